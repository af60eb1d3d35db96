//! Sections: what lenses lay open of closed shells, against windings along rays in f64.

use std::collections::BTreeMap;

use crate::studio::*;
use glam::{DQuat, DVec2, DVec3};
use veduta::{
    city::CityModel,
    geom::{Aabb, Ray, Shape, ray::TriangleTest},
    lens::{Class, EffectUse, Lens, LensSprite, Parameter, Region},
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [120, 80];
const CUT: [f32; 3] = [0.6, 0.3, 0.2];

/// A lens that takes away what is in it, or before it, and closes what it opens.
fn cut(name: &str, shape: impl Into<Region>, class: Class) -> Lens {
    let effect = EffectUse { class, ..used("eraser") };
    Lens { effects: vec![effect], section: Some(CUT), ..lens(name, vec![shape.into()], "eraser") }
}

/// What a ray shows: object + 1 (0: several, or nothing), D, and whether it is a section, of which lens.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    object: u32,
    distance: f64,
    section: Option<usize>,
}

/// What a ray shows of closed shells that lenses cut, each given with the class that it hides.
fn shown((model, all): (&CityModel, &[Triangle]), lenses: &[(Reference, Class)], ray: &Ray) -> Shown {
    let test = TriangleTest::new(ray).expect("a direction");
    let hits: Vec<(f64, f64, u32, bool)> = all
        .iter()
        .filter_map(|&Triangle { corners: [a, b, c], object, .. }| {
            let stays = model.objects[object as usize].class.is_ground();
            Some((test.hit([a, b, c])?, (b - a).cross(c - a).dot(ray.direction).signum(), object, stays))
        })
        .collect();
    let inside: Vec<Vec<(f64, f64)>> = lenses.iter().map(|(shape, _)| shape.intervals(ray)).collect();
    let is_hidden = |d: f64| {
        lenses.iter().zip(&inside).any(|((_, class), inside)| match class {
            Class::Inside => inside.iter().any(|(a, b)| (*a..=*b).contains(&d)),
            _ => inside.first().is_some_and(|(a, b)| d < *a && *b > 0.0),
        })
    };
    let nothing = Shown { object: 0, distance: f64::INFINITY, section: None };
    let faces = hits.iter().filter(|(d, _, _, stays)| *stays || !is_hidden(*d));
    let faces = faces.map(|&(distance, _, object, _)| Shown { object: object + 1, distance, section: None });
    let ends = (0..lenses.len()).flat_map(|i| {
        let ends = inside[i].iter().map(move |(a, b)| if lenses[i].1 == Class::Inside { *b } else { *a });
        ends.map(move |d| (i, d))
    });
    let sections = ends.filter(|&(_, d)| d > 0.0 && is_hidden(d * (1.0 - 1e-9)) && !is_hidden(d * (1.0 + 1e-9)));
    let sections = sections.filter_map(|(lens, distance)| {
        let mut windings: BTreeMap<u32, f64> = BTreeMap::new();
        let beyond = hits.iter().filter(|(d, _, _, stays)| *d > distance && !stays);
        beyond.for_each(|(_, way, o, _)| *windings.entry(*o).or_default() += way);
        let around: Vec<u32> = windings.into_iter().filter(|(_, w)| *w > 0.5).map(|(o, _)| o).collect();
        let object = if let [one] = around[..] { one + 1 } else { 0 };
        (!around.is_empty()).then_some(Shown { object, distance, section: Some(lens) })
    });
    faces.chain(sections).min_by(|a, b| a.distance.total_cmp(&b.distance)).unwrap_or(nothing)
}

/// The thinnest of the parts of a ray within a volume and of the gaps between them, as part of the way from the first to the last.
fn finest_part(inside: &[(f64, f64)]) -> f64 {
    let (Some(first), Some(last)) = (inside.first(), inside.last()) else { return 1.0 };
    if inside.len() < 2 {
        return 1.0;
    }
    let gaps = inside.windows(2).map(|pair| pair[1].0 - pair[0].1);
    inside.iter().map(|(a, b)| b - a).chain(gaps).fold(f64::INFINITY, f64::min) / (last.1 - first.0.max(0.0))
}

