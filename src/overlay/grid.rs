//! All crossings of a picture at once: lines and overlays are sorted into the cells of a grid, and only those that share
//! a cell are compared.
//!
//! A cell holds a piece of each segment that passes it: a box around that part of it, rounded outwards. Where two segments
//! share a point, they share the cell of that point, and their boxes there overlap. Whether they do share one is told by
//! the exact predicates of [`crate::overlay::crossings`].

use crate::overlay::{
    crossings::{Lattice, Way, on_lattice, segment_passes, segments_cross},
    placed::Crossings,
    rect::Rect,
};

/// Boxes are told in parts of cells, of which there are 2 to the power of this in a row.
const PARTS: u32 = 8;

/// Parts are 2 to the power of this lattice steps wide and high, or larger: with this, cells are 32 pixels wide, about as
/// much as a segment of a curve.
const LEAST_SHIFT: u32 = 5;

/// The most columns, and the most rows.
const MOST_CELLS: i64 = 64;

/// Crossings, and where they are.
#[derive(Clone, Debug, Default)]
pub struct Counted {
    /// The number of crossings.
    pub crossings: Crossings,
    /// Pairs of lines that cross: segments that meet.
    pub lines: Vec<[Segment; 2]>,
    /// Lines that cross overlays: segments that do, and the number of the overlay.
    pub overlays: Vec<(Segment, usize)>,
}

/// A segment of a line.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// The number of its overlay.
    pub overlay: u32,
    /// The number of its line: of all, overlay by overlay.
    pub line: u32,
    /// Its number, from the overlay.
    pub number: u32,
}

impl Counted {
    /// For each crossing the numbers of two overlays between which it is.
    pub fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        let lines = self.lines.iter().map(|both| both.map(|segment| segment.overlay as usize));
        lines.chain(self.overlays.iter().map(|(segment, overlay)| [segment.overlay as usize, *overlay]))
    }
}

/// The crossings of all overlays and their lines. Where there is no rectangle there are no lines.
pub fn count(rects: &[Option<Rect>], ways: &[Vec<Way>]) -> Counted {
    let mut counted = Counted::default();
    let present: Vec<(usize, Rect)> = rects.iter().enumerate().filter_map(|(i, r)| Some((i, (*r)?))).collect();
    let Some(grid) = Grid::around(&present) else { return counted };
    let lines: Vec<(usize, &Way)> = ways.iter().enumerate().flat_map(|(i, w)| w.iter().map(move |w| (i, w))).collect();
    let segment_count = lines.iter().map(|(_, way)| way.points().len() - 1).sum();
    let (mut segments, mut pieces) = (Vec::with_capacity(segment_count), Vec::with_capacity(3 * segment_count));
    for (line, (i, way)) in (0..).zip(&lines) {
        let points = way.points();
        for (number, ends) in (0..).zip(points.windows(2)) {
            grid.add_segment(&mut pieces, segments.len() as u32, ends[0], ends[1]);
            let is_last = number as usize + 2 == points.len();
            segments.push(Known {
                ends: [ends[0], ends[1]],
                is_last,
                name: Segment { overlay: *i as u32, line, number },
            });
        }
    }
    let mut overlays = Vec::new();
    for (of, (_, rect)) in (0..).zip(&present) {
        grid.add_overlay(&mut overlays, of, rect);
    }
    let (pieces, overlays) = (grid.sorted(&pieces), grid.sorted(&overlays));
    let (mut near, mut near_overlays) = (Chosen::default(), Chosen::default());
    for (pieces, overlays) in pieces.cells().zip(overlays.cells()) {
        for (k, a) in pieces.iter().enumerate() {
            near.add(pieces[..k].iter().map(|b| ([a.of, b.of], b.touches(a))));
            near_overlays.add(overlays.iter().map(|b| ([a.of, b.of], b.touches(a))));
        }
    }
    let mut crossing = Chosen::default();
    crossing.add(near.pairs().iter().map(|pair| {
        let [a, b] = pair.map(|n| &segments[n as usize]);
        (*pair, (a.name.overlay != b.name.overlay) & segments_cross(a.ends, b.ends, a.is_last & b.is_last))
    }));
    let mut met = Pairs::new(lines.len(), lines.len());
    for [a, b] in crossing.pairs().iter().map(|pair| pair.map(|n| &segments[n as usize])) {
        // The pieces of a cell are in the order of their lines.
        if met.add(a.name.line, b.name.line) {
            counted.lines.push([a.name, b.name]);
        }
    }
    let mut passed = Pairs::new(lines.len(), present.len());
    for [n, of] in near_overlays.pairs() {
        let (a, (overlay, rect)) = (&segments[*n as usize], &present[*of as usize]);
        if a.name.overlay as usize != *overlay && segment_passes(a.ends, rect) && passed.add(a.name.line, *of) {
            counted.overlays.push((a.name, *overlay));
        }
    }
    counted.crossings = Crossings { lines: counted.lines.len() as u32, overlays: counted.overlays.len() as u32 };
    counted
}

