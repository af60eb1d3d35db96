//! Names and numbers that registers have.

use crate::city::synth::{
    full::{
        blocks::Lot,
        house::{Function, House},
        object::{Address, Object},
        plan::{Cell, Plan, Street},
    },
    random::Random,
};

const NAMES: u64 = 61;
const REGISTER: u64 = 62;

const TOWNS: [&str; 6] = ["Altmere", "Brookhaven", "Lindenau", "Marvik", "Oldenbridge", "Westermoor"];
const STREETS: [&str; 40] = [
    "Abbey", "Alder", "Anchor", "Baker", "Barley", "Beech", "Bell", "Bishop", "Bridge", "Castle", "Chapel", "Chestnut",
    "Cooper", "Copper", "Corn", "Elm", "Falcon", "Ferry", "Fisher", "Garden", "Glover", "Goose", "Harbour", "Hill",
    "Linden", "Malt", "Mill", "Monk", "Orchard", "Potter", "Rose", "Saddler", "School", "Shepherd", "Silver", "Smith",
    "Spring", "Swan", "Tanner", "Weaver",
];

/// The town of a city.
pub fn town(plan: &Plan) -> &'static str {
    TOWNS[Random::at(plan.options.seed, NAMES, [0, 0]).range(0, TOWNS.len() as i64 - 1) as usize]
}

/// The name of the street in a line, upright or level.
pub fn street(plan: &Plan, is_upright: bool, line: i64, street: Street) -> String {
    let name = match street {
        Street::Boulevard => {
            return ["South Wall", "East Wall", "North Wall"]
                [usize::from(is_upright) + 2 * usize::from(!is_upright && line > 0)]
            .into();
        }
        Street::River => return if is_upright { "Quay".into() } else { "River Street".into() },
        _ => {
            let shift = Random::at(plan.options.seed, NAMES, [1, i64::from(is_upright)]).range(0, 39);
            STREETS[(line * 7 + shift + if is_upright { 20 } else { 0 }).rem_euclid(40) as usize]
        }
    };
    let kind = match street {
        Street::Lane => "Lane",
        Street::Main => "Street",
        Street::Avenue => "Road",
        Street::Path => "Path",
        _ => "Track",
    };
    // Names come again after forty lines.
    match line.div_euclid(40) {
        0 => format!("{name} {kind}"),
        n => format!("{name} {kind} {n}"),
    }
}

/// The address of a lot.
pub fn address(plan: &Plan, [i, j]: Cell, lot: &Lot) -> Address {
    let (is_upright, line, along, kind) = match lot.side {
        0 => (false, j, i, plan.level(i, j)),
        1 => (true, i + 1, j, plan.upright(i + 1, j)),
        2 => (false, j + 1, i, plan.level(i, j + 1)),
        _ => (true, i, j, plan.upright(i, j)),
    };
    let side = match (along < 0, is_upright) {
        (false, true) => "North",
        (true, true) => "South",
        (false, false) => "East",
        (true, false) => "West",
    };
    let name = street(plan, is_upright, line, kind);
    // Odd numbers on one side, even ones on the other, and fifty of each from crossing to crossing.
    let number =
        100 * along.abs().min((along + 1).abs()) + 2 * lot.place + if matches!(lot.side, 0 | 3) { 2 } else { 1 };
    let code = format!("{:05}", 10_000 + (i + 150) * 300 + j + 150);
    Address { street: format!("{name} {side}"), number, code, town: town(plan) }
}

impl Function {
    /// As the attribute has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Residential => "residential",
            Self::Commercial => "commercial",
            Self::Office => "office",
            Self::Public => "public",
            Self::Industrial => "industrial",
            Self::Church => "church",
            Self::TownHall => "town hall",
            Self::Gate => "gate",
            Self::Outbuilding => "outbuilding",
        }
    }
}

/// Adds what registers know of a house.
pub fn register(object: Object, house: &House, random: &mut Random) -> Object {
    let mut object = object
        .text("function", house.function.name())
        .whole("storeysAboveGround", house.storeys())
        .length("measuredHeight", house.height())
        .whole("yearOfConstruction", house.year);
    if let Some(end) = house.end {
        object = object.whole("yearOfDemolition", end);
    }
    let inhabitants = inhabitants(house, random);
    object = object.whole("inhabitants", inhabitants);
    let has_heating = !matches!(house.function, Function::Outbuilding | Function::Gate | Function::Church);
    if has_heating && house.end.is_none() {
        object = object.text("energyClass", energy_class(house.year, random));
    }
    object
}

/// How many live there: by the area of its storeys, which was less to each long ago.
fn inhabitants(house: &House, random: &mut Random) -> i64 {
    let share = match house.function {
        Function::Residential => 80,
        Function::Commercial => 45,
        _ => return 0,
    };
    let area_each = if house.end.is_some() { 14 } else { 40 };
    (house.floor_area() * share * random.range(60, 125) / (10_000 * area_each))
        .max(i64::from(house.function == Function::Residential))
}

/// A to G: newer is better, and some old houses were insulated.
fn energy_class(year: i64, random: &mut Random) -> &'static str {
    const CLASSES: [&str; 7] = ["A", "B", "C", "D", "E", "F", "G"];
    let usual = match year {
        2015.. => 0,
        2003..=2014 => 1,
        1990..=2002 => 2,
        1978..=1989 => 3,
        1919..=1977 => 5,
        _ => 5,
    };
    let renewed = if year < 2003 && random.chance(35) { random.range(1, 3) } else { 0 };
    CLASSES[(usual + random.range(-1, 1) - renewed).clamp(0, 6) as usize]
}

/// The numbers that a register gives a building.
pub fn register_of(plan: &Plan, number: u64) -> Random {
    Random::at(plan.options.seed, REGISTER, [number as i64, 0])
}
