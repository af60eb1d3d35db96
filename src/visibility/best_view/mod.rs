//! Best views of city objects (beyond Trapp §3.4, which takes the best-view normal as given).
//!
//! ```text
//! object ─> subject: its faces, the ball around them, samples of its facades
//!                │
//!   directions ──┴─> rating: sight lines from the eye to the samples ─> score ─> the best, and those clearly different
//! ```
//!
//! The score of a direction is facade · unoccluded · upright · sunlit, half of it its own and half the mean of its neighbours':
//!
//! * *facade*: how much of the object's facades is seen, as large as it appears: Σ w·c·v / Σ w over samples of equal area, v = 1 where
//!   the sight line from the eye is free and 0 elsewhere, c the cosine between sight line and face normal, w = 1 − ½·n_z²: a flat roof
//!   counts for half of a wall, since it says less of a building. Of a box alone it is largest, from far, along (A_x, A_y, ½·A_z), the
//!   areas across its axes.
//! * *unoccluded*: that, over the same were the object alone: 1 where nothing else stands before it.
//! * *upright*: [`upright`], which likes views of people and low drones better than plans.
//! * *sunlit*, where a sun is given ([`Subject::lit_from`]): 1 where all that is seen is turned to it, 0.7 where nothing is; what stands in the
//!   light of the object is not asked. So of two sides that show as much the sunlit one is taken.
//! * *stable*: neighbours are 15° away in azimuth and elevation, so a view that a small turn spoils is worth less than one that it
//!   does not.
//!
//! **Cost.** Directions are those of a lattice of 5° over the upper half sphere, 1297 of them. All are looked over by every sixteenth sample; then
//! every third in azimuth and elevation (145) is rated, then those around the best of both; none twice. A rating is [`SAMPLES`] sight lines.
//!
//! **Error.** A share by 512 samples has a standard error below ½/√512 = 2.2 %; samples stand evenly along the faces, so it is mostly
//! below 1 %. Directions are exact to half a step, 2.5°. Scores closer than 2 % are ties, told apart by azimuth.

mod samples;
mod search;
#[cfg(test)]
mod tests;

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use crate::{
    city::{CityModel, spatial::SpatialIndex},
    geom::{Aabb, Ray, Sphere},
    view::{Field, Framing, FramingError},
    visibility::best_view::samples::{Facades, SAMPLES, Sample},
};

/// Views of an object that are listed at most.
pub const MOST_VIEWS: usize = 8;
/// Part of the best score that a listed view has at least.
const LEAST: f64 = 1.0 / 3.0;
/// Directions of two listed views differ by at least this, radians.
pub const APART: f64 = 30.0 * std::f64::consts::PI / 180.0;

/// The distance from a face within which nothing hides it, metres: faces of two objects in one plane are both seen.
const SKIN_M: f64 = 1e-3;

/// Why an object has no views.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoView {
    /// Nothing to look at.
    #[error("the object \"{0}\" has no faces that are shown, nor have its parts: there is nothing to look at")]
    NoFaces(String),
    /// No camera.
    #[error(transparent)]
    Framing(#[from] FramingError),
}

/// The parts of an object that are seen from somewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Area of its facades that is seen, of all of it, 0..=1; of a convex body about a half at most.
    pub visible: f64,
    /// The share that is seen, as large as it appears, of what would be were the object alone, 0..=1; 0 where nothing would be.
    pub unoccluded: f64,
    /// The share of its facades that is seen, as large as it appears, see the top of this file, 0..=1.
    pub facade: f64,
    /// The same, were the object alone.
    pub facade_alone: f64,
    /// How well what is seen is lit by the sun, as large as it appears, 0..=1: 1 where it is turned to it by 60° or less, in proportion
    /// to the cosine beyond; 1 without a sun, and where nothing is seen.
    pub lit: f64,
}

/// A view of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestView {
    /// The camera, and the best-view normal.
    pub framing: Framing,
    /// The parts that are seen from there.
    pub seen: Seen,
    /// The score, 0..=1, by which views are ordered; scores of one object compare, those of two say little.
    pub score: f64,
}

