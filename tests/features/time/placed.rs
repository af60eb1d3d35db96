//! What moves by a timetable is, at a moment, as if it stood where it is then: for all that asks where things are.

use glam::{DQuat, DVec3};
use veduta::{
    figure::{self, scene_file},
    render::{frame::Backend, picture::Request},
    scene::Scene,
};

use crate::studio::*;

const SIZE: [u32; 2] = [240, 160];

/// A box from one corner to another, metres, put elsewhere.
fn solid(id: &str, [low, high]: [[f64; 3]; 2], put: impl Fn(DVec3) -> DVec3, vertices: &mut Vec<[i64; 3]>) -> String {
    let first = vertices.len();
    for z in [low[2], high[2]] {
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        let millimetres = |[x, y]: [f64; 2]| put(DVec3::new(x, y, z)).to_array().map(|v| (1000.0 * v).round() as i64);
        vertices.extend(corners.map(millimetres));
    }
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let faces = faces.map(|face| vec![face.map(|k: usize| first + k)]);
    format!(
        r#""{id}": {{"type": "Building", "geometry": [{{"type": "Solid", "lod": "2", "boundaries": [{faces:?}]}}]}}"#
    )
}

/// Houses, and a tram that is put elsewhere.
fn city(folder: &Folder, name: &str, put: impl Fn(DVec3) -> DVec3) {
    let mut vertices = Vec::new();
    let still = |p: DVec3| p;
    let objects = [
        solid("tram", [[-6.0, -2.0, 0.0], [6.0, 2.0, 4.0]], put, &mut vertices),
        solid("house", [[20.0, 30.0, 0.0], [36.0, 40.0, 12.0]], still, &mut vertices),
        solid("shed", [[24.0, 8.0, 0.0], [34.0, 14.0, 8.0]], still, &mut vertices),
        solid("far", [[-60.0, 40.0, 0.0], [-44.0, 50.0, 14.0]], still, &mut vertices),
    ];
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}}, "CityObjects": {{{}}}, "vertices": {vertices:?}}}"#,
        objects.join(", ")
    );
    folder.write(name, text);
}

const LENSES: &[(&str, &str)] = &[
    ("a map", "[[lens]]\nname = \"m\"\nkind = \"map-view\"\n"),
    ("a small model", "[[lens]]\nname = \"w\"\nkind = \"worldlet\"\npoi = \"tram\"\n"),
    (
        "another content",
        "[[lens]]\nname = \"c\"\nkind = \"content\"\nshape = { kind = \"sphere\", center = [30, 24, 2], radius = 14.0 }\ncontent = { derive = \"hull\" }\n",
    ),
    (
        "a copy of it",
        "[[lens]]\nname = \"c\"\nkind = \"content\"\nshape = { kind = \"sphere\", center = [10, 0, 6], radius = 12.0 }\ncontent = { from = [30, 22, 2], to = [10, 0, 6], scale = 1.5, rotation_deg = [40, 0, 0] }\n",
    ),
    ("edges of all", "[style]\neffects = [\"edges\"]\n"),
    (
        "what it covers",
        "[[lens]]\nname = \"s\"\nshape = { kind = \"sphere\", center = [30, 24, 2], radius = 7.0 }\neffects = [{ effect = \"eraser\" }]\n",
    ),
    ("nothing", ""),
    (
        "a deformation moves it",
        "[[lens]]\nname = \"d\"\nkind = \"deformation\"\nshape = { kind = \"sphere\", center = [30, 24, 2], radius = 14.0 }\n\
         deform = [{ kind = \"translate\", by = [0, 0, 9] }]\n",
    ),
    ("houses that hide it", "[[lens]]\nname = \"o\"\nkind = \"occlusion\"\npoi = \"tram\"\nrender = \"x-ray\"\n"),
    ("it hides a house", "[[lens]]\nname = \"o\"\nkind = \"occlusion\"\npoi = \"house\"\nrender = \"edges\"\n"),
    (
        "it is lowered",
        "[[lens]]\nname = \"o\"\nkind = \"deformation\"\ndeform = [{ kind = \"lower\", poi = \"house\", factor = 0.2 }]\n",
    ),
    ("a view of it", "[[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"tram\"\n"),
    ("a note about it", "[[lens]]\nname = \"n\"\nkind = \"annotation\"\npoi = \"tram\"\ntext = \"{id}\"\n"),
    (
        "a lens on it",
        "[[lens]]\nname = \"a\"\nattached_to = { object = \"tram\" }\nshape = { kind = \"sphere\", center = [0, 0, 0], radius = 5.0 }\neffects = [\"sepia\"]\n",
    ),
    (
        "a lens of it",
        "[[lens]]\nname = \"a\"\nshape = { kind = \"objects\", ids = [\"tram\"] }\neffects = [\"sepia\"]\n",
    ),
    (
        "a lens that holds it",
        "[[lens]]\nname = \"a\"\nshape = { kind = \"enclosed\", shapes = [{ kind = \"sphere\", center = [30, 24, 2], radius = 3.0 }] }\neffects = [\"sepia\"]\n",
    ),
];

fn scene(folder: &Folder, file: &str, rest: &str) -> Scene {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"{file}\"]\nground = false\n{rest}[camera]\neye = [30, -60, 40]\ntarget = [30, 20, 0]\n\
         [[poi]]\nname = \"tram\"\nobject = \"tram\"\n[[poi]]\nname = \"house\"\nobject = \"house\"\n"
    );
    let options = scene_file::Options { base: folder.0.clone(), ..Default::default() };
    scene_file::parse(&text, "s.toml", &options).unwrap_or_else(|error| panic!("{error}"))
}

