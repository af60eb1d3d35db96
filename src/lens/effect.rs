//! The table of effects: names, kinds, parameters; what scene files, help and the renderer read.
//!
//! A lens has at most one scene style (K1: how surfaces are drawn); post styles run after it in list order (K3).

use crate::lens::{
    EffectUse, Parameter,
    color::{Srgb, parse_hex},
    nearest::did_you_mean,
    ramp,
};

/// How an effect takes part in the picture (K1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectKind {
    /// Gives surfaces their colour, before light.
    SceneStyle,
    /// Changes the colour of the lit picture.
    PostStyle,
}

impl EffectKind {
    /// As people read it.
    pub fn name(self) -> &'static str {
        match self {
            Self::SceneStyle => "scene style",
            Self::PostStyle => "post style",
        }
    }
}

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterKind {
    /// `true` or `false`.
    Boolean,
    /// A number within the closed range.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// Any text.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// `"#rrggbb"` or `[r, g, b]`, sRGB 0..1.
    Color,
    /// Finite numbers, ascending, at most [`MAX_LIST`].
    Numbers,
    /// Texts, at most [`MAX_LIST`].
    Texts,
}

/// Longest list a parameter takes.
pub const MAX_LIST: usize = 256;

/// One parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterDefinition {
    /// Its key.
    pub name: &'static str,
    /// What it takes.
    pub kind: ParameterKind,
    /// What holds where it is not given, in words or as TOML.
    pub default: &'static str,
    /// Whether the effect does nothing without it.
    pub required: bool,
    /// Unit, or empty.
    pub unit: &'static str,
    /// What it does.
    pub doc: &'static str,
}

/// One effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectDefinition {
    /// Its name in scene files.
    pub name: &'static str,
    /// Scene style or post style.
    pub kind: EffectKind,
    /// The requirement it fulfils.
    pub spec: &'static str,
    /// What it does, one sentence.
    pub doc: &'static str,
    /// Its parameters.
    pub parameters: &'static [ParameterDefinition],
}

const AMOUNT: ParameterDefinition = ParameterDefinition {
    name: "amount",
    kind: ParameterKind::Number { min: 0.0, max: 1.0 },
    default: "1.0",
    required: false,
    unit: "",
    doc: "How much of the effect: 0 = none, 1 = all of it.",
};

const fn optional(
    name: &'static str,
    kind: ParameterKind,
    default: &'static str,
    unit: &'static str,
    doc: &'static str,
) -> ParameterDefinition {
    ParameterDefinition { name, kind, default, required: false, unit, doc }
}

const ANY_NUMBER: ParameterKind = ParameterKind::Number { min: f64::MIN, max: f64::MAX };

const THEMATIC: &[ParameterDefinition] = &[
    ParameterDefinition {
        name: "attribute",
        kind: ParameterKind::Text,
        default: "none",
        required: true,
        unit: "",
        doc: "Name of the attribute; an object without it takes its parent's.",
    },
    optional("ramp", ParameterKind::Word(ramp::NAMES), "\"viridis\"", "", "Colours of numbers, low to high."),
    optional("reverse", ParameterKind::Boolean, "false", "", "Turns the ramp around."),
    optional(
        "scale",
        ParameterKind::Word(&["continuous", "equal", "quantile"]),
        "\"continuous\"",
        "",
        "Numbers: a smooth ramp, classes of equal width, or classes of equally many objects.",
    ),
    optional("classes", ParameterKind::Number { min: 2.0, max: 12.0 }, "5", "classes", "How many classes."),
    optional(
        "breaks",
        ParameterKind::Numbers,
        "none",
        "the attribute's",
        "Own class borders, ascending; a value on a border belongs to the upper class.",
    ),
    optional(
        "min",
        ANY_NUMBER,
        "the smallest value",
        "the attribute's",
        "Where the ramp begins; lower values take its first colour.",
    ),
    optional(
        "max",
        ANY_NUMBER,
        "the largest value",
        "the attribute's",
        "Where the ramp ends; higher values take its last colour.",
    ),
    optional(
        "categories",
        ParameterKind::Texts,
        "most frequent first",
        "",
        "Treats values as categories, in this order; others are drawn as `other`.",
    ),
    optional("no_data", ParameterKind::Color, "\"#a8a8a8\"", "", "Colour of objects without a value."),
    optional("threshold", ANY_NUMBER, "none", "the attribute's", "Numbers at or above it take the colour `highlight`."),
    optional("highlight", ParameterKind::Color, "\"#d55e00\"", "", "Colour of numbers at or above `threshold`."),
];

