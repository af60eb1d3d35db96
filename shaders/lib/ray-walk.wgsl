// Bent rays followed through the triangles of the city.
//
// Of each city that is drawn there is a hierarchy of boxes (`render::ray_city`) over triangles whose corners are whole steps of a grid, so that
// the corners of neighbours are the same to the bit. A ray is tested against a triangle by the signs of the three edges that it passes (Woop,
// Benthin, Wald: Watertight Ray/Triangle Intersection, JCGT 2013): where f32 cannot tell them, by whole numbers, so that nothing leaks
// through an edge that two triangles share. What hides fragments elsewhere (`visible`) is asked of each hit.

// Words are four u32 each. A box: two, least corner and first, greatest corner and count; of an inner box the count is 0 and `first` is that of its two
// boxes. A triangle: three, a corner each and its surface, what it is (TRIANGLE_*), and where its rest begins, counted from the first box.
struct RayCity {
    from_view_x: vec4f,         // columns of the turn and scale from view space to the city's own; w: metres of a step of its grid
    from_view_y: vec4f,
    from_view_z: vec4f,
    eye: vec3i,                 // steps of the grid
    surfaces: u32,              // where its surfaces begin in the table
    eye_fraction: vec3f,        // steps, -0.5..0.5, or where the eye is far off, all that is left
    number: u32,                // of the content; 0: the scene's own
    eye_in_boxes: vec3f,        // where boxes are counted, metres
    boxes: u32,                 // where they begin; without any NO_BOXES
    triangles: u32,             // where they begin
    world_x: vec4f,             // columns of the turn and scale from its own space to the world's; w: the scale
    world_y: vec4f,
    world_z: vec4f,
}

const NO_BOXES: u32 = 0xffffffffu;
const TRIANGLE_IN_PLANE: u32 = 1u;      // its depth is that of a plane, which is the first of its rest
const TRIANGLE_FACADE: u32 = 2u;        // with storeys and windows
const TRIANGLE_LAYER_SHIFT: u32 = 8u;   // which layer of its plane it is, 8 bits
const TRIANGLE_LAYERS: u32 = 0xffu;
const TRIANGLE_SECTION_SHIFT: u32 = 16u;    // above it: which section it is of, from 1, where that has images
const TRIANGLE_SMOOTH: u32 = 4u;        // with a normal per corner
const TRIANGLE_PLACED: u32 = 8u;        // with texture coordinates
const MOST_DEPTH: u32 = 64u;

struct RayCities {
    count: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    all: array<RayCity, 128>,
}

//@bindings

//@handlers

// A ray in the space of a city: metres from the eye, and boxes.
struct CityRay {
    origin: vec3f,              // relative to the eye
    direction: vec3f,
    boxed: vec3f,               // the origin where boxes are counted
    inverse: vec3f,             // of the direction, finite
    axes: vec3u,                // the last is that along which it goes most
    shear: vec2f,
    // Where places of the city are counted from: as `RayCity` has it.
    eye: vec3i,
    eye_fraction: vec3f,        // what is left of it, steps
    step: f32,                  // metres
}

fn component(v: vec3f, axis: u32) -> f32 {
    return select(select(v.z, v.y, axis == 1u), v.x, axis == 0u);
}

fn city_ray(number: u32, ray: Ray) -> CityRay {
    let own = ray_cities.all[number];
    let turn = mat3x3f(own.from_view_x.xyz, own.from_view_y.xyz, own.from_view_z.xyz);
    let origin = turn * ray.origin;
    let direction = turn * ray.direction;
    let size = abs(direction);
    let along = select(select(2u, 1u, size.y >= size.z), 0u, size.x >= size.y && size.x >= size.z);
    let axes = vec3u((along + 1u) % 3u, (along + 2u) % 3u, along);
    let main = component(direction, along);
    let shear = vec2f(component(direction, axes.x), component(direction, axes.y)) / main;
    // 2^-80 in place of 0: what it is divided by stays a number.
    let least = select(vec3f(8.2718061e-25), vec3f(-8.2718061e-25), direction < vec3f(0.0));
    let divisor = select(direction, least, size < vec3f(8.2718061e-25));
    return CityRay(origin, direction, own.eye_in_boxes + origin, 1.0 / divisor, axes, shear, own.eye, own.eye_fraction, own.from_view_x.w);
}

// Where a ray is in a box, of its parameter: a little more than that.
fn span_in_box(ray: CityRay, low: vec3f, high: vec3f) -> vec2f {
    let a = (low - ray.boxed) * ray.inverse;
    let b = (high - ray.boxed) * ray.inverse;
    let near = min(a, b);
    let far = max(a, b);
    // Division is right to 2.5 units of the last place.
    let enter = max(max(near.x, near.y), near.z);
    let leave = min(min(far.x, far.y), far.z);
    return vec2f(enter - 2e-6 * abs(enter), leave + 2e-6 * abs(leave));
}

