//! Closed forms: volumes, areas, heights; and the object that a face belongs to.

use glam::{DVec2, DVec3, Vec3};

use super::*;
use crate::city::{
    build::{
        ModelBuilder,
        points::Pool,
        raw::{Polygons, RawGeometry, RawObject},
    },
    coplanar::{coplanar_triangles, stacked_triangles},
    model::{Lod, NONE, ObjectClass, StringId, Surface},
    test_city::{LATTICE, add, add_box, builder, grid_of_cubes},
};

const BOX: Form = Form::Box { oriented: false };
const FLAT: Form = Form::Flat { lift_m: LIFT_M };
const TOP: Form = Form::Top { lift_m: LIFT_M };

fn made(model: &CityModel, form: Form) -> Derived {
    derived_by(model, Derive { form, parts: false })
}

fn derived_by(model: &CityModel, how: Derive) -> Derived {
    let all: Vec<u32> = (0..model.geometries.len() as u32).collect();
    let derived = derive(model, &all, &how);
    derived.model.validate().expect("a sound model");
    assert_eq!(derived.model.objects.len(), model.objects.len());
    assert!(derived.model.objects.iter().zip(&model.objects).all(|(a, b)| a.id == b.id && a.class == b.class));
    derived
}

/// The triangles of a model, with the index of the surface and the packed normal.
fn triangles(model: &CityModel) -> Vec<([DVec3; 3], u32, u32)> {
    let of = |tile: &crate::city::model::Tile| {
        let (range, first) = (tile.indices.clone(), tile.vertices.start);
        let (origin, indices) = (tile.origin.as_dvec3(), &model.indices);
        let triangle = move |at: u32| {
            let corners = [0, 1, 2].map(|k| &model.vertices[(first + indices[(at + k) as usize]) as usize]);
            let places = corners.map(|v| origin + Vec3::from(v.position).as_dvec3());
            (places, corners[0].surface, corners[0].normal)
        };
        range.step_by(3).map(triangle).collect::<Vec<_>>()
    };
    model.tiles.iter().flat_map(of).collect()
}

/// The volume that closed bodies enclose, cubic metres.
fn volume(model: &CityModel) -> f64 {
    let all = triangles(model);
    let base = all.first().map_or(DVec3::ZERO, |(corners, ..)| corners[0]);
    all.iter().map(|(c, ..)| (c[0] - base).dot((c[1] - base).cross(c[2] - base)) / 6.0).sum()
}

/// The area of faces that look up, one by one, square metres.
fn seen_from_above(model: &CityModel) -> f64 {
    let side = |c: &[DVec3; 3]| 0.5 * (c[1] - c[0]).truncate().perp_dot((c[2] - c[0]).truncate());
    triangles(model).iter().map(|(c, ..)| side(c).max(0.0)).sum()
}

fn owners(model: &CityModel) -> Vec<u32> {
    let mut owners: Vec<u32> =
        triangles(model).iter().map(|(_, surface, _)| model.surfaces[*surface as usize].object).collect();
    owners.dedup();
    owners
}

fn near(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() <= 1e-5 * wanted.abs().max(1.0)
}

/// A closed body upright on a ring (millimetres, counter-clockwise).
fn add_upright(builder: &mut ModelBuilder, id: &str, ring: &[[i64; 2]], [low, high]: [i64; 2]) -> u32 {
    let n = ring.len() as u32;
    let points = [low, high].iter().flat_map(|z| ring.iter().map(move |p| [p[0], p[1], *z])).collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    add(builder, id, ObjectClass::Building, None, points, &faces)
}

