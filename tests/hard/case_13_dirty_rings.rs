//! Case 13: rings with touching holes, spikes, duplicate points, 10,000 corners; zero-area, self-crossing, two-point
//! rings. Property: the triangulated area equals the ring's area exactly and nothing overlaps, or the face is refused
//! with a reason. Oracle: shoelace, winding numbers and separating axes in `i128`.

use proptest::prelude::*;
use veduta::geom::triangulate::{Refusal, Triangulator};

use crate::oracle::{Numbers, P2, P3, interiors_meet, on_segment, shoelace, turn, winding};

/// Triangulates rings of the plane, laid into space by `place` (an exact integer map that keeps the plane's sides).
fn triangulate(rings: &[Vec<P2>], place: impl Fn(P2) -> P3) -> Result<Vec<[P2; 3]>, Refusal> {
    let flat: Vec<P2> = rings.concat();
    let points: Vec<P3> = flat.iter().map(|&p| place(p)).collect();
    let mut end = 0;
    let ends: Vec<u32> = rings
        .iter()
        .map(|ring| {
            end += ring.len() as u32;
            end
        })
        .collect();
    let mut triangles = Vec::new();
    Triangulator::default().triangulate(&points, &ends, &mut triangles)?;
    Ok(triangles.into_iter().map(|t| t.map(|i| flat[i as usize])).collect())
}

/// The three ways a plane is laid into space: level, steep in x, steep in y.
fn places() -> [fn(P2) -> P3; 3] {
    [|[u, v]| [u, v, 7], |[u, v]| [3 * u - 2 * v, u, v], |[u, v]| [v, -5 * u - 3 * v, u]]
}

/// Rings are good when, with the outer one counter-clockwise and holes clockwise, no edges cross and every place is
/// enclosed once or not at all. Sampled at points that are on no edge of rings with small even coordinates.
fn enclosed(rings: &[Vec<P2>], p: P2) -> i32 {
    let mut sum = 0;
    for (i, ring) in rings.iter().enumerate() {
        let turned = (shoelace(ring) < 0) != (i > 0);
        sum += if turned { -winding(ring, p) } else { winding(ring, p) };
    }
    sum
}

fn edges(rings: &[Vec<P2>]) -> Vec<(P2, P2)> {
    rings.iter().flat_map(|ring| (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]))).collect()
}

/// What must hold of rings whatever they are; `span`: coordinates are multiples of 1000 in `0..=span × 1000`.
fn check(rings: &[Vec<P2>], span: i64) -> Result<bool, TestCaseError> {
    let all_edges = edges(rings);
    let samples: Vec<P2> = (0..span * 3)
        .flat_map(|x| (0..span * 3).map(move |y| [x * 333 + 101, y * 333 + 59]))
        .filter(|&p| !all_edges.iter().any(|&(a, b)| on_segment(p, a, b)))
        .collect();
    let overlapping = samples.iter().any(|&p| !(0..=1).contains(&enclosed(rings, p)));
    let outcome = triangulate(rings, |[u, v]| [u, v, 0]);
    let Ok(triangles) = outcome else { return Ok(false) };
    prop_assert!(!overlapping, "rings that cover a place twice are refused");
    let area: i128 = rings.iter().enumerate().map(|(i, r)| shoelace(r).abs() * if i == 0 { 1 } else { -1 }).sum();
    let facing = shoelace(&rings[0]).signum();
    prop_assert!(triangles.iter().all(|t| turn(t[0], t[1], t[2]).signum() == facing), "all face as the ring does");
    prop_assert_eq!(triangles.iter().map(|t| turn(t[0], t[1], t[2]).abs()).sum::<i128>(), area);
    for (i, s) in triangles.iter().enumerate() {
        prop_assert!(triangles[..i].iter().all(|t| !interiors_meet(*s, *t)), "triangles overlap");
    }
    for p in samples {
        let inside = |t: &[P2; 3]| (0..3).all(|i| turn(t[i], t[(i + 1) % 3], p).signum() != -facing);
        let strictly = |t: &[P2; 3]| (0..3).all(|i| turn(t[i], t[(i + 1) % 3], p).signum() == facing);
        let wanted = enclosed(rings, p) == 1;
        prop_assert_eq!(triangles.iter().any(inside), wanted || triangles.iter().any(|t| inside(t) && !strictly(t)));
    }
    Ok(true)
}

