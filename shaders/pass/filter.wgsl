// One direction of a separable neighbourhood filter (K3). The kernel is the effect's: a weight for each offset, in pixels.

struct FilterStage {
    step: vec2i,                // to the next pixel: (1, 0) or (0, 1)
    reach: i32,                 // pixels on either side
    first: u32,                 // slot of the effect's parameters
    size: vec2i,                // of the picture, pixels
}

@group(0) @binding(0) var<uniform> stage: FilterStage;
@group(0) @binding(1) var image: texture_2d<f32>;      // linear, multiplied by opacity
@group(0) @binding(2) var<uniform> parameters: array<vec4f, 4096>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

//@handlers

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -stage.reach; i <= stage.reach; i++) {
        // Beyond the picture nothing is known: the kernel is cut there.
        let there = pixel + i * stage.step;
        let weight = kernel(f32(i));
        if all(there >= vec2i(0)) && all(there < stage.size) && weight > 0.0 && weight < 1e6 {
            sum += weight * textureLoad(image, there, 0);
            weights += weight;
        }
    }
    return select(textureLoad(image, pixel, 0), sum / weights, weights > 0.0);
}
