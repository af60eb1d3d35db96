//! The timeline: which moment the scene shows, what comes and goes when, and play.

use std::sync::Arc;

use eframe::egui::{self, Align2, FontId, Key, Rect, Sense, Stroke, Ui, pos2, vec2};

use crate::{
    app::state::Window,
    city::{
        CityModel,
        lifetime::{Dating, Lifetimes},
    },
    figure::moments::label,
    scene::{Command, Scene},
    time::{Granularity, Interval, Moment, Span, Unit},
};

/// How long playing takes from one end to the other, seconds.
const PLAY_S: f64 = 20.0;
/// How fast it may be played, times that.
const SPEEDS: [(f64, &str); 5] = [(0.25, "¼×"), (0.5, "½×"), (1.0, "1×"), (2.0, "2×"), (4.0, "4×")];
/// Columns of the histogram, at most; each at least so many points wide.
const MOST_COLUMNS: usize = 200;
const COLUMN_PT: f32 = 4.0;

/// What the timeline knows and does.
#[derive(Debug)]
pub struct Timeline {
    known: Option<Known>,
    /// Whether it plays, and how fast, times the whole in [`PLAY_S`].
    pub plays: bool,
    speed: f64,
    /// The moment while it is dragged or played, microseconds: finer than what the scene shows.
    at: Option<i64>,
    /// What is typed as a moment.
    draft: Option<String>,
}

impl Default for Timeline {
    fn default() -> Self {
        Self { known: None, plays: false, speed: 1.0, at: None, draft: None }
    }
}

/// When the objects of a city come and go.
#[derive(Debug)]
struct Known {
    model: Arc<CityModel>,
    dating: Dating,
    /// The moments at which something comes or goes, ascending; parts come and go with their buildings.
    events: Vec<Moment>,
    granularity: Granularity,
}

impl Known {
    fn new(model: &Arc<CityModel>, dating: &Dating) -> Self {
        let found = Lifetimes::new(model, dating).unwrap_or_default();
        let of_top = found.of.iter().zip(&model.objects).filter(|(_, object)| object.parents.is_empty());
        let mut events: Vec<Moment> =
            of_top.flat_map(|(lifetime, _)| [lifetime.begin, lifetime.end]).flatten().collect();
        events.sort_unstable();
        Self {
            model: model.clone(),
            dating: dating.clone(),
            events,
            granularity: found.granularity.unwrap_or(Granularity::Year),
        }
    }

    /// The first and the last moment of the line: all that comes and goes, and one unit more at both ends.
    fn span(&self) -> Option<[Moment; 2]> {
        let (first, last) = (*self.events.first()?, *self.events.last()?);
        let unit = self.unit();
        Some([first.shifted(Span::of_micros(-1)).floored(unit), last.shifted(unit.span()).ceiled(unit)])
    }

    /// What a step is: as finely as dates say it.
    fn unit(&self) -> Unit {
        match self.granularity {
            Granularity::Year => Unit::Months(12),
            Granularity::Month => Unit::Months(1),
            Granularity::Day => Unit::Micros(crate::time::DAY),
            Granularity::Minute => Unit::Micros(crate::time::MINUTE),
            _ => Unit::Micros(crate::time::SECOND),
        }
    }

    /// How many events are in each of so many columns of the line.
    fn columns(&self, [first, last]: [Moment; 2], count: usize) -> Vec<u32> {
        let mut columns = vec![0; count];
        for event in &self.events {
            let share = i128::from(*event - first) * count as i128 / i128::from((last - first).max(1));
            if let Some(column) = columns.get_mut(share.max(0) as usize) {
                *column += 1;
            }
        }
        columns
    }
}

/// Something that keys do to the timeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Plays, or stops.
    Play,
    /// A unit back.
    Back,
    /// A unit on.
    On,
}

