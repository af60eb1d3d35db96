//! Houses: where they stand, what form they have, and their shells in three levels of detail.

use crate::city::synth::{
    full::{
        field::{Field, P2, P3},
        frame::{Frame, STEP, steps},
        shell::{Face, Shell, Surface},
    },
    house::{self, Part, Shape},
};

/// Walls go so far below the lowest ground at them, millimetres.
const SUNK: i64 = 600;
/// Floors lie so far above the highest ground at the front, millimetres.
const STEP_UP: i64 = 150;

/// The form of a house.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One of the plain city.
    Plain(Shape),
    /// Two slopes, the gable at the street.
    Gablet,
    /// Four slopes that meet in a point.
    Pyramid,
}

/// What a building is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Dwellings.
    Residential,
    /// Shops, dwellings above.
    Commercial,
    /// Offices.
    Office,
    /// Schools, baths and the like.
    Public,
    /// Works and stores.
    Industrial,
    /// The church.
    Church,
    /// The town hall.
    TownHall,
    /// Gates of the old wall.
    Gate,
    /// Barns, sheds, garages.
    Outbuilding,
}

/// A house. Lengths along and across are steps of its frame, heights millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct House {
    /// Its form.
    pub form: Form,
    /// Its front left corner, seen from the street.
    pub frame: Frame,
    /// Length along the street, steps.
    pub width: i64,
    /// Length away from it, steps.
    pub depth: i64,
    /// Height of the eaves (of the podium of a tower) above the floor, millimetres.
    pub eaves: i64,
    /// Height of the roof (of a tower's upper part) above the eaves, millimetres.
    pub rise: i64,
    /// Width of wings, depth of a ring, setback of a hip, mansard or tower, steps.
    pub inset: i64,
    /// Height of its floor, millimetres above the river.
    pub floor: i64,
    /// Height of its lowest edge, millimetres above the river.
    pub base: i64,
    /// Height of a storey, millimetres.
    pub storey: i64,
    /// What it is for.
    pub function: Function,
    /// The year from which it stands.
    pub year: i64,
    /// The year in which it was pulled down; `None`: it stands.
    pub end: Option<i64>,
    /// Whether others stand wall to wall with it, at the left and at the right.
    pub party: [bool; 2],
    /// Whether it has a level of detail 3.
    pub is_fine: bool,
}

impl House {
    /// A house at a place, of no size.
    pub fn at(frame: Frame) -> Self {
        Self {
            form: Form::Plain(Shape::Flat),
            frame,
            width: 0,
            depth: 0,
            eaves: 0,
            rise: 0,
            inset: 0,
            floor: 0,
            base: 0,
            storey: 3_000,
            function: Function::Residential,
            year: 0,
            end: None,
            party: [false; 2],
            is_fine: false,
        }
    }

    /// Puts it on the ground.
    pub fn stand(&mut self, field: &Field) {
        let [a, b, c, d] = self.frame.rectangle([0, 0], [self.width, self.depth]).map(|at| field.height(at));
        let middle = field.height(self.frame.at(self.width / 2, self.depth / 2));
        self.floor = a.max(b).max((a + b + c + d) / 4) + STEP_UP;
        self.base = a.min(b).min(c).min(d).min(middle) - SUNK;
    }

    /// Its height above the floor, millimetres.
    pub fn height(&self) -> i64 {
        match self.form {
            Form::Plain(Shape::Flat | Shape::Court) => self.eaves,
            _ => self.eaves + self.rise,
        }
    }

    /// Storeys above the ground; those under the roof do not count.
    pub fn storeys(&self) -> i64 {
        let top = if self.form == Form::Plain(Shape::Tower) { self.height() } else { self.eaves };
        (top / self.storey).max(1)
    }

