//! Modules of the uber back end: they hold whatever any plan of the scene may name.

use crate::shader::{
    effect::{definition::EffectDefinition, prototype::EffectKind},
    plan::{Bends, form::Form, lens::BodyKind, lens_test::LensTest},
};

/// Contents of a module of the uber back end: whatever any plan of the scene may name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Uber {
    /// The scene's effects, ascending, each once; those of disabled lenses too.
    pub effects: Vec<u32>,
    /// How the volumes of the scene's lenses are tested, ascending, each once; none: there are no lenses.
    pub tests: Vec<LensTest>,
    /// Forms of the leaves of their combinations, ascending, each once.
    pub leaves: Vec<Form>,
    /// Kinds of their bodies, ascending, each once.
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
    pub transparency: bool,
    /// Whether some materials let through what is behind them, whatever lenses do.
    pub clear_materials: bool,
    /// Whether some lenses have own content.
    pub contents: bool,
    /// Whether objects come and go.
    pub timed: bool,
    /// Whether some may be there by halves.
    pub partly: bool,
    /// Whether some move.
    pub moves: bool,
    /// Whether some look otherwise at other moments.
    pub varies: bool,
    /// How many lenses bend the rays of some pixels.
    pub bends: Bends,
    /// Whether fields stand in the city.
    pub fields: bool,
    /// Whether a frame shows what is under the sun of one of several moments alone.
    pub lit: bool,
    /// The time operators of the scene's lenses, ascending, each once.
    pub epochs: Vec<u32>,
}

impl Uber {
    /// The part that decides which fragments are there; `None` where nothing may be hidden.
    pub fn hiding(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let effects = self.of(handlers, EffectKind::decides_visibility);
        (!effects.is_empty() || self.contents || self.clear_materials || self.timed).then(|| Self {
            effects,
            tests: self.tests.clone(),
            leaves: self.leaves.clone(),
            contents: self.contents,
            timed: self.timed,
            partly: self.partly,
            moves: self.moves,
            epochs: self.epochs.clone(),
            sides: self.sides,
            borders: self.dithers || (self.borders && self.is_seen_through(handlers)),
            by_ray: self.by_ray,
            clear_materials: self.clear_materials,
            bends: self.bends,
            ..Self::default()
        })
    }

    /// Whether no other classes of lenses than *inside* are asked for.
    pub fn asks_inside_alone(&self) -> bool {
        !self.sides && !self.masks
    }

    /// The part that lines go through; `None` where no effect draws lines.
    pub fn lining(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let effects = self.of(handlers, EffectKind::touches_lines);
        let (tests, leaves) = (self.tests.clone(), self.leaves.clone());
        let Self { sides, borders, by_ray, dithers, contents, timed, partly, moves, blends, bends, .. } = *self;
        let epochs = self.epochs.clone();
        let all = Self {
            effects,
            tests,
            leaves,
            sides,
            borders,
            by_ray,
            dithers,
            contents,
            timed,
            partly,
            moves,
            bends,
            epochs,
            ..Self::default()
        };
        self.lines.then_some(Self { blends, lines: true, ..all })
    }

    /// The part that decides how surfaces look.
    pub fn shading(self, handlers: &[EffectDefinition]) -> Self {
        let transparency = self.is_seen_through(handlers);
        let effects = self.of(handlers, |kind| !kind.decides_visibility());
        let all = Self {
            effects,
            transparency,
            contents: false,
            clear_materials: false,
            fields: false,
            moves: false,
            ..self
        };
        if all.varies { all } else { Self { timed: false, partly: false, epochs: Vec::new(), ..all } }
    }

    /// The part that decides how much of each translucent layer is seen, and how that looks; `None` where nothing is seen
    /// through.
    pub fn layering(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let is_of_layers = |kind| match kind {
            EffectKind::Hide => self.fields,
            kind => kind != EffectKind::Filter,
        };
        let effects = self.of(handlers, is_of_layers);
        let is_timed = self.partly || self.varies;
        let epochs = if is_timed { self.epochs.clone() } else { Vec::new() };
        let moves = self.partly && self.moves;
        let timed = Self { timed: is_timed, moves, epochs, contents: false, ..self.clone() };
        let all = Self { effects, bodies: Vec::new(), lines: false, transparency: false, ..timed };
        self.is_seen_through(handlers).then_some(all)
    }

    fn is_seen_through(&self, handlers: &[EffectDefinition]) -> bool {
        self.clear_materials
            || self.fields
            || self.partly
            || self.effects.iter().any(|&e| handlers[e as usize].kind == EffectKind::Opacity)
    }

    fn of(&self, handlers: &[EffectDefinition], is_wanted: impl Fn(EffectKind) -> bool) -> Vec<u32> {
        self.effects.iter().copied().filter(|&e| is_wanted(handlers[e as usize].kind)).collect()
    }
}
