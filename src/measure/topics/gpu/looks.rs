//! Scenes that checks draw: scenes and lenses by one line, and pictures with all that is known of each pixel.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::{
    geom::Aabb,
    lens::{Class, EffectUse, Lens, Parameter, Region},
    measure::stage,
    render::{
        frame::Backend,
        picture::{Aovs, Picture, RenderError, Request, Studio},
    },
    scene::{Scene, Sun, Transparency},
    view::{Camera, Projection, View},
};

/// All AOVs.
pub const ALL: Aovs = Aovs { depth: true, object_id: true, normal: true, lens_mask: true };

/// A scene without shadows.
pub fn scene(camera: Camera, lenses: Vec<Lens>) -> Scene {
    Scene { camera: Some(camera), lenses, sun: Sun { shadows: false, ..Sun::default() }, ..Scene::default() }
}

/// A lens with one effect, without outline.
pub fn lens(name: &str, shape: impl Into<Region>, effect: &str) -> Lens {
    stage::lens(name, shape, &[effect])
}

/// An effect with its defaults.
pub fn used(effect: &str) -> EffectUse {
    EffectUse { effect: effect.into(), class: Class::Inside, blend: None, weight: None, parameters: BTreeMap::new() }
}

/// An effect with one number.
pub fn with_number(effect: &str, name: &str, value: f64) -> EffectUse {
    let parameters = BTreeMap::from([(name.to_owned(), Parameter::Number(value))]);
    EffectUse { parameters, ..used(effect) }
}

/// An effect for the objects whose attribute `n` is one of these, or for all others.
pub fn for_numbers(mut effect: EffectUse, numbers: &[usize], except: bool) -> EffectUse {
    let values = numbers.iter().map(ToString::to_string).collect();
    effect.parameters.insert("attribute".into(), Parameter::Text("n".into()));
    effect.parameters.insert("values".into(), Parameter::Texts(values));
    effect.parameters.insert("except".into(), Parameter::Boolean(except));
    effect
}

/// A scene of which everything lets a part of the light through.
pub fn translucent(camera: Camera, opacity: f64, method: Transparency) -> Scene {
    let mut made = scene(camera, Vec::new());
    made.style.effects = vec![with_number("transparent", "opacity", opacity)];
    made.style.transparency = method;
    made
}

/// A parallel view.
pub fn orthographic(eye: DVec3, target: DVec3, height_m: f64) -> Camera {
    Camera { projection: Projection::Orthographic { height_m }, ..Camera::looking(eye, target, 1.0) }
}

/// The view of a camera on a picture of `size` pixels, whatever is in it.
///
/// # Errors
/// Cameras without a picture.
pub fn view(camera: Camera, size: [u32; 2]) -> Result<View, RenderError> {
    Ok(View::new(camera, size, &Aabb { min: camera.eye - 1e8, max: camera.eye + 1e8 })?)
}

/// One unjittered sample with all AOVs.
///
/// # Errors
/// Drawing fails.
pub fn picture(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Result<Picture, RenderError> {
    picture_by(studio, scene, size, Backend::default())
}

/// The same with shaders made by one of the back ends.
///
/// # Errors
/// Drawing fails.
pub fn picture_by(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
    backend: Backend,
) -> Result<Picture, RenderError> {
    studio.render(scene, &Request { aovs: ALL, backend, ..Request::plain(size) })
}

/// The layers over the opaque picture, of one of the back ends.
///
/// # Errors
/// Drawing fails.
pub fn transparency(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
    backend: Backend,
) -> Result<Vec<[f32; 4]>, RenderError> {
    studio.backend = backend;
    let found = studio.transparency(scene, size);
    studio.backend = Backend::default();
    found
}

/// Distances of a picture that has them, metres.
pub fn depths(picture: &Picture) -> &[f32] {
    picture.depth.as_deref().unwrap_or_default()
}

/// Objects of a picture that has them, index + 1.
pub fn ids(picture: &Picture) -> &[u32] {
    picture.object_id.as_deref().unwrap_or_default()
}

/// Whether a lens' bit is set, of a picture that has masks.
pub fn bit(picture: &Picture, lens: usize, pixel: usize) -> bool {
    let plane = picture.lens_mask.as_ref().and_then(|planes| planes.get(lens / 32));
    plane.and_then(|plane| plane.get(pixel)).is_some_and(|word| word >> (lens % 32) & 1 == 1)
}

/// Column and row of a pixel.
pub fn column_row(size: [u32; 2], pixel: usize) -> [u32; 2] {
    [pixel as u32 % size[0], pixel as u32 / size[0]]
}

/// The middle of a pixel.
pub fn middle(size: [u32; 2], pixel: usize) -> DVec2 {
    let [x, y] = column_row(size, pixel);
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

/// Whether two pictures have the same bytes in colour, distance, object, normal and, where both have as many lenses, masks.
pub fn is_same(a: &Picture, b: &Picture) -> bool {
    let bits = |p: &Picture| depths(p).iter().map(|d| d.to_bits()).collect::<Vec<_>>();
    a.rgba == b.rgba && a.object_id == b.object_id && a.normal == b.normal && bits(a) == bits(b)
}

/// A look over a city from above, along its streets, and in parallel.
pub fn cameras(studio: &Studio) -> [Camera; 3] {
    let extent = studio.extent();
    let (center, size) = (extent.center(), extent.size().length());
    let house = house(studio);
    let street = DVec3::new(house.min.x - 9.0, house.min.y - 6.0, house.min.z + 1.6);
    let above = center + size * DVec3::new(0.4, -0.6, 0.5);
    [
        Camera::looking(above, center, 0.8),
        Camera::looking(street, house.center(), 1.2),
        orthographic(above, center, 0.6 * size),
    ]
}

/// The box around one of the middle objects of a city.
pub fn house(studio: &Studio) -> Aabb {
    let geometry = studio.geometries.get(studio.geometries.len() / 2);
    geometry.map_or(Aabb::EMPTY, |&g| studio.model.geometries[g as usize].bounds)
}
