//! A scene for a picture of another size: what it gives in pixels keeps its share of the picture.

use crate::{
    lens::{EffectUse, Lens, Parameter, border::BorderUnit},
    scene::{
        model::{Scene, TextSize},
        overlay::{ContextLine, Overlay},
    },
    shader::effect::{DefaultValue, Fallback, ParameterKind, find},
};

/// The unit of effects' parameters that are lengths in the picture.
const PIXELS: &str = "pixels";
/// The one of those that follow the size of the picture, or its dots per inch: [`crate::scene::Figure::point_px`].
pub const POINTS: &str = "points";

impl Scene {
    /// The scene for a picture that is `factor` > 0 times as wide and high as the one that its lengths in pixels are meant for, and whose text
    /// is so large there (`em_px`): overlays, their lines, the layout, text, borders, lines of effects and lenses, and how fine meshes are.
    #[must_use]
    pub fn sized(&self, factor: f64, em_px: f64) -> Self {
        let mut scene = self.clone();
        scene.overlays.iter_mut().for_each(|overlay| size_overlay(overlay, factor));
        // What is not given goes by the picture as it is.
        for length in [&mut scene.layout.margin_px, &mut scene.layout.gap_px] {
            *length = length.map(|length| length * factor);
        }
        scene.figure.text = Some(TextSize::Pixels(em_px * factor));
        scene.figure.scale *= factor;
        scene.style.chord_px *= factor;
        scene.style = scene.style.drawn();
        scene.style.effects.iter_mut().for_each(|used| size_effect(used, factor));
        scene.lenses.iter_mut().for_each(|lens| size_lens(lens, factor));
        scene
    }
}

fn size_overlay(overlay: &mut Overlay, factor: f64) {
    let sizes = [overlay.size.as_mut(), overlay.min.as_mut(), overlay.max.as_mut()];
    for side in sizes.into_iter().flatten().flatten() {
        *side = ((f64::from(*side) * factor).round() as u32).max(1);
    }
    if let Some(ContextLine { widths, fade, .. }) = &mut overlay.line {
        *widths = widths.map(|width| width.map(|width| width * factor));
        *fade = fade.map(|radii| radii.map(|radius| radius * factor));
    }
}

fn size_lens(lens: &mut Lens, factor: f64) {
    if let Some(border) = lens.border.as_mut().filter(|border| border.unit == BorderUnit::Pixels) {
        border.width *= factor;
    }
    let look = lens.kind.best_view_mut().and_then(|shown| shown.look.as_mut());
    let of_view = look.into_iter().flat_map(|look| &mut look.effects);
    lens.effects.iter_mut().chain(of_view).for_each(|used| size_effect(used, factor));
    if let Some(render) = lens.kind.rendering_mut() {
        let of_cases = render.cases.iter_mut().flat_map(|case| &mut case.effects);
        of_cases.chain(&mut render.poi_effects).for_each(|used| size_effect(used, factor));
    }
}

fn size_effect(used: &mut EffectUse, factor: f64) {
    let Some(definition) = find(&used.effect) else { return };
    for parameter in definition.parameters.iter().filter(|parameter| parameter.unit == PIXELS) {
        let ParameterKind::Number { min, max } = parameter.kind else { continue };
        let given = used.number(&parameter.name);
        let number = given.or(match parameter.fallback {
            Fallback::Value(DefaultValue::Number(number)) => Some(number),
            _ => None,
        });
        if let Some(number) = number {
            used.parameters.insert(parameter.name.clone(), Parameter::Number((number * factor).clamp(min, max)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::{Class, LensKind, kind::BestViewLens};

    fn used(effect: &str, parameters: &[(&str, f64)]) -> EffectUse {
        let parameters = parameters.iter().map(|(name, number)| ((*name).to_owned(), Parameter::Number(*number)));
        EffectUse {
            effect: effect.to_owned(),
            class: Class::Inside,
            blend: None,
            weight: None,
            parameters: parameters.collect(),
        }
    }

    #[test]
    fn what_is_given_in_pixels_keeps_its_share_of_the_picture() {
        let mut scene = Scene::default();
        let shown = crate::lens::BestView {
            pois: Vec::new(),
            depiction: crate::lens::best_view::Depiction::Text("a".to_owned()),
            lenses: None,
            look: None,
        };
        let view = Lens::plain("view", BestViewLens { shown }, [0.0; 3]);
        let mut lines = Lens::plain("lines", LensKind::default(), [0.0; 3]);
        let blur = find("blur").unwrap().parameters.iter().find(|own| own.unit == PIXELS).unwrap();
        lines.effects =
            vec![used("blur", &[]), used("blur", &[(&blur.name, 2.0)]), used("sepia", &[]), used("wireframe", &[])];
        scene.lenses = vec![view, lines];
        let line = ContextLine { widths: [Some(6.0), None], ..ContextLine::default() };
        scene.overlays = vec![Overlay { size: Some([240, 160]), line: Some(line), ..Overlay::of("view") }];
        scene.layout.margin_px = Some(16.0);
        let half = scene.sized(0.5, 14.0);
        assert_eq!(half.overlays[0].size, Some([120, 80]));
        assert_eq!(half.overlays[0].line.as_ref().unwrap().widths, [Some(3.0), None]);
        assert_eq!((half.layout.margin_px, half.layout.gap_px), (Some(8.0), None));
        assert_eq!(half.figure.text_px(), Some(7.0));
        let effects = &half.lenses[1].effects;
        let Fallback::Value(DefaultValue::Number(default)) = blur.fallback else { panic!("a radius has a default") };
        assert_eq!(effects[0].number(&blur.name), Some(0.5 * default));
        assert_eq!(effects[1].number(&blur.name), Some(1.0));
        assert_eq!(effects[2..], scene.lenses[1].effects[2..], "what is not in pixels stays");
        assert_eq!(half.figure.point_px(), 0.5 * scene.figure.point_px());
        // There and back; and at its own size nothing is another but for what was left to defaults.
        let back = half.sized(2.0, 7.0);
        assert_eq!(back.overlays[0], scene.overlays[0]);
        assert_eq!(back.lenses[1].effects[1], scene.lenses[1].effects[1]);
    }
}
