//! Logical lines of OBJ and MTL files: any line end, `\` continuations joined, comments cut.

use std::borrow::Cow;

/// Walks over the logical lines of a file.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// 1-based number of the line that comes next.
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: 1 }
    }

    /// The next physical line without its end (`\n`, `\r\n` or a lone `\r`).
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
        let (line, after) = self.rest.split_at(end);
        self.rest = after.strip_prefix(b"\r\n").or(after.get(1..)).unwrap_or(&[]);
        self.number += 1;
        Some(line)
    }
}

impl<'a> Iterator for Lines<'a> {
    /// The number of its first physical line, and the line.
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let number = self.number;
        let mut line = Cow::Borrowed(self.physical()?);
        while line.last() == Some(&b'\\') {
            let joined = line.to_mut();
            joined.pop();
            joined.push(b' ');
            joined.extend_from_slice(self.physical().unwrap_or(&[]));
        }
        Some((number, line))
    }
}

/// The keyword of a line and what follows it, both trimmed; `None` for blank lines and comments.
pub(super) fn statement(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let line = line.trim_ascii();
    if line.is_empty() || line[0] == b'#' {
        return None;
    }
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    Some((&line[..end], line[end..].trim_ascii()))
}

/// The words of a statement's arguments, up to a comment.
pub(super) fn words(arguments: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = arguments.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
    words.take_while(|w| w[0] != b'#')
}

/// A number; `nan` and `inf` are numbers too, and are dealt with where they are used.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Text as it is, or as Latin-1 where it is not UTF-8: old exporters write names in the code page of their machine.
pub(super) fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_end_counts_once() {
        let lines: Vec<_> = Lines::new(b"a\r\nb\rc\n\nd \\\n e\nlast").map(|(n, l)| (n, text(&l))).collect();
        let wanted = [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d   e"), (7, "last")];
        assert_eq!(lines, wanted.map(|(n, l)| (n, l.to_owned())));
        assert_eq!(Lines::new(b"x\\").map(|(_, l)| text(&l)).collect::<Vec<_>>(), ["x "]);
    }

    #[test]
    fn comments_and_blanks_are_no_statements() {
        assert_eq!(statement(b"  # x"), None);
        assert_eq!(statement(b"\t"), None);
        assert_eq!(statement(b" g  a b "), Some((&b"g"[..], &b"a b"[..])));
        assert_eq!(words(b"1  2 # 3").count(), 2);
    }
}
