//! Lens volumes (L3) as numbers: what is inside, where a ray enters and leaves, how far the border is.
//!
//! One rule for borders, everywhere: a body is closed (its border belongs to it), and along a ray its interval is
//! `entry ≤ t < exit` (L4). A ray that only touches (a tangent, a corner) has `entry = exit`: it misses. A ray that
//! runs within a face is inside it. A body without volume (radius 0, an edge 0) holds nothing.

mod corridor;
pub mod flat;
mod hull;
mod mesh;
mod placed;
mod polytope;
pub mod solid;

use glam::{DQuat, DVec2, DVec3};

pub use flat::{Flat, FlatFigure, Sightlines};
pub use hull::Hull;
pub use mesh::Mesh;
pub use placed::Motion;
pub use solid::{PlacedSolid, Solid};

use crate::geom::{Aabb, Ray};

/// A volume (L3), in model coordinates.
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
    #[error("a polygon may have at most {max} points, has {0}", max = flat::MAX_CORNERS)]
    ManyCorners(usize),
    /// What a flat lens holds depends on the eye, [`Shape::volumes_seen`].
    #[error(
        "a flat lens holds what an eye sees through it: it cannot be asked without one, nor be part of another shape"
    )]
    NeedsEye,
    /// The shape is the union of several volumes, [`Shape::volumes`].
    #[error("a corridor is several volumes")]
    Several,
    /// More points than a lens needs.
    #[error("a shape may have at most {max} points, has {0}", max = hull::MAX_POINTS)]
    ManyPoints(usize),
    /// More planes than a lens needs.
    #[error("a polytope may have at most {max} planes, has {0}", max = polytope::MAX_PLANES)]
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
    #[error("{}", solid::words_for(.0))]
    Ring(crate::geom::triangulate::Refusal),
    /// Layers of a 3D mask differ in size.
    #[error("layer {0} has {1:?} pixels, the first has {2:?}: all layers need the same size")]
    Layers(usize, [u32; 2], [u32; 2]),
    /// A mask without a single pixel.
    #[error("the mask is empty: a pixel belongs to it where it is opaque and at least as bright as mid grey")]
    EmptyMask,
    /// More faces than a lens needs.
    #[error("a solid may have at most {max} triangles, has {0}", max = solid::MAX_FACES)]
    ManyFaces(usize),
    /// Faces that enclose nothing.
    #[error("the faces enclose no volume")]
    NoBody,
    /// All points lie on one plane (or line).
    #[error("all {0} points lie on one plane: the hull has no volume; move one of them off it")]
    Flat(usize),
}

