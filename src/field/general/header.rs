//! The header of the general array importer: a statement a line.

use glam::DVec3;

use crate::field::{
    error::FieldError,
    grid::{MOST_PER_AXIS, cells_of, checked_size},
    input::Input,
    numbers::NumberKind,
    words::{Words, all_numbers, number},
};

/// The most arrays.
const MOST_VARIABLES: usize = 1024;

/// How numbers follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interleaving {
    /// All arrays of a sample together.
    Field,
    /// Each component of each array on its own.
    Record,
    /// Each array on its own.
    RecordVector,
    /// Each array on its own with all its steps.
    SeriesVector,
}

/// What is passed over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Skip {
    Nothing,
    Bytes(usize),
    Lines(usize),
    /// Up to a text, and past it.
    Marker(Vec<u8>),
}

/// Where the samples are.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// At whole numbers.
    None,
    /// Coordinates along each axis.
    Axes([Vec<f64>; 3]),
    /// Every place, x fastest.
    Points(Vec<DVec3>),
}

/// One array.
#[derive(Clone, Debug)]
pub struct Variable {
    pub name: String,
    pub components: usize,
    pub kind: NumberKind,
    /// Whether its values are in the cells between samples.
    pub is_cells: bool,
}

/// The header.
pub struct Header {
    /// The file of the numbers; none: they follow the header.
    pub file: Option<String>,
    /// Samples along each axis, or how many there are.
    pub counts: Vec<usize>,
    /// Whether the samples are on no grid.
    pub is_scattered: bool,
    pub variables: Vec<Variable>,
    pub is_text: bool,
    pub is_big: bool,
    pub interleaving: Interleaving,
    pub skip: Skip,
    /// Characters before and of a number, for each array.
    pub layout: Option<Vec<[usize; 2]>>,
    /// Characters before numbers in a line, how many there are in it, and the characters of one, for each array.
    pub block: Option<Vec<[usize; 3]>>,
    /// Whether the first axis is the fastest.
    pub is_first_fastest: bool,
    /// What is between the numbers of arrays.
    pub record_separators: Vec<Skip>,
    /// Steps in time.
    pub series: usize,
    /// The first time, and the time between steps.
    pub times: Option<[f64; 2]>,
    /// What is between steps.
    pub series_separator: Skip,
    pub positions: Positions,
    /// Where the header ends, in bytes.
    pub end: usize,
}

/// One statement.
struct Statement {
    key: String,
    value: String,
    at: usize,
}

struct Statements<'a> {
    input: &'a Input<'a>,
    all: Vec<Statement>,
    end: usize,
}

impl<'a> Statements<'a> {
    fn read(input: &'a Input<'a>) -> Result<Self, FieldError> {
        let mut words = Words::new(&input.bytes);
        let mut all: Vec<Statement> = Vec::new();
        loop {
            let at = words.at();
            let Some(line) = words.text_line() else { break };
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            if line.eq_ignore_ascii_case("end") {
                break;
            }
            if let Some((key, value)) = line.split_once('=') {
                all.push(Statement { key: key.trim().to_lowercase(), value: value.trim().to_owned(), at });
            } else if let Some(last) = all.last_mut().filter(|last| last.key == "positions") {
                last.value = format!("{} {line}", last.value);
            } else {
                return Err(input.at(at, format!("\"{line}\" is no statement; `keyword = value` belongs here")));
            }
        }
        Ok(Self { input, all, end: words.at() })
    }

    fn get(&self, key: &str) -> Option<&Statement> {
        self.all.iter().rev().find(|statement| statement.key == key)
    }

    fn text(&self, key: &str) -> &str {
        self.get(key).map_or("", |statement| &statement.value)
    }

    /// The parts of a list, between commas.
    fn list(&self, key: &str) -> Vec<&str> {
        let text = self.text(key);
        if text.is_empty() { Vec::new() } else { text.split(',').map(str::trim).collect() }
    }

    /// An error at a statement.
    fn fault(&self, key: &str, what: &str) -> FieldError {
        match self.get(key) {
            Some(found) => self.input.at(found.at, format!("`{key}` is \"{}\"; {what} belongs there", found.value)),
            None => self.input.at(self.end, format!("the header has no `{key}`; {what} belongs there")),
        }
    }

    /// What a statement says, if it is there; `what` would be right.
    fn parsed<T>(&self, key: &str, what: &str, parse: impl Fn(&str) -> Option<T>) -> Result<Option<T>, FieldError> {
        let Some(statement) = self.get(key) else { return Ok(None) };
        parse(&statement.value).map(Some).ok_or_else(|| self.fault(key, what))
    }
}

