//! Two states of a city compared: what came, what went, and what became of the rest.
//!
//! ```text
//! keys, ids, predecessors ─> pairs (`matching`) ─┬─ faces (`shape`) ───────┬─> differences ─ along parents (`families`) ─> states
//!                                                └─ attributes (`attributes`) ┘
//! ```
//!
//! **Faces** are compared level of detail by level of detail, on the grids of the files: corners are the same where they are at most half a
//! step of the coarser grid apart along each axis (and 15 µm for how models keep them). It matters neither in which order corners, rings,
//! faces and geometries stand, nor where rings begin, nor how flat faces are cut, into triangles or several faces. Corners on straight edges
//! count. What is not compared: points and lines, faces that are refused, types and attributes of semantic surfaces, materials, textures.
//!
//! **Attributes** are compared by name: numbers by what they count, lists and tables by what they hold; null is as good as nothing.
//!
//! All of it takes time and memory in proportion to both cities.

mod attributes;
mod families;
mod matching;
mod shape;
mod state;

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

pub use self::{
    attributes::AttributeChange,
    shape::FLOAT_STEP_M,
    state::{AttributeCounts, CompareError, Compared, Counts, Key, MatchedBy, RepeatedKey, Side, State},
};
use self::{
    attributes::Texts,
    families::Families,
    matching::{Matching, Pair},
    shape::Shape,
    state::Differences,
};
use crate::city::model::{CityModel, StringId};

/// What became of the objects of a city.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Of each object of the earlier state.
    pub before: Vec<Compared>,
    /// Of each object of the later state.
    pub after: Vec<Compared>,
    /// All objects, each for itself.
    pub objects: Counts,
    /// Objects without parents in one state at least, each with all below it.
    pub roots: Counts,
    /// Attributes of objects that are in both states and whose values differ, most first, then by name.
    pub attributes: Vec<(String, AttributeCounts)>,
    /// Objects in both states whose type differs.
    pub types_changed: u64,
    /// Values of the key that several objects of one state have: these objects are matched by id or not at all.
    pub repeated_keys: Vec<RepeatedKey>,
    /// How far corners may be apart along each axis and be the same, metres: on the coarsest grid of both states.
    pub tolerance: DVec3,
}

impl Comparison {
    /// Compares an earlier state of a city with a later one.
    ///
    /// # Errors
    /// Coordinates of both do not mean the same places; no object of one has the attribute that is the key.
    pub fn new(before: &CityModel, after: &CityModel, key: &Key) -> Result<Self, CompareError> {
        are_in_one_place(before, after)?;
        let matching = Matching::new(before, after, key)?;
        let texts = Texts::new(before, after);
        let own: Vec<Differences> =
            matching.pairs.par_iter().map(|pair| differences(before, after, &texts, *pair)).collect();
        let rolled_up = Families::new(before, after, &matching).rolled_up(&own);
        let compared = |pair: u32, without: State| match matching.pairs.get(pair as usize) {
            None => Compared { counterpart: None, by: None, own: without, state: without },
            Some(found) => {
                let counterpart = if without == State::Removed { found.after } else { found.before };
                let [own, state] = [&own, &rolled_up].map(|all| all[pair as usize].state());
                Compared { counterpart: Some(counterpart), by: Some(found.by), own, state }
            }
        };
        let mut this = Self {
            before: matching.of_before.iter().map(|pair| compared(*pair, State::Removed)).collect(),
            after: matching.of_after.iter().map(|pair| compared(*pair, State::Added)).collect(),
            tolerance: tolerance(before, after),
            ..Self::default()
        };
        this.count(before, after);
        this.count_attributes(before, after, &texts, &matching.pairs);
        this.repeated_keys = matching.repeated;
        Ok(this)
    }

    /// Hands over each attribute that differs with its object of the later state, in the order of objects.
    pub fn each_change<'a>(
        &self,
        before: &'a CityModel,
        after: &'a CityModel,
        change: &mut dyn FnMut(u32, AttributeChange<'a>),
    ) {
        let texts = Texts::new(before, after);
        for (object, compared) in (0..).zip(&self.after) {
            let is_other = matches!(compared.own, State::Changed { attributes: true, .. });
            if let Some(old) = compared.counterpart.filter(|_| is_other) {
                texts.each_change(old, object, &mut |one| change(object, one));
            }
        }
    }

    fn count(&mut self, before: &CityModel, after: &CityModel) {
        let removed = self.before.iter().zip(&before.objects).filter(|(compared, _)| compared.counterpart.is_none());
        for (compared, object) in removed.chain(self.after.iter().zip(&after.objects)) {
            self.objects.add(compared.own);
            let counterpart = compared.counterpart.map(|old| &before.objects[old as usize]);
            if object.parents.is_empty() || counterpart.is_some_and(|old| old.parents.is_empty()) {
                self.roots.add(compared.state);
            }
        }
    }

    fn count_attributes(&mut self, before: &CityModel, after: &CityModel, texts: &Texts, pairs: &[Pair]) {
        let mut counts: FxHashMap<&str, AttributeCounts> = FxHashMap::default();
        self.each_change(before, after, &mut |_, change| {
            use crate::city::model::Value::Null;
            let count = counts.entry(change.name).or_default();
            match (change.before, change.after) {
                (Null, _) => count.added += 1,
                (_, Null) => count.removed += 1,
                _ => count.changed += 1,
            }
        });
        self.attributes = counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect();
        self.attributes.sort_unstable_by(|a, b| b.1.total().cmp(&a.1.total()).then_with(|| a.0.cmp(&b.0)));
        let is_other = |pair: &&Pair| !texts.are_same(kind(before, pair.before), kind(after, pair.after));
        self.types_changed = pairs.iter().filter(is_other).count() as u64;
    }
}

/// What differs in an object itself.
fn differences(before: &CityModel, after: &CityModel, texts: &Texts, pair: Pair) -> Differences {
    let mut attributes = !texts.are_same(kind(before, pair.before), kind(after, pair.after));
    texts.each_change(pair.before, pair.after, &mut |_| attributes = true);
    let old = Shape { model: before, object: pair.before };
    let new = Shape { model: after, object: pair.after };
    Differences { geometry: !shape::are_same(old, new), attributes }
}

fn kind(model: &CityModel, object: u32) -> StringId {
    model.objects[object as usize].kind
}

/// Whether coordinates of both mean the same places, as far as both say where they are.
fn are_in_one_place(before: &CityModel, after: &CityModel) -> Result<(), CompareError> {
    let name = |model: &CityModel| model.crs.clone().or_else(|| model.crs_raw.clone());
    if let (Some(old), Some(new)) = (name(before), name(after))
        && old != new
    {
        return Err(CompareError::References { before: old, after: new });
    }
    let (old, new) = (before.frames, after.frames);
    let are_others = old.zone.zip(new.zone).is_some_and(|(old, new)| old != new)
        || old.local.zip(new.local).is_some_and(|(old, new)| old != new);
    if are_others { Err(CompareError::Frames) } else { Ok(()) }
}

/// The tolerance on the coarsest grid of both.
fn tolerance(before: &CityModel, after: &CityModel) -> DVec3 {
    let coarsest = |model: &CityModel| {
        model.geometries.iter().fold(DVec3::ZERO, |step, geometry| step.max(shape::step_of(model, geometry)))
    };
    shape::tolerance(coarsest(before).max(coarsest(after)))
}

#[cfg(test)]
mod tests;
