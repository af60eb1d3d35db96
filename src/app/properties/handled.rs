//! Lists of handlers, each with its parameters as its header has them: effects, and steps of time. Those of users need nothing more.

use eframe::egui::{self, Id, Stroke, Ui, vec2};
use toml::{Table as TomlTable, Value};

use crate::{
    app::properties::{
        edits::{Change, Edits, To},
        values::{parameter_of, title_of, value_of},
        widget::{Setting, Takes, typed_value, widget, wrong},
    },
    figure::scene_file::keys::Key,
    lens::{
        Handled, Operator, Parameter,
        effect::problem_with,
        epoch::linked,
        links::{link_to, linkable, names_lens},
    },
    scene::Scene,
    shader::effect::{self, AskedBy, EffectDefinition, Fallback, ParameterDefinition, ParameterKind, asked_for},
    time::{Moment, Span},
};

/// A kind of list.
pub struct Listed {
    /// The key that names the handler in a table.
    named_by: &'static str,
    /// What one of the list is called.
    one: &'static str,
    /// Whether one without parameters is written as its name.
    has_words: bool,
    /// The handlers that there are.
    all: fn() -> Vec<&'static EffectDefinition>,
    /// What is wrong with one, beyond what each of its parameters takes.
    problem: fn(&Handled, &Scene) -> Option<String>,
}

/// Effects.
pub const EFFECTS: Listed = Listed {
    named_by: "effect",
    one: "effect",
    has_words: true,
    all: || effect::effects().collect(),
    problem: |_, _| None,
};

/// Time operators.
pub const OPERATORS: Listed = Listed {
    named_by: "op",
    one: "time step",
    has_words: false,
    all: || asked_for(AskedBy::Times).collect(),
    problem: |step, scene| {
        let alone = Operator::new(step, scene.time_s).err();
        alone.or_else(|| linked(std::slice::from_ref(step), &scene.lenses).err())
    },
};

/// One of a list, as it is given.
struct Given<'a> {
    list: &'a Listed,
    /// The path of the list, and its place in it.
    of: &'a str,
    index: usize,
    name: String,
    table: TomlTable,
}

impl Given<'_> {
    fn path(&self) -> String {
        format!("{}.{}", self.of, self.index)
    }
}

/// The names of the lenses that a step of a list may be linked to.
fn lenses<'a>(scene: &'a Scene, list: &str) -> Vec<&'a str> {
    let from = list.strip_prefix("lens.").and_then(|rest| rest.split('.').next()?.parse().ok());
    linkable(&scene.lenses, from)
}

/// A list in order, with what each takes; each can be made another one, moved and taken away, and more can be added.
pub fn list(ui: &mut Ui, edits: &mut Edits, list: &Listed, key: &Key, value: &Value, path: &str) {
    let all = value.as_array().cloned().unwrap_or_default();
    let title = ui.label(title_of(key.name)).on_hover_text(key.doc).id;
    for (index, used) in all.iter().enumerate() {
        let table = used.as_table().cloned().unwrap_or_default();
        let name = used.as_str().or_else(|| table.get(list.named_by).and_then(Value::as_str)).unwrap_or("").to_owned();
        let given = Given { list, of: path, index, name, table };
        ui.indent((path, index), |ui| {
            ui.horizontal(|ui| {
                kinds(ui, edits, &given, title);
                order(ui, edits, &given, &all);
            });
            let definition = (list.all)().into_iter().find(|definition| definition.name == given.name);
            for parameter in definition.into_iter().flat_map(|definition| &definition.parameters) {
                parameter_row(ui, edits, &given, parameter);
            }
            wrong(ui, edits.drafts, &given.path());
            // What is there is right but for what other lenses are now.
            let whole = handled(&given, &given.table).and_then(|step| (list.problem)(&step, edits.scene));
            if let Some(problem) = whole {
                ui.colored_label(ui.visuals().error_fg_color, problem);
            }
        });
    }
    ui.horizontal(|ui| {
        let added = |ui: &mut Ui, edits: &mut Edits| {
            for definition in (list.all)() {
                let fresh = fresh(edits.scene, list, path, definition, &TomlTable::new());
                let button = ui.add_enabled(fresh.is_some(), egui::Button::new(&definition.name));
                if let (true, Some(fresh)) = (button.on_hover_text(&definition.doc).clicked(), fresh) {
                    ui.close();
                    let value = Value::Array(all.iter().cloned().chain([fresh]).collect());
                    edits.push(path.to_owned(), To::Value(value));
                }
            }
        };
        ui.menu_button(format!("Add {}", list.one), |ui| {
            egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| added(ui, edits));
        });
        if list.named_by == OPERATORS.named_by {
            link_menu(ui, edits, path);
        }
    });
    wrong(ui, edits.drafts, path);
}

