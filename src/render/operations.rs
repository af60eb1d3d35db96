//! What the context and the lenses do, as one list: bottom lens first (L6).

use crate::{
    city::CityModel,
    lens::{
        Class, EffectUse, Lens, LensBody,
        effect::{default_of, in_floats},
        thematic::{ThematicError, ThematicScale},
    },
    render::palette,
    shader::{self, ClassTest, Plan, PlanLens, Scope, Step},
};

/// Width of a lens outline, pixels.
const OUTLINE_PX: f32 = 1.6;

/// Volumes that one pipeline may read: a uniform buffer of 64 KiB, which every adapter binds, holds more than so many.
pub const MOST_VOLUMES: usize = 1024;
/// `vec4f` of parameters that one pipeline may read: such a buffer full.
pub const MOST_SLOTS: usize = 4096;

/// One use of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// Index into [`shader::effects`].
    pub effect: u32,
    /// Its first slot of the parameters.
    pub parameters: u32,
    /// Which lens, or `None`: everywhere.
    pub lens: Option<u32>,
    /// On which of its classes.
    pub class: Class,
}

/// The operations of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operations {
    /// Effects in order.
    pub list: Vec<Operation>,
    /// Lenses that show their silhouette, and the first slot of its parameters.
    pub outlines: Vec<(u32, u32)>,
    /// Parameters of all of them, in slots of four.
    pub parameters: Vec<[f32; 4]>,
    /// Colours of objects, one run per thematic effect, sRGB bytes.
    pub object_colors: Vec<u32>,
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
        for effect in context {
            out.add(effect, None, model)?;
        }
        let active = || lenses.iter().enumerate().filter(|(i, _)| visible.get(*i) == Some(&true));
        for (i, lens) in active() {
            for effect in &lens.effects {
                out.add(effect, Some(i as u32), model)?;
            }
        }
        for (i, lens) in active().filter(|(_, lens)| lens.body == LensBody::Outline) {
            let [r, g, b] = palette::linear(lens.color);
            out.outlines.push((i as u32, out.parameters.len() as u32));
            out.parameters.extend([[r, g, b, 0.92], [OUTLINE_PX, 0.0, 0.0, 0.0]]);
        }
        Ok(out)
    }

    /// What shading has to do outside all lenses.
    pub fn context_plan(&self) -> Plan {
        Plan { steps: self.steps(|_| None), ..Plan::default() }
    }

    /// What shading has to do where lenses may be seen; `seen` holds each seen volume's lens, ascending. With `masks`
    /// every pixel's classes are written down.
    pub fn lens_plan(&self, seen: &[u32], masks: bool) -> Plan {
        let mut lenses: Vec<PlanLens> = Vec::new();
        let mut numbers = Vec::new();
        for &lens in seen {
            if numbers.last() == Some(&lens) {
                lenses[numbers.len() - 1].volumes += 1;
                continue;
            }
            let line = self.outlines.iter().find(|(o, _)| *o == lens).map(|(_, first)| *first);
            // Without masks nobody asks for a lens' number: equal plans are equal then.
            let number = if masks { lens } else { numbers.len() as u32 };
            lenses.push(PlanLens { number, volumes: 1, outline: line });
            numbers.push(lens);
        }
        let steps = self.steps(|lens| numbers.iter().position(|&n| n == lens).map(|i| i as u32));
        Plan { lenses, steps, masks }
    }

    /// The list as steps; `place` finds a lens in the plan.
    fn steps(&self, place: impl Fn(u32) -> Option<u32>) -> Vec<Step> {
        let step = |operation: &Operation| {
            let scope = match operation.lens {
                None => Scope::Everywhere,
                Some(lens) => Scope::Lens(place(lens)?, class_test(operation.class)),
            };
            Some(Step { effect: operation.effect, scope, parameters: operation.parameters })
        };
        self.list.iter().filter_map(step).collect()
    }

    fn add(&mut self, effect: &EffectUse, lens: Option<u32>, model: &CityModel) -> Result<(), ThematicError> {
        let Some(number) = shader::effect::number_of(&effect.effect) else { return Ok(()) };
        let definition = &shader::effects()[number as usize];
        let first = self.parameters.len() as u32;
        let mut floats = Vec::new();
        if definition.object_colors {
            floats.push(self.object_colors.len() as f32);
            let colors = ThematicScale::new(model, effect)?.object_colors(model);
            self.object_colors.extend(colors.iter().map(|c| {
                let [r, g, b] = c.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
                u32::from_le_bytes([r, g, b, 255])
            }));
        }
        for (parameter, ..) in definition.shader_parameters() {
            let value = effect.parameters.get(&parameter.name).cloned().or_else(|| default_of(parameter));
            floats.extend(value.map_or_else(Vec::new, |value| in_floats(parameter, &value)));
        }
        floats.resize(definition.slots() as usize * 4, 0.0);
        self.parameters.extend(floats.as_chunks().0);
        self.list.push(Operation { effect: number, parameters: first, lens, class: effect.class });
        Ok(())
    }
}

fn class_test(class: Class) -> ClassTest {
    match class {
        Class::Inside => ClassTest::Inside,
        Class::Front => ClassTest::Front,
        Class::Behind => ClassTest::Behind,
        Class::Rest => ClassTest::Rest,
    }
}
