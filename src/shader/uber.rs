//! The uber back end (H3): every handler the scene may ask for in one module; which of them run, where, and with which
//! parameters stands in the invoker table (H2), a uniform. Whatever lenses do, nothing is compiled.

use std::{fmt::Write as _, sync::LazyLock};

use crate::shader::{
    effect::{EffectDefinition, EffectKind, Mode},
    lens_test,
    library::{HALO, SHELL, SILHOUETTE},
    masks,
    plan::{BodyKind, Program, Uber},
    shading::Shading,
};

/// Side of the tiles that have lists of invokers, pixels.
pub const TILE_PX: u32 = 32;
/// Volumes of a picture: a uniform of 64 KiB holds more than so many.
pub const MOST_VOLUMES: u32 = 1024;
/// `vec4f` of parameters of a picture: such a uniform full.
pub const MOST_SLOTS: u32 = 4096;

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
    text.push_str(&TABLE_SOURCE);
    text.push_str(&classes(uber));
    text.push_str(TILES);
    text.push_str(&invoke(uber, "material", &[EffectKind::Material], handlers));
    text.push_str(&invoke(uber, "light", &[EffectKind::Light], handlers));
    text.push_str(&invoke(uber, "style", &[EffectKind::Scene, EffectKind::Post, EffectKind::Filter], handlers));
    text.push_str(&shade(uber, handlers));
    text.push_str(&styled(uber, handlers));
    let parts = Program::Uber(uber.clone()).has();
    if parts.bodies {
        text.push_str(&(lens_test::volume_covers(&uber.tests) + LENS_COVERS));
    }
    if parts.outlines {
        let _ = writeln!(text, "{}", SILHOUETTE.text);
    }
    if parts.shells || parts.halos {
        text.push_str(LENS_DISTANCE);
    }
    if parts.shells {
        text.push_str(&lens_test::ends_of_volume(&uber.tests));
        let _ = writeln!(text, "{LENS_ENDS}{}", SHELL.text);
    }
    if parts.halos {
        let _ = writeln!(text, "{}", HALO.text);
    }
    text.push_str(&outlines(uber));
    text.push_str("fn write_classes(pixel: vec2i, point: Point, classes: Classes) {\n");
    if uber.masks && !uber.tests.is_empty() {
        if shading.is_of_surfaces {
            text.push_str(masks::ONLY_SHOWN);
        }
        if uber.veils {
            text.push_str(&masks::not_through_layers("table.tiles.w != 0u && "));
        }
        text.push_str(WRITE_CLASSES);
    }
    text.push_str("}\n");
    text
}

/// `opacity_at`, for `pass/composite.wgsl`.
pub(super) fn opacity(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let mut text = invoke(uber, "opacity", &[EffectKind::Opacity], handlers);
    text.push_str("fn opacity_at(point: Point, classes: Classes) -> f32 {\n    var opacity = 1.0;\n");
    let share = share_argument(uber);
    text.push_str(&each(uber, "OPACITIES", &format!("opacity = invoke_opacity(opacity, point, by{share});\n")));
    text + "    return opacity;\n}\n"
}

/// Where nothing is drawn in lines or seen through in a frame, lines and layers are those of another.
const WITH_LINES: &str = "    if table.ranges.z < table.ranges.w {\n        paint = with_lines(paint, pixel);\n    }\n";
const WITH_VEIL: &str = "    if table.tiles.w != 0u {\n        paint = with_veil(paint, pixel);\n    }\n";

/// Which classes a place has, and which invokers run there.
pub(super) fn classes(uber: &Uber) -> String {
    match uber.tests.is_empty() {
        true => NO_CLASSES.to_owned(),
        false => {
            let tests = &uber.tests;
            let has_distances = Program::Uber(uber.clone()).has().distances;
            let distances = if has_distances { lens_test::distance_to(tests, uber.by_ray) } else { String::new() };
            let shares = if uber.borders { [SHARE_OF, SHARE_AT].concat() } else { String::new() };
            lens_test::class_of(uber) + &distances + CLASSES + &shares
        }
    }
}

