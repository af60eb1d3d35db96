//! The invoker table of the uber back end, and which of its invokers may run in which tile of the picture.

use glam::DVec3;

use crate::{
    render::{
        eye::PictureTile,
        layout,
        screen_bound::ScreenBound,
        silhouettes::{Rays, Silhouette},
    },
    shader::{Blend, ClassTest, EffectDefinition, EffectKind, Plan, PlanLens, Scope, Step, TILE_PX, scope_number},
};

/// Sections of the lists of a tile, as `shader::uber` numbers them: opacity rules, materials, lights, styles, bodies, masks.
const SECTIONS: usize = 6;

/// The section of bodies.
const BODIES: usize = 4;

/// An invoker of a section, and the lens of the plan that it belongs to; none: the context.
type Entry = (u32, Option<u32>);

/// What invokers are made of: the context's plan and the lenses', what is hidden, what lines go through, and translucent layers.
#[derive(Clone, Copy, Debug)]
pub struct InvokerPlans<'a> {
    /// Outside of all lenses.
    pub context: &'a Plan,
    /// Where they may be seen.
    pub lenses: &'a Plan,
    /// What is hidden.
    pub hiding: Option<&'a Plan>,
    /// What lines go through.
    pub lining: Option<&'a Plan>,
    /// What is seen through.
    pub layering: Option<&'a Plan>,
}

/// The invokers of a picture.
#[derive(Debug, Default)]
pub struct Invokers {
    all: Vec<layout::PackedInvoker>,
    /// Of each, the lens of the plan that it acts inside of, and nowhere else.
    inside_of: Vec<Option<u32>>,
    hides: [u32; 2],
    lines: [u32; 2],
    contents: [u32; 2],
    /// Where the invokers of time operators stand by the bits of lenses, and how many bits there are.
    epochs: [u32; 2],
    /// Whether something is seen through.
    has_layers: bool,
    /// Outside of all lenses, and where they may be seen.
    sections: [[Vec<Entry>; SECTIONS]; 2],
}

impl Invokers {
    /// Of the context's plan and the lenses', of what is hidden, of what lines go through, and of translucent layers.
    pub fn new(plans: InvokerPlans, handlers: &[EffectDefinition]) -> Self {
        let InvokerPlans { context, lenses, hiding, lining, layering } = plans;
        let plans = [context, lenses];
        let mut out = Self { has_layers: layering.is_some(), ..Self::default() };
        let first = out.all.len() as u32;
        if let Some(plan) = hiding {
            let volumes = volumes_before(plan);
            out.all
                .extend(plan.steps.iter().map(|s| invoker(plan, &volumes, s, &handlers[s.effect as usize]).packed()));
        }
        out.hides = [first, out.all.len() as u32];
        let first = out.all.len() as u32;
        if let Some(plan) = lining {
            let volumes = volumes_before(plan);
            out.all.extend(plan.steps.iter().map(|step| {
                let handler = &handlers[step.effect as usize];
                layout::Invoker { kind: to_lines(handler), ..invoker(plan, &volumes, step, handler) }.packed()
            }));
        }
        out.lines = [first, out.all.len() as u32];
        let first = out.all.len() as u32;
        if let Some(plan) = hiding.or(lining) {
            let volumes = volumes_before(plan);
            out.all.extend(plan.contents.iter().map(|content| {
                let lens = &plan.lenses[content.lens as usize];
                let invoker = layout::Invoker {
                    handler: content.city,
                    scope: scope_number(Scope::Lens(content.lens, content.class)),
                    first_volume: volumes[content.lens as usize],
                    volumes: lens.volumes.len() as u32,
                    weight: u32::from(content.keeps_terrain),
                    kind: content.clip.number(),
                    border: lens.border.map_or(0, |b| b.parameters + 1),
                    ..layout::Invoker::default()
                };
                invoker.packed()
            }));
        }
        out.contents = [first, out.all.len() as u32];
        let first = out.all.len() as u32;
        if let Some(plan) = hiding.or(lining) {
            let volumes = volumes_before(plan);
            out.all.extend(plan.epochs.iter().map(|epoch| {
                let lens = &plan.lenses[epoch.lens as usize];
                let invoker = layout::Invoker {
                    handler: epoch.handler,
                    scope: scope_number(Scope::Lens(epoch.lens, ClassTest::Inside)),
                    first_volume: volumes[epoch.lens as usize],
                    volumes: lens.volumes.len() as u32,
                    parameters: epoch.words,
                    border: lens.border.map_or(0, |b| b.parameters + 1),
                    ..layout::Invoker::default()
                };
                invoker.packed()
            }));
        }
        let epochs = hiding.or(lining).map_or(&[][..], |plan| &plan.epochs);
        let bits = epochs.iter().map(|epoch| epoch.bit + 1).max().unwrap_or(0);
        out.epochs = [out.all.len() as u32, bits];
        // As the table has them: where the invokers of a lens begin, and where they end.
        let mut of_lenses = vec![layout::PackedInvoker::default(); bits as usize];
        for (i, epoch) in (first..).zip(epochs) {
            let own = &mut of_lenses[epoch.bit as usize];
            own.place = if own.call == 0 { i } else { own.place };
            own.call = i + 1;
        }
        out.all.extend(of_lenses);
        out.inside_of.resize(out.all.len(), None);
        let [context, lenses] = plans;
        let rules = |is_one: &dyn Fn(Scope) -> bool| -> Vec<Step> {
            let all = layering.iter().flat_map(|plan| plan.steps_of(EffectKind::Opacity, handlers));
            all.filter(|(step, _)| is_one(step.scope)).map(|(step, _)| step.clone()).collect()
        };
        out.sections = [
            out.sections_of(context, &rules(&|scope| scope == Scope::Everywhere), handlers),
            out.sections_of(lenses, &rules(&|_| true), handlers),
        ];
        out
    }

