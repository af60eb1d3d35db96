//! Gizmos of a lens' shape: their places, and the shape that results when one is put elsewhere.
//!
//! All places and lengths are metres, in the coordinates of the shape.

use glam::{DQuat, DVec2, DVec3};

use crate::{
    geom::{
        Aabb,
        shape::{definition::Shape, flat::FlatFigure},
    },
    lens::Region,
};

/// Shapes with more corners than this are held by their middle only: gizmos would cover them.
pub const MOST_CORNERS: usize = 64;
/// The least size that dragging leaves.
pub const LEAST_M: f64 = 0.1;

/// The part of a shape that a gizmo holds, and so what dragging it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GizmoKind {
    /// Its middle: moves it.
    Middle,
    /// A place as far from its middle as its radius.
    Ring,
    /// A side of it, on one of its own axes.
    Side {
        /// Which axis, 0 to 2.
        axis: usize,
        /// On its positive half.
        is_up: bool,
    },
    /// One of its points.
    Corner(usize),
    /// Turns it about the vertical through its middle.
    Turn,
}

/// The block that the sides of a shape bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its middle.
    pub center: DVec3,
    /// Half its extent along its own axes.
    pub half: DVec3,
    /// Turns its own axes into those of the coordinates.
    pub turn: DQuat,
    /// Which of its own axes have sides that can be held.
    pub has: [bool; 3],
    /// The middle stays where a side is moved, so that the opposite one moves, too.
    is_centered: bool,
}

impl Block {
    /// The direction of one of its axes, unit.
    pub fn axis(&self, axis: usize) -> DVec3 {
        self.turn * DVec3::AXES[axis]
    }

    /// The middle of a side.
    pub fn side(&self, axis: usize, is_up: bool) -> DVec3 {
        let out = if is_up { self.half[axis] } else { -self.half[axis] };
        self.center + out * self.axis(axis)
    }

    /// With a side so far out from the middle, along its axis; evenly: larger or smaller as a whole, about its middle.
    fn with_side(&self, axis: usize, is_up: bool, out: f64, is_even: bool) -> Self {
        let (before, mut to) = (self.half[axis], *self);
        if is_even {
            to.half *= out.max(LEAST_M) / before.max(LEAST_M);
        } else if self.is_centered {
            to.half[axis] = out.max(LEAST_M);
        } else {
            let half = (0.5 * (out + before)).max(0.5 * LEAST_M);
            let away = if is_up { half - before } else { before - half };
            to.center += away * self.axis(axis);
            to.half[axis] = half;
        }
        to
    }
}

/// All that can be held of a shape, with where it is; `ground`: the height of what is seen there in plan, for shapes that
/// have no height of their own there. A ring is where its middle is: which way it is seen from decides on which side of that.
pub fn gizmos(region: &Region, ground: &dyn Fn(DVec2) -> Option<f64>) -> Vec<(GizmoKind, DVec3)> {
    let Some(middle) = middle(region, ground) else { return Vec::new() };
    let mut all = vec![(GizmoKind::Middle, middle)];
    all.extend(radius(region).map(|_| (GizmoKind::Ring, middle)));
    if let Some(block) = block(region) {
        for axis in (0..3).filter(|axis| block.has[*axis]) {
            all.extend([true, false].map(|is_up| (GizmoKind::Side { axis, is_up }, block.side(axis, is_up))));
        }
    }
    let corners = corners(region, ground);
    if corners.len() <= MOST_CORNERS {
        all.extend(corners.into_iter().enumerate().map(|(i, at)| (GizmoKind::Corner(i), at)));
    }
    all.extend(heading(region).map(|ahead| (GizmoKind::Turn, middle + ahead)));
    all
}

/// The middle of a shape; `None`: it has none that could be moved.
pub fn middle(region: &Region, ground: &dyn Fn(DVec2) -> Option<f64>) -> Option<DVec3> {
    let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    Some(match region {
        Region::Shape(
            Shape::Sphere { center, .. }
            | Shape::Box { center, .. }
            | Shape::Cylinder { center, .. }
            | Shape::Ellipsoid { center, .. }
            | Shape::Frustum { center, .. }
            | Shape::Flat { center, .. },
        ) => *center,
        Region::Shape(Shape::Convex { points } | Shape::Corridor { points, .. }) => mean(points),
        Region::Mesh { at, .. } => *at,
        Region::Prism { points, base, height, .. } => {
            let plan = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
            within(plan, [*base, base + height], ground)
        }
        Region::Mask { corner, size, base, height, .. } => within(corner + 0.5 * size, [*base, base + height], ground),
        Region::Mask3d { corner, size, .. } => corner + 0.5 * size,
        Region::Combined { parts, .. } | Region::Enclosed { parts, .. } => {
            let all: Option<Vec<DVec3>> = parts.iter().map(|part| self::middle(part, ground)).collect();
            mean(&all.filter(|all| !all.is_empty())?)
        }
        _ => return None,
    })
}

