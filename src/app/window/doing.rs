//! Effects of actions.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use eframe::egui::{self, Context};
use glam::{DVec2, DVec3};

use crate::{
    app::{
        actions::Action,
        file_dialog::{Asking, FileDialog, Purpose},
        new_lens::{self, Spot},
        objects,
        render_thread::{Draw, Export, Opened},
        state::{Chosen, Window},
        unsaved::LeftBehind,
        user_effects::is_effect,
        window::{BUILTIN, shown_path},
    },
    figure::{picture, scene_file},
    geom::Aabb,
    lens::Lens,
    scene::{Command, Scene},
    view::{Projection, navigate},
};

impl Window {
    /// Whether an action means anything now.
    pub fn can(&self, action: Action) -> bool {
        let lens = self.chosen.lens.and_then(|index| self.document.scene().lenses.get(index));
        match action {
            Action::Undo => self.document.names()[0].is_some(),
            Action::Redo => self.document.names()[1].is_some(),
            Action::DuplicateLens => lens.is_some(),
            Action::RenameLens | Action::DeleteLens | Action::RaiseLens | Action::LowerLens | Action::ToggleLens => {
                lens.is_some_and(|lens| !self.is_locked(lens))
            }
            Action::HideObject | Action::IsolateObject => self.chosen.object.is_some(),
            Action::FrameChosen => self.chosen != Chosen::default(),
            Action::CopyPicture => self.frame.as_ref().is_some_and(|frame| !frame.rgba.is_empty()),
            Action::Time(_) => self.has_timeline(),
            Action::AddLens(kind) => self.city.is_some() && (!kind.needs_object() || self.chosen.object.is_some()),
            Action::Quit | Action::Open | Action::OpenBuiltin | Action::Shortcuts | Action::ToggleTheme => true,
            _ => self.city.is_some(),
        }
    }

    /// Whether a lens is not to be changed.
    pub fn is_locked(&self, lens: &Lens) -> bool {
        self.locked.contains(&lens.name)
    }

