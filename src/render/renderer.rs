//! The renderer: what lives on the GPU between frames, and how it is kept up to date.
//!
//! It refuses to know files, commands and windows. Between two equal frames it allocates and uploads
//! nothing; [`Gpu::allocations`] and [`Gpu::uploads`] prove it.

use std::path::Path;

use crate::{
    city::{CityModel, ground::Ground},
    gpu::{Gpu, GpuError, Timer},
    render::{
        bare,
        cities::Cities,
        city::{CityBuffers, Shown},
        city_on_gpu::CityOnGpu,
        contents::{ContentLook, WantedContent},
        deformed::{DeformedFigures, Deforming},
        frame::FrameInput,
        images::Images,
        layers::{LayerFigures, MethodFigures},
        layout,
        parts::Tiling,
        pass::{
            Inputs,
            context::{FrameContext, Pass as _, Preparing},
        },
        plan::{Adapter, FramePlan, Stayed},
        ray_tracer::TracedFigures,
        resource::{
            pipelines::Pipelines,
            recording::{PassRecord, Recording},
            targets::{Needs, Targets},
        },
        settings::Settings,
        stored::SpriteTexels,
        view_state::{ViewState, fit_targets},
    },
    view::View,
};

/// A renderer on one device.
#[derive(Debug)]
pub struct Renderer {
    /// The device.
    pub gpu: Gpu,
    /// Room, and ways of drawing.
    pub settings: Settings,
    /// What of furniture is images.
    pub images: Images,
    pub(super) pipelines: Pipelines,
    pub(super) city: Option<CityOnGpu>,
    /// How many cities were put on the GPU.
    cities_set: u64,
    /// What is kept for the view that is drawn.
    pub(super) view: ViewState,
    deforming: Deforming,
    /// The effects that the frames since the last [`Renderer::begin_picture`] ran, ascending.
    ran: Vec<u32>,
}

