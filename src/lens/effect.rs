//! Uses of effects: whether they are right, and what they tell the shader. The effects themselves are files
//! ([`crate::shader::effect`]).
//!
//! A lens has at most one scene style (how surfaces are drawn); post styles run after it in list order.

use std::collections::BTreeMap;

use crate::{
    lens::{
        color::{Srgb, linear_from_srgb, parse_hex},
        effect_use::{EffectUse, Parameter},
        nearest::did_you_mean,
    },
    shader::{
        effect::{
            DefaultValue, EffectDefinition, EffectKind, Fallback, MAX_INSTANTS, MAX_LIST, MAX_RAMP,
            ParameterDefinition, ParameterKind, effects, find, named,
        },
        effect_file::RESERVED,
    },
};

/// Stands among the effects of a lens for a content in another level of detail ([`crate::lens::content::Content`]).
pub const LOD: &str = "lod";

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
    let mut problems = problems_of_parameters(definition, &used.parameters, RESERVED);
    if let (Some(min), Some(max)) = (used.number("min"), used.number("max"))
        && min >= max
    {
        problems.push(problem("min", format!("must be less than max = {max}, is {min}")));
    }
    if definition.kind.decides_visibility() {
        let does = if definition.kind == EffectKind::Hide { "hides things" } else { "says how opaque things are" };
        let blended = [("blend", used.blend.is_some()), ("weight", used.weight.is_some())];
        for (key, _) in blended.iter().filter(|(_, is_given)| *is_given) {
            problems.push(problem(key, format!("\"{}\" {does}; there is nothing to blend", used.effect)));
        }
    }
    if let Some(weight) = used.weight
        && !(0.0..=1.0).contains(&weight)
    {
        problems.push(problem("weight", format!("must be a number 0 to 1, is {weight}")));
    }
    problems
}

/// Everything wrong with the parameters of a handler: unknown, missing and unfit ones; `reserved`: keys that are no parameters.
pub fn problems_of_parameters(
    definition: &EffectDefinition,
    parameters: &BTreeMap<String, Parameter>,
    reserved: &[&str],
) -> Vec<EffectProblem> {
    let names = || definition.parameters.iter().map(|p| p.name.as_str());
    let problem = |key: &str, message: String| EffectProblem { key: key.to_owned(), message };
    let mut problems = Vec::new();
    for (key, value) in parameters {
        match definition.parameters.iter().find(|p| p.name == *key) {
            None => {
                let hint = did_you_mean(key, names().chain(reserved.iter().copied()));
                problems.push(problem(key, format!("\"{}\" has no such parameter{hint}", definition.name)));
            }
            Some(parameter) => {
                problems.extend(problem_with(&parameter.kind, value).map(|message| problem(key, message)))
            }
        }
    }
    for parameter in definition.parameters.iter().filter(|p| p.is_required() && !parameters.contains_key(&p.name)) {
        problems.push(problem(
            &parameter.name,
            format!("is missing: \"{}\" needs it ({})", definition.name, parameter.doc),
        ));
    }
    problems
}

/// What other programs and papers call effects, and what they are called here.
const OTHER_NAMES: [(&str, &str); 12] = [
    ("outline", "edges"),
    ("outlines", "edges"),
    ("contour", "edges"),
    ("contours", "edges"),
    ("silhouette", "edges"),
    ("gray", "greyscale"),
    ("grey", "greyscale"),
    ("monochrome", "greyscale"),
    ("ghost", "x-ray"),
    ("alpha", "transparent"),
    ("opacity", "transparent"),
    ("translucent", "transparent"),
];

/// The message for a name that is no effect of this version.
pub fn unknown_effect(name: &str) -> String {
    if let Some(handler) = named().find(|handler| handler.name == name) {
        let row = handler.kind.prototype();
        return format!("\"{name}\" is a {}; it would be right as the kind of {}", row.name, row.asked_by.place());
    }
    let other = OTHER_NAMES.iter().find(|(other, _)| name.eq_ignore_ascii_case(other));
    if let Some((_, own)) = other {
        return format!("there is no effect \"{name}\"; did you mean \"{own}\"?");
    }
    match did_you_mean(name, effects().map(|e| e.name.as_str())) {
        hint if hint.is_empty() => {
            format!("there is no effect \"{name}\"; effects of your own come from a folder: --effects DIR")
        }
        hint => format!("there is no effect \"{name}\"{hint}"),
    }
}

