//! Tokens of expressions.

use crate::query::{QueryError, Relation};

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum What {
    Open,
    Close,
    Comma,
    Range,
    Relation(Relation),
    /// A word as it stands: of the language, a name, a text, a number or a date.
    Word(String),
    /// A name in backquotes.
    Name(String),
    /// A text in quotes.
    Text(String),
}

/// A token, and the column of its first character, from 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub what: What,
    pub column: usize,
}

/// The tokens of a text.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, QueryError> {
    let all: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < all.len() {
        let (begin, next) = (at, all.get(at + 1).copied());
        let (what, length) = match (all[at], next) {
            (c, _) if c.is_whitespace() => {
                at += 1;
                continue;
            }
            ('(', _) => (What::Open, 1),
            (')', _) => (What::Close, 1),
            (',', _) => (What::Comma, 1),
            ('.', Some('.')) => (What::Range, 2),
            ('<', Some('=')) => (What::Relation(Relation::AtMost), 2),
            ('>', Some('=')) => (What::Relation(Relation::AtLeast), 2),
            ('!', Some('=')) | ('<', Some('>')) => (What::Relation(Relation::Other), 2),
            ('=', Some('=')) => (What::Relation(Relation::Equal), 2),
            ('<', _) => (What::Relation(Relation::Less), 1),
            ('>', _) => (What::Relation(Relation::More), 1),
            ('=', _) => (What::Relation(Relation::Equal), 1),
            (quote @ ('"' | '\'' | '`'), _) => quoted(&all, at, quote)?,
            (c, _) if is_of_word(c) => {
                let ends = |i: &usize| !is_of_word(all[*i]) || (all[*i] == '.' && all.get(i + 1) == Some(&'.'));
                let end = (at..all.len()).find(ends).unwrap_or(all.len());
                (What::Word(all[at..end].iter().collect()), end - at)
            }
            (c, _) => {
                let message = format!(
                    "\"{c}\" says nothing here: names with other letters stand in `backquotes`, texts in \"quotes\""
                );
                return Err(QueryError { column: at + 1, message });
            }
        };
        tokens.push(Token { what, column: begin + 1 });
        at += length.max(1);
    }
    Ok(tokens)
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '-' | '+' | '.' | ':' | '%' | '#' | '/')
}

/// What stands in quotes, and how long it is with them; a backslash keeps what follows it.
fn quoted(all: &[char], at: usize, quote: char) -> Result<(What, usize), QueryError> {
    let mut text = String::new();
    let mut i = at + 1;
    while i < all.len() && all[i] != quote {
        let is_kept = all[i] == '\\' && quote != '`' && i + 1 < all.len();
        i += usize::from(is_kept);
        text.push(all[i]);
        i += 1;
    }
    if i >= all.len() {
        return Err(QueryError { column: at + 1, message: format!("the {quote} that begins here has no end") });
    }
    let what = if quote == '`' { What::Name(text) } else { What::Text(text) };
    Ok((what, i + 1 - at))
}
