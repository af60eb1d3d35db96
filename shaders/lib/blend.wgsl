// Blend modes, channel by channel, and what is made of them.

fn blend_replace(below: vec3f, above: vec3f) -> vec3f {
    return above;
}

fn blend_add(below: vec3f, above: vec3f) -> vec3f {
    return below + above;
}

fn blend_subtract(below: vec3f, above: vec3f) -> vec3f {
    return max(below - above, vec3f(0.0));
}

fn blend_multiply(below: vec3f, above: vec3f) -> vec3f {
    return below * above;
}

fn blend_screen(below: vec3f, above: vec3f) -> vec3f {
    return 1.0 - (1.0 - min(below, vec3f(1.0))) * (1.0 - min(above, vec3f(1.0)));
}

// Middle grey to the eye is 0.214 of the light.
fn blend_overlay(below: vec3f, above: vec3f) -> vec3f {
    let lighter = min(2.0 * blend_screen(below, above), vec3f(1.0));
    return select(lighter, 2.0 * below * above, below < vec3f(0.214));
}

// Exact where both are equal.
fn weighed(below: vec3f, above: vec3f, weight: f32) -> vec3f {
    return below + (above - below) * weight;
}

// By the mode's number; 0 replaces.
fn blend(mode: u32, below: vec3f, above: vec3f) -> vec3f {
    switch mode {
        case 2u: { return blend_add(below, above); }
        case 3u: { return blend_subtract(below, above); }
        case 4u: { return blend_multiply(below, above); }
        case 5u: { return blend_screen(below, above); }
        case 6u: { return blend_overlay(below, above); }
        default: { return above; }
    }
}
