//! Heights above a slope and a step whose heights are known.

use proptest::prelude::*;

use super::*;
use crate::{
    geom::combination::Operation,
    lens::{BestView, LensKind, kind::BestViewLens},
    scene::model::Poi,
    view::{Projection, path::Form},
};

/// A slope to the east, with a step of 3 m at x = 50; none west of 0.
fn slope(at: DVec2) -> Option<f64> {
    (at.x >= 0.0).then_some(0.1 * at.x + if at.x > 50.0 { 3.0 } else { 0.0 })
}

fn camera(eye: [f64; 3], target: [f64; 3]) -> Camera {
    Camera {
        near_m: default_near_m(DVec3::from(eye).distance(target.into())),
        ..Camera::looking(eye.into(), target.into(), 0.8)
    }
}

fn lens(shapes: Vec<Region>) -> Lens {
    Lens { placement: Placement::AboveGround, shapes, ..Lens::plain("a", LensKind::default(), [0.0; 3]) }
}

fn ball(center: [f64; 3]) -> Region {
    Shape::Sphere { center: center.into(), radius: 5.0 }.into()
}

#[test]
fn cameras_points_and_shapes_stand_on_the_ground() {
    let way = Shape::Corridor {
        points: vec![DVec3::new(10.0, 0.0, 1.0), DVec3::new(60.0, 9.0, 2.0)],
        width: 4.0,
        height: 3.0,
    };
    let prism = Region::Prism {
        points: [[50.0, 0.0], [70.0, 0.0], [60.0, 30.0]].map(DVec2::from).to_vec(),
        holes: vec![],
        base: -1.0,
        height: 9.0,
    };
    let parts = vec![ball([20.0, 0.0, 0.0]), ball([80.0, 0.0, 4.0])];
    let scene = Scene {
        camera: Some(camera([10.0, 0.0, 1.7], [60.0, 0.0, 5.0])),
        camera_above_ground: true,
        pois: vec![Poi { name: "p".into(), place: PoiPlace::AboveGround(DVec3::new(30.0, 5.0, 2.0)) }],
        lenses: vec![lens(vec![way.into(), prism, Region::Combined { how: Operation::Union, parts }])],
        ..Scene::default()
    };
    let found = scene.on_ground(&slope).unwrap();
    let eye = found.camera.unwrap();
    assert_eq!((eye.eye.z, eye.target.z), (1.7 + 1.0, 5.0 + 9.0));
    assert_eq!(eye.near_m, default_near_m(eye.eye.distance(eye.target)), "that of its new distance");
    assert_eq!(found.pois[0].place, PoiPlace::At(DVec3::new(30.0, 5.0, 5.0)));
    let [
        Region::Shape(Shape::Corridor { points, .. }),
        Region::Prism { base, height, .. },
        Region::Combined { parts, .. },
    ] = &found.lenses[0].shapes[..]
    else {
        panic!("{:?}", found.lenses[0].shapes)
    };
    assert_eq!([points[0].z, points[1].z], [2.0, 11.0]);
    assert_eq!((*base, *height), (8.0, 9.0), "at the middle of its corners");
    assert_eq!(parts[..], [ball([20.0, 0.0, 2.0]), ball([80.0, 0.0, 15.0])]);
    assert_eq!(found.lenses[0].placement, Placement::World);
    assert!(!found.has_heights_above_ground());
    // Once is enough, and the scene itself is as it was.
    assert_eq!(found.on_ground(&slope).unwrap(), found);
    assert!(scene.has_heights_above_ground());
}

#[test]
fn what_is_of_the_model_is_not_touched() {
    let plain = Scene {
        camera: Some(camera([10.0, 0.0, 1.7], [60.0, 0.0, 5.0])),
        pois: vec![Poi { name: "p".into(), place: PoiPlace::At(DVec3::new(30.0, 5.0, 2.0)) }],
        lenses: vec![Lens { placement: Placement::World, ..lens(vec![ball([20.0, 0.0, 2.0])]) }],
        ..Scene::default()
    };
    let nowhere = |_: DVec2| -> Option<f64> { panic!("nobody asks for the ground") };
    assert!(matches!(plain.on_ground(&nowhere), Ok(Cow::Borrowed(_))));
}

