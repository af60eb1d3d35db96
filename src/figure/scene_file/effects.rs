//! Effects in scene files: names, or tables with parameters; read and written.

use std::collections::BTreeMap;

use crate::{
    city::Lod,
    figure::scene_file::{
        check::{Fields, Place},
        forms::{Worded, parameter, parameter_data},
        keys::{CLASSES, Kind},
        node::{Data, Node},
        reader::Reader,
        row::Given,
    },
    lens::{Class, Content, EffectUse, Parameter, effect, nearest::did_you_mean},
    shader::{
        Blend,
        effect::{EffectKind, PerObject, find as find_effect},
    },
};

/// The content that the effect `lod` of a lens is.
pub struct Shown {
    /// What it shows.
    pub content: Content,
    /// Its line.
    pub line: u32,
}

/// The effects of a lens or of the context that a key lists, and what its effect `lod` shows.
pub fn effects(reader: &mut Reader, fields: &Fields, key: &str, in_lens: bool) -> (Vec<EffectUse>, Option<Shown>) {
    let mut effects = Vec::new();
    let mut content: Option<Shown> = None;
    let mut scene_style: Option<String> = None;
    for (i, node) in fields.node(key).and_then(Node::list).unwrap_or_default().iter().enumerate() {
        let place = fields.place.within(&format!("{key}.{i}"), node.line);
        let Some(used) = effect(reader, node, &place, in_lens) else { continue };
        if used.effect == effect::LOD {
            if content.is_some() {
                reader.checker.note(&place, "", node.line, "is a second \"lod\"; a lens shows one");
            }
            content = Some(Shown { content: lod_effect(reader, &used, node, &place, in_lens), line: node.line });
            continue;
        }
        let is_scene_style = find_effect(&used.effect).is_some_and(|e| e.kind == EffectKind::Scene);
        match &scene_style {
            Some(first) if is_scene_style => {
                let message =
                    format!("\"{}\" is a second scene style beside \"{first}\"; only one is possible", used.effect);
                reader.checker.note(&place, "", node.line, message);
            }
            None if is_scene_style => scene_style = Some(used.effect.clone()),
            _ => {}
        }
        effects.push(used);
    }
    (effects, content)
}

/// What the effect `lod` shows.
fn lod_effect(reader: &mut Reader, used: &EffectUse, node: &Node, place: &Place, in_lens: bool) -> Content {
    let mut note = |key: &str, message: String| reader.checker.note(place, key, node.line, message);
    if !in_lens {
        note("", "has a meaning only in a lens; for the context [city] lod = \"1.2\" would be right".to_owned());
    }
    let lod = match used.parameters.get("lod") {
        Some(Parameter::Text(text)) => Lod::parse(text),
        Some(Parameter::Number(number)) => Lod::parse(&number.to_string()),
        _ => None,
    };
    if lod.is_none() {
        let given = if used.parameters.contains_key("lod") { "must be" } else { "is missing:" };
        note("lod", format!("{given} {}", Kind::Lod.describe()));
    }
    for key in used.parameters.keys().filter(|key| *key != "lod") {
        note(key, format!("\"lod\" has no such parameter{}", did_you_mean(key, ["lod", "class"].into_iter())));
    }
    for (key, _) in [("blend", used.blend.is_some()), ("weight", used.weight.is_some())].iter().filter(|k| k.1) {
        note(key, "\"lod\" shows something else; there is nothing to blend".to_owned());
    }
    Content { lod, class: used.class, ..Content::default() }
}

