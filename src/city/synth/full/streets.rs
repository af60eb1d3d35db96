//! Streets, squares, river and the ground of blocks: nets of triangles that meet in the same points, so that no gap is
//! between them and nothing lies on anything else.
//!
//! ```text
//!   block │ p │   road   │ p │ block      an edge: three lanes between the sides of two blocks, cut in `PARTS`
//!  ───────┼───┼──────────┼───┼───────
//!    p    │ p │          │ p │   p        a crossing: four corners of pavement, the rest road
//! ```

use crate::city::synth::full::{
    field::{Field, P2, P3, QUAY, between},
    plan::{Cell, Plan, RIVER, Street},
    shell::{Shell, Surface},
};

/// The sides of blocks are cut in so many parts.
pub const PARTS: i64 = 4;
/// The width of a quay, millimetres.
const QUAY_WIDTH: i64 = 11_000;
/// The width of the slope from the quay to the water, millimetres.
const BANK: i64 = 3_500;

/// Points across a street: its sides and those of its road.
pub type Across = [P2; 4];

impl Plan {
    /// Points of side `k` of a block: south, east, north, west; west to east and south to north.
    pub fn side(&self, cell: Cell, k: usize) -> Vec<P2> {
        let block = self.block(cell);
        let (a, b) = [(0, 1), (1, 2), (3, 2), (0, 3)][k];
        (0..=PARTS).map(|part| between(block[a], block[b], part, PARTS)).collect()
    }

    /// Points across the street in line `i` along row `j`, from west to east; from south to north. Not of the river.
    pub fn upright_points(&self, i: i64, j: i64) -> Vec<Across> {
        let pavement = self.upright(i, j).pavement();
        let (west, east) = (self.side([i - 1, j], 1), self.side([i, j], 3));
        west.iter().zip(&east).map(|(w, e)| across(*w, *e, pavement)).collect()
    }

    /// Points across the street in line `j` along column `i`, from south to north; from west to east.
    pub fn level_points(&self, i: i64, j: i64) -> Vec<Across> {
        let pavement = self.level(i, j).pavement();
        let (south, north) = (self.side([i, j - 1], 2), self.side([i, j], 0));
        south.iter().zip(&north).map(|(s, n)| across(*s, *n, pavement)).collect()
    }

    /// Points across a quay along row `j`, from the block to the water, from south to north.
    pub fn quay_points(&self, is_east: bool, j: i64) -> Vec<Across> {
        let cell = [self.river() - i64::from(!is_east), j];
        let side = self.side(cell, if is_east { 3 } else { 1 });
        let edge = self.quay_edge(is_east, j, RIVER - QUAY_WIDTH);
        side.iter().zip(&edge).map(|(a, b)| across(*a, *b, Street::River.pavement())).collect()
    }

    /// A line beside the river along row `j`, so far from its middle on the straight plan.
    fn quay_edge(&self, is_east: bool, j: i64, away: i64) -> Vec<P2> {
        let river = self.river();
        let straight = self.straight([river - i64::from(!is_east), j]);
        let (south, north) = if is_east { (straight[0][1], straight[3][1]) } else { (straight[1][1], straight[2][1]) };
        let p = self.east(river) + if is_east { away } else { -away };
        (0..=PARTS).map(|part| self.field.place(between([p, south], [p, north], part, PARTS))).collect()
    }

    /// The water's edge along row `j`, from south to north.
    pub fn water_edge(&self, is_east: bool, j: i64) -> Vec<P2> {
        self.quay_edge(is_east, j, RIVER - QUAY_WIDTH - BANK)
    }
}

/// Points across a street, its pavements so many thousandths of its width.
fn across(a: P2, b: P2, pavement: i64) -> Across {
    [a, between(a, b, pavement, 1000), between(a, b, 1000 - pavement, 1000), b]
}

fn lane(i: usize, _: usize) -> Surface {
    if i == 1 { Surface::Traffic } else { Surface::Pavement }
}

/// What the lanes of a street are.
fn lanes(street: Street) -> impl Fn(usize, usize) -> Surface {
    move |i, j| if street == Street::Path { Surface::Pavement } else { lane(i, j) }
}

fn crossing(i: usize, j: usize) -> Surface {
    if i == 1 || j == 1 { Surface::Traffic } else { Surface::Pavement }
}

