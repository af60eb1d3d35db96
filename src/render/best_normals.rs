//! The directions that objects are seen best from, found once (B2).

use std::sync::PoisonError;

use glam::DVec3;

use crate::{
    render::picture::{RenderError, Studio},
    view::Field,
    visibility::best_views,
};

impl Studio {
    /// The best-view normal of an object, unit: of the best view with this vertical field of view in a picture of 16 by 9. It does not depend
    /// on the size of what shows it, so that it stays the same when that changes.
    ///
    /// # Errors
    /// Where the city has no such object, or nothing of it is shown.
    pub fn best_normal(&self, id: &str, fov_y: f64) -> Result<DVec3, RenderError> {
        let wrong = |message: String| RenderError::Scene(message);
        let object = self.model.find_object(id).ok_or_else(|| wrong(format!("the city has no object \"{id}\"")))?;
        let key = (object, fov_y.to_bits());
        let mut known = self.best_normals.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(normal) = known.get(&key) {
            return Ok(*normal);
        }
        let field = Field { fov_y, ..Field::default() };
        let shown = self.shown();
        let views = best_views(&self.model, &self.geometries, shown.index(), object, &field);
        let views = views.map_err(|error| wrong(error.to_string()))?;
        let normal = views.first().map_or(DVec3::Z, |view| view.framing.normal);
        known.insert(key, normal);
        Ok(normal)
    }
}
