//! The full city: its objects as they are made, and its files read back.

use std::collections::{HashMap, HashSet};

use serde_json::Value as Json;

use crate::city::{
    build::ModelBuilder,
    load::{LoadOptions, input, read_input},
    synth::{
        SynthOptions,
        full::{
            blocks::{Block, Kind},
            city::each_family,
            field::{P2, P3},
            frame::STEP,
            history::{FIRST, LAST},
            object::{Geometry, Object, Value},
            plan::{Cells, Plan},
            shell::{Shell, Surface},
            transport, write_cityjson, write_cityjsonseq, write_timetable,
        },
    },
};

fn cross(a: P3, b: P3) -> [i128; 3] {
    let [a, b] = [a, b].map(|v| v.map(i128::from));
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn minus(a: P3, b: P3) -> P3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [i128; 3], b: P3) -> i128 {
    (0..3).map(|k| a[k] * i128::from(b[k])).sum()
}

/// Twice the vector area of a ring.
fn area(points: &[P3], ring: &[u32]) -> [i128; 3] {
    let at = |i: usize| points[ring[i % ring.len()] as usize];
    let mut sum = [0; 3];
    for i in 0..ring.len() {
        let part = cross(minus(at(i), at(0)), minus(at(i + 1), at(0)));
        sum = [sum[0] + part[0], sum[1] + part[1], sum[2] + part[2]];
    }
    sum
}

/// A shell is closed, looks outward, and its faces are exactly planar, with holes that run the other way round.
pub fn check_shell(shell: &Shell, id: &str) {
    let points = &shell.points;
    let mut edges: HashMap<(P3, P3), i32> = HashMap::new();
    let mut six_volumes = 0;
    for (surface, rings) in &shell.faces {
        let normal = area(points, &rings[0]);
        assert_ne!(normal, [0; 3], "{id}: a face without area ({surface:?})");
        let up = normal[2].signum();
        match surface {
            Surface::Ground | Surface::Floor => assert_eq!(up, -1, "{id}: {surface:?}"),
            Surface::Roof | Surface::Ceiling => assert_eq!(up, 1, "{id}: {surface:?}"),
            Surface::InteriorWall | Surface::Window | Surface::Door => assert_eq!(up, 0, "{id}: {surface:?}"),
            _ => {}
        }
        for (k, ring) in rings.iter().enumerate() {
            let ring_area = area(points, ring);
            let along: i128 = (0..3).map(|i| normal[i] * ring_area[i]).sum();
            assert_eq!(along > 0, k == 0, "{id}: holes run the other way round ({surface:?})");
            let first = points[rings[0][0] as usize];
            for (i, a) in ring.iter().enumerate() {
                let (a, b) = (points[*a as usize], points[ring[(i + 1) % ring.len()] as usize]);
                assert_eq!(dot(normal, minus(a, first)), 0, "{id}: not planar ({surface:?})");
                *edges.entry((a, b)).or_default() += 1;
            }
            six_volumes += dot(ring_area, minus(points[ring[0] as usize], points[0]));
        }
    }
    for ((a, b), count) in &edges {
        assert_eq!((*count, edges.get(&(*b, *a))), (1, Some(&1)), "{id}: edge {a:?} {b:?} is not closed");
    }
    assert!(six_volumes > 0, "{id}: inside out");
}

fn objects(buildings: u64, seed: u64) -> Vec<Object> {
    let mut all = Vec::new();
    let plan = Plan::new(&SynthOptions { buildings, seed });
    each_family(&plan, &mut |family, _| {
        all.extend_from_slice(family);
        Ok(())
    })
    .unwrap();
    all
}

fn whole(object: &Object, name: &str) -> Option<i64> {
    object.attributes.iter().find(|(n, _)| *n == name).map(|(_, value)| match value {
        Value::Whole(number) | Value::Length(number) => *number,
        Value::Text(text) => panic!("{}: {name} is the text {text}", object.id),
    })
}

