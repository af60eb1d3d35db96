//! Deformations as numbers that `lib/deform.wgsl` reads.

use glam::{DVec2, DVec3, IVec3, Vec3};

use crate::{
    geom::{
        Aabb,
        deform::{Control, Deformer, Deformers, Opening, Operator, Profile},
    },
    shader::{
        DeformPlan, PlanControl, PlanDeformer, PlanStep, STEP_HEAD,
        effect::{handlers, number_of},
    },
};

/// Cells of a metre, where the city is not too large for that: 2¹⁵, 31 µm each.
const FINEST_SHIFT: u32 = 15;
/// Cells from the anchor, 2 to this: twice as many still fit.
const EXTENT_SHIFT: u32 = 30;
/// Cells that pivots are multiples of: up to 2³⁰, f32 holds these exactly.
const PIVOT_STEP: f64 = 64.0;
/// Metres that anchors are multiples of, so that origins of what is moved do not depend on them.
const ANCHOR_STEP_M: i32 = 32;

/// The lattice that places are cells of while they are refined: cells of 2^−shift metres, counted from an anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lattice {
    pub anchor: IVec3,
    pub shift: u32,
}

impl Lattice {
    /// The finest one that holds a box.
    pub fn around(bounds: &Aabb) -> Self {
        let step = f64::from(ANCHOR_STEP_M);
        let anchor = (bounds.center() / step).round() * step;
        let extent = (bounds.min - anchor).abs().max((bounds.max - anchor).abs()).max_element();
        let room = f64::from(1_u32 << EXTENT_SHIFT) / extent.max(1.0);
        Self { anchor: anchor.as_ivec3(), shift: (room.log2().floor().max(0.0) as u32).min(FINEST_SHIFT) }
    }

    /// Metres.
    pub fn cell_m(&self) -> f64 {
        f64::from(1_u32 << self.shift).recip()
    }

    /// Where a cell is.
    pub fn place(&self, cell: IVec3) -> DVec3 {
        self.anchor.as_dvec3() + cell.as_dvec3() * self.cell_m()
    }

    /// The cell of a place of the world, and how far the place is from it, metres: what is beyond the lattice is counted from its end.
    pub fn cell_of(&self, place: DVec3) -> (IVec3, Vec3) {
        let end = f64::from(1_u32 << EXTENT_SHIFT);
        let from = place - self.anchor.as_dvec3();
        let cell = (from / self.cell_m()).round().clamp(DVec3::splat(-end), DVec3::splat(end));
        (cell.as_ivec3(), (from - cell * self.cell_m()).as_vec3())
    }
}

/// What deformers do, as a shader is written for it.
pub(super) fn plan_of(deformers: &Deformers) -> DeformPlan {
    let deformer = |deformer: &Deformer| {
        let deformation = deformer.deformation();
        let (control, has_band) = match &deformation.control {
            Control::Everywhere => (PlanControl::Everywhere, false),
            Control::Plane(plane) => {
                let control = match plane.profile {
                    Profile::Linear { .. } => PlanControl::Linear,
                    Profile::Smooth { .. } => PlanControl::Smooth,
                    Profile::Bump => PlanControl::Bump,
                    Profile::Ring { .. } => PlanControl::Ring,
                    Profile::Texels(_) => PlanControl::Texels,
                };
                (control, plane.band.is_some())
            }
        };
        // A handler that went away since the scene was read does nothing.
        let step = |operator: &Operator| number_of(operator.handler()).map(|n| PlanStep::new(n, handlers()));
        PlanDeformer { control, has_band, steps: deformation.chain.iter().filter_map(step).collect() }
    };
    DeformPlan(deformers.0.iter().map(deformer).collect())
}

/// All numbers of deformations that `lib/deform.wgsl` reads.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DeformNumbers {
    /// In fours.
    pub numbers: Vec<f32>,
    /// Texels and routes.
    pub tables: Vec<f32>,
}

