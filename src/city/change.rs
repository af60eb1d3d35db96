//! What became of objects from one state of a city to another, as an attribute of them: by time, or against other files.

use std::path::{Path, PathBuf};

use crate::{
    city::{
        compare::{CompareError, Comparison, Key, State},
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

/// The usual name of the attribute.
pub const ATTRIBUTE: &str = "change";

/// What became of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Became {
    /// It is in the later state alone.
    Added,
    /// It is in the earlier state alone.
    Removed,
    /// It is in both, and the same.
    Kept,
    /// It is in neither of two moments.
    AtNeither,
    /// It has another shape.
    OtherShape,
    /// It has other attributes, or another type.
    OtherAttributes,
    /// Both of these.
    Other,
}

impl Became {
    /// What may have become of objects of an earlier state in files.
    pub const OF_EARLIER: [Self; 5] = [Self::Removed, Self::Kept, Self::OtherShape, Self::OtherAttributes, Self::Other];

    /// What the attribute says.
    pub fn word(self) -> &'static str {
        match self {
            Self::Added => "added",
            Self::Removed => "removed",
            Self::Kept => "kept",
            Self::AtNeither => "at neither",
            Self::OtherShape => "other shape",
            Self::OtherAttributes => "other attributes",
            Self::Other => "other shape and attributes",
        }
    }
}

impl From<State> for Became {
    fn from(state: State) -> Self {
        match state {
            State::Added => Self::Added,
            State::Removed => Self::Removed,
            State::Unchanged => Self::Kept,
            State::Changed { geometry: true, attributes: false } => Self::OtherShape,
            State::Changed { geometry: false, .. } => Self::OtherAttributes,
            State::Changed { .. } => Self::Other,
        }
    }
}

impl CityModel {
    /// Adds an attribute to all objects with a date: what became of them from one moment to another.
    ///
    /// # Errors
    /// No object has the attributes that are to say when it is there.
    pub fn add_change(&mut self, attribute: &str, [since, until]: [Moment; 2], dating: &Dating) -> Result<(), String> {
        let of = |lifetime: &Lifetime| {
            let is_undated = lifetime.begin.is_none() && lifetime.end.is_none();
            let became = match [since, until].map(|at| lifetime.holds(Some(at))) {
                [true, true] => Became::Kept,
                [true, false] => Became::Removed,
                [false, true] => Became::Added,
                [false, false] => Became::AtNeither,
            };
            (!is_undated).then_some(became)
        };
        let lifetimes = Lifetimes::new(self, dating)?;
        let words: Vec<Option<Became>> = lifetimes.of.iter().map(of).collect();
        if words.iter().all(Option::is_none) {
            log::warn!("no object says when it is there: {attribute} has no values");
        }
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
        let found = Comparison::new(before, self, &key_of(key));
        let found = found.map_err(|error| LoadError::new(file, error.to_string()))?;
        let words: Vec<Option<Became>> = found.after.iter().map(|compared| Some(compared.own.into())).collect();
        self.add_words(attribute, &words);
        Ok(found.before.iter().filter(|compared| compared.own == State::Removed).count() as u64)
    }

    /// Adds an attribute to all objects of an earlier state: what became of them in a later one; of each object what that is.
    ///
    /// # Errors
    /// The states cannot be compared.
    pub fn add_change_until(
        &mut self,
        attribute: &str,
        after: &CityModel,
        key: Option<&str>,
    ) -> Result<Vec<Became>, CompareError> {
        let found = Comparison::new(self, after, &key_of(key))?;
        let became: Vec<Became> = found.before.iter().map(|compared| compared.own.into()).collect();
        let words: Vec<Option<Became>> = became.iter().copied().map(Some).collect();
        self.add_words(attribute, &words);
        Ok(became)
    }

    /// A word for each object that has one.
    fn add_words(&mut self, attribute: &str, words: &[Option<Became>]) {
        let name = self.strings.intern(attribute);
        self.changes.push(name);
        let mut added = Added::new(words.len());
        for (object, word) in (0..).zip(words).filter_map(|(object, word)| Some((object, (*word)?))) {
            let value = Value::String(self.strings.intern(word.word()));
            let first = added.values.len();
            added.values.push(Attribute { name, value });
            added.put(object, first);
        }
        self.add_attributes(added);
    }
}

/// By which attribute objects of two states are the same; without one by their ids.
fn key_of(attribute: Option<&str>) -> Key {
    attribute.map_or(Key::Id, |key| Key::Attribute(key.to_owned()))
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
        let mut old = before.clone();
        let became = old.add_change_until("change", &after, None).expect("a comparison");
        let expected = [Became::Kept, Became::OtherShape, Became::Removed];
        assert_eq!((words(&old, "change"), &became[..]), (expected.map(|of| of.word().into()).to_vec(), &expected[..]));
        assert_eq!((words(&after, "change"), gone), (vec!["kept".into(), "other shape".into(), "added".into()], 1));
        // What became of objects since one state makes them no others than in another.
        assert_eq!(after.add_change_since(Path::new("old"), "again", &before, None).expect("a comparison"), 1);
        assert_eq!(words(&after, "again"), words(&after, "change"));
        let wrong = after.add_change_since(Path::new("old"), "change", &before, Some("number"));
        assert!(wrong.is_err_and(|error| error.to_string().contains("number")));
    }
}
