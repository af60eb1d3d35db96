use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::*;
use crate::geom::deform::{
    Band, Control, ControlPlane, Deformation, Frame, Operator, Profile, Space,
    tests::{deformation, ready, vector},
};

type Bits = [u64; 3];
/// The edges of a refined mesh, and its triangles, by places at rest.
type Mesh = Vec<[DVec3; 3]>;

fn bits(p: DVec3) -> Bits {
    p.to_array().map(f64::to_bits)
}

fn even(_: DVec3) -> f64 {
    1.0
}

/// A bump of 20 m × 20 m around a place, rising by `rise`.
fn bump(at: DVec3, rise: f64) -> Deformers {
    let size = DVec2::splat(20.0);
    let control = ControlPlane { corner: -0.5 * size.extend(0.0), size, profile: Profile::Bump, band: None };
    Deformers(vec![ready(Deformation {
        frame: Frame { pivot: at, ..Frame::WORLD },
        space: Space::World,
        chain: vec![Operator::Translate(DVec3::Z * rise)],
        control: Control::Plane(control),
    })])
}

/// What is drawn, at rest: triangles that were kept and refined ones, each with its source.
fn drawn(positions: &[DVec3], triangles: &[[u32; 3]], refined: &Refined) -> Vec<(u32, [DVec3; 3])> {
    let kept = refined.kept.iter().map(|&i| (i, triangles[i as usize].map(|i| positions[i as usize])));
    let fine = refined.triangles.iter().map(|corners| {
        let corners = corners.map(|i| refined.vertices[i as usize]);
        (corners[0].source, corners.map(|vertex| vertex.rest))
    });
    kept.chain(fine).collect()
}

fn double_area(triangle: &[DVec3; 3]) -> DVec3 {
    (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0])
}

/// A ball of 8·4ᵐ triangles, its corners shaken.
fn body(center: DVec3, radius: f64, shakes: &[DVec3]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut positions = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let mut middles = BTreeMap::new();
    let mut middle = |positions: &mut Vec<DVec3>, a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a as usize] + positions[b as usize]).normalize_or(DVec3::X));
            positions.len() as u32 - 1
        })
    };
    triangles = triangles
        .iter()
        .flat_map(|&[a, b, c]| {
            let [m, n, k] = [(a, b), (b, c), (c, a)].map(|(a, b)| middle(&mut positions, a, b));
            [[a, m, k], [m, b, n], [k, n, c], [m, n, k]]
        })
        .collect();
    let shaken = positions.iter().zip(shakes.iter().cycle()).map(|(p, shake)| center + radius * (*p + 0.2 * *shake));
    (shaken.collect(), triangles)
}

/// Each directed edge of a closed body once, and once the other way.
fn is_closed(mesh: &[(u32, [DVec3; 3])]) -> bool {
    let mut edges: BTreeMap<(Bits, Bits), i32> = BTreeMap::new();
    for (_, t) in mesh {
        for i in 0..3 {
            *edges.entry((bits(t[i]), bits(t[(i + 1) % 3]))).or_default() += 1;
        }
    }
    edges.iter().all(|((a, b), count)| *count == 1 && edges.get(&(*b, *a)) == Some(&1))
}

/// The true chord error, by brute force.
fn chord_error(deformers: &Deformers, a: DVec3, b: DVec3) -> f64 {
    let (start, end) = (deformers.value(a), deformers.value(b));
    let off = |i: u32| {
        let t = f64::from(i) / 256.0;
        deformers.value(a + (b - a) * t).distance(start + (end - start) * t)
    };
    (0..=256).map(off).fold(0.0, f64::max)
}

