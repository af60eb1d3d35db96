//! The plot of a measurement: one drawing, written as SVG and rasterised to PNG, so that the two cannot differ.
//!
//! Time goes up, error (or a knob) to the right; the best is at the bottom left. A topic may have several figures up, one
//! panel each above a shared axis. Colours are Okabe and Ito's, which people
//! with any colour vision tell apart; filled and hollow, dashes and shapes say the same again for grey prints.

pub mod labels;
pub mod raster;
pub mod scale;
pub mod svg;

use crate::measure::{
    plot::{
        labels::Frame,
        scale::Scale,
        svg::{Anchor, Font, Marker, Stroke, Svg, text_width},
    },
    quantity::Quantity,
    report::{Origin, number},
    run::{Measurement, Row},
};

/// Width of the drawing, CSS pixels; the height follows from its panels.
const WIDTH: f64 = 760.0;
/// Height of the axes of a plot with one panel, and of each of several.
const ONE_PANEL: f64 = 296.0;
const PANEL: f64 = 210.0;
/// From one panel's axes to the next one's.
const GAP: f64 = 48.0;
/// Above the first panel's axes, and below the last one's.
const HEAD: f64 = 112.0;
const FOOT: f64 = 92.0;
/// Between the points of neighbouring series at one place of the axis.
const BESIDE: f64 = 7.0;
/// Pixels of the PNG per CSS pixel.
pub const PNG_SCALE: f32 = 2.0;

const INK: &str = "#1a1a1a";
const SOFT: &str = "#5f5f5f";
const GRID: &str = "#e3e3e3";
/// Okabe & Ito (2008), the dark ones first.
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"];
const DASHES: [&str; 6] = ["", "7 4", "2 3", "10 3 2 3", "", "4 4"];
const MARKERS: [Marker; 4] = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];

const TITLE: Font = Font { size: 18.0, is_strong: true, color: INK };
const AXIS: Font = Font { size: 13.0, is_strong: true, color: INK };
const LABEL: Font = Font { size: 13.0, is_strong: false, color: INK };
const TICK: Font = Font { size: 12.0, is_strong: false, color: SOFT };
const NOTE: Font = Font { size: 11.0, is_strong: false, color: SOFT };

/// A row that has a place in the plot.
struct Point<'a> {
    row: &'a Row,
    at: [f64; 2],
    /// Ends of its interval, lower end of the interval first; both the point itself where it has none.
    bar: [f64; 2],
}

/// One pair of axes.
struct Panel {
    figure: Quantity,
    /// The text above it.
    title: String,
    x: Scale,
    y: Scale,
    inside: Frame,
    /// Whether the shared axis has its ticks here.
    is_last: bool,
}

impl Panel {
    /// The point of a row, moved aside by `shift`.
    fn point<'a>(&self, measured: &Measurement, row: &'a Row, shift: f64) -> Option<Point<'a>> {
        let at = [self.x.at(measured.topic.x.of(row))? + shift, self.y.at(self.figure.of(row))?];
        let bar = self.figure.estimate(row).and_then(|e| Some([self.y.at(e.low)?, self.y.at(e.high)?]));
        Some(Point { row, at, bar: bar.unwrap_or([at[1]; 2]) })
    }
}

/// The content of each panel: its title, its figure up, its rows.
fn panels(measured: &Measurement) -> Vec<(String, Quantity, Vec<&Row>)> {
    let topic = measured.topic;
    let Some(knob) = topic.panels else {
        let all = || measured.rows.iter().collect();
        return topic.y.iter().map(|&figure| (figure.title(topic.knobs), figure, all())).collect();
    };
    let mut panels: Vec<(String, Quantity, Vec<&Row>)> = Vec::new();
    for row in &measured.rows {
        let title = format!("{}: {}", row.knobs[knob], topic.y[0].title(topic.knobs));
        match panels.iter_mut().find(|(known, ..)| *known == title) {
            Some((.., rows)) => rows.push(row),
            None => panels.push((title, topic.y[0], vec![row])),
        }
    }
    panels
}

