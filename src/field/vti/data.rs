//! The numbers of a VTK XML file: text, base64 or raw, as they are or in compressed blocks.

use std::borrow::Cow;

use crate::field::{
    input::{Input, can_become, inflate},
    numbers::{NumberKind, Numbers},
    vti::{
        whole_number,
        xml::{Element, find},
    },
    words::Words,
};

/// How all numbers of a file are packed.
#[derive(Clone, Copy, Default)]
pub struct Encoding {
    is_big: bool,
    /// Whether the lengths before data have 64 bits.
    is_long: bool,
    is_compressed: bool,
}

/// Data behind all elements.
pub struct Appended {
    /// Where its element begins, in bytes.
    pub tag: usize,
    /// Where the data begin.
    start: usize,
    is_raw: bool,
}

impl Appended {
    /// Looks for the element; what is behind it is no XML.
    pub fn find(bytes: &[u8]) -> Option<Self> {
        let tag = find(bytes, b"<AppendedData")?;
        let rest = bytes.get(tag..)?;
        let end = find(rest, b">")?;
        let is_raw = find(rest.get(..end)?, b"raw").is_some();
        let space = rest.get(end + 1..)?.iter().take_while(|b| b.is_ascii_whitespace()).count();
        let mark = tag + end + 1 + space;
        let start = if bytes.get(mark) == Some(&b'_') { mark + 1 } else { mark };
        Some(Self { tag, start, is_raw })
    }
}

impl Encoding {
    /// What the outermost element says.
    pub fn of(element: &Element<'_>) -> Result<Self, String> {
        match element.get("type").unwrap_or("") {
            "ImageData" => {}
            "PImageData" => return Err("the file is an index of pieces; open these, or save one file".into()),
            other => return Err(format!("the file holds {other}; ImageData can be read, so resample it to an image")),
        }
        let is_compressed = match element.get("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(format!(
                    "its data are compressed with {other}; save them with vtkZLibDataCompressor, or none"
                ));
            }
        };
        let is_long = match element.get("header_type") {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(other) => return Err(format!("header_type is \"{other}\"; UInt32 or UInt64 belongs there")),
        };
        Ok(Self { is_big: element.get("byte_order") == Some("BigEndian"), is_long, is_compressed })
    }

    /// The first `count` numbers of a DataArray. `content`: the text in it.
    pub fn numbers(
        &self,
        element: &Element<'_>,
        content: &[u8],
        appended: Option<&Appended>,
        input: &Input<'_>,
        kind: NumberKind,
        count: usize,
    ) -> Result<Numbers<'static>, String> {
        let needed = count.saturating_mul(kind.bytes());
        let bytes = match element.get("format") {
            None | Some("ascii") => return Words::new(content).numbers(kind, count),
            Some("binary") => self.unpacked(&mut Base64::new(content), needed)?,
            Some("appended") => {
                let appended = appended.ok_or("its data are appended, but there is no AppendedData")?;
                let offset = whole_number(element, "offset").ok_or("it has no offset into AppendedData")?;
                let from = appended.start.saturating_add(offset);
                let data = input.bytes.get(from..).filter(|data| !data.is_empty()).ok_or_else(|| {
                    format!("its offset {offset} is behind the end of the file; is the file complete?")
                })?;
                match appended.is_raw {
                    true => self.unpacked(&mut Raw(data), needed)?,
                    false => self.unpacked(&mut Base64::new(data), needed)?,
                }
            }
            Some(other) => return Err(format!("its format is \"{other}\"; ascii, binary or appended belongs there")),
        };
        Ok(Numbers::packed(kind, self.is_big, bytes))
    }

    /// The data, without the lengths before them, unpacked; exactly `needed` bytes.
    fn unpacked(&self, source: &mut impl Source, needed: usize) -> Result<Vec<u8>, String> {
        if !self.is_compressed {
            let length = self.length(source)?;
            if length < needed {
                return Err(format!("its data have {length} bytes, the extent needs {needed}"));
            }
            return Ok(source.take(needed)?.into_owned());
        }
        let (blocks, block, last) = (self.length(source)?, self.length(source)?, self.length(source)?);
        // A last block of size 0 is a full one.
        let total = match (blocks, last) {
            (0, _) => 0,
            (_, 0) => blocks.saturating_mul(block),
            (_, last) => (blocks - 1).saturating_mul(block).saturating_add(last),
        };
        if total < needed {
            return Err(format!("its {blocks} blocks have {total} bytes, the extent needs {needed}"));
        }
        let mut lengths = Vec::new();
        for _ in 0..blocks {
            lengths.push(self.length(source)?);
        }
        source.part();
        let packed = lengths.iter().fold(0_usize, |sum, n| sum.saturating_add(*n));
        if !can_become(packed, total) {
            return Err(format!("its {packed} bytes cannot become {total}; is the file damaged?"));
        }
        let mut bytes = Vec::new();
        for (i, length) in lengths.iter().enumerate() {
            if bytes.len() >= needed {
                break;
            }
            let size = if i + 1 == blocks && last > 0 { last } else { block };
            let start = bytes.len();
            inflate(&source.take(*length)?, size as u64, &mut bytes)?;
            if bytes.len() - start != size {
                return Err(format!("block {i} has {} bytes, {size} belong there", bytes.len() - start));
            }
        }
        bytes.truncate(needed);
        Ok(bytes)
    }

    fn length(&self, source: &mut impl Source) -> Result<usize, String> {
        let bytes = source.take(if self.is_long { 8 } else { 4 })?;
        let fold = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        let value = match self.is_big {
            true => bytes.iter().fold(0, fold),
            false => bytes.iter().rev().fold(0, fold),
        };
        usize::try_from(value).map_err(|_| "its data are too long".to_owned())
    }
}

