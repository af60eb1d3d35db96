//! Lenses that draw what hides a point of interest so that it can be seen.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::{body::LensBody, content::Content, rendering::Rendering};

/// What an occlusion lens has of its own, beside the occluders of its focus areas.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Occlusion {
    /// How occluders are drawn.
    pub rendering: Rendering,
    /// What it shows in place of what is below it; `None`: it acts on that.
    pub content: Option<Content>,
}

impl OwnKind for Occlusion {
    // What is done to occluders is what tells of them; a line around what is opaque of it, and none around the rest, tells less.
    const ROW: KindRow = KindRow { body: LensBody::None, ..KindRow::new("occlusion") };

    fn empty() -> Self {
        Self::default()
    }
}

impl Own for Occlusion {
    fn content(&self) -> Option<&Content> {
        self.content.as_ref()
    }

    fn content_mut(&mut self) -> Option<&mut Content> {
        self.content.as_mut()
    }

    fn set_content(&mut self, content: Option<Content>) {
        self.content = content;
    }

    fn rendering(&self) -> Option<&Rendering> {
        Some(&self.rendering)
    }

    fn rendering_mut(&mut self) -> Option<&mut Rendering> {
        Some(&mut self.rendering)
    }
}
