//! Landmarks: the objects of a city that stand out (beyond Trapp §5.3.2).
//!
//! An object is a root city object with its parts; what others stand on (terrain, water, roads, land use) and plants are none. Four
//! terms, each 0..=1, make its score, after the structural and semantic measures of Raubal and Winter (2002):
//!
//! | term | weight | is | 1 is |
//! | --- | --- | --- | --- |
//! | height | 0.4 | (h − m)/(h + m + 10 m), not below 0; h its height, m the mean height of its neighbours by footprint | a tower among nothing |
//! | footprint | 0.15 | (a − b)/(a + b + 200 m²), not below 0; a its footprint, b the mean of its neighbours' | a hall among nothing |
//! | isolation | 0.25 | d/(d + 100 m); d how far the nearest object is that is at least as high, in plan, box to box | the highest of all |
//! | attributes | 0.2 | 1 where a function or a name has a word for a landmark, ½ where there is another name, else 0 | a church |
//!
//! The constants are a house's height and footprint and a street block's width, so that sheds among nothing are no landmarks.
//! Neighbours are those whose boxes come within 200 m of its own in plan.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, ObjectClass, StringId, Value, derived::footprints, label::NAMES},
    geom::{Aabb, bvh::Bvh},
    visibility::units::Units,
};

/// The radius of the neighbourhood of an object, metres.
const NEIGHBOURHOOD_M: f64 = 200.0;
/// Metres and square metres of a house.
const HOUSE: (f64, f64) = (10.0, 200.0);
/// Metres of a street block.
const BLOCK_M: f64 = 100.0;
/// The weights of the terms, in their order.
const WEIGHTS: [f64; 4] = [0.4, 0.15, 0.25, 0.2];

/// A name that more objects have is none.
const NAMESAKES: usize = 3;
/// Parts of the names of attributes that say what an object is for, in lower case.
const FUNCTIONS: [&str; 8] = ["function", "functie", "funktion", "usage", "gebruik", "nutzung", "amenity", "class"];
/// Words for landmarks. A word of a text is one if it is the same, or, of those of four letters and more, ends with it: the
/// `Domkirche` is, the `Kerkstraat` is not.
const WORDS: [&str; 53] = [
    "abbey",
    "basilica",
    "campanile",
    "castle",
    "cathedral",
    "chapel",
    "church",
    "lighthouse",
    "minster",
    "monument",
    "mosque",
    "museum",
    "obelisk",
    "opera",
    "palace",
    "stadium",
    "synagogue",
    "temple",
    "theatre",
    "tower",
    "windmill",
    "kapel",
    "kasteel",
    "kathedraal",
    "kerk",
    "molen",
    "moskee",
    "paleis",
    "stadhuis",
    "synagoge",
    "tempel",
    "theater",
    "toren",
    "vuurtoren",
    "bahnhof",
    "denkmal",
    "dom",
    "kapelle",
    "kirche",
    "leuchtturm",
    "moschee",
    "münster",
    "mühle",
    "rathaus",
    "schloss",
    "turm",
    "cathédrale",
    "chapelle",
    "château",
    "église",
    "mairie",
    "musée",
    "théâtre",
];

/// An object that stands out.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Its root object, by index.
    pub object: u32,
    /// The weighted sum of its terms, 0..=1.
    pub score: f64,
    /// The terms of the score.
    pub terms: Terms,
    /// From its lowest point to its highest, metres.
    pub height_m: f64,
    /// The mean height of its neighbours, by footprint, metres; 0 without any.
    pub neighbours_m: f64,
    /// The ground that it covers, square metres.
    pub footprint_m2: f64,
    /// Whether that is the area of a convex hull: what is covered has too many crossings for an outline.
    pub footprint_is_hull: bool,
    /// The distance to the nearest object that is at least as high, metres in plan; `None`: there is none.
    pub isolation_m: Option<f64>,
    /// Its name, if it has one.
    pub name: Option<String>,
}

/// The terms of a score, each 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Its height over that of its neighbours.
    pub height: f64,
    /// Its footprint over that of its neighbours.
    pub footprint: f64,
    /// The term of the distance to the next that is as high.
    pub isolation: f64,
    /// The term of its attributes.
    pub attributes: f64,
}

impl Terms {
    /// Their weighted sum.
    pub fn score(&self) -> f64 {
        let terms = [self.height, self.footprint, self.isolation, self.attributes];
        terms.iter().zip(WEIGHTS).map(|(term, weight)| term * weight).sum()
    }
}

