//! Occluders and what they hide, for the eye of a picture: worked out again only where the eye, a point of interest or the test is another.
//!
//! A picture knows nothing of what was before it, unless time was made to pass: [`Occlusion::pass`].

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec3;

use crate::{
    geom::Aabb,
    lens::{Occluders, chosen::members, rendering::When, solids::ShownCity},
    render::{displayed::Stand, stats},
    scene::{Poi, PoiPlace},
    visibility::{self, CaseMemory, Detected, Memory, Query, Scope, Set, Units, Viewer},
};

/// What is known of the occluders that lenses look for.
#[derive(Debug, Default)]
pub struct Occlusion {
    /// Of the city at rest, and of the one that deformations showed last; by number.
    units: Vec<(u64, Arc<Units>)>,
    known: Vec<Known>,
    /// Over time, by the names of lenses.
    remembered: BTreeMap<String, Remembered>,
    /// Tests asked so far.
    asked: u64,
    /// Objects that are not there.
    gone: Option<Arc<[bool]>>,
}

/// The occluders of one lens over time.
#[derive(Debug)]
struct Remembered {
    memory: Memory,
    /// Occluders, points and eye of the last step: pictures of other moments have no history.
    asked: Asked,
    shown: ShownOccluders,
    /// The cases that it draws them in, and of each unit that is drawn which one; one more means none.
    when: Vec<When>,
    cases: BTreeMap<u32, CaseMemory>,
}

/// Occluders that a lens looks for, and from where.
#[derive(Clone, Debug, PartialEq)]
struct Asked {
    of: Occluders,
    places: Vec<PoiPlace>,
    viewer: Viewer,
}

impl Asked {
    fn new(of: &Occluders, pois: &[Poi], viewer: Viewer) -> Self {
        let place_of = |name: &String| pois.iter().find(|poi| poi.name == *name).map(|poi| poi.place.clone());
        Self { of: of.clone(), places: of.pois.iter().filter_map(place_of).collect(), viewer }
    }
}

/// A lens whose occluders come and go over time.
#[derive(Clone, Debug)]
pub struct Passing<'a> {
    /// Its name.
    pub name: &'a str,
    /// Occluders that it looks for.
    pub of: &'a Occluders,
    /// The cases that it draws them in; none: all in one way.
    pub when: Vec<When>,
    /// Where it looks for them.
    pub stand: Stand<'a>,
}

/// What is drawn as an occluder.
#[derive(Clone, Debug)]
pub struct ShownOccluders {
    /// One flag per object of the city: whether it is one, be it in part.
    pub objects: Arc<[bool]>,
    /// Where some come or go, from which threshold of a pixel on and below which each object is drawn as one, 0 to 1.
    pub thresholds: Option<Arc<[[f32; 2]]>>,
}

impl ShownOccluders {
    /// Between these thresholds each.
    fn between(thresholds: Vec<[f32; 2]>) -> Self {
        let fades = |[from, to]: &[f32; 2]| from < to && (*from > 0.0 || *to < 1.0);
        Self {
            objects: thresholds.iter().map(|[from, to]| from < to).collect(),
            thresholds: thresholds.iter().any(fades).then(|| thresholds.into()),
        }
    }
}

/// Of each object of a city what its unit has; the default of what others stand on.
fn by_object<T: Copy + Default>(units: &Units, city: ShownCity, of_unit: impl Fn(u32) -> T) -> Vec<T> {
    let objects = units.of_object.iter().zip(&city.model.objects);
    objects.map(|(&unit, object)| if object.class.is_ground() { T::default() } else { of_unit(unit) }).collect()
}

/// The occluders of one lens, or of several that look for the same.
#[derive(Debug)]
struct Known {
    /// The number of the city.
    city: u64,
    /// Occluders that it is of.
    of: Occluders,
    places: Vec<PoiPlace>,
    /// What that means in the city.
    pois: Vec<visibility::Poi>,
    forced: Set,
    forbidden: Set,
    /// Seen from there.
    found: Option<Found>,
    is_wanted: bool,
}

/// What is worked out beside the occluders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct How {
    /// Shares also where no test asks for them.
    is_measured: bool,
    /// Objects that stay occluders.
    has_margin: bool,
}

impl How {
    /// Whether there is all that the other asks for.
    fn serves(self, other: Self) -> bool {
        self.is_measured >= other.is_measured && self.has_margin >= other.has_margin
    }
}

#[derive(Clone, Debug)]
struct Found {
    viewer: Viewer,
    how: How,
    detected: Arc<Detected>,
    objects: Arc<[bool]>,
}

/// What a lens looks for: occluders, and the cases that it draws them in.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// Occluders.
    pub of: &'a Occluders,
    /// The cases, in order; none: all in one way.
    pub when: &'a [When],
}