/// An object that is looked at: itself and all below it (parts, members), as far as it is shown.
#[derive(Debug)]
pub struct Subject<'a> {
    model: &'a CityModel,
    index: &'a SpatialIndex,
    /// Per object of the city, whether it is the subject.
    is_own: Vec<bool>,
    /// S = (M, r): the smallest ball around the corners of all that is shown of it, metres.
    pub ball: Sphere,
    /// Around the same corners, metres; not empty.
    pub bounds: Aabb,
    facades: Facades,
    /// The corners of all that is shown of it, metres.
    corners: Vec<DVec3>,
    sun: Option<DVec3>,
}

impl<'a> Subject<'a> {
    /// An object of a city of which the geometries `shown` are shown; `index` finds their triangles.
    pub fn new(model: &'a CityModel, shown: &[u32], index: &'a SpatialIndex, object: u32) -> Result<Self, NoView> {
        let is_own = family(model, object);
        let own: Vec<u32> =
            shown.iter().copied().filter(|&g| is_own[model.geometries[g as usize].object as usize]).collect();
        let none = || NoView::NoFaces(model.objects[object as usize].id.to_string());
        let facades = Facades::new(model, &own).ok_or_else(none)?;
        let corners = samples::corners(model, &own);
        let ball = Sphere::around(&corners).ok_or_else(none)?;
        let bounds = Aabb::from_points(corners.iter().copied());
        Ok(Self { model, index, is_own, ball, bounds, facades, corners, sun: None })
    }

    /// The same in the light of a sun in this direction (unit), if it is above the horizon: views of the sunlit side are better.
    #[must_use]
    pub fn lit_from(self, sun: DVec3) -> Self {
        Self { sun: Some(sun).filter(|sun| sun.z > 0.0), ..self }
    }

    /// The corners of all that is shown of it, metres; several times where faces meet.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// Its views, best first: each the best of those around it, [`APART`] from all before it, and a third as good as the first at least;
    /// `most` (≤ [`MOST_VIEWS`]) at most and one at least. What is seen from nowhere, as what is in another object, has the views that it would have alone, with `visible` 0.
    pub fn best_views(&self, field: &Field, most: usize) -> Result<Vec<BestView>, NoView> {
        search::best_views(self, field, most.clamp(1, MOST_VIEWS))
    }

    /// The middle of its facades: the mean of their samples, metres. Unlike that of its box it lies at or in the bulk of the object, whatever towers
    /// or wings it has.
    pub fn middle(&self) -> DVec3 {
        self.facades.samples.iter().map(|sample| sample.at).sum::<DVec3>() / SAMPLES as f64
    }

    /// Its view from a direction that is given (BVN, any length); `viewer` as for [`Framing::new`].
    pub fn view_along(&self, normal: DVec3, field: &Field, viewer: Option<[DVec3; 2]>) -> Result<BestView, NoView> {
        let framing = Framing::new(&self.ball, normal, field, viewer)?;
        let seen = self.seen(framing.eye);
        let score = search::score_along(self, framing.normal, field);
        Ok(BestView { framing, seen, score })
    }

    /// The parts that are seen from an eye.
    fn seen(&self, eye: DVec3) -> Seen {
        self.seen_by(1, eye)
    }

    /// The same by every so many-th sample.
    fn seen_by(&self, every: usize, eye: DVec3) -> Seen {
        let (mut count, mut seen, mut alone, mut lit) = (0_u32, 0.0, 0.0, 0.0);
        for sample in self.facades.samples.iter().step_by(every) {
            let to = sample.at - eye;
            let distance = to.length();
            if distance <= SKIN_M {
                continue;
            }
            let appears = sample.weight * (sample.normal.dot(to) / distance).abs();
            let (by_itself, by_others) = self.hidden(eye, sample, distance);
            if !by_itself {
                alone += appears;
                if !by_others {
                    (count, seen) = (count + 1, seen + appears);
                    lit += appears * self.sun.map_or(1.0, |sun| lit_by(sun, sample.normal, to));
                }
            }
        }
        let share = every as f64;
        Seen {
            visible: share * f64::from(count) / SAMPLES as f64,
            unoccluded: if alone > 0.0 { seen / alone } else { 0.0 },
            facade: share * seen / self.facades.weight,
            facade_alone: share * alone / self.facades.weight,
            lit: if seen > 0.0 { lit / seen } else { 1.0 },
        }
    }

