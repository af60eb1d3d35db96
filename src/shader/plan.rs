//! What a scene asks of shading: the invoker table (H2), from which both back ends are made.
//!
//! A [`Plan`] names handlers, lenses and classes, never positions or parameters: those stand in uniforms, so a lens that
//! moves or a slider that is dragged compiles nothing. Equal plans share a pipeline.

use crate::shader::{
    effect::{EffectDefinition, EffectKind},
    regions::Regions,
};

/// `vec4f` that a body's parameters take: colour and opacity; width of the line or the glow in pixels.
pub const BODY_SLOTS: u32 = 2;

/// Lenses and effects of one part of the picture, bottom lens first (L6).
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Plan {
    /// Lenses that may be seen there.
    pub lenses: Vec<PlanLens>,
    /// What is done, bottom lens first; prototypes have an order of their own ([`EffectKind::ALL`]).
    pub steps: Vec<Step>,
    /// Whether the air shows.
    pub haze: bool,
    /// Whether every pixel's classes are written down, for AOVs and statistics.
    pub masks: bool,
    /// Whether some effect draws lines.
    pub lines: bool,
    /// Whether something is seen through: what shading lays over its picture.
    pub veils: bool,
    /// What its lenses show in themselves, bottom lens first (C6).
    pub contents: Vec<PlanContent>,
    /// How places are told apart, for the techniques that are kept for reference (C2); `None`: by accumulation.
    pub regions: Option<Regions>,
}

/// What a lens of a plan shows in place of what is below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanContent {
    /// Index into [`Plan::lenses`].
    pub lens: u32,
    /// On which of its classes.
    pub class: ClassTest,
    /// Number of the city that it shows, from 1; less than [`MOST_CITIES`].
    pub city: u32,
    /// What becomes of what is below.
    pub clip: Clip,
    /// Whether terrain stays as it is below.
    pub keeps_terrain: bool,
}

/// Cities of a picture, the scene's own included: bits of a word.
pub const MOST_CITIES: u32 = 32;

/// What becomes of what is shown below a lens that has own content (C6), the context included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Clip {
    /// It is clipped: the topmost content shows.
    #[default]
    Order,
    /// It stays, and the content is added.
    Merge,
    /// Nothing shows where a lens below has another content, neither; else as `Order`.
    Discard,
}

impl Clip {
    /// All, in the order of the uber back end's numbers.
    pub const ALL: [Self; 3] = [Self::Order, Self::Merge, Self::Discard];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Order => "order",
            Self::Merge => "merge",
            Self::Discard => "discard",
        }
    }

    /// The number that the uber back end knows it by.
    pub fn number(self) -> u32 {
        Self::ALL.iter().position(|c| *c == self).unwrap_or(0) as u32
    }
}

/// A lens of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PlanLens {
    /// Its bit in the masks.
    pub number: u32,
    /// How each of its volumes is tested; among the frame's volumes they follow those of the lenses before it.
    pub volumes: Vec<VolumeTest>,
    /// What the leaves of its combinations are, ascending, each once.
    pub leaves: Vec<VolumeTest>,
    /// How its body is drawn, if it is.
    pub body: Option<PlanBody>,
    /// Its soft border, if it has one.
    pub border: Option<PlanBorder>,
}

/// How the body of a lens is drawn (L5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanBody {
    /// As what.
    pub kind: BodyKind,
    /// Place of its parameters.
    pub parameters: u32,
}

/// What the body of a lens is drawn as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BodyKind {
    /// A line around its silhouette.
    Outline,
    /// Tinted glass, with such a line.
    Shell,
    /// A glow around its silhouette.
    Halo,
}

impl BodyKind {
    /// Its number in the invoker table.
    pub fn number(self) -> u32 {
        self as u32
    }

    /// Whether it has a line around its silhouette.
    pub fn has_outline(self) -> bool {
        self != Self::Halo
    }
}

/// A soft border (L9).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanBorder {
    /// Place of its parameters.
    pub parameters: u32,
    /// Whether what cannot be had by halves is dithered.
    pub dithers: bool,
    /// Whether it is told by the distance along the ray.
    pub by_ray: bool,
}

