//! Contents of lenses: what shows where, against rays in f64 and the rule; shadows, edges, and both back ends.

use crate::studio::*;
use glam::{DQuat, DVec3};
use veduta::{
    city::{
        CityModel, Lod,
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
    },
    figure::scene_file::{Options, parse},
    geom::{Aabb, Ray, Shape, ray::TriangleTest},
    lens::{
        Border, BorderUnit, Class, Content, Copied, Discrete, Lens, Parameter, Region, classify::classify,
        kind::ContentLens,
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Scene, Sun},
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
        let placed = faces(model, geometries).into_iter();
        let triangles = placed.map(|(corners, object)| (corners.map(&place), object + first_object + 1)).collect();
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

fn showing(name: &str, shape: impl Into<Region>, content: Content) -> Lens {
    let kind = ContentLens { content }.into();
    Lens { kind, effects: vec![], ..lens(name, [shape.into()], "sepia") }
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
    let content = lens.content().expect("a content");
    Shows { reference: Reference::of(&lens.shapes[0]), class: content.class, clip: content.clip, city }
}

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

#[test]
fn a_lens_shows_the_city_in_another_level_of_detail() {
    let (mut studio, mut scene) = two_levels();
    let cities = [level(&studio, "2"), level(&studio, "1")];
    let at = DVec3::new(45.0, 40.0, 4.0);
    let others = [Class::Behind, Class::Rest, Class::Front];
    for (i, (shape, other)) in shapes(at, 30.0).into_iter().zip(others.into_iter().cycle()).enumerate() {
        // Shapes take turns; in a thorough run each has both.
        for (_, class) in [Class::Inside, other].into_iter().enumerate().filter(|(j, _)| is_tried(i + j, 2)) {
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

#[test]
fn contents_fade_by_dithering_where_their_lens_does() {
    let (mut studio, mut scene) = two_levels();
    let hard = showing("blocks", ball(DVec3::new(40.0, 40.0, 4.0), 24.0), lod("1"));
    let mut border = Border { width: 16.0, unit: BorderUnit::Metres, discrete: Discrete::Threshold };
    scene.lenses = vec![hard.clone()];
    let plain = draw(&mut studio, &scene, Backend::Specialised);
    let mut shown = |border: Border, effects: Vec<veduta::lens::EffectUse>| {
        scene.lenses = vec![Lens { border: Some(border), effects, ..hard.clone() }];
        let [a, b] = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend));
        assert!(a.rgba == b.rgba && a.depth == b.depth, "the back ends differ");
        a.depth.expect("depths")
    };
    let before = plain.depth.expect("depths");
    let changed = |depth: &[f32]| depth.iter().zip(&before).filter(|(a, b)| a != b).count();
    assert_eq!(changed(&shown(border, vec![])), 0, "it ends where the degree of interest is one half");
    border.discrete = Discrete::Dither;
    let dithered = shown(border, vec![]);
    assert!(changed(&dithered) > 40, "{}", changed(&dithered));
    assert!(shown(border, vec![used("sepia"), used("wireframe")]) != dithered);
}

/// A file of [`levels`] in the folder of temporary files; gone when dropped.
struct File(std::path::PathBuf);

impl File {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-contents-{}-{name}.city.json", std::process::id()));
        std::fs::write(&path, text).expect("a temporary file");
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        // What is gone is gone.
        let _ = std::fs::remove_file(&self.0);
    }
}

fn model_of(path: &std::path::Path) -> CityModel {
    load(&[path.to_owned()], &LoadOptions::default(), &Quiet).expect("the file loads")
}

fn ball(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere { center, radius }
}

/// So large that it holds everything.
fn everywhere() -> Shape {
    ball(DVec3::new(40.0, 40.0, 0.0), 2000.0)
}

#[test]
fn other_data_sets_overlap_as_their_clips_say() {
    let (mut studio, mut scene) = two_levels();
    // Another plan of the same place, and a third.
    let files = [File::new("plan", &levels(5, 5.0, 12.0)), File::new("third", &levels(4, 9.0, 2.0))];
    let models = [0, 1].map(|i| model_of(&files[i].0));
    let own = studio.model.objects.len() as u32;
    let all = |model: &CityModel, first| City::new(model, &shown_geometries(model, None), first, |p| p);
    let cities = [
        level(&studio, "2"),
        all(&models[0], own),
        all(&models[1], own + models[0].objects.len() as u32),
        level(&studio, "1"),
    ];
    let at = |x: f64, y: f64| DVec3::new(40.0 + x, 40.0 + y, 4.0);
    let places = [at(-12.0, -4.0), at(10.0, -6.0), at(0.0, 12.0)];
    let of_files = |i: usize| Content { files: vec![files[i].0.clone()], ..Content::default() };
    let contents = [of_files(0), of_files(1), lod("1")];
    for (round, clips) in [
        [Clip::Order, Clip::Order, Clip::Order],
        [Clip::Order, Clip::Merge, Clip::Merge],
        [Clip::Discard, Clip::Discard, Clip::Discard],
        [Clip::Merge, Clip::Discard, Clip::Order],
        [Clip::Merge, Clip::Order, Clip::Discard],
    ]
    .into_iter()
    .enumerate()
    {
        let one = |i: usize| {
            let content = Content { clip: clips[i], ..contents[i].clone() };
            showing(&i.to_string(), ball(places[i], 24.0), content)
        };
        scene.lenses = (0..3).map(one).collect();
        let rules: Vec<Shows> = scene.lenses.iter().zip(1..).map(|(lens, city)| shows(lens, city)).collect();
        let backend = [Backend::Specialised, Backend::Uber][round % 2];
        let drawn = draw(&mut studio, &scene, backend);
        let found = compare(&drawn, &view_of(&scene), &cities, &rules);
        // What two cities share belongs to the first.
        assert!(found[..3].iter().all(|count| *count > 30) && found[3] > 4, "{clips:?}: {found:?}");
        let firsts: Vec<_> = drawn.statistics.contents.iter().map(|c| c.first_object).collect();
        assert_eq!(firsts, [Some(own), Some(own + models[0].objects.len() as u32), None]);
    }
}

#[test]
fn terrain_may_stay_as_it_is_below() {
    let (mut studio, mut scene) = two_levels();
    let file = File::new("hills", &levels(3, 3.0, 9.0));
    let content = Content { files: vec![file.0.clone()], keep_terrain: true, ..Content::default() };
    scene.lenses = vec![showing("plan", ball(DVec3::new(40.0, 40.0, 0.0), 30.0), content)];
    let own = studio.model.objects.len() as u32;
    let ground = studio.model.find_object("ground").expect("the ground") + 1;
    for backend in [Backend::Specialised, Backend::Uber] {
        let drawn = draw(&mut studio, &scene, backend);
        let inside = bits(&drawn, 0);
        let ids = drawn.object_id.expect("ids");
        let shown = |is_one: &dyn Fn(u32) -> bool| (0..ids.len()).filter(|&i| inside[i] && is_one(ids[i])).count();
        assert!(shown(&|id| id == ground) > 100, "the ground stays: {}", shown(&|id| id == ground));
        assert_eq!(shown(&|id| id == ground + own), 0, "the plan brings none");
        assert!(shown(&|id| id > own) > 100, "houses of the plan are there");
        assert_eq!(shown(&|id| (1..=own).contains(&id) && id != ground), 0, "houses of the city are not");
    }
}

#[test]
fn copies_are_turned_scaled_and_put_into_the_lens() {
    let (mut studio, mut scene) = two_levels();
    let from = DVec3::new(69.0, 68.5, 0.0);
    let center = DVec3::new(30.0, 30.0, 2.0);
    let rotations = [DQuat::IDENTITY, DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(0.3)];
    for (i, (rotation, scale)) in rotations.into_iter().flat_map(|r| [(r, 1.0), (r, 2.5), (r, 0.4)]).enumerate() {
        // To the middle of the lens, or to where it says.
        let to = [None, Some(center + DVec3::new(3.0, -2.0, 1.0))][i % 2];
        let copied = Some(Copied { from: Some(from), to, rotation, scale });
        let content = Content { copied, ..lod(if i % 3 == 2 { "1" } else { "2" }) };
        scene.lenses = vec![showing("copy", ball(center, 26.0), content.clone())];
        let level = content.lod.expect("a level").to_string();
        let target = to.unwrap_or(center);
        let place = |p: DVec3| rotation * ((p - from) * scale) + target;
        let geometries = shown_geometries(&studio.model, Lod::parse(&level));
        let cities = [self::level(&studio, "2"), City::new(&studio.model, &geometries, 0, place)];
        let backend = [Backend::Specialised, Backend::Uber][i / 3];
        let drawn = draw(&mut studio, &scene, backend);
        let found = compare(&drawn, &view_of(&scene), &cities, &[shows(&scene.lenses[0], 1)]);
        assert!(found[1] > 150, "{rotation} {scale}: {found:?}");
        let normals = drawn.normal.expect("normals");
        let turned = rotation * DVec3::Z;
        let is_up = |n: &[f32; 3]| DVec3::from(n.map(f64::from)).dot(turned).abs() > 0.9999;
        assert!(normals.iter().filter(|n| is_up(n)).count() > 20, "{rotation}: the ground of the copy is turned");
    }
}

/// Holds what a scene shows through a lens to what another shows without, to so many steps of a byte: to every pixel where all of the sky is seen. Maps of
/// what its points see are fitted to boxes around what may be seen, and these are others: two pixels at a shadow's border may lie a part of a texel beside.
fn same_as(plain: &Scene, through: &Scene, most: u8, what: &str) {
    let (mut a, mut b) = (of_scene(plain), of_scene(through));
    let with_sky = |scene: &Scene, ambient_occlusion: bool| {
        let mut scene = scene.clone();
        scene.sun.ambient_occlusion = ambient_occlusion;
        scene
    };
    for (backend, hides_sky) in [(Backend::Specialised, false), (Backend::Uber, false), (Backend::Specialised, true)] {
        let (plain, through) = (&with_sky(plain, hides_sky), &with_sky(through, hides_sky));
        let request = Request { samples: 3, aovs: ALL, backend, ..Request::plain(SIZE) };
        let wanted = a.render(plain, &request).expect("a picture");
        let found = b.render(through, &request).expect("a picture");
        assert!(wanted.normal == found.normal, "{what} {backend:?}: normals");
        // An orthographic view ends where its cities do.
        let apart = |a: &Picture, b: &Picture| {
            let depths = a.depth.as_ref().expect("depths").iter().zip(b.depth.as_ref().expect("depths"));
            depths.filter(|(a, b)| a != b && (*a - *b).abs() > 1e-5 * a.abs()).count()
        };
        assert_eq!(apart(&wanted, &found), 0, "{what} {backend:?}: depths");
        let is_apart = |(a, b): (&[u8; 4], &[u8; 4])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > most);
        let wrong = wanted.rgba.iter().zip(&found.rgba).filter(|pair| is_apart(*pair)).count();
        assert!(wrong <= if hides_sky { 2 } else { 0 }, "{what} {backend:?}: {wrong} pixels, hidden sky: {hides_sky}");
    }
}

