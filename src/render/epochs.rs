//! What moments show in a scene: which objects are there, and what lenses do to the moment, as the GPU reads it.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::{
    city::{
        CityModel,
        lifetime::{Dating, Lifetime, Lifetimes},
    },
    geom::{Aabb, Volume},
    lens::{
        Lens, Operator,
        epoch::{Ghosts, Instant, InstantOf, linked},
    },
    render::hiding::{Presence, rounded},
    scene::Scene,
    time::{DAY, Moment, Span},
};

/// The moments of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Epochs {
    /// The scene's own, which show together, each with how much it counts: one, or several. `None`: all objects are there.
    pub own: Vec<(Option<Moment>, f64)>,
    /// What shows by halves beside them.
    ghosts: Ghosts,
    /// Whether what is there at some of them is there whole.
    shows_any: bool,
    /// What lenses do to them, by lens, ascending; of a lens in order.
    pub operators: Vec<(u32, Operator)>,
    /// The first and the last moment that shows anywhere; `None`: none does.
    pub range: Option<[Moment; 2]>,
}

impl Default for Epochs {
    fn default() -> Self {
        Self { own: vec![(None, 1.0)], ghosts: Ghosts::NONE, shows_any: false, operators: Vec::new(), range: None }
    }
}

/// Combinations of the moments that show together, of all operators of a scene, at most: objects are asked in each.
const MOST_COMBINATIONS: usize = 64;

