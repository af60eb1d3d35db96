// Where rays go through the faces of the solids of a lens: each crossing is put on a list of its texel. The faces are drawn;
// nothing is coloured. What finds no room marks its texel; the host makes room for as many as there were.

struct ListStage {
    view: View,
    region: Region,
    // From the picture's clip space to that of the target.
    clip_scale: vec2f,
    clip_shift: vec2f,
    // Texels of a row, and rows.
    width: u32,
    height: u32,
    // Where the lists of the sprite begin.
    first_list: u32,
    // Which of the lens' leaves the solid is.
    leaf: u32,
    // Crossings that all lists take together.
    room: u32,
}

@group(2) @binding(0) var<uniform> stage: ListStage;
@group(2) @binding(2) var<storage, read_write> lists: array<atomic<u32>>;
@group(2) @binding(3) var<storage, read_write> crossings: array<u32>;
@group(2) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

// Share of the near plane's distance.
const CLIPPED: f32 = 0.01;

// The eye of the sprite.
var<private> view: View;

struct SolidCorner {
    @builtin(position) @invariant clip: vec4f,
    @location(0) distance: f32,         // metres along the axis of the sprite
}

@vertex
fn vertex(@location(0) corner: vec3f) -> SolidCorner {
    view = stage.view;
    let s = solid_of(stage.region);
    let p = s.center + corner.x * s.x + corner.y * s.y + corner.z * s.z;
    let w = select(-p.z, 1.0, view.orthographic == 1u);
    let in_picture = p.xy * view.projection.xy + view.projection.zw * w;
    // Clipped well before anything is seen, but not in the eye, where nothing has a place in the picture.
    let z = select(w - CLIPPED * view.near, 0.5, view.orthographic == 1u);
    return SolidCorner(vec4f(in_picture * stage.clip_scale + stage.clip_shift * w, z, w), -p.z);
}

@fragment
fn note(in: SolidCorner, @builtin(front_facing) is_entry: bool) {
    let at = vec2u(in.clip.xy);
    if at.x >= stage.width || at.y >= stage.height {
        return;
    }
    let list = stage.first_list + at.y * stage.width + at.x;
    let number = atomicAdd(&counts[0], 1u);
    if number >= stage.room {
        atomicOr(&lists[list], INCOMPLETE);
        return;
    }
    let before = atomicExchange(&lists[list], number + 1u);
    crossings[2u * number] = bitcast<u32>(in.distance);
    crossings[2u * number + 1u] = before | stage.leaf << LEAF_SHIFT | select(0u, IS_ENTRY, is_entry);
}