impl Occlusion {
    /// The occluders of a lens, by its name: as remembered, if time was made to pass up to here, else as they are found. Of
    /// some cases those that the last one holds of, and none before it; without a case all.
    pub fn objects(&mut self, lens: &str, search: Search, stand: Stand, viewer: Viewer) -> ShownOccluders {
        let (Search { of, when }, Stand { city, pois }) = (search, stand);
        let units = self.units_of(city);
        let remembered = self.memory_of(lens, of, pois, viewer).filter(|known| known.when.starts_with(when));
        let Some(Remembered { memory, cases, shown, .. }) = remembered else {
            let Found { objects, detected, .. } = self.found(of, stand, viewer, How::default());
            let Some(last) = when.len().checked_sub(1) else { return ShownOccluders { objects, thresholds: None } };
            let cases = Cases::new(when, &units, city, viewer);
            let is_of_case = |unit| detected.occluders.has(unit) && cases.first(unit) == last;
            let of_case: Vec<bool> = (0..units.len() as u32).map(is_of_case).collect();
            let objects = units.objects_of(city.model, &Set::of(&of_case)).into();
            return ShownOccluders { objects, thresholds: None };
        };
        let Some(last) = when.len().checked_sub(1) else { return shown.clone() };
        let of_unit = |unit: u32| {
            let weight = memory.weights()[unit as usize];
            cases.get(&unit).map_or([0.0; 2], |of_unit| of_unit.thresholds(last, weight))
        };
        ShownOccluders::between(by_object(&units, city, of_unit))
    }

    /// Per object of the city, how far it is drawn as an occluder of a lens, by its name, 0 to 1; `None` where no time passed for it.
    pub fn weights(&self, lens: &str) -> Option<Vec<f32>> {
        let ShownOccluders { objects, thresholds } = &self.remembered.get(lens)?.shown;
        let settled = || objects.iter().map(|is| f32::from(u8::from(*is))).collect();
        let fading = |all: &Arc<[[f32; 2]]>| all.iter().map(|[from, to]| to - from).collect();
        Some(thresholds.as_ref().map_or_else(settled, fading))
    }

    /// The same by cases that it is drawn in; what is drawn in none is in none of them.
    pub fn case_weights(&self, lens: &str, city: ShownCity) -> Option<Vec<Vec<f32>>> {
        let Remembered { memory, when, cases, .. } = self.remembered.get(lens)?;
        // Which of an object's unit is the same wherever they are.
        let (_, units) = self.units.first()?;
        let of_case = |case: usize| {
            let of_unit = |unit: u32| {
                let weight = memory.weights()[unit as usize];
                cases.get(&unit).map_or([0.0; 2], |of_unit| of_unit.thresholds(case, weight))
            };
            by_object(units, city, of_unit).into_iter().map(|[from, to]| to - from).collect()
        };
        Some((0..when.len()).map(of_case).collect())
    }

    fn memory_of(&self, lens: &str, of: &Occluders, pois: &[Poi], viewer: Viewer) -> Option<&Remembered> {
        self.remembered.get(lens).filter(|remembered| remembered.asked == Asked::new(of, pois, viewer))
    }

    /// Time goes on by `dt` seconds, ≥ 0, to a moment when lenses look for these occluders and draw them in these cases; those that were
    /// not there before begin settled.
    pub fn pass(&mut self, lenses: &[Passing], viewer: Viewer, dt: f64) {
        self.remembered.retain(|name, _| lenses.iter().any(|lens| lens.name == name));
        for &Passing { name, of, ref when, stand } in lenses {
            let Stand { city, pois } = stand;
            let how = How { has_margin: true, ..How::default() };
            let detected = self.found(of, stand, viewer, how).detected;
            let units = self.units_of(city);
            let before = self.remembered.remove(name);
            let (memory, cases_before) = match before {
                None => (Memory::settled(&detected), None),
                Some(Remembered { mut memory, cases, when: known, .. }) => {
                    memory.step(&detected, of.pace, dt);
                    (memory, (known.len() == when.len()).then_some(cases))
                }
            };
            let asked_of = Cases::new(when, &units, city, viewer);
            let over_time = |unit: u32| {
                let now = asked_of.first(unit);
                let known = cases_before.as_ref().and_then(|cases| cases.get(&unit)).cloned();
                let mut case = known.unwrap_or_else(|| CaseMemory::settled(now, when.len() + 1));
                case.step(now, asked_of.holds(case.case(), unit, of.margin.metres), of.pace, dt);
                (unit, case)
            };
            let shown = memory.shown();
            let cases = if when.is_empty() { BTreeMap::new() } else { shown.iter().map(over_time).collect() };
            let of_unit = |unit: u32| [0.0, memory.weights()[unit as usize] as f32];
            let shown = ShownOccluders::between(by_object(&units, city, of_unit));
            let asked = Asked::new(of, pois, viewer);
            let when = when.clone();
            self.remembered.insert(name.to_owned(), Remembered { memory, asked, shown, when, cases });
        }
        self.forget_others();
    }

