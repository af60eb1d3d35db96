// Colour spaces. Shading is linear; OKLab (Ottosson 2020) where lightness must move without hue.

// Both ways by polynomials where the standard has powers: these are long on a software adapter. Channels within 0..1. Each is
// summed in pairs (Estrin's scheme): what one effect makes is what the next begins with, so that a chain of effects takes as
// long as its operations wait for each other. Their twins are tested.

// Within 2.5e-6.
fn linear_from_srgb(c: vec3f) -> vec3f {
    let c2 = c * c;
    let low = (0.000875111499 + 0.0344924766 * c) + (0.496140214 + 0.795216045 * c) * c2;
    let high = (-0.639369665 + 0.511841304 * c) + (-0.255237423 + 0.0560430913 * c) * c2;
    return select(min(low + high * (c2 * c2), vec3f(1.0)), c * (1.0 / 12.92), c <= vec3f(0.04045));
}

// Within 2e-6, half a thousandth of a byte's step: in the fourth root of c.
fn srgb_from_linear(c: vec3f) -> vec3f {
    let square = sqrt(c);
    let root = sqrt(square);
    let low = (-0.0596417498 + 0.140776781 * root) + (1.36022559 - 0.838965334 * root) * square;
    let high = (0.638769462 - 0.306036986 * root) + 0.0648733212 * square;
    return select(min(low + high * c, vec3f(1.0)), 12.92 * c, c <= vec3f(0.0031308));
}

// Relative luminance of linear Rec. 709 / sRGB primaries.
fn luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}

// Within 6e-7 of it above 1e-18, and within 1.1e-6 for what is less, which counts as 1e-18; without a power or a division. Less
// a third of the exponent is a first guess of the inverse root, off by 3.5 % at most; by how much is known, and
// (1 - off)^(-2/3) makes up for it: a polynomial (Remez, 3e-7). Its twin is tested.
fn cube_root(x: vec3f) -> vec3f {
    let some = max(x, vec3f(1e-18));
    let inverse = bitcast<vec3f>(1419900000 - vec3i(vec3f(bitcast<vec3i>(some)) * (1.0 / 3.0)));
    let part = some * inverse;
    let off = 1.0 - part * (inverse * inverse);
    let off2 = off * off;
    return part * inverse * ((1.0 + 0.66665207 * off) + ((0.55553394 + 0.49939994 * off) + 0.45872923 * off2) * off2);
}

// OKLab is a turn and a stretch of the cube roots of what three kinds of cones take up, and grey has three equal roots. What
// only moves lightness, or only scales what is beside it, is done on the roots: it is less, and the same.
fn cone_roots(c: vec3f) -> vec3f {
    let lms = vec3f(
        dot(c, vec3f(0.4122214708, 0.5363325363, 0.0514459929)),
        dot(c, vec3f(0.2119034982, 0.6806995451, 0.1073969566)),
        dot(c, vec3f(0.0883024619, 0.2817188376, 0.6299787005)));
    return cube_root(lms);
}

// OKLab's lightness.
fn lightness_of_roots(r: vec3f) -> f32 {
    return dot(r, vec3f(0.2104542553, 0.7936177850, -0.0040720468));
}

fn linear_from_roots(r: vec3f) -> vec3f {
    let lms = r * r * r;
    return vec3f(
        dot(lms, vec3f(4.0767416621, -3.3077115913, 0.2309699292)),
        dot(lms, vec3f(-1.2684380046, 2.6097574011, -0.3413193965)),
        dot(lms, vec3f(-0.0041960863, -0.7034186147, 1.7076147010)));
}

fn oklab_from_linear(c: vec3f) -> vec3f {
    let r = cone_roots(c);
    return vec3f(
        lightness_of_roots(r),
        dot(r, vec3f(1.9779984951, -2.4285922050, 0.4505937099)),
        dot(r, vec3f(0.0259040371, 0.7827717662, -0.8086757660)));
}

fn linear_from_oklab(lab: vec3f) -> vec3f {
    return linear_from_roots(vec3f(
        dot(lab, vec3f(1.0, 0.3963377774, 0.2158037573)),
        dot(lab, vec3f(1.0, -0.1055613458, -0.0638541728)),
        dot(lab, vec3f(1.0, -0.0894841775, -1.2914855480))));
}

const CHROMA_STEPS: i32 = 9;            // halvings by which the chroma that a screen has is found
const GAMUT_SLACK: f32 = 1e-5;          // what rounding makes of the colours at the border

fn is_in_gamut(c: vec3f) -> bool {
    return all(c >= vec3f(-GAMUT_SLACK)) && all(c <= vec3f(1.0 + GAMUT_SLACK));
}

// Linear light 0..1 of an OKLab colour: of its lightness and hue, and of its chroma as much as a screen has. Its twin is tested.
fn linear_in_gamut(lab: vec3f) -> vec3f {
    let whole = linear_from_oklab(lab);
    if is_in_gamut(whole) {
        return clamp(whole, vec3f(0.0), vec3f(1.0));
    }
    var low = 0.0;
    var step = 0.5;
    for (var i = 0; i < CHROMA_STEPS; i++) {
        low += select(0.0, step, is_in_gamut(linear_from_oklab(vec3f(lab.x, (low + step) * lab.yz))));
        step *= 0.5;
    }
    return clamp(linear_from_oklab(vec3f(lab.x, low * lab.yz)), vec3f(0.0), vec3f(1.0));
}

// A colour that means something, linear, in light of 0 (none) to 1: its lightness goes by `relief` to either side of its own, hue and chroma
// stay. Its twin is tested.
fn shown_under_light(color: vec3f, relief: f32, shade: f32) -> vec3f {
    let lab = oklab_from_linear(color);
    let lightness = clamp(lab.x + relief * (2.0 * clamp(shade, 0.0, 1.0) - 1.0), 0.0, 1.0);
    return linear_in_gamut(vec3f(lightness, lab.yz));
}
