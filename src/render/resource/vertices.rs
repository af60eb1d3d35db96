//! Vertex buffers that several passes draw from.

use crate::render::layout;

/// Corners of the city's triangles.
const VERTEX: &[wgpu::VertexAttribute] =
    &wgpu::vertex_attr_array![0 => Sint32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32];
/// Corners of the faces of solids of lenses, metres.
const SOLID_CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x3];
/// Corners of parts of the picture.
const CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x2];

/// Triangles that are cut: where their words begin, their city, and into how many parts a side is.
const PIECE: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Uint32x3];

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

/// Triangles that are cut, one for each instance.
pub fn pieces() -> Option<wgpu::VertexBufferLayout<'static>> {
    let step_mode = wgpu::VertexStepMode::Instance;
    Some(wgpu::VertexBufferLayout { array_stride: 12, step_mode, attributes: PIECE })
}

/// Corners of parts of the picture.
pub fn picture_corners() -> Option<wgpu::VertexBufferLayout<'static>> {
    per_vertex(8, CORNER)
}
