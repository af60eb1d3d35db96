//! Case 14, deformations: non-planar faces. Property: what they become is the same set of triangles, at rest and shown, wherever rings
//! start, whichever way they run and in which order triangles come; and pictures are the same. Oracle: equality.

use std::collections::BTreeSet;

use glam::DVec3;
use proptest::prelude::*;
use veduta::{
    geom::{
        deform::{
            Deformers,
            refine::{Limits, Refined, refined},
        },
        triangulate::Triangulator,
    },
    view::Camera,
};

use crate::{
    bodies::{Body, ORIGIN, place, studio_of},
    case_14_non_planar_faces::face,
    deformed::{deformers, distances, drawn, strong},
    oracle::{Numbers, P3},
    studio,
};

/// Places at rest and shown, to the bit.
type Corner = [u64; 6];

fn bits(rest: DVec3, shown: DVec3) -> Corner {
    let [a, b, c] = rest.to_array().map(f64::to_bits);
    let [d, e, f] = shown.to_array().map(f64::to_bits);
    [a, b, c, d, e, f]
}

/// What a mesh becomes, as a set of triangles that nobody turned.
fn set(positions: &[DVec3], triangles: &[[u32; 3]], deformers: &Deformers) -> (BTreeSet<[Corner; 3]>, Refined) {
    let limits = Limits { triangles: 50_000, ..Limits::default() };
    let made = refined(positions, triangles, deformers, &|_| 20.0, 0.3, limits);
    let sorted = |mut t: [Corner; 3]| {
        t.sort_unstable();
        t
    };
    let fine = made.triangles.iter().map(|t| {
        sorted(t.map(|i| {
            let corner = made.vertices[i as usize];
            bits(corner.rest, corner.shown)
        }))
    });
    let kept = made.kept.iter().map(|&i| {
        let corner = |i: u32| positions[i as usize];
        sorted(triangles[i as usize].map(|i| bits(corner(i), deformers.value(corner(i)))))
    });
    let all: BTreeSet<_> = fine.chain(kept).collect();
    assert_eq!(all.len(), made.triangles.len() + made.kept.len(), "no triangle twice");
    (all, made)
}

/// A face's rings as triangles in the world.
fn triangulated(rings: &[Vec<P3>]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let points: Vec<P3> = rings.concat();
    let ends: Vec<u32> = rings
        .iter()
        .scan(0, |end, ring| {
            *end += ring.len() as u32;
            Some(*end)
        })
        .collect();
    let mut triangles = Vec::new();
    Triangulator::default().triangulate(&points, &ends, &mut triangles).expect("a face");
    (points.iter().map(|p| place(p.map(|c| 10 * c))).collect(), triangles)
}

proptest! {
    #![proptest_config(crate::seeds::cases(20))]

    #[test]
    fn faces_become_the_same_however_they_are_written(
        radii in prop::collection::vec(600_i64..2000, 4..30), heights in prop::collection::vec(-90_i64..90, 1..9),
        holes in 0_usize..4, starts in prop::collection::vec(0_usize..50, 4),
        reversed in prop::collection::vec(any::<bool>(), 4), kind in 0_usize..4, seed in any::<u64>(),
    ) {
        let rings = face(&radii, &heights, holes);
        let mut other = rings.clone();
        for ((ring, start), reverse) in other.iter_mut().zip(&starts).zip(&reversed) {
            let n = ring.len();
            ring.rotate_left(start % n);
            if *reverse {
                ring.reverse();
            }
        }
        other[1..].reverse();
        let deformers = deformers(&strong(kind, ORIGIN, 15.0, &mut Numbers(seed)));
        let (positions, triangles) = triangulated(&rings);
        let (plain, made) = set(&positions, &triangles, &deformers);
        prop_assert!(made.triangles.len() > triangles.len(), "something is split");
        let (positions, triangles) = triangulated(&other);
        let (again, other) = set(&positions, &triangles, &deformers);
        prop_assert_eq!(made.report, other.report);
        prop_assert!(plain == again, "other triangles");
    }

    #[test]
    fn pairs_of_triangles_become_the_same_in_any_order(
        heights in prop::collection::vec(-9.0..9.0f64, 25), keys in prop::collection::vec(any::<u32>(), 32),
        kind in 0_usize..4, seed in any::<u64>(),
    ) {
        // Sixteen quads that are not flat, each as a pair.
        let corner = |i: usize| ORIGIN + DVec3::new(6.0 * (i % 5) as f64 - 12.0, 7.0 * (i / 5) as f64 - 14.0, heights[i]);
        let positions: Vec<DVec3> = (0..25).map(corner).collect();
        let quads = (0..16_u32).map(|i| i % 4 + 5 * (i / 4));
        let pairs: Vec<[u32; 3]> = quads.flat_map(|i| [[i, i + 1, i + 6], [i, i + 6, i + 5]]).collect();
        let mut order: Vec<usize> = (0..32).collect();
        order.sort_by_key(|&i| keys[i]);
        let turned = |i: usize| {
            let [a, b, c] = pairs[i];
            [[a, b, c], [b, c, a], [c, a, b], [c, b, a], [a, c, b], [b, a, c]][keys[i] as usize % 6]
        };
        let other: Vec<[u32; 3]> = order.into_iter().map(turned).collect();
        let deformers = deformers(&strong(kind, ORIGIN, 15.0, &mut Numbers(seed)));
        let (plain, made) = set(&positions, &pairs, &deformers);
        let (again, second) = set(&positions, &other, &deformers);
        prop_assert_eq!(made.report, second.report);
        prop_assert!(plain == again, "other triangles");
    }
}