/// The type of the numbers of a DataArray.
pub fn number_kind(element: &Element<'_>) -> Result<NumberKind, String> {
    Ok(match element.get("type").unwrap_or("") {
        "Int8" => NumberKind::I8,
        "UInt8" => NumberKind::U8,
        "Int16" => NumberKind::I16,
        "UInt16" => NumberKind::U16,
        "Int32" => NumberKind::I32,
        "UInt32" => NumberKind::U32,
        "Int64" => NumberKind::I64,
        "UInt64" => NumberKind::U64,
        "Float32" => NumberKind::F32,
        "Float64" => NumberKind::F64,
        other => return Err(format!("its type is \"{other}\"; Int8 to UInt64, Float32 or Float64 belongs there")),
    })
}

/// Bytes, one after the other.
trait Source {
    /// The next bytes, all of them.
    fn take(&mut self, count: usize) -> Result<Cow<'_, [u8]>, String>;

    /// What comes is packed on its own.
    fn part(&mut self) {}
}

struct Raw<'a>(&'a [u8]);

impl Source for Raw<'_> {
    fn take(&mut self, count: usize) -> Result<Cow<'_, [u8]>, String> {
        let (own, rest) = self.0.split_at_checked(count).ok_or_else(|| too_short(count, self.0.len()))?;
        self.0 = rest;
        Ok(Cow::Borrowed(own))
    }
}

fn too_short(wanted: usize, left: usize) -> String {
    format!("{wanted} bytes belong here, {left} are left; is the file complete?")
}

/// Base64, in parts that may end in `=` and are decoded as if they were one.
struct Base64<'a> {
    text: std::slice::Iter<'a, u8>,
    /// Bytes that are decoded and not yet taken, the last first.
    ready: Vec<u8>,
}

impl<'a> Base64<'a> {
    fn new(text: &'a [u8]) -> Self {
        Self { text: text.iter(), ready: Vec::new() }
    }

    /// Decodes four digits more; whether there were any.
    fn decode(&mut self) -> Result<bool, String> {
        let (mut digits, mut bits, mut filled) = (0, 0_u32, 0);
        while digits + filled < 4 {
            let Some(byte) = self.text.next() else { break };
            let digit = match byte {
                b'A'..=b'Z' => byte - b'A',
                b'a'..=b'z' => byte - b'a' + 26,
                b'0'..=b'9' => byte - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' => {
                    filled += 1;
                    continue;
                }
                b if b.is_ascii_whitespace() => continue,
                // The end of appended data.
                b'<' => break,
                other => return Err(format!("\"{}\" is no digit of base64", char::from(*other).escape_default())),
            };
            bits = bits << 6 | u32::from(digit);
            digits += 1;
        }
        let [_, a, b, c] = (bits << (6 * (4 - digits))).to_be_bytes();
        let decoded: &[u8] = match digits {
            4 => &[c, b, a],
            3 => &[b, a],
            2 => &[a],
            _ => &[],
        };
        self.ready.splice(..0, decoded.iter().copied());
        Ok(!decoded.is_empty())
    }
}

impl Source for Base64<'_> {
    fn take(&mut self, count: usize) -> Result<Cow<'_, [u8]>, String> {
        let mut taken = Vec::with_capacity(count.min(self.text.len() / 4 * 3 + 3));
        while taken.len() < count {
            match self.ready.pop() {
                Some(byte) => taken.push(byte),
                None if self.decode()? => {}
                None => return Err(too_short(count, taken.len())),
            }
        }
        Ok(Cow::Owned(taken))
    }

    /// Bits that are left of what was packed before are none of it.
    fn part(&mut self) {
        self.ready.clear();
    }
}
