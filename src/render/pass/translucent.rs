//! Drawing what may be translucent of the city: what passes over layers share.

use std::hash::BuildHasher as _;

use crate::render::{
    cities::DrawnSection,
    city::{Chunk, SectionKind, draws_of},
    cut::Cut,
    pass::{
        context::FrameContext,
        opaque::{set_section, visible},
    },
    resource::{key::PipelineKey, recording::Counted},
};

/// Draws the chunks that may be translucent, each kind of section by the pipeline that `key_of` names (its second argument: whether
/// its city has normals per vertex; its third: whether all of the chunks is translucent, nothing opaque or hidden among it); `bind`
/// binds the group that has the city's offset.
pub fn draw_translucent<K: PipelineKey>(
    frame: &FrameContext,
    pass: &mut wgpu::RenderPass,
    cut: &Cut,
    key_of: impl Fn(SectionKind, bool, bool) -> K,
    bind: impl Fn(&mut wgpu::RenderPass, u32),
) -> Counted {
    let (view, shuffled) = (&frame.plan.input.view, frame.plan.settings.shuffled);
    let mut counted = Counted::NONE;
    let mut sections = frame.cities.drawn_sections(&frame.plan.details, Some(cut));
    if shuffled.is_some_and(|by| by % 2 == 1) {
        sections.reverse();
    }
    for drawn in sections {
        let seen = visible(&drawn, frame, Some(cut));
        let (all, some): (Vec<&Chunk>, Vec<&Chunk>) = seen
            .iter()
            .map(|s| s.chunk)
            .filter(|chunk| cut.hiding.may_clear(chunk, view))
            .partition(|chunk| drawn.content.is_none() && cut.hiding.keeps_all_clear(chunk, view));
        for (chunks, is_all) in [(all, true), (some, false)] {
            if chunks.is_empty() {
                continue;
            }
            let key = key_of(drawn.section.kind, drawn.city.buffers.smooth, is_all);
            pass.set_pipeline(frame.pipelines.get(&key));
            bind(pass, drawn.offset);
            counted += draw_chunks(pass, &drawn, chunks, shuffled);
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
) -> Counted {
    // What is opaque is there already, so the order is free: neighbours become one draw.
    chunks.sort_unstable_by_key(|chunk| chunk.range.start);
    set_section(pass, drawn);
    let (mut runs, triangles) = draws_of(chunks.into_iter());
    if let Some(by) = shuffled {
        runs = runs.into_iter().flatten().step_by(3).map(|first| first..first + 3).collect();
        runs.sort_by_key(|run| rustc_hash::FxBuildHasher.hash_one([run.start, by]));
    }
    pass.set_index_buffer(drawn.section.indices.slice(..), wgpu::IndexFormat::Uint32);
    runs.iter().for_each(|run| pass.draw_indexed(run.clone(), 0, drawn.layer..drawn.layer + 1));
    Counted { draws: runs.len() as u32, triangles }
}
