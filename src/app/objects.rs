//! City objects: which are there, what is known of the chosen one, and colours by what is known.

use eframe::egui::{self, Key, RichText, Ui};

use crate::{
    app::{document::Document, finder::text_of, new_lens::quoted, state::Window},
    city::{Attribute, CityModel},
    lens::{Lens, Region, chosen::Choice, measures::MEASURES},
    scene::PiecePlace,
};

/// Lenses that hide: the names are the window's own.
const HIDDEN: &str = "hidden objects";
const ISOLATED: &str = "all but these";
const HIDDEN_TYPES: &str = "hidden types";

/// All of them.
const HIDING: &[&str] = &[HIDDEN, ISOLATED, HIDDEN_TYPES];

/// The panel.
pub fn show(window: &mut Window, ui: &mut Ui) {
    let Some(city) = window.city.clone() else { return };
    let model = &*city.model;
    ui.heading("Objects");
    let label = ui.label("Find by id, type or attribute").id;
    let field = ui.add(
        egui::TextEdit::singleline(&mut window.finder.text)
            .hint_text("id, word, name=value, name>5")
            .desired_width(f32::INFINITY),
    );
    let field = field.labelled_by(label);
    if std::mem::take(&mut window.finder.wants_focus) {
        field.request_focus();
    }
    let goes = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    let found = window.finder.find(model, &city.attributes);
    if goes && found.objects.is_empty() {
        // A person types on: letters are no commands then.
        field.request_focus();
    }
    if found.count > 0 {
        let shown = found.objects.len();
        let more = if found.count > shown { format!("; the first {shown}") } else { String::new() };
        ui.weak(format!("{} found{more}", found.count));
    } else if !found.why_none.is_empty() {
        ui.weak(&found.why_none);
    }
    let mut go_to = goes.then(|| found.objects.first().map(|(object, _)| *object)).flatten();
    if !found.objects.is_empty() {
        egui::ScrollArea::vertical().id_salt("found").max_height(180.0).auto_shrink([false, true]).show(ui, |ui| {
            for (object, value) in found.objects {
                let own = &model.objects[object as usize];
                // The value first: ids are long, and are cut.
                let text = match value {
                    Some(value) => format!("{value}  {}", own.id),
                    None => format!("{}  {}", own.id, model.strings.get(own.kind)),
                };
                let response = ui.add(egui::Button::selectable(window.chosen.object == Some(object), text).truncate());
                if response.clicked() {
                    go_to = Some(object);
                }
            }
        });
    }
    if let Some(object) = go_to {
        window.chosen.object = Some(object);
        let bounds = model.bounds_at(object, window.document.scene().shown_moment());
        window.frame_box(&bounds);
    }
    ui.separator();
    match window.chosen.object {
        Some(object) if (object as usize) < model.objects.len() => about(window, ui, model, object),
        _ => {
            ui.weak("Click on an object to see what is known of it.");
        }
    }
    if window.document.scene().lenses.iter().any(|lens| HIDING.contains(&&*lens.name)) {
        ui.horizontal(|ui| {
            ui.label("Some objects are hidden.");
            if ui.button("Show all").clicked() {
                show_all(window);
            }
        });
    }
    ui.separator();
    colors(window, ui, &city.attributes);
    level(window, ui, &city.levels);
    types(window, ui, &city.types);
}

/// Which types of objects are shown.
fn types(window: &mut Window, ui: &mut Ui, all: &[(String, usize)]) {
    if all.len() < 2 {
        return;
    }
    let lenses = &window.document.scene().lenses;
    let hidden = lenses.iter().find(|lens| lens.name == HIDDEN_TYPES).map(|lens| choice_of(lens).types);
    let mut hidden = hidden.unwrap_or_default();
    let mut is_changed = false;
    egui::CollapsingHeader::new("Types").show(ui, |ui| {
        for (name, count) in all {
            let mut is_shown = !hidden.contains(name);
            if ui.checkbox(&mut is_shown, format!("{name} ({count})")).changed() {
                hidden.retain(|own| own != name);
                if !is_shown {
                    hidden.push(name.clone());
                }
                is_changed = true;
            }
        }
    });
    if is_changed {
        let list: Vec<String> = hidden.iter().map(|name| quoted(name)).collect();
        match list.is_empty() {
            true => {
                window.document.edit("show all types", |scene| scene.lenses.retain(|lens| lens.name != HIDDEN_TYPES))
            }
            false => set_hiding(window, HIDDEN_TYPES, &format!("types = [{}]", list.join(", "))),
        }
    }
}