/// The handlers of the module, with their numbers.
fn used<'a>(uber: &Uber, handlers: &'a [EffectDefinition]) -> impl Iterator<Item = (u32, &'a EffectDefinition)> {
    let is_used = |(i, h): &(u32, &EffectDefinition)| match h.mode {
        Mode::Local => uber.effects.contains(i),
        Mode::Optional => true,
        Mode::Global => uber.haze,
        Mode::Ignore => false,
    };
    handlers.iter().enumerate().map(|(i, h)| (i as u32, h)).filter(is_used)
}

/// Whether the scene may ask for an effect of this prototype.
fn has(uber: &Uber, kind: EffectKind, handlers: &[EffectDefinition]) -> bool {
    used(uber, handlers).any(|(_, h)| h.kind == kind && h.mode == Mode::Local)
}

/// One handler of a prototype by its number, laid over what is below as its invoker says. Scene styles and post styles
/// are one list.
pub(super) fn invoke(uber: &Uber, word: &str, kinds: &[EffectKind], handlers: &[EffectDefinition]) -> String {
    if !kinds.iter().any(|&kind| has(uber, kind, handlers)) {
        return String::new();
    }
    let (_, type_name) = kinds[0].subject();
    let share = if fades(uber) { ", share: f32" } else { "" };
    let mut text = format!(
        "fn invoke_{word}(below: {type_name}, point: Point, by: Invoker{share}) -> {type_name} {{\n    var above = below;\n    switch \
         by.handler {{\n"
    );
    let is_one = |h: &EffectDefinition| kinds.contains(&h.kind) && h.mode == Mode::Local;
    for (number, handler) in used(uber, handlers).filter(|(_, h)| is_one(h)) {
        let name = handler.wgsl_name();
        let own = match handler.slots() {
            0 => String::new(),
            _ => format!(", {}(by.parameters)", handler.own("parameters")),
        };
        let call = match handler.kind {
            EffectKind::Filter => "filtered_at(by.parameters, point)".to_owned(),
            _ => format!("{name}(below, point{own})"),
        };
        let call = match (handler.is_users, handler.kind) {
            (_, EffectKind::Opacity) => {
                let asked = handler.acts_on("point", "by.parameters");
                let asked = asked.map_or_else(String::new, |asked| format!("if {asked} {{ above = "));
                let end = if asked.is_empty() { "" } else { "; }" };
                let start = if asked.is_empty() { "above = " } else { "" };
                let _ = writeln!(text, "        case {number}u: {{ {asked}{start}contained_opacity({call}){end} }}");
                continue;
            }
            (false, _) | (_, EffectKind::Filter) => call,
            (true, EffectKind::Material) => format!("contained_material({call})"),
            (true, _) => format!("contained({call})"),
        };
        let _ = writeln!(text, "        case {number}u: {{ above = {call}; }}");
    }
    text.push_str("        default: {}\n    }\n");
    let is_rule = kinds[0] == EffectKind::Opacity;
    if uber.blends && !is_rule {
        let blended = match kinds[0] {
            EffectKind::Material => "blended_material(by.blend, below, above, parameters[by.weight].x)",
            _ => "weighed(below, blend(by.blend, below, above), parameters[by.weight].x)",
        };
        let _ = writeln!(text, "    if by.blend != 0u {{\n        above = {blended};\n    }}");
    }
    if fades(uber) {
        let laid = match kinds[0] {
            EffectKind::Material => "blended_material(1u, below, above, share)",
            EffectKind::Opacity => "mix(below, above, share)",
            _ => "weighed(below, above, share)",
        };
        let _ = writeln!(text, "    if by.border != 0u {{\n        above = {laid};\n    }}");
    }
    text.push_str("    return above;\n}\n\n");
    text
}

/// Whether some of the scene's lenses may fade.
pub(super) fn fades(uber: &Uber) -> bool {
    uber.borders && !uber.tests.is_empty()
}

