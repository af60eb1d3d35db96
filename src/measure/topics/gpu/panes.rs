//! Panes across a sight line: the layers of each pixel, and compositing in f64.

use glam::DVec3;

use crate::{
    lens::EffectUse,
    measure::topics::gpu::{
        cities::{Solid, numbered, of_solids, pane},
        looks::{for_numbers, orthographic, scene, transparency, used, with_number},
        numbers::Numbers,
    },
    render::{
        frame::Backend,
        picture::{RenderError, Studio},
    },
    scene::Scene,
};

/// Width and height of the pictures, pixels.
pub const SIZE: [u32; 2] = [48, 40];

/// A layer of a pixel: the number of its pane, and its colour, linear light.
pub type Layer = (usize, [f32; 3]);

/// Panes a tenth of a metre apart, at random sides.
pub fn panes(count: usize, numbers: &mut Numbers) -> Vec<Solid> {
    let mut corner = |low: i64| [0, 1].map(|_| low + numbers.below(4_000));
    let sides: Vec<_> = (0..count).map(|_| (corner(0), corner(6_000))).collect();
    numbered(sides.into_iter().enumerate().map(|(i, (low, high))| pane(100 * i as i64, low, high)))
}

/// A studio over them.
///
/// # Errors
/// The adapter refuses it.
pub fn studio_of(panes: &[Solid]) -> Result<Studio, RenderError> {
    of_solids(DVec3::ZERO, panes)
}

/// A scene that is drawn with these effects, from before the first pane.
pub fn of_context(effects: Vec<EffectUse>) -> Scene {
    let eye = DVec3::new(-20.0, 5.0, 5.0);
    let mut made = scene(orthographic(eye, eye.with_x(0.0), 11.0), Vec::new());
    made.style.effects = effects;
    made
}

/// Layers of each pixel, from near to far.
///
/// # Errors
/// Drawing fails.
pub fn stacks(studio: &mut Studio, panes: &[Solid]) -> Result<Vec<Vec<Layer>>, RenderError> {
    let mut stacks = vec![Vec::new(); (SIZE[0] * SIZE[1]) as usize];
    for pane in panes {
        let only = for_numbers(used("eraser"), &[pane.number], true);
        let scene = of_context(vec![only, with_number("transparent", "opacity", 1.0)]);
        let seen = transparency(studio, &scene, SIZE, Backend::Specialised)?;
        for (stack, v) in stacks.iter_mut().zip(seen) {
            stack.extend((v[3] == 0.0).then_some((pane.number, [v[0], v[1], v[2]])));
        }
    }
    Ok(stacks)
}

/// Laid one over the other in f64: colours, and what is let through.
pub fn composited(stack: &[Layer], opacity: impl Fn(usize) -> f64) -> [f64; 4] {
    let (mut color, mut through) = ([0.0; 3], 1.0);
    for (pane, own) in stack {
        let a = opacity(*pane);
        for (sum, c) in color.iter_mut().zip(own) {
            *sum += through * a * f64::from(*c);
        }
        through *= 1.0 - a;
    }
    [color[0], color[1], color[2], through]
}

/// The largest difference of a channel.
pub fn difference(found: [f32; 4], right: [f64; 4]) -> f64 {
    (0..4).map(|i| (f64::from(found[i]) - right[i]).abs()).fold(0.0, f64::max)
}
