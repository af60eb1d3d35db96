//! One sample of one view: the frame as a readable list of passes.
//!
//! ```text
//! stored depth sprites          of the lens volumes in view that are tested by them, and those that have eyes of their own
//!                               and are not there yet
//! shadow map                    if the sun casts shadows and the map does not hold this view yet
//! depth sprites                 of the solids in view whose sides are asked for
//! geometry                      everything once; on a software adapter what is near, and then
//! geometry beyond               what that does not hide, where it hides much
//! layers, composite             what is translucent, listed by pixel, sorted and laid one over the other
//! narrow lists                  of many lenses, those that each tile shows something of
//! lines                         edges, where effects draw them
//! unfiltered, filter down,      for each neighbourhood filter in view: its lens' own image over the lens' bounds
//! filter across                 and what the filter reaches beyond them, and the filter
//! shade                         outside of where lenses may be seen without them, inside with them
//! shown layers                  where AOVs are asked for
//! resolve                       the mean of the samples, after the last of several
//! furniture                     title, caption, legends: over the last sample
//! ```
//!
//! A pass that the scene does not call for is not in the list (U3). Techniques that are kept for reference have others for the
//! geometry and shading (`render::regions`).

use std::{ops::Range, sync::Arc};

use glam::DVec2;

use crate::{
    geom::Aabb,
    gpu::{GpuError, Slot, Timer},
    render::{
        cells::{Detail, Details},
        city::{CityBuffers, Section, SectionKind, draws_of},
        city_passes::draw_ranges,
        cut::Cuts,
        deformations::Moved,
        eye::{PictureTile, view_uniform},
        filters,
        frame_keys::ShadeKeys,
        furniture::Furniture,
        invokers::Invokers,
        key::{Behind, Key},
        layers::{LayerDraw, LayerFigures},
        layout, light, lines,
        octagon::Mesh,
        operations::Operations,
        plans::Plans,
        renderer::{Renderer, STAGE_STRIDE},
        sections,
        seen::{Kept, Seen, SeenVolume, part_of, seen_volumes},
        solids::SolidTable,
        sprite_passes,
        sprites::Pages,
        stored::{self, Making},
        targets::Needs,
        transparency::MethodFigures,
        volume::LensVolume,
    },
    scene::{Background, BaseStyle, Sun, Technique, Transparency},
    shader::{MOST_SLOTS, MOST_VOLUMES, Plan, TILE_PX, VolumeTest, handlers},
    view::{Frustum, View},
};

/// Name of the pass that empties the lens masks; where it ran, they hold this frame's classes.
pub const CLEAR_MASKS: &str = "clear lens masks";

/// Everything a sample is drawn from.
#[derive(Clone, Debug)]
pub struct FrameInput<'a> {
    /// The eye and the whole picture.
    pub view: View,
    /// The part of the picture that is drawn.
    pub tile: PictureTile,
    /// Light.
    pub sun: Sun,
    /// Colours to start from.
    pub base: BaseStyle,
    /// What is behind the city.
    pub background: Background,
    /// How lenses are evaluated.
    pub technique: Technique,
    /// How translucent layers are laid one over the other.
    pub transparency: Transparency,
    /// Nothing is behind the city.
    pub transparent: bool,
    /// How far the air begins to show, as a share of the scene's radius; 0 = never.
    pub haze: f64,
    /// Volumes of enabled lenses, bottom to top.
    pub volumes: &'a [LensVolume],
    /// How many lenses the scene has, disabled ones included.
    pub lens_count: u32,
    /// The solids among them.
    pub solids: &'a Arc<SolidTable>,
    /// What the context and the lenses do.
    pub operations: &'a Operations,
    /// How shaders are made of that.
    pub backend: Backend,
    /// Whether interpolated depth is kept, for the AOV.
    pub measured: bool,
    /// Whether surfaces are kept for AOVs that translucent layers may be the shown surface of.
    pub shown: bool,
    /// Whether every pixel's classes are kept, for AOVs and statistics; of the first sample.
    pub masks: bool,
    /// Which sample this is.
    pub sample: u32,
    /// How many there will be.
    pub samples: u32,
    /// What moves the city.
    pub moved: &'a Moved,
    /// How far edges that it bends may be from where they should be, pixels.
    pub chord_px: f64,
    /// What is drawn over the picture, after its last sample.
    pub furniture: &'a Furniture,
    /// How many triangles the city may take, where it may be simplified to that: at least a quarter of it is for what is no terrain.
    pub most_triangles: Option<u64>,
}

