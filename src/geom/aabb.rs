//! Axis-aligned boxes in f64 world metres.

use glam::DVec3;

/// An axis-aligned box, closed on all sides; `min > max` on any axis means empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner, metres.
    pub min: DVec3,
    /// Largest corner, metres.
    pub max: DVec3,
}

impl Default for Aabb {
    /// The empty box.
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that holds nothing: neutral for [`Aabb::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub fn from_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::grown)
    }

    /// The box that reaches so far to each side of its middle.
    pub fn around(center: DVec3, half: DVec3) -> Self {
        Self { min: center - half, max: center + half }
    }

    /// The distance of its nearest point from a point; 0 inside.
    pub fn distance_to(&self, point: DVec3) -> f64 {
        point.distance(point.max(self.min).min(self.max))
    }

    /// Whether the box holds no point at all.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box around this one and `point`.
    #[must_use]
    pub fn grown(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the closed boxes share a point.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// The middle; meaningless when empty.
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Full edge lengths, metres; zero when empty.
    pub fn size(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }

    /// The eight corners; bit 0, 1, 2 of the index choose max on x, y, z.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_meets_nothing() {
        let unit = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(!Aabb::EMPTY.meets(&unit));
        assert_eq!(Aabb::EMPTY.size(), DVec3::ZERO);
    }

    #[test]
    fn touching_boxes_meet() {
        let a = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let b = Aabb { min: DVec3::X, max: DVec3::X + DVec3::ONE };
        assert!(a.meets(&b));
        assert_eq!(Aabb::from_points(a.corners()), a);
    }
}
