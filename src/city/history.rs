//! Attributes that change over time: which value an object has from when on.

use rustc_hash::FxHashMap;

use crate::{
    city::model::{CityModel, StringId, Value},
    time::Moment,
};

/// From when on (`None`: since ever) something has which value (`None`: none), ascending.
pub type Values<T> = Vec<(Option<Moment>, Option<T>)>;

/// A row: since when, until when, and what holds.
pub type Held<T> = (Option<Moment>, Option<Moment>, T);

/// The values of an attribute over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// By object, at least one each.
    pub of: FxHashMap<u32, Values<Value>>,
}

impl CityModel {
    /// The values over time of an attribute of an object; where it has none of its own, of what it is a part of. `None`: it does not change.
    pub fn history_of(&self, object: u32, name: StringId) -> Option<&[(Option<Moment>, Option<Value>)]> {
        let history = self.histories.get(&name)?;
        let mut at = object;
        // No family is deeper than there are objects.
        for _ in 0..self.objects.len() {
            if let Some(own) = history.of.get(&at) {
                return Some(own);
            }
            let has_own = self.attributes_of(at).iter().any(|own| own.name == name && own.value != Value::Null);
            at = self.objects[at as usize].parents.first().copied().filter(|_| !has_own)?;
        }
        None
    }
}

/// Rows that each say from when until when something holds, as values from when on: where nothing holds, `None`. Of rows that hold at one moment
/// the one that began last counts.
pub fn breakpoints<T: Copy + PartialEq>(rows: &[Held<T>]) -> Values<T> {
    let holds = |at: Option<Moment>, (begin, end, _): &Held<T>| {
        *begin <= at && end.is_none_or(|end| at.is_none_or(|at| at < end))
    };
    let mut moments: Vec<Option<Moment>> = rows.iter().map(|row| row.0).collect();
    moments.extend(rows.iter().filter(|row| row.1.is_some()).map(|row| row.1));
    moments.sort_unstable();
    moments.dedup();
    let at = |at: Option<Moment>| {
        let holding = rows.iter().filter(|row| holds(at, row));
        holding.fold(None, |best: Option<&Held<T>>, row| match best {
            Some(best) if best.0 > row.0 => Some(best),
            _ => Some(row),
        })
    };
    let mut found: Values<T> = Vec::with_capacity(moments.len());
    for moment in moments {
        let value = at(moment).map(|row| row.2);
        if found.last().is_none_or(|last| last.1 != value) {
            found.push((moment, value));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_values_from_when_on() {
        let year = |year: i64| Moment::of_year(year);
        let rows =
            [(None, year(1900), 1), (year(1900), year(1950), 2), (year(1960), None, 3), (year(1920), year(1930), 4)];
        let expected = [
            (None, Some(1)),
            (year(1900), Some(2)),
            (year(1920), Some(4)),
            (year(1930), Some(2)),
            (year(1950), None),
            (year(1960), Some(3)),
        ];
        assert_eq!(breakpoints(&rows), expected);
        assert_eq!(breakpoints(&[(year(1900), None, 7)]), [(year(1900), Some(7))]);
        assert_eq!(
            breakpoints(&[(year(1900), year(1900), 7)]),
            [(year(1900), None)],
            "what ends when it begins holds nowhere"
        );
        assert_eq!(breakpoints::<i32>(&[]), []);
    }
}
