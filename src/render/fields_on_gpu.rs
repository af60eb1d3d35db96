//! Fields on the GPU: their values one behind the other in one texture, their bricks in another, and their numbers.

use std::sync::Arc;

use crate::{
    field::Values,
    gpu::{Gpu, GpuError},
    render::{
        fields::{PlacedField, PlacedFields},
        resource::synced::Synced,
    },
    scene::volume::MOST_VOLUMES,
    view::View,
};

/// As `lib/fields.wgsl` has it: texels below are no values.
const MISSING: f32 = -1e38;
/// Of the textures, for messages.
const VALUES: &str = "what volumes hold";
const BRICKS: &str = "where volumes are seen";
/// What to do where the GPU has no such texture.
const ADVICE: &str = "smaller volumes, or fewer in one picture, would be right";

/// What shaders read of fields.
#[derive(Debug)]
pub(super) struct FieldsOnGpu {
    values: wgpu::Texture,
    bricks: wgpu::Texture,
    pub values_view: wgpu::TextureView,
    pub bricks_view: wgpu::TextureView,
    pub table: Synced,
    /// What the textures hold, and where each begins in them.
    held: Vec<Arc<PlacedField>>,
    firsts: Vec<[u32; 2]>,
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// The smallest box that holds boxes one behind the other, and where each begins.
fn stacked(sizes: impl Iterator<Item = [usize; 3]>) -> ([u32; 3], Vec<u32>) {
    let (mut all, mut firsts) = ([1, 1, 0], Vec::new());
    for [width, height, depth] in sizes.map(|size| size.map(|n| n as u32)) {
        firsts.push(all[2]);
        all = [all[0].max(width), all[1].max(height), all[2] + depth];
    }
    ([all[0], all[1], all[2].max(1)], firsts)
}

impl FieldsOnGpu {
    /// None.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let values = gpu.texture_3d(VALUES, [1, 1, 1], wgpu::TextureFormat::R32Float, ADVICE)?;
        let bricks = gpu.texture_3d(BRICKS, [1, 1, 1], wgpu::TextureFormat::R8Uint, ADVICE)?;
        Ok(Self {
            values_view: view_of(&values),
            bricks_view: view_of(&bricks),
            values,
            bricks,
            table: Synced::new(gpu, "fields", wgpu::BufferUsages::UNIFORM)?,
            held: Vec::new(),
            firsts: Vec::new(),
        })
    }

    /// Makes it hold these; `true`: something that bind groups hold is another now.
    ///
    /// # Errors
    /// Those of the GPU; that it has no such textures.
    pub fn fit(&mut self, gpu: &Gpu, fields: &PlacedFields, view: &View, jittered: bool) -> Result<bool, GpuError> {
        if fields.is_empty() {
            return Ok(false);
        }
        let placed = &fields.all[..fields.all.len().min(MOST_VOLUMES)];
        let has_all = |is: &dyn Fn(&Arc<PlacedField>, &Arc<PlacedField>) -> bool| {
            self.held.len() == placed.len() && self.held.iter().zip(placed).all(|(held, field)| is(held, field))
        };
        let has_values = has_all(&|held, field| Arc::ptr_eq(&held.data, &field.data));
        let has_seen = has_values && has_all(&|held, field| Arc::ptr_eq(held, field) || held.seen == field.seen);
        if !has_values {
            self.put_values(gpu, placed)?;
        }
        if !has_seen {
            for (field, [_, first]) in placed.iter().zip(&self.firsts) {
                gpu.write_texture_box(&self.bricks, *first, field.data.bricks.map(|n| n as u32), &field.seen);
            }
        }
        self.held = placed.to_vec();
        let is_new = self.table.sync(gpu, &[fields.uniform(view, &self.firsts, self.texels(), jittered)])?;
        Ok(is_new || !has_values)
    }

    /// From texels to values: times the first, plus the second.
    fn texels(&self) -> [f64; 2] {
        let is_bytes = self.values.format() == wgpu::TextureFormat::R8Unorm;
        [if is_bytes { 255.0 } else { 1.0 }, 0.0]
    }

    fn put_values(&mut self, gpu: &Gpu, placed: &[Arc<PlacedField>]) -> Result<(), GpuError> {
        let data = || placed.iter().map(|field| &*field.data);
        let (size, firsts) = stacked(data().map(|own| own.size));
        let (brick_size, first_bricks) = stacked(data().map(|own| own.bricks));
        let format = match data().all(|own| matches!(own.values, Values::U8(_))) {
            true => wgpu::TextureFormat::R8Unorm,
            false => wgpu::TextureFormat::R32Float,
        };
        // Until all is there it holds nothing.
        self.held.clear();
        self.values = gpu.texture_3d(VALUES, size, format, ADVICE)?;
        self.bricks = gpu.texture_3d(BRICKS, brick_size, wgpu::TextureFormat::R8Uint, ADVICE)?;
        (self.values_view, self.bricks_view) = (view_of(&self.values), view_of(&self.bricks));
        for (own, first) in data().zip(&firsts) {
            let size = own.size.map(|n| n as u32);
            match &own.values {
                Values::U8(values) if format == wgpu::TextureFormat::R8Unorm => {
                    gpu.write_texture_box(&self.values, *first, size, values);
                }
                values => {
                    let known = |value: f32| if value.is_finite() { value } else { MISSING };
                    let texels: Vec<f32> = (0..values.len()).map(|i| known(values.get(i))).collect();
                    gpu.write_texture_box(&self.values, *first, size, bytemuck::cast_slice(&texels));
                }
            }
        }
        self.firsts = firsts.into_iter().zip(first_bricks).map(|(a, b)| [a, b]).collect();
        Ok(())
    }
}