    fn sections_of(&mut self, plan: &Plan, rules: &[Step], handlers: &[EffectDefinition]) -> [Vec<Entry>; SECTIONS] {
        let volumes = volumes_before(plan);
        let mut add = |invoker: layout::Invoker, lens: Option<u32>, is_inside: bool| {
            self.all.push(invoker.packed());
            self.inside_of.push(lens.filter(|_| is_inside));
            (self.all.len() as u32 - 1, lens)
        };
        let mut of_kinds = |kinds: &[EffectKind]| -> Vec<Entry> {
            let steps = plan.steps.iter().chain(rules).map(|s| (s, &handlers[s.effect as usize]));
            let chosen = steps.filter(|(_, h)| kinds.contains(&h.kind));
            let one = |(step, handler): (&Step, &EffectDefinition)| {
                let invoker = invoker(plan, &volumes, step, handler);
                match step.scope {
                    Scope::Lens(lens, class) => add(invoker, Some(lens), class == ClassTest::Inside),
                    Scope::Everywhere => add(invoker, None, false),
                }
            };
            chosen.map(one).collect()
        };
        let opacities = of_kinds(&[EffectKind::Opacity]);
        let materials = of_kinds(&[EffectKind::Material]);
        let lights = of_kinds(&[EffectKind::Light]);
        let styles = of_kinds(&[EffectKind::Scene, EffectKind::Post, EffectKind::Filter]);
        let mut of_lenses = |is_one: &dyn Fn(&PlanLens) -> bool| -> Vec<Entry> {
            let ones = (0..).zip(&plan.lenses).filter(|(_, lens)| is_one(lens));
            ones.map(|(i, lens)| {
                let invoker = layout::Invoker {
                    first_volume: volumes[i as usize],
                    volumes: lens.volumes.len() as u32,
                    handler: lens.body.map_or(0, |body| body.kind.number()),
                    parameters: lens.body.map_or(0, |body| body.parameters),
                    number: lens.number,
                    kind: u32::from(plan.is_convex(i)),
                    ..layout::Invoker::default()
                };
                add(invoker, Some(i), false)
            })
            .collect()
        };
        let bodies = of_lenses(&|lens| lens.body.is_some());
        let masks = of_lenses(&|_| plan.masks);
        [opacities, materials, lights, styles, bodies, masks]
    }

    /// The table as `shader::uber` declares it, for a picture of this size.
    pub fn table(&self, size: [u32; 2]) -> Vec<u32> {
        let [from, to] = self.contents;
        let tiles = [[size[0].div_ceil(TILE_PX), from], [to, u32::from(self.has_layers)]];
        [&[self.hides, self.lines], &tiles[..], &[self.epochs, [0; 2]]].concat().concat()
    }

    /// Where each may act, if the plan's lenses do in these rooms: everywhere if it acts on more than what is inside.
    pub fn reaches(&self, rooms: &[[DVec3; 2]]) -> Vec<layout::Reach> {
        let of = |lens: &Option<u32>| {
            lens.and_then(|lens| rooms.get(lens as usize)).map_or(layout::Reach::EVERYWHERE, layout::Reach::of)
        };
        self.inside_of.iter().map(of).collect()
    }

    /// All of them.
    pub fn all(&self) -> &[layout::PackedInvoker] {
        &self.all
    }

