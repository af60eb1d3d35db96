//! What stands near hides what is behind it: the stored depth of the chunks drawn first, as an occlusion-culling depth buffer.
//!
//! From a street most of what the frustum holds is hidden. On a software adapter every hidden triangle costs as much
//! as a seen one, while reading the depth back costs next to nothing: its passes run one after the other anyway, in
//! memory that the processor owns. The buffer is the depth target itself, so it is right whatever was drawn into it, and
//! a chunk is left out only where every fragment of it would have failed the depth test.

use glam::DVec2;

use crate::{
    geom::Aabb,
    gpu::{Gpu, GpuError},
    render::{city::SeenChunk, eye::PictureTile},
    view::View,
};

/// Triangles that are near.
const NEAR_TRIANGLES: u32 = 2048;
/// Triangles beyond it from which it pays: about as many as are drawn in the time of reading depth back.
const LEAST_BEYOND: u32 = 8192;

/// Side of a cell, pixels: the farthest depth of each is kept.
const CELL: usize = 4;
/// Pixels a box's projection is widened by: half of one by which samples lie beside centres, and room for rounding.
const MARGIN_PX: f64 = 1.5;
/// By how much more than its nearest point a chunk must be hidden, as a share of the stored depth: that of a fragment is
/// interpolated in f32 and may come out nearer than the corners it stands between.
const DEPTH_MARGIN: f64 = 1e-3;

/// How far the near chunks reach in a view, metres; `None` where they would not hide enough to pay.
///
/// They pay where their boxes could cover the whole picture: from within the city, not from above it.
pub fn reach<'a>(view: &View, seen: impl Iterator<Item = &'a SeenChunk<'a>>) -> Option<f64> {
    if view.is_orthographic() {
        return None;
    }
    let triangles = |s: &SeenChunk| (s.chunk.range.end - s.chunk.range.start) / 3;
    let mut seen: Vec<&SeenChunk> = seen.collect();
    seen.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let all: u32 = seen.iter().map(|s| triangles(s)).sum();
    if all < NEAR_TRIANGLES + LEAST_BEYOND {
        return None;
    }
    let (mut near, mut cover) = (0, 0.0);
    let size = DVec2::new(view.size[0].into(), view.size[1].into());
    for s in seen {
        cover += projected(view, &s.chunk.bounds).map_or(1.0, |(low, high, _)| {
            let extent = high.clamp(DVec2::ZERO, size) - low.clamp(DVec2::ZERO, size);
            extent.element_product() / size.element_product()
        });
        near += triangles(s);
        if near >= NEAR_TRIANGLES {
            return (cover >= 1.0).then_some(s.distance);
        }
    }
    None
}

/// Box around a box's projection in a perspective picture, pixels, and its least distance along the view axis, metres;
/// `None` where it reaches the near plane.
fn projected(view: &View, bounds: &Aabb) -> Option<(DVec2, DVec2, f64)> {
    let (mut low, mut high, mut nearest) = (DVec2::INFINITY, DVec2::NEG_INFINITY, f64::INFINITY);
    for corner in bounds.corners() {
        let p = view.pixel(corner).filter(|p| p.z > view.camera.near_m)?;
        (low, high, nearest) = (low.min(p.truncate()), high.max(p.truncate()), nearest.min(p.z));
    }
    Some((low, high, nearest))
}

/// The depth of a frame so far, on the CPU.
#[derive(Debug)]
pub struct CullingDepth {
    staging: wgpu::Buffer,
    cells: Cells,
}

/// The farthest stored depths of a target, cell by cell.
#[derive(Debug)]
struct Cells {
    /// Of the target, pixels.
    size: [usize; 2],
    /// One of every cell, row by row.
    farthest: Vec<f32>,
    /// Those of the columns of one row of cells.
    columns: Vec<f32>,
}

impl CullingDepth {
    /// One for a depth target of this size.
    pub fn new(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let staging = gpu.empty_buffer("near depth", usage, u64::from(pitch(width)) * u64::from(height))?;
        Ok(Self { staging, cells: Cells::new([width as usize, height as usize]) })
    }

