//! The light on the faces of a city by rays in f64: what pictures of more and more samples come near.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::{
    geom::{Aabb, Ray},
    measure::difference::{Against, linear_light},
    render::{
        light::{self, LightSample, Surround, to_sun},
        palette::CLAY,
        picture::{Aovs, Picture, RenderError, Request, Studio},
    },
    scene::Scene,
    view::View,
};

/// Rays from each place to the disc of the sun, and to the sky: Fibonacci numbers, for a lattice of two dimensions.
const RAYS: [u32; 2] = [233, 987];
/// The Fibonacci numbers before them.
const STEPS: [u32; 2] = [144, 610];
/// Rays begin so far from where the depth of a pixel says, which f32 rounds, metres.
const AWAY_M: f64 = 2e-3;
/// About so many pixels of a picture are compared.
const PIXELS: usize = 4000;

/// Light on clay in some pixels of a picture, those all of whose neighbours show the same face: linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightByRays {
    pixels: Vec<(usize, [f64; 3])>,
}

/// Place `i` of a lattice in the unit square.
fn in_square(i: u32, rays: usize) -> DVec2 {
    let n = RAYS[rays];
    DVec2::new((f64::from(i) + 0.5) / f64::from(n), f64::from(i * STEPS[rays] % n) / f64::from(n))
}

impl LightByRays {
    /// That of a picture of this size of a scene in clay without lenses, one sample, that fits one target.
    ///
    /// # Errors
    /// What cannot be drawn.
    pub fn new(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Result<Self, RenderError> {
        let aovs = Aovs { depth: true, normal: true, object_id: true, ..Aovs::default() };
        let picture = studio.render(scene, &Request { aovs, ..Request::plain(size) })?;
        let view = View::new(studio.camera(scene, size), size, &Aabb::EMPTY)?;
        let places = places(&view, &picture);
        studio.find_triangles();
        let index = studio.index().get();
        let is_free = |origin: DVec3, direction: DVec3| {
            index.is_none_or(|index| index.hit(&studio.model, &Ray { origin, direction }).is_none())
        };
        let colors = light::uniform(
            &scene.sun,
            &LightSample::new(&scene.sun, 0, 1, false),
            &Surround { look: scene.style.look, background: scene.style.background, fade: None },
            [None; 2],
            view.camera.eye,
            1.0,
        );
        let middle = to_sun(&scene.sun);
        let (aside, up) = middle.any_orthonormal_pair();
        let radius = (0.5 * scene.sun.size).tan();
        let lit = |(i, place, normal): (usize, DVec3, DVec3)| {
            let from = place + AWAY_M * normal;
            let falls = |to: DVec3| if is_free(from, to) { normal.dot(to).max(0.0) } else { 0.0 };
            let of_disc = |i: u32| {
                let p = in_square(i, 0);
                let (sin, cos) = (TAU * p.y).sin_cos();
                falls((middle + radius * p.x.sqrt() * (cos * aside + sin * up)).normalize_or(middle))
            };
            // Uniform over the hemisphere.
            let of_sky = |i: u32| {
                let p = in_square(i, 1);
                let (sin, cos) = (TAU * p.y).sin_cos();
                let level = (1.0 - p.x * p.x).sqrt();
                2.0 * falls(DVec3::new(level * cos, level * sin, p.x))
            };
            let sun = (0..RAYS[0]).map(of_disc).sum::<f64>() / f64::from(RAYS[0]);
            let sky = (0..RAYS[1]).map(of_sky).sum::<f64>() / f64::from(RAYS[1]);
            let of = |c: usize| {
                let arrives = f64::from(colors.ground[c]) * (0.5 - 0.5 * normal.z)
                    + f64::from(colors.sky[c]) * sky
                    + f64::from(colors.sun[c]) * sun;
                f64::from(CLAY[c]) * arrives
            };
            (i, [0, 1, 2].map(of))
        };
        Ok(Self { pixels: places.into_par_iter().map(lit).collect() })
    }

    /// The errors of a picture, which has 8 bits a channel: steps of at most 0.009 of linear light.
    pub fn errors(&self, picture: &Picture) -> Against {
        Against::of(self.pixels.iter().map(|(i, right)| {
            let found = linear_light(picture.rgba[*i]);
            [0, 1, 2].map(|c| found[c] - right[c])
        }))
    }
}

/// Pixels of objects, each with its place and normal: some, evenly spread, whose neighbours all lie in its plane.
fn places(view: &View, picture: &Picture) -> Vec<(usize, DVec3, DVec3)> {
    let (Some(depth), Some(normals), Some(ids)) = (&picture.depth, &picture.normal, &picture.object_id) else {
        return Vec::new();
    };
    let [w, h] = picture.size.map(|side| side as usize);
    let place = |i: usize| view.pixel_ray((i % w) as u32, (i / w) as u32).at(f64::from(depth[i]));
    let found = |i: usize| {
        let normal = DVec3::from(normals[i].map(f64::from));
        let is_same =
            |k: usize| ids[k] == ids[i] && normals[k] == normals[i] && (place(k) - place(i)).dot(normal).abs() < 0.01;
        let rows = [i - w, i, i + w];
        let is_inside = ids[i] > 0 && rows.iter().all(|row| (row - 1..=row + 1).all(is_same));
        is_inside.then(|| (i, place(i), normal.normalize_or(DVec3::Z)))
    };
    let inside = (1..h.saturating_sub(1)).flat_map(|y| (1..w.saturating_sub(1)).map(move |x| y * w + x));
    let all: Vec<_> = inside.filter_map(found).collect();
    let every = all.len().div_ceil(PIXELS).max(1);
    all.into_iter().step_by(every).collect()
}
