//! Tables of scene-file keys: a widget for each key, and a menu of those that are not given.

use eframe::egui::{self, Ui};
use toml::{Table as TomlTable, Value};

use crate::{
    app::properties::{
        edits::{Edits, To},
        handled::{EFFECTS, OPERATORS, list},
        kinds::{of_kind, of_other_kind},
        values::{title_of, value_of},
        widget::{Setting, Takes, widget, wrong},
    },
    figure::scene_file::{
        best_view::VIEWS,
        deformation::STEPS,
        keys::{Key, Kind, Table},
        overlay::OVERLAY,
        shape_keys::SHAPES,
        test_keys::TESTS,
    },
    shader::effect,
};

/// Words that only a person has: what is written on figures.
const WORDS: &[&str] = &["title", "caption"];

/// Which keys of a table have a widget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Those that are given.
    Given,
    /// Those too whose default is a value.
    All,
}

/// Tables of one kind, each under its name, with a button that takes it away, and one for another.
pub fn tables(ui: &mut Ui, edits: &mut Edits, key: &Key, keys: &'static Table, value: &Value, path: &str) {
    let list = value.as_array().map_or(&[][..], Vec::as_slice);
    for (i, own) in list.iter().enumerate() {
        let Some(inner) = own.as_table() else { continue };
        let at = format!("{path}.{i}");
        let name = ["name", "path", "effect"].iter().find_map(|key| inner.get(*key).and_then(Value::as_str));
        let name = name.map_or_else(|| format!("{} {}", title_of(keys.name), i + 1), str::to_owned);
        egui::CollapsingHeader::new(name).id_salt(&at).show(ui, |ui| {
            table(ui, edits, keys, Shown::Given, inner, &at);
            if ui.small_button("Take it away").clicked() {
                edits.push(at.clone(), To::Nothing);
            }
        });
        wrong(ui, edits.drafts, &at);
    }
    // For points of interest and volumes there is a better way: those in the examples are in no city.
    let example = value_of(key.example).and_then(|all| all.as_array().and_then(|all| all.first().cloned()));
    if let Some(example) = example.filter(|_| !["poi", "volume"].contains(&key.name))
        && ui.small_button(format!("Add {}", keys.name)).on_hover_text(keys.doc).clicked()
    {
        edits.push(format!("{path}.{}", list.len()), To::Value(example));
    }
    wrong(ui, edits.drafts, &format!("{path}.{}", list.len()));
}

/// A table that is one of several kinds, with a list to choose another from.
fn kind_of_several(ui: &mut Ui, edits: &mut Edits, family: &'static [Table], given: &TomlTable, path: &str) {
    let kind = given.get("kind").and_then(Value::as_str).unwrap_or("");
    let Some(keys) = of_kind(family, kind) else { return own_handler(ui, edits, kind, given, path) };
    ui.horizontal(|ui| {
        let label = ui.label("Kind").on_hover_text(keys.doc).id;
        let shown = egui::ComboBox::from_id_salt((path, "kind")).selected_text(kind).show_ui(ui, |ui| {
            for table in family {
                if ui.selectable_label(table.name == keys.name, table.name).on_hover_text(table.doc).clicked() {
                    let to = To::Value(of_other_kind(table, given));
                    edits.push(path.to_owned(), to);
                }
            }
        });
        shown.response.labelled_by(label);
    });
    table(ui, edits, keys, Shown::Given, given, path);
}

/// A shape or a step of a user's: the keys of its table, and the parameters that its header has.
fn own_handler(ui: &mut Ui, edits: &mut Edits, kind: &str, given: &TomlTable, path: &str) {
    ui.label(kind).on_hover_text("A handler of your own");
    let definition = effect::named().find(|handler| handler.name == kind);
    let parameters = || definition.into_iter().flat_map(|handler| &handler.parameters);
    let is_parameter = |key: &str| parameters().any(|parameter| parameter.name == key);
    let mut row = |name: &str, doc: &str, takes: Takes, unit: &str, value: &Value| {
        let place = format!("{path}.{name}");
        ui.horizontal(|ui| {
            let label = ui.label(title_of(name)).on_hover_text(doc).id;
            widget(ui, edits, takes, value, &Setting { path: &place, unit, hint: "", label });
        });
        wrong(ui, edits.drafts, &place);
    };
    // Those of its box.
    for (name, value) in given.iter().filter(|(name, _)| *name != "kind" && !is_parameter(name)) {
        row(name, "", Takes::Numbers, "", value);
    }
    for parameter in parameters() {
        let value = given.get(&parameter.name).cloned().or_else(|| value_of(&parameter.default_text()));
        let value = value.unwrap_or_else(|| Value::String(String::new()));
        row(&parameter.name, &parameter.doc, Takes::of_parameter(&parameter.kind), &parameter.unit, &value);
    }
}

