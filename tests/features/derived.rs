//! Derived contents, drawn: who is seen where, against rays in f64; shadows; both back ends; nothing is made anew.

use crate::studio::{self, *};
use glam::DVec3;
use veduta::{
    city::derived::{Derive, Form, Height, derive},
    geom::{Shape, ray::TriangleTest},
    lens::{
        Content, Lens, Region,
        chosen::{Choice, members},
        kind::ContentLens,
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{CitySpec, Scene, Sun, Transparency},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [160, 110];

const FORMS: [Form; 6] = [
    Form::Box { oriented: false },
    Form::Box { oriented: true },
    Form::Prism,
    Form::Hull,
    Form::Flat { lift_m: 0.05 },
    Form::Height(Height::Factor(1.7)),
];

fn showing(form: Form, focus: impl Into<Region>) -> Lens {
    let content = Content { derive: Some(Derive { form, parts: false }), ..Content::default() };
    Lens { kind: ContentLens { content }.into(), effects: vec![], ..lens("derived", [focus.into()], "sepia") }
}

fn request(backend: Backend) -> Request {
    Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) }
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    studio.render(scene, &request(backend)).expect("a picture")
}

/// From above, and from the street.
fn cameras(studio: &Studio) -> [Camera; 2] {
    let extent = studio.extent();
    let (middle, size) = (extent.center(), extent.size());
    [
        Camera::looking(middle + size.length() * DVec3::new(0.2, -0.5, 0.6), middle, 0.7),
        Camera::looking(middle + size * DVec3::new(-0.1, -0.45, 0.5), middle, 1.0),
    ]
}

#[test]
fn chosen_objects_are_seen_in_their_form_and_under_their_own_number() {
    let mut studio = synthetic(60);
    let (model, geometries) = (studio.model.clone(), studio.geometries.clone());
    let choice = Choice { attribute: Some("yearOfConstruction".into()), min: Some(1950.0), ..Choice::default() };
    let chosen = members(&model, &choice);
    for (number, form) in FORMS.into_iter().enumerate() {
        let made = derive(&model, &geometries, &Derive { form, parts: false });
        // The context without the members but with all ground, and the members' forms.
        let is_ground = |object: u32| model.objects[object as usize].class.is_ground();
        let mut wanted = faces(&model, &geometries);
        wanted.retain(|(_, object)| !chosen[*object as usize] || is_ground(*object));
        let own = faces(&made.model, &made.geometries());
        wanted.extend(own.into_iter().filter(|(_, object)| chosen[*object as usize]));
        let mut seen = 0;
        // The cameras take turns; in a thorough run each form is seen by both.
        let cameras = cameras(&studio).into_iter().enumerate();
        for (_, camera) in cameras.filter(|(i, _)| is_tried(number + i, 2)) {
            let scene = scene(camera, vec![showing(form, Region::Thematic(choice.clone()))]);
            let one = drawn(&mut studio, &scene, Backend::Specialised);
            let other = drawn(&mut studio, &scene, Backend::Uber);
            assert!(one.rgba == other.rgba && one.object_id == other.object_id, "{form:?}: the back ends differ");
            let view = View::new(camera, SIZE, &studio.extent()).expect("a view");
            seen += compare(&one, &view, &wanted, &chosen, form);
        }
        let least = if is_thorough() { 400 } else { 150 };
        assert!(seen > least, "{form:?}: {seen}");
    }
}

/// Holds object ids to what rays meet first; returns how many pixels show chosen objects.
fn compare(drawn: &Picture, view: &View, faces: &[([DVec3; 3], u32)], chosen: &[bool], form: Form) -> usize {
    let ids = drawn.object_id.as_ref().expect("ids");
    let [w, h] = SIZE;
    let first = |x: u32, y: u32| {
        let ray = view.pixel_ray(x, y);
        let test = TriangleTest::new(&ray).expect("a direction");
        let hits = faces.iter().filter_map(|(corners, object)| Some((test.hit(*corners)?, object + 1)));
        let hits: Vec<(f64, u32)> = hits.collect();
        let nearest = hits.iter().map(|(d, _)| *d).fold(f64::INFINITY, f64::min);
        let mut all: Vec<u32> =
            hits.into_iter().filter(|(d, _)| *d <= nearest * (1.0 + 1e-6)).map(|(_, object)| object).collect();
        all.push(if nearest.is_finite() { all[0] } else { 0 });
        all
    };
    let wanted: Vec<Vec<u32>> = (0..h).flat_map(|y| (0..w).map(move |x| first(x, y))).collect();
    let (mut seen, mut unsure) = (0, 0);
    for (i, objects) in wanted.iter().enumerate() {
        let is_chosen = ids[i].checked_sub(1).is_some_and(|object| chosen[object as usize]);
        seen += usize::from(is_chosen);
        if objects.contains(&ids[i]) {
            continue;
        }
        let near = [i.wrapping_sub(1), i + 1, i.wrapping_sub(w as usize), i + w as usize];
        let is_border = near.iter().any(|&n| wanted.get(n).is_none_or(|other| other != objects));
        assert!(is_border, "{form:?}, pixel {}, {}: {} for {objects:?}", i as u32 % w, i as u32 / w, ids[i]);
        unsure += 1;
    }
    assert!(unsure * 100 < wanted.len(), "{form:?}: {unsure} of {} pixels", wanted.len());
    seen
}

