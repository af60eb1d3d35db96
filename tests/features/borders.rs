//! Soft borders of lenses, pixel by pixel against f64.

use crate::studio::*;
use glam::{DQuat, DVec2, DVec3};
use veduta::{
    geom::{Aabb, Shape, shape::FlatFigure},
    lens::{
        Border, BorderUnit, Class, Discrete, EffectUse, Lens, LensSprite, Placement, border::degree_of_interest,
        color::linear_from_srgb,
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [320, 200];
const BACKENDS: [Backend; 2] = [Backend::Specialised, Backend::Uber];

fn draw(studio: &mut Studio, scene: &Scene, samples: u32, backend: Backend) -> Picture {
    let request = Request { samples, aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

fn view_of(camera: Camera) -> View {
    View::new(camera, SIZE, &Aabb { min: DVec3::splat(-2e4), max: DVec3::splat(2e4) }).expect("a view")
}

fn metres(width: f64) -> Option<Border> {
    Some(Border { width, unit: BorderUnit::Metres, discrete: Discrete::Threshold })
}

/// Of a byte of the picture, linear.
fn linear(byte: u8) -> f64 {
    f64::from(linear_from_srgb([f32::from(byte) / 255.0; 3])[0])
}

/// The city as it is, and with an effect everywhere: what a faded lens of that effect lies between.
fn both(studio: &mut Studio, camera: Camera) -> [Picture; 2] {
    let mut everywhere = scene(camera, vec![]);
    everywhere.style.effects = vec![used("invert")];
    [scene(camera, vec![]), everywhere].map(|scene| draw(studio, &scene, 1, Backend::Specialised))
}

/// The largest difference, in linear light, between `faded` and what lies between the two others by `share` of a pixel and of the
/// distance shown there, if any. And how many pixels are between.
fn furthest_off(
    [below, above]: &[Picture; 2],
    faded: &Picture,
    share: impl Fn(u32, u32, Option<f64>) -> f64,
) -> (f64, usize) {
    let (mut most, mut between) = (0.0_f64, 0);
    let depth = below.depth.as_ref().expect("depth was asked for");
    let [w, h] = below.size;
    for (i, (x, y)) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).enumerate() {
        let share = share(x, y, Some(f64::from(depth[i])).filter(|d| d.is_finite()));
        between += usize::from(share > 0.02 && share < 0.98);
        for channel in 0..3 {
            let [a, b, c] = [below, above, faded].map(|p| linear(p.rgba[i][channel]));
            most = most.max((c - (a + (b - a) * share)).abs());
        }
    }
    (most, between)
}

/// One step of a byte is up to 0.0089 of the light near white; three of them are rounded.
const ROUNDING: f64 = 0.012;

#[test]
fn lenses_of_every_shape_fade_as_f64_says() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let level = orthographic(middle + DVec3::new(60.0, -110.0, 80.0), middle, 150.0);
    let all = |camera: Camera| if camera == level && !is_thorough() { 3 } else { 1 };
    for (camera, width, backends) in [(camera, 24.0, &BACKENDS[..]), (level, 12.0, &BACKENDS[..1])] {
        let view = view_of(camera);
        let ends = both(&mut studio, camera);
        let shapes = shapes(middle + DVec3::new(0.0, 0.0, -4.0), 42.0).into_iter().enumerate();
        for (i, focus) in shapes.step_by(all(camera)) {
            let reference = Reference::of(&focus);
            let lens = Lens { border: metres(width), ..lens("a", [focus], "invert") };
            let scene = scene(camera, vec![lens]);
            for &backend in backends {
                let faded = draw(&mut studio, &scene, 1, backend);
                let interest = |x, y, d| degree_of_interest(reference.distance(view.pixel_ray(x, y).at(d)), width);
                let share = |x, y, d: Option<f64>| d.map_or(0.0, |d| interest(x, y, d));
                let (most, between) = furthest_off(&ends, &faded, share);
                assert!(between > 200, "shape {i}: {between} pixels between");
                assert!(most < ROUNDING, "shape {i}, {backend:?}: {most} off");
            }
        }
    }
}

#[test]
fn both_back_ends_fade_alike_to_the_byte() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let dithered = Some(Border { width: 30.0, unit: BorderUnit::Pixels, discrete: Discrete::Dither });
    let mut lenses: Vec<Lens> = shapes(middle + DVec3::new(0.0, 0.0, -4.0), 30.0)
        .into_iter()
        .enumerate()
        .map(|(i, focus)| {
            let effects = ["gooch", "blur", "clay", "marble", "hidden-line", "eraser", "gloss", "sepia", "wireframe"];
            let border = [metres(20.0), None, dithered][i % 3];
            Lens { border, ..lens(&format!("lens {i}"), [focus], effects[i % effects.len()]) }
        })
        .collect();
    lenses[4].effects.push(EffectUse { class: Class::Front, weight: Some(0.7), ..used("darken") });
    lenses[0].effects.push(EffectUse { class: Class::Rest, ..used("greyscale") });
    let scene = scene(camera, lenses);
    // A module takes a compiler more than twice as long that is twice as long.
    // Two of them, then two not; in a thorough run all.
    let parts = scene.lenses.chunks(if is_thorough() { 4 } else { 2 }).enumerate();
    for (_, part) in parts.filter(|(i, _)| is_tried(*i, 2)) {
        let scene = Scene { lenses: part.to_vec(), ..scene.clone() };
        let [one, other] = BACKENDS.map(|backend| draw(&mut studio, &scene, 2, backend));
        assert!(one.rgba == other.rgba);
    }
}

#[test]
fn a_lens_that_is_a_skin_is_where_rays_enter_and_leave_as_f64_says() {
    // What its ends are rounded by, metres.
    const BAND: f64 = 1e-3;
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let eye = middle + DVec3::new(60.0, -110.0, 80.0);
    // From outside; from within the larger ones, where rays begin at the eye, so wide that it matters; and with parallel rays.
    let within = Camera::looking(middle + DVec3::new(0.0, 0.0, 12.0), middle + DVec3::new(60.0, 20.0, 0.0), 1.2);
    let outside = Camera::looking(eye, middle, 0.8);
    for (look, (camera, half)) in
        [(outside, 2.5), (within, 18.0), (orthographic(eye, middle, 150.0), 2.5)].into_iter().enumerate()
    {
        let is_first = look == 0;
        let border = Some(Border { width: 2.0 * half, unit: BorderUnit::Ray, discrete: Discrete::Threshold });
        let is_parallel = view_of(camera).is_orthographic();
        let view = view_of(camera);
        let [below, above] = both(&mut studio, camera);
        let depth = below.depth.as_ref().expect("depth was asked for");
        let mut on = 0;
        let shapes = shapes(middle + DVec3::new(0.0, 0.0, -4.0), 42.0).into_iter().enumerate();
        let is_shown = |i: usize| is_first || is_thorough() || i % 3 == look;
        for (i, focus) in shapes.filter(|(i, _)| is_shown(*i)) {
            let reference = Reference::of(&focus);
            // Whether each pixel is on the skin; none where rounding decides.
            let is_on = |(i, d): (usize, &f32)| {
                let (x, y) = (i as u32 % SIZE[0], i as u32 / SIZE[0]);
                let start = if is_parallel { f64::NEG_INFINITY } else { 0.0 };
                // What lies behind the eye is not seen.
                let mut found = reference.intervals(&view.pixel_ray(x, y));
                found.retain(|(_, exit)| *exit > start);
                let ends = found.first().zip(found.last()).filter(|_| d.is_finite());
                let Some((first, last)) = ends else { return Some(false) };
                let away = [first.0.max(start), last.1].map(|end| (f64::from(*d) - end).abs());
                let nearest = away[0].min(away[1]);
                (away.iter().all(|away| (away - half).abs() > BAND)).then_some(nearest <= half)
            };
            let expected: Vec<Option<bool>> = depth.iter().enumerate().map(is_on).collect();
            on += expected.iter().filter(|on| **on == Some(true)).count();
            // Modules for many shapes take seconds to compile: both back ends and sprites for the first eye alone. What the other
            // eyes see without a sprite has one here.
            let with = is_first && (i % 3 > 0 || i >= 7 || is_thorough());
            let without = i % 3 == 0 || !is_first || is_thorough();
            let sprites = [(without, None), (with, Some(LensSprite::default()))];
            for (_, sprite) in sprites.into_iter().filter(|(is_asked, _)| *is_asked) {
                let lens = Lens { border, sprite, ..lens("a", [focus.clone()], "invert") };
                let scene = scene(camera, vec![lens]);
                let found = draw(&mut studio, &scene, 1, Backend::Specialised);
                if is_first && is_tried(i, 2) {
                    assert!(draw(&mut studio, &scene, 1, Backend::Uber).rgba == found.rgba, "shape {i}: not alike");
                }
                let right = |(i, on): (usize, &Option<bool>)| {
                    on.is_none_or(|on| found.rgba[i] == if on { above.rgba[i] } else { below.rgba[i] })
                };
                let wrong = expected.iter().enumerate().filter(|e| !right(*e)).count();
                // Edges of solids and of what they are combined with are drawn on a grid of 1/256 pixel.
                let most = if i < 7 { 0 } else { 24 };
                assert!(wrong <= most, "shape {i}, {sprite:?}, {camera:?}: {wrong} pixels are wrong");
            }
        }
        let least = if is_first || is_thorough() { 1_000 } else { 300 };
        assert!(on > least, "{on} pixels on a skin");
    }
}

#[test]
fn a_skin_hides_what_lies_on_it_alone() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let border = Some(Border { width: 4.0, unit: BorderUnit::Ray, discrete: Discrete::Threshold });
    let ball = Shape::Sphere { center: middle, radius: 40.0 };
    let lens = Lens { border, ..lens("a", [ball.clone()], "eraser") };
    let reference = Reference::of(&ball.into());
    let plain = draw(&mut studio, &scene(camera, vec![]), 1, Backend::Specialised);
    let [one, other] = BACKENDS.map(|backend| draw(&mut studio, &scene(camera, vec![lens.clone()]), 1, backend));
    assert!(one.rgba == other.rgba && one.depth == other.depth);
    let (view, mut gone) = (view_of(camera), 0);
    let [before, after] = [&plain, &one].map(|p| p.depth.as_ref().expect("depth was asked for"));
    for (i, (was, is)) in before.iter().zip(after).enumerate().filter(|(i, _)| is_tried(*i, 3)) {
        let found = reference.intervals(&view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]));
        let away = |d: f32| {
            let ends = found.iter().flat_map(|(a, b)| [*a, *b]);
            ends.map(|end| (f64::from(d) - end).abs()).fold(f64::INFINITY, f64::min)
        };
        if was.is_finite() && away(*was) < 1.999 {
            gone += 1;
            assert!(is > was, "pixel {i} still shows what lies on the skin");
        } else if was.is_finite() && away(*was) > 2.001 {
            assert!(is == was, "pixel {i} shows {is} instead of {was}");
        }
        assert!(!is.is_finite() || away(*is) > 1.999, "pixel {i} shows what lies on the skin");
    }
    assert!(gone > 100, "{gone} pixels");
}