/// A house with a ridge along x: walls 5 m, ridge at 8 m, 10 m × 8 m.
fn add_house(builder: &mut ModelBuilder, id: &str, [x, y, z]: [i64; 3]) -> u32 {
    let corners = [[0, 0], [10_000, 0], [10_000, 8000], [0, 8000]];
    let mut points: Vec<[i64; 3]> =
        [z, z + 5000].iter().flat_map(|h| corners.map(|c| [x + c[0], y + c[1], *h])).collect();
    points.extend([[x, y + 4000, z + 8000], [x + 10_000, y + 4000, z + 8000]]);
    let faces: [&[u32]; 7] =
        [&[3, 2, 1, 0], &[0, 1, 5, 4], &[2, 3, 7, 6], &[1, 2, 6, 9, 5], &[3, 0, 4, 8, 7], &[4, 5, 9, 8], &[6, 7, 8, 9]];
    let faces: Vec<Vec<u32>> = faces.iter().map(|face| face.to_vec()).collect();
    add(builder, id, ObjectClass::Building, None, points, &faces)
}

const L: [[i64; 2]; 6] = [[0, 0], [20_000, 0], [20_000, 10_000], [10_000, 10_000], [10_000, 20_000], [0, 20_000]];

#[test]
fn an_empty_city_derives_nothing() {
    for form in [BOX, Form::Prism, Form::Hull, FLAT, Form::Height(Height::Metres(9.0))] {
        let empty = made(&CityModel::default(), form);
        assert_eq!((empty.geometries().len(), empty.unchanged, empty.left_out), (0, 0, 0), "{form:?}");
    }
}

#[test]
fn cubes_are_their_own_boxes() {
    let model = grid_of_cubes(3, 2);
    for form in [BOX, Form::Box { oriented: true }, Form::Prism, Form::Hull] {
        let derived = made(&model, form);
        assert!(near(volume(&derived.model), 6000.0), "{form:?}: {}", volume(&derived.model));
        assert_eq!(owners(&derived.model), [0, 1, 2, 3, 4, 5], "{form:?}");
        assert_eq!(derived.unchanged, 0);
        let kinds: Vec<&str> = derived.model.surfaces.iter().map(|s| derived.model.strings.get(s.kind)).collect();
        assert_eq!(kinds[..3], ["RoofSurface", "WallSurface", "GroundSurface"], "{form:?}");
        assert!(near(seen_from_above(&derived.model), 600.0), "{form:?}");
    }
}

#[test]
fn an_l_has_the_volumes_of_closed_forms() {
    let mut b = builder();
    add_upright(&mut b, "L", &L, [1000, 7000]);
    let model = b.finish();
    let cubic = |form| volume(&made(&model, form).model);
    assert!(near(cubic(BOX), 400.0 * 6.0));
    assert!(near(cubic(Form::Box { oriented: true }), 400.0 * 6.0));
    assert!(near(cubic(Form::Prism), 300.0 * 6.0), "the house itself");
    assert!(near(cubic(Form::Hull), 350.0 * 6.0), "the corner is cut off");
}

#[test]
fn oriented_boxes_stand_on_the_smallest_rectangle() {
    let mut b = builder();
    // 20 m × 10 m, turned as the triangle 3, 4, 5 is.
    add_upright(&mut b, "turned", &[[0, 0], [16_000, 12_000], [10_000, 20_000], [-6000, 8000]], [0, 9000]);
    let model = b.finish();
    assert!(near(volume(&made(&model, Form::Box { oriented: true }).model), 200.0 * 9.0));
    assert!(near(volume(&made(&model, BOX).model), 22.0 * 20.0 * 9.0));
}

#[test]
fn a_prism_stands_on_all_that_is_seen_from_above() {
    let mut b = builder();
    add_house(&mut b, "house", [0, 0, 0]);
    // A ring of four wings around a courtyard, given as one object that overlaps itself.
    let wings =
        [[0, 30_000, 9000, 6000], [0, 45_000, 9000, 6000], [0, 30_000, 3000, 21_000], [6000, 30_000, 3000, 21_000]];
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for [x, y, w, d] in wings {
        let first = points.len() as u32;
        points.extend([[x, y], [x + w, y], [x + w, y + d], [x, y + d]].map(|p| [p[0], p[1], 4000]));
        faces.push((first..first + 4).collect());
    }
    points.extend([[0, 30_000, 0], [9000, 30_000, 0], [9000, 51_000, 0]]);
    faces.push(vec![18, 17, 16]);
    add(&mut b, "wings", ObjectClass::Building, None, points, &faces);
    let model = b.finish();
    let derived = made(&model, Form::Prism);
    let courtyard = 3.0 * 9.0;
    assert!(near(volume(&derived.model), 80.0 * 8.0 + (9.0 * 21.0 - courtyard) * 4.0), "{}", volume(&derived.model));
}

