//! Occlusion lenses: with `discard` all of a point of interest is seen, and nothing that does not hide it is gone. Oracle: the
//! object ids of pictures, of the whole city and of the point of interest alone with the ground.

#![allow(clippy::print_stdout, reason = "what was measured, for those who ask with --no-capture")]

use std::collections::{BTreeMap, BTreeSet};

use crate::studio::{self, *};
use glam::DVec3;
use veduta::{
    figure::scene_file::{self, Options},
    geom::{Aabb, Shape, combination::Operation},
    lens::{Lens, Occluders, Region, Rendering, chosen::Choice, kind::Occlusion},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Poi, PoiPlace, Scene, check_against},
    view::Camera,
    visibility::Test,
};

const SIZE: [u32; 2] = [320, 200];

fn occlusion(of: Occluders) -> Lens {
    let lens = lens("occluders", [Region::Occluders(of)], "sepia");
    Lens { kind: Occlusion::default().into(), effects: vec![], ..lens }
}

/// Each object's root, walked up.
fn roots(studio: &Studio) -> Vec<u32> {
    let objects = &studio.model.objects;
    let top = |mut object: u32| {
        while let Some(parent) = objects[object as usize].parents.first() {
            object = *parent;
        }
        object
    };
    (0..objects.len() as u32).map(top).collect()
}

/// Street views at objects: the scene, the object.
fn views(studio: &Studio, count: usize) -> Vec<(Scene, u32)> {
    let model = &studio.model;
    let boxes: Vec<(u32, Aabb)> = (0..model.objects.len() as u32)
        .filter(|&o| model.objects[o as usize].parents.is_empty() && !model.objects[o as usize].class.is_ground())
        .map(|o| (o, model.family_bounds(o)))
        .filter(|(_, b)| b.size().z > 4.0)
        .collect();
    let view = |i: usize| {
        let (object, bounds) = boxes[i * 37 % boxes.len()];
        let turn = i as f64 * 2.4;
        let eye = bounds.center().with_z(bounds.min.z + 1.7 + 3.0 * (i % 3) as f64)
            + DVec3::new(turn.cos(), turn.sin(), 0.0) * (35.0 + 12.0 * (i % 5) as f64);
        let mut scene = scene(Camera::looking(eye, bounds.center(), 0.9), vec![]);
        scene.pois =
            vec![Poi { name: "it".into(), place: PoiPlace::Object(model.objects[object as usize].id.to_string()) }];
        (scene, object)
    };
    (0..count).map(view).collect()
}

/// Hides all but an object, its parts and the ground.
fn alone(studio: &Studio, object: u32) -> Lens {
    let ground = studio.model.objects.iter().filter(|o| o.class.is_ground());
    let ids = ground.map(|o| o.id.to_string()).chain([studio.model.objects[object as usize].id.to_string()]).collect();
    lens("alone", [Region::Thematic(Choice { ids, except: true, ..Choice::default() })], "eraser")
}

fn ids(picture: &Picture) -> &[u32] {
    picture.object_id.as_deref().expect("object ids")
}

#[test]
fn discard_shows_all_of_a_point_of_interest_and_takes_nothing_else() {
    for (mut studio, count) in [(synthetic(60), 12), (self::studio::studio(&[citydata("square.city.json")]), 12)] {
        let root = roots(&studio);
        let (mut hidden, mut seen, mut gone) = (0, 0, 0);
        for (plain, object) in views(&studio, count) {
            let of = Occluders { pois: vec!["it".into()], ..Occluders::default() };
            let through = Scene { lenses: vec![occlusion(of)], ..plain.clone() };
            let lonely = Scene { lenses: vec![alone(&studio, object)], ..plain.clone() };
            let [plain, through, lonely] = [&plain, &through, &lonely].map(|s| picture(&mut studio, s, SIZE));
            let list = through.statistics.lenses[0].occluders.as_ref().expect("occluders");
            let occluders: BTreeSet<u32> =
                list.iter().map(|o| studio.model.find_object(&o.id).expect("an object")).collect();
            assert!(list.iter().all(|o| o.why == ["exact"] && o.coverage.is_some()));
            let is = |id: u32, object: u32| id > 0 && root[id as usize - 1] == object;
            for i in 0..ids(&plain).len() {
                let [was, now, own] = [&plain, &through, &lonely].map(|p| ids(p)[i]);
                seen += usize::from(is(own, object));
                assert_eq!(is(own, object), is(now, object), "pixel {i}: {own} alone, {now} through the lens");
                if is(own, object) && !is(was, object) {
                    hidden += 1;
                    assert!(occluders.contains(&root[was as usize - 1]), "pixel {i}: {was} hides it");
                }
                // What is no occluder is where it was.
                if was == 0 || !occluders.contains(&root[was as usize - 1]) {
                    assert_eq!(was, now, "pixel {i}");
                } else {
                    gone += 1;
                    assert!(
                        now == 0 || !occluders.contains(&root[now as usize - 1]),
                        "pixel {i}: {now} is still there"
                    );
                }
            }
        }
        println!("{hidden} of {seen} pixels were hidden; {gone} showed occluders");
        assert!(seen > 5_000 && hidden > 1_000 && gone > 2_000, "{hidden} of {seen}, {gone}");
    }
}