fn about(window: &mut Window, ui: &mut Ui, model: &CityModel, object: u32) {
    let own = &model.objects[object as usize];
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(&*own.id).strong()).truncate().selectable(true));
    });
    ui.weak(model.strings.get(own.kind));
    if let Some(&parent) = own.parents.first() {
        let name = model.objects[parent as usize].id.to_string();
        if ui.link(format!("part of {name}")).clicked() {
            window.chosen.object = Some(parent);
        }
    }
    ui.horizontal_wrapped(|ui| {
        if ui.button("Go there").clicked() {
            let bounds = model.bounds_at(object, window.document.scene().shown_moment());
            window.frame_box(&bounds);
        }
        if ui.button("Hide").clicked() {
            hide(window);
        }
        if ui.button("Isolate").clicked() {
            isolate(window);
        }
    });
    let bounds = model.family_bounds(object);
    if !bounds.is_empty() {
        let size = bounds.size();
        ui.label(format!("{:.1} × {:.1} m, {:.1} m high", size.x, size.y, size.z));
    }
    // What it is part of lends it what it has not of its own.
    let family: Vec<u32> =
        std::iter::successors(Some(object), |at| model.objects[*at as usize].parents.first().copied()).collect();
    let mut known = Vec::new();
    for at in family {
        let of_it = model.attributes_of(at).iter().filter(|own| !known.contains(&own.name));
        let rows: Vec<Attribute> = of_it.copied().collect();
        known.extend(rows.iter().map(|own| own.name));
        if rows.is_empty() {
            continue;
        }
        if at != object {
            ui.weak(format!("As part of {}:", model.objects[at as usize].id));
        }
        attributes(ui, model, &rows, at);
    }
    if known.is_empty() {
        ui.weak("It has no attributes.");
    }
}

/// Attributes and their values.
fn attributes(ui: &mut Ui, model: &CityModel, all: &[Attribute], object: u32) {
    let rows: Vec<(&str, String)> =
        all.iter().map(|own| (model.strings.get(own.name), text_of(own.value, model))).collect();
    // Names get what values leave of the panel, and at least half of it.
    let width = ui.available_width() - ui.spacing().item_spacing.x;
    let widest = rows.iter().map(|(_, value)| width_of(ui, value)).fold(0.0, f32::max);
    let of_names = width - widest.min(0.5 * width);
    egui::Grid::new(("attributes", object)).num_columns(2).striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.scope(|ui| {
                ui.set_width(of_names);
                ui.add(egui::Label::new(RichText::new(name).weak()).truncate()).on_hover_text(name);
            });
            ui.scope(|ui| {
                ui.set_max_width(width - of_names);
                ui.add(egui::Label::new(value).selectable(true).wrap());
            });
            ui.end_row();
        }
    });
}

/// The width of a text in one line, points.
fn width_of(ui: &Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::WHITE).size().x.ceil() + 1.0
}

/// Colours by an attribute or a measure, as an effect on the context.
fn colors(window: &mut Window, ui: &mut Ui, names: &[String]) {
    let label = ui.heading("Colour by").id;
    let effect = window.document.scene().style.effects.iter().find(|used| used.effect == "thematic");
    let now = effect.and_then(|used| used.text("attribute")).map(str::to_owned);
    let mut wanted = None;
    egui::ComboBox::from_id_salt("colour by")
        .width(ui.available_width())
        .selected_text(now.as_deref().unwrap_or("nothing"))
        .show_ui(ui, |ui| {
            if ui.selectable_label(now.is_none(), "nothing").clicked() {
                wanted = Some(None);
            }
            let measures = MEASURES.iter().map(|measure| measure.name);
            for name in names.iter().map(String::as_str).chain(measures) {
                if ui.selectable_label(now.as_deref() == Some(name), name).clicked() {
                    wanted = Some(Some(name.to_owned()));
                }
            }
        })
        .response
        .labelled_by(label);
    let done = match wanted {
        None => return,
        Some(None) => {
            window
                .document
                .edit("colour by nothing", |scene| scene.style.effects.retain(|used| used.effect != "thematic"));
            Ok(())
        }
        Some(Some(name)) => {
            let effect = format!("{{ effect = \"thematic\", attribute = {} }}", quoted(&name));
            let effects = &window.document.scene().style.effects;
            // In the place of the one before, or as the first: what comes after acts on its colours.
            let at = effects.iter().position(|used| used.effect == "thematic");
            let mut draft = Document::new(window.document.scene().clone(), window.document.file().map(Into::into));
            let is_alone = effects.is_empty();
            let done = match at {
                Some(at) => draft.set(&format!("style.effects.{at}={effect}")),
                None if is_alone => draft.set(&format!("style.effects=[{effect}]")),
                None => draft.set(&format!("style.effects.{}={effect}", effects.len())),
            };
            done.map(|()| {
                let mut after = draft.scene().clone();
                if after.figure.legend == PiecePlace::None {
                    after.figure.legend = PiecePlace::Auto;
                }
                window.document.edit(format!("colour by {name}"), |scene| *scene = after);
            })
        }
    };
    if let Err(error) = done {
        window.fail(error);
    }
}

