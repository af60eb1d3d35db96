//! The program as people and scripts meet it: the binary itself, its exit codes and its two streams.

use std::{
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use serde_json::{Value, json};

fn veduta(arguments: &[&str]) -> Command {
    let mut command = crate::program();
    command.args(arguments).env_remove("NO_COLOR").env_remove("VEDUTA_DATA").stdin(Stdio::null());
    command
}

fn run(arguments: &[&str]) -> Output {
    veduta(arguments).output().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("the program was killed")
}

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-cli-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str, content: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Two houses and a part; 10 × 20 × 3 m.
const CITY: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[100.0,200.0,0.0]},
"metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/7415"},
"CityObjects":{
"a":{"type":"Building","attributes":{"year":1900,"name":"old"},"children":["a1"]},
"a1":{"type":"BuildingPart","parents":["a"],"geometry":[{"type":"MultiSurface","lod":"2.0","boundaries":[[[0,1,2,3]],[[0,1,4]]],
"semantics":{"surfaces":[{"type":"RoofSurface"}],"values":[0,null]}}]},
"b":{"type":"Building","attributes":{"year":2000,"name":null}}},
"vertices":[[0,0,0],[10000,0,0],[10000,20000,0],[0,20000,0],[10000,0,3000],[99000,99000,99000]]}"#;

#[test]
fn help_and_version_are_no_failures() {
    for arguments in [&["--help"][..], &["--version"], &["info", "--help"], &["synth", "--help"]] {
        let output = run(arguments);
        assert_eq!(code(&output), 0, "{arguments:?}");
        assert!(!out(&output).is_empty() && err(&output).is_empty(), "{arguments:?}");
    }
    for command in ["info", "synth", "effects", "render", "sheet", "animate", "gallery", "measure"] {
        let help = out(&run(&[command, "--help"]));
        assert!(help.contains("Examples:"), "veduta {command} --help has no examples:\n{help}");
    }
}

#[test]
fn wrong_usage_is_code_two() {
    for arguments in [
        &["info"][..],
        &["info", "--no-such-option", "x.json"],
        &["synth", "--buildings", "many", "--seed", "1", "-o", "x.json"],
        &["synth", "--buildings", "5", "--seed", "1", "-o", "x.doc"],
        &["-v", "-q", "info", "x.json"],
        &["inof", "x.json"],
        &["nonsense"],
    ] {
        let output = run(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}: {}", err(&output));
        assert!(out(&output).is_empty(), "{arguments:?}");
        assert!(!err(&output).contains("panicked"), "{arguments:?}");
    }
    assert!(err(&run(&["inof", "x.json"])).contains("veduta info"), "a near miss is named");
    assert!(err(&run(&["nonsense"])).contains("info, synth"), "else the commands are listed");
}

