//! The sun inside a time lens: where it stands at the moment that shows there, with its shadows.

use glam::{DVec2, DVec3};
use veduta::{
    geom::Shape,
    lens::{Handled, Lens, Parameter},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Scene, SunTime},
    time::{Interval, Moment},
    view::Camera,
};

use crate::{materials::BOTH, studio::*};

const SIZE: [u32; 2] = [200, 125];

fn moment(text: &str) -> Option<Moment> {
    Interval::parse(text).expect("a time").begin
}

/// The market square at a moment of a day in summer, and no lens.
fn square(at: &str) -> Scene {
    let camera = Camera::looking(DVec3::new(-75.0, -110.0, 62.0), DVec3::new(8.0, 12.0, 4.0), 0.8);
    let mut scene = scene(camera, vec![]);
    scene.moment = moment(at);
    scene.sun.shadows = true;
    scene.sun.when = SunTime::Scene;
    scene.sun.place = Some(DVec2::new(52.0, 4.4));
    scene.sun.in_lenses = true;
    scene
}

fn lens_of(name: &str, x: f64, hour: &str) -> Lens {
    let at = Parameter::Text(hour.to_owned());
    let step = Handled { handler: "time-of-day".to_owned(), parameters: [("time".to_owned(), at)].into() };
    let mut lens = lens(name, [Shape::Sphere { center: DVec3::new(x, 10.0, 4.0), radius: 24.0 }], "sepia");
    lens.effects.clear();
    lens.time = vec![step];
    lens
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend, samples: u32) -> Picture {
    let request = Request { aovs: ALL, backend, samples, ..Request::plain(SIZE) };
    let scene = studio.on_ground(scene).expect("a sun").into_owned();
    studio.render(&scene, &request).expect("a picture")
}

#[test]
fn shadows_in_lenses_are_those_of_their_hours() {
    let mut studio = studio(&[citydata("square.city.json")]);
    let mut scene = square("2026-06-21T10:00");
    scene.lenses = vec![lens_of("evening", -8.0, "19:00"), lens_of("noon", 22.0, "13:00")];
    for backend in BOTH {
        let hours = ["2026-06-21T10:00", "2026-06-21T19:00", "2026-06-21T13:00"];
        let [now, evening, noon] = hours.map(|at| drawn(&mut studio, &square(at), backend, 1));
        let found = drawn(&mut studio, &scene, backend, 1);
        assert_eq!((&found.depth, &found.object_id), (&now.depth, &now.object_id));
        let inside = [0, 1].map(|lens| bits(&found, lens));
        let mut differ = [0; 2];
        for (i, color) in found.rgba.iter().enumerate() {
            // The upper lens sets the hour, whatever the lower one did.
            let expected = match (inside[0][i], inside[1][i]) {
                (_, true) => &noon,
                (true, false) => &evening,
                (false, false) => &now,
            };
            assert_eq!(*color, expected.rgba[i], "{backend:?}: pixel {i}");
            differ[0] += usize::from(inside[0][i] && evening.rgba[i] != now.rgba[i]);
            differ[1] += usize::from(inside[1][i] && noon.rgba[i] != now.rgba[i]);
        }
        assert!(differ.iter().all(|count| *count > 500), "{differ:?}");
    }
    // Of several samples each has its own sun: away from the lenses' borders the picture is that of the hour.
    let [now, noon] =
        ["2026-06-21T10:00", "2026-06-21T13:00"].map(|at| drawn(&mut studio, &square(at), Backend::Uber, 4));
    let found = drawn(&mut studio, &scene, Backend::Uber, 4);
    let inside = [0, 1].map(|lens| bits(&found, lens));
    let is_even = |i: usize, bits: &[bool], is: bool| {
        let (x, y) = (i as i64 % 200, i as i64 / 200);
        let near = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (x + dx, y + dy)));
        near.filter(|(x, y)| (0..200).contains(x) && (0..125).contains(y))
            .all(|(x, y)| bits[(y * 200 + x) as usize] == is)
    };
    let mut asked = [0; 2];
    for i in 0..found.rgba.len() {
        if is_even(i, &inside[1], true) {
            assert_eq!(found.rgba[i], noon.rgba[i], "pixel {i}, at noon");
            asked[0] += 1;
        } else if is_even(i, &inside[0], false) && is_even(i, &inside[1], false) {
            assert_eq!(found.rgba[i], now.rgba[i], "pixel {i}, outside");
            asked[1] += 1;
        }
    }
    assert!(asked.iter().all(|count| *count > 300), "{asked:?}");
}

#[test]
fn one_sun_is_everywhere_unless_it_is_asked_for() {
    let mut studio = studio(&[citydata("square.city.json")]);
    let mut scene = square("2026-06-21T10:00");
    let plain = drawn(&mut studio, &scene, Backend::Specialised, 1);
    scene.sun.in_lenses = false;
    scene.lenses = vec![lens_of("evening", -8.0, "19:00")];
    assert!(drawn(&mut studio, &scene, Backend::Specialised, 1).rgba == plain.rgba);
    // Too many are told.
    scene.sun.in_lenses = true;
    scene.lenses =
        (0..9).map(|i| lens_of(&format!("at {i}"), f64::from(i) - 4.0, &format!("{:02}:00", 8 + i))).collect();
    let scene = studio.on_ground(&scene).expect("a sun").into_owned();
    let error = studio.render(&scene, &Request::plain(SIZE)).expect_err("too many").to_string();
    assert!(error.contains("more than 8 moments"), "{error}");
}
