//! Case 11: rays through shared edges and vertices: nothing leaks. Oracle: the target lies on the closed surface of a
//! convex body around the ray's origin, so every ray out of it must meet it, at the target.

use glam::DVec3;
use veduta::geom::ray::{Ray, TriangleTest};

use crate::oracle::{Numbers, P3};

/// An octahedron of `size`, each face split `n` times along its edges; integer corners, shared exactly.
fn octahedron(n: i64, size: i64) -> Vec<[P3; 3]> {
    let mut triangles = Vec::new();
    for signs in 0..8 {
        let at = |i: i64, j: i64| {
            let p = [i * size, j * size, (n - i - j) * size];
            [0, 1, 2].map(|axis| if signs >> axis & 1 == 0 { p[axis] } else { -p[axis] })
        };
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    triangles
}

#[test]
fn rays_out_of_a_closed_body_never_leak() {
    let triangles = octahedron(6, 997);
    let world = |p: P3| DVec3::new(85_000.0, 447_000.0, 3.0) + 0.001 * DVec3::from(p.map(|c| c as f64));
    let surface: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(world)).collect();
    let mut numbers = Numbers(11);
    let mut shot = 0;
    for _ in 0..40 {
        let eye = world([0; 3].map(|_: i64| numbers.below(2400) - 1200));
        for [a, b, c] in &surface {
            let parts = [*a, 0.5 * (*a + *b), *b + 0.3 * (*c - *b), (*a + *b + *c) / 3.0];
            for target in parts {
                let ray = Ray { origin: eye, direction: target - eye };
                let test = TriangleTest::new(&ray).unwrap();
                let hits: Vec<f64> = surface.iter().filter_map(|&t| test.hit(t)).collect();
                assert!(!hits.is_empty(), "{eye} -> {target} leaks");
                assert!(hits.iter().all(|t| (t - 1.0).abs() < 1e-6), "{eye} -> {target}: {hits:?}");
                shot += 1;
            }
        }
    }
    assert!(shot > 40_000);
}
