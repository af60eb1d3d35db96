//! The techniques that are kept for reference: the picture of each is that of accumulation, and what they cannot do they
//! refuse.

use crate::studio::*;
use glam::DVec3;
use veduta::{
    geom::{Shape, shape::FlatFigure},
    lens::{Border, BorderUnit, Class, Discrete, EffectUse, Lens, LensBody, Region, classify::classify},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Scene, Sun, Technique},
    shader::Blend,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [160, 100];
const AT: DVec3 = DVec3::new(20.0, 20.0, 5.0);

fn cameras() -> [Camera; 3] {
    let eye = AT + DVec3::new(-110.0, -130.0, 85.0);
    [
        Camera::looking(eye, AT, 1.0),
        orthographic(eye, AT, 150.0),
        // Inside of some of the lenses.
        Camera::looking(AT + DVec3::new(4.0, -3.0, 9.0), AT + DVec3::new(60.0, 40.0, 3.0), 1.2),
    ]
}

fn draw(studio: &mut Studio, scene: &Scene, samples: u32, transparent: bool) -> Picture {
    let request = Request {
        samples,
        transparent,
        aovs: ALL,
        statistics: true,
        backend: Backend::Specialised,
        ..Request::plain(SIZE)
    };
    studio.render(scene, &request).expect("a picture")
}

fn of_class(effect: &str, class: Class) -> EffectUse {
    EffectUse { class, ..used(effect) }
}

/// The same scene by another technique.
fn by(technique: Technique, scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.style.technique = technique;
    scene
}

/// Convex shapes of all kinds, by turns around a point: those of lens i.
fn shapes_of(i: usize, at: DVec3, r: f64) -> Vec<Region> {
    shapes(at, r).into_iter().take(7).skip(i).step_by(4).collect()
}

/// Four lenses that meet, on all classes, with effects of all kinds that shade.
fn meeting() -> Vec<Lens> {
    let effects = [
        vec![used("cel"), of_class("sepia", Class::Front)],
        vec![
            EffectUse { blend: Some(Blend::Multiply), weight: Some(0.7), ..used("gooch") },
            used("lighting"),
            used("gloss"),
        ],
        vec![EffectUse { weight: Some(0.4), ..of_class("invert", Class::Rest) }],
        vec![
            of_class("darken", Class::Behind),
            of_class("marble", Class::Behind),
            of_class("posterise", Class::Behind),
        ],
    ];
    let make = |(i, effects): (usize, Vec<EffectUse>)| {
        let at = AT + 9.0 * i as f64 * DVec3::new(1.0, -0.6, 0.1);
        Lens { effects, ..lens(&format!("lens {i}"), shapes_of(i, at, 34.0), "sepia") }
    };
    effects.into_iter().enumerate().map(make).collect()
}

/// Spheres in two rows that do not meet.
fn apart(effects: &[&str]) -> Vec<Lens> {
    let at = |i: usize| AT + DVec3::new(34.0 * (i % 3) as f64 - 34.0, 34.0 * (i / 3) as f64 - 17.0, 3.0);
    let one = |(i, effect): (usize, &&str)| {
        lens(&format!("lens {i}"), [Shape::Sphere { center: at(i), radius: 15.0 }], effect)
    };
    effects.iter().enumerate().map(one).collect()
}

fn town(camera: Camera, lenses: Vec<Lens>) -> Scene {
    let mut scene = scene(camera, lenses);
    scene.style.effects = vec![EffectUse { weight: Some(0.5), ..used("saturate") }];
    scene
}

/// The pictures are equal to the byte, and all that comes along with them.
fn assert_same(a: &Picture, b: &Picture, what: &str) {
    let unequal = a.rgba.iter().zip(&b.rgba).filter(|(a, b)| a != b).count();
    let steps = a.rgba.iter().flatten().zip(b.rgba.iter().flatten()).map(|(a, b)| a.abs_diff(*b)).max();
    // Compilers of GPUs join products and sums in one program and not in the other.
    let most = u8::from(snapping() > 0.0);
    assert!(steps <= Some(most), "{what}: {unequal} pixels differ, by at most {steps:?}");
    assert_eq!(a.lens_mask, b.lens_mask, "{what}: lens masks");
    assert_eq!(a.object_id, b.object_id, "{what}: objects");
    assert_eq!(a.normal, b.normal, "{what}: normals");
    let bits = |p: &Picture| p.depth.iter().flatten().map(|d| d.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(a), bits(b), "{what}: depths");
    assert_eq!(a.statistics.handlers, b.statistics.handlers, "{what}: handlers");
}

