//! Contents under deformations: they are deformed as the city is, wherever they stand, and what is asked of objects is asked of where
//! they are shown.

use std::collections::BTreeSet;

use crate::studio::*;
use glam::{DQuat, DVec3};
use veduta::{
    city::{CityModel, derived::derive},
    figure::scene_file::{Options, parse},
    geom::deform::Deformers,
    lens::{Copied, Lens},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    view::View,
};

const SIZE: [u32; 2] = [480, 300];
/// As in `deformations`: edges a quarter of a pixel, what is between them twice that; and by as much more as the inverse stretches.
const OFF_PX: f64 = 0.75;

fn town(lenses: &str) -> Scene {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n[camera]\neye = [-90, -140, 100]\ntarget = [0, 0, 10]\n\
         [sun]\nshadows = false\n{lenses}"
    );
    parse(&text, "s.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

const BOX: &str = "{ kind = \"box\", center = [5, 3, 30], size = [120, 90, 60], rotation_deg = [20, 0, 0] }";

fn deformation(steps: &str, rest: &str) -> String {
    format!(
        "[[lens]]\nname = \"moved\"\nkind = \"deformation\"\nbody = \"none\"\nshape = {BOX}\ndeform = [{steps}]\n{rest}\n"
    )
}

fn content(content: &str, shape: &str) -> String {
    format!(
        "[[lens]]\nname = \"content\"\nkind = \"content\"\nbody = \"none\"\nshape = {shape}\ncontent = {{ {content} }}\n"
    )
}

fn request(backend: Backend) -> Request {
    Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) }
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    studio.render(scene, &request(backend)).unwrap_or_else(|error| panic!("{error}"))
}

/// The nearest point of a triangle, by clamping (an oracle that shares nothing with what is tested): the plane's foot if that is in it, else
/// the nearest of its edges.
fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let n = (b - a).cross(c - a);
    let edge = |u: DVec3, v: DVec3| {
        let t = ((p - u).dot(v - u) / (v - u).length_squared().max(1e-300)).clamp(0.0, 1.0);
        p.distance(u + (v - u) * t)
    };
    let nearest_edge = edge(a, b).min(edge(b, c)).min(edge(c, a));
    let is_inside = [(a, b), (b, c), (c, a)].iter().all(|(u, v)| (*v - *u).cross(p - *u).dot(n) >= 0.0);
    if n.length_squared() > 0.0 && is_inside {
        ((p - a).dot(n) / n.length()).abs().min(nearest_edge)
    } else {
        nearest_edge
    }
}

/// A triangle, and whose it is.
type Face = ([DVec3; 3], u32);

/// The triangles of some geometries where they stand.
fn placed(model: &CityModel, geometries: &[u32], place: impl Fn(DVec3) -> DVec3) -> Vec<Face> {
    faces(model, geometries).into_iter().map(|(corners, object)| (corners.map(&place), object)).collect()
}

/// What pixels of a content lens show, against what the content has at their places at rest.
#[derive(Default)]
struct Seen {
    /// How far they are from that at worst, pixels.
    off_px: f64,
    count: usize,
    /// Those that are moved by more than a metre.
    moved: usize,
    /// Those whose normal is that of the face, moved along.
    turned: usize,
}

/// Of every seventh pixel of the lens.
fn seen(picture: &Picture, view: &View, deformers: &Deformers, faces: &[Face]) -> Seen {
    let (depths, ids) = (picture.depth.as_ref().unwrap(), picture.object_id.as_ref().unwrap());
    let normals = picture.normal.as_ref().unwrap();
    // The content lens is the second.
    let mask = bits(picture, 1);
    let mut seen = Seen::default();
    for i in (0..depths.len()).step_by(7).filter(|&i| mask[i] && ids[i] > 0) {
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let place = ray.origin + ray.direction * (f64::from(depths[i]) / ray.direction.dot(view.basis.forward));
        let rest = deformers.inverse(place).unwrap_or_else(|| panic!("{place} has a place at rest"));
        let own = faces.iter().filter(|(_, object)| object + 1 == ids[i]);
        let distances = own.map(|(corners, _)| (distance(rest, *corners), *corners));
        let (off, [a, b, c]) = distances.min_by(|one, other| one.0.total_cmp(&other.0)).expect("faces");
        let pixel_m = view.depth(place) * 2.0 * view.half_extent().y / f64::from(SIZE[1]);
        seen.off_px = seen.off_px.max(off / pixel_m);
        seen.count += 1;
        seen.moved += usize::from(rest.distance(place) > 1.0);
        let normal = deformers.jacobian(rest).inverse().transpose() * (b - a).cross(c - a);
        let along = normal.normalize_or_zero().dot(DVec3::from(normals[i].map(f64::from))).abs();
        seen.turned += usize::from(along > 5.0_f64.to_radians().cos());
    }
    seen
}

