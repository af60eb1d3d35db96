//! name = "open-street"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "Opens a street along a route: what stands beside it is moved away, and lowered."
//! derivative = true
//!
//! [[parameter]]
//! name = "half_width"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "Half the width of the street."
//!
//! [[parameter]]
//! name = "reach"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "How far from the route something is moved."
//!
//! [[parameter]]
//! name = "aside"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "How far each side is moved away."
//!
//! [[parameter]]
//! name = "height"
//! type = "number"
//! required = true
//! doc = "How many times as high what stands beside it is."
//!
//! [[parameter]]
//! name = "base"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "Height that stays."
//!
//! [[parameter]]
//! name = "route"
//! type = "number"
//! required = true
//! doc = "Where its route begins in the tables."

// After `geom::deform::Opening`, which says why.

const NO_TRUST: f32 = 0.05;
const FULL_TRUST: f32 = 0.2;
const RADIUS_PER_REACH: f32 = 1.5;

// The integrals over one part of a route and their derivatives, along it and across; all in units of the radius.
struct Sums {
    weight: f32,
    weight_slope: vec2f,
    mean: vec2f,
    mean_slope: mat2x2f,    // columns: by a, by b
}

fn sums_of(a: f32, b: f32, length: f32) -> Sums {
    let squared = max(1.0 - b * b, 0.0);
    let h = sqrt(squared);
    let low = clamp(-a, -h, h);
    let high = clamp(length - a, -h, h);
    let rest = max(vec2f(squared) - vec2f(low * low, high * high), vec2f(0.0));
    let kernel = rest * rest;
    let weight = weight_up_to(high, h) - weight_up_to(low, h);
    let cubes = rest * kernel;
    let first = (cubes.x - cubes.y) * (1.0 / 6.0);
    let along = kernel.x - kernel.y;
    let across = -4.0 * b * (high * (squared - high * high * (1.0 / 3.0)) - low * (squared - low * low * (1.0 / 3.0)));
    let by_a = vec2f(-(high * kernel.y - low * kernel.x), -(b * along));
    let by_b = vec2f(-(b * along), -weight - b * across);
    return Sums(weight, vec2f(along, across), vec2f(first, -(b * weight)), mat2x2f(by_a, by_b));
}

fn weight_up_to(t: f32, h: f32) -> f32 {
    let s = t * t;
    let g = h * h;
    return t * (g * g - (2.0 / 3.0) * g * s + 0.2 * s * s);
}

fn effect(place: vec3f, p: Parameters) -> Jet {
    let nothing = Jet(vec3f(0.0), NO_SLOPE);
    let half_width = p.half_width;
    let reach = p.reach;
    let aside = p.aside;
    let lower = p.height - 1.0;
    // First how many parts it has.
    let route = u32(p.route);
    let parts = u32(tables[route]);
    let unit = 1.0 / (RADIUS_PER_REACH * reach);
    var weight = 0.0;
    var weight_slope = vec2f(0.0);
    var mean = vec2f(0.0);
    var mean_slope = mat2x2f(0.0, 0.0, 0.0, 0.0);
    for (var i = 0u; i < parts; i++) {
        // Where it begins, which way it goes, how long it is.
        let at = route + 1u + 5u * i;
        let along = vec2f(tables[at + 2u], tables[at + 3u]);
        let way = (place.xy - vec2f(tables[at], tables[at + 1u])) * unit;
        let a = dot(way, along);
        let b = way.y * along.x - way.x * along.y;
        let part = tables[at + 4u] * unit;
        if abs(b) >= 1.0 || a <= -1.0 || a >= part + 1.0 {
            continue;
        }
        let sums = sums_of(a, b, part);
        // From along and across to x and y.
        let back = mat2x2f(along, vec2f(-along.y, along.x));
        weight += sums.weight;
        weight_slope += back * sums.weight_slope;
        mean += back * sums.mean;
        mean_slope += back * sums.mean_slope * transpose(back);
    }
    if weight <= NO_TRUST {
        return nothing;
    }
    let q = (weight - NO_TRUST) / (FULL_TRUST - NO_TRUST);
    let sure = clamp(q, 0.0, 1.0);
    let trust = smooth01(sure);
    let trust_slope =
        weight_slope * (smooth01_slope(sure) * clamp_slope(q, 0.0, 1.0) * unit / (FULL_TRUST - NO_TRUST));
    let scale = 1.0 / weight;
    let unit_way = -clamp(mean * scale, vec2f(-1.0), vec2f(1.0));
    let by_x = -(mean_slope[0] + unit_way * weight_slope.x) * scale;
    let by_y = -(mean_slope[1] + unit_way * weight_slope.y) * scale;
    let way = unit_way / unit;
    let distance = length(way);
    if distance >= reach {
        return nothing;
    }
    // Of the push by the distance and of what is lowered: values, and derivatives divided by the distance.
    var push = aside / half_width * (1.5 - 0.5 * distance * distance / (half_width * half_width));
    var push_slope = -aside / (half_width * half_width * half_width);
    var fade = 1.0;
    var fade_slope = 0.0;
    if distance > half_width {
        let rate = 1.0 / (reach - half_width);
        let t = clamp((distance - half_width) * rate, 0.0, 1.0);
        let value = 1.0 - smooth01(t);
        let slope = -smooth01_slope(t) * rate;
        push = aside * value / distance;
        push_slope = aside * (slope - value / distance) / (distance * distance);
        fade = value;
        fade_slope = slope / distance;
    }
    let height = (place.z - p.base) * lower;
    let half_gradient = vec2f(dot(by_x, way), dot(by_y, way));
    let moved = vec3f(push * way, height * fade);
    var x = vec3f(push * by_x + push_slope * half_gradient.x * way, height * fade_slope * half_gradient.x);
    var y = vec3f(push * by_y + push_slope * half_gradient.y * way, height * fade_slope * half_gradient.y);
    x = x * trust + moved * trust_slope.x;
    y = y * trust + moved * trust_slope.y;
    return Jet(moved * trust, mat3x3f(x, y, vec3f(0.0, 0.0, fade * lower * trust)));
}
