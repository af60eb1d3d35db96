//! The most that shapes may have.

/// Corners a polygon may have: each costs every pixel of its bounds a test.
pub const MAX_CORNERS: usize = 1024;

/// Points a hull may be given: each costs a test against every face.
pub const MAX_POINTS: usize = 4096;

/// Planes a body may be given: each three of them may meet in a corner.
pub const MAX_PLANES: usize = 64;

/// Faces that a solid may have.
pub const MAX_FACES: usize = 1 << 20;
