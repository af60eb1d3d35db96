//! Who hides what, for the eye of a picture (O2): worked out again only where the eye, a point of interest or the test is another (O6).

use std::sync::Arc;

use crate::{
    geom::Aabb,
    lens::{Occluders, chosen::members, rendering::When, solids::ShownCity},
    render::stats,
    scene::{Poi, PoiPlace},
    visibility::{self, Detected, Query, Scope, Set, Units, Viewer},
};

/// What is known of the occluders that lenses look for.
#[derive(Debug, Default)]
pub struct Occlusion {
    units: Option<Arc<Units>>,
    known: Vec<Known>,
    /// Tests asked so far.
    asked: u64,
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

#[derive(Clone, Debug)]
struct Found {
    viewer: Viewer,
    is_measured: bool,
    detected: Arc<Detected>,
    objects: Arc<[bool]>,
}

impl Occlusion {
    /// The objects of all occluders, one flag per object of the city.
    pub fn objects(&mut self, of: &Occluders, pois: &[Poi], city: ShownCity, viewer: Viewer) -> Arc<[bool]> {
        self.found(of, pois, city, viewer, false).objects
    }

    /// Those of the occluders that the last of some cases holds of, and none before it.
    pub fn objects_of_case(
        &mut self,
        of: &Occluders,
        when: &[When],
        pois: &[Poi],
        city: ShownCity,
        viewer: Viewer,
    ) -> Arc<[bool]> {
        let detected = self.found(of, pois, city, viewer, false).detected;
        let units = self.units_of(city);
        let mut left = detected.occluders.clone();
        let mut of_case = Set::new(units.len());
        for case in when {
            of_case = held(case, &left, &units, city, viewer);
            left = left.without(&of_case);
        }
        units.objects_of(city.model, &of_case).into()
    }

    /// The occluders with their reasons and the shares that they cover.
    pub fn explained(&mut self, of: &Occluders, pois: &[Poi], city: ShownCity, viewer: Viewer) -> Vec<stats::Occluder> {
        let detected = self.found(of, pois, city, viewer, true).detected;
        let one = |occluder: &visibility::Occluder| stats::Occluder {
            id: city.model.objects[occluder.root as usize].id.to_string(),
            why: occluder.why.clone(),
            coverage: occluder.coverage.map(|c| stats::Coverage { share: c.share, low: c.low, high: c.high }),
        };
        detected.list.iter().map(one).collect()
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

    fn found(&mut self, of: &Occluders, pois: &[Poi], city: ShownCity, viewer: Viewer, measured: bool) -> Found {
        let units = self.units_of(city);
        let place_of = |name: &String| pois.iter().find(|poi| poi.name == *name).map(|poi| &poi.place);
        let is_same = |known: &Known| known.of == *of && known.places.iter().eq(of.pois.iter().filter_map(place_of));
        let at = self.known.iter().position(is_same).unwrap_or_else(|| {
            let places = of.pois.iter().filter_map(place_of).cloned().collect();
            self.known.push(Known::new(of, places, city, &units));
            self.known.len() - 1
        });
        let known = &mut self.known[at];
        known.is_wanted = true;
        let is_right = |found: &&Found| found.viewer == viewer && (found.is_measured || !measured);
        if let Some(found) = known.found.as_ref().filter(is_right) {
            return found.clone();
        }
        let query = Query {
            viewer,
            pois: &known.pois,
            test: &of.test,
            forced: &known.forced,
            forbidden: &known.forbidden,
            measured,
            margin: None,
        };
        let detected = Scope { model: city.model, units: &units, index: city.index() }.detect(&query);
        self.asked += 1;
        let objects = units.objects_of(city.model, &detected.occluders).into();
        let found = Found { viewer, is_measured: measured, detected: Arc::new(detected), objects };
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
