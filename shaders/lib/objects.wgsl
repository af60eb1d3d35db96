// Values per object that effects read.

@group(2) @binding(1) var<storage, read> object_values: array<u32>;

// Whether an object is one of those that an effect chose by an attribute; `first`: its parameter of this name. The values
// begin with that of no object.
fn is_chosen(first: u32, object: u32) -> bool {
    return object_values[first + (object + 1u)] != 0u;
}

// The value of a ramp at a place, 0 to 1, between its steps linearly; `first`: the parameter.
fn share_on_ramp(first: u32, at: f32) -> f32 {
    let place = step_of_ramp(first, at);
    let next = place.step + select(0u, 1u, place.step + 1u < object_values[first]);
    return mix(bitcast<f32>(object_values[first + 1u + place.step]), bitcast<f32>(object_values[first + 1u + next]), place.share);
}

// The same of colours, linear light.
fn color_on_ramp(first: u32, at: f32) -> vec3f {
    let place = step_of_ramp(first, at);
    let next = place.step + select(0u, 1u, place.step + 1u < object_values[first]);
    return mix(ramp_color(first, place.step), ramp_color(first, next), place.share);
}

struct PlaceOnRamp {
    step: u32,
    share: f32,                 // of the way to the next, 0..1
}

fn step_of_ramp(first: u32, at: f32) -> PlaceOnRamp {
    let place = clamp(at, 0.0, 1.0) * f32(object_values[first] - 1u);
    return PlaceOnRamp(u32(place), fract(place));
}

fn ramp_color(first: u32, step: u32) -> vec3f {
    let at = first + 1u + 3u * step;
    return vec3f(bitcast<f32>(object_values[at]), bitcast<f32>(object_values[at + 1u]), bitcast<f32>(object_values[at + 2u]));
}
