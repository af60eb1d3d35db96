//! Side tables: attributes of city objects that stand in another file, joined by id.

mod table;
mod timetable;

use std::path::PathBuf;

use rustc_hash::FxHashMap;

use crate::city::{
    join::table::{Cell, Table},
    load::{error::LoadError, input},
    model::{Attribute, CityModel, StringId, Value},
    side_table::{Join, JoinFacts},
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
        let owners = self.owners(join)?;
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
        let mut added: FxHashMap<u32, Vec<Attribute>> = FxHashMap::default();
        table.each_row(|key, cells| {
            facts.rows += 1;
            let Some(objects) = owners.get(key) else {
                facts.without_object += 1;
                if facts.first_without_object.len() < NAMED {
                    facts.first_without_object.push(key.to_owned());
                }
                return;
            };
            if objects.iter().any(|object| added.contains_key(object)) {
                facts.repeated += 1;
                return;
            }
            facts.joined += 1;
            let mut own = Vec::with_capacity(names.len());
            cells.each(|column, cell| {
                let value = match cell {
                    Cell::Boolean(is) => Value::Boolean(is),
                    Cell::Integer(number) => Value::Integer(number),
                    Cell::Number(number) => Value::Number(number),
                    Cell::Text(text) => Value::String(self.strings.intern(text)),
                    Cell::Array(json) => Value::Array(self.strings.intern(&json)),
                    Cell::Object(json) => Value::Object(self.strings.intern(&json)),
                };
                own.push(Attribute { name: names[column], value });
            });
            for &object in objects {
                added.insert(object, own.clone());
            }
        })?;
        facts.objects = added.len() as u64;
        drop(owners);
        self.add_attributes(&added);
        self.joins.push(facts);
        Ok(())
    }

    /// The objects that a key may mean, in their order.
    fn owners(&self, join: &Join) -> Result<FxHashMap<String, Vec<u32>>, LoadError> {
        let mut owners: FxHashMap<String, Vec<u32>> = FxHashMap::default();
        let Some(name) = &join.attribute else {
            owners.extend(self.objects.iter().zip(0..).map(|(object, number)| (object.id.to_string(), vec![number])));
            return Ok(owners);
        };
        let id = self.strings.find(name);
        for number in 0..self.objects.len() as u32 {
            let own = self.attributes_of(number).iter().find(|attribute| Some(attribute.name) == id);
            let key = own.and_then(|attribute| match attribute.value {
                Value::String(text) => Some(self.strings.get(text).to_owned()),
                Value::Integer(number) => Some(number.to_string()),
                _ => None,
            });
            owners.entry_of(key, number);
        }
        match owners.is_empty() {
            false => Ok(owners),
            true => Err(LoadError::new(
                &join.file,
                format!("is joined by the attribute \"{name}\", which no object has as a text or a whole number"),
            )),
        }
    }

    /// Puts attributes among those that objects have.
    pub fn add_attributes(&mut self, added: &FxHashMap<u32, Vec<Attribute>>) {
        if added.is_empty() {
            return;
        }
        let old = std::mem::take(&mut self.attributes);
        let mut all = Vec::with_capacity(old.len() + added.values().map(Vec::len).sum::<usize>());
        let mut moved = |range: &mut std::ops::Range<u32>, own: &[Attribute]| {
            let first = all.len() as u32;
            let before = &old[range.start as usize..range.end as usize];
            let is_replaced = |attribute: &&Attribute| !own.iter().any(|new| new.name == attribute.name);
            all.extend(before.iter().filter(is_replaced));
            all.extend(own);
            *range = first..all.len() as u32;
        };
        for (number, object) in (0..).zip(&mut self.objects) {
            moved(&mut object.attributes, added.get(&number).map_or(&[], Vec::as_slice));
        }
        for detail in &mut self.details {
            moved(&mut detail.attributes, &[]);
        }
        self.attributes = all;
    }
}

/// Notes an owner of a key.
trait Owners {
    fn entry_of(&mut self, key: Option<String>, number: u32);
}

impl Owners for FxHashMap<String, Vec<u32>> {
    fn entry_of(&mut self, key: Option<String>, number: u32) {
        if let Some(key) = key {
            self.entry(key).or_default().push(number);
        }
    }
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
