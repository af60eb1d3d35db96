// Lenses that bend rays (Wang et al., section 3): where the ray of a pixel goes. `lens::ray_path` does the same on the host, and says what a
// plane does to a ray.

struct RayLens {
    center: vec2f,              // in the picture's plane at distance 1; of parallel rays, metres
    radius: f32,                // the same
    border: f32,                // width of the band in which rays find back, a share of the radius
    distance: f32,              // D of its plane, metres
    until: f32,                 // D from which on rays go as the eye sees, metres
    power: f32,                 // what it takes from slopes, 1 / metres
    kind: u32,                  // RAY_*
    outline: u32,               // OUTLINE_*
    first_knot: u32,            // of a sampled radius
    knots: u32,
    angle: f32,                 // of a fisheye, from its middle to its rim, radians
    color: vec3f,               // of its grid, linear
    grid: f32,                  // how far the lines of a grid are apart where it bends nothing, as its radius; 0: there is none
}

const RAY_PLANE: u32 = 0u;
const RAY_SAMPLED: u32 = 1u;
const RAY_ANGULAR: u32 = 2u;
const RAY_HEMISPHERICAL: u32 = 3u;
const RAY_OWN: u32 = 4u;           // as a handler of the user's says, whose number is in knots, whose parameters begin at first_knot
const OUTLINE_SQUARE: u32 = 1u;
const OUTLINE_FIELD: u32 = 2u;      // told by a field, whose number is in first_knot
const FIELD_SIDE: u32 = 512u;       // texels

struct RayEvent {
    distance: f32,              // D, metres
    lens: u32,
    ends: u32,                  // whether the ray goes on as the eye sees; else it meets the plane
    reserved: u32,
}

// Those of the picture stand first, the topmost before the others, then those with planes.
struct RayLenses {
    images: u32,
    planes: u32,
    events: u32,
    stretch: f32,               // from pixel to pixel rays of these turn at most so many times as far as others; FAR_AWAY: any
    followed: u32,              // a bit for each lens: whether its rays are followed through triangles,
    warped: u32,                // or looked up in an image of what the eye sees,
    moved: u32,                 // or triangles' corners are where it shows them
    chosen: array<vec4u, 2>,    // of each lens where the marks of the objects that it acts on begin, from 1; 0: it acts on all
    lenses: array<RayLens, 8>,
    along: array<RayEvent, 16>, // nearest first
    knots: array<vec4f, 1024>,  // radius of the lens, of the picture, its derivative
}

@group(2) @binding(11) var<uniform> ray_lenses: RayLenses;
@group(2) @binding(12) var ray_fields: texture_2d<f32>;     // one below the other, rows from low to high y

// The line that what is looked at lies on.
var<private> seen_ray: Ray;
var<private> seen_pixel: vec2f;
var<private> seen_distance: f32;
// That whose ray was asked for last.
var<private> asked_pixel: vec2f;

// A ray on its way.
struct Path {
    ray: Ray,
    bent: array<vec2f, max(RAY_PLANES, 1u)>,    // what each plane added to its slope
    is_round: bool,             // of a fisheye: no plane stands in its way
}

// How far a place of the picture is from the middle of a lens, in radii.
fn rim_share(lens: u32, across: vec2f) -> f32 {
    let place = (across - ray_lens(lens).center) / ray_lens(lens).radius;
    let reach = max(abs(place.x), abs(place.y));
    var share = select(length(place), reach, ray_lens(lens).outline == OUTLINE_SQUARE);
    if RAY_FIELDS && ray_lens(lens).outline == OUTLINE_FIELD {
        share = select(FAR_AWAY, field_share(ray_lens(lens).first_knot, place), reach < 1.0);
    }
    return share;
}

