//! Prototypes: what handlers do, when they run and what their functions look like.

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
