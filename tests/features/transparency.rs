//! The methods of laying translucent layers one over the other, against the exact one and against their formulas.

use crate::panes::*;
use crate::studio::*;
use glam::DVec3;
use veduta::{
    render::{
        frame::Backend,
        picture::{Aovs, Request, Studio},
    },
    scene::{Scene, Transparency},
    view::Camera,
};

/// The same scene by another method.
fn by(method: Transparency, scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.style.transparency = method;
    scene
}

const PEEL: Transparency = Transparency::Peel { layers: 0 };

fn peel(layers: u32) -> Transparency {
    Transparency::Peel { layers }
}

fn k_buffer(layers: u32) -> Transparency {
    Transparency::KBuffer { layers }
}

const BOTH: [Backend; 2] = [Backend::Specialised, Backend::Uber];

/// Opacities that differ from pane to pane.
fn unlike(count: usize) -> Scene {
    let opacity = |i: usize| rule("transparent", &[("opacity", 0.1 + 0.02 * i as f64)], Some(&[i]), false);
    of_context((0..count).map(opacity).collect())
}

#[test]
fn peeling_until_nothing_is_left_is_exact_to_the_bit() {
    let mut random = Random(31);
    let mut all = panes(23, &mut random);
    // Some share a plane, and overlap in it.
    all[6].x = all[5].x;
    all[9].x = all[8].x;
    let mut studio = studio_of(&all);
    // A film counts once in a plane, wherever one round ends and the next begins.
    all[12].x = all[11].x;
    all[13].x = all[11].x;
    set_city(&mut studio, &all);
    for scene in
        [unlike(23), of_context(vec![used("peel")]), of_context(vec![used("x-ray")]), of_context(vec![used("film")])]
    {
        for backend in BOTH {
            let exact = transparency(&mut studio, &scene, backend, SIZE);
            let fragments = studio.renderer.layer_figures().nodes;
            let found = transparency(&mut studio, &by(PEEL, &scene), backend, SIZE);
            assert_eq!(exact, found, "{backend:?}");
            let (figures, layers) = (studio.renderer.method_figures(), studio.renderer.layer_figures());
            assert_eq!((layers.nodes, layers.excess, figures.dropped, figures.merged), (fragments, 0, 0, None));
            assert!(figures.rounds >= 3, "{figures:?}");
            // In bands too.
            studio.renderer.settings.most_layers = Some(u64::from(SIZE[0]) * 4 * 7);
            let found = transparency(&mut studio, &by(PEEL, &scene), backend, SIZE);
            assert_eq!(exact, found, "{backend:?} in bands");
            assert_eq!(studio.renderer.layer_figures().bands, 6);
            studio.renderer.settings.most_layers = None;
        }
    }
}

/// From random places of the town towards others, four and in a thorough run eight, from a street or a little above it.
#[test]
fn peeling_until_nothing_is_left_is_exact_in_a_town() {
    let mut studio = studio(&["builtin:town".into()]);
    let extent = studio.extent();
    let mut random = Random(77);
    let mut place = || extent.min + extent.size() * DVec3::new(random.share(), random.share(), 0.3 * random.share());
    let size = [320, 180];
    for view in 0..if is_thorough() { 8 } else { 4 } {
        let camera = Camera::looking(place() + DVec3::Z * 1.7, place(), 0.8);
        for used in [with_numbers("transparent", &[("opacity", 0.05)]), used("film")] {
            let mut scene = scene(camera, vec![]);
            scene.style.effects = vec![used];
            let exact = transparency(&mut studio, &scene, Backend::Specialised, size);
            let fragments = studio.renderer.layer_figures().nodes;
            let found = transparency(&mut studio, &by(PEEL, &scene), Backend::Specialised, size);
            let off = exact.iter().zip(&found).filter(|(a, b)| a != b).count();
            assert_eq!(off, 0, "pixels of view {view}");
            assert_eq!(studio.renderer.layer_figures().nodes, fragments);
            // What a figure makes of it, too: of four samples, in the order of all passes.
            if view < 2 {
                let asked = Request { size, samples: 4, aovs: Aovs::default(), ..request(Backend::Specialised) };
                let exact = studio.render(&scene, &asked).expect("a picture").rgba;
                assert_eq!(studio.render(&by(PEEL, &scene), &asked).expect("a picture").rgba, exact);
            }
        }
    }
}