/// Modules that a scene's lenses have a part in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShaderPart {
    /// How what is shown looks.
    #[default]
    Shade,
    /// What is there.
    Geometry,
    /// What casts a shadow.
    Shadow,
    /// Edges as lines.
    Lines,
    /// What is translucent.
    Layers,
    /// How translucent layers look, and are laid over each other.
    Composite,
}

/// How shaders are made of what a scene asks for (H3). The picture is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// For this very scene: the fastest frames; a change of effects, lenses or their order is compiled, and waited for.
    #[default]
    Specialised,
    /// One module for all that the scene may ask for: nothing is compiled when lenses come, go or change their order.
    Uber,
    /// The uber back end, until the specialised pipelines are there; those are made off the frame.
    Adaptive,
}

/// One pass that ran.
#[derive(Clone, Debug, PartialEq)]
pub struct PassRecord {
    /// What it does.
    pub name: &'static str,
    /// Which view it drew.
    pub view: &'static str,
    /// The lenses it served; none: the scene.
    pub lenses: Vec<u32>,
    /// Draw calls.
    pub draws: u32,
    /// Triangles handed to the rasteriser.
    pub triangles: u64,
    /// Where its measures stand.
    pub slot: Option<usize>,
}

/// Notes passes while they are recorded.
pub(super) struct Recorder<'a> {
    pub timer: Option<&'a mut Timer>,
    passes: Vec<PassRecord>,
}

impl Recorder<'_> {
    pub(super) fn begin(
        &mut self,
        name: &'static str,
        view: &'static str,
        lenses: &[u32],
        shades: bool,
    ) -> Option<Slot> {
        let slot = self.timer.as_mut().and_then(|t| t.slot(shades));
        let index = slot.map(|s| s.index());
        self.passes.push(PassRecord { name, view, lenses: lenses.to_vec(), draws: 0, triangles: 0, slot: index });
        slot
    }

    pub(super) fn count(&mut self, draws: u32, triangles: u64) {
        if let Some(pass) = self.passes.last_mut() {
            pass.draws += draws;
            pass.triangles += triangles;
        }
    }
}

impl Renderer {
    /// Draws one sample into the targets; the picture stands in `targets.picture` after the last one.
    pub fn draw(&mut self, input: &FrameInput, timer: Option<&mut Timer>) -> Result<Vec<PassRecord>, GpuError> {
        let drawn = self.draw_passes(input, timer);
        if drawn.is_err() {
            // What was to be made may not be there.
            self.own_sprites.forget();
        }
        drawn
    }