impl Epochs {
    /// Of a scene's enabled lenses that have a focus area; those with an overlay show their moment in it.
    ///
    /// # Errors
    /// A step of a lens: whose, and what would be right. More combinations of moments than can be shown together.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        let mut out = Self { own: vec![(scene.moment, 1.0)], ..Self::default() };
        let mut range = scene.moment.map(|moment| [moment; 2]);
        let steps =
            linked(&scene.time_steps, &scene.lenses).map_err(|wrong| format!("[time] steps, \"link\": {wrong}"))?;
        for step in &steps {
            let operator = Operator::new(step, scene.time_s)
                .map_err(|message| format!("[time] steps, \"{}\": {message}", step.handler))?;
            range = operator.range(range);
            out.own = together(&out.own, std::slice::from_ref(&operator));
            out.ghosts = operator.ghosts().unwrap_or(out.ghosts);
            out.shows_any |= operator.shows_any();
        }
        for (lens, number) in scene.lenses.iter().zip(0..).filter(|(lens, _)| is_in_space(lens)) {
            let mut own = range;
            let steps = linked(&lens.time, &scene.lenses)
                .map_err(|wrong| format!("lens \"{}\": time, \"link\": {wrong}", lens.name))?;
            for step in &steps {
                let operator = Operator::new(step, scene.time_s)
                    .map_err(|message| format!("lens \"{}\": time, \"{}\": {message}", lens.name, step.handler))?;
                own = operator.range(own);
                out.operators.push((number, operator));
            }
            range = union(range, own);
        }
        out.range = range;
        match out.combinations() {
            0..=MOST_COMBINATIONS => Ok(out),
            count => Err(format!(
                "aggregates: their moments make {count} combinations, at most {MOST_COMBINATIONS} would be right; take fewer moments, or fewer \
                 lenses with several"
            )),
        }
    }

    /// Whether a moment shows anywhere.
    pub fn is_any(&self) -> bool {
        self.range.is_some()
    }

    /// Whether something of cities may be there by halves: at some of several moments, or fading, or in outline.
    pub fn is_partly(&self, lifetimes: &[Arc<Lifetimes>]) -> bool {
        let has_ghosts = || lifetimes.iter().any(|lifetimes| lifetimes.of.iter().any(|of| of.is_ghost()));
        let is_partly = |operator: &Operator| !operator.instants().is_empty() || operator.ghosts().is_some();
        self.own.len() > 1
            || self.ghosts != Ghosts::NONE
            || self.operators.iter().any(|(_, own)| is_partly(own))
            || has_ghosts()
    }

    /// Combinations of the moments that show together.
    fn combinations(&self) -> usize {
        let of_operators = self.operators.iter().map(|(_, operator)| operator.instants().len().max(1));
        of_operators.fold(self.own.len(), usize::saturating_mul)
    }

    /// The longest of all ghosts.
    fn reach(&self) -> Ghosts {
        let all = self.operators.iter().filter_map(|(_, operator)| operator.ghosts());
        let longer = |a: Span, b: Span| if a.mean_micros() < b.mean_micros() { b } else { a };
        all.fold(self.ghosts, |a, b| Ghosts { past: longer(a.past, b.past), future: longer(a.future, b.future) })
    }

    /// Whether the edges of what is not there yet are drawn in a lens with operators that say so, or outside all (`None`).
    pub fn draws_future(&self, lens: Option<u32>) -> bool {
        let of_lens = |lens: u32| {
            let own = self.operators.iter().filter(|(of, _)| *of == lens);
            own.filter_map(|(_, operator)| operator.ghosts()).any(|ghosts| !ghosts.future.is_none())
        };
        lens.map_or(!self.ghosts.future.is_none(), of_lens)
    }

    /// The moments that show together where the lenses that `is_inside` hold a place, ascending, each once with how much it counts.
    pub fn moments_at(&self, is_inside: impl Fn(u32) -> bool) -> Vec<(Option<Moment>, f64)> {
        let mut moments = self.own.clone();
        for steps in self.operators.chunk_by(|a, b| a.0 == b.0) {
            if is_inside(steps[0].0) {
                moments = steps.iter().fold(moments, |at, (_, operator)| together(&at, std::slice::from_ref(operator)));
            }
        }
        moments
    }

    /// The lenses with operators, ascending: a lens' place among them is its bit.
    pub fn lenses(&self) -> Vec<u32> {
        let mut lenses: Vec<u32> = self.operators.iter().map(|(lens, _)| *lens).collect();
        lenses.dedup();
        lenses
    }

    /// Of each object whether it is there at the moments that may show of it: those of all combinations of the lenses that may hold some of it.
    pub fn presence(&self, lifetimes: &Lifetimes, met: &MetLenses) -> Vec<Presence> {
        let mut moments: FxHashMap<Met, Option<Vec<Option<Moment>>>> = FxHashMap::default();
        let fades = |lifetime: &Lifetime, at: &Option<Moment>, past: Span| {
            let gone =
                lifetime.end.filter(|end| lifetime.is_dated() && lifetime.begin.is_none_or(|begin| begin < *end));
            gone.zip(*at).is_some_and(|(end, at)| end <= at && at < end.shifted(past))
        };
        let past = self.reach().past;
        let of = |(lifetime, object): (&Lifetime, usize)| {
            if *lifetime == Lifetime::ALWAYS {
                return Presence::Always;
            }
            let lenses = met.of(object);
            let Some(moments) = moments.entry(lenses).or_insert_with(|| self.moments_of(lenses)) else {
                return Presence::Sometimes;
            };
            let there = moments.iter().filter(|moment| lifetime.holds(**moment)).count();
            match there {
                _ if lifetime.is_ghost() => Presence::Sometimes,
                0 if moments.iter().any(|moment| fades(lifetime, moment, past)) => Presence::Sometimes,
                0 => Presence::Never,
                all if all == moments.len() => Presence::Always,
                _ => Presence::Sometimes,
            }
        };
        lifetimes.of.iter().zip(0..).map(of).collect()
    }

    /// The moments of all combinations of the lenses that may hold some of an object, each once; `None`: too many.
    pub fn moments_of(&self, lenses: Met) -> Option<Vec<Option<Moment>>> {
        let mut moments: Vec<Option<Moment>> = self.own.iter().map(|(moment, _)| *moment).collect();
        for (bit, steps) in self.operators.chunk_by(|a, b| a.0 == b.0).enumerate() {
            if !has_bit(lenses.may, bit) {
                continue;
            }
            let after = |at: &Option<Moment>| {
                let each = |moments: Vec<Option<Moment>>, (_, operator): &(u32, Operator)| {
                    let made = moments.into_iter().flat_map(|at| operator.moments(at));
                    made.map(|(moment, _)| moment).collect()
                };
                steps.iter().fold(vec![*at], each)
            };
            let more: Vec<Option<Moment>> = moments.iter().flat_map(after).collect();
            match has_bit(lenses.surely, bit) {
                true => moments = more,
                false => moments.extend(more),
            }
            moments.sort_unstable();
            moments.dedup();
            if moments.len() > MOST_MOMENTS {
                return None;
            }
        }
        Some(moments)
    }

    /// What effects read of objects, from its first word on: `lib/lifetime.wgsl` says how it lies. Then, for each operator, where its words
    /// begin. `lifetimes`: of the scene's own city, then of contents, as their objects follow each other; `moving`: the moments for which
    /// something that moves is drawn.
    pub fn words(
        &self,
        lifetimes: &[Arc<Lifetimes>],
        met: &MetLenses,
        moving: &[Option<Moment>],
    ) -> (Vec<u32>, Vec<u32>) {
        let of = |moment: Option<Moment>| moment.map_or(Moment::TIMELESS, Moment::words);
        let [first, last] = self.range.map_or([None; 2], |range| range.map(Some));
        // What is gone by less shows yet; ends of months make a few days of difference.
        let reach = self.reach();
        let slack = if reach.past.is_none() { Span::NONE } else { Span::of_micros(-4 * DAY) };
        let first = first.map(|first| first.shifted(reach.past.back()).shifted(slack));
        let any = self.own.iter().map(|(moment, _)| *moment).min().flatten();
        let mut words = Vec::new();
        words.extend(of(any));
        words.extend([0, 0]);
        words.extend(of(first));
        words.extend(of(last));
        words.extend([self.combinations() as u32, 0]);
        words.extend([0, self.own.len() as u32, 1]);
        words.extend([self.ghosts.past, self.ghosts.future].iter().flat_map(|span| span.words()));
        words.push(words.len() as u32 + 5);
        words.push(u32::from(self.shows_any));
        // Under which sun a frame is.
        words.extend([0, 0, 1]);
        words.extend(moving.iter().flat_map(|moment| of(*moment)));
        let mut begins = Vec::new();
        for (_, operator) in &self.operators {
            begins.push(words.len() as u32);
            words.extend(&operator.words);
        }
        if self.is_partly(lifetimes) {
            self.put_instants(&mut words, &begins);
        }
        (words[2], words[3]) = (words.len() as u32, 4 + 2 * met.words as u32);
        let mut put = |lifetime: &Lifetime, met: Met| {
            words.extend(lifetime.words());
            words.extend(met.may);
            words.extend(met.surely);
        };
        // No object may be anywhere.
        put(&Lifetime::ALWAYS, met.anywhere());
        for (lifetime, object) in lifetimes.iter().flat_map(|lifetimes| &lifetimes.of).zip(0..) {
            put(lifetime, met.of(object));
        }
        (words, begins)
    }

    /// Adds the moments of sets, that of the scene first, and the weights of their combinations: of each set the first takes turns quickest
    /// that is first.
    fn put_instants(&self, words: &mut Vec<u32>, begins: &[u32]) {
        let own: Vec<Instant> =
            self.own.iter().map(|(at, weight)| Instant { at: InstantOf::Moment(*at), weight: *weight }).collect();
        let mut weights = vec![1.0];
        let mut put = |set: &[Instant], place: usize, words: &mut Vec<u32>| {
            (words[place], words[place + 2]) = (words.len() as u32, weights.len() as u32);
            words.extend(set.iter().flat_map(Instant::words));
            let each = set.iter().flat_map(|one| weights.iter().map(|weight| weight * one.weight));
            weights = each.collect();
        };
        put(&own, SCENE_INSTANTS, words);
        for ((_, operator), begin) in self.operators.iter().zip(begins).filter(|((_, o), _)| !o.instants().is_empty()) {
            put(operator.instants(), *begin as usize, words);
        }
        words[WEIGHTS] = words.len() as u32;
        words.extend(weights.iter().map(|weight| (*weight as f32).to_bits()));
    }
}

