//! Triangles and polygons near the origin: nearest points, and what planes leave of them.

use glam::{DVec2, DVec3};

/// The point of a triangle that is nearest to the origin (Ericson, *Real-Time Collision Detection*, 5.1.5).
pub(super) fn nearest_to_origin(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

/// The part of a convex polygon inside all half spaces n·p ≤ d (Sutherland & Hodgman).
pub(crate) fn clipped(corners: &[DVec3], planes: impl IntoIterator<Item = (DVec3, f64)>) -> Vec<DVec3> {
    let mut polygon = corners.to_vec();
    let mut next = Vec::with_capacity(8);
    for (normal, offset) in planes {
        let depth = |p: DVec3| offset - normal.dot(p);
        next.clear();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (dp, dq) = (depth(p), depth(q));
            if dp >= 0.0 {
                next.push(p);
            }
            if (dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0) {
                next.push(p + (q - p) * (dp / (dp - dq)));
            }
        }
        std::mem::swap(&mut polygon, &mut next);
    }
    polygon
}

/// Distance of a convex polygon (also a point or a segment) to the origin; ∞ for none.
pub(crate) fn distance_to_origin(polygon: &[DVec2]) -> f64 {
    let edges = || (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
    let around = edges().map(|(p, q)| p.perp_dot(q));
    let (mut left, mut right) = (0, 0);
    for side in around {
        left += u32::from(side >= 0.0);
        right += u32::from(side <= 0.0);
    }
    let count = polygon.len() as u32;
    let to_edges = edges().map(|(p, q)| {
        let along = q - p;
        let t = if along == DVec2::ZERO { 0.0 } else { (-p.dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        (p + along * t).length()
    });
    let nearest = to_edges.fold(f64::INFINITY, f64::min);
    // The origin is on the same side of every edge, and the polygon has an area: it is inside.
    if count >= 3 && (left == count) != (right == count) { 0.0 } else { nearest }
}
