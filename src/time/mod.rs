//! Time: moments, spans between them, intervals as registers hold them, and their calendar.
//!
//! A [`Moment`] is a whole number of microseconds (i64) since the start of 1970 in the proleptic Gregorian calendar: the calendar of today
//! goes on backwards, the year 0 is 1 BCE, days have 86,400 seconds. Nothing of time is ever a floating-point number. Moments have no time
//! zone: they are read as the city's own clock shows them; what says how far it is from UTC is brought to UTC.

mod interval;
mod label;
mod moment;
mod read;
mod span;
mod unit;

pub use interval::{Granularity, Interval};
pub use moment::Moment;
pub use span::Span;
pub use unit::Unit;

/// Microseconds of a second.
pub const SECOND: i64 = 1_000_000;
/// Microseconds of a minute.
pub const MINUTE: i64 = 60 * SECOND;
/// Microseconds of an hour.
pub const HOUR: i64 = 60 * MINUTE;
/// Microseconds of a day.
pub const DAY: i64 = 24 * HOUR;
