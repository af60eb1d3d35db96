//! A picture, its AOVs and its statistics, from a scene and a city: the shown surface written down.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    error::Error,
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use crate::{
    city::{
        CityModel, Lod, ObjectClass,
        coplanar::coplanar_triangles,
        derived::{Derive, Form, derive},
        ground::{Ground, plain_ground},
        load::LoadOptions,
        place::Places,
        shown::{ShownObjects, shown_geometries},
        spatial::SpatialIndex,
        sun::{Site, SunPosition},
    },
    geom::{Aabb, deform::Deformers},
    gpu::{Gpu, GpuError, Timer},
    lens::{ray_path::RayPaths, solids::ShownCity},
    render::{
        bands::{Band, ClassCounts, DrawnBand},
        best_views::KnownViews,
        city::Shown,
        deformed::DeformedFigures,
        diagnostics,
        epochs::{Epochs, KnownLifetimes},
        eye::PictureTile,
        fields::ShownVolume,
        footprints::OwnFootprints,
        frame::{Backend, FrameInput, ShaderPart},
        furniture::{self, Furniture},
        insets::Inset,
        layers::{LayerFigures, MethodFigures},
        lens_figures::{FiguresOf, handlers_that_ran, lens_figures},
        moved::Moved,
        moving::MovingObjects,
        parts::{Part, Tiling, whole},
        pass::masks::CLEAR_MASKS,
        ray_tracer::TracedFigures,
        renderer::Renderer,
        resolve::{Known, ResolveError, Resolved, Surroundings},
        resource::recording::PassRecord,
        stance::{self, Stance},
        stats::{self, Statistics},
        stored::SpriteTexels,
        visible_share,
        volume::LensVolume,
    },
    scene::{CitySpec, Drawn, Scene, Sun, SunTime},
    time::Moment,
    view::{Camera, CameraError, View, first_view},
};

pub use crate::render::request::{Aovs, Request};

/// How thick the air is: the share of the horizon's colour that a scene's radius of it adds.
const HAZE: f64 = 0.035;

/// What the targets of a picture take for each pixel, bytes, and what a filter adds, and what it starts from.
const PIXEL_BYTES: u64 = 48;
const FILTER_BYTES: u64 = 16;

/// What can go wrong while drawing.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The GPU.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The camera.
    #[error("camera: {0}")]
    Camera(#[from] CameraError),
    /// Something a scene says that the city cannot answer.
    #[error("{0}")]
    Scene(String),
    /// [`Studio::interrupt`] said so.
    #[error("interrupted")]
    Interrupted,
    /// Who takes the bands of a picture could not.
    #[error("{0}")]
    Taken(Box<dyn Error + Send + Sync>),
}

impl From<ResolveError> for RenderError {
    fn from(error: ResolveError) -> Self {
        match error {
            ResolveError::Camera(error) => Self::Camera(error),
            ResolveError::Scene(message) => Self::Scene(message),
        }
    }
}

/// Takes the bands of a picture, from the top.
pub type TakeBand<'a> = dyn FnMut(Band) -> Result<(), Box<dyn Error + Send + Sync>> + 'a;

/// An overlay as it lies over a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownOverlay {
    /// The number of its lens.
    pub lens: u32,
    /// Left and top of what it shows, pixels of the picture; of one that stands in the scene, of what its board may touch.
    pub at: [i32; 2],
    /// Width and height of the same, pixels.
    pub size: [u32; 2],
    /// The eye of what it shows, where that is a view.
    pub camera: Option<Camera>,
}

/// A finished picture; row 0 at the top.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Width, height.
    pub size: [u32; 2],
    /// sRGB, straight alpha.
    pub rgba: Vec<[u8; 4]>,
    /// Metres along the view axis, +∞ = nothing.
    pub depth: Option<Vec<f32>>,
    /// Object index + 1, 0 = nothing.
    pub object_id: Option<Vec<u32>>,
    /// Unit, model axes, towards the eye; 0,0,0 = nothing.
    pub normal: Option<Vec<[f32; 3]>>,
    /// One bit per lens, 32 lenses per plane.
    pub lens_mask: Option<Vec<Vec<u32>>>,
    /// How many pixels show each class of each lens that was drawn, where that is counted.
    pub(super) class_counts: Vec<ClassCounts>,
    /// Rays that have more intervals than the sprite of their lens has layers, by lens.
    pub(super) excess: BTreeMap<u32, u32>,
    /// Objects by lens that have no section since they are open.
    pub(super) open: BTreeMap<u32, u32>,
    /// Translucent layers.
    pub(super) layers: LayerFigures,
    /// What their method took.
    pub(super) method: MethodFigures,
    /// Rays that the processor followed.
    pub(super) traced: TracedFigures,
    /// Objects by lens that have no form that its content derives: shown as they are, left out, shown as something else.
    pub(super) not_derived: [BTreeMap<u32, u32>; 3],
    /// By lens the thousandths of its strength at which its deformation is used, where it would fold space.
    pub(super) weakened: BTreeMap<u32, u32>,
    /// By lens the thousandths of what it changes in which it shows things turned round, since the rays that it bends cross.
    pub(super) folded: BTreeMap<u32, u32>,
    /// What is to be said of volumes of which nothing is seen.
    pub(super) unseen_volumes: Vec<String>,
    /// What deformations took.
    pub(super) deformed: Option<DeformedFigures>,
    /// How lenses bend rays in it.
    pub rays: RayPaths,
    /// The overlays that lie over it, by their lenses.
    pub overlays: Vec<ShownOverlay>,
    /// Characters of the furniture that no font has.
    pub without_glyph: BTreeSet<char>,
    /// GPU allocations and uploads while drawing, and the bytes of these (reading back not counted).
    made: [u64; 3],
    /// What it cost.
    pub statistics: Statistics,
}