    fn draw_passes(&mut self, input: &FrameInput, timer: Option<&mut Timer>) -> Result<Vec<PassRecord>, GpuError> {
        if self.city.is_none() {
            return Ok(Vec::new());
        }
        let mut recorder = Recorder { timer, passes: Vec::new() };
        self.layer_figures = LayerFigures::default();
        self.method_figures = MethodFigures::default();
        self.fit_deformed(input)?;
        let city = self.drawn_box();
        self.details = self.details_for(input);
        self.own_sprites.plan(input, &city);
        let all_seen = seen_volumes(input, &city, self.own_sprites.room());
        let sun_view = self.sun_view(&input.view, &input.sun, |frustum| self.content_bounds(input, frustum));
        let plans = Plans::new(input, &all_seen.volumes);
        let is_seen = |lens| all_seen.volumes.iter().any(|v| v.lens == lens);
        let cuts = Cuts::new(input, is_seen, sun_view.as_ref(), plans.hiding.clone());
        let is_asked = |volume: usize| {
            let is_hiding =
                cuts.sun.as_ref().is_some_and(|cut| cut.hiding.lenses.contains(&input.volumes[volume].lens));
            is_hiding || all_seen.volumes.iter().any(|v| v.index == volume)
        };
        self.has_sections = sections::are_asked_for(input);
        let making = self.fit_sprites(&all_seen, input, is_asked)?;
        self.finish_own_sprites(is_asked);
        let Seen { volumes: seen, pages, .. } = &all_seen;
        let filters = plans.filters.len() as u32;
        let lines = if self.has_edges() { lines::draws(input, plans.lining.as_ref(), &plans.seen) } else { Vec::new() };
        let shows_layers = plans.layering.is_some() && (input.shown || input.measured || wants_masks(input));
        self.fit_targets(Needs {
            veils: plans.layering.is_some(),
            tails: plans.layering.is_some()
                && matches!(input.transparency, Transparency::KBuffer { .. } | Transparency::Weighted),
            shown_layers: shows_layers,
            filters,
            filter_images: if filters > 0 { behind(input).images() as u32 } else { 0 },
            lines: !lines.is_empty(),
            sprite_depth: seen.iter().any(|v| v.test.has_faces()),
            ..needs(input, !seen.is_empty(), pages, self.colored(), self.smooth(), sun_view.is_some())
        })?;
        self.kept_sprites = stored::kept_sprites(&making, &input.view);
        self.kept_sprites.extend(self.own_sprites.kept());
        let (keys, is_uber) = self.prepare(input, (seen, &making), &plans, &cuts, sun_view.is_some());
        self.upload(input, sun_view.as_ref(), (seen, &making), &plans, &cuts, is_uber)?;
        // What is narrowed is what is opaque.
        let narrows = self.narrows_lists && is_uber && plans.is_long() && plans.layering.is_none();
        if narrows {
            let [across, down] = input.tile.size.map(|side| side.div_ceil(TILE_PX));
            self.prepare_narrowing(&plans.invokers().reaches(&plans.rooms), across * down)?;
        }
        if self.binds_narrowed != narrows {
            self.binds_narrowed = narrows;
            self.groups = None;
        }
        if self.buffers.line_stages.sync(&self.gpu, &lines::stages(&lines))? {
            self.groups = None;
        }
        let mut mesh = Mesh::default();
        let (size, whole) = (input.tile.size, PictureTile::whole(input.tile.size));
        let shade_parts = match part_of(seen.iter()) {
            Some(part) => [vec![(mesh.add_beyond(part, size), whole)], mesh.add(part, size, [1, 1])],
            None => [vec![(mesh.all(), whole)], Vec::new()],
        };
        let filter_parts = filters::parts(&plans.filters, size, seen, &mut mesh);
        self.buffers.mesh.sync(&self.gpu, &mesh.corners)?;
        self.fit_groups();
        if let Some(regions) = &plans.regions {
            self.fit_regions(input.tile.size, regions)?;
        }
        let rounds = sections::rounds(input, seen, cuts.picture.as_ref());
        self.fit_sections(input.tile.size, &rounds)?;
        let mut encoder =
            self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        // Before the city: what a lens hides is decided by them.
        self.stored_pass(&mut encoder, &mut recorder, &making);
        if let Some(sun_view) = &sun_view {
            self.shadow_pass(&mut encoder, &mut recorder, input, sun_view, (&cuts, &keys.cuts));
        }
        if pages.count > 0 {
            self.sprite_passes(&mut encoder, &mut recorder, input, seen, pages.count);
        }
        match &plans.regions {
            None => encoder = self.geometry_passes(encoder, &mut recorder, input, (&cuts, &keys.cuts))?,
            Some(regions) => self.region_geometry(&mut encoder, &mut recorder, input, regions),
        }
        if let Some(cut) = cuts.picture.as_ref().zip(keys.cuts.picture.as_ref()) {
            self.section_passes(&mut encoder, &mut recorder, input, &rounds, cut);
        }
        if !seen.is_empty() && wants_masks(input) {
            self.clear_masks(&mut encoder, &mut recorder, input);
        }
        if let Some((keys, cut)) = keys.layers.as_ref().zip(cuts.picture.as_ref()) {
            let is_everywhere = plans.context.veils;
            let [outside, inside] = &shade_parts;
            let pieces = if is_everywhere || inside.is_empty() { all_parts(outside, inside) } else { inside.clone() };
            let part = u32::from(!seen.is_empty());
            let draw = LayerDraw { cut, keys, pieces: &pieces, part };
            encoder = self.layer_passes(encoder, &mut recorder, input, &draw)?;
        }
        if narrows {
            self.narrow_pass(&mut encoder, &mut recorder, input.tile.size.map(|side| side.div_ceil(TILE_PX)));
        }
        if let (false, Some(key)) = (lines.is_empty(), &keys.lines) {
            self.lines_pass(&mut encoder, &mut recorder, input, (&lines, cuts.picture.as_ref()), key);
        }
        self.filter_passes(&mut encoder, &mut recorder, input, (&plans.filters, &filter_parts), &keys.filters);
        match &plans.regions {
            None => self.shade_pass(&mut encoder, &mut recorder, input, shade_parts, &keys),
            Some(regions) => {
                let [outside, inside] = shade_parts;
                self.classes_pass(&mut encoder, &mut recorder, &inside, &keys.regions);
                self.shade_pass(&mut encoder, &mut recorder, input, [outside, Vec::new()], &keys);
                self.shade_regions(&mut encoder, &mut recorder, input, &inside, (regions, &keys.regions));
            }
        }
        if let Some(key) = keys.layers.as_ref().and_then(|layers| layers.shown.as_ref()) {
            self.show_layers(&mut encoder, &mut recorder, input, key);
        }
        if input.samples > 1 && input.sample + 1 == input.samples {
            self.resolve_pass(&mut encoder, &mut recorder);
        }
        if wants_furniture(input) {
            self.furniture_passes(&mut encoder, &mut recorder, input)?;
        }
        if let Some(timer) = &recorder.timer {
            timer.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        Ok(recorder.passes)
    }

    /// Draws the city in one lit pass over the same buffers and the same visible chunks, into the same targets: what
    /// the plain frame is measured against. Needs a frame drawn before, for the targets and the view.
    pub fn draw_bare(&mut self, view: &View) {
        self.pipelines.prepare(&Key::Bare);
        let (Some(targets), Some(groups), Some(city)) = (&self.targets, &self.groups, &self.city) else { return };
        let mut encoder =
            self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("bare") });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("bare"),
            color_attachments: &[Some(color_attachment(&targets.picture.view, wgpu::Color::WHITE))],
            depth_stencil_attachment: Some(depth_attachment(&targets.depth.view, 0.0)),
            ..Default::default()
        });
        pass.set_pipeline(self.pipelines.get(&Key::Bare));
        pass.set_bind_group(0, &groups.view, &[]);
        pass.set_bind_group(1, &city.group, &[]);
        let (frustum, whole) = (view.frustum(1.0), Details::default());
        for section in &city.buffers.sections {
            let seen = CityBuffers::visible(section.chunks.iter().filter(|c| whole.show(c)), &frustum, view.camera.eye);
            let (draws, _) = draws_of(seen.iter().map(|s| s.chunk));
            pass.set_vertex_buffer(0, section.vertices.slice(..));
            draw_ranges(&mut pass, &section.indices, &draws);
        }
        drop(pass);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// The box around all cities on the card.
    pub(super) fn drawn_box(&self) -> Aabb {
        self.cities().fold(Aabb::EMPTY, |all, c| all.union(c.buffers.bounds))
    }

    /// Whether some faces of the picture have a normal per vertex.
    pub(super) fn smooth(&self) -> bool {
        // Sections have normals of their own.
        self.has_sections || self.cities().any(|c| c.buffers.smooth)
    }

    pub(super) fn colored(&self) -> bool {
        let is_textured = |s: &Section| matches!(s.kind, SectionKind::Textured { .. });
        self.has_sections || self.cities().any(|c| c.buffers.sections.iter().any(is_textured))
    }

    /// The sun's view where shadows are wanted. `contents`: what contents show in a frustum, and in all.
    pub(super) fn sun_view(&self, view: &View, sun: &Sun, contents: impl Fn(&Frustum) -> [Aabb; 2]) -> Option<View> {
        let city = &self.city.as_ref()?.buffers;
        if !light::casts_shadows(sun) {
            return None;
        }
        let frustum = view.frustum(1.0);
        let receivers = city
            .sections
            .iter()
            .flat_map(|s| &s.chunks)
            .filter(|c| c.details & Detail::Full.bit() != 0 && frustum.meets(&c.bounds))
            .fold(Aabb::EMPTY, |all, c| all.union(c.bounds));
        let [seen, all] = contents(&frustum);
        let moved = self.deformed.as_ref().map_or(Aabb::EMPTY, |deformed| deformed.city.buffers.bounds);
        let seen = if frustum.meets(&moved) { seen.union(moved) } else { seen };
        light::sun_view(sun, &receivers.union(seen), &city.bounds.union(all).union(moved))
    }

    /// Brings the small buffers up to date; on the uber back end with the invoker table of the plans.
    fn upload(
        &mut self,
        input: &FrameInput,
        sun: Option<&View>,
        (seen, making): (&[SeenVolume], &[Making]),
        plans: &Plans,
        cuts: &Cuts,
        is_uber: bool,
    ) -> Result<(), GpuError> {
        let Some(city) = &self.city else { return Ok(()) };
        let radius = light::radius_of(&city.buffers.bounds);
        let jitter = crate::view::jitter_px(input.sample);
        let jitter = if input.samples > 1 { jitter } else { DVec2::ZERO };
        let haze = haze(input) / radius;
        let view = view_uniform(&input.view, input.tile, jitter, input.sample, haze);
        let light = light::uniform(&input.sun, input.background, sun, input.view.camera.eye, radius);
        let (mut stages, mut list_stages, mut stored_stages) = (Vec::new(), Vec::new(), Vec::new());
        let (mut sprite_places, mut shapes, mut planes) = (Vec::new(), Vec::new(), Vec::new());
        let mut stored_shapes: Vec<(&Making, layout::Shape)> = Vec::new();
        let mut of_seen = making.iter();
        for volume in seen {
            let body = &input.volumes[volume.index].body;
            if volume.test == VolumeTest::OwnSprite {
                shapes.push(self.own_sprites.figures(volume.index, &input.view, &mut planes));
                sprite_places.push(bytemuck::Zeroable::zeroed());
                continue;
            }
            let is_listed = volume.test.is_sprite() && !body.is_form();
            let shape = match is_listed {
                true => body.program_figures(&input.view, &mut planes),
                false => body.figures(&input.view, &mut planes),
            };
            shapes.push(layout::Shape { kind: volume.test.number(), ..shape });
            let Some(sprite) = &volume.sprite else {
                sprite_places.push(bytemuck::Zeroable::zeroed());
                continue;
            };
            match &sprite.kept {
                Kept::Page(place) => {
                    let seen = (volume, sprite, *place);
                    let (own, place) =
                        sprite_passes::layouts(shape, seen, body, &input.view, input.tile, self.page_size());
                    stages.extend(own.iter().flat_map(strided));
                    sprite_places.push(place);
                }
                Kept::Stored(_) => {
                    let Some(making) = of_seen.next() else { continue };
                    stored_shapes.push((making, shape));
                    sprite_places.push(stored::place(volume, making, input.tile));
                }
            }
        }
        // Those that have eyes of their own follow.
        for making in of_seen {
            let own_view = making.own.as_ref().unwrap_or(&input.view);
            let shape = match making.body.is_form() {
                true => making.body.figures(own_view, &mut planes),
                false => making.body.program_figures(own_view, &mut planes),
            };
            stored_shapes.push((making, shape));
        }
        for (making, shape) in stored_shapes {
            let (own_view, uniform, target) = match &making.own {
                None => (&input.view, view, input.tile.size),
                Some(own) => {
                    let uniform = view_uniform(own, PictureTile::whole(own.size), DVec2::ZERO, 0, 0.0);
                    (own, uniform, own.size)
                }
            };
            let stage = stored::stage(shape, making, uniform, target);
            let lists = stored::list_stages(making, (own_view, &stage), self.list_size(), self.crossing_room);
            list_stages.extend(lists.iter().flat_map(stored::placed));
            stored_stages.extend(stored::placed(&stage));
        }
        let eyes = [Some(input.view.camera.eye), sun.map(|sun| sun.camera.eye)];
        let city_uniforms = eyes.map(|eye| eye.map_or_else(Vec::new, |eye| self.city_uniforms(eye)));
        let sun_shapes = cuts.sun.as_ref().map(|cut| cut.shapes(input, &self.own_sprites));
        let mut parameters = std::borrow::Cow::Borrowed(&input.operations.parameters);
        let (gpu, b) = (&self.gpu, &mut self.buffers);
        let mut stale = false;
        if is_uber || !plans.filters.is_empty() {
            // Their modules declare this array as long as it may be.
            parameters.to_mut().resize(MOST_SLOTS as usize, [0.0; 4]);
        }
        for (filter, (_, slot)) in plans.uses() {
            parameters.to_mut()[slot as usize][0] = (4 * behind(input).images() * filter) as f32;
        }
        let stages_of = |f| filters::stages(f, input.tile.size, behind(input).images());
        let filter_stages: Vec<u8> = plans.filters.iter().flat_map(stages_of).flat_map(|s| strided(&s)).collect();
        stale |= b.filter_stages.sync(gpu, &filter_stages)?;
        if is_uber {
            sprite_places.resize(MOST_VOLUMES as usize, bytemuck::Zeroable::zeroed());
            shapes.resize(MOST_VOLUMES as usize, bytemuck::Zeroable::zeroed());
            let invokers = plans.invokers();
            stale |= b.invoker_table.sync(gpu, &invokers.table(input.tile.size))?;
            stale |= b.invokers.sync(gpu, invokers.all())?;
            stale |= b.tile_lists.sync(gpu, &invokers.tile_lists(&plans.parts, input.tile.size))?;
        }
        stale |= b.view.sync(gpu, &[view])?;
        stale |= b.light.sync(gpu, &[light])?;
        if let Some(sun) = sun {
            let whole = PictureTile::whole(sun.size);
            stale |= b.sun_view.sync(gpu, &[view_uniform(sun, whole, DVec2::ZERO, 0, 0.0)])?;
        }
        if let Some(shapes) = &sun_shapes {
            stale |= b.eye.sync(gpu, &[shapes.eye])?;
            stale |= b.shapes.sync(gpu, &shapes.shapes)?;
            stale |= b.shape_planes.sync(gpu, &shapes.planes)?;
            if let (true, Some(cut)) = (is_uber, &cuts.sun) {
                let none = Plan::default();
                let invokers = Invokers::new([&none, &none], [Some(&cut.plan), None, None], handlers());
                stale |= b.shape_invoker_table.sync(gpu, &invokers.table([0, 0]))?;
                stale |= b.shape_invokers.sync(gpu, invokers.all())?;
            }
        }
        if self.solids_of.as_ref().is_none_or(|before| !Arc::ptr_eq(before, input.solids)) {
            stale |= b.solids.sync(gpu, &input.solids.words)?;
            b.solid_corners.sync(gpu, &input.solids.corners)?;
            self.solids_of = Some(input.solids.clone());
            self.shadow_of = None;
        }
        stale |= b.cities.sync(gpu, &city_uniforms[0])?;
        stale |= b.sun_cities.sync(gpu, &city_uniforms[1])?;
        stale |= b.planes.sync(gpu, &planes)?;
        stale |= b.sprite_stages.sync(gpu, &stages)?;
        stale |= b.stored_stages.sync(gpu, &[list_stages, stored_stages].concat())?;
        stale |= b.sprite_places.sync(gpu, &sprite_places)?;
        stale |= b.lens_shapes.sync(gpu, &shapes)?;
        stale |= b.parameters.sync(gpu, &parameters)?;
        stale |= b.object_values.sync(gpu, &input.operations.object_values)?;
        stale |= b.resolve.sync(gpu, &[input.samples as f32])?;
        if stale {
            self.groups = None;
        }
        Ok(())
    }

    fn clear_masks(&self, encoder: &mut wgpu::CommandEncoder, recorder: &mut Recorder, input: &FrameInput) {
        let Some(targets) = &self.targets else { return };
        let layers = mask_layers(input) as usize;
        for some in targets.masks.layers[..layers].chunks(4) {
            let slot = recorder.begin(CLEAR_MASKS, "main", &[], false);
            let attachments: Vec<_> =
                some.iter().map(|view| Some(color_attachment(view, wgpu::Color::TRANSPARENT))).collect();
            encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(CLEAR_MASKS),
                color_attachments: &attachments,
                timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
                ..Default::default()
            });
        }
    }

    fn shade_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        [outside, inside]: [Vec<(Range<u32>, PictureTile)>; 2],
        keys: &ShadeKeys,
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let target = if input.samples > 1 { &targets.sums } else { &targets.picture };
        let load = if input.sample == 0 { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
        let mut attachment = color_attachment(&target.view, wgpu::Color::TRANSPARENT);
        attachment.ops.load = load;
        let depth = read_depth(&targets.depth.view);
        self.picture_pass(encoder, recorder, ("shade", Some(attachment), depth), |pass| {
            pass.set_bind_group(3, &groups.lines, &[]);
            let mut counted = (0, 0);
            for (part, keys, pieces) in [(0, &keys.context, outside), (1, &keys.lenses, inside)] {
                keys.iter().for_each(|key| self.draw_pieces(pass, key, part, &pieces, &mut counted));
            }
            counted
        });
    }

    /// A pass that reads what the geometry left, over parts of the picture; `draw` returns its draws and triangles.
    pub(super) fn picture_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        (name, target, depth): PictureTarget<'_>,
        draw: impl FnOnce(&mut wgpu::RenderPass) -> (u32, u64),
    ) {
        let Some(groups) = &self.groups else { return };
        let slot = recorder.begin(name, "main", &[], true);
        let color = [target];
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: if color[0].is_some() { &color } else { &[] },
            depth_stencil_attachment: Some(depth),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        pass.set_bind_group(0, &groups.view, &[]);
        pass.set_bind_group(1, &groups.shade, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        pass.set_vertex_buffer(0, self.buffers.mesh.buffer().slice(..));
        let (drawn, triangles) = draw(&mut pass);
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(drawn, triangles);
    }

    /// Draws pieces of the picture, of the context (part 0) or of the lenses (part 1); adds draws and triangles to `counted`.
    pub(super) fn draw_pieces(
        &self,
        pass: &mut wgpu::RenderPass,
        key: &Key,
        part: u32,
        pieces: &[(Range<u32>, PictureTile)],
        counted: &mut (u32, u64),
    ) {
        let mut drawn = pieces.iter().filter(|(corners, tile)| !corners.is_empty() && !tile.is_empty()).peekable();
        if drawn.peek().is_some() {
            pass.set_pipeline(self.pipelines.get(key));
        }
        for (corners, tile) in drawn {
            scissor(pass, *tile);
            pass.draw(corners.clone(), part..part + 1);
            *counted = (counted.0 + 1, counted.1 + corners.len() as u64 / 3);
        }
    }

    fn resolve_pass(&self, encoder: &mut wgpu::CommandEncoder, recorder: &mut Recorder) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let slot = recorder.begin("resolve", "main", &[], true);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("resolve"),
            color_attachments: &[Some(color_attachment(&targets.picture.view, wgpu::Color::TRANSPARENT))],
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        pass.set_pipeline(self.pipelines.get(&Key::Resolve));
        pass.set_bind_group(0, &groups.resolve, &[]);
        pass.draw(0..3, 0..1);
        recorder.count(1, 1);
    }
}

