//! The results that the hand-made files of `citydata/` must have; numbers known by thought.

use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::{
    city::{
        load::{load, options::LoadOptions, progress::Quiet},
        model::{CityModel, Material, NONE, ObjectClass, Surface, TextureImage, Value, Wrap},
    },
    geom::Aabb,
};

fn city(name: &str) -> CityModel {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("citydata").join(name);
    load(&[path], &LoadOptions::default(), &Quiet).unwrap_or_else(|error| panic!("{error}"))
}

fn object(model: &CityModel, id: &str) -> u32 {
    model.find_object(id).unwrap_or_else(|| panic!("no object {id}"))
}

/// Triangles of an object: corners and surface.
fn triangles(model: &CityModel, id: &str) -> Vec<([DVec3; 3], Surface)> {
    let object = object(model, id);
    let tiles = model.tiles.iter().filter(|t| model.geometries[t.geometry as usize].object == object);
    tiles
        .flat_map(|tile| {
            let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
            indices.chunks(3).map(move |t| {
                let vertex = |i: u32| tile.vertices.start + i;
                let surface = model.vertices[vertex(t[0]) as usize].surface;
                ([t[0], t[1], t[2]].map(|i| model.position(tile, vertex(i))), model.surfaces[surface as usize])
            })
        })
        .collect()
}

fn bounds(model: &CityModel, id: &str) -> Aabb {
    Aabb::from_points(triangles(model, id).into_iter().flat_map(|(corners, _)| corners))
}

fn volume(model: &CityModel, id: &str) -> f64 {
    let origin = bounds(model, id).min;
    triangles(model, id).iter().map(|([a, b, c], _)| (a - origin).dot((b - origin).cross(c - origin)) / 6.0).sum()
}

fn area_vector(corners: &[DVec3; 3]) -> DVec3 {
    0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0])
}

/// The material of the faces whose normal points along `normal`, if they have one.
fn material(model: &CityModel, id: &str, normal: DVec3) -> Option<Material> {
    let faces = triangles(model, id);
    let face = faces.iter().find(|(corners, _)| area_vector(corners).normalize_or_zero().dot(normal) > 0.99).unwrap();
    model.materials.get(face.1.material as usize).cloned()
}

fn attribute(model: &CityModel, id: &str, name: &str) -> Option<Value> {
    let name = model.strings.find(name)?;
    model.attributes_of(object(model, id)).iter().find(|a| a.name == name).map(|a| a.value)
}

fn assert_near(found: DVec3, wanted: [f64; 3], tolerance: f64) {
    assert!((found - DVec3::from(wanted)).abs().max_element() <= tolerance, "{found} is not {wanted:?}");
}

/// No handedness slips: each of the six triangles lies on its half-axis, faces outwards and has its colour.
#[test]
fn axes_point_where_they_say() {
    let model = city("axes.city.json");
    for (id, axis) in [
        ("plus-x", DVec3::X),
        ("minus-x", -DVec3::X),
        ("plus-y", DVec3::Y),
        ("minus-y", -DVec3::Y),
        ("plus-z", DVec3::Z),
        ("minus-z", -DVec3::Z),
    ] {
        let [(corners, _)] = triangles(&model, id)[..] else { panic!("{id} is one triangle") };
        assert_eq!(area_vector(&corners), 12.0 * axis, "{id}");
        assert!(corners.iter().all(|c| c.dot(axis) == 10.0), "{id}");
        let color = material(&model, id, axis).unwrap().base_color;
        let lit = [0, 1, 2].map(|i| color[i] > 0.0);
        assert_eq!(lit, [axis.x != 0.0, axis.y != 0.0, axis.z != 0.0], "{id}");
    }
}