    /// The share of the area of its walls that is seen from an eye, 0..=1: of faces steeper than 45°, and of all where none is.
    pub fn walls_seen(&self, eye: DVec3) -> f64 {
        let is_wall = |sample: &&Sample| sample.normal.z.abs() < FRAC_1_SQRT_2;
        let walls: Vec<&Sample> = self.facades.samples.iter().filter(is_wall).collect();
        let asked = if walls.is_empty() { self.facades.samples.iter().collect() } else { walls };
        let seen = asked.iter().filter(|sample| self.is_free(eye, sample)).count();
        seen as f64 / asked.len() as f64
    }

    /// Whether nothing is before a sample.
    fn is_free(&self, eye: DVec3, sample: &Sample) -> bool {
        let ray = Ray { origin: eye, direction: sample.at - eye };
        let mut is_free = true;
        self.index.hits_until(self.model, &ray, 1.0 - SKIN_M / ray.direction.length(), |hit| {
            is_free = hit.triangle == sample.triangle;
            !is_free
        });
        is_free
    }

    /// Whether the object itself is before a sample, and whether another is; not asked of what it hides itself. Of a closed body the
    /// inner sides of its far faces are behind the near ones, so which way faces look is not asked either.
    fn hidden(&self, eye: DVec3, sample: &Sample, distance: f64) -> (bool, bool) {
        let ray = Ray { origin: eye, direction: sample.at - eye };
        let (mut by_itself, mut by_others) = (false, false);
        self.index.hits_until(self.model, &ray, 1.0 - SKIN_M / distance, |hit| {
            match self.is_own[hit.object as usize] {
                true => by_itself |= hit.triangle != sample.triangle,
                false => by_others = true,
            }
            by_itself
        });
        (by_itself, by_others)
    }
}

/// The views of an object, best first: see [`Subject`].
pub fn best_views(
    model: &CityModel,
    shown: &[u32],
    index: &SpatialIndex,
    object: u32,
    field: &Field,
) -> Result<Vec<BestView>, NoView> {
    Subject::new(model, shown, index, object)?.best_views(field, MOST_VIEWS)
}

/// The weight of a view from this elevation, ½..=1, radians above the horizon: 1 up to 30°, where people and low drones look from,
/// then less, to ½ straight down (3t² − 2t³ between). The same below the horizon.
pub fn upright(elevation: f64) -> f64 {
    const FIRST: f64 = std::f64::consts::FRAC_PI_6;
    let t = ((elevation.abs() - FIRST) / (std::f64::consts::FRAC_PI_2 - FIRST)).clamp(0.0, 1.0);
    1.0 - 0.5 * t * t * (3.0 - 2.0 * t)
}

/// How well the side of a face that an eye looks `to` is lit by a sun: 1 up to 60° from it, none from 90° on.
fn lit_by(sun: DVec3, normal: DVec3, to: DVec3) -> f64 {
    let facing = if normal.dot(to) > 0.0 { -normal } else { normal };
    (2.0 * facing.dot(sun)).clamp(0.0, 1.0)
}

/// An object and all below it, one flag per object of the city.
fn family(model: &CityModel, object: u32) -> Vec<bool> {
    let mut is_own = vec![false; model.objects.len()];
    let mut open = vec![object];
    while let Some(member) = open.pop() {
        // Each once, whatever files say of which belongs to which.
        if !std::mem::replace(&mut is_own[member as usize], true) {
            open.extend(&model.objects[member as usize].children);
        }
    }
    is_own
}
