//! Sections: the text of the pass that finds where volumes end, and in which closed shells that is.

use std::fmt::Write as _;

use crate::shader::{
    effect::definition::EffectDefinition,
    hiding, lens_test,
    plan::{program::Program, volume_test::VolumeTest},
};

/// The functions that the pass calls: `visible`, and the ends of volumes.
pub(super) fn source(program: &Program, handlers: &[EffectDefinition], names: &[&str]) -> String {
    let mut text = hiding::source(program, handlers, names, hiding::Eye::Picture);
    let (kinds, by): (Vec<(String, VolumeTest, String)>, &str) = match program {
        Program::Specialised(plan) => {
            let all = plan.lenses.iter().flat_map(|lens| &lens.volumes).enumerate();
            (all.map(|(i, test)| (format!("{i}u"), *test, i.to_string())).collect(), "volume")
        }
        Program::Uber(uber) => {
            let all = uber.tests.iter().map(|test| (test.constant().to_owned(), *test, "volume".to_owned()));
            (all.collect(), "shapes[volume].kind")
        }
    };
    let mut switch = |head: &str, otherwise: &str, answer: &dyn Fn(VolumeTest, &str) -> String| {
        let _ = writeln!(text, "{head}");
        let _ = writeln!(text, "    switch {by} {{");
        for (case, test, volume) in &kinds {
            let _ = writeln!(text, "        case {case}: {{ return {}; }}", answer(*test, volume));
        }
        let _ = writeln!(text, "        default: {{ return {otherwise}; }}\n    }}\n}}\n");
    };
    switch("fn holds_volume(volume: u32, sight: Sight) -> bool {", "false", &lens_test::holds);
    let end = |test: VolumeTest, volume: &str| match test {
        _ if test.has_span() => format!("end_of_span(span_of_shape(ray, shapes[{volume}], {}))", test.constant()),
        _ if test.has_leaves() => {
            format!("end_of_combined(shapes[{volume}], ray, pixel, {})", lens_test::span(test, volume))
        }
        _ => format!("end_by_steps(ray, pixel, {})", lens_test::span(test, volume)),
    };
    switch("fn end_of(ray: Ray, pixel: vec2i) -> f32 {\n    let volume = stage.volume;", "0.0", &end);
    text
}
