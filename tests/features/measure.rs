//! `veduta measure` as people and scripts meet it: four files that other programs can read, and that agree.

use std::{
    path::PathBuf,
    process::{Output, Stdio},
    sync::Arc,
};

use serde_json::Value;
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    gpu::Gpu,
    measure::{
        self, TOPICS, Variant,
        difference::{Against, Difference},
        stage::Stage,
        topic::Exact,
    },
    render::picture::Studio,
    scene::{CitySpec, Transparency},
};

fn run(arguments: &[&str]) -> Output {
    let mut command = crate::program();
    command.args(arguments).env_remove("VEDUTA_DATA").stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn folder(name: &str) -> Folder {
    Folder(std::env::temp_dir().join(format!("veduta-measure-{name}-{}", std::process::id())))
}

/// The files of a tiny run of one topic; its JSON.
fn tiny_run(topic: &str) -> (Folder, Value) {
    let folder = folder(topic);
    let place = folder.0.to_str().unwrap();
    let size = ["--pairs", "3", "--size", "64x36"];
    let output = run(&[&["measure", topic, "-o", place, "--json", "--city", "builtin:square"], &size[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let mut names: Vec<String> =
        std::fs::read_dir(&folder.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["json", "md", "png", "svg"].map(|extension| format!("{topic}.{extension}")));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let file: Value = serde_json::from_slice(&std::fs::read(folder.0.join(format!("{topic}.json"))).unwrap()).unwrap();
    assert_eq!(json, file, "stdout and file say the same");
    (folder, json)
}

fn check_files(folder: &Folder, topic: &str, json: &Value) {
    let read = |extension: &str| std::fs::read(folder.0.join(format!("{topic}.{extension}"))).unwrap();
    let variants = json["variants"].as_array().unwrap();
    let svg = text(&read("svg"));
    let document = resvg::usvg::roxmltree::Document::parse(&svg).unwrap();
    let drawn: Vec<&str> = document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).collect();
    assert!(drawn.contains(&json["topic"]["title"].as_str().unwrap()));
    let table = text(&read("md"));
    assert_eq!(table.lines().filter(|line| line.starts_with('|')).count(), 2 + variants.len());
    for variant in variants {
        assert!(table.contains(variant["label"].as_str().unwrap()));
        for key in ["ms", "ratio", "start_ms"] {
            let at = |end: &str| variant[key][end].as_f64().unwrap();
            assert!(at("low") <= at("median") && at("median") <= at("high"), "{key} of {variant}");
        }
        assert!(variant["gpu_bytes"].as_u64().unwrap() > 0);
    }
    assert!(table.contains(&format!("{topic}.svg")));
    assert!(variants.iter().any(|v| v["is_pareto"] == true));
    let png = png::Decoder::new(std::io::Cursor::new(read("png"))).read_info().unwrap();
    assert!(png.info().width == 1520 && png.info().height >= 1000, "{:?}", png.info().size());
}

#[test]
fn samples() {
    let (folder, json) = tiny_run("samples");
    check_files(&folder, "samples", &json);
    let of = |key: &str| -> Vec<f64> {
        json["variants"].as_array().unwrap().iter().map(|v| v["difference"][key].as_f64().unwrap()).collect()
    };
    // One sample shows stairs that 64 do not; half as many samples again and again come closer.
    for key in ["flip", "mean_steps"] {
        let errors = of(key);
        assert_eq!(errors.len(), 6);
        assert!(errors[0] > 2.0 * errors[4] && errors[5] > 0.0, "{key}: {errors:?}");
    }
    let counts: Vec<_> = json["variants"].as_array().unwrap().iter().map(|v| v["knobs"]["samples"].clone()).collect();
    assert_eq!(counts, [1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
}

#[test]
fn sprites() {
    let model = load(&["builtin:square".into()], &LoadOptions::default(), &Quiet).unwrap();
    let mut studio =
        Studio::new(Gpu::open().unwrap(), Arc::new(model), &CitySpec { ground: false, ..CitySpec::default() }).unwrap();
    let topic = TOPICS.iter().find(|topic| topic.name == "sprites").unwrap();
    let trial = (topic.make)(&mut Stage { studio: &mut studio, size: [160, 90] }).unwrap();
    let knobs = |v: &Variant| v.knobs.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let all: Vec<String> = trial.variants.iter().map(knobs).collect();
    for format in ["unorm8", "unorm16", "uint32", "float16", "float32"] {
        for mapping in ["z", "complementary-z", "w", "1/w"] {
            assert!(all.contains(&format!("sphere {format} {mapping} 512")), "{format} {mapping}");
        }
        for shape in ["box", "concave"] {
            assert!(all.contains(&format!("{shape} {format} 1/w 512")), "{shape} {format}");
        }
    }
    let mut wrong = |of: &str| {
        let variant = &trial.variants[all.iter().position(|knobs| knobs == of).unwrap_or_else(|| panic!("no {of}"))];
        let picture = studio.render(&variant.shot.scene, &variant.shot.request).unwrap();
        let mask = variant.mask.as_ref().unwrap();
        let share = mask.iter().filter(|is_in| **is_in).count() as f64 / mask.len() as f64;
        assert!((0.05..0.3).contains(&share), "{of}: the lens holds {share} of the picture");
        measure::difference::wrong_bits(mask, &picture.lens_mask.unwrap()[0])
    };
    for shape in ["sphere", "box", "concave"] {
        let (fine, coarse) = (wrong(&format!("{shape} float32 1/w 2048")), wrong(&format!("{shape} float32 1/w 128")));
        assert!(fine <= 2 && coarse >= fine, "{shape}: {fine} wrong with 2048 texels, {coarse} with 128");
    }
    let [eight, sixteen] = ["unorm8", "unorm16"].map(|format| wrong(&format!("sphere {format} w 512")));
    assert!(eight > sixteen + 3, "{eight} wrong with 8 bits from the eye on, {sixteen} with 16");
}

#[test]
fn lens_tests() {
    let model = load(&["builtin:square".into()], &LoadOptions::default(), &Quiet).unwrap();
    let mut studio = Studio::new(Gpu::open().unwrap(), Arc::new(model), &CitySpec::default()).unwrap();
    let topic = TOPICS.iter().find(|topic| topic.name == "lens-tests").unwrap();
    let trial = (topic.make)(&mut Stage { studio: &mut studio, size: [160, 90] }).unwrap();
    let knob = |v: &Variant, i: usize| v.knobs[i].to_string();
    let kinds = ["sphere", "ellipsoid", "box", "cylinder", "cone", "convex", "solid", "combination"];
    for kind in kinds {
        for test in ["shape", "sprite"] {
            let is_it = |v: &&Variant| knob(v, 0) == kind && knob(v, 1) == test;
            assert_eq!(trial.variants.iter().filter(is_it).count(), 1, "{kind} by {test}");
        }
    }
    for v in &trial.variants {
        assert_eq!(knob(v, 2), v.shot.scene.lenses.len().to_string(), "{}", v.label);
        assert_eq!(knob(v, 1) == "sprite", v.shot.scene.lenses.iter().all(|lens| lens.sprite.is_some()), "{}", v.label);
        let moves = v.shot.before.as_ref().is_some_and(|before| *before != v.shot.scene);
        assert_eq!(knob(v, 4) == "moving", moves, "{}", v.label);
    }
    let most = trial.variants.iter().map(|v| v.shot.scene.lenses.len()).max();
    assert_eq!(most, Some(10));
    // The techniques of the literature draw it too, those that test by shapes to the byte.
    let techniques = |arrangement: &str, count: &str| -> Vec<String> {
        let is_it = |v: &&Variant| knob(v, 3) == arrangement && knob(v, 2) == count && knob(v, 4) == "still";
        trial.variants.iter().filter(is_it).map(|v| knob(v, 1)).collect()
    };
    assert_eq!(techniques("apart", "4"), ["shape", "sprite", "branches", "regions", "three-pass"]);
    assert_eq!(techniques("overlapping", "4"), ["shape", "sprite", "branches", "regions"]);
    assert_eq!(techniques("apart", "10"), ["shape", "sprite", "regions", "three-pass"]);
    let by_them = |v: &&Variant| ["branches", "regions"].contains(&&*knob(v, 1)) && ["2", "4"].contains(&&*knob(v, 2));
    for v in trial.variants.iter().filter(by_them) {
        let reference = v.reference.as_ref().unwrap();
        let [right, found] = [reference, &v.shot].map(|shot| studio.render(&shot.scene, &shot.request).unwrap());
        assert!(right.rgba == found.rgba, "{}", v.label);
    }
    // Both tests draw one picture, to a few pixels of the border.
    let by_sprite = |v: &&Variant| knob(v, 1) == "sprite" && (kinds.contains(&&*knob(v, 0)) || knob(v, 2) == "10");
    for v in trial.variants.iter().filter(by_sprite) {
        let reference = v.reference.as_ref().unwrap();
        let [right, found] = [reference, &v.shot].map(|shot| studio.render(&shot.scene, &shot.request).unwrap());
        let inside = right.lens_mask.as_ref().unwrap()[0].iter().filter(|bits| **bits != 0).count();
        let wrong = Difference::between(&right, &found).wrong_mask_pixels.unwrap();
        assert!(inside > 200 && wrong <= 4, "{}: {wrong} of {inside}", v.label);
    }
}

#[test]
fn topics_are_listed() {
    let output = run(&["measure"]);
    assert_eq!(output.status.code(), Some(0));
    let list = text(&output.stdout);
    assert_eq!(list.lines().count(), TOPICS.len() + 1, "and the probe of the GPU");
    for topic in TOPICS {
        assert!(list.contains(topic.name) && list.contains(topic.about));
    }
    let json: Value = serde_json::from_slice(&run(&["measure", "--json"]).stdout).unwrap();
    assert_eq!(json.as_array().unwrap().len(), TOPICS.len());
}

#[test]
fn wrong_usage_is_told() {
    let told = |arguments: &[&str], part: &str| {
        let output = run(&[&["measure"], arguments].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(part), "{message} lacks {part}");
    };
    let nowhere = folder("nowhere");
    let place = nowhere.0.to_str().unwrap();
    told(&["sample", "-o", place], "did you mean \"samples\"?");
    told(&["xyzzy", "-o", place], "sprites");
    told(&["samples"], "-o DIR");
    told(&["samples", "-o", place, "--pairs", "0"], "1..");
    told(&["samples", "-o", place, "--size", "9000x10"], "4096");
    told(&["samples", "-o", place, "--write-references"], "measure gpu");
    told(&["gpu"], "-o DIR");
    told(&["gpu", "-o", place, "--only", "coplanar face"], "did you mean \"coplanar faces\"?");
    assert!(!nowhere.0.exists(), "nothing is made for a command that is wrong");
    let output = run(&["measure", "samples", "-o", place, "--city", "no/such.city.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("no/such.city.json"));
}

/// Whole runs of every topic would compile shaders for minutes; what they have drawn is looked at here.
#[test]
fn topics_make_whole_trials() {
    let model = load(&["builtin:square".into()], &LoadOptions::default(), &Quiet).unwrap();
    let mut studio = Studio::new(Gpu::open().unwrap(), Arc::new(model), &CitySpec::default()).unwrap();
    for topic in TOPICS {
        let trial = (topic.make)(&mut Stage { studio: &mut studio, size: [64, 36] }).unwrap();
        let mut labels: Vec<&str> = trial.variants.iter().map(|v| v.label.as_str()).collect();
        labels.sort_unstable();
        labels.dedup();
        assert_eq!(labels.len(), trial.variants.len(), "{}: labels are unlike", topic.name);
        assert!(trial.variants.iter().all(|v| v.knobs.len() == topic.knobs.len()), "{}", topic.name);
        assert!(trial.plain.scene.lenses.is_empty() && trial.plain.request.samples == 1, "{}", topic.name);
    }
}

#[test]
fn transparency_is_measured_against_f64() {
    let model = load(&["builtin:square".into()], &LoadOptions::default(), &Quiet).unwrap();
    let mut studio = Studio::new(Gpu::open().unwrap(), Arc::new(model), &CitySpec::default()).unwrap();
    let topic = TOPICS.iter().find(|topic| topic.name == "transparency").unwrap();
    let size = [64, 36];
    let trial = (topic.make)(&mut Stage { studio: &mut studio, size }).unwrap();
    let mut deepest = 0;
    for variant in trial.variants.iter().filter(|v| v.shot.request.samples == 1) {
        let Some(Exact::Layers(right)) = &variant.exact else { panic!("{} has layers", variant.label) };
        deepest = deepest.max(right.most_layers);
        let found = studio.transparency(&variant.shot.scene, size).unwrap();
        let Against { max, mean, .. } = Against::transparency(&found, &right.transparency);
        assert!(mean <= max && max <= 2.0, "{}: {mean} {max}", variant.label);
        let method = variant.shot.scene.style.transparency;
        match method {
            // What the issue allows is 2^-16 + n 2^-23; f32 does better.
            Transparency::Exact | Transparency::Peel { layers: 0 } => {
                let allowed = f64::from(3 * right.most_layers + 1) * 2_f64.powi(-24);
                assert!(max > 0.0 && max <= 2.0 * allowed, "{}: {max:e} of {allowed:e}", variant.label);
            }
            Transparency::Weighted => assert!(max > 1e-3, "{}: {max}", variant.label),
            Transparency::Peel { layers } | Transparency::KBuffer { layers } if layers < right.most_layers => {
                assert!(max > 1e-6, "{}: {max:e} of {} layers", variant.label, right.most_layers);
            }
            _ => {}
        }
    }
    assert!(deepest > 10, "{deepest}");
    // By chance: pictures, with noise that falls with samples.
    let noise = |label: &str| {
        let v = trial.variants.iter().find(|v| v.label == format!("dense, stochastic {label}")).unwrap();
        let [found, right] = [&v.shot, v.reference.as_ref().unwrap()].map(|shot| {
            let mut studio =
                Studio::new(Gpu::open().unwrap(), Arc::clone(&studio.model), &CitySpec::default()).unwrap();
            studio.render(&shot.scene, &shot.request).unwrap()
        });
        Against::pictures(&found, &right).mean
    };
    let (one, many) = (noise("1"), noise("16"));
    assert!(many > 1e-4 && one > 2.0 * many, "{one} {many}");
}

#[test]
fn handlers() {
    let model = load(&["builtin:square".into()], &LoadOptions::default(), &Quiet).unwrap();
    let mut studio = Studio::new(Gpu::open().unwrap(), Arc::new(model), &CitySpec::default()).unwrap();
    let topic = TOPICS.iter().find(|topic| topic.name == "handlers").unwrap();
    let trial = (topic.make)(&mut Stage { studio: &mut studio, size: [64, 36] }).unwrap();
    assert_eq!(trial.variants.len(), 6 * 2 * 2, "counts, arrangements, back ends");
    let effects = |v: &Variant| v.shot.scene.lenses.iter().map(|lens| lens.effects.len()).sum::<usize>();
    let plain = studio.render(&trial.plain.scene, &trial.plain.request).unwrap();
    for variant in &trial.variants {
        assert_eq!(variant.knobs[0], measure::Value::Number(effects(variant) as f64), "{}", variant.label);
    }
    for variant in trial.variants.iter().filter(|v| effects(v) == 2) {
        let reference = variant.reference.as_ref().unwrap();
        let [right, found] = [reference, &variant.shot].map(|shot| studio.render(&shot.scene, &shot.request).unwrap());
        // Both back ends make one picture, and there is something in it.
        assert_eq!(Difference::between(&right, &found).max_steps, 0, "{}", variant.label);
        let share = Difference::between(&plain, &found).wrong_pixels as f64 / (64.0 * 36.0);
        assert!((0.05..0.2).contains(&share), "{}: a lens over a tenth changes {share}", variant.label);
    }
}
