//! Deformations made ready for use, one and several.

use glam::{DMat3, DVec3};

use crate::geom::{
    aabb::Aabb,
    deform::{
        Deformation, Fault, Frame, Interval, Space,
        control::Sampled,
        matrix,
        number::{Matrix, Vector, plus_identity, product, sum, zeros},
    },
};

/// Cells along each side of a box whose deformed bounds are asked.
const CELLS: usize = 4;

/// The convex part of the world outside which a deformation leaves every bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// The frame of the lens, in the world.
    pub frame: Frame,
    /// A closed box of that frame; sides may be infinite, and it may be empty.
    pub bounds: Aabb,
}

impl Support {
    /// Whether a place of the world may be moved.
    pub fn contains(&self, place: DVec3) -> bool {
        self.holds(self.frame.from_world(place))
    }

    pub(super) fn holds(&self, p: DVec3) -> bool {
        p.cmpge(self.bounds.min).all() && p.cmple(self.bounds.max).all()
    }

    /// The same, wider by some metres on every side; what is empty stays so.
    #[must_use]
    pub fn grown(&self, metres: f64) -> Self {
        match self.bounds.is_empty() {
            true => *self,
            false => Self { bounds: Aabb { min: self.bounds.min - metres, max: self.bounds.max + metres }, ..*self },
        }
    }

    /// Whether it has something of a box of the world.
    pub fn reaches(&self, bounds: &Aabb) -> bool {
        !self.part_of(bounds).is_empty()
    }

    /// A box of the world around it.
    pub fn in_world(&self) -> Aabb {
        if self.bounds.is_empty() {
            return Aabb::EMPTY;
        }
        let turned = turned(&self.frame.axes, &intervals(&self.bounds));
        let pivot = self.frame.pivot.to_array();
        aabb(&std::array::from_fn(|i| turned[i] + Interval::from(pivot[i])))
    }

    /// What it has of a box of the world, as a box of the frame; maybe empty.
    pub fn part_of(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() {
            return Aabb::EMPTY;
        }
        let pivot = self.frame.pivot.to_array();
        let world = intervals(bounds);
        let local = turned(&self.frame.axes.transpose(), &std::array::from_fn(|i| world[i] - Interval::from(pivot[i])));
        let local = aabb(&local);
        Aabb { min: local.min.max(self.bounds.min), max: local.max.min(self.bounds.max) }
    }
}

/// One deformation of the world, checked and ready for use.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformer {
    pub(super) deformation: Deformation,
    support: Support,
    /// How far apart samples may be before each operator, in the frame.
    spacing: Vec<DVec3>,
}

/// What a place of the frame becomes: g(x) − x, κ, and θ(x) − x.
struct Moved {
    kappa: f64,
    way: DVec3,
}

impl Deformer {
    /// A deformation in the world ([`Deformation::in_world`]); one that follows the camera, or cannot be used, is refused.
    pub fn new(deformation: Deformation) -> Result<Self, Fault> {
        deformation.check()?;
        if deformation.space != Space::World {
            return Err(Fault("a deformation that follows the camera has no place in the world by itself"));
        }
        let chain = deformation.chain.iter().map(|operator| operator.support()).fold(Aabb::EMPTY, Aabb::union);
        let control = deformation.control.support();
        let bounds = Aabb { min: chain.min.max(control.min), max: chain.max.min(control.max) };
        let mut spacing: Vec<DVec3> = deformation.chain.iter().map(|operator| operator.spacing()).collect();
        if let Some(first) = spacing.first_mut() {
            *first = first.min(deformation.control.spacing());
        }
        Ok(Self { support: Support { frame: deformation.frame, bounds }, spacing, deformation })
    }

    /// What it was made of.
    pub fn deformation(&self) -> &Deformation {
        &self.deformation
    }

    /// Where it may move something.
    pub fn support(&self) -> &Support {
        &self.support
    }

    /// How far apart samples may be before each operator to see all that it does (and, before the first, all of the control), metres of
    /// the frame; ∞ where it is linear.
    pub fn spacing(&self) -> &[DVec3] {
        &self.spacing
    }

    /// θ of a place of the world. Outside the support, and wherever nothing moves, the same bits.
    pub fn value(&self, place: DVec3) -> DVec3 {
        self.traced(place, &mut |_, _| {})
    }

    /// The same; `visit` is told each step's place in the frame and how far apart places may be there (operators in order, the control
    /// with the first); a NaN where that does not matter.
    pub(super) fn traced(&self, place: DVec3, visit: &mut impl FnMut(DVec3, DVec3)) -> DVec3 {
        let p = self.support.frame.from_world(place);
        if !self.support.holds(p) {
            // Only the first step is continuous across the border of the support, where κ is 0.
            for (step, spacing) in self.spacing.iter().enumerate() {
                visit(if step == 0 { p } else { DVec3::NAN }, *spacing);
            }
            return place;
        }
        let Moved { kappa, way } = self.moved(p, visit);
        if kappa == 0.0 || way == DVec3::ZERO {
            return place;
        }
        place + self.support.frame.axes * (kappa * way)
    }

    fn moved(&self, p: DVec3, visit: &mut impl FnMut(DVec3, DVec3)) -> Moved {
        let kappa = self.deformation.control.at(&p.to_array()).value;
        let mut way = DVec3::ZERO;
        for (operator, spacing) in self.deformation.chain.iter().zip(&self.spacing) {
            visit(p + way, *spacing);
            way += DVec3::from(operator.jet(&(p + way).to_array()).0);
        }
        Moved { kappa, way }
    }

