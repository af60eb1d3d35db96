//! Streets and blocks: a grid of unequal columns and rows that grows outward from the centre.
//!
//! ```text
//!   street  block          cell (i, j): its street runs along the west and the south,
//!  ┌──────┬────────┐       the block is what is left; `x(i)` is where column i starts
//!  │      │ houses │
//!  │      ├────────┘       blocks are about twice as wide as deep, so ring r of the
//!  └──────┴─────────┘      city has columns -r..=r and rows -2r..=2r
//! ```

use crate::city::synth::{
    SynthOptions,
    house::{House, Shape},
    random::Random,
};

/// Houses stand this far from the street.
const PAVEMENT: i64 = 3_000;
const STOREY: i64 = 3_000;
/// The year of the newest house.
const NEWEST: i64 = 2025;

const COLUMN_SALT: u64 = 1;
const ROW_SALT: u64 = 2;
const BLOCK_SALT: u64 = 3;

/// One block of the city.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its number in the order of making, from 1.
    pub number: u64,
    /// The number of buildings in the blocks before it.
    pub first_building: u64,
    /// The street at its west and south: an L, counter-clockwise, millimetres.
    pub street: [[i64; 2]; 6],
    /// The ground of its buildings, counter-clockwise, millimetres.
    pub ground: [[i64; 2]; 4],
    /// Its buildings.
    pub houses: Vec<House>,
}

/// The blocks of a city, from the centre outward, until all buildings have a place.
#[derive(Clone, Debug)]
pub struct Layout {
    options: SynthOptions,
    columns: Axis,
    rows: Axis,
    /// The ring where the city will about end.
    last_ring: i64,
    made: u64,
    blocks: u64,
    cells: Cells,
}

impl Layout {
    /// The city of these options.
    pub fn new(options: &SynthOptions) -> Self {
        // A block holds about 16 buildings, and 8 r² blocks lie within ring r.
        let last_ring = (options.buildings / 128).isqrt() as i64 + 1;
        Self {
            options: *options,
            columns: Axis::new(options.seed, COLUMN_SALT, [84_000, 132_000]),
            rows: Axis::new(options.seed, ROW_SALT, [46_000, 62_000]),
            last_ring,
            made: 0,
            blocks: 0,
            cells: Cells::default(),
        }
    }
}

impl Iterator for Layout {
    type Item = Block;

    fn next(&mut self) -> Option<Block> {
        if self.made >= self.options.buildings {
            return None;
        }
        let [i, j] = self.cells.next();
        let (x, street_x, x_end) = self.columns.cell(i);
        let (y, street_y, y_end) = self.rows.cell(j);
        let (x0, y0) = (x + street_x, y + street_y);
        let mut random = Random::at(self.options.seed, BLOCK_SALT, [i, j]);
        // 1000 at the centre, 0 at the edge.
        let centrality = 1000 - (1000 * i.abs().max((j.abs() + 1) / 2) / self.last_ring).min(1000);
        let plot = Plot {
            min: [x0 + PAVEMENT, y0 + PAVEMENT],
            max: [x_end - PAVEMENT, y_end - PAVEMENT],
            centrality,
            skyline: (self.last_ring * 30_000).min(135_000),
            // The city grew outward: the centre is old, with newer blocks in between.
            year: if random.chance(15) {
                random.range(1960, 2020)
            } else {
                1985 - centrality / 10 + random.range(-20, 30)
            },
        };
        let mut houses = plot.build(&mut random);
        houses.iter_mut().for_each(|house| house.year = house.year.min(NEWEST));
        houses.truncate(usize::try_from(self.options.buildings - self.made).unwrap_or(usize::MAX));
        let first_building = self.made;
        self.made += houses.len() as u64;
        self.blocks += 1;
        let street = [[x, y], [x_end, y], [x_end, y0], [x0, y0], [x0, y_end], [x, y_end]];
        let ground = [[x0, y0], [x_end, y0], [x_end, y_end], [x0, y_end]];
        Some(Block { number: self.blocks, first_building, street, ground, houses })
    }
}

/// Goes through the cells ring by ring: columns -r..=r, rows -2r..=2r, without those of the ring before. Rows come in the
/// order 0, 1, -1, 2, -2, ..., so that a ring that ends early still hangs together.
#[derive(Clone, Debug, Default)]
struct Cells {
    ring: i64,
    column: i64,
    /// Position in the order of rows.
    row: i64,
}

