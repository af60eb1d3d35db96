//! Lenses that are fixed to something, and flat lenses, against f64.

use crate::studio::*;
use glam::{DQuat, DVec2, DVec3};
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    geom::{Aabb, Shape, Volume, shape::FlatFigure},
    lens::{Class, EffectUse, Lens, LensBody, LensSprite, Parameter, Placement, Region},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
        stats::Statistics,
        volume::LensVolume,
    },
    scene::{Poi, PoiPlace, Scene, Sun, anchor::anchor, check_against},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [320, 240];

/// The middle of a house: `share` of all come before it in the file.
fn house(studio: &Studio, share: f64) -> (DVec3, String) {
    let geometry =
        &studio.model.geometries[studio.geometries[(share * studio.geometries.len() as f64) as usize] as usize];
    (geometry.bounds.center(), studio.model.objects[geometry.object as usize].id.to_string())
}

fn arrow(r: f64) -> FlatFigure {
    let points = [[0.0, 1.0], [-0.8, -0.8], [0.0, -0.3], [0.8, -0.8]].map(|p| r * DVec2::from(p));
    FlatFigure::Polygon { points: points.to_vec() }
}

fn figures(r: f64) -> [FlatFigure; 3] {
    [FlatFigure::Disc { radius: r }, FlatFigure::Rectangle { size: DVec2::new(1.7, 0.9) * r }, arrow(r)]
}

/// Turns a figure's x, y plane upright, towards `yaw` degrees.
fn upright(yaw: f64) -> DQuat {
    DQuat::from_rotation_z(yaw.to_radians()) * DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2)
}

fn flat(center: DVec3, rotation: DQuat, figure: FlatFigure) -> Shape {
    Shape::Flat { center, rotation, figure }
}

/// The view without its far plane, which only depth depends on.
fn view(camera: Camera) -> View {
    View::new(camera, SIZE, &Aabb::EMPTY).expect("a view")
}

/// What the f64 twin says of a pixel, and whether that is the same around its centre.
fn class_of(volume: &Volume, view: &View, pixel: [u32; 2], d: f64) -> Option<Class> {
    let at = DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
    let of = |offset: DVec2, d: f64| match volume.entry_exit(&view.ray(at + offset)) {
        Some((entry, _)) if d >= entry => Class::Inside,
        Some(_) => Class::Front,
        None => Class::Rest,
    };
    // A hundredth of a pixel, and the float band of an analytic test along a ray that may graze the plane.
    let near = [[0.0, 0.0], [0.01, 0.0], [-0.01, 0.0], [0.0, 0.01], [0.0, -0.01]].map(DVec2::from);
    let band = 1.0 + 1e-5;
    let all: Vec<Class> = near.into_iter().flat_map(|o| [of(o, d / band), of(o, d), of(o, d * band)]).collect();
    all.iter().all(|c| *c == all[0]).then_some(all[0])
}

/// Holds a picture's mask and counts of one lens of one volume against f64; returns how many pixels are inside, and how many of
/// these show nothing.
fn hold_to_twin(drawn: &Picture, view: &View, volume: Option<&Volume>, lens: usize) -> (usize, usize) {
    let (inside, depth) = (bits(drawn, lens), drawn.depth.as_ref().expect("depth"));
    let (mut unsure, mut counts) = (0, [0_u64; 3]);
    let mut found = (0, 0);
    for (i, [x, y]) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y])).enumerate() {
        let Some(class) = volume.map_or(Some(Class::Rest), |v| class_of(v, view, [x, y], depth[i].into())) else {
            unsure += 1;
            continue;
        };
        assert_eq!(inside[i], class == Class::Inside, "pixel {x},{y} at {} m of {volume:?}", depth[i]);
        counts[match class {
            Class::Inside => 0,
            Class::Front => 1,
            _ => 2,
        }] += 1;
        found.0 += usize::from(inside[i]);
        found.1 += usize::from(inside[i] && depth[i].is_infinite());
    }
    assert!(unsure < 400, "{unsure} pixels lie on the border");
    let c = &drawn.statistics.lenses[lens].classified;
    match volume {
        None => assert_eq!([c.inside, c.front, c.behind, c.rest], [None; 4]),
        Some(_) => {
            for (counted, sure) in [c.inside, c.front, c.rest].into_iter().zip(counts) {
                let counted = counted.expect("a count");
                assert!((sure..=sure + unsure).contains(&counted), "{counted} counted, {sure} sure, of {volume:?}");
            }
            assert_eq!(c.behind, Some(0), "nothing is behind a flat lens");
        }
    }
    found
}