#[test]
fn back_ends_agree_and_shadows_go() {
    let mut studio = synthetic(60);
    let mut lit = 0;
    for (mut scene, _) in views(&studio, 8) {
        scene.sun.shadows = true;
        let of = Occluders { pois: vec!["it".into()], ..Occluders::default() };
        let plain = picture(&mut studio, &scene, SIZE);
        scene.lenses = vec![occlusion(of)];
        let mut draw = |backend| {
            let request = Request { aovs: ALL, backend, ..Request::plain(SIZE) };
            studio.render(&scene, &request).expect("a picture")
        };
        let (a, b) = (draw(Backend::Specialised), draw(Backend::Uber));
        assert!(a.rgba == b.rgba && a.object_id == b.object_id && a.lens_mask == b.lens_mask);
        let same_surface = (0..plain.rgba.len()).filter(|&i| ids(&plain)[i] == ids(&a)[i] && ids(&a)[i] > 0);
        lit += same_surface.filter(|&i| plain.rgba[i] != a.rgba[i]).count();
    }
    assert!(lit > 100, "shadows of what is gone are gone: {lit}");
}

#[test]
fn with_a_shape_what_of_occluders_is_in_it_goes() {
    let mut studio = synthetic(60);
    let found = views(&studio, 12).into_iter().map(|(scene, _)| {
        let camera = scene.camera.expect("a camera");
        let ball = Shape::Sphere { center: camera.eye.lerp(camera.target, 0.4), radius: 14.0 };
        let of = Occluders { pois: vec!["it".into()], ..Occluders::default() };
        let both = Region::Combined {
            how: Operation::Intersection,
            parts: vec![Region::Occluders(of.clone()), ball.clone().into()],
        };
        let mark = |focus: Region| Lens {
            shapes: vec![focus],
            kind: Occlusion { rendering: Rendering::of_effects(vec![used("sepia")]), content: None }.into(),
            ..occlusion(of.clone())
        };
        let lenses = vec![mark(Region::Occluders(of.clone())), lens("ball", [ball], "sepia"), mark(both)];
        let drawn = picture(&mut studio, &Scene { lenses, ..scene }, SIZE);
        let [whole, ball, both] = [0, 1, 2].map(|i| bits(&drawn, i));
        assert!((0..both.len()).all(|i| both[i] == (whole[i] && ball[i])));
        assert_eq!(drawn.statistics.lenses[0].occluders, drawn.statistics.lenses[2].occluders);
        assert_eq!(drawn.statistics.lenses[1].occluders, None);
        (both.iter().filter(|b| **b).count(), whole.iter().filter(|b| **b).count())
    });
    let (both, whole) = found.fold((0, 0), |(a, b), (c, d)| (a + c, b + d));
    assert!(both > 500 && whole > both + 5_000, "{both} of {whole}");
}

#[test]
fn the_city_is_asked_again_only_where_the_answer_may_be_another() {
    let mut studio = synthetic(20);
    let (mut scene, _) = views(&studio, 1).remove(0);
    let of = Occluders { pois: vec!["it".into()], ..Occluders::default() };
    scene.lenses = vec![occlusion(of.clone()), Lens { name: "same".into(), ..occlusion(of) }];
    let mut asked = |scene: &Scene| {
        let before = studio.occlusion_tests();
        studio.redraw(scene, SIZE).expect("a frame");
        studio.redraw(scene, SIZE).expect("a frame");
        studio.occlusion_tests() - before
    };
    assert_eq!(asked(&scene), 1, "lenses that look for the same ask once");
    scene.lenses[0].color = [0.1, 0.2, 0.3];
    scene.lenses[1].effects = vec![used("sepia")];
    let camera = scene.camera.expect("a camera");
    scene.camera = Some(Camera { target: camera.target + DVec3::X, ..camera });
    assert_eq!(asked(&scene), 0, "the same eye");
    scene.camera = Some(Camera { eye: camera.eye + DVec3::X, ..camera });
    assert_eq!(asked(&scene), 1, "another eye");
    scene.pois[0].place = PoiPlace::At(camera.target);
    assert_eq!(asked(&scene), 1, "another place");
    let Region::Occluders(of) = &mut scene.lenses[0].shapes[0] else { panic!("occluders") };
    of.test = Test::ViewAxis;
    assert_eq!(asked(&scene), 1, "another test, of one of both");
    scene.lenses[0].enabled = false;
    scene.camera = Some(Camera { eye: camera.eye + DVec3::Y, ..camera });
    assert_eq!(asked(&scene), 1, "of one that is disabled nobody is looked for");
}

