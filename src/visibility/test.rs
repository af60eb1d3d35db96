//! Detection tests as data.

use glam::DVec3;

/// When a unit is an occluder. A box is that around what is shown of a unit, with edges along the axes; LF is the eye.
/// Tests of boxes count a unit whose box holds the eye.
#[derive(Clone, Debug, PartialEq)]
pub enum Test {
    /// A reference point of its box is less than `radius` metres from the eye (Trapp, eq. 3.16).
    Spherical {
        /// Metres, ≥ 0; 50 to 150 in streets.
        radius: f64,
        /// Which point counts.
        reference: Reference,
    },
    /// The middle of its box is less than `radius` metres from the eye, measured across `up`.
    Cylindrical {
        /// Metres, ≥ 0.
        radius: f64,
        /// LU, unit.
        up: DVec3,
    },
    /// As [`Self::Spherical`], and its box meets the plane through the eye across `up` (Trapp, eq. 3.17).
    ViewerHeight {
        /// Metres, ≥ 0.
        radius: f64,
        /// Which point counts.
        reference: Reference,
        /// LU, unit.
        up: DVec3,
    },
    /// Its box meets the segment from the eye to the middle of a point of interest (Trapp, eq. 3.18); exact.
    ViewAxis,
    /// The base of its box meets the disc of `radius` metres around the place under the eye, in plan.
    Ground {
        /// Metres, ≥ 0.
        radius: f64,
    },
    /// A triangle of it lies on a sight line from the eye to the box around a point of interest: before the box, or within it
    /// before a face of the object. Exact ([`crate::geom::shaft`]).
    Exact {
        /// Only where it covers at least this share of the point of interest, 0..=1; 0: any triangle counts.
        coverage: f64,
        /// Rays that the share is measured by, 1..=65,536; 256 are right to 6 % (95 % interval).
        rays: u32,
    },
    /// A triangle of it lies on a sight line from the eye to a point of a polyline, before that point. Exact.
    Route {
        /// Its corners, metres; at least two.
        points: Vec<DVec3>,
    },
    /// Some of them hold.
    Any(Vec<Test>),
    /// All of them hold.
    All(Vec<Test>),
    /// It does not hold.
    Not(Box<Test>),
}

/// Which point of a box is asked for its distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// Its middle.
    #[default]
    Centre,
    /// The point of it that is nearest.
    Nearest,
    /// One corner is enough.
    AnyCorner,
    /// All corners must be near.
    AllCorners,
}

impl Reference {
    /// All, with their words.
    pub const WORDS: [(&str, Self); 4] = [
        ("centre", Self::Centre),
        ("nearest", Self::Nearest),
        ("any-corner", Self::AnyCorner),
        ("all-corners", Self::AllCorners),
    ];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, reference)| *reference == self).map_or("centre", |(word, _)| word)
    }

    /// The reference of a word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, reference)| *reference)
    }
}

impl Default for Test {
    fn default() -> Self {
        Self::Exact { coverage: 0.0, rays: Self::RAYS }
    }
}

impl Test {
    /// Rays that shares are measured by where nothing else is said.
    pub const RAYS: u32 = 256;

    /// Its word in scene files and statistics.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Spherical { .. } => "spherical",
            Self::Cylindrical { .. } => "cylindrical",
            Self::ViewerHeight { .. } => "viewer-height",
            Self::ViewAxis => "view-axis",
            Self::Ground { .. } => "ground",
            Self::Exact { .. } => "exact",
            Self::Route { .. } => "route",
            Self::Any(_) => "any",
            Self::All(_) => "all",
            Self::Not(_) => "not",
        }
    }

    /// The tests it is put together from; none for one that is not.
    pub fn parts(&self) -> &[Self] {
        match self {
            Self::Any(parts) | Self::All(parts) => parts,
            Self::Not(part) => std::slice::from_ref(part),
            _ => &[],
        }
    }

    /// Whether it asks for a point of interest.
    pub fn needs_poi(&self) -> bool {
        matches!(self, Self::ViewAxis | Self::Exact { .. }) || self.parts().iter().any(Self::needs_poi)
    }
}
