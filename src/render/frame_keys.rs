//! The pipelines that a frame is drawn with: those it calls for, and no other (U3).

use crate::{
    render::{
        city::{Section, SectionKind},
        city_passes::geometry_key,
        cut::{CutPrograms, Cuts},
        frame::{Backend, FrameInput, behind, haze, wants_furniture, wants_masks},
        key::{Key, ShadeTarget, Shown},
        layers::{self, LayerKeys},
        plans::Plans,
        regions::{self, RegionKeys},
        renderer::{CityOnGpu, Renderer},
        sections,
        seen::{Kept, SeenVolume},
        sprite_passes,
        stored::{self, Making},
        transparency::{ForwardKeys, FragmentPass, SlotKeys},
    },
    scene::{BaseStyle, Technique, Transparency},
    shader::{Plan, Program},
};

/// The pipelines of the shade pass: outside the lenses' bounds, and inside; each for surfaces and for the background.
#[derive(Clone, Debug, Default)]
pub(super) struct ShadeKeys {
    pub context: Vec<Key>,
    pub lenses: Vec<Key>,
    /// For each filter, what shades the image that it reads.
    pub filters: Vec<Key>,
    /// What is hidden, and what draws the parts of the city where it is.
    pub cuts: CutPrograms,
    pub city: Vec<Key>,
    /// What draws lines.
    pub lines: Option<Key>,
    /// What lists and lays translucent layers.
    pub layers: Option<LayerKeys>,
    /// What marks and shades regions.
    pub regions: RegionKeys,
}

impl ShadeKeys {
    pub fn all(&self) -> impl Iterator<Item = &Key> {
        let parts = self.context.iter().chain(&self.lenses).chain(&self.filters).chain(&self.city).chain(&self.lines);
        parts.chain(self.regions.all()).chain(self.layers.iter().flat_map(LayerKeys::all))
    }
}

