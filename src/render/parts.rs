//! The parts in which large pictures are drawn.

use crate::{render::eye::PictureTile, shader::effect_file::MOST_REACH};

/// Longest side of a target; larger pictures are drawn in tiles.
pub const TILE: u32 = 4096;
/// Pixels by which tiles overlap, so that what looks at neighbours (outlines, filters) has them.
const OVERLAP: u32 = 8 + MOST_REACH;

/// A rectangle that is drawn, and the part of it that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// What is drawn.
    pub drawn: PictureTile,
    /// What of it is kept.
    pub kept: PictureTile,
}

/// All of a picture.
pub(super) fn whole(size: [u32; 2]) -> PictureTile {
    PictureTile::whole(size)
}

/// Cuts a picture into parts that fit a target.
pub(super) fn parts(size: [u32; 2]) -> Vec<Part> {
    let cuts = |side: u32| -> Vec<[u32; 4]> {
        if side <= TILE {
            return vec![[0, side, 0, side]];
        }
        let step = TILE - 2 * OVERLAP;
        (0..side.div_ceil(step))
            .map(|i| {
                let (from, to) = (i * step, ((i + 1) * step).min(side));
                [from.saturating_sub(OVERLAP), (to + OVERLAP).min(side), from, to]
            })
            .collect()
    };
    let mut parts = Vec::new();
    for y in cuts(size[1]) {
        for x in cuts(size[0]) {
            let rect = |k: usize| PictureTile { origin: [x[k], y[k]], size: [x[k + 1] - x[k], y[k + 1] - y[k]] };
            parts.push(Part { drawn: rect(0), kept: rect(2) });
        }
    }
    parts
}

/// Copies the kept part of a drawn rectangle into the picture.
pub(super) fn put<T: Copy>(out: &mut [T], size: [u32; 2], part: Part, drawn: &[T]) {
    let Part { drawn: d, kept: k } = part;
    let width = k.size[0] as usize;
    for y in k.origin[1]..k.origin[1] + k.size[1] {
        let to = y as usize * size[0] as usize + k.origin[0] as usize;
        let from = (y - d.origin[1]) as usize * d.size[0] as usize + (k.origin[0] - d.origin[0]) as usize;
        out[to..to + width].copy_from_slice(&drawn[from..from + width]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_keep_every_pixel_once() {
        for size in [[1, 1], [4096, 17], [4097, 9], [12_000, 4100]] {
            let mut hits = vec![0_u8; size[0] as usize * size[1] as usize];
            for part in parts(size) {
                assert!(part.drawn.size.iter().all(|&s| s <= TILE));
                let ones = vec![1; part.drawn.size[0] as usize * part.drawn.size[1] as usize];
                let before: u64 = hits.iter().map(|&h| u64::from(h)).sum();
                put(&mut hits, size, part, &ones);
                let after: u64 = hits.iter().map(|&h| u64::from(h)).sum();
                assert_eq!(after - before, u64::from(part.kept.size[0]) * u64::from(part.kept.size[1]));
            }
            assert!(hits.iter().all(|&h| h == 1));
        }
    }
}