    /// The area of its storeys, square metres.
    pub fn floor_area(&self) -> i64 {
        let [w, d, i] = [self.width, self.depth, self.inset];
        let of_steps = |area: i64, storeys: i64| area * STEP * STEP / 1_000_000 * storeys;
        match self.form {
            Form::Plain(Shape::Court) => of_steps(w * d - (w - 2 * i) * (d - 2 * i), self.storeys()),
            Form::Plain(Shape::Corner) => of_steps(w * d - (w - i) * (d - i), self.storeys()),
            Form::Plain(Shape::Tower) => {
                let low = (self.eaves / self.storey).max(1);
                of_steps(w * d, low) + of_steps((w - 2 * i) * (d - 2 * i), self.storeys() - low)
            }
            _ => of_steps(w * d, self.storeys()),
        }
    }

    /// What of it is solid from the floor to the eaves: from a corner, with a size, steps.
    pub fn core(&self) -> [P2; 2] {
        let deep = match self.form {
            Form::Plain(Shape::Court | Shape::Corner) => self.inset,
            _ => self.depth,
        };
        [[0, 0], [self.width, deep]]
    }

    /// The shell of level of detail 1: a block.
    pub fn block(&self) -> Shell {
        let [w, d, i] = [self.width, self.depth, self.inset];
        let top = self.floor
            + match self.form {
                Form::Plain(Shape::Tower) => self.height(),
                _ => self.eaves + (self.height() - self.eaves) / 2,
            };
        let footprint: Vec<P2> = match self.form {
            Form::Plain(Shape::Court) => return self.shell(),
            Form::Plain(Shape::Corner) => vec![[0, 0], [w, 0], [w, i], [i, i], [i, d], [0, d]],
            _ => vec![[0, 0], [w, 0], [w, d], [0, d]],
        };
        let footprint: Vec<P2> = footprint.into_iter().map(|[x, y]| self.frame.at(x, y)).collect();
        Shell::prism(&footprint, self.base, top)
    }

    /// The shell of level of detail 2.
    pub fn shell(&self) -> Shell {
        let points = self.local().into_iter().map(|at| self.placed(at)).collect();
        Shell { points, faces: self.faces() }
    }

    /// The shell of level of detail 3: windows and a door set into the walls.
    pub fn fine_shell(&self) -> Shell {
        let mut points = self.local();
        let mut faces = Vec::new();
        let mut has_door = false;
        for (surface, mut rings) in self.faces() {
            if surface == Surface::Wall {
                let openings = self.openings(&points, &rings[0], &mut has_door);
                for opening in openings {
                    opening.cut(&mut points, &mut rings, &mut faces);
                }
            }
            faces.push((surface, rings));
        }
        Shell { points: points.into_iter().map(|at| self.placed(at)).collect(), faces }
    }

    /// Chimneys and dormers.
    pub fn on_the_roof(&self) -> Vec<Shell> {
        if self.function == Function::Industrial {
            return Vec::new();
        }
        let [w, d] = [self.width, self.depth];
        let top = self.eaves + self.rise;
        let mut boxes: Vec<[P3; 2]> = Vec::new();
        let mut chimney = |x: i64, y: i64| boxes.push([[x, y, self.eaves], [x + 2, y + 3, top + 800]]);
        match self.form {
            Form::Plain(Shape::Gable) => chimney(1, d / 2 - 1),
            Form::Gablet => chimney(w / 2 - 1, (d / 2).max(2)),
            Form::Plain(Shape::Hip) => chimney(self.inset + 1, d / 2 - 1),
            Form::Plain(Shape::Mansard) => chimney(self.inset + 1, d / 2),
            _ => return Vec::new(),
        }
        self.dormers(&mut boxes);
        boxes.into_iter().map(|[low, high]| self.block_between(low, high)).collect()
    }

