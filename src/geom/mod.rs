//! Shapes and numbers. Nothing here knows what a city is.

pub mod aabb;
pub mod shape;

pub use aabb::Aabb;
pub use shape::Shape;
