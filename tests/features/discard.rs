//! Effects that discard parts of the city: what is there afterwards, against rays in f64; shadows, and both back ends.

use std::collections::BTreeMap;

use crate::studio::*;
use glam::DVec3;
use veduta::{
    city::{CityModel, NONE, ObjectClass, StringId},
    geom::{Ray, Shape, ray::TriangleTest},
    lens::{Class, EffectUse, Lens, Parameter, Region, classify::classify},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Scene, Sun},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [120, 80];

fn eraser(parameters: &[(&str, Parameter)], class: Class) -> EffectUse {
    let parameters: BTreeMap<_, _> = parameters.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect();
    EffectUse { parameters, class, ..used("eraser") }
}

fn with(effect: EffectUse, shape: &(impl Clone + Into<Region>)) -> Lens {
    Lens { effects: vec![effect], ..lens("gone", vec![shape.clone()], "eraser") }
}

/// Where what a ray meets at D is, and how sure that is: the distance of D from the nearest border of the lens.
fn class_of(reference: &Reference, ray: &Ray, d: f64) -> (Class, f64) {
    let intervals = reference.intervals(ray);
    let room = intervals.iter().flat_map(|(a, b)| [(d - a).abs(), (d - b).abs()]).fold(f64::INFINITY, f64::min);
    (classify(&intervals, d), room)
}

/// Compares the objects shown with those that rays meet first, among the triangles that are not `hidden`; returns how many
/// pixels show something else than without the lens.
fn compare(
    studio: &mut Studio,
    scene: &Scene,
    shape: &Region,
    class: Class,
    hidden: &dyn Fn(&CityModel, &Triangle) -> bool,
) -> usize {
    let all = triangles(studio);
    let reference = Reference::of(shape);
    let view = View::new(scene.camera.expect("a camera"), SIZE, &studio.extent()).expect("a view");
    let drawn = picture(studio, scene, SIZE);
    let plain = picture(studio, &Scene { lenses: vec![], ..scene.clone() }, SIZE);
    let (shown, before) = (drawn.object_id.expect("ids"), plain.depth.expect("depths"));
    let depth = drawn.depth.expect("depths");
    let pixels: Vec<(u32, u32)> = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).collect();
    // What rays meet first: objects + 1 (several share a plane), its distance, and whether a float could not see it otherwise.
    let expected = |&(x, y): &(u32, u32)| {
        let ray = view.pixel_ray(x, y);
        let test = TriangleTest::new(&ray).expect("a direction");
        let (mut nearest, mut objects, mut is_sure, mut slant) = (f64::INFINITY, vec![0], true, 0.0);
        for triangle in &all {
            let Some(d) = test.hit(triangle.corners) else { continue };
            let (found, room) = class_of(&reference, &ray, d);
            let may_go = hidden(&studio.model, triangle);
            // A float may fall on the other side of a border so near.
            is_sure &= !may_go || room > d * 2e-6;
            if (may_go && found == class) || d > nearest * (1.0 + 1e-6) {
                continue;
            }
            if d < nearest * (1.0 - 1e-6) {
                objects.clear();
            }
            nearest = nearest.min(d);
            objects.push(triangle.object + 1);
            let [a, b, c] = triangle.corners;
            slant = ray.direction.length() / (b - a).cross(c - a).normalize_or(DVec3::Z).dot(ray.direction).abs();
        }
        // What is beside its face by the adapter's grid is farther off along the ray.
        let room = 1e-4 * nearest + if nearest.is_finite() { slant * off_face(&view, nearest) } else { 0.0 };
        (objects, nearest, room, is_sure)
    };
    let wanted: Vec<(Vec<u32>, f64, f64, bool)> = pixels.iter().map(expected).collect();
    let wanted_ids: Vec<u32> = wanted.iter().map(|w| w.0[0]).collect();
    let (mut compared, mut unsure) = (0, 0);
    for (i, &(ref objects, nearest, room, is_sure)) in wanted.iter().enumerate() {
        let is_near = (f64::from(depth[i]) - nearest).abs() < room;
        if objects.contains(&shown[i]) && (shown[i] == 0 || is_near) {
            compared += 1;
            continue;
        }
        // Pixels of an edge belong to whoever covers their centre, to 1/256 pixel.
        assert!(
            !is_sure || is_silhouette(&shown, i) || is_silhouette(&wanted_ids, i),
            "{shape:?}, pixel {:?}: object {} at {}, wanted {objects:?} at {nearest}",
            pixels[i],
            shown[i],
            depth[i]
        );
        unsure += 1;
    }
    assert!(unsure * 20 < compared, "{unsure} of {compared} pixels are on borders");
    (0..shown.len()).filter(|&i| depth[i].to_bits() != before[i].to_bits()).count()
}