/// How it is decided where a place is with regard to a lens volume (S7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VolumeTest {
    /// From the figures of a sphere.
    Sphere,
    /// Of an oriented box.
    Box,
    /// Of a cylinder.
    Cylinder,
    /// Of the planes of a convex polytope.
    Convex,
    /// Of an ellipsoid.
    Ellipsoid,
    /// Of a cone, cut or not.
    Frustum,
    /// Of the faces of a solid of any form; cheap for *inside* alone.
    Solid,
    /// Of the faces, and of a volumetric depth sprite what is in front and behind.
    SolidSprite,
    /// By its volumetric depth sprite.
    Sprite,
    /// By the object that a place belongs to.
    Members,
    /// Of the leaves of a combination; cheap for *inside* alone.
    Combined,
    /// Of the leaves, and of a volumetric depth sprite what is in front and behind.
    CombinedSprite,
    /// Of a figure in a plane, which is looked through.
    Flat,
    /// By its volumetric depth sprite, whatever that is stored in.
    LayeredSprite,
    /// By a volumetric depth sprite that has its own eye.
    OwnSprite,
    /// By the object that a place belongs to, where objects come or go.
    FadingMembers,
}

impl VolumeTest {
    /// All of them, in the order of their numbers in `lib/shape.wgsl`.
    pub const ALL: [Self; 16] = [
        Self::Sphere,
        Self::Box,
        Self::Cylinder,
        Self::Convex,
        Self::Ellipsoid,
        Self::Frustum,
        Self::Solid,
        Self::SolidSprite,
        Self::Sprite,
        Self::Members,
        Self::Combined,
        Self::CombinedSprite,
        Self::Flat,
        Self::LayeredSprite,
        Self::OwnSprite,
        Self::FadingMembers,
    ];

    /// Its number, as `lib/shape.wgsl` knows it.
    pub fn number(self) -> u32 {
        Self::ALL.iter().position(|t| *t == self).unwrap_or(0) as u32
    }

    /// Whether a volumetric depth sprite of the picture's eye alone says where a place is.
    pub fn is_sprite(self) -> bool {
        matches!(self, Self::Sprite | Self::LayeredSprite)
    }

    /// Whether a volumetric depth sprite tells the sides of what is not inside.
    pub fn has_sides(self) -> bool {
        matches!(self, Self::SolidSprite | Self::CombinedSprite)
    }

    /// Whether it says in closed form where rays are inside, and they leave it again.
    pub fn has_span(self) -> bool {
        matches!(self, Self::Sphere | Self::Box | Self::Cylinder | Self::Convex | Self::Ellipsoid | Self::Frustum)
    }

    /// Whether it may read the faces of a solid.
    pub fn has_faces(self) -> bool {
        matches!(self, Self::Solid | Self::SolidSprite) || self.has_leaves()
    }

    /// Whether it reads the leaves of a combination.
    pub fn has_leaves(self) -> bool {
        matches!(self, Self::Combined | Self::CombinedSprite)
    }

    /// Its constant there.
    pub fn constant(self) -> &'static str {
        match self {
            Self::Sphere => "SPHERE",
            Self::Box => "BOX",
            Self::Cylinder => "CYLINDER",
            Self::Convex => "CONVEX",
            Self::Ellipsoid => "ELLIPSOID",
            Self::Frustum => "FRUSTUM",
            Self::Solid => "SOLID",
            Self::SolidSprite => "SOLID_SPRITE",
            Self::Sprite => "SPRITE",
            Self::Members => "MEMBERS",
            Self::Combined => "COMBINED",
            Self::CombinedSprite => "COMBINED_SPRITE",
            Self::Flat => "FLAT",
            Self::LayeredSprite => "LAYERED_SPRITE",
            Self::OwnSprite => "OWN_SPRITE",
            Self::FadingMembers => "FADING_MEMBERS",
        }
    }
}

/// One use of an effect.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    /// Index into [`crate::shader::effect::handlers`].
    pub effect: u32,
    /// Where it acts.
    pub scope: Scope,
    /// Its first `vec4f` of the parameters.
    pub parameters: u32,
    /// How it is laid over what is below it; its weight follows its parameters. `None`: it replaces that.
    pub blend: Option<Blend>,
}

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scope {
    /// All of the picture.
    Everywhere,
    /// One class of a lens (L4): index into [`Plan::lenses`].
    Lens(u32, ClassTest),
}

/// A class of L4, as `lib/lens.wgsl` tests it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClassTest {
    /// D_F ≤ D < D_B.
    Inside,
    /// D < D_F.
    Front,
    /// D ≥ D_B.
    Behind,
    /// The ray misses the lens, or D is between two of its volumes.
    Rest,
}

impl ClassTest {
    /// All of them, in the order of the uber back end's numbers, which begin with 1.
    pub const ALL: [Self; 4] = [Self::Inside, Self::Front, Self::Behind, Self::Rest];

