//! What commands write: never in place of what they read, whole or not at all, through links and into pipes.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};

/// A folder of one test, removed at its end, with a scene, its city, a sheet and an animation.
struct Folder(PathBuf);

const CITY: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}]}},"vertices":[[0,0,0],[9,0,0],[0,0,9]]}"#;
const SCENE: &str = "veduta = 1\n[city]\nfiles = [\"city.city.json\"]\n";
const GLTF: &str = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"face.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#;
const OBJ: &str = "mtllib wall.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nv 0 0 0\nv 10 0 0\nv 10 0 10\nusemtl m\nf 1/1 2/2 3/3\n";

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-outputs-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder");
        let folder = Self(path);
        let mut texture = std::io::Cursor::new(Vec::new());
        image::RgbImage::new(2, 2).write_to(&mut texture, image::ImageFormat::Png).expect("an image");
        for (name, bytes) in [
            ("city.city.json", CITY.as_bytes()),
            ("scene.toml", SCENE.as_bytes()),
            ("sheet.toml", b"veduta_sheet = 1\nscene = \"scene.toml\"\n[[row]]\nname = \"a\"\n[[column]]\nname = \"b\"\nset = [\"sun.azimuth_deg=10\"]\n"),
            ("wall.obj", OBJ.as_bytes()),
            ("wall.mtl", b"newmtl m\nKd 1 1 1\nmap_Kd wall.png\n"),
            ("wall.toml", b"veduta = 1\n[city]\nfiles = [\"wall.obj\"]\n"),
            ("wall.sheet.toml", b"veduta_sheet = 1\nscene = \"wall.toml\"\n[[column]]\nname = \"wall\"\n"),
            ("0001.obj", OBJ.replace("wall.mtl", "0001.mtl").as_bytes()),
            ("0001.mtl", b"newmtl m\nKd 1 1 1\nmap_Kd 0001.png\n"),
            ("film.toml", b"veduta = 1\n[city]\nfiles = [\"0001.obj\"]\n[animation]\nfps = 2\ncamera = [{ at = 0, eye = [0, 0, 9], target = [4, 9, 0] }, { at = 1, eye = [8, 0, 9], target = [4, 9, 0] }]\n"),
            ("0001.png", texture.get_ref()),
            ("face.gltf", GLTF.as_bytes()),
            ("face.bin", &[0; 36]),
            ("wall.png", texture.get_ref()),
        ] {
            fs::write(folder.0.join(name), bytes).expect("a file");
        }
        folder
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = crate::program();
        command.args(arguments).current_dir(&self.0).stdin(Stdio::null()).env_remove("VEDUTA_DATA");
        command.output().expect("the program")
    }

    /// All files and what is in them.
    fn content(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let folders = [self.0.clone(), self.0.join("scenes")];
        let mut all: Vec<(PathBuf, Vec<u8>)> = folders
            .iter()
            .flat_map(|folder| fs::read_dir(folder).into_iter().flatten())
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.is_file())
            .map(|path| (path.clone(), fs::read(path).expect("a file")))
            .collect();
        all.sort();
        all
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[cfg(unix)]
#[test]
fn no_result_replaces_what_is_read() {
    let folder = Folder::new("inputs");
    std::os::unix::fs::symlink("city.city.json", folder.0.join("linked.json")).expect("a link");
    std::os::unix::fs::symlink("wall.png", folder.0.join("linked.png")).expect("a link");
    fs::hard_link(folder.0.join("city.city.json"), folder.0.join("same.json")).expect("a link");
    fs::copy(folder.0.join("city.city.json"), folder.0.join("samples.json")).expect("a copy");
    // The images of the gallery, where the program was cloned.
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    fs::create_dir(folder.0.join("scenes")).expect("a folder");
    for image in ["trapp-3-6-3-b.png", "trapp-5-3-3-a.png", "trapp-5-3-3-b.png"] {
        fs::copy(scenes.join(image), folder.0.join("scenes").join(image)).expect("a copy");
    }
    let before = folder.content();
    for arguments in [
        // The city, the scene, by other spellings and links.
        &["render", "scene.toml", "-o", "a.png", "--stats", "city.city.json"][..],
        &["render", "scene.toml", "-o", "a.png", "--stats", "./city.city.json"],
        &["render", "scene.toml", "-o", "a.png", "--stats", "linked.json"],
        &["render", "scene.toml", "-o", "a.png", "--stats", "same.json"],
        &["render", "scene.toml", "-o", "a.png", "--stats", "scene.toml"],
        &["render", "city.city.json", "-o", "a.png", "--stats", "city.city.json"],
        &["render", ".", "-o", "a.png", "--stats", "city.city.json"],
        // Textures of the city.
        &["render", "wall.obj", "-o", "wall.png"],
        &["render", "wall.obj", "-o", "linked.png"],
        &["render", "wall.obj", "-o", "a.png", "--aov", "normal=wall.png"],
        // What it names beside.
        &["render", "wall.obj", "-o", "a.png", "--stats", "wall.mtl"],
        &["render", "face.gltf", "-o", "a.png", "--stats", "face.bin"],
        &["info", "wall.obj", "--landmarks", "1", "--scene", "wall.mtl"],
        &["sheet", "wall.sheet.toml", "-o", "wall.png"],
        &["sheet", "wall.sheet.toml", "-o", "a.png", "--cells", "."],
        &["sheet", "wall.sheet.toml", "-o", "a.png", "--figures", "wall.mtl"],
        &["animate", "film.toml", "-o", "."],
        &["animate", "film.toml", "-o", "frames", "--stats", "0001.mtl"],
        &["measure", "samples", "-o", ".", "--city", "samples.json"],
        &["gallery", "trapp-3-6-3-b", "-o", "scenes"],
        // Two results for one file.
        &["render", "scene.toml", "-o", "a.png", "--aov", "normal=./a.png"],
        &["render", "scene.toml", "-o", "a.png", "--aov", "normal=b.png", "--aov", "object-id=b.png"],
        // The other commands.
        &["info", "city.city.json", "--landmarks", "1", "--scene", "city.city.json"],
        &["info", "city.city.json", "--landmarks", "1", "--scene", "linked.json"],
        &["sheet", "sheet.toml", "-o", "a.png", "--figures", "sheet.toml"],
        &["sheet", "sheet.toml", "-o", "a.png", "--figures", "scene.toml"],
        &["sheet", "sheet.toml", "-o", "a.png", "--figures", "city.city.json"],
        &["animate", "scene.toml", "-o", "frames", "--stats", "scene.toml"],
    ] {
        let output = folder.run(arguments);
        assert_eq!(code(&output), Some(2), "{arguments:?}: {}", said(&output));
        let is_told = said(&output).contains("is read, and would be replaced") || said(&output).contains("two results");
        assert!(is_told, "{arguments:?}: {}", said(&output));
        assert!(folder.content() == before, "{arguments:?} changed a file");
    }
}

