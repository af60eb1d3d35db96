//! Maps that are not among the operators here: a user's.

use std::{fmt::Debug, sync::Arc};

use glam::{DMat3, DVec3};

/// A map of the lens frame.
pub trait Map: Debug + Send + Sync {
    /// The name of its handler.
    fn name(&self) -> &str;

    /// How far a place is moved, metres, and the derivative of that by the place (columns: by x, y, z). Any number, or none.
    fn jet(&self, place: DVec3) -> (DVec3, DMat3);

    /// The extent of its lens along its axes, metres.
    fn size(&self) -> DVec3;

    /// Its parameters, as the GPU reads them.
    fn parameters(&self) -> &[f32];

    /// What tells it from others: maps with the same numbers do the same.
    fn identity(&self) -> &[u64];
}

/// A map, contained: whatever it gives, no place goes farther along an axis than its reach, and what is no number stays.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// The map.
    pub map: Arc<dyn Map>,
    /// How far a place is moved along each axis at most, metres, > 0.
    pub reach: f64,
    /// The shortest way, metres, over which what it does changes, > 0.
    pub detail: f64,
    /// The part of it that is used.
    pub strength: f64,
}

/// Differences on the GPU are taken over so many parts of the detail, half of them to each side.
const PARTS: f64 = 32.0;
/// And over no less than this part of the lens, for what f32 holds there.
const LEAST_PART: f64 = 1.0 / 4096.0;

impl PartialEq for Mapped {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |m: &Self| [m.reach, m.detail, m.strength];
        self.map.identity() == other.map.identity() && numbers(self) == numbers(other)
    }
}

impl Mapped {
    /// The way and its derivative.
    pub(super) fn jet(&self, place: DVec3) -> (DVec3, DMat3) {
        let (way, slope) = self.map.jet(place);
        let (mut out, mut rows) = (DVec3::ZERO, DMat3::ZERO);
        for i in 0..3 {
            // As the GPU has it: what f32 does not hold is no number.
            if way[i].abs() <= 3e38 {
                out[i] = way[i].clamp(-self.reach, self.reach);
                let row = slope.row(i);
                if way[i].abs() <= self.reach && row.is_finite() {
                    rows.x_axis[i] = row.x;
                    rows.y_axis[i] = row.y;
                    rows.z_axis[i] = row.z;
                }
            }
        }
        (out * self.strength, rows * self.strength)
    }

    /// How far a place is moved along each axis at most, metres.
    pub(super) fn most(&self) -> f64 {
        self.reach * self.strength
    }

    /// Half of how far apart places are of which the GPU makes the derivative, metres.
    pub fn half_difference(&self) -> f64 {
        (self.detail / (2.0 * PARTS)).max(LEAST_PART * self.map.size().max_element())
    }

    pub(super) fn fault(&self) -> Option<&'static str> {
        let is_length = |n: f64| n.is_finite() && n > 0.0;
        let is_right = is_length(self.reach) && is_length(self.detail) && self.strength.is_finite();
        (!is_right).then_some("the reach or the detail of a map is not a length")
    }
}
