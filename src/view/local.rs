//! Cameras of best-view lenses that go by the main eye (Trapp §3.4.1); those that go by an object are [`crate::view::framing::Framing`]s.
//!
//! All of them look along a line that the caller gives, at a field of view that the caller gives; what is decided here is where they
//! stand and what is up in them.

use glam::{DVec2, DVec3};

use crate::view::camera::{Camera, Projection, default_near_m};

/// The largest sine of the angle between sights of a camera and the eye plane that counts as level.
const LEVEL: f64 = 1e-9;
/// The distance of the target of a level camera from the eye, metres.
const LEVEL_REACH_M: f64 = 50.0;

/// A camera `distance_m` from the viewer along `normal` that looks at the viewer (multiple centres of projection).
pub fn towards_viewer(viewer: &Camera, normal: DVec3, distance_m: f64, fov_y: f64) -> Camera {
    let normal = normal.normalize_or(DVec3::Z);
    let eye = viewer.eye + distance_m * normal;
    Camera {
        eye,
        target: viewer.eye,
        up: upright(normal, viewer),
        projection: Projection::Perspective { fov_y },
        near_m: default_near_m(distance_m),
    }
}

/// A camera in the viewer's eye that looks along `direction` (single centre of projection); the viewer's up.
pub fn from_viewer(viewer: &Camera, direction: DVec3, fov_y: f64) -> Camera {
    let reach = viewer.eye.distance(viewer.target).max(1.0);
    Camera {
        target: viewer.eye + reach * direction.normalize_or(forward(viewer)),
        projection: Projection::Perspective { fov_y },
        ..*viewer
    }
}

/// A direction given on the viewer's axes - x to the right of its picture, y to its top, z out of it towards the eye - on the model's.
pub fn of_viewer(viewer: &Camera, direction: DVec3) -> DVec3 {
    viewer
        .basis()
        .map_or(direction, |basis| direction.x * basis.right + direction.y * basis.up - direction.z * basis.forward)
}

/// A map: what lies around `centre` seen straight from above, `height_m` metres of ground from its lower to its upper border, with `heading`
/// (in plan, any length but 0) towards its top. It stands `above_m` metres over the centre.
pub fn map(centre: DVec3, heading: DVec2, height_m: f64, above_m: f64) -> Camera {
    Camera {
        eye: centre + above_m * DVec3::Z,
        target: centre,
        up: heading.normalize_or(DVec2::Y).extend(0.0),
        projection: Projection::Orthographic { height_m },
        near_m: default_near_m(above_m),
    }
}

/// The middle of a map that follows an eye lazily: that of before, moved no further than it takes for the eye to be within `reach` of it.
pub fn followed(before: DVec2, eye: DVec2, reach: f64) -> DVec2 {
    let away = eye - before;
    let distance = away.length();
    if distance <= reach { before } else { eye - away * (reach / distance) }
}

/// Where a fisheye shows a place: both as shares of the way from the middle to where it ends, of length 0..1. The middle becomes
/// `magnification` times larger (Sarkar and Brown's (d + 1) r / (d r + 1), d = magnification − 1).
pub fn fisheye(place: DVec2, magnification: f64) -> DVec2 {
    let d = magnification - 1.0;
    place * ((d + 1.0) / (d * place.length() + 1.0))
}

/// The place that a fisheye shows there: the inverse of [`fisheye`], which the shader of overlays has too.
pub fn unfisheye(shown: DVec2, magnification: f64) -> DVec2 {
    shown / (1.0 + (magnification - 1.0) * (1.0 - shown.length().min(1.0)))
}

/// A camera behind and above `at`, which it looks at, where `heading` (in plan, of length 1) is ahead: `distance_m` ≥ 0 behind it and
/// `height_m` above. Straight above it the heading is at its top.
pub fn behind(at: DVec3, heading: DVec2, distance_m: f64, height_m: f64, fov_y: f64) -> Camera {
    let eye = at - distance_m * heading.extend(0.0) + height_m * DVec3::Z;
    let up = if distance_m > 1e-6 * height_m.abs() { DVec3::Z } else { heading.extend(0.0) };
    Camera { up, ..Camera::looking(eye, at, fov_y) }
}

