//! Checked shapes, with what their tests need worked out once.

use glam::{DQuat, DVec2, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        border::{distance_of_ellipsoid, distance_of_frustum},
        flat::{ENDLESS_M, Flat},
        form::VolumeForm,
        hull::Hull,
        solid::PlacedSolid,
        span::{EVERYWHERE, Parted, Side, across, both, cone, round, slab},
    },
};

/// A checked shape with what its tests need worked out once.
#[derive(Clone, Debug, PartialEq)]
pub enum Volume {
    /// A ball.
    Sphere {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
    },
    /// A box: half edges, and the rotation that turns its axes into the world's.
    Box {
        /// Its middle, metres.
        center: DVec3,
        /// Half the edges or the height, metres.
        half: DVec3,
        /// Turns the box's axes into the world's.
        rotation: DQuat,
    },
    /// A cylinder: half height, unit axis.
    Cylinder {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
        /// Half the edges or the height, metres.
        half: f64,
        /// Unit.
        axis: DVec3,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Its middle, metres.
        center: DVec3,
        /// Half its extent along its axes, metres.
        radii: DVec3,
        /// Turns its axes into the world's.
        rotation: DQuat,
    },
    /// A cone, cut or not: half height, unit axis.
    Frustum {
        /// Its middle, metres.
        center: DVec3,
        /// Where the axis begins, and where it ends, metres, ≥ 0.
        radii: [f64; 2],
        /// Half the height, metres.
        half: f64,
        /// Unit.
        axis: DVec3,
    },
    /// A convex polytope.
    Convex(Hull),
    /// A solid of any form.
    Solid(PlacedSolid),
    /// What an eye sees through a figure.
    Flat(Flat),
}

impl Volume {
    /// Its form.
    pub fn form(&self) -> VolumeForm {
        match self {
            Self::Sphere { .. } => VolumeForm::Sphere,
            Self::Box { .. } => VolumeForm::Box,
            Self::Cylinder { .. } => VolumeForm::Cylinder,
            Self::Convex(_) => VolumeForm::Convex,
            Self::Ellipsoid { .. } => VolumeForm::Ellipsoid,
            Self::Frustum { .. } => VolumeForm::Frustum,
            Self::Solid(_) => VolumeForm::Solid,
            Self::Flat(_) => VolumeForm::Flat,
        }
    }

