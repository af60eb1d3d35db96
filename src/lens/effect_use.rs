//! Uses of effects, with their parameters.

use std::collections::BTreeMap;

use crate::{lens::class::Class, shader::Blend};

/// One use of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectUse {
    /// Its name in the table of effects ([`crate::lens::effect`]).
    pub effect: String,
    /// What it acts on, seen along the pixel's ray.
    pub class: Class,
    /// How it is laid over what is below; `None`: it replaces that.
    pub blend: Option<Blend>,
    /// How much of it, 0 to 1; `None`: all.
    pub weight: Option<f64>,
    /// Its parameters; the table has the defaults.
    pub parameters: BTreeMap<String, Parameter>,
}

/// An effect parameter's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Parameter {
    /// Yes or no.
    Boolean(bool),
    /// A number, in the unit the effect states.
    Number(f64),
    /// A word, a colour ramp, an attribute name.
    Text(String),
    /// Numbers: class breaks, a colour.
    Numbers(Vec<f64>),
    /// Words: categories.
    Texts(Vec<String>),
}
