//! The effects: what lenses and the context can do to what they show (C4).
//!
//! An effect is one file in `shaders/effect` and one row in [`FILES`]; [`super::effect_file`] says what stands in it.

use std::sync::{LazyLock, RwLock};

use crate::shader::{
    effect_file::{self, FileError},
    wgsl::token::identifier,
};

macro_rules! built_in {
    ($name:literal) => {
        (concat!("shaders/effect/", $name, ".wgsl"), include_str!(concat!("../../shaders/effect/", $name, ".wgsl")))
    };
}

/// The handlers that come with the program: effects in the order people read them, then what runs without being asked.
const FILES: &[(&str, &str)] = &[
    built_in!("thematic"),
    built_in!("flat"),
    built_in!("cel"),
    built_in!("gooch"),
    built_in!("clay"),
    built_in!("x-ray-tint"),
    built_in!("hidden-line"),
    built_in!("wireframe"),
    built_in!("greyscale"),
    built_in!("sepia"),
    built_in!("invert"),
    built_in!("darken"),
    built_in!("brighten"),
    built_in!("saturate"),
    built_in!("overlay"),
    built_in!("discard-color"),
    built_in!("posterise"),
    built_in!("engraving"),
    built_in!("blur"),
    built_in!("edges"),
    built_in!("iso-lines"),
    built_in!("eraser"),
    built_in!("cut-away"),
    built_in!("screen-door"),
    built_in!("transparent"),
    built_in!("x-ray"),
    built_in!("film"),
    built_in!("soft-film"),
    built_in!("peel"),
    built_in!("brick"),
    built_in!("gloss"),
    built_in!("marble"),
    built_in!("velvet"),
    built_in!("glow"),
    built_in!("lighting"),
    built_in!("lambert"),
    built_in!("haze"),
];

/// The prototype handlers of shading (H1), in the order of their execution: what an effect's `kind` says. Several
/// handlers of one prototype run in lens order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EffectKind {
    /// Takes parts of the city away, before anything is seen of them.
    Hide,
    /// Says how much of a surface stands between the eye and what is behind it; from 1, lens by lens.
    Opacity,
    /// Changes what surfaces are made of, before light falls on them.
    Material,
    /// Changes the light that falls on them.
    Light,
    /// Gives surfaces their colour; at most one per lens, and nothing behind the city has it.
    Scene,
    /// What is between the surface and the eye.
    Air,
    /// Changes the colour of the lit picture.
    Post,
    /// The same, by what is beside it: the kernel of a separable filter. Runs among the post styles.
    Filter,
}

impl EffectKind {
    /// All, in the order of their execution.
    pub const ALL: [Self; 8] =
        [Self::Hide, Self::Opacity, Self::Material, Self::Light, Self::Scene, Self::Air, Self::Post, Self::Filter];

    /// As people read it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hide => "hiding",
            Self::Opacity => "opacity rule",
            Self::Material => "material",
            Self::Light => "light",
            Self::Scene => "scene style",
            Self::Air => "air",
            Self::Post => "post style",
            Self::Filter => "filter",
        }
    }

    /// What its handlers take first and, but for hiding ones, give back: name and type in WGSL.
    pub fn subject(self) -> (&'static str, &'static str) {
        match self {
            Self::Hide => ("fragment", "Fragment"),
            Self::Opacity => ("opacity", "f32"),
            Self::Material => ("material", "Material"),
            Self::Light => ("arriving", "vec3f"),
            Self::Scene | Self::Air | Self::Post => ("color", "vec3f"),
            Self::Filter => ("offset", "f32"),
        }
    }

    /// Whether its handlers take turns in lens order on the colour.
    pub fn is_style(self) -> bool {
        matches!(self, Self::Scene | Self::Post | Self::Filter)
    }

    /// Whether its handlers have a say in how a line looks: materials and light do not, nor does what is beside it.
    pub fn touches_lines(self) -> bool {
        matches!(self, Self::Hide | Self::Scene | Self::Post)
    }

    /// Whether its handlers decide what the geometry pass shows, by each fragment's own depth (K4).
    pub fn decides_visibility(self) -> bool {
        matches!(self, Self::Hide | Self::Opacity)
    }

    /// Whether its handlers run before the surface has a colour.
    pub fn is_before_color(self) -> bool {
        matches!(self, Self::Material | Self::Light)
    }
}

/// When a handler runs (H1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Always.
    Global,
    /// Where a lens, or the context, has it: effects.
    #[default]
    Local,
    /// Where no other handler of its prototype set the result.
    Optional,
    /// Never.
    Ignore,
}