#[test]
fn names_that_are_not_there_are_told() {
    let text = r#"
veduta = 1
[city]
files = ["builtin:square"]
[[poi]]
name = "church"
object = "church"
[[lens]]
name = "a"
kind = "occlusion"
poi = ["church", "chruch"]
force = { attribute = "no such thing" }
forbid = { ids = ["house-001", "hous-002"] }
"#;
    let scene = scene_file::parse(text, "s", &Options::for_command_line()).expect("a scene");
    let studio = of_scene(&scene);
    let told: Vec<String> = check_against(&scene, &studio.model).iter().map(ToString::to_string).collect();
    assert_eq!(told.len(), 3, "{told:?}");
    assert!(
        told[0].starts_with(
            "[lens.0] poi.1: nobody hides it: the scene has no point of interest \"chruch\"; did you mean \"church\"?"
        ),
        "{told:?}"
    );
    assert!(told[1].starts_with("[lens.0] force.attribute: chooses nothing: "), "{told:?}");
    assert!(told[2].starts_with("[lens.0] forbid.ids.1: chooses nothing: "), "{told:?}");
}

/// What a test says of every root object, here from boxes and the scene's figures.
fn by_boxes(studio: &Studio, holds: impl Fn(&Aabb) -> bool) -> BTreeSet<String> {
    let (model, root) = (&studio.model, roots(studio));
    let mut boxes: BTreeMap<u32, Aabb> = BTreeMap::new();
    for geometry in studio.geometries.iter().map(|&g| &model.geometries[g as usize]) {
        if !model.objects[geometry.object as usize].class.is_ground() {
            let own = boxes.entry(root[geometry.object as usize]).or_default();
            *own = own.union(geometry.bounds);
        }
    }
    let kept = boxes.into_iter().filter(|(_, b)| holds(b)).map(|(o, _)| model.objects[o as usize].id.to_string());
    kept.filter(|id| id != "church").collect()
}

/// The scenes after Trapp, figure 3.3.2: of each test just those are gone whom the text says.
#[test]
fn trapp_3_3_2_tests_take_what_their_equations_say() {
    for name in ["trapp-3-3-2-a", "trapp-3-3-2-b", "trapp-3-3-2-c"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"));
        let scene = scene_file::read(&path, &Options::for_file(&path)).expect("a scene");
        let mut studio = of_scene(&scene);
        let eye = scene.camera.expect("a camera").eye;
        let Some(of) = scene.lenses[0].occluders() else { panic!("an occlusion lens") };
        let points: Vec<DVec3> = of
            .pois
            .iter()
            .map(|name| match &scene.pois.iter().find(|poi| poi.name == *name).expect("a point of interest").place {
                PoiPlace::At(at) => *at,
                PoiPlace::AboveGround(_) | PoiPlace::On(_) => panic!("{name} moves"),
                PoiPlace::Object(id) => {
                    studio.model.family_bounds(studio.model.find_object(id).expect("an object")).center()
                }
            })
            .collect();
        let expected = match &of.test {
            Test::Spherical { radius, .. } => by_boxes(&studio, |b| b.center().distance(eye) < *radius),
            Test::ViewerHeight { radius, .. } => {
                by_boxes(&studio, |b| b.center().distance(eye) < *radius && b.min.z <= eye.z && eye.z <= b.max.z)
            }
            Test::ViewAxis => by_boxes(&studio, |b| {
                // A thousandth of the way at a time.
                let on_way = |p: DVec3| {
                    (0..=20_000).any(|i| {
                        let at = eye.lerp(p, f64::from(i) / 20_000.0);
                        at.cmpge(b.min).all() && at.cmple(b.max).all()
                    })
                };
                points.iter().any(|p| on_way(*p))
            }),
            other => panic!("{other:?}"),
        };
        let drawn = picture(&mut studio, &scene, SIZE);
        let list = drawn.statistics.lenses[0].occluders.as_ref().expect("occluders");
        let found: BTreeSet<String> = list.iter().map(|o| o.id.clone()).collect();
        assert_eq!(found, expected, "{name}");
        assert!(found.len() > 2, "{name}: {found:?}");
        let root = roots(&studio);
        let is_gone =
            |id: &u32| *id == 0 || !found.contains(&*studio.model.objects[root[*id as usize - 1] as usize].id);
        assert!(ids(&drawn).iter().all(is_gone), "{name}");
    }
}
