//! The town hall at the market: storeys, units, rooms with floors, doors and furniture, and stairs between them.
//!
//! ```text
//!  ┌──────┬──────┬───────┬──────┬──────┐
//!  │ room │ room │ stairs│ room │ room │   three storeys of this; a unit at either side of the stairs
//!  ├──────┴──────┴───────┴──────┴──────┤
//!  │             corridor              │
//!  ├───────┬────────┬────────┬─────────┤
//!  │ room  │  room  │  room  │  room   │
//!  └───────┴────────┴────────┴─────────┘
//! ```

use crate::city::synth::{
    full::{
        blocks::Block,
        field::{P2, P3},
        frame::{Frame, Strip, steps},
        house::{Form, Function, House},
        object::{Geometry, Object},
        plan::Plan,
        shell::{Shell, Surface},
    },
    house::Shape,
};

const WIDTH: i64 = steps(30_000);
const DEPTH: i64 = steps(15_000);
const STOREY: i64 = 3_600;
const STOREYS: i64 = 3;
/// Height of rooms, millimetres.
const CLEAR: i64 = 3_300;
/// Thickness of the outer walls, steps.
const WALL: i64 = 2;
/// The year in which it was built.
const BUILT: i64 = 1612;

/// A room of each storey: its name, what unit it is of, its corners in steps, and in which of its walls its door is.
struct Plot {
    name: &'static str,
    unit: Option<usize>,
    low: P2,
    high: P2,
    door: Door,
}

/// Where the door of a room is.
#[derive(Clone, Copy, PartialEq)]
enum Door {
    South,
    North,
    None,
}

const UNITS: [&str; 2] = ["registry", "council"];

const PLOTS: [Plot; 10] = [
    Plot { name: "room-1", unit: Some(0), low: [WALL, WALL], high: [30, 25], door: Door::North },
    Plot { name: "room-2", unit: Some(0), low: [31, WALL], high: [59, 25], door: Door::North },
    Plot { name: "room-3", unit: Some(1), low: [60, WALL], high: [89, 25], door: Door::North },
    Plot { name: "room-4", unit: Some(1), low: [90, WALL], high: [WIDTH - WALL, 25], door: Door::North },
    Plot { name: "corridor", unit: None, low: [WALL, 26], high: [WIDTH - WALL, 34], door: Door::None },
    Plot { name: "room-5", unit: Some(0), low: [WALL, 35], high: [25, DEPTH - WALL], door: Door::South },
    Plot { name: "room-6", unit: Some(0), low: [26, 35], high: [49, DEPTH - WALL], door: Door::South },
    Plot { name: "stairwell", unit: None, low: [50, 35], high: [70, DEPTH - WALL], door: Door::South },
    Plot { name: "room-7", unit: Some(1), low: [71, 35], high: [94, DEPTH - WALL], door: Door::South },
    Plot { name: "room-8", unit: Some(1), low: [95, 35], high: [WIDTH - WALL, DEPTH - WALL], door: Door::South },
];

/// The town hall as a building: at the north side of the market, its front to the south.
pub fn hall(plan: &Plan, block: &Block) -> Option<House> {
    let strip = Strip::along(&block.corners, 2, steps(1_500), DEPTH, &[])?;
    let spare = strip.length() - WIDTH;
    if spare < 0 {
        return None;
    }
    let back = strip.house(spare / 2, 0);
    let turned = Frame { u: back.u.map(|a| -a), v: back.v.map(|a| -a), ..back.moved(WIDTH, DEPTH) };
    let mut house = House {
        form: Form::Plain(Shape::Hip),
        width: WIDTH,
        depth: DEPTH,
        eaves: STOREYS * STOREY + 600,
        rise: 5_500,
        inset: DEPTH / 2 - 2,
        storey: STOREY,
        function: Function::TownHall,
        year: BUILT,
        is_fine: true,
        ..House::at(turned)
    };
    house.stand(&plan.field);
    Some(house)
}

