//! Reading what registers say of times.

use jiff::civil;

use crate::time::{DAY, Granularity, HOUR, Interval, MINUTE, Moment, SECOND, Span};

/// What would be right.
const RIGHT: &str =
    "a year, a date or a date-time as in \"1890\", \"1890-05-03\" or \"1890-05-03T14:00\" would be right";

/// Whole numbers beyond this are seconds, milliseconds or microseconds since 1970.
const SECONDS: i64 = 100_000_000_000;
const MILLISECONDS: i64 = 100_000_000_000_000;

impl Interval {
    /// Reads ISO 8601 (`1890`, `1890-05`, `1890-05-03`, `18900503`, `1890-05-03T14:00:00.5+01:00`, a space for the `T`), what the Extended
    /// Date/Time Format adds (ISO 8601-2: `1890?`, `~`, `%`, `189X`, `Y-9000`, `1890-21` for a season and `1890-33` for a quarter,
    /// `1890/1895`, `../1890`, `1890/..`), and what people write (`1890s`, `c. 1890`, `1890-1895`, `44 BCE`, `3.5.1890`).
    ///
    /// # Errors
    /// It is none of these: what would be right.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("\"{text}\" is no time; {RIGHT}");
        if let Some((from, until)) = text.split_once('/') {
            let (begin, end) = (side(from, text)?, side(until, text)?);
            return Self::between(begin, end).ok_or_else(|| format!("\"{text}\" ends before it begins; {RIGHT}"));
        }
        let (text_alone, is_about) = without_about(text.trim());
        let stem = text_alone.trim_end_matches(['?', '~', '%']);
        let uncertain = is_about || stem.len() < text_alone.len();
        let read = date_time(stem).or_else(|| range_of_years(stem)).or_else(|| year(stem)).ok_or_else(wrong)?;
        Ok(Self { uncertain: read.uncertain || uncertain, ..read })
    }

    /// Reads a whole number: a year (−9999 to 9999), a date as 18900503, or UNIX time in seconds, from 10¹¹ in milliseconds and from 10¹⁴ in
    /// microseconds.
    ///
    /// # Errors
    /// It is outside the calendar: what would be right.
    pub fn of_number(number: i64) -> Result<Self, String> {
        let of_unix = |unit: i64, granularity| {
            let begin = number.checked_mul(unit).and_then(Moment::from_micros)?;
            Some(Self::from(begin, Span::of_micros(unit), granularity))
        };
        let read = match number.unsigned_abs() as i64 {
            0..=9999 => of_year(number),
            size if size < SECONDS => compact(&number.to_string()).or_else(|| of_unix(SECOND, Granularity::Second)),
            size if size < MILLISECONDS => of_unix(1000, Granularity::Micro),
            _ => of_unix(1, Granularity::Micro),
        };
        read.ok_or_else(|| format!("{number} is no time; {RIGHT}"))
    }

    /// From a moment on, so long.
    fn from(begin: Moment, long: Span, granularity: Granularity) -> Self {
        let end = begin.shifted(long);
        Self { begin: Some(begin), end: Some(end), granularity, uncertain: false }
    }

    /// From the beginning of one to the end of another; `None`: nothing is between them.
    fn between(first: Option<Self>, last: Option<Self>) -> Option<Self> {
        let (begin, end) = (first.and_then(|i| i.begin), last.and_then(|i| i.end));
        let both = [first, last].into_iter().flatten();
        let granularity = both.clone().map(|i| i.granularity).max().unwrap_or(Granularity::Year);
        let uncertain = both.clone().any(|i| i.uncertain);
        let is_ordered = begin.zip(end).is_none_or(|(begin, end)| begin < end);
        is_ordered.then_some(Self { begin, end, granularity, uncertain })
    }
}

/// One end of an interval; open or unknown: `None`.
fn side(text: &str, whole: &str) -> Result<Option<Interval>, String> {
    match text.trim() {
        "" | ".." => Ok(None),
        side => Interval::parse(side).map(Some).map_err(|_| format!("\"{whole}\" is no time; {RIGHT}")),
    }
}

/// Without a word that says *about*, and whether there was one.
fn without_about(text: &str) -> (&str, bool) {
    for word in ["circa", "about", "ca.", "ca", "c.", "c", "~"] {
        if let Some(rest) =
            text.get(..word.len()).filter(|head| head.eq_ignore_ascii_case(word)).map(|_| &text[word.len()..])
            && rest.trim_start().starts_with(|c: char| c.is_ascii_digit())
        {
            return (rest.trim_start(), true);
        }
    }
    (text, false)
}

