//! The triangles of the plain ground: below the city no more than its heights need, around it rings that grow.
//!
//! Below: right-angled triangles, each halved until it is as near to the heights as wanted (Evans, Kirkpatrick and Townsend 2001,
//! "Right-triangulated irregular networks"). Around: a triangulation between the border of these and rings.

use glam::{DVec2, DVec3};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::city::ground::{BELOW_M, field::HeightField};

/// How far triangles may be from the heights, metres: less than the ground lies below what stands on it.
const NEAR_M: f64 = 0.75 * BELOW_M;
/// Ground that is so level all around, as a share of how far it goes on, takes one ring.
const LEVEL: f64 = 1e-3;
/// How much farther each ring is than the one before, ...
const FARTHER: f64 = 2.0;
/// ... and how many points it has.
const RING_POINTS: usize = 16;

/// Below the rim of terrain less is not seen, metres.
const LEAST_GAP_M: f64 = 0.15;

/// Triangles, counter-clockwise from above.
pub struct Net {
    /// All corners, metres.
    pub points: Vec<DVec3>,
    /// Those of the field.
    pub below: Vec<[u32; 3]>,
    /// Those around it.
    pub around: Vec<[u32; 3]>,
}

/// A place of the grid: column, row.
type Place = [usize; 2];

fn halfway(a: Place, b: Place) -> Place {
    [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]
}

impl Net {
    /// That of a field, and of rings up to so many metres from its border.
    pub fn of(field: &HeightField, reach: f64) -> Self {
        let errors = errors(field);
        let last = field.cells;
        let mut numbers = vec![u32::MAX; field.heights.len()];
        let mut net = Self { points: Vec::new(), below: Vec::new(), around: Vec::new() };
        // Corners of the two halves of the square, the right angle last.
        let mut left = vec![[[0, 0], [last, last], [last, 0]], [[last, last], [0, 0], [0, last]]];
        while let Some([a, b, c]) = left.pop() {
            let middle = halfway(a, b);
            let is_whole = a[0].abs_diff(c[0]) + a[1].abs_diff(c[1]) > 1;
            if is_whole && errors[field.index(middle[0], middle[1])] > NEAR_M {
                left.extend([[c, a, middle], [b, c, middle]]);
                continue;
            }
            let corners = [a, c, b].map(|place| {
                let i = field.index(place[0], place[1]);
                if numbers[i] == u32::MAX {
                    numbers[i] = net.points.len() as u32;
                    net.points.push(field.place(place[0], place[1]).extend(field.heights[i]));
                }
                numbers[i]
            });
            net.below.push(counter_clockwise(&net.points, corners));
        }
        let border: Vec<u32> =
            border(last).map(|[x, y]| numbers[field.index(x, y)]).filter(|&i| i != u32::MAX).collect();
        net.surround(field, &border, reach);
        net
    }

    /// Hangs a strip from the rim of terrain down into the ground, so that nothing is seen below it.
    pub fn hang(&mut self, rim: &[DVec3; 2], field: &HeightField) {
        let gap = |p: &DVec3| p.z - field.least_around(p.truncate());
        if rim.iter().all(|p| gap(p) < LEAST_GAP_M) {
            return;
        }
        let first = self.points.len() as u32;
        let foot = |p: DVec3| p.truncate().extend(field.least_around(p.truncate()).min(p.z) - BELOW_M);
        self.points.extend([rim[0], rim[1], foot(rim[1]), foot(rim[0])]);
        self.below.extend([[first, first + 2, first + 1], [first, first + 3, first + 2]]);
    }

