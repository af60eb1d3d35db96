//! Where a place is with regard to a lens.

/// Where the shown surface is with regard to a lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Class {
    /// D_F ≤ D < D_B.
    #[default]
    Inside,
    /// D < D_F.
    Front,
    /// D ≥ D_B.
    Behind,
    /// The ray misses the lens.
    Rest,
}