/// The drawing, as SVG.
pub fn svg(measured: &Measurement, origin: &Origin) -> String {
    let topic = measured.topic;
    let panels = panels(measured);
    let panel_height = if panels.len() == 1 { ONE_PANEL } else { PANEL };
    let height = HEAD + panels.len() as f64 * (panel_height + GAP) - GAP + FOOT;
    let about = format!("{} The reference is {}.", topic.about, topic.reference);
    let mut out = Svg::new([WIDTH, height], topic.title, &about);
    head(&mut out, measured, origin);
    let lines = series(measured, &measured.rows.iter().collect::<Vec<_>>());
    let widest = lines.iter().map(|(name, _)| text_width(name, LABEL.size)).fold(0.0, f64::max);
    let right = if lines.is_empty() { WIDTH - 40.0 } else { (WIDTH - 28.0 - widest).max(0.5 * WIDTH) };
    let last = panels.len() - 1;
    for (i, (title, figure, rows)) in panels.into_iter().enumerate() {
        let top = HEAD + i as f64 * (panel_height + GAP);
        let inside: Frame = [64.0, top, right, top + panel_height];
        let panel = Panel {
            figure,
            title,
            x: x_scale(measured, [inside[0], inside[2]]),
            y: y_scale(&rows, figure, [inside[3], inside[1]]),
            inside,
            is_last: i == last,
        };
        draw(&mut out, measured, &panel, &series(measured, &rows));
    }
    foot(&mut out, measured, height - 18.0);
    out.finish()
}

fn draw(out: &mut Svg, measured: &Measurement, panel: &Panel, lines: &[(String, Vec<&Row>)]) {
    axes(out, measured, panel);
    // The line of the plain frame keeps labels off.
    let plain = if panel.figure == Quantity::Ratio { panel.y.at(1.0) } else { None };
    if let Some(y) = plain {
        out.line(&[[panel.inside[0], y], [panel.inside[2], y]], Stroke { color: SOFT, width: 1.0, dashes: "1 3" });
    }
    let taken = if lines.is_empty() {
        let points: Vec<Point<'_>> = measured.rows.iter().filter_map(|row| panel.point(measured, row, 0.0)).collect();
        single(out, measured, panel, &points, plain)
    } else {
        let mut points = Vec::with_capacity(lines.len());
        for (i, (name, rows)) in lines.iter().enumerate() {
            // Among places side by side only: along a scale it would be a lie.
            let beside = if matches!(measured.topic.x, Quantity::Knob(_)) { BESIDE } else { 0.0 };
            let shift = beside * (i as f64 - 0.5 * (lines.len() - 1) as f64);
            let of_line = rows.iter().filter_map(|row| panel.point(measured, row, shift)).collect();
            points.push((name.as_str(), of_line));
        }
        several(out, &points, panel.inside, measured.topic.notes)
    };
    if let Some(y) = plain {
        let name = "plain frame";
        let beside = [panel.inside[0] + 4.0, 0.0, panel.inside[2], 0.0];
        let x = labels::along_line(y - 5.0, name, NOTE.size, &taken, beside);
        out.text([x, y - 5.0], Anchor::Start, NOTE, name);
    }
}

/// Rows that one line joins, with the line's name; none where points stand alone.
fn series<'a>(measured: &Measurement, of: &[&'a Row]) -> Vec<(String, Vec<&'a Row>)> {
    let mut lines: Vec<(String, Vec<&Row>)> = Vec::new();
    if measured.topic.series.is_empty() {
        return lines;
    }
    for &row in of {
        let values = measured.topic.series.iter().filter_map(|&k| row.knobs.get(k));
        let name = values.map(ToString::to_string).collect::<Vec<_>>().join(", ");
        match lines.iter_mut().find(|(known, _)| *known == name) {
            Some((_, rows)) => rows.push(row),
            None => lines.push((name, vec![row])),
        }
    }
    for (_, rows) in &mut lines {
        rows.sort_by(|a, b| measured.topic.x.of(a).total_cmp(&measured.topic.x.of(b)));
    }
    lines
}

fn x_scale(measured: &Measurement, span: [f64; 2]) -> Scale {
    let values: Vec<f64> = measured.rows.iter().map(|row| measured.topic.x.of(row)).collect();
    match measured.topic.x {
        Quantity::Knob(_) => Scale::ordinal(&values, span),
        _ => Scale::of_errors(&values, span),
    }
}