/// All effects of this version.
pub const EFFECTS: &[EffectDefinition] = &[
    EffectDefinition {
        name: "greyscale",
        kind: EffectKind::PostStyle,
        spec: "K3",
        doc: "Keeps lightness (Rec. 709 luminance), drops colour.",
        parameters: &[AMOUNT],
    },
    EffectDefinition {
        name: "sepia",
        kind: EffectKind::PostStyle,
        spec: "K3",
        doc: "The brown of old photographs.",
        parameters: &[AMOUNT],
    },
    EffectDefinition {
        name: "thematic",
        kind: EffectKind::SceneStyle,
        spec: "K2",
        doc: "Colours objects by an attribute; light changes lightness alone, hue and chroma stay the legend's.",
        parameters: THEMATIC,
    },
];

/// Effects whose names are fixed but which this version does not have.
pub const LATER: &[&str] =
    &["invert", "darken", "blur", "flat", "cel", "gooch", "wireframe", "hidden-line", "eraser", "x-ray", "lod"];

/// Keys of an effect table that are not parameters.
pub const RESERVED: &[&str] = &["effect", "class"];

/// The definition of the effect called `name`.
pub fn find(name: &str) -> Option<&'static EffectDefinition> {
    EFFECTS.iter().find(|e| e.name == name)
}

/// Something wrong with a use of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectProblem {
    /// The parameter, or `effect`.
    pub key: String,
    /// What is wrong, and what would be right.
    pub message: String,
}

/// Everything wrong with a use of an effect: its name, unknown, missing and unfit parameters.
pub fn check(used: &EffectUse) -> Vec<EffectProblem> {
    let problem = |key: &str, message: String| EffectProblem { key: key.to_owned(), message };
    let Some(definition) = find(&used.effect) else {
        return vec![problem("effect", unknown_effect(&used.effect))];
    };
    let names = || definition.parameters.iter().map(|p| p.name);
    let mut problems = Vec::new();
    for (key, value) in &used.parameters {
        match definition.parameters.iter().find(|p| p.name == key) {
            None => {
                let hint = did_you_mean(key, names().chain(RESERVED.iter().copied()));
                problems.push(problem(key, format!("\"{}\" has no such parameter{hint}", used.effect)));
            }
            Some(parameter) => problems.extend(parameter.kind.check(value).map(|message| problem(key, message))),
        }
    }
    for parameter in definition.parameters.iter().filter(|p| p.required && !used.parameters.contains_key(p.name)) {
        problems.push(problem(parameter.name, format!("is missing: \"{}\" needs it ({})", used.effect, parameter.doc)));
    }
    if let (Some(min), Some(max)) = (used.number("min"), used.number("max"))
        && min >= max
    {
        problems.push(problem("min", format!("must be less than max = {max}, is {min}")));
    }
    problems
}

/// The message for a name that is no effect of this version.
pub fn unknown_effect(name: &str) -> String {
    if LATER.contains(&name) {
        let all: Vec<&str> = EFFECTS.iter().map(|e| e.name).collect();
        return format!("effect = \"{name}\" is not available yet; available: {}", all.join(", "));
    }
    format!("there is no effect \"{name}\"{}", did_you_mean(name, EFFECTS.iter().map(|e| e.name)))
}

impl ParameterKind {
    /// What is wrong with `value`, if anything.
    pub fn check(&self, value: &Parameter) -> Option<String> {
        let expected = |what: &str| Some(format!("must be {what}, is {}", written(value)));
        match (self, value) {
            (Self::Boolean, Parameter::Boolean(_)) | (Self::Text, Parameter::Text(_)) => None,
            (Self::Boolean, _) => expected("true or false"),
            (Self::Text, _) => expected("a text"),
            (Self::Number { min, max }, Parameter::Number(n)) if n.is_finite() && (*min..=*max).contains(n) => None,
            (Self::Number { .. }, _) => expected(&self.describe()),
            (Self::Word(words), Parameter::Text(text)) if words.contains(&text.as_str()) => None,
            (Self::Word(words), Parameter::Text(text)) => Some(format!(
                "must be one of {}, is \"{text}\"{}",
                words.join(", "),
                did_you_mean(text, words.iter().copied())
            )),
            (Self::Color, value) if color_of(value).is_some() => None,
            (Self::Numbers, Parameter::Numbers(n)) => {
                let ascending = n.windows(2).all(|w| w[0] < w[1]) && n.iter().all(|n| n.is_finite());
                let fits = (1..=MAX_LIST).contains(&n.len()) && ascending;
                if fits { None } else { expected(&self.describe()) }
            }
            (Self::Texts, Parameter::Texts(t)) if (1..=MAX_LIST).contains(&t.len()) => None,
            _ => expected(&self.describe()),
        }
    }

    /// What it takes, as people read it.
    pub fn describe(&self) -> String {
        match self {
            Self::Boolean => "true or false".into(),
            Self::Number { min, max } if *min == f64::MIN && *max == f64::MAX => "a finite number".into(),
            Self::Number { min, max } => format!("a number {min} to {max}"),
            Self::Text => "a text".into(),
            Self::Word(words) => format!("one of {}", words.join(", ")),
            Self::Color => "a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Numbers => format!("1 to {MAX_LIST} ascending numbers"),
            Self::Texts => format!("1 to {MAX_LIST} texts"),
        }
    }
}

