// The volumetric depth test (S5): every pixel of a lens' screen bounds gets one bit per class.
// Several volumes of one lens are ORed: inside any of them is inside the lens.
//
// mask layers of lens i, with w = i / 32, bit i % 32:  3w inside | 3w + 1 in front | 3w + 2 behind;
// where nobody asks for more than inside, layer w is all there is

struct MaskStage {
    origin: vec2u,              // of the screen bounds, pixels
    size: vec2u,
    texels_per_pixel: vec2f,    // sprite against target
    sprite_origin: vec2f,       // of the sprite's part that is kept, texels
    lens: u32,
}

@group(1) @binding(0) var scene_depth: texture_depth_2d;
@group(1) @binding(1) var entry_depth: texture_depth_2d;
@group(1) @binding(2) var exit_depth: texture_depth_2d;
@group(1) @binding(3) var masks: texture_storage_2d_array<r32uint, read_write>;
@group(2) @binding(0) var<uniform> stage: MaskStage;

override MASK_LAYERS: u32 = 3u;

const INSIDE: u32 = 0u;
const FRONT: u32 = 1u;
const BEHIND: u32 = 2u;
const REST: u32 = 3u;

// Twin: `veduta::lens::classify`. Distances in metres; `has_entry` false: the eye is inside.
fn classify(distance: f32, has_entry: bool, enter: f32, exit: f32) -> u32 {
    if has_entry && distance < enter {
        return FRONT;
    }
    if distance < exit {
        return INSIDE;
    }
    return BEHIND;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= stage.size) {
        return;
    }
    let pixel = stage.origin + id.xy;
    let texel = vec2u((vec2f(pixel) + 0.5) * stage.texels_per_pixel - stage.sprite_origin);
    let exit = textureLoad(exit_depth, texel, 0);
    if exit == 1.0 {
        return; // the clear value: the ray misses the lens
    }
    let stored = textureLoad(scene_depth, pixel, 0);
    var class_ = BEHIND; // nothing there: D is infinite
    if stored > 0.0 {
        let entry = textureLoad(entry_depth, texel, 0);
        class_ = classify(distance_of_depth(stored), entry > 0.0, distance_of_depth(entry), distance_of_depth(exit));
    }
    if MASK_LAYERS == 1u && class_ != INSIDE {
        return;
    }
    let layer = MASK_LAYERS * (stage.lens / 32u) + class_;
    let word = textureLoad(masks, pixel, layer).x;
    textureStore(masks, pixel, layer, vec4u(word | (1u << (stage.lens % 32u)), 0u, 0u, 0u));
}
