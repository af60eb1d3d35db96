// Deformations (Trapp §3.6): where places are shown, and what normals become. The same formulas as `geom::deform`, in f32. Which of them a
// scene calls for is written out by `shader::deforming`; their numbers stand where `render::deform_words` puts them, in `numbers` and
// `tables`, which the module that includes this binds.
//
// A place is a cell of a lattice (whole numbers of a power of two of a metre, from an anchor) and an offset in metres. Differences of
// cells are exact, so what is computed depends on where a lens is, not on where the city is: errors are some 2^-23 of the distance from
// its pivot.

// Numbers stand in fours. The first is the size of a cell, metres. Of a deformer:
const PIVOT: u32 = 0u;          // cells, as many as floats hold exactly
const PIVOT_OFFSET: u32 = 1u;   // metres
const AXES: u32 = 2u;           // A, B, N
const SUPPORT_LOW: u32 = 5u;
const SUPPORT_HIGH: u32 = 6u;
const CORNER: u32 = 7u;
const SIDES: u32 = 8u;          // 1/metres, twice; then border, or inner and outer, or columns and rows
const TEXELS: u32 = 9u;         // where they begin in `tables`
const BAND: u32 = 10u;          // low, high, 1/fade
const DEFORMER_NUMBERS: u32 = 11u;
// Numbers of a step: twice the reciprocal of how far apart samples may be; then its own.

fn cell_size() -> f32 {
    return numbers[0].x;
}

fn deformer_at(i: u32) -> u32 {
    return 1u + i * DEFORMER_NUMBERS;
}

// The frame of a lens: A, B, N as columns.
fn frame_axes(lens: u32) -> mat3x3f {
    return mat3x3f(numbers[lens + AXES].xyz, numbers[lens + AXES + 1u].xyz, numbers[lens + AXES + 2u].xyz);
}

// A place in the frame of a lens, metres.
fn in_frame(lens: u32, cell: vec3i, offset: vec3f) -> vec3f {
    let whole = cell - vec3i(numbers[lens + PIVOT].xyz);
    let way = vec3f(whole) * cell_size() + (offset - numbers[lens + PIVOT_OFFSET].xyz);
    return way * frame_axes(lens);
}

fn is_supported(lens: u32, p: vec3f) -> bool {
    return all(p >= numbers[lens + SUPPORT_LOW].xyz) && all(p <= numbers[lens + SUPPORT_HIGH].xyz);
}

// Adapters need not know a sine to more than 2^-11 (Vulkan); this one knows it to 2^-23. Half turns are taken off first.
fn sine(x: f32) -> f32 {
    let turns = round(x * 0.318309886);
    let r = (x - turns * 3.140625) - turns * 9.67653590e-4;
    let s = r * r;
    let series = r * (1.0 + s * (-0.166666667 + s * (8.33333333e-3 + s * (-1.98412698e-4 + s * (2.75573192e-6 - s * 2.50521084e-8)))));
    return select(series, -series, (i32(turns) & 1) == 1);
}

// sin x and cos x - 1.
fn turn(x: f32) -> vec2f {
    let half = sine(0.5 * x);
    return vec2f(sine(x), -2.0 * half * half);
}

fn sinc(x: f32) -> f32 {
    let s = x * x;
    return select(sine(x) / x, 1.0 - s * (0.166666667 - s * 8.33333333e-3), abs(x) < 0.05);
}

fn smooth01(q: f32) -> f32 {
    return q * q * (3.0 - 2.0 * q);
}

fn smooth01_slope(q: f32) -> f32 {
    return 6.0 * q * (1.0 - q);
}

// 1 for low <= x <= high, else 0: the derivative of clamping.
fn clamp_slope(x: f32, low: f32, high: f32) -> f32 {
    return select(0.0, 1.0, x >= low && x <= high);
}

// How strong a lens is at a place of its frame, and the gradient.
struct Kappa {
    value: f32,
    slope: vec3f,
}

// A function of s, and its derivative.
fn trapezoid(s: f32, border: f32) -> vec2f {
    let rate = 1.0 / border;
    let up = s * rate;
    let down = (1.0 - s) * rate;
    let slope = (clamp_slope(up, 0.0, 1.0) - clamp_slope(down, 0.0, 1.0)) * rate;
    return vec2f(clamp(min(up, down), 0.0, 1.0), slope);
}

fn smoothed(f: vec2f) -> vec2f {
    return vec2f(smooth01(f.x), smooth01_slope(f.x) * f.y);
}

// The two texels beside a place along one side: numbers from 1, 0 and count + 1 are the zeros on the border; the part of the way between
// them; and its derivative.
struct Knots {
    first: u32,
    part: f32,
    rate: f32,
}

fn knots(s: f32, count: u32) -> Knots {
    let size = f32(count);
    let p = s * size - 0.5;
    let last = size - 1.0;
    if p < 0.0 {
        return Knots(0u, max(2.0 * p + 1.0, 0.0), 2.0 * size);
    }
    if p >= last {
        return Knots(count, min(2.0 * (p - last), 1.0), 2.0 * size);
    }
    let first = floor(p);
    return Knots(u32(first) + 1u, p - first, size);
}

fn texel(first: u32, x: u32, y: u32, count: vec2u) -> f32 {
    let is_inside = x >= 1u && y >= 1u && x <= count.x && y <= count.y;
    let at = select(0u, (y - 1u) * count.x + x - 1u, is_inside);
    return select(0.0, tables[first + at], is_inside);
}