#[test]
fn what_is_outside_has_what_inside_has_not() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let ends = both(&mut studio, camera);
    let view = view_of(camera);
    for (i, focus) in shapes(middle + DVec3::new(0.0, 0.0, -4.0), 42.0).into_iter().enumerate() {
        let reference = Reference::of(&focus);
        let effects = [Class::Front, Class::Behind, Class::Rest].map(|class| EffectUse { class, ..used("invert") });
        let lens = Lens { border: metres(30.0), effects: effects.to_vec(), ..lens("a", [focus], "invert") };
        let scene = scene(camera, vec![lens]);
        let faded = draw(&mut studio, &scene, 1, Backend::Specialised);
        // The background is the rest.
        let interest = |x, y, d| degree_of_interest(reference.distance(view.pixel_ray(x, y).at(d)), 30.0);
        let share = |x, y, d: Option<f64>| d.map_or(1.0, |d| 1.0 - interest(x, y, d));
        let (most, _) = furthest_off(&ends, &faded, share);
        assert!(most < ROUNDING, "shape {i}: {most} off");
    }
}

#[test]
fn flat_lenses_fade_across_their_outline() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let view = view_of(camera);
    let ends = both(&mut studio, camera);
    let figures = [
        FlatFigure::Disc { radius: 2.0 },
        FlatFigure::Rectangle { size: DVec2::new(5.0, 3.0) },
        FlatFigure::Polygon { points: vec![DVec2::new(-2.0, -2.0), DVec2::new(3.0, -1.0), DVec2::new(-1.0, 2.5)] },
    ];
    for figure in figures {
        let shape =
            Shape::Flat { center: DVec3::new(0.4, 0.2, -10.0), rotation: DQuat::IDENTITY, figure: figure.clone() };
        let placed = Lens { placement: Placement::Camera, border: metres(1.5), ..lens("a", [shape], "invert") };
        for backend in BACKENDS {
            let faded = draw(&mut studio, &scene(camera, vec![placed.clone()]), 1, backend);
            let share = |x, y, _| {
                let ray = view.pixel_ray(x, y);
                let d = ray.direction / ray.direction.dot(view.basis.forward) * 10.0;
                let at = DVec2::new(d.dot(view.basis.right) - 0.4, d.dot(view.basis.up) - 0.2);
                degree_of_interest(figure.signed_distance(at), 1.5)
            };
            // The sky fades, too.
            let (most, _) = furthest_off(&ends, &faded, share);
            assert!(most < ROUNDING, "{figure:?}, {backend:?}: {most} off");
        }
    }
}

