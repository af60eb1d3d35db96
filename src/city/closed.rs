//! Whether triangles close: every edge is used as often in one direction as in the other. No edge is looked up: each adds a number made
//! of its two ends, or takes it away in the other direction. What is open has the sum 0 with a probability of 2⁻⁶⁴.

use glam::DVec3;

/// What the edges of a triangle add, wrapping, to the sum of an object; corners in metres, compared to the bit.
pub fn edges(corners: [DVec3; 3]) -> u64 {
    let ends = corners.map(number);
    let of = |sum: u64, (from, to): (usize, usize)| sum.wrapping_add(directed(ends[from], ends[to]));
    [(0, 1), (1, 2), (2, 0)].into_iter().fold(0, of)
}

/// SplitMix64's last step.
fn mixed(n: u64) -> u64 {
    let n = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let n = (n ^ (n >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    n ^ (n >> 31)
}

/// A number of a place, by its bits; −0 is 0.
fn number(place: DVec3) -> u64 {
    let add = |n: u64, x: f64| mixed(n.wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_add((x + 0.0).to_bits()));
    place.to_array().into_iter().fold(0, add)
}

/// A number of an edge; that of the opposite edge is its negative, and that from a place to itself 0.
fn directed(from: u64, to: u64) -> u64 {
    let of = |low: u64, high: u64| mixed(mixed(low).wrapping_add(high.rotate_left(32)));
    match from.cmp(&to) {
        std::cmp::Ordering::Less => of(from, to),
        std::cmp::Ordering::Greater => of(to, from).wrapping_neg(),
        std::cmp::Ordering::Equal => 0,
    }
}
