//! The timeline: which moment the scene shows, what comes and goes when, and play.

use eframe::egui::{self, Key, Rect, Sense, Ui, vec2};

use crate::{
    app::{
        state::Window,
        timeline::{
            known::{Known, Line},
            paint::Sign,
        },
    },
    scene::{Animation, Command, Scene},
    time::{Interval, Moment, SECOND, Span},
};

mod known;
mod paint;

/// How long playing takes from one end to the other, seconds.
const PLAY_S: f64 = 20.0;

/// How fast it is played.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Speed {
    /// All of the line in [`PLAY_S`], times that.
    Whole(f64),
    /// As the clock goes, times that.
    Clock(f64),
}

/// How fast it may be played; by the clock what moves by timetables.
const SPEEDS: [(Speed, &str); 8] = [
    (Speed::Whole(0.25), "¼×"),
    (Speed::Whole(0.5), "½×"),
    (Speed::Whole(1.0), "1×"),
    (Speed::Whole(2.0), "2×"),
    (Speed::Whole(4.0), "4×"),
    (Speed::Clock(1.0), "real time"),
    (Speed::Clock(10.0), "10× real time"),
    (Speed::Clock(60.0), "60× real time"),
];
/// Columns of the histogram, at most; each at least so many points wide.
const MOST_COLUMNS: usize = 200;
const COLUMN_PT: f32 = 4.0;

/// What the timeline knows and does.
#[derive(Debug)]
pub struct Timeline {
    known: Option<Known>,
    /// Which line is chosen, where there are several.
    line: Option<Line>,
    /// Whether it plays.
    pub plays: bool,
    speed: Speed,
    /// What is played round and round; `None`: all of the line, once.
    pub range: Option<[Moment; 2]>,
    /// The moment while it is dragged or played, microseconds: finer than what the scene shows.
    at: Option<i64>,
    /// What is typed as a moment.
    draft: Option<String>,
}

impl Default for Timeline {
    fn default() -> Self {
        Self { known: None, line: None, plays: false, speed: Speed::Whole(1.0), range: None, at: None, draft: None }
    }
}

/// The line that is shown.
#[derive(Clone, Copy, Debug)]
struct Shown {
    line: Line,
    /// Its first and its last moment.
    span: [Moment; 2],
    /// Those of what is played.
    range: [Moment; 2],
    /// Where it is in the window.
    rect: Rect,
}

impl Shown {
    /// How far on the line a moment is, points from the left of the window.
    fn x(&self, at: Moment) -> f32 {
        let [first, last] = self.span;
        let share = ((at - first) as f64 / (last - first).max(1) as f64).clamp(0.0, 1.0);
        self.rect.left() + share as f32 * self.rect.width()
    }

    /// The moment of a place.
    fn moment(&self, x: f32) -> Moment {
        let [first, last] = self.span;
        let share = f64::from(((x - self.rect.left()) / self.rect.width().max(1.0)).clamp(0.0, 1.0));
        let micros = first.micros() + (share * (last - first) as f64).round() as i64;
        Moment::from_micros(micros).unwrap_or(first)
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
    /// What is played begins now.
    LoopFrom,
    /// What is played ends now.
    LoopUntil,
    /// The present view is a camera key of the present moment.
    Key,
}

impl Window {
    /// Whether its city has a timeline.
    pub fn has_timeline(&self) -> bool {
        self.timeline.known.as_ref().is_some_and(|known| known.lines().next().is_some())
    }

    /// The line that is shown, before it has a place.
    fn shown_line(&self) -> Option<Shown> {
        let known = self.timeline.known.as_ref()?;
        let line = known.line(self.timeline.line, self.document.scene().moment)?;
        let span = known.span(line)?;
        let within = |[from, until]: [Moment; 2]| {
            let range = [from.max(span[0]), until.min(span[1])];
            (range[0] < range[1]).then_some(range)
        };
        let range = self.timeline.range.and_then(within).unwrap_or(span);
        Some(Shown { line, span, range, rect: Rect::ZERO })
    }

