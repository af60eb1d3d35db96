//! What a reader has found so far, within the limits of a file.

use crate::field::{
    data::{Field, FieldFile, Step, Values},
    error::plain_line,
    grid::{Grid, checked_size},
};

/// The most bytes of values in a file.
pub const MOST_VALUE_BYTES: u64 = 1 << 31;
/// The most numbers of a sample.
const MOST_COMPONENTS: usize = 1024;
/// The most fields of a file, and the most warnings.
const MOST_FIELDS: usize = 4096;
const MOST_WARNINGS: usize = 100;

/// What a reader has found so far.
pub struct Output {
    fields: Vec<Field>,
    warnings: Vec<String>,
    /// Bytes of values that may still come.
    left: u64,
}

impl Default for Output {
    fn default() -> Self {
        Self { fields: Vec::new(), warnings: Vec::new(), left: MOST_VALUE_BYTES }
    }
}

impl Output {
    /// Asks for room for values before they are made; the error says which limit they break. `number_bytes`: 1 where bytes stay bytes, else 4.
    pub fn reserve(&mut self, size: [usize; 3], components: usize, number_bytes: usize) -> Result<(), String> {
        self.reserve_steps(size, components, number_bytes, 1)
    }

    /// [`Self::reserve`] for so many steps in time.
    pub fn reserve_steps(
        &mut self,
        size: [usize; 3],
        components: usize,
        number_bytes: usize,
        steps: usize,
    ) -> Result<(), String> {
        checked_size(size)?;
        if components == 0 || components > MOST_COMPONENTS {
            return Err(format!("samples have {components} components; 1 to {MOST_COMPONENTS} can be read"));
        }
        let count = size.iter().product::<usize>() as u64 * components as u64 * number_bytes as u64;
        let count = count.saturating_mul(steps as u64);
        self.left = self.left.checked_sub(count).ok_or_else(|| {
            let gib = MOST_VALUE_BYTES >> 30;
            format!("has more than {gib} GiB of values; thin it out, or keep fewer arrays or steps in a file")
        })?;
        Ok(())
    }

    /// Says what was done.
    pub fn warn(&mut self, message: impl AsRef<str>) {
        let message = plain_line(message.as_ref());
        if self.warnings.len() < MOST_WARNINGS && !self.warnings.contains(&message) {
            self.warnings.push(message);
        }
    }

    /// Adds a field that does not change.
    pub fn add(&mut self, name: String, grid: Grid, components: usize, values: Values) -> Result<(), String> {
        self.add_steps(name, grid, components, vec![Step { time: None, values }])
    }

    /// Adds a field; the error says that there are too many.
    pub fn add_steps(&mut self, name: String, grid: Grid, components: usize, steps: Vec<Step>) -> Result<(), String> {
        if self.fields.len() >= MOST_FIELDS {
            return Err(format!("has more than {MOST_FIELDS} arrays"));
        }
        let is_sound = steps.iter().all(|step| step.values.len() == grid.count() * components);
        if steps.is_empty() || !is_sound {
            return Err(format!("\"{name}\" has not as many values as its grid has samples"));
        }
        let is_integer = steps.iter().all(|step| step.values.is_whole());
        let name = self.free_name(&plain_line(name.trim()));
        self.fields.push(Field { name, grid, components, is_integer, unit: None, steps });
        Ok(())
    }

    /// Gives the last field a unit.
    pub fn set_unit(&mut self, unit: &str) {
        let unit = plain_line(unit.trim().trim_matches('"'));
        if let Some(field) = self.fields.last_mut().filter(|_| !unit.is_empty()) {
            field.unit = Some(unit);
        }
    }

    /// Whether there are no fields.
    pub fn is_empty(&self) -> bool {
        self.fields.is_empty()
    }

    /// The name, or with a number where it is taken.
    fn free_name(&self, name: &str) -> String {
        let is_free = |name: &str| !name.is_empty() && self.fields.iter().all(|field| field.name != name);
        let base = if name.is_empty() { "field" } else { name };
        let numbered = (2..).map(|n| format!("{base} {n}"));
        std::iter::once(base.to_owned()).chain(numbered).find(|name| is_free(name)).unwrap_or_default()
    }

    /// The file; the error says that nothing is in it.
    pub fn finish(self, format: &'static str) -> Result<FieldFile, String> {
        match self.is_empty() {
            true => Err("has no array of numbers on a grid".into()),
            false => Ok(FieldFile { format, fields: self.fields, warnings: self.warnings, beside: Vec::new() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn limits_hold_before_anything_is_made() {
        let mut output = Output::default();
        output.reserve([1024, 512, 512], 1, 4).unwrap();
        output.reserve([1024, 512, 512], 4, 1).unwrap();
        assert!(output.reserve([1, 1, 1], 1, 1).unwrap_err().contains("2 GiB of values"));
        let mut output = Output::default();
        assert!(output.reserve([1, 1, 1], 1025, 1).unwrap_err().contains("1 to 1024"));
        assert!(output.reserve([1, 0, 1], 1, 1).unwrap_err().contains("at least one"));
        assert!(output.finish("x").unwrap_err().contains("no array"));
    }

    #[test]
    fn names_are_told_apart() {
        let grid = Grid::new([1, 1, 1], DVec3::ZERO, [DVec3::ZERO; 3]).unwrap();
        let mut output = Output::default();
        for name in ["a", "a", "", "a "] {
            output.add(name.into(), grid, 1, Values::U8(vec![1])).unwrap();
        }
        assert!(output.add("b".into(), grid, 2, Values::U8(vec![1])).is_err());
        output.set_unit("\"K\"");
        output.warn("one\ntwo");
        output.warn("one\ntwo");
        let file = output.finish("x").unwrap();
        assert_eq!(file.fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["a", "a 2", "field", "a 3"]);
        assert_eq!((file.fields[3].unit.as_deref(), &file.warnings[..]), (Some("K"), &["one\\ntwo".to_owned()][..]));
    }
}
