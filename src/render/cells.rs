//! Cells: the objects of a city in groups that stand near each other, and in which detail a view draws each of them.
//!
//! The order of a city's triangles on the GPU is that of its cells: near numbers are near places. What is terrain belongs to none.

use std::ops::Range;

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, Tile},
    geom::Aabb,
    render::city::{CHUNK_TRIANGLES, Chunk, Shown},
    view::View,
};

/// The cell of what is in none.
pub(super) const NO_CELL: u32 = u32::MAX;

/// In which detail a cell is drawn, finest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum Detail {
    /// As the model has it.
    Full,
    /// Block models: footprint prisms, where an object has no geometry of level of detail 1.
    Blocks,
    /// What looks up of these.
    Roofs,
    /// Not at all.
    Nothing,
}

impl Detail {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Full, Self::Blocks, Self::Roofs, Self::Nothing];

    /// Its bit in [`Chunk::details`].
    pub fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// The tiles of what is shown in drawing order.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// Tile and cell; those of terrain last.
    pub tiles: Vec<(u32, u32)>,
    /// The cell of each object that has one.
    pub of_object: FxHashMap<u32, u32>,
    /// How many there are.
    pub count: u32,
}

/// Interleaves the low 21 bits of x and y: near numbers are near places.
fn morton(x: u32, y: u32) -> u64 {
    (0..21).fold(0, |code, bit| code | u64::from(x >> bit & 1) << (2 * bit) | u64::from(y >> bit & 1) << (2 * bit + 1))
}

impl Cells {
    /// Objects in Morton order of their middles, about [`CHUNK_TRIANGLES`] triangles to a cell; what has more alone is a cell of its own.
    pub fn new(shown: &Shown, extent: &Aabb) -> Self {
        let model = shown.model;
        let scale = f64::from((1 << 21) - 1) / extent.size().x.max(extent.size().y).max(1.0);
        let code = |bounds: &Aabb| {
            let at = (bounds.center() - extent.min) * scale;
            morton(at.x.max(0.0) as u32, at.y.max(0.0) as u32)
        };
        let tiles = || shown.geometries.iter().flat_map(|&g| model.geometries[g as usize].tiles.clone());
        let mut objects: FxHashMap<u32, (Aabb, usize)> = FxHashMap::default();
        for tile in tiles().map(|t| &model.tiles[t as usize]) {
            let object = model.geometries[tile.geometry as usize].object;
            if !model.objects[object as usize].class.is_ground() {
                let (bounds, triangles) = objects.entry(object).or_insert((Aabb::EMPTY, 0));
                (*bounds, *triangles) = (bounds.union(tile.bounds), *triangles + tile.indices.len() / 3);
            }
        }
        let mut ordered: Vec<(u64, u32, usize)> =
            objects.iter().map(|(&object, (bounds, triangles))| (code(bounds), object, *triangles)).collect();
        ordered.sort_unstable();
        let mut made = Self::default();
        // The cell that is being filled, and its triangles.
        let mut open: Option<(u32, usize)> = None;
        for (_, object, triangles) in ordered {
            let is_large = triangles > CHUNK_TRIANGLES;
            let (cell, sum) = open.filter(|_| !is_large).unwrap_or_else(|| {
                made.count += 1;
                (made.count - 1, 0)
            });
            made.of_object.insert(object, cell);
            if !is_large {
                open = Some((cell, sum + triangles)).filter(|(_, sum)| *sum < CHUNK_TRIANGLES);
            }
        }
        let mut keyed: Vec<(u32, u64, u32)> =
            tiles().map(|t| (made.of(model, t), code(&model.tiles[t as usize].bounds), t)).collect();
        keyed.sort_unstable();
        made.tiles = keyed.into_iter().map(|(cell, _, tile)| (tile, cell)).collect();
        made
    }

    /// The cell of a tile.
    pub fn of(&self, model: &CityModel, tile: u32) -> u32 {
        let Tile { geometry, .. } = model.tiles[tile as usize];
        let object = model.geometries[geometry as usize].object;
        self.of_object.get(&object).copied().unwrap_or(NO_CELL)
    }
}

/// What a cell takes to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellFigures {
    /// Box around it in every detail, metres.
    pub bounds: Aabb,
    /// Triangles by [`Detail`], the last of which has none.
    pub triangles: [u32; 3],
}

