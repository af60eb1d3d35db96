//! Heights above the ground: what a scene gives so becomes heights of the model once its city is known.
//!
//! ```text
//!   scene file: at = [x, y, 1.7], above_ground = true
//!        │ kept so: read, written, edited
//!        └─ Scene::on_ground, before a picture ─> at = [x, y, ground(x, y) + 1.7], above_ground = false ─> all that draws, picks and counts
//! ```

use std::borrow::Cow;

use glam::{DVec2, DVec3};

use crate::{
    geom::Shape,
    lens::{
        Lens, Placement, Region,
        best_view::{Depiction, LocalView},
        deform::Step,
    },
    scene::{
        check::SceneProblem,
        model::{PoiPlace, Scene},
        trajectory::{Pace, Trajectory},
    },
    view::{Camera, default_near_m},
    visibility::Test,
};

/// The height of the ground at a place in plan, metres; `None`: there is none.
pub type Ground<'a> = &'a dyn Fn(DVec2) -> Option<f64>;

/// Ways that follow the ground have a point at least every so many metres, ...
const STEP_M: f64 = 4.0;
/// ... but no more than about so many.
const MOST_POINTS: f64 = 4_000.0;

/// There is no ground at a place.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the city has no ground at ({}, {}): neither terrain, roads, water or land, nor a plain ground (`ground` of [city])", .0.x, .0.y)]
pub struct NoGround(pub DVec2);

impl Scene {
    /// Whether it gives heights above the ground.
    pub fn has_heights_above_ground(&self) -> bool {
        self.camera.is_some() && self.camera_above_ground
            || self.trajectories.iter().any(|way| way.above_ground)
            || self.pois.iter().any(|poi| matches!(poi.place, PoiPlace::AboveGround(_)))
            || self.lenses.iter().any(is_above_ground)
    }

    /// The scene with heights of the model in place of those above the ground. A way follows the ground between its points.
    ///
    /// # Errors
    /// Where there is no ground.
    pub fn on_ground(&self, ground: Ground) -> Result<Cow<'_, Self>, SceneProblem> {
        if !self.has_heights_above_ground() {
            return Ok(Cow::Borrowed(self));
        }
        let at = |table: String| {
            move |NoGround(at): NoGround| SceneProblem {
                table,
                key: "above_ground".into(),
                message: NoGround(at).to_string(),
                is_error: true,
            }
        };
        let mut scene = self.clone();
        if let Some(camera) = scene.camera.as_mut().filter(|_| self.camera_above_ground) {
            *camera = raised(camera, ground).map_err(at("camera".into()))?;
        }
        scene.camera_above_ground = false;
        for (i, way) in scene.trajectories.iter_mut().enumerate().filter(|(_, way)| way.above_ground) {
            *way = following(way, ground).map_err(at(format!("trajectory.{i}")))?;
        }
        for (i, poi) in scene.pois.iter_mut().enumerate() {
            if let PoiPlace::AboveGround(place) = poi.place {
                poi.place = PoiPlace::At(above(place, ground).map_err(at(format!("poi.{i}")))?);
            }
        }
        for (i, lens) in scene.lenses.iter_mut().enumerate().filter(|(_, lens)| is_above_ground(lens)) {
            put_on_ground(lens, ground).map_err(at(format!("lens.{i}")))?;
        }
        Ok(Cow::Owned(scene))
    }
}

/// Whether a lens gives heights above the ground: of its shapes, or of the eye of its view.
fn is_above_ground(lens: &Lens) -> bool {
    let view = lens.kind.best_view().and_then(|shown| shown.view());
    lens.placement == Placement::AboveGround || matches!(view, Some(LocalView::Camera { above_ground: true, .. }))
}

fn put_on_ground(lens: &mut Lens, ground: Ground) -> Result<(), NoGround> {
    if let Some(shown) = lens.kind.best_view_mut()
        && let Depiction::View(LocalView::Camera { camera, above_ground }) = &mut shown.depiction
        && std::mem::take(above_ground)
    {
        *camera = raised(camera, ground)?;
    }
    if lens.placement != Placement::AboveGround {
        return Ok(());
    }
    lens.placement = Placement::World;
    let mut missing = None;
    heights_of_lens(lens, &mut |at, height| match ground(at) {
        Some(ground) => *height += ground,
        None => missing = missing.or(Some(NoGround(at))),
    });
    if let Some(missing) = missing {
        return Err(missing);
    }
    if let Some(own) = lens.sprite.as_mut().and_then(|sprite| sprite.own.as_mut()) {
        own.camera = raised(&own.camera, ground)?;
    }
    Ok(())
}

/// A place that is given above the ground, metres.
pub fn above(place: DVec3, ground: Ground) -> Result<DVec3, NoGround> {
    let plan = place.truncate();
    Ok(place.with_z(place.z + ground(plan).ok_or(NoGround(plan))?))
}

/// A camera of which eye and target are given above the ground.
pub fn raised(camera: &Camera, ground: Ground) -> Result<Camera, NoGround> {
    moved(camera, above(camera.eye, ground)?, above(camera.target, ground)?)
}

/// The same the other way: [`raised`] gives the camera back.
pub fn lowered(camera: &Camera, ground: Ground) -> Result<Camera, NoGround> {
    let down = |at: DVec2| ground(at).map(|height| -height);
    raised(camera, &down)
}

