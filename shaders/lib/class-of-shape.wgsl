// Classes of a fragment wherever it is: beside the picture or behind the eye as well. A sprite drawn from the eye says nothing of
// what only the sun sees. So they come from the shapes themselves, along the main eye's ray through the fragment.

// On distances along the ray, from the fragment on (`classify` in `lib/lens.wgsl` does it on stored depths).
fn class_of(volume: u32, fragment: Fragment) -> u32 {
    let shape = shapes[volume];
    let distance = -fragment.position.z;
    let is_seen = fragment.is_parallel || distance > 0.0;
    let away = select(fragment.position / distance, vec3f(0.0, 0.0, -1.0), fragment.is_parallel || !is_seen);
    let span = span_of_shape(Ray(fragment.position, away), shape, shape.kind);
    let is_missed = span.enter > span.exit || (!fragment.is_parallel && span.exit <= -distance);
    let is_inside = span.enter <= 0.0 && span.exit > 0.0;
    // Behind the eye nobody looks past a lens.
    let beside = select(MISSED, select(BEHIND, FRONT, span.enter > 0.0), is_seen);
    return select(select(beside, INSIDE, is_inside), MISSED, is_missed);
}