/// Compares pictures with rays; returns how many pixels show sections, and how many of them face elsewhere than the lens.
fn compare(studio: &mut Studio, scene: &Scene, classes: &[Class]) -> (usize, usize) {
    let all = triangles(studio);
    let model = studio.model.clone();
    let city = (&*model, &all[..]);
    let lenses: Vec<(Reference, Class)> =
        scene.lenses.iter().zip(classes).map(|(lens, class)| (Reference::of(&lens.shapes[0]), *class)).collect();
    let view = View::new(scene.camera.expect("a camera"), SIZE, &studio.extent()).expect("a view");
    let drawn = picture(studio, scene, SIZE);
    let (ids, depths) = (drawn.object_id.as_ref().expect("ids"), drawn.depth.as_ref().expect("depths"));
    let normals = drawn.normal.as_ref().expect("normals");
    let (mut sections, mut borders, mut bent) = (0, 0, 0);
    for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
        let ray = view.pixel_ray(x, y);
        let wanted = shown(city, &lenses, &ray);
        let at = f64::from(depths[i]);
        let is_right = at == wanted.distance || (at / wanted.distance - 1.0).abs() < 2e-5;
        if wanted.section.is_none() && ids[i] == wanted.object && is_right {
            continue;
        }
        // A pixel belongs to whoever covers its centre, to the adapter's grid and what floats make of it.
        let by = 0.02_f64.max(2.0 * snapping());
        let beside = [[by, 0.0], [-by, 0.0], [0.0, by], [0.0, -by]].map(|step| {
            let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            shown(city, &lenses, &view.ray(middle + DVec2::from(step)))
        });
        let is_same = |s: &Shown| (s.object, s.section) == (wanted.object, wanted.section);
        let is_near = |s: &Shown| s.distance == wanted.distance || (s.distance / wanted.distance - 1.0).abs() < 0.01;
        let (near, finest) = (view.camera.near_m, lenses.iter().map(|(shape, _)| finest_part(&shape.intervals(&ray))));
        // What is thinner than a step of the search may be missed, and an end before the near plane lies on it.
        let is_seen = wanted.distance > near * 1.1 && finest.fold(1.0, f64::min) > 1.0 / 90.0;
        if !is_seen || !beside.iter().all(|s| is_same(s) && is_near(s)) {
            borders += 1;
            continue;
        }
        // Where the ray goes along a face, that of another place in the pixel is elsewhere.
        let elsewhere = beside.iter().filter(|s| s.distance != wanted.distance);
        let elsewhere = elsewhere.map(|s| (s.distance / wanted.distance - 1.0).abs()).fold(0.0, f64::max);
        assert_eq!(ids[i], wanted.object, "pixel {x}, {y}: at {at}, wanted {wanted:?}");
        assert!(
            at == wanted.distance || (at / wanted.distance - 1.0).abs() < 2e-5 + elsewhere,
            "pixel {x}, {y}: at {at}, wanted {wanted:?}; {:?}",
            scene.lenses[0].shapes
        );
        let Some(number) = wanted.section else { continue };
        sections += 1;
        // The surface of the lens, from how far places are from it.
        let place = ray.at(wanted.distance);
        let step = 1e-3;
        let away = |axis: DVec3| {
            lenses[number].0.distance(place + step * axis) - lenses[number].0.distance(place - step * axis)
        };
        let slope = DVec3::new(away(DVec3::X), away(DVec3::Y), away(DVec3::Z)).normalize_or_zero();
        let normal = glam::Vec3::from(normals[i]).as_dvec3();
        assert!(normal.dot(ray.direction) <= 0.0, "pixel {x}, {y}: faces away");
        bent += usize::from(normal.dot(slope).abs() < 0.98);
    }
    assert!(borders * 5 < (SIZE[0] * SIZE[1]) as usize, "{borders} pixels are on borders");
    (sections, bent)
}

/// Houses, and the middle of the largest of them.
fn town() -> (Studio, DVec3) {
    let studio = synthetic(12);
    let model = &studio.model;
    let geometries = studio.geometries.iter().map(|&g| &model.geometries[g as usize]);
    let houses = geometries.filter(|g| !model.objects[g.object as usize].class.is_ground());
    let size = |bounds: &Aabb| bounds.size().element_product();
    let largest = houses.map(|g| g.bounds).max_by(|a, b| size(a).total_cmp(&size(b))).expect("houses");
    (studio, largest.center())
}

