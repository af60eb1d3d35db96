//! What stands on the market and beside the old gates: a fountain, stalls, and what is left of the wall.

use crate::city::synth::{
    full::{
        blocks::Block,
        field::{Field, P2, between},
        frame::{Frame, steps},
        house::{Form, Function, House},
        object::{Geometry, Object},
        plan::{Cell, Plan},
        shell::{Shell, Surface},
    },
    random::Random,
};

const STALLS: u64 = 71;
/// The year of the gates.
const WALLED: i64 = 1468;

/// A fountain in the middle of the open half of the market, and stalls around it.
pub fn market(plan: &Plan, block: &Block) -> Vec<Object> {
    let [a, b, c, d] = block.corners;
    let place = |x: i64, y: i64| between(between(a, b, x, 100), between(d, c, x, 100), y, 100);
    let frame = Frame { origin: place(50, 34), ..Frame::towards(a, b) };
    let mut objects = vec![fountain(&plan.field, &frame)];
    let random = &mut Random::at(plan.options.seed, STALLS, block.cell);
    for row in [14, 54] {
        for column in 0..6 {
            if random.chance(78) {
                let at = place(14 + 14 * column, row + random.range(-3, 3));
                objects.push(stall(&plan.field, &Frame { origin: at, ..frame }, objects.len()));
            }
        }
    }
    objects
}

/// An eight-sided basin with a column.
fn fountain(field: &Field, frame: &Frame) -> Object {
    let [r, s] = [steps(3_000), steps(1_250)];
    let ring = [[r, -s], [r, s], [s, r], [-s, r], [-r, s], [-r, -s], [-s, -r], [s, -r]].map(|[x, y]| frame.at(x, y));
    let ground = field.height(frame.origin);
    let column = frame.rectangle([-2, -2], [2, 2]);
    let solid = |footprint: &[P2], low: i64, high: i64| {
        Shell::prism_of(footprint, ground + low, ground + high, [Surface::Plain; 3])
    };
    Object::new("fountain".into(), "CityFurniture")
        .text("class", "fountain")
        .with(Geometry::Solids("2", vec![solid(&ring, -400, 700), solid(&column, 700, 3_600)]))
}

/// A table under a roof on four posts.
fn stall(field: &Field, frame: &Frame, number: usize) -> Object {
    let ground = field.height(frame.origin);
    let solid = |low: [i64; 3], high: [i64; 3]| {
        let footprint = frame.rectangle([low[0], low[1]], [high[0], high[1]]);
        Shell::prism_of(&footprint, ground + low[2], ground + high[2], [Surface::Plain; 3])
    };
    let mut solids = vec![solid([-5, -3, -300], [5, 3, 900]), solid([-7, -5, 2_300], [7, 5, 2_450])];
    for (x, y) in [(-7, -5), (6, -5), (6, 4), (-7, 4)] {
        solids.push(solid([x, y, -300], [x + 1, y + 1, 2_300]));
    }
    Object::new(format!("stall{number}"), "CityFurniture")
        .text("class", "market stall")
        .with(Geometry::Solids("2", solids))
}

/// The gate tower that stands in the street south or west of a cell: the wall is gone, and the boulevard goes around it.
pub fn gate(plan: &Plan, [i, j]: Cell) -> Option<House> {
    let rows = match ([i, j], plan.core) {
        ([i, 0], core) if i == core + 1 => plan.upright_points(i, j),
        ([0, j], core) if j == core + 1 || j == -core => plan.level_points(i, j),
        _ => return None,
    };
    // In the middle of the street, a little away from the crossing.
    let side = steps(7_500);
    let middle = |row: &[P2; 4]| between(row[0], row[3], 1, 2);
    let frame = Frame::towards(middle(&rows[0]), middle(&rows[2]));
    let mut tower = House {
        form: Form::Pyramid,
        width: side,
        depth: side,
        eaves: 16_500,
        rise: 7_500,
        storey: 4_000,
        function: Function::Gate,
        year: WALLED,
        is_fine: true,
        ..House::at(frame.moved(steps(4_000), -side / 2))
    };
    tower.stand(&plan.field);
    Some(tower)
}
