//! All values of the chosen lens, of the style, the light and the figure: from the table of scene-file keys, so that whatever a scene can say
//! can be said here.

use eframe::egui::{self, RichText, Ui};
use glam::DVec3;
use toml::{Table as TomlTable, Value};

use crate::{
    app::{
        properties::{
            edits::{Change, Drafts, Edits, To},
            tables::{Shown, table, tables},
            values::title_of,
        },
        state::Window,
    },
    field::PLUME,
    figure::scene_file::{
        keys::{Key, Kind},
        lens::LENS,
        node::Data,
        overlay::OVERLAY,
        scene::ROOT,
    },
    view::Camera,
};

pub mod edits;
mod handled;
mod kinds;
pub mod looks;
mod tables;
mod transfer;
mod values;
mod widget;

/// Keys of the scene that stand elsewhere in the window: in the list of lenses, and with the chosen one.
const ELSEWHERE: &[&str] = &["veduta", "lens", "overlay"];
/// The keys that are needed most.
const FIRST: &[&str] = &["camera", "sun", "style", "poi", "volume", "figure"];

/// The panel.
pub fn show(window: &mut Window, drafts: &mut Drafts, ui: &mut Ui) {
    let root = drafts.root(&window.document);
    let mut edits = Edits { scene: window.document.scene(), drafts: &mut *drafts, changes: Vec::new() };
    if let Some(index) = window.chosen.lens {
        let lens = root.get("lens").and_then(|all| all.get(index)).and_then(Value::as_table).cloned();
        if let Some(lens) = lens {
            let is_locked = window.document.scene().lenses.get(index).is_some_and(|lens| window.is_locked(lens));
            ui.heading(lens.get("name").and_then(Value::as_str).unwrap_or("Lens"));
            if is_locked {
                ui.weak("Locked: it is not changed.");
            }
            ui.add_enabled_ui(!is_locked, |ui| {
                table(ui, &mut edits, &LENS, Shown::Given, &lens, &format!("lens.{index}"));
                overlay(ui, &mut edits, window, &root, index);
            });
        }
    }
    let sections = ROOT.keys.iter().filter(|key| !ELSEWHERE.contains(&key.name));
    let (first, rare): (Vec<&Key>, Vec<&Key>) = sections.partition(|key| FIRST.contains(&key.name));
    for key in first {
        section(window, &mut edits, &root, key, ui);
    }
    egui::CollapsingHeader::new(RichText::new("More of the scene").strong()).show(ui, |ui| {
        for key in rare {
            section(window, &mut edits, &root, key, ui);
        }
    });
    for Change { path, to, is_held } in edits.changes {
        let renamed = window.chosen.lens.filter(|index| path == format!("lens.{index}.name"));
        let data = |value: &Value| Some(Data::from(value));
        let done = match (&to, renamed) {
            (To::Value(Value::String(name)), Some(index)) => window.document.rename_lens(index, name),
            (To::Value(value), _) if is_held => window.document.preview_value(&path, data(value)),
            (To::Value(value), _) => window.document.set_value(&path, data(value)),
            (To::Typed(text), _) => window.document.set(&format!("{path}={text}")),
            (To::Nothing, _) => window.document.set_value(&path, None),
        };
        match done {
            Ok(()) => {
                drafts.wrong.remove(&path);
                drafts.texts.remove(&path);
            }
            Err(error) => {
                drafts.wrong.insert(path, error);
            }
        }
    }
}

/// The properties of the chosen lens' overlay, if it has one.
fn overlay(ui: &mut Ui, edits: &mut Edits, window: &Window, root: &TomlTable, lens: usize) {
    let scene = window.document.scene();
    let Some(lens) = scene.lenses.get(lens).filter(|lens| lens.kind.has_overlay()) else { return };
    let given = root.get("overlay").and_then(Value::as_array).cloned().unwrap_or_default();
    let is_own = |own: &Value| own.get("lens").and_then(Value::as_str) == Some(&*lens.name);
    let at = given.iter().position(is_own);
    let path = format!("overlay.{}", at.unwrap_or(given.len()));
    let own = at.and_then(|at| given[at].as_table().cloned()).unwrap_or_default();
    egui::CollapsingHeader::new("Overlay").id_salt("overlay of the lens").default_open(true).show(ui, |ui| {
        let before = edits.changes.len();
        table(ui, edits, &OVERLAY, Shown::All, &own, &path);
        for Change { path: place, to, is_held } in edits.changes.split_off(before) {
            let name = Value::String(lens.name.clone());
            let (path, to) = match (at, place.strip_prefix(&format!("{path}.")), to) {
                // The first that is said of it makes its table.
                (None, Some(key), To::Value(value)) => {
                    let own = TomlTable::from_iter([("lens".to_owned(), name), (key.to_owned(), value)]);
                    (path.clone(), To::Value(Value::Table(own)))
                }
                (None, Some(key), To::Typed(text)) => {
                    (path.clone(), To::Typed(format!("{{ lens = {name}, {key} = {text} }}")))
                }
                (_, _, to) => (place, to),
            };
            edits.changes.push(Change { path, to, is_held });
        }
    });
}

