//! Methods of laying translucent layers one over the other that are not exact or not fast, for comparison and for small cards
//! (O7, [`crate::scene::Transparency`]): the same fragments, classes, opacities and shading as the exact one (`render::layers`).
//!
//! ```text
//! k-buffer    slots: depths, codes, rest    the nearest layers of each pixel, whatever the draw order; then as lists
//!             composite
//! peel        the same, again and again with what is behind
//! weighted    composite of no slot at all, and of all layers as the tail that a K-buffer has
//! stochastic  chance    layers that are there by chance, into the targets of what is opaque
//! ```

mod draws;
mod forward;
mod keys;
mod slots;

pub(super) use keys::through_format;
pub use keys::{ForwardKeys, FragmentPass, SlotKeys, TranslucentKey};
pub(super) use slots::SlotsOnGpu;

/// What the method of a frame took and left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodFigures {
    /// What it holds on the card, bytes, beside the targets that the exact method has too.
    pub bytes: u64,
    /// Rounds of peeling, all bands together.
    pub rounds: u32,
    /// Fragments whose order is not known, and that are seen as one layer; `None`: they were not counted.
    pub merged: Option<u64>,
    /// Fragments that it does not show though nothing opaque is before them.
    pub dropped: u64,
}

impl MethodFigures {
    /// Adds another frame of the same picture.
    pub(super) fn add(&mut self, other: &Self) {
        self.bytes = self.bytes.max(other.bytes);
        self.rounds += other.rounds;
        self.merged = other.merged.map(|merged| merged + self.merged.unwrap_or(0));
        self.dropped += other.dropped;
    }
}
