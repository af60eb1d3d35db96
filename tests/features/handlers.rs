//! The two back ends of the shader handlers: the same picture, and what each compiles.

use crate::studio::{self, is_thorough, is_tried, lens, scene, shapes, synthetic, used};
use glam::DVec3;
use veduta::{
    figure::scene_file::{self, Options},
    geom::Shape,
    lens::{EffectUse, Lens, LensBody, Parameter, Region},
    render::{
        frame::{Backend, ShaderPart},
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::Scene,
    shader::Blend,
    view::Camera,
};

const SIZE: [u32; 2] = [160, 90];

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    draw_of_size(studio, scene, SIZE, backend)
}

fn draw_of_size(studio: &mut Studio, scene: &Scene, size: [u32; 2], backend: Backend) -> Picture {
    let aovs = Aovs { lens_mask: true, ..Aovs::default() };
    let request = Request { samples: 2, aovs, statistics: true, backend, ..Request::plain(size) };
    studio.render(scene, &request).expect("a picture")
}

/// Overlapping lenses of all shapes over a synthetic town.
fn lenses() -> Vec<Lens> {
    let effects = [
        vec![used("cel"), used("sepia")],
        vec![EffectUse { blend: Some(Blend::Multiply), weight: Some(0.7), ..used("gooch") }],
        vec![used("posterise"), EffectUse { weight: Some(0.4), ..used("invert") }, used("flat")],
        vec![EffectUse { class: veduta::lens::Class::Behind, ..used("darken") }, used("overlay")],
    ];
    let all = shapes(DVec3::new(20.0, 20.0, 5.0), 40.0);
    let make = |(i, effects): (usize, Vec<EffectUse>)| {
        let body = if i % 2 == 0 { LensBody::Outline } else { LensBody::None };
        Lens { effects, body, ..lens(&format!("lens {i}"), every_fourth(&all, i), "sepia") }
    };
    effects.into_iter().enumerate().map(make).collect()
}

/// The shapes of one of four lenses that share them.
fn every_fourth(all: &[Region], first: usize) -> Vec<Region> {
    all.iter().skip(first).step_by(4).cloned().collect()
}

fn town() -> (Studio, Scene) {
    let camera = Camera::looking(DVec3::new(-90.0, -110.0, 90.0), DVec3::new(20.0, 20.0, 0.0), 1.0);
    let mut scene = scene(camera, lenses());
    scene.style.effects = vec![EffectUse { weight: Some(0.5), ..used("saturate") }];
    (synthetic(40), scene)
}

#[test]
fn both_back_ends_draw_the_same_bytes() {
    let (mut studio, mut scene) = town();
    // A module for all four takes a compiler longer than two for two.
    let sets = if is_thorough() { vec![0b0000, 0b0001, 0b1010, 0b1111_u32] } else { vec![0b0000, 0b1010, 0b0101] };
    for enabled in sets {
        for (i, lens) in scene.lenses.iter_mut().enumerate() {
            lens.enabled = enabled >> i & 1 == 1;
        }
        let specialised = draw(&mut studio, &scene, Backend::Specialised);
        let uber = draw(&mut studio, &scene, Backend::Uber);
        assert_eq!(specialised.rgba, uber.rgba, "{enabled:04b}");
        assert_eq!(specialised.lens_mask, uber.lens_mask, "{enabled:04b}");
        let (a, b) = (specialised.statistics, uber.statistics);
        assert_eq!(a.handlers, b.handlers, "{enabled:04b}");
        let names = |s: &veduta::render::stats::Statistics| -> Vec<String> {
            s.passes.iter().map(|p| format!("{} {} {}", p.name, p.draws, p.triangles)).collect()
        };
        assert_eq!(names(&a), names(&b), "{enabled:04b}");
    }
}

