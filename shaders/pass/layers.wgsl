// Translucent layers: every fragment that is seen through is noted in a list of its pixel. `pass/composite.wgsl` sorts them.
//
// A list begins at `heads` (`lib/layer-nodes.wgsl`) and goes on from node to node. A node has three words and, where the picture has them, a normal per
// vertex, a colour and a share of light of textures, in places that `lib/fragment-nodes.wgsl` tells.
//
// Where there is much room, it is shared out between pools, one for each tile of the picture in turn, and what a pool has no
// room for spills into the rest: processors that draw different tiles neither count with the same counter nor write
// side by side. Nodes that find no room are counted all the same: the host sees it, and draws what did not fit in narrower bands.

@fragment //@early
fn note_plain(in: Varying) {
    //@behind
    add_node(in.clip.xy, in.clip.z, in.code, ALONE, 0u, natural_color(in.code), 0u);
}

@fragment //@early
fn note_smooth(in: SmoothVarying) {
    //@behind
    add_node(in.clip.xy, in.clip.z, in.code, ALONE, normal_code(in.normal, in.code), natural_color(in.code), 0u);
}

@fragment //@early
fn note_textured(in: TexturedVarying) {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code);
    //@behind
    if look.opacity < ALPHA_CUTOFF {
        return;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    add_node(in.clip.xy, in.clip.z, in.code, ALONE, look.normal, packed_texel(look.color), packed(look.light));
}

// The instance is the layer of the face in its plane: of equal depths the upper one is nearer. It is told with the number.
@vertex
fn vertex_coplanar_layer(in: Vertex, plane: Plane, @builtin(instance_index) layer: u32) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.code = code_in_plane(face.code, layer);
    return face;
}

fn code_in_plane(code: u32, layer: u32) -> u32 {
    return (code & NODE_CODE) | ((MOST_IN_PLANE - min(layer, MOST_IN_PLANE)) << PLANE_SHIFT);
}

// Its depth is that of the plane, not the interpolated one that the depth test would take.
@fragment
fn note_coplanar(in: CoplanarVarying) {
    let depth = depth_on_plane(in.plane, in.clip);
    if textureLoad(opaque_depth, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, in.plane.xy) {
        return;
    }
    let code = in.code & NODE_CODE;
    let normal = select(0u, normal_code(in.normal, code), SMOOTH);
    add_node(in.clip.xy, depth, code, in.code & ~NODE_CODE, normal, natural_color(code), 0u);
}

@vertex
fn vertex_textured_layer(
    in: Vertex,
    plane: Plane,
    @location(7) texcoord: vec2f,
    @builtin(instance_index) layer: u32,
) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.code = code_in_plane(face.code, layer);
    face.texcoord = texcoord;
    return face;
}

@fragment
fn note_textured_coplanar(in: CoplanarVarying) {
    let code = in.code & NODE_CODE;
    let look = look_at(in.texcoord, in.normal, in.relative, code);
    let depth = depth_on_plane(in.plane, in.clip);
    let is_behind = textureLoad(opaque_depth, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, in.plane.xy);
    if is_behind || look.opacity < ALPHA_CUTOFF {
        return;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    add_node(in.clip.xy, depth, code, in.code & ~NODE_CODE, look.normal, packed_texel(look.color), packed(look.light));
}