/// Facts about a segment.
struct Known {
    ends: [Lattice; 2],
    /// Whether its line ends with it.
    is_last: bool,
    name: Segment,
}

/// Pairs that were chosen of many, without a branch for each: which one is cannot be foretold.
#[derive(Default)]
struct Chosen {
    pairs: Vec<[u32; 2]>,
    count: usize,
}

impl Chosen {
    fn add(&mut self, all: impl ExactSizeIterator<Item = ([u32; 2], bool)>) {
        if self.pairs.len() < self.count + all.len() {
            self.pairs.resize(2 * self.count + all.len(), [0; 2]);
        }
        for (pair, is_chosen) in all {
            self.pairs[self.count] = pair;
            self.count += usize::from(is_chosen);
        }
    }

    fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs[..self.count]
    }
}

/// The piece of a segment or of an overlay that is in a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    /// A box: parts of a cell from the grid's corner on.
    low: [u16; 2],
    high: [u16; 2],
    /// The number of the segment or of the overlay.
    of: u32,
}

impl Piece {
    /// Whether the boxes share a point.
    fn touches(&self, other: &Self) -> bool {
        (self.low[0] <= other.high[0])
            & (other.low[0] <= self.high[0])
            & (self.low[1] <= other.high[1])
            & (other.low[1] <= self.high[1])
    }
}

/// Cells around what stands in a picture. Those along its border hold what is outside of it, too.
struct Grid {
    /// Its upper left corner, lattice steps.
    origin: Lattice,
    /// Columns and rows.
    count: [u16; 2],
    /// The size of a part of a cell is 2 to the power of this, lattice steps.
    shift: u32,
}

impl Grid {
    /// `None` around nothing.
    fn around(present: &[(usize, Rect)]) -> Option<Self> {
        let both = |a: Rect, b: Rect| Rect {
            min: [0, 1].map(|i| a.min[i].min(b.min[i])),
            max: [0, 1].map(|i| a.max[i].max(b.max[i])),
        };
        let [origin, end] = on_lattice(&present.iter().map(|p| p.1).reduce(both)?);
        let extent = [0, 1].map(|i| end[i] - origin[i]);
        let mut shift = LEAST_SHIFT;
        while extent.iter().any(|e| e >> (shift + PARTS) >= MOST_CELLS) {
            shift += 1;
        }
        Some(Self { origin, count: extent.map(|e| (e >> (shift + PARTS)) as u16 + 1), shift })
    }

    /// In which part from the grid's corner on a coordinate of an axis is.
    fn part(&self, axis: usize, at: i64) -> u16 {
        ((at - self.origin[axis]) >> self.shift).clamp(0, (i64::from(self.count[axis]) << PARTS) - 1) as u16
    }

    fn add(&self, pieces: &mut Vec<(u16, Piece)>, piece: Piece) {
        for row in piece.low[1] >> PARTS..=piece.high[1] >> PARTS {
            for column in piece.low[0] >> PARTS..=piece.high[0] >> PARTS {
                pieces.push((row * self.count[0] + column, piece));
            }
        }
    }

    fn add_overlay(&self, pieces: &mut Vec<(u16, Piece)>, of: u32, rect: &Rect) {
        let [low, high] = on_lattice(rect).map(|p| [self.part(0, p[0]), self.part(1, p[1])]);
        self.add(pieces, Piece { low, high, of });
    }