/// How many passes of this name a picture took.
fn passes(picture: &Picture, name: &str) -> usize {
    picture.statistics.passes.iter().filter(|pass| pass.name == name).count()
}

#[test]
fn branches_and_regions_draw_what_accumulation_draws() {
    let mut studio = synthetic(40);
    for (c, camera) in cameras().into_iter().enumerate() {
        let lenses = [meeting(), apart(&["sepia", "cel", "gloss", "invert", "lighting"])];
        for (l, lenses) in lenses.into_iter().enumerate() {
            let scene = town(camera, lenses);
            let wanted = draw(&mut studio, &scene, 1, false);
            let plain = draw(&mut studio, &Scene { lenses: vec![], ..scene.clone() }, 1, false);
            let changed = wanted.rgba.iter().zip(&plain.rgba).filter(|(a, b)| a != b).count();
            assert!(changed > 200, "camera {c}, lenses {l}: {changed} pixels show lenses");
            for technique in [Technique::Branches, Technique::Regions] {
                let found = draw(&mut studio, &by(technique, &scene), 1, false);
                assert_same(&found, &wanted, &format!("camera {c}, lenses {l}, {technique:?}"));
                let drawn = passes(&found, "geometry of a region");
                assert_eq!(drawn > 0, technique == Technique::Regions, "{drawn} passes of regions");
            }
        }
    }
}

#[test]
fn they_do_so_with_samples_shadows_and_nothing_behind_and_without_aovs() {
    let mut studio = synthetic(40);
    for technique in [Technique::Branches, Technique::Regions] {
        let mut scene = town(cameras()[0], meeting().into_iter().take(3).collect());
        scene.sun = Sun::default();
        for transparent in [false, true] {
            let wanted = draw(&mut studio, &scene, 3, transparent);
            let found = draw(&mut studio, &by(technique, &scene), 3, transparent);
            assert_same(&found, &wanted, &format!("{technique:?}, transparent: {transparent}"));
        }
        let request = Request { backend: Backend::Uber, ..Request::plain(SIZE) };
        let wanted = studio.render(&scene, &request).expect("a picture");
        let found = studio.render(&by(technique, &scene), &request).expect("a picture");
        assert!(found.rgba == wanted.rgba, "{technique:?} without AOVs");
    }
}

/// A disc before the picture's middle, seen against the sky too.
fn disc() -> Shape {
    let rotation = glam::DQuat::from_rotation_x(1.3);
    Shape::Flat { center: AT + DVec3::new(-10.0, -30.0, 24.0), rotation, figure: FlatFigure::Disc { radius: 22.0 } }
}

fn street() -> Camera {
    Camera::looking(AT + DVec3::new(-30.0, -90.0, 14.0), AT + DVec3::new(0.0, 0.0, 16.0), 1.1)
}

#[test]
fn the_background_has_its_region() {
    let mut studio = synthetic(40);
    let lenses = vec![
        Lens { effects: vec![used("sepia"), of_class("invert", Class::Front)], ..lens("disc", [disc()], "sepia") },
        Lens {
            effects: vec![of_class("darken", Class::Behind), of_class("greyscale", Class::Rest)],
            ..lens("ball", [Shape::Sphere { center: AT + DVec3::Z * 30.0, radius: 18.0 }], "sepia")
        },
    ];
    let scene = town(street(), lenses);
    let wanted = draw(&mut studio, &scene, 1, false);
    let sky = |p: &Picture| -> Vec<[u8; 4]> {
        let depth = p.depth.as_ref().expect("depth");
        p.rgba.iter().zip(depth).filter(|(_, d)| !d.is_finite()).map(|(c, _)| *c).collect()
    };
    let plain = draw(&mut studio, &Scene { lenses: vec![], ..scene.clone() }, 1, false);
    let changed = sky(&wanted).iter().zip(&sky(&plain)).filter(|(a, b)| a != b).count();
    assert!(changed > 500, "{changed} pixels of the sky show lenses");
    for technique in [Technique::Branches, Technique::Regions] {
        let found = draw(&mut studio, &by(technique, &scene), 1, false);
        assert_same(&found, &wanted, &format!("{technique:?}"));
    }
}

