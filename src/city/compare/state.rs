//! Verdicts of a comparison: on an object, on all, and why there is none.

use serde::Serialize;

/// What objects of two states of a city are matched by.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub enum Key {
    /// Their ids.
    #[default]
    Id,
    /// The value of this attribute; ids where one of both has none.
    Attribute(String),
}

/// What became of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// It is in the later state alone.
    Added,
    /// It is in the earlier state alone.
    Removed,
    /// It is in both, and the same.
    Unchanged,
    /// It is in both, and differs in one of these at least.
    Changed {
        /// Its faces differ.
        geometry: bool,
        /// Its attributes or its type differ.
        attributes: bool,
    },
}

/// How an object was found in the other state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MatchedBy {
    /// Both have the same id.
    Id,
    /// Both have the same value of the attribute asked for.
    Key,
    /// One names the other as what came before or after it.
    Version,
    /// Their parents were matched by a key or as versions, and have as many parts of their type.
    Part,
}

/// An object of one state, compared with the other state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Its counterpart in the other state.
    pub counterpart: Option<u32>,
    /// How that was found; `None`: there is none.
    pub by: Option<MatchedBy>,
    /// What became of the object itself.
    pub own: State,
    /// What became of it with all below it: changed where a part was added, removed or changed.
    pub state: State,
}

/// What differs in an object that is in both states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Differences {
    pub geometry: bool,
    pub attributes: bool,
}

impl Differences {
    /// Of a part that came or went: geometry, or attributes where it has none.
    pub fn of_part(has_geometry: bool) -> Self {
        Self { geometry: has_geometry, attributes: !has_geometry }
    }

    /// Whether there are none.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self { geometry: self.geometry | other.geometry, attributes: self.attributes | other.attributes }
    }

    /// The state of an object that has them.
    pub fn state(self) -> State {
        let Self { geometry, attributes } = self;
        if self.is_none() { State::Unchanged } else { State::Changed { geometry, attributes } }
    }
}

/// Objects of both states by what became of them; one that is in both counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// In the later state alone.
    pub added: u64,
    /// In the earlier state alone.
    pub removed: u64,
    /// In both, and different.
    pub changed: u64,
    /// The number of those whose geometry differs.
    pub changed_geometry: u64,
    /// The number of those whose attributes differ; one may be among both.
    pub changed_attributes: u64,
    /// In both, and the same.
    pub unchanged: u64,
}

impl Counts {
    /// Counts one more.
    pub fn add(&mut self, state: State) {
        match state {
            State::Added => self.added += 1,
            State::Removed => self.removed += 1,
            State::Unchanged => self.unchanged += 1,
            State::Changed { geometry, attributes } => {
                self.changed += 1;
                self.changed_geometry += u64::from(geometry);
                self.changed_attributes += u64::from(attributes);
            }
        }
    }
}

/// Values of an attribute of objects that are in both states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct AttributeCounts {
    /// In the later state alone; null is no value.
    pub added: u64,
    /// In the earlier state alone.
    pub removed: u64,
    /// In both, and different.
    pub changed: u64,
}

impl AttributeCounts {
    /// All of them.
    pub fn total(self) -> u64 {
        self.added + self.removed + self.changed
    }
}

/// A value of the key that does not say which object is meant.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct RepeatedKey {
    /// The value.
    pub value: String,
    /// Objects of the earlier state that have it.
    pub before: u32,
    /// Objects of the later state that have it.
    pub after: u32,
}

/// One of both states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The earlier one.
    Before,
    /// The later one.
    After,
}

/// Why two cities cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// Their coordinates mean other places.
    #[error("the reference systems differ: {before} and {after}")]
    References {
        /// The reference system of the earlier state.
        before: String,
        /// That of the later state.
        after: String,
    },
    /// Degrees or earth-centred coordinates were put in other metric frames.
    #[error("the metric frames differ; the later state is to be loaded with the frames of the earlier one")]
    Frames,
    /// No object has the attribute that is the key.
    #[error("no object has an attribute \"{attribute}\" that is a text or a number")]
    NoKey {
        /// The attribute.
        attribute: String,
        /// The state that lacks it.
        side: Side,
    },
}