    /// Does what a key says.
    pub(super) fn step_time(&mut self, step: Step) {
        let Some(shown) = self.shown_line() else { return };
        let Some(unit) = self.timeline.known.as_ref().map(|known| known.unit(shown.line)) else { return };
        let (span, [from, until]) = (shown.span, shown.range);
        let now = self.document.scene().moment.unwrap_or(span[0]);
        match step {
            Step::Play => {
                self.timeline.plays ^= true;
                // From the end it begins again.
                let is_within = self.document.scene().moment.is_some_and(|at| (from..until).contains(&at));
                let start = if is_within { now } else { from };
                self.timeline.at = self.timeline.plays.then(|| start.micros());
            }
            Step::Back => self.show_moment(now.shifted(Span::of_micros(-1)).floored(unit), span),
            Step::On => self.show_moment(now.shifted(Span::of_micros(1)).ceiled(unit), span),
            Step::LoopFrom => self.loop_between(&shown, [now, until]),
            Step::LoopUntil => self.loop_between(&shown, [from, now]),
            Step::Key => self.keep_view(&shown),
        }
    }

    /// What is played from now on; all of the line is no part of it, and ends that meet leave it as it is.
    fn loop_between(&mut self, shown: &Shown, [from, until]: [Moment; 2]) {
        let [first, last] = shown.span;
        let range = [from.clamp(first, last), until.clamp(first, last)];
        if range[0] < range[1] {
            self.timeline.range = Some(range).filter(|range| *range != shown.span);
        }
    }