/// Words in which it is said where the weights of combinations and the moments of the scene begin: as `lib/instants.wgsl` has them.
const WEIGHTS: usize = 9;
const SCENE_INSTANTS: usize = 10;

/// What operators, one after the other, make of moments that show together: ascending, each once.
fn together(moments: &[(Option<Moment>, f64)], operators: &[Operator]) -> Vec<(Option<Moment>, f64)> {
    let mut moments = moments.to_vec();
    for operator in operators {
        let each = |(at, weight): &(Option<Moment>, f64)| {
            let weight = *weight;
            operator.moments(*at).into_iter().map(move |(moment, share)| (moment, weight * share))
        };
        moments = moments.iter().flat_map(each).collect();
        moments.sort_by_key(|(moment, _)| *moment);
        moments.dedup_by(|later, kept| {
            let is_same = later.0 == kept.0;
            kept.1 += if is_same { later.1 } else { 0.0 };
            is_same
        });
    }
    moments
}

/// Moments that an object is asked about one by one, at most.
const MOST_MOMENTS: usize = 64;

/// Which lenses with operators may hold some of which objects, and which hold all of them: a bit each, by the boxes of objects.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MetLenses {
    /// Words of an object, for either.
    words: usize,
    /// Those of all objects of the scene's own city, as they are counted: first those that may hold some of it.
    of: Vec<u32>,
    /// Those of all others: any lens may, none surely does.
    others: Vec<u32>,
}