#[test]
fn neighbours_in_one_plane_are_known_exactly() {
    let mut b = builder();
    add_box(&mut b, "west", [0, 0, 0], [10_123, 10_000, 9_000]);
    add_box(&mut b, "east", [10_123, 2_000, 0], [20_000, 10_000, 9_000]);
    let model = b.finish();
    for form in [BOX, Form::Prism, Form::Hull] {
        let derived = made(&model, form);
        let shared = coplanar_triangles(&derived.model, &derived.geometries());
        assert_eq!(shared.len(), 4, "{form:?}: two triangles of either party wall");
    }
}

#[test]
fn faces_stand_for_roots_and_groups_are_none() {
    let mut b = builder();
    let object = |kind: &str, id: &str, parents: &[&str], children: &[&str]| RawObject {
        id: id.to_owned(),
        kind: kind.to_owned(),
        parents: parents.iter().map(|p| (*p).to_owned()).collect(),
        children: children.iter().map(|c| (*c).to_owned()).collect(),
        ..RawObject::default()
    };
    let group = b.add_object(object("CityObjectGroup", "group", &[], &["house", "shed"]));
    let house = b.add_object(object("Building", "house", &["group"], &["hall", "tower"]));
    let hall = b.add_object(object("BuildingPart", "hall", &["house"], &[]));
    let tower = b.add_object(object("BuildingPart", "tower", &["house"], &[]));
    let shed = b.add_object(object("Building", "shed", &["group"], &[]));
    let mut solid = |object: u32, x: i64, size: [i64; 3]| {
        let surface = b.add_surface(Surface { object, material: NONE, kind: StringId(NONE), detail: NONE });
        let [w, d, h] = size;
        let ring = [[x, 0], [x + w, 0], [x + w, d], [x, d]];
        let points: Vec<[i64; 3]> = [0, h].iter().flat_map(|z| ring.map(|p| [p[0], p[1], *z])).collect();
        let mut polygons = Polygons::default();
        for face in [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]] {
            polygons.indices.extend(face);
            polygons.ring_ends.push(polygons.indices.len() as u32);
            polygons.polygon_ends.push(polygons.ring_ends.len() as u32);
            polygons.surfaces.push(surface);
        }
        let pool = std::sync::Arc::new(Pool { lattice: LATTICE, points: points.into() });
        b.add_geometry(RawGeometry { object, lod: Lod { tenths: 20 }, solid: true, pool, polygons });
    };
    solid(hall, 0, [10_000, 8000, 5000]);
    solid(tower, 12_000, [4000, 4000, 20_000]);
    solid(shed, 30_000, [3000, 3000, 3000]);
    let model = b.finish();
    let whole = made(&model, BOX);
    assert_eq!(owners(&whole.model), [house, shed], "not {group}, not {hall}");
    assert!(near(volume(&whole.model), 16.0 * 8.0 * 20.0 + 27.0), "hall and tower share a box");
    let parts = derived_by(&model, Derive { form: BOX, parts: true });
    assert_eq!(owners(&parts.model), [hall, tower, shed]);
    assert!(near(volume(&parts.model), 400.0 + 320.0 + 27.0));
    // What is moved keeps its own objects, and the height of the whole.
    let raised = made(&model, Form::Height(Height::Metres(40.0)));
    assert_eq!(owners(&raised.model), [hall, tower, shed]);
    let tops = raised.model.geometries.iter().map(|g| (g.bounds.max.z * 1e3).round() / 1e3).collect::<Vec<_>>();
    assert_eq!(tops, [25.0, 40.0, 40.0], "by 20 m, the tower's height above the hall kept");
}