fn text<'a>(object: &'a Object, name: &str) -> Option<&'a str> {
    object.attributes.iter().find(|(n, _)| *n == name).map(|(_, value)| match value {
        Value::Text(text) => text.as_str(),
        other => panic!("{}: {name} is {other:?}", object.id),
    })
}

/// From which year on a building stood, and from which on it did not.
fn years(object: &Object) -> [i64; 2] {
    [whole(object, "yearOfConstruction").unwrap(), whole(object, "yearOfDemolition").unwrap_or(i64::MAX)]
}

fn written(buildings: u64, seed: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_cityjson(&SynthOptions { buildings, seed }, &mut bytes, &mut |_| {}).unwrap();
    bytes
}

#[test]
fn solids_are_closed_outward_and_exactly_planar() {
    let mut kinds: HashMap<(&str, &str), u64> = HashMap::new();
    for seed in 1..=4 {
        for object in objects(1500, seed) {
            for geometry in &object.geometries {
                let (lod, shells) = match geometry {
                    Geometry::Solid(lod, shell) => (*lod, std::slice::from_ref(shell)),
                    Geometry::Solids(lod, shells) => (*lod, &shells[..]),
                    _ => continue,
                };
                shells.iter().for_each(|shell| check_shell(shell, &object.id));
                *kinds.entry((object.kind, lod)).or_default() += 1;
            }
        }
    }
    for (kind, lod, least) in [
        ("Building", "1", 6000),
        ("Building", "2", 6000),
        ("Building", "3", 400),
        ("BuildingPart", "2", 28),
        ("BuildingInstallation", "2", 1000),
        ("BuildingInstallation", "3", 8),
        ("BuildingRoom", "3", 120),
        ("BuildingFurniture", "3", 96),
        ("Bridge", "2", 12),
        ("BridgeConstructiveElement", "2", 12),
        ("CityFurniture", "2", 20),
    ] {
        let count = kinds.get(&(kind, lod)).copied().unwrap_or(0);
        assert!(count >= least, "{kind} in level of detail {lod}: {count}");
    }
}

#[test]
fn exactly_the_buildings_asked_for_stand_today_and_ids_are_unique() {
    for (count, seed) in [(100, 1), (101, 2), (137, 3), (2000, 4)] {
        let all = objects(count, seed);
        let standing = all.iter().filter(|o| o.kind == "Building" && whole(o, "yearOfDemolition").is_none()).count();
        assert_eq!(standing as u64, count);
        let ids: HashSet<&str> = all.iter().map(|o| o.id.as_str()).collect();
        assert_eq!(ids.len(), all.len(), "seed {seed}");
        for name in ["Minster", "Town Hall"] {
            assert_eq!(all.iter().filter(|o| text(o, "name").is_some_and(|n| n.ends_with(name))).count(), 1, "{name}");
        }
        // Links lead both ways.
        let by_id: HashMap<&str, &Object> = all.iter().map(|o| (o.id.as_str(), o)).collect();
        for object in &all {
            for child in &object.children {
                assert_eq!(by_id[child.as_str()].parent.as_deref(), Some(object.id.as_str()));
            }
            let has_link = |parent: &String| by_id[parent.as_str()].children.contains(&object.id);
            assert!(object.parent.as_ref().is_none_or(has_link), "{}", object.id);
        }
    }
}

/// The convex hull of a footprint that is given as the ring of a ground face: a rectangle, or an L of six corners.
fn footprint(object: &Object) -> Vec<P2> {
    let shell = object.geometries.iter().find_map(|geometry| match geometry {
        Geometry::Solid("2", shell) => Some(shell),
        _ => None,
    });
    let shell = shell.unwrap_or_else(|| panic!("{} has no level of detail 2", object.id));
    let ring = &shell.faces[0].1[0];
    let points: Vec<P2> = ring.iter().rev().map(|i| shell.points[*i as usize]).map(|[x, y, _]| [x, y]).collect();
    let is_convex = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| points[(i + k + points.len() - 1) % points.len()]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) > 0
    };
    (0..points.len()).filter(|i| is_convex(*i)).map(|i| points[i]).collect()
}

