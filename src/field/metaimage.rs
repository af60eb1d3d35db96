//! MetaImage (`.mha`, or `.mhd` with its data beside): lines of `Key = value`, then the numbers.

use std::borrow::Cow;

use glam::DVec3;

use crate::field::{
    error::FieldError,
    grid::Grid,
    input::{Input, can_become, inflate},
    numbers::{self, Layout, Meaning, NumberKind, Numbers},
    output::Output,
    words::{Words, all_numbers, all_whole},
};

/// The header.
struct Header {
    lines: Vec<Line>,
    /// Where it ends, in bytes.
    end: usize,
}

struct Line {
    key: String,
    value: String,
    at: usize,
}

impl Header {
    /// The lines up to that which says where the data are, which is the last.
    fn read(input: &Input<'_>) -> Result<Self, FieldError> {
        let mut words = Words::new(&input.bytes);
        let mut lines: Vec<Line> = Vec::new();
        loop {
            let at = words.at();
            let Some(text) = words.text_line() else {
                return Err(input.at(at, "the header has no `ElementDataFile`; it belongs behind all other lines"));
            };
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let Some((key, value)) = text.split_once('=') else {
                return Err(input.at(at, format!("\"{text}\" is no line of a header; `Key = value` belongs here")));
            };
            let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
            let is_last = key == "ElementDataFile";
            lines.push(Line { key, value, at });
            if is_last {
                return Ok(Self { lines, end: words.at() });
            }
        }
    }

    fn get(&self, keys: &[&str]) -> Option<&Line> {
        self.lines.iter().find(|line| keys.contains(&line.key.as_str()))
    }

    fn text(&self, key: &str) -> &str {
        self.get(&[key]).map_or("", |line| &line.value)
    }

    fn is_true(&self, keys: &[&str]) -> bool {
        self.get(keys).is_some_and(|line| line.value.eq_ignore_ascii_case("true") || line.value == "1")
    }

    /// So many numbers, if the key is there.
    fn numbers(&self, input: &Input<'_>, keys: &[&str], count: usize) -> Result<Option<Vec<f64>>, FieldError> {
        let Some(line) = self.get(keys) else { return Ok(None) };
        all_numbers(&line.value).filter(|all| all.len() >= count).map(Some).ok_or_else(|| {
            input.at(line.at, format!("`{}` is \"{}\"; {count} numbers belong there", line.key, line.value))
        })
    }
}

/// Reads a MetaImage file.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let header = Header::read(input)?;
    let line = header
        .get(&["DimSize"])
        .ok_or_else(|| input.at(0, "the header has no `DimSize`, like `DimSize = 64 64 32`"))?;
    let sizes = all_whole(&line.value).filter(|sizes| (1..=3).contains(&sizes.len())).ok_or_else(|| {
        input.at(line.at, format!("`DimSize` is \"{}\"; samples along 1 to 3 axes belong there", line.value))
    })?;
    let at = |axis: usize| sizes.get(axis).copied().unwrap_or(1);
    let size = [at(0), at(1), at(2)];
    let kind = header
        .get(&["ElementType"])
        .ok_or_else(|| input.at(0, "the header has no `ElementType`, like `ElementType = MET_SHORT`"))?;
    let kind = number_kind(&kind.value).map_err(|message| input.at(kind.at, message))?;
    let channels = header.numbers(input, &["ElementNumberOfChannels"], 1)?;
    let components = channels.and_then(|all| all.first().copied()).map_or(1, |n| n.max(0.0) as usize);
    output.reserve(size, components, if kind == NumberKind::U8 { 1 } else { 4 }).map_err(|m| input.at(line.at, m))?;
    let grid = grid(input, &header, size, sizes.len())?;
    let layout = Layout::dense(kind, size, components);
    let needed = layout.count().saturating_mul(kind.bytes());
    let data = data(input, &header, kind, needed)?;
    let values = numbers::values(&data, &layout, &Meaning::PLAIN).map_err(|message| input.at(header.end, message))?;
    output.add(input.stem(), grid, components, values).map_err(|message| input.fail(message))
}

