//! What a frame costs: the plain frame against the bare lit draw of the same buffers, street against overview, and one
//! colour lens, and ten that overlap, against the plain frame.
//!
//! `cargo bench --bench frame [-- --pairs N]`: frames A and B are drawn in turn, and the median of their ratios is
//! given with its 95 % interval; a target is met when the interval's upper end meets it. "All" is the plain frame with what
//! near buildings hide: it draws the very triangles that the bare draw does. `-- --only "V2 ten"` draws only the rows whose A it is,
//! `-- --profile "V1 plain"` one of them over and over, for a profiler to watch, and `-- --passes "V1 plain"` tells what each of its
//! passes takes.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{cell::Cell, sync::Arc, time::Instant};

use veduta::{
    city::load::{LoadOptions, Quiet, load},
    geom::{Aabb, Shape},
    gpu::Gpu,
    lens::{
        Lens, LensBody, Region,
        kind::Magnifier,
        ray::{RayLens, RayMethod},
    },
    measure::{
        ratio::{Estimate, in_turn, ratios},
        stage::plain_scene,
        topics::gpu::views::{overview, see_through_city, see_through_lens, spread, street, with_lens, with_ten},
    },
    render::picture::{Request, Studio},
    scene::{CitySpec, Scene},
    view::View,
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
    /// Scenes in turn, redrawn in full.
    Turns(Vec<Scene>, Cell<usize>),
}

