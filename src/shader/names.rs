//! Names in modules' texts and names, as people read them.

use crate::shader::{effect::registry::handlers, plan::program::Program};

/// The effects of a program.
pub(super) fn of_effects(program: &Program) -> String {
    let names: Vec<&str> = program.effects().iter().map(|&e| handlers()[e as usize].name.as_str()).collect();
    names.join(", ")
}

/// The effects that take fragments away, behind the name of a pass.
pub(super) fn of_hidden(program: &Program) -> String {
    let has = program.has();
    let contents = has.contents.then_some("contents".to_owned());
    let contents = contents.into_iter().chain(has.moves.then_some("moving".to_owned()));
    let effects = Some(of_effects(program)).filter(|names| !names.is_empty());
    let what: Vec<String> = contents.chain(effects).collect();
    format!(" cut{} ({})", of_backend(program), what.join(", "))
}

/// The back end, where it is not the specialised one.
pub(super) fn of_backend(program: &Program) -> &'static str {
    if matches!(program, Program::Uber(_)) { " uber" } else { "" }
}

/// A text that cannot end the comment it stands in.
pub(super) fn one_line(text: &str) -> String {
    text.chars().take(60).map(|c| if c.is_control() || "\u{2028}\u{2029}".contains(c) { ' ' } else { c }).collect()
}
