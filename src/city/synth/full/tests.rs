//! The written city, read back with nothing but a JSON reader.

use std::collections::HashMap;

use crate::city::synth::full::{field::P3, shell::Shell};

fn cross(a: P3, b: P3) -> [i128; 3] {
    let [a, b] = [a, b].map(|v| v.map(i128::from));
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn minus(a: P3, b: P3) -> P3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [i128; 3], b: P3) -> i128 {
    (0..3).map(|k| a[k] * i128::from(b[k])).sum()
}

/// Twice the vector area of a ring.
fn area(points: &[P3], ring: &[u32]) -> [i128; 3] {
    let at = |i: usize| points[ring[i % ring.len()] as usize];
    let mut sum = [0; 3];
    for i in 0..ring.len() {
        let part = cross(minus(at(i), at(0)), minus(at(i + 1), at(0)));
        sum = [sum[0] + part[0], sum[1] + part[1], sum[2] + part[2]];
    }
    sum
}

/// A shell is closed, looks outward, and its faces are exactly planar, with holes that run the other way round.
pub fn check_shell(shell: &Shell, id: &str) {
    let points = &shell.points;
    let mut edges: HashMap<(P3, P3), i32> = HashMap::new();
    let mut six_volumes = 0;
    for (surface, rings) in &shell.faces {
        let normal = area(points, &rings[0]);
        assert_ne!(normal, [0; 3], "{id}: a face without area ({surface:?})");
        for (k, ring) in rings.iter().enumerate() {
            let ring_area = area(points, ring);
            let along: i128 = (0..3).map(|i| normal[i] * ring_area[i]).sum();
            assert_eq!(along > 0, k == 0, "{id}: holes run the other way round ({surface:?})");
            let first = points[rings[0][0] as usize];
            for (i, a) in ring.iter().enumerate() {
                let (a, b) = (points[*a as usize], points[ring[(i + 1) % ring.len()] as usize]);
                assert_eq!(dot(normal, minus(a, first)), 0, "{id}: not planar ({surface:?})");
                *edges.entry((a, b)).or_default() += 1;
            }
            six_volumes += dot(ring_area, minus(points[ring[0] as usize], points[0]));
        }
    }
    for ((a, b), count) in &edges {
        assert_eq!((*count, edges.get(&(*b, *a))), (1, Some(&1)), "{id}: edge {a:?} {b:?} is not closed");
    }
    assert!(six_volumes > 0, "{id}: inside out");
}