#[test]
fn a_lens_that_holds_everything_shows_what_a_scene_of_its_content_shows() {
    let file = File::new("whole", &levels(6, 0.0, 6.0));
    let camera = Camera::looking(DVec3::new(-40.0, -70.0, 60.0), DVec3::new(45.0, 45.0, 0.0), 0.8);
    let thematic = veduta::lens::EffectUse {
        parameters: [("attribute".to_owned(), Parameter::Text("year".into()))].into(),
        ..used("thematic")
    };
    let effects = [None, Some(thematic), Some(used("wireframe")), Some(used("hidden-line")), Some(used("blur"))];
    for (i, effect) in effects.into_iter().enumerate() {
        let mut plain = Scene { camera: Some(camera), ..Scene::default() };
        plain.city.files = vec![file.0.clone()];
        plain.style.effects.extend(effect);
        let mut through = plain.clone();
        through.city.lod = Some("1".into());
        let what = format!("{:?}", plain.style.effects.first().map(|e| &e.effect));
        // By a volume and by object: in turn, and in a thorough run both with each effect.
        if is_tried(i, 2) {
            through.lenses = vec![showing("all", everywhere(), lod("2"))];
            same_as(&plain, &through, 0, &what);
        }
        if is_tried(i + 1, 2) {
            let all = Region::Thematic(Default::default());
            through.lenses = vec![showing("all", all, Content { keep_terrain: true, ..lod("2") })];
            same_as(&plain, &through, 0, &format!("{what} by object"));
        }
    }
}

