//! Trees: three templates, and where they stand.

use crate::city::synth::{
    full::{
        blocks::{Block, Kind},
        field::{Field, P2, between, distance},
        object::{Geometry, Object},
        plan::{Cell, Plan, Street},
        shell::{Shell, Surface},
        streets::Across,
    },
    random::Random,
};

const TREES: u64 = 51;

/// The kinds of trees: template, Latin name, height of a grown one, millimetres. Templates are about a metre high.
const SPECIES: [(usize, &str, i64); 5] = [
    (0, "Tilia cordata", 15_000),
    (0, "Platanus x hispanica", 18_000),
    (1, "Malus domestica", 6_500),
    (1, "Acer campestre", 9_000),
    (2, "Picea abies", 17_000),
];
/// Turns without rounding: cosine and sine, thousandths.
const TURNS: [P2; 8] =
    [[1000, 0], [960, 280], [800, 600], [600, 800], [280, 960], [-600, 800], [-960, 280], [-280, -960]];

/// The templates: closed shells of trees a metre high, points in thousandths of it.
pub fn templates() -> Vec<(&'static str, Vec<Shell>)> {
    let trunk = |half: i64, top: i64| prism_ring(&[(half, -40), (half, top)]);
    vec![
        ("2", vec![trunk(20, 340), prism_ring(&[(90, 280), (250, 480), (260, 680), (110, 1000)])]),
        ("2", vec![trunk(20, 300), prism_ring(&[(140, 230), (360, 500), (330, 760), (150, 1000)])]),
        ("2", vec![trunk(20, 200), prism_ring(&[(190, 130), (120, 480), (20, 1000)])]),
    ]
}

/// A closed shell of six-sided rings, each of a radius at a height, one above the other.
fn prism_ring(rings: &[(i64, i64)]) -> Shell {
    // Corners of a hexagon about 10 wide to a side; rings are whole multiples of it, so that faces between them are planar.
    const HEXAGON: [P2; 6] = [[10, 0], [5, 9], [-5, 9], [-10, 0], [-5, -9], [5, -9]];
    let mut shell = Shell::default();
    for (radius, z) in rings {
        shell.points.extend(HEXAGON.map(|[x, y]| [x * (radius / 10), y * (radius / 10), *z]));
    }
    let at = |ring: usize, k: u32| ring as u32 * 6 + k % 6;
    shell.faces.push((Surface::Plain, vec![(0..6).rev().collect()]));
    for ring in 0..rings.len() - 1 {
        for k in 0..6 {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            shell.faces.push((Surface::Plain, vec![vec![a, b, c, d]]));
        }
    }
    shell.faces.push((Surface::Plain, vec![(0..6).map(|k| at(rings.len() - 1, k)).collect()]));
    shell
}

/// Plants trees of one cell, and counts them.
pub struct Planter<'a> {
    field: &'a Field,
    random: Random,
    cell: Cell,
    place: &'static str,
    count: u64,
    /// The trees so far.
    pub trees: Vec<Object>,
}

impl<'a> Planter<'a> {
    /// For the trees of a cell; `place` is a word of their ids: in the yard or in the street.
    pub fn new(plan: &'a Plan, cell: Cell, place: &'static str) -> Self {
        let random = Random::at(plan.options.seed, TREES + place.len() as u64, cell);
        Self { field: &plan.field, random, cell, place, count: 0, trees: Vec::new() }
    }

    /// A tree of a kind, here.
    fn plant(&mut self, at: P2, species: usize) {
        let (template, name, grown) = SPECIES[species];
        let height = grown * self.random.range(62, 112) / 100 / 100 * 100;
        let [c, s] = TURNS[self.random.range(0, TURNS.len() as i64 - 1) as usize];
        self.count += 1;
        let [i, j] = self.cell;
        let scale = [c * height / 1000, s * height / 1000, height];
        let tree = Object::new(format!("{}-tree{i}_{j}_{}", self.place, self.count), "SolitaryVegetationObject")
            .text("species", name)
            .length("height", height)
            .with(Geometry::Instance(template, self.field.ground(at), scale));
        self.trees.push(tree);
    }

    /// Trees along a street, on both pavements.
    pub fn line(&mut self, street: Street, points: &[Across]) {
        let (apart, species) = match street {
            Street::Boulevard => (11_000, 1),
            Street::Main => (17_000, 0),
            Street::Avenue if self.random.chance(45) => (15_000, 3),
            Street::River => (14_000, 0),
            _ => return,
        };
        let sides: &[bool] = if street == Street::River { &[true] } else { &[false, true] };
        for is_far in sides {
            let place = |row: &Across| {
                if *is_far { between(row[2], row[3], 40, 100) } else { between(row[0], row[1], 60, 100) }
            };
            let (a, b) = (place(&points[0]), place(&points[points.len() - 1]));
            let count = distance(a, b) / apart;
            for k in 0..count {
                // Along the points, which bend at quays.
                let parts = points.len() as i64 - 1;
                let at = (2 * k + 1) * parts * 500 / count;
                let (from, part) = ((at / 1000).min(parts - 1) as usize, at % 1000);
                let at = between(place(&points[from]), place(&points[from + 1]), part, 1000);
                if !self.random.chance(7) {
                    self.plant(at, species);
                }
            }
        }
    }

    /// Trees of a block, where no house is.
    pub fn block(&mut self, block: &Block) {
        let (count, kinds): (i64, &[(i64, usize)]) = match block.kind {
            Kind::Park => (self.random.range(36, 60), &[(4, 0), (2, 1), (2, 3), (1, 4)]),
            Kind::Wood => (self.random.range(70, 110), &[(3, 4), (2, 3), (1, 0)]),
            Kind::Square => (self.random.range(8, 18), &[(4, 0), (1, 1)]),
            Kind::Field if self.random.chance(40) => (self.random.range(2, 9), &[(3, 2), (1, 0)]),
            Kind::Field | Kind::Market => return,
            Kind::Villas => (self.random.range(14, 26), &[(3, 2), (3, 3), (1, 4), (1, 0)]),
            Kind::Terraces => (self.random.range(8, 18), &[(4, 2), (2, 3)]),
            Kind::Slabs | Kind::Towers => (self.random.range(8, 20), &[(2, 0), (3, 3)]),
            Kind::Perimeter | Kind::Courts => (self.random.range(4, 10), &[(1, 0), (3, 3)]),
            Kind::OldTown => (self.random.range(0, 4), &[(2, 2), (1, 3)]),
            Kind::Close => (14, &[(3, 0)]),
            Kind::Halls => (self.random.range(0, 5), &[(1, 3)]),
        };
        let near = if block.kind == Kind::OldTown { 1_200 } else { 2_500 };
        let [a, b, c, d] = block.corners;
        for _ in 0..count {
            let (s, t) = (self.random.range(25, 975), self.random.range(25, 975));
            let at = between(between(a, b, s, 1000), between(d, c, s, 1000), t, 1000);
            let species = self.random.pick(kinds);
            if !block.is_built(at, near) {
                self.plant(at, species);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_are_closed_and_planar() {
        for (_, shells) in templates() {
            for shell in shells {
                crate::city::synth::full::tests::check_shell(&shell, "tree");
            }
        }
    }
}
