//! Light, in absolute numbers: what closed forms say of faces, shadows, haze and sky. Pictures that are only compared with each other would
//! not notice where all of them are wrong.

use crate::studio::*;
use glam::DVec3;
use veduta::{
    render::picture::{Picture, Request, Studio},
    scene::{BaseStyle, Scene, Style, Sun},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [240, 160];
/// Linear light at noon: of the sun, of the sky, and what the ground throws back; and the colour of clay.
pub const SUN: [f64; 3] = [0.86, 0.86 * 0.95, 0.86 * 0.86];
pub const SKY: [f64; 3] = [0.335, 0.375, 0.43];
pub const GROUND: [f64; 3] = [0.20, 0.185, 0.165];
pub const CLAY: [f64; 3] = [0.62, 0.585, 0.54];
/// sRGB of the sky at the horizon and above.
const HORIZON: [f64; 3] = [0.90, 0.925, 0.94];
const ZENITH: [f64; 3] = [0.57, 0.70, 0.84];

/// A plate of 160 m, its top at 0, and a tower of 20 × 20 × 30 m on its middle.
fn plate() -> Studio {
    boxes("light", &[([-80, -80, -2], [160, 160, 2]), ([-10, -10, 0], [20, 20, 30])], false, false)
}

fn sunny(camera: Camera, azimuth_deg: f64, elevation_deg: f64, shadows: bool) -> Scene {
    Scene {
        sun: Sun {
            azimuth: azimuth_deg.to_radians(),
            elevation: elevation_deg.to_radians(),
            shadows,
            ..Sun::default()
        },
        style: Style { base: BaseStyle::Clay, ..Style::default() },
        ..scene(camera, vec![])
    }
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    let request = Request { aovs: ALL, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

pub fn to_sun(scene: &Scene) -> DVec3 {
    let (azimuth, elevation) = (scene.sun.azimuth, scene.sun.elevation);
    DVec3::new(azimuth.sin() * elevation.cos(), azimuth.cos() * elevation.cos(), elevation.sin())
}

/// sRGB of linear light, 0 to 255, not rounded.
fn encoded(linear: [f64; 3]) -> [f64; 3] {
    linear.map(|c| 255.0 * if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.min(1.0).powf(1.0 / 2.4) - 0.055 })
}

pub fn decoded(srgb: [f64; 3]) -> [f64; 3] {
    srgb.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

/// What a face of clay looks like: half of the sky and half of the ground are before an upright one.
fn clay(normal: DVec3, to_sun: DVec3, share: f64) -> [f64; 3] {
    let up = 0.5 + 0.5 * normal.z;
    let falls = normal.dot(to_sun).max(0.0) * share;
    encoded(std::array::from_fn(|c| CLAY[c] * (GROUND[c] + (SKY[c] - GROUND[c]) * up + SUN[c] * falls)))
}

/// Whether a colour is another by a step of 255 at most, the rounding of both.
fn is_near(color: [u8; 4], wanted: [f64; 3]) -> bool {
    (0..3).all(|c| (f64::from(color[c]) - wanted[c]).abs() <= 1.0)
}

#[test]
fn faces_are_as_light_as_sun_sky_and_ground_say() {
    let mut studio = plate();
    let eyes = [DVec3::new(60.0, -90.0, 50.0), DVec3::new(-70.0, 60.0, 40.0), DVec3::new(30.0, -40.0, -60.0)];
    let mut seen = std::collections::BTreeSet::new();
    for eye in eyes {
        for (azimuth, elevation) in [(180.0, 40.0), (300.0, 30.0), (90.0, 90.0)] {
            let scene = sunny(Camera::looking(eye, DVec3::new(0.0, 0.0, 5.0), 0.9), azimuth, elevation, false);
            let picture = drawn(&mut studio, &scene);
            let (ids, normals) = (picture.object_id.as_ref().unwrap(), picture.normal.as_ref().unwrap());
            for (i, id) in ids.iter().enumerate().filter(|(_, id)| **id > 0) {
                let normal = DVec3::from(normals[i].map(f64::from)).round();
                seen.insert(normal.as_ivec3().to_array());
                let wanted = clay(normal, to_sun(&scene), 1.0);
                let is = picture.rgba[i];
                assert!(
                    is_near(is, wanted),
                    "object {id} facing {normal}, sun {azimuth}°, {elevation}°: {is:?}, wanted {wanted:?}"
                );
            }
        }
    }
    assert_eq!(seen.len(), 6, "all sides are seen: {seen:?}");
}

#[test]
fn shadows_end_where_the_rays_of_the_sun_say() {
    let mut studio = plate();
    for (azimuth, elevation) in [(180.0, 45.0), (250.0, 30.0), (40.0, 60.0)] {
        let camera = Camera { up: DVec3::Y, ..orthographic(DVec3::new(0.0, 0.0, 200.0), DVec3::ZERO, 120.0) };
        let scene = sunny(camera, azimuth, elevation, true);
        let picture = drawn(&mut studio, &scene);
        let view = View::new(camera, SIZE, &studio.extent()).unwrap();
        let (depth, sun) = (picture.depth.as_ref().unwrap(), to_sun(&scene));
        // Two texels of the map and a pixel, and what the slant of the light makes of it.
        let room = (2.0 * 230.0 / 4096.0 + 120.0 / f64::from(SIZE[1])) / elevation.to_radians().tan().min(1.0) + 0.2;
        let (mut lit, mut shaded) = (0, 0);
        for (i, d) in depth.iter().enumerate().filter(|(_, d)| d.is_finite()) {
            let p = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(f64::from(*d));
            if p.z > 1.0 {
                // The tower's own top is wholly lit.
                if p.truncate().abs().max_element() < 9.0 {
                    assert!(
                        is_near(picture.rgba[i], clay(DVec3::Z, sun, 1.0)),
                        "the roof at {p}: {:?}",
                        picture.rgba[i]
                    );
                }
                continue;
            }
            // Towards the sun, through the tower and through one that is larger or smaller by the room.
            let meets = |grown: f64| {
                let (mut from, mut to) = (0.0_f64, f64::INFINITY);
                for (k, (low, high)) in [(-10.0, 10.0), (-10.0, 10.0), (0.0, 30.0)].into_iter().enumerate() {
                    let ends = [(low - grown - p[k]) / sun[k], (high + grown - p[k]) / sun[k]];
                    (from, to) = (from.max(ends[0].min(ends[1])), to.min(ends[0].max(ends[1])));
                }
                from < to
            };
            if meets(room) != meets(-room) {
                continue;
            }
            let is_shaded = meets(0.0);
            if is_shaded {
                shaded += 1
            } else {
                lit += 1
            }
            let wanted = clay(DVec3::Z, sun, if is_shaded { 0.0 } else { 1.0 });
            assert!(
                is_near(picture.rgba[i], wanted),
                "{p}, sun {azimuth}°, {elevation}°, shaded: {is_shaded}: {:?}, wanted {wanted:?}",
                picture.rgba[i]
            );
        }
        assert!(lit > 10_000 && shaded > 500, "{lit} pixels lit, {shaded} in the shadow");
    }
}

#[test]
fn the_sky_goes_from_the_horizon_up() {
    let mut studio = plate();
    let camera = Camera::looking(DVec3::new(0.0, -300.0, 40.0), DVec3::new(0.0, 0.0, 140.0), 1.2);
    let scene = sunny(camera, 180.0, 40.0, false);
    let picture = drawn(&mut studio, &scene);
    let view = View::new(camera, SIZE, &studio.extent()).unwrap();
    let (horizon, zenith) = (decoded(HORIZON), decoded(ZENITH));
    let mut count = 0;
    for (i, _) in picture.depth.as_ref().unwrap().iter().enumerate().filter(|(_, d)| d.is_infinite()) {
        let direction = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).direction.normalize_or(DVec3::Z);
        let low = 1.0 - direction.z.clamp(0.0, 1.0);
        let part = 1.0 - low * low;
        let wanted = encoded(std::array::from_fn(|c| horizon[c] + (zenith[c] - horizon[c]) * part));
        assert!(is_near(picture.rgba[i], wanted), "pixel {i}: {:?}, wanted {wanted:?}", picture.rgba[i]);
        count += 1;
    }
    assert!(count > 20_000, "{count} pixels show sky");
}

/// A house whose coordinates are lost leaves the shadows of the others as they are, however far it is.
#[test]
fn shadows_of_what_is_near_do_not_depend_on_how_large_the_city_is() {
    let houses = [([0, 0, 0], [12, 12, 15]), ([25, 0, 0], [12, 12, 10])];
    let camera = Camera::looking(DVec3::new(55.0, -45.0, 30.0), DVec3::new(18.0, 6.0, 5.0), 0.7);
    let size = [320, 200];
    let drawn = |far: Option<i64>| {
        let stray = far.map(|x| ([x, 0, 0], [12, 12, 10]));
        let all: Vec<_> = houses.into_iter().chain(stray).collect();
        let mut studio = with_full_shadows(boxes("stray", &all, false, true));
        picture(&mut studio, &scene(camera, vec![]), size).rgba
    };
    let alone = drawn(None);
    // Below the horizon of the small one.
    let from = 80 * size[0] as usize;
    let shaded = alone[from..].iter().filter(|rgba| rgba[0] < 150).count();
    assert!(shaded > 1500, "{shaded} pixels are in the shade");
    for far in [2_000, 20_000, 200_000, 2_000_000] {
        let other = drawn(Some(far));
        let is_other = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).any(|k| a[k].abs_diff(b[k]) > 8);
        let differ = alone[from..].iter().zip(&other[from..]).filter(|pair| is_other(*pair)).count();
        // Borders of shadows are where texels are.
        assert!(differ < shaded / 20, "{far} m: {differ} of {shaded} pixels in the shade differ");
    }
}
