//! The lenses of the scene, the top one first.

use crate::app::{
    actions::{Action, Menu, ROWS},
    state::{Renaming, Window},
};

use eframe::egui::{self, Align, Color32, Id, Layout, RichText, Sense, Ui};

/// The state of a lens for the person at the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Nothing special.
    Normal,
    /// The pointer is on it, in the list or in the picture.
    RollOver,
    /// It is the chosen one.
    Selected,
    /// It does nothing.
    Disabled,
}

impl Window {
    /// The state of a lens now; that it is switched off goes before all else.
    pub fn state_of(&self, lens: usize) -> State {
        let is_enabled = self.document.scene().lenses.get(lens).is_some_and(|lens| lens.enabled);
        match (self.chosen.lens == Some(lens), self.rolled_over == Some(lens)) {
            _ if !is_enabled => State::Disabled,
            (true, _) => State::Selected,
            (false, true) => State::RollOver,
            (false, false) => State::Normal,
        }
    }

    /// Begins to give a lens another name.
    pub(super) fn begin_renaming(&mut self, lens: usize) {
        let Some(own) = self.document.scene().lenses.get(lens) else { return };
        self.renaming = Some(Renaming { lens, text: own.name.clone(), is_fresh: true });
    }
}

/// The list.
pub fn show(window: &mut Window, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.heading("Lenses");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.menu_button("+ Add", |ui| {
                let context = ui.ctx().clone();
                for row in ROWS.iter().filter(|row| row.menu == Menu::Lens) {
                    let needs_object = match row.action {
                        Action::AddLens(kind) => kind.needs_object(),
                        Action::Draw(_) => false,
                        _ => continue,
                    };
                    let button = egui::Button::new(row.name);
                    let response = ui.add_enabled(window.can(row.action), button);
                    if needs_object {
                        response.clone().on_disabled_hover_text("Choose an object first: click on it.");
                    }
                    if response.clicked() {
                        ui.close();
                        window.act(&context, row.action);
                    }
                }
            });
        });
    });
    if window.document.scene().lenses.is_empty() {
        ui.weak("No lens yet. Add one: it is put on the chosen object, or in the middle of the picture.");
        return;
    }
    let count = window.document.scene().lenses.len();
    let mut moved = None;
    // The top one first, as they lie on each other.
    for index in (0..count).rev() {
        let id = Id::unique(("lens row", index));
        let (_, dropped) = ui.dnd_drop_zone::<usize, ()>(egui::Frame::NONE, |ui| {
            row(window, ui, index, id);
        });
        if let Some(from) = dropped {
            moved = Some((*from, index));
        }
    }
    if let Some((from, to)) = moved {
        window.move_lens(from, to);
    }
    ui.horizontal_wrapped(|ui| {
        let context = ui.ctx().clone();
        let buttons = [
            ("Raise", Action::RaiseLens),
            ("Lower", Action::LowerLens),
            ("Duplicate", Action::DuplicateLens),
            ("Delete", Action::DeleteLens),
        ];
        for (name, action) in buttons {
            let hint = ROWS.iter().find(|row| row.action == action).map_or("", |row| row.name);
            let response = ui.add_enabled(window.can(action), egui::Button::new(name).small()).on_hover_text(hint);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, hint));
            if response.clicked() {
                window.act(&context, action);
            }
        }
    });
}

fn row(window: &mut Window, ui: &mut Ui, index: usize, id: Id) {
    let Some(lens) = window.document.scene().lenses.get(index).cloned() else { return };
    let is_chosen = window.chosen.lens == Some(index);
    let is_locked = window.is_locked(&lens);
    let fill = match (is_chosen, window.state_of(index)) {
        (true, _) => ui.visuals().selection.bg_fill.gamma_multiply(0.45),
        (_, State::RollOver) => ui.visuals().selection.bg_fill.gamma_multiply(0.2),
        _ => Color32::TRANSPARENT,
    };
    let shown = egui::Frame::NONE.fill(fill).inner_margin(4.0).corner_radius(4.0).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.dnd_drag_source(id, index, grip).response.on_hover_text("Drag to reorder");
            let mut enabled = lens.enabled;
            let toggle = ui.add_enabled(!is_locked, egui::Checkbox::without_text(&mut enabled));
            toggle.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::CheckBox, true, enabled, format!("{} is on", lens.name))
            });
            if toggle.changed() {
                window.document.edit("switch lens", |scene| scene.lenses[index].enabled = enabled);
            }
            let mut rgb = lens.color.map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
            let picker = ui.add_enabled_ui(!is_locked, |ui| ui.color_edit_button_srgb(&mut rgb)).inner;
            picker.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::ColorWell, !is_locked, format!("Colour of {}", lens.name))
            });
            if picker.changed() {
                let mut scene = window.document.scene().clone();
                scene.lenses[index].color = rgb.map(|c| f32::from(c) / 255.0);
                window.document.preview("colour of the lens", scene);
            }
            if window.renaming.as_ref().is_some_and(|renaming| renaming.lens == index) {
                rename(window, ui);
                return;
            }
            let text = RichText::new(&lens.name);
            let text = if lens.enabled { text } else { text.weak() };
            let name = ui.add(egui::Button::selectable(is_chosen, text).sense(Sense::click()).truncate());
            if name.clicked() {
                window.chosen.lens = Some(index);
                window.is_lens_last = true;
            }
            if name.double_clicked() && !is_locked {
                window.begin_renaming(index);
            }
            name.on_hover_text(format!("{} lens; a double click renames it", lens.kind.word()));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let lock = ui.selectable_label(is_locked, RichText::new("lock").small());
                lock.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::Button, true, is_locked, format!("Lock {}", lens.name))
                });
                if lock.on_hover_text("Locked lenses are not changed").clicked() {
                    match is_locked {
                        true => window.locked.retain(|name| *name != lens.name),
                        false => window.locked.push(lens.name.clone()),
                    }
                }
                ui.weak(lens.kind.word());
            });
        });
    });
    if shown.response.contains_pointer() {
        window.rolls_over = Some(index);
    }
}

/// The field for another name: Enter takes it, Escape leaves it.
fn rename(window: &mut Window, ui: &mut Ui) {
    let Some(mut renaming) = window.renaming.take() else { return };
    let field = ui.add(egui::TextEdit::singleline(&mut renaming.text).desired_width(f32::INFINITY));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Name of the lens"));
    if std::mem::take(&mut renaming.is_fresh) {
        field.request_focus();
    }
    match field.lost_focus() {
        false => window.renaming = Some(renaming),
        true if ui.input(|input| input.key_pressed(egui::Key::Escape)) => {}
        true => {
            let name = renaming.text.trim();
            let is_same = window.document.scene().lenses.get(renaming.lens).is_some_and(|lens| lens.name == name);
            if !is_same && let Err(error) = window.document.rename_lens(renaming.lens, name) {
                window.fail(error);
            }
        }
    }
}

/// Six dots to hold a row by.
fn grip(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(10.0, 14.0), Sense::hover());
    for (x, y) in [(3.0, 3.0), (7.0, 3.0), (3.0, 7.0), (7.0, 7.0), (3.0, 11.0), (7.0, 11.0)] {
        ui.painter().circle_filled(rect.min + egui::vec2(x, y), 1.1, ui.visuals().weak_text_color());
    }
}
