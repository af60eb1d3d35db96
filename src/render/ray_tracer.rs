//! Rays that lenses bend, followed through the city on the processor: the twin of `lib/ray-walk.wgsl` for adapters that are programs themselves, which
//! this is quicker than.
//!
//! Four rays of pixels that lie together go through a hierarchy at once, one in each lane. Paths are told in f64, lines in a city's own space in f32 as
//! in the shader: what decides whether a triangle is met is exact in both.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::{BVec4A, DMat3, DVec2, DVec3, IVec3, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use crate::{
    lens::{
        ray::RayMethod,
        ray_path::{RayPaths, Rim},
        ray_walk::{PathPiece, RayWalk, ViewLine},
    },
    render::{
        eye::PictureTile,
        layout,
        ray_meshes::{IN_PLANE, LAYER_MASK, LAYER_SHIFT, NO_BOXES, Word},
    },
};

/// As `lib/view.wgsl` has it.
const FAR_AWAY: f32 = 1e30;
/// In place of 0 of a direction: what it divides stays a number.
const LEAST: f32 = 8.271_806e-25;
/// Boxes end later by this part of the parameter: what rounding of both ends may come to.
const BOX_SLACK: f32 = 4e-6;
/// Differences of products above this part of them have the sign that f32 gives them.
const SURE: f32 = 4e-7;
/// Two units of 2⁻²²: what lines overlap by where a ray turns, of the parameter.
const OVERLAP: f32 = 4.768_371_6e-7;
/// Rays go at least so much of their way along the axis along which they are sheared.
const LEAST_ALONG: f32 = 0.25;
/// Rays that are followed together.
const LANES: usize = 4;

/// A city that rays are followed through: as the shader reads it, and the words of its mesh, of which that one knows at which number they begin.
#[derive(Clone, Copy, Debug)]
pub struct TracedCity<'a> {
    /// As the shader reads it.
    pub own: layout::RayCity,
    /// The words of its mesh.
    pub words: &'a [Word],
    /// Where these begin among all.
    pub first: u32,
    /// Which of the cities it is.
    pub number: u32,
}

/// Where pixels of a tile lie in the picture's plane.
#[derive(Clone, Copy, Debug)]
pub struct TracedView {
    /// From pixels of the tile to places: as `layout::View` has it.
    pub across_from_pixel: [f32; 4],
    /// D of the nearest that is seen, metres.
    pub near: f32,
}

impl TracedView {
    fn across(&self, pixel: DVec2) -> DVec2 {
        let [x, y, at_x, at_y] = self.across_from_pixel.map(f64::from);
        pixel * DVec2::new(x, y) + DVec2::new(at_x, at_y)
    }

    /// How wide a pixel is.
    fn pixel(&self) -> f64 {
        f64::from(self.across_from_pixel[0].abs().max(self.across_from_pixel[1].abs()))
    }
}

/// What the ray of a pixel meets, as `lib/ray-walk.wgsl` reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TracedHit {
    /// The line's parameter.
    pub t: f32,
    /// Where the triangle's words begin, from 1; 0: nothing is met.
    pub triangle: u32,
    /// Which city it is of.
    pub city: u32,
    /// The weights of its second and third corner.
    pub weights: [f32; 2],
}

/// What the processor followed for a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TracedFigures {
    /// Rays of pixels, of all samples.
    pub rays: u64,
    /// How long that took, milliseconds.
    pub ms: f64,
}

impl TracedFigures {
    /// Adds what a frame took.
    pub fn add(&mut self, frame: Self) {
        self.rays += frame.rays;
        self.ms += frame.ms;
    }
}

