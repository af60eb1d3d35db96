//! Legacy VTK files (`.vtk`) of structured points, rectilinear and structured grids.
//!
//! Lines of text with numbers between them, as text or as big-endian bytes (<https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>).

mod geometry;

use crate::field::{
    data::{Step, Values},
    error::FieldError,
    input::Input,
    numbers::{self, Layout, Meaning, NumberKind, Numbers},
    output::Output,
    vtk::geometry::Geometry,
    words::Words,
};

/// How a file begins.
pub const MAGIC: &[u8] = b"# vtk DataFile";

/// A file under way.
struct Reader<'a> {
    input: &'a Input<'a>,
    words: Words<'a>,
    is_binary: bool,
    geometry: Geometry,
    /// The samples that the arrays which come are at.
    samples: Option<Samples>,
    time: Option<f64>,
}

#[derive(Clone, Copy)]
struct Samples {
    count: usize,
    is_cells: bool,
}

/// Reads a legacy VTK file.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let mut words = Words::new(&input.bytes);
    words.line();
    words.line();
    let at = words.at();
    let is_binary = match words.text_line().as_deref().map(str::to_uppercase).as_deref() {
        Some("ASCII") => false,
        Some("BINARY") => true,
        _ => return Err(input.at(at, "the third line must be ASCII or BINARY")),
    };
    let geometry = Geometry::default();
    Reader { input, words, is_binary, geometry, samples: None, time: None }.read(output)
}

impl<'a> Reader<'a> {
    fn read(mut self, output: &mut Output) -> Result<(), FieldError> {
        loop {
            self.words.skip_space();
            let at = self.words.at();
            let Some(word) = self.words.next() else { return Ok(()) };
            let keyword = word.to_uppercase();
            let result = match keyword.as_str() {
                "DATASET" => self.dataset(),
                "DIMENSIONS" | "EXTENT" | "ORIGIN" | "SPACING" | "ASPECT_RATIO" => self.placement(&keyword),
                "X_COORDINATES" | "Y_COORDINATES" | "Z_COORDINATES" => self.coordinates(&keyword),
                "POINTS" => self.points(),
                "METADATA" => self.skip_metadata(),
                "POINT_DATA" | "CELL_DATA" => self.begin_data(keyword == "CELL_DATA"),
                "FIELD" => self.field(output),
                "LOOKUP_TABLE" => self.skip_table(),
                _ if self.samples.is_some() => self.attribute(&keyword, output),
                _ => Err(format!("\"{word}\" is no keyword that can stand here")),
            };
            result.map_err(|message| self.input.at(at, message))?;
        }
    }

