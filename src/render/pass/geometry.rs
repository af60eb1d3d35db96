//! The city, every triangle at most once: in one pass, or what is near first and then what it does not hide.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cities::DrawnSection,
        city::SeenChunk,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass},
            culling_depth::{self, CullingDepth},
            opaque::{CutBy, SectionPart, add_cut_keys, add_whole_keys, draw_opaque, visible},
        },
        plan::FramePlan,
        programs::Programs,
        resource::recording::Recording,
    },
};

/// What it keeps: the near depth of the last frame that culled by it.
#[derive(Debug)]
pub struct Geometry {
    near: Option<CullingDepth>,
}

impl Pass for Geometry {
    type Input<'a> = ();

    const LIST: &'static [Line] = &[
        ("geometry", "everything once; on a software adapter what is near, and then"),
        ("geometry beyond", "what that does not hide, where it hides much"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { near: None })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        plan.plans.regions.is_none().then_some(())
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
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let FrameContext { gpu, targets, plan, .. } = *frame;
        let (view, tile) = (&plan.input.view, plan.input.tile);
        let cut = CutBy::of_picture(frame);
        let hidden = cut.map(|by| by.cut);
        let kept = self.near.take();
        let sections = frame.cities.drawn_sections(&plan.details, hidden);
        let seen: Vec<Vec<SeenChunk>> = sections.iter().map(|drawn| visible(drawn, frame, hidden)).collect();
        let parts = |keep: &dyn Fn(&DrawnSection, &SeenChunk) -> bool| -> Vec<SectionPart> {
            let zipped = sections.iter().zip(&seen);
            zipped.map(|(drawn, seen)| SectionPart { drawn: *drawn, chunks: chunks_of(drawn, seen, keep) }).collect()
        };
        // Layers of coplanar faces stay together and last: the later one wins where depths are equal.
        let hangs = |drawn: &DrawnSection| !drawn.section.kind.is_layer();
        let hanging = || sections.iter().zip(&seen).filter(|(drawn, _)| hangs(drawn)).flat_map(|(_, seen)| seen);
        let reach = if plan.settings.culls_hidden { culling_depth::reach(view, hanging()) } else { None };
        let Some(reach) = reach else {
            draw_opaque(frame, recording, "geometry", &parts(&|_, _| true), cut, true);
            self.near = kept;
            return Ok(());
        };
        let is_near = |drawn: &DrawnSection, s: &SeenChunk| hangs(drawn) && s.distance <= reach;
        draw_opaque(frame, recording, "geometry", &parts(&is_near), cut, true);
        let mut near = match kept {
            Some(near) if near.fits(&targets.depth.texture) => near,
            _ => CullingDepth::new(gpu, tile.size)?,
        };
        near.copy(&mut recording.encoder, &targets.depth.texture);
        recording.submit(gpu);
        near.read(gpu)?;
        let rest = parts(&|drawn, s| !is_near(drawn, s) && !near.hides(view, tile, &s.chunk.bounds));
        draw_opaque(frame, recording, "geometry beyond", &rest, cut, false);
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
