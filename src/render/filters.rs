//! Neighbourhood filters (K3): a lens' own image, unmasked, shaded over the lens' bounds and what the filter reaches beyond
//! them; then the filter down and across.
//!
//! Filters that read the same image have it shaded once, and uses that would make the same image share it. A filter reads
//! four pixels at once, so four are shaded at once.

use std::ops::Range;

use crate::render::{
    eye::PictureTile,
    frame::{FrameInput, Recorder, behind, color_attachment, scissor},
    key::Key,
    layout,
    octagon::{Mesh, Octagon, merged},
    operations::Filter,
    renderer::{Renderer, STAGE_STRIDE},
    seen::{SeenVolume, part_of},
};

/// Pixels to a texel of what is shaded for a filter, and of what it makes.
const UNFILTERED_BLOCK: [u32; 2] = [4, 1];
const FILTERED_BLOCK: [u32; 2] = [4, 4];

/// The stages of a filter in a picture of this size: for each of its images down, and across.
pub(super) fn stages(filter: &Filter, size: [u32; 2], images: usize) -> Vec<layout::FilterStage> {
    let stage = |step, length, layers, layer: usize| layout::FilterStage {
        step,
        reach: filter.reach as i32,
        first: filter.parameters,
        length: length as i32,
        layers,
        layer: layer as i32,
        pad_0: 0,
    };
    (0..images).flat_map(|image| [stage([0, 1], size[1], 1, image), stage([1, 0], size[0], 4, 0)]).collect()
}

impl Renderer {
    /// All filters of a frame; `keys` holds for each what shades the image it reads.
    pub(super) fn filter_passes(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (filters, parts): (&[Filter], &[FilterParts]),
        keys: &[Key],
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let Some([down, across]) = &groups.filters else { return };
        let images = behind(input).images();
        // A filter reads no image that a later one makes: those that read the same image may as well come first.
        for i in (0..filters.len()).filter(|&i| is_first(filters, i)) {
            let lenses: Vec<u32> = with_same_image(filters, i).flat_map(|k| lenses_of(&filters[k])).collect();
            let into = &targets.unfiltered.layers[..images];
            self.filter_pass(encoder, recorder, ("unfiltered", &lenses), into, &parts[i].unfiltered, |pass| {
                pass.set_pipeline(self.pipelines.get(&keys[i]));
                pass.set_bind_group(0, &groups.view, &[]);
                pass.set_bind_group(1, &groups.shade, &[]);
                pass.set_bind_group(2, &groups.lenses, &[]);
            });
            for k in with_same_image(filters, i) {
                let lenses: Vec<u32> = lenses_of(&filters[k]).collect();
                for image in 0..images {
                    let stage = |direction| ((2 * (k * images + image) + direction) as u64 * STAGE_STRIDE) as u32;
                    let lines = 4 * (k * images + image);
                    let mut filter_in = |name, group, direction, into: &[wgpu::TextureView], parts: &[Piece]| {
                        self.filter_pass(encoder, recorder, (name, &lenses), into, parts, |pass| {
                            pass.set_pipeline(self.pipelines.get(&Key::Filter(filters[k].effect)));
                            pass.set_bind_group(0, group, &[stage(direction)]);
                        });
                    };
                    let made = &targets.filtered.layers[lines..lines + 4];
                    filter_in("filter down", down, 0, &targets.half_filtered.layers, &parts[k].down);
                    filter_in("filter across", across, 1, made, &parts[k].across);
                }
            }
        }
    }

    fn filter_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        (name, lenses): (&'static str, &[u32]),
        into: &[wgpu::TextureView],
        parts: &[Piece],
        set: impl FnOnce(&mut wgpu::RenderPass),
    ) {
        let slot = recorder.begin(name, "main", lenses, true);
        let attachments: Vec<_> = into
            .iter()
            .map(|view| {
                // Every texel that is read with any weight is written first.
                let mut kept = color_attachment(view, wgpu::Color::TRANSPARENT);
                kept.ops.load = wgpu::LoadOp::Load;
                Some(kept)
            })
            .collect();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &attachments,
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        set(&mut pass);
        pass.set_vertex_buffer(0, self.buffers.mesh.buffer().slice(..));
        let (mut draws, mut triangles) = (0, 0);
        for (corners, tile) in parts.iter().filter(|(_, tile)| !tile.is_empty()) {
            scissor(&mut pass, *tile);
            pass.draw(corners.clone(), 0..1);
            (draws, triangles) = (draws + 1, triangles + corners.len() as u64 / 3);
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(draws, triangles);
    }
}

fn lenses_of(filter: &Filter) -> impl Iterator<Item = u32> {
    filter.uses.iter().filter_map(|(lens, _)| *lens)
}

/// Corners of the frame's mesh, and texels that cut what they span.
type Piece = (Range<u32>, PictureTile);

/// Where a filter and what it reads are drawn.
pub(super) struct FilterParts {
    /// The image that it reads, and others that read the same; of the first of these.
    unfiltered: Vec<Piece>,
    down: Vec<Piece>,
    across: Vec<Piece>,
}

/// Where the uses of a filter may be seen.
fn areas_of(filter: &Filter, size: [u32; 2], seen: &[SeenVolume]) -> Vec<Octagon> {
    let of_use = |(lens, _): &(Option<u32>, u32)| match lens {
        None => Some(Octagon::whole(size)),
        Some(lens) => part_of(seen.iter().filter(|v| v.lens == *lens)),
    };
    merged(filter.uses.iter().filter_map(of_use).collect())
}

/// Where the filters of a frame are drawn, each over what the ones after it read.
pub(super) fn parts(filters: &[Filter], size: [u32; 2], seen: &[SeenVolume], mesh: &mut Mesh) -> Vec<FilterParts> {
    let areas: Vec<Vec<Octagon>> = filters.iter().map(|f| areas_of(f, size, seen)).collect();
    let grown = |k: usize, by: [i32; 2]| areas[k].iter().map(move |area| area.grown(by)).collect::<Vec<_>>();
    let parts_of = |i: usize| {
        let reach = filters[i].reach as i32;
        let mut add =
            |parts: Vec<Octagon>, block| merged(parts).into_iter().flat_map(|p| mesh.add(p, size, block)).collect();
        let unfiltered = match is_first(filters, i) {
            true => with_same_image(filters, i).flat_map(|k| grown(k, [filters[k].reach as i32; 2])).collect(),
            false => Vec::new(),
        };
        FilterParts {
            unfiltered: add(unfiltered, UNFILTERED_BLOCK),
            down: add(grown(i, [reach, 0]), FILTERED_BLOCK),
            across: add(areas[i].clone(), FILTERED_BLOCK),
        }
    };
    (0..filters.len()).map(parts_of).collect()
}

/// Whether no filter before it reads the same image.
fn is_first(filters: &[Filter], i: usize) -> bool {
    filters[..i].iter().all(|f| f.plan != filters[i].plan)
}

/// It and the filters after it that read the same image.
fn with_same_image(filters: &[Filter], i: usize) -> impl Iterator<Item = usize> {
    (i..filters.len()).filter(move |&k| filters[k].plan == filters[i].plan)
}