/// True and predicted error, metres, of every edge of what was refined that meets a support and is bent by more than rounding.
fn chords(refined: &Refined, refiner: &Refiner<'_>) -> Vec<(f64, Chord)> {
    let corners = refined.triangles.iter().map(|corners| corners.map(|i| refined.vertices[i as usize].rest));
    let edges: BTreeMap<_, _> = corners
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .filter(|(a, b)| refiner.meets(*a, *b))
        .map(|(a, b)| ((bits(a).min(bits(b)), bits(a).max(bits(b))), (a, b)))
        .collect();
    let both = edges.values().map(|(a, b)| (chord_error(refiner.deformers, *a, *b), refiner.chord(*a, *b)));
    both.filter(|(truth, _)| *truth > 1e-7).collect()
}

/// A level square around zero, as two triangles with one diagonal.
fn terrain(half: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner = |x: f64, y: f64| DVec3::new(x * half, y * half, 0.0);
    (vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], vec![[0, 1, 2], [0, 2, 3]])
}

#[test]
fn a_small_lens_in_a_large_triangle_is_found() {
    let (positions, triangles) = terrain(5000.0);
    // In the middle of one triangle; across the diagonal; over a corner.
    for at in [DVec3::new(1234.5, -2345.6, 0.0), DVec3::new(100.0, 105.0, 0.0), positions[2]] {
        let deformers = bump(at, 9.0);
        let refined = refined(&positions, &triangles, &deformers, &even, 0.05, Limits::default());
        assert_eq!(refined.report, Report { tolerance_px: 0.05, shortest_m: 0.01, ..Report::default() });
        // Every place of the lens is where it should be.
        for i in 0..2000 {
            let t = f64::from(i);
            let p = at + DVec3::new(9.0 * (t * 0.37).sin(), 9.0 * (t * 0.59).cos(), 0.0);
            let rise = deformers.value(p).z;
            let over = refined.triangles.iter().map(|t| t.map(|i| refined.vertices[i as usize])).find_map(|t| {
                let full = double_area(&t.map(|v| v.rest)).z;
                let part = |i: usize, j: usize| double_area(&[t[i].rest, t[j].rest, p]).z / full;
                let weights = [part(1, 2), part(2, 0), part(0, 1)];
                let height = (0..3).map(|i| weights[i] * t[i].shown.z).sum::<f64>();
                weights.iter().all(|w| *w >= -1e-9).then_some(height)
            });
            if p.abs().max_element() <= 5000.0 {
                assert!((over.expect("a triangle over it") - rise).abs() < 0.1, "{p} {over:?} {rise}");
            }
        }
        let smallest = refined.vertices.len();
        assert!((100..40_000).contains(&smallest), "{smallest}");
    }
}

#[test]
fn what_no_lens_meets_keeps_its_indices() {
    let (positions, triangles) = terrain(50.0);
    let away = bump(DVec3::new(80.0, 0.0, 0.0), 9.0);
    let refined = refined(&positions, &triangles, &away, &even, 0.05, Limits::default());
    assert_eq!((refined.kept, refined.triangles.len()), (vec![0, 1], 0));
    // A lens that touches one of them from above, with an end to its heights.
    let mut below = bump(DVec3::new(20.0, -30.0, 100.0), 9.0).0.remove(0).deformation().clone();
    if let Control::Plane(plane) = &mut below.control {
        plane.band = Some(Band { low: -99.0, high: 0.0, fade: 1.0 });
    }
    let near = Deformers(vec![ready(below)]);
    assert_eq!(super::refined(&positions, &triangles, &near, &even, 0.05, Limits::default()).kept, [0, 1]);
    let inside = bump(DVec3::new(20.0, -30.0, 0.0), 9.0);
    assert_eq!(super::refined(&positions, &triangles, &inside, &even, 0.05, Limits::default()).kept, [1]);
}

