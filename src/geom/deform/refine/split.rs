//! One triangle in smaller ones.

use glam::DVec3;

use crate::geom::deform::refine::{Refiner, chord::order};

/// How many edges inside triangles may follow from each other. Each should leave less to be done, but beside an edge that just keeps the
/// tolerance two others may be halved in turns, and come ever nearer to it.
const GENERATIONS: u32 = 32;

/// A corner of what a triangle becomes.
pub(super) struct Corner {
    pub(super) rest: DVec3,
    pub(super) shown: DVec3,
    pub(super) weights: DVec3,
}

/// What a triangle becomes.
pub(super) struct Split<'a> {
    refiner: &'a Refiner<'a>,
    /// Triangles from which on it is pointless to go on.
    most: usize,
    /// Whether the corners were put in order by an odd number of exchanges.
    is_turned: bool,
    pub(super) vertices: Vec<Corner>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) too_coarse: usize,
}

/// What is known of an edge, once for both triangles beside it.
#[derive(Clone, Copy)]
struct Edge {
    /// How many edges inside triangles whose longest edge was not halved led to it; 0 along the triangle's own. Its halves have its own, so
    /// both sides know the same.
    generation: u32,
    /// The vertex in its middle, if it is halved.
    middle: Option<u32>,
}

impl<'a> Split<'a> {
    pub(super) fn of(refiner: &'a Refiner<'a>, corners: [DVec3; 3], most: usize) -> Self {
        let mut sorted = [0, 1, 2];
        sorted.sort_by(|&i, &j| order(corners[i], corners[j]));
        let is_turned = matches!(sorted, [0, 2, 1] | [1, 0, 2] | [2, 1, 0]);
        let vertices = sorted.map(|i| Corner {
            rest: corners[i],
            shown: refiner.deformers.value(corners[i]),
            weights: DVec3::AXES[i],
        });
        let mut split =
            Self { refiner, most, is_turned, vertices: vertices.into(), triangles: Vec::new(), too_coarse: 0 };
        let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| split.edge(ends, 0));
        split.go([0, 1, 2], edges);
        split
    }

    fn rest(&self, i: u32) -> DVec3 {
        self.vertices[i as usize].rest
    }

    fn add(&mut self, rest: DVec3, weights: DVec3) -> u32 {
        self.vertices.push(Corner { rest, shown: self.refiner.deformers.value(rest), weights });
        self.vertices.len() as u32 - 1
    }

    /// An edge, halved if it has to be.
    fn edge(&mut self, [a, b]: [u32; 2], generation: u32) -> Edge {
        let [from, to] = [a, b].map(|i| self.rest(i));
        let rest = Refiner::middle(from, to);
        if rest == from || rest == to || !self.refiner.halves(from, to) {
            return Edge { generation, middle: None };
        }
        if generation > GENERATIONS || self.refiner.is_short(from, to) {
            self.too_coarse += 1;
            return Edge { generation, middle: None };
        }
        let weights = 0.5 * (self.vertices[a as usize].weights + self.vertices[b as usize].weights);
        Edge { generation, middle: Some(self.add(rest, weights)) }
    }

    /// Both halves of a halved edge, in its direction.
    fn halves(&mut self, [a, b]: [u32; 2], edge: Edge, middle: u32) -> [Edge; 2] {
        [[a, middle], [middle, b]].map(|ends| self.edge(ends, edge.generation))
    }

    /// Squared length of the edge that begins with a corner.
    fn squared(&self, corners: [u32; 3], first: usize) -> f64 {
        self.rest(corners[first]).distance_squared(self.rest(corners[(first + 1) % 3]))
    }

    /// A triangle with corners a, b, c and edges ab, bc, ca.
    fn go(&mut self, corners: [u32; 3], edges: [Edge; 3]) {
        if self.triangles.len() > self.most {
            return;
        }
        // Turned so that the edges that are halved come first, of three the longest.
        let count = edges.iter().filter(|edge| edge.middle.is_some()).count();
        let longest =
            (0..3).max_by(|&i, &j| self.squared(corners, i).total_cmp(&self.squared(corners, j))).unwrap_or(0);
        let first = match count {
            1 => edges.iter().position(|edge| edge.middle.is_some()).unwrap_or(0),
            2 => edges.iter().position(|edge| edge.middle.is_none()).map_or(0, |i| (i + 1) % 3),
            _ => longest,
        };
        let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
        let [ab, bc, ca] = [0, 1, 2].map(|i| edges[(first + i) % 3]);
        let inside =
            edges.iter().map(|edge| edge.generation).fold(0, u32::max) + u32::from(edges[longest].middle.is_none());
        match [ab.middle, bc.middle, ca.middle] {
            [Some(m), Some(n), Some(k)] => {
                let [am, mb] = self.halves([a, b], ab, m);
                let [bn, nc] = self.halves([b, c], bc, n);
                let [ck, ka] = self.halves([c, a], ca, k);
                let [mn, km] = [[m, n], [k, m]].map(|ends| self.edge(ends, inside));
                self.go([a, m, k], [am, km, ka]);
                self.go([m, b, n], [mb, bn, mn]);
                // What is left, m n c k, by its shorter diagonal: of slivers that keeps the number small.
                if self.rest(m).distance_squared(self.rest(c)) < self.rest(n).distance_squared(self.rest(k)) {
                    let mc = self.edge([m, c], inside);
                    self.go([m, n, c], [mn, nc, mc]);
                    self.go([m, c, k], [mc, ck, km]);
                } else {
                    let nk = self.edge([n, k], inside);
                    self.go([k, n, c], [nk, nc, ck]);
                    self.go([m, n, k], [mn, nk, km]);
                }
            }
            [Some(m), Some(n), None] => {
                let [am, mb] = self.halves([a, b], ab, m);
                let [bn, nc] = self.halves([b, c], bc, n);
                let mn = self.edge([m, n], inside);
                self.go([m, b, n], [mb, bn, mn]);
                // What is left, a m n c, by its shorter diagonal.
                let [first, second] = [[a, n], [m, c]].map(|[i, j]| self.rest(i).distance_squared(self.rest(j)));
                if first <= second {
                    let an = self.edge([a, n], inside);
                    self.go([a, m, n], [am, mn, an]);
                    self.go([a, n, c], [an, nc, ca]);
                } else {
                    let mc = self.edge([m, c], inside);
                    self.go([a, m, c], [am, mc, ca]);
                    self.go([m, n, c], [mn, nc, mc]);
                }
            }
            [Some(m), ..] => {
                let [am, mb] = self.halves([a, b], ab, m);
                let mc = self.edge([m, c], inside);
                self.go([a, m, c], [am, mc, ca]);
                self.go([m, b, c], [mb, bc, mc]);
            }
            _ => self.whole([a, b, c], [ab, bc, ca], inside),
        }
    }

    /// A triangle without halved edges: done, unless it is bent inside.
    fn whole(&mut self, corners: [u32; 3], [ab, bc, ca]: [Edge; 3], generation: u32) {
        let [a, b, c] = corners;
        let places = corners.map(|i| self.rest(i));
        let inside = if self.refiner.meets_triangle(&places) { self.refiner.worst_inside(&places) } else { None };
        let mixed = |of: [DVec3; 3], weights: DVec3| of[0] * weights.x + of[1] * weights.y + of[2] * weights.z;
        let is_room = |weights: &DVec3| {
            let p = mixed(places, *weights);
            generation <= GENERATIONS && places.iter().all(|corner| !self.refiner.is_short(*corner, p))
        };
        let Some(weights) = inside.filter(is_room) else {
            self.too_coarse += usize::from(inside.is_some());
            self.triangles.push(if self.is_turned { [a, c, b] } else { [a, b, c] });
            return;
        };
        let p = self.add(mixed(places, weights), mixed(corners.map(|i| self.vertices[i as usize].weights), weights));
        let [pa, pb, pc] = [a, b, c].map(|corner| self.edge([p, corner], generation));
        self.go([a, b, p], [ab, pb, pa]);
        self.go([b, c, p], [bc, pc, pb]);
        self.go([c, a, p], [ca, pa, pc]);
    }
}
