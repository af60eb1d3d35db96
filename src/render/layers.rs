//! Translucent layers (O1, O7): noted in a list per pixel, sorted, shaded and laid one over the other, exactly.
//!
//! ```text
//! layers            every fragment that is seen through and not behind what is opaque, into the list of its pixel
//! sort layers       where a list is very long
//! count layers      where opacity rules ask how many layers the picture has
//! composite         the lists, sorted and laid one over the other
//! shown layers      where AOVs are asked for: layers that are the shown surface take the place of what is opaque
//! ```
//!
//! How much memory the lists take is bounded: what does not fit is drawn in bands, halved until each fits. How many notes there
//! are is read back before they are sorted, so nothing is ever left out in silence: what a single pixel has too much is counted.

use std::ops::Range;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cut::Cut,
        eye::PictureTile,
        frame::{FrameInput, Recorder, color_attachment, read_depth, scissor},
        key::{GeometryKind, Key},
        renderer::{Renderer, all_of, group, whole},
        synced::Room,
        transparency::{ForwardKeys, SlotKeys},
    },
    shader::{EffectKind, Plan, Program, handlers},
};

/// What notes take at most, bytes: what exceeds it is drawn in bands.
pub const LAYER_BYTES: u64 = 96 << 20;
/// Notes that there is room for before anything is known: per pixel, and at least.
const FIRST_GUESS: [u64; 2] = [2, 1 << 16];
/// Bands of a picture at most; of what is left over, the excess is counted.
const MOST_BANDS: usize = 4096;
/// Pools that much room is shared out between, and notes that there is room for from which on it is (`pass/layers.wgsl`).
const POOLS: u64 = 16;
const MANY: u64 = 1 << 16;
/// Words of the lists before those of the pixels: how many notes spilled, how many layers at most, the longest list that was not
/// done; and, in lines of their own, how many notes each pool was to take.
pub(super) const HEADER: u64 = 16 * (1 + POOLS);
/// The word of the lists that has the number of a picked layer, as `pass/composite.wgsl` reads it.
const PICKED: u64 = 3;
/// Storage buffers that a shader of layers binds: two of lists, and what lens tests read.
const BUFFERS: u32 = 8;
/// What to do where the card has no such buffer.
const SMALLER: &str = "a smaller picture would be right";

/// What a frame had of translucent layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerFigures {
    /// Fragments that are seen through and not behind what is opaque.
    pub notes: u64,
    /// Bands that the picture was drawn in.
    pub bands: u32,
    /// Fragments that found no room and are missing in the picture.
    pub excess: u64,
}

/// What the card has of layers between frames.
#[derive(Debug)]
pub(super) struct LayersOnGpu {
    pub heads: Room,
    pub notes: Room,
    /// The header, to be read.
    pub counted: wgpu::Buffer,
}

impl LayersOnGpu {
    /// Without room for anything.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let read = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        Ok(Self {
            heads: Room::new(gpu, "lists of layers", usage | wgpu::BufferUsages::COPY_SRC, SMALLER)?,
            notes: Room::new(gpu, "layers", usage, SMALLER)?,
            counted: gpu.empty_buffer("number of layers", read, 4 * HEADER)?,
        })
    }

    /// What they take on the card.
    pub fn bytes(&self) -> u64 {
        self.heads.buffer().size() + self.notes.buffer().size()
    }
}

/// The pipelines of layers.
#[derive(Clone, Debug)]
pub(super) struct LayerKeys {
    /// What is translucent: program of the lists.
    pub noting: Program,
    pub composite: Key,
    pub count: Option<Key>,
    /// Whether opacity rules ask how many layers the picture has.
    pub asks_most: bool,
    /// Steps of sorting, where lists are long.
    pub sort: Vec<Key>,
    pub shown: Option<Key>,
    pub textured: bool,
    pub smooth: bool,
    /// Of methods that keep a fixed number of layers.
    pub slots: Option<SlotKeys>,
    /// Of those that shade fragments where they are drawn.
    pub forward: Option<ForwardKeys>,
}

