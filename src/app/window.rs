//! The window: its state, how the panels stand, and what comes back from the render thread.

mod doing;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use eframe::egui::{self, Context, RichText, Ui};

use crate::{
    app::{
        actions::{self, Action, Menu, ROWS},
        canvas_state::Canvas,
        cost, dialogs,
        document::Document,
        drawn::Drawing,
        file_dialog::{Asking, Purpose},
        finder::Finder,
        lens_list, objects, properties,
        render_thread::{Draw, Frame, Notify, RenderThread, Reply},
        state::{Chosen, Message, Window},
        theme,
        timeline::Timeline,
        unsaved::Unsaved,
        user_effects,
    },
    city::load::LoadOptions,
    figure::scene_file::{self, Options},
    scene::{CitySpec, Scene, above_ground, check_against},
    view::Camera,
};

/// The city that is shown where no other is named.
pub const BUILTIN: &str = crate::city::builtin::FIRST;
/// Files that are remembered.
const MOST_RECENT: usize = 10;

/// The state that the window begins with.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// A scene file, or city files; none: the built-in city.
    pub files: Vec<PathBuf>,
    /// Whether paths in models may leave the folders that were named.
    pub allow_outside: bool,
    /// Where files that were opened are remembered; `None`: nowhere.
    pub memory: Option<PathBuf>,
    /// Folders whose effects were added: they are read again when they change.
    pub effects: Vec<PathBuf>,
}

impl Start {
    /// Where this system keeps what a program remembers for its user.
    pub fn user_memory() -> Option<PathBuf> {
        let of = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let home = |below: &str| of("HOME").map(|home| home.join(below));
        let folder = match std::env::consts::OS {
            "windows" => of("APPDATA"),
            "macos" => home("Library/Application Support"),
            _ => of("XDG_CONFIG_HOME").or_else(|| home(".config")),
        };
        folder.map(|folder| folder.join("veduta/recent.txt"))
    }
}

impl Window {
    /// A window that begins to load.
    ///
    /// # Errors
    /// The system has no thread left.
    pub fn new(context: &Context, start: &Start) -> std::io::Result<Self> {
        theme::set(context);
        let own = context.clone();
        let notify: Notify = Arc::new(move || own.request_repaint());
        let unsaved = start.memory.as_ref().and_then(|file| Unsaved::new(file.with_file_name("unsaved")));
        let left_behind = unsaved.as_ref().map(Unsaved::left_behind).unwrap_or_default();
        let mut window = Self {
            render_thread: RenderThread::new(notify)?,
            document: Document::default(),
            city: None,
            loading: None,
            spec: CitySpec::default(),
            shown_spec: CitySpec::default(),
            waiting: None,
            frame: None,
            chosen: Chosen::default(),
            known_chosen: Chosen::default(),
            is_lens_last: false,
            canvas: Canvas::default(),
            finder: Finder::default(),
            dialog: None,
            asking: None,
            message: None,
            shows_cost: false,
            previews: false,
            drawing: None,
            walks: false,
            shows_shortcuts: false,
            locked: Vec::new(),
            lens_names: Vec::new(),
            rolled_over: None,
            rolls_over: None,
            renaming: None,
            recent: start.memory.as_deref().map(remembered).unwrap_or_default(),
            memory: start.memory.clone(),
            exported: None,
            statistics: None,
            times_ms: Vec::new(),
            asked: None,
            title: String::new(),
            quits: false,
            unsaved,
            left_behind,
            coming_back: None,
            after_saving: None,
            held_against: None,
            fov_y: 45.0_f64.to_radians(),
            allow_outside: start.allow_outside,
            allows_outside: start.allow_outside,
            drafts: properties::edits::Drafts::default(),
            timeline: Timeline::default(),
        };
        window.render_thread.watch(&start.effects, true);
        let files = if start.files.is_empty() { vec![PathBuf::from(BUILTIN)] } else { start.files.clone() };
        window.open(&files);
        Ok(window)
    }

    /// The figure that is being drawn on the city.
    pub fn drawing(&self) -> Option<&Drawing> {
        self.drawing.as_ref()
    }

    /// Whether a city is on its way.
    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// Whether the window is to be closed.
    pub fn quits(&self) -> bool {
        self.quits
    }

    /// Opens a scene, or city files as one city. What is shown stays until they are there. Effect files are added beside. A scene
    /// that reads files outside its folder is opened when the person allows it.
    pub fn open(&mut self, files: &[PathBuf]) {
        self.open_allowing(files, self.allow_outside);
    }

