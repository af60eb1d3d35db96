//! Many lenses in one picture.

use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::scene_file::{Options, parse},
    geom::{Aabb, Shape},
    lens::{Border, BorderUnit, Class, Discrete, EffectUse, Lens, LensBody, color},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [333, 217];

/// Balls all over the town, of which `overlap` lie over a place on average; every third acts on another class, every fifth shows
/// its outline.
fn balls(studio: &Studio, count: usize, overlap: f64) -> Vec<Lens> {
    let extent = studio.extent();
    let size = extent.size();
    let radius = (overlap * size.x * size.y / (count as f64 * std::f64::consts::PI)).sqrt();
    let effects = ["sepia", "greyscale", "invert", "darken", "glow"];
    // A sequence that spreads evenly (Roberts, the plastic number).
    let at = |i: usize| {
        let share = |step: f64| (0.5 + step * i as f64).fract();
        extent.min + DVec3::new(share(0.754_877_666), share(0.569_840_291), 0.2) * size
    };
    let one = |i: usize| {
        let shape = Shape::Sphere { center: at(i), radius: radius * (0.7 + 0.6 * (i % 7) as f64 / 6.0) };
        let class = [Class::Inside, Class::Inside, Class::Behind][i % 3];
        let body = if i.is_multiple_of(5) { LensBody::Outline } else { LensBody::None };
        let effect = EffectUse { class, ..used(effects[i % effects.len()]) };
        Lens { effects: vec![effect], body, ..lens(&format!("ball {i}"), vec![shape], "sepia") }
    };
    (0..count).map(one).collect()
}

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

#[test]
fn a_thousand_lenses_hold_what_f64_says() {
    let mut studio = synthetic(200);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(160.0, -260.0, 190.0), middle, 0.8);
    let scene = scene(camera, balls(&studio, 1000, 4.0));
    let drawn = draw(&mut studio, &scene, Backend::Specialised);
    let view = View::new(camera, SIZE, &Aabb { min: DVec3::splat(-2e4), max: DVec3::splat(2e4) }).expect("a view");
    let mut seen = 0;
    for (i, lens) in scene.lenses.iter().enumerate() {
        assert_eq!(wrong_pixels(&drawn, &view, lens, i), 0, "lens {i}");
        seen += usize::from(bits(&drawn, i).contains(&true));
    }
    assert!(seen > 500, "{seen} lenses are seen");
    // One that moves compiles nothing.
    let mut moved = scene.clone();
    let Some(veduta::lens::Region::Shape(Shape::Sphere { center, .. })) = moved.lenses[500].shapes.first_mut() else {
        panic!("a ball");
    };
    *center += DVec3::new(30.0, -12.0, 4.0);
    let again = draw(&mut studio, &moved, Backend::Specialised);
    assert_eq!(again.statistics.pipelines.compiled, 0);
    assert!(again.rgba != drawn.rgba);
}

#[test]
fn tiles_change_no_byte() {
    let mut studio = synthetic(200);
    let middle = studio.extent().center();
    for (count, eye) in [(12, DVec3::new(160.0, -260.0, 190.0)), (18, DVec3::new(4.0, -30.0, 12.0))] {
        let camera = Camera::looking(middle + eye, middle, 0.9);
        let mut scene = scene(camera, balls(&studio, count, 3.0));
        // One that is everywhere, and one by its sprite.
        scene.lenses[3].effects[0].class = Class::Rest;
        scene.lenses[5].sprite = Some(Default::default());
        scene.style.effects.push(used("saturate"));
        let [written, listed] = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend));
        assert!(written.rgba == listed.rgba, "{count} lenses");
        assert!(written.lens_mask == listed.lens_mask, "{count} lenses");
        let counts = |p: &Picture| p.statistics.lenses.iter().map(|l| l.classified).collect::<Vec<_>>();
        assert_eq!(counts(&written), counts(&listed));
    }
}