/// Holds what moves to a city in which it stands so: where it is, its turn in degrees, its scale.
fn compare(pose: [f64; 5], backend: Backend, every: usize) {
    let folder = Folder::new(&format!("tram-placed-{}", pose[3]));
    let [x, y, z, yaw, scale] = pose;
    let turn = DQuat::from_rotation_z(yaw.to_radians());
    city(&folder, "moving.city.json", |p| p);
    city(&folder, "still.city.json", |p| turn * (scale * p) + DVec3::new(x, y, z));
    // It is there half way.
    let last = [x, y, z, yaw].map(|v| (2.0 * v).to_string()).join(",");
    let table = format!(
        "id,t,x,y,z,yaw,scale\ntram,2025-06-01T08:00:00,0,0,0,0,1\ntram,2025-06-01T08:00:20,{last},{}\n",
        2.0 * scale - 1.0
    );
    folder.write("day.csv", table);
    let mut wrong = Vec::new();
    for (name, lens) in LENSES.iter().step_by(every) {
        let time = format!("timetables = [\"day.csv\"]\n[time]\nat = \"2025-06-01T08:00:10\"\n{lens}");
        let [still, moving] = [scene(&folder, "still.city.json", lens), scene(&folder, "moving.city.json", &time)];
        let drawn = [still, moving].map(|scene| {
            let request = Request { aovs: ALL, backend, ..Request::plain(SIZE) };
            figure::draw(&mut of_scene(&scene), &scene, &request).unwrap_or_else(|error| panic!("{name}: {error}"))
        });
        let is_other = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|i| a[i].abs_diff(b[i]) > 8);
        // Where an edge runs through a pixel, the millimetre counts that one of the cities is rounded to.
        let others = drawn[0].rgba.iter().zip(&drawn[1].rgba).filter(is_other).count();
        let ids = drawn.each_ref().map(|drawn| drawn.object_id.as_ref().expect("ids"));
        let of_others = ids[0].iter().zip(ids[1]).filter(|(a, b)| a != b).count();
        if others > 40 || of_others > 40 {
            wrong.push(format!("{name}: {others}, {of_others}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn what_moves_is_as_if_it_stood_there() {
    // The other back end draws every third of them.
    compare([30.0, 24.0, 0.0, 0.0, 1.0], Backend::Uber, 3);
    compare([31.0, 22.0, 1.5, 25.0, 1.2], Backend::Specialised, 1);
}

#[test]
fn a_view_with_a_moment_of_its_own_looks_where_things_are_then() {
    let folder = Folder::new("tram-view");
    city(&folder, "moving.city.json", |p| p);
    city(&folder, "still.city.json", |p| p + DVec3::new(30.0, 24.0, 0.0));
    folder.write("day.csv", "id,t,x,y,z\ntram,2025-06-01T08:00:00,0,0,0\ntram,2025-06-01T08:00:20,60,48,0\n");
    let lens = |time: &str| format!("[[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"tram\"\n{time}");
    let then = lens("time = [{ op = \"shift\", by = \"10 s\" }]\n");
    let moving = format!("timetables = [\"day.csv\"]\n[time]\nat = \"2025-06-01T08:00:00\"\n{then}");
    let [still, moving] = [("still.city.json", lens("")), ("moving.city.json", moving)].map(|(file, rest)| {
        let scene = scene(&folder, file, &rest);
        let mut studio = of_scene(&scene);
        let mut shown = |scene: &Scene| {
            let drawn = figure::draw(&mut studio, scene, &Request::plain(SIZE)).expect("a picture");
            let place = drawn.overlays.first().expect("an overlay");
            let [x, y] = place.at.map(|v| v as usize);
            let [w, h] = place.size.map(|v| v as usize);
            let width = SIZE[0] as usize;
            let rows = (y..y + h).flat_map(|row| drawn.rgba[row * width + x..row * width + x + w].to_vec());
            (rows.collect::<Vec<_>>(), drawn.rgba.clone())
        };
        let first = shown(&scene);
        // Again, with what is known by now.
        assert!(shown(&scene) == first);
        first.0
    });
    let others = still.iter().zip(&moving).filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 8)).count();
    assert!(still.len() == moving.len() && others < 40, "{others} of {}", still.len());
}

#[test]
fn views_forget_a_city_that_another_view_put_there() {
    let folder = Folder::new("tram-views");
    city(&folder, "moving.city.json", |p| p);
    folder.write("day.csv", "id,t,x,y,z\ntram,2025-06-01T08:00:00,0,0,0\ntram,2025-06-01T08:00:20,60,48,0\n");
    let with = |time: &str| {
        let content =
            "shape = { kind = \"sphere\", center = [30, 24, 2], radius = 14.0 }\ncontent = { derive = \"prism\" }\n";
        let rest = format!(
            "timetables = [\"day.csv\"]\n[[lens]]\nname = \"c\"\nkind = \"content\"\n{content}effects = [\"sepia\"]\n\
             [[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"house\"\n{time}"
        );
        scene(&folder, "moving.city.json", &rest)
    };
    // A picture with a content, then one whose view alone asks for a moment: its city is another one, and the picture's own view has a table of the first.
    let (first, then) = (with(""), with("time = [{ op = \"set\", at = \"2025-06-01T08:00:10\" }]\n"));
    let request = Request { aovs: ALL, ..Request::plain(SIZE) };
    let mut studio = of_scene(&first);
    let mut drawn = |scene: &Scene| figure::draw(&mut studio, scene, &request).expect("a picture");
    let before = drawn(&first);
    let expected = figure::draw(&mut of_scene(&then), &then, &request).expect("a picture");
    for _ in 0..2 {
        let now = drawn(&then);
        assert!(now.rgba == expected.rgba && now.object_id == expected.object_id);
    }
    assert!(drawn(&first).object_id == before.object_id);
}
