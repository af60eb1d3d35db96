//! Coming down to the ground: where a person can stand, and what they look at.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::{
    app::state::Window,
    city::place::Places,
    geom::Aabb,
    scene::above_ground,
    view::{Camera, Field, Projection, navigate},
    visibility::{Before, ENOUGH, EYE_HEIGHT_M, Standing, Subject},
};

/// An eye higher than this above the ground comes down where it looks, else where it is, metres.
const LOW_M: f64 = 10.0;
/// The free distance around a place to stand, metres.
const ROOM_M: f64 = 1.0;
/// The distance around a place up to which a free one is looked for, metres, and the steps: metres, and that share of how far it is
/// already, so that where nothing is free some 1,400 places are tried.
const REACH_M: f64 = 100.0;
const APART_M: f64 = 2.0;
const APART_SHARE: f64 = 0.1;

impl Window {
    /// The camera after coming down to the ground: before the chosen object with all of it in the picture, where a third of its facades is
    /// seen or as much as can be ([`Before`]), on the side of the eye if that will do; a low eye that sees so much of it only turns to it.
    /// Without an object it is where the eye looks, and a low eye stays where it is. It never lands in a building where there is room beside it.
    pub(super) fn landing(&self, camera: &Camera) -> Camera {
        let here = camera.eye.truncate();
        let is_low = self.ground_at(here).is_none_or(|ground| camera.eye.z - ground < LOW_M);
        if let Some(standing) = self.before_chosen(camera, is_low) {
            return navigate::landed(camera, standing.eye, Some(standing.target));
        }
        let chosen = self.chosen_bounds().filter(|_| !is_low).map(|bounds| bounds.center());
        let seen = || self.canvas.middle(self.frame.as_deref()).unwrap_or(camera.target).truncate();
        let wanted = match chosen {
            _ if is_low => here,
            Some(middle) => middle.truncate(),
            None => seen(),
        };
        let place = free_near(wanted, |place| self.places().is_none_or(|places| places.is_free(place, ROOM_M)));
        match self.ground_at(place) {
            Some(ground) => navigate::landed(camera, place.extend(ground + EYE_HEIGHT_M), chosen),
            None => *camera,
        }
    }

    /// Where to stand before the chosen object, if one is chosen that can be looked at so.
    fn before_chosen(&self, camera: &Camera, is_low: bool) -> Option<Standing> {
        let (city, places) = (self.city.as_ref()?, self.places()?);
        let object = self.chosen.object.filter(|object| !self.is_ground(*object))?;
        let subject = Subject::new(&city.model, &city.geometries, places.index, object).ok()?;
        let fov_y = match camera.projection {
            Projection::Perspective { fov_y } => fov_y,
            Projection::Orthographic { .. } => self.fov_y,
        };
        let before = Before { subject: &subject, places, field: Field { fov_y, aspect: self.canvas.aspect() } };
        let here = is_low.then(|| before.standing_at(camera.eye.truncate())).flatten();
        here.filter(|standing| standing.seen >= ENOUGH).or_else(|| before.standing(camera.eye))
    }

    /// Around the chosen object, but for ground, metres.
    fn chosen_bounds(&self) -> Option<Aabb> {
        let object = self.chosen.object.filter(|object| !self.is_ground(*object))?;
        let bounds = self.bounds_of(self.city.as_ref()?, object);
        (!bounds.is_empty()).then_some(bounds)
    }

    /// The height of the ground at a place in plan, metres: of terrain, roads and the like, else of the plain ground, else of the lowest
    /// place of the city.
    pub(super) fn ground_at(&self, at: DVec2) -> Option<f64> {
        let lowest = self.city.as_ref()?.extent.min.z;
        self.places().map(|places| places.ground(at).unwrap_or(lowest))
    }

