//! Input that is wrong: every case must end in one readable message or in listed warnings with the
//! rest shown; through the library, and through the program with its exit code and a limit on memory.

use std::{
    fmt::Write,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use veduta::city::load::{LoadOptions, Quiet, load};

/// Two squares; everything below is made wrong from it.
const HOUSE: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{"a":{"type":"Building","attributes":{"height":3},"geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2,3]],[[0,1,5,4]]]}]}},"vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1]]}"#;

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no a\nf 1 2 3\n";

const GLTF: &str = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"name":"a","mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAA"}]}"#;

/// What must come of a file.
enum Wanted {
    /// An error whose message has all these words besides the file's name.
    Error(&'static [&'static str]),
    /// So many triangles, and these warnings.
    Shown(u32, &'static [&'static str]),
    /// An error, or these warnings.
    Either(&'static [&'static str]),
}
use Wanted::{Either, Error, Shown};

/// A wrong file.
struct Case {
    name: &'static str,
    bytes: Vec<u8>,
    wanted: Wanted,
}

fn case(name: &'static str, bytes: impl Into<Vec<u8>>, wanted: Wanted) -> Case {
    Case { name, bytes: bytes.into(), wanted }
}

/// `HOUSE` with one text replaced; the text must be there.
fn house(from: &str, to: &str) -> String {
    assert!(HOUSE.contains(from), "{from}");
    HOUSE.replacen(from, to, 1)
}

