//! Threads that load and draw: whatever that takes, the window goes on.
//!
//! ```text
//!   window ── open ──▶ loader ── city ──┐
//!      │                                ▼
//!      ├── draw (the latest one counts) ─▶ render thread ── frames, pictures written, failures ──▶ window
//!      └── export ──────────────────────▶
//! ```

use std::{
    any::Any,
    collections::{BTreeMap, BTreeSet, VecDeque},
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread::JoinHandle,
    time::Instant,
};

use crate::{
    app::user_effects::{self, Watch},
    city::{
        CityModel, Lod, facts,
        ground::Ground,
        load::{self, LoadOptions, LoadStats, Stage},
        spatial::SpatialIndex,
    },
    figure::{
        self,
        furniture::em_px,
        overlays::Standing,
        paper::{self, Format, Target},
        picture::Notes,
    },
    geom::Aabb,
    gpu::{Gpu, GpuError},
    lens::{ray_path::RayPaths, thematic::attribute_names},
    render::{
        fields::ShownVolume,
        picture::{Aovs, RenderError, Request, ShownOverlay, Studio},
        stats::{self, Statistics},
    },
    scene::{CitySpec, DEFAULT_SAMPLES, Scene},
    shader::effect,
    view::View,
};

/// Samples per pixel of a picture that stands still: as many as a figure has.
const SAMPLES: u32 = DEFAULT_SAMPLES;
/// While something moves, milliseconds that a picture may take, a little less than what 20 frames a second leave.
const MOVING_MS: f64 = 45.0;
/// The parts of the width and height that pictures are drawn at meanwhile: each has half the pixels of the one before. Steps, since overlays
/// keep still in pictures of one size only.
const SCALES: [f64; 5] = [1.0, 0.707, 0.5, 0.354, 0.25];
/// A picture is finer again once it takes no more than this part of what it may: of twice the pixels it does then, too.
const QUICK: f64 = 0.4;

/// A picture to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Width and height, pixels, each at least 1.
    pub size: [u32; 2],
    /// The width and height of the picture whose pixels the scene's lengths are meant for; of the same shape.
    pub meant_for: [u32; 2],
    /// Whether the next one follows soon: it shall be quick rather than good.
    pub is_moving: bool,
    /// Whether it says what it cost.
    pub is_measured: bool,
}

impl Draw {
    /// The scene as it is drawn in a picture of this size, pixels: what it gives in pixels keeps its share, and what moves has no shadows where
    /// pictures have to be quick.
    pub fn scene_at(&self, size: [u32; 2]) -> Scene {
        let factor = f64::from(size[0]) / f64::from(self.meant_for[0]).max(1.0);
        let em = f64::from(em_px(&self.scene.figure, self.meant_for));
        // At its own size it is to be what is exported.
        let mut scene = if factor == 1.0 { (*self.scene).clone() } else { self.scene.sized(factor, em) };
        scene.sun.shadows &= !self.is_moving || size == self.size;
        scene
    }
}

/// A picture to write.
#[derive(Clone, Debug)]
pub struct Export {
    /// The scene, with size and samples.
    pub scene: Arc<Scene>,
    /// Where to.
    pub file: PathBuf,
    /// The metadata of the file.
    pub notes: Notes,
    /// Whether it is the figure of the scene, which a command makes again.
    pub is_of_scene: bool,
}

/// A reply of the threads.
#[derive(Debug)]
pub enum Reply {
    /// The stage of loading, in words.
    Loading(String),
    /// A city is there.
    Opened(Box<Opened>),
    /// It could not be loaded, or not be put on the GPU; what was there before still is.
    NotOpened(String),
    /// A picture.
    Frame(Box<Frame>),
    /// A scene could not be drawn.
    NotDrawn(String),
    /// A picture was written; whether it is the figure of the scene.
    Exported(PathBuf, bool),
    /// A picture was not.
    NotExported(String),
    /// A user's effect was read, and is called so.
    Effect(String),
    /// A user's effect file is wrong: the version before stays.
    NotEffect(String),
}