/// The last argument of calls of what an invoker asks for: where lenses fade they say how much of it there is.
pub(super) fn share_argument(uber: &Uber) -> &'static str {
    if fades(uber) { ", share" } else { "" }
}

/// A loop over the invokers of a section of the tile's list that run at a place, in their order; `body`: what is done with each, `by`.
///
/// In two steps, for adapters that take many pixels at a time and go through whatever one of them may do: as often as there are entries
/// in the list it is asked whether they run, but only as often as some run are handlers called. Where lenses fade it is one step, and
/// each has its `share`: how much is left over from asking, and of it Mesa 22.3 makes something else at some pixels. Loops here leave at
/// the end of their last round: such an adapter goes through a whole round to find that there is none.
fn each(uber: &Uber, section: &str, body: &str) -> String {
    let list = format!("of_{}", section.to_lowercase());
    let body: String = body.lines().map(|line| format!("{:1$}{line}\n", "", 12)).collect();
    if fades(uber) {
        return format!(
            "    let {list} = invokers_of(classes, {section});
    for (var k = {list}.x; k < {list}.y; k += ENTRY) {{
        let by = listed(k);
        let share = share_at(by, classes);
        if share > 0.0 {{
{body}        }}
        if k + ENTRY == {list}.y {{
            break;
        }}
    }}
"
        );
    }
    format!(
        "    let {list} = invokers_of(classes, {section});
    for (var first = {list}.x; first < {list}.y; first += 32u * ENTRY) {{
        var left = running(first, min(first + 32u * ENTRY, {list}.y), classes);
        while left != 0u {{
            let by = listed(first + ENTRY * firstTrailingBit(left));
{body}            left &= left - 1u;
            if left == 0u {{
                break;
            }}
        }}
        if first + 32u * ENTRY >= {list}.y {{
            break;
        }}
    }}
"
    )
}

/// From the surface to its colour: material, light, the standard style and air, then the styles.
fn shade(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let has = |kind| has(uber, kind, handlers);
    let share = share_argument(uber);
    let mut text = "fn shade(point: ptr<function, Point>, classes: Classes) -> vec3f {\n".to_owned();
    if has(EffectKind::Material) {
        text.push_str("    var material = Material((*point).base, vec3f(0.0), vec3f(0.0), 32.0);\n");
        let call = format!("material = invoke_material(material, *point, by{share});\n");
        text.push_str(&each(uber, "MATERIALS", &call));
        text.push_str("    (*point).base = material.base;\n");
    }
    if has(EffectKind::Light) {
        let call = format!("(*point).arriving = invoke_light((*point).arriving, *point, by{share});\n");
        text.push_str(&each(uber, "LIGHTS", &call));
        text.push_str("    (*point).shade = luminance((*point).arriving);\n");
    }
    let plus = if has(EffectKind::Material) {
        text.push_str("    (*point).highlight = highlights(material, *point);\n");
        " + (*point).highlight"
    } else {
        ""
    };
    text.push_str("    var color = vec3f(0.0);\n");
    let own = |kind, mode| handlers.iter().find(move |h| h.kind == kind && h.mode == mode);
    if let Some(standard) = own(EffectKind::Scene, Mode::Optional) {
        let _ = writeln!(text, "    color = {}(color, *point){plus};", standard.wgsl_name());
    }
    if let Some(air) = own(EffectKind::Air, Mode::Global).filter(|_| uber.haze) {
        let _ = writeln!(text, "    color = {}(color, *point);", air.wgsl_name());
    }
    text.push_str("    return styled(color, *point, classes);\n}\n\n");
    text
}

/// Scene styles and post styles, in lens order.
fn styled(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let has = |kind| has(uber, kind, handlers);
    if !EffectKind::ALL.iter().any(|&kind| kind.is_style() && has(kind)) {
        return "fn styled(start: vec3f, point: Point, classes: Classes) -> vec3f {\n    return start;\n}\n\n"
            .to_owned();
    }
    let highlight = match has(EffectKind::Material) {
        true if fades(uber) => "        color += point.highlight * share;\n",
        true => "        color += point.highlight;\n",
        false => "",
    };
    let share = share_argument(uber);
    let body = format!(
        "let is_scene_style = by.kind == 1u;
if !is_scene_style || point.surface != NO_SURFACE {{
    color = invoke_style(color, point, by{share});
    if is_scene_style {{
{highlight}    }}
}}
"
    );
    let text =
        "fn styled(start: vec3f, point: Point, classes: Classes) -> vec3f {\n    var color = start;\n".to_owned();
    text + &each(uber, "STYLES", &body) + "    return color;\n}\n\n"
}

