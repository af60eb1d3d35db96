// Translucent layers of triangles that hold their depth, behind `pass/layers.wgsl`.

// Triangles that hold their depth (`pass/held.wgsl`), which is not the one that the depth test would take either.
@vertex
fn vertex_held_layer(@builtin(vertex_index) index: u32, @builtin(instance_index) layer: u32) -> HeldVarying {
    var face = held_corner(index);
    face.code = select(face.code | ALONE, code_in_plane(face.code, layer), WORDS_BESIDES == WORDS_OF_PLANE);
    return face;
}

fn add_held(in: HeldVarying, color: u32) {
    let depth = held_depths(in).y;
    if textureLoad(opaque_depth, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, vec2f(0.0)) {
        return;
    }
    let code = in.code & NODE_CODE;
    add_node(in.clip.xy, depth, code, in.code & ~NODE_CODE, held_normal(in, code), color);
}

@fragment
fn note_held(in: HeldVarying) {
    add_held(in, natural_color(in.code & NODE_CODE));
}

@fragment
fn note_held_textured(in: HeldVarying) {
    let texel = textureSample(image, image_sampler, in.texcoord);
    if texel.a < ALPHA_CUTOFF {
        return;
    }
    texel_opacity = select(1.0, texel.a, TRANSLUCENT);
    add_held(in, packed_texel(texel.rgb * surface_at((in.code & NODE_CODE) - 1u).color));
}
