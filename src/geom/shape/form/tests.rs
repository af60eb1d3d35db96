use glam::DVec3;
use proptest::prelude::*;

use crate::geom::shape::{Shape, Volume};

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
