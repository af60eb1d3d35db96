//! Who hides what, for the eye of a picture (O2): worked out again only where the eye, a point of interest or the test is another (O6).
//!
//! A picture knows nothing of what was before it, unless time was made to pass: [`Occlusion::pass`].

use std::{collections::BTreeMap, sync::Arc};

use crate::{
    geom::Aabb,
    lens::{Occluders, chosen::members, rendering::When, solids::ShownCity},
    render::stats,
    scene::{Poi, PoiPlace},
    visibility::{self, Detected, Memory, Query, Scope, Set, Units, Viewer},
};

/// What is known of the occluders that lenses look for.
#[derive(Debug, Default)]
pub struct Occlusion {
    units: Option<Arc<Units>>,
    known: Vec<Known>,
    /// Over time, by the names of lenses.
    remembered: BTreeMap<String, Remembered>,
    /// Tests asked so far.
    asked: u64,
}

/// The occluders of one lens over time.
#[derive(Debug)]
struct Remembered {
    memory: Memory,
    /// For whom and from where the last step was made: pictures of other moments have no history.
    asked: Asked,
    shown: ShownOccluders,
}

/// Whom a lens looks for, and from where.
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

/// What is drawn as an occluder.
#[derive(Clone, Debug)]
pub struct ShownOccluders {
    /// One flag per object of the city: whether it is one, be it in part.
    pub objects: Arc<[bool]>,
    /// Where some come or go, how far each object has come, 0 to 1.
    pub weights: Option<Arc<[f32]>>,
}

/// The occluders of one lens, or of several that look for the same.
#[derive(Debug)]
struct Known {
    /// Of whom.
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

/// What is worked out beside who is an occluder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct How {
    /// Shares also where no test asks for them.
    is_measured: bool,
    /// Who stays one.
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

impl Occlusion {
    /// The occluders of a lens, by its name: as remembered, if time was made to pass up to here, else as they are found. Of
    /// some cases those that the last one holds of, and none before it; without a case all.
    pub fn objects(
        &mut self,
        lens: &str,
        (of, when): (&Occluders, &[When]),
        pois: &[Poi],
        city: ShownCity,
        viewer: Viewer,
    ) -> ShownOccluders {
        let (shown, occluders) = match self.memory_of(lens, of, pois, viewer) {
            Some(remembered) => (remembered.shown.clone(), remembered.memory.shown()),
            None => {
                let Found { objects, detected, .. } = self.found(of, pois, city, viewer, How::default());
                (ShownOccluders { objects, weights: None }, detected.occluders.clone())
            }
        };
        if when.is_empty() {
            return shown;
        }
        let units = self.units_of(city);
        let (mut left, mut of_case) = (occluders, Set::new(units.len()));
        for case in when {
            of_case = held(case, &left, &units, city, viewer);
            left = left.without(&of_case);
        }
        let objects: Arc<[bool]> = units.objects_of(city.model, &of_case).into();
        let of_these = |weights: Arc<[f32]>| -> Arc<[f32]> {
            objects.iter().zip(&weights[..]).map(|(is, weight)| if *is { *weight } else { 0.0 }).collect()
        };
        let weights = shown.weights.map(of_these);
        ShownOccluders { objects, weights }
    }

    /// Per object of the city, how far it is drawn as an occluder of a lens, by its name, 0 to 1; `None` where no time passed for it.
    pub fn weights(&self, lens: &str) -> Option<Vec<f32>> {
        let ShownOccluders { objects, weights } = &self.remembered.get(lens)?.shown;
        let settled = || objects.iter().map(|is| f32::from(u8::from(*is))).collect();
        Some(weights.as_ref().map_or_else(settled, |weights| weights.to_vec()))
    }

    fn memory_of(&self, lens: &str, of: &Occluders, pois: &[Poi], viewer: Viewer) -> Option<&Remembered> {
        self.remembered.get(lens).filter(|remembered| remembered.asked == Asked::new(of, pois, viewer))
    }

    /// Time goes on by `dt` seconds, ≥ 0, to a moment when lenses look for these occluders; those that were not there before
    /// begin settled (O6).
    pub fn pass(&mut self, lenses: &[(&str, &Occluders)], pois: &[Poi], city: ShownCity, viewer: Viewer, dt: f64) {
        self.remembered.retain(|name, _| lenses.iter().any(|(lens, _)| lens == name));
        for (lens, of) in lenses {
            let how = How { has_margin: true, ..How::default() };
            let detected = self.found(of, pois, city, viewer, how).detected;
            let memory = match self.remembered.remove(*lens) {
                None => Memory::settled(&detected),
                Some(Remembered { mut memory, .. }) => {
                    memory.step(&detected, of.pace, dt);
                    memory
                }
            };
            let units = self.units_of(city);
            let of_object = units.of_object.iter().zip(&city.model.objects);
            let weights: Vec<f32> = of_object
                .map(
                    |(&unit, object)| {
                        if object.class.is_ground() { 0.0 } else { memory.weights()[unit as usize] as f32 }
                    },
                )
                .collect();
            let shown = ShownOccluders {
                objects: weights.iter().map(|weight| *weight > 0.0).collect(),
                weights: weights.iter().any(|weight| *weight > 0.0 && *weight < 1.0).then(|| weights.into()),
            };
            let asked = Asked::new(of, pois, viewer);
            self.remembered.insert((*lens).to_owned(), Remembered { memory, asked, shown });
        }
        self.forget_others();
    }

