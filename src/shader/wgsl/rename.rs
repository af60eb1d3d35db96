//! Other names for what a WGSL text declares, so that two files never clash.

use crate::shader::wgsl::token::{Token, TokenKind};

/// A text with changed names, and the way back to the author's places.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::wgsl::token::tokens;

    const FILE: &str = "// twice(1)\nconst K: f32 = 2.0e0;\nstruct Pair { twice: f32, K: f32 }\n/* a /* b */ twice */\n\
                        var<private> seen: u32;\nfn twice(x: f32) -> f32 { let p = Pair(x, K); return p.twice * K; }\n";

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
}
