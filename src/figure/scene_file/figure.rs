//! `[figure]`, and the size of text.

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        node::Node,
    },
    scene::{DEFAULT_DPI, Figure, LegendPlace, TextSize},
};

/// Reads the table.
pub fn read(checker: &mut Checker, fields: &Fields) -> Figure {
    let default = Figure::default();
    let dpi = fields.number("dpi");
    let size = fields.node("size").and_then(Node::numbers::<2>).map_or(default.size, |s| s.map(|side| side as u32));
    Figure {
        size,
        samples: fields.integer("samples").unwrap_or(default.samples),
        legend: fields.text("legend").and_then(LegendPlace::of_word).unwrap_or(default.legend),
        title: fields.text("title").map(str::to_owned),
        caption: fields.text("caption").map(str::to_owned),
        text: text_size(checker, fields, dpi.unwrap_or(DEFAULT_DPI)),
        dpi,
    }
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