/// A checked shape with what its tests need worked out once.
#[derive(Clone, Debug, PartialEq)]
pub enum Volume {
    /// A ball.
    Sphere {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
    },
    /// A box: half edges, and the rotation that turns its axes into the world's.
    Box {
        /// Its middle, metres.
        center: DVec3,
        /// Half the edges or the height, metres.
        half: DVec3,
        /// Turns the box's axes into the world's.
        rotation: DQuat,
    },
    /// A cylinder: half height, unit axis.
    Cylinder {
        /// Its middle, metres.
        center: DVec3,
        /// Metres, ≥ 0.
        radius: f64,
        /// Half the edges or the height, metres.
        half: f64,
        /// Unit.
        axis: DVec3,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Its middle, metres.
        center: DVec3,
        /// Half its extent along its axes, metres.
        radii: DVec3,
        /// Turns its axes into the world's.
        rotation: DQuat,
    },
    /// A cone, cut or not: half height, unit axis.
    Frustum {
        /// Its middle, metres.
        center: DVec3,
        /// Where the axis begins, and where it ends, metres, ≥ 0.
        radii: [f64; 2],
        /// Half the height, metres.
        half: f64,
        /// Unit.
        axis: DVec3,
    },
    /// A convex polytope.
    Convex(Hull),
    /// A solid of any form.
    Solid(PlacedSolid),
    /// What an eye sees through a figure.
    Flat(Flat),
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
        let finite = |ok: bool| if ok { Ok(()) } else { Err(ShapeError::NotFinite) };
        let length = |name, value: f64| if value >= 0.0 { Ok(()) } else { Err(ShapeError::Negative(name, value)) };
        match self {
            Self::Sphere { center, radius } => {
                finite(center.is_finite() && radius.is_finite())?;
                length("radius", *radius)?;
                Ok(Volume::Sphere { center: *center, radius: *radius })
            }
            Self::Box { center, size, rotation } => {
                finite(center.is_finite() && size.is_finite() && rotation.is_finite() && rotation.length() > 0.0)?;
                length("size", size.min_element())?;
                Ok(Volume::Box { center: *center, half: 0.5 * *size, rotation: rotation.normalize() })
            }
            Self::Cylinder { center, radius, height, axis } => {
                finite(center.is_finite() && radius.is_finite() && height.is_finite() && axis.is_finite())?;
                length("radius", *radius)?;
                length("height", *height)?;
                let axis = axis.try_normalize().ok_or(ShapeError::NoAxis)?;
                Ok(Volume::Cylinder { center: *center, radius: *radius, half: 0.5 * height, axis })
            }
            Self::Ellipsoid { center, radii, rotation } => {
                finite(center.is_finite() && radii.is_finite() && rotation.is_finite() && rotation.length() > 0.0)?;
                length("radii", radii.min_element())?;
                Ok(Volume::Ellipsoid { center: *center, radii: *radii, rotation: rotation.normalize() })
            }
            Self::Frustum { center, radius, top_radius, height, axis } => {
                let is_finite = [*radius, *top_radius, *height].iter().all(|n| n.is_finite());
                finite(center.is_finite() && is_finite && axis.is_finite())?;
                length("radius", *radius)?;
                length("top_radius", *top_radius)?;
                length("height", *height)?;
                let axis = axis.try_normalize().ok_or(ShapeError::NoAxis)?;
                Ok(Volume::Frustum { center: *center, radii: [*radius, *top_radius], half: 0.5 * height, axis })
            }
            Self::Convex { points } => Hull::new(points).map(Volume::Convex),
            Self::Polytope { planes } => polytope::between(planes).map(Volume::Convex),
            Self::Corridor { .. } => Err(ShapeError::Several),
            Self::Flat { .. } => Err(ShapeError::NeedsEye),
        }
    }
}

