//! What a frame is drawn from: one sample of one view of a scene, as plain data.
//!
//! [`crate::render::plan`] makes a plan of it, and the passes of [`crate::render::pass`] draw that.

use std::sync::Arc;

use crate::{
    lens::ray_path::RayPaths,
    render::{
        eye::PictureTile, fields::PlacedFields, furniture::Furniture, moved::Moved, operations::Operations,
        solids::SolidTable, volume::LensVolume,
    },
    scene::{Background, BaseStyle, StyleLook, Sun, Technique, Transparency},
    view::View,
};

/// Everything a sample is drawn from.
#[derive(Clone, Debug)]
pub struct FrameInput<'a> {
    /// The eye and the whole picture.
    pub view: View,
    /// The part of the picture that is drawn.
    pub tile: PictureTile,
    /// Light.
    pub sun: Sun,
    /// Colours to start from.
    pub base: BaseStyle,
    /// Whose light it has.
    pub look: StyleLook,
    /// What is behind the city.
    pub background: Background,
    /// How lenses are evaluated.
    pub technique: Technique,
    /// How translucent layers are laid one over the other.
    pub transparency: Transparency,
    /// Nothing is behind the city.
    pub transparent: bool,
    /// How far the air begins to show, as a share of the scene's radius; 0 = never.
    pub haze: f64,
    /// Volumes of enabled lenses, bottom to top.
    pub volumes: &'a [LensVolume],
    /// How many lenses the scene has, disabled ones included.
    pub lens_count: u32,
    /// How lenses bend rays.
    pub rays: &'a RayPaths,
    /// Fields that stand in the city.
    pub fields: &'a PlacedFields,
    /// The solids among them.
    pub solids: &'a Arc<SolidTable>,
    /// What the context and the lenses do.
    pub operations: &'a Operations,
    /// How shaders are made of that.
    pub backend: Backend,
    /// Whether interpolated depth is kept, for the AOV.
    pub measured: bool,
    /// Whether surfaces are kept for AOVs that translucent layers may be the shown surface of.
    pub shown: bool,
    /// Whether every pixel's classes are kept, for AOVs and statistics; of the first sample.
    pub masks: bool,
    /// Which sample this is.
    pub sample: u32,
    /// How many there will be.
    pub samples: u32,
    /// Suns of several moments, each with its operations; each is drawn in a frame of its own, over the others.
    pub suns: &'a [(Sun, Operations)],
    /// Which of how many suns this is.
    pub sun_of: [u32; 2],
    /// Whether a picture of one sample tells by itself how the city hides the sky.
    pub screen_occlusion: bool,
    /// What moves the city.
    pub moved: &'a Moved,
    /// How far edges that it bends may be from where they should be, pixels.
    pub chord_px: f64,
    /// What is drawn over the picture, after its last sample.
    pub furniture: &'a Furniture,
    /// How many triangles the city may take, where it may be simplified to that: at least a quarter of it is for what is no terrain.
    pub most_triangles: Option<u64>,
}

/// What is behind the city, as `lib/light.wgsl` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Behind {
    /// The sky.
    Sky = 0,
    /// One colour.
    OneColor = 1,
    /// The picture is transparent.
    Nothing = 2,
}

impl Behind {
    /// Images that a neighbourhood filter has of such a picture: colours, and of a transparent one opacity.
    pub fn images(self) -> usize {
        1 + usize::from(self == Self::Nothing)
    }
}

impl FrameInput<'_> {
    /// Whether this sample writes the lens masks.
    pub fn wants_masks(&self) -> bool {
        self.masks && self.sample == 0
    }

    /// Layers of the lens masks: three classes, and a bit for each lens.
    pub fn mask_layers(&self) -> u32 {
        3 * self.lens_count.div_ceil(32)
    }

    /// Whether this sample is the last and something stands over the picture.
    pub fn wants_furniture(&self) -> bool {
        !self.furniture.is_empty() && self.is_last()
    }

    /// Haze per radius of the scene; none in orthographic views, which have no distance, nor on clay.
    pub fn haze_per_radius(&self) -> f64 {
        if self.view.is_orthographic() || self.base == BaseStyle::Clay { 0.0 } else { self.haze }
    }

    /// What is behind the city.
    pub fn behind(&self) -> Behind {
        match self.background {
            _ if self.transparent => Behind::Nothing,
            Background::Color(_) => Behind::OneColor,
            Background::Sky => Behind::Sky,
        }
    }

    /// Whether nothing is drawn of the picture after it.
    pub fn is_last(&self) -> bool {
        self.sample + 1 == self.samples && self.sun_of[0] + 1 == self.sun_of[1]
    }

    /// Whether nothing was drawn of the picture before it.
    pub fn is_first(&self) -> bool {
        self.sample == 0 && self.sun_of[0] == 0
    }

    /// Whether the picture is the mean of several samples.
    pub fn is_summed(&self) -> bool {
        self.samples > 1
    }

    /// Whether something asks which translucent layer is the shown surface.
    pub fn wants_shown_layers(&self) -> bool {
        self.shown || self.measured || self.wants_masks()
    }
}

/// Modules that a scene's lenses have a part in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShaderPart {
    /// How what is shown looks.
    #[default]
    Shade,
    /// What is there.
    Geometry,
    /// What casts a shadow.
    Shadow,
    /// Edges as lines.
    Lines,
    /// What is translucent.
    Layers,
    /// How translucent layers look, and are laid over each other.
    Composite,
}

/// How shaders are made of what a scene asks for. The picture is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// For this very scene: the fastest frames; a change of effects, lenses or their order is compiled, and waited for.
    #[default]
    Specialised,
    /// One module for all that the scene may ask for: nothing is compiled when lenses come, go or change their order.
    Uber,
    /// The uber back end, until the specialised pipelines are there; those are made off the frame.
    Adaptive,
}