    /// Whether it fits a depth target.
    pub fn fits(&self, depth: &wgpu::Texture) -> bool {
        self.cells.size == [depth.width() as usize, depth.height() as usize]
    }

    /// Takes down the depth target as it is after the commands before.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, depth: &wgpu::Texture) {
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch(depth.width())), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            depth.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &self.staging, layout },
            depth.size(),
        );
    }

    /// Waits for the copy and reads it.
    pub fn read(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        let Self { staging, cells } = self;
        let [width, height] = cells.size;
        gpu.mapped(staging, |bytes| {
            let rows = bytes.chunks(pitch(width as u32) as usize).take(height);
            cells.fill(&rows.map(|row| &bytemuck::cast_slice(row)[..width]).collect::<Vec<_>>());
        })
    }

    /// Whether nothing within the box can be seen in this part of a perspective picture: it lies beside the part, or behind
    /// what is near.
    pub fn hides(&self, view: &View, part: PictureTile, bounds: &Aabb) -> bool {
        self.cells.hides(view, part, bounds)
    }
}

impl Cells {
    fn new(size: [usize; 2]) -> Self {
        Self { size, farthest: Vec::new(), columns: Vec::new() }
    }

    /// Takes the rows of a target.
    fn fill(&mut self, rows: &[&[f32]]) {
        let Self { size: [width, _], farthest, columns } = self;
        farthest.clear();
        for band in rows.chunks(CELL) {
            columns.clear();
            columns.resize(*width, f32::INFINITY);
            for row in band {
                for (farthest, &depth) in columns.iter_mut().zip(*row) {
                    *farthest = if depth < *farthest { depth } else { *farthest };
                }
            }
            farthest.extend(columns.chunks(CELL).map(|c| c.iter().copied().fold(f32::INFINITY, f32::min)));
        }
    }

    fn hides(&self, view: &View, part: PictureTile, bounds: &Aabb) -> bool {
        let Some((low, high, nearest)) = projected(view, bounds) else { return false };
        let [width, height] = self.size;
        let origin = DVec2::new(part.origin[0].into(), part.origin[1].into());
        let size = DVec2::new(width as f64, height as f64);
        let low = (low - origin - MARGIN_PX).floor().clamp(DVec2::ZERO, size);
        let high = (high - origin + MARGIN_PX).ceil().clamp(DVec2::ZERO, size);
        if low.cmpge(high).any() {
            return true;
        }
        let stored = (view.camera.near_m / nearest * (1.0 + DEPTH_MARGIN)) as f32;
        let cell = |p: DVec2| [p.x as usize / CELL, p.y as usize / CELL];
        let ([left, top], [right, bottom]) = (cell(low), cell(high - 1.0));
        let row = |y: usize| &self.farthest[y * width.div_ceil(CELL)..][left..=right];
        (top..=bottom).all(|y| row(y).iter().all(|&farthest| farthest > stored))
    }
}

