//! What has a history costs nothing where no moment is asked for: counted.

use glam::DVec3;
use veduta::{
    lens::{Handled, Parameter},
    render::picture::{Request, Studio},
    scene::{CitySpec, Scene},
    time::Moment,
};

use crate::studio::*;

const SIZE: [u32; 2] = [160, 100];

/// The built-in old town, its side table and its timetable, or nothing of its history.
fn town(folder: &Folder, has_history: bool) -> Scene {
    let options = veduta::city::synth::SynthOptions { buildings: 100, seed: 3 };
    let mut city = Vec::new();
    veduta::city::synth::full::write_cityjson(&options, &mut city, &mut |_| ()).expect("a town");
    let mut day = Vec::new();
    veduta::city::synth::full::write_timetable(&options, &mut day).expect("a timetable");
    let mut text = String::from_utf8(city).expect("a text");
    if !has_history {
        text = text.replace("yearOfConstruction", "a").replace("yearOfDemolition", "b");
    }
    let file = folder.write(if has_history { "with.city.json" } else { "without.city.json" }, text);
    let day = folder.write("day.csv", day);
    let camera = veduta::view::Camera::looking(DVec3::new(60.0, -180.0, 120.0), DVec3::ZERO, 0.8);
    let mut scene = scene(
        camera,
        vec![lens("sepia", [veduta::geom::Shape::Sphere { center: DVec3::ZERO, radius: 40.0 }], "sepia")],
    );
    scene.sun.shadows = true;
    scene.city = CitySpec { files: vec![file], ..CitySpec::default() };
    if has_history {
        scene.city.timetables = vec![day];
    }
    scene
}

/// All that a picture is counted by: passes with their draws and triangles, and the programs that ran.
fn counts(studio: &mut Studio, scene: &Scene) -> Vec<String> {
    let request = Request { statistics: true, ..Request::plain(SIZE) };
    let found = studio.render(scene, &request).expect("a picture").statistics;
    let mut all: Vec<String> = found
        .passes
        .iter()
        .map(|pass| format!("{}: {} draws, {} triangles", pass.name, pass.draws, pass.triangles))
        .collect();
    all.extend(found.handlers);
    all
}

#[test]
fn a_history_that_nobody_asks_for_costs_nothing() {
    let folder = Folder::new("costs");
    let (with, without) = (town(&folder, true), town(&folder, false));
    let mut studio = of_scene(&with);
    let expected = counts(&mut of_scene(&without), &without);
    assert_eq!(counts(&mut studio, &with), expected);
    // Time that nothing answers costs nothing either: no object of the other has a date, and nothing moves.
    let asked = |scene: &Scene| {
        let mut asked = scene.clone();
        let by = Parameter::Text("-100 years".to_owned());
        asked.moment = Moment::of_year(1800);
        asked.lenses[0].time =
            vec![Handled { handler: "shift".to_owned(), parameters: [("by".to_owned(), by)].into() }];
        asked
    };
    assert_eq!(counts(&mut of_scene(&without), &asked(&without)), expected);
    assert_ne!(counts(&mut studio, &asked(&with)), expected);
    // When nobody asks any more, what moves is still drawn beside the rest, and nothing else costs anything: the picture is as before.
    let drawn = |studio: &mut Studio| studio.render(&with, &Request::plain(SIZE)).expect("a picture").rgba;
    assert!(drawn(&mut studio) == drawn(&mut of_scene(&with)));
    let mut without_timetable = with.clone();
    without_timetable.city.timetables.clear();
    let mut studio = of_scene(&without_timetable);
    assert_ne!(counts(&mut studio, &asked(&without_timetable)), expected);
    assert_eq!(counts(&mut studio, &without_timetable), expected);
}

#[test]
fn scrubbing_uploads_a_moment_and_compiles_nothing() {
    let folder = Folder::new("scrub");
    let mut scene = town(&folder, true);
    scene.city.timetables.clear();
    scene.moment = Moment::of_year(1900);
    let mut studio = of_scene(&scene);
    let at = |year: i64| {
        let at = Parameter::Text(Moment::of_year(year).expect("a year").written());
        vec![Handled { handler: "set".to_owned(), parameters: [("at".to_owned(), at)].into() }]
    };
    let mut drawn = |scene: &Scene| {
        let request = Request { statistics: true, ..Request::plain(SIZE) };
        let found = studio.render(scene, &request).expect("a picture").statistics;
        (found.frame.uploaded_bytes, found.frame.allocations, found.pipelines.compiled)
    };
    let lens_at = |i: usize| {
        let center = DVec3::new(25.0 * i as f64 - 60.0, 5.0, 0.0);
        lens(&format!("t{i}"), [veduta::geom::Shape::Sphere { center, radius: 30.0 }], "sepia")
    };
    scene.lenses = (0..4).map(lens_at).collect();
    for (lens, year) in scene.lenses.iter_mut().zip([1500, 1600, 1700, 1800]) {
        lens.time = at(year);
    }
    drawn(&scene);
    assert_eq!(drawn(&scene), (0, 0, 0), "the same again");
    // One lens, which shows neither the first nor the last of all moments, then all of them and the scene.
    scene.lenses[2].time = at(1711);
    let (bytes, allocations, compiled) = drawn(&scene);
    assert!(bytes > 0 && bytes <= 8 && allocations == 0 && compiled == 0, "{bytes} bytes, {allocations}, {compiled}");
    for (lens, year) in scene.lenses.iter_mut().zip([1510, 1620, 1730, 1840]) {
        lens.time = at(year);
    }
    scene.moment = Moment::of_year(1950);
    let (bytes, allocations, compiled) = drawn(&scene);
    // Four lenses, the scene, and the ends of what shows anywhere.
    assert!(
        bytes > 0 && bytes <= 16 * 4 && allocations == 0 && compiled == 0,
        "{bytes} bytes, {allocations}, {compiled}"
    );
}