/// A level camera at `at` that looks `azimuth` radians clockwise from `heading`, in plan.
pub fn level(at: DVec3, heading: DVec2, azimuth: f64, fov_y: f64) -> Camera {
    let along = heading.rotate(DVec2::from_angle(-azimuth));
    Camera::looking(at, at + LEVEL_REACH_M * along.extend(0.0), fov_y)
}

/// Where something is headed, in plan, of length 1, that moves so; `None`: it does not move, or straight up or down.
pub fn level_heading(direction: DVec3) -> Option<DVec2> {
    Some(direction.truncate())
        .filter(|level| level.length() > LEVEL * direction.length())
        .and_then(DVec2::try_normalize)
}

/// Where a viewer is headed, in plan, of length 1: along its view; looking straight down or up, to the top of its picture. North, where
/// neither says anything.
pub fn heading(viewer: &Camera) -> DVec2 {
    let Ok(basis) = viewer.basis() else { return DVec2::Y };
    let (ahead, top) = (basis.forward.truncate(), basis.up.truncate());
    // Looking down the top of the picture lies ahead, looking up it lies behind.
    let level = if ahead.length() > LEVEL { ahead } else { top * -basis.forward.z.signum() };
    level.normalize_or(DVec2::Y)
}

/// The upward direction in a camera that looks against `normal`, a unit vector, for a viewer that looks along f with u up: (I − n nᵀ)(f − (f·n) u), normalised.
/// It turns evenly while the normal goes from behind the viewer over its head, and is the viewer's own up where the camera looks the same
/// way. From two directions below the viewer this is 0: there the viewer's right is taken for up.
pub fn upright(normal: DVec3, viewer: &Camera) -> DVec3 {
    let Ok(basis) = viewer.basis() else { return DVec3::Z };
    let ahead = basis.forward - basis.forward.dot(normal) * basis.up;
    let across = |v: DVec3| v - v.dot(normal) * normal;
    across(ahead).try_normalize().filter(|_| across(ahead).length() > LEVEL).unwrap_or(basis.right)
}

