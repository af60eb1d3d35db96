//! Neighbourhood filters (K3): a lens' own image, unmasked, shaded over the lens' bounds and what the filter reaches beyond
//! them; then the filter across and down.
//!
//! Filters that read the same image have it shaded once, and uses that would make the same image share it.

use crate::render::{
    eye::{PictureTile, split},
    frame::{FrameInput, Recorder, color_attachment, scissor},
    layout,
    operations::Filter,
    pipelines::Key,
    renderer::{Renderer, STAGE_STRIDE},
    seen::SeenVolume,
};

/// The stages of a filter, across and down, in a picture of this size.
pub(super) fn stages(filter: &Filter, size: [u32; 2]) -> [layout::FilterStage; 2] {
    [([1, 0], size[0]), ([0, 1], size[0].div_ceil(4))].map(|(step, columns)| layout::FilterStage {
        step,
        reach: filter.reach as i32,
        first: filter.parameters,
        size: size.map(|s| s as i32),
        columns: columns as i32,
        pad_0: 0,
    })
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
        let Some([across, down]) = &groups.filters else { return };
        let size = input.tile.size;
        let whole = PictureTile::whole(size);
        let areas: Vec<Vec<PictureTile>> = filters.iter().map(|f| areas_of(f, size, seen)).collect();
        let columns = size[0].div_ceil(4);
        for (i, filter) in filters.iter().enumerate() {
            // A filter reads no image that a later one makes: those that read the same image may as well come first.
            if filters[..i].iter().any(|f| f.plan == filter.plan) {
                continue;
            }
            let same = || (i..).zip(&filters[i..]).filter(|(_, f)| f.plan == filter.plan);
            let wanted: Vec<PictureTile> =
                same().flat_map(|(k, f)| areas[k].iter().map(|area| grown(*area, [f.reach; 2], whole))).collect();
            let lenses: Vec<u32> = same().flat_map(|(_, f)| lenses_of(f)).collect();
            let unfiltered = [&targets.unfiltered[0].layers[0]];
            self.filter_pass(encoder, recorder, "unfiltered", &lenses, &unfiltered, &mut |pass| {
                pass.set_bind_group(0, &groups.view, &[]);
                pass.set_bind_group(1, &groups.shade, &[]);
                pass.set_bind_group(2, &groups.lenses, &[]);
                let mut drawn = 0;
                let rectangles = merged(wanted.clone());
                for key in &keys[i] {
                    pass.set_pipeline(self.pipelines.get(key));
                    drawn += fill(pass, rectangles.iter().copied());
                }
                drawn
            });
            for (k, filter) in same() {
                let lenses: Vec<u32> = lenses_of(filter).collect();
                let key = Key::Filter(filter.effect);
                let stage = |direction: usize| ((2 * k + direction) as u64 * STAGE_STRIDE) as u32;
                let half: Vec<&wgpu::TextureView> = targets.unfiltered[1].layers.iter().collect();
                self.filter_pass(encoder, recorder, "filter across", &lenses, &half, &mut |pass| {
                    pass.set_pipeline(self.pipelines.get(&key));
                    pass.set_bind_group(0, across, &[stage(0)]);
                    let rows = areas[k].iter().map(|area| grown(*area, [0, filter.reach], whole)).collect();
                    fill(pass, merged(rows).into_iter().map(|area| quartered(area, 0)))
                });
                let low: Vec<&wgpu::TextureView> = targets.filtered.layers[4 * k..4 * k + 4].iter().collect();
                self.filter_pass(encoder, recorder, "filter down", &lenses, &low, &mut |pass| {
                    pass.set_pipeline(self.pipelines.get(&key));
                    pass.set_bind_group(0, down, &[stage(1)]);
                    let quarters = areas[k].iter().map(|area| quartered(quartered(*area, 0), 1));
                    let beside = |part: PictureTile| {
                        (0..4).map(move |n| PictureTile {
                            origin: [part.origin[0] + n * columns, part.origin[1]],
                            ..part
                        })
                    };
                    fill(pass, quarters.flat_map(beside))
                });
            }
        }
    }

    fn filter_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        name: &'static str,
        lenses: &[u32],
        into: &[&wgpu::TextureView],
        draw: &mut dyn FnMut(&mut wgpu::RenderPass) -> u32,
    ) {
        let Some(targets) = &self.targets else { return };
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
        // What shades is tested against the city; a filter is not.
        let is_shading = into.len() == 1;
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

/// Where a rectangle is in images that hold every fourth pixel along an axis.
fn quartered(mut part: PictureTile, axis: usize) -> PictureTile {
    let end = (part.origin[axis] + part.size[axis]).div_ceil(4);
    part.origin[axis] /= 4;
    part.size[axis] = end - part.origin[axis];
    part
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
    fn quarters_hold_every_pixel() {
        for (x, w) in [(0, 1), (3, 1), (3, 2), (4, 4), (5, 8)] {
            let quarter = quartered(tile(x, 7, w, 2), 0);
            for pixel in x..x + w {
                assert!((quarter.origin[0]..quarter.origin[0] + quarter.size[0]).contains(&(pixel / 4)));
            }
            assert_eq!((quarter.origin[1], quarter.size[1]), (7, 2));
        }
    }
}
