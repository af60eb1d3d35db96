//! What the context and the lenses do, as one list: bottom lens first.

use std::sync::Arc;

use crate::{
    city::{CityModel, lifetime::Lifetimes},
    lens::{
        BorderUnit, Class, Discrete, EffectUse, Lens, LensBody, Parameter,
        chosen::{Choice, ChoiceError, chosen, members},
        effect::{default_of, in_floats, ramp},
        thematic::ThematicScale,
    },
    render::{
        epochs::{Epochs, MetLenses},
        hiding::Presence,
        palette,
        placed_region::Members,
    },
    scene::sized::POINTS,
    shader::{
        self, Bends, Blend, BodyKind, ClassTest, Clip, EffectDefinition, EffectKind, Form, LensTest, PerObject, Plan,
        PlanBody, PlanBorder, PlanContent, PlanEpoch, PlanLens, Scope, Step, Uber, effect::COMING_LINES,
    },
    time::Moment,
};

/// The word of the object values from which on it is said under which sun a frame is: `lib/varying.wgsl` has the same.
const LIT_MOMENT: usize = 21;

/// Width of a lens outline, points.
const OUTLINE_PT: f64 = 1.2;
/// And pixels at most: it is looked for pixel by pixel, and of loops software adapters go 65,535 rounds in all.
const WIDEST_OUTLINE_PX: f64 = 8.0;
/// How far the glow around a lens goes, points.
const HALO_PT: f64 = 13.5;

/// How wide the line or the glow of a lens' body is, pixels. `point_px`: pixels of a point.
pub fn body_px(is_halo: bool, point_px: f64) -> f64 {
    if is_halo { HALO_PT * point_px } else { (OUTLINE_PT * point_px).min(WIDEST_OUTLINE_PX) }
}

/// Different neighbourhood filters of a picture: each takes four of an image's 256 layers, of a transparent picture eight.
pub const MOST_FILTERS: usize = 32;

/// One use of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// Index into [`shader::handlers`].
    pub effect: u32,
    /// Its first slot of the parameters.
    pub parameters: u32,
    /// Which lens, or `None`: everywhere.
    pub lens: Option<u32>,
    /// On which of its classes.
    pub class: Class,
    /// How it is laid over what is below.
    pub blend: Option<Blend>,
    /// Of an opacity rule, what it makes translucent where its class is.
    pub translucent: Option<Translucent>,
}

/// What an opacity rule acts on, as [`EffectDefinition::acts_on`] asks it of fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Translucent {
    /// Whatever object it is.
    pub all_objects: bool,
    /// Terrain too.
    pub terrain: bool,
}

impl Operation {
    /// Whether it acts on what is inside one of these lenses, which ascend.
    fn is_in(&self, lenses: &[u32]) -> bool {
        self.class == Class::Inside && self.lens.is_some_and(|lens| lenses.binary_search(&lens).is_ok())
    }

    fn is_filter(&self) -> bool {
        shader::handlers()[self.effect as usize].kind == EffectKind::Filter
    }
}

/// What a lens shows in place of what is below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContentUse {
    /// Which lens.
    pub lens: u32,
    /// On which of its classes.
    pub class: Class,
    /// Number of the city that it shows, from 1.
    pub city: u32,
    /// What becomes of what is below.
    pub clip: Clip,
    /// Whether terrain stays as it is below.
    pub keeps_terrain: bool,
}

/// A time operator of a lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpochUse {
    /// Which lens.
    pub lens: u32,
    /// Index into [`shader::handlers`].
    pub handler: u32,
    /// Where its words begin among the object values.
    pub words: u32,
    /// The bit of its lens in what is known of objects.
    pub bit: u32,
}

/// When objects are there, and what lenses do to that.
#[derive(Clone, Debug, Default)]
pub struct SceneTime {
    /// The moments that show.
    pub epochs: Epochs,
    /// Of the scene's own city, then of contents.
    pub lifetimes: Vec<Arc<Lifetimes>>,
    /// Which lenses may hold which objects.
    pub met: MetLenses,
    /// Whether objects move, and the moments for which these are drawn.
    pub moves: bool,
    /// See `moves`.
    pub moving: Vec<Option<Moment>>,
    /// Whether fields show other steps in time at other moments.
    pub fields_vary: bool,
    /// The moments whose suns shine somewhere, the scene's own first; empty: one sun is everywhere.
    pub suns: Vec<Option<Moment>>,
}

