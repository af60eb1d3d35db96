//! Text read by words and lines, with raw bytes between.

use crate::field::numbers::{NumberKind, Numbers};

/// A place in a file, from which words, lines and bytes are taken.
#[derive(Clone)]
pub struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// The beginning of these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self::from(bytes, 0)
    }

    /// A place in these bytes; their end where it is behind that.
    pub fn from(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at: at.min(bytes.len()) }
    }

    /// Where the next byte is.
    pub fn at(&self) -> usize {
        self.at
    }

    /// All from here.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// Passes over so many bytes.
    pub fn skip(&mut self, count: usize) {
        self.at = self.at.saturating_add(count).min(self.bytes.len());
    }

    /// Passes over white space.
    pub fn skip_space(&mut self) {
        self.skip(self.rest().iter().take_while(|b| b.is_ascii_whitespace()).count());
    }

    /// The next word, in white space; none at the end. What is no UTF-8 is an empty word.
    pub fn next(&mut self) -> Option<&'a str> {
        self.skip_space();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.skip(length);
        let word = rest.get(..length).unwrap_or_default();
        (length > 0).then(|| std::str::from_utf8(word).unwrap_or(""))
    }

    /// The next word, which stays.
    pub fn peek(&self) -> Option<&'a str> {
        self.clone().next()
    }

    /// The rest of this line, without its end, which is passed; none at the end of the file.
    pub fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.skip(length + 1);
        let line = rest.get(..length).unwrap_or_default();
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// The rest of this line as text, without white space around it.
    pub fn text_line(&mut self) -> Option<String> {
        self.line().map(|line| String::from_utf8_lossy(line).trim().to_owned())
    }

    /// The next word as a number.
    pub fn number(&mut self) -> Option<f64> {
        number(self.next()?)
    }

    /// So many bytes; none where there are fewer.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.rest().get(..count)?;
        self.skip(count);
        Some(taken)
    }

    /// So many numbers between white space or commas. The error says how many there are.
    pub fn numbers(&mut self, kind: NumberKind, count: usize) -> Result<Numbers<'static>, String> {
        let is_between = |b: &u8| b.is_ascii_whitespace() || *b == b',';
        // A number and what parts it from the next are two bytes.
        let room = count.min(self.rest().len() / 2 + 1);
        let mut numbers = Numbers::with_room(kind, room);
        for found in 0..count {
            let space = self.rest().iter().take_while(|b| is_between(b)).count();
            let rest = self.rest().get(space..).unwrap_or_default();
            let length = rest.iter().position(is_between).unwrap_or(rest.len());
            let word = rest.get(..length).unwrap_or_default();
            let Some(value) = std::str::from_utf8(word).ok().and_then(number) else {
                let what = if word.is_empty() { "the end".into() } else { String::from_utf8_lossy(word) };
                return Err(format!("{count} numbers belong here, after {found} comes \"{what}\""));
            };
            self.skip(space + length);
            numbers.push(value);
        }
        Ok(numbers)
    }
}

/// A number as programs write it; `nan` and `inf` are numbers, too, and Fortran's `1.5D+03` is.
pub fn number(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| {
        // What C on Windows writes for NaN and infinity.
        if word.contains("#IND") || word.contains("#QNAN") || word.contains("#INF") {
            return Some(f64::NAN);
        }
        let is_fortran = word.bytes().all(|b| b.is_ascii_digit() || b"+-.dD".contains(&b));
        is_fortran.then(|| word.replace(['d', 'D'], "e")).and_then(|word| word.parse().ok())
    })
}

/// All numbers of a text, between white space or commas; none if something else is among them.
pub fn all_numbers(text: &str) -> Option<Vec<f64>> {
    let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    words.map(number).collect()
}

/// All whole numbers of a text, between white space; none if something else is among them.
pub fn all_whole(text: &str) -> Option<Vec<usize>> {
    text.split_whitespace().map(|word| word.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lines_and_bytes() {
        let mut words = Words::new(b"  a 12 rest of it \r\n\x01\x02-1.5D+01");
        assert_eq!((words.next(), words.next()), (Some("a"), Some("12")));
        assert_eq!(words.text_line().as_deref(), Some("rest of it"));
        assert_eq!(words.take(2), Some(&[1, 2][..]));
        assert_eq!(words.take(99), None);
        assert_eq!(words.number(), Some(-15.0));
        assert_eq!((words.next(), words.line()), (None, None));
    }

    #[test]
    fn numbers_are_counted() {
        let mut words = Words::new(b"1, 2\n3,x");
        let numbers = words.numbers(NumberKind::U8, 3).unwrap();
        assert_eq!(numbers.all(), [1.0, 2.0, 3.0]);
        let error = Words::new(b"1 2").numbers(NumberKind::F64, 1 << 40).err().unwrap();
        assert_eq!(error, "1099511627776 numbers belong here, after 2 comes \"the end\"");
        assert!(number("-1.#IND").is_some_and(f64::is_nan));
        assert_eq!(number("1.5e"), None);
        assert_eq!(all_numbers("1,2 3.5"), Some(vec![1.0, 2.0, 3.5]));
        assert_eq!(all_whole("1 -2"), None);
    }
}
