//! Sheets: one scene, varied in rows and columns, as one captioned picture and as one picture for each cell.
//!
//! ```text
//! sheet file ─ file ─> Sheet ─ cells ─> a Scene for each cell ─ drawn ─┐
//!                        └──── layout ─> where everything stands ─────┴─> page
//! ```

pub mod cells;
pub mod document;
pub mod file;
pub mod keys;
pub mod layout;

use crate::scene::TextSize;

pub use cells::{Cell, cells};
pub use layout::{Layout, Words};

/// A sheet, as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The scene file, as it is written.
    pub scene: String,
    /// Changes for all cells.
    pub settings: Vec<Setting>,
    /// Rows; empty: one without a name.
    pub rows: Vec<Variation>,
    /// Columns; empty: one without a name.
    pub columns: Vec<Variation>,
    /// Columns in a line, where there are no rows; `None`: all.
    pub wrap: Option<usize>,
    /// What is said of single cells.
    pub notes: Vec<CellNote>,
    /// Numbers below each cell.
    pub figures: Vec<CellFigure>,
    /// The point of interest that they are about.
    pub poi: Option<String>,
    /// How often frames are timed.
    pub pairs: usize,
    /// Above everything.
    pub title: Option<String>,
    /// Below everything.
    pub caption: Option<String>,
    /// Whether legends are shown.
    pub legend: bool,
    /// Pixels; `None`: as large as fits A4.
    pub cell_size: Option<[u32; 2]>,
    /// Samples per pixel; `None`: the scene's.
    pub samples: Option<u32>,
    /// Pixels between cells; `None`: an em.
    pub gap_px: Option<f64>,
    /// The em.
    pub text: Option<TextSize>,
    /// Dots per inch on paper; `None`: [`layout::A4_DPI`] where the sheet fits A4.
    pub dpi: Option<f64>,
}

/// A row or a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Its name, unique among its like.
    pub name: String,
    /// What stands beside or above it.
    pub heading: Option<String>,
    /// What it changes.
    pub settings: Vec<Setting>,
}

/// One `PATH=VALUE`, and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// As `--set` has it.
    pub assignment: String,
    /// `[row.1] set.0`.
    pub place: String,
    /// Line in the file, from 1.
    pub line: u32,
}

/// What is said of one cell.
#[derive(Clone, Debug, PartialEq)]
pub struct CellNote {
    /// Which row.
    pub row: usize,
    /// Which column.
    pub column: usize,
    /// What stands below it.
    pub caption: Option<String>,
    /// Changes of it alone.
    pub settings: Vec<Setting>,
}

/// A number that is told of each cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellFigure {
    /// How much of the point of interest is seen.
    VisibleShare,
    /// City objects that lenses meet.
    Occluders,
    /// Time of the frame against the plain one.
    FrameRatio,
}

impl CellFigure {
    /// All, with their words in sheet files.
    pub const WORDS: [(&str, Self); 3] =
        [("visible-share", Self::VisibleShare), ("occluders", Self::Occluders), ("frame-ratio", Self::FrameRatio)];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, figure)| *figure == self).map_or("", |(word, _)| word)
    }
}

impl Sheet {
    /// How many rows and columns of cells there are.
    pub fn grid(&self) -> [usize; 2] {
        [self.rows.len().max(1), self.columns.len().max(1)]
    }

    /// The dots per inch that the file says: none where it has a size in pixels and nothing else is said.
    pub fn dpi_of_file(&self) -> Option<f64> {
        self.dpi.or(self.cell_size.is_none().then_some(layout::A4_DPI))
    }

    /// Lines of cells, and cells in a line, as they stand on the page.
    pub fn lines(&self) -> [usize; 2] {
        let [rows, columns] = self.grid();
        match self.wrap.filter(|wrap| *wrap < columns) {
            Some(wrap) => [columns.div_ceil(wrap), wrap],
            None => [rows, columns],
        }
    }
}
