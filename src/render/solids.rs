//! The solids of a scene as the GPU reads them.

use std::{ops::Range, sync::Arc};

use crate::geom::Solid;

/// Each solid of a scene once, however many lenses have it.
#[derive(Debug, Default)]
pub struct SolidTable {
    solids: Vec<(Arc<Solid>, SolidPlace)>,
    /// As `shape/solid.wgsl` reads them.
    pub words: Vec<[u32; 4]>,
    /// Corners of all faces, own coordinates, to draw.
    pub corners: Vec<[f32; 3]>,
}

/// Where a solid stands in the table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolidPlace {
    /// Its first entry among the words.
    pub first: u32,
    /// Its corners.
    pub corners: Range<u32>,
}

/// Entries of the words, at most: their numbers reach the GPU as f32, and a binding has its limit.
pub const MOST_ENTRIES: usize = 1 << 23;

impl SolidTable {
    /// Of the solids of a scene, in their order; `Err` is how many entries they would take where there are too many.
    pub fn new<'a>(solids: impl IntoIterator<Item = &'a Arc<Solid>>) -> Result<Self, usize> {
        let mut table = Self::default();
        for solid in once(solids) {
            let (first, corner) = (table.words.len() as u32, table.corners.len() as u32);
            table.words.extend(solid.words());
            table.corners.extend(solid.faces().iter().flatten().map(|p| p.as_vec3().to_array()));
            let place = SolidPlace { first, corners: corner..table.corners.len() as u32 };
            table.solids.push((solid.clone(), place));
            if table.words.len() > MOST_ENTRIES {
                return Err(table.words.len());
            }
        }
        Ok(table)
    }

    /// Where a solid stands.
    pub fn place(&self, solid: &Arc<Solid>) -> Option<&SolidPlace> {
        self.solids.iter().find(|(s, _)| Arc::ptr_eq(s, solid)).map(|(_, place)| place)
    }

    /// Whether it holds just these solids.
    pub fn holds<'a>(&self, solids: impl IntoIterator<Item = &'a Arc<Solid>>) -> bool {
        let wanted = once(solids);
        wanted.len() == self.solids.len() && wanted.iter().all(|solid| self.place(solid).is_some())
    }
}

/// Each once.
fn once<'a>(solids: impl IntoIterator<Item = &'a Arc<Solid>>) -> Vec<&'a Arc<Solid>> {
    let mut wanted: Vec<&Arc<Solid>> = Vec::new();
    for solid in solids {
        if !wanted.iter().any(|s| Arc::ptr_eq(s, solid)) {
            wanted.push(solid);
        }
    }
    wanted
}
