//! Common parts of lens volumes. A volume that is several bodies in union makes several of them.
//!
//! A convex volume is flat faces (half spaces) and at most one round part, which every point outside can be parted from by
//! a plane. The planes of all volumes together bound the part, so flat volumes need nothing but clipping. Round parts are
//! cut away plane by plane: what is left of the polygon or body is asked for its middle; if the round parts hold that, it is
//! a common point, and if not, each that does not hold it gives a plane behind which nothing of it lies, and the middle with
//! it. A plane through or before the centre of gravity takes at least 4/9 of an area and 27/64 of a volume (Grünbaum 1960
//! for convex bodies), so either a common point is found or nothing is left. A point within [`TOUCH_M`] of a volume counts
//! as in it: borders belong to volumes.

use glam::DVec3;

use crate::geom::{aabb::Aabb, shape::Volume, triangle::clipped};

/// The distance from a volume within which a point is taken to be on its border, metres: a thousandth of the finest lattice of city files;
/// more for volumes of 1,000 km and beyond, by what f64 loses in them.
pub const TOUCH_M: f64 = 1e-9;

/// Boxes are called outside or inside only where they are so by this much, metres: the tests of triangles round as well.
const SLACK_M: f64 = 1e-6;

/// Rounds of cuts after which what is left counts as a point of touch: each takes 2/5 at least, so a square kilometre
/// would be 10⁻²⁵ m² by then.
const MOST_ROUNDS: usize = 150;

/// The points that are in each of several convex volumes; there is at least one.
#[derive(Clone, Debug)]
pub struct CommonPart {
    volumes: Vec<Volume>,
    /// Near its middle; the planes are relative to it, which keeps the digits.
    origin: DVec3,
    /// All flat faces: n · (p − origin) ≤ d, n unit outwards.
    faces: Vec<(DVec3, f64)>,
    /// A box that holds it, metres.
    bounds: Aabb,
    /// [`SLACK_M`] and [`TOUCH_M`], more where the volumes are so large that rounding is.
    slack: f64,
    touch: f64,
}

impl CommonPart {
    /// The part that convex `volumes` have in common, solids and flat lenses standing for the boxes around them; `None` if that is nothing (or no volumes are given).
    pub fn common(volumes: &[Volume]) -> Option<Self> {
        let bounds =
            volumes.iter().map(Volume::bounds).reduce(|a, b| Aabb { min: a.min.max(b.min), max: a.max.min(b.max) })?;
        if bounds.is_empty() || volumes.iter().any(Volume::is_empty) {
            return None;
        }
        let origin = bounds.center().round();
        let faces: Vec<(DVec3, f64)> = volumes.iter().flat_map(|v| v.flat_faces(origin)).collect();
        let size = bounds.min.abs().max(bounds.max.abs()).max_element();
        let largest = volumes.iter().map(|v| v.bounds().size().max_element()).fold(size, f64::max);
        let (slack, touch) = (SLACK_M + 1e-13 * largest, TOUCH_M.max(1e-15 * largest));
        let mut region = Self { volumes: volumes.to_vec(), origin, faces, bounds, slack, touch };
        if let [_] = volumes {
            return Some(region);
        }
        let body = region.cut_to_a_common_point(Body::cuboid(bounds.min - origin, bounds.max - origin))?;
        let around = Aabb::from_points(body.faces.iter().flatten().map(|p| *p + origin));
        region.bounds = Aabb { min: around.min - slack, max: around.max + slack };
        Some(region)
    }

    /// The volumes whose intersection it is.
    pub fn volumes(&self) -> &[Volume] {
        &self.volumes
    }

    /// A box that holds all of it, metres; of one volume the smallest.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Whether all of its volumes hold `p`; closed.
    pub fn contains(&self, p: DVec3) -> bool {
        self.volumes.iter().all(|v| v.contains(p))
    }

