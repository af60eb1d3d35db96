//! What deformation lenses cost, in parts of a plain frame of the same run: 500,000 triangles, a lens over a tenth of the city, and no
//! edge more than a quarter of a pixel from where it should be. While nothing moves; while the camera does, so that all is refined anew in
//! every frame; and while the lens does, so that what it meets is found anew, too.
//!
//! `cargo bench --bench deformations [-- --pairs N] [--profile moves|lens]`: a plain frame and one with the lens are drawn in turn; the
//! median of their ratios is given with its 95 % interval. A target is met when the interval's upper end meets it.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{sync::Arc, time::Instant};

use glam::DVec3;
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    figure::scene_file::{self, Options},
    geom::Aabb,
    gpu::Gpu,
    measure::{
        ratio::{Estimate, ratios},
        stage::plain_scene,
    },
    render::{furniture::Furniture, picture::Studio},
    scene::{CitySpec, Scene},
    view::Camera,
};

const SIZE: [u32; 2] = [1280, 720];
const TARGET: f64 = 2.0;

/// What is compared with the plain frame.
const STEPS: [(&str, &str); 4] = [
    ("heights", "{ kind = \"scale\", factors = [1, 1, 2.0] }"),
    ("twist", "{ kind = \"twist\", angle_deg = 40.0 }"),
    ("bend", "{ kind = \"bend\", angle_deg = 30.0 }"),
    (
        "chain",
        "{ kind = \"taper\", factor = 0.7 }, { kind = \"twist\", angle_deg = 30.0 }, { kind = \"bend\", angle_deg = 20.0 }",
    ),
];

#[derive(Clone, Copy, PartialEq)]
enum Moving {
    Nothing,
    Camera,
    Lens,
}

fn main() {
    let (mut pairs, mut profile) = (15, None);
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--pairs", Some(n)) => pairs = n.parse().expect("--pairs wants a number"),
            ("--profile", Some(name)) => profile = Some(name),
            _ => panic!("{argument} is neither --pairs N nor --profile NAME"),
        }
    }
    let model = load(&[bench_city::written(bench_city::BENCH_BUILDINGS)], &LoadOptions::default(), &Quiet)
        .unwrap_or_else(|error| panic!("{error}"));
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
    println!("adapter {}, {pairs} pairs, {}x{}", gpu.name(), SIZE[0], SIZE[1]);
    let mut studio = Studio::new(gpu, Arc::new(model), &spec).unwrap_or_else(|error| panic!("{error}"));
    studio.renderer.settings.holds_geometry = false;
    let extent = studio.extent();
    if let Some(name) = profile {
        let (_, steps) = STEPS.iter().find(|(own, _)| *own == name).expect("--profile names a row");
        for n in 0.. {
            frame(&mut studio, &scene(&extent, n, Some((*steps, 0))));
        }
    }
    println!(
        "{:<24} {:>9} {:>9} {:>24} {:>8}",
        "lens / plain frame", "ms", "plain ms", "ratio (95 % interval)", "target"
    );
    for (name, steps) in STEPS {
        for (what, moving) in
            [("", Moving::Nothing), (", camera moves", Moving::Camera), (", lens moves", Moving::Lens)]
        {
            let (mut own, mut plain) = (Vec::new(), Vec::new());
            for n in 0..=pairs {
                let (seen, at) = match moving {
                    Moving::Nothing => (0, 0),
                    Moving::Camera => (n, 0),
                    Moving::Lens => (0, n),
                };
                // The lens' frame comes after one of its own view where nothing moves: what it refined is still there.
                plain.push(frame(&mut studio, &scene(&extent, seen, None)));
                if moving == Moving::Nothing {
                    frame(&mut studio, &scene(&extent, seen, Some((steps, at))));
                }
                own.push(frame(&mut studio, &scene(&extent, seen, Some((steps, at)))));
            }
            let of = |values: &[f64]| Estimate::of(values).expect("one pair or more, and finite times");
            let Estimate { median, low, high } = of(&ratios(&own[1..], &plain[1..]));
            let verdict = if high <= TARGET { "met" } else { "MISSED" };
            let [own, plain] = [own, plain].map(|times| of(&times[1..]).median);
            let name = format!("{name}{what}");
            println!("{name:<24} {own:>9.1} {plain:>9.1} {median:>9.4} ({low:.4}..{high:.4}) {TARGET:>6.2} {verdict}");
        }
        if let Some(figures) = studio.renderer.deformed_figures() {
            println!("    {} triangles met, {} shown, {:?}", figures.met, figures.triangles, figures.report);
        }
    }
}

/// Draws a frame; milliseconds.
fn frame(studio: &mut Studio, scene: &Scene) -> f64 {
    let start = Instant::now();
    studio.redraw_with(scene, SIZE, &Furniture::default()).unwrap_or_else(|error| panic!("{error}"));
    studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
    start.elapsed().as_secs_f64() * 1e3
}

/// Frame `n` of a walk above the roofs, and steps of a lens at its place `at`.
fn scene(extent: &Aabb, n: usize, lens: Option<(&str, usize)>) -> Scene {
    let (middle, size) = (extent.center(), extent.size());
    let turn = 0.3 + 0.002 * n as f64;
    let eye = middle + DVec3::new(0.7 * turn.cos(), 0.7 * turn.sin(), 0.4) * size.truncate().length();
    let plain = plain_scene(Camera::looking(eye, middle, 0.8));
    let Some((steps, at)) = lens else { return plain };
    let side = 0.1_f64.sqrt() * size;
    let [x, y] = [middle.x + 0.5 * at as f64, middle.y];
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"any.city.json\"]\n[[lens]]\nname = \"moved\"\nkind = \"deformation\"\nbody = \"none\"\n\
         shape = {{ kind = \"box\", center = [{x}, {y}, {}], size = [{}, {}, {}] }}\ndeform = [{steps}]\n",
        middle.z, side.x, side.y, size.z
    );
    let options = Options { allow_outside: true, ..Options::default() };
    let own = scene_file::parse(&text, "deformations", &options).unwrap_or_else(|error| panic!("{error}"));
    Scene { lenses: own.lenses, ..plain }
}