/// The keys of a table that are shown, and a menu of the others.
pub fn table(ui: &mut Ui, edits: &mut Edits, keys: &Table, shown: Shown, given: &TomlTable, path: &str) {
    let shows_all = shown == Shown::All;
    let mut absent = Vec::new();
    // What kind of thing a lens is, is chosen when it is made; of the others it is chosen in the list above.
    // And an overlay stays with its lens.
    let is_chosen = |key: &&Key| key.name != "kind" && !(keys.name == OVERLAY.name && key.name == "lens");
    for key in keys.keys.iter().filter(is_chosen) {
        match given.get(key.name) {
            Some(value) => field(ui, edits, key, value, true, &format!("{path}.{}", key.name)),
            // Words that only a person has: empty until they are written.
            None if shows_all && WORDS.contains(&key.name) => {
                let empty = Value::String(String::new());
                field(ui, edits, key, &empty, false, &format!("{path}.{}", key.name));
            }
            None if shows_all && matches!(key.kind, Kind::Operators) => {
                field(ui, edits, key, &Value::Array(Vec::new()), false, &format!("{path}.{}", key.name));
            }
            None => match value_of(key.default).filter(|_| shows_all && !matches!(key.kind, Kind::Background)) {
                Some(value) => field(ui, edits, key, &value, false, &format!("{path}.{}", key.name)),
                None => absent.push(key),
            },
        }
    }
    if absent.is_empty() {
        return;
    }
    ui.menu_button("More…", |ui| {
        egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for key in absent {
                let hint = format!(
                    "{}\nWithout it: {}",
                    key.doc,
                    if key.default.is_empty() { "must be given" } else { key.default }
                );
                if ui.button(key.name).on_hover_text(hint).clicked() {
                    ui.close();
                    edits.push(format!("{path}.{}", key.name), To::Typed(key.example.to_owned()));
                }
            }
        });
    })
    .response
    .on_hover_text("What else can be said");
}

/// Name, widget, and a button that takes it away.
fn field(ui: &mut Ui, edits: &mut Edits, key: &Key, value: &Value, is_given: bool, path: &str) {
    let hint = if key.unit.is_empty() { key.doc.to_owned() } else { format!("{} ({})", key.doc, key.unit) };
    let own_table = match key.kind {
        Kind::Table(table) => Some(table),
        Kind::WordOrTable(_, table) if value.is_table() => Some(table),
        _ => None,
    };
    let family = match key.kind {
        Kind::Shape => Some(SHAPES),
        Kind::Test => Some(TESTS),
        Kind::View => Some(VIEWS),
        _ => None,
    };
    let removable = is_given && !key.default.is_empty() && key.name != "name";
    if let (Some(keys), Some(inner)) = (own_table, value.as_table()) {
        egui::CollapsingHeader::new(title_of(key.name)).id_salt(path).default_open(true).show(ui, |ui| {
            table(ui, edits, keys, Shown::Given, inner, path);
        });
        return;
    }
    if let (Some(family), Some(inner)) = (family, value.as_table()) {
        egui::CollapsingHeader::new(title_of(key.name)).id_salt(path).default_open(true).show(ui, |ui| {
            kind_of_several(ui, edits, family, inner, path);
        });
        return;
    }
    match (key.kind, value) {
        (Kind::Effects, _) => return list(ui, edits, &EFFECTS, key, value, path),
        (Kind::Operators, _) => return list(ui, edits, &OPERATORS, key, value, path),
        (Kind::Tables(keys), Value::Array(_)) => {
            ui.label(title_of(key.name)).on_hover_text(hint);
            ui.indent(path, |ui| tables(ui, edits, key, keys, value, path));
            return;
        }
        (Kind::Steps, Value::Array(steps)) => {
            ui.label(title_of(key.name)).on_hover_text(hint);
            for (i, step) in steps.iter().enumerate() {
                if let Some(inner) = step.as_table() {
                    ui.indent((path, i), |ui| {
                        kind_of_several(ui, edits, STEPS, inner, &format!("{path}.{i}"));
                    });
                }
            }
            ui.menu_button("Add step", |ui| {
                for table in STEPS {
                    if ui.button(table.name).on_hover_text(table.doc).clicked() {
                        ui.close();
                        let to = To::Value(of_other_kind(table, &TomlTable::new()));
                        edits.push(format!("{path}.{}", steps.len()), to);
                    }
                }
            });
            return;
        }
        _ => {}
    }
    ui.horizontal(|ui| {
        let label = ui.label(title_of(key.name)).on_hover_text(&hint);
        let setting = Setting { path, unit: key.unit, hint: "", label: label.id };
        widget(ui, edits, Takes::of(&key.kind), value, &setting);
        if removable && ui.small_button("×").on_hover_text(format!("Take it away: {}", key.default)).clicked() {
            edits.push(path.to_owned(), To::Nothing);
        }
    });
    wrong(ui, edits.drafts, path);
}