/// What operations are made of beside lenses and cities.
#[derive(Clone, Copy, Debug)]
pub struct Beside<'a> {
    /// What effects read of each lens.
    pub tables: &'a LensTables,
    /// When objects are there.
    pub time: &'a SceneTime,
    /// Pixels of a point, which some parameters are given in.
    pub point_px: f64,
}

/// A neighbourhood filter of a frame: one for all uses that would make the same image.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    /// Its handler.
    pub effect: u32,
    /// Whose it is, `None`: the context's; and the slot of the parameters where each of them reads which image it is.
    pub uses: Vec<(Option<u32>, u32)>,
    /// Its first slot of the parameters.
    pub parameters: u32,
    /// How far it looks to either side, pixels.
    pub reach: u32,
    /// What makes the image that it filters.
    pub plan: Plan,
}

/// What effects read of the lens that has them, one table per lens.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LensTables {
    /// Where in the picture its points of interest are ([`crate::render::sights`]).
    pub sights: Vec<Vec<u32>>,
    /// What objects cover of the ground ([`crate::render::footprints`]).
    pub footprints: Vec<Vec<u32>>,
}

/// How the volumes of all lenses of a scene may be tested.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AllTests {
    /// In the picture.
    pub picture: Vec<LensTest>,
    /// From the sun.
    pub sun: Vec<LensTest>,
    /// What the leaves of combinations are.
    pub leaves: Vec<Form>,
}

/// The operations of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operations {
    /// Effects in order.
    pub list: Vec<Operation>,
    /// What lenses show in themselves, bottom lens first.
    pub contents: Vec<ContentUse>,
    /// Whether objects come and go.
    pub timed: bool,
    /// Whether some may be there by halves.
    pub partly: bool,
    /// Whether some move.
    pub moves: bool,
    /// Whether some look otherwise at other moments.
    pub varies: bool,
    /// The moments whose suns shine somewhere, the scene's own first; empty: one sun is everywhere.
    pub suns: Vec<Option<Moment>>,
    /// How many lenses bend the rays of some pixels.
    pub bends: Bends,
    /// Whether fields stand in the city.
    pub fields: bool,
    /// Which objects of the scene's own city that is.
    pub presence: Arc<[Presence]>,
    /// What lenses do to the moment, bottom lens first.
    pub epochs: Vec<EpochUse>,
    /// Lenses whose bodies are drawn, and how.
    pub bodies: Vec<(u32, PlanBody)>,
    /// Lenses with soft borders, and these.
    pub borders: Vec<(u32, PlanBorder)>,
    /// Parameters of all of them, in slots of four.
    pub parameters: Vec<[f32; 4]>,
    /// What effects read of each object, one run per use: colours, sRGB bytes; or whether it is chosen, that of no object
    /// first. Objects of contents follow the city's.
    pub object_values: Vec<u32>,
    /// What any frame of the scene may ask for, disabled lenses included.
    uber: Uber,
    /// How their volumes are tested where sprites say nothing: for the sun.
    shape_tests: Vec<LensTest>,
}

