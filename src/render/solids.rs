//! The solids of a scene as the GPU reads them.

use std::{ops::Range, sync::Arc};

use crate::geom::{Solid, shape::solid::Near};

/// Each solid of a scene once, however many lenses have it.
#[derive(Debug, Default)]
pub struct SolidTable {
    solids: Vec<(Arc<Solid>, f64, SolidPlace)>,
    /// Columns and faces as `shape/solid.wgsl` reads them, and which are near as `lib/solid-distance.wgsl` does.
    pub words: Vec<[u32; 4]>,
    /// Corners of all faces, own coordinates, to draw.
    pub corners: Vec<[f32; 3]>,
}

/// Where a solid stands in the table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolidPlace {
    /// Its first entry among the words.
    pub first: u32,
    /// The first entry of the grid of those that are near; 0: it has none.
    pub near: u32,
    /// Its corners.
    pub corners: Range<u32>,
}

/// Entries of the words, at most: their numbers reach the GPU as f32, and a binding has its limit.
pub const MOST_ENTRIES: usize = 1 << 23;

impl SolidTable {
    /// Of the solids of a scene, in their order, each with how far from it its distance is asked for, metres; `Err` is how many
    /// entries they would take where there are too many.
    pub fn new<'a>(solids: impl IntoIterator<Item = (&'a Arc<Solid>, f64)>) -> Result<Self, usize> {
        let mut table = Self::default();
        for (solid, reach) in once(solids) {
            let (first, corner) = (table.words.len() as u32, table.corners.len() as u32);
            table.words.extend(solid.words());
            let near = if reach > 0.0 { table.words.len() as u32 } else { 0 };
            if reach > 0.0 {
                table.words.extend(Near::new(solid, reach).words(solid.faces()));
            }
            table.corners.extend(solid.faces().iter().flatten().map(|p| p.as_vec3().to_array()));
            let place = SolidPlace { first, near, corners: corner..table.corners.len() as u32 };
            table.solids.push((solid.clone(), reach, place));
            if table.words.len() > MOST_ENTRIES {
                return Err(table.words.len());
            }
        }
        Ok(table)
    }

    /// Where a solid stands.
    pub fn place(&self, solid: &Arc<Solid>) -> Option<&SolidPlace> {
        self.solids.iter().find(|(s, ..)| Arc::ptr_eq(s, solid)).map(|(.., place)| place)
    }

    /// Whether it holds just these solids, for these distances.
    pub fn holds<'a>(&self, solids: impl IntoIterator<Item = (&'a Arc<Solid>, f64)>) -> bool {
        let wanted = once(solids);
        let is_held = |(solid, reach): &(&Arc<Solid>, f64)| {
            self.solids.iter().any(|(s, r, _)| Arc::ptr_eq(s, solid) && r == reach)
        };
        wanted.len() == self.solids.len() && wanted.iter().all(is_held)
    }
}

/// Each once, with the farthest that is asked for.
fn once<'a>(solids: impl IntoIterator<Item = (&'a Arc<Solid>, f64)>) -> Vec<(&'a Arc<Solid>, f64)> {
    let mut wanted: Vec<(&Arc<Solid>, f64)> = Vec::new();
    for (solid, reach) in solids {
        match wanted.iter_mut().find(|(s, _)| Arc::ptr_eq(s, solid)) {
            Some((_, farthest)) => *farthest = farthest.max(reach),
            None => wanted.push((solid, reach)),
        }
    }
    wanted
}