impl CellFigures {
    /// Of all cells, from the chunks of a city.
    pub fn of_all<'a>(count: u32, chunks: impl Iterator<Item = &'a Chunk>) -> Vec<Self> {
        let mut cells = vec![Self { bounds: Aabb::EMPTY, triangles: [0; 3] }; count as usize];
        for chunk in chunks {
            let Some(cell) = cells.get_mut(chunk.cell as usize) else { continue };
            cell.bounds = cell.bounds.union(chunk.bounds);
            for (detail, sum) in Detail::ALL.iter().zip(&mut cell.triangles) {
                if chunk.details & detail.bit() != 0 {
                    *sum += triangles_in(&chunk.range);
                }
            }
        }
        cells
    }

    fn triangles(&self, detail: Detail) -> u32 {
        self.triangles.get(detail as usize).copied().unwrap_or(0)
    }
}

/// Triangles of a run of indices.
pub(super) fn triangles_in(indices: &Range<u32>) -> u32 {
    (indices.end - indices.start) / 3
}

/// The detail of each cell; without any, all is as the model has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Details(Vec<Detail>);

impl Details {
    /// Whether a chunk of the scene's own city is drawn.
    pub fn show(&self, chunk: &Chunk) -> bool {
        let detail = self.0.get(chunk.cell as usize).copied().unwrap_or(Detail::Full);
        chunk.details & detail.bit() != 0
    }

    /// For a view that draws at most `most` triangles of cells, casters of shadows included: all that is seen takes the finest detail that has
    /// no more triangles per pixel that it covers than all of that may have. What is beside the picture, and may throw its shadow
    /// into it, is blocks, as far as they go from the eye on.
    pub fn new(cells: &[CellFigures], view: &View, most: u64) -> Self {
        let frustum = view.frustum(1.0);
        let (seen, mut beside): (Vec<usize>, Vec<usize>) =
            (0..cells.len()).partition(|&i| frustum.meets(&cells[i].bounds));
        let seen: Vec<(usize, f64)> = seen.into_iter().map(|i| (i, covered(view, &cells[i].bounds))).collect();
        let full = |i: usize| u64::from(cells[i].triangles(Detail::Full));
        if seen.iter().map(|(i, _)| full(*i)).chain(beside.iter().map(|i| full(*i))).sum::<u64>() <= most {
            return Self::default();
        }
        let (density, taken) = densest(cells, &seen, most);
        let mut details = vec![Detail::Nothing; cells.len()];
        seen.iter().for_each(|&(i, area)| details[i] = finest(&cells[i], area, density));
        let eye = view.camera.eye.truncate();
        beside.sort_by_cached_key(|&i| {
            let distance = cells[i].bounds.center().truncate().distance_squared(eye);
            (distance.to_bits(), i)
        });
        let mut left = most - taken;
        for i in beside {
            let Some(rest) = left.checked_sub(cells[i].triangles(Detail::Blocks).into()) else { break };
            (details[i], left) = (Detail::Blocks, rest);
        }
        Self(details)
    }
}

/// The most triangles per pixel that all seen cells, with the pixels that they cover, may have for at most `most` triangles; and how many these
/// are. Each cell goes from nothing to its finest detail in steps, at the density at which it fits: they are taken from the lowest on.
fn densest(cells: &[CellFigures], seen: &[(usize, f64)], most: u64) -> (f64, u64) {
    let mut steps: Vec<(f64, i64)> = Vec::with_capacity(3 * seen.len());
    for &(i, area) in seen {
        // From the coarsest: what has no fewer triangles than a finer one is never shown.
        let mut before = 0;
        for detail in [Detail::Roofs, Detail::Blocks, Detail::Full] {
            let own = cells[i].triangles(detail);
            if Detail::ALL.iter().all(|finer| *finer >= detail || cells[i].triangles(*finer) > own) {
                steps.push((f64::from(own) / area, i64::from(own) - before));
                before = i64::from(own);
            }
        }
    }
    steps.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let (mut density, mut taken) = (0.0, 0);
    for together in steps.chunk_by(|a, b| a.0 == b.0) {
        let next = taken + together.iter().map(|step| step.1).sum::<i64>();
        if next as u64 > most {
            break;
        }
        (density, taken) = (together[0].0, next);
    }
    (density, taken as u64)
}