/// The `n` objects that stand out most of a city of which the geometries `shown` are shown, best first; of equal ones the one that
/// was read first.
pub fn landmarks(model: &CityModel, shown: &[u32], n: usize) -> Vec<Landmark> {
    let units = Units::new(model, shown);
    let can_be = |object: u32| {
        let class = model.objects[object as usize].class;
        !class.is_ground() && class != ObjectClass::Vegetation
    };
    let chosen: Vec<u32> = (0..units.len() as u32)
        .filter(|&unit| can_be(units.roots[unit as usize]) && !units.boxes[unit as usize].is_empty())
        .collect();
    let town = Town::new(model, &units, &chosen);
    let facts = UnitFacts::new(model, &units);
    let landmark = |at: usize| {
        let (height_m, (footprint_m2, footprint_is_hull)) = (town.heights[at], town.areas[at]);
        let [neighbours_m, usual_m2] = town.neighbourhood(at);
        let isolation_m = town.isolation(at);
        let unit = chosen[at];
        let (attributes, name) = facts.of(unit);
        let over = |own: f64, others: f64, house: f64| ((own - others) / (own + others + house)).max(0.0);
        let terms = Terms {
            height: over(height_m, neighbours_m, HOUSE.0),
            footprint: over(footprint_m2, usual_m2, HOUSE.1),
            isolation: isolation_m.map_or(1.0, |d| d / (d + BLOCK_M)),
            attributes,
        };
        let object = units.roots[unit as usize];
        Landmark {
            object,
            score: terms.score(),
            terms,
            height_m,
            neighbours_m,
            footprint_m2,
            footprint_is_hull,
            isolation_m,
            name,
        }
    };
    let mut all: Vec<Landmark> = (0..chosen.len()).into_par_iter().map(landmark).collect();
    all.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.object.cmp(&b.object)));
    all.truncate(n);
    all
}

/// The objects that can be landmarks, in plan.
struct Town {
    /// Boxes, flat: z = 0.
    boxes: Vec<Aabb>,
    /// Metres.
    heights: Vec<f64>,
    /// Square metres, and whether they are those of a convex hull.
    areas: Vec<(f64, bool)>,
    tree: Bvh,
    /// The longest way in it, metres.
    reach_m: f64,
}

impl Town {
    fn new(model: &CityModel, units: &Units, chosen: &[u32]) -> Self {
        let flat = |p: DVec3| p.with_z(0.0);
        let full = |unit: &u32| units.boxes[*unit as usize];
        let boxes: Vec<Aabb> = chosen.iter().map(full).map(|b| Aabb { min: flat(b.min), max: flat(b.max) }).collect();
        let geometries: Vec<u32> = chosen.iter().flat_map(|&unit| units.geometries(unit)).copied().collect();
        let mut sorted = geometries;
        sorted.sort_unstable();
        let mut covered: FxHashMap<u32, (f64, bool)> = FxHashMap::default();
        for footprint in footprints(model, &sorted, false) {
            let area: f64 = footprint.parts.iter().flatten().map(|ring| area_of(ring)).sum();
            let (sum, is_hull) = covered.entry(units.of_object[footprint.objects[0] as usize]).or_default();
            *sum += area;
            *is_hull |= footprint.is_hull;
        }
        let all = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
        Self {
            heights: chosen.iter().map(full).map(|b| b.size().z).collect(),
            areas: chosen.iter().map(|unit| covered.get(unit).copied().unwrap_or_default()).collect(),
            tree: Bvh::build(&boxes),
            reach_m: all.size().length(),
            boxes,
        }
    }

    /// Those whose boxes come within `reach` metres, with how far they are; not itself.
    fn near(&self, at: usize, reach: f64, mut visit: impl FnMut(usize, f64)) {
        let own = &self.boxes[at];
        self.tree.in_box(&Aabb { min: own.min - reach, max: own.max + reach }, |other| {
            let other = other as usize;
            let gap = (self.boxes[other].min - own.max).max(own.min - self.boxes[other].max).max(DVec3::ZERO);
            let distance = gap.truncate().length();
            if other != at && distance <= reach {
                visit(other, distance);
            }
        });
    }

    /// Mean height of the neighbours, by footprint, and their mean footprint; 0 without any.
    fn neighbourhood(&self, at: usize) -> [f64; 2] {
        // In the order of their numbers, so that sums round alike in every run.
        let mut neighbours = Vec::new();
        self.near(at, NEIGHBOURHOOD_M, |other, _| neighbours.push(other));
        neighbours.sort_unstable();
        let area: f64 = neighbours.iter().map(|&other| self.areas[other].0).sum();
        let volume: f64 = neighbours.iter().map(|&other| self.areas[other].0 * self.heights[other]).sum();
        let mean = |sum: f64, of: f64| if of > 0.0 { sum / of } else { 0.0 };
        [mean(volume, area), mean(area, neighbours.len() as f64)]
    }

