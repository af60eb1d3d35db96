//! Spans of time: calendar months and what is exact.

use std::fmt;

use crate::time::{DAY, HOUR, MINUTE, SECOND};

/// How long: whole months, whose length the calendar knows, and microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    months: i32,
    micros: i64,
}

/// Words of units, with the months or the microseconds of one.
const WORDS: [(&[&str], i64, i64); 9] = [
    (&["century", "centuries"], 1200, 0),
    (&["decade", "decades"], 120, 0),
    (&["year", "years", "y", "a"], 12, 0),
    (&["month", "months"], 1, 0),
    (&["week", "weeks", "w"], 0, 7 * DAY),
    (&["day", "days", "d"], 0, DAY),
    (&["hour", "hours", "h"], 0, HOUR),
    (&["minute", "minutes", "min"], 0, MINUTE),
    (&["second", "seconds", "s"], 0, SECOND),
];
/// Shorter ones.
const SMALL: [(&[&str], i64, i64); 2] =
    [(&["millisecond", "milliseconds", "ms"], 0, 1000), (&["microsecond", "microseconds", "us", "µs", "μs"], 0, 1)];

/// The longest: what lies between the ends of the calendar, and a day.
const MOST_MONTHS: i64 = 12 * 20_000;
const MOST_MICROS: i64 = 20_000 * 366 * DAY;

impl Span {
    /// No time at all.
    pub const NONE: Self = Self { months: 0, micros: 0 };

    /// Months, then microseconds.
    pub const fn new(months: i32, micros: i64) -> Self {
        Self { months, micros }
    }

    /// Months alone.
    pub fn of_months(months: i32) -> Self {
        Self { months, micros: 0 }
    }

    /// Microseconds alone.
    pub fn of_micros(micros: i64) -> Self {
        Self { months: 0, micros }
    }

    /// Reads a time of day, `14:30` or `14:30:05.5`, as the span since midnight.
    ///
    /// # Errors
    /// It is none, or not less than 24 hours: what would be right.
    pub fn of_clock(text: &str) -> Result<Self, String> {
        let micros = super::read::time_of_day(text.trim());
        micros.map(Self::of_micros).ok_or_else(|| format!("\"{text}\" is no time of day; \"14:30\" would be right"))
    }

    /// Its months.
    pub fn months(self) -> i32 {
        self.months
    }

    /// Microseconds beside its months.
    pub fn micros(self) -> i64 {
        self.micros
    }

    /// How long it is on the mean of the calendar's 400 years, microseconds: a year is 365.2425 days, a month a twelfth of that.
    pub fn mean_micros(self) -> i64 {
        const MONTH: i64 = 2_629_746 * SECOND;
        i64::from(self.months) * MONTH + self.micros
    }

    /// Whether it is none at all.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    /// Whether it goes back, a month counting as a twelfth of the mean year.
    pub fn is_back(self) -> bool {
        self.mean_micros() < 0
    }

    /// As long, the other way.
    #[must_use]
    pub fn back(self) -> Self {
        Self { months: -self.months, micros: -self.micros }
    }

    /// As shaders have it: months, whole hours and microseconds of an hour (0 to 3,599,999,999).
    pub fn words(self) -> [u32; 3] {
        let hours = self.micros.div_euclid(HOUR) as i32;
        [self.months.cast_unsigned(), hours.cast_unsigned(), self.micros.rem_euclid(HOUR) as u32]
    }

    /// Reads one: `10 years`, `-1 month`, `1 h 30 min`, or ISO 8601 (`P10Y`, `-P1M`, `PT1H30M`).
    ///
    /// # Errors
    /// It is none, or longer than 20,000 years: what would be right.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "\"{text}\" is no span of time; \"10 years\", \"-6 months\", \"1 h 30 min\" or \"P10Y\" would be right"
            )
        };
        let trimmed = text.trim();
        let (sign, rest) = match trimmed.strip_prefix(['-', '−']) {
            Some(rest) => (-1, rest.trim_start()),
            None => (1, trimmed.strip_prefix('+').unwrap_or(trimmed).trim_start()),
        };
        let parts = match rest.strip_prefix(['P', 'p']) {
            Some(iso) => iso_parts(iso),
            None => word_parts(rest),
        };
        let (mut months, mut micros) = (0_i64, 0_i64);
        for (amount, unit_months, unit_micros) in parts.ok_or_else(wrong)? {
            let (whole, part) = amount;
            months = whole.checked_mul(unit_months).and_then(|m| months.checked_add(m)).ok_or_else(wrong)?;
            micros = whole.checked_mul(unit_micros).and_then(|m| micros.checked_add(m)).ok_or_else(wrong)?;
            micros += part_of(part, unit_micros).ok_or_else(wrong)?;
        }
        if months > MOST_MONTHS || micros > MOST_MICROS {
            return Err(format!("\"{text}\" is longer than the calendar; at most 20,000 years would be right"));
        }
        Ok(Self { months: (sign * months) as i32, micros: sign * micros })
    }
}

/// A number as it is written, without a sign: its whole part, and the digits behind the point.
type Amount<'a> = (i64, &'a str);

fn amount(text: &str) -> Option<Amount<'_>> {
    let (whole, part) = text.split_once(['.', ',']).unwrap_or((text, ""));
    let is_digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
    (!whole.is_empty() && is_digits(whole) && is_digits(part)).then(|| Some((whole.parse().ok()?, part)))?
}

