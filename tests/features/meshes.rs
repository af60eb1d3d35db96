//! What the hand-made glTF and OBJ files of `citydata/` must become; the numbers are known by thought.

use std::path::PathBuf;

use glam::DVec3;
use veduta::{
    city::{
        CityModel, Material, NONE, TexelOpacity, TextureImage, Value, WarningCode, Wrap,
        load::{LoadOptions, Quiet, load},
        texture,
    },
    geom::Aabb,
};

fn city(name: &str) -> CityModel {
    let path = PathBuf::from("citydata").join(name);
    load(&[path], &LoadOptions::default(), &Quiet).unwrap_or_else(|e| panic!("{e}"))
}

fn ids(model: &CityModel) -> Vec<&str> {
    model.objects.iter().map(|o| &*o.id).collect()
}

fn object(model: &CityModel, id: &str) -> u32 {
    model.find_object(id).unwrap_or_else(|| panic!("no object {id}"))
}

fn bounds(model: &CityModel, id: &str) -> Aabb {
    let object = object(model, id);
    model.geometries.iter().filter(|g| g.object == object).fold(Aabb::EMPTY, |all, g| all.union(g.bounds))
}

/// World corners of the object's triangles.
fn triangles(model: &CityModel, id: &str) -> Vec<[DVec3; 3]> {
    let object = object(model, id);
    let tiles = model.tiles.iter().filter(|t| model.geometries[t.geometry as usize].object == object);
    tiles
        .flat_map(|tile| {
            let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
            indices.chunks(3).map(|t| [t[0], t[1], t[2]].map(|i| model.position(tile, tile.vertices.start + i)))
        })
        .collect()
}

/// Signed volume inside the object's triangles: positive only if they face outward.
fn volume(model: &CityModel, id: &str) -> f64 {
    let origin = bounds(model, id).min;
    let part = |[a, b, c]: [DVec3; 3]| (a - origin).dot((b - origin).cross(c - origin)) / 6.0;
    triangles(model, id).into_iter().map(part).sum()
}

/// The area vector of all triangles: its direction is the way they face.
fn area(model: &CityModel, id: &str) -> DVec3 {
    triangles(model, id).into_iter().map(|[a, b, c]| (b - a).cross(c - a) / 2.0).sum()
}

/// Materials of the object's surfaces, in order.
fn materials<'a>(model: &'a CityModel, id: &str) -> Vec<&'a Material> {
    let object = object(model, id);
    let own = model.surfaces.iter().filter(|s| s.object == object && s.material != NONE);
    own.map(|s| &model.materials[s.material as usize]).collect()
}

fn assert_box(found: Aabb, min: [f64; 3], max: [f64; 3]) {
    let near = |a: DVec3, b: [f64; 3]| (a - DVec3::from(b)).abs().max_element() < 2e-6;
    assert!(near(found.min, min) && near(found.max, max), "{found:?} is not {min:?} to {max:?}");
}

#[test]
fn gltf_nodes_nest_mirror_and_turn() {
    let model = city("nodes.gltf");
    assert_eq!(ids(&model), ["tower", "node-2", "spire", "mirrored", "tower#2"]);
    let parents: Vec<_> = model.objects.iter().map(|o| o.parents.clone()).collect();
    assert_eq!(parents, [vec![], vec![0], vec![0], vec![0], vec![]], "groups between mesh nodes are passed over");
    assert_eq!(model.objects[0].children, [1, 2, 3]);
    // y up, z south: (x, y, z) → (x, −z, y).
    assert_box(bounds(&model, "tower"), [10.0, 16.0, 0.0], [14.0, 20.0, 12.0]);
    assert_box(bounds(&model, "node-2"), [11.0, 17.0, 12.0], [13.0, 19.0, 15.0]);
    assert_box(bounds(&model, "spire"), [11.5, 17.5, 15.0], [12.5, 18.5, 27.0]);
    assert_box(bounds(&model, "mirrored"), [6.0, 16.0, 0.0], [10.0, 20.0, 6.0]);
    // A quarter turn about y takes +x to −z, which is north here.
    assert_box(bounds(&model, "tower#2"), [30.0, 20.0, 0.0], [31.0, 21.0, 1.0]);
    for (id, size) in [("tower", 192.0), ("node-2", 12.0), ("spire", 12.0), ("mirrored", 96.0), ("tower#2", 1.0)] {
        let found = volume(&model, id);
        assert!((found - size).abs() < 1e-3, "{id}: outward volume {found}, not {size}");
    }
    assert_eq!(model.warnings.count(WarningCode::DuplicateId), 1);
}

