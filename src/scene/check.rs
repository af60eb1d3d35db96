//! What a scene names in its city and is not there.

use crate::{
    city::CityModel,
    lens::{
        EffectUse, Lens, Occluders, Placement, Region, Rendering,
        chosen::{absent, absent_types},
        nearest::did_you_mean,
        ray::{Bend, RayLens},
        rendering::Case,
        source::is_known,
        thematic::{attribute_names, sentinels},
    },
    scene::{
        anchor::{AnchorProblem, anchor},
        model::{PoiPlace, Scene},
    },
};

/// A name that the city does not have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("[{table}] {key}: {message}")]
pub struct SceneProblem {
    /// The table in the scene file: `lens.0`.
    pub table: String,
    /// The way from there: `effects.1.attribute`.
    pub key: String,
    /// What is wrong, and what is near it.
    pub message: String,
    /// Whether no picture of it would show what the scene means: what it is about, or what it colours or chooses by, is not there.
    pub is_error: bool,
}

/// Attributes and objects that the scene names and the loaded city does not have, and choices of objects that mean none.
pub fn check_against(scene: &Scene, model: &CityModel) -> Vec<SceneProblem> {
    let mut problems = Vec::new();
    let mut names: Option<Vec<&str>> = None;
    let places = [("style".to_owned(), "effects", &scene.style.effects)].into_iter();
    let numbered = || scene.lenses.iter().enumerate().map(|(i, lens)| (format!("lens.{i}"), lens));
    let places = places.map(|(table, list, effects)| (table, list.to_owned(), effects));
    let drawn = numbered().flat_map(|(table, lens)| {
        lens.rendering().into_iter().flat_map(effects_of).map(move |(key, effects)| (table.clone(), key, effects))
    });
    let lenses = numbered().map(|(table, lens)| (table, "effects".to_owned(), &lens.effects));
    for (table, list, effects) in places.chain(drawn).chain(lenses) {
        for (i, used) in effects.iter().enumerate() {
            let Some(attribute) = used.text("attribute") else { continue };
            let names = names.get_or_insert_with(|| attribute_names(model));
            let is_measured = used.effect == "thematic" && is_known(model, attribute);
            if !names.contains(&attribute) && !is_measured {
                let hint = did_you_mean(attribute, names.iter().copied());
                problems.push(SceneProblem {
                    table: table.clone(),
                    key: format!("{list}.{i}.attribute"),
                    message: format!("no object of the city has the attribute \"{attribute}\"{hint}"),
                    is_error: true,
                });
            }
            let none = sentinels(model, attribute);
            if !none.is_empty() {
                let told: Vec<String> =
                    none.iter().take(4).map(|(number, count)| format!("{number:e} ({count})")).collect();
                problems.push(SceneProblem {
                    table: table.clone(),
                    key: format!("{list}.{i}.attribute"),
                    message: format!(
                        "objects have numbers for \"{attribute}\" that stand for no value, and are drawn as such: {}",
                        told.join(", ")
                    ),
                    is_error: false,
                });
            }
        }
    }
    for (i, lens) in scene.lenses.iter().enumerate() {
        let Err(problem) = anchor(&lens.placement, scene, model) else { continue };
        let key = match (&lens.placement, &problem) {
            (Placement::Object(_), _) => "attached_to.object",
            // It is told of the point of interest; the ground is known later.
            (_, AnchorProblem::NoObject(..) | AnchorProblem::NotOnGround) => continue,
            _ => "attached_to.poi",
        };
        problems.push(SceneProblem {
            table: format!("lens.{i}"),
            key: key.into(),
            message: format!("the lens acts nowhere: {problem}"),
            is_error: false,
        });
    }
    for (i, lens) in scene.lenses.iter().enumerate() {
        for (j, focus) in lens.shapes.iter().enumerate().filter_map(|(j, shape)| Some((j, shape.own_shape()?))) {
            let key = if lens.shapes.len() == 1 { "shape".to_owned() } else { format!("shapes.{j}") };
            check_focus(focus, &format!("lens.{i}"), &key, model, &mut problems);
        }
    }
    check_magnified(scene, &mut problems);
    for (i, lens) in scene.lenses.iter().enumerate() {
        if let Some(occluders) = lens.occluders() {
            check_occluders(occluders, &format!("lens.{i}"), scene, model, &mut problems);
        }
        for (key, case) in lens.rendering().into_iter().flat_map(cases_of) {
            let chosen = case.when.of.iter().flat_map(|choice| absent(model, choice));
            let named = chosen.map(|(at, message)| (format!("where.{at}"), format!("chooses nothing: {message}")));
            let types = absent_types(model, &case.when.types);
            let types = types.into_iter().map(|(at, message)| (format!("types.{at}"), message));
            problems.extend(named.chain(types).map(|(at, message)| SceneProblem {
                table: format!("lens.{i}"),
                is_error: at.ends_with("attribute"),
                key: format!("{key}.{at}"),
                message,
            }));
        }
    }
    check_bent(scene, model, &mut problems);
    for (i, poi) in scene.pois.iter().enumerate() {
        let PoiPlace::Object(id) = &poi.place else { continue };
        if model.find_object(id).is_none() {
            let hint = did_you_mean(id, model.objects.iter().map(|o| &*o.id));
            problems.push(SceneProblem {
                table: format!("poi.{i}"),
                key: "object".into(),
                message: format!("the city has no object \"{id}\"{hint}"),
                is_error: true,
            });
        }
    }
    problems
}

