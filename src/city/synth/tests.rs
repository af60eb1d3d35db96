//! The written city, read back with nothing but a JSON reader.

use std::collections::{HashMap, HashSet};

use serde_json::Value;

use super::*;

fn written(buildings: u64, seed: u64) -> Value {
    let mut text = Vec::new();
    write_cityjson(&SynthOptions { buildings, seed }, &mut text, &mut |_| {}).unwrap();
    serde_json::from_slice(&text).unwrap()
}

fn array(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap()
}

fn vertices(city: &Value) -> Vec<[i128; 3]> {
    let point = |v: &Value| std::array::from_fn(|i| i128::from(v[i].as_i64().unwrap()));
    array(&city["vertices"]).iter().map(point).collect()
}

/// Rings of every face of a building's shell.
fn shell(object: &Value) -> Vec<Vec<Vec<usize>>> {
    let ring = |ring: &Value| array(ring).iter().map(|i| i.as_u64().unwrap() as usize).collect();
    array(&object["geometry"][0]["boundaries"][0]).iter().map(|face| array(face).iter().map(ring).collect()).collect()
}

fn buildings(city: &Value) -> impl Iterator<Item = (&String, &Value)> {
    city["CityObjects"].as_object().unwrap().iter().filter(|(_, o)| o["type"] == "Building")
}

fn minus(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Twice the ring's vector area.
fn area(points: &[[i128; 3]], ring: &[usize]) -> [i128; 3] {
    let mut sum = [0; 3];
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let part = cross(minus(points[*a], points[ring[0]]), minus(points[b], points[ring[0]]));
        sum = std::array::from_fn(|k| sum[k] + part[k]);
    }
    sum
}

#[test]
fn shells_are_closed_outward_and_exactly_planar() {
    let mut shapes = HashSet::new();
    for seed in 1..=8 {
        check_shells(&written(3000, seed), &mut shapes);
    }
    // Flat and shed share a topology; gable, hip, mansard, corner, court and tower have their own.
    assert_eq!(shapes.len(), 7, "{shapes:?}");
}

/// Checks every building; gathers what tells the shapes apart: numbers of faces and of roofs.
fn check_shells(city: &Value, shapes: &mut HashSet<(usize, usize)>) {
    let points = vertices(city);
    for (id, object) in buildings(city) {
        let faces = shell(object);
        let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
        let mut six_volumes = 0;
        for rings in &faces {
            let normal = area(&points, &rings[0]);
            assert_ne!(normal, [0; 3], "{id}: a face without area");
            for (k, ring) in rings.iter().enumerate() {
                assert_eq!(ring.iter().collect::<HashSet<_>>().len(), ring.len(), "{id}: a point twice in a ring");
                for (i, a) in ring.iter().enumerate() {
                    *edges.entry((*a, ring[(i + 1) % ring.len()])).or_default() += 1;
                    assert_eq!(dot(normal, minus(points[*a], points[rings[0][0]])), 0, "{id}: not planar");
                }
                let ring_area = area(&points, ring);
                assert_eq!(dot(normal, ring_area) > 0, k == 0, "{id}: holes run the other way round");
                six_volumes += dot(ring_area, points[ring[0]]);
            }
        }
        for ((a, b), count) in &edges {
            assert_eq!((*count, edges.get(&(*b, *a))), (1, Some(&1)), "{id}: edge {a}-{b} is not closed");
        }
        assert!(six_volumes > 0, "{id}: inside out");
        let values = array(&object["geometry"][0]["semantics"]["values"][0]);
        assert_eq!(values.len(), faces.len(), "{id}: semantics");
        for (value, rings) in values.iter().zip(&faces) {
            let up = area(&points, &rings[0])[2].signum();
            assert_eq!(i128::from([-1, 0, 1][value.as_u64().unwrap() as usize]), up, "{id}: ground, wall or roof");
        }
        shapes.insert((faces.len(), values.iter().filter(|v| **v == 2).count()));
    }
}

#[test]
fn exactly_the_buildings_asked_for_with_three_attributes() {
    for count in [0, 1, 2, 17, 500] {
        let city = written(count, 3);
        assert_eq!(buildings(&city).count() as u64, count);
        let points = vertices(&city);
        for (id, object) in buildings(&city) {
            let attributes = object["attributes"].as_object().unwrap();
            assert_eq!(attributes.keys().collect::<Vec<_>>(), ["height", "function", "yearOfConstruction"]);
            let used = shell(object).into_iter().flatten().flatten();
            let height = used.map(|i| points[i][2]).max().unwrap();
            assert_eq!(attributes["height"].as_f64().unwrap(), height as f64 / 1000.0, "{id}");
            assert!(attributes["height"].is_f64() && attributes["yearOfConstruction"].is_i64());
        }
    }
}