#[cfg(unix)]
#[test]
fn a_result_that_nobody_takes_is_no_success() {
    let folder = Folder::new("pipe");
    let mut child = crate::program()
        .args(["render", "scene.toml", "-o", "-", "--size", "64x40", "--samples", "1"])
        .current_dir(&folder.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(code(&output), Some(1), "{}", said(&output));
    assert!(said(&output).contains("stdout"), "{}", said(&output));
}

fn parts(folder: &Path) -> usize {
    let names = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").file_name());
    names.filter(|name| name.to_string_lossy().contains(".part")).count()
}

/// A program that writes a file, and is in the middle of it.
#[cfg(unix)]
fn writing(folder: &Path) -> std::process::Child {
    let mut child = crate::program()
        .args(["synth", "--buildings", "2000000", "--seed", "1", "-o", "large.city.json"])
        .current_dir(folder)
        .stderr(Stdio::null())
        .spawn()
        .expect("the program");
    let started = Instant::now();
    while parts(folder) == 0 {
        assert!(started.elapsed() < Duration::from_secs(60), "nothing is written");
        assert!(child.try_wait().expect("a state").is_none(), "it has ended");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[cfg(unix)]
#[test]
fn a_program_that_is_ended_leaves_the_file_that_was_there_and_nothing_beside_it() {
    use std::os::unix::process::ExitStatusExt;
    let folder = Folder::new("ended");
    let target = folder.0.join("large.city.json");
    fs::write(&target, "before").expect("a file");
    for (signal, number, left) in [("TERM", 15, 0), ("INT", 2, 0), ("HUP", 1, 0), ("KILL", 9, 1)] {
        let mut child = writing(&folder.0);
        let kill = Command::new("sh").arg("-c").arg(format!("kill -{signal} {}", child.id())).status();
        assert!(kill.expect("a shell").success());
        assert_eq!(child.wait().expect("it ends").signal(), Some(number), "{signal}");
        assert_eq!(fs::read_to_string(&target).expect("the file"), "before", "{signal}");
        assert_eq!(parts(&folder.0), left, "{signal}");
    }
    // What could not be removed goes with the next result in this folder.
    let output = folder.run(&["synth", "--buildings", "5", "--seed", "1", "-o", "small.city.json"]);
    assert_eq!((code(&output), parts(&folder.0)), (Some(0), 0), "{}", said(&output));
}

/// The pixels of the first PNG in an SVG.
fn pixels_in(svg: &str) -> image::RgbImage {
    use base64::Engine;
    let data = svg.split("data:image/png;base64,").nth(1).and_then(|rest| rest.split('"').next()).expect("a picture");
    let png = base64::engine::general_purpose::STANDARD.decode(data).expect("base64");
    image::load_from_memory(&png).expect("a PNG").into_rgb8()
}

#[test]
fn figures_for_paper_hold_the_picture_and_text_over_it() {
    let folder = Folder::new("paper");
    let read = |name: &str| fs::read(folder.0.join(name)).expect(name);
    let done = |arguments: &[&str]| {
        let output = folder.run(arguments);
        assert_eq!(code(&output), Some(0), "{arguments:?}: {}", said(&output));
    };
    let small = ["--set", "figure.size_mm=[30, 20]", "--set", "figure.dpi=254"];
    done(&[&["render", "scene.toml", "-o", "plain.png"], &small[..]].concat());
    let titled = [&small[..], &["--set", "figure.title='A <triangle>'", "--set", "figure.text_px=12"]].concat();
    for out in ["a.svg", "b.svg", "a.pdf", "b.pdf"] {
        done(&[&["render", "scene.toml", "-o", out], &titled[..]].concat());
    }
    assert!(read("a.svg") == read("b.svg") && read("a.pdf") == read("b.pdf"), "the same scene is the same bytes");
    let plain = image::open(folder.0.join("plain.png")).expect("a picture").into_rgb8();
    assert_eq!(plain.dimensions(), (300, 200), "30 x 20 mm at 254 dots per inch");
    let svg = String::from_utf8(read("a.svg")).expect("text");
    assert!(
        svg.contains("width=\"30mm\" height=\"20mm\" viewBox=\"0 0 300 200\"")
            && svg.contains(">A &lt;triangle&gt;</text>")
    );
    assert!(pixels_in(&svg) == plain, "the picture without its title");
    let pdf = String::from_utf8_lossy(&read("a.pdf")).into_owned();
    assert!(
        pdf.starts_with("%PDF-1.7") && pdf.contains("/Width 300/Height 200") && pdf.contains("/Title(A <triangle>)")
    );
    // A size on the command line is one in pixels.
    done(&["render", "scene.toml", "-o", "c.svg", "--size", "100x50", "--set", "figure.column='single'"]);
    let svg = String::from_utf8(read("c.svg")).expect("text");
    assert!(
        svg.contains("width=\"8.4667mm\" height=\"4.2333mm\" viewBox=\"0 0 100 50\""),
        "100 x 50 pixels at 300 dots per inch"
    );
    // Sheets: the cells are pictures.
    for out in ["sheet.svg", "sheet.pdf", "sheet.png"] {
        done(&["sheet", "sheet.toml", "-o", out, "--set", "figure.size=[60, 40]", "--cells", "cells"]);
    }
    let svg = String::from_utf8(read("sheet.svg")).expect("text");
    let cell = image::open(folder.0.join("cells/a-b.png")).expect("a cell").into_rgb8();
    assert!(pixels_in(&svg) == cell && read("sheet.pdf").starts_with(b"%PDF"));
}

#[test]
fn what_no_figure_can_be_is_said() {
    let folder = Folder::new("formats");
    let refused = |arguments: &[&str], expected: i32, why: &str| {
        let output = folder.run(arguments);
        assert_eq!(code(&output), Some(expected), "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(why), "{arguments:?}: {}", said(&output));
    };
    for command in [["render", "scene.toml"], ["sheet", "sheet.toml"]] {
        let with = |out: &'static str| [&command[..], &["-o", out]].concat();
        refused(&with("a.eps"), 2, "a.eps: .eps cannot be written; .png, .pdf or .svg would be right");
        refused(&with("a"), 2, "a: names no format; .png, .pdf or .svg would be right");
    }
    let with = |set: &[&'static str]| {
        let sets = set.iter().flat_map(|set| ["--set", set]);
        ["render", "scene.toml", "-o", "a.pdf"].into_iter().chain(sets).collect::<Vec<_>>()
    };
    refused(
        &with(&["figure.dpi=2400", "figure.size_mm=[210, 297]"]),
        2,
        "210 x 297 mm at 2400 dpi are 19843 x 28063 pixels; 1 to 16384 on a side would be right, by another dpi or size_mm",
    );
    refused(&with(&["figure.column='single'", "figure.size_mm=[30, 20]"]), 2, "is given together with");
    refused(&with(&["figure.column='triple'"]), 2, "must be \"single\" or \"double\"");
    refused(&with(&["figure.north_arrow=[0.5, 1.5]"]), 2, "or [x, y], two numbers 0 to 1, is [0.5, 1.5]");
    refused(&with(&["figure.north_arrow='botom'"]), 2, "did you mean \"bottom\"?");
    assert!(!folder.0.join("a.pdf").exists());
}