fn forward(viewer: &Camera) -> DVec3 {
    (viewer.target - viewer.eye).normalize_or(DVec3::Y)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, TAU};

    use proptest::prelude::*;

    use super::*;
    use crate::{geom::Aabb, view::project::View};

    fn viewers() -> impl Strategy<Value = Camera> {
        let unit = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from);
        (unit(), unit(), unit()).prop_filter_map("a direction", |(eye, along, up)| {
            let along = along.try_normalize().filter(|a| a.cross(up).length() > 1e-2)?;
            let eye = 1e5 * eye;
            Some(Camera { up, ..Camera::looking(eye, eye + 50.0 * along, 0.8) })
        })
    }

    fn units() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64)
            .prop_filter_map("a direction", |v| DVec3::from(v).try_normalize().filter(|v| v.is_normalized()))
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn up_is_across_the_view_and_never_undefined(viewer in viewers(), normal in units()) {
            let up = upright(normal, &viewer);
            prop_assert!(up.is_normalized() && (up.dot(normal).abs() < 1e-6 || up == viewer.basis().unwrap().right), "{up}");
            prop_assert!(towards_viewer(&viewer, normal, 80.0, 0.7).basis().is_ok());
        }

        #[test]
        fn directions_of_the_viewer_keep_their_length_and_angles(viewer in viewers(), a in units(), b in units()) {
            let [wa, wb] = [a, b].map(|d| of_viewer(&viewer, d));
            prop_assert!((wa.dot(wb) - a.dot(b)).abs() < 1e-9);
            let ahead = of_viewer(&viewer, -DVec3::Z);
            prop_assert!((ahead - forward(&viewer)).length() < 1e-9);
            let back = from_viewer(&viewer, -ahead, 0.7);
            prop_assert!((forward(&back) + ahead).length() < 1e-9 && back.eye == viewer.eye);
        }
    }

    /// From behind, over the head, to the front: no step turns up by more than a few times what the normal turns by.
    #[test]
    fn up_turns_evenly_over_the_viewers_head() {
        let viewer = Camera::looking(DVec3::ZERO, DVec3::Y, 0.8);
        let normal = |i: i32| {
            let angle = std::f64::consts::PI * f64::from(i) / 1000.0;
            DVec3::new(0.0, -angle.cos(), angle.sin())
        };
        let up = |i: i32| upright(normal(i), &viewer);
        assert!((up(0) - DVec3::Z).length() < 1e-12, "looking the same way: the viewer's up");
        assert!((up(500) - DVec3::Y).length() < 1e-12, "from above: ahead is up");
        assert!((up(1000) + DVec3::Z).length() < 1e-12, "as a loop goes on");
        assert!((1..=1000).all(|i| up(i).distance(up(i - 1)) < 0.01));
    }

    /// Where the rule says nothing: c² = (√5 − 1) / 2 (f − c u) is along the normal.
    #[test]
    fn up_is_defined_where_its_rule_is_not() {
        let viewer = Camera::looking(DVec3::ZERO, DVec3::Y, 0.8);
        let c = (0.5 * (5.0_f64.sqrt() - 1.0)).sqrt();
        let normal = DVec3::new(0.0, 1.0, -c).normalize_or(DVec3::Y);
        assert_eq!(upright(normal, &viewer), DVec3::X);
        assert!(towards_viewer(&viewer, normal, 10.0, 0.5).basis().is_ok());
    }

    #[test]
    fn headings_are_in_plan() {
        let looking = |target: DVec3, up: DVec3| Camera { up, ..Camera::looking(DVec3::ZERO, target, 0.8) };
        let near =
            |camera: Camera, to: DVec2| assert!((heading(&camera) - to).length() < 1e-12, "{}", heading(&camera));
        near(looking(DVec3::new(1.0, 0.0, -7.0), DVec3::Z), DVec2::X);
        near(looking(-DVec3::Z, DVec3::new(0.0, -1.0, 0.0)), -DVec2::Y);
        near(looking(DVec3::Z, DVec3::new(0.0, -1.0, 0.0)), DVec2::Y);
        near(looking(-DVec3::Z, DVec3::Z), DVec2::Y);
    }

    #[test]
    fn a_lazy_map_follows_no_further_than_it_must() {
        let at = DVec2::new;
        assert_eq!(followed(at(10.0, 20.0), at(40.0, 60.0), 50.0), at(10.0, 20.0), "just within");
        assert_eq!(followed(at(10.0, 20.0), at(40.0, 60.0), 25.0), at(25.0, 40.0), "halfway");
        assert_eq!(followed(at(10.0, 20.0), at(40.0, 60.0), 0.0), at(40.0, 60.0));
        assert_eq!(followed(at(10.0, 20.0), at(10.0, 20.0), 0.0), at(10.0, 20.0));
    }

    #[test]
    fn a_fisheye_magnifies_its_middle_and_keeps_its_border() {
        for magnification in [1.0, 1.5, 4.0] {
            for i in 0..=100 {
                let place = DVec2::from_angle(0.7) * f64::from(i) / 100.0;
                let shown = fisheye(place, magnification);
                assert!((unfisheye(shown, magnification) - place).length() < 1e-12);
                assert!(shown.length() <= 1.0 + 1e-12);
            }
            let near = 1e-6;
            assert!((fisheye(DVec2::X * near, magnification).x / near - magnification).abs() < 1e-4);
            assert!((fisheye(DVec2::X, magnification) - DVec2::X).length() < 1e-12);
        }
    }

    #[test]
    fn maps_show_their_heading_upwards_and_metres_as_asked() {
        for i in 0..16 {
            let to = DVec2::from_angle(TAU * f64::from(i) / 16.0);
            let centre = DVec3::new(85_000.0, 446_000.0, 2.0);
            let view = View::new(map(centre, 3.0 * to, 200.0, 500.0), [300, 200], &Aabb::EMPTY).unwrap();
            let at = view.pixel(centre + 60.0 * to.extend(0.0)).unwrap();
            assert!((at.truncate() - DVec2::new(150.0, 40.0)).length() < 1e-6, "{at}");
            let right = DVec2::from_angle(-FRAC_PI_2).rotate(to);
            let at = view.pixel(centre + 60.0 * right.extend(0.0)).unwrap();
            assert!((at.truncate() - DVec2::new(210.0, 100.0)).length() < 1e-6, "{at}");
        }
    }
}
