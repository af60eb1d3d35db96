//! Recording passes: commands, and what statistics say of each pass.

use std::ops::AddAssign;

use crate::{
    gpu::{Gpu, Timer},
    render::eye::PictureTile,
};

/// One pass that ran.
#[derive(Clone, Debug, PartialEq)]
pub struct PassRecord {
    /// What it does.
    pub name: &'static str,
    /// Which view it drew.
    pub view: &'static str,
    /// The lenses it served; none: the scene.
    pub lenses: Vec<u32>,
    /// Draw calls.
    pub draws: u32,
    /// Triangles handed to the rasteriser.
    pub triangles: u64,
    /// Where its measures stand.
    pub slot: Option<usize>,
}

/// Draw calls, and triangles handed to the rasteriser.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Draw calls.
    pub draws: u32,
    /// Triangles.
    pub triangles: u64,
}

impl Counted {
    /// Nothing.
    pub const NONE: Self = Self { draws: 0, triangles: 0 };
    /// One triangle over everything.
    pub const ONE: Self = Self { draws: 1, triangles: 1 };

    /// One draw of so many vertices.
    pub fn corners(corners: u32) -> Self {
        Self { draws: 1, triangles: u64::from(corners) / 3 }
    }
}

impl AddAssign for Counted {
    fn add_assign(&mut self, other: Self) {
        self.draws += other.draws;
        self.triangles += other.triangles;
    }
}

/// What is measured of a pass beside its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaded {
    /// Nothing: it shades nothing that is counted.
    Unmeasured,
    /// Its shaded pixels.
    Counted,
    /// It has a place for shaded pixels, and none are counted.
    Uncounted,
}

/// A pass that draws.
#[derive(Debug)]
pub struct DrawnPass<'a> {
    /// What it does.
    pub name: &'static str,
    /// Which view it draws.
    pub view: &'static str,
    /// The lenses it serves; none: the scene.
    pub lenses: &'a [u32],
    /// What is measured.
    pub shaded: Shaded,
    /// What it draws into.
    pub colors: &'a [Option<wgpu::RenderPassColorAttachment<'a>>],
    /// The depth that it tests.
    pub depth: Option<wgpu::RenderPassDepthStencilAttachment<'a>>,
}

/// The commands of a frame so far, and what was noted of its passes.
pub struct Recording<'t> {
    /// The commands since the last [`Self::submit`].
    pub encoder: wgpu::CommandEncoder,
    timer: Option<&'t mut Timer>,
    passes: Vec<PassRecord>,
}

/// An encoder of commands of frames.
fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
}

impl<'t> Recording<'t> {
    /// Nothing yet; `timer` where passes are measured.
    pub fn new(gpu: &Gpu, timer: Option<&'t mut Timer>) -> Self {
        Self { encoder: encoder(gpu), timer, passes: Vec::new() }
    }

    fn note(&mut self, pass: PassRecord, is_shading: bool) -> Option<crate::gpu::Slot> {
        let slot = self.timer.as_mut().and_then(|timer| timer.slot(is_shading));
        self.passes.push(PassRecord { slot: slot.map(|s| s.index()), ..pass });
        slot
    }

    fn count(&mut self, counted: Counted) {
        if let Some(pass) = self.passes.last_mut() {
            pass.draws += counted.draws;
            pass.triangles += counted.triangles;
        }
    }

    /// Records a pass; `draw` says what it drew.
    pub fn draw(&mut self, pass: DrawnPass, draw: impl FnOnce(&mut wgpu::RenderPass) -> Counted) {
        let DrawnPass { name, view, lenses, shaded, colors, depth } = pass;
        let record = PassRecord { name, view, lenses: lenses.to_vec(), draws: 0, triangles: 0, slot: None };
        let slot = self.note(record, shaded != Shaded::Unmeasured);
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: colors,
            depth_stencil_attachment: depth,
            timestamp_writes: self.timer.as_ref().and_then(|timer| timer.render_writes(slot)),
            ..Default::default()
        });
        let timer = self.timer.as_ref().filter(|_| shaded == Shaded::Counted);
        if let Some(timer) = timer {
            timer.begin_count(&mut pass, slot);
        }
        let counted = draw(&mut pass);
        if let Some(timer) = timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        self.count(counted);
    }

    /// Records a pass of the main view that computes.
    pub fn compute(
        &mut self,
        name: &'static str,
        lenses: &[u32],
        compute: impl FnOnce(&mut wgpu::ComputePass) -> Counted,
    ) {
        let record = PassRecord { name, view: "main", lenses: lenses.to_vec(), draws: 0, triangles: 0, slot: None };
        let slot = self.note(record, false);
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: self.timer.as_ref().and_then(|timer| timer.compute_writes(slot)),
        });
        let counted = compute(&mut pass);
        drop(pass);
        self.count(counted);
    }

    /// Has the GPU do what was recorded, and goes on.
    pub fn submit(&mut self, gpu: &Gpu) {
        let done = std::mem::replace(&mut self.encoder, encoder(gpu));
        gpu.queue.submit([done.finish()]);
    }

    /// Has the GPU do the rest; what was noted of the passes.
    pub fn finish(mut self, gpu: &Gpu) -> Vec<PassRecord> {
        if let Some(timer) = &self.timer {
            timer.resolve(&mut self.encoder);
        }
        gpu.queue.submit([self.encoder.finish()]);
        self.passes
    }
}

/// Draws only within a part of the target.
pub fn scissor(pass: &mut wgpu::RenderPass, part: PictureTile) {
    pass.set_scissor_rect(part.origin[0], part.origin[1], part.size[0], part.size[1]);
}

/// A target that is cleared first.
pub fn cleared(view: &wgpu::TextureView, clear: wgpu::Color) -> wgpu::RenderPassColorAttachment<'_> {
    attachment(view, wgpu::LoadOp::Clear(clear))
}

/// A target that is drawn over.
pub fn kept(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    attachment(view, wgpu::LoadOp::Load)
}

fn attachment(view: &wgpu::TextureView, load: wgpu::LoadOp<wgpu::Color>) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// A depth that chooses and is not written.
pub fn read_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops: None }
}

/// A depth that is cleared first.
pub fn cleared_depth(view: &wgpu::TextureView, clear: f32) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    depth_attachment(view, wgpu::LoadOp::Clear(clear))
}

/// A depth that is written over.
pub fn kept_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    depth_attachment(view, wgpu::LoadOp::Load)
}

fn depth_attachment(view: &wgpu::TextureView, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}
