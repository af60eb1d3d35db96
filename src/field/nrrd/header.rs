//! The header of an NRRD file: a line for each thing that is known of the data.

use crate::field::{
    error::FieldError,
    input::Input,
    numbers::NumberKind,
    words::{Words, all_numbers, all_whole},
};

/// The most axes.
const MOST_AXES: usize = 16;
/// The most files of data.
const MOST_FILES: usize = 65_536;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Raw,
    Text,
    Hex,
    Gzip,
}

/// Where the data are.
pub enum DataFiles {
    /// Behind the header.
    Attached,
    /// In these files, one after the other.
    Listed(Vec<String>),
    /// In files whose names have a number.
    Numbered(Pattern),
}

/// Names with a number, like `slice%03d.raw`.
pub struct Pattern {
    before: String,
    after: String,
    /// Digits, with zeros before them or spaces.
    width: usize,
    has_zeros: bool,
    first: i64,
    step: i64,
    count: usize,
}

/// What is known of an axis.
#[derive(Clone, Default)]
pub struct Axis {
    pub size: usize,
    pub spacing: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub is_cell: bool,
    pub kind: String,
    pub label: String,
    pub unit: String,
    /// From a sample to the next, in space; none for an axis that does not lie in it.
    pub direction: Option<Vec<f64>>,
    /// Whether the file says of this axis that it does not lie in space.
    pub is_outside: bool,
}

/// The header.
pub struct Header {
    pub kind: NumberKind,
    pub axes: Vec<Axis>,
    pub encoding: Encoding,
    pub is_big: bool,
    pub line_skip: usize,
    /// Bytes before the data; none: the data are the last bytes of the file.
    pub byte_skip: Option<usize>,
    pub files: DataFiles,
    pub origin: Option<Vec<f64>>,
    pub content: Option<String>,
    /// The unit of the values.
    pub unit: Option<String>,
    /// The units of space.
    pub space_units: String,
    /// Where the header ends, in bytes.
    pub end: usize,
}

/// The lines of a header that say something; a key may stand once.
struct Lines {
    found: Vec<Line>,
    end: usize,
    /// The names that follow `data file: LIST`.
    listed: Vec<String>,
}

struct Line {
    key: String,
    value: String,
    at: usize,
}

impl Lines {
    fn read(input: &Input<'_>) -> Result<Self, FieldError> {
        let mut words = Words::new(&input.bytes);
        words.line();
        let mut lines = Self { found: Vec::new(), end: 0, listed: Vec::new() };
        loop {
            let at = words.at();
            let Some(text) = words.text_line().filter(|text| !text.is_empty()) else { break };
            if text.starts_with('#') || text.split_once(":=").is_some_and(|(key, _)| !key.contains(": ")) {
                continue;
            }
            let Some((key, value)) = text.split_once(':') else {
                return Err(input.at(at, format!("\"{text}\" is no line of a header; `key: value` belongs here")));
            };
            // `axis mins` and `axismins` are one key.
            let key = key.to_lowercase().replace([' ', '-'], "");
            let value = value.trim().to_owned();
            if lines.found.iter().any(|line| line.key == key) {
                return Err(input.at(at, format!("`{key}` is said twice; keep one")));
            }
            let is_list = key == "datafile" && value.starts_with("LIST");
            lines.found.push(Line { key, value, at });
            if is_list {
                while let Some(name) = words.text_line() {
                    lines.listed.extend(Some(name).filter(|name| !name.is_empty()));
                }
            }
        }
        lines.end = words.at();
        Ok(lines)
    }

    fn get(&self, keys: &[&str]) -> Option<&Line> {
        self.found.iter().find(|line| keys.contains(&line.key.as_str()))
    }

    fn text(&self, keys: &[&str]) -> &str {
        self.get(keys).map_or("", |line| &line.value)
    }

    /// A key that must be there.
    fn needed(&self, input: &Input<'_>, key: &str, example: &str) -> Result<&Line, FieldError> {
        self.get(&[key]).ok_or_else(|| {
            input.at(self.end, format!("the header has no `{key}`; a line like `{example}` belongs there"))
        })
    }

    /// A value for each axis.
    fn for_axes<T>(
        &self,
        input: &Input<'_>,
        keys: &[&str],
        axes: &mut [Axis],
        parse: impl Fn(&str) -> Option<Vec<T>>,
        mut set: impl FnMut(&mut Axis, T),
    ) -> Result<(), FieldError> {
        let Some(line) = self.get(keys) else { return Ok(()) };
        let values = parse(&line.value).filter(|values| values.len() == axes.len()).ok_or_else(|| {
            input.at(line.at, format!("`{}` needs {} values, one for each axis", line.key, axes.len()))
        })?;
        axes.iter_mut().zip(values).for_each(|(axis, value)| set(axis, value));
        Ok(())
    }
}

