//! Forms that objects may be shown as, and what is derived.

use crate::{city::model::CityModel, geom::Aabb};

/// The way in which a city is derived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derive {
    /// The form of each object.
    pub form: Form,
    /// Whether each object that has faces stands for itself; else a root object stands for itself and all its parts.
    pub parts: bool,
}

/// The form that an object is shown as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Its bounding box: along the axes, or upright on the smallest rectangle around its footprint.
    Box {
        /// Whether on the smallest rectangle.
        oriented: bool,
    },
    /// Its footprint, the outline of all of it seen from above, from its lowest to its highest point.
    Prism,
    /// Its convex hull.
    Hull,
    /// Its block model, of level of detail 1; where it has none, its prism.
    Lod1,
    /// Its faces that are seen from above, on the ground below it; where that has none, at its lowest point.
    Flat {
        /// The height above these, metres, ≥ 0.
        lift_m: f64,
    },
    /// The same, each face in the light that it had where it stood.
    Top {
        /// As that of [`Self::Flat`].
        lift_m: f64,
    },
    /// Itself, as high as this: walls stretched or shortened, roofs moved.
    Height(Height),
}

/// The height that something is to have, counted from its lowest point to its highest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// Metres, > 0.
    Metres(f64),
    /// This many times what it is, > 0.
    Factor(f64),
}

/// The height of flattened objects above the ground, or their lowest points, where nothing else is asked for, metres: depth tells them
/// from it then.
pub const LIFT_M: f64 = 0.05;

/// The range of lifts, metres.
pub const LIFT_RANGE_M: [f64; 2] = [0.0, 1000.0];
/// The range of heights, metres.
pub const HEIGHT_RANGE_M: [f64; 2] = [0.001, 100_000.0];

impl Form {
    /// Whether it lies on the ground, and throws no shadow.
    pub fn is_pressed(&self) -> bool {
        matches!(self, Self::Flat { .. } | Self::Top { .. })
    }

    /// A box that holds what the form makes of an object, whatever of that is shown; `bounds`: of all its geometries.
    pub fn reach(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() {
            return *bounds;
        }
        let size = bounds.size();
        let mut reach = Aabb { min: bounds.min - 1e-3, max: bounds.max + 1e-3 };
        match self {
            // The circle around all holds what stands on it: corners of the rectangle are no farther out than its sides are long.
            Self::Box { oriented: true } => {
                let aside = size.truncate().length() + 1e-3;
                (reach.min.x, reach.min.y) = (bounds.min.x - aside, bounds.min.y - aside);
                (reach.max.x, reach.max.y) = (bounds.max.x + aside, bounds.max.y + aside);
            }
            // From the lowest point that any level of detail may show.
            Self::Height(Height::Metres(metres)) => reach.max.z += metres,
            Self::Height(Height::Factor(factor)) => reach.max.z += size.z * (factor - 1.0).max(0.0),
            // On ground that rises and falls by no more than it is wide.
            Self::Flat { lift_m } | Self::Top { lift_m } => {
                let slope = size.truncate().length();
                (reach.min.z, reach.max.z) = (bounds.min.z - slope, bounds.max.z + slope + lift_m);
            }
            Self::Box { .. } | Self::Prism | Self::Hull | Self::Lod1 => {}
        }
        reach
    }
}

/// A city that was derived.
#[derive(Debug, Default)]
pub struct Derived {
    /// Its objects are those of the city it was made of, by number, without their attributes; all of its geometries are shown.
    pub model: CityModel,
    /// For each corner of each triangle, how high it was, metres: of triangles in one plane the highest is seen. Empty where forms
    /// leave nothing to tell apart.
    pub heights: Vec<[f32; 3]>,
    /// Objects without such a form, shown as they are.
    pub unchanged: u32,
    /// Objects of which the form leaves nothing.
    pub left_out: u32,
    /// Objects that have no such geometry of their own, and stand as something else instead.
    pub instead: u32,
}

impl Derived {
    /// All of its geometries.
    pub fn geometries(&self) -> Vec<u32> {
        (0..self.model.geometries.len() as u32).collect()
    }
}