fn cameras(at: DVec3) -> [Camera; 3] {
    [
        Camera::looking(at + DVec3::new(17.0, -24.0, 15.0), at, 0.8),
        orthographic(at + DVec3::new(-60.0, -40.0, 45.0), at, 24.0),
        // In the house, and in the lens.
        Camera::looking(at + DVec3::new(0.4, 0.7, 1.1), at + DVec3::new(9.0, 3.0, -1.0), 1.3),
    ]
}

#[test]
fn a_section_is_where_a_ray_leaves_a_lens_within_a_shell() {
    let (mut studio, at) = town();
    let (mut all, mut all_bent) = (0, 0);
    for (look, camera) in cameras(at).into_iter().enumerate() {
        // Each camera has every third shape, all of them together each.
        let shapes = shapes(at + DVec3::new(1.0, -2.0, 1.5), 6.0).into_iter().enumerate();
        for (_, shape) in shapes.filter(|(i, _)| is_tried(i + look, 3)) {
            let scene = scene(camera, vec![cut("cut", shape, Class::Inside)]);
            let (sections, bent) = compare(&mut studio, &scene, &[Class::Inside]);
            (all, all_bent) = (all + sections, all_bent + bent);
        }
    }
    // Where an edge of the lens goes through a pixel, it faces as neither side does.
    assert!(all_bent * 20 < all, "{all_bent} of {all} face elsewhere than the lens does");
    let least = if is_thorough() { 5000 } else { 1500 };
    assert!(all > least, "{all} pixels show sections");
}

#[test]
fn what_stands_before_a_lens_is_cut_where_rays_enter_it() {
    let (mut studio, at) = town();
    let camera = Camera::looking(at + DVec3::new(17.0, -24.0, 15.0), at, 0.8);
    for shape in &shapes(at, 5.0)[..6] {
        let scene = scene(camera, vec![cut("before", shape.clone(), Class::Front)]);
        let (sections, _) = compare(&mut studio, &scene, &[Class::Front]);
        assert!(sections > 40, "{shape:?}: {sections} pixels show sections");
    }
}

#[test]
fn between_two_lenses_a_slab_is_left() {
    let (mut studio, at) = town();
    let slab = |by: f64| Shape::Box {
        center: at + DVec3::new(by, 0.0, 0.0),
        size: DVec3::new(1.5, 60.0, 60.0),
        rotation: DQuat::from_rotation_z(0.3),
    };
    let ball = Shape::Sphere { center: at + DVec3::new(2.0, -6.0, 3.0), radius: 6.0 };
    for camera in &cameras(at)[..2] {
        let lenses = [slab(-2.0), slab(2.0), ball.clone()].map(|shape| cut("", shape, Class::Inside));
        let (sections, _) = compare(&mut studio, &scene(*camera, lenses.to_vec()), &[Class::Inside; 3]);
        assert!(sections > 200, "{sections} pixels show sections");
    }
}

/// The lower corner of a cube, and what is done to its six rings.
type Cube = ([i32; 3], fn(&mut Vec<Vec<u32>>));

/// A file with cubes of 10 m.
fn cubes(name: &str, all: &[Cube]) -> Studio {
    let (mut objects, mut vertices) = (Vec::new(), Vec::new());
    for (i, (low, change)) in all.iter().enumerate() {
        let first = 8 * i as u32;
        for corner in 0..8 {
            let at: [i32; 3] = std::array::from_fn(|axis| 1000 * (low[axis] + 10 * (corner >> axis & 1)));
            vertices.push(format!("{at:?}"));
        }
        let rings = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut rings: Vec<Vec<u32>> = rings.map(|ring| ring.map(|corner| first + corner).to_vec()).to_vec();
        change(&mut rings);
        let faces: Vec<String> = rings.iter().map(|ring| format!("[{ring:?}]")).collect();
        objects.push(format!(
            r#""cube{i}":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":"2","boundaries":[{}]}}]}}"#,
            faces.join(",")
        ));
    }
    let text = format!(
        r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[0.001,0.001,0.001],"translate":[0,0,0]}},"CityObjects":{{{}}},"vertices":[{}]}}"#,
        objects.join(","),
        vertices.join(",")
    );
    let path = std::env::temp_dir().join(format!("veduta-{name}-{}.city.json", std::process::id()));
    std::fs::write(&path, text).expect("a temporary file");
    let made = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

