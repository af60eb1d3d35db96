//! The one table of sheet-file keys: it drives the checks, the messages, `docs/sheet.md` and the JSON schema.

use crate::figure::scene_file::keys::{DPI, Key, Kind, TEXT_PT, Table, key};

/// Cells in a row or in a column at most.
pub const MOST: i64 = 64;

const TITLE: Key = key("title", Kind::Text, "none", "", "A title, above everything.", "\"Effects over one lens\"");

const SETTINGS: &str = "The changes that make it, as `--set` has them, in order.";

/// The whole file.
pub const ROOT: Table = Table {
    name: "",
    doc: "The top of the file.",
    keys: &[
        key("veduta_sheet", Kind::Integer { min: 1, max: 1 }, "", "", "Version of the format.", "1"),
        key(
            "scene",
            Kind::Text,
            "",
            "",
            "The scene that is varied, relative to the sheet file.",
            "\"first-lens.toml\"",
        ),
        key(
            "set",
            Kind::Texts,
            "none",
            "",
            "Changes for all cells, as `--set` has them, in order.",
            "[\"style.base=clay\", \"lens.age.shape.radius=80\"]",
        ),
        key(
            "row",
            Kind::Tables(&ROW),
            "one row",
            "",
            "Rows, from top to bottom.",
            "[{ name = \"near\", set = [\"lens.0.shape.radius=40\"] }]",
        ),
        key(
            "column",
            Kind::Tables(&COLUMN),
            "one column",
            "",
            "Columns, from left to right.",
            "[{ name = \"sepia\", set = [\"lens.0.effects=['sepia']\"] }]",
        ),
        key(
            "wrap",
            Kind::Integer { min: 1, max: MOST },
            "all in a line",
            "",
            "Where there is no `row`: columns in a line, before the next begins.",
            "4",
        ),
        key(
            "cell",
            Kind::Tables(&CELL),
            "none",
            "",
            "What is said of one cell, or changed in it alone.",
            "[{ row = \"near\", column = \"sepia\", caption = \"As an old photograph.\" }]",
        ),
        key(
            "figures",
            Kind::Texts,
            "none",
            "",
            "Numbers below each cell, in this order: `visible-share`, `occluders`, `frame-ratio`; see Figures.",
            "[\"visible-share\", \"frame-ratio\"]",
        ),
        key(
            "poi",
            Kind::Text,
            "the first that is an object",
            "",
            "The point of interest whose share is told; its name.",
            "\"hall\"",
        ),
        key(
            "pairs",
            Kind::Integer { min: 1, max: 10_000 },
            "15",
            "",
            "How often the frame of a cell and the plain one are timed in turn, for `frame-ratio`.",
            "51",
        ),
        TITLE,
        key(
            "caption",
            Kind::Text,
            "none",
            "",
            "A caption, below everything; `\\n` begins a new line.",
            "\"Years from the land register, 2023.\"",
        ),
        key(
            "legend",
            Kind::Boolean,
            "true",
            "",
            "Shows the legends of thematic colours, each once for all cells.",
            "false",
        ),
        key(
            "cell_size",
            Kind::Size,
            "the largest that fits 3508x2480 pixels, A4 landscape at 300 dpi (`dpi`), in the scene's proportions",
            "pixels",
            "Width and height of each cell.",
            "[640, 360]",
        ),
        key(
            "samples",
            Kind::Integer { min: 1, max: 1024 },
            "the scene's",
            "per pixel",
            "Samples that are averaged.",
            "16",
        ),
        key(
            "gap_px",
            Kind::Number { min: 0.0, max: 1000.0 },
            "the size of the text",
            "pixels",
            "Between cells.",
            "12.0",
        ),
        key(
            "text_px",
            Kind::Number { min: 6.0, max: 400.0 },
            "36 on A4 (8.6 pt), down to 25 (6 pt) where there is little room; with `cell_size` a 97th of the width of all columns, at least 10",
            "pixels",
            "Size of the text.",
            "24.0",
        ),
        key(
            "text_pt",
            TEXT_PT,
            "as for `text_px`",
            "points",
            "The same in points, 1/72 inch, in place of `text_px`: N points at `dpi` D are N·D/72 pixels, which are 6 to 400.",
            "8.0",
        ),
        key(
            "dpi",
            DPI,
            "300; with `cell_size` 96 for points, and the file says none",
            "dots per inch",
            "Resolution of the sheet on paper: of A4 without `cell_size`, of `text_pt`, and what the PNG says (pHYs).",
            "600.0",
        ),
    ],
};

/// `[[row]]`.
pub const ROW: Table = Table {
    name: "row",
    doc: "A row: what its cells have in common.",
    keys: &[NAME, HEADING, key("set", Kind::Texts, "none", "", SETTINGS, "[\"lens.0.shape.radius=40\"]")],
};

/// `[[column]]`.
pub const COLUMN: Table = Table {
    name: "column",
    doc: "A column: what its cells have in common. What it changes comes after what the row changes.",
    keys: &[NAME, HEADING, key("set", Kind::Texts, "none", "", SETTINGS, "[\"lens.0.effects=['sepia']\"]")],
};

const NAME: Key = key(
    "name",
    Kind::Text,
    "its number, from 1",
    "",
    "Its name, unique: cells and files have it. Letters, digits, `-` and `_`.",
    "\"sepia\"",
);

const HEADING: Key = key(
    "heading",
    Kind::Text,
    "the name, if it has one",
    "",
    "What stands beside or above it.",
    "\"Sepia, half of it\"",
);

/// `[[cell]]`.
pub const CELL: Table = Table {
    name: "cell",
    doc: "One cell, by the names of its row and its column.",
    keys: &[
        key("row", Kind::Text, "the only one", "", "Name of its row.", "\"near\""),
        key("column", Kind::Text, "the only one", "", "Name of its column.", "\"sepia\""),
        key("caption", Kind::Text, "none", "", "What stands below it.", "\"As an old photograph.\""),
        key(
            "set",
            Kind::Texts,
            "none",
            "",
            "Changes of this cell alone, after those of its row and column.",
            "[\"lens.0.enabled=false\"]",
        ),
    ],
};

/// All tables of the file with the way to them, for the docs.
pub const TABLES: &[(&str, &Table)] =
    &[("top level", &ROOT), ("[[row]]", &ROW), ("[[column]]", &COLUMN), ("[[cell]]", &CELL)];
