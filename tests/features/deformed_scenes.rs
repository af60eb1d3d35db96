//! Scenes after figures of Trapp's deformation lenses (3.6.2, 3.6.3, 5.3.3): what their captions say is so.

use std::path::Path;

use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::scene_file::{Options, read},
    geom::deform::Deformers,
    render::picture::{Picture, Request, Studio},
    scene::Scene,
    view::View,
};

const SIZE: [u32; 2] = [640, 360];

fn scene_of(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"));
    let mut scene = read(&file, &Options::for_file(&file)).unwrap_or_else(|error| panic!("{error}"));
    scene.sun.shadows = false;
    scene
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    let request = Request { aovs: ALL, statistics: true, ..Request::plain(SIZE) };
    studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}"))
}

/// The same without what moves.
fn still(scene: &Scene) -> Scene {
    let mut still = scene.clone();
    still.lenses.retain(|lens| lens.deform().is_none());
    still
}

/// What each pixel shows; nothing where that is the sky.
fn places(picture: &Picture, view: &View) -> Vec<Option<DVec3>> {
    let place = |(i, depth): (usize, &f32)| {
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let forward = ray.direction.dot(view.basis.forward);
        depth.is_finite().then(|| ray.origin + ray.direction * (f64::from(*depth) / forward))
    };
    picture.depth.as_ref().unwrap().iter().enumerate().map(place).collect()
}

fn view_of(studio: &Studio, scene: &Scene) -> View {
    View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap()
}

fn no_warning(picture: &Picture) {
    let warnings = &picture.statistics.warnings;
    assert!(warnings.iter().all(|w| w["code"] != "deformation-weakened"), "{warnings:?}");
}

/// Of a line that is bent: its length, and the angle between its ends, degrees.
fn bent(deformers: &Deformers, from: DVec3, to: DVec3) -> (f64, f64) {
    let at = |i: u32| deformers.value(from.lerp(to, f64::from(i) / 4000.0));
    let length = (0..4000).map(|i| at(i).distance(at(i + 1))).sum();
    (length, (at(1) - at(0)).angle_between(at(4000) - at(3999)).to_degrees())
}

#[test]
fn trapp_3_6_2_a_city_is_bent_by_what_it_says_and_keeps_its_lengths() {
    let scene = scene_of("bent-city");
    let mut studio = of_scene(&scene);
    for (name, ends, angle_deg) in [("around-x", DVec3::Y * 150.0, 120.0), ("around-z", DVec3::X * 200.0, 100.0)] {
        let mut own = scene.clone();
        own.lenses.retain(|lens| lens.name == name);
        let deformers = studio.deformers(&own, SIZE).unwrap();
        let (length, angle) = bent(&deformers, -ends, ends);
        assert!((length - 2.0 * ends.length()).abs() < 1e-3, "{name}: {length}");
        assert!((angle - angle_deg).abs() < 0.1, "{name}: {angle}");
        let picture = drawn(&mut studio, &own);
        no_warning(&picture);
        assert_eq!(picture.statistics.frame.deformed.unwrap().coarse, 0);
    }
    no_warning(&drawn(&mut studio, &scene));
}

#[test]
fn trapp_3_6_3_a_the_church_is_twice_as_high_and_beyond_the_circle_all_stays() {
    let scene = scene_of("trapp-3-6-3-a");
    let mut studio = of_scene(&scene);
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    let middle = DVec3::new(-62.0, -12.0, 0.0);
    for z in [0.0, 10.0, 35.0] {
        let shown = deformers.value(middle + DVec3::Z * z);
        assert!((shown - middle).distance(DVec3::Z * 2.0 * z) < 1e-9, "{z}: {shown}");
    }
    let across = deformers.value(middle + DVec3::X * 0.01) - deformers.value(middle);
    assert!((across.x - 0.014).abs() < 1e-5);
    let [picture, before] = [scene.clone(), still(&scene)].map(|scene| drawn(&mut studio, &scene));
    no_warning(&picture);
    let view = view_of(&studio, &scene);
    let [now, was] = [&picture, &before].map(|picture| places(picture, &view));
    let ids = |picture: &Picture| picture.object_id.clone().unwrap();
    let (ids_now, ids_was) = (ids(&picture), ids(&before));
    let is_beyond = |p: &Option<DVec3>| p.is_some_and(|p| (p - middle).truncate().length() > 62.5);
    let beyond: Vec<usize> = (0..now.len()).filter(|&i| is_beyond(&now[i]) && is_beyond(&was[i])).collect();
    let other =
        beyond.iter().filter(|&&i| ids_now[i] != ids_was[i] || now[i].unwrap().distance(was[i].unwrap()) > 0.05);
    let other = other.count();
    assert!(beyond.len() > 90_000 && other * 1000 < beyond.len(), "{other} of {}", beyond.len());
}

