//! How a city is shown where lenses move it: other heights of objects, and deformations after that.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    geom::{Aabb, deform::Deformers},
    render::heights::Heights,
};

/// How a city is shown: with other heights of objects, and then moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moved {
    /// First.
    pub heights: Arc<Heights>,
    /// The same of what moves by timetables, where the city's file has it: it is placed after that.
    pub heights_of_file: Arc<Heights>,
    /// Then.
    pub deformers: Arc<Deformers>,
}

impl Moved {
    /// Whether all is where it was.
    pub fn is_nothing(&self) -> bool {
        self.heights.is_empty() && self.deformers.0.is_empty()
    }

    /// The heights of objects of the city; of what moves by timetables, as its file has it.
    pub(super) fn heights_in(&self, moves: bool) -> &Heights {
        if moves { &self.heights_of_file } else { &self.heights }
    }

    /// Where a place is shown; of an object's, given that object.
    pub fn place(&self, object: Option<u32>, place: DVec3) -> DVec3 {
        self.deformers.value(object.map_or(place, |object| self.heights.place(object, place)))
    }

    /// A box around all that a box of the city becomes.
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        self.deformers.deformed_bounds(&self.heights.changed_bounds(bounds))
    }
}
