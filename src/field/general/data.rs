//! The numbers behind a header of the general array importer, taken apart into arrays and steps.

use crate::field::{
    general::header::{Header, Interleaving, Skip, Variable},
    numbers::Numbers,
    words::{Words, number},
};

/// One array in one step.
pub struct Column<'a> {
    pub numbers: Numbers<'a>,
    /// How many samples there are.
    pub count: usize,
    /// The byte of the first number.
    pub start: usize,
    /// Bytes from a sample to the next, and from a component to the next.
    pub stride: usize,
    pub component_stride: usize,
}

/// Numbers under way.
pub struct Data<'a> {
    pub header: &'a Header,
    pub words: Words<'a>,
    /// Lines whose numbers were not where the header says.
    pub moved: usize,
}

impl<'a> Data<'a> {
    /// Passes over what the header says is before all numbers.
    pub fn skip_header(&mut self) -> Result<(), String> {
        let skip = self.header.skip.clone();
        self.skip(&skip)
    }

    fn skip(&mut self, skip: &Skip) -> Result<(), String> {
        let is_there = match skip {
            Skip::Nothing => true,
            Skip::Bytes(count) => self.words.take(*count).is_some(),
            Skip::Lines(count) => (0..*count).all(|_| self.words.line().is_some()),
            Skip::Marker(marker) => {
                let found = self.words.rest().windows(marker.len()).position(|window| window == marker);
                found.is_some_and(|at| self.words.take(at + marker.len()).is_some())
            }
        };
        is_there.then_some(()).ok_or_else(|| "what is to be passed over goes past the end of the file".to_owned())
    }

    /// The numbers of each array, of each step.
    pub fn columns(&mut self) -> Result<Vec<Vec<Column<'a>>>, String> {
        let variables = &self.header.variables;
        let mut all: Vec<Vec<Column<'a>>> = variables.iter().map(|_| Vec::new()).collect();
        let separator = self.header.series_separator.clone();
        if self.header.interleaving == Interleaving::SeriesVector {
            for (i, (variable, columns)) in variables.iter().zip(&mut all).enumerate() {
                self.separate(i)?;
                for step in 0..self.header.series {
                    if step > 0 {
                        self.skip(&separator)?;
                    }
                    columns.push(self.array(i, variable)?);
                }
            }
            return Ok(all);
        }
        for step in 0..self.header.series {
            if step > 0 {
                self.skip(&separator)?;
            }
            if self.header.interleaving == Interleaving::Field {
                all.iter_mut().zip(self.samples()?).for_each(|(columns, column)| columns.push(column));
                continue;
            }
            for (i, (variable, columns)) in variables.iter().zip(&mut all).enumerate() {
                self.separate(i)?;
                columns.push(self.array(i, variable)?);
            }
        }
        Ok(all)
    }

    /// What is between arrays, before that of a number.
    fn separate(&mut self, array: usize) -> Result<(), String> {
        let separators = &self.header.record_separators;
        let Some(before) = array.checked_sub(1) else { return Ok(()) };
        let skip = separators.get(before).or(if separators.len() == 1 { separators.first() } else { None });
        skip.cloned().map_or(Ok(()), |skip| self.skip(&skip))
    }

    /// An array on its own.
    fn array(&mut self, index: usize, variable: &Variable) -> Result<Column<'a>, String> {
        let count = self.header.count(variable.is_cells);
        let all = count.saturating_mul(variable.components);
        let size = variable.kind.bytes();
        let numbers = if !self.header.is_text {
            let left = self.words.rest().len();
            let needed = all.saturating_mul(size);
            let bytes = self.words.take(needed).ok_or_else(|| {
                format!("{needed} bytes of \"{}\" belong here, {left} are left; is the file complete?", variable.name)
            })?;
            Numbers::packed(variable.kind, self.header.is_big, bytes)
        } else if let Some([skip, elements, width]) = self.header.block.as_ref().and_then(|block| block.get(index)) {
            self.block(variable, [*skip, *elements, *width], all)?
        } else {
            self.words.numbers(variable.kind, all).map_err(|message| format!("\"{}\": {message}", variable.name))?
        };
        // Components are together, or each on its own.
        let (stride, component_stride) = match self.header.interleaving {
            Interleaving::Record => (size, size.saturating_mul(count)),
            _ => (size.saturating_mul(variable.components), size),
        };
        Ok(Column { numbers, count, start: 0, stride, component_stride })
    }

    /// Numbers at fixed places of lines: `skip` characters, then `elements` numbers of `width` characters.
    fn block(
        &mut self,
        variable: &Variable,
        [skip, elements, width]: [usize; 3],
        count: usize,
    ) -> Result<Numbers<'static>, String> {
        if elements == 0 || width == 0 {
            return Err("`block` says that lines have no numbers".into());
        }
        let mut numbers = Numbers::with_room(variable.kind, count.min(self.words.rest().len()));
        while numbers.len() < count {
            let line = self.line(&variable.name)?;
            let mut rest = line.get(skip..).unwrap_or_default();
            for _ in 0..elements.min(count - numbers.len()) {
                numbers.push(number_at(&mut rest, width, &variable.name)?);
            }
        }
        Ok(numbers)
    }

    fn line(&mut self, name: &str) -> Result<&'a [u8], String> {
        self.words.line().ok_or_else(|| format!("a line with numbers of \"{name}\" belongs here, the file ends"))
    }

    /// All arrays, of which each sample has its numbers together.
    fn samples(&mut self) -> Result<Vec<Column<'a>>, String> {
        let variables = &self.header.variables;
        let has_cells = variables.first().is_some_and(|variable| variable.is_cells);
        if variables.iter().any(|variable| variable.is_cells != has_cells) {
            return Err("arrays with values at points and in cells cannot follow each other sample by sample".into());
        }
        let count = self.header.count(has_cells);
        if !self.header.is_text {
            return self.packed_samples(count);
        }
        // Every sample has a number of two characters at least.
        let room = count.min(self.words.rest().len() / 2 + 1);
        let with_room = |variable: &Variable| {
            Numbers::with_room(variable.kind, room.saturating_mul(variable.components).min(self.words.rest().len()))
        };
        let mut all: Vec<Numbers<'static>> = variables.iter().map(with_room).collect();
        for _ in 0..count {
            match &self.header.layout {
                Some(layout) => {
                    let line = self.line(variables.first().map_or("", |v| &v.name))?;
                    // Numbers that outgrow their characters move those behind them.
                    let own = match in_columns(line, variables, layout, false) {
                        Err(_) => {
                            self.moved += 1;
                            in_columns(line, variables, layout, true)?
                        }
                        own => own?,
                    };
                    let mut own = own.into_iter();
                    for (variable, numbers) in variables.iter().zip(&mut all) {
                        own.by_ref().take(variable.components).for_each(|value| numbers.push(value));
                    }
                }
                None => {
                    for (variable, numbers) in variables.iter().zip(&mut all) {
                        let own = self.words.numbers(variable.kind, variable.components);
                        let own = own.map_err(|message| format!("\"{}\": {message}", variable.name))?;
                        own.all().into_iter().for_each(|value| numbers.push(value));
                    }
                }
            }
        }
        let column = |(variable, numbers): (&Variable, Numbers<'a>)| {
            let size = variable.kind.bytes();
            Column { numbers, count, start: 0, stride: size * variable.components, component_stride: size }
        };
        Ok(variables.iter().zip(all).map(column).collect())
    }

    fn packed_samples(&mut self, count: usize) -> Result<Vec<Column<'a>>, String> {
        let variables = &self.header.variables;
        let stride: usize = variables.iter().map(|variable| variable.components * variable.kind.bytes()).sum();
        let needed = count.saturating_mul(stride);
        let left = self.words.rest().len();
        let bytes = self.words.take(needed).ok_or_else(|| {
            format!("{count} samples of {stride} bytes belong here, {left} bytes are left; is the file complete?")
        })?;
        let mut start = 0;
        let mut all = Vec::new();
        for Variable { kind, components, .. } in variables {
            let numbers = Numbers::packed(*kind, self.header.is_big, bytes);
            all.push(Column { numbers, count, start, stride, component_stride: kind.bytes() });
            start += components * kind.bytes();
        }
        Ok(all)
    }
}