#[test]
fn failures_are_code_one_and_one_message() {
    let folder = Folder::new("failures");
    let empty = folder.file("empty.json", "");
    let cut = folder.file("cut.json", &CITY[..CITY.len() / 3]);
    let picture = folder.file("picture.json", "\u{89}PNG\r\n\u{1a}\n");
    for (file, named) in [("/no/such/file.json", "file.json"), (&empty, "empty.json"), (&picture, "picture.json")] {
        let output = run(&["info", file]);
        assert_eq!(code(&output), 1, "{file}");
        assert!(out(&output).is_empty(), "{file}");
        let message = err(&output);
        assert!(message.starts_with("error: ") && message.contains(named), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    // What of a damaged file can be read is shown, or the place of the damage named.
    let output = run(&["info", &cut]);
    assert!(!err(&output).contains("panicked"), "{}", err(&output));
    assert!(code(&output) == 0 && out(&output).contains("truncated") || err(&output).contains("cut.json"));
}

#[test]
fn without_a_display_the_window_says_what_makes_a_picture() {
    let folder = Folder::new("no-display");
    let city = folder.file("a.city.json", CITY);
    for arguments in [&["view"][..], &["view", &city], &[&city], &[], &["builtin:square"]] {
        let output = without_display(arguments);
        assert_eq!(code(&output), 1, "{arguments:?}");
        assert!(err(&output).contains("veduta render"), "{arguments:?}: {}", err(&output));
    }
    for (arguments, named) in
        [(&["view", "no.city.json"][..], "no.city.json"), (&["view", "builtin:moon"], "builtin:square")]
    {
        let output = without_display(arguments);
        assert_eq!(code(&output), 1, "{arguments:?}");
        assert!(err(&output).contains(named), "{arguments:?}: {}", err(&output));
    }
    let output = without_display(&["view", "a.toml", "b.json"]);
    assert_eq!(code(&output), 2, "{}", err(&output));
}

fn without_display(arguments: &[&str]) -> Output {
    let mut command = crate::program();
    command.args(arguments).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap()
}

#[test]
fn info_as_json_is_the_object_of_the_contract() {
    let folder = Folder::new("json");
    let output = run(&["info", "--json", "--list", &folder.file("a.city.json", CITY)]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let facts: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys: Vec<_> = facts.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "format",
        "version",
        "crs",
        "crs_raw",
        "extent",
        "objects",
        "lods",
        "attributes",
        "joins",
        "timetables",
        "time",
    ];
    assert_eq!(keys, [&expected[..], &["textures", "faces_dropped", "warnings"]].concat());
    assert_eq!((&facts["joins"], &facts["time"]), (&json!([]), &Value::Null));
    assert_eq!(facts["crs"], "EPSG:7415");
    assert_eq!(facts["extent"], json!({"min": [100.0, 200.0, 0.0], "max": [110.0, 220.0, 3.0]}));
    assert_eq!(facts["objects"]["by_type"], json!({"Building": 2, "BuildingPart": 1}));
    let extent = json!({"min": [100.0, 200.0, 0.0], "max": [110.0, 220.0, 3.0]});
    let part = json!({"id": "a1", "type": "BuildingPart", "parents": ["a"], "lods": ["2"], "extent": extent});
    assert_eq!(facts["objects"]["list"][1], part);
    assert_eq!(facts["objects"]["list"][0]["extent"], extent, "that of its part");
    assert_eq!(facts["objects"]["list"][2]["extent"], Value::Null, "no geometry");
    assert_eq!(facts["lods"], json!({"2": {"objects": 1, "polygons": 2, "triangles": 3}}));
    let year =
        json!({"count": 2, "nulls": 0, "type": "integer", "min": 1900, "max": 2000, "values": [[1900, 1], [2000, 1]]});
    assert_eq!(facts["attributes"]["year"], year);
    assert_eq!(facts["attributes"]["name"]["nulls"], 1);
}

#[test]
fn info_names_the_objects_of_which_an_expression_is_true() {
    let folder = Folder::new("where");
    let file = folder.file("a.city.json", CITY);
    for (text, expected) in [
        ("year < 1950", vec!["a", "a1"]),
        ("not year < 1950 and type = building", vec!["b"]),
        ("type = BuildingPart or year in 1999..", vec!["a1", "b"]),
        ("geometry.height = 3", vec!["a", "a1"]),
        ("year > 3000", vec![]),
    ] {
        let output = run(&["info", "--json", "--where", text, &file]);
        assert_eq!(code(&output), 0, "{text}: {}", err(&output));
        let facts: Value = serde_json::from_slice(&output.stdout).unwrap();
        let list = facts["objects"]["list"].as_array().unwrap();
        let ids: Vec<&str> = list.iter().map(|object| object["id"].as_str().unwrap()).collect();
        assert_eq!(ids, expected, "{text}");
    }
    for (text, wanted, message) in [
        (
            "yaer < 1950",
            1,
            "--where: column 1: no object of the city has the attribute \"yaer\"; did you mean \"year\"?",
        ),
        ("year < 1950 and", 2, "--where: column 16: a name is missing here"),
    ] {
        let output = run(&["info", "--where", text, &file]);
        assert_eq!(code(&output), wanted, "{text}");
        assert!(err(&output).contains(message), "{text}: {}", err(&output));
    }
}

#[test]
fn info_as_text_fits_and_names_what_is_there() {
    let folder = Folder::new("text");
    let file = folder.file("a.city.json", CITY);
    let text = out(&run(&["info", &file]));
    for part in ["EPSG:7415", "└ BuildingPart", "RoofSurface", "1900 … 2000", "Warnings"] {
        assert!(text.contains(part), "{part} is missing in:\n{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(!text.contains('\u{1b}'), "no colours in a pipe");
    assert!(out(&run(&["info", "--list", &file])).lines().any(|line| line.contains("a1")
        && line.contains("BuildingPart")
        && line.contains("[105.00, 210.00, 1.50]")
        && line.contains("10.00 × 20.00 × 3.00 m")));
}

#[test]
fn several_files_make_one_city() {
    let folder = Folder::new("several");
    let (a, b) = (folder.file("a.city.json", CITY), folder.file("b.city.json", CITY));
    let facts: Value = serde_json::from_slice(&run(&["info", "--json", "--list", &a, &b]).stdout).unwrap();
    assert_eq!(facts["objects"]["total"], 6);
    assert_eq!(facts["objects"]["list"][3]["id"], "a#2");
    assert_eq!(facts["objects"]["list"][4]["parents"], json!(["a#2"]), "links stay within their file");
    assert_eq!(facts["warnings"][0]["code"], "duplicate-id");
    assert_eq!(facts["warnings"][0]["count"], 3);
}

#[test]
fn a_dash_is_stdin_and_stdout() {
    let made = run(&["synth", "--buildings", "20", "--seed", "4", "-o", "-"]);
    assert_eq!(code(&made), 0);
    let mut child = veduta(&["info", "--json", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(&made.stdout).unwrap();
    let facts: Value = serde_json::from_slice(&child.wait_with_output().unwrap().stdout).unwrap();
    assert_eq!(facts["objects"]["by_type"]["Building"], 20);
    assert_eq!(facts["warnings"], json!([]));
}

#[test]
fn synth_writes_every_format_by_its_ending() {
    let folder = Folder::new("endings");
    let facts = |name: &str| -> Value {
        let file = folder.path(name);
        let output = run(&["synth", "--buildings", "60", "--seed", "9", "-o", &file]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        serde_json::from_slice(&run(&["info", "--json", &file]).stdout).unwrap()
    };
    let plain = facts("a.city.json");
    for name in ["a.city.json.gz", "a.city.jsonl", "a.city.jsonl.gz"] {
        let other = facts(name);
        for key in ["extent", "objects", "lods", "attributes", "warnings"] {
            assert_eq!(other[key], plain[key], "{name}: {key}");
        }
    }
    assert_eq!(&std::fs::read(folder.path("a.city.json.gz")).unwrap()[..2], [0x1f, 0x8b]);
}

#[test]
fn a_reader_that_leaves_has_read_enough_and_has_no_file() {
    let folder = Folder::new("leaves");
    let large = folder.path("large.city.json");
    assert_eq!(code(&run(&["synth", "--buildings", "3000", "--seed", "1", "-o", &large])), 0);
    let left = |arguments: &[&str]| {
        let mut child = veduta(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        (code(&output), err(&output))
    };
    assert_eq!(left(&["info", "--json", "--list", &large]), (0, String::new()));
    let (code, said) = left(&["synth", "--buildings", "5000", "--seed", "1", "-o", "-"]);
    assert!(code == 1 && said.contains("stdout"), "{code}: {said}");
}

#[test]
fn what_cannot_be_written_leaves_nothing() {
    let folder = Folder::new("unwritable");
    let output = run(&["synth", "--buildings", "5", "--seed", "1", "-o", &folder.path("no/such/folder/a.json")]);
    assert_eq!(code(&output), 1);
    assert!(err(&output).contains("folder"), "{}", err(&output));
    let a = folder.path("a.json");
    for wrong in ["5", "100001"] {
        let full = run(&["synth", "--detail", "full", "--buildings", wrong, "--seed", "1", "-o", &a]);
        assert_eq!(code(&full), 2);
        assert!(err(&full).contains("100 to 100000 buildings"), "{}", err(&full));
    }
    let plain = run(&["synth", "--buildings", "5", "--seed", "1", "--timetable", &folder.path("a.csv"), "-o", &a]);
    assert_eq!(code(&plain), 2);
    assert!(err(&plain).contains("--detail full"), "{}", err(&plain));
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 0);
}

#[test]
fn a_city_in_full_comes_with_a_timetable() {
    let folder = Folder::new("full");
    let (city, day) = (folder.path("a.city.jsonl.gz"), folder.path("a.csv"));
    let full = ["synth", "--detail", "full", "--buildings", "100", "--seed", "1", "--timetable", &day, "-o", &city];
    assert_eq!(code(&run(&full)), 0);
    let table = std::fs::read_to_string(&day).unwrap();
    assert!(table.starts_with("id,t,x,y,z,yaw,scale\ntram-1,2025-06-01T05:00:00,"), "{}", &table[..80]);
    let info = run(&["info", &city]);
    let said = String::from_utf8_lossy(&info.stdout);
    assert!(said.contains("BuildingStorey") && said.contains("Warnings    none"), "{said}");
}

#[test]
fn quiet_is_quiet_and_verbose_says_what_it_does() {
    let folder = Folder::new("levels");
    let file = folder.file("a.city.json", CITY);
    assert_eq!(err(&run(&["-q", "info", &file])), "");
    assert_eq!(err(&run(&["info", &file])), "");
    assert!(err(&run(&["info", "-v", &file])).contains("3 objects"));
    let colourless = veduta(&["info", "-v", &file]).env("NO_COLOR", "1").output().unwrap();
    assert!(!err(&colourless).contains('\u{1b}'));
}

#[test]
fn messages_do_not_name_the_build() {
    let output = run(&["info", Path::new("x").join("missing.json").to_str().unwrap()]);
    assert!(!err(&output).contains("src/"), "{}", err(&output));
}

#[test]
fn effects_are_listed() {
    let listed: Value = serde_json::from_slice(&run(&["effects", "--json"]).stdout).unwrap();
    let names: Vec<_> = listed.as_array().unwrap().iter().map(|effect| effect["name"].as_str().unwrap()).collect();
    for name in ["greyscale", "sepia", "thematic"] {
        assert!(names.contains(&name), "{name}");
    }
    let thematic = out(&run(&["effects", "thematic"]));
    assert!(thematic.contains("attribute") && !thematic.contains("sepia"), "{thematic}");
    assert_eq!(code(&run(&["effects", "sepai"])), 2);
}

/// Pixels of a PNG, row by row.
fn pixels(file: &str) -> (u32, u32, Vec<[u8; 4]>) {
    let image = image::open(file).unwrap().into_rgba8();
    (image.width(), image.height(), image.pixels().map(|p| p.0).collect())
}

#[test]
fn a_picture_with_everything_that_comes_with_it() {
    let folder = Folder::new("render");
    let city = folder.file("a.city.json", CITY);
    let path = |name: &str| folder.path(name);
    let (ids, depth, mask) = (path("ids.png"), path("depth.exr"), path("mask.png"));
    let output = run(&[
        "render",
        &city,
        "-o",
        &path("a.png"),
        "--size",
        "96x64",
        "--aov",
        &format!("object-id={ids}"),
        "--aov",
        &format!("depth={depth}"),
        "--aov",
        &format!("lens-mask={mask}"),
        "--stats",
        &path("stats.json"),
        "--set",
        "lens.0={shape={kind=\"sphere\",center=[105,210,0],radius=100},effects=[\"sepia\"]}",
    ]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let (width, height, picture) = pixels(&path("a.png"));
    assert_eq!((width, height), (96, 64));
    assert!(picture.iter().any(|p| *p != picture[0]), "an empty picture");
    // The only object with geometry is the second: index 1, written as 2.
    let ids = pixels(&ids).2;
    let seen: std::collections::BTreeSet<u32> =
        ids.iter().map(|[r, g, b, _]| u32::from(*r) << 16 | u32::from(*g) << 8 | u32::from(*b)).collect();
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), [0, 2]);
    let object = ids.iter().filter(|p| p[2] == 2).count() as u64;
    let stats: Value = serde_json::from_slice(&std::fs::read(path("stats.json")).unwrap()).unwrap();
    assert_eq!(stats["city"]["objects"], 1);
    let lens = &stats["lenses"][0];
    assert_eq!(lens["kind"], "color");
    assert!(lens["covered"].as_u64().unwrap() >= object, "the lens holds the whole object");
    for key in ["adapter", "load", "city", "frame", "passes", "pipelines", "handlers", "lenses", "overlays", "warnings"]
    {
        assert!(!stats[key].is_null(), "{key} is missing");
    }
    assert!(std::fs::metadata(&depth).unwrap().len() > 0 && Path::new(&mask).exists());
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 6, "nothing half-written is left");
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let folder = Folder::new("bytes");
    let city = folder.file("a.city.json", CITY);
    let scene = folder.file("scene.toml", "veduta = 1\ncity.files = [\"a.city.json\"]\nfigure.size = [64, 48]\n");
    let bytes = |input: &str, name: &str| {
        let file = folder.path(name);
        let output = run(&["render", input, "-o", &file, "--size", "64x48"]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        std::fs::read(&file).unwrap()
    };
    assert_eq!(bytes(&scene, "1.png"), bytes(&scene, "2.png"));
    bytes(&city, "3.png");
    assert_eq!(pixels(&folder.path("1.png")), pixels(&folder.path("3.png")), "a scene of the city alone");
}

#[test]
fn what_render_cannot_do_is_said_before_it_draws() {
    let folder = Folder::new("refused");
    let city = folder.file("a.city.json", CITY);
    let scene = folder.file("scene.toml", "veduta = 1\ncity.files = [\"a.city.json\"]\n");
    let picture = folder.path("a.png");
    let wrong = |extra: &[&str], expected: i32, named: &str| {
        let output = run(&[&["render"], extra].concat());
        assert_eq!(code(&output), expected, "{extra:?}: {}", err(&output));
        assert!(err(&output).contains(named), "{extra:?}: {}", err(&output));
        assert!(!Path::new(&picture).exists());
    };
    wrong(&[&city, "-o", &picture, "--size", "0x9"], 2, "--size");
    wrong(&[&city, "-o", &picture, "--samples", "0"], 2, "--samples");
    wrong(&[&city, "-o", &picture, "--aov", "colour=x.png"], 2, "object-id");
    wrong(&[&city, "-o", &picture, "--set", "lens.0.shape.radius=80"], 2, "lens");
    wrong(&[&city, "-o", &picture, "--set", "nonsense"], 2, "PATH=VALUE");
    wrong(&[&scene, &city, "-o", &picture], 2, "scene");
    wrong(&[&city, "-o", &folder.path("a.jpg")], 2, ".jpg cannot be written; .png, .pdf or .svg would be right");
    wrong(&["/no/such.toml", "-o", &picture], 1, "such.toml");
    let misspelt = folder.file("b.toml", "veduta = 1\n[camra]\n");
    wrong(&[&misspelt, "-o", &picture], 1, "camera");
    let mut many = vec!["render", city.as_str(), "-o", picture.as_str(), "--aov", "lens-mask=m.png"];
    let lenses: Vec<String> =
        (0..17).map(|i| format!("--set=lens.{i}={{shape={{kind=\"sphere\",center=[0,0,0],radius=1}}}}")).collect();
    many.extend(lenses.iter().map(String::as_str));
    wrong(&many[1..], 2, "exr");
}

#[test]
fn what_is_not_there_is_named_with_who_asks_for_it() {
    let folder = Folder::new("absent");
    folder.file("a.city.json", CITY);
    let scene = folder.file("s.toml", "veduta = 1\n[city]\nfiles = [\n\"a.city.json\",\n\"nope.json\"]\n");
    let (picture, none) = (folder.path("a.png"), folder.path("nope.json"));
    let refused = |arguments: &[&str], expected: &str| {
        let output = run(arguments);
        assert_eq!(code(&output), 1, "{}", err(&output));
        assert_eq!(err(&output), format!("error: {expected}\n"), "{arguments:?}");
    };
    let expected = format!("{scene}:5: [city] files.1: there is no file or folder \"nope.json\" ({none})");
    refused(&["render", &scene, "-o", &picture], &expected);
    refused(&["animate", &scene, "-o", &folder.path("frames")], &expected);
    refused(&["shader", &scene], &expected);
    let sheet = folder.file("s.sheet.toml", "veduta_sheet = 1\nscene = \"s.toml\"\n[[row]]\nname = \"a\"\n");
    refused(&["sheet", &sheet, "-o", &picture], &format!("{sheet}: scene: {expected}"));
    let effects = folder.path("effects");
    let expected = format!("--effects {effects}: cannot be read: No such file or directory (os error 2)");
    refused(&["effects", "--effects", &effects], &expected);
}

#[test]
fn where_results_go_is_looked_at_before_the_city_is() {
    let folder = Folder::new("before");
    let city = folder.file("a.city.json", "this is no city");
    let scene = folder.file("s.toml", &format!("veduta = 1\ncity.files = [\"a.city.json\"]\n{ANIMATION}"));
    let sheet = folder.file("s.sheet.toml", "veduta_sheet = 1\nscene = \"s.toml\"\n[[row]]\nname = \"a\"\n");
    let (good, none) = (folder.path("a.png"), folder.path("none"));
    let refused = |arguments: &[&str], file: &str| {
        let output = run(arguments);
        assert_eq!(code(&output), 1, "{}", err(&output));
        assert_eq!(err(&output), format!("error: {file}: the folder {none} does not exist; make it first\n"));
    };
    let inside = |name: &str| folder.path(&format!("none/{name}"));
    let (png, exr, json) = (inside("x.png"), inside("x.exr"), inside("x.json"));
    refused(&["render", &city, "-o", &png], &png);
    refused(&["render", &scene, "-o", &png], &png);
    refused(&["render", &city, "-o", &good, "--stats", &json], &json);
    refused(&["render", &city, "-o", &good, "--aov", &format!("depth={exr}")], &exr);
    refused(&["render", &scene, "-o", &good, "--sprite", &format!("a={exr}")], &exr);
    refused(&["sheet", &sheet, "-o", &png], &png);
    refused(&["sheet", &sheet, "-o", &good, "--figures", &json], &json);
    refused(&["animate", &scene, "-o", &folder.path("frames"), "--stats", &json], &json);
    // A folder is no file; and what is right goes on to the city.
    let output = run(&["render", &city, "-o", &good, "--stats", folder.0.to_str().unwrap()]);
    assert_eq!(code(&output), 2, "{}", err(&output));
    let output = run(&["render", &city, "-o", &good]);
    assert!(err(&output).contains("a.city.json"), "{}", err(&output));
}

/// A lens, and two pictures of its scene.
const ANIMATION: &str = "[[lens]]
name = \"a\"
shape = { kind = \"sphere\", center = [0, 0, 0], radius = 9 }
[animation]
frames = 2
camera = [{ at = 0, eye = [0, -9, 9], target = [0, 0, 0] }, { at = 1, eye = [9, -9, 9], target = [0, 0, 0] }]
";

#[test]
fn a_picture_goes_to_stdout_too() {
    let folder = Folder::new("stdout");
    let output = run(&["render", &folder.file("a.city.json", CITY), "-o", "-", "--size", "8x8"]);
    assert_eq!(&output.stdout[..8], b"\x89PNG\r\n\x1a\n");
}

#[test]
fn the_gallery_draws_or_says_why_not() {
    let folder = Folder::new("gallery");
    let output = run(&["gallery", "-o", &folder.path("new/out"), "vienna-roofs"]);
    assert_eq!((code(&output), out(&output).trim().contains("skipped: data absent")), (0, true), "{}", err(&output));
    let output = run(&["gallery", "-o", &folder.path("out"), "no-such-scene"]);
    assert_eq!(code(&output), 2);
}

#[test]
fn every_scene_ships_and_reads() {
    let listed: Vec<&str> = veduta::cli::gallery::SCENES.iter().map(|(name, _)| *name).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    files.sort();
    let files_there = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap());
    let files_there = files_there.filter(|entry| entry.file_type().unwrap().is_file());
    let mut images: Vec<String> = files_there.map(|entry| entry.file_name().into_string().unwrap()).collect();
    images.retain(|name| !name.ends_with(".toml"));
    images.sort();
    let known: Vec<&str> = veduta::cli::gallery::IMAGES.iter().map(|(name, _)| *name).collect();
    assert_eq!(known, images, "images that ship");
    let (sheets, files): (Vec<String>, Vec<String>) = files.into_iter().partition(|name| name.ends_with(".sheet"));
    assert_eq!(listed, files);
    let named: Vec<String> = veduta::cli::gallery::SHEETS.iter().map(|(name, _)| format!("{name}.sheet")).collect();
    assert_eq!(named, sheets);
    for (name, text) in veduta::cli::gallery::SHEETS {
        assert!(!listed.contains(name), "{name} is the name of a scene too");
        let sheet = veduta::figure::sheet::file::parse(text, name).unwrap();
        let file = folder.join(&sheet.scene);
        let options = veduta::figure::scene_file::Options::for_file(&file);
        let scene = match veduta::figure::scene_file::read(&file, &options) {
            Err(error) if error.is_data_absent => continue,
            read => read.unwrap(),
        };
        let cells = veduta::figure::sheet::cells(&sheet, &scene, name, &options);
        assert!(cells.is_ok(), "{}", cells.unwrap_err());
    }
    for name in listed {
        let file = folder.join(name).with_extension("toml");
        let mut options = veduta::figure::scene_file::Options::for_file(&file);
        options.data = Some("/data".into());
        let scene = veduta::figure::scene_file::read(&file, &options);
        assert!(scene.is_ok(), "{}", scene.unwrap_err());
    }
}

/// What a machine may lack is said in one line, whatever the command; what needs it not goes on.
#[test]
fn a_poor_machine_gets_one_line() {
    let folder = Folder::new("poor");
    let house = folder.file("house.city.json", CITY);
    let [picture, animation] = ["house.png", "frames"].map(|name| folder.path(name));
    let no_driver = |arguments: &[&str]| {
        let mut command = veduta(arguments);
        for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            command.env(name, "/nonexistent/driver.json");
        }
        // A fault of the program would be told at length otherwise.
        command.env_remove("RUST_BACKTRACE").env_remove("VEDUTA_ADAPTER").output().unwrap()
    };
    let scene =
        folder.file("scene.toml", "veduta = 1\n[city]\nfiles = [\"house.city.json\"]\n[animation]\nframes = 2\n");
    for arguments in [
        &["render", &house, "-o", &picture][..],
        &["animate", &scene, "-o", &animation],
        &["measure", "handlers", "-o", &animation],
    ] {
        let output = no_driver(arguments);
        let said = err(&output);
        let errors: Vec<&str> = said.lines().filter(|line| !line.starts_with("note:")).collect();
        assert_eq!((code(&output), errors.len()), (1, 1), "{arguments:?}: {said}");
        let is_told = errors[0].starts_with("error: ") && errors[0].contains("mesa-vulkan-drivers");
        assert!(is_told && !said.contains("panicked"), "{arguments:?}: {said}");
        assert!(!Path::new(&picture).exists(), "{arguments:?}");
    }
    assert_eq!(code(&no_driver(&["info", &house])), 0, "what draws nothing needs none");
    // No home, or one that is not there.
    for (name, value) in [("HOME", None), ("HOME", Some("/nonexistent")), ("XDG_CONFIG_HOME", Some("/nonexistent"))] {
        let mut command = veduta(&["render", &house, "-o", &picture, "--size", "40x30", "-q"]);
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
        let output = command.output().unwrap();
        assert_eq!((code(&output), err(&output).as_str()), (0, ""), "{name}: {value:?}");
    }
}

#[test]
fn too_much_memory_ends_with_a_line() {
    let folder = Folder::new("memory");
    let city = folder.path("many.city.json");
    assert_eq!(code(&run(&["synth", "--buildings", "30000", "--seed", "1", "-o", &city, "-q"])), 0);
    let picture = folder.path("many.png");
    let output = run(&["render", &city, "-o", &picture, "--size", "64x40", "--memory", "130M", "-q"]);
    let said = err(&output);
    assert_eq!((code(&output), said.lines().count()), (1, 1), "{said}");
    assert!(said.starts_with("error: ") && said.contains("--memory allows, 130 MiB"), "{said}");
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 1, "nothing half-written stays");
    assert_eq!(code(&run(&["info", &city, "--memory", "4G", "-q"])), 0);
    let output = run(&["info", &city, "--memory", "much"]);
    assert_eq!(code(&output), 2);
    assert!(err(&output).contains("4G"), "{}", err(&output));
}

/// A point of interest or an attribute that is not there is no picture, in every command, and told once.
#[test]
fn what_a_scene_is_about_has_to_be_there() {
    let folder = Folder::new("about");
    folder.file("a.city.json", CITY);
    let head = "veduta = 1\n[city]\nfiles = [\"a.city.json\"]\n[animation]\nframes = 2\n";
    let poi = folder.file("poi.toml", &format!("{head}[[poi]]\nname = \"p\"\nobject = \"a2\"\n"));
    let thematic = "[style]\neffects = [{ effect = \"thematic\", attribute = \"yaer\" }]\n";
    let attribute = folder.file("attribute.toml", &format!("{head}{thematic}"));
    let both = folder.file("both.toml", &format!("{head}{thematic}[[poi]]\nname = \"p\"\nobject = \"a2\"\n"));
    let no_object = "scene: [poi.0] object: the city has no object \"a2\"; did you mean \"a\"?";
    let no_attribute =
        "scene: [style] effects.0.attribute: no object of the city has the attribute \"yaer\"; did you mean \"year\"?";
    let [picture, frames] = ["a.png", "frames"].map(|name| folder.path(name));
    for (scene, told) in [(&poi, &[no_object][..]), (&attribute, &[no_attribute]), (&both, &[no_attribute, no_object])]
    {
        let sheet =
            folder.file("a.sheet.toml", &format!("veduta_sheet = 1\nscene = {scene:?}\n[[row]]\nname = \"r\"\n"));
        for arguments in [
            &["render", scene, "-o", &picture][..],
            &["animate", scene, "-o", &frames],
            &["shader", scene],
            &["sheet", &sheet, "-o", &picture, "--allow-outside"],
        ] {
            let output = run(arguments);
            let expected: String = told.iter().map(|message| format!("error: {message}\n")).collect();
            assert_eq!((code(&output), err(&output)), (1, expected), "{arguments:?}");
        }
    }
    assert!(!Path::new(&picture).exists() && !Path::new(&frames).join("0000.png").exists());
}

/// A picture from below the ground, or from within a house, says so: it is black or walls, and nothing else tells why.
#[test]
fn an_eye_where_nobody_stands_is_told() {
    let folder = Folder::new("eye");
    let picture = folder.path("x.png");
    let said = |eye: &str| {
        let eye = format!("camera.eye=[{eye}]");
        let of = ["render", "builtin:square", "-o", &picture, "--size", "32x24"];
        let camera = ["--set", &eye, "--set", "camera.target=[0, 0, 3]"];
        let output = run(&[&of[..], &camera].concat());
        assert_eq!(code(&output), 0);
        err(&output)
    };
    let below = said("20, -40, -3");
    assert!(below.contains("m below the ground") && !below.contains("in building"), "{below}");
    let within = said("-60, -14, 3");
    assert!(within.contains("the eye is in building \"church\"") && !within.contains("below the ground"), "{within}");
    let free = said("20, -40, 12");
    assert!(!free.contains("the eye is"), "{free}");
}