const STEPS: [&str; 3] = [
    "{ kind = \"twist\", angle_deg = 50.0 }",
    "{ kind = \"translate\", by = [0.0, 10.0, 25.0] }",
    "{ kind = \"scale\", factors = [0.8, 0.8, 1.5] }, { kind = \"bend\", angle_deg = 30.0 }",
];

fn content_of(lens: &Lens) -> &veduta::lens::Content {
    lens.shown().expect("a content")
}

/// What a content shows, where it stands at rest.
fn content_faces(studio: &Studio, lens: &Lens) -> Vec<Face> {
    let content = content_of(lens);
    let Copied { from, to, rotation, scale } = content.copied.unwrap_or_default();
    let (from, to) = (from.unwrap_or_default(), to.unwrap_or_default());
    let is_copied = content.copied.is_some();
    let place = |p: DVec3| if is_copied { rotation * ((p - from) * scale) + to } else { p };
    match &content.derive {
        Some(how) => {
            let made = derive(&studio.model, &studio.geometries, how);
            let mut all = placed(&made.model, &made.geometries(), place);
            // Terrain and what lies on it shows beside what is derived.
            let is_ground = |object: u32| studio.model.objects[object as usize].class.is_ground();
            all.extend(placed(&studio.model, &studio.geometries, place).into_iter().filter(|(_, o)| is_ground(*o)));
            all
        }
        None => placed(&studio.model, &studio.geometries, place),
    }
}

#[test]
fn contents_are_shown_where_deformations_take_them() {
    let contents = [
        ("derive = \"box\"", "{ kind = \"sphere\", center = [0, 0, 30], radius = 35 }"),
        ("derive = \"hull\"", "{ kind = \"cylinder\", center = [0, 0, -20], radius = 35, height = 120 }"),
        (
            "from = [20, 10, 0], to = [0, 0, 12], rotation_deg = [35, 0, 0], scale = 0.6",
            "{ kind = \"sphere\", center = [0, 0, 25], radius = 40 }",
        ),
    ];
    let mut studio = of_scene(&town(""));
    for (i, steps) in STEPS.into_iter().enumerate() {
        for (j, (own, shape)) in contents.into_iter().enumerate() {
            if !is_tried(i + j, 2) {
                continue;
            }
            let scene = town(&(deformation(steps, "") + &content(own, shape)));
            let one = drawn(&mut studio, &scene, Backend::Specialised);
            let other = drawn(&mut studio, &scene, Backend::Uber);
            assert!(one.rgba == other.rgba && one.object_id == other.object_id, "{steps}, {own}: the back ends differ");
            assert!(
                one.depth == other.depth && one.lens_mask == other.lens_mask,
                "{steps}, {own}: the back ends differ"
            );
            let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
            let deformers = studio.deformers(&scene, SIZE).unwrap();
            let Seen { off_px, count, moved, turned } =
                seen(&one, &view, &deformers, &content_faces(&studio, &scene.lenses[1]));
            assert!(count > 500 && moved > count / 4, "{steps}, {own}: {moved} of {count} pixels show what was moved");
            assert!(off_px < OFF_PX, "{steps}, {own}: shown {off_px} pixels from where it should be");
            // At edges the nearest face may be the other one.
            assert!(turned * 20 > count * 19, "{steps}, {own}: {turned} of {count} normals are moved along");
        }
    }
}

