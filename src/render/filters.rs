//! Neighbourhood filters (K3): a lens' own image, unmasked, shaded over the lens' bounds and what the filter reaches beyond
//! them; then the filter down and across.
//!
//! Filters that read the same image have it shaded once, and uses that would make the same image share it. A filter reads
//! four pixels at once; that is what a copy to a texture of other texels is for.

use crate::render::{
    eye::{PictureTile, split},
    frame::{FrameInput, Recorder, behind, color_attachment, scissor},
    layout,
    operations::Filter,
    pipelines::Key,
    renderer::{Renderer, STAGE_STRIDE},
    seen::SeenVolume,
    targets::{Targets, row_bytes},
};

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

/// Where a filter's image is shaded.
enum Into<'a> {
    /// Tested against the city.
    Shaded(&'a [wgpu::TextureView]),
    /// Each of the four lines of a block.
    Lines(&'a [wgpu::TextureView]),
}

impl Renderer {
    /// All filters of a frame; `keys` holds for each what shades the image it reads.
    pub(super) fn filter_passes(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        seen: &[SeenVolume],
        filters: &[Filter],
        keys: &[Vec<Key>],
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let Some([down, across]) = &groups.filters else { return };
        let size = input.tile.size;
        let whole = PictureTile::whole(size);
        let areas: Vec<Vec<PictureTile>> = filters.iter().map(|f| areas_of(f, size, seen)).collect();
        let images = behind(input).images();
        for (i, filter) in filters.iter().enumerate() {
            // A filter reads no image that a later one makes: those that read the same image may as well come first.
            if filters[..i].iter().any(|f| f.plan == filter.plan) {
                continue;
            }
            let same = || (i..).zip(&filters[i..]).filter(|(_, f)| f.plan == filter.plan);
            let around = |(k, f): (usize, &Filter)| -> Vec<PictureTile> {
                areas[k].iter().map(|area| in_fours(grown(*area, [f.reach; 2], whole), whole)).collect()
            };
            let wanted = merged(same().flat_map(around).collect());
            let lenses: Vec<u32> = same().flat_map(|(_, f)| lenses_of(f)).collect();
            let into = Into::Shaded(&targets.unfiltered.layers[..images]);
            self.filter_pass(encoder, recorder, "unfiltered", &lenses, &into, &mut |pass| {
                pass.set_bind_group(0, &groups.view, &[]);
                pass.set_bind_group(1, &groups.shade, &[]);
                pass.set_bind_group(2, &groups.lenses, &[]);
                let mut drawn = 0;
                for key in &keys[i] {
                    pass.set_pipeline(self.pipelines.get(key));
                    drawn += fill(pass, wanted.iter().copied());
                }
                drawn
            });
            gather_fours(encoder, targets, &wanted, images as u32);
            for (k, filter) in same() {
                let lenses: Vec<u32> = lenses_of(filter).collect();
                let key = Key::Filter(filter.effect);
                let columns: Vec<PictureTile> =
                    areas[k].iter().map(|area| in_fours(grown(*area, [filter.reach, 0], whole), whole)).collect();
                for image in 0..images {
                    let stage = |direction| ((2 * (k * images + image) + direction) as u64 * STAGE_STRIDE) as u32;
                    let lines = 4 * (k * images + image);
                    let mut filter_in = |name, group, direction, into: &[wgpu::TextureView], parts: &[PictureTile]| {
                        self.filter_pass(encoder, recorder, name, &lenses, &Into::Lines(into), &mut |pass| {
                            pass.set_pipeline(self.pipelines.get(&key));
                            pass.set_bind_group(0, group, &[stage(direction)]);
                            fill(pass, merged(parts.to_vec()).into_iter().map(blocks))
                        });
                    };
                    filter_in("filter down", down, 0, &targets.fours[1].layers, &columns);
                    filter_in("filter across", across, 1, &targets.filtered.layers[lines..lines + 4], &areas[k]);
                }
            }
        }
    }

    fn filter_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        name: &'static str,
        lenses: &[u32],
        into: &Into,
        draw: &mut dyn FnMut(&mut wgpu::RenderPass) -> u32,
    ) {
        let Some(targets) = &self.targets else { return };
        let slot = recorder.begin(name, "main", lenses, true);
        let (Into::Shaded(views) | Into::Lines(views)) = into;
        let attachments: Vec<_> = views
            .iter()
            .map(|view| {
                // Every texel that is read with any weight is written first.
                let mut kept = color_attachment(view, wgpu::Color::TRANSPARENT);
                kept.ops.load = wgpu::LoadOp::Load;
                Some(kept)
            })
            .collect();
        let is_shading = matches!(into, Into::Shaded(_));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &attachments,
            depth_stencil_attachment: is_shading.then_some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth.view,
                depth_ops: None, // only read
                stencil_ops: None,
            }),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        let drawn = draw(&mut pass);
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(drawn, u64::from(drawn));
    }
}

/// Makes one texel of four pixels that stand side by side: the same bytes.
fn gather_fours(encoder: &mut wgpu::CommandEncoder, targets: &Targets, parts: &[PictureTile], layers: u32) {
    let size = targets.needs.size;
    let row = row_bytes(size);
    for part in parts {
        let [x, y] = part.origin;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: u64::from(y) * u64::from(row) + u64::from(4 * x),
            bytes_per_row: Some(row),
            rows_per_image: Some(size[1]),
        };
        let bytes = wgpu::TexelCopyBufferInfo { buffer: &targets.unfiltered_bytes, layout };
        let at = |texture, x| wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x, y, z: 0 },
            aspect: wgpu::TextureAspect::All,
        };
        let extent = |width| wgpu::Extent3d { width, height: part.size[1], depth_or_array_layers: layers };
        encoder.copy_texture_to_buffer(at(&targets.unfiltered.texture, x), bytes, extent(part.size[0]));
        let fours = at(&targets.fours[0].texture, x / 4);
        encoder.copy_buffer_to_texture(bytes, fours, extent(part.size[0].div_ceil(4)));
    }
}

