//! The picture in the window: it is looked at, moved around in, and its lenses have gizmos.

use std::{sync::Arc, time::Instant};

use eframe::egui::{
    self, Align2, Color32, ColorImage, Context, CursorIcon, Key, PointerButton, Pos2, Rect, Response, Sense,
    TextureOptions, Ui, Vec2, pos2, vec2,
};
use glam::{DVec2, DVec3};

use crate::{
    app::{
        canvas_state::{Canvas, Drag, Hovered},
        gizmo,
        render_thread::Frame,
        spots::in_rect,
        state::Window,
    },
    figure::{overlays::views::POINT_RADIUS_M, scene_file::node::Data},
    geom::Aabb,
    render::picture::ShownOverlay,
    scene::{Command, PoiPlace, above_ground},
    view::{
        Camera, View, default_near_m,
        navigate::{self, Flight},
    },
    visibility::EYE_HEIGHT_M,
};

/// Radians that a drag over a point of the window turns.
const TURN: f64 = 0.006;
/// The factor by which a point of the wheel makes distances smaller.
const ZOOM: f64 = 0.0025;
/// The turn by arrows in a second, radians; the way along with them, heights of the picture; the factor by which + makes distances smaller.
const KEY_TURN: f64 = 1.2;
const KEY_PAN: f64 = 0.6;
const KEY_ZOOM: f64 = 1.2;
/// The factor by which a double click goes nearer.
const NEARER: f64 = 0.5;
/// A brisk walk, and a ride.
const WALK_M_S: f64 = 3.0;
const FAST_WALK_M_S: f64 = 12.0;
/// The longest side of a picture, pixels: what one target takes.
const MOST_PIXELS: f32 = 4096.0;

/// The time after the last move until the eye rests, seconds.
const REST_S: f64 = 0.15;

impl Canvas {
    /// Another city is shown.
    pub fn forget(&mut self) {
        (self.drag, self.flight, self.hovered, self.outlines) = (None, None, None, None);
    }

    /// Takes a picture.
    pub fn show(&mut self, context: &Context, frame: &Frame) {
        let size = frame.view.size.map(|side| side as usize);
        if size[0] * size[1] != frame.rgba.len() || frame.rgba.is_empty() {
            return;
        }
        let image = ColorImage::from_rgba_unmultiplied(size, frame.rgba.as_flattened());
        if frame.shown.is_some() {
            // Outlines are of what it shows; a better picture of the same shows the same.
            self.outlines = None;
        }
        // A coarse picture is smoothed; one of the window's own pixels stays as it is.
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::LINEAR),
            None => self.texture = Some(context.load_texture("city", image, TextureOptions::LINEAR)),
        }
    }

    /// Width by height.
    pub fn aspect(&self) -> f64 {
        self.rect.map_or(1.6, |rect| f64::from(rect.width() / rect.height().max(1.0)))
    }

    /// Lets the eye fly.
    pub fn fly(&mut self, from: Camera, to: Camera) {
        self.flight = Some((Flight { from, to }, Instant::now()));
    }

    /// The place in the middle of the picture, metres.
    pub fn middle(&self, frame: Option<&Frame>) -> Option<DVec3> {
        let frame = frame?;
        pick(frame, frame.view.size.map(|side| f64::from(side) / 2.0).into()).map(|hovered| hovered.at)
    }

    /// The place that the pointer is on, metres.
    pub fn pointed(&self) -> Option<DVec3> {
        self.hovered.map(|hovered| hovered.at)
    }

    /// The thing under the pointer, in words.
    pub fn place_text(&self) -> Option<String> {
        let Hovered { at, .. } = self.hovered?;
        Some(format!("{:.2}  {:.2}  {:.2} m", at.x, at.y, at.z))
    }

    fn is_resting(&self) -> bool {
        self.drag.is_none()
            && self.flight.is_none()
            && self.moved_at.is_none_or(|moved| moved.elapsed().as_secs_f64() > REST_S)
    }
}