/// The lenses of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Met<'a> {
    /// Those that may hold some of it.
    pub may: &'a [u32],
    /// Those among them that hold all of it.
    pub surely: &'a [u32],
}

/// Where a lens with operators is.
#[derive(Clone, Debug, Default)]
pub struct LensPlaces {
    /// The boxes around its volumes, with what places of fragments may be rounded by; `None`: it may hold anything.
    pub around: Option<Vec<Aabb>>,
    /// Those of its volumes that are convex and end at once, which are told apart by their shapes alone.
    pub convex: Vec<Volume>,
    /// From where they are seen: the farther off, the more places are rounded.
    pub eye: DVec3,
}

impl LensPlaces {
    fn may_hold(&self, bounds: &Aabb) -> bool {
        self.around.as_ref().is_none_or(|boxes| boxes.iter().any(|b| b.meets(bounds)))
    }

    fn surely_holds(&self, bounds: &Aabb) -> bool {
        let is_deep =
            |volume: &Volume, corner: DVec3| volume.signed_distance(corner) <= -rounded(corner.distance(self.eye));
        let holds = |volume: &Volume| bounds.corners().into_iter().all(|corner| is_deep(volume, corner));
        !bounds.is_empty() && self.convex.iter().any(holds)
    }
}

impl MetLenses {
    /// Of objects with these boxes, and of lenses. Without boxes of objects all may be anywhere.
    pub fn new(objects: Option<&[Aabb]>, lenses: &[LensPlaces]) -> Self {
        let words = lenses.len().div_ceil(32);
        let mut of = vec![0; 2 * words * objects.map_or(0, <[Aabb]>::len)];
        for (own, bounds) in of.chunks_mut((2 * words).max(1)).zip(objects.unwrap_or_default()) {
            for (lens, places) in lenses.iter().enumerate().filter(|(_, places)| places.may_hold(bounds)) {
                let bit = 1 << (lens % 32);
                own[lens / 32] |= bit;
                if places.surely_holds(bounds) {
                    own[words + lens / 32] |= bit;
                }
            }
        }
        Self { words, of, others: [vec![u32::MAX; words], vec![0; words]].concat() }
    }

    /// Those of an object.
    pub fn of(&self, object: usize) -> Met<'_> {
        let own = self.of.get(2 * object * self.words..2 * (object + 1) * self.words).unwrap_or(&self.others);
        let (may, surely) = own.split_at(self.words);
        Met { may, surely }
    }

    /// Those of what may be anywhere.
    fn anywhere(&self) -> Met<'_> {
        let (may, surely) = self.others.split_at(self.words);
        Met { may, surely }
    }
}

