//! The same picture again: on another device, by the other back end, and from views at the rim of what there is.

use glam::DVec3;

use crate::{
    lens::Lens,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{cameras, depths, house, is_same, lens, picture, picture_by, scene},
        numbers::Numbers,
        shapes::{KINDS, shape},
    },
    render::{frame::Backend, picture::RenderError},
    view::{Camera, MAX_FOV, MIN_FOV},
};

/// See the module.
pub const CHECK: Check = Check {
    name: "repeats",
    case: "21",
    property: "a picture has the same bytes again, on another device and by the other back end; straight up and down and with the \
               smallest and largest fields of view, distances and normals are numbers",
    oracle: "byte equality; what a number is",
    unit: "answers",
    least: 14,
    run,
};

const SIZE: [u32; 2] = [160, 120];

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(60, 7)?;
    let mut other = synthetic(60, 7)?;
    let mut numbers = Numbers(21);
    let at = house(&studio).center();
    let effects = ["sepia", "gooch", "blur", "cel", "invert"];
    let lenses: Vec<Lens> = (0..5)
        .map(|kind| {
            let shape = shape(kind % KINDS, at + 15.0 * numbers.in_cube(), 30.0, &mut numbers);
            lens(effects[kind], shape, effects[kind])
        })
        .collect();
    for (i, camera) in cameras(&studio).into_iter().enumerate() {
        let scene = scene(camera, lenses.clone());
        let first = picture(&mut studio, &scene, SIZE)?;
        let again = picture(&mut studio, &scene, SIZE)?;
        let elsewhere = picture(&mut other, &scene, SIZE)?;
        let uber = picture_by(&mut studio, &scene, SIZE, Backend::Uber)?;
        for (what, drawn) in [("again", again), ("on another device", elsewhere), ("by the uber shader", uber)] {
            found.ask(is_same(&first, &drawn) && first.lens_mask == drawn.lens_mask, || {
                let changed = (0..first.rgba.len()).filter(|&i| first.rgba[i] != drawn.rgba[i]).count();
                format!("camera {i}, {what}: {changed} pixels have another colour")
            });
        }
    }
    let up = |direction: DVec3, fov: f64| Camera::looking(at - 40.0 * direction, at, fov);
    for camera in [up(-DVec3::Z, 0.8), up(DVec3::Z, 0.8), up(DVec3::Y, MIN_FOV), up(DVec3::Y, MAX_FOV)] {
        let drawn = picture(&mut studio, &scene(camera, lenses.clone()), SIZE)?;
        let wrong = depths(&drawn).iter().position(|d| d.is_nan() || *d <= 0.0);
        found.ask(wrong.is_none(), || format!("{camera:?}: pixel {wrong:?} has no distance"));
        let mut normals = drawn.normal.iter().flatten().flatten();
        found.ask(normals.all(|n| n.is_finite() && n.abs() <= 1.01), || format!("{camera:?}: a normal that is none"));
    }
    Ok(())
}
