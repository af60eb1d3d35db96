//! What a frame costs: the plain frame against the bare lit draw of the same buffers, street against overview, and one
//! colour lens against the plain frame.
//!
//! `cargo bench --bench frame [-- --pairs N]`: frames A and B are drawn in turn, and the median of their ratios is
//! given with its 95 % interval; a target is met when the interval's upper end meets it. "All" is the plain frame with what
//! near buildings hide: it draws the very triangles that the bare draw does. `-- --profile "V1 plain"` draws
//! one of them over and over, for a profiler to watch.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{sync::Arc, time::Instant};

use glam::DVec3;
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    geom::{Aabb, Shape},
    gpu::Gpu,
    lens::{Class, EffectUse, Lens, LensBody, LensKind},
    render::picture::{Aovs, Request, Studio},
    scene::{BaseStyle, CitySpec, Scene, Sun},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [1280, 720];

/// One of the frames that are compared.
enum Frame {
    /// The bare lit draw.
    Bare(View),
    /// A scene, redrawn in full.
    Full(Scene),
    /// The same with what near buildings hide, as the bare draw draws it.
    Unculled(Scene),
}

fn main() {
    let (mut pairs, mut profile) = (31, None);
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--pairs", Some(n)) => pairs = n.parse().expect("--pairs wants a number"),
            ("--profile", name @ Some(_)) => profile = name,
            _ => panic!("{argument} is neither --pairs N nor --profile NAME"),
        }
    }
    let model = load(&[bench_city::written(bench_city::BENCH_BUILDINGS)], &LoadOptions::default(), &Quiet)
        .unwrap_or_else(|error| panic!("{error}"));
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
    println!("adapter {}, {pairs} pairs, {}x{}", gpu.name(), SIZE[0], SIZE[1]);
    let mut studio = Studio::new(gpu, Arc::new(model), &spec).unwrap_or_else(|error| panic!("{error}"));
    println!("{} triangles", studio.renderer.city().map_or(0, |c| c.triangles));
    let mut frames = Vec::new();
    for (v, camera) in [("V1", overview(&studio.extent())), ("V2", street(&studio))] {
        let scene = plain(camera);
        let lensed = with_lens(v, &scene, &mut studio);
        frames.push((format!("{v} bare"), Frame::Bare(view(&scene))));
        frames.push((format!("{v} all"), Frame::Unculled(scene.clone())));
        frames.push((format!("{v} plain"), Frame::Full(scene)));
        frames.push((format!("{v} lens"), Frame::Full(lensed)));
    }
    let named = |name: &str| {
        let found = frames.iter().find(|(n, _)| n == name);
        &found.unwrap_or_else(|| panic!("no frame is called {name}; V1 or V2 with bare, all, plain or lens")).1
    };
    if let Some(name) = profile {
        // A bare draw takes targets and view from the frame before it.
        timed(&mut studio, named(&format!("{} plain", name.split(' ').next().unwrap_or_default())));
        let best = (0..pairs).map(|_| timed(&mut studio, named(&name))).fold(f64::INFINITY, f64::min);
        println!("{name}: {best:.1} ms at best");
        return;
    }
    println!("{:<22} {:>9} {:>9} {:>24} {:>8}", "A / B", "A ms", "B ms", "ratio (95 % interval)", "target");
    compare(&mut studio, pairs, named, ["V1 plain", "V1 bare"], 1.30);
    compare(&mut studio, pairs, named, ["V2 all", "V2 bare"], 1.45);
    compare(&mut studio, pairs, named, ["V2 plain", "V2 bare"], 1.45);
    compare(&mut studio, pairs, named, ["V2 plain", "V1 plain"], 0.50);
    compare(&mut studio, pairs, named, ["V1 lens", "V1 plain"], 1.10);
    compare(&mut studio, pairs, named, ["V2 lens", "V2 plain"], 1.10);
}

/// Clay, no shadows, one sample.
fn plain(camera: Camera) -> Scene {
    let mut scene = Scene { camera: Some(camera), ..Scene::default() };
    scene.style.base = BaseStyle::Clay;
    scene.sun = Sun { shadows: false, ..Sun::default() };
    scene
}

/// V1: the whole city in the frustum.
fn overview(extent: &Aabb) -> Camera {
    let target = extent.center().with_z(extent.min.z);
    let reach = extent.size().truncate().length();
    let mut camera = Camera::looking(target + DVec3::new(-0.45, -0.75, 0.55) * reach, target, 45_f64.to_radians());
    // Nearer, as long as all corners stay in the picture.
    for _ in 0..40 {
        let closer = Camera { eye: target + (camera.eye - target) * 0.97, ..camera };
        let frustum = View::new(closer, SIZE, extent).expect("a view").frustum(0.0);
        if !extent.corners().into_iter().all(|c| frustum.contains(c)) {
            break;
        }
        camera = closer;
    }
    camera
}

