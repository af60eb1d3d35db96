//! Rays followed through the city: what `lib/ray-walk.wgsl` leaves open.

/// Which city a ray is in, and whether what it meets there is there. `hidden`: what hides something, and whether there are other cities than the
/// scene's own; `None`: nothing does.
pub(super) fn source(hidden: Option<(String, bool)>) -> String {
    match hidden {
        None => cities(false).to_owned() + ALL_IS_THERE,
        Some((hidden, has_cities)) => hidden + cities(has_cities) + ASKED,
    }
}

/// How a city is begun; whether there are others than the scene's own.
pub(super) fn cities(has_cities: bool) -> &'static str {
    if has_cities { IN_CITIES } else { IN_ONE }
}

/// What becomes of a hit where the first one is looked for.
pub(super) const FIRST: &str = "                    if is_there(line, at, hit) {
                        found = hit;
                    }
";

/// The same where all are noted.
pub(super) const ALL: &str = "                    note_hit(line, at, hit);
";

/// Of fragments that are drawn, those are left out that bent rays meet in other places.
pub(super) const LEFT_OUT: &str = "    if is_bent(at) {
        return;
    }
";

/// What the ray of a pixel meets, where it is followed here.
pub(super) const FOLLOWED: &str = "fn found_by_pixel(at: vec2f) -> Hit {
    return first_of_pixel(at, NO_HIT);
}
";

/// The same where it was followed on the processor (`render::ray_tracer`): of each pixel of a part of the tile what it met first, the nearest first, five
/// words each.
const TRACED: &str = "@group(3) @binding(2) var<storage, read> traced_hits: array<u32>;

fn traced_hit(at: vec2f, number: u32) -> Hit {
    let place = vec2u(at) - vec2u(traced_hits[0], traced_hits[1]);
    let pixel = place.y * traced_hits[2] + place.x;
    let first = 4u + 5u * (pixel * traced_hits[3] + number);
    let triangle = traced_hits[first + 1u];
    let weights = vec2f(bitcast<f32>(traced_hits[first + 3u]), bitcast<f32>(traced_hits[first + 4u]));
    let t = select(FAR_AWAY, bitcast<f32>(traced_hits[first]), triangle > 0u);
    return Hit(t, max(triangle, 1u) - 1u, traced_hits[first + 2u], weights);
}
";

/// What is there of it, where nothing is hidden,
const TRACED_FIRST: &str = "
fn found_by_pixel(at: vec2f) -> Hit {
    return traced_hit(at, 0u);
}
";

/// and where something is: where all that was told is hidden it is followed here, too.
const TRACED_THERE: &str = "
fn found_by_pixel(at: vec2f) -> Hit {
    var found = NO_HIT;
    var goes_on = true;
    for (var number = 0u; number < traced_hits[3] && goes_on; number++) {
        let hit = traced_hit(at, number);
        let is_hit = hit.t < FAR_AWAY;
        begin_city(hit.city);
        see_pixel(at, hit.t);
        goes_on = false;
        if is_hit {
            if is_there(seen_ray, at, hit) {
                found = hit;
            } else {
                goes_on = true;
            }
        }
    }
    if goes_on {
        found = first_of_pixel(at, NO_HIT);
    }
    return found;
}
";

/// What was traced; whether something is hidden.
pub(super) fn traced(is_hidden: bool) -> String {
    TRACED.to_owned() + if is_hidden { TRACED_THERE } else { TRACED_FIRST }
}

/// What rays are followed through, in the last group.
pub(super) const LAST_GROUP: &str = "@group(3) @binding(0) var<uniform> ray_cities: RayCities;
@group(3) @binding(1) var<storage, read> ray_words: array<vec4u>;
";

/// The same beside the surfaces.
pub(super) const FIRST_GROUP: &str = "@group(1) @binding(5) var<uniform> ray_cities: RayCities;
@group(1) @binding(6) var<storage, read> ray_words: array<vec4u>;
";

const ALL_IS_THERE: &str = "
fn is_there(line: Ray, at: vec2f, hit: Hit) -> bool {
    return true;
}
";

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
