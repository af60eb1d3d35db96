//! Just enough of WGSL's grammar to rename what a file declares, so that two files never clash (H2).

use std::ops::Range;

use rustc_hash::{FxHashMap, FxHashSet};

/// A piece of a WGSL text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Where it stands, bytes.
    pub span: Range<usize>,
    /// What it is.
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

/// What a text declares at its top.
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

/// What a text declares at its top, each with its attributes and what stands before it, in order.
fn items<'a>(text: &'a str, tokens: &[Token]) -> Vec<(Declaration<'a>, Range<usize>)> {
    let mut named = declarations(text, tokens).into_iter().peekable();
    let mut out = Vec::new();
    let (mut depth, mut start) = (0_i32, 0);
    for (i, token) in tokens.iter().enumerate() {
        let is_end = match token.kind {
            TokenKind::Mark(b'{' | b'(' | b'[') => {
                depth += 1;
                false
            }
            TokenKind::Mark(mark @ (b'}' | b')' | b']')) => {
                depth -= 1;
                let closes = tokens.get(i + 1).is_some_and(|next| next.kind == TokenKind::Mark(b';'));
                depth == 0 && mark == b'}' && !closes
            }
            TokenKind::Mark(b';') => depth == 0,
            _ => false,
        };
        if is_end {
            if let Some(name) = named.next_if(|name| name.span.end <= token.span.end) {
                out.push((name, start..token.span.end));
            }
            start = token.span.end;
        }
    }
    out
}

/// A text with another one behind it. What the other declares as the first does is left out, resources and constants of pipelines by
/// their names alone; what else it declares under a name of the first gets another name.
pub fn merged(first: &str, other: &str) -> String {
    let words = |text: &str| -> Vec<String> { tokens(text).iter().map(|t| text[t.span.clone()].to_owned()).collect() };
    let known: FxHashMap<&str, Vec<String>> =
        items(first, &tokens(first)).into_iter().map(|(name, span)| (name.name, words(&first[span]))).collect();
    let (mut rest, mut clashes) = (String::new(), FxHashSet::default());
    for (name, span) in items(other, &tokens(other)) {
        let own = &other[span];
        match known.get(name.name) {
            Some(_) if matches!(name.keyword, "var" | "override") => continue,
            Some(same) if *same == words(own) => continue,
            Some(_) => _ = clashes.insert(name.name),
            None => {}
        }
        rest.push_str(own);
    }
    let renamed = Renamed::new(&rest, &tokens(&rest), |word| clashes.contains(word).then(|| format!("other_{word}")));
    format!("{first}{}\n", renamed.text)
}

/// A text whose names were changed, and the way back to the author's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Renamed {
    /// The new text; lines are the old ones.
    pub text: String,
    /// Where each changed name begins in the new text and in the old one, ascending.
    edits: Vec<(usize, usize)>,
}

impl Renamed {
    /// Changes the words that `rename` has an answer for, but for members (`.name`) and the fields that structs declare.
    pub fn new(text: &str, tokens: &[Token], rename: impl Fn(&str) -> Option<String>) -> Self {
        let mut out = Self { text: String::with_capacity(text.len() + text.len() / 4), edits: vec![(0, 0)] };
        let mut copied = 0;
        let mut structs = Structs::default();
        for (i, token) in tokens.iter().enumerate() {
            let word = &text[token.span.clone()];
            structs.pass(token, word);
            let before = |n: usize| i.checked_sub(n).map(|k| &tokens[k]);
            let is_after = |mark: u8| before(1).is_some_and(|t| t.kind == TokenKind::Mark(mark));
            // An address space: `ptr<function, T>`.
            let is_space = is_after(b'<') && before(2).is_some_and(|t| &text[t.span.clone()] == "ptr");
            // Nor are members and attributes names of the file.
            if token.kind != TokenKind::Word || is_after(b'.') || is_after(b'@') || is_space {
                continue;
            }
            let is_field = structs.inside && tokens.get(i + 1).is_some_and(|t| t.kind == TokenKind::Mark(b':'));
            let Some(new) = rename(word).filter(|_| !is_field) else { continue };
            out.text.push_str(&text[copied..token.span.start]);
            out.edits.push((out.text.len(), token.span.start));
            out.text.push_str(&new);
            out.edits.push((out.text.len(), token.span.end));
            copied = token.span.end;
        }
        out.text.push_str(&text[copied..]);
        out
    }

    /// Where a place of the new text stands in the old one, bytes.
    pub fn original(&self, at: usize) -> usize {
        let edit = self.edits.partition_point(|&(new, _)| new <= at).saturating_sub(1);
        let (new, old) = self.edits[edit];
        let end = self.edits.get(edit + 1).map_or(usize::MAX, |&(_, old)| old);
        (old + (at - new)).min(end)
    }
}

/// Whether a token stands in the braces of a `struct`.
#[derive(Default)]
struct Structs {
    inside: bool,
    opens: bool,
}

impl Structs {
    fn pass(&mut self, token: &Token, word: &str) {
        match token.kind {
            TokenKind::Word if word == "struct" => self.opens = true,
            TokenKind::Mark(b'{') if self.opens => (self.inside, self.opens) = (true, false),
            TokenKind::Mark(b'}') => self.inside = false,
            _ => {}
        }
    }
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
    fn names_change_and_members_comments_and_fields_do_not() {
        let names = ["K", "Pair", "twice"];
        let renamed = Renamed::new(FILE, &tokens(FILE), |w| names.contains(&w).then(|| format!("my_{w}")));
        let expected = "// twice(1)\nconst my_K: f32 = 2.0e0;\nstruct my_Pair { twice: f32, K: f32 }\n\
                        /* a /* b */ twice */\nvar<private> seen: u32;\n\
                        fn my_twice(x: f32) -> f32 { let p = my_Pair(x, my_K); return p.twice * my_K; }\n";
        assert_eq!(renamed.text, expected);
        for (i, token) in tokens(FILE).iter().enumerate() {
            let there = &tokens(&renamed.text)[i];
            assert_eq!(renamed.original(there.span.start), token.span.start, "{:?}", &FILE[token.span.clone()]);
        }
    }

    #[test]
    fn texts_are_merged_without_saying_things_twice() {
        let first = "@group(0) @binding(0) var<uniform> a: A;\nstruct A { x: f32 }\nfn f(x: f32) -> f32 { return x; }\nfn g() {}\n";
        let other = "@group(1) @binding(0) var<uniform> a: B;\n// said already\nstruct A { x: f32, }\nfn f( x: f32) -> f32 { return x; }\n\
                     fn g() -> f32 { return h.g; }\nconst K = f(1.0) + g();";
        let expected = format!(
            "{first}\n// said already\nstruct other_A {{ x: f32, }}\nfn other_g() -> f32 {{ return h.g; }}\nconst K = f(1.0) + other_g();\n"
        );
        assert_eq!(merged(first, other), expected);
        assert_eq!(merged(first, first), format!("{first}\n"));
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