fn is_silhouette(ids: &[u32], i: usize) -> bool {
    let w = SIZE[0] as usize;
    let near = [i.wrapping_sub(1), i + 1, i.wrapping_sub(w), i + w];
    near.iter().any(|&n| ids.get(n) != Some(&ids[i]))
}

/// A town, a camera over it, and a point in it.
fn town() -> (Studio, Camera, DVec3) {
    let studio = synthetic(40);
    let number = studio.geometries[studio.geometries.len() / 2];
    let at = studio.model.geometries[number as usize].bounds.center();
    (studio, Camera::looking(at + DVec3::new(70.0, -90.0, 60.0), at, 0.8), at)
}

fn is_terrain(model: &CityModel, triangle: &Triangle) -> bool {
    use ObjectClass::{Land, Road, Terrain, Water};
    matches!(model.objects[triangle.object as usize].class, Terrain | Water | Road | Land)
}

fn kind<'a>(model: &'a CityModel, triangle: &Triangle) -> &'a str {
    let kind = model.surfaces[triangle.surface as usize].kind;
    if kind == StringId(NONE) { "" } else { model.strings.get(kind) }
}

#[test]
fn what_is_shown_is_what_rays_meet_first_of_what_is_left() {
    let (mut studio, camera, at) = town();
    let word = |w: &str| [("part", Parameter::Text(w.into()))];
    for (i, shape) in shapes(at, 45.0).into_iter().enumerate() {
        // Two of the six for each shape, and in a thorough run all; each with three or four shapes.
        let mut number = i;
        let mut check = |effect: EffectUse, hidden: &dyn Fn(&CityModel, &Triangle) -> bool| {
            number += 1;
            if !is_tried(number, 3) {
                return;
            }
            let class = effect.class;
            let scene = scene(camera, vec![with(effect, &shape)]);
            let changed = compare(&mut studio, &scene, &shape, class, hidden);
            // Behind a small volume there is little but sky.
            let least = if class == Class::Behind { 4 } else { 20 };
            assert!(changed > least, "{shape:?} {class:?}: only {changed} pixels changed");
        };
        check(eraser(&[], Class::Inside), &|model, t| !is_terrain(model, t));
        let all = [("keep_terrain", Parameter::Boolean(false))];
        check(eraser(&all, Class::Inside), &|_, _| true);
        check(eraser(&word("walls"), Class::Inside), &|model, t| kind(model, t) == "WallSurface");
        check(eraser(&word("roofs"), Class::Inside), &|model, t| kind(model, t) == "RoofSurface");
        check(eraser(&all, Class::Behind), &|_, _| true);
        check(eraser(&[], Class::Rest), &|model, t| !is_terrain(model, t));
    }
}

#[test]
fn what_stands_before_a_lens_goes() {
    let (mut studio, _, at) = town();
    // From the street: houses stand before the lens.
    let camera = Camera::looking(at + DVec3::new(110.0, -70.0, 9.0), at, 0.9);
    let shape = Region::from(Shape::Sphere { center: at, radius: 25.0 });
    let scene = scene(camera, vec![with(eraser(&[], Class::Front), &shape)]);
    let changed = compare(&mut studio, &scene, &shape, Class::Front, &|model, t| !is_terrain(model, t));
    assert!(changed > 100, "{changed}");
}

