// Colour spaces. Shading is linear; OKLab (Ottosson 2020) where lightness must move without hue.

fn linear_from_srgb(c: vec3f) -> vec3f {
    return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}

// Channels within 0..1.
fn srgb_from_linear(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

// Relative luminance of linear Rec. 709 / sRGB primaries.
fn luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}

// Of x >= 0, within 2^-22 of it above 1e-18, and within 1.1e-6 below: a third of the exponent is a first guess, off by 4 % at
// most, and each of two steps of Halley's cubes that. Half of what pow() costs on a software adapter. Its twin is tested.
fn cube_root(x: vec3f) -> vec3f {
    let some = max(x, vec3f(1e-18));
    var root = bitcast<vec3f>(vec3i(vec3f(bitcast<vec3i>(some)) * (1.0 / 3.0)) + 709921077);
    for (var i = 0; i < 2; i++) {
        let cube = root * root * root;
        root *= (cube + 2.0 * some) / (2.0 * cube + some);
    }
    return root;
}

fn oklab_from_linear(c: vec3f) -> vec3f {
    let lms = vec3f(
        dot(c, vec3f(0.4122214708, 0.5363325363, 0.0514459929)),
        dot(c, vec3f(0.2119034982, 0.6806995451, 0.1073969566)),
        dot(c, vec3f(0.0883024619, 0.2817188376, 0.6299787005)));
    let r = cube_root(max(lms, vec3f(0.0)));
    return vec3f(
        dot(r, vec3f(0.2104542553, 0.7936177850, -0.0040720468)),
        dot(r, vec3f(1.9779984951, -2.4285922050, 0.4505937099)),
        dot(r, vec3f(0.0259040371, 0.7827717662, -0.8086757660)));
}

fn linear_from_oklab(lab: vec3f) -> vec3f {
    let r = vec3f(
        dot(lab, vec3f(1.0, 0.3963377774, 0.2158037573)),
        dot(lab, vec3f(1.0, -0.1055613458, -0.0638541728)),
        dot(lab, vec3f(1.0, -0.0894841775, -1.2914855480)));
    let lms = r * r * r;
    return vec3f(
        dot(lms, vec3f(4.0767416621, -3.3077115913, 0.2309699292)),
        dot(lms, vec3f(-1.2684380046, 2.6097574011, -0.3413193965)),
        dot(lms, vec3f(-0.0041960863, -0.7034186147, 1.7076147010)));
}