/// Whether the insides of two convex polygons share a place.
fn overlap(a: &[P2], b: &[P2]) -> bool {
    let separates = |a: &[P2], b: &[P2]| {
        (0..a.len()).any(|i| {
            let (p, q) = (a[i], a[(i + 1) % a.len()]);
            b.iter().all(|r| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) <= 0)
        })
    };
    !separates(a, b) && !separates(b, a)
}

#[test]
fn no_two_buildings_stand_in_one_place_in_any_year() {
    let mut touching = 0;
    for seed in [1, 2, 3] {
        let all = objects(2500, seed);
        let houses: Vec<([i64; 2], Vec<P2>, &str)> = all
            .iter()
            .filter(|o| o.kind == "Building" && !o.geometries.is_empty())
            .map(|o| (years(o), footprint(o), o.id.as_str()))
            .collect();
        const CELL: i64 = 60_000;
        let mut cells: HashMap<P2, Vec<usize>> = HashMap::new();
        for (i, (_, points, _)) in houses.iter().enumerate() {
            let at: HashSet<P2> = points.iter().map(|p| p.map(|v| v.div_euclid(CELL))).collect();
            at.into_iter().for_each(|cell| cells.entry(cell).or_default().push(i));
        }
        let sample: Vec<i64> = (FIRST..=LAST).step_by(10).chain([LAST]).collect();
        for members in cells.values() {
            for (k, i) in members.iter().enumerate() {
                for j in &members[..k] {
                    let ((a, p, id), (b, q, other)) = (&houses[*i], &houses[*j]);
                    if !sample.iter().any(|year| a[0] <= *year && *year < a[1] && b[0] <= *year && *year < b[1]) {
                        continue;
                    }
                    assert!(!overlap(p, q), "seed {seed}: {id} and {other}: {p:?} {q:?}");
                    touching += usize::from(p.iter().filter(|corner| q.contains(corner)).count() >= 1);
                }
            }
        }
    }
    assert!(touching > 2000, "only {touching} stand wall to wall");
}

#[test]
fn what_stood_before_ends_when_its_successor_begins_and_is_smaller() {
    let all = objects(3000, 9);
    let by_id: HashMap<&str, &Object> = all.iter().map(|o| (o.id.as_str(), o)).collect();
    let mut chains = 0;
    let mut oldest = LAST;
    for object in all.iter().filter(|o| o.kind == "Building") {
        let [from, to] = years(object);
        assert!(FIRST <= from && from < to && from <= LAST, "{}: {from} to {to}", object.id);
        oldest = oldest.min(from);
        let successor = text(object, "successor").map(|id| by_id[id]);
        assert_eq!(successor.is_some(), to != i64::MAX, "{}: what is gone has a successor", object.id);
        if let Some(successor) = successor {
            assert_eq!(years(successor)[0], to, "{}", object.id);
            assert_eq!(text(successor, "predecessor"), Some(object.id.as_str()));
            assert!(whole(object, "measuredHeight") < whole(successor, "measuredHeight"), "{}", object.id);
            let outer = footprint(successor);
            for point in footprint(object) {
                let is_inside = (0..outer.len()).all(|i| {
                    let (p, q) = (outer[i], outer[(i + 1) % outer.len()]);
                    (q[0] - p[0]) * (point[1] - p[1]) - (q[1] - p[1]) * (point[0] - p[0]) > 0
                });
                assert!(is_inside, "{} stands in its successor", object.id);
            }
            chains += 1;
        }
        let predecessor = text(object, "predecessor").map(|id| by_id[id]);
        assert!(predecessor.is_none_or(|p| text(p, "successor") == Some(object.id.as_str())));
    }
    assert!(chains > 400 && oldest < 1440, "{chains} predecessors, the oldest of {oldest}");
}

