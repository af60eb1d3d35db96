//! The camera turns by parts of a pixel before a static scene.

use glam::DVec2;

use crate::{
    city::{CityModel, spatial::SpatialIndex},
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{cameras, ids, middle, picture, scene, view},
    },
    render::picture::RenderError,
    view::{Camera, View},
};

/// See the module.
pub const CHECK: Check = Check {
    name: "jitter",
    case: "23",
    property: "where the camera turns by parts of a pixel, another object is shown only where a silhouette is within that reach",
    oracle: "rays through the city in f64",
    unit: "pixels",
    least: 100_000,
    run,
};

const SIZE: [u32; 2] = [160, 120];
const FRAMES: u32 = 5;

/// The camera, turned (or, in parallel views, moved) so that the picture shifts by `px` pixels.
fn shifted(camera: Camera, px: DVec2) -> Result<Camera, RenderError> {
    let still = view(camera, SIZE)?;
    let far = (camera.target - camera.eye).length();
    let by = still.pixel_m(far) * (px.x * still.basis.right + px.y * still.basis.up);
    let eye = if still.is_orthographic() { camera.eye + by } else { camera.eye };
    Ok(Camera { eye, target: camera.target + by, ..camera })
}

/// Whether rays within `reach` pixels of a pixel's centre meet each of these objects (index + 1; 0 none) first.
fn are_near(index: &SpatialIndex, model: &CityModel, view: &View, at: DVec2, reach: f64, objects: [u32; 2]) -> bool {
    let steps = 7;
    let mut missing = objects.to_vec();
    for (i, j) in (-steps..=steps).flat_map(|j| (-steps..=steps).map(move |i| (i, j))) {
        let aside = reach / f64::from(steps) * DVec2::new(f64::from(i), f64::from(j));
        let hit = index.hit(model, &view.ray(at + aside)).filter(|hit| hit.t > view.camera.near_m);
        let seen = hit.map_or(0, |hit| hit.object + 1);
        missing.retain(|object| *object != seen);
        if missing.is_empty() {
            return true;
        }
    }
    false
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(60, 7)?;
    let index = SpatialIndex::build(&studio.model, &studio.geometries);
    for camera in cameras(&studio) {
        let still = picture(&mut studio, &scene(camera, Vec::new()), SIZE)?;
        let from = view(camera, SIZE)?;
        for frame in 1..=FRAMES {
            // Up to half a pixel in both ways: no two frames alike.
            let step = |by: f64| (f64::from(frame) * by).fract() - 0.5;
            let moved = shifted(camera, DVec2::new(step(0.754_878), step(0.569_840)))?;
            let drawn = picture(&mut studio, &scene(moved, Vec::new()), SIZE)?;
            let to = view(moved, SIZE)?;
            for (i, (was, is)) in ids(&still).iter().zip(ids(&drawn)).enumerate() {
                let at = middle(SIZE, i);
                // Within what the picture moved by here, both are there.
                let is_right = was == is
                    || to.pixel(from.ray(at).at(1e4)).is_some_and(|now| {
                        let reach = 1.05 * (now.truncate() - at).abs().max_element();
                        are_near(&index, &studio.model, &from, at, reach, [*was, *is])
                    });
                found.ask(is_right, || {
                    format!("frame {frame}, pixel {at}: object {was} became {is}, no silhouette near")
                });
            }
        }
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}