impl Operations {
    /// The operations of the context's effects and of the enabled lenses that have a volume; `visible[i]` says
    /// whether lens i has one. `tests`: of the volumes of all lenses, in the picture and from the sun, and what leaves their combinations have. Thematic colours are
    /// those of the objects of `models`, the scene's own city first, by the first one's scale.
    pub fn new(
        context: &[EffectUse],
        lenses: &[Lens],
        visible: &[bool],
        tests: AllTests,
        models: &[&CityModel],
        beside: &Beside,
    ) -> Result<Self, ChoiceError> {
        let Beside { tables, time, point_px } = *beside;
        let mut out =
            Self { uber: Self::uber_of(context, lenses), shape_tests: each_once(tests.sun), ..Self::default() };
        out.add_time(time, visible, models);
        out.add_coming(time);
        out.uber.tests = each_once(tests.picture);
        out.uber.leaves = each_once(tests.leaves);
        // Lenses of no volume at all have no bodies.
        if out.uber.tests.is_empty() {
            out.uber.bodies.clear();
        }
        let epochs = &time.epochs;
        let coming = EffectUse::new(COMING_LINES);
        let is_coming = |effect: &EffectUse| effect.effect == COMING_LINES;
        let shows_all = context.iter().any(is_coming);
        let of_scene = (out.partly && epochs.draws_future(None) && !shows_all).then_some(&coming);
        for effect in context.iter().chain(of_scene) {
            out.add(effect, None, models, tables, point_px)?;
        }
        let active = || lenses.iter().enumerate().filter(|(i, _)| visible.get(*i) == Some(&true));
        for (i, lens) in active() {
            let number = i as u32;
            let is_drawn = shows_all || of_scene.is_some() || lens.uses().any(is_coming);
            let of_ghosts = (out.partly && epochs.draws_future(Some(number)) && !is_drawn).then_some(&coming);
            for effect in lens.uses().chain(of_ghosts) {
                out.add(effect, Some(number), models, tables, point_px)?;
            }
        }
        for (i, lens) in active() {
            let Some(kind) = body_kind(lens.drawn_body()) else { continue };
            let [r, g, b] = palette::linear(lens.color);
            out.bodies.push((i as u32, PlanBody { kind, parameters: out.parameters.len() as u32 }));
            let width = body_px(kind == BodyKind::Halo, point_px) as f32;
            out.parameters.extend([[r, g, b, 0.92], [width, 0.0, 0.0, 0.0]]);
        }
        for (i, lens) in active() {
            let Some(border) = lens.soft_border() else { continue };
            let parameters = out.parameters.len() as u32;
            let by_ray = border.unit == BorderUnit::Ray;
            // What is there or not is asked of a border along rays as of one that dithers: all of it, or nothing.
            let dithers = by_ray || border.discrete == Discrete::Dither;
            let flags = [border.unit == BorderUnit::Pixels, dithers, by_ray];
            let [in_pixels, dithered, along] = flags.map(|is| f32::from(u8::from(is)));
            out.borders.push((i as u32, PlanBorder { parameters, dithers, by_ray }));
            out.parameters.push([border.width as f32, in_pixels, dithered, along]);
        }
        Ok(out)
    }

    /// Puts when objects are there among the values of objects, before all else: where it begins, shaders know.
    fn add_time(&mut self, time: &SceneTime, visible: &[bool], models: &[&CityModel]) {
        let has_histories = models.iter().any(|model| !model.histories.is_empty());
        let has_any = || time.lifetimes.iter().any(|lifetimes| lifetimes.has_any());
        let is_lit = !time.suns.is_empty();
        self.varies = is_lit || time.fields_vary || (time.epochs.is_any() && has_histories);
        self.suns.clone_from(&time.suns);
        self.uber.lit = is_lit;
        self.timed = time.moves || self.varies || (time.epochs.is_any() && has_any());
        if !self.timed {
            return;
        }
        self.partly = time.epochs.is_partly(&time.lifetimes);
        self.presence = time.lifetimes.first().map_or_else(Vec::new, |own| time.epochs.presence(own, &time.met)).into();
        let (words, begins) = time.epochs.words(&time.lifetimes, &time.met, &time.moving);
        let lenses = time.epochs.lenses();
        self.object_values = words;
        let operators = time.epochs.operators.iter().zip(begins);
        let uses = operators.map(|((lens, operator), words)| {
            let bit = lenses.binary_search(lens).unwrap_or_default() as u32;
            EpochUse { lens: *lens, handler: operator.handler, words, bit }
        });
        self.epochs = uses.filter(|used| visible.get(used.lens as usize) == Some(&true)).collect();
        self.moves = time.moves;
        self.uber.varies = self.varies;
        (self.uber.timed, self.uber.partly, self.uber.moves) = (true, self.partly, self.moves);
        self.uber.epochs = each_once(time.epochs.operators.iter().map(|(_, operator)| operator.handler).collect());
    }

    /// Has modules of the uber back end draw the edges of what is not there yet.
    fn add_coming(&mut self, time: &SceneTime) {
        let epochs = &time.epochs;
        let draws =
            epochs.draws_future(None) || epochs.lenses().into_iter().any(|lens| epochs.draws_future(Some(lens)));
        if self.partly && draws {
            self.uber.effects.extend(shader::effect::number_of(COMING_LINES));
            self.uber.effects = each_once(std::mem::take(&mut self.uber.effects));
            self.uber.lines = true;
        }
    }

