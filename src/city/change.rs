//! What became of objects from one state of a city to another, as an attribute of them: by time, or against other files.

use std::path::{Path, PathBuf};

use crate::{
    city::{
        compare::{Comparison, Key, State},
        join::Added,
        lifetime::{Dating, Lifetime, Lifetimes},
        load::error::LoadError,
        model::{Attribute, CityModel, Value},
    },
    time::Moment,
};

/// Two states of a city, and the attribute that says what became of each object.
#[derive(Clone, Debug, PartialEq)]
pub struct CityChange {
    /// Its name.
    pub attribute: String,
    /// The states.
    pub between: Between,
}

/// Which states.
#[derive(Clone, Debug, PartialEq)]
pub enum Between {
    /// The city at two moments.
    Moments([Moment; 2]),
    /// An earlier state in other files, and the city.
    Files {
        /// The files.
        files: Vec<PathBuf>,
        /// The attribute by which objects of both are the same; `None`: their id.
        key: Option<String>,
    },
}

/// What the attribute says.
const ADDED: &str = "added";
const REMOVED: &str = "removed";
const KEPT: &str = "kept";
/// At neither of two moments.
const NEITHER: &str = "at neither";

impl CityModel {
    /// Adds an attribute to all objects with a date: what became of them from one moment to another.
    ///
    /// # Errors
    /// No object has the attributes that are to say when it is there.
    pub fn add_change(&mut self, attribute: &str, [since, until]: [Moment; 2], dating: &Dating) -> Result<(), String> {
        let of = |lifetime: &Lifetime| {
            let is_undated = lifetime.begin.is_none() && lifetime.end.is_none();
            let word = match [since, until].map(|at| lifetime.holds(Some(at))) {
                [true, true] => KEPT,
                [true, false] => REMOVED,
                [false, true] => ADDED,
                [false, false] => NEITHER,
            };
            (!is_undated).then_some(word)
        };
        let lifetimes = Lifetimes::new(self, dating)?;
        let words: Vec<Option<&str>> = lifetimes.of.iter().map(of).collect();
        self.add_words(attribute, &words);
        Ok(())
    }

    /// Adds an attribute to all objects: what became of them since an earlier state; how many objects that had are gone.
    ///
    /// # Errors
    /// The states cannot be compared.
    pub fn add_change_since(
        &mut self,
        file: &Path,
        attribute: &str,
        before: &CityModel,
        key: Option<&str>,
    ) -> Result<u64, LoadError> {
        let key = key.map_or(Key::Id, |key| Key::Attribute(key.to_owned()));
        let found = Comparison::new(before, self, &key).map_err(|error| LoadError::new(file, error.to_string()))?;
        let of = |state: State| match state {
            State::Added => ADDED,
            State::Removed => REMOVED,
            State::Unchanged => KEPT,
            State::Changed { geometry: true, attributes: false } => "other shape",
            State::Changed { geometry: false, .. } => "other attributes",
            State::Changed { .. } => "other shape and attributes",
        };
        let words: Vec<Option<&str>> = found.after.iter().map(|compared| Some(of(compared.own))).collect();
        self.add_words(attribute, &words);
        Ok(found.before.iter().filter(|compared| compared.own == State::Removed).count() as u64)
    }

    /// A word for each object that has one.
    fn add_words(&mut self, attribute: &str, words: &[Option<&str>]) {
        let name = self.strings.intern(attribute);
        let mut added = Added::new(words.len());
        for (object, word) in (0..).zip(words).filter_map(|(object, word)| Some((object, (*word)?))) {
            let value = Value::String(self.strings.intern(word));
            let first = added.values.len();
            added.values.push(Attribute { name, value });
            added.put(object, first);
        }
        self.add_attributes(added);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::test_city::{add_box, builder};

    /// Of each object; `-`: it has none.
    fn words(model: &CityModel, attribute: &str) -> Vec<String> {
        let name = model.strings.find(attribute).expect("the attribute");
        let of = |object: u32| {
            let own = model.attributes_of(object).iter().find(|own| own.name == name);
            match own.map(|own| own.value) {
                Some(Value::String(text)) => model.strings.get(text).to_owned(),
                None => "-".to_owned(),
                other => panic!("{other:?}"),
            }
        };
        (0..model.objects.len() as u32).map(of).collect()
    }

    #[test]
    fn objects_come_stay_and_go_between_two_moments() {
        let mut builder = builder();
        for (i, id) in ["old", "gone", "new", "between", "ever"].into_iter().enumerate() {
            let x = 5000 * i as i64;
            add_box(&mut builder, id, [x, 0, 0], [x + 1000, 1000, 1000]);
        }
        let mut model = builder.finish();
        let (begin, end) = (model.strings.intern("yearOfConstruction"), model.strings.intern("yearOfDemolition"));
        let years =
            [[Some(1600), None], [Some(1650), Some(1890)], [Some(1895), None], [Some(1850), Some(1860)], [None; 2]];
        let mut dates = Added::new(model.objects.len());
        for (object, of) in (0..).zip(years) {
            let named = [begin, end].into_iter().zip(of);
            let own = named.filter_map(|(name, year)| Some(Attribute { name, value: Value::Integer(year?) }));
            let first = dates.values.len();
            dates.values.extend(own);
            dates.put(object, first);
        }
        model.add_attributes(dates);
        let at = |year: i64| Moment::of_year(year).expect("a year");
        model.add_change("change", [at(1800), at(1900)], &Dating::default()).expect("dates");
        assert_eq!(words(&model, "change"), ["kept", "removed", "added", "at neither", "-"]);
        // Ends are not of lifetimes: what begins when the second state is, is there, and what ends then is not.
        model.add_change("edge", [at(1600), at(1890)], &Dating::default()).expect("dates");
        assert_eq!(words(&model, "edge"), ["kept", "at neither", "at neither", "at neither", "-"]);
    }

    #[test]
    fn objects_are_compared_with_those_of_another_state() {
        let state = |boxes: &[(&str, i64)]| {
            let mut builder = builder();
            for (id, x) in boxes {
                add_box(&mut builder, id, [*x, 0, 0], [x + 1000, 1000, 1000]);
            }
            builder.finish()
        };
        let before = state(&[("a", 0), ("b", 5000), ("gone", 9000)]);
        let mut after = state(&[("a", 0), ("b", 5100), ("c", 20_000)]);
        let gone = after.add_change_since(Path::new("old"), "change", &before, None).expect("a comparison");
        assert_eq!((words(&after, "change"), gone), (vec!["kept".into(), "other shape".into(), "added".into()], 1));
        let wrong = after.add_change_since(Path::new("old"), "change", &before, Some("number"));
        assert!(wrong.is_err_and(|error| error.to_string().contains("number")));
    }
}
