//! Who hides what shall be seen: the focus area of occlusion lenses.

use crate::{
    lens::chosen::Choice,
    visibility::{Margin, Pace, Test},
};

/// The city objects, whole, that a test takes for occluders; worked out for each eye.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Occluders {
    /// Names of the points of interest that they hide; may be none where the test asks for none.
    pub pois: Vec<String>,
    /// When one is an occluder.
    pub test: Test,
    /// Those that are one in any case, but for points of interest and what others stand on.
    pub force: Option<Choice>,
    /// Those that never are one, forced or not.
    pub forbid: Option<Choice>,
    /// Over time, how far one may leave the test before it ceases to be one.
    pub margin: Margin,
    /// Over time, how fast they come and go.
    pub pace: Pace,
}