/// The numbers of a line, all arrays one after the other. `is_moved`: a number that goes on behind its characters is taken whole, and what
/// comes next begins behind it; else it is an error, unless there is no white space between numbers.
fn in_columns(line: &[u8], variables: &[Variable], layout: &[[usize; 2]], is_moved: bool) -> Result<Vec<f64>, String> {
    let first = layout.first().map_or(0, |[skip, _]| *skip);
    let behind = line.get(first..).unwrap_or_default();
    let words = behind.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count();
    let is_parted = words >= variables.iter().map(|variable| variable.components).sum();
    let is_digit = |b: Option<&u8>| b.is_some_and(|b| b.is_ascii_digit() || *b == b'.');
    let mut rest = line;
    let mut all = Vec::new();
    for (variable, [skip, width]) in variables.iter().zip(layout) {
        rest = rest.get(*skip..).unwrap_or_default();
        for _ in 0..variable.components {
            let spaces = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
            let word = rest.iter().skip(spaces).take_while(|b| !b.is_ascii_whitespace()).count();
            let is_cut = is_digit(width.checked_sub(1).and_then(|i| rest.get(i))) && is_digit(rest.get(*width));
            if !is_moved && is_cut && is_parted {
                return Err(format!("a number of \"{}\" is longer than {width} characters", variable.name));
            }
            let width = if is_moved && spaces < *width { (*width).max(spaces + word) } else { *width };
            all.push(number_at(&mut rest, width, &variable.name)?);
        }
    }
    Ok(all)
}

/// The number in the next characters of a line; NaN where they are blank.
fn number_at(rest: &mut &[u8], width: usize, name: &str) -> Result<f64, String> {
    let (own, after) = rest.split_at(width.min(rest.len()));
    *rest = after;
    if own.is_empty() {
        return Err(format!("the line before ends before the {width} characters of \"{name}\""));
    }
    let text = String::from_utf8_lossy(own);
    match text.trim() {
        "" => Ok(f64::NAN),
        text => number(text)
            .ok_or_else(|| format!("\"{text}\" stands in the line before where a number of \"{name}\" belongs")),
    }
}
