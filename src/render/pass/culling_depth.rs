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
    /// Of the target, pixels.
    size: [usize; 2],
    /// Farthest stored depth of every cell, row by row.
    cells: Vec<f32>,
    /// Farthest stored depth of the columns of one row of cells.
    columns: Vec<f32>,
}

impl CullingDepth {
    /// One for a depth target of this size.
    pub fn new(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let staging = gpu.empty_buffer("near depth", usage, u64::from(pitch(width)) * u64::from(height))?;
        Ok(Self { staging, size: [width as usize, height as usize], cells: Vec::new(), columns: Vec::new() })
    }

    /// Whether it fits a depth target.
    pub fn fits(&self, depth: &wgpu::Texture) -> bool {
        self.size == [depth.width() as usize, depth.height() as usize]
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
        let Self { staging, size: [width, height], cells, columns } = self;
        cells.clear();
        gpu.mapped(staging, |bytes| {
            let rows = bytes.chunks(pitch(*width as u32) as usize).take(*height);
            let rows: Vec<&[f32]> = rows.map(|row| &bytemuck::cast_slice(row)[..*width]).collect();
            for band in rows.chunks(CELL) {
                columns.clear();
                columns.resize(*width, f32::INFINITY);
                for row in band {
                    for (farthest, &depth) in columns.iter_mut().zip(*row) {
                        *farthest = if depth < *farthest { depth } else { *farthest };
                    }
                }
                cells.extend(columns.chunks(CELL).map(|c| c.iter().copied().fold(f32::INFINITY, f32::min)));
            }
        })
    }

    /// Whether nothing within the box can be seen in this part of a perspective picture: it lies beside the part, or behind
    /// what is near.
    pub fn hides(&self, view: &View, part: PictureTile, bounds: &Aabb) -> bool {
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
        let row = |y: usize| &self.cells[y * width.div_ceil(CELL)..][left..=right];
        (top..=bottom).all(|y| row(y).iter().all(|&farthest| farthest > stored))
    }
}

/// Bytes between the rows of the copy.
fn pitch(width: u32) -> u32 {
    (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
