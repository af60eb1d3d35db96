//! Steps of deformation lenses that change heights of city objects, and what they make of a city's.

use crate::{
    city::CityModel,
    lens::{
        deform::{Deform, Step},
        nearest::did_you_mean,
        solids::ShownCity,
        thematic::{attribute_names, number_of},
    },
    render::{
        displayed::Stand,
        heights::Heights,
        occlusion::{Occlusion, Search},
    },
    visibility::Viewer,
};

/// One step of a lens that changes heights, and all that what it does depends on, but for the city.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rule {
    /// Which lens of the scene.
    pub lens: usize,
    pub step: Step,
    pub strength: f64,
    /// Of each object how far it is lowered, 0 to 1.
    pub weights: Vec<f32>,
}

impl Rule {
    /// Those of a lens, by its name and number.
    pub fn of_lens(lens: usize, name: &str, deform: &Deform, asked: &mut Asked) -> Vec<Self> {
        let weights = |step: &Step, asked: &mut Asked| {
            let Step::Lower { of, .. } = step else { return Vec::new() };
            let shown = asked.occlusion.objects(name, Search { of, when: &[] }, asked.stand, asked.viewer);
            let settled = || shown.objects.iter().map(|is| f32::from(u8::from(*is))).collect();
            asked.occlusion.weights(name).unwrap_or_else(settled)
        };
        let rule =
            |step: &Step| Self { lens, step: step.clone(), strength: deform.strength, weights: weights(step, asked) };
        deform.steps.iter().map(rule).collect()
    }
}

/// What lenses ask about.
pub(super) struct Asked<'a> {
    /// At rest: what moves objects is not told by where it moves them.
    pub stand: Stand<'a>,
    pub occlusion: &'a mut Occlusion,
    pub viewer: Viewer,
}

/// All that rules make of a city's.
///
/// # Errors
/// An attribute that no object has.
pub(super) fn heights_of(rules: &[Rule], city: ShownCity) -> Result<Heights, String> {
    let mut heights = Heights::default();
    for rule in rules {
        let factors = match &rule.step {
            Step::Heights { attribute, from, to } => factors_of(city.model, attribute, *from, *to)
                .map_err(|message| format!("[lens.{}] {message}", rule.lens))?,
            Step::Lower { factor, .. } => {
                rule.weights.iter().map(|weight| 1.0 + f64::from(*weight) * (factor - 1.0)).collect()
            }
            _ => continue,
        };
        heights.multiply(city, &factors, rule.strength);
    }
    Ok(heights)
}

/// Of each object what a number of it says; 1 without one.
fn factors_of(model: &CityModel, attribute: &str, from: [f64; 2], to: [f64; 2]) -> Result<Vec<f64>, String> {
    let Some(name) = model.strings.find(attribute) else {
        let hint = did_you_mean(attribute, attribute_names(model));
        return Err(format!("deform: no object of the city has the attribute \"{attribute}\"{hint}"));
    };
    let factor = |object: u32| {
        let number = number_of(model.attribute(object, name)?, &model.strings)?;
        let part = ((number - from[0]) / (from[1] - from[0])).clamp(0.0, 1.0);
        Some(to[0] + part * (to[1] - to[0]))
    };
    Ok((0..model.objects.len() as u32).map(|object| factor(object).unwrap_or(1.0)).collect())
}
