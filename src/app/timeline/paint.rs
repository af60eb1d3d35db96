//! What is drawn of the timeline.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Stroke, Ui, pos2, vec2};

/// How wide a handle of what is played is, points: beside the line.
pub const HANDLE_PT: f32 = 9.0;

/// What is on a button: drawn, for fonts lack it.
#[derive(Clone, Copy)]
pub enum Sign {
    /// A step back.
    Back,
    /// Plays.
    Play,
    /// Stops.
    Pause,
    /// A step on.
    On,
    /// A camera key.
    Key,
}

impl Sign {
    /// A button with it; whether it was clicked.
    pub fn button(self, ui: &mut Ui, name: &str, key: &str) -> bool {
        let button = ui.add(egui::Button::new("").min_size(vec2(26.0, 22.0))).on_hover_text(format!("{name} ({key})"));
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
        let color = ui.style().interact(&button).fg_stroke.color;
        let middle = button.rect.center();
        let painter = ui.painter();
        // Half as wide as it is high, its middle so far aside; turned to the left by a minus.
        let triangle = |aside: f32, turn: f32| {
            let at = |x: f32, y: f32| middle + vec2(aside + turn * x, y);
            let points = vec![at(-3.0, -5.0), at(4.0, 0.0), at(-3.0, 5.0)];
            painter.add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
        };
        let bar = |aside: f32| {
            painter.rect_filled(Rect::from_center_size(middle + vec2(aside, 0.0), vec2(2.5, 10.0)), 0.0, color);
        };
        match self {
            Self::Play => triangle(0.0, 1.0),
            Self::Pause => [-3.0, 3.0].into_iter().for_each(bar),
            Self::Back => {
                triangle(1.0, -1.0);
                bar(-5.0);
            }
            Self::On => {
                triangle(-1.0, 1.0);
                bar(5.0);
            }
            Self::Key => {
                painter.add(diamond(middle - vec2(3.0, 0.0), 5.0, color));
                let plus = middle + vec2(6.5, 0.0);
                painter.hline(plus.x - 3.0..=plus.x + 3.0, plus.y, Stroke::new(1.5, color));
                painter.vline(plus.x, plus.y - 3.0..=plus.y + 3.0, Stroke::new(1.5, color));
            }
        }
        button.clicked()
    }
}

/// How much comes and goes in each column.
pub fn columns(ui: &Ui, rect: Rect, columns: &[u32]) {
    let most = columns.iter().copied().max().unwrap_or(1).max(1);
    let painter = ui.painter_at(rect);
    let visuals = ui.visuals();
    painter.rect_filled(rect, 4.0, visuals.extreme_bg_color);
    let (width, height) = (rect.width() / columns.len() as f32, rect.height() - 14.0);
    for (i, count) in columns.iter().enumerate().filter(|(_, count)| **count > 0) {
        // Few are seen beside many.
        let tall = (0.15 + 0.85 * (*count as f32 / most as f32).sqrt()) * height;
        let left = rect.left() + i as f32 * width;
        let bottom = rect.bottom() - 13.0;
        let bar = Rect::from_min_max(pos2(left + 0.5, bottom - tall), pos2(left + width - 0.5, bottom));
        painter.rect_filled(bar, 0.0, visuals.widgets.inactive.fg_stroke.color.gamma_multiply(0.55));
    }
}

/// What the line begins and ends with.
pub fn ends(ui: &Ui, rect: Rect, [first, last]: [String; 2]) {
    let (font, color) = (FontId::proportional(10.0), ui.visuals().weak_text_color());
    let painter = ui.painter_at(rect);
    painter.text(rect.left_bottom() + vec2(4.0, -1.0), Align2::LEFT_BOTTOM, first, font.clone(), color);
    painter.text(rect.right_bottom() + vec2(-4.0, -1.0), Align2::RIGHT_BOTTOM, last, font, color);
}

/// The present moment, at so many points from the left of the window.
pub fn cursor(ui: &Ui, rect: Rect, x: f32, text: &str) {
    let color = ui.visuals().selection.stroke.color;
    let painter = ui.painter_at(rect);
    painter.vline(x, rect.y_range(), Stroke::new(2.0, color));
    let is_right = x > rect.center().x;
    let (align, aside) = if is_right { (Align2::RIGHT_TOP, -5.0) } else { (Align2::LEFT_TOP, 5.0) };
    let place = pos2(x + aside, rect.top() + 1.0);
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), color);
    let box_ = align.anchor_size(place, galley.size()).expand(2.0);
    painter.rect_filled(box_, 3.0, ui.visuals().extreme_bg_color.gamma_multiply(0.9));
    painter.text(place, align, text, FontId::proportional(12.0), color);
}

/// The marks of camera keys.
pub fn keys(ui: &Ui, rect: Rect, places: impl Iterator<Item = f32>) {
    let (fill, edge) = (ui.visuals().warn_fg_color, ui.visuals().extreme_bg_color);
    let painter = ui.painter_at(rect);
    for x in places {
        let middle = pos2(x, rect.bottom() - 7.0);
        painter.add(diamond(middle, 5.5, edge));
        painter.add(diamond(middle, 4.0, fill));
    }
}

/// What is played round, between the handles at both ends of it; what is not is dim. `are_set`: whether it is less than all of the line.
pub fn range(ui: &Ui, rect: Rect, [from, until]: [f32; 2], are_set: bool) {
    let painter = ui.painter();
    let color = match are_set {
        true => ui.visuals().selection.stroke.color,
        false => ui.visuals().weak_text_color(),
    };
    let dim = ui.visuals().panel_fill.gamma_multiply(0.65);
    for [left, right] in [[rect.left(), from], [until, rect.right()]] {
        let beside = Rect::from_min_max(pos2(left, rect.top()), pos2(right, rect.bottom()));
        if beside.width() > 0.5 {
            painter.rect_filled(beside, 0.0, dim);
        }
    }
    for (x, aside) in [(from, -1.0), (until, 1.0)] {
        let at = |dx: f32, y: f32| pos2(x + aside * dx, y);
        painter.vline(x, rect.y_range(), Stroke::new(1.5, color));
        let [top, bottom] = [rect.top() + 1.0, rect.top() + 15.0];
        let points = vec![at(0.0, top), at(HANDLE_PT - 1.0, top), at(HANDLE_PT - 1.0, bottom - 5.0), at(0.0, bottom)];
        painter.add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
    }
}

fn diamond(middle: Pos2, half: f32, color: Color32) -> egui::Shape {
    let at = |x: f32, y: f32| middle + half * vec2(x, y);
    egui::Shape::convex_polygon(vec![at(0.0, -1.0), at(0.8, 0.0), at(0.0, 1.0), at(-0.8, 0.0)], color, Stroke::NONE)
}