fn small_ring(points: std::ops::Range<usize>) -> impl Strategy<Value = Vec<P2>> {
    prop::collection::vec([0_i64..7, 0_i64..7].prop_map(|p| p.map(|c| c * 1000)), points)
}

proptest! {
    #![proptest_config(crate::seeds::cases(3000))]

    /// Anything at all: crossing, touching, folding back, repeating itself.
    #[test]
    fn any_ring_is_exact_or_refused(ring in small_ring(0..11)) {
        check(&[ring], 7)?;
    }

    /// A square with holes that may touch, overlap or stick out.
    #[test]
    fn any_holes_are_exact_or_refused(holes in prop::collection::vec(small_ring(3..6), 1..4)) {
        let holes: Vec<Vec<P2>> = holes.into_iter().filter(|hole| shoelace(hole) != 0).collect();
        let mut rings = vec![vec![[0, 0], [6000, 0], [6000, 6000], [0, 6000]]];
        rings.extend(holes);
        check(&rings, 7)?;
    }

    /// Simple rings are never refused, whatever dirt lies on them, however they lie in space.
    #[test]
    fn dirt_on_a_star_changes_nothing(
        radii in prop::collection::vec(1_000_000_i64..9_000_000, 3..60),
        dirt in prop::collection::vec((0_usize..60, 0_u8..3), 0..10),
    ) {
        let star = star(&radii);
        let mut dirty = star.clone();
        for (at, kind) in dirt {
            let i = at % dirty.len();
            let (p, next) = (dirty[i], dirty[(i + 1) % dirty.len()]);
            match kind {
                0 => dirty.insert(i, p),
                // A whisker outwards and back.
                1 => dirty.splice(i..i, [p, [2 * p[0], 2 * p[1]]]).for_each(drop),
                // Along the next edge and back.
                _ => dirty.splice(i..i, [p, next]).for_each(drop),
            }
        }
        for place in places() {
            let clean = triangulate(std::slice::from_ref(&star), place).unwrap();
            let found = triangulate(std::slice::from_ref(&dirty), place);
            prop_assert!(found.is_ok(), "{:?}", found);
            let sum = |triangles: &[[P2; 3]]| triangles.iter().map(|t| turn(t[0], t[1], t[2])).sum::<i128>();
            prop_assert_eq!(sum(&found.unwrap()), shoelace(&star));
            prop_assert_eq!(sum(&clean), shoelace(&star));
            prop_assert_eq!(clean.len(), star.len() - 2, "every corner is used");
        }
    }
}

/// A star-shaped ring: simple by construction, as angles grow and no two corners are opposite.
fn star(radii: &[i64]) -> Vec<P2> {
    let n = radii.len() as f64;
    let corner = |(i, &r): (usize, &i64)| {
        let angle = (i as f64 + 0.3) / n * std::f64::consts::TAU;
        [(r as f64 * angle.cos()) as i64, (r as f64 * angle.sin()) as i64]
    };
    radii.iter().enumerate().map(corner).collect()
}

