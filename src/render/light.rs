//! Sun and sky: from where the light of each sample of a picture comes.

use std::f64::consts::TAU;

use glam::{DMat4, DVec2, DVec3};

use crate::{
    city::ground::Fade,
    geom::Aabb,
    render::{layout, palette, sun_eye::SunEye},
    scene::{Background, SkyLight, StyleLook, Sun},
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

/// How high the sun must stand to cast shadows, radians. The part of a large disc that is lower counts as if it stood here.
const LEAST_ELEVATION: f64 = 0.01;
/// From which diameter on the sun's disc has a point of its own in each sample, radians: two degrees. Seen from far, a smaller one has the same for some
/// samples, at most so many: its borders of shadows are a few pixels wide, and the sun's map is drawn as often less. In a street they are wide, and would show as many steps.
const MANY_POINTS_RAD: f64 = 0.035;
const MOST_HELD: u32 = 4;
/// A turn of the golden angle, as a part of a whole one.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Whether a sun can cast shadows: it must stand above the horizon.
pub fn casts_shadows(sun: &Sun) -> bool {
    sun.shadows && sun.elevation > LEAST_ELEVATION
}

/// Whether the city hides parts of the sky from itself.
pub fn hides_sky(sun: &Sun) -> bool {
    sun.shadows && sun.ambient_occlusion
}

/// Whether the samples of a picture of so many show it, each from another point of the sky.
pub fn occludes_sky(sun: &Sun, samples: u32) -> bool {
    hides_sky(sun) && samples > 1
}

/// From where the light of one sample comes, units towards it: the mean over all samples of a picture is that of the whole disc of the sun and
/// of the whole sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// A point of the sun's disc; of a picture of one sample its middle.
    pub to_sun: DVec3,
    /// A point of the sky, where its shadows are wanted.
    pub sky: Option<SkyPoint>,
}

/// A point of the sky, and for how much of it it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyPoint {
    /// Unit, towards it.
    pub to: DVec3,
    /// The solid angle that it stands for, over π and over the share of the samples: the mean of `weight · max(n · to, 0)` over all samples
    /// is the share of all that may fall on a surface with the normal n.
    pub weight: f64,
    /// How far around it the filter of its map looks, as a tangent: half of that of half the angle of a cone of that solid angle. The more samples,
    /// the smaller.
    pub spread: f64,
}

/// The points of the sky of a picture of `n` samples. Their density is half uniform and half that of the cosine to the zenith, so that
/// ground and roofs converge as walls do: (1 + 2 z) / 4π for each solid angle, z the cosine. A few points are no whole sky: their weights
/// are changed, by as little as does it, until all their means of polynomials of the second degree are those of the sky. What falls on a
/// matt surface depends on little else (Ramamoorthi and Hanrahan 2001): no wall is lighter because of where the points happen to be.
fn sky_points(n: u32) -> Vec<SkyPoint> {
    let of_sky = |i: u32| {
        let p = on_spiral(i, n, 0.303);
        let z = 0.5 * ((1.0 + 8.0 * p.x).sqrt() - 1.0);
        let (sin, cos) = (TAU * p.y).sin_cos();
        let level = (1.0 - z * z).max(0.0).sqrt();
        SkyPoint { to: DVec3::new(level * cos, level * sin, z), weight: 4.0 / (1.0 + 2.0 * z), spread: 0.0 }
    };
    let mut points: Vec<SkyPoint> = (0..n).map(of_sky).collect();
    let terms = |DVec3 { x, y, z }: DVec3| [1.0, x, y, z, x * y, y * z, z * x, x * x - y * y, z * z];
    // Integrals over the upper hemisphere, over π.
    let wanted = [2.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 2.0 / 3.0];
    // Factors 1 + Σ f · terms of all weights, with as many conditions: a symmetric system.
    let mut system = [[0.0; TERMS + 1]; TERMS];
    for point in &points {
        let (own, weight) = (terms(point.to), point.weight / f64::from(n));
        for (row, a) in system.iter_mut().zip(own) {
            row.iter_mut().zip(own).for_each(|(sum, b)| *sum += weight * a * b);
            row[TERMS] -= weight * a;
        }
    }
    for (i, row) in system.iter_mut().enumerate() {
        // Of fewer points than conditions these are met as nearly as may be.
        row[i] += 1e-9;
        row[TERMS] += wanted[i];
    }
    let factors = solved(system);
    for point in &mut points {
        let change: f64 = terms(point.to).iter().zip(factors).map(|(term, factor)| term * factor).sum();
        point.weight *= (1.0 + change).max(0.0);
        // 2 π (1 - cos) = π · weight / n. As wide as the whole cone, filters reach around corners, and errors grow again.
        let cosine = 1.0 - 0.5 * point.weight / f64::from(n);
        point.spread = 0.5 * if cosine > 0.0 { (1.0 / (cosine * cosine) - 1.0).sqrt().min(1.0) } else { 1.0 };
    }
    points
}

