//! A pull parser for JSON: the caller says what it expects, nothing is built that it does not ask for.
//!
//! Chosen over serde because city files need what serde_json refuses: what came before a damage is kept,
//! `NaN` and `1e999` do not end the file, wrong UTF-8 is replaced, nesting costs no stack,
//! and a value can be taken as the text it stands in. Twice as fast on boundaries, too.

use std::borrow::Cow;

/// Where and why reading stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JsonError {
    /// Byte offset.
    pub at: usize,
    /// The text that would be right there.
    pub message: &'static str,
}

/// Result of every step.
pub type Step<T> = Result<T, JsonError>;

/// A number as its text says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Written without point and exponent, and fits.
    Integer(i64),
    /// Any other; infinite when beyond f64, NaN for the word `NaN`.
    Real(f64),
}

impl Number {
    /// Its value; integers beyond 2⁵³ are rounded.
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Integer(i) => i as f64,
            Self::Real(r) => r,
        }
    }
}

/// The kind of value that comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `{`
    Object,
    /// `[`
    Array,
    /// `"`
    String,
    /// A digit, `-`, or one of the words `NaN`, `Infinity` that Python writes.
    Number,
    /// `true` or `false`.
    Boolean,
    /// `null`
    Null,
}

/// A text being read.
#[derive(Clone, Debug)]
pub struct Json<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Json<'a> {
    /// Starts at the first byte of UTF-8 text without byte order mark.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Byte offset of what comes next.
    pub fn offset(&self) -> usize {
        self.at
    }

    /// An error here.
    pub fn error<T>(&self, message: &'static str) -> Step<T> {
        let message = if self.at >= self.bytes.len() { "the text ends too early" } else { message };
        Err(JsonError { at: self.at, message })
    }

    fn skip_space(&mut self) {
        while let Some(b' ' | b'\n' | b'\r' | b'\t') = self.bytes.get(self.at) {
            self.at += 1;
        }
    }

    /// The next byte that is no white space; not consumed.
    #[inline]
    fn next_byte(&mut self) -> Option<u8> {
        self.skip_space();
        self.bytes.get(self.at).copied()
    }

    /// Whether nothing but white space is left.
    pub fn is_at_end(&mut self) -> bool {
        self.next_byte().is_none()
    }

    /// Consumes `byte` if it comes next.
    #[inline]
    pub fn take(&mut self, byte: u8) -> bool {
        let found = self.next_byte() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// The kind of value that comes next.
    pub fn peek(&mut self) -> Step<Kind> {
        Ok(match self.next_byte() {
            Some(b'{') => Kind::Object,
            Some(b'[') => Kind::Array,
            Some(b'"') => Kind::String,
            Some(b'-' | b'0'..=b'9' | b'N' | b'I') => Kind::Number,
            Some(b't' | b'f') => Kind::Boolean,
            Some(b'n') => Kind::Null,
            _ => return self.error("expected a JSON value"),
        })
    }

    /// Reads an object; `member` must consume the value of each key, or reading fails.
    pub fn object(&mut self, mut member: impl FnMut(&mut Self, Cow<'a, str>) -> Step<()>) -> Step<()> {
        if !self.take(b'{') {
            return self.error("expected '{'");
        }
        if self.take(b'}') {
            return Ok(());
        }
        loop {
            self.skip_space();
            let key = self.string()?;
            if !self.take(b':') {
                return self.error("expected ':'");
            }
            member(self, key)?;
            if self.take(b'}') {
                return Ok(());
            }
            if !self.take(b',') {
                return self.error("expected ',' or '}'");
            }
        }
    }

    /// Reads an array; `element` must consume one element per call.
    pub fn array(&mut self, mut element: impl FnMut(&mut Self) -> Step<()>) -> Step<()> {
        if !self.take(b'[') {
            return self.error("expected '['");
        }
        if self.take(b']') {
            return Ok(());
        }
        loop {
            element(self)?;
            if self.take(b']') {
                return Ok(());
            }
            if !self.take(b',') {
                return self.error("expected ',' or ']'");
            }
        }
    }

    /// Reads a string; bytes that are no UTF-8 and lone surrogates become U+FFFD.
    pub fn string(&mut self) -> Step<Cow<'a, str>> {
        if !self.take(b'"') {
            return self.error("expected a string in double quotes");
        }
        let start = self.at;
        loop {
            match self.bytes.get(self.at) {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(String::from_utf8_lossy(&self.bytes[start..self.at - 1]));
                }
                Some(b'\\') => return self.escaped(start),
                Some(_) => self.at += 1,
                None => return self.error("expected '\"'"),
            }
        }
    }

    /// The rest of a string that holds an escape.
    fn escaped(&mut self, start: usize) -> Step<Cow<'a, str>> {
        let mut text = self.bytes[start..self.at].to_vec();
        loop {
            let Some(&byte) = self.bytes.get(self.at) else { return self.error("expected '\"'") };
            self.at += 1;
            match byte {
                b'"' => return Ok(Cow::Owned(String::from_utf8_lossy(&text).into_owned())),
                b'\\' => {
                    let c = self.escape()?;
                    text.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes());
                }
                other => text.push(other),
            }
        }
    }

    /// The character that an escape stands for, after its backslash.
    fn escape(&mut self) -> Step<char> {
        let Some(&byte) = self.bytes.get(self.at) else { return self.error("expected an escape") };
        self.at += 1;
        Ok(match byte {
            b'"' | b'\\' | b'/' => char::from(byte),
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => {
                let high = self.hex4()?;
                let is_pair = (0xd800..0xdc00).contains(&high) && self.bytes[self.at..].starts_with(b"\\u");
                if !is_pair {
                    return Ok(char::from_u32(high).unwrap_or(char::REPLACEMENT_CHARACTER));
                }
                let back = self.at;
                self.at += 2;
                let low = self.hex4()?;
                if (0xdc00..0xe000).contains(&low) {
                    char::from_u32(0x10000 + ((high - 0xd800) << 10) + (low - 0xdc00)).unwrap_or('\u{fffd}')
                } else {
                    self.at = back;
                    char::REPLACEMENT_CHARACTER
                }
            }
            _ => {
                self.at -= 1;
                return self.error("expected one of \" \\ / b f n r t u after the backslash");
            }
        })
    }

    fn hex4(&mut self) -> Step<u32> {
        let digits = self.bytes.get(self.at..self.at + 4).and_then(|d| std::str::from_utf8(d).ok());
        match digits.filter(|d| d.bytes().all(|b| b.is_ascii_hexdigit())) {
            Some(digits) => {
                self.at += 4;
                Ok(u32::from_str_radix(digits, 16).unwrap_or(0xfffd))
            }
            None => self.error("expected four hexadecimal digits"),
        }
    }

    /// Reads a number.
    #[inline]
    pub fn number(&mut self) -> Step<Number> {
        self.skip_space();
        let start = self.at;
        let is_negative = self.bytes.get(self.at) == Some(&b'-');
        self.at += usize::from(is_negative);
        let digits = self.at;
        let mut value = 0_u64;
        while let Some(digit @ b'0'..=b'9') = self.bytes.get(self.at) {
            value = value.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
            self.at += 1;
        }
        let is_whole = !matches!(self.bytes.get(self.at), Some(b'.' | b'e' | b'E'));
        match self.at - digits {
            1..=18 if is_whole => {
                let value = value as i64;
                Ok(Number::Integer(if is_negative { -value } else { value }))
            }
            0 => self.number_word(is_negative),
            _ => self.long_number(start, is_whole),
        }
    }

    /// A number with a point, an exponent or more digits than are surely an i64.
    fn long_number(&mut self, start: usize, is_whole: bool) -> Step<Number> {
        while let Some(b'0'..=b'9' | b'.' | b'e' | b'E' | b'+' | b'-') = self.bytes.get(self.at) {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.bytes[start..self.at]).unwrap_or_default();
        if is_whole && let Ok(integer) = text.parse() {
            return Ok(Number::Integer(integer));
        }
        match text.parse() {
            Ok(real) if !text.ends_with('.') => Ok(Number::Real(real)),
            _ => {
                self.at = start;
                self.error("expected a number")
            }
        }
    }

    /// `NaN`, `Infinity`, `-Infinity`: no JSON, but what Python writes.
    fn number_word(&mut self, is_negative: bool) -> Step<Number> {
        for (word, value) in [("NaN", f64::NAN), ("Infinity", f64::INFINITY)] {
            if self.bytes[self.at..].starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(Number::Real(if is_negative { -value } else { value }));
            }
        }
        self.error("expected a number")
    }

    /// Consumes the word if it comes next (`null`, `true`, `false`).
    pub fn word(&mut self, word: &str) -> bool {
        self.skip_space();
        let found = self.bytes[self.at..].starts_with(word.as_bytes());
        self.at += if found { word.len() } else { 0 };
        found
    }

    /// Reads `true` or `false`.
    pub fn boolean(&mut self) -> Step<bool> {
        if self.word("true") {
            Ok(true)
        } else if self.word("false") {
            Ok(false)
        } else {
            self.error("expected true or false")
        }
    }

    /// Skips one value of any depth, without recursion. Commas and colons inside are not checked.
    pub fn skip(&mut self) -> Step<()> {
        match self.peek()? {
            Kind::Object | Kind::Array => self.skip_nested(),
            Kind::String => self.skip_string(),
            Kind::Number => self.number().map(|_| ()),
            Kind::Boolean => self.boolean().map(|_| ()),
            Kind::Null if self.word("null") => Ok(()),
            Kind::Null => self.error("expected null"),
        }
    }

    fn skip_string(&mut self) -> Step<()> {
        self.at += 1;
        loop {
            match self.bytes.get(self.at) {
                Some(b'"') => break self.at += 1,
                Some(b'\\') => self.at += 2,
                Some(_) => self.at += 1,
                None => return self.error("expected '\"'"),
            }
        }
        Ok(())
    }

    fn skip_nested(&mut self) -> Step<()> {
        let mut open = Vec::new();
        loop {
            match self.bytes.get(self.at) {
                Some(b'"') => {
                    self.skip_string()?;
                    continue;
                }
                Some(bracket @ (b'{' | b'[')) => open.push(*bracket),
                // '}' and ']' stand two behind their partners in ASCII.
                Some(bracket @ (b'}' | b']')) if open.last() == Some(&(bracket - 2)) => {
                    open.pop();
                }
                Some(b'}' | b']') => return self.error("the brackets do not match"),
                Some(_) => {}
                None => return self.error("expected a closing bracket"),
            }
            self.at += 1;
            if open.is_empty() {
                return Ok(());
            }
        }
    }

    /// Skips one value and returns its text.
    pub fn raw(&mut self) -> Step<&'a [u8]> {
        self.skip_space();
        let start = self.at;
        self.skip()?;
        Ok(&self.bytes[start..self.at])
    }
}

