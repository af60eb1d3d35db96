//! VTK XML image data (`.vti`).
//!
//! Elements of XML, with numbers as text, as base64, or appended behind all elements.

mod data;
mod join;
mod xml;

use glam::DVec3;

use crate::field::{
    data::Step,
    error::FieldError,
    grid::{Grid, cells_of},
    input::Input,
    numbers::{self, Layout, Meaning, NumberKind},
    output::Output,
    vti::{
        data::{Appended, Encoding},
        join::Joined,
        xml::{Element, Tag, Tags},
    },
    words::{all_numbers, number},
};

/// The largest number of an extent.
const MOST_EXTENT: u64 = 1 << 40;

/// What of the elements is under way.
struct Reader<'a> {
    input: &'a Input<'a>,
    encoding: Encoding,
    appended: Option<Appended>,
    whole: Option<Whole>,
    /// The samples of the piece that is read.
    piece: Option<Extent>,
    /// Which data are read.
    section: Section,
    time: Option<f64>,
    joined: Vec<Joined>,
    has_pieces: bool,
}

/// Where the whole image lies.
#[derive(Clone, Copy)]
struct Whole {
    extent: Extent,
    origin: DVec3,
    steps: [DVec3; 3],
}

/// The first and the last sample along each axis.
pub type Extent = [[i64; 2]; 3];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    None,
    Points,
    Cells,
    /// Data of the file, which lie on no grid.
    File,
}

/// Reads a VTI file.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let mut reader = Reader {
        input,
        encoding: Encoding::default(),
        appended: Appended::find(&input.bytes),
        whole: None,
        piece: None,
        section: Section::None,
        time: None,
        joined: Vec::new(),
        has_pieces: false,
    };
    let end = reader.appended.as_ref().map_or(input.bytes.len(), |appended| appended.tag);
    let mut tags = Tags::new(input.bytes.get(..end).unwrap_or_default());
    while let Some(tag) = tags.next().map_err(|fault| input.at(fault.at, fault.message))? {
        match tag {
            Tag::Open(element) => reader.open(&element, &mut tags, output)?,
            Tag::Close(name) => reader.close(name),
        }
    }
    reader.finish(output)
}

impl Reader<'_> {
    fn open(&mut self, element: &Element<'_>, tags: &mut Tags<'_>, output: &mut Output) -> Result<(), FieldError> {
        let at = |message: String| self.input.at(element.at, message);
        match element.name {
            "VTKFile" => self.encoding = Encoding::of(element).map_err(at)?,
            "ImageData" => self.whole = Some(whole(element).map_err(at)?),
            "Piece" => {
                let whole = self.whole.ok_or_else(|| at("a Piece stands outside of ImageData".into()))?;
                let piece = extent(element, "Extent").map_err(at)?;
                let is_inside = piece.iter().zip(whole.extent).all(|(own, all)| own[0] >= all[0] && own[1] <= all[1]);
                if !is_inside {
                    return Err(at(format!("the Extent of the piece is not in the WholeExtent {:?}", whole.extent)));
                }
                (self.piece, self.has_pieces) = (Some(piece), true);
            }
            "PointData" => self.section = Section::Points,
            "CellData" => self.section = Section::Cells,
            "FieldData" => self.section = Section::File,
            "DataArray" if self.section == Section::File => self.read_time(element, tags)?,
            "DataArray" if self.section != Section::None => self.read_array(element, tags, output)?,
            _ => {}
        }
        if element.is_closed {
            self.close(element.name);
        }
        Ok(())
    }

    fn close(&mut self, name: &str) {
        match name {
            "PointData" | "CellData" | "FieldData" => self.section = Section::None,
            "Piece" => self.piece = None,
            _ => {}
        }
    }

    /// The time, which is the only thing of the file's own data that is looked at.
    fn read_time(&mut self, element: &Element<'_>, tags: &Tags<'_>) -> Result<(), FieldError> {
        if element.get("Name") != Some("TimeValue") {
            return Ok(());
        }
        let fail = |message: String| self.input.at(element.at, format!("the array \"TimeValue\": {message}"));
        let kind = data::number_kind(element).map_err(fail)?;
        let numbers = self.encoding.numbers(element, tags.content(), self.appended.as_ref(), self.input, kind, 1);
        self.time = numbers.map_err(fail)?.all().first().copied();
        Ok(())
    }

    fn read_array(&mut self, element: &Element<'_>, tags: &Tags<'_>, output: &mut Output) -> Result<(), FieldError> {
        let name = element.get("Name").unwrap_or("").to_owned();
        let fail = |message: String| self.input.at(element.at, format!("the array \"{name}\": {message}"));
        let (Some(whole), Some(piece)) = (self.whole, self.piece) else {
            return Err(fail("it stands outside of a Piece".into()));
        };
        if element.get("type") == Some("String") {
            output.warn(format!("the array \"{name}\" is text; it is left out"));
            return Ok(());
        }
        let is_cells = self.section == Section::Cells;
        let components = match element.get("NumberOfComponents") {
            None => 1,
            Some(text) => text.trim().parse::<usize>().map_err(|_| fail(format!("\"{text}\" are no components")))?,
        };
        let kind = data::number_kind(element).map_err(fail)?;
        let size = size_of(piece).map_err(fail)?;
        let size = if is_cells { cells_of(size) } else { size };
        output.reserve(size, components, if kind == NumberKind::U8 { 1 } else { 4 }).map_err(fail)?;
        let count = Layout::dense(kind, size, components).count();
        let content = tags.content();
        let numbers = self.encoding.numbers(element, content, self.appended.as_ref(), self.input, kind, count);
        let layout = Layout::dense(kind, size, components);
        let values = numbers::values(&numbers.map_err(fail)?, &layout, &Meaning::PLAIN).map_err(fail)?;
        let known = self.joined.iter_mut().find(|j| j.name == name && j.is_cells == is_cells);
        match known {
            Some(joined) if joined.components != components => {
                Err(fail(format!("it has {} components in another piece, and {components} here", joined.components)))
            }
            Some(joined) => {
                joined.pieces.push(join::Piece { extent: piece, values });
                Ok(())
            }
            None => {
                let pieces = vec![join::Piece { extent: piece, values }];
                self.joined.push(Joined { name, is_cells, components, whole: whole.extent, pieces });
                Ok(())
            }
        }
    }

    fn finish(self, output: &mut Output) -> Result<(), FieldError> {
        let fail = |message: String| self.input.fail(message);
        let Some(whole) = self.whole else { return Err(fail("has no element ImageData".into())) };
        if self.joined.is_empty() {
            return Err(fail(if self.has_pieces { "has no DataArray".into() } else { "has no Piece".into() }));
        }
        for joined in self.joined {
            let (name, components, is_cells) = (joined.name.clone(), joined.components, joined.is_cells);
            let (extent, values) = joined.into_values(output).map_err(fail)?;
            let first = DVec3::from_array(extent.map(|[first, _]| first as f64));
            let [a, b, c] = whole.steps;
            let origin = whole.origin + a * first.x + b * first.y + c * first.z;
            let grid = Grid::new(size_of(extent).map_err(fail)?, origin, whole.steps).map_err(fail)?;
            let grid = if is_cells { grid.cells() } else { grid };
            let name = if name.is_empty() { self.input.stem() } else { name };
            output.add_steps(name, grid, components, vec![Step { time: self.time, values }]).map_err(fail)?;
        }
        Ok(())
    }
}

