//! Soft shadows and the hidden sky: pictures of several samples against the integrals that they are the means of, by rays of our own in f64; with
//! lenses, whose effects these samples go through like any other.

use std::{collections::BTreeMap, f64::consts::TAU};

use crate::{
    light::{CLAY, GROUND, SKY, SUN, decoded, to_sun},
    studio::*,
};
use glam::DVec3;
use veduta::{
    geom::Shape,
    lens::{EffectUse, Lens, Parameter},
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{BaseStyle, Scene, Style, Sun, Transparency},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [160, 110];

/// Corners of the boxes: a plate with its top at 0, a tower, and a wall across a narrow street from it.
const BOXES: [([i64; 3], [i64; 3]); 3] =
    [([-80, -80, -2], [160, 160, 2]), ([-10, -10, 0], [20, 20, 30]), ([16, -40, 0], [4, 70, 18])];

fn town() -> Studio {
    with_full_shadows(boxes("sky", &BOXES, false, false))
}

/// A low sun, large enough for borders to be seen.
fn lit(camera: Camera, lenses: Vec<Lens>) -> Scene {
    Scene {
        sun: Sun { azimuth: 3.9, elevation: 0.6, size: 0.1, ..Sun::default() },
        style: Style { base: BaseStyle::Clay, ..Style::default() },
        ..scene(camera, lenses)
    }
}

fn drawn(studio: &mut Studio, scene: &Scene, samples: u32, backend: Backend) -> Picture {
    let aovs = Aovs { depth: true, normal: true, ..Aovs::default() };
    let request = Request { samples, aovs, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

fn linear(rgba: [u8; 4]) -> [f64; 3] {
    decoded([0, 1, 2].map(|k| f64::from(rgba[k]) / 255.0))
}

/// Whether one of the boxes is in the way.
fn is_hidden(from: DVec3, way: DVec3, boxes: &[([i64; 3], [i64; 3])]) -> bool {
    boxes.iter().any(|(low, size)| {
        let low = DVec3::from(low.map(|v| v as f64));
        let high = low + DVec3::from(size.map(|v| v as f64));
        let (a, b) = ((low - from) / way, (high - from) / way);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        leave > enter.max(1e-6)
    })
}

/// Means over the unit square, of places in the middle of equal parts.
fn mean(side: u32, value: impl Fn(f64, f64) -> f64) -> f64 {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let all = (0..side * side).map(|i| value(at(i % side), at(i / side)));
    all.sum::<f64>() / f64::from(side * side)
}

/// What a face of clay looks like at a place.
fn exact(scene: &Scene, place: DVec3, normal: DVec3, boxes: &[([i64; 3], [i64; 3])]) -> [f64; 3] {
    let from = place + 1e-3 * normal;
    let middle = to_sun(scene);
    let (aside, up) = middle.any_orthonormal_pair();
    let sun = mean(16, |u, v| {
        let (sin, cos) = (TAU * v).sin_cos();
        let to = (middle + (0.5 * scene.sun.size).tan() * u.sqrt() * (cos * aside + sin * up)).normalize_or(middle);
        if is_hidden(from, to, boxes) { 0.0 } else { normal.dot(to).max(0.0) }
    });
    // Of a hemisphere whose directions are all as likely: 2 cos is what each gives of all that may fall there.
    let sky = mean(40, |u, v| {
        let (sin, cos) = (TAU * v).sin_cos();
        let level = (1.0 - u * u).sqrt();
        let to = DVec3::new(level * cos, level * sin, u);
        if is_hidden(from, to, boxes) { 0.0 } else { 2.0 * normal.dot(to).max(0.0) }
    });
    std::array::from_fn(|c| CLAY[c] * (GROUND[c] * (0.5 - 0.5 * normal.z) + SKY[c] * sky + SUN[c] * sun))
}

fn cameras() -> [Camera; 3] {
    [
        Camera::looking(DVec3::new(70.0, -95.0, 60.0), DVec3::new(0.0, 0.0, 8.0), 0.7),
        // In the street, between tower and wall.
        Camera::looking(DVec3::new(13.0, -45.0, 2.0), DVec3::new(12.5, 0.0, 6.0), 1.0),
        orthographic(DVec3::new(-60.0, -80.0, 90.0), DVec3::new(0.0, 0.0, 5.0), 90.0),
    ]
}

/// Errors of the pixels of a picture whose neighbours lie on the same face: mean and root of the mean square, of a channel; and how many these are.
fn errors(scene: &Scene, picture: &Picture, boxes: &[([i64; 3], [i64; 3])]) -> (f64, f64, u32) {
    let view = View::new(scene.camera.unwrap(), SIZE, &veduta::geom::Aabb::EMPTY).unwrap();
    let (depth, normals) = (picture.depth.as_ref().unwrap(), picture.normal.as_ref().unwrap());
    let [w, h] = SIZE.map(|side| side as usize);
    let place = |i: usize| view.pixel_ray((i % w) as u32, (i / w) as u32).at(f64::from(depth[i]));
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0);
    for i in (1..h - 1).flat_map(|y| (1..w - 1).map(move |x| y * w + x)).step_by(7) {
        let normal = DVec3::from(normals[i].map(f64::from)).round();
        let is_same = |k: &usize| normals[*k] == normals[i] && (place(*k) - place(i)).dot(normal).abs() < 0.05;
        if !depth[i].is_finite() || ![i - 1, i + 1, i - w, i + w, i - w - 1, i + w + 1].iter().all(is_same) {
            continue;
        }
        let (is, wanted) = (linear(picture.rgba[i]), exact(scene, place(i), normal, boxes));
        let error = (0..3).map(|c| is[c] - wanted[c]).sum::<f64>() / 3.0;
        sum += error;
        squares += error * error;
        count += 1;
    }
    (sum / f64::from(count), (squares / f64::from(count)).sqrt(), count)
}

/// The mean over samples of what sun and sky give is their integral, and each fourfold number of them comes nearer to it.
#[test]
fn more_samples_come_nearer_to_what_all_rays_say() {
    let mut studio = town();
    for (k, camera) in cameras().into_iter().enumerate() {
        let scene = lit(camera, vec![]);
        let of = |samples: u32, studio: &mut Studio| {
            errors(&scene, &drawn(studio, &scene, samples, Backend::default()), &BOXES)
        };
        let all = [4, 16, 64].map(|samples| of(samples, &mut studio));
        println!("view {k}: {all:?}");
        let [four, sixteen, many] = all;
        assert!(four.2 > 1_000, "view {k}: {all:?}");
        assert!(sixteen.1 < 0.6 * four.1 && many.1 < 0.75 * sixteen.1, "view {k}: {all:?}");
        assert!(sixteen.1 < 0.015 && many.1 < 0.008 && many.0.abs() < 0.003, "view {k}: {all:?}");
    }
}

/// A picture of one sample that looks into itself comes near to what samples bring, so that nobody sees them come; both back ends draw the same.
#[test]
fn one_sample_tells_from_its_picture_how_much_sky_is_hidden() {
    let mut studio = town();
    for (k, camera) in cameras().into_iter().enumerate() {
        let mut scene = lit(camera, vec![]);
        scene.sun.size = 0.0;
        let mut of = |screen_occlusion: bool, backend: Backend| {
            let aovs = Aovs { depth: true, normal: true, ..Aovs::default() };
            let request = Request { aovs, backend, screen_occlusion, ..Request::plain(SIZE) };
            studio.render(&scene, &request).expect("a picture")
        };
        let [open, seen] = [false, true].map(|on| of(on, Backend::Specialised));
        assert_eq!(of(true, Backend::Uber).rgba, seen.rgba, "view {k}");
        let [before, after] = [&open, &seen].map(|picture| errors(&scene, picture, &BOXES));
        println!("view {k}: open {before:?}, seen in the picture {after:?}");
        assert!(before.2 > 1_000 && after.1 < 0.8 * before.1 && after.0.abs() < 0.75 * before.0.abs(), "view {k}");
        // Nothing else is another.
        assert!(open.depth == seen.depth && open.normal == seen.normal, "view {k}");
    }
}

fn around(low: [f64; 3], high: [f64; 3]) -> Shape {
    let (low, high) = (DVec3::from(low), DVec3::from(high));
    Shape::Box { center: 0.5 * (low + high), size: high - low, rotation: glam::DQuat::IDENTITY }
}

/// What a lens takes away hides no sky, what keeps its shadows does; with both back ends.
#[test]
fn what_a_lens_hides_leaves_the_sky_open() {
    let mut studio = town();
    let camera = cameras()[0];
    let tower = around([-10.5, -10.5, 0.2], [10.5, 10.5, 31.0]);
    let hidden = Lens { keeps_shadows: false, ..lens("away", [tower.clone()], "eraser") };
    let kept = Lens { keeps_shadows: true, ..hidden.clone() };
    let without = [BOXES[0], BOXES[2]];
    for backend in [Backend::Specialised, Backend::Uber] {
        let scene = lit(camera, vec![hidden.clone()]);
        let open = errors(&scene, &drawn(&mut studio, &scene, 16, backend), &without);
        assert!(open.1 < 0.014, "{backend:?}: {open:?}");
        let scene = lit(camera, vec![kept.clone()]);
        let picture = drawn(&mut studio, &scene, 16, backend);
        let [still, gone] = [&BOXES[..], &without].map(|boxes| errors(&scene, &picture, boxes));
        assert!(still.1 < 0.014 && gone.1 > 1.5 * still.1, "{backend:?}: {still:?}, {gone:?}");
    }
}

/// Samples that are brighter than the picture go through filters and layers as they are.
#[test]
fn filters_and_layers_see_whole_samples() {
    let mut studio = town();
    let camera = cameras()[0];
    let all = around([-90.0, -90.0, -5.0], [90.0, 90.0, 60.0]);
    let mut blurred = lens("blurred", [all.clone()], "blur");
    blurred.effects[0].parameters = BTreeMap::from([("radius".into(), Parameter::Number(0.5))]);
    let mut glass = lens("glass", [all], "transparent");
    glass.effects[0].parameters = BTreeMap::from([("opacity".into(), Parameter::Number(1.0))]);
    // What is seen through casts no shadows of its own.
    glass.keeps_shadows = true;
    // White walls with the sun in their faces: single samples are brighter than any picture.
    let mut white = lit(camera, vec![]);
    white.sun.elevation = 0.3;
    let parameters = BTreeMap::from([("color".into(), Parameter::Text("#ffffff".into()))]);
    white.style.effects = vec![EffectUse { parameters, ..used("clay") }];
    for mut scene in [lit(camera, vec![]), white] {
        for transparency in [Transparency::Exact, Transparency::of("k-buffer", None).unwrap().expect("a method")] {
            scene.style.transparency = transparency;
            let plain = drawn(&mut studio, &scene, 16, Backend::default());
            for lens in [&blurred, &glass] {
                let with = Scene { lenses: vec![lens.clone()], ..scene.clone() };
                let picture = drawn(&mut studio, &with, 16, Backend::default());
                let off = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0);
                let worst = plain.rgba.iter().zip(&picture.rgba).map(off).max().unwrap();
                // Rounding of each sample of a filter, and of the picture.
                assert!(worst <= 2, "{}: {worst} steps", lens.name);
            }
        }
    }
}
