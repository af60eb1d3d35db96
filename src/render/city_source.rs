//! The corners of a section of the city, read back to the host.

use glam::{DVec3, IVec3, Vec3};

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        city::{Section, SectionKind, provoking_corner},
        layout::{CityVertex, TexturedPlane},
    },
};

/// The corners of a section, on the host.
#[derive(Debug)]
pub(super) struct Source {
    /// Which corner of a triangle flat values come from.
    pub provoking: usize,
    pub vertices: Vec<CityVertex>,
    pub indices: Vec<u32>,
    pub texcoords: Vec<[f32; 2]>,
}

impl Source {
    /// What the GPU has of a section.
    pub fn read(gpu: &Gpu, section: &Section) -> Result<Self, GpuError> {
        let of = |buffer: &wgpu::Buffer| gpu.read_buffer(buffer);
        let texcoords = match (section.kind, &section.extra) {
            (SectionKind::Textured(_), Some(extra)) => bytemuck::pod_collect_to_vec(&of(extra)?),
            (SectionKind::Coplanar(Some(_)), Some(extra)) => {
                let each: Vec<TexturedPlane> = bytemuck::pod_collect_to_vec(&of(extra)?);
                each.iter().map(|corner| corner.texcoord).collect()
            }
            _ => Vec::new(),
        };
        let vertices = bytemuck::pod_collect_to_vec(&of(&section.vertices)?);
        let provoking = provoking_corner(gpu);
        Ok(Self { provoking, vertices, indices: bytemuck::pod_collect_to_vec(&of(&section.indices)?), texcoords })
    }

    /// Where a vertex is, exactly.
    pub fn place(&self, index: u32) -> DVec3 {
        let CityVertex { origin, position, .. } = self.vertices[index as usize];
        IVec3::from(origin).as_dvec3() + Vec3::from(position).as_dvec3()
    }
}