#[test]
fn views_have_an_eye_above_the_ground() {
    let eye = camera([20.0, 0.0, 1.0], [30.0, 0.0, 2.0]);
    let shown = BestView {
        pois: vec![],
        depiction: Depiction::View(LocalView::Camera { camera: eye, above_ground: true }),
        lenses: None,
        look: None,
    };
    let view = Lens::plain("view", BestViewLens { shown }, [0.0; 3]);
    let scene = Scene { lenses: vec![view], ..Scene::default() };
    let found = scene.on_ground(&slope).unwrap();
    let Some(LocalView::Camera { camera, above_ground: false }) = found.lenses[0].best_view().unwrap().view() else {
        panic!("an eye of the model")
    };
    assert_eq!((camera.eye.z, camera.target.z), (3.0, 5.0));
}

#[test]
fn where_there_is_no_ground_one_is_told_of_it() {
    let scene = Scene { lenses: vec![lens(vec![ball([20.0, 0.0, 0.0]), ball([-5.0, 2.0, 0.0])])], ..Scene::default() };
    let problem = scene.on_ground(&slope).unwrap_err().to_string();
    assert!(problem.starts_with("[lens.0] above_ground: the city has no ground at (-5, 2)"), "{problem}");
}

fn way(pace: Pace, form: Form) -> Trajectory {
    let points = [[0.0, 0.0, 2.0], [40.0, 0.0, 2.0], [40.0, 30.0, 4.0], [120.0, 30.0, 2.0]];
    Trajectory {
        name: "way".into(),
        points: points.map(DVec3::from).to_vec(),
        pace,
        form,
        above_ground: true,
        start_s: 3.0,
        color: [0.0; 3],
        marker: true,
        trace: true,
    }
}

#[test]
fn what_moves_is_when_and_where_it_was_and_on_the_ground() {
    let times = [0.0, 10.0, 14.0, 30.0];
    for is_smooth in [false, true] {
        let given = way(Pace::Times(times.to_vec()), Form { is_closed: false, is_smooth });
        let found = following(&given, &slope).unwrap();
        for tenth in 0..330 {
            let time = f64::from(tenth) / 10.0;
            let (at, on) = (given.at(time).at, found.at(time).at);
            // Straight pieces, and a step in the ground that the way climbs in one of them.
            assert!(
                (at - on).truncate().length() < if is_smooth { 0.6 } else { 0.05 },
                "{is_smooth} {time}: {at} {on}"
            );
            if (on.x - 50.0).abs() > 3.0 * STEP_M {
                assert!((on.z - at.z - slope(at.truncate()).unwrap()).abs() < 0.1, "{is_smooth} {time}: {at} {on}");
            }
        }
        assert_eq!(found.end_s(), given.end_s());
    }
    // It is as fast up the slope as elsewhere.
    let fast = following(&way(Pace::Speed(5.0), Form { is_closed: false, is_smooth: false }), &slope).unwrap();
    let (a, b) = (fast.at(5.0).at, fast.at(6.0).at);
    assert!((a.distance(b) - 5.0).abs() < 1e-9 && b.z > a.z);
    // A way that goes round is back where it began.
    let round = way(Pace::Times([&times[..], &[44.0]].concat()), Form { is_closed: true, is_smooth: false });
    let round = following(&round, &slope).unwrap();
    assert!(round.at(3.0 + 44.0).at.distance(round.at(3.0).at) < 1e-9);
    let Pace::Times(times) = &round.pace else { panic!("by times") };
    assert_eq!(times.len(), round.points.len() + 1);
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn up_and_down_again_is_the_same_place(
        eye in prop::array::uniform3(0.0..500.0f64), target in prop::array::uniform3(0.0..500.0f64),
    ) {
        let flat = Camera { projection: Projection::Orthographic { height_m: 30.0 }, ..camera(eye, target) };
        for given in [camera(eye, target), flat] {
            let there = raised(&given, &slope).unwrap();
            let back = lowered(&there, &slope).unwrap();
            prop_assert!((back.eye - given.eye).length() < 1e-9 && (back.target - given.target).length() < 1e-9);
        }
        let mut region = ball(eye);
        raise(&mut region, &slope).unwrap();
        lower(&mut region, &slope).unwrap();
        let Region::Shape(Shape::Sphere { center, .. }) = region else { panic!("a ball") };
        prop_assert!((center - DVec3::from(eye)).length() < 1e-9);
    }
}
