// The depth sprite of a combination, drawn like that of a solid: the ends of its closed forms in one draw, the faces of its
// solids in one each. A place where a leaf begins or ends counts where the combination does too.

// No object is known here, and none is asked for.
fn is_chosen(first: u32, object: u32) -> bool {
    return true;
}

fn is_fading_member(first: u32, object: u32, pixel: vec2i) -> bool {
    return true;
}

fn combination() -> Combination {
    return Combination(stage.leaves.x, stage.leaves.y, 0.0);
}

fn ray_of_texel(at: vec2f) -> Ray {
    return ray_of_pixel((at + stage.origin) * stage.pixels_per_texel);
}

@fragment
fn nearest_form(@builtin(position) at: vec4f) -> Stored {
    let span = span_of_forms(combination(), ray_of_texel(at.xy), view.orthographic == 0u);
    if span.enter >= FAR_AWAY {
        discard;
    }
    return stored_entry(span.enter);
}

@fragment
fn farthest_form(@builtin(position) at: vec4f) -> Stored {
    let span = span_of_forms(combination(), ray_of_texel(at.xy), view.orthographic == 0u);
    if span.exit <= -FAR_AWAY {
        discard;
    }
    return stored_exit(span.exit);
}

// Whether the combination begins (1) or ends (2) where a ray goes through a face of one of its solids, or neither.
fn end_at(in: SolidCorner, is_entry: bool) -> u32 {
    let ray = ray_of_texel(in.clip.xy);
    find_spans(combination(), ray);
    let is_in = around(combination(), ray, in.distance, stage.leaves.z, is_entry);
    return select(select(0u, 2u, is_in.before && !is_in.after), 1u, is_in.after && !is_in.before);
}

@fragment
fn nearest_face(in: SolidCorner, @builtin(front_facing) is_entry: bool) -> Stored {
    if end_at(in, is_entry) != 1u {
        discard;
    }
    return stored_entry(in.distance);
}

@fragment
fn farthest_face(in: SolidCorner, @builtin(front_facing) is_entry: bool) -> Stored {
    if end_at(in, is_entry) != 2u {
        discard;
    }
    return stored_exit(in.distance);
}