/// What a parameter takes.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterKind {
    /// `true` or `false`; in WGSL a `bool`.
    Boolean,
    /// A number within the closed range; in WGSL an `f32`.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// Any text; not for WGSL.
    Text,
    /// One of these words; in WGSL a `u32`, and a constant `PARAMETER_WORD` for each.
    Word(Vec<String>),
    /// `"#rrggbb"` or `[r, g, b]`, sRGB 0..1; in WGSL a `vec3f`, linear.
    Color,
    /// Finite numbers, ascending, at most [`MAX_LIST`]; not for WGSL.
    Numbers,
    /// Texts, at most [`MAX_LIST`]; not for WGSL.
    Texts,
    /// Shares, 0 to 1, at equal steps of a ramp, at most [`MAX_RAMP`]; in WGSL a `u32` for `share_on_ramp`.
    Shares,
    /// Colours, as [`Self::Color`], at equal steps of a ramp, at most [`MAX_RAMP`]; in WGSL a `u32` for `color_on_ramp`.
    Colors,
}

/// Longest list a parameter takes.
pub const MAX_LIST: usize = 256;
/// Steps of a ramp.
pub const MAX_RAMP: usize = 64;

impl ParameterKind {
    /// Its type in WGSL and how many floats it takes there; `None` for what only the host reads.
    pub fn in_shader(&self) -> Option<(&'static str, usize)> {
        match self {
            Self::Boolean => Some(("bool", 1)),
            Self::Number { .. } => Some(("f32", 1)),
            Self::Word(_) | Self::Shares | Self::Colors => Some(("u32", 1)),
            Self::Color => Some(("vec3f", 3)),
            Self::Text | Self::Numbers | Self::Texts => None,
        }
    }

    /// What it takes, as people read it.
    pub fn describe(&self) -> String {
        match self {
            Self::Boolean => "true or false".into(),
            Self::Number { min, max } if *min == f64::MIN && *max == f64::MAX => "a finite number".into(),
            Self::Number { min, max } => format!("a number {min} to {max}"),
            Self::Text => "a text".into(),
            Self::Word(words) => format!("one of {}", words.join(", ")),
            Self::Color => "a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Numbers => format!("1 to {MAX_LIST} ascending numbers"),
            Self::Texts => format!("1 to {MAX_LIST} texts"),
            Self::Shares => format!("1 to {MAX_RAMP} numbers of 0 to 1"),
            Self::Colors => format!("1 to {MAX_RAMP} colours \"#rrggbb\""),
        }
    }

    /// Whether WGSL reads it as a ramp.
    pub fn is_ramp(&self) -> bool {
        matches!(self, Self::Shares | Self::Colors)
    }
}

/// What holds where a parameter is not given.
#[derive(Clone, Debug, PartialEq)]
pub enum Fallback {
    /// The effect does nothing without it.
    Required,
    /// This value.
    Value(DefaultValue),
    /// What the words say; the host knows.
    Words(String),
}

/// A parameter's default value.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(untagged)]
pub enum DefaultValue {
    /// Yes or no.
    Boolean(bool),
    /// A number.
    Number(f64),
    /// A word, or a colour as `"#rrggbb"`.
    Text(String),
    /// Shares.
    Numbers(Vec<f64>),
    /// Colours.
    Texts(Vec<String>),
}

/// One parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterDefinition {
    /// Its key.
    pub name: String,
    /// What it takes.
    pub kind: ParameterKind,
    /// What holds where it is not given.
    pub fallback: Fallback,
    /// Unit, or empty.
    pub unit: String,
    /// What it does.
    pub doc: String,
}

impl ParameterDefinition {
    /// Whether the effect does nothing without it.
    pub fn is_required(&self) -> bool {
        self.fallback == Fallback::Required
    }

    /// What holds where it is not given, in words or as TOML; empty where it is required.
    pub fn default_text(&self) -> String {
        match &self.fallback {
            Fallback::Required => String::new(),
            Fallback::Words(words) => words.clone(),
            Fallback::Value(DefaultValue::Boolean(b)) => b.to_string(),
            Fallback::Value(DefaultValue::Number(n)) => n.to_string(),
            Fallback::Value(DefaultValue::Text(t)) => format!("\"{t}\""),
            Fallback::Value(DefaultValue::Numbers(n)) => format!("{n:?}"),
            Fallback::Value(DefaultValue::Texts(t)) => format!("{t:?}"),
        }
    }
}

/// What an effect reads of each object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PerObject {
    /// A colour, by an attribute (K2); all its parameters are for the host.
    Colors,
    /// Whether an attribute chooses it ([`crate::lens::chosen`]).
    Chosen,
    /// Nothing of objects: where in the picture the points of interest of its lens are (`render::sights`).
    Sights,
    /// What they cover of the ground, by its outline (`render::footprints`).
    Footprints,
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
    /// The requirement it fulfils.
    pub spec: String,
    /// What it does, one sentence.
    pub doc: String,
    /// Its parameters.
    pub parameters: Vec<ParameterDefinition>,
    /// What its WGSL reads of each object, which the host makes of attributes.
    pub objects: Option<PerObject>,
    /// It draws edges where it acts: with its parameters `line_color` and `line_width`.
    pub lines: bool,
    /// Somebody else wrote it: what it returns is contained.
    pub is_users: bool,
    /// It looks at what it takes first, so it cannot stand in for what is below it.
    pub reads_below: bool,
    /// It calls `most_layers`: how many layers the pixel has that has most, which somebody must count first.
    pub asks_most_layers: bool,
    /// The WGSL of its functions, names qualified; that of its parameters first.
    pub source: String,
    /// Where the WGSL of its parameters ends in it.
    pub parameters_end: usize,
}

