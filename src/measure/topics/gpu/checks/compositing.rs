//! Translucent layers laid over each other: against f64, in any order of drawing, and ten thousand of them.

use crate::{
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{COLORS, Solid, pane},
        looks::{for_numbers, transparency, used, with_number},
        numbers::Numbers,
        panes::{SIZE, composited, difference, of_context, panes, stacks, studio_of},
    },
    render::{
        frame::Backend,
        picture::{RenderError, Request, Studio},
    },
};

/// See the module.
pub const CHECK: Check = Check {
    name: "translucency",
    case: "16",
    property: "n layers err by at most (3 n + 1) · 2⁻²⁴, 10,000 by 2⁻¹⁶ + n · 2⁻²³; opacities of 0, 1, 1 − 2⁻²⁴ and 2⁻²⁴; \
               the order of drawing changes no byte, nor does the back end",
    oracle: "compositing in f64 of the colours that each layer has alone",
    unit: "pixels",
    least: 10_000,
    run,
};

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut numbers = Numbers(7);
    let mut all = panes(27, &mut numbers);
    // Two share a plane, and overlap in it.
    let x = all[5].faces[0][0][0];
    all[6].faces[0].iter_mut().for_each(|corner| corner[0] = x);
    let mut studio = studio_of(&all)?;
    ask_counts(found, &mut studio, &all, &mut numbers)?;
    if !found.goes_on() {
        return Ok(());
    }
    ask_orders(found, &mut studio, all.len())?;
    if found.goes_on() { ask_ten_thousand(found) } else { Ok(()) }
}

/// From one pane in the city to all of them, some of which let through nothing, everything, and all but the least bit.
fn ask_counts(
    found: &mut Findings,
    studio: &mut Studio,
    all: &[Solid],
    numbers: &mut Numbers,
) -> Result<(), RenderError> {
    let stacks = stacks(studio, all)?;
    for count in [1, 8, 9, 27] {
        let special = [0.0, 1.0, 1.0 - 2_f64.powi(-24), 2_f64.powi(-24)];
        let one = |i: usize| if numbers.below(9) == 0 { special[i % 4] } else { numbers.share() * 0.4 };
        let opacities: Vec<f64> = (0..all.len()).map(one).map(|a: f64| f64::from(a as f32)).collect();
        let gone: Vec<usize> = (count..all.len()).collect();
        let mut effects = Vec::new();
        effects.extend((!gone.is_empty()).then(|| for_numbers(used("eraser"), &gone, false)));
        let opacity = |(i, a): (usize, &f64)| for_numbers(with_number("transparent", "opacity", *a), &[i], false);
        effects.extend(opacities.iter().enumerate().map(opacity));
        let scene = of_context(effects);
        let laid = transparency(studio, &scene, SIZE, Backend::Specialised)?;
        let other = transparency(studio, &scene, SIZE, Backend::Uber)?;
        let allowed = (3.0 * count as f64 + 1.0) * 2_f64.powi(-24);
        for (i, stack) in stacks.iter().enumerate() {
            let stack: Vec<_> = stack.iter().filter(|(pane, _)| *pane < count).copied().collect();
            let error = difference(laid[i], composited(&stack, |pane| opacities[pane]));
            found.ask(error <= allowed && laid[i] == other[i], || {
                format!("{count} panes, pixel {i}: off by {error:e}; {:?} and {:?}", laid[i], other[i])
            });
        }
    }
    Ok(())
}

/// Triangles drawn in other orders.
fn ask_orders(found: &mut Findings, studio: &mut Studio, count: usize) -> Result<(), RenderError> {
    let opacity = |i: usize| for_numbers(with_number("transparent", "opacity", 0.1 + 0.02 * i as f64), &[i], false);
    let scene = of_context((0..count).map(opacity).collect());
    let first = transparency(studio, &scene, SIZE, Backend::Specialised)?;
    for order in 0..20 {
        studio.renderer.settings.shuffled = Some(order);
        let again = transparency(studio, &scene, SIZE, Backend::Specialised)?;
        for (i, (a, b)) in first.iter().zip(&again).enumerate() {
            found.ask(a == b, || format!("order {order}, pixel {i}: {b:?}, not {a:?}"));
        }
    }
    studio.renderer.settings.shuffled = None;
    Ok(())
}

fn ask_ten_thousand(found: &mut Findings) -> Result<(), RenderError> {
    let one = |i: usize| {
        let faces = pane(2 * i as i64, [0, 0], [10_000, 10_000]);
        Solid { number: i, faces, material: i % COLORS.len() }
    };
    let all: Vec<Solid> = (0..10_000).map(one).collect();
    let mut studio = studio_of(&all)?;
    let size = [4, 4];
    let a = f64::from(0.0003_f32);
    let scene = of_context(vec![with_number("transparent", "opacity", a)]);
    // A picture is drawn anew where lists turn out to be long; the next frame knows.
    studio.render(&scene, &Request::plain(size))?;
    let laid = transparency(&mut studio, &scene, size, Backend::Specialised)?;
    // One of each material is enough to know the colours.
    let mut own = [[0.0; 3]; COLORS.len()];
    for (i, color) in own.iter_mut().enumerate() {
        let only = for_numbers(used("eraser"), &[i], true);
        let alone = of_context(vec![only, with_number("transparent", "opacity", 1.0)]);
        let v = transparency(&mut studio, &alone, size, Backend::Specialised)?[5];
        *color = [v[0], v[1], v[2]];
    }
    let stack: Vec<_> = all.iter().map(|pane| (pane.number, own[pane.material])).collect();
    // The middle of the picture: all panes are there.
    let error = difference(laid[5], composited(&stack, |_| a));
    let allowed = 2_f64.powi(-16) + 1e4 * 2_f64.powi(-23);
    found.ask(error <= allowed, || format!("10,000 layers: off by {error:e}"));
    Ok(())
}
