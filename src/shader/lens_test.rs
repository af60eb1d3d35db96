//! Lens tests in a module's text: which uniforms they read, and the calls, from the regions' numbers or by depth sprites.

use std::fmt::Write as _;

use crate::shader::{
    forms::{has_clear, loaded},
    own_region,
    plan::{Plan, form::Form, lens_test::LensTest, program::Program, uber::Uber},
    table::MOST_VOLUMES,
};

/// The uniforms that the tests of a program read in the picture; `carried`: the regions reach fragments as
/// [`crate::shader::carried`] has it.
pub(super) fn bindings(program: &Program, carried: bool) -> String {
    let count = match program {
        Program::Specialised(plan) => plan.volumes(),
        Program::Uber(_) => MOST_VOLUMES,
    };
    let parts = program.has();
    let mut text = String::new();
    if parts.sprites || parts.side_sprites {
        let _ = writeln!(text, "@group(2) @binding(3) var<uniform> sprite_places: array<SpritePlace, {count}>;");
    }
    // The uber back end reads of each volume there how it is tested.
    if parts.regions {
        text.push_str(&uniform(7, "lens_regions", &format!("array<Region, {count}>"), carried));
    }
    if parts.lenses {
        text.push('\n');
        text.push_str(&program.forms().functions());
    }
    text
}

/// A uniform array, and where it is carried what it is carried into.
pub(super) fn uniform(binding: u32, name: &str, array: &str, carried: bool) -> String {
    let whole = if carried { "_uniform" } else { "" };
    let own = if carried { format!("var<private> {name}: {array};\n") } else { String::new() };
    format!("@group(2) @binding({binding}) var<uniform> {name}{whole}: {array};\n{own}")
}

/// Questions to a volume.
#[derive(Clone, Copy)]
enum Question {
    /// Its classes.
    Classes,
    /// Whether a place is inside.
    Inside,
    /// Whether a pixel's ray meets it.
    Covers,
    /// Whether a pixel is clear of its silhouette: those around it surely meet it as it does.
    Clear,
}

/// A question to a volume by its number, about a `place`.
fn call(question: Question, test: LensTest, volume: &str, place: &str) -> String {
    use {Form as F, LensTest as T, Question as Q};
    let (region, sprite) = (format!("lens_regions[{volume}]"), format!("sprite_places[{volume}]"));
    let own = loaded(test, &region);
    match (question, test) {
        (Q::Clear, T::Numbers(form)) if has_clear(form) => {
            format!("is_clear_of_form({region}, {}, {place})", form.constant())
        }
        (Q::Clear, _) => "false".to_owned(),
        (Q::Covers, T::Sprite) => format!("covers_sprite({sprite}, {place})"),
        (_, T::Sprite) => format!("class_in_sprite({sprite}, {place})"),
        (Q::Covers, T::LayeredSprite) => format!("covers_layers({sprite}, {place})"),
        (_, T::LayeredSprite) => format!("class_in_layers({sprite}, {place})"),
        (Q::Covers, T::OwnSprite) => format!("covers_own({own}, {place})"),
        (_, T::OwnSprite) => format!("class_in_own({own}, {place})"),
        (Q::Covers, T::Sides(_)) => format!("covers_sides({sprite}, {place})"),
        (Q::Classes, T::Sides(F::Combined)) => format!("class_in_combined({own}, {sprite}, {place})"),
        (Q::Classes, T::Sides(_)) => format!("class_in_solid({own}, {sprite}, {place})"),
        (Q::Covers, T::Numbers(F::Members)) => format!("covers_members({own}, {place})"),
        (_, T::Numbers(F::Members)) => format!("inside_members({own}, {place})"),
        (Q::Covers, T::Numbers(F::FadingMembers)) => format!("covers_fading_members({own}, {place})"),
        (_, T::Numbers(F::FadingMembers)) => format!("inside_fading_members({own}, {place})"),
        (Q::Inside, T::Numbers(F::Combined) | T::Sides(F::Combined)) => format!("inside_combined({own}, {place})"),
        (Q::Classes, T::Numbers(F::Combined)) => format!("class_by_leaves({own}, {place})"),
        (Q::Covers, T::Numbers(F::Combined)) => format!("covers_by_leaves({own}, {place})"),
        (Q::Inside, T::Sides(_)) => format!("inside_solid({own}, {place})"),
        (Q::Inside, T::Numbers(form)) if form.is_solid() => format!("inside_solid({own}, {place})"),
        (Q::Classes, T::Numbers(form)) if form.is_solid() => format!("class_by_faces({own}, {place})"),
        (Q::Covers, T::Numbers(form)) if form.is_solid() => format!("covers_by_faces({own}, {place})"),
        (Q::Classes, T::Numbers(F::Own(handler))) => format!("class_of_{}({own}, {place})", own_region::name(handler)),
        (Q::Classes, T::Numbers(form)) => format!("class_in_form({region}, {}, {place})", form.constant()),
        (Q::Inside, T::Numbers(form)) => format!("inside_form({region}, {}, {place})", form.constant()),
        (Q::Covers, T::Numbers(form)) => format!("covers_form({region}, {}, {place})", form.constant()),
    }
}