impl Cells {
    fn next(&mut self) -> [i64; 2] {
        let r = self.ring;
        let row = if self.row % 2 == 1 { (self.row + 1) / 2 } else { -self.row / 2 };
        let here = [self.column, row];
        let is_whole_row = row.abs() > 2 * (r - 1);
        // Rows that the ring before has crossed keep only their two ends.
        self.column = if is_whole_row || self.column == r { self.column + 1 } else { r };
        if self.column > r {
            self.row += 1;
            if self.row > 4 * r {
                self.ring += 1;
                self.row = 0;
            }
            self.column = -self.ring;
        }
        here
    }
}

/// Where columns (or rows) start: sums of street and block widths on both sides of the centre.
#[derive(Clone, Debug)]
struct Axis {
    seed: u64,
    salt: u64,
    block: [i64; 2],
    /// Start of columns 0, 1, 2, ...
    up: Vec<i64>,
    /// Start of columns 0, -1, -2, ...
    down: Vec<i64>,
}

impl Axis {
    fn new(seed: u64, salt: u64, block: [i64; 2]) -> Self {
        let mut axis = Self { seed, salt, block, up: Vec::new(), down: Vec::new() };
        // The origin is the middle of the central crossing, so an eye there stands on a street.
        let start = -axis.widths(0).0 / 2;
        axis.up.push(start);
        axis.down.push(start);
        axis
    }

    /// Street and block width of column `i`.
    fn widths(&self, i: i64) -> (i64, i64) {
        let street = if i.rem_euclid(5) == 0 { 20_000 } else { 11_000 };
        let block = Random::at(self.seed, self.salt, [i, 0]).decimetres(self.block[0], self.block[1]);
        (street, block)
    }

    /// Start, street width and end of column `i`.
    fn cell(&mut self, i: i64) -> (i64, i64, i64) {
        let (street, block) = self.widths(i);
        let start = self.start(i);
        (start, street, start + street + block)
    }

    fn start(&mut self, i: i64) -> i64 {
        let distance = i.unsigned_abs() as usize;
        while i > 0 && self.up.len() <= distance {
            let last = self.up.len() as i64 - 1;
            let (street, block) = self.widths(last);
            self.up.push(self.up[last as usize] + street + block);
        }
        while i < 0 && self.down.len() <= distance {
            let next = -(self.down.len() as i64);
            let (street, block) = self.widths(next);
            self.down.push(self.down[self.down.len() - 1] - street - block);
        }
        if i >= 0 { self.up[distance] } else { self.down[distance] }
    }
}

// --- blocks -----------------------------------------------------------------------------------

/// Where a block may be built over: its ground without the pavement.
#[derive(Clone, Copy, Debug)]
struct Plot {
    min: [i64; 2],
    max: [i64; 2],
    centrality: i64,
    /// Height that the towers of a city of this size reach, above those of its edge.
    skyline: i64,
    year: i64,
}

/// The way in which a block is built over.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Terraces,
    Detached,
    Perimeter,
    Courts,
    Towers,
    Halls,
    Park,
}

/// A side of a block, along which houses stand wall to wall.
#[derive(Clone, Copy)]
struct Row {
    /// Where it starts: the left end, seen from the street.
    start: [i64; 2],
    /// Quarter turns of its houses.
    turn: u8,
    length: i64,
    depth: i64,
}

impl Plot {
    fn build(&self, random: &mut Random) -> Vec<House> {
        let c = self.centrality;
        let kind = random.pick(&[
            (40, Kind::Terraces),
            (if c < 400 { 24 } else { 3 }, Kind::Detached),
            (if c < 300 { 6 } else { 45 }, Kind::Perimeter),
            (if c < 500 { 1 } else { 8 }, Kind::Courts),
            (if c < 700 { 0 } else { 70 * (c - 700) / 300 }, Kind::Towers),
            (if c < 250 { 7 } else { 0 }, Kind::Halls),
            (3, Kind::Park),
        ]);
        match kind {
            Kind::Terraces => self.terraces(random),
            Kind::Detached => self.detached(random),
            Kind::Perimeter => self.perimeter(random),
            Kind::Courts => self.courts(random),
            Kind::Towers => self.towers(random),
            Kind::Halls => self.halls(random),
            Kind::Park => Vec::new(),
        }
    }