/// The cases of a rendering, each with its key in scene files.
fn cases_of(render: &Rendering) -> impl Iterator<Item = (String, &Case)> {
    let several = render.cases.len() > 1;
    let key = move |i: usize| if several { format!("render.{i}") } else { "render".to_owned() };
    render.cases.iter().enumerate().map(move |(i, case)| (key(i), case))
}

/// The lists of effects of a rendering that files give, with their keys.
fn effects_of(render: &Rendering) -> impl Iterator<Item = (String, &Vec<EffectUse>)> {
    let is_list = matches!(&render.cases[..], [one] if one.when.is_always());
    let key_of = move |key: String| if is_list { key } else { format!("{key}.effects") };
    let by_effects = cases_of(render).filter(|(_, case)| case.word.is_none());
    let cases = by_effects.map(move |(key, case)| (key_of(key), &case.effects));
    cases.chain([("poi_effects".to_owned(), &render.poi_effects)])
}

/// The names of an occlusion lens.
fn check_occluders(of: &Occluders, table: &str, scene: &Scene, model: &CityModel, problems: &mut Vec<SceneProblem>) {
    let mut problem = |key: String, message: String| {
        let is_error = key.ends_with(".attribute");
        problems.push(SceneProblem { table: table.to_owned(), key, message, is_error });
    };
    for (i, name) in of.pois.iter().enumerate() {
        let placement = Placement::Poi(name.clone());
        match anchor(&placement, scene, model) {
            // It is told of the point of interest.
            Ok(_) | Err(AnchorProblem::NoObject(..) | AnchorProblem::NotOnGround) => {}
            Err(wrong) => {
                let key = if of.pois.len() == 1 { "poi".to_owned() } else { format!("poi.{i}") };
                let why = match wrong {
                    AnchorProblem::NoGeometry(id) => format!("\"{id}\" has no geometry, nor have its parts"),
                    other => other.to_string(),
                };
                problem(key, format!("nobody hides it: {why}"));
            }
        }
    }
    for (key, choice) in [("force", &of.force), ("forbid", &of.forbid)] {
        for (at, message) in choice.iter().flat_map(|choice| absent(model, choice)) {
            problem(format!("{key}.{at}"), format!("chooses nothing: {message}"));
        }
    }
}

/// What lenses that bend rays magnify in its own outline, and what they act on alone.
fn check_bent(scene: &Scene, model: &CityModel, problems: &mut Vec<SceneProblem>) {
    for (i, ray) in scene.lenses.iter().enumerate().filter_map(|(i, lens)| Some((i, lens.ray()?))) {
        let chosen = [("of", ray.bend.feature().map(|feature| &feature.of)), ("only", ray.only.as_ref())];
        for (at, choice) in chosen {
            let named = choice.into_iter().flat_map(|choice| absent(model, choice));
            problems.extend(named.map(|(key, message)| SceneProblem {
                table: format!("lens.{i}"),
                is_error: key == "attribute",
                key: format!("ray.{at}.{key}"),
                message: format!("chooses nothing: {message}"),
            }));
        }
    }
}

