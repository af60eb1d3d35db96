"""The calendar of Python's `datetime` as an independent one: chains of time operators, in whole numbers.

    python3 tests/features/time/chains.py > tests/features/time/chains.txt

Chains are made by a generator of random numbers that the test has, too. A line has the number of a chain, its first moment and its last,
microseconds since 1970; then, for each thousand chains, their sum modulo 2^64 in their order. Years that `datetime` does not have are moved
by rounds of the calendar, 400 years of 146,097 days.
"""

import datetime

DAY = 86_400_000_000
EPOCH = datetime.date(1970, 1, 1).toordinal()
FIRST_YEAR, LAST_YEAR = -9999, 9999
MONTHS = [1, 3, 6, 12, 120, 1200]
MICROS = [1, 40_000, 10**6, 60 * 10**6, 420 * 10**6, 900 * 10**6, 5400 * 10**6, 3600 * 10**6, 6 * 3600 * 10**6, 25 * 3600 * 10**6,
          DAY, 7 * DAY, 14 * DAY, 10 * DAY]


def day_of(year, month, day):
    rounds = (year - 1) // 400 - 4
    return datetime.date(year - 400 * rounds, month, day).toordinal() + 146_097 * rounds - EPOCH


def date_of(day):
    rounds = (day + EPOCH - 1) // 146_097 - 4
    date = datetime.date.fromordinal(day + EPOCH - 146_097 * rounds)
    return date.year + 400 * rounds, date.month, date.day


FIRST = day_of(FIRST_YEAR, 1, 1) * DAY
LAST = day_of(LAST_YEAR, 12, 31) * DAY + DAY - 1


def within(micros):
    return min(max(micros, FIRST), LAST)


def in_month(count, day, time):
    """The day of a month counted from the year 0, or its last."""
    year, month = count // 12, count % 12 + 1
    if year < FIRST_YEAR:
        return FIRST
    if year > LAST_YEAR:
        return LAST
    for last in (day, 30, 29, 28):
        try:
            return day_of(year, month, min(day, last)) * DAY + time
        except ValueError:
            continue


def shift(at, months, micros):
    if months:
        year, month, day = date_of(at // DAY)
        at = in_month(12 * year + month - 1 + months, day, at % DAY)
    return within(at + micros)


def months_of(at):
    year, month, _ = date_of(at // DAY)
    return 12 * year + month - 1


def floor(at, months, micros):
    if months:
        count = months_of(at)
        return in_month(count - count % months, 1, 0)
    origin = 4 * DAY if micros % (7 * DAY) == 0 else 0
    return within(at - (at - origin) % micros)


def ceil(at, months, micros):
    if months:
        if floor(at, months, micros) == at:
            return at
        count = months_of(at)
        return in_month(count - count % months + months, 1, 0)
    origin = 4 * DAY if micros % (7 * DAY) == 0 else 0
    return within(at + (origin - at) % micros)


class Random:
    def __init__(self):
        self.state = 44

    def below(self, most):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) % 2**64
        return (self.state >> 16) % most

    def moment(self):
        """A year of all, now and then near one of the ends; a day; now and then midnight, an hour or the last microsecond of the day."""
        kind = self.below(8)
        year = {0: FIRST_YEAR + self.below(12), 1: LAST_YEAR - self.below(12)}.get(kind, self.below(6000) - 3000)
        month, day = self.below(12) + 1, self.below(31) + 1
        time = [0, self.below(24) * 3600 * 10**6, DAY - 1, self.below(DAY)][self.below(4)]
        return in_month(12 * year + month - 1, day, time)

    def span(self):
        months = [0, self.below(25) - 12, self.below(4801) - 2400][self.below(3)]
        micros = [0, self.below(2 * DAY) - DAY, (self.below(2001) - 1000) * DAY][self.below(3)]
        return months, micros

    def unit(self):
        kind = self.below(len(MONTHS) + len(MICROS))
        return (MONTHS[kind], 0) if kind < len(MONTHS) else (0, MICROS[kind - len(MONTHS)])


def chain(random):
    at = random.moment()
    first = at
    for _ in range(1 + random.below(8)):
        kind = random.below(9)
        if kind == 0:
            at = random.moment()
        elif kind <= 4:
            at = shift(at, *random.span())
        elif kind <= 6:
            at = shift(at, *random.span())
            at = ceil(at, *random.unit())
        elif kind == 7:
            at = shift(at, *random.span())
            at = floor(at, *random.unit())
        else:
            at = at - at % DAY + random.below(DAY)
    return first, at


random, total = Random(), 0
for number in range(100_000):
    first, last = chain(random)
    total = (total * 3 + last) % 2**64
    if number % 1000 < 2:
        print(number, first, last)
    if number % 1000 == 999:
        print("sum", total)
