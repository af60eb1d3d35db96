//! Lens tests: how it is decided where a place is with regard to a volume.

/// How it is decided where a place is with regard to a lens volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VolumeTest {
    /// From the figures of a sphere.
    Sphere,
    /// From the figures of an oriented box.
    Box,
    /// From the figures of a cylinder.
    Cylinder,
    /// From the planes of a convex polytope.
    Convex,
    /// From the figures of an ellipsoid.
    Ellipsoid,
    /// From the figures of a cone or frustum.
    Frustum,
    /// From the faces of a solid of any form; cheap for *inside* alone.
    Solid,
    /// From the faces of a solid; *in front* and *behind* from a volumetric depth sprite.
    SolidSprite,
    /// By its volumetric depth sprite.
    Sprite,
    /// By the object that a place belongs to.
    Members,
    /// From the leaves of a combination; cheap for *inside* alone.
    Combined,
    /// From the leaves of a combination; *in front* and *behind* from a volumetric depth sprite.
    CombinedSprite,
    /// From a figure in a plane, which is looked through.
    Flat,
    /// By its volumetric depth sprite, whatever that is stored in.
    LayeredSprite,
    /// By a volumetric depth sprite that has its own eye.
    OwnSprite,
    /// By the object that a place belongs to, where objects come or go.
    FadingMembers,
}

impl VolumeTest {
    /// All of them, in the order of their numbers in `lib/shape.wgsl`.
    pub const ALL: [Self; 16] = [
        Self::Sphere,
        Self::Box,
        Self::Cylinder,
        Self::Convex,
        Self::Ellipsoid,
        Self::Frustum,
        Self::Solid,
        Self::SolidSprite,
        Self::Sprite,
        Self::Members,
        Self::Combined,
        Self::CombinedSprite,
        Self::Flat,
        Self::LayeredSprite,
        Self::OwnSprite,
        Self::FadingMembers,
    ];

    /// Its number, as `lib/shape.wgsl` knows it.
    pub fn number(self) -> u32 {
        Self::ALL.iter().position(|t| *t == self).unwrap_or(0) as u32
    }

    /// Whether a volumetric depth sprite of the picture's eye alone says where a place is.
    pub fn is_sprite(self) -> bool {
        matches!(self, Self::Sprite | Self::LayeredSprite)
    }

    /// Whether a volumetric depth sprite tells the sides of what is not inside.
    pub fn has_sides(self) -> bool {
        matches!(self, Self::SolidSprite | Self::CombinedSprite)
    }

    /// Whether it says in closed form where rays are inside, and they leave it again.
    pub fn has_span(self) -> bool {
        matches!(self, Self::Sphere | Self::Box | Self::Cylinder | Self::Convex | Self::Ellipsoid | Self::Frustum)
    }

    /// Whether it may read the faces of a solid.
    pub fn has_faces(self) -> bool {
        matches!(self, Self::Solid | Self::SolidSprite) || self.has_leaves()
    }

    /// Whether it reads the leaves of a combination.
    pub fn has_leaves(self) -> bool {
        matches!(self, Self::Combined | Self::CombinedSprite)
    }

    /// Its constant there.
    pub fn constant(self) -> &'static str {
        match self {
            Self::Sphere => "SPHERE",
            Self::Box => "BOX",
            Self::Cylinder => "CYLINDER",
            Self::Convex => "CONVEX",
            Self::Ellipsoid => "ELLIPSOID",
            Self::Frustum => "FRUSTUM",
            Self::Solid => "SOLID",
            Self::SolidSprite => "SOLID_SPRITE",
            Self::Sprite => "SPRITE",
            Self::Members => "MEMBERS",
            Self::Combined => "COMBINED",
            Self::CombinedSprite => "COMBINED_SPRITE",
            Self::Flat => "FLAT",
            Self::LayeredSprite => "LAYERED_SPRITE",
            Self::OwnSprite => "OWN_SPRITE",
            Self::FadingMembers => "FADING_MEMBERS",
        }
    }
}
