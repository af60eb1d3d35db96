//! Units that moments are rounded to.

use std::fmt;

use crate::time::{DAY, Span};

/// A unit of the calendar: how long, and where it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// So many months, > 0, counted from the start of the year 0.
    Months(i32),
    /// So many microseconds, > 0; whole weeks are counted from Mondays, all else from the start of 1970.
    Micros(i64),
}

/// 1970-01-05, a Monday.
const MONDAY: i64 = 4 * DAY;

impl Unit {
    /// The unit as long as a span.
    ///
    /// # Errors
    /// It is 0 or less, or of months and days together: what would be right.
    pub fn of(span: Span) -> Result<Self, String> {
        match (span.months(), span.micros()) {
            (months, 0) if months > 0 => Ok(Self::Months(months)),
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

    /// As shaders have it: months; or none, whole hours and microseconds of an hour.
    pub fn words(self) -> [u32; 3] {
        self.span().words()
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.span().fmt(f)
    }
}
