//! `flat`: an object pressed to the ground (Trapp §3.3, ad hoc). What is seen of it from above lies there as in a map: faces that look up, and
//! roofs whichever way they were turned; the highest is seen where several lie on each other.
//!
//! Where the city has a ground of its own below the object, its faces are cut along the triangles of that and lie on them, so that they
//! follow slopes; elsewhere they are level, at the object's lowest point.
//!
//! `top`: the same as a picture from straight above (Trapp §3.3, advanced): faces keep the normals by which they were lit. The field draws such a
//! picture for each object into a texture of its own and lays it on the ground as a quad. Here the faces themselves lie there: no texel is
//! too large near the eye, slopes are followed, ids and other AOVs stay, and what light the scene has now falls on them.

use super::{
    moved::Change,
    source::{Source, Unit},
};
use crate::city::derived::form::{Form, LIFT_M};

/// Lowest points are rounded to this, per metre: those of neighbours are then one plane where they are meant to be.
const PER_M: f64 = 1000.0;

/// Faces that cover less of the ground than this are seen from the side only, square metres.
pub(super) const LEAST_AREA_M2: f64 = 1e-6;

pub(super) fn change(source: &Source, unit: &Unit, form: &Form) -> Change {
    let lift = if let Form::Flat { lift_m } | Form::Top { lift_m } = form { *lift_m } else { LIFT_M };
    let is_lit = matches!(form, Form::Top { .. });
    let z = (unit.bounds.min.z * PER_M).round() / PER_M + lift;
    let sides = || source.faces_of(unit).map(|face| 0.5 * face.normal().z);
    if sides().any(|side| side > LEAST_AREA_M2) {
        Change::Level { z, base: unit.bounds.min.z, lift, from_below: false, is_lit }
    } else if sides().any(|side| side < -LEAST_AREA_M2) {
        Change::Level { z, base: unit.bounds.min.z, lift, from_below: true, is_lit }
    } else {
        Change::Gone
    }
}
