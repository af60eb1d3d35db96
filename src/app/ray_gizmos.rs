//! Lenses that bend rays in the picture: they are held by their middle and their rim, and the wheel magnifies.

use eframe::egui::{Pos2, Rect, Ui, Vec2};
use glam::DVec3;

use crate::{
    app::{
        canvas_state::{Drag, Gizmo},
        gizmo::places::GizmoKind,
        state::Window,
    },
    figure::scene_file::node::Data,
    lens::ray::{Bend, Feature, RayLens, RayOutline, SamplingRate},
};

/// How much a point of the wheel magnifies, and how much wider it makes a border.
const BY_WHEEL: f64 = 0.004;
const BORDER_BY_WHEEL: f64 = 0.001;
/// The least and the most that the wheel makes of a magnification and of a fisheye's angle, degrees.
const MAGNIFICATIONS: [f64; 2] = [0.2, 100.0];
const ANGLES_DEG: [f64; 2] = [10.0, 360.0];

/// Where the middle of a lens is in the window, and from there to its rim.
fn place_of(ray: &RayLens, rect: Rect) -> (Pos2, f32) {
    let [x, y] = ray.center.to_array().map(|share| share as f32);
    (rect.min + Vec2::new(x, y) * rect.size(), ray.radius as f32 * rect.height())
}

fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

impl Window {
    /// What can be held of a lens that bends rays: its middle, and of the chosen one its rim.
    pub(super) fn ray_gizmos(&self, index: usize, ray: &RayLens, rect: Rect, is_held: bool) -> Vec<Gizmo> {
        if matches!(ray.bend, Bend::Feature(_)) {
            // It stands where its feature is.
            return Vec::new();
        }
        let (middle, radius) = place_of(ray, rect);
        let gizmo = |kind, at| Gizmo { lens: index, shape: 0, kind, place: DVec3::ZERO, at };
        let mut all = vec![gizmo(GizmoKind::Middle, middle)];
        let sides = [Vec2::new(1.0, 0.0), Vec2::new(-1.0, 0.0), Vec2::new(0.0, 1.0), Vec2::new(0.0, -1.0)];
        let rim = sides.into_iter().map(|side| middle + radius * side).find(|at| rect.shrink(4.0).contains(*at));
        all.extend(rim.filter(|_| is_held).map(|at| gizmo(GizmoKind::Ring, at)));
        all
    }

    /// The drag of a gizmo of a lens that bends rays.
    pub(super) fn ray_grip(&self, gizmo: Gizmo, pressed: Pos2) -> Option<Drag> {
        self.document.scene().lenses.get(gizmo.lens)?.ray()?;
        Some(Drag::Ray { lens: gizmo.lens, kind: gizmo.kind, off: pressed - gizmo.at })
    }

    /// Shows what the lens becomes when the pointer is there.
    pub(super) fn drag_ray(&mut self, lens: usize, kind: GizmoKind, rect: Rect, now: Pos2) {
        let Some(ray) = self.document.scene().lenses.get(lens).and_then(|lens| lens.ray()) else { return };
        let (middle, _) = place_of(ray, rect);
        let (key, value) = match kind {
            GizmoKind::Ring => {
                let from = now - middle;
                let reach = match ray.outline {
                    RayOutline::Circle => from.length(),
                    RayOutline::Square => from.abs().max_elem(),
                };
                ("radius", Data::from(rounded(f64::from(reach / rect.height()).clamp(0.005, 4.0))))
            }
            _ => {
                let share = (now - rect.min) / rect.size();
                ("center", Data::from([share.x, share.y].map(|c| rounded(f64::from(c.clamp(0.0, 1.0))))))
            }
        };
        self.preview_ray(lens, key, value);
    }

    fn preview_ray(&mut self, lens: usize, key: &str, value: Data) {
        if let Err(error) = self.document.preview_value(&format!("lens.{lens}.ray.{key}"), Some(value)) {
            self.fail(error);
        }
    }

    /// The wheel over the chosen lens: it magnifies more or less, with Alt its border becomes wider or narrower. Whether it did something.
    pub(super) fn wheel_of_ray(&mut self, ui: &Ui, rect: Rect, at: Pos2, scroll: f32) -> bool {
        let Some(index) = self.chosen.lens else { return false };
        let Some(lens) = self.document.scene().lenses.get(index).filter(|lens| !self.is_locked(lens)) else {
            return false;
        };
        let Some(ray) = lens.ray() else { return false };
        let (middle, radius) = place_of(ray, rect);
        if at.distance(middle) > radius && !matches!(ray.bend, Bend::Feature(_)) {
            return false;
        }
        let is_alt = ui.input(|input| input.modifiers.alt);
        let factor = (BY_WHEEL * f64::from(scroll)).exp();
        let magnified = |now: f64| rounded((now * factor).clamp(MAGNIFICATIONS[0], MAGNIFICATIONS[1]));
        let (key, value) = match &ray.bend {
            Bend::Magnify(magnify) if is_alt => {
                let wider = magnify.border + BORDER_BY_WHEEL * f64::from(scroll);
                ("border", Data::from(rounded(wider.clamp(0.0, 1.0))))
            }
            Bend::Magnify(magnify) | Bend::Feature(Feature { magnify, .. }) => {
                ("magnification", Data::from(magnified(magnify.magnification)))
            }
            Bend::Sample(sampling) => match sampling.rate {
                SamplingRate::Cubic(middle) => ("magnification", Data::from(magnified(middle))),
                SamplingRate::Points(_) => return false,
            },
            // What its handler's parameters do, nobody knows.
            Bend::Own(_) => return false,
            // The less it shows, the larger that is.
            Bend::Fisheye(fisheye) => {
                let angle = fisheye.angle.to_degrees() / factor;
                ("angle_deg", Data::from(rounded(angle.clamp(ANGLES_DEG[0], ANGLES_DEG[1]))))
            }
        };
        self.preview_ray(index, key, value);
        true
    }
}