    /// The function that tests it.
    pub fn function(self) -> &'static str {
        match self {
            Self::Inside => "is_inside",
            Self::Front => "is_in_front",
            Self::Behind => "is_behind",
            Self::Rest => "is_rest",
        }
    }

    /// The function that says how much of it a place with a degree of interest has (`lib/border.wgsl`).
    pub fn share(self) -> &'static str {
        match self {
            Self::Inside => "share_inside",
            Self::Front => "share_front",
            Self::Behind => "share_behind",
            Self::Rest => "share_rest",
        }
    }
}

/// How a channel is laid over what is below (C5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blend {
    /// In its place; with a weight below 1: as paint.
    Replace,
    /// The sum.
    Add,
    /// The difference, at least 0.
    Subtract,
    /// As a filter.
    Multiply,
    /// As light.
    Screen,
    /// A filter where it is dark below, light where it is light.
    Overlay,
}

impl Blend {
    /// All, in the order of the uber back end's numbers, which begin with 1.
    pub const ALL: [Self; 6] = [Self::Replace, Self::Add, Self::Subtract, Self::Multiply, Self::Screen, Self::Overlay];

    /// All words that name one.
    pub const WORDS: [&str; 7] = ["replace", "add", "subtract", "multiply", "screen", "overlay", "alpha"];

    /// The number that `lib/blend.wgsl` knows it by.
    pub fn number(self) -> u32 {
        1 + Self::ALL.iter().position(|b| *b == self).unwrap_or(0) as u32
    }

    /// The mode that a word names.
    pub fn parse(word: &str) -> Option<Self> {
        let word = if word == "alpha" { "replace" } else { word };
        Self::ALL.into_iter().find(|b| b.word() == word)
    }

    /// Its word in scene files; `alpha` is another for `replace`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Replace => "replace",
            Self::Add => "add",
            Self::Subtract => "subtract",
            Self::Multiply => "multiply",
            Self::Screen => "screen",
            Self::Overlay => "overlay",
        }
    }
}

/// A plan on one of the back ends (H3). Both make the same picture.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Program {
    /// What is asked for, written out.
    Specialised(Plan),
    /// Everything that the scene may ask for, chosen per pixel from a table in a uniform.
    Uber(Uber),
}

/// What one module of the uber back end holds: what any plan of the scene may name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Uber {
    /// The scene's effects, ascending, each once; those of disabled lenses too.
    pub effects: Vec<u32>,
    /// How the volumes of the scene's lenses are tested, ascending, each once; none: there are no lenses.
    pub tests: Vec<VolumeTest>,
    /// What the leaves of their combinations are, ascending, each once.
    pub leaves: Vec<VolumeTest>,
    /// What their bodies are drawn as, ascending, each once.
    pub bodies: Vec<BodyKind>,
    /// Whether something may act on other classes of them than *inside*.
    pub sides: bool,
    /// Whether some of them have soft borders.
    pub borders: bool,
    /// Whether some of these are told along rays.
    pub by_ray: bool,
    /// Whether what cannot be had by halves is dithered along some of these.
    pub dithers: bool,
    /// Whether some effects are blended.
    pub blends: bool,
    /// Whether the air shows.
    pub haze: bool,
    /// Whether every pixel's classes are written down.
    pub masks: bool,
    /// Whether some effects draw lines.
    pub lines: bool,
    /// Whether something may be seen through.
    pub veils: bool,
    /// Whether some lenses have own content.
    pub contents: bool,
}

impl Uber {
    /// What of it says what is there; `None` where nothing may be hidden.
    pub fn hiding(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let effects = self.of(handlers, EffectKind::decides_visibility);
        (!effects.is_empty() || self.contents).then(|| Self {
            effects,
            tests: self.tests.clone(),
            leaves: self.leaves.clone(),
            contents: self.contents,
            sides: self.sides,
            borders: self.dithers || (self.borders && self.is_seen_through(handlers)),
            by_ray: self.by_ray,
            ..Self::default()
        })
    }

    /// Whether nobody asks for other classes of lenses than *inside*.
    pub fn asks_inside_alone(&self) -> bool {
        !self.sides && !self.masks
    }

    /// What of it lines go through; `None` where nobody may draw any.
    pub fn lining(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let effects = self.of(handlers, EffectKind::touches_lines);
        let (tests, leaves) = (self.tests.clone(), self.leaves.clone());
        let Self { sides, borders, by_ray, dithers, contents, .. } = *self;
        let all = Self { effects, tests, leaves, sides, borders, by_ray, dithers, contents, ..Self::default() };
        self.lines.then_some(Self { blends: self.blends, lines: true, ..all })
    }

