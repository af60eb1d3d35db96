//! What the default look costs, as a person sees it in the window and in a figure: against the plain frame of the same city, which has one
//! sample, clay, and neither ground nor shadows.
//!
//! `cargo bench --bench look [-- --pairs N]`: frames A and B are drawn in turn, and the median of their ratios is given with its 95 % interval; a
//! target is met when the interval's upper end meets it. `-- --only "V2 sixteen"` draws only the rows of that name.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{sync::Arc, time::Instant};

use glam::DVec3;
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    gpu::Gpu,
    lens::{Lens, LensBody, Region},
    measure::{
        ratio::{Estimate, in_turn, ratios},
        stage::plain_scene,
        topics::gpu::views::{overview, street, with_lens},
    },
    render::picture::{Request, Studio},
    scene::{CitySpec, Scene, Style, Sun},
    view::Camera,
};

const SIZE: [u32; 2] = [1280, 720];

/// Names of frames, how often samples are drawn, and what their ratio to the plain frame is to be at most.
const ROWS: [(&str, f64); 4] = [("eye moves", 2.1), ("lens moves", 1.4), ("sixteen", 20.0), ("occlusion", 1.25)];

/// Scenes that are drawn in turn, as the request says.
struct Frames {
    studio: usize,
    scenes: Vec<Scene>,
    request: Request,
    next: usize,
}

impl Frames {
    fn draw(&mut self, studios: &mut [Studio; 2]) -> f64 {
        let studio = &mut studios[self.studio];
        self.next = (self.next + 1) % self.scenes.len();
        let start = Instant::now();
        studio.draw(&self.scenes[self.next], &self.request).unwrap_or_else(|error| panic!("{error}"));
        studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
        start.elapsed().as_secs_f64() * 1e3
    }
}

fn main() {
    let (mut pairs, mut only, mut passes) = (21, None, false);
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--pairs", Some(n)) => pairs = n.parse().expect("--pairs wants a number"),
            ("--only", name @ Some(_)) => only = name,
            ("--passes", Some(word)) => passes = word == "yes",
            _ => panic!("{argument} is neither --pairs N nor --only NAME nor --passes yes"),
        }
    }
    let file = bench_city::written(bench_city::BENCH_BUILDINGS);
    let model = load(&[file], &LoadOptions::default(), &Quiet).unwrap_or_else(|error| panic!("{error}"));
    let model = Arc::new(model);
    let mut studios = [false, true].map(|ground| {
        let spec = CitySpec { ground, ..CitySpec::default() };
        let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
        let mut studio = Studio::new(gpu, model.clone(), &spec).unwrap_or_else(|error| panic!("{error}"));
        // The plain frame is drawn whole, each time.
        studio.renderer.settings.holds_geometry = ground;
        studio
    });
    println!("adapter {}, {pairs} pairs, {}x{}", studios[0].renderer.gpu.name(), SIZE[0], SIZE[1]);
    println!("{:<24} {:>9} {:>9} {:>24} {:>8}", "A / plain", "A ms", "plain ms", "ratio (95 % interval)", "target");
    let over = overview(&studios[0].extent(), SIZE).unwrap_or_else(|error| panic!("{error}"));
    for (view, camera) in [("V1", over), ("V2", street(&studios[0]))] {
        let default = Scene { camera: Some(camera), ..Scene::default() };
        let lensed = with_lens(&default, &mut studios[1], SIZE).unwrap_or_else(|error| panic!("{error}"));
        for (name, target) in ROWS {
            let name = format!("{view} {name}");
            if only.as_ref().is_some_and(|wanted| *wanted != name) {
                continue;
            }
            let (scenes, studio) = match &name[3..] {
                "eye moves" => ((0..8).map(|step| turned(&default, step)).collect(), 1),
                "lens moves" => ((0..8).map(|step| moved(&lensed, step)).collect(), 1),
                "sixteen" => (vec![default.clone()], 1),
                // The sky alone: the sun is below the horizon, and casts no shadows.
                _ => {
                    let sun = Sun { elevation: -0.1, ..Sun::default() };
                    (vec![Scene { sun, ..plain_scene(camera) }], 0)
                }
            };
            let samples = if name.ends_with("sixteen") { 16 } else { 1 };
            let request = Request { samples, screen_occlusion: true, ..Request::plain(SIZE) };
            let plain = Frames { studio: 0, scenes: vec![plain_scene(camera)], request: Request::plain(SIZE), next: 0 };
            let frames = Frames { studio, scenes, request, next: 0 };
            if passes {
                print_passes(&mut studios[studio], &frames);
            }
            compare(&mut studios, pairs, &name, [frames, plain], target);
        }
    }
}

