//! Distances to the borders of round bodies.

use glam::{DVec2, DVec3};

/// From a point in the ellipsoid's own axes to its border, negative inside.
///
/// The nearest point is x with xᵢ = eᵢ² yᵢ / (t + eᵢ²), t the largest root of Σ (eᵢ yᵢ / (t + eᵢ²))² = 1 (Eberly, *Distance
/// from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*). t is counted from −min eᵢ², where the points that have
/// several nearest ones find it.
pub(super) fn distance_of_ellipsoid(p: DVec3, radii: DVec3) -> f64 {
    if radii.min_element() <= 0.0 {
        // A disc, a line or a point: a ball around what it is in holds it.
        return (p.abs() - radii).max(DVec3::ZERO).length();
    }
    let y = p.abs().max(1e-30 * radii);
    let least = radii.min_element() * radii.min_element();
    let above = radii * radii - least;
    let (mut low, mut high) = (0.0, (radii * y).length());
    for _ in 0..220 {
        let s = 0.5 * (low + high);
        if s <= low || s >= high {
            break;
        }
        if (radii * y / (s + above)).length_squared() > 1.0 { low = s } else { high = s }
    }
    let nearest = radii * radii * y / (high + above);
    let distance = (y - nearest).length();
    if (p / radii).length_squared() <= 1.0 { -distance } else { distance }
}

/// From a point (away from the axis, along it) to the border of a cone with its tip cut off, negative inside.
pub(super) fn distance_of_frustum(p: DVec2, [bottom, top]: [f64; 2], half: f64) -> f64 {
    let corners = [DVec2::new(bottom, -half), DVec2::new(top, half)];
    let side = corners[1] - corners[0];
    // To the right of the side, seen from the first corner, is outside.
    let beyond_side = (p - corners[0]).perp_dot(side) / side.length();
    let inside = beyond_side.max(p.y.abs() - half);
    if inside <= 0.0 {
        return inside;
    }
    let to_segment = |a: DVec2, b: DVec2| {
        let along = b - a;
        let t = if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        (p - a - t * along).length()
    };
    let caps = corners.map(|c| to_segment(DVec2::new(0.0, c.y), c));
    caps[0].min(caps[1]).min(to_segment(corners[0], corners[1]))
}