// ---- products of f32, compared exactly: 24 bits times 24 bits are 48

struct Product {
    high: u32,
    low: u32,
    exponent: i32,
    sign: i32,                  // 0: the product is 0
}

fn product(a: f32, b: f32) -> Product {
    let x = bitcast<u32>(a);
    let y = bitcast<u32>(b);
    let e = vec2i(vec2u(x, y) >> vec2u(23u) & vec2u(0xffu));
    if e.x == 0 || e.y == 0 {
        return Product(0u, 0u, 0, 0);
    }
    let m = (vec2u(x, y) & vec2u(0x7fffffu)) | vec2u(0x800000u);
    // 12 bits each.
    let top = m >> vec2u(12u);
    let rest = m & vec2u(0xfffu);
    let middle = top.x * rest.y + rest.x * top.y;
    let bottom = rest.x * rest.y + ((middle & 0xfffffu) << 12u);
    let carry = select(0u, 1u, bottom < (rest.x * rest.y));
    // 2^32 times this, and the rest.
    let high = ((top.x * top.y) >> 8u) + (middle >> 20u) + carry;
    let shifted = (top.x * top.y) << 24u;
    let low = bottom + shifted;
    let sign = select(1, -1, ((x ^ y) >> 31u) == 1u);
    return Product(high + select(0u, 1u, low < shifted), low, e.x + e.y, sign);
}

// The sign of |p| - |q|.
fn compared(p: Product, q: Product) -> i32 {
    let by = p.exponent - q.exponent;
    if by > 2 {
        return 1;
    }
    if by < -2 {
        return -1;
    }
    // Both have 47 or 48 bits: two more fit.
    let of_p = u32(max(by, 0));
    let of_q = u32(max(-by, 0));
    let a = vec2u(select((p.high << of_p) | (p.low >> (32u - max(of_p, 1u))), p.high, of_p == 0u), p.low << of_p);
    let b = vec2u(select((q.high << of_q) | (q.low >> (32u - max(of_q, 1u))), q.high, of_q == 0u), q.low << of_q);
    if a.x != b.x {
        return select(-1, 1, a.x > b.x);
    }
    return select(select(0, -1, a.y < b.y), 1, a.y > b.y);
}

// A number of the sign of a * b - c * d, and where f32 can tell it that.
fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let p = a * b;
    let q = c * d;
    let difference = p - q;
    if abs(difference) > 4e-7 * (abs(p) + abs(q)) {
        return difference;
    }
    let exact_p = product(a, b);
    let exact_q = product(c, d);
    var sign = exact_p.sign - exact_q.sign;
    if exact_p.sign == exact_q.sign {
        sign = exact_p.sign * compared(exact_p, exact_q);
    }
    // So small that it says nothing but its sign.
    return f32(clamp(sign, -1, 1)) * max(abs(difference), 1e-38);
}

// ---- triangles

struct Hit {
    t: f32,                     // FAR_AWAY: none
    triangle: u32,              // where its words begin
    city: u32,
    weights: vec2f,             // of its second and third corner
}

const NO_HIT = Hit(1e30, 0u, 0u, vec2f(0.0));

// A corner relative to where the ray begins, sheared along it: the same for all triangles that have it.
fn sheared(ray: CityRay, words: vec4u) -> vec3f {
    let relative = (vec3f(vec3i(words.xyz) - ray.eye) - ray.eye_fraction) * ray.step - ray.origin;
    let depth = component(relative, ray.axes.z);
    return vec3f(component(relative, ray.axes.x) - ray.shear.x * depth, component(relative, ray.axes.y) - ray.shear.y * depth, depth);
}

// Where a ray meets a triangle.
fn hit_of(number: u32, ray: CityRay, triangle: u32) -> Hit {
    let words = ray_words[triangle + 1u];
    let a = sheared(ray, ray_words[triangle]);
    let b = sheared(ray, words);
    let c = sheared(ray, ray_words[triangle + 2u]);
    let u = difference_of_products(b.x, c.y, b.y, c.x);
    let v = difference_of_products(c.x, a.y, c.y, a.x);
    let w = difference_of_products(a.x, b.y, a.y, b.x);
    let sum = u + v + w;
    let is_out = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
    if is_out || sum == 0.0 {
        return NO_HIT;
    }
    let depth = (u * a.z + v * b.z + w * c.z) / sum;
    var t = depth / component(ray.direction, ray.axes.z);
    if (words.w & TRIANGLE_IN_PLANE) != 0u {
        t = distance_to_plane(ray, ray_cities.all[number].boxes + ray_words[triangle + 2u].w, t);
    }
    return Hit(t, triangle, number, vec2f(v, w) / sum);
}