#[test]
fn attributes_are_within_their_ranges() {
    let all = objects(1500, 6);
    let mut classes = HashSet::new();
    for object in all.iter().filter(|o| o.kind == "Building") {
        let id = &object.id;
        let storeys = whole(object, "storeysAboveGround").unwrap();
        let height = whole(object, "measuredHeight").unwrap();
        assert!((1..=40).contains(&storeys) && (2_000..=150_000).contains(&height), "{id}: {storeys}, {height} mm");
        assert!(storeys == 1 || height / storeys >= 2_500, "{id}: {storeys} storeys in {height} mm");
        assert!((0..=2_000).contains(&whole(object, "inhabitants").unwrap()), "{id}");
        assert!(text(object, "function").is_some_and(|f| !f.is_empty()));
        if let Some(class) = text(object, "energyClass") {
            assert!(["A", "B", "C", "D", "E", "F", "G"].contains(&class), "{id}: {class}");
            assert!(whole(object, "yearOfDemolition").is_none(), "{id}: nobody rates what is gone");
            classes.insert(class);
        }
        if let Some(address) = &object.address {
            assert!(address.number > 0 && address.code.len() == 5 && address.street.len() > 5, "{id}: {address:?}");
        }
        let top = object.geometries.iter().filter_map(|g| match g {
            Geometry::Solid("2", shell) => shell.points.iter().map(|p| p[2]).max(),
            _ => None,
        });
        let floor = top.max().map(|top| top - height);
        let low = footprint_low(object);
        assert!(floor.zip(low).is_none_or(|(floor, low)| floor > low), "{id}: its floor lies above its lowest edge");
    }
    assert_eq!(classes.len(), 7);
    let addressed = all.iter().filter(|o| o.address.is_some()).count();
    assert!(addressed > 1400, "{addressed} addresses");
}

/// The lowest edge of a building.
fn footprint_low(object: &Object) -> Option<i64> {
    object.geometries.iter().find_map(|g| match g {
        Geometry::Solid("2", shell) => shell.points.iter().map(|p| p[2]).min(),
        _ => None,
    })
}

#[test]
fn houses_stand_in_the_ground_and_not_above_it() {
    let plan = Plan::new(&SynthOptions { buildings: 3000, seed: 5 });
    let mut steepest = 0;
    for cell in Cells::default().take_while(|cell| Plan::ring(*cell) <= plan.last) {
        for lot in Block::city(&plan, cell).lots {
            let house = &lot.house;
            for corner in house.frame.rectangle([0, 0], [house.width, house.depth]) {
                let ground = plan.field.height(corner);
                assert!(house.base <= ground - 500, "{cell:?}: the ground is {} mm below a wall", house.base - ground);
                steepest = steepest.max(house.floor - house.base);
            }
            let front = [0, house.width].map(|x| plan.field.height(house.frame.at(x, 0)));
            assert!(front.iter().all(|ground| *ground < house.floor), "{cell:?}: a floor below the street");
        }
    }
    assert!(steepest > 1_200, "no slope to stand on: {steepest}");
}