/// The table, declared.
pub(super) static TABLE_SOURCE: LazyLock<String> =
    LazyLock::new(|| format!("{TABLE}const TILE_PX: u32 = {TILE_PX}u;\n\n"));

/// As `render::layout` lays it out.
const TABLE: &str = "// ==== the invoker table

struct Invoker {
    handler: u32,               // its number
    scope: u32,                 // 0 everywhere, 1 inside, 2 in front, 3 behind, 4 rest
    first_volume: u32,          // of its lens
    volumes: u32,
    parameters: u32,            // its first slot
    blend: u32,                 // 0 replaces
    weight: u32,                // slot of its weight, if blended
    kind: u32,                  // 1 = a style for surfaces alone, 2 = an opacity rule
    number: u32,                // of a lens: its bit in the masks
    border: u32,                // of a lens that fades: the slot after that of its border; 0 else
}

// One as it is kept: a software adapter takes long for each word that it reads.
struct PackedInvoker {
    place: u32,                 // scope: 3 bits, first_volume: 11, volumes: 11
    call: u32,                  // handler: 13 bits, parameters: 13, blend: 3, kind: 3
    slots: u32,                 // weight, border: 16 bits each
    number: u32,
}

struct InvokerTable {
    ranges: vec4u,              // from up to (not included): what hides; what lines go through
    tiles: vec4u,               // x: tiles of the picture in a row; y, z: contents of lenses, from up to; w: 1 where there are layers
}

// A uniform, as it always was: with none at this place Mesa 22.3 takes others for each other, and crashes.
@group(2) @binding(5) var<uniform> table: InvokerTable;
@group(2) @binding(9) var<storage, read> invokers: array<PackedInvoker>;

fn unpacked_invoker(kept: PackedInvoker) -> Invoker {
    return Invoker(
        kept.call & 8191u, kept.place & 7u, (kept.place >> 3u) & 2047u, kept.place >> 14u, (kept.call >> 13u) & 8191u,
        (kept.call >> 26u) & 7u, kept.slots & 65535u, kept.call >> 29u, kept.number, kept.slots >> 16u);
}

fn invoker(i: u32) -> Invoker {
    return unpacked_invoker(invokers[i]);
}

";

/// Which invokers may run at a pixel, for shading (L8): those of the lenses that its tile may show. Sections in their order.
const TILES: &str = "// Per tile seven places: where its invokers of each section begin, and where the last end; first those outside of all lenses. Then the
// invokers, three words each: place and call, which most is asked of, and the number in the table.
@group(2) @binding(8) var<storage, read> tile_lists: array<u32>;

const OPACITIES: u32 = 0u;
const MATERIALS: u32 = 1u;
const LIGHTS: u32 = 2u;
const STYLES: u32 = 3u;
const OUTLINES: u32 = 4u;
const MASKS: u32 = 5u;
const ENTRY: u32 = 3u;          // words

fn invokers_of(classes: Classes, section: u32) -> vec2u {
    let record = 7u * tile_of(classes) + section;
    return vec2u(tile_lists[record], tile_lists[record + 1u]);
}

fn listed(at: u32) -> Invoker {
    let others = invokers[tile_lists[at + 2u]];
    return unpacked_invoker(PackedInvoker(tile_lists[at], tile_lists[at + 1u], others.slots, others.number));
}

// Which of the invokers from `first` up to `end` of the lists, at most 32, run at a place: a bit for each.
fn running(first: u32, end: u32, classes: Classes) -> u32 {
    var bits = 0u;
    var bit = 1u;
    for (var k = first; k < end; k += ENTRY) {
        bits |= select(0u, bit, runs(listed(k), classes));
        bit <<= 1u;
        if k + ENTRY == end {
            break;
        }
    }
    return bits;
}