/// What the rays of pixels meet that lie in lenses whose rays are followed, row by row of a part of the tile, of others nothing; and how many rays these are. Of each the
/// `most` that it meets first, the nearest first, 1 to [`MOST_HITS`].
pub fn trace(
    paths: &RayPaths,
    view: &TracedView,
    cities: &[TracedCity],
    part: PictureTile,
    most: usize,
) -> (Vec<TracedHit>, u64) {
    let [width, height] = part.size.map(|n| n as usize);
    let mut hits = vec![TracedHit::default(); most * width * height];
    let followed = AtomicU64::new(0);
    let rims: Vec<&Rim> = paths.rims().filter(|rim| rim.method == RayMethod::Rays).collect();
    let is_bent = |across: DVec2| rims.iter().any(|rim| is_within(rim, across, view.pixel()));
    let corner = DVec2::new(part.origin[0].into(), part.origin[1].into()) + 0.5;
    let tracer = Tracer { near: view.near, cities };
    let rows = hits.par_chunks_mut((2 * most * width).max(1)).enumerate();
    rows.for_each_init(
        || (RayWalk::new(paths), <[Vec<PathPiece>; LANES]>::default()),
        |(walk, pieces), (pair, hits)| {
            for x in (0..width).step_by(2) {
                let places = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
                    let across = view.across(corner + DVec2::new((x + dx) as f64, (2 * pair + dy) as f64));
                    (x + dx < width && 2 * pair + dy < height && is_bent(across)).then_some(across)
                });
                let rays = places.iter().flatten().count();
                if rays == 0 {
                    continue;
                }
                followed.fetch_add(rays as u64, Relaxed);
                for (own, place) in pieces.iter_mut().zip(places) {
                    own.clear();
                    place.into_iter().for_each(|place| own.extend_from_slice(walk.pieces(place)));
                }
                let found = tracer.follow(pieces, most);
                for (lane, _) in places.iter().enumerate().filter(|(_, place)| place.is_some()) {
                    let pixel = lane / 2 * width + x + lane % 2;
                    hits[most * pixel..most * (pixel + 1)].copy_from_slice(found.of_lane(lane));
                }
            }
        },
    );
    (hits, followed.into_inner())
}

/// Whether a place may lie within a rim as f32 has it: up to a pixel beside.
fn is_within(rim: &Rim, across: DVec2, pixel: f64) -> bool {
    let rounded = 1.0 + pixel / rim.radius;
    match &rim.field {
        // A field's share tells nothing about how far its border is.
        Some(_) => ((across - rim.center) / rim.radius).abs().max_element() < rounded,
        None => rim.share(across) < rounded,
    }
}

/// Follows rays.
struct Tracer<'a> {
    near: f32,
    cities: &'a [TracedCity<'a>],
}

/// Hits of a ray that are told, at most.
pub const MOST_HITS: usize = 4;

/// The nearest that four rays met so far, so many of each.
struct Found {
    most: usize,
    hits: [[TracedHit; MOST_HITS]; LANES],
    /// Which layer of its plane each is of.
    layers: [[u32; MOST_HITS]; LANES],
    counts: [usize; LANES],
    /// How far more are looked for.
    reach: Vec4,
}

impl Found {
    fn nothing(most: usize) -> Self {
        Self {
            most: most.min(MOST_HITS),
            hits: [[TracedHit::default(); MOST_HITS]; LANES],
            layers: [[0; MOST_HITS]; LANES],
            counts: [0; LANES],
            reach: Vec4::splat(FAR_AWAY),
        }
    }

    /// Takes a hit of a ray, if it is one of the nearest; of two that are as far that comes first which lies over the other.
    fn take(&mut self, lane: usize, hit: TracedHit, layer: u32) {
        let (hits, layers) = (&mut self.hits[lane], &mut self.layers[lane]);
        let count = self.counts[lane];
        let is_after = |i: &usize| {
            let first = &hits[*i];
            let lies_over = (layer, first.triangle) > (layers[*i], hit.triangle);
            hit.t > first.t || (hit.t == first.t && !lies_over)
        };
        let place = (0..count).take_while(is_after).count();
        if place == self.most {
            return;
        }
        let count = (count + 1).min(self.most);
        hits[place..count].rotate_right(1);
        layers[place..count].rotate_right(1);
        (hits[place], layers[place]) = (hit, layer);
        self.counts[lane] = count;
        if count == self.most {
            self.reach[lane] = hits[count - 1].t;
        }
    }

