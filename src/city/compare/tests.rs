use std::sync::Arc;

use proptest::prelude::*;
use serde_json::{Value as Json, json};

use super::*;
use crate::city::{
    build::{Lattice, ModelBuilder, Polygons, Pool, RawGeometry, RawObject},
    crs::{Frames, UtmZone},
    load::{LoadOptions, Quiet, load},
    model::{Attribute, Lod, NONE, Surface, Value},
    test_city::{LATTICE, builder, terrain},
};

/// An object as tests make it: corners in steps of the grid, faces of rings.
#[derive(Clone, Debug, Default)]
struct Made {
    id: String,
    kind: &'static str,
    parents: Vec<String>,
    attributes: Vec<(&'static str, Json)>,
    points: Vec<[i64; 3]>,
    faces: Vec<Vec<Vec<u32>>>,
    lod: Option<&'static str>,
}

impl Made {
    fn bare(id: &str) -> Self {
        Self { id: id.to_owned(), kind: "Building", ..Self::default() }
    }

    /// A box of 10 m.
    fn at(id: &str, corner: [i64; 3]) -> Self {
        let points = (0..8).map(|i| [0, 1, 2].map(|axis| corner[axis] + 10_000 * (i >> axis & 1))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Self { points, faces: faces.map(|ring| vec![ring.to_vec()]).to_vec(), ..Self::bare(id) }
    }

    fn kind(mut self, kind: &'static str) -> Self {
        self.kind = kind;
        self
    }

    fn of(mut self, parent: &str) -> Self {
        self.parents.push(parent.to_owned());
        self.kind("BuildingPart")
    }

    fn with(mut self, name: &'static str, value: Json) -> Self {
        self.attributes.push((name, value));
        self
    }
}

fn city(objects: &[Made]) -> CityModel {
    city_on(LATTICE, objects)
}

fn value(builder: &mut ModelBuilder, json: &Json) -> Value {
    match json {
        Json::Null => Value::Null,
        Json::Bool(is) => Value::Boolean(*is),
        Json::Number(n) => n.as_i64().map_or_else(|| Value::Number(n.as_f64().expect("a number")), Value::Integer),
        Json::String(text) => Value::String(builder.intern(text)),
        Json::Array(_) => Value::Array(builder.intern(&json.to_string())),
        Json::Object(_) => Value::Object(builder.intern(&json.to_string())),
    }
}

fn city_on(lattice: Lattice, objects: &[Made]) -> CityModel {
    let mut builder = builder();
    // Two cities do not number their strings alike.
    builder.intern(objects.last().map_or("", |object| &object.id));
    for made in objects {
        let attributes = made.attributes.iter().map(|(name, json)| {
            let value = value(&mut builder, json);
            Attribute { name: builder.intern(name), value }
        });
        let attributes: Vec<Attribute> = attributes.collect();
        let raw = RawObject { id: made.id.clone(), kind: made.kind.to_owned(), ..RawObject::default() };
        let object = builder.add_object(RawObject { parents: made.parents.clone(), attributes, ..raw });
        if made.faces.is_empty() {
            continue;
        }
        let surface = builder.add_surface(Surface { object, material: NONE, kind: StringId(NONE), detail: NONE });
        let mut polygons = Polygons::default();
        for face in &made.faces {
            for ring in face {
                polygons.indices.extend_from_slice(ring);
                polygons.ring_ends.push(polygons.indices.len() as u32);
            }
            polygons.polygon_ends.push(polygons.ring_ends.len() as u32);
            polygons.surfaces.push(surface);
        }
        let pool = Arc::new(Pool { lattice, points: made.points.clone().into() });
        let lod = Lod::parse(made.lod.unwrap_or("2")).unwrap_or(Lod::NONE);
        builder.add_geometry(RawGeometry { object, lod, solid: false, pool, polygons });
    }
    let model = builder.finish();
    model.validate().expect("a sound model");
    model
}

fn compared(before: &CityModel, after: &CityModel) -> Comparison {
    Comparison::new(before, after, &Key::Id).expect("two states of a city")
}

fn by(name: &str, before: &CityModel, after: &CityModel) -> Comparison {
    Comparison::new(before, after, &Key::Attribute(name.to_owned())).expect("two states of a city")
}

fn changed(geometry: bool, attributes: bool) -> State {
    State::Changed { geometry, attributes }
}

/// Whether faces alone, of one object, differ.
fn differ(old: &Made, new: &Made) -> bool {
    let found = compared(&city(std::slice::from_ref(old)), &city(std::slice::from_ref(new)));
    assert!(matches!(found.after[0].own, State::Unchanged | State::Changed { attributes: false, .. }));
    found.after[0].own != State::Unchanged
}

#[test]
fn what_came_went_and_changed() {
    let house = |id: &str, x: i64| Made::at(id, [x, 0, 0]);
    let before = city(&[
        house("same", 0).with("year", json!(1900)),
        house("moved", 20_000),
        house("renamed", 40_000).with("name", json!("old")).with("height", json!(10)).with("gone", json!(true)),
        house("gone", 60_000),
        house("both", 80_000).with("height", json!(3.5)),
    ]);
    let after = city(&[
        house("both", 80_001).with("height", json!(3.25)),
        house("new", 100_000),
        house("renamed", 40_000).with("height", json!(10.0)).with("name", json!("new")).with("fresh", json!(null)),
        house("moved", 20_000).with("fresh", json!("x")),
        house("same", 0).with("year", json!(1900)).with("none", json!(null)),
    ]);
    let found = compared(&before, &after);
    let own = |side: &[Compared]| side.iter().map(|compared| compared.own).collect::<Vec<_>>();
    let (a, r, u) = (State::Added, State::Removed, State::Unchanged);
    assert_eq!(own(&found.before), [u, changed(false, true), changed(false, true), r, changed(true, true)]);
    assert_eq!(own(&found.after), [changed(true, true), a, changed(false, true), changed(false, true), u]);
    let counterparts: Vec<_> = found.before.iter().map(|compared| compared.counterpart).collect();
    assert_eq!(counterparts, [Some(4), Some(3), Some(2), None, Some(0)]);
    let counts = Counts { added: 1, removed: 1, changed: 3, changed_geometry: 1, changed_attributes: 3, unchanged: 1 };
    assert_eq!((found.objects, found.roots, found.types_changed), (counts, counts, 0));
    let count = |added, removed, changed| AttributeCounts { added, removed, changed };
    let names = ["fresh", "gone", "height", "name"];
    let counts = [count(1, 0, 0), count(0, 1, 0), count(0, 0, 1), count(0, 0, 1)];
    assert_eq!(found.attributes, [0, 1, 2, 3].map(|i| (names[i].to_owned(), counts[i])));
    let mut told = Vec::new();
    found.each_change(&before, &after, &mut |object, change| told.push((object, change.name.to_owned())));
    let expected = [(0, "height"), (2, "name"), (2, "gone"), (3, "fresh")];
    assert_eq!(told, expected.map(|(object, name)| (object, name.to_owned())));
    assert!((found.tolerance - 0.0005).abs().max_element() < 2e-5);
}

#[test]
fn values_are_compared_by_what_they_mean() {
    let same = [
        (json!(1), json!(1.0)),
        (json!([1, {"a": 2.0}]), json!([1.0, {"a": 2}])),
        (json!({"a": 1, "b": [true, null]}), json!({"b": [true, null], "a": 1})),
        (json!(9_007_199_254_740_992_i64), json!(9_007_199_254_740_992.0)),
    ];
    let other = [
        (json!(1), json!("1")),
        (json!(1), json!(1.000_000_1)),
        (json!(9_007_199_254_740_993_i64), json!(9_007_199_254_740_992.0)),
        (json!([1, 2]), json!([2, 1])),
        (json!({"a": 1}), json!({"a": 1, "b": 1})),
        (json!(true), json!(1)),
        (json!("a"), json!("A")),
        (json!([]), json!({})),
    ];
    let state = |(old, new): &(Json, Json)| {
        let [old, new] = [old, new].map(|value| city(&[Made::bare("a").with("x", value.clone())]));
        compared(&old, &new).after[0].own
    };
    same.iter().for_each(|pair| assert_eq!(state(pair), State::Unchanged, "{pair:?}"));
    other.iter().for_each(|pair| assert_eq!(state(pair), changed(false, true), "{pair:?}"));
    // Objects with many attributes, in other orders, with repeated names.
    let names: Vec<&'static str> = (0..300).map(|i| &*format!("n{i}").leak()).collect();
    let many = |names: &[&'static str]| {
        names.iter().fold(Made::bare("a"), |made, name| made.with(name, json!(name.len()))).with("n7", json!("again"))
    };
    let reversed: Vec<_> = names.iter().rev().copied().collect();
    assert_eq!(compared(&city(&[many(&names)]), &city(&[many(&reversed)])).objects.unchanged, 1);
    let found = compared(&city(&[many(&names[..200])]), &city(&[many(&reversed)]));
    assert_eq!((found.attributes.len(), found.objects.changed), (100, 1));
}

#[test]
fn a_type_is_an_attribute_that_all_have() {
    let found = compared(&city(&[Made::at("a", [0; 3])]), &city(&[Made::at("a", [0; 3]).kind("Bridge")]));
    assert_eq!((found.after[0].own, found.types_changed), (changed(false, true), 1));
    assert!(found.attributes.is_empty());
}

#[test]
fn faces_are_the_same_however_they_are_cut() {
    let whole = Made::at("a", [0; 3]);
    let with = |faces: &[&[&[u32]]]| Made {
        faces: faces.iter().map(|face| face.iter().map(|ring| ring.to_vec()).collect()).collect(),
        ..whole.clone()
    };
    // The top as two triangles, along either diagonal.
    let mut cut = whole.clone();
    cut.faces[1] = vec![vec![4, 5, 7]];
    cut.faces.push(vec![vec![4, 7, 6]]);
    let mut other = whole.clone();
    other.faces[1] = vec![vec![4, 5, 6]];
    other.faces.push(vec![vec![5, 7, 6]]);
    assert!(!differ(&whole, &cut) && !differ(&whole, &other) && !differ(&cut, &other));
    // All faces at once, whose diagonals meet those of others.
    let triangles = |ring: &Vec<u32>, first: usize| {
        let at = |k: usize| ring[(first + k) % 4];
        [vec![vec![at(0), at(1), at(2)]], vec![vec![at(0), at(2), at(3)]]]
    };
    let all =
        |first| Made { faces: whole.faces.iter().flat_map(|f| triangles(&f[0], first)).collect(), ..whole.clone() };
    assert!(!differ(&all(0), &all(1)) && !differ(&whole, &all(1)));
    // Without a face, with one turned over, with one that is bent the other way.
    assert!(differ(
        &whole,
        &with(&[&[&[0, 2, 3, 1]], &[&[4, 5, 7, 6]], &[&[0, 1, 5, 4]], &[&[2, 6, 7, 3]], &[&[0, 4, 6, 2]]])
    ));
    let mut turned = whole.clone();
    turned.faces[1][0].reverse();
    assert!(differ(&whole, &turned));
    turned.faces.iter_mut().skip(2).for_each(|face| face[0].reverse());
    turned.faces[0][0].reverse();
    assert!(differ(&whole, &turned), "all of it inside out");
    let lift = |made: &Made, by: i64| {
        let mut made = made.clone();
        made.points[7][2] += by;
        made
    };
    assert!(!differ(&lift(&cut, 2), &lift(&other, 2)), "bent by two millimetres it is flat");
    assert!(differ(&lift(&cut, 50), &lift(&other, 50)), "bent by five centimetres it is a ridge or a valley");
    assert!(differ(&cut, &lift(&cut, 1)), "a corner one step away");
}

#[test]
fn holes_and_corners_on_edges_count() {
    let points = vec![
        [0, 0, 0],
        [9_000, 0, 0],
        [9_000, 9_000, 0],
        [0, 9_000, 0],
        [3_000, 3_000, 0],
        [3_000, 6_000, 0],
        [6_000, 6_000, 0],
        [6_000, 3_000, 0],
        [4_500, 0, 0],
    ];
    let face = |rings: &[&[u32]]| Made {
        points: points.clone(),
        faces: vec![rings.iter().map(|ring| ring.to_vec()).collect()],
        ..Made::bare("a")
    };
    let hole = face(&[&[0, 1, 2, 3], &[4, 5, 6, 7]]);
    assert!(!differ(&hole, &face(&[&[2, 3, 0, 1], &[6, 7, 4, 5]])));
    assert!(differ(&hole, &face(&[&[0, 1, 2, 3]])));
    // Hole filled by a face of its own: the border is that of the whole, the corners are not.
    let mut filled = hole.clone();
    filled.faces.push(vec![vec![4, 7, 6, 5]]);
    assert!(differ(&hole, &filled) && differ(&face(&[&[0, 1, 2, 3]]), &filled));
    // In four pieces around the hole.
    let pieces = Made {
        faces: [[0, 1, 7, 4], [1, 2, 6, 7], [2, 3, 5, 6], [3, 0, 4, 5]].map(|r| vec![r.to_vec()]).to_vec(),
        ..hole.clone()
    };
    assert!(!differ(&hole, &pieces));
    assert!(differ(&face(&[&[0, 1, 2, 3]]), &face(&[&[0, 8, 1, 2, 3]])), "a corner on a straight edge");
}

#[test]
fn grids_may_differ() {
    let at = |step: f64| Lattice { step: DVec3::splat(step), origin: DVec3::new(85_000.0, 447_000.0, 0.0) };
    let fine = [Made::at("a", [3, 7, 4]), Made::at("b", [20_006, 0, 1])];
    let scaled = |objects: &[Made], by: f64| -> Vec<Made> {
        let scale = |p: [i64; 3]| p.map(|c| (c as f64 * by).round() as i64);
        objects.iter().map(|o| Made { points: o.points.iter().map(|p| scale(*p)).collect(), ..o.clone() }).collect()
    };
    let rounded = scaled(&fine, 0.1);
    let [a, b] = [city_on(at(0.001), &fine), city_on(at(0.01), &rounded)];
    assert_eq!([compared(&a, &b).objects.unchanged, compared(&b, &a).objects.unchanged], [2, 2]);
    let mut moved = rounded.clone();
    moved[1].points[3][0] += 1;
    let c = city_on(at(0.01), &moved);
    assert_eq!([compared(&b, &c).objects.changed, compared(&a, &c).objects.changed], [1, 1]);
    // Other steps along each axis.
    let odd = Lattice { step: DVec3::new(0.01, 0.01, 0.001), ..LATTICE };
    let [d, mut lifted] = [rounded.clone(), rounded];
    lifted[0].points.iter_mut().for_each(|p| p[2] += 1);
    assert_eq!(compared(&city_on(odd, &d), &city_on(odd, &lifted)).objects.changed, 1);
    // Numbers that are no grid.
    let float = |objects: &[Made]| city_on(Lattice::FINE, &scaled(objects, 1_048.576));
    assert_eq!(compared(&city_on(at(0.001), &fine), &float(&fine)).objects.changed, 2, "elsewhere");
    let near = Lattice { origin: DVec3::ZERO, ..at(0.001) };
    assert_eq!(compared(&city_on(near, &fine), &float(&fine)).objects.unchanged, 2);
    assert_eq!(
        compared(
            &city_on(Lattice { step: DVec3::splat(1e-4), ..LATTICE }, &fine),
            &city_on(Lattice { step: DVec3::splat(1e-4), ..LATTICE }, &scaled(&fine, 1.0))
        )
        .objects
        .unchanged,
        2
    );
}

#[test]
fn levels_of_detail_count() {
    let of = |lod| Made { lod: Some(lod), ..Made::at("a", [0; 3]) };
    assert!(differ(&of("1.2"), &of("2.2")));
    assert!(!differ(&of("none"), &of("2.2")) && !differ(&of("1.2"), &of("none")), "a format without them");
    // What is written in whole metres is not known to half a metre.
    let metres = |step: f64, x: i64| {
        let points = Made::at("a", [0; 3]).points.iter().map(|p| p.map(|c| c / 1000 * (1.0 / step) as i64)).collect();
        let mut made = Made { points, ..of("none") };
        made.points[7][0] += x;
        city_on(Lattice { step: DVec3::splat(step), origin: DVec3::ZERO }, &[made])
    };
    let states = [metres(0.1, 0), metres(0.1, 3)].map(|new| compared(&metres(1.0, 0), &new).objects);
    assert_eq!(states.map(|counts| [counts.unchanged, counts.changed]), [[1, 0], [0, 1]]);
    assert!(differ(&Made::bare("a"), &of("2")) && !differ(&Made::bare("a"), &Made::bare("a")));
}

#[test]
fn wholes_change_with_their_parts() {
    let whole = |id: &str| Made::bare(id);
    let part = |id: &str, of: &str, x: i64| Made::at(id, [x, 0, 0]).of(of);
    let before = city(&[
        whole("a"),
        part("a1", "a", 0),
        Made::bare("a2").of("a1"),
        whole("b"),
        part("b1", "b", 20_000),
        whole("c"),
        part("c1", "c", 40_000),
        whole("d"),
        part("d1", "d", 60_000),
        whole("e"),
        part("x", "e", 80_000),
        whole("f"),
    ]);
    let after = city(&[
        whole("a"),
        part("a1", "a", 0),
        Made::bare("a2").of("a1").with("use", json!("shop")),
        whole("b"),
        part("b1", "b", 20_001),
        whole("c"),
        part("c1", "c", 40_000),
        part("c2", "c", 50_000),
        whole("d"),
        part("d1", "d", 60_000),
        whole("e"),
        whole("f"),
        part("x", "f", 80_000),
    ]);
    let found = compared(&before, &after);
    let states = |ids: &[&str]| -> Vec<(State, State)> {
        ids.iter()
            .map(|id| found.after[after.find_object(id).expect("an object") as usize])
            .map(|c| (c.own, c.state))
            .collect()
    };
    let u = State::Unchanged;
    assert_eq!(states(&["a", "a1"]), [(u, changed(false, true)); 2]);
    assert_eq!(states(&["b", "c", "e", "f"]), [(u, changed(true, false)); 4], "moved, came, left, arrived");
    assert_eq!(states(&["d", "x"]), [(u, u); 2]);
    assert_eq!((found.objects.changed, found.objects.added, found.objects.unchanged), (2, 1, 10));
    assert_eq!((found.roots.changed, found.roots.unchanged, found.roots.changed_geometry), (5, 1, 4));
    let back = compared(&after, &before);
    assert_eq!((back.roots.changed, back.objects.removed), (5, 1));
}

#[test]
fn versions_name_each_other() {
    let house = |id: &str, x: i64| Made::at(id, [x, 0, 0]);
    let before = city(&[
        house("a.1", 0).with("successor", json!("a.2")),
        house("b.1", 20_000),
        house("c.1", 40_000),
        house("d", 60_000).with("successor", json!("a.2")),
        house("e.1", 80_000),
        Made::at("e.1-p", [80_000, 0, 0]).of("e.1"),
    ]);
    let after = city(&[
        house("a.2", 0),
        house("b.2", 20_001).with("predecessors", json!(["b.1", "nobody", 3])),
        house("c.3", 40_000).with("predecessor", json!("c.2")),
        house("d", 60_000),
        house("e.2", 80_000).with("predecessor", json!("e.1")),
        Made::at("e.2-p", [80_000, 0, 0]).of("e.2"),
    ]);
    let found = compared(&before, &after);
    let ways: Vec<_> = found.after.iter().map(|compared| (compared.counterpart, compared.by)).collect();
    use MatchedBy::{Id, Part, Version};
    let way = |to, by| (Some(to), Some(by));
    assert_eq!(ways, [way(0, Version), way(1, Version), (None, None), way(3, Id), way(4, Version), way(5, Part)]);
    assert_eq!(found.after[1].own, changed(true, true));
    let back = compared(&after, &before);
    assert_eq!(back.before.iter().map(|c| (c.counterpart, c.by)).collect::<Vec<_>>(), ways);
    // Of two that became one the first by its id is its earlier version.
    let two = city(&[house("z", 0), house("y", 20_000)]);
    let one = city(&[house("x", 0).with("predecessors", json!(["z", "y"]))]);
    assert_eq!(compared(&two, &one).after[0].counterpart, Some(1));
}

#[test]
fn keys_match_what_ids_do_not() {
    let house = |id: &str, x: i64, key: Json| Made::at(id, [x, 0, 0]).with("pand", key);
    let before = city(&[
        house("a", 0, json!("007")),
        house("b", 20_000, json!(8)),
        house("c", 40_000, json!("twice")),
        house("d", 60_000, json!("twice")),
        house("e", 80_000, json!(null)),
        house("f", 90_000, json!("6")),
        Made::at("a-1", [0, 0, 0]).of("a"),
        Made::at("a-2", [5_000, 0, 0]).of("a"),
    ]);
    let after = city(&[
        house("u1", 0, json!("007")),
        house("u2", 20_000, json!("8")),
        house("c", 40_000, json!("twice")),
        house("u3", 60_000, json!("twice")),
        house("e", 80_000, json!("9")),
        house("f", 90_000, json!("5")),
        Made::at("u1-1", [0, 0, 0]).of("u1"),
        Made::at("u1-2", [5_000, 0, 0]).of("u1"),
    ]);
    let found = by("pand", &before, &after);
    use MatchedBy::{Id, Key, Part};
    let ways: Vec<_> = found.after.iter().map(|compared| (compared.counterpart, compared.by)).collect();
    let way = |to, by| (Some(to), Some(by));
    let none = (None, None);
    assert_eq!(ways[..4], [way(0, Key), way(1, Key), way(2, Id), none], "what repeats: by id or not at all");
    assert_eq!(ways[4..], [way(4, Id), none, way(6, Part), way(7, Part)], "ids only where no keys say otherwise");
    assert_eq!(found.repeated_keys, [RepeatedKey { value: "twice".into(), before: 2, after: 2 }]);
    assert_eq!(found.after[1].own, changed(false, true), "8 and \"8\" are one key and two values");
    let missing = Comparison::new(&before, &after, &super::Key::Attribute("identificatie".into()));
    assert_eq!(missing, Err(CompareError::NoKey { attribute: "identificatie".into(), side: Side::Before }));
}

#[test]
fn other_places_are_no_states_of_one_city() {
    let of = |crs: Option<&str>, raw: Option<&str>| CityModel {
        crs: crs.map(str::to_owned),
        crs_raw: raw.map(str::to_owned),
        ..city(&[])
    };
    let error = |a: &CityModel, b: &CityModel| Comparison::new(a, b, &Key::Id).err();
    let [here, there, nowhere] = [of(Some("EPSG:7415"), None), of(Some("EPSG:28992"), None), of(None, None)];
    let named = CompareError::References { before: "EPSG:7415".into(), after: "EPSG:28992".into() };
    assert_eq!(error(&here, &there), Some(named));
    assert_eq!([error(&here, &nowhere), error(&nowhere, &there), error(&here, &here)], [None, None, None]);
    assert!(error(&of(None, Some("local A")), &of(None, Some("local B"))).is_some());
    let zone = |number| CityModel {
        frames: Frames { zone: Some(UtmZone { number, is_south: false }), local: None },
        ..city(&[])
    };
    assert_eq!(error(&zone(31), &zone(32)), Some(CompareError::Frames));
    assert_eq!(error(&zone(31), &zone(31)), None);
}

#[test]
fn degrees_are_compared_in_one_frame() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/citydata/crs-degrees.city.json");
    let in_frames = |frames: Frames| {
        let options = LoadOptions { frames, ..LoadOptions::default() };
        load(&[file.into()], &options, &Quiet).expect("a city")
    };
    let own = in_frames(Frames::default());
    let zone = own.frames.zone.expect("a zone");
    let other = in_frames(Frames { zone: Some(UtmZone { number: zone.number + 1, ..zone }), local: None });
    assert_eq!(Comparison::new(&own, &other, &Key::Id), Err(CompareError::Frames));
    let again = in_frames(other.frames);
    assert_eq!(compared(&other, &again).objects.unchanged, again.objects.len() as u64);
    assert!(again.geometries.iter().zip(&own.geometries).any(|(a, b)| a.bounds != b.bounds));
}

#[test]
fn a_corner_of_terrain_is_found() {
    let [old, mut new] = [terrain(60), terrain(60)];
    assert_eq!(compared(&old, &new).objects.unchanged, 1);
    let at = new.vertices.len() / 2;
    new.vertices[at].position[2] += 0.001;
    assert_eq!(compared(&old, &new).objects.changed_geometry, 1);
}

/// Up to six boxes, some of them parts, with attributes.
fn some_city() -> impl Strategy<Value = Vec<Made>> {
    let one = (0..40_i64, 0..40_i64, 0..3_i64, proptest::option::of(0..4_i64), any::<bool>());
    prop::collection::vec(one, 1..7).prop_map(|all| {
        let made = |(number, (x, y, z, year, is_part)): (usize, (i64, i64, i64, Option<i64>, bool))| {
            let made = Made::at(&format!("o{number}"), [x * 3_001, y * 2_999, z * 1_003]);
            let made = if is_part && number > 0 { made.of(&format!("o{}", number / 2)) } else { made };
            year.into_iter().fold(made, |made, year| made.with("year", json!(year)))
        };
        all.into_iter().enumerate().map(made).collect()
    })
}

/// The same city in other words: corners, faces, rings and objects in other orders.
fn shuffled(objects: &[Made], seed: u64) -> Vec<Made> {
    let mut state = seed | 1;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let mut order = |count: usize| -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        (1..count).rev().for_each(|i| order.swap(i, next(i + 1)));
        order
    };
    let mut made = Vec::new();
    for object in order(objects.len()).into_iter().map(|i| &objects[i]) {
        let corners = order(object.points.len());
        let mut points = object.points.clone();
        corners.iter().zip(&object.points).for_each(|(to, point)| points[*to] = *point);
        let faces = order(object.faces.len()).into_iter().map(|face| {
            let ring = |ring: &Vec<u32>| {
                let mut ring: Vec<u32> = ring.iter().map(|corner| corners[*corner as usize] as u32).collect();
                let first = order(ring.len()).first().copied().unwrap_or_default();
                ring.rotate_left(first);
                ring
            };
            object.faces[face].iter().map(ring).collect()
        });
        let faces = faces.collect();
        let attributes = order(object.attributes.len()).into_iter().map(|i| object.attributes[i].clone()).collect();
        made.push(Made { points, faces, attributes, ..object.clone() });
    }
    made
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn a_city_is_itself_in_whatever_words(objects in some_city(), seed in any::<u64>()) {
        let before = city(&objects);
        for after in [city(&objects), city(&shuffled(&objects, seed))] {
            let found = compared(&before, &after);
            prop_assert!(found.before.iter().chain(&found.after).all(|c| (c.own, c.state) == (State::Unchanged, State::Unchanged)));
            prop_assert_eq!(found.objects.unchanged, objects.len() as u64);
        }
    }

