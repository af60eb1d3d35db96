//! Drawing on the city, point by point.

use glam::DVec3;

/// The figure that is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// A way: a lens along it.
    Route,
    /// A polygon: a lens over it.
    Area,
    /// Something to measure.
    Measure,
}

impl Figure {
    /// The least number of points that it takes.
    pub(super) fn least(self) -> usize {
        if self == Self::Area { 3 } else { 2 }
    }

    pub(super) fn hint(self) -> &'static str {
        match self {
            Self::Route => {
                "Click along the way. Enter puts the lens, Backspace takes the last point back, Esc ends it."
            }
            Self::Area => {
                "Click around the area. Enter puts the lens, Backspace takes the last point back, Esc ends it."
            }
            Self::Measure => "Click from place to place. Backspace takes the last point back, Esc ends it.",
        }
    }
}

/// A figure that is being drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// The figure.
    pub figure: Figure,
    /// Its points so far, metres.
    pub points: Vec<DVec3>,
}
