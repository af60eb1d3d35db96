use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;

use super::{
    fit::FILL,
    flight::FLIGHT_S,
    look::{Look, shorter},
    settled::{has_default_near, picture_height_m},
    *,
};
use crate::{geom::Aabb, view::camera::default_near_m};

const NATIONAL: DVec3 = DVec3::new(85_000.0, 447_000.0, 3.0);
const SIZE: [u32; 2] = [1280, 720];
const ASPECT: f64 = 1280.0 / 720.0;

fn view(camera: &Camera) -> View {
    View::new(*camera, SIZE, &Aabb::EMPTY).unwrap()
}

/// Where a point is seen, as a part of the picture.
fn place(camera: &Camera, at: DVec3) -> DVec2 {
    view(camera).pixel(at).expect("before the eye").truncate() / DVec2::new(SIZE[0].into(), SIZE[1].into())
}

/// The point at a place in the picture (parts of it) at depth `d`.
fn seen_at(camera: &Camera, part: [f64; 2], d: f64) -> DVec3 {
    view(camera).ray(DVec2::from(part) * DVec2::new(SIZE[0].into(), SIZE[1].into())).at(d)
}

fn looking(eye: DVec3, heading: f64, pitch: f64, distance: f64, projection: Projection) -> Camera {
    let look = Look { heading, pitch };
    let target = eye + distance * look.basis().forward;
    Camera { eye, target, up: look.up(), projection, near_m: default_near_m(distance) }
}

fn perspective(fov_degrees: f64) -> Projection {
    Projection::Perspective { fov_y: fov_degrees.to_radians() }
}

/// Without roll, up to 80 degrees up or down.
fn cameras() -> impl Strategy<Value = Camera> {
    let eye = prop::array::uniform3(-500.0..500.0f64).prop_map(|e| NATIONAL + DVec3::from(e));
    (eye, -4.0..4.0f64, -1.4..1.4f64, 10.0..2000.0f64, any::<bool>(), 0.2..1.0f64).prop_map(
        |(eye, heading, pitch, distance, orthographic, scale)| {
            let projection = if orthographic {
                Projection::Orthographic { height_m: 500.0 * scale }
            } else {
                perspective(100.0 * scale)
            };
            looking(eye, heading, pitch, distance, projection)
        },
    )
}

/// With any up, rolled as it makes them, and with near planes of their own.
fn rolled_cameras() -> impl Strategy<Value = Camera> {
    (cameras(), prop::array::uniform3(-1.0..1.0f64), 0.001..2.0f64).prop_map(|(camera, up, near_m)| Camera {
        up: DVec3::from(up),
        near_m,
        ..camera
    })
}

fn boxes() -> impl Strategy<Value = Aabb> {
    (prop::array::uniform3(-500.0..500.0f64), prop::array::uniform3(0.0..300.0f64)).prop_map(|(min, size)| {
        let min = NATIONAL + DVec3::from(min);
        Aabb { min, max: min + DVec3::from(size) + 0.5 }
    })
}

fn angles() -> impl Strategy<Value = DVec2> {
    prop::array::uniform2(-3.0..3.0f64).prop_map(DVec2::from)
}

fn parts() -> impl Strategy<Value = [f64; 2]> {
    prop::array::uniform2(0.0..1.0f64)
}

fn distance_m(camera: &Camera) -> f64 {
    camera.eye.distance(camera.target)
}

/// Greatest distance of a corner from the picture's middle, as a part of its half width or height: 1 on the border.
fn fill(camera: &Camera, bounds: &Aabb) -> f64 {
    let from_middle = |corner| 2.0 * (place(camera, corner) - 0.5).abs().max_element();
    bounds.corners().into_iter().map(from_middle).fold(0.0, f64::max)
}

/// Whether the box fills the picture but for the margin, or less where an eye that is nearer would have it before its near plane.
fn just_fits(camera: &Camera, bounds: &Aabb) -> bool {
    let nearest = bounds.corners().into_iter().map(|corner| view(camera).depth(corner)).fold(f64::INFINITY, f64::min);
    let fill = fill(camera, bounds);
    (fill - FILL).abs() < 1e-6 || (fill < FILL && nearest < 1.03 * camera.near_m)
}