fn grid(input: &Input<'_>, header: &Header, size: [usize; 3], axes: usize) -> Result<Grid, FieldError> {
    let spacing = header.numbers(input, &["ElementSpacing", "ElementSize"], axes)?.unwrap_or(vec![1.0; axes]);
    let origin = header.numbers(input, &["Offset", "Position", "Origin"], axes)?.unwrap_or(vec![0.0; axes]);
    let matrix = header.numbers(input, &["TransformMatrix", "Rotation", "Orientation"], axes * axes)?;
    let place = |numbers: &[f64]| {
        let at = |axis: usize| numbers.get(axis).copied().filter(|_| axis < axes).unwrap_or(0.0);
        DVec3::new(at(0), at(1), at(2))
    };
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    let steps = std::array::from_fn(|axis| {
        let own = matrix.as_ref().and_then(|all| all.get(axis * axes..(axis + 1) * axes)).filter(|_| axis < axes);
        own.map_or(units[axis], place) * spacing.get(axis).copied().unwrap_or(1.0)
    });
    Grid::new(size, place(&origin), steps).map_err(|message| input.fail(message))
}

/// The numbers, of `needed` bytes when they are packed.
fn data<'a>(input: &'a Input<'_>, header: &Header, kind: NumberKind, needed: usize) -> Result<Numbers<'a>, FieldError> {
    let name = header.text("ElementDataFile");
    let line = header.get(&["ElementDataFile"]).map_or(0, |line| line.at);
    if name.starts_with("LIST") || name.contains('%') {
        return Err(input.at(line, "the data are in several files; save them in one"));
    }
    if name.eq_ignore_ascii_case("LOCAL") {
        let bytes = input.bytes.get(header.end..).unwrap_or_default();
        return unpacked(input, header, bytes, kind, needed).map_err(|message| input.at(header.end, message));
    }
    let file = input.beside(name, false)?;
    let numbers = unpacked(input, header, &file.bytes, kind, needed).map_err(|message| file.fail(message))?;
    Ok(Numbers { bytes: Cow::Owned(numbers.bytes.into_owned()), ..numbers })
}

fn unpacked<'a>(
    input: &Input<'_>,
    header: &Header,
    bytes: &'a [u8],
    kind: NumberKind,
    needed: usize,
) -> Result<Numbers<'a>, String> {
    if header.get(&["BinaryData"]).is_some() && !header.is_true(&["BinaryData"]) {
        return Words::new(bytes).numbers(kind, needed / kind.bytes());
    }
    let is_big = header.is_true(&["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]);
    let skip = header.numbers(input, &["HeaderSize"], 1).map_err(|error| error.message)?;
    let mut bytes = Cow::Borrowed(match skip.and_then(|all| all.first().copied()) {
        Some(skip) if skip < 0.0 => bytes.get(bytes.len().saturating_sub(needed)..).unwrap_or_default(),
        Some(skip) => bytes.get(skip as usize..).unwrap_or_default(),
        None => bytes,
    });
    if header.is_true(&["CompressedData"]) {
        if !can_become(bytes.len(), needed) {
            return Err(format!("{} bytes cannot become {needed}; is the file damaged?", bytes.len()));
        }
        let mut all = Vec::new();
        inflate(&bytes, needed as u64, &mut all)?;
        bytes = Cow::Owned(all);
    }
    if bytes.len() < needed {
        return Err(format!("{needed} bytes of data belong here, there are {}; is the file complete?", bytes.len()));
    }
    Ok(Numbers::packed(kind, is_big, bytes))
}

fn number_kind(name: &str) -> Result<NumberKind, String> {
    Ok(match name.trim_end_matches("_ARRAY") {
        "MET_UCHAR" => NumberKind::U8,
        "MET_CHAR" => NumberKind::I8,
        "MET_USHORT" => NumberKind::U16,
        "MET_SHORT" => NumberKind::I16,
        "MET_UINT" => NumberKind::U32,
        "MET_INT" => NumberKind::I32,
        "MET_ULONG" | "MET_ULONG_LONG" => NumberKind::U64,
        "MET_LONG" | "MET_LONG_LONG" => NumberKind::I64,
        "MET_FLOAT" => NumberKind::F32,
        "MET_DOUBLE" => NumberKind::F64,
        other => {
            return Err(format!(
                "`ElementType` is \"{other}\"; MET_UCHAR, MET_SHORT or MET_FLOAT belongs there, for example"
            ));
        }
    })
}

#[cfg(test)]
mod tests;