#[test]
fn ground_that_is_lifted_does_not_bury_what_lies_on_it() {
    let mut studio = of_scene(&town(""));
    let lift = deformation("{ kind = \"translate\", by = [0.0, 0.0, 25.0] }", "");
    let flat = content("derive = \"flat\"", "{ kind = \"cylinder\", center = [0, 0, -20], radius = 30, height = 120 }");
    let still = drawn(
        &mut studio,
        &town(&("".to_owned() + &deformation("{ kind = \"translate\", by = [0.0, 0.0, 0.0] }", "") + &flat)),
        Backend::default(),
    );
    let lifted = drawn(&mut studio, &town(&(lift + &flat)), Backend::default());
    // Objects that are not ground: the houses, pressed flat.
    let houses = |picture: &Picture| {
        let mask = bits(picture, 1);
        let is_house = |id: u32| id > 0 && !studio.model.objects[id as usize - 1].class.is_ground();
        let ids = picture.object_id.as_ref().unwrap();
        ids.iter().zip(mask).filter(|(id, is_in)| *is_in && is_house(**id)).count()
    };
    let (before, after) = (houses(&still), houses(&lifted));
    assert!(before > 500, "{before} pixels show houses that lie on the ground");
    assert!(after > before / 2, "{after} pixels of {before} are left where the ground is lifted");
}

#[test]
fn what_is_enclosed_is_told_from_where_it_is_shown() {
    let mut studio = of_scene(&town(""));
    // A whole block of air is moved, with what is in it.
    let moves = deformation("{ kind = \"translate\", by = [40.0, 0.0, 0.0] }", "control = \"everywhere\"");
    let ball = |rest: &str| {
        format!(
            "[[lens]]\nname = \"held\"\nbody = \"none\"\neffects = [\"sepia\"]\n{rest}\n\
             shape = {{ kind = \"enclosed\", shapes = [{{ kind = \"sphere\", center = [30, 0, 5], radius = 28 }}] }}\n"
        )
    };
    let mut seen = Vec::new();
    for rest in ["", "space = \"rest\"\n"] {
        let scene = town(&(moves.clone() + &ball(rest)));
        let picture = drawn(&mut studio, &scene, Backend::default());
        let deformers = studio.deformers(&scene, SIZE).unwrap();
        let place = |p: DVec3| if rest.is_empty() { deformers.value(p) } else { p };
        let all = placed(&studio.model, &studio.geometries, place);
        let center = DVec3::new(30.0, 0.0, 5.0);
        let mut objects: BTreeSet<u32> = all
            .iter()
            .filter(|(corners, object)| {
                !studio.model.objects[*object as usize].class.is_ground() && distance(center, *corners) <= 28.0
            })
            .map(|(_, object)| studio.model.root(*object))
            .collect();
        objects = (0..studio.model.objects.len() as u32).filter(|o| objects.contains(&studio.model.root(*o))).collect();
        let ids = picture.object_id.as_ref().unwrap();
        let mask = bits(&picture, 1);
        let wanted: Vec<bool> = ids.iter().map(|id| *id > 0 && objects.contains(&(id - 1))).collect();
        assert_eq!(mask, wanted, "space {rest:?}");
        assert!(mask.iter().any(|is_in| *is_in));
        let counted = picture.statistics.lenses[1].objects;
        seen.push((objects, counted));
    }
    assert_ne!(seen[0].0, seen[1].0, "others are there once they are moved");
}