/// How many pixels show each object in what a ball opens, and how many of them show the colour of sections there.
fn opened(studio: &mut Studio, center: DVec3) -> BTreeMap<u32, usize> {
    let camera = Camera::looking(DVec3::new(32.0, -20.0, 24.0), DVec3::new(5.0, 5.0, 4.0), 0.9);
    let drawn = |studio: &mut Studio, section| {
        let lens = Lens { section, ..cut("cut", Shape::Sphere { center, radius: 6.0 }, Class::Inside) };
        picture(studio, &scene(camera, vec![lens]), SIZE)
    };
    let [hollow, closed] = [None, Some(CUT)].map(|section| drawn(studio, section));
    let ids = closed.object_id.expect("ids");
    let [before, after] = [hollow.depth, closed.depth].map(|depth| depth.expect("depths"));
    let mut found = BTreeMap::new();
    (0..ids.len()).filter(|&i| before[i] != after[i]).for_each(|i| *found.entry(ids[i]).or_default() += 1);
    found
}

#[test]
fn shells_may_face_either_way_and_open_ones_stay_open() {
    let at = DVec3::new(8.0, 1.0, 8.0);
    let mut as_is = cubes("as-is", &[([0; 3], |_| {})]);
    let outward = opened(&mut as_is, at);
    assert!(outward[&1] > 300, "{outward:?}");
    let mut inward = cubes("inward", &[([0; 3], |rings| rings.iter_mut().for_each(|ring| ring.reverse()))]);
    assert_eq!(opened(&mut inward, at), outward);
    let mut open = cubes("open", &[([0; 3], |rings| rings.truncate(5))]);
    assert_eq!(opened(&mut open, at), BTreeMap::new(), "what is open encloses nothing");
    let mut turned = cubes("turned", &[([0; 3], |rings| rings[2].reverse())]);
    assert_eq!(opened(&mut turned, at), BTreeMap::new(), "nor does a shell one face of which looks inwards");
}

#[test]
fn of_what_is_open_a_warning_tells() {
    let open: Cube = ([0; 3], |rings| rings.truncate(5));
    let beside: Cube = ([40, 0, 0], |rings| rings.truncate(5));
    let mut mixed = cubes("mixed", &[open, ([0, 20, 0], |_| {}), beside]);
    let camera = Camera::looking(DVec3::new(62.0, -60.0, 44.0), DVec3::new(5.0, 5.0, 4.0), 0.9);
    let mut told = |lenses: Vec<Lens>| {
        let warnings = picture(&mut mixed, &scene(camera, lenses), SIZE).statistics.warnings;
        let found = warnings.into_iter().find(|w| w["code"] == "open-shells");
        found.map(|w| (w["count"].as_u64().expect("a count"), w["objects"][0].as_str().expect("a name").to_owned()))
    };
    let ball = |radius| Shape::Sphere { center: DVec3::new(5.0, 15.0, 5.0), radius };
    let cut = |radius| cut("ball", ball(radius), Class::Inside);
    assert_eq!(told(vec![cut(12.0)]), Some((1, "ball".to_owned())), "one of the two that are cut");
    assert_eq!(told(vec![cut(4.9)]), None, "none is met");
    assert_eq!(told(vec![cut(30.0)]), None, "both go as a whole, and the third is not met");
    assert_eq!(told(vec![Lens { section: None, ..cut(12.0) }]), None, "nobody asked");
    assert_eq!(told(vec![Lens { effects: vec![used("sepia")], ..cut(12.0) }]), None, "nothing is hidden");
}

#[test]
fn where_shells_overlap_a_section_is_of_none_of_them() {
    // Two that overlap from x = 4 to 10, cut in their common part and beside it.
    let mut both = cubes("overlap", &[([0; 3], |_| {}), ([4, 0, 0], |_| {})]);
    let found = opened(&mut both, DVec3::new(8.0, 0.0, 9.0));
    assert!([0, 1, 2].iter().all(|object| found.get(object).is_some_and(|count| *count > 10)), "{found:?}");
    let mut apart = cubes("apart", &[([0; 3], |_| {}), ([10, 0, 0], |_| {})]);
    let found = opened(&mut apart, DVec3::new(10.0, 0.0, 9.0));
    assert!(found.contains_key(&1) && found.contains_key(&2) && !found.contains_key(&0), "{found:?}");
}

