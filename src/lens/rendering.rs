//! How occluders are drawn: words for effects and forms, with parameters; by distance and kind of object, if asked.

use std::collections::BTreeMap;

use crate::{
    city::derived::{Derive, Form, HEIGHT_RANGE_M, Height, LIFT_M, LIFT_RANGE_M},
    lens::{
        chosen::Choice,
        class::Class,
        content::Content,
        effect_use::{EffectUse, Parameter},
    },
    shader::effect::{DefaultValue, Fallback, ParameterDefinition, ParameterKind, find},
};

/// A word for effects, and for what occluders are shown as.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What scene files call it.
    pub word: &'static str,
    /// Where it comes from: author and section.
    pub spec: &'static str,
    /// What one sees.
    pub doc: &'static str,
    /// What is done to them: effects, with the parameters whose defaults are others here than elsewhere.
    pub effects: &'static [(&'static str, &'static [(&'static str, Preset)])],
    /// What they are shown as; `None`: as themselves.
    pub form: Option<FormRow>,
}

/// A default that a word has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Preset {
    /// A number.
    Number(f64),
    /// A word or a colour.
    Text(&'static str),
}

/// What a word shows occluders as.
#[derive(Clone, Copy, Debug)]
pub struct FormRow {
    /// The parameters that it reads.
    pub parameters: &'static [FormParameter],
    /// The form that they say.
    pub make: fn(&Given) -> Form,
}

/// A parameter of a form.
#[derive(Clone, Copy, Debug)]
pub struct FormParameter {
    name: &'static str,
    /// Its closed range; `None`: yes or no.
    range: Option<[f64; 2]>,
    /// Of yes or no: 0 is no.
    default: f64,
    unit: &'static str,
    doc: &'static str,
}

/// The parameters of a word that are given, by name.
pub type Given = BTreeMap<String, Parameter>;

const ORIENTED: FormParameter = FormParameter {
    name: "oriented",
    range: None,
    default: 0.0,
    unit: "",
    doc: "Whether boxes stand on the smallest rectangle around the footprint; else along the axes.",
};
const LIFT: FormParameter = FormParameter {
    name: "lift",
    range: Some(LIFT_RANGE_M),
    default: LIFT_M,
    unit: "m",
    doc: "How far above the ground they lie.",
};
const HEIGHT: FormParameter = FormParameter {
    name: "height",
    range: Some(HEIGHT_RANGE_M),
    default: 3.0,
    unit: "m",
    doc: "How high they are, from the lowest point to the highest.",
};

const BOX: Option<FormRow> = Some(FormRow {
    parameters: &[ORIENTED],
    make: |given| Form::Box { oriented: given.get(ORIENTED.name) == Some(&Parameter::Boolean(true)) },
});
const PRISM: Option<FormRow> = Some(FormRow { parameters: &[], make: |_| Form::Prism });
const TOP: Option<FormRow> =
    Some(FormRow { parameters: &[LIFT], make: |given| Form::Top { lift_m: LIFT.number(given) } });
const LOD1: Option<FormRow> = Some(FormRow { parameters: &[], make: |_| Form::Lod1 });
const HULL: Option<FormRow> = Some(FormRow { parameters: &[], make: |_| Form::Hull });
const FLAT: Option<FormRow> =
    Some(FormRow { parameters: &[LIFT], make: |given| Form::Flat { lift_m: LIFT.number(given) } });
const LOW: Option<FormRow> =
    Some(FormRow { parameters: &[HEIGHT], make: |given| Form::Height(Height::Metres(HEIGHT.number(given))) });

/// The colour of what is abstracted.
const BLUE: (&str, &[(&str, Preset)]) = ("clay", &[("color", Preset::Text("#8fb4d9"))]);

/// Lines by which the form of what is seen through reads.
const FEATURE_LINES: (&str, &[(&str, Preset)]) = ("feature-lines", &[]);

