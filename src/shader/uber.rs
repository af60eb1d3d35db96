//! The uber back end (Trapp §3.7): every handler the scene may ask for in one module; which of them run, where, and with which
//! parameters stands in the invoker table, a uniform. Whatever lenses do, nothing is compiled.

use std::fmt::Write as _;

use crate::shader::{
    effect::{definition::EffectDefinition, prototype::EffectKind},
    epochs::{self, OF_LAYER},
    hiding,
    invoke::{each, fades, invoke, shade, share_argument, styled, used},
    lens_test,
    library::{
        HALO, INVOKER_CLASSES, LENS_CLEAR, LENS_COVERS, LENS_DISTANCE, LENS_ENDS, NO_CLASSES, SHARE_AT_INVOKER,
        SHARE_OF_INVOKER, SHELL, SILHOUETTE, TILE_INVOKERS,
    },
    masks,
    plan::{lens::BodyKind, program::Program, uber::Uber},
    shading::Shading,
    table::{self, MOST_SLOTS},
    writer::{KEPT_END, kept_head, opacity_end, presence_of_field},
};

/// `shade`, `styled`, `outlines`, `write_classes` and what they call, for `pass/shade.wgsl`.
pub(super) fn source(uber: &Uber, handlers: &[EffectDefinition], shading: &Shading) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "@group(2) @binding(2) var<uniform> parameters: array<vec4f, {MOST_SLOTS}>;");
    text.push_str(&lens_test::bindings(&Program::Uber(uber.clone()), false));
    if uber.masks {
        text.push_str(masks::BINDING);
    }
    text.push('\n');
    for (_, effect) in used(uber, handlers).filter(|(_, h)| h.kind != EffectKind::Filter) {
        let _ = write!(text, "// ==== effect {}\n\n{}\n\n", effect.name, effect.source.trim_end());
    }
    text.push_str(&table::declared());
    text.push_str(&classes(uber));
    text.push_str(&TILE_INVOKERS.paragraph());
    text.push_str(&if uber.varies { moments(uber, handlers) } else { String::new() });
    text.push_str(epochs::is_lit_here(uber.lit));
    text.push_str(&invoke(uber, "material", &[EffectKind::Material], handlers));
    text.push_str(&invoke(uber, "light", &[EffectKind::Light], handlers));
    text.push_str(&invoke(uber, "style", &[EffectKind::Scene, EffectKind::Post, EffectKind::Filter], handlers));
    text.push_str(&shade(uber, handlers));
    text.push_str(&styled(uber, handlers));
    let parts = Program::Uber(uber.clone()).has();
    if parts.bodies {
        text.push_str(&(lens_test::volume_covers(&uber.tests) + &LENS_COVERS.paragraph()));
    }
    if parts.outlines {
        text.push_str(&(lens_test::volume_is_clear(&uber.tests) + &LENS_CLEAR.paragraph() + &SILHOUETTE.paragraph()));
    }
    if parts.shells || parts.halos {
        text.push_str(&LENS_DISTANCE.paragraph());
    }
    if parts.shells {
        text.push_str(&lens_test::ends_of_volume(&uber.tests));
        text.push_str(&(LENS_ENDS.paragraph() + &SHELL.paragraph()));
    }
    if parts.halos {
        text.push_str(&HALO.paragraph());
    }
    text.push_str(&outlines(uber));
    text.push_str("fn write_classes(pixel: vec2i, point: Point, classes: Classes) {\n");
    if uber.masks && !uber.tests.is_empty() {
        if shading.is_of_surfaces {
            text.push_str(masks::ONLY_SHOWN);
        }
        if uber.transparency {
            text.push_str(&masks::not_through_layers("table.tiles.w != 0u && "));
        }
        text.push_str(WRITE_CLASSES);
    }
    text.push_str("}\n");
    text
}

/// Which moment shows at a layer, or at what is shaded, and how much of it is there.
fn moments(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let runs = if fades(uber) { "is_layer_there(by, point, classes)" } else { "runs(by, classes)" };
    let there = if fades(uber) { IS_LAYER_THERE } else { "" };
    epochs::operators(&Program::Uber(uber.clone()), handlers) + there + &epochs::uber(uber, handlers, &OF_LAYER, runs)
}

/// `opacity_at`, for `pass/composite.wgsl`.
pub(super) fn opacity(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let head = "fn opacity_at(point: Point, classes: Classes) -> f32 {\n    var opacity = 1.0;\n";
    // Where looks change over time, shading has it already.
    let mut text = if uber.partly && !uber.varies { moments(uber, handlers) } else { String::new() };
    let end = opacity_end(uber.clear_materials, uber.partly);
    // Of materials alone there are no rules.
    if !used(uber, handlers).any(|(_, h)| h.kind == EffectKind::Opacity) {
        return text + head + &end;
    }
    text.push_str(&(invoke(uber, "opacity", &[EffectKind::Opacity], handlers) + head));
    let share = share_argument(uber);
    text.push_str(&each(uber, "OPACITIES", &format!("opacity = invoke_opacity(opacity, point, by{share});\n")));
    text + &end
}

