//! City objects of other heights: what deformation lenses multiply them with, before anything else moves them.

use glam::DVec3;

use crate::{
    city::CityModel,
    geom::Aabb,
    lens::{
        deform::{Deform, Step},
        nearest::did_you_mean,
        solids::ShownCity,
        thematic::{attribute_names, number_of},
    },
    render::{
        displayed::Stand,
        occlusion::{Occlusion, Search},
    },
    visibility::Viewer,
};

/// What the height of an object is multiplied with, and the height that stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// > 0.
    pub factor: f64,
    /// The lowest of the object and of all that belongs to it, metres.
    pub base_m: f64,
}

impl Height {
    /// Where a place of the object is.
    pub fn place(&self, place: DVec3) -> DVec3 {
        DVec3::new(place.x, place.y, self.base_m + self.factor * (place.z - self.base_m))
    }

    /// What a normal becomes, of unit length.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        (normal * DVec3::new(self.factor, self.factor, 1.0)).normalize_or(DVec3::Z)
    }
}

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

/// Heights of the objects of a city that are changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heights {
    /// One per object; none: no object is changed.
    of: Vec<Option<Height>>,
    /// Around those that are, at rest and as they are shown.
    bounds: Option<Aabb>,
}

/// What lenses ask about.
pub(super) struct Asked<'a> {
    /// At rest: what moves objects is not told by where it moves them.
    pub stand: Stand<'a>,
    pub occlusion: &'a mut Occlusion,
    pub viewer: Viewer,
}

impl Heights {
    /// Whether all stays as it is.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_none()
    }

    /// What an object's height becomes; `None`: it stays.
    pub fn of(&self, object: u32) -> Option<&Height> {
        self.of.get(object as usize)?.as_ref()
    }

    /// Where a place of an object is.
    pub fn place(&self, object: u32, place: DVec3) -> DVec3 {
        self.of(object).map_or(place, |height| height.place(place))
    }

    /// Whether what is changed may have something of a box.
    pub fn reaches(&self, bounds: &Aabb) -> bool {
        self.bounds.is_some_and(|own| own.meets(bounds))
    }

    /// A box around all that a box of the city becomes.
    pub fn changed_bounds(&self, bounds: &Aabb) -> Aabb {
        self.bounds.map_or(*bounds, |own| bounds.union(own))
    }

    /// All that rules make of a city's.
    ///
    /// # Errors
    /// An attribute that no object has.
    pub(super) fn of_rules(rules: &[Rule], city: ShownCity) -> Result<Self, String> {
        let mut heights = Self::default();
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

    fn multiply(&mut self, city: ShownCity, factors: &[f64], strength: f64) {
        let model = city.model;
        let roots = model.roots();
        for &geometry in city.geometries {
            let bounds = model.geometries[geometry as usize].bounds;
            let object = model.geometries[geometry as usize].object;
            let factor = 1.0 + strength * (factors.get(object as usize).copied().unwrap_or(1.0) - 1.0);
            if factor == 1.0 || model.objects[object as usize].class.is_ground() || bounds.is_empty() {
                continue;
            }
            self.of.resize(model.objects.len(), None);
            let base_m = model.family_bounds(roots[object as usize]).min.z;
            let own = self.of[object as usize].get_or_insert(Height { factor: 1.0, base_m });
            own.factor *= factor;
            let shown = Aabb { min: own.place(bounds.min), max: own.place(bounds.max) };
            self.bounds = Some(self.bounds.unwrap_or(Aabb::EMPTY).union(bounds).union(shown));
        }
    }
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
