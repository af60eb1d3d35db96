// Regions as depths, so that the depth test tells shading which pixels are whose: k + 1 steps where a surface of region k is
// shown, and half of all steps more where nothing is. The passes of the regions have said which surface is whose; the
// background, which they do not draw, is what lies infinitely far.

const STEP: f32 = 1.0 / 4096.0;
const BACKGROUND: u32 = 2048u;

@group(1) @binding(7) var scene_depth: texture_depth_2d;
@group(3) @binding(0) var regions: texture_2d<u32>;

@vertex
fn vertex(@location(0) at: vec2f) -> @builtin(position) @invariant vec4f {
    return vec4f(at, 0.0, 1.0);
}

//@handlers
@fragment
fn fragment(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    let pixel = vec2i(at.xy);
    if textureLoad(scene_depth, pixel, 0) > 0.0 {
        return f32(textureLoad(regions, pixel, 0).x + 1u) * STEP;
    }
    let region = region_at(sight_at(pixel, ray_of_pixel(at.xy), 0.0, NO_OBJECT));
    return f32(BACKGROUND + region + 1u) * STEP;
}
