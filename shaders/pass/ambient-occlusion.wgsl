// How much of the sky's light arrives at what a picture of one sample shows, as far as the picture itself can tell: horizon-based ambient
// occlusion with the cosine's exact integral (Jimenez and others 2016), at half the resolution.
//
// A slice is a plane through the ray to the eye. In it the horizon is the highest that the picture shows on either side; between the two, in
// front of the face, and above the ground's horizon, the sky is seen. The integral over that, over the same without anything in the way, is the
// share that arrives: it is 1 for a lone wall, half of whose light comes from the ground.
//
// Four texels side by side look in different directions; where they are read, all four are (`lib/light.wgsl`).

override SMOOTH: bool = false;      // whether normals are in the target, not with the surfaces

@group(1) @binding(6) var codes: texture_2d<u32>;
@group(1) @binding(7) var scene_depth: texture_depth_2d;

const PI: f32 = 3.14159265;
const HALF_PI: f32 = 1.57079633;

const SLICES: i32 = 1;
const STEPS: i32 = 4;
// How far things count, metres; from the first share of it on less and less.
const FARTHEST_M: f32 = 60.0;
const FULL: f32 = 0.6;
// And pixels, as a share of the picture's height.
const FARTHEST: f32 = 0.5;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

fn place(pixel: vec2i, depth: f32) -> vec3f {
    let ray = ray_of_pixel(vec2f(pixel) + 0.5);
    return ray.origin + distance_of_depth(depth) * ray.direction;
}

// Where angles from the ray to the eye lie between a and b, of the light of a slice whose face is turned by n: from 0 on.
fn integral(angle: f32, n: f32) -> f32 {
    return sign(angle) * 0.25 * (cos(n) + 2.0 * angle * sin(n) - cos(2.0 * angle - n));
}

// The same between two angles before the face, above the ground's horizon: within a right angle of `zenith`. Angles go around; of two such half
// circles what is in both is in one piece.
fn of_sky(low: f32, high: f32, n: f32, zenith: f32) -> f32 {
    let middle = zenith - 2.0 * PI * round((zenith - n) / (2.0 * PI));
    let a = clamp(middle - HALF_PI, low, high);
    let b = clamp(middle + HALF_PI, low, high);
    return max(integral(b, n) - integral(a, n), 0.0);
}

// The cosine of the horizon on one side, from the ray to the eye; at least `least`.
fn horizon(pixel: vec2i, at: vec3f, to_eye: vec3f, way: vec2f, first: f32, least: f32) -> f32 {
    var highest = least;
    let most = vec2i(view.size) - 1;
    for (var i = 0; i < STEPS; i++) {
        let share = (f32(i) + first) / f32(STEPS);
        let beside = vec2i(round(way * (share * share)));
        let seen = pixel + beside + vec2i(sign(way)) * select(0, 1, all(beside == vec2i(0)));
        let depth = textureLoad(scene_depth, clamp(seen, vec2i(0), most), 0);
        let is_known = depth > 0.0 && all(seen >= vec2i(0)) && all(seen <= most);
        let step = place(seen, select(0.5, depth, is_known)) - at;
        let squared = max(dot(step, step), 1e-12);
        let per_far = inverseSqrt(squared);
        let height = dot(step, to_eye) * per_far;
        let weight = clamp((1.0 - squared * per_far / FARTHEST_M) / (1.0 - FULL), 0.0, 1.0);
        highest = max(highest, select(least, mix(least, height, weight), is_known));
    }
    return highest;
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec2f {
    let texel = vec2i(at.xy);
    let pixel = min(texel * 2, vec2i(view.size) - 1);
    let depth = textureLoad(scene_depth, pixel, 0);
    if depth == 0.0 {
        return vec2f(1.0, 0.0);
    }
    let code = textureLoad(codes, pixel, 0).xy;
    var normal_code = code.y;
    if !SMOOTH {
        normal_code = surface_at(code.x - 1u).normal;
    }
    let here = place(pixel, depth);
    let to_eye = select(-normalize(here), vec3f(0.0, 0.0, 1.0), view.orthographic == 1u);
    var normal = view.view_from_world * decode_normal(normal_code);
    normal *= select(1.0, -1.0, dot(normal, to_eye) < 0.0);
    let up = view.view_from_world[2];
    let metres = abs(2.0 / (view.projection.y * view.size.y)) * select(distance_of_depth(depth), 1.0, view.orthographic == 1u);
    let reach = clamp(FARTHEST_M / metres, 2.0, FARTHEST * view.size.y);
    let quarter = f32((texel.x & 1) + 2 * (texel.y & 1));
    let first = fract(0.35 + 0.618034 * quarter) * 0.9 + 0.1;
    var seen = 0.0;
    var open = 0.0;
    for (var slice = 0; slice < SLICES; slice++) {
        let angle = (f32(slice) + 0.25 * quarter) * (PI / f32(SLICES));
        let way = vec2f(cos(angle), sin(angle));
        let aside = vec3f(way, 0.0) - dot(vec3f(way, 0.0), to_eye) * to_eye;
        let side = aside * inverseSqrt(max(dot(aside, aside), 1e-12));
        let across = cross(side, to_eye);
        let turned = normal - dot(normal, across) * across;
        let share = length(turned);
        let n = sign(dot(side, turned)) * acos(clamp(dot(turned, to_eye) / max(share, 1e-6), -1.0, 1.0));
        // Rows of pixels go down.
        let pixels = vec2f(way.x, -way.y) * reach;
        let after = acos(horizon(pixel, here, to_eye, pixels, first, cos(min(n + HALF_PI, PI))));
        let before = -acos(horizon(pixel, here, to_eye, -pixels, first, cos(max(n - HALF_PI, -PI))));
        let zenith = atan2(dot(up, side), dot(up, to_eye));
        let low = max(before, n - HALF_PI);
        let high = min(after, n + HALF_PI);
        seen += share * of_sky(low, high, n, zenith);
        open += share * of_sky(n - HALF_PI, n + HALF_PI, n, zenith);
    }
    return vec2f(select(1.0, clamp(seen / max(open, 1e-4), 0.0, 1.0), open > 1e-3), depth);
}