#[test]
fn a_small_box_is_as_near_as_the_near_plane_lets_it() {
    // Half a metre along its diagonal, through a wide lens: the nearest corner is in the middle of the picture, so it is the near plane
    // that keeps the eye away, and no more than that.
    let bounds = Aabb { min: NATIONAL, max: NATIONAL + 0.5 };
    let eye = NATIONAL + DVec3::new(-200.0, -200.0, 200.0);
    let up = DVec3::new(0.3, -0.8, 0.1);
    let camera = Camera { up, ..Camera::looking(eye, eye + DVec3::new(100.0, 100.0, -100.0), 1.74) };
    let there = framed(&camera, &bounds, ASPECT);
    let fill = fill(&there, &bounds);
    assert!(fill < FILL && just_fits(&there, &bounds), "{fill}");
    assert!(bounds.corners().iter().all(|corner| view(&there).depth(*corner) >= there.near_m));
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn a_pivot_keeps_its_pixel(
        camera in prop_oneof![cameras(), rolled_cameras()], part in parts(), d in 5.0..2000.0f64, turn in angles()
    ) {
        let pivot = seen_at(&camera, part, d);
        let turned = orbit(&camera, pivot, turn);
        prop_assert!(place(&turned, pivot).distance(part.into()) < 1e-6);
        prop_assert!((view(&turned).depth(pivot) - d).abs() < 1e-6);
        prop_assert!((distance_m(&turned) - distance_m(&camera)).abs() < 1e-6);
        prop_assert_eq!(turned.up, DVec3::Z);
        prop_assert!(view(&turned).basis.right.z.abs() < 1e-9, "no roll");
    }

    #[test]
    fn a_turn_and_back_is_no_turn(
        camera in cameras(), part in parts(), d in 5.0..2000.0f64, x in -9.0..9.0f64, to in -1.4..1.4f64
    ) {
        let turn = DVec2::new(x, to - Look::of(&view(&camera).basis).pitch);
        let pivot = seen_at(&camera, part, d);
        let back = orbit(&orbit(&camera, pivot, turn), pivot, -turn);
        let scale = 1.0 + d + distance_m(&camera);
        prop_assert!(back.eye.distance(camera.eye) < 1e-9 * scale, "{}", back.eye - camera.eye);
        prop_assert!(back.target.distance(camera.target) < 1e-9 * scale);
        prop_assert_eq!((back.up, back.projection), (camera.up, camera.projection));
    }

    #[test]
    fn turning_adds_to_heading_and_pitch_up_to_the_limit(camera in cameras(), turn in angles()) {
        let before = Look::of(&view(&camera).basis);
        let turned = look_around(&camera, turn);
        let after = Look::of(&view(&turned).basis);
        prop_assert_eq!(turned.eye, camera.eye);
        prop_assert!((after.pitch - (before.pitch + turn.y).clamp(-MAX_PITCH, MAX_PITCH)).abs() < 1e-9);
        prop_assert!(shorter(after.heading - before.heading - turn.x).abs() < 1e-7);
    }

    #[test]
    fn the_point_held_stays_under_the_hand(
        camera in rolled_cameras(), from in parts(), to in parts(), d in 1.0..2000.0f64
    ) {
        let size = DVec2::new(SIZE[0].into(), SIZE[1].into());
        let at = seen_at(&camera, from, d);
        let panned = pan(&view(&camera), at, DVec2::from(from) * size, DVec2::from(to) * size);
        prop_assert!(place(&panned, at).distance(to.into()) < 1e-6);
        let way = panned.eye - camera.eye;
        prop_assert!(way.dot(view(&camera).basis.forward).abs() < 1e-6, "parallel to the picture");
        prop_assert!(way.distance(panned.target - camera.target) < 1e-9);
        prop_assert_eq!(panned.near_m, if has_default_near(&camera) { panned.near_m } else { camera.near_m });
    }

    #[test]
    fn zooming_keeps_the_pixel_and_the_direction(
        camera in rolled_cameras(), part in parts(), d in 5.0..2000.0f64, factor in 0.001..50.0f64
    ) {
        let at = seen_at(&camera, part, d);
        let zoomed = zoom(&camera, at, factor);
        prop_assert!(place(&zoomed, at).distance(part.into()) < 1e-6, "{} {part:?}", place(&zoomed, at));
        prop_assert!(view(&zoomed).basis.forward.distance(view(&camera).basis.forward) < 1e-7);
        match (camera.projection, zoomed.projection) {
            (Projection::Orthographic { height_m }, Projection::Orthographic { height_m: higher }) => {
                prop_assert!((higher - height_m * factor).abs() < 1e-9 * higher);
                let least = if factor > 1.0 { higher } else { 0.0 };
                prop_assert!((distance_m(&zoomed) - distance_m(&camera).max(least)).abs() < 1e-6);
            }
            (Projection::Perspective { .. }, _) => {
                let nearer = (factor * camera.eye.distance(at)).max(MIN_DISTANCE_M);
                prop_assert!((zoomed.eye.distance(at) - nearer).abs() < 1e-8 * (1.0 + nearer));
                prop_assert_eq!(zoomed.projection, camera.projection);
            }
            _ => prop_assert!(false, "another kind of projection"),
        }
    }

    #[test]
    fn walking_stays_level(
        camera in prop_oneof![cameras(), rolled_cameras()], right in -50.0..50.0f64, forward in -50.0..50.0f64
    ) {
        let walked = travel(&camera, DVec3::new(right, forward, 0.0), true);
        prop_assert_eq!(walked.eye.z, camera.eye.z);
        let way = walked.eye - camera.eye;
        prop_assert!((way.length() - right.hypot(forward)).abs() < 1e-8);
        let ahead = (camera.target - camera.eye).truncate().try_normalize().unwrap();
        prop_assert!((way.truncate().dot(ahead) - forward).abs() < 1e-6, "{way}");
        prop_assert!((way.truncate().dot(DVec2::new(ahead.y, -ahead.x)) - right).abs() < 1e-6);
        let above = walk(&camera, DVec2::new(right, forward), |at| Some(at.x - NATIONAL.x), 1.7);
        prop_assert!((above.eye.z - (walked.eye.x - NATIONAL.x) - 1.7).abs() < 1e-9);
        prop_assert!((above.target - above.eye).distance(camera.target - camera.eye) < 1e-9);
        prop_assert_eq!(walk(&camera, DVec2::new(right, forward), |_| None, 1.7), walked);
    }

    #[test]
    fn travelling_goes_along_the_axes_of_the_camera(
        camera in rolled_cameras(), steps in prop::array::uniform3(-50.0..50.0f64)
    ) {
        let there = travel(&camera, steps.into(), false);
        let (basis, way) = (view(&camera).basis, there.eye - camera.eye);
        let at = DVec3::new(way.dot(basis.right), way.dot(basis.forward), way.dot(basis.up));
        prop_assert!(at.distance(steps.into()) < 1e-8);
    }

    #[test]
    fn a_framed_box_just_fits(camera in rolled_cameras(), bounds in boxes(), aspect in 0.3..3.0f64) {
        let camera = Camera { near_m: default_near_m(distance_m(&camera)), ..camera };
        let wide = framed(&camera, &bounds, ASPECT);
        prop_assert!(just_fits(&wide, &bounds), "{}", fill(&wide, &bounds));
        prop_assert!(view(&wide).basis.forward.distance(view(&camera).basis.forward) < 1e-7);
        prop_assert!(view(&wide).basis.up.distance(view(&camera).basis.up) < 1e-5);
        for camera in [wide, framed(&camera, &bounds, aspect)] {
            let seen = view(&camera);
            prop_assert!(bounds.corners().iter().all(|corner| seen.depth(*corner) >= camera.near_m));
            prop_assert!((seen.depth(bounds.center()) - distance_m(&camera)).abs() < 1e-6);
        }
    }

    #[test]
    fn sides_show_all_of_a_box_from_where_they_say(camera in cameras(), bounds in boxes()) {
        for axis in Axis::ALL {
            let there = axis_view(axis, &bounds, &camera, ASPECT);
            prop_assert!((fill(&there, &bounds) - FILL).abs() < 1e-6, "{axis:?}");
            prop_assert!(view(&there).basis.forward.distance(axis.direction()) < 1e-7);
            let from_middle = there.eye - bounds.center();
            let (side, right) = match axis {
                Axis::Top => (from_middle.z, DVec3::X),
                Axis::North => (from_middle.y, -DVec3::X),
                Axis::South => (-from_middle.y, DVec3::X),
                Axis::East => (from_middle.x, DVec3::Y),
                Axis::West => (-from_middle.x, -DVec3::Y),
            };
            prop_assert!(side > 0.0 && view(&there).basis.right.distance(right) < 1e-7, "{axis:?}");
            prop_assert_eq!(view(&there).is_orthographic(), view(&camera).is_orthographic());
            prop_assert!(view(&there).is_orthographic() || there.projection == camera.projection);
        }
    }

    #[test]
    fn another_projection_and_back_is_the_start(camera in rolled_cameras(), fov in 0.1..2.0f64, part in parts()) {
        let fov_y = match camera.projection {
            Projection::Perspective { fov_y } => fov_y,
            Projection::Orthographic { .. } => fov,
        };
        let orthographic = view(&camera).is_orthographic();
        prop_assert_eq!(with_projection(&camera, orthographic, fov_y), camera);
        let other = with_projection(&camera, !orthographic, fov_y);
        prop_assert_eq!(view(&other).is_orthographic(), !orthographic);
        let beside = seen_at(&camera, part, distance_m(&camera));
        prop_assert!(place(&other, beside).distance(part.into()) < 1e-6, "keeps its size");
        let back = with_projection(&other, orthographic, fov_y);
        let growth = picture_height_m(&back) / picture_height_m(&camera);
        prop_assert!((growth - 1.0).abs() < 1e-9);
        prop_assert!(place(&back, beside).distance(part.into()) < 1e-6);
        if !orthographic {
            prop_assert!(back.eye.distance(camera.eye) < 1e-9 * (1.0 + distance_m(&camera)));
            prop_assert_eq!(back.projection, camera.projection);
        }
    }

    #[test]
    fn flights_are_exact_at_their_ends_and_go_on_between(from in rolled_cameras(), to in rolled_cameras()) {
        let flight = Flight { from, to };
        prop_assert_eq!((flight.at(0.0), flight.at(1.0)), (from, to));
        prop_assert_eq!((flight.at(-1.0), flight.at(2.0), flight.at(f64::NAN)), (from, to, from));
        prop_assert!((FLIGHT_S.0..=FLIGHT_S.1).contains(&flight.duration_s()));
        let steps = 4000;
        let mut before = from;
        let lowest = from.eye.z.min(to.eye.z);
        for i in 1..=steps {
            let now = flight.at(f64::from(i) / f64::from(steps));
            prop_assert!(now.check().is_ok());
            prop_assert!(now.eye.z >= lowest - 1e-9);
            // A few thousand metres and half a circle in 4000 steps, the fastest at twice the mean speed and more.
            let reach = distance_m(&before) + from.target.distance(to.target) + 10.0;
            prop_assert!(now.eye.distance(before.eye) < 0.01 * reach, "{i}: {}", now.eye - before.eye);
            prop_assert!(now.target.distance(before.target) < 0.01 * reach, "{i}");
            let (a, b) = (view(&before).basis, view(&now).basis);
            prop_assert!(a.forward.distance(b.forward) < 0.01 && a.up.distance(b.up) < 0.02, "{i}: {a:?} {b:?}");
            let growth = picture_height_m(&now) / picture_height_m(&before);
            prop_assert!((growth - 1.0).abs() < 0.02, "{i}: {growth}");
            before = now;
        }
    }

    #[test]
    fn flights_between_level_cameras_do_not_roll(from in cameras(), to in cameras(), t in 0.0..1.0f64) {
        let flight = Flight { from, to };
        let basis = view(&flight.at(t)).basis;
        prop_assert!(basis.right.z.abs() < 1e-9);
        let headings = [from, flight.at(t), to].map(|camera| Look::of(&view(&camera).basis).heading);
        let (turned, whole) = (shorter(headings[1] - headings[0]), shorter(headings[2] - headings[0]));
        prop_assert!(turned * whole >= -1e-9 && turned.abs() <= whole.abs() + 1e-9, "the short way round");
    }

    #[test]
    fn no_numbers_are_needed_to_answer(
        camera in rolled_cameras(), axis in 0..3usize,
        bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300])
    ) {
        let mut at = camera.target;
        at[axis] = bad;
        let turn = DVec2::new(at.x, at.y);
        let answers = [
            orbit(&camera, at, DVec2::ONE),
            orbit(&camera, NATIONAL, DVec2::new(bad, 0.1)),
            look_around(&camera, turn),
            pan(&view(&camera), at, DVec2::ZERO, DVec2::ONE),
            pan(&view(&camera), camera.target, DVec2::splat(bad), DVec2::ONE),
            zoom(&camera, at, 0.5),
            zoom(&camera, camera.target, bad),
            travel(&camera, at, true),
            travel(&camera, at, false),
            walk(&camera, DVec2::ONE, |_| Some(bad), 1.7),
            walk(&camera, DVec2::ONE, |_| Some(0.0), bad),
            framed(&camera, &Aabb { min: NATIONAL, max: at }, 1.0),
            framed(&camera, &Aabb { min: at, max: NATIONAL }, bad),
            axis_view(Axis::Top, &Aabb { min: NATIONAL, max: at }, &camera, 1.0),
            with_projection(&camera, true, bad),
            with_projection(&camera, false, bad),
            Flight { from: Camera { eye: at, ..camera }, to: camera }.at(1.0),
            Flight { from: camera, to: Camera { eye: at, ..camera } }.at(0.5),
        ];
        for (i, answer) in answers.into_iter().enumerate() {
            prop_assert!(answer.check().is_ok(), "{i}: {answer:?}");
        }
        // Where the given camera has no picture, it comes back.
        let none = Camera { eye: at, up: DVec3::splat(bad), ..camera };
        for answer in [
            orbit(&none, NATIONAL, DVec2::ONE), zoom(&none, NATIONAL, 0.5), travel(&none, DVec3::ONE, true),
            framed(&none, &Aabb { min: NATIONAL, max: NATIONAL + 1.0 }, 1.0), with_projection(&none, true, 1.0),
        ] {
            prop_assert!(answer.up == none.up || bad.is_nan() && answer.up.is_nan());
            prop_assert_eq!(answer.target, none.target);
        }
        let from_none = Flight { from: none, to: camera };
        prop_assert!((FLIGHT_S.0..=FLIGHT_S.1).contains(&from_none.duration_s()));
    }
}

