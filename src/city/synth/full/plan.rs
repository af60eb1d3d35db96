//! The plan: lines of streets, the cells between them, the river in one of the lines, and what each cell is.
//!
//! ```text
//!        line i      line i + 1
//!          │   cell    │            cells come in rings from the middle; those of the core, within `core` of it
//!  line j ─┼───────────┼─           both ways, are the old town. The river runs in the line at its west, a boulevard
//!          │  (i, j)   │            where its walls were in the lines at the other three sides
//! ```

use std::cell::RefCell;

use crate::city::synth::{
    SynthOptions,
    full::field::{Field, P2},
    random::Random,
};

const COLUMN: u64 = 21;
const ROW: u64 = 22;
const PATH: u64 = 23;

/// Half the width of the river with its quays, millimetres.
pub const RIVER: i64 = 37_000;

/// What a street is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Street {
    /// Of the old town.
    Lane,
    /// One of those that lead out of it.
    Main,
    /// Where the wall was.
    Boulevard,
    /// Between later blocks.
    Avenue,
    /// For those on foot only.
    Path,
    /// Through the fields.
    Track,
    /// The river and its quays.
    River,
}

impl Street {
    /// Half of its width, millimetres.
    pub fn half(self) -> i64 {
        match self {
            Self::Lane => 3_600,
            Self::Main => 8_500,
            Self::Boulevard => 17_000,
            Self::Avenue => 6_500,
            Self::Path => 2_300,
            Self::Track => 3_000,
            Self::River => RIVER,
        }
    }

    /// How much of the width each of its pavements takes, thousandths.
    pub fn pavement(self) -> i64 {
        match self {
            Self::Lane => 190,
            Self::Main => 210,
            Self::Boulevard => 270,
            Self::Avenue => 230,
            Self::Path => 330,
            Self::Track => 120,
            Self::River => 220,
        }
    }
}

/// A cell of the plan, by column and row.
pub type Cell = [i64; 2];

/// The plan of one city.
#[derive(Debug)]
pub struct Plan {
    /// Which city.
    pub options: SynthOptions,
    /// Its land.
    pub field: Field,
    /// The old town reaches so many cells from the middle one.
    pub core: i64,
    /// The ring where the city will about end.
    pub last: i64,
    columns: RefCell<Axis>,
    rows: RefCell<Axis>,
}

impl Plan {
    /// The plan of a city.
    pub fn new(options: &SynthOptions) -> Self {
        let core_of = |last: i64| (last * 3 / 10).clamp(1, 6);
        // A cell holds about 10 buildings, one of the old town 12 more; 3.9 r² cells lie within ring r.
        let holds = |last: i64| 41 * last * last + 25 * (2 * core_of(last) + 1).pow(2) / 2;
        let asked = options.buildings as i64 * 9 / 10;
        let last = (1..).find(|last| holds(*last) >= asked).unwrap_or(1);
        let core = core_of(last);
        let columns = Axis::new(options.seed, COLUMN, core, [104_000, 62_000, 80_000]);
        let rows = Axis::new(options.seed, ROW, core, [90_000, 56_000, 64_000]);
        let mut plan = Self {
            options: *options,
            field: Field::new(options.seed, 0),
            core,
            last,
            columns: RefCell::new(columns),
            rows: RefCell::new(rows),
        };
        let river = plan.columns.borrow_mut().start(-core);
        plan.field = Field::new(options.seed, river);
        plan
    }

    /// The line in which the river runs.
    pub fn river(&self) -> i64 {
        -self.core
    }

    /// The ring of a cell: a square without its corners.
    pub fn ring([i, j]: Cell) -> i64 {
        let (i, j) = (i.abs(), j.abs());
        i.max(j).max((4 * (i + j) + 6) / 7)
    }

    /// Whether a cell is of the old town.
    pub fn is_core(&self, [i, j]: Cell) -> bool {
        i.abs() <= self.core && j.abs() <= self.core
    }

    /// The street in line `i` along row `j`.
    pub fn upright(&self, i: i64, j: i64) -> Street {
        let sides = [[i - 1, j], [i, j]];
        match () {
            () if i == self.river() => Street::River,
            () if i == self.core + 1 && j.abs() <= self.core => Street::Boulevard,
            () => self.street(sides, i, COLUMN),
        }
    }

    /// The street in line `j` along column `i`.
    pub fn level(&self, i: i64, j: i64) -> Street {
        let sides = [[i, j - 1], [i, j]];
        let is_wall = (j == -self.core || j == self.core + 1) && i.abs() <= self.core;
        if is_wall { Street::Boulevard } else { self.street(sides, j, ROW) }
    }

    fn street(&self, sides: [Cell; 2], line: i64, salt: u64) -> Street {
        let [_, [i, j]] = sides;
        // Some blocks of later times hang together: only a path leads between them.
        let is_path = || Random::at(self.options.seed, PATH + salt, [i, j]).chance(24);
        let is_outside = sides.iter().all(|cell| Self::ring(*cell) > self.last + 1);
        match line {
            0 => Street::Main,
            _ if is_outside => Street::Track,
            _ if sides.iter().all(|cell| self.is_core(*cell)) => Street::Lane,
            _ if line.rem_euclid(4) == 0 => Street::Main,
            _ if is_path() => Street::Path,
            _ => Street::Avenue,
        }
    }

    /// The middle of line `i`, millimetres east on the straight plan.
    pub fn east(&self, i: i64) -> i64 {
        self.columns.borrow_mut().start(i)
    }

