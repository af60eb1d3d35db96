//! Words of overlays: texts and captions that say what is known of the object that they are of.
//!
//! ```text
//! "{name}, {yearOfConstruction}"  ->  "Stadhuis, 1893"       an attribute of the object, or of what it is part of
//! "{id}"                          ->  its id, whole
//! the id of the object itself     ->  what people call it ([`label`])
//! ```

use crate::{
    city::{
        CityModel,
        label::{attribute, is_readable, label},
    },
    lens::BestView,
    scene::{PoiPlace, Scene},
};

/// What stands where the object has no value.
const NOTHING: &str = "\u{2013}";

/// A text of an overlay with what is known of its first point of interest, if that is an object of the city. What is in braces and no attribute
/// of any object stays as it is.
pub(super) fn filled(model: &CityModel, scene: &Scene, shown: &BestView, text: &str) -> String {
    let first = shown.pois.first().and_then(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let object = match first.map(|poi| &poi.place) {
        Some(PoiPlace::Object(id)) => model.find_object(id),
        _ => None,
    };
    object.map_or_else(|| text.to_owned(), |object| of_object(model, object, text))
}

fn of_object(model: &CityModel, object: u32, text: &str) -> String {
    let id = &*model.objects[object as usize].id;
    // Ids may have braces themselves; those that are words stay.
    let named = if is_readable(id) { text.to_owned() } else { text.replace(id, "{name}") };
    let (mut filled, mut left) = (String::new(), &named[..]);
    while let Some((before, rest)) = left.split_once('{') {
        filled.push_str(before);
        let Some((key, after)) = rest.split_once('}') else {
            filled.push('{');
            left = rest;
            break;
        };
        match value(model, object, key) {
            Some(value) => filled.push_str(&value),
            None => filled.extend(["{", key, "}"]),
        }
        left = after;
    }
    filled + left
}

/// What stands for a key; `None`: no object of the city has such an attribute.
fn value(model: &CityModel, object: u32, key: &str) -> Option<String> {
    match key {
        "name" => Some(label(model, object)),
        "id" => Some(model.objects[object as usize].id.to_string()),
        key => {
            let known = model.strings.find(key)?;
            let is_attribute = || model.attributes.iter().any(|attribute| attribute.name == known);
            attribute(model, object, key).or_else(|| is_attribute().then(|| NOTHING.to_owned()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        city::{Attribute, CityObject, Value},
        lens::best_view::Depiction,
        scene::Poi,
    };

    const GUID: &str = "{10A31B7E-8FC2-45EE-836A-1DB9FEF06E04}";

    fn city() -> CityModel {
        let mut model = CityModel::default();
        let kind = model.strings.intern("Building");
        let texts =
            [("name", "Stadhuis"), ("use", "office")].map(|own| [own.0, own.1].map(|t| model.strings.intern(t)));
        model.attributes.extend(texts.map(|[name, text]| Attribute { name, value: Value::String(text) }));
        for (id, attributes) in [(GUID, 0..0), ("hall", 0..2), ("GUID_8AEB4C1E-0B4C-4A0F-9E4B-1B2C3D4E5F60", 1..2)] {
            model.objects.push(CityObject {
                id: id.into(),
                kind,
                class: Default::default(),
                parents: vec![],
                children: vec![],
                attributes,
                geometries: 0..0,
            });
        }
        model
    }

    fn of(id: &str, text: &str) -> String {
        let shown =
            BestView { pois: vec!["p".into()], depiction: Depiction::Text(String::new()), lenses: None, look: None };
        let place = PoiPlace::Object(id.into());
        let scene = Scene { pois: vec![Poi { name: "p".into(), place }], ..Scene::default() };
        filled(&city(), &scene, &shown, text)
    }

    #[test]
    fn texts_say_what_is_known_of_their_object() {
        assert_eq!(of("hall", "{name}: {use}"), "Stadhuis: office");
        assert_eq!(of(GUID, "{name}, {use}"), "Building 1, \u{2013}", "no name, and no value");
        assert_eq!(of(GUID, "id {id}"), format!("id {GUID}"), "whole where it is asked for");
        assert_eq!(of(GUID, "{height} {} {"), "{height} {} {", "no attribute of the city");
    }

    #[test]
    fn an_id_that_nobody_can_read_gives_way_to_a_name() {
        assert_eq!(of(GUID, GUID), "Building 1");
        let long = city().objects[2].id.to_string();
        assert_eq!(of(&long, &format!("View of {long}")), "View of Building 3");
        assert_eq!(of("hall", "the hall"), "the hall", "a word stays");
        assert_eq!(of("nowhere", "{name}"), "{name}", "of nothing nothing is known");
    }
}
