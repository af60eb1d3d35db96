//! `[figure]` in scene files, and the size of text.

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        forms::{Same, Word},
        keys::{DPI, Kind, TEXT_PT, Table, key},
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    scene::{DEFAULT_DPI, Figure, TextSize},
};

//////FIG
/// `[figure]`.
pub const FIGURE: Table =
    Table { name: "figure", doc: "How a picture is made of the scene.", keys: keys_of!(FIGURE_ROWS) };

/// Its rows.
pub const FIGURE_ROWS: &[Row<Figure>] = &[
    field!(
        key("size", Kind::Size, "[1280, 720]", "pixels", "Width and height, each 1 to 16384.", "[1920, 1080]"),
        Same,
        |figure: Figure| figure.size
    ),
    field!(
        key(
            "samples",
            Kind::Integer { min: 1, max: 1024 },
            "16",
            "per pixel",
            "Samples that are averaged: 1 is a quick draft with jagged edges and hard shadows, 16 is smooth.",
            "64",
        ),
        Same,
        |figure: Figure| figure.samples
    ),
    field!(
        key(
            "legend",
            Kind::Word { now: &["none", "auto", "top-left", "top-right", "bottom-left", "bottom-right"], later: &[] },
            "\"none\"",
            "",
            "Where the legends of thematic colours stand; `auto` chooses the corner.",
            "\"auto\"",
        ),
        Word,
        |figure: Figure| figure.legend
    ),
    field!(
        key("title", Kind::Text, "none", "", "A title, drawn at the top left.", "\"How old the town is\""),
        Same,
        |figure: Figure| figure.title
    ),
    field!(
        key(
            "caption",
            Kind::Text,
            "none",
            "",
            "A caption, drawn at the bottom left; `\\n` begins a new line.",
            "\"Years from the land register, 2023.\"",
        ),
        Same,
        |figure: Figure| figure.caption
    ),
    Row::<Figure>::joint(
        key(
            "text_px",
            Kind::Number { min: 6.0, max: 400.0 },
            "by the size of the picture: 13 at 1280x720",
            "pixels",
            "Size of the text of legends and captions.",
            "16.0",
        ),
        |figure, _| match figure.text {
            Some(TextSize::Pixels(px)) => Some(px.into()),
            _ => None,
        },
    ),
    Row::<Figure>::joint(
        key(
            "text_pt",
            TEXT_PT,
            "by the size of the picture",
            "points",
            "The same in points, 1/72 inch, in place of `text_px`: N points at `dpi` D are N·D/72 pixels, which are 6 to 400.",
            "9.0",
        ),
        |figure, _| match figure.text {
            Some(TextSize::Points(points)) => Some(points.into()),
            _ => None,
        },
    ),
    field!(
        key(
            "dpi",
            DPI,
            "96 for points; the file says none",
            "dots per inch",
            "Resolution of the picture on paper: what `text_pt` is measured by, and what the PNG says (pHYs).",
            "300.0",
        ),
        Same,
        |figure: Figure| figure.dpi
    ),
];

/// Reads the table.
pub fn read(reader: &mut Reader, fields: &Fields) -> Figure {
    let mut figure = Figure::default();
    row::read(FIGURE_ROWS, fields, reader, &mut figure);
    figure.text = text_size(&mut reader.checker, fields, figure.dpi.unwrap_or(DEFAULT_DPI));
    figure
}

/// The size of text in a table that has `text_px` and `text_pt`, at so many dots per inch.
pub(in crate::figure) fn text_size(checker: &mut Checker, fields: &Fields, dpi: f64) -> Option<TextSize> {
    let points = match (fields.number("text_px"), fields.number("text_pt")) {
        (Some(px), None) => return Some(TextSize::Pixels(px)),
        (_, points) => points?,
    };
    let size = TextSize::Points(points);
    let [least, most] = [TextSize::RANGE_PX.start(), TextSize::RANGE_PX.end()];
    let message = if fields.given("text_px") {
        "is given together with text_px: one of them would be right".to_owned()
    } else if !TextSize::RANGE_PX.contains(&size.px(dpi)) {
        let px = (size.px(dpi) * 100.0).round() / 100.0;
        format!("{points} points at {dpi} dpi are {px} pixels; {least} to {most} pixels would be right")
    } else {
        return Some(size);
    };
    checker.note(&fields.place, "text_pt", fields.line("text_pt"), message);
    None
}