#[test]
fn slivers_stay_slivers() {
    let at = DVec3::new(85_000.0, 447_000.0, 0.0);
    let across = DVec3::new(0.6, 0.8, 0.0);
    let positions = [at - 500.0 * across, at + 500.0 * across, at + 1e-3 * DVec3::Z];
    let deformers = bump(at, 9.0);
    let refined = refined(&positions, &[[0, 1, 2]], &deformers, &even, 0.05, Limits::default());
    assert_eq!(refined.report.too_coarse, 0);
    assert!((10..2000).contains(&refined.triangles.len()), "{}", refined.triangles.len());
    let area: f64 = drawn(&positions, &[[0, 1, 2]], &refined).iter().map(|(_, t)| double_area(t).length()).sum();
    assert!((area - 1.0).abs() < 1e-6);
    for vertex in &refined.vertices {
        let mixed = positions[0] * vertex.weights.x + positions[1] * vertex.weights.y + positions[2] * vertex.weights.z;
        assert!(mixed.distance(vertex.rest) < 1e-9 && vertex.shown == deformers.value(vertex.rest));
    }
    // Corners in one place, and on one line.
    for flat in [[positions[0]; 3], [positions[0], positions[1], at]] {
        let refined = super::refined(&flat, &[[0, 1, 2]], &deformers, &even, 0.05, Limits::default());
        assert!(refined.report.too_coarse == 0 && refined.triangles.len() < 2000);
    }
}

#[test]
fn too_many_are_said_and_not_cut_off() {
    let (positions, triangles) = terrain(50.0);
    let deformers = bump(DVec3::ZERO, 9.0);
    let fine = refined(&positions, &triangles, &deformers, &even, 1e-4, Limits::default());
    let few = refined(&positions, &triangles, &deformers, &even, 1e-4, Limits { triangles: 500, ..Limits::default() });
    assert!(few.triangles.len() <= 500 && fine.triangles.len() > 5000, "{}", few.triangles.len());
    assert!(few.report.tolerance_px > 1e-4 && fine.report.tolerance_px == 1e-4);
    let area: f64 = drawn(&positions, &triangles, &few).iter().map(|(_, t)| double_area(t).length()).sum();
    assert!((area - 20_000.0).abs() < 1e-6, "nothing is missing");
    let flat = refined(&positions, &triangles, &deformers, &even, 1e-4, Limits { triangles: 1, ..Limits::default() });
    assert!(flat.triangles.len() == 2 && flat.report.shortest_m == f64::INFINITY && flat.report.too_coarse > 0);
    let shallow =
        refined(&positions, &triangles, &deformers, &even, 1e-4, Limits { shortest_m: 20.0, ..Limits::default() });
    assert!(shallow.report.too_coarse > 0 && shallow.report.shortest_m == 20.0);
    let broken = [positions[0], DVec3::NAN, positions[2]];
    let unusable = refined(&broken, &[[0, 1, 2], [0, 2, 9]], &deformers, &even, 1e-4, Limits::default());
    assert_eq!((unusable.report.unusable, unusable.kept), (2, vec![0, 1]));
}

#[test]
fn what_is_far_is_coarser() {
    let (positions, triangles) = terrain(50.0);
    let deformers = bump(DVec3::ZERO, 9.0);
    let seen_from = |distance: f64| {
        let eye = DVec3::new(0.0, -distance, 2.0);
        let scale = |p: DVec3| 1000.0 / p.distance(eye).max(0.1);
        refined(&positions, &triangles, &deformers, &scale, 1.0, Limits::default()).triangles.len()
    };
    let [near, far] = [30.0, 3000.0].map(seen_from);
    assert!(near > 20 * far, "{near} {far}");
}