#[test]
fn textures_smooth_faces_and_layers_of_one_plane_are_drawn_by_regions_too() {
    let files =
        ["textured.glb", "textures.city.json", "door-in-wall.city.json", "roof-on-roof.city.json", "nodes.gltf"];
    for file in files {
        let mut studio = studio(&[citydata(file)]);
        let bounds = studio.extent();
        let (at, r) = (bounds.center(), 0.5 * bounds.size().length());
        let mut lenses = vec![
            lens("a", [Shape::Sphere { center: at + 0.3 * r * DVec3::X, radius: 0.5 * r }], "sepia"),
            lens("b", [Shape::Sphere { center: at - 0.2 * r * DVec3::Y, radius: 0.6 * r }], "cel"),
        ];
        lenses[1].effects.push(of_class("posterise", Class::Behind));
        let scene = scene(Camera::looking(at + r * DVec3::new(-1.1, -1.6, 1.2), at, 0.9), lenses);
        let wanted = draw(&mut studio, &scene, 2, false);
        let found = draw(&mut studio, &by(Technique::Regions, &scene), 2, false);
        assert!(passes(&found, "geometry of a region") > 0, "{file}");
        assert_same(&found, &wanted, file);
    }
}

#[test]
fn regions_that_cannot_occur_get_no_pass() {
    let mut studio = synthetic(40);
    let lenses = apart(&["sepia", "cel", "invert"]);
    let scene = town(cameras()[0], lenses.clone());
    let found = draw(&mut studio, &by(Technique::Regions, &scene), 1, false);
    assert_eq!(passes(&found, "geometry of a region"), 4, "the context and three lenses that do not meet");
    let mut meeting = scene.clone();
    let shape = Shape::Sphere { center: AT, radius: 30.0 };
    meeting.lenses.iter_mut().for_each(|lens| lens.shapes = vec![shape.clone().into()]);
    let found = draw(&mut studio, &by(Technique::Regions, &meeting), 1, false);
    assert_eq!(passes(&found, "geometry of a region"), 8);
    let plain = draw(&mut studio, &by(Technique::Regions, &Scene { lenses: vec![], ..scene }), 1, false);
    assert_eq!(passes(&plain, "geometry of a region"), 0, "without lenses there are no regions");
}

#[test]
fn branches_take_all_that_ends_at_once() {
    let mut studio = synthetic(40);
    let ball = |x: f64| Shape::Sphere { center: AT + DVec3::new(x, 0.0, 0.0), radius: 30.0 };
    let lenses = vec![
        Lens { effects: vec![used("blur"), of_class("sepia", Class::Behind)], ..lens("a", [ball(-20.0)], "") },
        Lens { effects: vec![used("eraser")], body: LensBody::Outline, ..lens("b", [ball(20.0)], "") },
        Lens { effects: vec![used("wireframe")], body: LensBody::Shell, ..lens("c", [ball(0.0)], "") },
    ];
    let scene = town(cameras()[0], lenses);
    let wanted = draw(&mut studio, &scene, 2, false);
    let found = draw(&mut studio, &by(Technique::Branches, &scene), 2, false);
    assert_same(&found, &wanted, "branches");
}

/// Pixels that differ, of those whose class no pixel beside them differs from: there the depth maps of R, a texel of which is a
/// pixel, leave no doubt. And how many do so at all.
fn unlike(a: &Picture, b: &Picture, scene: &Scene) -> (usize, usize) {
    let view = View::new(scene.camera.expect("a camera"), SIZE, &veduta::geom::Aabb { min: AT - 1e4, max: AT + 1e4 });
    let view = view.expect("a view");
    let depth = b.depth.as_ref().expect("depth");
    let references: Vec<Vec<Reference>> =
        scene.lenses.iter().map(|l| l.shapes.iter().map(Reference::of).collect()).collect();
    // Of the ray through the pixel x, y at the depth that a pixel beside it shows.
    let classes = |x: u32, y: u32, d: f32| -> Vec<Class> {
        let ray = view.pixel_ray(x, y);
        let of_lens = |parts: &Vec<Reference>| {
            let mut all: Vec<(f64, f64)> = parts.iter().flat_map(|part| part.intervals(&ray)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            classify(&all, f64::from(d))
        };
        references.iter().map(of_lens).collect()
    };
    let index = |x: u32, y: u32| (y * SIZE[0] + x) as usize;
    let (mut apart, mut all) = (0, 0);
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
        if a.rgba[index(x, y)] == b.rgba[index(x, y)] {
            continue;
        }
        all += 1;
        let d = depth[index(x, y)];
        let own = classes(x, y, d);
        let around = (x.saturating_sub(1)..=(x + 1).min(SIZE[0] - 1))
            .flat_map(|x| (y.saturating_sub(1)..=(y + 1).min(SIZE[1] - 1)).map(move |y| (x, y)));
        let is_plain = around.clone().all(|(x, y)| classes(x, y, d) == own && classes(x, y, depth[index(x, y)]) == own);
        apart += usize::from(is_plain);
    }
    (apart, all)
}