/// All words; the first is the default.
pub const ROWS: &[Row] = &[
    Row {
        word: "discard",
        spec: "Trapp §3.3",
        doc: "Occluders are not there, nor are their shadows.",
        effects: &[("eraser", &[])],
        form: None,
    },
    Row {
        word: "box",
        spec: "Trapp §3.3",
        doc: "The edges of their bounding boxes.",
        effects: &[("wireframe", &[])],
        form: BOX,
    },
    Row {
        word: "edges",
        spec: "Trapp §3.3",
        doc: "Their own edges and creases.",
        effects: &[("wireframe", &[])],
        form: None,
    },
    Row {
        word: "transparent",
        spec: "Trapp §3.3",
        doc: "Translucent, with their textures and colours.",
        effects: &[("transparent", &[("opacity", Preset::Number(0.23))])],
        form: None,
    },
    Row {
        word: "transparent-plain",
        spec: "Trapp §3.3",
        doc: "Translucent, without them.",
        effects: &[("transparent", &[("opacity", Preset::Number(0.23))]), ("clay", &[])],
        form: None,
    },
    Row {
        word: "transparent-box",
        spec: "Trapp §3.3",
        doc: "Their bounding boxes, translucent, with their edges.",
        effects: &[("transparent", &[("opacity", Preset::Number(0.14))]), ("clay", &[]), FEATURE_LINES],
        form: BOX,
    },
    Row {
        word: "x-ray",
        spec: "Trapp §3.3",
        doc: "Clear where they face the eye, denser where they are seen edge on, in their own colours, with their edges; what is behind is fainter.",
        effects: &[("x-ray", &[]), FEATURE_LINES],
        form: None,
    },
    Row {
        word: "x-ray-color",
        spec: "Trapp §3.3",
        doc: "The same in one colour.",
        effects: &[("x-ray", &[]), BLUE, FEATURE_LINES],
        form: None,
    },
    Row {
        word: "x-ray-shape",
        spec: "Trapp §3.3",
        doc: "The same of their footprints' prisms: colour and shape are left out.",
        effects: &[("x-ray", &[]), BLUE, FEATURE_LINES],
        form: PRISM,
    },
    Row {
        word: "flatten",
        spec: "Trapp §3.3",
        doc: "Pressed flat to the ground: what is seen of them from above.",
        effects: &[],
        form: FLAT,
    },
    Row {
        word: "dither",
        spec: "Trapp §3.3",
        doc: "Thinned out by a pattern of pixels.",
        effects: &[("screen-door", &[])],
        form: None,
    },
    Row {
        word: "x-ray-ramp",
        spec: "Trapp §3.3",
        doc: "As `x-ray`, in colours of a ramp, from faces that look at the eye to those seen edge on; opacity has one too.",
        effects: &[("x-ray", &[]), ("x-ray-tint", &[]), FEATURE_LINES],
        form: None,
    },
    Row {
        word: "cut-away",
        spec: "Trapp §3.3",
        doc: "What is before a point of interest is cut out of them, with a torn rim; the rest of them stays.",
        effects: &[("cut-away", &[])],
        form: None,
    },
    Row {
        word: "lod1",
        spec: "Trapp §3.3",
        doc: "Their blocks of level of detail 1, translucent and grey, with their edges; of what has none the prism over its footprint.",
        effects: &[
            ("transparent", &[("opacity", Preset::Number(0.16))]),
            ("clay", &[("color", Preset::Text("#7d8ea0"))]),
            ("feature-lines", &[("line_color", Preset::Text("#4c5863"))]),
        ],
        form: LOD1,
    },
    Row {
        word: "flatten-top",
        spec: "Trapp §3.3",
        doc: "As `flatten`, in the light in which they stood: a picture from straight above.",
        effects: &[],
        form: TOP,
    },
    Row {
        word: "flatten-film",
        spec: "Trapp §3.3",
        doc: "The same as a translucent film on the ground.",
        effects: &[("film", &[])],
        form: TOP,
    },
    Row {
        word: "flatten-soft",
        spec: "Trapp §3.3",
        doc: "The same, clear at its rim and dense inside, by how far the outline of what they cover is.",
        effects: &[("soft-film", &[])],
        form: TOP,
    },
    Row {
        word: "hull",
        spec: "Trapp §3.3",
        doc: "Their convex hulls, translucent and the colour of sand, with their edges.",
        effects: &[
            ("transparent", &[("opacity", Preset::Number(0.16))]),
            ("clay", &[("color", Preset::Text("#d9b36c"))]),
            ("feature-lines", &[("line_color", Preset::Text("#7d5a1e"))]),
        ],
        form: HULL,
    },
    Row {
        word: "low",
        spec: "Trapp §3.3",
        doc: "As high as `height` says, three metres without it, whatever their height.",
        effects: &[],
        form: LOW,
    },
];