impl Header {
    /// Reads the header of a file.
    pub fn read(input: &Input<'_>) -> Result<Self, FieldError> {
        let statements = Statements::read(input)?;
        let is_scattered = statements.get("points").is_some() && statements.get("grid").is_none();
        let key = if is_scattered { "points" } else { "grid" };
        let counts = statements.parsed(key, "samples along each axis, like `16 x 8 x 4`,", counts)?;
        let Some(counts) = counts else {
            return Err(statements.fault("grid", "samples along each axis, like `16 x 8 x 4`,"));
        };
        if !is_scattered {
            checked_size(size_of(&counts)).map_err(|message| input.fail(message))?;
        }
        let variables = variables(&statements)?;
        let arrays = variables.len();
        let numbers = |text: &str| text.split(',').map(|part| part.trim().parse().ok()).collect::<Option<Vec<usize>>>();
        let pairs = |text: &str| {
            numbers(text).and_then(|all| all.as_chunks::<2>().0.to_vec().into()).filter(|a| a.len() == arrays)
        };
        let threes = |text: &str| {
            numbers(text).and_then(|all| all.as_chunks::<3>().0.to_vec().into()).filter(|a| a.len() == arrays)
        };
        let layout = statements.parsed("layout", "`skip, width` for each array", pairs)?;
        let block = statements.parsed("block", "`skip, elements, width` for each array", threes)?;
        let is_first_fastest = match statements.text("majority").to_lowercase().as_str() {
            "column" => true,
            "" | "row" => false,
            _ => return Err(statements.fault("majority", "`row` or `column`")),
        };
        let interleaving = match statements.text("interleaving").to_lowercase().as_str() {
            "field" => Interleaving::Field,
            "record" => Interleaving::Record,
            "" | "record-vector" | "vector" => Interleaving::RecordVector,
            "series-vector" => Interleaving::SeriesVector,
            _ => return Err(statements.fault("interleaving", "`field`, `record`, `record-vector` or `series-vector`")),
        };
        let mut header = Self {
            file: statements.get("file").map(|file| file.value.trim_matches('"').to_owned()),
            counts,
            is_scattered,
            variables,
            is_text: true,
            is_big: false,
            interleaving,
            skip: statements
                .parsed("header", "`lines N`, `bytes N` or `marker \"TEXT\"`", skip)?
                .unwrap_or(Skip::Nothing),
            layout,
            block,
            is_first_fastest,
            record_separators: Vec::new(),
            series: 1,
            times: None,
            series_separator: Skip::Nothing,
            positions: Positions::None,
            end: statements.end,
        };
        header.read_format(&statements)?;
        header.read_series(&statements)?;
        let separators = |text: &str| text.split(',').map(|part| skip(part.trim())).collect();
        let what = "`lines N`, `bytes N` or `marker \"TEXT\"` between arrays";
        header.record_separators = statements.parsed("recordseparator", what, separators)?.unwrap_or_default();
        let what = "an origin and a delta for each axis, or `regular` and `irregular` and their numbers, or all places";
        if let Some(positions) = statements.parsed("positions", what, |text| header.positions_of(text))? {
            header.positions = positions;
        }
        Ok(header)
    }

    fn read_format(&mut self, statements: &Statements<'_>) -> Result<(), FieldError> {
        for word in statements.text("format").to_lowercase().split_whitespace() {
            match word {
                "ascii" | "text" => self.is_text = true,
                "binary" | "ieee" => self.is_text = false,
                "msb" | "lsb" => self.is_big = word == "msb",
                _ => return Err(statements.fault("format", "`ascii`, or `msb` or `lsb` and `binary`,")),
            }
        }
        Ok(())
    }

    /// `series = 53, 1, 0.5, separator = lines 2`; the second `=` is in the value.
    fn read_series(&mut self, statements: &Statements<'_>) -> Result<(), FieldError> {
        let fault = || statements.fault("series", "how many steps there are, and then a first time and a time between");
        if statements.get("series").is_none() {
            return Ok(());
        }
        let mut numbers = Vec::new();
        for part in statements.list("series") {
            match part.split_once('=') {
                Some((key, value)) if key.trim() == "separator" => {
                    self.series_separator = skip(value.trim()).ok_or_else(fault)?
                }
                Some(_) => return Err(fault()),
                None => numbers.push(number(part).ok_or_else(fault)?),
            }
        }
        match numbers[..] {
            [count] if count >= 1.0 => self.series = count as usize,
            [count, start, delta] if count >= 1.0 => {
                (self.series, self.times) = (count as usize, Some([start, delta]));
            }
            _ => return Err(fault()),
        }
        Ok(())
    }

