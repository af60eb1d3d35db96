//! The passes that draw the city's triangles: from the sun, and from the main view.

use glam::DVec2;

use crate::{
    gpu::GpuError,
    render::{
        city::{Chunk, CityBuffers, Draw, SectionKind, SeenChunk, draws_of},
        contents::DrawnSection,
        curtain::{self, Curtain},
        cut::{Cut, CutPrograms, Cuts},
        eye::{PictureTile, view_uniform},
        frame::{FrameInput, Recorder, color_attachment, depth_attachment},
        key::Key,
        renderer::{Renderer, Shadow},
    },
    shader::Program,
    view::View,
};

/// What a pass draws of a section.
pub(super) type Part<'a> = (DrawnSection<'a>, Vec<&'a Chunk>);

impl Renderer {
    /// Depth from the sun, where the map does not hold this view yet.
    pub(super) fn shadow_pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        sun: &View,
        (cuts, programs): (&Cuts, &CutPrograms),
    ) {
        let cut = cuts.sun.as_ref().zip(programs.sun.as_ref());
        let wanted = Shadow {
            view: view_uniform(sun, PictureTile::whole(sun.size), DVec2::ZERO, 0, 0.0),
            cut: cut.map(|(cut, program)| (program.clone(), cut.all_numbers(input, &self.own_sprites))),
            cities: self.city_uniforms(sun.camera.eye),
            details: self.details.clone(),
        };
        if self.shadow_of.as_ref() == Some(&wanted) {
            return;
        }
        self.shadow_of = Some(wanted);
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let lenses = cut.map_or(&[][..], |(cut, _)| &cut.hiding.lenses);
        let slot = recorder.begin("shadow map", "sun", lenses, false);
        let writes = recorder.timer.as_ref().and_then(|t| t.render_writes(slot));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            depth_stencil_attachment: Some(depth_attachment(&targets.shadow.view, 0.0)),
            timestamp_writes: writes,
            ..Default::default()
        });
        pass.set_bind_group(0, &groups.sun_view, &[]);
        // Casters may stand before the picture's edge, never behind the sun.
        let frustum = sun.frustum(1.0);
        let own_cut = cut.map(|(cut, _)| cut);
        for drawn in self.drawn_sections(own_cut).into_iter().filter(|drawn| drawn.has_shadow) {
            let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, own_cut, &input.view));
            let seen = CityBuffers::visible(shown, &frustum, sun.camera.eye);
            let chunks: Vec<&Chunk> = seen.iter().map(|s| s.chunk).collect();
            pass.set_vertex_buffer(0, drawn.section.vertices.slice(..));
            for (part, is_cut) in Cut::parts(own_cut, &input.view, &chunks, drawn.content.is_some()) {
                let (draws, triangles) = draws_of(part.into_iter());
                match cut.filter(|_| is_cut) {
                    Some((_, program)) => {
                        pass.set_pipeline(self.pipelines.get(&Key::Shadow(Some(program.clone()))));
                        pass.set_bind_group(1, &groups.shapes_city, &[drawn.offset; 2]);
                        pass.set_bind_group(2, &groups.shapes, &[]);
                    }
                    None => {
                        pass.set_pipeline(self.pipelines.get(&Key::Shadow(None)));
                        pass.set_bind_group(1, &drawn.city.group, &[]);
                    }
                }
                draw_ranges(&mut pass, &drawn.section.indices, &draws);
                recorder.count(draws.len() as u32, triangles);
            }
        }
    }

    /// The city, every triangle at most once: in one pass, or what is near first and then what it does not hide.
    pub(super) fn geometry_passes(
        &mut self,
        mut encoder: wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        cuts: (&Cuts, &CutPrograms),
    ) -> Result<wgpu::CommandEncoder, GpuError> {
        let cut = cuts.0.picture.as_ref().zip(cuts.1.picture.as_ref());
        let Some(targets) = &self.targets else { return Ok(encoder) };
        let frustum = input.view.frustum(1.0);
        let own_cut = cut.map(|(cut, _)| cut);
        let kept = self.curtain.take();
        let sections = self.drawn_sections(own_cut);
        let mut seen: Vec<Vec<SeenChunk>> = Vec::new();
        for drawn in &sections {
            let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, own_cut, &input.view));
            seen.push(CityBuffers::visible(shown, &frustum, input.view.camera.eye));
        }
        let part = |keep: &dyn Fn(&DrawnSection, &SeenChunk) -> bool| -> Vec<Part> {
            let mut kept: Vec<Part> = Vec::new();
            for (drawn, seen) in sections.iter().zip(&seen) {
                kept.push((*drawn, seen.iter().filter(|s| keep(drawn, s)).map(|s| s.chunk).collect()));
            }
            kept
        };
        // Layers of coplanar faces stay together and last: the later one wins where depths are equal.
        let hangs = |drawn: &DrawnSection| drawn.section.kind != SectionKind::Coplanar;
        let hanging = || sections.iter().zip(&seen).filter(|(drawn, _)| hangs(drawn)).flat_map(|(_, seen)| seen);
        let reach = if self.culls_hidden { curtain::reach(&input.view, hanging()) } else { None };
        let Some(reach) = reach else {
            self.geometry_pass(&mut encoder, recorder, input, (&part(&|_, _| true), cut), ("geometry", true));
            self.curtain = kept;
            return Ok(encoder);
        };
        let is_near = |drawn: &DrawnSection, s: &SeenChunk| hangs(drawn) && s.distance <= reach;
        self.geometry_pass(&mut encoder, recorder, input, (&part(&is_near), cut), ("geometry", true));
        let mut curtain = match kept {
            Some(curtain) if curtain.fits(&targets.depth.texture) => curtain,
            _ => Curtain::new(&self.gpu, input.tile.size)?,
        };
        curtain.copy(&mut encoder, &targets.depth.texture);
        self.gpu.queue.submit([encoder.finish()]);
        curtain.read(&self.gpu)?;
        let rest = part(&|drawn, s| !is_near(drawn, s) && !curtain.hides(&input.view, input.tile, &s.chunk.bounds));
        encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        self.geometry_pass(&mut encoder, recorder, input, (&rest, cut), ("geometry beyond", false));
        self.curtain = Some(curtain);
        Ok(encoder)
    }

    pub(super) fn geometry_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (parts, cut): (&[Part], Option<(&Cut, &Program)>),
        (name, is_first): (&'static str, bool),
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let colored = self.colored();
        let lenses = cut.map_or(&[][..], |(cut, _)| &cut.hiding.lenses);
        let slot = recorder.begin(name, "main", lenses, true);
        let writes = recorder.timer.as_ref().and_then(|t| t.render_writes(slot));
        let targets_of =
            [Some(&targets.codes), colored.then_some(&targets.colors), input.measured.then_some(&targets.own_depth)];
        let colors = targets_of.map(|target| {
            let mut attachment = color_attachment(&target?.view, wgpu::Color::TRANSPARENT);
            if !is_first {
                attachment.ops.load = wgpu::LoadOp::Load;
            }
            Some(attachment)
        });
        let count = if input.measured { 3 } else { 1 + usize::from(colored) };
        let mut depth = depth_attachment(&targets.depth.view, 0.0);
        if !is_first {
            depth.depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store });
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &colors[..count],
            depth_stencil_attachment: Some(depth),
            timestamp_writes: writes,
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        pass.set_bind_group(0, &groups.view, &[]);
        let mut counted = (0, 0);
        for (DrawnSection { city, section, image, content, offset, .. }, chunks) in parts {
            if chunks.is_empty() {
                continue;
            }
            pass.set_vertex_buffer(0, section.vertices.slice(..));
            if let Some(extra) = &section.extra {
                pass.set_vertex_buffer(1, extra.slice(..));
            }
            if let Some(image) = *image {
                pass.set_bind_group(3, image, &[]);
            }
            for (part, is_cut) in Cut::parts(cut.map(|(cut, _)| cut), &input.view, chunks, content.is_some()) {
                let (draws, triangles) = draws_of(part.into_iter());
                let program = cut.filter(|_| is_cut).map(|(_, program)| program.clone());
                if program.is_some() {
                    pass.set_bind_group(2, &groups.lenses, &[]);
                }
                match program.is_some() {
                    true => pass.set_bind_group(1, &groups.cut_city, &[*offset; 2]),
                    false => pass.set_bind_group(1, &city.group, &[]),
                }
                let normals = [self.smooth(), city.buffers.smooth];
                let key = geometry_key(section.kind, colored, normals, input.measured, program);
                pass.set_pipeline(self.pipelines.get(&key));
                draw_ranges(&mut pass, &section.indices, &draws);
                counted = (counted.0 + draws.len() as u32, counted.1 + triangles);
            }
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        recorder.count(counted.0, counted.1);
    }
}

/// The pipeline that draws a section; `cut`: where something may be hidden. `smooth`: whether the picture has smooth faces, and
/// whether the section's city has.
pub(super) fn geometry_key(
    kind: SectionKind,
    colored: bool,
    [smooth, own]: [bool; 2],
    measured: bool,
    cut: Option<Program>,
) -> Key {
    Key::Geometry { section: kind.into(), colored, smooth, flat: smooth && !own, measured, cut }
}

pub(super) fn draw_ranges(pass: &mut wgpu::RenderPass, indices: &wgpu::Buffer, draws: &[Draw]) {
    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
    for draw in draws {
        pass.draw_indexed(draw.clone(), 0, 0..1);
    }
}
