// The sides of a solid in a depth sprite (Trapp §3.1, in its two stages): per texel the stored depth of the nearest entry and of
// the farthest exit. Its faces are drawn with a depth test, nearest first and then farthest, each into its own channel.
//
// Stored depth decreases with distance, as in the picture's depth target. It is clamped, not clipped. A texel that the solid
// misses holds NO_ENTRY and NO_EXIT. An exit without an entry says that the eye, or the near plane, is inside.

struct SpriteStage {
    region: Region,
    // Target pixels per sprite texel: a coarser sprite takes the ray of its own texel's centre.
    pixels_per_texel: vec2f,
    // Of the part of the sprite that is kept (the lens' screen bounds), texels.
    origin: vec2f,
    // From the picture's clip space to the page's.
    clip_scale: vec2f,
    clip_shift: vec2f,
    // Of a combination: where its leaves begin among the planes, how many there are, which of them `region` is.
    leaves: vec4u,
}

@group(2) @binding(0) var<uniform> stage: SpriteStage;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

const NO_ENTRY = 0.0;
const NO_EXIT = 1.0;

@fragment
fn missed() -> @location(0) vec2f {
    return vec2f(NO_ENTRY, NO_EXIT);
}

// Share of the near plane's distance.
const CLIPPED: f32 = 0.01;

struct SolidCorner {
    @builtin(position) @invariant clip: vec4f,
    @location(0) distance: f32,         // metres along the view axis
}

@vertex
fn vertex_of_solid(@location(0) corner: vec3f) -> SolidCorner {
    let s = solid_of(stage.region);
    let p = s.center + corner.x * s.x + corner.y * s.y + corner.z * s.z;
    let w = select(-p.z, 1.0, view.orthographic == 1u);
    let in_picture = p.xy * view.projection.xy + view.projection.zw * w;
    // Fragments write their depth. Clipped well before anything is seen, but not in the eye, where nothing has a place in the
    // picture.
    let z = select(w - CLIPPED * view.near, 0.5, view.orthographic == 1u);
    return SolidCorner(vec4f(in_picture * stage.clip_scale + stage.clip_shift * w, z, w), -p.z);
}

struct Stored {
    @location(0) ends: vec2f,
    @builtin(frag_depth) depth: f32,
}

fn stored_entry(distance: f32) -> Stored {
    let depth = max(depth_of_distance(distance), 1e-30);
    return Stored(vec2f(depth, 0.0), depth);
}

fn stored_exit(distance: f32) -> Stored {
    let depth = min(depth_of_distance(distance), 0.99999994);
    return Stored(vec2f(0.0, depth), depth);
}

@fragment
fn nearest(in: SolidCorner) -> Stored {
    return stored_entry(in.distance);
}

@fragment
fn farthest(in: SolidCorner) -> Stored {
    return stored_exit(in.distance);
}