/// Whether a volume by its number holds the place `sight`.
pub(super) fn holds(test: LensTest, volume: &str) -> String {
    format!("is_inside({})", call(Question::Inside, test, volume, "sight"))
}

/// A question to all volumes of a plan's lens.
fn joined(plan: &Plan, lens: u32, question: Question, place: &str, operator: &str) -> String {
    let (first, tests) = plan.volumes_of(lens);
    let calls: Vec<String> =
        (first..).zip(tests).map(|(volume, test)| call(question, *test, &volume.to_string(), place)).collect();
    calls.join(operator)
}

/// The classes of a place with regard to one lens of a plan.
pub(super) fn classes(plan: &Plan, lens: u32, sight: &str) -> String {
    let question = if plan.asks_inside_alone(lens) { Question::Inside } else { Question::Classes };
    joined(plan, lens, question, sight, "\n        | ")
}

/// Whether one lens of a plan covers a pixel.
pub(super) fn covers(plan: &Plan, lens: u32, pixel: &str) -> String {
    joined(plan, lens, Question::Covers, pixel, " || ")
}

/// Whether a pixel is clear of the silhouettes of one lens of a plan.
pub(super) fn is_clear(plan: &Plan, lens: u32, around: &str) -> String {
    joined(plan, lens, Question::Clear, around, " && ")
}

/// The degree of interest of a place in one lens of a plan; `border` are the parameters of its border.
pub(super) fn interest(plan: &Plan, lens: u32, border: &str) -> String {
    format!("degree_of_interest({}, {border}, sight)", distance_of(plan, lens, border))
}

/// How far a place is from one lens of a plan.
pub(super) fn distance_of(plan: &Plan, lens: u32, border: &str) -> String {
    match plan.border_of(lens).is_some_and(|border| border.by_ray) {
        true => least(plan, lens, along_ray),
        false => distance_in_space(plan, lens, border),
    }
}

/// The same where its border is not asked for: never along a ray.
pub(super) fn distance_in_space(plan: &Plan, lens: u32, border: &str) -> String {
    least(plan, lens, |test, volume| distance(test, volume, border))
}

/// The least distance of all volumes of one lens of a plan.
fn least(plan: &Plan, lens: u32, of: impl Fn(LensTest, &str) -> String) -> String {
    let (first, tests) = plan.volumes_of(lens);
    let distances = (first..).zip(tests).map(|(volume, test)| of(*test, &volume.to_string()));
    distances.reduce(|all, one| format!("min({all}, {one})")).unwrap_or_else(|| "FAR_AWAY".to_owned())
}

/// Where a ray meets one lens of a plan first and last.
pub(super) fn ends_of(plan: &Plan, lens: u32) -> String {
    let (first, tests) = plan.volumes_of(lens);
    let spans = (first..).zip(tests).map(|(volume, test)| span(*test, &volume.to_string()));
    spans.reduce(|all, one| format!("with_span({all}, {one})")).unwrap_or_else(|| "EMPTY_SPAN".to_owned())
}

/// Where a ray meets a volume by its number first and last.
pub(super) fn span(test: LensTest, volume: &str) -> String {
    span_of(test, volume, "pixel", "ray")
}

/// How far a place is from where its ray enters or leaves a volume by its number.
fn along_ray(test: LensTest, volume: &str) -> String {
    format!("distance_to_ends({}, sight)", span_of(test, volume, "sight.pixel", "sight.ray"))
}

