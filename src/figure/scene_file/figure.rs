//! `[figure]` in scene files, and the size of text.

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        forms::Same,
        keys::{DPI, Kind, TEXT_PT, Table, key},
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    scene::{Anchor, Column, Figure, Paper, TextSize},
    view::MAX_SIZE,
};

/// The words for places of pieces that may be nowhere, and of those that have a place.
const PLACES: [&str; 10] = {
    let mut words = ["none", "auto", "", "", "", "", "", "", "", ""];
    let mut i = 0;
    while i < Anchor::WORDS.len() {
        words[i + 2] = Anchor::WORDS[i].0;
        i += 1;
    }
    words
};
const WANTED: &[&str] = PLACES.split_at(1).1;
const COLUMNS: [&str; 2] = [Column::WORDS[0].0, Column::WORDS[1].0];

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
    Row::<Figure>::new(
        key(
            "size_mm",
            Kind::PaperSize,
            "none: it has a size in pixels",
            "millimetres",
            "Width and height on paper, in place of `size`: at `dpi` D, N millimetres are N·D/25.4 pixels, rounded, which are 1 to 16384.",
            "[120.0, 80.0]",
        ),
        |figure, _| match figure.paper {
            Some(Paper::Millimetres(size)) => Some(size.into()),
            _ => None,
        },
        |figure, given| figure.paper = given.node.numbers::<2>().map(Paper::Millimetres),
    ),
    Row::<Figure>::new(
        key(
            "column",
            Kind::Word { now: &COLUMNS, later: &[] },
            "none: it has a size of its own",
            "",
            "Width on paper, that of a column of a journal: 85 mm (`single`) or 175 mm (`double`); `size` says its proportions alone.",
            "\"single\"",
        ),
        |figure, _| match figure.paper {
            Some(Paper::Column(column)) => {
                Column::WORDS.iter().find(|(_, own)| *own == column).map(|(word, _)| (*word).into())
            }
            _ => None,
        },
        |figure, given| {
            let column = Column::WORDS.iter().find(|(word, _)| given.node.text() == Some(word));
            figure.paper = column.map(|(_, column)| Paper::Column(*column));
        },
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
            Kind::WordOrPlace(&PLACES),
            "\"none\"",
            "",
            "Where the legends of thematic colours stand: in a corner, at the middle of a side, or with their middle at `[x, y]`, shares of the \
             picture's width and height from the upper left. `auto` chooses; no piece of a figure stands on another.",
            "\"auto\"",
        ),
        Same,
        |figure: Figure| figure.legend
    ),
    field!(key("title", Kind::Text, "none", "", "A title.", "\"How old the town is\""), Same, |figure: Figure| figure
        .title),
    field!(
        key(
            "title_at",
            Kind::WordOrPlace(WANTED),
            "\"auto\"",
            "",
            "Where it stands, as for `legend`; `auto` is at the top left.",
            "\"top\""
        ),
        Same,
        |figure: Figure| figure.title_at
    ),
    field!(
        key(
            "caption",
            Kind::Text,
            "none",
            "",
            "A caption; `\\n` begins a new line.",
            "\"Years from the land register, 2023.\"",
        ),
        Same,
        |figure: Figure| figure.caption
    ),
    field!(
        key(
            "caption_at",
            Kind::WordOrPlace(WANTED),
            "\"auto\"",
            "",
            "Where it stands, as for `legend`; `auto` is at the bottom left.",
            "[0.5, 0.9]",
        ),
        Same,
        |figure: Figure| figure.caption_at
    ),
    field!(
        key(
            "scale_bar",
            Kind::WordOrPlace(&PLACES),
            "\"none\"",
            "",
            "A bar of a round length, about a fifth of the picture's width. Under an orthographic camera it is true along the picture's width \
             everywhere, and stands as `legend` does. In perspective, lengths are true at one distance: the bar then lies at its place in the \
             picture, on level ground as high as the camera's target (`auto`: at the target), and says that it is true here.",
            "\"auto\"",
        ),
        Same,
        |figure: Figure| figure.scale_bar
    ),
    field!(
        key(
            "time_labels",
            Kind::Boolean,
            "true",
            "",
            "Whether lenses that show a moment, and have a body, say which: above their middles, and where they overlap.",
            "false",
        ),
        Same,
        |figure: Figure| figure.time_labels
    ),
    field!(
        key(
            "north_arrow",
            Kind::WordOrPlace(&PLACES),
            "\"none\"",
            "",
            "An arrow that lies level at the camera's target and points to the north, foreshortened as the camera sees it. Where it \
             stands, as for `legend`.",
            "\"top-right\"",
        ),
        Same,
        |figure: Figure| figure.north_arrow
    ),
    Row::<Figure>::joint(
        key(
            "text_px",
            Kind::Number { min: 6.0, max: 400.0 },
            "7 points with `size_mm` or `column`; else by the size of the picture: 13 at 1280x720",
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
            "as for `text_px`",
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
            "300 with `size_mm` or `column`; else 96 for points, and the file says none",
            "dots per inch",
            "Resolution of the picture on paper: what millimetres and points are measured by, and what the PNG says (pHYs).",
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
    check_paper(&mut reader.checker, fields, &mut figure);
    figure.text = text_size(&mut reader.checker, fields, figure.dots());
    figure
}

/// Notes sizes that contradict each other, and those on paper that are no size of a picture; none of them stays.
fn check_paper(checker: &mut Checker, fields: &Fields, figure: &mut Figure) {
    let Some(paper) = figure.paper else { return };
    let key = if fields.given("size_mm") { "size_mm" } else { "column" };
    let other = ["size", "column"].into_iter().find(|other| key == "size_mm" && fields.given(other));
    let [w, h] = figure.pixels();
    let message = match (other, paper) {
        (Some(other), _) => format!("is given together with {other}: one of them would be right"),
        _ if [w, h].iter().all(|side| (1..=MAX_SIZE).contains(side)) => return,
        (None, Paper::Millimetres([wide, high])) => format!(
            "{wide} x {high} mm at {} dpi are {w} x {h} pixels; 1 to {MAX_SIZE} on a side would be right, by another dpi or size_mm",
            figure.dots()
        ),
        (None, Paper::Column(column)) => format!(
            "{} mm at {} dpi are {w} x {h} pixels; 1 to {MAX_SIZE} on a side would be right, by another dpi or size",
            column.width_mm(),
            figure.dots()
        ),
    };
    checker.note(&fields.place, key, fields.line(key), message);
    figure.paper = None;
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
