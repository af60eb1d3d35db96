//! Two parallel walls a small gap apart, seen from far away: opaque, and as translucent layers.

use glam::DVec3;

use crate::{
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{numbered, of_solids, pane},
        looks::{for_numbers, ids, picture, scene, translucent, transparency, used, with_number},
        numbers::Numbers,
    },
    render::{
        frame::Backend,
        picture::{RenderError, Studio},
    },
    scene::Transparency,
    view::{Camera, default_near_m},
};

/// See the module.
pub const CHECK: Check = Check {
    name: "parallel walls",
    case: "2",
    property: "of two parallel walls a gap g apart, seen from z, the nearer is in front, and its layer is laid over the \
               other's, wherever g ≥ 4 · 2⁻²³ · z",
    oracle: "the integers of their places and the side of the eye; compositing in f64",
    unit: "pixels",
    least: 80_000,
    run,
};

const PIXELS: [u32; 2] = [40, 32];

/// Looks at the middle of the walls from `z_m` metres, `side` −1 before the first and +1 behind the second, turned by `off` from
/// the perpendicular; the walls fill the picture.
fn look(z_m: f64, side: f64, off: [f64; 2]) -> Camera {
    let middle = DVec3::new(0.0, 50.0, 50.0);
    let eye = middle + DVec3::new(side * z_m, off[0] * z_m, off[1] * z_m);
    Camera { near_m: default_near_m(z_m), ..Camera::looking(eye, middle, (4.0 / z_m).max(2e-4)) }
}

/// The distance at which a gap is this many times what can be told.
fn distance_m(gap_mm: i64, times: f64) -> f64 {
    gap_mm as f64 * 1e-3 * f64::from(1 << 23) / (4.0 * times)
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut numbers = Numbers(3);
    for gap_mm in [1, 3, 40] {
        let walls = [0, gap_mm].map(|x| pane(x, [0, 0], [100_000, 100_000]));
        let mut studio = of_solids(DVec3::ZERO, &numbered(walls))?;
        for times in [1.0, 1.25, 3.0, 50.0] {
            for i in 0..8 {
                let side = if i % 2 == 0 { -1.0 } else { 1.0 };
                let off = [numbers.share() - 0.5, 0.2 * numbers.share()];
                let camera = look(distance_m(gap_mm, times), side, off);
                let drawn = picture(&mut studio, &scene(camera, Vec::new()), PIXELS)?;
                let expected = if side < 0.0 { 1 } else { 2 };
                for id in ids(&drawn) {
                    found.ask(*id == expected, || {
                        format!("{gap_mm} mm from {} m: object {id}, not {expected}", distance_m(gap_mm, times))
                    });
                }
                if i < 2 && gap_mm != 3 {
                    ask_layers(found, &mut studio, camera, side < 0.0)?;
                }
            }
            if !found.goes_on() {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// Lays one wall over the other in f64, from their colours alone.
fn ask_layers(
    found: &mut Findings,
    studio: &mut Studio,
    camera: Camera,
    first_is_near: bool,
) -> Result<(), RenderError> {
    let mut alone = [Vec::new(), Vec::new()];
    for (wall, own) in alone.iter_mut().enumerate() {
        let mut only = translucent(camera, 1.0, Transparency::Exact);
        only.style.effects =
            vec![for_numbers(used("eraser"), &[wall], true), with_number("transparent", "opacity", 1.0)];
        *own = transparency(studio, &only, PIXELS, Backend::Specialised)?;
    }
    let both = transparency(studio, &translucent(camera, 0.6, Transparency::Exact), PIXELS, Backend::Specialised)?;
    let [near, far] = if first_is_near { [&alone[0], &alone[1]] } else { [&alone[1], &alone[0]] };
    let a = f64::from(0.6_f32);
    for (i, laid) in both.iter().enumerate() {
        let right = [0, 1, 2].map(|c| a * f64::from(near[i][c]) + (1.0 - a) * a * f64::from(far[i][c]));
        let error = (0..3).map(|c| (f64::from(laid[c]) - right[c]).abs()).fold(0.0, f64::max);
        found.ask(error < 7.0 * 2_f64.powi(-24), || format!("layers from {}, pixel {i}: off by {error:e}", camera.eye));
    }
    Ok(())
}