    /// The occluders of a lens with their reasons, the shares that they cover and, over time, how far they have come.
    pub fn explained(&mut self, lens: &str, search: Search, stand: Stand, viewer: Viewer) -> Vec<stats::Occluder> {
        let (Search { of, when }, Stand { city, pois }) = (search, stand);
        let how = How { is_measured: true, ..How::default() };
        let detected = self.found(of, stand, viewer, how).detected;
        let units = self.units_of(city);
        let remembered = self.memory_of(lens, of, pois, viewer);
        let now = Cases::new(when, &units, city, viewer);
        let case_of = |unit: u32| {
            let known = remembered.and_then(|remembered| remembered.cases.get(&unit)).map(CaseMemory::case);
            Some(known.unwrap_or_else(|| now.first(unit))).filter(|case| *case < when.len()).map(|case| case + 1)
        };
        let one = |unit: u32, why: Vec<String>| stats::Occluder {
            id: city.model.objects[units.roots[unit as usize] as usize].id.to_string(),
            why,
            coverage: None,
            distance: units.boxes[unit as usize].distance_to(viewer.eye),
            case: (!when.is_empty()).then(|| case_of(unit)),
            weight: None,
        };
        let found = detected.list.iter().map(|occluder| {
            let coverage = occluder.coverage.map(|c| stats::Coverage { share: c.share, low: c.low, high: c.high });
            (occluder.unit, stats::Occluder { coverage, ..one(occluder.unit, occluder.why.clone()) })
        });
        let Some(memory) = remembered.map(|remembered| &remembered.memory) else {
            return found.map(|(_, occluder)| occluder).collect();
        };
        let mut all: BTreeMap<u32, stats::Occluder> = found.collect();
        for (unit, &weight) in (0..).zip(memory.weights()).filter(|(_, weight)| **weight > 0.0) {
            let kept = memory.is_occluder(unit).then(|| "kept".to_owned()).into_iter().collect();
            all.entry(unit).or_insert_with(|| one(unit, kept)).weight = Some(weight);
        }
        all.into_values()
            .map(|occluder| stats::Occluder { weight: occluder.weight.or(Some(0.0)), ..occluder })
            .collect()
    }

    /// How many occluders of a lens come and go; `None` where no time was made to pass up to here.
    pub fn over_time(&self, lens: &str, of: &Occluders, pois: &[Poi], viewer: Viewer) -> Option<stats::OverTime> {
        let Remembered { memory, cases, .. } = self.memory_of(lens, of, pois, viewer)?;
        let mut counts = stats::OverTime::default();
        for (unit, &weight) in (0..).zip(memory.weights()).filter(|(_, weight)| **weight > 0.0) {
            match memory.is_occluder(unit) {
                true if weight == 1.0 => counts.whole += 1,
                true => counts.entering += 1,
                false => counts.leaving += 1,
            }
            counts.changing += u64::from(cases.get(&unit).is_some_and(|case| !case.is_settled()));
        }
        Some(counts)
    }

    /// Whether what was last made to pass left something between two states.
    pub fn is_fading(&self) -> bool {
        let fades =
            |known: &Remembered| !known.memory.is_settled() || !known.cases.values().all(CaseMemory::is_settled);
        self.remembered.values().any(fades)
    }

    /// How many tests were asked of the city so far; what is known already is not asked again.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// From now on these objects hide nothing, one flag per object of the city: they are not there at the scene's moment; `None`: all
    /// are.
    pub fn set_gone(&mut self, gone: Option<Arc<[bool]>>) {
        if self.gone != gone {
            self.gone = gone;
            self.known.iter_mut().for_each(|known| known.found = None);
        }
    }

    /// Forgets what was not asked for since the last time.
    pub fn forget_others(&mut self) {
        self.known.retain(|known| known.is_wanted);
        self.known.iter_mut().for_each(|known| known.is_wanted = false);
    }

    /// The box around what is shown of a place, metres; empty where the city has no such object.
    pub fn box_of(&mut self, place: &PoiPlace, city: ShownCity) -> Aabb {
        poi_of(place, city).map_or(Aabb::EMPTY, |poi| self.units_of(city).box_of(poi))
    }

