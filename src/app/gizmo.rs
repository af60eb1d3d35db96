//! Gizmos of lenses in the picture: discs, rings and squares of constant size in points, and what dragging them does.

pub mod places;

use std::borrow::Cow;

use eframe::egui::{Align2, Color32, CursorIcon, Painter, Pos2, Rect, Shape, Stroke, Ui, Vec2, vec2};
use glam::{DVec2, DVec3};

use crate::{
    app::{
        canvas_state::{Gizmo, Grip},
        gizmo::places::GizmoKind,
        lens_list::State,
        spots::{in_rect, spot_of},
        state::Window,
        theme::{caption, color_of},
    },
    geom::Aabb,
    lens::{Lens, Placement, Region},
    scene::{
        above_ground,
        anchor::{anchor, object_of},
    },
    view::View,
};

/// Half the size of the disc, points.
const DISC: f32 = 7.0;
/// Half the size of a gizmo at a side or a corner, points.
const SQUARE: f32 = 4.5;
/// Within so many points of a gizmo it is meant.
const REACH: f32 = 11.0;
/// Gizmos that are nearer to each other than this are not all shown: the first of them is.
const APART: f32 = 16.0;
/// The distance of the turning gizmo beyond the end of the shape, points.
const BEYOND: f32 = 26.0;
/// Where that is outside the picture: how far from the middle, points.
const NEAR: f32 = 60.0;

impl Window {
    /// The origin of a lens' coordinates; `None`: it is fixed to the eye, or to what the city does not have.
    fn origin_of(&self, lens: &Lens) -> Option<DVec3> {
        if matches!(lens.placement, Placement::World | Placement::AboveGround) {
            return Some(DVec3::ZERO);
        }
        let (city, scene) = (self.city.as_ref()?, self.document.scene());
        let origin = anchor(&lens.placement, scene, &city.model).ok().flatten()?;
        let object = object_of(&lens.placement, scene).and_then(|id| city.model.find_object(&id));
        let pose = object.and_then(|object| city.model.pose_of(object, scene.shown_moment()));
        Some(pose.map_or(origin, |pose| pose.place(origin)))
    }