/// A lens of each figure at a place, and another by its sprite.
fn flats((center, rotation, r): (DVec3, DQuat, f64)) -> Vec<Lens> {
    let twice = |figure: FlatFigure| [(figure.clone(), None), (figure, Some(LensSprite::default()))];
    let one = |(i, (figure, sprite)): (usize, (FlatFigure, Option<LensSprite>))| Lens {
        sprite,
        ..lens(&i.to_string(), vec![flat(center, rotation, figure)], "sepia")
    };
    figures(r).into_iter().flat_map(twice).enumerate().map(one).collect()
}

fn only_volume(lens: &LensVolume) -> &Volume {
    lens.region.volume().expect("a volume")
}

#[test]
fn masks_of_flat_lenses_are_right_to_the_pixel() {
    let mut studio = synthetic(60);
    let (at, _) = house(&studio, 0.5);
    let eye = at + DVec3::new(90.0, -120.0, 70.0);
    let street = at + DVec3::new(6.0, 3.0, -6.0);
    let cameras = [
        Camera::looking(eye, at, 0.9),
        orthographic(eye, at, 160.0),
        // To the horizon: a third of the picture is sky.
        Camera::looking(street, street + DVec3::new(60.0, 30.0, 6.0), 1.1),
    ];
    for (look, camera) in cameras.into_iter().enumerate() {
        let view = view(camera);
        let forward = view.basis.forward;
        let turn = DQuat::from_rotation_arc(DVec3::Z, -forward);
        let places = [
            // Facing the eye in the middle of the city; upright and level ones; one that rays graze.
            (at, turn, 30.0),
            (at, upright(20.0), 45.0),
            (at + DVec3::Z * 12.0, DQuat::IDENTITY, 40.0),
            (at, upright(100.0) * DQuat::from_rotation_y(0.35), 60.0),
            // Between the eye and the near plane; beyond the city; behind the eye; beside it, reaching behind it.
            (camera.eye + forward * 0.02, turn, 0.004),
            (camera.eye + forward * 9e4, turn, 2e4),
            (camera.eye - forward * 40.0, turn, 20.0),
            (camera.eye + view.basis.right * 3.0, DQuat::from_rotation_arc(DVec3::Z, view.basis.right), 9.0),
        ];
        let (mut inside, mut sky) = (0, 0);
        // Places take turns; in a thorough run every camera sees all.
        for (_, place) in places.into_iter().enumerate().filter(|(i, _)| is_tried(i + look, 2)) {
            let scene = scene(camera, flats(place));
            let drawn = picture(&mut studio, &scene, SIZE);
            let volumes = studio.lens_volumes(&scene, SIZE).expect("volumes");
            for i in 0..scene.lenses.len() {
                let volume = volumes.iter().find(|v| v.lens as usize == i).map(only_volume);
                let found = hold_to_twin(&drawn, &view, volume, i);
                (inside, sky) = (inside + found.0, sky + found.1);
            }
        }
        let [least, least_sky] = if is_thorough() { [20_000, 1000] } else { [8_000, 300] };
        assert!(inside > least && sky > least_sky, "{inside} pixels inside, {sky} of them sky");
    }
}

