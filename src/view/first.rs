//! The first view, where none is given: an oblique one that fills the picture with the city.

use glam::{DVec2, DVec3};

use crate::{
    geom::Aabb,
    view::{
        basis::Basis,
        camera::{Camera, Projection, default_near_m},
    },
};

/// Vertical field of view, radians: wide enough for depth, narrow enough for upright walls.
const FOV_Y: f64 = 40.0 * std::f64::consts::PI / 180.0;
/// The angle by which the view looks down, radians.
const DOWN: f64 = 33.0 * std::f64::consts::PI / 180.0;
/// Where the eye stands, radians clockwise from north: south-east and south-west, where northern suns light facades.
const AZIMUTHS: [f64; 2] = [150.0 * std::f64::consts::PI / 180.0, 210.0 * std::f64::consts::PI / 180.0];
/// Part of the picture's half width and height the city may fill.
const FILL: f64 = 0.94;
/// Smallest thing worth a whole picture, metres.
const SMALLEST_M: f64 = 6.0;

/// A good first view of an unknown city on a picture `aspect` times as wide as high.
///
/// `boxes` are the boxes of the buildings (or of whatever matters), `extent` that of everything; without boxes the
/// extent is framed. The frame is the tightest one that holds the boxes, less the few that stand far from all others.
pub fn first_view(extent: &Aabb, boxes: &[Aabb], aspect: f64) -> Camera {
    let kept = without_outliers(boxes);
    let whole = kept.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
    let whole = if whole.is_empty() { *extent } else { whole };
    let whole =
        if whole.is_empty() || !whole.size().is_finite() { Aabb { min: DVec3::ZERO, max: DVec3::ZERO } } else { whole };
    let mut points: Vec<DVec3> = kept.iter().flat_map(Aabb::corners).collect();
    if points.is_empty() || whole.size().max_element() < SMALLEST_M {
        let half = (0.5 * whole.size()).max(DVec3::splat(0.5 * SMALLEST_M));
        points = Aabb { min: whole.center() - half, max: whole.center() + half }.corners().to_vec();
    }
    let tan = FILL * DVec2::new((0.5 * FOV_Y).tan() * aspect.clamp(0.05, 20.0).max(0.05), (0.5 * FOV_Y).tan());
    let candidates = AZIMUTHS.map(|azimuth| fitted(&points, whole.center(), azimuth, tan));
    let distance = |c: &Camera| c.eye.distance(c.target);
    // The nearer eye shows the city larger; the south-east wins a draw (its east walls lie in the sun's shade: relief).
    if distance(&candidates[1]) < 0.98 * distance(&candidates[0]) { candidates[1] } else { candidates[0] }
}

/// The nearest eye from which all `points` fit, looking down from `azimuth`.
///
/// In the axes of the eye a point (r, u, d) fits the width iff |r − eye.r| ≤ tan·(d − eye.d): with
/// A = min(d·tan − r), B = min(d·tan + r) the deepest eye is eye.d = (A+B)/(2·tan) at eye.r = (B−A)/2.
fn fitted(points: &[DVec3], center: DVec3, azimuth: f64, tan: DVec2) -> Camera {
    let forward = DVec3::new(-azimuth.sin() * DOWN.cos(), -azimuth.cos() * DOWN.cos(), -DOWN.sin());
    let basis = Basis::looking_along(forward, DVec3::Z);
    let side = |axis: DVec3, tan: f64| {
        let (mut a, mut b) = (f64::INFINITY, f64::INFINITY);
        for p in points {
            let (s, d) = ((*p - center).dot(axis), (*p - center).dot(forward));
            a = a.min(d * tan - s);
            b = b.min(d * tan + s);
        }
        (0.5 * (b - a), 0.5 * (a + b) / tan)
    };
    let (right, deepest_x) = side(basis.right, tan.x);
    let (up, deepest_y) = side(basis.up, tan.y);
    let eye = center + right * basis.right + up * basis.up + deepest_x.min(deepest_y) * forward;
    // Whole centimetres: the numbers are read and edited by people.
    let eye = (100.0 * eye).round() / 100.0;
    let reach = (center - eye).dot(forward).max(1.0);
    let target = (100.0 * (eye + reach * forward)).round() / 100.0;
    let near_m = default_near_m(eye.distance(target));
    Camera { eye, target, up: DVec3::Z, projection: Projection::Perspective { fov_y: FOV_Y }, near_m }
}