/// A city that can be drawn.
#[derive(Debug)]
pub struct Opened {
    /// The city.
    pub model: Arc<CityModel>,
    /// For each object the one that it is part of, or itself.
    pub roots: Vec<u32>,
    /// Names of attributes that objects have, sorted.
    pub attributes: Vec<String>,
    /// Types of objects that are part of no other, with how many there are, sorted.
    pub types: Vec<(String, usize)>,
    /// Levels of detail that there are, the coarsest first.
    pub levels: Vec<String>,
    /// The geometries that are shown, by index.
    pub geometries: Vec<u32>,
    /// Finds what is shown along a ray, once that is known: after the first picture.
    pub index: Arc<OnceLock<SpatialIndex>>,
    /// The plain ground under it.
    pub ground: Option<Arc<Ground>>,
    /// Around what is shown, metres; empty for an empty city.
    pub extent: Aabb,
    /// Kinds of warnings about its files.
    pub warnings: Vec<String>,
    /// The adapter that draws.
    pub adapter: String,
    /// Whether that is the processor.
    pub is_software: bool,
}

/// A picture, and what it shows.
#[derive(Debug)]
pub struct Frame {
    /// The scene that it shows.
    pub scene: Arc<Scene>,
    /// The eye.
    pub view: View,
    /// Rows of sRGB texels, the upper left first; as many as `view.size` says.
    pub rgba: Vec<[u8; 4]>,
    /// For each pixel the object's index + 1 and metres along the view axis (+∞: nothing); only of pictures that stand still.
    pub shown: Option<(Vec<u32>, Vec<f32>)>,
    /// How lenses bend rays in it.
    pub rays: RayPaths,
    /// What its volumes show.
    pub volumes: Vec<ShownVolume>,
    /// Where overlays stand in it; only of pictures that stand still.
    pub overlays: Vec<ShownOverlay>,
    /// Samples per pixel.
    pub samples: u32,
    /// Whether the next one of the same scene is better.
    pub is_final: bool,
    /// Its cost, where that was asked for.
    pub statistics: Option<Box<Statistics>>,
    /// The time that it took, milliseconds.
    pub ms: f64,
}

/// The work that is wanted of the render thread.
#[derive(Default)]
struct Wanted {
    city: Option<Loaded>,
    exports: VecDeque<Export>,
    draw: Option<Draw>,
    /// Effect files that changed.
    effects: Vec<PathBuf>,
    quits: bool,
}

struct Loaded {
    model: CityModel,
    spec: CitySpec,
    reading: LoadOptions,
    stats: LoadStats,
}

/// The state that both sides share.
#[derive(Default)]
struct Shared {
    wanted: Mutex<Wanted>,
    wake: Condvar,
    interrupt: Arc<AtomicBool>,
    /// Which opening is the last one.
    opening: AtomicU64,
    /// A user's effect files.
    watch: Mutex<Watch>,
}

impl Shared {
    fn wanted(&self) -> MutexGuard<'_, Wanted> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn want(&self, change: impl FnOnce(&mut Wanted)) {
        change(&mut self.wanted());
        self.interrupt.store(true, Ordering::Relaxed);
        self.wake.notify_all();
    }
}

/// Says that a reply is there.
pub type Notify = Arc<dyn Fn() + Send + Sync>;

/// The window's side.
pub struct RenderThread {
    shared: Arc<Shared>,
    sender: Sender<Reply>,
    replies: Receiver<Reply>,
    notify: Notify,
    thread: Option<JoinHandle<()>>,
}

impl std::fmt::Debug for RenderThread {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RenderThread").finish_non_exhaustive()
    }
}