    /// Adds rings around the border, which is counter-clockwise. Heights are those of the nearest place of the border, and far from it their
    /// mean.
    fn surround(&mut self, field: &HeightField, border: &[u32], reach: f64) {
        let half = 0.5 * field.cells as f64 * field.step;
        let heights = || border.iter().map(|&i| self.points[i as usize].z);
        let mean = heights().sum::<f64>() / border.len() as f64;
        let is_level = heights().all(|height| (height - mean).abs() < LEVEL * reach);
        let mut numbers = border.to_vec();
        let mut away = if is_level { reach } else { (reach / 16.0).max(4.0 * field.step).min(reach) };
        loop {
            for k in 0..RING_POINTS {
                let (offset, share) = (ring_point(k, half, away), (away / reach).powi(2));
                let inner = offset.clamp(DVec2::splat(-half), DVec2::splat(half));
                let at = (inner / field.step + 0.5 * field.cells as f64).round();
                let height = field.heights[field.index(at.x as usize, at.y as usize)];
                numbers.push(self.points.len() as u32);
                self.points.push((field.middle + offset).extend(height + share * (mean - height)));
            }
            if away >= reach {
                break;
            }
            away = if FARTHER * FARTHER.sqrt() * away > reach { reach } else { FARTHER * away };
        }
        // Relative to the middle: no digits are lost in far-off coordinates.
        let at = |i: u32| {
            let p = self.points[i as usize].truncate() - field.middle;
            Point2::new(p.x, p.y)
        };
        let mut net = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        let handles: Vec<_> = numbers.iter().map_while(|&i| net.insert(at(i)).ok()).collect();
        if handles.len() < numbers.len() || net.num_vertices() < numbers.len() {
            return;
        }
        for k in 0..border.len() {
            net.add_constraint(handles[k], handles[(k + 1) % border.len()]);
        }
        let is_outside = |corners: &[u32; 3]| {
            let sum: DVec2 = corners.iter().map(|&i| self.points[i as usize].truncate() - field.middle).sum();
            (sum / 3.0).abs().max_element() > half
        };
        let faces = net.inner_faces().map(|face| face.vertices().map(|vertex| numbers[vertex.index()]));
        self.around = faces.filter(is_outside).collect();
    }
}

/// A point of the ring `away` metres from a square of so much half a side: on a square with round corners.
fn ring_point(k: usize, half: f64, away: f64) -> DVec2 {
    let direction = DVec2::from_angle(k as f64 / RING_POINTS as f64 * std::f64::consts::TAU);
    // As far along the direction as the distance from the square says: it grows with the way, so halving finds it.
    let (mut low, mut high) = (0.0, 2.0 * (half + away));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let beyond = ((middle * direction).abs() - half).max(DVec2::ZERO).length();
        if beyond < away { low = middle } else { high = middle }
    }
    // Edges between them are as far as that.
    high / (std::f64::consts::PI / RING_POINTS as f64).cos() * direction
}

fn counter_clockwise(points: &[DVec3], [a, b, c]: [u32; 3]) -> [u32; 3] {
    let [p, q, r] = [a, b, c].map(|i| points[i as usize].truncate());
    if (q - p).perp_dot(r - p) < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// The grid's border, counter-clockwise.
fn border(last: usize) -> impl Iterator<Item = Place> {
    let south = (0..last).map(|k| [k, 0]);
    let east = (0..last).map(move |k| [last, k]);
    let north = (0..last).map(move |k| [last - k, last]);
    let west = (0..last).map(move |k| [0, last - k]);
    south.chain(east).chain(north).chain(west)
}

/// For each grid point how far the two triangles that it halves may be from the heights, metres: what it is beside the middle of their long
/// side, and at most as much more as their halves have.
fn errors(field: &HeightField) -> Vec<f64> {
    let size = field.cells;
    let mut errors = vec![0.0_f64; field.heights.len()];
    let (count, parents) = (2 * size * size - 2, size * size - 2);
    for i in (0..count).rev() {
        let [a, b, c] = triangle(i, size);
        let middle = halfway(a, b);
        let at = |place: Place| field.heights[field.index(place[0], place[1])];
        let mut error = (0.5 * (at(a) + at(b)) - at(middle)).abs();
        if i < parents {
            let below = [halfway(a, c), halfway(b, c)].map(|p| errors[field.index(p[0], p[1])]);
            error += below[0].max(below[1]);
        }
        let of_middle = &mut errors[field.index(middle[0], middle[1])];
        *of_middle = of_middle.max(error);
    }
    errors
}

/// A triangle of the hierarchy, largest first: the two halves of the square are 0 and 1, the halves of number i are 2i + 2 and 2i + 3.
fn triangle(i: usize, size: usize) -> [Place; 3] {
    let path = i + 2;
    let mut corners =
        if path_bit(path) { [[0, 0], [size, size], [size, 0]] } else { [[size, size], [0, 0], [0, size]] };
    let depth = path.ilog2();
    for level in (0..depth.saturating_sub(1)).rev() {
        let [a, b, c] = corners;
        let middle = halfway(a, b);
        corners = if path >> level & 1 == 1 { [c, a, middle] } else { [b, c, middle] };
    }
    corners
}

/// Which half of the square a path begins with.
fn path_bit(path: usize) -> bool {
    path >> (path.ilog2() - 1) & 1 == 1
}