/// A tower on a lawn under the midday sun.
fn tower(form: Option<Form>) -> (Studio, Scene) {
    let ring = [[0, 0], [6, 0], [6, 6], [0, 6]];
    let mut vertices: Vec<String> = Vec::new();
    let mut corner = |x: i64, y: i64, z: i64| {
        vertices.push(format!("[{x},{y},{z}]"));
        vertices.len() - 1
    };
    let low = ring.map(|[x, y]| corner(x, y, 0));
    let high = ring.map(|[x, y]| corner(x, y, 14));
    let lawn = [[-40, -40], [46, -40], [46, 46], [-40, 46]].map(|[x, y]| corner(x, y, 0));
    let list = |ring: &[usize]| format!("[[{}]]", ring.iter().map(usize::to_string).collect::<Vec<_>>().join(","));
    let mut walls: Vec<String> =
        (0..4).map(|k| list(&[low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]])).collect();
    walls.extend([list(&high), list(&[low[3], low[2], low[1], low[0]])]);
    let text = format!(
        "{{\"type\":\"CityJSON\",\"version\":\"2.0\",\"transform\":{{\"scale\":[1,1,1],\"translate\":[0,0,0]}},\"CityObjects\":{{\
         \"tower\":{{\"type\":\"Building\",\"geometry\":[{{\"type\":\"MultiSurface\",\"lod\":\"1\",\"boundaries\":[{}]}}]}},\
         \"lawn\":{{\"type\":\"LandUse\",\"geometry\":[{{\"type\":\"MultiSurface\",\"lod\":\"1\",\"boundaries\":[{}]}}]}}}},\
         \"vertices\":[{}]}}",
        walls.join(","),
        list(&lawn),
        vertices.join(",")
    );
    let path = std::env::temp_dir().join(format!(
        "veduta-tower-{}-{:?}.city.json",
        std::process::id(),
        std::thread::current().id()
    ));
    std::fs::write(&path, text).expect("a temporary file");
    let studio = studio::studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    let camera = orthographic(DVec3::new(3.0, 3.0, 90.0), DVec3::new(3.0, 3.001, 0.0), 60.0);
    let everything = Shape::Sphere { center: DVec3::ZERO, radius: 400.0 };
    let lenses = form.map(|form| showing(form, everything)).into_iter().collect();
    let sun = Sun { shadows: true, elevation: 45.0_f64.to_radians(), ..Sun::default() };
    (studio, Scene { sun, ..scene(camera, lenses) })
}

#[test]
fn shadows_are_those_of_the_form() {
    let shaded = |form: Option<Form>| {
        let (mut studio, scene) = tower(form);
        let picture = drawn(&mut studio, &scene, Backend::Specialised);
        let ids = picture.object_id.expect("ids");
        let lawn = |i: &usize| ids[*i] == 2;
        let light = (0..ids.len()).filter(lawn).map(|i| picture.rgba[i][1]).max().expect("a lawn");
        (0..ids.len()).filter(lawn).filter(|&i| picture.rgba[i][1] + 20 < light).count()
    };
    let itself = shaded(None);
    // A square metre is (110 / 60)² pixels; at 45° a wall shades as far as it is high.
    let pixels = f64::from(SIZE[1] * SIZE[1]) / 3600.0;
    assert!((itself as f64 / pixels) > 60.0, "{itself}");
    assert_eq!(shaded(Some(Form::Flat { lift_m: 0.05 })), 0, "what is flat throws none");
    let boxed = shaded(Some(Form::Box { oriented: false }));
    assert!(boxed.abs_diff(itself) <= 3, "{boxed}, {itself}: a box is its own box");
    let half = shaded(Some(Form::Height(Height::Factor(0.5))));
    let ratio = half as f64 / itself as f64;
    assert!((0.4..0.6).contains(&ratio), "{half} of {itself}");
}

