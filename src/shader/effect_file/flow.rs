//! Control flow of users' effects: loops that end, and no pixel taken away.

use crate::shader::{
    effect_file::error::{File, FileError},
    wgsl::token::{self, Token, TokenKind},
};

/// Rounds of one loop.
const MOST_ROUNDS: u32 = 1024;

/// Refuses what may never end, or leave a hole: `loop`, `while`, `discard`, and `for` but for
/// `for (var i = NUMBER; i < NUMBER; i++)` whose body leaves `i` alone.
pub(super) fn check_control_flow(file: &File) -> Result<(), FileError> {
    let tokens = token::tokens(file.text);
    let word = |i: usize| tokens.get(i).map_or("", |t: &Token| &file.text[t.span.clone()]);
    for (i, token) in tokens.iter().enumerate().filter(|(_, t)| t.kind == TokenKind::Word) {
        let error = |message: &str| Err(file.error(token.span.start, message));
        match word(i) {
            "loop" | "while" => {
                return error("it may never end; expected for (var i = 0; i < NUMBER; i++), or no loop");
            }
            "discard" => {
                return error(
                    "an effect cannot take the pixel away; kind = \"hide\" returns true where something is hidden",
                );
            }
            "for" if !is_bounded(&tokens, i, &word) => {
                let message = format!(
                    "expected for (var i = NUMBER; i < NUMBER; i++) of at most {MOST_ROUNDS} rounds, whose body \
                     leaves i alone"
                );
                return error(&message);
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether the `for` at token `i` counts a variable of its own from one number up to another.
fn is_bounded<'a>(tokens: &[Token], i: usize, word: &impl Fn(usize) -> &'a str) -> bool {
    let name = word(i + 3);
    let head = ["for", "(", "var", name, "=", word(i + 5), ";", name, "<", word(i + 9), ";", name, "+", "+", ")", "{"];
    let integer = |text: &str| text.trim_end_matches(['u', 'i']).parse::<u32>().ok();
    let (Some(from), Some(to)) = (integer(word(i + 5)), integer(word(i + 9))) else { return false };
    if !(0..head.len()).all(|k| word(i + k) == head[k]) || to.saturating_sub(from) > MOST_ROUNDS {
        return false;
    }
    // Up to the brace that closes the body, the variable is not assigned to, and its address is not taken.
    let mut depth = 1;
    for k in i + head.len()..tokens.len() {
        match word(k) {
            "{" => depth += 1,
            "}" => depth -= 1,
            w if w == name && word(k - 1) != "." => {
                let assigns = match (word(k + 1), word(k + 2)) {
                    ("=", next) => next != "=",
                    ("+", "+" | "=") | ("-", "-" | "=") | ("*" | "/" | "%" | "&" | "|" | "^", "=") => true,
                    ("<", "<") | (">", ">") => word(k + 3) == "=",
                    _ => false,
                };
                if assigns || word(k - 1) == "&" {
                    return false;
                }
            }
            _ => {}
        }
        if depth == 0 {
            return true;
        }
    }
    false
}
