//! When the objects of a city come, go and move.

use std::sync::Arc;

use crate::{
    city::{
        CityModel,
        lifetime::{Dating, Lifetimes},
    },
    figure::moments::label,
    time::{DAY, Granularity, HOUR, MINUTE, Moment, SECOND, Span, Unit},
};

/// What a timeline is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// What comes and goes.
    Dates,
    /// What moves by timetables.
    Timetables,
}

/// Steps through timetables: the longest of which there are [`STEPS`] or more.
const UNITS: [i64; 6] = [HOUR, 10 * MINUTE, MINUTE, 10 * SECOND, SECOND, SECOND / 10];
const STEPS: i64 = 120;
/// What moments of timetables are played and dragged in.
const FINEST: Unit = Unit::Micros(1_000);

/// When the objects of a city come, go and move.
#[derive(Debug)]
pub struct Known {
    model: Arc<CityModel>,
    dating: Dating,
    /// The moments at which something comes or goes, ascending; parts come and go with their buildings.
    events: Vec<Moment>,
    /// How finely dates say when.
    granularity: Granularity,
    /// The first and the last moment of what moves.
    moving: Option<[Moment; 2]>,
}

impl Known {
    /// That of a city.
    pub fn new(model: &Arc<CityModel>, dating: &Dating) -> Self {
        let found = Lifetimes::new(model, dating).unwrap_or_default();
        let of_top = found.of.iter().zip(&model.objects).filter(|(_, object)| object.parents.is_empty());
        let mut events: Vec<Moment> =
            of_top.flat_map(|(lifetime, _)| [lifetime.begin, lifetime.end]).flatten().collect();
        events.sort_unstable();
        let ends = model.moves.iter().filter_map(|of| Some([of.keys.first()?.at, of.keys.last()?.at]));
        let moving = ends.reduce(|[first, last], [from, until]| [first.min(from), last.max(until)]);
        Self {
            model: model.clone(),
            dating: dating.clone(),
            events,
            granularity: found.granularity.unwrap_or(Granularity::Year),
            moving: moving.filter(|[first, last]| first < last),
        }
    }

    /// Whether it is of this city.
    pub fn is_of(&self, model: &Arc<CityModel>, dating: &Dating) -> bool {
        Arc::ptr_eq(&self.model, model) && self.dating == *dating
    }

    /// What there are lines of.
    pub fn lines(&self) -> impl Iterator<Item = Line> {
        let dates = (!self.events.is_empty()).then_some(Line::Dates);
        dates.into_iter().chain(self.moving.map(|_| Line::Timetables))
    }

    /// The line that is shown: the one that is chosen, else that of timetables where they have a moment.
    pub fn line(&self, chosen: Option<Line>, moment: Option<Moment>) -> Option<Line> {
        let is_among = |at: Moment| self.moving.is_some_and(|[first, last]| (first..=last).contains(&at));
        let of_moment = moment.filter(|at| is_among(*at)).map(|_| Line::Timetables);
        chosen.filter(|line| self.lines().any(|own| own == *line)).or(of_moment).or_else(|| self.lines().next())
    }

    /// The first and the last moment of a line: all that moves, or all that comes and goes and one unit more at both ends.
    pub fn span(&self, line: Line) -> Option<[Moment; 2]> {
        if line == Line::Timetables {
            return self.moving;
        }
        let (first, last) = (*self.events.first()?, *self.events.last()?);
        let unit = self.unit(line);
        Some([first.shifted(Span::of_micros(-1)).floored(unit), last.shifted(unit.span()).ceiled(unit)])
    }

    /// What a step is: as finely as dates say it; of timetables a round one.
    pub fn unit(&self, line: Line) -> Unit {
        if let (Line::Timetables, Some([first, last])) = (line, self.moving) {
            let long = UNITS.into_iter().find(|unit| (last - first) / unit >= STEPS);
            return Unit::Micros(long.unwrap_or(SECOND / 10));
        }
        match self.granularity {
            Granularity::Year => Unit::Months(12),
            Granularity::Month => Unit::Months(1),
            Granularity::Day => Unit::Micros(DAY),
            Granularity::Minute => Unit::Micros(MINUTE),
            _ => Unit::Micros(SECOND),
        }
    }

    /// What moments are played in.
    pub fn played(&self, line: Line) -> Unit {
        if line == Line::Timetables { FINEST } else { self.unit(line) }
    }

    /// What moments are dragged and told in: no finer than a person means.
    pub fn dragged(&self, line: Line) -> Unit {
        match (line, self.unit(line)) {
            (Line::Timetables, Unit::Micros(unit)) => Unit::Micros(unit.min(SECOND)),
            (_, unit) => unit,
        }
    }

    /// A moment of a line in words.
    pub fn told(&self, line: Line, at: Moment) -> String {
        match line {
            Line::Dates => label(at, Some(self.granularity)),
            Line::Timetables => label(at.floored(self.dragged(line)), Some(Granularity::Second)),
        }
    }

    /// How many events are in each of so many columns of a span.
    pub fn columns(&self, [first, last]: [Moment; 2], count: usize) -> Vec<u32> {
        let mut columns = vec![0; count];
        for event in &self.events {
            let share = i128::from(*event - first) * count as i128 / i128::from((last - first).max(1));
            let column = usize::try_from(share).ok().filter(|_| *event >= first);
            if let Some(column) = column.and_then(|column| columns.get_mut(column)) {
                *column += 1;
            }
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::city::timetable::{Keyframe, Keyframes};

    #[test]
    fn what_moves_has_a_line_of_its_own() {
        let start = Moment::of_date(2025, 6, 1).expect("a date");
        let key = |second: i64| Keyframe {
            at: start.shifted(Span::of_micros(second * SECOND)),
            place: DVec3::ZERO,
            yaw: 0.0,
            scale: 1.0,
        };
        let of = |seconds: &[i64]| Keyframes { object: 0, keys: seconds.iter().map(|second| key(*second)).collect() };
        let known = |moves: Vec<Keyframes>| {
            Known::new(&Arc::new(CityModel { moves, ..CityModel::default() }), &Dating::default())
        };
        assert_eq!(known(vec![]).line(Some(Line::Timetables), None), None);
        assert_eq!(known(vec![of(&[5])]).lines().count(), 0, "what stands does not move");
        let day = known(vec![of(&[0, 60]), of(&[30, 86_400])]);
        assert_eq!(day.line(None, None), Some(Line::Timetables));
        assert_eq!(day.span(Line::Timetables), Some([key(0).at, key(86_400).at]));
        assert_eq!(day.unit(Line::Timetables), Unit::Micros(10 * MINUTE));
        assert_eq!(known(vec![of(&[0, 60])]).unit(Line::Timetables), Unit::Micros(SECOND / 10));
    }
}
