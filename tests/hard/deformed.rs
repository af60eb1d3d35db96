//! Deformation lenses, and where they show a place by the operators' formulas alone, in f64; which pixels surfaces cover, in f64; and closed
//! bodies that are cut unevenly.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec2, DVec3};
use veduta::{
    geom::{
        Shape,
        deform::{Deformer, Deformers},
    },
    lens::{
        Deform, Lens, LensBody,
        deform::{ControlProfile, Step, Viewer},
        kind::Deformation,
    },
    render::picture::{Picture, Request, Studio},
    scene::Scene,
    view::View,
};

use crate::{
    bodies::{Body, place},
    lenses::{in_cube, share},
    oracle::{Numbers, P3, normal},
    studio,
};

/// A deformation lens over a box.
#[derive(Clone, Debug)]
pub struct Bent {
    pub center: DVec3,
    pub size: DVec3,
    pub rotation: DQuat,
    pub steps: Vec<Step>,
    pub control: ControlProfile,
}

impl Bent {
    /// An upright one.
    pub fn upright(center: DVec3, size: DVec3, steps: Vec<Step>, control: ControlProfile) -> Self {
        Self { center, size, rotation: DQuat::IDENTITY, steps, control }
    }

    /// As a scene has it.
    pub fn lens(&self, name: &str) -> Lens {
        let Self { center, size, rotation, .. } = *self;
        let deform = Deform { steps: self.steps.clone(), control: Some(self.control.clone()), strength: 1.0 };
        Lens {
            shapes: vec![Shape::Box { center, size, rotation }.into()],
            body: LensBody::None,
            ..Lens::plain(name, Deformation::from(deform), [0.5; 3])
        }
    }

    /// Where a place of the world is shown.
    pub fn value(&self, place: DVec3) -> DVec3 {
        let pivot = self.center - self.rotation * DVec3::new(0.0, 0.0, 0.5 * self.size.z);
        let rest = self.rotation.inverse() * (place - pivot);
        let kappa = self.kappa(rest);
        let moved = self.steps.iter().fold(rest, |p, step| stepped(step, self.size, p));
        if kappa == 0.0 { place } else { place + self.rotation * (kappa * (moved - rest)) }
    }

    /// How strong it is at a place of its frame.
    fn kappa(&self, p: DVec3) -> f64 {
        let at = 2.0 * p.truncate() / self.size.truncate();
        if let ControlProfile::Everywhere = self.control {
            return 1.0;
        }
        if at.abs().max_element() >= 1.0 {
            return 0.0;
        }
        // From the border: 0 to 1 in the middle.
        let rise = |border: f64| (0.5 * (1.0 - at.abs()) / border).min(DVec2::ONE);
        let smooth = |q: f64| q * q * (3.0 - 2.0 * q);
        match self.control {
            ControlProfile::Linear { border } => rise(border).element_product(),
            ControlProfile::Smooth { border } => smooth(rise(border).x) * smooth(rise(border).y),
            ControlProfile::Bump => (1.0 - at.length_squared()).max(0.0).powi(2),
            ControlProfile::Ring { inner, outer } => {
                let (inner, outer) = (inner * inner, outer * outer);
                let v = (2.0 * at.length_squared() - inner - outer) / (outer - inner);
                (1.0 - v * v).max(0.0).powi(2) * f64::from(u8::from(v.abs() < 1.0))
            }
            _ => unreachable!("no image"),
        }
    }
}

/// One step in the frame of a lens over a box of a size, by its geometry.
pub fn stepped(step: &Step, size: DVec3, p: DVec3) -> DVec3 {
    let part = (p.z / size.z).clamp(0.0, 1.0);
    match *step {
        Step::Translate { by } => p + by,
        Step::Scale { factors } => p * factors,
        Step::Shear { slope } => p + (slope * p.z).extend(0.0),
        Step::Taper { factor } => (p.truncate() * (1.0 + (factor - 1.0) * part)).extend(p.z),
        Step::Twist { angle } => DVec2::from_angle(angle * part).rotate(p.truncate()).extend(p.z),
        Step::Bend { angle: 0.0 } => p,
        Step::Bend { angle } => {
            // On circles about the line y = 0, z = r; straight beyond both ends.
            let r = size.y / angle;
            let y = p.y.clamp(-0.5 * size.y, 0.5 * size.y);
            let (sin, cos) = (y / r).sin_cos();
            let beyond = p.y - y;
            DVec3::new(p.x, (r - p.z) * sin + beyond * cos, r - (r - p.z) * cos + beyond * sin)
        }
        _ => unreachable!("a step over a box"),
    }
}

