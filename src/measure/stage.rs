//! Where topics set up what they have drawn: a city, a view of it, and lenses that cover a known share of the picture.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::{
    geom::{Aabb, Shape, Volume, combination::Operation},
    lens::{Class, EffectUse, Lens, LensBody, LensKind, Region},
    measure::topic::Shot,
    render::picture::{Aovs, RenderError, Request, Studio},
    scene::{BaseStyle, Scene, Sun},
    view::{Camera, View},
};

/// The stage of a topic: what it draws with.
#[derive(Debug)]
pub struct Stage<'a> {
    /// The city on the GPU.
    pub studio: &'a mut Studio,
    /// Width and height of all pictures, pixels.
    pub size: [u32; 2],
}

impl Stage<'_> {
    /// The plain frame: clay, no shadows, no lens, a good first view.
    pub fn plain_scene(&self) -> Scene {
        plain_scene(self.studio.camera(&Scene::default(), self.size))
    }

    /// A picture of `scene` with so many samples per pixel; with lens masks where it has lenses.
    pub fn shot(&self, scene: Scene, samples: u32) -> Shot {
        let aovs = Aovs { lens_mask: !scene.lenses.is_empty(), ..Aovs::default() };
        Shot { request: Request { samples, aovs, ..Request::plain(self.size) }, scene, before: None, also: Vec::new() }
    }

    /// Whether the shown place of each pixel of a picture of `scene`, which has no lenses, is in a focus area: by its definition,
    /// in f64, from the depth that the picture has. Nothing of the lens tests on the GPU has a part in it.
    pub fn mask_in_f64(&mut self, scene: &Scene, focus: &Region) -> Result<Vec<bool>, RenderError> {
        let mut request = Request::plain(self.size);
        request.aovs.depth = true;
        let depth = self.studio.render(scene, &request)?.depth.unwrap_or_default();
        let view = View::new(self.studio.camera(scene, self.size), self.size, &Aabb::EMPTY)?;
        let body = Exact::of(focus).map_err(RenderError::Scene)?;
        let holds = |(i, d): (usize, &f32)| {
            let [x, y] = [i as u32 % self.size[0], i as u32 / self.size[0]];
            d.is_finite() && body.holds(view.pixel_ray(x, y).at(f64::from(*d)))
        };
        Ok(depth.iter().enumerate().map(holds).collect())
    }

    /// A sphere around what stands near the middle of the picture, so large that the surface inside it makes up `share`
    /// of the picture.
    pub fn sphere_covering(&mut self, share: f64) -> Result<Shape, RenderError> {
        let scene = self.plain_scene();
        sphere_covering(self.studio, &scene, self.size, share)
    }
}

/// A focus area in f64.
enum Exact {
    /// The union of volumes.
    Volumes(Vec<Volume>),
    /// A combination.
    Combined(Operation, Vec<Exact>),
}

impl Exact {
    fn of(focus: &Region) -> Result<Self, String> {
        Ok(match focus {
            Region::Combined { how, parts } => {
                Self::Combined(*how, parts.iter().map(Self::of).collect::<Result<_, _>>()?)
            }
            other => Self::Volumes(other.volumes()?),
        })
    }

    fn holds(&self, p: DVec3) -> bool {
        match self {
            Self::Volumes(all) => all.iter().any(|volume| volume.contains(p)),
            Self::Combined(how, parts) => {
                parts.iter().map(|part| part.holds(p)).reduce(|a, b| how.joins(a, b)).unwrap_or(false)
            }
        }
    }
}

/// Clay, no shadows, one sample.
pub fn plain_scene(camera: Camera) -> Scene {
    let mut scene = Scene { camera: Some(camera), ..Scene::default() };
    scene.style.base = BaseStyle::Clay;
    scene.sun = Sun { shadows: false, ..Sun::default() };
    scene
}

/// A lens without outline that applies these effects to what is inside.
pub fn lens(name: &str, shape: impl Into<Region>, effects: &[&str]) -> Lens {
    let use_of = |effect: &&str| EffectUse {
        effect: (*effect).to_owned(),
        class: Class::Inside,
        blend: None,
        weight: None,
        parameters: BTreeMap::new(),
    };
    Lens {
        shapes: vec![shape.into()],
        effects: effects.iter().map(use_of).collect(),
        body: LensBody::None,
        ..Lens::plain(name, LensKind::default(), [0.8, 0.2, 0.1])
    }
}

/// See [`Stage::sphere_covering`]; `scene` has a camera and no lenses.
pub fn sphere_covering(studio: &mut Studio, scene: &Scene, size: [u32; 2], share: f64) -> Result<Shape, RenderError> {
    let mut request = Request::plain(size);
    request.aovs.depth = true;
    let depth = studio.render(scene, &request)?.depth.unwrap_or_default();
    let nothing =
        || RenderError::Scene("nothing of the city is in the picture; another city would be right".to_owned());
    let (pixel, distance) = nearest_to_the_middle(size, &depth).ok_or_else(nothing)?;
    let camera = studio.camera(scene, size);
    let center = View::new(camera, size, &Aabb::EMPTY)?.pixel_ray(pixel[0], pixel[1]).at(distance);
    sphere_around(studio, scene, size, share, center, distance)
}

/// A sphere around `center`, so large that the surface inside it makes up `share` of the picture, but no larger than
/// `most` metres; `scene` has a camera and no lenses.
pub fn sphere_around(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
    share: f64,
    center: DVec3,
    most: f64,
) -> Result<Shape, RenderError> {
    let mut request = Request::plain(size);
    request.aovs.lens_mask = true;
    let mut share_of = |radius: f64| -> Result<f64, RenderError> {
        let mut lensed = scene.clone();
        lensed.lenses = vec![lens("lens", Shape::Sphere { center, radius }, &["greyscale"])];
        let masks = studio.render(&lensed, &request)?.lens_mask.unwrap_or_default();
        let inside = masks.iter().flatten().filter(|bits| **bits & 1 == 1).count();
        Ok(inside as f64 / (f64::from(size[0]) * f64::from(size[1])))
    };
    // The shown surface inside it makes up the share, not its disc; it grows with the radius.
    let (mut low, mut high) = (0.0, most);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if share_of(middle)? < share { low = middle } else { high = middle }
    }
    Ok(Shape::Sphere { center, radius: high })
}

/// The pixel nearest to the middle that shows something, and its depth in metres.
fn nearest_to_the_middle(size: [u32; 2], depth: &[f32]) -> Option<([u32; 2], f64)> {
    let from_middle = |i: usize| {
        let [x, y] = [i as u32 % size[0], i as u32 / size[0]];
        let off = |at: u32, side: u32| u64::from(at.abs_diff(side / 2)).pow(2);
        off(x, size[0]) + off(y, size[1])
    };
    let shown = (0..depth.len()).filter(|&i| depth[i].is_finite());
    let i = shown.min_by_key(|&i| from_middle(i))?;
    Some(([i as u32 % size[0], i as u32 / size[0]], f64::from(depth[i])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_where_something_stands() {
        let far = f32::INFINITY;
        let depth = [far, far, far, 5.0, far, far, far, far, far, far, 7.0, far];
        assert_eq!(nearest_to_the_middle([4, 3], &depth), Some(([2, 2], 7.0)));
        assert_eq!(nearest_to_the_middle([4, 3], &[far; 12]), None);
    }
}
