//! Sizes in users' effects: of types, of constants, of expressions. What a compiler unrolls, copies and recurses over is bounded before one
//! sees it, and entry points and bindings, which belong to the program, are refused.

use rustc_hash::FxHashMap;

use crate::shader::{
    effect_file::error::{File, FileError},
    wgsl::token::{self, Token, TokenKind},
};

/// Numbers that a type holds, and that a constant or a variable is made of: 16 KiB.
const MOST_NUMBERS: u64 = 4096;
/// Numbers that all variables and constants of a file hold together.
const MOST_IN_ALL: u64 = 4 * MOST_NUMBERS;
/// Words and marks of an expression, between commas and semicolons.
const MOST_WORDS: usize = 1000;
/// Brackets in brackets.
const MOST_DEPTH: usize = 64;

/// Refuses what is small in the file and large in the compiler.
pub(super) fn check_bounds(file: &File) -> Result<(), FileError> {
    let tokens = token::tokens(file.text);
    check_shape(file, &tokens)?;
    let mut sizes = Sizes {
        file,
        tokens: &tokens,
        types: FxHashMap::default(),
        values: FxHashMap::default(),
        counts: FxHashMap::default(),
    };
    let mut in_all = 0_u64;
    for (at, token) in tokens.iter().enumerate().filter(|(_, token)| token.kind == TokenKind::Word) {
        let size = match sizes.word(at) {
            "struct" => sizes.structure(at)?,
            "alias" => sizes.alias(at)?,
            "const" | "let" | "var" | "override" => sizes.variable(at)?,
            // What is made in passing is as large as its type.
            "array" => {
                sizes.type_at(at)?;
                continue;
            }
            _ => continue,
        };
        in_all = in_all.saturating_add(size);
        if in_all > MOST_IN_ALL {
            let message =
                format!("the variables, constants and types of an effect hold at most {MOST_IN_ALL} numbers together");
            return Err(file.error(token.span.start, message));
        }
    }
    Ok(())
}

/// Attributes, the length of expressions, brackets in brackets.
fn check_shape(file: &File, tokens: &[Token]) -> Result<(), FileError> {
    let (mut depth, mut words) = (0_usize, 0);
    for (i, token) in tokens.iter().enumerate() {
        let error = |message: String| Err(file.error(token.span.start, message));
        words += 1;
        match token.kind {
            TokenKind::Mark(b'@') => {
                let name = tokens.get(i + 1).map_or("", |t| &file.text[t.span.clone()]);
                return error(format!(
                    "@{name}: entry points, bindings and layouts are the program's; an effect has none"
                ));
            }
            TokenKind::Mark(b'(' | b'[' | b'{') => depth += 1,
            TokenKind::Mark(b')' | b']' | b'}') => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MOST_DEPTH {
            return error(format!("brackets stand in brackets at most {MOST_DEPTH} deep"));
        }
        if words > MOST_WORDS {
            return error(format!("an expression has at most {MOST_WORDS} words and marks"));
        }
        if let TokenKind::Mark(b',' | b';' | b'{' | b'}') = token.kind {
            words = 0;
        }
    }
    Ok(())
}

/// How many numbers things hold.
struct Sizes<'a> {
    file: &'a File<'a>,
    tokens: &'a [Token],
    /// Of structs and aliases.
    types: FxHashMap<&'a str, u64>,
    /// Of constants and variables.
    values: FxHashMap<&'a str, u64>,
    /// Constants that are one whole number, which lengths of arrays may be.
    counts: FxHashMap<&'a str, u64>,
}

