//! All crossings of a picture at once: lines and overlays are sorted into the cells of a grid, and only those that share a cell are compared.
//!
//! A cell holds a piece of each segment that passes it: a box around that part of it, rounded outwards. Where two segments share a point, they share the
//! cell of that point, and their boxes there overlap. Whether they do share one is told by the exact predicates of [`crate::overlay::crossings`].

use crate::overlay::{
    Rect,
    crossings::{Lattice, Way, on_lattice},
    place::Crossings,
};

/// Cells are 2 to the power of this lattice steps wide and high, or larger: 32 pixels, about as long as a segment of a curve.
const LEAST_SHIFT: u32 = 13;

/// The most columns, and the most rows.
const MOST_CELLS: i64 = 64;

/// Crossings, and between which overlays they are.
#[derive(Clone, Debug, Default)]
pub struct Counted {
    /// How many.
    pub crossings: Crossings,
    /// For each of them the numbers of two overlays, the lower first.
    pub pairs: Vec<(usize, usize)>,
}

/// The crossings of all overlays and their lines. Where there is no rectangle there are no lines.
pub fn count(rects: &[Option<Rect>], ways: &[Vec<Way>]) -> Counted {
    let mut counted = Counted::default();
    let present: Vec<(usize, Rect)> = rects.iter().enumerate().filter_map(|(i, r)| Some((i, (*r)?))).collect();
    let lines: Vec<(usize, &Way)> = present.iter().flat_map(|&(i, _)| ways[i].iter().map(move |w| (i, w))).collect();
    let Some(grid) = Grid::around(&present) else { return counted };
    let (mut segments, mut overlays) = (Vec::new(), Vec::new());
    for (of, (_, way)) in (0..).zip(&lines) {
        for (segment, ends) in (0..).zip(way.points().windows(2)) {
            grid.add_segment(&mut segments, of, segment, ends[0], ends[1]);
        }
    }
    for (of, (_, rect)) in (0..).zip(&present) {
        let [low, high] = on_lattice(rect);
        grid.add(&mut overlays, Piece { low: small(low), high: small(high), of, segment: 0 });
    }
    let (segments, overlays) = (grid.sorted(&segments), grid.sorted(&overlays));
    let mut met = Pairs::new(lines.len(), lines.len());
    let mut passed = Pairs::new(lines.len(), present.len());
    for (segments, overlays) in segments.cells().zip(overlays.cells()) {
        for (n, a) in segments.iter().enumerate() {
            let (line, (i, way)) = (a.of as usize, lines[a.of as usize]);
            // The pieces of a cell are in the order of their lines.
            for b in segments[..n].iter().filter(|b| b.touches(a)) {
                let (other, (j, other_way)) = (b.of as usize, lines[b.of as usize]);
                if i != j && !met.has(line, other) && way.meets(a.segment as usize, other_way, b.segment as usize) {
                    met.add(line, other);
                    counted.crossings.lines += 1;
                    counted.pairs.push((i.min(j), i.max(j)));
                }
            }
            for b in overlays.iter().filter(|b| b.touches(a)) {
                let (other, (j, rect)) = (b.of as usize, present[b.of as usize]);
                if i != j && !passed.has(line, other) && way.passes(a.segment as usize, &rect) {
                    passed.add(line, other);
                    counted.crossings.overlays += 1;
                    counted.pairs.push((i.min(j), i.max(j)));
                }
            }
        }
    }
    counted
}

/// What of a segment or of an overlay is in a cell: a box, lattice steps.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    low: [i32; 2],
    high: [i32; 2],
    /// The number of the line or of the overlay.
    of: u32,
    /// The number of the segment.
    segment: u32,
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

/// Coordinates are at most 2²⁸.
fn small(point: Lattice) -> [i32; 2] {
    point.map(|v| v as i32)
}

/// Cells around what stands in a picture. Those along its border hold what is outside of it, too.
struct Grid {
    /// Its upper left corner, lattice steps.
    origin: Lattice,
    /// Columns and rows.
    count: [i64; 2],
    /// The size of a cell is 2 to the power of this, lattice steps.
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
        while extent.iter().any(|e| e >> shift >= MOST_CELLS) {
            shift += 1;
        }
        Some(Self { origin, count: extent.map(|e| (e >> shift) + 1), shift })
    }

    /// The column (axis 0) or the row of a coordinate.
    fn cell(&self, axis: usize, at: i64) -> i64 {
        ((at - self.origin[axis]) >> self.shift).clamp(0, self.count[axis] - 1)
    }

    /// Adds a piece to all cells that its box touches.
    fn add(&self, pieces: &mut Vec<(u32, Piece)>, piece: Piece) {
        let range =
            |axis: usize| self.cell(axis, i64::from(piece.low[axis]))..=self.cell(axis, i64::from(piece.high[axis]));
        for row in range(1) {
            for column in range(0) {
                pieces.push(((row * self.count[0] + column) as u32, piece));
            }
        }
    }

    /// Adds the pieces of a segment, column by column.
    fn add_segment(&self, pieces: &mut Vec<(u32, Piece)>, of: u32, segment: u32, a: Lattice, b: Lattice) {
        let (from, to) = if a[0] <= b[0] { (a, b) } else { (b, a) };
        let slope = (to[1] - from[1]) as f64 / (to[0] - from[0]) as f64;
        let (low, high) = (from[1].min(to[1]), from[1].max(to[1]));
        let (first, last) = (self.cell(0, from[0]), self.cell(0, to[0]));
        let mut left = from;
        for column in first..=last {
            let right = if column == last {
                to
            } else {
                let x = self.origin[0] + ((column + 1) << self.shift);
                [x, from[1] + ((x - from[0]) as f64 * slope) as i64]
            };
            // The ordinate at a border between columns is less than two steps off.
            let low = (left[1].min(right[1]) - 2).max(low);
            let high = (left[1].max(right[1]) + 2).min(high);
            for row in self.cell(1, low)..=self.cell(1, high) {
                let piece = Piece { low: small([left[0], low]), high: small([right[0], high]), of, segment };
                pieces.push(((row * self.count[0] + column) as u32, piece));
            }
            left = right;
        }
    }

    /// Pieces by their cells, otherwise in their order.
    fn sorted(&self, pieces: &[(u32, Piece)]) -> Sorted {
        let mut ends = vec![0_u32; (self.count[0] * self.count[1]) as usize + 1];
        pieces.iter().for_each(|(cell, _)| ends[*cell as usize + 1] += 1);
        for cell in 1..ends.len() {
            ends[cell] += ends[cell - 1];
        }
        let mut sorted = vec![Piece::default(); pieces.len()];
        for (cell, piece) in pieces {
            let at = &mut ends[*cell as usize];
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
pub struct Pairs {
    columns: usize,
    bits: Vec<u64>,
}

impl Pairs {
    /// Of numbers below `rows` and below `columns`.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self { columns, bits: vec![0; (rows * columns).div_ceil(64)] }
    }

    /// Whether it holds a pair.
    pub fn has(&self, a: usize, b: usize) -> bool {
        let at = a * self.columns + b;
        self.bits[at / 64] >> (at % 64) & 1 == 1
    }

    /// Adds one.
    pub fn add(&mut self, a: usize, b: usize) {
        let at = a * self.columns + b;
        self.bits[at / 64] |= 1 << (at % 64);
    }
}
