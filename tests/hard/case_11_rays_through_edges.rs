//! Case 11: rays through shared edges and vertices: nothing leaks. Oracle: the target lies on the closed surface of a
//! convex body around the ray's origin, so every ray out of it must meet it, at the target.

use glam::{DQuat, DVec3};
use veduta::{
    geom::{
        Shape,
        ray::{Ray, TriangleTest},
    },
    view::Camera,
};

use crate::{
    oracle::{Numbers, P3},
    studio,
};

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

#[test]
fn rays_out_of_a_lens_leave_it_once_through_edges_and_corners() {
    let world = |p: P3| DVec3::new(85_000.0, 447_000.0, 3.0) + 0.001 * DVec3::from(p.map(|c| c as f64));
    let points: Vec<DVec3> = octahedron(6, 997).iter().flatten().map(|p| world(*p)).collect();
    // Sides of any length; all of them meet in the corners.
    let plane = |i: i64| {
        let n = DVec3::from([0, 1, 2].map(|bit| if i >> bit & 1 == 0 { 1.0 } else { -1.0 })) * (1.0 + i as f64);
        [n.x, n.y, n.z, n.dot(world([0; 3])) + (1.0 + i as f64) * 5.982]
    };
    let lenses = [Shape::Convex { points }, Shape::Polytope { planes: (0..8).map(plane).collect() }];
    let mut numbers = Numbers(111);
    for lens in lenses {
        let volume = lens.volume().expect("a volume");
        for _ in 0..40 {
            let eye = world([0; 3].map(|_: i64| numbers.below(2400) - 1200));
            for [a, b, c] in octahedron(6, 997).iter().map(|t| t.map(world)) {
                for target in [a, 0.5 * (a + b), b + 0.3 * (c - b), (a + b + c) / 3.0] {
                    let found = volume.entry_exit(&Ray { origin: eye, direction: target - eye });
                    let Some((enter, exit)) = found else { panic!("{eye} -> {target} leaks") };
                    assert!(enter < 0.0 && (exit - 1.0).abs() < 1e-6, "{eye} -> {target}: {enter} {exit}");
                }
            }
        }
    }
}

/// A lens of bodies that share faces, edges and corners holds what one body of their outline holds.
#[test]
fn bodies_of_a_lens_that_share_faces_leave_no_gap() {
    let mut studio = studio::studio(&[studio::citydata("cube.city.json")]);
    let cut = [1.0, 2.7, 6.3, 9.0];
    let body = |x: usize, y: usize, z: usize| {
        let (min, max) =
            (DVec3::new(cut[x], cut[y] - 3.0, cut[z]), DVec3::new(cut[x + 1], cut[y + 1] - 3.0, cut[z + 1]));
        Shape::Box { center: min.midpoint(max), size: max - min, rotation: DQuat::IDENTITY }
    };
    let all = (0..3).flat_map(|x| (0..3).flat_map(move |y| (0..3).map(move |z| (x, y, z))));
    let parts: Vec<Shape> = all.map(|(x, y, z)| body(x, y, z)).collect();
    let whole = Shape::Box { center: DVec3::new(5.0, 2.0, 5.0), size: DVec3::splat(8.0), rotation: DQuat::IDENTITY };
    let lenses = vec![studio::lens("parts", parts, "sepia"), studio::lens("whole", vec![whole], "sepia")];
    let mut inside = 0;
    for i in 0..16 {
        // Along the cuts: rows and columns of pixels on shared faces, and the wall y = 0 through the bodies.
        let t = f64::from(i);
        let aside = DVec3::new((t * 0.754_878).fract() - 0.5, -1.0, (t * 0.569_840).fract() - 0.5) * (3.0 + t);
        let at = DVec3::new(cut[i as usize % 4], 0.0, cut[i as usize / 4]);
        let camera = Camera::looking(at + aside, at, 0.7);
        let drawn = studio::picture(&mut studio, &studio::scene(camera, lenses.clone()), [161, 121]);
        let (parts, whole) = (studio::bits(&drawn, 0), studio::bits(&drawn, 1));
        // Only at the rim of the whole may they differ: its border is not rounded as theirs are.
        let depth = drawn.depth.as_ref().expect("depth");
        let view = crate::lenses::view(camera, [161, 121]);
        for (k, d) in depth.iter().enumerate() {
            let p = view.pixel_ray(k as u32 % 161, k as u32 / 161).at(f64::from(*d)) - DVec3::new(5.0, 2.0, 5.0);
            let from_rim = (p.abs().max_element() - 4.0).abs();
            assert!(parts[k] == whole[k] || from_rim < 1e-4, "view {i}, pixel {k}: a gap, {from_rim} m from the rim");
        }
        inside += parts.iter().filter(|b| **b).count();
    }
    assert!(inside > 50_000, "{inside}");
}
