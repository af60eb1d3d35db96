//! Rows of keys: what a key takes, and how its value goes into what a table means and comes out of it.
//!
//! A table of a scene file is a list of rows over the type that it means. Reading, writing, `--set`, the docs, the schema
//! and the panels of the window go by its rows.

use std::path::PathBuf;

use crate::figure::scene_file::{
    check::{Fields, Place},
    keys::{Key, Table},
    node::{Data, Node},
    paths::Options,
    reader::Reader,
};

/// One key of the tables that mean a `T`.
pub struct Row<T: 'static> {
    /// Name, kind, default, unit, text and example.
    pub key: Key,
    /// The value as files have it; `None`: there is nothing to say.
    get: fn(&T, &Options) -> Option<Data>,
    /// Takes a value over that is of the right kind.
    set: fn(&mut T, &mut Given),
    /// Written at its default, too.
    is_always: bool,
    /// The key that files have before it; empty: the row above.
    after: &'static str,
}

impl<T> Clone for Row<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Row<T> {}

/// A value that stands in a file, on its way into a `T`.
pub struct Given<'g, 'n, 'o> {
    /// The value.
    pub node: &'n Node,
    /// The table that it stands in.
    pub fields: &'g Fields<'n>,
    /// Its key.
    pub key: &'static str,
    /// Takes notes, and knows where paths lead.
    pub reader: &'g mut Reader<'o>,
}

impl<'n> Given<'_, 'n, '_> {
    /// Notes that something is wrong with it.
    pub fn note(&mut self, message: impl Into<String>) {
        self.reader.checker.note(&self.fields.place, self.key, self.node.line, message);
    }

    /// Where a table that it is stands.
    pub fn place(&self) -> Place {
        self.fields.place.within(self.key, self.node.line)
    }

    /// The file that it names; noted where it may not be read.
    pub fn file(&mut self) -> Option<PathBuf> {
        self.reader.path(self.fields, self.key, self.node)
    }

    /// The checked keys of a table that it is.
    pub fn table(&mut self, table: &Table) -> Fields<'n> {
        self.reader.checker.fields(self.node, table, &[], self.place())
    }
}

impl<T> Row<T> {
    /// A key that is taken over by itself.
    pub const fn new(key: Key, get: fn(&T, &Options) -> Option<Data>, set: fn(&mut T, &mut Given)) -> Self {
        Self { key, get, set, is_always: false, after: "" }
    }

    /// A key that is read together with others, by what reads the table.
    pub const fn joint(key: Key, get: fn(&T, &Options) -> Option<Data>) -> Self {
        Self::new(key, get, |_, _| {})
    }

    /// Written at its default, too.
    pub const fn always(self) -> Self {
        Self { is_always: true, ..self }
    }

    /// Written after this key, wherever its row stands.
    pub const fn after(self, name: &'static str) -> Self {
        Self { after: name, ..self }
    }
}

/// The keys of some rows.
pub const fn keys<T, const N: usize>(rows: &[Row<T>]) -> [Key; N] {
    let mut keys = [rows[0].key; N];
    let mut i = 0;
    while i < N {
        keys[i] = rows[i].key;
        i += 1;
    }
    keys
}

/// Takes over what a table has, into a value that is at its defaults; `false` where a key is wrong or missing that must be given.
pub fn read<T>(rows: &[Row<T>], fields: &Fields, reader: &mut Reader, into: &mut T) -> bool {
    let mut is_whole = true;
    for row in rows {
        match fields.node(row.key.name) {
            Some(node) => (row.set)(into, &mut Given { node, fields, key: row.key.name, reader }),
            None => is_whole &= !row.key.default.is_empty(),
        }
    }
    is_whole
}