fn gltf(from: &str, to: &str) -> String {
    assert!(GLTF.contains(from), "{from}");
    GLTF.replacen(from, to, 1)
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// A GLB of one JSON chunk and a binary chunk, with the lengths it claims.
fn glb(json: &str, binary: &[u8], says: impl Fn(u32) -> u32, json_says: impl Fn(u32) -> u32) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(says(total as u32).to_le_bytes());
    out.extend(json_says(json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(&json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

fn utf16(text: &str) -> Vec<u8> {
    [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

/// What is wrong with the file as a whole.
fn whole_files() -> Vec<Case> {
    let picture = std::fs::read("citydata/brick.png").unwrap();
    vec![
        case("empty.json", "", Error(&["empty", "0 bytes"])),
        case("blank.json", " \n\t\n", Error(&["white space"])),
        case("empty.glb", "", Error(&["empty"])),
        case("empty.obj", "", Error(&["empty"])),
        case("picture.json", picture.clone(), Error(&["PNG"])),
        case("picture.obj", picture.clone(), Error(&["PNG"])),
        case("picture.glb", picture, Error(&["PNG"])),
        case("binary.json", (0..=255).cycle().take(10_000).collect::<Vec<u8>>(), Error(&[])),
        case("prose.json", "Once upon a time", Error(&[])),
        case("prose.obj", "Once upon a time", Error(&["OBJ"])),
        case("list.json", "[1, 2]", Error(&["CityJSON"])),
        case("utf16.json", utf16(HOUSE), Error(&["UTF-16", "UTF-8"])),
        case("citygml.gml", "<?xml version=\"1.0\"?><core:CityModel xmlns:core=\"citygml/2.0\"/>", Error(&["CityGML"])),
        case("tileset.json", r#"{"asset":{"version":"1.1"},"geometricError":1,"root":{}}"#, Error(&["3D Tiles"])),
        case("page.json", "<!DOCTYPE html><html></html>", Error(&["web page"])),
        case("map.geojson", r#"{"type":"FeatureCollection","features":[]}"#, Error(&["GeoJSON"])),
        case("bomb.json.gz", gzip(&vec![b' '; 300 << 20]), Error(&["MiB"])),
        case("twice.json.gz", gzip(&gzip(HOUSE.as_bytes())), Error(&["gzip"])),
        case("torn.json.gz", gzip(HOUSE.as_bytes())[..40].to_vec(), Either(&["truncated-file"])),
        case("noise.json.gz", [&gzip(b"")[..10], &[0xff; 90]].concat(), Error(&["gzip"])),
    ]
}

/// What is wrong with CityJSON's own words.
fn city_json() -> Vec<Case> {
    let deep = "[".repeat(1_000_000);
    let deep_pairs = format!("{}1{}", "[".repeat(1_000_000), "]".repeat(1_000_000));
    vec![
        case("right.json", HOUSE, Shown(4, &[])),
        case("truncated.json", &HOUSE.as_bytes()[..230], Either(&["truncated-file"])),
        case("unclosed.json", &HOUSE.as_bytes()[..HOUSE.len() - 1], Shown(4, &["truncated-file"])),
        case("no-type.json", "{}", Error(&["CityJSON"])),
        case("version-0.json", house("\"2.0\"", "\"0.6\""), Error(&["0.6"])),
        case("version-9.json", house("\"2.0\"", "\"9.9\""), Either(&["malformed"])),
        case("version-number.json", house("\"2.0\"", "2"), Either(&["malformed"])),
        case(
            "no-transform.json",
            house(r#""transform":{"scale":[1,1,1],"translate":[0,0,0]},"#, ""),
            Shown(4, &["missing-transform"]),
        ),
        case("transform-null.json", house(r#"{"scale":[1,1,1],"translate":[0,0,0]}"#, "null"), Either(&["missing-transform"])),
        case("scale-zero.json", house("\"scale\":[1,1,1]", "\"scale\":[0,0,0]"), Either(&[])),
        case("scale-huge.json", house("\"scale\":[1,1,1]", "\"scale\":[1e300,1e300,1e999]"), Either(&[])),
        case("z-int32-min.json", house("[0,0,1]", "[0,0,-2147483648]"), Shown(2, &["bad-coordinate"])),
        case("z-int64-min.json", house("[0,0,1]", "[0,0,-9223372036854775808]"), Shown(2, &["bad-coordinate"])),
        case("z-beyond.json", house("[0,0,1]", "[0,0,99999999999999999999999]"), Shown(2, &["bad-coordinate"])),
        case("nan.json", house("[0,0,1]", "[0,0,NaN]"), Either(&["bad-coordinate"])),
        case("infinity.json", house("[0,0,1]", "[0,0,-Infinity]"), Either(&["bad-coordinate"])),
        case("short-vertex.json", house("[0,0,1]", "[0,0]"), Either(&[])),
        case("attribute-f32-max.json", house(":3}", ":3.4e38}"), Shown(4, &[])),
        case("attribute-beyond.json", house(":3}", ":1e999}"), Shown(4, &["attribute-range"])),
        case("ring-of-two.json", house("[[0,1,2,3]]", "[[0,1]]"), Shown(2, &["short-ring"])),
        case("ring-of-none.json", house("[[0,1,2,3]]", "[[]]"), Shown(2, &["short-ring"])),
        case("no-ring.json", house("[[0,1,2,3]]", "[]"), Shown(2, &[])),
        case("hole-of-two.json", house("[[0,1,2,3]]", "[[0,1,2,3],[1,2]]"), Shown(4, &["short-ring"])),
        case("zero-area.json", house("[[0,1,2,3]]", "[[0,1,0,1]]"), Shown(2, &[])),
        case("self-crossing.json", house("[[0,1,2,3]]", "[[0,2,1,3]]"), Shown(2, &["self-crossing"])),
        case("index-past.json", house("[[0,1,2,3]]", "[[0,1,2,99]]"), Shown(2, &["vertex-index-out-of-range"])),
        case("index-negative.json", house("[[0,1,2,3]]", "[[0,1,2,-1]]"), Shown(2, &["vertex-index-out-of-range"])),
        case("index-huge.json", house("[[0,1,2,3]]", "[[0,1,2,4294967296]]"), Shown(2, &["vertex-index-out-of-range"])),
        case("index-text.json", house("[[0,1,2,3]]", "[[0,1,2,\"3\"]]"), Either(&[])),
        case("index-fraction.json", house("[[0,1,2,3]]", "[[0,1,2,2.5]]"), Either(&[])),
        case("depth-wrong.json", house("[[0,1,2,3]]", "0"), Either(&[])),
        case(
            "template.json",
            house(
                r#"{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2,3]],[[0,1,5,4]]]}"#,
                r#"{"type":"GeometryInstance","template":7,"boundaries":[0],"transformationMatrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}"#,
            ),
            Shown(0, &["template-index-out-of-range"]),
        ),
        case(
            "cyclic.json",
            house(r#""CityObjects":{"#, r#""CityObjects":{"b":{"type":"Building","parents":["c"],"children":["c"]},"c":{"type":"Building","parents":["b"],"children":["b"]},"#),
            Shown(4, &["cyclic-parents"]),
        ),
        case("own-parent.json", house("\"attributes\"", "\"parents\":[\"a\"],\"attributes\""), Shown(4, &["cyclic-parents"])),
        case("dangling.json", house("\"attributes\"", "\"parents\":[\"z\"],\"attributes\""), Shown(4, &["dangling-link"])),
        case("empty-city.json", r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{},"vertices":[]}"#, Shown(0, &[])),
        case("twins.json", house("\"CityObjects\":{", "\"CityObjects\":{\"a\":{\"type\":\"Road\"},"), Shown(4, &["duplicate-id"])),
        case(
            "missing-texture.json",
            house(
                "\"vertices\"",
                r#""appearance":{"textures":[{"type":"PNG","image":"appearances/none.png"}],"vertices-texture":[[0,0],[1,0],[1,1],[0,1]]},"vertices""#,
            )
            .replace(
                "[[0,1,5,4]]]",
                r#"[[0,1,5,4]]],"texture":{"t":{"values":[[[0,0,1,2,3]],[[9,0,1,2,77]]]}}"#,
            ),
            Shown(4, &["missing-texture", "appearance-index-out-of-range"]),
        ),
        case(
            "texture-beyond.json",
            house(
                "\"vertices\"",
                r#""appearance":{"materials":[{"name":"m","diffuseColor":[NaN,1e308,-1]}],"textures":[{"type":"PNG","image":"none.png"}],"vertices-texture":[[1e308,0],[NaN,0],[1,1e999],[0,1]]},"vertices""#,
            )
            .replace(
                "[[0,1,5,4]]]",
                r#"[[0,1,5,4]]],"texture":{"t":{"values":[[[0,0,1,2,3]],[[0,0,1,2,3]]]}},"material":{"t":{"value":0}}"#,
            ),
            Shown(4, &["missing-texture"]),
        ),
        case("version-lines.json", house("\"2.0\"", "\"0\\n\\n\\u0007\""), Error(&["version"])),
        case(
            "outside-texture.json",
            house(
                "\"vertices\"",
                r#""appearance":{"textures":[{"type":"PNG","image":"../../../../../../../../etc/passwd"},{"type":"PNG","image":"/etc/passwd"}],"vertices-texture":[]},"vertices""#,
            ),
            Shown(4, &["outside-path"]),
        ),
        case("latin1.json", house(":3}", ":\"\u{1}\"}").replace('\u{1}', "Stra\u{2}e").bytes().map(|b| if b == 2 { 0xdf } else { b }).collect::<Vec<u8>>(), Either(&["malformed"])),
        case("deep.json", format!("{{\"type\":\"CityJSON\",\"version\":\"2.0\",\"a\":{deep}"), Either(&["truncated-file"])),
        case("deep-extra.json", house("\"vertices\"", &format!("\"extra\":{deep_pairs},\"vertices\"")), Either(&[])),
        case("deep-attribute.json", house(":3}", &format!(":{deep_pairs}}}")), Either(&[])),
        case("deep-boundary.json", house("[[0,1,2,3]]", &deep_pairs), Either(&[])),
        case("deep-objects.json", house(":3}", &format!(":{}1{}}}", "{\"a\":".repeat(300_000), "}".repeat(300_000))), Either(&[])),
        case("torn.jsonl", format!("{}\n{{\"type\":\"CityJSONFeature\",\"id\":", house("\"a\":{", "\"z\":{").replace('\n', "")), Shown(4, &["malformed"])),
    ]
}

/// What is wrong with glTF and OBJ.
fn meshes() -> Vec<Case> {
    let same = |n: u32| n;
    let chain: String = {
        let mut nodes = String::new();
        for i in 0..100_000 {
            write!(nodes, "{{\"children\":[{}]}},", i + 1).unwrap();
        }
        format!("\"nodes\":[{nodes}{{\"mesh\":0}}]")
    };
    vec![
        case("right.gltf", GLTF, Shown(1, &[])),
        case("right.glb", glb(GLTF, &[0; 8], same, same), Shown(1, &[])),
        case("truncated.gltf", &GLTF.as_bytes()[..200], Error(&["line 1", "ends early"])),
        case("no-asset.gltf", "{}", Error(&["asset"])),
        case("version-1.gltf", gltf("\"2.0\"", "\"1.0\""), Error(&["1.0", "2.0"])),
        case(
            "draco.gltf",
            gltf("\"scenes\"", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scenes\""),
            Error(&["KHR_draco_mesh_compression"]),
        ),
        case(
            "meshopt.gltf",
            gltf("\"scenes\"", "\"extensionsRequired\":[\"EXT_meshopt_compression\"],\"scenes\""),
            Error(&["EXT_meshopt_compression"]),
        ),
        case(
            "basisu.gltf",
            gltf("\"scenes\"", "\"extensionsRequired\":[\"KHR_texture_basisu\"],\"scenes\""),
            Error(&["KHR_texture_basisu", "PNG"]),
        ),
        case("count-huge.gltf", gltf("\"count\":3", "\"count\":18446744073709551615"), Error(&["accessors[0]"])),
        case(
            "count-zeros.gltf",
            gltf(
                "\"bufferView\":0,\"componentType\":5126,\"count\":3",
                "\"componentType\":5126,\"count\":9000000000000000000",
            ),
            Error(&["more than this file may unfold"]),
        ),
        case(
            "view-huge.gltf",
            gltf("\"byteLength\":36}],\"buffers\"", "\"byteLength\":99999999999}],\"buffers\""),
            Shown(1, &[]),
        ),
        case(
            "view-offset.gltf",
            gltf("{\"buffer\":0,", "{\"buffer\":0,\"byteOffset\":18446744073709551615,"),
            Error(&["bufferViews[0]"]),
        ),
        case("buffer-missing.gltf", gltf("data:;base64,", "no-such.bin?"), Error(&["no-such.bin", "does not exist"])),
        case(
            "buffer-outside.gltf",
            gltf("data:;base64,", "../../../../../../../../etc/passwd#"),
            Error(&["outside the folders"]),
        ),
        case("buffer-web.gltf", gltf("data:;base64,", "https://example.org/"), Error(&["network"])),
        case("base64-wrong.gltf", gltf("base64,AAAA", "base64,A*AA"), Error(&["base64"])),
        case(
            "stride-zero.gltf",
            gltf("\"byteLength\":36}],\"buffers\"", "\"byteLength\":36,\"byteStride\":0}],\"buffers\""),
            Error(&["byteStride"]),
        ),
        case(
            "sparse-outside.gltf",
            // The second corner's x, as a number of a corner.
            gltf(
                "\"count\":3",
                "\"count\":3,\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5125},\"values\":{\"bufferView\":0}}",
            ),
            Error(&["accessors[0]", "sparse.indices"]),
        ),
        case("type-wrong.gltf", gltf("VEC3", "VEC9"), Error(&["accessors[0]"])),
        case("mesh-missing.gltf", gltf("\"mesh\":0", "\"mesh\":9"), Error(&["meshes[9]"])),
        case("no-position.gltf", gltf("POSITION", "NORMAL"), Error(&["POSITION"])),
        case("node-cycle.gltf", gltf("\"mesh\":0}", "\"mesh\":0,\"children\":[0]}"), Shown(1, &["cyclic-parents"])),
        case("node-chain.gltf", gltf("\"nodes\":[{\"name\":\"a\",\"mesh\":0}]", &chain), Shown(1, &[])),
        case(
            "nan-translation.gltf",
            gltf("\"mesh\":0}", "\"mesh\":0,\"translation\":[1e300,1e300,1e300]}"),
            Shown(0, &["bad-coordinate"]),
        ),
        case(
            "deep.gltf",
            gltf("\"scenes\"", &format!("\"extras\":{},\"scenes\"", "[".repeat(1_000_000))),
            Error(&["line 1"]),
        ),
        case("lying.glb", glb(GLTF, &[0; 8], |n| n + 1000, same), Shown(1, &["truncated-file"])),
        case("modest.glb", glb(GLTF, &[0; 8], |n| n - 8, same), Shown(1, &["malformed"])),
        case("tiny-length.glb", glb(GLTF, &[0; 8], |_| 3, same), Shown(1, &["malformed"])),
        case("json-lying.glb", glb(GLTF, &[0; 8], same, |_| u32::MAX), Error(&["JSON chunk"])),
        case("json-short.glb", glb(GLTF, &[0; 8], same, |n| n - 20), Error(&["JSON chunk", "line 1"])),
        case("header.glb", "glTF\x02\0\0", Error(&["header"])),
        case("magic.glb", "glTF", Error(&["header"])),
        case("version-1.glb", "glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0", Error(&["version 1"])),
        case("right.obj", OBJ, Shown(1, &[])),
        case("index-0.obj", format!("{OBJ}f 0 1 2\n"), Shown(1, &["vertex-index-out-of-range"])),
        case(
            "index-min.obj",
            format!("{OBJ}f -9223372036854775808 1 2\nf 9223372036854775807 1 2\n"),
            Shown(1, &["vertex-index-out-of-range"]),
        ),
        case("index-beyond.obj", format!("{OBJ}f 99999999999999999999999 1 2\n"), Shown(1, &["malformed"])),
        case("nan.obj", format!("{OBJ}v nan inf -inf\nf 1 2 5\n"), Shown(1, &["bad-coordinate"])),
        case("far.obj", format!("{OBJ}v 1e308 0 0\nf 1 2 5\n"), Shown(1, &["bad-coordinate"])),
        case("two-points.obj", format!("{OBJ}f 1 2\nf 1\nf\n"), Shown(1, &["short-ring"])),
        case("torn.obj", format!("{OBJ}f 1 2 3/"), Shown(1, &["duplicate-shape"])),
        case(
            "no-mtl.obj",
            format!("mtllib none.mtl\nusemtl none\n{OBJ}"),
            Shown(1, &["malformed", "appearance-index-out-of-range"]),
        ),
        case(
            "outside-mtl.obj",
            format!("mtllib ../../../../../../../../etc/passwd\n{OBJ}"),
            Shown(1, &["outside-path"]),
        ),
        case("latin1.obj", [OBJ.as_bytes(), b"o Stra\xdfe\nf 1 3 4\n"].concat(), Shown(2, &[])),
        case("long-line.obj", format!("{OBJ}f{}", " 1 2 3".repeat(200_000)), Either(&[])),
        case("nul.obj", [OBJ.as_bytes(), &[0; 5000]].concat(), Shown(1, &["malformed"])),
        case("no-faces.obj", "v 0 0 0\n", Shown(0, &[])),
    ]
}

/// A folder of its own for one test, with the case's file in it.
fn write(case: &Case, under: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wrong_input").join(under);
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(case.name);
    std::fs::write(&path, &case.bytes).unwrap();
    path
}

/// What is wrong with the outcome, if anything.
fn judge(case: &Case, path: &Path) -> Result<(), String> {
    let loaded = load(std::slice::from_ref(&path.to_path_buf()), &LoadOptions::default(), &Quiet);
    let model = match (loaded, &case.wanted) {
        (Err(e), Error(_) | Either(_)) => {
            let words = if let Error(words) = case.wanted { words } else { &[] };
            let message = e.to_string();
            let missing: Vec<_> = words.iter().chain([&case.name]).filter(|w| !message.contains(**w)).collect();
            let readable = message.len() < 600 && !message.contains('\n');
            return if missing.is_empty() && readable { Ok(()) } else { Err(format!("lacks {missing:?}: {message}")) };
        }
        (Err(e), Shown(..)) => return Err(format!("is refused: {e}")),
        (Ok(_), Error(_)) => return Err("is read without an error".into()),
        (Ok(model), Shown(..) | Either(_)) => model,
    };
    let found: Vec<&str> = model.warnings.iter().map(|(code, _)| code.code()).collect();
    let triangles = (model.indices.len() / 3) as u32;
    let (right, codes) = match case.wanted {
        Shown(wanted, codes) => (wanted == triangles, codes),
        Either(codes) | Error(codes) => (true, codes),
    };
    model.validate()?;
    let unread = model.warnings.iter().find(|(_, w)| w.message.is_empty() || w.count == 0);
    match (right && codes.iter().all(|c| found.contains(c)), unread) {
        (true, None) => Ok(()),
        (_, unread) => Err(format!("{triangles} triangles, warnings {found:?}, without words: {unread:?}")),
    }
}

fn judge_all(cases: &[Case], under: &str) {
    let judged = cases.iter().map(|case| (case.name, judge(case, &write(case, under))));
    let failures: Vec<_> = judged.filter_map(|(name, result)| Some(format!("{name} {}", result.err()?))).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn whole_files_that_are_wrong() {
    judge_all(&whole_files(), "whole");
}

#[test]
fn city_json_that_is_wrong() {
    judge_all(&city_json(), "cityjson");
}

#[test]
fn meshes_that_are_wrong() {
    judge_all(&meshes(), "meshes");
}

/// A file cut anywhere: never a panic, never silence.
#[test]
fn files_cut_at_every_byte() {
    let glb = glb(GLTF, &[0; 8], |n| n, |n| n);
    for (name, bytes) in [
        ("cut.json", HOUSE.as_bytes()),
        ("cut.gltf", GLTF.as_bytes()),
        ("cut.glb", &glb),
        ("cut.obj", OBJ.as_bytes()),
        ("cut.json.gz", &gzip(HOUSE.as_bytes())),
    ] {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wrong_input").join("cut");
        std::fs::create_dir_all(&folder).unwrap();
        for end in 0..bytes.len() {
            let path = folder.join(name);
            std::fs::write(&path, &bytes[..end]).unwrap();
            let loaded = load(std::slice::from_ref(&path), &LoadOptions::default(), &Quiet);
            // OBJ has no end mark: a cut between lines is a shorter file.
            let silent = loaded.is_ok_and(|m| m.warnings.is_empty());
            assert!(!silent || name == "cut.obj", "{name} cut after {end} of {} bytes is read in silence", bytes.len());
        }
    }
}

/// Runs `veduta info` with 2 GiB of address space, which nothing here has reason to need.
fn info(path: &Path) -> Output {
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -v 2097152; exec \"$0\" info \"$1\"", env!("CARGO_BIN_EXE_veduta")]);
        shell
    } else {
        let mut plain = Command::new(env!("CARGO_BIN_EXE_veduta"));
        plain.arg("info");
        plain
    };
    command.arg(path).stdin(Stdio::null()).output().expect("the program starts")
}

/// The program keeps its word: 0 with the facts on stdout, 1 with one message on stderr, and nothing else.
#[test]
fn the_program_says_what_is_wrong() {
    for case in whole_files().iter().chain(&city_json()).chain(&meshes()) {
        let path = write(case, "program");
        let output = info(&path);
        let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        let name = case.name;
        assert!(!err.contains("panicked"), "{name}: {err}");
        match (&case.wanted, output.status.code()) {
            (Error(_) | Either(_), Some(1)) => {
                assert!(err.contains(name), "{name} is not named: {err}");
                assert!(out.is_empty(), "{name}: facts besides an error: {out}");
            }
            (Shown(_, codes) | Either(codes), Some(0)) => {
                assert!(codes.iter().all(|c| out.contains(c)), "{name}: {codes:?} are not all listed: {out}");
            }
            (_, code) => panic!("{name}: exit code {code:?}\n{out}\n{err}"),
        }
    }
}

#[test]
fn wrong_usage_is_2_and_what_is_not_there_is_1() {
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_veduta")).args(arguments).stdin(Stdio::null()).output().unwrap()
    };
    assert_eq!(run(&["info"]).status.code(), Some(2));
    assert_eq!(run(&["info", "--no-such-option", "x"]).status.code(), Some(2));
    let absent = run(&["info", "no/such/city.json"]);
    assert_eq!(absent.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&absent.stderr).contains("no/such/city.json"));
}

/// Lists of scenes are bounded before what is in them is looked into.
#[test]
fn scenes_of_too_many_things_are_refused_at_once() {
    use veduta::figure::scene_file::{Options, parse};
    let head = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n";
    let sphere = "{ kind = \"sphere\", center = [0, 0, 5], radius = 3 }";
    let of = |key: &str, one: &str| format!("{key} = [{}]\n", vec![one; 100_000].join(", "));
    let lens = "[[lens]]\nname = \"l\"\neffects = [\"sepia\"]\n";
    let shape = format!("shape = {sphere}\n");
    for (name, text, said) in [
        (
            "lenses",
            (0..100_000).map(|i| format!("[[lens]]\nname = \"l{i}\"\n{shape}effects = [\"sepia\"]\n")).collect(),
            "lens: has 100000 entries; at most 4096",
        ),
        ("shapes", lens.to_owned() + &of("shapes", sphere), "shapes: has 100000 entries; at most 1024"),
        (
            "parts",
            format!("{lens}shape = {{ kind = \"union\", {} }}\n", of("shapes", sphere).trim_end()),
            "shape.shapes: has 100000 entries; at most 1024",
        ),
        (
            "effects",
            format!("[[lens]]\nname = \"l\"\n{shape}{}", of("effects", "\"sepia\"")),
            "effects: has 100000 entries; at most 1024",
        ),
    ] {
        let error = parse(&(head.to_owned() + &text), "t.toml", &Options::default()).expect_err(name).to_string();
        assert!(error.contains(said) && error.len() < 400, "{name}: {error:.400}");
    }
}