    /// The middle of line `j`, millimetres north on the straight plan.
    pub fn north(&self, j: i64) -> i64 {
        self.rows.borrow_mut().start(j)
    }

    /// The corners of a cell without its streets, counter-clockwise from the south-west, on the straight plan.
    pub fn straight(&self, [i, j]: Cell) -> [P2; 4] {
        let west = self.east(i) + self.upright(i, j).half();
        let east = self.east(i + 1) - self.upright(i + 1, j).half();
        let south = self.north(j) + self.level(i, j).half();
        let north = self.north(j + 1) - self.level(i, j + 1).half();
        [[west, south], [east, south], [east, north], [west, north]]
    }

    /// The same where they lie.
    pub fn block(&self, cell: Cell) -> [P2; 4] {
        self.straight(cell).map(|at| self.field.place(at))
    }
}

/// Where lines run: sums of the widths of columns or rows on both sides of the middle one.
#[derive(Clone, Debug)]
struct Axis {
    seed: u64,
    salt: u64,
    core: i64,
    /// Whether the river runs in one of the lines.
    has_river: bool,
    /// Widths: of the middle cell, of the old town, of what came later, millimetres.
    widths: [i64; 3],
    up: Vec<i64>,
    down: Vec<i64>,
}

impl Axis {
    fn new(seed: u64, salt: u64, core: i64, widths: [i64; 3]) -> Self {
        let start = -widths[0] / 2;
        Self { seed, salt, core, has_river: salt == COLUMN, widths, up: vec![start], down: vec![start] }
    }

    fn width(&self, i: i64) -> i64 {
        let random = &mut Random::at(self.seed, self.salt, [i, 0]);
        match i.abs() {
            0 => self.widths[0],
            k if k <= self.core => self.widths[1] * random.range(86, 118) / 100 + self.room(i),
            k => self.widths[2] * (random.range(84, 122) + (k - self.core).min(12)) / 100 + self.room(i),
        }
    }

    /// What a cell is wider for the river or a boulevard at its side, millimetres.
    fn room(&self, i: i64) -> i64 {
        match i {
            _ if self.has_river && (i == -self.core || i == -self.core - 1) => RIVER - 4_000,
            _ if i.abs() == self.core || i.abs() == self.core + 1 => 13_000,
            _ => 0,
        }
    }

    fn start(&mut self, i: i64) -> i64 {
        let distance = i.unsigned_abs() as usize;
        while i > 0 && self.up.len() <= distance {
            let last = self.up.len() as i64 - 1;
            self.up.push(self.up[last as usize] + self.width(last));
        }
        while i < 0 && self.down.len() <= distance {
            let next = -(self.down.len() as i64);
            self.down.push(self.down[self.down.len() - 1] - self.width(next));
        }
        if i >= 0 { self.up[distance] } else { self.down[distance] }
    }
}

/// Goes through the cells ring by ring, each once.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    ring: i64,
    /// Rows of the ring that are done.
    row: i64,
    /// Cells of that row that are done.
    done: i64,
}

impl Cells {
    /// The farthest column of row `j` that lies within `ring`; -1 where none does.
    fn reach(ring: i64, j: i64) -> i64 {
        if j.abs() > ring { -1 } else { ring.min(ring * 7 / 4 - j.abs()) }
    }
}

impl Iterator for Cells {
    type Item = Cell;

    fn next(&mut self) -> Option<Cell> {
        loop {
            if self.row > 2 * self.ring {
                *self = Self { ring: self.ring + 1, row: 0, done: 0 };
            }
            // Rows come as 0, 1, -1, 2, -2, ..., so that a ring that ends early still hangs together.
            let j = if self.row % 2 == 1 { (self.row + 1) / 2 } else { -self.row / 2 };
            let (inner, outer) = (Self::reach(self.ring - 1, j), Self::reach(self.ring, j));
            let columns = if inner < 0 { 2 * outer + 1 } else { 2 * (outer - inner) };
            if self.done >= columns {
                self.row += 1;
                self.done = 0;
                continue;
            }
            let i = match (inner < 0, self.done < outer - inner) {
                (true, _) => self.done - outer,
                (false, true) => self.done - outer,
                (false, false) => self.done - (outer - inner) + inner + 1,
            };
            self.done += 1;
            return Some([i, j]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_comes_once_in_the_order_of_rings() {
        let mut seen = std::collections::HashSet::new();
        let mut last = 0;
        for cell in Cells::default().take_while(|cell| Plan::ring(*cell) <= 9) {
            assert!(Plan::ring(cell) >= last, "{cell:?}");
            last = Plan::ring(cell);
            assert!(seen.insert(cell), "{cell:?} twice");
        }
        let expected = (-9..=9).flat_map(|i| (-9..=9).map(move |j| [i, j])).filter(|c| Plan::ring(*c) <= 9).count();
        assert_eq!(seen.len(), expected);
    }

    #[test]
    fn blocks_are_convex_and_lie_the_right_way_round() {
        for seed in 1..=4 {
            let plan = Plan::new(&SynthOptions { buildings: 4000, seed });
            for cell in Cells::default().take_while(|cell| Plan::ring(*cell) <= plan.last + 2) {
                let block = plan.block(cell);
                for k in 0..4 {
                    let [a, b, c] = [0, 1, 2].map(|n| block[(k + n) % 4]);
                    let turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
                    assert!(turn > 0, "seed {seed}, cell {cell:?}: {block:?}");
                }
            }
        }
    }
}
