//! Case 14: non-planar faces. Property: the same triangles wherever rings start, whichever way they run, however the
//! holes are ordered and wherever the face lies. Oracle: equality of sets of triangles.

use std::collections::BTreeSet;

use proptest::prelude::*;
use veduta::geom::triangulate::{Refusal, Triangulator};

use crate::oracle::{P3, normal};

/// The set of triangles, each as its sorted corners; and whether all of them face as `up` says.
fn triangles(rings: &[Vec<P3>]) -> Result<BTreeSet<[P3; 3]>, Refusal> {
    let points: Vec<P3> = rings.concat();
    let mut end = 0;
    let ends: Vec<u32> = rings
        .iter()
        .map(|ring| {
            end += ring.len() as u32;
            end
        })
        .collect();
    let mut found = Vec::new();
    Triangulator::default().triangulate(&points, &ends, &mut found)?;
    let sorted = |t: [u32; 3]| {
        let mut t = t.map(|i| points[i as usize]);
        t.sort_unstable();
        t
    };
    let set: BTreeSet<_> = found.iter().map(|&t| sorted(t)).collect();
    assert_eq!(set.len(), found.len(), "no triangle twice");
    Ok(set)
}

/// A bumpy star with up to three bumpy holes, given by heights and radii.
pub fn face(radii: &[i64], heights: &[i64], holes: usize) -> Vec<Vec<P3>> {
    let n = radii.len();
    let ring = |center: [i64; 2], scale: f64, count: usize| -> Vec<P3> {
        (0..count)
            .map(|i| {
                let angle = (i as f64 + 0.37) / count as f64 * std::f64::consts::TAU;
                let r = radii[i % n] as f64 * scale;
                let (x, y) = ((r * angle.cos()) as i64, (r * angle.sin()) as i64);
                [center[0] + x, center[1] + y, heights[i % heights.len()]]
            })
            .collect()
    };
    let mut rings = vec![ring([0, 0], 1.0, n)];
    let places = [[200, 150], [-220, 90], [30, -240]];
    rings.extend(places[..holes].iter().map(|&center| ring(center, 0.05, 5)));
    rings
}

proptest! {
    #![proptest_config(crate::seeds::cases(1500))]

    #[test]
    fn the_same_triangles_however_the_face_is_written(
        radii in prop::collection::vec(600_i64..2000, 4..50),
        heights in prop::collection::vec(-90_i64..90, 1..9),
        holes in 0_usize..4,
        starts in prop::collection::vec(0_usize..50, 4),
        reversed in prop::collection::vec(any::<bool>(), 4),
        swap in any::<bool>(),
        shift in [-1_000_000_000_000_i64..1_000_000_000_000, -1_000_000_000..1_000_000_000, -9_000..9_000],
        axes in 0_usize..3,
    ) {
        let mut rings = face(&radii, &heights, holes);
        for p in rings.iter_mut().flatten() {
            p.rotate_left(axes);
        }
        let plain = triangles(&rings).unwrap();
        let mut other = rings.clone();
        for ((ring, start), reverse) in other.iter_mut().zip(&starts).zip(&reversed) {
            let n = ring.len();
            ring.rotate_left(start % n);
            if *reverse {
                ring.reverse();
            }
            for p in ring {
                *p = [0, 1, 2].map(|i| p[i] + shift[i]);
            }
        }
        if swap {
            other[1..].reverse();
        }
        let moved: BTreeSet<_> =
            triangles(&other).unwrap().into_iter().map(|t| t.map(|p| [0, 1, 2].map(|i| p[i] - shift[i]))).collect();
        prop_assert_eq!(moved, plain);
    }
}

#[test]
fn triangles_turn_with_the_ring() {
    let ring: Vec<P3> = face(&[900, 1200, 700, 1500, 800, 1000], &[40, -60, 10], 0).remove(0);
    let mut up = Vec::new();
    let mut down = Vec::new();
    Triangulator::default().triangulate(&ring, &[6], &mut up).unwrap();
    let backwards: Vec<P3> = ring.iter().rev().copied().collect();
    Triangulator::default().triangulate(&backwards, &[6], &mut down).unwrap();
    assert!(up.iter().all(|t| normal(t.map(|i| ring[i as usize]))[2] > 0));
    assert!(down.iter().all(|t| normal(t.map(|i| backwards[i as usize]))[2] < 0));
}

#[test]
fn a_repeated_lowest_corner_does_not_unsettle_the_start() {
    // Two loops that touch in their lowest corner, which therefore stands twice in the ring.
    let ring: Vec<P3> = vec![[0, 0, 0], [5, 1, 3], [5, 4, -2], [0, 0, 0], [2, 6, 1], [0, 5, 4]];
    let plain = triangles(std::slice::from_ref(&ring)).unwrap();
    for start in 0..6 {
        let mut turned = ring.clone();
        turned.rotate_left(start);
        assert_eq!(triangles(&[turned.clone()]).unwrap(), plain);
        turned.reverse();
        assert_eq!(triangles(&[turned]).unwrap(), plain);
    }
}