/// Which levels of detail are shown, where there are several.
fn level(window: &mut Window, ui: &mut Ui, all: &[String]) {
    if all.len() < 2 {
        return;
    }
    let now = window.document.scene().city.lod.clone();
    let mut wanted = None;
    ui.horizontal(|ui| {
        let label = ui.label("Level of detail up to").id;
        let text = now.as_deref().unwrap_or("the finest");
        let shown = egui::ComboBox::from_id_salt("level of detail").selected_text(text).show_ui(ui, |ui| {
            if ui.selectable_label(now.is_none(), "the finest").clicked() {
                wanted = Some(None);
            }
            for lod in all {
                if ui.selectable_label(now.as_ref() == Some(lod), lod).clicked() {
                    wanted = Some(Some(lod.clone()));
                }
            }
        });
        shown.response.labelled_by(label);
    });
    if let Some(lod) = wanted {
        window.document.edit("level of detail", |scene| scene.city.lod = lod);
    }
}

/// The root of the chosen object, by id.
fn chosen_id(window: &Window) -> Option<String> {
    let (city, object) = (window.city.as_ref()?, window.chosen.object?);
    let root = city.roots.get(object as usize).copied()?;
    Some(city.model.objects[root as usize].id.to_string())
}

/// Does not show the chosen object.
pub fn hide(window: &mut Window) {
    let Some(id) = chosen_id(window) else { return };
    let lenses = &window.document.scene().lenses;
    let at = lenses.iter().position(|lens| lens.name == HIDDEN);
    let ids = at.map(|at| choice_of(&lenses[at]).ids).unwrap_or_default();
    let mut ids: Vec<String> = ids.into_iter().filter(|own| *own != id).collect();
    ids.push(id);
    set_hiding(window, HIDDEN, &of_ids(&ids));
    window.chosen.object = None;
}

/// Shows the chosen object alone, and what it stands on.
pub fn isolate(window: &mut Window) {
    let Some(id) = chosen_id(window) else { return };
    let ground = window.city.as_ref().map(|city| {
        let all = city.model.objects.iter().filter(|object| object.class.is_ground());
        all.map(|object| object.id.to_string()).collect::<Vec<_>>()
    });
    let ids: Vec<String> = std::iter::once(id).chain(ground.unwrap_or_default()).collect();
    set_hiding(window, ISOLATED, &format!("{}, except = true", of_ids(&ids)));
}

/// Shows what was hidden.
pub fn show_all(window: &mut Window) {
    window.document.edit("show all", |scene| scene.lenses.retain(|lens| !HIDING.contains(&&*lens.name)));
}

fn choice_of(lens: &Lens) -> Choice {
    match &lens.shapes[..] {
        [Region::Thematic(choice)] => choice.clone(),
        _ => Choice::default(),
    }
}

fn of_ids(ids: &[String]) -> String {
    let all: Vec<String> = ids.iter().map(|id| quoted(id)).collect();
    format!("ids = [{}]", all.join(", "))
}

/// A lens that hides what is chosen so; on the terrain, too.
fn set_hiding(window: &mut Window, name: &str, choice: &str) {
    let lenses = &window.document.scene().lenses;
    let at = lenses.iter().position(|lens| lens.name == name).unwrap_or(lenses.len());
    let lens = format!(
        "lens.{at}={{ name = {}, kind = \"color\", body = \"none\", effects = [{{ effect = \"eraser\", keep_terrain = false }}], shape = {{ kind = \"thematic\", {choice} }} }}",
        quoted(name)
    );
    if let Err(error) = window.document.set(&lens) {
        window.fail(error);
    }
}