#[test]
fn footprints_do_not_overlap_but_share_walls() {
    let city = written(1200, 11);
    let points = vertices(&city);
    let boxes: Vec<[i128; 4]> = buildings(&city)
        .map(|(_, object)| {
            let ground: Vec<_> = shell(object)[0][0].iter().map(|&i| points[i]).collect();
            let axis = |k: usize| ground.iter().map(move |p| p[k]);
            [axis(0).min().unwrap(), axis(1).min().unwrap(), axis(0).max().unwrap(), axis(1).max().unwrap()]
        })
        .collect();
    let mut touching = 0;
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[..i] {
            let [width, depth] = [0, 1].map(|k| a[k + 2].min(b[k + 2]) - a[k].max(b[k]));
            assert!(width <= 0 || depth <= 0, "{a:?} and {b:?} overlap");
            touching += usize::from((width == 0 && depth > 0) || (depth == 0 && width > 0));
        }
    }
    assert!(touching > 300, "only {touching} party walls");
}

#[test]
fn streets_and_grounds_face_up_and_cover_their_cells() {
    let city = written(300, 2);
    let points = vertices(&city);
    let objects = city["CityObjects"].as_object().unwrap();
    let ring = |id: &str| -> Vec<usize> {
        let ring = array(&objects[id]["geometry"][0]["boundaries"][0][0]);
        ring.iter().map(|i| i.as_u64().unwrap() as usize).collect()
    };
    let blocks = objects.values().filter(|o| o["type"] == "Road").count();
    assert!(blocks > 10 && objects.len() == 300 + 2 * blocks);
    for block in 1..=blocks {
        let (street, ground) = (ring(&format!("s{block}")), ring(&format!("g{block}")));
        let [street_area, ground_area] = [&street, &ground].map(|ring| area(&points, ring));
        assert!(street_area[..2] == [0, 0] && ground_area[..2] == [0, 0] && ground_area[2] > 0);
        let axis = |k: usize| street.iter().map(|&i| points[i][k]).max().unwrap() - points[street[0]][k];
        assert_eq!(street_area[2] + ground_area[2], 2 * axis(0) * axis(1), "block {block}");
    }
}

#[test]
fn the_seed_alone_decides() {
    let bytes = |buildings, seed| {
        let mut text = Vec::new();
        write_cityjson(&SynthOptions { buildings, seed }, &mut text, &mut |_| {}).unwrap();
        text
    };
    assert_eq!(bytes(300, 1), bytes(300, 1));
    assert_ne!(bytes(300, 1), bytes(300, 2));
    // FNV-1a of the bytes: the same on every machine and in every version that does not announce a change.
    let hash =
        bytes(300, 1).iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(hash, 0x6c2c_0e50_e600_1a58, "{hash:#x}");
}

#[test]
fn a_sequence_holds_the_same_objects() {
    let options = SynthOptions { buildings: 200, seed: 5 };
    let mut text = Vec::new();
    write_cityjsonseq(&options, &mut text, &mut |_| {}).unwrap();
    let whole = written(200, 5);
    let points = vertices(&whole);
    let lines: Vec<Value> =
        String::from_utf8(text).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines[0]["type"], "CityJSON");
    assert_eq!(lines.len() - 1, whole["CityObjects"].as_object().unwrap().len());
    for feature in lines[1..].iter().filter(|f| f["id"].as_str().unwrap().starts_with('b')) {
        let id = feature["id"].as_str().unwrap();
        let here = vertices(feature);
        let corners = |object: &Value, points: &[[i128; 3]]| -> Vec<[i128; 3]> {
            shell(object).into_iter().flatten().flatten().map(|i| points[i]).collect()
        };
        let (one, other) = (&feature["CityObjects"][id], &whole["CityObjects"][id]);
        assert_eq!(corners(one, &here), corners(other, &points), "{id}");
        assert_eq!(one["attributes"], other["attributes"]);
    }
}

#[test]
fn heights_are_written_as_numbers() {
    assert_eq!([metres(12_000), metres(12_340), metres(5)], ["12.0", "12.34", "0.005"]);
}
