//! Lens tests in a module's text: which uniforms they read, and the calls, from the shapes or by depth sprites (S7).

use std::fmt::Write as _;

use crate::shader::{
    plan::{Plan, Program, VolumeTest},
    uber::MOST_VOLUMES,
};

/// The uniforms that the tests of a program read in the picture; `carried`: the shapes reach fragments as
/// [`crate::shader::carried`] has it.
pub(super) fn bindings(program: &Program, carried: bool) -> String {
    let count = match program {
        Program::Specialised(plan) => plan.volumes(),
        Program::Uber(_) => MOST_VOLUMES,
    };
    let parts = program.has();
    let mut text = String::new();
    if parts.sprites {
        let _ = writeln!(text, "@group(2) @binding(3) var<uniform> sprite_places: array<SpritePlace, {count}>;");
    }
    // The uber back end reads of each volume there how it is tested.
    if parts.shapes {
        text.push_str(&uniform(7, "shapes", &format!("array<Shape, {count}>"), carried));
    }
    text
}

/// A uniform array, and where it is carried what it is carried into.
pub(super) fn uniform(binding: u32, name: &str, array: &str, carried: bool) -> String {
    let whole = if carried { "_uniform" } else { "" };
    let own = if carried { format!("var<private> {name}: {array};\n") } else { String::new() };
    format!("@group(2) @binding({binding}) var<uniform> {name}{whole}: {array};\n{own}")
}

fn call(test: VolumeTest, volume: u32, [of_shape, of_sprite]: [&str; 2], place: &str) -> String {
    match test {
        VolumeTest::Sprite => format!("{of_sprite}(sprite_places[{volume}], {place})"),
        _ => format!("{of_shape}(shapes[{volume}], {}, {place})", test.constant()),
    }
}

/// A value of all volumes of a plan's lens.
fn joined(plan: &Plan, lens: u32, words: [&str; 2], place: &str, operator: &str) -> String {
    let (first, tests) = plan.volumes_of(lens);
    let calls: Vec<String> = (first..).zip(tests).map(|(volume, test)| call(*test, volume, words, place)).collect();
    calls.join(operator)
}

/// The classes of a place with regard to one lens of a plan.
pub(super) fn classes(plan: &Plan, lens: u32, sight: &str) -> String {
    let of_shape = if plan.asks_inside_alone(lens) { "inside_shape" } else { "class_in_shape" };
    joined(plan, lens, [of_shape, "class_in_sprite"], sight, "\n        | ")
}

/// Whether one lens of a plan covers a pixel.
pub(super) fn covers(plan: &Plan, lens: u32, pixel: &str) -> String {
    joined(plan, lens, ["covers_shape", "covers_sprite"], pixel, " || ")
}

/// For the uber back end: a value of a volume by its number.
fn by_number(tests: &[VolumeTest], words: [&str; 2], place: &str) -> String {
    let one = |test: VolumeTest| match test {
        VolumeTest::Sprite => format!("{}(sprite_places[v], {place})", words[1]),
        _ => format!("{}(shapes[v], {}, {place})", words[0], test.constant()),
    };
    match tests {
        [] => String::new(),
        [only] => format!("    return {};\n", one(*only)),
        [first, rest @ ..] => {
            let mut text = "    switch shapes[v].kind {\n".to_owned();
            for test in rest {
                let _ = writeln!(text, "        case {}: {{ return {}; }}", test.constant(), one(*test));
            }
            let _ = writeln!(text, "        default: {{ return {}; }}\n    }}", one(*first));
            text
        }
    }
}

/// `class_of`, for the uber back end.
pub(super) fn class_of(tests: &[VolumeTest]) -> String {
    let body = by_number(tests, ["class_in_shape", "class_in_sprite"], "sight");
    format!("fn class_of(v: u32, sight: Sight) -> u32 {{\n{body}}}\n\n")
}

/// `volume_covers`, for the uber back end.
pub(super) fn volume_covers(tests: &[VolumeTest]) -> String {
    let body = by_number(tests, ["covers_shape", "covers_sprite"], "pixel");
    format!("fn volume_covers(v: u32, pixel: vec2i) -> bool {{\n{body}}}\n\n")
}
