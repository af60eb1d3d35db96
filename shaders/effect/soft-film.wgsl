//! name = "soft-film"
//! kind = "opacity"
//! spec = "Trapp §3.3"
//! doc = "As `film`, but clear at the rim of what each object covers of the ground, seen from above, and denser towards its middle."
//! objects = "footprints"
//!
//! [[parameter]]
//! name = "opacity"
//! type = "number"
//! range = [0, 1]
//! default = 0.9
//! doc = "Of the film well inside: 0 = nothing of it is seen, 1 = nothing of the ground."
//!
//! [[parameter]]
//! name = "soft"
//! type = "number"
//! range = [0, 1]
//! default = 0.7
//! doc = "How wide the rim is, as a share of the footprint's area divided by the length of its outline, but two pixels at least; 0 = no rim."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay opaque."

fn effect(opacity: f32, point: Point, p: Parameters) -> f32 {
    let number = point.object - object_values[p.first];
    if point.is_covered || number >= object_values[p.first + 1u] {
        return select(p.opacity, 0.0, point.is_covered);
    }
    let begin = object_values[p.first + 2u + number];
    if begin == 0u || p.soft == 0.0 {
        return p.opacity;
    }
    let found = nearest_edge(p.first + begin, point);
    // Narrower than two pixels it would be a ragged edge, wider than the core nothing would be wholly there.
    let width = min(max(p.soft * found.core, 2.0 * metres_per_pixel(point)), found.core);
    return p.opacity * smoothstep(0.0, width, found.distance);
}

struct Nearest {
    distance: f32,              // metres
    core: f32,                  // area divided by length of the outline, metres
}

// The edge of a footprint that is nearest to a point, seen from above; far away, of core 1, where none is as near as the core. Where
// things stand in the table of footprints: render::footprints.
fn nearest_edge(first: u32, point: Point) -> Nearest {
    let whole = view.eye_whole.xy - vec2i(bitcast<i32>(object_values[first]), bitcast<i32>(object_values[first + 1u]));
    let at = vec2f(whole) + view.eye_fraction.xy + point.relative.xy;
    let cells = vec2u(object_values[first + 3u] & 0xffffu, object_values[first + 3u] >> 16u);
    let cell = min(vec2u(max(at / number_at(first + 2u), vec2f(0.0))), cells - 1u);
    let list = first + 4u + cell.y * cells.x + cell.x;
    let end = first + object_values[list + 1u];
    var nearest = Nearest(1e9, 1.0);
    for (var edge = first + object_values[list]; edge < end; edge += 5u) {
        let a = vec2f(number_at(edge), number_at(edge + 1u));
        let along = vec2f(number_at(edge + 2u), number_at(edge + 3u)) - a;
        let share = clamp(dot(at - a, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
        let distance = length(at - a - share * along);
        if distance < nearest.distance {
            nearest = Nearest(distance, number_at(edge + 4u));
        }
    }
    return nearest;
}

fn number_at(at: u32) -> f32 {
    return bitcast<f32>(object_values[at]);
}
