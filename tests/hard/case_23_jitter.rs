//! Case 23: the camera turns by parts of a pixel before a static scene: another object is shown only where a silhouette is
//! within that reach, and a lens's mask changes only near its border or with the surface that is shown. Oracle: rays through
//! the city in f64, and the signed distance of the shown places.

use glam::{DVec2, DVec3};
use veduta::{
    city::spatial::SpatialIndex,
    view::{Camera, View},
};

use crate::{
    lenses::{KINDS, band, cameras, shape, view},
    oracle::Numbers,
    studio,
};

const SIZE: [u32; 2] = [160, 120];

/// The camera, turned (or, in parallel views, moved) so that the picture shifts by `px` pixels.
fn shifted(camera: Camera, px: DVec2) -> Camera {
    let still = view(camera, SIZE);
    let far = (camera.target - camera.eye).length();
    let by = still.pixel_m(far) * (px.x * still.basis.right + px.y * still.basis.up);
    let eye = if still.is_orthographic() { camera.eye + by } else { camera.eye };
    Camera { eye, target: camera.target + by, ..camera }
}

/// What rays within `reach` pixels of a pixel's centre meet first: objects (index + 1; 0 none), and how far.
fn around(
    index: &SpatialIndex,
    model: &veduta::city::CityModel,
    view: &View,
    [x, y]: [u32; 2],
    reach: f64,
) -> Vec<(u32, f64)> {
    let steps = 7;
    let mut seen = Vec::new();
    for j in -steps..=steps {
        for i in -steps..=steps {
            let aside = reach / f64::from(steps) * DVec2::new(f64::from(i), f64::from(j));
            let ray = view.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) + aside);
            let hit = index.hit(model, &ray).filter(|hit| hit.t > view.camera.near_m);
            seen.push(hit.map_or((0, f64::INFINITY), |hit| (hit.object + 1, hit.t)));
        }
    }
    seen
}

#[test]
fn sub_pixel_jitter_changes_only_silhouettes_and_borders() {
    let mut studio = studio::synthetic(60);
    let index = SpatialIndex::build(&studio.model, &studio.geometries);
    let mut numbers = Numbers(23);
    let house = studio.model.geometries[studio.geometries[studio.geometries.len() / 2] as usize].bounds.center();
    let lenses: Vec<_> = (0..KINDS)
        .map(|kind| {
            let at = house + DVec3::new(numbers.below(60) as f64 - 30.0, numbers.below(60) as f64 - 30.0, 0.0);
            studio::lens(&format!("lens {kind}"), vec![shape(kind, at, 30.0, &mut numbers)], "sepia")
        })
        .collect();
    let (mut changed, mut bits_changed) = (0, 0);
    let frames = if studio::is_thorough() { 12 } else { 6 };
    for camera in cameras(&studio) {
        let of = |studio: &mut _, camera: Camera| {
            let scene = studio::scene(camera, lenses.clone());
            studio::picture(studio, &scene, SIZE)
        };
        let (still, from) = (of(&mut studio, camera), view(camera, SIZE));
        let ids = still.object_id.as_ref().expect("ids");
        let depth = still.depth.as_ref().expect("depth");
        for frame in 1..=frames {
            // Up to half a pixel in both ways: no two frames alike.
            let step = |by: f64| (f64::from(frame) * by).fract() - 0.5;
            let moved = shifted(camera, DVec2::new(step(0.754_878), step(0.569_840)));
            let (drawn, to) = (of(&mut studio, moved), view(moved, SIZE));
            let ids_now = drawn.object_id.as_ref().expect("ids");
            let depth_now = drawn.depth.as_ref().expect("depth");
            for i in 0..ids.len() {
                let pixel = [i as u32 % SIZE[0], i as u32 / SIZE[0]];
                if ids[i] != ids_now[i] {
                    changed += 1;
                    // Within what the picture moved by here, both are there.
                    let middle = DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
                    let at = to.pixel(from.ray(middle).at(1e4)).expect("before the eye").truncate();
                    let seen = around(&index, &studio.model, &from, pixel, 1.05 * (at - middle).abs().max_element());
                    assert!(
                        [ids[i], ids_now[i]].iter().all(|id| seen.iter().any(|(s, _)| s == id)),
                        "frame {frame}, pixel {pixel:?}: {} became {}, and no silhouette is near",
                        ids[i],
                        ids_now[i]
                    );
                    continue;
                }
                let [was, is] = [(&from, depth[i]), (&to, depth_now[i])]
                    .map(|(view, d)| (view.pixel_ray(pixel[0], pixel[1]).at(f64::from(d)), f64::from(d)));
                for (bit, lens) in lenses.iter().enumerate() {
                    let [before, now] =
                        [&still, &drawn].map(|p| p.lens_mask.as_ref().expect("masks")[0][i] >> bit & 1 == 1);
                    if before == now {
                        continue;
                    }
                    bits_changed += 1;
                    assert!(ids[i] != 0, "frame {frame}, pixel {pixel:?}: a lens holds the sky");
                    // No place is farther from the border than the shown place moved.
                    let volumes = || lens.shapes.iter().flat_map(|s| s.volumes().expect("volumes"));
                    let distance = volumes().map(|v| v.signed_distance(was.0)).fold(f64::INFINITY, f64::min).abs();
                    let slack = volumes().map(|v| band(&v, &to, was.1.max(is.1))).fold(0.0, f64::max);
                    let reach = was.0.distance(is.0) + 2.0 * slack;
                    assert!(
                        distance <= reach,
                        "frame {frame}, pixel {pixel:?}: {distance} m off the border of {lens:?}"
                    );
                }
            }
        }
    }
    let [least, least_bits] = if studio::is_thorough() { [1_000, 250] } else { [500, 120] };
    assert!(changed > least && bits_changed > least_bits, "{changed} pixels, {bits_changed} bits");
}
