//! What the layout of 200 labels costs (B6, B7): from nothing, and from the frame before on a walk, in parts of a plain frame of the same run.
//!
//! `cargo bench --bench overlays [-- --pairs N]`: a frame is drawn, and one is laid out, in turn; the median of their ratios is given with its 95 % interval. A
//! target is met when the interval's upper end meets it.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{sync::Arc, time::Instant};

use glam::{DVec2, DVec3};
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    geom::Aabb,
    gpu::Gpu,
    measure::{
        ratio::{Estimate, ratios},
        stage::plain_scene,
    },
    overlay::{Align, Arrangement, Focus, Layout, LineKind, Overlay, Rect, Request, place},
    render::picture::Studio,
    scene::CitySpec,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [1280, 720];
const LABELS: usize = 200;

fn main() {
    let mut pairs = 61;
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--pairs", Some(n)) => pairs = n.parse().expect("--pairs wants a number"),
            _ => panic!("{argument} is not --pairs N"),
        }
    }
    let model = load(&[bench_city::written(bench_city::BENCH_BUILDINGS)], &LoadOptions::default(), &Quiet)
        .unwrap_or_else(|error| panic!("{error}"));
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
    println!("adapter {}, {pairs} pairs, {}x{}, {LABELS} labels", gpu.name(), SIZE[0], SIZE[1]);
    let mut studio = Studio::new(gpu, Arc::new(model), &spec).unwrap_or_else(|error| panic!("{error}"));
    let boxes: Vec<Aabb> = studio.geometries.iter().map(|g| studio.model.geometries[*g as usize].bounds).collect();
    let step = (boxes.len() / LABELS).max(1);
    let places: Vec<DVec3> = boxes.iter().step_by(step).take(LABELS).map(Aabb::center).collect();
    let extent = studio.extent();
    println!(
        "{:<42} {:>9} {:>9} {:>24} {:>8}",
        "layout / plain frame", "ms", "frame ms", "ratio (95 % interval)", "target"
    );
    for (name, arrangement) in [("border", Arrangement::Border), ("sides", Arrangement::Vertical(Align::Both))] {
        for lines in [LineKind::Straight, LineKind::Orthogonal, LineKind::Curved] {
            let request = |n: usize| asked(&view(&extent, n), &places, arrangement, lines);
            for (what, is_walk, target) in [("from nothing", false, 1.0), ("from the frame before", true, 0.02)] {
                let mut before = place(&request(0), None);
                let (mut layouts, mut frames) = (Vec::new(), Vec::new());
                for n in 1..=pairs {
                    let asked = request(n);
                    let start = Instant::now();
                    let placed = place(&asked, is_walk.then_some(&before));
                    layouts.push(start.elapsed().as_secs_f64() * 1e3);
                    before = placed;
                    let scene = plain_scene(view(&extent, n).camera);
                    let start = Instant::now();
                    studio.redraw(&scene, SIZE).unwrap_or_else(|error| panic!("{error}"));
                    studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
                    frames.push(start.elapsed().as_secs_f64() * 1e3);
                }
                let of = |values: &[f64]| Estimate::of(values).expect("one pair or more, and finite times");
                let Estimate { median, low, high } = of(&ratios(&layouts, &frames));
                let verdict = if high <= target { "met" } else { "MISSED" };
                let name = format!("{name}, {lines:?}, {what}");
                let [layout, frame] = [&layouts, &frames].map(|times| of(times).median);
                println!(
                    "{name:<42} {layout:>9.3} {frame:>9.1} {median:>9.4} ({low:.4}..{high:.4}) {target:>6.2} {verdict}"
                );
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
fn asked(view: &View, places: &[DVec3], arrangement: Arrangement, lines: LineKind) -> Request {
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
    Request {
        picture: SIZE,
        overlays: (0..).zip(places).map(overlay).collect(),
        avoid: places.iter().filter_map(seen).collect(),
        clearance: 6.0,
        blocked: vec![Rect::new([16, 16], [300, 40])],
        layout: Layout { arrangement, ..Layout::default() },
    }
}