    /// Whether it has no volume: it holds no point and no ray meets it (hard case 21).
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Sphere { radius, .. } => *radius <= 0.0,
            Self::Box { half, .. } => half.min_element() <= 0.0,
            Self::Cylinder { radius, half, .. } => radius.min(*half) <= 0.0,
            Self::Ellipsoid { radii, .. } => radii.min_element() <= 0.0,
            Self::Frustum { radii, half, .. } => radii[0].max(radii[1]).min(*half) <= 0.0,
            Self::Convex(_) | Self::Solid(_) => false,
            Self::Flat(flat) => flat.is_empty(),
        }
    }

    /// Whether it is convex: all but solids and flat lenses.
    pub fn is_convex(&self) -> bool {
        !matches!(self, Self::Solid(_) | Self::Flat(_))
    }

    /// Whether it has an end on all sides.
    pub fn is_bounded(&self) -> bool {
        !matches!(self, Self::Flat(_))
    }

    /// Whether the closed body holds `p`.
    pub fn contains(&self, p: DVec3) -> bool {
        match self {
            Self::Solid(placed) => placed.solid.winding(placed.local(p)) != 0,
            Self::Flat(flat) => flat.contains(p),
            _ => self.signed_distance(p) <= 0.0 && !self.is_empty(),
        }
    }

    /// Where the line of `ray` enters and leaves: inside for `entry ≤ t < exit`; of a solid, which it may leave and enter again
    /// in between, the first and the last crossing ([`crate::geom::shape::solid::Solid::crossings`] has all of them). Both may be negative (behind the
    /// origin). `None`: it misses. A ray without direction is everywhere inside or misses. A flat lens knows only the sight
    /// lines of its own eye, and their exit is infinite.
    pub fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        if self.is_empty() {
            return None;
        }
        let (entry, exit) = match self {
            Self::Sphere { center, radius } => round(ray.origin - *center, ray.direction, *radius)?,
            Self::Box { center, half, rotation } => {
                let back = rotation.conjugate();
                let (o, d) = (back * (ray.origin - *center), back * ray.direction);
                (0..3).try_fold(EVERYWHERE, |all, axis| Some(both([all, slab(o[axis], d[axis], half[axis])?])))?
            }
            Self::Cylinder { center, radius, half, axis } => {
                let (o, d) = (ray.origin - *center, ray.direction);
                let (along_o, along_d) = (o.dot(*axis), d.dot(*axis));
                let side = round(o - along_o * *axis, across(d, *axis), *radius)?;
                both([side, slab(along_o, along_d, *half)?])
            }
            Self::Ellipsoid { center, radii, rotation } => {
                // A ball in its own measure.
                let back = rotation.conjugate();
                round(back * (ray.origin - *center) / *radii, back * ray.direction / *radii, 1.0)?
            }
            Self::Frustum { center, radii, half, axis } => {
                let (o, d) = (ray.origin - *center, ray.direction);
                let (along_o, along_d) = (o.dot(*axis), d.dot(*axis));
                let ends = slab(along_o, along_d, *half)?;
                let slope = (radii[1] - radii[0]) / (2.0 * half);
                let middle = 0.5 * (radii[0] + radii[1]);
                let o = Parted { across: o - along_o * *axis, along: along_o };
                let d = Parted { across: across(d, *axis), along: along_d };
                both([ends, cone(o, d, Side { middle, slope, ends })?])
            }
            Self::Convex(hull) => hull.entry_exit(ray)?,
            Self::Solid(placed) => {
                let crossings = placed.solid.crossings(&placed.local_ray(ray));
                let ends = (f64::INFINITY, f64::NEG_INFINITY);
                crossings.iter().fold(ends, |(low, high), c| (low.min(c.t), high.max(c.t)))
            }
            Self::Flat(flat) => flat.entry_exit(ray)?,
        };
        (entry < exit).then_some((entry, exit))
    }

    /// Exact Euclidean distance to the border, metres, negative inside.
    pub fn signed_distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Sphere { center, radius } => p.distance(*center) - radius,
            Self::Box { center, half, rotation } => {
                let q = (rotation.conjugate() * (p - *center)).abs() - *half;
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Cylinder { center, radius, half, axis } => {
                let v = p - *center;
                let along = v.dot(*axis);
                let q = DVec2::new((v - along * *axis).length() - radius, along.abs() - half);
                q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Ellipsoid { center, radii, rotation } => {
                distance_of_ellipsoid(rotation.conjugate() * (p - *center), *radii)
            }
            Self::Frustum { center, radii, half, axis } => {
                let v = p - *center;
                let along = v.dot(*axis);
                distance_of_frustum(DVec2::new((v - along * *axis).length(), along), *radii, *half)
            }
            Self::Convex(hull) => hull.signed_distance(p),
            Self::Solid(placed) => {
                let local = placed.local(p);
                let distance = placed.solid.distance(local);
                if placed.solid.winding(local) != 0 { -distance } else { distance }
            }
            Self::Flat(flat) => flat.signed_distance(p),
        }
    }

    /// The smallest axis-aligned box around it; one around everything for a flat lens, which has no end.
    pub fn bounds(&self) -> Aabb {
        let around = |center: DVec3, half: DVec3| Aabb { min: center - half, max: center + half };
        match self {
            Self::Sphere { center, radius } => around(*center, DVec3::splat(*radius)),
            Self::Box { center, half, rotation } => {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| *rotation * a);
                around(*center, (0..3).map(|i| half[i] * axes[i].abs()).sum())
            }
            Self::Cylinder { center, radius, half, axis } => {
                // A disc of normal n reaches r·√(1 − nᵢ²) along axis i.
                let disc = (DVec3::ONE - *axis * *axis).max(DVec3::ZERO).map(f64::sqrt);
                around(*center, *half * axis.abs() + *radius * disc)
            }
            Self::Ellipsoid { center, radii, rotation } => {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| *rotation * a);
                let squares: DVec3 = (0..3).map(|i| (radii[i] * axes[i]) * (radii[i] * axes[i])).sum();
                around(*center, squares.map(f64::sqrt))
            }
            Self::Frustum { center, radii, half, axis } => {
                let disc = (DVec3::ONE - *axis * *axis).max(DVec3::ZERO).map(f64::sqrt);
                around(*center - *half * *axis, radii[0] * disc).union(around(*center + *half * *axis, radii[1] * disc))
            }
            Self::Convex(hull) => hull.bounds(),
            Self::Solid(placed) => Aabb::from_points(placed.solid.bounds().corners().map(|c| placed.world(c))),
            Self::Flat(_) => around(DVec3::ZERO, DVec3::splat(ENDLESS_M)),
        }
    }
}