impl EffectDefinition {
    /// Its name as WGSL has it: what all its names begin with.
    pub fn wgsl_name(&self) -> String {
        let name = identifier(&self.name);
        // Whatever a user calls an effect, nothing of the program is called so.
        if self.is_users { format!("user_{name}") } else { name }
    }

    /// What a name of its own is called in a module. Two users' effects never have the same name: an effect's holds no
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

    /// Of an opacity rule: which fragments it makes translucent at all, as a condition on what has `object` and `part` of this
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

    /// Of an opacity rule: by which of its parameters terrain stays opaque, if by any.
    pub fn terrain_parameter(&self) -> Option<&ParameterDefinition> {
        self.parameters.iter().find(|p| p.name == KEEP_TERRAIN && p.kind == ParameterKind::Boolean)
    }

    /// The WGSL of its parameters alone.
    pub fn parameters_source(&self) -> &str {
        &self.source[..self.parameters_end]
    }

    /// How many numbers its WGSL reads of its parameters: the first value per object is one.
    pub fn floats(&self) -> usize {
        let floats: usize = self.shader_parameters().map(|(_, _, floats)| floats).sum();
        floats + usize::from(self.objects.is_some())
    }

    /// How many `vec4f` its parameters take.
    pub fn slots(&self) -> u32 {
        self.floats().div_ceil(4) as u32
    }
}

/// The parameter of an opacity rule by which terrain stays opaque.
const KEEP_TERRAIN: &str = "keep_terrain";

/// What the 13 bits of an invoker's handler can tell apart.
pub const MOST_HANDLERS: usize = 8192;

/// The handlers there are. Definitions are never freed: a pipeline may refer to one that was replaced.
static EFFECTS: LazyLock<RwLock<&'static [EffectDefinition]>> = LazyLock::new(|| {
    let read = |(path, text): &(&str, &str)| {
        effect_file::read(path, text).unwrap_or_else(|error| unreachable!("a built-in effect: {error}"))
    };
    RwLock::new(Vec::leak(FILES.iter().map(read).collect()))
});

/// All handler objects: the program's, then a user's. A handler's place is the number that shaders know it by.
pub fn handlers() -> &'static [EffectDefinition] {
    *EFFECTS.read().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The effects: handlers that a lens, or the context, asks for by name.
pub fn effects() -> impl Iterator<Item = &'static EffectDefinition> {
    handlers().iter().filter(|h| h.mode == Mode::Local)
}

/// The effect called `name`.
pub fn find(name: &str) -> Option<&'static EffectDefinition> {
    effects().find(|e| e.name == name)
}

/// The number of the effect called `name`.
pub fn number_of(name: &str) -> Option<u32> {
    handlers().iter().position(|e| e.name == name && e.mode == Mode::Local).map(|i| i as u32)
}

/// Adds a user's effect file; its name must be new.
///
/// # Errors
/// What is wrong with the file, or with its name.
pub fn add(path: &str, text: &str) -> Result<(), FileError> {
    put(path, text, false).map(drop)
}

/// Takes a user's effect file that may be another version of one that is there, and says how the effect is called. It keeps its number;
/// pipelines that have the version before in them stay until they are forgotten ([`crate::render::Renderer::forget_shaders`]). Not while a
/// picture is drawn: that would mix both versions.
///
/// # Errors
/// What is wrong with the file, or with its name; what was there before stays.
pub fn replace(path: &str, text: &str) -> Result<String, FileError> {
    put(path, text, true)
}

fn put(path: &str, text: &str, may_replace: bool) -> Result<String, FileError> {
    let effect = effect_file::checked(path, text)?;
    let name = effect.name.clone();
    let mut all = EFFECTS.write().unwrap_or_else(std::sync::PoisonError::into_inner);
    let at = all.iter().position(|e| e.name == name);
    if at.is_some_and(|at| !(may_replace && all[at].is_users)) {
        let message = format!("there is an effect \"{name}\" already; expected another name");
        return Err(FileError { path: path.to_owned(), line: 1, column: 1, message });
    }
    if at.is_none() && all.len() == MOST_HANDLERS {
        let message = format!("there are {MOST_HANDLERS} effects already; expected no more");
        return Err(FileError { path: path.to_owned(), line: 1, column: 1, message });
    }
    let mut more = all.to_vec();
    match at {
        Some(at) => more[at] = effect,
        None => more.push(effect),
    }
    *all = Vec::leak(more);
    Ok(name)
}
