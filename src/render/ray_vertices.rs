//! Triangles whose corners lenses move: which of the city's they show, and how finely each is cut.
//!
//! A triangle is cut into `n²` parts by cutting each side into n: so often that the sides of parts are short in the picture of the lens, a power
//! of two. All triangles that are cut alike are drawn at once.

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

use crate::{
    lens::{
        ray::RayMethod,
        ray_path::{ImageBend, RayPaths},
    },
    view::View,
};

/// How long sides of parts may be in the picture, pixels, where nothing is said.
const SIDE_PX: f64 = 12.0;
/// Into how many parts a side is cut at most, as a power of two.
const MOST_CUTS: u32 = 6;

/// Where triangles of a city are, and what they are called.
pub(super) struct CityTriangles<'a> {
    /// Three of them for each triangle, and the corners' own words.
    pub words: &'a [[u32; 4]],
    /// Where the first begins for the shaders.
    pub first: u32,
    /// Its number for the shaders.
    pub city: u32,
    /// From the corners' steps to view space.
    pub to_view: DMat3,
    /// What corners are counted from, in those steps.
    pub eye: DVec3,
}

/// Triangles that are cut alike: into how many parts each side is, and of each triangle where its words begin, its city, and that number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Pieces {
    pub all: Vec<[u32; 3]>,
    /// How many of them are cut into 1, 2, 4, ... parts a side, in this order.
    pub counts: [u32; MOST_CUTS as usize + 1],
}

/// What lenses show: where in the picture, and how large.
struct Reach {
    /// The picture's places that they show, and how much larger they show what is there at most.
    flat: Vec<([DVec2; 2], f64)>,
    /// Of the largest fisheye: pixels to a radian.
    round: f64,
}

impl Reach {
    fn new(paths: &RayPaths, view: &View) -> Self {
        let mut reach = Self { flat: Vec::new(), round: 0.0 };
        let mut add = |center: DVec2, radius: f64, magnifies: f64, fineness: f64| {
            // What is made smaller comes from beyond the rim.
            let radius = DVec2::splat(radius * magnifies.recip().max(1.0));
            reach.flat.push(([center - radius, center + radius], magnifies.max(1.0) * fineness));
        };
        for lens in paths.planes.iter().filter(|lens| lens.rim.method == RayMethod::Vertices) {
            add(lens.rim.center, lens.rim.radius, lens.magnifies(paths.is_parallel), lens.rim.fineness);
        }
        let mut round: f64 = 0.0;
        for lens in paths.images.iter().filter(|lens| lens.rim.method == RayMethod::Vertices) {
            match &lens.bend {
                ImageBend::Sampled(radius) => {
                    add(lens.rim.center, lens.rim.radius, radius.magnifies(), lens.rim.fineness);
                }
                ImageBend::Round(angle, _) => {
                    let radius_px = lens.rim.radius / (2.0 * view.half_extent().y) * f64::from(view.size[1]);
                    round = round.max(radius_px / (0.5 * angle) * lens.rim.fineness);
                }
                // A handler has no inverse.
                ImageBend::Own(_) => {}
            }
        }
        Self { round, ..reach }
    }

    /// How long the longest side of a triangle may be shown, pixels; `None`: no lens shows it.
    fn longest_px(&self, corners: &[DVec3; 3], view: &View) -> Option<f64> {
        let mut longest = None;
        let mut add = |px: f64| longest = Some(longest.map_or(px, |before: f64| before.max(px)));
        let sides = [[0, 1], [1, 2], [2, 0]];
        if self.round > 0.0 {
            // A side is never seen wider than from its nearest place.
            let near = corners.iter().map(|c| c.length()).fold(f64::INFINITY, f64::min);
            let length = sides.iter().map(|[i, k]| corners[*i].distance(corners[*k])).fold(0.0, f64::max);
            add(self.round * (length / near.max(1e-3)).min(std::f64::consts::TAU));
        }
        let is_parallel = view.is_orthographic();
        let is_before = corners.iter().all(|c| -c.z > view.camera.near_m);
        let per_pixel = f64::from(view.size[1]) / (2.0 * view.half_extent().y);
        if is_parallel || is_before {
            let places = corners.map(|c| c.truncate() / if is_parallel { 1.0 } else { -c.z });
            let low = places[0].min(places[1]).min(places[2]);
            let high = places[0].max(places[1]).max(places[2]);
            let length = sides.iter().map(|[i, k]| places[*i].distance(places[*k])).fold(0.0, f64::max);
            for ([from, to], magnifies) in &self.flat {
                if low.cmple(*to).all() && high.cmpge(*from).all() {
                    add(length * per_pixel * magnifies);
                }
            }
        } else if corners.iter().any(|c| -c.z > view.camera.near_m) {
            self.flat.iter().for_each(|_| add(f64::INFINITY));
        }
        longest
    }
}

/// What lenses that move corners show of cities.
pub(super) fn pieces(paths: &RayPaths, view: &View, cities: &[CityTriangles]) -> Pieces {
    let reach = Reach::new(paths, view);
    let mut by_cuts: Vec<Vec<[u32; 3]>> = vec![Vec::new(); MOST_CUTS as usize + 1];
    for city in cities {
        let of = |(number, words): (usize, &[[u32; 4]])| {
            let corner = |word: &[u32; 4]| {
                let at = DVec3::new(f64::from(word[0] as i32), f64::from(word[1] as i32), f64::from(word[2] as i32));
                city.to_view * (at - city.eye)
            };
            let longest = reach.longest_px(&[corner(&words[0]), corner(&words[1]), corner(&words[2])], view)?;
            let level = (longest / SIDE_PX).max(1.0).log2().ceil().min(f64::from(MOST_CUTS)) as u32;
            Some((level, [city.first + 3 * number as u32, city.city, 1 << level]))
        };
        let found: Vec<(u32, [u32; 3])> = city.words.par_chunks(3).enumerate().filter_map(of).collect();
        found.into_iter().for_each(|(level, piece)| by_cuts[level as usize].push(piece));
    }
    let mut counts = [0; MOST_CUTS as usize + 1];
    counts.iter_mut().zip(&by_cuts).for_each(|(count, all)| *count = all.len() as u32);
    Pieces { all: by_cuts.concat(), counts }
}
