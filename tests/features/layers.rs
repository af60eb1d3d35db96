//! Translucent layers: AOVs, lenses, borders, opacity rules, both back ends. That they are exact, and what has no room, are hard cases
//! (15 and 16).

use crate::panes::*;
use crate::studio::*;
use glam::DVec3;
use veduta::{
    geom::Shape,
    lens::{Border, BorderUnit, Class, Discrete, EffectUse, Lens, Parameter},
    render::{
        frame::Backend,
        picture::{Aovs, Request, Studio},
    },
    scene::Scene,
    view::Camera,
};

#[test]
fn layers_of_a_number_along_the_ray_grow_denser() {
    let mut random = Random(21);
    let all = panes(12, &mut random);
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let most = stacks.iter().map(Vec::len).max().unwrap_or(0);
    for of in ["pixel", "image"] {
        let mut peel = used("peel");
        peel.parameters.insert("count".into(), Parameter::Text(of.into()));
        let scene = of_context(vec![peel]);
        let found = transparency(&mut studio, &scene, Backend::Specialised, SIZE);
        let expected: Vec<_> = stacks
            .iter()
            .map(|stack| {
                let last = if of == "pixel" { stack.len() } else { most }.saturating_sub(1);
                composited(stack, |layer, _| {
                    let t = layer as f64 / last as f64;
                    if last == 0 { 1.0 } else { t * t * (3.0 - 2.0 * t) }
                })
            })
            .collect();
        let error = largest_difference(&found, &expected);
        assert!(error <= 1e-5, "{of}: {error:e}");
        assert_eq!(found, transparency(&mut studio, &scene, Backend::Uber, SIZE), "{of}");
        // In bands, the picture's number of layers is that of all of them.
        studio.renderer.settings.most_layers = Some(200);
        assert_eq!(found, transparency(&mut studio, &scene, Backend::Specialised, SIZE), "{of}, in bands");
        assert!(studio.renderer.layer_figures().bands > 2);
        studio.renderer.settings.most_layers = None;
    }
}

/// Of one building without semantics, given by its faces and its corners in millimetres.
fn building(name: &str, faces: &str, corners: &str) -> Studio {
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}},
            "CityObjects": {{"p": {{"type": "Building",
                "geometry": [{{"type": "MultiSurface", "lod": "2", "boundaries": [{faces}]}}]}}}}, "vertices": [{corners}]}}"#,
    );
    let path = std::env::temp_dir().join(format!("veduta-{name}-{}.city.json", std::process::id()));
    std::fs::write(&path, text).expect("a temporary file");
    let studio = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    studio
}

