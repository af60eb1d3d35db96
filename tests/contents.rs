//! Contents of lenses (C3, C6): what shows where, against rays in f64 and the rule; shadows, edges, and both back ends.

mod studio;

use glam::DVec3;
use studio::*;
use veduta::{
    city::{CityModel, Lod, shown::shown_geometries},
    geom::{Aabb, Ray, Shape, ray::TriangleTest},
    lens::{Class, Content, Focus, Lens, LensKind, classify::classify},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    shader::Clip,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [140, 96];

/// A city as the oracle has it: its triangles where they stand, with the id and normal of each.
struct City {
    triangles: Vec<([DVec3; 3], u32)>,
}

impl City {
    fn new(model: &CityModel, geometries: &[u32], first_object: u32, place: impl Fn(DVec3) -> DVec3) -> Self {
        let mut triangles = Vec::new();
        for &g in geometries {
            let geometry = &model.geometries[g as usize];
            for t in geometry.tiles.clone() {
                let tile = &model.tiles[t as usize];
                for corners in model.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
                    let corner = |k: usize| place(model.position(tile, tile.vertices.start + corners[k]));
                    triangles.push(([corner(0), corner(1), corner(2)], geometry.object + first_object + 1));
                }
            }
        }
        Self { triangles }
    }
}

/// A lens as the oracle has it.
struct Shows {
    reference: Reference,
    class: Class,
    clip: Clip,
    /// Index among the cities.
    city: usize,
}

/// Which cities show where a ray is at a distance, one bit each; and how far that is from where it changes.
fn shown_at(lenses: &[Shows], ray: &Ray, d: f64) -> (u32, f64) {
    let (mut shown, mut below, mut room) = (1_u32, 0_u32, f64::INFINITY);
    for lens in lenses {
        let intervals = lens.reference.intervals(ray);
        room = intervals.iter().flat_map(|(a, b)| [(d - a).abs(), (d - b).abs()]).fold(room, f64::min);
        if classify(&intervals, d) != lens.class {
            continue;
        }
        let own = 1 << lens.city;
        shown = match lens.clip {
            Clip::Order => own,
            Clip::Merge => shown | own,
            Clip::Discard if below & !own != 0 => 0,
            Clip::Discard => own,
        };
        below |= own;
    }
    (shown, room)
}

/// Holds depths and object ids to what rays meet first of what shows; returns how many pixels show each city.
fn compare(drawn: &Picture, view: &View, cities: &[City], lenses: &[Shows]) -> Vec<usize> {
    let (ids, depth) = (drawn.object_id.as_ref().expect("ids"), drawn.depth.as_ref().expect("depths"));
    let [w, h] = drawn.size;
    let mut wanted: Vec<(Vec<u32>, f64, bool, usize)> = Vec::new();
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let ray = view.pixel_ray(x, y);
        let test = TriangleTest::new(&ray).expect("a direction");
        let (mut nearest, mut objects, mut is_sure, mut whose) = (f64::INFINITY, vec![0], true, 0);
        for (number, city) in cities.iter().enumerate() {
            for (corners, object) in &city.triangles {
                let Some(d) = test.hit(*corners) else { continue };
                let (shown, room) = shown_at(lenses, &ray, d);
                is_sure &= room > d * 4e-6 + 1e-4;
                if shown >> number & 1 == 0 || d > nearest * (1.0 + 1e-6) {
                    continue;
                }
                if d < nearest * (1.0 - 1e-6) {
                    objects.clear();
                }
                (nearest, whose) = (nearest.min(d), number);
                objects.push(*object);
            }
        }
        wanted.push((objects, nearest, is_sure, whose));
    }
    let wanted_ids: Vec<u32> = wanted.iter().map(|w| w.0[0]).collect();
    let is_silhouette = |ids: &[u32], i: usize| {
        let near = [i.wrapping_sub(1), i + 1, i.wrapping_sub(w as usize), i + w as usize];
        near.iter().any(|&n| ids.get(n) != Some(&ids[i]))
    };
    let (mut compared, mut unsure) = (0, 0);
    let mut shows = vec![0; cities.len()];
    for (i, (objects, nearest, is_sure, whose)) in wanted.iter().enumerate() {
        let is_near = ids[i] == 0 || (f64::from(depth[i]) / nearest - 1.0).abs() < 1e-4;
        if objects.contains(&ids[i]) && is_near {
            compared += 1;
            shows[*whose] += usize::from(ids[i] != 0);
            continue;
        }
        assert!(
            !is_sure || is_silhouette(ids, i) || is_silhouette(&wanted_ids, i),
            "pixel {}, {}: object {} at {}, wanted {objects:?} at {nearest}",
            i as u32 % w,
            i as u32 / w,
            ids[i],
            depth[i]
        );
        unsure += 1;
    }
    assert!(unsure * 12 < compared, "{unsure} of {compared} pixels are on borders");
    shows
}