#[test]
fn textures_and_smooth_faces_are_shown_in_a_city_without() {
    let smooth = std::env::temp_dir().join(format!("veduta-contents-{}-smooth.obj", std::process::id()));
    // A tent whose ridge is round.
    let tent = "v 0 0 0\nv 9 0 0\nv 9 3 4\nv 0 3 4\nv 9 6 0\nv 0 6 0\nvn 0 -1 0.2\nvn 0 0 1\nvn 0 1 0.2\n\
                f 1//1 2//1 3//2\nf 1//1 3//2 4//2\nf 4//2 3//2 5//3\nf 4//2 5//3 6//3\n";
    std::fs::write(&smooth, tent).expect("a temporary file");
    let names = ["textures.city.json", "textured.glb", "party-wall.city.json", "door-in-wall.city.json"];
    let files: Vec<std::path::PathBuf> = names.into_iter().map(citydata).chain([smooth.clone()]).collect();
    let is_smooth = |file: &std::path::PathBuf| {
        let studio = studio(std::slice::from_ref(file));
        studio.renderer.city().is_some_and(|city| city.smooth)
    };
    assert!(is_smooth(&smooth) && !is_smooth(&files[0]));
    for (own, other) in files.iter().flat_map(|a| files.iter().map(move |b| (a, b))).filter(|(a, b)| a != b) {
        let shown = studio(std::slice::from_ref(other)).extent();
        let (at, size) = (shown.center(), shown.size().length());
        let camera = orthographic(at + DVec3::new(-0.7, -1.0, 0.8) * size, at, size * 1.2);
        let sun = Sun { shadows: false, ..Sun::default() };
        let mut plain = Scene { camera: Some(camera), sun, ..Scene::default() };
        plain.city.ground = false;
        let mut through = plain.clone();
        plain.city.files = vec![other.clone()];
        through.city.files = vec![own.clone()];
        let content = Content { files: vec![other.clone()], ..Content::default() };
        through.lenses = vec![showing("all", ball(at, 1e7), content)];
        // Colours that go through a target, as textures make them, are bytes.
        same_as(&plain, &through, 1, &format!("{} in {}", other.display(), own.display()));
    }
    std::fs::remove_file(smooth).expect("the temporary file");
}