";

const NO_CLASSES: &str = "struct Classes {
    part: u32,
}

fn classes_at(sight: Sight, part: u32) -> Classes {
    return Classes(part);
}

fn tile_of(classes: Classes) -> u32 {
    return 0u;
}

fn runs(by: Invoker, classes: Classes) -> bool {
    return by.scope == 0u;
}

";

const CLASSES: &str = "struct Classes {
    part: u32,
    sight: Sight,
}

fn classes_at(sight: Sight, part: u32) -> Classes {
    return Classes(part, sight);
}

fn tile_of(classes: Classes) -> u32 {
    let at = vec2u(classes.sight.pixel) / TILE_PX;
    return select(1u + at.y * table.tiles.x + at.x, 0u, classes.part == 0u);
}

fn classes_of(by: Invoker, classes: Classes) -> u32 {
    var all = MISSED;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        all |= class_of(v, classes.sight);
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return all;
}

fn runs(by: Invoker, classes: Classes) -> bool {
    if by.scope == 0u {
        return true;
    }
    let all = classes_of(by, classes);
    switch by.scope {
        case 1u: { return is_inside(all); }
        case 2u: { return is_in_front(all); }
        case 3u: { return is_behind(all); }
        default: { return is_rest(all); }
    }
}

";

/// How much of an invoker a place has that has these classes.
pub(super) const SHARE_OF: &str = "fn share_of(by: Invoker, all: u32, sight: Sight) -> f32 {
    if by.border == 0u {
        return 1.0;
    }
    let border = parameters[by.border - 1u];
    var distance = FAR_AWAY;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        distance = min(distance, distance_to(v, sight, border));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    let interest = degree_of_interest(distance, border, sight);
    switch by.scope {
        case 1u: { return share_inside(all, interest); }
        case 2u: { return share_front(all, interest); }
        case 3u: { return share_behind(all, interest); }
        default: { return share_rest(all, interest); }
    }
}

";

const SHARE_AT: &str = "fn share_at(by: Invoker, classes: Classes) -> f32 {
    if by.scope == 0u || by.border == 0u {
        return select(0.0, 1.0, runs(by, classes));
    }
    return share_of(by, classes_of(by, classes), classes.sight);
}

";

const LENS_COVERS: &str = "fn lens_covers(lens: u32, pixel: vec2i) -> bool {
    let by = invoker(lens);
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        if volume_covers(v, pixel) {
            return true;
        }
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return false;
}

";

const LENS_DISTANCE: &str = "fn lens_distance(lens: u32, sight: Sight) -> f32 {
    let by = invoker(lens);
    var distance = FAR_AWAY;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        distance = min(distance, distance_to(v, sight, vec4f(0.0)));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return distance;
}

";

const LENS_ENDS: &str = "fn lens_ends(lens: u32, pixel: vec2i, ray: Ray) -> Span {
    let by = invoker(lens);
    var ends = EMPTY_SPAN;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        ends = with_span(ends, ends_of_volume(v, pixel, ray));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return ends;
}

";

/// What is laid over the shaded picture: lines, layers, and the bodies of lenses; `by.handler` says of which kind a body is.
fn outlines(uber: &Uber) -> String {
    let over = [(uber.lines, WITH_LINES), (uber.veils, WITH_VEIL)];
    let over: String = over.iter().filter(|(is_drawn, _)| *is_drawn).map(|(_, laid)| *laid).collect();
    let head = "fn outlines(start: vec4f, pixel: vec2i, classes: Classes) -> vec4f {\n    var paint = start;\n";
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
            BodyKind::Shell => "            paint = shell(lens, paint, pixel, color);\n",
            BodyKind::Halo => "            paint = halo(lens, paint, pixel, color, width);\n",
        };
        let line = "            paint = outlined(paint, silhouette(lens, pixel, width), color);\n";
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
