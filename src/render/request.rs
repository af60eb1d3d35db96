//! What is asked of a picture.

use crate::render::frame::Backend;

/// Which AOVs a picture brings along; all of the unjittered sample at the pixel's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Aovs {
    /// Metres along the view axis.
    pub depth: bool,
    /// Object index + 1.
    pub object_id: bool,
    /// Unit normals.
    pub normal: bool,
    /// Lens membership.
    pub lens_mask: bool,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Width, height, pixels.
    pub size: [u32; 2],
    /// Samples per pixel, at least 1.
    pub samples: u32,
    /// Nothing behind the city.
    pub transparent: bool,
    /// AOVs.
    pub aovs: Aovs,
    /// Whether passes are timed and lenses counted.
    pub statistics: bool,
    /// How shaders are made.
    pub backend: Backend,
    /// Whether a picture of one sample tells by itself how the city hides the sky, where the sun has ambient occlusion: as the window does until the
    /// samples are there.
    pub screen_occlusion: bool,
}

impl Request {
    /// One sample of a picture of this size, and nothing beside it.
    pub fn plain(size: [u32; 2]) -> Self {
        Self {
            size,
            samples: 1,
            transparent: false,
            aovs: Aovs::default(),
            statistics: false,
            backend: Backend::default(),
            screen_occlusion: false,
        }
    }
}
