// Colour spaces. Shading is linear; OKLab (Ottosson 2020) where lightness must move without hue.

// Both ways by polynomials where the standard has powers: these are long on a software adapter. Channels within 0..1. Their
// twins are tested.

// Within 2.5e-6.
fn linear_from_srgb(c: vec3f) -> vec3f {
    var sum = vec3f(0.0560430913);
    sum = sum * c - 0.255237423;
    sum = sum * c + 0.511841304;
    sum = sum * c - 0.639369665;
    sum = sum * c + 0.795216045;
    sum = sum * c + 0.496140214;
    sum = sum * c + 0.0344924766;
    sum = sum * c + 0.000875111499;
    return select(min(sum, vec3f(1.0)), c / 12.92, c <= vec3f(0.04045));
}

// Within 2e-6, half a thousandth of a byte's step: in the fourth root of c.
fn srgb_from_linear(c: vec3f) -> vec3f {
    let root = sqrt(sqrt(c));
    var sum = vec3f(0.0648733212);
    sum = sum * root - 0.306036986;
    sum = sum * root + 0.638769462;
    sum = sum * root - 0.838965334;
    sum = sum * root + 1.36022559;
    sum = sum * root + 0.140776781;
    sum = sum * root - 0.0596417498;
    return select(min(sum, vec3f(1.0)), 12.92 * c, c <= vec3f(0.0031308));
}

// Relative luminance of linear Rec. 709 / sRGB primaries.
fn luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}

// Within 2^-21 of it above 1e-18, and within 1.1e-6 for what is less, which counts as 1e-18; without a power or a division. Less
// a third of the exponent is a first guess of the inverse root, off by 4 % at most; a step of third order and one of Newton's
// leave rounding. Its twin is tested.
fn cube_root(x: vec3f) -> vec3f {
    let some = max(x, vec3f(1e-18));
    var inverse = bitcast<vec3f>(1419900000 - vec3i(vec3f(bitcast<vec3i>(some)) * (1.0 / 3.0)));
    let off = 1.0 - some * inverse * (inverse * inverse);
    inverse *= 1.0 + off * (1.0 / 3.0 + off * (2.0 / 9.0));
    inverse += inverse * ((1.0 - some * inverse * (inverse * inverse)) * (1.0 / 3.0));
    return some * inverse * inverse;
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