proptest! {
    #![proptest_config(crate::seeds::cases(24))]

    #[test]
    fn neighbours_meet_whatever_the_order(
        deformation in deformation(5e4), second in deformation(9.0), is_double in any::<bool>(),
        shift in vector(20.0), shakes in prop::collection::vec(vector(1.0), 18),
        keys in prop::collection::vec(any::<u32>(), 32),
    ) {
        let center = deformation.frame.pivot + shift;
        let (positions, triangles) = body(center, 15.0, &shakes);
        let mut deformers = Deformers(vec![ready(deformation.at_strength(0.3))]);
        if is_double {
            let frame = Frame { pivot: center + second.frame.pivot, ..second.frame };
            deformers.0.push(ready(Deformation { frame, ..second.at_strength(0.3) }));
        }
        let limits = Limits { triangles: 60_000, ..Limits::default() };
        let whole = refined(&positions, &triangles, &deformers, &even, 0.2, limits);
        let mesh = drawn(&positions, &triangles, &whole);
        prop_assert!(is_closed(&mesh), "{:?}", whole.report);

        // The same area of each face and the same volume, none of it turned.
        let faces = triangles.iter().map(|t| t.map(|i| positions[i as usize]));
        for (source, face) in faces.enumerate() {
            let normal = double_area(&face);
            let parts = mesh.iter().filter(|(of, _)| *of == source as u32).map(|(_, t)| double_area(t));
            let sum = parts.clone().sum::<DVec3>();
            prop_assert!(sum.distance(normal) < 1e-6 * normal.length());
            prop_assert!((parts.map(DVec3::length).sum::<f64>() - normal.length()).abs() < 1e-6 * normal.length());
        }

        // Triangles in another order, each from another corner or from the other side.
        let mut order: Vec<usize> = (0..triangles.len()).collect();
        order.sort_by_key(|&i| keys[i]);
        let other: Vec<[u32; 3]> = order.iter().map(|&i| {
            let [a, b, c] = triangles[i];
            [[a, b, c], [b, c, a], [c, a, b], [c, b, a], [a, c, b], [b, a, c]][keys[i] as usize % 6]
        }).collect();
        let again = refined(&positions, &other, &deformers, &even, 0.2, limits);
        let set = |mesh: Mesh| -> BTreeSet<[Bits; 3]> {
            mesh.iter().map(|t| { let mut t = t.map(bits); t.sort_unstable(); t }).collect()
        };
        let all = |refined: &Refined, triangles: &[[u32; 3]]| {
            drawn(&positions, triangles, refined).into_iter().map(|(_, t)| t).collect::<Mesh>()
        };
        prop_assert_eq!(set(all(&again, &other)), set(all(&whole, &triangles)));
        prop_assert_eq!(again.report, whole.report);
    }
}

proptest! {
    #![proptest_config(crate::seeds::sample(8, 24))]

    #[test]
    fn edges_are_as_near_as_predicted(
        deformation in deformation(300.0), second in deformation(9.0), is_double in any::<bool>(),
        shift in vector(10.0), shakes in prop::collection::vec(vector(1.0), 18), fineness in 0.0..3.0f64,
    ) {
        let center = deformation.frame.pivot + shift;
        let (positions, triangles) = body(center, 15.0, &shakes);
        let mut deformers = Deformers(vec![ready(deformation)]);
        if is_double {
            let frame = Frame { pivot: center + second.frame.pivot, ..second.frame };
            deformers.0.push(ready(Deformation { frame, ..second }));
        }
        let tolerance_px = 0.5 * 10.0_f64.powf(-fineness);
        let limits = Limits { triangles: 30_000, ..Limits::default() };
        let refined = refined(&positions, &triangles, &deformers, &even, tolerance_px, limits);
        prop_assume!(refined.report.too_coarse == 0);
        let tolerance_px = refined.report.tolerance_px;
        let refiner = Refiner { deformers: &deformers, pixels_per_m: &even, tolerance_px, shortest_m: limits.shortest_m };
        let chords = chords(&refined, &refiner);
        for (truth, chord) in &chords {
            prop_assert!(*truth <= 1.05 * chord.metres.min(tolerance_px), "{} {:?}", truth, chord);
        }
        // Where the tolerance decides, and not only the size of what is to be seen.
        let near = chords.iter().filter(|(_, chord)| chord.pixels >= 0.3 * tolerance_px);
        let mut ratios: Vec<f64> = near.map(|(truth, chord)| truth / chord.metres).collect();
        ratios.sort_by(f64::total_cmp);
        if ratios.len() >= 30 {
            prop_assert!(ratios[ratios.len() / 2] >= 0.5, "{}", ratios[ratios.len() / 2]);
        }
    }
}
