//! Drawing what may be translucent of the city: what passes over layers share.

use std::hash::BuildHasher as _;

use crate::render::{
    cities::DrawnSection,
    city::{Chunk, draws_of},
    city_facts::SectionFacts,
    cut::Cut,
    pass::{
        context::FrameContext,
        opaque::{draw_corners, set_section, visible},
    },
    resource::{key::PipelineKey, recording::Counted},
};

/// Draws the chunks that may be translucent, each section by the pipeline that `key_of` names (its second argument: whether all of the
/// chunks is translucent, nothing opaque or hidden among it); `bind` binds the group that has the city's offset. `can_hold`: whether
/// these are pipelines of triangles that hold their depth, where the plan asks for it.
pub fn draw_translucent<K: PipelineKey>(
    frame: &FrameContext,
    pass: &mut wgpu::RenderPass,
    cut: Option<&Cut>,
    can_hold: bool,
    key_of: impl Fn(&SectionFacts, bool) -> K,
    bind: impl Fn(&mut wgpu::RenderPass, u32),
) -> Counted {
    let (view, shuffled) = (&frame.plan.input.view, frame.plan.settings.shuffled);
    let mut counted = Counted::NONE;
    let Some(cut) = cut else { return counted };
    let mut sections = frame.cities.drawn_sections(&frame.plan.details, Some(cut));
    if shuffled.is_some_and(|by| by % 2 == 1) {
        sections.reverse();
    }
    for drawn in sections {
        let seen = visible(&drawn, &frame.plan.input.view, Some(cut));
        let facts = drawn.facts();
        let holds_depth = can_hold && frame.plan.holds_depth(&facts);
        let (all, some): (Vec<&Chunk>, Vec<&Chunk>) = seen
            .iter()
            .map(|s| s.chunk)
            .filter(|chunk| cut.hiding.may_clear(chunk, view, drawn.content.is_some()))
            .partition(|chunk| drawn.content.is_none() && cut.hiding.keeps_all_clear(chunk, view));
        for (chunks, is_all) in [(all, true), (some, false)] {
            if chunks.is_empty() {
                continue;
            }
            let key = key_of(&facts, is_all);
            pass.set_pipeline(frame.pipelines.get(&key));
            bind(pass, drawn.offset);
            set_section(frame, pass, &drawn, holds_depth);
            counted += draw_chunks(pass, &drawn, chunks, shuffled, holds_depth);
        }
    }
    counted
}

/// Draws chunks of a section; `shuffled`: triangle by triangle, in an order shuffled by this number.
fn draw_chunks(
    pass: &mut wgpu::RenderPass,
    drawn: &DrawnSection,
    mut chunks: Vec<&Chunk>,
    shuffled: Option<u32>,
    holds_depth: bool,
) -> Counted {
    // What is opaque is there already, so the order is free: neighbours become one draw.
    chunks.sort_unstable_by_key(|chunk| chunk.range.start);
    let (mut runs, triangles) = draws_of(chunks.into_iter().map(|chunk| chunk.range.clone()));
    if let Some(by) = shuffled {
        runs = runs.into_iter().flatten().step_by(3).map(|first| first..first + 3).collect();
        runs.sort_by_key(|run| rustc_hash::FxBuildHasher.hash_one([run.start, by]));
    }
    draw_corners(pass, &runs, drawn.layer, holds_depth);
    Counted { draws: runs.len() as u32, triangles }
}