    /// Whether the closed triangle and the region share a point.
    pub fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        match &self.volumes[..] {
            [one] => one.meets_triangle(corners),
            _ => self.cuts_down(corners),
        }
    }

    /// [`CommonPart::meets_triangle`] by cutting, for any number of volumes.
    fn cuts_down(&self, corners: &[DVec3; 3]) -> bool {
        let local = corners.map(|p| p - self.origin);
        let mut left = clipped(&local, self.faces.iter().copied());
        for _ in 0..MOST_ROUNDS {
            if left.is_empty() {
                return false;
            }
            let middle = middle_of_polygon(&left);
            let cuts = self.cuts(middle);
            if cuts.is_empty() {
                return true;
            }
            left = clipped(&left, cuts);
        }
        true
    }

    /// The part of `body` that is left when its middle is a common point; `None` where there is none.
    fn cut_to_a_common_point(&self, mut body: Body) -> Option<Body> {
        for &face in &self.faces {
            body.cut(face.0, face.1);
        }
        for _ in 0..MOST_ROUNDS {
            let cuts = self.cuts(body.middle()?);
            if cuts.is_empty() {
                break;
            }
            for cut in cuts {
                body.cut(cut.0, cut.1);
            }
        }
        (!body.faces.is_empty()).then_some(body)
    }

    /// The planes that part a point from the round volumes that do not hold it.
    fn cuts(&self, p: DVec3) -> Vec<(DVec3, f64)> {
        let is_beyond = |(normal, offset): &(DVec3, f64)| normal.dot(p) - offset > self.touch;
        self.volumes.iter().filter_map(|v| v.parting_plane(p, self.origin)).filter(is_beyond).collect()
    }

    /// Where an axis-aligned box is: `None` outside, `Some(true)` wholly inside. A box that it cannot decide is
    /// `Some(false)`; what it says of the others is so also of everything in them.
    pub fn coverage(&self, bounds: &Aabb) -> Option<bool> {
        let wide = |by: f64| Aabb { min: bounds.min - by, max: bounds.max + by };
        if !self.bounds.meets(&wide(self.slack)) {
            return None;
        }
        let (center, half) = (bounds.center() - self.origin, 0.5 * bounds.size() + self.slack);
        let mut is_inside = true;
        for (normal, offset) in &self.faces {
            let (distance, reach) = (normal.dot(center) - offset, normal.abs().dot(half));
            if distance > reach {
                return None;
            }
            is_inside &= distance <= -reach;
        }
        for volume in &self.volumes {
            if let Some((normal, offset)) = volume.parting_plane(center, self.origin) {
                if normal.dot(center) - offset > normal.abs().dot(half) {
                    return None;
                }
                is_inside = false;
            }
        }
        let corners = || wide(self.slack).corners().map(|p| p - self.origin);
        let holds_all = |v: &Volume| corners().iter().all(|p| v.parting_plane(*p, self.origin).is_none());
        Some(is_inside && self.volumes.iter().all(holds_all))
    }
}

/// The centre of gravity of a convex polygon; of one without area, of its corners.
fn middle_of_polygon(corners: &[DVec3]) -> DVec3 {
    let first = corners[0];
    let (mut sum, mut area) = (DVec3::ZERO, 0.0);
    for pair in corners[1..].windows(2) {
        let (a, b) = (pair[0] - first, pair[1] - first);
        let part = a.cross(b).length();
        sum += part * (a + b) / 3.0;
        area += part;
    }
    let mean = || corners.iter().map(|p| *p - first).sum::<DVec3>() / corners.len() as f64;
    first + if area > 0.0 { sum / area } else { mean() }
}

/// A convex body as its faces; flat or empty ones too.
struct Body {
    faces: Vec<Vec<DVec3>>,
}

impl Body {
    fn cuboid(min: DVec3, max: DVec3) -> Self {
        let corners = Aabb { min, max }.corners();
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        Self { faces: quads.iter().map(|quad| quad.iter().map(|&i: &usize| corners[i]).collect()).collect() }
    }

    /// Leaves what lies behind the plane n · p ≤ d.
    fn cut(&mut self, normal: DVec3, offset: f64) {
        let depth = |p: &DVec3| offset - normal.dot(*p);
        if self.faces.iter().flatten().all(|p| depth(p) >= 0.0) {
            return;
        }
        let mut rim: Vec<DVec3> = Vec::new();
        for face in &mut self.faces {
            let left = clipped(face, [(normal, offset)]);
            // What the plane cut or touches: corners that were not there before, or lie in it.
            rim.extend(left.iter().filter(|p| depth(p) <= 0.0 || !face.contains(p)));
            *face = left;
        }
        self.faces.retain(|face| !face.is_empty());
        if rim.is_empty() {
            return;
        }
        let (u, v) = normal.any_orthonormal_pair();
        let middle = rim.iter().sum::<DVec3>() / rim.len() as f64;
        let turn = |p: &DVec3| (*p - middle).dot(v).atan2((*p - middle).dot(u));
        rim.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        rim.dedup();
        self.faces.push(rim);
    }

    /// Its centre of gravity; of one without volume, of its corners; `None` of nothing.
    fn middle(&self) -> Option<DVec3> {
        let corners = || self.faces.iter().flatten();
        let count = corners().count();
        if count == 0 {
            return None;
        }
        let apex = corners().sum::<DVec3>() / count as f64;
        let (mut sum, mut volume) = (DVec3::ZERO, 0.0);
        for face in &self.faces {
            let first = face[0] - apex;
            for pair in face[1..].windows(2) {
                let (a, b) = (pair[0] - apex, pair[1] - apex);
                let part = first.dot(a.cross(b)).abs();
                sum += part * (first + a + b) / 4.0;
                volume += part;
            }
        }
        Some(if volume > 0.0 { apex + sum / volume } else { apex })
    }
}

#[cfg(test)]
mod tests;