/// Blocks whose faces are not flat, in metres of ten.
fn crooked(numbers: &mut Numbers) -> Vec<Body> {
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (0..6)
        .map(|i| {
            let corner = |c: i64| -> P3 {
                let half = |axis: i64| if c >> axis & 1 == 0 { -4_000 } else { 4_000 };
                let at = [half(0) + 9_500 * (i % 3 - 1), half(1) + 9_500 * (i / 3), half(2) + 5_000];
                at.map(|c| c + numbers.below(2_001) - 1_000)
            };
            let corners: Vec<P3> = (0..8).map(corner).collect();
            faces.iter().map(|face| face.map(|i| corners[i]).to_vec()).collect()
        })
        .collect()
}

#[test]
fn pictures_are_the_same_however_faces_are_written() {
    const SIZE: [u32; 2] = [240, 180];
    let mut numbers = Numbers(614);
    let bodies = crooked(&mut numbers);
    // Rings that begin elsewhere, faces in another order; and rings the other way round.
    let mut turned = bodies.clone();
    for (i, body) in turned.iter_mut().enumerate() {
        body.rotate_left(1 + i % 5);
        body.iter_mut().for_each(|ring| ring.rotate_left(1 + numbers.below(3) as usize));
    }
    let mut reversed = turned.clone();
    reversed.iter_mut().flatten().for_each(|ring| ring.reverse());
    let mut studios = [&bodies, &turned, &reversed].map(|bodies| studio_of(bodies));
    let center = ORIGIN + DVec3::new(0.0, 5.0, 5.0);
    let mut moved = 0;
    for i in 0..4 {
        let lenses = strong(i, center, 18.0, &mut numbers);
        let eye = center + DVec3::new(30.0, -45.0, 25.0 + i as f64);
        let lenses: Vec<_> = lenses.iter().enumerate().map(|(i, lens)| lens.lens(&i.to_string())).collect();
        let scene = studio::scene(Camera::looking(eye, center, 0.9), lenses);
        let [plain, turned, reversed] = studios.each_mut().map(|studio| drawn(studio, &scene, SIZE));
        let bits = |of| distances(of).iter().map(|d| d.to_bits()).collect::<Vec<_>>();
        assert!(plain.rgba == turned.rgba && plain.normal == turned.normal, "{i}: another picture");
        assert!(bits(&plain) == bits(&turned) && plain.object_id == turned.object_id, "{i}: other places");
        // What stays as it is is drawn the other way round: its distances are rounded otherwise.
        let mut both = distances(&plain).iter().zip(distances(&reversed));
        let is_same = both.all(|(a, b)| a == b || (a - b).abs() < 1e-5 * a);
        assert!(is_same && plain.object_id == reversed.object_id, "{i}: other places, reversed");
        // Rounded on the other side of the sphere.
        let normals = [&plain, &reversed].map(|of| of.normal.iter().flatten().flatten().copied().collect::<Vec<f32>>());
        let mut both = normals[0].iter().zip(&normals[1]);
        assert!(both.all(|(a, b)| (a - b).abs() < 1e-3), "{i}: other normals, reversed");
        moved += plain.statistics.frame.deformed.map_or(0, |deformed| deformed.triangles);
    }
    assert!(moved > 3_000, "{moved}");
}
