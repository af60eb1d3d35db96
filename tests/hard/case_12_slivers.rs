//! Case 12: slivers of 1 mm × 1 km. Property: a fan of slivers has no gaps, and a hit lies between the corners. Oracle:
//! the fan is a known rectangle.

use glam::{DQuat, DVec3, Vec3Swizzles};
use veduta::{
    geom::{
        Shape,
        ray::{Ray, TriangleTest},
        triangulate::Triangulator,
    },
    view::Camera,
};

use crate::{
    lenses::{check_mask, view},
    oracle::{Numbers, P3, normal},
    studio,
};

#[test]
fn a_kilometre_of_slivers_has_no_gap() {
    // A strip of 200 mm × 1 km, cut lengthwise into slivers of 1 mm, leaning slightly.
    let strip: Vec<[DVec3; 3]> = (0..200)
        .flat_map(|i| {
            let at = |side: i32, end: f64| {
                DVec3::new(85_000.0 + 0.001 * f64::from(i + side), 447_000.0 + 1000.0 * end, 0.3 * end)
            };
            [[at(0, 0.0), at(1, 0.0), at(1, 1.0)], [at(0, 0.0), at(1, 1.0), at(0, 1.0)]]
        })
        .collect();
    let mut numbers = Numbers(12);
    for _ in 0..4000 {
        let part = numbers.below(100_000) as f64 / 100_000.0;
        // As often as not exactly on the edge between two slivers.
        let across =
            if numbers.below(2) == 0 { numbers.below(200) as f64 } else { numbers.below(200_000) as f64 / 1000.0 };
        let target = DVec3::new(85_000.0 + 0.001 * across, 447_000.0 + 1000.0 * part, 0.3 * part);
        let direction = DVec3::new(numbers.below(5) as f64 - 2.0, numbers.below(5) as f64 - 2.0, -3.0);
        let test = TriangleTest::new(&Ray { origin: target - 20.0 * direction, direction }).unwrap();
        let hits: Vec<f64> = strip.iter().filter_map(|&t| test.hit(t)).collect();
        let at_the_rim = !(1e-6..=199.999_999).contains(&across) || !(1e-9..=1.0 - 1e-9).contains(&part);
        assert!(at_the_rim || !hits.is_empty(), "{target} {direction}");
        assert!(hits.iter().all(|t| (t - 20.0).abs() < 1e-3), "{hits:?}");
    }
}

#[test]
fn slivers_are_triangulated_to_the_last_unit() {
    let kilometre = 1_000_000;
    let ring: Vec<P3> = vec![[0, 0, 0], [kilometre, 1, 0], [2 * kilometre, 1, 5], [kilometre, 2, 3], [500_000, 2, 1]];
    let mut triangles = Vec::new();
    let face = Triangulator::default().triangulate(&ring, &[5], &mut triangles).unwrap();
    assert_eq!(triangles.len(), 3);
    let mut sum = [0; 3];
    for t in triangles {
        let n = normal(t.map(|i| ring[i as usize]));
        sum = [0, 1, 2].map(|i| sum[i] + n[i]);
    }
    assert_eq!(sum, face.normal, "the vector areas of the triangles add up to the ring's");
}

