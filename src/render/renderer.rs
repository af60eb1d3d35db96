//! The renderer: what lives on the graphics card between frames, and how it is kept up to date.
//!
//! It refuses to know files, commands and windows. Between two equal frames it allocates and uploads
//! nothing; [`Gpu::allocations`] and [`Gpu::uploads`] prove it.

use std::{path::Path, sync::Arc};

use crate::{
    city::CityModel,
    gpu::{Gpu, GpuError},
    render::{
        cells::Details,
        city::{CityBuffers, SectionKind, Shown},
        contents::Contents,
        curtain::Curtain,
        deformed::{Deformed, Met, Source},
        edges::{Edge, EdgeBuffers},
        furniture::FurnitureOnGpu,
        images::Images,
        layers::{LayerFigures, LayersOnGpu},
        layout,
        narrow::Narrowing,
        own_sprites::OwnSprites,
        pipelines::{Layouts, Pipelines},
        refinery::Refinery,
        regions::RegionsOnGpu,
        sections::SectionsOnGpu,
        solids::SolidTable,
        stored::KeptSprite,
        synced::{Room, Synced},
        targets::{Needs, Target, Targets},
        transparency::{MethodFigures, SlotsOnGpu},
    },
    shader::{Program, handlers},
};

/// Bytes between two dynamic offsets: what every adapter accepts.
pub(super) const STAGE_STRIDE: u64 = 256;
/// What to do where sprites are too large.
const COARSER: &str = "a smaller resolution, fewer layers or fewer bits (sprite of a lens) would be right";

/// A renderer on one device.
#[derive(Debug)]
pub struct Renderer {
    /// The device.
    pub gpu: Gpu,
    pub(super) pipelines: Pipelines,
    pub(super) city: Option<CityOnGpu>,
    pub(super) contents: Contents,
    pub(super) targets: Option<Targets>,
    pub(super) buffers: Buffers,
    pub(super) groups: Option<Groups>,
    pub(super) shadow_sampler: wgpu::Sampler,
    /// What the shadow map holds; drawn again when it should hold something else.
    pub(super) shadow_of: Option<Shadow>,
    /// Whether chunks that nearer ones hide are left out where that pays: on software adapters.
    pub culls_hidden: bool,
    /// Whether lists of many lenses are narrowed to what each tile shows.
    pub narrows_lists: bool,
    pub(super) narrowing: Option<Narrowing>,
    /// Whether the groups bind the narrowed lists.
    pub(super) binds_narrowed: bool,
    /// The effects that the frames since the last [`Renderer::begin_picture`] ran, ascending.
    pub(super) ran: Vec<u32>,
    /// The solids that the card holds.
    pub(super) solids_of: Option<Arc<SolidTable>>,
    /// The near depth of the last frame that culled by it.
    pub(super) curtain: Option<Curtain>,
    /// What deformations make of the city in this view.
    pub(super) deformed: Option<Deformed>,
    /// What they meet, whatever the view.
    pub(super) met: Option<Met>,
    /// What refines it.
    pub(super) refinery: Option<Refinery>,
    /// Cities that were put on the card so far.
    pub(super) city_number: u64,
    /// Of techniques that draw the city by regions, once there was one.
    pub(super) regions: Option<RegionsOnGpu>,
    pub(super) sections: Option<SectionsOnGpu>,
    /// Whether the scene asks for sections, in view or not.
    pub(super) has_sections: bool,
    /// Titles, captions and legends, once a picture had some.
    pub(super) furniture: Option<FurnitureOnGpu>,
    /// What of it is images.
    pub images: Images,
    /// The sprites that have eyes of their own.
    pub(super) own_sprites: OwnSprites,
    /// The stored sprites of the last frame.
    pub(super) kept_sprites: Vec<KeptSprite>,
    /// What passes that list crossings are drawn on, once there was one.
    pub(super) list_target: Option<wgpu::TextureView>,
    /// Whether the last frame listed crossings, and how many of them there is room for.
    pub(super) lists_crossings: bool,
    pub(super) crossing_room: u64,
    /// Lists of translucent layers, once there were some, and what the last frame had of them.
    pub(super) layers: Option<LayersOnGpu>,
    pub(super) layer_figures: LayerFigures,
    /// Slots of the nearest of them, once a method took some.
    pub(super) slots: Option<SlotsOnGpu>,
    /// What the method of the last frame took and left out.
    pub(super) method_figures: MethodFigures,
    /// The longest list that frames sort; 0: none is long.
    pub(super) longest_list: u32,
    /// How many notes of translucent layers have room at a time; `None`: as many as [`crate::render::layers::LAYER_BYTES`]
    /// hold. What does not fit is drawn in bands.
    pub most_layers: Option<u64>,
    /// The number of the only layer that the exact method tells ([`crate::render::composited`]), nearest first; `None`: all are laid.
    pub(super) picked_layer: Option<u32>,
    /// Triangles of translucent layers are drawn one by one, in an order shuffled by this number; `None`: as they lie in the city.
    /// The picture is the same.
    pub shuffled: Option<u32>,
    /// Counts cities, so that the shadow of an old one is not taken for the new one's.
    /// In which detail the view that is drawn shows the city.
    pub(super) details: Details,
}