#[test]
fn the_shipped_scenes_of_built_in_cities_are_the_same_on_both() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("the scenes").map(|entry| entry.expect("a file").path()).collect();
    // Beside images; tests/data draws those of test data, and sheets are tests/sheets'.
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.retain(|path| {
        let text = std::fs::read_to_string(path).expect("a scene");
        !text.contains("VEDUTA_DATA") && !path.to_string_lossy().ends_with(".sheet.toml")
    });
    // Those of one figure are much alike, and their names begin alike.
    paths.sort();
    let mut drawn = 0;
    for (_, path) in paths.into_iter().enumerate().filter(|(i, _)| is_tried(*i, 5)) {
        let scene = scene_file::read(&path, &Options::for_file(&path)).expect("a scene");
        let mut studio = studio::of_scene(&scene);
        let a = draw(&mut studio, &scene, Backend::Specialised);
        let b = draw(&mut studio, &scene, Backend::Uber);
        assert_eq!(a.rgba, b.rgba, "{}", path.display());
        drawn += 1;
    }
    assert!(drawn > 5, "only {drawn} scenes");
}

#[test]
fn a_lens_of_no_volume_at_all_shows_nothing_on_either() {
    let (mut studio, mut scene) = town();
    scene.lenses.clear();
    let plain = draw(&mut studio, &scene, Backend::Specialised).rgba;
    let points = vec![DVec3::ZERO, DVec3::X * 40.0];
    let nothing = vec![Shape::Corridor { points, width: 0.0, height: 9.0 }];
    scene.lenses = vec![Lens { body: LensBody::Outline, ..lens("nothing", nothing, "sepia") }];
    for backend in [Backend::Specialised, Backend::Uber] {
        assert!(draw(&mut studio, &scene, backend).rgba == plain, "{backend:?}");
    }
}

#[test]
fn pipelines_that_no_frame_uses_any_more_are_given_back() {
    const MOST: usize = 20;
    let (mut studio, mut scene) = town();
    scene.lenses.truncate(1);
    studio.renderer.settings.most_pipelines = MOST;
    let mut with = |effect: &str| {
        scene.lenses[0].effects = vec![used(effect)];
        let drawn = draw_of_size(&mut studio, &scene, [48, 27], Backend::Specialised);
        (drawn, studio.renderer.pipelines().kept())
    };
    let first = with("sepia").0;
    let taken = first.statistics.pipelines.compiled as usize;
    assert!(taken < MOST, "a scene takes {taken}");
    let mut most_kept = 0;
    for effect in ["invert", "posterise", "cel", "gooch", "darken", "brighten", "greyscale", "saturate", "brick"] {
        let (drawn, kept) = with(effect);
        assert!(drawn.statistics.pipelines.compiled > 0, "{effect}");
        most_kept = most_kept.max(kept);
    }
    assert!(most_kept > taken && most_kept <= MOST + taken, "{most_kept} of {MOST} and {taken} are kept");
    // What comes back is made anew, and what stays is not.
    let again = with("sepia").0;
    assert!(again.statistics.pipelines.compiled > 0 && again.rgba == first.rgba);
    assert_eq!(with("sepia").0.statistics.pipelines.compiled, 0);
}

#[test]
fn moving_toggling_and_changing_parameters_compile_nothing() {
    let (mut studio, mut scene) = town();
    // What is compiled is the same for pictures of any size.
    let size = if is_thorough() { SIZE } else { [48, 27] };
    draw_of_size(&mut studio, &scene, size, Backend::Uber);
    let mut check = |scene: &Scene, what: &str| {
        let statistics = draw_of_size(&mut studio, scene, size, Backend::Uber).statistics;
        assert_eq!(statistics.pipelines.compiled, 0, "{what}");
    };
    for i in 0..scene.lenses.len() {
        scene.lenses[i].enabled = false;
        check(&scene, "off");
        scene.lenses[i].enabled = true;
        check(&scene, "on");
    }
    scene.lenses.reverse();
    check(&scene, "order");
    let moved: Vec<Region> = shapes(DVec3::new(-10.0, 35.0, 8.0), 25.0).into_iter().rev().collect();
    for (i, lens) in scene.lenses.iter_mut().enumerate() {
        lens.shapes = every_fourth(&moved, i);
    }
    check(&scene, "moved");
    scene.lenses[0].shapes = shapes(DVec3::new(0.0, 5000.0, 8.0), 25.0);
    check(&scene, "out of the picture");
    for lens in &mut scene.lenses {
        for effect in lens.effects.iter_mut().filter(|e| e.effect == "sepia") {
            effect.parameters.insert("amount".into(), Parameter::Number(0.25));
        }
    }
    scene.style.effects[0].weight = Some(0.9);
    check(&scene, "parameters");
}