impl Volume {
    /// Whether it has no volume: it holds no point and no ray meets it (hard case 21).
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Sphere { radius, .. } => *radius <= 0.0,
            Self::Box { half, .. } => half.min_element() <= 0.0,
            Self::Cylinder { radius, half, .. } => radius.min(*half) <= 0.0,
            Self::Ellipsoid { radii, .. } => radii.min_element() <= 0.0,
            Self::Frustum { radii, half, .. } => radii[0].max(radii[1]).min(*half) <= 0.0,
            Self::Convex(_) | Self::Solid(_) => false,
            Self::Flat(flat) => flat.is_empty(),
        }
    }

    /// Whether it is convex: all but solids and flat lenses.
    pub fn is_convex(&self) -> bool {
        !matches!(self, Self::Solid(_) | Self::Flat(_))
    }

    /// Whether it has an end on all sides.
    pub fn is_bounded(&self) -> bool {
        !matches!(self, Self::Flat(_))
    }

    /// Whether the closed body holds `p`.
    pub fn contains(&self, p: DVec3) -> bool {
        match self {
            Self::Solid(placed) => placed.solid.winding(placed.local(p)) != 0,
            Self::Flat(flat) => flat.contains(p),
            _ => self.signed_distance(p) <= 0.0 && !self.is_empty(),
        }
    }

    /// Where the line of `ray` enters and leaves: inside for `entry ≤ t < exit`; of a solid, which it may leave and enter again
    /// in between, the first and the last crossing ([`Solid::crossings`] has all of them). Both may be negative (behind the
    /// origin). `None`: it misses. A ray without direction is everywhere inside or misses. A flat lens knows only the sight
    /// lines of its own eye, and their exit is infinite.
    pub fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        if self.is_empty() {
            return None;
        }
        let (entry, exit) = match self {
            Self::Sphere { center, radius } => round(ray.origin - *center, ray.direction, *radius)?,
            Self::Box { center, half, rotation } => {
                let back = rotation.conjugate();
                let (o, d) = (back * (ray.origin - *center), back * ray.direction);
                (0..3).try_fold(EVERYWHERE, |all, axis| Some(both(all, slab(o[axis], d[axis], half[axis])?)))?
            }
            Self::Cylinder { center, radius, half, axis } => {
                let (o, d) = (ray.origin - *center, ray.direction);
                let (along_o, along_d) = (o.dot(*axis), d.dot(*axis));
                let side = round(o - along_o * *axis, across(d, *axis), *radius)?;
                both(side, slab(along_o, along_d, *half)?)
            }
            Self::Ellipsoid { center, radii, rotation } => {
                // A ball in its own measure.
                let back = rotation.conjugate();
                round(back * (ray.origin - *center) / *radii, back * ray.direction / *radii, 1.0)?
            }
            Self::Frustum { center, radii, half, axis } => {
                let (o, d) = (ray.origin - *center, ray.direction);
                let (along_o, along_d) = (o.dot(*axis), d.dot(*axis));
                let ends = slab(along_o, along_d, *half)?;
                let slope = (radii[1] - radii[0]) / (2.0 * half);
                let middle = 0.5 * (radii[0] + radii[1]);
                let (o, d) = ((o - along_o * *axis, along_o), (across(d, *axis), along_d));
                both(ends, cone(o, d, middle, slope, ends)?)
            }
            Self::Convex(hull) => hull.entry_exit(ray)?,
            Self::Solid(placed) => {
                let crossings = placed.solid.crossings(&placed.local_ray(ray));
                let ends = (f64::INFINITY, f64::NEG_INFINITY);
                crossings.iter().fold(ends, |(low, high), c| (low.min(c.t), high.max(c.t)))
            }
            Self::Flat(flat) => flat.entry_exit(ray)?,
        };
        (entry < exit).then_some((entry, exit))
    }

    /// Exact Euclidean distance to the border, metres, negative inside.
    pub fn signed_distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Sphere { center, radius } => p.distance(*center) - radius,
            Self::Box { center, half, rotation } => {
                let q = (rotation.conjugate() * (p - *center)).abs() - *half;
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Cylinder { center, radius, half, axis } => {
                let v = p - *center;
                let along = v.dot(*axis);
                let q = DVec2::new((v - along * *axis).length() - radius, along.abs() - half);
                q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Ellipsoid { center, radii, rotation } => {
                distance_of_ellipsoid(rotation.conjugate() * (p - *center), *radii)
            }
            Self::Frustum { center, radii, half, axis } => {
                let v = p - *center;
                let along = v.dot(*axis);
                distance_of_frustum(DVec2::new((v - along * *axis).length(), along), *radii, *half)
            }
            Self::Convex(hull) => hull.signed_distance(p),
            Self::Solid(placed) => {
                let local = placed.local(p);
                let distance = placed.solid.distance(local);
                if placed.solid.winding(local) != 0 { -distance } else { distance }
            }
            Self::Flat(flat) => flat.signed_distance(p),
        }
    }

    /// The smallest axis-aligned box around it; one around everything for a flat lens, which has no end.
    pub fn bounds(&self) -> Aabb {
        let around = |center: DVec3, half: DVec3| Aabb { min: center - half, max: center + half };
        match self {
            Self::Sphere { center, radius } => around(*center, DVec3::splat(*radius)),
            Self::Box { center, half, rotation } => {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| *rotation * a);
                around(*center, (0..3).map(|i| half[i] * axes[i].abs()).sum())
            }
            Self::Cylinder { center, radius, half, axis } => {
                // A disc of normal n reaches r·√(1 − nᵢ²) along axis i.
                let disc = (DVec3::ONE - *axis * *axis).max(DVec3::ZERO).map(f64::sqrt);
                around(*center, *half * axis.abs() + *radius * disc)
            }
            Self::Ellipsoid { center, radii, rotation } => {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| *rotation * a);
                let squares: DVec3 = (0..3).map(|i| (radii[i] * axes[i]) * (radii[i] * axes[i])).sum();
                around(*center, squares.map(f64::sqrt))
            }
            Self::Frustum { center, radii, half, axis } => {
                let disc = (DVec3::ONE - *axis * *axis).max(DVec3::ZERO).map(f64::sqrt);
                around(*center - *half * *axis, radii[0] * disc).union(around(*center + *half * *axis, radii[1] * disc))
            }
            Self::Convex(hull) => hull.bounds(),
            Self::Solid(placed) => Aabb::from_points(placed.solid.bounds().corners().map(|c| placed.world(c))),
            Self::Flat(_) => around(DVec3::ZERO, DVec3::splat(flat::ENDLESS_M)),
        }
    }
}

