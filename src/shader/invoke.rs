//! Invokers of the uber back end run: one handler by its number, and loops over those of a tile, for the prototypes of shading.

use std::fmt::Write as _;

use crate::shader::{
    effect::{
        definition::EffectDefinition,
        prototype::{EffectKind, Mode, Stage},
    },
    plan::uber::Uber,
    writer::{HIGHLIGHT_LEFT, HIGHLIGHTED, MATERIAL_BEGINS, MATERIAL_ENDS, OF_FIELDS, as_is, moment_here},
};

/// The handlers of the module, with their numbers.
pub(super) fn used<'a>(
    uber: &Uber,
    handlers: &'a [EffectDefinition],
) -> impl Iterator<Item = (u32, &'a EffectDefinition)> {
    let is_used = |(i, h): &(u32, &EffectDefinition)| match h.mode {
        Mode::Local => uber.effects.contains(i),
        Mode::Optional => true,
        Mode::Global => uber.haze,
        Mode::Ignore => false,
    };
    let shades = |(_, h): &(u32, &EffectDefinition)| h.kind.prototype().stage >= Stage::Visibility;
    handlers.iter().enumerate().map(|(i, h)| (i as u32, h)).filter(shades).filter(is_used)
}

/// Whether the scene may ask for an effect of this prototype.
pub(super) fn has(uber: &Uber, kind: EffectKind, handlers: &[EffectDefinition]) -> bool {
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
    let as_is = as_is(kinds[0]);
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
                let _ = writeln!(
                    text,
                    "        case {number}u: {{ {asked}{start}number_as_is(contained_opacity({call})){end} }}"
                );
                continue;
            }
            (false, _) | (_, EffectKind::Filter) => call,
            (true, EffectKind::Material) => format!("contained_material({call})"),
            (true, _) => format!("contained({call})"),
        };
        let call = match handler.kind {
            EffectKind::Scene if has(uber, EffectKind::Material, handlers) => {
                format!("{as_is}(before_sky({call}, point)) + point.highlight")
            }
            EffectKind::Scene => format!("before_sky({call}, point)"),
            _ => call,
        };
        let _ = writeln!(text, "        case {number}u: {{ above = {as_is}({call}); }}");
    }
    text.push_str("        default: {}\n    }\n");
    let is_rule = kinds[0] == EffectKind::Opacity;
    if uber.blends && !is_rule {
        let blended = match kinds[0] {
            EffectKind::Material => "blended_material(by.blend, below, above, parameters[by.weight].x)",
            _ => "weighed(below, blend(by.blend, below, above), parameters[by.weight].x)",
        };
        let _ = writeln!(text, "    if by.blend != 0u {{\n        above = {as_is}({blended});\n    }}");
    }
    if fades(uber) {
        let laid = match kinds[0] {
            EffectKind::Material => "blended_material(1u, below, above, share)",
            EffectKind::Opacity => "mix(below, above, share)",
            _ => "weighed(below, above, share)",
        };
        let _ = writeln!(text, "    if by.border != 0u {{\n        above = {as_is}({laid});\n    }}");
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
pub(super) fn each(uber: &Uber, section: &str, body: &str) -> String {
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
pub(super) fn shade(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let has = |kind| has(uber, kind, handlers);
    let share = share_argument(uber);
    let mut text = "fn shade(point: ptr<function, Point>, classes: Classes) -> vec3f {\n".to_owned();
    text.push_str(if uber.varies { moment_here(uber.partly) } else { "" });
    if has(EffectKind::Material) {
        text.push_str(MATERIAL_BEGINS);
        let call = format!("material = invoke_material(material, *point, by{share});\n");
        let of_fields = used(uber, handlers).find(|(_, h)| h.name == OF_FIELDS).map_or(u32::MAX, |(number, _)| number);
        let call = match uber.fields {
            false => call,
            true => format!("if (*point).surface != NO_SURFACE || by.handler == {of_fields}u {{\n    {call}}}\n"),
        };
        text.push_str(&each(uber, "MATERIALS", &call));
        text.push_str(MATERIAL_ENDS);
    }
    if has(EffectKind::Light) {
        text.push_str("    (*point).arriving = as_is((*point).arriving);\n");
        let call = format!("(*point).arriving = invoke_light((*point).arriving, *point, by{share});\n");
        text.push_str(&each(uber, "LIGHTS", &call));
        text.push_str("    (*point).shade = luminance((*point).arriving);\n");
    }
    let plus = if has(EffectKind::Material) {
        text.push_str(HIGHLIGHTED);
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
    text.push_str("    color = before_sky(color, *point);\n");
    text.push_str(if has(EffectKind::Material) { HIGHLIGHT_LEFT } else { "" });
    text.push_str("    return styled(color, *point, classes);\n}\n\n");
    text
}

/// Scene styles and post styles, in lens order.
pub(super) fn styled(uber: &Uber, handlers: &[EffectDefinition]) -> String {
    let has = |kind| has(uber, kind, handlers);
    if !EffectKind::ALL.iter().any(|&kind| kind.is_style() && has(kind)) {
        return "fn styled(start: vec3f, point: Point, classes: Classes) -> vec3f {\n    return start;\n}\n\n"
            .to_owned();
    }
    let share = share_argument(uber);
    let body = format!(
        "if by.kind != 1u || point.surface != NO_SURFACE {{
    color = invoke_style(color, point, by{share});
}}
"
    );
    let text = "fn styled(start: vec3f, point: Point, classes: Classes) -> vec3f {\n    var color = as_is(start);\n"
        .to_owned();
    text + &each(uber, "STYLES", &body) + "    return color;\n}\n\n"
}