#[test]
fn more_lenses_than_are_written_out_are_gone_through_tile_by_tile() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(90.0, -140.0, 90.0), middle, 0.9);
    let request = |backend| Request { statistics: true, backend, ..Request::plain(SIZE) };
    for (count, is_listed) in [(20, false), (60, true)] {
        let scene = scene(camera, balls(&studio, count, 30.0));
        let drawn = studio.render(&scene, &request(Backend::Specialised)).expect("a picture");
        let names = &drawn.statistics.pipelines.names;
        assert_eq!(names.iter().any(|name| name.contains("shade uber")), is_listed, "{count}: {names:?}");
    }
}

/// Lists are gone through in parts of 32 invokers; here one place runs more than two of these.
#[test]
fn many_at_one_place_run_in_their_order() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(90.0, -140.0, 90.0), middle, 0.9);
    // Every second one inverts what the ones before it left.
    let one = |i: usize| {
        let effect = if i.is_multiple_of(2) { with_numbers("overlay", &[("opacity", 0.08)]) } else { used("invert") };
        let shape = Shape::Sphere { center: middle, radius: 20.0 + 1.5 * ((7 * i) % 75) as f64 };
        Lens { effects: vec![effect], ..lens(&format!("{i}"), vec![shape], "invert") }
    };
    let plain = draw(&mut studio, &scene(camera, Vec::new()), Backend::Specialised);
    let all = scene(camera, (0..75).map(one).collect());
    let drawn = draw(&mut studio, &all, Backend::Specialised);
    let inside: Vec<Vec<bool>> = (0..75).map(|i| bits(&drawn, i)).collect();
    let paint = color::linear_from_srgb([0xd5, 0x5e, 0x00].map(|c| f32::from(c as u8) / 255.0)).map(f64::from);
    let (mut most, mut some) = (0, 0);
    for (i, (before, after)) in plain.rgba.iter().zip(&drawn.rgba).enumerate() {
        let running: Vec<usize> = (0..75).filter(|&lens| inside[lens][i]).collect();
        let mut c =
            color::linear_from_srgb([before[0], before[1], before[2]].map(|c| f32::from(c) / 255.0)).map(f64::from);
        for &lens in &running {
            c = match lens % 2 {
                0 => std::array::from_fn(|k| 0.92 * c[k] + 0.08 * paint[k]),
                _ => {
                    let negative = color::srgb_from_linear(c.map(|c| c as f32)).map(|c| 1.0 - c);
                    color::linear_from_srgb(negative).map(f64::from)
                }
            };
        }
        let wanted = color::srgb_from_linear(c.map(|c| c as f32)).map(|c| 255.0 * c);
        for k in 0..3 {
            let wrong = (wanted[k] - f32::from(after[k])).abs();
            // What the plain picture is rounded by.
            assert!(wrong <= 2.0, "pixel {i}, lenses {running:?}: {after:?}, not {wanted:?}");
        }
        (most, some) = (most.max(running.len()), some + usize::from((33..65).contains(&running.len())));
    }
    assert!(most > 64 && some > 1000, "{most} lenses at a place, more than 32 at {some}");
}