/// What is in it: storeys, each with its rooms, units and stairs. The building itself gets the storeys as children.
pub fn inside(hall: &House, building: &mut Object) -> Vec<Object> {
    let mut objects = Vec::new();
    for level in 0..STOREYS {
        let prefix = format!("{}-storey{level}", building.id);
        let mut storey = Object::new(prefix.clone(), "BuildingStorey")
            .whole("storeyNumber", level)
            .length("elevation", level * STOREY)
            .child_of(building);
        let mut below = Vec::new();
        let mut units: Vec<Object> = UNITS
            .iter()
            .map(|name| {
                Object::new(format!("{prefix}-{name}"), "BuildingUnit").text("function", *name).child_of(&mut storey)
            })
            .collect();
        for plot in &PLOTS {
            let mut room = Object::new(format!("{prefix}-{}", plot.name), "BuildingRoom")
                .text("function", if plot.unit.is_some() { "office" } else { plot.name })
                .with(Geometry::Solid("3", plot.shell(hall, level)));
            room = room.child_of(plot.unit.map_or(&mut storey, |unit| &mut units[unit]));
            if plot.unit.is_some() {
                let furniture = Object::new(format!("{}-desk", room.id), "BuildingFurniture")
                    .text("function", "desk")
                    .with(Geometry::Solids("3", plot.desk(hall, level)))
                    .child_of(&mut room);
                below.push(furniture);
            }
            below.push(room);
        }
        if level + 1 < STOREYS {
            let stairs = Object::new(format!("{prefix}-stairs"), "BuildingInstallation")
                .text("function", "stairs")
                .with(Geometry::Solid("3", stairs(hall, level)))
                .child_of(&mut storey);
            below.push(stairs);
        }
        objects.push(storey);
        objects.extend(units);
        objects.extend(below);
    }
    objects
}

impl Plot {
    /// The room: closed, its faces seen from outside it; the door lies in its wall.
    fn shell(&self, hall: &House, level: i64) -> Shell {
        let [low, high] = [hall.floor + level * STOREY, hall.floor + level * STOREY + CLEAR];
        let corners = hall.frame.rectangle(self.low, self.high);
        let mut shell = Shell::prism_of(&corners, low, high, [Surface::Floor, Surface::InteriorWall, Surface::Ceiling]);
        let middle = (self.low[0] + self.high[0]) / 2;
        // Face 1 is the south wall, 3 the north one; each seen from outside.
        let (face, along, y) = match self.door {
            Door::South => (1, [middle - 2, middle + 2], self.low[1]),
            Door::North => (3, [middle + 2, middle - 2], self.high[1]),
            Door::None => return shell,
        };
        let first = shell.points.len() as u32;
        for (x, z) in [(along[0], low + 50), (along[1], low + 50), (along[1], low + 2_150), (along[0], low + 2_150)] {
            let [px, py] = hall.frame.at(x, y);
            shell.points.push([px, py, z]);
        }
        shell.faces[face].1.push([3, 2, 1, 0].map(|i| first + i).to_vec());
        shell.faces.push((Surface::Door, vec![[0, 1, 2, 3].map(|i| first + i).to_vec()]));
        shell
    }

    /// A desk: a top on two sides, in the middle of the room, and a cupboard at its wall.
    fn desk(&self, hall: &House, level: i64) -> Vec<Shell> {
        let floor = level * STOREY;
        let [x, y] = [0, 1].map(|k| (self.low[k] + self.high[k]) / 2);
        let solid = |low: P3, high: P3| {
            let footprint = hall.frame.rectangle([low[0], low[1]], [high[0], high[1]]);
            let [low, high] = [low[2], high[2]].map(|z| hall.floor + floor + z);
            Shell::prism_of(&footprint, low, high, [Surface::Plain; 3])
        };
        vec![
            solid([x - 3, y - 2, 700], [x + 3, y + 2, 740]),
            solid([x - 3, y - 2, 0], [x - 2, y + 2, 700]),
            solid([x + 2, y - 2, 0], [x + 3, y + 2, 700]),
            solid([self.low[0], self.low[1] + 4, 0], [self.low[0] + 2, self.low[1] + 12, 2_000]),
        ]
    }
}

/// A flight of stairs from a storey to the next: one closed solid.
fn stairs(hall: &House, level: i64) -> Shell {
    let count = STOREY / 300;
    let floor = hall.floor + level * STOREY;
    // The profile, from the foot along the ground, up at the end, and down the steps.
    let mut profile: Vec<P2> = vec![[54, 0], [54 + count, 0]];
    for step in (0..count).rev() {
        profile.push([54 + step + 1, 300 * (step + 1)]);
        profile.push([54 + step, 300 * (step + 1)]);
    }
    let n = profile.len() as u32;
    let at = |y: i64| {
        profile.iter().map(move |[x, z]| {
            let [px, py] = hall.frame.at(*x, y);
            [px, py, floor + z]
        })
    };
    let points: Vec<P3> = at(40).chain(at(46)).collect();
    let mut faces = vec![(Surface::Plain, vec![(0..n).collect()]), (Surface::Plain, vec![(n..2 * n).rev().collect()])];
    faces.extend((0..n).map(|i| {
        let next = (i + 1) % n;
        (Surface::Plain, vec![vec![next, i, n + i, n + next]])
    }));
    Shell { points, faces }
}
