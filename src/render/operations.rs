//! What the context and the lenses do, as one list for the shader: bottom lens first (L6).

use crate::{
    city::CityModel,
    lens::{
        Class, EffectUse, Lens, LensBody,
        thematic::{ThematicError, ThematicScale},
    },
    render::{layout, palette},
    shader,
};

/// Width of a lens outline, pixels.
const OUTLINE_PX: f32 = 1.6;

/// The operations of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operations {
    /// The shader's block: count, then [`layout::Operation`]s.
    pub bytes: Vec<u8>,
    /// Colours of objects, one run per thematic effect, sRGB bytes.
    pub object_colors: Vec<u32>,
    /// Numbers of all effects in the list, ascending.
    pub effects: Vec<u32>,
    /// Numbers of the context's effects, ascending.
    pub context_effects: Vec<u32>,
    /// Whether some lens shows its silhouette.
    pub outlines: bool,
    /// Whether some lens acts on another class than *inside*.
    pub other_classes: bool,
}

impl Operations {
    /// The operations of the context's effects and of the enabled lenses that have a volume; `visible[i]` says
    /// whether lens i has one. Thematic colours are those of `model`'s objects.
    pub fn new(
        context: &[EffectUse],
        lenses: &[Lens],
        visible: &[bool],
        model: &CityModel,
    ) -> Result<Self, ThematicError> {
        let mut out = Self::default();
        let mut list = Vec::new();
        for effect in context {
            list.extend(out.operation(effect, layout::CONTEXT, model)?);
        }
        out.context_effects = out.effects.clone();
        let active = || lenses.iter().enumerate().filter(|(i, _)| visible.get(*i) == Some(&true));
        for (i, lens) in active() {
            for effect in &lens.effects {
                out.other_classes |= effect.class != Class::Inside;
                list.extend(out.operation(effect, i as u32, model)?);
            }
        }
        for (i, lens) in active().filter(|(_, lens)| lens.body == LensBody::Outline) {
            out.outlines = true;
            let [r, g, b] = palette::linear(lens.color);
            list.push(layout::Operation {
                effect: layout::OUTLINE,
                lens: i as u32,
                parameters: layout::Parameters { a: [r, g, b, 0.92], b: [OUTLINE_PX, 0.0, 0.0, 0.0] },
                ..Default::default()
            });
        }
        let mut header = [0_u32; 4];
        header[0] = list.len() as u32;
        out.bytes.extend_from_slice(bytemuck::cast_slice(&header));
        list.resize(list.len().max(1), layout::Operation::default());
        out.bytes.extend_from_slice(bytemuck::cast_slice(&list));
        Ok(out)
    }

    fn operation(
        &mut self,
        effect: &EffectUse,
        lens: u32,
        model: &CityModel,
    ) -> Result<Option<layout::Operation>, ThematicError> {
        let Some(number) = shader::effect_number(&effect.effect) else { return Ok(None) };
        if let Err(place) = self.effects.binary_search(&number) {
            self.effects.insert(place, number);
        }
        let mut parameters = layout::Parameters::default();
        if effect.effect == "thematic" {
            parameters.a[0] = self.object_colors.len() as f32;
            let colors = ThematicScale::new(model, effect)?.object_colors(model);
            self.object_colors.extend(colors.iter().map(|c| {
                let [r, g, b] = c.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
                u32::from_le_bytes([r, g, b, 255])
            }));
        } else {
            parameters.a[0] = effect.amount();
        }
        Ok(Some(layout::Operation {
            effect: number,
            lens,
            class_: class_number(effect.class),
            parameters,
            reserved: 0,
        }))
    }
}

/// `pass/shade.wgsl`.
fn class_number(class: Class) -> u32 {
    match class {
        Class::Inside => 0,
        Class::Front => 1,
        Class::Behind => 2,
        Class::Rest => 3,
    }
}
