//! K-buffer and peeling: the nearest layers of each pixel in slots (`lib/slots.wgsl`), then as lists for the pass that lays the
//! exact method's one over the other.

use crate::{
    gpu::GpuError,
    render::{
        eye::PictureTile,
        frame::{FrameInput, Recorder, read_depth, scissor, strided},
        key::Key,
        layers::{HEADER, LAYER_BYTES, LayerDraw, LayerFigures, LayersOnGpu},
        renderer::{Renderer, STAGE_STRIDE, all_of, group, whole},
        synced::Synced,
        transparency::{FragmentPass, MethodFigures, SlotKeys},
    },
};

/// What the card has of slots between frames.
#[derive(Debug)]
pub(in crate::render) struct SlotsOnGpu {
    /// Heads and records of pixels, slots, and what is read of them.
    lists: LayersOnGpu,
    /// Words of the slots of the largest band.
    words: u64,
    /// The bands, each at its offset, once for the first round of peeling and once for the others.
    bands: Synced,
}

/// Bytes of a pixel of the targets of what finds no slot.
const TAIL_BYTES: u64 = 20;

/// A band, as `pass/link-slots.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Band {
    origin: [u32; 2],
    size: [u32; 2],
    picture: [u32; 2],
    round: u32,
    reserved: u32,
}

impl Band {
    const SIZE: Option<wgpu::BufferSize> = wgpu::BufferSize::new(size_of::<Self>() as u64);
}

/// The parts of a region that so many pixels have room for, by whole rows.
fn bands_of(region: PictureTile, pixels: u64) -> Vec<PictureTile> {
    let rows = (pixels / u64::from(region.size[0].max(1))).clamp(1, u64::from(region.size[1].max(1))) as u32;
    let starts = (0..region.size[1]).step_by(rows as usize);
    let band = |y: u32| PictureTile {
        origin: [region.origin[0], region.origin[1] + y],
        size: [region.size[0], rows.min(region.size[1] - y)],
    };
    starts.map(band).collect()
}

impl Renderer {
    /// Makes the layers of a frame by slots; what was recorded before is submitted.
    pub(in crate::render) fn slot_passes(
        &mut self,
        mut encoder: wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (draw, keys): (&LayerDraw, SlotKeys),
        region: PictureTile,
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        let size = input.tile.size;
        let mut own = match self.slots.take() {
            Some(own) => own,
            None => SlotsOnGpu {
                lists: LayersOnGpu::new(&self.gpu)?,
                words: 0,
                bands: Synced::new(&self.gpu, "bands of layers", wgpu::BufferUsages::UNIFORM)?,
            },
        };
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        own.lists.heads.fit(&self.gpu, 4 * (HEADER + pixels * u64::from(1 + keys.record)))?;
        let of_pixel = 4 * u64::from(keys.slots * keys.words);
        let most = self.most_layers.map_or(LAYER_BYTES, |layers| 4 * u64::from(keys.words) * layers);
        let bands = bands_of(region, most.checked_div(of_pixel).unwrap_or(u64::MAX));
        let room = of_pixel * u64::from(region.size[0]) * u64::from(bands.first().map_or(0, |band| band.size[1]));
        own.lists.notes.fit(&self.gpu, room)?;
        own.words = room / 4;
        let rounds = |round| {
            let stage = move |band: &PictureTile| Band {
                origin: band.origin,
                size: band.size,
                picture: size,
                round,
                reserved: 0,
            };
            bands.iter().flat_map(move |band| strided(&stage(band)))
        };
        own.bands.sync(&self.gpu, &rounds(0).chain(rounds(1)).collect::<Vec<u8>>())?;
        encoder.clear_buffer(own.lists.heads.buffer(), 0, None);
        let of_tail = if keys.has_tail() { pixels * TAIL_BYTES } else { 0 };
        let mut figures = MethodFigures { bytes: own.lists.bytes() + of_tail, ..MethodFigures::default() };
        // How many layers there are at most is known after the last band.
        if draw.keys.asks_most && bands.len() > 1 {
            for (i, band) in bands.iter().enumerate() {
                self.fill_slots(&mut encoder, recorder, input, (draw, &keys, &own), (i, *band), &keys.passes()[..1]);
                self.link_slots(&mut encoder, recorder, (&keys, &own), (i, *band));
            }
            // All but that is found again.
            encoder.clear_buffer(own.lists.heads.buffer(), 0, Some(4));
            encoder.clear_buffer(own.lists.heads.buffer(), 8, None);
        }
        let (mut notes, mut left) = (0, 0);
        for (i, band) in bands.iter().enumerate() {
            let mut round = 0;
            loop {
                let at = if round == 0 { i } else { bands.len() + i };
                if keys.slots > 0 {
                    self.fill_slots(&mut encoder, recorder, input, (draw, &keys, &own), (at, *band), keys.passes());
                    self.link_slots(&mut encoder, recorder, (&keys, &own), (at, *band));
                }
                if keys.has_tail() {
                    let slots = [own.slots(), own.band()];
                    self.tail_pass(&mut encoder, recorder, input, (draw, keys, slots), (at, *band));
                }
                self.composite_layers(&mut encoder, recorder, draw, &own.lists, (*band, own.words), size);
                round += 1;
                if !keys.is_peeling() && i + 1 < bands.len() {
                    break;
                }
                let [all, rest] = self.count_slots(&mut encoder, &own)?;
                notes = all;
                encoder.clear_buffer(own.lists.heads.buffer(), 8, Some(4));
                let is_over = keys.limit > 0 && round * keys.slots >= keys.limit;
                if is_over || rest == 0 || !keys.is_peeling() {
                    left += rest;
                    break;
                }
            }
            figures.rounds += if keys.is_peeling() { round } else { 0 };
        }
        if keys.is_peeling() {
            figures.dropped = left;
        } else {
            figures.merged = (keys.slots > 0).then_some(left);
        }
        self.layer_figures = LayerFigures { notes, bands: bands.len() as u32, excess: 0 };
        self.method_figures = figures;
        self.slots = Some(own);
        Ok(encoder)
    }

