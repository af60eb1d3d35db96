//! name = "cut-away"
//! kind = "hide"
//! spec = "Trapp §3.3"
//! doc = "Cuts a hole with a torn rim into what stands before the points of interest of its lens."
//! objects = "sights"
//!
//! [[parameter]]
//! name = "margin"
//! type = "number"
//! range = [0, 1000]
//! default = 1
//! unit = "m"
//! doc = "How far the hole reaches beyond the rectangle around the point of interest in the picture, everywhere; measured at the point of interest."
//!
//! [[parameter]]
//! name = "rim"
//! type = "number"
//! range = [0, 1000]
//! default = 6
//! unit = "m"
//! doc = "How much farther it reaches where its rim is torn farthest."
//!
//! [[parameter]]
//! name = "grain"
//! type = "number"
//! range = [0.01, 1000]
//! default = 5
//! unit = "m"
//! doc = "How long its teeth are along the rim."

// The host writes of each point of interest: the rectangle (low x, low y, high x, high y) that holds it, in tangents of the view
// (metres where rays are parallel), how far its farthest point is, and how many metres a unit of the rectangle is at its middle.
fn effect(fragment: Fragment, p: Parameters) -> bool {
    let count = object_values[p.first];
    let distance = -fragment.position.z;
    let place = fragment.position.xy / select(max(distance, 1e-6), 1.0, fragment.is_parallel);
    var is_cut = false;
    for (var i = 0u; i < count; i++) {
        let at = p.first + 1u + 6u * i;
        let low = vec2f(number(at), number(at + 1u));
        let high = vec2f(number(at + 2u), number(at + 3u));
        let metres = number(at + 5u);
        let beyond = metres * (abs(place - 0.5 * (low + high)) - 0.5 * (high - low));
        let outside = length(max(beyond, vec2f(0.0))) + min(max(beyond.x, beyond.y), 0.0);
        let tear = torn(metres * (place - low) / p.grain);
        is_cut = is_cut || (distance < number(at + 4u) && outside < p.margin + p.rim * tear);
    }
    return is_cut;
}

fn number(at: u32) -> f32 {
    return bitcast<f32>(object_values[at]);
}

// 0..1, the same in every run: two octaves of values on a lattice, the second half as high.
fn torn(at: vec2f) -> f32 {
    return (2.0 * noise(at) + noise(2.7 * at + 11.5)) / 3.0;
}

fn noise(at: vec2f) -> f32 {
    let cell = floor(at);
    let part = fract(at);
    let row = vec2f(lattice(cell), lattice(cell + vec2f(0.0, 1.0)));
    let next = vec2f(lattice(cell + vec2f(1.0, 0.0)), lattice(cell + 1.0));
    let across = mix(row, next, part.x);
    return mix(across.x, across.y, part.y);
}

// Of a lattice point, by a hash of its whole numbers (M. Jarzynski, M. Olano 2020, pcg2d).
fn lattice(cell: vec2f) -> f32 {
    var v = bitcast<vec2u>(vec2i(clamp(cell, vec2f(-1e6), vec2f(1e6)))) * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v = v ^ (v >> vec2u(16u));
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v = v ^ (v >> vec2u(16u));
    return f32(v.x >> 8u) / 16777215.0;
}