impl LayerKeys {
    /// The pipeline that notes a section.
    pub fn noting_key(&self, kind: GeometryKind, [is_smooth_city, all]: [bool; 2], early: bool) -> Key {
        Key::Layers {
            section: kind,
            smooth: self.smooth,
            flat: self.smooth && !is_smooth_city,
            textured: self.textured,
            program: self.noting.clone(),
            all,
            early,
        }
    }

    /// All but those of sections.
    pub fn all(&self) -> impl Iterator<Item = &Key> {
        let composite = [&self.composite].into_iter().filter(|_| !self.is_stochastic());
        composite.chain(&self.count).chain(&self.sort).chain(&self.shown)
    }

    /// Whether layers are there by chance, and nothing is laid over.
    pub fn is_stochastic(&self) -> bool {
        self.slots.is_none() && self.forward.is_some()
    }

    /// Steps that sort lists of so many notes.
    pub fn sorting(words: u32, longest: u32) -> Vec<Key> {
        let widths = (0..32).map(|step| 1_u32 << step).take_while(|width| *width < longest);
        widths.map(|width| Key::SortLayers { words, width }).collect()
    }

    /// Words of a note.
    pub fn words(smooth: bool, textured: bool) -> u32 {
        3 + u32::from(smooth) + u32::from(textured)
    }
}

/// Whether some opacity rule of a plan asks how many layers the picture has.
pub(super) fn asks_most(plan: &Plan) -> bool {
    plan.steps_of(EffectKind::Opacity, handlers()).any(|(_, rule)| rule.asks_most_layers)
}

/// Halves of a band, the longer side halved; `None` of one pixel.
fn halves(band: PictureTile) -> Option<[PictureTile; 2]> {
    let side = usize::from(band.size[1] >= band.size[0]);
    let first = band.size[side] / 2;
    if first == 0 {
        return None;
    }
    let mut parts = [band; 2];
    parts[0].size[side] = first;
    parts[1].size[side] -= first;
    parts[1].origin[side] += first;
    Some(parts)
}

/// What two parts of a picture have in common.
pub(super) fn common(a: PictureTile, b: PictureTile) -> PictureTile {
    let low = [0, 1].map(|i| a.origin[i].max(b.origin[i]));
    let high = [0, 1].map(|i| (a.origin[i] + a.size[i]).min(b.origin[i] + b.size[i]));
    PictureTile { origin: low, size: [0, 1].map(|i| high[i].saturating_sub(low[i])) }
}

/// What the header of lists tells.
#[derive(Clone, Copy, Debug)]
struct Noted {
    /// How many notes there are, those without room included.
    notes: u64,
    /// How many their pools had no room for.
    spilled: u64,
    /// The longest list that the lists before told of.
    longest: u32,
}

impl Noted {
    /// How many found no room, where there is some for so many.
    fn excess(&self, room: u64) -> u64 {
        let pooled = if room >= MANY { POOLS * (room / 64 * 3) } else { room };
        self.spilled.saturating_sub(room - pooled)
    }

    /// Room that would do, unless pools fill unevenly; more than there was.
    fn wanted(&self, room: u64) -> u64 {
        (self.notes + self.notes / 2).max(2 * room)
    }
}

impl LayersOnGpu {
    /// How many notes there is room for, of so many words, `most` at most.
    fn room(&self, words: u64, most: u64) -> u64 {
        most.min(self.notes.buffer().size() / (4 * words))
    }

    /// As many words of the notes, for shaders to tell from how many there is room for. They are bound two by two: of one more there
    /// is no further note.
    pub fn notes(&self, words: u64) -> wgpu::BindingResource<'_> {
        let size = wgpu::BufferSize::new(4 * words.max(1).next_multiple_of(2));
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: self.notes.buffer(), offset: 0, size })
    }
}

/// What lists are drawn from.
pub(super) struct LayerDraw<'a> {
    pub cut: &'a Cut,
    pub keys: &'a LayerKeys,
    /// Parts of the picture where something may be translucent, as triangles of the mesh.
    pub pieces: &'a [(Range<u32>, PictureTile)],
    /// Of the picture: the context's, or the lenses'.
    pub part: u32,
}

