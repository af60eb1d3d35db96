//! Kinds of sections of a city, as far as pipelines differ.

use crate::{
    city::NONE,
    render::{
        city::{Images, SectionKind, Texels},
        layout,
        resource::{
            bindings::GroupLayout,
            formats::EMISSIONS,
            key::{flag, words},
            layouts::IMAGES,
            vertices::{self, per_vertex},
        },
    },
};

/// Kinds of geometry sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GeometryKind {
    /// Ordinary.
    Plain,
    /// Textured, and what its images do.
    Textured(Look),
    /// Depth from the shared plane.
    Coplanar,
}

/// What images do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Look {
    /// The opacity of that of colours.
    pub texels: Texels,
    /// Whether one says how much of its own light there is.
    pub emits: bool,
    /// What the x and y of that of normals are multiplied with: the bits of its f32; 0 where there is none.
    pub normal_scale: u32,
}

impl Look {
    /// An opaque image of colours.
    pub const PLAIN: Self = Self { texels: Texels::Opaque, emits: false, normal_scale: 0 };
}

impl From<SectionKind> for GeometryKind {
    fn from(kind: SectionKind) -> Self {
        match kind {
            SectionKind::Plain => Self::Plain,
            SectionKind::Textured(Images { emission, normal_scale, texels, .. }) => {
                Self::Textured(Look { texels, emits: emission != NONE, normal_scale })
            }
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

    /// Group 3: textures.
    pub fn images(self) -> Option<&'static GroupLayout> {
        matches!(self, Self::Textured(_)).then_some(&IMAGES)
    }

    /// The target of shares of own light: others than these leave it alone.
    pub fn emissions(self) -> wgpu::ColorTargetState {
        let is_written = matches!(self, Self::Textured(Look { emits: true, .. }));
        let write_mask = if is_written { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() };
        wgpu::ColorTargetState { format: EMISSIONS, blend: None, write_mask }
    }

    /// What images do, as pipelines read it; where triangles hold their depth, how many words corners have besides.
    pub fn constants(self, holds_depth: bool) -> Vec<(&'static str, f64)> {
        let (look, words) = match self {
            Self::Plain => (None, 0),
            Self::Textured(look) => (Some(look), 2),
            Self::Coplanar => (None, size_of::<layout::Plane>() / 4),
        };
        let least = |texels| match texels {
            Texels::Opaque => 0.0,
            Texels::Holes(least) => f64::from(f32::from_bits(least)),
            Texels::Translucent => LEAST_SEEN,
        };
        let of_images = look.map(|Look { texels, emits, normal_scale }| {
            [
                ("ALPHA_CUTOFF", least(texels)),
                ("TRANSLUCENT", flag(texels == Texels::Translucent)),
                ("IMAGE_EMITS", flag(emits)),
                ("NORMAL_SCALE", f64::from(f32::from_bits(normal_scale))),
            ]
        });
        of_images.into_iter().flatten().chain(holds_depth.then_some(("WORDS_BESIDES", words as f64))).collect()
    }

    /// What names of pipelines say of it.
    pub fn words(self) -> String {
        let look = match self {
            Self::Plain => return String::new(),
            Self::Coplanar => return " coplanar".to_owned(),
            Self::Textured(look) => look,
        };
        let texels = match look.texels {
            Texels::Opaque => " of textures",
            Texels::Holes(_) => " of textures with holes",
            Texels::Translucent => " of translucent textures",
        };
        format!("{texels}{}", words(&[(look.emits, "of light"), (look.normal_scale != 0, "of normals")]))
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