/// Several, bottom first.
pub fn shown(lenses: &[Bent], place: DVec3) -> DVec3 {
    lenses.iter().fold(place, |place, lens| lens.value(place))
}

/// Ready for use as they were asked for.
pub fn deformers(lenses: &[Bent]) -> Deformers {
    let viewer = Viewer { eye: DVec3::ZERO, forward: DVec3::Y, ground: 0.0 };
    let ready = |lens: &Bent| {
        let Bent { center, size, rotation, .. } = *lens;
        let area = Shape::Box { center, size, rotation };
        let deform = lens.lens("").deform().expect("a deformation").clone();
        let made = deform.deformation(Some(&area), &viewer, |_| Err("no images".into())).expect("steps over a box");
        Deformer::new(made).expect("numbers that can be used")
    };
    Deformers(lenses.iter().map(ready).collect())
}

/// The determinant of the derivative, by central differences of two steps (Richardson); `None` at a kink, where they are others.
pub fn determinant(value: impl Fn(DVec3) -> DVec3, at: DVec3, step: f64) -> Option<f64> {
    let by = |step: f64| {
        let along = |axis: DVec3| (value(at + step * axis) - value(at - step * axis)) / (2.0 * step);
        DMat3::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    };
    let (fine, coarse) = (by(step), by(2.0 * step));
    let size = fine.to_cols_array().iter().fold(1.0_f64, |size, c| size.max(c.abs()));
    let is_smooth = (fine - coarse).to_cols_array().iter().all(|d| d.abs() < 1e-5 * size);
    is_smooth.then(|| ((fine * 4.0 - coarse) * (1.0 / 3.0)).determinant())
}

/// One sample with all AOVs and statistics.
pub fn drawn(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Picture {
    let request = Request { aovs: studio::ALL, statistics: true, backend: studio.backend, ..Request::plain(size) };
    studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether a picture says that a deformation was weakened.
pub fn is_weakened(picture: &Picture) -> bool {
    picture.statistics.warnings.iter().any(|warning| warning["code"] == "deformation-weakened")
}

/// The distances of a picture; none is NaN, and none is behind the eye.
pub fn distances(picture: &Picture) -> &[f32] {
    let depth = picture.depth.as_ref().expect("depth was asked for");
    let wrong = depth.iter().position(|d| d.is_nan() || *d <= 0.0);
    assert!(wrong.is_none(), "pixel {wrong:?} has a distance that is none: {:?}", wrong.map(|i| depth[i]));
    let normals = picture.normal.as_ref().expect("normals were asked for");
    assert!(normals.iter().flatten().all(|n| n.is_finite() && n.abs() <= 1.01), "a normal that is none");
    depth
}

/// Pixels of a picture.
pub struct Pixels {
    pub size: [u32; 2],
    pub is_in: Vec<bool>,
}

impl Pixels {
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, is_in: vec![false; (size[0] * size[1]) as usize] }
    }

    /// Adds those whose middles a triangle of the world covers, before the near plane, or comes within `reach` pixels of.
    pub fn add(&mut self, view: &View, triangle: [DVec3; 3], reach: f64) {
        // Cut at the near plane.
        let near = view.camera.near_m;
        let mut seen: Vec<DVec2> = Vec::with_capacity(4);
        for i in 0..3 {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            let (own, next) = (view.depth(a), view.depth(b));
            if own >= near {
                seen.extend(view.pixel(a).map(|p| p.truncate()));
            }
            if (own >= near) != (next >= near) {
                seen.extend(view.pixel(a + (b - a) * ((near - own) / (next - own))).map(|p| p.truncate()));
            }
        }
        for i in 2..seen.len() {
            self.fill([seen[0], seen[i - 1], seen[i]], reach);
        }
    }

    fn fill(&mut self, [a, b, c]: [DVec2; 3], reach: f64) {
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        let low = (a.min(b).min(c) - reach - 0.5).ceil().clamp(DVec2::ZERO, size);
        let high = (a.max(b).max(c) + reach + 0.5).floor().clamp(DVec2::ZERO, size);
        let sides = [[a, b], [b, c], [c, a]];
        for y in low.y as u32..high.y as u32 {
            for x in low.x as u32..high.x as u32 {
                let pixel = (y * self.size[0] + x) as usize;
                if self.is_in[pixel] {
                    continue;
                }
                let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let turns = sides.map(|[a, b]| (b - a).perp_dot(p - a));
                let is_within = turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0);
                let is_near = |[a, b]: [DVec2; 2]| {
                    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-300)).clamp(0.0, 1.0);
                    p.distance_squared(a + (b - a) * t) <= reach * reach
                };
                self.is_in[pixel] = is_within || reach > 0.0 && sides.into_iter().any(is_near);
            }
        }
    }
}