    /// A shape of a lens in coordinates of its origin: as it is, or with its heights above the ground as those of the model.
    fn standing<'r>(&self, lens: &Lens, region: &'r Region) -> Cow<'r, Region> {
        let mut raised = Cow::Borrowed(region);
        if lens.placement == Placement::AboveGround && above_ground::raise(raised.to_mut(), &self.ground()).is_err() {
            return Cow::Borrowed(region);
        }
        raised
    }

    /// The height of the ground at a place in plan, both counted from an origin.
    fn ground_from(&self, origin: DVec3) -> impl Fn(DVec2) -> Option<f64> {
        move |plan| self.ground_at(plan + origin.truncate()).map(|z| z - origin.z)
    }

    /// The middles of a lens' shapes and, of the chosen one, all that can be held, the first before what it would cover.
    fn gizmos_of(&self, index: usize, view: &View, rect: Rect) -> Vec<Gizmo> {
        let Some(lens) = self.document.scene().lenses.get(index) else { return Vec::new() };
        let is_held = self.chosen.lens == Some(index) && !self.is_locked(lens);
        if let Some(ray) = lens.ray() {
            return self.ray_gizmos(index, ray, rect, is_held);
        }
        let Some(origin) = self.origin_of(lens) else { return Vec::new() };
        let ground = self.ground_from(origin);
        let mut shown: Vec<Gizmo> = Vec::new();
        for (shape, region) in lens.shapes.iter().enumerate().filter_map(|(i, own)| Some((i, own.own_shape()?))) {
            let gizmo = |kind, place, at| Gizmo { lens: index, shape, kind, place, at };
            let region = &*self.standing(lens, region);
            let Some(middle) = places::middle(region, &ground).map(|middle| middle + origin) else { continue };
            let Some(middle_at) = spot_of(view, rect, middle) else { continue };
            let disc = gizmo(GizmoKind::Middle, middle, middle_at);
            if !is_held {
                shown.push(disc);
                continue;
            }
            for (kind, place) in places::gizmos(region, &ground) {
                let place = place + origin;
                let at = match kind {
                    GizmoKind::Ring => {
                        ring_at(view, rect, middle, middle_at, places::radius(region).unwrap_or_default())
                    }
                    GizmoKind::Turn => spot_of(view, rect, place).map(|end| turn_at(rect, middle_at, end)),
                    _ => spot_of(view, rect, place),
                };
                let Some(at) = at.filter(|at| rect.contains(*at)) else { continue };
                if shown.iter().all(|other| other.at.distance(at) >= APART) || kind == GizmoKind::Middle {
                    shown.push(gizmo(kind, place, at));
                }
            }
        }
        shown
    }

    /// The gizmo of the chosen lens at a place of the window.
    pub(super) fn gizmo_at(&self, view: &View, rect: Rect, at: Pos2) -> Option<Gizmo> {
        let index = self
            .chosen
            .lens
            .filter(|index| self.document.scene().lenses.get(*index).is_some_and(|lens| !self.is_locked(lens)))?;
        nearest(&self.gizmos_of(index, view, rect), at)
    }

    /// The lens whose disc is at a place: those in front first; of lenses that are off only the chosen one's is shown.
    pub(super) fn lens_at(&self, view: &View, rect: Rect, at: Pos2) -> Option<usize> {
        let is_shown = |index: &usize| self.chosen.lens == Some(*index) || self.state_of(*index) != State::Disabled;
        let is_there = |index: &usize| {
            let all = self.gizmos_of(*index, view, rect);
            all.iter().any(|gizmo| gizmo.kind == GizmoKind::Middle && gizmo.at.distance(at) <= REACH)
        };
        (0..self.document.scene().lenses.len()).rev().filter(is_shown).find(is_there)
    }

    /// Begins to drag a gizmo that was pressed there.
    pub(super) fn grip(&self, gizmo: Gizmo, pressed: Pos2) -> Option<Grip> {
        let lens = self.document.scene().lenses.get(gizmo.lens)?;
        let before = self.standing(lens, lens.shapes.get(gizmo.shape)?.own_shape()?).into_owned();
        let middle = places::middle(&before, &|_| None)? + self.origin_of(lens)?;
        // What is turned is so about where its middle is on the ground.
        let middle = middle.with_z(gizmo.place.z);
        Some(Grip { gizmo, off: pressed - gizmo.at, before, middle })
    }

    /// Shows what the lens becomes when the pointer is there; with Shift: up and down instead of along the ground, or as a whole.
    pub(super) fn drag_grip(&mut self, grip: &Grip, view: &View, rect: Rect, now: Pos2, shift: bool) {
        let Gizmo { lens: index, shape, kind, place, at: pressed } = grip.gizmo;
        let Some(lens) = self.document.scene().lenses.get(index) else { return };
        let Some(origin) = self.origin_of(lens) else { return };
        let (now, mut after) = (now - grip.off, grip.before.clone());
        let verb = match kind {
            GizmoKind::Middle => {
                let Some(to) = dragged_to(view, rect, now, place, shift) else { return };
                let mut by = to - place;
                if let (Placement::AboveGround, false) = (&lens.placement, shift) {
                    // Along the ground, up and down with it.
                    let ground = self.ground();
                    by.z += ground(to.truncate()).zip(ground(place.truncate())).map_or(0.0, |(to, from)| to - from);
                }
                places::move_by(&mut after, by);
                "move"
            }
            GizmoKind::Ring => {
                let Some(middle) = spot_of(view, rect, place) else { return };
                let metres = view.pixel_m(view.depth(place)) * f64::from(middle.distance(now));
                places::set_radius(&mut after, metres);
                "resize"
            }
            GizmoKind::Side { axis, is_up } => {
                let Some(block) = places::block(&grip.before) else { return };
                let axis_up = block.axis(axis);
                let out = if is_up { axis_up } else { -axis_up };
                let Some(along) = along_line(view, rect, now, block.center + origin, out) else { return };
                places::set_side(&mut after, axis, is_up, along, shift);
                "resize"
            }
            GizmoKind::Corner(corner) => {
                let Some(to) = dragged_to(view, rect, now, place, shift) else { return };
                places::set_corner(&mut after, corner, to - origin);
                "reshape"
            }
            GizmoKind::Turn => {
                let seen = |at| dragged_to(view, rect, at, grip.middle, false).map(|to| (to - grip.middle).truncate());
                let (Some(from), Some(to)) = (seen(pressed), seen(now)) else { return };
                let angle = from.angle_to(to);
                if !angle.is_finite() {
                    return;
                }
                // With Shift by steps, as one turns a thing on a drawing.
                let step = if shift { 15_f64 } else { 0.1 }.to_radians();
                places::turn_by(&mut after, (angle / step).round() * step);
                "turn"
            }
        };
        if lens.placement == Placement::AboveGround && above_ground::lower(&mut after, &self.ground()).is_err() {
            return;
        }
        let name = format!("{verb} {}", lens.name);
        let mut scene = self.document.scene().clone();
        let own = scene.lenses.get_mut(index).and_then(|lens| lens.shapes.get_mut(shape));
        if let Some(own) = own.and_then(Region::own_shape_mut) {
            *own = after;
            self.document.preview(name, scene);
        }
    }

    /// A box around what the chosen lens has of its own, model coordinates.
    pub(super) fn chosen_lens_box(&self) -> Aabb {
        let lens = self.chosen.lens.and_then(|index| self.document.scene().lenses.get(index));
        let Some((lens, origin)) = lens.and_then(|lens| Some((lens, self.origin_of(lens)?))) else {
            return Aabb::EMPTY;
        };
        let shapes = lens.shapes.iter().filter_map(Region::own_shape);
        let all = shapes.map(|shape| places::extent(&self.standing(lens, shape)));
        let all = all.fold(Aabb::EMPTY, Aabb::union);
        if all.is_empty() { all } else { Aabb { min: all.min + origin, max: all.max + origin } }
    }

    fn draw_wires(&self, painter: &Painter, lens: &Lens, view: &View, rect: Rect, color: Color32) {
        let Some(origin) = self.origin_of(lens) else { return };
        let ground = self.ground_from(origin);
        let shapes = lens.shapes.iter().filter_map(Region::own_shape);
        for wire in shapes.flat_map(|region| places::wires(&self.standing(lens, region), &ground)) {
            for ends in wire.windows(2) {
                if let (Some(a), Some(b)) =
                    (spot_of(view, rect, ends[0] + origin), spot_of(view, rect, ends[1] + origin))
                {
                    painter.line_segment([a, b], Stroke::new(1.0, color.gamma_multiply(0.7)));
                }
            }
        }
    }

    pub(super) fn draw_gizmos(&self, ui: &Ui, rect: Rect) {
        let Some(view) = self.view_in(rect) else { return };
        let painter = ui.painter_at(rect);
        for (index, lens) in self.document.scene().lenses.iter().enumerate() {
            let state = self.state_of(index);
            // One that is off shows where it is only while it is chosen.
            if state == State::Disabled && self.chosen.lens != Some(index) {
                continue;
            }
            let color = if state == State::Disabled { Color32::from_gray(128) } else { color_of(lens.color) };
            let all = self.gizmos_of(index, &view, rect);
            let disc = if state == State::Normal { 0.6 * DISC } else { DISC };
            if self.chosen.lens == Some(index) && !self.is_locked(lens) {
                self.draw_wires(&painter, lens, &view, rect, color);
            }
            let mut middle = None;
            for gizmo in all.iter().rev() {
                draw_gizmo(&painter, gizmo, disc, color, &all);
                if gizmo.kind == GizmoKind::Middle {
                    middle = Some(gizmo.at);
                }
            }
            if let Some(middle) = middle.filter(|_| state != State::Normal) {
                caption(&painter, middle - vec2(0.0, disc + 4.0), Align2::CENTER_BOTTOM, &lens.name, 13.0);
            }
        }
    }
}

