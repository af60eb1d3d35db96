//! Case 4: lenses cut by the near plane, the eye inside, on and outside, lenses wholly behind the eye: exact class for
//! every pixel; the same picture for near = 0.125 and 1 m where D > 1 m. Oracle: f64 entry and exit of the pixel's ray.

use std::collections::BTreeMap;

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    geom::{Aabb, Shape, Volume},
    lens::{Class, EffectUse, Lens, Region, classify},
    render::picture::Studio,
    view::{Camera, View},
};

use crate::{
    lenses::{KINDS, band, check_mask, painted, painted_class, shape},
    oracle::Numbers,
    studio,
};

const SIZE: [u32; 2] = [160, 120];

fn eye(studio: &Studio) -> (DVec3, DVec3) {
    let bounds = studio.model.geometries[studio.geometries[studio.geometries.len() / 2] as usize].bounds;
    // Before the house, a metre and a half up, looking past it.
    let eye = DVec3::new(bounds.min.x - 9.0, bounds.min.y - 6.0, bounds.min.z + 1.6);
    (eye, bounds.center())
}

fn lenses(eye: DVec3, forward: DVec3) -> Vec<(String, Shape)> {
    let turn = DQuat::from_rotation_z(0.3);
    let cube = |center, edge| Shape::Box { center, size: DVec3::splat(edge), rotation: turn };
    let ball = |center, radius| Shape::Sphere { center, radius };
    let by_hand = [
        ("ball, eye in its middle", ball(eye, 14.0)),
        ("ball, eye near its border, inside", ball(eye + forward * 9.9, 10.0)),
        ("ball, eye on its border", ball(eye + forward * 10.0, 10.0)),
        ("ball, eye near its border, outside", ball(eye + forward * 10.1, 10.0)),
        ("box, eye inside", cube(eye, 24.0)),
        ("box, eye outside", cube(eye + forward * 18.0, 16.0)),
        (
            "box, eye on a face",
            Shape::Box { center: eye + DVec3::X * 8.0, size: DVec3::new(16.0, 20.0, 30.0), rotation: DQuat::IDENTITY },
        ),
    ];
    let mut all: Vec<(String, Shape)> = by_hand.into_iter().map(|(what, shape)| (what.to_owned(), shape)).collect();
    let mut numbers = Numbers(4);
    for kind in 0..KINDS {
        for (what, center, r) in [
            ("eye in its middle", eye, 25.0),
            ("around the near plane", eye + forward * 0.6, 0.7),
            ("smaller than the near distance", eye, 0.05),
            ("beside the eye", eye + DVec3::new(-forward.y, forward.x, 0.2) * 7.0, 9.0),
            ("outside", eye + forward * 20.0, 14.0),
            ("behind the eye", eye - forward * 30.0, 20.0),
        ] {
            all.push((format!("kind {kind}, {what}"), shape(kind, center, r, &mut numbers)));
        }
    }
    all
}

/// The classes that a place at D on a ray may have, where a ray within a thousandth of a pixel, and ends within the band,
/// could be meant.
fn possible(volumes: &[Volume], view: &View, at: DVec2, d: f64) -> Vec<Class> {
    let mut classes = Vec::new();
    for (i, j) in (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j))) {
        let ray = view.ray(at + 1e-3 * DVec2::new(f64::from(i), f64::from(j)));
        let spans: Vec<(f64, f64, f64)> = volumes
            .iter()
            .filter_map(|v| v.entry_exit(&ray).map(|(enter, exit)| (enter, exit, band(v, view, d))))
            .collect();
        let of_moved = |by: f64| {
            let moved: Vec<(f64, f64)> = spans.iter().map(|(enter, exit, b)| (enter - by * b, exit + by * b)).collect();
            classify(&moved, d)
        };
        // Where the ray goes along a face, what is near it may be far from the end.
        let is_near = volumes.iter().any(|v| v.signed_distance(ray.at(d)).abs() <= band(v, view, d));
        for class in [-1.0, 0.0, 1.0].map(of_moved).into_iter().chain(is_near.then_some(Class::Inside)) {
            if !classes.contains(&class) {
                classes.push(class);
            }
        }
    }
    classes
}

