//! Moments as people read them.

use crate::time::{Granularity, Moment, SECOND};

impl Moment {
    /// The moment in a granularity: `1890`, `May 1890`, `3 May 1890`, `3 May 1890, 14:05`, with seconds, with microseconds; years before 1 as
    /// `44 BCE`.
    pub fn label(self, granularity: Granularity) -> String {
        let (year, month, day) = self.date();
        let year = if year > 0 { year.to_string() } else { format!("{} BCE", 1 - i32::from(year)) };
        let month = MONTHS[(month - 1) as usize];
        match granularity {
            Granularity::Year => year,
            Granularity::Month => format!("{month} {year}"),
            Granularity::Day => format!("{day} {month} {year}"),
            _ => format!("{day} {month} {year}, {}", self.clock(granularity)),
        }
    }

    /// Its time of day: `14:05`, `14:05:30` or `14:05:30.000025`.
    pub fn clock(self, granularity: Granularity) -> String {
        let micros = self.time_of_day();
        let seconds = micros / SECOND;
        let (hour, minute, second) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
        match granularity {
            Granularity::Micro => format!("{hour:02}:{minute:02}:{second:02}.{:06}", micros % SECOND),
            Granularity::Second => format!("{hour:02}:{minute:02}:{second:02}"),
            _ => format!("{hour:02}:{minute:02}"),
        }
    }

    /// As files have it: `1890`, `1890-05`, `1890-05-03`, `1890-05-03T14:05:30`, as short as it is exact.
    pub fn written(self) -> String {
        let (year, month, day) = self.date();
        let year = if year < 0 { format!("-{:04}", -i32::from(year)) } else { format!("{year:04}") };
        match Granularity::of(self) {
            Granularity::Year => year,
            Granularity::Month => format!("{year}-{month:02}"),
            Granularity::Day => format!("{year}-{month:02}-{day:02}"),
            granularity => format!("{year}-{month:02}-{day:02}T{}", self.clock(granularity)),
        }
    }
}

const MONTHS: [&str; 12] = [
    "January",
    "February",
    "March",
    "April",
    "May",
    "June",
    "July",
    "August",
    "September",
    "October",
    "November",
    "December",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{HOUR, Interval, MINUTE, Span};

    #[test]
    fn moments_are_written_as_they_are_read() {
        let day = Moment::of_date(1890, 5, 3).expect("a day");
        let at = |micros| day.shifted(Span::of_micros(micros));
        for (moment, written, label) in [
            (Moment::of_year(1890).expect("a year"), "1890", "1890"),
            (Moment::of_date(1890, 5, 1).expect("a month"), "1890-05", "May 1890"),
            (day, "1890-05-03", "3 May 1890"),
            (at(14 * HOUR + 5 * MINUTE), "1890-05-03T14:05", "3 May 1890, 14:05"),
            (at(14 * HOUR + 5 * MINUTE + 7 * SECOND), "1890-05-03T14:05:07", "3 May 1890, 14:05:07"),
            (at(25), "1890-05-03T00:00:00.000025", "3 May 1890, 00:00:00.000025"),
            (Moment::of_year(0).expect("a year"), "0000", "1 BCE"),
            (Moment::of_date(-43, 3, 15).expect("a day"), "-0043-03-15", "15 March 44 BCE"),
            (Moment::FIRST, "-9999", "10000 BCE"),
        ] {
            assert_eq!((moment.written().as_str(), moment.label(Granularity::of(moment)).as_str()), (written, label));
            assert_eq!(Interval::parse(written).map(|read| read.begin), Ok(Some(moment)), "{written}");
        }
    }
}
