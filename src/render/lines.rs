//! Edges as lines, where effects draw them (K2): into a layer of their own, which shading lays over its picture.

use crate::{
    geom::Aabb,
    gpu::{Gpu, GpuError},
    lens::Class,
    render::{
        city::Shown,
        contents::Placement,
        cut::Cut,
        edges::{EdgeBuffers, VERTICES},
        frame::{FrameInput, Recorder, color_attachment, strided},
        hiding::{Reach, reaches_of},
        key::Key,
        layout::LineStage,
        renderer::{CityOnGpu, Renderer, STAGE_STRIDE},
    },
    shader::{EffectDefinition, Plan, Scope, Step, handlers},
};

/// One effect that draws lines in a frame.
#[derive(Clone, Debug)]
pub(super) struct LineDraw {
    /// For the shader.
    pub stage: LineStage,
    /// Where it draws.
    reaches: Vec<Reach>,
    /// Whose it is; `None`: the context's.
    pub lens: Option<u32>,
}

/// The draws of a frame: `plan` is what lines go through, `lenses` the numbers of its lenses.
pub(super) fn draws(input: &FrameInput, plan: Option<&Plan>, lenses: &[u32]) -> Vec<LineDraw> {
    let Some(plan) = plan else { return Vec::new() };
    let draw = |(number, step): (usize, &Step)| {
        let handler = &handlers()[step.effect as usize];
        let (lens, class) = match step.scope {
            Scope::Everywhere => (None, Class::Rest),
            Scope::Lens(lens, class) => (lenses.get(lens as usize).copied(), Class::from(class)),
        };
        let value = |name: &str| parameter(handler, name, step.parameters, &input.operations.parameters);
        handler.lines.then(|| LineDraw {
            stage: LineStage {
                width: value("line_width").unwrap_or(1.0),
                step: number as u32,
                flat_edges: u32::from(value("flat_edges").unwrap_or(0.0) != 0.0),
                reserved: 0,
            },
            reaches: reaches_of(lens, class, input.volumes, &input.view),
            lens,
        })
    };
    plan.steps.iter().enumerate().filter_map(draw).collect()
}

/// A parameter of a handler that takes one float.
fn parameter(handler: &EffectDefinition, name: &str, first: u32, all: &[[f32; 4]]) -> Option<f32> {
    let mut before = 0;
    for (parameter, _, floats) in handler.shader_parameters() {
        if parameter.name == name {
            return all.get(first as usize + before / 4).map(|slot| slot[before % 4]);
        }
        before += floats;
    }
    None
}

/// The stages of all draws, each at its offset.
pub(super) fn stages(draws: &[LineDraw]) -> Vec<u8> {
    draws.iter().flat_map(|draw| strided(&draw.stage)).collect()
}

impl CityOnGpu {
    /// Puts the edges of what it shows on the card, if they are not there.
    pub fn find_edges(&mut self, gpu: &Gpu, shown: &Shown) -> Result<(), GpuError> {
        if self.edges.is_none() {
            self.edges = Some(EdgeBuffers::new(gpu, shown, &self.buffers, &Default::default())?);
        }
        Ok(())
    }
}

impl Renderer {
    /// Whether the city's edges are on the card.
    pub fn has_edges(&self) -> bool {
        self.city.as_ref().is_some_and(|city| city.edges.is_some())
    }

    /// Puts the edges of the city that [`Renderer::set_city`] was given on the card; once per city.
    pub fn set_edges(&mut self, shown: &Shown) -> Result<(), GpuError> {
        match &mut self.city {
            Some(city) => city.find_edges(&self.gpu, shown),
            None => Ok(()),
        }
    }

    pub(super) fn lines_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (draws, cut): (&[LineDraw], Option<&Cut>),
        key: &Key,
    ) {
        let (Some(targets), Some(groups), Some(city)) = (&self.targets, &self.groups, &self.city) else { return };
        let (Some(edges), Some(stage)) = (&city.edges, &groups.line_stage) else { return };
        let mut lenses: Vec<u32> = draws.iter().filter_map(|d| d.lens).collect();
        lenses.dedup();
        let slot = recorder.begin("lines", "main", &lenses, true);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lines"),
            color_attachments: &[Some(color_attachment(&targets.lines.view, wgpu::Color::TRANSPARENT))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
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
        pass.set_pipeline(self.pipelines.get(key));
        pass.set_bind_group(0, &groups.view, &[]);
        pass.set_bind_group(1, &groups.shade, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        let own: Vec<&EdgeBuffers> = match self.deformed.as_ref().and_then(|deformed| deformed.edges.as_ref()) {
            Some(parts) => parts.iter().collect(),
            None => vec![edges],
        };
        let own = own.into_iter().map(|edges| (edges, &Placement::NONE, None, 0));
        let contents = self.content_edges().filter_map(|(city, number, placement, offset)| {
            let is_asked = cut.is_some_and(|cut| cut.plan.contents.iter().any(|c| c.city == number));
            Some((city.edges.as_ref().filter(|_| is_asked)?, placement, Some(number), offset))
        });
        let drawn: Vec<_> = own.chain(contents).collect();
        let frustum = input.view.frustum(1.0);
        let (mut count, mut triangles) = (0, 0);
        for (i, draw) in draws.iter().enumerate() {
            let is_wanted = |bounds: &Aabb| draw.reaches.iter().any(|reach| reach.touches(bounds, &input.view));
            for (edges, placement, content, offset) in &drawn {
                pass.set_bind_group(3, stage, &[(i as u64 * STAGE_STRIDE) as u32, *offset]);
                pass.set_vertex_buffer(0, edges.instances.slice(..));
                let is_shown = |bounds: &Aabb| {
                    content.is_none_or(|number| cut.is_some_and(|c| c.hiding.shows(number, bounds, &input.view)))
                };
                for range in edges.draws(|bounds| {
                    let placed = placement.boxed(bounds);
                    frustum.meets(&placed) && is_wanted(&placed) && is_shown(&placed)
                }) {
                    triangles += 2 * u64::from(range.end - range.start);
                    pass.draw(0..VERTICES, range);
                    count += 1;
                }
            }
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(count, triangles);
    }
}
