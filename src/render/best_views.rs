//! The balls around objects, and the directions that they are seen best from, found once.

use std::{
    collections::HashMap,
    sync::{Arc, MutexGuard, PoisonError},
};

use glam::DVec3;

use crate::{
    geom::Sphere,
    render::{
        light::to_sun,
        picture::{RenderError, Studio},
    },
    scene::Sun,
    view::Field,
    visibility::{BestView, Subject},
};

/// What is known of objects, by their number in the city.
#[derive(Debug, Default)]
pub(super) struct KnownViews {
    bulks: HashMap<u32, Arc<Bulk>>,
    /// And by the bits of the vertical field of view, and of the direction to the sun.
    best: HashMap<(u32, [u64; 4]), BestView>,
}

/// Where an object is.
#[derive(Debug)]
pub struct Bulk {
    /// The smallest ball around what is shown of it and its parts, metres.
    pub ball: Sphere,
    /// The middle of its facades, metres: see [`Subject::middle`].
    pub middle: DVec3,
    /// The corners of what is shown of it, metres.
    pub corners: Vec<DVec3>,
}

impl KnownViews {
    /// Things stand elsewhere now.
    pub fn clear(&mut self) {
        self.bulks.clear();
        self.best.clear();
    }
}

impl Studio {
    /// Where an object and its parts are, as far as they are shown.
    ///
    /// # Errors
    /// Where the city has no such object, or nothing of it is shown.
    pub fn bulk(&self, id: &str) -> Result<Arc<Bulk>, RenderError> {
        let object = self.object(id)?;
        if let Some(bulk) = self.known_views().bulks.get(&object) {
            return Ok(bulk.clone());
        }
        let bulk = self.with_subject(object, |subject| {
            Ok(Arc::new(Bulk { ball: subject.ball, middle: subject.middle(), corners: subject.corners().to_vec() }))
        })?;
        self.known_views().bulks.insert(object, bulk.clone());
        Ok(bulk)
    }

    /// The best view of an object with this vertical field of view in a picture of 16 by 9, in the light of a scene. Its normal does not depend on the
    /// size of what shows it, so that it stays the same when that changes.
    ///
    /// # Errors
    /// As for [`Studio::bulk`]; a field of view that no camera has.
    pub fn best_view(&self, id: &str, fov_y: f64, sun: &Sun) -> Result<BestView, RenderError> {
        let object = self.object(id)?;
        let to_sun = to_sun(sun);
        let key = (object, [fov_y, to_sun.x, to_sun.y, to_sun.z].map(f64::to_bits));
        if let Some(best) = self.known_views().best.get(&key) {
            return Ok(*best);
        }
        let field = Field { fov_y, ..Field::default() };
        let best = self.with_subject(object, |subject| {
            let views = subject.lit_from(to_sun).best_views(&field, 1);
            let views = views.map_err(|error| RenderError::Scene(error.to_string()))?;
            views.first().copied().ok_or_else(|| RenderError::Scene(format!("the object \"{id}\" has no view")))
        })?;
        self.known_views().best.insert(key, best);
        Ok(best)
    }

    fn object(&self, id: &str) -> Result<u32, RenderError> {
        self.model.find_object(id).ok_or_else(|| RenderError::Scene(format!("the city has no object \"{id}\"")))
    }

    fn with_subject<T>(
        &self,
        object: u32,
        ask: impl FnOnce(Subject) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let shown = self.shown();
        let subject = Subject::new(&self.model, &self.geometries, shown.index(), object);
        ask(subject.map_err(|error| RenderError::Scene(error.to_string()))?)
    }

    fn known_views(&self) -> MutexGuard<'_, KnownViews> {
        self.known_views.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