/// A near plane that is the default one of its distance stays so.
fn moved(camera: &Camera, eye: DVec3, target: DVec3) -> Result<Camera, NoGround> {
    let is_default = camera.near_m == default_near_m(camera.eye.distance(camera.target));
    let near_m = if is_default { default_near_m(eye.distance(target)) } else { camera.near_m };
    Ok(Camera { eye, target, near_m, ..*camera })
}

/// Raises the places of a shape, and of those that it is combined of, by the ground below each.
pub fn raise(region: &mut Region, ground: Ground) -> Result<(), NoGround> {
    let mut missing = None;
    heights(region, &mut |at, height| match ground(at) {
        Some(ground) => *height += ground,
        None => missing = missing.or(Some(NoGround(at))),
    });
    missing.map_or(Ok(()), Err)
}

/// The same the other way: [`raise`] gives the shape back.
pub fn lower(region: &mut Region, ground: Ground) -> Result<(), NoGround> {
    raise(region, &|at| ground(at).map(|height| -height))
}

/// Visits the heights of a lens that are those of the ground where it says so: of its shapes, and of the ways of its detection tests. Whether
/// it has any.
pub fn heights_of_lens(lens: &mut Lens, visit: &mut dyn FnMut(DVec2, &mut f64)) -> bool {
    let mut has_any = false;
    for shape in &mut lens.shapes {
        has_any |= heights(shape, visit);
    }
    let mut each = |place: &mut DVec3| visit(place.truncate(), &mut place.z);
    for step in lens.kind.deform_mut().into_iter().flat_map(|deform| &mut deform.steps) {
        if let Step::Lower { of, .. } = step {
            has_any |= heights_of_test(&mut of.test, &mut each);
        }
    }
    has_any
}

/// Visits the heights in a region, each with the place in plan that it is at; whether it, or a part of it, has any.
pub fn heights(region: &mut Region, visit: &mut dyn FnMut(DVec2, &mut f64)) -> bool {
    let mut each = |place: &mut DVec3| visit(place.truncate(), &mut place.z);
    match region {
        Region::Shape(shape) => return heights_of(shape, &mut each),
        Region::Mesh { at, .. } => each(at),
        Region::Own { center, .. } => each(center),
        Region::Mask3d { corner, size, .. } => visit(corner.truncate() + 0.5 * size.truncate(), &mut corner.z),
        Region::Mask { corner, size, base, .. } => visit(*corner + 0.5 * *size, base),
        Region::Prism { points, base, .. } => {
            visit(points.iter().sum::<DVec2>() / points.len().max(1) as f64, base);
        }
        Region::Enclosed { parts, .. } | Region::Combined { parts, .. } => {
            return parts.iter_mut().fold(false, |any, part| heights(part, visit) | any);
        }
        Region::Occluders(own) | Region::Case { of: own, .. } => return heights_of_test(&mut own.test, &mut each),
        Region::Sprite { .. } | Region::Magnified { .. } | Region::Objects(_) | Region::Thematic(_) => return false,
    }
    true
}

fn heights_of(shape: &mut Shape, each: &mut dyn FnMut(&mut DVec3)) -> bool {
    match shape {
        Shape::Sphere { center, .. }
        | Shape::Box { center, .. }
        | Shape::Cylinder { center, .. }
        | Shape::Ellipsoid { center, .. }
        | Shape::Frustum { center, .. }
        | Shape::Flat { center, .. } => each(center),
        Shape::Convex { points } | Shape::Corridor { points, .. } => points.iter_mut().for_each(each),
        Shape::Polytope { .. } | Shape::Form(_) => return false,
    }
    true
}

/// The ways of a detection test.
fn heights_of_test(test: &mut Test, each: &mut dyn FnMut(&mut DVec3)) -> bool {
    match test {
        Test::Route { points } => {
            points.iter_mut().for_each(each);
            true
        }
        Test::Any(parts) | Test::All(parts) => {
            parts.iter_mut().fold(false, |any, part| heights_of_test(part, each) | any)
        }
        Test::Not(part) => heights_of_test(part, each),
        _ => false,
    }
}

/// A way whose heights are above the ground, as one through more points that follows it. What has a speed goes at it up and down, too.
fn following(way: &Trajectory, ground: Ground) -> Result<Trajectory, NoGround> {
    let line = way.line();
    let step = STEP_M.max(line.length() / MOST_POINTS);
    let (mut marks, mut times): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let given = if let Pace::Times(times) = &way.pace { &times[..] } else { &[] };
    let mut add = |mark: f64, time: Option<f64>| {
        marks.push(mark);
        times.extend(time);
    };
    for (i, ends) in line.marks().windows(2).enumerate() {
        let pieces = ((ends[1] - ends[0]) / step).ceil().max(1.0);
        add(ends[0], given.get(i).copied());
        for k in 1..pieces as u32 {
            let mark = ends[0] + (ends[1] - ends[0]) * f64::from(k) / pieces;
            add(mark, given.get(i..i + 2).map(|span| way.gone_at(mark, [span[0], span[1]])));
        }
    }
    // Of a closed way the last mark is the first point again.
    let last = line.marks().len() - 1;
    let (end, end_time) = (line.length(), given.get(last).copied());
    add(end, end_time);
    if way.form.is_closed {
        marks.pop();
    }
    let points: Result<Vec<DVec3>, NoGround> = marks.iter().map(|mark| above(line.at(*mark), ground)).collect();
    let pace = if given.is_empty() { way.pace.clone() } else { Pace::Times(times) };
    Ok(Trajectory { points: points?, pace, above_ground: false, ..way.clone() })
}

#[cfg(test)]
mod tests;