// The share that a field has at a place, -1..1: between texels linearly.
fn field_share(field: u32, place: vec2f) -> f32 {
    let side = f32(FIELD_SIDE);
    let at = clamp((0.5 * place + 0.5) * side - 0.5, vec2f(0.0), vec2f(side - 1.0));
    let low = min(floor(at), vec2f(side - 2.0));
    let share = at - low;
    let texel = vec2u(low) + vec2u(0u, field * FIELD_SIDE);
    let a = textureLoad(ray_fields, texel, 0).x;
    let b = textureLoad(ray_fields, texel + vec2u(1u, 0u), 0).x;
    let c = textureLoad(ray_fields, texel + vec2u(0u, 1u), 0).x;
    let d = textureLoad(ray_fields, texel + vec2u(1u, 1u), 0).x;
    return mix(mix(a, b, share.x), mix(c, d, share.x), share.y);
}

fn across_of_pixel(pixel: vec2f) -> vec2f {
    return pixel * view.across_from_pixel.xy + view.across_from_pixel.zw;
}

// The lenses that may bend the ray of a pixel, a bit for each.
fn lenses_over(pixel: vec2f) -> u32 {
    let across = across_of_pixel(pixel);
    var over = 0u;
    for (var lens = 0u; lens < RAY_IMAGES + RAY_PLANES; lens++) {
        over |= select(0u, 1u << lens, rim_share(lens, across) < 1.0);
    }
    return over;
}

fn is_bent(pixel: vec2f) -> bool {
    return lenses_over(pixel) != 0u;
}

// How many times as far as others the rays of the pixels within a reach turn at most, from one to the next, up to a distance.
fn most_stretch(pixel: vec2f, reach: f32, distance: f32) -> f32 {
    let across = across_of_pixel(pixel);
    let width = reach * max(abs(view.across_from_pixel.x), abs(view.across_from_pixel.y));
    var may = false;
    for (var lens = 0u; lens < RAY_IMAGES + RAY_PLANES; lens++) {
        let is_met = lens < RAY_IMAGES || distance <= 0.0 || distance > ray_lens(lens).distance;
        may |= is_met & (rim_share(lens, across) < 1.0 + 1.4143 * width / ray_lens(lens).radius);
    }
    return select(1.0, ray_lenses.stretch, may);
}

// The radius of the picture at one of a lens', by the radius; 1 at the rim.
fn sampled_scale(lens: u32, share: f32) -> f32 {
    let first = ray_lens(lens).first_knot;
    var low = 0u;
    var high = ray_lens(lens).knots - 1u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if ray_lenses.knots[first + middle].x <= share {
            low = middle;
        } else {
            high = middle;
        }
    }
    let a = ray_lenses.knots[first + low];
    let b = ray_lenses.knots[first + high];
    let step = b.x - a.x;
    let t = clamp((share - a.x) / step, 0.0, 1.0);
    let from_a = a.y * (1.0 + 2.0 * t) + a.z * step * t;
    let from_b = b.y * (3.0 - 2.0 * t) - b.z * step * (1.0 - t);
    let radius = (1.0 - t) * (1.0 - t) * from_a + t * t * from_b;
    return select(a.z, radius / share, share > 1e-6);
}