/// A place in plan, at the height of what is seen there as far as that is within the shape, else half way up.
fn within(plan: DVec2, [low, high]: [f64; 2], ground: &dyn Fn(DVec2) -> Option<f64>) -> DVec3 {
    plan.extend(ground(plan).map_or(0.5 * (low + high), |z| z.clamp(low, high.max(low))))
}

/// The distance of the ring from the middle.
pub fn radius(region: &Region) -> Option<f64> {
    match region {
        Region::Shape(
            Shape::Sphere { radius, .. }
            | Shape::Cylinder { radius, .. }
            | Shape::Frustum { radius, .. }
            | Shape::Flat { figure: FlatFigure::Disc { radius }, .. },
        ) => Some(*radius),
        _ => None,
    }
}

/// The block that its sides bound.
pub fn block(region: &Region) -> Option<Block> {
    let upright = |axis: DVec3| DQuat::from_rotation_arc(DVec3::Z, axis.normalize_or(DVec3::Z));
    let block = |center, half, turn, has| Block { center, half, turn, has, is_centered: false };
    let along_z = [false, false, true];
    Some(match region {
        Region::Shape(Shape::Box { center, size, rotation }) => block(*center, 0.5 * *size, *rotation, [true; 3]),
        Region::Shape(Shape::Ellipsoid { center, radii, rotation }) => {
            Block { is_centered: true, ..block(*center, *radii, *rotation, [true; 3]) }
        }
        Region::Shape(
            Shape::Cylinder { center, radius, height, axis } | Shape::Frustum { center, radius, height, axis, .. },
        ) => block(*center, DVec3::new(*radius, *radius, 0.5 * height), upright(*axis), along_z),
        Region::Shape(Shape::Flat { center, rotation, figure: FlatFigure::Rectangle { size } }) => {
            Block { is_centered: true, ..block(*center, 0.5 * size.extend(0.0), *rotation, [true, true, false]) }
        }
        Region::Shape(Shape::Corridor { points, width, height }) => {
            let [a, b] = points.first_chunk::<2>()?;
            let along = (b - a).truncate().try_normalize().unwrap_or(DVec2::X);
            let turn = DQuat::from_rotation_z((-along.x).atan2(along.y));
            let half = DVec3::new(0.5 * width, 0.0, 0.5 * height);
            Block { is_centered: true, ..block(0.5 * (a + b), half, turn, [true, false, true]) }
        }
        Region::Prism { points, base, height, .. } => {
            let plan = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
            block(plan.extend(base + 0.5 * height), DVec3::new(0.0, 0.0, 0.5 * height), DQuat::IDENTITY, along_z)
        }
        Region::Mask { corner, size, base, height, .. } => {
            let size = size.extend(*height);
            block(corner.extend(*base) + 0.5 * size, 0.5 * size, DQuat::IDENTITY, [true; 3])
        }
        Region::Mask3d { corner, size, .. } => block(corner + 0.5 * size, 0.5 * *size, DQuat::IDENTITY, [true; 3]),
        _ => return None,
    })
}

/// Its points.
fn corners(region: &Region, ground: &dyn Fn(DVec2) -> Option<f64>) -> Vec<DVec3> {
    match region {
        Region::Shape(Shape::Convex { points } | Shape::Corridor { points, .. }) => points.clone(),
        Region::Shape(Shape::Flat { center, rotation, figure: FlatFigure::Polygon { points } }) => {
            points.iter().map(|p| center + *rotation * p.extend(0.0)).collect()
        }
        Region::Prism { points, base, height, .. } => {
            points.iter().map(|p| within(*p, [*base, base + height], ground)).collect()
        }
        _ => Vec::new(),
    }
}

