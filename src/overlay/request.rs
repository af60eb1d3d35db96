//! The request for a layout: overlays, their limits and their anchors, and their arrangement.

use glam::DVec2;

use crate::overlay::rect::Rect;

/// All that decides where overlays stand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Width and height of the picture, pixels.
    pub picture: [u32; 2],
    /// In any order: nothing depends on it. Their ids differ.
    pub overlays: Vec<Overlay>,
    /// Points that no overlay should cover, pixels: all points of interest that are seen. What is not finite is left out.
    pub avoid: Vec<DVec2>,
    /// The distance, in x or in y, that an overlay keeps from each of those points, pixels, 0 and up; 6 looks well.
    pub clearance: f64,
    /// Rectangles that overlays leave free as they do one another, with the gap: a title, a legend. Pixels, each `max` above its `min`; what is outside of the
    /// picture does not matter. An overlay that has no room beside them is folded.
    pub blocked: Vec<Rect>,
    /// Their arrangement.
    pub layout: Layout,
}

/// One overlay, as the layout sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// Its name. Whatever is else equal is decided by the lower id.
    pub id: u32,
    /// Higher ones are placed first and folded last. NaN counts as the lowest.
    pub priority: f64,
    /// Smallest, preferred and largest width and height, pixels. What is not finite or below 1 counts as 1; min ≤ preferred ≤ max is
    /// made so by raising the later one.
    pub min: DVec2,
    /// See `min`.
    pub preferred: DVec2,
    /// See `min`.
    pub max: DVec2,
    /// Where its context lines end. The first says where it would like to stand. What is not finite has no line.
    pub anchors: Vec<Focus>,
    /// The kind of its context lines.
    pub lines: LineKind,
    /// Degree of interest, 0..1; for [`SizeRule::ByInterest`].
    pub weight: f64,
    /// From the eye, metres, above 0; for [`SizeRule::ByDistance`] and [`Order::Distance`].
    pub distance: f64,
}

/// The end of a context line in the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Focus {
    /// A projected point of interest, pixels; it may be outside of the picture.
    Point(DVec2),
    /// The outline of an area, pixels, in either sense, without its first point again: the line ends where it meets it.
    Area(Vec<DVec2>),
}

/// The arrangement of overlays.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The sides of the picture along which they stand.
    pub arrangement: Arrangement,
    /// Their order along a side.
    pub order: Order,
    /// The rule by which the room of a side is shared.
    pub along: Along,
    /// The rule for their sizes.
    pub size: SizeRule,
    /// Between overlays and the picture's border, whole pixels.
    pub margin: u32,
    /// Between two overlays, whole pixels.
    pub gap: u32,
    /// The distance inward up to which overlays may stand that have no room along their side, as a share of the picture, 0..1. At 1 they go wherever there is room,
    /// at 0 they are folded.
    pub reach: f64,
    /// Exploration focus: the overlay whose first anchor is nearest to this centre of interest (pixels) stands in the middle of its side.
    pub centre_of_interest: Option<DVec2>,
    /// An overlay keeps still until its best place is further away than this, pixels, 0 and up.
    pub dead_band: f64,
    /// The distance that an overlay glides per call, pixels, 1 and up; infinite: in one step.
    pub glide: f64,
    /// Up to how many overlays the least number of crossings is proven, where it is not zero: all orders are tried, which takes
    /// a millisecond for 6, and nine times as long for each more. At most 9, and at most 5 with a frame before.
    pub proven: u32,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            arrangement: Arrangement::Border,
            order: Order::Anchors,
            along: Along::Even,
            size: SizeRule::Preferred,
            margin: 12,
            gap: 10,
            reach: 1.0,
            centre_of_interest: None,
            dead_band: 12.0,
            glide: 24.0,
            proven: 9,
        }
    }
}

/// The sides of the picture along which overlays stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// In columns at the left, the right or both sides.
    Vertical(Align),
    /// In rows at the top (`First`), the bottom (`Last`) or both.
    Horizontal(Align),
    /// Around the border: all four sides.
    Border,
}

/// Which of two opposite sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Left, or top.
    First,
    /// Right, or bottom.
    Last,
    /// Both.
    Both,
}

/// The order of overlays along a side: from the top, or from the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// That of their anchors, changed until least lines cross.
    Anchors,
    /// The highest priority first.
    Priority,
    /// The nearest first.
    Distance,
    /// The lowest id first.
    Id,
}

/// The rule by which the room of a side is shared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// With equal room between them, and at the ends.
    Even,
    /// One after another from the top, or from the left.
    Start,
    /// Each as near to the height (or the abscissa) of its first anchor as the others let it: least squares.
    Anchors,
}

/// The rule for the sizes of overlays before they have to shrink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeRule {
    /// As they prefer.
    Preferred,
    /// The nearest is as large as it may be; at twice its distance an overlay is half of the way to its smallest size, at four times three quarters.
    ByDistance,
    /// From smallest to largest by the degree of interest.
    ByInterest,
}

/// The way of a context line from its overlay to its focus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LineKind {
    /// A segment.
    #[default]
    Straight,
    /// Square to the overlay's border, then along it.
    Orthogonal,
    /// A quadratic Bézier curve that leaves square to the overlay's border: it has no loops, and x and y never turn back.
    Curved,
}