    /// The occluders of a lens with their reasons, the shares that they cover and, over time, how far they have come.
    pub fn explained(
        &mut self,
        lens: &str,
        of: &Occluders,
        pois: &[Poi],
        city: ShownCity,
        viewer: Viewer,
    ) -> Vec<stats::Occluder> {
        let how = How { is_measured: true, ..How::default() };
        let detected = self.found(of, pois, city, viewer, how).detected;
        let id = |root: u32| city.model.objects[root as usize].id.to_string();
        let one = |occluder: &visibility::Occluder| stats::Occluder {
            id: id(occluder.root),
            why: occluder.why.clone(),
            coverage: occluder.coverage.map(|c| stats::Coverage { share: c.share, low: c.low, high: c.high }),
            weight: None,
        };
        let found = detected.list.iter().map(|occluder| (occluder.unit, one(occluder)));
        let Some(memory) = self.memory_of(lens, of, pois, viewer).map(|remembered| &remembered.memory) else {
            return found.map(|(_, occluder)| occluder).collect();
        };
        let mut all: BTreeMap<u32, stats::Occluder> = found.collect();
        let Some(units) = &self.units else { return Vec::new() };
        for (unit, &weight) in (0..).zip(memory.weights()).filter(|(_, weight)| **weight > 0.0) {
            let kept = memory.is_occluder(unit).then(|| "kept".to_owned()).into_iter().collect();
            let gone = || stats::Occluder { id: id(units.roots[unit as usize]), why: kept, ..Default::default() };
            all.entry(unit).or_insert_with(gone).weight = Some(weight);
        }
        all.into_values()
            .map(|occluder| stats::Occluder { weight: occluder.weight.or(Some(0.0)), ..occluder })
            .collect()
    }

    /// How many tests were asked of the city so far; what is known already is not asked again.
    pub fn asked(&self) -> u64 {
        self.asked
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
        self.units.get_or_insert_with(|| Arc::new(Units::new(city.model, city.geometries))).clone()
    }

    fn found(&mut self, of: &Occluders, pois: &[Poi], city: ShownCity, viewer: Viewer, how: How) -> Found {
        let units = self.units_of(city);
        let Asked { places, .. } = Asked::new(of, pois, viewer);
        let is_same = |known: &Known| known.of == *of && known.places == places;
        let at = self.known.iter().position(is_same).unwrap_or_else(|| {
            self.known.push(Known::new(of, places.clone(), city, &units));
            self.known.len() - 1
        });
        let known = &mut self.known[at];
        known.is_wanted = true;
        if let Some(found) = known.found.as_ref().filter(|found| found.viewer == viewer && found.how.serves(how)) {
            return found.clone();
        }
        let query = Query {
            viewer,
            pois: &known.pois,
            test: &of.test,
            forced: &known.forced,
            forbidden: &known.forbidden,
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

/// What a place means in the city.
fn poi_of(place: &PoiPlace, city: ShownCity) -> Option<visibility::Poi> {
    match place {
        PoiPlace::At(at) => Some(visibility::Poi::At(*at)),
        PoiPlace::Object(id) => city.model.find_object(id).map(visibility::Poi::Object),
    }
}

/// The units among some that a case holds of.
fn held(when: &When, among: &Set, units: &Units, city: ShownCity, viewer: Viewer) -> Set {
    let mut held = Set::new(units.len());
    let chosen = when.of.as_ref().map(|choice| units.flagged(city.model, &members(city.model, choice)));
    let kind = |unit: u32| city.model.strings.get(city.model.objects[units.roots[unit as usize] as usize].kind);
    for unit in among.iter() {
        let distance = || units.boxes[unit as usize].distance_to(viewer.eye);
        let is_near = when.nearer_m.is_none_or(|nearer| distance() < nearer);
        let is_of_type = when.types.is_empty() || when.types.iter().any(|name| name == kind(unit));
        if is_near && is_of_type && chosen.as_ref().is_none_or(|chosen| chosen.has(unit)) {
            held.insert(unit);
        }
    }
    held
}

impl Known {
    /// Names that the city does not have mean nobody ([`crate::scene::check_against`] says so).
    fn new(of: &Occluders, places: Vec<PoiPlace>, city: ShownCity, units: &Units) -> Self {
        let set = |choice: &Option<_>| match choice {
            None => Set::new(units.len()),
            Some(choice) => units.flagged(city.model, &members(city.model, choice)),
        };
        Self {
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