/// The finest detail of a cell with at most so many triangles per pixel; `area`: the pixels that it covers.
fn finest(cell: &CellFigures, area: f64, density: f64) -> Detail {
    let fits = |detail: &Detail| f64::from(cell.triangles(*detail)) / area <= density;
    Detail::ALL.into_iter().find(fits).unwrap_or(Detail::Nothing)
}

/// Pixels of a view's that a box covers at most: of the square around the ball around it. At least one.
fn covered(view: &View, bounds: &Aabb) -> f64 {
    let size = DVec2::new(view.size[0].into(), view.size[1].into());
    let radius = 0.5 * bounds.size().length();
    let Some(center) = view.pixel(bounds.center()).filter(|center| center.z > radius) else { return size.x * size.y };
    let per_metre = 0.5 * size.y / view.half_extent().y;
    let reach = radius * if view.is_orthographic() { per_metre } else { per_metre / center.z };
    let part = (center.truncate() + reach).min(size) - (center.truncate() - reach).max(DVec2::ZERO);
    (part.x.max(0.0) * part.y.max(0.0)).max(1.0)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::view::Camera;

    fn view() -> View {
        View::new(Camera::looking(DVec3::new(0.0, -300.0, 60.0), DVec3::ZERO, 0.8), [160, 120], &Aabb::EMPTY)
            .expect("a view")
    }

    fn cells() -> impl Strategy<Value = Vec<CellFigures>> {
        let cell = (-400.0..400.0_f64, -250.0..2000.0_f64, 1.0..60.0_f64, 1..5_u32, 1..9_u32, 2..100_u32);
        prop::collection::vec(cell, 1..60).prop_map(|all| {
            all.into_iter()
                .map(|(x, y, size, more, walls, roofs)| {
                    let min = DVec3::new(x, y, 0.0);
                    let blocks = roofs * (1 + walls);
                    CellFigures { bounds: Aabb { min, max: min + size }, triangles: [blocks * more, blocks, roofs] }
                })
                .collect()
        })
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Never more than may be, shadows included; nothing is simplified where all fits; more room never makes a cell that is seen coarser; and
        /// what is beside the picture is there from the eye on.
        #[test]
        fn details_keep_within_their_triangles(cells in cells(), most in 0..40_000_u64) {
            let view = view();
            let frustum = view.frustum(1.0);
            let all: u64 = cells.iter().map(|c| u64::from(c.triangles[0])).sum();
            let details = Details::new(&cells, &view, most);
            prop_assert_eq!(details == Details::default(), all <= most);
            if all > most {
                let drawn = |d: &Details| -> u64 { cells.iter().zip(&d.0).map(|(c, d)| u64::from(c.triangles(*d))).sum() };
                prop_assert!(drawn(&details) <= most);
                let beside = |i: &usize| !frustum.meets(&cells[*i].bounds);
                let distance = |i: usize| cells[i].bounds.center().truncate().distance(view.camera.eye.truncate());
                let is_there = |i: &usize| details.0[*i] == Detail::Blocks;
                let (there, gone): (Vec<_>, Vec<_>) = (0..cells.len()).filter(beside).partition(is_there);
                prop_assert!(gone.iter().all(|&i| details.0[i] == Detail::Nothing));
                let furthest = there.iter().map(|&i| distance(i)).fold(0.0, f64::max);
                prop_assert!(gone.iter().all(|&i| distance(i) >= furthest));
                let finer = Details::new(&cells, &view, most + most / 2);
                let is_finer = |i: usize| finer == Details::default() || finer.0[i] <= details.0[i];
                prop_assert!((0..cells.len()).filter(|i| !beside(i)).all(is_finer));
            }
        }
    }

    #[test]
    fn what_is_near_is_finer_than_what_is_far() {
        let row = (0..40).map(|i| {
            let min = DVec3::new(-5.0, -200.0 + 60.0 * f64::from(i), 0.0);
            CellFigures { bounds: Aabb { min, max: min + 10.0 }, triangles: [1000, 300, 60] }
        });
        let cells: Vec<_> = row.collect();
        let details = Details::new(&cells, &view(), 9_000).0;
        assert_eq!(details[0], Detail::Full);
        assert!(details.is_sorted(), "{details:?}");
        assert!(details.iter().all(|detail| details.contains(&Detail::Roofs) && *detail <= Detail::Nothing));
    }
}
