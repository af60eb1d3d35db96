//! Costs of users' effects: loops and calls multiplied out.

use crate::shader::{
    effect_file::error::{File, FileError},
    wgsl::token::{self, Declaration, Token, TokenKind},
};

/// Words and marks that `effect` may run through for one pixel, loops and calls multiplied out.
const MOST_STEPS: u64 = 1_000_000;

/// Refuses effects that end, but far too late: loops in loops, and functions that call the next one twice.
pub(super) fn check_cost(file: &File) -> Result<(), FileError> {
    let tokens = token::tokens(file.text);
    let declared = token::declarations(file.text, &tokens);
    let mut costs = Costs { file, tokens: &tokens, declared: &declared, known: Vec::new() };
    for declaration in declared.iter().filter(|d| d.keyword == "fn") {
        if costs.of(declaration.name, 0).is_none_or(|cost| cost > MOST_STEPS) {
            let message = format!("this takes more than {MOST_STEPS} steps per pixel, or calls itself");
            return Err(file.error(declaration.span.start, message));
        }
    }
    Ok(())
}

/// Costs of the functions of a file.
struct Costs<'a> {
    file: &'a File<'a>,
    tokens: &'a [Token],
    declared: &'a [Declaration<'a>],
    known: Vec<(&'a str, u64)>,
}

impl<'a> Costs<'a> {
    /// Steps of one call; `None` for one that calls itself.
    fn of(&mut self, name: &'a str, depth: usize) -> Option<u64> {
        if let Some((_, cost)) = self.known.iter().find(|(known, _)| *known == name) {
            return Some(*cost);
        }
        // Deeper than there are functions: one calls itself.
        if depth > self.declared.len() {
            return None;
        }
        let begin = self.declared.iter().find(|d| d.keyword == "fn" && d.name == name)?.span.end;
        let first = self.tokens.partition_point(|t| t.span.start < begin);
        let (mut cost, mut rounds) = (0_u64, Vec::new());
        let mut pending = None;
        for (i, token) in self.tokens.iter().enumerate().skip(first) {
            let text = self.file.text;
            let word = &text[token.span.clone()];
            let times = rounds.iter().copied().fold(1, u64::saturating_mul);
            cost = cost.saturating_add(times);
            match word {
                "for" => {
                    let number = |k: usize| self.tokens.get(i + k).map_or("0", |t| &text[t.span.clone()]);
                    let integer = |text: &str| text.trim_end_matches(['u', 'i']).parse::<u64>().unwrap_or(0);
                    pending = Some(integer(number(9)).saturating_sub(integer(number(5))));
                }
                "{" => rounds.push(pending.take().unwrap_or(1)),
                "}" => {
                    rounds.pop();
                    if rounds.is_empty() {
                        break;
                    }
                }
                _ => {
                    let callee = self.declared.iter().find(|d| d.keyword == "fn" && d.name == word);
                    if let (TokenKind::Word, Some(callee)) = (token.kind, callee) {
                        cost = cost.saturating_add(times.saturating_mul(self.of(callee.name, depth + 1)?));
                    }
                }
            }
        }
        self.known.push((name, cost));
        Some(cost)
    }
}
