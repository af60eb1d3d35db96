// The lens test from the numbers of a region, for whatever has a closed form. `form` is the region's own, or a constant where all
// regions of a call are of one: a software adapter runs all cases of a switch that it cannot decide before. `form_holds` and
// `span_of_form` know the forms that a module needs.
//
// Inside is asked of the place and needs no ray. Only what is not inside asks on which side of the volume it lies, and
// whether its ray meets the volume at all. The volumes are convex: what is outside and nearer than the middle of the ray's
// way through is in front. Of a flat lens rays never leave; it is asked by the ray alone, and holds also where nothing is.

fn class_in_form(s: Region, form: u32, sight: Sight) -> u32 {
    let span = span_of_form(sight.ray, s, form);
    // Perspective rays start at the eye: what lies behind it is not seen, and no ray there looks past a lens.
    let starts_at_eye = !sight.is_parallel;
    let is_missed = span.enter > span.exit || (starts_at_eye && (span.exit <= 0.0 || sight.distance <= 0.0));
    let side = select(BEHIND, FRONT, sight.distance < 0.5 * (span.enter + span.exit));
    // Inside, the side is the one that is nearer along the ray: soft borders ask for it.
    return inside_form(s, form, sight) | select(side, MISSED, is_missed);
}

// INSIDE or nothing, for lenses that ask for no other class.
fn inside_form(s: Region, form: u32, sight: Sight) -> u32 {
    return select(MISSED, INSIDE, form_holds(s, form, sight));
}

// Whether the ray of a pixel's centre meets the volume.
fn covers_form(s: Region, form: u32, pixel: vec2i) -> bool {
    let span = span_of_form(ray_at_distance(vec2f(pixel) + 0.5, -s.a.z), s, form);
    return span.enter <= span.exit && (span.exit > 0.0 || view.orthographic == 1u);
}