    /// The distance to the nearest that is at least as high; `None` where none is.
    fn isolation(&self, at: usize) -> Option<f64> {
        let mut reach = BLOCK_M;
        loop {
            let mut nearest: Option<f64> = None;
            self.near(at, reach, |other, distance| {
                if self.heights[other] >= self.heights[at] {
                    nearest = Some(nearest.map_or(distance, |known| known.min(distance)));
                }
            });
            if nearest.is_some() || reach > self.reach_m {
                return nearest;
            }
            reach *= 2.0;
        }
    }
}

/// Signed area of a ring, square metres; counter-clockwise is positive, so holes count against.
fn area_of(ring: &[DVec2]) -> f64 {
    let Some(&base) = ring.first() else { return 0.0 };
    ring.windows(2).map(|ends| 0.5 * (ends[0] - base).perp_dot(ends[1] - base)).sum()
}

/// Facts that attributes tell, per unit.
struct UnitFacts<'a> {
    model: &'a CityModel,
    /// The objects of each unit, its root first.
    members: FxHashMap<u32, Vec<u32>>,
    /// The number of times that each name occurs.
    names: FxHashMap<StringId, usize>,
}

impl<'a> UnitFacts<'a> {
    fn new(model: &'a CityModel, units: &Units) -> Self {
        let mut members: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        units.roots.iter().zip(0..).for_each(|(&root, unit)| members.entry(unit).or_default().push(root));
        for (object, &unit) in (0..).zip(&units.of_object) {
            if units.roots[unit as usize] != object {
                members.entry(unit).or_default().push(object);
            }
        }
        let mut names = FxHashMap::default();
        for object in 0..model.objects.len() as u32 {
            for attribute in model.attributes_of(object) {
                if let (true, Value::String(text)) = (is_name(model, attribute.name), attribute.value) {
                    *names.entry(text).or_insert(0) += 1;
                }
            }
        }
        Self { model, members, names }
    }

    /// The term of a unit, and its name.
    fn of(&self, unit: u32) -> (f64, Option<String>) {
        let (mut term, mut name) = (0.0_f64, None);
        let members = self.members.get(&unit).map_or(&[][..], Vec::as_slice);
        for attribute in members.iter().flat_map(|&object| self.model.attributes_of(object)) {
            let Value::String(id) = attribute.value else { continue };
            let text = self.model.strings.get(id).trim();
            // A code or a number is no name.
            let is_text = text.chars().filter(|c| c.is_alphabetic()).count() >= 3;
            if is_name(self.model, attribute.name) {
                if is_text && self.names.get(&id).is_some_and(|count| *count <= NAMESAKES) {
                    term = term.max(if says_landmark(text) { 1.0 } else { 0.5 });
                    name.get_or_insert_with(|| text.to_owned());
                }
            } else if is_function(self.model, attribute.name) && says_landmark(text) {
                term = 1.0;
            }
        }
        (term, name)
    }
}

fn is_name(model: &CityModel, attribute: StringId) -> bool {
    let name = model.strings.get(attribute);
    NAMES.iter().any(|known| name.eq_ignore_ascii_case(known))
}

fn is_function(model: &CityModel, attribute: StringId) -> bool {
    let name = model.strings.get(attribute).to_lowercase();
    FUNCTIONS.iter().any(|part| name.contains(part))
}

