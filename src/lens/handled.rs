//! Users' handlers that stand in another place than a list of effects: steps of deformations, shapes, transforms of contents.

use std::{collections::BTreeMap, sync::Arc};

use glam::{DMat3, DQuat, DVec3};

use crate::{
    geom::deform::{Map, Mapped},
    lens::{
        effect::{self, EffectProblem},
        effect_use::Parameter,
        nearest::did_you_mean,
    },
    shader::{
        effect::{Amount, AskedBy, EffectDefinition, ParameterDefinition, asked_for, find_asked_by},
        host::HostProgram,
    },
};

/// One use of a handler.
#[derive(Clone, Debug, PartialEq)]
pub struct Handled {
    /// Its name.
    pub handler: String,
    /// Its parameters; its header has the defaults.
    pub parameters: BTreeMap<String, Parameter>,
}

/// The detail of a map that says nothing of it, in shortest sides of its lens.
const DETAIL: f64 = 1.0 / 16.0;

impl Handled {
    /// A use of nothing.
    pub const fn nameless() -> Self {
        Self { handler: String::new(), parameters: BTreeMap::new() }
    }

    /// A use without parameters.
    pub fn named(handler: &str) -> Self {
        Self { handler: handler.to_owned(), parameters: BTreeMap::new() }
    }

    /// Its definition, where it is asked for.
    ///
    /// # Errors
    /// There is none of this name.
    pub fn definition(&self, asked_by: AskedBy) -> Result<&'static EffectDefinition, String> {
        find_asked_by(asked_by, &self.handler).ok_or_else(|| {
            let hint = did_you_mean(&self.handler, asked_for(asked_by).map(|h| h.name.as_str()));
            format!(
                "there is no handler \"{}\"{hint}; those of your own come from a folder: --effects DIR",
                self.handler
            )
        })
    }

    /// Everything wrong with its parameters; `reserved`: keys that are no parameters.
    pub fn problems(&self, definition: &EffectDefinition, reserved: &[&str]) -> Vec<EffectProblem> {
        effect::problems_of_parameters(definition, &self.parameters, reserved)
    }

    /// Its parameters as the GPU reads them, packed.
    pub fn floats(&self, definition: &EffectDefinition) -> Vec<f32> {
        definition.shader_parameters().flat_map(|(parameter, ..)| self.floats_of(parameter)).collect()
    }

    /// One of them.
    pub fn floats_of(&self, parameter: &ParameterDefinition) -> Vec<f32> {
        match self.value(parameter) {
            Some(value) => effect::in_floats(parameter, &value),
            None => vec![0.0; parameter.kind.in_shader().map_or(0, |(_, floats)| floats)],
        }
    }

    /// A length of its header, metres.
    fn amount(&self, definition: &EffectDefinition, amount: &Amount) -> f64 {
        match amount {
            Amount::Number(number) => *number,
            Amount::Parameter(name) => {
                let parameter = definition.parameters.iter().find(|p| p.name == *name);
                match parameter.and_then(|parameter| self.value(parameter)) {
                    Some(Parameter::Number(number)) => number.abs(),
                    _ => 0.0,
                }
            }
        }
    }

    /// The value of a parameter: as given where that fits, else the header's.
    fn value(&self, parameter: &ParameterDefinition) -> Option<Parameter> {
        let given = self.parameters.get(&parameter.name).filter(|v| effect::problem_with(&parameter.kind, v).is_none());
        given.cloned().or_else(|| effect::default_of(parameter))
    }

    /// The map of a deformation over a lens of this extent, metres.
    ///
    /// # Errors
    /// There is no deformation of this name.
    pub fn map(&self, size: DVec3) -> Result<Mapped, String> {
        let definition = self.definition(AskedBy::Steps)?;
        let Some(program) = definition.host.clone() else { return Err("it does not run on the host".into()) };
        let parameters = self.floats(definition);
        let reach = self.amount(definition, &definition.reach).max(LEAST_M);
        let asked = definition.detail.as_ref().map(|detail| self.amount(definition, detail));
        let detail = asked.unwrap_or(DETAIL * size.min_element()).max(LEAST_M);
        let numbers = parameters.iter().map(|n| u64::from(n.to_bits()));
        // A definition stays where it is for ever; another version of it stands elsewhere.
        let identity = std::iter::once(std::ptr::from_ref(definition) as u64)
            .chain(size.to_array().map(f64::to_bits))
            .chain(numbers)
            .collect();
        let map = UserMap { name: definition.name.clone(), program, size, parameters, identity };
        Ok(Mapped { map: Arc::new(map), reach, detail, strength: 1.0 })
    }
}

/// What turns, scales and moves: p becomes `rotation * (scale * p) + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Turns.
    pub rotation: DQuat,
    /// Scales, > 0.
    pub scale: f64,
    /// Moves, metres.
    pub offset: DVec3,
}

/// How far, relative to the lens, what a transform makes of a place may be from what a similarity makes of it.
const ALIKE: f64 = 1e-6;

impl Handled {
    /// The transform of a content, for a lens of this extent, metres.
    ///
    /// # Errors
    /// There is no transform of this name, or it does more than turn, scale and move.
    pub fn similarity(&self, size: DVec3) -> Result<Similarity, String> {
        let definition = self.definition(AskedBy::Contents)?;
        let parameters = self.floats(definition);
        let run = |place: DVec3| definition.host.as_ref().and_then(|host| host.vector(place, size, &parameters));
        let wrong = || format!("\"{}\" does more than turn, move and scale alike along all axes", self.handler);
        let (offset, linear) = run(DVec3::ZERO).ok_or_else(wrong)?;
        let scale = linear.determinant().cbrt();
        let is_length = scale.is_finite() && scale > 0.0 && offset.is_finite();
        let rotation = DQuat::from_mat3(&(linear * scale.recip())).normalize();
        let made = Similarity { rotation, scale, offset };
        let reach = size.max_element().max(1.0);
        let is_alike = |corner: u32| {
            let sign = |bit: u32| if corner >> bit & 1 == 1 { reach } else { -reach };
            let place = DVec3::new(sign(0), sign(1), sign(2));
            run(place).is_some_and(|(moved, _)| (moved - made.point(place)).length() <= ALIKE * scale * reach)
        };
        if is_length && (0..8).all(is_alike) { Ok(made) } else { Err(wrong()) }
    }
}

impl Similarity {
    /// What becomes of a place.
    pub fn point(&self, place: DVec3) -> DVec3 {
        self.rotation * (self.scale * place) + self.offset
    }
}

/// The least length of a map, metres: of one whose parameter says 0.
const LEAST_M: f64 = 1e-3;

/// A user's map with its parameters.
#[derive(Debug)]
struct UserMap {
    name: String,
    program: Arc<HostProgram>,
    size: DVec3,
    parameters: Vec<f32>,
    identity: Vec<u64>,
}

impl Map for UserMap {
    fn name(&self) -> &str {
        &self.name
    }

    fn jet(&self, place: DVec3) -> (DVec3, DMat3) {
        self.program.vector(place, self.size, &self.parameters).unwrap_or((DVec3::ZERO, DMat3::ZERO))
    }

    fn size(&self) -> DVec3 {
        self.size
    }

    fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    fn identity(&self) -> &[u64] {
        &self.identity
    }
}
