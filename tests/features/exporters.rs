//! Files as exporters write them: what stands around the geometry does not make it wrong, or lost. Each was met in files of others.

use std::{
    io::{Cursor, Write as _},
    path::Path,
};

use crate::studio::Folder;
use glam::DVec3;
use veduta::{
    city::{
        CityModel, NONE, TextureImage, WarningCode, facts,
        load::{LFS_POINTER, LoadOptions, Quiet, Up, load},
    },
    geom::Aabb,
};

/// Writes a file and loads it.
fn load_text(folder: &Folder, name: &str, bytes: impl AsRef<[u8]>) -> CityModel {
    loaded(&folder.write(name, bytes))
}

fn loaded(path: &Path) -> CityModel {
    load(&[path.to_owned()], &LoadOptions::default(), &Quiet).unwrap_or_else(|error| panic!("{error}"))
}

/// What is wrong with a file that is not read.
fn refusal(path: &Path) -> String {
    load(&[path.to_owned()], &LoadOptions::default(), &Quiet).expect_err("it is refused").to_string()
}

fn warnings(model: &CityModel) -> Vec<String> {
    model
        .warnings
        .iter()
        .map(|(code, warning)| format!("{} × {}: {}", warning.count, code.code(), warning.message))
        .collect()
}

/// The material names and textures of a model's surfaces, in their order.
fn textured(model: &CityModel) -> Vec<bool> {
    let texture = |material: u32| model.materials.get(material as usize).map_or(NONE, |material| material.texture);
    model.surfaces.iter().map(|surface| texture(surface.material) != NONE).collect()
}

fn is_near(found: Aabb, min: [f64; 3], max: [f64; 3]) -> bool {
    let near = |a: DVec3, b: [f64; 3]| (a - DVec3::from(b)).abs().max_element() < 1e-3;
    near(found.min, min) && near(found.max, max)
}

fn encoded(format: image::ImageFormat) -> Vec<u8> {
    let pixels = image::RgbImage::from_fn(8, 8, |x, y| image::Rgb([20 * x as u8, 20 * y as u8, 90]));
    let mut bytes = Cursor::new(Vec::new());
    image::DynamicImage::ImageRgb8(pixels).write_to(&mut bytes, format).expect("an image");
    bytes.into_inner()
}

/// A wall with a window and a wall beside it, with these texture values.
fn two_walls(values: &str) -> String {
    format!(
        r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[1,1,1],"translate":[0,0,0]}},
"appearance":{{"textures":[{{"type":"PNG","image":"t.png"}}],"vertices-texture":[[0,0],[1,0],[1,1],[0,1]]}},
"CityObjects":{{"a":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":"2",
"boundaries":[[[0,1,2,3],[4,7,6,5]],[[8,9,10,11]]],"texture":{{"t":{{"values":{values}}}}}}}]}}}},
"vertices":[[0,0,0],[10,0,0],[10,0,10],[0,0,10],[3,0,3],[7,0,3],[7,0,7],[3,0,7],[12,0,0],[22,0,0],[22,0,10],[12,0,10]]}}"#
    )
}

#[test]
fn a_texture_value_that_does_not_match_costs_its_own_face() {
    let folder = Folder::new("exporters-textures");
    folder.write("t.png", encoded(image::ImageFormat::Png));
    for (values, has, count) in [
        // Nothing for the whole face: once for all of its rings, for each, or for the face.
        ("[[[null]],[[0,0,1,2,3]]]", [false, true], 0),
        ("[[[null],[null]],[[0,0,1,2,3]]]", [false, true], 0),
        ("[[null],[[0,0,1,2,3]]]", [false, true], 0),
        ("[null,[[0,0,1,2,3]]]", [false, true], 0),
        ("[[[0,0,1,2,3],[0,0,3,2,1]],[[null]]]", [true, false], 0),
        // A ring too few, a coordinate too few, a texture that is not there, a word.
        ("[[[0,0,1,2,3]],[[0,0,1,2,3]]]", [false, true], 1),
        ("[[[0,0,1,2],[0,0,3,2,1]],[[0,0,1,2,3]]]", [false, true], 1),
        ("[[[7,0,1,2,3],[7,0,3,2,1]],[[0,0,1,2,3]]]", [false, true], 1),
        ("[\"none\",[[0,0,1,2,3]]]", [false, true], 1),
        // One face too few, one too many.
        ("[[[0,0,1,2,3],[0,0,3,2,1]]]", [true, false], 1),
        ("[[[null]],[[0,0,1,2,3]],[[0,0,1,2,3]]]", [false, true], 1),
    ] {
        let model = load_text(&folder, "walls.city.json", two_walls(values));
        assert_eq!(textured(&model), has, "{values}");
        assert_eq!(model.warnings.count(WarningCode::AppearanceIndex), count, "{values}: {:?}", warnings(&model));
        assert_eq!(model.warnings.iter().count() as u64, count, "{values}: {:?}", warnings(&model));
    }
}

