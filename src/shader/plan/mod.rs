//! Plans: what a scene asks of shading, the invoker table, from which both back ends are made.
//!
//! A [`Plan`] names handlers, lenses and classes, never positions or parameters: those stand in uniforms, so a lens that
//! moves or a slider that is dragged compiles nothing. Equal plans share a pipeline.

pub(super) mod content;
pub(super) mod epoch;
pub(super) mod form;
pub(super) mod lens;
pub(super) mod lens_test;
pub(super) mod program;
pub(super) mod regions;
pub(super) mod step;
pub(super) mod uber;

use crate::geom::shape::form::Extent;
use crate::shader::{
    effect::{definition::EffectDefinition, prototype::EffectKind},
    plan::{
        content::PlanContent,
        epoch::PlanEpoch,
        form::Form,
        lens::{BODY_SLOTS, BodyKind, PlanBorder, PlanLens},
        lens_test::LensTest,
        regions::Regions,
        step::{ClassTest, Scope, Step},
    },
};

/// Lenses that bend rays, of one picture at most.
pub const MOST_RAY_LENSES: usize = 8;
/// How many `vec4f` of numbers shaders have of each of these at most.
pub const RAY_NUMBERS: usize = 128;

/// How many lenses bend the rays of a picture: shaders are made for so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Bends {
    /// Those of the picture.
    pub images: u32,
    /// Those with planes.
    pub planes: u32,
    /// Whether some of them have grids.
    pub grids: bool,
    /// Whether fields tell the outlines of some.
    pub fields: bool,
    /// How many of them act on some objects alone.
    pub choosing: u32,
    /// Numbers of the ray handlers of users that some have, ascending; 0 behind these.
    pub own: [u16; MOST_RAY_LENSES],
}

impl Bends {
    /// Whether there are any.
    pub fn is_any(self) -> bool {
        self.images + self.planes > 0
    }

    /// Whether there is one alone.
    pub fn is_one(self) -> bool {
        self.images + self.planes == 1
    }
}

/// Lenses and effects of one part of the picture, bottom lens first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Plan {
    /// Lenses that may be seen there.
    pub lenses: Vec<PlanLens>,
    /// The uses of effects, bottom lens first; prototypes have an order of their own ([`EffectKind::ALL`]).
    pub steps: Vec<Step>,
    /// Whether the air shows.
    pub haze: bool,
    /// Whether every pixel's classes are written down, for AOVs and statistics.
    pub masks: bool,
    /// Whether some effect draws lines.
    pub lines: bool,
    /// Whether something is seen through: what shading lays over its picture.
    pub transparency: bool,
    /// Whether some materials let through what is behind them, whatever lenses do.
    pub clear_materials: bool,
    /// The contents of its lenses, bottom lens first.
    pub contents: Vec<PlanContent>,
    /// Whether objects come and go: each place shows a moment.
    pub timed: bool,
    /// Whether some may be there by halves: at some of several moments, or as ghosts.
    pub partly: bool,
    /// Whether some move, each drawn for the moments that may show of it.
    pub moves: bool,
    /// Whether some look otherwise at other moments.
    pub varies: bool,
    /// How many lenses bend the rays of some pixels.
    pub bends: Bends,
    /// Whether fields stand in the city.
    pub fields: bool,
    /// Whether the frame shows what is under the sun of one of several moments alone; then looks vary, too.
    pub lit: bool,
    /// The time operators of its lenses, bottom lens first.
    pub epochs: Vec<PlanEpoch>,
    /// How places are told apart, for the techniques that are kept for reference; `None`: by accumulation.
    pub regions: Option<Regions>,
}

