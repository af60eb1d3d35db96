//! The bind group layouts that several passes share, and the layouts that were made so far.

use std::sync::{Arc, Mutex, PoisonError};

use rustc_hash::FxHashMap;
use wgpu::ShaderStages as S;

use crate::{
    gpu::Gpu,
    render::resource::bindings::{
        COMPARING, COMPUTED, DEPTHS, DRAWN, FLOATS, GroupLayout, LAYERED_FLOATS, LAYERED_NUMBERS, NUMBERS, SAMPLED,
        SAMPLER, STAGE, STORAGE, UNIFORM, WRITTEN_MASKS,
    },
};

/// Group 0 nearly everywhere: the view.
pub static VIEW: GroupLayout = GroupLayout { label: "view", entries: &[(0, DRAWN, UNIFORM)] };
/// Geometry and shadow, group 1: surfaces.
pub static CITY: GroupLayout = GroupLayout { label: "city", entries: &[(0, S::FRAGMENT, NUMBERS)] };
/// Geometry, group 3: textures of colours, of shares of own light, of normals, each with how it is sampled.
pub static IMAGES: GroupLayout = GroupLayout {
    label: "images",
    entries: &[
        (0, S::FRAGMENT, SAMPLED),
        (1, S::FRAGMENT, SAMPLER),
        (2, S::FRAGMENT, SAMPLED),
        (3, S::FRAGMENT, SAMPLER),
        (4, S::FRAGMENT, SAMPLED),
        (5, S::FRAGMENT, SAMPLER),
    ],
};
/// Geometry of triangles that hold their depth, group 4: indices, vertices, what each has besides.
pub static CORNERS: GroupLayout = GroupLayout {
    label: "corners",
    entries: &[(0, S::VERTEX, STORAGE), (1, S::VERTEX, STORAGE), (2, S::VERTEX, STORAGE)],
};
/// Sprites, group 1: planes of convex volumes, faces of solids.
pub static PLANES: GroupLayout =
    GroupLayout { label: "planes", entries: &[(1, COMPUTED, STORAGE), (2, COMPUTED, STORAGE)] };
/// Shade, group 1: surfaces, planes of convex volumes, faces of solids, light, targets, maps of light.
pub static SHADE: GroupLayout = GroupLayout {
    label: "shade",
    entries: &[
        (0, DRAWN, NUMBERS),
        (1, S::FRAGMENT, STORAGE),
        (2, S::FRAGMENT, STORAGE),
        (3, DRAWN, UNIFORM),
        (4, S::FRAGMENT, DEPTHS),
        (5, S::FRAGMENT, COMPARING),
        (6, S::FRAGMENT, NUMBERS),
        (7, S::FRAGMENT, DEPTHS),
        (8, S::FRAGMENT, FLOATS),
        (9, S::FRAGMENT, FLOATS),
        (10, S::FRAGMENT, DEPTHS),
        (11, S::FRAGMENT, FLOATS),
    ],
};
/// Shade, and geometry where something is hidden, group 2: sprites, object values, parameters, volumes, masks, invokers, filtered
/// images, shapes, lenses that bend rays.
pub static LENSES: GroupLayout = GroupLayout {
    label: "lenses",
    entries: &[
        (0, S::FRAGMENT, LAYERED_FLOATS),
        (1, DRAWN, STORAGE),
        (2, DRAWN, UNIFORM),
        (3, S::FRAGMENT, UNIFORM),
        (4, S::FRAGMENT, WRITTEN_MASKS),
        (5, S::FRAGMENT, UNIFORM),
        (6, S::FRAGMENT, LAYERED_NUMBERS),
        (7, DRAWN, UNIFORM),
        (8, S::FRAGMENT, STORAGE),
        (9, S::FRAGMENT, STORAGE),
        (10, S::FRAGMENT, STORAGE),
        (11, DRAWN, UNIFORM),
        (12, DRAWN, FLOATS),
    ],
};
/// Geometry and shadow where something is hidden, group 1: surfaces, planes of convex volumes, faces of solids; the city, for the
/// view and for the main eye, at dynamic offsets.
pub static CUT_CITY: GroupLayout = GroupLayout {
    label: "surfaces and planes",
    entries: &[
        (0, S::FRAGMENT, NUMBERS),
        (1, S::FRAGMENT, STORAGE),
        (2, S::FRAGMENT, STORAGE),
        (3, DRAWN, STAGE),
        (4, S::VERTEX, STAGE),
    ],
};

/// The layouts of a device, each made when first asked for.
#[derive(Clone, Debug)]
pub struct Layouts {
    device: wgpu::Device,
    made: Arc<Mutex<FxHashMap<GroupLayout, wgpu::BindGroupLayout>>>,
}

impl Layouts {
    /// None yet.
    pub fn new(gpu: &Gpu) -> Self {
        Self { device: gpu.device.clone(), made: Arc::default() }
    }

    /// The layout that plain data describe.
    pub fn of(&self, layout: &GroupLayout) -> wgpu::BindGroupLayout {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.entry(*layout).or_insert_with(|| self.make(layout)).clone()
    }

    fn make(&self, layout: &GroupLayout) -> wgpu::BindGroupLayout {
        let entries: Vec<_> = layout
            .entries
            .iter()
            .map(|&(binding, visibility, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
            .collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(layout.label), entries: &entries };
        self.device.create_bind_group_layout(&descriptor)
    }
}
