//! Moments and time operators in scene files, read and written.

use std::collections::BTreeMap;

use crate::{
    figure::scene_file::{
        check::Fields,
        forms::{Form, Same, parameter, parameter_data},
        node::{Data, Node},
        reader::Reader,
    },
    lens::{Handled, Operator, Parameter},
    shader::{
        effect::{AskedBy, ParameterKind},
        effect_file::RESERVED_OF_TIME,
    },
    time::{Interval, Moment},
};

/// The key that names an operator.
const OP: &str = "op";

/// A moment as files have it: a text, a whole number or a date of TOML.
///
/// # Errors
/// What would be right.
pub fn moment(node: &Node) -> Result<Moment, String> {
    let text =
        text_of(node).ok_or_else(|| format!("must be {}, is {}", ParameterKind::Moment.describe(), node.quoted()))?;
    Interval::parse(&text)?
        .begin
        .ok_or_else(|| format!("\"{text}\" has no beginning; a time that has one would be right"))
}

/// What stands for a time, as a text.
fn text_of(node: &Node) -> Option<String> {
    match &node.data {
        Data::Text(text) => Some(text.clone()),
        Data::Date(text) => Some(text.clone()),
        // Fewer digits are more likely seconds, or a slip.
        Data::Integer(year) if (1000..=9999).contains(year) => Some(year.to_string()),
        _ => None,
    }
}

impl Form<Option<Moment>> for Same {
    fn data(value: &Option<Moment>) -> Option<Data> {
        value.map(|moment| Data::Text(moment.written()))
    }

    fn take(node: &Node, into: &mut Option<Moment>) {
        if let Ok(moment) = moment(node) {
            *into = Some(moment);
        }
    }
}

/// Time operators, one after the other.
pub fn written(steps: &[Handled]) -> Option<Data> {
    let step = |step: &Handled| {
        let parameters = step.parameters.iter().map(|(key, value)| (key.clone(), parameter_data(value)));
        Data::table(std::iter::once((OP.to_owned(), Data::text(&step.handler))).chain(parameters))
    };
    (!steps.is_empty()).then(|| Data::list(steps.iter().map(step)))
}

/// Reads those of a key; what is wrong is noted.
pub fn read(reader: &mut Reader, fields: &Fields, key: &str) -> Vec<Handled> {
    let nodes = fields.node(key).and_then(Node::list).unwrap_or_default();
    let steps = nodes.iter().enumerate().filter_map(|(i, node)| {
        let place = fields.place.within(&format!("{key}.{i}"), node.line);
        step(node)
            .map_err(|(key, message)| {
                let line = node.entry(&key).map_or(node.line, |entry| entry.line);
                reader.checker.note(&place, &key, line, message);
            })
            .ok()
    });
    steps.collect()
}

/// A step; else the key that is wrong and why.
fn step(node: &Node) -> Result<Handled, (String, String)> {
    let wrong = |key: &str, message: String| (key.to_owned(), message);
    let Data::Table(entries) = &node.data else {
        return Err(wrong("", format!("must be a table {{ op = ..., ... }}, is {}", node.quoted())));
    };
    let name =
        node.entry(OP).ok_or_else(|| wrong(OP, "is missing: which operator, e.g. \"set\" or \"shift\"".to_owned()))?;
    let name =
        name.text().ok_or_else(|| wrong(OP, format!("must be the name of a time operator, is {}", name.quoted())))?;
    let mut used = Handled { handler: name.to_owned(), parameters: BTreeMap::new() };
    let definition = used.definition(AskedBy::Times).map_err(|message| wrong(OP, message))?;
    for (key, _, value) in entries.iter().filter(|(key, ..)| key != OP) {
        let is_moment = definition.parameters.iter().any(|p| p.name == *key && p.kind == ParameterKind::Moment);
        let text = text_of(value).filter(|_| is_moment).map(Parameter::Text);
        let is_of_instants = definition.parameters.iter().any(|p| p.name == *key && p.kind == ParameterKind::Instants);
        let texts = || value.list().filter(|_| is_of_instants)?.iter().map(text_of).collect::<Option<Vec<String>>>();
        match text.or_else(|| texts().map(Parameter::Texts)).or_else(|| parameter(value)) {
            Some(value) => used.parameters.insert(key.clone(), value),
            None => return Err(wrong(key, format!("{} is no value of a parameter", value.quoted()))),
        };
    }
    if let Some(problem) = used.problems(definition, RESERVED_OF_TIME).into_iter().next() {
        return Err((problem.key, problem.message));
    }
    Operator::new(&used, 0.0).map_err(|message| wrong("", message))?;
    Ok(used)
}
