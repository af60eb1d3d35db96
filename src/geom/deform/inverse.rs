//! Back from deformed places to those at rest: closed forms where there are, else Newton's method with a guard.

use glam::{DMat3, DVec3};

use crate::geom::deform::{Control, Deformer, Operator, matrix, number::Number};

/// Steps of Newton's method at most; a handful is the rule.
const STEPS: usize = 60;
/// Smallest part of a Newton step that is tried.
const SMALLEST_STEP: f64 = 1e-6;
/// Parts in which the strength is raised from 0, where Newton's method does not arrive at once: at most 2 to this power.
const DOUBLINGS: u32 = 7;
/// What may remain, relative to the size of the numbers.
const CLOSE: f64 = 1e-12;

impl Deformer {
    /// The place that θ takes to `place`; `None` where none was found. There is one at most where nothing folds (and nothing comes
    /// round: a bend of more than one turn).
    pub fn inverse(&self, place: DVec3) -> Option<DVec3> {
        // What θ leaves alone is its own: nothing else comes there.
        if !self.support().contains(place) && self.deformation.control != Control::Everywhere {
            return Some(place);
        }
        let frame = self.support().frame;
        if self.deformation.control == Control::Everywhere {
            let back = |p: DVec3, operator: &Operator| operator.inverse(p);
            let p = self.deformation.chain.iter().rev().try_fold(frame.from_world(place), back)?;
            return Some(if self.value(place) == place { place } else { frame.to_world(p) });
        }
        let way = |p: DVec3| frame.from_world(self.value(frame.to_world(p))) - p;
        solved(frame.from_world(place), way, |p| matrix(&self.jacobian_over(&p.to_array()))).map(|p| frame.to_world(p))
    }
}

impl Operator {
    /// The place that the operator takes to p; `None` where none was found.
    pub fn inverse(&self, p: DVec3) -> Option<DVec3> {
        // Operators of which the first argument stays go back by the same formula.
        match self {
            Self::Translate(way) => Some(p - *way),
            Self::Scale { factors, about } => Some(*about + (p - *about) / *factors),
            Self::Shear { slope, base } => Some(p - (*slope * (p.z - base)).extend(0.0)),
            Self::Taper { z, factors } => {
                let t = Number::clamp((p.z - z[0]) / (z[1] - z[0]), 0.0, 1.0);
                let r = factors[0] + (factors[1] - factors[0]) * t;
                Some(DVec3::new(p.x / r, p.y / r, p.z))
            }
            Self::Twist { z, angles } => Self::Twist { z: *z, angles: angles.map(|a| -a) }.value(p).into(),
            Self::Bend { curvature, y, about, base } => {
                let up = DVec3::new(0.0, *about, *base);
                unbent(p - up, *curvature, y.map(|y| y - about)).map(|p| p + up)
            }
            Self::Open(_) | Self::Map(_) => solved(p, |p| self.value(p) - p, |p| self.jacobian(p)),
        }
        .filter(|p| p.is_finite())
    }
}

/// Back from a bend about y = 0, z = 0 between two ends.
///
/// In the bent part k·Y = sin φ·(1 − kz) and 1 − k·Z = cos φ·(1 − kz), so the direction of both gives φ, and their length 1 − kz. The
/// straight parts are turned back about their ends.
fn unbent(p: DVec3, k: f64, [low, high]: [f64; 2]) -> Option<DVec3> {
    let angle = (k * p.y).atan2(1.0 - k * p.z);
    // A turn more or less, where the bend is that long.
    let turns = [0.0, 1.0, -1.0].map(|turn| angle + turn * std::f64::consts::TAU);
    let inside = turns.into_iter().find_map(|angle| {
        let u = if angle.abs() > 1.0 { angle / k } else { p.y / ((k * p.y).hypot(1.0 - k * p.z) * angle.sinc()) };
        (low..=high).contains(&u).then(|| back(p, k, u)).map(|[_, z]| DVec3::new(p.x, u, z))
    });
    inside.or_else(|| {
        [low, high].into_iter().find_map(|end| {
            let [beyond, z] = back(p, k, end);
            let is_beyond = if end == high { beyond >= 0.0 } else { beyond <= 0.0 };
            is_beyond.then_some(DVec3::new(p.x, end + beyond, z))
        })
    })
}

/// A bent place in the frame that the bend has at u: along it and over it.
fn back(p: DVec3, k: f64, u: f64) -> [f64; 2] {
    let angle = k * u;
    let (sin, cos) = angle.sin_cos();
    let y = p.y - u * angle.sinc();
    let z = p.z - 0.5 * u * angle * (0.5 * angle).sinc().powi(2);
    [y * cos + z * sin, z * cos - y * sin]
}

/// x with x + way(x) = target, for a map of which `jacobian` is that of x + way(x).
///
/// Newton's method from the target itself; where that fails the way is raised from nothing in steps, each from where the last one ended.
fn solved(target: DVec3, way: impl Fn(DVec3) -> DVec3, jacobian: impl Fn(DVec3) -> DMat3) -> Option<DVec3> {
    (0..=DOUBLINGS).find_map(|power| {
        let parts = 1_u32 << power;
        (1..=parts).try_fold(target, |start, part| {
            let strength = f64::from(part) / f64::from(parts);
            let rest = |x: DVec3| x + strength * way(x) - target;
            newton(start, rest, |x| DMat3::IDENTITY * (1.0 - strength) + jacobian(x) * strength, target.length())
        })
    })
}

/// A zero of `rest`, from `start`: each step is halved until less remains.
fn newton(start: DVec3, rest: impl Fn(DVec3) -> DVec3, jacobian: impl Fn(DVec3) -> DMat3, size: f64) -> Option<DVec3> {
    let mut x = start;
    let mut left = rest(x);
    for _ in 0..STEPS {
        if left.length() <= CLOSE * (1.0 + size) {
            return Some(x);
        }
        let step = jacobian(x).inverse() * left;
        if !step.is_finite() {
            return None;
        }
        let mut part = 1.0;
        loop {
            let next = x - part * step;
            let next_left = rest(next);
            if next_left.length() < left.length() {
                (x, left) = (next, next_left);
                break;
            }
            part *= 0.5;
            if part < SMALLEST_STEP {
                return None;
            }
        }
    }
    None
}