/// Base64 of bytes.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0_u32, |word, byte| word << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        (0..=chunk.len()).for_each(|i| text.push(DIGITS[(word >> (18 - 6 * i)) as usize & 63].into()));
        text.push_str(&"=".repeat(3 - chunk.len()));
    }
    text
}

/// A glTF file of one triangle, 10 m east and up, with these members besides and some text changed.
fn triangle(more: &str, changes: &[(&str, &str)]) -> String {
    let corners = [[0.0_f32, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let mut text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"name":"wall"}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.8,0.1,0.1,1]}}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"data:;base64,{}"}}]{more}}}"#,
        base64(&bytes)
    );
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text
}

#[test]
fn gltf_that_the_format_allows_is_read() {
    let folder = Folder::new("exporters-gltf");
    let channel = |target: &str| {
        format!(
            r#","animations":[{{"samplers":[{{"input":0,"output":0}}],"channels":[{{"sampler":0,"target":{target}}}]}}]"#
        )
    };
    for (name, more, changes) in [
        ("plain", String::new(), vec![]),
        ("a channel without a node", channel(r#"{"path":"rotation"}"#), vec![]),
        (
            "a channel with a pointer",
            channel(r#"{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/0"}}}"#)
                + r#","extensionsUsed":["KHR_animation_pointer"],"extensionsRequired":["KHR_animation_pointer"]"#,
            vec![],
        ),
        ("an empty scene behind", String::new(), vec![(r#"[{"nodes":[0]}]"#, r#"[{"nodes":[0]},{"name":"empty"}]"#)]),
        (
            "an empty scene before",
            String::new(),
            vec![(r#"[{"nodes":[0]}]"#, r#"[{"name":"empty"},{"nodes":[0]}]"#), (r#""scene":0"#, r#""scene":1"#)],
        ),
        (
            "no scene named, the first empty",
            String::new(),
            vec![(r#"[{"nodes":[0]}]"#, r#"[{},{"nodes":[0]}]"#), (r#""scene":0,"#, "")],
        ),
        ("no scenes", String::new(), vec![(r#""scene":0,"scenes":[{"nodes":[0]}],"#, "")]),
        (
            "whole numbers as fractions",
            String::new(),
            vec![
                (r#""count":3"#, r#""count":3.0"#),
                (r#""componentType":5126"#, r#""componentType":5.126e3"#),
                (r#""byteLength":36"#, r#""byteLength":36.00"#),
                (r#""mesh":0"#, r#""mesh":0.0"#),
                (r#""scene":0"#, r#""scene":0.0"#),
            ],
        ),
        ("lists of nothing", r#","cameras":null,"skins":null,"textures":null"#.into(), vec![]),
        (
            "a camera, a skin and a texture that are wrong",
            r#","cameras":[{}],"skins":[{"joints":-1}],"textures":[{"source":"x"}],"samplers":[7]"#.into(),
            vec![],
        ),
        (
            "an image that only an extension names",
            r#","extensionsRequired":["EXT_texture_webp"],"textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}],"images":[{"uri":"t.webp"}]"#.into(),
            vec![],
        ),
    ] {
        let model = load_text(&folder, "t.gltf", triangle(&more, &changes));
        assert_eq!(model.indices.len(), 3, "{name}");
        assert_eq!(warnings(&model), [] as [String; 0], "{name}");
        assert!(is_near(model.extent(), [0.0, 0.0, 0.0], [10.0, 0.0, 10.0]), "{name}");
        let surface = model.surfaces[0];
        assert!((model.materials[surface.material as usize].base_color[0] - 0.8).abs() < 1e-6, "{name}");
    }
}

#[test]
fn what_is_wrong_with_a_part_of_gltf_costs_that_part() {
    let folder = Folder::new("exporters-gltf-parts");
    let two = |second: &str, mesh: &str| {
        let nodes = format!(r#""nodes":[{{"mesh":0,"name":"wall"}},{second}]"#);
        let meshes = format!(r#""material":0}}]}}{mesh}],"#);
        triangle(
            "",
            &[
                (r#""nodes":[{"mesh":0,"name":"wall"}]"#, &nodes),
                (r#"[{"nodes":[0]}]"#, r#"[{"nodes":[0,1]}]"#),
                (r#""material":0}]}],"#, &meshes),
            ],
        )
    };
    for (second, mesh, code, said) in [
        (r#"{"mesh":"x"}"#, "", WarningCode::Malformed, "nodes[1]"),
        (r#"{"mesh":1,"name":"b"}"#, r#",{"primitives":7}"#, WarningCode::BadGeometry, "meshes[1]"),
        (r#"{"mesh":4,"name":"b"}"#, "", WarningCode::BadGeometry, "meshes[4] does not exist; the file has 1"),
    ] {
        let model = load_text(&folder, "t.gltf", two(second, mesh));
        assert_eq!(model.indices.len(), 3, "{second}");
        assert_eq!(model.warnings.count(code), 1, "{second}: {:?}", warnings(&model));
        assert!(warnings(&model)[0].contains(said), "{:?}", warnings(&model));
    }
    // What is hidden is not shown, nor what hangs on it.
    let hidden = two(r#"{"extensions":{"KHR_node_visibility":{"visible":false}},"mesh":0,"children":[]}"#, "");
    assert_eq!(load_text(&folder, "t.gltf", hidden).indices.len(), 3);
}

/// A triangle of OBJ with texture coordinates, after this head.
fn obj(head: &str, material: &str) -> String {
    format!("{head}\nvt 0 0\nvt 1 0\nvt 1 1\nv 0 0 0\nv 10 0 0\nv 10 10 0\nusemtl {material}\nf 1/1 2/2 3/3\n")
}

#[test]
fn names_of_files_are_found_as_exporters_spell_them() {
    let folder = Folder::new("exporters-names");
    folder.write("my mat.mtl", "newmtl Red Paint\nKd 1 0 0\n");
    std::fs::create_dir_all(folder.0.join("Maps")).expect("a folder");
    folder.write("Maps/Wall Tile.PNG", encoded(image::ImageFormat::Png));
    for library in [
        "my mat.mtl",
        "\"my mat.mtl\"",
        "my\\ mat.mtl",
        "My Mat.MTL",
        "C:\\Users\\me\\my mat.mtl",
        "/home/somebody/models/my mat.mtl",
        "./my mat.mtl",
    ] {
        for material in ["Red Paint", "red paint"] {
            let model = load_text(&folder, "t.obj", obj(&format!("mtllib {library}"), material));
            let found = &model.materials[model.surfaces[0].material as usize];
            assert_eq!((&*found.name, found.base_color), ("Red Paint", [1.0, 0.0, 0.0, 1.0]), "{library}, {material}");
            assert_eq!(warnings(&model), [] as [String; 0], "{library}, {material}");
        }
    }
    for map in [
        "Maps/Wall Tile.PNG",
        "\"Maps/Wall Tile.PNG\"",
        "'Maps\\Wall Tile.PNG'",
        "maps/wall tile.png",
        "Maps/Wall\\ Tile.PNG",
    ] {
        folder.write("t.mtl", format!("newmtl m\nKd 1 1 1\nmap_Kd {map}\n"));
        let model = load_text(&folder, "t.obj", obj("mtllib t.mtl", "m"));
        assert_eq!(textured(&model), [true], "{map}: {:?}", warnings(&model));
        assert!(matches!(model.textures[0].image, TextureImage::File(_)), "{map}");
        assert_eq!(warnings(&model), [] as [String; 0], "{map}");
    }
    // Nothing is found that is not there, and nothing outside.
    std::fs::create_dir_all(folder.0.join("inner")).expect("a folder");
    folder.write("inner/t.obj", obj("mtllib ../MY MAT.mtl", "m"));
    let model = loaded(&folder.0.join("inner/t.obj"));
    assert!(model.warnings.count(WarningCode::OutsidePath) > 0 && model.materials.is_empty(), "{:?}", warnings(&model));
}

#[test]
fn found_textures_can_be_read_and_others_are_told_with_their_object() {
    use image::ImageFormat as F;
    let folder = Folder::new("exporters-images");
    let png = encoded(F::Png);
    let jpeg = encoded(F::Jpeg);
    let pointer = [LFS_POINTER, b"v1\noid sha256:4d7a\nsize 12345\n"].concat();
    for (name, bytes, said) in [
        ("a.png", png.clone(), None),
        ("a.jpg", jpeg.clone(), None),
        ("a.tif", encoded(F::Tiff), None),
        ("a.webp", encoded(F::WebP), None),
        ("a.bmp", encoded(F::Bmp), None),
        ("a.gif", encoded(F::Gif), None),
        ("a.tga", encoded(F::Tga), None),
        // By what it is, not by its name.
        ("b.jpg", png.clone(), None),
        ("empty.png", Vec::new(), Some("no image of a kind that is read")),
        ("page.jpg", b"<!DOCTYPE html><html></html>".to_vec(), Some("no image of a kind that is read")),
        ("half.png", png[..png.len() / 2].to_vec(), Some("cannot be decoded")),
        ("half.jpg", jpeg[..jpeg.len() / 4].to_vec(), Some("cannot be decoded")),
        ("kept.png", pointer, Some("Git LFS pointer")),
        ("a.dds", b"DDS |.......".to_vec(), Some("Dds, which is not read")),
    ] {
        folder.write(name, bytes);
        folder.write("t.mtl", format!("newmtl m\nKd 1 1 1\nmap_Kd {name}\n"));
        for (file, text) in [
            ("t.obj", obj("mtllib t.mtl", "m")),
            ("t.city.json", two_walls("[[[null]],[[0,0,1,2,3]]]").replace("t.png", name)),
        ] {
            let model = load_text(&folder, file, text);
            let textures = facts::facts(&model, false).textures;
            assert_eq!((textures.declared, textures.found), (1, u64::from(said.is_none())), "{name} of {file}");
            assert_eq!(
                model.warnings.count(WarningCode::MissingTexture),
                u64::from(said.is_some()),
                "{name} of {file}"
            );
            let told = warnings(&model).concat();
            assert!(said.is_none_or(|said| told.contains(said)), "{name} of {file}: {told}");
            let objects = model.warnings.iter().flat_map(|(_, warning)| &warning.objects);
            let id = &*model.objects[0].id;
            assert!(said.is_none() || objects.into_iter().any(|object| object == id), "{name} of {file}: {told}");
        }
    }
}

#[test]
fn y_is_up_where_the_scene_says_so() {
    let folder = Folder::new("exporters-up");
    let text = "v 0 0 0\nv 10 0 0\nv 10 0 -20\nv 0 50 0\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1 2 4\n";
    let path = folder.write("t.obj", text);
    let options = LoadOptions { up: Up::Y, ..LoadOptions::default() };
    let model = load(std::slice::from_ref(&path), &options, &Quiet).expect("a model");
    assert!(is_near(model.extent(), [0.0, 0.0, 0.0], [10.0, 20.0, 50.0]), "{:?}", model.extent());
    assert!(is_near(loaded(&path).extent(), [0.0, 0.0, -20.0], [10.0, 50.0, 0.0]));
    let scene = veduta::figure::scene_file::parse(
        "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\nup = \"y\"\n",
        "t.toml",
        &veduta::figure::scene_file::Options::default(),
    );
    assert_eq!(scene.expect("a scene").city.up, Up::Y);
}

/// A cube of CityJSON at these coordinates, of this reference system.
fn cube(translate: [f64; 3], scale: [f64; 3], crs: Option<&str>) -> String {
    let metadata = crs.map_or(String::new(), |crs| {
        format!(r#""metadata":{{"referenceSystem":"https://www.opengis.net/def/crs/{crs}"}},"#)
    });
    format!(
        r#"{{"type":"CityJSON","version":"2.0",{metadata}"transform":{{"scale":{scale:?},"translate":{translate:?}}},
"CityObjects":{{"a":{{"type":"Building","geometry":[{{"type":"Solid","lod":"2","boundaries":
[[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]]}}]}}}},
"vertices":[[0,0,0],[10,0,0],[10,10,0],[0,10,0],[0,0,10],[10,0,10],[10,10,10],[0,10,10]]}}"#
    )
}

#[test]
fn earth_centred_coordinates_stand_upright() {
    let folder = Folder::new("exporters-earth");
    // On the equator at Greenwich up is x, north is z, east is y.
    let at = [6_378_137.0, 0.0, 0.0];
    let model = load_text(&folder, "t.city.json", cube(at, [1.0, 2.0, 3.0], Some("EPSG/0/4978")));
    assert!(is_near(model.extent(), [0.0, 0.0, 0.0], [20.0, 30.0, 10.0]), "{:?}", model.extent());
    assert_eq!(warnings(&model), [] as [String; 0]);
    // At 50° north, 4° east it is far from all axes, and as large as it is.
    let at = [3_900_000.0, 300_000.0, 5_000_000.0];
    let model = load_text(&folder, "t.city.json", cube(at, [1.0; 3], Some("EPSG/0/4978")));
    assert_eq!((model.indices.len(), warnings(&model)), (36, vec![]));
    let longest = 10.0 * 3.0_f64.sqrt();
    assert!(model.extent().size().max_element() < longest + 1e-3 && model.extent().size().min_element() > 9.0);
    assert!(model.extent().min.truncate().abs().max_element() < longest);
    // What says to be earth-centred and is not.
    let model = load_text(&folder, "t.city.json", cube([85_000.0, 447_000.0, 0.0], [1.0; 3], Some("EPSG/0/4978")));
    assert!(is_near(model.extent(), [85_000.0, 447_000.0, 0.0], [85_010.0, 447_010.0, 10.0]));
    assert_eq!(model.warnings.count(WarningCode::UnknownCrs), 1);
    // glTF is y up, and says nothing of where it is; OBJ neither.
    let moved = r#"{"mesh":0,"name":"wall","translation":[0,6378137,30000]}"#;
    let model = load_text(&folder, "t.gltf", triangle("", &[(r#"{"mesh":0,"name":"wall"}"#, moved)]));
    assert_eq!((model.indices.len(), model.warnings.count(WarningCode::UnknownCrs)), (3, 1), "{:?}", warnings(&model));
    assert!(model.extent().min.truncate().abs().max_element() < 20.0, "{:?}", model.extent());
    let text = "v 0 0 6356752\nv 10 0 6356752\nv 10 0 6356762\nvn 1 0 0\nf 1//1 2//1 3//1\n";
    let model = load_text(&folder, "t.obj", text);
    assert!(is_near(model.extent(), [-0.0, -0.0, -0.314], [0.0, 10.0, 9.686]) || model.extent().size().z > 9.9);
    assert_eq!(model.warnings.count(WarningCode::UnknownCrs), 1, "{:?}", warnings(&model));
    // National coordinates are not earth-centred, however large.
    let text = "v 2500000 5700000 90\nv 2500010 5700000 90\nv 2500010 5700010 95\nf 1 2 3\n";
    assert!(load_text(&folder, "t.obj", text).extent().min.x > 2_499_999.0);
}

#[test]
fn degrees_without_a_reference_system_are_told() {
    let folder = Folder::new("exporters-degrees");
    let degrees = cube([4.35, 52.01, 0.0], [1e-6, 1e-6, 1.0], None);
    let model = load_text(&folder, "t.city.json", &degrees);
    assert_eq!(model.warnings.count(WarningCode::UnknownCrs), 1, "{:?}", warnings(&model));
    assert!(warnings(&model)[0].contains("look like degrees"));
    let known = cube([4.35, 52.01, 0.0], [1e-6, 1e-6, 1.0], Some("OGC/1.3/CRS84h"));
    assert_eq!(load_text(&folder, "t.city.json", known).warnings.count(WarningCode::UnknownCrs), 0);
    // A mast is no city in degrees.
    let mast = load_text(&folder, "t.city.json", cube([4.0, 52.0, 0.0], [0.01, 0.01, 5.0], None));
    assert_eq!(warnings(&mast), [] as [String; 0]);
}

#[test]
fn pointers_of_git_lfs_are_called_that() {
    let folder = Folder::new("exporters-lfs");
    let pointer = [LFS_POINTER, b"v1\noid sha256:4d7a\nsize 12345\n"].concat();
    for name in ["t.city.json", "t.city.jsonl", "t.glb", "t.gltf", "t.obj"] {
        assert!(refusal(&folder.write(name, &pointer)).contains("Git LFS pointer"), "{name}");
    }
    folder.write("t.bin", &pointer);
    let beside = triangle("", &[("\"uri\":\"data:", "\"uri\":\"t.bin\",\"name\":\"data:")]);
    assert!(refusal(&folder.write("u.gltf", beside)).contains("Git LFS pointer"));
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(bytes).expect("packed");
    packer.finish().expect("packed")
}

#[test]
fn what_stands_behind_compressed_content_is_passed_over() {
    let folder = Folder::new("exporters-gzip");
    let text = cube([0.0; 3], [1.0; 3], None);
    let whole = gzipped(text.as_bytes());
    let (half, rest) = text.as_bytes().split_at(100);
    for (name, bytes, count) in [
        ("whole", whole.clone(), 0),
        ("two members", [gzipped(half), gzipped(rest)].concat(), 0),
        ("padding", [&whole[..], &[0; 512]].concat(), 0),
        ("something behind", [&whole[..], b"\r\n--boundary--"].concat(), 1),
    ] {
        let model = load_text(&folder, "t.city.json.gz", bytes);
        assert_eq!(model.indices.len(), 36, "{name}");
        assert_eq!(model.warnings.count(WarningCode::Malformed), count, "{name}: {:?}", warnings(&model));
    }
}

#[test]
fn features_that_span_lines_are_read() {
    let folder = Folder::new("exporters-spanning");
    let header = "{\n \"type\": \"CityJSON\", \"version\": \"2.0\",\n \"transform\": {\"scale\": [1,1,1], \"translate\": [0,0,0]},\n \"CityObjects\": {}, \"vertices\": []\n}\n";
    let feature = |id: &str| {
        format!(
            "{{\n \"type\": \"CityJSONFeature\", \"id\": \"{id}\",\n \"CityObjects\": {{\n  \"{id}\": {{\"type\": \"Building\", \"geometry\": [\n   {{\"type\": \"MultiSurface\", \"lod\": \"2\", \"boundaries\": [[[0,1,2]]]}}]}}\n }},\n \"vertices\": [[0,0,0],[9,0,0],[0,0,9]]\n}}\n"
        )
    };
    let one_line = |text: String| text.replace('\n', "") + "\n";
    let ids = |model: &CityModel| model.objects.iter().map(|object| object.id.to_string()).collect::<Vec<_>>();
    for (name, text, count) in [
        ("all", header.to_owned() + &feature("a") + &feature("b"), 2),
        ("some", header.to_owned() + &one_line(feature("a")) + &feature("b"), 1),
        ("none", header.to_owned() + &one_line(feature("a")) + &one_line(feature("b")), 0),
        ("on one line", header.to_owned() + feature("a").trim_end() + &feature("b"), 2),
    ] {
        let model = load_text(&folder, "t.city.jsonl", &text);
        assert_eq!(ids(&model), ["a", "b"], "{name}: {:?}", warnings(&model));
        assert_eq!((model.indices.len(), model.warnings.count(WarningCode::Malformed)), (6, count), "{name}");
    }
    // A feature without an end costs what it cannot be told from, not what is whole before it.
    let cut = header.to_owned() + &feature("a") + &feature("b")[..60] + "\n" + &one_line(feature("c"));
    let model = load_text(&folder, "t.city.jsonl", &cut);
    assert!(ids(&model).starts_with(&["a".to_owned()]), "{:?}", ids(&model));
    assert!(model.warnings.count(WarningCode::Malformed) > 1);
}

#[test]
fn a_template_that_is_moved_by_its_last_row_stands_where_it_was_meant() {
    let folder = Folder::new("exporters-template");
    let tree = |matrix: &str| {
        format!(
            r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[1,1,1],"translate":[0,0,0]}},
"CityObjects":{{"t":{{"type":"CityFurniture","geometry":[{{"type":"GeometryInstance","template":0,"boundaries":[0],
"transformationMatrix":[{matrix}]}}]}}}},"vertices":[[5,5,0]],
"geometry-templates":{{"templates":[{{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}}],
"vertices-templates":[[0,0,0],[10,0,0],[10,0,10]]}}}}"#
        )
    };
    let by_rows = load_text(&folder, "t.city.json", tree("2,0,0,100, 0,2,0,200, 0,0,2,300, 0,0,0,1"));
    let by_columns = load_text(&folder, "t.city.json", tree("2,0,0,0, 0,2,0,0, 0,0,2,0, 100,200,300,1"));
    assert!(is_near(by_rows.extent(), [105.0, 205.0, 300.0], [125.0, 205.0, 320.0]), "{:?}", by_rows.extent());
    assert_eq!(by_rows.extent(), by_columns.extent());
    assert_eq!((warnings(&by_rows).len(), by_columns.warnings.count(WarningCode::Malformed)), (0, 1));
}

#[test]
fn a_city_of_which_nothing_is_drawn_says_why() {
    let folder = Folder::new("exporters-nothing");
    let of = |objects: &str| {
        format!(
            r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[1,1,1],"translate":[0,0,0]}},"CityObjects":{{{objects}}},"vertices":[[0,0,0],[9,0,0],[0,0,9]]}}"#
        )
    };
    let building = |geometry: &str| of(&format!(r#""a":{{"type":"Building","geometry":{geometry}}}"#));
    for (text, lod, said) in [
        (of(""), None, "no city objects"),
        (building("null"), None, "none of the 1 city objects has geometry"),
        (building("[]"), None, "none of the 1 city objects has geometry"),
        (building(r#"[{"type":"MultiPoint","lod":"0","boundaries":[0,1]}]"#), None, "points or lines alone"),
        (building(r#"[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,1]]]}]"#), None, "all 1 faces are faulty"),
        (
            building(r#"[{"type":"MultiSurface","lod":"2.2","boundaries":[[[0,1,2]]]}]"#),
            Some("1"),
            "all levels of detail that there are (2.2)",
        ),
        (building(r#"[{"type":"MultiSurface","lod":"2.2","boundaries":[[[0,1,2]]]}]"#), None, ""),
    ] {
        let model = load_text(&folder, "t.city.json", &text);
        let cap = lod.and_then(veduta::city::Lod::parse);
        let shown = veduta::city::shown::shown_geometries(&model, cap);
        let why = facts::nothing_drawn(&model, &shown);
        assert_eq!(why.is_none(), said.is_empty(), "{text}: {why:?}");
        assert!(why.unwrap_or_default().contains(said), "{text}");
    }
}
