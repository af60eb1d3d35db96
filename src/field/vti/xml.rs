//! XML by its tags, as far as VTK writes it.

/// What is wrong, and where, in bytes.
pub struct Fault {
    pub at: usize,
    pub message: String,
}

/// A tag that begins an element, or is one.
pub struct Element<'a> {
    pub name: &'a str,
    /// Where it begins, in bytes.
    pub at: usize,
    /// Whether it has no content.
    pub is_closed: bool,
    attributes: Vec<Attribute<'a>>,
}

struct Attribute<'a> {
    name: &'a str,
    value: String,
}

/// A tag.
pub enum Tag<'a> {
    Open(Element<'a>),
    Close(&'a str),
}

impl Element<'_> {
    /// The value of an attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|attribute| attribute.name == name).map(|attribute| attribute.value.as_str())
    }
}

/// The tags of a file, one after the other.
pub struct Tags<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tags<'a> {
    /// The tags in these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// The text up to the next tag.
    pub fn content(&self) -> &'a [u8] {
        let rest = self.rest();
        rest.get(..find(rest, b"<").unwrap_or(rest.len())).unwrap_or_default()
    }

    /// The next tag; none at the end.
    pub fn next(&mut self) -> Result<Option<Tag<'a>>, Fault> {
        loop {
            let Some(before) = find(self.rest(), b"<") else { return Ok(None) };
            self.at += before;
            let at = self.at;
            let fault = |message: &str| Fault { at, message: message.to_owned() };
            let rest = self.rest();
            let end: &[u8] = match rest {
                [b'<', b'!', b'-', b'-', ..] => b"-->",
                [b'<', b'!', b'[', ..] => b"]]>",
                [b'<', b'?', ..] => b"?>",
                _ => b">",
            };
            let Some(length) = find(rest, end) else {
                return Err(fault("a tag of XML is not closed; is the file complete?"));
            };
            self.at += length + end.len();
            let inside = rest.get(1..length).unwrap_or_default();
            if matches!(inside.first(), Some(b'!' | b'?')) {
                continue;
            }
            let text = std::str::from_utf8(inside).map_err(|_| fault("a tag of XML is no UTF-8"))?;
            return tag(text, at)
                .map(Some)
                .ok_or_else(|| fault("a tag of XML is damaged; <Name key=\"value\"> belongs here"));
        }
    }
}

fn tag(text: &str, at: usize) -> Option<Tag<'_>> {
    if let Some(name) = text.strip_prefix('/') {
        return Some(Tag::Close(name.trim()));
    }
    let (text, is_closed) = text.strip_suffix('/').map_or((text, false), |text| (text, true));
    let name = text.split_whitespace().next()?;
    let mut rest = text.trim_start().get(name.len()..)?.trim_start();
    let mut attributes = Vec::new();
    while !rest.is_empty() {
        let (name, after) = rest.split_once('=').filter(|(name, _)| !name.trim().contains(char::is_whitespace))?;
        let after = after.trim_start();
        let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        let (value, after) = after.get(1..)?.split_once(quote)?;
        attributes.push(Attribute { name: name.trim(), value: plain(value) });
        rest = after.trim_start();
    }
    Some(Tag::Open(Element { name, at, is_closed, attributes }))
}

/// The text of an attribute, its entities resolved; those that are not known stay.
fn plain(text: &str) -> String {
    let mut parts = text.split('&');
    let mut plain = parts.next().unwrap_or("").to_owned();
    for part in parts {
        let (entity, after) = part.split_once(';').unwrap_or(("", part));
        let code = |digits: &str, radix| u32::from_str_radix(digits, radix).ok().and_then(char::from_u32);
        let known = match entity {
            "lt" => Some('<'),
            "gt" => Some('>'),
            "amp" => Some('&'),
            "quot" => Some('"'),
            "apos" => Some('\''),
            _ => entity
                .strip_prefix("#x")
                .map(|hex| code(hex, 16))
                .or(entity.strip_prefix('#').map(|n| code(n, 10)))
                .flatten(),
        };
        match known {
            Some(c) => {
                plain.push(c);
                plain.push_str(after);
            }
            None => {
                plain.push('&');
                plain.push_str(part);
            }
        }
    }
    plain
}

/// Where a text begins in bytes.
pub fn find(bytes: &[u8], needle: &[u8]) -> Option<usize> {
    let (first, others) = needle.split_first()?;
    let mut from = 0;
    loop {
        let at = from + bytes.get(from..)?.iter().position(|b| b == first)?;
        if bytes.get(at + 1..)?.starts_with(others) {
            return Some(at);
        }
        from = at + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_and_what_is_between() {
        let text = b"<?xml version='1.0'?><!-- <no> --><A b=\"1 &lt;&#65;&x;\" c='\"'>text<B/></A>";
        let mut tags = Tags::new(text);
        let Ok(Some(Tag::Open(a))) = tags.next() else { panic!("an element") };
        assert_eq!((a.name, a.get("b"), a.get("c"), a.get("d")), ("A", Some("1 <A&x;"), Some("\""), None));
        assert_eq!(tags.content(), b"text");
        assert!(matches!(tags.next(), Ok(Some(Tag::Open(b))) if b.is_closed));
        assert!(matches!(tags.next(), Ok(Some(Tag::Close("A")))));
        assert!(matches!(tags.next(), Ok(None)));
        for wrong in ["<A", "<A b>", "<A b=1>", "<A b=\"1>", "<>"] {
            assert!(Tags::new(wrong.as_bytes()).next().is_err(), "{wrong}");
        }
    }
}
