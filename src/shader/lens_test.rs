//! Lens tests in a module's text: which uniforms they read, and the calls, from the shapes or by depth sprites.

use std::fmt::Write as _;

use crate::shader::{
    plan::{Plan, program::Program, uber::Uber, volume_test::VolumeTest},
    table::MOST_VOLUMES,
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
    if parts.sprites || parts.side_sprites {
        let _ = writeln!(text, "@group(2) @binding(3) var<uniform> sprite_places: array<SpritePlace, {count}>;");
    }
    // The uber back end reads of each volume there how it is tested.
    if parts.shapes {
        text.push_str(&uniform(7, "shapes", &format!("array<Shape, {count}>"), carried));
    }
    if parts.combinations {
        text.push('\n');
        text.push_str(&leaves(&program.leaves()));
        if parts.distances {
            text.push_str(&leaf_distances(&program.leaves()));
        }
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
}

/// A question to a volume by its number, about a `place`.
fn call(question: Question, test: VolumeTest, volume: &str, place: &str) -> String {
    use {Question as Q, VolumeTest as T};
    let (shape, sprite) = (format!("shapes[{volume}]"), format!("sprite_places[{volume}]"));
    match (question, test) {
        (Q::Covers, T::Members) => format!("covers_members({shape}, {place})"),
        (_, T::Members) => format!("inside_members({shape}, {place})"),
        (Q::Covers, T::FadingMembers) => format!("covers_fading_members({shape}, {place})"),
        (_, T::FadingMembers) => format!("inside_fading_members({shape}, {place})"),
        (Q::Covers, T::Sprite) => format!("covers_sprite({sprite}, {place})"),
        (_, T::Sprite) => format!("class_in_sprite({sprite}, {place})"),
        (Q::Covers, T::LayeredSprite) => format!("covers_layers({sprite}, {place})"),
        (_, T::LayeredSprite) => format!("class_in_layers({sprite}, {place})"),
        (Q::Covers, T::OwnSprite) => format!("covers_own({shape}, {place})"),
        (_, T::OwnSprite) => format!("class_in_own({shape}, {place})"),
        (Q::Covers, T::SolidSprite | T::CombinedSprite) => format!("covers_sides({sprite}, {place})"),
        (Q::Classes, T::SolidSprite) => format!("class_in_solid({shape}, {sprite}, {place})"),
        (Q::Inside, T::Combined | T::CombinedSprite) => format!("inside_combined({shape}, {place})"),
        (Q::Classes, T::CombinedSprite) => format!("class_in_combined({shape}, {sprite}, {place})"),
        (Q::Classes, T::Combined) => format!("class_by_leaves({shape}, {place})"),
        (Q::Covers, T::Combined) => format!("covers_by_leaves({shape}, {place})"),
        (Q::Inside, T::Solid | T::SolidSprite) => format!("inside_solid({shape}, {place})"),
        (Q::Classes, T::Solid) => format!("class_by_faces({shape}, {place})"),
        (Q::Covers, T::Solid) => format!("covers_by_faces({shape}, {place})"),
        (Q::Classes, _) => format!("class_in_shape({shape}, {}, {place})", test.constant()),
        (Q::Inside, _) => format!("inside_shape({shape}, {}, {place})", test.constant()),
        (Q::Covers, _) => format!("covers_shape({shape}, {}, {place})", test.constant()),
    }
}

/// Whether a volume by its number holds the place `sight`.
pub(super) fn holds(test: VolumeTest, volume: &str) -> String {
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

/// The degree of interest of a place in one lens of a plan; `border` are the parameters of its border.
pub(super) fn interest(plan: &Plan, lens: u32, border: &str) -> String {
    format!("degree_of_interest({}, {border}, sight)", distance_of(plan, lens, border))
}

/// How far a place is from one lens of a plan.
pub(super) fn distance_of(plan: &Plan, lens: u32, border: &str) -> String {
    let (first, tests) = plan.volumes_of(lens);
    let by_ray = plan.border_of(lens).is_some_and(|border| border.by_ray);
    let distances = (first..).zip(tests).map(|(volume, test)| match by_ray {
        true => along_ray(*test, &volume.to_string()),
        false => distance(*test, &volume.to_string(), border),
    });
    distances.reduce(|all, one| format!("min({all}, {one})")).unwrap_or_else(|| "FAR_AWAY".to_owned())
}

/// Where a ray meets one lens of a plan first and last.
pub(super) fn ends_of(plan: &Plan, lens: u32) -> String {
    let (first, tests) = plan.volumes_of(lens);
    let spans = (first..).zip(tests).map(|(volume, test)| span(*test, &volume.to_string()));
    spans.reduce(|all, one| format!("with_span({all}, {one})")).unwrap_or_else(|| "EMPTY_SPAN".to_owned())
}

/// Where a ray meets a volume by its number first and last.
pub(super) fn span(test: VolumeTest, volume: &str) -> String {
    span_of(test, volume, "pixel", "ray")
}

/// How far a place is from where its ray enters or leaves a volume by its number.
fn along_ray(test: VolumeTest, volume: &str) -> String {
    format!("distance_to_ends({}, sight)", span_of(test, volume, "sight.pixel", "sight.ray"))
}

fn span_of(test: VolumeTest, volume: &str, pixel: &str, ray: &str) -> String {
    match test {
        VolumeTest::Members | VolumeTest::FadingMembers | VolumeTest::Solid | VolumeTest::Combined => {
            "EMPTY_SPAN".to_owned()
        }
        VolumeTest::SolidSprite | VolumeTest::CombinedSprite => {
            format!("span_in_sides(sprite_places[{volume}], {pixel})")
        }
        VolumeTest::Sprite | VolumeTest::LayeredSprite => {
            format!("span_in_layers(sprite_places[{volume}], {pixel})")
        }
        VolumeTest::OwnSprite => format!("span_in_own(shapes[{volume}], {ray})"),
        _ => format!("span_of_shape({ray}, shapes[{volume}], {})", test.constant()),
    }
}

/// `ends_of_volume`, for the uber back end.
pub(super) fn ends_of_volume(tests: &[VolumeTest]) -> String {
    let head = "fn ends_of_volume(v: u32, pixel: vec2i, ray: Ray) -> Span {\n    switch shapes[v].kind {\n";
    let mut text = head.to_owned();
    for test in tests {
        let _ = writeln!(text, "        case {}: {{ return {}; }}", test.constant(), span(*test, "v"));
    }
    text + "        default: { return EMPTY_SPAN; }\n    }\n}\n\n"
}

/// How far a place is from a volume by its number, negative inside. What has no distance ends at once.
fn distance(test: VolumeTest, volume: &str, border: &str) -> String {
    let shape = format!("shapes[{volume}]");
    match test {
        VolumeTest::Members | VolumeTest::FadingMembers | VolumeTest::Sprite | VolumeTest::LayeredSprite => {
            let inside = call(Question::Inside, test, volume, "sight");
            format!("select(FAR_AWAY, -FAR_AWAY, is_inside({inside}))")
        }
        VolumeTest::OwnSprite => "FAR_AWAY".to_owned(),
        VolumeTest::Solid | VolumeTest::SolidSprite => format!("distance_to_solid({shape}, sight)"),
        VolumeTest::Combined | VolumeTest::CombinedSprite => format!("distance_to_combined({shape}, sight, {border})"),
        _ => format!("distance_to_shape({shape}, {}, sight, {border})", test.constant()),
    }
}

/// For the uber back end: a question to a volume by its number.
fn by_number(tests: &[VolumeTest], question: Question, place: &str) -> String {
    match tests {
        [] => String::new(),
        [only] => format!("    return {};\n", call(question, *only, "v", place)),
        [first, rest @ ..] => {
            let mut text = "    switch shapes[v].kind {\n".to_owned();
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

/// `leaf_holds` and `span_of_leaf`, for leaves of combinations of these kinds.
pub(super) fn leaves(kinds: &[VolumeTest]) -> String {
    let of = |head: &str, kind: &str, end: &str, answer: &dyn Fn(VolumeTest) -> String| {
        let mut text = format!("fn {head} {{\n");
        match kinds {
            [only] => {
                let _ = writeln!(text, "    return {};", answer(*only));
            }
            _ => {
                let _ = writeln!(text, "    switch {kind} {{");
                for kind in kinds {
                    let _ = writeln!(text, "        case {}: {{ return {}; }}", kind.constant(), answer(*kind));
                }
                let _ = writeln!(text, "        default: {{ return {end}; }}\n    }}");
            }
        }
        text + "}\n\n"
    };
    let holds = |kind: VolumeTest| match kind {
        VolumeTest::Solid => "solid_holds(leaf.shape, place.position, place.distance)".to_owned(),
        VolumeTest::Members => "is_chosen(u32(leaf.first), place.object)".to_owned(),
        VolumeTest::FadingMembers => "is_fading_member(u32(leaf.first), place.object, place.pixel)".to_owned(),
        VolumeTest::Flat => "flat_holds(leaf.shape, place.ray, place.distance, place.is_parallel)".to_owned(),
        _ => format!("holds(leaf.shape, {}, place.position, place.distance)", kind.constant()),
    };
    // A solid's ends are not asked for here; a choice of objects is the box around them.
    let span = |kind: VolumeTest| match kind {
        VolumeTest::Solid => "EMPTY_SPAN".to_owned(),
        VolumeTest::Members | VolumeTest::FadingMembers => "span_of_shape(ray, s, BOX)".to_owned(),
        _ => format!("span_of_shape(ray, s, {})", kind.constant()),
    };
    let holds = of("leaf_holds(leaf: Leaf, place: Sight) -> bool", "leaf.shape.kind", "false", &holds);
    holds + &of("span_of_leaf(ray: Ray, s: Shape) -> Span", "s.kind", "EMPTY_SPAN", &span)
}

/// `distance_to_leaf`, for leaves of combinations of these kinds.
fn leaf_distances(kinds: &[VolumeTest]) -> String {
    let head = "fn distance_to_leaf(leaf: Leaf, sight: Sight, border: vec4f) -> f32 {\n    switch leaf.shape.kind {\n";
    let mut text = head.to_owned();
    for kind in kinds {
        let answer = match kind {
            VolumeTest::Solid => "distance_to_solid(leaf.shape, sight)".to_owned(),
            VolumeTest::Members => "select(FAR_AWAY, -FAR_AWAY, is_chosen(u32(leaf.first), sight.object))".to_owned(),
            VolumeTest::FadingMembers => {
                "select(FAR_AWAY, -FAR_AWAY, is_fading_member(u32(leaf.first), sight.object, sight.pixel))".to_owned()
            }
            _ => format!("distance_to_shape(leaf.shape, {}, sight, border)", kind.constant()),
        };
        let _ = writeln!(text, "        case {}: {{ return {answer}; }}", kind.constant());
    }
    text + "        default: { return FAR_AWAY; }\n    }\n}\n\n"
}

/// `distance_to`, for the uber back end.
pub(super) fn distance_to(tests: &[VolumeTest], by_ray: bool) -> String {
    let head = "fn distance_to(v: u32, sight: Sight, border: vec4f) -> f32 {\n    switch shapes[v].kind {\n";
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
pub(super) fn volume_covers(tests: &[VolumeTest]) -> String {
    let body = by_number(tests, Question::Covers, "pixel");
    format!("fn volume_covers(v: u32, pixel: vec2i) -> bool {{\n{body}}}\n\n")
}