/// The pointer over a gizmo.
pub(super) fn cursor(gizmo: &Gizmo) -> CursorIcon {
    match gizmo.kind {
        GizmoKind::Middle | GizmoKind::Corner(_) => CursorIcon::Grab,
        GizmoKind::Turn => CursorIcon::Alias,
        GizmoKind::Ring => CursorIcon::ResizeHorizontal,
        GizmoKind::Side { axis: 2, .. } => CursorIcon::ResizeVertical,
        GizmoKind::Side { .. } => CursorIcon::Move,
    }
}

/// The nearest of the gizmos that are near enough, the disc before what is as near.
fn nearest(all: &[Gizmo], at: Pos2) -> Option<Gizmo> {
    let near = all.iter().filter(|gizmo| gizmo.at.distance(at) <= REACH);
    near.min_by(|a, b| a.at.distance(at).total_cmp(&b.at.distance(at))).copied()
}

fn draw_gizmo(painter: &Painter, gizmo: &Gizmo, disc: f32, color: Color32, all: &[Gizmo]) {
    let middle = all.iter().find(|other| other.kind == GizmoKind::Middle && other.shape == gizmo.shape);
    let spoke = || {
        if let Some(middle) = middle {
            painter.line_segment([middle.at, gizmo.at], Stroke::new(1.5, Color32::from_white_alpha(200)));
        }
    };
    match gizmo.kind {
        GizmoKind::Middle => _ = painter.circle(gizmo.at, disc, color, Stroke::new(2.0, Color32::WHITE)),
        GizmoKind::Ring => {
            spoke();
            painter.circle(gizmo.at, 0.8 * DISC, Color32::WHITE, Stroke::new(2.5, color));
        }
        GizmoKind::Side { .. } | GizmoKind::Corner(_) => {
            let square = Rect::from_center_size(gizmo.at, Vec2::splat(2.0 * SQUARE));
            let round = if matches!(gizmo.kind, GizmoKind::Corner(_)) { SQUARE } else { 1.5 };
            painter.rect_filled(square.expand(1.5), round + 1.5, color);
            painter.rect_filled(square.shrink(0.5), round, Color32::WHITE);
        }
        GizmoKind::Turn => {
            spoke();
            painter.circle(gizmo.at, DISC + 1.0, Color32::WHITE, Stroke::new(1.5, color));
            // Three quarters of a circle, and its arrow.
            let on = |angle: f32, radius: f32| gizmo.at + radius * vec2(angle.cos(), angle.sin());
            let arc = (0..=12).map(|i| on(0.5 + 0.4 * i as f32, 4.2)).collect();
            painter.add(Shape::line(arc, Stroke::new(1.6, color)));
            let end = 0.5 + 0.4 * 12.0;
            let tip = [on(end, 1.4), on(end, 7.0), on(end + 0.75, 4.4)];
            painter.add(Shape::convex_polygon(tip.to_vec(), color, Stroke::NONE));
        }
    }
}