    /// What a ray met, the nearest first; those behind the last are of no triangle.
    fn of_lane(&self, lane: usize) -> &[TracedHit] {
        &self.hits[lane][..self.most]
    }
}

/// Straight pieces of four rays, and where they begin, end, and came from.
struct Stretch {
    lines: [ViewLine; LANES],
    from: f32,
    to: Vec4,
    /// What the pieces before lie on, and how far they reach into these.
    before: Option<[ViewLine; LANES]>,
    overlap: f32,
}

impl Tracer<'_> {
    /// The `most` that four rays meet first, of each the pieces of its path.
    fn follow(&self, paths: &[Vec<PathPiece>; LANES], most: usize) -> Found {
        let mut found = Found::nothing(most);
        let mut before = None;
        let (mut from, mut overlap) = (self.near, 0.0);
        let count = paths.iter().map(Vec::len).max().unwrap_or(0);
        for i in 0..count {
            // All rays turn at the same distances, but for those that never do.
            let ends =
                |path: &Vec<PathPiece>| path.get(i).map_or(-1.0, |piece| piece.range[1].min(FAR_AWAY.into()) as f32);
            let to = Vec4::from_array(paths.each_ref().map(ends));
            let line = |path: &Vec<PathPiece>| path.get(i).map_or(STILL, |piece| piece.line);
            let lines = paths.each_ref().map(line);
            let lanes = (to.cmpgt(Vec4::splat(from)) & found.reach.cmpgt(Vec4::splat(from))).bitmask();
            if lanes != 0 {
                let stretch = Stretch { lines, from, to, before, overlap };
                for city in self.cities {
                    self.follow_in_city(city, &stretch, lanes, &mut found);
                }
            }
            let turn = Vec4::select(to.cmplt(Vec4::splat(FAR_AWAY)), to, Vec4::splat(-1.0)).max_element();
            if turn > from {
                (from, before, overlap) = (turn, Some(lines), OVERLAP * turn);
            }
        }
        found
    }

    /// The same of some lanes in one city.
    fn follow_in_city(&self, city: &TracedCity, stretch: &Stretch, lanes: u32, found: &mut Found) {
        if city.own.boxes == NO_BOXES {
            return;
        }
        match Lines::new(&city.own, &stretch.lines, lanes) {
            Some(lines) => first_in_city(city, &lines, stretch, lanes, found),
            // They go too far apart to be followed together. One alone that has no axis goes nowhere: it is no number.
            None if lanes.count_ones() > 1 => (0..LANES as u32)
                .map(|lane| 1 << lane & lanes)
                .filter(|lane| *lane != 0)
                .for_each(|lane| self.follow_in_city(city, stretch, lane, found)),
            None => {}
        }
    }
}

/// In a lane that follows nothing.
const STILL: ViewLine = ViewLine { origin: DVec3::ZERO, direction: DVec3::NEG_Z };

/// Four lines in the space of a city: metres from the eye, and boxes.
struct Lines {
    origin: [Vec4; 3],
    direction: [Vec4; 3],
    /// The origin where boxes are counted.
    boxed: [Vec4; 3],
    /// Of the direction, finite.
    inverse: [Vec4; 3],
    /// Whether all go down an axis, and whether some do and some do not.
    is_down: [bool; 3],
    is_mixed: bool,
    /// The last is that along which they go.
    axes: [usize; 3],
    shear: [Vec4; 2],
    eye: IVec3,
    eye_fraction: Vec3,
    step: f32,
}

