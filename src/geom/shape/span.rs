//! Where along a ray something begins and ends.

use glam::DVec3;

/// The interval of a ray that is inside wherever it is.
pub(super) const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// What two intervals share (empty: entry > exit).
pub(super) fn both(spans: [(f64, f64); 2]) -> (f64, f64) {
    let [a, b] = spans;
    (a.0.max(b.0), a.1.min(b.1))
}

/// Where `|o + t·d| ≤ half`. A ray parallel to the slab is inside it everywhere (its faces too) or nowhere.
pub(super) fn slab(o: f64, d: f64, half: f64) -> Option<(f64, f64)> {
    if d == 0.0 {
        return (o.abs() <= half).then_some(EVERYWHERE);
    }
    let (a, b) = ((-half - o) / d, (half - o) / d);
    Some((a.min(b), a.max(b)))
}

/// `d` without its part along the unit `axis`; exactly zero where only rounding is left of it.
pub(super) fn across(d: DVec3, axis: DVec3) -> DVec3 {
    let rest = d - d.dot(axis) * axis;
    if rest.length_squared() <= 1e-28 * d.length_squared() { DVec3::ZERO } else { rest }
}

/// Where `|o + t·d| ≤ radius`, for spheres and, with o and d across its axis, cylinders.
///
/// The discriminant is taken from the point of the ray nearest the centre: b² − ac of the textbook loses all digits
/// for a far eye (Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems I, ch. 7).
pub(super) fn round(o: DVec3, d: DVec3, radius: f64) -> Option<(f64, f64)> {
    let a = d.length_squared();
    if a == 0.0 {
        return (o.length() <= radius).then_some(EVERYWHERE);
    }
    let middle = -o.dot(d) / a;
    let nearest = (o + middle * d).length();
    // (r − q)(r + q) keeps the sign of r − q where r² − q² rounds to nothing.
    let left = (radius - nearest) * (radius + nearest);
    (left > 0.0).then(|| {
        let half = (left / a).sqrt();
        (middle - half, middle + half)
    })
}

/// A vector in its parts across an axis and along it.
#[derive(Clone, Copy)]
pub(super) struct Parted {
    pub across: DVec3,
    pub along: f64,
}

/// The side of a cone: its radius is `middle + slope·z`, and is ≥ 0 between two `ends` of a ray.
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub middle: f64,
    pub slope: f64,
    pub ends: (f64, f64),
}

/// Where `|o + t·d| ≤ middle + slope·(z_o + t·z_d)` between two ends within which the right side is ≥ 0: o and d across
/// the axis, and along it.
///
/// The quadratic is set up around the point of the line nearest the middle, as for [`round`].
pub(super) fn cone(o: Parted, d: Parted, side: Side) -> Option<(f64, f64)> {
    let Side { middle, slope, ends } = side;
    let all = d.across.length_squared() + d.along * d.along;
    let start = if all > 0.0 { -(o.across.dot(d.across) + o.along * d.along) / all } else { 0.0 };
    let (near, z) = (o.across + start * d.across, o.along + start * d.along);
    let (radius, growth) = (middle + slope * z, slope * d.along);
    // a t² + 2 b t + c ≤ 0
    let a = (d.across.length() - growth.abs()) * (d.across.length() + growth.abs());
    let b = near.dot(d.across) - radius * growth;
    let c = (near.length() - radius.abs()) * (near.length() + radius.abs());
    let ends = (ends.0 - start, ends.1 - start);
    let moved = |(entry, exit): (f64, f64)| Some((entry + start, exit + start));
    let left = b * b - a * c;
    if a > 0.0 {
        // It crosses one of the two cones that meet in the tip, and is inside between.
        if left <= 0.0 {
            return None;
        }
        let q = -(b + left.sqrt().copysign(b));
        let (s, t) = (q / a, if q == 0.0 { 0.0 } else { c / q });
        return moved((s.min(t), s.max(t)));
    }
    // Steeper than the side: in one cone up to a point, in the other from a point on.
    if left < 0.0 || (a == 0.0 && b == 0.0) {
        return if c <= 0.0 { moved(ends) } else { None };
    }
    let q = -(b + left.sqrt().copysign(b));
    let roots = [if a == 0.0 { f64::NAN } else { q / a }, if q == 0.0 { 0.0 } else { c / q }];
    // Between the ends the one whose radius is not negative.
    let is_right = |t: f64| !t.is_nan() && radius + growth * t >= -1e-12 * (radius.abs() + (growth * t).abs());
    let border = roots.into_iter().filter(|t| is_right(*t));
    let border = if growth > 0.0 { border.fold(f64::NAN, f64::max) } else { border.fold(f64::NAN, f64::min) };
    match border {
        t if t.is_nan() => None,
        t if growth > 0.0 => moved((t, f64::INFINITY)),
        t => moved((f64::NEG_INFINITY, t)),
    }
}
