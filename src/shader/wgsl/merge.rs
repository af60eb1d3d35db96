//! Two WGSL texts as one, without saying things twice.

use std::ops::Range;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::shader::wgsl::{
    rename::Renamed,
    token::{Declaration, Token, TokenKind, declarations, tokens},
};

/// Declarations at the top of a text, each with its attributes and what stands before it, in order.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
