//! A city on the GPU: its buffers, what binds them, and its edges once something drew lines.

use crate::{
    city::CityModel,
    gpu::{Gpu, GpuError},
    render::{
        city::{CityBuffers, SectionKind, Shown},
        city_source::Source,
        edges::{Edge, EdgeBuffers},
        resource::{
            bindings::group,
            layouts::{CITY, IMAGES},
            pipelines::Pipelines,
        },
    },
};

/// The city's buffers and the groups that bind them.
#[derive(Debug)]
pub(super) struct CityOnGpu {
    pub buffers: CityBuffers,
    pub group: wgpu::BindGroup,
    /// Its edges, once something drew lines.
    pub edges: Option<EdgeBuffers>,
    /// One per section: its textures' group.
    pub images: Vec<Option<SectionImages>>,
    /// One per section: its corners on the host, once something deformed it.
    pub sources: Option<Vec<Source>>,
    /// Its edges on the host, once something deformed them.
    pub edge_sources: Option<Vec<Edge>>,
}

impl CityOnGpu {
    /// Puts what is shown of a city on the GPU, and the block models of its objects where there are some.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, shown: &Shown, blocks: Option<&CityModel>) -> Result<Self, GpuError> {
        let buffers = CityBuffers::new(gpu, shown, blocks)?;
        let surfaces = wgpu::BindingResource::TextureView(&buffers.surfaces);
        let group = group(gpu, "city", &pipelines.layout(&CITY), &[(0, surfaces)]);
        let images = buffers.sections.iter().map(|section| image_of(gpu, pipelines, &buffers, section.kind)).collect();
        Ok(Self { group, images, buffers, edges: None, sources: None, edge_sources: None })
    }

    /// Sections whose surfaces and textures are those of another city.
    pub fn beside(of: &Self, images: Vec<Option<SectionImages>>, buffers: CityBuffers) -> Self {
        Self { group: of.group.clone(), images, buffers, edges: None, sources: None, edge_sources: None }
    }

    /// Puts the edges of what it shows on the GPU, if they are not there.
    pub fn find_edges(&mut self, gpu: &Gpu, shown: &Shown) -> Result<(), GpuError> {
        if self.edges.is_none() {
            self.edges = Some(EdgeBuffers::new(gpu, shown, &self.buffers, &Default::default())?);
        }
        Ok(())
    }
}

/// What binds the textures of a section.
#[derive(Clone, Debug)]
pub(super) struct SectionImages {
    /// Where it is drawn.
    pub drawn: wgpu::BindGroup,
    /// Where each pixel says which level it samples.
    pub by_level: wgpu::BindGroup,
}

/// The textures of a section.
pub(super) fn image_of(
    gpu: &Gpu,
    pipelines: &Pipelines,
    buffers: &CityBuffers,
    kind: SectionKind,
) -> Option<SectionImages> {
    let images = kind.images()?;
    let (mut drawn, mut by_level) = (Vec::new(), Vec::new());
    for (binding, number) in (0..).step_by(2).zip([images.color, images.emission, images.normals]) {
        let texture = buffers.textures.get_or_white(number)?;
        for (entries, sampler) in [(&mut drawn, &texture.sampler), (&mut by_level, &texture.by_level)] {
            entries.push((binding, wgpu::BindingResource::TextureView(&texture.view)));
            entries.push((binding + 1, wgpu::BindingResource::Sampler(sampler)));
        }
    }
    let made = |entries: &[(u32, wgpu::BindingResource)]| group(gpu, "images", &pipelines.layout(&IMAGES), entries);
    Some(SectionImages { drawn: made(&drawn), by_level: made(&by_level) })
}