fn y_scale(rows: &[&Row], figure: Quantity, span: [f64; 2]) -> Scale {
    let ends = rows.iter().flat_map(|row| match figure.estimate(row) {
        Some(estimate) => [estimate.low, estimate.high],
        None => [figure.of(row); 2],
    });
    let ends: Vec<f64> = ends.collect();
    if figure == Quantity::Ratio { Scale::of_ratios(&ends, span) } else { Scale::of_errors(&ends, span) }
}

fn head(out: &mut Svg, measured: &Measurement, origin: &Origin) {
    let [width, height] = measured.size;
    let left = 24.0;
    out.text([left, 34.0], Anchor::Start, TITLE, measured.topic.title);
    let facts = format!(
        "{}, {} triangles; {width} × {height} pixels; plain frame {} ms; {}",
        shortened(&origin.city.join(", "), 48),
        measured.triangles,
        number(measured.plain_ms.median),
        shortened(&measured.adapter.name, 40),
    );
    out.text([left, 54.0], Anchor::Start, NOTE, &facts);
}

fn foot(out: &mut Svg, measured: &Measurement, y: f64) {
    let left = 28.0;
    out.marker([left, y - 4.0], Marker::Circle, INK, true);
    out.text([left + 10.0, y], Anchor::Start, NOTE, "Pareto front");
    out.marker([left + 98.0, y - 4.0], Marker::Circle, INK, false);
    out.text([left + 108.0, y], Anchor::Start, NOTE, "not on it");
    let text = format!(
        "bars: 95 % intervals of {} rounds; reference: {}",
        measured.pairs,
        shortened(measured.topic.reference, 70)
    );
    out.text([left + 174.0, y], Anchor::Start, NOTE, &text);
}

fn axes(out: &mut Svg, measured: &Measurement, panel: &Panel) {
    let (x, y, [left, top, right, bottom]) = (&panel.x, &panel.y, panel.inside);
    let knobs = measured.topic.knobs;
    out.text([24.0, top - 18.0], Anchor::Start, AXIS, &panel.title);
    let thin = |color| Stroke { color, width: 1.0, dashes: "" };
    for (value, text) in &y.ticks {
        let Some(at) = y.at(*value) else { continue };
        out.line(&[[left, at], [right, at]], thin(GRID));
        out.text([left - 8.0, at + 4.0], Anchor::End, TICK, text);
    }
    for (value, text) in &x.ticks {
        let Some(at) = x.at(*value) else { continue };
        out.line(&[[at, bottom], [at, bottom + 5.0]], thin(INK));
        if panel.is_last {
            out.text([at, bottom + 19.0], Anchor::Middle, TICK, text);
        }
    }
    match x.break_at() {
        // The axis is cut between 0 and where the logarithm begins.
        Some(at) => {
            out.line(&[[left, bottom], [at - 3.0, bottom]], thin(INK));
            out.line(&[[at + 3.0, bottom], [right, bottom]], thin(INK));
            for off in [-3.0, 3.0] {
                out.line(&[[at + off - 3.0, bottom + 5.0], [at + off + 3.0, bottom - 5.0]], thin(INK));
            }
        }
        None => out.line(&[[left, bottom], [right, bottom]], thin(INK)),
    }
    if panel.is_last {
        out.text([right, bottom + 42.0], Anchor::End, AXIS, &measured.topic.x.title(knobs));
    }
}

fn bar(out: &mut Svg, point: &Point<'_>, color: &'static str) {
    let [x, _] = point.at;
    if point.bar[0] == point.bar[1] {
        return;
    }
    let stroke = Stroke { color, width: 1.4, dashes: "" };
    out.line(&[[x, point.bar[0]], [x, point.bar[1]]], stroke);
    for y in point.bar {
        out.line(&[[x - 3.0, y], [x + 3.0, y]], stroke);
    }
}