#[test]
fn the_uber_back_end_serves_until_the_specialised_one_is_there() {
    let (mut studio, scene) = town();
    let wanted = draw(&mut studio, &scene, Backend::Specialised).rgba;
    let mut fresh = synthetic(40);
    let first = draw(&mut fresh, &scene, Backend::Adaptive);
    assert!(first.statistics.pipelines.names.iter().any(|n| n.contains("uber")), "nothing served meanwhile");
    assert_eq!(first.rgba, wanted);
    // A thread makes them; nobody waits for it but this test.
    for _ in 0..600 {
        let later = draw(&mut fresh, &scene, Backend::Adaptive);
        assert_eq!(later.rgba, wanted);
        assert_eq!(later.statistics.pipelines.compiled, 0, "a frame waited");
        if !later.statistics.pipelines.names.iter().any(|n| n.contains("uber")) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    panic!("the specialised pipelines never came");
}

#[test]
fn disabled_lenses_cost_nothing_and_change_nothing() {
    let (mut studio, mut scene) = town();
    for lens in &mut scene.lenses {
        lens.enabled = false;
    }
    let disabled = draw(&mut studio, &scene, Backend::Specialised);
    scene.lenses.clear();
    let none = draw(&mut studio, &scene, Backend::Specialised);
    assert_eq!(disabled.rgba, none.rgba);
    assert_eq!(disabled.statistics.pipelines.names, none.statistics.pipelines.names);
    assert_eq!(disabled.statistics.handlers, none.statistics.handlers);
}

#[test]
fn the_text_of_a_scene_is_readable_and_says_whose_it_is() {
    let (studio, scene) = town();
    let text = studio.shader(&scene, SIZE, Backend::Specialised, ShaderPart::Shade).expect("a text");
    assert!(text.contains("lens_0: u32,  // lens 0"), "{text}");
    assert!(
        text.contains("if is_inside(classes.lens_0) {\n        color = as_is(sepia(color, point, sepia_parameters(")
    );
    assert!(text.lines().all(|line| line.len() <= 160 && line.trim_end() == line), "a long line, or blanks at its end");
    let uber = studio.shader(&scene, SIZE, Backend::Uber, ShaderPart::Shade).expect("a text");
    assert!(uber.contains("invokers: array<PackedInvoker>") && !text.contains("Invoker"));
    let mut scene = scene;
    scene.lenses[0].effects.push(used("wireframe"));
    let part = |part: ShaderPart| studio.shader(&scene, SIZE, Backend::Specialised, part).expect("a text");
    let wanted = "if is_inside(classes_of_lens_0(sight_of(fragment))) && wireframe(fragment, wireframe_parameters(";
    assert!(part(ShaderPart::Geometry).contains(wanted) && part(ShaderPart::Shadow).contains(wanted));
    assert!(part(ShaderPart::Lines).contains("color = wireframe_parameters("));
    assert_eq!([ShaderPart::Layers, ShaderPart::Composite].map(part), ["// Nothing is translucent.\n"; 2]);
    scene.lenses[0].effects.push(used("x-ray"));
    for backend in [Backend::Specialised, Backend::Uber] {
        let text = |part| studio.shader(&scene, SIZE, backend, part).expect("a text");
        assert!(text(ShaderPart::Layers).contains("fn note_plain"), "{backend:?}");
        let composite = text(ShaderPart::Composite);
        assert!(composite.contains("contained_opacity(x_ray("), "{composite}");
    }
}