impl Lines {
    /// Those of some lanes; `None`: no axis suits all of them.
    fn new(city: &layout::RayCity, lines: &[ViewLine; LANES], lanes: u32) -> Option<Self> {
        let column = |c: [f32; 4]| Vec4::from(c).xyz().as_dvec3();
        let turn = DMat3::from_cols(column(city.from_view_x), column(city.from_view_y), column(city.from_view_z));
        let origins = lines.map(|line| (turn * line.origin).as_vec3());
        let directions = lines.map(|line| (turn * line.direction).as_vec3());
        let some = directions[(lanes.trailing_zeros() as usize).min(LANES - 1)].abs();
        let along = if some.x >= some.y && some.x >= some.z { 0 } else { 1 + usize::from(some.y < some.z) };
        let suits = |lane: usize| directions[lane][along].abs() >= LEAST_ALONG * directions[lane].abs().max_element();
        if !(0..LANES).all(|lane| lanes >> lane & 1 == 0 || suits(lane)) {
            return None;
        }
        let by_axis = |all: &[Vec3; LANES]| [0, 1, 2].map(|axis| Vec4::from_array(all.map(|v| v[axis])));
        let (origin, direction) = (by_axis(&origins), by_axis(&directions));
        let eye_in_boxes = city.eye_in_boxes;
        let divisor = |d: Vec4| {
            let least = Vec4::select(d.cmplt(Vec4::ZERO), Vec4::splat(-LEAST), Vec4::splat(LEAST));
            Vec4::select(d.abs().cmplt(Vec4::splat(LEAST)), least, d)
        };
        let axes = [(along + 1) % 3, (along + 2) % 3, along];
        let goes_down = direction.map(|d| d.cmplt(Vec4::ZERO).bitmask() & lanes);
        Some(Self {
            boxed: [0, 1, 2].map(|k| Vec4::splat(eye_in_boxes[k]) + origin[k]),
            inverse: direction.map(|d| divisor(d).recip()),
            is_down: goes_down.map(|down| down == lanes),
            is_mixed: goes_down.iter().any(|down| *down != 0 && *down != lanes),
            shear: [0, 1].map(|k| direction[axes[k]] / direction[along]),
            origin,
            direction,
            axes,
            eye: IVec3::from(city.eye),
            eye_fraction: Vec3::from(city.eye_fraction),
            step: city.from_view_x[3],
        })
    }

    /// From where to where they are in a box, of their parameters, or a little longer; what ends below 0 says no more than that.
    #[inline]
    fn spans(&self, low: &Word, high: &Word) -> [Vec4; 2] {
        let at = |bits: u32, k: usize| (Vec4::splat(f32::from_bits(bits)) - self.boxed[k]) * self.inverse[k];
        if self.is_mixed {
            let [a, b] = [at(low[0], 0), at(high[0], 0)];
            let [c, d] = [at(low[1], 1), at(high[1], 1)];
            let [e, f] = [at(low[2], 2), at(high[2], 2)];
            let enter = a.min(b).max(c.min(d)).max(e.min(f));
            return [enter, (1.0 + BOX_SLACK) * a.max(b).min(c.max(d)).min(e.max(f))];
        }
        let ends = |k: usize| if self.is_down[k] { [high[k], low[k]] } else { [low[k], high[k]] };
        let [[a, b], [c, d], [e, f]] = [ends(0), ends(1), ends(2)];
        let enter = at(a, 0).max(at(c, 1)).max(at(e, 2));
        [enter, (1.0 + BOX_SLACK) * at(b, 0).min(at(d, 1)).min(at(f, 2))]
    }

    /// A place of the grid, metres from the eye.
    #[inline]
    fn beside_eye(&self, word: &Word) -> Vec3 {
        let steps = IVec3::new(word[0] as i32, word[1] as i32, word[2] as i32) - self.eye;
        (steps.as_vec3() - self.eye_fraction) * self.step
    }

    /// A corner relative to where the lines begin, sheared along them.
    #[inline]
    fn sheared(&self, word: &Word) -> [Vec4; 3] {
        let place = self.beside_eye(word).to_array();
        let [i, j, k] = self.axes;
        let along = Vec4::splat(place[k]) - self.origin[k];
        let [x, y] = [Vec4::splat(place[i]) - self.origin[i], Vec4::splat(place[j]) - self.origin[j]];
        [x - self.shear[0] * along, y - self.shear[1] * along, along]
    }