#[test]
fn peeling_to_a_number_of_layers_shows_the_nearest_and_counts_the_others() {
    let mut random = Random(32);
    let all = panes(11, &mut random);
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let scene = of_context(vec![rule("transparent", &[("opacity", 0.3)], None, false)]);
    let a = f64::from(0.3_f32);
    for layers in [1, 2, 3, 4, 5, 8, 9] {
        let found = transparency(&mut studio, &by(peel(layers), &scene), Backend::Specialised, SIZE);
        let nearest = |stack: &Vec<(usize, [f32; 3])>| stack[..stack.len().min(layers as usize)].to_vec();
        let expected: Vec<_> = stacks.iter().map(|stack| composited(&nearest(stack), |_, _| a)).collect();
        let error = largest_difference(&found, &expected);
        assert!(error <= 3.0 * f64::from(layers) * 2_f64.powi(-24) + 2_f64.powi(-24), "{layers}: {error:e}");
        let dropped: usize = stacks.iter().map(|s| s.len().saturating_sub(layers as usize)).sum();
        let figures = studio.renderer.method_figures();
        let deepest = stacks.iter().map(Vec::len).max().unwrap_or(0) as u32;
        let rounds = layers.min(deepest).div_ceil(layers.min(4));
        assert_eq!((figures.dropped, figures.rounds), (dropped as u64, rounds), "{layers}");
    }
}

#[test]
fn a_k_buffer_is_exact_where_no_pixel_has_more_layers_than_slots() {
    let mut random = Random(33);
    let mut all = panes(9, &mut random);
    all[4].x = all[3].x;
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    for scene in [unlike(9), of_context(vec![used("peel")]), of_context(vec![used("film")])] {
        for backend in BOTH {
            let exact = transparency(&mut studio, &scene, backend, SIZE);
            for slots in [4, 8, 16] {
                let found = transparency(&mut studio, &by(k_buffer(slots), &scene), backend, SIZE);
                let figures = studio.renderer.method_figures();
                let merged: usize = stacks.iter().map(|s| s.len().saturating_sub(slots as usize)).sum();
                assert_eq!((figures.merged, figures.dropped), (Some(merged as u64), 0), "{slots}");
                let mut same = 0;
                for ((stack, e), f) in stacks.iter().zip(&exact).zip(&found) {
                    if stack.len() <= slots as usize {
                        assert_eq!(e, f, "{slots} {backend:?}");
                        same += usize::from(!stack.is_empty());
                    }
                }
                assert!(same > 100, "{same}");
            }
        }
    }
}

#[test]
fn the_order_in_which_the_city_is_drawn_does_not_matter_to_slots() {
    let mut random = Random(98);
    let mut all = panes(14, &mut random);
    all[6].x = all[5].x;
    let mut studio = studio_of(&all);
    let scenes = [k_buffer(4), k_buffer(16), peel(6)].map(|method| by(method, &unlike(14)));
    let first = scenes.each_ref().map(|scene| transparency(&mut studio, scene, Backend::Specialised, SIZE));
    // In the file, and on the GPU.
    for order in 0..20 {
        studio.renderer.settings.shuffled = Some(order);
        for i in (1..all.len()).rev() {
            all.swap(i, random.below(i as u64 + 1) as usize);
        }
        set_city(&mut studio, &all);
        for (scene, first) in scenes.iter().zip(&first) {
            let found = transparency(&mut studio, scene, Backend::Specialised, SIZE);
            // Which layers the last one of a k-buffer merges is the same too, but their sum is rounded after each of ten.
            let merges = scene.style.transparency == k_buffer(4);
            let allowed = if merges { 3.0 * 10.0 * 2_f64.powi(-24) } else { 0.0 };
            let first: Vec<[f64; 4]> = first.iter().map(|v| v.map(f64::from)).collect();
            let error = largest_difference(&found, &first);
            assert!(error <= allowed, "{:?}: {error:e} {all:?}", scene.style.transparency);
        }
    }
}

#[test]
fn the_shown_surface_follows_methods_that_know_the_order() {
    let mut random = Random(35);
    let all = panes(9, &mut random);
    let mut studio = studio_of(&all);
    for opacity in [0.6, 0.3, 0.12] {
        let scene = of_context(vec![rule("transparent", &[("opacity", opacity)], None, false)]);
        let aovs = Aovs { lens_mask: false, ..ALL };
        let asked = Request { size: SIZE, aovs, ..request(Backend::Specialised) };
        let exact = studio.render(&scene, &asked).expect("a picture");
        for method in [PEEL, k_buffer(16)] {
            let found = studio.render(&by(method, &scene), &asked).expect("a picture");
            assert_eq!(found.rgba, exact.rgba, "{method:?}");
            assert_eq!(
                (found.object_id, found.depth, found.normal),
                (exact.object_id.clone(), exact.depth.clone(), exact.normal.clone())
            );
        }
    }
}

