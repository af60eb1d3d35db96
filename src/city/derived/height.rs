//! `height`: an object at another height. Below its lowest roof all is stretched or shortened; what is above moves as it is.
//!
//! ```text
//! new height │        ╱  slope 1: roofs keep their form
//!            │       ╱
//!            │    ╱      slope (new walls / old walls)
//!            │ ╱
//!            └──────────── old height
//!           base   lowest roof   top
//! ```
//!
//! An object without walls below its roofs, or one that is to be lower than its roofs are high, is scaled as a whole.

use super::{
    moved::{Change, Steps},
    source::{Part, Source, Unit},
};
use crate::city::derived::form::{Form, Height};

/// Objects and walls lower than this cannot be stretched, metres.
const LEAST_M: f64 = 1e-3;

pub(super) fn change(source: &Source, unit: &Unit, form: &Form) -> Change {
    let (base, top) = (unit.bounds.min.z, unit.bounds.max.z);
    let now = top - base;
    let wanted = match form {
        Form::Height(Height::Metres(metres)) => *metres,
        Form::Height(Height::Factor(factor)) => now * factor,
        _ => now,
    };
    if now < LEAST_M {
        return Change::None;
    }
    let roofs = source.faces_of(unit).filter(|face| source.part(face) == Part::Roof);
    let eaves = roofs.flat_map(|face| face.corners).map(|corner| corner.z).fold(top, f64::min);
    let (walls, roof) = (eaves - base, top - eaves);
    if walls < LEAST_M || wanted <= roof {
        return Change::Steps(Steps { base, knee: top, below: wanted / now, above: 1.0 });
    }
    Change::Steps(Steps { base, knee: eaves, below: (wanted - roof) / walls, above: 1.0 })
}
