//! Finds polygons given more than once in one object at one LoD.

use super::{
    job::{Context, corner_ranges},
    staging::Shape,
};
use crate::city::model::{NONE, Surface};

/// Buffers kept between objects.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Per polygon of the object: a sum over its edges (alike wherever rings start), the geometry, the polygon in it.
    keys: Vec<(u64, u32, u32)>,
}

/// Marks repeated polygons in `repeated` (per geometry of `raws`, per polygon): of each set of polygons with the same
/// rings in the same direction, starting anywhere, the one that knows most about its surface stays, else the first.
pub(super) fn mark(raws: &[Shape<'_>], context: &Context<'_>, scratch: &mut Scratch, repeated: &mut Vec<Vec<bool>>) {
    repeated.clear();
    repeated.extend(raws.iter().map(|raw| vec![false; raw.polygons.polygon_ends.len()]));
    if raws.iter().map(|raw| raw.polygons.polygon_ends.len()).sum::<usize>() < 2 {
        return;
    }
    scratch.keys.clear();
    for (g, raw) in raws.iter().enumerate() {
        for p in 0..raw.polygons.polygon_ends.len() {
            if let Some(sum) = edge_sum(raw, p, context) {
                scratch.keys.push((sum, g as u32, p as u32));
            }
        }
    }
    scratch.keys.sort_unstable();
    for same in scratch.keys.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        let mut kept: Vec<(usize, usize)> = Vec::new();
        for &(_, g, p) in same {
            let new = (g as usize, p as usize);
            match kept.iter_mut().find(|old| are_same(raws, [**old, new], context)) {
                None => kept.push(new),
                Some(old) => {
                    let knows = |(g, p): (usize, usize)| knowledge(&raws[g], p, context.surfaces);
                    let loser = if knows(new) > knows(*old) { std::mem::replace(old, new) } else { new };
                    repeated[loser.0][loser.1] = true;
                }
            }
        }
    }
}

/// A rank of what a polygon's surface says: semantics above material.
fn knowledge(raw: &Shape<'_>, polygon: usize, surfaces: &[Surface]) -> u8 {
    let surface = raw.polygons.surfaces.get(polygon).and_then(|&s| surfaces.get(s as usize));
    surface.map_or(0, |s| 2 * u8::from(s.kind.0 != NONE) + u8::from(s.material != NONE))
}

/// A sum over the polygon's directed edges; `None` if it names vertices that are not there.
fn edge_sum(raw: &Shape<'_>, polygon: usize, context: &Context<'_>) -> Option<u64> {
    let grid = context.grid(raw);
    let mut sum = u64::from(grid.class);
    for (number, ring) in corner_ranges(raw.polygons, polygon).enumerate() {
        let role = if number == 0 { 0x9e37_79b9 } else { 0x85eb_ca6b };
        let indices = raw.polygons.indices.get(ring)?;
        let point = |index: u32| raw.pool.points.get(index).map(|p| mix_point(grid.absolute(p)));
        let mut previous = point(*indices.last()?)?;
        for &index in indices {
            let next = point(index)?;
            sum = sum.wrapping_add(mix(previous ^ next.rotate_left(23) ^ role));
            previous = next;
        }
    }
    Some(sum)
}

fn mix_point(p: [i64; 3]) -> u64 {
    p.iter().fold(0, |h, &c| mix(h ^ c as u64))
}

/// One round of the splitmix64 finaliser.
fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^ (x >> 27)
}

/// Whether two polygons really have the same rings: the sums only point at candidates.
fn are_same(raws: &[Shape<'_>], pair: [(usize, usize); 2], context: &Context<'_>) -> bool {
    let [grid_a, grid_b] = pair.map(|(g, _)| context.grid(&raws[g]));
    if grid_a.class != grid_b.class {
        return false;
    }
    let rings = |(g, p): (usize, usize)| -> Vec<Vec<[i64; 3]>> {
        let (raw, grid) = (&raws[g], context.grid(&raws[g]));
        let points = |ring: std::ops::Range<usize>| {
            raw.polygons.indices[ring]
                .iter()
                .filter_map(|&i| raw.pool.points.get(i))
                .map(|p| grid.absolute(p))
                .collect()
        };
        let mut rings: Vec<Vec<[i64; 3]>> = corner_ranges(raw.polygons, p).map(points).collect();
        for ring in &mut rings {
            start_at_least(ring);
        }
        if let Some((_, holes)) = rings.split_first_mut() {
            holes.sort();
        }
        rings
    };
    rings(pair[0]) == rings(pair[1])
}

/// Rotates a ring to its lexicographically smallest form.
fn start_at_least(ring: &mut [[i64; 3]]) {
    let n = ring.len();
    let start = crate::geom::triangulate::least_rotation(n, |i| ring[i]);
    ring.rotate_left(start);
}