impl Header {
    /// Reads the header of a file.
    pub fn read(input: &Input<'_>) -> Result<Self, FieldError> {
        if !matches!(input.bytes.get(..8), Some([.., b'1'..=b'5'])) {
            return Err(input.at(0, "the file is of a version of NRRD that is not known; NRRD0001 to NRRD0005 are"));
        }
        let lines = Lines::read(input)?;
        let kind = lines.needed(input, "type", "type: float")?;
        let kind = number_kind(&kind.value).map_err(|message| input.at(kind.at, message))?;
        let axes = axes(input, &lines)?;
        let encoding = lines.needed(input, "encoding", "encoding: raw")?;
        let encoding = match encoding.value.to_lowercase().as_str() {
            "raw" => Encoding::Raw,
            "txt" | "text" | "ascii" => Encoding::Text,
            "hex" => Encoding::Hex,
            "gz" | "gzip" => Encoding::Gzip,
            other => {
                let message = format!("`encoding: {other}` is not read; raw, ascii, hex and gzip are");
                return Err(input.at(encoding.at, message));
            }
        };
        let whole = |key: &str| match lines.get(&[key]) {
            None => Ok(0),
            Some(line) => line.value.parse::<i64>().ok().filter(|n| *n >= -1).ok_or_else(|| {
                input.at(line.at, format!("`{key}` is \"{}\"; a whole number belongs there", line.value))
            }),
        };
        let byte_skip = whole("byteskip")?;
        if byte_skip == -1 && encoding != Encoding::Raw {
            let at = lines.get(&["byteskip"]).map_or(0, |line| line.at);
            return Err(input.at(at, "`byte skip: -1` is for `encoding: raw` only"));
        }
        let origin = match lines.get(&["spaceorigin"]) {
            None => None,
            Some(line) => Some(vector(&line.value).ok_or_else(|| {
                input.at(line.at, format!("`space origin` is \"{}\"; (x,y,z) belongs there", line.value))
            })?),
        };
        let is_big = match lines.get(&["endian"]) {
            Some(line) if line.value == "big" => true,
            Some(line) if line.value == "little" => false,
            Some(line) => return Err(input.at(line.at, "`endian` must be `little` or `big`")),
            None if kind.bytes() == 1 || encoding == Encoding::Text => false,
            None => {
                let message = "the header has no `endian`; `endian: little` or `endian: big` belongs there";
                return Err(input.at(lines.end, message));
            }
        };
        let text = |keys: &[&str]| Some(lines.text(keys).to_owned()).filter(|text| !text.is_empty());
        Ok(Self {
            kind,
            axes,
            encoding,
            is_big,
            line_skip: whole("lineskip")?.max(0) as usize,
            byte_skip: usize::try_from(byte_skip).ok(),
            files: files(input, &lines)?,
            origin,
            content: text(&["content"]),
            unit: text(&["sampleunits"]),
            space_units: lines.text(&["spaceunits"]).to_owned(),
            end: lines.end,
        })
    }
}

fn axes(input: &Input<'_>, lines: &Lines) -> Result<Vec<Axis>, FieldError> {
    let dimension = lines.needed(input, "dimension", "dimension: 3")?;
    let count = dimension.value.parse().ok().filter(|n| (1..=MOST_AXES).contains(n));
    let Some(count) = count else {
        let message = format!("`dimension` is \"{}\"; 1 to {MOST_AXES} belongs there", dimension.value);
        return Err(input.at(dimension.at, message));
    };
    let mut axes = vec![Axis::default(); count];
    lines.needed(input, "sizes", "sizes: 64 64 32")?;
    lines.for_axes(input, &["sizes"], &mut axes, all_whole, |axis, size| axis.size = size)?;
    lines.for_axes(input, &["spacings"], &mut axes, all_numbers, |axis, spacing| {
        axis.spacing = Some(spacing).filter(|s| s.is_finite());
        axis.is_outside |= !spacing.is_finite();
    })?;
    lines.for_axes(input, &["axismins"], &mut axes, all_numbers, |axis, min| {
        axis.min = Some(min).filter(|m| m.is_finite());
    })?;
    lines.for_axes(input, &["axismaxs"], &mut axes, all_numbers, |axis, max| {
        axis.max = Some(max).filter(|m| m.is_finite());
    })?;
    let words = |text: &str| Some(text.split_whitespace().map(str::to_owned).collect());
    lines.for_axes(input, &["centers", "centerings"], &mut axes, words, |axis, center: String| {
        axis.is_cell = center == "cell";
    })?;
    lines.for_axes(input, &["kinds"], &mut axes, words, |axis, kind| axis.kind = kind.to_lowercase())?;
    lines.for_axes(input, &["labels"], &mut axes, quoted, |axis, label| axis.label = label)?;
    lines.for_axes(input, &["units"], &mut axes, quoted, |axis, unit| axis.unit = unit)?;
    lines.for_axes(input, &["spacedirections"], &mut axes, directions, |axis, direction| {
        axis.is_outside |= direction.is_none();
        axis.direction = direction;
    })?;
    Ok(axes)
}

