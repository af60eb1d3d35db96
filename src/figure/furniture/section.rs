//! Legends as lines of a card, shortened until they fit.

use crate::{
    figure::{
        furniture::{
            card::{Content, INK, Line, Painter, QUIET_INK, Size},
            height_of,
        },
        legend::{Legend, Row},
        ticks::{number_text, ticks},
    },
    lens::color::Srgb,
    render::text::{TextStyle, Weight},
};

/// Width of a bar of colours where there is room, em.
const BAR_EM: f32 = 13.0;
/// Height of a histogram above it, em.
const HISTOGRAM_EM: f32 = 2.2;
/// What stands below a bar of directions, and where.
const COMPASS: [(f32, &str); 5] = [(0.0, "N"), (0.25, "E"), (0.5, "S"), (0.75, "W"), (1.0, "N")];
/// Lenses a legend names; the others are counted.
const MOST_LENSES: usize = 3;

/// The lines of all legends that fit into a card in `room`: categories beyond it are counted, and so are legends.
pub fn fitted(painter: &mut Painter, legends: &[Legend], room: Size) -> Vec<Line> {
    let inside = painter.inside(room);
    let mut shown = legends.len();
    while shown > 0 {
        let mut rows: Vec<Vec<Row>> = legends[..shown].iter().map(Legend::rows).collect();
        let mut hidden = vec![0_usize; shown];
        loop {
            let lines = lines(painter, &legends[..shown], &rows, &hidden, legends.len() - shown, inside.width);
            if height_of(&lines) <= inside.height {
                return lines;
            }
            // From the longest list, the last that may go. The line that counts takes one's place: two go at first.
            let removable = |i: &usize| rows[*i].iter().filter(|row| !row.is_kept).count();
            let Some(longest) = (0..shown).max_by_key(removable).filter(|i| removable(i) > 1) else { break };
            let times = if hidden[longest] == 0 { 2 } else { 1 };
            for _ in 0..times {
                if let Some(last) = rows[longest].iter().rposition(|row| !row.is_kept) {
                    rows[longest].remove(last);
                    hidden[longest] += 1;
                }
            }
        }
        shown -= 1;
    }
    Vec::new()
}

fn lines(
    painter: &mut Painter,
    legends: &[Legend],
    rows: &[Vec<Row>],
    hidden: &[usize],
    left_out: usize,
    width: f32,
) -> Vec<Line> {
    let mut lines = Vec::new();
    for (i, legend) in legends.iter().enumerate() {
        if i > 0 {
            lines.push(Line { height: painter.px(0.8), width: 0.0, content: Content::Gap });
        }
        head(painter, legend, width, &mut lines);
        bar(painter, legend, width, &mut lines);
        let (values, kept): (Vec<&Row>, Vec<&Row>) = rows[i].iter().partition(|row| !row.is_kept);
        values.into_iter().for_each(|row| lines.push(swatch(painter, row, width)));
        if hidden[i] > 0 {
            lines.push(note(painter, &format!("… and {} more", hidden[i]), width));
        }
        kept.into_iter().for_each(|row| lines.push(swatch(painter, row, width)));
    }
    if left_out > 0 {
        let plural = if left_out == 1 { "" } else { "s" };
        lines.push(note(painter, &format!("… and {left_out} more legend{plural}"), width));
    }
    lines
}

fn style(painter: &Painter, weight: Weight, tabular: bool) -> TextStyle {
    TextStyle { size_px: painter.em, weight, tabular }
}

/// Title, unit, and whose it is.
fn head(painter: &mut Painter, legend: &Legend, width: f32, lines: &mut Vec<Line>) {
    let (bold, plain) = (style(painter, Weight::SemiBold, false), style(painter, Weight::Regular, false));
    let unit = legend.unit.as_ref().map(|unit| painter.setter.elided(&format!("\u{a0}({unit})"), plain, width / 3.0));
    let unit = unit.unwrap_or_default();
    let unit_width = painter.setter.width(&unit, plain);
    let title = painter.setter.elided(&legend.title, bold, width - unit_width);
    let texts = vec![(title.clone(), bold, INK), (unit, plain, QUIET_INK)];
    let needed = painter.setter.width(&title, bold) + unit_width;
    lines.push(Line { height: painter.px(1.5), width: needed, content: Content::Texts(texts) });
    for (name, color) in legend.lenses.iter().take(MOST_LENSES) {
        lines.push(marked(painter, *color, true, name, QUIET_INK, width));
    }
    if legend.lenses.len() > MOST_LENSES {
        let more = legend.lenses.len() - MOST_LENSES;
        let plural = if more == 1 { "lens" } else { "lenses" };
        lines.push(note(painter, &format!("… and {more} more {plural}"), width));
    }
    lines.push(Line { height: painter.px(0.2), width: 0.0, content: Content::Gap });
}