fn of_year(year: i64) -> Option<Interval> {
    Some(Interval::from(Moment::of_year(year)?, Span::of_months(12), Granularity::Year))
}

/// A year alone, in one of the ways of writing it; some digits may be unknown.
fn year(text: &str) -> Option<Interval> {
    let upper = text.to_ascii_uppercase();
    for (word, sign) in [("BCE", -1), ("BC", -1), ("CE", 1), ("AD", 1)] {
        if let Some(number) = upper.strip_suffix(word) {
            let number: i64 = number.trim().parse().ok().filter(|n| *n > 0)?;
            return of_year(if sign < 0 { 1 - number } else { number });
        }
    }
    if let Some(decade) = text.strip_suffix('s') {
        let from: i64 = decade.parse().ok().filter(|n| n % 10 == 0 && decade.len() == 4)?;
        return Some(Interval::from(Moment::of_year(from)?, Span::of_months(120), Granularity::Year));
    }
    let long = upper.strip_prefix('Y');
    let (sign, digits) = match long.unwrap_or(&upper) {
        rest if rest.starts_with('-') => (-1, &rest[1..]),
        rest => (1, rest.strip_prefix('+').unwrap_or(rest)),
    };
    let known = digits.trim_end_matches(['X', 'U']);
    let unknown = (digits.len() - known.len()) as u32;
    // Fewer than four are the day or the month of something else.
    if digits.len() > 4
        || (digits.len() < 4 && long.is_none())
        || !known.bytes().all(|b| b.is_ascii_digit())
        || known.is_empty()
    {
        return None;
    }
    if unknown == 0 {
        return of_year(sign * known.parse::<i64>().ok()?);
    }
    if digits.len() != 4 {
        return None;
    }
    let step = 10_i64.pow(unknown);
    let first = known.parse::<i64>().ok()? * step;
    // Years before 0 count backwards: -018X are the years -189 to -180.
    let first = if sign < 0 { -(first + step - 1) } else { first };
    let span = Span::of_months(12 * step as i32);
    Some(Interval { uncertain: true, ..Interval::from(Moment::of_year(first)?, span, Granularity::Year) })
}

/// `1890-1895`.
fn range_of_years(text: &str) -> Option<Interval> {
    let (first, last) = text.split_once(['-', '–'])?;
    let (first, last) = (first.trim(), last.trim());
    let is_year = |s: &str| s.len() == 4 && s.bytes().all(|b| b.is_ascii_digit());
    if !is_year(first) || !is_year(last) {
        return None;
    }
    Interval::between(of_year(first.parse().ok()?), of_year(last.parse().ok()?))
}

/// `18900503`.
fn compact(text: &str) -> Option<Interval> {
    if text.len() != 8 || !text.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    of_day(&text[..4], &text[4..6], &text[6..])
}

fn of_day(year: &str, month: &str, day: &str) -> Option<Interval> {
    let begin = Moment::of_date(year.parse().ok()?, month.parse().ok()?, day.parse().ok()?)?;
    Some(Interval::from(begin, Span::of_micros(DAY), Granularity::Day))
}

/// A date from the month on, with a time or without.
fn date_time(text: &str) -> Option<Interval> {
    if let Some(day) = compact(text).or_else(|| dotted(text)) {
        return Some(day);
    }
    let (date, time) = match text.find(['T', 't', ' ']) {
        Some(at) if text[..at].contains('-') => (&text[..at], Some(text[at + 1..].trim())),
        _ => (text, None),
    };
    let (sign, digits) = match date.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", date.strip_prefix('+').unwrap_or(date)),
    };
    let is_number = |s: &str, lengths: &[usize]| lengths.contains(&s.len()) && s.bytes().all(|b| b.is_ascii_digit());
    let parts: Vec<&str> = digits.split('-').collect();
    let (year, month) = (format!("{sign}{}", parts[0]), *parts.get(1)?);
    if !is_number(parts[0], &[4]) {
        return None;
    }
    if let (["XX" | "xx" | "uu"], None) = (&parts[1..], time) {
        return Some(Interval { uncertain: true, ..of_year(year.parse().ok()?)? });
    }
    if !is_number(month, &[1, 2]) {
        return None;
    }
    let day = match parts[..] {
        [_, _] if time.is_none() => return of_months(year.parse().ok()?, month.parse().ok()?),
        [_, _, "XX" | "xx" | "uu"] if time.is_none() => {
            return Some(Interval { uncertain: true, ..of_months(year.parse().ok()?, month.parse().ok()?)? });
        }
        [_, _, day] if is_number(day, &[1, 2]) => of_day(&year, month, day)?,
        _ => return None,
    };
    let Some(time) = time else { return Some(day) };
    let (micros, long, granularity) = of_clock(time)?;
    let begin = Moment::from_micros(day.begin?.micros() + micros)?;
    Some(Interval::from(begin, Span::of_micros(long), granularity))
}