impl RenderThread {
    /// Begins to wait for work.
    ///
    /// # Errors
    /// The system has no thread left.
    pub fn new(notify: Notify) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, replies) = channel();
        let mut own = Worker::new(shared.clone(), sender.clone(), notify.clone());
        let thread = std::thread::Builder::new().name("render".into()).spawn(move || own.work())?;
        Ok(Self { shared, sender, replies, notify, thread: Some(thread) })
    }

    /// Loads a city; what is being loaded is forgotten. The one that is shown stays until the new one is there.
    pub fn open(&self, spec: CitySpec, reading: LoadOptions) {
        let number = self.shared.opening.fetch_add(1, Ordering::SeqCst) + 1;
        let (shared, sender, notify) = (self.shared.clone(), self.sender.clone(), self.notify.clone());
        let tell = move |reply| {
            let _ = sender.send(reply);
            notify();
        };
        let failed = tell.clone();
        let load = move || {
            let replies = LoadingReplies { shared: &shared, number, tell: &tell };
            let loaded = catch_unwind(AssertUnwindSafe(|| {
                beside_the_window(|| load::load_with_stats(&spec.files, &reading, &replies))
            }));
            if shared.opening.load(Ordering::SeqCst) != number {
                return;
            }
            match loaded {
                Ok(Ok((model, stats))) => {
                    shared.want(|wanted| wanted.city = Some(Loaded { model, spec, reading, stats }));
                }
                Ok(Err(error)) => tell(Reply::NotOpened(error.to_string())),
                Err(panic) => tell(Reply::NotOpened(our_mistake(&*panic))),
            }
        };
        if let Err(error) = std::thread::Builder::new().name("loader".into()).spawn(load) {
            failed(Reply::NotOpened(format!("no thread to load with: {error}")));
        }
    }

    /// Forgets what is being loaded: it goes on to the end of its stage, at most.
    pub fn cancel_opening(&self) {
        self.shared.opening.fetch_add(1, Ordering::SeqCst);
        self.shared.wanted().city = None;
    }

    /// Draws this next, and not what was wanted before.
    pub fn draw(&self, draw: Draw) {
        self.shared.want(|wanted| wanted.draw = Some(draw));
    }

    /// Writes a picture.
    pub fn export(&self, export: Export) {
        self.shared.want(|wanted| wanted.exports.push_back(export));
    }

    /// Reads effect files, and those of folders, again whenever they change; `are_read`: they are known as they are now.
    pub fn watch(&self, places: &[PathBuf], are_read: bool) {
        let is_first = {
            let mut watch = self.shared.watch.lock().unwrap_or_else(PoisonError::into_inner);
            let is_first = watch.is_empty();
            match are_read {
                true => watch.add_read(places),
                false => watch.add(places),
            }
            is_first && !watch.is_empty()
        };
        if !is_first {
            return;
        }
        let shared = self.shared.clone();
        let look = move || {
            while !shared.wanted().quits {
                let changed = shared.watch.lock().unwrap_or_else(PoisonError::into_inner).changed();
                if !changed.is_empty() {
                    shared.want(|wanted| wanted.effects.extend(changed));
                }
                std::thread::sleep(user_effects::EVERY);
            }
        };
        if let Err(error) = std::thread::Builder::new().name("effects".into()).spawn(look) {
            log::warn!("effects are not read again: no thread to look at them with: {error}");
        }
    }

    /// The replies since the last call.
    pub fn replies(&self) -> Vec<Reply> {
        self.replies.try_iter().collect()
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.shared.opening.fetch_add(1, Ordering::SeqCst);
        self.shared.want(|wanted| wanted.quits = true);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Says what loading is at.
struct LoadingReplies<'a, F: Fn(Reply)> {
    shared: &'a Shared,
    number: u64,
    tell: &'a F,
}

impl<F: Fn(Reply) + Sync> load::Progress for LoadingReplies<'_, F> {
    fn is_cancelled(&self) -> bool {
        self.shared.opening.load(Ordering::SeqCst) != self.number
    }

    fn enter(&self, stage: Stage, file: usize, files: usize, path: &Path) {
        if self.is_cancelled() {
            return;
        }
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let which = if files > 1 && file < files { format!(" ({} of {files})", file + 1) } else { String::new() };
        (self.tell)(Reply::Loading(match stage {
            Stage::Read => format!("Reading {name}{which}"),
            Stage::Parse => format!("Parsing {name}{which}"),
            Stage::Build => "Triangulating".to_owned(),
        }));
    }
}

fn types_of(model: &CityModel) -> Vec<(String, usize)> {
    let mut all: BTreeMap<&str, usize> = BTreeMap::new();
    for object in model.objects.iter().filter(|object| object.parents.is_empty()) {
        *all.entry(model.strings.get(object.kind)).or_default() += 1;
    }
    all.into_iter().map(|(name, count)| (name.to_owned(), count)).collect()
}

