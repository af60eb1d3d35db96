// Translucent layers that pixels in lenses that bend rays show: all that their rays meet before what is opaque, into the list of the pixel.

override SMOOTH: bool = false;      // whether nodes have a normal per vertex

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// What is met: whether it is there is asked on the line that the ray is on there.
fn note_hit(line: Ray, at: vec2f, hit: Hit) {
    if is_met_before(hit) {
        return;
    }
    let depth = depth_of_distance(hit.t);
    let code = code_of(hit);
    if !is_layer(fragment_on(line, at, depth, code)) {
        return;
    }
    let kind = ray_words[hit.triangle + 1u].w;
    let layer = min((kind >> TRIANGLE_LAYER_SHIFT) & TRIANGLE_LAYERS, MOST_IN_PLANE);
    let plane = select(ALONE, (MOST_IN_PLANE - layer) << PLANE_SHIFT, (kind & TRIANGLE_IN_PLANE) != 0u);
    let look = look_of(at, hit);
    keep_node(at, depth, code, plane, look.normal, select(0u, packed_texel(look.color), TEXTURED), 0u);
}

@fragment
fn note_rays(@builtin(position) place: vec4f) {
    if !is_bent(place.xy) {
        discard;
    }
    let depth = textureLoad(opaque_depth, vec2i(place.xy), 0);
    var last = NO_HIT;
    last.t = select(FAR_AWAY, distance_of_depth(depth), depth > 0.0);
    first_of_pixel(place.xy, last);
}