impl DeformNumbers {
    /// Of deformers whose plan this is.
    pub fn new(deformers: &Deformers, plan: &DeformPlan, lattice: &Lattice) -> Self {
        let mut all = Self { numbers: vec![0.0; 4 * plan.numbers()], tables: Vec::new() };
        all.put(0, &[lattice.cell_m()]);
        for (i, (deformer, steps)) in deformers.0.iter().zip(plan.steps()).enumerate() {
            all.deformer(DeformPlan::deformer(i), deformer, lattice);
            let chain = deformer.deformation().chain.iter().zip(deformer.spacing());
            for ((operator, spacing), at) in chain.zip(steps) {
                all.step(at, operator, *spacing);
            }
        }
        all
    }

    /// Puts numbers at a place given in fours.
    fn put(&mut self, at: usize, numbers: &[f64]) {
        for (to, number) in self.numbers[4 * at..].iter_mut().zip(numbers) {
            // What is endless ends where no adapter's numbers do.
            *to = (*number as f32).clamp(-3e38, 3e38);
        }
    }

    fn deformer(&mut self, at: usize, deformer: &Deformer, lattice: &Lattice) {
        let support = deformer.support();
        let pivot = (lattice.cell_of(support.frame.pivot).0.as_dvec3() / PIVOT_STEP).round() * PIVOT_STEP;
        self.put(at, &pivot.to_array());
        let rest = support.frame.pivot - lattice.anchor.as_dvec3() - pivot * lattice.cell_m();
        self.put(at + 1, &rest.to_array());
        let axes = support.frame.axes;
        for (i, axis) in [axes.x_axis, axes.y_axis, axes.z_axis].iter().enumerate() {
            self.put(at + 2 + i, &axis.to_array());
        }
        self.put(at + 5, &support.bounds.min.to_array());
        self.put(at + 6, &support.bounds.max.to_array());
        let Control::Plane(plane) = &deformer.deformation().control else { return };
        self.put(at + 7, &plane.corner.to_array());
        let own = match &plane.profile {
            Profile::Linear { border } | Profile::Smooth { border } => [*border, 0.0],
            Profile::Bump => [0.0; 2],
            Profile::Ring { inner, outer } => [*inner, *outer],
            Profile::Texels(texels) => {
                self.put(at + 9, &[self.tables.len() as f64]);
                self.tables.extend(texels.values());
                texels.size().map(|side| side as f64)
            }
        };
        self.put(at + 8, &[plane.size.x.recip(), plane.size.y.recip(), own[0], own[1]]);
        if let Some(band) = &plane.band {
            self.put(at + 10, &[band.low, band.high, band.fade.recip()]);
        }
    }

    fn step(&mut self, at: usize, operator: &Operator, spacing: DVec3) {
        self.put(at, &(2.0 / spacing).to_array());
        // In the order of the parameters in the header of its handler.
        let own: Vec<f64> = match operator {
            Operator::Translate(way) => way.to_array().into(),
            Operator::Scale { factors, about } => [(*factors - DVec3::ONE).to_array(), about.to_array()].concat(),
            Operator::Shear { slope, base } => vec![slope.x, slope.y, *base],
            Operator::Taper { z, factors } => [*z, *factors].concat(),
            Operator::Twist { z, angles } => [*z, *angles].concat(),
            Operator::Bend { curvature, y, about, base } => vec![*curvature, y[0], y[1], *about, *base],
            Operator::Open(opening) => {
                let Opening { half_width, reach, aside, height, base, .. } = *opening;
                vec![half_width, reach, aside, height, base, self.route(&opening.line) as f64]
            }
            Operator::Map(mapped) => {
                let size = mapped.map.size();
                let head = [size.x, size.y, size.z, mapped.reach, mapped.strength, mapped.half_difference(), 0.0, 0.0];
                head.into_iter().chain(mapped.map.parameters().iter().map(|n| f64::from(*n))).collect()
            }
        };
        self.put(at + STEP_HEAD, &own);
    }

    /// Puts a route into the tables, and says where it begins.
    fn route(&mut self, line: &[DVec2]) -> usize {
        let first = self.tables.len();
        self.tables.push(0.0);
        for part in line.windows(2) {
            let Some(along) = (part[1] - part[0]).try_normalize() else { continue };
            let own = [part[0].x, part[0].y, along.x, along.y, part[0].distance(part[1])];
            self.tables.extend(own.map(|number| number as f32));
        }
        self.tables[first] = ((self.tables.len() - first) / 5) as f32;
        first
    }
}