/// `kept_of_field`, for the fields of `pass/composite.wgsl`.
pub(super) fn kept(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let has = |kind| used(uber, handlers).any(|(_, h)| h.kind == kind);
    let hides = has(EffectKind::Hide);
    let is_cut = hides || has(EffectKind::Opacity) || uber.varies;
    let head = presence_of_field(uber.varies, uber.partly) + &kept_head(is_cut);
    if !hides {
        return head + KEPT_END;
    }
    let mut text = "fn hides_field(fragment: Fragment, by: Invoker) -> bool {\n    switch by.handler {\n".to_owned();
    for (number, handler) in used(uber, handlers).filter(|(_, h)| h.kind == EffectKind::Hide) {
        let call = hiding::call(handler, "by.parameters");
        let _ = writeln!(text, "        case {number}u: {{ return {call}; }}");
    }
    text.push_str("        default: { return false; }\n    }\n}\n\n");
    let share = if fades(uber) { "share_at(by, classes)" } else { "select(0.0, 1.0, runs(by, classes))" };
    text + &head + &kept_by_invokers(share) + KEPT_END
}

/// `by.kind` is 2 for opacity rules.
fn kept_by_invokers(share: &str) -> String {
    format!(
        "    let range = table.ranges.xy;
    for (var i = range.x; i < range.y; i++) {{
        let by = invoker(i);
        if by.kind != 2u && hides_field(fragment, by) {{
            kept *= 1.0 - {share};
        }}
        if i + 1u == range.y {{
            break;
        }}
    }}
"
    )
}

/// Whether something is there at a layer that cannot be had by halves, where lenses fade.
const IS_LAYER_THERE: &str = "fn is_layer_there(by: Invoker, point: Point, classes: Classes) -> bool {
    if by.border != 0u && parameters[by.border - 1u].z > 0.5 {
        return is_dithered(share_at(by, classes), point.pixel);
    }
    return runs(by, classes);
}

";

/// Which classes a place has, and which invokers run there.
pub(super) fn classes(uber: &Uber) -> String {
    match uber.tests.is_empty() {
        true => NO_CLASSES.paragraph(),
        false => {
            let tests = &uber.tests;
            let has_distances = Program::Uber(uber.clone()).has().distances;
            let distances = if has_distances { lens_test::distance_to(tests, uber.by_ray) } else { String::new() };
            let shares =
                if uber.borders { SHARE_OF_INVOKER.paragraph() + &SHARE_AT_INVOKER.paragraph() } else { String::new() };
            lens_test::class_of(uber) + &distances + &INVOKER_CLASSES.paragraph() + &shares
        }
    }
}

/// Where nothing is drawn in lines or seen through in a frame, lines and layers are those of another.
const WITH_LINES: &str =
    "    if table.ranges.z < table.ranges.w {\n        paint = paint_as_is(with_lines(paint, pixel));\n    }\n";
const WITH_TRANSPARENCY: &str =
    "    if table.tiles.w != 0u {\n        paint = paint_as_is(with_transparency(paint, pixel));\n    }\n";

/// `outlines`: lines, layers and the bodies of lenses over the shaded picture; `by.handler` is the kind of a body, and `by.kind` is 1 of
/// a convex one.
fn outlines(uber: &Uber) -> String {
    let over = [(uber.lines, WITH_LINES), (uber.transparency, WITH_TRANSPARENCY)];
    let over: String = over.iter().filter(|(is_drawn, _)| *is_drawn).map(|(_, laid)| *laid).collect();
    let head =
        "fn outlines(start: vec4f, pixel: vec2i, classes: Classes) -> vec4f {\n    var paint = paint_as_is(start);\n";
    if uber.bodies.is_empty() {
        return format!("{head}{over}    return paint;\n}}\n\n");
    }
    let mut text = format!(
        "{head}{over}    let run = invokers_of(classes, OUTLINES);
    for (var k = run.x; k < run.y; k += ENTRY) {{
        let lens = tile_lists[k + 2u];
        let by = listed(k);
        let color = parameters[by.parameters];
        let width = parameters[by.parameters + 1u].x;
"
    );
    for kind in &uber.bodies {
        let drawn = match kind {
            BodyKind::Outline => "",
            BodyKind::Shell => "            paint = paint_as_is(shell(lens, paint, pixel, color));\n",
            BodyKind::Halo => "            paint = paint_as_is(halo(lens, paint, pixel, color, width));\n",
        };
        let line =
            "            paint = paint_as_is(outlined(paint, silhouette(lens, pixel, width, by.kind == 1u), color));\n";
        let line = if kind.has_outline() { line } else { "" };
        let _ = write!(text, "        if by.handler == {}u {{\n{drawn}{line}        }}\n", kind.number());
    }
    text + "        if k + ENTRY == run.y {\n            break;\n        }\n    }\n    return paint;\n}\n\n"
}

const WRITE_CLASSES: &str = "    var bits = vec3u(0u);
    let run = invokers_of(classes, MASKS);
    for (var k = run.x; k < run.y; k += ENTRY) {
        let by = listed(k);
        let all = classes_of(by, classes);
        bits |= select(vec3u(0u), vec3u(1u << (by.number % 32u)), (vec3u(all) & vec3u(INSIDE, FRONT, BEHIND)) != vec3u(0u));
        let layer = i32(by.number / 32u) * 3;
        if k + ENTRY == run.y || listed(k + ENTRY).number / 32u != by.number / 32u {
            textureStore(class_masks, pixel, layer, vec4u(bits.x, 0u, 0u, 0u));
            textureStore(class_masks, pixel, layer + 1, vec4u(bits.y, 0u, 0u, 0u));
            textureStore(class_masks, pixel, layer + 2, vec4u(bits.z, 0u, 0u, 0u));
            bits = vec3u(0u);
        }
        if k + ENTRY == run.y {
            break;
        }
    }
";
