//! What to show where: a lens = shapes + effects + order (V §3).

pub mod best_view;
pub mod border;
pub mod chosen;
pub mod classify;
pub mod color;
pub mod content;
pub mod deform;
pub mod dither;
pub mod effect;
pub mod focus;
pub mod intersection;
pub mod nearest;
pub mod occluders;
pub mod ramp;
pub mod rendering;
pub mod solids;
pub mod sprite;
pub mod sprite_file;
pub mod sprite_volume;
pub mod thematic;

use std::collections::BTreeMap;

pub use best_view::BestView;
pub use border::{Border, BorderUnit, Discrete};
pub use classify::classify;
pub use content::{Content, ContentSource, Copied};
pub use deform::Deform;
pub use focus::Focus;
pub use occluders::Occluders;
pub use rendering::Rendering;
pub use sprite::{LensSprite, OwnEye};
pub use sprite_volume::{PlacedSprite, SpriteSpace, SpriteVolume};

use crate::{geom::Shape, shader::Blend};

/// A lens (L1).
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Its name, unique.
    pub name: String,
    /// What kind of lens it is.
    pub kind: LensKind,
    /// `false`: keeps its place and its mask bit, acts on nothing.
    pub enabled: bool,
    /// Its own colour, sRGB 0..1: outline, legend, halo.
    pub color: [f32; 3],
    /// What its shapes are fixed to (L2).
    pub placement: Placement,
    /// Its focus areas: inside where any of them is (L1).
    pub shapes: Vec<Focus>,
    /// How the occluders of an occlusion lens are drawn (O3).
    pub render: Option<Rendering>,
    /// What it does, in order (K1: at most one scene style), after what it is drawn by.
    pub effects: Vec<EffectUse>,
    /// What its overlay shows, if it has one (B1 to B5).
    pub best_view: Option<BestView>,
    /// What it does with space, if it is a deformation lens (D1).
    pub deform: Option<Deform>,
    /// What it shows in place of what is below it (C6); `None`: it acts on that.
    pub content: Option<Content>,
    /// How the lens body itself is drawn (L5).
    pub body: LensBody,
    /// The volumetric depth sprite that it is tested by; `None`: from its shapes (S7).
    pub sprite: Option<LensSprite>,
    /// How it ends (L9); `None`: at once.
    pub border: Option<Border>,
    /// Whether what it takes away, sees through or replaces still casts the shadow that it has without the lens.
    pub keeps_shadows: bool,
    /// Whether its focus area is of the city at rest and goes with what deformations move, or stands where it is (L10).
    pub at_rest: bool,
    /// The colour, sRGB 0..1, of the sections through closed shells where it ends; `None`: what is cut is hollow.
    pub section: Option<[f32; 3]>,
}

impl Lens {
    /// A lens without shapes and without effects, its body as lenses of its kind have it.
    pub fn plain(name: impl Into<String>, kind: LensKind, color: [f32; 3]) -> Self {
        Self {
            name: name.into(),
            kind,
            enabled: true,
            color,
            placement: Placement::World,
            shapes: Vec::new(),
            render: None,
            effects: Vec::new(),
            best_view: None,
            deform: None,
            content: None,
            body: LensBody::of_kind(kind),
            sprite: None,
            border: None,
            keeps_shadows: false,
            at_rest: false,
            section: None,
        }
    }

    /// Its border, if it has a width.
    pub fn soft_border(&self) -> Option<Border> {
        self.border.filter(|b| b.width > 0.0)
    }

    /// Whether some of its shapes are depth sprites of files (S8).
    pub fn has_sprite_file(&self) -> bool {
        self.shapes.iter().any(|s| s.any(&|f| matches!(f, Focus::Sprite { .. })))
    }

    /// How its body is drawn: lenses by object have no surface, and a flat one has no silhouette that a ray comes close to; they
    /// show a line instead.
    pub fn drawn_body(&self) -> LensBody {
        let is_in = |is_one: &dyn Fn(&Focus) -> bool| self.shapes.iter().any(|s| s.any(is_one));
        let is_by_object = || is_in(&Focus::is_by_object);
        let is_flat = || is_in(&|f| matches!(f, Focus::Shape(Shape::Flat { .. })));
        match self.body {
            LensBody::Shell if is_by_object() => LensBody::Outline,
            LensBody::Halo if self.sprite.is_some() || is_by_object() || is_flat() || self.has_sprite_file() => {
                LensBody::Outline
            }
            body => body,
        }
    }
}

/// What the shapes of a lens are fixed to, whose origin and axes their coordinates are of (L2); metres.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Placement {
    /// The world: model coordinates.
    #[default]
    World,
    /// A city object, by its id: the middle of the axis-aligned box around the geometries of all its levels of detail and those
    /// of all its parts; the world's axes.
    Object(String),
    /// A point of interest, by its name: its point, or its object as above; the world's axes.
    Poi(String),
    /// The camera: the eye; x to the right of the picture, y to its top, z out of it to whoever looks.
    Camera,
}