    /// Has rays of some pixels be bent.
    pub fn bend_rays(&mut self, by: Bends) {
        (self.bends, self.uber.bends) = (by, by);
    }

    /// Has fields stand in the city.
    pub fn add_fields(&mut self) {
        (self.fields, self.uber.fields) = (true, true);
    }

    /// The same for a frame under the sun of one of its moments.
    pub fn under_sun(&self, number: usize) -> Self {
        let mut own = self.clone();
        let [hour, micro] = self.suns.get(number).copied().flatten().map_or(Moment::TIMELESS, Moment::words);
        own.object_values[LIT_MOMENT..LIT_MOMENT + 3].copy_from_slice(&[hour, micro, u32::from(number == 0)]);
        own
    }

    /// What one module of the uber back end has to hold for this scene.
    fn uber_of(context: &[EffectUse], lenses: &[Lens]) -> Uber {
        let uses = || context.iter().chain(lenses.iter().flat_map(Lens::uses));
        let mut effects: Vec<u32> = uses().filter_map(|e| shader::effect::number_of(&e.effect)).collect();
        effects.sort_unstable();
        effects.dedup();
        Uber {
            effects,
            bodies: {
                let mut kinds: Vec<BodyKind> = lenses.iter().filter_map(|l| body_kind(l.drawn_body())).collect();
                kinds.sort_unstable();
                kinds.dedup();
                kinds
            },
            sides: lenses.iter().any(|l| l.classes().any(|class| class != Class::Inside)),
            borders: lenses.iter().any(|l| l.soft_border().is_some()),
            dithers: lenses
                .iter()
                .any(|l| l.soft_border().is_some_and(|b| b.discrete == Discrete::Dither || b.unit == BorderUnit::Ray)),
            by_ray: lenses.iter().any(|l| l.soft_border().is_some_and(|b| b.unit == BorderUnit::Ray)),
            blends: uses().any(|e| blend_of(e).is_some()),
            lines: uses().any(|e| shader::effect::find(&e.effect).is_some_and(|h| h.lines)),
            contents: lenses.iter().any(|l| l.shown().is_some()),
            ..Uber::default()
        }
    }

    /// The uber back end's module for a frame of the scene.
    pub fn uber(&self, haze: bool, masks: bool, clear_materials: bool) -> Uber {
        Uber { haze, masks, clear_materials, ..self.uber.clone() }.shading(shader::handlers())
    }

    /// The uber back end's module of lines, where some may be drawn.
    pub fn uber_lining(&self) -> Option<Uber> {
        self.uber.lining(shader::handlers())
    }

    /// The uber back end's module of translucent layers, where there may be some.
    pub fn uber_layering(&self, haze: bool, masks: bool, clear_materials: bool) -> Option<Uber> {
        Uber { haze, masks, clear_materials, ..self.uber.clone() }.layering(shader::handlers())
    }

    /// Whether no lens of the scene does anything to how places look that are there: they take away, or show another moment.
    pub fn looks_like_context(&self) -> bool {
        let hides = |o: &Operation| shader::handlers()[o.effect as usize].kind == EffectKind::Hide;
        let is_of_lens = |o: &&Operation| o.lens.is_some();
        !self.varies
            && self.bodies.is_empty()
            && self.contents.is_empty()
            && self.list.iter().filter(is_of_lens).all(hides)
    }

    /// Whether a lens of the scene has own content, in whatever frame, or something moves.
    pub fn may_show_contents(&self) -> bool {
        self.uber.contents || self.uber.moves
    }

    /// Whether the context or an enabled lens draws lines.
    pub fn draws_lines(&self) -> bool {
        self.list.iter().any(|o| shader::handlers()[o.effect as usize].lines)
    }

    /// The uber back end's part of the modules of geometry and shadow, where something may be hidden.
    pub fn uber_hiding(&self, clear_materials: bool) -> [Option<Uber>; 2] {
        let picture = Uber { clear_materials, ..self.uber.clone() }.hiding(shader::handlers());
        let sun = self.uber.hiding(shader::handlers());
        let sun = sun.map(|uber| Uber { tests: self.shape_tests.clone(), borders: false, by_ray: false, ..uber });
        [picture, sun]
    }

