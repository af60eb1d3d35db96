//! What all methods of laying translucent layers one over the other share in a frame.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cut::Cut,
        eye::PictureTile,
        pass::context::FrameContext,
        picture_parts::Piece,
        plan::FramePlan,
        programs::Programs,
        resource::recording::{Recording, cleared},
        resource::targets::Needs,
    },
    scene::Transparency,
    shader::{EffectKind, Program, handlers},
};

/// Storage buffers that a shader of layers binds: two of lists, and what lens tests read.
const BUFFERS: u32 = 8;
/// And where rays are followed to them: triangles.
const BUFFERS_OF_RAYS: u32 = 9;

/// What is translucent in a frame, and where.
#[derive(Clone, Debug)]
pub struct Layering<'a> {
    /// `None`: of the city nothing is, there are fields alone.
    pub cut: Option<&'a Cut>,
    /// Parts of the picture where something may be translucent, as triangles of the mesh.
    pub pieces: Vec<Piece>,
    /// Of the picture: the context's (0), or the lenses' (1).
    pub part: u32,
    /// The rectangle around all pieces; `None`: there is no pixel.
    pub region: Option<PictureTile>,
    /// Whether it is written down which layer is the shown surface.
    pub shown: bool,
}

/// The programs of translucent layers.
#[derive(Clone, Copy, Debug)]
pub struct LayerPrograms<'a> {
    /// What is translucent.
    pub noting: &'a Program,
    /// How it looks.
    pub composite: &'a Program,
}

impl<'a> LayerPrograms<'a> {
    /// Those of a frame; `None`: nothing is translucent.
    pub fn of(programs: &'a Programs) -> Option<Self> {
        let (noting, composite) = programs.picture.as_ref().zip(programs.layering.as_ref())?;
        Some(Self { noting, composite })
    }
}

impl<'a> Layering<'a> {
    /// What a frame's plan has of them.
    pub fn of(plan: &'a FramePlan<'a>) -> Option<Self> {
        plan.plans.layering.as_ref()?;
        let cut = plan.cuts.picture.as_ref();
        let input = plan.input;
        let (parts, size) = (&plan.parts, input.tile.size);
        let is_everywhere = plan.plans.context.transparency;
        let pieces = if is_everywhere || parts.inside.is_empty() { parts.all() } else { parts.inside.clone() };
        let region = pieces.iter().map(|(_, tile)| *tile).filter(|tile| !tile.is_empty()).reduce(PictureTile::around);
        let region = region.map(|region| region.common(PictureTile::whole(size))).filter(|r| !r.is_empty());
        // Where nothing of the city is seen through, that is where fields are.
        let region = match cut {
            Some(_) => region,
            None => {
                region.zip(input.fields.part(&input.view, input.tile, !input.rays.is_empty())).map(|(a, b)| a.common(b))
            }
        };
        let region = region.filter(|region| !region.is_empty());
        Some(Self { cut, pieces, part: u32::from(plan.has_lenses()), region, shown: shows_layers(plan) })
    }

    /// The lenses that decide what is seen through.
    pub fn lenses(&self) -> &[u32] {
        self.cut.map_or(&[], |cut| &cut.hiding.lenses)
    }

    /// Adds the targets of layers.
    pub fn add_needs(plan: &FramePlan, needs: &mut Needs) {
        needs.transparency = true;
        needs.shown_layers = plan.input.wants_shown_layers();
    }

    /// Nothing is translucent, until something is.
    ///
    /// # Errors
    /// That the device binds fewer buffers than lists of layers take.
    pub fn clear(&self, frame: &FrameContext, recording: &mut Recording) -> Result<(), GpuError> {
        let bends = frame.plan.input.operations.bends.is_any();
        check(frame.gpu, if bends { BUFFERS_OF_RAYS } else { BUFFERS })?;
        let clear = wgpu::Color { r: 0.0, g: 0.0, b: 0.0, a: 1.0 };
        let targets = frame.targets;
        let colors = [
            Some(cleared(&targets.transparency.view, clear)),
            Some(cleared(&targets.shown_code.view, wgpu::Color::TRANSPARENT)),
        ];
        recording.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear layers"),
            color_attachments: &colors[..if self.shown { 2 } else { 1 }],
            ..Default::default()
        });
        Ok(())
    }
}

/// Whether it is written down which layer is the shown surface: those that are there by chance are it already.
pub fn shows_layers(plan: &FramePlan) -> bool {
    plan.input.wants_shown_layers() && plan.input.transparency != Transparency::Stochastic
}

/// Words of a fragment node.
pub fn words(plan: &FramePlan) -> u32 {
    3 + u32::from(plan.smooth) + u32::from(has_colors(plan)) + u32::from(plan.texels_emit)
}

/// Whether nodes have a colour, and with it the opacity of a texel where textures have some: in clay too.
pub fn has_colors(plan: &FramePlan) -> bool {
    plan.is_textured() || plan.blended
}

/// Whether some opacity rule asks how many layers the picture has.
pub fn asks_most(plan: &FramePlan) -> bool {
    let rules = plan.plans.layering.as_ref().map(|layering| layering.steps_of(EffectKind::Opacity, handlers()));
    rules.into_iter().flatten().any(|(_, rule)| rule.asks_most_layers)
}

/// Refuses a device that binds fewer buffers than lists of layers take.
fn check(gpu: &Gpu, wanted: u32) -> Result<(), GpuError> {
    let most = gpu.device.limits().max_storage_buffers_per_shader_stage;
    if most >= wanted {
        return Ok(());
    }
    let message = format!("it binds {most} storage buffers at a time; what is translucent takes {wanted}");
    Err(GpuError::Failed { adapter: gpu.name(), message })
}