/// The table of a value, without the keys that are as in `default`.
pub fn written<T>(rows: &[Row<T>], value: &T, default: &T, options: &Options) -> Data {
    let mut entries: Vec<(&'static str, Data)> = Vec::new();
    for row in rows {
        let Some(own) = (row.get)(value, options) else { continue };
        let is_needed = row.is_always || row.key.default.is_empty();
        if is_needed || (row.get)(default, options).as_ref() != Some(&own) {
            entries.push((row.key.name, own));
        }
    }
    Data::table(in_order(rows, entries))
}

/// Brings keys into the order of files.
fn in_order<T>(rows: &[Row<T>], mut entries: Vec<(&'static str, Data)>) -> Vec<(&'static str, Data)> {
    if rows.iter().all(|row| row.after.is_empty()) {
        return entries;
    }
    let mut order: Vec<&str> = rows.iter().filter(|row| row.after.is_empty()).map(|row| row.key.name).collect();
    for row in rows.iter().filter(|row| !row.after.is_empty()) {
        let at = order.iter().position(|name| *name == row.after).map_or(order.len(), |at| at + 1);
        order.insert(at, row.key.name);
    }
    entries.sort_by_key(|(name, _)| order.iter().position(|own| own == name));
    entries
}

/// One kind of several that a table may be, such as a sphere among shapes.
pub struct Variant<T: 'static> {
    /// Name, text and keys; its name is what its `kind` says.
    pub table: Table,
    /// Its rows.
    pub rows: &'static [Row<T>],
    /// One at its defaults.
    pub default: fn() -> T,
    /// Whether a value is of this kind.
    pub is: fn(&T) -> bool,
}

impl<T> Clone for Variant<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Variant<T> {}

impl<T> Variant<T> {
    /// The variant that a value is.
    pub fn of<'v>(variants: &'v [Self], value: &T) -> Option<&'v Self> {
        variants.iter().find(|variant| (variant.is)(value))
    }

    /// A value of this kind, of its table; `None` where a key is wrong or missing that must be given.
    pub fn read(&self, fields: &Fields, reader: &mut Reader) -> Option<T> {
        let mut value = (self.default)();
        read(self.rows, fields, reader, &mut value).then_some(value)
    }

    /// Its table.
    pub fn written(&self, value: &T, options: &Options) -> Data {
        written(self.rows, value, &(self.default)(), options)
    }
}

/// The tables of some variants.
pub const fn tables<T, const N: usize>(variants: &[Variant<T>]) -> [Table; N] {
    let mut tables = [variants[0].table; N];
    let mut i = 0;
    while i < N {
        tables[i] = variants[i].table;
        i += 1;
    }
    tables
}

/// The keys of a constant list of rows.
macro_rules! keys_of {
    ($rows:expr) => {
        &$crate::figure::scene_file::row::keys::<_, { $rows.len() }>($rows)
    };
}

/// The row of a key, the form that its value has in files, and the place of it: `field!(KEY, Same, |sun: Sun| sun.shadows)`.
macro_rules! field {
    ($key:expr, $form:ty, |$own:ident: $type:ty| $place:expr) => {
        $crate::figure::scene_file::row::Row::<$type>::new(
            $key,
            |$own, _| <$form as $crate::figure::scene_file::forms::Form<_>>::data(&$place),
            |$own, given| <$form as $crate::figure::scene_file::forms::Form<_>>::take(given.node, &mut $place),
        )
    };
}

/// The row of a key that one variant of an enum has: `part!(Shape, KEY, Same, Shape::Sphere { radius, .. } => radius)`.
macro_rules! part {
    ($type:ty, $key:expr, $form:ty, $pattern:pat => $place:ident) => {
        $crate::figure::scene_file::row::Row::<$type>::new(
            $key,
            |own, _| match own {
                $pattern => <$form as $crate::figure::scene_file::forms::Form<_>>::data($place),
                #[allow(unreachable_patterns, reason = "an enum may have one variant")]
                _ => None,
            },
            |own, given| {
                if let $pattern = own {
                    <$form as $crate::figure::scene_file::forms::Form<_>>::take(given.node, $place);
                }
            },
        )
    };
}

/// The row of the key that says which variant a table is: `kind!("sphere", "Which shape.")`.
macro_rules! kind {
    ($name:literal, $doc:literal) => {
        kind!($name, $doc, "")
    };
    ($name:literal, $doc:literal, $default:literal) => {
        $crate::figure::scene_file::row::Row::joint(
            $crate::figure::scene_file::keys::key(
                "kind",
                $crate::figure::scene_file::keys::Kind::Text,
                $default,
                "",
                $doc,
                concat!("\"", $name, "\""),
            ),
            |_, _| Some($crate::figure::scene_file::node::Data::Text($name.to_owned())),
        )
        .always()
    };
}

/// A variant: its type, name and text, its value at the defaults, the pattern that it has, and its rows.
macro_rules! variant {
    ($type:ty, $name:literal, $doc:expr, $default:expr, $pattern:pat, $rows:expr) => {{
        const ROWS: &[$crate::figure::scene_file::row::Row<$type>] = $rows;
        const KEYS: &[$crate::figure::scene_file::keys::Key] = $crate::figure::scene_file::row::keys_of!(ROWS);
        $crate::figure::scene_file::row::Variant {
            table: $crate::figure::scene_file::keys::Table { name: $name, doc: $doc, keys: KEYS },
            rows: ROWS,
            default: || $default,
            is: |own| matches!(own, $pattern),
        }
    }};
}

pub(in crate::figure::scene_file) use {field, keys_of, kind, part, variant};