/// The ramp with round numbers below it.
fn bar(painter: &mut Painter, legend: &Legend, width: f32, lines: &mut Vec<Line>) {
    let Some((min, max)) = legend.bar() else { return };
    let columns = painter.px(BAR_EM).min(width.floor()).max(1.0);
    let style = TextStyle { size_px: 0.92 * painter.em, ..style(painter, Weight::Regular, true) };
    let colors: Vec<Srgb> = (0..columns as usize)
        .map(|i| legend.scale.color_of_number(min + (max - min) * (i as f64 + 0.5) / f64::from(columns)))
        .collect();
    let ticks = match (legend.scale.is_direction(), [min, max]) {
        (true, [0.0, 360.0]) => COMPASS.map(|(share, name)| (share * columns, name.to_owned())).to_vec(),
        (_, ends) => fitting_ticks(painter, ends, columns, style),
    };
    let heights = legend.columns();
    if !heights.is_empty() {
        let height = painter.px(HISTOGRAM_EM) + painter.hairline();
        lines.push(Line { height, width: columns, content: Content::Columns { heights, width: columns } });
    }
    lines.push(Line { height: painter.hairline(), width: 0.0, content: Content::Gap });
    let height = painter.bar_height() + painter.px(1.45);
    lines.push(Line { height, width: columns, content: Content::Bar { colors, ticks, style } });
}

/// As many round numbers as stand beside each other; the ends where that is fewer than two.
fn fitting_ticks(painter: &mut Painter, [min, max]: [f64; 2], columns: f32, style: TextStyle) -> Vec<(f32, String)> {
    let least = painter.px(0.5);
    for wanted in (1..=6).rev() {
        let (values, step) = ticks(min, max, wanted);
        let marks: Vec<(f32, String)> = values
            .iter()
            .map(|v| (((v - min) / (max - min) * f64::from(columns)) as f32, number_text(*v, step)))
            .collect();
        if marks.len() >= 2 && fits(painter, &marks, columns, style, least) {
            return marks;
        }
    }
    let (_, step) = ticks(min, max, 100);
    let ends = vec![(0.0, number_text(min, step)), (columns, number_text(max, step))];
    if fits(painter, &ends, columns, style, least) { ends } else { Vec::new() }
}

/// Whether the texts, each in the middle of its column but inside the bar, keep their distance.
fn fits(painter: &mut Painter, marks: &[(f32, String)], columns: f32, style: TextStyle, least: f32) -> bool {
    let mut end = f32::NEG_INFINITY;
    marks.iter().all(|(at, text)| {
        let width = painter.setter.width(text, style);
        let left = (at - width / 2.0).clamp(0.0, (columns - width).max(0.0));
        let is_apart = left >= end + least && width <= columns;
        end = left + width;
        is_apart
    })
}

fn swatch(painter: &mut Painter, row: &Row, width: f32) -> Line {
    marked(painter, row.color, false, &row.label, INK, width)
}

/// A colour and a text.
fn marked(painter: &mut Painter, color: Srgb, is_ring: bool, text: &str, ink: Srgb, width: f32) -> Line {
    let style = style(painter, Weight::Regular, true);
    let indent = painter.swatch() + painter.px(0.5);
    let text = painter.setter.elided(text, style, width - indent);
    let needed = indent + painter.setter.width(&text, style);
    Line { height: painter.px(1.42), width: needed, content: Content::Swatch { color, is_ring, text, style, ink } }
}

fn note(painter: &mut Painter, text: &str, width: f32) -> Line {
    let style = style(painter, Weight::Regular, false);
    let text = painter.setter.elided(text, style, width);
    let needed = painter.setter.width(&text, style);
    Line { height: painter.px(1.42), width: needed, content: Content::Texts(vec![(text, style, QUIET_INK)]) }
}
