// Moments, as whole hours since the start of 1970 in the proleptic Gregorian calendar and microseconds of that hour: exact, in integers
// alone. The host's `time::Moment` is the same, and its twin in all that follows.

struct Moment {
    hour: i32,
    micro: u32,                 // 0 .. 3,599,999,999
}

// How long: calendar months, then whole hours, then microseconds of an hour.
struct Duration {
    months: i32,
    hours: i32,
    micro: u32,                 // 0 .. 3,599,999,999
}

// No moment at all: everything is there.
const TIMELESS_HOUR: i32 = -2147483647;
const MICROS_OF_HOUR: u32 = 3600000000u;
// Ends of the calendar: the years -9999 to 9999.
const FIRST_MOMENT = Moment(-104918088, 0u);
const LAST_MOMENT = Moment(70389527, 3599999999u);

fn is_before(a: Moment, b: Moment) -> bool {
    return a.hour < b.hour || (a.hour == b.hour && a.micro < b.micro);
}

fn are_same(a: Moment, b: Moment) -> bool {
    return a.hour == b.hour && a.micro == b.micro;
}

fn in_calendar(at: Moment) -> Moment {
    if is_before(at, FIRST_MOMENT) {
        return FIRST_MOMENT;
    }
    if is_before(LAST_MOMENT, at) {
        return LAST_MOMENT;
    }
    return at;
}

// A moment that the calendar has, of whatever two numbers; none stays none.
fn sound(at: Moment) -> Moment {
    if at.hour == TIMELESS_HOUR {
        return Moment(TIMELESS_HOUR, 0u);
    }
    return in_calendar(Moment(at.hour, min(at.micro, MICROS_OF_HOUR - 1u)));
}

// Quotient and rest as Euclid has them, for b > 0.
fn floor_div(a: i32, b: i32) -> i32 {
    let q = a / b;
    return select(q, q - 1, q * b > a);
}

fn floor_mod(a: i32, b: i32) -> i32 {
    return a - b * floor_div(a, b);
}

struct Date {
    year: i32,
    month: i32,                 // 1 .. 12
    day: i32,                   // 1 .. 31
}

// The date of a day, counted from the start of 1970: years that begin with March, in the calendar's rounds of 400.
fn date_of_day(day: i32) -> Date {
    let shifted_day = day + 719468;
    let era = floor_div(shifted_day, 146097);
    let of_era = shifted_day - 146097 * era;
    let year_of_era = (of_era - of_era / 1460 + of_era / 36524 - of_era / 146096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march_month = (5 * of_year + 2) / 153;
    let month = select(march_month - 9, march_month + 3, march_month < 10);
    let year = year_of_era + 400 * era + select(0, 1, month <= 2);
    return Date(year, month, of_year - (153 * march_month + 2) / 5 + 1);
}

// The day of a date, counted from the start of 1970.
fn day_of_date(date: Date) -> i32 {
    let year = date.year - select(0, 1, date.month <= 2);
    let era = floor_div(year, 400);
    let year_of_era = year - 400 * era;
    let march_month = select(date.month - 3, date.month + 9, date.month <= 2);
    let of_year = (153 * march_month + 2) / 5 + date.day - 1;
    let of_era = 365 * year_of_era + year_of_era / 4 - year_of_era / 100 + of_year;
    return 146097 * era + of_era - 719468;
}

// A date of the month that is so many months after the start of the year 0; days that it does not have are its last.
fn date_in_month(count: i32, day: i32) -> Date {
    let first = Date(floor_div(count, 12), floor_mod(count, 12) + 1, 1);
    let next = Date(floor_div(count + 1, 12), floor_mod(count + 1, 12) + 1, 1);
    return Date(first.year, first.month, min(day, day_of_date(next) - day_of_date(first)));
}

fn month_count(date: Date) -> i32 {
    return 12 * date.year + date.month - 1;
}

// So much later: by months first.
fn shifted(at: Moment, by: Duration) -> Moment {
    var moved = at;
    if by.months != 0 {
        let day = floor_div(at.hour, 24);
        let date = date_of_day(day);
        let to = day_of_date(date_in_month(month_count(date) + by.months, date.day));
        moved = in_calendar(Moment(24 * to + at.hour - 24 * day, at.micro));
    }
    let room = MICROS_OF_HOUR - by.micro;
    let is_carried = moved.micro >= room;
    let micro = select(moved.micro + by.micro, moved.micro - room, is_carried);
    return in_calendar(Moment(moved.hour + by.hours + select(0, 1, is_carried), micro));
}

// What moments are rounded to: so many months; or none, and so many times a part of an hour that divides it.
struct Unit {
    months: i32,
    count: u32,                 // 1 .. 65,535
    base: u32,                  // microseconds, 1 .. 3,600,000,000
}

// Whole bases and microseconds of one.
struct Part {
    bases: u32,
    micro: u32,
}

// How long the unit that holds a moment has gone on: of units without months.
fn since_unit(at: Moment, unit: Unit) -> Part {
    // Whole weeks are counted from Mondays.
    let origin = select(0, 96, unit.base == MICROS_OF_HOUR && unit.count % 168u == 0u);
    let hours = u32(floor_mod(at.hour - origin, i32(unit.count)));
    let of_hours = (hours * ((MICROS_OF_HOUR / unit.base) % unit.count)) % unit.count;
    return Part((of_hours + (at.micro / unit.base) % unit.count) % unit.count, at.micro % unit.base);
}

fn duration_of(part: Part, unit: Unit) -> Duration {
    let per_hour = MICROS_OF_HOUR / unit.base;
    return Duration(0, i32(part.bases / per_hour), (part.bases % per_hour) * unit.base + part.micro);
}

fn earlier(at: Moment, by: Duration) -> Moment {
    let is_borrowed = at.micro < by.micro;
    let micro = select(at.micro - by.micro, at.micro + (MICROS_OF_HOUR - by.micro), is_borrowed);
    return in_calendar(Moment(at.hour - by.hours - select(0, 1, is_borrowed), micro));
}

// The last full unit that is not after it.
fn floored(at: Moment, unit: Unit) -> Moment {
    if unit.months > 0 {
        let count = month_count(date_of_day(floor_div(at.hour, 24)));
        return in_calendar(Moment(24 * day_of_date(date_in_month(count - floor_mod(count, unit.months), 1)), 0u));
    }
    return earlier(at, duration_of(since_unit(at, unit), unit));
}

// The first full unit that is not before it: one that is full stays.
fn ceiled(at: Moment, unit: Unit) -> Moment {
    if unit.months > 0 {
        let floor = floored(at, unit);
        if floor.hour == at.hour && floor.micro == at.micro {
            return at;
        }
        let count = month_count(date_of_day(floor_div(at.hour, 24)));
        return in_calendar(Moment(24 * day_of_date(date_in_month(count - floor_mod(count, unit.months) + unit.months, 1)), 0u));
    }
    let since = since_unit(at, unit);
    if since.bases == 0u && since.micro == 0u {
        return at;
    }
    // What is missing of the unit, which is not all of it.
    let is_between = since.micro > 0u;
    let missing = Part(unit.count - since.bases - select(0u, 1u, is_between), select(0u, unit.base - since.micro, is_between));
    return shifted(at, duration_of(missing, unit));
}

// The same day at so long after midnight.
fn at_time_of_day(at: Moment, time: Duration) -> Moment {
    return Moment(24 * floor_div(at.hour, 24) + time.hours, time.micro);
}