/// A month, or what ISO 8601-2 counts on behind the months: seasons of the north (21 to 24, from spring), quarters (33 to 36).
fn of_months(year: i64, number: i64) -> Option<Interval> {
    let (first, months) = match number {
        1..=12 => (number, 1),
        21..=24 => (3 * (number - 20), 3),
        33..=36 => (3 * (number - 33) + 1, 3),
        _ => return None,
    };
    let begin = Moment::of_date(year, first as i8, 1)?;
    Some(Interval::from(begin, Span::of_months(months), Granularity::Month))
}

/// `3.5.1890`.
fn dotted(text: &str) -> Option<Interval> {
    match text.split('.').collect::<Vec<_>>()[..] {
        [day, month, year] if year.len() == 4 && day.len() <= 2 && month.len() <= 2 => of_day(year, month, day),
        _ => None,
    }
}

/// A time of day, with how far it is from UTC or without: microseconds after midnight of the clock or of UTC, how long it is, how finely it is
/// said.
fn of_clock(text: &str) -> Option<(i64, i64, Granularity)> {
    let (clock, ahead) = match text.find(['Z', 'z', '+', '-', '−']) {
        None => (text, 0),
        Some(at) => (text[..at].trim_end(), offset(&text[at..])?),
    };
    let (whole, part) = clock.split_once(['.', ',']).unwrap_or((clock, ""));
    let digits: Vec<&str> = match whole.contains(':') {
        true => whole.split(':').collect(),
        false => whole.as_bytes().chunks(2).map(|two| std::str::from_utf8(two).unwrap_or("")).collect(),
    };
    let number = |s: &str, most: i64| s.parse::<i64>().ok().filter(|n| s.len() == 2 && (0..=most).contains(n));
    let parts = match digits[..] {
        [h] => [number(h, 24)?, 0, 0],
        [h, m] => [number(h, 24)?, number(m, 59)?, 0],
        // A leap second is the first of the next minute.
        [h, m, s] => [number(h, 24)?, number(m, 59)?, number(s, 60)?],
        _ => return None,
    };
    if (!part.is_empty() || clock.ends_with(['.', ','])) && digits.len() != 3
        || !part.bytes().all(|b| b.is_ascii_digit())
    {
        return None;
    }
    let fraction = format!("{part:0<6}")[..6].parse::<i64>().ok()?;
    let [hour, minute, second] = parts;
    let micros = hour * HOUR + minute * MINUTE + second * SECOND + fraction;
    if micros > DAY {
        return None;
    }
    let (long, granularity) = match (digits.len(), part.is_empty()) {
        (1, _) => (HOUR, Granularity::Minute),
        (2, _) => (MINUTE, Granularity::Minute),
        (_, true) => (SECOND, Granularity::Second),
        _ => (1, Granularity::Micro),
    };
    Some((micros - ahead, long, granularity))
}

/// A time of day without an offset, microseconds.
pub(super) fn time_of_day(text: &str) -> Option<i64> {
    let is_clock = text.bytes().all(|b| b.is_ascii_digit() || b".:".contains(&b)) && text.contains(':');
    of_clock(text).map(|(micros, ..)| micros).filter(|micros| is_clock && *micros < DAY)
}