#[test]
fn gltf_meshes_are_shared_and_instanced() {
    let model = city("instancing.gltf");
    assert_eq!(ids(&model), ["left", "right", "row"]);
    assert_box(bounds(&model, "right"), [0.0, 4.0, 0.0], [1.0, 5.0, 1.0]);
    assert_box(bounds(&model, "row"), [0.0, 9.0, 0.0], [7.0, 10.0, 3.0]);
    assert!((volume(&model, "row") - 6.0).abs() < 1e-6, "three boxes, 1, 2 and 3 high");
}

#[test]
fn gltf_buffers_lie_beside_the_file() {
    assert_box(city("external.gltf").extent(), [0.0, -1.0, 0.0], [1.0, 0.0, 1.0]);
}

#[test]
fn gltf_modes_all_become_triangles_that_face_one_way() {
    let model = city("modes.glb");
    for (id, size, count) in [("strip", 2.0, 4), ("fan", 2.5, 3), ("soup", 1.0, 2), ("wide", 1.0, 2)] {
        assert_eq!(triangles(&model, id).len(), count, "{id}");
        // All were drawn counter-clockwise seen from +z of glTF, which is south.
        assert!((area(&model, id) - DVec3::new(0.0, -size, 0.0)).length() < 1e-9, "{id}: {}", area(&model, id));
    }
    assert_eq!(triangles(&model, "dots").len(), 0);
    assert_eq!(model.warnings.count(WarningCode::Unsupported), 2);
}

