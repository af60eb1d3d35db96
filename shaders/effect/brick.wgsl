//! name = "brick"
//! kind = "material"
//! spec = "Tiesel §3"
//! doc = "Walls of brick, made of numbers alone; roofs and ground keep their colour."
//!
//! [[parameter]]
//! name = "length"
//! type = "number"
//! range = [0.1, 8]
//! default = 1.2
//! unit = "metres"
//! doc = "Length of a brick with its joint; it is a quarter as high. A real one has 0.25, which only near walls show."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#a4492f"
//! doc = "Colour of a brick."
//!
//! [[parameter]]
//! name = "joint"
//! type = "color"
//! default = "#d8cdbb"
//! doc = "Colour of the joints."

fn effect(material: Material, point: Point, p: Parameters) -> Material {
    if abs(point.normal.z) > 0.5 || point.object == NO_OBJECT {
        return material;
    }
    let height = 0.25 * p.length;
    // Along the wall, and up. Twice the length: courses are shifted by half a brick, every other.
    let along = normalize(vec2f(-point.normal.y, point.normal.x));
    let u = dot(within(point, 2.0 * p.length).xy, along) / p.length;
    let v = within(point, 2.0 * height).z / height;
    let course = floor(v);
    let shifted = u + 0.5 * (course - 2.0 * floor(0.5 * course));
    let half_joint = 0.5 * JOINT * height;
    let in_brick = vec2f(fract(shifted) * p.length, fract(v) * height);
    let from_joint = min(in_brick, vec2f(p.length, height) - in_brick) - half_joint;
    let pixel = metres_per_pixel(point) / max(abs(dot(point.normal, normalize(point.relative))), 0.1);
    let brick = clamp(0.5 + min(from_joint.x, from_joint.y) / pixel, 0.0, 1.0);
    // Seen from afar, a wall has the mean colour.
    let far = smoothstep(0.25, 0.6, pixel / height);
    let share = mix(brick, (1.0 - JOINT) * (1.0 - 0.25 * JOINT), far);
    let tone = mix(0.82 + 0.36 * random(vec2f(floor(shifted), course)), 1.0, far);
    var changed = material;
    changed.base = mix(p.joint, p.color * tone, share);
    return changed;
}

const JOINT = 0.16;             // of a brick's height

// A number 0..1 that belongs to a brick: of whole numbers, which are the same on every adapter.
fn random(place: vec2f) -> f32 {
    let c = vec2u(vec2i(place));
    var h = (c.x * 0x8da6b343u) ^ (c.y * 0xd8163841u);
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return f32((h ^ (h >> 16u)) >> 8u) / 16777216.0;
}