    /// Column by column.
    fn add_segment(&self, pieces: &mut Vec<(u16, Piece)>, of: u32, a: Lattice, b: Lattice) {
        let (from, to) = if a[0] <= b[0] { (a, b) } else { (b, a) };
        let (low, high) = (from[1].min(to[1]), from[1].max(to[1]));
        let (first, last) = (self.part(0, from[0]), self.part(0, to[0]));
        let mut left = from[1];
        for column in first >> PARTS..=last >> PARTS {
            let border = (column + 1) << PARTS;
            let right = if border > last {
                to[1]
            } else {
                let x = self.origin[0] + (i64::from(border) << self.shift);
                from[1] + ((x - from[0]) as f64 * ((to[1] - from[1]) as f64 / (to[0] - from[0]) as f64)) as i64
            };
            // The ordinate at a border between columns is less than two steps off.
            let rows = ((left.min(right) - 2).max(low), (left.max(right) + 2).min(high));
            self.add(
                pieces,
                Piece {
                    low: [first.max(column << PARTS), self.part(1, rows.0)],
                    high: [last.min(border - 1), self.part(1, rows.1)],
                    of,
                },
            );
            left = right;
        }
    }

    /// Pieces by their cells, otherwise in their order.
    fn sorted(&self, pieces: &[(u16, Piece)]) -> Sorted {
        let mut ends = vec![0; usize::from(self.count[0]) * usize::from(self.count[1]) + 1];
        pieces.iter().for_each(|(cell, _)| ends[usize::from(*cell) + 1] += 1);
        for cell in 1..ends.len() {
            ends[cell] += ends[cell - 1];
        }
        let mut sorted = vec![Piece::default(); pieces.len()];
        for (cell, piece) in pieces {
            let at = &mut ends[usize::from(*cell)];
            sorted[*at as usize] = *piece;
            *at += 1;
        }
        // What was the beginning of each has moved on to its end.
        ends.pop();
        Sorted { ends, pieces: sorted }
    }
}

/// Pieces by their cells.
struct Sorted {
    /// Where the pieces of each cell end.
    ends: Vec<u32>,
    pieces: Vec<Piece>,
}

impl Sorted {
    /// The pieces of each cell.
    fn cells(&self) -> impl Iterator<Item = &[Piece]> {
        let begins = std::iter::once(&0).chain(&self.ends);
        begins.zip(&self.ends).map(|(begin, end)| &self.pieces[*begin as usize..*end as usize])
    }
}

/// A set of pairs of numbers.
struct Pairs {
    columns: usize,
    bits: Vec<u64>,
}

impl Pairs {
    /// Makes an empty one for numbers below `rows` and below `columns`.
    fn new(rows: usize, columns: usize) -> Self {
        Self { columns, bits: vec![0; (rows * columns).div_ceil(64)] }
    }

    /// Adds one; whether it was not there.
    fn add(&mut self, a: u32, b: u32) -> bool {
        let at = a as usize * self.columns + b as usize;
        let (word, bit) = (&mut self.bits[at / 64], 1 << (at % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlay::crossings::{STEPS, between};

    #[test]
    fn all_crossings_are_those_of_all_pairs() {
        let mut state = 1_u64;
        let mut number = |most: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % most) as i64
        };
        let mut sum = 0;
        for round in 0..300 {
            // Every third picture is so large that cells have to grow, and some lines lead far out of it.
            let scale = if round % 3 == 0 { 50 } else { 1 };
            let mut rects = Vec::new();
            let mut ways = Vec::new();
            for n in 0..12 {
                let min = [number(500) as i32 * scale, number(300) as i32 * scale];
                rects.push((n % 5 < 4).then(|| Rect::new(min, [20 + 2 * n, 30 - n])));
                // Places on few points, so that lines touch, lie along each other and end together.
                let unit = if n % 2 == 0 { 20 * STEPS } else { 1 };
                let mut point = || match number(30) {
                    0 => [-(1 << 28), number(1 << 20)],
                    _ => [number(600 * STEPS as u64), number(400 * STEPS as u64)]
                        .map(|v| v / unit * unit * i64::from(scale)),
                };
                let mut way = || Way::new((0..2 + n % 4).map(|_| point()).collect());
                ways.push(if n % 5 < 4 { [way(), way()].into_iter().flatten().collect() } else { Vec::new() });
            }
            let counted = count(&rects, &ways);
            let mut pairs = vec![0; 144];
            counted.pairs().for_each(|[i, j]| pairs[i.max(j) * 12 + i.min(j)] += 1);
            for i in 0..12 {
                for j in 0..i {
                    let both = rects[i].zip(rects[j]);
                    let expected = both.map_or(0, |(a, b)| between(&a, &ways[i], &b, &ways[j]));
                    assert_eq!(pairs[i * 12 + j], expected, "round {round}, {i} and {j}");
                }
            }
            assert_eq!(counted.crossings.sum(), pairs.iter().sum::<u32>());
            sum += counted.crossings.sum();
        }
        assert!(sum > 10_000, "{sum}");
    }
}