// Faces of one plane are equally far, to the bit; `t`: where the ray goes along the plane.
fn distance_to_plane(ray: CityRay, rest: u32, t: f32) -> f32 {
    let normal = bitcast<vec3f>(ray_words[rest].xyz);
    let relative = (vec3f(vec3i(ray_words[rest + 1u].xyz) - ray.eye) - ray.eye_fraction) * ray.step - ray.origin;
    let slope = dot(normal, ray.direction);
    let found = (dot(normal, relative) + bitcast<f32>(ray_words[rest].w)) / slope;
    return select(t, found, abs(slope) > 1e-6 * length(ray.direction));
}

// Of two hits that are as far, whether the second one lies over the first.
fn lies_over(first: Hit, second: Hit) -> bool {
    let layer_of_first = (ray_words[first.triangle + 1u].w >> TRIANGLE_LAYER_SHIFT) & TRIANGLE_LAYERS;
    let layer_of_second = (ray_words[second.triangle + 1u].w >> TRIANGLE_LAYER_SHIFT) & TRIANGLE_LAYERS;
    return layer_of_second > layer_of_first || (layer_of_second == layer_of_first && second.triangle < first.triangle);
}

fn code_of(hit: Hit) -> u32 {
    return ray_words[hit.triangle].w + ray_cities.all[hit.city].surfaces + 1u;
}

fn object_of(hit: Hit) -> u32 {
    return surface_at(code_of(hit) - 1u).object;
}

// The first that a straight piece of a ray meets from `from` to `to`, nearer than `best`, and is there.
fn first_in_city(at: vec2f, number: u32, line: Ray, range: vec2f, best: Hit) -> Hit {
    let own = ray_cities.all[number];
    var found = best;
    begin_city(number);
    seen_ray = line;
    seen_pixel = at;
    asked_pixel = at;
    let ray = city_ray(number, line);
    var stack: array<u32, 64>;
    var height = select(1u, 0u, own.boxes == NO_BOXES);
    stack[0] = own.boxes;
    while height > 0u {
        height -= 1u;
        let box = stack[height];
        let low = ray_words[box];
        let high = ray_words[box + 1u];
        let span = span_in_box(ray, bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz));
        let is_met = span.x <= span.y && span.y >= range.x && span.x <= min(range.y, found.t);
        if is_met && high.w == 0u {
            // The nearer one is looked at first.
            let first = own.boxes + 2u * low.w;
            let a = span_in_box(ray, bitcast<vec3f>(ray_words[first].xyz), bitcast<vec3f>(ray_words[first + 1u].xyz));
            let b = span_in_box(ray, bitcast<vec3f>(ray_words[first + 2u].xyz), bitcast<vec3f>(ray_words[first + 3u].xyz));
            let swap = a.x <= b.x;
            stack[height] = select(first, first + 2u, swap);
            stack[height + 1u] = select(first + 2u, first, swap);
            height += 2u;
        }
        if is_met {
            for (var i = 0u; i < high.w; i++) {
                let hit = hit_of(number, ray, own.triangles + 3u * (low.w + i));
                let is_nearer = hit.t < found.t || (hit.t == found.t && hit.t < FAR_AWAY && lies_over(found, hit));
                if is_nearer && hit.t >= range.x && hit.t <= range.y && is_in_set(object_of(hit)) {
                    //@met
                }
            }
        }
    }
    return found;
}

// The first that the ray of a pixel meets nearer than `last`: of each set of lenses that may act on something, among what it acts on.
fn first_of_pixel(at: vec2f, last: Hit) -> Hit {
    var found = last;
    for (var number = 0u; number < (1u << RAY_CHOOSING); number++) {
        see_set(number);
        found = first_on_path(at, found);
    }
    return found;
}

// Where the ray that is followed turned last, on which line it was before, and by how much both lines overlap there: either may round what is just
// there to the other's side.
var<private> turned_at: f32;
var<private> turned_from: Ray;
var<private> turned_by: f32;

// Whether what is met about where the ray turned was met on the line before already.
fn is_met_before(hit: Hit) -> bool {
    if abs(hit.t - turned_at) > turned_by {
        return false;
    }
    return hit_of(hit.city, city_ray(hit.city, turned_from), hit.triangle).t <= turned_at;
}