/// Points that stand alone, a line through the front, a label beside each; gives the boxes they take.
fn single(
    out: &mut Svg,
    measured: &Measurement,
    panel: &Panel,
    points: &[Point<'_>],
    plain: Option<f64>,
) -> Vec<Frame> {
    let inside = panel.inside;
    let mut front: Vec<[f64; 2]> = points.iter().filter(|p| p.row.is_pareto).map(|p| p.at).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]).then(b[1].total_cmp(&a[1])));
    let mut obstacles: Vec<Frame> = front.windows(2).flat_map(|w| labels::along(w[0], w[1])).collect();
    obstacles.extend(points.iter().flat_map(taken_by));
    // Only a front of the very two figures that are drawn is a line in the drawing.
    if measured.topic.front == [measured.topic.x, panel.figure] && front.len() > 1 {
        out.line(&front, Stroke { color: COLORS[1], width: 2.2, dashes: "" });
    }
    for point in points {
        bar(out, point, COLORS[0]);
        out.marker(point.at, Marker::Circle, COLORS[0], point.row.is_pareto);
    }
    let texts: Vec<String> = points.iter().map(|p| p.row.label.clone()).collect();
    let at: Vec<[f64; 2]> = points.iter().map(|p| p.at).collect();
    let page = [inside[0] + 2.0, inside[1] - 10.0, WIDTH - 6.0, inside[3] - 2.0];
    let mut off_plain = obstacles.clone();
    if let Some(y) = plain {
        off_plain.extend(labels::along([inside[0], y], [inside[2], y]));
    }
    for (place, text) in labels::places(&at, &texts, LABEL.size, &off_plain, page).iter().zip(&texts) {
        out.text(place.at, place.anchor, LABEL, text);
        obstacles.push(labels::frame(place, text, LABEL.size));
    }
    obstacles
}

/// Boxes of a point and its interval.
fn taken_by(point: &Point<'_>) -> [Frame; 2] {
    let [x, y] = point.at;
    [[x - 3.0, point.bar[1], x + 3.0, point.bar[0]], [x - 6.0, y - 6.0, x + 6.0, y + 6.0]]
}

/// One line per series, named at its right end; gives the boxes they take.
/// Knob `notes` stands beside the points.
fn several(out: &mut Svg, lines: &[(&str, Vec<Point<'_>>)], inside: Frame, notes: Option<usize>) -> Vec<Frame> {
    let mut taken = Vec::new();
    for (i, (_, points)) in lines.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let path: Vec<[f64; 2]> = points.iter().map(|p| p.at).collect();
        taken.extend(path.windows(2).flat_map(|w| labels::along(w[0], w[1])));
        taken.extend(points.iter().flat_map(taken_by));
        out.line(&path, Stroke { color, width: 2.0, dashes: DASHES[i % DASHES.len()] });
    }
    for (i, (_, points)) in lines.iter().enumerate() {
        for point in points {
            bar(out, point, COLORS[i % COLORS.len()]);
            out.marker(point.at, MARKERS[i % MARKERS.len()], COLORS[i % COLORS.len()], point.row.is_pareto);
        }
    }
    let all: Vec<(usize, &Point<'_>)> =
        lines.iter().enumerate().flat_map(|(i, (_, points))| points.iter().map(move |point| (i, point))).collect();
    let text =
        |(_, point): &(usize, &Point<'_>)| notes.and_then(|knob| point.row.knobs.get(knob)).map(ToString::to_string);
    let texts: Vec<String> = all.iter().filter_map(text).collect();
    let at: Vec<[f64; 2]> = all.iter().map(|(_, point)| point.at).filter(|_| notes.is_some()).collect();
    let page = [inside[0] + 2.0, inside[1] - 10.0, inside[2] + 6.0, inside[3] - 2.0];
    let places = labels::places(&at, &texts, NOTE.size, &taken, page);
    for ((place, text), (i, _)) in places.iter().zip(&texts).zip(&all) {
        out.text(place.at, place.anchor, Font { color: COLORS[i % COLORS.len()], ..NOTE }, text);
        taken.push(labels::frame(place, text, NOTE.size));
    }
    let ends: Vec<f64> = lines.iter().filter_map(|(_, points)| points.last()).map(|p| p.at[1]).collect();
    let named = lines.iter().enumerate().filter(|(_, line)| !line.1.is_empty());
    for ((i, (name, _)), y) in named.zip(labels::apart(&ends, 17.0)) {
        let font = Font { color: COLORS[i % COLORS.len()], is_strong: true, ..LABEL };
        out.text([inside[2] + 8.0, y + 4.5], Anchor::Start, font, name);
    }
    taken
}

/// At most so many characters, the end left out.
fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(1)).chain(['…']).collect()
}