fn showing(name: &str, shape: impl Into<Focus>, content: Content) -> Lens {
    let kind = LensKind::Content;
    Lens { kind, effects: vec![], content: Some(content), ..lens(name, [shape.into()], "sepia") }
}

fn lod(text: &str) -> Content {
    Content { lod: Lod::parse(text), ..Content::default() }
}

/// Streets of houses in two levels of detail: a LoD 2 with roofs and a LoD 1 of blocks.
fn two_levels() -> (Studio, Scene) {
    let folder = std::env::temp_dir();
    let path = folder.join(format!("veduta-levels-{}-{:?}.city.json", std::process::id(), std::thread::current().id()));
    std::fs::write(&path, levels(6, 0.0, 6.0)).expect("a temporary file");
    let camera = Camera::looking(DVec3::new(-40.0, -70.0, 60.0), DVec3::new(45.0, 45.0, 0.0), 0.8);
    let mut scene = scene(camera, vec![]);
    scene.city.files = vec![path.clone()];
    scene.city.ground = false;
    let studio = of_scene(&scene);
    std::fs::remove_file(path).expect("the temporary file");
    (studio, scene)
}

/// CityJSON of `n`×`n` houses on plots of 16 m, a terrain under them: LoD 1 blocks of 5 m, LoD 2 with a ridge `ridge` m
/// higher; all shifted by `shift` m to the east.
fn levels(n: usize, shift: f64, ridge: f64) -> String {
    let mut vertices: Vec<String> = Vec::new();
    let mut objects: Vec<String> = Vec::new();
    let mut add = |x: f64, y: f64, z: f64| {
        vertices.push(format!("[{},{},{}]", ((x + shift) * 1000.0) as i64, (y * 1000.0) as i64, (z * 1000.0) as i64));
        vertices.len() - 1
    };
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let (x, y) = (i as f64 * 16.0, j as f64 * 16.0);
        let corners = [(x, y), (x + 10.0, y), (x + 10.0, y + 9.0), (x, y + 9.0)];
        let low = corners.map(|(x, y)| add(x, y, 0.0));
        let high = corners.map(|(x, y)| add(x, y, 5.0));
        let ridge = [add(x, y + 4.5, 5.0 + ridge), add(x + 10.0, y + 4.5, 5.0 + ridge)];
        let wall = |k: usize| format!("[[{},{},{},{}]]", low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]);
        let [a, b, c, d] = high;
        let [p, q] = ridge;
        let flat = format!("{},{},{},{},[[{a},{b},{c},{d}]]", wall(0), wall(1), wall(2), wall(3));
        let steep = format!(
            "{},{},{},{},[[{a},{b},{q},{p}]],[[{c},{d},{p},{q}]],[[{b},{c},{q}]],[[{d},{a},{p}]]",
            wall(0),
            wall(1),
            wall(2),
            wall(3)
        );
        let geometry = |lod: &str, faces: &str| {
            format!("{{\"type\":\"MultiSurface\",\"lod\":\"{lod}\",\"boundaries\":[{faces}]}}")
        };
        objects.push(format!(
            "\"house-{i}-{j}\":{{\"type\":\"Building\",\"attributes\":{{\"year\":{}}},\"geometry\":[{},{}]}}",
            1900 + 10 * i + j,
            geometry("1", &flat),
            geometry("2", &steep)
        ));
    }
    let far = 16.0 * n as f64;
    let ground = [(-10.0, -10.0), (far, -10.0), (far, far), (-10.0, far)].map(|(x, y)| add(x, y, -0.5));
    let [a, b, c, d] = ground;
    objects.push(format!(
        "\"ground\":{{\"type\":\"LandUse\",\"geometry\":[{{\"type\":\"MultiSurface\",\"lod\":\"1\",\"boundaries\":[[[{a},{b},{c},{d}]]]}}]}}"
    ));
    format!(
        "{{\"type\":\"CityJSON\",\"version\":\"2.0\",\"transform\":{{\"scale\":[0.001,0.001,0.001],\"translate\":[0,0,0]}},\
         \"CityObjects\":{{{}}},\"vertices\":[{}]}}",
        objects.join(","),
        vertices.join(",")
    )
}