#[test]
fn what_is_seen_through_a_flat_lens_changes_up_to_the_sky() {
    let mut studio = synthetic(60);
    let (at, _) = house(&studio, 0.5);
    let eye = at + DVec3::new(-60.0, -20.0, -4.0);
    let camera = Camera::looking(eye, eye + DVec3::new(60.0, 20.0, 9.0), 1.0);
    let plain = picture(&mut studio, &scene(camera, vec![]), SIZE);
    let shape = flat(eye + DVec3::new(24.0, 8.0, 4.0), upright(70.0), arrow(14.0));
    for (sprite, body) in [(None, LensBody::None), (Some(LensSprite::default()), LensBody::None)] {
        let grey = Lens { sprite, body, ..lens("grey", vec![shape.clone()], "invert") };
        let drawn = picture(&mut studio, &scene(camera, vec![grey]), SIZE);
        let inside = bits(&drawn, 0);
        let ids = plain.object_id.as_ref().expect("ids");
        let mut changed = [0, 0];
        for i in 0..ids.len() {
            assert_eq!(drawn.rgba[i] != plain.rgba[i], inside[i], "pixel {i}");
            changed[usize::from(ids[i] == 0)] += usize::from(inside[i]);
        }
        assert!(changed[0] > 500 && changed[1] > 500, "{changed:?} pixels of the city and of the sky");
        assert_eq!(drawn.statistics.lenses[0].covered as usize, changed[0] + changed[1]);
        // Objects whose triangles meet it: at least those that are seen through it.
        let mut seen: Vec<u32> = (0..ids.len()).filter(|&i| inside[i] && ids[i] != 0).map(|i| ids[i]).collect();
        seen.sort_unstable();
        seen.dedup();
        let objects = drawn.statistics.lenses[0].objects as usize;
        assert!(objects >= seen.len() && objects < 60, "{objects} objects, {} of them seen", seen.len());
    }
}

#[test]
fn what_a_flat_lens_hides_is_gone_beyond_its_plane() {
    let mut studio = synthetic(60);
    let (at, _) = house(&studio, 0.5);
    for camera in [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        orthographic(at + DVec3::new(90.0, -120.0, 70.0), at, 160.0),
    ] {
        let view = view(camera);
        let plain = picture(&mut studio, &scene(camera, vec![]), SIZE);
        for figure in figures(35.0) {
            let shape = flat(at, upright(10.0), figure);
            let mut eraser = used("eraser");
            eraser.parameters.insert("keep_terrain".into(), Parameter::Boolean(false));
            let scene = scene(camera, vec![Lens { effects: vec![eraser], ..lens("gone", vec![shape], "eraser") }]);
            let drawn = picture(&mut studio, &scene, SIZE);
            let volume = studio.lens_volumes(&scene, SIZE).expect("volumes").remove(0);
            let volume = only_volume(&volume);
            let (before, after) = (plain.depth.as_ref().expect("depth"), drawn.depth.as_ref().expect("depth"));
            let (mut gone, mut kept) = (0, 0);
            for (i, [x, y]) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y])).enumerate() {
                match class_of(volume, &view, [x, y], before[i].into()) {
                    // Nothing of it is left: a fragment beyond the plane is hidden at any depth.
                    Some(Class::Inside) => {
                        assert!(after[i].is_infinite(), "pixel {x},{y} still shows something");
                        gone += usize::from(before[i].is_finite());
                    }
                    Some(_) => {
                        assert_eq!((before[i], plain.rgba[i]), (after[i], drawn.rgba[i]), "pixel {x},{y}");
                        kept += 1;
                    }
                    None => {}
                }
            }
            assert!(gone > 500 && kept > 10_000, "{gone} {kept}");
        }
    }
}