    /// The lists of all tiles of a picture, where the lenses of the plan may be seen in these parts of it: for each tile where
    /// its sections begin and the last one ends, and then the invokers, three words each. First those outside of all lenses.
    /// `rays`: of a tile; a lens's body is left out where its silhouette is not seen.
    pub fn tile_lists(
        &self,
        parts: &[ScreenBound],
        size: [u32; 2],
        silhouettes: &[Silhouette],
        rays: impl Fn(PictureTile) -> Rays,
    ) -> Vec<u32> {
        let [across, down] = size.map(|side| side.div_ceil(TILE_PX));
        // Which lenses a tile may show; ascending, as they are gone through in order.
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (lens, part) in (0..).zip(parts) {
            let around = part.rectangle();
            let [x, y] = around.origin.map(|o| o / TILE_PX);
            let end = |i: usize, most: u32| (around.origin[i] + around.size[i]).div_ceil(TILE_PX).min(most);
            for row in y..end(1, down) {
                for column in x..end(0, across) {
                    let tile = PictureTile { origin: [column * TILE_PX, row * TILE_PX], size: [TILE_PX; 2] };
                    if part.within(tile).is_some() {
                        pairs.push((row * across + column, lens));
                    }
                }
            }
        }
        // Stable: lenses of a tile keep their order.
        pairs.sort_by_key(|(tile, _)| *tile);
        let [context, lenses] = &self.sections;
        let mut words = vec![0; (SECTIONS + 1) * (1 + (across * down) as usize)];
        let put = |words: &mut Vec<u32>, (invoker, _): &Entry| {
            let kept = &self.all[*invoker as usize];
            words.extend([kept.place, kept.call, *invoker]);
        };
        for (i, section) in context.iter().enumerate() {
            words[i] = words.len() as u32;
            section.iter().for_each(|entry| put(&mut words, entry));
        }
        words[SECTIONS] = words.len() as u32;
        // The entries of each lens stand together, in the order of lenses, but those of the context come first.
        let begins: Vec<Vec<u32>> = lenses.iter().map(|section| begins_of(section, parts.len())).collect();
        let mut shown = pairs.chunk_by(|a, b| a.0 == b.0).peekable();
        for tile in 0..across * down {
            let own = shown.next_if(|pairs| pairs[0].0 == tile).unwrap_or_default();
            let record = (SECTIONS + 1) * (1 + tile as usize);
            let origin = [tile % across * TILE_PX, tile / across * TILE_PX];
            let rays = rays(PictureTile { origin, size: [TILE_PX; 2] });
            for (i, section) in lenses.iter().enumerate() {
                words[record + i] = words.len() as u32;
                section[..begins[i][0] as usize].iter().for_each(|entry| put(&mut words, entry));
                let is_seen = |lens: u32| i != BODIES || silhouettes[lens as usize].may_be_seen_by(&rays);
                for (_, lens) in own.iter().filter(|(_, lens)| is_seen(*lens)) {
                    let [from, to] = [0, 1].map(|end| begins[i][*lens as usize + end] as usize);
                    section[from..to].iter().for_each(|entry| put(&mut words, entry));
                }
            }
            words[record + SECTIONS] = words.len() as u32;
        }
        words
    }
}

/// Where the entries of each of so many lenses begin in a section, and those of the last one end.
fn begins_of(section: &[Entry], lenses: usize) -> Vec<u32> {
    let mut begins = vec![0; lenses + 1];
    for (_, lens) in section {
        begins[lens.map_or(0, |l| l as usize + 1).min(lenses)] += 1;
    }
    for i in 1..begins.len() {
        begins[i] += begins[i - 1];
    }
    begins
}

/// How many volumes come before those of each lens of a plan.
fn volumes_before(plan: &Plan) -> Vec<u32> {
    let mut before = 0;
    let mut of = |lens: &PlanLens| {
        let own = lens.volumes.len() as u32;
        before += own;
        before - own
    };
    plan.lenses.iter().map(&mut of).collect()
}

/// What a handler is to lines, as `shader::lining` numbers it.
fn to_lines(handler: &EffectDefinition) -> u32 {
    match (handler.kind, handler.lines) {
        (EffectKind::Scene, false) => 1,
        (EffectKind::Scene, true) => 2,
        (EffectKind::Hide, false) => 3,
        (EffectKind::Hide, true) => 4,
        (EffectKind::Post, true) => 5,
        _ => 0,
    }
}

fn invoker(plan: &Plan, volumes: &[u32], step: &Step, handler: &EffectDefinition) -> layout::Invoker {
    let (first_volume, count, border) = match step.scope {
        Scope::Everywhere => (0, 0, None),
        Scope::Lens(lens, _) => {
            let of = &plan.lenses[lens as usize];
            (volumes[lens as usize], of.volumes.len() as u32, of.border)
        }
    };
    layout::Invoker {
        handler: step.effect,
        scope: scope_number(step.scope),
        first_volume,
        volumes: count,
        parameters: if handler.kind == EffectKind::Filter { step.image(handler) } else { step.parameters },
        blend: step.blend.map_or(0, Blend::number),
        weight: step.weight(handler).unwrap_or(0),
        kind: match handler.kind {
            EffectKind::Scene => 1,
            EffectKind::Opacity => 2,
            _ => 0,
        },
        number: 0,
        border: border.map_or(0, |b| b.parameters + 1),
    }
}
