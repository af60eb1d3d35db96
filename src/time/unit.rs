//! Units that moments are rounded to.

use std::fmt;

use crate::time::{DAY, HOUR, Span};

/// A unit of the calendar: how long, and where it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// So many months, > 0, counted from the start of the year 0.
    Months(i32),
    /// So many microseconds, > 0, at most 65,535 times what they have in common with an hour; whole weeks are counted from Mondays, all else
    /// from the start of 1970.
    Micros(i64),
}

/// 1970-01-05, a Monday.
const MONDAY: i64 = 4 * DAY;

impl Unit {
    /// The unit as long as a span.
    ///
    /// # Errors
    /// It is 0 or less, of months and days together, or has too little in common with an hour: what would be right.
    pub fn of(span: Span) -> Result<Self, String> {
        match (span.months(), span.micros()) {
            (months, 0) if months > 0 => Ok(Self::Months(months)),
            (0, micros) if micros > 0 && micros / common(micros) > MOST_COUNT => Err(format!(
                "\"{span}\" is no unit: what it has in common with an hour goes into it {} times, at most {MOST_COUNT} would be right",
                micros / common(micros)
            )),
            (0, micros) if micros > 0 => Ok(Self::Micros(micros)),
            _ => Err(format!(
                "\"{span}\" is no unit; \"year\", \"10 years\", \"month\", \"day\" or \"15 min\" would be right"
            )),
        }
    }

    /// The span that it is as long as.
    pub fn span(self) -> Span {
        match self {
            Self::Months(months) => Span::of_months(months),
            Self::Micros(micros) => Span::of_micros(micros),
        }
    }

    /// Where its first begins, microseconds after the start of 1970.
    pub(super) fn origin(self) -> i64 {
        match self {
            Self::Micros(micros) if micros % (7 * DAY) == 0 => MONDAY,
            _ => 0,
        }
    }

    /// As shaders have it: months; or none, and so many times the microseconds that it has in common with an hour.
    pub fn words(self) -> [u32; 3] {
        match self {
            Self::Months(months) => [months.cast_unsigned(), 0, 0],
            Self::Micros(micros) => [0, (micros / common(micros)) as u32, common(micros) as u32],
        }
    }
}

/// How often what a unit has in common with an hour goes into it, at most: shaders multiply in 32 bits.
const MOST_COUNT: i64 = 65_535;

/// The longest span that goes into an hour and into so many microseconds, > 0, without rest.
fn common(micros: i64) -> i64 {
    let (mut a, mut b) = (micros, HOUR);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.span().fmt(f)
    }
}