#[test]
fn what_a_flat_lens_hides_casts_no_shadow() {
    let sun = Sun { azimuth: 225.0_f64.to_radians(), elevation: 20.0_f64.to_radians(), ..Sun::default() };
    let of = |camera: Camera, lenses: Vec<Lens>, shadows: bool| {
        let mut scene = Scene { camera: Some(camera), lenses, sun: Sun { shadows, ..sun }, ..Scene::default() };
        scene.city.files = vec![citydata("cube.city.json")];
        scene
    };
    let mut studio = of_scene(&of(Camera::looking(DVec3::ONE, DVec3::ZERO, 1.0), vec![], true));
    let at = studio.model.geometries[studio.geometries[0] as usize].bounds.center();
    let above = at + DVec3::new(-60.0, -50.0, 60.0);
    for camera in [Camera::looking(above, at, 0.6), orthographic(above, at, 60.0)] {
        let turn = DQuat::from_rotation_arc(DVec3::Z, (above - at).normalize_or(DVec3::Z));
        for figure in [FlatFigure::Disc { radius: 25.0 }, arrow(40.0)] {
            let gone = |distance: f64| {
                let center = at + (above - at).normalize_or(DVec3::Z) * distance;
                vec![lens("gone", vec![flat(center, turn, figure.clone())], "eraser")]
            };
            let mut draw = |lenses, shadows| picture(&mut studio, &of(camera, lenses, shadows), SIZE).rgba;
            let (with_shadow, without) = (draw(vec![], true), draw(vec![], false));
            assert!(with_shadow != without, "there was no shadow");
            assert!(draw(gone(30.0), true) == draw(gone(30.0), false), "a shadow is left of {figure:?}");
            assert!(draw(gone(-200.0), true) == with_shadow, "it takes what stands before it");
        }
    }
}

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { samples: 2, aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

/// Flat and round lenses, of the scene and of the camera.
fn mixed(studio: &Studio) -> (Scene, DVec3) {
    let (at, id) = house(studio, 0.5);
    let mut lenses = vec![
        lens("flat", vec![flat(at, upright(15.0), arrow(40.0))], "greyscale"),
        lens("ahead", vec![Shape::Sphere { center: DVec3::new(20.0, -10.0, -140.0), radius: 35.0 }], "invert"),
        lens(
            "glass",
            vec![flat(DVec3::new(-0.05, 0.02, -0.4), DQuat::from_rotation_z(0.4), figures(0.09)[1].clone())],
            "sepia",
        ),
        lens(
            "house",
            vec![Shape::Cylinder { center: DVec3::Z * 5.0, radius: 20.0, height: 60.0, axis: DVec3::Z }],
            "cel",
        ),
        lens("roofless", vec![Shape::Sphere { center: DVec3::new(40.0, 0.0, 0.0), radius: 25.0 }], "eraser"),
    ];
    lenses[0].body = LensBody::Outline;
    lenses[0].effects.push(EffectUse { class: Class::Front, ..used("darken") });
    lenses[1].placement = Placement::Camera;
    lenses[2].placement = Placement::Camera;
    lenses[3].placement = Placement::Object(id);
    lenses[4].placement = Placement::Poi("place".into());
    let camera = Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9);
    let mut scene = scene(camera, lenses);
    scene.sun.shadows = true;
    scene.pois.push(Poi { name: "place".into(), place: PoiPlace::At(at + DVec3::X * 3.0) });
    (scene, at)
}

#[test]
fn both_back_ends_draw_them_alike_and_moving_the_camera_compiles_nothing() {
    let mut studio = synthetic(40);
    let (mut scene, at) = mixed(&studio);
    let names = |s: &Statistics| s.pipelines.names.join(", ");
    for (i, from) in [[40.0, -70.0, 150.0], [70.0, -40.0, 140.0], [-30.0, -60.0, 160.0]].into_iter().enumerate() {
        scene.camera = Some(Camera::looking(at + DVec3::from(from), at, 0.9));
        let (a, b) = (draw(&mut studio, &scene, Backend::Specialised), draw(&mut studio, &scene, Backend::Uber));
        assert!(a.rgba == b.rgba && a.object_id == b.object_id && a.lens_mask == b.lens_mask, "from {from:?}");
        for (lens, figures) in a.statistics.lenses.iter().enumerate() {
            assert!(figures.visible && figures.objects > 0, "lens {lens} acts on nothing");
            assert!(lens == 4 || figures.covered > 50, "lens {lens} covers {} pixels", figures.covered);
        }
        for drawn in [a, b] {
            let compiled = drawn.statistics.pipelines.compiled;
            assert!(i == 0 || compiled == 0, "{compiled} compiled from {from:?}: {}", names(&drawn.statistics));
        }
    }
}

