//! Shapes as they are given, in model coordinates, and their check.

use glam::{DQuat, DVec3};

use crate::geom::shape::{
    corridor,
    error::ShapeError,
    flat::{Flat, FlatFigure, Sightlines},
    form::{
        Volume, cylinder::Cylinder, ellipsoid::Ellipsoid, frustum::Frustum, oriented_box::OrientedBox, sphere::Sphere,
    },
    hull::Hull,
    polytope,
};

/// A volume, in model coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
    },
    /// An oriented box; `size` = full edges.
    Box {
        /// Its middle, metres.
        center: DVec3,
        /// Full edges, metres, ≥ 0.
        size: DVec3,
        /// Turns the box's axes into the world's.
        rotation: DQuat,
    },
    /// A finite cylinder; `axis` unit, `center` = the middle of its axis.
    Cylinder {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
        /// Full height, metres, ≥ 0.
        height: f64,
        /// Unit.
        axis: DVec3,
    },
    /// A ball that is stretched along its own axes.
    Ellipsoid {
        /// Its middle, metres.
        center: DVec3,
        /// Half its extent along its own x, y, z, metres, ≥ 0.
        radii: DVec3,
        /// Turns its axes into the world's.
        rotation: DQuat,
    },
    /// A cone, or what is left of one without its tip; `axis` unit, `center` = the middle of its axis.
    Frustum {
        /// Its middle, metres.
        center: DVec3,
        /// Where the axis begins, metres, ≥ 0.
        radius: f64,
        /// Where the axis ends, metres, ≥ 0; 0: a cone.
        top_radius: f64,
        /// Full height, metres, ≥ 0.
        height: f64,
        /// Unit.
        axis: DVec3,
    },
    /// The convex hull of points.
    Convex {
        /// At least four, not on one plane; metres.
        points: Vec<DVec3>,
    },
    /// The body between planes: where `n · p ≤ d` for each of them.
    Polytope {
        /// `[n.x, n.y, n.z, d]`: the normal outwards, of any length but 0; with one of length 1, `d` is in metres.
        planes: Vec<[f64; 4]>,
    },
    /// What lies along a line: within half the width of it seen from above, and half the height above and below it.
    Corridor {
        /// At least two, metres.
        points: Vec<DVec3>,
        /// Full width, metres, ≥ 0.
        width: f64,
        /// Full height, metres, ≥ 0.
        height: f64,
    },
    /// A volume of a form that is given by fields ([`crate::geom::shape::form::given`]) and is no variant of its own; not checked.
    Form(Volume),
    /// What is seen through a figure in a plane, from there to infinity; only in the view that it is defined in.
    Flat {
        /// The figure's origin, metres.
        center: DVec3,
        /// Turns its axes into the world's; its z is the plane's normal.
        rotation: DQuat,
        /// In its own x, y plane.
        figure: FlatFigure,
    },
}

impl Shape {
    /// Whether it is a shape at all.
    pub fn check(&self) -> Result<(), ShapeError> {
        self.volumes_seen(&Sightlines::Along(DVec3::NEG_Z)).map(|_| ())
    }

    /// As [`Shape::volumes`], for an eye with these sight lines: a flat lens depends on them.
    pub fn volumes_seen(&self, sight: &Sightlines) -> Result<Vec<Volume>, ShapeError> {
        let Self::Flat { center, rotation, figure } = self else { return self.volumes() };
        if !(center.is_finite() && rotation.is_finite() && rotation.length() > 0.0) {
            return Err(ShapeError::NotFinite);
        }
        figure.check()?;
        Ok(vec![Volume::Flat(Flat::new(*center, rotation.normalize(), figure.clone(), *sight))])
    }

    /// Checks the shape and prepares it: the volumes whose union it is, none where it is known to hold nothing.
    pub fn volumes(&self) -> Result<Vec<Volume>, ShapeError> {
        match self {
            Self::Corridor { points, width, height } => {
                let sizes = [("width", *width), ("height", *height)];
                if let Some((name, value)) = sizes.into_iter().find(|(_, v)| !v.is_finite() || *v < 0.0) {
                    return Err(if value.is_finite() {
                        ShapeError::Negative(name, value)
                    } else {
                        ShapeError::NotFinite
                    });
                }
                corridor::bodies(points, *width, *height)
            }
            _ => self.volume().map(|volume| vec![volume]),
        }
    }

    /// Checks the shape and prepares it, if it is one volume.
    pub fn volume(&self) -> Result<Volume, ShapeError> {
        if let Some(mut given) = self.given() {
            return given.check().map(|()| given);
        }
        let finite = |ok: bool| if ok { Ok(()) } else { Err(ShapeError::NotFinite) };
        let length = |name, value: f64| if value >= 0.0 { Ok(()) } else { Err(ShapeError::Negative(name, value)) };
        match self {
            Self::Frustum { center, radius, top_radius, height, axis } => {
                let is_finite = [*radius, *top_radius, *height].iter().all(|n| n.is_finite());
                finite(center.is_finite() && is_finite && axis.is_finite())?;
                length("radius", *radius)?;
                length("top_radius", *top_radius)?;
                length("height", *height)?;
                let axis = axis.try_normalize().ok_or(ShapeError::NoAxis)?;
                Ok(Volume::Frustum(Frustum {
                    center: *center,
                    radii: [*radius, *top_radius],
                    half: 0.5 * height,
                    axis,
                }))
            }
            Self::Convex { points } => Hull::new(points).map(Volume::Convex),
            Self::Polytope { planes } => polytope::between(planes).map(Volume::Convex),
            Self::Flat { .. } => Err(ShapeError::NeedsEye),
            // All else is given by fields.
            _ => Err(ShapeError::Several),
        }
    }

    /// The volume of a form that is given by fields, not checked.
    pub fn given(&self) -> Option<Volume> {
        Some(match *self {
            Self::Sphere { center, radius } => Volume::Sphere(Sphere { center, radius }),
            Self::Box { center, size, rotation } => Volume::Box(OrientedBox { center, size, rotation }),
            Self::Cylinder { center, radius, height, axis } => {
                Volume::Cylinder(Cylinder { center, radius, height, axis })
            }
            Self::Ellipsoid { center, radii, rotation } => Volume::Ellipsoid(Ellipsoid { center, radii, rotation }),
            Self::Form(ref volume) => volume.clone(),
            _ => return None,
        })
    }

    /// The shape that is given by the fields of a volume.
    pub fn of_given(volume: Volume) -> Self {
        match volume {
            Volume::Sphere(Sphere { center, radius }) => Self::Sphere { center, radius },
            Volume::Box(OrientedBox { center, size, rotation }) => Self::Box { center, size, rotation },
            Volume::Cylinder(Cylinder { center, radius, height, axis }) => {
                Self::Cylinder { center, radius, height, axis }
            }
            Volume::Ellipsoid(Ellipsoid { center, radii, rotation }) => Self::Ellipsoid { center, radii, rotation },
            other => Self::Form(other),
        }
    }
}
