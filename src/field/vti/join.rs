//! Arrays of several pieces of an image, joined.

use crate::field::{data::Values, grid::checked_size, output::Output, vti::Extent};

/// The values of one piece.
pub struct Piece {
    /// Its samples, not its cells.
    pub extent: Extent,
    pub values: Values,
}

/// An array, in pieces.
pub struct Joined {
    pub name: String,
    pub is_cells: bool,
    pub components: usize,
    /// The samples of the whole image.
    pub whole: Extent,
    pub pieces: Vec<Piece>,
}

impl Joined {
    /// The samples of the image that the pieces have, and the values of all; what no piece has is missing.
    pub fn into_values(mut self, output: &mut Output) -> Result<(Extent, Values), String> {
        if let [piece] = &mut self.pieces[..] {
            let values = std::mem::replace(&mut piece.values, Values::U8(Vec::new()));
            if piece.extent != self.whole {
                output.warn(format!("the only piece of \"{}\" is smaller than the whole image", self.name));
            }
            return Ok((piece.extent, values));
        }
        let mut extent = [[i64::MAX, i64::MIN]; 3];
        for piece in &self.pieces {
            for (all, own) in extent.iter_mut().zip(piece.extent) {
                *all = [all[0].min(own[0]), all[1].max(own[1])];
            }
        }
        let size = self.size(extent);
        checked_size(size)?;
        let count = size.iter().product::<usize>() * self.components;
        let have: usize = self.pieces.iter().map(|piece| piece.values.len()).sum();
        // Pieces share borders. A few of them far apart are no image.
        if have < count / 2 {
            return Err(format!("the pieces of \"{}\" have {have} of its {count} numbers", self.name));
        }
        output.reserve(size, self.components, 4)?;
        let mut all = vec![f32::NAN; count];
        let mut is_bytes = true;
        for piece in &self.pieces {
            is_bytes &= matches!(piece.values, Values::U8(_));
            self.copy(piece, extent, size, &mut all);
        }
        let is_whole = all.iter().all(|value| value.is_finite());
        if !is_whole && is_bytes {
            output.warn(format!("the pieces of \"{}\" do not cover the image; the rest is missing", self.name));
        }
        let values = match is_bytes && is_whole {
            true => Values::U8(all.into_iter().map(|value| value as u8).collect()),
            false => Values::F32(all),
        };
        Ok((extent, values))
    }

    fn size(&self, extent: Extent) -> [usize; 3] {
        let fewer = i64::from(self.is_cells);
        extent.map(|[first, last]| usize::try_from(last - first + 1 - fewer).unwrap_or(0).max(1))
    }

    fn copy(&self, piece: &Piece, extent: Extent, size: [usize; 3], all: &mut [f32]) {
        let [nx, ny, nz] = self.size(piece.extent);
        let from: [usize; 3] =
            std::array::from_fn(|axis| usize::try_from(piece.extent[axis][0] - extent[axis][0]).unwrap_or(0));
        let mut next = 0;
        for z in 0..nz {
            for y in 0..ny {
                let row = from[0] + size[0] * (from[1] + y + size[1] * (from[2] + z));
                let to = all.get_mut(row * self.components..).unwrap_or_default();
                for value in to.iter_mut().take(nx * self.components) {
                    *value = piece.values.get(next);
                    next += 1;
                }
            }
        }
    }
}
