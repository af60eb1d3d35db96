//! The parts of a picture that shading and filters are drawn over, as triangles of one mesh.

use std::ops::Range;

use crate::render::{
    eye::PictureTile,
    operations::Filter,
    screen_bound::{Mesh, ScreenBound, merged},
    seen::{SeenVolume, part_of},
};

/// Pixels to a texel of what is shaded for a filter, and of what it makes.
const UNFILTERED_BLOCK: [u32; 2] = [4, 1];
const FILTERED_BLOCK: [u32; 2] = [4, 4];

/// Corners of the frame's mesh, and texels that cut what they span.
pub(super) type Piece = (Range<u32>, PictureTile);

/// Where a filter and what it reads are drawn.
#[derive(Clone, Debug)]
pub(super) struct FilterParts {
    /// The image that it reads, and others that read the same; of the first of these.
    pub unfiltered: Vec<Piece>,
    pub down: Vec<Piece>,
    pub across: Vec<Piece>,
}

/// Where a frame is drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct PictureParts {
    /// The triangles.
    pub mesh: Mesh,
    /// Outside of where lenses may be seen and rays bent, and there.
    pub outside: Vec<Piece>,
    pub inside: Vec<Piece>,
    /// Of each filter.
    pub filters: Vec<FilterParts>,
}

impl PictureParts {
    /// Those of a picture of this size; `looked_at`: the lenses, ascending, of those seen that do anything to how places look; `bent`: where rays may be.
    pub fn new(
        seen: &[SeenVolume],
        looked_at: &[u32],
        bent: Option<ScreenBound>,
        filters: &[Filter],
        size: [u32; 2],
    ) -> Self {
        let (mut mesh, whole) = (Mesh::default(), PictureTile::whole(size));
        let of_lenses = part_of(seen.iter().filter(|v| looked_at.binary_search(&v.lens).is_ok()));
        let [outside, inside] = match of_lenses.into_iter().chain(bent).reduce(ScreenBound::with) {
            Some(part) => [vec![(mesh.add_beyond(part, size), whole)], mesh.add(part, size, [1, 1])],
            None => [vec![(mesh.all(), whole)], Vec::new()],
        };
        let filters = filter_parts(filters, size, seen, &mut mesh);
        Self { mesh, outside, inside, filters }
    }

    /// All of the picture.
    pub fn all(&self) -> Vec<Piece> {
        [&self.outside[..], &self.inside].concat()
    }
}

/// Where the uses of a filter may be seen.
fn areas_of(filter: &Filter, size: [u32; 2], seen: &[SeenVolume]) -> Vec<ScreenBound> {
    let of_use = |(lens, _): &(Option<u32>, u32)| match lens {
        None => Some(ScreenBound::whole(size)),
        Some(lens) => part_of(seen.iter().filter(|v| v.lens == *lens)),
    };
    merged(filter.uses.iter().filter_map(of_use).collect())
}

/// Where the filters of a frame are drawn, each over what the ones after it read.
fn filter_parts(filters: &[Filter], size: [u32; 2], seen: &[SeenVolume], mesh: &mut Mesh) -> Vec<FilterParts> {
    let areas: Vec<Vec<ScreenBound>> = filters.iter().map(|f| areas_of(f, size, seen)).collect();
    let grown = |k: usize, by: [i32; 2]| areas[k].iter().map(move |area| area.grown(by)).collect::<Vec<_>>();
    let parts_of = |i: usize| {
        let reach = filters[i].reach as i32;
        let mut add =
            |parts: Vec<ScreenBound>, block| merged(parts).into_iter().flat_map(|p| mesh.add(p, size, block)).collect();
        let unfiltered = match is_first(filters, i) {
            true => with_same_image(filters, i).flat_map(|k| grown(k, [filters[k].reach as i32; 2])).collect(),
            false => Vec::new(),
        };
        FilterParts {
            unfiltered: add(unfiltered, UNFILTERED_BLOCK),
            down: add(grown(i, [reach, 0]), FILTERED_BLOCK),
            across: add(areas[i].clone(), FILTERED_BLOCK),
        }
    };
    (0..filters.len()).map(parts_of).collect()
}

/// Whether no filter before it reads the same image.
pub(super) fn is_first(filters: &[Filter], i: usize) -> bool {
    filters[..i].iter().all(|f| f.plan != filters[i].plan)
}

/// It and the filters after it that read the same image.
pub(super) fn with_same_image(filters: &[Filter], i: usize) -> impl Iterator<Item = usize> {
    (i..filters.len()).filter(move |&k| filters[k].plan == filters[i].plan)
}
