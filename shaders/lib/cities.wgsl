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

// How far a content may be from what is opaque and still be in one plane with it, as depth: this part of its distance, and what the
// rasteriser's grid makes of the plane's slope (depth per pixel).
const PLANE_DEPTH: f32 = 1.0 / 262144.0;

// By how much what is translucent must be before what is opaque: a content that lies in the plane of what stays is hidden by it. Else
// the last bits of both would decide, here so and there so.
fn room_before_opaque(depth: f32, slope: vec2f) -> f32 {
    return select(PLANE_DEPTH * depth + 2.0 * SNAPPING * (abs(slope.x) + abs(slope.y)), 0.0, city.number == 0u);
}