    fn positions_of(&self, text: &str) -> Option<Positions> {
        let dimensions = self.counts.len();
        let is_word = |part: &str| part.eq_ignore_ascii_case("regular") || part.eq_ignore_ascii_case("irregular");
        let parts: Vec<&str> = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|p| !p.is_empty()).collect();
        let words: Vec<&str> = parts.iter().copied().take_while(|part| is_word(part)).collect();
        let numbers = all_numbers(&parts.get(words.len()..)?.join(" "))?;
        let is_pairs = words.is_empty() && numbers.len() == 2 * dimensions && !self.is_scattered;
        if words.len() == dimensions || is_pairs {
            let mut axes = [vec![0.0], vec![0.0], vec![0.0]];
            let mut rest = &numbers[..];
            for (i, count) in self.counts.iter().enumerate() {
                let is_regular = is_pairs || words.get(i)?.eq_ignore_ascii_case("regular");
                let (own, after) = rest.split_at_checked(if is_regular { 2 } else { *count })?;
                *axes.get_mut(i)? = match own {
                    [origin, delta] if is_regular => (0..*count).map(|n| origin + delta * n as f64).collect(),
                    _ => own.to_vec(),
                };
                rest = after;
            }
            return rest.is_empty().then_some(Positions::Axes(axes));
        }
        let count = self.count(false);
        let dimensions =
            numbers.len().checked_div(count).filter(|d| d * count == numbers.len() && (1..=3).contains(d))?;
        let at = |point: &[f64], axis: usize| point.get(axis).copied().unwrap_or(0.0);
        let points = numbers.chunks_exact(dimensions).map(|point| DVec3::new(at(point, 0), at(point, 1), at(point, 2)));
        Some(Positions::Points(points.collect()))
    }

    /// Samples along each axis.
    pub fn size(&self) -> [usize; 3] {
        size_of(&self.counts)
    }

    /// How many samples there are, at points or in cells.
    pub fn count(&self, is_cells: bool) -> usize {
        let size = if is_cells { cells_of(self.size()) } else { self.size() };
        size.iter().fold(1, |count, n| count.saturating_mul(*n))
    }
}

fn size_of(counts: &[usize]) -> [usize; 3] {
    let at = |axis: usize| counts.get(axis).copied().unwrap_or(1);
    [at(0), at(1), at(2)]
}

/// `144 x 73`.
fn counts(text: &str) -> Option<Vec<usize>> {
    let counts: Option<Vec<usize>> = text.split(['x', 'X', ',']).map(|part| part.trim().parse().ok()).collect();
    counts.filter(|counts| (1..=3).contains(&counts.len()) && counts.iter().all(|n| *n > 0))
}

/// `lines 8`, `bytes 100`, `marker "x"`.
fn skip(text: &str) -> Option<Skip> {
    let (word, value) = text.split_once(char::is_whitespace)?;
    let value = value.trim();
    match word.to_lowercase().as_str() {
        "lines" => value.parse().ok().map(Skip::Lines),
        "bytes" => value.parse().ok().map(Skip::Bytes),
        "marker" => {
            let marker = value.trim_matches('"').replace("\\n", "\n").replace("\\t", "\t");
            (!marker.is_empty()).then_some(Skip::Marker(marker.into_bytes()))
        }
        _ => None,
    }
}

fn variables(statements: &Statements<'_>) -> Result<Vec<Variable>, FieldError> {
    let [names, structures, types, dependencies] =
        ["field", "structure", "type", "dependency"].map(|key| statements.list(key));
    let count = names.len().max(structures.len()).max(types.len()).max(1);
    if count > MOST_VARIABLES {
        return Err(statements.fault("field", &format!("at most {MOST_VARIABLES} arrays")));
    }
    let mut all = Vec::new();
    for i in 0..count {
        // One says it for all.
        let of =
            |list: &[&str]| list.get(i).or(if list.len() == 1 { list.first() } else { None }).map(|s| s.to_lowercase());
        let components = match of(&structures).as_deref() {
            None | Some("scalar") => Some(1),
            Some(text) => text.strip_suffix("-vector").and_then(|n| n.parse().ok()),
        };
        let components = components.filter(|n| (1..=MOST_PER_AXIS).contains(n));
        let kind = match of(&types) {
            None => Some(NumberKind::F32),
            Some(name) => number_kind(&name),
        };
        all.push(Variable {
            name: names.get(i).map_or_else(|| format!("field{i}"), |name| (*name).to_owned()),
            components: components
                .ok_or_else(|| statements.fault("structure", "`scalar` or `3-vector` for each array"))?,
            kind: kind.ok_or_else(|| {
                statements.fault("type", "`float`, `double`, `int`, `short` or `byte` for each array")
            })?,
            is_cells: of(&dependencies).as_deref() == Some("connections"),
        });
    }
    Ok(all)
}

fn number_kind(name: &str) -> Option<NumberKind> {
    let words: Vec<&str> = name.split_whitespace().collect();
    Some(match words.join(" ").as_str() {
        // Bytes are unsigned unless they are said not to be, all else is signed.
        "byte" | "char" | "unsigned byte" | "unsigned char" | "ubyte" => NumberKind::U8,
        "signed byte" | "signed char" => NumberKind::I8,
        "short" | "signed short" => NumberKind::I16,
        "unsigned short" | "ushort" => NumberKind::U16,
        "int" | "signed int" => NumberKind::I32,
        "unsigned int" | "uint" => NumberKind::U32,
        "float" => NumberKind::F32,
        "double" => NumberKind::F64,
        _ => return None,
    })
}
