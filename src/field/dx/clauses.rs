//! What is said of an object, clause by clause.

use std::collections::BTreeMap;

use crate::field::{
    dx::{
        objects::{Array, Class, Object, Place, Reference, Regular},
        tokens::{Token, Tokens},
    },
    numbers::NumberKind,
};

/// The most numbers of an item of an array.
const MOST_COMPONENTS: usize = 1024;

/// What is wrong, and where, in bytes.
pub struct Fault {
    pub at: usize,
    pub message: String,
}

/// How numbers are written.
#[derive(Clone, Copy)]
pub struct Mode {
    is_text: bool,
    is_big: bool,
}

impl Default for Mode {
    /// Text; bytes are as machines have them today.
    fn default() -> Self {
        Self { is_text: true, is_big: false }
    }
}

impl Mode {
    /// Takes a word that says how; whether it does.
    pub fn take(&mut self, token: &Token) -> bool {
        if token.is("text") || token.is("ascii") {
            self.is_text = true;
        } else if token.is("binary") || token.is("ieee") || token.is("xdr") {
            self.is_text = false;
        } else if token.is("msb") || token.is("lsb") {
            self.is_big = token.is("msb");
            self.is_text = false;
        } else {
            return false;
        }
        true
    }
}

/// An object under way.
struct Clauses {
    class: String,
    mode: Mode,
    kind: NumberKind,
    /// Numbers of a number: complex ones have two.
    category: usize,
    shape: Vec<usize>,
    items: usize,
    place: Place,
    regular: Regular,
    references: Vec<Reference>,
    attributes: BTreeMap<String, String>,
}

/// Reads an object, behind the word `object`. `number`: its name if it has none.
pub fn object(tokens: &mut Tokens<'_>, at: usize, mode: Mode, number: usize) -> Result<Object, Fault> {
    let mut key = number.to_string();
    if let Some(token) = tokens.peek().filter(|token| !token.is("class")) {
        key = token.text;
        tokens.next();
    }
    let mut clauses = Clauses {
        class: String::new(),
        mode,
        kind: NumberKind::F32,
        category: 1,
        shape: Vec::new(),
        items: 0,
        place: Place::Nowhere,
        regular: Regular::default(),
        references: Vec::new(),
        attributes: BTreeMap::new(),
    };
    while let Some(token) = tokens.peek().filter(|token| !token.is("object") && !token.is("end")) {
        tokens.next();
        clauses.clause(&token, tokens).map_err(|message| Fault { at: token.at, message })?;
    }
    let attributes = std::mem::take(&mut clauses.attributes);
    let class = clauses.into_class().map_err(|message| Fault { at, message })?;
    Ok(Object { key, at, class, attributes })
}