#[test]
fn the_church_is_behind_the_houses() {
    for seed in 1..=6 {
        let plan = Plan::new(&SynthOptions { buildings: 1000, seed });
        let block = Block::city(&plan, [0, 0]);
        assert_eq!(block.kind, Kind::Close);
        let middle = block.corners.iter().fold([0, 0], |sum, c| [sum[0] + c[0] / 4, sum[1] + c[1] / 4]);
        let (mut seen, mut count) = (0, 0);
        for side in 0..4 {
            for k in 0..40 {
                // Eyes on the pavement at this side, and 6 m up the church.
                let (a, b) = (block.corners[side], block.corners[(side + 1) % 4]);
                let eye = [0, 1].map(|n| a[n] + (b[n] - a[n]) * (2 * k + 1) / 80);
                let eye = [0, 1].map(|n| eye[n] - (middle[n] - eye[n]) / 30);
                let low = plan.field.height(eye) + 1_700;
                let high = plan.field.height(middle) + 6_000;
                let is_hidden = block.lots.iter().any(|lot| {
                    let house = &lot.house;
                    let top = house.floor + house.eaves;
                    (1..200).any(|part| {
                        let at = [0, 1].map(|n| eye[n] + (middle[n] - eye[n]) * part / 200);
                        let z = low + (high - low) * part / 200;
                        let away = [at[0] - house.frame.origin[0], at[1] - house.frame.origin[1]];
                        let along = |step: P2| (away[0] * step[0] + away[1] * step[1]) / (STEP * STEP);
                        let (x, y) = (along(house.frame.u), along(house.frame.v));
                        (0..=house.width).contains(&x) && (0..=house.depth).contains(&y) && z < top
                    })
                });
                seen += usize::from(!is_hidden);
                count += 1;
            }
        }
        assert!(seen * 100 <= count * 15, "seed {seed}: seen from {seen} of {count} places");
        assert!(super::landmark::church(&plan, &block, "b1", "x").is_some_and(|parts| parts.len() == 8));
    }
}

#[test]
fn the_seed_alone_decides() {
    let bytes = written(100, 1);
    assert_eq!(bytes, written(100, 1));
    assert_ne!(bytes, written(100, 2));
    // FNV-1a of the bytes: the same on every machine and in every version that does not announce a change.
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(hash, 0x6144_308d_ff21_61a0, "{hash:#x}");
}

#[test]
fn a_sequence_holds_the_same_objects() {
    let options = SynthOptions { buildings: 120, seed: 5 };
    let mut text = Vec::new();
    write_cityjsonseq(&options, &mut text, &mut |_| {}).unwrap();
    let whole: Json = serde_json::from_slice(&written(120, 5)).unwrap();
    let text = String::from_utf8(text).unwrap();
    let mut lines = text.lines().map(|line| serde_json::from_str::<Json>(line).unwrap());
    let first = lines.next().unwrap();
    assert_eq!(first["geometry-templates"], whole["geometry-templates"]);
    let mut count = 0;
    for feature in lines {
        let own = feature["CityObjects"].as_object().unwrap();
        assert!(own.contains_key(feature["id"].as_str().unwrap()));
        for (id, object) in own {
            let other = &whole["CityObjects"][id];
            assert_eq!(object["attributes"], other["attributes"], "{id}");
            assert_eq!(places(object, &feature["vertices"]), places(other, &whole["vertices"]), "{id}");
            count += 1;
        }
    }
    assert_eq!(count, whole["CityObjects"].as_object().unwrap().len());
}

/// The vertices that an object names, in the order in which it does.
fn places(object: &Json, vertices: &Json) -> Vec<Json> {
    fn gather(boundaries: &Json, vertices: &Json, into: &mut Vec<Json>) {
        match boundaries {
            Json::Array(list) => list.iter().for_each(|item| gather(item, vertices, into)),
            index => into.push(vertices[index.as_u64().unwrap() as usize].clone()),
        }
    }
    let mut found = Vec::new();
    for geometry in object["geometry"].as_array().unwrap() {
        gather(&geometry["boundaries"], vertices, &mut found);
    }
    found
}

#[test]
fn nothing_in_it_is_worth_a_warning() {
    for (buildings, seed) in [(100, 1), (700, 2), (2500, 3)] {
        let mut builder = ModelBuilder::default();
        let input = input::from_bytes("town.city.json".as_ref(), written(buildings, seed)).unwrap();
        read_input(&mut builder, input, &LoadOptions::default()).unwrap();
        let model = builder.finish();
        assert!(model.warnings.is_empty(), "{buildings}, seed {seed}: {:?}", model.warnings);
        assert!(model.objects.len() as u64 > 4 * buildings);
    }
}

