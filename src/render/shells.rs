//! Which city objects are closed shells, as they are drawn: what lies behind their surface can be told from what lies before it.

use rustc_hash::FxHashMap;

use crate::render::{
    city::{Shown, corners_of},
    layout,
};

/// Flags of the table of surfaces by object; open ones are left out.
pub(super) type Shells = FxHashMap<u32, u32>;

/// What is summed up of an object's triangles.
#[derive(Default)]
struct Sum {
    /// Of its directed edges: 0 where each has its opposite.
    edges: u64,
    /// Six times what it encloses, cubic metres; negative where its faces look inwards.
    volume: f64,
}

/// The closed shells among what `tiles` of a city show: every edge of an object is used as often in one direction as in the
/// other, so that a ray enters it as often as it leaves it.
///
/// No edge is looked up: each adds a number made of its two ends, or takes it away in the other direction. An open object has
/// the sum 0 with a probability of 2⁻⁶⁴.
pub(super) fn closed_shells(shown: &Shown, tiles: impl Iterator<Item = u32>, middle: glam::DVec3) -> Shells {
    let model = shown.model;
    let mut sums: FxHashMap<u32, Sum> = FxHashMap::default();
    for t in tiles {
        let tile = &model.tiles[t as usize];
        for triangle in tile.indices.start / 3..tile.indices.end / 3 {
            let corners = corners_of(model, tile, triangle);
            let Some(surface) = model.surfaces.get(corners[0].surface as usize) else { continue };
            let places = corners.map(|v| tile.origin.as_dvec3() + glam::Vec3::from(v.position).as_dvec3());
            let ends = places.map(number);
            let sum = sums.entry(surface.object).or_default();
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                sum.edges = sum.edges.wrapping_add(directed(ends[from], ends[to]));
            }
            let [a, b, c] = places.map(|place| place - middle);
            sum.volume += a.dot(b.cross(c));
        }
    }
    let flags = |sum: &Sum| match sum {
        Sum { edges: 0, volume } if *volume > 0.0 => Some(layout::SURFACE_CLOSED),
        Sum { edges: 0, volume } if *volume < 0.0 => Some(layout::SURFACE_CLOSED | layout::SURFACE_INWARD),
        _ => None,
    };
    sums.iter().filter_map(|(&object, sum)| Some((object, flags(sum)?))).collect()
}

/// SplitMix64's last step.
fn mixed(n: u64) -> u64 {
    let n = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let n = (n ^ (n >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    n ^ (n >> 31)
}

/// A number of a place, by its bits; −0 is 0.
fn number(place: glam::DVec3) -> u64 {
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
