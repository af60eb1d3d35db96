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
    /// Open addressing over the texts; a power of two, at most three quarters full.
    slots: Vec<Slot>,
}

/// A place in the table of texts.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    /// 1 + id, or 0 where it is free.
    id: u32,
    /// Of its text: others are told from it without a look at that.
    hash: u32,
}

impl Strings {
    /// The id of `text`, made if new.
    pub fn intern(&mut self, text: &str) -> StringId {
        if self.ends.len() * 4 >= self.slots.len() * 3 {
            self.resize((self.slots.len() * 2).max(64));
        }
        let hash = hash_of(text);
        let slot = self.slot_of(text, hash);
        if let Some(id) = self.slots[slot].id.checked_sub(1) {
            return StringId(id);
        }
        let id = u32::try_from(self.ends.len()).ok().filter(|id| *id < u32::MAX).expect("more than 2^32 strings");
        self.text.push_str(text);
        self.ends.push(self.text.len());
        self.slots[slot] = Slot { id: id + 1, hash };
        StringId(id)
    }

    /// The id of `text`, if it was ever interned.
    pub fn find(&self, text: &str) -> Option<StringId> {
        let slot = (!self.slots.is_empty()).then(|| self.slot_of(text, hash_of(text)))?;
        self.slots[slot].id.checked_sub(1).map(StringId)
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
    fn slot_of(&self, text: &str, hash: u32) -> usize {
        let mut place = hash as usize & (self.slots.len() - 1);
        loop {
            let slot = self.slots[place];
            if slot.id == 0 || (slot.hash == hash && self.at(slot.id as usize - 1) == text) {
                return place;
            }
            place = (place + 1) & (self.slots.len() - 1);
        }
    }

    fn resize(&mut self, count: usize) {
        let mut slots = vec![Slot::default(); count];
        for slot in self.slots.iter().filter(|slot| slot.id != 0) {
            let mut place = slot.hash as usize & (count - 1);
            while slots[place].id != 0 {
                place = (place + 1) & (count - 1);
            }
            slots[place] = *slot;
        }
        give_back(std::mem::replace(&mut self.slots, slots));
    }
}

/// What tells where looking for a text begins: in all its bits.
fn hash_of(text: &str) -> u32 {
    let hash = FxBuildHasher.hash_one(text).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (hash ^ (hash >> 32)) as u32
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
