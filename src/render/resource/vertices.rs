//! Vertex buffers that several passes draw from.

use crate::render::layout;

/// Corners of the city's triangles.
const VERTEX: &[wgpu::VertexAttribute] =
    &wgpu::vertex_attr_array![0 => Sint32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32];
/// Corners of the faces of solids of lenses, metres.
const SOLID_CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x3];
/// Corners of parts of the picture.
const CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x2];

/// One element per vertex.
pub fn per_vertex(array_stride: u64, attributes: &[wgpu::VertexAttribute]) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
}

/// Corners of the city's triangles.
pub fn city() -> Option<wgpu::VertexBufferLayout<'static>> {
    per_vertex(size_of::<layout::CityVertex>() as u64, VERTEX)
}

/// Corners of the faces of solids of lenses.
pub fn solid_corners() -> Option<wgpu::VertexBufferLayout<'static>> {
    per_vertex(12, SOLID_CORNER)
}

/// Corners of parts of the picture.
pub fn picture_corners() -> Option<wgpu::VertexBufferLayout<'static>> {
    per_vertex(8, CORNER)
}