#[test]
fn what_is_flat_wins_over_its_ground_in_every_frame() {
    let (mut studio, still) = tower(Some(Form::Flat { lift_m: 0.05 }));
    let target = DVec3::new(3.0, 3.0, 0.0);
    let mut seen = std::collections::BTreeSet::new();
    for i in 0..if is_thorough() { 100 } else { 30 } {
        let t = f64::from(i);
        let jitter = 1e-3 * DVec3::new((t * 0.618_034).fract(), (t * 0.754_878).fract(), (t * 0.569_840).fract());
        let camera = Camera::looking(target + DVec3::new(130.0, -290.0, 41.0) + jitter, target + jitter, 0.012);
        let picture = drawn(&mut studio, &Scene { camera: Some(camera), ..still.clone() }, Backend::Specialised);
        let ids = picture.object_id.expect("ids");
        seen.extend((50..60).flat_map(|y| (70..90).map(move |x| (x, y))).map(|(x, y)| ids[y * SIZE[0] as usize + x]));
    }
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), [1], "objects (index + 1) in the middle of the tower's plan");
}

#[test]
fn nothing_is_made_anew_where_lenses_move_and_members_change() {
    for backend in [Backend::Specialised, Backend::Uber] {
        let mut studio = synthetic(60);
        let middle = studio.extent().center();
        let [camera, _] = cameras(&studio);
        let form = Form::Box { oriented: false };
        let by_place = |x: f64| Shape::Sphere { center: middle + DVec3::X * x, radius: 40.0 };
        let by_object = |year: f64| {
            Region::Thematic(Choice {
                attribute: Some("yearOfConstruction".into()),
                min: Some(year),
                ..Choice::default()
            })
        };
        let mut compiled = |focus: Region| {
            let picture = drawn(&mut studio, &scene(camera, vec![showing(form, focus)]), backend);
            let contents = picture.statistics.contents;
            (picture.statistics.pipelines.compiled, contents[0].triangles, studio.renderer.gpu.allocations())
        };
        for [first, second] in [[by_place(0.0).into(), by_place(9.0).into()], [by_object(1950.0), by_object(1990.0)]] {
            let (_, triangles, before) = compiled(first);
            let (count, again, after) = compiled(second);
            assert_eq!((count, again), (0, triangles), "{backend:?}");
            // A picture allocates what it is read through.
            assert!(after - before < 16, "{backend:?}: {} allocations", after - before);
        }
    }
}

#[test]
fn objects_without_the_form_are_told_of() {
    let mut studio = studio::studio(&[citydata("roof-on-roof.city.json")]);
    let everything = || Shape::Sphere { center: DVec3::ZERO, radius: 400.0 };
    let camera = Camera::looking(DVec3::new(13.0, -29.0, 41.0), DVec3::new(3.0, 4.0, 3.0), 0.5);
    let mut told = |form: Form| -> Vec<(String, u64)> {
        let picture = drawn(&mut studio, &scene(camera, vec![showing(form, everything())]), Backend::Specialised);
        let warnings = picture.statistics.warnings.iter();
        let ours = warnings.filter(|w| w["code"].as_str().is_some_and(|code| code.ends_with("derived")));
        ours.map(|w| (w["code"].as_str().unwrap().to_owned(), w["count"].as_u64().unwrap())).collect()
    };
    assert_eq!(told(Form::Hull), [("not-derived".to_owned(), 1)], "the awning is flat");
    assert_eq!(told(Form::Flat { lift_m: 0.05 }), []);
}

/// Normals and colours of the pixels that show an object, or the plain ground (0).
fn looks(picture: &Picture, id: u32) -> Vec<([f32; 3], [u8; 4])> {
    let (ids, depth) = (picture.object_id.as_ref().unwrap(), picture.depth.as_ref().unwrap());
    let normals = picture.normal.as_ref().unwrap();
    let is_it = |i: &usize| ids[*i] == id && depth[*i].is_finite();
    (0..ids.len()).filter(is_it).map(|i| (normals[i], picture.rgba[i])).collect()
}

