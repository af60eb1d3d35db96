//! The city, every triangle at most once: in one pass, or what is near first and then what it does not hide; and not again as long as the targets
//! hold it.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cells::Details,
        cities::DrawnSection,
        city::SeenChunk,
        layout,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass},
            culling_depth::{self, CullingDepth},
            opaque::{CutBy, OpaqueEye, SectionPart, add_cut_keys, add_whole_keys, draw_opaque, visible},
        },
        plan::FramePlan,
        programs::Programs,
        resource::{recording::Recording, targets::Targets},
    },
    view::View,
};

/// What the targets show of a city of which nothing is hidden.
#[derive(Clone, Debug, PartialEq)]
struct Held {
    eye: layout::View,
    /// Chunks are culled by this one.
    view: View,
    /// In which detail the city is drawn.
    details: Details,
    /// How often the city, or what is moved of it, became another.
    world: u64,
    /// Whether depth is drawn for AOVs too.
    measured: bool,
    /// Codes, colours, depth, depth for AOVs, shares of own light.
    targets: [wgpu::Texture; 5],
}

impl Held {
    /// What a frame wants to be there; `None` where it must be drawn: lenses hide something, put something there, or cut it open.
    fn wanted(frame: &FrameContext) -> Option<Self> {
        let FrameContext { plan, shared, targets, .. } = *frame;
        let is_own = plan.cuts.picture.is_none() && plan.sections.len() == plan.own_sections.len();
        let Targets { codes, colors, depth, own_depth, emissions, .. } = targets;
        (plan.settings.holds_geometry && is_own).then(|| Self {
            eye: plan.view_uniform(),
            view: plan.input.view,
            details: plan.details.clone(),
            world: shared.world,
            measured: plan.input.measured,
            targets: [codes, colors, depth, own_depth, emissions].map(|target| target.texture.clone()),
        })
    }
}

/// Handed on: how often the targets of what is opaque were drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drawing(pub u64);

/// What it keeps.
#[derive(Debug)]
pub struct Geometry {
    /// The near depth of the last frame that culled by it.
    near: Option<CullingDepth>,
    /// What the targets hold.
    held: Option<Held>,
    drawing: Drawing,
}

impl Pass for Geometry {
    type Input<'a> = ();

    const LIST: &'static [Line] = &[
        ("geometry", "everything once; on a software adapter what is near, and then"),
        ("geometry beyond", "what that does not hide, where it hides much"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { near: None, held: None, drawing: Drawing(0) })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        plan.plans.regions.is_none().then_some(())
    }

    fn begin(&mut self, plan: &FramePlan) {
        // Its passes draw into the same targets. Others that do come with a cut.
        if plan.plans.regions.is_some() {
            self.held = None;
        }
    }

    fn forget(&mut self) {
        self.held = None;
    }

    fn add_keys(&self, input: Option<&()>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        if input.is_none() {
            return;
        }
        add_whole_keys(plan, keys);
        if let Some(program) = &programs.made_for_picture {
            add_cut_keys(plan, program, keys);
        }
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let FrameContext { gpu, targets, plan, .. } = *frame;
        let wanted = Held::wanted(frame);
        if wanted.is_some() && self.held == wanted {
            board.put(self.drawing);
            return Ok(());
        }
        self.held = wanted;
        self.drawing.0 += 1;
        board.put(self.drawing);
        let (view, tile) = (&plan.input.view, plan.input.tile);
        let (cut, eye) = (CutBy::of_picture(frame), OpaqueEye::of_picture(frame));
        let hidden = cut.map(|by| by.cut);
        let kept = self.near.take();
        let sections = frame.cities.drawn_sections(&plan.details, hidden);
        let seen: Vec<Vec<SeenChunk>> = sections.iter().map(|drawn| visible(drawn, view, hidden)).collect();
        let parts = |keep: &dyn Fn(&DrawnSection, &SeenChunk) -> bool| -> Vec<SectionPart> {
            let zipped = sections.iter().zip(&seen);
            zipped.map(|(drawn, seen)| SectionPart { drawn: *drawn, chunks: chunks_of(drawn, seen, keep) }).collect()
        };
        // Layers of coplanar faces stay together and last: the later one wins where depths are equal.
        let hangs = |drawn: &DrawnSection| !drawn.section.kind.is_layer();
        let hanging = || sections.iter().zip(&seen).filter(|(drawn, _)| hangs(drawn)).flat_map(|(_, seen)| seen);
        let reach = if plan.settings.culls_hidden { culling_depth::reach(view, hanging()) } else { None };
        let Some(reach) = reach else {
            draw_opaque(frame, recording, &eye, "geometry", &parts(&|_, _| true), cut, true);
            self.near = kept;
            return Ok(());
        };
        let is_near = |drawn: &DrawnSection, s: &SeenChunk| hangs(drawn) && s.distance <= reach;
        draw_opaque(frame, recording, &eye, "geometry", &parts(&is_near), cut, true);
        let mut near = match kept {
            Some(near) if near.fits(&targets.depth.texture) => near,
            _ => CullingDepth::new(gpu, tile.size)?,
        };
        near.copy(&mut recording.encoder, &targets.depth.texture);
        recording.submit(gpu);
        near.read(gpu)?;
        let rest = parts(&|drawn, s| !is_near(drawn, s) && !near.hides(view, tile, &s.chunk.bounds));
        draw_opaque(frame, recording, &eye, "geometry beyond", &rest, cut, false);
        self.near = Some(near);
        Ok(())
    }
}

/// The chunks of a section that are kept.
fn chunks_of<'a>(
    drawn: &DrawnSection<'a>,
    seen: &[SeenChunk<'a>],
    keep: &dyn Fn(&DrawnSection, &SeenChunk) -> bool,
) -> Vec<&'a crate::render::city::Chunk> {
    seen.iter().filter(|s| keep(drawn, s)).map(|s| s.chunk).collect()
}