fn span_of(test: LensTest, volume: &str, pixel: &str, ray: &str) -> String {
    match test {
        LensTest::Sides(_) => format!("span_in_sides(sprite_places[{volume}], {pixel})"),
        LensTest::Sprite | LensTest::LayeredSprite => format!("span_in_layers(sprite_places[{volume}], {pixel})"),
        LensTest::OwnSprite => format!("span_in_own({}, {ray})", loaded(test, &format!("lens_regions[{volume}]"))),
        LensTest::Numbers(form) => match form.has_span() {
            true => format!("span_of_form({ray}, lens_regions[{volume}], {})", form.constant()),
            false => "EMPTY_SPAN".to_owned(),
        },
    }
}

/// `ends_of_volume`, for the uber back end.
pub(super) fn ends_of_volume(tests: &[LensTest]) -> String {
    let head = "fn ends_of_volume(v: u32, pixel: vec2i, ray: Ray) -> Span {\n    switch lens_regions[v].test {\n";
    let mut text = head.to_owned();
    for test in tests {
        let _ = writeln!(text, "        case {}: {{ return {}; }}", test.constant(), span(*test, "v"));
    }
    text + "        default: { return EMPTY_SPAN; }\n    }\n}\n\n"
}

/// How far a place is from a volume by its number, negative inside. What has no distance ends at once.
fn distance(test: LensTest, volume: &str, border: &str) -> String {
    let region = format!("lens_regions[{volume}]");
    let form = match test {
        LensTest::OwnSprite => return "FAR_AWAY".to_owned(),
        LensTest::Sprite | LensTest::LayeredSprite => None,
        LensTest::Numbers(Form::Members | Form::FadingMembers) => None,
        LensTest::Numbers(form) | LensTest::Sides(form) => Some(form),
    };
    match form {
        None => {
            let inside = call(Question::Inside, test, volume, "sight");
            format!("select(FAR_AWAY, -FAR_AWAY, is_inside({inside}))")
        }
        Some(Form::Combined) => format!("distance_to_combined({}, sight, {border})", loaded(test, &region)),
        Some(form) if form.is_solid() => format!("distance_to_solid({}, sight, {border})", loaded(test, &region)),
        Some(form) => format!("distance_to_form({region}, {}, sight, {border})", form.constant()),
    }
}

/// For the uber back end: a question to a volume by its number.
fn by_number(tests: &[LensTest], question: Question, place: &str) -> String {
    match tests {
        [] => String::new(),
        [only] => format!("    return {};\n", call(question, *only, "v", place)),
        [first, rest @ ..] => {
            let mut text = "    switch lens_regions[v].test {\n".to_owned();
            for test in rest {
                let answer = call(question, *test, "v", place);
                let _ = writeln!(text, "        case {}: {{ return {answer}; }}", test.constant());
            }
            let answer = call(question, *first, "v", place);
            let _ = writeln!(text, "        default: {{ return {answer}; }}\n    }}");
            text
        }
    }
}

/// `distance_to`, for the uber back end.
pub(super) fn distance_to(tests: &[LensTest], by_ray: bool) -> String {
    let head = "fn distance_to(v: u32, sight: Sight, border: vec4f) -> f32 {\n    switch lens_regions[v].test {\n";
    let mut text = head.to_owned();
    for test in tests {
        let mut away = distance(*test, "v", "border");
        if by_ray {
            away = format!("select({away}, {}, border.w > 0.5)", along_ray(*test, "v"));
        }
        let _ = writeln!(text, "        case {}: {{ return {away}; }}", test.constant());
    }
    text + "        default: { return FAR_AWAY; }\n    }\n}\n\n"
}

/// `class_of`, for the uber back end.
pub(super) fn class_of(uber: &Uber) -> String {
    let question = if uber.asks_inside_alone() { Question::Inside } else { Question::Classes };
    let body = by_number(&uber.tests, question, "sight");
    format!("fn class_of(v: u32, sight: Sight) -> u32 {{\n{body}}}\n\n")
}

/// `volume_covers`, for the uber back end.
pub(super) fn volume_covers(tests: &[LensTest]) -> String {
    let body = by_number(tests, Question::Covers, "pixel");
    format!("fn volume_covers(v: u32, pixel: vec2i) -> bool {{\n{body}}}\n\n")
}

/// `volume_is_clear`, for the uber back end.
pub(super) fn volume_is_clear(tests: &[LensTest]) -> String {
    let body = by_number(tests, Question::Clear, "pixel, reach");
    format!("fn volume_is_clear(v: u32, pixel: vec2i, reach: i32) -> bool {{\n{body}}}\n\n")
}