#[test]
fn a_lens_of_the_camera_moves_with_it() {
    let mut studio = synthetic(60);
    let (at, _) = house(&studio, 0.5);
    // An egg that is long to the right, standing out to the left and below of the view axis, 120 m ahead.
    let (center, radii) = (DVec3::new(-30.0, -12.0, -120.0), DVec3::new(40.0, 15.0, 60.0));
    let egg = Shape::Ellipsoid { center, radii, rotation: DQuat::IDENTITY };
    let lens = Lens { placement: Placement::Camera, ..lens("egg", vec![egg], "sepia") };
    for camera in [
        Camera::looking(at + DVec3::new(90.0, -100.0, 50.0), at, 0.9),
        Camera::looking(at + DVec3::new(-10.0, 120.0, 70.0), at, 1.2),
        // Straight down: north is at the top.
        Camera::looking(at + DVec3::Z * 120.0, at, 1.0),
        orthographic(at + DVec3::new(-90.0, -100.0, 50.0), at, 150.0),
        Camera { up: DVec3::X, ..Camera::looking(at + DVec3::new(9.0, -100.0, 50.0), at, 0.9) },
    ] {
        let scene = scene(camera, vec![lens.clone()]);
        let drawn = picture(&mut studio, &scene, SIZE);
        let (view, inside) = (view(camera), bits(&drawn, 0));
        let depth = drawn.depth.as_ref().expect("depth");
        let mut held = 0;
        for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
            let d = f64::from(depth[i]);
            if !d.is_finite() {
                assert!(!inside[i]);
                continue;
            }
            // In the camera's axes, from the pixel alone: half a picture is tan(fov / 2) high at one metre.
            let [w, h] = SIZE.map(f64::from);
            let ndc =
                DVec2::new((f64::from(x) + 0.5 - 0.5 * w) / (0.5 * h), (0.5 * h - f64::from(y) - 0.5) / (0.5 * h));
            let scale = view.half_extent().y * if view.is_orthographic() { 1.0 } else { d };
            let q = ((scale * ndc).extend(-d) - center) / radii;
            if (q.length() - 1.0).abs() > 1e-4 {
                assert_eq!(inside[i], q.length() < 1.0, "pixel {x},{y}");
            }
            held += usize::from(inside[i]);
        }
        assert!(held > 500, "{held} pixels");
    }
}

#[test]
fn the_middle_of_an_object_is_that_of_its_whole_family() {
    let mut families = 0;
    for file in ["lod-grandchild", "lod-part", "group", "cyclic", "v10-part", "lod-all"] {
        let model = load(&[citydata(&format!("{file}.city.json"))], &LoadOptions::default(), &Quiet).expect("a city");
        // By the definition: who has it among the parents' parents, in as many steps as there are objects.
        let belongs = |object: usize, to: usize| {
            let mut found = vec![object];
            for _ in 0..model.objects.len() {
                let parents = found.iter().flat_map(|&o| &model.objects[o].parents).map(|p| *p as usize);
                found = found.iter().copied().chain(parents).collect();
                found.sort_unstable();
                found.dedup();
            }
            found.contains(&to)
        };
        for (i, object) in model.objects.iter().enumerate() {
            let own = model.geometries.iter().filter(|g| belongs(g.object as usize, i));
            let bounds = own.clone().fold(Aabb::EMPTY, |all, g| all.union(g.bounds));
            let placement = Placement::Object(object.id.to_string());
            match anchor(&placement, &Scene::default(), &model) {
                Ok(at) => assert_eq!(at, Some(bounds.center()), "{file}: {}", object.id),
                Err(problem) => assert!(bounds.is_empty(), "{file}: {problem}"),
            }
            families += usize::from(own.count() > 1);
        }
    }
    assert!(families >= 3, "{families} objects of several geometries");
}