/// Area, and that each of many sample places is covered as often as it is enclosed.
fn check_large(rings: &[Vec<P2>], seed: u64) {
    let triangles = triangulate(rings, |[u, v]| [u, v, u + v]).unwrap();
    let area: i128 = rings.iter().enumerate().map(|(i, r)| shoelace(r).abs() * if i == 0 { 1 } else { -1 }).sum();
    let facing = shoelace(&rings[0]).signum();
    assert!(triangles.iter().all(|t| turn(t[0], t[1], t[2]).signum() == facing));
    assert_eq!(triangles.iter().map(|t| turn(t[0], t[1], t[2]).abs()).sum::<i128>(), area);
    let corners: usize = rings.iter().map(Vec::len).sum();
    assert_eq!(triangles.len(), corners + 2 * (rings.len() - 1) - 2);
    let low = [0, 1].map(|axis| rings[0].iter().map(|p| p[axis]).min().unwrap());
    let high = [0, 1].map(|axis| rings[0].iter().map(|p| p[axis]).max().unwrap());
    let mut numbers = Numbers(seed);
    for _ in 0..100 {
        let p = [0, 1].map(|axis| low[axis] + numbers.below((high[axis] - low[axis]) as u64));
        let signs = |t: &[P2; 3]| [0, 1, 2].map(|i| (turn(t[i], t[(i + 1) % 3], p) * facing).signum());
        if triangles.iter().any(|t| signs(t).contains(&0) && !signs(t).contains(&-1)) {
            continue;
        }
        let cover = triangles.iter().filter(|t| signs(t) == [1; 3]).count();
        assert_eq!(cover as i32, enclosed(rings, p), "at {p:?}");
    }
}

#[test]
fn a_star_of_ten_thousand_corners() {
    let mut numbers = Numbers(13);
    let radii: Vec<i64> = (0..10_000).map(|_| 400_000_000 + numbers.below(600_000_000)).collect();
    check_large(&[star(&radii)], 1);
}

#[test]
fn a_spiral_of_ten_thousand_corners() {
    let at = |i: i64, radius: i64| {
        let angle = i as f64 * 0.05;
        let r = (1000 * i + radius) as f64;
        [(r * angle.cos()) as i64, (r * angle.sin()) as i64]
    };
    let mut ring: Vec<P2> = (100..5100).map(|i| at(i, 40_000)).collect();
    ring.extend((100..5100).rev().map(|i| at(i, 0)));
    check_large(&[ring], 2);
}

#[test]
fn a_wall_with_a_thousand_windows_that_touch_at_their_corners() {
    let mut rings = vec![vec![[-10, -10], [1010, -10], [1010, 1010], [-10, 1010]]];
    for i in 0..100_i64 {
        for j in 0..10_i64 {
            // Diagonal rows: each window touches the next one in a corner.
            let (x, y) = (i * 10, (j * 100 + i * 10) % 1000);
            let mut window = vec![[x, y], [x + 10, y], [x + 10, y + 10], [x, y + 10]];
            if (i + j) % 2 == 0 {
                window.reverse();
            }
            rings.push(window);
        }
    }
    let triangles = triangulate(&rings, |[u, v]| [u, 3, v]).unwrap();
    let covered: i128 = triangles.iter().map(|t| turn(t[0], t[1], t[2]).abs()).sum();
    assert_eq!(covered, 2 * (1020 * 1020 - 1000 * 100));
}

#[test]
fn reasons_name_what_is_wrong() {
    let refused = |ring: &[P2]| triangulate(&[ring.to_vec()], |[u, v]| [5, u, v]).unwrap_err();
    assert_eq!(refused(&[]), Refusal::ShortRing);
    assert_eq!(refused(&[[0, 0], [9, 9]]), Refusal::ShortRing);
    assert_eq!(refused(&[[0, 0], [9, 9], [0, 0]]), Refusal::ShortRing);
    assert_eq!(refused(&[[0, 0], [9, 9], [4, 4], [1, 1]]), Refusal::ZeroArea);
    assert_eq!(refused(&[[0, 0], [9, 0], [0, 9], [9, 9]]), Refusal::SelfCrossing);
    assert_eq!(refused(&[[0, 0], [9, 0], [0, 9], [8, 9]]), Refusal::SelfCrossing);
}
