//! The transfer function of a volume, drawn over what values it has: its opacities are dragged, colours stand below.

use eframe::egui::{
    self, Color32, CornerRadius, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, emath::GuiRounding, pos2, vec2,
};
use toml::{Table as TomlTable, Value};

use crate::{
    app::properties::{
        edits::{Change, Edits, To},
        values::{number_value, trimmed},
    },
    lens::color::{Srgb, to_hex},
    render::fields::ShownVolume,
    scene::{Volume, volume::Transfer},
};

/// How high the curve and the colours are, points.
const CURVE_HEIGHT: f32 = 84.0;
const COLORS_HEIGHT: f32 = 12.0;
/// How near a point has to be that is taken hold of, points.
const NEAR: f32 = 9.0;
/// The size of a point, points.
const POINT: f32 = 3.5;

/// A point of the curve: a value and its opacity.
type Knot = [f64; 2];

/// The curve of a transfer function.
fn knots(transfer: &Transfer, ends: [f64; 2]) -> Vec<Knot> {
    let [low, high] = ends;
    let last = transfer.opacity.len().saturating_sub(1).max(1) as f64;
    let at = |i: usize| transfer.values.get(i).copied().unwrap_or(low + (high - low) * i as f64 / last);
    transfer.opacity.iter().enumerate().map(|(i, opacity)| [at(i), f64::from(*opacity)]).collect()
}

/// The transfer function with another curve. Its colours stay where they were.
fn with_knots(transfer: &Transfer, knots: &[Knot], ends: [f64; 2]) -> Transfer {
    let values: Vec<f64> = knots.iter().map(|[value, _]| *value).collect();
    let is_even = transfer.values.is_empty() && values.len() == transfer.opacity.len();
    let opacity = knots.iter().map(|[_, opacity]| *opacity as f32).collect();
    if is_even {
        return Transfer { opacity, ..transfer.clone() };
    }
    let has_colors = !transfer.colors.is_empty();
    let colors = values.iter().filter(|_| has_colors).map(|value| transfer.look(*value, ends).0).collect();
    Transfer { values, opacity, colors, range: Some(transfer.range.unwrap_or(ends)), ..transfer.clone() }
}

/// The tables of scene files have it so; what else its table has stays.
fn written(given: &TomlTable, transfer: &Transfer, is_even: bool) -> Value {
    let mut table = given.clone();
    let numbers = |all: Vec<f64>| Value::Array(all.into_iter().map(|n| number_value(n, false)).collect());
    let opacity = transfer.opacity.iter().map(|n| f64::from((n * 1e3).round()) / 1e3).collect();
    table.insert("opacity".to_owned(), numbers(opacity));
    if !is_even {
        table.insert("values".to_owned(), numbers(transfer.values.clone()));
        if let Some(range) = transfer.range {
            table.insert("range".to_owned(), numbers(range.to_vec()));
        }
    }
    if !transfer.colors.is_empty() {
        let colors = transfer.colors.iter().map(|color| Value::String(to_hex(*color))).collect();
        table.insert("colors".to_owned(), Value::Array(colors));
    }
    Value::Table(table)
}

/// Where the curve is drawn, and the values at its ends.
struct Chart {
    rect: Rect,
    ends: [f64; 2],
}

impl Chart {
    fn place(&self, [value, opacity]: Knot) -> Pos2 {
        let [low, high] = self.ends;
        let share = if high > low { (value - low) / (high - low) } else { 0.5 };
        pos2(
            self.rect.left() + self.rect.width() * share as f32,
            self.rect.bottom() - self.rect.height() * opacity as f32,
        )
    }

    fn knot(&self, at: Pos2) -> Knot {
        let [low, high] = self.ends;
        let share = f64::from((at.x - self.rect.left()) / self.rect.width()).clamp(0.0, 1.0);
        let opacity = f64::from((self.rect.bottom() - at.y) / self.rect.height()).clamp(0.0, 1.0);
        [low + (high - low) * share, opacity]
    }
}