#[test]
fn pressed_flat_the_highest_is_seen() {
    let mut b = builder();
    add_house(&mut b, "house", [0, 0, 2000]);
    let model = b.finish();
    let derived = made(&model, FLAT);
    assert!(near(seen_from_above(&derived.model), 80.0), "the plan of two roofs");
    let level = |(corners, _, normal): &([DVec3; 3], u32, u32)| {
        corners.iter().all(|c| (c.z - 2.05).abs() < 1e-6) && *normal == crate::city::model::encode_normal(DVec3::Z)
    };
    assert!(triangles(&derived.model).iter().all(level));
    assert!(stacked_triangles(&derived.model, &derived.geometries(), &derived.heights).is_empty(), "side by side");

    // A dormer stands on the slope, lower than the ridge; a cellar's ceiling lies below all.
    let mut b = builder();
    let object = add_house(&mut b, "house", [0, 0, 0]);
    let surface = b.add_surface(Surface { object, material: NONE, kind: StringId(NONE), detail: NONE });
    let sheet = |z: i64| [[4000, 1000, z], [6000, 1000, z], [6000, 2500, z], [4000, 2500, z]];
    for z in [7400, 1000] {
        let polygons = Polygons {
            indices: vec![0, 1, 2, 3],
            ring_ends: vec![4],
            polygon_ends: vec![1],
            surfaces: vec![surface],
            ..Polygons::default()
        };
        let pool = std::sync::Arc::new(Pool { lattice: LATTICE, points: sheet(z).to_vec().into() });
        b.add_geometry(RawGeometry { object, lod: Lod { tenths: 20 }, solid: false, pool, polygons });
    }
    let derived = made(&b.finish(), FLAT);
    let stacked = stacked_triangles(&derived.model, &derived.geometries(), &derived.heights);
    let height = |triangle: u32| derived.heights[triangle as usize].iter().copied().fold(0.0, f32::max);
    let layers = |wanted: f32| {
        let all = stacked.iter().filter(|t| (height(t.triangle) - wanted).abs() < 1e-3).map(|t| t.layer);
        all.collect::<std::collections::BTreeSet<_>>().into_iter().collect::<Vec<_>>()
    };
    assert_eq!((layers(1.0), layers(8.0), layers(7.4)), (vec![0], vec![1], vec![2]), "ceiling, roof, dormer");
}

#[test]
fn what_is_pressed_flat_lies_on_the_slope_below_it() {
    let mut b = builder();
    add_house(&mut b, "house", [10_000, 10_000, 2000]);
    // Rises by 1 m in 10 m to the east; its western part is missing: x < 12 m.
    let slope = [[12_000, 0, 1200], [60_000, 0, 6000], [60_000, 60_000, 6000], [12_000, 60_000, 1200]];
    add(&mut b, "slope", ObjectClass::Terrain, None, slope.to_vec(), &[vec![0, 1, 2, 3]]);
    let derived = made(&b.finish(), FLAT);
    assert!(owners(&derived.model) == [0], "the ground stays where it is");
    let (mut on_slope, mut level) = (0, 0);
    for (corners, ..) in triangles(&derived.model) {
        let rise = |c: &DVec3| 0.1 * (c.x - LATTICE.origin.x);
        if corners.iter().all(|c| (c.z - rise(c) - 0.05).abs() < 1e-4) {
            on_slope += 1;
        } else {
            level += 1;
            assert!(corners.iter().all(|c| (c.z - 2.05).abs() < 1e-5), "{corners:?}");
        }
    }
    assert!(on_slope >= 4 && level >= 2, "{on_slope} {level}");
    let on = |model: &CityModel| {
        let area = |c: &[DVec3; 3]| 0.5 * (c[1] - c[0]).truncate().perp_dot((c[2] - c[0]).truncate());
        let sloping = triangles(model).into_iter().filter(|(c, ..)| c[0].z != c[1].z || c[0].z != c[2].z);
        sloping.map(|(c, ..)| area(&c)).sum::<f64>()
    };
    assert!(near(on(&derived.model), 8.0 * 8.0), "{}", on(&derived.model));
}

