//! Effects as they are defined: what an effect file says.

use std::sync::Arc;

use crate::shader::{
    effect::{
        parameter::{Fallback, ParameterDefinition, ParameterKind},
        prototype::{EffectKind, Mode},
    },
    host::HostProgram,
    wgsl::token::identifier,
};

/// Values per object that effects read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PerObject {
    /// A colour, by an attribute; all its parameters are for the host.
    Colors,
    /// Whether an attribute chooses it ([`crate::lens::chosen`]).
    Chosen,
    /// Nothing of objects: where in the picture the points of interest of its lens are (`render::sights`).
    Sights,
    /// Outlines of the ground that they cover (`render::footprints`).
    Footprints,
}

/// A number of a header: itself, or that of a parameter.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(untagged)]
pub enum Amount {
    /// The number.
    Number(f64),
    /// The name of a parameter, which is a number.
    Parameter(String),
}

/// One effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectDefinition {
    /// Its name in scene files.
    pub name: String,
    /// Its prototype.
    pub kind: EffectKind,
    /// When it runs.
    pub mode: Mode,
    /// Where it comes from: author and section, or what its author says.
    pub spec: String,
    /// Its purpose, one sentence.
    pub doc: String,
    /// Its parameters.
    pub parameters: Vec<ParameterDefinition>,
    /// The values per object that its WGSL reads, which the host makes of attributes.
    pub objects: Option<PerObject>,
    /// It draws edges where it acts: with its parameters `line_color` and `line_width`.
    pub lines: bool,
    /// Whether a user wrote it: then its results are contained.
    pub is_users: bool,
    /// It looks at what it takes first, so it cannot stand in for what is below it.
    pub reads_below: bool,
    /// Whether it calls `most_layers`: the largest number of layers of a pixel, which a pass must count first.
    pub asks_most_layers: bool,
    /// Whether its function gives the derivative of what it does, too: one of the program. A user's is made of differences.
    pub has_derivative: bool,
    /// Of a deformation, how far a place is moved along each axis at most, metres: what goes farther is held there.
    pub reach: Amount,
    /// The shortest way, metres, over which what a user's map does changes; `None`: a sixteenth of the shortest side of its lens.
    pub detail: Option<Amount>,
    /// A user's handler as the host runs it, where the host does ([`crate::shader::host`]).
    pub host: Option<Arc<HostProgram>>,
    /// The WGSL of its functions, names qualified; that of its parameters first.
    pub source: String,
    /// Where the WGSL of its parameters ends in it.
    pub parameters_end: usize,
}

/// The effect that draws the edges of what is not there yet.
pub const COMING_LINES: &str = "coming-lines";

impl EffectDefinition {
    /// Its name as WGSL has it: what all its names begin with.
    pub fn wgsl_name(&self) -> String {
        let name = identifier(&self.name);
        // Names of time operators are short, and some are words of WGSL.
        let name = if self.kind == EffectKind::Epoch { format!("epoch_{name}") } else { name };
        // Whatever a user calls an effect, nothing of the program is called so.
        if self.is_users { format!("user_{name}") } else { name }
    }

    /// The name in a module of one of its own names. Two users' effects never have the same name: an effect's holds no
    /// `__`. That two of the program's have not, tests see.
    pub fn own(&self, name: &str) -> String {
        format!("{}{}{name}", self.wgsl_name(), if self.is_users { "__" } else { "_" })
    }

    /// The parameters that WGSL reads, in order.
    pub fn shader_parameters(&self) -> impl Iterator<Item = (&ParameterDefinition, &'static str, usize)> {
        let all = self
            .parameters
            .iter()
            .filter(|p| self.objects != Some(PerObject::Colors) && !matches!(p.fallback, Fallback::Words(_)));
        all.filter_map(|p| p.kind.in_shader().map(|(type_name, floats)| (p, type_name, floats)))
    }

    /// Which fragments an opacity rule makes translucent at all, as a condition on what has `object` and `part` of this
    /// name, and its parameters from `first`; `None`: all of them. The others stay with what is opaque.
    pub fn acts_on(&self, place: &str, first: &str) -> Option<String> {
        let own = format!("{}({first})", self.own("parameters"));
        let mut conditions = Vec::new();
        if self.terrain_parameter().is_some() {
            conditions.push(format!("!({place}.part == PART_TERRAIN && {own}.{KEEP_TERRAIN})"));
        }
        if self.objects == Some(PerObject::Chosen) {
            conditions.push(format!("is_chosen({own}.first, {place}.object)"));
        }
        (!conditions.is_empty()).then(|| conditions.join(" && "))
    }

    /// The parameter of an opacity rule by which terrain stays opaque, if there is one.
    pub fn terrain_parameter(&self) -> Option<&ParameterDefinition> {
        self.parameters.iter().find(|p| p.name == KEEP_TERRAIN && p.kind == ParameterKind::Boolean)
    }

    /// The WGSL of its parameters alone.
    pub fn parameters_source(&self) -> &str {
        &self.source[..self.parameters_end]
    }

    /// Whether its lines are those of what is not there yet.
    pub fn draws_coming(&self) -> bool {
        self.name == COMING_LINES && !self.is_users
    }

    /// How many numbers its WGSL reads of its parameters: the first value per object is one.
    pub fn floats(&self) -> usize {
        let floats: usize = self.shader_parameters().map(|(_, _, floats)| floats).sum();
        floats + usize::from(self.objects.is_some())
    }

    /// A declaration, for its text alone, of what its parameters are read from.
    pub fn array_of_parameters(&self) -> String {
        let (array, slots) = (self.kind.prototype().parameters, self.slots().max(1));
        match array.split_once('.') {
            None => format!("var<private> {array}: array<vec4f, {slots}>;\n"),
            Some((name, member)) => {
                format!("struct Held_{name} {{ {member}: array<vec4f, {slots}> }}\nvar<private> {name}: Held_{name};\n")
            }
        }
    }

    /// How many `vec4f` its parameters take.
    pub fn slots(&self) -> u32 {
        self.floats().div_ceil(4) as u32
    }
}

/// The parameter of an opacity rule by which terrain stays opaque.
const KEEP_TERRAIN: &str = "keep_terrain";