/// The street in line `i` along row `j`, which is not the river.
pub fn upright(plan: &Plan, i: i64, j: i64) -> Shell {
    let mut shell = Shell::default();
    let rows: Vec<Vec<P3>> =
        plan.upright_points(i, j).iter().map(|row| row.map(|at| plan.field.ground(at)).to_vec()).collect();
    shell.net(&rows, lanes(plan.upright(i, j)));
    shell
}

/// The street in line `j` along column `i`.
pub fn level(plan: &Plan, i: i64, j: i64) -> Shell {
    let mut shell = Shell::default();
    let across = plan.level_points(i, j);
    let row = |k: usize| across.iter().map(|points| plan.field.ground(points[k])).collect();
    let rows: Vec<Vec<P3>> = (0..4).map(row).collect();
    let lanes = lanes(plan.level(i, j));
    shell.net(&rows, |i, j| lanes(j, i));
    shell
}

/// The crossing of lines `i` and `j`, where the river is not.
pub fn crossing_of(plan: &Plan, i: i64, j: i64) -> Shell {
    let (south, north) = (plan.upright_points(i, j - 1), plan.upright_points(i, j));
    let (west, east) = (plan.level_points(i - 1, j), plan.level_points(i, j));
    let last = PARTS as usize;
    let middle = plan.field.place([plan.east(i), plan.north(j)]);
    patch(&plan.field, [&south[last], &north[0], &west[last], &east[0]], middle)
}

/// A net over four sides that meet in their corners: south and north from west to east, west and east from south to north.
/// All of them are seen from `middle`, so its inner corners, on the way there, fold nothing.
fn patch(field: &Field, [south, north, west, east]: [&Across; 4], middle: P2) -> Shell {
    let inner = |corner: P2| between(corner, middle, 45, 100);
    let mut shell = Shell::default();
    let rows: Vec<Vec<P3>> = (0..4)
        .map(|j| {
            let row: Across = match j {
                0 => *south,
                1 => [west[1], inner(south[0]), inner(south[3]), east[1]],
                2 => [west[2], inner(north[0]), inner(north[3]), east[2]],
                _ => *north,
            };
            row.map(|at| field.ground(at)).to_vec()
        })
        .collect();
    shell.net(&rows, crossing);
    shell
}

/// The two quays along row `j` and where they meet the street in line `j`.
pub fn quays(plan: &Plan, j: i64) -> Shell {
    let mut shell = Shell::default();
    let ground = |row: &Across| row.map(|at| plan.field.ground(at)).to_vec();
    let reversed = |row: &Across| [row[3], row[2], row[1], row[0]];
    let [west, east] = [false, true].map(|is_east| plan.quay_points(is_east, j));
    shell.net(&west.iter().map(ground).collect::<Vec<_>>(), lane);
    shell.net(&east.iter().map(|row| ground(&reversed(row))).collect::<Vec<_>>(), lane);
    let [west_before, east_before] = [false, true].map(|is_east| plan.quay_points(is_east, j - 1));
    let last = PARTS as usize;
    let (river, pavement) = (plan.river(), Street::Main.pavement());
    let middle = |south: &Across, north: &Across| {
        between(between(south[0], south[3], 1, 2), between(north[0], north[3], 1, 2), 1, 2)
    };
    let (south, north) = (west_before[last], west[0]);
    let street = plan.level_points(river - 1, j)[last];
    add(
        &mut shell,
        patch(&plan.field, [&south, &north, &street, &across(south[3], north[3], pavement)], middle(&south, &north)),
    );
    let (south, north) = (reversed(&east_before[last]), reversed(&east[0]));
    let street = plan.level_points(river, j)[0];
    add(
        &mut shell,
        patch(&plan.field, [&south, &north, &across(south[0], north[0], pavement), &street], middle(&south, &north)),
    );
    shell
}

/// Adds the faces of another shell.
pub fn add(shell: &mut Shell, other: Shell) {
    let first = shell.points.len() as u32;
    shell.points.extend(other.points);
    shell.faces.extend(other.faces.into_iter().map(|(surface, mut rings)| {
        rings.iter_mut().flatten().for_each(|i| *i += first);
        (surface, rings)
    }));
}

/// The river along row `j` and below line `j`: its water, and the walls of its quays.
pub struct RiverPart {
    /// The water, level.
    pub water: Shell,
    /// The slopes at its sides.
    pub banks: Shell,
}

