//! Rays followed through the city: what `pass/rays.wgsl` leaves open.

/// Which city a ray is in, and whether what it meets there is there. `hidden`: what hides something, and whether there are other cities than the
/// scene's own; `None`: nothing does.
pub(super) fn source(hidden: Option<(String, bool)>) -> String {
    match hidden {
        None => ALL_IS_THERE.to_owned(),
        Some((hidden, true)) => hidden + IN_CITIES + ASKED,
        Some((hidden, false)) => hidden + IN_ONE + ASKED,
    }
}

/// Where nothing is hidden.
const ALL_IS_THERE: &str = "fn begin_city(number: u32) {}

fn is_there(line: Ray, at: vec2f, hit: Hit) -> bool {
    return true;
}
";

/// Where no city stands elsewhere than the scene's own.
const IN_ONE: &str = "fn begin_city(number: u32) {}
";

const IN_CITIES: &str = "fn begin_city(number: u32) {
    let own = ray_cities.all[number];
    city.linear = mat3x3f(own.world_x.xyz, own.world_y.xyz, own.world_z.xyz);
    city.number = own.number;
    city.first_surface = own.surfaces;
    city.scale = own.world_x.w;
}
";

const ASKED: &str = "
fn is_there(line: Ray, at: vec2f, hit: Hit) -> bool {
    return visible(fragment_on(line, at, depth_of_distance(hit.t), code_of(hit)));
}
";