#[test]
fn an_eye_inside_a_hiding_lens_sees_what_is_beyond() {
    let (mut studio, _, at) = town();
    let camera = Camera::looking(at + DVec3::new(0.0, 0.0, 25.0), at + DVec3::new(90.0, 20.0, 0.0), 1.2);
    let shapes = shapes(at + DVec3::new(0.0, 0.0, 25.0), 70.0).into_iter().enumerate();
    for (_, shape) in shapes.filter(|(i, _)| is_tried(*i, 3)) {
        let scene = scene(camera, vec![with(eraser(&[], Class::Inside), &shape)]);
        compare(&mut studio, &scene, &shape, Class::Inside, &|model, t| !is_terrain(model, t));
    }
}

#[test]
fn the_context_hides_without_a_lens() {
    let (mut studio, camera, at) = town();
    let nowhere = Shape::Sphere { center: at, radius: 1.0 };
    for (class, lenses) in
        [(Class::Rest, vec![]), (Class::Rest, vec![lens("grey", vec![nowhere.clone()], "greyscale")])]
    {
        let mut scene = scene(camera, lenses);
        scene.sun.shadows = true;
        scene.style.effects = vec![eraser(&[], Class::Inside)];
        // Every ray is in the context.
        let far = Region::from(Shape::Sphere { center: at + DVec3::Z * 9000.0, radius: 1.0 });
        let changed = compare(&mut studio, &scene, &far, class, &|model, t| !is_terrain(model, t));
        assert!(changed == 0, "the plain picture has the same context");
        scene.style.effects.clear();
        let before = picture(&mut studio, &scene, SIZE).object_id;
        scene.style.effects = vec![used("wireframe")];
        assert!(picture(&mut studio, &scene, SIZE).object_id != before);
    }
}

#[test]
fn an_attribute_chooses_who_goes() {
    let (mut studio, camera, at) = town();
    let shape = Region::from(Shape::Sphere { center: at, radius: 60.0 });
    let model = studio.model.clone();
    let id = model.strings.find("height").expect("synthetic buildings have heights");
    let height =
        |t: &Triangle| model.attribute(t.object, id).and_then(|v| veduta::lens::thematic::number_of(v, &model.strings));
    let parameters = [("attribute", Parameter::Text("height".into())), ("min", Parameter::Number(9.0))];
    let scene_of =
        |parameters: &[(&str, Parameter)]| scene(camera, vec![with(eraser(parameters, Class::Inside), &shape)]);
    let high = |_: &CityModel, t: &Triangle| height(t).is_some_and(|h| h >= 9.0);
    let changed = compare(&mut studio, &scene_of(&parameters), &shape, Class::Inside, &high);
    let except = [&parameters[..], &[("except", Parameter::Boolean(true))]].concat();
    let low = |model: &CityModel, t: &Triangle| !high(model, t) && !is_terrain(model, t);
    let others = compare(&mut studio, &scene_of(&except), &shape, Class::Inside, &low);
    assert!(changed > 20 && others > 20, "{changed} {others}");
}

/// A cube on the plain ground in the evening sun.
fn cube(camera: Camera, lenses: Vec<Lens>, shadows: bool) -> Scene {
    let sun = Sun { azimuth: 225.0_f64.to_radians(), elevation: 20.0_f64.to_radians(), shadows, ..Sun::default() };
    let mut scene = Scene { camera: Some(camera), lenses, sun, ..Scene::default() };
    scene.city.files = vec![citydata("cube.city.json")];
    scene
}