    /// Dormers in the slope at the street, where there is room.
    fn dormers(&self, boxes: &mut Vec<[P3; 2]>) {
        // Steps from the eaves to where the slope ends.
        let run = match self.form {
            Form::Plain(Shape::Gable) => self.depth / 2,
            Form::Plain(Shape::Mansard) => self.inset,
            _ => return,
        };
        let is_mansard = run == self.inset && self.form == Form::Plain(Shape::Mansard);
        if self.rise < 2_600 || run == 0 {
            return;
        }
        let start = if is_mansard { 1 } else { steps(900) };
        let sill = self.eaves + self.rise * start / run;
        let head = (sill + 1_500).min(self.eaves + self.rise - if is_mansard { 0 } else { 500 });
        // One step behind where the slope is as high as the dormer.
        let back = ((head - self.eaves) * run + self.rise - 1) / self.rise + 1;
        let margin = if is_mansard { self.inset + 2 } else { 4 };
        let count = (self.width - 2 * margin + 6) / 12;
        for k in 0..count {
            let middle = margin + (self.width - 2 * margin) * (2 * k + 1) / (2 * count);
            boxes.push([[middle - 3, start, sill - 300], [middle + 3, back.min(self.depth - 1), head]]);
        }
    }

    /// An upright box in its frame, heights above its floor.
    pub fn block_between(&self, low: P3, high: P3) -> Shell {
        let footprint = self.frame.rectangle([low[0], low[1]], [high[0], high[1]]);
        Shell::prism(&footprint, self.floor + low[2], self.floor + high[2])
    }

    /// A point of its frame in the city's.
    fn placed(&self, [x, y, z]: P3) -> P3 {
        let [px, py] = self.frame.at(x, y);
        [px, py, self.floor + z]
    }

    /// Its points in its own frame: steps, and millimetres above the floor.
    fn local(&self) -> Vec<P3> {
        let [w, d, e, i] = [self.width, self.depth, self.eaves, self.inset];
        let (low, top) = (self.base - self.floor, self.eaves + self.rise);
        let rectangle = |inset: i64, z: i64| {
            [[inset, inset, z], [w - inset, inset, z], [w - inset, d - inset, z], [inset, d - inset, z]]
        };
        let outline = [rectangle(0, low), rectangle(0, e)];
        let ridge = |points: [P3; 2]| [&outline.concat()[..], &points[..]].concat();
        match self.form {
            Form::Plain(Shape::Flat) => outline.concat(),
            Form::Plain(Shape::Shed) => [rectangle(0, low), [[0, 0, e], [w, 0, e], [w, d, top], [0, d, top]]].concat(),
            Form::Plain(Shape::Gable) => ridge([[0, d / 2, top], [w, d / 2, top]]),
            Form::Plain(Shape::Hip) => ridge([[i, d / 2, top], [w - i, d / 2, top]]),
            Form::Plain(Shape::Mansard) => [outline[0], outline[1], rectangle(i, top)].concat(),
            Form::Plain(Shape::Corner) => {
                let at = |z: i64| [[0, 0, z], [w, 0, z], [w, i, z], [i, i, z], [i, d, z], [0, d, z]];
                let ridge = [[w, i / 2, top], [i / 2, i / 2, top], [i / 2, d, top]];
                [&at(low)[..], &at(e)[..], &ridge[..]].concat()
            }
            Form::Plain(Shape::Court) => {
                [rectangle(0, low), rectangle(i, low), rectangle(0, e), rectangle(i, e)].concat()
            }
            Form::Plain(Shape::Tower) => [outline[0], outline[1], rectangle(i, e), rectangle(i, top)].concat(),
            Form::Gablet => ridge([[w / 2, 0, top], [w / 2, d, top]]),
            Form::Pyramid => [&outline.concat()[..], &[[w / 2, d / 2, top]]].concat(),
        }
    }

    /// The faces of its shell over [`Self::local`].
    fn faces(&self) -> Vec<Face> {
        let table: &[house::Face] = match self.form {
            Form::Plain(shape) => shape.faces(),
            Form::Gablet => GABLET,
            Form::Pyramid => PYRAMID,
        };
        let surface = |part: Part| match part {
            Part::Ground => Surface::Ground,
            Part::Wall => Surface::Wall,
            Part::Roof => Surface::Roof,
        };
        let rings = |rings: &[&[u8]]| rings.iter().map(|ring| ring.iter().map(|i| u32::from(*i)).collect()).collect();
        table.iter().map(|(part, of_face)| (surface(*part), rings(of_face))).collect()
    }