impl Renderer {
    /// Makes, sorts and lays over each other the layers of a frame; what was recorded before is submitted.
    pub(super) fn layer_passes(
        &mut self,
        mut encoder: wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        draw: &LayerDraw,
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        check(&self.gpu)?;
        let size = input.tile.size;
        let region = draw.pieces.iter().map(|(_, tile)| *tile).filter(|tile| !tile.is_empty());
        let region = region.reduce(|a, b| {
            let low = [0, 1].map(|i| a.origin[i].min(b.origin[i]));
            let high = [0, 1].map(|i| (a.origin[i] + a.size[i]).max(b.origin[i] + b.size[i]));
            PictureTile { origin: low, size: [0, 1].map(|i| high[i] - low[i]) }
        });
        self.clear_layers(&mut encoder, draw.keys.shown.is_some());
        let Some(region) = region.map(|region| common(region, PictureTile::whole(size))).filter(|r| !r.is_empty())
        else {
            return Ok(encoder);
        };
        if draw.keys.is_stochastic() {
            self.chance_pass(&mut encoder, recorder, input, draw);
            self.layer_figures.bands = 1;
            return Ok(encoder);
        }
        if let Some(slots) = draw.keys.slots {
            return self.slot_passes(encoder, recorder, input, (draw, slots), region);
        }
        let words = u64::from(LayerKeys::words(draw.keys.smooth, draw.keys.textured));
        let mut own = match self.layers.take() {
            Some(own) => own,
            None => LayersOnGpu::new(&self.gpu)?,
        };
        own.heads.fit(&self.gpu, 4 * (HEADER + u64::from(size[0]) * u64::from(size[1])))?;
        if let Some(picked) = self.picked_layer {
            self.gpu.queue.write_buffer(own.heads.buffer(), 4 * PICKED, &picked.to_le_bytes());
        }
        let most = self.most_layers.unwrap_or(LAYER_BYTES / (4 * words));
        let pixels = u64::from(region.size[0]) * u64::from(region.size[1]);
        own.notes.fit(&self.gpu, 4 * words * most.min((FIRST_GUESS[0] * pixels).max(FIRST_GUESS[1])))?;
        let mut bands = vec![region];
        let mut fitting: Vec<(PictureTile, u64)> = Vec::new();
        let mut figures = LayerFigures::default();
        // How many layers there are at most is known after the last band.
        let counts_first = draw.keys.count.is_some();
        while let Some(band) = bands.pop() {
            let mut room = own.room(words, most);
            let mut found = self.note_layers(&mut encoder, recorder, input, draw, &own, (band, room * words))?;
            // The last frame says how long its lists were: nobody may have asked since.
            self.longest_list = self.longest_list.max(if fitting.is_empty() { found.longest } else { 0 });
            while found.excess(room) > 0 && room < most {
                own.notes.fit(&self.gpu, 4 * words * found.wanted(room).min(most))?;
                room = own.room(words, most);
                found = self.note_layers(&mut encoder, recorder, input, draw, &own, (band, room * words))?;
            }
            let excess = found.excess(room);
            let is_last = fitting.len() + bands.len() + 1 >= MOST_BANDS || most == 0;
            if let Some(parts) = halves(band).filter(|_| excess > 0 && !is_last) {
                bands.extend(parts);
                continue;
            }
            if fitting.is_empty() {
                encoder.clear_buffer(own.heads.buffer(), 4, Some(8));
            }
            figures.notes += found.notes;
            figures.bands += 1;
            figures.excess += excess;
            fitting.push((band, room * words));
            if let Some(count) = &draw.keys.count {
                self.order_layers(&mut encoder, recorder, ("count layers", count), (&own, room * words), size);
            } else {
                self.composite_layers(&mut encoder, recorder, draw, &own, (band, room * words), size);
            }
        }
        if counts_first {
            for band in &fitting {
                // Those of the only one are still there.
                if fitting.len() > 1 {
                    self.note_layers(&mut encoder, recorder, input, draw, &own, *band)?;
                }
                self.composite_layers(&mut encoder, recorder, draw, &own, *band, size);
            }
        }
        self.method_figures.bytes = own.bytes();
        self.layer_figures = figures;
        self.layers = Some(own);
        Ok(encoder)
    }

