//! Values: those that objects have, those that expressions name, and how they stand to each other.

use std::{borrow::Cow, cmp::Ordering};

use crate::{
    query::Relation,
    time::{Interval, Moment},
};

/// What an object has.
#[derive(Clone, Debug, PartialEq)]
pub enum Given<'a> {
    /// A number.
    Number(f64),
    /// A text.
    Text(Cow<'a, str>),
    /// True or false.
    Truth(bool),
}

/// What an expression names.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// A date finer than a year, as it is written, and what it means.
    Date(String, Interval),
}

/// The year of a day.
fn year_of(date: &Interval) -> Option<f64> {
    date.begin.map(|begin| begin.date().0 as f64)
}

/// The order of a year, a whole number, to a date that is asked for.
fn order_of_year(year: f64, wanted: &Interval) -> Option<Ordering> {
    let whole = (year.fract() == 0.0 && year.abs() < 1e6).then_some(year as i64)?;
    order_of_dates(Moment::of_year(whole)?, wanted)
}

/// The order of what begins at a moment to a date that is asked for: equal within it.
fn order_of_dates(begin: Moment, wanted: &Interval) -> Option<Ordering> {
    if wanted.begin.is_some_and(|first| begin < first) {
        return Some(Ordering::Less);
    }
    let is_after = wanted.end.is_some_and(|end| begin >= end);
    Some(if is_after { Ordering::Greater } else { Ordering::Equal })
}

impl Given<'_> {
    /// Whether it stands so to what is named.
    pub fn stands(&self, relation: Relation, literal: &Literal) -> bool {
        if relation == Relation::Contains {
            return self.written().to_lowercase().contains(&literal.written().to_lowercase());
        }
        self.order(literal).is_some_and(|order| match relation {
            Relation::Equal => order.is_eq(),
            Relation::Other => order.is_ne(),
            Relation::Less => order.is_lt(),
            Relation::AtMost => order.is_le(),
            Relation::More => order.is_gt(),
            Relation::AtLeast | Relation::Contains => order.is_ge(),
        })
    }

    /// Its order to what is named; `None`: it stands in none.
    pub fn order(&self, literal: &Literal) -> Option<Ordering> {
        match (self, literal) {
            (Self::Number(own), Literal::Number(wanted)) => own.partial_cmp(wanted),
            (Self::Text(own), Literal::Number(wanted)) => match own.trim().parse::<f64>() {
                Ok(own) => own.partial_cmp(wanted),
                Err(_) => year_of(&Interval::parse(own).ok()?)?.partial_cmp(wanted),
            },
            (Self::Text(own), Literal::Date(_, wanted)) => match Interval::parse(own) {
                Ok(own) => order_of_dates(own.begin?, wanted),
                Err(_) => order_of_year(own.trim().parse().ok()?, wanted),
            },
            (Self::Number(own), Literal::Date(_, wanted)) => order_of_year(*own, wanted),
            (Self::Number(own), Literal::Text(wanted)) => own.partial_cmp(&wanted.trim().parse::<f64>().ok()?),
            (Self::Text(_) | Self::Truth(_), Literal::Text(wanted)) => {
                Some(self.written().to_lowercase().cmp(&wanted.to_lowercase()))
            }
            (Self::Truth(_), _) => None,
        }
    }

    /// As people read it.
    pub fn written(&self) -> Cow<'_, str> {
        match self {
            Self::Number(number) => Cow::Owned(number.to_string()),
            Self::Text(text) => Cow::Borrowed(text),
            Self::Truth(truth) => Cow::Borrowed(if *truth { "true" } else { "false" }),
        }
    }
}

impl Literal {
    fn written(&self) -> Cow<'_, str> {
        match self {
            Self::Number(number) => Cow::Owned(number.to_string()),
            Self::Text(text) | Self::Date(text, _) => Cow::Borrowed(text),
        }
    }
}

/// As it is written: reading that gives the same.
impl std::fmt::Display for Literal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"")),
            Self::Date(text, _) => f.write_str(text),
        }
    }
}
