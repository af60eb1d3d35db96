//! Interned strings.

use std::hash::BuildHasher;

use rustc_hash::FxBuildHasher;

use crate::city::{memory::give_back, model::StringId};

/// Interned strings: one text for all, because a city has tens of thousands of a few bytes each.
#[derive(Clone, Debug, Default)]
pub struct Strings {
    /// All texts, one after the other.
    text: String,
    /// Exclusive ends in `text`, by id.
    ends: Vec<usize>,
    /// Open addressing over the texts: 1 + id, or 0 where free; a power of two, at most three quarters full.
    slots: Vec<u32>,
}

impl Strings {
    /// The id of `text`, made if new.
    pub fn intern(&mut self, text: &str) -> StringId {
        if self.ends.len() * 4 >= self.slots.len() * 3 {
            self.resize((self.slots.len() * 2).max(64));
        }
        let slot = self.slot_of(text);
        if let Some(id) = self.slots[slot].checked_sub(1) {
            return StringId(id);
        }
        let id = u32::try_from(self.ends.len()).ok().filter(|id| *id < u32::MAX).expect("more than 2^32 strings");
        self.text.push_str(text);
        self.ends.push(self.text.len());
        self.slots[slot] = id + 1;
        StringId(id)
    }

    /// The id of `text`, if it was ever interned.
    pub fn find(&self, text: &str) -> Option<StringId> {
        let slot = (!self.slots.is_empty()).then(|| self.slot_of(text))?;
        self.slots[slot].checked_sub(1).map(StringId)
    }

    /// All texts, in the order of their ids.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.ends.len()).map(|index| self.at(index))
    }

    /// The number of strings.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The text of `id`.
    pub fn get(&self, id: StringId) -> &str {
        self.at(id.0 as usize)
    }

    fn at(&self, index: usize) -> &str {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[index]]
    }

    /// Where `text` stands in `slots`, or the free slot where it would.
    fn slot_of(&self, text: &str) -> usize {
        let mut slot = home(text, self.slots.len());
        while let Some(id) = self.slots[slot].checked_sub(1)
            && self.at(id as usize) != text
        {
            slot = (slot + 1) & (self.slots.len() - 1);
        }
        slot
    }

    fn resize(&mut self, count: usize) {
        let mut slots = vec![0; count];
        for (id, text) in (1..).zip(self.iter()) {
            let mut slot = home(text, count);
            while slots[slot] != 0 {
                slot = (slot + 1) & (count - 1);
            }
            slots[slot] = id;
        }
        give_back(std::mem::replace(&mut self.slots, slots));
    }
}

/// Where looking for `text` begins in a table of `count` slots, a power of two.
fn home(text: &str, count: usize) -> usize {
    let hash = FxBuildHasher.hash_one(text).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (hash ^ (hash >> 32)) as usize & (count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back_and_each_is_there_once() {
        let mut strings = Strings::default();
        assert_eq!((strings.find("a"), strings.find(""), strings.len()), (None, None, 0));
        let text = |i: u32| if i == 7 { String::new() } else { format!("name {i} é") };
        for round in 0..2 {
            for i in 0..5000 {
                assert_eq!(strings.intern(&text(i)), StringId(i), "round {round}");
            }
        }
        assert_eq!(strings.len(), 5000);
        assert!(strings.iter().eq((0..5000).map(text)));
        for i in 0..5000 {
            assert_eq!((strings.get(StringId(i)), strings.find(&text(i))), (&*text(i), Some(StringId(i))));
        }
        assert_eq!(strings.find("name"), None);
    }
}