#[test]
fn textures_and_normals_per_vertex_are_in_slots() {
    for file in ["textures.city.json", "textured.obj", "textured.gltf", "materials.gltf"] {
        let mut studio = studio(&[citydata(file)]);
        let mut scene = Scene::default();
        scene.style.effects = vec![used("x-ray")];
        let asked = request(Backend::Specialised);
        let exact = studio.render(&scene, &asked).expect("a picture");
        for method in [PEEL, k_buffer(16)] {
            let found = studio.render(&by(method, &scene), &asked).expect("a picture");
            assert_eq!(found.rgba, exact.rgba, "{file} {method:?}");
        }
    }
}

/// McGuire and Bavoil 2013, equations 6 and 9, in f64; distances in radii of the scene.
fn weighted(layers: &[([f32; 3], f64, f64)]) -> [f64; 4] {
    let (mut sum, mut weights, mut through) = ([0.0; 3], 0.0, 1.0);
    for (color, opacity, distance) in layers {
        let w = opacity * (0.03 / (1e-5 + distance.powi(4))).clamp(1e-2, 3e3);
        for (sum, c) in sum.iter_mut().zip(color) {
            *sum += f64::from(*c) * opacity * w;
        }
        weights += opacity * w;
        through *= 1.0 - opacity;
    }
    let [r, g, b] = sum.map(|sum| if weights > 0.0 { sum / weights * (1.0 - through) } else { 0.0 });
    [r, g, b, through]
}

/// Each pane's colour, opacity and distance in radii of the scene: half the diagonals of its box in plan.
fn weighing(
    studio: &Studio,
    all: &[Pane],
    stack: &[(usize, [f32; 3])],
    opacity: impl Fn(usize) -> f64,
) -> Vec<([f32; 3], f64, f64)> {
    let bounds = studio.extent();
    let radius = 0.5 * (bounds.max - bounds.min).truncate().length();
    let of =
        |(pane, color): &(usize, [f32; 3])| (*color, opacity(*pane), (20.0 + all[*pane].x as f64 / 1000.0) / radius);
    stack.iter().map(of).collect()
}

#[test]
fn weighted_layers_are_as_their_formula_says() {
    let mut random = Random(36);
    let mut all = panes(12, &mut random);
    for (i, pane) in all.iter_mut().enumerate() {
        pane.x = 10_000 * i as i64;
    }
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let opacity = |pane: usize| f64::from((0.1 + 0.02 * pane as f64) as f32);
    let weighed: Vec<_> = stacks.iter().map(|s| weighing(&studio, &all, s, opacity)).collect();
    let is_least = |distance: f64| 0.03 / (1e-5 + distance.powi(4)) <= 1e-2;
    let least = weighed.iter().flatten().filter(|(.., distance)| is_least(*distance)).count();
    let count = weighed.iter().flatten().count();
    assert!((count / 4..count * 3 / 4).contains(&least), "{least} of {count} weigh least");
    let expected: Vec<_> = weighed.iter().map(|layers| weighted(layers)).collect();
    let scene = by(Transparency::Weighted, &unlike(12));
    for backend in BOTH {
        let found = transparency(&mut studio, &scene, backend, SIZE);
        let error = largest_difference(&found, &expected);
        assert!(error < 2e-5, "{backend:?}: {error:e}");
    }
    let exact = transparency(&mut studio, &unlike(12), Backend::Specialised, SIZE);
    assert!(largest_difference(&exact, &expected) > 0.02, "it is another picture than the exact one");
}