fn main() {
    let (mut pairs, mut profile, mut only, mut passes) = (31, None, None, None);
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--pairs", Some(n)) => pairs = n.parse().expect("--pairs wants a number"),
            ("--profile", name @ Some(_)) => profile = name,
            ("--only", name @ Some(_)) => only = name,
            ("--passes", name @ Some(_)) => passes = name,
            _ => panic!("{argument} is neither --pairs N nor --only NAME nor --profile NAME nor --passes NAME"),
        }
    }
    let model = load(&[bench_city::written(bench_city::BENCH_BUILDINGS)], &LoadOptions::default(), &Quiet)
        .unwrap_or_else(|error| panic!("{error}"));
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    let gpu = Gpu::open().unwrap_or_else(|error| panic!("{error}"));
    println!("adapter {}, {pairs} pairs, {}x{}", gpu.name(), SIZE[0], SIZE[1]);
    let mut studio = Studio::new(gpu, Arc::new(model), &spec).unwrap_or_else(|error| panic!("{error}"));
    studio.renderer.settings.holds_geometry = false;
    println!("{} triangles", studio.renderer.city().map_or(0, |c| c.triangles));
    let mut frames = Vec::new();
    let over = overview(&studio.extent(), SIZE).unwrap_or_else(|error| panic!("{error}"));
    for (v, camera) in [("V1", over), ("V2", street(&studio))] {
        let scene = plain_scene(camera);
        let lensed = with_lens(&scene, &mut studio, SIZE).unwrap_or_else(|error| panic!("{error}"));
        let many = with_ten(&lensed, &mut studio, SIZE).unwrap_or_else(|error| panic!("{error}"));
        println!("{v}: lenses of {} m and of {} m cover a tenth of the picture each", radii(&lensed), radii(&many));
        let [few, thousand] = [10, 1000].map(|count| spread(&scene, &studio.extent(), count));
        let moving = (0..8).map(|step| moved(&thousand, f64::from(step)));
        frames.push((format!("{v} see-through"), Frame::Full(see_through_lens(&lensed))));
        frames.push((format!("{v} see-through city"), Frame::Full(see_through_city(&scene))));
        frames.push((format!("{v} moving"), Frame::Turns(moving.collect(), Cell::new(0))));
        let one_moves = (0..8).map(|step| moved(&lensed, f64::from(step)));
        frames.push((format!("{v} lens moving"), Frame::Turns(one_moves.collect(), Cell::new(0))));
        for (name, scene) in [("lens", &lensed), ("ten", &many), ("few", &few), ("thousand", &thousand)] {
            frames.push((format!("{v} {name} outlined"), Frame::Full(outlined(scene))));
        }
        for method in [RayMethod::Rays, RayMethod::Image] {
            let magnified = with_magnifier(&scene, method);
            let name = format!("{v} {}", if method == RayMethod::Rays { "magnifier" } else { "magnifier by image" });
            frames.push((format!("{name} outlined"), Frame::Full(outlined(&magnified))));
            frames.push((name, Frame::Full(magnified)));
        }
        frames.push((format!("{v} few"), Frame::Full(few)));
        frames.push((format!("{v} thousand"), Frame::Full(thousand)));
        frames.push((format!("{v} bare"), Frame::Bare(view(&scene))));
        frames.push((format!("{v} all"), Frame::Unculled(scene.clone())));
        frames.push((format!("{v} plain"), Frame::Full(scene)));
        frames.push((format!("{v} lens"), Frame::Full(lensed)));
        frames.push((format!("{v} ten all"), Frame::Unculled(many.clone())));
        frames.push((format!("{v} ten"), Frame::Full(many)));
    }
    let named = |name: &str| {
        let found = frames.iter().find(|(n, _)| n == name);
        &found
            .unwrap_or_else(|| {
                panic!("no frame is called {name}; V1 or V2 with bare, all, plain, lens, ten, few, thousand, these four also outlined, ten all, lens moving, moving, see-through, see-through city, magnifier or magnifier by image, these two also outlined")
            })
            .1
    };
    if let Some(name) = profile {
        // A bare draw takes targets and view from the frame before it.
        timed(&mut studio, named(&format!("{} plain", name.split(' ').next().unwrap_or_default())));
        let times: Vec<f64> = (0..pairs).map(|_| timed(&mut studio, named(&name))).collect();
        let best = times.iter().copied().fold(f64::INFINITY, f64::min);
        println!("{name}: {best:.1} ms at best, {:.1} in the mean", times.iter().sum::<f64>() / pairs as f64);
        return;
    }
    if let Some(name) = passes {
        pass_times(&mut studio, named(&name), pairs);
        return;
    }
    println!("{:<22} {:>9} {:>9} {:>24} {:>8}", "A / B", "A ms", "B ms", "ratio (95 % interval)", "target");
    let is_wanted = |name: &str| only.as_ref().is_none_or(|wanted| wanted == name);
    for (a, b, target) in ROWS.into_iter().filter(|(a, ..)| is_wanted(a)) {
        compare(&mut studio, pairs, named, [a, b], target);
    }
    for (name, still) in HOSTS.into_iter().filter(|(name, _)| is_wanted(name)) {
        host_share(&mut studio, pairs, name, [named(name), named(still)], 0.02);
    }
}

/// Frames A and B, and what their ratio is to be at most.
const ROWS: [(&str, &str, f64); 30] = [
    ("V1 plain", "V1 bare", 1.30),
    ("V2 all", "V2 bare", 1.45),
    ("V2 plain", "V2 bare", 1.45),
    ("V2 plain", "V1 plain", 0.50),
    ("V1 lens", "V1 plain", 1.05),
    ("V2 lens", "V2 plain", 1.05),
    ("V1 ten", "V1 plain", 1.30),
    ("V2 ten all", "V2 all", 1.30),
    ("V2 ten", "V2 plain", 1.30),
    ("V1 thousand", "V1 few", 1.50),
    ("V2 thousand", "V2 few", 1.50),
    ("V1 lens outlined", "V1 plain", 1.05),
    ("V2 lens outlined", "V2 plain", 1.05),
    ("V1 ten outlined", "V1 plain", 1.30),
    ("V2 ten outlined", "V2 plain", 1.30),
    ("V1 thousand outlined", "V1 few outlined", 1.50),
    ("V2 thousand outlined", "V2 few outlined", 1.50),
    ("V1 moving", "V1 thousand", 1.05),
    ("V2 moving", "V2 thousand", 1.05),
    ("V1 see-through", "V1 plain", 1.50),
    ("V2 see-through", "V2 plain", 2.00),
    ("V1 see-through city", "V1 plain", 10.0),
    ("V2 see-through city", "V2 plain", 10.0),
    ("V2 see-through city", "V2 all", 10.0),
    ("V1 magnifier", "V1 plain", 1.60),
    ("V2 magnifier", "V2 plain", 2.50),
    ("V1 magnifier outlined", "V1 plain", 1.60),
    ("V2 magnifier outlined", "V2 plain", 2.50),
    ("V1 magnifier by image", "V1 plain", 2.50),
    ("V2 magnifier by image", "V2 plain", 4.50),
];