fn files(input: &Input<'_>, lines: &Lines) -> Result<DataFiles, FieldError> {
    let Some(line) = lines.get(&["datafile"]) else { return Ok(DataFiles::Attached) };
    let fail = |message: String| Err(input.at(line.at, message));
    let names = if line.value.starts_with("LIST") {
        lines.listed.clone()
    } else if line.value.contains('%') {
        let what = "a name with one %d and `FIRST LAST STEP`";
        return Pattern::parse(&line.value)
            .map(DataFiles::Numbered)
            .ok_or_else(|| input.at(line.at, format!("`data file` is \"{}\"; {what} belongs there", line.value)));
    } else {
        vec![line.value.clone()]
    };
    match names.len() {
        0 => fail("`data file: LIST` is followed by no name".into()),
        n if n > MOST_FILES => fail(format!("the data are in {n} files; at most {MOST_FILES} are read")),
        _ => Ok(DataFiles::Listed(names)),
    }
}

impl Pattern {
    /// `NAME%03d.raw FIRST LAST STEP`, and a dimension that tells nothing here.
    fn parse(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let (before, rest) = words.next()?.split_once('%')?;
        let (width, after) = rest.split_once('d')?;
        let mut whole = || words.next()?.parse::<i64>().ok();
        let (first, last, step) = (whole()?, whole()?, whole()?);
        let span = last.checked_sub(first)?;
        let count = usize::try_from(span.checked_div(step)?).ok()?.checked_add(1)?;
        let has_zeros = width.starts_with('0');
        let width = if width.is_empty() { 0 } else { width.parse().ok().filter(|w| *w <= 32)? };
        (count <= MOST_FILES && !after.contains('%')).then(|| Self {
            before: before.to_owned(),
            after: after.to_owned(),
            width,
            has_zeros,
            first,
            step,
            count,
        })
    }

    /// All names.
    pub fn names(&self) -> Vec<String> {
        let Self { before, after, width, has_zeros, first, step, count } = self;
        let numbers = (0..*count as i64).map(|i| first.saturating_add(step.saturating_mul(i)));
        let name = |n| match has_zeros {
            true => format!("{before}{n:0width$}{after}"),
            false => format!("{before}{n:width$}{after}"),
        };
        numbers.map(name).collect()
    }
}

fn number_kind(name: &str) -> Result<NumberKind, String> {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split_whitespace().collect();
    let kind = match words.join(" ").as_str() {
        "signed char" | "int8" | "int8_t" | "char" => NumberKind::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => NumberKind::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => NumberKind::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => NumberKind::U16,
        "int" | "signed int" | "int32" | "int32_t" => NumberKind::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => NumberKind::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => NumberKind::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => NumberKind::U64,
        "float" => NumberKind::F32,
        "double" => NumberKind::F64,
        _ => {
            return Err(format!(
                "`type: {name}` is no type of numbers; uint8, int16, float or double are, for example"
            ));
        }
    };
    Ok(kind)
}

/// `"a" "b c"`; words without quotes, too.
fn quoted(text: &str) -> Option<Vec<String>> {
    if !text.contains('"') {
        return Some(text.split_whitespace().map(str::to_owned).collect());
    }
    Some(text.split('"').skip(1).step_by(2).map(str::to_owned).collect())
}

/// `(1,0,0) none (0,1,0)`.
fn directions(text: &str) -> Option<Vec<Option<Vec<f64>>>> {
    let mut all = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none").or_else(|| rest.strip_prefix("???")) {
            all.push(None);
            rest = after.trim_start();
        } else {
            let (own, after) = rest.split_at(rest.find(')')? + 1);
            let direction = vector(own)?;
            all.push(Some(direction).filter(|d| d.iter().all(|c| c.is_finite())));
            rest = after.trim_start();
        }
    }
    Some(all)
}

/// `(x,y,z)`, of 1 to 3 numbers.
fn vector(text: &str) -> Option<Vec<f64>> {
    let inside = text.trim().strip_prefix('(')?.strip_suffix(')')?;
    all_numbers(inside).filter(|numbers| (1..=3).contains(&numbers.len()))
}
