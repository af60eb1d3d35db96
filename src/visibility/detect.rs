//! A test asked of a city.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::{
    city::{CityModel, spatial::SpatialIndex},
    geom::{
        Aabb,
        shaft::{BoxShaft, SegmentShaft, TriangleShaft},
    },
    visibility::{
        bounds::{self, grown},
        coverage::{Coverage, Sampler},
        set::Set,
        test::Test,
        units::{Poi, Units, Viewer},
    },
};

/// A city, and what finds things in it.
#[derive(Clone, Copy, Debug)]
pub struct Scope<'a> {
    /// The city.
    pub model: &'a CityModel,
    /// Its units.
    pub units: &'a Units,
    /// Finds the triangles that are shown.
    pub index: &'a SpatialIndex,
}

/// A question about occluders.
#[derive(Clone, Copy, Debug)]
pub struct Query<'a> {
    /// From where.
    pub viewer: Viewer,
    /// Points of interest that shall be seen; an occluder of any is one. Those of which nothing is shown are left out.
    pub pois: &'a [Poi],
    /// When something is an occluder.
    pub test: &'a Test,
    /// Units that are one in any case, but for points of interest.
    pub forced: &'a Set,
    /// Units that never are one, forced or not.
    pub forbidden: &'a Set,
    /// Whether shares are measured also where no test asks for them.
    pub measured: bool,
    /// The distance by which an occluder may leave its test before it ceases to be one.
    pub margin: Option<Margin>,
}

/// The distance by which an occluder may leave its test before it ceases to be one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Metres, ≥ 0: reaches and boxes are larger by this, under `not` smaller.
    pub metres: f64,
}

impl Default for Margin {
    /// A step: more than an eye that walks moves up and down.
    fn default() -> Self {
        Self { metres: 1.0 }
    }
}

impl Margin {
    /// By how much less of the share that a test asks for an occluder stays one.
    const SHARE: f64 = 0.25;
}

/// The occluders that were found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detected {
    /// The occluders, as units.
    pub occluders: Set,
    /// Those, and all that stay occluders if they are one.
    pub kept: Set,
    /// Each occluder with its reasons, by units ascending.
    pub list: Vec<Occluder>,
}

/// An occluder, and why it is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Occluder {
    /// Its unit.
    pub unit: u32,
    /// Its root object, by index.
    pub root: u32,
    /// Which tests it was classified by, in the order of the expression: those that held, and `not …` for those under `not` that
    /// did not; `forced`. The second of one kind is `… 2`.
    pub why: Vec<String>,
    /// The largest share of a point of interest that it covers, where one was measured.
    pub coverage: Option<Coverage>,
}

/// A test without parts, asked.
struct Asked {
    name: String,
    is_inverted: bool,
    held: Set,
    coverage: BTreeMap<u32, Coverage>,
}