impl Plan {
    /// The numbers of all effects in it, ascending, each once.
    pub fn effects(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.steps.iter().map(|s| s.effect).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Kinds of bodies of its lenses, ascending, each once.
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
        // Contents and moments fade by dithering alone.
        let has_moment = || self.epochs.iter().any(|e| e.lens == lens);
        let shows = |b: &PlanBorder| b.dithers && (self.contents.iter().any(|c| c.lens == lens) || has_moment());
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

    /// Whether one of its lenses does anything to how places look that are there: it has an effect that does, a body or a content, or is asked
    /// for.
    pub fn is_looked_at(&self, lens: u32, handlers: &[EffectDefinition]) -> bool {
        let acts = |s: &Step| {
            let is_its = matches!(s.scope, Scope::Lens(l, _) if l == lens);
            is_its && handlers[s.effect as usize].kind != EffectKind::Hide
        };
        let shows = || self.contents.iter().any(|c| c.lens == lens);
        let varies = || self.varies && self.epochs.iter().any(|e| e.lens == lens);
        self.masks || self.lenses[lens as usize].body.is_some() || shows() || varies() || self.steps.iter().any(acts)
    }

    /// Volumes of all its lenses.
    pub fn volumes(&self) -> u32 {
        self.tests().count() as u32
    }

    /// How they are tested.
    pub fn tests(&self) -> impl Iterator<Item = LensTest> {
        self.lenses.iter().flat_map(|l| &l.volumes).copied()
    }

    /// Whether no other classes of a lens than *inside* are asked for.
    pub fn asks_inside_alone(&self, lens: u32) -> bool {
        let is_other = |s: &Step| matches!(s.scope, Scope::Lens(l, class) if l == lens && class != ClassTest::Inside);
        let is_content = |c: &PlanContent| c.lens == lens && c.class != ClassTest::Inside;
        let is_apart = self.regions.as_ref().is_some_and(|regions| regions.asks_sides(lens));
        !is_apart && !self.masks && !self.steps.iter().any(is_other) && !self.contents.iter().any(is_content)
    }

    /// The volumes of one of its lenses: how many come before them, and how they are tested.
    pub fn volumes_of(&self, lens: u32) -> (u32, &[LensTest]) {
        let before = self.lenses[..lens as usize].iter().map(|l| l.volumes.len() as u32).sum();
        (before, &self.lenses[lens as usize].volumes)
    }

    /// Whether one lens is one convex body, tested by its own numbers.
    pub fn is_convex(&self, lens: u32) -> bool {
        let (_, tests) = self.volumes_of(lens);
        matches!(tests, [LensTest::Numbers(Form::Volume(form))] if form.extent() == Extent::Convex)
    }

    /// Its steps of one prototype, in the order of their execution.
    pub fn steps_of<'a>(
        &'a self,
        kind: EffectKind,
        handlers: &'a [EffectDefinition],
    ) -> impl DoubleEndedIterator<Item = (&'a Step, &'a EffectDefinition)> {
        self.steps.iter().map(|s| (s, &handlers[s.effect as usize])).filter(move |(_, h)| h.kind == kind)
    }

    /// The part that decides which fragments are there; `None` where nothing is hidden.
    pub fn hiding(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let decides = |step: &&Step| handlers[step.effect as usize].kind.decides_visibility();
        let steps: Vec<Step> = self.steps.iter().filter(decides).cloned().collect();
        if steps.is_empty() && self.contents.is_empty() && !self.clear_materials && !self.timed {
            return None;
        }
        let (mut lenses, contents, epochs) = (self.plain_lenses(), self.contents.clone(), self.epochs.clone());
        // A lens that fades is translucent in all of its border.
        let fades = |lens: u32| {
            let mut rules = self.steps_of(EffectKind::Opacity, handlers);
            rules.any(|(step, _)| matches!(step.scope, Scope::Lens(l, _) if l == lens))
        };
        (0..).zip(&mut lenses).for_each(|(i, lens)| lens.border = lens.border.filter(|b| b.dithers || fades(i)));
        let Self { clear_materials, timed, partly, moves, bends, .. } = *self;
        Some(Self { lenses, steps, contents, epochs, clear_materials, timed, partly, moves, bends, ..Self::default() })
    }