#[test]
fn what_finds_no_slot_is_one_layer_behind_the_others() {
    let mut random = Random(37);
    let mut all = panes(15, &mut random);
    all[4].x = all[3].x;
    let mut studio = studio_of(&all);
    let stacks = stacks(&mut studio, &all);
    let opacity = |pane: usize| f64::from((0.1 + 0.02 * pane as f64) as f32);
    let deepest = stacks.iter().map(Vec::len).max().unwrap_or(0);
    assert!(deepest > 8, "{deepest}");
    for slots in [4, 8] {
        let laid = |stack: &Vec<(usize, [f32; 3])>| {
            let (near, far) = stack.split_at(stack.len().min(slots as usize));
            let front = composited(near, |_, pane| opacity(pane));
            let rest = weighted(&weighing(&studio, &all, far, opacity));
            let over = |i: usize| front[i] + front[3] * rest[i];
            [over(0), over(1), over(2), front[3] * rest[3]]
        };
        let expected: Vec<_> = stacks.iter().map(laid).collect();
        let scene = by(k_buffer(slots), &unlike(15));
        for backend in BOTH {
            let found = transparency(&mut studio, &scene, backend, SIZE);
            let error = largest_difference(&found, &expected);
            assert!(error < 1e-5, "{slots} {backend:?}: {error:e}");
        }
        // In bands too.
        let whole = transparency(&mut studio, &scene, Backend::Specialised, SIZE);
        studio.renderer.settings.most_layers = Some(u64::from(SIZE[0] * slots) * 9);
        assert_eq!(whole, transparency(&mut studio, &scene, Backend::Specialised, SIZE));
        assert_eq!(studio.renderer.layer_figures().bands, 5);
        studio.renderer.settings.most_layers = None;
    }
}

#[test]
fn chance_is_right_in_the_mean() {
    let mut random = Random(38);
    let all = panes(7, &mut random);
    let mut studio = studio_of(&all);
    let scene = of_context(vec![rule("transparent", &[("opacity", 0.35)], None, false)]);
    let base = Request { size: SIZE, aovs: Aovs::default(), ..request(Backend::Specialised) };
    const SAMPLES: u32 = 64;
    for backend in BOTH {
        let mut mean = |method, samples: u32| {
            let drawn = studio.render(&by(method, &scene), &Request { samples, backend, ..base }).expect("a picture");
            drawn.rgba
        };
        let exact = mean(Transparency::Exact, SAMPLES);
        let found = mean(Transparency::Stochastic, SAMPLES);
        let linear = |byte: u8| {
            let s = f64::from(byte) / 255.0;
            if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
        };
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (e, f) in exact.iter().zip(&found) {
            for i in 0..3 {
                let d = linear(f[i]) - linear(e[i]);
                (sum, squares, count) = (sum + d, squares + d * d, count + 1.0);
            }
        }
        // A sample is one of the layers' colours, 0..1: the standard deviation of the mean of 64 is at most 1/16.
        let deviation = f64::sqrt(squares / count);
        assert!(deviation > 1e-3 && deviation < 0.5 / f64::from(SAMPLES).sqrt(), "{backend:?}: {deviation}");
        // Pixels are independent, and their three channels are as good as one; rounding to bytes is even.
        let error = sum / count;
        let standard_error = deviation / f64::sqrt(count / 3.0);
        assert!(error.abs() < 4.0 * standard_error + 1e-4, "{backend:?}: {error} of {standard_error}");
    }
}

#[test]
fn methods_and_lenses_with_contents_borders_and_shadows_draw_what_is_opaque_alike() {
    let mut studio = synthetic(60);
    let center = studio.extent().center();
    let camera = Camera {
        eye: center + DVec3::new(-70.0, -110.0, 60.0),
        target: center,
        ..studio.camera(&Scene::default(), SIZE)
    };
    let shape = veduta::geom::Shape::Sphere { center, radius: 30.0 };
    let clear = |opacity| veduta::lens::Lens {
        effects: vec![with_numbers("transparent", &[("opacity", opacity)]), used("sepia")],
        ..lens("l", vec![shape.clone()], "eraser")
    };
    for backend in BOTH {
        let mut drawn = |method, opacity| {
            let mut scene = scene(camera, vec![clear(opacity)]);
            scene.sun.shadows = true;
            studio.render(&by(method, &scene), &request(backend)).expect("a picture")
        };
        for opacity in [0.0, 1.0] {
            let exact = drawn(Transparency::Exact, opacity);
            for method in [PEEL, k_buffer(4), Transparency::Weighted, Transparency::Stochastic] {
                let found = drawn(method, opacity);
                // Weighted layers that are opaque are seen through each other.
                if opacity == 0.0 || method != Transparency::Weighted {
                    assert_eq!(found.rgba, exact.rgba, "{method:?} {opacity} {backend:?}");
                    assert_eq!(found.object_id, exact.object_id, "{method:?} {opacity} {backend:?}");
                }
            }
        }
    }
}
