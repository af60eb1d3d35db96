//! The words of a native file of OpenDX: names in quotes are one, commas part them, `#` begins a comment.

use crate::field::words::Words;

/// A word.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    /// What it says, without quotes.
    pub text: String,
    /// Whether it stood in quotes: it is no keyword then.
    pub is_quoted: bool,
    /// Where it begins, in bytes.
    pub at: usize,
}

impl Token {
    /// Whether it is this keyword.
    pub fn is(&self, keyword: &str) -> bool {
        !self.is_quoted && self.text.eq_ignore_ascii_case(keyword)
    }
}

/// The words, one after the other.
#[derive(Clone)]
pub struct Tokens<'a> {
    /// The place of the next.
    pub words: Words<'a>,
}

impl Tokens<'_> {
    /// The next word.
    pub fn next(&mut self) -> Option<Token> {
        loop {
            let rest = self.words.rest();
            match rest.first()? {
                b if b.is_ascii_whitespace() || *b == b',' => self.words.skip(1),
                b'#' => drop(self.words.line()),
                b'"' => return Some(self.quoted()),
                _ => break,
            }
        }
        let at = self.words.at();
        let rest = self.words.rest();
        let is_end = |b: &u8| b.is_ascii_whitespace() || matches!(b, b',' | b'"');
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        self.words.skip(length);
        let text = String::from_utf8_lossy(rest.get(..length).unwrap_or_default()).into_owned();
        Some(Token { text, is_quoted: false, at })
    }

    fn quoted(&mut self) -> Token {
        let at = self.words.at();
        self.words.skip(1);
        let rest = self.words.rest();
        let length = rest.iter().position(|b| *b == b'"').unwrap_or(rest.len());
        self.words.skip(length + 1);
        let text = String::from_utf8_lossy(rest.get(..length).unwrap_or_default()).into_owned();
        Token { text, is_quoted: true, at }
    }

    /// The next word, which stays.
    pub fn peek(&self) -> Option<Token> {
        self.clone().next()
    }

    /// Numbers, as long as there are any.
    pub fn numbers(&mut self) -> Vec<f64> {
        let mut all = Vec::new();
        while let Some(number) = self.peek().filter(|t| !t.is_quoted).and_then(|t| crate::field::words::number(&t.text))
        {
            all.push(number);
            self.next();
        }
        all
    }

    /// Whole numbers, as long as there are any.
    pub fn whole(&mut self) -> Vec<usize> {
        let mut all = Vec::new();
        while let Some(number) = self.peek().filter(|t| !t.is_quoted).and_then(|t| t.text.parse().ok()) {
            all.push(number);
            self.next();
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_quotes_and_comments() {
        let mut tokens = Tokens { words: Words::new(b"object \"a b\"# no\n data f.bin,12 1.5 2 x") };
        let texts: Vec<String> = (0..5).filter_map(|_| tokens.next()).map(|t| t.text).collect();
        assert_eq!(texts, ["object", "a b", "data", "f.bin", "12"]);
        assert_eq!(tokens.clone().whole(), [0_usize; 0]);
        assert_eq!(tokens.numbers(), [1.5, 2.0]);
        assert!(tokens.next().is_some_and(|t| t.is("X")) && tokens.next().is_none());
    }
}