    /// The same; `allow_outside`: whether a scene may read files outside its folder.
    pub(super) fn open_allowing(&mut self, files: &[PathBuf], allow_outside: bool) {
        let files = &self.without_effects(files)[..];
        if files.is_empty() {
            return;
        }
        let is_scene = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        let document = match files.iter().find(|path| is_scene(path)) {
            Some(file) => {
                let options = |allow_outside| Options { allow_outside, must_exist: true, ..Options::for_file(file) };
                match scene_file::read(file, &options(allow_outside)) {
                    Ok(scene) => Document::new(scene, Some(file.clone())),
                    // It is fine but for that.
                    Err(error) if !allow_outside && scene_file::read(file, &options(true)).is_ok() => {
                        self.asking = Some(Asking::Outside(files.to_vec(), error.to_string()));
                        return;
                    }
                    Err(error) => return self.fail(error.to_string()),
                }
            }
            None => {
                let city = CitySpec { files: files.to_vec(), ..CitySpec::default() };
                Document::new(Scene { city, ..Scene::default() }, None)
            }
        };
        if document.scene().is_empty() {
            return self.fail("The scene names no city; [city] files = [\"FILE\"] would be right.".to_owned());
        }
        for file in files {
            let is_builtin = file.to_string_lossy().starts_with("builtin:");
            self.recent.retain(|own| own != file);
            if !is_builtin {
                self.recent.insert(0, std::path::absolute(file).unwrap_or_else(|_| file.clone()));
            }
        }
        self.recent.truncate(MOST_RECENT);
        self.remember();
        self.allows_outside = allow_outside;
        self.load(&document);
        (self.waiting, self.coming_back) = (Some(document), None);
    }

    /// Files but for effects, which are added.
    fn without_effects(&self, files: &[PathBuf]) -> Vec<PathBuf> {
        let (effects, others): (Vec<PathBuf>, Vec<PathBuf>) =
            files.iter().cloned().partition(|path| user_effects::is_effect(path));
        self.render_thread.watch(&effects, false);
        others
    }

    /// Remembers the window; failures are ignored, as they are no reason to disturb anybody.
    fn remember(&self) {
        let Some(file) = &self.memory else { return };
        let lines: Vec<String> = self.recent.iter().map(|path| format!("{}\n", path.display())).collect();
        let written = file.parent().map_or(Ok(()), std::fs::create_dir_all);
        if let Err(error) = written.and_then(|()| std::fs::write(file, lines.concat())) {
            log::debug!("{}: {error}", file.display());
        }
    }

    fn load(&mut self, document: &Document) {
        self.spec = document.scene().city.clone();
        let mut roots: Vec<PathBuf> = self.spec.files.iter().filter(|path| path.is_dir()).cloned().collect();
        roots.push(document.options().base);
        self.loading = Some("Reading".to_owned());
        let reading = LoadOptions {
            allow_outside: self.allows_outside,
            roots,
            up: self.spec.up,
            materials: self.spec.materials,
            joins: self.spec.joins.clone(),
            changes: (self.spec.changes.clone(), self.spec.dating.clone()),
            timetables: self.spec.timetables.clone(),
            ..LoadOptions::default()
        };
        self.render_thread.open(self.spec.clone(), reading);
    }

    /// Whether the scene names a city that is loaded otherwise than the one that is there.
    fn wants_another_city(&self) -> bool {
        let asked = &self.document.scene().city;
        !asked.files.is_empty() && !asked.loads_as(&self.spec)
    }

    /// Loads again what edits of the scene ask for: other files, another level of detail.
    fn follow_city(&mut self) {
        if self.city.is_none() || self.loading.is_some() || !self.wants_another_city() {
            return;
        }
        let document = std::mem::take(&mut self.document);
        self.load(&document);
        self.document = document;
    }

    /// Remembers which was chosen last, a lens or an object.
    fn follow_chosen(&mut self) {
        let before = std::mem::replace(&mut self.known_chosen, self.chosen);
        if self.chosen.object != before.object {
            self.is_lens_last = false;
        }
        if self.chosen.lens != before.lens {
            self.is_lens_last = self.chosen.lens.is_some();
        }
    }

