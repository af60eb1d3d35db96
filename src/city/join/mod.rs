//! Side tables: attributes of city objects that stand in another file, joined by id.

mod table;
mod timetable;

use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use crate::{
    city::{
        history::breakpoints,
        join::table::{Cell, Table},
        load::{error::LoadError, input},
        model::{Attribute, CityModel, CityObject, StringId, Value},
        side_table::{Join, JoinFacts},
    },
    time::{Interval, Moment},
};

/// Keys of rows without an object that are named.
const NAMED: usize = 8;

impl CityModel {
    /// Adds the attributes of a side table; where an object has one of that name, the table's stands in its place. An empty cell says
    /// nothing.
    ///
    /// # Errors
    /// A file that is no table, or has no such column; an attribute that no object has.
    pub fn join(&mut self, join: &Join) -> Result<(), LoadError> {
        let bytes = input::read(&join.file)?.bytes;
        let table = Table::new(&join.file, &bytes, &join.key)?;
        let mut owners = match &join.attribute {
            None => Owners::Ids(Ids { objects: &self.objects, next: 0, numbers: None, found: 0 }),
            Some(name) => Owners::Keys(self.owners(&join.file, name)?),
        };
        let mut facts = JoinFacts {
            file: join.file.clone(),
            key: table.key().to_owned(),
            attribute: join.attribute.clone(),
            rows: 0,
            joined: 0,
            objects: 0,
            without_object: 0,
            first_without_object: Vec::new(),
            repeated: 0,
            attributes: table.columns().to_vec(),
        };
        let names: Vec<StringId> = table.columns().iter().map(|name| self.strings.intern(name)).collect();
        let mut added = Added::new(self.objects.len());
        let valid = valid_columns(&table, join)?;
        let is_over_time = valid != [None, None];
        if !is_over_time {
            added.values.reserve(table.most_rows().min(self.objects.len()) * names.len());
        }
        let mut over_time: FxHashMap<u32, Vec<Row>> = FxHashMap::default();
        let mut wrong: Option<LoadError> = None;
        table.each_row(|key, cells| {
            facts.rows += 1;
            let Some(objects) = owners.get(key) else {
                facts.without_object += 1;
                if facts.first_without_object.len() < NAMED {
                    facts.first_without_object.push(key.to_owned());
                }
                return;
            };
            if !is_over_time && objects.iter().any(|object| added.has(*object)) {
                facts.repeated += 1;
                return;
            }
            facts.joined += 1;
            let first = added.values.len();
            let mut dates = [None; 2];
            cells.each(|column, cell| {
                if let Some(end) = valid.iter().position(|of| *of == Some(column)) {
                    match date(&cell) {
                        Ok(date) => dates[end] = date,
                        Err(message) => {
                            let place = format!("row {} of {key}, {}", facts.rows, table.columns()[column]);
                            wrong.get_or_insert_with(|| LoadError::at(&join.file, place, message));
                        }
                    }
                    return;
                }
                let value = match cell {
                    Cell::Boolean(is) => Value::Boolean(is),
                    Cell::Integer(number) => Value::Integer(number),
                    Cell::Number(number) => Value::Number(number),
                    Cell::Text(text) => Value::String(self.strings.intern(text)),
                    Cell::Array(json) => Value::Array(self.strings.intern(&json)),
                    Cell::Object(json) => Value::Object(self.strings.intern(&json)),
                };
                added.values.push(Attribute { name: names[column], value });
            });
            if is_over_time {
                let own = added.values.split_off(first);
                objects.iter().for_each(|object| {
                    over_time.entry(*object).or_default().push((dates[0], dates[1], own.clone()));
                });
                return;
            }
            objects.iter().for_each(|object| added.put(*object, first));
        })?;
        drop(owners);
        if let Some(error) = wrong {
            return Err(error);
        }
        let is_date = |name: &String| valid.iter().flatten().any(|column| table.columns()[*column] == *name);
        facts.attributes.retain(|name| !is_date(name));
        self.add_histories(over_time, &mut added);
        facts.objects = added.count() as u64;
        self.add_attributes(added);
        self.joins.push(facts);
        Ok(())
    }

    /// Adds what rows say over time, and to `added` what holds last.
    fn add_histories(&mut self, over_time: FxHashMap<u32, Vec<Row>>, added: &mut Added) {
        for (object, mut rows) in over_time {
            rows.sort_by_key(|(begin, ..)| *begin);
            let mut names: Vec<StringId> = rows.iter().flat_map(|row| &row.2).map(|own| own.name).collect();
            names.sort_unstable();
            names.dedup();
            let first = added.values.len();
            for name in names {
                let value = |own: &[Attribute]| own.iter().find(|own| own.name == name).map(|own| own.value);
                let said: Vec<_> =
                    rows.iter().filter_map(|(begin, end, own)| Some((*begin, *end, value(own)?))).collect();
                if let Some((.., last)) = said.last() {
                    added.values.push(Attribute { name, value: *last });
                }
                self.histories.entry(name).or_default().of.insert(object, breakpoints(&said));
            }
            added.put(object, first);
        }
    }

    /// The objects that a value of an attribute may mean, in their order.
    fn owners(&self, file: &Path, name: &str) -> Result<FxHashMap<String, Vec<u32>>, LoadError> {
        let mut owners: FxHashMap<String, Vec<u32>> = FxHashMap::default();
        let id = self.strings.find(name);
        for number in 0..self.objects.len() as u32 {
            let own = self.attributes_of(number).iter().find(|attribute| Some(attribute.name) == id);
            let key = own.and_then(|attribute| match attribute.value {
                Value::String(text) => Some(self.strings.get(text).to_owned()),
                Value::Integer(number) => Some(number.to_string()),
                _ => None,
            });
            if let Some(key) = key {
                owners.entry(key).or_default().push(number);
            }
        }
        match owners.is_empty() {
            false => Ok(owners),
            true => Err(LoadError::new(
                file,
                format!("is joined by the attribute \"{name}\", which no object has as a text or a whole number"),
            )),
        }
    }