#[test]
fn turning_about_a_point_is_what_is_written() {
    let camera = Camera::looking(NATIONAL - 10.0 * DVec3::Y, NATIONAL, 1.0);
    let near = |camera: &Camera, eye: DVec3| assert!((camera.eye - NATIONAL).distance(eye) < 1e-9, "{camera:?}");
    // A quarter clockwise: the view goes east, so the eye stands in the west.
    near(&orbit(&camera, NATIONAL, DVec2::new(FRAC_PI_2, 0.0)), -10.0 * DVec3::X);
    // Looking down by 30 degrees lifts the eye.
    let down = orbit(&camera, NATIONAL, DVec2::new(0.0, -PI / 6.0));
    near(&down, DVec3::new(0.0, -10.0 * (PI / 6.0).cos(), 5.0));
    let steepest = orbit(&camera, NATIONAL, DVec2::new(0.0, -9.0));
    near(&steepest, 10.0 * DVec3::new(0.0, -MAX_PITCH.cos(), MAX_PITCH.sin()));
    let around = look_around(&camera, DVec2::new(-FRAC_PI_2, 0.0));
    assert!((around.target - around.eye).distance(-10.0 * DVec3::X) < 1e-9, "to the left");
}

#[test]
fn seen_from_straight_above_the_top_of_the_picture_is_ahead() {
    let top = Camera { up: DVec3::X, ..Camera::looking(NATIONAL + 100.0 * DVec3::Z, NATIONAL, 1.0) };
    let ahead = travel(&top, DVec3::new(0.0, 5.0, 0.0), true);
    assert!((ahead.eye - top.eye).distance(5.0 * DVec3::X) < 1e-9);
    // Further down is not possible; round and up is.
    assert!(orbit(&top, NATIONAL, DVec2::new(0.0, -1.0)).eye.distance(top.eye) < 1e-9);
    let round = orbit(&top, NATIONAL, DVec2::new(FRAC_PI_2, 0.0));
    assert!(round.eye.distance(top.eye) < 1e-9 && view(&round).basis.up.distance(-DVec3::Y) < 1e-9);
    let raised = orbit(&top, NATIONAL, DVec2::new(0.0, PI / 6.0));
    assert_eq!(raised.up, DVec3::Z);
    assert!((raised.eye - NATIONAL).distance(100.0 * DVec3::new(-0.5, 0.0, 0.75_f64.sqrt())) < 1e-9, "from the west");
    // Up into the sky, the bottom of the picture is ahead.
    let sky = Camera { up: -DVec3::X, ..Camera::looking(NATIONAL, NATIONAL + 100.0 * DVec3::Z, 1.0) };
    assert!((travel(&sky, DVec3::Y, true).eye - sky.eye).distance(DVec3::X) < 1e-9);
    // Flights leave from there without a jump.
    let flight = Flight { from: top, to: raised };
    assert!(view(&flight.at(1e-3)).basis.up.distance(DVec3::X) < 1e-6);
}