/// Name of a pass over the picture, its colour if it has one, and its depth.
pub(super) type PictureTarget<'a> =
    (&'static str, Option<wgpu::RenderPassColorAttachment<'a>>, wgpu::RenderPassDepthStencilAttachment<'a>);

/// What shading draws outside of the lenses' bounds, and inside.
fn all_parts<T: Clone>(outside: &[T], inside: &[T]) -> Vec<T> {
    [outside, inside].concat()
}

/// Whether this sample writes the lens masks.
pub(super) fn wants_masks(input: &FrameInput) -> bool {
    input.masks && input.sample == 0
}

/// Three classes, and a bit for each lens.
fn mask_layers(input: &FrameInput) -> u32 {
    3 * input.lens_count.div_ceil(32)
}

/// Whether this sample is the last and something stands over the picture.
pub(super) fn wants_furniture(input: &FrameInput) -> bool {
    !input.furniture.is_empty() && input.sample + 1 == input.samples
}

/// Haze per radius of the scene; none in orthographic views, which have no distance, nor on clay.
pub(super) fn haze(input: &FrameInput) -> f64 {
    if input.view.is_orthographic() || input.base == BaseStyle::Clay { 0.0 } else { input.haze }
}

fn needs(input: &FrameInput, has_lenses: bool, pages: &Pages, colors: bool, smooth: bool, shadows: bool) -> Needs {
    Needs {
        size: input.tile.size,
        colors,
        smooth,
        own_depth: input.measured,
        sums: input.samples > 1,
        mask_layers: if input.masks && has_lenses { mask_layers(input) } else { 0 },
        sprites: [pages.size[0], pages.size[1], pages.count],
        sprite_depth: false,
        filters: 0,
        filter_images: 0,
        lines: false,
        veils: false,
        tails: false,
        shown_layers: false,
        shadow: if shadows { light::SHADOW_SIZE } else { 0 },
    }
}

/// What is behind the city.
pub(super) fn behind(input: &FrameInput) -> Behind {
    match input.background {
        _ if input.transparent => Behind::Nothing,
        Background::Color(_) => Behind::OneColor,
        Background::Sky => Behind::Sky,
    }
}

pub(super) fn strided<T: bytemuck::Pod>(value: &T) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(value).to_vec();
    bytes.resize(STAGE_STRIDE as usize, 0);
    bytes
}

pub(super) fn scissor(pass: &mut wgpu::RenderPass, part: PictureTile) {
    pass.set_scissor_rect(part.origin[0], part.origin[1], part.size[0], part.size[1]);
}

pub(super) fn color_attachment(view: &wgpu::TextureView, clear: wgpu::Color) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
    }
}

/// A depth that chooses and is not written.
pub(super) fn read_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops: None }
}

pub(super) fn depth_attachment(view: &wgpu::TextureView, clear: f32) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}
