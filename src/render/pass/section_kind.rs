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
    /// Depth from the shared plane; what its images do, where it has some.
    Coplanar(Option<Look>),
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
    /// Whether there is none: storeys and windows are drawn.
    pub facade: bool,
}

impl Look {
    fn of(images: Images) -> Self {
        let Images { emission, normal_scale, texels, facade, .. } = images;
        Self { texels, emits: emission != NONE, normal_scale, facade }
    }
}

impl From<SectionKind> for GeometryKind {
    fn from(kind: SectionKind) -> Self {
        match (kind, kind.images().map(Look::of)) {
            (SectionKind::Coplanar(_), look) => Self::Coplanar(look),
            (_, None) => Self::Plain,
            (_, Some(look)) => Self::Textured(look),
        }
    }
}

/// Opacity below which a texel is not there: half of the least that is not 0.
const LEAST_SEEN: f64 = 0.5 / 255.0;

const TEXCOORD: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x2];
const TEXTURED_PLANE: &[wgpu::VertexAttribute] =
    &wgpu::vertex_attr_array![4 => Float32x3, 5 => Sint32x3, 6 => Float32, 7 => Float32x2];
/// Of these, the texture coordinate alone, as where there is no plane.
const TEXCOORD_OF_PLANE: &[wgpu::VertexAttribute] = &[wgpu::VertexAttribute {
    offset: std::mem::offset_of!(layout::TexturedPlane, texcoord) as u64,
    shader_location: 4,
    format: wgpu::VertexFormat::Float32x2,
}];
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
            Self::Coplanar(None) => per_vertex(size_of::<layout::Plane>() as u64, PLANE),
            Self::Coplanar(Some(_)) => per_vertex(size_of::<layout::TexturedPlane>() as u64, TEXTURED_PLANE),
        };
        std::iter::once(vertices::city()).chain(extra.map(Some)).collect()
    }

    /// What its texture coordinates are read from where planes do not matter.
    pub fn texcoord_buffers(self) -> Vec<Option<wgpu::VertexBufferLayout<'static>>> {
        let texcoord = match self {
            Self::Coplanar(_) => per_vertex(size_of::<layout::TexturedPlane>() as u64, TEXCOORD_OF_PLANE),
            _ => per_vertex(size_of::<[f32; 2]>() as u64, TEXCOORD),
        };
        vec![vertices::city(), texcoord]
    }

    /// What its images do.
    pub fn look(self) -> Option<Look> {
        match self {
            Self::Plain | Self::Coplanar(None) => None,
            Self::Textured(look) | Self::Coplanar(Some(look)) => Some(look),
        }
    }

    /// Whether its depth is that of shared planes.
    pub fn is_layer(self) -> bool {
        matches!(self, Self::Coplanar(_))
    }

    /// Group 3: textures.
    pub fn images(self) -> Option<&'static GroupLayout> {
        self.look().map(|_| &IMAGES)
    }

    /// The target of shares of own light: others than these leave it alone.
    pub fn emissions(self) -> wgpu::ColorTargetState {
        let is_written = self.look().is_some_and(|look| look.emits);
        let write_mask = if is_written { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() };
        wgpu::ColorTargetState { format: EMISSIONS, blend: None, write_mask }
    }

    /// What images do, as pipelines read it; where triangles hold their depth, how many words corners have besides.
    pub fn constants(self, holds_depth: bool) -> Vec<(&'static str, f64)> {
        let bytes = match self {
            Self::Plain => 0,
            Self::Textured(_) => size_of::<[f32; 2]>(),
            Self::Coplanar(None) => size_of::<layout::Plane>(),
            Self::Coplanar(Some(_)) => size_of::<layout::TexturedPlane>(),
        };
        let least = |texels| match texels {
            Texels::Opaque => 0.0,
            Texels::Holes(least) => f64::from(f32::from_bits(least)),
            Texels::Translucent => LEAST_SEEN,
        };
        let of_images = self.look().map(|Look { texels, emits, normal_scale, facade }| {
            [
                ("ALPHA_CUTOFF", least(texels)),
                ("TRANSLUCENT", flag(texels == Texels::Translucent)),
                ("IMAGE_EMITS", flag(emits)),
                ("NORMAL_SCALE", f64::from(f32::from_bits(normal_scale))),
                ("FACADE", flag(facade)),
            ]
        });
        of_images.into_iter().flatten().chain(holds_depth.then_some(("WORDS_BESIDES", (bytes / 4) as f64))).collect()
    }

    /// What names of pipelines say of it.
    pub fn words(self) -> String {
        let plane = if self.is_layer() { " coplanar" } else { "" };
        let Some(look) = self.look() else { return plane.to_owned() };
        let texels = match look.texels {
            Texels::Opaque => " of textures",
            Texels::Holes(_) => " of textures with holes",
            Texels::Translucent => " of translucent textures",
        };
        let texels = if look.facade { " of storeys" } else { texels };
        format!("{plane}{texels}{}", words(&[(look.emits, "of light"), (look.normal_scale != 0, "of normals")]))
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