/// Frames in which a lens moves, and the same in which it does not.
const HOSTS: [(&str, &str); 4] = [
    ("V1 lens moving", "V1 lens"),
    ("V2 lens moving", "V2 lens"),
    ("V1 moving", "V1 thousand"),
    ("V2 moving", "V2 thousand"),
];

fn view(scene: &Scene) -> View {
    View::new(scene.camera.expect("a camera"), SIZE, &Aabb::EMPTY).expect("a view")
}

/// The scene with the outlines that lenses have where nothing else is asked for.
fn outlined(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.lenses.iter_mut().for_each(|lens| lens.body = LensBody::default());
    scene
}

/// The scene with a magnifier over a tenth of the picture.
fn with_magnifier(scene: &Scene, method: RayMethod) -> Scene {
    let [width, height] = SIZE.map(f64::from);
    let ray = RayLens { method, radius: (0.1 * width / height / std::f64::consts::PI).sqrt(), ..RayLens::magnifier() };
    let lens = Lens { body: LensBody::None, ..Lens::plain("magnifier", Magnifier { ray }, [0.8, 0.2, 0.1]) };
    Scene { lenses: vec![lens], ..scene.clone() }
}

/// The scene with one of its lenses some metres away.
fn moved(scene: &Scene, metres: f64) -> Scene {
    let mut scene = scene.clone();
    let middle = scene.lenses.len() / 2;
    if let Some(Region::Shape(Shape::Sphere { center, .. })) = scene.lenses[middle].shapes.first_mut() {
        center.x += metres;
    }
    scene
}

/// The radii of a scene's lenses, metres.
fn radii(scene: &Scene) -> String {
    let radius = |lens: &Lens| match lens.shapes.first() {
        Some(Region::Shape(Shape::Sphere { radius, .. })) => format!("{radius:.1}"),
        _ => "?".to_owned(),
    };
    scene.lenses.iter().map(radius).collect::<Vec<_>>().join(", ")
}

/// Prints which part of a frame the host itself computes (the processor time of the thread that draws it), and which part it computes
/// because a lens moves: what it computes beyond the same frame with nothing moved, drawn in turn.
fn host_share(studio: &mut Studio, pairs: usize, name: &str, [moving, still]: [&Frame; 2], target: f64) {
    timed(studio, moving);
    timed(studio, still);
    let both: Vec<[[f64; 2]; 2]> = (0..pairs).map(|_| [parts(studio, moving), parts(studio, still)]).collect();
    let estimate = |values: &[f64]| Estimate::of(values).expect("one or more, and finite times");
    let whole: Vec<f64> = both.iter().map(|[moving, _]| moving[1]).collect();
    let all: Vec<f64> = both.iter().map(|[moving, _]| moving[0]).collect();
    let added: Vec<f64> = both.iter().map(|[moving, still]| moving[0] - still[0]).collect();
    for (what, host) in [("host", all), ("for moving it", added)] {
        let Estimate { median, low, high } = estimate(&ratios(&host, &whole));
        let verdict = if high <= target { "met" } else { "MISSED" };
        let [host, whole] = [&host, &whole].map(|times| estimate(times).median);
        let name = format!("{name}, {what}");
        println!("{name:<28} {host:>9.3} {whole:>9.1} {median:>9.4} ({low:.4}..{high:.4}) {target:>6.2} {verdict}");
    }
}

/// Draws one frame to its end; takes milliseconds.
fn timed(studio: &mut Studio, frame: &Frame) -> f64 {
    parts(studio, frame)[1]
}