/// The part of the river along row `j` with what of it is below line `j`.
pub fn river(plan: &Plan, j: i64) -> RiverPart {
    let along = |is_east: bool, lines: &dyn Fn(bool, i64) -> Vec<P2>| -> Vec<P2> {
        let before = lines(is_east, j - 1);
        std::iter::once(before[PARTS as usize]).chain(lines(is_east, j)).collect()
    };
    let water = |is_east| along(is_east, &|is_east, j| plan.water_edge(is_east, j));
    let quay =
        |is_east| along(is_east, &|is_east, j| plan.quay_points(is_east, j).into_iter().map(|row| row[3]).collect());
    let level = |points: [P2; 2], heights: [i64; 2]| {
        [[points[0][0], points[0][1], heights[0]], [points[1][0], points[1][1], heights[1]]].to_vec()
    };
    let [(west, west_top), (east, east_top)] = [false, true].map(|is_east| (water(is_east), quay(is_east)));
    let mut part = RiverPart { water: Shell::default(), banks: Shell::default() };
    let rows = |a: &[P2], b: &[P2], heights: [i64; 2]| -> Vec<Vec<P3>> {
        a.iter().zip(b).map(|(a, b)| level([*a, *b], heights)).collect()
    };
    part.water.net(&rows(&west, &east, [0, 0]), |_, _| Surface::Water);
    part.banks.net(&rows(&west_top, &west, [QUAY, 0]), |_, _| Surface::Plain);
    part.banks.net(&rows(&east, &east_top, [0, QUAY]), |_, _| Surface::Plain);
    part
}

/// The ground of a block: a net over its sides.
pub fn ground(plan: &Plan, cell: Cell) -> Shell {
    let mut shell = Shell::default();
    let [west, east] = [3, 1].map(|k| plan.side(cell, k));
    let [south, north] = [0, 2].map(|k| plan.side(cell, k));
    let row = |j: usize| -> Vec<P3> {
        let points: Vec<P2> = match j {
            0 => south.clone(),
            _ if j == PARTS as usize => north.clone(),
            _ => (0..=PARTS).map(|part| between(west[j], east[j], part, PARTS)).collect(),
        };
        points.into_iter().map(|at| plan.field.ground(at)).collect()
    };
    let rows: Vec<Vec<P3>> = (0..=PARTS as usize).map(row).collect();
    shell.net(&rows, |_, _| Surface::Plain);
    shell
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::city::synth::{SynthOptions, full::plan::Cells};

    /// All faces of the ground of the cells around the middle, each with where it is from.
    fn faces(plan: &Plan, rings: i64) -> Vec<Vec<P3>> {
        let mut all = Vec::new();
        for [i, j] in Cells::default().take_while(|cell| Plan::ring(*cell) <= rings) {
            let mut shells = vec![ground(plan, [i, j]), level(plan, i, j)];
            if i == plan.river() {
                let RiverPart { water, banks } = river(plan, j);
                shells.extend([quays(plan, j), water, banks]);
            } else {
                shells.extend([upright(plan, i, j), crossing_of(plan, i, j)]);
            }
            for shell in shells {
                all.extend(
                    shell
                        .faces
                        .iter()
                        .map(|(_, rings)| rings[0].iter().map(|i| shell.points[*i as usize]).collect::<Vec<_>>()),
                );
            }
        }
        all
    }

    #[test]
    fn the_ground_is_whole_and_nothing_lies_on_anything_else() {
        for seed in [1, 2, 3] {
            let plan = Plan::new(&SynthOptions { buildings: 1500, seed });
            let mut edges: HashMap<(P3, P3), i32> = HashMap::new();
            for face in faces(&plan, 8) {
                let [a, b, c] = [face[0], face[1], face[2]];
                let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                assert!(twice > 0, "seed {seed}: a face that looks down: {face:?}");
                for k in 0..3 {
                    *edges.entry((face[k], face[(k + 1) % 3])).or_default() += 1;
                }
            }
            let mut inner = 0;
            for ((a, b), times) in &edges {
                assert_eq!(*times, 1, "seed {seed}: an edge twice in one direction: {a:?} {b:?}");
                let is_inner = a[0].abs().max(a[1].abs()) < 250_000;
                inner += usize::from(is_inner);
                // At the water streets are cut finer than what they meet, on one straight and level line.
                let is_mouth = a[2] == QUAY && b[2] == QUAY;
                assert!(!is_inner || is_mouth || edges.contains_key(&(*b, *a)), "seed {seed}: a gap at {a:?} {b:?}");
            }
            assert!(inner > 2000, "{inner}");
        }
    }
}