/// Fills rectangles with the pipeline that is set; how many.
fn fill(pass: &mut wgpu::RenderPass, parts: impl Iterator<Item = PictureTile>) -> u32 {
    let mut drawn = 0;
    for part in parts {
        scissor(pass, part);
        pass.draw(0..3, 0..1);
        drawn += 1;
    }
    drawn
}

fn lenses_of(filter: &Filter) -> impl Iterator<Item = u32> {
    filter.uses.iter().filter_map(|(lens, _)| *lens)
}

/// Where the uses of a filter may be seen.
fn areas_of(filter: &Filter, size: [u32; 2], seen: &[SeenVolume]) -> Vec<PictureTile> {
    let of_use = |(lens, _): &(Option<u32>, u32)| match lens {
        None => Some(PictureTile::whole(size)),
        Some(lens) => split(size, seen.iter().filter(|v| v.lens == *lens).map(|v| v.bounds)).0,
    };
    merged(filter.uses.iter().filter_map(of_use).map(|part| in_fours(part, PictureTile::whole(size))).collect())
}

/// A rectangle with what it takes to make whole fours of it, inside the whole.
fn in_fours(part: PictureTile, whole: PictureTile) -> PictureTile {
    let low = part.origin.map(|o| o / 4 * 4);
    let high: [u32; 2] =
        std::array::from_fn(|i| (part.origin[i] + part.size[i]).next_multiple_of(4).min(whole.size[i]));
    PictureTile { origin: low, size: [high[0] - low[0], high[1] - low[1]] }
}

/// The same rectangles; two become one where that is no larger than both.
fn merged(mut parts: Vec<PictureTile>) -> Vec<PictureTile> {
    let area = |p: &PictureTile| u64::from(p.size[0]) * u64::from(p.size[1]);
    let mut i = 0;
    while i < parts.len() {
        let joined = |k: usize| (k, around(parts[i], parts[k]));
        let fits = |(k, all): &(usize, PictureTile)| area(all) <= area(&parts[i]) + area(&parts[*k]);
        match (i + 1..parts.len()).map(joined).find(fits) {
            Some((k, all)) => {
                parts.swap_remove(k);
                parts[i] = all;
                // What did not fit one of them may fit both.
                i = 0;
            }
            None => i += 1,
        }
    }
    parts
}

/// The rectangle around two.
fn around(a: PictureTile, b: PictureTile) -> PictureTile {
    let low: [u32; 2] = std::array::from_fn(|i| a.origin[i].min(b.origin[i]));
    let high: [u32; 2] = std::array::from_fn(|i| (a.origin[i] + a.size[i]).max(b.origin[i] + b.size[i]));
    PictureTile { origin: low, size: [high[0] - low[0], high[1] - low[1]] }
}

/// A rectangle with so many pixels more on either side, inside the whole.
fn grown(part: PictureTile, by: [u32; 2], whole: PictureTile) -> PictureTile {
    let low: [u32; 2] = std::array::from_fn(|i| part.origin[i].saturating_sub(by[i]));
    let high: [u32; 2] = std::array::from_fn(|i| (part.origin[i] + part.size[i] + by[i]).min(whole.size[i]));
    PictureTile { origin: low, size: [high[0] - low[0], high[1] - low[1]] }
}

/// Where a rectangle of whole fours is in images of blocks of four by four pixels.
fn blocks(part: PictureTile) -> PictureTile {
    PictureTile { origin: part.origin.map(|o| o / 4), size: part.size.map(|s| s.div_ceil(4)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(x: u32, y: u32, w: u32, h: u32) -> PictureTile {
        PictureTile { origin: [x, y], size: [w, h] }
    }

    #[test]
    fn rectangles_that_overlap_much_become_one_and_nothing_is_lost() {
        assert_eq!(merged(vec![tile(0, 0, 10, 10), tile(1, 1, 10, 10)]), [tile(0, 0, 11, 11)]);
        let apart = vec![tile(0, 0, 2, 2), tile(90, 90, 2, 2)];
        assert_eq!(merged(apart.clone()), apart);
        // Two halves of a square, then its other half.
        let three = vec![tile(0, 0, 4, 4), tile(4, 4, 4, 4), tile(4, 0, 4, 4), tile(0, 4, 4, 4)];
        assert_eq!(merged(three), [tile(0, 0, 8, 8)]);
    }

    #[test]
    fn blocks_hold_every_pixel() {
        let whole = tile(0, 0, 13, 30);
        for (x, w) in [(0, 1), (3, 1), (3, 2), (4, 4), (5, 8), (11, 2)] {
            let fours = in_fours(tile(x, 7, w, 2), whole);
            assert_eq!(fours.origin[0] % 4, 0);
            assert!(fours.origin[0] + fours.size[0] <= whole.size[0]);
            let blocks = blocks(fours);
            for pixel in x..x + w {
                assert!((blocks.origin[0]..blocks.origin[0] + blocks.size[0]).contains(&(pixel / 4)));
            }
            assert_eq!((blocks.origin[1], blocks.size[1]), (1, 2));
        }
    }
}