/// Bytes between the rows of the copy.
fn pitch(width: u32) -> u32 {
    (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{geom::Ray, view::Camera};
    use glam::DVec3;

    /// Sides that are no whole number of cells.
    const SIZE: [u32; 2] = [37, 22];
    /// The tile of a picture twice as large each way.
    const TILE: PictureTile = PictureTile { origin: [37, 22], size: SIZE };

    fn view(size: [u32; 2]) -> View {
        let camera =
            Camera { near_m: 0.5, ..Camera::looking(DVec3::new(3.0, -2.0, 9.0), DVec3::new(8.0, 90.0, 4.0), 0.9) };
        View::new(camera, size, &Aabb { min: DVec3::splat(-500.0), max: DVec3::splat(500.0) }).expect("a view")
    }

    fn stored(view: &View, distance: f64) -> f32 {
        (view.camera.near_m / distance) as f32
    }

    /// A wall at a distance, with holes through which one sees for ever.
    fn wall(view: &View, distance: f64, holes: &[[u32; 2]]) -> Cells {
        let row = |y: u32| -> Vec<f32> {
            (0..SIZE[0]).map(|x| if holes.contains(&[x, y]) { 0.0 } else { stored(view, distance) }).collect()
        };
        let rows: Vec<Vec<f32>> = (0..SIZE[1]).map(row).collect();
        let mut cells = Cells::new(SIZE.map(|side| side as usize));
        cells.fill(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
        cells
    }

    /// Where along a ray a box begins, beyond the eye.
    fn entry(ray: &Ray, bounds: &Aabb) -> Option<f64> {
        let inverse = ray.direction.recip();
        let (a, b) = ((bounds.min - ray.origin) * inverse, (bounds.max - ray.origin) * inverse);
        let (from, to) = (a.min(b).max_element(), a.max(b).min_element());
        (from <= to && to > 0.0).then_some(from.max(0.0))
    }

    /// Whether some pixel of a tile sees a part of a box through its holes, or before its wall: by rays.
    fn is_seen(view: &View, tile: PictureTile, distance: f64, holes: &[[u32; 2]], bounds: &Aabb) -> bool {
        (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y])).any(|[x, y]| {
            let ray = view.pixel_ray(x + tile.origin[0], y + tile.origin[1]);
            let begins = entry(&ray, bounds).map(|t| view.depth(ray.at(t)));
            begins.is_some_and(|depth| holes.contains(&[x, y]) || depth < distance)
        })
    }

    #[test]
    fn nothing_that_rays_see_is_hidden_and_what_is_far_behind_a_wall_is() {
        let mut state = 17_u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let corners = [[0, 0], [36, 0], [0, 21], [36, 21], [36, 10], [17, 21]];
        let (mut hidden, mut through_holes) = (0, 0);
        for (view, tile) in [(view(SIZE), PictureTile::whole(SIZE)), (view([74, 44]), TILE)] {
            for round in 0..6000 {
                let distance = 20.0 + 60.0 * next();
                // Every other time one of the outermost pixels; else any.
                let hole = match round % 3 {
                    0 => vec![corners[round / 3 % corners.len()]],
                    1 => vec![[(37.0 * next()) as u32, (22.0 * next()) as u32]],
                    _ => vec![],
                };
                let at = DVec2::new(f64::from(tile.origin[0]), f64::from(tile.origin[1]))
                    + DVec2::new(40.0 * next() - 1.5, 25.0 * next() - 1.5);
                let ray = view.ray(at);
                let begin = distance * (0.97 + 0.1 * next());
                let along = ray.direction.dot(view.basis.forward);
                let middle = ray.at(begin / along);
                let half = 0.02 + 2.0 * next();
                let bounds = Aabb { min: middle - half, max: middle + half };
                let cells = wall(&view, distance, &hole);
                let is_hidden = cells.hides(&view, tile, &bounds);
                let sees = is_seen(&view, tile, distance, &hole, &bounds);
                assert!(!(is_hidden && sees), "{bounds:?} behind {distance} m is seen, hole {hole:?}, {tile:?}");
                hidden += u32::from(is_hidden);
                through_holes += u32::from(sees && !hole.is_empty());
            }
        }
        assert!(hidden > 1500 && through_holes > 500, "{hidden} hidden, {through_holes} seen");
    }

    #[test]
    fn a_wall_hides_what_is_a_thousandth_behind_it_and_nothing_before_it() {
        let view = view(SIZE);
        let cells = wall(&view, 50.0, &[]);
        for (x, y) in [(1.0, 1.0), (18.0, 11.0), (35.9, 20.9)] {
            let ray = view.ray(DVec2::new(x, y));
            let along = ray.direction.dot(view.basis.forward);
            let at = |depth: f64| Aabb::from_points([ray.at(depth / along)]);
            assert!(cells.hides(&view, PictureTile::whole(SIZE), &at(50.2)), "{x} {y}");
            assert!(!cells.hides(&view, PictureTile::whole(SIZE), &at(49.99)), "{x} {y}");
        }
        // A hole in the last pixel of the last row and column.
        let cells = wall(&view, 50.0, &[[36, 21]]);
        let ray = view.pixel_ray(36, 21);
        assert!(!cells.hides(&view, PictureTile::whole(SIZE), &Aabb::from_points([ray.at(70.0)])));
    }
}
