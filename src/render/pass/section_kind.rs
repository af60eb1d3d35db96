//! Kinds of sections of a city, as far as pipelines differ.

use crate::render::{
    city::{SectionKind, Texels},
    layout,
    resource::{
        bindings::GroupLayout,
        key::flag,
        layouts::IMAGE,
        vertices::{self, per_vertex},
    },
};

/// Kinds of geometry sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GeometryKind {
    /// Ordinary.
    Plain,
    /// Textured, and what the opacity of texels does.
    Textured(Texels),
    /// Depth from the shared plane.
    Coplanar,
}

impl From<SectionKind> for GeometryKind {
    fn from(kind: SectionKind) -> Self {
        match kind {
            SectionKind::Plain => Self::Plain,
            SectionKind::Textured { texels, .. } => Self::Textured(texels),
            SectionKind::Coplanar => Self::Coplanar,
        }
    }
}

/// Opacity below which a texel is not there: half of the least that is not 0.
const LEAST_SEEN: f64 = 0.5 / 255.0;

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

    /// What the opacity of texels does, as pipelines read it; where triangles hold their depth, how many words corners have besides.
    pub fn constants(self, holds_depth: bool) -> Vec<(&'static str, f64)> {
        let (texels, words) = match self {
            Self::Plain => (None, 0),
            Self::Textured(texels) => (Some(texels), 2),
            Self::Coplanar => (None, size_of::<layout::Plane>() / 4),
        };
        let least = |texels| match texels {
            Texels::Opaque => 0.0,
            Texels::Holes(least) => f64::from(f32::from_bits(least)),
            Texels::Translucent => LEAST_SEEN,
        };
        let of_texels = texels
            .map(|t| [("ALPHA_CUTOFF", least(t)), ("TRANSLUCENT", flag(t == Texels::Translucent))])
            .into_iter()
            .flatten();
        of_texels.chain(holds_depth.then_some(("WORDS_BESIDES", words as f64))).collect()
    }

    /// What names of pipelines of layers say of it.
    pub fn layer_words(self) -> &'static str {
        match self {
            Self::Plain => "",
            Self::Textured(Texels::Opaque) => " of textures",
            Self::Textured(Texels::Holes(_)) => " of textures with holes",
            Self::Textured(Texels::Translucent) => " of translucent textures",
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