/// A table, or a list of tables, of the scene.
fn section(window: &Window, edits: &mut Edits, root: &TomlTable, key: &Key, ui: &mut Ui) {
    let heading = match key.name {
        "poi" => "Points of interest".to_owned(),
        "volume" => "Volumes".to_owned(),
        name => title_of(name),
    };
    egui::CollapsingHeader::new(RichText::new(heading).strong()).id_salt(key.name).show(ui, |ui| {
        ui.weak(key.doc);
        match key.kind {
            Kind::Table(keys) => {
                let own = root.get(key.name).and_then(Value::as_table).cloned().unwrap_or_default();
                table(ui, edits, keys, Shown::All, &own, key.name);
            }
            Kind::Tables(keys) => {
                if key.name == "volume" {
                    transfers(window, edits, root, ui);
                }
                let none = Value::Array(Vec::new());
                tables(ui, edits, key, keys, root.get(key.name).unwrap_or(&none), key.name);
                if let ("poi" | "volume", Some(at)) = (key.name, window.canvas.middle(window.frame.as_deref()))
                    && ui.button("Add one in the middle of the picture").clicked()
                {
                    let scene = window.document.scene();
                    let numbers = |point: DVec3| {
                        Value::Array(point.to_array().map(|c| Value::Float((c * 100.0).round() / 100.0)).to_vec())
                    };
                    let (count, table) = match key.name {
                        "poi" => (scene.pois.len(), TomlTable::from_iter([("at".to_owned(), numbers(at))])),
                        _ => (scene.volumes.len(), volume_around(at, window.camera(), numbers)),
                    };
                    edits.push(format!("{}.{count}", key.name), To::Value(Value::Table(table)));
                }
            }
            _ => {}
        }
        if key.name == "figure" {
            command_line(window, ui);
        }
    });
}

/// The built-in volume around a place, half as wide as it is far away.
fn volume_around(at: DVec3, camera: Option<Camera>, numbers: impl Fn(DVec3) -> Value) -> TomlTable {
    let far = camera.map_or(100.0, |camera| camera.eye.distance(at)).max(1.0);
    // It is 65 x 65 x 25 samples.
    let step = 0.5 * far / 64.0;
    let low = DVec3::new(at.x - 32.0 * step, at.y - 32.0 * step, at.z);
    TomlTable::from_iter([
        ("file".to_owned(), Value::String(PLUME.to_owned())),
        ("origin".to_owned(), numbers(low)),
        ("spacing".to_owned(), numbers(DVec3::new(step, step, 0.5 * step).max(DVec3::splat(0.01)))),
    ])
}

/// The transfer functions of the volumes that are shown.
fn transfers(window: &Window, edits: &mut Edits, root: &TomlTable, ui: &mut Ui) {
    let scene = window.document.scene();
    let Some(frame) = window.frame.as_deref() else { return };
    for shown in &frame.volumes {
        let Some(volume) = scene.volumes.get(shown.index).filter(|volume| !volume.labels) else { continue };
        let path = format!("volume.{}", shown.index);
        let given = root.get("volume").and_then(|all| all.get(shown.index)).and_then(|own| own.get("transfer"));
        let given = given.and_then(Value::as_table).cloned().unwrap_or_default();
        ui.label(format!("{}: {}", volume.name, shown.title));
        transfer::editor(ui, edits, volume, shown, &given, &path);
    }
}

fn command_line(window: &Window, ui: &mut Ui) {
    match window.command_line() {
        Some(line) => {
            ui.label("The same without a window:");
            ui.horizontal(|ui| {
                if ui.small_button("Copy").clicked() {
                    ui.ctx().copy_text(line.clone());
                }
                ui.add(egui::Label::new(RichText::new(&line).monospace()).wrap());
            });
        }
        None => {
            ui.weak("Once the scene is saved, the command that makes the figure stands here.");
        }
    }
}