/// A city on the GPU, ready for any number of pictures.
#[derive(Debug)]
pub struct Studio {
    /// The renderer.
    pub renderer: Renderer,
    /// The city as it is at the moment of what was drawn last ([`Self::stand_at`]).
    pub model: Arc<CityModel>,
    /// Its geometries that are shown.
    pub geometries: Vec<u32>,
    /// The plain ground under it.
    pub ground: Option<Arc<Ground>>,
    /// Objects with something to show.
    pub objects: u64,
    /// How long loading took, filled by whoever loaded.
    pub load: stats::Load,
    /// How [`Studio::redraw`] makes shaders.
    pub backend: Backend,
    /// What stays from scene to scene.
    pub(super) known: Mutex<Known>,
    /// Where it is `true`, a picture of several samples ends after the one that is being drawn, as [`RenderError::Interrupted`].
    pub interrupt: Arc<AtomicBool>,
    /// How contents of lenses are loaded.
    pub reading: LoadOptions,
    /// From where objects are seen best, by object and field of view.
    pub(super) known_views: Mutex<KnownViews>,
    /// Pictures from other eyes, by number.
    pub(super) insets: BTreeMap<u64, Inset>,
    /// Where the shown triangles are, made for the first picture whose lenses are counted.
    index: Arc<OnceLock<SpatialIndex>>,
    /// What its objects cover of the ground, once an effect asks for it.
    footprints: OwnFootprints,
    /// When its objects, and those of contents, are there.
    pub(super) lifetimes: Arc<KnownLifetimes>,
    /// What moves of the city.
    moving: Arc<MovingObjects>,
    /// Whether the rest is drawn where its file has it, and what moves beside that: since a moment was asked for.
    is_still: bool,
    /// Where what moves stands, for who asks on the host.
    pub(super) stance: Stance,
}

impl Studio {
    /// Chooses what is shown and puts it on the GPU.
    pub fn new(gpu: Gpu, model: Arc<CityModel>, spec: &CitySpec) -> Result<Self, RenderError> {
        let cap = match &spec.lod {
            None => None,
            Some(text) => Some(Lod::parse(text).ok_or_else(|| {
                RenderError::Scene(format!(
                    "city.lod: \"{text}\" is no level of detail; expected e.g. \"1.3\" or \"2\""
                ))
            })?),
        };
        let geometries = shown_geometries(&model, cap);
        let ground = spec.ground.then(|| plain_ground(&model, &geometries)).flatten().map(Arc::new);
        let moving = MovingObjects::new(&model, &geometries);
        let coplanar = coplanar_triangles(&model, &geometries);
        let mut renderer = Renderer::new(gpu)?;
        let shown = Shown { coplanar: &coplanar, ground: ground.as_deref(), ..Shown::of(&model, &geometries) };
        renderer.set_city(&shown, None)?;
        let mut objects: Vec<u32> = geometries.iter().map(|&g| model.geometries[g as usize].object).collect();
        objects.sort_unstable();
        objects.dedup();
        Ok(Self {
            renderer,
            objects: objects.len() as u64,
            model,
            geometries,
            moving: Arc::new(moving),
            is_still: false,
            stance: Stance::default(),
            ground,
            load: stats::Load::default(),
            backend: Backend::default(),
            known: Mutex::default(),
            reading: LoadOptions::default(),
            known_views: Mutex::default(),
            interrupt: Arc::default(),
            insets: BTreeMap::new(),
            index: Arc::default(),
            footprints: OnceLock::new(),
            lifetimes: Arc::default(),
        })
    }

    /// When the objects of cities are there, as far as that was asked for.
    pub fn known_lifetimes(&self) -> &KnownLifetimes {
        &self.lifetimes
    }