/// Where the ring of a shape is: right of its middle, else on a side where it is in the picture.
fn ring_at(view: &View, rect: Rect, middle: DVec3, at: Pos2, radius: f64) -> Option<Pos2> {
    let reach = (radius / view.pixel_m(view.depth(middle))) as f32;
    let sides = [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)];
    let inner = rect.shrink(DISC);
    sides.into_iter().map(|side| at + reach * side).find(|spot| inner.contains(*spot))
}

/// Where the gizmo that turns a shape is: beyond its end, as seen from its middle.
fn turn_at(rect: Rect, middle: Pos2, end: Pos2) -> Pos2 {
    let way = end - middle;
    let out = if way.length() > 1.0 { way.normalized() } else { vec2(0.0, 1.0) };
    let beyond = end + BEYOND * out;
    if rect.shrink(DISC).contains(beyond) { beyond } else { middle + NEAR * out }
}

/// Where a place goes that is dragged to a place of the window: along the ground, or up and down.
fn dragged_to(view: &View, rect: Rect, at: Pos2, from: DVec3, is_vertical: bool) -> Option<DVec3> {
    let ray = view.ray(in_rect(rect, at));
    if is_vertical {
        // In the upright plane that faces the eye.
        let normal = view.basis.forward.with_z(0.0).try_normalize()?;
        let along = ray.direction.dot(normal);
        let t = (along.abs() > 1e-6).then(|| (from - ray.origin).dot(normal) / along)?;
        return Some(from.with_z(ray.at(t).z));
    }
    let t = (ray.direction.z.abs() > 1e-4).then(|| (from.z - ray.origin.z) / ray.direction.z)?;
    let to = ray.at(t);
    // Beyond the horizon there is no ground, and next to it too much.
    (t > 0.0 && to.distance(from) < 20.0 * view.camera.eye.distance(from).max(1.0)).then_some(to)
}

