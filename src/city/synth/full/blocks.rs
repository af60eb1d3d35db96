//! Blocks: what each cell is, and the houses in it.

use crate::city::synth::{
    full::{
        field::{P2, distance},
        frame::{Frame, STEP, Strip, steps, yard},
        history::{self, Era, LAST},
        house::{Form, Function, House},
        plan::{Cell, Plan},
        style,
    },
    house::Shape,
    random::Random,
};

const BLOCK: u64 = 41;
const WOODS: u64 = 42;

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The church, and houses around it that hide it.
    Close,
    /// The market with the town hall.
    Market,
    /// Narrow houses wall to wall, yards with sheds.
    OldTown,
    /// Large buildings around courts.
    Courts,
    /// Town houses wall to wall around a yard.
    Perimeter,
    /// Rows of houses with gardens.
    Terraces,
    /// Houses in gardens of their own.
    Villas,
    /// Long blocks in parallel.
    Slabs,
    /// High buildings.
    Towers,
    /// Works and stores.
    Halls,
    /// Paved, with trees.
    Square,
    /// Lawns and trees.
    Park,
    /// Fields around the city.
    Field,
    /// Woods around the city.
    Wood,
}

/// A place with a house, and what stood there before.
#[derive(Clone, Debug)]
pub struct Lot {
    /// What stands there.
    pub house: House,
    /// What stood there, newest first.
    pub before: Vec<House>,
    /// The side of its block at which it stands: south, east, north, west.
    pub side: usize,
    /// Its place among the houses of that side, from 0.
    pub place: i64,
}

/// A cell with all that is built in it.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its column and row.
    pub cell: Cell,
    /// What it is.
    pub kind: Kind,
    /// Its corners, counter-clockwise from the south-west, millimetres.
    pub corners: [P2; 4],
    /// Its places.
    pub lots: Vec<Lot>,
}

impl Block {
    /// A cell of the city.
    pub fn city(plan: &Plan, cell: Cell) -> Self {
        let mut random = Random::at(plan.options.seed, BLOCK, cell);
        let era = Era::of(plan, cell, &mut random);
        let corners = plan.block(cell);
        let kind = kind_of(plan, cell, &era, &corners, &mut random);
        let mut builder = Builder { plan, era, corners, kind, lots: Vec::new(), random, is_fine: is_fine(cell) };
        builder.build();
        let mut lots = builder.lots;
        if kind == Kind::Market {
            lots.iter_mut().for_each(|lot| lot.house.is_fine = true);
        }
        Self { cell, kind, corners, lots }
    }

    /// A cell around the city.
    pub fn country(plan: &Plan, cell: Cell) -> Self {
        // Woods are larger than fields.
        let mut random = Random::at(plan.options.seed, WOODS, cell.map(|k| k.div_euclid(2)));
        let kind = random.pick(&[(7, Kind::Field), (3, Kind::Wood)]);
        Self { cell, kind, corners: plan.block(cell), lots: Vec::new() }
    }

    /// Whether a place is in a house or so near, millimetres.
    pub fn is_built(&self, at: P2, near: i64) -> bool {
        self.lots.iter().any(|lot| {
            let House { frame, width, depth, .. } = &lot.house;
            let away = [at[0] - frame.origin[0], at[1] - frame.origin[1]];
            let along = |step: P2| (away[0] * step[0] + away[1] * step[1]) / STEP;
            let (x, y) = (along(frame.u), along(frame.v));
            (-near..=width * STEP + near).contains(&x) && (-near..=depth * STEP + near).contains(&y)
        })
    }
}

/// Houses in the middle of the town and along the tram have windows and doors.
fn is_fine(cell: Cell) -> bool {
    Plan::ring(cell) <= 2 || (cell[0].abs() <= 8 && matches!(cell[1], -1 | 0))
}

