//! `veduta measure gpu`: a report that is whole, and failures that are told after it is written.

use std::{
    path::{Path, PathBuf},
    process::{Output, Stdio},
};

use serde_json::Value;

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn folder(name: &str) -> Folder {
    Folder(std::env::temp_dir().join(format!("veduta-gpu-{name}-{}", std::process::id())))
}

fn run(output: &Path, arguments: &[&str]) -> Output {
    let mut command = crate::program();
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["measure", "gpu", "-o", output.to_str().unwrap()]);
    command.args(arguments).env_remove("VEDUTA_DATA").stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Both files.
fn report(folder: &Folder) -> (String, Value) {
    let read = |extension: &str| std::fs::read_to_string(folder.0.join(format!("gpu.{extension}"))).unwrap();
    (read("md"), serde_json::from_str(&read("json")).unwrap())
}

#[test]
fn a_short_probe_says_what_it_found() {
    let folder = folder("short");
    let only = ["--only", "coplanar faces", "--only", "room for layers", "--only", "town", "--only", "V1 lens"];
    let frames = ["--city", "builtin:square", "--size", "64x36", "--pairs", "3"];
    let output = run(&folder.0, &[&only[..], &frames].concat());
    let told = text(&output.stderr);
    let (table, json) = report(&folder);
    let is_software = json["is_software"].as_bool().unwrap();
    if is_software {
        assert_eq!(output.status.code(), Some(0), "{told}");
        assert!(told.contains("is a software adapter") && table.contains("**This is a software adapter"), "{told}");
        assert_eq!(json["failures"], Value::Array(Vec::new()));
    }
    assert!(table.contains(json["adapter"]["name"].as_str().unwrap()));
    let names = |of: &Value, key: &str| -> Vec<String> {
        of.as_array().unwrap().iter().map(|row| row[key].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names(&json["checks"], "name"), ["coplanar faces", "room for layers"]);
    assert_eq!(names(&json["pictures"], "scene"), ["town"]);
    assert_eq!(names(&json["frames"]["rows"], "name"), ["V1 plain", "V1 lens"]);
    for check in json["checks"].as_array().unwrap() {
        assert!(["property", "oracle"].iter().all(|key| check[*key].as_str().is_some_and(|said| !said.is_empty())));
        assert!(check["tried"].as_u64().unwrap() > 0 && check["verdict"].is_string(), "{check}");
        assert!(table.contains(check["property"].as_str().unwrap()));
    }
    assert_eq!((&json["frames"]["rounds"], &json["frames"]["rows"][0]["ratio"]["median"]), (&3.into(), &1.0.into()));
    assert!(json["frames"]["rows"][1]["ms"]["median"].as_f64().unwrap() > 0.0);
    assert!(json["seconds"].as_f64().unwrap() < json["limit_seconds"].as_f64().unwrap());
}

#[test]
fn references_that_differ_or_are_missing_are_told() {
    let (folder, scenes) = (folder("differs"), folder("scenes"));
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    std::fs::create_dir_all(scenes.0.join("references")).unwrap();
    for name in ["town", "first-lens"] {
        std::fs::copy(shipped.join(format!("{name}.toml")), scenes.0.join(format!("{name}.toml"))).unwrap();
    }
    // The picture of another scene.
    std::fs::copy(shipped.join("references/first-lens.png"), scenes.0.join("references/town.png")).unwrap();
    let place = scenes.0.to_str().unwrap();
    let output = run(&folder.0, &["--scenes", place, "--only", "town", "--only", "first-lens"]);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    let line = |part: &str| told.lines().any(|line| line.contains(part));
    assert!(line("2 of 2 fail") && line("town: ") && line("pixels are off by more than 2 of 255"), "{told}");
    assert!(line("first-lens: ") && line("--write-references"), "{told}");
    let (table, json) = report(&folder);
    assert_eq!(json["failures"].as_array().unwrap().len(), 2);
    assert!(json["pictures"][0]["wrong"].as_u64().unwrap() > 100 && table.contains("| town | differs |"), "{table}");
}

#[test]
fn what_has_no_time_is_left_out_and_said() {
    let folder = folder("no-time");
    let output = run(&folder.0, &["--minutes", "0"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let (table, json) = report(&folder);
    assert!(json["checks"].as_array().unwrap().is_empty() && json["frames"].is_null());
    assert!(json["skipped"].as_array().unwrap().len() > 20 && table.contains("- seams: no time was left of 0 s"));
}
