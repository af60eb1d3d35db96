//! What was measured of a city so far, as plain data ([`crate::city::measured`] measures it).

use std::sync::OnceLock;

/// A face: the triangles of an object that face one way and are of one semantic surface, as far as that has more than a type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Its object.
    pub object: u32,
    /// Its packed normal.
    pub normal: u32,
    /// Its semantic surface, index into `CityModel::details`, or `NONE`.
    pub detail: u32,
    /// Square metres.
    pub area: f64,
}

/// What was measured of a city so far.
#[derive(Debug, Default)]
pub struct Measured {
    /// Of each object whether it is shown by default.
    pub(super) shown: OnceLock<Vec<bool>>,
    /// What triangles say.
    pub(super) faces: OnceLock<OfFaces>,
    /// Of each object the ground that it covers, square metres, NaN where it covers none.
    pub(super) areas: OnceLock<Vec<f64>>,
}

impl Clone for Measured {
    /// That of another model, which may change: measured anew.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// What triangles say.
#[derive(Debug, Default)]
pub(super) struct OfFaces {
    /// One per object.
    pub sums: Vec<Sums>,
    /// All faces, by object, then by normal, then by detail.
    pub faces: Vec<Face>,
    /// The direction of each object, NaN without one.
    pub azimuths: Vec<f64>,
}

/// Sums over the triangles of an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    /// Lowest and highest place, metres.
    pub low: f64,
    pub high: f64,
    /// 0 where they are closed.
    pub edges: u64,
    /// Six times the volume, cubic metres.
    pub volume: f64,
    /// Area of roofs, square metres, and the same times their slopes, degrees.
    pub roof: f64,
    pub sloped: f64,
}

impl Sums {
    pub const NONE: Self =
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY, edges: 0, volume: 0.0, roof: 0.0, sloped: 0.0 };

    pub fn add(&mut self, other: &Self) {
        (self.low, self.high) = (self.low.min(other.low), self.high.max(other.high));
        self.edges = self.edges.wrapping_add(other.edges);
        self.volume += other.volume;
        self.roof += other.roof;
        self.sloped += other.sloped;
    }
}