#[test]
fn the_eye_stays_before_what_it_zooms_to() {
    let mut camera = Camera::looking(NATIONAL - 50.0 * DVec3::Y, NATIONAL, 1.0);
    for _ in 0..100 {
        camera = zoom(&camera, NATIONAL, 0.7);
    }
    assert!((camera.eye.distance(NATIONAL) - MIN_DISTANCE_M).abs() < 1e-6 && camera.eye.y < NATIONAL.y);
    for _ in 0..100 {
        camera = zoom(&camera, NATIONAL, 1.5);
    }
    assert!((camera.eye.distance(NATIONAL) - MAX_DISTANCE_M).abs() < 1e-2);
    let mut flat = with_projection(&Camera::looking(NATIONAL - 50.0 * DVec3::Y, NATIONAL, 1.0), true, 1.0);
    for (factor, limit) in [(0.3, HEIGHTS_M.0), (3.0, HEIGHTS_M.1)] {
        for _ in 0..60 {
            flat = zoom(&flat, NATIONAL, factor);
        }
        assert_eq!(flat.projection, Projection::Orthographic { height_m: limit });
    }
}

#[test]
fn a_near_plane_of_ones_own_is_kept() {
    let camera = Camera::looking(NATIONAL - 100.0 * DVec3::Y, NATIONAL, 1.0);
    let bounds = Aabb { min: NATIONAL, max: NATIONAL + 50.0 };
    let own = Camera { near_m: 0.7, ..camera };
    let far = zoom(&camera, NATIONAL, 10.0);
    assert!((far.near_m - default_near_m(1000.0)).abs() < 1e-9 && far.near_m != camera.near_m);
    assert_eq!(zoom(&own, NATIONAL, 10.0).near_m, 0.7);
    assert_eq!(axis_view(Axis::Top, &bounds, &own, 1.0).near_m, 0.7);
    // Far away before it: the eye keeps the box behind it.
    let cutting = Camera { near_m: 400.0, ..camera };
    let there = framed(&cutting, &bounds, 1.0);
    assert!(there.near_m == 400.0 && bounds.corners().iter().all(|c| view(&there).depth(*c) >= 400.0));
    assert!((Flight { from: own, to: Camera { near_m: 0.175, ..far } }.at(0.5).near_m - 0.35).abs() < 1e-9);
}

