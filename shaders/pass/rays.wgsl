// What pixels in lenses that bend rays show, in place of what the geometry passes drew there.

override SMOOTH: bool = false;      // whether some faces of the picture have a normal per vertex

//@found

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn follow(@builtin(position) place: vec4f) -> Followed {
    if (lenses_over(place.xy) & ray_lenses.followed) == 0u {
        discard;
    }
    let hit = found_by_pixel(place.xy);
    var followed: Followed;
    if hit.t < FAR_AWAY {
        let look = look_of(place.xy, hit);
        followed.code = vec2u(code_of(hit), look.normal);
        followed.color = vec4f(look.color, look.facade);
        followed.depth = depth_of_distance(hit.t);
        followed.own_depth = followed.depth;
        followed.hit = vec2u(hit.triangle + 1u, hit.city);
    }
    return followed;
}