/// The scene with its eye moved around what it looks at, a five-hundredth of its distance a step.
fn turned(scene: &Scene, step: u32) -> Scene {
    let camera = scene.camera.expect("a camera");
    let aside = (camera.target - camera.eye).cross(DVec3::Z) * (0.002 * f64::from(step));
    Scene { camera: Some(Camera { eye: camera.eye + aside, ..camera }), ..scene.clone() }
}

/// The scene in the default style with its lens some metres away, and its outline.
fn moved(scene: &Scene, step: u32) -> Scene {
    let mut scene = Scene { style: Style::default(), sun: Sun::default(), ..scene.clone() };
    scene.lenses.iter_mut().for_each(|lens: &mut Lens| lens.body = LensBody::default());
    if let Some(Region::Shape(veduta::geom::Shape::Sphere { center, .. })) = scene.lenses[0].shapes.first_mut() {
        center.x += f64::from(step);
    }
    scene
}

/// Draws the first two scenes measured, and prints what the passes of the second cost: what is held from one frame to the next is left out as it is
/// in a window.
fn print_passes(studio: &mut Studio, frames: &Frames) {
    let request = Request { statistics: true, ..frames.request };
    let mut draw = |i: usize| {
        let scene = &frames.scenes[i % frames.scenes.len()];
        studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}")).statistics
    };
    draw(0);
    let statistics = draw(1);
    let mut sums: Vec<(String, u32, u64, f64)> = Vec::new();
    for pass in statistics.passes {
        let at = sums.iter().position(|sum| sum.0 == pass.name).unwrap_or_else(|| {
            sums.push((pass.name.clone(), 0, 0, 0.0));
            sums.len() - 1
        });
        let sum = &mut sums[at];
        *sum = (pass.name, sum.1 + 1, sum.2 + pass.triangles, sum.3 + pass.gpu_ms.unwrap_or(f64::NAN));
    }
    for (name, times, triangles, ms) in sums {
        // Of several samples the first is timed.
        let ms = if ms.is_nan() { String::new() } else { format!("{ms:>9.1} ms") };
        println!("    {name:<20} {times:>3} x {triangles:>10} triangles {ms}");
    }
}

/// Draws A and B in turn and prints the median of A/B with its 95 % interval.
fn compare(studios: &mut [Studio; 2], pairs: usize, name: &str, [mut a, mut b]: [Frames; 2], target: f64) {
    for _ in 0..2 {
        a.draw(studios);
        b.draw(studios);
    }
    let times = in_turn(2, pairs, |i| Ok::<_, std::convert::Infallible>([&mut a, &mut b][i].draw(studios)));
    let Ok(times) = times;
    let of = |values: &[f64]| Estimate::of(values).expect("one pair or more, and finite times");
    let [of_a, of_b] = [0, 1].map(|i| of(&times[i]).median);
    let Estimate { median, low, high } = of(&ratios(&times[0], &times[1]));
    let verdict = if high <= target { "met" } else { "MISSED" };
    println!("{name:<24} {of_a:>9.1} {of_b:>9.1} {median:>9.3} ({low:.3}..{high:.3}) {target:>6.2} {verdict}");
}
