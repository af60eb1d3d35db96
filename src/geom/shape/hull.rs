//! Convex hulls of points: exact decisions, f64 planes.
//!
//! Incremental hull with Shewchuk's adaptive predicates (crate `robust`): a face that sees the new point is removed,
//! the horizon is joined to it. "Sees" is the exact sign of a determinant, so coplanar and repeated points are safe.

use glam::DVec3;
use robust::{Coord3D, orient3d};
use rustc_hash::FxHashMap;

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{error::ShapeError, limits::MAX_POINTS},
};

/// A hull thinner than this has no usable inside, metres.
pub(super) const THIN_M: f64 = 1e-6;

/// A convex polytope.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Near the middle of the points; everything else is relative to it, which keeps the digits.
    pub(super) center: DVec3,
    /// Corners, relative to `center`.
    pub(super) corners: Vec<DVec3>,
    /// Corners of each triangle, counter-clockwise from outside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// One per face: unit normal outwards, distance from `center`.
    pub(super) planes: Vec<(DVec3, f64)>,
}

/// Exact: positive where `d` is on the outer side of the triangle `a b c` (counter-clockwise from outside).
fn outside(points: &[DVec3], [a, b, c]: [u32; 3], d: u32) -> f64 {
    let at = |i: u32| {
        let p = points[i as usize];
        Coord3D { x: p.x, y: p.y, z: p.z }
    };
    -orient3d(at(a), at(b), at(c), at(d))
}

impl Hull {
    /// The hull of `points`; refuses what has no volume.
    pub fn new(points: &[DVec3]) -> Result<Self, ShapeError> {
        if !points.iter().all(|p| p.is_finite()) {
            return Err(ShapeError::NotFinite);
        }
        if points.len() > MAX_POINTS {
            return Err(ShapeError::ManyPoints(points.len()));
        }
        let mut distinct: Vec<DVec3> = points.iter().map(|p| *p + 0.0).collect();
        distinct.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
        distinct.dedup();
        if distinct.len() < 4 {
            return Err(ShapeError::FewPoints(distinct.len()));
        }
        let triangles = grown(&distinct, first_tetrahedron(&distinct)?);
        Ok(Self::assembled(&distinct, &triangles))
    }

    /// Drops the points inside, and finds the planes.
    fn assembled(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let center = Aabb::from_points(used.iter().map(|i| points[*i as usize])).center().round();
        let corners: Vec<DVec3> = used.iter().map(|i| points[*i as usize] - center).collect();
        let new_index = |i: u32| used.binary_search(&i).unwrap_or(0) as u32;
        let relative: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(new_index)).collect();
        let planes = planes_of(points, triangles)
            .into_iter()
            .map(|face| {
                let [a, b, c] = relative[face].map(|i| corners[i as usize]);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                // All corners are inside whatever the normal's rounding.
                (normal, corners.iter().map(|p| normal.dot(*p)).fold(f64::NEG_INFINITY, f64::max))
            })
            .filter(|(normal, _)| *normal != DVec3::ZERO)
            .collect();
        Self { center, corners, triangles: relative, planes }
    }

    /// The face planes as `(unit normal outwards, offset)`: inside where `normal · (p − center) ≤ offset`.
    pub fn planes(&self) -> (DVec3, &[(DVec3, f64)]) {
        (self.center, &self.planes)
    }

    /// Corners in world metres, and triangles counter-clockwise from outside.
    pub fn faces(&self) -> (Vec<DVec3>, &[[u32; 3]]) {
        (self.corners.iter().map(|p| *p + self.center).collect(), &self.triangles)
    }

    /// Triangles counter-clockwise from outside, their corners relative to the centre of [`Self::planes`].
    pub fn triangles(&self) -> Vec<[DVec3; 3]> {
        self.triangles.iter().map(|t| t.map(|i| self.corners[i as usize])).collect()
    }

    /// Where a ray is in it; entry > exit where it misses.
    pub(super) fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        let origin = ray.origin - self.center;
        let (mut entry, mut exit) = crate::geom::shape::span::EVERYWHERE;
        for (normal, offset) in &self.planes {
            let (speed, gap) = (normal.dot(ray.direction), offset - normal.dot(origin));
            if speed == 0.0 {
                if gap < 0.0 {
                    return None;
                }
            } else if speed > 0.0 {
                exit = exit.min(gap / speed);
            } else {
                entry = entry.max(gap / speed);
            }
        }
        Some((entry, exit))
    }

    /// Distance to the border, negative inside. Inside, the nearest border point is the foot on the nearest plane; outside, it lies on some triangle.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        let q = p - self.center;
        let depth = self.planes.iter().map(|(n, k)| n.dot(q) - k).fold(f64::NEG_INFINITY, f64::max);
        if depth <= 0.0 {
            return depth;
        }
        let corner = |i: u32| self.corners[i as usize];
        let nearest = |t: &[u32; 3]| distance_to_triangle(q, t.map(corner));
        self.triangles.iter().map(nearest).fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE)
    }
}

