//! Region tests of users written out: what the tests of lenses ask of their handlers.

use crate::shader::effect::{definition::EffectDefinition, registry::handlers};

/// What the functions about a handler's region are called: `NAME_holds`, `span_of_NAME`, `distance_to_NAME`, `class_of_NAME`.
pub(super) fn name(handler: u32) -> String {
    name_of(&handlers()[handler as usize])
}

fn name_of(definition: &EffectDefinition) -> String {
    format!("own_{}", definition.wgsl_name())
}

/// The functions about the region of a handler, over `shape/own.wgsl`.
pub(super) fn functions(handler: u32) -> String {
    of_handler(&handlers()[handler as usize])
}

/// The same of a definition.
pub(super) fn of_handler(definition: &EffectDefinition) -> String {
    // No name of the handler's own begins so.
    let (name, away) = (name_of(definition), format!("away_from_{}", definition.wgsl_name()));
    let parameters = match definition.slots() {
        0 => String::new(),
        _ => format!(", {}(s.first + 1u)", definition.own("parameters")),
    };
    format!(
        "{source}
// How far a place is from it, metres, negative inside.
fn {away}(s: OwnRegion, position: vec3f) -> f32 {{
    let place = in_own(s, position - s.center);
    let half = planes[s.first].xyz;
    return contained_distance({own}(place, 2.0 * half{parameters}), place, half);
}}

fn {name}_holds(s: OwnRegion, sight: Sight) -> bool {{
    return {away}(s, sight.position) <= face_slack(s.center, sight);
}}

fn distance_to_{name}(s: OwnRegion, sight: Sight, border: vec4f) -> f32 {{
    return {away}(s, sight.position);
}}

// From where a ray enters first to where it leaves last.
fn span_of_{name}(ray: Ray, s: OwnRegion) -> Span {{
    let whole = span_of_own_box(ray, s);
    if whole.enter > whole.exit {{
        return EMPTY_SPAN;
    }}
    let half = planes[s.first].xyz;
    let exact = OWN_EXACT * max(half.x, max(half.y, half.z));
    let speed = length(ray.direction);
    var ends = array<f32, 2>(whole.enter, whole.exit);
    for (var end = 0; end < 2; end++) {{
        let way = select(1.0, -1.0, end == 1) / speed;
        var at = ends[end];
        var free = {away}(s, ray.origin + at * ray.direction);
        var is_in_box = true;
        for (var i = 0; i < OWN_STEPS && free > exact && is_in_box; i++) {{
            at += way * free;
            is_in_box = at >= whole.enter && at <= whole.exit;
            free = {away}(s, ray.origin + at * ray.direction);
        }}
        ends[end] = at;
        // A ray that grazes it runs out of steps before it is there.
        if free > OWN_NEAR * exact || !is_in_box {{
            return EMPTY_SPAN;
        }}
    }}
    return Span(ends[0], max(ends[0], ends[1]));
}}

fn class_of_{name}(s: OwnRegion, sight: Sight) -> u32 {{
    let is_inside = sight.distance < FAR_AWAY && {name}_holds(s, sight);
    return class_of_own(span_of_{name}(sight.ray, s), is_inside, sight);
}}

",
        source = definition.source,
        own = definition.wgsl_name(),
    )
}