#[test]
fn in_pixels_a_border_is_as_wide_near_and_far() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let view = view_of(camera);
    let ends = both(&mut studio, camera);
    let border = Border { width: 26.0, unit: BorderUnit::Pixels, discrete: Discrete::Threshold };
    for focus in shapes(middle + DVec3::new(0.0, 0.0, -4.0), 36.0).into_iter().step_by(3) {
        let reference = Reference::of(&focus);
        let lens = Lens { border: Some(border), ..lens("a", [focus], "invert") };
        let faded = draw(&mut studio, &scene(camera, vec![lens]), 1, Backend::Specialised);
        let interest = |x, y, d| {
            let distance = reference.distance(view.pixel_ray(x, y).at(d));
            degree_of_interest(distance, border.width_m(&view, d))
        };
        let share = |x, y, d: Option<f64>| d.map_or(0.0, |d| interest(x, y, d));
        let (most, between) = furthest_off(&ends, &faded, share);
        assert!(between > 300 && most < ROUNDING, "{between} between, {most} off");
    }
}

#[test]
fn an_eraser_ends_at_the_volume_or_pixel_by_pixel() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let ball = || Shape::Sphere { center: middle, radius: 40.0 };
    let with = |border| scene(camera, vec![Lens { border, ..lens("a", [ball()], "eraser") }]);
    let hard = draw(&mut studio, &with(None), 1, Backend::Specialised);
    let soft = draw(&mut studio, &with(metres(20.0)), 1, Backend::Specialised);
    assert!(hard.rgba == soft.rgba);
    let dithered = Border { width: 20.0, unit: BorderUnit::Metres, discrete: Discrete::Dither };
    let whole = draw(&mut studio, &scene(camera, vec![]), 1, Backend::Specialised);
    let view = view_of(camera);
    for backend in BACKENDS {
        let drawn = draw(&mut studio, &with(Some(dithered)), 1, backend);
        // Of what was there, as large a share is gone as the degree of interest says.
        let (depth, left) = (whole.depth.as_ref().expect("depth"), drawn.depth.as_ref().expect("depth"));
        let (mut wanted, mut gone, mut between) = (0.0, 0.0, 0.0);
        for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
            let d = f64::from(depth[i]);
            if !d.is_finite() {
                continue;
            }
            let share = degree_of_interest(view.pixel_ray(x, y).at(d).distance(middle) - 40.0, 20.0);
            let is_gone = left[i] != depth[i];
            assert!(share > 0.0 || !is_gone, "pixel {x}, {y} is gone outside");
            assert!(share < 1.0 || is_gone, "pixel {x}, {y} is left inside");
            if share > 0.0 && share < 1.0 {
                (wanted, gone, between) = (wanted + share, gone + f64::from(u8::from(is_gone)), between + 1.0);
            }
        }
        assert!(between > 1000.0, "{between} pixels between");
        assert!(((gone - wanted) / between).abs() < 0.03, "{gone} of {between} are gone, {wanted} should be");
    }
}
