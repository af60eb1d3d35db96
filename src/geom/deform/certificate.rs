//! Proofs that a deformation folds nothing (hard case 17): det J > 0 everywhere, by interval arithmetic over smaller and smaller
//! boxes.

use std::{cmp::Ordering, collections::BinaryHeap};

use glam::{DVec3, UVec3};
use rayon::prelude::*;

use crate::geom::{
    aabb::Aabb,
    deform::{
        Control, Deformation, Deformer, Fault, Interval, Operator,
        deformer::intervals,
        number::{self, Vector, determinant},
    },
};

/// Boxes that a proof may look at; a few microseconds each.
const BOXES: usize = 1 << 12;
/// Halvings of the range in which the largest safe strength is searched: to a part in a thousand.
const HALVINGS: usize = 10;

/// Places along each side at which a user's map is looked at: half of its detail apart, but so many at least and at most.
const LEAST_PLACES: f64 = 8.0;
const MOST_PLACES: f64 = 48.0;
/// How often it is looked closer, three times as close each time, and around how many places.
const CLOSER: usize = 4;
const WORST: usize = 256;

/// det J of what is taken for not folded without a proof.
pub const CLEAR: f64 = 0.25;

/// What is known of det J over a box of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Proof {
    /// It is > 0 everywhere, for every real number in the box.
    Proven,
    /// It is not: neighbours change sides.
    Folds {
        /// Where, in the world.
        at: DVec3,
        /// det J there, ≤ 0.
        determinant: f64,
    },
    /// Neither was found out in as many boxes as may be looked at.
    Unknown {
        /// The smallest det J in the middles of those boxes, the most doubtful ones of all; 0 in a box without end.
        least: f64,
    },
}

/// How much of a deformation is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Strength {
    /// The part of its strength that is proven to fold nothing, 0..=1.
    pub used: f64,
    /// The part at which nothing was seen to fold, at least `used`: no proof, but det J was at least [`CLEAR`] in thousands of places. Long
    /// openings are seldom proven as far as they go.
    pub seen: f64,
    /// Why it is not used as it was asked for; `None`: it is.
    pub reason: Option<Proof>,
    /// The deformation at the strength `used`.
    pub deformer: Deformer,
}

/// A box to look at, the most doubtful one first.
struct Doubt {
    sides: Vector<Interval>,
    least: f64,
}

impl PartialEq for Doubt {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Doubt {}

impl PartialOrd for Doubt {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Doubt {
    fn cmp(&self, other: &Self) -> Ordering {
        other.least.total_cmp(&self.least)
    }
}

impl Deformer {
    /// Whether det J > 0 everywhere in a box of the world.
    pub fn prove(&self, bounds: &Aabb) -> Proof {
        let part = self.support().part_of(bounds);
        if part.is_empty() || self.deformation.chain.is_empty() {
            return Proof::Proven;
        }
        if self.deformation.chain.iter().any(|operator| matches!(operator, Operator::Map(_))) {
            return self.looked_at(&part);
        }
        let mut doubts = BinaryHeap::new();
        let mut least_seen = f64::INFINITY;
        let mut looked_at = 0;
        let mut note = |doubts: &mut BinaryHeap<Doubt>, sides: Vector<Interval>| {
            looked_at += 1;
            let least = self.determinant_over(&sides).low;
            // A NaN cannot come out of intervals; if one did, it would not prove anything either.
            if !matches!(least.partial_cmp(&0.0), Some(Ordering::Greater)) {
                doubts.push(Doubt { sides, least });
            }
            looked_at
        };
        note(&mut doubts, intervals(&part));
        while let Some(Doubt { sides, .. }) = doubts.pop() {
            if sides.iter().any(|side| !side.width().is_finite()) {
                return Proof::Unknown { least: 0.0 };
            }
            let middle = DVec3::from(sides.map(Interval::middle));
            let at = self.support().frame.to_world(middle);
            let determinant = self.jacobian(at).determinant();
            if determinant <= 0.0 {
                return Proof::Folds { at, determinant };
            }
            least_seen = least_seen.min(determinant);
            let axis = self.axis_to_halve(&sides);
            for half in halves(sides[axis]) {
                let mut sides = sides;
                sides[axis] = half;
                if note(&mut doubts, sides) >= BOXES {
                    return Proof::Unknown { least: least_seen };
                }
            }
        }
        Proof::Proven
    }

