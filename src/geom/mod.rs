//! Shapes and numbers. Nothing here knows what a city is.

pub mod aabb;
pub mod bvh;
pub mod combination;
pub mod common_part;
pub mod deform;
pub mod exact;
pub mod outline;
pub mod plane;
pub mod ray;
pub mod shaft;
pub mod shape;
pub mod sphere;
pub(crate) mod triangle;
pub mod triangulate;

pub use aabb::Aabb;
pub use common_part::CommonPart;
pub use ray::Ray;
pub use shape::{Shape, Solid, Volume};
pub use sphere::Sphere;
pub(crate) use triangle::clipped;