fn has_bit(words: &[u32], bit: usize) -> bool {
    words.get(bit / 32).is_some_and(|word| word >> (bit % 32) & 1 == 1)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geom::shape::Sphere,
        lens::{Handled, Parameter, epoch::set_to},
    };

    fn year(year: i64) -> Option<Moment> {
        Moment::of_year(year)
    }

    fn shift(by: &str) -> Handled {
        Handled { handler: "shift".into(), parameters: [("by".to_owned(), Parameter::Text(by.into()))].into() }
    }

    /// A scene in 1900: 1650 in lens 0, ten years later in lens 1.
    fn epochs() -> Epochs {
        let lens = |name: &str, step: Handled| Lens {
            time: vec![step],
            ..Lens::plain(name, crate::lens::kind::TimeLens::default(), [0.0; 3])
        };
        let set = set_to(year(1650).expect("a year"));
        let scene = Scene {
            moment: year(1900),
            lenses: vec![lens("then", set), lens("later", shift("10 years"))],
            ..Scene::default()
        };
        Epochs::new(&scene).expect("moments")
    }

    #[test]
    fn lenses_act_bottom_to_top() {
        let epochs = epochs();
        let at = |inside: &[u32]| epochs.moments_at(|lens| inside.contains(&lens));
        let one = |at: i64| vec![(year(at), 1.0)];
        assert_eq!([at(&[]), at(&[0]), at(&[1]), at(&[0, 1])], [1900, 1650, 1910, 1660].map(one));
        assert_eq!(epochs.range, year(1650).zip(year(1910)).map(|(first, last)| [first, last]));
    }

    #[test]
    fn an_object_is_asked_of_the_lenses_that_may_hold_it() {
        let cube = |x: f64| Aabb { min: DVec3::new(x, 0.0, 0.0), max: DVec3::new(x + 1.0, 1.0, 1.0) };
        let boxes: Vec<Aabb> = [0.0, 10.0, 20.0].map(cube).into();
        let at = |around: Vec<Aabb>| LensPlaces { around: Some(around), ..LensPlaces::default() };
        let met = MetLenses::new(Some(&boxes), &[at(vec![cube(0.5), cube(9.5)]), at(vec![cube(10.5)])]);
        assert_eq!(
            [0, 1, 2, 3].map(|object| met.of(object).may[0]),
            [0b01, 0b11, 0b00, u32::MAX],
            "of others any may hold some"
        );
        assert_eq!(MetLenses::new(Some(&boxes), &[LensPlaces::default()]).of(2).may, [1], "a lens without an end");
        let of = |begin: i64, end: Option<i64>| Lifetime::of(year(begin), end.and_then(year));
        let presence =
            |lifetime: Lifetime| epochs().presence(&Lifetimes { of: vec![lifetime; 3], ..Lifetimes::default() }, &met);
        use Presence::{Always, Never, Sometimes};
        assert_eq!(presence(of(1600, None)), [Always, Always, Always]);
        assert_eq!(presence(of(1700, None)), [Sometimes, Sometimes, Always]);
        assert_eq!(presence(of(1655, Some(1900))), [Never, Sometimes, Never], "1660 shows where both lenses are");
        assert_eq!(presence(of(1905, Some(1911))), [Never, Sometimes, Never]);
        assert_eq!(presence(of(1650, Some(1651))), [Sometimes, Sometimes, Never]);
        assert_eq!(presence(Lifetime::NEVER), [Never; 3]);
        // The first lens holds all of the last object: what shows there is 1650 alone.
        let sphere = Volume::Sphere(Sphere { center: DVec3::new(20.0, 0.0, 0.0), radius: 3.0 });
        let met =
            MetLenses::new(Some(&boxes), &[LensPlaces { convex: vec![sphere], ..LensPlaces::default() }, at(vec![])]);
        assert_eq!([0, 1, 2, 3].map(|object| met.of(object).surely[0]), [0, 0, 1, 0]);
        let presence =
            |lifetime: Lifetime| epochs().presence(&Lifetimes { of: vec![lifetime; 3], ..Lifetimes::default() }, &met);
        assert_eq!(presence(of(1600, Some(1800))), [Sometimes, Sometimes, Always]);
        assert_eq!(presence(of(1700, None)), [Sometimes, Sometimes, Never]);
        let timeless = Epochs { own: vec![(None, 1.0)], ..epochs() };
        let found = timeless.presence(&Lifetimes { of: vec![Lifetime::NEVER; 3], ..Lifetimes::default() }, &met);
        assert_eq!(found, [Sometimes, Sometimes, Never], "without a moment all is there, but where a lens sets one");
    }
}
