//! Expressions about objects: which of a city's are meant, by their attributes, types, ids and forms.
//!
//! ```text
//! expression = term { "or" term }
//! term       = factor { "and" factor }
//! factor     = "not" factor | "(" expression ")" | test
//! test       = name [ relation value | "in" range | "in" "(" value { "," value } ")" ]
//! relation   = "=" | "!=" | "<" | "<=" | ">" | ">=" | "contains"
//! range      = [ value ] ".." [ value ]
//! value      = number | date | word | "text"
//! name       = word | `any name`
//! ```
//!
//! A name alone asks whether an object has that attribute, and that it is not false. An attribute that an object lacks is that of what it belongs to; where that lacks
//! it, too, no relation holds, `!=` neither. Letters may be large or small, in words of the language, names and texts. `id`, `type` and `geometry.height` (metres, of the box around it
//! and all that belongs to it) are there for every object, where no attribute has that name.
//!
//! Numbers compare with texts that are numbers; with a text that is a day they compare as its year. A date, `1899`, `1899-03` or `1899-03-01`, equals what lies within it.

mod bound;
mod parser;
mod token;
mod value;

#[cfg(test)]
mod tests;

pub use bound::Bound;
pub use parser::parse;
pub use value::{Given, Literal};

/// How a value is to stand to another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// The same.
    Equal,
    /// Another one.
    Other,
    /// Less.
    Less,
    /// At most the same.
    AtMost,
    /// More.
    More,
    /// At least the same.
    AtLeast,
    /// A text that has it in it.
    Contains,
}

/// A name in an expression, and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// As it is written.
    pub text: String,
    /// The column of its first character, from 1.
    pub column: usize,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// Some of these.
    Any(Vec<Expression>),
    /// All of these.
    All(Vec<Expression>),
    /// Not this.
    Not(Box<Expression>),
    /// Has a value that is not false.
    Has(Name),
    /// Its value stands so to another one.
    Is(Name, Relation, Literal),
    /// Its value lies between two, both included; `None`: there is no end.
    Between(Name, Option<Literal>, Option<Literal>),
    /// Its value is one of these.
    OneOf(Name, Vec<Literal>),
}

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {column}: {message}")]
pub struct QueryError {
    /// The column of the first character that is wrong, from 1, characters.
    pub column: usize,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Expression {
    /// Whether it holds, where `value` gives what an object has of a name.
    pub fn holds<'a>(&self, value: &dyn Fn(&Name) -> Option<Given<'a>>) -> bool {
        match self {
            Self::Any(all) => all.iter().any(|one| one.holds(value)),
            Self::All(all) => all.iter().all(|one| one.holds(value)),
            Self::Not(one) => !one.holds(value),
            Self::Has(name) => value(name).is_some_and(|given| given != Given::Truth(false)),
            Self::Is(name, relation, literal) => value(name).is_some_and(|given| given.stands(*relation, literal)),
            Self::Between(name, low, high) => value(name).is_some_and(|given| {
                let holds =
                    |relation, end: &Option<Literal>| end.as_ref().is_none_or(|end| given.stands(relation, end));
                holds(Relation::AtLeast, low) && holds(Relation::AtMost, high)
            }),
            Self::OneOf(name, all) => {
                value(name).is_some_and(|given| all.iter().any(|one| given.stands(Relation::Equal, one)))
            }
        }
    }

    /// The names in it, in the order in which they stand.
    pub fn names(&self) -> Vec<&Name> {
        match self {
            Self::Any(all) | Self::All(all) => all.iter().flat_map(Self::names).collect(),
            Self::Not(one) => one.names(),
            Self::Has(name) | Self::Is(name, ..) | Self::Between(name, ..) | Self::OneOf(name, _) => vec![name],
        }
    }
}

impl std::fmt::Display for Relation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Equal => "=",
            Self::Other => "!=",
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::More => ">",
            Self::AtLeast => ">=",
            Self::Contains => "contains",
        })
    }
}

/// As it is written: reading that gives the same.
impl std::fmt::Display for Expression {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let joined = |f: &mut std::fmt::Formatter<'_>, all: &[Self], word: &str| {
            all.iter().enumerate().try_for_each(|(i, one)| {
                f.write_str(if i > 0 { word } else { "" })?;
                match one {
                    Self::Any(_) | Self::All(_) => write!(f, "({one})"),
                    _ => write!(f, "{one}"),
                }
            })
        };
        match self {
            Self::Any(all) => joined(f, all, " or "),
            Self::All(all) => joined(f, all, " and "),
            Self::Not(one) => match **one {
                Self::Any(_) | Self::All(_) => write!(f, "not ({one})"),
                _ => write!(f, "not {one}"),
            },
            Self::Has(name) => write!(f, "`{}`", name.text),
            Self::Is(name, relation, literal) => write!(f, "`{}` {relation} {literal}", name.text),
            Self::Between(name, low, high) => {
                write!(f, "`{}` in ", name.text)?;
                low.iter().try_for_each(|low| write!(f, "{low}"))?;
                f.write_str(" .. ")?;
                high.iter().try_for_each(|high| write!(f, "{high}"))
            }
            Self::OneOf(name, all) => {
                let all: Vec<String> = all.iter().map(Literal::to_string).collect();
                write!(f, "`{}` in ({})", name.text, all.join(", "))
            }
        }
    }
}
