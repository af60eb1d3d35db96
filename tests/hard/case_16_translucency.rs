//! Case 16: opacities 0, 1, 1 - 2^-24, equal depths, 10,000 layers, 100 draw orders. Oracle: compositing in f64 of the colours that each
//! layer has alone.

use veduta::render::{
    frame::Backend,
    picture::{Aovs, Request},
};

use crate::panes::*;

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
        let found = transparency(&mut studio, &scene, Backend::Specialised, SIZE);
        let error = largest_difference(&found, &expected);
        // Issue: 2⁻¹⁶ for colours of 16 bits, which these are not; f32 alone takes 3 roundings a layer.
        let allowed = 3.0 * count as f64 * 2_f64.powi(-24) + 2_f64.powi(-24);
        assert!(error <= allowed, "{count}: {error:e} > {allowed:e}");
        assert_eq!(found, transparency(&mut studio, &scene, Backend::Uber, SIZE), "{count}: both back ends");
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
    let first = transparency(&mut studio, &scene, Backend::Specialised, SIZE);
    // In the file, and on the GPU.
    for order in 0..100 {
        studio.renderer.settings.shuffled = Some(order);
        assert_eq!(
            first,
            transparency(&mut studio, &scene, Backend::Specialised, SIZE),
            "the GPU's order {order}: {all:?}"
        );
        for i in (1..all.len()).rev() {
            all.swap(i, random.below(i as u64 + 1) as usize);
        }
        set_city(&mut studio, &all);
        assert_eq!(first, transparency(&mut studio, &scene, Backend::Specialised, SIZE), "{all:?}");
    }
}

#[test]
fn long_lists_are_laid_in_the_order_of_short_ones() {
    // Each two share a plane; the first twenty take nearly all light.
    let all: Vec<Pane> = (0..10_000)
        .map(|i| Pane {
            name: i,
            x: (i / 2) as i64,
            low: [0, 0],
            high: [10_000, 10_000],
            material: i % MATERIALS.len(),
        })
        .collect();
    let first: Vec<usize> = (0..20).collect();
    let opacity = |a: f64, except: bool| rule("transparent", &[("opacity", a)], Some(&first), except);
    let scene = of_context(vec![opacity(0.3, false), opacity(0.0003, true)]);
    let size = [4, 4];
    let mut studio = studio_of(&all[..20]);
    let short = transparency(&mut studio, &scene, Backend::Specialised, size);
    set_city(&mut studio, &all);
    let base = Request { size, aovs: Aovs::default(), statistics: true, ..request(Backend::Specialised) };
    let passes = studio.render(&scene, &base).expect("a picture").statistics.passes;
    assert!(passes.iter().any(|pass| pass.name == "sort layers"), "{passes:?}");
    let long = transparency(&mut studio, &scene, Backend::Specialised, size);
    // 0.7²⁰ of the light is left to what lies behind; two layers in another order would make a hundredth.
    let apart = long.iter().zip(&short).flat_map(|(a, b)| (0..4).map(move |k| (a[k] - b[k]).abs())).fold(0.0, f32::max);
    assert!(apart < 0.7_f32.powi(20), "{apart:e}");
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
    // Frame by frame, the third knows how long the lists of the first were.
    let frames = [(); 3].map(|()| transparency(&mut studio, &scene, Backend::Specialised, size));
    // A picture is drawn anew where lists turn out to be long; the next frame knows.
    let base = Request { size, aovs: Aovs::default(), ..request(Backend::Specialised) };
    studio.render(&scene, &base).expect("a picture");
    let found = transparency(&mut studio, &scene, Backend::Specialised, size);
    assert_eq!(frames[2], found);
    // One of each material is enough to know the colours.
    let own: Vec<[f32; 3]> = (0..MATERIALS.len())
        .map(|i| {
            let alone = [rule("eraser", &[], Some(&[i]), true), rule("transparent", &[("opacity", 1.0)], None, false)];
            let v = transparency(&mut studio, &of_context(alone.to_vec()), Backend::Specialised, size)[5];
            assert_eq!(v[3], 0.0);
            [v[0], v[1], v[2]]
        })
        .collect();
    let stack: Vec<_> = all.iter().map(|pane| (pane.name, own[pane.material])).collect();
    let expected = composited(&stack, |_, _| a);
    let error = largest_difference(&[found[5]], &[expected]);
    assert!(error <= 2_f64.powi(-16) + 1e4 * 2_f64.powi(-23), "{error:e}");
}