    /// Where some of them meet a triangle.
    #[inline]
    fn met(&self, words: &[Word], triangle: usize, lanes: u32) -> Option<Met> {
        let corners = &words[triangle..triangle + 3];
        let [a, b, c] = [self.sheared(&corners[0]), self.sheared(&corners[1]), self.sheared(&corners[2])];
        let u = difference_of_products([b[0], c[1]], [b[1], c[0]], lanes);
        let v = difference_of_products([c[0], a[1]], [c[1], a[0]], lanes);
        let w = difference_of_products([a[0], b[1]], [a[1], b[0]], lanes);
        let sum = u + v + w;
        let is_out = u.min(v).min(w).cmplt(Vec4::ZERO) & u.max(v).max(w).cmpgt(Vec4::ZERO);
        let lanes = lanes & !(is_out | sum.cmpeq(Vec4::ZERO)).bitmask();
        if lanes == 0 {
            return None;
        }
        let depth = (u * a[2] + v * b[2] + w * c[2]) / sum;
        let mut t = depth / self.direction[self.axes[2]];
        let kind = corners[1][3];
        if kind & IN_PLANE != 0 {
            let rest = corners[2][3] as usize;
            t = self.to_plane(&words[rest..rest + 2], t);
        }
        Some(Met { lanes, t, weights: [v / sum, w / sum], layer: kind >> LAYER_SHIFT & LAYER_MASK })
    }

    /// Faces of one plane are equally far, to the bit; `t`: where a line goes along the plane.
    fn to_plane(&self, rest: &[Word], t: Vec4) -> Vec4 {
        let place = self.beside_eye(&rest[1]);
        let normal = [0, 1, 2].map(|k| f32::from_bits(rest[0][k]));
        let dot = |v: [Vec4; 3]| normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2];
        let slope = dot(self.direction);
        let relative = [0, 1, 2].map(|k| Vec4::splat(place[k]) - self.origin[k]);
        let found = (dot(relative) + f32::from_bits(rest[0][3])) / slope;
        let [x, y, z] = self.direction;
        let length = Vec4::from_array((x * x + y * y + z * z).to_array().map(f32::sqrt));
        Vec4::select(slope.abs().cmpgt(1e-6 * length), found, t)
    }
}

/// Where lines meet a triangle.
struct Met {
    /// Which do.
    lanes: u32,
    t: Vec4,
    /// Of its second and third corner.
    weights: [Vec4; 2],
    /// Which layer of its plane it is.
    layer: u32,
}

/// Numbers of the sign of `p[0]·p[1] − q[0]·q[1]`, and where f32 can tell them these: products of two f32 are exact in f64.
#[inline]
fn difference_of_products(p: [Vec4; 2], q: [Vec4; 2], lanes: u32) -> Vec4 {
    let (first, second) = (p[0] * p[1], q[0] * q[1]);
    let mut difference = first - second;
    let is_sure = difference.abs().cmpgt(SURE * (first.abs() + second.abs()));
    let mut rest = lanes & !is_sure.bitmask();
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize;
        let product = |of: [Vec4; 2]| f64::from(of[0][lane]) * f64::from(of[1][lane]);
        let (exact_p, exact_q) = (product(p), product(q));
        let sign = f32::from(i8::from(exact_p > exact_q) - i8::from(exact_p < exact_q));
        // So small that it says nothing but its sign.
        difference[lane] = sign * difference[lane].abs().max(1e-38);
        rest &= rest - 1;
    }
    difference
}