#[test]
fn every_pixel_has_its_exact_class() {
    let mut studio = studio::synthetic(40);
    let (eye, target) = eye(&studio);
    let forward = (target - eye).normalize_or(DVec3::X);
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    for (what, shape) in lenses(eye, forward) {
        let camera = Camera::looking(eye, target, 1.2);
        let view = View::new(camera, SIZE, &Aabb::EMPTY).expect("a view");
        let scene = studio::scene(camera, vec![painted(vec![shape.clone()])]);
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        check_mask(&drawn, &view, &scene.lenses[0], 0).unwrap_or_else(|why| panic!("{what}: {why}"));
        let volumes = shape.volumes().expect("volumes");
        // Several bodies: which side of each other they are on is asked of each alone.
        let ids = drawn.object_id.as_ref().expect("ids");
        let depth = drawn.depth.as_ref().expect("depth");
        for i in (0..ids.len()).filter(|&i| ids[i] != 0 && volumes.len() == 1) {
            let at = DVec2::new(f64::from(i as u32 % SIZE[0]) + 0.5, f64::from(i as u32 / SIZE[0]) + 0.5);
            let class = painted_class(drawn.rgba[i]).unwrap_or_else(|| panic!("{what}: {at} has no class"));
            let possible = possible(&volumes, &view, at, f64::from(depth[i]));
            assert!(possible.contains(&class), "{what}: {at} is {class:?}, not {possible:?}");
            *seen.entry(format!("{class:?}")).or_default() += u32::from(possible.len() == 1);
        }
    }
    assert!(seen.len() == 4 && seen.values().all(|&n| n > 1_000), "{seen:?}");
}

#[test]
fn the_near_plane_changes_nothing_beyond_it() {
    let mut studio = studio::synthetic(40);
    let (eye, target) = eye(&studio);
    let forward = (target - eye).normalize_or(DVec3::X);
    // A few at a time: one shader for sixty lenses takes minutes to compile.
    for some in lenses(eye, forward).chunks(7) {
        let list: Vec<_> = some.iter().map(|(name, s)| studio::lens(name, vec![s.clone()], "sepia")).collect();
        let mut of = |near_m: f64| {
            let camera = Camera { near_m, ..Camera::looking(eye, target, 1.2) };
            studio::picture(&mut studio, &studio::scene(camera, list.clone()), SIZE)
        };
        let (close, far) = (of(0.125), of(1.0));
        assert_eq!(&close.object_id, &far.object_id, "something stands within a metre");
        let depth = far.depth.as_ref().expect("depth");
        let beyond: Vec<usize> = (0..depth.len()).filter(|&i| depth[i] > 1.0).collect();
        for (bit, (what, _)) in some.iter().enumerate() {
            let (close, far) = (studio::bits(&close, bit), studio::bits(&far, bit));
            assert!(beyond.iter().all(|&i| close[i] == far[i]), "{what}");
        }
        assert!(beyond.iter().all(|&i| close.rgba[i] == far.rgba[i]), "from {}", some[0].0);
    }
}

#[test]
fn nor_does_it_for_solids_and_combinations() {
    let mut studio = studio::synthetic(40);
    let (eye, target) = eye(&studio);
    let forward = (target - eye).normalize_or(DVec3::X);
    let places = [
        ("eye in its middle", eye, 25.0),
        ("around the near plane", eye + forward * 0.6, 0.7),
        ("outside", eye + forward * 20.0, 14.0),
        ("behind the eye", eye - forward * 30.0, 20.0),
    ];
    let mut held = 0;
    for (i, (what, at, r)) in places.into_iter().enumerate() {
        // What has no closed form: the last four.
        let shapes = studio::shapes(at, r).split_off(7);
        // Classes and places take turns; in a thorough run all of them at all of these.
        let classes = [Class::Inside, Class::Front, Class::Behind].into_iter().enumerate();
        for (_, class) in classes.filter(|(j, _)| studio::is_tried(i + j, 2)) {
            let lens = |(i, shape): (usize, &Region)| {
                let effect = EffectUse { class, ..studio::used("sepia") };
                Lens { effects: vec![effect], ..studio::lens(&i.to_string(), vec![shape.clone()], "sepia") }
            };
            let lenses: Vec<Lens> = shapes.iter().enumerate().map(lens).collect();
            let mut of = |near_m: f64| {
                let camera = Camera { near_m, ..Camera::looking(eye, target, 1.2) };
                studio::picture(&mut studio, &studio::scene(camera, lenses.clone()), SIZE)
            };
            let (close, far) = (of(0.125), of(1.0));
            let depth = far.depth.as_ref().expect("depth");
            let beyond: Vec<usize> = (0..depth.len()).filter(|&i| depth[i] > 1.0).collect();
            for bit in 0..lenses.len() {
                let (close, far) = (studio::bits(&close, bit), studio::bits(&far, bit));
                assert!(beyond.iter().all(|&i| close[i] == far[i]), "{what}, {class:?}, shape {bit}");
                held += close.iter().filter(|held| **held).count();
            }
            assert!(beyond.iter().all(|&i| close.rgba[i] == far.rgba[i]), "{what}, {class:?}");
        }
    }
    let least = if studio::is_thorough() { 10_000 } else { 4_000 };
    assert!(held > least, "{held} pixels are in some lens");
}
