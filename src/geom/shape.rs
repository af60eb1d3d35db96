//! Lens volumes (L3) as numbers: what is inside, where a ray enters and leaves, how far the border is.

use glam::{DQuat, DVec3};

/// A volume (L3), in model coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere { center: DVec3, radius: f64 },
    /// An oriented box; `size` = full edges.
    Box { center: DVec3, size: DVec3, rotation: DQuat },
    /// A finite cylinder; `axis` unit, `center` = the middle of its axis.
    Cylinder { center: DVec3, radius: f64, height: f64, axis: DVec3 },
    /// The convex hull of points.
    Convex { points: Vec<DVec3> },
}