/// The thing that a picture shows at a place of it, pixels from its upper left corner; `None`: nothing, or it is not known yet.
pub fn pick(frame: &Frame, at: DVec2) -> Option<Hovered> {
    let (ids, depths) = frame.shown.as_ref()?;
    let [w, h] = frame.view.size;
    let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < f64::from(w) && at.y < f64::from(h);
    let (x, y) = (at.x as u32, at.y as u32);
    let i = inside.then(|| y as usize * w as usize + x as usize)?;
    let depth = f64::from(*depths.get(i)?);
    if !depth.is_finite() {
        return None;
    }
    if !frame.rays.is_empty() {
        let object = ids.get(i)?.checked_sub(1);
        return Some(Hovered { object, at: bent_place(frame, object, [x, y], depth) });
    }
    let ray = frame.view.pixel_ray(x, y);
    let along = ray.direction.dot(frame.view.basis.forward);
    // Metres along the view axis from the eye's plane.
    let start = frame.view.depth(ray.origin);
    let place = ray.at((depth - start) / along);
    Some(Hovered { object: ids.get(i)?.checked_sub(1), at: place })
}

/// The place of an object that a pixel shows so far away, where lenses bend rays.
fn bent_place(frame: &Frame, object: Option<u32>, pixel: [u32; 2], depth: f64) -> DVec3 {
    let view = &frame.view;
    let share = (DVec2::from(pixel.map(f64::from)) + 0.5) / DVec2::from(view.size.map(f64::from));
    let across = DVec2::new(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y) * view.half_extent();
    let place = frame.rays.acting_on(object).line(across, depth).at(depth);
    let to_world = view.basis.view_from_world().transpose();
    view.camera.eye + to_world * place
}

