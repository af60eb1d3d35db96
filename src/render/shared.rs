//! Buffers that several passes of a view read, and what binds them.

use std::{borrow::Cow, sync::Arc};

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        bent,
        cities::Cities,
        eye::PictureTile,
        fields_on_gpu::FieldsOnGpu,
        invokers::Invokers,
        layout,
        light::{self, Surround},
        plan::FramePlan,
        ray_fields::RayFields,
        resource::{
            bindings::{all_of, group, one_of, whole},
            layouts::{CUT_CITY, LENSES, PLANES, SHADE, VIEW},
            pipelines::Pipelines,
            synced::{Room, Synced},
            targets::Targets,
        },
        silhouettes::Rays,
        solids::SolidTable,
        volume::LensVolume,
    },
    shader::{MOST_SLOTS, MOST_VOLUMES},
};

/// What to do where sprites are too large.
pub(super) const COARSER: &str = "a smaller resolution, fewer layers or fewer bits (sprite of a lens) would be right";

/// Small buffers that follow the scene, and the sprites of lenses.
#[derive(Debug)]
pub(super) struct Shared {
    pub view: Synced,
    pub light: Synced,
    pub planes: Synced,
    /// Solids: their columns and faces, and the corners of their faces to draw.
    pub solids: Synced,
    pub solid_corners: Synced,
    /// The sprites of lenses.
    pub sprites: Room,
    pub sprite_places: Synced,
    pub lens_regions: Synced,
    pub parameters: Synced,
    pub invoker_table: Synced,
    pub invokers: Synced,
    pub tile_lists: Synced,
    pub object_values: Synced,
    /// The lenses that bend rays, and what some of them have in place of an outline.
    pub ray_lenses: Synced,
    pub ray_fields: RayFields,
    /// What stands in the city of fields.
    pub fields: FieldsOnGpu,
    /// The scene's own city and contents, for the main view.
    pub cities: Synced,
    /// How many samples there are.
    pub samples: Synced,
    /// Triangles over parts of the picture.
    pub mesh: Synced,
    /// The narrowed lists, where they are bound in place of those of tiles.
    narrowed: Option<wgpu::Buffer>,
    pub shadow_sampler: wgpu::Sampler,
    /// How often something that bind groups hold was replaced.
    pub stamp: u64,
    /// How often what may cast shadows became another.
    pub world: u64,
    solids_of: Option<Arc<SolidTable>>,
    groups: Option<(u64, SharedGroups)>,
}

/// Bind groups that several passes set.
#[derive(Debug)]
pub(super) struct SharedGroups {
    pub view: wgpu::BindGroup,
    pub planes: wgpu::BindGroup,
    pub shade: wgpu::BindGroup,
    pub lenses: wgpu::BindGroup,
    /// Where something is hidden in the picture.
    pub cut_city: wgpu::BindGroup,
}