#[test]
fn solids_enclose_their_volume() {
    for (file, id, wanted) in [
        ("cube.city.json", "cube", 1000.0),
        ("inner-shell.city.json", "vault", 1000.0 - 64.0),
        ("multisolid.city.json", "twins", 128.0),
        ("compositesolid.city.json", "pair", 64.0 + 96.0),
        ("courtyard.city.json", "cloister", (900.0 - 100.0) * 9.0),
        ("v10-no-transform.city.json", "shed", 2.875 * 4.25 * 2.5),
        ("packed.city.json.gz", "packed", 64.0),
        ("bom.city.json", "marked", 64.0),
        ("far.city.json", "far", 64.0),
    ] {
        let found = volume(&city(file), id);
        assert!((found - wanted).abs() < 1e-4 * wanted, "{file}: {found} is not {wanted}");
    }
}

#[test]
fn templates_are_placed_scaled_and_mirrored_right_side_out() {
    let model = city("templates.city.json");
    // The octahedron: base 2, two heights of 2: 8/3 m³, around (0, 0, 2).
    for (id, min, max, scale) in [
        ("tree-0", [-1.0, 4.0, 1.0], [1.0, 6.0, 5.0], 1.0),
        ("tree-1", [8.0, 3.0, 1.0], [12.0, 7.0, 9.0], 8.0),
        ("tree-2", [19.5, 4.0, 1.0], [21.5, 6.0, 7.0], 1.5),
    ] {
        let found = bounds(&model, id);
        assert_near(found.min, min, 1e-6);
        assert_near(found.max, max, 1e-6);
        assert!((volume(&model, id) - scale * 8.0 / 3.0).abs() < 1e-5, "{id}: {}", volume(&model, id));
    }
    assert_eq!(model.objects[0].class, ObjectClass::Vegetation);
}

#[test]
fn materials_follow_the_default_theme() {
    let model = city("materials.city.json");
    assert_eq!(material(&model, "themes", DVec3::Z).unwrap().name, "tiles");
    assert_eq!(material(&model, "themes", DVec3::X).unwrap().name, "plaster");
    assert_eq!(material(&model, "themes", -DVec3::Z), None, "null is no material");
    assert_eq!(material(&model, "plain", -DVec3::Z).unwrap().name, "plaster");
    assert_eq!(material(&model, "none", DVec3::Z), None);
    assert!(material(&model, "themes", DVec3::Z).unwrap().roughness < 0.9, "tiles shine");
}

#[test]
fn templates_have_what_their_own_document_declares() {
    let model = city("templates-sequence.city.jsonl");
    for (id, wanted) in [("dressed", "brick"), ("fir", "leaves"), ("yew", "leaves")] {
        assert_eq!(material(&model, id, -DVec3::Y).unwrap().name, wanted, "{id}");
    }
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
}

#[test]
fn textures_stand_upright() {
    let model = city("textures.city.json");
    assert!(
        model.textures.iter().all(|t| matches!(&t.image, TextureImage::File(path) if path.ends_with("corners.png")))
    );
    let wraps: Vec<Wrap> = model.textures.iter().map(|t| t.wrap[0]).collect();
    assert_eq!(wraps, [Wrap::Clamp, Wrap::Repeat, Wrap::Mirror, Wrap::Clamp]);
    let tile = model.tiles.iter().find(|t| model.geometries[t.geometry as usize].object == 0).unwrap();
    for vertex in tile.vertices.clone() {
        let at = model.position(tile, vertex);
        let [u, v] = model.texcoords[(tile.texcoords + vertex - tile.vertices.start) as usize];
        // The panel is 4 m wide and high; row 0 of the image is at its top.
        assert_eq!([f64::from(u), f64::from(v)], [at.x / 4.0, 1.0 - at.z / 4.0]);
    }
    let (_, bare) = triangles(&model, "bare")[0];
    assert_eq!(bare.material, NONE);
}

#[test]
fn textures_that_cannot_be_had_are_declared_all_the_same() {
    let model = city("texture-missing.city.json");
    assert_eq!(model.textures.len(), 2);
    assert!(model.textures.iter().all(|t| t.image.is_missing()));
}