    /// What of it says how things look.
    pub fn shading(self, handlers: &[EffectDefinition]) -> Self {
        let veils = self.is_seen_through(handlers);
        Self { effects: self.of(handlers, |kind| !kind.decides_visibility()), veils, contents: false, ..self }
    }

    /// What of it says how much of each translucent layer is seen, and how that looks; `None` where nothing may be seen through.
    pub fn layering(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let effects = self.of(handlers, |kind| !matches!(kind, EffectKind::Hide | EffectKind::Filter));
        let all = Self { effects, bodies: Vec::new(), lines: false, veils: false, contents: false, ..self.clone() };
        self.is_seen_through(handlers).then_some(all)
    }

    fn is_seen_through(&self, handlers: &[EffectDefinition]) -> bool {
        self.effects.iter().any(|&e| handlers[e as usize].kind == EffectKind::Opacity)
    }

    fn of(&self, handlers: &[EffectDefinition], is_wanted: impl Fn(EffectKind) -> bool) -> Vec<u32> {
        self.effects.iter().copied().filter(|&e| is_wanted(handlers[e as usize].kind)).collect()
    }
}

impl Program {
    /// Which libraries it calls.
    pub fn has(&self) -> Parts {
        let (tests, has_lenses) = match self {
            Self::Specialised(plan) => (plan.tests().collect(), !plan.lenses.is_empty()),
            Self::Uber(uber) => (uber.tests.clone(), !uber.tests.is_empty()),
        };
        let (bodies, blends, lines, borders) = match self {
            Self::Specialised(plan) => (plan.bodies(), plan.has_blends(), plan.lines, plan.has_borders()),
            Self::Uber(uber) => (uber.bodies.clone(), uber.blends, uber.lines, uber.borders && has_lenses),
        };
        let veils = match self {
            Self::Specialised(plan) => plan.veils,
            Self::Uber(uber) => uber.veils,
        };
        let by_ray = match self {
            Self::Specialised(plan) => plan.borders().any(|border| border.by_ray),
            Self::Uber(uber) => uber.by_ray && borders,
        };
        let contents = match self {
            Self::Specialised(plan) => !plan.contents.is_empty(),
            Self::Uber(uber) => uber.contents,
        };
        let has_body = |kind| bodies.contains(&kind);
        Parts {
            lenses: has_lenses,
            // The uber back end reads there which test it is.
            shapes: tests.iter().any(|t| !t.is_sprite()) || (matches!(self, Self::Uber(_)) && has_lenses),
            members: tests.contains(&VolumeTest::Members),
            fading_members: tests.contains(&VolumeTest::FadingMembers),
            fading: tests.iter().chain(&self.leaves()).any(|test| *test == VolumeTest::FadingMembers),
            sprites: tests.iter().any(|t| t.is_sprite()),
            own_sprites: tests.contains(&VolumeTest::OwnSprite),
            solids: tests.iter().any(|t| t.has_faces()),
            side_sprites: tests.iter().any(|t| t.has_sides()),
            combinations: tests.iter().any(|t| t.has_leaves()),
            combined_sprites: tests.contains(&VolumeTest::CombinedSprite),
            bodies: !bodies.is_empty(),
            outlines: bodies.iter().any(|b| b.has_outline()),
            shells: has_body(BodyKind::Shell),
            halos: has_body(BodyKind::Halo),
            distances: borders || has_body(BodyKind::Shell) || has_body(BodyKind::Halo),
            blends: blends || borders,
            lines,
            veils,
            contents,
            borders,
            by_ray,
        }
    }

    /// What the leaves of its combinations are, ascending, each once.
    pub fn leaves(&self) -> Vec<VolumeTest> {
        match self {
            Self::Specialised(plan) => {
                let mut all: Vec<VolumeTest> = plan.lenses.iter().flat_map(|l| &l.leaves).copied().collect();
                all.sort_unstable();
                all.dedup();
                all
            }
            Self::Uber(uber) => uber.leaves.clone(),
        }
    }

    /// The numbers of all handlers its text has, ascending.
    pub fn effects(&self) -> Vec<u32> {
        match self {
            Self::Specialised(plan) => plan.effects(),
            Self::Uber(uber) => uber.effects.clone(),
        }
    }
}

