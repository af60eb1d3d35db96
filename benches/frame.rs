//! What a frame costs: the plain frame against the bare lit draw of the same buffers, street against overview, and one
//! colour lens against the plain frame.
//!
//! `cargo bench --bench frame [-- --pairs N]`: frames A and B are drawn in turn, and the median of their ratios is
//! given with its 95 % interval; a target is met when the interval's upper end meets it.

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

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let pairs = match &arguments[..] {
        [flag, n] if flag == "--pairs" => n.parse().expect("--pairs wants a number"),
        _ => 31,
    };
    let model = load(&[bench_city::written(bench_city::BENCH_BUILDINGS)], &LoadOptions::default(), &Quiet)
        .unwrap_or_else(|error| panic!("{error}"));
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
    println!("adapter {}, {pairs} pairs, {}x{}", gpu.name(), SIZE[0], SIZE[1]);
    let mut studio = Studio::new(gpu, Arc::new(model), &spec).unwrap_or_else(|error| panic!("{error}"));
    let extent = studio.extent();
    println!("{} triangles", studio.renderer.city().map_or(0, |c| c.triangles));
    println!("{:<52} {:>9} {:>9} {:>24} {:>8}", "A / B", "A ms", "B ms", "ratio (95 % interval)", "target");
    let v1 = plain(overview(&extent));
    let v2 = plain(street(&studio));
    for (name, scene, target) in [("V1", &v1, 1.3), ("V2", &v2, 1.45)] {
        let view = view(scene);
        let plain = |studio: &mut Studio| frame(studio, scene);
        let bare = |studio: &mut Studio| {
            studio.renderer.draw_bare(&view);
            finish(studio);
        };
        compare(&format!("{name}: plain frame / bare lit draw"), &mut studio, pairs, target, plain, bare);
    }
    compare("plain frame: V2 / V1", &mut studio, pairs, 0.5, |s| frame(s, &v2), |s| frame(s, &v1));
    for (name, scene) in [("V1", &v1), ("V2", &v2)] {
        let lensed = with_lens(scene, &mut studio);
        compare(
            &format!("{name}: one colour lens over a tenth / plain frame"),
            &mut studio,
            pairs,
            1.10,
            |s| frame(s, &lensed),
            |s| frame(s, scene),
        );
    }
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

/// A greyscale lens whose mask covers about a tenth of the picture.
fn with_lens(scene: &Scene, studio: &mut Studio) -> Scene {
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
                parameters: Default::default(),
            }],
            body: LensBody::None,
            sprite_resolution: None,
        }];
        lensed
    };
    let distance = camera.eye.distance(camera.target);
    // A disc of a tenth of the picture: π p² = w·h/10 pixels.
    let pixels = f64::from(SIZE[0] * SIZE[1]) / 10.0;
    // From the street a lens that far is behind the first houses: it stands among them.
    let distance = if distance < 100.0 { 30.0 } else { distance };
    let mut radius = (pixels / std::f64::consts::PI).sqrt() * view(scene).pixel_m(distance);
    let request = Request { size: SIZE, samples: 1, transparent: false, aovs: Aovs::default(), statistics: true };
    let mut covered = |radius: f64| {
        let figures = studio.render(&of(radius, distance), &request).expect("a picture").statistics;
        figures.lenses[0].covered as f64 / pixels
    };
    // The shown surface inside it makes up the tenth, not its disc.
    for _ in 0..12 {
        radius *= (1.0 / covered(radius).max(0.05)).sqrt().clamp(0.7, 1.4);
    }
    println!("  the lens covers {:.1} % of the picture", 10.0 * covered(radius));
    of(radius, distance)
}

fn frame(studio: &mut Studio, scene: &Scene) {
    studio.redraw(scene, SIZE).unwrap_or_else(|error| panic!("{error}"));
    finish(studio);
}

fn finish(studio: &Studio) {
    studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
}

/// Draws A and B in turn and prints the median of A/B with its 95 % interval.
fn compare(
    name: &str,
    studio: &mut Studio,
    pairs: usize,
    target: f64,
    mut a: impl FnMut(&mut Studio),
    mut b: impl FnMut(&mut Studio),
) {
    let time = |studio: &mut Studio, f: &mut dyn FnMut(&mut Studio)| {
        let start = Instant::now();
        f(studio);
        start.elapsed().as_secs_f64() * 1e3
    };
    for _ in 0..2 {
        a(studio);
        b(studio);
    }
    let (mut of_a, mut of_b, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..pairs {
        // Every other pair the other way round, so that neither always runs on the other's warm caches.
        let (ta, tb) = if i % 2 == 0 {
            let ta = time(studio, &mut a);
            (ta, time(studio, &mut b))
        } else {
            let tb = time(studio, &mut b);
            (time(studio, &mut a), tb)
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
        "{name:<52} {:>9.1} {:>9.1} {median:>9.3} ({low:.3}..{high:.3}) {target:>6.2} {verdict}",
        of_a[pairs / 2],
        of_b[pairs / 2]
    );
}
