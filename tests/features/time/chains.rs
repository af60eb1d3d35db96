//! Chains of time operators against `chains.txt`, which Python's calendar made (`chains.py`), and loops against whole numbers.

use std::collections::BTreeMap;

use veduta::{
    lens::{Handled, Operator, Parameter},
    time::{DAY, Moment, SECOND, Span, Unit},
};

const MONTHS: [i32; 6] = [1, 3, 6, 12, 120, 1200];
const MICROS: [i64; 14] = [
    1,
    40_000,
    SECOND,
    60 * SECOND,
    420 * SECOND,
    900 * SECOND,
    5400 * SECOND,
    3600 * SECOND,
    6 * 3600 * SECOND,
    25 * 3600 * SECOND,
    DAY,
    7 * DAY,
    14 * DAY,
    10 * DAY,
];

/// The generator of `chains.py`.
struct Random(u64);

impl Random {
    fn below(&mut self, most: i64) -> i64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 16) as i64).rem_euclid(most)
    }

    fn moment(&mut self) -> Moment {
        let kind = self.below(8);
        let years = [-9999 + self.below(12), 9999 - self.below(12), self.below(6000) - 3000];
        let year = years[kind.min(2) as usize];
        let (month, day) = (self.below(12) + 1, self.below(31) + 1);
        let times = [0, self.below(24) * 3600 * SECOND, DAY - 1, self.below(DAY)];
        let time = times[self.below(4) as usize];
        // Days that the month does not have are its last.
        let date = (28..=day).rev().find_map(|day| Moment::of_date(year, month as i8, day as i8));
        let date = date.or_else(|| Moment::of_date(year, month as i8, day as i8)).expect("a day");
        date.at_time_of_day(time)
    }

    fn span(&mut self) -> Span {
        let months = [0, self.below(25) - 12, self.below(4801) - 2400];
        let months = months[self.below(3) as usize];
        let micros = [0, self.below(2 * DAY) - DAY, (self.below(2001) - 1000) * DAY];
        let micros = micros[self.below(3) as usize];
        Span::new(months as i32, micros)
    }

    fn unit(&mut self) -> Unit {
        let kind = self.below((MONTHS.len() + MICROS.len()) as i64) as usize;
        if kind < MONTHS.len() { Unit::Months(MONTHS[kind]) } else { Unit::Micros(MICROS[kind - MONTHS.len()]) }
    }
}

/// The next chain: its first moment and its last.
fn chain(random: &mut Random) -> (Moment, Moment) {
    let first = random.moment();
    let mut at = first;
    for _ in 0..=random.below(8) {
        match random.below(9) {
            0 => at = random.moment(),
            1..=4 => at = at.shifted(random.span()),
            5..=6 => at = at.shifted(random.span()).ceiled(random.unit()),
            7 => at = at.shifted(random.span()).floored(random.unit()),
            _ => at = at.at_time_of_day(random.below(DAY)),
        }
    }
    (first, at)
}

#[test]
fn a_hundred_thousand_chains_are_those_of_another_calendar() {
    let lines: Vec<&str> = include_str!("chains.txt").lines().collect();
    let mut lines = lines.into_iter();
    let (mut random, mut total) = (Random(44), 0_u64);
    for number in 0..100_000_u64 {
        let (first, last) = chain(&mut random);
        total = total.wrapping_mul(3).wrapping_add(last.micros().cast_unsigned());
        if number % 1000 < 2 {
            let expected = lines.next().expect("a line");
            assert_eq!(format!("{number} {} {}", first.micros(), last.micros()), expected);
        }
        if number % 1000 == 999 {
            assert_eq!(Some(format!("sum {total}").as_str()), lines.next(), "the thousand chains up to {number}");
        }
    }
    assert_eq!(lines.next(), None);
}

fn operator(op: &str, parameters: &[(&str, &str)], clock_s: f64) -> Operator {
    let parameters = parameters.iter().map(|(key, text)| ((*key).to_owned(), Parameter::Text((*text).to_owned())));
    let used = Handled { handler: op.to_owned(), parameters: parameters.collect::<BTreeMap<_, _>>() };
    Operator::new(&used, clock_s).unwrap_or_else(|wrong| panic!("{op}: {wrong}"))
}

