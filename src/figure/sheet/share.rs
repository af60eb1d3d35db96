//! How much of a point of interest is seen.

use crate::{
    city::CityModel,
    lens::{
        Class, EffectUse, Focus, Lens, LensBody, LensKind,
        chosen::{Choice, members},
    },
    render::picture::{Aovs, RenderError, Request, Studio},
    scene::Scene,
};

/// The share of a point of interest that is seen: the sum of the transmittance over its pixels, by the number of them. Its
/// pixels (`poi`) are those where it is seen with nothing but terrain; `transmittance` gives, for one of them, how much of it
/// comes through to the eye, 0 to 1. `None` where it has no pixel.
pub fn visible_share(poi: &[bool], transmittance: impl Fn(usize) -> f64) -> Option<f64> {
    let (count, sum) = (0..poi.len())
        .filter(|&i| poi[i])
        .fold((0_u64, 0.0), |(count, sum), i| (count + 1, sum + transmittance(i).clamp(0.0, 1.0)));
    (count > 0).then(|| sum / count as f64)
}

/// Which objects are the point of interest: itself and its parts.
pub fn objects_of(model: &CityModel, id: &str) -> Vec<bool> {
    members(model, &Choice { ids: vec![id.to_owned()], ..Choice::default() })
}

/// The scene of the same view with nothing but the terrain and the object: no lens, no effect on the context.
pub fn alone(scene: &Scene, model: &CityModel, id: &str) -> Scene {
    let ground = model.objects.iter().filter(|object| object.class.is_ground()).map(|object| object.id.to_string());
    let kept = Choice { ids: ground.chain([id.to_owned()]).collect(), except: true, ..Choice::default() };
    let mut alone = scene.clone();
    alone.style.effects.clear();
    alone.style.technique = Default::default();
    alone.lenses = vec![Lens {
        name: "all else".to_owned(),
        kind: LensKind::Color,
        enabled: true,
        color: [0.0; 3],
        placement: Default::default(),
        shapes: vec![Focus::Thematic(kept)],
        effects: vec![EffectUse {
            effect: "eraser".to_owned(),
            class: Class::Inside,
            blend: None,
            weight: None,
            parameters: Default::default(),
        }],
        best_view: None,
        deform: None,
        content: None,
        body: LensBody::None,
        sprite: None,
        border: None,
        keeps_shadows: false,
        at_rest: false,
        section: None,
        render: None,
    }];
    alone
}

/// The share of an object that a scene's picture shows; `None` where it is out of the picture, or terrain hides all of it.
///
/// # Errors
/// What drawing cannot do.
pub fn share_in(studio: &mut Studio, scene: &Scene, id: &str) -> Result<Option<f64>, RenderError> {
    let request = Request {
        size: scene.figure.size,
        samples: 1,
        transparent: false,
        aovs: Aovs { object_id: true, ..Aovs::default() },
        statistics: false,
        backend: Default::default(),
    };
    let model = studio.model.clone();
    let objects = objects_of(&model, id);
    let mut shows = |scene: &Scene| -> Result<Vec<bool>, RenderError> {
        let ids = studio.render(scene, &request)?.object_id.unwrap_or_default();
        let is_of = |code: &u32| code.checked_sub(1).and_then(|i| objects.get(i as usize)) == Some(&true);
        Ok(ids.iter().map(is_of).collect())
    };
    let whole = shows(&alone(scene, &model, id))?;
    let seen = studio.transmittance(scene, scene.figure.size)?;
    let is_of = |code: u32| code.checked_sub(1).and_then(|i| objects.get(i as usize)) == Some(&true);
    Ok(visible_share(&whole, |i| if is_of(seen.object_id[i]) { f64::from(seen.through[i]) } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_the_mean_of_what_comes_through() {
        let through = [1.0, 0.25, 9.0, 0.5];
        assert_eq!(visible_share(&[true, true, false, true], |i| through[i]), Some(1.75 / 3.0));
        assert_eq!(visible_share(&[true; 2], |_| 0.0), Some(0.0));
        assert_eq!(visible_share(&[false; 4], |_| 1.0), None);
    }
}