/// The city's buffers and the groups that bind them.
#[derive(Debug)]
pub(super) struct CityOnGpu {
    pub buffers: CityBuffers,
    pub group: wgpu::BindGroup,
    /// Its edges, once something drew lines.
    pub edges: Option<EdgeBuffers>,
    /// One per section: its texture's group.
    pub images: Vec<Option<wgpu::BindGroup>>,
    /// One per section: its corners on the host, once something deformed it.
    pub sources: Option<Vec<Source>>,
    /// Its edges on the host, once something deformed them.
    pub edge_sources: Option<Vec<Edge>>,
}

/// Small buffers that follow the scene.
#[derive(Debug)]
pub(super) struct Buffers {
    pub view: Synced,
    pub sun_view: Synced,
    pub light: Synced,
    pub planes: Synced,
    /// Solids: their columns and faces, and the corners of their faces to draw.
    pub solids: Synced,
    pub solid_corners: Synced,
    pub sprite_stages: Synced,
    /// The sprites of lenses, and what makes them.
    pub sprites: Room,
    pub stored_stages: Synced,
    /// Lists of crossings that layered sprites are made from, the crossings, and how many there are; then the rays of each
    /// sprite that have more intervals than layers.
    pub lists: Room,
    pub crossings: Room,
    pub counts: Room,
    pub sprite_places: Synced,
    pub lens_shapes: Synced,
    pub parameters: Synced,
    pub invoker_table: Synced,
    pub invokers: Synced,
    pub tile_lists: Synced,
    pub filter_stages: Synced,
    pub object_values: Synced,
    /// For the sun, where something is hidden: the main view, shapes of lens volumes, their planes, invokers.
    pub eye: Synced,
    pub shapes: Synced,
    pub shape_planes: Synced,
    pub shape_invoker_table: Synced,
    pub shape_invokers: Synced,
    pub line_stages: Synced,
    /// The scene's own city and contents, for the main view and for the sun.
    pub cities: Synced,
    pub sun_cities: Synced,
    pub resolve: Synced,
    /// Triangles over parts of the picture.
    pub mesh: Synced,
}

impl Buffers {
    /// Empty ones.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        let uniform = |label| Synced::new(gpu, label, U::UNIFORM);
        let storage = |label| Synced::new(gpu, label, U::STORAGE);
        Ok(Self {
            view: uniform("view")?,
            sun_view: uniform("sun's view")?,
            light: uniform("light")?,
            planes: storage("lens planes")?,
            solids: storage("solids of lenses")?,
            solid_corners: Synced::new(gpu, "corners of solids", U::VERTEX)?,
            sprite_stages: uniform("sprite stages")?,
            sprites: Room::new(gpu, "depth sprites of lenses", U::STORAGE | U::COPY_SRC | U::COPY_DST, COARSER)?,
            stored_stages: uniform("stages of stored sprites")?,
            lists: Room::new(gpu, "lists of crossings", U::STORAGE | U::COPY_DST, COARSER)?,
            crossings: Room::new(gpu, "crossings", U::STORAGE, COARSER)?,
            counts: Room::new(gpu, "counts of sprites", U::STORAGE | U::COPY_DST | U::COPY_SRC, COARSER)?,
            sprite_places: uniform("places of depth sprites")?,
            lens_shapes: uniform("lens shapes")?,
            parameters: uniform("parameters")?,
            invoker_table: uniform("invoker table")?,
            invokers: storage("invokers")?,
            tile_lists: storage("invokers of tiles")?,
            filter_stages: uniform("filter stages")?,
            object_values: storage("object values")?,
            eye: uniform("main view for the sun")?,
            shapes: storage("lens shapes for the sun")?,
            shape_planes: storage("lens planes for the sun")?,
            line_stages: uniform("line stages")?,
            cities: uniform("cities")?,
            sun_cities: uniform("cities for the sun")?,
            shape_invoker_table: uniform("invoker table for the sun")?,
            shape_invokers: storage("invokers for the sun")?,
            resolve: uniform("resolve")?,
            mesh: Synced::new(gpu, "parts of the picture", U::VERTEX)?,
        })
    }
}