    /// What shading has to do outside all lenses.
    pub fn context_plan(&self, haze: bool) -> Plan {
        let steps = self.steps(&[], |_| None);
        let Self { timed, partly, moves, varies, bends, fields, .. } = *self;
        let lit = !self.suns.is_empty();
        Plan {
            lines: draws_lines(&steps),
            steps,
            haze,
            timed,
            partly,
            moves,
            varies,
            bends,
            fields,
            lit,
            ..Plan::default()
        }
    }

    /// What shading has to do where lenses may be seen; `seen` holds each seen volume's lens, ascending, and how it is
    /// tested, and what the leaves of a combination are. Nothing is inside the lenses `empty`, which ascend. With `masks` every pixel's
    /// classes are written down.
    pub fn lens_plan(&self, seen: &[(u32, LensTest, Vec<Form>)], empty: &[u32], haze: bool, masks: bool) -> Plan {
        let mut lenses: Vec<PlanLens> = Vec::new();
        let mut numbers = Vec::new();
        for (lens, test, leaves) in seen {
            let (lens, test) = (*lens, *test);
            if numbers.last() == Some(&lens) {
                let of = &mut lenses[numbers.len() - 1];
                of.volumes.push(test);
                of.leaves = each_once([&of.leaves[..], leaves].concat());
                continue;
            }
            let body = of_lens(&self.bodies, lens);
            // Without masks nobody asks for a lens' number: equal plans are equal then.
            let number = if masks { lens } else { numbers.len() as u32 };
            let border = of_lens(&self.borders, lens);
            lenses.push(PlanLens { number, volumes: vec![test], leaves: leaves.clone(), body, border });
            numbers.push(lens);
        }
        let place = |lens| numbers.binary_search(&lens).ok().map(|i| i as u32);
        let steps = self.steps(empty, place);
        let content = |c: &ContentUse| {
            let (lens, class) = (place(c.lens)?, class_test(c.class));
            Some(PlanContent { lens, class, city: c.city, clip: c.clip, keeps_terrain: c.keeps_terrain })
        };
        let contents = self.contents.iter().filter_map(content).collect();
        let epoch = |e: &EpochUse| {
            let is_empty = empty.binary_search(&e.lens).is_ok();
            let lens = place(e.lens).filter(|_| !is_empty)?;
            Some(PlanEpoch { lens, handler: e.handler, words: e.words, bit: e.bit })
        };
        let epochs = self.epochs.iter().filter_map(epoch).collect();
        let lines = draws_lines(&steps);
        let Self { timed, partly, moves, varies, bends, fields, .. } = *self;
        let lit = !self.suns.is_empty();
        let of_time = Plan { timed, partly, moves, varies, bends, fields, lit, epochs, ..Plan::default() };
        Plan { lenses, steps, haze, masks, lines, contents, ..of_time }
    }

    /// The list as steps; `place` finds a lens in the plan.
    fn steps(&self, empty: &[u32], place: impl Fn(u32) -> Option<u32>) -> Vec<Step> {
        let step = |operation: &Operation| {
            let scope = match operation.lens {
                None => Scope::Everywhere,
                Some(lens) => Scope::Lens(place(lens)?, class_test(operation.class)),
            };
            Some(Step { effect: operation.effect, scope, parameters: operation.parameters, blend: operation.blend })
        };
        self.list.iter().filter(|o| !o.is_in(empty)).filter_map(step).collect()
    }