    fn units_of(&mut self, city: ShownCity) -> Arc<Units> {
        if let Some((_, units)) = self.units.iter().find(|(number, _)| *number == city.number) {
            return units.clone();
        }
        let units = Arc::new(Units::new(city.model, city.geometries));
        self.units.retain(|(number, _)| *number == ShownCity::undeformed(city.number));
        self.units.push((city.number, units.clone()));
        units
    }

    fn found(&mut self, of: &Occluders, stand: Stand, viewer: Viewer, how: How) -> Found {
        let Stand { city, pois } = stand;
        let units = self.units_of(city);
        let Asked { places, .. } = Asked::new(of, pois, viewer);
        let is_same = |known: &Known| known.city == city.number && known.of == *of && known.places == places;
        let at = self.known.iter().position(is_same).unwrap_or_else(|| {
            self.known.push(Known::new(of, places.clone(), city, &units));
            self.known.len() - 1
        });
        let known = &mut self.known[at];
        known.is_wanted = true;
        if let Some(found) = known.found.as_ref().filter(|found| found.viewer == viewer && found.how.serves(how)) {
            return found.clone();
        }
        let gone = self.gone.as_deref().map(|gone| units.all_flagged(city.model, gone));
        let forbidden = gone.map_or_else(|| known.forbidden.clone(), |gone| gone.or(&known.forbidden));
        let query = Query {
            viewer,
            pois: &known.pois,
            test: &of.test,
            forced: &known.forced,
            forbidden: &forbidden,
            measured: how.is_measured,
            margin: how.has_margin.then_some(of.margin),
        };
        let detected = Scope { model: city.model, units: &units, index: city.index() }.detect(&query);
        self.asked += 1;
        let objects = units.objects_of(city.model, &detected.occluders).into();
        let found = Found { viewer, how, detected: Arc::new(detected), objects };
        known.found.insert(found).clone()
    }
}

/// What a place means in the city; scenes that are drawn hold nothing that moves ([`crate::scene::Scene::drawn`]).
fn poi_of(place: &PoiPlace, city: ShownCity) -> Option<visibility::Poi> {
    match place {
        PoiPlace::At(at) => Some(visibility::Poi::At(*at)),
        // As what moves: [`crate::scene::Scene::on_ground`].
        PoiPlace::AboveGround(_) => None,
        PoiPlace::Object(id) => city.model.find_object(id).map(visibility::Poi::Object),
        PoiPlace::On(_) => None,
    }
}

/// Of which units some cases hold.
struct Cases<'a> {
    when: &'a [When],
    /// The units that each chooses; `None`: it asks for nothing of the kind.
    chosen: Vec<Option<Set>>,
    units: &'a Units,
    city: ShownCity<'a>,
    eye: DVec3,
}

impl<'a> Cases<'a> {
    fn new(when: &'a [When], units: &'a Units, city: ShownCity<'a>, viewer: Viewer) -> Self {
        let chosen_by = |choice| units.flagged(city.model, &members(city.model, choice));
        Self {
            when,
            chosen: when.iter().map(|when| when.of.as_ref().map(chosen_by)).collect(),
            units,
            city,
            eye: viewer.eye,
        }
    }

    /// The first that holds of a unit; where none does, how many there are.
    fn first(&self, unit: u32) -> usize {
        (0..self.when.len()).find(|&case| self.holds(case, unit, 0.0)).unwrap_or(self.when.len())
    }

    /// Whether a case holds of a unit; distances may be larger by a margin, metres.
    fn holds(&self, case: usize, unit: u32, margin: f64) -> bool {
        let Some(When { nearer_m, types, .. }) = self.when.get(case) else { return true };
        let objects = &self.city.model.objects;
        let kind = || self.city.model.strings.get(objects[self.units.roots[unit as usize] as usize].kind);
        let distance = || self.units.boxes[unit as usize].distance_to(self.eye);
        nearer_m.is_none_or(|nearer| distance() < nearer + margin)
            && (types.is_empty() || types.iter().any(|name| name == kind()))
            && self.chosen[case].as_ref().is_none_or(|chosen| chosen.has(unit))
    }
}

impl Known {
    /// Names that the city does not have mean nobody ([`crate::scene::check_against`] says so).
    fn new(of: &Occluders, places: Vec<PoiPlace>, city: ShownCity, units: &Units) -> Self {
        let set = |choice: &Option<_>| match choice {
            None => Set::new(units.len()),
            Some(choice) => units.flagged(city.model, &members(city.model, choice)),
        };
        Self {
            city: city.number,
            of: of.clone(),
            pois: places.iter().filter_map(|place| poi_of(place, city)).collect(),
            places,
            forced: set(&of.force),
            forbidden: set(&of.forbid),
            found: None,
            is_wanted: true,
        }
    }
}
