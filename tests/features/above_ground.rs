//! Heights above the ground: the same pictures, masks and objects as of a scene with the heights that come of it.

use veduta::{
    figure::{self, animation::Film, scene_file},
    render::picture::{Aovs, Picture, Request, Studio},
    scene::Scene,
};

use crate::studio::*;

/// A slope that climbs to the north by half, and three blocks on it.
fn slope() -> Studio {
    let blocks = [([-20, 40, 20], [12, 10, 14]), ([6, 60, 30], [10, 10, 9]), ([-4, 90, 45], [14, 8, 12])];
    boxes("above", &blocks, true, true)
}

/// What is above the ground in the first of both has the same heights in the second.
fn scenes() -> [Scene; 2] {
    let text = |above: bool| {
        let flag = if above { "above_ground = true" } else { "" };
        let z = |y: f64, height: f64| if above { height } else { height + 0.5 * y };
        format!(
            r##"
veduta = 1
[camera]
eye = [-14, 8, {eye}]
target = [0, 60, {target}]
{flag}
[time]
at_s = 5
[[trajectory]]
name = "way"
points = [[-10, 30, {start}], [20, 80, {end}]]
times_s = [0, 10]
trace = true
{flag}
[[poi]]
name = "stop"
at = [10, 56, {stop}]
{flag}
[[poi]]
name = "moving"
trajectory = "way"
[[lens]]
name = "along"
shape = {{ kind = "corridor", points = [[-14, 44, {first}], [8, 64, {second}]], width = 9, height = 6 }}
effects = [{{ effect = "overlay", color = "#d01010" }}]
{flag}
[[lens]]
name = "at"
attached_to = {{ poi = "stop" }}
shape = {{ kind = "sphere", center = [0, 0, 0], radius = 7 }}
effects = ["invert"]
[[lens]]
name = "view"
kind = "see-through"
view = {{ kind = "camera", eye = [30, 70, {own_eye}], target = [0, 90, {own_target}]{own_flag} }}
[[lens]]
name = "note"
kind = "annotation"
poi = ["stop", "moving"]
text = "here"
"##,
            eye = z(8.0, 22.0),
            target = z(60.0, 3.0),
            start = z(30.0, 2.0),
            end = z(80.0, 2.0),
            stop = z(56.0, 4.0),
            first = z(44.0, 4.0),
            second = z(64.0, 3.0),
            own_eye = z(70.0, 9.0),
            own_target = z(90.0, 5.0),
            own_flag = if above { ", above_ground = true" } else { "" },
        )
    };
    [true, false]
        .map(|above| scene_file::parse(&text(above), "s.toml", &Default::default()).unwrap_or_else(|e| panic!("{e}")))
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    let aovs = Aovs { depth: true, object_id: true, lens_mask: true, ..Aovs::default() };
    figure::draw(studio, scene, &Request { aovs, ..Request::plain([240, 160]) }).expect("a picture")
}

#[test]
fn pictures_are_those_of_the_heights_that_come_of_it() {
    let mut studio = slope();
    let [above, plain] = scenes().map(|scene| drawn(&mut studio, &scene));
    assert!(above.rgba == plain.rgba, "what is seen, overlays and lines too");
    assert_eq!((&above.object_id, &above.depth), (&plain.object_id, &plain.depth));
    for lens in 0..2 {
        let held = bits(&above, lens);
        assert_eq!(held, bits(&plain, lens));
        assert!(held.iter().filter(|held| **held).count() > 50, "lens {lens} is in the picture");
    }
    // It would be another picture were the heights those of the model.
    let mut flat = scenes()[0].clone();
    flat.camera_above_ground = false;
    assert!(drawn(&mut studio, &flat).rgba != plain.rgba);
}

