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
    return lay(in.clip.xy, in.clip.z, in.code, KEPT_ALONE, 0u, own_color(in.code));
}

@fragment //@early
fn lay_smooth(in: SmoothVarying) -> Laid {
    //@behind
    return lay(in.clip.xy, in.clip.z, in.code, KEPT_ALONE, normal_code(in.normal, in.code), own_color(in.code));
}

@fragment //@early
fn lay_textured(in: TexturedVarying) -> Laid {
    let texel = textureSample(image, image_sampler, in.texcoord);
    //@behind
    if texel.a < ALPHA_CUTOFF {
        discard;
    }
    texel_opacity = select(1.0, texel.a, TRANSLUCENT);
    let normal = select(0u, encode_normal(in.normal), SMOOTH);
    return lay(in.clip.xy, in.clip.z, in.code, KEPT_ALONE, normal, packed_texel(texel.rgb * surface_at(in.code - 1u).color));
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
    return lay(in.clip.xy, depth, code, in.code & ~KEPT_CODE, normal, own_color(code));
}