fn whole(element: &Element<'_>) -> Result<Whole, String> {
    let list = |name: &str, count: usize, otherwise: &[f64]| match element.get(name) {
        None => Ok(otherwise.to_vec()),
        Some(text) => all_numbers(text)
            .filter(|all| all.len() == count)
            .ok_or_else(|| format!("{name} is \"{text}\"; {count} numbers belong there")),
    };
    let [ox, oy, oz] = list("Origin", 3, &[0.0; 3])?[..] else { return Err("Origin has not 3 numbers".into()) };
    let [sx, sy, sz] = list("Spacing", 3, &[1.0; 3])?[..] else { return Err("Spacing has not 3 numbers".into()) };
    let direction = list("Direction", 9, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    // Rows of a matrix whose columns are the axes.
    let column = |axis: usize| {
        let at = |row: usize| direction.get(row * 3 + axis).copied().unwrap_or(0.0);
        DVec3::new(at(0), at(1), at(2))
    };
    Ok(Whole {
        extent: extent(element, "WholeExtent")?,
        origin: DVec3::new(ox, oy, oz),
        steps: [column(0) * sx, column(1) * sy, column(2) * sz],
    })
}

fn extent(element: &Element<'_>, name: &str) -> Result<Extent, String> {
    let text = element.get(name).unwrap_or("");
    let numbers: Option<Vec<i64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    match numbers.as_deref() {
        Some([x0, x1, y0, y1, z0, z1]) if numbers.iter().flatten().all(|n| n.unsigned_abs() <= MOST_EXTENT) => {
            Ok([[*x0, *x1], [*y0, *y1], [*z0, *z1]])
        }
        _ => Err(format!(
            "{name} is \"{text}\"; the first and the last sample along each axis belong there: six whole numbers"
        )),
    }
}

/// Samples along each axis.
fn size_of(extent: Extent) -> Result<[usize; 3], String> {
    let size = extent.map(|[first, last]| usize::try_from(last - first + 1).unwrap_or(0));
    crate::field::grid::checked_size(size)?;
    Ok(size)
}

/// A whole number that an attribute gives.
fn whole_number(element: &Element<'_>, name: &str) -> Option<usize> {
    element.get(name).and_then(number).filter(|n| n.fract() == 0.0 && *n >= 0.0).map(|n| n as usize)
}

#[cfg(test)]
mod tests;