    fn size(&self) -> [i64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    fn south(&self, depth: i64) -> Row {
        Row { start: self.min, turn: 0, length: self.size()[0], depth }
    }

    fn north(&self, depth: i64) -> Row {
        Row { start: self.max, turn: 2, length: self.size()[0], depth }
    }

    /// The west side, between rows of `depth` at the south and the north.
    fn west(&self, depth: i64) -> Row {
        Row { start: [self.min[0], self.max[1] - depth], turn: 3, length: self.size()[1] - 2 * depth, depth }
    }

    fn east(&self, depth: i64) -> Row {
        Row { start: [self.max[0], self.min[1] + depth], turn: 1, length: self.size()[1] - 2 * depth, depth }
    }

    /// Two rows of narrow houses that share their party walls, gardens between the rows.
    fn terraces(&self, random: &mut Random) -> Vec<House> {
        let mut houses = Vec::new();
        for is_north in [false, true] {
            let depth = random.decimetres(8_600, 11_600);
            let row = if is_north { self.north(depth) } else { self.south(depth) };
            let width = random.decimetres(5_200, 7_800);
            let shape = random.pick(&[(52, Shape::Flat), (18, Shape::Shed), (30, Shape::Gable)]);
            let storeys = random.range(2, 3);
            let rise = if shape == Shape::Shed { 1_500 } else { random.decimetres(2_600, 4_200) };
            // An alley lets one through to the gardens.
            let run = random.range(6, 11);
            let mut eaves = storeys * STOREY;
            let (mut at, mut count) = (0, 0);
            while at + width <= row.length {
                if random.chance(22) {
                    eaves = storeys * STOREY + random.decimetres(-300, 300);
                }
                houses.push(House {
                    width,
                    eaves,
                    rise,
                    function: "residential",
                    year: self.year + is_north as i64 * 2,
                    ..row.house(shape, at)
                });
                count += 1;
                at += width + if count % run == 0 { 2_000 } else { 0 };
            }
        }
        houses
    }

    /// Houses with a garden around.
    fn detached(&self, random: &mut Random) -> Vec<House> {
        let mut houses = Vec::new();
        for row in [self.south(0), self.north(0)] {
            let mut at = 0;
            loop {
                let lot = random.decimetres(12_500, 18_000);
                if at + lot > row.length {
                    break;
                }
                let width = random.decimetres(7_600, lot - 3_600);
                let depth = random.decimetres(7_600, 11_000);
                let kinds = [(22, Shape::Gable), (22, Shape::Hip), (18, Shape::Flat), (20, Shape::Shed)];
                let shape = random.pick(&[&kinds[..], &[(14, Shape::Corner), (4, Shape::Mansard)]].concat());
                let across = random.decimetres(1_000, lot - width - 1_000);
                let set_back = random.decimetres(0, 3_500);
                let house = House {
                    width,
                    depth,
                    eaves: STOREY * random.range(1, 2) + random.decimetres(0, 800),
                    rise: if shape == Shape::Shed { 1_400 } else { random.decimetres(2_200, 3_800) },
                    inset: match shape {
                        Shape::Corner => random.decimetres(4_000, 5_600) / 200 * 200,
                        Shape::Hip => random.decimetres(2_000, 3_400),
                        _ => 1_400,
                    },
                    function: "residential",
                    year: self.year + random.range(0, 12),
                    ..Row { start: row.along(at + across, set_back), ..row }.house(shape, 0)
                };
                houses.push(house);
                at += lot;
            }
        }
        houses
    }

    /// Town houses wall to wall around a common yard.
    fn perimeter(&self, random: &mut Random) -> Vec<House> {
        let depth = random.decimetres(11_000, 13_600);
        let storeys = 3 + self.centrality / 300 + random.range(0, 1);
        let mut houses = Vec::new();
        for row in [self.south(depth), self.east(depth), self.north(depth), self.west(depth)] {
            let mut at = 0;
            while row.length - at >= 8_000 {
                // The last house takes what is left, so that the corner closes.
                let width = random.decimetres(9_000, 15_000);
                let width = if row.length - at - width < 8_000 { row.length - at } else { width };
                let shape =
                    random.pick(&[(62, Shape::Flat), (22, Shape::Gable), (10, Shape::Shed), (6, Shape::Mansard)]);
                houses.push(House {
                    width,
                    eaves: (storeys + random.range(-1, 1)) * STOREY + 1_000,
                    rise: if shape == Shape::Shed { 1_800 } else { random.decimetres(3_000, 4_600) },
                    inset: random.decimetres(1_200, 2_000),
                    function: random.pick(&[(70, "residential"), (20, "commercial"), (10, "office")]),
                    year: self.year + random.range(-10, 25),
                    ..row.house(shape, at)
                });
                at += width;
            }
        }
        houses
    }

    /// Two or three large buildings, each around its own yard.
    fn courts(&self, random: &mut Random) -> Vec<House> {
        let storeys = 4 + self.centrality / 250;
        self.parcels(random.range(2, 3), 1, 6_000, random, |random, width, depth| House {
            width,
            depth,
            eaves: (storeys + random.range(-1, 1)) * STOREY,
            // A yard of 6 m at least.
            inset: random.decimetres(9_000, 12_000).min((width.min(depth) - 6_000) / 200 * 100),
            function: random.pick(&[(40, "public"), (40, "office"), (20, "commercial")]),
            year: self.year + random.range(0, 30),
            ..Row::NOWHERE.house(Shape::Court, 0)
        })
    }

    /// High buildings, the higher the nearer the centre.
    fn towers(&self, random: &mut Random) -> Vec<House> {
        let reach = 25_000 + self.skyline * (self.centrality - 600).max(0) / 400;
        self.parcels(random.range(3, 4), 2, 8_000, random, |random, width, depth| {
            let height = random.decimetres(25_000, reach.max(30_000));
            let on_podium = random.chance(45);
            House {
                width: if on_podium { width } else { width - 3_000 },
                depth: if on_podium { depth } else { depth - 1_000 },
                eaves: if on_podium { random.range(2, 4) * STOREY } else { height },
                rise: if on_podium { height } else { 0 },
                inset: random.decimetres(2_000, 3_600),
                function: random.pick(&[(60, "office"), (25, "residential"), (15, "commercial")]),
                year: random.range(1965, 2024),
                ..Row::NOWHERE.house(if on_podium { Shape::Tower } else { Shape::Flat }, 0)
            }
        })
    }

    /// Halls with low roofs.
    fn halls(&self, random: &mut Random) -> Vec<House> {
        self.parcels(random.range(2, 4), 1, 7_000, random, |random, width, depth| {
            let shape = random.pick(&[(40, Shape::Flat), (30, Shape::Shed), (30, Shape::Gable)]);
            House {
                width,
                depth,
                eaves: random.decimetres(5_500, 9_500),
                rise: random.decimetres(1_200, 2_400),
                function: "industrial",
                year: random.range(1955, 2022),
                ..Row::NOWHERE.house(shape, 0)
            }
        })
    }

    /// One building in each of `across` × `along` equal parcels, `gap` apart, facing south.
    fn parcels(
        &self,
        across: i64,
        along: i64,
        gap: i64,
        random: &mut Random,
        mut make: impl FnMut(&mut Random, i64, i64) -> House,
    ) -> Vec<House> {
        let size = self.size();
        let width = (size[0] - gap * (across - 1)) / across / 100 * 100;
        let depth = (size[1] - gap * (along - 1)) / along / 100 * 100;
        let mut houses = Vec::new();
        for row in 0..along {
            for column in 0..across {
                let corner = [self.min[0] + column * (width + gap), self.min[1] + row * (depth + gap)];
                houses.push(House { corner, ..make(random, width, depth) });
            }
        }
        houses
    }
}

impl Row {
    /// A row for houses whose place is given afterwards.
    const NOWHERE: Self = Self { start: [0, 0], turn: 0, length: 0, depth: 0 };

