//! Six hundred years: when each place was built on, what stood there before, and the year of the great fire.

use crate::city::synth::{
    full::{
        frame::{STEP, steps},
        house::{Form, Function, House},
        plan::{Cell, Plan},
    },
    house::Shape,
    random::Random,
};

/// The year in which the town begins.
pub const FIRST: i64 = 1425;
/// The year of the newest building.
pub const LAST: i64 = 2025;
/// Buildings that stood in a place, at most.
const GENERATIONS: usize = 4;

const FIRE: u64 = 31;

/// When a block was first built on, and what befell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Era {
    /// The year of its first buildings.
    pub first: i64,
    /// How far out it is, 0 at the old wall to 1000 where the city ends; negative within the wall.
    pub out: i64,
    /// The year of the fire, where it burnt.
    pub fire: Option<i64>,
}

impl Era {
    /// The era of a cell.
    pub fn of(plan: &Plan, cell: Cell, random: &mut Random) -> Self {
        let ring = Plan::ring(cell);
        if plan.is_core(cell) {
            let first = FIRST + 170 * ring / (plan.core + 1);
            // The quarter to the north-east.
            let has_burnt = cell[0] >= 0 && cell[1] >= 0 && cell != [0, 0];
            let fire = Random::at(plan.options.seed, FIRE, [0, 0]).range(1640, 1720);
            return Self { first, out: ring - plan.core - 1, fire: has_burnt.then_some(fire) };
        }
        let out = (1000 * (ring - plan.core) / (plan.last - plan.core).max(1)).clamp(0, 1000);
        // The town filled its walls for long, then grew ever faster.
        const GROWTH: [[i64; 2]; 6] = [[0, 1700], [200, 1845], [400, 1900], [600, 1938], [800, 1970], [1000, 2008]];
        let [from, to] =
            GROWTH.windows(2).map(|w| [w[0], w[1]]).find(|[_, to]| out <= to[0]).unwrap_or([GROWTH[4], GROWTH[5]]);
        let first = from[1] + (to[1] - from[1]) * (out - from[0]) / (to[0] - from[0]) + random.range(-14, 8);
        Self { first, out, fire: None }
    }

    /// The years in which a place was built on, oldest first.
    pub fn years(&self, random: &mut Random) -> Vec<i64> {
        let mut years = vec![(self.first + random.range(0, 22)).min(LAST)];
        loop {
            let last = years[years.len() - 1];
            // Some houses last for good, the more the older they are.
            let stays = match last {
                ..=1599 => 26,
                1600..=1849 => 32,
                _ => 20,
            };
            let life = if random.chance(stays) { LAST } else { random.range(60, 420) };
            let mut next = last + life;
            if let Some(fire) = self.fire.filter(|fire| last < *fire && next >= *fire) {
                next = fire + random.range(1, 7);
            }
            if next > LAST - 3 {
                break;
            }
            years.push(next);
        }
        years
    }
}

/// What stood where a house stands, newest first: each within its successor, so that the smaller is never seen through the larger.
pub fn predecessors(house: &House, years: &[i64], random: &mut Random) -> Vec<House> {
    let mut found: Vec<House> = Vec::new();
    for &year in years.iter().rev().skip(1).take(GENERATIONS - 1) {
        let Some(before) = predecessor(found.last().unwrap_or(house), year, random) else { break };
        found.push(before);
    }
    found
}

/// What stood where a house stands, from a year on until that was built; `None` where there is no room for anything smaller.
fn predecessor(after: &House, year: i64, random: &mut Random) -> Option<House> {
    let [[x, y], [width, depth]] = after.core();
    let depth = depth.min(random.range(steps(8_000), steps(13_000)));
    let width = width.min(random.range(steps(8_000), steps(16_000)));
    let (width, depth) = (width - 2, depth - 2);
    let total = (after.eaves - 400).min(random.range(5_500, 11_000));
    if width < steps(2_500) || depth < steps(3_500) || total < 3_600 {
        return None;
    }
    let is_deep = depth > width;
    let form = random.pick(&[
        (if is_deep { 6 } else { 1 }, Form::Gablet),
        (5, Form::Plain(Shape::Gable)),
        (1, Form::Plain(Shape::Hip)),
    ]);
    let run = STEP * if form == Form::Gablet { width } else { depth } / 2;
    let rise = (run * 9 / 10).min(total * 45 / 100) / 100 * 100;
    let storey = 2_500;
    let function = match after.function {
        Function::Residential | Function::Commercial => after.function,
        Function::Industrial => Function::Outbuilding,
        _ => Function::Residential,
    };
    let inset = match form {
        Form::Plain(Shape::Hip) => (depth.min(width) / 2 - 1).max(1),
        _ => 0,
    };
    Some(House {
        form,
        frame: after.frame.moved(x + 1, y + 1),
        width,
        depth,
        eaves: total - rise,
        rise,
        inset,
        base: after.base + 50,
        storey,
        function,
        year,
        end: Some(after.year),
        is_fine: false,
        ..after.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::synth::{SynthOptions, full::plan::Cells};

    #[test]
    fn the_town_grows_outward_and_ever_faster() {
        let plan = Plan::new(&SynthOptions { buildings: 10_000, seed: 3 });
        let mut by_ring = vec![(0, 0); plan.last as usize + 1];
        for cell in Cells::default().take_while(|cell| Plan::ring(*cell) <= plan.last) {
            let era = Era::of(&plan, cell, &mut Random::at(3, 99, cell));
            assert!((FIRST..=LAST).contains(&era.first), "{era:?}");
            let (sum, count) = &mut by_ring[Plan::ring(cell) as usize];
            (*sum, *count) = (*sum + era.first, *count + 1);
        }
        let means: Vec<i64> = by_ring.iter().map(|(sum, count)| sum / count).collect();
        assert!(means.windows(2).all(|w| w[0] < w[1]), "{means:?}");
        assert!(means[0] == FIRST && means[means.len() - 1] > 1990, "{means:?}");
    }

    #[test]
    fn years_follow_each_other_and_the_fire_spares_nothing() {
        let era = Era { first: 1450, out: -1, fire: Some(1680) };
        let mut random = Random::at(5, 6, [7, 8]);
        for _ in 0..300 {
            let years = era.years(&mut random);
            assert!(years.windows(2).all(|w| w[0] < w[1]) && years[years.len() - 1] <= LAST, "{years:?}");
            assert!(years.iter().any(|year| (1681..=1687).contains(year)), "{years:?}");
        }
    }
}
