//! What overlays cost, in parts of a plain frame of the same run: the layout of 200 labels, from nothing and from the frame before on a
//! walk; twelve overlays that show what they showed before, while the main view is drawn again; and twelve that are drawn again, in parts of what a
//! model says (so much for each view, each triangle and each pixel), whose constants are fitted in the same run.
//!
//! `cargo bench --bench overlays [-- --pairs N] [--only labels|unchanged|redrawn]`: a frame is drawn, and one is laid out or drawn with overlays, in turn; the
//! median of their ratios is given with its 95 % interval. A target is met when the interval's upper end meets it.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{sync::Arc, time::Instant};

use glam::{DVec2, DVec3};
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    figure::{
        overlays::{Standing, overlays},
        scene_file::{self, Options},
    },
    geom::Aabb,
    gpu::Gpu,
    measure::{
        ratio::{Estimate, ratios},
        stage::plain_scene,
    },
    overlay::{self, Align, Arrangement, Focus, Layout, LineKind, Overlay, Rect, place},
    render::{
        furniture::Furniture,
        picture::{Request, Studio},
    },
    scene::{CitySpec, Scene},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [1280, 720];
const LABELS: usize = 200;
const OVERLAYS: usize = 12;

fn main() {
    let (mut pairs, mut only) = (61, None);
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--pairs", Some(n)) => pairs = n.parse().expect("--pairs wants a number"),
            ("--only", Some(part)) => only = Some(part),
            _ => panic!("{argument} is not --pairs N or --only labels|unchanged|redrawn"),
        }
    }
    let model = load(&[bench_city::written(bench_city::BENCH_BUILDINGS)], &LoadOptions::default(), &Quiet)
        .unwrap_or_else(|error| panic!("{error}"));
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
    println!("adapter {}, {pairs} pairs, {}x{}, {LABELS} labels", gpu.name(), SIZE[0], SIZE[1]);
    println!(
        "{:<42} {:>9} {:>9} {:>24} {:>8}",
        "layout / plain frame", "ms", "frame ms", "ratio (95 % interval)", "target"
    );
    let model = Arc::new(model);
    let studio = |gpu| {
        let mut studio = Studio::new(gpu, Arc::clone(&model), &spec).unwrap_or_else(|error| panic!("{error}"));
        studio.renderer.settings.holds_geometry = false;
        studio
    };
    let mut plain = studio(gpu);
    let is_asked = |part: &str| only.as_deref().is_none_or(|only| only == part);
    if is_asked("labels") {
        labels(&mut plain, pairs);
    }
    if is_asked("unchanged") || is_asked("redrawn") {
        let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
        let mut own = studio(gpu);
        if is_asked("unchanged") {
            unchanged(&mut plain, &mut own, pairs);
        }
        if is_asked("redrawn") {
            redrawn(&mut plain, &mut own, pairs);
        }
    }
}

/// Milliseconds.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed().as_secs_f64() * 1e3)
}

fn row(name: &str, own: &[f64], frames: &[f64], target: f64) {
    let of = |values: &[f64]| Estimate::of(values).expect("one pair or more, and finite times");
    let Estimate { median, low, high } = of(&ratios(own, frames));
    let verdict = if high <= target { "met" } else { "MISSED" };
    let [own, frame] = [own, frames].map(|times| of(times).median);
    println!("{name:<42} {own:>9.3} {frame:>9.1} {median:>9.4} ({low:.4}..{high:.4}) {target:>6.2} {verdict}");
}

fn frame(studio: &mut Studio, scene: &Scene, furniture: &Furniture) {
    frame_of(studio, scene, SIZE, furniture);
}

fn frame_of(studio: &mut Studio, scene: &Scene, size: [u32; 2], furniture: &Furniture) {
    studio.redraw_with(scene, size, furniture).unwrap_or_else(|error| panic!("{error}"));
    studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
}