impl Scope<'_> {
    /// Asks a test.
    pub fn detect(&self, query: &Query) -> Detected {
        let mut asked = Vec::new();
        let [found, kept] = self.ask(query, query.test, false, &mut asked);
        let mut never = query.forbidden.clone();
        query.pois.iter().filter_map(|&poi| self.units.unit_of(poi)).for_each(|unit| never.insert(unit));
        let has_body = |unit: &u32| !self.units.boxes[*unit as usize].is_empty();
        let bodies = |set: Set| {
            let mut out = Set::new(self.units.len());
            set.or(query.forced).without(&never).iter().filter(has_body).for_each(|unit| out.insert(unit));
            out
        };
        let (occluders, kept) = (bodies(found), bodies(kept));
        let list = occluders.iter().map(|unit| self.explained(unit, query, &asked)).collect();
        Detected { occluders, kept, list }
    }

    fn explained(&self, unit: u32, query: &Query, asked: &[Asked]) -> Occluder {
        let reasons = asked.iter().filter(|leaf| leaf.held.has(unit) != leaf.is_inverted).map(|leaf| leaf.name.clone());
        let forced = query.forced.has(unit).then(|| "forced".to_owned());
        let shares = asked.iter().filter_map(|leaf| leaf.coverage.get(&unit).copied());
        Occluder {
            unit,
            root: self.units.roots[unit as usize],
            why: reasons.chain(forced).collect(),
            coverage: shares.max_by(|a, b| a.share.total_cmp(&b.share)),
        }
    }

    /// The units that a test holds for, and those that keep it; `asked` gets the tests that it is put together from.
    fn ask(&self, query: &Query, test: &Test, is_inverted: bool, asked: &mut Vec<Asked>) -> [Set; 2] {
        let mut part = |part: &Test, inverted: bool| self.ask(query, part, inverted, asked);
        let joined = |sets: Vec<[Set; 2]>, join: fn(Set, &Set) -> Set| {
            let both = |[a, b]: [Set; 2], [c, d]: [Set; 2]| [join(a, &c), join(b, &d)];
            sets.into_iter().reduce(both)
        };
        let none = || [Set::new(self.units.len()), Set::new(self.units.len())];
        match test {
            Test::Any(parts) => {
                joined(parts.iter().map(|p| part(p, is_inverted)).collect(), Set::or).unwrap_or_else(none)
            }
            Test::All(parts) => joined(parts.iter().map(|p| part(p, is_inverted)).collect(), Set::and)
                .unwrap_or_else(|| none().map(Set::complement)),
            Test::Not(one) => part(one, !is_inverted).map(Set::complement),
            leaf => {
                let (held, coverage) = self.leaf(query, leaf, 0.0);
                // Under `not` a smaller reach keeps more.
                let kept = match query.margin {
                    None => held.clone(),
                    Some(Margin { metres }) if is_inverted => held.clone().and(&self.leaf(query, leaf, -metres).0),
                    Some(Margin { metres }) => held.clone().or(&self.leaf(query, leaf, metres).0),
                };
                let prefix = if is_inverted { "not " } else { "" };
                let same =
                    asked.iter().filter(|a| a.name.trim_start_matches("not ").split(' ').next() == Some(leaf.word()));
                let name = match same.count() {
                    0 => format!("{prefix}{}", leaf.word()),
                    n => format!("{prefix}{} {}", leaf.word(), n + 1),
                };
                asked.push(Asked { name, is_inverted, held: held.clone(), coverage });
                [held, kept]
            }
        }
    }

    /// The units that a test without parts holds for, with `margin` metres added to its reach, and the shares it measured.
    fn leaf(&self, query: &Query, test: &Test, margin: f64) -> (Set, BTreeMap<u32, Coverage>) {
        match test {
            Test::Exact { coverage, rays } => {
                let mut found = Set::new(self.units.len());
                for &poi in query.pois {
                    self.add_exact(query, poi, margin, &mut found);
                }
                if (*coverage <= 0.0 && !query.measured) || found.count() == 0 {
                    return (found, BTreeMap::new());
                }
                let shares = self.shares(query, &found, (*rays).max(1));
                let wanted = coverage * if margin == 0.0 { 1.0 } else { 1.0 - Margin::SHARE * margin.signum() };
                let mut enough = Set::new(self.units.len());
                let share = |unit: u32| shares.get(&unit).map_or(0.0, |c| c.share);
                found.iter().filter(|&unit| share(unit) >= wanted).for_each(|unit| enough.insert(unit));
                (enough, shares)
            }
            Test::Route { points } => {
                let mut found = Set::new(self.units.len());
                for ends in points.windows(2) {
                    let ends = [ends[0], ends[1]];
                    let around = grown(&Aabb::from_points(ends), margin.max(0.0));
                    let shaft = SegmentShaft::new(query.viewer.eye_for(&around), ends);
                    self.add_meeting(
                        &Set::new(self.units.len()),
                        &mut found,
                        |bounds| shaft.may_meet(bounds),
                        |t| shaft.meets(t),
                    );
                    if margin > 0.0 {
                        let eye = query.viewer.eye_for(&around);
                        let shaft = BoxShaft::new(eye, &around);
                        let never = Set::new(self.units.len());
                        self.add_meeting(&never, &mut found, |bounds| shaft.may_meet(bounds), |t| shaft.meets(t));
                    }
                }
                (found, BTreeMap::new())
            }
            _ => {
                let found = bounds::units_of(test, self.units, &query.viewer, query.pois, margin);
                (found.unwrap_or_else(|| Set::new(self.units.len())), BTreeMap::new())
            }
        }
    }

    /// Adds the units that are on sight lines to a point of interest, before it.
    fn add_exact(&self, query: &Query, poi: Poi, margin: f64, found: &mut Set) {
        let own = self.units.box_of(poi);
        if own.is_empty() {
            return;
        }
        let target = if margin == 0.0 { own } else { grown(&own, margin) };
        let eye = query.viewer.eye_for(&target);
        let shaft = BoxShaft::new(eye, &target);
        let unit = self.units.unit_of(poi);
        let faces = unit.map_or_else(Vec::new, |unit| self.faces_of(unit, eye));
        let mut never = query.forbidden.clone();
        unit.into_iter().for_each(|unit| never.insert(unit));
        self.add_meeting(
            &never,
            found,
            |bounds| shaft.may_meet(bounds) || bounds.meets(&target),
            |t| shaft.meets(t) || (Aabb::from_points(*t).meets(&target) && faces.iter().any(|face| face.meets(t))),
        );
    }

    /// The shafts to the faces that are shown of a unit.
    fn faces_of(&self, unit: u32, eye: DVec3) -> Vec<TriangleShaft> {
        let own = self.units.geometries(unit).iter().map(|&g| &self.model.geometries[g as usize]);
        let tiles = own.flat_map(|g| &self.model.tiles[g.tiles.start as usize..g.tiles.end as usize]);
        tiles
            .flat_map(|tile| {
                let corner = |i: u32| self.model.position(tile, tile.vertices.start + self.model.indices[i as usize]);
                tile.indices.clone().step_by(3).map(move |i| [corner(i), corner(i + 1), corner(i + 2)])
            })
            .filter_map(|corners| TriangleShaft::new(eye, corners))
            .collect()
    }

    /// Adds the units of which a triangle meets something; those of `never`, and those found already, are not asked.
    fn add_meeting(
        &self,
        never: &Set,
        found: &mut Set,
        may_meet: impl Fn(&Aabb) -> bool,
        meets: impl Fn(&[DVec3; 3]) -> bool,
    ) {
        let found = std::cell::RefCell::new(found);
        let object_of = |tile: u32| self.model.geometries[self.model.tiles[tile as usize].geometry as usize].object;
        self.index.triangles_where(
            self.model,
            &may_meet,
            |tile| {
                let object = object_of(tile);
                let unit = self.units.of_object[object as usize];
                let is_ground = self.model.objects[object as usize].class.is_ground();
                !is_ground && !never.has(unit) && !found.borrow().has(unit)
            },
            |tile, corners| {
                let is_met = meets(corners);
                if is_met {
                    found.borrow_mut().insert(self.units.of_object[object_of(tile) as usize]);
                }
                !is_met
            },
        );
    }

    /// The largest share of a point of interest that each of some units covers.
    fn shares(&self, query: &Query, units: &Set, rays: u32) -> BTreeMap<u32, Coverage> {
        let mut largest: BTreeMap<u32, Coverage> = BTreeMap::new();
        for &poi in query.pois {
            let bounds = self.units.box_of(poi);
            if bounds.is_empty() {
                continue;
            }
            let eye = query.viewer.eye_for(&bounds);
            let sampler = Sampler { model: self.model, index: self.index, of_object: &self.units.of_object, eye };
            let Some((met, counts)) = sampler.count(self.units.unit_of(poi), &bounds, rays) else { continue };
            for unit in units.iter() {
                let share = Coverage::of(counts.get(&unit).copied().unwrap_or(0), met);
                let entry = largest.entry(unit).or_insert(share);
                if share.share > entry.share {
                    *entry = share;
                }
            }
        }
        largest
    }
}