fn view_of(scene: &Scene) -> View {
    let around = Aabb { min: DVec3::splat(-1e3), max: DVec3::splat(1e3) };
    View::new(scene.camera.expect("a camera"), SIZE, &around).expect("a view")
}

fn level(studio: &Studio, text: &str) -> City {
    City::new(&studio.model, &shown_geometries(&studio.model, Lod::parse(text)), 0, |p| p)
}

fn shows(lens: &Lens, city: usize) -> Shows {
    let content = lens.content.as_ref().expect("a content");
    Shows { reference: Reference::of(&lens.shapes[0]), class: content.class, clip: content.clip, city }
}

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { size: SIZE, samples: 1, transparent: false, aovs: ALL, statistics: true, backend };
    studio.render(scene, &request).expect("a picture")
}

#[test]
fn a_lens_shows_the_city_in_another_level_of_detail() {
    let (mut studio, mut scene) = two_levels();
    let cities = [level(&studio, "2"), level(&studio, "1")];
    let at = DVec3::new(45.0, 40.0, 4.0);
    for shape in shapes(at, 30.0) {
        for class in [Class::Inside, Class::Behind, Class::Rest, Class::Front] {
            scene.lenses = vec![showing("blocks", shape.clone(), Content { class, ..lod("1") })];
            let drawn = draw(&mut studio, &scene, Backend::Specialised);
            let found = compare(&drawn, &view_of(&scene), &cities, &[shows(&scene.lenses[0], 1)]);
            let least = if class == Class::Front { 0 } else { 40 };
            assert!(found[0] > 80 && found[1] > least, "{shape:?} {class:?}: {found:?}");
            assert!(drawn.statistics.contents[0].triangles < drawn.statistics.city.triangles);
        }
    }
}

#[test]
fn lenses_below_and_above_decide_by_their_order() {
    let (mut studio, mut scene) = two_levels();
    let cities = [level(&studio, "2"), level(&studio, "1")];
    let ball = |by: f64| Shape::Sphere { center: DVec3::new(40.0 + by, 40.0, 4.0), radius: 22.0 };
    let blocks = showing("blocks", ball(-8.0), lod("1"));
    let roofs = showing("roofs", ball(8.0), lod("2"));
    for order in [[&blocks, &roofs], [&roofs, &blocks]] {
        scene.lenses = order.map(Clone::clone).to_vec();
        let lenses = order.map(|lens| shows(lens, usize::from(lens.name == "blocks")));
        let found = compare(&draw(&mut studio, &scene, Backend::Uber), &view_of(&scene), &cities, &lenses);
        assert!(found.iter().all(|count| *count > 100), "{found:?}");
    }
}