/// Kinds of lenses this version has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LensKind {
    /// Restyles what is in it (K1).
    #[default]
    Color,
    /// Shows something else in it (C3).
    Content,
    /// Draws what hides a point of interest so that it can be seen (O2, O3).
    Occlusion,
    /// Moves what is in it (D1).
    Deformation,
    /// Shows an image or a text (B1).
    Annotation,
    /// Shows the city from an eye of its own (B2, B3).
    BestView,
    /// Shows a map of what lies around the main eye (B4).
    MapView,
    /// Shows a small model of a place that can be turned (B5).
    Worldlet,
    /// Shows another place in a region of the picture (B5).
    SeeThrough,
    /// Shows another place that one can go to (B5).
    Portal,
}

impl LensKind {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 10] = [
        ("color", Self::Color),
        ("content", Self::Content),
        ("occlusion", Self::Occlusion),
        ("deformation", Self::Deformation),
        ("annotation", Self::Annotation),
        ("best-view", Self::BestView),
        ("map-view", Self::MapView),
        ("worldlet", Self::Worldlet),
        ("see-through", Self::SeeThrough),
        ("portal", Self::Portal),
    ];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    /// The kind with this word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| *w == word).map(|(_, kind)| *kind)
    }

    /// Whether its lenses have an overlay in place of a focus area (V §3.4).
    pub fn has_overlay(self) -> bool {
        !matches!(self, Self::Color | Self::Content | Self::Occlusion | Self::Deformation)
    }
}

impl Lens {
    /// The classes it acts on, of what it does and shows.
    pub fn classes(&self) -> impl Iterator<Item = Class> {
        self.uses().map(|e| e.class).chain(self.shown().map(|c| c.class))
    }

    /// What it shows in itself: its own content, or what it shows occluders as; of several cases the first that shows something.
    pub fn shown(&self) -> Option<&Content> {
        let cases = || self.render.iter().flat_map(|render| &render.cases);
        self.content.as_ref().or_else(|| cases().find_map(|case| case.content.as_ref()))
    }

    /// What it does, in order: how it draws occluders, then its effects.
    pub fn uses(&self) -> impl Iterator<Item = &EffectUse> {
        let cases = self.render.iter().flat_map(|render| &render.cases);
        cases.flat_map(|case| &case.effects).chain(&self.effects)
    }

    /// Whom it looks for, if it is an occlusion lens.
    pub fn occluders(&self) -> Option<&Occluders> {
        let of_deform = || self.deform.as_ref().and_then(Deform::occluders);
        self.shapes.first().and_then(Focus::occluders).or_else(of_deform)
    }
}

/// How a lens body is drawn (L5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LensBody {
    /// Not at all.
    None,
    /// A line around its silhouette, in the lens colour.
    #[default]
    Outline,
    /// Tinted glass, with a line around it.
    Shell,
    /// A glow around its silhouette.
    Halo,
}

impl LensBody {
    /// How lenses of a kind are drawn that say nothing of it. What is done to occluders is what tells of them; a line around what is opaque of
    /// it, and none around the rest, tells less.
    pub fn of_kind(kind: LensKind) -> Self {
        if kind == LensKind::Occlusion { Self::None } else { Self::Outline }
    }

    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 4] =
        [("outline", Self::Outline), ("shell", Self::Shell), ("halo", Self::Halo), ("none", Self::None)];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, body)| *body == self).map_or("none", |(word, _)| word)
    }
}

/// One use of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectUse {
    /// Its name in the table of effects ([`crate::lens::effect`]).
    pub effect: String,
    /// What it acts on, seen along the pixel's ray (L4).
    pub class: Class,
    /// How it is laid over what is below (C5); `None`: it replaces that.
    pub blend: Option<Blend>,
    /// How much of it, 0 to 1; `None`: all.
    pub weight: Option<f64>,
    /// Its parameters; the table has the defaults.
    pub parameters: BTreeMap<String, Parameter>,
}

/// Where the shown surface is with regard to a lens (L4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Class {
    /// D_F ≤ D < D_B.
    #[default]
    Inside,
    /// D < D_F.
    Front,
    /// D ≥ D_B.
    Behind,
    /// The ray misses the lens.
    Rest,
}

/// An effect parameter's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Parameter {
    /// Yes or no.
    Boolean(bool),
    /// A number, in the unit the effect states.
    Number(f64),
    /// A word, a colour ramp, an attribute name.
    Text(String),
    /// Numbers: class breaks, a colour.
    Numbers(Vec<f64>),
    /// Words: categories.
    Texts(Vec<String>),
}