    /// Makes the present view a camera key of the present moment.
    fn keep_view(&mut self, shown: &Shown) {
        let scene = self.document.scene();
        let (Some(camera), at) = (scene.camera, scene.moment.unwrap_or(shown.span[0])) else { return };
        match Animation::with_key(scene.animation.as_ref(), &camera, at, shown.range) {
            Ok(animation) => {
                let told = self.timeline.known.as_ref().map(|known| known.told(shown.line, at)).unwrap_or_default();
                self.document.edit(format!("camera key at {told}"), |scene| scene.animation = Some(animation));
                self.say(format!("The view is the camera's key at {told}."));
            }
            Err(error) => self.fail(error),
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
        let Some(shown) = self.shown_line() else { return };
        egui::Panel::bottom("timeline").show(ui, |ui| {
            ui.horizontal(|ui| {
                self.buttons(ui, &shown);
                self.typed(ui);
                self.line(ui, shown);
            });
        });
        if self.timeline.plays {
            self.play(ui, &shown);
        }
    }

    fn know_time(&mut self) {
        let Some(city) = &self.city else { return };
        let dating = &self.document.scene().city.dating;
        if !self.timeline.known.as_ref().is_some_and(|known| known.is_of(&city.model, dating)) {
            self.timeline.known = Some(Known::new(&city.model, dating));
            (self.timeline.plays, self.timeline.at) = (false, None);
            (self.timeline.line, self.timeline.range) = (None, None);
        }
    }

    fn buttons(&mut self, ui: &mut Ui, line: &Shown) {
        let (play, name) = match self.timeline.plays {
            true => (Sign::Pause, "Pause"),
            false => (Sign::Play, "Play through time"),
        };
        let all = [
            (Sign::Back, "Step back in time", ",", Step::Back),
            (play, name, "Space", Step::Play),
            (Sign::On, "Step on in time", ".", Step::On),
            (Sign::Key, "Keep the view for this moment", "C", Step::Key),
        ];
        for (sign, name, key, step) in all {
            if sign.button(ui, name, key) {
                self.step_time(step);
            }
        }
        let shown = SPEEDS.iter().find(|(speed, _)| *speed == self.timeline.speed).map_or("1×", |(_, name)| *name);
        let chosen = egui::ComboBox::from_id_salt("speed of time").selected_text(shown).width(48.0);
        let chosen = chosen.show_ui(ui, |ui| {
            let has_clock = line.line == Line::Timetables;
            for (speed, name) in SPEEDS.into_iter().filter(|(speed, _)| has_clock || matches!(speed, Speed::Whole(_))) {
                ui.selectable_value(&mut self.timeline.speed, speed, name);
            }
        });
        chosen.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Speed of time"));
        if self.timeline.known.as_ref().is_some_and(|known| known.lines().count() > 1) {
            let mut is_of_moves = line.line == Line::Timetables;
            let hint = "The line is of the timetables by which objects move, not of what comes and goes";
            if ui.checkbox(&mut is_of_moves, "Timetables").on_hover_text(hint).changed() {
                self.timeline.line = Some(if is_of_moves { Line::Timetables } else { Line::Dates });
                self.timeline.range = None;
            }
        }
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

    /// The line with its histogram; a drag scrubs. Its handles stand beside what is played.
    fn line(&mut self, ui: &mut Ui, mut shown: Shown) {
        let size = vec2(ui.available_width().max(80.0), 36.0);
        let (whole, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Timeline"));
        shown.rect = whole.shrink2(vec2(paint::HANDLE_PT, 0.0));
        let rect = shown.rect;
        let Some(known) = &self.timeline.known else { return };
        let told = |at: Moment| known.told(shown.line, at);
        let dragged = known.dragged(shown.line);
        let now = self.document.scene().moment.map(told).unwrap_or_default();
        let count = ((rect.width() / COLUMN_PT) as usize).clamp(1, MOST_COLUMNS);
        paint::columns(ui, rect, &known.columns(shown.span, count));
        paint::ends(ui, rect, shown.span.map(told));
        self.handles(ui, &shown, whole);
        if let Some(animation) = &self.document.scene().animation {
            let moments = animation.camera.iter().filter_map(|key| animation.moment_of(key.at));
            let is_there = |at: &Moment| (shown.span[0]..=shown.span[1]).contains(at);
            paint::keys(ui, whole, moments.filter(is_there).map(|at| shown.x(at)));
        }
        if let Some(at) = self.document.scene().moment {
            paint::cursor(ui, rect, shown.x(at), &now);
        }
        if let Some(pointer) = response.interact_pointer_pos() {
            let at = shown.moment(pointer.x).floored(dragged).clamp(shown.span[0], shown.span[1]);
            self.timeline.plays = false;
            if self.document.scene().moment != Some(at) {
                let scene = Scene { moment: Some(at), ..self.document.scene().clone() };
                self.document.preview("move through time", scene);
            }
        }
    }

    /// The handles of what is played: dragged they go, a double click takes them back to the ends.
    fn handles(&mut self, ui: &mut Ui, shown: &Shown, whole: Rect) {
        let [from, until] = shown.range;
        let unit = self.timeline.known.as_ref().map(|known| known.dragged(shown.line));
        for (end, name) in [(0, "Loop from"), (1, "Loop until")] {
            let x = shown.x(shown.range[end]);
            let beside = if end == 0 { x - paint::HANDLE_PT..=x } else { x..=x + paint::HANDLE_PT };
            let grip = Rect::from_x_y_ranges(beside, whole.y_range());
            let response = ui.interact(grip, ui.scope_id().with(name), Sense::click_and_drag());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, name));
            let response =
                response.on_hover_text(format!("{name} here when it plays; a double click: all of the line"));
            let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
            if response.double_clicked() {
                self.timeline.range = None;
            } else if let (true, Some(pointer), Some(unit)) =
                (response.drag_delta().x != 0.0, response.interact_pointer_pos(), unit)
            {
                // By its middle.
                let aside = if end == 0 { 0.5 } else { -0.5 } * paint::HANDLE_PT;
                let at = shown.moment(pointer.x + aside);
                // To full units, but for the ends of the line.
                let at = if at <= shown.span[0] || at >= shown.span[1] { at } else { at.floored(unit) };
                let range = if end == 0 { [at, until] } else { [from, at] };
                self.loop_between(shown, range);
            }
        }
        paint::range(ui, shown.rect, shown.range.map(|at| shown.x(at)), self.timeline.range.is_some());
    }

    /// Goes on in time; round and round where a part of the line is played.
    fn play(&mut self, ui: &Ui, shown: &Shown) {
        let seconds = f64::from(ui.input(|input| input.stable_dt).min(0.5));
        let Some(played) = self.timeline.known.as_ref().map(|known| known.played(shown.line)) else { return };
        let [from, until] = shown.range;
        let per_second = match self.timeline.speed {
            Speed::Whole(times) => times * (shown.span[1] - shown.span[0]) as f64 / PLAY_S,
            Speed::Clock(times) => times * SECOND as f64,
        };
        let before = self.timeline.at.unwrap_or(from.micros());
        let next = before.saturating_add((seconds * per_second) as i64);
        let next = match self.timeline.range {
            Some(_) => from.micros() + (next - from.micros()).rem_euclid((until - from).max(1)),
            None => next,
        };
        self.timeline.at = Some(next);
        let at = Moment::from_micros(next).unwrap_or(until).clamp(from, until);
        self.timeline.plays = at < until;
        // A full unit may begin before what is played.
        self.show_moment(at.floored(played).max(from), shown.span);
        ui.ctx().request_repaint();
    }
}
