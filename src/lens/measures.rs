//! Attributes that no file has to bring: what is measured of the geometry of objects and of faces, by names that begin with `geometry:` and
//! `surface:`. Where a file has an attribute of such a name, that one is meant.

use crate::{
    city::{
        CityModel, decode_normal,
        kept_measures::Face,
        measured::{OfObject, azimuth_deg, slope_deg},
    },
    lens::color::Srgb,
};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// Of objects.
    Object(OfObject),
    /// Of faces: their slope.
    FaceSlope,
    /// Of faces: where they look.
    FaceAzimuth,
    /// Of faces: the area of all of an object that look one way.
    FaceArea,
}

/// A measure: its name and what it is.
#[derive(Debug, PartialEq)]
pub struct Measure {
    /// Its name where an attribute is asked for.
    pub name: &'static str,
    /// What legends call it.
    pub label: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its meaning, one sentence.
    pub doc: &'static str,
    /// What is measured.
    pub what: Measured,
}

const fn row(
    name: &'static str,
    label: &'static str,
    unit: &'static str,
    doc: &'static str,
    what: Measured,
) -> Measure {
    Measure { name, label, unit, doc, what }
}

/// The measures.
pub static MEASURES: [Measure; 8] = [
    row(
        "geometry:height",
        "Height",
        "m",
        "From an object's lowest to its highest vertex.",
        Measured::Object(OfObject::Height),
    ),
    row(
        "geometry:area",
        "Footprint",
        "m²",
        "Ground that an object covers, seen from above.",
        Measured::Object(OfObject::Area),
    ),
    row(
        "geometry:volume",
        "Volume",
        "m³",
        "What an object's faces enclose; no value where they are not closed.",
        Measured::Object(OfObject::Volume),
    ),
    row(
        "geometry:slope",
        "Roof slope",
        "°",
        "Of an object's faces that look up and are less steep than 75°, the mean by area; 0 is level.",
        Measured::Object(OfObject::Slope),
    ),
    row(
        "geometry:azimuth",
        "Roof direction",
        "°",
        "Where most of the area of these faces looks, clockwise from north, of those steeper than 1°; no value without one.",
        Measured::Object(OfObject::Azimuth),
    ),
    row("surface:slope", "Slope", "°", "Of each face by itself: 0 is level, 90 upright.", Measured::FaceSlope),
    row(
        "surface:azimuth",
        "Direction",
        "°",
        "Of each face by itself: where it looks, clockwise from north; no value below a slope of 1°.",
        Measured::FaceAzimuth,
    ),
    row("surface:area", "Area", "m²", "Of an object's faces that look one way, together.", Measured::FaceArea),
];

/// The measure of this name.
pub fn find(name: &str) -> Option<&'static Measure> {
    MEASURES.iter().find(|measure| measure.name == name)
}

/// The number in `shaders/effect/thematic.wgsl` of what stands in a table of faces.
pub const OF_FACES: u32 = 3;

/// Steps into which slopes and directions of faces are divided for shaders: sixteenths and quarters of degrees.
pub const STEPS: usize = 1440;

impl Measured {
    /// Whether it is a direction, which goes round.
    pub fn is_direction(self) -> bool {
        matches!(self, Self::Object(OfObject::Azimuth) | Self::FaceAzimuth)
    }

    /// Whether it follows from where a face looks, so that it stands in steps.
    pub fn is_in_steps(self) -> bool {
        matches!(self, Self::FaceSlope | Self::FaceAzimuth)
    }

    /// Whether it is of faces.
    pub fn is_of_faces(self) -> bool {
        self.word() != 0
    }

    /// Its number in `shaders/effect/thematic.wgsl`.
    pub fn word(self) -> u32 {
        match self {
            Self::Object(_) => 0,
            Self::FaceSlope => 1,
            Self::FaceAzimuth => 2,
            Self::FaceArea => OF_FACES,
        }
    }

    /// The value of a face; `None` without one, or where it is of objects. Areas are its own.
    pub fn of_face(self, face: &Face) -> Option<f64> {
        let normal = decode_normal(face.normal);
        match self {
            Self::Object(_) => None,
            Self::FaceSlope => Some(slope_deg(normal)),
            Self::FaceAzimuth => azimuth_deg(normal),
            Self::FaceArea => Some(face.area),
        }
    }

    /// The value of every object, or of every face, of a city; those of objects by index.
    pub fn values(self, model: &CityModel) -> Vec<Option<f64>> {
        match self {
            Self::Object(what) => {
                model.measured_of_objects(what).into_iter().map(|n| Some(n).filter(|n| n.is_finite())).collect()
            }
            Self::FaceArea => {
                let ways = model.measured_faces().chunk_by(|a, b| (a.object, a.normal) == (b.object, b.normal));
                let area = |way: &[Face]| vec![Some(way.iter().map(|face| face.area).sum()); way.len()];
                ways.flat_map(area).collect()
            }
            _ => model.measured_faces().iter().map(|face| self.of_face(face)).collect(),
        }
    }

    /// The colours of the steps of what is of faces, then that of no value.
    pub fn steps(self, color: impl Fn(f64) -> Srgb, no_data: Srgb) -> Vec<Srgb> {
        let whole = if self.is_direction() { 360.0 } else { 90.0 };
        let step = |i: usize| color((i as f64 + 0.5) / STEPS as f64 * whole);
        (0..STEPS).map(step).chain([no_data]).collect()
    }
}