/// The lenses that a list may be linked to: a link to one comes in the place of all steps.
fn link_menu(ui: &mut Ui, edits: &mut Edits, path: &str) {
    let scene = edits.scene;
    let others = lenses(scene, path);
    let menu = ui.add_enabled_ui(!others.is_empty(), |ui| {
        ui.menu_button("Link to…", |ui| {
            for name in others {
                if ui.button(name).clicked() {
                    ui.close();
                    forget(edits, path);
                    edits.push(path.to_owned(), To::Value(Value::Array(vec![table_of(&link_to(name, "0 s"))])));
                }
            }
        })
    });
    menu.inner.response.on_hover_text(
        "Shows what another lens shows, or so much later: a link in the place of all steps, with a delay to be typed",
    );
}

/// A use as a table.
fn table_of(step: &Handled) -> Value {
    let text = |value: &Parameter| match value {
        Parameter::Text(text) => Some(Value::String(text.clone())),
        _ => None,
    };
    let parameters = step.parameters.iter().filter_map(|(key, value)| Some((key.clone(), text(value)?)));
    let name = (OPERATORS.named_by.to_owned(), Value::String(step.handler.clone()));
    Value::Table(std::iter::once(name).chain(parameters).collect())
}

/// The handlers that it can be made.
fn kinds(ui: &mut Ui, edits: &mut Edits, given: &Given, title: Id) {
    let path = given.path();
    let shown = egui::ComboBox::from_id_salt((&path, given.list.named_by)).selected_text(&given.name).height(360.0);
    let shown = shown.show_ui(ui, |ui| {
        for definition in (given.list.all)() {
            let Some(other) = fresh(edits.scene, given.list, given.of, definition, &given.table) else { continue };
            let label =
                ui.selectable_label(definition.name == given.name, &definition.name).on_hover_text(&definition.doc);
            if label.clicked() && definition.name != given.name {
                forget(edits, &path);
                edits.push(path.clone(), To::Value(other));
            }
        }
    });
    shown.response.labelled_by(title);
}

/// What moves it up and down and takes it away.
fn order(ui: &mut Ui, edits: &mut Edits, given: &Given, all: &[Value]) {
    let Given { list, of, index, .. } = *given;
    let number = index + 1;
    let moved = |to: usize| {
        let mut all = all.to_vec();
        all.swap(index, to);
        To::Value(Value::Array(all))
    };
    let mut button = |sign: Sign, does: &str, name: String, to: Option<To>| {
        let response = ui.add_enabled(to.is_some(), egui::Button::new("").small().min_size(vec2(18.0, 0.0)));
        sign.paint(ui, &response);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, to.is_some(), &name));
        if let (true, Some(to)) = (response.on_hover_text(does).clicked(), to) {
            forget(edits, of);
            edits.push(of.to_owned(), to);
        }
    };
    if all.len() > 1 {
        let up = index.checked_sub(1).map(moved);
        let down = (number < all.len()).then(|| moved(number));
        button(Sign::Up, "It acts before the one above", format!("Move {} {number} up", list.one), up);
        button(Sign::Down, "It acts after the one below", format!("Move {} {number} down", list.one), down);
    }
    let kept: Vec<Value> = all.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, own)| own.clone()).collect();
    // No list is what is said of none.
    let to = if kept.is_empty() { To::Nothing } else { To::Value(Value::Array(kept)) };
    button(Sign::Away, &format!("Take this {} away", list.one), format!("Take {} {number} away", list.one), Some(to));
}

/// What is on a button: drawn, for fonts lack it.
#[derive(Clone, Copy)]
enum Sign {
    Up,
    Down,
    Away,
}

impl Sign {
    fn paint(self, ui: &Ui, button: &egui::Response) {
        let color =
            ui.style().interact(button).fg_stroke.color.gamma_multiply(if button.enabled() { 1.0 } else { 0.4 });
        let at = |x: f32, y: f32| button.rect.center() + vec2(x, y);
        let painter = ui.painter();
        let triangle = |up: f32| {
            let points = vec![at(-4.0, 2.5 * up), at(0.0, -3.5 * up), at(4.0, 2.5 * up)];
            painter.add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
        };
        match self {
            Self::Up => triangle(1.0),
            Self::Down => triangle(-1.0),
            Self::Away => {
                let stroke = Stroke::new(1.2, color);
                painter.line_segment([at(-3.0, -3.0), at(3.0, 3.0)], stroke);
                painter.line_segment([at(-3.0, 3.0), at(3.0, -3.0)], stroke);
            }
        }
    }
}

/// Forgets what is typed in a list: its places are no longer the same.
fn forget(edits: &mut Edits, path: &str) {
    let is_within = |own: &String| own.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    edits.drafts.texts.retain(|own, _| !is_within(own));
    edits.drafts.wrong.retain(|own, _| !is_within(own));
}