impl Renderer {
    /// A renderer without a city.
    pub fn new(gpu: Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            settings: Settings::new(gpu.is_software()),
            images: Images::new(&gpu),
            pipelines: Pipelines::new(&gpu),
            city: None,
            cities_set: 0,
            view: ViewState::new(&gpu)?,
            deforming: Deforming::default(),
            ran: Vec::new(),
            gpu,
        })
    }

    /// How pictures are cut that are too large for a target, where pixels take so many bytes, and filters look so many pixels far.
    pub(super) fn tiling(&self, pixel_bytes: u64, reach: u32) -> Tiling {
        Tiling::new(self.gpu.device.limits().max_texture_dimension_2d, pixel_bytes, self.settings.tile, reach)
    }

    /// Puts a city on the GPU in place of the last one.
    pub fn set_city(&mut self, shown: &Shown, blocks: Option<&CityModel>) -> Result<(), GpuError> {
        self.city = None;
        self.deforming.begin_city();
        self.cities_set += 1;
        self.view.begin_city(self.cities_set);
        self.city = Some(CityOnGpu::new(&self.gpu, &self.pipelines, shown, blocks)?);
        Ok(())
    }

    /// The city's buffers.
    pub fn city(&self) -> Option<&CityBuffers> {
        self.city.as_ref().map(|c| &c.buffers)
    }

    /// Makes the GPU hold these contents beside the scene's city, whose plain ground is `ground`, and no others; with their
    /// edges where something draws lines, and with storeys and windows on walls where these are wanted. Between frames with the same contents nothing
    /// is made.
    pub fn set_contents(
        &mut self,
        wanted: &[WantedContent],
        ground: Option<&Ground>,
        edges: bool,
        facades: bool,
    ) -> Result<(), GpuError> {
        let Some(own) = &self.city else { return Ok(()) };
        // Since the view was drawn last another city may have been put there for another view.
        self.view.begin_city(self.cities_set);
        let how = ContentLook { ground, edges, facades };
        if self.view.contents.set(&self.gpu, &self.pipelines, own, wanted, how)? {
            self.view.change_surfaces();
        }
        Ok(())
    }

    /// Whether the city's edges are on the GPU.
    pub fn has_edges(&self) -> bool {
        self.city.as_ref().is_some_and(|city| city.edges.is_some())
    }

    /// Puts the edges of the city that [`Renderer::set_city`] was given on the GPU; once per city.
    pub fn set_edges(&mut self, shown: &Shown) -> Result<(), GpuError> {
        match &mut self.city {
            Some(city) => city.find_edges(&self.gpu, shown),
            None => Ok(()),
        }
    }

    /// The entry of the table of surfaces, of the scene's own city and of contents; of a section, whose it is.
    pub fn surface(&self, number: u32) -> Option<layout::Surface> {
        self.view.contents.surface(self.city.as_ref()?, number)
    }

    /// The AOV's number of what has this code in the geometry target: object index + 1, 0 = nothing.
    pub(super) fn object_id(&self, code: u32) -> u32 {
        // The plain ground is no object: its NO_OBJECT wraps to 0.
        code.checked_sub(1).and_then(|number| self.surface(number)).map_or(0, |s| s.object.wrapping_add(1))
    }

    /// The buffers of a content's city, by its name; 0: of the scene's own.
    pub fn content_city(&self, id: u64) -> Option<&CityBuffers> {
        self.view.contents.city(self.city.as_ref()?, id).map(|city| &city.buffers)
    }

    /// The cities that frames draw.
    pub(super) fn cities(&self) -> Option<Cities<'_>> {
        let ViewState { contents, deformed, .. } = &self.view;
        Some(Cities { own: self.city.as_ref()?, deformed, contents })
    }

    /// Gives back the targets and the lists of translucent layers; the next frame makes its own. City and pipelines stay.
    pub fn drop_targets(&mut self) {
        self.view.drop_targets();
    }

    /// The targets of the last frame.
    pub fn targets(&self) -> Option<&Targets> {
        self.view.targets.as_ref()
    }

    /// Starts counting pipelines anew; the first frame draws the city, whatever the targets hold.
    pub fn begin_picture(&mut self) {
        self.pipelines.begin_picture();
        self.view.passes.geometry.forget();
        self.ran.clear();
    }

    /// Effects of the plans that were drawn since then, ascending.
    pub fn planned(&self) -> &[u32] {
        &self.ran
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

    /// Draws one sample into the targets; the picture stands in `targets.picture` after the last one.
    pub fn draw(&mut self, input: &FrameInput, timer: Option<&mut Timer>) -> Result<Vec<PassRecord>, GpuError> {
        let drawn = self.draw_suns(input, timer).and_then(|drawn| self.gpu.check().map(|()| drawn));
        if drawn.is_err() {
            // What was to be made may not be there.
            self.view.own_sprites.forget();
            self.view.passes.forget();
        }
        drawn
    }

    /// Draws the frames of all suns, one over the other.
    fn draw_suns(&mut self, input: &FrameInput, mut timer: Option<&mut Timer>) -> Result<Vec<PassRecord>, GpuError> {
        if input.suns.is_empty() {
            return self.draw_frame(input, timer);
        }
        let mut records = Vec::new();
        for (number, (sun, operations)) in input.suns.iter().enumerate() {
            let sun_of = [number as u32, input.suns.len() as u32];
            let own = FrameInput { sun: *sun, operations, sun_of, ..input.clone() };
            records.extend(self.draw_frame(&own, timer.take())?);
        }
        Ok(records)
    }

    fn draw_frame(&mut self, input: &FrameInput, timer: Option<&mut Timer>) -> Result<Vec<PassRecord>, GpuError> {
        let Self { gpu, settings, images, pipelines, city, view, deforming, ran, .. } = self;
        let Some(city) = city else { return Ok(Vec::new()) };
        let ViewState { contents, deformed, targets, shared, passes, own_sprites, .. } = view;
        pipelines.begin_frame(settings.most_pipelines);
        shared.world += u64::from(deforming.fit(gpu, pipelines, city, contents, deformed, input)?);
        let cities = Cities { own: city, deformed, contents };
        let (sprite_bytes, count_bytes) = (shared.sprites.buffer().size(), passes.stored.count_bytes());
        let stayed = Stayed { own_sprites, sprite_bytes, count_bytes };
        let plan = FramePlan::new(input, &cities.facts(), adapter_of(gpu), *settings, stayed);
        let inputs = Inputs::of(&plan);
        passes.begin(&plan);
        let targets = fit_targets(gpu, targets, shared, needs_of(&plan, &inputs), pipelines.sums());
        let programs = plan.programs(|wanted| {
            // All are asked for, also when the first is not there.
            let keys = passes.keys(&inputs, &plan, wanted);
            keys.of_programs().filter(|key| !pipelines.is_ready(key)).count() == 0
        });
        for key in passes.keys(&inputs, &plan, &programs).sorted() {
            pipelines.prepare(&key);
        }
        ran.extend(plan.effects());
        ran.sort_unstable();
        ran.dedup();
        shared.fit_sprites(gpu, &plan)?;
        shared.upload(gpu, &plan, &cities, programs.is_uber)?;
        if !plan.narrows() {
            shared.bind_tile_lists();
        }
        let (plan, programs, pipelines) = (&plan, &programs, pipelines);
        passes.prepare(&inputs, &mut Preparing { gpu, pipelines, images, cities, shared, targets, plan, programs })?;
        shared.fit_groups(gpu, pipelines, &cities, targets);
        let Some(groups) = shared.groups() else { return Ok(Vec::new()) };
        let frame = FrameContext { gpu, pipelines, images, cities, shared, groups, targets, plan, programs };
        let mut recording = Recording::new(gpu, timer);
        passes.record(&inputs, &frame, &mut recording)?;
        Ok(recording.finish(gpu))
    }

    /// Draws the city in one lit pass over the same buffers and the same visible chunks, into the same targets: what
    /// the plain frame is measured against. Needs a frame drawn before, for the targets and the view.
    pub fn draw_bare(&mut self, view: &View) {
        let (Some(targets), Some(groups), Some(city)) = (&self.view.targets, self.view.shared.groups(), &self.city)
        else {
            return;
        };
        self.view.passes.geometry.forget();
        bare::draw(&self.gpu, &mut self.pipelines, city, targets, &groups.view, view);
    }

    /// The stored sprites of a lens as the last frame made them.
    pub fn read_sprites(&self, lens: u32) -> Result<Vec<SpriteTexels>, GpuError> {
        self.view.passes.stored.read(&self.gpu, &self.view.shared, lens)
    }

    /// Whether the last frame met more crossings than there was room for, and the next has room for them.
    pub fn makes_room(&mut self) -> Result<bool, GpuError> {
        self.view.passes.stored.makes_room(&self.gpu, &mut self.view.own_sprites)
    }

    /// Rays that have more intervals than their sprite has layers, by lens: of the sprites of the last frame's eye, and with `own`
    /// of those that have eyes of their own.
    pub fn read_excess(&self, own: bool) -> Result<Vec<(u32, u32)>, GpuError> {
        self.view.passes.stored.read_excess(&self.gpu, own)
    }

    /// Whether lists of the last frame are longer than it was made for, and the next one has to sort them; that it then does.
    pub(super) fn sorts_longer(&mut self) -> Result<bool, GpuError> {
        self.view.passes.layers.sorts_longer(&self.gpu)
    }

    /// What the last frame had of translucent layers.
    pub fn layer_figures(&self) -> LayerFigures {
        let passes = &self.view.passes;
        let all = [passes.layers.figures, passes.slots.figures, passes.stochastic.figures];
        all.into_iter().find(|figures| figures.bands > 0).unwrap_or_default()
    }

    /// What the processor followed for the last frame.
    pub fn traced_figures(&self) -> TracedFigures {
        self.view.passes.rays.figures
    }

    /// What the method of the last frame took and left out.
    pub fn method_figures(&self) -> MethodFigures {
        let passes = &self.view.passes;
        let all = [passes.layers.method, passes.slots.method];
        all.into_iter().find(|method| *method != MethodFigures::default()).unwrap_or_default()
    }

    /// What the deformations of the last frame took; `None`: there were none.
    pub fn deformed_figures(&self) -> Option<DeformedFigures> {
        DeformedFigures::of_all(&self.view.deformed)
    }

    /// How far the bent edges of the last frame are from where they should be, by brute force in f64, pixels: the median of those that are
    /// off at all, and the farthest. `None`: nothing is refined.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn chords(&mut self) -> Result<Option<[f64; 2]>, GpuError> {
        match self.view.deformed.first() {
            Some(deformed) => self.deforming.chords(&self.gpu, deformed),
            None => Ok(None),
        }
    }
}

fn adapter_of(gpu: &Gpu) -> Adapter {
    Adapter {
        is_software: gpu.is_software(),
        tests_depth_early: gpu.tests_depth_early(),
        holds_depth: gpu.holds_depth(),
    }
}

/// The targets that a frame draws into.
fn needs_of(plan: &FramePlan, inputs: &Inputs) -> Needs {
    let mut needs = Needs {
        size: plan.input.tile.size,
        colors: plan.colored,
        emissions: plan.texels_emit,
        smooth: plan.smooth,
        own_depth: plan.input.measured,
        ..Needs::default()
    };
    inputs.add_needs(plan, &mut needs);
    needs
}