    /// Finds the nearest layers of the pixels of a band, `at` its place among the bands.
    fn fill_slots(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (draw, keys, own): (&LayerDraw, &SlotKeys, &SlotsOnGpu),
        (at, band): (usize, PictureTile),
        passes: &[FragmentPass],
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        encoder.clear_buffer(own.lists.notes.buffer(), 0, None);
        let entries = [
            (0, whole(self.buffers.view.buffer())),
            (1, whole(own.lists.heads.buffer())),
            (2, own.slots()),
            (3, all_of(&targets.depth)),
            (4, own.band()),
        ];
        let view = group(&self.gpu, "slots of layers", &self.pipelines.layouts.slots, &entries);
        let early = self.gpu.tests_depth_early();
        for &of in passes {
            let name = of.name();
            let slot = recorder.begin(name, "main", &draw.cut.hiding.lenses, true);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(name),
                depth_stencil_attachment: Some(read_depth(&targets.depth.view)),
                timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
                ..Default::default()
            });
            if let Some(timer) = &recorder.timer {
                timer.begin_count(&mut pass, slot);
            }
            scissor(&mut pass, band);
            pass.set_bind_group(0, &view, &[(at as u64 * STAGE_STRIDE) as u32]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            let (draws, triangles) = self.draw_reached(
                &mut pass,
                input,
                draw.cut,
                |kind, [is_smooth, _]| draw.keys.translucent_key(*keys, (kind.into(), is_smooth), of, early),
                |pass, offset| pass.set_bind_group(1, &groups.cut_city, &[offset; 2]),
            );
            if let Some(timer) = &recorder.timer {
                timer.end_count(&mut pass, slot);
            }
            drop(pass);
            recorder.count(draws, triangles);
        }
    }

    /// Makes lists of the slots of a band, and counts what has none.
    fn link_slots(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        (keys, own): (&SlotKeys, &SlotsOnGpu),
        (at, band): (usize, PictureTile),
    ) {
        let entries = [(0, whole(own.lists.heads.buffer())), (1, own.slots()), (2, own.band())];
        let lists = group(&self.gpu, "slots as lists", &self.pipelines.layouts.link_slots, &entries);
        let slot = recorder.begin("link slots", "main", &[], false);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("link slots"),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.compute_writes(slot)),
        });
        pass.set_pipeline(self.pipelines.get_compute(&Key::LinkSlots(*keys)));
        pass.set_bind_group(0, &lists, &[(at as u64 * STAGE_STRIDE) as u32]);
        let groups = (band.size[0] * band.size[1]).div_ceil(64);
        let across = groups.min(32768);
        pass.dispatch_workgroups(across, groups.div_ceil(across), 1);
        drop(pass);
        recorder.count(1, 0);
    }

    /// How many layers there were so far, and how many found no slot. `encoder` is submitted and begun anew.
    fn count_slots(&self, encoder: &mut wgpu::CommandEncoder, own: &SlotsOnGpu) -> Result<[u64; 2], GpuError> {
        encoder.copy_buffer_to_buffer(own.lists.heads.buffer(), 0, &own.lists.counted, 0, 4 * HEADER);
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let done = std::mem::replace(encoder, self.gpu.device.create_command_encoder(&descriptor));
        self.gpu.queue.submit([done.finish()]);
        self.gpu.mapped(&own.lists.counted, |bytes| {
            let [all, _, left] = bytemuck::pod_read_unaligned::<[u32; 3]>(&bytes[..12]);
            [all, left].map(u64::from)
        })
    }

    /// What the method of the last frame took and left out.
    pub fn method_figures(&self) -> MethodFigures {
        self.method_figures
    }
}

impl SlotsOnGpu {
    fn slots(&self) -> wgpu::BindingResource<'_> {
        self.lists.notes(self.words)
    }

    fn band(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: self.bands.buffer(), offset: 0, size: Band::SIZE })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_a_region_once() {
        for (width, height, pixels) in [(10, 7, 20), (10, 7, 1), (10, 7, 70), (3, 1, 2), (1, 9, 4)] {
            let region = PictureTile { origin: [5, 6], size: [width, height] };
            let bands = bands_of(region, pixels);
            let mut next = 6;
            for band in &bands {
                assert_eq!((band.origin, band.size[0]), ([5, next], width));
                assert!(u64::from(band.size[1] * width) <= pixels.max(u64::from(width)) && band.size[1] > 0);
                next += band.size[1];
            }
            assert_eq!(next, 6 + height);
        }
    }
}
