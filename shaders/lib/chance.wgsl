// Each translucent fragment there or not by chance, as often as it is opaque, in every sample anew (Enderton et al. 2010): what is
// there is opaque, takes part in the depth test and is shaded as all that is opaque.

struct Laid {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    @location(4) light: vec4f,
//@depth
}

// A number 0..1 (1 left out) that looks random: PCG (Jarzynski and Olano 2020), of the pixel, the sample and the fragment.
fn chance(pixel: vec2u, code: u32, depth: f32) -> f32 {
    // Of the picture, whatever part of it is drawn.
    let at = pixel + vec2u(view.first_pixel & 0xffffu, view.first_pixel >> 16u);
    var state = at.x;
    state = scrambled(state ^ scrambled(at.y + 0x9e3779b9u));
    state = scrambled(state ^ scrambled(view.sample_index + 0x85ebca6bu));
    state = scrambled(state ^ scrambled(code));
    // To a part in two thousand: how depth is rounded goes by the tile that is drawn.
    state = scrambled(state ^ (bitcast<u32>(depth) >> 12u));
    return f32(state >> 8u) * (1.0 / 16777216.0);
}

fn scrambled(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn lay(at: vec2f, depth: f32, code: u32, plane: u32, normal: u32, color: u32, light_share: u32) -> Laid {
    take(corner_of(vec2f(0.0), PART));
    if !is_layer(fragment_at(at, depth, code)) {
        discard;
    }
    let point = layer_point(at, depth, code, normal, color, light_share);
    let opacity = opacity_at(point, layer_classes(point));
    if opacity <= chance(vec2u(at), code, depth) {
        discard;
    }
    var laid: Laid;
    laid.code = vec2u(code, normal);
    laid.color = vec4f(point.base, 1.0);
    laid.own_depth = depth;
    laid.light = vec4f(unpacked(light_share), 1.0);
    //@set
    return laid;
}
