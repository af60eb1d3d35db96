//! Sun, sky, and the sun's own view of the city for its shadows.

use glam::{DVec2, DVec3};

use crate::{
    geom::Aabb,
    render::{eye::shadow_from_relative, layout, palette},
    scene::{Background, Sun},
    view::{Camera, Projection, View},
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

/// The sun's orthographic view of `receivers`, from beyond `casters`, of so many texels each way.
pub fn sun_view(sun: &Sun, receivers: &Aabb, casters: &Aabb, size: u32) -> Option<View> {
    let size = size.max(LEAST_SHADOW_SIZE);
    if receivers.is_empty() || casters.is_empty() {
        return None;
    }
    let direction = to_sun(sun);
    let center = receivers.center();
    let reach = casters.corners().into_iter().map(|c| (c - center).dot(direction)).fold(0.0, f64::max) + 10.0;
    let eye = center + direction * reach;
    let probe = Camera {
        eye,
        target: center,
        up: DVec3::Z,
        projection: Projection::Orthographic { height_m: 1.0 },
        near_m: 1.0,
    };
    let basis = probe.basis().ok()?;
    let half = receivers
        .corners()
        .into_iter()
        .fold(0.0_f64, |half, c| half.max((c - center).dot(basis.right).abs()).max((c - center).dot(basis.up).abs()));
    // A texel's width more on each side, so that filters never look past the border.
    let height_m = (2.0 * half * (1.0 + 4.0 / f64::from(size))).clamp(1.0, 1e7);
    let camera = Camera { projection: Projection::Orthographic { height_m }, ..probe };
    View::new(camera, [size; 2], &casters.union(*receivers)).ok()
}

/// The light block; `shadow` is the sun's view where there is a shadow map.
pub fn uniform(
    sun: &Sun,
    background: Background,
    shadow: Option<&View>,
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
    let matrix = shadow.map(|view| shadow_from_relative(view, eye));
    let texel = shadow.map_or(0.0, |view| view.pixel_m(1.0));
    layout::Light {
        to_sun: to_sun(sun).as_vec3().to_array(),
        shadow_texel: texel as f32,
        sun: sun_color,
        shadow_depth_step: shadow.map_or(1.0, |view| view.far_m - view.camera.near_m) as f32,
        sky: [0.335, 0.375, 0.43].map(|c| c * ambient),
        reserved_0: 0.0,
        ground: [0.20, 0.185, 0.165].map(|c| c * ambient),
        reserved_1: 0.0,
        shadow_from_relative: matrix.unwrap_or_default().as_mat4().to_cols_array_2d(),
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

    #[test]
    fn the_shadow_map_holds_all_receivers() {
        let sun = Sun::default();
        let receivers = Aabb { min: DVec3::new(8e4, 4e5, -3.0), max: DVec3::new(8.06e4, 4.004e5, 60.0) };
        let casters = Aabb { min: receivers.min - 500.0, max: receivers.max + 500.0 };
        let view = sun_view(&sun, &receivers, &casters, SHADOW_SIZE).unwrap();
        let matrix = shadow_from_relative(&view, receivers.min);
        for corner in receivers.corners() {
            let at = matrix.project_point3(corner - receivers.min);
            assert!(at.cmpge(DVec3::ZERO).all() && at.cmple(DVec3::ONE).all(), "{corner} lands at {at}");
        }
        for corner in casters.corners() {
            assert!(matrix.project_point3(corner - receivers.min).z <= 1.0, "{corner} is cut off");
        }
    }
}