#[test]
fn three_passes_draw_what_accumulation_draws_but_for_borders() {
    let mut studio = synthetic(40);
    let all_classes = || {
        vec![
            used("cel"),
            of_class("sepia", Class::Front),
            of_class("invert", Class::Behind),
            of_class("darken", Class::Rest),
        ]
    };
    for (c, camera) in cameras().into_iter().enumerate() {
        for (s, shape) in shapes(AT, 30.0).into_iter().take(7).enumerate() {
            let effects = if s % 2 == 0 { all_classes() } else { vec![used("gloss"), used("gooch")] };
            let scene = town(camera, vec![Lens { effects, ..lens("one", [shape], "sepia") }]);
            let wanted = draw(&mut studio, &scene, 1, false);
            let found = draw(&mut studio, &by(Technique::ThreePass, &scene), 1, false);
            let (apart, all) = unlike(&found, &wanted, &scene);
            assert_eq!(apart, 0, "camera {c}, shape {s}: pixels that differ far from borders");
            assert!(all < 60, "camera {c}, shape {s}: {all} pixels differ");
            assert_eq!(found.depth, wanted.depth);
            assert_eq!(found.object_id, wanted.object_id);
            if c == 0 {
                // Behind and rest differ where the lens treats them so.
                assert_eq!(passes(&found, "geometry of a region"), if s % 2 == 0 { 4 } else { 3 }, "shape {s}");
            }
        }
        let two = vec![
            Shape::Sphere { center: AT - 18.0 * DVec3::X, radius: 20.0 },
            Shape::Sphere { center: AT + 12.0 * DVec3::X, radius: 20.0 },
        ];
        let scenes = [
            vec![Lens { effects: all_classes(), ..lens("of two", two, "sepia") }],
            apart(&["sepia", "cel", "gloss", "invert", "lighting", "posterise"]),
        ];
        for (l, lenses) in scenes.into_iter().enumerate() {
            let scene = town(camera, lenses);
            let wanted = draw(&mut studio, &scene, 1, false);
            let found = draw(&mut studio, &by(Technique::ThreePass, &scene), 1, false);
            let (apart, all) = unlike(&found, &wanted, &scene);
            assert_eq!(apart, 0, "camera {c}, lenses {l}: pixels that differ far from borders");
            assert!(all < 60, "camera {c}, lenses {l}: {all} pixels differ");
        }
    }
}