    /// What many places say where nothing is known between them: of a user's map. A lattice over a part of the frame, and finer ones around
    /// the places of it where least is left.
    fn looked_at(&self, part: &Aabb) -> Proof {
        if !part.size().is_finite() {
            return Proof::Unknown { least: 0.0 };
        }
        let det = |p: DVec3| number::determinant(&self.jacobian_over(&p.to_array()));
        let apart = self.spacing().iter().fold(DVec3::INFINITY, |least, spacing| least.min(*spacing));
        let counts = (part.size() / (0.5 * apart))
            .ceil()
            .clamp(DVec3::splat(LEAST_PLACES), DVec3::splat(MOST_PLACES))
            .as_uvec3();
        let mut step = part.size() / counts.as_dvec3();
        let cell = |i: u32| UVec3::new(i % counts.x, i / counts.x % counts.y, i / (counts.x * counts.y));
        let places = |i: u32| part.min + step * (cell(i).as_dvec3() + 0.5);
        let all: Vec<f64> = (0..counts.element_product()).into_par_iter().map(|i| det(places(i))).collect();
        // Those of which no neighbour is worse: of many alike in a row, each is looked at closer.
        let is_worst = |&i: &u32| {
            let steps = [1, counts.x, counts.x * counts.y];
            (0..3).all(|axis| {
                let (at, step) = (cell(i)[axis], steps[axis]);
                (at == 0 || all[i as usize] <= all[(i - step) as usize])
                    && (at + 1 == counts[axis] || all[i as usize] <= all[(i + step) as usize])
            })
        };
        let worst = (0..all.len() as u32).filter(is_worst);
        let mut seen: Vec<(f64, DVec3)> = worst.map(|i| (all[i as usize], places(i))).collect();
        for _ in 0..CLOSER {
            seen.sort_by(|a, b| a.0.total_cmp(&b.0));
            seen.truncate(WORST);
            step /= 3.0;
            let around = |at: DVec3| {
                (0..27_u32).map(move |i| {
                    let aside = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0;
                    (at + step * aside).clamp(part.min, part.max)
                })
            };
            let best = |at: &DVec3| around(*at).map(|p| (det(p), p)).min_by(|a, b| a.0.total_cmp(&b.0));
            seen = seen.par_iter().filter_map(|(_, at)| best(at)).collect();
        }
        let least = seen.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        match least {
            Some((determinant, at)) if *determinant <= 0.0 => {
                Proof::Folds { at: self.support().frame.to_world(*at), determinant: *determinant }
            }
            Some((least, _)) => Proof::Unknown { least: *least },
            None => Proof::Proven,
        }
    }

    /// The side of which most of the doubt comes: the one that alone makes the bound the worst.
    fn axis_to_halve(&self, sides: &Vector<Interval>) -> usize {
        let alone = |axis: usize| {
            let sides = std::array::from_fn(|i| if i == axis { sides[i] } else { sides[i].middle().into() });
            self.determinant_over(&sides).low
        };
        let least = [0, 1, 2].map(alone);
        let worse = |a: &usize, b: &usize| {
            least[*b].total_cmp(&least[*a]).then(sides[*a].width().total_cmp(&sides[*b].width()))
        };
        (0..3).max_by(worse).unwrap_or(0)
    }

    /// Bounds of det J over a box of the frame.
    fn determinant_over(&self, sides: &Vector<Interval>) -> Interval {
        if self.deformation.control != Control::Everywhere {
            return determinant(&self.jacobian_over(sides));
        }
        // Without a control it is the product of the operators', which are known in closed form.
        let mut place = *sides;
        let mut product = Interval::from(1.0);
        for operator in &self.deformation.chain {
            product = product * operator.det(&place);
            let way = operator.jet(&place).0;
            place = std::array::from_fn(|i| place[i] + way[i]);
        }
        product
    }
}

impl Deformation {
    /// The largest part of its strength ([`Deformation::at_strength`]) that halving finds to fold nothing in a box of the world, and
    /// proves: to a part in a thousand, if what is weaker than a safe one is safe.
    pub fn safe_strength(&self, bounds: &Aabb) -> Result<Strength, Fault> {
        let prove = |strength: f64| Deformer::new(self.at_strength(strength)).map(|deformer| deformer.prove(bounds));
        let reason = match prove(1.0)? {
            Proof::Proven => None,
            reason => Some(reason),
        };
        let is_clear = |proof: &Proof| match proof {
            Proof::Proven => true,
            Proof::Unknown { least } => *least >= CLEAR,
            Proof::Folds { .. } => false,
        };
        // What is only looked at is never proven.
        let is_looked_at = self.chain.iter().any(|operator| matches!(operator, Operator::Map(_)));
        let used = if reason.is_none() {
            1.0
        } else if is_looked_at {
            0.0
        } else {
            largest(0.0, |strength| Ok(prove(strength)? == Proof::Proven))?
        };
        let seen = match &reason {
            Some(proof) if !is_clear(proof) => largest(used, |strength| Ok(is_clear(&prove(strength)?)))?,
            _ => 1.0,
        };
        Ok(Strength { used, seen, reason, deformer: Deformer::new(self.at_strength(used))? })
    }
}

/// The largest strength that halving finds between one that is good and 1, which is not.
fn largest(mut good: f64, is_good: impl Fn(f64) -> Result<bool, Fault>) -> Result<f64, Fault> {
    let mut bad = 1.0;
    for _ in 0..HALVINGS {
        let strength = 0.5 * (good + bad);
        if is_good(strength)? {
            good = strength;
        } else {
            bad = strength;
        }
    }
    Ok(good)
}

fn halves(side: Interval) -> [Interval; 2] {
    let middle = side.middle();
    [Interval { low: side.low, high: middle }, Interval { low: middle, high: side.high }]
}
