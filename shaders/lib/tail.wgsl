// All translucent fragments of a pixel as one layer, those nearer weighing more: weighted blended transparency (McGuire and Bavoil
// 2013, equation 6 with the weight of equation 9), for all layers or for those that found no slot (`lib/slots.wgsl`).
//
//   colour = sum of c_i a_i w_i / sum of a_i w_i       let through = product of 1 - a_i

override SLOTS: u32 = 0u;           // of a pixel that hold the nearest; 0: all are one layer

struct Band {
    origin: vec2u,                  // pixels
    size: vec2u,
}

@group(0) @binding(2) var<storage, read> slots: array<u32>;
@group(0) @binding(4) var<uniform> band: Band;

struct Laid {
    @location(0) sum: vec4f,        // c a w; a w
    @location(1) through: vec4f,    // 1 - a, to be multiplied
}

// Equation 9 of the source, which has 200 for a scene of 500 m: here the radius of the scene.
fn weight(distance: f32, opacity: f32) -> f32 {
    let z = distance / light.scene_radius;
    return opacity * clamp(0.03 / (1e-5 + z * z * z * z), 1e-2, 3e3);
}

fn has_slot(pixel: vec2u, depth: f32, code: u32) -> bool {
    if SLOTS == 0u {
        return false;
    }
    let inside = pixel - band.origin;
    let last = key_place((inside.y * band.size.x + inside.x) * SLOTS + SLOTS - 1u);
    let kept = slots[last];
    let bits = bitcast<u32>(depth);
    return kept == 0u || bits > kept || (bits == kept && code <= slots[last + 1u]);
}

fn lay(at: vec2f, depth: f32, code: u32, plane: u32, normal: u32, color: u32, light_share: u32) -> Laid {
    take(corner_of(vec2f(0.0), PART));
    if has_slot(vec2u(at), depth, code | plane) || !is_layer(fragment_at(at, depth, code)) {
        discard;
    }
    var point = layer_point(at, depth, code, normal, color, light_share);
    let classes = layer_classes(point);
    let opacity = opacity_at(point, classes);
    let paint = shade(&point, classes);
    let weighed = opacity * weight(point.distance, opacity);
    return Laid(vec4f(paint * weighed, weighed), vec4f(1.0 - opacity));
}