impl Renderer {
    /// Makes the pipelines this frame calls for, and no other; whether shading is the uber back end's.
    pub(super) fn prepare(
        &mut self,
        input: &FrameInput,
        (seen, making): (&[SeenVolume], &[Making]),
        plans: &Plans,
        cuts: &Cuts,
        shadows: bool,
    ) -> (ShadeKeys, bool) {
        let Some(city) = &self.city else { return (ShadeKeys::default(), false) };
        let (colored, smooth, has_sections) = (self.colored(), self.smooth(), self.has_sections);
        let mut keys: Vec<Key> = Vec::new();
        if shadows {
            keys.push(Key::Shadow(None));
        }
        for own in std::iter::once(city).chain(self.deformed.iter().map(|deformed| &deformed.city)) {
            let whole_key = |section: &Section| {
                geometry_key(section.kind, colored, [smooth, own.buffers.smooth], input.measured, None)
            };
            keys.extend(own.buffers.sections.iter().map(whole_key));
        }
        // For all sections, contents' too: a lens that moves compiles nothing.
        let of_city = |city: &CityOnGpu| -> Vec<_> {
            city.buffers.sections.iter().map(|s| (s.kind, city.buffers.smooth)).collect()
        };
        let sections: Vec<(SectionKind, bool)> = self.cities().flat_map(of_city).collect();
        let cut_keys = |picture: Option<&Program>, sun: Option<&Program>| -> Vec<Key> {
            let sections = sections.iter().flat_map(|&(kind, own)| {
                picture.map(|program| geometry_key(kind, colored, [smooth, own], input.measured, Some(program.clone())))
            });
            let caps = picture.filter(|p| has_sections && p.regions().is_none()).into_iter();
            let caps = caps.flat_map(|program| sections::keys(program, input.measured));
            sections.chain(caps).chain(sun.map(|program| Key::Shadow(Some(program.clone())))).collect()
        };
        for volume in seen {
            let body = &input.volumes[volume.index].body;
            match volume.sprite.as_ref().map(|s| &s.kept) {
                Some(Kept::Page(_)) => keys.extend(sprite_passes::keys(body)),
                Some(Kept::Stored(_)) | None => {}
            }
        }
        keys.extend(making.iter().flat_map(|m| stored::keys(m.body)));
        let clay = input.base == BaseStyle::Clay;
        let shade_to = |target, shown, program: Program| Key::Shade {
            program,
            shown,
            target,
            textured: colored && !clay,
            clay,
            shadows,
            smooth,
            sections: has_sections,
            behind: behind(input),
        };
        let target = if input.samples > 1 { ShadeTarget::Sums } else { ShadeTarget::Picture };
        let both = |program: Program| {
            [Shown::Surface, Shown::Background].map(|shown| shade_to(target, shown, program.clone())).to_vec()
        };
        let lines_key = |program: Program| Key::Lines { program, smooth };
        let shown = (input.shown || input.measured || wants_masks(input))
            .then_some(Key::ShownLayers { smooth, measured: input.measured });
        let layer_keys = |noting: Option<Program>, composite: Option<Program>| {
            let (noting, program) = noting.zip(composite)?;
            let forward = ForwardKeys {
                program: program.clone(),
                clay,
                // Mesa 22.3 crashes where fragments of the city sample the shadow map.
                shadows: shadows && !self.gpu.is_software(),
                part: u32::from(!seen.is_empty()),
                colored,
                measured: input.measured,
            };
            let is_forward = !matches!(input.transparency, Transparency::Exact | Transparency::Peel { .. });
            let textured = colored && !clay;
            let count = plans.layering.as_ref().filter(|plan| layers::asks_most(plan));
            let words = LayerKeys::words(smooth, textured);
            let slots = SlotKeys::of(input.transparency, words);
            let sort = if slots.is_some() { Vec::new() } else { LayerKeys::sorting(words, self.longest_list) };
            Some(LayerKeys {
                noting,
                composite: Key::Composite {
                    program,
                    textured,
                    clay,
                    shadows,
                    smooth,
                    shown: shown.is_some(),
                    sorted: slots.is_some() || !sort.is_empty(),
                    record: slots.map_or(0, |slots| slots.record),
                    tail: slots.is_some_and(|slots| slots.has_tail()),
                    picks: self.picked_layer.is_some() && slots.is_none(),
                },
                asks_most: count.is_some(),
                count: count.filter(|_| slots.is_none() && !is_forward).map(|_| Key::CountLayers(words)),
                sort,
                shown: shown.clone().filter(|_| input.transparency != Transparency::Stochastic),
                textured,
                smooth,
                slots,
                forward: is_forward.then_some(forward),
            })
        };
        let parts = |context: Program,
                     lenses: Program,
                     city: Vec<Key>,
                     cuts: CutPrograms,
                     [lines, layers]: [Option<Program>; 2]| ShadeKeys {
            lines: lines.map(lines_key),
            layers: layer_keys(cuts.picture.clone(), layers),
            city,
            cuts,
            context: both(context),
            lenses: if seen.is_empty() || plans.regions.is_some() { Vec::new() } else { both(lenses) },
            regions: plans.regions.as_ref().map_or_else(RegionKeys::default, |regions| {
                let masks = wants_masks(input).then(|| Plan { steps: Vec::new(), ..plans.lenses.clone() });
                regions::keys(input, regions, masks, shade_to)
            }),
            // Written out on either back end: a few steps without a lens.
            filters: plans
                .filters
                .iter()
                .map(|f| shade_to(ShadeTarget::Unfiltered, Shown::Any, Program::Specialised(f.plan.clone())))
                .collect(),
        };
        let specialised = || {
            let cuts = cuts.specialised();
            let by_region = plans.regions.as_ref().map(|regions| Program::Specialised(regions.plan.clone()));
            let city = cut_keys(cuts.picture.as_ref().or(by_region.as_ref()), cuts.sun.as_ref());
            let [context, lenses] = [&plans.context, &plans.lenses].map(|plan| Program::Specialised(plan.clone()));
            let others = [&plans.lining, &plans.layering].map(|plan| plan.clone().map(Program::Specialised));
            parts(context, lenses, city, cuts, others)
        };
        let uber = || {
            let uber = Program::Uber(input.operations.uber(haze(input) > 0.0, wants_masks(input)));
            let hiding = input.operations.uber_hiding().map(|uber| uber.map(Program::Uber));
            let city = cut_keys(hiding[0].as_ref(), hiding[1].as_ref().filter(|_| shadows));
            let layering = input.operations.uber_layering(haze(input) > 0.0, wants_masks(input));
            let others = [input.operations.uber_lining(), layering.filter(|_| plans.layering.is_some())];
            parts(uber.clone(), uber, city, cuts.uber(hiding), others.map(|uber| uber.map(Program::Uber)))
        };
        let shade_keys = match input.backend {
            // Those kept for reference are written out.
            _ if input.technique != Technique::Accumulate => specialised(),
            // What is written out for so many compiles for minutes.
            Backend::Specialised if plans.is_long() => uber(),
            Backend::Specialised => specialised(),
            Backend::Uber => uber(),
            Backend::Adaptive if plans.is_long() => uber(),
            Backend::Adaptive => {
                let wanted = specialised();
                // All are asked for, also when the first is not there.
                let missing = wanted.all().filter(|key| !self.pipelines.is_ready(key)).count();
                if missing == 0 { wanted } else { uber() }
            }
        };
        keys.extend(shade_keys.all().cloned());
        if let Some(layers) = &shade_keys.layers {
            let early = self.gpu.tests_depth_early();
            match layers.slots {
                None if layers.is_stochastic() => {
                    let key = |&(kind, own): &(SectionKind, bool)| {
                        layers.translucent_key(SlotKeys::NONE, (kind.into(), own), FragmentPass::Chance, false)
                    };
                    keys.extend(sections.iter().map(key));
                }
                None => keys.extend(sections.iter().flat_map(|&(kind, own)| {
                    [false, true].map(|all| layers.noting_key(kind.into(), [own, all], early))
                })),
                Some(slots) => keys.extend(slots.all(layers, &sections, early)),
            }
        }
        keys.extend(plans.filters.iter().map(|f| Key::Filter(f.effect)));
        if input.samples > 1 {
            keys.push(Key::Resolve);
        }
        if wants_furniture(input) {
            let layered = input.transparent;
            keys.extend(input.furniture.parts().map(|part| Key::Furniture { layered, part }));
            keys.extend(input.transparent.then_some(Key::FurnitureOver));
        }
        for key in &keys {
            self.pipelines.prepare(key);
        }
        self.ran.extend(plans.context.effects());
        self.ran.extend(plans.lenses.effects());
        self.ran.extend(plans.layering.iter().flat_map(|plan| plan.effects()));
        self.ran.extend(plans.lining.iter().flat_map(|plan| plan.effects()));
        self.ran.extend(cuts.all().flat_map(|cut| cut.plan.effects()));
        self.ran.sort_unstable();
        self.ran.dedup();
        let is_uber = shade_keys.context.iter().any(|key| matches!(key, Key::Shade { program: Program::Uber(_), .. }));
        (shade_keys, is_uber)
    }
}
