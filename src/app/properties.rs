//! All values of the chosen lens, of the style, the light and the figure: from the table of scene-file keys, so that whatever a scene can say
//! can be said here.

use std::{collections::BTreeMap, rc::Rc};

use eframe::egui::{self, DragValue, RichText, Ui};
use toml::{Table as TomlTable, Value};

use crate::{
    app::state::Window,
    figure::scene_file::{
        best_view::VIEWS,
        deformation::STEPS,
        keys::{Key, Kind, Table},
        lens::LENS,
        node::Data,
        overlay::OVERLAY,
        scene::ROOT,
        shape_keys::SHAPES,
        test_keys::TESTS,
        tree,
    },
    lens::rendering::ROWS,
    scene::Scene,
    shader::effect::{self, Fallback, ParameterKind},
};

/// What the scene has that stands elsewhere in the window: in the list of lenses, and with the chosen one.
const ELSEWHERE: &[&str] = &["veduta", "lens", "overlay"];
/// What is written on figures.
const WORDS: &[&str] = &["title", "caption"];
/// What a person asks for most.
const FIRST: &[&str] = &["camera", "sun", "style", "poi", "figure"];

/// The button that takes a value away, with the space before it, points.
const TAKE_AWAY_WIDTH: f32 = 36.0;

/// What is typed and not done yet, and what was wrong with it, by path.
#[derive(Debug, Default)]
pub struct Drafts {
    of: Option<(Scene, Rc<TomlTable>)>,
    texts: BTreeMap<String, String>,
    wrong: BTreeMap<String, String>,
}

impl Drafts {
    /// The scene as a table.
    fn root(&mut self, window: &Window) -> Rc<TomlTable> {
        let scene = window.document.scene();
        let is_known = self.of.as_ref().is_some_and(|(of, _)| of == scene);
        if !is_known {
            let table = match Value::from(&tree(scene, &window.document.options()).data) {
                Value::Table(table) => table,
                _ => TomlTable::new(),
            };
            self.of = Some((scene.clone(), Rc::new(table)));
        }
        self.of.as_ref().map(|(_, table)| table.clone()).unwrap_or_default()
    }
}

/// What a value becomes.
#[derive(Clone, Debug)]
enum To {
    /// Another value.
    Value(Value),
    /// What somebody typed.
    Typed(String),
    /// It is taken away.
    Nothing,
}

/// What a widget asks for.
#[derive(Clone, Debug)]
struct Change {
    path: String,
    to: To,
    /// It goes on.
    is_held: bool,
}