fn kind_of(plan: &Plan, cell: Cell, era: &Era, corners: &[P2; 4], random: &mut Random) -> Kind {
    match cell {
        [0, 0] => return Kind::Close,
        [1, 0] => return Kind::Market,
        _ => {}
    }
    if plan.is_core(cell) {
        let is_at_market = Plan::ring(cell) <= 1;
        let others = if is_at_market { 0 } else { 1 };
        return random.pick(&[
            (88, Kind::OldTown),
            (7 * others, Kind::Courts),
            (2 * others, Kind::Park),
            (3 * others, Kind::Square),
        ]);
    }
    // Villas have the views, works the river and the south.
    let middle = [0, 1].map(|k| corners.iter().map(|c| c[k]).sum::<i64>() / 4);
    let villas = if plan.field.height(middle) > 24_000 { 3 } else { 1 };
    let halls = if cell[1] < -plan.core && cell[0] < 2 { 3 } else { 1 };
    match era.out {
        ..=250 => random.pick(&[
            (60, Kind::Perimeter),
            (8, Kind::Courts),
            (5 * villas, Kind::Villas),
            (12, Kind::Terraces),
            (4, Kind::Park),
            (3, Kind::Square),
            (3, Kind::Towers),
        ]),
        251..=520 => random.pick(&[
            (30, Kind::Perimeter),
            (34, Kind::Terraces),
            (8 * villas, Kind::Villas),
            (4, Kind::Courts),
            (4 * halls, Kind::Halls),
            (5, Kind::Slabs),
            (5, Kind::Park),
            (3, Kind::Towers),
        ]),
        521..=800 => random.pick(&[
            (30, Kind::Terraces),
            (22, Kind::Slabs),
            (10 * villas, Kind::Villas),
            (6 * halls, Kind::Halls),
            (5, Kind::Towers),
            (5, Kind::Park),
        ]),
        _ => random.pick(&[
            (26 * villas, Kind::Villas),
            (26, Kind::Terraces),
            (8 * halls, Kind::Halls),
            (8, Kind::Slabs),
            (5, Kind::Towers),
            (5, Kind::Park),
        ]),
    }
}

/// Fills a block.
struct Builder<'a> {
    plan: &'a Plan,
    era: Era,
    corners: [P2; 4],
    kind: Kind,
    lots: Vec<Lot>,
    random: Random,
    is_fine: bool,
}

