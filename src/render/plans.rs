//! What the shaders of a frame have to do, from what the scene asks for and which lenses are in view.

use std::cell::OnceCell;

use glam::DVec3;

use crate::{
    render::{
        frame::FrameInput,
        invokers::{InvokerPlans, Invokers},
        operations::Filter,
        regions::RegionPasses,
        screen_bound::ScreenBound,
        seen::{SeenVolume, part_of},
        silhouettes::Silhouette,
    },
    scene::{Technique, technique::MOST_WRITTEN_OUT},
    shader::{Plan, Regions, handlers},
};

/// What shading does outside the lenses' bounds, and inside.
pub(super) struct Plans {
    pub context: Plan,
    pub lenses: Plan,
    pub filters: Vec<Filter>,
    /// What is hidden in the picture.
    pub hiding: Option<Plan>,
    /// What lines go through.
    pub lining: Option<Plan>,
    /// What is made of translucent layers.
    pub layering: Option<Plan>,
    /// Lenses in view, in the order of the plans, and where.
    pub seen: Vec<u32>,
    /// Those of them that do anything to how places look that are there, ascending.
    pub looked_at: Vec<u32>,
    pub parts: Vec<ScreenBound>,
    /// The boxes in which each acts as *inside*, as [`LensVolume::room`](super::volume::LensVolume::room) has them.
    pub rooms: Vec<[DVec3; 2]>,
    /// Where their outlines are.
    pub silhouettes: Vec<Silhouette>,
    invokers: OnceCell<Invokers>,
    /// The regions that the city is drawn by, where the technique has passes for them.
    pub regions: Option<RegionPasses>,
}

impl Plans {
    /// `seen`: the volumes in view; `empty`: the lenses, ascending, in which nothing is; `clear_materials`: whether something in view
    /// is translucent by its material.
    pub fn new(input: &FrameInput, seen: &[SeenVolume], empty: &[u32], clear_materials: bool) -> Self {
        let haze = input.haze_per_radius() > 0.0;
        let lenses: Vec<u32> = seen.iter().map(|v| v.lens).collect();
        let filters = input.operations.filters(&lenses, empty, haze);
        let volumes: Vec<_> = seen.iter().map(|v| (v.lens, v.test, v.leaves.clone())).collect();
        let lenses = match seen.is_empty() {
            true => Plan::default(),
            false => input.operations.lens_plan(&volumes, empty, haze, input.wants_masks()),
        };
        let lenses = Plan { clear_materials: clear_materials && !seen.is_empty(), ..lenses };
        let context = Plan { clear_materials, ..input.operations.context_plan(haze) };
        let whole = if seen.is_empty() { &context } else { &lenses };
        let (hiding, lining) = (whole.hiding(handlers()), whole.lining(handlers()));
        let layering = whole.layering(handlers());
        let mut numbers: Vec<u32> = seen.iter().map(|v| v.lens).collect();
        numbers.dedup();
        let is_looked_at =
            |(i, _): &(u32, &u32)| input.technique != Technique::Accumulate || whole.is_looked_at(*i, handlers());
        let looked_at = (0..).zip(&numbers).filter(is_looked_at).map(|(_, number)| *number).collect();
        let of_lens = || seen.chunk_by(|a, b| a.lens == b.lens);
        let room = |volumes: &[SeenVolume]| {
            let each = volumes.iter().map(|v| input.volumes[v.index].room(&input.view));
            each.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or([DVec3::NEG_INFINITY, DVec3::INFINITY])
        };
        let context = context.shading(handlers());
        // Where rays are bent and no lens is seen, it is the same.
        let mut lenses = if seen.is_empty() { context.clone() } else { lenses.shading(handlers()) };
        let has_passes = input.technique.has_passes() && !seen.is_empty();
        let regions = has_passes.then(|| RegionPasses::new(input, seen, &lenses, &numbers));
        if input.technique == Technique::Branches && !seen.is_empty() {
            lenses.regions = Some(Regions::combinations(&lenses));
        }
        Self {
            parts: of_lens().filter_map(|volumes| part_of(volumes.iter())).collect(),
            rooms: of_lens().map(room).collect(),
            silhouettes: of_lens()
                .map(|volumes| match input.rays.is_empty() {
                    true => Silhouette::of(volumes.iter().map(|v| &input.volumes[v.index])),
                    false => Silhouette::default(),
                })
                .collect(),
            invokers: OnceCell::new(),
            filters,
            hiding,
            lining,
            layering,
            seen: numbers,
            looked_at,
            context,
            lenses,
            regions,
        }
    }

    /// The invokers of the picture.
    pub fn invokers(&self) -> &Invokers {
        let plans = InvokerPlans {
            context: &self.context,
            lenses: &self.lenses,
            hiding: self.hiding.as_ref(),
            lining: self.lining.as_ref(),
            layering: self.layering.as_ref(),
        };
        self.invokers.get_or_init(|| Invokers::new(plans, handlers()))
    }

    /// Whether it would be too long, written out.
    pub fn is_long(&self) -> bool {
        self.lenses.volumes() as usize > MOST_WRITTEN_OUT
    }

    /// Whether so many lenses do something to how places look.
    pub fn looks_at_many(&self) -> bool {
        let of = |(i, number): (u32, &u32)| match self.looked_at.binary_search(number) {
            Ok(_) => self.lenses.volumes_of(i).1.len(),
            Err(_) => 0,
        };
        (0..).zip(&self.seen).map(of).sum::<usize>() > MOST_WRITTEN_OUT
    }

    /// The uses of filters, each with the number of the image that it gets.
    pub fn uses(&self) -> impl Iterator<Item = (usize, (Option<u32>, u32))> {
        self.filters.iter().enumerate().flat_map(|(i, f)| f.uses.iter().map(move |u| (i, *u)))
    }
}