/// What a shadow map shows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shadow {
    /// The sun's view.
    pub view: layout::View,
    /// What is hidden from it, and all numbers that this depends on.
    pub cut: Option<(Program, Vec<u8>)>,
    /// Where contents stand.
    pub cities: Vec<u8>,
    /// In which detail the city throws it.
    pub details: Details,
}

/// Bind groups over buffers and targets; made anew when one of them was replaced.
#[derive(Debug)]
pub(super) struct Groups {
    pub view: wgpu::BindGroup,
    pub sun_view: wgpu::BindGroup,
    pub planes: wgpu::BindGroup,
    pub sprite_stage: wgpu::BindGroup,
    pub stored: wgpu::BindGroup,
    pub shade: wgpu::BindGroup,
    pub lenses: wgpu::BindGroup,
    /// Where something is hidden: from the picture, and from the sun.
    pub cut_city: wgpu::BindGroup,
    pub shapes_city: wgpu::BindGroup,
    pub shapes: wgpu::BindGroup,
    /// The layer of lines, and where there are some the stage of one draw.
    pub lines: wgpu::BindGroup,
    pub line_stage: Option<wgpu::BindGroup>,
    /// Down, and across; where the frame has filters.
    pub filters: Option<[wgpu::BindGroup; 2]>,
    pub resolve: wgpu::BindGroup,
}

impl Renderer {
    /// A renderer without a city.
    pub fn new(gpu: Gpu) -> Result<Self, GpuError> {
        let buffers = Buffers::new(&gpu)?;
        let shadow_sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        Ok(Self {
            pipelines: Pipelines::new(&gpu),
            city: None,
            contents: Contents::default(),
            targets: None,
            buffers,
            groups: None,
            shadow_sampler,
            shadow_of: None,
            culls_hidden: gpu.is_software(),
            narrows_lists: true,
            narrowing: None,
            binds_narrowed: false,
            curtain: None,
            deformed: None,
            met: None,
            refinery: None,
            city_number: 0,
            regions: None,
            sections: None,
            has_sections: false,
            furniture: None,
            images: Images::new(&gpu),
            ran: Vec::new(),
            solids_of: None,
            own_sprites: OwnSprites::default(),
            layers: None,
            slots: None,
            method_figures: MethodFigures::default(),
            layer_figures: LayerFigures::default(),
            longest_list: 0,
            most_layers: None,
            picked_layer: None,
            shuffled: None,
            kept_sprites: Vec::new(),
            list_target: None,
            lists_crossings: false,
            crossing_room: 0,
            details: Details::default(),
            gpu,
        })
    }

    /// Puts a city on the card in place of the last one.
    pub fn set_city(&mut self, shown: &Shown, blocks: Option<&CityModel>) -> Result<(), GpuError> {
        self.city = None;
        (self.deformed, self.met) = (None, None);
        self.city_number += 1;
        (self.layers, self.longest_list) = (None, 0);
        self.slots = None;
        self.contents = Contents::default();
        self.city = Some(self.city_on_gpu(shown, blocks)?);
        self.groups = None;
        self.shadow_of = None;
        Ok(())
    }

    /// The buffers of a city, and what binds them.
    pub(super) fn city_on_gpu(&self, shown: &Shown, blocks: Option<&CityModel>) -> Result<CityOnGpu, GpuError> {
        let gpu = &self.gpu;
        let buffers = CityBuffers::new(gpu, shown, blocks)?;
        let surfaces = wgpu::BindingResource::TextureView(&buffers.surfaces);
        let group = group(gpu, "city", &self.pipelines.layouts.city, &[(0, surfaces)]);
        let images = buffers.sections.iter().map(|section| self.image_of(&buffers, section.kind)).collect();
        Ok(CityOnGpu { group, images, buffers, edges: None, sources: None, edge_sources: None })
    }

