//! What became of a city since an earlier state: what is gone stands beside what is there, in lenses that ask for it, is coloured and counted.

use std::{fmt::Write as _, path::Path};

use glam::DVec3;
use veduta::{
    figure::{legend::legends, scene_file},
    render::{frame::Backend, picture::Request},
    scene::Scene,
};

use crate::{materials::BOTH, studio::*};

const SIZE: [u32; 2] = [160, 40];

/// A city of cubes of four metres along x: id, where, and a number that is an attribute.
fn cubes(folder: &Folder, name: &str, all: &[(&str, i64, i64)]) {
    let (mut objects, mut vertices) = (Vec::new(), Vec::new());
    for &(id, x, number) in all {
        let first = vertices.len();
        for z in [0, 4] {
            vertices.extend([[0, 0], [4, 0], [4, 4], [0, 4]].map(|[a, b]| [x + a, b, z]));
        }
        let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let faces = faces.map(|face| vec![face.map(|k: usize| first + k)]);
        objects.push(format!(
            r#""{id}": {{"type": "Building", "attributes": {{"number": {number}}}, "geometry": [{{"type": "Solid", "lod": "2", "boundaries": [{faces:?}]}}]}}"#
        ));
    }
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [1, 1, 1], "translate": [0, 0, 0]}}, "CityObjects": {{{}}}, "vertices": {vertices:?}}}"#,
        objects.join(", ")
    );
    folder.write(name, text);
}

/// Where the cubes are, along x.
const KEPT: f64 = 2.0;
const GROWN: [f64; 2] = [22.0, 32.0];
const GONE: f64 = 42.0;
const RENUMBERED: f64 = 62.0;
const NEW: f64 = 82.0;

fn states(folder: &Folder) {
    cubes(folder, "old.city.json", &[("a", 0, 1), ("b", 20, 2), ("gone", 40, 3), ("d", 60, 4)]);
    cubes(folder, "new.city.json", &[("d", 60, 5), ("b", 30, 2), ("new", 80, 6), ("a", 0, 1)]);
}

fn parsed(folder: &Path, rest: &str) -> Result<Scene, String> {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"new.city.json\"]\nground = false\n[[city.change]]\nfiles = [\"old.city.json\"]\n\
         [camera]\neye = [45, -80, 60]\ntarget = [45, 2, 0]\nprojection = \"orthographic\"\nheight_m = 30\n{rest}"
    );
    let options = scene_file::Options { base: folder.to_owned(), ..Default::default() };
    scene_file::parse(&text, "s.toml", &options).map_err(|error| error.to_string())
}

fn lens(content: &str) -> String {
    format!(
        "[[lens]]\nname = \"since\"\nkind = \"content\"\nshape = {{ kind = \"box\", center = [32.5, 2, 4], size = [75, 14, 10] }}\n\
         content = {{ files = [\"old.city.json\"], {content} }}\n\
         effects = [{{ effect = \"thematic\", attribute = \"change\", counts = true, relief = 0, categories = [\"removed\", \"added\", \"kept\"], \
         colors = [\"#ff0000\", \"#00ff00\", \"#ffffff\"] }}]\n"
    )
}

/// The numbers of objects seen on top of the cubes, and their colours.
fn seen(folder: &Folder, content: &str, backend: Backend) -> Vec<(u32, [u8; 3])> {
    let scene = parsed(&folder.0, &lens(content)).unwrap_or_else(|error| panic!("{error}"));
    let mut studio = of_scene(&scene);
    let request = Request {
        aovs: veduta::render::picture::Aovs { object_id: true, ..Default::default() },
        backend,
        ..Request::plain(SIZE)
    };
    let drawn = studio.render(&scene, &request).expect("a picture");
    let around = studio.extent();
    let view = veduta::view::View::new(scene.camera.expect("a camera"), SIZE, &around).expect("a view");
    let ids = drawn.object_id.as_ref().expect("ids");
    let at = |x: f64| {
        let place = view.pixel(DVec3::new(x, 2.0, 4.0)).expect("before the eye");
        let i = place.y as usize * SIZE[0] as usize + place.x as usize;
        let [r, g, b, _] = drawn.rgba[i];
        (ids[i], [r, g, b])
    };
    [KEPT, GROWN[0], GROWN[1], GONE, RENUMBERED, NEW].map(at).to_vec()
}

fn is_red([r, g, b]: [u8; 3]) -> bool {
    u32::from(r) > 2 * u32::from(g.max(b))
}

#[test]
fn what_is_gone_stands_beside_what_is_there() {
    let folder = Folder::new("changes");
    states(&folder);
    for backend in BOTH {
        let numbers = |content: &str| seen(&folder, content, backend).iter().map(|(id, _)| *id).collect::<Vec<_>>();
        // Objects of the earlier state follow the four of the city.
        assert_eq!(numbers("only = \"removed\""), [4, 0, 2, 7, 1, 3]);
        assert_eq!(numbers("only = [\"removed\", \"other shape\"]"), [4, 6, 2, 7, 1, 3]);
        assert_eq!(numbers("only = \"kept\", lod = \"2\"")[1..], [0, 2, 0, 1, 3]);
        // What is another by the number of a house.
        assert_eq!(numbers("only = \"removed\", key = \"number\"")[3], 7);
        let colors = seen(&folder, "only = \"removed\"", backend);
        let red: Vec<bool> = colors.iter().map(|(_, color)| is_red(*color)).collect();
        assert_eq!(red, [false, false, false, true, false, false], "{colors:?}");
    }
}

#[test]
fn legends_count_what_is_gone() {
    let folder = Folder::new("changes-legend");
    states(&folder);
    let scene = parsed(&folder.0, &lens("only = \"removed\"")).expect("a scene");
    let studio = of_scene(&scene);
    let beside = studio.shown_beside(&scene, SIZE).expect("contents");
    let [legend] = &legends(&scene, &studio.model, &[true], &studio.model, &beside)[..] else { panic!("one legend") };
    let mut rows = String::new();
    legend.rows().iter().for_each(|row| write!(rows, "{}; ", row.label).expect("a text"));
    assert_eq!(rows, "removed (1); added (1); kept (1); other (2); ");
    assert!(studio.shown_beside(&parsed(&folder.0, "").expect("a scene"), SIZE).expect("none").is_empty());
}

#[test]
fn what_was_is_asked_for_in_words_that_are_known() {
    let folder = Folder::new("changes-wrong");
    states(&folder);
    let message = |content: &str| parsed(&folder.0, &lens(content)).expect_err("wrong");
    assert!(
        message("only = \"gone\"")
            .contains("\"gone\" became of no object of an earlier state; expected some of \"removed\"")
    );
    assert!(message("key = \"number\"").contains("has a meaning only with only"));
    let own = lens("only = \"removed\"").replace("files = [\"old.city.json\"], ", "");
    assert!(parsed(&folder.0, &own).expect_err("wrong").contains("has a meaning only with files"));
    // What is written is read again.
    let scene = parsed(&folder.0, &lens("only = [\"removed\", \"other shape\"], key = \"number\"")).expect("a scene");
    let options = scene_file::Options { base: folder.0.clone(), ..Default::default() };
    let again = scene_file::parse(&scene_file::to_toml_for(&scene, &options), "s.toml", &options).expect("a scene");
    assert_eq!(again.lenses, scene.lenses);
}
