//! Intervals as registers hold them.

use crate::time::{Moment, SECOND};

/// How finely a moment is said, coarse to fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Granularity {
    /// Year, or several.
    Year,
    /// Month.
    Month,
    /// Day.
    Day,
    /// Minute of a day.
    Minute,
    /// Second.
    Second,
    /// Parts of it: microseconds.
    Micro,
}

impl Granularity {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Year => "year",
            Self::Month => "month",
            Self::Day => "day",
            Self::Minute => "minute",
            Self::Second => "second",
            Self::Micro => "microsecond",
        }
    }

    /// The coarsest that says a moment exactly.
    pub fn of(moment: Moment) -> Self {
        let (_, month, day) = moment.date();
        match moment.time_of_day() {
            0 if month == 1 && day == 1 => Self::Year,
            0 if day == 1 => Self::Month,
            0 => Self::Day,
            time if time % (60 * SECOND) == 0 => Self::Minute,
            time if time % SECOND == 0 => Self::Second,
            _ => Self::Micro,
        }
    }
}

/// What a register says of a time: a year, a month, a day, an instant, or a stretch of them, from its first moment up to its last (not
/// included); `None`: open at that end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Its first moment.
    pub begin: Option<Moment>,
    /// The first moment after it.
    pub end: Option<Moment>,
    /// How finely it is said.
    pub granularity: Granularity,
    /// Whether it is said to be uncertain or approximate.
    pub uncertain: bool,
}
