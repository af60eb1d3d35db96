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

// 64 bits, as 16 each, low first.
struct Wide {
    a: u32,
    b: u32,
    c: u32,
    d: u32,
}

fn wide_of(hours: u32, micro: u32) -> Wide {
    // hours * 3,600,000,000 + micro; 3,600,000,000 is 54931 * 65536 + 41984.
    let low = hours & 65535u;
    let high = hours >> 16u;
    let a = low * 41984u + (micro & 65535u);
    let b = (a >> 16u) + low * 54931u;
    let b_more = (micro >> 16u) + (b & 65535u);
    let b_high = b_more & 65535u;
    let second = high * 41984u + b_high;
    let c = (second >> 16u) + (b >> 16u) + (b_more >> 16u);
    let c_more = high * 54931u + c;
    return Wide(a & 65535u, second & 65535u, c_more & 65535u, c_more >> 16u);
}

fn wide_is_less(x: Wide, y: Wide) -> bool {
    if x.d != y.d {
        return x.d < y.d;
    }
    if x.c != y.c {
        return x.c < y.c;
    }
    if x.b != y.b {
        return x.b < y.b;
    }
    return x.a < y.a;
}

fn wide_less(x: Wide, y: Wide) -> Wide {
    let a = x.a + 65536u - y.a;
    let b = x.b + 65535u - y.b + (a >> 16u);
    let c = x.c + 65535u - y.c + (b >> 16u);
    let d = x.d + 65535u - y.d + (c >> 16u);
    return Wide(a & 65535u, b & 65535u, c & 65535u, d & 65535u);
}

fn wide_bit(x: Wide, bit: u32) -> u32 {
    let words = array<u32, 4>(x.a, x.b, x.c, x.d);
    return (words[bit >> 4u] >> (bit & 15u)) & 1u;
}

fn wide_twice(x: Wide, bit: u32) -> Wide {
    let a = 2u * x.a + bit;
    let b = 2u * x.b + (a >> 16u);
    let c = 2u * x.c + (b >> 16u);
    let d = 2u * x.d + (c >> 16u);
    return Wide(a & 65535u, b & 65535u, c & 65535u, d & 65535u);
}

// The rest of a division, bit by bit.
fn wide_rest(x: Wide, by: Wide) -> Wide {
    var rest = Wide(0u, 0u, 0u, 0u);
    for (var i = 0u; i < 64u; i++) {
        rest = wide_twice(rest, wide_bit(x, 63u - i));
        if !wide_is_less(rest, by) {
            rest = wide_less(rest, by);
        }
    }
    return rest;
}

// How long the unit that holds a moment has gone on: of units without months.
fn since_unit(at: Moment, unit: Duration) -> Duration {
    if unit.micro == 0u {
        // Whole weeks are counted from Mondays.
        let origin = select(0, 96, unit.hours % 168 == 0);
        return Duration(0, floor_mod(at.hour - origin, unit.hours), at.micro);
    }
    if unit.hours == 0 && MICROS_OF_HOUR % unit.micro == 0u {
        return Duration(0, 0, at.micro % unit.micro);
    }
    // Before 1970 the rest is what is missing of a unit.
    let is_early = at.hour < 0;
    let before = wide_of(u32(abs(at.hour)), 0u);
    let length = wide_of(u32(unit.hours), unit.micro);
    var rest = wide_rest(wide_of(u32(max(at.hour, 0)), at.micro), length);
    if is_early {
        let missing = wide_rest(before, length);
        let part = wide_rest(wide_of(0u, at.micro), length);
        // part - missing, once around.
        if wide_is_less(part, missing) {
            rest = wide_sum(part, length);
        } else {
            rest = part;
        }
        rest = wide_less(rest, missing);
    }
    return duration_of(rest);
}

fn wide_sum(x: Wide, y: Wide) -> Wide {
    let a = x.a + y.a;
    let b = x.b + y.b + (a >> 16u);
    let c = x.c + y.c + (b >> 16u);
    let d = x.d + y.d + (c >> 16u);
    return Wide(a & 65535u, b & 65535u, c & 65535u, d & 65535u);
}

// Hours and microseconds of so many microseconds, less than 2^31 hours.
fn duration_of(micros: Wide) -> Duration {
    let hour = wide_of(1u, 0u);
    var hours = 0u;
    var rest = Wide(0u, 0u, 0u, 0u);
    for (var i = 0u; i < 64u; i++) {
        rest = wide_twice(rest, wide_bit(micros, 63u - i));
        hours = 2u * hours;
        if !wide_is_less(rest, hour) {
            rest = wide_less(rest, hour);
            hours += 1u;
        }
    }
    return Duration(0, i32(hours), rest.a + 65536u * rest.b);
}

fn earlier(at: Moment, by: Duration) -> Moment {
    let is_borrowed = at.micro < by.micro;
    let micro = select(at.micro - by.micro, at.micro + (MICROS_OF_HOUR - by.micro), is_borrowed);
    return in_calendar(Moment(at.hour - by.hours - select(0, 1, is_borrowed), micro));
}

// The last full unit that is not after it.
fn floored(at: Moment, unit: Duration) -> Moment {
    if unit.months > 0 {
        let count = month_count(date_of_day(floor_div(at.hour, 24)));
        return in_calendar(Moment(24 * day_of_date(date_in_month(count - floor_mod(count, unit.months), 1)), 0u));
    }
    return earlier(at, since_unit(at, unit));
}

// The first full unit that is not before it: one that is full stays.
fn ceiled(at: Moment, unit: Duration) -> Moment {
    if unit.months > 0 {
        let floor = floored(at, unit);
        if floor.hour == at.hour && floor.micro == at.micro {
            return at;
        }
        let count = month_count(date_of_day(floor_div(at.hour, 24)));
        return in_calendar(Moment(24 * day_of_date(date_in_month(count - floor_mod(count, unit.months) + unit.months, 1)), 0u));
    }
    let since = since_unit(at, unit);
    if since.hours == 0 && since.micro == 0u {
        return at;
    }
    // What is missing of the unit, which is not all of it.
    let is_borrowed = unit.micro < since.micro;
    let micro = select(unit.micro - since.micro, unit.micro + (MICROS_OF_HOUR - since.micro), is_borrowed);
    return shifted(at, Duration(0, unit.hours - since.hours - select(0, 1, is_borrowed), micro));
}

// The same day at so long after midnight.
fn at_time_of_day(at: Moment, time: Duration) -> Moment {
    return Moment(24 * floor_div(at.hour, 24) + time.hours, time.micro);
}