/// The first that the lines of some lanes meet of a city, nearer than what they found.
fn first_in_city(city: &TracedCity, lines: &Lines, stretch: &Stretch, lanes: u32, found: &mut Found) {
    let TracedCity { own, words, first, number } = city;
    let triangles = (own.triangles - first) as usize;
    let active = BVec4A::new(lanes & 1 != 0, lanes & 2 != 0, lanes & 4 != 0, lanes & 8 != 0);
    let begin = stretch.from - stretch.overlap;
    let from = Vec4::select(active, Vec4::splat(begin), Vec4::splat(f32::INFINITY));
    let to = stretch.to;
    let mut stack = [(0_u32, 0.0_f32); 64];
    let mut height = 1;
    stack[0] = (own.boxes - first, f32::NEG_INFINITY);
    let mut until = to.min(found.reach);
    let mut reach = (1.0 + BOX_SLACK) * until;
    let mut farthest = farthest_of(reach, lanes);
    while height > 0 {
        height -= 1;
        let (mut at, nearest) = stack[height];
        if nearest > farthest {
            continue;
        }
        let [mut low, mut high] = [words[at as usize], words[at as usize + 1]];
        let mut is_missed = false;
        while high[3] == 0 && !is_missed {
            at = 2 * low[3];
            let boxes = &words[at as usize..at as usize + 4];
            let [a, b] = [[boxes[0], boxes[1]], [boxes[2], boxes[3]]];
            let [from_a, to_a] = lines.spans(&a[0], &a[1]);
            let [from_b, to_b] = lines.spans(&b[0], &b[1]);
            let (from_a, from_b) = (from_a.max(from), from_b.max(from));
            let (in_a, in_b) = (from_a.cmple(to_a.min(reach)), from_b.cmple(to_b.min(reach)));
            is_missed = !in_a.any() && !in_b.any();
            let mut is_first = in_a.any();
            if in_a.any() && in_b.any() {
                // The nearer one is looked at first.
                let [near_a, near_b] = [(in_a, from_a), (in_b, from_b)]
                    .map(|(is_met, from)| Vec4::select(is_met, from, Vec4::INFINITY).min_element());
                is_first = near_a <= near_b;
                stack[height] = if is_first { (at + 2, near_b) } else { (at, near_a) };
                height += 1;
            }
            [low, high] = if is_first { a } else { b };
        }
        if is_missed {
            continue;
        }
        for i in 0..high[3] {
            let triangle = triangles + 3 * (low[3] + i) as usize;
            let Some(met) = lines.met(words, triangle, lanes) else { continue };
            let in_range = met.t.cmpge(Vec4::splat(begin)) & met.t.cmple(until);
            let mut rest = met.lanes & in_range.bitmask();
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let t = met.t[lane];
                if t < FAR_AWAY && !is_met_before(city, stretch, triangle, lane, t) {
                    let weights = met.weights.map(|w| w[lane]);
                    let hit = TracedHit { t, triangle: first + triangle as u32 + 1, city: *number, weights };
                    found.take(lane, hit, met.layer);
                }
            }
            until = to.min(found.reach);
            reach = (1.0 + BOX_SLACK) * until;
            farthest = farthest_of(reach, lanes);
        }
    }
}

/// Whether what is met about where a ray turned was met on the line before already.
fn is_met_before(city: &TracedCity, stretch: &Stretch, triangle: usize, lane: usize, t: f32) -> bool {
    let Some(before) = stretch.before.as_ref().filter(|_| (t - stretch.from).abs() <= stretch.overlap) else {
        return false;
    };
    let lines = Lines::new(&city.own, before, 1 << lane);
    let met = lines.and_then(|lines| lines.met(city.words, triangle, 1 << lane));
    met.is_some_and(|met| met.t[lane] <= stretch.from)
}