fn first_on_path(at: vec2f, last: Hit) -> Hit {
    var path = path_of_place(across_of_pixel(at));
    var found = last;
    var begin = view.near;
    turned_at = -1.0;
    turned_by = 0.0;
    let count = select(2u * RAY_PLANES, 0u, path.is_round);
    for (var i = 0u; i <= count; i++) {
        var end = FAR_AWAY;
        if i < count {
            end = ray_event(i).distance;
        }
        if found.t > begin && end > begin {
            for (var number = 0u; number < ray_cities.count; number++) {
                found = first_in_city(at, number, path.ray, vec2f(begin - turned_by, end), found);
            }
            begin = end;
            turned_at = end;
            turned_from = path.ray;
            // Two units of 2^-22.
            turned_by = 4.7683716e-7 * end;
        }
        if i < count {
            pass_event(&path, i);
        }
    }
    return found;
}

// Words of a triangle's rest behind its plane: of each corner its normal, then its texture coordinates.
fn rest_of(hit: Hit) -> u32 {
    let is_in_plane = (ray_words[hit.triangle + 1u].w & TRIANGLE_IN_PLANE) != 0u;
    return ray_cities.all[hit.city].boxes + ray_words[hit.triangle + 2u].w + select(0u, 2u, is_in_plane);
}

// Where a line meets the plane of a triangle: the weights of its second and third corner, and how far.
fn plane_met(hit: Hit, line: Ray) -> vec3f {
    let ray = city_ray(hit.city, line);
    let a = sheared(ray, ray_words[hit.triangle]);
    let b = sheared(ray, ray_words[hit.triangle + 1u]);
    let c = sheared(ray, ray_words[hit.triangle + 2u]);
    let u = b.x * c.y - b.y * c.x;
    let v = c.x * a.y - c.y * a.x;
    let w = a.x * b.y - a.y * b.x;
    let sum = u + v + w;
    var t = (u * a.z + v * b.z + w * c.z) / sum / component(ray.direction, ray.axes.z);
    if (ray_words[hit.triangle + 1u].w & TRIANGLE_IN_PLANE) != 0u {
        t = distance_to_plane(ray, ray_cities.all[hit.city].boxes + ray_words[hit.triangle + 2u].w, t);
    }
    return vec3f(vec2f(v, w) / sum, t);
}

// The weights of the corners where the line of a pixel meets it.
fn weights_beside(at: vec2f, hit: Hit) -> vec2f {
    return plane_met(hit, bent_ray(across_of_pixel(at), hit.t)).xy;
}

fn texcoords_of(rest: u32) -> mat3x2f {
    let first = bitcast<vec4f>(ray_words[rest]);
    let second = bitcast<vec4f>(ray_words[rest + 1u]);
    return mat3x2f(first.xy, first.zw, second.xy);
}

fn texcoord_of(corners: mat3x2f, weights: vec2f) -> vec2f {
    return corners * vec3f(1.0 - weights.x - weights.y, weights);
}

// How much of the colour storeys and windows leave.
fn facade_share(at: vec2f, hit: Hit, rest: u32) -> f32 {
    let corners = texcoords_of(rest);
    let here = texcoord_of(corners, hit.weights);
    let right = texcoord_of(corners, weights_beside(at + vec2f(1.0, 0.0), hit));
    let below = texcoord_of(corners, weights_beside(at + vec2f(0.0, 1.0), hit));
    return facade_at(here, abs(right - here) + abs(below - here));
}

// The normal of a triangle that has one per corner.
fn normal_code_of(hit: Hit, rest: u32) -> u32 {
    let own = ray_cities.all[hit.city];
    let codes = ray_words[rest];
    let weights = vec3f(1.0 - hit.weights.x - hit.weights.y, hit.weights);
    let normal = mat3x3f(decode_normal(codes.x), decode_normal(codes.y), decode_normal(codes.z)) * weights;
    return encode_normal(mat3x3f(own.world_x.xyz, own.world_y.xyz, own.world_z.xyz) * normal / own.world_x.w);
}

// What a hit looks like.
struct HitLook {
    color: vec3f,               // linear, with storeys and windows
    facade: f32,                // how much of it these leave
    normal: u32,                // octahedral; 0 where the picture has none
}

fn look_of(at: vec2f, hit: Hit) -> HitLook {
    let surface = surface_at(code_of(hit) - 1u);
    see_object(surface.object);
    let kind = ray_words[hit.triangle + 1u].w;
    var rest = rest_of(hit);
    var normal = surface.normal;
    if SMOOTH && (kind & TRIANGLE_SMOOTH) != 0u {
        normal = normal_code_of(hit, rest);
    }
    rest += select(0u, 1u, (kind & TRIANGLE_SMOOTH) != 0u);
    var share = 1.0;
    if (kind & TRIANGLE_FACADE) != 0u {
        share = facade_share(at, hit, rest);
    }
    return HitLook(surface.color * share, share, select(0u, normal, SMOOTH));
}

// What passes write of what they find, where geometry passes write what they draw.
struct Followed {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    @location(3) hit: vec2u,    // triangle + 1, city: whose images are looked at then
    @builtin(frag_depth) depth: f32,
}