/// The distance along a line, from a place on it in a unit direction, at which the line is nearest to what the pointer is on.
fn along_line(view: &View, rect: Rect, at: Pos2, from: DVec3, way: DVec3) -> Option<f64> {
    let ray = view.ray(in_rect(rect, at));
    let sight = ray.direction.try_normalize()?;
    let (between, slope) = (from - ray.origin, sight.dot(way));
    // Seen nearly along the line every pixel is far.
    let flat = 1.0 - slope * slope;
    let along = (flat > 1e-3).then(|| (slope * sight.dot(between) - way.dot(between)) / flat)?;
    (along.abs() < 20.0 * view.camera.eye.distance(from).max(1.0)).then_some(along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Camera;

    fn view() -> (View, Rect) {
        let camera = Camera::looking(DVec3::new(30.0, -80.0, 60.0), DVec3::new(0.0, 0.0, 5.0), 0.8);
        let rect = Rect::from_min_size(Pos2::new(40.0, 20.0), vec2(640.0, 480.0));
        (View::new(camera, [640, 480], &Aabb::EMPTY).unwrap(), rect)
    }

    #[test]
    fn what_is_dragged_is_under_the_pointer() {
        let (view, rect) = view();
        let from = DVec3::new(3.0, -4.0, 2.0);
        for to in [DVec3::new(10.0, 8.0, 2.0), DVec3::new(-20.0, 3.5, 2.0)] {
            let at = spot_of(&view, rect, to).unwrap();
            let along_ground = dragged_to(&view, rect, at, from, false).unwrap();
            // Places of a window are f32: a few ten-thousandths of a point.
            assert!(along_ground.distance(to) < 1e-3, "{along_ground} {to}");
        }
        let up = DVec3::new(3.0, -4.0, 17.0);
        let at = spot_of(&view, rect, up).unwrap();
        assert!(dragged_to(&view, rect, at, from, true).unwrap().distance(up) < 1e-3);
        for way in [DVec3::X, DVec3::Z, DVec3::new(0.6, 0.8, 0.0)] {
            let at = spot_of(&view, rect, from + 7.25 * way).unwrap();
            let along = along_line(&view, rect, at, from, way).unwrap();
            assert!((along - 7.25).abs() < 1e-3, "{way}: {along}");
        }
        let sight = view.basis.forward;
        let ahead = view.camera.eye + 9.0 * sight;
        let at = spot_of(&view, rect, ahead).unwrap();
        assert_eq!(along_line(&view, rect, at, ahead, sight), None, "seen along the line");
    }

    #[test]
    fn rings_and_turning_knobs_stay_in_the_picture() {
        let (view, rect) = view();
        let middle = DVec3::new(0.0, 0.0, 5.0);
        let at = spot_of(&view, rect, middle).unwrap();
        let small = ring_at(&view, rect, middle, at, 5.0).unwrap();
        assert!(small.x > at.x && small.y == at.y);
        let metres = view.pixel_m(view.depth(middle)) * f64::from(small.distance(at));
        assert!((metres - 5.0).abs() < 1e-3);
        assert_eq!(ring_at(&view, rect, middle, at, 500.0), None, "larger than all that is seen");
        // Beyond its end; where that is outside, near its middle.
        let end = at + vec2(100.0, 0.0);
        assert_eq!(turn_at(rect, at, end), end + vec2(BEYOND, 0.0));
        assert_eq!(turn_at(rect, at, at + vec2(0.0, 5e3)), at + vec2(0.0, NEAR));
    }
}