/// Four points that span a volume, as the faces of their tetrahedron.
fn first_tetrahedron(points: &[DVec3]) -> Result<[[u32; 3]; 4], ShapeError> {
    let flat = ShapeError::Flat(points.len());
    let a = 0;
    let farthest = |measure: &dyn Fn(DVec3) -> f64| {
        (0..points.len()).max_by(|i, j| measure(points[*i]).total_cmp(&measure(points[*j]))).unwrap_or(0)
    };
    let b = farthest(&|p| p.distance_squared(points[a]));
    let along = (points[b] - points[a]).normalize_or_zero();
    let c = farthest(&|p| (p - points[a]).cross(along).length_squared());
    let normal = along.cross(points[c] - points[a]);
    let Some(normal) = normal.try_normalize() else { return Err(flat) };
    let d = farthest(&|p| (p - points[a]).dot(normal).abs());
    if (points[d] - points[a]).dot(normal).abs() < THIN_M {
        return Err(flat);
    }
    let [a, b, c, d] = [a, b, c, d].map(|i| i as u32);
    let side = outside(points, [a, b, c], d);
    if side == 0.0 {
        return Err(flat);
    }
    let (b, c) = if side > 0.0 { (c, b) } else { (b, c) };
    Ok([[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
}

/// Adds every point in order.
fn grown(points: &[DVec3], first: [[u32; 3]; 4]) -> Vec<[u32; 3]> {
    let mut faces = first.to_vec();
    for p in 0..points.len() as u32 {
        let sees: Vec<bool> = faces.iter().map(|f| !f.contains(&p) && outside(points, *f, p) > 0.0).collect();
        if !sees.contains(&true) {
            continue;
        }
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for (face, seen) in faces.iter().zip(&sees) {
            if *seen {
                edges.extend([[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]]);
            }
        }
        let all: rustc_hash::FxHashSet<[u32; 2]> = edges.iter().copied().collect();
        let mut kept = sees.iter();
        faces.retain(|_| !kept.next().copied().unwrap_or(false));
        // An edge whose twin was not seen is on the horizon.
        faces.extend(edges.into_iter().filter(|[a, b]| !all.contains(&[*b, *a])).map(|[a, b]| [a, b, p]));
    }
    faces
}

/// One triangle per plane: of exactly coplanar neighbours the largest speaks for all.
fn planes_of(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<usize> {
    let mut by_edge: FxHashMap<[u32; 2], usize> = FxHashMap::default();
    for (i, [a, b, c]) in triangles.iter().enumerate() {
        by_edge.extend([([*a, *b], i), ([*b, *c], i), ([*c, *a], i)]);
    }
    let area = |i: usize| {
        let [a, b, c] = triangles[i].map(|k| points[k as usize]);
        (b - a).cross(c - a).length()
    };
    let mut done = vec![false; triangles.len()];
    let mut speakers = Vec::new();
    for start in 0..triangles.len() {
        if done[start] {
            continue;
        }
        done[start] = true;
        let (mut stack, mut largest) = (vec![start], start);
        while let Some(at) = stack.pop() {
            let [a, b, c] = triangles[at];
            for edge in [[b, a], [c, b], [a, c]] {
                let Some(&next) = by_edge.get(&edge) else { continue };
                if !done[next] && triangles[next].iter().all(|p| outside(points, triangles[at], *p) == 0.0) {
                    done[next] = true;
                    stack.push(next);
                    if area(next) > area(largest) {
                        largest = next;
                    }
                }
            }
        }
        speakers.push(largest);
    }
    speakers
}

/// Distance from `p` to a triangle (C. Ericson, *Real-Time Collision Detection*, 5.1.5).
fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_segment = |a: DVec3, b: DVec3| {
        let ab = b - a;
        let t = ((p - a).dot(ab) / ab.length_squared()).clamp(0.0, 1.0);
        p.distance(a + t * ab)
    };
    let edges = to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a));
    let Some(n) = (b - a).cross(c - a).try_normalize() else { return edges };
    let over = [(a, b), (b, c), (c, a)].iter().all(|(s, e)| (*e - *s).cross(p - *s).dot(n) >= 0.0);
    if over { (p - a).dot(n).abs() } else { edges }
}
