//! A layout: places, markers, context lines and their crossings, and what could not be done.

use crate::overlay::{lane::Side, rect::Rect, request::Request};
use glam::DVec2;

/// Where overlays stand, and their lines. It is also what the next frame needs to know of this one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placed {
    /// Those that have a place, by id.
    pub placements: Vec<Placement>,
    /// Those that have none, by id.
    pub folded: Vec<u32>,
    /// Markers that stand for those that are folded.
    pub markers: Vec<Marker>,
    /// The context lines, by overlay and anchor.
    pub lines: Vec<ContextLine>,
    /// Which lines cross what.
    pub crossings: Crossings,
    /// Whether no other order along the lanes has less crossings, with as many overlays on each. True only where there are none, or where this call
    /// tried all orders.
    pub is_least: bool,
    /// The wishes that could not be met, by overlay.
    pub facts: Vec<Fact>,
    /// The sides along which overlays are on their way: the next call moves them further, even if nothing else changes.
    pub gliding: Vec<Side>,
    /// Whether the next call gives this again, at no cost, if the request is equal (which one with NaN never is).
    pub settled: bool,
    /// Why overlays moved further than they glide, or changed their order; `None` if none did.
    pub jump: Option<Jump>,
    /// Eighths of the way from wanted to smallest sizes, 0..8.
    pub step: u32,
    /// The request.
    pub request: Request,
    /// The overlay in the exploration focus.
    pub focused: Option<u32>,
    /// Crossings for which no better order was found: it is not looked for again until their number changes.
    pub(crate) hopeless: u32,
    /// The overlay that had the last turn, of those that wait for a place, or for a better one.
    pub(crate) turn: Option<u32>,
    /// The number of them that had a turn since the request or a place has changed.
    pub(crate) tried: usize,
}

/// Why overlays move in one step. The first that holds is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jump {
    /// There is no frame before, or it has another picture, arrangement, margin or gap, or what stood there has no room at all any more.
    Anew,
    /// An overlay came: a new one, or one that was folded or further inward and has found a place. Those of its lane make room.
    Came,
    /// The order along a lane changed: less lines cross, or what the order goes by has changed.
    Order,
    /// All have become smaller or larger, and on the way they would meet.
    Size,
    /// A point, or what is blocked, came where an overlay stood, and would be covered on the way.
    Room,
}

/// An overlay that has a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Its id.
    pub id: u32,
    /// Where it stands, whole pixels.
    pub rect: Rect,
    /// On which side.
    pub seat: Seat,
}

/// The way in which an overlay stands at its side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seat {
    /// In the row along it; the number counts from the top or from the left.
    Lane(Side, u32),
    /// Further inward, or in a corner.
    Inward(Side),
}

impl Seat {
    /// Its side.
    pub fn side(self) -> Side {
        let (Self::Lane(side, _) | Self::Inward(side)) = self;
        side
    }
}

/// Stands for folded overlays.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Where: the first anchor of the most important of them, moved into the picture; pixels. Of those without an anchor the picture's middle.
    pub at: DVec2,
    /// The folded overlays, by id; their number is what it shows.
    pub overlays: Vec<u32>,
}

/// A context line.
#[derive(Clone, Debug, PartialEq)]
pub struct ContextLine {
    /// The overlay.
    pub overlay: u32,
    /// Which of its anchors, by number.
    pub anchor: usize,
    /// From the overlay's border to the focus, pixels; two at least, on 1/256 of a pixel. A curve is given by segments.
    pub points: Vec<DVec2>,
}

/// Which lines cross what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of lines of different overlays that share a point, other than a common focus where both end.
    pub lines: u32,
    /// Pairs of a line and another overlay that share a point.
    pub overlays: u32,
}

impl Crossings {
    /// Both.
    pub fn sum(self) -> u32 {
        self.lines + self.overlays
    }
}

/// A wish that could not be met.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// The overlay covers points, which it would wherever it stood; numbers in [`Request::avoid`].
    Covers {
        /// Id.
        overlay: u32,
        /// Which points.
        points: Vec<usize>,
    },
    /// The overlay is larger than the picture less its margin, even at its smallest.
    TooLarge {
        /// Id.
        overlay: u32,
    },
    /// There is no room left for the overlay.
    NoRoom {
        /// Id.
        overlay: u32,
    },
    /// The anchor is no place: not finite, or an area without points.
    NoAnchor {
        /// Id.
        overlay: u32,
        /// Its number.
        anchor: usize,
    },
    /// The overlay covers its own focus, so that there is no line to it.
    OnItsFocus {
        /// Id.
        overlay: u32,
        /// The number of the anchor.
        anchor: usize,
    },
}

impl Placed {
    /// Whether an overlay covers points.
    pub(crate) fn covers(&self, id: u32) -> bool {
        self.facts.iter().any(|f| matches!(f, Fact::Covers { overlay, .. } if *overlay == id))
    }
}
