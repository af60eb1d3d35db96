//! Bodies of lenses and what else is laid over the shaded picture, on the specialised back end: `outlines` and what it calls.

use std::fmt::Write as _;

use crate::shader::{
    lens_test,
    library::{File, HALO, SHELL, SILHOUETTE},
    plan::{
        Plan,
        lens::{BodyKind, PlanBody},
    },
    wgsl::function::bound,
};

/// Layers over the shaded picture and below the bodies of lenses: lines of the city, and translucent layers over these.
const WITH_LINES: &str = "    paint = paint_as_is(with_lines(paint, pixel));\n";
const WITH_TRANSPARENCY: &str = "    paint = paint_as_is(with_transparency(paint, pixel));\n";

/// The lenses' bodies.
pub(super) fn outlines(plan: &Plan) -> String {
    let bodies: Vec<(usize, PlanBody)> =
        plan.lenses.iter().enumerate().filter_map(|(i, l)| l.body.map(|body| (i, body))).collect();
    let mut text: String = bodies.iter().map(|(i, body)| body_functions(plan, *i, body.kind)).collect();
    text.push_str("fn outlines(start: vec4f, pixel: vec2i, classes: Classes) -> vec4f {\n");
    if bodies.is_empty() && !plan.lines && !plan.transparency {
        text.push_str("    return start;\n}\n\n");
        return text;
    }
    text.push_str("    var paint = paint_as_is(start);\n");
    let over = [(plan.lines, WITH_LINES), (plan.transparency, WITH_TRANSPARENCY)];
    over.iter().filter(|(is_drawn, _)| *is_drawn).for_each(|(_, laid)| text.push_str(laid));
    for (i, PlanBody { kind, parameters }) in bodies {
        let is_convex = plan.is_convex(i as u32);
        let (color, width) = (format!("parameters[{parameters}]"), format!("parameters[{}].x", parameters + 1));
        match kind {
            BodyKind::Halo => {
                let _ = writeln!(text, "    paint = paint_as_is(halo_{i}(paint, pixel, {color}, {width}));");
                continue;
            }
            BodyKind::Shell => {
                let _ = writeln!(text, "    paint = paint_as_is(shell_{i}(paint, pixel, {color}));");
            }
            BodyKind::Outline => {}
        }
        let _ = writeln!(
            text,
            "    paint = paint_as_is(outlined(paint, silhouette_{i}(pixel, {width}, {is_convex}), {color}));"
        );
    }
    text.push_str("    return paint;\n}\n\n");
    text
}

/// Functions that the body of a lens calls: which pixels it covers, where a ray meets it, how far a place is from it. Each lens has its own: a
/// compiler takes its time over a function that asks for the lens.
fn body_functions(plan: &Plan, i: usize, kind: BodyKind) -> String {
    let lens = i as u32;
    let of_this = |name: &str| match name.strip_prefix("lens_") {
        Some(question) => format!("lens_{i}_{question}"),
        None => format!("{name}_{i}"),
    };
    let own = |file: &File, names: &[&'static str]| {
        let names: Vec<_> = names.iter().map(|name| (*name, of_this(name))).collect();
        file.changed(|text| bound(text, "lens", &names)) + "\n"
    };
    let answer = |head: &str, value: &str| format!("fn lens_{i}_{head} {{\n    return {value};\n}}\n\n");
    let mut text = answer("covers(pixel: vec2i) -> bool", &lens_test::covers(plan, lens, "pixel"));
    if kind.has_outline() {
        let is_clear = lens_test::is_clear(plan, lens, "pixel, reach");
        text.push_str(&answer("is_clear(pixel: vec2i, reach: i32) -> bool", &is_clear));
        text.push_str(&own(&SILHOUETTE, &["lens_covers", "lens_is_clear", "silhouette"]));
    }
    if kind != BodyKind::Outline {
        let distance = lens_test::distance_in_space(plan, lens, "vec4f(2.0 * reach, 0.0, 0.0, 0.0)");
        text.push_str(&answer("distance(sight: Sight, reach: f32) -> f32", &distance));
    }
    if kind == BodyKind::Shell {
        text.push_str(&answer("ends(pixel: vec2i, ray: Ray) -> Span", &lens_test::ends_of(plan, lens)));
        text.push_str(&own(&SHELL, &["lens_normal", "lens_distance", "lens_ends", "shell"]));
    }
    if kind == BodyKind::Halo {
        text.push_str(&own(&HALO, &["lens_covers", "lens_distance", "halo"]));
    }
    text
}
