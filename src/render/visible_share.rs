//! How much of a point of interest is seen.

use crate::{
    city::CityModel,
    lens::{
        Class, EffectUse, Lens, LensBody, LensKind, Region,
        chosen::{Choice, members},
    },
    render::{
        parts::TILE,
        picture::{Aovs, RenderError, Request, Studio},
        stats,
    },
    scene::{PoiPlace, Scene},
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

/// The scene of the same view with nothing but the terrain and the object: no effect on the context, and no lens but those that move the
/// city.
pub fn alone(scene: &Scene, model: &CityModel, id: &str) -> Scene {
    let ground = model.objects.iter().filter(|object| object.class.is_ground()).map(|object| object.id.to_string());
    let kept = Choice { ids: ground.chain([id.to_owned()]).collect(), except: true, ..Choice::default() };
    let mut alone = scene.clone();
    alone.style.effects.clear();
    alone.style.technique = Default::default();
    alone.lenses.retain(|lens| lens.deform().is_some());
    alone.lenses.iter_mut().for_each(|lens| {
        lens.effects.clear();
        lens.body = LensBody::None;
        lens.border = None;
    });
    alone.lenses.push(all_else(kept));
    alone
}

/// A lens that takes away all but what is chosen.
fn all_else(kept: Choice) -> Lens {
    let eraser = EffectUse {
        effect: "eraser".to_owned(),
        class: Class::Inside,
        blend: None,
        weight: None,
        parameters: Default::default(),
    };
    let plain = Lens::plain("all else", LensKind::default(), [0.0; 3]);
    Lens { shapes: vec![Region::Thematic(kept)], effects: vec![eraser], body: LensBody::None, ..plain }
}

/// The share of an object that a scene's picture of this size shows, where deformations show it; `None` where it is out of the picture, or
/// terrain hides all of it. `size` fits one target ([`TILE`]).
///
/// # Errors
/// What drawing cannot do.
pub fn share_in(studio: &mut Studio, scene: &Scene, size: [u32; 2], id: &str) -> Result<Option<f64>, RenderError> {
    let aovs = Aovs { object_id: true, ..Aovs::default() };
    let request = Request { aovs, ..Request::plain(size) };
    let model = studio.model.clone();
    let objects = objects_of(&model, id);
    let is_of = |code: u32| code.checked_sub(1).and_then(|i| objects.get(i as usize)) == Some(&true);
    let ids = studio.render(&alone(scene, &model, id), &request)?.object_id.unwrap_or_default();
    let whole: Vec<bool> = ids.into_iter().map(is_of).collect();
    let seen = studio.transmittance(scene, size)?;
    Ok(visible_share(&whole, |i| if is_of(seen.object_id[i]) { f64::from(seen.through[i]) } else { 0.0 }))
}

/// Of each lens that makes occluders lower how much of its points of interest is seen, as they are shown and without deformations;
/// `None` for other lenses. Points that are no objects have no share.
///
/// # Errors
/// What drawing cannot do.
pub(super) fn of_lenses(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
) -> Result<Vec<Option<Vec<stats::Visible>>>, RenderError> {
    let size = within(size, TILE);
    let mut at_rest = scene.clone();
    at_rest.lenses.iter_mut().for_each(|lens| lens.enabled &= lens.deform().is_none());
    let pois = scene.standing_pois();
    let mut of_lens = |lens: &Lens| {
        let Some(of) = lens.deform().and_then(|deform| deform.occluders()).filter(|_| lens.enabled) else {
            return Ok(None);
        };
        let named = pois.iter().filter(|poi| of.pois.contains(&poi.name));
        let objects = named.filter_map(|poi| match &poi.place {
            PoiPlace::Object(id) => Some((&poi.name, id)),
            _ => None,
        });
        let visible = objects.map(|(name, id)| {
            Ok(stats::Visible {
                poi: name.clone(),
                share: share_in(studio, scene, size, id)?,
                at_rest: share_in(studio, &at_rest, size, id)?,
            })
        });
        visible.collect::<Result<Vec<_>, _>>().map(Some)
    };
    scene.lenses.iter().map(&mut of_lens).collect()
}

/// A size of the same shape that fits a target.
fn within(size: [u32; 2], most: u32) -> [u32; 2] {
    let longest = size[0].max(size[1]);
    if longest <= most {
        return size;
    }
    size.map(|side| ((u64::from(side) * u64::from(most)).div_ceil(u64::from(longest)) as u32).max(1))
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

    #[test]
    fn sizes_fit_a_target_and_keep_their_shape() {
        assert_eq!(within([640, 480], 2048), [640, 480]);
        assert_eq!(within([4096, 1024], 2048), [2048, 512]);
        assert_eq!(within([3, 90_000], 2048), [1, 2048]);
    }
}
