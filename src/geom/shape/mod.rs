//! Lens volumes as numbers: what is inside, where a ray enters and leaves, how far the border is.
//!
//! One rule for borders, everywhere: a body is closed (its border belongs to it), and along a ray its interval is
//! `entry ≤ t < exit`. A ray that only touches (a tangent, a corner) has `entry = exit`: it misses. A ray that
//! runs within a face is inside it. A body without volume (radius 0, an edge 0) holds nothing.

mod build;
mod corridor;
pub mod definition;
pub mod error;
pub mod flat;
pub(crate) mod form;
mod hull;
pub mod limits;
mod mesh;
mod motion;
mod placed;
mod polytope;
pub mod solid;
mod span;
mod volume;

pub use definition::Shape;
pub use error::ShapeError;
pub use flat::{Flat, FlatFigure, Sightlines};
pub use form::{
    Extent, OfVolume, Volume, VolumeForm,
    body::{Rows, RowsEye},
    cylinder::Cylinder,
    ellipsoid::Ellipsoid,
    frustum::Frustum,
    oriented_box::OrientedBox,
    sphere::Sphere,
};
pub use hull::Hull;
pub use mesh::Mesh;
pub use motion::Motion;
pub use solid::{PlacedSolid, Solid};

#[cfg(test)]
mod tests;