/// What the digits behind a point are of a unit; `None`: no whole number of microseconds.
fn part_of(digits: &str, micros: i64) -> Option<i64> {
    let mut all = 0_i128;
    let mut scale = 1_i128;
    for digit in digits.bytes().take(18) {
        all = 10 * all + i128::from(digit - b'0');
        scale *= 10;
    }
    let part = all * i128::from(micros);
    (part % scale == 0 && digits.len() <= 18 && (micros > 0 || all == 0)).then_some((part / scale) as i64)
}

fn word_parts(text: &str) -> Option<Vec<(Amount<'_>, i64, i64)>> {
    let mut parts = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.' && c != ',').unwrap_or(rest.len());
        // A unit alone is one of it.
        let number = if end == 0 { (1, "") } else { amount(&rest[..end])? };
        rest = rest[end..].trim_start();
        let end = rest.find(|c: char| c.is_ascii_digit() || c.is_whitespace()).unwrap_or(rest.len());
        let word = rest[..end].to_lowercase();
        let mut units = WORDS.iter().chain(&SMALL);
        let (_, months, micros) = units.find(|(words, ..)| words.contains(&word.as_str()))?;
        parts.push((number, *months, *micros));
        rest = rest[end..].trim_start();
    }
    (!parts.is_empty()).then_some(parts)
}

fn iso_parts(text: &str) -> Option<Vec<(Amount<'_>, i64, i64)>> {
    let mut parts = Vec::new();
    let mut rest = text;
    let mut is_time = false;
    while !rest.is_empty() {
        if let Some(time) = rest.strip_prefix(['T', 't'])
            && !is_time
        {
            (rest, is_time) = (time, true);
            continue;
        }
        let end = rest.find(|c: char| c.is_ascii_alphabetic())?;
        let number = amount(&rest[..end])?;
        let (months, micros) = match (rest.as_bytes()[end].to_ascii_uppercase(), is_time) {
            (b'Y', false) => (12, 0),
            (b'M', false) => (1, 0),
            (b'W', false) => (0, 7 * DAY),
            (b'D', false) => (0, DAY),
            (b'H', true) => (0, HOUR),
            (b'M', true) => (0, MINUTE),
            (b'S', true) => (0, SECOND),
            _ => return None,
        };
        parts.push((number, months, micros));
        rest = &rest[end + 1..];
    }
    (!parts.is_empty()).then_some(parts)
}

impl fmt::Display for Span {
    /// As [`Span::parse`] reads it, where both parts have one sign: the largest units that make it up.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_mixed = self.months != 0 && self.micros != 0 && (self.months < 0) != (self.micros < 0);
        if is_mixed {
            return write!(f, "{} and {}", Self::of_months(self.months), Self::of_micros(self.micros));
        }
        let mut months = i64::from(self.months).abs();
        let mut micros = self.micros.abs();
        let mut words = Vec::new();
        let plural = |n: i64, unit: &str| format!("{n} {unit}{}", if n == 1 { "" } else { "s" });
        for (length, unit) in [(12, "year"), (1, "month")] {
            if months >= length {
                words.push(plural(months / length, unit));
                months %= length;
            }
        }
        for (length, unit) in [(DAY, "day"), (HOUR, "h"), (MINUTE, "min"), (SECOND, "s"), (1000, "ms"), (1, "µs")] {
            if micros >= length {
                let n = micros / length;
                words.push(if unit == "day" { plural(n, unit) } else { format!("{n} {unit}") });
                micros %= length;
            }
        }
        let sign = if self.months < 0 || self.micros < 0 { "-" } else { "" };
        match words.is_empty() {
            true => f.write_str("0 s"),
            false => write!(f, "{sign}{}", words.join(" ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_read_and_written() {
        for (text, months, micros) in [
            ("10 years", 120, 0),
            ("-6 months", -6, 0),
            ("P10Y", 120, 0),
            ("-P1Y2M3DT4H5M6.5S", -14, -(3 * DAY + 4 * HOUR + 5 * MINUTE + 6_500_000)),
            ("1 h 30 min", 0, HOUR + 30 * MINUTE),
            ("1.5h", 0, HOUR + 30 * MINUTE),
            ("PT0.000001S", 0, 1),
            ("25 µs", 0, 25),
            ("week", 0, 7 * DAY),
            ("+2 decades", 240, 0),
            ("0 s", 0, 0),
        ] {
            let span = Span::parse(text).unwrap_or_else(|wrong| panic!("{wrong}"));
            assert_eq!((span.months, span.micros), (months, micros), "{text}");
            assert_eq!(Span::parse(&span.to_string()), Ok(span), "{text}: {span}");
            let [own, hours, rest] = span.words();
            assert_eq!(own.cast_signed(), months);
            assert_eq!(i64::from(hours.cast_signed()) * HOUR + i64::from(rest), micros);
        }
        for text in [
            "",
            "10",
            "ten years",
            "1.5 months",
            "P",
            "PT",
            "P1H",
            "1 year -2 days",
            "99999999999999999999 s",
            "21000 years",
            "0.3333333 s",
        ] {
            assert!(Span::parse(text).is_err(), "{text}");
        }
    }
}
