//! Animations: each frame is the picture of its moment's scene, and what is wrong is said before anything is drawn.

use std::{
    path::{Path, PathBuf},
    process::{Output, Stdio},
};

use crate::studio::{of_scene, with_full_shadows};
use glam::DVec3;
use veduta::{
    figure::{
        self,
        animation::Film,
        scene_file::{self, Options},
    },
    geom::Shape,
    lens::Region,
    render::picture::Request,
    scene::Scene,
    view::Projection,
};

const SCENE: &str = r#"
veduta = 1
[city]
files = ["builtin:square"]
[camera]
eye = [-75, -110, 62]
target = [8, 12, 4]
fov_deg = 46.0
[[lens]]
name = "a"
shape = { kind = "sphere", center = [32, 22, 6], radius = 34 }
effects = ["sepia"]
[figure]
size = [96, 64]
title = "A walk"
[animation]
fps = 5
camera = [
  { at = 0.0, eye = [-75, -110, 62], target = [8, 12, 4] },
  { at = 0.6, eye = [20, -120, 40], target = [8, 12, 4], fov_deg = 60.0 },
  { at = 1.0, eye = [80, -100, 62], target = [8, 12, 4] },
]
[[animation.change]]
path = "lens.a.shape.center"
keys = [{ at = 0, value = [32, 22, 6] }, { at = 1, value = [-20, 10, 6] }]
[[animation.change]]
path = "lens.a.shape.radius"
keys = [{ at = 0, value = 34 }, { at = 1, value = 20 }]
"#;

fn scene() -> Scene {
    scene_file::parse(SCENE, "s", &Options::for_command_line()).unwrap()
}

fn run(arguments: &[&str]) -> Output {
    let mut command = crate::program();
    command.args(arguments).env_remove("VEDUTA_DATA").stdin(Stdio::null()).output().unwrap()
}

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("veduta-animate-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    std::fs::write(path.join("s.toml"), SCENE).unwrap();
    path
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_frame_has_the_values_of_its_moment() {
    let film = Film::new(&scene()).unwrap();
    assert_eq!(film.frames(), 6);
    for (frame, share) in [(0, 0.0), (3, 0.6), (5, 1.0)] {
        let moment = film.scene(frame).unwrap();
        let Region::Shape(Shape::Sphere { center, radius }) = moment.lenses[0].shapes[0] else { panic!("a sphere") };
        let expected = DVec3::new(32.0, 22.0, 6.0).lerp(DVec3::new(-20.0, 10.0, 6.0), share);
        assert!(center.distance(expected) < 1e-6 && (radius - (34.0 - 14.0 * share)).abs() < 1e-9, "{frame}: {center}");
        assert_eq!(moment.animation, None);
    }
    let camera = film.scene(3).unwrap().camera.unwrap();
    assert!(camera.eye.distance(DVec3::new(20.0, -120.0, 40.0)) < 1e-6);
    assert!(matches!(camera.projection, Projection::Perspective { fov_y } if (fov_y.to_degrees() - 60.0).abs() < 1e-9));
}

#[test]
fn a_studio_that_drew_other_frames_draws_the_same_bytes() {
    let film = Film::new(&scene()).unwrap();
    let draw = |studio: &mut veduta::render::picture::Studio, frame| {
        let scene = film.scene(frame).unwrap();
        let request = Request { samples: 2, ..Request::plain(scene.figure.size) };
        figure::draw(studio, &scene, &request).unwrap().rgba
    };
    let mut one = of_scene(&scene());
    let all: Vec<_> = (0..film.frames()).map(|frame| draw(&mut one, frame)).collect();
    assert!(draw(&mut of_scene(&scene()), 4) == all[4]);
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]), "every frame is another picture");
}

