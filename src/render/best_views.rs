//! The balls around objects, and the directions that they are seen best from, found once.

use std::{
    collections::HashMap,
    sync::{MutexGuard, PoisonError},
};

use glam::DVec3;

use crate::{
    geom::Sphere,
    render::picture::{RenderError, Studio},
    view::Field,
    visibility::{BestView, Subject},
};

/// What is known of objects, by their number in the city.
#[derive(Debug, Default)]
pub(super) struct KnownViews {
    balls: HashMap<u32, (Sphere, DVec3)>,
    /// And by the bits of the vertical field of view.
    best: HashMap<(u32, u64), BestView>,
}

impl Studio {
    /// The smallest ball around what is shown of an object and its parts, metres.
    ///
    /// # Errors
    /// Where the city has no such object, or nothing of it is shown.
    pub fn ball(&self, id: &str) -> Result<Sphere, RenderError> {
        self.bulk(id).map(|bulk| bulk.0)
    }

    /// The middle of the facades of an object, metres: see [`Subject::middle`].
    ///
    /// # Errors
    /// As for [`Studio::ball`].
    pub fn middle(&self, id: &str) -> Result<DVec3, RenderError> {
        self.bulk(id).map(|bulk| bulk.1)
    }

    fn bulk(&self, id: &str) -> Result<(Sphere, DVec3), RenderError> {
        let object = self.object(id)?;
        if let Some(bulk) = self.known_views().balls.get(&object) {
            return Ok(*bulk);
        }
        let bulk = self.with_subject(object, |subject| Ok((subject.ball, subject.middle())))?;
        self.known_views().balls.insert(object, bulk);
        Ok(bulk)
    }

    /// The best view of an object with this vertical field of view in a picture of 16 by 9. Its normal does not depend on the size of what shows it, so
    /// that it stays the same when that changes.
    ///
    /// # Errors
    /// As for [`Studio::ball`]; a field of view that no camera has.
    pub fn best_view(&self, id: &str, fov_y: f64) -> Result<BestView, RenderError> {
        let object = self.object(id)?;
        let key = (object, fov_y.to_bits());
        if let Some(best) = self.known_views().best.get(&key) {
            return Ok(*best);
        }
        let field = Field { fov_y, ..Field::default() };
        let best = self.with_subject(object, |subject| {
            let views = subject.best_views(&field, 1).map_err(|error| RenderError::Scene(error.to_string()))?;
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
        ask: impl FnOnce(&Subject) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let shown = self.shown();
        let subject = Subject::new(&self.model, &self.geometries, shown.index(), object);
        ask(&subject.map_err(|error| RenderError::Scene(error.to_string()))?)
    }

    fn known_views(&self) -> MutexGuard<'_, KnownViews> {
        self.known_views.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