/// Which libraries a program calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// The classes of lenses.
    pub lenses: bool,
    /// The lens test from shapes.
    pub shapes: bool,
    /// The lens test by depth sprites.
    pub sprites: bool,
    /// By those that have their own eye.
    pub own_sprites: bool,
    /// Membership by object.
    pub members: bool,
    /// Membership by object where objects come or go.
    pub fading_members: bool,
    /// The same, also of leaves of combinations.
    pub fading: bool,
    /// The lens test from the faces of solids.
    pub solids: bool,
    /// The sides of solids and combinations by depth sprites.
    pub side_sprites: bool,
    /// The lens test from the leaves of combinations.
    pub combinations: bool,
    /// Their sides by depth sprites.
    pub combined_sprites: bool,
    /// Bodies.
    pub bodies: bool,
    /// Their silhouettes.
    pub outlines: bool,
    /// As glass.
    pub shells: bool,
    /// As a glow.
    pub halos: bool,
    /// How far a place is from a lens.
    pub distances: bool,
    /// Blend modes.
    pub blends: bool,
    /// Lines over what was shaded.
    pub lines: bool,
    /// Translucent layers over what was shaded.
    pub veils: bool,
    /// Contents of lenses.
    pub contents: bool,
    /// Soft borders of lenses.
    pub borders: bool,
    /// Borders of lenses along rays.
    pub by_ray: bool,
}