#[test]
fn semantic_surfaces_keep_their_attributes_and_parents() {
    let model = city("semantics.city.json");
    let kind = |s: &Surface| model.strings.get(s.kind).to_owned();
    let faces = triangles(&model, "house");
    let find = |name: &str| faces.iter().map(|(_, s)| *s).find(|s| kind(s) == name).unwrap();
    let detail = |s: Surface| &model.details[s.detail as usize];
    let value = |s: Surface, name: &str| {
        let range = detail(s).attributes.clone();
        let own = &model.attributes[range.start as usize..range.end as usize];
        own.iter().find(|a| model.strings.get(a.name) == name).map(|a| a.value)
    };
    assert_eq!(find("GroundSurface").detail, NONE);
    assert_eq!(value(find("RoofSurface"), "solar"), Some(Value::Boolean(true)));
    assert_eq!(value(find("RoofSurface"), "slope"), Some(Value::Number(0.0)));
    assert!(matches!(value(find("Window"), "glazing"), Some(Value::String(s)) if model.strings.get(s) == "double"));
    assert_eq!(detail(find("Window")).parent, find("WallSurface").detail);
    assert_eq!(detail(find("WallSurface")).parent, NONE);
    let window: DVec3 = faces.iter().filter(|(_, s)| kind(s) == "Window").map(|(c, _)| area_vector(c)).sum();
    assert_near(window, [0.0, -4.0, 0.0], 1e-9);
}

