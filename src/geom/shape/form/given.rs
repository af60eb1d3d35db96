//! Forms that are given by a few fields, with the names, units and texts of these in scene files.

use glam::{DQuat, DVec3};

use crate::geom::shape::error::ShapeError;

/// Quantities that fields may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A place, metres.
    Place,
    /// A length, metres, ≥ 0.
    Length,
    /// Lengths along three axes, metres, ≥ 0.
    Lengths,
    /// A direction, of any length but 0.
    Direction,
    /// Turns own axes into the world's.
    Turn,
}

/// The value of a field, where it stands.
#[derive(Debug)]
pub enum Value<'a> {
    /// A [`Quantity::Length`].
    Number(&'a mut f64),
    /// A [`Quantity::Place`], [`Quantity::Lengths`] or [`Quantity::Direction`].
    Vector(&'a mut DVec3),
    /// A [`Quantity::Turn`].
    Turn(&'a mut DQuat),
}

/// A field of a form.
#[derive(Clone, Copy, Debug)]
pub struct Field<T: 'static> {
    /// Its key in scene files.
    pub name: &'static str,
    /// Its quantity.
    pub quantity: Quantity,
    /// Its default as TOML; empty: it must be given.
    pub default: &'static str,
    /// Its meaning.
    pub doc: &'static str,
    /// A good value, as TOML.
    pub example: &'static str,
    /// Where it stands.
    pub at: fn(&mut T) -> Value<'_>,
}

/// A form that is given by fields.
pub trait Given: Clone + 'static {
    /// Its name in scene files.
    const NAME: &'static str;
    /// The same in quotation marks.
    const QUOTED: &'static str;
    /// One sentence about it.
    const DOC: &'static str;
    /// Its value where no field is given.
    const DEFAULT: Self;
    /// Its fields, at most [`MOST_FIELDS`].
    const FIELDS: &'static [Field<Self>];
}

/// Fields of a form, at most.
pub const MOST_FIELDS: usize = 7;

/// The names and the text of a [`Given`].
macro_rules! named {
    ($name:literal, $doc:literal) => {
        const NAME: &'static str = $name;
        const QUOTED: &'static str = concat!("\"", $name, "\"");
        const DOC: &'static str = $doc;
    };
}
pub(super) use named;

/// Refuses numbers that are none and negative lengths, and makes directions and turns unit.
pub(super) fn check<T: Given>(own: &mut T) -> Result<(), ShapeError> {
    let is_finite = |value: Value| match value {
        Value::Number(number) => number.is_finite(),
        Value::Vector(vector) => vector.is_finite(),
        Value::Turn(turn) => turn.is_finite() && turn.length() > 0.0,
    };
    if !T::FIELDS.iter().all(|field| is_finite((field.at)(own))) {
        return Err(ShapeError::NotFinite);
    }
    for field in T::FIELDS {
        let least = match (field.at)(own) {
            Value::Number(number) => *number,
            Value::Vector(vector) if field.quantity == Quantity::Lengths => vector.min_element(),
            Value::Vector(_) | Value::Turn(_) => 0.0,
        };
        if least < 0.0 {
            return Err(ShapeError::Negative(field.name, least));
        }
    }
    for field in T::FIELDS {
        match (field.at)(own) {
            Value::Vector(way) if field.quantity == Quantity::Direction => {
                *way = way.try_normalize().ok_or(ShapeError::NoAxis)?;
            }
            Value::Turn(turn) => *turn = turn.normalize(),
            Value::Number(_) | Value::Vector(_) => {}
        }
    }
    Ok(())
}

impl<T> Field<T> {
    /// `center`: the middle.
    pub(super) const fn center(at: fn(&mut T) -> Value<'_>) -> Self {
        let (doc, example) = ("The middle of the body.", "[78600.0, 457950.0, 10.0]");
        Self { name: "center", quantity: Quantity::Place, default: "", doc, example, at }
    }

    /// `radius`.
    pub(super) const fn radius(at: fn(&mut T) -> Value<'_>) -> Self {
        let doc = "Radius; 0 holds nothing.";
        Self { name: "radius", quantity: Quantity::Length, default: "", doc, example: "60.0", at }
    }

    /// `rotation_deg`.
    pub(super) const fn rotation(at: fn(&mut T) -> Value<'_>) -> Self {
        let doc = "`[yaw, pitch, roll]`: yaw turns it counter-clockwise seen from above (0: its x is east), pitch then lifts its x end, roll then turns it about its own x.";
        let example = "[30.0, 0.0, 0.0]";
        Self { name: "rotation_deg", quantity: Quantity::Turn, default: "[0, 0, 0]", doc, example, at }
    }
}