impl Shared {
    /// Empty ones.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        let uniform = |label| Synced::new(gpu, label, U::UNIFORM);
        let storage = |label| Synced::new(gpu, label, U::STORAGE);
        let shadow_sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        Ok(Self {
            view: uniform("view")?,
            light: uniform("light")?,
            planes: storage("lens planes")?,
            solids: storage("solids of lenses")?,
            solid_corners: Synced::new(gpu, "corners of solids", U::VERTEX)?,
            sprites: Room::new(gpu, "depth sprites of lenses", U::STORAGE | U::COPY_SRC | U::COPY_DST, COARSER)?,
            sprite_places: uniform("places of depth sprites")?,
            lens_regions: uniform("lens shapes")?,
            parameters: uniform("parameters")?,
            invoker_table: uniform("invoker table")?,
            invokers: storage("invokers")?,
            tile_lists: storage("invokers of tiles")?,
            object_values: storage("object values")?,
            ray_lenses: uniform("lenses that bend rays")?,
            ray_fields: RayFields::new(gpu),
            fields: FieldsOnGpu::new(gpu)?,
            cities: uniform("cities")?,
            samples: uniform("resolve")?,
            mesh: Synced::new(gpu, "parts of the picture", U::VERTEX)?,
            narrowed: None,
            shadow_sampler,
            stamp: 0,
            world: 0,
            solids_of: None,
            groups: None,
        })
    }

    /// Makes room for the sprites of a frame, and puts those of files there.
    pub fn fit_sprites(&mut self, gpu: &Gpu, plan: &FramePlan) -> Result<(), GpuError> {
        self.stamp += u64::from(self.sprites.fit(gpu, plan.sprite_bytes)?);
        for (first, words) in &plan.file_words {
            gpu.write_from(self.sprites.buffer(), 4 * u64::from(*first), words);
        }
        Ok(())
    }

    /// Brings the buffers up to date; with the invoker table where programs are the uber back end's.
    pub fn upload(&mut self, gpu: &Gpu, plan: &FramePlan, cities: &Cities, is_uber: bool) -> Result<(), GpuError> {
        let (input, plans, numbers) = (plan.input, &plan.plans, &plan.numbers);
        let mut stale = false;
        if is_uber {
            let invokers: &Invokers = plans.invokers();
            stale |= self.invoker_table.sync(gpu, &invokers.table(input.tile.size))?;
            stale |= self.invokers.sync(gpu, invokers.all())?;
            let margin = input.volumes.iter().map(LensVolume::line_margin_px).max().unwrap_or_default();
            let rays = |PictureTile { origin: [x, y], size }: PictureTile| {
                let [left, top] = input.tile.origin;
                let tile = PictureTile { origin: [left + x, top + y], size };
                Rays::of(&input.view, tile, margin.into())
            };
            let lists = invokers.tile_lists(&plans.parts, input.tile.size, &plans.silhouettes, rays);
            stale |= self.tile_lists.sync(gpu, &lists)?;
        }
        let eye = input.view.camera.eye;
        let maps = [plan.sun.as_ref(), plan.sky.as_ref()];
        stale |= self.view.sync(gpu, &[plan.view_uniform()])?;
        let around = Surround { look: input.look, background: input.background, fade: plan.fade };
        stale |= self.light.sync(gpu, &[light::uniform(&input.sun, &plan.light, &around, maps, eye, plan.radius)])?;
        if self.solids_of.as_ref().is_none_or(|before| !Arc::ptr_eq(before, input.solids)) {
            stale |= self.solids.sync(gpu, &input.solids.words)?;
            self.solid_corners.sync(gpu, &input.solids.corners)?;
            self.solids_of = Some(input.solids.clone());
            self.world += 1;
        }
        stale |= self.cities.sync(gpu, &cities.uniforms(eye, input.operations))?;
        stale |= self.planes.sync(gpu, &numbers.planes)?;
        stale |= self.sprite_places.sync(gpu, &of_volumes(&numbers.places, is_uber))?;
        stale |= self.lens_regions.sync(gpu, &of_volumes(&numbers.regions, is_uber))?;
        stale |= self.parameters.sync(gpu, &parameters(plan, is_uber))?;
        stale |= self.object_values.sync(gpu, &input.operations.object_values)?;
        stale |= self.ray_lenses.sync(gpu, &[bent::uniform(input.rays)])?;
        stale |= self.ray_fields.fit(gpu, &bent::fields(input.rays));
        stale |= self.fields.fit(gpu, input.fields, &input.view, input.is_summed())?;
        stale |= self.samples.sync(gpu, &[input.samples as f32])?;
        self.mesh.sync(gpu, &plan.parts.mesh.corners)?;
        self.stamp += u64::from(stale);
        Ok(())
    }

    /// Binds narrowed lists in place of those of tiles.
    pub fn bind_narrowed(&mut self, lists: &wgpu::Buffer) {
        if self.narrowed.as_ref() != Some(lists) {
            self.narrowed = Some(lists.clone());
            self.stamp += 1;
        }
    }

    /// Binds the lists of tiles again.
    pub fn bind_tile_lists(&mut self) {
        self.stamp += u64::from(self.narrowed.take().is_some());
    }

    /// Makes the bind groups anew if something that they hold was replaced.
    pub fn fit_groups(&mut self, gpu: &Gpu, pipelines: &Pipelines, cities: &Cities, targets: &Targets) {
        if self.groups.as_ref().is_none_or(|(of, _)| *of != self.stamp) {
            self.groups = Some((self.stamp, self.made_groups(gpu, pipelines, cities, targets)));
        }
    }

    /// The bind groups of the last frame.
    pub fn groups(&self) -> Option<&SharedGroups> {
        self.groups.as_ref().map(|(_, groups)| groups)
    }

    fn made_groups(&self, gpu: &Gpu, pipelines: &Pipelines, cities: &Cities, targets: &Targets) -> SharedGroups {
        let made = |layout: &_, entries: &[(u32, wgpu::BindingResource)]| {
            let layout: &crate::render::resource::bindings::GroupLayout = layout;
            group(gpu, layout.label, &pipelines.layout(layout), entries)
        };
        SharedGroups {
            view: made(&VIEW, &[(0, whole(self.view.buffer()))]),
            planes: made(&PLANES, &[(1, whole(self.planes.buffer())), (2, whole(self.solids.buffer()))]),
            shade: made(&SHADE, &self.shading(cities, targets, ShadedTargets::of(targets))),
            lenses: made(&LENSES, &self.lenses(targets, &self.sprite_places, &self.lens_regions)),
            cut_city: made(&CUT_CITY, &self.cut_city(cities, &self.planes)),
        }
    }

    /// What tells of lenses, where these places of sprites and shapes are told.
    pub fn lenses<'a>(
        &'a self,
        targets: &'a Targets,
        places: &'a Synced,
        regions: &'a Synced,
    ) -> [(u32, wgpu::BindingResource<'a>); 13] {
        [
            (0, all_of(&targets.sprites)),
            (1, whole(self.object_values.buffer())),
            (2, whole(self.parameters.buffer())),
            (3, whole(places.buffer())),
            (4, all_of(&targets.masks)),
            (5, whole(self.invoker_table.buffer())),
            (6, all_of(&targets.filtered)),
            (7, whole(regions.buffer())),
            (8, whole(self.narrowed.as_ref().unwrap_or(self.tile_lists.buffer()))),
            (9, whole(self.invokers.buffer())),
            (10, whole(self.sprites.buffer())),
            (11, whole(self.ray_lenses.buffer())),
            (12, wgpu::BindingResource::TextureView(&self.ray_fields.view)),
        ]
    }

    /// What tells of a city where something is hidden, by these planes.
    pub fn cut_city<'a>(&'a self, cities: &Cities<'a>, planes: &'a Synced) -> [(u32, wgpu::BindingResource<'a>); 5] {
        [
            (0, wgpu::BindingResource::TextureView(cities.surfaces())),
            (1, whole(planes.buffer())),
            (2, whole(self.solids.buffer())),
            (3, one_of::<layout::City>(&self.cities)),
            (4, one_of::<layout::City>(&self.cities)),
        ]
    }

    /// What shading binds.
    pub fn shading<'a>(
        &'a self,
        cities: &Cities<'a>,
        targets: &'a Targets,
        read: ShadedTargets<'a>,
    ) -> [(u32, wgpu::BindingResource<'a>); 12] {
        [
            (0, wgpu::BindingResource::TextureView(cities.surfaces())),
            (1, whole(self.planes.buffer())),
            (2, whole(self.solids.buffer())),
            (3, whole(self.light.buffer())),
            (4, all_of(&targets.shadow)),
            (5, wgpu::BindingResource::Sampler(&self.shadow_sampler)),
            (6, wgpu::BindingResource::TextureView(read.codes)),
            (7, wgpu::BindingResource::TextureView(read.depth)),
            (8, wgpu::BindingResource::TextureView(read.colors)),
            (9, wgpu::BindingResource::TextureView(read.emissions)),
            (10, all_of(&targets.sky)),
            (11, all_of(&targets.occlusion)),
        ]
    }
}