    /// J = ∂θ/∂x in the world. At kinks the derivative of the inner side.
    pub fn jacobian(&self, place: DVec3) -> DMat3 {
        let p = self.support.frame.from_world(place);
        if !self.support.holds(p) {
            return DMat3::IDENTITY;
        }
        let axes = self.support.frame.axes;
        axes * matrix(&self.jacobian_over(&p.to_array())) * axes.transpose()
    }

    /// J in the frame, over a part of the support.
    pub(super) fn jacobian_over<S: Sampled>(&self, p: &Vector<S>) -> Matrix<S> {
        let kappa = self.deformation.control.at(p);
        let (way, slope) = self.chain_over(p);
        let mixed =
            std::array::from_fn(|i| std::array::from_fn(|j| kappa.value * slope[i][j] + way[i] * kappa.slope[j]));
        plus_identity(mixed)
    }

    /// g(x) − x and J_g − I.
    fn chain_over<S: Sampled>(&self, p: &Vector<S>) -> (Vector<S>, Matrix<S>) {
        let mut way = [S::from(0.0); 3];
        let mut slope = zeros();
        for operator in &self.deformation.chain {
            let (step, step_slope) = operator.jet(&std::array::from_fn(|i| p[i] + way[i]));
            // (I + d)(I + D) − I = D + d(I + D).
            slope = sum(&slope, &product(&step_slope, &plus_identity(slope)));
            way = std::array::from_fn(|i| way[i] + step[i]);
        }
        (way, slope)
    }

    /// A box around all that a box of the world becomes.
    pub fn deformed_bounds(&self, bounds: &Aabb) -> Aabb {
        let part = self.support.part_of(bounds);
        if part.is_empty() {
            return *bounds;
        }
        // Zero is in it: what lies outside the support stays.
        let mut way = [Interval::from(0.0); 3];
        for cell in cells(&part) {
            let kappa = self.deformation.control.at(&cell).value;
            let step = self.chain_over(&cell).0.map(|w| w * kappa);
            let step = turned(&self.support.frame.axes, &step);
            way = std::array::from_fn(|i| way[i].union(step[i]));
        }
        let world = intervals(bounds);
        aabb(&std::array::from_fn(|i| world[i] + way[i]))
    }
}

/// Several deformations, bottom first: what one has moved, the next one moves on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deformers(pub Vec<Deformer>);

impl Deformers {
    /// θ of a place of the world.
    pub fn value(&self, place: DVec3) -> DVec3 {
        self.0.iter().fold(place, |place, deformer| deformer.value(place))
    }

    /// The same, with all steps told ([`Deformer::traced`]): as many for each place.
    pub(super) fn traced(&self, place: DVec3, visit: &mut impl FnMut(DVec3, DVec3)) -> DVec3 {
        self.0.iter().fold(place, |place, deformer| deformer.traced(place, visit))
    }

    /// ∂θ/∂x in the world.
    pub fn jacobian(&self, place: DVec3) -> DMat3 {
        let start = (place, DMat3::IDENTITY);
        let step = |(place, jacobian): (DVec3, DMat3), deformer: &Deformer| {
            (deformer.value(place), deformer.jacobian(place) * jacobian)
        };
        self.0.iter().fold(start, step).1
    }

    /// A box around all that a box of the world becomes.
    pub fn deformed_bounds(&self, bounds: &Aabb) -> Aabb {
        self.0.iter().fold(*bounds, |bounds, deformer| deformer.deformed_bounds(&bounds))
    }

    /// The place that is taken to this one; `None` where none was found.
    pub fn inverse(&self, place: DVec3) -> Option<DVec3> {
        self.0.iter().rev().try_fold(place, |place, deformer| deformer.inverse(place))
    }

    /// Boxes outside all of which every bit stays: what no deformation reaches at rest, none reaches later.
    pub fn supports(&self) -> impl Iterator<Item = &Support> {
        self.0.iter().map(Deformer::support)
    }
}

/// The sides of a box.
pub(super) fn intervals(bounds: &Aabb) -> Vector<Interval> {
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    std::array::from_fn(|i| Interval::new(low[i], high[i]))
}

fn aabb(sides: &Vector<Interval>) -> Aabb {
    Aabb { min: DVec3::from(sides.map(|s| s.low)), max: DVec3::from(sides.map(|s| s.high)) }
}

/// axes·p.
fn turned(axes: &DMat3, p: &Vector<Interval>) -> Vector<Interval> {
    let rows = axes.transpose().to_cols_array_2d();
    std::array::from_fn(|i| (0..3).fold(Interval::from(0.0), |sum, j| sum + p[j] * Interval::from(rows[i][j])))
}

/// A box in equal parts; an infinite side in one.
fn cells(bounds: &Aabb) -> Vec<Vector<Interval>> {
    let cut = |side: Interval| -> Vec<Interval> {
        if !side.width().is_finite() {
            return vec![side];
        }
        let at = |i: usize| if i == CELLS { side.high } else { side.low + side.width() * i as f64 / CELLS as f64 };
        (0..CELLS).map(|i| Interval::new(at(i), at(i + 1))).collect()
    };
    let [x, y, z] = intervals(bounds).map(cut);
    let mut cells = Vec::with_capacity(x.len() * y.len() * z.len());
    for &x in &x {
        for &y in &y {
            cells.extend(z.iter().map(|&z| [x, y, z]));
        }
    }
    cells
}
