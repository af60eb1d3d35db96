//! Sections: the text of the pass that finds where volumes end, and in which closed shells that is.

use std::fmt::Write as _;

use crate::shader::{
    effect::definition::EffectDefinition,
    forms::loaded,
    hiding, lens_test,
    plan::{lens_test::LensTest, program::Program},
};

/// The functions that the pass calls: `visible`, and the ends of volumes.
pub(super) fn source(program: &Program, handlers: &[EffectDefinition], names: &[&str]) -> String {
    let mut text = hiding::source(program, handlers, names, hiding::Eye::Picture);
    let (kinds, by): (Vec<(String, LensTest, String)>, &str) = match program {
        Program::Specialised(plan) => {
            let all = plan.lenses.iter().flat_map(|lens| &lens.volumes).enumerate();
            (all.map(|(i, test)| (format!("{i}u"), *test, i.to_string())).collect(), "volume")
        }
        Program::Uber(uber) => {
            let all = uber.tests.iter().map(|test| (test.constant(), *test, "volume".to_owned()));
            (all.collect(), "lens_regions[volume].test")
        }
    };
    let mut switch = |head: &str, otherwise: &str, answer: &dyn Fn(LensTest, &str) -> String| {
        let _ = writeln!(text, "{head}");
        let _ = writeln!(text, "    switch {by} {{");
        for (case, test, volume) in &kinds {
            let _ = writeln!(text, "        case {case}: {{ return {}; }}", answer(*test, volume));
        }
        let _ = writeln!(text, "        default: {{ return {otherwise}; }}\n    }}\n}}\n");
    };
    switch("fn holds_volume(volume: u32, sight: Sight) -> bool {", "false", &lens_test::holds);
    let end = |test: LensTest, volume: &str| match test {
        _ if test.has_span() => format!("end_of_span(span_of_form(ray, lens_regions[{volume}], {}))", test.constant()),
        _ if test.has_leaves() => {
            let combination = loaded(test, &format!("lens_regions[{volume}]"));
            format!("end_of_combined({combination}, ray, pixel, {})", lens_test::span(test, volume))
        }
        _ => format!("end_by_steps(ray, pixel, {})", lens_test::span(test, volume)),
    };
    switch("fn end_of(ray: Ray, pixel: vec2i) -> f32 {\n    let volume = stage.volume;", "0.0", &end);
    text
}
