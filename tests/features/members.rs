//! Lenses of city objects: a thematic lens is what belongs to its objects and nothing else, whatever is beside it; the volumes
//! of objects hold the objects' own walls and roofs; what shapes enclose are whole buildings. Oracle: the object ids of the picture.

use std::collections::BTreeSet;

use crate::studio;
use glam::DVec3;
use veduta::{
    geom::{Shape, combination::Operation},
    lens::{
        Lens, LensBody, Region,
        chosen::{Choice, members},
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [240, 160];

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { aovs: studio::ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

/// Whether each pixel shows one of these objects.
fn shows(picture: &Picture, chosen: &[bool]) -> Vec<bool> {
    let ids = picture.object_id.as_ref().expect("object ids");
    ids.iter().map(|id| id.checked_sub(1).is_some_and(|object| chosen[object as usize])).collect()
}

/// From the street, from above, along the roofs.
fn cameras(studio: &Studio) -> [Camera; 3] {
    let extent = studio.extent();
    let (middle, size) = (extent.center(), extent.size());
    [
        Camera::looking(middle + size * glam::DVec3::new(-0.1, -0.45, 0.3), middle, 1.2),
        Camera::looking(middle + size.length() * glam::DVec3::new(0.2, -0.5, 0.6), middle, 0.9),
        studio::orthographic(middle + size * glam::DVec3::new(0.8, 0.7, 1.5), middle, 0.5 * size.truncate().length()),
    ]
}

/// Choices over the synthetic city: by attribute, turned round, by id with parts, and two of them that nobody is.
fn choices(studio: &Studio) -> Vec<Choice> {
    let by = |min: Option<f64>, max: Option<f64>, except: bool| Choice {
        attribute: Some("yearOfConstruction".into()),
        min,
        max,
        except,
        ..Choice::default()
    };
    let ids = studio.model.objects.iter().step_by(7).map(|o| o.id.to_string()).collect();
    vec![
        by(Some(1940.0), None, false),
        by(None, Some(1940.0), true),
        Choice { ids, ..Choice::default() },
        by(Some(9e9), None, false),
        Choice { ids: vec!["nobody".into()], ..Choice::default() },
    ]
}

#[test]
fn thematic_lenses_are_what_belongs_to_their_objects() {
    let mut studio = studio::synthetic(60);
    let choices = choices(&studio);
    let lens = |choice: &Choice| studio::lens("thematic", [Region::Thematic(choice.clone())], "sepia");
    let lenses: Vec<Lens> = choices.iter().map(lens).collect();
    let mut found = vec![0; lenses.len()];
    for camera in cameras(&studio) {
        let scene = studio::scene(camera, lenses.clone());
        let one = drawn(&mut studio, &scene, Backend::Specialised);
        let other = drawn(&mut studio, &scene, Backend::Uber);
        assert!(one.rgba == other.rgba && one.lens_mask == other.lens_mask, "the back ends differ");
        for (i, choice) in choices.iter().enumerate() {
            let expected = shows(&one, &members(&studio.model, choice));
            assert!(studio::bits(&one, i) == expected, "{choice:?}");
            found[i] += expected.iter().filter(|b| **b).count();
        }
    }
    assert!(found[..3].iter().all(|n| *n > 1_000) && found[3..] == [0, 0], "{found:?}");
}

#[test]
fn outlines_of_thematic_lenses_follow_what_is_seen_of_their_objects() {
    let mut studio = studio::synthetic(60);
    let choice = choices(&studio).remove(2);
    let camera = cameras(&studio)[1];
    let mut lens = studio::lens("thematic", [Region::Thematic(choice)], "sepia");
    lens.effects.clear();
    let plain = drawn(&mut studio, &studio::scene(camera, vec![lens.clone()]), Backend::Specialised);
    lens.body = LensBody::Outline;
    let lined = drawn(&mut studio, &studio::scene(camera, vec![lens]), Backend::Specialised);
    let inside = studio::bits(&plain, 0);
    let [w, h] = SIZE.map(|s| s as i32);
    let differs = |x: i32, y: i32, reach: i32| {
        let beside = |j: i32| (-reach..=reach).map(move |i| (x + i, y + j));
        let near = (-reach..=reach).flat_map(beside).filter(|(i, j)| (0..w).contains(i) && (0..h).contains(j));
        near.into_iter().any(|(i, j)| inside[(j * w + i) as usize] != inside[(y * w + x) as usize])
    };
    let mut count = 0;
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let i = (y * w + x) as usize;
        let is_lined = plain.rgba[i] != lined.rgba[i];
        assert!(!is_lined || differs(x, y, 3), "a line at {x},{y}, where no border is near");
        let has_border = [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(dx, dy)| {
            let (i, j) = (x + dx, y + dy);
            (0..w).contains(&i) && (0..h).contains(&j) && inside[(j * w + i) as usize] != inside[(y * w + x) as usize]
        });
        assert!(is_lined || !has_border, "no line at {x},{y}, on the border");
        count += u32::from(has_border);
    }
    assert!(count > 500, "{count}");
}

#[test]
fn the_volumes_of_objects_hold_their_own_walls_and_roofs() {
    let studios = [
        studio::synthetic(60),
        studio::studio(&[studio::citydata("square.city.json")]),
        studio::studio(&[studio::citydata("courtyard.city.json")]),
    ];
    for mut studio in studios {
        let ids: Vec<String> = studio.model.objects.iter().step_by(3).map(|o| o.id.to_string()).collect();
        let choice = Choice { ids, ..Choice::default() };
        let chosen = members(&studio.model, &choice);
        let lens = studio::lens("objects", [Region::Objects(choice)], "sepia");
        let (mut found, mut past_edges) = (0, 0);
        for camera in cameras(&studio) {
            for backend in [Backend::Specialised, Backend::Uber] {
                let picture = drawn(&mut studio, &studio::scene(camera, vec![lens.clone()]), backend);
                let inside = studio::bits(&picture, 0);
                let volumes = studio.lens_volumes(&studio::scene(camera, vec![lens.clone()]), SIZE).expect("volumes");
                assert_eq!(volumes.len(), 1);
                let volume = volumes[0].region.volume().expect("one volume");
                let view = View::new(camera, SIZE, &studio.extent()).expect("a view");
                let own = shows(&picture, &chosen);
                // Flat objects, as streets are, have no volume.
                let flat = |object: u32| {
                    let all = studio.geometries.iter().map(|&g| &studio.model.geometries[g as usize]);
                    all.filter(|g| g.object == object).all(|g| g.bounds.size().min_element() < 0.5)
                };
                let ids = picture.object_id.as_ref().expect("object ids");
                for i in (0..own.len()).filter(|i| own[*i] && !flat(ids[*i] - 1)) {
                    found += 1;
                    let d = f64::from(picture.depth.as_ref().expect("depth")[i]);
                    let p = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(d);
                    let beyond = volume.signed_distance(p);
                    if beyond > 4.0 * f64::from(f32::EPSILON) * d + studio::off_face(&view, d) {
                        // Corners are drawn on a grid of 1/256 pixel: past an edge.
                        assert!(beyond <= view.pixel_m(d) / 128.0, "{beyond} m from its volume");
                        past_edges += 1;
                        continue;
                    }
                    let object = &studio.model.objects[ids[i] as usize - 1];
                    assert!(inside[i], "{backend:?}, pixel {i} of {object:?} is not in its own volume");
                }
            }
        }
        assert!(found > 3_000 && 500 * past_edges < found, "{found}, {past_edges} past edges");
    }
}

/// The point of a triangle that is nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
fn nearest(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * ab;
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * ac;
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    }
    let all = va + vb + vc;
    a + vb / all * ab + vc / all * ac
}

/// The buildings that a ball touches, or holds with all their corners; ids of roots. By all their triangles.
fn in_ball(studio: &Studio, center: DVec3, radius: f64, whole: bool) -> BTreeSet<u32> {
    let root = |mut object: u32| {
        while let Some(&parent) = studio.model.objects[object as usize].parents.first() {
            object = parent;
        }
        object
    };
    let triangles: Vec<_> = studio::triangles(studio)
        .into_iter()
        .filter(|t| !studio.model.objects[t.object as usize].class.is_ground())
        .collect();
    let touches = |t: &&studio::Triangle| nearest(center, t.corners).distance(center) <= radius;
    let is_cut = |t: &&studio::Triangle| t.corners.iter().any(|c| c.distance(center) > radius);
    let mut found: BTreeSet<u32> = triangles.iter().filter(touches).map(|t| root(t.object)).collect();
    if whole {
        triangles.iter().filter(is_cut).for_each(|t| {
            found.remove(&root(t.object));
        });
    }
    found
}

/// One per object: whether its root is among these.
fn with_parts(studio: &Studio, roots: &BTreeSet<u32>) -> Vec<bool> {
    let mut all = vec![false; studio.model.objects.len()];
    let mut next: Vec<u32> = roots.iter().copied().collect();
    while let Some(object) = next.pop() {
        all[object as usize] = true;
        next.extend(&studio.model.objects[object as usize].children);
    }
    all
}

fn ball(center: DVec3, radius: f64) -> Region {
    Shape::Sphere { center, radius }.into()
}

#[test]
fn a_lens_of_what_is_enclosed_acts_on_whole_buildings() {
    let mut studio = studio::synthetic(60);
    let camera = cameras(&studio)[1];
    let (middle, size) = (studio.extent().center(), studio.extent().size());
    let mut seen = [BTreeSet::new(), BTreeSet::new()];
    let mut compiled = Vec::new();
    for step in 0..6 {
        let (center, radius) = (middle + size * DVec3::new(0.1 * f64::from(step) - 0.3, 0.05, 0.0), 0.2 * size.x);
        let enclosed = |whole| Region::Enclosed { parts: vec![ball(center, radius)], whole, types: vec![] };
        let lenses: Vec<Lens> = [false, true]
            .map(|whole| studio::lens(if whole { "whole" } else { "touched" }, [enclosed(whole)], "sepia"))
            .to_vec();
        let scene = studio::scene(camera, lenses);
        let one = drawn(&mut studio, &scene, Backend::Specialised);
        let other = drawn(&mut studio, &scene, Backend::Uber);
        assert!(one.rgba == other.rgba && one.lens_mask == other.lens_mask, "the back ends differ");
        compiled.push(one.statistics.pipelines.compiled + other.statistics.pipelines.compiled);
        for (i, whole) in [false, true].into_iter().enumerate() {
            let roots = in_ball(&studio, center, radius, whole);
            assert!(studio::bits(&one, i) == shows(&one, &with_parts(&studio, &roots)), "step {step}, whole: {whole}");
            seen[i].insert(roots);
        }
    }
    // It moves on: others are enclosed, and nothing is compiled for them.
    assert!(seen.iter().all(|s| s.len() > 3) && seen[0].iter().all(|s| s.len() > 3), "{seen:?}");
    assert!(compiled[0] > 0 && compiled[1..].iter().all(|count| *count == 0), "{compiled:?}");
}

#[test]
fn a_part_stands_for_its_building_and_the_ground_for_nothing() {
    let mut studio = studio::studio(&[studio::citydata("two-wings.city.json")]);
    let camera = cameras(&studio)[1];
    let at = |x: f64, y: f64| DVec3::new(78_000.0 + x, 457_000.0 + y, 2.0);
    let mut of_types = |parts: Vec<Region>, whole: bool, types: &[&str]| -> Vec<String> {
        let types = types.iter().map(|t| (*t).to_owned()).collect();
        let lens = studio::lens("enclosed", [Region::Enclosed { parts, whole, types }], "sepia");
        let picture = drawn(&mut studio, &studio::scene(camera, vec![lens]), Backend::Specialised);
        let (inside, ids) = (studio::bits(&picture, 0), picture.object_id.as_ref().expect("object ids"));
        let shown: BTreeSet<u32> = (0..ids.len()).filter(|&i| inside[i]).map(|i| ids[i]).collect();
        shown.into_iter().map(|id| studio.model.objects[id as usize - 1].id.to_string()).collect()
    };
    let hall = ["hall-west", "hall-east"];
    let all = || vec![ball(at(25.0, 15.0), 60.0)];
    assert_eq!(of_types(all(), false, &["Building"]), [hall[0], hall[1], "shed"], "parts are of their building's type");
    assert!(of_types(all(), false, &["Bridge", "BuildingPart", "LandUse"]).is_empty());
    let mut named = |parts: Vec<Region>, whole: bool| of_types(parts, whole, &[]);
    assert_eq!(named(vec![ball(at(5.0, 5.0), 6.0)], false), hall, "both wings, though one is touched");
    assert!(named(vec![ball(at(5.0, 5.0), 20.0)], true).is_empty(), "a wing lies outside");
    assert_eq!(named(vec![ball(at(5.0, 5.0), 20.0), ball(at(45.0, 5.0), 20.0)], true), hall, "one wing in each");
    assert_eq!(named(vec![ball(at(3.0, 28.0), 9.0)], true), ["shed"], "and not the lawn");
    assert!(named(vec![ball(at(25.0, 5.0), 5.0)], false).is_empty(), "the lawn alone");
    // By object within by object, and in combinations.
    let shed = Choice { ids: vec!["shed".into()], ..Choice::default() };
    assert_eq!(named(vec![Region::Thematic(shed.clone())], false), ["shed"]);
    let parts = all().into_iter().chain([Region::Thematic(shed)]).collect();
    let others = Region::Combined { how: Operation::Difference, parts };
    assert_eq!(of_types(vec![others], false, &[]), hall);
}

#[test]
fn a_member_of_a_group_stands_for_itself() {
    let mut studio = studio::studio(&[studio::citydata("group.city.json")]);
    let camera = cameras(&studio)[1];
    for (at, name) in [(2.0, "one"), (8.0, "two")] {
        let parts = vec![ball(DVec3::new(at, 2.0, 2.0), 3.0)];
        let enclosed = Region::Enclosed { parts, whole: false, types: vec!["Building".into()] };
        let scene = studio::scene(camera, vec![studio::lens("enclosed", [enclosed], "sepia")]);
        let picture = drawn(&mut studio, &scene, Backend::Specialised);
        let only: Vec<bool> = studio.model.objects.iter().map(|o| &*o.id == name).collect();
        let expected = shows(&picture, &only);
        assert!(expected.contains(&true) && studio::bits(&picture, 0) == expected, "{name}");
    }
}
