//! Rays, and a ray–triangle test that loses nothing at shared edges.

use glam::DVec3;
use robust::{Coord, orient2d};

/// A half-line `origin + t · direction`, t ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: DVec3,
    /// Where it goes; any length but zero, which is the unit of t.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `t`. Rays of a a view advance one metre along the view axis per unit of `t`, so that
    /// `t` is the distance D of the lens maths.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// A ray made ready for many triangles (Woop, Benthin, Wald: *Watertight Ray/Triangle Intersection*, JCGT 2013): a shear
/// turns it into an axis, so that the test is about the signs of three edges seen from a point in the plane. The signs
/// are exact, and each corner is sheared alike for every triangle that has it: two triangles that share an edge can
/// never both miss a ray that passes between them.
#[derive(Clone, Copy, Debug)]
pub struct TriangleTest {
    origin: DVec3,
    axes: [usize; 3],
    shear: [f64; 2],
    /// 1 / direction along the main axis.
    scale: f64,
}

impl TriangleTest {
    /// `None` for a direction without length or with a component that is no number.
    pub fn new(ray: &Ray) -> Option<Self> {
        let d = ray.direction;
        let along = d.abs().max_element();
        if !(d.is_finite() && ray.origin.is_finite() && along > 0.0) {
            return None;
        }
        let main = (0..3).find(|&i| d[i].abs() == along)?;
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let shear = [d[axes[0]] / d[main], d[axes[1]] / d[main]];
        Some(Self { origin: ray.origin, axes, shear, scale: d[main].recip() })
    }

    /// Where the ray meets the closed triangle, from either side; `None` also if it lies in the triangle's plane.
    pub fn hit(&self, triangle: [DVec3; 3]) -> Option<f64> {
        let [a, b, c] = triangle.map(|corner| self.sheared(corner));
        let side = |p: (Coord<f64>, f64), q: (Coord<f64>, f64)| orient2d(p.0, q.0, Coord { x: 0.0, y: 0.0 });
        let (u, v, w) = (side(b, c), side(c, a), side(a, b));
        let out = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        let sum = u + v + w;
        if out || sum == 0.0 {
            return None;
        }
        // A weighted mean of the corners: stays between them however thin the triangle is.
        let depth = (u / sum) * a.1 + (v / sum) * b.1 + (w / sum) * c.1;
        let t = depth * self.scale;
        (t >= 0.0).then_some(t)
    }

    /// The corner relative to the ray: in the plane across the main axis, and along it.
    fn sheared(&self, corner: DVec3) -> (Coord<f64>, f64) {
        let relative = corner - self.origin;
        let depth = relative[self.axes[2]];
        let x = relative[self.axes[0]] - self.shear[0] * depth;
        let y = relative[self.axes[1]] - self.shear[1] * depth;
        (Coord { x, y }, depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(origin: [f64; 3], direction: [f64; 3], triangle: [[f64; 3]; 3]) -> Option<f64> {
        let ray = Ray { origin: origin.into(), direction: direction.into() };
        TriangleTest::new(&ray)?.hit(triangle.map(DVec3::from))
    }

    const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn t_counts_lengths_of_the_direction() {
        assert_eq!(hit([1.0, 1.0, 6.0], [0.0, 0.0, -2.0], FLOOR), Some(3.0));
        assert_eq!(hit([1.0, 1.0, -6.0], [0.0, 0.0, 2.0], FLOOR), Some(3.0), "from below as well");
        assert_eq!(hit([1.0, 1.0, 6.0], [0.0, 0.0, 2.0], FLOOR), None, "behind");
        assert_eq!(hit([3.0, 3.0, 6.0], [0.0, 0.0, -2.0], FLOOR), None, "beside");
    }

    #[test]
    fn edges_and_corners_belong_to_the_triangle() {
        for [x, y] in [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [2.0, 2.0], [1.0, 0.0], [0.0, 3.0]] {
            assert_eq!(hit([x, y, 1.0], [0.0, 0.0, -1.0], FLOOR), Some(1.0), "{x} {y}");
        }
    }

    #[test]
    fn rays_without_direction_or_in_the_plane_hit_nothing() {
        assert_eq!(hit([1.0, 1.0, 0.0], [1.0, 0.0, 0.0], FLOOR), None);
        assert_eq!(hit([1.0, 1.0, 1.0], [0.0; 3], FLOOR), None);
        assert_eq!(hit([1.0, 1.0, 1.0], [0.0, f64::NAN, 1.0], FLOOR), None);
        assert_eq!(hit([f64::INFINITY, 1.0, 1.0], [0.0, 0.0, 1.0], FLOOR), None);
    }
}