/// The boxes whose middle lies within the middle 98 % of all middles, widened by half that range and 50 m per axis.
fn without_outliers(boxes: &[Aabb]) -> Vec<Aabb> {
    let mut kept: Vec<Aabb> = boxes.iter().filter(|b| !b.is_empty() && b.size().is_finite()).copied().collect();
    if kept.len() < 8 {
        return kept;
    }
    let range = |axis: usize| {
        let mut middles: Vec<f64> = kept.iter().map(|b| b.center()[axis]).collect();
        middles.sort_unstable_by(f64::total_cmp);
        let cut = (middles.len() / 100).max(1);
        let (low, high) = (middles[cut], middles[middles.len() - 1 - cut]);
        let wider = 0.5 * (high - low) + 50.0;
        (low - wider, high + wider)
    };
    let ranges = [range(0), range(1), range(2)];
    kept.retain(|b| (0..3).all(|axis| (ranges[axis].0..=ranges[axis].1).contains(&b.center()[axis])));
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::project::View;

    fn grid(n: i32, pitch: f64) -> Vec<Aabb> {
        let at = |i: i32, j: i32| DVec3::new(80_000.0 + pitch * f64::from(i), 450_000.0 + pitch * f64::from(j), 2.0);
        (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .map(|(i, j)| Aabb { min: at(i, j), max: at(i, j) + 10.0 })
            .collect()
    }

    /// Smallest and largest pixel coordinate of the boxes, as a part of the picture.
    fn framed(camera: Camera, size: [u32; 2], boxes: &[Aabb]) -> (DVec2, DVec2) {
        let view = View::new(camera, size, &Aabb::EMPTY).unwrap();
        let scale = DVec2::new(size[0].into(), size[1].into());
        boxes.iter().flat_map(Aabb::corners).fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            let at = view.pixel(p).expect("in front of the eye").truncate() / scale;
            (low.min(at), high.max(at))
        })
    }

    #[test]
    fn everything_is_in_the_picture_and_fills_it() {
        for (n, pitch) in [(1, 1.0), (3, 15.0), (30, 30.0), (100, 100.0)] {
            for size in [[1280, 720], [720, 1280], [500, 500]] {
                let boxes = grid(n, pitch);
                let extent = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
                let camera = first_view(&extent, &boxes, f64::from(size[0]) / f64::from(size[1]));
                let (low, high) = framed(camera, size, &boxes);
                assert!(low.min_element() >= 0.0 && high.max_element() <= 1.0, "{n} {size:?}: {low} {high}");
                assert!((high - low).max_element() > 0.8, "{n} {size:?}: fills only {}", high - low);
                assert!(
                    camera.eye.y < camera.target.y && camera.eye.z > camera.target.z,
                    "from the south, looking down"
                );
            }
        }
    }

    #[test]
    fn one_shed_far_away_does_not_shrink_the_city() {
        let boxes = grid(20, 20.0);
        let mut with_shed = boxes.clone();
        with_shed.push(Aabb { min: DVec3::ZERO, max: DVec3::splat(3.0) });
        let extent = with_shed.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
        let camera = first_view(&extent, &with_shed, 1.5);
        let (low, high) = framed(camera, [1500, 1000], &boxes);
        assert!((high - low).max_element() > 0.8, "{low} {high}");
    }

    #[test]
    fn nothing_still_has_a_view() {
        assert!(first_view(&Aabb::EMPTY, &[], 1.6).check().is_ok());
        assert!(first_view(&Aabb { min: DVec3::ZERO, max: DVec3::ZERO }, &[], f64::NAN).check().is_ok());
    }
}
