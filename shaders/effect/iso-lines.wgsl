//! name = "iso-lines"
//! kind = "post"
//! spec = "Tiesel §3"
//! doc = "Lines of equal distance, or of equal height: 70 % of their colour, every fifth twice as wide and 95 %. Lines closer than 5 pixels go over into an even tone, which fades out from 2.5 pixels to 1."
//!
//! [[parameter]]
//! name = "equal"
//! type = "word"
//! words = ["eye", "point", "height"]
//! default = "height"
//! doc = "What is equal along a line: the distance from the eye, that from a point, the height."
//!
//! [[parameter]]
//! name = "interval"
//! type = "number"
//! range = [0.1, 10000]
//! default = 5
//! unit = "metres"
//! doc = "From line to line; every fifth is thicker."
//!
//! [[parameter]]
//! name = "x"
//! type = "number"
//! default = 0
//! unit = "metres"
//! doc = "The point, in model coordinates (to 1/32 m within 500 km of the origin)."
//!
//! [[parameter]]
//! name = "y"
//! type = "number"
//! default = 0
//! unit = "metres"
//! doc = "The point."
//!
//! [[parameter]]
//! name = "z"
//! type = "number"
//! default = 0
//! unit = "metres"
//! doc = "The point."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#0b3c5d"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "width"
//! type = "number"
//! range = [0.5, 8]
//! default = 1.2
//! unit = "pixels"
//! doc = "Width of a line."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    if point.surface == NO_SURFACE {
        return color;
    }
    var away = point.relative;
    if p.equal == EQUAL_POINT {
        away += vec3f(view.eye_whole) - vec3f(p.x, p.y, p.z) + view.eye_fraction;
    }
    var value = length(away);
    var uphill = away / max(value, 1e-6);
    if p.equal == EQUAL_HEIGHT {
        value = f32(view.eye_whole.z) + (view.eye_fraction.z + point.relative.z);
        uphill = vec3f(0.0, 0.0, 1.0);
    }
    // How much the value changes from pixel to pixel, at most.
    let along = length(uphill - point.normal * dot(uphill, point.normal));
    let facing = abs(dot(point.normal, normalize(point.relative)));
    let per_pixel = max(along * metres_per_pixel(point) / max(facing, 0.05), 1e-9);
    let fine = line(value, p.interval, p.width, per_pixel);
    let thick = line(value, 5.0 * p.interval, 2.0 * p.width, per_pixel);
    return mix(color, p.color, max(0.7 * fine, 0.95 * thick));
}

// How much of a pixel a line at the multiples of `interval` covers; where lines are too dense, their mean.
fn line(value: f32, interval: f32, width: f32, per_pixel: f32) -> f32 {
    let turns = value / interval;
    let off = abs(turns - round(turns)) * interval / per_pixel;
    let sharp = clamp(0.5 * width + 0.5 - off, 0.0, 1.0);
    let pixels = interval / per_pixel;
    let mean = min(width / pixels, 1.0);
    // A face of equal value is no line.
    let shown = select(0.0, mix(mean, sharp, smoothstep(2.0, 5.0, pixels)), per_pixel > 1e-4 * interval);
    return shown * smoothstep(1.0, 2.5, pixels);
}