/// The interval of a ray that is inside wherever it is.
const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// What two intervals share (empty: entry > exit).
fn both(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.max(b.0), a.1.min(b.1))
}

/// Where `|o + t·d| ≤ half`. A ray parallel to the slab is inside it everywhere (its faces too) or nowhere.
fn slab(o: f64, d: f64, half: f64) -> Option<(f64, f64)> {
    if d == 0.0 {
        return (o.abs() <= half).then_some(EVERYWHERE);
    }
    let (a, b) = ((-half - o) / d, (half - o) / d);
    Some((a.min(b), a.max(b)))
}

/// `d` without its part along the unit `axis`; exactly zero where only rounding is left of it.
fn across(d: DVec3, axis: DVec3) -> DVec3 {
    let rest = d - d.dot(axis) * axis;
    if rest.length_squared() <= 1e-28 * d.length_squared() { DVec3::ZERO } else { rest }
}

/// Where `|o + t·d| ≤ radius`, for spheres and, with o and d across its axis, cylinders.
///
/// The discriminant is taken from the point of the ray nearest the centre: b² − ac of the textbook loses all digits
/// for a far eye (Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems I, ch. 7).
fn round(o: DVec3, d: DVec3, radius: f64) -> Option<(f64, f64)> {
    let a = d.length_squared();
    if a == 0.0 {
        return (o.length() <= radius).then_some(EVERYWHERE);
    }
    let middle = -o.dot(d) / a;
    let nearest = (o + middle * d).length();
    // (r − q)(r + q) keeps the sign of r − q where r² − q² rounds to nothing.
    let left = (radius - nearest) * (radius + nearest);
    (left > 0.0).then(|| {
        let half = (left / a).sqrt();
        (middle - half, middle + half)
    })
}