/// Milliseconds of processor time of this thread so far; 0 where the system does not tell.
fn processor_ms() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = told.split_whitespace().next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.unwrap_or(0.0) * 1e-6
}

/// Milliseconds that the host computes for a frame, and until it is drawn.
fn parts(studio: &mut Studio, frame: &Frame) -> [f64; 2] {
    let is_software = studio.renderer.gpu.is_software();
    studio.renderer.settings.culls_hidden = is_software && !matches!(frame, Frame::Unculled(_));
    let (start, before) = (Instant::now(), processor_ms());
    match frame {
        Frame::Bare(view) => studio.renderer.draw_bare(view),
        Frame::Turns(scenes, turn) => {
            turn.set((turn.get() + 1) % scenes.len());
            studio.redraw(&scenes[turn.get()], SIZE).unwrap_or_else(|error| panic!("{error}"));
        }
        Frame::Full(scene) | Frame::Unculled(scene) => {
            studio.redraw(scene, SIZE).unwrap_or_else(|error| panic!("{error}"))
        }
    }
    studio.renderer.gpu.wait().unwrap_or_else(|error| panic!("{error}"));
    let whole = start.elapsed().as_secs_f64() * 1e3;
    // After the wait: the system counts when a thread gives way.
    [processor_ms() - before, whole]
}

/// Prints the median time of each pass of a frame, by the GPU's clock.
fn pass_times(studio: &mut Studio, frame: &Frame, pairs: usize) {
    let (Frame::Full(scene) | Frame::Unculled(scene)) = frame else { panic!("a scene is drawn in passes") };
    let request = Request { statistics: true, ..Request::plain(SIZE) };
    let mut times: Vec<(String, [u64; 2], Vec<f64>)> = Vec::new();
    for round in 0..=pairs {
        let picture = studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}"));
        for (i, pass) in picture.statistics.passes.into_iter().enumerate().filter(|_| round > 0) {
            if times.len() == i {
                times.push((pass.name, [u64::from(pass.draws), pass.triangles], Vec::new()));
            }
            times[i].2.extend(pass.gpu_ms);
        }
    }
    for (name, [draws, triangles], ms) in times {
        println!(
            "{name:<22} {draws:>6} draws {triangles:>9} triangles {:>9.2} ms",
            Estimate::of(&ms).map_or(f64::NAN, |e| e.median)
        );
    }
}

/// Draws A and B in turn and prints the median of A/B with its 95 % interval.
fn compare<'a>(studio: &mut Studio, pairs: usize, named: impl Fn(&str) -> &'a Frame, names: [&str; 2], target: f64) {
    let [a, b] = names.map(named);
    for _ in 0..2 {
        timed(studio, a);
        timed(studio, b);
    }
    let mut hosts = [Vec::new(), Vec::new()];
    let times = in_turn(2, pairs, |i| {
        let [host, whole] = parts(studio, [a, b][i]);
        hosts[i].push(host);
        Ok::<_, std::convert::Infallible>(whole)
    });
    let Ok(times) = times;
    let of = |values: &[f64]| Estimate::of(values).expect("one pair or more, and finite times");
    let [of_a, of_b] = [0, 1].map(|i| of(&times[i]).median);
    let [host_a, host_b] = hosts.map(|host| of(&host).median);
    let Estimate { median, low, high } = of(&ratios(&times[0], &times[1]));
    let verdict = if high <= target { "met" } else { "MISSED" };
    println!(
        "{:<22} {:>9.1} {:>9.1} {median:>9.3} ({low:.3}..{high:.3}) {target:>6.2} {verdict:<6} host {host_a:.2} {host_b:.2}",
        names.join(" / "),
        of_a,
        of_b
    );
    timed(studio, a);
    let layers = studio.renderer.layer_figures();
    if layers.nodes > 0 {
        let each = (of_a - of_b) * 1e6 / layers.nodes as f64;
        println!("    {} translucent fragments in {} bands, {each:.0} ns each", layers.nodes, layers.bands);
    }
}