    /// Puts attributes among those that objects have.
    pub fn add_attributes(&mut self, added: Added) {
        if added.count() == 0 {
            return;
        }
        if self.attributes.is_empty() {
            // Nothing is there that they could stand beside.
            for (object, own) in self.objects.iter_mut().zip(&added.of) {
                object.attributes = own.map_or(0..0, |(first, end)| first..end);
            }
            self.attributes = added.values;
            return;
        }
        let old = std::mem::take(&mut self.attributes);
        let mut all = Vec::with_capacity(old.len() + added.values.len());
        let mut moved = |range: &mut std::ops::Range<u32>, own: &[Attribute]| {
            let first = all.len() as u32;
            let before = &old[range.start as usize..range.end as usize];
            let is_replaced = |attribute: &&Attribute| !own.iter().any(|new| new.name == attribute.name);
            all.extend(before.iter().filter(is_replaced));
            all.extend(own);
            *range = first..all.len() as u32;
        };
        for (number, object) in (0..).zip(&mut self.objects) {
            moved(&mut object.attributes, added.of(number));
        }
        for detail in &mut self.details {
            moved(&mut detail.attributes, &[]);
        }
        self.attributes = all;
    }
}

/// Objects by their ids: of rows that stand in the order of objects the next one is asked first.
struct Ids<'a> {
    objects: &'a [CityObject],
    next: usize,
    /// Once a row does not.
    numbers: Option<FxHashMap<&'a str, u32>>,
    found: u32,
}

impl Ids<'_> {
    fn find(&mut self, key: &str) -> Option<&u32> {
        let is_next = self.objects.get(self.next).is_some_and(|object| *object.id == *key);
        self.found = match is_next {
            true => self.next as u32,
            false => {
                let all = || self.objects.iter().map(|object| &*object.id).zip(0..).collect();
                *self.numbers.get_or_insert_with(all).get(key)?
            }
        };
        self.next = self.found as usize + 1;
        Some(&self.found)
    }
}

/// Which objects rows are of.
enum Owners<'a> {
    /// By their ids.
    Ids(Ids<'a>),
    /// By an attribute.
    Keys(FxHashMap<String, Vec<u32>>),
}

impl Owners<'_> {
    fn get(&mut self, key: &str) -> Option<&[u32]> {
        match self {
            Self::Ids(ids) => ids.find(key).map(std::slice::from_ref),
            Self::Keys(keys) => keys.get(key).map(Vec::as_slice),
        }
    }
}

/// Attributes that objects get.
#[derive(Debug)]
pub struct Added {
    /// All, those of an object one after the other.
    pub values: Vec<Attribute>,
    /// Which are of each object; `None`: it gets none.
    of: Vec<Option<(u32, u32)>>,
}

impl Added {
    /// None, for so many objects.
    pub fn new(objects: usize) -> Self {
        Self { values: Vec::new(), of: vec![None; objects] }
    }

    /// Has an object get what was added from a place on.
    pub fn put(&mut self, object: u32, first: usize) {
        self.of[object as usize] = Some((first as u32, self.values.len() as u32));
    }

    /// Whether an object gets some.
    fn has(&self, object: u32) -> bool {
        self.of[object as usize].is_some()
    }

    /// Those of an object.
    fn of(&self, object: u32) -> &[Attribute] {
        self.of[object as usize].map_or(&[], |(first, end)| &self.values[first as usize..end as usize])
    }

    /// Objects that get some.
    fn count(&self) -> usize {
        self.of.iter().flatten().count()
    }
}

/// What a row says, from when until when.
type Row = (Option<Moment>, Option<Moment>, Vec<Attribute>);

/// Which columns say since when and until when rows hold.
fn valid_columns(table: &Table, join: &Join) -> Result<[Option<usize>; 2], LoadError> {
    let column = |name: &String| {
        let at = table.columns().iter().position(|column| column == name);
        at.ok_or_else(|| {
            LoadError::new(&join.file, format!("has no column \"{name}\"; it has {}", table.columns().join(", ")))
        })
    };
    let [from, until] = &join.valid;
    Ok([from.as_ref().map(column).transpose()?, until.as_ref().map(column).transpose()?])
}

/// The beginning of what a cell says; open ends have none.
fn date(cell: &Cell) -> Result<Option<Moment>, String> {
    let text = match cell {
        Cell::Text(text) => (*text).to_owned(),
        Cell::Integer(number) => number.to_string(),
        _ => return Err("must be a time: \"1890\", \"1890-05-03\" or \"1890-05-03T14:00\"".to_owned()),
    };
    Interval::parse(&text).map(|interval| interval.begin)
}

/// Joins all side tables of a city, in order.
///
/// # Errors
/// See [`CityModel::join`].
pub fn join_all(model: &mut CityModel, joins: &[Join]) -> Result<(), LoadError> {
    joins.iter().try_for_each(|join| model.join(join))
}

/// Reads all timetables of a city, in order.
///
/// # Errors
/// See [`CityModel::add_timetable`].
pub fn read_timetables(model: &mut CityModel, files: &[PathBuf]) -> Result<(), LoadError> {
    files.iter().try_for_each(|file| model.add_timetable(file))
}

#[cfg(test)]
mod tests;