    fn word(&mut self, what: &str) -> Result<&'a str, String> {
        self.words.next().ok_or_else(|| format!("{what} belongs here, the file ends"))
    }

    fn whole(&mut self, what: &str) -> Result<usize, String> {
        let word = self.word(what)?;
        word.parse().map_err(|_| format!("\"{word}\" stands where {what} belongs: a whole number"))
    }

    fn number(&mut self, what: &str) -> Result<f64, String> {
        self.words.number().ok_or_else(|| format!("{what} belongs here: a number"))
    }

    fn dataset(&mut self) -> Result<(), String> {
        let kind = self.word("the kind of data set")?.to_uppercase();
        self.geometry = Geometry::new(&kind)?;
        Ok(())
    }

    fn placement(&mut self, keyword: &str) -> Result<(), String> {
        self.geometry.forget_ways();
        match keyword {
            "DIMENSIONS" => {
                for axis in 0..3 {
                    self.geometry.size[axis] = self.whole("samples along x, y and z")?;
                }
            }
            "EXTENT" => {
                for axis in 0..3 {
                    let (first, last) = (self.number("a first sample")?, self.number("a last sample")?);
                    self.geometry.size[axis] = (last - first + 1.0).max(0.0) as usize;
                    self.geometry.first[axis] = first;
                }
            }
            "ORIGIN" => {
                for axis in 0..3 {
                    self.geometry.origin[axis] = self.number("an origin of three coordinates")?;
                }
            }
            _ => {
                for axis in 0..3 {
                    self.geometry.spacing[axis] = self.number("a spacing along x, y and z")?;
                }
            }
        }
        Ok(())
    }

    fn coordinates(&mut self, keyword: &str) -> Result<(), String> {
        self.geometry.forget_ways();
        let axis = ["X", "Y", "Z"].iter().position(|name| keyword.starts_with(name)).unwrap_or(0);
        let count = self.whole("how many coordinates there are")?;
        let kind = self.kind()?;
        self.geometry.axes[axis] = self.numbers(&kind, count)?.all();
        Ok(())
    }

    fn points(&mut self) -> Result<(), String> {
        self.geometry.forget_ways();
        let count = self.whole("how many points there are")?;
        let kind = self.kind()?;
        let numbers = self.numbers(&kind, count.saturating_mul(3))?;
        self.geometry.set_points(&numbers);
        Ok(())
    }

    /// Lines up to an empty one.
    fn skip_metadata(&mut self) -> Result<(), String> {
        self.words.line();
        while self.words.line().is_some_and(|line| !line.trim_ascii().is_empty()) {}
        Ok(())
    }

    fn begin_data(&mut self, is_cells: bool) -> Result<(), String> {
        let count = self.whole("how many samples there are")?;
        self.samples = None;
        if count == 0 {
            return Ok(());
        }
        let size = self.geometry.sample_size(is_cells);
        let wanted = size.iter().fold(1_usize, |count, n| count.saturating_mul(*n));
        if count != wanted {
            let [x, y, z] = size;
            return Err(format!("there are data for {count} samples, but the grid has {x} × {y} × {z} of them"));
        }
        self.samples = Some(Samples { count, is_cells });
        Ok(())
    }

    /// A table of colours, which tells nothing about the values.
    fn skip_table(&mut self) -> Result<(), String> {
        self.word("the name of a table")?;
        let count = self.whole("the size of the table")?;
        let kind = if self.is_binary { Kind::Number(NumberKind::U8) } else { Kind::Number(NumberKind::F32) };
        self.numbers(&kind, count.saturating_mul(4)).map(drop)
    }

    /// Arrays, each with its own number of components; before all data they belong to the file.
    fn field(&mut self, output: &mut Output) -> Result<(), String> {
        self.word("a name")?;
        let arrays = self.whole("how many arrays there are")?;
        for _ in 0..arrays {
            let mut name = self.word("the name of an array")?;
            while name == "METADATA" {
                self.skip_metadata()?;
                name = self.word("the name of an array")?;
            }
            let components = self.whole("the number of components")?;
            let tuples = self.whole("the number of samples")?;
            let kind = self.kind()?;
            let count = components.saturating_mul(tuples);
            if let Kind::Text = kind {
                output.warn(format!("the array \"{}\" is text; it is left out", decoded(name)));
                self.skip_text(count)?;
                continue;
            }
            match self.samples {
                Some(samples) if samples.count == tuples => self.array(name, components, &kind, output)?,
                Some(samples) => {
                    return Err(format!("the array \"{name}\" has {tuples} samples, {} belong there", samples.count));
                }
                None => {
                    let numbers = self.numbers(&kind, count)?;
                    if ["TIME", "TimeValue"].contains(&name) && count > 0 {
                        self.time = Some(numbers.at_byte(0));
                    }
                }
            }
        }
        Ok(())
    }

    /// Strings: a line each; in binary files, a length before each.
    fn skip_text(&mut self, count: usize) -> Result<(), String> {
        self.words.line();
        for _ in 0..count {
            if !self.is_binary {
                self.words.line().ok_or("the file ends within an array of text")?;
                continue;
            }
            // Two bits say how many bytes the length has.
            let first = *self.words.rest().first().ok_or("the file ends within an array of text")?;
            let bytes = 8 >> (first >> 6);
            let length = self.words.take(bytes).ok_or("the file ends within an array of text")?;
            let head = u64::from(first & 0x3f);
            let length = length.iter().skip(1).fold(head, |length, byte| length << 8 | u64::from(*byte));
            self.words.skip(usize::try_from(length).unwrap_or(usize::MAX));
        }
        Ok(())
    }

    /// An array of a name that its keyword says the number of components of.
    fn attribute(&mut self, keyword: &str, output: &mut Output) -> Result<(), String> {
        let name = self.word("the name of an array")?;
        let components = match keyword {
            "COLOR_SCALARS" => {
                let components = self.whole("the number of components")?;
                let kind = if self.is_binary { NumberKind::U8 } else { NumberKind::F32 };
                return self.array(name, components, &Kind::Number(kind), output);
            }
            "TEXTURE_COORDINATES" => self.whole("the number of components")?,
            "VECTORS" | "NORMALS" => 3,
            "TENSORS" => 9,
            "TENSORS6" => 6,
            "SCALARS" | "GLOBAL_IDS" | "PEDIGREE_IDS" => 1,
            other => return Err(format!("\"{other}\" is no kind of data that is known")),
        };
        let kind = self.kind()?;
        if keyword != "SCALARS" {
            return self.array(name, components, &kind, output);
        }
        let line = self.words.text_line().unwrap_or_default();
        let components = match line.as_str() {
            "" => 1,
            text => text.parse().map_err(|_| format!("\"{text}\" stands where the number of components belongs"))?,
        };
        if self.words.peek().is_some_and(|word| word.eq_ignore_ascii_case("LOOKUP_TABLE")) {
            self.words.next();
            self.word("the name of a table")?;
            self.array(name, components, &kind, output)
        } else {
            // No table, and the line is over: bytes begin here.
            self.array_after_line(name, components, &kind, output)
        }
    }

    /// An array that begins in the next line.
    fn array(&mut self, name: &str, components: usize, kind: &Kind, output: &mut Output) -> Result<(), String> {
        self.words.line();
        self.array_after_line(name, components, kind, output)
    }

    fn array_after_line(
        &mut self,
        name: &str,
        components: usize,
        kind: &Kind,
        output: &mut Output,
    ) -> Result<(), String> {
        let Some(samples) = self.samples else { return Err("there is no POINT_DATA or CELL_DATA before it".into()) };
        let name = decoded(name);
        let named = |message: String| format!("the array \"{name}\": {message}");
        let size = self.geometry.sample_size(samples.is_cells);
        let kind_bytes = if matches!(kind, Kind::Bits | Kind::Number(NumberKind::U8)) { 1 } else { 4 };
        output.reserve(size, components, kind_bytes).map_err(named)?;
        let numbers = self.numbers_after_line(kind, samples.count.saturating_mul(components)).map_err(named)?;
        let layout = Layout::dense(numbers.kind, size, components);
        let values: Values = numbers::values(&numbers, &layout, &Meaning::PLAIN).map_err(named)?;
        let way = self.geometry.resampling(samples.is_cells).map_err(named)?;
        if let Some(note) = &way.note {
            output.warn(format!("\"{name}\": {note}"));
            output.reserve(way.grid.size, components, 4).map_err(named)?;
        }
        let (grid, values) = (way.grid, way.values(values, components));
        let name = if name.is_empty() { self.input.stem() } else { name };
        output.add_steps(name, grid, components, vec![Step { time: self.time, values }])
    }

    fn kind(&mut self) -> Result<Kind, String> {
        let word = self.word("the type of the numbers")?;
        Kind::parse(word)
            .ok_or_else(|| format!("\"{word}\" is no type of numbers; float or unsigned_char is, for example"))
    }

    /// Numbers that begin in the next line.
    fn numbers(&mut self, kind: &Kind, count: usize) -> Result<Numbers<'a>, String> {
        self.words.line();
        self.numbers_after_line(kind, count)
    }

    fn numbers_after_line(&mut self, kind: &Kind, count: usize) -> Result<Numbers<'a>, String> {
        let number = match kind {
            Kind::Number(number) => *number,
            Kind::Bits => NumberKind::U8,
            Kind::Text => return Err("it is text; numbers belong here".into()),
        };
        if !self.is_binary {
            return self.words.numbers(number, count);
        }
        let left = self.words.rest().len();
        let needed = match kind {
            Kind::Bits => count.div_ceil(8),
            _ => count.saturating_mul(number.bytes()),
        };
        let bytes = self
            .words
            .take(needed)
            .ok_or_else(|| format!("{needed} bytes belong here, {left} are left; is the file complete?"))?;
        Ok(match kind {
            Kind::Bits => {
                let bit = |i: usize| bytes.get(i / 8).map_or(0, |byte| byte >> (7 - i % 8) & 1);
                Numbers::packed(number, true, (0..count).map(bit).collect::<Vec<u8>>())
            }
            _ => Numbers::packed(number, true, bytes),
        })
    }
}

/// The type of an array.
enum Kind {
    Number(NumberKind),
    Bits,
    Text,
}

impl Kind {
    fn parse(word: &str) -> Option<Self> {
        Some(Self::Number(match word.to_lowercase().as_str() {
            "bit" => return Some(Self::Bits),
            "string" | "utf8_string" => return Some(Self::Text),
            "unsigned_char" => NumberKind::U8,
            "char" | "signed_char" => NumberKind::I8,
            "unsigned_short" => NumberKind::U16,
            "short" => NumberKind::I16,
            "unsigned_int" => NumberKind::U32,
            // Ids are written as int, whatever they are in memory.
            "int" | "vtkidtype" => NumberKind::I32,
            "unsigned_long" | "vtktypeuint64" | "unsigned_long_long" => NumberKind::U64,
            "long" | "vtktypeint64" | "long_long" => NumberKind::I64,
            "float" => NumberKind::F32,
            "double" => NumberKind::F64,
            _ => return None,
        }))
    }
}

/// A name, whose spaces and the like are written as `%20`.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let hex = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()).filter(|_| *first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = after.get(2..).unwrap_or_default();
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests;