    /// Does it, where it means anything.
    pub fn act(&mut self, context: &Context, action: Action) {
        if !self.can(action) {
            return;
        }
        match action {
            Action::Open => self.dialog = Some(FileDialog::open(self.folder())),
            Action::AddFiles => self.dialog = Some(FileDialog::add(self.folder())),
            Action::OpenBuiltin => self.guarded(Purpose::OpenThese(vec![BUILTIN.into()])),
            Action::Save => match self.document.file().map(Path::to_owned) {
                Some(file) => self.save(&file),
                None => self.dialog = Some(FileDialog::save(self.folder())),
            },
            Action::SaveAs => self.dialog = Some(FileDialog::save(self.folder())),
            Action::Export => self.dialog = Some(FileDialog::export(self.folder())),
            Action::CopyPicture => self.copy_picture(context),
            Action::Quit => self.guarded(Purpose::Quit),
            Action::Undo | Action::Redo => self.undo_or_redo(action),
            Action::AddLens(kind) => {
                let spot = self.spot();
                match kind.add(&mut self.document, &spot) {
                    Ok(index) => self.chosen.lens = Some(index),
                    Err(error) => self.fail(error),
                }
            }
            Action::Time(step) => self.step_time(step),
            Action::Draw(figure) => self.begin_drawing(figure),
            Action::ToggleWalk => {
                self.walks ^= true;
                let how = if self.walks {
                    "Walking: W A S D go along the ground."
                } else {
                    "Flying: W A S D go where you look."
                };
                self.say(how);
                self.canvas.step_down = self.walks;
            }
            Action::DuplicateLens => self.duplicate(),
            Action::RenameLens => {
                if let Some(index) = self.chosen.lens {
                    self.begin_renaming(index);
                }
            }
            Action::DeleteLens => self.delete_chosen_lens(),
            Action::RaiseLens => self.reorder(1),
            Action::LowerLens => self.reorder(-1),
            Action::ToggleLens => {
                if let Some(index) = self.chosen.lens {
                    self.document.edit("switch lens", |scene| scene.lenses[index].enabled ^= true);
                }
            }
            Action::GoHome => {
                if let (Some(camera), Some(home)) = (self.camera(), self.canvas.home) {
                    self.canvas.fly(camera, home);
                }
            }
            Action::FrameAll => {
                let extent = self.city.as_ref().map_or(Aabb::EMPTY, |city| city.extent);
                self.frame_box(&extent);
            }
            Action::FrameChosen => {
                let bounds = self.chosen_box();
                self.frame_box(&bounds);
            }
            Action::Look(axis) => {
                if let (Some(city), Some(camera)) = (&self.city, self.camera()) {
                    let to = navigate::axis_view(axis, &city.extent, &camera, self.canvas.aspect());
                    self.canvas.fly(camera, to);
                }
            }
            Action::ToggleProjection => self.toggle_projection(),
            Action::HideObject => objects::hide(self),
            Action::IsolateObject => objects::isolate(self),
            Action::ShowAll => objects::show_all(self),
            Action::Find => self.finder.wants_focus = true,
            Action::ToggleCost => {
                self.shows_cost ^= true;
            }
            Action::TogglePreview => self.previews ^= true,
            Action::ToggleTheme => {
                let is_dark = context.global_style().visuals.dark_mode;
                context.set_theme(if is_dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Action::Shortcuts => self.shows_shortcuts = true,
        }
        context.request_repaint();
    }

    /// Takes back the last edit, or does again what was taken back last.
    fn undo_or_redo(&mut self, action: Action) {
        let before = self.document.scene().lenses.len();
        let (done, name) = match action {
            Action::Undo => ("Undone", self.document.undo()),
            _ => ("Done again", self.document.redo()),
        };
        if let Some(name) = name {
            self.say(format!("{done}: {name}"));
        }
        self.keep_chosen();
        // A lens that came back is the one that is meant.
        let now = self.document.scene().lenses.len();
        if now > before && self.chosen.lens.is_none() {
            self.chosen.lens = Some(now - 1);
        }
    }

    /// Removes the chosen lens, and what shows it; says which lenses were linked to it, as they keep what they show.
    fn delete_chosen_lens(&mut self) {
        let Some(index) = self.chosen.lens.take() else { return };
        self.document.settle();
        let scene = self.document.scene();
        let Some(command) = Command::remove_lens(scene, index) else { return };
        let name = &scene.lenses[index].name;
        let linked = Command::linked_to(scene, name);
        let text = match &linked[..] {
            [] => None,
            linked => Some(format!(
                "{name} is removed. Linked to it {} {}: what {} shows stays, by steps of its own.",
                if linked.len() == 1 { "was" } else { "were" },
                linked.join(", "),
                if linked.len() == 1 { "it" } else { "each" },
            )),
        };
        self.document.apply(command);
        if let Some(text) = text {
            self.say(text);
        }
        self.keep_chosen();
    }

    /// Changes between perspective and orthographic.
    fn toggle_projection(&mut self) {
        if let Some(camera) = self.camera() {
            let to_orthographic = match camera.projection {
                Projection::Perspective { fov_y } => {
                    self.fov_y = fov_y;
                    true
                }
                Projection::Orthographic { .. } => false,
            };
            self.put_eye(navigate::with_projection(&camera, to_orthographic, self.fov_y));
        }
    }

    /// Where dialogs begin.
    fn folder(&self) -> PathBuf {
        let near = self.document.file().or(self.document.scene().city.files.first().map(PathBuf::as_path));
        let folder = near.and_then(Path::parent).filter(|folder| folder.is_dir()).map(Path::to_owned);
        folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default()
    }

    /// Does what would lose edits only once that is agreed.
    pub(in crate::app) fn guarded(&mut self, purpose: Purpose) {
        let keeps_city = matches!(&purpose, Purpose::OpenThese(files) if files.iter().all(|file| is_effect(file)));
        match self.document.is_changed() && !keeps_city {
            true => self.asking = Some(Asking::Lose(purpose)),
            false => self.go_on(purpose),
        }
    }

    pub(in crate::app) fn go_on(&mut self, purpose: Purpose) {
        match purpose {
            Purpose::Quit => self.quits = true,
            Purpose::OpenThese(files) => self.open(&files),
        }
    }

    /// Writes the scene.
    pub fn save(&mut self, file: &Path) {
        match self.document.save(file) {
            Ok(()) if self.document.leads_outside() => self.say(format!(
                "{} is saved. It names files outside its folder: commands that read it need --allow-outside.",
                file.display()
            )),
            Ok(()) => self.say(format!("{} is saved.", file.display())),
            Err(error) => return self.fail(error),
        }
        if let Some(purpose) = self.after_saving.take() {
            self.go_on(purpose);
        }
    }

    /// Opens edits that a window before left behind.
    pub(in crate::app) fn bring_back(&mut self, left: LeftBehind) {
        match left.read() {
            Ok(document) => {
                // Whoever edited them had them open.
                self.allows_outside = true;
                self.load(&document);
                (self.waiting, self.coming_back) = (Some(document), Some(left));
            }
            Err(error) => self.fail(error),
        }
    }

    /// Keeps edits that are not saved, asks about those that were left behind, and forgets those that came back.
    pub(super) fn keep_edits(&mut self, context: &Context) {
        let Some(unsaved) = &mut self.unsaved else { return };
        if self.quits {
            unsaved.forget();
            return;
        }
        if let Some(pause) = unsaved.follow(&self.document) {
            context.request_repaint_after(pause);
        }
        if self.waiting.is_none()
            && let Some(left) = self.coming_back.take_if(|_| unsaved.has(&self.document))
        {
            left.remove();
        }
        let is_free = self.asking.is_none() && self.dialog.is_none() && self.loading.is_none();
        if is_free && !self.left_behind.is_empty() {
            self.asking = Some(Asking::ComeBack(self.left_behind.remove(0)));
            context.request_repaint();
        }
    }

    /// What was to come back does not: where it stays.
    pub(super) fn stays_behind(&mut self) -> String {
        let left = self.coming_back.take();
        left.map_or_else(String::new, |left| format!(" The edits stay in {}.", left.file.display()))
    }

    /// Writes the figure.
    pub fn export(&mut self, file: &Path) {
        self.document.settle();
        // What the file says: angles are written in degrees.
        let scene = match self.document.as_written() {
            Ok(scene) => scene,
            Err(error) => return self.fail(error),
        };
        self.write_figure(scene, file, true);
    }

    /// The size of the picture that the window shows, where it shows one, pixels.
    pub fn shown_size(&self) -> Option<[u32; 2]> {
        Some(self.asked.as_ref()?.size)
    }

    /// Writes what the window shows, as large as it shows it and with the samples of the figure.
    pub fn export_shown(&mut self, file: &Path) {
        self.document.settle();
        let Some(draw) = self.asked.as_ref() else { return };
        let draw = Draw { is_moving: false, ..draw.clone() };
        let mut scene = draw.scene_at(draw.size);
        scene.figure.set_pixels(draw.size);
        self.write_figure(scene, file, false);
    }

    fn write_figure(&mut self, scene: Scene, file: &Path, is_of_scene: bool) {
        let notes = picture::notes_of(&scene, &self.document.options());
        self.render_thread.export(Export { scene: Arc::new(scene), file: file.to_owned(), notes, is_of_scene });
        self.say(format!("Writing {}…", file.display()));
    }

    /// Puts the picture that the window shows into the clipboard.
    fn copy_picture(&mut self, context: &Context) {
        let Some(frame) = &self.frame else { return };
        let size = frame.view.size.map(|side| side as usize);
        if size[0] * size[1] != frame.rgba.len() {
            return;
        }
        context.copy_image(egui::ColorImage::from_rgba_unmultiplied(size, frame.rgba.as_flattened()));
        self.say(format!("The picture is in the clipboard: {} × {} pixels.", size[0], size[1]));
    }

    /// The line that makes the figure without a window.
    pub fn command_line(&self) -> Option<String> {
        let scene = self.document.file()?;
        let figure = self.exported.as_ref().map_or_else(|| PathBuf::from("figure.png"), |(_, file)| file.clone());
        let allowing = if self.document.leads_outside() { " --allow-outside" } else { "" };
        Some(format!("veduta render {} -o {}{allowing}", shown_path(scene), shown_path(&figure)))
    }

    /// Where a new lens is put: on the chosen object, else where the pointer is, else in the middle of what is seen.
    fn spot(&self) -> Spot {
        let object = self.chosen.object.and_then(|object| {
            let city = self.city.as_ref()?;
            let root = city.roots.get(object as usize).copied()?;
            Some((city.model.objects[root as usize].id.to_string(), self.bounds_of(city, root)))
        });
        match object {
            Some((id, bounds)) if !bounds.is_empty() => {
                let radius = (0.6 * bounds.size().length()).max(1.0);
                let at = bounds.center().with_z(bounds.min.z);
                Spot { at, share: self.share_of(at), radius, object: Some(id) }
            }
            _ => {
                let camera = self.camera();
                let shown = || self.canvas.middle(self.frame.as_deref());
                let at = self.canvas.pointed().or_else(shown).or(camera.map(|camera| camera.target));
                let distance = camera.zip(at).map_or(100.0, |(camera, at)| camera.eye.distance(at));
                let at = at.unwrap_or(DVec3::ZERO);
                let radius = (0.1 * distance).clamp(1.0, 2_000.0);
                Spot { at, share: self.share_of(at), radius, object: None }
            }
        }
    }

    /// Where a place is in the picture, shares of its width and height; the middle where it is in none.
    fn share_of(&self, at: DVec3) -> DVec2 {
        let view = self.canvas.rect.and_then(|rect| self.view_in(rect));
        let share = view.and_then(|view| {
            let pixel = view.pixel(at)?.truncate();
            Some(pixel / DVec2::from(view.size.map(f64::from)))
        });
        share
            .filter(|share| share.cmpge(DVec2::ZERO).all() && share.cmple(DVec2::ONE).all())
            .unwrap_or(DVec2::splat(0.5))
    }

    fn duplicate(&mut self) {
        let Some(index) = self.chosen.lens else { return };
        let mut lens = self.document.scene().lenses[index].clone();
        let stem = lens.name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end().to_owned();
        lens.name = new_lens::free_name(self.document.scene(), &stem);
        lens.color = scene_file::lens_color(self.document.scene().lenses.len());
        self.document.edit(format!("duplicate lens {stem}"), |scene| scene.lenses.insert(index + 1, lens));
        self.chosen.lens = Some(index + 1);
    }

    fn reorder(&mut self, by: isize) {
        let Some(index) = self.chosen.lens else { return };
        let Some(to) = index.checked_add_signed(by) else { return };
        self.move_lens(index, to);
    }

    /// Moves a lens to another place in the order.
    pub(in crate::app) fn move_lens(&mut self, index: usize, to: usize) {
        self.document.settle();
        if let Some(command) = Command::reorder_lens(self.document.scene(), index, to) {
            self.document.apply(command);
            self.chosen.lens = Some(to);
        }
    }

    fn keep_chosen(&mut self) {
        let count = self.document.scene().lenses.len();
        self.chosen.lens = self.chosen.lens.filter(|index| *index < count);
    }

    /// The box around an object with its parts where it stands, metres.
    pub(in crate::app) fn bounds_of(&self, city: &Opened, object: u32) -> Aabb {
        city.model.bounds_at(object, self.document.scene().shown_moment())
    }

    fn chosen_box(&self) -> Aabb {
        let of_lens = self.chosen_lens_box();
        match (self.chosen.object, &self.city) {
            (Some(object), Some(city)) if of_lens.is_empty() || !self.is_lens_last => self.bounds_of(city, object),
            _ => of_lens,
        }
    }

    pub(in crate::app) fn frame_box(&mut self, bounds: &Aabb) {
        if let (Some(camera), false) = (self.camera(), bounds.is_empty()) {
            let to = navigate::framed(&camera, bounds, self.canvas.aspect());
            self.canvas.fly(camera, to);
        }
    }
}
