// One direction of a separable neighbourhood filter (K3). The kernel is the effect's: a weight for each offset, in pixels.
//
// What a pixel costs is the texels it reads, so an invocation makes four pixels that follow each other in that direction:
// they share most of what they read. Pixel p of a row or column is pixel p / 4 of target p % 4. Across makes four narrow
// images; down reads these, and makes four low ones, in which the narrow ones stand side by side.

struct FilterStage {
    step: vec2i,                // to the next pixel: (1, 0) or (0, 1)
    reach: i32,                 // pixels on either side
    first: u32,                 // slot of the effect's parameters
    size: vec2i,                // of the picture, pixels
    columns: i32,               // of one layer of the image
}

struct Four {
    @location(0) first: vec4f,
    @location(1) second: vec4f,
    @location(2) third: vec4f,
    @location(3) fourth: vec4f,
}

@group(0) @binding(0) var<uniform> stage: FilterStage;
@group(0) @binding(1) var image: texture_2d_array<f32>;    // linear, multiplied by opacity
@group(0) @binding(2) var<uniform> parameters: array<vec4f, 4096>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

//@handlers

// Of the pixel's own offset never 0: where no other weight is left, the pixel stays as it is.
fn weight_at(i: i32, own: Own) -> f32 {
    let weight = kernel(f32(i), own);
    let least = select(0.0, 1e-20, i == 0);
    return select(least, max(weight, least), i <= stage.reach && weight > 0.0 && weight < 1e6);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> Four {
    let texel = vec2i(at.xy);
    // A pixel's centre is half a pixel from any border, so this is exact; a software adapter divides integers lane by lane.
    let layer = i32(at.x / f32(stage.columns));
    let pixel = vec2i(texel.x - layer * stage.columns, texel.y) * (1 + 3 * stage.step);
    let start = dot(pixel, stage.step);
    let length = dot(stage.size, stage.step);
    let own = own_parameters();
    var sums = mat4x4f();
    var weights = vec4f(0.0);
    // What the texel that is read weighs in each of the four.
    var here = vec4f(0.0);
    for (var i = -stage.reach; i < stage.reach + 4; i++) {
        here = vec4f(weight_at(i, own), here.xyz);
        // Beyond the picture nothing is known: the kernel is cut there.
        let is_known = start + i >= 0 && start + i < length;
        let weighed = select(vec4f(0.0), here, is_known);
        let color = textureLoad(image, pixel + i * stage.step, layer, 0);
        sums[0] += weighed.x * color;
        sums[1] += weighed.y * color;
        sums[2] += weighed.z * color;
        sums[3] += weighed.w * color;
        weights += weighed;
    }
    // Pixels beyond the picture have no weight.
    weights = max(weights, vec4f(1e-30));
    return Four(sums[0] / weights.x, sums[1] / weights.y, sums[2] / weights.z, sums[3] / weights.w);
}
