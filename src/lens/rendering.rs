//! How occluders are drawn (O3): words for effects.

use std::collections::BTreeMap;

use crate::lens::{Class, EffectUse};

/// A word for effects.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What scene files call it.
    pub word: &'static str,
    /// Where the spec has it.
    pub spec: &'static str,
    /// What one sees.
    pub doc: &'static str,
    /// What it is made of.
    pub effects: fn() -> Vec<EffectUse>,
}

/// All words; the first is the default.
pub const ROWS: &[Row] = &[Row {
    word: "discard",
    spec: "O3",
    doc: "Occluders are not there, nor are their shadows.",
    effects: || vec![plain("eraser")],
}];

/// An effect with its defaults.
fn plain(effect: &str) -> EffectUse {
    EffectUse { effect: effect.into(), class: Class::Inside, blend: None, weight: None, parameters: BTreeMap::new() }
}

/// How the occluders of a lens are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// The word it was given by; `None`: by effects.
    pub word: Option<&'static str>,
    /// What it is made of.
    pub effects: Vec<EffectUse>,
}

impl Default for Rendering {
    fn default() -> Self {
        let Row { word, effects, .. } = ROWS[0];
        Self { word: Some(word), effects: effects() }
    }
}

impl Rendering {
    /// The rendering of a word.
    pub fn of_word(word: &str) -> Option<Self> {
        let row = ROWS.iter().find(|row| row.word == word)?;
        Some(Self { word: Some(row.word), effects: (row.effects)() })
    }

    /// Of effects.
    pub fn of_effects(effects: Vec<EffectUse>) -> Self {
        Self { word: None, effects }
    }

    /// All words.
    pub fn words() -> impl Iterator<Item = &'static str> + Clone {
        ROWS.iter().map(|row| row.word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::effect;

    #[test]
    fn words_differ_and_are_made_of_right_effects() {
        for (i, row) in ROWS.iter().enumerate() {
            let made = Rendering::of_word(row.word).unwrap();
            assert!(ROWS[..i].iter().all(|other| other.word != row.word), "{}", row.word);
            assert!(!made.effects.is_empty() && row.doc.ends_with('.') && !row.spec.is_empty());
            for used in &made.effects {
                assert_eq!(effect::check(used), [], "{}", row.word);
            }
        }
        assert_eq!(Rendering::of_word("vanish"), None);
    }
}
