// Translucent fragments of the city one by one, for the methods that keep no list of all of them: `lay` says what becomes of
// each, as `lib/slots.wgsl` or `lib/tail.wgsl` has it. What is opaque is there already; what is behind it is left out.

override TEXTURED: bool = false;    // whether the picture has textures

// The bits of a kept number that are that of the surface. Above them is how many layers of a plane may be over this one, as in
// `pass/layers.wgsl`.
const KEPT_CODE: u32 = 0x07ffffffu;
const KEPT_PLANE_SHIFT: u32 = 27u;
const MOST_KEPT_IN_PLANE: u32 = 31u;
const KEPT_ALONE: u32 = 0xf8000000u;    // in its plane: as the lowest

//@opaque-depth

fn own_color(code: u32) -> u32 {
    if TEXTURED {
        return packed_texel(surface_at(code - 1u).color);
    }
    return 0u;
}

@fragment //@early
fn lay_plain(in: Varying) -> Laid {
    //@behind
    return lay(in.clip.xy, in.clip.z, in.code, KEPT_ALONE, 0u, own_color(in.code), 0u);
}

@fragment //@early
fn lay_smooth(in: SmoothVarying) -> Laid {
    //@behind
    return lay(in.clip.xy, in.clip.z, in.code, KEPT_ALONE, normal_code(in.normal, in.code), own_color(in.code), 0u);
}

@fragment //@early
fn lay_textured(in: TexturedVarying) -> Laid {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code);
    //@behind
    if look.opacity < ALPHA_CUTOFF {
        discard;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    let color = packed_texel(look.color);
    return lay(in.clip.xy, in.clip.z, in.code, KEPT_ALONE, look.normal, color, packed(look.light));
}

// The instance is the layer of the face in its plane: of equal depths the upper one is nearer.
@vertex
fn vertex_in_plane(in: Vertex, plane: Plane, @builtin(instance_index) layer: u32) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.code = (face.code & KEPT_CODE) | ((MOST_KEPT_IN_PLANE - min(layer, MOST_KEPT_IN_PLANE)) << KEPT_PLANE_SHIFT);
    return face;
}

// Its depth is that of the plane, not the interpolated one that the depth test would take.
@fragment
fn lay_coplanar(in: CoplanarVarying) -> Laid {
    let depth = depth_on_plane(in.plane, in.clip);
    //@behind-plane
    let code = in.code & KEPT_CODE;
    let normal = select(0u, normal_code(in.normal, code), SMOOTH);
    return lay(in.clip.xy, depth, code, in.code & ~KEPT_CODE, normal, own_color(code), 0u);
}

@vertex
fn vertex_textured_in_plane(
    in: Vertex,
    plane: Plane,
    @location(7) texcoord: vec2f,
    @builtin(instance_index) layer: u32,
) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.code = (face.code & KEPT_CODE) | ((MOST_KEPT_IN_PLANE - min(layer, MOST_KEPT_IN_PLANE)) << KEPT_PLANE_SHIFT);
    face.texcoord = texcoord;
    return face;
}

@fragment
fn lay_textured_coplanar(in: CoplanarVarying) -> Laid {
    let code = in.code & KEPT_CODE;
    let look = look_at(in.texcoord, in.normal, in.relative, code);
    let depth = depth_on_plane(in.plane, in.clip);
    //@behind-plane
    if look.opacity < ALPHA_CUTOFF {
        discard;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    let color = packed_texel(look.color);
    return lay(in.clip.xy, depth, code, in.code & ~KEPT_CODE, look.normal, color, packed(look.light));
}
