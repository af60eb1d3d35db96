// Where vertices stand, in modules that draw contents of lenses beside the scene's own city. Each city is one set of
// draws with a `city` of its own.
//
// What is not moved is counted from the eye, turned by nothing and scaled by 1: to the bit as `relative_to_eye` has it, so
// that what two cities share lies in one place.

struct City {
    linear: mat3x3f,            // turns and scales
    from_whole: vec3i,          // what it is turned about, metres
    number: u32,                // 0: the scene's own city
    from_fraction: vec3f,
    first_surface: u32,         // where its surfaces begin in the table
    to: vec3f,                  // where that comes to stand, relative to the eye, metres
    scale: f32,
}

fn placed_by(city: City, whole: vec3i, offset: vec3f) -> vec3f {
    return city.linear * ((vec3f(whole - city.from_whole) - city.from_fraction) + offset) + city.to;
}

fn city_relative(whole: vec3i, offset: vec3f) -> vec3f {
    return placed_by(city, whole, offset);
}

fn city_direction(direction: vec3f) -> vec3f {
    return city.linear * direction / city.scale;
}

fn city_length(metres: f32) -> f32 {
    return metres * city.scale;
}

fn city_surface(number: u32) -> u32 {
    return number + city.first_surface;
}

fn city_number() -> u32 {
    return city.number;
}