/// Where `|o + t·d| ≤ middle + slope·(z_o + t·z_d)` between two ends within which the right side is ≥ 0: o and d across
/// the axis, and along it.
///
/// The quadratic is set up around the point of the line nearest the middle, as for [`round`].
fn cone(o: (DVec3, f64), d: (DVec3, f64), middle: f64, slope: f64, ends: (f64, f64)) -> Option<(f64, f64)> {
    let all = d.0.length_squared() + d.1 * d.1;
    let start = if all > 0.0 { -(o.0.dot(d.0) + o.1 * d.1) / all } else { 0.0 };
    let (near, z) = (o.0 + start * d.0, o.1 + start * d.1);
    let (radius, growth) = (middle + slope * z, slope * d.1);
    // a t² + 2 b t + c ≤ 0
    let a = (d.0.length() - growth.abs()) * (d.0.length() + growth.abs());
    let b = near.dot(d.0) - radius * growth;
    let c = (near.length() - radius.abs()) * (near.length() + radius.abs());
    let ends = (ends.0 - start, ends.1 - start);
    let moved = |(entry, exit): (f64, f64)| Some((entry + start, exit + start));
    let left = b * b - a * c;
    if a > 0.0 {
        // It crosses one of the two cones that meet in the tip, and is inside between.
        if left <= 0.0 {
            return None;
        }
        let q = -(b + left.sqrt().copysign(b));
        let (s, t) = (q / a, if q == 0.0 { 0.0 } else { c / q });
        return moved((s.min(t), s.max(t)));
    }
    // Steeper than the side: in one cone up to a point, in the other from a point on.
    if left < 0.0 || (a == 0.0 && b == 0.0) {
        return if c <= 0.0 { moved(ends) } else { None };
    }
    let q = -(b + left.sqrt().copysign(b));
    let roots = [if a == 0.0 { f64::NAN } else { q / a }, if q == 0.0 { 0.0 } else { c / q }];
    // Between the ends the one whose radius is not negative.
    let is_right = |t: f64| !t.is_nan() && radius + growth * t >= -1e-12 * (radius.abs() + (growth * t).abs());
    let border = roots.into_iter().filter(|t| is_right(*t));
    let border = if growth > 0.0 { border.fold(f64::NAN, f64::max) } else { border.fold(f64::NAN, f64::min) };
    match border {
        t if t.is_nan() => None,
        t if growth > 0.0 => moved((t, f64::INFINITY)),
        t => moved((f64::NEG_INFINITY, t)),
    }
}

/// From a point in the ellipsoid's own axes to its border, negative inside.
///
/// The nearest point is x with xᵢ = eᵢ² yᵢ / (t + eᵢ²), t the largest root of Σ (eᵢ yᵢ / (t + eᵢ²))² = 1 (Eberly, *Distance
/// from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*). t is counted from −min eᵢ², where the points that have
/// several nearest ones find it.
fn distance_of_ellipsoid(p: DVec3, radii: DVec3) -> f64 {
    if radii.min_element() <= 0.0 {
        // A disc, a line or a point: a ball around what it is in holds it.
        return (p.abs() - radii).max(DVec3::ZERO).length();
    }
    let y = p.abs().max(1e-30 * radii);
    let least = radii.min_element() * radii.min_element();
    let above = radii * radii - least;
    let (mut low, mut high) = (0.0, (radii * y).length());
    for _ in 0..220 {
        let s = 0.5 * (low + high);
        if s <= low || s >= high {
            break;
        }
        if (radii * y / (s + above)).length_squared() > 1.0 { low = s } else { high = s }
    }
    let nearest = radii * radii * y / (high + above);
    let distance = (y - nearest).length();
    if (p / radii).length_squared() <= 1.0 { -distance } else { distance }
}

/// From a point (away from the axis, along it) to the border of a cone with its tip cut off, negative inside.
fn distance_of_frustum(p: DVec2, [bottom, top]: [f64; 2], half: f64) -> f64 {
    let corners = [DVec2::new(bottom, -half), DVec2::new(top, half)];
    let side = corners[1] - corners[0];
    // To the right of the side, seen from the first corner, is outside.
    let beyond_side = (p - corners[0]).perp_dot(side) / side.length();
    let inside = beyond_side.max(p.y.abs() - half);
    if inside <= 0.0 {
        return inside;
    }
    let to_segment = |a: DVec2, b: DVec2| {
        let along = b - a;
        let t = if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        (p - a - t * along).length()
    };
    let caps = corners.map(|c| to_segment(DVec2::new(0.0, c.y), c));
    caps[0].min(caps[1]).min(to_segment(corners[0], corners[1]))
}

#[cfg(test)]
mod tests;
