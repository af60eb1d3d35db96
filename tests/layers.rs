//! Translucent layers: exact against compositing in f64, whatever the order; what has no room is counted; AOVs, lenses, both back ends.

mod studio;

use std::{path::PathBuf, sync::Arc};

use glam::DVec3;
use studio::*;
use veduta::{
    city::{
        coplanar::coplanar_triangles,
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
    },
    geom::Shape,
    lens::{Border, BorderUnit, Class, Discrete, EffectUse, Lens, Parameter},
    render::{
        city::Shown,
        frame::Backend,
        layers::LayerFigures,
        picture::{Aovs, Request, Studio},
    },
    scene::Scene,
    view::Camera,
};

const SIZE: [u32; 2] = [48, 40];

/// A pane across the x axis: its place, its lower and upper corner in y and z, millimetres, and its material.
#[derive(Clone, Copy, Debug)]
struct Pane {
    name: usize,
    x: i64,
    low: [i64; 2],
    high: [i64; 2],
    material: usize,
}

/// Numbers that look random: xorshift.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    fn share(&mut self) -> f64 {
        self.below(1 << 20) as f64 / f64::from(1 << 20)
    }
}

const MATERIALS: [&str; 4] = ["[0.9,0.85,0.7]", "[0.7,0.25,0.15]", "[0.1,0.3,0.8]", "[0.2,0.7,0.2]"];

fn panes(count: usize, random: &mut Random) -> Vec<Pane> {
    let mut side = |low: u64| -> [i64; 2] { [0, 1].map(|_| (low + random.below(4000)) as i64) };
    let bounds: Vec<_> = (0..count).map(|_| (side(0), side(6000))).collect();
    let pane = |(i, (low, high)): (usize, ([i64; 2], [i64; 2]))| Pane {
        name: i,
        x: 100 * i as i64,
        low,
        high,
        material: i % MATERIALS.len(),
    };
    bounds.into_iter().enumerate().map(pane).collect()
}

/// The city of these panes, in this order.
fn city(panes: &[Pane]) -> PathBuf {
    use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
    static MADE: AtomicU32 = AtomicU32::new(0);
    let (mut objects, mut vertices) = (Vec::new(), Vec::new());
    for (i, pane) in panes.iter().enumerate() {
        let ([y, z], [y2, z2]) = (pane.low, pane.high);
        let v = 4 * i;
        objects.push(format!(
            r#""p{}": {{"type": "Building", "attributes": {{"n": {}}}, "geometry": [{{"type": "MultiSurface", "lod": "2",
                "boundaries": [[[{}, {}, {}, {}]]], "material": {{"a": {{"value": {}}}}}}}]}}"#,
            pane.name, pane.name, v, v + 1, v + 2, v + 3, pane.material
        ));
        let x = pane.x;
        vertices.push(format!("[{x},{y},{z}],[{x},{y2},{z}],[{x},{y2},{z2}],[{x},{y},{z2}]"));
    }
    let materials = MATERIALS.iter().enumerate().map(|(i, c)| format!(r#"{{"name": "m{i}", "diffuseColor": {c}}}"#));
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}},
            "CityObjects": {{{}}},
            "appearance": {{"default-theme-material": "a", "materials": [{}]}}, "vertices": [{}]}}"#,
        objects.join(",\n"),
        materials.collect::<Vec<_>>().join(","),
        vertices.join(",")
    );
    let number = MADE.fetch_add(1, Relaxed);
    let path = std::env::temp_dir().join(format!("veduta-panes-{}-{number}.city.json", std::process::id()));
    std::fs::write(&path, text).expect("a temporary file");
    path
}