#[test]
fn layers_that_are_alike_in_everything_are_all_laid() {
    // More faces of one surface in one plane than are told apart, and than one walk through a list finds.
    let (count, a) = (60, 0.1);
    let corners = |i: usize| format!("[0,0,0],[0,10000,0],[0,10000,{0}],[0,0,{0}]", 10_000 - i);
    let faces: Vec<String> =
        (0..count).map(|i| format!("[[{}, {}, {}, {}]]", 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3)).collect();
    let mut studio = building("alike", &faces.join(","), &(0..count).map(corners).collect::<Vec<_>>().join(","));
    let scene = of_context(vec![with_numbers("transparent", &[("opacity", a)])]);
    let middle = (SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize;
    for backend in [Backend::Specialised, Backend::Uber] {
        let found = transparency(&mut studio, &scene, backend, SIZE)[middle];
        let through = (1.0 - f64::from(a as f32)).powi(count as i32);
        assert!((f64::from(found[3]) - through).abs() <= 60.0 * 2.0_f64.powi(-24), "{backend:?}: {found:?}, {through}");
    }
}

/// A lens over the synthetic town that does this to one of its classes.
fn town_lens(effect: EffectUse, border: Option<Border>) -> Lens {
    let shape = Shape::Sphere { center: DVec3::new(0.0, 0.0, 5.0), radius: 30.0 };
    Lens { effects: vec![effect], border, ..lens("see through", vec![shape], "eraser") }
}

#[test]
fn what_is_wholly_clear_is_as_if_erased_and_what_is_opaque_as_if_untouched() {
    let mut studio = synthetic(60);
    let center = studio.extent().center();
    let camera = Camera {
        eye: center + DVec3::new(-70.0, -110.0, 60.0),
        target: center,
        ..studio.camera(&Scene::default(), SIZE)
    };
    for class in [Class::Inside, Class::Front, Class::Behind, Class::Rest] {
        for keeps in [true, false] {
            let used = |effect: &str, numbers: &[(&str, f64)]| {
                let mut one = EffectUse { class, ..with_numbers(effect, numbers) };
                one.parameters.insert("keep_terrain".into(), Parameter::Boolean(keeps));
                let mut lens = town_lens(one, None);
                lens.shapes = vec![Shape::Sphere { center, radius: 30.0 }.into()];
                lens
            };
            for backend in [Backend::Specialised, Backend::Uber] {
                let mut drawn = |lenses: Vec<Lens>| {
                    let mut scene = scene(camera, lenses);
                    scene.sun.shadows = true;
                    studio.render(&scene, &request(backend)).expect("a picture")
                };
                let clear = drawn(vec![used("transparent", &[("opacity", 0.0)])]);
                let erased = drawn(vec![used("eraser", &[])]);
                assert_eq!(clear.rgba, erased.rgba, "{class:?} {backend:?}");
                assert_eq!((&clear.depth, &clear.object_id), (&erased.depth, &erased.object_id));
                assert_eq!((&clear.normal, &clear.lens_mask), (&erased.normal, &erased.lens_mask));
                let plain =
                    drawn(vec![used("eraser", &[])].into_iter().map(|l| Lens { effects: vec![], ..l }).collect());
                assert_ne!(clear.object_id, plain.object_id, "{class:?}: something went");
                // Shadows go with what is translucent, so only what is shown is compared.
                let opaque = drawn(vec![used("transparent", &[("opacity", 1.0)])]);
                assert_eq!(opaque.object_id, plain.object_id, "{class:?} {backend:?}");
                assert_eq!(opaque.lens_mask, plain.lens_mask, "{class:?} {backend:?}");
                let off = |(a, b): (&f32, &f32)| a != b && (a - b).abs() > 1e-6 * b;
                let [a, b] = [&opaque, &plain].map(|p| p.depth.as_ref().expect("depths"));
                assert!(!a.iter().zip(b).any(off), "{class:?} {backend:?}");
                assert_eq!(opaque.normal, plain.normal, "{class:?} {backend:?}");
            }
        }
    }
}

#[test]
fn the_shown_surface_is_where_half_of_the_light_comes_from() {
    let mut random = Random(5);
    let all = panes(6, &mut random);
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    for (opacity, layer) in [(0.6, 0), (0.3, 1), (0.2, 3), (0.05, 6)] {
        let scene = of_context(vec![rule("transparent", &[("opacity", opacity)], None, false)]);
        let aovs = Aovs { lens_mask: false, ..ALL };
        let picture =
            studio.render(&scene, &Request { size: SIZE, aovs, ..request(Backend::Specialised) }).expect("a picture");
        let (ids, depths) = (picture.object_id.expect("ids"), picture.depth.expect("depths"));
        let normals = picture.normal.expect("normals");
        let index_of = |pane: usize| {
            let name = format!("p{pane}");
            let objects = &studio.model.objects;
            objects.iter().position(|o| *o.id == *name).expect("the object") as u32 + 1
        };
        for (i, stack) in stacks.iter().enumerate() {
            match stack.get(layer) {
                None => assert_eq!((ids[i], depths[i], normals[i]), (0, f32::INFINITY, [0.0; 3]), "{opacity}"),
                Some((pane, _)) => {
                    assert_eq!(ids[i], index_of(*pane), "{opacity}");
                    let d = 20.0 + all[*pane].x as f32 / 1000.0;
                    assert!((depths[i] - d).abs() < 1e-4 && normals[i] == [-1.0, 0.0, 0.0], "{opacity}: {}", depths[i]);
                }
            }
        }
    }
}

#[test]
fn a_lens_out_of_view_leaves_no_layers_behind() {
    let mut random = Random(8);
    let all = panes(5, &mut random);
    let mut studio = studio_of(&all);
    let at = |x: f64| {
        let shape = Shape::Sphere { center: DVec3::new(x, 5.0, 5.0), radius: 6.0 };
        let clear = with_numbers("transparent", &[("opacity", 0.2)]);
        scene(camera(), vec![Lens { effects: vec![clear], ..lens("l", vec![shape], "eraser") }])
    };
    for backend in [Backend::Uber, Backend::Specialised] {
        let mut drawn = |scene: &Scene| studio.render(scene, &request(backend)).expect("a picture").rgba;
        let plain = drawn(&scene(camera(), vec![]));
        // Never in view before, then in view, and gone again.
        assert_eq!(drawn(&at(-900.0)), plain, "{backend:?}");
        assert_ne!(drawn(&at(0.0)), plain, "{backend:?}");
        assert_eq!(drawn(&at(-900.0)), plain, "{backend:?}");
    }
}

#[test]
fn what_is_opaque_is_known_behind_layers() {
    let mut random = Random(12);
    let mut all = panes(7, &mut random);
    all[6] = Pane { low: [0, 0], high: [9000, 9000], ..all[6] };
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let clear = rule("transparent", &[("opacity", 0.25)], Some(&[6]), true);
    let found = studio.transmittance(&of_context(vec![clear]), SIZE).expect("a frame");
    let ids =
        picture(&mut studio, &of_context(vec![rule("eraser", &[], Some(&[6]), true)]), SIZE).object_id.expect("ids");
    assert_eq!(found.object_id, ids);
    for (stack, through) in stacks.iter().zip(&found.through) {
        let layers = stack.iter().filter(|(pane, _)| *pane != 6).count();
        assert!((f64::from(*through) - 0.75_f64.powi(layers as i32)).abs() < 1e-6);
    }
    let plain = studio.transmittance(&of_context(vec![]), SIZE).expect("a frame");
    assert!(plain.through.iter().all(|t| *t == 1.0));
}

#[test]
fn a_soft_border_leads_from_opaque_to_clear() {
    let all = [Pane { name: 0, x: 0, low: [0, 0], high: [10_000, 10_000], material: 0 }];
    let mut studio = studio_of(&all);
    let border = Border { width: 4.0, unit: BorderUnit::Metres, discrete: Discrete::Dither };
    let clear = with_numbers("transparent", &[("opacity", 0.0)]);
    let shape = Shape::Sphere { center: DVec3::new(0.0, 5.0, 5.0), radius: 3.0 };
    let lens = Lens { border: Some(border), ..Lens { effects: vec![clear], ..lens("soft", vec![shape], "eraser") } };
    let scene = scene(camera(), vec![lens]);
    for backend in [Backend::Specialised, Backend::Uber] {
        let found = transparency(&mut studio, &scene, backend, SIZE);
        // Along the middle row: opaque outside, clear inside, and never back.
        let row: Vec<f32> = (0..SIZE[0] / 2).map(|x| found[(SIZE[1] / 2 * SIZE[0] + x) as usize][3]).collect();
        let seen: Vec<f32> = row.iter().copied().filter(|t| *t > 0.0 && *t < 1.0).collect();
        assert!(seen.len() > 4 && seen.is_sorted(), "{backend:?}: {row:?}");
        assert_eq!(found[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize][3], 1.0);
    }
}

#[test]
fn many_samples_and_nothing_behind_the_city() {
    let mut random = Random(17);
    let all = panes(5, &mut random);
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let scene = of_context(vec![rule("transparent", &[("opacity", 0.3)], None, false)]);
    let base = Request { size: SIZE, transparent: true, aovs: Aovs::default(), ..request(Backend::Specialised) };
    let one = studio.render(&scene, &base).expect("a picture");
    for (stack, found) in stacks.iter().zip(&one.rgba) {
        let alpha = 1.0 - 0.7_f64.powi(stack.len() as i32);
        assert!((f64::from(found[3]) / 255.0 - alpha).abs() <= 0.5 / 255.0 + 1e-6, "{found:?}");
    }
    let many = studio.render(&scene, &Request { samples: 16, ..base }).expect("a picture");
    let of = |picture: &[[u8; 4]]| picture.iter().map(|p| f64::from(p[3])).sum::<f64>() / picture.len() as f64;
    assert!((of(&one.rgba) - of(&many.rgba)).abs() < 2.0, "as opaque on the whole");
    assert_ne!(one.rgba, many.rgba, "edges are smooth");
}

#[test]
fn x_ray_shows_faces_by_how_they_are_seen() {
    let all = [Pane { name: 0, x: 0, low: [0, 0], high: [10_000, 10_000], material: 0 }];
    let mut studio = studio_of(&all);
    // Seen from the side, more and more.
    for turn in [0.0_f64, 0.3, 0.7, 1.1, 1.4, 1.5] {
        let at = DVec3::new(0.0, 5.0, 5.0);
        let eye = at + 20.0 * DVec3::new(-turn.cos(), -turn.sin(), 0.0);
        for (exponent, least, most) in [(0.6, 0.05, 0.85), (0.0, 0.1, 0.9), (1.0, 0.0, 1.0), (3.0, 0.2, 0.7)] {
            let numbers = [("exponent", exponent), ("least", least), ("most", most)];
            let mut scene = of_context(vec![with_numbers("x-ray", &numbers)]);
            scene.camera = Some(orthographic(eye, at, 11.0));
            let found = transparency(&mut studio, &scene, Backend::Specialised, SIZE);
            let middle = found[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize];
            let density = if exponent == 0.0 { 0.0 } else { 1.0 - turn.cos().powf(exponent) };
            let opacity = least + (most - least) * density;
            assert!((f64::from(middle[3]) - (1.0 - opacity)).abs() < 2e-4, "{turn} {exponent}: {middle:?}, {opacity}");
        }
    }
}

/// A layer behind another is fainter than it, by as much as is asked.
#[test]
fn x_ray_does_not_pile_up() {
    let pane = |name, x| Pane { name, x, low: [0, 0], high: [10_000, 10_000], material: 0 };
    let mut studio = studio_of(&[pane(0, 0), pane(1, 1_000), pane(2, 2_000)]);
    let at = DVec3::new(0.0, 5.0, 5.0);
    for behind in [0.0_f64, 0.45, 1.0] {
        let numbers = [("exponent", 0.0), ("least", 0.4), ("behind", behind)];
        let mut scene = of_context(vec![with_numbers("x-ray", &numbers)]);
        scene.camera = Some(orthographic(at - 20.0 * DVec3::X, at, 11.0));
        let through: f64 = (0..3).map(|layer| 1.0 - 0.4 * behind.powi(layer)).product();
        for backend in [Backend::Specialised, Backend::Uber] {
            let found = transparency(&mut studio, &scene, backend, SIZE);
            let middle = f64::from(found[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize][3]);
            assert!((middle - through).abs() < 2e-4, "{behind} {backend:?}: {middle}, {through}");
        }
    }
}

#[test]
fn x_ray_shows_floors_faintly() {
    let [up, down] = ["[[0, 1, 2, 3]]", "[[3, 2, 1, 0]]"];
    // How much a face of 10 m rises on its way, whether it is a floor, and which way it looks.
    let cases = [(0, down, true), (0, up, false), (1200, down, true), (1700, down, false), (1700, up, false)];
    for (rise, face, is_floor) in cases {
        let corners = format!("[0,0,0],[10000,0,{rise}],[10000,10000,{rise}],[0,10000,0]");
        let mut studio = building("floor", face, &corners);
        let at = DVec3::new(5.0, 5.0, f64::from(rise) / 2000.0);
        let normal = DVec3::new(-f64::from(rise), 0.0, 10_000.0) / f64::from(rise).hypot(10_000.0);
        let back = DVec3::new(0.0, -0.8, 0.6);
        for floors in [0.0, 0.25, 1.0] {
            let numbers = [("exponent", 1.0), ("least", 0.1), ("most", 0.9), ("floors", floors)];
            let mut scene = of_context(vec![with_numbers("x-ray", &numbers)]);
            scene.camera = Some(orthographic(at + 20.0 * back, at, 11.0));
            let of_face = 0.1 + 0.8 * (1.0 - normal.dot(back));
            let opacity = if is_floor { floors * of_face } else { of_face };
            for backend in [Backend::Specialised, Backend::Uber] {
                let found = transparency(&mut studio, &scene, backend, SIZE);
                let middle = found[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize];
                let error = f64::from(middle[3]) - (1.0 - opacity);
                assert!(error.abs() < 2e-4, "{rise} {face} {floors} {backend:?}: {middle:?}, {opacity}");
            }
        }
    }
}

/// The colour times opacity, and what is let through, in the middle of a pane that is seen from this far aside, radians.
fn seen_aside(studio: &mut Studio, turn: f64, effects: &[EffectUse], backend: Backend) -> [f64; 4] {
    let at = DVec3::new(0.0, 5.0, 5.0);
    let mut scene = of_context(effects.to_vec());
    scene.camera = Some(orthographic(at + 20.0 * DVec3::new(-turn.cos(), -turn.sin(), 0.0), at, 11.0));
    transparency(studio, &scene, backend, SIZE)[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize].map(f64::from)
}

/// How far `at` is on a way of equal steps: the step, and how much of it.
fn on_ramp(at: f64, count: usize) -> (usize, f64) {
    let place = at * (count - 1) as f64;
    let step = (place as usize).min(count - 2);
    (step, place - step as f64)
}

#[test]
fn opacity_and_colour_go_by_their_ramps() {
    let all = [Pane { name: 0, x: 0, low: [0, 0], high: [10_000, 10_000], material: 0 }];
    let mut studio = studio_of(&all);
    let curve = [0.0, 0.7, 0.1, 1.0];
    let mut x_ray = with_numbers("x-ray", &[("exponent", 1.0), ("least", 0.1), ("most", 0.9)]);
    x_ray.parameters.insert("curve".into(), Parameter::Numbers(curve.into()));
    let tint = |colors: &[&str]| {
        let mut tint = with_numbers("x-ray-tint", &[("exponent", 1.0)]);
        tint.parameters.insert("colors".into(), Parameter::Texts(colors.iter().map(|c| (*c).to_owned()).collect()));
        tint
    };
    let ramp = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
    for backend in [Backend::Specialised, Backend::Uber] {
        for turn in [0.0_f64, 0.4, 0.8, 1.1, 1.3, 1.45] {
            let edge_on = 1.0 - turn.cos();
            let (step, share) = on_ramp(edge_on, curve.len());
            let opacity = 0.1 + 0.8 * (curve[step] + share * (curve[step + 1] - curve[step]));
            let white = seen_aside(&mut studio, turn, &[x_ray.clone(), tint(&["#ffffff", "#ffffff"])], backend);
            assert!((white[3] - (1.0 - opacity)).abs() < 2e-4, "{backend:?} {turn}: {white:?}, {opacity}");
            let found =
                seen_aside(&mut studio, turn, &[x_ray.clone(), tint(&["#ff0000", "#00ff00", "#ffffff"])], backend);
            let (step, share) = on_ramp(edge_on, ramp.len());
            for channel in 0..3 {
                let color = ramp[step][channel] + share * (ramp[step + 1][channel] - ramp[step][channel]);
                let error = found[channel] - color * white[channel];
                assert!(error.abs() < 2e-4, "{backend:?} {turn}: {found:?} by {white:?}, {color}");
            }
        }
    }
}