/// Twelve best views of 160 × 120 pixels with lines and captions: the frame with them over the one without.
fn unchanged(plain: &mut Studio, own: &mut Studio, pairs: usize) {
    let extent = plain.extent();
    let roots: Vec<&str> = own.model.objects.iter().filter(|o| !o.class.is_ground()).map(|o| &*o.id).collect();
    let chosen: Vec<String> = roots.iter().step_by((roots.len() / OVERLAYS).max(1)).map(|id| id.to_string()).collect();
    let table = |(n, id): (usize, &String)| {
        format!(
            "[[poi]]\nname = \"{n}\"\nobject = \"{id}\"\n[[lens]]\nname = \"{n}\"\nkind = \"best-view\"\npoi = \"{n}\"\n\
             [[overlay]]\nlens = \"{n}\"\nsize = [160, 120]\nframe = \"print\"\ncaption = \"House {n}\"\n"
        )
    };
    let tables: String = chosen.iter().take(OVERLAYS).enumerate().map(table).collect();
    let mut scene = with_tables(&tables);
    let mut standing = Standing::default();
    let (mut without, mut with) = (Vec::new(), Vec::new());
    let mut hosts = Vec::new();
    let mut drawn_again = 0;
    for n in 0..=pairs {
        let alone = plain_scene(view(&extent, n).camera);
        let ((), time) = timed(|| frame(plain, &alone, &Furniture::default()));
        without.push(time);
        scene = Scene { camera: alone.camera, style: alone.style, sun: alone.sun, ..scene };
        let start = Instant::now();
        let overlays =
            overlays(own, &scene, &request(own), &[], &mut standing).unwrap_or_else(|error| panic!("{error}"));
        hosts.push(start.elapsed().as_secs_f64() * 1e3);
        frame(own, &scene, &overlays.furniture);
        with.push(start.elapsed().as_secs_f64() * 1e3);
        if n > 0 {
            drawn_again += overlays.figures.iter().filter(|figures| figures.rendered).count();
        }
    }
    assert_eq!(drawn_again, 0, "what overlays show does not change on this walk");
    let more: Vec<f64> = with.iter().zip(&without).map(|(with, without)| with - without).collect();
    row("12 unchanged overlays", &more[1..], &without[1..], 0.07);
    row("of that, until the frame is begun", &hosts[1..], &without[1..], 0.07);
}

fn with_tables(tables: &str) -> Scene {
    let text = format!("veduta = 1\n[city]\nfiles = [\"any.city.json\"]\n{tables}");
    let options = Options { allow_outside: true, ..Options::default() };
    scene_file::parse(&text, "overlays", &options).unwrap_or_else(|error| panic!("{error}"))
}

fn request(studio: &Studio) -> Request {
    Request { backend: studio.backend, ..Request::plain(SIZE) }
}

/// Twelve views of 160 × 120 pixels that look at the main eye's surroundings from outside and are drawn again in every frame. The model's time for a view
/// that shows nothing, for each triangle and for each pixel is that of plain frames of the same run: of the sky, of the whole city
/// in so few pixels, and of the whole city in many.
fn redrawn(plain: &mut Studio, own: &mut Studio, pairs: usize) {
    let extent = plain.extent();
    let reach = extent.size().truncate().length();
    let table = |n: usize| {
        let (turn, far) = (0.5 * n as f64, reach * (0.05 + 0.08 * n as f64));
        let (x, y) = (turn.cos(), turn.sin());
        format!(
            "[[lens]]\nname = \"{n}\"\nkind = \"best-view\"\nview = {{ kind = \"mcop\", normal = [{x:.4}, {y:.4}, 1], distance = {far:.1} }}\n\
             [[overlay]]\nlens = \"{n}\"\nsize = [160, 120]\nframe = \"none\"\n"
        )
    };
    let mut scene = with_tables(&(0..OVERLAYS).map(table).collect::<String>());
    let mut standing = Standing::default();
    let small = [160, 120];
    let pixels = |size: [u32; 2]| f64::from(size[0] * size[1]);
    let all = plain.renderer.city().map_or(0, |city| city.triangles) as f64;
    let (mut own_times, mut models, mut constants, mut most) = (Vec::new(), Vec::new(), [0.0; 3], 0.0_f64);
    for n in 0..=pairs {
        let alone = plain_scene(view(&extent, n).camera);
        let mut sky = alone.clone();
        if let Some(camera) = &mut sky.camera {
            camera.target = camera.eye + (camera.eye - camera.target);
        }
        let mut timed_frame = |scene, size| timed(|| frame_of(plain, scene, size, &Furniture::default())).1;
        let [fixed, few, many] = [(&sky, small), (&alone, small), (&alone, SIZE)].map(|(s, size)| timed_frame(s, size));
        let per_pixel = (many - few) / (pixels(SIZE) - pixels(small));
        let per_triangle = (few - fixed) / all;
        let fixed = fixed - per_pixel * pixels(small);
        scene = Scene { camera: alone.camera, style: alone.style, sun: alone.sun, ..scene };
        let start = Instant::now();
        let made = overlays(own, &scene, &request(own), &[], &mut standing).unwrap_or_else(|error| panic!("{error}"));
        own.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
        let time = start.elapsed().as_secs_f64() * 1e3;
        assert!(n == 0 || made.figures.iter().filter(|f| f.rendered).count() >= OVERLAYS - 1, "they are drawn again");
        let model = made.figures.iter().filter(|figures| figures.rendered).map(|figures| {
            let triangles = figures.triangles(&figures.shown.lens.to_string(), 1) as f64;
            most = most.max(triangles / pixels(figures.shown.size));
            fixed + per_triangle * triangles + per_pixel * pixels(figures.shown.size)
        });
        models.push(model.sum::<f64>());
        own_times.push(time);
        constants = [fixed, per_triangle * 1e3, per_pixel * 1e6];
    }
    let [fixed, triangle, pixel] = constants;
    println!(
        "model: {fixed:.2} ms a view, {triangle:.3} µs a triangle, {pixel:.1} ns a pixel; {most:.2} triangles a pixel at most"
    );
    row("12 overlays drawn again / model", &own_times[1..], &models[1..], 1.3);
}

