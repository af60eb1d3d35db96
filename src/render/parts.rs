//! The parts in which large pictures are drawn.

use crate::{render::eye::PictureTile, shader::effect_file::MOST_REACH};

/// Longest side of a target; larger pictures are drawn in tiles.
pub const TILE: u32 = 4096;
/// What targets, filters and sprites of a tile may take, bytes: where they would take more, tiles are smaller.
const TILE_BYTES: u64 = 1 << 30;
/// The shortest side of a tile that can be asked for.
pub const LEAST_TILE: u32 = 64;
/// Pixels by which tiles overlap, so that what looks at neighbours (outlines, edges) has them; filters may reach farther.
const OVERLAP: u32 = 8 + MOST_REACH;
/// Tiles begin at multiples of so many pixels, as the blocks do in which filters work.
const STEP: u32 = 8;

/// A rectangle that is drawn, and the part of it that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// What is drawn.
    pub drawn: PictureTile,
    /// What of it is kept.
    pub kept: PictureTile,
}

/// How large pictures are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tiling {
    /// Longest side of a target, pixels.
    pub most: u32,
    /// Longest side of what is kept of one, where that is asked for.
    pub kept: Option<u32>,
    /// How far filters look, one after the other, pixels.
    pub reach: u32,
}

/// All of a picture.
pub(super) fn whole(size: [u32; 2]) -> PictureTile {
    PictureTile::whole(size)
}

impl Tiling {
    /// How pictures are cut whose pixels take so many bytes each, on targets of at most `side` pixels.
    pub fn new(side: u32, pixel_bytes: u64, kept: Option<u32>, reach: u32) -> Self {
        let affordable = (TILE_BYTES / pixel_bytes.max(1)).isqrt() as u32;
        let least = 2 * OVERLAP + LEAST_TILE;
        Self { most: TILE.min(affordable.max(least)).min(side), kept, reach }
    }

    /// What one side of a picture is cut into: from where and how much is drawn, and from where to where it is kept.
    fn cuts(&self, side: u32) -> Vec<[u32; 4]> {
        let overlap = OVERLAP.max(8 + self.reach).next_multiple_of(STEP);
        let longest = self.most.saturating_sub(2 * overlap + STEP).max(LEAST_TILE) / STEP * STEP;
        let step = match self.kept {
            Some(kept) if side > kept => kept.next_multiple_of(STEP).min(longest),
            _ if side > self.most => longest,
            _ => return vec![[0, side, 0, side]],
        };
        // As equal as they may be, so that targets are made once.
        let count = side.div_ceil(step);
        let step = side.div_ceil(count).next_multiple_of(STEP);
        let drawn = (step + 2 * overlap).min(side);
        let cut = |i: u32| {
            let (from, to) = (i * step, ((i + 1) * step).min(side));
            let first = from.saturating_sub(overlap).min((side - drawn) / STEP * STEP);
            let end = if to + overlap >= side { side } else { first + drawn };
            [first, end - first, from, to - from]
        };
        (0..count).map(cut).filter(|[.., kept]| *kept > 0).collect()
    }

    /// The parts of a picture that fit a target, row by row: those of a row keep the same rows of pixels.
    pub fn rows(&self, size: [u32; 2]) -> Vec<Vec<Part>> {
        let [columns, rows] = size.map(|side| self.cuts(side));
        let part = |x: &[u32; 4], y: &[u32; 4]| {
            let rect = |k: usize| PictureTile { origin: [x[k], y[k]], size: [x[k + 1], y[k + 1]] };
            Part { drawn: rect(0), kept: rect(2) }
        };
        rows.iter().map(|y| columns.iter().map(|x| part(x, y)).collect()).collect()
    }
}

/// Copies the kept part of a drawn rectangle into rows of a picture that is `width` pixels wide, of which the first is `first_row`.
pub(super) fn put<T: Copy>(out: &mut [T], [picture_width, first_row]: [u32; 2], part: Part, drawn: &[T]) {
    let Part { drawn: d, kept: k } = part;
    let width = k.size[0] as usize;
    for y in k.origin[1]..k.origin[1] + k.size[1] {
        let to = (y - first_row) as usize * picture_width as usize + k.origin[0] as usize;
        let from = (y - d.origin[1]) as usize * d.size[0] as usize + (k.origin[0] - d.origin[0]) as usize;
        out[to..to + width].copy_from_slice(&drawn[from..from + width]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_keep_every_pixel_once_and_know_its_neighbours() {
        let plain = Tiling { most: TILE, kept: None, reach: 0 };
        let small = |kept, reach| Tiling { kept: Some(kept), reach, ..plain };
        let device = Tiling { most: 2048, kept: Some(9000), reach: 64 };
        for tiling in [plain, small(64, 0), small(100, 64), small(128, 200), device] {
            for size in [[1, 1], [300, 200], [4096, 17], [4097, 9], [3001, 4100]] {
                let mut hits = vec![0_u8; size[0] as usize * size[1] as usize];
                let mut next_row = 0;
                for row in tiling.rows(size) {
                    assert!(row.iter().all(|part| part.kept.origin[1] == next_row), "{tiling:?} {size:?}");
                    next_row += row[0].kept.size[1];
                    for part in row {
                        let Part { drawn, kept } = part;
                        assert!(drawn.size.iter().all(|&side| side <= TILE), "{drawn:?}");
                        assert!(drawn.origin.iter().all(|first| first % STEP == 0), "{drawn:?}");
                        for (i, side) in size.into_iter().enumerate() {
                            let [before, after] = [kept.origin[i] - drawn.origin[i], drawn.end(i) - kept.end(i)];
                            let margin = tiling.reach.max(MOST_REACH) + 1;
                            assert!(before >= margin || drawn.origin[i] == 0, "{part:?}");
                            assert!(after >= margin || drawn.end(i) == side, "{part:?}");
                        }
                        let ones = vec![1; drawn.size[0] as usize * drawn.size[1] as usize];
                        let before: u64 = hits.iter().map(|&hit| u64::from(hit)).sum();
                        put(&mut hits, [size[0], 0], part, &ones);
                        let after: u64 = hits.iter().map(|&hit| u64::from(hit)).sum();
                        assert_eq!(after - before, u64::from(kept.size[0]) * u64::from(kept.size[1]));
                    }
                }
                assert!(hits.iter().all(|&hit| hit == 1), "{tiling:?} {size:?}");
            }
        }
    }

    #[test]
    fn tiles_are_smaller_where_pixels_take_more() {
        let most = |side, bytes| Tiling::new(side, bytes, None, 0).most;
        assert_eq!([most(16_384, 48), most(2048, 48), most(16_384, 1024)], [TILE, 2048, 1024]);
        assert_eq!(most(16_384, 1 << 40), 2 * OVERLAP + LEAST_TILE);
    }

    #[test]
    fn targets_are_made_once() {
        let sizes = |tiling: Tiling, size| {
            let mut sizes: Vec<[u32; 2]> =
                tiling.rows(size).into_iter().flatten().map(|part| part.drawn.size).collect();
            sizes.sort_unstable();
            sizes.dedup();
            sizes
        };
        let plain = Tiling { most: TILE, kept: None, reach: 0 };
        assert_eq!(sizes(plain, [16_384, 16_384]), [[3424, 3424]]);
        assert_eq!(sizes(plain, [4096, 4096]), [[4096, 4096]]);
        assert_eq!(sizes(Tiling { kept: Some(96), ..plain }, [288, 192]), [[240, 192]]);
    }
}