    /// The neighbourhood filters of the context and of the lenses `seen`, which ascend as those do in which nothing is, in the order of
    /// their images: each with the
    /// plan of the image it filters. That is its lens' own, unmasked: what the context does, then what the lens does to
    /// the same class before it.
    pub fn filters(&self, seen: &[u32], empty: &[u32], haze: bool) -> Vec<Filter> {
        if !self.list.iter().any(Operation::is_filter) {
            return Vec::new();
        }
        let hides = |o: &Operation| shader::handlers()[o.effect as usize].kind.decides_visibility();
        let is_seen = |o: &&Operation| {
            !hides(o) && !o.is_in(empty) && o.lens.is_none_or(|lens| seen.binary_search(&lens).is_ok())
        };
        let operations: Vec<&Operation> = self.list.iter().filter(is_seen).collect();
        let filter = |(i, operation): (usize, &&Operation)| {
            let is_own = |o: &Operation| o.lens.is_none() || (o.lens, o.class) == (operation.lens, operation.class);
            let step = |o: &&Operation| {
                is_own(o).then_some(Step {
                    effect: o.effect,
                    scope: Scope::Everywhere,
                    parameters: o.parameters,
                    blend: o.blend,
                })
            };
            let steps = operations[..i].iter().filter_map(step);
            Filter {
                effect: operation.effect,
                uses: vec![(operation.lens, operation.parameters + slots_of(operation))],
                parameters: operation.parameters,
                reach: self.parameters[operation.parameters as usize][0].ceil() as u32,
                plan: Plan { steps: steps.collect(), haze, bends: self.bends, ..Plan::default() },
            }
        };
        let mut filters: Vec<Filter> = Vec::new();
        let numbers = |f: &Filter| {
            let first = f.parameters as usize;
            &self.parameters[first..first + shader::handlers()[f.effect as usize].slots() as usize]
        };
        for mut one in operations.iter().enumerate().filter(|(_, o)| o.is_filter()).map(filter) {
            let makes_it = |f: &&mut Filter| (f.effect, &f.plan, numbers(f)) == (one.effect, &one.plan, numbers(&one));
            match filters.iter_mut().find(makes_it) {
                Some(same) => same.uses.append(&mut one.uses),
                None => filters.push(one),
            }
        }
        filters
    }

    /// How many uses of filters there are.
    pub fn filter_count(&self) -> u64 {
        self.list.iter().filter(|operation| operation.is_filter()).count() as u64
    }

    /// How far filters look at most, one after the other, pixels.
    pub fn reach(&self) -> u32 {
        let filters = self.list.iter().filter(|operation| operation.is_filter());
        filters.map(|filter| self.parameters[filter.parameters as usize][0].ceil() as u32).sum()
    }

    /// Marks objects for a lens test by object, of `count` in all, or notes their thresholds; where that begins.
    pub fn add_members(&mut self, members: &Members, count: usize) -> u32 {
        // Fields come behind all objects.
        let first = self.object_values.len();
        // That of no object first.
        match &members.thresholds {
            None => {
                self.object_values.push(0);
                self.object_values.extend(members.objects.iter().map(|&is_chosen| u32::from(is_chosen)));
                self.object_values.resize(first + 1 + count, 0);
                self.object_values.extend(members.fields.map(u32::from));
            }
            Some(thresholds) => {
                self.object_values.extend([0, 0]);
                self.object_values.extend(thresholds.iter().flatten().map(|threshold| threshold.to_bits()));
                self.object_values.resize(first + 2 * (1 + count), 0);
                let thresholds = members.fields.map(|is| [0, if is { 1.0_f32.to_bits() } else { 0 }]);
                self.object_values.extend(thresholds.as_flattened());
            }
        }
        first as u32
    }

    fn add(
        &mut self,
        effect: &EffectUse,
        lens: Option<u32>,
        models: &[&CityModel],
        tables: &LensTables,
        point_px: f64,
    ) -> Result<(), ChoiceError> {
        let Some(number) = shader::effect::number_of(&effect.effect) else { return Ok(()) };
        if effect.weight == Some(0.0) && blend_of(effect).is_some() {
            return Ok(());
        }
        let definition = &shader::handlers()[number as usize];
        let first = self.parameters.len() as u32;
        let mut floats = Vec::new();
        for (parameter, _, count) in definition.shader_parameters() {
            let value = effect.parameters.get(&parameter.name).cloned().or_else(|| default_of(parameter));
            if parameter.kind.is_ramp() {
                floats.push(self.object_values.len() as f32);
                self.object_values.extend(value.iter().flat_map(ramp));
                continue;
            }
            let length = if parameter.unit == POINTS { point_px as f32 } else { 1.0 };
            let own = value.map_or_else(|| vec![0.0; count], |value| in_floats(parameter, &value));
            floats.extend(own.iter().map(|float| float * length));
        }
        let first_value = self.object_values.len() as f32;
        match definition.objects {
            None => {}
            Some(PerObject::Colors) => {
                let scale = in_any(models, |model| ThematicScale::new(model, effect))?;
                self.object_values.extend(scale.for_shader(models));
                floats.push(first_value);
            }
            Some(what @ (PerObject::Sights | PerObject::Footprints)) => {
                let tables = if what == PerObject::Sights { &tables.sights } else { &tables.footprints };
                let of_lens = lens.and_then(|lens| tables.get(lens as usize));
                // Empty ones begin with 0, and none has more than two numbers in front.
                self.object_values.extend(of_lens.map_or(&[0, 0][..], Vec::as_slice));
                floats.push(first_value);
            }
            Some(PerObject::Chosen) => {
                let choice = Choice::of_effect(effect);
                let without_object = in_any(models, |model| chosen(model, &choice))?.without_object;
                self.object_values.push(u32::from(without_object));
                let objects = models.iter().flat_map(|model| members(model, &choice));
                self.object_values.extend(objects.map(u32::from));
                floats.push(first_value);
            }
        }
        floats.resize(definition.slots() as usize * 4, 0.0);
        self.parameters.extend(floats.as_chunks().0);
        if definition.kind == EffectKind::Filter {
            // Which image holds what it made: a frame says it.
            self.parameters.push([0.0; 4]);
        }
        let blend = blend_of(effect);
        if blend.is_some() {
            self.parameters.push([effect.weight.unwrap_or(1.0) as f32, 0.0, 0.0, 0.0]);
        }
        let translucent = translucent(definition, effect);
        self.list.push(Operation { effect: number, parameters: first, lens, class: effect.class, blend, translucent });
        Ok(())
    }
}