    /// The place `along` the row and `back` from the street.
    fn along(&self, along: i64, back: i64) -> [i64; 2] {
        let [x, y] = self.start;
        match self.turn {
            0 => [x + along, y + back],
            1 => [x - back, y + along],
            2 => [x - along, y - back],
            _ => [x + back, y - along],
        }
    }

    /// A house in the row; sizes are filled in by the caller.
    fn house(&self, shape: Shape, at: i64) -> House {
        House {
            shape,
            corner: self.along(at, 0),
            turn: self.turn,
            width: 0,
            depth: self.depth,
            eaves: 0,
            rise: 0,
            inset: 0,
            function: "residential",
            year: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_comes_once_ring_by_ring() {
        let mut cells = Cells::default();
        let mut seen = std::collections::HashSet::new();
        for r in 0..5_i64 {
            let upto = (2 * r + 1) * (4 * r + 1);
            while (seen.len() as i64) < upto {
                let [i, j] = cells.next();
                assert!(i.abs() <= r && j.abs() <= 2 * r, "[{i}, {j}] in ring {r}");
                assert!(seen.insert([i, j]), "[{i}, {j}] twice");
            }
        }
    }

    #[test]
    fn columns_follow_each_other_without_gap() {
        let mut axis = Axis::new(5, COLUMN_SALT, [84_000, 132_000]);
        for i in [3, -4, 0, -1, 1, 2, -3, -2] {
            let (_, _, end) = axis.cell(i);
            assert_eq!(axis.cell(i + 1).0, end, "column {i}");
        }
    }
}