/// The greatest of some lanes.
fn farthest_of(t: Vec4, lanes: u32) -> f32 {
    (0..LANES).filter(|lane| lanes >> lane & 1 != 0).fold(f32::NEG_INFINITY, |most, lane| most.max(t[lane]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geom::{Aabb, bvh::Bvh};

    /// Squares along a side of the terrain, and their width, steps of the grid.
    const SIDE: usize = 12;
    const WIDE: i32 = 1 << 14;
    /// Metres of a step.
    const STEP: f64 = 1.0 / 1024.0;

    /// A terrain of two triangles a square, and its words: boxes, then corners.
    struct Terrain {
        triangles: Vec<[IVec3; 3]>,
        words: Vec<Word>,
        first_triangle: u32,
    }

    impl Terrain {
        fn new(heights: &[i32]) -> Self {
            let corner = |x: usize, y: usize| {
                IVec3::new(x as i32 * WIDE, y as i32 * WIDE, heights[(y * (SIDE + 1) + x) % heights.len()])
            };
            let square = |x: usize, y: usize| {
                let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
                if (x + y).is_multiple_of(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
            };
            let squares = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
            let triangles: Vec<[IVec3; 3]> = squares.flat_map(|(x, y)| square(x, y)).collect();
            let around = |t: &[IVec3; 3]| {
                let own = Aabb::from_points(t.iter().map(|c| c.as_dvec3() * STEP));
                Aabb { min: own.min - 1e-3, max: own.max + 1e-3 }
            };
            let boxes: Vec<Aabb> = triangles.iter().map(around).collect();
            let (nodes, items) = Bvh::build(&boxes).flat(60, &boxes);
            let mut words: Vec<Word> = Vec::new();
            for node in &nodes {
                let word = |c: [f32; 3], last: u32| [c[0].to_bits(), c[1].to_bits(), c[2].to_bits(), last];
                words.extend([word(node.min, node.first), word(node.max, node.count)]);
            }
            let first_triangle = words.len() as u32;
            for &item in &items {
                words.extend(triangles[item as usize].map(|c| [c.x as u32, c.y as u32, c.z as u32, 0]));
            }
            Self { triangles, words, first_triangle }
        }

        fn city(&self, eye: DVec3) -> TracedCity<'_> {
            let steps = eye / STEP;
            let own = layout::RayCity {
                from_view_x: [1.0, 0.0, 0.0, STEP as f32],
                from_view_y: [0.0, 1.0, 0.0, 0.0],
                from_view_z: [0.0, 0.0, 1.0, 0.0],
                eye: steps.round().as_ivec3().to_array(),
                eye_fraction: (steps - steps.round()).as_vec3().to_array(),
                eye_in_boxes: eye.as_vec3().to_array(),
                boxes: 0,
                triangles: self.first_triangle,
                ..bytemuck::Zeroable::zeroed()
            };
            TracedCity { own, words: &self.words, first: 0, number: 0 }
        }

        /// Where a line meets it first, in f64, all triangles asked; those that it passes by no more than `slack` of their size count as met.
        fn first(&self, eye: DVec3, direction: DVec3, slack: f64) -> f64 {
            let met = |t: &[IVec3; 3]| {
                let [a, b, c] = t.map(|c| c.as_dvec3() * STEP - eye);
                let volume = |p: DVec3, q: DVec3| p.cross(q).dot(direction);
                let [u, v, w] = [volume(b, c), volume(c, a), volume(a, b)];
                let sum = u + v + w;
                let is_met = [u, v, w].iter().all(|x| x / sum >= -slack);
                (is_met && sum != 0.0)
                    .then(|| (u * a + v * b + w * c).dot(direction) / sum / direction.length_squared())
            };
            self.triangles.iter().filter_map(met).filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min)
        }
    }

    fn path(direction: DVec3, turns: &[f64]) -> Vec<PathPiece> {
        let ends = turns.iter().copied().chain([f64::INFINITY]);
        let begins = std::iter::once(0.0).chain(turns.iter().copied());
        let line = ViewLine { origin: DVec3::ZERO, direction };
        begins.zip(ends).map(|(from, to)| PathPiece { range: [from, to], line }).collect()
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// The sign is that of the numbers, however near products are to each other, and the same the other way round.
        #[test]
        fn signs_of_differences_are_exact(a in 1_i64..1 << 24, b in 1_i64..1 << 24, by in -2_i64..3, aside in -2_i64..3, lane in 0..LANES) {
            // Whole numbers of 24 bits are f32, and beside each other: (a + by)(b + aside) is near ab.
            let [c, d] = [(a + by).clamp(1, 1 << 24), (b + aside).clamp(1, 1 << 24)];
            let lanes = |x: i64| Vec4::splat(x as f32);
            let sign = (a * b - c * d).signum() as f32;
            let [one, other] = [[[a, b], [c, d]], [[c, d], [a, b]]].map(|[p, q]| {
                difference_of_products(p.map(lanes), q.map(lanes), 1 << lane)[lane]
            });
            prop_assert_eq!([one, other].map(|x| if x == 0.0 { 0.0 } else { x.signum() }), [sign, -sign]);
        }

        /// Between triangles nothing leaks, through corners and along edges neither, wherever pieces end; and what is met is where f64 has it.
        #[test]
        fn no_ray_falls_through_a_terrain(
            // Flatter than all rays: none passes beside a ridge.
            heights in prop::collection::vec(-1000_i32..1000, (SIDE + 1) * (SIDE + 1)),
            eye in [20.0_f64..170.0, 20.0_f64..170.0, 60.0_f64..300.0],
            places in prop::collection::vec((1_i32..SIDE as i32, 1_i32..SIDE as i32, 0_u32..4, 0.0_f64..1.0), LANES),
            turned in 0.1_f64..1.5,
        ) {
            let terrain = Terrain::new(&heights);
            let eye = DVec3::from(eye);
            let targets: Vec<DVec3> = places.iter().map(|&(x, y, what, share)| {
                let corner = |x: i32, y: i32| {
                    let height = heights[(y as usize * (SIDE + 1) + x as usize) % heights.len()];
                    IVec3::new(x * WIDE, y * WIDE, height).as_dvec3() * STEP
                };
                match what {
                    0 => corner(x, y),
                    1 => corner(x, y).lerp(corner(x + 1, y), share),
                    2 => corner(x, y).lerp(corner(x, y - 1), share),
                    _ => corner(x, y).lerp(corner(x - 1, y - 1), share),
                }
            }).collect();
            let cities = [terrain.city(eye)];
            let tracer = Tracer { near: 0.5, cities: &cities };
            // Along the view axis by one metre, so that all turn together; at the first one's target, too.
            let directions: [DVec3; LANES] = std::array::from_fn(|lane| (targets[lane] - eye) / (eye.z - targets[lane].z));
            let first = eye.z - targets[0].z;
            for turns in [vec![], vec![turned * first], vec![first], vec![0.5 * first, first]] {
                let found = tracer.follow(&directions.map(|direction| path(direction, &turns)), 1);
                for (lane, direction) in directions.into_iter().enumerate() {
                    let hit = found.of_lane(lane)[0];
                    prop_assert!(hit.triangle > 0, "lane {lane} falls through: {direction} from {eye}, {turns:?}");
                    let [low, high] = [1e-3, -1e-3].map(|slack| terrain.first(eye, direction, slack));
                    let t = f64::from(hit.t);
                    prop_assert!(t >= low * (1.0 - 1e-5) && t <= high * (1.0 + 1e-5), "lane {lane}: {t}, not {low} to {high}");
                }
            }
            // What is no direction meets nothing, and leaves those beside it alone.
            let lost = [DVec3::NAN, directions[1], DVec3::splat(f64::INFINITY), directions[3]];
            let found = tracer.follow(&lost.map(|direction| path(direction, &[])), 1);
            for lane in 0..LANES {
                prop_assert_eq!(found.of_lane(lane)[0].triangle > 0, lane % 2 == 1, "lane {}", lane);
            }
            prop_assert_eq!(tracer.follow(&std::array::from_fn(|_| path(DVec3::Z, &[])), 1).of_lane(0)[0], TracedHit::default(), "above");
        }
    }
}