#[test]
fn gltf_extras_are_attributes() {
    let model = city("extras.gltf");
    let get = |id: &str, name: &str| {
        let name = model.strings.find(name).unwrap_or_else(|| panic!("no attribute {name}"));
        model.attributes_of(object(&model, id)).iter().find(|a| a.name == name).map(|a| a.value)
    };
    let text = |value| match value {
        Some(Value::String(s) | Value::Array(s) | Value::Object(s)) => model.strings.get(s).to_owned(),
        other => panic!("{other:?} is no text"),
    };
    assert_eq!(get("a", "storeys"), Some(Value::Integer(3)), "the node's word counts before the mesh's");
    assert_eq!(get("b", "storeys"), Some(Value::Integer(1)));
    assert_eq!(get("a", "height"), Some(Value::Number(9.5)));
    assert_eq!(get("a", "listed"), Some(Value::Boolean(true)));
    assert_eq!(get("a", "owner"), Some(Value::Null));
    assert_eq!(text(get("a", "tags")), r#"["x","y"]"#);
    assert_eq!(text(get("a", "address")), r#"{"street":"Main"}"#);
    assert_eq!(text(get("a", "function")), "home");
    assert_eq!(text(get("b", "extras")), "just a note");
}

#[test]
fn gltf_materials_keep_what_can_be_drawn() {
    let model = city("materials.gltf");
    let one = |id: &str| {
        let found = materials(&model, id);
        assert_eq!(found.len(), 1, "{id}");
        found[0].clone()
    };
    assert_eq!(one("plain"), Material::default());
    let unlit = one("unlit");
    assert!(unlit.unlit && unlit.roughness == 0.25);
    assert_eq!(unlit.base_color, [0.2, 0.4, 0.6, 1.0], "OPAQUE has no opacity");
    let mask = one("mask");
    let TexelOpacity::Holes(least) = mask.texels else { panic!("{:?}", mask.texels) };
    assert!((least - 0.5).abs() < 1e-6, "0.4 after a factor of 0.8 is 0.5 of the texel");
    assert_eq!((mask.base_color[3], mask.texture), (1.0, 0));
    assert_eq!(one("blend").base_color, [0.1, 0.2, 0.3, 0.5]);
    assert_eq!(one("lamp").emissive, [4.0, 2.0, 1.0]);
    let glossy = one("glossy");
    assert_eq!((glossy.base_color, glossy.roughness), ([0.5, 0.25, 0.125, 1.0], 0.25));
    assert_eq!(one("red").base_color, [1.0, 0.0, 0.0, 1.0]);
    // Red, green, blue: a mean of thirds. Red, blue, white: ⅔, ⅓, ⅔.
    let gradient = materials(&model, "gradient");
    for (found, wanted) in gradient.iter().zip([[1.0, 1.0, 1.0], [2.0, 1.0, 2.0]]) {
        assert!((0..3).all(|c| (found.base_color[c] - wanted[c] / 3.0).abs() < 1e-3), "{found:?}");
    }
    assert_eq!(gradient.len(), 2);
}

#[test]
fn gltf_textures_are_found_mapped_and_decoded() {
    for (name, wrap, far) in [
        ("textured.gltf", [Wrap::Clamp, Wrap::Mirror], [4.5, 2.0]),
        ("textured.glb", [Wrap::Repeat, Wrap::Repeat], [1.0, 1.0]),
    ] {
        let model = city(name);
        let texture = &model.textures[materials(&model, "wall")[0].texture as usize];
        assert_eq!(texture.wrap, wrap, "{name}");
        let pixels = texture::decode(texture).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((pixels.width, pixels.height, pixels.levels.len()), (4, 4, 3));
        assert_eq!(pixels.levels[0][..8], [220, 200, 180, 255, 178, 76, 51, 255]);
        // The corner at 8 east, 0 up shows the bottom right of the picture.
        let tile = &model.tiles[0];
        let corner = tile.vertices.clone().find(|v| {
            let at = model.position(tile, *v);
            at.x == 8.0 && at.z == 0.0
        });
        let at = tile.texcoords + corner.expect("a corner at 8 east, 0 up") - tile.vertices.start;
        assert_eq!(model.texcoords[at as usize], far, "{name}");
    }
}

#[test]
fn gltf_sparse_and_quantized_positions() {
    let model = city("sparse.gltf");
    assert_box(bounds(&model, "sparse"), [0.0, 0.0, 0.0], [2.0, 0.0, 2.0]);
    assert_box(bounds(&model, "quantized"), [7.0, 0.0, 0.0], [13.0, 0.0, 3.0]);
}

/// 2⁻¹⁰ m at 447 km: f32 has steps of 2⁻⁵ m there.
#[test]
fn gltf_keeps_national_coordinates() {
    let found = city("national.gltf").extent();
    assert_eq!(found.min, DVec3::new(85000.125 + 1.0 / 1024.0, 447_000.5 + 1.0 / 128.0 - 1.0, -1.5));
}

#[test]
fn gltf_that_is_damaged_shows_the_rest() {
    let model = city("damaged.glb");
    assert_eq!(triangles(&model, "good").len(), 2);
    for (code, count) in [
        (WarningCode::TruncatedFile, 1),
        (WarningCode::VertexIndex, 1),
        (WarningCode::BadCoordinate, 2),
        (WarningCode::BadGeometry, 2),
        (WarningCode::AppearanceIndex, 2),
        (WarningCode::CyclicParents, 2),
        (WarningCode::Malformed, 1),
    ] {
        assert_eq!(model.warnings.count(code), count, "{}", code.code());
    }
}

#[test]
fn obj_groups_are_objects() {
    let model = city("groups.obj");
    assert_eq!(ids(&model), ["group-0", "house one", "roof south", "last"]);
    let polygons: Vec<u32> = model.geometries.iter().map(|g| g.polygons).collect();
    assert_eq!(polygons, [2, 3, 1, 1]);
    assert_box(bounds(&model, "house one"), [0.0, 0.0, 0.0], [4.0, 4.0, 3.0]);
    assert_box(bounds(&model, "roof south"), [0.0, 0.0, 3.0], [4.0, 2.0, 5.0]);
    // The floor faces up, the wall in the nameless group north.
    assert_eq!(area(&model, "group-0"), DVec3::new(0.0, 12.0, 16.0));
    assert_eq!(area(&model, "last"), DVec3::new(-12.0, 0.0, 0.0));
}

#[test]
fn obj_materials_change_inside_a_group() {
    let model = city("textured.obj");
    let by_name = |name: &str| {
        let mut found: Vec<&Material> = materials(&model, "house").into_iter().filter(|m| m.name == name).collect();
        found.sort_by_key(|m| m.texture);
        found
    };
    let brick = by_name("brick");
    assert_eq!(brick.len(), 2, "with its texture, and without for the face that has no coordinates");
    let texture = &model.textures[brick[0].texture as usize];
    assert_eq!(brick[1].texture, NONE);
    assert_eq!(texture.wrap, [Wrap::Clamp; 2]);
    assert_eq!(texture.image, TextureImage::File("citydata/brick.png".into()));
    assert_eq!(texture::decode(texture).map(|p| p.width), Ok(4));
    let glass = by_name("glass")[0];
    assert_eq!(glass.base_color[3], 0.25);
    assert!((glass.base_color[0] - 0.214_041).abs() < 1e-5, "0.5 of sRGB is 0.214 of the light");
    assert!((glass.roughness - 0.02f32.sqrt()).abs() < 1e-6);
    assert_eq!(by_name("lamp")[0].emissive[1], 1.0);
    // The L of 6 × 2 and 3 × 3 faces south.
    let south = triangles(&model, "house").into_iter().filter(|t| t.iter().all(|p| p.y == 0.0));
    let area: DVec3 = south.map(|[a, b, c]| (b - a).cross(c - a) / 2.0).sum();
    assert_eq!(area, DVec3::new(0.0, -21.0, 0.0));
    // v up in the file, down here.
    let tile = model.tiles.iter().find(|t| t.texcoords != NONE).expect("a textured tile");
    let far = tile.vertices.clone().find(|v| model.position(tile, *v) == DVec3::new(6.0, 0.0, 2.0));
    let at = tile.texcoords + far.expect("the corner at 6 east, 2 up") - tile.vertices.start;
    assert_eq!(model.texcoords[at as usize], [2.0, 0.5]);
}

/// Three decimals are exact: the extent is that of the text, and the sloped roof is one plane.
#[test]
fn obj_keeps_national_coordinates() {
    let model = city("national.obj");
    let tenth_mm = |v: DVec3| (v * 1e4).round() / 1e4;
    assert_eq!(tenth_mm(model.extent().min), DVec3::new(85000.123, 447_000.457, -0.031));
    assert_eq!(tenth_mm(model.extent().max), DVec3::new(85010.223, 447_008.957, 2.519));
    assert_eq!(model.warnings.count(WarningCode::NonPlanar), 0);
    assert!(model.planes.iter().all(|p| *p == model.planes[0] && *p != 0), "all in one plane: {:?}", model.planes);
}

#[test]
fn obj_that_is_damaged_shows_the_rest() {
    let model = city("damaged.obj");
    assert_eq!(ids(&model), ["right"]);
    assert_eq!(triangles(&model, "right").len(), 2);
    for (code, count) in [
        (WarningCode::VertexIndex, 3),
        (WarningCode::BadCoordinate, 3),
        (WarningCode::ShortRing, 1),
        (WarningCode::AppearanceIndex, 2),
        (WarningCode::Malformed, 5),
    ] {
        assert_eq!(model.warnings.count(code), count, "{}", code.code());
    }
}

/// tobj reads the same positions and faces, where a file has nothing that stops it.
#[test]
fn obj_agrees_with_tobj() {
    for name in ["groups.obj", "textured.obj", "national.obj"] {
        let text = std::fs::read(format!("citydata/{name}")).unwrap();
        // It knows no continued lines, and takes a line of three points for a face.
        let text = String::from_utf8(text).unwrap().replace("\\\r\n", " ").replace("\nl ", "\n# ");
        let options = tobj::LoadOptions { ignore_lines: true, ignore_points: true, ..Default::default() };
        let (meshes, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
        let mut theirs = Aabb::EMPTY;
        let mut polygons = 0;
        for mesh in meshes.iter().map(|m| &m.mesh) {
            polygons += if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { mesh.face_arities.len() };
            for p in mesh.positions.chunks(3) {
                theirs = theirs.union(Aabb { min: DVec3::from_slice(p), max: DVec3::from_slice(p) });
            }
        }
        let model = city(name);
        let ours = model.extent();
        assert!((ours.min - theirs.min).abs().max_element() < 1e-6, "{name}: {ours:?}, tobj {theirs:?}");
        assert!((ours.max - theirs.max).abs().max_element() < 1e-6, "{name}: {ours:?}, tobj {theirs:?}");
        assert_eq!(model.geometries.iter().map(|g| g.polygons as usize).sum::<usize>(), polygons, "{name}");
    }
}
