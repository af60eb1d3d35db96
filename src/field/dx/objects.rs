//! The objects of a native file of OpenDX.

use std::collections::BTreeMap;

use crate::field::{
    dx::{clauses, tokens::Tokens},
    error::FieldError,
    input::Input,
    numbers::{NumberKind, Numbers},
    words::Words,
};

/// What an object is.
pub enum Class {
    /// Numbers.
    Array(Array),
    /// Places on a regular grid, the last axis fastest.
    GridPositions(Regular),
    /// The cells of a grid: samples along each axis, the last fastest.
    GridConnections(Vec<usize>),
    /// Places on a line.
    RegularArray(Regular),
    /// Sums of places, one of each array; the last fastest.
    ProductArray(Vec<String>),
    /// Named objects that belong together.
    Field(Vec<Reference>),
    /// Fields, or groups.
    Group(Vec<Reference>),
    /// Fields in time.
    Series(Vec<Reference>),
    /// Anything else.
    Other(String),
}

/// A regular grid of places.
#[derive(Clone, Default)]
pub struct Regular {
    pub counts: Vec<usize>,
    pub origin: Vec<f64>,
    /// From a place to the next along each axis.
    pub deltas: Vec<Vec<f64>>,
}

/// An object by its name.
pub struct Reference {
    /// What it is here: `data`, `positions`, or the name of a member.
    pub role: String,
    /// Its own name.
    pub key: String,
    /// Where it is in a series.
    pub position: Option<f64>,
}

/// Numbers of an array.
#[derive(Clone)]
pub struct Array {
    pub kind: NumberKind,
    pub is_text: bool,
    pub is_big: bool,
    /// Numbers of an item.
    pub components: usize,
    pub items: usize,
    pub place: Place,
}

/// Where numbers are.
#[derive(Clone)]
pub enum Place {
    /// Nowhere.
    Nowhere,
    /// At this byte of the file.
    Here(usize),
    /// So many bytes behind all objects.
    Behind(usize),
    /// In another file, from this byte on.
    File(String, usize),
}

/// One object.
pub struct Object {
    pub key: String,
    /// Where it begins, in bytes.
    pub at: usize,
    pub class: Class,
    /// What is said of it.
    pub attributes: BTreeMap<String, String>,
}

/// All objects.
pub struct Objects {
    /// In the order of the file.
    pub all: Vec<Object>,
    by_key: BTreeMap<String, usize>,
    /// Where the objects end and numbers begin, in bytes.
    end: usize,
}

impl Objects {
    /// Reads the objects of a file.
    pub fn read(input: &Input<'_>) -> Result<Self, FieldError> {
        let mut tokens = Tokens { words: Words::new(&input.bytes) };
        let mut objects = Self { all: Vec::new(), by_key: BTreeMap::new(), end: input.bytes.len() };
        let mut mode = clauses::Mode::default();
        while let Some(token) = tokens.next() {
            if token.is("object") {
                let number = objects.all.len() + 1;
                let object = clauses::object(&mut tokens, token.at, mode, number)
                    .map_err(|fault| input.at(fault.at, fault.message))?;
                objects.by_key.insert(object.key.clone(), objects.all.len());
                objects.all.push(object);
            } else if token.is("end") {
                tokens.words.line();
                objects.end = tokens.words.at();
                break;
            } else if !mode.take(&token) && !token.is("mode") && !token.is("data") && !token.is("default") {
                let message = format!("\"{}\" stands where `object` or `end` belongs", token.text);
                return Err(input.at(token.at, message));
            }
        }
        Ok(objects)
    }

    /// The object of a name.
    pub fn get(&self, key: &str) -> Option<&Object> {
        self.by_key.get(key).and_then(|index| self.all.get(*index))
    }

    /// The numbers of an array.
    pub fn numbers<'a>(&self, input: &'a Input<'_>, object: &Object, array: &Array) -> Result<Numbers<'a>, FieldError> {
        let count = array.items.saturating_mul(array.components);
        let (at, file) = match &array.place {
            Place::Nowhere => return Err(input.at(object.at, "the array has no `data`")),
            Place::Here(at) => (*at, None),
            Place::Behind(offset) => (self.end.saturating_add(*offset), None),
            Place::File(name, offset) => (*offset, Some(input.beside(name, true)?)),
        };
        if let Some(file) = file {
            let numbers = array.numbers(&file.bytes, at, count).map_err(|message| file.at(at, message))?;
            return Ok(Numbers { bytes: numbers.bytes.into_owned().into(), ..numbers });
        }
        array.numbers(&input.bytes, at, count).map_err(|message| {
            input.at(object.at, format!("the numbers of the array \"{}\", at byte {at}: {message}", object.key))
        })
    }
}

impl Array {
    fn numbers<'a>(&self, bytes: &'a [u8], at: usize, count: usize) -> Result<Numbers<'a>, String> {
        let mut words = Words::from(bytes, at);
        if self.is_text {
            return words.numbers(self.kind, count);
        }
        let needed = count.saturating_mul(self.kind.bytes());
        let left = words.rest().len();
        let own = words
            .take(needed)
            .ok_or_else(|| format!("{needed} bytes belong there, {left} are left; is the file complete?"))?;
        Ok(Numbers::packed(self.kind, self.is_big, own))
    }
}