/// What is wrong with a parameter's value, if anything.
pub fn problem_with(kind: &ParameterKind, value: &Parameter) -> Option<String> {
    let expected = |what: &str| Some(format!("must be {what}, is {}", written(value)));
    match (kind, value) {
        (ParameterKind::Boolean, Parameter::Boolean(_)) | (ParameterKind::Text, Parameter::Text(_)) => None,
        (ParameterKind::Number { min, max }, Parameter::Number(n)) if n.is_finite() && (*min..=*max).contains(n) => {
            None
        }
        (ParameterKind::Word(words), Parameter::Text(text)) if words.contains(text) => None,
        (ParameterKind::Word(words), Parameter::Text(text)) => Some(format!(
            "must be one of {}, is \"{text}\"{}",
            words.join(", "),
            did_you_mean(text, words.iter().map(String::as_str))
        )),
        (ParameterKind::Color, value) if color_of(value).is_some() => None,
        (ParameterKind::Vector, Parameter::Numbers(n)) if n.len() == 3 && n.iter().all(|n| n.is_finite()) => None,
        (kind, Parameter::Text(text)) if kind.is_time() => kind.words_of_time(text).err(),
        (ParameterKind::Numbers, Parameter::Numbers(n)) => {
            let ascending = n.windows(2).all(|w| w[0] < w[1]) && n.iter().all(|n| n.is_finite());
            let fits = (1..=MAX_LIST).contains(&n.len()) && ascending;
            if fits { None } else { expected(&kind.describe()) }
        }
        (ParameterKind::Instants, Parameter::Texts(t)) if (1..=MAX_INSTANTS).contains(&t.len()) => None,
        (ParameterKind::Weights, Parameter::Numbers(n))
            if (1..=MAX_INSTANTS).contains(&n.len()) && n.iter().all(|n| n.is_finite() && *n > 0.0) =>
        {
            None
        }
        (ParameterKind::Texts, Parameter::Texts(t)) if (1..=MAX_LIST).contains(&t.len()) => None,
        (ParameterKind::Shares, Parameter::Numbers(n))
            if (1..=MAX_RAMP).contains(&n.len()) && n.iter().all(|n| (0.0..=1.0).contains(n)) =>
        {
            None
        }
        (ParameterKind::Colors, Parameter::Texts(t))
            if (1..=MAX_RAMP).contains(&t.len()) && t.iter().all(|t| parse_hex(t).is_some()) =>
        {
            None
        }
        _ => expected(&kind.describe()),
    }
}

/// The value that holds where a parameter is not given, if it has one.
pub fn default_of(parameter: &ParameterDefinition) -> Option<Parameter> {
    match &parameter.fallback {
        Fallback::Value(DefaultValue::Boolean(b)) => Some(Parameter::Boolean(*b)),
        Fallback::Value(DefaultValue::Number(n)) => Some(Parameter::Number(*n)),
        Fallback::Value(DefaultValue::Text(t)) => Some(Parameter::Text(t.clone())),
        Fallback::Value(DefaultValue::Numbers(n)) => Some(Parameter::Numbers(n.clone())),
        Fallback::Value(DefaultValue::Texts(t)) => Some(Parameter::Texts(t.clone())),
        Fallback::Required | Fallback::Words(_) => None,
    }
}

/// A ramp as shaders read it: how many steps, then the number, or the three of a linear colour, of each.
pub fn ramp(value: &Parameter) -> Vec<u32> {
    let steps: Vec<Vec<f32>> = match value {
        Parameter::Numbers(n) => n.iter().map(|n| vec![*n as f32]).collect(),
        Parameter::Texts(t) => t.iter().map(|t| linear_from_srgb(parse_hex(t).unwrap_or_default()).to_vec()).collect(),
        _ => Vec::new(),
    };
    std::iter::once(steps.len() as u32).chain(steps.concat().into_iter().map(f32::to_bits)).collect()
}

/// A value as the shader reads it: as many floats as [`ParameterKind::in_shader`] says, colours linear.
pub fn in_floats(parameter: &ParameterDefinition, value: &Parameter) -> Vec<f32> {
    match (&parameter.kind, value) {
        (ParameterKind::Boolean, Parameter::Boolean(b)) => vec![f32::from(u8::from(*b))],
        (ParameterKind::Number { min, max }, Parameter::Number(n)) => vec![n.clamp(*min, *max) as f32],
        (ParameterKind::Word(words), Parameter::Text(text)) => {
            vec![words.iter().position(|w| w == text).unwrap_or(0) as f32]
        }
        (ParameterKind::Color, value) => linear_from_srgb(color_of(value).unwrap_or_default()).to_vec(),
        (ParameterKind::Vector, Parameter::Numbers(n)) if n.len() == 3 => n.iter().map(|n| *n as f32).collect(),
        // What a scene gave to an effect that is another one now.
        (kind, _) => vec![0.0; kind.in_shader().map_or(0, |(_, floats)| floats)],
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
    /// A use of an effect with every parameter at its default, on what is inside.
    pub fn new(effect: &str) -> Self {
        let class = crate::lens::class::Class::default();
        Self { effect: effect.into(), class, blend: None, weight: None, parameters: BTreeMap::new() }
    }

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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(effect: &str, parameters: &[(&str, Parameter)]) -> Vec<EffectProblem> {
        let parameters = parameters.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect();
        check(&EffectUse { effect: effect.into(), class: Default::default(), blend: None, weight: None, parameters })
    }

    #[test]
    fn the_table_is_well_formed() {
        for effect in effects() {
            assert!(effect.doc.ends_with('.') && !effect.spec.is_empty());
            for p in &effect.parameters {
                assert!(p.doc.ends_with('.') && !RESERVED.contains(&p.name.as_str()), "{}.{}", effect.name, p.name);
                // The shader reads every parameter, so every one has a value.
                let reads = effect.shader_parameters().any(|(read, ..)| read.name == p.name);
                assert!(!reads || p.is_required() || default_of(p).is_some(), "{}.{}", effect.name, p.name);
            }
        }
        let ramps = &find("thematic").unwrap().parameters.iter().find(|p| p.name == "ramp").unwrap().kind;
        assert_eq!(*ramps, ParameterKind::Word(crate::lens::ramp::NAMES.iter().map(|n| (*n).to_owned()).collect()));
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
        assert_eq!(message(with("outline", &[])), "effect: there is no effect \"outline\"; did you mean \"edges\"?");
        for (other, own) in OTHER_NAMES {
            assert!(effects().any(|e| e.name == own) && !effects().any(|e| e.name == other), "{other}");
        }
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