// Sine and cosine of 0 to half a turn, to two units of the last place: the built-in ones need not be right to more than 2^-11 (Moshier, Methods
// and Programs for Mathematical Functions, 1989).
fn sine_and_cosine(angle: f32) -> vec2f {
    let quarter = floor(angle * 1.27323954 + 1.0) * 0.5;
    let whole = floor(quarter);
    let x = ((angle - whole * 1.5703125) - whole * 4.8375129e-4) - whole * 7.5497899e-8;
    let z = x * x;
    let sine = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * x + x;
    let cosine = ((2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2) * z * z - 0.5 * z + 1.0;
    let turned = u32(whole) & 3u;
    let swapped = select(vec2f(sine, cosine), vec2f(cosine, -sine), turned == 1u || turned == 3u);
    return select(swapped, -swapped, turned >= 2u);
}

// The ray of a place of a fisheye.
fn round_ray(lens: u32, across: vec2f) -> Ray {
    let own = ray_lens(lens);
    let middle = select(own.center, vec2f(0.0), view.orthographic == 1u);
    let forward = normalize(vec3f(middle, -1.0));
    let right = normalize(vec3f(-forward.z, 0.0, forward.x));
    let up = cross(right, forward);
    let place = (across - own.center) / own.radius;
    let share = length(place);
    let is_angular = own.kind == RAY_ANGULAR;
    let widest = sine_and_cosine(own.angle).x;
    let angular = sine_and_cosine(own.angle * share);
    let sine = share * widest;
    // Of the angle from the axis; the sine by the radius, at 0 its limit.
    let cosine = select(sqrt(max(1.0 - sine * sine, 0.0)), angular.y, is_angular);
    let slope = select(widest, select(own.angle, angular.x / share, share > 1e-4), is_angular);
    return Ray(vec3f(0.0), normalize(cosine * forward + slope * (place.x * right + place.y * up)));
}

// Slopes beyond which what a handler says is a direction, not a place of the picture.
const MOST_SLOPE: f32 = 64.0;

// What a handler of the user's shows at a place of the picture, homogeneous: x, y and -z of view space; contained: where that is nothing that can be
// seen, the place itself.
fn own_seen(lens: u32, across: vec2f) -> vec3f {
    let own = ray_lens(lens);
    let is_flat = view.orthographic == 1u;
    let size = vec3f(own.radius, own.radius, select(1.0, 0.0, is_flat));
    let said = said_of_place(lens, (across - own.center) / own.radius, size);
    let seen = vec3f(own.center * said.z + own.radius * said.xy, said.z);
    let is_right = all(abs(seen) <= vec3f(3e38)) & any(seen != vec3f(0.0)) & ((seen.z > 0.0) | !is_flat);
    return select(vec3f(across, 1.0), seen, is_right);
}

fn is_place_of_picture(seen: vec3f) -> bool {
    return (view.orthographic == 1u) | ((seen.z > 0.0) & (max(abs(seen.x), abs(seen.y)) <= MOST_SLOPE * seen.z));
}

// The path of a ray that begins at a place of the picture.
fn path_of_place(place: vec2f) -> Path {
    var across = place;
    var path: Path;
    for (var lens = 0u; lens < RAY_IMAGES; lens++) {
        let share = rim_share(lens, across);
        let is_sampled = ray_lens(lens).kind == RAY_SAMPLED;
        let is_own = HAS_OWN_RAYS & (ray_lens(lens).kind == RAY_OWN);
        let is_met = share < 1.0 && !path.is_round && acts(lens);
        if is_met && is_own {
            let seen = own_seen(lens, across);
            path.is_round = !is_place_of_picture(seen);
            path.ray = Ray(vec3f(0.0), normalize(vec3f(seen.xy, -seen.z)));
            across = select(seen.xy / seen.z, across, path.is_round);
        }
        if is_met && !is_sampled && !is_own {
            path.ray = round_ray(lens, across);
            path.is_round = true;
        }
        if is_met && is_sampled {
            let center = ray_lens(lens).center;
            across = center + sampled_scale(lens, share) * (across - center);
        }
    }
    if !path.is_round {
        path.ray = straight_ray(across);
    }
    return path;
}

fn straight_ray(across: vec2f) -> Ray {
    let is_flat = view.orthographic == 1u;
    return Ray(vec3f(select(vec2f(0.0), across, is_flat), 0.0), vec3f(select(across, vec2f(0.0), is_flat), -1.0));
}

// What becomes of a ray there.
fn pass_event(path: ptr<function, Path>, number: u32) {
    let event = ray_event(number);
    // Of one alone nothing is looked for.
    let plane = select(event.lens - RAY_IMAGES, 0u, RAY_PLANES == 1u);
    let lens = ray_lens(RAY_IMAGES + plane);
    let is_flat = view.orthographic == 1u;
    let at = (*path).ray.origin.xy + event.distance * (*path).ray.direction.xy;
    let scale = select(event.distance, 1.0, is_flat);
    let share = rim_share(RAY_IMAGES + plane, at / scale);
    let k = select(0.0, max((share - (1.0 - lens.border)) / lens.border, 0.0), lens.border > 0.0);
    let is_met = share < 1.0 && acts(RAY_IMAGES + plane);
    let met = select(vec2f(0.0), -(1.0 - k) * lens.power * (at - scale * lens.center), is_met);
    let ends = event.ends == 1u;
    let by = select(met, (*path).bent[plane], ends);
    (*path).bent[plane] = by;
    // Of a ray that goes on as the eye sees that place.
    let goes_on = select(-lens.distance / event.distance, -1.0, is_flat);
    let begins = select(lens.distance, event.distance, is_flat);
    let slope = (*path).ray.direction.xy + select(1.0, goes_on, ends) * by;
    let origin = (*path).ray.origin.xy + select(-event.distance, begins, ends) * by;
    (*path).ray = Ray(vec3f(origin, 0.0), vec3f(slope, -1.0));
}

// The line on which a ray lies at a distance that begins at a place of the picture.
fn bent_by_planes(across: vec2f, distance: f32) -> Ray {
    var path: Path;
    path.ray = straight_ray(across);
    for (var i = 0u; i < 2u * RAY_PLANES; i++) {
        if ray_event(i).distance < distance {
            pass_event(&path, i);
        }
    }
    return path.ray;
}

// The line on which the ray of a place of the picture lies at a distance.
fn bent_ray(place: vec2f, distance: f32) -> Ray {
    var path = path_of_place(place);
    for (var i = 0u; i < 2u * RAY_PLANES; i++) {
        if !path.is_round && ray_event(i).distance < distance {
            pass_event(&path, i);
        }
    }
    return path.ray;
}

fn see_pixel(pixel: vec2f, distance: f32) {
    seen_pixel = pixel;
    asked_pixel = pixel;
    seen_distance = distance;
    seen_ray = bent_ray(across_of_pixel(pixel), distance);
}

// The place of the picture, (x, y, -1), of the pixel whose ray this is; and where, without lenses that bend rays, what its ray meets at a distance is
// seen.
fn picture_place(ray: Ray) -> vec3f {
    // That of what is looked at is known, whatever was asked for since.
    let is_seen = all(ray.origin == seen_ray.origin) && all(ray.direction == seen_ray.direction);
    return vec3f(across_of_pixel(select(asked_pixel, seen_pixel, is_seen)), -1.0);
}

fn picture_place_at(distance: f32, place: vec3f) -> vec3f {
    let ray = bent_ray(place.xy, distance);
    let at = ray.origin.xy + distance * ray.direction.xy;
    let seen = select(at / distance, at, view.orthographic == 1u);
    let is_round = ray.direction.z != -1.0;
    return select(place, vec3f(seen, -1.0), distance > 0.0 && !is_round);
}

// The line of a pixel at the distance of what is looked at.
fn ray_of_pixel(pixel: vec2f) -> Ray {
    asked_pixel = pixel;
    if all(pixel == seen_pixel) {
        return seen_ray;
    }
    return bent_ray(across_of_pixel(pixel), seen_distance);
}

// At that of something else.
fn ray_at_distance(pixel: vec2f, distance: f32) -> Ray {
    asked_pixel = pixel;
    return bent_ray(across_of_pixel(pixel), select(FAR_AWAY, distance, distance > 0.0));
}

// From which distance on, beyond this one, the ray of a pixel may lie on another line.
fn line_ends(pixel: vec2f, distance: f32) -> f32 {
    var end = FAR_AWAY;
    let may_turn = is_bent(pixel);
    for (var i = 0u; i < 2u * RAY_PLANES; i++) {
        let event = ray_event(i);
        let plane = select(event.lens - RAY_IMAGES, 0u, RAY_PLANES == 1u);
        let has_power = ray_lens(RAY_IMAGES + plane).power != 0.0;
        end = select(end, min(end, event.distance), may_turn && has_power && event.distance > distance);
    }
    return end;
}