#[test]
fn lenses_without_content_act_on_what_is_shown() {
    let (mut studio, mut scene) = two_levels();
    scene.sun.shadows = true;
    let at = DVec3::new(40.0, 40.0, 4.0);
    let blocks = showing("blocks", ball(at, 24.0), lod("1"));
    let grey = lens("grey", [ball(at + DVec3::X * 6.0, 24.0)], "greyscale");
    let gone = lens("gone", [ball(at - DVec3::X * 14.0, 14.0)], "eraser");
    let lines = lens("lines", [ball(at + DVec3::new(-4.0, 16.0, 0.0), 12.0)], "wireframe");
    let order = [[&blocks, &grey, &gone, &lines], [&lines, &gone, &grey, &blocks]];
    let pictures = order.map(|lenses| {
        scene.lenses = lenses.map(Clone::clone).to_vec();
        let mut both = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend));
        assert!(both[0].rgba == both[1].rgba && both[0].object_id == both[1].object_id, "the back ends differ");
        std::mem::take(&mut both[0])
    });
    // What is shown goes by the order of contents alone.
    assert!(pictures[0].object_id == pictures[1].object_id && pictures[0].depth == pictures[1].depth);
    let view = view_of(&scene);
    for (picture, bit) in pictures.iter().zip([1, 2]) {
        assert_eq!(wrong_pixels(picture, &view, &grey, bit), 0);
        let inside = bits(picture, bit);
        let is_grey = |[r, g, b, _]: [u8; 4]| r.abs_diff(g) <= 1 && g.abs_diff(b) <= 1;
        let grey = (0..inside.len()).filter(|&i| inside[i] && is_grey(picture.rgba[i])).count();
        let all = inside.iter().filter(|b| **b).count();
        // Lines of a lens above keep their colour.
        assert!(grey * 10 > all * 9, "{grey} of {all}");
    }
}

