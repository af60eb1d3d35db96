//! Lines and areas that are drawn on the city, point by point: for lenses, and to measure.

use eframe::egui::{Align2, Color32, Key, Rect, Stroke, Ui, pos2};
use glam::DVec3;

use crate::{
    app::{
        drawn::{Drawing, Figure},
        new_lens::{free_name, quoted},
        state::Window,
        theme::caption,
    },
    view::View,
};

impl Window {
    /// Begins to draw.
    pub(super) fn begin_drawing(&mut self, figure: Figure) {
        self.drawing = Some(Drawing { figure, points: Vec::new() });
        self.say(figure.hint());
    }

    /// Takes keys of what is being drawn.
    pub(super) fn go_on_drawing(&mut self, ui: &Ui) {
        let Some(drawing) = &mut self.drawing else { return };
        if ui.ctx().text_edit_focused() {
            return;
        }
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        if pressed(Key::Backspace) {
            drawing.points.pop();
        }
        if pressed(Key::Escape) {
            self.drawing = None;
            self.message = None;
        } else if pressed(Key::Enter) {
            self.finish_drawing();
        }
    }

    fn finish_drawing(&mut self) {
        let Some(Drawing { figure, points }) = self.drawing.take() else { return };
        if figure == Figure::Measure {
            return;
        }
        if points.len() < figure.least() {
            return self.fail(format!("{} points are needed at least.", figure.least()));
        }
        let scene = self.document.scene();
        let name = free_name(scene, if figure == Figure::Route { "route" } else { "area" });
        let index = scene.lenses.len();
        let shape = match figure {
            Figure::Route => {
                let width = (0.1 * length_of(&points)).clamp(8.0, 60.0);
                let all: Vec<String> = points.iter().map(|p| format!("[{:.2}, {:.2}, {:.2}]", p.x, p.y, p.z)).collect();
                format!("kind = \"corridor\", points = [{}], width = {width:.1}, height = 80.0", all.join(", "))
            }
            _ => {
                let low = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
                let all: Vec<String> = points.iter().map(|p| format!("[{:.2}, {:.2}]", p.x, p.y)).collect();
                format!("kind = \"mask\", points = [{}], base = {:.2}, height = 120.0", all.join(", "), low - 20.0)
            }
        };
        let lens = format!("{{ name = {}, effects = [\"sepia\"], shape = {{ {shape} }} }}", quoted(&name));
        match self.document.set(&format!("lens.{index}={lens}")) {
            Ok(()) => {
                self.chosen.lens = Some(index);
                self.message = None;
            }
            Err(error) => self.fail(error),
        }
    }

    /// Shows what is drawn so far, and how long it is.
    pub(super) fn show_drawing(&self, ui: &Ui, view: &View, rect: Rect) {
        let Some(Drawing { figure, points }) = &self.drawing else { return };
        let painter = ui.painter_at(rect);
        let spot =
            |place: &DVec3| view.pixel(*place).map(|p| rect.min + (pos2(p.x as f32, p.y as f32) - pos2(0.0, 0.0)));
        let mut all = points.clone();
        all.extend(self.canvas.pointed());
        if *figure == Figure::Area && all.len() > 2 {
            all.push(all[0]);
        }
        for ends in all.windows(2) {
            if let (Some(a), Some(b)) = (spot(&ends[0]), spot(&ends[1])) {
                painter.line_segment([a, b], Stroke::new(4.0, Color32::from_white_alpha(180)));
                painter.line_segment([a, b], Stroke::new(2.0, Color32::from_rgb(208, 72, 0)));
                if *figure == Figure::Measure {
                    let way = ends[1] - ends[0];
                    let text = format!(
                        "{:.2} m, {:.2} along the ground, {:+.2} up",
                        way.length(),
                        way.truncate().length(),
                        way.z
                    );
                    caption(&painter, a.lerp(b, 0.5), Align2::CENTER_BOTTOM, &text, 13.0);
                }
            }
        }
        for place in points.iter().filter_map(spot) {
            painter.circle(place, 4.0, Color32::from_rgb(208, 72, 0), Stroke::new(1.5, Color32::WHITE));
        }
        if *figure == Figure::Measure && all.len() > 2 {
            let text = format!("{:.2} m in all", length_of(&all));
            caption(&painter, rect.center_top() + eframe::egui::vec2(0.0, 8.0), Align2::CENTER_TOP, &text, 15.0);
        }
    }
}

fn length_of(points: &[DVec3]) -> f64 {
    points.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}
