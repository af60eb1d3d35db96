//! Where what the lenses are attached to is.

use glam::DVec3;

use crate::{
    city::CityModel,
    lens::{Placement, nearest::did_you_mean},
    scene::model::{PoiPlace, Scene},
};

/// Why a lens is attached to nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AnchorProblem {
    /// The city has no such object.
    #[error("the city has no object \"{0}\"{1}")]
    NoObject(String, String),
    /// Nothing of the object has a place.
    #[error("the object \"{0}\" has no geometry, nor have its parts: there is nothing to attach to")]
    NoGeometry(String),
    /// The scene has no such point of interest.
    #[error("the scene has no point of interest \"{0}\"{1}")]
    NoPoi(String, String),
    /// Its heights are above the ground: only [`Scene::on_ground`] knows where that is.
    #[error("its height is above the ground, which is not known yet")]
    NotOnGround,
    /// The scene has no such trajectory.
    #[error("the scene has no trajectory \"{0}\"")]
    NoTrajectory(String),
}

/// The origin of the coordinates of shapes that are placed so, metres; a camera's is its eye, which is not known here: `None`.
pub fn anchor(placement: &Placement, scene: &Scene, model: &CityModel) -> Result<Option<DVec3>, AnchorProblem> {
    match placement {
        Placement::Camera => Ok(None),
        Placement::World => Ok(Some(DVec3::ZERO)),
        // Where the ground is its shapes know, each for itself.
        Placement::AboveGround => Err(AnchorProblem::NotOnGround),
        Placement::Object(id) => middle_of(id, model).map(Some),
        Placement::Poi(name) => match scene.pois.iter().find(|poi| poi.name == *name).map(|poi| scene.place(poi)) {
            Some(PoiPlace::At(at)) => Ok(Some(at)),
            Some(PoiPlace::AboveGround(_)) => Err(AnchorProblem::NotOnGround),
            Some(PoiPlace::Object(id)) => middle_of(&id, model).map(Some),
            Some(PoiPlace::On(name)) => Err(AnchorProblem::NoTrajectory(name)),
            None => {
                let hint = did_you_mean(name, scene.pois.iter().map(|poi| poi.name.as_str()));
                Err(AnchorProblem::NoPoi(name.clone(), hint))
            }
        },
    }
}

/// The id of the city object that shapes are placed by, itself or as a point of interest.
pub fn object_of(placement: &Placement, scene: &Scene) -> Option<String> {
    match placement {
        Placement::Object(id) => Some(id.clone()),
        Placement::Poi(name) => {
            let poi = scene.pois.iter().find(|poi| poi.name == *name)?;
            if let PoiPlace::Object(id) = scene.place(poi) { Some(id) } else { None }
        }
        Placement::World | Placement::AboveGround | Placement::Camera => None,
    }
}

fn middle_of(id: &str, model: &CityModel) -> Result<DVec3, AnchorProblem> {
    let Some(object) = model.find_object(id) else {
        let hint = did_you_mean(id, model.objects.iter().map(|o| &*o.id));
        return Err(AnchorProblem::NoObject(id.to_owned(), hint));
    };
    let bounds = model.family_bounds(object);
    if bounds.is_empty() { Err(AnchorProblem::NoGeometry(id.to_owned())) } else { Ok(bounds.center()) }
}
