//! Moments, and their calendar.

use jiff::{SignedDuration, civil};

use crate::time::{DAY, HOUR, SECOND, Span, Unit};

/// A moment: microseconds since 1970-01-01T00:00:00, from the start of the year −9999 to the end of the year 9999.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Moment(i64);

const ORIGIN: civil::DateTime = civil::datetime(1970, 1, 1, 0, 0, 0, 0);
/// Days from 1970-01-01 to −9999-01-01, and to 9999-12-31.
const FIRST_DAY: i64 = -4_371_587;
const LAST_DAY: i64 = 2_932_896;

impl Moment {
    /// The first: the start of the year −9999.
    pub const FIRST: Self = Self(FIRST_DAY * DAY);
    /// The last: a microsecond before the year 10000.
    pub const LAST: Self = Self(LAST_DAY * DAY + DAY - 1);

    /// The moment so many microseconds after the start of 1970; `None` outside the years −9999 to 9999.
    pub fn from_micros(micros: i64) -> Option<Self> {
        (Self::FIRST.0..=Self::LAST.0).contains(&micros).then_some(Self(micros))
    }

    /// The start of a year; `None` outside −9999 to 9999.
    pub fn of_year(year: i64) -> Option<Self> {
        Self::of_date(year, 1, 1)
    }

    /// The start of a day; `None` where the calendar has none like it.
    pub fn of_date(year: i64, month: i8, day: i8) -> Option<Self> {
        let date = civil::Date::new(i16::try_from(year).ok()?, month, day).ok()?;
        Some(Self::of_civil(date.to_datetime(civil::Time::midnight())))
    }

    /// Microseconds since the start of 1970.
    pub fn micros(self) -> i64 {
        self.0
    }

    /// No moment at all, as shaders have it.
    pub const TIMELESS: [u32; 2] = [(-i32::MAX).cast_unsigned(), 0];

    /// As shaders have it: whole hours since the start of 1970, and microseconds of that hour.
    pub fn words(self) -> [u32; 2] {
        [(self.0.div_euclid(HOUR) as i32).cast_unsigned(), self.0.rem_euclid(HOUR) as u32]
    }

    /// Of what [`Self::words`] gives; `None` outside the calendar.
    pub fn of_words([hour, micro]: [u32; 2]) -> Option<Self> {
        Self::from_micros(i64::from(hour.cast_signed()) * HOUR + i64::from(micro))
    }

    /// Its year, month and day.
    pub fn date(self) -> (i16, i8, i8) {
        let date = self.civil().date();
        (date.year(), date.month(), date.day())
    }

    /// Microseconds since its day began.
    pub fn time_of_day(self) -> i64 {
        self.0.rem_euclid(DAY)
    }

    /// So much later: first by the months of the span, where a day that the month does not have becomes its last, then by the rest. What
    /// leaves the calendar stays at its first or last moment.
    #[must_use]
    pub fn shifted(self, by: Span) -> Self {
        let moved = match by.months() {
            0 => self,
            months => self.after_months(months),
        };
        Self::within(moved.0.saturating_add(by.micros()))
    }

    fn after_months(self, months: i32) -> Self {
        match self.civil().checked_add(jiff::Span::new().months(months)) {
            Ok(moved) => Self::of_civil(moved),
            Err(_) if months < 0 => Self::FIRST,
            Err(_) => Self::LAST,
        }
    }

    /// The last full unit that is not after it. Months count from the start of the year 0, weeks from Mondays, all else from the start of
    /// 1970, which for what divides a day is midnight.
    #[must_use]
    pub fn floored(self, unit: Unit) -> Self {
        match unit {
            Unit::Months(months) => {
                let count = self.months();
                Self::of_month(count - count.rem_euclid(months.into()))
            }
            Unit::Micros(micros) => {
                let since = self.0 - unit.origin();
                Self::within(self.0 - since.rem_euclid(micros))
            }
        }
    }

    /// The first full unit that is not before it: one that is full stays.
    #[must_use]
    pub fn ceiled(self, unit: Unit) -> Self {
        match unit {
            Unit::Months(_) if self.floored(unit) == self => self,
            Unit::Months(months) => {
                let (count, months) = (self.months(), i64::from(months));
                Self::of_month(count - count.rem_euclid(months) + months)
            }
            Unit::Micros(micros) => match (self.0 - unit.origin()).rem_euclid(micros) {
                0 => self,
                since => Self::within(self.0.saturating_add(micros - since)),
            },
        }
    }

    /// The same day at so many microseconds after midnight.
    #[must_use]
    pub fn at_time_of_day(self, micros: i64) -> Self {
        Self::within(self.0 - self.time_of_day() + micros)
    }

    /// Its month, counted from the start of the year 0.
    fn months(self) -> i64 {
        let (year, month, _) = self.date();
        i64::from(year) * 12 + i64::from(month) - 1
    }

    /// The first moment of a month, counted from the start of the year 0.
    fn of_month(count: i64) -> Self {
        let year = count.div_euclid(12);
        let month = (count.rem_euclid(12) + 1) as i8;
        Self::of_date(year, month, 1).unwrap_or(if count < 0 { Self::FIRST } else { Self::LAST })
    }

    fn within(micros: i64) -> Self {
        Self(micros.clamp(Self::FIRST.0, Self::LAST.0))
    }

    pub(super) fn of_civil(at: civil::DateTime) -> Self {
        let since = at.duration_since(ORIGIN);
        Self(since.as_secs() * SECOND + i64::from(since.subsec_micros()))
    }

    pub(super) fn civil(self) -> civil::DateTime {
        let since = SignedDuration::from_micros(self.0);
        ORIGIN.checked_add(since).expect("moments are in the calendar")
    }
}

impl std::ops::Sub for Moment {
    type Output = i64;

    /// Microseconds between them.
    fn sub(self, other: Self) -> i64 {
        self.0 - other.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_calendar_has_these_ends() {
        assert_eq!(Moment::of_date(-9999, 1, 1), Some(Moment::FIRST));
        assert_eq!(Moment::of_date(9999, 12, 31).map(|m| m.micros() + DAY - 1), Some(Moment::LAST.micros()));
        assert_eq!(Moment::of_year(10_000), None);
        assert_eq!(Moment::of_date(1900, 2, 29), None, "no leap year");
        assert_eq!(Moment::of_date(0, 2, 29).map(Moment::date), Some((0, 2, 29)), "a leap year");
        assert_eq!(Moment::from_micros(Moment::LAST.micros() + 1), None);
        for moment in [Moment::FIRST, Moment::LAST] {
            assert_eq!(Moment::of_words(moment.words()), Some(moment));
        }
        let year = Unit::Months(12);
        assert_eq!(Moment::LAST.ceiled(year), Moment::LAST, "there is no later year");
        assert_eq!(Moment::FIRST.shifted(Span::of_months(-1)), Moment::FIRST);
        assert_eq!(Moment::LAST.shifted(Span::of_micros(i64::MAX)), Moment::LAST);
    }
}