fn written(value: &Parameter) -> String {
    match value {
        Parameter::Boolean(b) => b.to_string(),
        Parameter::Number(n) => n.to_string(),
        Parameter::Text(t) => format!("\"{t}\""),
        Parameter::Numbers(n) => format!("{:?}", &n[..n.len().min(8)]),
        Parameter::Texts(t) => format!("{:?}", &t[..t.len().min(8)]),
    }
}

/// The colour a parameter means.
pub fn color_of(value: &Parameter) -> Option<Srgb> {
    match value {
        Parameter::Text(text) => parse_hex(text),
        Parameter::Numbers(n) => match n[..] {
            [r, g, b] if [r, g, b].iter().all(|c| (0.0..=1.0).contains(c)) => Some([r as f32, g as f32, b as f32]),
            _ => None,
        },
        _ => None,
    }
}

/// Typed reading; `None` where not given or of another type.
impl EffectUse {
    /// A number.
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.parameters.get(key) {
            Some(Parameter::Number(n)) => Some(*n),
            _ => None,
        }
    }

    /// A text or word.
    pub fn text(&self, key: &str) -> Option<&str> {
        match self.parameters.get(key) {
            Some(Parameter::Text(t)) => Some(t),
            _ => None,
        }
    }

    /// Yes or no.
    pub fn boolean(&self, key: &str) -> Option<bool> {
        match self.parameters.get(key) {
            Some(Parameter::Boolean(b)) => Some(*b),
            _ => None,
        }
    }

    /// A colour, sRGB.
    pub fn color(&self, key: &str) -> Option<Srgb> {
        self.parameters.get(key).and_then(color_of)
    }

    /// How much of the effect, 0..=1; 1 where not given.
    pub fn amount(&self) -> f32 {
        self.number("amount").unwrap_or(1.0).clamp(0.0, 1.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(effect: &str, parameters: &[(&str, Parameter)]) -> Vec<EffectProblem> {
        let parameters = parameters.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect();
        check(&EffectUse { effect: effect.into(), class: Default::default(), parameters })
    }

    #[test]
    fn the_table_is_well_formed() {
        for effect in EFFECTS {
            assert!(effect.doc.ends_with('.') && !effect.spec.is_empty() && !LATER.contains(&effect.name));
            for p in effect.parameters {
                assert!(p.doc.ends_with('.') && !p.default.is_empty(), "{}.{}", effect.name, p.name);
                assert!(!RESERVED.contains(&p.name));
            }
        }
    }

    #[test]
    fn good_uses_pass() {
        assert_eq!(with("sepia", &[]), []);
        assert_eq!(with("sepia", &[("amount", Parameter::Number(0.5))]), []);
        let thematic = [
            ("attribute", Parameter::Text("height".into())),
            ("breaks", Parameter::Numbers(vec![1.0, 2.0])),
            ("no_data", Parameter::Numbers(vec![0.5, 0.5, 1.0])),
        ];
        assert_eq!(with("thematic", &thematic), []);
    }

    #[test]
    fn each_fault_is_named() {
        let message =
            |problems: Vec<EffectProblem>| problems.first().map(|p| format!("{}: {}", p.key, p.message)).unwrap();
        assert_eq!(message(with("sepai", &[])), "effect: there is no effect \"sepai\"; did you mean \"sepia\"?");
        assert!(message(with("x-ray", &[])).starts_with("effect: effect = \"x-ray\" is not available yet"));
        assert!(message(with("thematic", &[])).starts_with("attribute: is missing"));
        assert_eq!(
            message(with("sepia", &[("amonut", Parameter::Number(1.0))])),
            "amonut: \"sepia\" has no such parameter; did you mean \"amount\"?"
        );
        assert_eq!(
            message(with("sepia", &[("amount", Parameter::Number(7.0))])),
            "amount: must be a number 0 to 1, is 7"
        );
        assert!(!with("sepia", &[("amount", Parameter::Number(f64::NAN))]).is_empty());
        let attribute = ("attribute", Parameter::Text("a".into()));
        for (key, value) in [
            ("breaks", Parameter::Numbers(vec![2.0, 1.0])),
            ("breaks", Parameter::Numbers(vec![])),
            ("ramp", Parameter::Text("virids".into())),
            ("no_data", Parameter::Text("red".into())),
            ("classes", Parameter::Number(1.0)),
        ] {
            assert_eq!(with("thematic", &[attribute.clone(), (key, value)]).len(), 1, "{key}");
        }
        let swapped = [attribute, ("min", Parameter::Number(3.0)), ("max", Parameter::Number(2.0))];
        assert_eq!(message(with("thematic", &swapped)), "min: must be less than max = 2, is 3");
    }
}
