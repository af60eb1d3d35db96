//! Why a shape is no volume, in words.

use crate::geom::{
    shape::limits::{MAX_CORNERS, MAX_FACES, MAX_PLANES, MAX_POINTS},
    triangulate::Refusal,
};

/// Why a polygon was refused, in words.
fn words_for(refusal: &Refusal) -> &'static str {
    match refusal {
        Refusal::ShortRing => "a ring needs at least 3 points that differ",
        Refusal::ZeroArea => "the polygon has no area: all its points are on one line",
        Refusal::SelfCrossing => {
            "the polygon crosses itself, or a hole crosses its border: order the points along the border"
        }
        Refusal::AreaMismatch => "the holes must lie inside of the polygon and not overlap",
        Refusal::TooLarge => "the polygon is too large",
    }
}

/// Why a shape is no volume.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A number is NaN or infinite.
    #[error("every number must be finite")]
    NotFinite,
    /// A length is negative.
    #[error("{0} must be ≥ 0, is {1}")]
    Negative(&'static str, f64),
    /// The axis has no direction.
    #[error("axis must have a length, is 0, 0, 0")]
    NoAxis,
    /// Too few points for a volume.
    #[error("a convex hull needs at least 4 points that differ, has {0}")]
    FewPoints(usize),
    /// Too few points for a line.
    #[error("a line needs at least 2 points, has {0}")]
    ShortLine(usize),
    /// Too few points for an area.
    #[error("a polygon needs at least 3 points, has {0}")]
    FewCorners(usize),
    /// More corners than a pixel can be tested against.
    #[error("a polygon may have at most {max} points, has {0}", max = MAX_CORNERS)]
    ManyCorners(usize),
    /// What a flat lens holds depends on the eye, [`crate::geom::shape::Shape::volumes_seen`].
    #[error(
        "a flat lens holds what an eye sees through it: it cannot be asked without one, nor be part of another shape"
    )]
    NeedsEye,
    /// The shape is the union of several volumes, [`crate::geom::shape::Shape::volumes`].
    #[error("a corridor is several volumes")]
    Several,
    /// More points than a lens needs.
    #[error("a shape may have at most {max} points, has {0}", max = MAX_POINTS)]
    ManyPoints(usize),
    /// More planes than a lens needs.
    #[error("a polytope may have at most {max} planes, has {0}", max = MAX_PLANES)]
    ManyPlanes(usize),
    /// A plane without direction.
    #[error("plane {0} must have a normal, is 0, 0, 0")]
    NoNormal(usize),
    /// The planes leave it open to some side.
    #[error(
        "the planes must close a body: it is open to some side, so add the plane that is missing, or turn one round"
    )]
    Open,
    /// No point is on the inner side of all planes, or only a flat figure.
    #[error("the planes leave nothing between them: turn those round whose normal points inwards")]
    Nothing,
    /// A polygon is none.
    #[error("{}", words_for(.0))]
    Ring(crate::geom::triangulate::Refusal),
    /// Layers of a 3D mask differ in size.
    #[error("layer {0} has {1:?} pixels, the first has {2:?}: all layers need the same size")]
    Layers(usize, [u32; 2], [u32; 2]),
    /// A mask without a single pixel.
    #[error("the mask is empty: a pixel belongs to it where it is opaque and at least as bright as mid grey")]
    EmptyMask,
    /// More faces than a lens needs.
    #[error("a solid may have at most {max} triangles, has {0}", max = MAX_FACES)]
    ManyFaces(usize),
    /// Faces that enclose nothing.
    #[error("the faces enclose no volume")]
    NoBody,
    /// All points lie on one plane (or line).
    #[error("all {0} points lie on one plane: the hull has no volume; move one of them off it")]
    Flat(usize),
}