/// Lines that show what its gizmos are of: the edges of a block, the line or ring through its points.
pub fn wires(region: &Region, ground: &dyn Fn(DVec2) -> Option<f64>) -> Vec<Vec<DVec3>> {
    let closed = |mut ring: Vec<DVec3>| {
        ring.extend(ring.first().copied());
        ring
    };
    match region {
        Region::Shape(Shape::Box { .. }) | Region::Mask { .. } | Region::Mask3d { .. } => {
            let Some(block) = block(region) else { return Vec::new() };
            let corner = |[x, y, z]: [f64; 3]| block.center + block.turn * (DVec3::new(x, y, z) * block.half);
            let around = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let ring = |z: f64| closed(around.map(|[x, y]| corner([x, y, z])).to_vec());
            let posts = around.map(|[x, y]| vec![corner([x, y, -1.0]), corner([x, y, 1.0])]);
            [ring(-1.0), ring(1.0)].into_iter().chain(posts).collect()
        }
        Region::Shape(Shape::Corridor { points, .. }) => vec![points.clone()],
        Region::Prism { .. } | Region::Shape(Shape::Flat { figure: FlatFigure::Polygon { .. }, .. }) => {
            vec![closed(corners(region, ground))]
        }
        _ => Vec::new(),
    }
}

/// From its middle to what shows how it is turned, level; `None`: nothing of it can be turned, or that could not be seen.
fn heading(region: &Region) -> Option<DVec3> {
    let nowhere = |_| None;
    let ahead = match region {
        Region::Shape(
            Shape::Box { rotation, .. }
            | Shape::Ellipsoid { rotation, .. }
            | Shape::Flat { rotation, figure: FlatFigure::Rectangle { .. }, .. },
        ) => {
            // Its x, as far as that is level.
            let level = (*rotation * DVec3::X).with_z(0.0);
            block(region)?.half.x * level.try_normalize()?
        }
        Region::Mesh { rotation, scale, .. } => scale * (*rotation * DVec3::X).with_z(0.0).try_normalize()?,
        _ => *corners(region, &nowhere).first()? - middle(region, &nowhere)?,
    };
    let level = ahead.with_z(0.0);
    (level.length() > 1e-6).then_some(level)
}

/// Moves it.
pub fn move_by(region: &mut Region, by: DVec3) {
    match region {
        Region::Shape(
            Shape::Sphere { center, .. }
            | Shape::Box { center, .. }
            | Shape::Cylinder { center, .. }
            | Shape::Ellipsoid { center, .. }
            | Shape::Frustum { center, .. }
            | Shape::Flat { center, .. },
        ) => *center = to_mm(*center + by),
        Region::Shape(Shape::Convex { points } | Shape::Corridor { points, .. }) => {
            points.iter_mut().for_each(|p| *p = to_mm(*p + by));
        }
        Region::Mesh { at, .. } => *at = to_mm(*at + by),
        Region::Prism { points, holes, base, .. } => {
            let plan = points.iter_mut().chain(holes.iter_mut().flatten());
            plan.for_each(|p| *p = to_mm((*p + by.truncate()).extend(0.0)).truncate());
            *base = round_mm(*base + by.z);
        }
        Region::Mask { corner, base, .. } => {
            *corner = to_mm((*corner + by.truncate()).extend(0.0)).truncate();
            *base = round_mm(*base + by.z);
        }
        Region::Mask3d { corner, .. } => *corner = to_mm(*corner + by),
        Region::Combined { parts, .. } | Region::Enclosed { parts, .. } => {
            parts.iter_mut().for_each(|part| move_by(part, by));
        }
        _ => {}
    }
}

/// Puts its ring so far from its middle; what else there is of a cone's radii keeps its share.
pub fn set_radius(region: &mut Region, to: f64) {
    let to = round_mm(to.max(LEAST_M));
    match region {
        Region::Shape(
            Shape::Sphere { radius, .. }
            | Shape::Cylinder { radius, .. }
            | Shape::Flat { figure: FlatFigure::Disc { radius }, .. },
        ) => *radius = to,
        Region::Shape(Shape::Frustum { radius, top_radius, .. }) => {
            if *radius > 0.0 {
                *top_radius = round_mm(*top_radius * to / *radius);
            }
            *radius = to;
        }
        _ => {}
    }
}