/// V2: at the city's centre, 1.7 m up.
fn street(studio: &Studio) -> Camera {
    let extent = studio.extent();
    // The nearest place to it where no building stands.
    let model = &studio.model;
    let is_free = |p: DVec3| {
        let near =
            |b: &Aabb| (b.min.x - 1.0..b.max.x + 1.0).contains(&p.x) && (b.min.y - 1.0..b.max.y + 1.0).contains(&p.y);
        !studio.geometries.iter().any(|&g| {
            let geometry = &model.geometries[g as usize];
            !model.objects[geometry.object as usize].class.is_ground() && near(&geometry.bounds)
        })
    };
    let spiral = (0..20_000).map(|i| {
        let (turn, reach) = (f64::from(i) * 0.5, f64::from(i) * 0.02);
        extent.center().with_z(extent.min.z + 1.7) + DVec3::new(turn.cos(), turn.sin(), 0.0) * reach
    });
    let eye = spiral.into_iter().find(|p| is_free(*p)).unwrap_or(extent.center());
    Camera::looking(eye, eye + DVec3::new(80.0, 30.0, 0.0), 45_f64.to_radians())
}

fn view(scene: &Scene) -> View {
    View::new(scene.camera.expect("a camera"), SIZE, &Aabb::EMPTY).expect("a view")
}

/// A greyscale lens whose mask covers a tenth of the picture.
fn with_lens(v: &str, scene: &Scene, studio: &mut Studio) -> Scene {
    let camera = scene.camera.expect("a camera");
    let forward = (camera.target - camera.eye).normalize_or(DVec3::X);
    let of = |radius: f64, distance: f64| {
        let mut lensed = scene.clone();
        lensed.lenses = vec![Lens {
            name: "lens".into(),
            kind: LensKind::Color,
            enabled: true,
            color: [0.8, 0.2, 0.1],
            shapes: vec![Shape::Sphere { center: camera.eye + forward * distance, radius }],
            effects: vec![EffectUse {
                effect: "greyscale".into(),
                class: Class::Inside,
                blend: None,
                weight: None,
                parameters: Default::default(),
            }],
            body: LensBody::None,
            sprite_resolution: None,
        }];
        lensed
    };
    // Around the shown surface in the middle of the picture.
    let aovs = Aovs { depth: true, ..Aovs::default() };
    let request =
        Request { size: SIZE, samples: 1, transparent: false, aovs, statistics: true, backend: Default::default() };
    let depth = studio.render(scene, &request).expect("a picture").depth.expect("its depth");
    let distance = f64::from(depth[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize]);
    assert!(distance.is_finite(), "nothing stands in the middle of the picture");
    let mut share = |radius: f64| {
        let figures = studio.render(&of(radius, distance), &request).expect("a picture").statistics;
        figures.lenses[0].covered as f64 / f64::from(SIZE[0] * SIZE[1])
    };
    // The shown surface inside it makes up the tenth, not its disc; it grows with the radius.
    let (mut low, mut high) = (0.0, distance);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if share(middle) < 0.1 { low = middle } else { high = middle }
    }
    println!("{v}: a lens of {high:.1} m covers {:.2} % of the picture", 100.0 * share(high));
    of(high, distance)
}

/// Draws one frame to its end; takes milliseconds.
fn timed(studio: &mut Studio, frame: &Frame) -> f64 {
    let is_software = studio.renderer.gpu.is_software();
    studio.renderer.culls_hidden = is_software && !matches!(frame, Frame::Unculled(_));
    let start = Instant::now();
    match frame {
        Frame::Bare(view) => studio.renderer.draw_bare(view),
        Frame::Full(scene) | Frame::Unculled(scene) => {
            studio.redraw(scene, SIZE).unwrap_or_else(|error| panic!("{error}"))
        }
    }
    studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
    start.elapsed().as_secs_f64() * 1e3
}

/// Draws A and B in turn and prints the median of A/B with its 95 % interval.
fn compare<'a>(studio: &mut Studio, pairs: usize, named: impl Fn(&str) -> &'a Frame, names: [&str; 2], target: f64) {
    let [a, b] = names.map(named);
    for _ in 0..2 {
        timed(studio, a);
        timed(studio, b);
    }
    let (mut of_a, mut of_b, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..pairs {
        // Every other pair the other way round, so that neither always runs on the other's warm caches.
        let (ta, tb) = if i % 2 == 0 {
            let ta = timed(studio, a);
            (ta, timed(studio, b))
        } else {
            let tb = timed(studio, b);
            (timed(studio, a), tb)
        };
        of_a.push(ta);
        of_b.push(tb);
        ratios.push(ta / tb);
    }
    for list in [&mut of_a, &mut of_b, &mut ratios] {
        list.sort_by(f64::total_cmp);
    }
    // Order statistics that hold the median with 95 %: n/2 ± 0.98·√n.
    let half_width = 0.98 * (pairs as f64).sqrt();
    let low = ratios[((pairs as f64 / 2.0 - half_width).floor().max(0.0)) as usize];
    let high = ratios[((pairs as f64 / 2.0 + half_width).ceil() as usize).min(pairs - 1)];
    let median = ratios[pairs / 2];
    let verdict = if high <= target { "met" } else { "MISSED" };
    println!(
        "{:<22} {:>9.1} {:>9.1} {median:>9.3} ({low:.3}..{high:.3}) {target:>6.2} {verdict}",
        names.join(" / "),
        of_a[pairs / 2],
        of_b[pairs / 2]
    );
}