impl Plan {
    /// The numbers of all effects in it, ascending, each once.
    pub fn effects(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.steps.iter().map(|s| s.effect).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// What the bodies of its lenses are drawn as, ascending, each once.
    pub fn bodies(&self) -> Vec<BodyKind> {
        let mut kinds: Vec<BodyKind> = self.lenses.iter().filter_map(|l| l.body).map(|b| b.kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// Whether some lens fades.
    pub fn has_borders(&self) -> bool {
        self.borders().next().is_some()
    }

    /// The soft borders of its lenses that do something here.
    pub fn borders(&self) -> impl Iterator<Item = PlanBorder> {
        (0..self.lenses.len() as u32).filter_map(|lens| self.border_of(lens))
    }

    /// The soft border of one of its lenses that does something here.
    pub fn border_of(&self, lens: u32) -> Option<PlanBorder> {
        let acts = |s: &Step| matches!(s.scope, Scope::Lens(l, _) if l == lens);
        // What a lens shows fades by dithering alone.
        let shows = |b: &PlanBorder| b.dithers && self.contents.iter().any(|c| c.lens == lens);
        self.lenses[lens as usize].border.filter(|b| shows(b) || self.steps.iter().any(acts))
    }

    /// With lenses that end at once: from where a border is not told.
    pub fn without_borders(mut self) -> Self {
        self.lenses.iter_mut().for_each(|lens| lens.border = None);
        self
    }

    /// Whether some effect is a filter.
    pub fn has_filters(&self, handlers: &[EffectDefinition]) -> bool {
        self.steps.iter().any(|s| handlers[s.effect as usize].kind == EffectKind::Filter)
    }

    /// Whether some effect is blended.
    pub fn has_blends(&self) -> bool {
        self.steps.iter().any(|s| s.blend.is_some())
    }

    /// Volumes of all its lenses.
    pub fn volumes(&self) -> u32 {
        self.tests().count() as u32
    }

    /// How they are tested.
    pub fn tests(&self) -> impl Iterator<Item = VolumeTest> {
        self.lenses.iter().flat_map(|l| &l.volumes).copied()
    }

    /// Whether nobody asks for other classes of a lens than *inside*.
    pub fn asks_inside_alone(&self, lens: u32) -> bool {
        let is_other = |s: &Step| matches!(s.scope, Scope::Lens(l, class) if l == lens && class != ClassTest::Inside);
        let is_content = |c: &PlanContent| c.lens == lens && c.class != ClassTest::Inside;
        let is_apart = self.regions.as_ref().is_some_and(|regions| regions.asks_sides(lens));
        !is_apart && !self.masks && !self.steps.iter().any(is_other) && !self.contents.iter().any(is_content)
    }

    /// The volumes of one of its lenses: how many come before them, and how they are tested.
    pub fn volumes_of(&self, lens: u32) -> (u32, &[VolumeTest]) {
        let before = self.lenses[..lens as usize].iter().map(|l| l.volumes.len() as u32).sum();
        (before, &self.lenses[lens as usize].volumes)
    }

    /// Its steps of one prototype, in the order of their execution.
    pub fn steps_of<'a>(
        &'a self,
        kind: EffectKind,
        handlers: &'a [EffectDefinition],
    ) -> impl DoubleEndedIterator<Item = (&'a Step, &'a EffectDefinition)> {
        self.steps.iter().map(|s| (s, &handlers[s.effect as usize])).filter(move |(_, h)| h.kind == kind)
    }

    /// What of it says what is there; `None` where nothing is hidden.
    pub fn hiding(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let decides = |step: &&Step| handlers[step.effect as usize].kind.decides_visibility();
        let steps: Vec<Step> = self.steps.iter().filter(decides).cloned().collect();
        if steps.is_empty() && self.contents.is_empty() {
            return None;
        }
        let (mut lenses, contents) = (self.plain_lenses(), self.contents.clone());
        // What fades is translucent in all of its border.
        let fades = |lens: u32| {
            let mut rules = self.steps_of(EffectKind::Opacity, handlers);
            rules.any(|(step, _)| matches!(step.scope, Scope::Lens(l, _) if l == lens))
        };
        (0..).zip(&mut lenses).for_each(|(i, lens)| lens.border = lens.border.filter(|b| b.dithers || fades(i)));
        Some(Self { lenses, steps, contents, ..Self::default() })
    }

    /// What of it lines go through; `None` where nobody draws any.
    pub fn lining(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let steps = self.steps.iter().filter(|s| handlers[s.effect as usize].kind.touches_lines()).cloned().collect();
        self.lines.then(|| Self {
            lenses: self.plain_lenses(),
            steps,
            lines: true,
            contents: self.contents.clone(),
            ..Self::default()
        })
    }

    /// Its lenses for passes that ask for nothing but their volumes, which keep their places.
    fn plain_lenses(&self) -> Vec<PlanLens> {
        let lens = |(i, lens): (usize, &PlanLens)| PlanLens { number: i as u32, body: None, ..lens.clone() };
        self.lenses.iter().enumerate().map(lens).collect()
    }

    /// What of it says how things look.
    pub fn shading(mut self, handlers: &[EffectDefinition]) -> Self {
        self.veils = self.is_seen_through(handlers);
        self.steps.retain(|step| !handlers[step.effect as usize].kind.decides_visibility());
        self.contents.clear();
        self
    }

    /// What of it says how much of each translucent layer is seen, and how that looks; `None` where nothing is seen through.
    pub fn layering(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let is_of_layers =
            |step: &&Step| !matches!(handlers[step.effect as usize].kind, EffectKind::Hide | EffectKind::Filter);
        let steps = self.steps.iter().filter(is_of_layers).cloned().collect();
        let mut lenses = self.lenses.clone();
        lenses.iter_mut().for_each(|lens| lens.body = None);
        let all = Self { lenses, steps, haze: self.haze, masks: self.masks, ..Self::default() };
        self.is_seen_through(handlers).then_some(all)
    }

    fn is_seen_through(&self, handlers: &[EffectDefinition]) -> bool {
        self.steps_of(EffectKind::Opacity, handlers).next().is_some()
    }

    /// How many `vec4f` of the parameters it reads.
    pub fn slots(&self, handlers: &[EffectDefinition]) -> u32 {
        let of_steps = self.steps.iter().map(|s| s.end(&handlers[s.effect as usize]));
        let of_lines = self.lenses.iter().filter_map(|l| l.body.map(|b| b.parameters + BODY_SLOTS));
        let of_borders = self.lenses.iter().filter_map(|l| l.border.map(|b| b.parameters + 1));
        of_steps.chain(of_lines).chain(of_borders).max().unwrap_or(0)
    }
}

impl Step {
    /// Where its weight stands, if it is blended.
    pub fn weight(&self, handler: &EffectDefinition) -> Option<u32> {
        self.blend.map(|_| self.parameters + handler.slots() + u32::from(handler.kind == EffectKind::Filter))
    }

    /// Of a filter: where it stands which image holds what it made.
    pub fn image(&self, handler: &EffectDefinition) -> u32 {
        self.parameters + handler.slots()
    }

    /// The slot after its last one.
    fn end(&self, handler: &EffectDefinition) -> u32 {
        let is_filter = handler.kind == EffectKind::Filter;
        self.parameters + handler.slots() + u32::from(is_filter) + u32::from(self.blend.is_some())
    }

    /// Whether nothing of what is below it is left where it acts.
    pub fn replaces(&self, handler: &EffectDefinition) -> bool {
        self.blend.is_none() && !handler.reads_below
    }
}