/// Layouts of 200 labels over the frame.
fn labels(studio: &mut Studio, pairs: usize) {
    let boxes: Vec<Aabb> = studio.geometries.iter().map(|g| studio.model.geometries[*g as usize].bounds).collect();
    let step = (boxes.len() / LABELS).max(1);
    let places: Vec<DVec3> = boxes.iter().step_by(step).take(LABELS).map(Aabb::center).collect();
    let extent = studio.extent();
    for (name, arrangement) in [("border", Arrangement::Border), ("sides", Arrangement::Vertical(Align::Both))] {
        for lines in [LineKind::Straight, LineKind::Orthogonal, LineKind::Curved] {
            let request = |n: usize| asked(&view(&extent, n), &places, arrangement, lines);
            for (what, is_walk, target) in [("from nothing", false, 1.0), ("from the frame before", true, 0.02)] {
                let mut before = place(&request(0), None);
                let (mut layouts, mut frames) = (Vec::new(), Vec::new());
                for n in 1..=pairs {
                    let asked = request(n);
                    let (placed, time) = timed(|| place(&asked, is_walk.then_some(&before)));
                    layouts.push(time);
                    before = placed;
                    let scene = plain_scene(view(&extent, n).camera);
                    frames.push(timed(|| frame(studio, &scene, &Furniture::default())).1);
                }
                row(&format!("{name}, {lines:?}, {what}"), &layouts, &frames, target);
            }
        }
    }
}

/// Frame `n` of a walk above the roofs.
fn view(extent: &Aabb, n: usize) -> View {
    let (middle, reach) = (extent.center(), extent.size().truncate().length());
    let turn = 0.3 + 0.002 * n as f64;
    let eye = middle + DVec3::new(0.7 * turn.cos(), 0.7 * turn.sin(), 0.4) * reach;
    View::new(Camera::looking(eye, middle, 0.8), SIZE, extent).unwrap_or_else(|error| panic!("{error}"))
}

/// Labels of the places, all of whose middles shall stay free.
fn asked(view: &View, places: &[DVec3], arrangement: Arrangement, lines: LineKind) -> overlay::Request {
    let [width, height] = SIZE.map(f64::from);
    let seen = |at: &DVec3| {
        let pixel = view.pixel(*at).filter(|p| p.z > view.camera.near_m)?.truncate();
        ((0.0..=width).contains(&pixel.x) && (0.0..=height).contains(&pixel.y)).then_some(pixel)
    };
    let size = DVec2::new(60.0, 16.0);
    let overlay = |(id, at): (u32, &DVec3)| Overlay {
        id,
        priority: f64::from(id % 5),
        min: 0.5 * size,
        preferred: size,
        max: 1.5 * size,
        anchors: seen(at).map(Focus::Point).into_iter().collect(),
        lines,
        weight: 0.5,
        distance: at.distance(view.camera.eye),
    };
    overlay::Request {
        picture: SIZE,
        overlays: (0..).zip(places).map(overlay).collect(),
        avoid: places.iter().filter_map(seen).collect(),
        clearance: 6.0,
        blocked: vec![Rect::new([16, 16], [300, 40])],
        layout: Layout { arrangement, ..Layout::default() },
    }
}