#[test]
fn what_a_tile_does_not_show_changes_no_byte() {
    let mut studio = synthetic(200);
    let middle = studio.extent().center();
    let street = Camera::looking(middle + DVec3::new(4.0, -30.0, 6.0), middle + DVec3::new(60.0, 60.0, 3.0), 0.9);
    let above = Camera::looking(middle + DVec3::new(160.0, -260.0, 190.0), middle, 0.8);
    for camera in [street, above, orthographic(above.eye, middle, 200.0)] {
        let mut scene = scene(camera, balls(&studio, 120, 3.0));
        // On every class, with borders, of other shapes, and of combinations.
        for (i, lens) in scene.lenses.iter_mut().enumerate() {
            lens.effects[0].class = [Class::Inside, Class::Inside, Class::Inside, Class::Behind, Class::Rest][i % 5];
            if i.is_multiple_of(7) {
                let unit = [BorderUnit::Metres, BorderUnit::Pixels][i % 2];
                lens.border = Some(Border { width: 9.0, unit, discrete: Discrete::Threshold });
            }
        }
        for (i, focus) in shapes(middle, 20.0).into_iter().take(3).enumerate() {
            scene.lenses.push(lens(&format!("shape {i}"), [focus], "invert"));
        }
        let mut draw = |narrows: bool| {
            studio.renderer.settings.narrows_lists = narrows;
            let request =
                Request { samples: 2, statistics: true, backend: Backend::Specialised, ..Request::plain(SIZE) };
            studio.render(&scene, &request).expect("a picture")
        };
        let [all, narrowed] = [false, true].map(&mut draw);
        assert!(narrowed.statistics.passes.iter().any(|p| p.name == "narrow lists"));
        assert!(all.statistics.passes.iter().all(|p| p.name != "narrow lists"));
        assert!(all.rgba == narrowed.rgba);
    }
}

#[test]
fn more_deformations_than_a_program_holds_are_refused_at_once() {
    let scene = |count: usize| {
        let lens = |i: usize| {
            format!(
                "[[lens]]\nname = \"d{i}\"\nkind = \"deformation\"\nshape = {{ kind = \"sphere\", center = [{}, 0, 5], radius = 6 }}\n\
                 deform = [{{ kind = \"translate\", by = [0, 0, 2] }}]\n",
                i % 50
            )
        };
        let lenses: String = (0..count).map(lens).collect();
        let text = format!("veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n{lenses}");
        parse(&text, "many.toml", &Options::default()).expect("a scene")
    };
    let mut studio = of_scene(&scene(0));
    let request = Request::plain([60, 40]);
    let error = studio.render(&scene(1000), &request).expect_err("too many").to_string();
    assert!(error.starts_with("1000 deformation lenses move the city; one picture takes 64"), "{error}");
    // Those that are off count for nothing.
    let mut some = scene(1000);
    some.lenses.iter_mut().skip(2).for_each(|lens| lens.enabled = false);
    studio.render(&some, &request).expect("a picture");
}

/// The lens of a thousand and the images of a thousand layers.
#[test]
fn a_thousand_masks_are_drawn() {
    let mask = |i: usize| {
        let (x, y) = (i % 40 * 3, i / 40 * 4);
        let corners = format!("[[{x}, {y}], [{}, {y}], [{}, {}]]", x + 6, x + 6, y + 6);
        format!(
            "[[lens]]\nname = \"m{i}\"\nkind = \"color\"\nshape = {{ kind = \"mask\", points = {corners}, base = 0, height = 20 }}\n\
             effects = [\"sepia\"]\n"
        )
    };
    let masks: String = (0..1000).map(mask).collect();
    let folder = Folder::new("layers");
    let image = folder.0.join("layer.png");
    image::GrayImage::from_fn(16, 16, |x, y| image::Luma([if (x + y) % 3 == 0 { 0 } else { 255 }]))
        .save(&image)
        .expect("an image");
    let images = vec![format!("{:?}", image.display().to_string()); 1000].join(", ");
    let layers = format!(
        "[[lens]]\nname = \"layers\"\nkind = \"color\"\nshape = {{ kind = \"mask3d\", images = [{images}], corner = [-50, -50, 0], \
         size = [100, 100, 40] }}\neffects = [\"sepia\"]\n"
    );
    for lenses in [masks, layers] {
        let text = format!("veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n{lenses}");
        let options = Options { allow_outside: true, ..Options::default() };
        let scene = parse(&text, "masks.toml", &options).expect("a scene");
        let drawn = draw(&mut of_scene(&scene), &scene, Backend::Specialised);
        let pixels = &drawn.statistics.lenses.iter().map(|lens| lens.covered).sum::<u64>();
        assert!(*pixels > 100, "{pixels} pixels");
    }
}
