//! Shadows of a picture against exact rays of the sun, one through every pixel.

use glam::{DVec2, DVec3};
use veduta::{
    city::spatial::SpatialIndex,
    geom::Ray,
    render::picture::Studio,
    scene::{BaseStyle, Scene, Style, Sun},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [440, 275];
/// Rays begin so far from where the depth of a pixel says, which f32 rounds, metres.
const AWAY_M: f64 = 2e-3;
/// A texel of the shadow map may be as many pixels wide (`render::sun_eye`).
const TEXEL_PX: f64 = 1.5;
/// Faces that the light only grazes are dark whether it falls on them or not; the cosine from which it tells.
const GRAZING: f64 = 0.2;

fn luminance(rgba: [u8; 4]) -> f64 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * linear(rgba[0]) + 0.7152 * linear(rgba[1]) + 0.0722 * linear(rgba[2])
}

/// Of the pixels on which the sun may shine, those whose light no ray within a texel of the shadow map has; and how many were compared.
pub fn wrong_shadows(studio: &mut Studio, camera: Camera, sun: Sun) -> Result<[usize; 2], &'static str> {
    let style = Style { base: BaseStyle::Clay, ..Style::default() };
    let scene =
        |shadows: bool| Scene { sun: Sun { shadows, ..sun }, style: style.clone(), ..super::scene(camera, vec![]) };
    let with = super::picture(studio, &scene(true), SIZE);
    let without = super::picture(studio, &scene(false), SIZE);
    let view = View::new(camera, SIZE, &studio.extent()).map_err(|_| "no view")?;
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
    // What is smaller than a pixel shows in none beside it: whether the sun is so within a texel of the shadow map, on the plane of the face.
    let is_beside = |x: u32, y: u32, is_lit: bool| {
        let i = (y * SIZE[0] + x) as usize;
        let normal = DVec3::from(normals[i].map(f64::from));
        let place = view.pixel_ray(x, y).at(f64::from(depth[i]));
        let steps = || (-6..=6).map(|step| f64::from(step) * TEXEL_PX / 6.0);
        steps().flat_map(|dy| steps().map(move |dx| DVec2::new(dx, dy))).any(|aside| {
            let ray = view.ray(DVec2::new(f64::from(x), f64::from(y)) + 0.5 + aside);
            let along = (place - ray.origin).dot(normal) / ray.direction.dot(normal);
            let origin = ray.at(along) + AWAY_M * (normal + to_sun);
            index.hit(&studio.model, &Ray { origin, direction: to_sun }).is_none() == is_lit
        })
    };
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
        wrong += usize::from(!is_right && !is_beside(x, y, is_lit));
    }
    Ok([wrong, compared])
}