    /// The city, and what is shown of it.
    pub(super) fn shown(&self) -> ShownCity<'_> {
        let number = ShownCity::numbered(self.stance.count);
        ShownCity { model: &self.model, geometries: &self.geometries, index: &self.index, number }
    }

    /// Has all that asks where things are find what moves by timetables where it is at the moment of a scene, and attributes that change as they
    /// are then, if the scene has something that asks. Whoever draws a scene has it stand so; who asks before that, asks for it.
    pub fn stand_at(&mut self, scene: &Scene) {
        if self.model.moves.is_empty() && self.model.histories.is_empty() {
            return;
        }
        if let Some(at) = stance::asked_for(scene) {
            self.put_at(at);
        }
    }

    /// The city as its file has it.
    pub fn file(&self) -> &Arc<CityModel> {
        self.stance.file(&self.model)
    }

    /// The same at a moment.
    pub(super) fn put_at(&mut self, at: Option<Moment>) {
        if self.stance.put(&mut self.model, &mut self.index, at) {
            self.known_views.get_mut().unwrap_or_else(PoisonError::into_inner).clear();
        }
    }

    /// What finds the triangles that are shown, as soon as that is known: [`Self::find_triangles`], or a picture whose lenses are counted,
    /// finds it out.
    pub fn index(&self) -> &Arc<OnceLock<SpatialIndex>> {
        &self.index
    }

    /// Finds out where the triangles are that are shown.
    pub fn find_triangles(&self) {
        self.shown().index();
    }

    /// What is at places of it.
    pub fn places(&self) -> Places<'_> {
        Places { model: &self.model, index: self.shown().index(), ground: self.ground.as_deref() }
    }

    /// A scene of which heights are the model's: those that it gives above the ground are found here. What draws, counts and picks takes such
    /// scenes; [`crate::figure`] asks for them itself.
    ///
    /// # Errors
    /// Where there is no ground.
    pub fn on_ground<'s>(&self, scene: &'s Scene) -> Result<Cow<'s, Scene>, RenderError> {
        // The index takes a moment to make: only where it is asked.
        let found = scene.on_ground(&|at| self.places().ground(at));
        let mut scene = found.map_err(|problem| RenderError::Scene(problem.to_string()))?;
        if let Some(sun) = self.sun_by_date(&scene)? {
            scene.to_mut().sun = sun;
        }
        Ok(scene)
    }

    /// The sun of a scene that says when it shines, standing where it does then.
    ///
    /// # Errors
    /// Where the city is, or the sun was, is not known; the scene has no moment.
    pub fn sun_by_date(&self, scene: &Scene) -> Result<Option<Sun>, RenderError> {
        let sun = scene.sun;
        let wrong = |message: String| RenderError::Scene(format!("[sun] {message}"));
        let moment = match sun.when {
            SunTime::Never => return Ok(None),
            SunTime::At(moment) => moment,
            SunTime::Scene => scene.shown_moment().ok_or_else(|| {
                wrong(
                    "follows_time: the scene has no moment; [time] at = \"2026-06-21T16:00\" would be right".to_owned(),
                )
            })?,
        };
        let site = match sun.place {
            Some(place) => Site::given(place.x, place.y),
            None => Site::of_model(self.file().crs.as_deref(), self.extent().center().truncate())
                .map_err(RenderError::Scene)?,
        };
        let offset_h = sun.utc_offset_h.unwrap_or_else(|| site.standard_offset_h());
        let SunPosition { azimuth, elevation } = site.sun(moment, offset_h).map_err(wrong)?;
        Ok(Some(Sun { azimuth, elevation, ..sun }))
    }

    /// The building that the eye of a scene is in, where its camera is given.
    pub fn building_around(&self, scene: &Scene) -> Option<u32> {
        let eye = scene.camera?.eye;
        let is_near = |g: &u32| {
            let geometry = &self.model.geometries[*g as usize];
            let class = self.model.objects[geometry.object as usize].class;
            class == ObjectClass::Building && geometry.bounds.distance_to(eye) == 0.0
        };
        // The index takes a moment to make: only where there may be an answer.
        self.geometries.iter().any(is_near).then(|| self.places().building_around(eye)).flatten()
    }

    /// How far the eye of a scene is below the ground, metres, where its camera is given and something near stands higher than it.
    pub fn eye_below_ground(&self, scene: &Scene) -> Option<f64> {
        const NEAR_M: f64 = 100.0;
        let eye = scene.camera?.eye;
        let stands_higher = |g: &u32| {
            let bounds = self.model.geometries[*g as usize].bounds;
            bounds.max.z > eye.z && bounds.distance_to(eye.with_z(eye.z.clamp(bounds.min.z, bounds.max.z))) < NEAR_M
        };
        let may_be = self.geometries.iter().any(stands_higher);
        let ground = may_be.then(|| self.places().ground(eye.truncate())).flatten()?;
        (ground > eye.z).then_some(ground - eye.z)
    }

    /// Box around the shown city, without the plain ground; empty for an empty city.
    pub fn extent(&self) -> Aabb {
        self.geometries.iter().fold(Aabb::EMPTY, |all, &g| all.union(self.file().geometries[g as usize].bounds))
    }

    /// The scene's camera, or a good first view of the city.
    pub fn camera(&self, scene: &Scene, size: [u32; 2]) -> Camera {
        scene.camera.unwrap_or_else(|| {
            // Tile by tile: the box of a long or slanting object is mostly empty. Terrain may leave the picture.
            let tiles_of = |wanted: &dyn Fn(bool) -> bool| -> Vec<Aabb> {
                let kept = self.geometries.iter().map(|&g| &self.file().geometries[g as usize]);
                kept.filter(|g| wanted(self.file().objects[g.object as usize].class.is_ground()))
                    .flat_map(|g| &self.file().tiles[g.tiles.start as usize..g.tiles.end as usize])
                    .map(|tile| tile.bounds)
                    .collect()
            };
            let mut boxes = tiles_of(&|is_ground| !is_ground);
            if boxes.is_empty() {
                boxes = tiles_of(&|_| true);
            }
            let mut extent = self.extent();
            if extent.is_empty() {
                // Volumes alone; whoever draws tells what is wrong with one.
                let volumes = self.known().fields.of_scene(&scene.volumes, &Epochs::default()).unwrap_or_default();
                extent = volumes.bounds();
                boxes = volumes.all.iter().map(|field| field.bounds()).collect();
            }
            first_view(&extent, &boxes, f64::from(size[0]) / f64::from(size[1]))
        })
    }

    /// Draws a picture, without text; [`crate::figure::draw`] adds what the scene's `[figure]` asks for.
    pub fn render(&mut self, scene: &Scene, request: &Request) -> Result<Picture, RenderError> {
        self.render_with(scene, request, &furniture::NONE)
    }

    /// Draws a picture and `furniture` over it; AOVs do not see it.
    pub fn render_with(
        &mut self,
        scene: &Scene,
        request: &Request,
        furniture: &Furniture,
    ) -> Result<Picture, RenderError> {
        let mut bands = Band::default();
        let picture = self.render_in_bands(scene, request, furniture, &mut |band| {
            bands.append(band);
            Ok(())
        })?;
        Ok(picture.with(bands))
    }

    /// The same, band by band from the top: `take` gets the pixels, and the picture that is answered has all but these. What is held at a time is one
    /// band: the height of a tile, where the picture is drawn in tiles ([`crate::render::settings::Settings::tile`]).
    ///
    /// # Errors
    /// Those of a picture; [`RenderError::Taken`] where `take` fails.
    pub fn render_in_bands(
        &mut self,
        scene: &Scene,
        request: &Request,
        furniture: &Furniture,
        take: &mut TakeBand,
    ) -> Result<Picture, RenderError> {
        let started = Instant::now();
        self.stand_at(scene);
        let drawn = scene.drawn();
        let resolved = self.resolve(&drawn, request.size, request.samples)?;
        let drawn_lenses = drawn.scene.lenses.len();
        let mut picture = Picture::empty(request, drawn_lenses);
        let mut passes: Vec<stats::Pass> = Vec::new();
        self.renderer.begin_picture();
        self.find_cities(&resolved, drawn.scene.style.facades)?;
        for row in self.tiling(request, &resolved).rows(request.size) {
            let Some(first) = row.first() else { continue };
            let size = [request.size[0], first.kept.size[1]];
            let mut band = DrawnBand::new(request, first.kept.origin[1], size, drawn_lenses);
            for part in row {
                let input = FrameInput { furniture, ..input(&drawn.scene, request, &resolved, part.drawn) };
                self.render_part(&drawn, request, input, part, &mut band, &mut picture, &mut passes)?;
            }
            band.count(&mut picture.class_counts);
            take(band.finished(request, &drawn, scene.lenses.len())).map_err(RenderError::Taken)?;
        }
        picture.open = diagnostics::open_shells(self, &resolved);
        picture.not_derived = diagnostics::not_derived(&resolved.contents);
        picture.weakened = resolved.deformations.weakened.clone();
        picture.deformed = self.renderer.deformed_figures();
        picture.unseen_volumes = resolved.fields.unseen(&self.extent());
        picture.folded = resolved.rays.folds();
        picture.rays = resolved.rays.clone();
        picture.without_glyph = diagnostics::without_glyph(furniture);
        if request.statistics {
            picture.statistics.handlers = handlers_that_ran(self.renderer.planned(), &resolved.operations, &picture);
        }
        picture.fold(&drawn, scene.lenses.len());
        diagnostics::messages(scene, &picture).iter().for_each(|message| log::warn!("{message}"));
        if request.statistics {
            picture.statistics = self.statistics(scene, &drawn, request, &resolved, &picture, passes);
            let frame = &mut picture.statistics.frame;
            frame.cpu_ms = started.elapsed().as_secs_f64() * 1e3;
            [frame.allocations, frame.uploads, frame.uploaded_bytes] = picture.made;
            let seen = visible_share::of_lenses(self, scene, request.size)?;
            picture.statistics.lenses.iter_mut().zip(seen).for_each(|(lens, seen)| lens.seen = seen);
        }
        Ok(picture)
    }

    /// Draws one sample of one frame without reading anything back: what a window does, and benchmarks.
    pub fn redraw(&mut self, scene: &Scene, size: [u32; 2]) -> Result<(), RenderError> {
        self.redraw_with(scene, size, &furniture::NONE)
    }

    /// The same with `furniture` over it. As long as that stays equal, nothing is set, allocated or uploaded again.
    pub fn redraw_with(&mut self, scene: &Scene, size: [u32; 2], furniture: &Furniture) -> Result<(), RenderError> {
        let request = Request { backend: self.backend, ..Request::plain(size) };
        self.draw_with(scene, &request, furniture, None).map(|_| ())
    }

    /// Draws a scene again as [`Self::redraw`] does, to its end; milliseconds by the GPU's clock, where it has one.
    ///
    /// # Errors
    /// What cannot be drawn.
    pub fn redraw_timed(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Option<f64>, RenderError> {
        let request = Request { backend: self.backend, ..Request::plain(size) };
        let mut timer = Timer::new(&self.renderer.gpu)?;
        self.draw_with(scene, &request, &furniture::NONE, Some(&mut timer))?;
        Ok(timer.read(&self.renderer.gpu)?.iter().map(|pass| pass.gpu_ms).sum())
    }

    /// Draws all samples of a picture that fits one target, without reading anything back; the passes that ran.
    pub fn draw(&mut self, scene: &Scene, request: &Request) -> Result<Vec<stats::Pass>, RenderError> {
        self.draw_with(scene, request, &furniture::NONE, None)
    }

    /// Draws all samples of a picture, part by part where it is large, and gives `after` the renderer after each; the passes that ran.
    pub(super) fn draw_parts(
        &mut self,
        scene: &Scene,
        request: &Request,
        furniture: &Furniture,
        most_triangles: Option<u64>,
        after: &mut dyn FnMut(&mut Renderer, Part),
    ) -> Result<Vec<stats::Pass>, RenderError> {
        self.stand_at(scene);
        let drawn = scene.drawn();
        let resolved = self.resolve(&drawn, request.size, request.samples)?;
        self.find_cities(&resolved, drawn.scene.style.facades)?;
        let mut passes = Vec::new();
        for part in self.tiling(request, &resolved).rows(request.size).into_iter().flatten() {
            let input = input(&drawn.scene, request, &resolved, part.drawn);
            let mut input = FrameInput { furniture, most_triangles, ..input };
            for sample in 0..input.samples {
                input.sample = sample;
                let mut records = self.renderer.draw(&input, None)?;
                // Lists that were too short are long enough the second time.
                if sample == 0 && (self.renderer.makes_room()? | self.renderer.sorts_longer()?) {
                    records = self.renderer.draw(&input, None)?;
                }
                collect(&mut passes, &records, &[], &drawn);
            }
            after(&mut self.renderer, part);
        }
        Ok(passes)
    }

    /// The passes that ran, of all samples; `timer` measures those of the first.
    fn draw_with(
        &mut self,
        scene: &Scene,
        request: &Request,
        furniture: &Furniture,
        mut timer: Option<&mut Timer>,
    ) -> Result<Vec<stats::Pass>, RenderError> {
        self.stand_at(scene);
        let drawn = scene.drawn();
        let resolved = self.resolve(&drawn, request.size, request.samples)?;
        let whole = PictureTile::whole(request.size);
        self.find_cities(&resolved, drawn.scene.style.facades)?;
        let mut input = FrameInput { furniture, ..input(&drawn.scene, request, &resolved, whole) };
        let mut passes = Vec::new();
        for sample in 0..input.samples {
            input.sample = sample;
            let records = self.renderer.draw(&input, timer.take())?;
            collect(&mut passes, &records, &[], &drawn);
        }
        Ok(passes)
    }

    /// The stored depth sprites of a lens in a picture of this size: none where it is not seen or not tested by one.
    pub fn sprites(&mut self, scene: &Scene, size: [u32; 2], lens: usize) -> Result<Vec<SpriteTexels>, RenderError> {
        self.redraw(scene, size)?;
        if self.renderer.makes_room()? {
            self.redraw(scene, size)?;
        }
        let drawn = scene.drawn();
        Ok(self.renderer.read_sprites(drawn.whole(lens as u32))?)
    }

    /// Puts the city on the GPU anew, with block models or without.
    fn set_city(&mut self, facades: bool, blocks: bool) -> Result<(), RenderError> {
        let (geometries, beside) = self.moving.drawn_still(self.is_still, &self.geometries);
        let model = self.stance.file(&self.model);
        let derived = || derive(model, geometries, &Derive { form: Form::Lod1, parts: true });
        let blocks = blocks.then(derived);
        let coplanar = coplanar_triangles(model, geometries);
        let ground = self.ground.as_deref();
        let shown = Shown { coplanar: &coplanar, ground, facades, beside, ..Shown::of(model, geometries) };
        self.renderer.set_city(&shown, blocks.as_ref().map(|blocks| &blocks.model))?;
        self.insets.clear();
        Ok(())
    }

    /// Puts contents of lenses on the GPU, edges the first time that something draws lines, and storeys and windows on walls where these are
    /// wanted.
    fn find_cities(&mut self, resolved: &Resolved, facades: bool) -> Result<(), RenderError> {
        let edges = resolved.operations.draws_lines();
        // Once something was asked to move it stays so: views of one picture, with moments and without, are drawn from one city.
        let is_other = resolved.operations.moves && !self.is_still;
        self.is_still |= is_other;
        let stale = self.renderer.city().filter(|city| is_other || city.has_facades != facades);
        let stale = stale.map(|city| city.has_blocks);
        if let Some(has_blocks) = stale {
            self.set_city(facades, has_blocks)?;
        }
        self.renderer.set_contents(&resolved.contents.wanted, self.ground.as_deref(), edges, facades)?;
        if self.renderer.has_edges() || !edges {
            return Ok(());
        }
        let (geometries, beside) = self.moving.drawn_still(self.is_still, &self.geometries);
        let (model, ground) = (self.stance.file(&self.model), self.ground.as_deref());
        let shown = Shown { ground, facades, beside, ..Shown::of(model, geometries) };
        Ok(self.renderer.set_edges(&shown)?)
    }

    /// Makes block models of all objects, once, for views that may show no more triangles than `most`, where
    /// the city has more. All insets are drawn again.
    pub(super) fn find_blocks(&mut self, most: u64) -> Result<(), RenderError> {
        let large = self.renderer.city().filter(|city| !city.has_blocks && city.triangles > most);
        let Some(facades) = large.map(|city| city.has_facades) else { return Ok(()) };
        let started = Instant::now();
        self.set_city(facades, true)?;
        log::info!("block models of {} objects in {:.0} ms", self.objects, started.elapsed().as_secs_f64() * 1e3);
        Ok(())
    }

    /// The WGSL of a module that runs where the scene's lenses are in the picture, or everywhere where none is.
    pub fn shader(
        &self,
        scene: &Scene,
        size: [u32; 2],
        backend: Backend,
        part: ShaderPart,
    ) -> Result<String, RenderError> {
        let drawn = scene.drawn();
        let resolved = self.resolve(&drawn, size, 1)?;
        let request = Request { backend, ..Request::plain(size) };
        let input = input(&drawn.scene, &request, &resolved, whole(size));
        Ok(self.renderer.shader(&input, &drawn.scene.lenses, part))
    }

    /// What the volumes of a scene show.
    ///
    /// # Errors
    /// A file that is none, or has not what is asked for.
    pub fn volumes(&self, scene: &Scene) -> Result<Vec<ShownVolume>, RenderError> {
        let epochs = Epochs::new(scene).map_err(RenderError::Scene)?;
        let at = epochs.own.first().and_then(|(moment, _)| *moment);
        self.known().fields.shown(&scene.volumes, at).map_err(RenderError::Scene)
    }

    /// The files that the volumes of a scene are read from, with those that they name.
    ///
    /// # Errors
    /// A file that is none.
    pub fn volume_files(&self, scene: &Scene) -> Result<Vec<PathBuf>, RenderError> {
        self.known().fields.files_of(&scene.volumes).map_err(RenderError::Scene)
    }

    /// The surroundings that scenes are resolved in.
    fn surroundings(&self) -> Surroundings<'_> {
        Surroundings {
            city: self.shown(),
            model: self.stance.file(&self.model),
            facts: self.renderer.cities().map(|cities| cities.facts()),
            footprints: &self.footprints,
            reading: &self.reading,
            lifetimes: &self.lifetimes,
            moving: &self.moving,
            is_still: self.is_still,
        }
    }

    /// What stays from scene to scene.
    pub(super) fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How a picture is cut.
    fn tiling(&self, request: &Request, resolved: &Resolved) -> Tiling {
        let masks = request.statistics || request.aovs.lens_mask;
        let words = resolved.volumes.iter().map(|volume| 1 + u64::from(volume.lens) / 32).max().unwrap_or(0);
        let longest = f64::from(request.size[0].max(request.size[1]));
        let of_sprite = |volume: &LensVolume| {
            let sprite = volume.sprite.filter(|sprite| sprite.own.is_none())?;
            let share = sprite.resolution.map_or(1.0, |side| f64::from(side) / longest);
            let layers = if sprite.aggregate { 1 } else { sprite.layers };
            Some((f64::from(layers * sprite.format.bits()) / 4.0 * share * share) as u64)
        };
        let bytes = PIXEL_BYTES
            + if request.samples > 1 { 16 } else { 0 }
            + if masks { 3 * 4 * words } else { 0 }
            + resolved.operations.filter_count() * FILTER_BYTES
            + resolved.volumes.iter().filter_map(of_sprite).sum::<u64>();
        self.renderer.tiling(bytes, resolved.operations.reach())
    }

    /// What a scene is in a picture of this size and so many samples.
    fn resolve(&self, drawn: &Drawn, size: [u32; 2], samples: u32) -> Result<Resolved, RenderError> {
        let camera = self.camera(&drawn.scene, size);
        let mut resolved = self.surroundings().resolve(drawn, &camera, size, samples, &mut self.known())?;
        let scene = &*drawn.scene;
        for (number, moment) in resolved.operations.suns.iter().enumerate() {
            let then = Scene { moment: *moment, time_steps: Vec::new(), ..scene.clone() };
            let sun = self.sun_by_date(&then)?.unwrap_or(scene.sun);
            resolved.suns.push((sun, resolved.operations.under_sun(number)));
        }
        Ok(resolved)
    }

    /// Which lenses of the scene can be seen in a picture of this size: enabled, with a volume that meets it.
    pub fn lenses_in_view(&self, scene: &Scene, size: [u32; 2]) -> Result<Vec<bool>, RenderError> {
        let camera = self.camera(scene, size);
        let volumes = self.lens_volumes(scene, size)?;
        let view = View::new(camera, size, &Aabb::EMPTY)?;
        let mut seen = vec![false; scene.lenses.len()];
        for volume in volumes.iter().filter(|v| v.seen_part(&view, whole(size)).is_some()) {
            seen[volume.lens as usize] = true;
        }
        Ok(seen)
    }

    /// What lenses show of earlier states of the city beside it in a picture of this size: each data set with its objects that are shown.
    ///
    /// # Errors
    /// Those of a picture.
    pub fn shown_beside(&self, scene: &Scene, size: [u32; 2]) -> Result<Vec<ShownObjects>, RenderError> {
        let drawn = scene.drawn();
        let is_beside = |lens: u32| {
            let content = drawn.scene.lenses.get(lens as usize).and_then(|lens| lens.content());
            content.is_some_and(|content| content.only.is_some())
        };
        let mut found: Vec<ShownObjects> = Vec::new();
        if !(0..drawn.scene.lenses.len() as u32).any(is_beside) {
            return Ok(found);
        }
        let contents = self.resolve(&drawn, size, 1)?.contents;
        for used in contents.uses.iter().filter(|used| is_beside(used.lens)) {
            let Some(city) = contents.of_lens(used.lens).and_then(|shown| shown.city.as_ref()) else { continue };
            let geometries = if city.is_derived() { &city.made_of.0 } else { &city.geometries };
            let objects = geometries.iter().map(|&g| city.source.geometries[g as usize].object);
            match found.iter_mut().find(|known| Arc::ptr_eq(&known.model, &city.source)) {
                Some(known) => known.objects.extend(objects),
                None => found.push(ShownObjects { model: city.source.clone(), objects: objects.collect() }),
            }
        }
        for shown in &mut found {
            shown.objects.sort_unstable();
            shown.objects.dedup();
        }
        Ok(found)
    }

    /// The volumes of the scene's enabled lenses where they stand in a picture of this size.
    pub fn lens_volumes(&self, scene: &Scene, size: [u32; 2]) -> Result<Vec<LensVolume>, RenderError> {
        let (drawn, camera) = (scene.drawn(), self.camera(scene, size));
        let mut volumes = self.surroundings().volumes(&drawn, &camera, size, &mut self.known())?;
        volumes.iter_mut().for_each(|volume| volume.lens = drawn.owner(volume.lens));
        Ok(volumes)
    }

    /// How the city is shown in a picture of a scene of this size, in the world.
    ///
    /// # Errors
    /// What a deformation lens cannot do.
    pub fn moved(&self, scene: &Scene, size: [u32; 2]) -> Result<Moved, RenderError> {
        let drawn = scene.drawn();
        let camera = self.camera(&drawn.scene, size);
        Ok(self.surroundings().deformations(&drawn.scene, &camera, &mut self.known())?.moved)
    }

    /// What moves the city in a picture of a scene of this size, in the world; none where nothing does.
    ///
    /// # Errors
    /// What a deformation lens cannot do.
    pub fn deformers(&self, scene: &Scene, size: [u32; 2]) -> Result<Arc<Deformers>, RenderError> {
        self.moved(scene, size).map(|moved| moved.deformers)
    }

    #[allow(clippy::too_many_arguments, reason = "one part of a picture; the arguments are the picture's own")]
    fn render_part(
        &mut self,
        drawn: &Drawn,
        request: &Request,
        mut input: FrameInput,
        part: Part,
        band: &mut DrawnBand,
        picture: &mut Picture,
        passes: &mut Vec<stats::Pass>,
    ) -> Result<(), RenderError> {
        for sample in 0..input.samples {
            if sample > 0 && self.interrupt.load(Ordering::Relaxed) {
                return Err(RenderError::Interrupted);
            }
            input.sample = sample;
            let mut timer =
                if request.statistics && sample == 0 { Some(Timer::new(&self.renderer.gpu)?) } else { None };
            let made = |gpu: &Gpu| [gpu.allocations(), gpu.uploads(), gpu.uploaded_bytes()];
            let before = made(&self.renderer.gpu);
            let mut records = self.renderer.draw(&input, timer.as_mut())?;
            // Later samples are added to those before; they meet about as many crossings.
            if sample == 0 && (self.renderer.makes_room()? | self.renderer.sorts_longer()?) {
                timer = timer.map(|_| Timer::new(&self.renderer.gpu)).transpose()?;
                records = self.renderer.draw(&input, timer.as_mut())?;
            }
            let layers = self.renderer.layer_figures();
            picture.layers.nodes += layers.nodes;
            picture.layers.bands += layers.bands;
            picture.layers.excess += layers.excess;
            picture.method.add(&self.renderer.method_figures());
            picture.traced.add(self.renderer.traced_figures());
            let after = made(&self.renderer.gpu);
            picture.made.iter_mut().zip(after).zip(before).for_each(|((all, after), before)| *all += after - before);
            if sample == 0 {
                band.read_aovs(&self.renderer, &input.view, part)?;
                if records.iter().any(|r| r.name == CLEAR_MASKS) {
                    band.read_masks(&self.renderer, drawn.scene.lenses.len(), part)?;
                }
                for (lens, rays) in self.renderer.read_excess(part.kept.origin == [0, 0])? {
                    *picture.excess.entry(lens).or_default() += rays;
                }
            }
            if request.statistics {
                let measures = timer.map(|t| t.read(&self.renderer.gpu)).transpose()?.unwrap_or_default();
                collect(passes, &records, &measures, drawn);
            }
        }
        Ok(band.read_picture(&self.renderer, part)?)
    }

    #[allow(clippy::too_many_arguments, reason = "all that a picture was made of")]
    fn statistics(
        &self,
        scene: &Scene,
        drawn: &Drawn,
        request: &Request,
        resolved: &Resolved,
        picture: &Picture,
        passes: Vec<stats::Pass>,
    ) -> Statistics {
        let gpu = &self.renderer.gpu;
        let pipelines = self.renderer.pipelines();
        let city = self.renderer.city();
        let mut seen = vec![false; scene.lenses.len()];
        let is_seen = |v: &&LensVolume| v.seen_part(&resolved.view, whole(request.size)).is_some();
        resolved.volumes.iter().filter(is_seen).for_each(|v| seen[drawn.owner(v.lens) as usize] = true);
        let pois = scene.standing_pois();
        let stands = self.stands(scene, &resolved.deformations.moved, &pois);
        let of = FiguresOf { scene, drawn, resolved, city: self.shown(), seen: &seen };
        let narrowing = pipelines.narrowing;
        let compiled = pipelines.compiled + u32::from(narrowing == Some(true));
        let names: Vec<String> = pipelines.used.iter().map(|key| key.name()).collect();
        let names: Vec<String> = names.into_iter().chain(narrowing.map(|_| "narrow lists".to_owned())).collect();
        Statistics {
            adapter: stats::Adapter {
                name: gpu.info.name.clone(),
                backend: format!("{:?}", gpu.info.backend).to_lowercase(),
                kind: gpu.kind().to_owned(),
            },
            load: stats::Load { peak_bytes: stats::peak_memory(), ..self.load.clone() },
            city: stats::City {
                objects: self.objects,
                triangles: city.map_or(0, |c| c.triangles),
                vertices: city.map_or(0, |c| c.vertices),
                gpu_bytes: city.map_or(0, |c| c.bytes),
            },
            frame: stats::Frame {
                gpu_ms: passes.iter().map(|p| p.gpu_ms).sum(),
                samples: request.samples,
                peak_gpu_bytes: gpu.allocated_bytes(),
                layers: (picture.layers.bands > 0).then_some(stats::Layers {
                    fragments: picture.layers.nodes,
                    bands: picture.layers.bands,
                    missing: picture.layers.excess,
                    method: scene.style.transparency.word(),
                    gpu_bytes: picture.method.bytes,
                    rounds: picture.method.rounds,
                    merged: picture.method.merged,
                    dropped: picture.method.dropped,
                }),
                traced: (picture.traced.rays > 0)
                    .then_some(stats::Traced { rays: picture.traced.rays, ms: picture.traced.ms }),
                deformed: picture.deformed.map(|of| stats::Deformed {
                    met: of.met,
                    triangles: of.triangles,
                    tolerance_px: of.report.tolerance_px,
                    coarse: of.report.too_coarse as u64,
                }),
                ..Default::default()
            },
            pipelines: stats::Pipelines { compiled, reused: names.len() as u32 - compiled, names },
            handlers: picture.statistics.handlers.clone(),
            lenses: (0..scene.lenses.len())
                .map(|i| stats::LensFigures {
                    occluders: self.occluders(&stands, &scene.lenses[i], &resolved.view).map(|mut all| {
                        let own = resolved.volumes.iter().filter(|volume| drawn.owner(volume.lens) == i as u32);
                        let leaves = own.flat_map(|volume| volume.region.leaves());
                        all.extend(resolved.fields.told(leaves.map(|leaf| &leaf.leaf), resolved.view.camera.eye));
                        all
                    }),
                    over_time: self.over_time(&stands, &scene.lenses[i], &resolved.view),
                    ..lens_figures(of, picture, i)
                })
                .collect(),
            contents: resolved.contents.figures(drawn, self.shown(), |id| self.renderer.content_city(id)),
            overlays: Vec::new(),
            warnings: self.warnings().into_iter().chain(diagnostics::warnings(scene, picture)).collect(),
            passes,
        }
    }

    fn warnings(&self) -> Vec<serde_json::Value> {
        let warning = |(code, w): (crate::city::WarningCode, &crate::city::warning::Warning)| serde_json::json!({ "code": code.code(), "count": w.count, "objects": w.objects, "message": w.message });
        self.model.warnings.iter().map(warning).collect()
    }
}