#[test]
fn attributes_keep_their_types() {
    let model = city("attributes.city.json");
    let get = |name: &str| attribute(&model, "attributes", name).unwrap_or_else(|| panic!("no attribute {name}"));
    let text = |name: &str| match get(name) {
        Value::String(s) | Value::Array(s) | Value::Object(s) => model.strings.get(s).to_owned(),
        other => panic!("{name} is {other:?}"),
    };
    assert_eq!(get("yearOfConstruction"), Value::Integer(1888));
    assert_eq!(get("height"), Value::Number(4.0));
    assert_eq!(get("listed"), Value::Boolean(true));
    assert_eq!(get("renovated"), Value::Null);
    assert_eq!(get("huge"), Value::Number(3.4e38));
    assert_eq!(text("beyond"), "123456789012345678901234567891");
    assert_eq!(text("creationDate"), "2016-09-29");
    assert_eq!(text("owners"), r#"["A","B"]"#);
    assert_eq!(text("address"), r#"{"street":"Lijnmarkt","number":12}"#);
    assert_eq!(text("name"), "Łódź 🏙");
    assert_eq!(attribute(&model, "other", "height"), None);
}

#[test]
fn extensions_lose_nothing() {
    let model = city("extension.city.json");
    let kept = |place: &str| model.unknown.iter().find(|(p, _)| p == place).map(|(_, text)| text.as_str());
    assert_eq!(kept("+noise-survey"), Some(r#"{"year":2021,"levels":[55,60]}"#));
    assert_eq!(kept("CityObjects/barrier/+noise-source"), Some(r#"{"road":"A13"}"#));
    assert_eq!(kept("CityObjects/house/address"), Some(r#"[{"Country":"NL"}]"#));
    assert!(kept("extensions").is_some());
    assert_eq!(attribute(&model, "house", "+noise-inside"), Some(Value::Integer(31)));
    let barrier = &model.objects[object(&model, "barrier") as usize];
    assert_eq!(model.strings.get(barrier.kind), "+NoiseBarrier");
    assert_eq!(barrier.class, ObjectClass::Other);
}

#[test]
fn national_coordinates_keep_every_digit() {
    let model = city("far.city.json");
    let found = bounds(&model, "far");
    assert_eq!(found.min, DVec3::new(2_600_000.125, 60_000_000.25, 4000.0));
    assert_eq!(found.max, DVec3::new(2_600_004.125, 60_000_004.25, 4004.0));
    assert_eq!(city("crs-utm.city.json").crs.as_deref(), Some("EPSG:25832+5783"));
    assert_eq!(city("crs-unknown.city.json").crs, None);
}

/// 20 m by 10 m on a sphere of 111 km per degree; the ellipsoid makes them at most 1.1 % longer.
#[test]
fn degrees_become_metres_with_north_up() {
    let model = city("crs-degrees.city.json");
    let size = bounds(&model, "tokyo").size();
    assert!((20.0..20.3).contains(&size.x) && (9.95..10.3).contains(&size.y), "{size}");
    assert!((size.z - 12.0).abs() < 1e-5);
    assert!(volume(&model, "tokyo") > 0.0, "swapped axes would turn it inside out");
    assert_eq!(model.crs.as_deref(), Some("EPSG:6697"));
}

#[test]
fn points_and_lines_count_for_the_extent_only() {
    let model = city("points-and-lines.city.json");
    assert_eq!(model.extent_as_read.max, DVec3::new(20.0, 5.0, 3.0));
    assert_eq!(bounds(&model, "kiosk").max, DVec3::new(2.0, 2.0, 3.0));
}

#[test]
fn features_have_vertices_of_their_own() {
    let model = city("sequence.city.jsonl");
    let ids: Vec<&str> = model.objects.iter().map(|o| &*o.id).collect();
    assert_eq!(ids, ["b0", "b0-0", "b1", "b1-0", "b2", "b2-0"]);
    for k in 0..3_u32 {
        let found = bounds(&model, &format!("b{k}-0"));
        let x = 85_000.0 + 10.0 * f64::from(k);
        assert_near(found.min, [x, 447_000.0, 0.0], 1e-6);
        assert_near(found.max, [x + 8.0, 447_008.0, 3.0 * f64::from(k + 1)], 1e-6);
        assert_eq!(model.objects[2 * k as usize + 1].parents, [2 * k]);
    }
    let damaged = city("sequence-bad-line.city.jsonl");
    assert_eq!(damaged.objects.len(), 4);
    let (_, warning) = damaged.warnings.iter().next().unwrap();
    assert!(warning.message.contains("line 3, column 101"), "{}", warning.message);
}

#[test]
fn several_files_are_one_city() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("citydata");
    let files: Vec<PathBuf> = ["crs-rd.city.json", "crs-utm.city.json"].map(|f| folder.join(f)).into();
    let model = load(&files, &LoadOptions::default(), &Quiet).unwrap();
    assert_eq!(model.objects.len(), 2);
    assert_eq!(model.sources.len(), 2);
    assert_eq!(model.crs.as_deref(), Some("EPSG:7415"));
    let codes: Vec<&str> = model.warnings.iter().map(|(code, _)| code.code()).collect();
    assert_eq!(codes, ["crs-mismatch"]);
}

#[test]
fn a_polygon_has_the_texture_that_all_its_rings_have_and_else_none() {
    let plate = |id: &str, hole: u32| {
        format!(
            r#""{id}": {{"type": "GenericCityObject", "geometry": [{{"type": "MultiSurface", "lod": "2",
               "boundaries": [[[0,1,2,3],[4,7,6,5]]], "texture": {{"t": {{"values": [[[0,0,1,2,3],[{hole},0,1,2,3]]]}}}}}}]}}"#
        )
    };
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [1,1,1], "translate": [0,0,0]}},
           "appearance": {{"default-theme-texture": "t", "vertices-texture": [[0,0],[1,0],[1,1],[0,1]],
             "textures": [{{"type": "PNG", "image": "a.png"}}, {{"type": "PNG", "image": "b.png"}}]}},
           "CityObjects": {{{}, {}}},
           "vertices": [[0,0,0],[9,0,0],[9,9,0],[0,9,0],[3,3,0],[6,3,0],[6,6,0],[3,6,0]]}}"#,
        plate("same", 0),
        plate("other", 1)
    );
    let path = std::env::temp_dir().join(format!("veduta-rings-{}.city.json", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let model =
        load(std::slice::from_ref(&path), &LoadOptions::default(), &Quiet).unwrap_or_else(|error| panic!("{error}"));
    std::fs::remove_file(path).unwrap();
    let texture = |id: &str| {
        let material = triangles(&model, id)[0].1.material;
        model.materials.get(material as usize).map_or(NONE, |own| own.texture)
    };
    assert_eq!((texture("same"), texture("other")), (0, NONE));
}
