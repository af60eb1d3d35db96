// Volumetric depth sprite of one lens volume (S1, V §3.1): per texel the stored depth of the nearest entry (stage 1)
// and of the farthest exit (stage 2). The volumes are convex and their ends have closed forms, so one draw makes both
// stages, and the "nearest" and "farthest" of the source need no depth test: a ray has one span. Solids of any form have
// faces: these are drawn with a depth test, nearest first and then farthest, each into its own channel.
//
// Stored depth decreases with distance (1/w, S4's default). It is clamped, not clipped. A texel that the volume misses
// holds what the target was cleared to, NO_ENTRY and NO_EXIT. An exit without an entry says that the eye, or the near
// plane, is inside.

struct SpriteStage {
    shape: Shape,
    // Target pixels per sprite texel: a coarser sprite takes the ray of its own texel's centre.
    pixels_per_texel: vec2f,
    // Of the part of the sprite that is kept (the lens' screen bounds), texels.
    origin: vec2f,
    // From the picture's clip space to the page's.
    clip_scale: vec2f,
    clip_shift: vec2f,
    // Of a combination: where its leaves begin among the planes, how many there are, which of them `shape` is.
    leaves: vec4u,
}

@group(2) @binding(0) var<uniform> stage: SpriteStage;

// Which kind of shape this pipeline is for.
override KIND: u32 = SPHERE;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

const NO_ENTRY = 0.0;
const NO_EXIT = 1.0;

// Stage 1 of a span, and stage 2.
fn ends_of(span: Span) -> vec2f {
    // A true entry is never NO_ENTRY; a true exit never NO_EXIT: a lens nearer than the near plane ends just behind it.
    let enter = max(depth_of_distance(span.enter), 1e-30);
    // What has no end holds also where nothing is, at depth 0.
    let exit = select(min(depth_of_distance(span.exit), 0.99999994), -1.0, span.exit >= NO_END);
    // Perspective rays start at the eye: what lies behind it is not seen, and no entry.
    let starts_at_eye = view.orthographic == 0u;
    let is_missed = span.enter > span.exit || (starts_at_eye && span.exit <= 0.0);
    let ends = vec2f(select(enter, NO_ENTRY, starts_at_eye && span.enter <= 0.0), exit);
    return select(ends, vec2f(NO_ENTRY, NO_EXIT), is_missed);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec2f {
    return ends_of(span_of_shape(ray_of_pixel((at.xy + stage.origin) * stage.pixels_per_texel), stage.shape, KIND));
}

// ---- solids of any form

@fragment
fn missed() -> @location(0) vec2f {
    return vec2f(NO_ENTRY, NO_EXIT);
}

struct SolidCorner {
    @builtin(position) clip: vec4f,
    @location(0) distance: f32,         // metres along the view axis
}

@vertex
fn vertex_of_solid(@location(0) corner: vec3f) -> SolidCorner {
    let s = stage.shape;
    let p = s.center + corner.x * s.axis_x + corner.y * s.axis_y + corner.z * s.axis_z;
    let w = select(-p.z, 1.0, view.orthographic == 1u);
    let in_picture = p.xy * view.projection.xy + view.projection.zw * w;
    // Fragments write their depth. Half way everywhere, nothing is clipped by the near plane or the far one.
    return SolidCorner(vec4f(in_picture * stage.clip_scale + stage.clip_shift * w, 0.5 * w, w), -p.z);
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
