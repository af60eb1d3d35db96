//! Whether a triangle and a lens volume share a point, in f64: also where the triangle spans the
//! volume with no corner and no edge inside.

use glam::{DMat3, DVec2, DVec3};

use crate::geom::{
    shape::volume::Volume,
    triangle::{clipped, distance_to_origin, nearest_to_origin},
};

impl Volume {
    /// Whether the closed triangle and the closed volume share a point.
    pub fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        if self.is_empty() {
            return false;
        }
        match self {
            Self::Sphere { center, radius } => {
                let [a, b, c] = corners.map(|p| p - *center);
                nearest_to_origin(a, b, c).length_squared() <= radius * radius
            }
            Self::Box { center, half, rotation } => {
                let back = DMat3::from_quat(rotation.conjugate());
                let local = corners.map(|p| back * (p - *center));
                let axes = [DVec3::X, DVec3::Y, DVec3::Z];
                let planes = axes.into_iter().zip(half.to_array()).flat_map(|(n, h)| [(n, h), (-n, h)]);
                !clipped(&local, planes).is_empty()
            }
            Self::Cylinder { center, radius, half, axis } => {
                let local = corners.map(|p| p - *center);
                let part = clipped(&local, [(*axis, *half), (-*axis, *half)]);
                let (u, v) = axis.any_orthonormal_pair();
                let flat: Vec<DVec2> = part.iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect();
                distance_to_origin(&flat) <= *radius
            }
            Self::Ellipsoid { center, radii, rotation } => {
                let [a, b, c] = corners.map(|p| rotation.conjugate() * (p - *center) / *radii);
                nearest_to_origin(a, b, c).length_squared() <= 1.0
            }
            Self::Frustum { center, radii, half, axis } => {
                let local = corners.map(|p| p - *center);
                let slope = (radii[1] - radii[0]) / (2.0 * half);
                let middle = 0.5 * (radii[0] + radii[1]);
                let radius = |p: DVec3| middle + slope * p.dot(*axis);
                // A cone is a cylinder seen from its tip: divided by the radius there, what is convex stays so. Without the
                // tip, where the radius is less than 1e-12 of the largest.
                let tip = (-slope * *axis, middle - 1e-12 * radii[0].max(radii[1]));
                let part = clipped(&local, [(*axis, *half), (-*axis, *half), tip]);
                let (u, v) = axis.any_orthonormal_pair();
                let flat: Vec<DVec2> = part.iter().map(|p| DVec2::new(p.dot(u), p.dot(v)) / radius(*p)).collect();
                distance_to_origin(&flat) <= 1.0
            }
            Self::Convex(hull) => {
                let (center, planes) = hull.planes();
                let local = corners.map(|p| p - center);
                !clipped(&local, planes.iter().copied()).is_empty()
            }
            Self::Solid(placed) => placed.solid.meets_triangle(&corners.map(|p| placed.local(p))),
            Self::Flat(flat) => flat.meets_triangle(corners),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geom::shape::definition::Shape;

    fn shapes() -> Vec<Volume> {
        let cube: Vec<DVec3> =
            (0..8).map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * 4.0).collect();
        [
            Shape::Sphere { center: DVec3::ONE, radius: 3.0 },
            Shape::Box {
                center: DVec3::ONE,
                size: DVec3::new(6.0, 2.0, 4.0),
                rotation: glam::DQuat::from_rotation_z(0.4) * glam::DQuat::from_rotation_x(0.3),
            },
            Shape::Cylinder { center: DVec3::ONE, radius: 2.0, height: 5.0, axis: DVec3::new(0.48, 0.6, 0.64) },
            Shape::Convex { points: cube },
            Shape::Ellipsoid {
                center: DVec3::ONE,
                radii: DVec3::new(4.0, 1.5, 2.5),
                rotation: glam::DQuat::from_rotation_x(0.7),
            },
            Shape::Frustum {
                center: DVec3::ONE,
                radius: 3.0,
                top_radius: 1.0,
                height: 5.0,
                axis: DVec3::new(0.48, 0.6, 0.64),
            },
            Shape::Frustum { center: DVec3::ONE, radius: 0.0, top_radius: 3.0, height: 4.0, axis: DVec3::X },
        ]
        .iter()
        .map(|s| s.volume().unwrap())
        .collect()
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Against points spread over the triangle: a point inside must be found, and where the triangle meets the
        /// volume some point of it is at most as far from the volume as the spread's spacing.
        #[test]
        fn agrees_with_points_of_the_triangle(raw in prop::array::uniform9(-8.0..8.0f64)) {
            let corners = [0, 3, 6].map(|i| DVec3::new(raw[i], raw[i + 1], raw[i + 2]));
            let n = 60;
            let spacing = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f64::max) / f64::from(n);
            for volume in shapes() {
                let mut least = f64::INFINITY;
                for i in 0..=n {
                    for j in 0..=n - i {
                        let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                        let p = corners[0] + (corners[1] - corners[0]) * s + (corners[2] - corners[0]) * t;
                        least = least.min(volume.signed_distance(p));
                    }
                }
                let meets = volume.meets_triangle(&corners);
                prop_assert!(meets || least > -1e-9, "{volume:?} holds a point of {corners:?} at {least}");
                prop_assert!(!meets || least < spacing, "{volume:?} is {least} from {corners:?}");
            }
        }
    }

    #[test]
    fn a_triangle_that_spans_a_volume_meets_it() {
        let wide = [DVec3::new(-90.0, -90.0, 1.0), DVec3::new(90.0, -90.0, 1.0), DVec3::new(0.0, 120.0, 1.0)];
        for volume in shapes() {
            assert!(volume.meets_triangle(&wide), "{volume:?}");
            assert!(!volume.meets_triangle(&wide.map(|p| p + DVec3::Z * 50.0)), "{volume:?}");
        }
    }
}