/// A parallelogram in `parts` along both sides.
pub fn patch(corner: DVec3, u: DVec3, v: DVec3, parts: [u32; 2]) -> Vec<[DVec3; 3]> {
    let at =
        |i: u32, j: u32| corner + u * (f64::from(i) / f64::from(parts[0])) + v * (f64::from(j) / f64::from(parts[1]));
    let cells = (0..parts[0]).flat_map(|i| (0..parts[1]).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect()
}

/// A triangle in n² parts.
pub fn parts([a, b, c]: [DVec3; 3], n: u32) -> Vec<[DVec3; 3]> {
    let at = |i: u32, j: u32| a + (b - a) * (f64::from(i) / f64::from(n)) + (c - a) * (f64::from(j) / f64::from(n));
    let mut all = Vec::new();
    for i in 0..n {
        for j in 0..n - i {
            all.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < n {
                all.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    all
}

/// A closed mesh in whole millimetres whose neighbours share corners.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub corners: Vec<P3>,
    pub triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// A box around zero.
    pub fn block(half: P3) -> Self {
        let at = |i: i64| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -half[axis] } else { half[axis] });
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self { corners: (0..8).map(at).collect(), triangles }
    }

    /// A rough ball around zero.
    pub fn ball(radius: f64, numbers: &mut Numbers) -> Self {
        let mut corners = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let mut triangles =
            vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        for _ in 0..2 {
            let mut middles = std::collections::BTreeMap::new();
            let mut middle = |a: usize, b: usize| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    corners.push((corners[a] + corners[b]).normalize_or(DVec3::X));
                    corners.len() - 1
                })
            };
            let finer = |[a, b, c]: [usize; 3]| {
                let [m, n, k] = [(a, b), (b, c), (c, a)].map(|(a, b)| middle(a, b));
                [[a, m, k], [m, b, n], [k, n, c], [m, n, k]]
            };
            triangles = triangles.into_iter().flat_map(finer).collect();
        }
        let rough = |p: DVec3| (p * 1000.0 * radius * (0.85 + 0.15 * share(numbers))).round();
        let corners = corners.into_iter().map(rough).map(|p| p.to_array().map(|c| c as i64)).collect();
        Self { corners, triangles }
    }

    /// Halves edges at random, in both triangles beside each: as unevenly as chance has it.
    #[must_use]
    pub fn halved(mut self, count: usize, numbers: &mut Numbers) -> Self {
        for _ in 0..count {
            let [a, b, _] = self.triangles[numbers.below(self.triangles.len() as u64) as usize];
            let (p, q) = (self.corners[a], self.corners[b]);
            let middle = [0, 1, 2].map(|i| (p[i] + q[i]) / 2);
            let m = self.corners.len();
            self.corners.push(middle);
            let mut halves = Vec::with_capacity(self.triangles.len() + 2);
            for t in &self.triangles {
                match (0..3).find(|&i| [t[i], t[(i + 1) % 3]] == [a, b] || [t[i], t[(i + 1) % 3]] == [b, a]) {
                    Some(i) => {
                        let [a, b, c] = [t[i], t[(i + 1) % 3], t[(i + 2) % 3]];
                        halves.extend([[m, c, a], [m, b, c]]);
                    }
                    None => halves.push(*t),
                }
            }
            let has_area = |t: &[usize; 3]| normal(t.map(|i| self.corners[i])) != [0; 3];
            if halves.iter().all(has_area) {
                self.triangles = halves;
            }
        }
        self
    }

    /// As faces, moved by whole millimetres.
    pub fn body(&self, by: P3) -> Body {
        let corner = |i: usize| [0, 1, 2].map(|axis| self.corners[i][axis] + by[axis]);
        self.triangles.iter().map(|t| t.map(corner).to_vec()).collect()
    }

    /// The places of its triangles, metres, with all ways from `about` (millimetres) this much shorter.
    pub fn places(&self, by: P3, factor: f64) -> Vec<[DVec3; 3]> {
        let about = place(by);
        let corner =
            |i: usize| about + factor * (place([0, 1, 2].map(|axis| self.corners[i][axis] + by[axis])) - about);
        self.triangles.iter().map(|t| t.map(corner)).collect()
    }
}