    /// What is at places of the city, once that is known.
    fn places(&self) -> Option<Places<'_>> {
        let city = self.city.as_ref()?;
        Some(Places { model: &city.model, index: city.index.get()?, ground: city.ground.as_deref() })
    }

    /// Moves the eye as a person does: not below the ground, and not into a building; from there anywhere.
    pub(super) fn look(&mut self, to: Camera) {
        let kept = match (self.camera(), self.places()) {
            (Some(from), Some(places)) if matches!(to.projection, Projection::Perspective { .. }) => {
                kept(&from, to, |eye| places.kept(from.eye, eye))
            }
            _ => to,
        };
        self.put_eye(kept);
    }

    /// Puts the eye somewhere, model coordinates; the scene goes on giving it above the ground where it does.
    pub(super) fn put_eye(&mut self, camera: Camera) {
        let own = match self.document.scene().camera_above_ground {
            true => above_ground::lowered(&camera, &self.ground()),
            false => Ok(camera),
        };
        if let Ok(own) = own {
            self.document.look(own);
        }
    }

    /// The height of the ground at places in plan, metres, where there is ground that is known.
    pub(super) fn ground(&self) -> impl Fn(DVec2) -> Option<f64> {
        |at| self.places()?.ground(at)
    }

    fn is_ground(&self, object: u32) -> bool {
        let objects = self.city.as_ref().map(|city| &city.model.objects);
        objects.and_then(|objects| objects.get(object as usize)).is_some_and(|own| own.class.is_ground())
    }
}

/// A camera on its way `to` somewhere whose eye comes where it may: what it looks at stays where that did not move, else it goes along.
fn kept(from: &Camera, to: Camera, eye: impl Fn(DVec3) -> DVec3) -> Camera {
    let kept = eye(to.eye);
    match kept {
        kept if kept == to.eye => to,
        kept if kept == from.eye => *from,
        kept if to.target == from.target => Camera { eye: kept, ..to },
        kept => Camera { eye: kept, target: to.target + (kept - to.eye), ..to },
    }
}

/// The free place nearest to `at`, of places 2 to 10 m apart on circles up to 100 m around it; `at` itself where none is free.
fn free_near(at: DVec2, is_free: impl Fn(DVec2) -> bool) -> DVec2 {
    let apart = |radius: f64| APART_M.max(APART_SHARE * radius);
    let circles =
        std::iter::successors(Some(0.0), |radius| Some(radius + apart(*radius))).take_while(|r| *r <= REACH_M);
    let mut places = circles.flat_map(|radius| {
        let count = (TAU * radius / apart(radius)).ceil().max(1.0);
        (0..count as u32).map(move |i| at + radius * DVec2::from_angle(TAU * f64::from(i) / count))
    });
    places.find(|place| is_free(*place)).unwrap_or(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_free_place_is_taken() {
        let at = DVec2::new(85_000.0, 447_000.0);
        assert_eq!(free_near(at, |_| true), at);
        // A house of 30 by 12 m around it: beside its nearer walls, at most one circle farther than need be.
        let is_free = |place: DVec2| (place - at).abs().cmpgt(DVec2::new(15.0, 6.0)).any();
        let place = free_near(at, is_free);
        assert!(is_free(place) && (6.0..8.5).contains(&place.distance(at)), "{place}");
        // A way out on one side only, as of a court with a gate.
        let gate = |place: DVec2| (place - at).x > 40.0 && (place - at).y.abs() < 3.0;
        let place = free_near(at, gate);
        assert!(gate(place) && (40.0..45.0).contains(&place.distance(at)), "{place}");
        // None: where it was.
        assert_eq!(free_near(at, |_| false), at);
        assert_eq!(free_near(at, |place| place.distance(at) > 101.0), at);
        // Far places are farther apart.
        let tried = std::cell::Cell::new(0);
        free_near(at, |_| {
            tried.set(tried.get() + 1);
            false
        });
        assert!((1_200..1_600).contains(&tried.get()), "{}", tried.get());
    }
}