/// A parameter: its name, its field, and what is wrong with it, while it is typed too.
fn parameter_row(ui: &mut Ui, edits: &mut Edits, given: &Given, parameter: &ParameterDefinition) {
    let place = format!("{}.{}", given.path(), parameter.name);
    let scene = edits.scene;
    let takes = match names_lens(&given.name, &parameter.name) {
        true => Takes::Words(lenses(scene, given.of)),
        false => Takes::of_parameter(&parameter.kind),
    };
    let live = edits.drafts.texts.get(&place).and_then(|text| live_problem(text, &takes, given, parameter, scene));
    ui.horizontal(|ui| {
        let hint = format!("{}\n{}", parameter.doc, parameter.kind.describe());
        let label = ui.label(title_of(&parameter.name)).on_hover_text(hint);
        let own = given.table.get(&parameter.name).cloned().or_else(|| match &parameter.fallback {
            Fallback::Value(_) => value_of(&parameter.default_text()),
            _ => None,
        });
        let value = own.unwrap_or_else(|| Value::String(String::new()));
        let without = parameter.default_text();
        let setting = Setting { path: &place, unit: &parameter.unit, hint: &without, label: label.id };
        let before = edits.changes.len();
        widget(ui, edits, takes, &value, &setting);
        // What does not fit stays typed. The whole table is given: one that was only a name becomes one.
        for change in edits.changes.split_off(before).into_iter().filter(|_| live.is_none()) {
            let mut table = given.table.clone();
            table.insert(given.list.named_by.to_owned(), Value::String(given.name.clone()));
            let value = match change.to {
                To::Value(value) => Some(value),
                To::Typed(text) => {
                    let Some(value) = value_of(&text) else {
                        edits.drafts.wrong.insert(place.clone(), format!("{text} is not a value"));
                        continue;
                    };
                    Some(value)
                }
                To::Nothing => None,
            };
            edits.drafts.texts.remove(&place);
            edits.drafts.wrong.remove(&place);
            match value {
                Some(value) => table.insert(parameter.name.clone(), value),
                None => table.remove(&parameter.name),
            };
            let to = To::Value(Value::Table(table));
            edits.changes.push(Change { path: given.path(), to, is_held: change.is_held });
        }
    });
    match live {
        Some(problem) => {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        None => wrong(ui, edits.drafts, &place),
    }
}

/// What is wrong with a parameter as it is typed so far.
fn live_problem(
    text: &str,
    takes: &Takes,
    given: &Given,
    parameter: &ParameterDefinition,
    scene: &Scene,
) -> Option<String> {
    if text.trim().is_empty() {
        let is_needed = parameter.is_required().then(|| format!("must be {}", parameter.kind.describe()));
        return is_needed;
    }
    let Some(value) = typed_value(takes, text) else { return Some(format!("must be {}", parameter.kind.describe())) };
    let own = parameter_of(&value)?;
    problem_with(&parameter.kind, &own).or_else(|| {
        let mut table = given.table.clone();
        table.insert(parameter.name.clone(), value);
        (given.list.problem)(&handled(given, &table)?, scene)
    })
}

/// The use of a handler that a table is.
fn handled(given: &Given, table: &TomlTable) -> Option<Handled> {
    let own = table.iter().filter(|(key, _)| *key != given.list.named_by);
    let parameters = own.map(|(key, value)| Some((key.clone(), parameter_of(value)?))).collect::<Option<_>>()?;
    Some(Handled { handler: given.name.clone(), parameters })
}

/// A use of a handler in a list: what was given before stays where it fits, what else is needed is as an example has it. `None`: there is no
/// example of what it needs.
fn fresh(scene: &Scene, list: &Listed, path: &str, definition: &EffectDefinition, before: &TomlTable) -> Option<Value> {
    if list.has_words {
        return Some(Value::String(definition.name.clone()));
    }
    let mut table = TomlTable::new();
    table.insert(list.named_by.to_owned(), Value::String(definition.name.clone()));
    let mut moments = 0;
    for parameter in &definition.parameters {
        let fits =
            |value: &&Value| parameter_of(value).is_some_and(|own| problem_with(&parameter.kind, &own).is_none());
        let is_name = names_lens(&definition.name, &parameter.name);
        let kept = before.get(&parameter.name).filter(fits).filter(|_| !is_name).cloned();
        let example = || match is_name {
            true => lenses(scene, path).first().map(|name| Value::String((*name).to_owned())),
            false => example_of(&parameter.kind, scene, &mut moments),
        };
        let value = kept.map_or_else(|| parameter.is_required().then(example), |kept| Some(Some(kept)));
        if let Some(value) = value {
            table.insert(parameter.name.clone(), value?);
        }
    }
    Some(Value::Table(table))
}

/// A value of a kind, to begin with; moments that follow each other are a hundred years apart.
fn example_of(kind: &ParameterKind, scene: &Scene, moments: &mut i32) -> Option<Value> {
    let text = |text: &str| Some(Value::String(text.to_owned()));
    match kind {
        ParameterKind::Moment => {
            let first = scene.moment.or(Moment::of_year(1900))?;
            let at = first.shifted(Span::of_months(1200 * std::mem::replace(moments, *moments + 1)));
            text(&at.written())
        }
        ParameterKind::Span => text("-10 years"),
        ParameterKind::Unit => text("10 years"),
        ParameterKind::Clock => text("12:00"),
        ParameterKind::Instants => {
            Some(Value::Array(["0 s", "-50 years"].map(|own| Value::String(own.into())).to_vec()))
        }
        ParameterKind::Boolean => Some(Value::Boolean(false)),
        ParameterKind::Number { min, max } => Some(Value::Float(0.0_f64.clamp(*min, *max))),
        ParameterKind::Word(words) => text(words.first()?),
        ParameterKind::Color => text("#808080"),
        ParameterKind::Vector => Some(Value::Array([0.0, 0.0, 1.0].map(Value::Float).to_vec())),
        ParameterKind::Numbers | ParameterKind::Shares | ParameterKind::Weights => {
            Some(Value::Array(vec![Value::Float(1.0)]))
        }
        ParameterKind::Colors => Some(Value::Array(vec![Value::String("#808080".to_owned())])),
        ParameterKind::Text | ParameterKind::Texts => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::{Lens, kind::TimeLens};

    #[test]
    fn every_operator_has_an_example_that_is_right() {
        let mut scene = Scene::default();
        let made = |scene: &Scene, definition: &EffectDefinition, before: &TomlTable| {
            fresh(scene, &OPERATORS, "lens.1.time", definition, before)
        };
        let link = asked_for(AskedBy::Times).find(|own| own.name == "link").expect("it is there");
        assert_eq!(made(&scene, link, &TomlTable::new()), None, "there is nothing to link to");
        scene.lenses = ["then", "now"].map(|name| Lens::plain(name, TimeLens::default(), [0.0; 3])).to_vec();
        for definition in asked_for(AskedBy::Times).filter(|own| !own.is_users) {
            let value = made(&scene, definition, &TomlTable::new()).expect("an example");
            let table = value.as_table().expect("a table").clone();
            let given = Given { list: &OPERATORS, of: "lens.1.time", index: 0, name: definition.name.clone(), table };
            let step = handled(&given, &given.table).expect("a step");
            assert_eq!((OPERATORS.problem)(&step, &scene), None, "{value}");
            // What fits stays.
            let before: TomlTable = "by = \"3 days\"\nto = 4".parse().expect("a table");
            let kept = made(&scene, definition, &before).expect("an example");
            let takes = |name: &str| definition.parameters.iter().any(|own| own.name == name);
            assert_eq!(kept.get("by").and_then(Value::as_str), takes("by").then_some("3 days"));
            assert_eq!(kept.get("to").and_then(Value::as_str), takes("to").then_some("then"));
        }
    }

    #[test]
    fn what_is_typed_is_told_while_it_is() {
        let lenses = vec![Lens::plain("then", TimeLens::default(), [0.0; 3])];
        let scene = Scene { lenses, ..Scene::default() };
        let problem = |op: &str, table: &str, name: &str, text: &str| {
            let definition = asked_for(AskedBy::Times).find(|own| own.name == op).expect(op);
            let parameter = definition.parameters.iter().find(|own| own.name == name).expect(name);
            let table = table.parse().expect("a table");
            let given = Given { list: &OPERATORS, of: "lens.1.time", index: 0, name: op.to_owned(), table };
            live_problem(text, &Takes::of_parameter(&parameter.kind), &given, parameter, &scene).unwrap_or_default()
        };
        assert_eq!(problem("set", "", "at", "1650"), "");
        assert!(problem("set", "", "at", "16x0").contains("is no time"));
        assert!(problem("set", "", "at", " ").starts_with("must be a time"));
        assert_eq!(problem("ghost", "", "past", ""), "", "it has a default");
        assert!(problem("loop", "begin = \"1900\"\nend = \"1950\"", "end", "1850").contains("later than begin"));
        assert_eq!(problem("aggregate", "", "at", "1650, -10 years"), "");
        assert!(problem("aggregate", "", "at", "1650, when").contains("\"when\""));
        assert!(problem("aggregate", "at = [\"1650\"]", "weights", "1, 2").contains("one for each"));
        assert!(problem("aggregate", "at = [\"1650\"]", "weights", "1, x").contains("numbers above 0"));
        assert!(problem("link", "", "to", "than").contains("did you mean \"then\""));
    }
}