#[test]
fn what_is_hidden_casts_no_shadow() {
    let mut studio = of_scene(&cube(Camera::looking(DVec3::ONE, DVec3::ZERO, 1.0), vec![], true));
    let at = studio.model.geometries[studio.geometries[0] as usize].bounds.center();
    let (above, beside) = (at + DVec3::new(-60.0, -50.0, 60.0), at + DVec3::new(9.0, 9.0, 0.0));
    let cameras = [
        Camera::looking(above, at, 0.6),
        orthographic(above, at, 60.0),
        // The cube is behind the eye; its shadow lies before it.
        Camera::looking(beside + DVec3::new(0.0, 0.0, 9.0), beside + DVec3::new(4.0, 4.0, -5.0), 1.2),
    ];
    for (i, camera) in cameras.into_iter().enumerate() {
        let mut draw = |lens: Option<&Region>, shadows: bool| {
            let lenses = lens.map(|shape| with(eraser(&[], Class::Inside), shape)).into_iter().collect();
            picture(&mut studio, &cube(camera, lenses, shadows), SIZE).rgba
        };
        let with_shadow = draw(None, true);
        let all = shapes(at, 40.0);
        let wanted = draw(Some(&all[0]), false);
        assert!(with_shadow != draw(None, false), "camera {i}: there was no shadow");
        // The others have notches and holes, and the cube is in them.
        for shape in all.into_iter().take(7) {
            assert!(draw(Some(&shape), true) == wanted, "camera {i}, {shape:?}: a shadow is left");
        }
        // A lens far away takes nothing.
        let far = Shape::Sphere { center: at + DVec3::new(0.0, 0.0, 500.0), radius: 5.0 };
        assert!(draw(Some(&far.into()), true) == with_shadow);
    }
}

#[test]
fn both_back_ends_hide_the_same() {
    let (mut studio, camera, at) = town();
    let classes = [Class::Inside, Class::Front, Class::Behind, Class::Rest];
    for (shape, class) in shapes(at, 45.0).into_iter().zip(classes) {
        let roofs = eraser(&[("part", Parameter::Text("roofs".into()))], class);
        let mut both = with(roofs, &shape);
        both.effects.push(used("sepia"));
        let mut scene = scene(camera, vec![lens("grey", vec![shape.clone()], "greyscale"), both]);
        scene.sun.shadows = true;
        let mut draw = |backend: Backend| -> Picture {
            let request = Request { samples: 2, aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
            studio.render(&scene, &request).expect("a picture")
        };
        let (a, b) = (draw(Backend::Specialised), draw(Backend::Uber));
        assert!(a.rgba == b.rgba, "{class:?}: colours differ");
        assert!((a.object_id, a.lens_mask) == (b.object_id, b.lens_mask), "{class:?}: AOVs differ");
        assert_eq!(a.statistics.handlers, ["greyscale", "sepia", "eraser"].map(str::to_owned));
    }
}

#[test]
fn a_hiding_lens_that_moves_compiles_nothing_and_one_out_of_view_costs_nothing() {
    let (mut studio, camera, at) = town();
    let mut moved = |by: DVec3, enabled: bool| {
        let shape = Shape::Sphere { center: at + by, radius: 20.0 };
        let mut lens = with(eraser(&[], Class::Inside), &shape);
        lens.enabled = enabled;
        let mut scene = scene(camera, vec![lens]);
        scene.sun.shadows = true;
        picture(&mut studio, &scene, SIZE).statistics
    };
    let names = |s: &veduta::render::stats::Statistics| s.pipelines.names.join(", ");
    let first = moved(DVec3::ZERO, true);
    assert!(
        names(&first).contains("geometry cut (eraser)") && names(&first).contains("shadow cut (eraser)"),
        "{}",
        names(&first)
    );
    for by in [DVec3::new(10.0, 0.0, 0.0), DVec3::new(-15.0, 20.0, 5.0)] {
        let there = moved(by, true);
        assert_eq!(there.pipelines.compiled, 0, "{}", names(&there));
        let geometry = there.passes.iter().find(|p| p.name == "geometry").expect("a geometry pass");
        assert_eq!(geometry.serves, serde_json::json!([0]));
    }
    for away in [moved(DVec3::new(0.0, 0.0, 9000.0), true), moved(DVec3::ZERO, false)] {
        assert!(!names(&away).contains("cut") && away.handlers.is_empty(), "{}", names(&away));
        assert!(away.passes.iter().all(|p| p.serves != serde_json::json!([0])));
    }
}