#[test]
fn walls_are_stretched_and_roofs_are_moved() {
    let mut b = builder();
    add_house(&mut b, "house", [0, 0, 1000]);
    let model = b.finish();
    let heights = |form| {
        let derived = made(&model, form);
        let mut all: Vec<i64> =
            triangles(&derived.model).iter().flat_map(|t| t.0).map(|c| (c.z * 1000.0).round() as i64).collect();
        all.sort_unstable();
        all.dedup();
        (all, volume(&derived.model))
    };
    let (levels, cubic) = heights(Form::Height(Height::Metres(20.0)));
    assert_eq!(levels, [1000, 18_000, 21_000], "the roof is 3 m high, as it was");
    assert!(near(cubic, 80.0 * 17.0 + 80.0 * 1.5));
    let (levels, cubic) = heights(Form::Height(Height::Factor(0.5)));
    assert_eq!(levels, [1000, 2000, 5000]);
    assert!(near(cubic, 80.0 + 120.0));
    let (levels, cubic) = heights(Form::Height(Height::Metres(2.0)));
    assert_eq!(levels, [1000, 2250, 3000], "lower than its roof: scaled as a whole");
    assert!(near(cubic, (80.0 * 5.0 + 120.0) / 4.0));
    // Faces look where they lie.
    let lowered = made(&model, Form::Height(Height::Metres(2.0)));
    for (corners, _, normal) in triangles(&lowered.model) {
        let lies = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        assert!(lies.angle_between(crate::city::model::decode_normal(normal)) < 1e-4, "{corners:?}");
    }
}

#[test]
fn what_has_no_such_form_stays_or_goes_and_is_counted() {
    let mut b = builder();
    let flat = vec![[0, 0, 0], [5000, 0, 0], [5000, 5000, 0], [0, 5000, 0]];
    add(&mut b, "lawn", ObjectClass::Vegetation, None, flat, &[vec![0, 1, 2, 3]]);
    let upright = vec![[0, 9000, 0], [5000, 9000, 0], [5000, 9000, 3000], [0, 9000, 3000]];
    add(&mut b, "fence", ObjectClass::Other, None, upright, &[vec![0, 1, 2, 3]]);
    add(&mut b, "sliver", ObjectClass::Other, None, vec![[0, 0, 0], [1, 0, 0], [0, 1, 1]], &[vec![0, 1, 2]]);
    let model = b.finish();
    let counts = |form| {
        let derived = made(&model, form);
        (derived.unchanged, derived.left_out, owners(&derived.model))
    };
    assert_eq!(counts(BOX), (2, 0, vec![2, 0, 1]), "the sliver has a box of a millimetre");
    assert_eq!(counts(Form::Prism), (2, 0, vec![2, 0, 1]));
    assert_eq!(counts(Form::Hull), (3, 0, vec![0, 1, 2]));
    assert_eq!(counts(FLAT), (0, 2, vec![0]));
    assert_eq!(counts(Form::Height(Height::Metres(9.0))).0, 1, "the lawn has no height to change");
    let lawn = made(&model, FLAT);
    assert!(triangles(&lawn.model).iter().all(|(c, ..)| c.iter().all(|c| DVec2::new(c.z, 0.05).length() < 0.08)));
}