/// Parameters by which effects choose objects: a lens has chosen already.
const OF_CHOICE: [&str; 6] = ["keep_terrain", "attribute", "values", "min", "max", "except"];

impl FormParameter {
    fn number(&self, given: &Given) -> f64 {
        match given.get(self.name) {
            Some(Parameter::Number(number)) => *number,
            _ => self.default,
        }
    }

    fn definition(&self) -> ParameterDefinition {
        let (kind, default) = match self.range {
            None => (ParameterKind::Boolean, DefaultValue::Boolean(self.default != 0.0)),
            Some([min, max]) => (ParameterKind::Number { min, max }, DefaultValue::Number(self.default)),
        };
        let (name, unit, doc) = (self.name.to_owned(), self.unit.to_owned(), self.doc.to_owned());
        ParameterDefinition { name, kind, fallback: Fallback::Value(default), unit, doc }
    }
}

impl Row {
    /// The row of a word.
    pub fn of_word(word: &str) -> Option<&'static Self> {
        ROWS.iter().find(|row| row.word == word)
    }

    /// What may be given beside the word: the parameters of its effects, but for those that choose objects, and of its form. One
    /// that several effects have goes to all of them.
    pub fn parameters(&self) -> Vec<ParameterDefinition> {
        let mut all: Vec<ParameterDefinition> = Vec::new();
        for (effect, presets) in self.effects {
            for parameter in find(effect).into_iter().flat_map(|effect| &effect.parameters) {
                let is_known = all.iter().any(|known| known.name == parameter.name);
                if is_known || OF_CHOICE.contains(&parameter.name.as_str()) {
                    continue;
                }
                let mut own = parameter.clone();
                if let Some((_, preset)) = presets.iter().find(|(name, _)| *name == own.name) {
                    own.fallback = Fallback::Value(match *preset {
                        Preset::Number(number) => DefaultValue::Number(number),
                        Preset::Text(text) => DefaultValue::Text(text.to_owned()),
                    });
                }
                all.push(own);
            }
        }
        all.extend(self.form.iter().flat_map(|form| form.parameters).map(FormParameter::definition));
        all
    }

    /// What is done to occluders, with these parameters.
    fn uses(&self, given: &Given) -> Vec<EffectUse> {
        let of = |(effect, presets): &(&str, &[(&str, Preset)])| {
            let preset = |(name, preset): &(&str, Preset)| {
                let value = match *preset {
                    Preset::Number(number) => Parameter::Number(number),
                    Preset::Text(text) => Parameter::Text(text.to_owned()),
                };
                ((*name).to_owned(), value)
            };
            let mut parameters: BTreeMap<String, Parameter> = presets.iter().map(preset).collect();
            let has = |name: &str| find(effect).is_some_and(|e| e.parameters.iter().any(|p| p.name == name));
            parameters.extend(given.iter().filter(|(name, _)| has(name)).map(|(name, v)| (name.clone(), v.clone())));
            EffectUse { effect: (*effect).into(), class: Class::Inside, blend: None, weight: None, parameters }
        };
        self.effects.iter().map(of).collect()
    }
}

/// Of which occluders something holds: of those that all of it holds of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct When {
    /// Their box comes nearer to the eye than this, metres.
    pub nearer_m: Option<f64>,
    /// They are of one of these types, as their files call them; empty: of any.
    pub types: Vec<String>,
    /// They, or parts of them, are chosen.
    pub of: Option<Choice>,
}

impl When {
    /// Whether it holds of all.
    pub fn is_always(&self) -> bool {
        *self == Self::default()
    }
}

/// One way of drawing occluders.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Of which; of those of which no case before holds.
    pub when: When,
    /// The word it was given by; `None`: by effects.
    pub word: Option<&'static str>,
    /// The parameters given beside the word.
    pub given: Given,
    /// What is done to them.
    pub effects: Vec<EffectUse>,
    /// What they are shown as; `None`: as themselves.
    pub content: Option<Content>,
}