#[test]
fn vehicles_keep_to_their_lines_and_begin_where_they_stand() {
    let options = SynthOptions { buildings: 1200, seed: 3 };
    let plan = Plan::new(&options);
    let services = transport::services(&plan);
    let vehicles: Vec<Object> = services.iter().map(transport::Service::object).collect();
    let mut csv = Vec::new();
    write_timetable(&options, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("id,t,x,y,z,yaw,scale"));
    let mut last: HashMap<&str, (&str, f64)> = HashMap::new();
    for line in lines {
        let [id, time, x, y, z, yaw, scale] = line.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
        let at = [x, y, z].map(|v| v.parse::<f64>().unwrap());
        let yaw: f64 = yaw.parse().unwrap();
        assert!(time.len() == 19 && time.starts_with("2025-06-01T") && scale == "1", "{line}");
        let service = services.iter().position(|s| s.id == id).unwrap();
        let ways = [&services[service].out, &services[service].back];
        let away = ways.iter().flat_map(|way| way.points.windows(2)).map(|pair| distance(at, pair)).fold(1e9, f64::min);
        assert!(away < 0.002, "{line}: {away} m off the line");
        match last.insert(id, (time, yaw)) {
            // Times are in order as texts; turns are the shorter way round.
            Some((before, turned)) => assert!(before < time && (yaw - turned).abs() <= 180.0, "{line}"),
            None => {
                let Geometry::Solids(_, shells) = &vehicles[service].geometries[0] else { panic!() };
                let points: Vec<P3> = shells.iter().flat_map(|s| &s.points).copied().collect();
                let middle =
                    [0, 1].map(|k| points.iter().map(|p| p[k] as f64).sum::<f64>() / points.len() as f64 / 1e3);
                assert!((middle[0] - at[0]).hypot(middle[1] - at[1]) < 3.0, "{id} stands at {middle:?}, not {at:?}");
            }
        }
    }
    assert_eq!(last.len(), services.len());
    assert!(["tram", "boat"].iter().all(|kind| last.keys().filter(|id| id.starts_with(kind)).count() >= 2));
    assert!(last.values().all(|(time, _)| *time > "2025-06-01T22:30:00"));
}

/// How far a place is from a segment in space, metres.
fn distance(at: [f64; 3], pair: &[P3]) -> f64 {
    let [a, b] = [0, 1].map(|k| pair[k].map(|v| v as f64 / 1000.0));
    let d = [0, 1, 2].map(|k| b[k] - a[k]);
    let length: f64 = d.iter().map(|v| v * v).sum();
    let t = ((0..3).map(|k| (at[k] - a[k]) * d[k]).sum::<f64>() / length).clamp(0.0, 1.0);
    (0..3).map(|k| (at[k] - a[k] - t * d[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn work_grows_with_the_buildings_and_no_piece_of_it_does() {
    let sizes = |buildings: u64| {
        let plan = Plan::new(&SynthOptions { buildings, seed: 8 });
        let (mut families, mut largest) = (0, 0);
        each_family(&plan, &mut |family, _| {
            families += 1;
            let points = |shell: &Shell| shell.points.len();
            let of_geometry = |geometry: &Geometry| match geometry {
                Geometry::Solid(_, shell) | Geometry::Surfaces(_, shell) | Geometry::Relief(_, shell) => points(shell),
                Geometry::Solids(_, shells) => shells.iter().map(points).sum(),
                Geometry::Instance(..) => 1,
            };
            largest = largest.max(family.iter().flat_map(|o| &o.geometries).map(of_geometry).sum::<usize>());
            Ok(())
        })
        .unwrap();
        (families, largest)
    };
    let (small, large) = (sizes(4_000), sizes(16_000));
    assert!(large.0 < 5 * small.0, "{small:?}, {large:?}");
    assert!(large.1 < 6_000 && large.1 < 2 * small.1, "{small:?}, {large:?}");
}
