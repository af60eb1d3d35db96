//! How occluders are drawn (O3): words for effects.

use crate::{
    city::derived::{Derive, Form, Height, LIFT_M},
    lens::{Class, Content, EffectUse, Parameter},
};

/// A word for effects, and for what occluders are shown as.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What scene files call it.
    pub word: &'static str,
    /// Where the spec has it.
    pub spec: &'static str,
    /// What one sees.
    pub doc: &'static str,
    /// What is done to them.
    pub effects: fn() -> Vec<EffectUse>,
    /// What they are shown as; `None`: as themselves.
    pub form: Option<Form>,
}

const BOX: Option<Form> = Some(Form::Box { oriented: false });

/// All words; the first is the default.
pub const ROWS: &[Row] = &[
    Row {
        word: "discard",
        spec: "O3",
        doc: "Occluders are not there, nor are their shadows.",
        effects: || vec![plain("eraser")],
        form: None,
    },
    Row {
        word: "box",
        spec: "O3",
        doc: "The edges of their bounding boxes.",
        effects: || vec![plain("wireframe")],
        form: BOX,
    },
    Row {
        word: "edges",
        spec: "O3",
        doc: "Their own edges and creases.",
        effects: || vec![plain("wireframe")],
        form: None,
    },
    Row {
        word: "transparent",
        spec: "O1, O3",
        doc: "Translucent, with their textures and colours.",
        effects: || vec![with("transparent", &[("opacity", 0.18)])],
        form: None,
    },
    Row {
        word: "transparent-plain",
        spec: "O1, O3",
        doc: "Translucent, without them.",
        effects: || vec![with("transparent", &[("opacity", 0.18)]), plain("clay")],
        form: None,
    },
    Row {
        word: "transparent-box",
        spec: "O1, O3",
        doc: "Their bounding boxes, translucent.",
        effects: || vec![with("transparent", &[("opacity", 0.12)]), plain("clay")],
        form: BOX,
    },
    Row {
        word: "x-ray",
        spec: "O3, O4",
        doc: "Clear where they face the eye, dense where they are seen edge on, in their own colours.",
        effects: || vec![plain("x-ray")],
        form: None,
    },
    Row {
        word: "x-ray-color",
        spec: "O3, O4",
        doc: "The same in one colour.",
        effects: || vec![plain("x-ray"), blue()],
        form: None,
    },
    Row {
        word: "x-ray-shape",
        spec: "O3, O4",
        doc: "The same of their footprints' prisms: colour and shape are left out.",
        effects: || vec![plain("x-ray"), blue()],
        form: Some(Form::Prism),
    },
    Row {
        word: "flatten",
        spec: "O3, O5",
        doc: "Pressed flat to the ground: what is seen of them from above.",
        effects: Vec::new,
        form: Some(Form::Flat { lift_m: LIFT_M }),
    },
    Row {
        word: "hull",
        spec: "O3",
        doc: "Their convex hulls, translucent.",
        effects: || vec![with("transparent", &[("opacity", 0.12)]), plain("clay")],
        form: Some(Form::Hull),
    },
    Row {
        word: "low",
        spec: "O3",
        doc: "Three metres high, whatever their height.",
        effects: Vec::new,
        form: Some(Form::Height(Height::Metres(3.0))),
    },
];

/// An effect with its defaults.
fn plain(effect: &str) -> EffectUse {
    with(effect, &[])
}

/// An effect with these numbers.
fn with(effect: &str, numbers: &[(&str, f64)]) -> EffectUse {
    let parameters = numbers.iter().map(|(key, number)| ((*key).to_owned(), Parameter::Number(*number))).collect();
    EffectUse { effect: effect.into(), class: Class::Inside, blend: None, weight: None, parameters }
}

/// The one colour of what is abstracted.
fn blue() -> EffectUse {
    let parameters = [("color".to_owned(), Parameter::Text("#8fb4d9".to_owned()))].into();
    EffectUse { parameters, ..plain("clay") }
}

/// How the occluders of a lens are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// The word it was given by; `None`: by effects.
    pub word: Option<&'static str>,
    /// What is done to them.
    pub effects: Vec<EffectUse>,
    /// What they are shown as; `None`: as themselves.
    pub content: Option<Content>,
}

impl Default for Rendering {
    fn default() -> Self {
        Self::of_row(&ROWS[0])
    }
}

impl Rendering {
    fn of_row(row: &Row) -> Self {
        let content = |form| Content { derive: Some(Derive { form, parts: false }), ..Content::default() };
        Self { word: Some(row.word), effects: (row.effects)(), content: row.form.map(content) }
    }

    /// The rendering of a word.
    pub fn of_word(word: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.word == word).map(Self::of_row)
    }

    /// Of effects.
    pub fn of_effects(effects: Vec<EffectUse>) -> Self {
        Self { word: None, effects, content: None }
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
            assert!(
                !(made.effects.is_empty() && made.content.is_none()) && row.doc.ends_with('.') && !row.spec.is_empty()
            );
            for used in &made.effects {
                assert_eq!(effect::check(used), [], "{}", row.word);
            }
        }
        assert_eq!(Rendering::of_word("vanish"), None);
    }
}
