//! Case 12: slivers of 1 mm × 1 km. Property: a fan of slivers has no gaps, and a hit lies between the corners. Oracle:
//! the fan is a known rectangle.

use glam::DVec3;
use veduta::geom::{
    ray::{Ray, TriangleTest},
    triangulate::Triangulator,
};

use crate::oracle::{Numbers, P3, normal};

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
