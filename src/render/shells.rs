//! Which city objects are closed shells, as they are drawn: what lies behind their surface can be told from what lies before it.

use rustc_hash::FxHashMap;

use crate::{
    city::closed::edges,
    render::{
        city::{Shown, corners_of},
        layout,
    },
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
pub(super) fn closed_shells(shown: &Shown, tiles: impl Iterator<Item = u32>, middle: glam::DVec3) -> Shells {
    let model = shown.model;
    let mut sums: FxHashMap<u32, Sum> = FxHashMap::default();
    for t in tiles {
        let tile = &model.tiles[t as usize];
        for triangle in tile.indices.start / 3..tile.indices.end / 3 {
            let corners = corners_of(model, tile, triangle);
            let Some(surface) = model.surfaces.get(corners[0].surface as usize) else { continue };
            let places = corners.map(|v| tile.origin.as_dvec3() + glam::Vec3::from(v.position).as_dvec3());
            let sum = sums.entry(surface.object).or_default();
            sum.edges = sum.edges.wrapping_add(edges(places));
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