impl Window {
    /// Whether its city has a timeline.
    pub fn has_timeline(&self) -> bool {
        self.timeline.known.as_ref().is_some_and(|known| !known.events.is_empty())
    }

    /// Does what a key says.
    pub(super) fn step_time(&mut self, step: Step) {
        let Some(known) = &self.timeline.known else { return };
        let (Some(span), unit) = (known.span(), known.unit()) else { return };
        let now = self.document.scene().moment.unwrap_or(span[0]);
        match step {
            Step::Play => {
                self.timeline.plays ^= true;
                // From the end it begins again.
                let is_over = self.document.scene().moment.is_none_or(|at| at >= span[1]);
                let start = if is_over { span[0] } else { now };
                self.timeline.at = self.timeline.plays.then(|| start.micros());
            }
            Step::Back => self.show_moment(now.shifted(Span::of_micros(-1)).floored(unit), span),
            Step::On => self.show_moment(now.shifted(Span::of_micros(1)).ceiled(unit), span),
        }
    }

    fn show_moment(&mut self, at: Moment, [first, last]: [Moment; 2]) {
        let at = at.clamp(first, last);
        if self.document.scene().moment != Some(at) {
            let command = Command::show_moment(self.document.scene(), Some(at));
            self.document.apply(command);
        }
    }

    /// The panel below the canvas.
    pub(super) fn show_timeline(&mut self, ui: &mut Ui) {
        self.know_time();
        let Some(span) = self.timeline.known.as_ref().and_then(Known::span) else { return };
        egui::Panel::bottom("timeline").show(ui, |ui| {
            ui.horizontal(|ui| {
                self.buttons(ui);
                self.typed(ui);
                self.line(ui, span);
            });
        });
        if self.timeline.plays {
            self.play(ui, span);
        }
    }

    fn know_time(&mut self) {
        let Some(city) = &self.city else { return };
        let dating = &self.document.scene().city.dating;
        let is_known = |known: &Known| Arc::ptr_eq(&known.model, &city.model) && known.dating == *dating;
        if !self.timeline.known.as_ref().is_some_and(is_known) {
            self.timeline.known = Some(Known::new(&city.model, dating));
            (self.timeline.plays, self.timeline.at) = (false, None);
        }
    }

    fn buttons(&mut self, ui: &mut Ui) {
        let (play, name) = match self.timeline.plays {
            true => (Sign::Pause, "Pause"),
            false => (Sign::Play, "Play through time"),
        };
        let all = [
            (Sign::Back, "Step back in time", ",", Step::Back),
            (play, name, "Space", Step::Play),
            (Sign::On, "Step on in time", ".", Step::On),
        ];
        for (sign, name, key, step) in all {
            if sign.button(ui, name, key) {
                self.step_time(step);
            }
        }
        let shown = SPEEDS.iter().find(|(speed, _)| *speed == self.timeline.speed).map_or("1×", |(_, name)| *name);
        let chosen = egui::ComboBox::from_id_salt("speed of time").selected_text(shown).width(48.0);
        let chosen = chosen.show_ui(ui, |ui| {
            for (speed, name) in SPEEDS {
                ui.selectable_value(&mut self.timeline.speed, speed, name);
            }
        });
        chosen.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Speed of time"));
    }

    /// The moment, to be typed; nothing shows all.
    fn typed(&mut self, ui: &mut Ui) {
        let shown = self.document.scene().moment.map(Moment::written).unwrap_or_default();
        let mut text = self.timeline.draft.clone().unwrap_or_else(|| shown.clone());
        let field = egui::TextEdit::singleline(&mut text).desired_width(96.0).hint_text("all times");
        let response = ui
            .add(field)
            .on_hover_text("The moment that shows: a year, a date or a date-time; empty: all objects are there");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Moment"));
        if response.has_focus() {
            self.timeline.draft = Some(text.clone());
        }
        let is_done = response.lost_focus() && !ui.input(|input| input.key_pressed(Key::Escape));
        if response.lost_focus() {
            self.timeline.draft = None;
        }
        if !is_done || text.trim() == shown {
            return;
        }
        let moment = match text.trim() {
            "" => Ok(None),
            typed => Interval::parse(typed).and_then(|read| match read.begin {
                None => Err(format!("\"{typed}\" has no beginning")),
                begin => Ok(begin),
            }),
        };
        match moment {
            Ok(moment) => {
                let command = Command::show_moment(self.document.scene(), moment).beginning();
                self.document.apply(command);
            }
            Err(wrong) => self.fail(wrong),
        }
    }