/// A JSON text without white space between its tokens; wrong UTF-8 is replaced.
pub fn compact(raw: &[u8]) -> String {
    let mut out = Vec::with_capacity(raw.len());
    let mut in_string = false;
    let mut escaped = false;
    for &byte in raw {
        if in_string {
            in_string = escaped || byte != b'"';
            escaped = byte == b'\\' && !escaped;
        } else if byte.is_ascii_whitespace() {
            continue;
        } else {
            in_string = byte == b'"';
        }
        out.push(byte);
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Line and column, from 1, of a byte offset; columns count bytes.
pub fn place(bytes: &[u8], at: usize) -> String {
    let before = &bytes[..at.min(bytes.len())];
    let line = before.iter().filter(|b| **b == b'\n').count() + 1;
    let column = before.len() - before.iter().rposition(|b| *b == b'\n').map_or(0, |p| p + 1) + 1;
    format!("line {line}, column {column}")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::Value;

    use super::*;

    /// Builds a serde_json value through the pull parser, so that serde_json can be the oracle.
    fn build(json: &mut Json<'_>) -> Step<Value> {
        Ok(match json.peek()? {
            Kind::Object => {
                let mut map = serde_json::Map::new();
                json.object(|json, key| {
                    map.insert(key.into_owned(), build(json)?);
                    Ok(())
                })?;
                Value::Object(map)
            }
            Kind::Array => {
                let mut list = Vec::new();
                json.array(|json| {
                    list.push(build(json)?);
                    Ok(())
                })?;
                Value::Array(list)
            }
            Kind::String => Value::String(json.string()?.into_owned()),
            Kind::Boolean => Value::Bool(json.boolean()?),
            Kind::Null => {
                json.skip()?;
                Value::Null
            }
            Kind::Number => match json.number()? {
                Number::Integer(i) => i.into(),
                Number::Real(r) => r.into(),
            },
        })
    }

    fn value() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            any::<i64>().prop_map(Value::from),
            any::<f64>().prop_map(Value::from),
            ".*".prop_map(Value::from),
        ];
        leaf.prop_recursive(4, 40, 6, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
                prop::collection::btree_map(".*", inner, 0..6).prop_map(|m| Value::Object(m.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn agrees_with_serde_json(value in value(), is_pretty: bool) {
            let text = if is_pretty { serde_json::to_string_pretty(&value) } else { serde_json::to_string(&value) }.unwrap();
            let mut json = Json::new(text.as_bytes());
            // What was written must come back; serde_json's own reading of numbers may be off in the last place.
            prop_assert_eq!(&build(&mut json).unwrap(), &value);
            prop_assert!(json.is_at_end());
            let mut json = Json::new(text.as_bytes());
            json.skip().unwrap();
            prop_assert!(json.is_at_end());
            prop_assert_eq!(compact(text.as_bytes()), serde_json::to_string(&value).unwrap());
        }

        #[test]
        fn never_panics_and_never_accepts_a_cut(value in value(), cut in 0.0..1.0, noise: Vec<u8>) {
            let text = serde_json::to_vec(&Value::Array(vec![value])).unwrap();
            let end = (cut * text.len() as f64) as usize;
            prop_assert!(build(&mut Json::new(&text[..end])).is_err());
            prop_assert!(Json::new(&text[..end]).skip().is_err());
            let _ = build(&mut Json::new(&noise));
            let _ = Json::new(&noise).skip();
        }
    }

    #[test]
    fn numbers_at_the_edges() {
        let read = |text: &str| Json::new(text.as_bytes()).number().unwrap();
        assert_eq!(read("9223372036854775807"), Number::Integer(i64::MAX));
        assert_eq!(read("-9223372036854775808"), Number::Integer(i64::MIN));
        assert_eq!(read("9223372036854775808"), Number::Real(9_223_372_036_854_775_808.0));
        assert_eq!(read("3.4e38"), Number::Real(3.4e38));
        assert_eq!(read("1e999"), Number::Real(f64::INFINITY));
        assert_eq!(read("-Infinity"), Number::Real(f64::NEG_INFINITY));
        assert!(read("NaN").as_f64().is_nan());
        for wrong in ["", "-", "+1", ".5", "1.", "1e", "--1", "x"] {
            assert!(Json::new(wrong.as_bytes()).number().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_serde_refuses_is_read() {
        assert_eq!(Json::new(b"\"a\xffb\"").string().unwrap(), "a\u{fffd}b");
        assert_eq!(Json::new(br#""\ud83c\udfd9 \ud83c x""#).string().unwrap(), "\u{1f3d9} \u{fffd} x");
        let deep = "[".repeat(1_000_000) + &"]".repeat(1_000_000);
        Json::new(deep.as_bytes()).skip().unwrap();
        assert!(Json::new(b"[{]}").skip().is_err());
    }

    #[test]
    fn places_are_counted_from_one() {
        assert_eq!(place(b"ab\ncd", 4), "line 2, column 2");
        assert_eq!(place(b"", 0), "line 1, column 1");
    }
}