/// The panel.
pub fn show(window: &mut Window, drafts: &mut Drafts, ui: &mut Ui) {
    let root = drafts.root(window);
    let mut changes = Vec::new();
    if let Some(index) = window.chosen.lens {
        let lens = root.get("lens").and_then(|all| all.get(index)).and_then(Value::as_table).cloned();
        if let Some(lens) = lens {
            let is_locked = window.document.scene().lenses.get(index).is_some_and(|lens| window.is_locked(lens));
            ui.heading(lens.get("name").and_then(Value::as_str).unwrap_or("Lens"));
            if is_locked {
                ui.weak("Locked: it is not changed.");
            }
            ui.add_enabled_ui(!is_locked, |ui| {
                table(ui, drafts, (&LENS, false), &lens, &format!("lens.{index}"), &mut changes);
                overlay(ui, drafts, window, &root, index, &mut changes);
            });
        }
    }
    let sections = ROOT.keys.iter().filter(|key| !ELSEWHERE.contains(&key.name));
    let (first, rare): (Vec<&Key>, Vec<&Key>) = sections.partition(|key| FIRST.contains(&key.name));
    for key in first {
        section(window, drafts, &root, key, ui, &mut changes);
    }
    egui::CollapsingHeader::new(RichText::new("More of the scene").strong()).show(ui, |ui| {
        for key in rare {
            section(window, drafts, &root, key, ui, &mut changes);
        }
    });
    for Change { path, to, is_held } in changes {
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

/// How the picture of the chosen lens stands, if it has one.
fn overlay(
    ui: &mut Ui,
    drafts: &mut Drafts,
    window: &Window,
    root: &TomlTable,
    lens: usize,
    changes: &mut Vec<Change>,
) {
    let scene = window.document.scene();
    let Some(lens) = scene.lenses.get(lens).filter(|lens| lens.kind.has_overlay()) else { return };
    let given = root.get("overlay").and_then(Value::as_array).cloned().unwrap_or_default();
    let is_own = |own: &Value| own.get("lens").and_then(Value::as_str) == Some(&*lens.name);
    let at = given.iter().position(is_own);
    let path = format!("overlay.{}", at.unwrap_or(given.len()));
    let own = at.and_then(|at| given[at].as_table().cloned()).unwrap_or_default();
    egui::CollapsingHeader::new("Overlay").id_salt("overlay of the lens").default_open(true).show(ui, |ui| {
        let mut own_changes = Vec::new();
        table(ui, drafts, (&OVERLAY, true), &own, &path, &mut own_changes);
        for Change { path: place, to, is_held } in own_changes {
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
            changes.push(Change { path, to, is_held });
        }
    });
}

/// A table, or a list of tables, of the scene.
fn section(window: &Window, drafts: &mut Drafts, root: &TomlTable, key: &Key, ui: &mut Ui, changes: &mut Vec<Change>) {
    let heading = if key.name == "poi" { "Points of interest".to_owned() } else { title_of(key.name) };
    egui::CollapsingHeader::new(RichText::new(heading).strong()).id_salt(key.name).show(ui, |ui| {
        ui.weak(key.doc);
        match key.kind {
            Kind::Table(keys) => {
                let own = root.get(key.name).and_then(Value::as_table).cloned().unwrap_or_default();
                table(ui, drafts, (keys, true), &own, key.name, changes);
            }
            Kind::Tables(keys) => {
                let none = Value::Array(Vec::new());
                tables(ui, drafts, (key, keys), root.get(key.name).unwrap_or(&none), key.name, changes);
                if let ("poi", Some(at)) = (key.name, window.canvas.middle(window.frame.as_deref()))
                    && ui.button("Add one in the middle of the picture").clicked()
                {
                    let count = window.document.scene().pois.len();
                    let at = at.to_array().map(|c| Value::Float((c * 100.0).round() / 100.0)).to_vec();
                    let poi = TomlTable::from_iter([("at".to_owned(), Value::Array(at))]);
                    let to = To::Value(Value::Table(poi));
                    changes.push(Change { path: format!("poi.{count}"), to, is_held: false });
                }
            }
            _ => {}
        }
        if key.name == "figure" {
            command_line(window, ui);
        }
    });
}

/// Tables of one kind, each under its name, with a button that takes it away, and one for another.
fn tables(
    ui: &mut Ui,
    drafts: &mut Drafts,
    (key, keys): (&Key, &'static Table),
    value: &Value,
    path: &str,
    changes: &mut Vec<Change>,
) {
    let list = value.as_array().map_or(&[][..], Vec::as_slice);
    for (i, own) in list.iter().enumerate() {
        let Some(inner) = own.as_table() else { continue };
        let at = format!("{path}.{i}");
        let name = ["name", "path", "effect"].iter().find_map(|key| inner.get(*key).and_then(Value::as_str));
        let name = name.map_or_else(|| format!("{} {}", title_of(keys.name), i + 1), str::to_owned);
        egui::CollapsingHeader::new(name).id_salt(&at).show(ui, |ui| {
            table(ui, drafts, (keys, false), inner, &at, changes);
            if ui.small_button("Take it away").clicked() {
                changes.push(Change { path: at.clone(), to: To::Nothing, is_held: false });
            }
        });
        wrong(ui, drafts, &at);
    }
    // For a point of interest there is a better way: the one in the example is in no city.
    let example = value_of(key.example).and_then(|all| all.as_array().and_then(|all| all.first().cloned()));
    if let Some(example) = example.filter(|_| key.name != "poi")
        && ui.small_button(format!("Add {}", keys.name)).on_hover_text(keys.doc).clicked()
    {
        changes.push(Change { path: format!("{path}.{}", list.len()), to: To::Value(example), is_held: false });
    }
    wrong(ui, drafts, &format!("{path}.{}", list.len()));
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

/// A table that is one of several kinds, with a list to choose another from.
fn kind_of_several(
    ui: &mut Ui,
    drafts: &mut Drafts,
    family: &'static [Table],
    given: &TomlTable,
    path: &str,
    changes: &mut Vec<Change>,
) {
    let kind = given.get("kind").and_then(Value::as_str).unwrap_or("");
    let Some(keys) = of_kind(family, kind) else { return };
    ui.horizontal(|ui| {
        let label = ui.label("Kind").on_hover_text(keys.doc).id;
        let shown = egui::ComboBox::from_id_salt((path, "kind")).selected_text(kind).show_ui(ui, |ui| {
            for table in family {
                if ui.selectable_label(table.name == keys.name, table.name).on_hover_text(table.doc).clicked() {
                    let to = To::Value(of_other_kind(table, given));
                    changes.push(Change { path: path.to_owned(), to, is_held: false });
                }
            }
        });
        shown.response.labelled_by(label);
    });
    table(ui, drafts, (keys, false), given, path, changes);
}

/// A table of another kind: what both have stays, sizes stay about as they were, what else the other needs is as in its example.
fn of_other_kind(keys: &Table, given: &TomlTable) -> Value {
    let mut made = TomlTable::new();
    let half = half_extent(given);
    let before = given.get("kind").and_then(Value::as_str).and_then(|kind| of_kind(SHAPES, kind));
    // A size of two numbers is no size of three.
    let is_same_kind = |key: &Key| {
        let own = before.and_then(|table| table.keys.iter().find(|own| own.name == key.name));
        own.is_none_or(|own| std::mem::discriminant(&own.kind) == std::mem::discriminant(&key.kind))
    };
    let size = |name: &str| {
        let [x, y, z] = half?;
        let of = |numbers: &[f64]| Some(Value::Array(numbers.iter().map(|n| Value::Float(*n)).collect()));
        match (keys.name, name) {
            (_, "radius") => Some(Value::Float(x.max(y))),
            ("frustum", "top_radius") => Some(Value::Float(0.5 * x.max(y))),
            (_, "radii") => of(&[x, y, z]),
            ("box", "size") => of(&[2.0 * x, 2.0 * y, 2.0 * z]),
            ("cylinder" | "cone" | "frustum", "height") => Some(Value::Float(2.0 * z)),
            _ => None,
        }
    };
    for key in keys.keys {
        let value = match key.name {
            "kind" => Some(Value::String(keys.name.to_owned())),
            name => {
                let same = given.get(name).filter(|_| is_same_kind(key)).cloned();
                same.or_else(|| size(name)).or_else(|| key.default.is_empty().then(|| value_of(key.example)).flatten())
            }
        };
        if let Some(value) = value {
            made.insert(key.name.to_owned(), value);
        }
    }
    Value::Table(made)
}

/// Half of how large a shape is along its own axes, metres, where its kind says that.
fn half_extent(given: &TomlTable) -> Option<[f64; 3]> {
    let number = |key: &str| given.get(key).filter(|v| v.is_float() || v.is_integer()).map(number_of);
    let three = |key: &str| {
        let list = given.get(key)?.as_array()?;
        <[f64; 3]>::try_from(list.iter().map(number_of).collect::<Vec<_>>()).ok()
    };
    match given.get("kind").and_then(Value::as_str)? {
        "box" => three("size").map(|size| size.map(|side| 0.5 * side)),
        "ellipsoid" => three("radii"),
        "sphere" => number("radius").map(|r| [r; 3]),
        "cylinder" | "cone" | "frustum" => Some([number("radius")?, number("radius")?, 0.5 * number("height")?]),
        _ => None,
    }
}

/// The keys of a table: those that are given, with `shows_all` those too whose default is a value, and a menu of the others.
fn table(
    ui: &mut Ui,
    drafts: &mut Drafts,
    (keys, shows_all): (&Table, bool),
    given: &TomlTable,
    path: &str,
    changes: &mut Vec<Change>,
) {
    let mut absent = Vec::new();
    // What kind of thing a lens is, is chosen when it is made; of the others it is chosen in the list above.
    // And an overlay stays with its lens.
    let is_chosen = |key: &&Key| key.name != "kind" && !(keys.name == OVERLAY.name && key.name == "lens");
    for key in keys.keys.iter().filter(is_chosen) {
        match given.get(key.name) {
            Some(value) => field(ui, drafts, key, (value, true), &format!("{path}.{}", key.name), changes),
            // Words that only a person has: empty until they are written.
            None if shows_all && WORDS.contains(&key.name) => {
                let empty = Value::String(String::new());
                field(ui, drafts, key, (&empty, false), &format!("{path}.{}", key.name), changes);
            }
            None => match value_of(key.default).filter(|_| shows_all && !matches!(key.kind, Kind::Background)) {
                Some(value) => field(ui, drafts, key, (&value, false), &format!("{path}.{}", key.name), changes),
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
                    changes.push(Change {
                        path: format!("{path}.{}", key.name),
                        to: To::Typed(key.example.to_owned()),
                        is_held: false,
                    });
                }
            }
        });
    })
    .response
    .on_hover_text("What else can be said");
}

/// Name, widget, and a button that takes it away.
fn field(
    ui: &mut Ui,
    drafts: &mut Drafts,
    key: &Key,
    (value, is_given): (&Value, bool),
    path: &str,
    changes: &mut Vec<Change>,
) {
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
            table(ui, drafts, (keys, false), inner, path, changes);
        });
        return;
    }
    if let (Some(family), Some(inner)) = (family, value.as_table()) {
        egui::CollapsingHeader::new(title_of(key.name)).id_salt(path).default_open(true).show(ui, |ui| {
            kind_of_several(ui, drafts, family, inner, path, changes);
        });
        return;
    }
    match (key.kind, value) {
        (Kind::Effects, _) => return effects(ui, drafts, key, value, path, changes),
        (Kind::Tables(keys), Value::Array(_)) => {
            ui.label(title_of(key.name)).on_hover_text(hint);
            ui.indent(path, |ui| tables(ui, drafts, (key, keys), value, path, changes));
            return;
        }
        (Kind::Steps, Value::Array(steps)) => {
            ui.label(title_of(key.name)).on_hover_text(hint);
            for (i, step) in steps.iter().enumerate() {
                if let Some(inner) = step.as_table() {
                    ui.indent((path, i), |ui| {
                        kind_of_several(ui, drafts, STEPS, inner, &format!("{path}.{i}"), changes);
                    });
                }
            }
            ui.menu_button("Add step", |ui| {
                for table in STEPS {
                    if ui.button(table.name).on_hover_text(table.doc).clicked() {
                        ui.close();
                        let to = To::Value(of_other_kind(table, &TomlTable::new()));
                        changes.push(Change { path: format!("{path}.{}", steps.len()), to, is_held: false });
                    }
                }
            });
            return;
        }
        _ => {}
    }
    ui.horizontal(|ui| {
        let label = ui.label(title_of(key.name)).on_hover_text(&hint);
        widget(ui, drafts, Takes::of(&key.kind), value, path, (key.unit, ""), label.id, changes);
        if removable && ui.small_button("×").on_hover_text(format!("Take it away: {}", key.default)).clicked() {
            changes.push(Change { path: path.to_owned(), to: To::Nothing, is_held: false });
        }
    });
    wrong(ui, drafts, path);
}