    /// Windows and doors of a wall whose ring begins with its lower edge.
    fn openings(&self, points: &[P3], ring: &[u32], has_door: &mut bool) -> Vec<Opening> {
        let [a, b] = [points[ring[0] as usize], points[ring[1] as usize]];
        let step = [(b[0] - a[0]).signum(), (b[1] - a[1]).signum()];
        let length = (b[0] - a[0]).abs() + (b[1] - a[1]).abs();
        let is_party = match step[1] {
            0 => false,
            1.. => self.party[1],
            _ => self.party[0],
        };
        if length < 10 || is_party {
            return Vec::new();
        }
        let top = ring[2..].iter().map(|i| points[*i as usize][2]).min().unwrap_or(0);
        let low = a[2].max(0);
        let columns = (length - 2) / 9;
        let mut openings = Vec::new();
        for storey in 0.. {
            let sill = low + storey * self.storey + 900;
            let head = sill + self.storey / 2;
            if head + 250 > top {
                break;
            }
            for column in 0..columns {
                let middle = length * (2 * column + 1) / (2 * columns);
                let is_door = !*has_door && storey == 0 && low == 0 && column == columns / 2;
                *has_door |= is_door;
                let (surface, sill) = if is_door { (Surface::Door, low + 100) } else { (Surface::Window, sill) };
                openings.push(Opening {
                    surface,
                    start: a,
                    step,
                    along: [middle - 2, middle + 2],
                    heights: [sill, head],
                });
            }
        }
        openings
    }
}

/// An opening in a wall.
struct Opening {
    surface: Surface,
    /// Where the wall begins, and a step along it.
    start: P3,
    step: P2,
    /// From where to where along the wall, steps.
    along: [i64; 2],
    /// From where to where above the floor, millimetres.
    heights: [i64; 2],
}

impl Opening {
    /// Cuts it into a wall: a hole, what is set back in it by a step, and the four faces between.
    fn cut(&self, points: &mut Vec<P3>, rings: &mut Vec<Vec<u32>>, faces: &mut Vec<Face>) {
        let [from, to] = self.along;
        let [low, high] = self.heights;
        let [sx, sy] = self.step;
        let first = points.len() as u32;
        for back in [0, 1] {
            for (along, z) in [(from, low), (to, low), (to, high), (from, high)] {
                points.push([self.start[0] + along * sx - back * sy, self.start[1] + along * sy + back * sx, z]);
            }
        }
        rings.push([3, 2, 1, 0].map(|i| first + i).to_vec());
        faces.push((self.surface, vec![[4, 5, 6, 7].map(|i| first + i).to_vec()]));
        for i in 0..4 {
            let next = (i + 1) % 4;
            faces.push((Surface::Wall, vec![[i, next, 4 + next, 4 + i].map(|k| first + k).to_vec()]));
        }
    }
}

use Part::{Ground, Roof, Wall};

const GABLET: &[house::Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 8, 4]]),
    (Wall, &[&[1, 2, 6, 5]]),
    (Wall, &[&[2, 3, 7, 9, 6]]),
    (Wall, &[&[3, 0, 4, 7]]),
    (Roof, &[&[5, 6, 9, 8]]),
    (Roof, &[&[7, 4, 8, 9]]),
];

const PYRAMID: &[house::Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 4]]),
    (Wall, &[&[1, 2, 6, 5]]),
    (Wall, &[&[2, 3, 7, 6]]),
    (Wall, &[&[3, 0, 4, 7]]),
    (Roof, &[&[4, 5, 8]]),
    (Roof, &[&[5, 6, 8]]),
    (Roof, &[&[6, 7, 8]]),
    (Roof, &[&[7, 4, 8]]),
];