#[test]
fn trapp_3_6_3_b_houses_are_an_eighth_as_high_and_show_the_market() {
    let scene = scene_of("trapp-3-6-3-b");
    let mut studio = of_scene(&scene);
    let [picture, before] = [scene.clone(), still(&scene)].map(|scene| drawn(&mut studio, &scene));
    no_warning(&picture);
    let model = studio.model.clone();
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    // Every house is pressed to an eighth, stays, or stands where the texture changes.
    let (mut pressed, mut kept) = (0, 0);
    let (mut own, mut still_there) = (0, 0);
    for triangle in triangles(&studio) {
        let id = &model.objects[model.roots()[triangle.object as usize] as usize].id;
        let top = triangle.corners.into_iter().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
        if id.starts_with("house-") && top.z > 3.0 {
            let factor = deformers.value(top).z / top.z;
            pressed += u32::from((factor - 0.125).abs() < 0.002);
            kept += u32::from((factor - 1.0).abs() < 1e-9);
        }
        if &**id == "town-hall" || &**id == "church" {
            own += 1;
            still_there += u32::from(deformers.value(top).distance(top) < 0.01);
        }
    }
    assert!(own > 100 && 100 * still_there > 95 * own, "town hall and church stay: {still_there} of {own}");
    assert!(pressed > 500 && pressed > 4 * kept, "{pressed} {kept}");
    let roots = model.roots();
    let count = |picture: &Picture, name: &str| {
        let own = model.find_object(name).unwrap();
        picture.object_id.as_ref().unwrap().iter().filter(|id| **id > 0 && roots[**id as usize - 1] == own).count()
    };
    let [church, was] = [&picture, &before].map(|picture| count(picture, "church"));
    assert!(church > was && was > 0, "{church} {was}");
}

#[test]
fn trapp_5_3_3_the_mill_is_called_out_of_its_terrain() {
    let scene = scene_of("trapp-5-3-3");
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    no_warning(&picture);
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    let hill = DVec3::new(-155.5, 113.5, 10.65);
    // Within 11 m all is lifted and one and a half times as large: it keeps its form.
    let around = [DVec3::ZERO, DVec3::X * 8.0, DVec3::Y * -9.0, DVec3::new(5.0, 5.0, 12.0), DVec3::Z * 14.0];
    let shown = around.map(|way| deformers.value(hill + way));
    for (i, way) in around.iter().enumerate() {
        let error = (shown[i] - shown[0]).distance(1.5 * *way);
        assert!(error < 0.03 * way.length() + 0.02, "{way}: {}", shown[i] - shown[0]);
    }
    assert!((shown[0].z - hill.z - 30.0).abs() < 0.3, "{}", shown[0]);
    // Beyond the lens all stays.
    for turn in 0..24 {
        let angle = f64::from(turn) * std::f64::consts::TAU / 24.0;
        let place = hill + 38.5 * DVec3::new(angle.cos(), angle.sin(), 0.0);
        assert!(deformers.value(place).distance(place) < 0.05, "{place}");
    }
    // Nothing tears: along rays from the hill places keep their order.
    for turn in 0..24 {
        let (sin, cos) = (f64::from(turn) * std::f64::consts::TAU / 24.0).sin_cos();
        let away = |r: f64| (deformers.value(hill + r * DVec3::new(cos, sin, 0.0)) - hill).truncate().length();
        assert!((0..400).all(|i| away(0.1 * f64::from(i + 1)) > away(0.1 * f64::from(i))), "{turn}");
    }
    let before = drawn(&mut studio, &still(&scene));
    let mill = studio.model.find_object("windmill").or_else(|| studio.model.find_object("mill"));
    let roots = studio.model.roots();
    let mill = roots[mill.expect("the mill") as usize];
    let count = |picture: &Picture| {
        let ids = picture.object_id.as_ref().unwrap();
        ids.iter().filter(|id| **id > 0 && roots[**id as usize - 1] == mill).count() as f64
    };
    let larger = count(&picture) / count(&before);
    assert!((1.6..3.4).contains(&larger), "{larger} times as many pixels");
}
