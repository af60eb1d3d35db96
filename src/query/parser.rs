//! From a text to an expression.

use crate::{
    query::{
        Expression, Literal, Name, QueryError, Relation,
        token::{Token, What, tokens},
    },
    time::Interval,
};

/// Expressions in each other, at most.
const MOST_DEPTH: usize = 64;
/// Characters of an expression, at most.
const MOST_CHARACTERS: usize = 20_000;

/// Reads an expression.
///
/// # Errors
/// What is wrong with it, and at which column.
pub fn parse(text: &str) -> Result<Expression, QueryError> {
    if text.chars().nth(MOST_CHARACTERS).is_some() {
        let message = format!("an expression has {MOST_CHARACTERS} characters at most");
        return Err(QueryError { column: MOST_CHARACTERS + 1, message });
    }
    let mut parser = Parser { tokens: tokens(text)?, at: 0, end: text.chars().count() + 1, depth: 0 };
    let expression = parser.any()?;
    match parser.tokens.get(parser.at) {
        None => Ok(expression),
        Some(token) => {
            Err(QueryError { column: token.column, message: "\"and\" or \"or\" is missing before this".to_owned() })
        }
    }
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    /// The column behind the last one.
    end: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> Option<&What> {
        self.tokens.get(self.at).map(|token| &token.what)
    }

    fn column(&self) -> usize {
        self.tokens.get(self.at).map_or(self.end, |token| token.column)
    }

    fn wrong<T>(&self, message: &str) -> Result<T, QueryError> {
        Err(QueryError { column: self.column(), message: message.to_owned() })
    }

    /// Whether a word of the language is next, which is taken then.
    fn takes(&mut self, word: &str) -> bool {
        let is_next = matches!(self.peek(), Some(What::Word(own)) if own.eq_ignore_ascii_case(word));
        self.at += usize::from(is_next);
        is_next
    }

    fn takes_sign(&mut self, what: &What) -> bool {
        let is_next = self.peek() == Some(what);
        self.at += usize::from(is_next);
        is_next
    }

    fn any(&mut self) -> Result<Expression, QueryError> {
        let mut all = vec![self.all()?];
        while self.takes("or") {
            all.push(self.all()?);
        }
        Ok(if all.len() == 1 { all.remove(0) } else { Expression::Any(all) })
    }

    fn all(&mut self) -> Result<Expression, QueryError> {
        let mut all = vec![self.factor()?];
        while self.takes("and") {
            all.push(self.factor()?);
        }
        Ok(if all.len() == 1 { all.remove(0) } else { Expression::All(all) })
    }

    fn factor(&mut self) -> Result<Expression, QueryError> {
        if self.depth == MOST_DEPTH {
            return self.wrong("there are too many \"not\" and \"(\" in each other");
        }
        self.depth += 1;
        let found = if self.takes("not") {
            Expression::Not(Box::new(self.factor()?))
        } else if self.takes_sign(&What::Open) {
            let inside = self.any()?;
            if !self.takes_sign(&What::Close) {
                return self.wrong("\")\" is missing");
            }
            inside
        } else {
            self.test()?
        };
        self.depth -= 1;
        Ok(found)
    }

    fn name(&mut self) -> Result<Name, QueryError> {
        let column = self.column();
        let text = match self.peek() {
            Some(What::Name(name)) => name.clone(),
            Some(What::Word(word)) if is_reserved(word) => {
                return self.wrong(&format!(
                    "a name is missing before \"{word}\"; one that is called so stands in `backquotes`"
                ));
            }
            Some(What::Word(word)) => word.clone(),
            Some(What::Text(_)) => {
                return self.wrong("a name is missing here, not a text: names stand as they are, or in `backquotes`");
            }
            _ => {
                return self
                    .wrong("a name is missing here: that of an attribute, \"type\", \"id\" or \"geometry.height\"");
            }
        };
        self.at += 1;
        Ok(Name { text, column })
    }

    fn test(&mut self) -> Result<Expression, QueryError> {
        let name = self.name()?;
        if self.takes("in") {
            return self.within(name);
        }
        let relation = match self.peek() {
            Some(What::Relation(relation)) => *relation,
            Some(What::Word(word)) if word.eq_ignore_ascii_case("contains") => Relation::Contains,
            _ => return Ok(Expression::Has(name)),
        };
        self.at += 1;
        Ok(Expression::Is(name, relation, self.literal()?))
    }

    fn within(&mut self, name: Name) -> Result<Expression, QueryError> {
        if self.takes_sign(&What::Open) {
            let mut all = vec![self.literal()?];
            while self.takes_sign(&What::Comma) {
                all.push(self.literal()?);
            }
            if !self.takes_sign(&What::Close) {
                return self.wrong("\",\" or \")\" is missing");
            }
            return Ok(Expression::OneOf(name, all));
        }
        let low = if self.peek() == Some(&What::Range) { None } else { Some(self.literal()?) };
        if !self.takes_sign(&What::Range) {
            return self.wrong("\"..\" is missing: a range is 3..25, 3.. or ..25, a list (3, 25)");
        }
        let has_high = match self.peek() {
            Some(What::Word(word)) => !is_reserved(word),
            Some(What::Text(_)) => true,
            _ => false,
        };
        let high = if has_high { Some(self.literal()?) } else { None };
        if low.is_none() && high.is_none() {
            return self.wrong("a range has one end at least");
        }
        Ok(Expression::Between(name, low, high))
    }

    fn literal(&mut self) -> Result<Literal, QueryError> {
        let literal = match self.peek() {
            Some(What::Text(text)) => Literal::Text(text.clone()),
            Some(What::Word(word)) if is_reserved(word) => {
                return self.wrong(&format!(
                    "a value is missing before \"{word}\"; a text that reads so stands in \"quotes\""
                ));
            }
            Some(What::Word(word)) => of_word(word),
            Some(What::Name(_)) => {
                return self.wrong("a value is missing here, not a name: a number, a date or a \"text\"");
            }
            _ => return self.wrong("a value is missing here: a number, a date or a \"text\""),
        };
        self.at += 1;
        Ok(literal)
    }
}

/// Words of the language.
const RESERVED: [&str; 5] = ["and", "or", "not", "in", "contains"];

fn is_reserved(word: &str) -> bool {
    RESERVED.iter().any(|own| own.eq_ignore_ascii_case(word))
}

/// What a word means as a value: a number, a date that is finer than a year, or itself.
fn of_word(word: &str) -> Literal {
    if let Some(number) = word.parse::<f64>().ok().filter(|number| number.is_finite()) {
        return Literal::Number(number);
    }
    let begins = word.as_bytes().first().is_some_and(u8::is_ascii_digit);
    match Interval::parse(word).ok().filter(|date| begins && date.begin.is_some()) {
        Some(date) => Literal::Date(word.to_owned(), date),
        None => Literal::Text(word.to_owned()),
    }
}