    /// What binds the texture of a section.
    pub(super) fn image_of(&self, buffers: &CityBuffers, kind: SectionKind) -> Option<wgpu::BindGroup> {
        let SectionKind::Textured { texture, .. } = kind else { return None };
        let (view, sampler) = buffers.textures.get(texture)?;
        let entries = [(0, wgpu::BindingResource::TextureView(view)), (1, wgpu::BindingResource::Sampler(sampler))];
        Some(group(&self.gpu, "image", &self.pipelines.layouts.image, &entries))
    }

    /// The city's buffers.
    pub fn city(&self) -> Option<&CityBuffers> {
        self.city.as_ref().map(|c| &c.buffers)
    }

    /// Gives back the targets and the lists of translucent layers; the next frame makes its own. City and pipelines stay.
    pub fn drop_targets(&mut self) {
        (self.targets, self.groups, self.layers, self.slots) = (None, None, None, None);
    }

    /// The targets of the last frame.
    pub fn targets(&self) -> Option<&Targets> {
        self.targets.as_ref()
    }

    /// Starts counting pipelines anew.
    pub fn begin_picture(&mut self) {
        self.pipelines.begin_picture();
        self.ran.clear();
    }

    /// Names of the effects that ran since then, each once.
    pub fn handlers(&self) -> Vec<String> {
        self.ran.iter().map(|&e| handlers()[e as usize].name.clone()).collect()
    }

    /// The AOV's number of what has this code in the geometry target: object index + 1, 0 = nothing.
    pub(super) fn object_id(&self, code: u32) -> u32 {
        // The plain ground is no object: its NO_OBJECT wraps to 0.
        code.checked_sub(1).and_then(|number| self.surface(number)).map_or(0, |s| s.object.wrapping_add(1))
    }

    /// Keeps the image of a file ([`Images::of_file`]).
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn image_of_file(&mut self, number: u64, file: &Path, size: Option<[u32; 2]>) -> Result<bool, String> {
        self.images.of_file(&self.gpu, number, file, size)
    }

    /// All pipelines are made anew: a user's effect is another now ([`crate::shader::effect::replace`]).
    pub fn forget_shaders(&mut self) {
        self.pipelines.forget();
        self.ran.clear();
    }

    /// The pipelines.
    pub fn pipelines(&self) -> &Pipelines {
        &self.pipelines
    }

    /// Makes the targets fit; what is there is kept where it does.
    pub(super) fn fit_targets(&mut self, needs: Needs) -> Result<(), GpuError> {
        if self.targets.as_ref().is_some_and(|t| t.serve(&needs)) {
            return Ok(());
        }
        self.groups = None;
        let before = self.targets.take();
        let shadow = before.as_ref().map(|t| t.shadow.texture.clone());
        let targets = Targets::new(&self.gpu, needs, self.pipelines.layouts.sums, before);
        if shadow.is_none_or(|shadow| shadow != targets.shadow.texture) {
            self.shadow_of = None;
        }
        self.targets = Some(targets);
        Ok(())
    }