#[test]
fn what_a_technique_cannot_do_is_refused() {
    let mut studio = synthetic(3);
    let ball = |x: f64| Shape::Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 5.0 };
    let one = |effect: &str| lens("one", [ball(0.0)], effect);
    let many =
        |count: usize| (0..count).map(|i| lens(&format!("lens {i}"), [ball(20.0 * i as f64)], "sepia")).collect();
    let all = |class: Class| of_class("sepia", class);
    let four = |name: &str| Lens {
        effects: vec![all(Class::Inside), all(Class::Front), all(Class::Behind), all(Class::Rest)],
        ..lens(name, [ball(0.0)], "")
    };
    let soft = Border { width: 2.0, unit: BorderUnit::Metres, discrete: Discrete::default() };
    let (b, r, t) = (Technique::Branches, Technique::Regions, Technique::ThreePass);
    let cases: Vec<(Technique, Vec<Lens>, &str)> = vec![
        (b, many(7), "\"branches\" takes at most 6 lenses, for 2^6 combinations of them; the scene has 7"),
        (r, many(11), "\"regions\" takes at most 10 lenses, for 2^10 combinations of them; the scene has 11"),
        (
            b,
            vec![four("a"), four("b"), four("c")],
            "\"branches\" takes at most 64 combinations of lenses and classes; the scene has 125",
        ),
        (
            b,
            vec![Lens { border: Some(soft), ..one("sepia") }],
            "\"branches\" has no soft borders, and lens \"one\" has one",
        ),
        (
            r,
            vec![Lens { body: LensBody::Outline, ..one("sepia") }],
            "\"regions\" draws no bodies of lenses, and lens \"one\" has body = \"outline\" (\"none\" draws none)",
        ),
        (
            t,
            vec![Lens { time: vec![veduta::lens::epoch::set_to(veduta::time::Moment::FIRST)], ..one("sepia") }],
            "\"three-pass\" shows all times, and lens \"one\" has operators of time",
        ),
        (r, vec![one("eraser")], "\"regions\" hides nothing, and lens \"one\" has the effect \"eraser\""),
        (r, vec![one("blur")], "\"regions\" has no neighbourhood filters, and lens \"one\" has the effect \"blur\""),
        (t, vec![one("wireframe")], "\"three-pass\" draws no lines, and lens \"one\" has the effect \"wireframe\""),
        (
            t,
            vec![lens("one", [ball(0.0)], "sepia"), lens("two", [ball(4.0)], "sepia")],
            "\"three-pass\" takes lenses that do not meet, and lenses \"one\" and \"two\" may",
        ),
        (
            t,
            vec![four("one"), lens("two", [ball(40.0)], "sepia")],
            "\"three-pass\" takes several lenses that act inside alone, and lens \"one\" acts in front, behind or beside",
        ),
        (
            t,
            vec![lens("one", [shapes(AT, 9.0).swap_remove(7)], "sepia")],
            "\"three-pass\" needs volumes with one front and one back, and that of lens \"one\" has no such form",
        ),
    ];
    for (technique, lenses, wanted) in cases {
        let mut scene = by(technique, &town(cameras()[0], lenses));
        let found = studio.redraw(&scene, SIZE).expect_err(wanted).to_string();
        assert_eq!(found, format!("[style] technique: {wanted}; \"accumulate\" would be right"));
        scene.style.technique = Technique::Accumulate;
        studio.redraw(&scene, SIZE).expect("accumulation takes it");
    }
    let mut scene = by(r, &town(cameras()[0], vec![one("sepia")]));
    scene.style.effects.push(used("blur"));
    let found = studio.redraw(&scene, SIZE).expect_err("a filter").to_string();
    assert!(found.contains("has no neighbourhood filters, and the context has the effect \"blur\""), "{found}");
    // What is disabled is no matter.
    let mut scene = by(b, &town(cameras()[0], many(7)));
    scene.lenses[3].enabled = false;
    studio.redraw(&scene, SIZE).expect("six lenses are left");
}

#[test]
fn the_line_that_refuses_names_the_file_and_the_key() {
    let folder = std::env::temp_dir().join(format!("veduta-techniques-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let file = folder.join("seven.toml");
    let lens = "[[lens]]\nshape = { kind = \"sphere\", center = [0, 0, 0], radius = 9 }\neffects = [\"sepia\"]\n";
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[style]\ntechnique = \"branches\"\n{}",
        lens.repeat(7)
    );
    std::fs::write(&file, text).expect("a scene file");
    let run = crate::program()
        .args(["render", "-q"])
        .arg(&file)
        .arg("-o")
        .arg(folder.join("picture.png"))
        .output()
        .expect("the program runs");
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    std::fs::remove_dir_all(&folder).expect("the temporary folder");
    assert!(!run.status.success());
    let line = format!(
        "{}: [style] technique: \"branches\" takes at most 6 lenses, for 2^6 combinations of them; the scene has 7; \"accumulate\" would be right",
        file.display()
    );
    assert!(said.lines().any(|l| l.ends_with(&line)), "{said}");
}

#[test]
fn their_second_frame_compiles_and_allocates_nothing() {
    let mut studio = synthetic(40);
    let lenses = meeting();
    for technique in [Technique::Accumulate, Technique::Branches, Technique::Regions] {
        let scene = by(technique, &scene(cameras()[0], lenses.clone()));
        draw(&mut studio, &scene, 1, false);
        let again = draw(&mut studio, &scene, 1, false).statistics;
        assert_eq!((again.pipelines.compiled, again.frame.allocations), (0, 0), "{technique:?}");
    }
}
