//! The effects: what lenses and the context can do to what they show.
//!
//! An effect is one file in `shaders/effect` and one row in [`registry`]; [`super::effect_file`] says what stands in it.

pub(super) mod definition;
pub(super) mod parameter;
pub(super) mod prototype;
pub(super) mod registry;
pub(super) mod user;

pub use definition::{Amount, COMING_LINES, EffectDefinition, PerObject};
pub use parameter::{DefaultValue, Fallback, MAX_INSTANTS, MAX_LIST, MAX_RAMP, ParameterDefinition, ParameterKind};
pub use prototype::{AskedBy, EffectKind, Mode, PROTOTYPES, Prototype, Stage};
pub use registry::{
    MOST_HANDLERS, asked_for, effects, find, find_asked_by, handlers, named, number_asked_by, number_of,
};
pub use user::{add, replace};
