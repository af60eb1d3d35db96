// Where vertices stand, in modules that draw the scene's own city and no other.

fn city_relative(whole: vec3i, offset: vec3f) -> vec3f {
    return relative_to_eye(whole, offset);
}

fn city_direction(direction: vec3f) -> vec3f {
    return direction;
}

fn city_length(metres: f32) -> f32 {
    return metres;
}

fn city_surface(number: u32) -> u32 {
    return number;
}

fn city_number() -> u32 {
    return 0u;
}

fn room_before_opaque(depth: f32, slope: vec2f) -> f32 {
    return 0.0;
}