    /// The part that lines go through; `None` where no effect draws lines.
    pub fn lining(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        let steps = self.steps.iter().filter(|s| handlers[s.effect as usize].kind.touches_lines()).cloned().collect();
        self.lines.then(|| Self {
            lenses: self.plain_lenses(),
            steps,
            lines: true,
            contents: self.contents.clone(),
            timed: self.timed,
            partly: self.partly,
            moves: self.moves,
            bends: self.bends,
            epochs: self.epochs.clone(),
            ..Self::default()
        })
    }

    /// Its lenses for passes that ask for nothing but their volumes, which keep their places.
    fn plain_lenses(&self) -> Vec<PlanLens> {
        let lens = |(i, lens): (usize, &PlanLens)| PlanLens { number: i as u32, body: None, ..lens.clone() };
        self.lenses.iter().enumerate().map(lens).collect()
    }

    /// The part that decides how surfaces look.
    pub fn shading(mut self, handlers: &[EffectDefinition]) -> Self {
        self.transparency = self.is_seen_through(handlers);
        self.clear_materials = false;
        self.fields = false;
        self.steps.retain(|step| !handlers[step.effect as usize].kind.decides_visibility());
        self.contents.clear();
        self.moves = false;
        if !self.varies {
            self.epochs.clear();
            (self.timed, self.partly) = (false, false);
        }
        self
    }

    /// The part that decides how much of each translucent layer is seen, and how that looks; `None` where nothing is seen
    /// through.
    pub fn layering(&self, handlers: &[EffectDefinition]) -> Option<Self> {
        // What hides cuts fields, too, where they are laid.
        let is_of_layers = |step: &&Step| match handlers[step.effect as usize].kind {
            EffectKind::Hide => self.fields,
            kind => kind != EffectKind::Filter,
        };
        let steps = self.steps.iter().filter(is_of_layers).cloned().collect();
        let mut lenses = self.lenses.clone();
        lenses.iter_mut().for_each(|lens| lens.body = None);
        let Self { haze, masks, clear_materials, partly, varies, bends, fields, .. } = *self;
        let moves = partly && self.moves;
        // What is there by halves is asked how much of it.
        let timed = partly || varies;
        let epochs = if timed { self.epochs.clone() } else { Vec::new() };
        let all = Self {
            lenses,
            steps,
            haze,
            masks,
            clear_materials,
            timed,
            partly,
            moves,
            varies,
            bends,
            fields,
            epochs,
            ..Self::default()
        };
        self.is_seen_through(handlers).then_some(all)
    }

    fn is_seen_through(&self, handlers: &[EffectDefinition]) -> bool {
        self.clear_materials
            || self.fields
            || self.partly
            || self.steps_of(EffectKind::Opacity, handlers).next().is_some()
    }

    /// How many `vec4f` of the parameters it reads.
    pub fn slots(&self, handlers: &[EffectDefinition]) -> u32 {
        let of_steps = self.steps.iter().map(|s| s.end(&handlers[s.effect as usize]));
        let of_lines = self.lenses.iter().filter_map(|l| l.body.map(|b| b.parameters + BODY_SLOTS));
        let of_borders = self.lenses.iter().filter_map(|l| l.border.map(|b| b.parameters + 1));
        of_steps.chain(of_lines).chain(of_borders).max().unwrap_or(0)
    }

    /// The plan of one region, where no class is left to test.
    pub fn of_region(&self, region: u32) -> Self {
        let own = self.regions.as_ref().map_or_else(Vec::new, |regions| regions.classes_of(region));
        let is_own = |scope| match scope {
            Scope::Everywhere => true,
            Scope::Lens(lens, class) => own.contains(&(lens, class)),
        };
        let steps = self.steps.iter().filter(|s| is_own(s.scope)).cloned();
        let everywhere = steps.map(|mut step| {
            step.scope = Scope::Everywhere;
            step
        });
        Self { steps: everywhere.collect(), haze: self.haze, ..Self::default() }
    }
}
