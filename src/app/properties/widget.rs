//! The widget of one value: a number to drag, a list to choose from, a colour, text.

use eframe::egui::{self, DragValue, Ui};
use toml::Value;

use crate::{
    app::properties::{
        edits::{Change, Drafts, Edits, To},
        looks,
        values::{hex, number_of, number_value, trimmed, value_of},
    },
    figure::scene_file::keys::Kind,
    lens::rendering::ROWS,
    shader::effect::ParameterKind,
};

/// The button that takes a value away, with the space before it, points.
const TAKE_AWAY_WIDTH: f32 = 36.0;

/// The kind of value that a widget is made for.
pub enum Takes<'a> {
    /// A number within bounds.
    Number {
        /// The least.
        min: f64,
        /// The largest.
        max: f64,
        /// Whether it is a whole number.
        is_whole: bool,
    },
    /// A list of numbers.
    Numbers,
    /// Yes or no.
    Boolean,
    /// One of some words.
    Words(Vec<&'a str>),
    /// A colour.
    Color,
    /// Text of its own.
    Text,
    /// Texts of their own, with commas between them.
    Texts,
    /// Numbers with commas between them, as many as there may be.
    List,
    /// Anything, as TOML.
    Toml,
}

impl<'a> Takes<'a> {
    /// The widget for a key.
    pub fn of(kind: &'a Kind) -> Self {
        match kind {
            Kind::Integer { min, max } => Self::Number { min: *min as f64, max: *max as f64, is_whole: true },
            Kind::Number { min, max } => Self::Number { min: *min, max: *max, is_whole: false },
            Kind::Boolean => Self::Boolean,
            Kind::Word { now, .. } => Self::Words(now.to_vec()),
            Kind::WordOrTable(words, _) | Kind::WordOrPlace(words) => Self::Words(words.to_vec()),
            Kind::Color => Self::Color,
            Kind::Text | Kind::Lod | Kind::Names | Kind::Moment => Self::Text,
            Kind::Rendering => Self::Words(ROWS.iter().map(|row| row.word).collect()),
            Kind::Point
            | Kind::Lengths
            | Kind::Direction
            | Kind::Angles
            | Kind::PlanPoint
            | Kind::PlanLengths
            | Kind::PicturePlace
            | Kind::PaperSize
            | Kind::Size => Self::Numbers,
            _ => Self::Toml,
        }
    }

    /// The widget for a parameter of an effect.
    pub fn of_parameter(kind: &'a ParameterKind) -> Self {
        match kind {
            ParameterKind::Boolean => Self::Boolean,
            ParameterKind::Number { min, max } => Self::Number { min: *min, max: *max, is_whole: false },
            ParameterKind::Text
            | ParameterKind::Moment
            | ParameterKind::Span
            | ParameterKind::Unit
            | ParameterKind::Clock => Self::Text,
            ParameterKind::Instants => Self::Texts,
            ParameterKind::Weights => Self::List,
            ParameterKind::Word(words) => Self::Words(words.iter().map(String::as_str).collect()),
            ParameterKind::Color => Self::Color,
            ParameterKind::Vector => Self::Numbers,
            _ => Self::Toml,
        }
    }
}

/// The surroundings of a widget.
pub struct Setting<'a> {
    /// The path of its value's key.
    pub path: &'a str,
    /// The unit of its value; empty for none.
    pub unit: &'a str,
    /// The text of an empty field.
    pub hint: &'a str,
    /// Its name.
    pub label: egui::Id,
}

/// The widget of a value.
pub fn widget(ui: &mut Ui, edits: &mut Edits, takes: Takes, value: &Value, setting: &Setting) {
    let Setting { path, unit, label, .. } = *setting;
    let mut push = |value: Value, is_held: bool| {
        edits.changes.push(Change { path: path.to_owned(), to: To::Value(value), is_held });
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
        (Takes::Words(words), Value::String(now)) if looks::are_looks(&words) => {
            if let Some(word) = looks::menu(ui, &words, now, label) {
                push(Value::String(word), false);
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
            edits.changes.extend(typed(ui, edits.drafts, &takes, value, setting));
        }
    }
}

/// The value that a text means in a field for it; `None`: it is none.
pub fn typed_value(takes: &Takes, text: &str) -> Option<Value> {
    let parts = || text.split(',').map(str::trim).filter(|part| !part.is_empty());
    let number = |part: &str| part.parse::<f64>().ok().filter(|n| n.is_finite()).map(Value::Float);
    match takes {
        Takes::Text | Takes::Words(_) => Some(Value::String(text.trim().to_owned())),
        Takes::Texts => Some(Value::Array(parts().map(|part| Value::String(part.to_owned())).collect())),
        Takes::List => parts().map(number).collect::<Option<_>>().map(Value::Array),
        _ => value_of(text),
    }
}

/// The text of a value in a field for it.
fn text_of(takes: &Takes, value: &Value) -> String {
    match (takes, value) {
        (Takes::Text, Value::String(text)) => text.clone(),
        (_, Value::String(text)) if text.is_empty() => String::new(),
        (Takes::Texts, Value::Array(list)) if list.iter().all(Value::is_str) => {
            list.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(", ")
        }
        (Takes::List, Value::Array(list)) => {
            list.iter().map(|own| trimmed(number_of(own), 6)).collect::<Vec<_>>().join(", ")
        }
        _ => value.to_string(),
    }
}

/// A field for text, of its own or as TOML, and what becomes of the value when it is done.
fn typed(ui: &mut Ui, drafts: &mut Drafts, takes: &Takes, value: &Value, setting: &Setting) -> Option<Change> {
    let Setting { path, hint, label, .. } = *setting;
    let now = text_of(takes, value);
    let mut text = drafts.texts.get(path).cloned().unwrap_or_else(|| now.clone());
    // What takes it away stands behind it, and no panel gets wider for either.
    let width = (ui.available_width() - TAKE_AWAY_WIDTH).clamp(40.0, 150.0);
    let field = egui::TextEdit::singleline(&mut text).desired_width(width).hint_text(hint);
    let response = ui.add(field).labelled_by(label);
    if response.changed() {
        drafts.texts.insert(path.to_owned(), text.clone());
    }
    if response.lost_focus() && text == now {
        drafts.texts.remove(path);
    } else if response.lost_focus() {
        let own = match takes {
            Takes::Text if !value.is_str() => None,
            Takes::Text | Takes::Texts | Takes::List => typed_value(takes, &text),
            _ => None,
        };
        let to = match (text.trim().is_empty(), own) {
            (true, _) => To::Nothing,
            (false, Some(value)) => To::Value(value),
            (false, None) => To::Typed(text),
        };
        return Some(Change { path: path.to_owned(), to, is_held: false });
    }
    None
}

/// Shows what was wrong with the text for a key, if anything was.
pub fn wrong(ui: &mut Ui, drafts: &Drafts, path: &str) {
    if let Some(problem) = drafts.wrong.get(path) {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
}
