//! Lens volumes (L3) as numbers: what is inside, where a ray enters and leaves, how far the border is.
//!
//! One rule for borders, everywhere: a body is closed (its border belongs to it), and along a ray its interval is
//! `entry ≤ t < exit` (L4). A ray that only touches (a tangent, a corner) has `entry = exit`: it misses. A ray that
//! runs within a face is inside it. A body without volume (radius 0, an edge 0) holds nothing.

mod hull;
mod mesh;

use glam::{DQuat, DVec2, DVec3};

pub use hull::Hull;
pub use mesh::Mesh;

use crate::geom::{Aabb, Ray};

/// A volume (L3), in model coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
    },
    /// An oriented box; `size` = full edges.
    Box {
        /// Its middle, metres.
        center: DVec3,
        /// Full edges, metres, ≥ 0.
        size: DVec3,
        /// Turns the box's axes into the world's.
        rotation: DQuat,
    },
    /// A finite cylinder; `axis` unit, `center` = the middle of its axis.
    Cylinder {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
        /// Full height, metres, ≥ 0.
        height: f64,
        /// Unit.
        axis: DVec3,
    },
    /// The convex hull of points.
    Convex {
        /// At least four, not on one plane; metres.
        points: Vec<DVec3>,
    },
}

/// Why a shape is no volume.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A number is NaN or infinite.
    #[error("every number must be finite")]
    NotFinite,
    /// A length is negative.
    #[error("{0} must be ≥ 0, is {1}")]
    Negative(&'static str, f64),
    /// The axis has no direction.
    #[error("axis must have a length, is 0, 0, 0")]
    NoAxis,
    /// Too few points for a volume.
    #[error("a convex hull needs at least 4 points that differ, has {0}")]
    FewPoints(usize),
    /// More points than a lens needs.
    #[error("a convex hull may have at most {max} points, has {0}", max = hull::MAX_POINTS)]
    ManyPoints(usize),
    /// All points lie on one plane (or line).
    #[error("all {0} points lie on one plane: the hull has no volume; move one of them off it")]
    Flat(usize),
}

/// A checked shape with what its tests need worked out once.
#[derive(Clone, Debug)]
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
    /// A convex polytope.
    Convex(Hull),
}

impl Shape {
    /// Checks the shape and prepares it.
    pub fn volume(&self) -> Result<Volume, ShapeError> {
        let finite = |ok: bool| if ok { Ok(()) } else { Err(ShapeError::NotFinite) };
        let length = |name, value: f64| if value >= 0.0 { Ok(()) } else { Err(ShapeError::Negative(name, value)) };
        match self {
            Self::Sphere { center, radius } => {
                finite(center.is_finite() && radius.is_finite())?;
                length("radius", *radius)?;
                Ok(Volume::Sphere { center: *center, radius: *radius })
            }
            Self::Box { center, size, rotation } => {
                finite(center.is_finite() && size.is_finite() && rotation.is_finite() && rotation.length() > 0.0)?;
                length("size", size.min_element())?;
                Ok(Volume::Box { center: *center, half: 0.5 * *size, rotation: rotation.normalize() })
            }
            Self::Cylinder { center, radius, height, axis } => {
                finite(center.is_finite() && radius.is_finite() && height.is_finite() && axis.is_finite())?;
                length("radius", *radius)?;
                length("height", *height)?;
                let axis = axis.try_normalize().ok_or(ShapeError::NoAxis)?;
                Ok(Volume::Cylinder { center: *center, radius: *radius, half: 0.5 * height, axis })
            }
            Self::Convex { points } => Hull::new(points).map(Volume::Convex),
        }
    }
}

impl Volume {
    /// Whether it has no volume: it holds no point and no ray meets it (hard case 21).
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Sphere { radius, .. } => *radius <= 0.0,
            Self::Box { half, .. } => half.min_element() <= 0.0,
            Self::Cylinder { radius, half, .. } => radius.min(*half) <= 0.0,
            Self::Convex(_) => false,
        }
    }

    /// Whether the closed body holds `p`.
    pub fn contains(&self, p: DVec3) -> bool {
        self.signed_distance(p) <= 0.0 && !self.is_empty()
    }

    /// Where the line of `ray` enters and leaves: inside for `entry ≤ t < exit`. Both may be negative (behind the
    /// origin). `None`: it misses. A ray without direction is everywhere inside or misses.
    pub fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        if self.is_empty() {
            return None;
        }
        let (entry, exit) = match self {
            Self::Sphere { center, radius } => round(ray.origin - *center, ray.direction, *radius)?,
            Self::Box { center, half, rotation } => {
                let back = rotation.conjugate();
                let (o, d) = (back * (ray.origin - *center), back * ray.direction);
                (0..3).try_fold(EVERYWHERE, |all, axis| Some(both(all, slab(o[axis], d[axis], half[axis])?)))?
            }
            Self::Cylinder { center, radius, half, axis } => {
                let (o, d) = (ray.origin - *center, ray.direction);
                let (along_o, along_d) = (o.dot(*axis), d.dot(*axis));
                let side = round(o - along_o * *axis, across(d, *axis), *radius)?;
                both(side, slab(along_o, along_d, *half)?)
            }
            Self::Convex(hull) => hull.entry_exit(ray)?,
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
            Self::Convex(hull) => hull.signed_distance(p),
        }
    }

    /// The smallest axis-aligned box around it.
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
            Self::Convex(hull) => hull.bounds(),
        }
    }
}

/// The interval of a ray that is inside wherever it is.
const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// What two intervals share (empty: entry > exit).
fn both(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.max(b.0), a.1.min(b.1))
}

/// Where `|o + t·d| ≤ half`. A ray parallel to the slab is inside it everywhere (its faces too) or nowhere.
fn slab(o: f64, d: f64, half: f64) -> Option<(f64, f64)> {
    if d == 0.0 {
        return (o.abs() <= half).then_some(EVERYWHERE);
    }
    let (a, b) = ((-half - o) / d, (half - o) / d);
    Some((a.min(b), a.max(b)))
}

/// `d` without its part along the unit `axis`; exactly zero where only rounding is left of it.
fn across(d: DVec3, axis: DVec3) -> DVec3 {
    let rest = d - d.dot(axis) * axis;
    if rest.length_squared() <= 1e-28 * d.length_squared() { DVec3::ZERO } else { rest }
}

/// Where `|o + t·d| ≤ radius`, for spheres and, with o and d across its axis, cylinders.
///
/// The discriminant is taken from the point of the ray nearest the centre: b² − ac of the textbook loses all digits
/// for a far eye (Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems I, ch. 7).
fn round(o: DVec3, d: DVec3, radius: f64) -> Option<(f64, f64)> {
    let a = d.length_squared();
    if a == 0.0 {
        return (o.length() <= radius).then_some(EVERYWHERE);
    }
    let middle = -o.dot(d) / a;
    let nearest = (o + middle * d).length();
    // (r − q)(r + q) keeps the sign of r − q where r² − q² rounds to nothing.
    let left = (radius - nearest) * (radius + nearest);
    (left > 0.0).then(|| {
        let half = (left / a).sqrt();
        (middle - half, middle + half)
    })
}

#[cfg(test)]
mod tests;