    /// Nothing is translucent, until something is.
    fn clear_layers(&self, encoder: &mut wgpu::CommandEncoder, shown: bool) {
        let Some(targets) = &self.targets else { return };
        let clear = wgpu::Color { r: 0.0, g: 0.0, b: 0.0, a: 1.0 };
        let cleared = [(&targets.veil, clear), (&targets.shown_code, wgpu::Color::TRANSPARENT)];
        let attachments = cleared.map(|(target, clear)| Some(color_attachment(&target.view, clear)));
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear layers"),
            color_attachments: &attachments[..if shown { 2 } else { 1 }],
            ..Default::default()
        });
    }

    /// Notes the layers of a band, and reads how many there are. `encoder` is submitted and begun anew.
    fn note_layers(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        draw: &LayerDraw,
        own: &LayersOnGpu,
        (band, words): (PictureTile, u64),
    ) -> Result<Noted, GpuError> {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else {
            return Ok(Noted { notes: 0, spilled: 0, longest: 0 });
        };
        let layouts = &self.pipelines.layouts;
        // What the header tells of lists before stays.
        encoder.clear_buffer(own.heads.buffer(), 0, Some(4));
        encoder.clear_buffer(own.heads.buffer(), 4 * 16, None);
        let entries = [
            (0, whole(self.buffers.view.buffer())),
            (1, whole(own.heads.buffer())),
            (2, own.notes(words)),
            (3, all_of(&targets.depth)),
        ];
        let view = group(&self.gpu, "layers", &layouts.layers, &entries);
        let slot = recorder.begin("layers", "main", &draw.cut.hiding.lenses, true);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("layers"),
            depth_stencil_attachment: Some(read_depth(&targets.depth.view)),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        scissor(&mut pass, band);
        pass.set_bind_group(0, &view, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        let early = self.gpu.tests_depth_early();
        let (draws, triangles) = self.draw_reached(
            &mut pass,
            input,
            draw.cut,
            |kind, of| draw.keys.noting_key(kind.into(), of, early),
            |pass, offset| pass.set_bind_group(1, &groups.cut_city, &[offset; 2]),
        );
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(draws, triangles);
        encoder.copy_buffer_to_buffer(own.heads.buffer(), 0, &own.counted, 0, 4 * HEADER);
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let done = std::mem::replace(encoder, self.gpu.device.create_command_encoder(&descriptor));
        self.gpu.queue.submit([done.finish()]);
        self.gpu.mapped(&own.counted, |bytes| {
            let header: [u32; HEADER as usize] = bytemuck::pod_read_unaligned(&bytes[..4 * HEADER as usize]);
            let notes = header[16..].iter().step_by(16).map(|pool| u64::from(*pool)).sum();
            Noted { notes, spilled: header[0].into(), longest: header[2] }
        })
    }

    /// Goes through all lists of a picture of this size.
    fn order_layers(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        (name, key): (&'static str, &Key),
        (own, words): (&LayersOnGpu, u64),
        size: [u32; 2],
    ) {
        let layouts = &self.pipelines.layouts;
        let entries = [(0, whole(own.heads.buffer())), (1, own.notes(words))];
        let lists = group(&self.gpu, "order of layers", &layouts.layer_order, &entries);
        let slot = recorder.begin(name, "main", &[], false);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.compute_writes(slot)),
        });
        pass.set_pipeline(self.pipelines.get_compute(key));
        pass.set_bind_group(0, &lists, &[]);
        let groups = (size[0] * size[1]).div_ceil(64);
        let across = groups.min(32768);
        pass.dispatch_workgroups(across, groups.div_ceil(across), 1);
        drop(pass);
        recorder.count(1, 0);
    }

    /// Sorts what was noted in a band, and lays it one over the other.
    pub(super) fn composite_layers(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        draw: &LayerDraw,
        own: &LayersOnGpu,
        (band, words): (PictureTile, u64),
        size: [u32; 2],
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        for key in &draw.keys.sort {
            self.order_layers(encoder, recorder, ("sort layers", key), (own, words), size);
        }
        let layouts = &self.pipelines.layouts;
        let [sums, through] = [&targets.tail_sums, &targets.tail_through].map(all_of);
        let entries = [(0, whole(own.heads.buffer())), (1, own.notes(words)), (2, sums), (3, through)];
        let lists = group(&self.gpu, "lists of layers", &layouts.layer_lists, &entries);
        let slot = recorder.begin("composite", "main", &draw.cut.hiding.lenses, true);
        let attachments = [&targets.veil, &targets.shown_code, &targets.shown_depth].map(|target| {
            let mut attachment = color_attachment(&target.view, wgpu::Color::TRANSPARENT);
            attachment.ops.load = wgpu::LoadOp::Load;
            Some(attachment)
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("composite"),
            color_attachments: &attachments[..if draw.keys.shown.is_some() { 3 } else { 1 }],
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        pass.set_pipeline(self.pipelines.get(&draw.keys.composite));
        pass.set_bind_group(0, &groups.view, &[]);
        pass.set_bind_group(1, &groups.shade, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        pass.set_bind_group(3, &lists, &[]);
        pass.set_vertex_buffer(0, self.buffers.mesh.buffer().slice(..));
        let mut counted = (0, 0);
        for (corners, tile) in draw.pieces {
            let tile = common(*tile, band);
            if corners.is_empty() || tile.is_empty() {
                continue;
            }
            scissor(&mut pass, tile);
            pass.draw(corners.clone(), draw.part..draw.part + 1);
            counted = (counted.0 + 1, counted.1 + corners.len() as u64 / 3);
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(counted.0, counted.1);
    }

    /// Puts layers that are the shown surface in the place of what is opaque.
    pub(super) fn show_layers(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        key: &Key,
    ) {
        let Some(targets) = &self.targets else { return };
        let entries = [(0, all_of(&targets.shown_code)), (1, all_of(&targets.shown_depth))];
        let shown = group(&self.gpu, "shown layers", &self.pipelines.layouts.shown_layers, &entries);
        let slot = recorder.begin("shown layers", "main", &[], false);
        let attachments = [&targets.codes, &targets.own_depth].map(|target| {
            let mut attachment = color_attachment(&target.view, wgpu::Color::TRANSPARENT);
            attachment.ops.load = wgpu::LoadOp::Load;
            Some(attachment)
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shown layers"),
            color_attachments: &attachments[..if input.measured { 2 } else { 1 }],
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        pass.set_pipeline(self.pipelines.get(key));
        pass.set_bind_group(0, &shown, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        recorder.count(1, 1);
    }

    /// Whether lists of the last frame are longer than it was made for, and the next one has to sort them; that it then does.
    pub(super) fn sorts_longer(&mut self) -> Result<bool, GpuError> {
        let Some(own) = self.layers.as_ref().filter(|_| self.layer_figures.notes > 0) else { return Ok(false) };
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("longest list") };
        let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
        encoder.copy_buffer_to_buffer(own.heads.buffer(), 0, &own.counted, 0, 4 * HEADER);
        self.gpu.queue.submit([encoder.finish()]);
        let longest = self.gpu.mapped(&own.counted, |bytes| bytemuck::pod_read_unaligned::<u32>(&bytes[8..12]))?;
        let is_longer = longest > self.longest_list;
        if is_longer {
            self.longest_list = longest;
        }
        Ok(is_longer)
    }

    /// What the last frame had of translucent layers.
    pub fn layer_figures(&self) -> LayerFigures {
        self.layer_figures
    }
}

/// Refuses a device that binds fewer buffers than lists of layers take.
fn check(gpu: &Gpu) -> Result<(), GpuError> {
    let most = gpu.device.limits().max_storage_buffers_per_shader_stage;
    if most >= BUFFERS {
        return Ok(());
    }
    let message = format!("it binds {most} storage buffers at a time; what is translucent takes {BUFFERS}");
    Err(GpuError::Failed { adapter: gpu.name(), message })
}