/// What shading reads of what the geometry passes leave.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadedTargets<'a> {
    pub codes: &'a wgpu::TextureView,
    pub depth: &'a wgpu::TextureView,
    pub colors: &'a wgpu::TextureView,
    pub emissions: &'a wgpu::TextureView,
}

impl<'a> ShadedTargets<'a> {
    fn of(targets: &'a Targets) -> Self {
        let Targets { codes, depth, colors, emissions, .. } = targets;
        Self { codes: &codes.view, depth: &depth.view, colors: &colors.view, emissions: &emissions.view }
    }
}

/// What shaders are told of each volume; the uber back end's modules declare it as long as it may be.
pub(super) fn of_volumes<T: bytemuck::Pod>(each: &[T], is_uber: bool) -> Cow<'_, [T]> {
    let mut each = Cow::Borrowed(each);
    if is_uber {
        each.to_mut().resize(MOST_VOLUMES as usize, T::zeroed());
    }
    each
}

/// The parameters of effects, and of each use of a filter which image is its.
fn parameters<'a>(plan: &FramePlan<'a>, is_uber: bool) -> Cow<'a, [[f32; 4]]> {
    let mut parameters = Cow::Borrowed(&plan.input.operations.parameters[..]);
    if is_uber || !plan.plans.filters.is_empty() {
        // Their modules declare this array as long as it may be.
        parameters.to_mut().resize(MOST_SLOTS as usize, [0.0; 4]);
    }
    for (filter, (_, slot)) in plan.plans.uses() {
        parameters.to_mut()[slot as usize][0] = (4 * plan.input.behind().images() * filter) as f32;
    }
    parameters
}