/// What a use of an effect makes translucent; `None`: it is no opacity rule.
fn translucent(definition: &EffectDefinition, effect: &EffectUse) -> Option<Translucent> {
    let chooses = definition.objects == Some(PerObject::Chosen) && Choice::of_effect(effect).attribute.is_some();
    let keeps_terrain = definition.terrain_parameter().is_some_and(|parameter| {
        let value = effect.parameters.get(&parameter.name).cloned().or_else(|| default_of(parameter));
        value != Some(Parameter::Boolean(false))
    });
    let found = Translucent { all_objects: !chooses, terrain: !keeps_terrain };
    (definition.kind == EffectKind::Opacity).then_some(found)
}

/// Of the first city that has what is asked for; else what is wrong with the scene's own.
fn in_any<T, E>(models: &[&CityModel], ask: impl Fn(&CityModel) -> Result<T, E>) -> Result<T, E> {
    let [own, others @ ..] = models else { return ask(&CityModel::default()) };
    ask(own).or_else(|error| others.iter().find_map(|model| ask(model).ok()).ok_or(error))
}

/// What a lens has of what some have, ascending.
fn of_lens<T: Copy>(of: &[(u32, T)], lens: u32) -> Option<T> {
    of.binary_search_by_key(&lens, |(owner, _)| *owner).ok().map(|i| of[i].1)
}

/// Ascending, each once.
fn each_once<T: Ord>(mut tests: Vec<T>) -> Vec<T> {
    tests.sort_unstable();
    tests.dedup();
    tests
}

/// Of an operation's own parameters.
fn slots_of(operation: &Operation) -> u32 {
    shader::handlers()[operation.effect as usize].slots()
}

/// How a use is laid over what is below; one with a weight at least as paint.
fn blend_of(effect: &EffectUse) -> Option<Blend> {
    effect.blend.filter(|b| *b != Blend::Replace || effect.weight.is_some()).or(effect.weight.map(|_| Blend::Replace))
}

fn body_kind(body: LensBody) -> Option<BodyKind> {
    match body {
        LensBody::None => None,
        LensBody::Outline => Some(BodyKind::Outline),
        LensBody::Shell => Some(BodyKind::Shell),
        LensBody::Halo => Some(BodyKind::Halo),
    }
}

/// Whether some step draws lines.
fn draws_lines(steps: &[Step]) -> bool {
    steps.iter().any(|step| shader::handlers()[step.effect as usize].lines)
}

impl From<ClassTest> for Class {
    fn from(test: ClassTest) -> Self {
        match test {
            ClassTest::Inside => Self::Inside,
            ClassTest::Front => Self::Front,
            ClassTest::Behind => Self::Behind,
            ClassTest::Rest => Self::Rest,
        }
    }
}

fn class_test(class: Class) -> ClassTest {
    match class {
        Class::Inside => ClassTest::Inside,
        Class::Front => ClassTest::Front,
        Class::Behind => ClassTest::Behind,
        Class::Rest => ClassTest::Rest,
    }
}