#[test]
fn objects_are_counted_where_they_are_shown() {
    let mut studio = of_scene(&town(""));
    let moves = deformation("{ kind = \"translate\", by = [40.0, 0.0, 0.0] }", "control = \"everywhere\"");
    let shape = "{ kind = \"sphere\", center = [30, 0, 5], radius = 28 }";
    let plain = format!("[[lens]]\nname = \"plain\"\nbody = \"none\"\neffects = [\"sepia\"]\nshape = {shape}\n");
    let count_of = |studio: &mut Studio, lens: &str, moves: &str, faces_of: &dyn Fn(&Studio, &Scene) -> Vec<Face>| {
        let scene = town(&(moves.to_owned() + lens));
        let picture = drawn(studio, &scene, Backend::default());
        let deformers = studio.deformers(&scene, SIZE).unwrap();
        let center = DVec3::new(30.0, 0.0, 5.0);
        let met = faces_of(studio, &scene)
            .into_iter()
            .filter(|(corners, _)| distance(center, corners.map(|p| deformers.value(p))) <= 28.0);
        let objects: BTreeSet<u32> = met.map(|(_, object)| object).collect();
        assert_eq!(picture.statistics.lenses.last().unwrap().objects, objects.len() as u64, "{lens}");
        objects
    };
    let own = |studio: &Studio, _: &Scene| placed(&studio.model, &studio.geometries, |p| p);
    let of_content = |studio: &Studio, scene: &Scene| {
        let content = content_of(scene.lenses.last().unwrap());
        let Copied { from, to, rotation, scale } =
            content.copied.unwrap_or(Copied { from: None, to: None, rotation: DQuat::IDENTITY, scale: 1.0 });
        let (from, to) = (from.unwrap_or_default(), to.unwrap_or_default());
        let made = content.derive.as_ref().map(|how| derive(&studio.model, &studio.geometries, how));
        let place = |p: DVec3| rotation * ((p - from) * scale) + to;
        made.map_or_else(
            || placed(&studio.model, &studio.geometries, place),
            |made| placed(&made.model, &made.geometries(), place),
        )
    };
    let here = count_of(&mut studio, &plain, "", &own);
    let there = count_of(&mut studio, &plain, &moves, &own);
    assert_ne!(here, there, "others are there once they are moved");
    let boxes = content("derive = \"box\"", shape);
    let boxes_there = count_of(&mut studio, &boxes, &moves, &of_content);
    assert!(!boxes_there.is_empty());
    let copy = content("from = [20, 10, 0], to = [0, 0, 12], rotation_deg = [35, 0, 0], scale = 0.6", shape);
    assert!(!count_of(&mut studio, &copy, &moves, &of_content).is_empty());
}

#[test]
fn occluders_are_found_where_they_are_shown() {
    let mut studio = of_scene(&town(""));
    // All of the town goes to the east, and so does what is looked for: it is hidden as it is from a place further west.
    let by = DVec3::new(40.0, 0.0, 0.0);
    let moves = deformation("{ kind = \"translate\", by = [40.0, 0.0, 0.0] }", "control = \"everywhere\"")
        .replace("[20, 0, 0]", "[0, 0, 0]");
    let looks = |rest: &str| {
        format!(
            "[[poi]]\nname = \"p\"\nat = [20, 30, 1]\n[[lens]]\nname = \"who\"\nkind = \"occlusion\"\npoi = \"p\"\n\
             test = {{ kind = \"exact\" }}\nrender = \"discard\"\n{rest}\n"
        )
    };
    let mut found = |moves: &str, rest: &str, shift: DVec3| {
        let mut scene = town(&(looks(rest) + moves));
        let camera = scene.camera.as_mut().unwrap();
        // Low enough for houses to be in the way.
        (camera.eye, camera.target) = (DVec3::new(-90.0, -140.0, 12.0) + shift, DVec3::new(20.0, 30.0, 1.0) + shift);
        let picture = drawn(&mut studio, &scene, Backend::default());
        let occluders = picture.statistics.lenses.iter().find(|l| l.name == "who").unwrap().occluders.clone().unwrap();
        occluders.into_iter().map(|one| one.id).collect::<BTreeSet<String>>()
    };
    let moved = found(&moves, "", DVec3::ZERO);
    let from_the_west = found("", "", -by);
    let still = found("", "", DVec3::ZERO);
    assert!(moved.len() > 1 && moved != still, "{moved:?}");
    assert_eq!(moved, from_the_west);
    assert_eq!(found(&moves, "space = \"rest\"", DVec3::ZERO), still);
}