/// Whatever shows chosen buildings, and wherever: it is in their lens, by both back ends.
#[test]
fn what_other_lenses_show_of_chosen_objects_is_in_a_lens_of_these() {
    let head = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\nground = false\n[camera]\neye = [-190, 90, 120]\ntarget = [0, 0, 30]\n\
                [sun]\nshadows = false\n[[lens]]\nname = \"buildings\"\nshape = { kind = \"thematic\", ids = [\"town-hall\", \"house-020\"] }\n\
                effects = [\"greyscale\"]\n";
    let air = "shape = { kind = \"box\", center = [0, 0, 100], size = [400, 400, 400] }";
    let lifted = "[[lens]]\nname = \"lifts\"\nkind = \"deformation\"\nshape = { kind = \"box\", center = [0, 0, 150], size = [300, 300, 302] }\n\
                  deform = [{ kind = \"translate\", by = [0, 0, 25] }]\nbody = \"none\"\n";
    let contents = [
        "{ derive = \"height\", factor = 5.0 }",
        "{ derive = \"box\", from = [0, 0, 0], to = [-40, 30, 40] }",
        "{ from = [0, 0, 0], to = [10, 60, 45], rotation_deg = [40, 0, 0], scale = 0.7 }",
    ];
    let mut elsewhere = [0; 2];
    for (content, deformation) in contents.into_iter().flat_map(|content| ["", lifted].map(|lens| (content, lens))) {
        let text = format!(
            "{head}[[lens]]\nname = \"other\"\nkind = \"content\"\n{air}\ncontent = {content}\nbody = \"none\"\n{deformation}"
        );
        let scene = parse(&text, "others.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let mut studio = of_scene(&scene);
        let alone = Scene { lenses: scene.lenses[..1].to_vec(), ..scene.clone() };
        let at_home = bits(&draw(&mut studio, &alone, Backend::Specialised), 0);
        for (k, backend) in [Backend::Specialised, Backend::Uber].into_iter().enumerate() {
            let picture = draw(&mut studio, &scene, backend);
            let (ids, is_in) = (picture.object_id.as_ref().expect("ids"), bits(&picture, 0));
            for (i, id) in ids.iter().enumerate() {
                let model = &studio.model;
                let name = |object: u32| &*model.objects[object as usize].id;
                let is_chosen = *id != 0 && ["town-hall", "house-020"].contains(&name(model.root(*id - 1)));
                let at = || format!("pixel {}, {}, {backend:?}\n{text}", i as u32 % SIZE[0], i as u32 / SIZE[0]);
                assert_eq!(is_in[i], is_chosen, "{}", at());
                elsewhere[k] += usize::from(is_chosen && !at_home[i]);
            }
        }
    }
    assert!(elsewhere[0] > 1_000 && elsewhere[0] == elsewhere[1], "{elsewhere:?} pixels show one where none stands");
}

#[test]
fn a_content_that_moves_compiles_nothing_and_one_that_is_absent_costs_nothing() {
    let (mut studio, mut scene) = two_levels();
    scene.sun.shadows = true;
    let file = File::new("moved", &levels(5, 5.0, 12.0));
    let content = Content { files: vec![file.0.clone()], ..Content::default() };
    let copied = Some(Copied { from: Some(DVec3::new(20.0, 20.0, 0.0)), scale: 1.5, ..Copied::default() });
    let mut at = |by: DVec3, enabled: bool, backend: Backend| {
        let center = DVec3::new(40.0, 40.0, 4.0) + by;
        let mut lenses = vec![
            showing("plan", ball(center, 20.0), content.clone()),
            showing("copy", ball(center + DVec3::X * 20.0, 15.0), Content { copied, ..Content::default() }),
        ];
        lenses.iter_mut().for_each(|lens| lens.enabled = enabled);
        scene.lenses = lenses;
        let statistics = draw(&mut studio, &scene, backend).statistics;
        (statistics, studio.renderer.gpu.allocations())
    };
    let far = DVec3::new(0.0, 0.0, 9000.0);
    // Never seen: nothing is loaded.
    let (away, _) = at(far, true, Backend::Specialised);
    let names = |s: &veduta::render::stats::Statistics| s.pipelines.names.join(", ");
    assert!(!names(&away).contains("contents") && away.contents.iter().all(|c| c.gpu_bytes == 0), "{}", names(&away));
    for backend in [Backend::Specialised, Backend::Uber] {
        let (first, _) = at(DVec3::ZERO, true, backend);
        assert!(names(&first).contains("(contents)") && first.contents.len() == 2, "{}", names(&first));
        assert!(
            first.contents[0].gpu_bytes > 0 && first.contents[1].gpu_bytes == 0,
            "a copy takes no memory of its own"
        );
        let mut before = None;
        for by in [DVec3::new(10.0, 0.0, 0.0), DVec3::new(-5.0, 12.0, 3.0), DVec3::new(2.0, 2.0, 0.0)] {
            let (there, allocations) = at(by, true, backend);
            assert_eq!(there.pipelines.compiled, 0, "{}", names(&there));
            let geometry = there.passes.iter().find(|p| p.name == "geometry").expect("a geometry pass");
            assert_eq!(geometry.serves, serde_json::json!([0, 1]));
            let made = before.replace(allocations).map(|before| allocations - before);
            // A picture allocates what it is read through.
            assert!(made.is_none_or(|made| made < 16), "{made:?} allocations");
        }
        let (off, _) = at(DVec3::ZERO, false, backend);
        assert!(off.contents.is_empty(), "{:?}", off.contents);
        // The uber back end holds what the scene may ask for.
        assert!(backend == Backend::Uber || !names(&off).contains("cut"), "{}", names(&off));
    }
}

#[test]
fn tiles_of_a_large_figure_show_the_same() {
    let (mut studio, mut scene) = two_levels();
    // Along a row of roofs.
    let at = DVec3::new(37.0, 39.0, 6.0);
    scene.camera = Some(orthographic(at + DVec3::new(0.0, -60.0, 60.0), at, 0.25));
    scene.lenses = vec![showing("blocks", ball(at, 14.0), lod("1"))];
    let size = [4400, 8];
    let cities = [level(&studio, "2"), level(&studio, "1")];
    let request = Request { aovs: ALL, statistics: true, backend: Backend::Specialised, ..Request::plain(size) };
    let drawn = studio.render(&scene, &request).expect("a picture");
    let around = Aabb { min: DVec3::splat(-1e3), max: DVec3::splat(1e3) };
    let view = View::new(scene.camera.expect("a camera"), size, &around).expect("a view");
    let found = compare(&drawn, &view, &cities, &[shows(&scene.lenses[0], 1)]);
    assert!(found.iter().all(|count| *count > 100), "{found:?}");
    assert!(drawn.statistics.passes.iter().filter(|p| p.name == "geometry").count() > 1, "there is one tile");
}

#[test]
fn what_cannot_be_shown_is_one_clear_line() {
    let (mut studio, mut scene) = two_levels();
    let empty = File::new("empty", r#"{"type":"CityJSON","version":"2.0","CityObjects":{},"vertices":[]}"#);
    let at = DVec3::new(40.0, 40.0, 4.0);
    let files = |path: &str| Content { files: vec![path.into()], ..Content::default() };
    let flat = Shape::Flat {
        center: at,
        rotation: DQuat::IDENTITY,
        figure: veduta::geom::shape::FlatFigure::Disc { radius: 5.0 },
    };
    let scaled = Content { copied: Some(Copied { scale: 2.0, ..Copied::default() }), ..Content::default() };
    for (shape, content, wanted) in [
        (ball(at, 9.0), lod("1.3"), "[lens.0] content.lod: nothing has the level of detail 1.3; there are 1, 2"),
        (ball(at, 9.0), files("/nowhere/a.city.json"), "[lens.0] content.files: /nowhere/a.city.json: cannot be read"),
        (ball(at, 9.0), files(&empty.0.display().to_string()), "empty.city.json hold nothing that can be shown"),
        (flat, scaled, "[lens.0] content.to: is missing: a lens without end has no middle to put it to"),
    ] {
        scene.lenses = vec![showing("wrong", shape, content)];
        let request = Request { aovs: ALL, backend: Backend::Specialised, ..Request::plain(SIZE) };
        let message = studio.render(&scene, &request).expect_err(wanted).to_string();
        assert!(message.contains(wanted) && !message.contains('\n'), "{message}\n  wanted {wanted}");
        scene.lenses[0].enabled = false;
        studio.render(&scene, &request).expect("a lens that is off is not asked");
    }
}