    /// The line with its histogram; a drag scrubs.
    fn line(&mut self, ui: &mut Ui, span: [Moment; 2]) {
        let size = vec2(ui.available_width().max(80.0), 36.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Timeline"));
        let Some(known) = &self.timeline.known else { return };
        let (granularity, unit) = (known.granularity, known.unit());
        let count = ((rect.width() / COLUMN_PT) as usize).clamp(1, MOST_COLUMNS);
        paint_columns(ui, rect, &known.columns(span, count));
        let total = (span[1] - span[0]).max(1);
        let share = |at: Moment| ((at - span[0]) as f64 / total as f64).clamp(0.0, 1.0) as f32;
        paint_ends(ui, rect, span.map(|at| label(at, Some(granularity))));
        if let Some(at) = self.document.scene().moment {
            let x = rect.left() + share(at) * rect.width();
            paint_cursor(ui, rect, x, &label(at, Some(granularity)));
        }
        if let Some(pointer) = response.interact_pointer_pos() {
            let share = f64::from(((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0));
            let micros = span[0].micros() + (share * total as f64).round() as i64;
            let at = Moment::from_micros(micros).unwrap_or(span[0]).floored(unit).clamp(span[0], span[1]);
            self.timeline.plays = false;
            if self.document.scene().moment != Some(at) {
                let scene = Scene { moment: Some(at), ..self.document.scene().clone() };
                self.document.preview("move through time", scene);
            }
        }
    }

    /// Goes on in time.
    fn play(&mut self, ui: &Ui, span: [Moment; 2]) {
        let seconds = f64::from(ui.input(|input| input.stable_dt).min(0.5));
        let unit = self.timeline.known.as_ref().map_or(Unit::Months(12), Known::unit);
        let total = (span[1] - span[0]) as f64;
        let before = self.timeline.at.unwrap_or(span[0].micros());
        let next = before.saturating_add((total * seconds * self.timeline.speed / PLAY_S) as i64);
        self.timeline.at = Some(next);
        let at = Moment::from_micros(next).unwrap_or(span[1]).min(span[1]);
        self.timeline.plays = at < span[1];
        self.show_moment(at.floored(unit), span);
        ui.ctx().request_repaint();
    }
}

/// What is on a button: drawn, for fonts lack it.
#[derive(Clone, Copy)]
enum Sign {
    Back,
    Play,
    Pause,
    On,
}

impl Sign {
    /// A button with it; whether it was clicked.
    fn button(self, ui: &mut Ui, name: &str, key: &str) -> bool {
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
        }
        button.clicked()
    }
}

fn paint_columns(ui: &Ui, rect: Rect, columns: &[u32]) {
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

fn paint_ends(ui: &Ui, rect: Rect, [first, last]: [String; 2]) {
    let (font, color) = (FontId::proportional(10.0), ui.visuals().weak_text_color());
    let painter = ui.painter_at(rect);
    painter.text(rect.left_bottom() + vec2(4.0, -1.0), Align2::LEFT_BOTTOM, first, font.clone(), color);
    painter.text(rect.right_bottom() + vec2(-4.0, -1.0), Align2::RIGHT_BOTTOM, last, font, color);
}

fn paint_cursor(ui: &Ui, rect: Rect, x: f32, text: &str) {
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