    /// Makes the bind groups if something they bind was replaced.
    pub(super) fn fit_groups(&mut self) {
        if self.groups.is_some() {
            return;
        }
        let (Some(targets), Some(city)) = (&self.targets, &self.city) else { return };
        let (gpu, p, b): (_, &Layouts, _) = (&self.gpu, &self.pipelines.layouts, &self.buffers);
        let lists = match &self.narrowing {
            Some(narrowing) if self.binds_narrowed => &narrowing.lists,
            _ => b.tile_lists.buffer(),
        };
        let stage_group =
            |label, buffer: &Synced, size: usize| group(gpu, label, &p.stage, &[(0, stage_of(buffer, size))]);
        let surfaces = || {
            let all = self.contents.surfaces.as_ref().unwrap_or(&city.buffers.surfaces);
            wgpu::BindingResource::TextureView(all)
        };
        let cut_city = |planes: &Synced, cities: &Synced| {
            let entries = [
                (0, surfaces()),
                (1, whole(planes.buffer())),
                (2, whole(b.solids.buffer())),
                (3, one_of::<layout::City>(cities)),
                (4, one_of::<layout::City>(&b.cities)),
            ];
            group(gpu, "surfaces and planes", &p.cut_city, &entries)
        };
        self.groups = Some(Groups {
            view: group(gpu, "view", &p.view, &[(0, whole(b.view.buffer()))]),
            sun_view: group(gpu, "sun's view", &p.view, &[(0, whole(b.sun_view.buffer()))]),
            planes: group(gpu, "planes", &p.planes, &[(1, whole(b.planes.buffer())), (2, whole(b.solids.buffer()))]),
            sprite_stage: stage_group("sprite stage", &b.sprite_stages, size_of::<layout::SpriteStage>()),
            stored: group(
                gpu,
                "stored sprites",
                &p.stored,
                &[
                    (0, stage_of(&b.stored_stages, size_of::<layout::StoredStage>())),
                    (1, whole(b.sprites.buffer())),
                    (2, whole(b.lists.buffer())),
                    (3, whole(b.crossings.buffer())),
                    (4, whole(b.counts.buffer())),
                ],
            ),
            shade: group(
                gpu,
                "shade",
                &p.shade,
                &[
                    (0, surfaces()),
                    (1, whole(b.planes.buffer())),
                    (2, whole(b.solids.buffer())),
                    (3, whole(b.light.buffer())),
                    (4, all_of(&targets.shadow)),
                    (5, wgpu::BindingResource::Sampler(&self.shadow_sampler)),
                    (6, all_of(&targets.codes)),
                    (7, all_of(&targets.depth)),
                    (8, all_of(&targets.colors)),
                ],
            ),
            lenses: group(
                gpu,
                "lenses",
                &p.lenses,
                &[
                    (0, all_of(&targets.sprites)),
                    (1, whole(b.object_values.buffer())),
                    (2, whole(b.parameters.buffer())),
                    (3, whole(b.sprite_places.buffer())),
                    (4, all_of(&targets.masks)),
                    (5, whole(b.invoker_table.buffer())),
                    (6, all_of(&targets.filtered)),
                    (7, whole(b.lens_shapes.buffer())),
                    (8, whole(lists)),
                    (9, whole(b.invokers.buffer())),
                    (10, whole(b.sprites.buffer())),
                ],
            ),
            lines: group(gpu, "lines and layers", &p.lines, &[(0, all_of(&targets.lines)), (1, all_of(&targets.veil))]),
            line_stage: targets.needs.lines.then(|| {
                let entries =
                    [(0, one_of::<layout::LineStage>(&b.line_stages)), (1, one_of::<layout::City>(&b.cities))];
                group(gpu, "line stage", &p.line_stage, &entries)
            }),
            cut_city: cut_city(&b.planes, &b.cities),
            shapes_city: cut_city(&b.shape_planes, &b.sun_cities),
            shapes: group(
                gpu,
                "shapes",
                &p.shapes,
                &[
                    (1, whole(b.object_values.buffer())),
                    (2, whole(b.parameters.buffer())),
                    (5, whole(b.shape_invoker_table.buffer())),
                    (7, whole(b.eye.buffer())),
                    (8, whole(b.shapes.buffer())),
                    (9, whole(b.shape_invokers.buffer())),
                    (10, whole(b.sprites.buffer())),
                ],
            ),
            filters: (targets.needs.filters > 0).then(|| {
                [&targets.unfiltered, &targets.half_filtered].map(|image| {
                    let stage = wgpu::BufferBinding {
                        buffer: b.filter_stages.buffer(),
                        offset: 0,
                        size: wgpu::BufferSize::new(size_of::<layout::FilterStage>() as u64),
                    };
                    let entries = [
                        (0, wgpu::BindingResource::Buffer(stage)),
                        (1, all_of(image)),
                        (2, whole(b.parameters.buffer())),
                    ];
                    group(gpu, "filter", &p.filter, &entries)
                })
            }),
            resolve: group(gpu, "resolve", &p.resolve, &[(0, whole(b.resolve.buffer())), (1, all_of(&targets.sums))]),
        });
    }
}

/// A uniform of this size at a dynamic offset.
fn stage_of(buffer: &Synced, size: usize) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(size as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: buffer.buffer(), offset: 0, size })
}

pub(super) fn all_of(target: &Target) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&target.view)
}

/// One of several in a uniform buffer, at a dynamic offset.
pub(super) fn one_of<T>(buffer: &Synced) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(size_of::<T>() as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: buffer.buffer(), offset: 0, size })
}

pub(super) fn whole(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    buffer.as_entire_binding()
}

pub(super) fn group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    entries: &[(u32, wgpu::BindingResource)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = entries
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
