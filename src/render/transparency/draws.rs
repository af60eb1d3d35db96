//! The draws of what may be translucent.

use std::hash::BuildHasher as _;

use crate::{
    render::{
        city::{Chunk, CityBuffers, SectionKind, draws_of},
        contents::DrawnSection,
        cut::Cut,
        frame::FrameInput,
        key::Key,
        renderer::Renderer,
    },
    view::Frustum,
};

impl Renderer {
    /// Draws the chunks that may be translucent, each kind of section by the pipeline that `key_of` names (its second argument: whether
    /// its city has normals per vertex, and whether all of the chunks is translucent, nothing opaque or hidden among it); `bind`
    /// binds group 1. Returns draws and triangles.
    pub(in crate::render) fn draw_reached(
        &self,
        pass: &mut wgpu::RenderPass,
        input: &FrameInput,
        cut: &Cut,
        key_of: impl Fn(SectionKind, [bool; 2]) -> Key,
        bind: impl Fn(&mut wgpu::RenderPass, u32),
    ) -> (u32, u64) {
        let frustum: Frustum = input.view.frustum(1.0);
        let mut counted = (0, 0);
        let mut sections = self.drawn_sections(Some(cut));
        if self.shuffled.is_some_and(|by| by % 2 == 1) {
            sections.reverse();
        }
        for drawn in sections {
            let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, Some(cut), &input.view));
            let seen = CityBuffers::visible(shown, &frustum, input.view.camera.eye);
            let DrawnSection { city, section, image, content, offset, layer, .. } = drawn;
            let (all, some): (Vec<&Chunk>, Vec<&Chunk>) = seen
                .iter()
                .map(|s| s.chunk)
                .filter(|chunk| cut.hiding.may_clear(chunk, &input.view))
                .partition(|chunk| content.is_none() && cut.hiding.keeps_all_clear(chunk, &input.view));
            for (mut reached, is_all) in [(all, true), (some, false)] {
                if reached.is_empty() {
                    continue;
                }
                // What is opaque is there already, so the order is free: neighbours become one draw.
                reached.sort_unstable_by_key(|chunk| chunk.range.start);
                pass.set_pipeline(self.pipelines.get(&key_of(section.kind, [city.buffers.smooth, is_all])));
                bind(pass, offset);
                if let Some(image) = image {
                    pass.set_bind_group(3, image, &[]);
                }
                pass.set_vertex_buffer(0, section.vertices.slice(..));
                if let Some(extra) = &section.extra {
                    pass.set_vertex_buffer(1, extra.slice(..));
                }
                let (mut draws, triangles) = draws_of(reached.into_iter());
                if let Some(by) = self.shuffled {
                    draws = draws.into_iter().flatten().step_by(3).map(|first| first..first + 3).collect();
                    draws.sort_by_key(|draw| rustc_hash::FxBuildHasher.hash_one([draw.start, by]));
                }
                pass.set_index_buffer(section.indices.slice(..), wgpu::IndexFormat::Uint32);
                draws.iter().for_each(|range| pass.draw_indexed(range.clone(), 0, layer..layer + 1));
                counted = (counted.0 + draws.len() as u32, counted.1 + triangles);
            }
        }
        counted
    }
}