    #[test]
    fn there_and_back_is_mirrored(old in some_city(), new in some_city()) {
        let (old, new) = (city(&old), city(&new));
        let (there, back) = (compared(&old, &new), compared(&new, &old));
        let mirrored = |state: State| match state {
            State::Added => State::Removed,
            State::Removed => State::Added,
            same => same,
        };
        let of = |side: &[Compared]| side.iter().map(|c| Compared { own: mirrored(c.own), state: mirrored(c.state), ..*c }).collect::<Vec<_>>();
        prop_assert_eq!(of(&there.before), back.after);
        prop_assert_eq!(of(&there.after), back.before);
        prop_assert_eq!((there.objects.added, there.roots.removed), (back.objects.removed, back.roots.added));
    }

    #[test]
    fn one_step_of_one_corner_is_one_change(objects in some_city(), seed in any::<u64>(), which in any::<prop::sample::Index>(), corner in 0..8_usize, axis in 0..3_usize, is_up in any::<bool>()) {
        let before = city(&objects);
        let mut moved = objects.clone();
        let object = which.index(objects.len());
        moved[object].points[corner][axis] += if is_up { 1 } else { -1 };
        let id = objects[object].id.clone();
        let after = city(&shuffled(&moved, seed));
        let found = compared(&before, &after);
        let changes: Vec<&str> = after.objects.iter().zip(&found.after).filter(|(_, c)| c.own != State::Unchanged).map(|(o, _)| &*o.id).collect();
        prop_assert_eq!(changes, [&*id]);
        prop_assert_eq!(found.objects.changed_geometry, 1);
        let own_root = after.root(after.find_object(&id).expect("it is there"));
        let roots: Vec<u32> = (0..after.objects.len() as u32).filter(|o| after.objects[*o as usize].parents.is_empty() && found.after[*o as usize].state != State::Unchanged).collect();
        prop_assert_eq!(roots, [own_root]);
    }
}