#[test]
fn frames_are_the_pictures_that_render_makes() {
    let folder = folder("render");
    let (file, frames) = (folder.join("s.toml"), folder.join("new/frames"));
    let output = run(&["animate", text(&file), "-o", text(&frames), "--samples", "2"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names(&frames), ["0000.png", "0001.png", "0002.png", "0003.png", "0004.png", "0005.png"]);
    let moment = Film::new(&scene()).unwrap().scene(2).unwrap();
    let camera = moment.camera.unwrap();
    let Projection::Perspective { fov_y } = camera.projection else { panic!("perspective") };
    let Region::Shape(Shape::Sphere { center, radius }) = moment.lenses[0].shapes[0] else { panic!("a sphere") };
    let list = |p: DVec3| format!("[{:?},{:?},{:?}]", p.x, p.y, p.z);
    let picture = folder.join("moment.png");
    let settings = [
        format!("--set=camera.eye={}", list(camera.eye)),
        format!("--set=camera.target={}", list(camera.target)),
        format!("--set=camera.fov_deg={:?}", fov_y.to_degrees()),
        format!("--set=lens.a.shape.center={}", list(center)),
        format!("--set=lens.a.shape.radius={radius:?}"),
    ];
    let mut arguments = vec!["render", text(&file), "-o", text(&picture), "--samples", "2"];
    arguments.extend(settings.iter().map(String::as_str));
    assert_eq!(run(&arguments).status.code(), Some(0));
    let pixels = |path: &Path| image::open(path).unwrap().into_rgb8().into_raw();
    assert!(pixels(&picture) == pixels(&frames.join("0002.png")));
    // The first moment is written as it was read: its file is the same byte by byte.
    let output = run(&["render", text(&file), "-o", text(&picture), "--samples", "2"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(std::fs::read(&picture).unwrap() == std::fs::read(frames.join("0000.png")).unwrap());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_part_is_drawn_and_what_is_there_stays_or_is_told() {
    let folder = folder("part");
    let (file, frames) = (folder.join("s.toml"), folder.join("frames"));
    std::fs::create_dir_all(&frames).unwrap();
    for name in ["0002.png", "0009.png", "notes.txt"] {
        std::fs::write(frames.join(name), "old").unwrap();
    }
    let output = run(&["animate", text(&file), "-o", text(&frames), "--frames", "1..2", "--size", "16x16"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("0009.png stay") && said.contains("6 frames"), "{said}");
    assert_eq!(names(&frames), ["0001.png", "0002.png", "0009.png", "notes.txt"], "nothing half-written");
    assert_eq!(image::open(frames.join("0002.png")).unwrap().width(), 16, "the old one is replaced");
    std::fs::remove_dir_all(folder).unwrap();
}

/// What is near the eye gives way, over more than one frame.
const GIVES_WAY: &str = r#"
[[lens]]
name = "near"
kind = "occlusion"
test = { kind = "spherical", radius = 100.0, reference = "nearest" }
fade = 0.5
"#;

#[test]
fn a_frame_with_a_history_does_not_depend_on_which_frames_are_drawn() {
    let folder = folder("history");
    let (file, all, part) = (folder.join("s.toml"), folder.join("all"), folder.join("part"));
    let text_of_scene = SCENE.replace("[figure]", &format!("{GIVES_WAY}[figure]"));
    std::fs::write(&file, &text_of_scene).unwrap();
    for (to, frames) in [(&all, ".."), (&part, "3..4")] {
        let output = run(&["animate", text(&file), "-o", text(to), "--frames", frames]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(names(&part), ["0003.png", "0004.png"]);
    for name in names(&part) {
        assert!(std::fs::read(all.join(&name)).unwrap() == std::fs::read(part.join(&name)).unwrap(), "{name}");
    }
    // Some frames are not what their moment is by itself; the first is.
    let film = Film::new(&scene_file::parse(&text_of_scene, "s", &Options::for_command_line()).unwrap()).unwrap();
    let mut studio = with_full_shadows(of_scene(&scene()));
    let fading: Vec<u32> = (0..film.frames())
        .filter(|frame| {
            let scene = film.scene(*frame).unwrap();
            let request = Request { ..Request::plain(scene.figure.size) };
            let alone = figure::draw(&mut studio, &scene, &request).unwrap().rgba;
            let drawn = image::open(all.join(format!("{frame:04}.png"))).unwrap().into_rgba8();
            drawn.pixels().map(|p| p.0).ne(alone)
        })
        .collect();
    assert!(!fading.contains(&0) && !fading.is_empty(), "{fading:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn statistics_tell_of_each_frame_and_few_samples_are_warned_of() {
    let folder = folder("stats");
    let (file, frames, stats) = (folder.join("s.toml"), folder.join("frames"), folder.join("walk.jsonl"));
    std::fs::write(&file, SCENE.replace("[figure]", &format!("{GIVES_WAY}[figure]"))).unwrap();
    let draw = |samples: &str| {
        let arguments = ["animate", text(&file), "-o", text(&frames), "--frames", "1..", "--stats", text(&stats)];
        let output = run(&[&arguments[..], &["--samples", samples]].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{said}");
        said
    };
    let said = draw("2");
    assert!(
        said.contains("occluders fade") && said.contains("2 samples") && said.contains("figure.samples = 8"),
        "{said}"
    );
    let lines: Vec<serde_json::Value> =
        std::fs::read_to_string(&stats).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 5);
    let mut fading = 0;
    for (line, number) in lines.iter().zip(1..) {
        assert_eq!((&line["number"], &line["frame"]["samples"]), (&number.into(), &2.into()));
        assert!((line["at_s"].as_f64().unwrap() - 0.2 * f64::from(number)).abs() < 1e-9);
        assert_eq!(line["lenses"][0]["name"], "a");
        let near = &line["lenses"][1];
        let weights: Vec<f64> =
            near["occluders"].as_array().unwrap().iter().map(|o| o["weight"].as_f64().unwrap()).collect();
        let count = |key: &str| near["over_time"][key].as_u64().unwrap() as usize;
        assert_eq!(count("whole"), weights.iter().filter(|w| **w == 1.0).count(), "{near}");
        let between = weights.iter().filter(|w| **w > 0.0 && **w < 1.0).count();
        assert!(count("entering") + count("leaving") >= between, "{near}");
        fading += between;
    }
    assert!(fading > 0);
    assert!(!draw("8").contains("occluders fade"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_cannot_be_drawn_is_said_in_one_line_before_anything_is() {
    let folder = folder("wrong");
    let (file, frames) = (folder.join("s.toml"), folder.join("frames"));
    let wrong = |scene: &str, extra: &[&str], code: i32, expected: &str| {
        std::fs::write(&file, scene).unwrap();
        let output = run(&[&["animate", text(&file), "-o", text(&frames)], extra].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{extra:?}: {said}");
        assert!(said.contains(expected), "{expected}: {said}");
        assert!(!said.contains("panicked") && !frames.exists(), "{said}");
        if code == 1 {
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    };
    let still = SCENE.split("[animation]").next().unwrap();
    wrong(still, &[], 1, "s.toml: [animation] is missing: camera = [");
    wrong(&SCENE.replace("lens.a.shape.radius", "lens.b.shape.radius"), &[], 1, "there is no lens \"b\"");
    wrong(&SCENE.replace("value = 20 ", "value = -20 "), &[], 1, "frame 4, at 0.800 s: --set lens.a.shape.radius=-");
    wrong(
        &SCENE.replace("eye = [80, -100, 62]", "eye = [8, 12, 4]"),
        &[],
        1,
        "s.toml:21: [animation] camera.2: eye and target",
    );
    // On its way the eye runs over what it looks at.
    let over = still.to_owned()
        + "[animation]\nfps = 2\ncamera = [{ at = 0, eye = [0, 0, 9], target = [4, 0, 9] }, { at = 1, eye = [8, 0, 9], target = [4, 0, 9] }]\n";
    wrong(&over, &[], 1, "frame 1, at 0.500 s: camera: eye and target are the same point");
    wrong(SCENE, &["--frames", "3..9"], 2, "there is no frame 9: the animation has 6, 0 to 5");
    wrong(SCENE, &["--frames", "3..1"], 2, "1..3 would be right");
    wrong(SCENE, &["--frames", "all"], 2, "0..49");
    wrong(SCENE, &["--set", "animation.frames=0"], 2, "animation");
    let output = run(&["animate", text(&file), "-o", "-"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("-o DIR"));
    std::fs::write(&frames, "a file").unwrap();
    let output = run(&["animate", text(&file), "-o", text(&frames)]);
    assert_eq!(output.status.code(), Some(2));
    let expected =
        format!("error: -o {}: is a file, and frames go to a folder; -o DIR would be right\n", text(&frames));
    assert_eq!(String::from_utf8_lossy(&output.stderr), expected);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_example_of_the_docs_works_at_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_to_string(root.join("docs/scene.md")).unwrap();
    let section = docs.split("## Animations").nth(1).unwrap();
    let example = section.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let scene = std::fs::read_to_string(root.join("scenes/market-square.toml")).unwrap();
    let scene = scene_file::parse(&format!("{scene}\n{example}"), "s", &Options::for_command_line()).unwrap();
    let film = Film::new(&scene).unwrap();
    assert_eq!(film.frames(), 241);
    assert!((0..film.frames()).all(|frame| film.scene(frame).is_ok()));
}