#[test]
fn a_picture_from_above_keeps_the_light_of_slopes() {
    let mut b = builder();
    add_house(&mut b, "house", [0, 0, 2000]);
    // Half of it on a slope.
    let slope = [[5000, -10_000, 1000], [60_000, -10_000, 1500], [60_000, 60_000, 1500], [5000, 60_000, 1000]];
    add(&mut b, "slope", ObjectClass::Terrain, None, slope.to_vec(), &[vec![0, 1, 2, 3]]);
    let model = b.finish();
    let (flat, top) = (made(&model, FLAT), made(&model, TOP));
    let places = |derived: &Derived| triangles(&derived.model).into_iter().map(|t| t.0).collect::<Vec<_>>();
    assert_eq!((places(&flat), &flat.heights), (places(&top), &top.heights), "the same faces in the same order");
    // 3 m up over 4 m across, to the south and to the north.
    let south = DVec3::new(0.0, -0.6, 0.8);
    for (corners, _, normal) in triangles(&top.model) {
        let side = if corners.iter().map(|c| c.y - LATTICE.origin.y).sum::<f64>() < 12.0 { 1.0 } else { -1.0 };
        let wanted = south * DVec3::new(1.0, side, 1.0);
        assert!(crate::city::model::decode_normal(normal).distance(wanted) < 1e-3, "{corners:?}");
    }
}

#[test]
fn block_models_are_the_objects_own_and_prisms_stand_for_those_that_have_none() {
    let mut b = builder();
    let rich = add_house(&mut b, "rich", [0, 0, 0]);
    let poor = add_house(&mut b, "poor", [30_000, 0, 0]);
    // A block of 10 m × 8 m × 6 m beside the finer house.
    let surface = b.add_surface(Surface { object: rich, material: NONE, kind: StringId(NONE), detail: NONE });
    let ring = [[0, 0], [10_000, 0], [10_000, 8000], [0, 8000]];
    let points: Vec<[i64; 3]> = [0, 6000].iter().flat_map(|z| ring.map(|p| [p[0], p[1], *z])).collect();
    let mut polygons = Polygons::default();
    for face in [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]] {
        polygons.indices.extend(face);
        polygons.ring_ends.push(polygons.indices.len() as u32);
        polygons.polygon_ends.push(polygons.ring_ends.len() as u32);
        polygons.surfaces.push(surface);
    }
    let pool = std::sync::Arc::new(Pool { lattice: LATTICE, points: points.into() });
    b.add_geometry(RawGeometry { object: rich, lod: Lod { tenths: 12 }, solid: true, pool, polygons });
    let model = b.finish();
    let shown = crate::city::shown::shown_geometries(&model, None);
    let made = derive(&model, &shown, &Derive { form: Form::Lod1, parts: false });
    made.model.validate().expect("a sound model");
    assert_eq!((made.instead, made.unchanged, made.left_out), (1, 0, 0));
    let mut all = owners(&made.model);
    all.sort_unstable();
    assert_eq!(all, [rich, poor]);
    assert!(near(volume(&made.model), 80.0 * 6.0 + 80.0 * 8.0), "{}", volume(&made.model));
}

#[test]
fn every_word_has_its_row() {
    let height = Form::Height(Height::Factor(2.0));
    let all = [BOX, Form::Prism, Form::Hull, FLAT, TOP, Form::Lod1, height];
    let words: Vec<&str> = all.iter().map(|form| form.row().word).collect();
    assert_eq!(words, WORDS);
}

#[test]
fn reaches_hold_what_is_made() {
    let mut b = builder();
    add_house(&mut b, "house", [0, 0, 1000]);
    add_upright(&mut b, "turned", &[[0, 30_000], [16_000, 42_000], [10_000, 50_000], [-6000, 38_000]], [0, 9000]);
    let model = b.finish();
    let heights = [Height::Metres(30.0), Height::Factor(3.0), Height::Factor(0.5)].map(Form::Height);
    for form in
        [BOX, Form::Box { oriented: true }, Form::Prism, Form::Hull, FLAT, TOP, Form::Lod1].into_iter().chain(heights)
    {
        for geometry in &made(&model, form).model.geometries {
            let reach = form.reach(&model.family_bounds(geometry.object));
            let is_in = geometry.bounds.min.cmpge(reach.min) & geometry.bounds.max.cmple(reach.max);
            assert!(is_in.all(), "{form:?}: {:?} in {reach:?}", geometry.bounds);
        }
    }
}