fn input<'a>(scene: &Scene, request: &Request, resolved: &'a Resolved, tile: PictureTile) -> FrameInput<'a> {
    FrameInput {
        view: resolved.view,
        tile,
        sun: scene.sun,
        base: scene.style.base,
        look: scene.style.look,
        background: scene.style.background,
        technique: scene.style.technique,
        transparency: scene.style.transparency,
        transparent: request.transparent,
        haze: HAZE,
        volumes: &resolved.volumes,
        rays: &resolved.rays,
        fields: &resolved.fields,
        solids: &resolved.solids,
        lens_count: scene.lenses.len() as u32,
        operations: &resolved.operations,
        backend: request.backend,
        measured: request.aovs.depth,
        shown: request.aovs.object_id || request.aovs.normal,
        masks: request.statistics || request.aovs.lens_mask,
        sample: 0,
        samples: request.samples.max(1),
        suns: &resolved.suns,
        sun_of: [0, 1],
        screen_occlusion: request.screen_occlusion,
        moved: &resolved.deformations.moved,
        chord_px: scene.style.chord_px,
        furniture: &furniture::NONE,
        most_triangles: None,
    }
}

impl Picture {
    /// The same with the pixels of bands.
    fn with(self, bands: Band) -> Self {
        let Band { rgba, depth, object_id, normal, lens_mask, .. } = bands;
        Self { rgba, depth, object_id, normal, lens_mask, ..self }
    }

    /// One without pixels, of which nothing is known yet.
    fn empty(request: &Request, drawn_lenses: usize) -> Self {
        let counted = if request.statistics { drawn_lenses } else { 0 };
        Self { size: request.size, class_counts: vec![ClassCounts::default(); counted], ..Self::default() }
    }
}

fn collect(passes: &mut Vec<stats::Pass>, records: &[PassRecord], measures: &[crate::gpu::PassMeasure], drawn: &Drawn) {
    for record in records {
        let measure = record.slot.and_then(|slot| measures.get(slot)).copied().unwrap_or_default();
        passes.push(stats::Pass {
            name: record.name.to_owned(),
            view: record.view.to_owned(),
            serves: match &record.lenses[..] {
                [] => serde_json::json!("scene"),
                lenses => {
                    let mut owners: Vec<u32> = lenses.iter().map(|lens| drawn.owner(*lens)).collect();
                    owners.dedup();
                    serde_json::json!(owners)
                }
            },
            draws: record.draws,
            triangles: record.triangles,
            pixels: measure.pixels,
            gpu_ms: measure.gpu_ms,
        });
    }
}
