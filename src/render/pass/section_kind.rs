//! Kinds of sections of a city, as far as pipelines differ.

use crate::render::{
    city::SectionKind,
    layout,
    resource::{
        bindings::GroupLayout,
        layouts::IMAGE,
        vertices::{self, per_vertex},
    },
};

/// Kinds of geometry sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GeometryKind {
    /// Ordinary.
    Plain,
    /// Textured, with the bits of the alpha cutoff.
    Textured(u32),
    /// Depth from the shared plane.
    Coplanar,
}

impl From<SectionKind> for GeometryKind {
    fn from(kind: SectionKind) -> Self {
        match kind {
            SectionKind::Plain => Self::Plain,
            SectionKind::Textured { alpha_cutoff, .. } => Self::Textured(alpha_cutoff.to_bits()),
            SectionKind::Coplanar => Self::Coplanar,
        }
    }
}

const TEXCOORD: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x2];
const PLANE: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x3, 5 => Sint32x3, 6 => Float32];

impl GeometryKind {
    /// What it is drawn from; where triangles hold their depth, corners are read from storage.
    pub fn vertex_buffers(self, holds_depth: bool) -> Vec<Option<wgpu::VertexBufferLayout<'static>>> {
        if holds_depth {
            return Vec::new();
        }
        let extra = match self {
            Self::Plain => None,
            Self::Textured(_) => per_vertex(8, TEXCOORD),
            Self::Coplanar => per_vertex(size_of::<layout::Plane>() as u64, PLANE),
        };
        std::iter::once(vertices::city()).chain(extra.map(Some)).collect()
    }

    /// Group 3: a texture.
    pub fn image(self) -> Option<&'static GroupLayout> {
        matches!(self, Self::Textured(_)).then_some(&IMAGE)
    }

    /// The opacity below which texels are holes, as pipelines read it; where triangles hold their depth, how many words corners have besides.
    pub fn constants(self, holds_depth: bool) -> Vec<(&'static str, f64)> {
        let (cutoff, words) = match self {
            Self::Plain => (None, 0),
            Self::Textured(cutoff) => (Some(cutoff), 2),
            Self::Coplanar => (None, size_of::<layout::Plane>() / 4),
        };
        let cutoff = cutoff.map(|cutoff| ("ALPHA_CUTOFF", f64::from(f32::from_bits(cutoff))));
        cutoff.into_iter().chain(holds_depth.then_some(("WORDS_BESIDES", words as f64))).collect()
    }

    /// What names of pipelines of layers say of it.
    pub fn layer_words(self) -> &'static str {
        match self {
            Self::Plain => "",
            Self::Textured(0) => " of textures",
            Self::Textured(_) => " of textures with holes",
            Self::Coplanar => " coplanar",
        }
    }
}

/// Normals of a section's city, and of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Normals {
    /// Whether some faces of the picture have normals per vertex.
    pub smooth: bool,
    /// Whether they are in other cities of the picture, and this one has flat faces alone.
    pub flat: bool,
}

impl Normals {
    /// Of a city in a picture.
    pub fn new(smooth: bool, is_smooth_city: bool) -> Self {
        Self { smooth, flat: smooth && !is_smooth_city }
    }
}