impl Window {
    /// Draws the picture and does what pointer and keys ask of it.
    pub(super) fn draw_canvas(&mut self, ui: &mut Ui) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "City"));
        let arrows = egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let context = ui.ctx().clone();
        let rect = if self.previews { self.figure_part(rect) } else { rect };
        self.canvas.rect = Some(rect);
        ui.painter().rect_filled(response.rect, 0.0, ui.visuals().extreme_bg_color);
        if let Some(texture) = &self.canvas.texture {
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
        }
        let text = match (&self.city, &self.canvas.texture) {
            (None, _) => self.loading.as_deref().unwrap_or("Open a city: File, Open, or drop files here."),
            (Some(_), None) => "Drawing the first picture…",
            _ => "",
        };
        if !text.is_empty() {
            ui.painter().text(
                rect.center(),
                Align2::CENTER_CENTER,
                text,
                egui::FontId::proportional(16.0),
                ui.visuals().text_color(),
            );
        }
        if self.city.is_none() {
            return;
        }
        let before = self.camera();
        self.canvas.home = self.canvas.home.or(before);
        self.move_eye(ui, &response, rect);
        if self.camera() != before {
            self.canvas.moved_at = Some(Instant::now());
        }
        self.look_up(&response, rect);
        // The figure has none of what is only held and chosen.
        if !self.previews {
            self.draw_outlines(ui, rect);
            self.draw_gizmos(ui, rect);
        }
        self.go_on_drawing(ui);
        if let Some(view) = self.view_in(rect) {
            self.show_drawing(ui, &view, rect);
        }
        let is_moving = !self.canvas.is_resting();
        if is_moving {
            context.request_repaint_after(std::time::Duration::from_millis(15));
        }
        let pixels = rect.size() * context.pixels_per_point();
        let shrink = (MOST_PIXELS / pixels.max_elem()).min(1.0);
        let size = [pixels.x, pixels.y].map(|side| (side * shrink).round().max(0.0) as u32);
        let points = rect.size();
        // A figure's pixels are its own; the window's are points, however many pixels these have.
        let meant_for = match self.previews {
            true => self.document.scene().figure.pixels(),
            false => [points.x, points.y].map(|side| side.round().max(1.0) as u32),
        };
        self.want(size, meant_for, is_moving);
    }

    /// The part of the window that has the shape of the figure.
    fn figure_part(&self, rect: Rect) -> Rect {
        let [w, h] = self.document.scene().figure.pixels().map(|side| side as f32);
        let scale = (rect.width() / w).min(rect.height() / h);
        Rect::from_center_size(rect.center(), vec2(w, h) * scale)
    }

    /// The view that the window shows now: the picture may be of the one before.
    pub(super) fn view_in(&self, rect: Rect) -> Option<View> {
        let size = [rect.width(), rect.height()].map(|side| side.round().max(1.0) as u32);
        View::new(self.camera()?, size, &Aabb::EMPTY).ok()
    }

    /// The thing at a place of the window, from the last picture that tells.
    fn pick_at(&self, rect: Rect, at: Pos2) -> Option<Hovered> {
        let frame = self.frame.as_deref()?;
        let [w, h] = frame.view.size.map(f64::from);
        let share = (at - rect.min) / rect.size();
        pick(frame, DVec2::new(f64::from(share.x) * w, f64::from(share.y) * h))
    }

    /// A place to turn around, or to come nearer to: what is shown there, else what is as far as the target.
    fn place_at(&self, rect: Rect, at: Pos2) -> Option<DVec3> {
        let camera = self.camera()?;
        // Only a picture of this very eye tells what is at a place of the window.
        let is_of_now = self.frame.as_ref().is_some_and(|frame| frame.view.camera == camera);
        if let Some(found) = self.pick_at(rect, at).filter(|_| is_of_now) {
            return Some(found.at);
        }
        let view = self.view_in(rect)?;
        let ray = view.ray(in_rect(rect, at));
        let depth = view.depth(camera.target).max(camera.near_m);
        let along = ray.direction.dot(view.basis.forward);
        Some(ray.at((depth - view.depth(ray.origin)) / along))
    }

    fn move_eye(&mut self, ui: &Ui, response: &Response, rect: Rect) {
        let Some(camera) = self.camera() else { return };
        let step = step_of(&mut self.canvas.last_step);
        if response.hovered() || response.clicked() {
            let scroll = ui.input(|input| input.smooth_scroll_delta().y + 400.0 * (input.zoom_delta() - 1.0));
            if let (true, Some(at)) = (scroll != 0.0, ui.input(|input| input.pointer.hover_pos())) {
                if self.wheel_of_ray(ui, rect, at, scroll) {
                    return;
                }
                if let Some(place) = self.place_at(rect, at) {
                    self.canvas.flight = None;
                    self.look(navigate::zoom(&camera, place, (-ZOOM * f64::from(scroll)).exp()));
                }
                return;
            }
        }
        if response.double_clicked()
            && let Some(place) = response.interact_pointer_pos().and_then(|at| self.place_at(rect, at))
        {
            let way = camera.eye - place;
            let eye = place + NEARER * way;
            let to = Camera { eye, target: place, ..navigate::zoom(&camera, place, NEARER) };
            self.canvas.fly(camera, to);
            return;
        }
        if response.drag_started() {
            self.begin_drag(ui, response, rect);
        }
        if let (Some(drag), true) = (self.canvas.drag.clone(), response.dragged()) {
            self.canvas.flight = None;
            self.go_on_dragging(ui, response, rect, drag);
        }
        if response.drag_stopped() {
            self.canvas.drag = None;
            self.canvas.moved_at = Some(Instant::now());
        }
        self.fly_on();
        self.travel(ui, response, rect, step);
    }

    fn begin_drag(&mut self, ui: &Ui, response: &Response, rect: Rect) {
        let at = ui.input(|input| input.pointer.press_origin()).or(response.interact_pointer_pos());
        let (Some(at), Some(camera)) = (at, self.camera()) else { return };
        let (modifiers, primary) =
            ui.input(|input| (input.modifiers, input.pointer.button_down(PointerButton::Primary)));
        let held = self.view_in(rect).filter(|_| primary).and_then(|view| {
            self.gizmo_at(&view, rect, at).or_else(|| {
                // The disc of a lens that is not chosen chooses it, as a click does.
                let lens = self.lens_at(&view, rect, at)?;
                if self.is_locked(self.document.scene().lenses.get(lens)?) {
                    return None;
                }
                self.chosen.lens = Some(lens);
                self.gizmo_at(&view, rect, at)
            })
        });
        if let Some(drag) = held.and_then(|gizmo| self.ray_grip(gizmo, at)) {
            self.canvas.drag = Some(drag);
            return;
        }
        if let Some(grip) = held.and_then(|gizmo| self.grip(gizmo, at)) {
            self.canvas.drag = Some(Drag::Gizmo(Box::new(grip)));
            return;
        }
        if let (true, Some((overlay, own))) = (primary, self.overlay_at(rect, at)) {
            let lens = overlay.lens as usize;
            self.chosen.lens = Some(lens);
            let is_locked = self.document.scene().lenses.get(lens).is_none_or(|lens| self.is_locked(lens));
            if !is_locked {
                self.canvas.drag = Some(Drag::Overlay { lens, off: at - own.center() });
                return;
            }
        }
        let is_plain = primary && !modifiers.command && !modifiers.shift;
        if let Some(held) = self.pick_at(rect, at).filter(|_| is_plain).and_then(|hovered| self.hold(hovered)) {
            self.canvas.drag = Some(Drag::Along(Arc::new(held)));
            return;
        }
        let place = self.place_at(rect, at).unwrap_or(camera.target);
        self.canvas.drag = Some(match (primary, modifiers) {
            (true, m) if m.command => Drag::Look,
            (true, m) if !m.shift => Drag::Orbit { pivot: place },
            _ => Drag::Pan { at: place },
        });
    }

    fn go_on_dragging(&mut self, ui: &Ui, response: &Response, rect: Rect, drag: Drag) {
        let Some(camera) = self.camera() else { return };
        let delta = response.drag_delta();
        let Some(now) = response.interact_pointer_pos() else { return };
        let turn = TURN * DVec2::new(f64::from(delta.x), f64::from(delta.y));
        match drag {
            _ if delta == Vec2::ZERO => {}
            // What is before the place goes with the pointer.
            Drag::Orbit { pivot } => self.look(navigate::orbit(&camera, pivot, DVec2::new(turn.x, -turn.y))),
            // The picture goes with the pointer.
            Drag::Look => self.look(navigate::look_around(&camera, DVec2::new(-turn.x, turn.y))),
            Drag::Pan { at } => {
                if let Some(view) = self.view_in(rect) {
                    let to = navigate::pan(&view, at, in_rect(rect, now - delta), in_rect(rect, now));
                    self.look(to);
                }
            }
            Drag::Gizmo(grip) => {
                let shift = ui.input(|input| input.modifiers.shift);
                if let Some(view) = self.view_in(rect) {
                    self.drag_grip(&grip, &view, rect, now, shift);
                }
            }
            Drag::Ray { lens, kind, off } => self.drag_ray(lens, kind, rect, now - off),
            Drag::Along(held) => {
                if let Some(view) = self.view_in(rect) {
                    self.drag_along(&held, &view, rect, now);
                }
            }
            Drag::Overlay { lens, off } => {
                let share = ((now - off) - rect.min) / rect.size();
                let [x, y] = [share.x, share.y].map(|c| c.clamp(0.0, 1.0));
                let scene = self.document.scene();
                let Some(name) = scene.lenses.get(lens).map(|lens| lens.name.clone()) else { return };
                let at = scene.overlays.iter().position(|overlay| overlay.lens == name);
                let place = Data::from([x, y].map(|share| (f64::from(share) * 1e4).round() / 1e4));
                let (path, value) = match at {
                    Some(i) => (format!("overlay.{i}.at"), place),
                    None => {
                        let table = Data::table([("lens", Data::Text(name)), ("at", place)]);
                        (format!("overlay.{}", scene.overlays.len()), table)
                    }
                };
                if let Err(error) = self.document.preview_value(&path, Some(value)) {
                    self.fail(error);
                }
            }
        }
    }

    fn fly_on(&mut self) {
        let Some((flight, started)) = self.canvas.flight else { return };
        let t = started.elapsed().as_secs_f64() / flight.duration_s().max(1e-3);
        self.put_eye(flight.at(t.min(1.0)));
        if t >= 1.0 {
            self.canvas.flight = None;
            self.canvas.moved_at = Some(Instant::now());
        }
    }

    fn travel(&mut self, ui: &Ui, response: &Response, rect: Rect, step: f64) {
        let Some(camera) = self.camera() else { return };
        if self.canvas.step_down {
            // The ground is known soon after the first picture.
            if self.city.as_ref().is_some_and(|city| city.index.get().is_some()) {
                self.canvas.step_down = false;
                self.canvas.fly(camera, self.landing(&camera));
                ui.ctx().request_repaint();
                return;
            }
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(50));
        }
        let is_asked = self.dialog.is_some() || self.asking.is_some() || self.shows_shortcuts;
        // Keys are for the picture unless something else has the focus.
        let is_elsewhere = !response.has_focus() && ui.memory(|memory| memory.focused().is_some());
        if is_asked || ui.ctx().text_edit_focused() || is_elsewhere && !response.hovered() {
            return;
        }
        let (way, fast) = ui.input(|input| {
            // With Ctrl they are something else.
            let is_down = |key| if input.modifiers.command { 0.0 } else { f64::from(u8::from(input.key_down(key))) };
            let way = DVec3::new(
                is_down(Key::D) - is_down(Key::A),
                is_down(Key::W) - is_down(Key::S),
                is_down(Key::E) - is_down(Key::Q),
            );
            (way, input.modifiers.shift)
        });
        if way == DVec3::ZERO {
            return self.turn_by_keys(ui, response, rect, step);
        }
        self.canvas.flight = None;
        if self.walks {
            let speed = if fast { FAST_WALK_M_S } else { WALK_M_S };
            let steps = DVec2::new(way.x, way.y) * speed * step.max(1e-3);
            let to = navigate::walk(&camera, steps, |at| self.ground_at(at), EYE_HEIGHT_M);
            self.look(to);
            ui.ctx().request_repaint();
            return;
        }
        let speed = (0.6 * camera.eye.distance(camera.target)).clamp(3.0, 2_000.0) * if fast { 4.0 } else { 1.0 };
        self.look(navigate::travel(&camera, way * speed * step.max(1e-3), false));
        ui.ctx().request_repaint();
    }

    /// Arrows go around what the eye looks at, with Shift along; + and - come nearer and go away.
    fn turn_by_keys(&mut self, ui: &Ui, response: &Response, rect: Rect, step: f64) {
        // Where a button has the focus, arrows go on to the next one.
        if !response.has_focus() && ui.memory(|memory| memory.focused().is_some()) {
            return;
        }
        let (turn, nearer, shift) = ui.input(|input| {
            let is_down = |key| if input.modifiers.command { 0.0 } else { f64::from(u8::from(input.key_down(key))) };
            let turn = DVec2::new(
                is_down(Key::ArrowRight) - is_down(Key::ArrowLeft),
                is_down(Key::ArrowDown) - is_down(Key::ArrowUp),
            );
            let nearer = is_down(Key::Plus) + is_down(Key::Equals) - is_down(Key::Minus);
            (turn, nearer, input.modifiers.shift)
        });
        let Some(camera) = self.camera().filter(|_| turn != DVec2::ZERO || nearer != 0.0) else { return };
        self.canvas.flight = None;
        let step = step.max(1e-3);
        if nearer != 0.0 {
            self.look(navigate::zoom(&camera, camera.target, (-KEY_ZOOM * nearer.signum() * step).exp()));
        } else if shift {
            if let Some(view) = self.view_in(rect) {
                let middle = in_rect(rect, rect.center());
                let to = middle - turn * KEY_PAN * f64::from(rect.height()) * step;
                self.look(navigate::pan(&view, camera.target, middle, to));
            }
        } else {
            self.look(navigate::orbit(&camera, camera.target, KEY_TURN * step * turn));
        }
        ui.ctx().request_repaint();
    }

    /// Finds what is under the pointer, and takes clicks.
    fn look_up(&mut self, response: &Response, rect: Rect) {
        let is_known = self.canvas.is_resting()
            && self
                .frame
                .as_ref()
                .is_some_and(|frame| frame.shown.is_some() && Some(frame.view.camera) == self.camera());
        let at = response.hover_pos().filter(|_| is_known);
        self.canvas.hovered = at.and_then(|at| self.pick_at(rect, at));
        if let Some(at) = response.hover_pos() {
            self.roll_over(response, rect, at);
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            response.request_focus();
            if let Some(drawing) = &mut self.drawing {
                drawing.points.extend(self.canvas.hovered.map(|hovered| hovered.at));
                return;
            }
            if let Some(lens) = self.view_in(rect).and_then(|view| self.lens_at(&view, rect, at)) {
                self.chosen.lens = Some(lens);
                self.is_lens_last = true;
                return;
            }
            if let Some((overlay, _)) = self.overlay_at(rect, at) {
                self.chosen.lens = Some(overlay.lens as usize);
                self.enter(&overlay);
                return;
            }
            self.chosen.object = self.pick_at(rect, at).and_then(|hovered| hovered.object);
            self.is_lens_last = false;
        }
    }

    /// Finds the lens that the pointer is on, and the action that is possible there.
    fn roll_over(&mut self, response: &Response, rect: Rect, at: Pos2) {
        let Some(view) = self.view_in(rect) else { return };
        let held = || {
            let gizmo = self.gizmo_at(&view, rect, at)?;
            Some((gizmo.lens, gizmo::cursor(&gizmo)))
        };
        let disc = || self.lens_at(&view, rect, at).map(|lens| (lens, CursorIcon::Grab));
        let overlay =
            || self.overlay_at(rect, at).map(|(overlay, _)| (overlay.lens as usize, CursorIcon::PointingHand));
        if let Some((lens, icon)) = held().or_else(disc).or_else(overlay) {
            self.rolls_over = Some(lens);
            response.ctx.set_cursor_icon(if self.canvas.drag.is_some() { CursorIcon::Grabbing } else { icon });
        } else if matches!(self.canvas.drag, Some(Drag::Along(_))) {
            response.ctx.set_cursor_icon(CursorIcon::Grabbing);
        } else if self.moves(self.canvas.hovered) {
            response.ctx.set_cursor_icon(CursorIcon::Grab);
        }
    }

    /// Goes to what an overlay shows: through a portal at once, to where the eye of a view is, to what a text or an image is about.
    fn enter(&mut self, overlay: &ShownOverlay) {
        let (index, Some(from)) = (overlay.lens as usize, self.camera()) else { return };
        if let Some(command) = Command::step_through(self.document.scene(), index, from) {
            self.canvas.flight = None;
            self.document.apply(command);
        } else if let Some(camera) = overlay.camera {
            // What a view cuts away in front of it stays in the way of a person that goes there: it is a near plane of its own.
            let near_m = default_near_m(camera.eye.distance(camera.target));
            self.canvas.fly(from, Camera { near_m, ..camera });
        } else {
            let bounds = self.about(index);
            self.frame_box(&bounds);
        }
    }

    /// Around the first point of interest of a lens, metres; empty: it has none, or none that stands in the city.
    fn about(&self, lens: usize) -> Aabb {
        let scene = self.document.scene();
        let shown = scene.lenses.get(lens).and_then(|lens| lens.best_view());
        let name = shown.and_then(|shown| shown.pois.first());
        let poi = name.and_then(|name| scene.pois.iter().find(|poi| poi.name == *name));
        match poi.map(|poi| scene.place(poi)) {
            Some(PoiPlace::Object(id)) => self.city.as_ref().map_or(Aabb::EMPTY, |city| {
                city.model.find_object(&id).map_or(Aabb::EMPTY, |object| self.bounds_of(city, object))
            }),
            Some(PoiPlace::At(at)) => Aabb::around(at, DVec3::splat(POINT_RADIUS_M)),
            Some(PoiPlace::AboveGround(at)) => above_ground::above(at, &self.ground())
                .map_or(Aabb::EMPTY, |at| Aabb::around(at, DVec3::splat(POINT_RADIUS_M))),
            _ => Aabb::EMPTY,
        }
    }

    /// The overlay at a place of the window, and where it is: of several the last, which lies in front.
    fn overlay_at(&self, rect: Rect, at: Pos2) -> Option<(ShownOverlay, Rect)> {
        let frame = self.frame.as_deref()?;
        let scale = rect.size() / vec2(frame.view.size[0] as f32, frame.view.size[1] as f32);
        let place = |own: &ShownOverlay| {
            let ([x, y], [w, h]) = (own.at.map(|c| c as f32), own.size.map(|c| c as f32));
            (*own, Rect::from_min_size(rect.min + vec2(x, y) * scale, vec2(w, h) * scale))
        };
        frame.overlays.iter().rev().map(place).find(|(_, own)| own.contains(at))
    }
}

/// The time that passed since the last call, seconds; not more than a tenth.
pub(super) fn step_of(last: &mut Option<Instant>) -> f64 {
    let now = Instant::now();
    let step = last.map_or(0.0, |last| (now - last).as_secs_f64());
    *last = Some(now);
    step.min(0.1)
}
