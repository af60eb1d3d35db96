//! What frames had of translucent layers, and how much memory they may take.

/// The most that fragment nodes take, bytes: what exceeds it is drawn in bands.
pub const LAYER_BYTES: u64 = 96 << 20;

/// What a frame had of translucent layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerFigures {
    /// Fragments that are seen through and not behind what is opaque.
    pub nodes: u64,
    /// Bands that the picture was drawn in.
    pub bands: u32,
    /// Fragments that found no room and are missing in the picture.
    pub excess: u64,
}

/// What the method of a frame took and left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodFigures {
    /// What it holds on the GPU, bytes, beside the targets that the exact method has too.
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
