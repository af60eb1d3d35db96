//! Sheets: cells are the pictures of `veduta render --set`, figures are what they say, and what is wrong is said before
//! anything is drawn.

use std::{
    path::{Path, PathBuf},
    process::{Output, Stdio},
};

use crate::studio::{self, Triangle, citydata, studio, triangles};
use glam::DVec3;
use serde_json::Value;
use veduta::{
    geom::{Aabb, Ray},
    lens::{Lens, Region, chosen::Choice},
    render::{
        furniture::{Furniture, Panel, Piece},
        picture::Studio,
        visible_share::{objects_of, share_in},
    },
    scene::Scene,
    view::{Camera, View},
};

const SCENE: &str = r##"
veduta = 1
[city]
files = ["builtin:square"]
[camera]
eye = [-75, -110, 62]
target = [8, 12, 4]
fov_deg = 46.0
[[poi]]
name = "hall"
object = "town-hall"
[[lens]]
name = "a"
shape = { kind = "sphere", center = [32, 22, 6], radius = 34 }
effects = [{ effect = "thematic", attribute = "yearOfConstruction", label = "Built" }]
[figure]
size = [96, 64]
title = "Not in a cell"
legend = "auto"
"##;

const SHEET: &str = r##"
veduta_sheet = 1
scene = "s.toml"
set = ["lens.a.color=#ff0000"]
cell_size = [96, 64]
text_px = 8
title = "Sheet"
figures = ["visible-share", "occluders"]
[[row]]
name = "near"
set = ["lens.a.shape.radius=20"]
[[row]]
name = "far"
[[column]]
name = "age"
[[column]]
name = "gone"
heading = "Erased"
set = ["lens.a.effects=['eraser']", "lens.a.shape={ kind = 'thematic', ids = ['town-hall'] }"]
[[cell]]
row = "far"
column = "age"
caption = "The caption."
"##;

