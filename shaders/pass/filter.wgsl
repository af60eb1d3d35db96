// One direction of a separable neighbourhood filter. The kernel is the effect's: a weight for each offset, in pixels.
//
// What a pixel costs is the texels it reads. So a texel holds four pixels that lie side by side across the filter's
// direction, and an invocation makes four of these that follow each other in it: 16 pixels of 4 + 2 r reads. It writes them
// turned, four pixels in its own direction to a texel: as the filter in the other direction reads them. Line k of the four
// goes into target k.

struct FilterStage {
    step: vec2i,                // to the next pixel: (1, 0) or (0, 1)
    reach: i32,                 // pixels on either side
    first: u32,                 // slot of the effect's parameters
    length: i32,                // of the picture in the filter's direction, pixels
    layers: i32,                // texels that follow each other stand in one layer, or in turn in four
    layer: i32,                 // the first of these
}

struct Lines {
    @location(0) first: vec4u,
    @location(1) second: vec4u,
    @location(2) third: vec4u,
    @location(3) fourth: vec4u,
}

@group(0) @binding(0) var<uniform> stage_uniform: FilterStage;
@group(0) @binding(1) var image: texture_2d_array<u32>;
@group(0) @binding(2) var<uniform> parameters_uniform: array<vec4f, 4096>;

// Carried with the triangle: `pass/shade.wgsl` says why.
var<private> stage: FilterStage;

struct Corner {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) way: vec4i,         // step, reach, length
    @location(1) @interpolate(flat, either) layers: vec2i,      // layers, layer
//@carried
}

@vertex
fn vertex(@location(0) at: vec2f) -> Corner {
    let s = stage_uniform;
    var corner: Corner;
    corner.clip = vec4f(at, 0.0, 1.0);
    corner.way = vec4i(s.step, s.reach, s.length);
    corner.layers = vec2i(s.layers, s.layer);
    carry(&corner, s.first);
    return corner;
}

//@handlers

// Of the pixel's own offset never 0: where no other weight is left, the pixel stays as it is.
fn weight_at(i: i32, own: Own) -> f32 {
    let weight = kernel(f32(i), own);
    let least = select(0.0, 1e-20, i == 0);
    return select(least, max(weight, least), i <= stage.reach && weight > 0.0 && weight < 1e6);
}

// The n-th texel in the filter's direction, of those that `beside` leads to.
fn texel(n: i32, beside: vec2i) -> mat3x4f {
    let is_turned = stage.layers == 4;
    let place = beside + select(n, n >> 2u, is_turned) * stage.step;
    return four_unpacked(textureLoad(image, place, stage.layer + select(0, n & 3, is_turned), 0));
}

// Beyond the picture nothing is known: the kernel is cut there.
fn known(n: i32, weights: vec4f) -> vec4f {
    return select(vec4f(0.0), weights, n >= 0 && n < stage.length);
}

@fragment
fn fragment(in: Corner) -> Lines {
    stage = FilterStage(in.way.xy, in.way.z, 0u, in.way.w, in.layers.x, in.layers.y);
    take_own(in);
    let block = vec2i(in.clip.xy);
    let beside = block * (1 - stage.step);
    let start = 4 * dot(block, stage.step);
    let own = own_parameters();
    var first = mat3x4f();
    var second = mat3x4f();
    var third = mat3x4f();
    var fourth = mat3x4f();
    var weights = vec4f(0.0);
    // What the texel that is read weighs in each of the four. Four texels at a time: a software adapter masks all sums once in
    // every round. Beyond the kernel's reach weights are 0.
    var last = vec4f(0.0);
    for (var i = -stage.reach; i < stage.reach + 4; i += 4) {
        let w = vec4f(weight_at(i, own), weight_at(i + 1, own), weight_at(i + 2, own), weight_at(i + 3, own));
        let a = known(start + i, vec4f(w.x, last.wzy));
        let b = known(start + i + 1, vec4f(w.yx, last.wz));
        let c = known(start + i + 2, vec4f(w.zyx, last.w));
        let d = known(start + i + 3, w.wzyx);
        last = w;
        let p = texel(start + i, beside);
        let q = texel(start + i + 1, beside);
        let r = texel(start + i + 2, beside);
        let s = texel(start + i + 3, beside);
        first += (a.x * p + b.x * q) + (c.x * r + d.x * s);
        second += (a.y * p + b.y * q) + (c.y * r + d.y * s);
        third += (a.z * p + b.z * q) + (c.z * r + d.z * s);
        fourth += (a.w * p + b.w * q) + (c.w * r + d.w * s);
        weights += (a + b) + (c + d);
        // Here, not at the beginning: a software adapter goes through a whole round to find that there is none.
        if i + 4 >= stage.reach + 4 {
            break;
        }
    }
    // Pixels beyond the picture have no weight.
    let scale = 1.0 / max(weights, vec4f(1e-30));
    let a = four_packed(first * scale.x);
    let b = four_packed(second * scale.y);
    let c = four_packed(third * scale.z);
    let d = four_packed(fourth * scale.w);
    return Lines(
        vec4u(a.x, b.x, c.x, d.x),
        vec4u(a.y, b.y, c.y, d.y),
        vec4u(a.z, b.z, c.z, d.z),
        vec4u(a.w, b.w, c.w, d.w));
}
