//! Objects that move are dragged along their way: the scene shows the moment at which they come where the pointer is.

use std::sync::Arc;

use eframe::egui::{Pos2, Rect};

use crate::{
    app::{
        canvas_state::{Held, Hovered},
        spots::in_rect,
        state::Window,
    },
    city::{
        timetable::Keyframes,
        way::{nearest, way_of},
    },
    lens::{Handled, epoch::moment_after},
    scene::Scene,
    time::{HOUR, Moment, Span},
    view::View,
};

/// How far from the box of an object a place of it may be found: a picture tells depths as `f32`.
const TOLERANCE_M: f64 = 0.5;
/// What the moments that a drag finds are rounded to, microseconds.
const FINEST: i64 = 1_000;

impl Window {
    /// The keyframes of an object that moves, with what it is part of.
    fn keyframes(&self, object: u32) -> Option<&Keyframes> {
        let model = &self.city.as_ref()?.model;
        model.moves.get(model.mover(object)?).filter(|of| of.keys.len() > 1)
    }

    /// Whether what is under the pointer can be dragged through time.
    pub(super) fn moves(&self, hovered: Option<Hovered>) -> bool {
        hovered.and_then(|hovered| self.keyframes(hovered.object?)).is_some()
    }

    /// What is held where an object that moves is shown. `None`: nothing moves there, or not as the scene's moment does.
    pub(super) fn hold(&self, hovered: Hovered) -> Option<Held> {
        let of = self.keyframes(hovered.object?)?;
        let scene = self.document.scene();
        let now = now(scene, of);
        let bounds = self.city.as_ref()?.model.family_bounds(of.object);
        // What is shown there is in its box at the moment that shows there.
        let stands = |moment: Moment| {
            let point = of.pose(Some(moment)).in_file(hovered.at);
            (bounds.distance_to(point) <= TOLERANCE_M).then_some((moment, point))
        };
        let own = scene.steps_of(None);
        let lenses = (0..scene.lenses.len()).filter(|i| scene.lenses[*i].enabled && !scene.lenses[*i].time.is_empty());
        let all =
            std::iter::once(own.clone()).chain(lenses.rev().map(|i| [own.clone(), scene.steps_of(Some(i))].concat()));
        let shown = all.filter(|steps| goes_along(steps, now, scene.time_s));
        let shown = shown.filter_map(|steps| moment_after(&steps, Some(now), scene.time_s).ok().flatten());
        let (moment, point) = shown.filter_map(stands).next()?;
        Some(Held { way: way_of(of, point), later: moment - now })
    }

    /// Goes to the moment at which what is held is nearest to the pointer.
    pub(super) fn drag_along(&mut self, held: &Arc<Held>, view: &View, rect: Rect, pointer: Pos2) {
        let scene = self.document.scene();
        let Some(first) = held.way.first() else { return };
        let later = Span::of_micros(held.later);
        let now = scene.moment.map_or(first.at, |now| now.shifted(later));
        let shown = |place| view.weighted_pixel(place);
        let Some(found) = nearest(&held.way, now, in_rect(rect, pointer), &shown) else { return };
        let at = found.shifted(later.back()).micros();
        let Some(at) = Moment::from_micros((at + FINEST / 2).div_euclid(FINEST) * FINEST) else { return };
        self.timeline.plays = false;
        if scene.moment != Some(at) {
            let scene = Scene { moment: Some(at), ..scene.clone() };
            self.document.preview("move through time", scene);
        }
    }
}

/// The moment of a scene; where it has none, objects are as at the first keyframe.
fn now(scene: &Scene, of: &Keyframes) -> Moment {
    scene.moment.unwrap_or(of.keys[0].at)
}

/// Whether what some steps make of a moment is later as it is later.
fn goes_along(steps: &[Handled], now: Moment, clock_s: f64) -> bool {
    let of = |at: Moment| moment_after(steps, Some(at), clock_s).ok().flatten();
    let hour = Span::of_micros(HOUR);
    matches!([of(now), of(now.shifted(hour))], [Some(at), Some(after)] if after - at == HOUR)
}
