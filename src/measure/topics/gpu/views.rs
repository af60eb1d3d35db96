//! Scenes that benchmarks of frames draw: two views of a city, and lenses in them.

use glam::DVec3;

use crate::{
    geom::{Aabb, Shape},
    lens::{EffectUse, Lens, Region},
    measure::stage::{lens, sphere_around, sphere_covering},
    render::picture::{RenderError, Studio},
    scene::Scene,
    view::{Camera, View},
};

/// V1: the whole city in the frustum of a picture of `size` pixels.
///
/// # Errors
/// A city without a picture.
pub fn overview(extent: &Aabb, size: [u32; 2]) -> Result<Camera, RenderError> {
    let target = extent.center().with_z(extent.min.z);
    let reach = extent.size().truncate().length();
    let mut camera = Camera::looking(target + DVec3::new(-0.45, -0.75, 0.55) * reach, target, 45_f64.to_radians());
    // Nearer, as long as all corners stay in the picture.
    for _ in 0..40 {
        let closer = Camera { eye: target + (camera.eye - target) * 0.97, ..camera };
        let frustum = View::new(closer, size, extent)?.frustum(0.0);
        if !extent.corners().into_iter().all(|c| frustum.contains(c)) {
            break;
        }
        camera = closer;
    }
    Ok(camera)
}

/// V2: at the city's centre, 1.7 m up, at the nearest place to it where no building stands.
pub fn street(studio: &Studio) -> Camera {
    let extent = studio.extent();
    let model = &studio.model;
    let is_free = |p: DVec3| {
        let near =
            |b: &Aabb| (b.min.x - 1.0..b.max.x + 1.0).contains(&p.x) && (b.min.y - 1.0..b.max.y + 1.0).contains(&p.y);
        !studio.geometries.iter().any(|&g| {
            let geometry = &model.geometries[g as usize];
            !model.objects[geometry.object as usize].class.is_ground() && near(&geometry.bounds)
        })
    };
    let spiral = (0..20_000).map(|i| {
        let (turn, reach) = (f64::from(i) * 0.5, f64::from(i) * 0.02);
        extent.center().with_z(extent.min.z + 1.7) + DVec3::new(turn.cos(), turn.sin(), 0.0) * reach
    });
    let eye = spiral.into_iter().find(|p| is_free(*p)).unwrap_or(extent.center());
    Camera::looking(eye, eye + DVec3::new(80.0, 30.0, 0.0), 45_f64.to_radians())
}

/// Greyscale lenses all over the city, of which on average one lies over a place on the ground.
pub fn spread(scene: &Scene, extent: &Aabb, count: u32) -> Scene {
    let size = extent.size();
    let radius = (size.x * size.y / (f64::from(count) * std::f64::consts::PI)).sqrt();
    let one = |i: u32| {
        // A sequence that spreads evenly (Roberts, the plastic number).
        let share = |step: f64| (0.5 + step * f64::from(i)).fract();
        let center = extent.min + DVec3::new(share(0.754_877_666), share(0.569_840_291), 0.0) * size;
        lens(&format!("{i}"), Shape::Sphere { center, radius }, &["greyscale"])
    };
    Scene { lenses: (0..count).map(one).collect(), ..scene.clone() }
}

/// A greyscale lens whose mask covers a tenth of a picture of `size` pixels.
///
/// # Errors
/// Drawing fails; a view of nothing.
pub fn with_lens(scene: &Scene, studio: &mut Studio, size: [u32; 2]) -> Result<Scene, RenderError> {
    let shape = sphere_covering(studio, scene, size, 0.1)?;
    Ok(Scene { lenses: vec![lens("lens", shape, &["greyscale"])], ..scene.clone() })
}

/// The effects of ten colour lenses, two of them neighbourhood filters.
const TEN: [&str; 10] =
    ["greyscale", "blur", "sepia", "invert", "darken", "brighten", "saturate", "posterise", "overlay", "blur"];

/// Ten lenses around the one of `lensed`, a fifth of its radius away, each over a tenth of the picture. All overlap.
///
/// # Errors
/// Drawing fails; a scene whose first lens is no sphere.
pub fn with_ten(lensed: &Scene, studio: &mut Studio, size: [u32; 2]) -> Result<Scene, RenderError> {
    let (center, radius) = sphere(lensed)
        .ok_or_else(|| RenderError::Scene("ten lenses stand around a sphere, and there is none".to_owned()))?;
    let plain = Scene { lenses: Vec::new(), ..lensed.clone() };
    let mut lenses = Vec::new();
    for (i, effect) in TEN.into_iter().enumerate() {
        let turn = std::f64::consts::TAU * i as f64 / TEN.len() as f64;
        let center = center + 0.2 * radius * DVec3::new(turn.cos(), turn.sin(), 0.0);
        let shape = sphere_around(studio, &plain, size, 0.1, center, 4.0 * radius)?;
        lenses.push(lens(effect, shape, &[effect]));
    }
    Ok(Scene { lenses, ..plain })
}

/// Centre and radius of the first lens, metres, where it is a sphere.
fn sphere(scene: &Scene) -> Option<(DVec3, f64)> {
    match scene.lenses.first()?.shapes.first()? {
        Region::Shape(Shape::Sphere { center, radius }) => Some((*center, *radius)),
        _ => None,
    }
}

/// Exactly translucent: every layer counts.
pub fn see_through() -> Vec<EffectUse> {
    lens("", Shape::Sphere { center: DVec3::ZERO, radius: 1.0 }, &["transparent"]).effects
}

/// The scene, seen through within its first lens.
pub fn see_through_lens(lensed: &Scene) -> Scene {
    let mut scene = lensed.clone();
    scene.lenses.truncate(1);
    scene.lenses.iter_mut().for_each(|lens: &mut Lens| lens.effects = see_through());
    scene
}

/// The scene, seen through everywhere.
pub fn see_through_city(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.style.effects = see_through();
    scene
}
