//! What moments show in a scene: which objects are there, and what lenses do to the moment, as the GPU reads it.

use std::sync::{Arc, Mutex, PoisonError};

use crate::{
    city::{
        CityModel,
        lifetime::{Dating, Lifetime, Lifetimes},
    },
    lens::{Lens, Operator, epoch::TIMELESS},
    render::hiding::Presence,
    scene::Scene,
    time::Moment,
};

/// The moments of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Epochs {
    /// The scene's own; `None`: all objects are there.
    pub moment: Option<Moment>,
    /// What lenses do to it, by lens, ascending; of a lens in order.
    pub operators: Vec<(u32, Operator)>,
    /// The first and the last moment that shows anywhere; `None`: none does.
    pub range: Option<[Moment; 2]>,
}

impl Epochs {
    /// Of a scene's enabled lenses that have a focus area; those with an overlay show their moment in it.
    ///
    /// # Errors
    /// A step of a lens: whose, and what would be right.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        let mut out = Self { moment: scene.moment, ..Self::default() };
        let mut range = scene.moment.map(|moment| [moment; 2]);
        for (lens, number) in scene.lenses.iter().zip(0..).filter(|(lens, _)| is_in_space(lens)) {
            let mut own = range;
            for step in &lens.time {
                let operator = Operator::new(step, scene.time_s)
                    .map_err(|message| format!("lens \"{}\": time, \"{}\": {message}", lens.name, step.handler))?;
                own = operator.range(own);
                out.operators.push((number, operator));
            }
            range = union(range, own);
        }
        out.range = range;
        Ok(out)
    }

    /// Whether a moment shows anywhere.
    pub fn is_any(&self) -> bool {
        self.range.is_some()
    }

    /// The moment that shows where the lenses that `is_inside` hold a place.
    pub fn moment_at(&self, is_inside: impl Fn(u32) -> bool) -> Option<Moment> {
        let mut moment = self.moment;
        for steps in self.operators.chunk_by(|a, b| a.0 == b.0) {
            if is_inside(steps[0].0) {
                moment = steps.iter().fold(moment, |moment, (_, operator)| operator.apply(moment));
            }
        }
        moment
    }

    /// Of each object whether it is there at the moments that show.
    pub fn presence(&self, lifetimes: &Lifetimes) -> Vec<Presence> {
        let Some([first, last]) = self.range else { return vec![Presence::Always; lifetimes.of.len()] };
        let of = |lifetime: &Lifetime| {
            let begins = lifetime.begin.unwrap_or(Moment::FIRST);
            // Where no moment shows, all is there.
            let is_apart = lifetime.is_never || begins > last || lifetime.end.is_some_and(|end| end <= first);
            match lifetime.holds(Some(first)) && lifetime.holds(Some(last)) {
                true => Presence::Always,
                false if is_apart && self.moment.is_some() => Presence::Never,
                false => Presence::Sometimes,
            }
        };
        lifetimes.of.iter().map(of).collect()
    }

    /// What effects read of objects, from its first word on: `lib/lifetime.wgsl` says how it lies. Then, for each operator, where its words
    /// begin. `lifetimes`: of the scene's own city, then of contents, as their objects follow each other.
    pub fn words(&self, lifetimes: &[Arc<Lifetimes>]) -> (Vec<u32>, Vec<u32>) {
        let of = |moment: Option<Moment>| moment.map_or(TIMELESS, Moment::words);
        let [first, last] = self.range.map_or([None; 2], |range| range.map(Some));
        let mut words = Vec::new();
        words.extend(of(self.moment));
        words.extend([0, 0]);
        words.extend(of(first));
        words.extend(of(last));
        let mut begins = Vec::new();
        for (_, operator) in &self.operators {
            begins.push(words.len() as u32);
            words.extend(&operator.words);
        }
        words[2] = words.len() as u32;
        words.extend(Lifetime::ALWAYS.words());
        words.extend(lifetimes.iter().flat_map(|lifetimes| &lifetimes.of).flat_map(|lifetime| lifetime.words()));
        (words, begins)
    }
}

/// Whether a lens acts in the space of the picture.
fn is_in_space(lens: &Lens) -> bool {
    lens.enabled && !lens.kind.has_overlay()
}

fn union(a: Option<[Moment; 2]>, b: Option<[Moment; 2]>) -> Option<[Moment; 2]> {
    match (a, b) {
        (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
        (one, other) => one.or(other),
    }
}

/// Lifetimes of cities, worked out when they are first asked for.
#[derive(Debug, Default)]
pub struct KnownLifetimes(Mutex<Vec<Known>>);

#[derive(Debug)]
struct Known {
    model: Arc<CityModel>,
    dating: Dating,
    lifetimes: Arc<Lifetimes>,
}

/// Cities whose lifetimes are kept.
const MOST_KNOWN: usize = 32;

impl KnownLifetimes {
    /// Of a city.
    ///
    /// # Errors
    /// An attribute that is asked for is not there.
    pub fn of(&self, model: &Arc<CityModel>, dating: &Dating) -> Result<Arc<Lifetimes>, String> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |one: &Known| Arc::ptr_eq(&one.model, model) && one.dating == *dating;
        if let Some(one) = known.iter().find(|one| is_it(one)) {
            return Ok(one.lifetimes.clone());
        }
        let lifetimes = Arc::new(Lifetimes::new(model, dating)?);
        if known.len() == MOST_KNOWN {
            known.remove(0);
        }
        known.push(Known { model: model.clone(), dating: dating.clone(), lifetimes: lifetimes.clone() });
        Ok(lifetimes)
    }
}