fn wrong(ui: &mut Ui, drafts: &Drafts, path: &str) {
    if let Some(problem) = drafts.wrong.get(path) {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
}

/// The table of a kind.
fn of_kind(tables: &'static [Table], kind: &str) -> Option<&'static Table> {
    tables.iter().find(|table| table.name == kind)
}

fn title_of(name: &str) -> String {
    match name {
        "poi" => return "Point of interest".to_owned(),
        "fov_deg" => return "Field of view".to_owned(),
        _ => {}
    }
    // The widget shows degrees.
    let mut text = name.trim_end_matches("_deg").replace('_', " ");
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

/// What a widget is made for.
enum Takes<'a> {
    Number {
        min: f64,
        max: f64,
        is_whole: bool,
    },
    Numbers,
    Boolean,
    Words(Vec<&'a str>),
    Color,
    Text,
    /// Anything, as TOML.
    Toml,
}

impl<'a> Takes<'a> {
    fn of(kind: &'a Kind) -> Self {
        match kind {
            Kind::Integer { min, max } => Self::Number { min: *min as f64, max: *max as f64, is_whole: true },
            Kind::Number { min, max } => Self::Number { min: *min, max: *max, is_whole: false },
            Kind::Boolean => Self::Boolean,
            Kind::Word { now, .. } => Self::Words(now.to_vec()),
            Kind::WordOrTable(words, _) => Self::Words(words.to_vec()),
            Kind::Color => Self::Color,
            Kind::Text | Kind::Lod | Kind::Names => Self::Text,
            Kind::Rendering => Self::Words(ROWS.iter().map(|row| row.word).collect()),
            Kind::Point
            | Kind::Lengths
            | Kind::Direction
            | Kind::Angles
            | Kind::PlanPoint
            | Kind::PlanLengths
            | Kind::PicturePlace
            | Kind::Size => Self::Numbers,
            _ => Self::Toml,
        }
    }

    fn of_parameter(kind: &'a ParameterKind) -> Self {
        match kind {
            ParameterKind::Boolean => Self::Boolean,
            ParameterKind::Number { min, max } => Self::Number { min: *min, max: *max, is_whole: false },
            ParameterKind::Text => Self::Text,
            ParameterKind::Word(words) => Self::Words(words.iter().map(String::as_str).collect()),
            ParameterKind::Color => Self::Color,
            _ => Self::Toml,
        }
    }
}

#[allow(clippy::too_many_arguments, reason = "one value with its place, its unit and its name")]
fn widget(
    ui: &mut Ui,
    drafts: &mut Drafts,
    takes: Takes,
    value: &Value,
    path: &str,
    (unit, hint): (&str, &str),
    label: egui::Id,
    changes: &mut Vec<Change>,
) {
    let mut push = |value: Value, is_held: bool| {
        changes.push(Change { path: path.to_owned(), to: To::Value(value), is_held });
    };
    match (takes, value) {
        (Takes::Number { min, max, is_whole }, Value::Integer(_) | Value::Float(_)) => {
            let mut number = number_of(value);
            let speed = if is_whole { 0.2 } else { (number.abs() * 0.01).clamp(0.005, 10.0) };
            let mut drag = DragValue::new(&mut number).speed(speed).custom_formatter(|number, _| trimmed(number, 3));
            // Counts say what they count by their name.
            if !unit.is_empty() && unit.len() <= 2 || unit == "degrees" || unit == "pixels" {
                let unit = if unit == "degrees" { "°" } else { unit };
                drag = drag.suffix(format!(" {unit}"));
            }
            let response = ui.add(drag).labelled_by(label);
            // Dragged it stops at its ends; what is typed beyond them is refused, and says so.
            if response.dragged() {
                number = number.clamp(min, max);
            }
            if response.changed() {
                push(number_value(number, is_whole), response.dragged());
            }
        }
        (Takes::Numbers, Value::Array(list)) if list.iter().all(|n| n.is_integer() || n.is_float()) => {
            let is_whole = list.iter().all(Value::is_integer) && unit == "pixels";
            let mut numbers: Vec<f64> = list.iter().map(number_of).collect();
            let mut held = None;
            for number in &mut numbers {
                let response = ui
                    .add(
                        DragValue::new(number)
                            .speed(if is_whole { 1.0 } else { 0.1 })
                            .custom_formatter(|number, _| trimmed(number, 2)),
                    )
                    .labelled_by(label);
                if response.changed() {
                    held = Some(response.dragged());
                }
            }
            if let Some(is_held) = held {
                push(Value::Array(numbers.iter().map(|n| number_value(*n, is_whole)).collect()), is_held);
            }
        }
        (Takes::Boolean, Value::Boolean(is)) => {
            let mut is = *is;
            if ui.add(egui::Checkbox::without_text(&mut is)).labelled_by(label).changed() {
                push(Value::Boolean(is), false);
            }
        }
        (Takes::Words(words), Value::String(now)) => {
            let shown = egui::ComboBox::from_id_salt(path).selected_text(now).show_ui(ui, |ui| {
                for word in words {
                    if ui.selectable_label(word == now, word).clicked() {
                        push(Value::String(word.to_owned()), false);
                    }
                }
            });
            shown.response.labelled_by(label);
        }
        (Takes::Color, Value::String(now)) => {
            let mut rgb = hex(now).unwrap_or([0; 3]);
            let response = ui.color_edit_button_srgb(&mut rgb).labelled_by(label);
            if response.changed() {
                let [r, g, b] = rgb;
                push(Value::String(format!("#{r:02x}{g:02x}{b:02x}")), true);
            }
        }
        (takes, _) => {
            let takes_text = matches!(takes, Takes::Text);
            changes.extend(typed(ui, drafts, takes_text, value, path, hint, label));
        }
    }
}

/// A field for text, of its own or as TOML, and what becomes of the value when it is done.
fn typed(
    ui: &mut Ui,
    drafts: &mut Drafts,
    takes_text: bool,
    value: &Value,
    path: &str,
    hint: &str,
    label: egui::Id,
) -> Option<Change> {
    let is_text = takes_text && value.is_str();
    let is_absent = value.as_str() == Some("");
    let now = match value.as_str().filter(|_| is_text || is_absent) {
        Some(text) => text.to_owned(),
        None => value.to_string(),
    };
    let mut text = drafts.texts.get(path).cloned().unwrap_or_else(|| now.clone());
    // What takes it away stands behind it, and no panel gets wider for either.
    let width = (ui.available_width() - TAKE_AWAY_WIDTH).clamp(40.0, 150.0);
    let field = egui::TextEdit::singleline(&mut text).desired_width(width).hint_text(hint);
    let response = ui.add(field).labelled_by(label);
    if response.changed() {
        drafts.texts.insert(path.to_owned(), text.clone());
    }
    if response.lost_focus() && text != now {
        let to = match text.trim().is_empty() {
            true => To::Nothing,
            false if is_text => To::Value(Value::String(text)),
            false => To::Typed(text),
        };
        return Some(Change { path: path.to_owned(), to, is_held: false });
    }
    None
}

/// A number as people write it: no more digits than it has.
fn trimmed(number: f64, most: usize) -> String {
    let text = format!("{number:.most$}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

fn number_of(value: &Value) -> f64 {
    value.as_float().or(value.as_integer().map(|n| n as f64)).unwrap_or(0.0)
}

fn number_value(number: f64, is_whole: bool) -> Value {
    if is_whole { Value::Integer(number.round() as i64) } else { Value::Float((number * 1e6).round() / 1e6) }
}

fn hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let channel = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
    Some([channel(0)?, channel(2)?, channel(4)?])
}

/// Effects in order, with their parameters, and a menu of all that there are.
fn effects(ui: &mut Ui, drafts: &mut Drafts, key: &Key, value: &Value, path: &str, changes: &mut Vec<Change>) {
    let list = value.as_array().cloned().unwrap_or_default();
    let title = ui.label(title_of(key.name)).on_hover_text(key.doc).id;
    let named = |used: &Value| -> (String, TomlTable) {
        match used {
            Value::String(name) => (name.clone(), TomlTable::new()),
            used => {
                let table = used.as_table().cloned().unwrap_or_default();
                (table.get("effect").and_then(Value::as_str).unwrap_or("").to_owned(), table)
            }
        }
    };
    for (i, used) in list.iter().enumerate() {
        let (name, table) = named(used);
        ui.indent((path, i), |ui| {
            ui.horizontal(|ui| {
                let shown = egui::ComboBox::from_id_salt((path, i, "effect")).selected_text(&name).height(360.0);
                let shown = shown.show_ui(ui, |ui| {
                    for definition in effect::effects() {
                        let label = ui
                            .selectable_label(definition.name == name, &definition.name)
                            .on_hover_text(&definition.doc);
                        if label.clicked() && definition.name != name {
                            changes.push(Change {
                                path: format!("{path}.{i}"),
                                to: To::Value(new_effect(definition)),
                                is_held: false,
                            });
                        }
                    }
                });
                shown.response.labelled_by(title);
                if ui.small_button("×").on_hover_text("Take this effect away").clicked() {
                    let kept = list.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, own)| own.clone());
                    let to = To::Value(Value::Array(kept.collect()));
                    changes.push(Change { path: path.to_owned(), to, is_held: false });
                }
            });
            let Some(definition) = effect::find(&name) else { return };
            for parameter in &definition.parameters {
                let given = table.get(&parameter.name).cloned();
                let value = given.or_else(|| match &parameter.fallback {
                    Fallback::Value(_) => value_of(&parameter.default_text()),
                    _ => None,
                });
                let place = format!("{path}.{i}.{}", parameter.name);
                ui.horizontal(|ui| {
                    let label = ui.label(title_of(&parameter.name)).on_hover_text(&parameter.doc);
                    let value = value.unwrap_or_else(|| Value::String(String::new()));
                    let mut own = Vec::new();
                    let without = parameter.default_text();
                    let takes = Takes::of_parameter(&parameter.kind);
                    widget(ui, drafts, takes, &value, &place, (&parameter.unit, &without), label.id, &mut own);
                    // An effect that was only a name becomes a table.
                    for change in own {
                        let mut table = table.clone();
                        table.insert("effect".to_owned(), Value::String(name.clone()));
                        let value = match change.to {
                            To::Value(value) => Some(value),
                            To::Typed(text) => {
                                let Some(value) = value_of(&text) else {
                                    drafts.wrong.insert(place.clone(), format!("{text} is not a value"));
                                    continue;
                                };
                                Some(value)
                            }
                            To::Nothing => None,
                        };
                        match value {
                            Some(value) => table.insert(parameter.name.clone(), value),
                            None => table.remove(&parameter.name),
                        };
                        let to = To::Value(Value::Table(table));
                        changes.push(Change { path: format!("{path}.{i}"), to, is_held: change.is_held });
                    }
                });
                wrong(ui, drafts, &place);
            }
            wrong(ui, drafts, &format!("{path}.{i}"));
        });
    }
    ui.horizontal(|ui| {
        ui.menu_button("Add effect", |ui| {
            egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for definition in effect::effects() {
                    if ui.button(&definition.name).on_hover_text(&definition.doc).clicked() {
                        ui.close();
                        changes.push(Change {
                            path: format!("{path}.{}", list.len()),
                            to: To::Value(new_effect(definition)),
                            is_held: false,
                        });
                    }
                }
            });
        });
    });
    wrong(ui, drafts, path);
}