/// Lenses of 1 mm × 1 km (and 1 mm or 1 km): along x, `center` in their middle.
fn slivers(center: DVec3) -> Vec<(&'static str, Shape)> {
    let rotation = DQuat::IDENTITY;
    let corner = |i: u32, half: DVec3| {
        let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        center + half * DVec3::new(side(0), side(1), side(2))
    };
    let plane = |n: DVec3, d: f64| [n.x, n.y, n.z, n.dot(center) + d];
    let flat = [(DVec3::X, 500.0), (DVec3::Y, 0.0005), (DVec3::Z, 500.0)];
    let (sheet, rod) = (DVec3::new(500.0, 0.0005, 500.0), DVec3::new(500.0, 0.0005, 0.0005));
    vec![
        ("sheet", Shape::Box { center, size: 2.0 * sheet, rotation }),
        ("rod", Shape::Box { center, size: 2.0 * rod, rotation }),
        ("cylinder", Shape::Cylinder { center, radius: 0.0005, height: 1000.0, axis: DVec3::X }),
        ("disc", Shape::Cylinder { center, radius: 500.0, height: 0.001, axis: DVec3::Y }),
        ("ellipsoid", Shape::Ellipsoid { center, radii: sheet, rotation }),
        ("cone", Shape::Frustum { center, radius: 500.0, top_radius: 0.0, height: 0.001, axis: DVec3::Y }),
        ("needle", Shape::Frustum { center, radius: 0.0005, top_radius: 0.0002, height: 1000.0, axis: DVec3::X }),
        ("convex", Shape::Convex { points: (0..8).map(|i| corner(i, sheet)).collect() }),
        (
            "polytope",
            Shape::Polytope { planes: flat.into_iter().flat_map(|(n, d)| [plane(n, d), plane(-n, d)]).collect() },
        ),
        (
            "corridor",
            Shape::Corridor {
                points: vec![center - 500.0 * DVec3::X, center + 500.0 * DVec3::X],
                width: 0.001,
                height: 1000.0,
            },
        ),
    ]
}

#[test]
fn rays_through_sliver_lenses_are_inside_where_they_meet_them() {
    let center = DVec3::new(85_000.0, 447_000.0, 3.0);
    let mut numbers = Numbers(112);
    for (what, shape) in slivers(center) {
        let volumes = shape.volumes().expect("volumes");
        for _ in 0..2_000 {
            // On the axis of all of them, in the inner half: half a millimetre off their borders, or a quarter.
            let target = center + DVec3::X * 0.001 * (numbers.below(400_000) as f64 - 200_000.0);
            let mut part = || numbers.below(2001) as f64 / 1000.0 - 1.0;
            let direction = DVec3::new(part(), part(), part()) * 3.0;
            if direction.yz().length() < 0.01 {
                continue;
            }
            let ray = Ray { origin: target - 20.0 * direction, direction };
            let spans: Vec<(f64, f64)> = volumes.iter().filter_map(|v| v.entry_exit(&ray)).collect();
            assert!(spans.iter().any(|(enter, exit)| *enter < 20.0 && 20.0 < *exit), "{what} {ray:?}: {spans:?}");
            // What is 2 mm aside of a sheet or a rod, along it, is not met.
            let beside = Ray { origin: target + DVec3::Y * 0.002 - 20.0 * DVec3::X, direction: DVec3::X };
            assert!(volumes.iter().all(|v| v.entry_exit(&beside).is_none()), "{what} {beside:?}");
        }
    }
}

#[test]
fn sliver_lenses_are_drawn_right_to_the_pixel() {
    let mut studio = studio::studio(&[studio::citydata("cube.city.json")]);
    // In the wall y = 0; and through the cube, where only a line of its roof and walls is inside.
    let mut inside = 0;
    for y in [0.0, 4.9998] {
        let lenses: Vec<_> = slivers(DVec3::new(5.0, y, 6.0))
            .into_iter()
            .map(|(name, shape)| studio::lens(name, vec![shape], "sepia"))
            .collect();
        for eye in [DVec3::new(4.0, -9.0, 7.0), DVec3::new(-400.0, -900.0, 300.0), DVec3::new(5.0, 4.9999, 19.0)] {
            let fov = 12.0 / eye.distance(DVec3::splat(5.0));
            let camera = Camera::looking(eye, DVec3::splat(5.0), fov);
            let drawn = studio::picture(&mut studio, &studio::scene(camera, lenses.clone()), [160, 120]);
            for (bit, lens) in lenses.iter().enumerate() {
                match check_mask(&drawn, &view(camera, [160, 120]), lens, bit) {
                    Ok(n) => inside += n,
                    Err(why) => panic!("{} from {eye}: {why}", lens.name),
                }
            }
        }
    }
    assert!(inside > 10_000, "{inside}");
}
