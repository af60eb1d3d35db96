// The lens test from the shapes themselves, for whatever has a closed form.
//
// Inside is asked of the place and needs no ray. Only what is not inside asks on which side of the volume it lies, and
// whether its ray meets the volume at all. The volumes are convex: what is outside and nearer than the middle of the ray's
// way through is in front. Of a flat lens rays never leave; it is asked by the ray alone, and holds also where nothing is.

fn class_in_shape(s: Shape, kind: u32, sight: Sight) -> u32 {
    let span = span_of_shape(sight.ray, s, kind);
    // Perspective rays start at the eye: what lies behind it is not seen, and no ray there looks past a lens.
    let starts_at_eye = !sight.is_parallel;
    let is_missed = span.enter > span.exit || (starts_at_eye && (span.exit <= 0.0 || sight.distance <= 0.0));
    let side = select(BEHIND, FRONT, sight.distance < 0.5 * (span.enter + span.exit));
    // Inside, the side is the one that is nearer along the ray: soft borders ask for it.
    return inside_shape(s, kind, sight) | select(side, MISSED, is_missed);
}

// INSIDE or nothing, for lenses that ask for no other class.
fn inside_shape(s: Shape, kind: u32, sight: Sight) -> u32 {
    return select(MISSED, INSIDE, is_in_shape(s, kind, sight));
}

fn is_in_shape(s: Shape, kind: u32, sight: Sight) -> bool {
    if kind == FLAT {
        return flat_holds(s, sight.ray, sight.distance, sight.is_parallel);
    }
    return sight.distance < FAR_AWAY && holds(s, kind, sight.position, sight.distance);
}

// Whether the ray of a pixel's centre meets the volume.
fn covers_shape(s: Shape, kind: u32, pixel: vec2i) -> bool {
    let span = span_of_shape(ray_of_pixel(vec2f(pixel) + 0.5), s, kind);
    return span.enter <= span.exit && (span.exit > 0.0 || view.orthographic == 1u);
}