#[test]
fn what_is_not_taken_away_whole_has_no_sections() {
    let (mut studio, at) = town();
    let camera = cameras(at)[0];
    let shape = Shape::Sphere { center: at, radius: 11.0 };
    let whole = picture(&mut studio, &scene(camera, vec![]), SIZE);
    let mut drawn = |effect: EffectUse, section| {
        let lens = Lens { effects: vec![effect], section, ..cut("cut", shape.clone(), Class::Inside) };
        picture(&mut studio, &scene(camera, vec![lens]), SIZE)
    };
    let walls = BTreeMap::from([("part".to_owned(), Parameter::Text("walls".into()))]);
    let walls = EffectUse { parameters: walls, ..used("eraser") };
    let [without, with] = [None, Some(CUT)].map(|section| drawn(walls.clone(), section));
    assert_eq!(without.depth, with.depth, "walls alone are no shell");
    assert_ne!(without.depth, whole.depth, "walls are gone");
    let [without, with] = [None, Some(CUT)].map(|section| drawn(used("sepia"), section));
    assert_eq!(without.rgba, with.rgba);
    let passes = |p: &Picture| p.statistics.passes.iter().map(|pass| pass.name.clone()).collect::<Vec<_>>();
    assert_eq!(passes(&without), passes(&with), "what hides nothing costs nothing");
}

fn request(backend: Backend) -> Request {
    Request { samples: 2, aovs: Aovs { lens_mask: false, ..ALL }, statistics: true, backend, ..Request::plain(SIZE) }
}

#[test]
fn both_back_ends_close_the_same_and_a_moving_lens_compiles_nothing() {
    let (mut studio, at) = town();
    let camera = cameras(at)[0];
    let sprite = Some(LensSprite { resolution: Some(256), ..LensSprite::default() });
    for (which, backend) in [Backend::Specialised, Backend::Uber].into_iter().enumerate() {
        // The back ends take turns; in a thorough run each has all four.
        let some = shapes(at + DVec3::new(2.0, -5.0, 3.0), 9.0).into_iter().enumerate().step_by(3);
        for (i, shape) in some.filter(|(i, _)| is_tried(i / 3 + which, 2)) {
            let at_step = |by: f64| {
                let moved = Region::from(Shape::Sphere { center: at + DVec3::new(by, 0.0, 0.0), radius: 8.0 });
                let lenses = vec![cut("still", shape.clone(), Class::Inside), cut("moving", moved, Class::Inside)];
                Scene { lenses, ..scene(camera, vec![]) }
            };
            let mut draw = |by: f64| studio.render(&at_step(by), &request(backend)).expect("a picture");
            let first = draw(0.0);
            assert!(first.statistics.passes.iter().any(|pass| pass.name == "sections"));
            let again = draw(3.0).statistics;
            assert_eq!(again.pipelines.compiled, 0, "{backend:?} {i}");
            // Out of sight, and back: what is written out is so for the lenses in sight.
            let away = draw(1e5).statistics.pipelines.compiled;
            assert!(away == 0 || backend == Backend::Specialised, "{away} {i}");
            assert_eq!(draw(0.0).statistics.frame.allocations, 0, "{backend:?} {i}");
        }
    }
    for (i, shape) in shapes(at + DVec3::new(2.0, -5.0, 3.0), 9.0).into_iter().enumerate() {
        // Every other shape has a sprite, and in a thorough run each.
        for (_, sprite) in [None, sprite].into_iter().enumerate().filter(|(j, _)| is_tried(i + j, 2)) {
            let lens = Lens { sprite, ..cut("cut", shape.clone(), Class::Inside) };
            let scene = scene(camera, vec![lens]);
            let [one, other] =
                [Backend::Specialised, Backend::Uber].map(|b| studio.render(&scene, &request(b)).expect("a picture"));
            assert!(one.rgba == other.rgba, "{shape:?} {sprite:?}");
            assert!(one.depth == other.depth && one.object_id == other.object_id, "{shape:?} {sprite:?}");
            assert!(one.normal == other.normal, "{shape:?} {sprite:?}");
            if !is_tried(i, 3) {
                continue;
            }
            let mut hollow = scene.clone();
            hollow.lenses[0].section = None;
            let hollow = studio.render(&hollow, &request(Backend::Specialised)).expect("a picture");
            assert!(one.depth != hollow.depth, "{shape:?} {sprite:?}: no section is seen");
        }
    }
}
