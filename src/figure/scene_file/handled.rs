//! Users' handlers in scene files: tables of `kind`, the handler's name, and its parameters.

use crate::{
    figure::scene_file::{
        check::Place,
        forms::{parameter, parameter_data},
        node::{Data, Node},
        reader::Reader,
    },
    lens::Handled,
    shader::effect::AskedBy,
};

/// The key that names a handler, which is no parameter.
const KIND: &str = "kind";

/// The use of a handler that a table names; `None`: there is none of that name. What is wrong with its parameters is noted.
pub fn read(reader: &mut Reader, node: &Node, place: &Place, asked_by: AskedBy) -> Option<Handled> {
    read_beside(reader, node, place, asked_by, &[KIND])
}

/// The same of a table that has keys of others, too.
pub fn read_beside(
    reader: &mut Reader,
    node: &Node,
    place: &Place,
    asked_by: AskedBy,
    others: &[&str],
) -> Option<Handled> {
    let Data::Table(entries) = &node.data else { return None };
    let mut used = Handled::named(node.entry(KIND)?.text()?);
    let definition = used.definition(asked_by).ok()?;
    for (key, line, value) in entries.iter().filter(|(key, ..)| !others.contains(&key.as_str())) {
        match parameter(value) {
            Some(value) => {
                used.parameters.insert(key.clone(), value);
            }
            None => reader.checker.note(place, key, *line, format!("{} is no value of a parameter", value.quoted())),
        }
    }
    for problem in used.problems(definition, others) {
        let line = entries.iter().find(|(key, ..)| *key == problem.key).map_or(node.line, |(_, line, _)| *line);
        reader.checker.note(place, &problem.key, line, problem.message);
    }
    Some(used)
}

/// The use of a handler that a table must name; what is wrong is noted.
pub fn required(reader: &mut Reader, node: &Node, place: &Place, asked_by: AskedBy) -> Option<Handled> {
    let used = read(reader, node, place, asked_by);
    if used.is_none() {
        let name = node.entry(KIND).and_then(Node::text).unwrap_or_default().to_owned();
        let message = match Handled::named(&name).definition(asked_by) {
            Err(message) if !name.is_empty() => message,
            _ => "is missing: the name of a handler of your own".to_owned(),
        };
        let line = node.entry(KIND).map_or(node.line, |kind| kind.line);
        reader.checker.note(place, KIND, line, message);
    }
    used
}

/// A use as files have it.
pub fn written(used: &Handled) -> Data {
    let parameters = used.parameters.iter().map(|(key, value)| (key.clone(), parameter_data(value)));
    Data::table(std::iter::once((KIND.to_owned(), Data::text(&used.handler))).chain(parameters))
}

/// The same with the keys of others.
pub fn written_over(used: &Handled, others: Data) -> Data {
    let (Data::Table(mut own), Data::Table(others)) = (written(used), others) else { unreachable!("both are tables") };
    // Behind its name.
    own.splice(1..1, others);
    Data::Table(own)
}