/// A deformation about a body around `center` of some `reach` metres, one of four kinds; few of them fold.
pub fn strong(kind: usize, center: DVec3, reach: f64, numbers: &mut Numbers) -> Vec<Bent> {
    let mut between = |low: f64, high: f64| low + (high - low) * share(numbers);
    let size = DVec3::new(between(2.0, 4.0), between(2.0, 4.0), between(2.0, 3.0)) * reach;
    let rotation = DQuat::from_rotation_z(between(0.0, TAU)) * DQuat::from_rotation_x(between(-0.5, 0.5));
    let everywhere = ControlProfile::Everywhere;
    let sign = if between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
    match kind % 4 {
        0 => {
            let steps = vec![Step::Twist { angle: between(-6.0, 6.0) }, Step::Taper { factor: between(0.3, 2.0) }];
            vec![Bent { center, size, rotation, steps, control: everywhere }]
        }
        1 => {
            // What is bent is below the line about which it is bent.
            let angle = between(1.0, 3.0) * size.y / reach / 4.0;
            let steps = vec![
                Step::Scale { factors: DVec3::new(between(0.5, 1.5), 1.0, between(0.2, 0.4)) },
                Step::Bend { angle: angle * sign * 0.7 },
            ];
            vec![Bent { center, size, rotation, steps, control: everywhere }]
        }
        2 => {
            // A slope of the control over the half of half a side.
            let by = DVec3::new(between(-0.1, 0.1), between(-0.1, 0.1), between(-2.0, 2.0)) * reach;
            let steps = vec![Step::Translate { by }, Step::Twist { angle: between(-0.4, 0.4) }];
            let size = size * DVec3::new(0.6, 0.6, 1.0);
            let control = ControlProfile::Smooth { border: 0.5 };
            let aside = reach * DVec3::new(between(-0.6, 0.6), between(-0.6, 0.6), 0.0);
            let rotation = DQuat::from_rotation_z(between(0.0, TAU));
            vec![Bent { center: center + aside, size, rotation, steps, control }]
        }
        _ => {
            let lift = Step::Translate { by: DVec3::Z * between(0.5, 1.5) * reach };
            let shear = Step::Shear { slope: DVec2::new(between(-1.0, 1.0), between(-1.0, 1.0)) };
            let twist = Step::Twist { angle: between(-4.0, 4.0) };
            let control = ControlProfile::Bump;
            vec![
                Bent { center, size: size * 0.5, rotation: DQuat::IDENTITY, steps: vec![lift], control },
                Bent { center, size, rotation, steps: vec![shear, twist], control: everywhere },
            ]
        }
    }
}

/// A direction.
pub fn direction(numbers: &mut Numbers) -> DVec3 {
    in_cube(numbers).try_normalize().unwrap_or(DVec3::X)
}