#[test]
fn operators_do_what_they_say() {
    let moment = |text: &str| veduta::time::Interval::parse(text).expect("a time").begin;
    let after = |at: &str, steps: &[(&str, &[(&str, &str)])]| {
        let operators = steps.iter().map(|(op, parameters)| operator(op, parameters, 0.0));
        operators.fold(moment(at), |at, one| one.apply(at)).map(Moment::written)
    };
    let is = |at: &str, steps: &[(&str, &[(&str, &str)])], expected: &str| {
        assert_eq!(after(at, steps).as_deref(), Some(expected), "{at}: {steps:?}");
    };
    is("1950", &[("set", &[("at", "1890-05")])], "1890-05");
    is("1950", &[("shift", &[("by", "10 years")])], "1960");
    is("2023-12-31", &[("shift", &[("by", "2 months")])], "2024-02-29");
    is("2024-02-29", &[("shift", &[("by", "-1 year")])], "2023-02-28");
    is("0001-03-01", &[("shift", &[("by", "-1 day")])], "0001-02-28");
    is("0000-03-01", &[("shift", &[("by", "-1 day")])], "0000-02-29");
    is("0001", &[("shift", &[("by", "-1 µs")])], "0000-12-31T23:59:59.999999");
    // The source's example (Tiesel §4.2.3): in minutes, at 10 the next full hour of 5 later is 60; one that is full stays.
    is("1970-01-01T00:10", &[("ceil", &[("unit", "hour"), ("by", "5 min")])], "1970-01-01T01:00");
    is("1970-01-01T01:00", &[("ceil", &[("unit", "hour")])], "1970-01-01T01:00");
    // And the chain of both gives 65.
    is("1970-01-01T00:10", &[("ceil", &[("unit", "hour")]), ("shift", &[("by", "5 min")])], "1970-01-01T01:05");
    is("1987-06-05", &[("floor", &[("unit", "decade")])], "1980");
    is("-0003-06-05", &[("floor", &[("unit", "decade")])], "-0010");
    is("1987-06-05", &[("ceil", &[("unit", "month")])], "1987-07");
    is("2026-11-29", &[("floor", &[("unit", "week")])], "2026-11-23");
    is("1890-05-03T07:00", &[("time-of-day", &[("time", "16:00")])], "1890-05-03T16:00");
    // Without a moment there is none, until one is set.
    let shift = operator("shift", &[("by", "10 years")], 0.0);
    assert_eq!(shift.apply(None), None);
    assert_eq!(operator("set", &[("at", "1650")], 0.0).apply(None), Moment::of_year(1650));
}

#[test]
fn loops_come_round_exactly() {
    let years: &[(&str, &str)] = &[("begin", "1940"), ("end", "2000"), ("per_second", "1 day")];
    let at = |parameters: &[(&str, &str)], clock_s: f64| operator("loop", parameters, clock_s).apply(None);
    let (from, until) = (Moment::of_year(1940).expect("a year"), Moment::of_year(2000).expect("a year"));
    let days = (until - from) / DAY;
    assert_eq!(days, 21_915);
    for second in [0, 1, days - 1, days, days + 1, 7 * days + 40, -1, -days, -3 * days - 5] {
        let expected = from.shifted(Span::of_micros(second.rem_euclid(days) * DAY));
        assert_eq!(at(years, second as f64), Some(expected), "second {second}");
        assert_eq!(at(years, (second + days) as f64), Some(expected), "a round later than second {second}");
    }
    // A microsecond before the seam, and on it.
    let micros: &[(&str, &str)] = &[("begin", "2026-11-29T10:00"), ("end", "2026-11-29T10:00:10")];
    let written = |clock_s: f64| at(micros, clock_s).map(Moment::written);
    assert_eq!(written(9.999_999).as_deref(), Some("2026-11-29T10:00:09.999999"));
    assert_eq!(written(10.0).as_deref(), Some("2026-11-29T10:00"));
    assert_eq!(written(-0.000_001).as_deref(), Some("2026-11-29T10:00:09.999999"));
}