impl Builder<'_> {
    fn build(&mut self) {
        match self.kind {
            Kind::Close => {
                self.rows([1, 38], [5_000, 7_500], true);
            }
            Kind::OldTown => self.old_town(),
            Kind::Perimeter => {
                let depth = steps(self.random.range(11_000, 13_000));
                self.rows([2, depth], [10_000, 15_500], false);
            }
            Kind::Terraces => self.terraces(),
            Kind::Villas => self.villas(),
            Kind::Courts => self.courts(),
            Kind::Slabs => self.slabs(),
            Kind::Towers => self.towers(),
            Kind::Halls => self.halls(),
            Kind::Market | Kind::Square | Kind::Park | Kind::Field | Kind::Wood => {}
        }
    }

    /// Puts a house up, in one of the years in which its place was built on; what stood there before comes with it.
    fn add(&mut self, side: usize, place: i64, house: House, years: &[i64]) {
        let mut house = House { year: years[years.len() - 1], is_fine: self.is_fine, ..house };
        house.stand(&self.plan.field);
        let before = history::predecessors(&house, years, &mut self.random);
        self.lots.push(Lot { house, before, side, place });
    }

    /// Houses wall to wall at all four sides, as far from the street and as deep as given (steps), so wide (millimetres).
    fn rows(&mut self, [front, depth]: [i64; 2], widths: [i64; 2], has_alleys: bool) -> Vec<Strip> {
        let [a, b, c, d] = self.corners;
        let is_wide = distance(a, b) + distance(c, d) >= distance(b, c) + distance(d, a);
        let order = if is_wide { [0, 2, 1, 3] } else { [1, 3, 0, 2] };
        let mut strips: Vec<Strip> = Vec::new();
        for side in order {
            if let Some(strip) = Strip::along(&self.corners, side, front, depth, &strips) {
                self.row(side, &strip, widths, has_alleys);
                strips.push(strip);
            }
        }
        strips
    }

    fn row(&mut self, side: usize, strip: &Strip, [least, most]: [i64; 2], has_alleys: bool) {
        let (mut at, mut place) = (0, 0);
        let alley = if has_alleys { strip.length() / 2 } else { i64::MAX };
        let mut has_passed = false;
        loop {
            if at >= alley && !has_passed {
                at += steps(2_500);
                has_passed = true;
            }
            let left = strip.length() - at;
            if left < steps(least) * 4 / 5 {
                break;
            }
            // The last house takes what is left, so that the corner closes.
            let width = steps(self.random.range(least, most));
            let width = if left - width < steps(least) * 4 / 5 { left } else { width };
            let years = self.era.years(&mut self.random);
            let mut house = style::town_house(
                strip.house(at, 0),
                [width, strip.depth],
                self.kind,
                &self.era,
                &years,
                &mut self.random,
            );
            // Those at the corners of the block, and at an alley, look to the side too.
            house.party = [place > 0, left > width];
            self.add(side, place, house, &years);
            at += width;
            place += 1;
        }
    }

    fn old_town(&mut self) {
        let depth = steps(self.random.range(8_500, 10_500));
        let has_alleys = self.random.chance(40);
        let strips = self.rows([1, depth], [4_500, 7_500], has_alleys);
        // Sheds and back houses in the yard.
        let Some(first) = strips.first() else { return };
        let side =
            (0..4).find(|k| Frame::towards(self.corners[*k], self.corners[(k + 1) % 4]) == first.frame).unwrap_or(0);
        let front = first.front + first.depth + steps(3_000);
        let Some(row) = Strip::along(&self.corners, side, front, steps(5_500), &strips) else { return };
        let mut at = steps(1_500);
        while row.length() - at > steps(6_500) {
            let width = steps(self.random.range(4_000, 6_500));
            if self.random.chance(65) {
                let years = self.era.years(&mut self.random);
                let house = style::shed(row.house(at, 0), [width, row.depth], &mut self.random);
                self.add(side, at / steps(5_000) + 40, house, &years);
            }
            at += width + steps(self.random.range(500, 5_000));
        }
    }

    /// Two rows of narrow houses with gardens between.
    fn terraces(&mut self) {
        let front = steps(self.random.range(2_000, 4_000));
        let depth = steps(self.random.range(8_600, 11_000));
        let mut strips: Vec<Strip> = Vec::new();
        let [a, b, c, d] = self.corners;
        let is_wide = distance(a, b) + distance(c, d) >= distance(b, c) + distance(d, a);
        for side in if is_wide { [0, 2] } else { [1, 3] } {
            let Some(strip) = Strip::along(&self.corners, side, front, depth, &strips) else { continue };
            strips.push(strip);
            // One builder, one year, one form for a row; some were replaced.
            let mut years = self.era.years(&mut self.random);
            years.truncate(1);
            let width = steps(self.random.range(5_200, 7_600));
            let run = self.random.range(5, 10);
            let pattern = style::terrace(&years, [width, depth], &mut self.random);
            let (mut at, mut place) = (0, 0);
            while at + width <= strip.length() {
                let mut house = House { frame: strip.house(at, 0), ..pattern.clone() };
                let mut own = years.clone();
                if self.random.chance(9) && years[0] + 35 < LAST {
                    own.push(self.random.range(years[0] + 30, LAST));
                    house = House { frame: house.frame, ..style::terrace(&own, [width, depth], &mut self.random) };
                }
                let is_last = at + 2 * width > strip.length();
                house.party = [place % run != 0, (place + 1) % run != 0 && !is_last];
                self.add(side, place, house, &own);
                place += 1;
                at += width + if place % run == 0 { steps(3_000) } else { 0 };
            }
        }
    }

    /// Houses in gardens.
    fn villas(&mut self) {
        let mut strips: Vec<Strip> = Vec::new();
        for side in [0, 2, 1, 3] {
            let Some(strip) = Strip::along(&self.corners, side, steps(3_000), steps(17_000), &strips) else { continue };
            strips.push(strip);
            let (mut at, mut place) = (0, 0);
            loop {
                let lot = steps(self.random.range(15_000, 22_000));
                if at + lot > strip.length() {
                    break;
                }
                let width = self.random.range(steps(8_000), lot - steps(4_500)).min(steps(14_000));
                let depth = self.random.range(steps(8_000), steps(12_000));
                let across = self.random.range(steps(1_500), lot - width - steps(1_500));
                let back = self.random.range(0, strip.depth - depth);
                let years = self.era.years(&mut self.random);
                let frame = strip.house(at + across, back);
                let house = style::villa(frame, [width, depth], &years, &mut self.random);
                self.add(side, place, house, &years);
                at += lot;
                place += 1;
            }
        }
    }

    /// A few large buildings, each around its own yard.
    fn courts(&mut self) {
        let is_old = self.era.out < 0;
        let count = if is_old { 1 } else { 2 };
        self.parcels([count, 1], steps(6_000), |this, frame, [width, depth]| {
            let mut years = this.era.years(&mut this.random);
            years.truncate(2);
            let storeys = this.random.range(3, if is_old { 3 } else { 5 });
            let wing = this.random.range(steps(8_500), steps(11_000)).min((width.min(depth) - steps(7_000)) / 2);
            let form = if wing < steps(5_000) { Shape::Flat } else { Shape::Court };
            let house = House {
                form: Form::Plain(form),
                width,
                depth,
                inset: wing.max(0),
                storey: 3_700,
                eaves: storeys * 3_700,
                function: this.random.pick(&[
                    (45, Function::Public),
                    (35, Function::Office),
                    (20, Function::Commercial),
                ]),
                ..House::at(frame)
            };
            (house, years)
        });
    }

    /// Long blocks in parallel, lawns between.
    fn slabs(&mut self) {
        let Some(ground) = yard(&self.corners, steps(5_000)) else { return };
        let deep = steps(self.random.range(10_000, 12_000));
        let apart = steps(self.random.range(18_000, 26_000));
        let storeys = self.random.pick(&[(5, 4), (3, 5), (2, 8)]);
        let form = if storeys < 5 && self.random.chance(50) { Shape::Gable } else { Shape::Flat };
        let first = self.era.first.max(1922) + self.random.range(0, 6);
        let mut place = 0;
        let mut back = 0;
        while back + deep <= ground.depth {
            // Each is made of houses, one for each stair.
            let shift = self.random.range(0, steps(8_000).min(ground.length() / 4));
            let mut at = shift;
            let stair = steps(self.random.range(16_000, 22_000));
            while at + stair <= ground.length() {
                let house = House {
                    form: Form::Plain(form),
                    width: stair,
                    depth: deep,
                    eaves: storeys * 2_800 + 600,
                    rise: if form == Shape::Gable { deep * STEP * 3 / 10 } else { 0 },
                    storey: 2_800,
                    party: [at > shift, at + 2 * stair <= ground.length()],
                    ..House::at(ground.house(at, back))
                };
                self.add(0, place, house, &[first.min(LAST)]);
                place += 1;
                at += stair;
            }
            back += deep + apart;
        }
    }

    /// High buildings on their own ground.
    fn towers(&mut self) {
        // As high as the city is large.
        let reach = 9 + self.plan.last.min(24);
        self.parcels([2, 2], steps(11_000), |this, frame, [width, depth]| {
            let has_podium = this.random.chance(45);
            let storeys = this.random.range(8, reach.max(10));
            let side = this.random.range(steps(16_000), steps(24_000)).min(width.min(depth));
            let year = this.random.range(this.era.first.clamp(1962, 2010), LAST);
            let shape = if has_podium { Shape::Tower } else { Shape::Flat };
            let low = this.random.range(2, 4) * 3_300;
            let house = House {
                form: Form::Plain(shape),
                frame: if has_podium { frame } else { frame.moved((width - side) / 2, (depth - side) / 2) },
                width: if has_podium { width } else { side },
                depth: if has_podium { depth } else { side },
                eaves: if has_podium { low } else { storeys * 3_300 },
                rise: if has_podium { storeys * 3_300 - low } else { 0 },
                inset: (width.min(depth) - steps(17_000)).clamp(steps(2_000), steps(7_000)).min(width.min(depth) / 3),
                storey: 3_300,
                function: this.random.pick(&[
                    (50, Function::Office),
                    (35, Function::Residential),
                    (15, Function::Commercial),
                ]),
                ..House::at(frame)
            };
            let mut years = this.era.years(&mut this.random);
            years.retain(|y| *y < year - 20);
            years.push(year);
            (house, years)
        });
    }

    /// Halls with low roofs.
    fn halls(&mut self) {
        let across = self.random.range(2, 3);
        let along = self.random.range(1, 2);
        self.parcels([across, along], steps(8_000), |this, frame, [width, depth]| {
            let shape = this.random.pick(&[(40, Shape::Flat), (25, Shape::Shed), (35, Shape::Gable)]);
            let run = if shape == Shape::Shed { depth } else { depth / 2 };
            let house = House {
                form: Form::Plain(shape),
                width,
                depth,
                eaves: this.random.range(55, 95) * 100,
                rise: if shape == Shape::Flat { 0 } else { (run * STEP / 6).clamp(900, 3_500) },
                storey: 5_000,
                function: Function::Industrial,
                ..House::at(frame)
            };
            let year = (this.era.first.max(1880) + this.random.range(5, 60)).min(LAST);
            (house, vec![year])
        });
    }

    /// One building in each of so many equal parcels of the yard, so far apart, all looking the same way.
    fn parcels(
        &mut self,
        [across, along]: [i64; 2],
        gap: i64,
        mut make: impl FnMut(&mut Self, Frame, [i64; 2]) -> (House, Vec<i64>),
    ) {
        let Some(ground) = yard(&self.corners, steps(3_000)) else { return };
        let width = (ground.length() - gap * (across - 1)) / across;
        let depth = (ground.depth - gap * (along - 1)) / along;
        if width < steps(9_000) || depth < steps(9_000) {
            return;
        }
        for row in 0..along {
            for column in 0..across {
                let frame = ground.house(column * (width + gap), row * (depth + gap));
                let (house, years) = make(self, frame, [width, depth]);
                self.add(0, row * across + column, house, &years);
            }
        }
    }
}
