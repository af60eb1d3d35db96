//! Text in columns: how wide, how cut, how numbers are written for people.

use crate::{cli::terminal::Paint, text::steers};

/// Where a cell's text stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// At the left, as text.
    Left,
    /// At the right, as numbers.
    Right,
}

/// Cells in aligned columns; the last column takes what is left of the width and is cut there.
pub struct Table {
    headings: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these column headings; a heading row is written unless all are empty.
    pub fn new(headings: &[(&str, Align)]) -> Self {
        Self { headings: headings.iter().map(|(text, align)| ((*text).to_owned(), *align)).collect(), rows: Vec::new() }
    }

    /// Adds a row, one cell per column.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.into());
    }

    /// The lines, headings faint.
    pub fn lines(&self, paint: Paint, width: usize) -> Vec<String> {
        let widths: Vec<usize> = self
            .headings
            .iter()
            .enumerate()
            .map(|(i, (text, _))| self.rows.iter().map(|row| columns(&row[i])).max().unwrap_or(0).max(columns(text)))
            .collect();
        let mut lines = Vec::new();
        if self.headings.iter().any(|(text, _)| !text.is_empty()) {
            let cells: Vec<String> = self.headings.iter().map(|(text, _)| text.clone()).collect();
            lines.push(paint.faint(self.line(&cells, &widths, width).trim_end()));
        }
        lines.extend(self.rows.iter().map(|row| self.line(row, &widths, width)));
        lines
    }

    fn line(&self, cells: &[String], widths: &[usize], width: usize) -> String {
        let mut line = String::new();
        for (i, cell) in cells.iter().enumerate() {
            let pad = " ".repeat(widths[i] - columns(cell));
            match self.headings[i].1 {
                Align::Right => line.extend([pad.as_str(), cell]),
                Align::Left => line.extend([cell, pad.as_str()]),
            }
            line.push_str("  ");
        }
        cut(line.trim_end(), width)
    }
}

/// The number of columns of a terminal that `text` takes: East Asian wide characters take two, combining marks none.
pub fn columns(text: &str) -> usize {
    text.chars().map(char_columns).sum()
}

fn char_columns(c: char) -> usize {
    match u32::from(c) {
        0x0300..=0x036f | 0x200b..=0x200d | 0xfe00..=0xfe0f => 0,
        0x1100..=0x115f
        | 0x2e80..=0xa4cf
        | 0xac00..=0xd7a3
        | 0xf900..=0xfaff
        | 0xfe30..=0xfe6f
        | 0xff00..=0xff60
        | 0xffe0..=0xffe6
        | 0x1f300..=0x1faff
        | 0x20000..=0x3fffd => 2,
        _ => 1,
    }
}

/// `text`, or its beginning and `…` where it is wider than `width`.
pub fn cut(text: &str, width: usize) -> String {
    if text.len() <= width || columns(text) <= width {
        return text.to_owned();
    }
    let mut kept = String::new();
    let mut used = 1;
    for c in text.chars() {
        used += char_columns(c);
        if used > width {
            break;
        }
        kept.push(c);
    }
    kept + "…"
}

/// `text` in lines of at most `width` columns, broken at spaces.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let word = cut(word, width);
        match lines.last_mut().filter(|line| columns(line) + 1 + columns(&word) <= width) {
            Some(line) => line.extend([" ", word.as_str()]),
            None => lines.push(word),
        }
    }
    lines
}

/// Text from a file as it may be shown: control and direction characters become `·`.
pub fn clean(text: &str) -> String {
    text.chars().map(|c| if steers(c) { '·' } else { c }).collect()
}

/// A count with thousands apart: `1,234,567`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A share that is 0 % or 100 % only when it is exactly that.
pub fn percent(part: u64, all: u64) -> String {
    match (part, all) {
        (0, _) | (_, 0) => "0 %".to_owned(),
        (part, all) if part >= all => "100 %".to_owned(),
        (part, all) => match 100.0 * part as f64 / all as f64 {
            share if share < 1.0 => "<1 %".to_owned(),
            share if share > 99.0 => ">99 %".to_owned(),
            share => format!("{share:.0} %"),
        },
    }
}

/// A length in metres or kilometres, with the digits that matter.
pub fn length(metres: f64) -> String {
    match metres {
        m if m >= 10_000.0 => format!("{:.1} km", m / 1000.0),
        m if m >= 100.0 => format!("{} m", count(m.round() as u64)),
        m if m >= 1.0 => format!("{m:.1} m"),
        m => format!("{m:.3} m"),
    }
}

/// A file size, as file managers write it.
pub fn bytes(n: u64) -> String {
    match n as f64 {
        n if n >= 1e9 => format!("{:.1} GB", n / 1e9),
        n if n >= 1e6 => format!("{:.1} MB", n / 1e6),
        n if n >= 1e3 => format!("{:.1} kB", n / 1e3),
        n => format!("{n} bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(["0", "999", "1,000", "1,234,567"], [0, 999, 1000, 1_234_567].map(count).each_ref().map(|s| &s[..]));
        for (part, all, text) in
            [(0, 5, "0 %"), (1, 1000, "<1 %"), (999, 1000, ">99 %"), (5, 5, "100 %"), (1, 2, "50 %")]
        {
            assert_eq!(percent(part, all), text);
        }
        assert_eq!(length(12_345.0), "12.3 km");
        assert_eq!(length(1512.4), "1,512 m");
        assert_eq!(length(3.25), "3.2 m");
        assert_eq!(bytes(4_100_000), "4.1 MB");
    }

    #[test]
    fn wide_characters_take_two_columns() {
        assert_eq!(columns("明治"), 4);
        assert_eq!(cut("明治生命館", 6), "明治…");
        assert_eq!(cut("short", 5), "short");
        assert_eq!(cut("longer", 5), "long…");
    }

    #[test]
    fn lines_are_broken_at_spaces() {
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert_eq!(wrap("unbreakable", 4), ["unb…"]);
        assert!(wrap("  ", 4).is_empty());
    }

    #[test]
    fn control_characters_do_not_get_through() {
        assert_eq!(clean("a\x1b[2J\u{202e}b\nc"), "a·[2J·b·c");
    }

    #[test]
    fn columns_align() {
        let mut table = Table::new(&[("name", Align::Left), ("n", Align::Right)]);
        table.row(["a".into(), "10".into()]);
        table.row(["bcdef".into(), "7".into()]);
        assert_eq!(table.lines(Paint { on: false }, 80), ["name    n", "a      10", "bcdef   7"]);
    }
}