/// How far a clock is ahead of UTC, microseconds.
fn offset(text: &str) -> Option<i64> {
    if matches!(text, "Z" | "z") {
        return Some(0);
    }
    let sign = if text.starts_with('+') { 1 } else { -1 };
    let digits: String = text.chars().skip(1).filter(|c| *c != ':').collect();
    let (hour, minute) = match digits.len() {
        2 => (digits.as_str(), "0"),
        4 => digits.split_at(2),
        _ => return None,
    };
    let time = civil::Time::new(hour.parse().ok()?, minute.parse().ok()?, 0, 0).ok()?;
    Some(sign * (i64::from(time.hour()) * HOUR + i64::from(time.minute()) * MINUTE))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Option<String>, Option<String>, bool) {
        let interval = Interval::parse(text).unwrap_or_else(|wrong| panic!("{wrong}"));
        let written = |moment: Option<Moment>| moment.map(Moment::written);
        (written(interval.begin), written(interval.end), interval.uncertain)
    }

    #[test]
    fn what_registers_write_is_read() {
        let whole = |begin: &str, end: &str| (Some(begin.to_owned()), Some(end.to_owned()), false);
        let about = |begin: &str, end: &str| (Some(begin.to_owned()), Some(end.to_owned()), true);
        for (text, expected) in [
            ("1890", whole("1890", "1891")),
            (" 1890 ", whole("1890", "1891")),
            ("0000", whole("0000", "0001")),
            ("-0043", whole("-0043", "-0042")),
            ("44 BCE", whole("-0043", "-0042")),
            ("44 bc", whole("-0043", "-0042")),
            ("79 AD", whole("0079", "0080")),
            ("Y-9000", whole("-9000", "-8999")),
            ("1890-05", whole("1890-05", "1890-06")),
            ("1890-12", whole("1890-12", "1891")),
            ("1900-02-28", whole("1900-02-28", "1900-03")),
            ("2000-02-29", whole("2000-02-29", "2000-03")),
            ("18900503", whole("1890-05-03", "1890-05-04")),
            ("3.5.1890", whole("1890-05-03", "1890-05-04")),
            ("2010-07-15T09:28:35", whole("2010-07-15T09:28:35", "2010-07-15T09:28:36")),
            ("2010-07-15 09:28", whole("2010-07-15T09:28", "2010-07-15T09:29")),
            ("2010-07-15T09:28:35.5Z", whole("2010-07-15T09:28:35.500000", "2010-07-15T09:28:35.500001")),
            ("2010-07-15T00:28:35+02:00", whole("2010-07-14T22:28:35", "2010-07-14T22:28:36")),
            ("2010-07-15T23:28-0130", whole("2010-07-16T00:58", "2010-07-16T00:59")),
            ("2010-12-31T24:00:00", whole("2011", "2011-01-01T00:00:01")),
            ("2016-12-31T23:59:60Z", whole("2017", "2017-01-01T00:00:01")),
            ("1890-21", whole("1890-03", "1890-06")),
            ("1890-24", whole("1890-12", "1891-03")),
            ("1890-34", whole("1890-04", "1890-07")),
            ("1890-1895", whole("1890", "1896")),
            ("1890/1895", whole("1890", "1896")),
            ("1890-05/1890-07-03", whole("1890-05", "1890-07-04")),
            ("1890s", whole("1890", "1900")),
            ("1890?", about("1890", "1891")),
            ("1890~", about("1890", "1891")),
            ("c. 1890", about("1890", "1891")),
            ("ca 1890", about("1890", "1891")),
            ("189X", about("1890", "1900")),
            ("18xx", about("1800", "1900")),
            ("-018X", about("-0189", "-0179")),
            ("1890-XX", about("1890", "1891")),
            ("1890-05-XX", about("1890-05", "1890-06")),
            ("1890?/1895", about("1890", "1896")),
        ] {
            assert_eq!(read(text), expected, "{text}");
        }
        assert_eq!(read("../1890"), (None, Some("1891".into()), false));
        assert_eq!(read("1890/.."), (Some("1890".into()), None, false));
        assert_eq!(read("1890/"), (Some("1890".into()), None, false));
    }

    #[test]
    fn numbers_are_years_dates_or_unix_times() {
        let begin = |number| Interval::of_number(number).ok().and_then(|i| i.begin).map(Moment::written);
        for (number, expected) in [
            (1890, "1890"),
            (0, "0000"),
            (-43, "-0043"),
            (18_900_503, "1890-05-03"),
            (1_279_186_115, "2010-07-15T09:28:35"),
            (1_279_186_115_250, "2010-07-15T09:28:35.250000"),
            (1_279_186_115_250_001, "2010-07-15T09:28:35.250001"),
            (-86_400, "1969-12-31"),
            (12_345_678, "1970-05-23T21:21:18"),
        ] {
            assert_eq!(begin(number).as_deref(), Some(expected), "{number}");
        }
        assert!(Interval::of_number(i64::MAX).is_err());
        assert!(Interval::of_number(i64::MIN).is_err());
    }

    #[test]
    fn what_is_no_time_is_told() {
        for text in [
            "",
            "unknown",
            "18",
            "189-05",
            "1890-13",
            "1890-02-30",
            "1900-02-29",
            "10000",
            "Y17000",
            "05/1890",
            "1895/1890",
            "XXXX",
            "1890-05-03T25:00",
            "1890-05-03T24:01",
            "1890-05-03T12:60",
            "1890-05-03T12:00.5",
            "1890-05-03T",
            "1890 AD BC",
            "0 BCE",
            "1895s",
            "1895-1890",
            "2010-07-15T09:28:35+25:00",
            "1890-05-03T12:00:00.x",
            "é",
            "1890é",
            "cé1890",
        ] {
            let wrong = Interval::parse(text).expect_err(text);
            assert!(wrong.contains("would be right"), "{wrong}");
        }
    }
}