#[test]
fn eyes_and_lenses_of_animations_follow_the_ground() {
    let studio = slope();
    let animation = "[animation]\nframes = 3\nfps = 1\ncamera = [{ at = 0, eye = [0, 10, 2], target = [0, 60, 2] }, { at = 2, eye = [0, 70, 6], target = [0, 120, 4] }]\n\
        [[animation.change]]\npath = \"lens.ball.shape.center\"\nkeys = [{ at = 0, value = [0, 20, 1] }, { at = 2, value = [0, 80, 1] }]\n";
    let text = format!(
        "veduta = 1\n[camera]\neye = [0, 10, 2]\ntarget = [0, 60, 2]\nabove_ground = true\n[[lens]]\nname = \"ball\"\nabove_ground = true\n\
         shape = {{ kind = \"sphere\", center = [0, 0, 1], radius = 4 }}\n{animation}"
    );
    let film = Film::new(&scene_file::parse(&text, "s.toml", &Default::default()).unwrap()).unwrap();
    for (frame, y, height) in [(0, 10.0, 2.0), (1, 40.0, 4.0), (2, 70.0, 6.0)] {
        let moment = film.scene(frame).unwrap();
        let scene = studio.on_ground(&moment).unwrap();
        let eye = scene.camera.unwrap().eye;
        assert!((eye.y - y).abs() < 1e-6 && (eye.z - 0.5 * y - height).abs() < 1e-4, "{frame}: {eye}");
        let middle = scene.lenses[0].shapes[0].volumes().unwrap()[0].bounds().center();
        assert!((middle.z - 0.5 * middle.y - 1.0).abs() < 1e-4, "{frame}: {middle}");
    }
}

#[test]
fn without_ground_it_is_an_error_that_names_the_place() {
    let mut studio = boxes("above", &[([0, 0, 0], [10, 10, 10])], false, false);
    let text = "veduta = 1\n[camera]\neye = [-20, -20, 1.7]\ntarget = [0, 0, 5]\nabove_ground = true\n";
    let scene = scene_file::parse(text, "s.toml", &Default::default()).unwrap();
    let error = figure::draw(&mut studio, &scene, &Request::plain([64, 48])).unwrap_err().to_string();
    assert!(error.starts_with("[camera] above_ground: the city has no ground at (-20, -20)"), "{error}");
}

#[test]
fn what_cannot_be_above_the_ground_is_refused() {
    let lens = |rest: &str| format!("veduta = 1\n[[lens]]\nabove_ground = true\n{rest}\n");
    let ball = "shape = { kind = \"sphere\", center = [0, 0, 0], radius = 4 }";
    for (text, expected) in [
        (lens(&format!("{ball}\nplacement = \"camera\"")), "is given together with placement = \"camera\""),
        (lens(&format!("{ball}\nattached_to = {{ object = \"a\" }}")), "is given together with attached_to"),
        (
            lens("shape = { kind = \"thematic\", ids = [\"a\"] }"),
            "has a meaning only for shapes with places of their own",
        ),
        (lens("kind = \"map-view\""), "has no meaning for a lens of kind \"map-view\""),
        ("veduta = 1\n[[poi]]\nobject = \"a\"\nabove_ground = true\n".into(), "has a meaning only with at = [x, y, z]"),
        ("veduta = 1\n[camera]\nabove_ground = 2\n".into(), "above_ground: must be true or false, is 2"),
    ] {
        let error = scene_file::parse(&text, "s.toml", &Default::default()).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}\n{error}");
    }
}

#[test]
fn a_setting_says_it_too() {
    let [above, plain] = scenes();
    let eye = plain.camera.unwrap().eye;
    let set = |scene: &Scene, assignment: &str| {
        let mut scene = scene.clone();
        scene_file::set(&scene, assignment).unwrap_or_else(|error| panic!("{error}")).redo(&mut scene);
        scene
    };
    let mut asked = set(&plain, "camera.above_ground=true");
    assert!(asked.camera_above_ground && asked.camera.unwrap().eye == eye, "the numbers stay");
    asked = set(&asked, "camera.above_ground=unset");
    assert_eq!(asked, plain);
    assert_eq!(set(&set(&above, "poi.stop.above_ground=false"), "poi.stop.above_ground=true"), above);
    assert_eq!(set(&set(&above, "lens.along.above_ground=unset"), "lens.along.above_ground=true"), above);
}