fn levels_of(model: &CityModel) -> Vec<String> {
    let all: BTreeSet<String> = model
        .geometries
        .iter()
        .map(|geometry| geometry.lod)
        .filter(|lod| *lod != Lod::NONE)
        .map(|lod| lod.to_string())
        .collect();
    all.into_iter().collect()
}

/// The same city on another device.
fn renewed(studio: &Studio, spec: &CitySpec) -> Result<Studio, RenderError> {
    let mut again = Studio::new(Gpu::open()?, studio.file().clone(), spec)?;
    (again.reading, again.load) = (studio.reading.clone(), studio.load.clone());
    again.interrupt = studio.interrupt.clone();
    Ok(again)
}

/// The message about a panic, with what people can do.
fn our_mistake(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    format!("this is a mistake of Veduta itself, please report it: {}", text.unwrap_or("it does not say which"))
}

/// Leaves one processor to the window.
fn beside_the_window<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let all = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    match rayon::ThreadPoolBuilder::new().num_threads((all - 1).max(1)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// The next thing to do.
enum Task {
    City(Box<Loaded>),
    Effects(Vec<PathBuf>),
    Export(Export),
    Draw(Draw),
    /// The last picture, better.
    Refine(Draw),
    Quit,
}

/// The side of the thread.
struct Worker {
    shared: Arc<Shared>,
    sender: Sender<Reply>,
    notify: Notify,
    studio: Option<Studio>,
    spec: CitySpec,
    /// Where overlays stand, and in pictures of which size.
    standing: (Standing, [u32; 2]),
    /// A picture that could be drawn better once nothing else is wanted.
    refine: Option<Draw>,
    /// Which of [`SCALES`].
    scale: usize,
}

impl Worker {
    fn new(shared: Arc<Shared>, sender: Sender<Reply>, notify: Notify) -> Self {
        Self {
            shared,
            sender,
            notify,
            studio: None,
            spec: CitySpec::default(),
            standing: Default::default(),
            refine: None,
            scale: 0,
        }
    }

    fn tell(&self, reply: Reply) {
        let _ = self.sender.send(reply);
        (self.notify)();
    }

    fn next(&mut self) -> Task {
        let mut wanted = self.shared.wanted();
        loop {
            self.shared.interrupt.store(false, Ordering::Relaxed);
            if wanted.quits {
                return Task::Quit;
            }
            if let Some(city) = wanted.city.take() {
                return Task::City(Box::new(city));
            }
            if !wanted.effects.is_empty() {
                return Task::Effects(std::mem::take(&mut wanted.effects));
            }
            if self.studio.is_some() {
                if let Some(draw) = wanted.draw.take() {
                    return Task::Draw(draw);
                }
                if let Some(export) = wanted.exports.pop_front() {
                    return Task::Export(export);
                }
                if let Some(draw) = self.refine.take() {
                    return Task::Refine(draw);
                }
            }
            wanted = self.shared.wake.wait(wanted).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn work(&mut self) {
        loop {
            match self.next() {
                Task::Quit => return,
                Task::City(city) => self.guarded(|own| own.set_up(*city)),
                Task::Effects(files) => self.guarded(|own| own.take_effects(&files)),
                Task::Export(export) => self.guarded(|own| own.write(&export)),
                Task::Draw(draw) => self.guarded(|own| own.frame(draw, false)),
                Task::Refine(draw) => self.guarded(|own| own.frame(draw, true)),
            }
        }
    }

    /// A mistake of ours is reported, and the next picture is drawn with all things new.
    fn guarded(&mut self, work: impl FnOnce(&mut Self)) {
        let Err(panic) = catch_unwind(AssertUnwindSafe(|| work(self))) else { return };
        (self.refine, self.standing) = (None, Default::default());
        self.studio = self.studio.take().and_then(|studio| renewed(&studio, &self.spec).ok());
        self.tell(Reply::NotDrawn(our_mistake(&*panic)));
    }

    fn set_up(&mut self, city: Loaded) {
        self.tell(Reply::Loading("Putting the city on the graphics card".to_owned()));
        let Loaded { model, spec, reading, stats } = city;
        let model = Arc::new(model);
        let opened = Gpu::open().map_err(RenderError::from).and_then(|gpu| Studio::new(gpu, model.clone(), &spec));
        let mut studio = match opened {
            Ok(studio) => studio,
            Err(error) => return self.tell(Reply::NotOpened(error.to_string())),
        };
        studio.reading = reading;
        studio.interrupt = self.shared.interrupt.clone();
        let ms = |stage: &str, time: std::time::Duration| (stage.to_owned(), time.as_secs_f64() * 1e3);
        studio.load = stats::Load {
            ms: [ms("read", stats.read), ms("parse", stats.parse), ms("build", stats.build)].into_iter().collect(),
            peak_bytes: stats::peak_memory(),
        };
        let nothing = facts::nothing_drawn(&model, &studio.geometries);
        let nothing = nothing.map(|why| format!("Nothing of the city is drawn: {why}."));
        let others = facts::warning_facts(&model);
        let warnings = nothing.into_iter().chain(others.iter().map(|warning| warning.message.clone())).collect();
        let gpu = &studio.renderer.gpu;
        let opened = Opened {
            roots: model.roots(),
            attributes: attribute_names(&model).into_iter().map(str::to_owned).collect(),
            types: types_of(&model),
            levels: levels_of(&model),
            geometries: studio.geometries.clone(),
            index: studio.index().clone(),
            ground: studio.ground.clone(),
            extent: studio.extent(),
            warnings,
            adapter: gpu.name(),
            is_software: gpu.is_software(),
            model,
        };
        (self.spec, self.standing, self.refine, self.scale) = (spec, Default::default(), None, 0);
        self.studio = Some(studio);
        self.tell(Reply::Opened(Box::new(opened)));
    }

    /// Between pictures: none has two versions of an effect.
    fn take_effects(&mut self, files: &[PathBuf]) {
        for file in files {
            let name = file.display().to_string();
            let text = std::fs::read_to_string(file).map_err(|error| format!("{name}: {error}"));
            let taken = text.and_then(|text| effect::replace(&name, &text).map_err(|error| error.to_string()));
            if let (Ok(_), Some(studio)) = (&taken, &mut self.studio) {
                studio.renderer.forget_shaders();
            }
            self.tell(match taken {
                Ok(name) => Reply::Effect(name),
                Err(error) => Reply::NotEffect(error),
            });
        }
    }

    /// A GPU that went away is asked for once more, before that is reported.
    fn with_studio<T>(
        &mut self,
        work: impl Fn(&mut Studio, &mut Standing) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let Some(studio) = &mut self.studio else { return Err(RenderError::Scene("there is no city".into())) };
        match work(studio, &mut self.standing.0) {
            Err(RenderError::Gpu(error @ GpuError::Failed { .. })) => {
                log::warn!("{error}; trying anew");
                *studio = renewed(studio, &self.spec)?;
                work(studio, &mut self.standing.0)
            }
            done => done,
        }
    }

    fn frame(&mut self, draw: Draw, is_refined: bool) {
        let started = Instant::now();
        let scale = if draw.is_moving { SCALES[self.scale] } else { 1.0 };
        let size = draw.size.map(|side| ((f64::from(side) * scale).round() as u32).max(1));
        let scene = draw.scene_at(size);
        let still = !draw.is_moving && !is_refined;
        let request = Request {
            samples: if is_refined { SAMPLES } else { 1 },
            aovs: Aovs { depth: still, object_id: still, ..Aovs::default() },
            statistics: still && draw.is_measured,
            screen_occlusion: true,
            ..Request::plain(size)
        };
        if self.standing.1 != size {
            self.standing = (Standing::default(), size);
        }
        let drawn = self.with_studio(|studio, standing| {
            let scene = studio.on_ground(&scene)?;
            let picture = figure::draw_next(studio, &scene, &request, standing)?;
            let view = View::new(studio.camera(&scene, size), size, &Aabb::EMPTY)?;
            let volumes = studio.volumes(&scene)?;
            Ok((picture, view, volumes))
        });
        let (picture, view, volumes) = match drawn {
            Ok(drawn) => drawn,
            // Something else is wanted before; if that is no other picture, this one goes on later.
            Err(RenderError::Interrupted) => return self.refine = Some(draw),
            Err(error) => return self.tell(Reply::NotDrawn(error.to_string())),
        };
        let ms = started.elapsed().as_secs_f64() * 1e3;
        if draw.is_moving {
            // One step at a time, or one slow picture would be followed by coarse ones.
            if ms > MOVING_MS {
                self.scale = (self.scale + 1).min(SCALES.len() - 1);
            } else if ms < QUICK * MOVING_MS {
                self.scale = self.scale.saturating_sub(1);
            }
        }
        if is_refined && let Some(studio) = &self.studio {
            // For a person that walks.
            studio.find_triangles();
        }
        self.refine = still.then(|| draw.clone());
        self.tell(Reply::Frame(Box::new(Frame {
            scene: draw.scene,
            view,
            rgba: picture.rgba,
            overlays: picture.overlays,
            rays: picture.rays,
            volumes,
            shown: picture.object_id.zip(picture.depth),
            samples: request.samples,
            is_final: is_refined,
            statistics: request.statistics.then(|| Box::new(picture.statistics)),
            ms,
        })));
    }

    fn write(&mut self, export: &Export) {
        let Export { scene, file, notes, is_of_scene } = export;
        let request = Request { samples: scene.figure.samples(), ..Request::plain(scene.figure.pixels()) };
        let written = Format::of(file).and_then(|format| {
            let target = Target { path: file, format, notes };
            // What is written is not interrupted by what is to be drawn next.
            let drawn = self.with_studio(|studio, _| {
                let interrupt = std::mem::take(&mut studio.interrupt);
                let drawn = paper::draw(studio, scene, &request, target, &mut |_| Ok(()));
                studio.interrupt = interrupt;
                drawn
            });
            let (_, drawn) = drawn.map_err(|error| error.to_string())?;
            drawn.finish().map_err(|error| error.to_string())
        });
        self.tell(match written {
            Ok(()) => Reply::Exported(file.clone(), *is_of_scene),
            Err(error) => Reply::NotExported(error),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A worker that draws the built-in city.
    fn worker() -> (Worker, Receiver<Reply>) {
        let (sender, replies) = channel();
        let mut worker = Worker::new(Arc::default(), sender, Arc::new(|| {}));
        let spec = CitySpec { files: vec!["builtin:square".into()], ..CitySpec::default() };
        let (model, stats) = load::load_with_stats(&spec.files, &LoadOptions::default(), &load::Quiet).unwrap();
        worker.set_up(Loaded { model, spec, reading: LoadOptions::default(), stats });
        assert!(replies.try_iter().any(|reply| matches!(reply, Reply::Opened(_))));
        (worker, replies)
    }

    fn draw() -> Draw {
        let size = [64, 48];
        Draw { scene: Arc::default(), size, meant_for: size, is_moving: false, is_measured: false }
    }

    fn picture(worker: &mut Worker, replies: &Receiver<Reply>) -> Vec<[u8; 4]> {
        worker.frame(draw(), false);
        match replies.try_iter().next() {
            Some(Reply::Frame(frame)) => frame.rgba,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_device_that_goes_away_is_replaced() {
        let (mut worker, replies) = worker();
        let before = picture(&mut worker, &replies);
        worker.studio.as_ref().expect("a city").renderer.gpu.device.destroy();
        assert_eq!(picture(&mut worker, &replies), before);
    }

    #[test]
    fn a_mistake_of_ours_is_told_and_the_next_picture_drawn() {
        let (mut worker, replies) = worker();
        let before = picture(&mut worker, &replies);
        worker.guarded(|own| {
            own.standing.1 = [1, 1];
            panic!("two and two");
        });
        let answers: Vec<Reply> = replies.try_iter().collect();
        assert!(matches!(&answers[..], [Reply::NotDrawn(text)] if text.contains("two and two")), "{answers:?}");
        assert_eq!(picture(&mut worker, &replies), before);
    }

    #[test]
    fn what_is_not_wanted_any_more_is_not_loaded() {
        let shared = Shared::default();
        let replies = LoadingReplies { shared: &shared, number: 1, tell: &drop::<Reply> };
        let error = load::load(&["builtin:square".into()], &LoadOptions::default(), &replies).unwrap_err();
        assert!(error.to_string().contains("cancelled"), "{error}");
    }
}