impl<'a> Sizes<'a> {
    fn word(&self, at: usize) -> &'a str {
        self.tokens.get(at).map_or("", |token| &self.file.text[token.span.clone()])
    }

    fn error<T>(&self, at: usize, message: impl Into<String>) -> Result<T, FileError> {
        let place = self.tokens.get(at).or(self.tokens.last()).map_or(0, |token| token.span.start);
        Err(self.file.error(place, message))
    }

    fn within(&self, at: usize, size: u64) -> Result<u64, FileError> {
        if size <= MOST_NUMBERS {
            return Ok(size);
        }
        self.error(at, format!("this holds more than {MOST_NUMBERS} numbers"))
    }

    /// A type and where it ends.
    fn type_at(&self, at: usize) -> Result<(u64, usize), FileError> {
        let name = self.word(at);
        if let Some(size) = self.types.get(name) {
            return Ok((*size, at + 1));
        }
        if name == "array" && self.word(at + 1) == "<" {
            let (element, end) = self.type_at(at + 2)?;
            if self.word(end) != "," {
                return self.error(at, "an array has a length");
            }
            let Some(count) = self.count(end + 1) else {
                return self.error(end + 1, "expected a whole number, or a constant that is one");
            };
            let close = end + 2 + usize::from(self.word(end + 2) == ",");
            if self.word(close) != ">" {
                return self.error(end + 1, "expected a whole number, or a constant that is one");
            }
            return Ok((self.within(at, element.saturating_mul(count))?, close + 1));
        }
        let of = |letters: &str| -> u64 {
            letters.bytes().filter(u8::is_ascii_digit).map(|b| u64::from(b - b'0')).product()
        };
        let size = match name.get(..3) {
            Some("vec" | "mat") => of(name.trim_end_matches(['f', 'i', 'u', 'h'])).clamp(1, 16),
            _ => 1,
        };
        // `vec3<f32>`.
        let is_generic = self.word(at + 1) == "<" && name.starts_with(['v', 'm', 'p', 'a']);
        let end = if is_generic { at + 4 } else { at + 1 };
        Ok((size, end))
    }

    /// The whole number at a place.
    fn count(&self, at: usize) -> Option<u64> {
        let word = self.word(at);
        word.trim_end_matches(['u', 'i']).parse().ok().or_else(|| self.counts.get(word).copied())
    }

    fn alias(&mut self, at: usize) -> Result<u64, FileError> {
        if self.word(at + 2) != "=" {
            return Ok(0);
        }
        let (size, _) = self.type_at(at + 3)?;
        self.types.insert(self.word(at + 1), size);
        Ok(0)
    }

    fn structure(&mut self, at: usize) -> Result<u64, FileError> {
        let (mut size, mut i) = (0_u64, at + 3);
        while i < self.tokens.len() && self.word(i) != "}" {
            if self.word(i) == ":" {
                let (member, end) = self.type_at(i + 1)?;
                size = self.within(i + 1, size.saturating_add(member))?;
                i = end;
            } else {
                i += 1;
            }
        }
        self.types.insert(self.word(at + 1), size);
        Ok(0)
    }

    /// A constant or a variable: as large as its type, or as what it is made of.
    fn variable(&mut self, at: usize) -> Result<u64, FileError> {
        let name = at + 1;
        let mut i = name + 1;
        let mut size = 1;
        if self.word(i) == ":" {
            (size, i) = self.type_at(i + 1)?;
        }
        let mut made = 0_u64;
        if self.word(i) == "=" {
            let first = i + 1;
            while i < self.tokens.len() && self.word(i) != ";" {
                let word = self.word(i);
                let own = match self.tokens[i].kind {
                    // A call gives what its type holds; others have been looked at where they are declared.
                    TokenKind::Word if self.word(i + 1) == "(" => self.types.get(word).copied().unwrap_or(0),
                    TokenKind::Word if self.word(i.wrapping_sub(1)) == "." => 0,
                    TokenKind::Word => self.values.get(word).copied().unwrap_or(0),
                    TokenKind::Number => 1,
                    TokenKind::Mark(_) => 0,
                };
                made = made.saturating_add(own);
                i += 1;
            }
            if let (Some(count), ";") = (self.count(first), self.word(first + 1)) {
                self.counts.insert(self.word(name), count);
            } else {
                self.counts.remove(self.word(name));
            }
        }
        let size = self.within(name, size.max(made))?;
        self.values.insert(self.word(name), size);
        Ok(size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(text: &str) -> Result<(), String> {
        check_bounds(&File { path: "e.wgsl", text }).map_err(|error| error.to_string())
    }

    #[test]
    fn what_effects_need_is_within_bounds() {
        for text in [
            "const N = 16u;\nstruct Tone { color: vec3f, share: f32, }\nalias Row = array<Tone, N>;\nfn effect(color: vec3f) -> vec3f { var row: Row; let m = mat4x4<f32>(); return row[0].color; }",
            "const PALETTE = array<vec3f, 256>(vec3f(0.1, 0.2, 0.3), vec3f(1.0));",
            "fn f() { var a: array<f32, 1024>; var b: array<vec4<f32>, 64>; for (var i = 0; i < 4; i++) { a[i] = 1.0; } }",
            "fn f(p: ptr<function, f32>) -> f32 { let a = (1.0 + 2.0) * 3.0; return a; }",
        ] {
            assert_eq!(checked(text), Ok(()), "{text}");
        }
        let palette = "0.5, ".repeat(1024);
        assert_eq!(checked(&format!("const P = array<f32, 1024>({palette});")), Ok(()));
    }

    #[test]
    fn what_grows_in_the_compiler_is_refused_where_it_stands() {
        let doubled: String = (1..24).map(|i| format!("const C{i} = array(C{0}, C{0});\n", i - 1)).collect();
        let nested: String = (1..9).map(|i| format!("struct S{i} {{ a: S{0}, b: array<S{0}, 4> }}\n", i - 1)).collect();
        let lets: String = (1..24).map(|i| format!("let c{i} = array(c{0}, c{0});\n", i - 1)).collect();
        for (text, place, said) in [
            ("fn f() { var a: array<f32, 100000>; }".into(), "1:17", "more than 4096 numbers"),
            ("var a: array<array<f32, 100>, 100>;".into(), "1:8", "more than 4096 numbers"),
            ("const N = 65536;\nvar a: array<vec4f, N>;".into(), "2:8", "more than 4096 numbers"),
            ("const N = 64 * 1024;\nvar a: array<f32, N>;".into(), "2:19", "expected a whole number"),
            ("fn f() { let x = array<f32, 16000000>()[0]; }".into(), "1:18", "more than 4096 numbers"),
            (format!("const C0 = 1.0;\n{doubled}"), "14:7", "more than 4096 numbers"),
            (format!("fn f() {{\nlet c0 = 1.0;\n{lets}}}"), "15:5", "more than 4096 numbers"),
            (format!("struct S0 {{ a: vec4f }}\n{nested}"), "6:23", "more than 4096 numbers"),
            ("fn f() { var a: array<f32, 4000>; }\n".repeat(5), "5:10", "together"),
            (format!("const A = 1.0{};", " + 1.0".repeat(30_000)), "1:", "an expression has at most"),
            (format!("const A = {}1.0{};", "(".repeat(80), ")".repeat(80)), "1:75", "64 deep"),
            ("@fragment fn main() {}".into(), "1:1", "@fragment"),
            ("@compute @workgroup_size(1) fn main() {}".into(), "1:1", "@compute"),
            ("@group(0) @binding(0) var<uniform> a: f32;".into(), "1:1", "@group"),
        ] {
            let message = checked(&text).expect_err(&text);
            assert!(message.starts_with(&format!("e.wgsl:{place}")) && message.contains(said), "{text}: {message}");
        }
    }
}