/// Lenses that shapes name.
fn check_magnified(scene: &Scene, problems: &mut Vec<SceneProblem>) {
    for (i, lens) in scene.lenses.iter().enumerate() {
        for (j, shape) in lens.shapes.iter().enumerate() {
            let has_outline = |ray: &RayLens| matches!(ray.bend, Bend::Feature(_)) || ray.mask.is_some();
            let is_wrong = |region: &Region| match region {
                Region::Magnified { lens, .. } => {
                    let named = scene.lenses.iter().find(|other| other.name == *lens);
                    named.and_then(Lens::ray).is_none_or(has_outline)
                }
                _ => false,
            };
            if shape.any(&is_wrong) {
                let key = if lens.shapes.len() == 1 { "shape".to_owned() } else { format!("shapes.{j}") };
                problems.push(SceneProblem {
                    table: format!("lens.{i}"),
                    key: format!("{key}.lens"),
                    message: "holds nothing: there is no lens of this name that bends rays in a circle or a square"
                        .into(),
                    is_error: false,
                });
            }
        }
    }
}

/// The choices of objects of a focus area and its parts.
fn check_focus(focus: &Region, table: &str, at: &str, model: &CityModel, problems: &mut Vec<SceneProblem>) {
    match focus {
        Region::Objects(choice) | Region::Thematic(choice) => {
            problems.extend(absent(model, choice).into_iter().map(|(key, message)| SceneProblem {
                table: table.to_owned(),
                is_error: key == "attribute",
                key: format!("{at}.{key}"),
                message: format!("chooses nothing: {message}"),
            }));
        }
        Region::Combined { parts, .. } | Region::Enclosed { parts, .. } => {
            if let Region::Enclosed { types, .. } = focus {
                problems.extend(absent_types(model, types).into_iter().map(|(i, message)| SceneProblem {
                    table: table.to_owned(),
                    key: format!("{at}.types.{i}"),
                    message,
                    is_error: false,
                }));
            }
            for (i, part) in parts.iter().enumerate() {
                check_focus(part, table, &format!("{at}.shapes.{i}"), model, problems);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        city::{Attribute, CityObject, Value},
        geom::combination::Operation,
        lens::{
            EffectUse, Lens, Parameter,
            chosen::Choice,
            kind::{FeatureLens, Magnifier},
            ray::{Bend, RayLens},
        },
        scene::model::Poi,
    };

    /// A city of a town hall.
    fn town_hall() -> CityModel {
        let mut model = CityModel::default();
        let (kind, name) = (model.strings.intern("Building"), model.strings.intern("yearOfConstruction"));
        model.attributes.push(Attribute { name, value: Value::Integer(1931) });
        model.objects.push(CityObject {
            id: "town-hall".into(),
            kind,
            class: Default::default(),
            parents: vec![],
            children: vec![],
            attributes: 0..1,
            geometries: 0..0,
        });
        model
    }

    #[test]
    fn absent_names_get_their_neighbours() {
        let model = town_hall();
        let mut scene = Scene::default();
        let used = |attribute: &str| EffectUse {
            effect: "thematic".into(),
            class: Default::default(),
            blend: None,
            weight: None,
            parameters: [("attribute".to_owned(), Parameter::Text(attribute.into()))].into(),
        };
        scene.style.effects.push(used("yearOfConstruction"));
        scene.pois.push(Poi { name: "a".into(), place: PoiPlace::Object("town-hall".into()) });
        assert_eq!(check_against(&scene, &model), []);
        let lens = |placement| Lens {
            name: String::new(),
            kind: Default::default(),
            enabled: true,
            color: [0.0; 3],
            placement,
            shapes: vec![],
            effects: vec![],
            time: vec![],
            body: Default::default(),
            sprite: None,
            border: None,
            keeps_shadows: false,
            at_rest: false,
            section: None,
        };
        let attached = [
            Placement::Camera,
            Placement::Object("town-hal".into()),
            Placement::Poi("aa".into()),
            Placement::Poi("a".into()),
            Placement::Poi("b".into()),
        ];
        scene.lenses.extend(attached.map(lens));
        let by_id = |id: &str| Choice { ids: vec!["town-hall".into(), id.into()], ..Choice::default() };
        let by_year =
            |name: &str, min: f64| Choice { attribute: Some(name.into()), min: Some(min), ..Choice::default() };
        let union = |parts| Region::Combined { how: Operation::Union, parts };
        scene.lenses[0].shapes = vec![Region::Objects(by_id("town-hall")), Region::Thematic(by_id("town-hal"))];
        let types = vec!["Building".into(), "building".into()];
        scene.lenses[4].shapes =
            vec![Region::Enclosed { parts: vec![Region::Thematic(by_id("town"))], whole: false, types }];
        scene.lenses[3].shapes = vec![union(vec![
            Region::Objects(by_year("yearOfConstruction", 1931.0)),
            union(vec![
                Region::Thematic(by_year("yearofConstruction", 0.0)),
                Region::Objects(by_year("yearOfConstruction", 1932.0)),
            ]),
        ])];
        scene.style.effects.push(used("yearOfconstrution"));
        scene.pois.push(Poi { name: "b".into(), place: PoiPlace::Object("townhall".into()) });
        let messages: Vec<String> = check_against(&scene, &model).iter().map(ToString::to_string).collect();
        assert_eq!(
            messages,
            [
                "[style] effects.1.attribute: no object of the city has the attribute \"yearOfconstrution\"; did you mean \"yearOfConstruction\"?",
                "[lens.1] attached_to.object: the lens acts nowhere: the city has no object \"town-hal\"; did you mean \"town-hall\"?",
                "[lens.2] attached_to.poi: the lens acts nowhere: the scene has no point of interest \"aa\"; did you mean \"a\"?",
                "[lens.3] attached_to.poi: the lens acts nowhere: the object \"town-hall\" has no geometry, nor have its parts: there is nothing to attach to",
                "[lens.0] shapes.1.ids.1: chooses nothing: the city has no object \"town-hal\"; did you mean \"town-hall\"?",
                "[lens.3] shape.shapes.1.shapes.0.attribute: chooses nothing: no object of the city has the attribute \"yearofConstruction\"; did you mean \"yearOfConstruction\"?",
                "[lens.3] shape.shapes.1.shapes.1.min: chooses nothing: no object has such a \"yearOfConstruction\"; it is 1931 to 1931",
                "[lens.4] shape.types.1: no object of the city is of the type \"building\"; did you mean \"Building\"?",
                "[lens.4] shape.shapes.0.ids.1: chooses nothing: the city has no object \"town\"; did you mean \"town-hall\"?",
                "[poi.1] object: the city has no object \"townhall\"; did you mean \"town-hall\"?",
            ]
        );
        let errors: Vec<usize> =
            (0..).zip(check_against(&scene, &model)).filter(|(_, p)| p.is_error).map(|(i, _)| i).collect();
        assert_eq!(errors, [0, 5, 9]);
    }

    #[test]
    fn what_the_city_lacks_of_lenses_that_bend_rays_is_told() {
        let mut scene = Scene::default();
        let model = town_hall();
        let mut lens = Lens::plain("glass", FeatureLens { ray: RayLens::feature() }, [0.5; 3]);
        let Some(Bend::Feature(feature)) = lens.kind.ray_mut().map(|ray| &mut ray.bend) else {
            panic!("a feature lens")
        };
        feature.of = Choice { ids: vec!["town-hall".into(), "townhall".into()], ..Choice::default() };
        scene.lenses.push(lens);
        let only = Some(Choice { ids: vec!["town-hal".into()], ..Choice::default() });
        let ray = RayLens { only, ..RayLens::magnifier() };
        scene.lenses.push(Lens::plain("some", Magnifier { ray }, [0.5; 3]));
        let messages: Vec<String> = check_against(&scene, &model).iter().map(ToString::to_string).collect();
        let expected =
            [("[lens.0] ray.of.ids.1", "townhall"), ("[lens.1] ray.only.ids.0", "town-hal")].map(|(at, id)| {
                format!("{at}: chooses nothing: the city has no object \"{id}\"; did you mean \"town-hall\"?")
            });
        assert_eq!(messages, expected);
    }
}
