//! Functions of a WGSL text made into other functions, by their tokens.

use std::ops::Range;

use crate::shader::wgsl::token::{Token, TokenKind, tokens};

/// A function that a text was to have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no function `{name}` {expected}")]
pub struct FunctionError {
    /// Its name.
    pub name: String,
    /// The expectation that does not hold.
    pub expected: String,
}

impl FunctionError {
    fn new(name: &str, expected: impl Into<String>) -> Self {
        Self { name: name.to_owned(), expected: expected.into() }
    }
}

/// A text while some of its places get another text.
struct Editing<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    edits: Vec<(Range<usize>, &'a str)>,
}

impl<'a> Editing<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, tokens: tokens(text), edits: Vec::new() }
    }

    fn word(&self, i: usize) -> &'a str {
        self.tokens.get(i).map_or("", |token| &self.text[token.span.clone()])
    }

    /// Where a token begins; behind the last one, the end of the text.
    fn start(&self, i: usize) -> usize {
        self.tokens.get(i).map_or(self.text.len(), |token| token.span.start)
    }

    /// Leaves out some tokens and the blanks behind them.
    fn leave_out(&mut self, tokens: Range<usize>) {
        self.edits.push((self.start(tokens.start)..self.start(tokens.end), ""));
    }

    fn put(&mut self, i: usize, word: &'a str) {
        self.edits.push((self.tokens[i].span.clone(), word));
    }

    /// The token after the one that closes what the token `open` opens.
    fn after_closing(&self, open: usize) -> usize {
        let mut depth = 0_i32;
        for i in open..self.tokens.len() {
            match self.tokens[i].kind {
                TokenKind::Mark(b'(' | b'[' | b'{') => depth += 1,
                TokenKind::Mark(b')' | b']' | b'}') => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return i + 1;
            }
        }
        self.tokens.len()
    }

    fn finished(mut self) -> String {
        self.edits.sort_by_key(|(span, _)| span.start);
        let (mut out, mut copied) = (String::with_capacity(self.text.len()), 0);
        for (span, word) in self.edits {
            out.push_str(&self.text[copied..span.start]);
            out.push_str(word);
            copied = span.end;
        }
        out + &self.text[copied..]
    }
}

/// A text in which functions with the first parameter `parameter` have other names and that parameter no more: the new name stands for
/// its value. They are declared there as `fn name(parameter: TYPE, ...)` or called as `name(parameter, ...)`.
///
/// # Errors
/// A function that is not named there, or with another first parameter.
pub fn bound(text: &str, parameter: &str, names: &[(&str, String)]) -> Result<String, FunctionError> {
    let mut editing = Editing::new(text);
    for (name, new_name) in names {
        let places: Vec<usize> = (0..editing.tokens.len())
            .filter(|&i| editing.word(i) == *name && (i == 0 || editing.word(i - 1) != "."))
            .collect();
        if places.is_empty() {
            return Err(FunctionError::new(name, "is named"));
        }
        for i in places {
            let comma = if editing.word(i + 3) == ":" { i + 5 } else { i + 3 };
            let head = [i + 1, i + 2, comma].map(|k| editing.word(k));
            if head != ["(", parameter, ","] {
                return Err(FunctionError::new(
                    name,
                    format!("has a first parameter `{parameter}` wherever it is named"),
                ));
            }
            editing.put(i, new_name);
            editing.leave_out(i + 2..comma + 1);
        }
    }
    Ok(editing.finished())
}

/// A text in which an entry point is a function of another name, without the attributes of an entry point.
///
/// # Errors
/// There is no such entry point.
pub fn without_entry(text: &str, entry: &str, new_name: &str) -> Result<String, FunctionError> {
    let mut editing = Editing::new(text);
    let declared = (1..editing.tokens.len()).find(|&i| [editing.word(i - 1), editing.word(i)] == ["fn", entry]);
    let Some(name) = declared else { return Err(FunctionError::new(entry, "is declared")) };
    let stages = ["vertex", "fragment", "compute"];
    if name < 3 || editing.word(name - 3) != "@" || !stages.contains(&editing.word(name - 2)) {
        return Err(FunctionError::new(entry, "is an entry point"));
    }
    editing.leave_out(name - 3..name - 1);
    editing.put(name, new_name);
    let end = editing.after_closing(name + 1);
    let attributes: Vec<usize> = (name + 1..end).filter(|&i| editing.word(i) == "@").collect();
    for at in attributes {
        let after = if editing.word(at + 2) == "(" { editing.after_closing(at + 2) } else { at + 2 };
        editing.leave_out(at..after);
    }
    Ok(editing.finished())
}

/// Whether a text calls a function.
pub fn calls(text: &str, name: &str) -> bool {
    let all = tokens(text);
    let word = |token: &Token| &text[token.span.clone()];
    (1..all.len()).any(|i| {
        let before = i.checked_sub(2).map_or("", |k| word(&all[k]));
        word(&all[i - 1]) == name && word(&all[i]) == "(" && before != "fn" && before != "."
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_parameter_goes_into_the_name() {
        let text = "// far(lens, 1)\nfn near(lens: u32, x: f32) -> f32 { return far(lens, x.far) + f(lens); }\n";
        let names = |a: &'static str, b: &'static str| [(a, format!("{a}_2")), (b, format!("{b}_2"))];
        let expected = "// far(lens, 1)\nfn near_2(x: f32) -> f32 { return far_2(x.far) + f(lens); }\n";
        assert_eq!(bound(text, "lens", &names("near", "far")).as_deref(), Ok(expected));
        let missing = bound(text, "lens", &names("near", "nearby")).expect_err("it is not there");
        assert_eq!(missing.to_string(), "no function `nearby` is named");
        let other = bound(text, "lens", &names("near", "f")).expect_err("it has no other parameter");
        assert_eq!(other.to_string(), "no function `f` has a first parameter `lens` wherever it is named");
    }

    #[test]
    fn an_entry_point_becomes_a_function() {
        let text = "@vertex\nfn vertex(@location(0) at: vec2f, @builtin(instance_index) part: u32) -> Corner {\n}\n";
        let expected = "fn corner_of(at: vec2f, part: u32) -> Corner {\n}\n";
        assert_eq!(without_entry(text, "vertex", "corner_of").as_deref(), Ok(expected));
        assert!(without_entry(text, "fragment", "f").is_err(), "there is none");
        assert!(without_entry(expected, "corner_of", "f").is_err(), "it is none");
    }

    #[test]
    fn calls_are_told_from_names() {
        assert!(calls("let a = 1u - most() ;", "most") && calls("most (a)", "most"));
        for other in ["// most()", "fn most() {}", "let most = 1;", "almost()", "a.most()", "most_of()"] {
            assert!(!calls(other, "most"), "{other}");
        }
    }
}