// Profiles: value and derivatives by s and t. Texels are filtered by hand.
fn texels(lens: u32, st: vec2f) -> vec3f {
    let count = vec2u(numbers[lens + SIDES].zw);
    let first = u32(numbers[lens + TEXELS].x);
    let columns = knots(st.x, count.x);
    let rows = knots(st.y, count.y);
    let a = texel(first, columns.first, rows.first, count);
    let b = texel(first, columns.first + 1u, rows.first, count);
    let c = texel(first, columns.first, rows.first + 1u, count);
    let d = texel(first, columns.first + 1u, rows.first + 1u, count);
    let low = a * (1.0 - columns.part) + b * columns.part;
    let high = c * (1.0 - columns.part) + d * columns.part;
    let by_s = columns.rate * ((b - a) * (1.0 - rows.part) + (d - c) * rows.part);
    return vec3f(low * (1.0 - rows.part) + high * rows.part, by_s, rows.rate * (high - low));
}

fn linear_plateau(lens: u32, st: vec2f) -> vec3f {
    let border = numbers[lens + SIDES].z;
    let s = trapezoid(st.x, border);
    let t = trapezoid(st.y, border);
    return vec3f(s.x * t.x, s.y * t.x, s.x * t.y);
}

fn smooth_plateau(lens: u32, st: vec2f) -> vec3f {
    let border = numbers[lens + SIDES].z;
    let s = smoothed(trapezoid(st.x, border));
    let t = smoothed(trapezoid(st.y, border));
    return vec3f(s.x * t.x, s.y * t.x, s.x * t.y);
}

fn bump(lens: u32, st: vec2f) -> vec3f {
    let at = 2.0 * st - 1.0;
    let rest = max(1.0 - dot(at, at), 0.0);
    return vec3f(rest * rest, -8.0 * rest * at);
}

fn ring(lens: u32, st: vec2f) -> vec3f {
    let radii = numbers[lens + SIDES].zw;
    let at = 2.0 * st - 1.0;
    let middle = 0.5 * (radii.y * radii.y + radii.x * radii.x);
    let half = 0.5 * (radii.y * radii.y - radii.x * radii.x);
    let v = clamp((dot(at, at) - middle) / half, -1.0, 1.0);
    let rest = 1.0 - v * v;
    return vec3f(rest * rest, -16.0 / half * rest * v * at);
}

// s and t of a place of the frame.
fn on_plane(lens: u32, p: vec3f) -> vec2f {
    return clamp((p.xy - numbers[lens + CORNER].xy) * numbers[lens + SIDES].xy, vec2f(0.0), vec2f(1.0));
}

fn kappa_of(lens: u32, profile: vec3f) -> Kappa {
    return Kappa(profile.x, vec3f(profile.yz * numbers[lens + SIDES].xy, 0.0));
}

// The same in a band of heights.
fn in_band(lens: u32, p: vec3f, kappa: Kappa) -> Kappa {
    let height = p.z - numbers[lens + CORNER].z;
    let band = numbers[lens + BAND].xyz;
    let up = band_end((height - band.x) * band.z, band.z);
    let down = band_end((band.y - height) * band.z, band.z);
    let level = up.x * down.x;
    return Kappa(kappa.value * level, vec3f(kappa.slope.xy * level, kappa.value * (up.y * down.x - up.x * down.y)));
}

fn band_end(q: f32, rate: f32) -> vec2f {
    return smoothed(vec2f(clamp(q, 0.0, 1.0), clamp_slope(q, 0.0, 1.0) * rate));
}

// Changes of a place by a step: g(p) - p, and its derivative (columns: by x, y, z). Steps are handlers, `shaders/effect`.
struct Jet {
    way: vec3f,
    slope: mat3x3f,
}

// What goes linearly between two ends, and its derivative.
fn linear(at: f32, ends: vec2f, values: vec2f) -> vec2f {
    let rate = (values.y - values.x) / (ends.y - ends.x);
    return vec2f((clamp(at, ends.x, ends.y) - ends.x) * rate + values.x, clamp_slope(at, ends.x, ends.y) * rate);
}

const NO_SLOPE = mat3x3f(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

// A way as a user's handler gives it: no farther than it says along each axis, nothing where it is no number, and as strong as asked for.
fn contained_way(way: vec3f, reach: f32, strength: f32) -> vec3f {
    let is_number = abs(way) <= vec3f(3e38);
    return clamp(select(vec3f(0.0), way, is_number), vec3f(-reach), vec3f(reach)) * strength;
}

// What comes after steps that lead to a place with such a derivative.
fn then(before: Jet, next: Jet) -> Jet {
    return Jet(before.way + next.way, before.slope + next.slope + next.slope * before.slope);
}

// How far a place is moved, metres, and what a normal there becomes (not of unit length).
struct Shown {
    way: vec3f,
    normal: vec3f,
}

// The same after a lens more, where a place of its support is.
fn moved_on(shown: Shown, lens: u32, kappa: Kappa, jet: Jet) -> Shown {
    let axes = frame_axes(lens);
    var a = kappa.value * jet.slope[0] + jet.way * kappa.slope.x;
    var b = kappa.value * jet.slope[1] + jet.way * kappa.slope.y;
    var c = kappa.value * jet.slope[2] + jet.way * kappa.slope.z;
    a.x += 1.0;
    b.y += 1.0;
    c.z += 1.0;
    // The cofactor matrix takes normals on, whatever the size of the determinant.
    let normal = axes * (mat3x3f(cross(b, c), cross(c, a), cross(a, b)) * (shown.normal * axes));
    return Shown(shown.way + axes * (kappa.value * jet.way), normal);
}

//@deformers