/// How many means of a sky's points are set right.
const TERMS: usize = 9;

/// The solution of a positive definite system, whose last column is its right side.
fn solved(mut system: [[f64; TERMS + 1]; TERMS]) -> [f64; TERMS] {
    for i in 0..TERMS {
        let pivot = system[i];
        for (k, row) in system.iter_mut().enumerate() {
            let factor = row[i] / pivot[i];
            if k != i {
                row.iter_mut().zip(pivot).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    std::array::from_fn(|i| system[i][TERMS] / system[i][i])
}

/// The place of sample `i` in an order in which the first of them are spread over all `n` already; `stride`: a part of 1, which tells orders
/// apart.
fn place_in_order(i: u32, n: u32, stride: f64) -> u32 {
    let (i, n) = (u64::from(i), u64::from(n.max(1)));
    let common = |mut a: u64, mut b: u64| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let first = ((n as f64 * stride) as u64).max(1);
    let step = (first..first + n).find(|&step| common(step, n) == 1).unwrap_or(1);
    (i * step % n) as u32
}

/// Sample `i` of `n` as a point of the unit square that is the golden spiral's, in an order of its own.
fn on_spiral(i: u32, n: u32, stride: f64) -> DVec2 {
    let place = f64::from(place_in_order(i, n, stride));
    DVec2::new((place + 0.5) / f64::from(n.max(1)), (place * GOLDEN).fract())
}

impl LightSample {
    /// That of sample `i` of `n`. `is_near`: whether the picture shows something much nearer than the rest.
    pub fn new(sun: &Sun, i: u32, n: u32, is_near: bool) -> Self {
        let middle = to_sun(sun);
        let of_disc = || {
            // A small disc needs fewer points, and each that is new a new map.
            let held = if is_near { 1 } else { ((MANY_POINTS_RAD / sun.size) as u32).clamp(1, MOST_HELD) };
            let p = on_spiral(i / held, n.div_ceil(held), 0.438);
            let (sin, cos) = (TAU * p.y).sin_cos();
            let (aside, up) = middle.any_orthonormal_pair();
            let radius = (0.5 * sun.size).tan() * p.x.sqrt();
            let to = (middle + radius * (cos * aside + sin * up)).normalize_or(middle);
            if sun.elevation <= LEAST_ELEVATION || to.z >= LEAST_ELEVATION {
                return to;
            }
            (to.truncate().normalize_or(DVec2::X) * LEAST_ELEVATION.cos()).extend(LEAST_ELEVATION.sin())
        };
        Self {
            to_sun: if n > 1 && sun.size > 0.0 { of_disc() } else { middle },
            sky: occludes_sky(sun, n).then(|| sky_points(n)[i as usize % n as usize]),
        }
    }
}

/// How a map of depth from a light is read.
struct MapReading {
    across: DMat4,
    scale: f32,
    depth_step: f32,
    levels: f32,
}

impl MapReading {
    fn of(map: Option<&SunEye>, eye: DVec3) -> Self {
        Self {
            across: map.map(|map| map.across_from_relative(eye)).unwrap_or_default(),
            scale: map.map_or(0.0, SunEye::scale) as f32,
            depth_step: map.map_or(1.0, SunEye::depth_step_m) as f32,
            levels: map.map_or(0, SunEye::packed) as f32,
        }
    }
}

/// What is around a city.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surround {
    /// Whose light it has.
    pub look: StyleLook,
    /// What is behind it.
    pub background: Background,
    /// How its plain ground fades, where it has one.
    pub fade: Option<Fade>,
}

/// The light block; `maps`: the eyes of sun and sky where there is a map of what they see.
pub fn uniform(
    sun: &Sun,
    light: &LightSample,
    around: &Surround,
    maps: [Option<&SunEye>; 2],
    eye: DVec3,
    scene_radius: f64,
) -> layout::Light {
    let Surround { look, background, fade } = *around;
    let SkyLight { sun: direct, sky, ground, zenith, horizon } = *look.light();
    // Below the horizon only a blue dusk is left.
    let day = ((sun.elevation.to_degrees() + 4.0) / 10.0).clamp(0.0, 1.0) as f32;
    // Low sun is warm.
    let warmth = (1.0 - (sun.elevation.to_degrees() / 25.0).clamp(0.0, 1.0)) as f32;
    let warm = [1.0, 1.0 - 0.232 * warmth, 1.0 - 0.488 * warmth];
    let sun_color: [f32; 3] = std::array::from_fn(|c| direct[c] * warm[c] * day);
    let ambient = 0.25 + 0.75 * day;
    let zenith = match background {
        Background::Color(srgb) => palette::linear(srgb),
        Background::Sky => palette::linear(zenith).map(|c| c * ambient),
    };
    let [shadow, of_sky] = maps.map(|map| MapReading::of(map, eye));
    layout::Light {
        to_sun: light.to_sun.as_vec3().to_array(),
        shadow_scale: shadow.scale,
        sun: sun_color,
        shadow_depth_step: shadow.depth_step,
        sky: sky.map(|c| c * ambient),
        shadow_levels: shadow.levels,
        ground: ground.map(|c| c * ambient),
        fade_width: fade.map_or(1.0, |fade| fade.width) as f32,
        sun_from_relative: shadow.across.as_mat4().to_cols_array_2d(),
        zenith,
        reserved_2: 0,
        horizon: palette::linear(horizon).map(|c| c * ambient),
        scene_radius: scene_radius as f32,
        to_sky: light.sky.map_or(DVec3::Z, |sky| sky.to).as_vec3().to_array(),
        sky_scale: of_sky.scale,
        sky_depth_step: of_sky.depth_step,
        sky_levels: of_sky.levels,
        sky_weight: light.sky.map_or(1.0, |sky| sky.weight) as f32,
        sky_spread: light.sky.map_or(0.0, |sky| sky.spread) as f32,
        sky_from_relative: of_sky.across.as_mat4().to_cols_array_2d(),
        fade: fade.map_or([0.0; 4], |fade| {
            let middle = (fade.middle - eye.truncate()).as_vec2();
            [middle.x, middle.y, fade.half.x as f32, fade.half.y as f32]
        }),
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
            to_sun(&Sun { azimuth: azimuth.to_radians(), elevation: elevation.to_radians(), ..Sun::default() })
        };
        assert!(at(0.0, 0.0).abs_diff_eq(DVec3::Y, 1e-12));
        assert!(at(90.0, 0.0).abs_diff_eq(DVec3::X, 1e-12));
        assert!(at(123.0, 90.0).abs_diff_eq(DVec3::Z, 1e-12));
    }

    fn of_all(sun: &Sun, n: u32) -> impl Iterator<Item = LightSample> {
        (0..n).map(move |i| LightSample::new(sun, i, n, false))
    }

    #[test]
    fn one_sample_sees_the_middle_of_the_sun_and_all_of_the_sky() {
        let sun = Sun { size: 0.3, ..Sun::default() };
        assert_eq!(LightSample::new(&sun, 0, 1, false), LightSample { to_sun: to_sun(&sun), sky: None });
        for sun in [Sun { shadows: false, ..sun }, Sun { ambient_occlusion: false, ..sun }] {
            assert!(of_all(&sun, 16).all(|light| light.sky.is_none()));
        }
        let point = Sun { size: 0.0, ..sun };
        assert!(of_all(&point, 16).all(|light| light.to_sun == to_sun(&point)));
    }

    #[test]
    fn points_of_a_small_sun_are_shared_where_all_is_far() {
        let sun = Sun::default();
        let points = |is_near: bool| {
            let mut all: Vec<DVec3> = (0..16).map(|i| LightSample::new(&sun, i, 16, is_near).to_sun).collect();
            all.dedup();
            all.len()
        };
        assert_eq!([points(false), points(true)], [6, 16]);
    }

    #[test]
    fn orders_have_every_place_once() {
        for n in 1..200 {
            for stride in [0.303, 0.438] {
                let mut places: Vec<u32> = (0..n).map(|i| place_in_order(i, n, stride)).collect();
                places.sort_unstable();
                assert!(places.into_iter().eq(0..n), "{n}, {stride}");
            }
        }
    }

    #[test]
    fn points_of_the_sun_are_spread_evenly_over_its_disc() {
        for (elevation, n) in [(0.8, 16), (1.57, 64), (0.2, 256), (0.3, 1024)] {
            let sun = Sun { elevation, size: 0.2, ..Sun::default() };
            let middle = to_sun(&sun);
            let tan = |light: LightSample| (light.to_sun / light.to_sun.dot(middle) - middle).length() / 0.1_f64.tan();
            assert!(of_all(&sun, n).all(|light| (light.to_sun.length() - 1.0).abs() < 1e-12 && tan(light) <= 1.0));
            // The mean of the squared radius of a disc is half of its own squared.
            let squared = of_all(&sun, n).map(|light| tan(light).powi(2)).sum::<f64>() / f64::from(n);
            assert!((squared - 0.5).abs() < 1e-9, "{n}: {squared}");
            let mean =
                of_all(&sun, n).map(|light| light.to_sun / light.to_sun.dot(middle)).sum::<DVec3>() / f64::from(n);
            assert!(mean.distance(middle) < 0.1 * 2.0 / f64::from(n), "{n}: {mean}");
        }
        // A disc half below the horizon still throws its shadows from above it.
        let low = Sun { elevation: 0.02, size: 0.3, ..Sun::default() };
        assert!(of_all(&low, 64).all(|light| light.to_sun.z >= LEAST_ELEVATION.sin() - 1e-12));
    }

    /// The mean over the samples of what falls on a surface without anything before it is what the whole sky gives: (1 + n.z) / 2.
    #[test]
    fn an_open_sky_gives_what_it_gives_without_samples() {
        let turned = |k: u32, height: f64| {
            let (sin, cos) = (f64::from(k) * 0.7).sin_cos();
            let level = (1.0 - height * height).sqrt();
            DVec3::new(level * cos, level * sin, height)
        };
        let mut worst = Vec::new();
        for n in [4, 8, 16, 64, 256, 1024] {
            let points: Vec<SkyPoint> = of_all(&Sun::default(), n).filter_map(|light| light.sky).collect();
            assert_eq!(points.len(), n as usize);
            let mean = |normal: DVec3| {
                points.iter().map(|sky| sky.weight * normal.dot(sky.to).max(0.0)).sum::<f64>() / f64::from(n)
            };
            let off = |normal: DVec3| (mean(normal) - (0.5 + 0.5 * normal.z)).abs();
            let all =
                [1.0, 0.7, 0.3, 0.0, -0.4, -1.0].into_iter().flat_map(|height| (0..9).map(move |k| turned(k, height)));
            worst.push((n, all.map(off).fold(0.0, f64::max), off(DVec3::Z)));
        }
        // Seen: 0.195, 0.084, 0.024, 0.0038, 0.0011, 0.00023; and of what lies level, from as many points as conditions on, nothing.
        for (n, any, up) in &worst {
            let is_enough = *n > TERMS as u32;
            let most = if is_enough { [0.4 / f64::from(*n), 1e-7] } else { [0.8 / f64::from(*n), 0.1] };
            assert!(*any < most[0] && *up < most[1], "{worst:?}");
        }
    }
}