    /// Locks stay with lenses that got another name.
    fn follow_names(&mut self) {
        let now: Vec<&String> = self.document.scene().lenses.iter().map(|lens| &lens.name).collect();
        if now.len() == self.lens_names.len() {
            let mut others = now.iter().zip(&self.lens_names).filter(|(now, before)| *now != before);
            if let (Some((now, before)), None) = (others.next(), others.next())
                && let Some(locked) = self.locked.iter_mut().find(|locked| *locked == before)
            {
                locked.clone_from(now);
            }
        }
        if !now.iter().copied().eq(&self.lens_names) {
            self.lens_names = now.into_iter().cloned().collect();
            self.renaming = None;
        }
    }

    /// Puts more files into the city.
    pub fn add_files(&mut self, files: &[PathBuf]) {
        let files = self.without_effects(files);
        if files.is_empty() {
            return;
        }
        let new: Vec<PathBuf> =
            files.iter().map(|file| std::path::absolute(file).unwrap_or_else(|_| file.clone())).collect();
        self.document.edit("add files", |scene| scene.city.files.extend(new));
    }

    pub(super) fn fail(&mut self, text: String) {
        log::warn!("{text}");
        self.message = Some(Message { text, details: String::new(), is_error: true });
    }

    pub(super) fn say(&mut self, text: impl Into<String>) {
        self.message = Some(Message { text: text.into(), details: String::new(), is_error: false });
    }

    fn hear(&mut self, context: &Context) {
        for reply in self.render_thread.replies() {
            match reply {
                Reply::Loading(what) => self.loading = self.loading.is_some().then_some(what),
                Reply::Opened(opened) => {
                    self.loading = None;
                    if let Some(document) = self.waiting.take() {
                        self.document = document;
                    }
                    let count = opened.model.objects.len();
                    let mut text = format!("{}: {count} objects", self.document.title());
                    let details = opened.warnings.join("\n");
                    if !details.is_empty() {
                        let kinds = opened.warnings.len();
                        text += &format!(
                            "; {kinds} {} about the files (point here to read them)",
                            if kinds == 1 { "warning" } else { "kinds of warnings" }
                        );
                    }
                    self.message = Some(Message { text, details, is_error: false });
                    // A large city takes a while to be forgotten.
                    if let Some(before) = self.city.replace(opened.into()) {
                        std::thread::spawn(move || drop(before));
                    }
                    self.shown_spec = self.spec.clone();
                    (self.chosen, self.frame, self.asked) = (Chosen::default(), None, None);
                    self.held_against = None;
                    self.canvas.forget();
                    self.finder.forget();
                }
                Reply::NotOpened(error) => {
                    // What cannot be loaded is taken back, where it was an edit.
                    if self.waiting.take().is_none() && self.document.scene().city != self.shown_spec {
                        self.document.undo();
                    }
                    self.loading = None;
                    self.spec = self.shown_spec.clone();
                    let stays = self.stays_behind();
                    self.fail(error + &stays);
                }
                // Of the scene before, asked for before the city came.
                Reply::Frame(frame) if frame.scene.city != self.document.scene().city => {}
                Reply::Frame(mut frame) => {
                    self.canvas.show(context, &frame);
                    // A good first view is one for the shape of the window.
                    if self.document.scene().camera.is_none() && frame.scene.camera.is_none() {
                        self.document.begin_at(frame.view.camera);
                    }
                    if let Some(statistics) = frame.statistics.take() {
                        self.statistics = Some(statistics);
                    }
                    if frame.samples == 1 {
                        self.times_ms.push(frame.ms);
                        let many = self.times_ms.len().saturating_sub(120);
                        self.times_ms.drain(..many);
                    }
                    // What is shown of a better picture is what the first one told.
                    if frame.shown.is_none() {
                        let before = self.frame.take();
                        let is_same =
                            |before: &Frame| Arc::ptr_eq(&before.scene, &frame.scene) && before.view == frame.view;
                        if let Some(before) = before.filter(|before| is_same(before)) {
                            (frame.shown, frame.overlays) = (before.shown, before.overlays);
                        }
                    }
                    if self.message.as_ref().is_some_and(|message| message.text.starts_with(NOT_DRAWN)) {
                        self.message = None;
                    }
                    self.tell_what_is_not_there(&frame.scene);
                    self.frame = Some(frame);
                }
                // The city that it is about is on its way.
                Reply::NotDrawn(_) if self.loading.is_some() || self.wants_another_city() => {}
                Reply::NotDrawn(error) => self.fail(format!("{NOT_DRAWN}{error}")),
                Reply::Exported(file, false) => self.say(format!("{} is written.", file.display())),
                Reply::Exported(file, true) => {
                    let mut text = format!("{} is written.", file.display());
                    if let Some(scene) = self.document.file() {
                        self.exported = Some((scene.to_owned(), file));
                    }
                    text += &match self.command_line() {
                        Some(line) if !self.document.is_changed() => format!(" The same without a window: {line}"),
                        _ => " Once the scene is saved, a command makes it again (see Figure, on the left).".to_owned(),
                    };
                    self.say(text);
                }
                Reply::NotExported(error) => self.fail(error),
                Reply::Effect(name) => {
                    // What it is given in this scene may not be what it takes now.
                    match self.document.as_written() {
                        Ok(_) => self.say(format!("The effect {name} was read.")),
                        Err(error) => self.fail(format!("The effect {name} was read. {error}")),
                    }
                    self.asked = None;
                }
                Reply::NotEffect(error) => self.fail(format!("{error}; the effect stays as it was")),
            }
        }
    }