#[test]
fn a_far_flight_rises_and_a_near_one_does_not() {
    let street = looking(NATIONAL, 0.3, 0.0, 20.0, perspective(50.0));
    let away = |metres: f64| moved(&street, metres * DVec3::X);
    let far = Flight { from: street, to: away(3000.0) };
    let middle = far.at(0.5);
    assert!(middle.eye.z > street.eye.z + 1000.0, "{middle:?}");
    let height = picture_height_m(&middle) / 3000.0;
    assert!((0.9..1.1).contains(&height), "as high as the way is long: {height}");
    let near = Flight { from: street, to: away(10.0) };
    assert!((near.at(0.5).eye - street.eye).distance(5.0 * DVec3::X) < 1e-9);
    assert!(near.duration_s() < far.duration_s());
    assert_eq!(Flight { from: street, to: street }.duration_s(), FLIGHT_S.0);
    // At rest at both ends.
    for (t, end) in [(1e-4, far.from), (1.0 - 1e-4, far.to)] {
        assert!(far.at(t).eye.distance(end.eye) < 1e-4);
    }
}

#[test]
fn what_cannot_be_done_changes_nothing() {
    let camera = Camera::looking(NATIONAL - 100.0 * DVec3::Y, NATIONAL, 1.0);
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(zoom(&camera, NATIONAL, factor), camera);
    }
    assert_eq!(zoom(&camera, camera.eye, 0.5), camera);
    assert_eq!(pan(&view(&camera), camera.eye - DVec3::Y, DVec2::ZERO, DVec2::ONE), camera);
    let point = Aabb { min: NATIONAL, max: NATIONAL };
    let bounds = Aabb { min: NATIONAL, max: NATIONAL + 1.0 };
    for (bounds, aspect) in [(&Aabb::EMPTY, 1.0), (&point, 1.0), (&bounds, 0.0), (&bounds, f64::NAN)] {
        assert_eq!(framed(&camera, bounds, aspect), camera);
        assert_eq!(axis_view(Axis::East, bounds, &camera, aspect), camera);
    }
    assert_eq!(
        with_projection(&with_projection(&camera, true, 1.0), false, 0.0).projection,
        Projection::Orthographic { height_m: picture_height_m(&camera) }
    );
    let none = Camera { eye: NATIONAL, ..camera };
    assert_eq!(orbit(&none, NATIONAL, DVec2::ONE), none);
    assert_eq!(look_around(&none, DVec2::ONE), none);
    assert_eq!(zoom(&none, camera.eye, 0.5), none);
    assert_eq!(walk(&none, DVec2::ONE, |_| Some(0.0), 1.7), none);
    assert_eq!(framed(&none, &bounds, 1.0), none);
    assert_eq!(axis_view(Axis::Top, &bounds, &none, 1.0), none);
    assert_eq!((Flight { from: none, to: camera }.at(0.5), Flight { from: camera, to: none }.at(0.5)), (none, camera));
}

#[test]
fn who_lands_looks_at_what_is_named_or_level_ahead() {
    let camera = Camera::looking(NATIONAL + DVec3::new(0.0, -300.0, 200.0), NATIONAL, 0.7);
    let eye = NATIONAL + DVec3::new(20.0, -40.0, 1.7);
    let there = landed(&camera, eye, Some(NATIONAL));
    assert_eq!((there.eye, there.target, there.up), (eye, NATIONAL, DVec3::Z));
    // North as before.
    let ahead = landed(&camera, eye, None);
    assert!(ahead.eye == eye && (ahead.target - eye - LANDED_M * DVec3::Y).length() < 1e-9, "{ahead:?}");
    for nothing in [eye, eye + 9.0 * DVec3::Z, DVec3::NAN] {
        assert_eq!(landed(&camera, eye, Some(nothing)), ahead);
    }
    assert_eq!(landed(&camera, DVec3::NAN, None), camera);
}
