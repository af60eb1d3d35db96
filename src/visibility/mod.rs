//! Occluder detection: objects that hide others (Trapp §3.3.1), on the CPU, in f64.
//!
//! The unit is the root city object with all its parts ([`Units`]). A [`Test`] says when one is an occluder; [`Scope::detect`]
//! asks it of a whole city and says of each occluder which parts of the test held ([`Detected`]). [`Memory`] keeps classes from
//! flickering over time, [`CaseMemory`] the ways in which they are drawn.
//!
//! And what is worth seeing: the best views of an object ([`best_views`]), the objects that stand out ([`landmarks()`]), and where a person
//! stands before one ([`Before`]).

mod best_view;
mod bounds;
mod cases;
mod coverage;
mod detect;
mod landmarks;
mod memory;
mod set;
mod standing;
mod test;
mod units;

pub use best_view::{APART, BestView, MOST_VIEWS, NoView, Seen, Subject, best_views, upright};
pub use cases::CaseMemory;
pub use coverage::Coverage;
pub use detect::{Detected, Margin, Occluder, Query, Scope};
pub use landmarks::{Landmark, Terms, landmarks};
pub use memory::{Memory, Pace};
pub use set::Set;
pub use standing::{Before, ENOUGH, EYE_HEIGHT_M, Standing};
pub use test::{Reference, Test};
pub use units::{Poi, Units, Viewer};

#[cfg(test)]
mod tests;
