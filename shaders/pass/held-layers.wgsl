// Translucent layers of triangles that hold their depth, behind `pass/layers.wgsl`.

// Triangles that hold their depth (`pass/held.wgsl`), which is not the one that the depth test would take either.
@vertex
fn vertex_held_layer(@builtin(vertex_index) index: u32, @builtin(instance_index) layer: u32) -> HeldVarying {
    var face = held_corner(index);
    face.code = select(face.code | ALONE, code_in_plane(face.code, layer), is_of_plane());
    return face;
}

fn add_held(in: HeldVarying, normal: u32, color: u32, light: u32) {
    let depth = held_depths(in).y;
    if textureLoad(opaque_depth, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, vec2f(0.0)) {
        return;
    }
    let code = in.code & NODE_CODE;
    add_node(in.clip.xy, depth, code, in.code & ~NODE_CODE, normal, color, light);
}

@fragment
fn note_held(in: HeldVarying) {
    let code = in.code & NODE_CODE;
    add_held(in, held_normal(in, code), natural_color(code), 0u);
}

@fragment
fn note_held_textured(in: HeldVarying) {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code & NODE_CODE);
    if look.opacity < ALPHA_CUTOFF {
        return;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    add_held(in, look.normal, packed_texel(look.color), packed(look.light));
}