fn studio_of(panes: &[Pane]) -> Studio {
    let path = city(panes);
    let made = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

/// Puts another city into a studio.
fn set_city(studio: &mut Studio, panes: &[Pane]) {
    let path = city(panes);
    let model = load(std::slice::from_ref(&path), &LoadOptions::default(), &Quiet).expect("the file loads");
    std::fs::remove_file(path).expect("the temporary file");
    let geometries = shown_geometries(&model, None);
    let coplanar = coplanar_triangles(&model, &geometries);
    let shown = Shown { model: &model, geometries: &geometries, coplanar: &coplanar, ground: None };
    studio.renderer.set_city(&shown).expect("the city fits");
    (studio.model, studio.geometries) = (Arc::new(model), geometries);
}

/// From before the first pane, without air between.
fn camera() -> Camera {
    orthographic(DVec3::new(-20.0, 5.0, 5.0), DVec3::new(0.0, 5.0, 5.0), 11.0)
}

fn rule(effect: &str, numbers: &[(&str, f64)], chosen: Option<&[usize]>, except: bool) -> EffectUse {
    let mut made = with_numbers(effect, numbers);
    if let Some(chosen) = chosen {
        let values = chosen.iter().map(ToString::to_string).collect();
        made.parameters.insert("attribute".into(), Parameter::Text("n".into()));
        made.parameters.insert("values".into(), Parameter::Texts(values));
        made.parameters.insert("except".into(), Parameter::Boolean(except));
    }
    made
}

fn of_context(effects: Vec<EffectUse>) -> Scene {
    let mut scene = scene(camera(), vec![]);
    scene.style.effects = effects;
    scene
}

/// What the last frame laid over its picture.
fn veil(studio: &mut Studio, scene: &Scene, backend: Backend, size: [u32; 2]) -> Vec<[f32; 4]> {
    studio.backend = backend;
    studio.redraw(scene, size).expect("a frame");
    let targets = studio.renderer.targets().expect("targets");
    let bytes = studio.renderer.gpu.read_texture(&targets.veil.texture, 0, wgpu::TextureAspect::All).expect("texels");
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Colours of a pane where it is, as shaded.
fn colors(studio: &mut Studio, pane: usize) -> Vec<Option<[f32; 3]>> {
    let alone = [rule("eraser", &[], Some(&[pane]), true), rule("transparent", &[("opacity", 1.0)], None, false)];
    let seen = veil(studio, &of_context(alone.to_vec()), Backend::Specialised, SIZE);
    seen.iter().map(|v| (v[3] == 0.0).then(|| [v[0], v[1], v[2]])).collect()
}

/// Layers of each pixel, from near to far: of which pane, and its colour.
fn stacks(studio: &mut Studio, panes: &[Pane]) -> Vec<Vec<(usize, [f32; 3])>> {
    let mut stacks = vec![Vec::new(); (SIZE[0] * SIZE[1]) as usize];
    let mut sorted: Vec<&Pane> = panes.iter().collect();
    sorted.sort_by_key(|pane| pane.x);
    for pane in sorted {
        for (stack, color) in stacks.iter_mut().zip(colors(studio, pane.name)) {
            stack.extend(color.map(|color| (pane.name, color)));
        }
    }
    stacks
}

/// Laid one over the other in f64.
fn composited(stack: &[(usize, [f32; 3])], opacity: impl Fn(usize, usize) -> f64) -> [f64; 4] {
    let (mut color, mut through) = ([0.0; 3], 1.0);
    for (layer, (pane, own)) in stack.iter().enumerate() {
        let a = opacity(layer, *pane);
        for (sum, c) in color.iter_mut().zip(own) {
            *sum += through * a * f64::from(*c);
        }
        through *= 1.0 - a;
    }
    [color[0], color[1], color[2], through]
}

fn largest_difference(found: &[[f32; 4]], expected: &[[f64; 4]]) -> f64 {
    let of = |(f, e): (&[f32; 4], &[f64; 4])| (0..4).map(|i| (f64::from(f[i]) - e[i]).abs()).fold(0.0, f64::max);
    found.iter().zip(expected).map(of).fold(0.0, f64::max)
}

#[test]
fn layers_are_laid_over_each_other_as_in_f64() {
    let mut random = Random(7);
    let all = panes(27, &mut random);
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let most = stacks.iter().map(Vec::len).max().unwrap_or(0);
    assert!(most > 20 && stacks.iter().any(Vec::is_empty), "{most} layers");
    // From one pane in the city to all of them; with nothing at all, all but nothing, all, and all but the least bit.
    for count in [1, 2, 7, 8, 9, 16, 27] {
        let special = [0.0, 1.0, 1.0 - 2_f64.powi(-24), 2_f64.powi(-24)];
        let opacities: Vec<f64> = (0..all.len())
            .map(|i| {
                let is_special = random.below(9) == 0;
                if is_special { special[i % 4] } else { random.share() * 0.4 }
            })
            .map(|a: f64| f64::from(a as f32))
            .collect();
        let gone: Vec<usize> = (count..all.len()).collect();
        let mut effects = vec![];
        if !gone.is_empty() {
            effects.push(rule("eraser", &[], Some(&gone), false));
        }
        let opacity = |(i, a): (usize, &f64)| rule("transparent", &[("opacity", *a)], Some(&[i]), false);
        effects.extend(opacities.iter().enumerate().map(opacity));
        let expected: Vec<_> = stacks
            .iter()
            .map(|stack| stack.iter().filter(|(pane, _)| *pane < count).copied().collect::<Vec<_>>())
            .map(|stack| composited(&stack, |_, pane| opacities[pane]))
            .collect();
        let scene = of_context(effects);
        let found = veil(&mut studio, &scene, Backend::Specialised, SIZE);
        let error = largest_difference(&found, &expected);
        // Issue: 2⁻¹⁶ for colours of 16 bits, which these are not; f32 alone takes 3 roundings a layer.
        let allowed = 3.0 * count as f64 * 2_f64.powi(-24) + 2_f64.powi(-24);
        assert!(error <= allowed, "{count}: {error:e} > {allowed:e}");
        assert_eq!(found, veil(&mut studio, &scene, Backend::Uber, SIZE), "{count}: both back ends");
    }
}

#[test]
fn the_order_in_which_the_city_is_drawn_does_not_matter() {
    let mut random = Random(99);
    let mut all = panes(14, &mut random);
    // Two of them share a plane, and overlap in it.
    all[6].x = all[5].x;
    let mut studio = studio_of(&all);
    let opacity = |i: usize| rule("transparent", &[("opacity", 0.1 + 0.05 * i as f64)], Some(&[i]), false);
    let scene = of_context((0..all.len()).map(opacity).collect());
    let first = veil(&mut studio, &scene, Backend::Specialised, SIZE);
    for _ in 0..100 {
        for i in (1..all.len()).rev() {
            all.swap(i, random.below(i as u64 + 1) as usize);
        }
        set_city(&mut studio, &all);
        assert_eq!(first, veil(&mut studio, &scene, Backend::Specialised, SIZE), "{all:?}");
    }
}

#[test]
fn what_has_no_room_is_drawn_in_bands_or_counted() {
    let mut random = Random(3);
    let all = panes(9, &mut random);
    let mut studio = studio_of(&all);
    let scene = of_context(vec![rule("transparent", &[("opacity", 0.3)], None, false)]);
    let whole = veil(&mut studio, &scene, Backend::Specialised, SIZE);
    let figures = studio.renderer.layer_figures();
    let stacks = stacks(&mut studio, &all);
    let notes: u64 = stacks.iter().map(|s| s.len() as u64).sum();
    assert_eq!(figures, LayerFigures { notes, bands: 1, excess: 0 });
    let mut at = |capacity: u64| {
        studio.renderer.most_layers = Some(capacity);
        (veil(&mut studio, &scene, Backend::Specialised, SIZE), studio.renderer.layer_figures())
    };
    assert_eq!(at(notes), (whole.clone(), LayerFigures { notes, bands: 1, excess: 0 }));
    assert_eq!(at(notes - 1), (whole.clone(), LayerFigures { notes, bands: 2, excess: 0 }));
    let (found, figures) = at(9);
    assert_eq!((&found, figures.notes, figures.excess), (&whole, notes, 0), "as many as a pixel has");
    assert!(figures.bands > 100);
    // One note for each pixel: the others are missing, and counted.
    let (found, figures) = at(1);
    let excess: u64 = stacks.iter().map(|s| (s.len() as u64).saturating_sub(1)).sum();
    assert_eq!((figures.notes, figures.excess), (notes, excess));
    for (found, stack) in found.iter().zip(&stacks) {
        let laid = if stack.is_empty() { 1.0 } else { 0.7 };
        assert!((found[3] - laid).abs() < 1e-6, "{found:?}");
    }
    let (found, figures) = at(0);
    assert_eq!(figures, LayerFigures { notes, bands: 1, excess: notes });
    assert!(found.iter().all(|v| *v == [0.0, 0.0, 0.0, 1.0]));
    let told = Request { size: SIZE, statistics: true, aovs: Aovs::default(), ..request(Backend::Specialised) };
    let picture = studio.render(&scene, &told).expect("a picture");
    let layers = picture.statistics.frame.layers.expect("there are some");
    assert_eq!((layers.fragments, layers.missing), (notes, notes));
    let warning = &picture.statistics.warnings[0];
    assert_eq!((&warning["code"], &warning["count"]), (&"layer-room".into(), &notes.into()));
}

#[test]
fn ten_thousand_layers_are_laid_over_each_other() {
    let all: Vec<Pane> = (0..10_000)
        .map(|i| Pane { name: i, x: 2 * i as i64, low: [0, 0], high: [10_000, 10_000], material: i % MATERIALS.len() })
        .collect();
    let mut studio = studio_of(&all);
    let size = [4, 4];
    let a = f64::from(0.0003_f32);
    let scene = of_context(vec![rule("transparent", &[("opacity", a)], None, false)]);
    // A picture is drawn anew where lists turn out to be long; the next frame knows.
    let base = Request { size, aovs: Aovs::default(), ..request(Backend::Specialised) };
    studio.render(&scene, &base).expect("a picture");
    let found = veil(&mut studio, &scene, Backend::Specialised, size);
    // One of each material is enough to know the colours.
    let own: Vec<[f32; 3]> = (0..MATERIALS.len())
        .map(|i| {
            let alone = [rule("eraser", &[], Some(&[i]), true), rule("transparent", &[("opacity", 1.0)], None, false)];
            let v = veil(&mut studio, &of_context(alone.to_vec()), Backend::Specialised, size)[5];
            assert_eq!(v[3], 0.0);
            [v[0], v[1], v[2]]
        })
        .collect();
    let stack: Vec<_> = all.iter().map(|pane| (pane.name, own[pane.material])).collect();
    let expected = composited(&stack, |_, _| a);
    let error = largest_difference(&[found[5]], &[expected]);
    assert!(error <= 2_f64.powi(-16) + 1e4 * 2_f64.powi(-23), "{error:e}");
}

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
        let found = veil(&mut studio, &scene, Backend::Specialised, SIZE);
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
        assert_eq!(found, veil(&mut studio, &scene, Backend::Uber, SIZE), "{of}");
        // In bands, the picture's number of layers is that of all of them.
        studio.renderer.most_layers = Some(200);
        assert_eq!(found, veil(&mut studio, &scene, Backend::Specialised, SIZE), "{of}, in bands");
        assert!(studio.renderer.layer_figures().bands > 2);
        studio.renderer.most_layers = None;
    }
}

fn request(backend: Backend) -> Request {
    Request { size: [160, 100], samples: 1, transparent: false, aovs: ALL, statistics: false, backend }
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
        let found = veil(&mut studio, &scene, backend, SIZE);
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
            let found = veil(&mut studio, &scene, Backend::Specialised, SIZE);
            let middle = found[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize];
            let density = if exponent == 0.0 { 0.0 } else { 1.0 - turn.cos().powf(exponent) };
            let opacity = least + (most - least) * density;
            assert!((f64::from(middle[3]) - (1.0 - opacity)).abs() < 2e-4, "{turn} {exponent}: {middle:?}, {opacity}");
        }
    }
}
