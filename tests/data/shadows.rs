//! Shadows of the shared cities against exact rays of the sun, one through every pixel.

use glam::DVec3;
use libtest_mimic::{Failed, Trial};
use veduta::{
    city::spatial::SpatialIndex,
    geom::Ray,
    render::picture::Studio,
    scene::{BaseStyle, Scene, Style, Sun},
    view::{Camera, View},
};

use crate::studio;

const SIZE: [u32; 2] = [440, 275];
/// Rays begin so far from where the depth of a pixel says, which f32 rounds, metres.
const AWAY_M: f64 = 2e-3;
/// Faces that the light only grazes are dark whether it falls on them or not; the cosine from which it tells.
const GRAZING: f64 = 0.2;

fn luminance(rgba: [u8; 4]) -> f64 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * linear(rgba[0]) + 0.7152 * linear(rgba[1]) + 0.0722 * linear(rgba[2])
}

/// Of the pixels on which the sun may shine, those whose light no ray within a pixel has; and how many were compared.
fn wrong_pixels(studio: &mut Studio, camera: Camera, sun: Sun) -> Result<[usize; 2], Failed> {
    let style = Style { base: BaseStyle::Clay, ..Style::default() };
    let scene =
        |shadows: bool| Scene { sun: Sun { shadows, ..sun }, style: style.clone(), ..studio::scene(camera, vec![]) };
    let with = studio::picture(studio, &scene(true), SIZE);
    let without = studio::picture(studio, &scene(false), SIZE);
    let view = View::new(camera, SIZE, &studio.extent())?;
    let to_sun = DVec3::new(
        sun.azimuth.sin() * sun.elevation.cos(),
        sun.azimuth.cos() * sun.elevation.cos(),
        sun.elevation.sin(),
    );
    let index = SpatialIndex::build(&studio.model, &studio.geometries);
    let (depth, normals) = (with.depth.as_ref().ok_or("no depth")?, with.normal.as_ref().ok_or("no normals")?);
    let pixels = || (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    // Whether the sun shines there; none where nothing is or what is there faces away from it.
    let exact: Vec<Option<bool>> = pixels()
        .zip(depth.iter().zip(normals))
        .map(|((x, y), (d, normal))| {
            let normal = DVec3::from(normal.map(f64::from));
            if !d.is_finite() || normal.dot(to_sun) < GRAZING {
                return None;
            }
            let origin = view.pixel_ray(x, y).at(f64::from(*d)) + AWAY_M * (normal + to_sun);
            Some(index.hit(&studio.model, &Ray { origin, direction: to_sun }).is_none())
        })
        .collect();
    let [w, h] = SIZE.map(|side| side as i32);
    let (mut wrong, mut compared) = (0, 0);
    for ((i, (x, y)), own) in pixels().enumerate().zip(&exact) {
        if own.is_none() {
            continue;
        }
        // A lit face has the light that it has without shadows; half of it is the border.
        let left = luminance(with.rgba[i]) / luminance(without.rgba[i]).max(1e-6);
        let cosine = DVec3::from(normals[i].map(f64::from)).dot(to_sun);
        let shaded = 0.33 / (0.33 + 0.75 * cosine);
        let is_lit = left > 0.5 * (1.0 + shaded);
        let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x as i32 + dx, y as i32 + dy)));
        let is_right = near
            .filter(|(x, y)| (0..w).contains(x) && (0..h).contains(y))
            .any(|(x, y)| exact[(y * w + x) as usize] == Some(is_lit));
        compared += 1;
        wrong += usize::from(!is_right);
    }
    Ok([wrong, compared])
}

pub fn trials() -> Vec<Trial> {
    let sun = |azimuth: f64, elevation: f64| Sun {
        azimuth: azimuth.to_radians(),
        elevation: elevation.to_radians(),
        ..Sun::default()
    };
    vec![crate::trial("shadows::shadows_are_those_of_exact_rays_in_the_street_and_from_above", move |root| {
        let mut studio = studio::studio(&[root.join("denhaag-01/DenHaag_01.v1.0.city.json")]);
        studio = studio::with_full_shadows(studio);
        let street = DVec3::new(78552.34, 457830.52, 12.463);
        let views = [
            (Camera::looking(street, street + DVec3::new(150.0, 150.0, 0.0), 60_f64.to_radians()), sun(100.0, 15.0)),
            (Camera::looking(street, street + DVec3::new(150.0, 150.0, 0.0), 60_f64.to_radians()), sun(220.0, 35.0)),
            (
                Camera::looking(
                    street + DVec3::new(-200.0, -300.0, 260.0),
                    street + DVec3::new(150.0, 150.0, 0.0),
                    45_f64.to_radians(),
                ),
                sun(100.0, 15.0),
            ),
        ];
        let mut all = Vec::new();
        for (camera, sun) in views {
            all.push(wrong_pixels(&mut studio, camera, sun)?);
        }
        if all.iter().all(|[wrong, compared]| wrong * 200 <= *compared && *compared > 10_000) {
            Ok(())
        } else {
            Err(format!("pixels of another light than rays within a pixel, and pixels compared: {all:?}").into())
        }
    })]
}
