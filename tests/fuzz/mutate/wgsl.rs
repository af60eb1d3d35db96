//! Effect files: the TOML of their headers, and the tokens of their WGSL.

use std::ops::Range;

use veduta::shader::wgsl::token::{self, Token, TokenKind};

use super::{
    change_number,
    tree::{Pool, change_toml},
    words::{NUMBERS, WORDS_OF_WGSL},
};
use crate::studio::random_scene::Random;

/// The most tokens that are doubled at once, and copies that are made.
const MOST_TOKENS: usize = 60;
const COPIES: &[usize] = &[1, 2, 3, 30, 2000];

/// The TOML of a file's header.
pub fn header(text: &str) -> String {
    let lines = text.lines().map_while(|line| line.strip_prefix("//!"));
    lines.map(|line| format!("{}\n", line.trim_start())).collect()
}

/// What stands between empty lines, where it is a declaration.
pub fn declarations(text: &str) -> Vec<String> {
    let begins = |text: &&str| ["fn ", "const ", "struct ", "alias "].iter().any(|word| text.starts_with(word));
    text.split("\n\n").map(str::trim_start).filter(begins).map(|text| format!("\n{text}\n")).collect()
}

pub fn change(bytes: Vec<u8>, pool: &Pool, random: &mut Random) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(&bytes) else { return change_number(bytes, random) };
    if random.once_in(5) {
        return change_header(text, pool, random);
    }
    let tokens = token::tokens(text);
    if tokens.is_empty() {
        return change_number(bytes, random);
    }
    let at = tokens[random.below(tokens.len())].span.clone();
    let piece = piece(&tokens, random);
    match random.below(11) {
        0 => replaced(text, at, ""),
        1 => replaced(text, at, &format!(" {} ", random.pick(WORDS_OF_WGSL))),
        2 => replaced(text, at.start..at.start, &format!(" {} ", random.pick(WORDS_OF_WGSL))),
        3 => {
            let numbers: Vec<&Token> = tokens.iter().filter(|token| token.kind == TokenKind::Number).collect();
            let at = if numbers.is_empty() { at } else { random.pick(&numbers).span.clone() };
            replaced(text, at, random.pick::<&str>(NUMBERS))
        }
        4 => {
            let words: Vec<&Token> = tokens.iter().filter(|token| token.kind == TokenKind::Word).collect();
            match words.is_empty() {
                true => replaced(text, at, ""),
                false => replaced(text, random.pick(&words).span.clone(), &text[random.pick(&words).span.clone()]),
            }
        }
        5 => replaced(text, piece.end..piece.end, &text[piece].repeat(*random.pick(COPIES))),
        6 => replaced(text, at.start..at.start, &format!(" {} ", &text[piece])),
        7 => replaced(text, piece, ""),
        8 => {
            let deep = *random.pick(&[1, 10, 63, 64, 300]);
            let pair = random.pick(&[
                ("(", ")"),
                ("{", "}"),
                ("[", "]"),
                ("-", ""),
                ("vec3f(", ")"),
                ("if (true) {", "}"),
                ("loop {", "}"),
            ]);
            let inner = text[piece.clone()].to_owned();
            replaced(text, piece, &format!("{}{inner}{}", pair.0.repeat(deep), pair.1.repeat(deep)))
        }
        9 if !pool.declarations.is_empty() => {
            replaced(text, text.len()..text.len(), random.pick::<String>(&pool.declarations))
        }
        _ => {
            let statement = random.pick(STATEMENTS);
            let after: Vec<&Token> =
                tokens.iter().filter(|token| matches!(token.kind, TokenKind::Mark(b'{' | b';'))).collect();
            let at = if after.is_empty() { at.end } else { random.pick(&after).span.end };
            replaced(text, at..at, &format!(" {statement} "))
        }
    }
}

/// Statements that ask much of a compiler or of a frame.
const STATEMENTS: &[&str] = &[
    "loop { }",
    "loop { if (color.x > 2.0) { break; } }",
    "for (var i = 0; i < 1000000; i++) { color.x += 0.1; }",
    "for (var i = 0; i < 4; i++) { i = 0; }",
    "for (var i = 0u; i < 4u; i--) { }",
    "while (true) { continue; }",
    "var big: array<vec4f, 4096>;",
    "var a: array<f32, 4>; a[100] = 1.0;",
    "let x = effect(color, point, p);",
    "return color / 0.0;",
    "return vec3f(bitcast<f32>(0x7fc00000u));",
    "discard;",
    "workgroupBarrier();",
    "switch (1) { case 1, 1: { } default: { } }",
    "const x = array<f32, 65536>()[0];",
    "let q = dpdx(color);",
    "let z = 1 / 0;",
    "let z = 1u << 40u;",
    "_ = textureLoad(scene, vec2i(0), 0);",
    "var p = &color; *p = vec3f(1.0);",
    "const_assert 1 == 2;",
    "return",
];

/// Some tokens that follow each other, often those of one pair of brackets.
fn piece(tokens: &[Token], random: &mut Random) -> Range<usize> {
    let first = random.below(tokens.len());
    let mut last = (first + random.below(MOST_TOKENS)).min(tokens.len() - 1);
    if matches!(tokens[first].kind, TokenKind::Mark(b'(' | b'[' | b'{')) {
        let mut depth = 0_i32;
        let closes = |token: &Token| {
            depth += match token.kind {
                TokenKind::Mark(b'(' | b'[' | b'{') => 1,
                TokenKind::Mark(b')' | b']' | b'}') => -1,
                _ => 0,
            };
            depth == 0
        };
        last = tokens[first..].iter().position(closes).map_or(last, |end| first + end);
    }
    tokens[first].span.start..tokens[last].span.end
}

fn replaced(text: &str, at: Range<usize>, with: &str) -> Vec<u8> {
    [&text[..at.start], with, &text[at.end..]].concat().into_bytes()
}

fn change_header(text: &str, pool: &Pool, random: &mut Random) -> Vec<u8> {
    let body = text.lines().skip_while(|line| line.starts_with("//!")).map(|line| format!("{line}\n"));
    let header = change_toml(header(text).into_bytes(), pool, random);
    let header = String::from_utf8_lossy(&header).lines().map(|line| format!("//! {line}\n")).collect::<String>();
    header.into_bytes().into_iter().chain(body.flat_map(String::into_bytes)).collect()
}
