//! NRRD, versions 1 to 5 (<https://teem.sourceforge.net/nrrd/format.html>).
//!
//! A header of lines, then the data or the names of the files that have them. Coordinates stay in the space of the file.

mod axes;
mod header;
mod write;

use std::borrow::Cow;

use crate::field::{
    data::Step,
    error::FieldError,
    input::{Input, gunzip_first},
    nrrd::{
        axes::Axes,
        header::{DataFiles, Encoding, Header},
    },
    numbers::{self, Meaning, NumberKind, Numbers},
    output::Output,
    words::Words,
};

pub use write::{Packing, write_nrrd};

/// How a file begins; a digit follows.
pub const MAGIC: &[u8] = b"NRRD000";

/// Reads an NRRD file, with its data or detached.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let header = Header::read(input)?;
    let axes = Axes::new(&header).map_err(|message| input.at(header.end, message))?;
    for note in &axes.notes {
        output.warn(note);
    }
    let kind = header.kind;
    let size = axes.size();
    let steps = axes.steps();
    let count = steps.saturating_mul(axes.components()).saturating_mul(size.iter().product());
    let value_bytes = if kind == NumberKind::U8 { 1 } else { 4 };
    let reserved = output.reserve_steps(size, axes.components(), value_bytes, steps);
    reserved.map_err(|message| input.fail(message))?;
    let data = data(input, &header, count)?;
    let mut all = Vec::with_capacity(steps);
    for step in 0..steps {
        let layout = axes.layout(kind, step);
        let values = numbers::values(&data, &layout, &Meaning::PLAIN).map_err(|message| input.fail(message))?;
        all.push(Step { time: axes.time(step), values });
    }
    let name = header.content.clone().unwrap_or_else(|| input.stem());
    let components = axes.components();
    output.add_steps(name, axes.grid, components, all).map_err(|message| input.fail(message))?;
    output.set_unit(header.unit.as_deref().unwrap_or(""));
    Ok(())
}

/// The numbers of all axes, `count` of them.
fn data<'a>(input: &'a Input<'_>, header: &Header, count: usize) -> Result<Numbers<'a>, FieldError> {
    let names = match &header.files {
        DataFiles::Attached => {
            let rest = input.bytes.get(header.end..).unwrap_or_default();
            return unpacked(input, header, rest, header.end, count);
        }
        DataFiles::Listed(names) => Cow::Borrowed(names),
        DataFiles::Numbered(pattern) => Cow::Owned(pattern.names()),
    };
    let each = count / names.len().max(1);
    if each.checked_mul(names.len()) != Some(count) {
        return Err(input.at(header.end, format!("{count} numbers cannot be in {} files of one size", names.len())));
    }
    let mut all = Numbers::packed(header.kind, header.is_big, Vec::new());
    for name in names.iter() {
        let file = input.beside(name, false)?;
        let part = unpacked(&file, header, &file.bytes, 0, each)?;
        all.is_big = part.is_big;
        if names.len() == 1 {
            return Ok(Numbers { bytes: Cow::Owned(part.bytes.into_owned()), ..part });
        }
        all.bytes.to_mut().extend_from_slice(part.bytes.get(..each * header.kind.bytes()).unwrap_or_default());
    }
    Ok(all)
}

/// `count` numbers out of the data of a file, of which all before byte `start` is header.
fn unpacked<'a>(
    file: &Input<'_>,
    header: &Header,
    data: &'a [u8],
    start: usize,
    count: usize,
) -> Result<Numbers<'a>, FieldError> {
    let mut words = Words::new(data);
    for _ in 0..header.line_skip {
        if words.line().is_none() {
            let lines = header.line_skip;
            return Err(file.at(start, format!("`line skip: {lines}` goes past the end of the data")));
        }
    }
    let start = start + words.at();
    let mut bytes = Cow::Borrowed(words.rest());
    let needed = count.saturating_mul(header.kind.bytes());
    if header.encoding == Encoding::Gzip {
        let most = needed.saturating_add(header.byte_skip.unwrap_or(0)) as u64;
        let unpacked = gunzip_first(&bytes, most);
        let failed = |message| file.at(start, format!("`encoding: gzip`, and the data {message}"));
        bytes = Cow::Owned(unpacked.map_err(failed)?);
    }
    let skip = match header.byte_skip {
        // From the end.
        None => bytes.len().saturating_sub(needed),
        Some(skip) => skip,
    };
    if skip > 0 {
        let rest = match bytes {
            Cow::Borrowed(bytes) => bytes.get(skip..).map(Cow::Borrowed),
            Cow::Owned(bytes) => bytes.get(skip..).map(|rest| Cow::Owned(rest.to_vec())),
        };
        bytes = rest.ok_or_else(|| file.at(start, format!("`byte skip: {skip}` goes past the end of the data")))?;
    }
    let kind = header.kind;
    match header.encoding {
        Encoding::Raw | Encoding::Gzip if bytes.len() < needed => Err(file.at(
            start,
            format!(
                "the header's sizes and type need {needed} bytes of data, there are {}; is the file complete?",
                bytes.len()
            ),
        )),
        Encoding::Raw | Encoding::Gzip => Ok(Numbers::packed(kind, header.is_big, bytes)),
        Encoding::Text => {
            let mut words = Words::new(&bytes);
            words.numbers(kind, count).map_err(|message| file.at(start + skip + words.at(), message))
        }
        Encoding::Hex => hex(&bytes, needed)
            .map(|bytes| Numbers::packed(kind, header.is_big, bytes))
            .map_err(|message| file.at(start, message)),
    }
}

/// So many bytes out of pairs of hexadecimal digits.
fn hex(text: &[u8], count: usize) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(count.min(text.len() / 2));
    let mut digits = text.iter().filter(|b| !b.is_ascii_whitespace());
    let mut digit = || digits.next().and_then(|b| char::from(*b).to_digit(16));
    while bytes.len() < count {
        let (Some(high), Some(low)) = (digit(), digit()) else {
            return Err(format!(
                "{count} bytes of hexadecimal digits belong here, there are {}; is the file complete?",
                bytes.len()
            ));
        };
        bytes.push((high * 16 + low) as u8);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests;
