//! Derived cities: what objects may be shown as instead of themselves. Made of a city object by object, so that each
//! derived face belongs to the object that it stands for, by the same number: lenses of objects hold it when they hold that.
//!
//! ```text
//! shown geometries ─> units: a root with its parts (`source`) ─┬─> a closed body of each (`bodies`: box, prism, hull) ─> builder
//!                                                               ├─> its own faces, moved (`moved`: flat, height)
//!                                                               └─> what it covers of the ground (`footprint`), for what fades at its rim
//! ```
//!
//! Terrain, water, roads and land use are never derived. One file per form, one row per form in [`FORMS`].

mod bodies;
mod boxes;
mod flat;
mod footprint;
mod form;
mod ground;
mod height;
mod hull;
mod lod1;
mod moved;
mod prism;
mod source;

use crate::city::model::CityModel;

pub use self::footprint::{Footprint, footprints};
pub use self::form::{Derive, Derived, Form, HEIGHT_RANGE_M, Height, LIFT_M, LIFT_RANGE_M};
use self::{ground::GroundFaces, source::Source};

/// A form as scene files have it.
#[derive(Clone, Copy, Debug)]
pub struct FormRow {
    /// Its word.
    pub word: &'static str,
    /// The options that it takes.
    pub options: &'static [&'static str],
    make: Make,
}

#[derive(Clone, Copy, Debug)]
enum Make {
    Body(bodies::Make),
    Moved(moved::Make),
    Other(fn(&CityModel, &[u32], &Derive) -> Derived),
}

/// All forms.
pub const FORMS: [FormRow; 7] = [
    FormRow { word: "box", options: &["oriented"], make: Make::Body(boxes::body) },
    FormRow { word: "prism", options: &[], make: Make::Body(prism::body) },
    FormRow { word: "hull", options: &[], make: Make::Body(hull::body) },
    FormRow { word: "flat", options: &["lift"], make: Make::Moved(flat::change) },
    FormRow { word: "top", options: &["lift"], make: Make::Moved(flat::change) },
    FormRow { word: "lod1", options: &[], make: Make::Other(lod1::derived) },
    FormRow { word: "height", options: &["height", "factor"], make: Make::Moved(height::change) },
];

/// The words of [`FORMS`], in their order.
pub const WORDS: &[&str] = &{
    let (mut words, mut i) = ([""; FORMS.len()], 0);
    while i < FORMS.len() {
        words[i] = FORMS[i].word;
        i += 1;
    }
    words
};

impl Form {
    /// Its row.
    pub fn row(&self) -> &'static FormRow {
        &FORMS[match self {
            Self::Box { .. } => 0,
            Self::Prism => 1,
            Self::Hull => 2,
            Self::Flat { .. } => 3,
            Self::Top { .. } => 4,
            Self::Lod1 => 5,
            Self::Height(_) => 6,
        }]
    }
}

/// Derives a city from what is `shown` of one (indices of geometries).
pub fn derive(model: &CityModel, shown: &[u32], how: &Derive) -> Derived {
    let mut source = Source::new(model, shown, how.parts);
    if how.form.is_pressed() {
        source.ground = GroundFaces::new(model, shown);
    }
    match how.form.row().make {
        Make::Body(make) => bodies::derived(&source, &how.form, make, None),
        Make::Other(derived) => derived(model, shown, how),
        Make::Moved(make) => moved::derived(&source, &how.form, make),
    }
}

#[cfg(test)]
mod tests;
