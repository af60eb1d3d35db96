//! Where cities stand, and things of them, before deformations move them.

use glam::{DQuat, DVec3};

use crate::{
    city::{decode_normal, encode_normal},
    geom::Aabb,
    render::heights::Height,
};

/// Where a content stands: `from` comes to `to`, and all else turned and scaled about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// What is turned and scaled about, metres.
    pub from: DVec3,
    /// Where that comes to stand, metres.
    pub to: DVec3,
    /// Turns.
    pub rotation: DQuat,
    /// Scales, > 0.
    pub scale: f64,
}

impl Placement {
    /// Where it is.
    pub const NONE: Self = Self { from: DVec3::ZERO, to: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 1.0 };

    /// Whether nothing moves.
    pub fn is_none(&self) -> bool {
        self.from == self.to && self.rotation == DQuat::IDENTITY && self.scale == 1.0
    }

    /// Where a point comes to stand.
    pub fn point(&self, p: DVec3) -> DVec3 {
        if self.is_none() { p } else { self.rotation * ((p - self.from) * self.scale) + self.to }
    }

    /// This one after another.
    pub fn after(&self, first: &Self) -> Self {
        if self.is_none() {
            return *first;
        }
        let rotation = self.rotation * first.rotation;
        Self { from: first.from, to: self.point(first.to), rotation, scale: self.scale * first.scale }
    }

    /// A box around what a box holds.
    pub fn boxed(&self, bounds: &Aabb) -> Aabb {
        if self.is_none() || bounds.is_empty() {
            return *bounds;
        }
        Aabb::from_points(bounds.corners().map(|c| self.point(c)))
    }
}

/// A city where it stands: the scene's own or a content's. Deformations move each by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct World {
    /// Which city; 0: the scene's own.
    pub city: u64,
    /// Where it stands.
    pub placement: Placement,
    /// Whether its objects are those of the scene's own city, and are as high as these.
    pub is_own: bool,
    /// Whether it moves by a timetable.
    pub moves: bool,
}

impl World {
    /// The scene's own city.
    pub const OWN: Self = Self { city: 0, placement: Placement::NONE, is_own: true, moves: false };
}

/// How something of a city stands before deformations move it: with another height, and placed.
#[derive(Clone, Copy)]
pub(super) struct Standing<'a> {
    /// First.
    pub raised: Option<Height>,
    /// Then.
    pub placement: &'a Placement,
}

impl Standing<'_> {
    /// Whether it stands elsewhere than its city has it.
    pub fn is_moved(&self) -> bool {
        self.raised.is_some() || !self.placement.is_none()
    }

    /// Where a place of its city stands.
    pub fn place(&self, place: DVec3) -> DVec3 {
        self.placement.point(self.raised.map_or(place, |height| height.place(place)))
    }

    /// A box around what stands in a box of its city.
    pub fn boxed(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() {
            return *bounds;
        }
        let raised =
            self.raised.map_or(*bounds, |height| Aabb::from_points([bounds.min, bounds.max].map(|p| height.place(p))));
        self.placement.boxed(&raised)
    }

    /// What a packed normal of its city becomes.
    pub fn packed_normal(&self, packed: u32) -> u32 {
        if !self.is_moved() {
            return packed;
        }
        let normal = decode_normal(packed);
        encode_normal(self.placement.rotation * self.raised.map_or(normal, |height| height.normal(normal)))
    }
}