impl Case {
    /// By a word, with these of its parameters.
    pub fn of_row(row: &Row, given: Given) -> Self {
        let content = row.form.map(|form| {
            let derive = Some(Derive { form: (form.make)(&given), parts: false });
            Content { derive, ..Content::default() }
        });
        Self { when: When::default(), word: Some(row.word), effects: row.uses(&given), given, content }
    }

    /// By effects.
    pub fn of_effects(effects: Vec<EffectUse>) -> Self {
        Self { when: When::default(), word: None, given: Given::new(), effects, content: None }
    }
}

/// How the occluders of a lens are drawn, and what they hide.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// Of each occluder the first that holds; those of which none does stay as they are.
    pub cases: Vec<Case>,
    /// What is done to the points of interest (Trapp §5.3.1).
    pub poi_effects: Vec<EffectUse>,
}

impl Default for Rendering {
    fn default() -> Self {
        Self::of_cases(vec![Case::of_row(&ROWS[0], Given::new())])
    }
}

impl Rendering {
    /// Case by case.
    pub fn of_cases(cases: Vec<Case>) -> Self {
        Self { cases, poi_effects: Vec::new() }
    }

    /// The rendering of a word.
    pub fn of_word(word: &str) -> Option<Self> {
        Row::of_word(word).map(|row| Self::of_cases(vec![Case::of_row(row, Given::new())]))
    }

    /// Of effects.
    pub fn of_effects(effects: Vec<EffectUse>) -> Self {
        Self::of_cases(vec![Case::of_effects(effects)])
    }

    /// All words.
    pub fn words() -> impl Iterator<Item = &'static str> + Clone {
        ROWS.iter().map(|row| row.word)
    }

    /// Whether all occluders are drawn in one way, and points of interest as they are.
    pub fn is_plain(&self) -> bool {
        matches!(&self.cases[..], [] | [_])
            && self.cases.iter().all(|one| one.when.is_always())
            && self.poi_effects.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::effect;

    #[test]
    fn words_differ_and_are_made_of_right_effects() {
        for (i, row) in ROWS.iter().enumerate() {
            let made = &Rendering::of_word(row.word).unwrap().cases[0];
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

    #[test]
    fn parameters_reach_what_they_are_of() {
        for row in ROWS {
            for parameter in row.parameters() {
                let doc = &parameter.doc;
                assert!(!parameter.is_required() && doc.ends_with('.'), "{}.{}", row.word, parameter.name);
                // Each number, at the ends of its range, changes what is made, unless it is the default.
                let ParameterKind::Number { min, max } = parameter.kind else { continue };
                let made = |n: f64| Case::of_row(row, [(parameter.name.clone(), Parameter::Number(n))].into());
                let (low, high) = (made(min), made(max));
                assert!(
                    (&low.effects, &low.content) != (&high.effects, &high.content),
                    "{}.{}",
                    row.word,
                    parameter.name
                );
                for used in low.effects.iter().chain(&high.effects) {
                    assert_eq!(effect::check(used), [], "{}.{}", row.word, parameter.name);
                }
            }
        }
        let names = |word| Row::of_word(word).unwrap().parameters().into_iter().map(|p| p.name).collect::<Vec<_>>();
        assert_eq!(names("discard"), ["part"]);
        let of_x_ray = ["exponent", "least", "most", "curve", "behind", "floors", "color"];
        let of_lines = ["line_color", "line_width", "faces_front", "fades"];
        assert_eq!(names("x-ray-shape"), [&of_x_ray[..], &of_lines].concat());
        assert_eq!(
            (names("transparent-box"), names("low")),
            (
                vec![
                    "opacity".into(),
                    "color".into(),
                    "line_color".into(),
                    "line_width".into(),
                    "faces_front".into(),
                    "fades".into(),
                    "oriented".into(),
                ],
                vec!["height".into()]
            )
        );
        let plain = Row::of_word("transparent").unwrap().parameters();
        assert_eq!(plain[0].fallback, Fallback::Value(DefaultValue::Number(0.23)));
    }
}
