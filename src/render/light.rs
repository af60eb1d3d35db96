//! Sun and sky.

use glam::{DVec2, DVec3};

use crate::{
    geom::Aabb,
    render::{layout, palette, sun_eye::SunEye},
    scene::{Background, Sun},
};

/// Texels along a side of the shadow map, unless [`crate::render::settings::Settings`] say otherwise.
pub const SHADOW_SIZE: u32 = 4096;
/// The fewest that it can have.
pub const LEAST_SHADOW_SIZE: u32 = 256;

/// Direction to the sun, unit: azimuth clockwise from north, elevation above the horizon.
pub fn to_sun(sun: &Sun) -> DVec3 {
    let (sin_a, cos_a) = sun.azimuth.sin_cos();
    let (sin_e, cos_e) = sun.elevation.sin_cos();
    DVec3::new(sin_a * cos_e, cos_a * cos_e, sin_e)
}

/// Whether a sun can cast shadows: it must stand above the horizon.
pub fn casts_shadows(sun: &Sun) -> bool {
    sun.shadows && sun.elevation > 0.01
}

/// The light block; `shadow` is the sun's eye where there is a shadow map.
pub fn uniform(
    sun: &Sun,
    background: Background,
    shadow: Option<&SunEye>,
    eye: DVec3,
    scene_radius: f64,
) -> layout::Light {
    // Below the horizon only a blue dusk is left.
    let day = ((sun.elevation.to_degrees() + 4.0) / 10.0).clamp(0.0, 1.0) as f32;
    // Low sun is warm.
    let warmth = (1.0 - (sun.elevation.to_degrees() / 25.0).clamp(0.0, 1.0)) as f32;
    let sun_color = [0.86, 0.86 * (0.95 - 0.22 * warmth), 0.86 * (0.86 - 0.42 * warmth)].map(|c: f32| c * day);
    let ambient = 0.25 + 0.75 * day;
    let zenith = match background {
        Background::Color(srgb) => palette::linear(srgb),
        Background::Sky => palette::linear([0.57, 0.70, 0.84]).map(|c| c * ambient),
    };
    let across = shadow.map(|sun| sun.across_from_relative(eye));
    layout::Light {
        to_sun: to_sun(sun).as_vec3().to_array(),
        shadow_scale: shadow.map_or(0.0, SunEye::scale) as f32,
        sun: sun_color,
        shadow_depth_step: shadow.map_or(1.0, SunEye::depth_step_m) as f32,
        sky: [0.335, 0.375, 0.43].map(|c| c * ambient),
        shadow_levels: shadow.map_or(0, SunEye::packed) as f32,
        ground: [0.20, 0.185, 0.165].map(|c| c * ambient),
        reserved_1: 0.0,
        sun_from_relative: across.unwrap_or_default().as_mat4().to_cols_array_2d(),
        zenith,
        reserved_2: 0,
        horizon: palette::linear([0.90, 0.925, 0.94]).map(|c| c * ambient),
        scene_radius: scene_radius as f32,
    }
}

/// Half the diagonal of a box in plan, metres, at least one.
pub fn radius_of(bounds: &Aabb) -> f64 {
    let size = bounds.size();
    (0.5 * DVec2::new(size.x, size.y).length()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_stands_where_it_is_said_to() {
        let at = |azimuth: f64, elevation: f64| {
            to_sun(&Sun { azimuth: azimuth.to_radians(), elevation: elevation.to_radians(), shadows: true })
        };
        assert!(at(0.0, 0.0).abs_diff_eq(DVec3::Y, 1e-12));
        assert!(at(90.0, 0.0).abs_diff_eq(DVec3::X, 1e-12));
        assert!(at(123.0, 90.0).abs_diff_eq(DVec3::Z, 1e-12));
    }
}