impl Clauses {
    fn clause(&mut self, token: &Token, tokens: &mut Tokens<'_>) -> Result<(), String> {
        let next = |tokens: &mut Tokens<'_>, what: &str| {
            tokens
                .next()
                .ok_or_else(|| format!("`{}` is followed by the end of the file; {what} belongs there", token.text))
        };
        if token.is_quoted {
            return Err(format!("\"{}\" in quotes stands where a keyword belongs", token.text));
        }
        match token.text.to_lowercase().as_str() {
            "class" => self.class = next(tokens, "a class")?.text.to_lowercase(),
            "type" => self.kind = kind(tokens)?,
            "category" => {
                self.category = match next(tokens, "real or complex")?.text.as_str() {
                    "real" => 1,
                    "complex" => 2,
                    "quaternion" => 4,
                    other => {
                        return Err(format!("the category is \"{other}\"; real, complex or quaternion belongs there"));
                    }
                }
            }
            "rank" => drop(next(tokens, "a number")?),
            "shape" => self.shape = tokens.whole(),
            "items" | "item" | "count" => {
                let word = next(tokens, "a number")?.text;
                self.items =
                    word.parse().map_err(|_| format!("\"{word}\" stands where the number of items belongs"))?;
            }
            "counts" => self.regular.counts = tokens.whole(),
            "origin" => self.regular.origin = tokens.numbers(),
            "delta" | "deltas" => self.regular.deltas.push(tokens.numbers()),
            "data" => self.data(tokens)?,
            "attribute" => {
                let name = next(tokens, "a name")?.text;
                let mut value = next(tokens, "a value")?;
                if ["string", "number", "value"].iter().any(|word| value.is(word)) {
                    value = next(tokens, "a value")?;
                }
                self.attributes.insert(name, value.text);
            }
            "component" | "member" | "term" => self.reference(token, tokens)?,
            // It may stand behind the name of a member, too.
            "position" => {
                let position = tokens.next().and_then(|t| crate::field::words::number(&t.text));
                if let Some(last) = self.references.last_mut() {
                    last.position = position;
                }
            }
            _ if self.mode.take(token) => {}
            other => return Err(format!("\"{other}\" is no keyword that can stand here")),
        }
        Ok(())
    }

    /// `data follows`, `data 120`, `data file "a.bin",120`, with how it is written before or between.
    fn data(&mut self, tokens: &mut Tokens<'_>) -> Result<(), String> {
        let mut is_file = false;
        loop {
            let token = tokens.next().ok_or("`data` is followed by the end of the file; a place belongs there")?;
            if self.mode.take(&token) || token.is("mode") {
                continue;
            }
            if token.is("file") && !is_file {
                is_file = true;
                continue;
            }
            if (token.is("follow") || token.is("follows")) && !is_file {
                return self.follows(tokens);
            }
            let number = token.text.parse::<usize>().ok().filter(|_| !token.is_quoted && !is_file);
            self.place = match number {
                Some(offset) => Place::Behind(offset),
                None => {
                    let offset = tokens.peek().filter(|t| !t.is_quoted).and_then(|t| t.text.parse().ok());
                    if offset.is_some() {
                        tokens.next();
                    }
                    Place::File(token.text, offset.unwrap_or(0))
                }
            };
            return Ok(());
        }
    }

    /// Passes over numbers that stand right here.
    fn follows(&mut self, tokens: &mut Tokens<'_>) -> Result<(), String> {
        let components = self.components()?;
        let count = self.items.saturating_mul(components);
        if self.mode.is_text {
            self.place = Place::Here(tokens.words.at());
            return tokens.words.numbers(self.kind, count).map(drop);
        }
        tokens.words.line();
        self.place = Place::Here(tokens.words.at());
        let needed = count.saturating_mul(self.kind.bytes());
        let left = tokens.words.rest().len();
        tokens
            .words
            .take(needed)
            .map(drop)
            .ok_or_else(|| format!("{needed} bytes belong behind it, {left} are left; is the file complete?"))
    }

    /// `component "data" value 1`, `member 0 position 1.5 value 2`, `term 3`.
    fn reference(&mut self, keyword: &Token, tokens: &mut Tokens<'_>) -> Result<(), String> {
        let mut position = None;
        let mut role = None;
        loop {
            let token = tokens.next().ok_or_else(|| format!("`{}` names no object", keyword.text))?;
            if token.is("position") && role.is_some() {
                position = tokens.next().and_then(|t| crate::field::words::number(&t.text));
            } else if token.is("value") && (role.is_some() || keyword.is("term")) {
            } else if token.is("file") && role.is_some() {
                return Err("objects of other files are not read; save all in one file".into());
            } else if role.is_some() || keyword.is("term") {
                self.references.push(Reference { role: role.unwrap_or_default(), key: token.text, position });
                return Ok(());
            } else {
                role = Some(token.text);
            }
        }
    }

    /// Numbers of an item.
    fn components(&self) -> Result<usize, String> {
        let count = self.shape.iter().fold(self.category, |count, n| count.saturating_mul(*n));
        match (1..=MOST_COMPONENTS).contains(&count) {
            true => Ok(count),
            false => Err(format!("an item has {count} numbers; 1 to {MOST_COMPONENTS} can be read")),
        }
    }

    fn into_class(self) -> Result<Class, String> {
        let components = self.components()?;
        let keys = |references: Vec<Reference>| references.into_iter().map(|reference| reference.key).collect();
        Ok(match self.class.as_str() {
            "array" => Class::Array(Array {
                kind: self.kind,
                is_text: self.mode.is_text,
                is_big: self.mode.is_big,
                components,
                items: self.items,
                place: self.place,
            }),
            "gridpositions" => Class::GridPositions(self.regular),
            "gridconnections" => Class::GridConnections(self.regular.counts),
            "regulararray" => Class::RegularArray(Regular { counts: vec![self.items], ..self.regular }),
            "productarray" => Class::ProductArray(keys(self.references)),
            "field" => Class::Field(self.references),
            "group" => Class::Group(self.references),
            "series" => Class::Series(self.references),
            "" => return Err("the object has no class; `object 1 class array ...` belongs here".into()),
            other => Class::Other(other.to_owned()),
        })
    }
}

fn kind(tokens: &mut Tokens<'_>) -> Result<NumberKind, String> {
    let mut name = tokens.next().map(|token| token.text.to_lowercase()).unwrap_or_default();
    if ["signed", "unsigned"].contains(&name.as_str()) {
        name = format!("{name} {}", tokens.next().map(|token| token.text.to_lowercase()).unwrap_or_default());
    }
    number_kind(&name)
}

/// The type of numbers of a name; bytes are unsigned unless it says otherwise.
pub fn number_kind(name: &str) -> Result<NumberKind, String> {
    Ok(match name {
        "byte" | "char" | "ubyte" | "uchar" | "unsigned byte" | "unsigned char" => NumberKind::U8,
        "signed byte" | "signed char" | "sbyte" => NumberKind::I8,
        "short" | "signed short" => NumberKind::I16,
        "ushort" | "unsigned short" => NumberKind::U16,
        "int" | "signed int" => NumberKind::I32,
        "uint" | "unsigned int" => NumberKind::U32,
        "float" => NumberKind::F32,
        "double" => NumberKind::F64,
        "string" => return Err("the type is string; numbers belong there".into()),
        other => return Err(format!("the type is \"{other}\"; float, double, int, short or byte belongs there")),
    })
}