/// Whether a text has a word for a landmark.
fn says_landmark(text: &str) -> bool {
    let text = text.to_lowercase();
    let mut words = text.split(|c: char| !c.is_alphabetic());
    words.any(|word| WORDS.iter().any(|known| word == *known || (known.chars().count() >= 4 && word.ends_with(known))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{
        Attribute,
        build::ModelBuilder,
        test_city::{add, add_box, builder, terrain},
    };

    /// Five rows of five houses of 10 m by 10 m by 8 m, 15 m apart; some of other heights, metres.
    fn houses(heights: &[(usize, i64)]) -> ModelBuilder {
        let mut city = builder();
        for i in 0..25 {
            let height = heights.iter().find(|(house, _)| *house == i).map_or(8, |(_, height)| *height);
            let min = [15_000 * (i as i64 % 5), 15_000 * (i as i64 / 5), 0];
            add_box(&mut city, &format!("{i}"), min, [min[0] + 10_000, min[1] + 10_000, 1000 * height]);
        }
        city
    }

    fn all_of(model: &CityModel, n: usize) -> Vec<Landmark> {
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        landmarks(model, &shown, n)
    }

    #[test]
    fn towers_stand_out_by_the_numbers_of_the_table() {
        let model = houses(&[(12, 40), (0, 30)]).finish();
        let found = all_of(&model, 4);
        assert_eq!(found.iter().map(|l| l.object).collect::<Vec<_>>(), [12, 0, 1, 2], "then houses, by number");
        let tower = &found[0];
        assert_eq!((tower.height_m, tower.isolation_m, &tower.name), (40.0, None, &None));
        assert!((tower.footprint_m2 - 100.0).abs() < 1e-9, "{tower:?}");
        let mean = (23.0 * 8.0 + 30.0) / 24.0;
        assert!((tower.neighbours_m - mean).abs() < 1e-9, "{tower:?}");
        let terms = Terms { height: (40.0 - mean) / (50.0 + mean), footprint: 0.0, isolation: 1.0, attributes: 0.0 };
        assert!((tower.terms.height - terms.height).abs() < 1e-12, "{tower:?}");
        assert!((tower.score - (0.4 * terms.height + 0.25)).abs() < 1e-12);
        // From the corner house to the tower in the middle, box to box.
        let away = found[1].isolation_m.unwrap();
        assert!((away - 20.0 * 2_f64.sqrt()).abs() < 1e-9, "{away}");
        assert!((found[1].terms.isolation - away / (away + 100.0)).abs() < 1e-12);
        assert!((found[2].isolation_m.unwrap() - 5.0).abs() < 1e-9 && found[2].terms.height == 0.0);
    }

    #[test]
    fn a_hall_stands_out_by_its_footprint_and_courts_are_no_part_of_it() {
        let mut city = houses(&[]);
        // A ring of 40 m by 40 m around a court of 20 m by 20 m, beside the houses.
        let corners = |a: i64, b: i64| {
            [[100_000 + a, a, 8_000], [100_000 + b, a, 8_000], [100_000 + b, b, 8_000], [100_000 + a, b, 8_000]]
        };
        let points: Vec<[i64; 3]> = [corners(0, 40_000), corners(10_000, 30_000)].concat();
        let faces = [vec![0, 1, 5, 4], vec![1, 2, 6, 5], vec![2, 3, 7, 6], vec![3, 0, 4, 7]];
        let hall = add(&mut city, "hall", ObjectClass::Building, Some("RoofSurface"), points, &faces);
        let model = city.finish();
        let first = &all_of(&model, 1)[0];
        assert_eq!(first.object, hall);
        assert!((first.footprint_m2 - 1200.0).abs() < 1e-6, "{first:?}");
        assert!((first.terms.footprint - 1100.0 / 1500.0).abs() < 1e-9, "{first:?}");
    }

    #[test]
    fn names_and_functions_count() {
        let mut city = houses(&[]);
        let texts =
            ["Naam", "Nieuwe Kerk", "Kerkstraat 5", "Huis", "12", "roof:class", "Domkirche", "function", "1000"];
        let [naam, kerk, street, same, number, class, dom, function, code] = texts.map(|text| city.intern(text));
        let mut model = city.finish();
        let mut tell = |object: usize, name, text| {
            let at = model.attributes.len() as u32;
            model.attributes.push(Attribute { name, value: Value::String(text) });
            model.objects[object].attributes = at..at + 1;
        };
        tell(7, naam, kerk);
        tell(3, naam, street);
        tell(9, class, dom);
        tell(11, function, code);
        tell(13, naam, number);
        (15..19).for_each(|house| tell(house, naam, same));
        let found = all_of(&model, 25);
        let of = |object: u32| found.iter().find(|l| l.object == object).unwrap();
        assert_eq!((of(7).terms.attributes, of(7).name.as_deref()), (1.0, Some("Nieuwe Kerk")));
        assert_eq!((of(3).terms.attributes, of(3).name.as_deref()), (0.5, Some("Kerkstraat 5")), "no church");
        assert_eq!((of(9).terms.attributes, &of(9).name), (1.0, &None));
        for (object, why) in [(11, "a code"), (13, "a number"), (15, "a name of many"), (0, "nothing")] {
            assert_eq!((of(object).terms.attributes, &of(object).name), (0.0, &None), "{why}");
        }
        assert_eq!(found[..2].iter().map(|l| l.object).collect::<Vec<_>>(), [7, 9]);
    }

    #[test]
    fn what_others_stand_on_and_plants_are_no_landmarks() {
        assert_eq!(all_of(&terrain(4), 9), []);
        assert_eq!(all_of(&CityModel::default(), 9), []);
        let mut city = builder();
        let corners = vec![[0, 0, 0], [9_000, 0, 0], [0, 9_000, 30_000]];
        add(&mut city, "tree", ObjectClass::Vegetation, None, corners, &[vec![0, 1, 2]]);
        add_box(&mut city, "shed", [90_000, 0, 0], [92_000, 2_000, 2_500]);
        let found = all_of(&city.finish(), 9);
        assert_eq!(found.iter().map(|l| l.object).collect::<Vec<_>>(), [1]);
        // The highest of all, but no tower.
        assert!((found[0].terms.height - 0.2).abs() < 1e-12 && found[0].terms.isolation == 1.0, "{found:?}");
    }
}