    /// Says what a scene names and its city does not have, once.
    fn tell_what_is_not_there(&mut self, scene: &Arc<Scene>) {
        let is_same = |before: &Arc<Scene>| {
            before.lenses == scene.lenses && before.pois == scene.pois && before.style == scene.style
        };
        if self.document.is_live() || self.held_against.as_ref().is_some_and(is_same) {
            return;
        }
        let Some(city) = &self.city else { return };
        let problems: Vec<String> = check_against(scene, &city.model).iter().map(ToString::to_string).collect();
        self.held_against = Some(Arc::clone(scene));
        if let [first, others @ ..] = &problems[..] {
            let more =
                if others.is_empty() { String::new() } else { format!("; and {} more (point here)", others.len()) };
            let (text, details) = (format!("{first}{more}"), problems.join("\n"));
            log::warn!("{}", problems.join("; "));
            self.message = Some(Message { text, details, is_error: true });
        }
    }

    /// The whole window.
    pub fn ui(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        self.hear(&context);
        let dropped: Vec<PathBuf> =
            context.input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect());
        if !dropped.is_empty() {
            self.guarded(Purpose::OpenThese(dropped));
        }
        if context.input(|input| input.viewport().close_requested()) && !self.quits && self.document.is_changed() {
            context.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.asking = Some(Asking::Lose(Purpose::Quit));
        }
        let is_modal = self.dialog.is_some() || self.asking.is_some() || self.shows_shortcuts;
        if !is_modal {
            for action in actions::asked(&context) {
                self.act(&context, action);
            }
        }
        self.follow_city();
        self.follow_names();
        self.follow_chosen();
        self.rolled_over = self.rolls_over.take();
        egui::Panel::top("menu").show(ui, |ui| self.menu(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        egui::Panel::left("lenses").default_size(300.0).min_size(220.0).resizable(true).show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                lens_list::show(self, ui);
                ui.separator();
                self.properties(ui);
            });
        });
        egui::Panel::right("objects").default_size(260.0).min_size(200.0).resizable(true).show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                objects::show(self, ui);
                if self.shows_cost {
                    ui.separator();
                    cost::show(self, ui);
                }
            });
        });
        self.show_timeline(ui);
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.draw_canvas(ui));
        // What is held is an edit when it is let go.
        if self.document.is_live() && !context.input(|input| input.pointer.any_down()) {
            self.document.settle();
        }
        self.keep_edits(&context);
        dialogs::show(self, &context);
        self.shortcuts(&context);
        let star = if self.document.is_changed() { "• " } else { "" };
        let title = match (&self.dialog, &self.asking) {
            (Some(dialog), _) => format!("{} — Veduta", dialog.title()),
            (None, Some(asking)) => format!("{} — Veduta", asking.title()),
            (None, None) => format!("{star}{} — Veduta", self.document.title()),
        };
        // Whatever is sent is followed by a frame.
        if self.title != title {
            context.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        if self.quits {
            // As it was agreed, before this frame or in it.
            self.keep_edits(&context);
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn properties(&mut self, ui: &mut Ui) {
        let mut drafts = std::mem::take(&mut self.drafts);
        properties::show(self, &mut drafts, ui);
        self.drafts = drafts;
    }

    /// Asks for the picture of what is edited, where it is another than the last one that was asked for. `size`: pixels; `meant_for`: the
    /// size that lengths in pixels are meant for.
    pub(super) fn want(&mut self, size: [u32; 2], meant_for: [u32; 2], is_moving: bool) {
        if self.city.is_none() || size.contains(&0) {
            return;
        }
        let mut scene = self.document.scene().clone();
        if !self.previews {
            (scene.figure.title, scene.figure.caption) = (None, None);
        }
        let draw = Draw { scene: Arc::new(scene), size, meant_for, is_moving, is_measured: self.shows_cost };
        if self.asked.as_ref() != Some(&draw) {
            self.render_thread.draw(draw.clone());
            self.asked = Some(draw);
        }
    }

    /// Where the eye is, in model coordinates; `None`: nobody knows yet, as long as it is given above ground that is not known.
    pub fn camera(&self) -> Option<Camera> {
        let scene = self.document.scene();
        let camera = scene.camera?;
        match scene.camera_above_ground {
            true => above_ground::raised(&camera, &self.ground()).ok(),
            false => Some(camera),
        }
    }

    fn menu(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        egui::MenuBar::new().ui(ui, |ui| {
            for (menu, name) in Menu::ALL {
                ui.menu_button(name, |ui| {
                    for row in ROWS.iter().filter(|row| row.menu == menu) {
                        let mut name = row.name.to_owned();
                        let [undo, redo] = self.document.names();
                        match row.action {
                            Action::Undo => name = undo.map_or(name, |what| format!("Undo: {what}")),
                            Action::Redo => name = redo.map_or(name, |what| format!("Redo: {what}")),
                            _ => {}
                        }
                        let mut button = egui::Button::new(name);
                        if let Some(key) = &row.key {
                            button = button.shortcut_text(context.format_shortcut(key));
                        }
                        if ui.add_enabled(self.can(row.action), button).clicked() {
                            ui.close();
                            self.act(&context, row.action);
                        }
                    }
                    if menu == Menu::File && !self.recent.is_empty() {
                        ui.separator();
                        ui.weak("Recent");
                        for file in self.recent.clone() {
                            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
                            if ui.button(name).on_hover_text(file.display().to_string()).clicked() {
                                ui.close();
                                self.guarded(Purpose::OpenThese(vec![file]));
                            }
                        }
                    }
                });
            }
        });
    }

    fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            // As high with nothing to say as with a button in it.
            ui.set_min_height(ui.spacing().interact_size.y);
            if let Some(what) = self.loading.clone() {
                ui.spinner();
                ui.label(what);
                if ui.button("Cancel").clicked() {
                    self.render_thread.cancel_opening();
                    if self.waiting.take().is_none() && self.document.scene().city != self.shown_spec {
                        self.document.undo();
                    }
                    self.loading = None;
                    self.spec = self.shown_spec.clone();
                    let stays = self.stays_behind();
                    self.say(format!("Loading was cancelled.{stays}"));
                }
            } else if let Some(Message { text, details, is_error }) = &self.message {
                let text = RichText::new(text);
                let text = if *is_error { text.color(ui.visuals().error_fg_color) } else { text };
                let label = ui.add(egui::Label::new(text).truncate());
                if !details.is_empty() {
                    label.on_hover_text(details);
                }
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if let Some(text) = self.canvas.place_text() {
                    ui.monospace(text);
                }
            });
        });
    }

    fn shortcuts(&mut self, context: &Context) {
        if !self.shows_shortcuts {
            return;
        }
        let response = egui::Modal::new(egui::Id::unique("shortcuts")).show(context, |ui| {
            ui.heading("Keys and mouse");
            ui.add_space(6.0);
            egui::ScrollArea::vertical().max_height(480.0).show(ui, |ui| {
                egui::Grid::new("shortcut list").num_columns(2).striped(true).spacing([24.0, 4.0]).show(ui, |ui| {
                    for (what, does) in actions::MOUSE {
                        ui.strong(*what);
                        ui.label(*does);
                        ui.end_row();
                    }
                    for row in ROWS {
                        let Some(key) = &row.key else { continue };
                        ui.strong(context.format_shortcut(key));
                        ui.label(row.name);
                        ui.end_row();
                    }
                });
            });
            ui.add_space(6.0);
            ui.button("Close").clicked()
        });
        if response.inner || response.should_close() {
            self.shows_shortcuts = false;
        }
    }
}

/// The beginning of a message that holds until something can be drawn again.
const NOT_DRAWN: &str = "Cannot be drawn: ";

/// Files that were opened before and still are there.
fn remembered(file: &Path) -> Vec<PathBuf> {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    text.lines().map(PathBuf::from).filter(|path| path.exists()).take(MOST_RECENT).collect()
}

/// A path as a shell takes it.
fn shown_path(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-".contains(c);
    if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}