#[test]
fn a_lens_that_is_attached_stands_where_its_object_or_place_is() {
    let mut studio = synthetic(60);
    let (at, id) = house(&studio, 0.5);
    let camera = Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9);
    // The synthetic houses have one geometry each: its middle is the object's.
    let shapes_at = |at: DVec3| [shapes(at, 20.0), vec![flat(at, upright(15.0), arrow(25.0)).into()]].concat();
    let all = |at: DVec3, placement: Placement| -> Vec<Lens> {
        let one =
            |(i, s): (usize, Region)| Lens { placement: placement.clone(), ..lens(&i.to_string(), vec![s], "sepia") };
        shapes_at(at).into_iter().enumerate().map(one).collect()
    };
    let wanted = picture(&mut studio, &scene(camera, all(at, Placement::World)), SIZE);
    assert!((0..12).all(|lens| bits(&wanted, lens).contains(&true)));
    let pois = vec![
        Poi { name: "of it".into(), place: PoiPlace::Object(id.clone()) },
        Poi { name: "there".into(), place: PoiPlace::At(at) },
    ];
    for placement in [Placement::Object(id), Placement::Poi("of it".into()), Placement::Poi("there".into())] {
        let scene = Scene { pois: pois.clone(), ..scene(camera, all(DVec3::ZERO, placement.clone())) };
        assert_eq!(check_against(&scene, &studio.model), []);
        let drawn = picture(&mut studio, &scene, SIZE);
        // Sums in another order: nothing but a rounding of f64.
        let differing =
            (0..12).map(|l| bits(&drawn, l).iter().zip(bits(&wanted, l)).filter(|(a, b)| **a != *b).count());
        assert!(differing.max() <= Some(2), "{placement:?}");
        let objects = |p: &Picture| p.statistics.lenses.iter().map(|l| l.objects).collect::<Vec<_>>();
        assert_eq!(objects(&drawn), objects(&wanted), "{placement:?}");
    }
    let plain = picture(&mut studio, &scene(camera, vec![]), SIZE);
    for nowhere in [Placement::Object("no such".into()), Placement::Poi("no such".into())] {
        let scene = scene(camera, all(DVec3::ZERO, nowhere));
        assert_eq!(check_against(&scene, &studio.model).len(), 12);
        let drawn = picture(&mut studio, &scene, SIZE);
        assert!(drawn.rgba == plain.rgba && drawn.statistics.lenses.iter().all(|l| !l.visible && l.covered == 0));
    }
}

#[test]
fn flat_lenses_that_hold_nothing_change_nothing() {
    let mut studio = synthetic(40);
    let (at, _) = house(&studio, 0.5);
    let eye = at + DVec3::new(60.0, -90.0, 40.0);
    for camera in [Camera::looking(eye, at, 0.9), orthographic(eye, at, 120.0)] {
        let view = view(camera);
        let plain = picture(&mut studio, &scene(camera, vec![]), SIZE);
        let through_eye = DQuat::from_rotation_arc(DVec3::Z, view.basis.right);
        let disc = || FlatFigure::Disc { radius: 30.0 };
        for (what, shape) in [
            ("edge on", flat(camera.eye + view.basis.forward * 50.0, through_eye, disc())),
            ("the eye in it", flat(camera.eye, through_eye, disc())),
            ("no radius", flat(at, DQuat::IDENTITY, FlatFigure::Disc { radius: 0.0 })),
            ("no width", flat(at, DQuat::IDENTITY, FlatFigure::Rectangle { size: DVec2::new(0.0, 9.0) })),
            (
                "a line",
                flat(at, DQuat::IDENTITY, FlatFigure::Polygon { points: vec![DVec2::ZERO, DVec2::X, DVec2::X] }),
            ),
        ] {
            for effect in ["sepia", "eraser"] {
                let outlined = Lens { body: LensBody::Outline, ..lens(what, vec![shape.clone()], effect) };
                let drawn = picture(&mut studio, &scene(camera, vec![outlined]), SIZE);
                assert!(drawn.rgba == plain.rgba, "{what}");
                assert_eq!(drawn.statistics.lenses[0].objects, 0, "{what}");
            }
        }
        // Nearly edge on: whatever it holds, every number is one.
        let nearly =
            flat(camera.eye + view.basis.forward * 50.0, DQuat::from_rotation_x(1e-7) * through_eye, arrow(30.0));
        let drawn = picture(&mut studio, &scene(camera, vec![lens("thin", vec![nearly], "sepia")]), SIZE);
        assert!(bits(&drawn, 0).iter().filter(|b| **b).count() < SIZE[1] as usize * 2);
    }
}