fn run(arguments: &[&str]) -> Output {
    let mut command = crate::program();
    command.args(arguments).env_remove("VEDUTA_DATA").stdin(Stdio::null()).output().unwrap()
}

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("veduta-sheet-{name}-{}", std::process::id()));
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
fn cells_are_the_pictures_of_render_and_stand_in_the_sheet() {
    let folder = folder("cells");
    let [file, sheet, out, picture, json] =
        ["s.toml", "g.sheet.toml", "out.png", "cell.png", "f.json"].map(|name| folder.join(name));
    std::fs::write(&sheet, SHEET).unwrap();
    let output = run(&["sheet", text(&sheet), "-o", text(&out), "--figures", text(&json)]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let cells = ["out-far-age.png", "out-far-gone.png", "out-near-age.png", "out-near-gone.png"];
    assert_eq!(names(&folder), [&["f.json", "g.sheet.toml"][..], &cells, &["out.png", "s.toml"]].concat());
    let bare = ["figure.title=unset", "figure.legend=none", "lens.a.color=#ff0000"];
    let gone = ["lens.a.effects=['eraser']", "lens.a.shape={ kind = 'thematic', ids = ['town-hall'] }"];
    let near = ["lens.a.shape.radius=20"];
    let of_cells: [(&str, Vec<&str>); 4] = [
        (cells[0], bare.to_vec()),
        (cells[1], [&bare[..], &gone].concat()),
        (cells[2], [&bare[..], &near].concat()),
        (cells[3], [&bare[..], &near, &gone].concat()),
    ];
    let mut rendered = Vec::new();
    for (cell, settings) in of_cells {
        let mut arguments = vec!["render", text(&file), "-o", text(&picture), "--size", "96x64"];
        arguments.extend(settings.iter().flat_map(|set| ["--set", set]));
        assert_eq!(run(&arguments).status.code(), Some(0));
        assert!(std::fs::read(&picture).unwrap() == std::fs::read(folder.join(cell)).unwrap(), "{cell}");
        rendered.push(image::open(&picture).unwrap().into_rgb8());
    }
    // Each of them once in the sheet, whole.
    let page = image::open(&out).unwrap().into_rgb8();
    for cell in &rendered[..3] {
        let is_there = |x: u32, y: u32| {
            (0..64).all(|row| (0..96).all(|column| page.get_pixel(x + column, y + row) == cell.get_pixel(column, row)))
        };
        let [w, h] = [page.width() - 96, page.height() - 64];
        let found = (0..=h).flat_map(|y| (0..=w).map(move |x| (x, y))).filter(|&(x, y)| is_there(x, y)).count();
        assert!(found >= 1, "{} places", found);
    }
    // The legend of the ages, though half of the cells have none, and paper at the corners.
    assert_eq!(page.get_pixel(0, 0).0, [255; 3]);
    let figures: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let cells = figures["cells"].as_array().unwrap();
    let of = |i: usize, key: &str| cells[i][key].as_f64().unwrap();
    assert_eq!(cells[3]["name"], "far-gone");
    assert!(of(0, "visible-share") > 0.3 && of(0, "visible-share") == of(2, "visible-share"), "{figures}");
    assert_eq!([of(1, "visible-share"), of(3, "visible-share")], [0.0, 0.0], "the hall is erased");
    assert!(of(0, "occluders") > 0.0 && of(0, "occluders") < of(2, "occluders"), "a larger lens meets more: {figures}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn occluders_are_those_that_statistics_list() {
    let folder = folder("occluders");
    let [file, sheet, json, stats] = ["s.toml", "g.sheet.toml", "f.json", "stats.json"].map(|name| folder.join(name));
    let who = |name| format!("[[lens]]\nname = \"{name}\"\nkind = \"occlusion\"\npoi = \"hall\"\n");
    let beside = "test = { kind = \"spherical\", radius = 60 }\n";
    std::fs::write(&file, format!("{}{}{}{beside}", SCENE.replace("62]", "9]"), who("who"), who("beside"))).unwrap();
    let off = ["lens.beside.enabled=false", "lens.who.enabled=false"];
    let columns = [("both", &off[..0]), ("one", &off[..1]), ("none", &off[..])];
    let mut text_of_sheet =
        "veduta_sheet = 1\nscene = \"s.toml\"\ncell_size = [96, 64]\nfigures = [\"occluders\"]\n".to_owned();
    for (name, set) in &columns {
        text_of_sheet += &format!("[[column]]\nname = \"{name}\"\nset = {set:?}\n");
    }
    std::fs::write(&sheet, text_of_sheet).unwrap();
    let output = run(&["sheet", text(&sheet), "-o", text(&folder.join("out.png")), "--figures", text(&json)]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let figures: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let mut told = Vec::new();
    for (i, (name, set)) in columns.iter().enumerate() {
        let picture = folder.join("cell.png");
        let mut arguments =
            vec!["render", text(&file), "-o", text(&picture), "--size", "96x64", "--stats", text(&stats)];
        arguments.extend(set.iter().flat_map(|set| ["--set", set]));
        assert_eq!(run(&arguments).status.code(), Some(0));
        let listed: Value = serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap();
        let lenses = listed["lenses"].as_array().unwrap();
        let count: usize = lenses.iter().filter_map(|lens| lens["occluders"].as_array()).map(Vec::len).sum();
        // Where none is enabled, what hides the hall hides it all the same.
        let wanted = if set.len() == 2 { told[0] } else { count };
        assert_eq!(figures["cells"][i]["occluders"].as_u64(), Some(wanted as u64), "{name}: {figures}");
        told.push(count);
    }
    assert!(told[0] > told[1] && told[1] > 0 && told[2] == 0, "{told:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_sheet_is_the_same_twice_and_made_for_a4_without_a_size() {
    let folder = folder("a4");
    let [sheet, cells, one, two] = ["g.sheet.toml", "cells", "1.png", "2.png"].map(|name| folder.join(name));
    std::fs::write(&sheet, SHEET.replace("cell_size = [96, 64]\ntext_px = 8\n", "")).unwrap();
    for file in [&one, &two] {
        let output = run(&["sheet", text(&sheet), "-o", text(file), "--cells", text(&cells)]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(std::fs::read(&one).unwrap() == std::fs::read(&two).unwrap());
    assert_eq!(names(&cells), ["far-age.png", "far-gone.png", "near-age.png", "near-gone.png"]);
    let page = image::open(&one).unwrap();
    assert!(page.width() <= 3508 && page.height() <= 2480, "{}x{}", page.width(), page.height());
    assert!(page.width() > 3460 || page.height() > 2430, "{}x{}", page.width(), page.height());
    let bytes = std::fs::read(&one).unwrap();
    let dots = [b"pHYs".as_slice(), &11_811_u32.to_be_bytes(), &11_811_u32.to_be_bytes(), &[1]].concat();
    assert!(bytes.windows(dots.len()).any(|window| window == dots), "300 dots per inch");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_cannot_be_drawn_is_said_before_anything_is() {
    let folder = folder("wrong");
    let [sheet, out, cells] = ["g.sheet.toml", "out.png", "cells"].map(|name| folder.join(name));
    let wrong = |text_of: &str, extra: &[&str], code: i32, expected: &str| {
        std::fs::write(&sheet, text_of).unwrap();
        let arguments = [&["sheet", text(&sheet), "-o", text(&out), "--cells", text(&cells)], extra].concat();
        let output = run(&arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert!(said.contains(expected) && !said.contains("panicked"), "{expected}: {said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert_eq!(names(&folder), ["g.sheet.toml", "s.toml"], "nothing is written");
    };
    wrong(&SHEET.replace("title", "titel"), &[], 1, "g.sheet.toml:7: titel: unknown key; did you mean \"title\"?");
    wrong(
        &SHEET.replace("shape.radius=20", "shape.raduis=20"),
        &[],
        1,
        "g.sheet.toml:11: [row.0] set.0 \"lens.a.shape.raduis=20\": [lens.0] shape.raduis: unknown key; did you mean \"radius\"? (cell near-age)",
    );
    wrong(&SHEET.replace("\"s.toml\"", "\"none.toml\""), &[], 1, "none.toml: cannot be read");
    wrong(&SHEET.replace("\"s.toml\"", "\"/etc/s.toml\""), &[], 1, "allow it with --allow-outside");
    wrong(&SHEET.replace("[96, 64]", "[16384, 64]"), &[], 1, "and 16384 is the most on a side");
    wrong(
        &SHEET.replace("text_px = 8", "poi = \"hal\""),
        &[],
        1,
        "no point of interest \"hal\"; did you mean \"hall\"?",
    );
    let outside = SHEET.replace("lens.a.shape.radius=20", "city.files=['/etc/a.json']");
    wrong(&outside, &[], 1, "leads out of the scene's folder");
    wrong(SCENE, &[], 1, "g.sheet.toml:1: is a scene; a sheet begins with veduta_sheet = 1");
    wrong(SHEET, &["--set", "lens.b.enabled=false"], 2, "there is no lens \"b\"");
    let output = run(&["sheet", text(&sheet), "-o", text(&folder.join("out.jpg"))]);
    assert_eq!(output.status.code(), Some(2));
    let output = run(&["render", text(&sheet), "-o", text(&out)]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("is a sheet and not a scene; `veduta sheet` draws it"));
    std::fs::remove_dir_all(folder).unwrap();
}

/// D of the nearest of these triangles along a ray.
fn nearest<'t>(all: impl Iterator<Item = &'t Triangle>, ray: &Ray) -> Option<(f64, u32)> {
    let hit = |triangle: &Triangle| {
        let [a, b, c] = triangle.corners;
        let (e, f) = (b - a, c - a);
        let across = ray.direction.cross(f);
        let det = e.dot(across);
        let from = ray.origin - a;
        let u = from.dot(across) / det;
        let around = from.cross(e);
        let (v, t) = (ray.direction.dot(around) / det, f.dot(around) / det);
        (det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, triangle.object))
    };
    all.filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn looking(lenses: Vec<Lens>) -> Scene {
    let camera = Camera::looking(DVec3::new(-60.0, -70.0, 16.0), DVec3::new(8.0, 12.0, 8.0), 0.7);
    let mut scene = studio::scene(camera, lenses);
    scene.figure.size = [96, 64];
    scene
}

#[test]
fn the_visible_share_is_that_of_rays_through_all_triangles() {
    let mut studio = studio(&[citydata("square.city.json")]);
    let all = triangles(&studio);
    let objects = objects_of(&studio.model, "town-hall");
    assert_eq!(objects.iter().filter(|is| **is).count(), 4, "the hall and its three parts");
    let is_ground = |object: u32| studio.model.objects[object as usize].class.is_ground();
    let scene = looking(vec![]);
    let view = View::new(scene.camera.unwrap(), [96, 64], &Aabb::EMPTY).unwrap();
    let (mut alone, mut seen) = (0, 0);
    for (x, y) in (0..64).flat_map(|y| (0..96).map(move |x| (x, y))) {
        let ray = view.pixel_ray(x, y);
        let is_hall = |hit: Option<(f64, u32)>| hit.is_some_and(|(_, object)| objects[object as usize]);
        let kept = all.iter().filter(|t| objects[t.object as usize] || is_ground(t.object));
        alone += usize::from(is_hall(nearest(kept, &ray)));
        seen += usize::from(is_hall(nearest(all.iter(), &ray)));
    }
    let expected = seen as f64 / alone as f64;
    assert!(alone > 100 && expected > 0.1 && expected < 0.9, "{seen} of {alone}: a view that says something");
    let share = share_in(&mut studio, &scene, [96, 64], "town-hall").unwrap().unwrap();
    // A ray that meets an edge may go either way: two pixels.
    assert!((share - expected).abs() <= 2.0 / alone as f64, "{share} is not {expected}");
    // What stands before it taken away, all of it; itself taken away, nothing. A context without it changes nothing of what it is
    // compared with.
    let eraser = |choice: Choice| studio::lens("e", [Region::Thematic(choice)], "eraser");
    let hall = || Choice { ids: vec!["town-hall".into()], ..Choice::default() };
    let mut of = |choice| share_in(&mut studio, &looking(vec![eraser(choice)]), [96, 64], "town-hall").unwrap();
    assert_eq!(of(hall()), Some(0.0));
    let trees = Choice { attribute: None, ids: vec!["terrain".into(), "town-hall".into()], except: true, ..hall() };
    let without = of(trees).unwrap();
    assert!(without > 0.99, "only what lies flat on the ground is left before it: {without}");
    // Out of the picture there is no share.
    let mut away = looking(vec![]);
    away.camera = Some(Camera::looking(DVec3::new(0.0, 0.0, 20.0), DVec3::new(-60.0, -70.0, 20.0), 0.3));
    assert_eq!(share_in(&mut studio, &away, [96, 64], "town-hall").unwrap(), None);
}

#[test]
fn a_page_is_its_furniture_on_its_ground_tile_by_tile() {
    let mut studio: Studio = studio(&[citydata("cube.city.json")]);
    let panel = |low: [f32; 2], high: [f32; 2]| {
        Piece::Panel(Panel {
            low,
            high,
            color: [1.0, 0.0, 0.0],
            opacity: 1.0,
            radius_px: 0.0,
            softness_px: 1.0,
            ellipse: false,
        })
    };
    // Wider than a target: across where tiles meet.
    let size = [4200, 20];
    let pieces = vec![panel([2.0, 3.0], [5.0, 7.0]), panel([4000.0, 0.0], [4190.0, 20.0])];
    let page = studio.renderer.page(size, [1.0, 1.0, 1.0], &Furniture { pieces }).unwrap();
    for (i, pixel) in page.iter().enumerate() {
        let [x, y] = [i as u32 % size[0], i as u32 / size[0]];
        let is_red = ((2..5).contains(&x) && (3..7).contains(&y)) || (4000..4190).contains(&x);
        assert_eq!(*pixel, if is_red { [255, 0, 0, 255] } else { [255; 4] }, "{x} {y}");
    }
    let empty = studio.renderer.page([3, 2], [0.0, 0.0, 1.0], &Furniture::default()).unwrap();
    assert_eq!(empty, [[0, 0, 255, 255]; 6]);
}

#[test]
fn the_example_of_the_docs_works_at_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_to_string(root.join("docs/sheet.md")).unwrap();
    let example = docs.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = folder("docs");
    std::fs::copy(root.join("scenes/first-lens.toml"), folder.join("first-lens.toml")).unwrap();
    let [sheet, out] = ["styles.sheet.toml", "styles.png"].map(|name| folder.join(name));
    std::fs::write(&sheet, format!("cell_size = [64, 36]\n{example}")).unwrap();
    let output = run(&["sheet", text(&sheet), "-o", text(&out)]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.join("styles-small-age.png").exists() && out.exists());
    std::fs::remove_dir_all(folder).unwrap();
}
