//! Headers of effect files: TOML, as serde reads it.

use serde::Deserialize;
use toml::Spanned;

use crate::shader::effect::{
    definition::{Amount, PerObject},
    parameter::{DefaultValue, Fallback, MAX_RAMP, ParameterDefinition, ParameterKind},
    prototype::{EffectKind, Mode},
};

/// Pixels that a filter reaches to either side.
pub const MOST_REACH: u32 = 64;
/// Pixels that a line may be wide.
pub const MOST_LINE_WIDTH: f64 = 64.0;
/// Keys of a use of an effect that are no parameters.
pub const RESERVED: &[&str] = &["effect", "class", "blend", "weight"];
/// Keys of a step of `time` that are no parameters.
pub const RESERVED_OF_TIME: &[&str] = &["op"];

/// The header of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    pub(super) name: Spanned<String>,
    pub(super) kind: EffectKind,
    /// Without it the prototype's own.
    pub(super) mode: Option<Mode>,
    pub(super) spec: String,
    pub(super) doc: String,
    pub(super) objects: Option<PerObject>,
    #[serde(default)]
    pub(super) lines: bool,
    /// Whether its function gives its derivative.
    #[serde(default)]
    pub(super) derivative: bool,
    pub(super) reach: Option<Spanned<Amount>>,
    pub(super) detail: Option<Spanned<Amount>>,
    #[serde(default, rename = "parameter")]
    pub(super) parameters: Vec<ParameterHeader>,
}

/// One parameter in a header.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ParameterHeader {
    pub(super) name: Spanned<String>,
    r#type: Spanned<TypeName>,
    range: Option<Spanned<[f64; 2]>>,
    words: Option<Vec<String>>,
    default: Option<Spanned<DefaultValue>>,
    without: Option<String>,
    #[serde(default)]
    required: bool,
    #[serde(default)]
    unit: String,
    doc: String,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum TypeName {
    Boolean,
    Number,
    Text,
    Word,
    Color,
    Vector,
    Numbers,
    Texts,
    Shares,
    Colors,
    Moment,
    Span,
    Unit,
    Clock,
    Instants,
    Weights,
}

/// Parameters that more than one effect has.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SharedParameters {
    #[serde(rename = "parameter")]
    pub(super) parameters: Vec<ParameterHeader>,
}

/// Those by which effects choose objects ([`PerObject::Chosen`]).
pub(super) const CHOICE: &str = include_str!("../../../shaders/effect/choice.toml");

impl ParameterHeader {
    /// The definition, or a mistake and its place in the header.
    pub(super) fn definition(self) -> Result<ParameterDefinition, (Option<std::ops::Range<usize>>, String)> {
        let span = Some(self.r#type.span());
        let wrong = |message: &str| Err((span.clone(), message.to_owned()));
        let type_name = *self.r#type.get_ref();
        if self.range.is_some() && type_name != TypeName::Number {
            return wrong("only numbers have a range");
        }
        let kind = match (type_name, self.words) {
            (TypeName::Word, Some(words)) if !words.is_empty() && words.iter().all(|w| is_effect_name(w)) => {
                ParameterKind::Word(words)
            }
            (TypeName::Word, _) => return wrong("expected words = [...], each of a-z, 0-9 and -"),
            (_, Some(_)) => return wrong("only type = \"word\" has words"),
            (TypeName::Boolean, None) => ParameterKind::Boolean,
            (TypeName::Text, None) => ParameterKind::Text,
            (TypeName::Color, None) => ParameterKind::Color,
            (TypeName::Vector, None) => ParameterKind::Vector,
            (TypeName::Numbers, None) => ParameterKind::Numbers,
            (TypeName::Texts, None) => ParameterKind::Texts,
            (TypeName::Shares, None) => ParameterKind::Shares,
            (TypeName::Colors, None) => ParameterKind::Colors,
            (TypeName::Moment, None) => ParameterKind::Moment,
            (TypeName::Span, None) => ParameterKind::Span,
            (TypeName::Unit, None) => ParameterKind::Unit,
            (TypeName::Clock, None) => ParameterKind::Clock,
            (TypeName::Instants, None) => ParameterKind::Instants,
            (TypeName::Weights, None) => ParameterKind::Weights,
            (TypeName::Number, None) => match self.range.map(Spanned::into_inner) {
                None => ParameterKind::Number { min: f64::MIN, max: f64::MAX },
                Some([min, max]) if min < max => ParameterKind::Number { min, max },
                Some(_) => return wrong("expected range = [LOW, HIGH] with LOW < HIGH"),
            },
        };
        let fallback = match (self.required, self.default, self.without) {
            (true, None, None) => Fallback::Required,
            (false, Some(value), None) => {
                let (place, value) = (value.span(), value.into_inner());
                if !takes(&kind, &value) {
                    return Err((Some(place), format!("the default must be {}", kind.describe())));
                }
                Fallback::Value(value)
            }
            (false, None, Some(words)) => Fallback::Words(words),
            _ => return wrong("expected one of default = VALUE, without = \"WHAT HOLDS THEN\" and required = true"),
        };
        Ok(ParameterDefinition { name: self.name.into_inner(), kind, fallback, unit: self.unit, doc: self.doc })
    }
}

/// Whether a parameter of this kind may have this default.
fn takes(kind: &ParameterKind, value: &DefaultValue) -> bool {
    match (kind, value) {
        (ParameterKind::Boolean, DefaultValue::Boolean(_)) | (ParameterKind::Text, DefaultValue::Text(_)) => true,
        (ParameterKind::Number { min, max }, DefaultValue::Number(n)) => (*min..=*max).contains(n),
        (ParameterKind::Word(words), DefaultValue::Text(text)) => words.contains(text),
        (ParameterKind::Color, DefaultValue::Text(text)) => is_color(text),
        (ParameterKind::Vector, DefaultValue::Numbers(list)) => list.len() == 3,
        (kind, DefaultValue::Text(text)) if kind.is_time() => kind.words_of_time(text).is_ok(),
        (ParameterKind::Colors, DefaultValue::Texts(list)) => is_ramp(list.len()) && list.iter().all(|t| is_color(t)),
        (ParameterKind::Shares, DefaultValue::Numbers(list)) => {
            is_ramp(list.len()) && list.iter().all(|n| (0.0..=1.0).contains(n))
        }
        _ => false,
    }
}

fn is_ramp(count: usize) -> bool {
    (1..=MAX_RAMP).contains(&count)
}

fn is_color(text: &str) -> bool {
    text.len() == 7 && text.starts_with('#') && text[1..].bytes().all(|b| b.is_ascii_hexdigit())
}

pub(super) fn is_effect_name(name: &str) -> bool {
    name.len() <= 40
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-')
        && !name.contains("--")
        && !name.ends_with('-')
}

pub(super) fn is_parameter_name(name: &str) -> bool {
    name.len() <= 40
        && !RESERVED.contains(&name)
        && !RESERVED_OF_TIME.contains(&name)
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}
