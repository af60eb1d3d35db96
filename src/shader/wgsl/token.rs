//! Tokens of a WGSL text, and what it declares at its top.

use std::ops::Range;

/// A piece of a WGSL text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Where it stands, bytes.
    pub span: Range<usize>,
    /// Its kind.
    pub kind: TokenKind,
}

/// Kinds of tokens that renaming has to tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// A name or keyword.
    Word,
    /// A number.
    Number,
    /// One character of anything else.
    Mark(u8),
}

/// The tokens of a text, without blanks and comments.
pub fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let mut out = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        let kind = match bytes[at] {
            b'/' if bytes.get(at + 1) == Some(&b'/') => {
                at += bytes[at..].iter().position(|&b| b == b'\n').unwrap_or(bytes.len() - at);
                continue;
            }
            b'/' if bytes.get(at + 1) == Some(&b'*') => {
                at = end_of_comment(bytes, at);
                continue;
            }
            b if b.is_ascii_whitespace() => {
                at += 1;
                continue;
            }
            b if b.is_ascii_alphabetic() || b == b'_' || b >= 0x80 => {
                at += bytes[at..].iter().position(|&b| !is_in_word(b)).unwrap_or(bytes.len() - at);
                TokenKind::Word
            }
            b if b.is_ascii_digit() => {
                at += bytes[at..].iter().position(|&b| !is_in_word(b) && b != b'.').unwrap_or(bytes.len() - at);
                TokenKind::Number
            }
            b => {
                at += 1;
                TokenKind::Mark(b)
            }
        };
        out.push(Token { span: start..at, kind });
    }
    out
}

fn is_in_word(b: u8) -> bool {
    b.is_ascii_alphanumeric() || b == b'_' || b >= 0x80
}

/// Where a block comment ends; they nest.
fn end_of_comment(bytes: &[u8], start: usize) -> usize {
    let (mut depth, mut at) = (0, start);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    bytes.len()
}

/// A declaration at the top of a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declaration<'a> {
    /// `fn`, `const`, `struct`, `alias`, `var`, `override`.
    pub keyword: &'a str,
    /// Its name.
    pub name: &'a str,
    /// Where the name stands.
    pub span: Range<usize>,
}

/// Declarations at the top of a text.
pub fn declarations<'a>(text: &'a str, tokens: &[Token]) -> Vec<Declaration<'a>> {
    const KEYWORDS: [&str; 6] = ["fn", "const", "struct", "alias", "var", "override"];
    let mut depth = 0_i32;
    let mut out = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Mark(b'{' | b'(' | b'[') => depth += 1,
            TokenKind::Mark(b'}' | b')' | b']') => depth -= 1,
            TokenKind::Word if depth == 0 && KEYWORDS.contains(&&text[token.span.clone()]) => {
                // `var<private> name`: the name is the first word after the angle brackets.
                let mut angles = 0;
                let name = tokens[i + 1..].iter().find(|t| {
                    match t.kind {
                        TokenKind::Mark(b'<') => angles += 1,
                        TokenKind::Mark(b'>') => angles -= 1,
                        _ => {}
                    }
                    angles == 0 && t.kind == TokenKind::Word
                });
                if let Some(name) = name {
                    let span = name.span.clone();
                    out.push(Declaration { keyword: &text[token.span.clone()], name: &text[span.clone()], span });
                }
            }
            _ => {}
        }
    }
    out
}

/// Line and column of a place, both from 1; columns count characters.
pub fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let before = &text[..at];
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
}

/// Words that name something in WGSL, of a name of a-z, 0-9 and -.
pub fn identifier(name: &str) -> String {
    name.chars().map(|c| if c == '-' { '_' } else { c }).collect()
}

/// The name of a function in the words of a type's: `FadingMembers` is `fading_members`.
pub fn snake(name: &str) -> String {
    let mut out = String::new();
    for (i, c) in name.chars().enumerate() {
        if c.is_ascii_uppercase() && i > 0 {
            out.push('_');
        }
        out.push(c.to_ascii_lowercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "// twice(1)\nconst K: f32 = 2.0e0;\nstruct Pair { twice: f32, K: f32 }\n/* a /* b */ twice */\n\
                        var<private> seen: u32;\nfn twice(x: f32) -> f32 { let p = Pair(x, K); return p.twice * K; }\n";

    #[test]
    fn declarations_are_found_at_the_top_only() {
        let names: Vec<_> = declarations(FILE, &tokens(FILE)).iter().map(|d| (d.keyword, d.name)).collect();
        assert_eq!(names, [("const", "K"), ("struct", "Pair"), ("var", "seen"), ("fn", "twice")]);
    }

    #[test]
    fn any_text_has_tokens() {
        for text in ["", "/*", "/* /*", "//", "é", "1.5e-3f", "\u{0}", "a.b.c"] {
            let all = tokens(text);
            assert!(all.iter().all(|t| t.span.end <= text.len() && t.span.start < t.span.end), "{text}");
        }
        assert_eq!(line_and_column("ab\ncé d", 7), (2, 4));
    }
}