fn of_srgb(color: Srgb) -> Color32 {
    let [r, g, b] = color.map(|c| (255.0 * c).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// The curve over the histogram, to be dragged. A double click makes a point, a click with the other button takes one away.
pub fn editor(ui: &mut Ui, edits: &mut Edits, volume: &Volume, shown: &ShownVolume, given: &TomlTable, path: &str) {
    let transfer = &volume.transfer;
    let ends = shown.ends;
    let width = ui.available_width().min(320.0);
    let (rect, response) =
        ui.allocate_exact_size(vec2(width, CURVE_HEIGHT + COLORS_HEIGHT + 2.0), Sense::click_and_drag());
    let name = format!("Transfer function of {}", volume.name);
    response.widget_info(|| WidgetInfo::labeled(Role::GraphicsObject, ui.is_enabled(), &name));
    let rect = rect.round_ui();
    let curve = Rect::from_min_size(rect.min, vec2(rect.width(), CURVE_HEIGHT));
    let chart = Chart { rect: curve.shrink2(vec2(POINT, POINT)), ends };
    let mut all = knots(transfer, ends);
    let near = |at: Pos2, all: &[Knot]| {
        let distance = |i: &usize| chart.place(all[*i]).distance(at);
        (0..all.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|i| distance(i) <= NEAR)
    };
    let pointer = response.interact_pointer_pos();
    let held = ui.scope_id().with((path, "held"));
    if response.drag_started() {
        let from = ui.input(|input| input.pointer.press_origin()).or(pointer);
        let taken = from.and_then(|at| near(at, &all));
        ui.data_mut(|data| data.insert_temp(held, taken));
    }
    let mut changed = None;
    if let (true, Some(Some(i)), Some(at)) =
        (response.dragged(), ui.data(|data| data.get_temp::<Option<usize>>(held)), pointer)
        && i < all.len()
    {
        let [value, opacity] = chart.knot(at);
        all[i][1] = opacity;
        // Between its neighbours; where they stand at equal steps, it stays.
        if !transfer.values.is_empty() && i > 0 && i + 1 < all.len() {
            let least = 1e-3 * (ends[1] - ends[0]);
            let [low, high] = [all[i - 1][0] + least, all[i + 1][0] - least];
            all[i][0] = if low < high { value.clamp(low, high) } else { all[i][0] };
        }
        changed = Some(true);
    }
    if let (true, Some(at)) = (response.double_clicked(), pointer)
        && near(at, &all).is_none()
    {
        let knot = chart.knot(at);
        all.insert(all.partition_point(|[value, _]| *value < knot[0]), knot);
        changed = Some(false);
    }
    if let (true, Some(at)) = (response.secondary_clicked(), pointer)
        && let Some(i) = near(at, &all).filter(|_| all.len() > 2)
    {
        all.remove(i);
        changed = Some(false);
    }
    if let Some(is_held) = changed {
        let next = with_knots(transfer, &all, ends);
        let to = To::Value(written(given, &next, next.values.is_empty()));
        edits.changes.push(Change { path: format!("{path}.transfer"), to, is_held });
    }
    if response.drag_stopped() {
        let to = To::Value(written(given, transfer, transfer.values.is_empty()));
        edits.push(format!("{path}.transfer"), to);
    }
    paint(ui, &chart, rect, volume, shown, &all);
    let [low, high] = ends;
    let unit = shown.unit.as_deref().map_or_else(String::new, |unit| format!(" {unit}"));
    let hovered = response.hover_pos().map(|at| {
        let [value, _] = chart.knot(at);
        let (_, opacity) = transfer.look(value, ends);
        format!("{}{unit}: opacity {}", trimmed(value, 3), trimmed(opacity.into(), 3))
    });
    ui.weak(hovered.unwrap_or_else(|| format!("{} to {}{unit}", trimmed(low, 3), trimmed(high, 3))));
}

fn paint(ui: &Ui, chart: &Chart, rect: Rect, volume: &Volume, shown: &ShownVolume, all: &[Knot]) {
    let painter = ui.painter_at(rect);
    let visuals = ui.visuals();
    painter.rect_filled(rect, CornerRadius::same(2), visuals.extreme_bg_color);
    // By logarithms: most of a volume is often empty.
    let most = shown.histogram.iter().copied().max().unwrap_or(0).max(1) as f32;
    let column = chart.rect.width() / shown.histogram.len().max(1) as f32;
    for (i, count) in shown.histogram.iter().enumerate().filter(|(_, count)| **count > 0) {
        let share = (1.0 + *count as f32).ln() / (1.0 + most).ln();
        let left = chart.rect.left() + column * i as f32;
        let bar = Rect::from_min_max(
            pos2(left, chart.rect.bottom() - share * chart.rect.height()),
            pos2(left + column, chart.rect.bottom()),
        );
        painter.rect_filled(bar, CornerRadius::ZERO, visuals.weak_text_color().gamma_multiply(0.35));
    }
    let bar = Rect::from_min_max(
        pos2(chart.rect.left(), rect.bottom() - COLORS_HEIGHT),
        pos2(chart.rect.right(), rect.bottom()),
    );
    let columns = bar.width().ceil().max(1.0) as usize;
    for i in 0..columns {
        let share = (i as f64 + 0.5) / columns as f64;
        let (color, _) = volume.transfer.look(chart.ends[0] + (chart.ends[1] - chart.ends[0]) * share, chart.ends);
        let left = bar.left() + i as f32;
        painter.rect_filled(
            Rect::from_min_max(pos2(left, bar.top()), pos2(left + 1.0, bar.bottom())),
            CornerRadius::ZERO,
            of_srgb(color),
        );
    }
    let line = Stroke::new(1.5, visuals.strong_text_color());
    let places: Vec<Pos2> = all.iter().map(|knot| chart.place(*knot)).collect();
    let ends = places.first().zip(places.last());
    let beyond = ends.map(|(first, last)| [pos2(chart.rect.left(), first.y), pos2(chart.rect.right(), last.y)]);
    let drawn: Vec<Pos2> = beyond
        .iter()
        .map(|[left, _]| *left)
        .chain(places.iter().copied())
        .chain(beyond.iter().map(|[_, right]| *right))
        .collect();
    painter.add(egui::Shape::line(drawn, line));
    for (place, [value, _]) in places.iter().zip(all) {
        let (color, _) = volume.transfer.look(*value, chart.ends);
        painter.circle(*place, POINT, of_srgb(color), line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_more_gives_all_their_values_and_keeps_colours() {
        let even = Transfer { colors: vec![[0.0; 3], [1.0; 3]], opacity: vec![0.0, 0.5], ..Transfer::default() };
        let ends = [10.0, 20.0];
        assert_eq!(knots(&even, ends), [[10.0, 0.0], [20.0, 0.5]]);
        let lower = with_knots(&even, &[[10.0, 0.25], [20.0, 0.5]], ends);
        assert_eq!((lower.values.len(), lower.opacity.clone()), (0, vec![0.25, 0.5]));
        let more = with_knots(&even, &[[10.0, 0.0], [12.0, 0.75], [20.0, 0.5]], ends);
        assert_eq!((more.values.clone(), more.range), (vec![10.0, 12.0, 20.0], Some(ends)));
        for value in [10.0, 12.0, 20.0] {
            let [before, after] = [even.look(value, ends).0, more.look(value, ends).0];
            assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-6), "{value}");
        }
        assert_eq!(more.look(11.0, ends).1, 0.375);
        let table = written(&TomlTable::from_iter([("ramp".to_owned(), Value::String("vik".into()))]), &more, false);
        assert_eq!(table["ramp"].as_str(), Some("vik"));
        assert_eq!(table["values"].as_array().map(Vec::len), Some(3));
    }
}