#[test]
fn level_light_stays_level_however_low_the_eye_is() {
    // Pressed flat on a slope that rises above the eye.
    let mut studio = boxes("slope", &[([-15, 100, 40], [30, 30, 40])], true, false);
    let ball = Shape::Sphere { center: DVec3::new(0.0, 110.0, 60.0), radius: 80.0 };
    let mut colors = Vec::new();
    for height in [20.0, 120.0] {
        let camera = Camera::looking(DVec3::new(10.0, -80.0, height), DVec3::new(0.0, 100.0, 50.0), 0.8);
        let scene = scene(camera, vec![showing(Form::Flat { lift_m: 0.05 }, ball.clone())]);
        let picture = drawn(&mut studio, &scene, Backend::default());
        let id = studio.model.find_object("box 0").unwrap() + 1;
        let all = looks(&picture, id);
        assert!(all.len() > 40, "{} pixels show it", all.len());
        let others: Vec<_> = all.iter().filter(|(normal, _)| *normal != [0.0, 0.0, 1.0]).collect();
        assert!(
            others.is_empty(),
            "from {height} m {} of {}: {:?}",
            others.len(),
            all.len(),
            &others[..others.len().min(3)]
        );
        // Hazy with the distance, but not dark.
        colors.push(all.iter().map(|(_, color)| i32::from(color[0])).max().unwrap());
    }
    assert!((colors[0] - colors[1]).abs() < 12, "{colors:?}");
    // The plain ground between a low and a high house.
    let houses = [([0, 0, 0], [12, 12, 10]), ([0, 300, 60], [12, 12, 10]), ([0, 150, 30], [12, 12, 10])];
    let mut studio = boxes("hill", &houses, false, true);
    let camera = Camera::looking(DVec3::new(30.0, -60.0, 8.0), DVec3::new(20.0, 200.0, 30.0), 0.8);
    let picture = drawn(&mut studio, &scene(camera, vec![]), Backend::default());
    let ground = looks(&picture, 0);
    assert!(ground.len() > 2000, "{} pixels show ground", ground.len());
    assert!(ground.iter().all(|(normal, _)| *normal == [0.0, 0.0, 1.0]));
}

/// A floor that lies in the plane of ground that stays is hidden by it: last bits of depths decide nothing. Layers are counted by rays in
/// f64.
#[test]
fn floors_of_contents_are_hidden_by_the_ground_in_their_plane() {
    let city = CitySpec { files: vec!["builtin:square".into()], ..CitySpec::default() };
    let mut studio = of_scene(&Scene { city, ..Scene::default() });
    let (model, geometries) = (studio.model.clone(), studio.geometries.clone());
    let form = Form::Box { oriented: false };
    let made = derive(&model, &geometries, &Derive { form, parts: false });
    let is_ground = |object: u32| model.objects[object as usize].class.is_ground();
    let [mut ground, mut blocks] = [faces(&model, &geometries), faces(&made.model, &made.geometries())];
    ground.retain(|(_, object)| is_ground(*object));
    blocks.retain(|(_, object)| !is_ground(*object));
    let everywhere = Shape::Sphere { center: DVec3::ZERO, radius: 2000.0 };
    let lens = Lens { effects: vec![used("transparent")], ..showing(form, everywhere) };
    let size = [64, 40];
    for (number, camera) in cameras(&studio).into_iter().enumerate() {
        let view = View::new(camera, size, &studio.extent()).expect("a view");
        let (mut layers, mut floors) = (0_u64, 0_u64);
        for ray in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y])).map(|[x, y]| view.pixel_ray(x, y)) {
            let test = TriangleTest::new(&ray).expect("a direction");
            let hits = |faces: &[([DVec3; 3], u32)]| -> Vec<f64> {
                faces.iter().filter_map(|(corners, _)| test.hit(*corners)).collect()
            };
            let end = hits(&ground).into_iter().fold(f64::INFINITY, f64::min);
            for d in hits(&blocks) {
                layers += u64::from(d < end * (1.0 - 1e-5));
                floors += u64::from((d - end).abs() <= 1e-5 * end);
            }
        }
        assert!(floors * 20 > layers, "{floors} floors in the ground among {layers} layers");
        for transparency in [Transparency::Exact, Transparency::Peel { layers: 0 }] {
            let mut scene = scene(camera, vec![lens.clone()]);
            scene.style.transparency = transparency;
            let request = Request { size, ..request(Backend::Specialised) };
            let picture = studio.render(&scene, &request).expect("a picture");
            let drawn = picture.statistics.frame.layers.expect("layers").fragments;
            // The rasteriser's grid moves borders.
            let off = drawn.abs_diff(layers);
            assert!(off * 100 < layers, "view {number}, {transparency:?}: {drawn} for {layers} and {floors} floors");
        }
    }
}