/// Puts a side so far from its middle, along its axis; evenly: makes it larger or smaller as a whole.
pub fn set_side(region: &mut Region, axis: usize, is_up: bool, out: f64, is_even: bool) {
    let Some(before) = block(region) else { return };
    let to = before.with_side(axis, is_up, out, is_even);
    let (at, size) = (to_mm(to.center), to_mm(2.0 * to.half));
    match region {
        Region::Shape(Shape::Box { center, size: own, .. }) => (*center, *own) = (at, size),
        Region::Shape(Shape::Ellipsoid { radii, .. }) => *radii = to_mm(to.half),
        Region::Shape(Shape::Cylinder { center, radius, height, .. }) => {
            (*center, *radius, *height) = (at, round_mm(to.half.x), size.z);
        }
        Region::Shape(Shape::Frustum { center, height, radius, top_radius, .. }) => {
            let share = if *radius > 0.0 { to.half.x / *radius } else { 1.0 };
            (*center, *radius, *top_radius) = (at, round_mm(to.half.x), round_mm(share * *top_radius));
            *height = size.z;
        }
        Region::Shape(Shape::Flat { figure: FlatFigure::Rectangle { size: own }, .. }) => *own = size.truncate(),
        Region::Shape(Shape::Corridor { width, height, .. }) => (*width, *height) = (size.x, size.z),
        Region::Prism { base, height, .. } => (*base, *height) = (round_mm(to.center.z - to.half.z), size.z),
        Region::Mask { corner, size: own, base, height, .. } => {
            let low = to_mm(to.center - to.half);
            (*corner, *own, *base, *height) = (low.truncate(), size.truncate(), low.z, size.z);
        }
        Region::Mask3d { corner, size: own, .. } => (*corner, *own) = (to_mm(to.center - to.half), size),
        _ => {}
    }
}

/// Puts one of its points elsewhere; of one that has points in plan only there.
pub fn set_corner(region: &mut Region, index: usize, to: DVec3) {
    match region {
        Region::Shape(Shape::Convex { points } | Shape::Corridor { points, .. }) => {
            points.iter_mut().skip(index).take(1).for_each(|p| *p = to_mm(to));
        }
        Region::Shape(Shape::Flat { center, rotation, figure: FlatFigure::Polygon { points } }) => {
            let own = rotation.inverse() * (to - *center);
            points.iter_mut().skip(index).take(1).for_each(|p| *p = to_mm(own).truncate());
        }
        Region::Prism { points, .. } => {
            points.iter_mut().skip(index).take(1).for_each(|p| *p = to_mm(to).truncate());
        }
        _ => {}
    }
}

/// Turns it about the vertical through its middle, radians counter-clockwise as seen from above.
pub fn turn_by(region: &mut Region, angle: f64) {
    let turn = DQuat::from_rotation_z(angle);
    let Some(about) = middle(region, &|_| None) else { return };
    match region {
        Region::Shape(
            Shape::Box { rotation, .. } | Shape::Ellipsoid { rotation, .. } | Shape::Flat { rotation, .. },
        )
        | Region::Mesh { rotation, .. } => *rotation = turn * *rotation,
        Region::Shape(Shape::Convex { points } | Shape::Corridor { points, .. }) => {
            points.iter_mut().for_each(|p| *p = to_mm(about + turn * (*p - about)));
        }
        Region::Prism { points, holes, .. } => {
            let turned = |p: DVec2| to_mm(about + turn * (p.extend(about.z) - about)).truncate();
            points.iter_mut().chain(holes.iter_mut().flatten()).for_each(|p| *p = turned(*p));
        }
        _ => {}
    }
}

/// A box around it, as far as it has places of its own; empty: it has none.
pub fn extent(region: &Region) -> Aabb {
    let Some(middle) = middle(region, &|_| None) else { return Aabb::EMPTY };
    let mut bounds = Aabb { min: middle, max: middle };
    let mut reach = |at: DVec3, by: f64| bounds = bounds.union(Aabb { min: at - by, max: at + by });
    reach(middle, radius(region).unwrap_or(0.0));
    if let Some(block) = block(region) {
        for axis in (0..3).filter(|axis| block.has[*axis]) {
            [true, false].into_iter().for_each(|is_up| reach(block.side(axis, is_up), 0.0));
        }
    }
    corners(region, &|_| None).into_iter().for_each(|at| reach(at, 0.0));
    if let Region::Combined { parts, .. } | Region::Enclosed { parts, .. } = region {
        bounds = parts.iter().map(extent).fold(bounds, |all, part| all.union(part));
    }
    bounds
}

/// A place rounded to millimetres, so that files stay readable.
fn to_mm(at: DVec3) -> DVec3 {
    DVec3::from(at.to_array().map(round_mm))
}

fn round_mm(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}

#[cfg(test)]
mod tests;