fn effect(reader: &mut Reader, node: &Node, place: &Place, in_lens: bool) -> Option<EffectUse> {
    let mut used = EffectUse {
        effect: String::new(),
        class: Class::Inside,
        blend: None,
        weight: None,
        parameters: BTreeMap::new(),
    };
    let mut lines: BTreeMap<&str, u32> = BTreeMap::new();
    match &node.data {
        Data::Text(name) => used.effect.clone_from(name),
        Data::Table(entries) => {
            for (key, line, value) in entries {
                lines.insert(key, *line);
                match (key.as_str(), value.text()) {
                    ("effect", Some(name)) => name.clone_into(&mut used.effect),
                    ("class", _) if !in_lens => {
                        reader.checker.note(
                            place,
                            key,
                            *line,
                            "has a meaning only in a lens: the context is everything",
                        );
                    }
                    ("class", Some(word)) if Class::of_word(word).is_some() => {
                        used.class = Class::of_word(word).unwrap_or_default();
                    }
                    ("blend", Some(word)) if Blend::parse(word).is_some() => used.blend = Blend::parse(word),
                    ("weight", _) if matches!(parameter(value), Some(Parameter::Number(_))) => {
                        used.weight = match parameter(value) {
                            Some(Parameter::Number(n)) => Some(n),
                            _ => None,
                        };
                    }
                    ("effect" | "class" | "blend" | "weight", text) => {
                        let (what, words): (String, &[&str]) = match key.as_str() {
                            "class" => (format!("one of {}", CLASSES.join(", ")), CLASSES),
                            "blend" => (format!("one of {}", Blend::WORDS.join(", ")), &Blend::WORDS),
                            "weight" => ("a number 0 to 1".into(), &[]),
                            _ => ("the name of an effect".into(), &[]),
                        };
                        let hint = text.map_or_else(String::new, |t| did_you_mean(t, words.iter().copied()));
                        reader.checker.note(place, key, *line, format!("must be {what}, is {}{hint}", value.quoted()));
                    }
                    _ => match parameter(value) {
                        Some(value) => {
                            used.parameters.insert(key.clone(), value);
                        }
                        None => reader.checker.note(
                            place,
                            key,
                            *line,
                            format!("{} is no value of a parameter", value.quoted()),
                        ),
                    },
                }
            }
            if used.effect.is_empty() {
                if !lines.contains_key("effect") {
                    reader.checker.note(place, "effect", node.line, "is missing: the name of an effect");
                }
                return None;
            }
        }
        _ => {
            let message = format!("must be a name or a table {{ effect = NAME, ... }}, is {}", node.quoted());
            reader.checker.note(place, "", node.line, message);
            return None;
        }
    }
    if used.effect == effect::LOD {
        return Some(used);
    }
    for problem in effect::check(&used) {
        let line = lines.get(problem.key.as_str()).copied().unwrap_or(node.line);
        let key = if problem.key == "effect" && lines.is_empty() { "" } else { &problem.key };
        reader.checker.note(place, key, line, problem.message);
    }
    Some(used)
}

/// Notes effects that need points of interest where there are none.
pub fn without_sights(reader: &mut Reader, fields: &Fields, key: &str, effects: &[EffectUse]) {
    let needs = |used: &&EffectUse| find_effect(&used.effect).is_some_and(|e| e.objects == Some(PerObject::Sights));
    if let Some(used) = effects.iter().find(needs) {
        let message = format!(
            "\"{}\" cuts what stands before a point of interest; a lens of kind = \"occlusion\" with poi would be right",
            used.effect
        );
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
}

/// Effects on all that is seen, of a key of its own.
pub fn of_context(given: &mut Given) -> Vec<EffectUse> {
    let (effects, _) = effects(given.reader, given.fields, given.key, false);
    without_sights(given.reader, given.fields, given.key, &effects);
    effects
}

/// Effects as files list them; `None`: there are none.
pub fn listed(effects: &[EffectUse]) -> Option<Data> {
    (!effects.is_empty()).then(|| Data::list(effects.iter().map(written)))
}

/// A use of an effect as files have it.
pub fn written(used: &EffectUse) -> Data {
    let class = (used.class != Class::Inside).then(|| ("class".to_owned(), used.class.word().into()));
    let blend = used.blend.map(|blend| ("blend".to_owned(), blend.word().into()));
    let weight = used.weight.map(|weight| ("weight".to_owned(), weight.into()));
    let parameters = used.parameters.iter().map(|(key, value)| (key.clone(), parameter_data(value)));
    let said: Vec<(String, Data)> = class.into_iter().chain(blend).chain(weight).chain(parameters).collect();
    if said.is_empty() {
        return Data::text(&used.effect);
    }
    Data::table(std::iter::once(("effect".to_owned(), Data::text(&used.effect))).chain(said))
}