fn new_effect(definition: &effect::EffectDefinition) -> Value {
    Value::String(definition.name.clone())
}

/// A value, of its TOML.
fn value_of(text: &str) -> Option<Value> {
    format!("v = {text}")
        .parse::<TomlTable>()
        .ok()
        .filter(|table| table.len() == 1)
        .and_then(|mut table| table.remove("v"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        for (number, text) in
            [(3.0, "3"), (0.42, "0.42"), (1.2345, "1.234"), (-0.0001, "0"), (1200.0, "1200"), (-7.5, "-7.5")]
        {
            assert_eq!(trimmed(number, 3), text);
        }
    }

    #[test]
    fn another_kind_of_shape_keeps_what_both_have() {
        let sphere: TomlTable = "kind = \"sphere\"\ncenter = [1, 2, 3]\nradius = 9.5".parse().unwrap();
        for table in SHAPES {
            let made = of_other_kind(table, &sphere);
            assert_eq!(made["kind"].as_str(), Some(table.name));
            if table.keys.iter().any(|key| key.name == "center") {
                assert_eq!(made["center"], sphere["center"], "{}", table.name);
            }
            let number = |key: &str| made.get(key).map(number_of);
            match table.name {
                "cylinder" => assert_eq!([number("radius"), number("height")], [Some(9.5), Some(19.0)]),
                "box" => assert_eq!(made["size"].to_string(), "[19.0, 19.0, 19.0]"),
                "ellipsoid" => assert_eq!(made["radii"].to_string(), "[9.5, 9.5, 9.5]"),
                _ => {}
            }
            // What must be given is there.
            for key in table.keys.iter().filter(|key| key.default.is_empty()) {
                assert!(made.get(key.name).is_some(), "{}: {}", table.name, key.name);
            }
        }
        let crate_like: TomlTable = "kind = \"box\"\ncenter = [1, 2, 3]\nsize = [8, 6, 20]".parse().unwrap();
        let of = |kind: &str| of_other_kind(of_kind(SHAPES, kind).unwrap(), &crate_like);
        assert_eq!(of("ellipsoid")["radii"].to_string(), "[4.0, 3.0, 10.0]");
        assert_eq!(number_of(&of("sphere")["radius"]), 4.0);
        assert!(of("flat").get("size").is_none(), "a rectangle has two sides");
    }
}
