//! Volumes as people have them: what is wrong with one is told, what is right is in legends and statistics of files.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Once,
};

use veduta::{
    figure::{
        legend::volume_legends,
        scene_file::{Options, parse},
    },
    render::{
        fields::ShownVolume,
        frame::Backend,
        picture::{Aovs, Request, Studio},
    },
    scene::Scene,
};

use crate::studio::{of_scene, volumes::written};

const CITY: &str = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n";

fn options() -> Options {
    Options { allow_outside: true, ..Options::default() }
}

fn scene(volumes: &str) -> Result<Scene, String> {
    parse(&format!("{CITY}{volumes}"), "scene.toml", &options()).map_err(|error| error.to_string())
}

fn message(studio: &mut Studio, volumes: &str) -> String {
    let drawn = scene(volumes).and_then(|scene| {
        studio.render(&scene, &Request::plain([16, 9])).map(|_| ()).map_err(|error| error.to_string())
    });
    drawn.err().unwrap_or_default()
}

#[test]
fn what_is_wrong_with_a_volume_is_told() {
    let file = written("wrong", [4, 3, 2], |[x, y, z]| (x + y + z) as f32 + 0.5);
    let picture = file.with_extension("png");
    fs::write(&picture, b"\x89PNG\r\n\x1a\n....").expect("a file");
    let truncated = file.with_file_name(format!("truncated-{}.nrrd", std::process::id()));
    let whole = fs::read(&file).expect("a file");
    fs::write(&truncated, &whole[..whole.len() - 5]).expect("a file");
    let of = |rest: &str| format!("[[volume]]\nfile = {file:?}\n{rest}");
    let five = of("").repeat(5).replace("[[volume]]\n", "[[volume]]\nname = \"NAME\"\n");
    let five = (0..5).fold(five, |text, i| text.replacen("NAME", &format!("v{i}"), 1));
    let cases: Vec<(String, &[&str])> = vec![
        ("[[volume]]\n".to_owned(), &["scene.toml", "file", "missing"]),
        (of("mode = \"mip\""), &["scene.toml:6", "mode", "\"maximum\""]),
        (of("spacing = [1, 0, 1]"), &["spacing", "above 0"]),
        (of("level = 3.0"), &["level", "isosurface"]),
        (of("slice = { axis = \"x\" }"), &["slice", "mode = \"slice\""]),
        (of("labels = true"), &["labels", "values = [1, 2]"]),
        (of("labels = true\ntransfer = { values = [1.5] }"), &["whole numbers"]),
        (of("transfer = { values = [1, 2, 3], opacity = [0.5, 1.0] }"), &["opacity", "2", "3"]),
        (of("transfer = { values = [3, 2] }"), &["values", "larger than the one before"]),
        (of("transfer = { range = [2, 1] }"), &["range", "second larger"]),
        (of("name = \"a\"\n") + &of("name = \"a\"\n"), &["\"a\" is the name of volume.0"]),
        (of("field = \"nothing\""), &["field", "no such array", "\""]),
        (of("time_step = 7"), &["time_step", "one step", "0"]),
        (of("component = \"z\""), &["component", "one component"]),
        (of("light = \"lit\"\nmode = \"slice\""), &["light", "isosurface"]),
        (of("mode = \"average\"\nlabels = true\ntransfer = { values = [1] }"), &["mode", "labels"]),
        (of("labels = true\ntransfer = { values = [1] }"), &["labels", "whole numbers 0 to 255"]),
        (five, &["5 volumes", "takes 4"]),
        (format!("[[volume]]\nfile = {:?}\n", file.with_extension("no")), &["volume-0", "cannot be read"]),
        (format!("[[volume]]\nfile = {picture:?}\n"), &["volume-0", "wrong", ".png", "PNG"]),
        (format!("[[volume]]\nfile = {truncated:?}\n"), &["truncated", "bytes"]),
        (of("[style]\ntransparency = \"weighted\""), &["transparency", "volumes", "\"exact\""]),
    ];
    let mut studio = of_scene(&scene("").expect("a city"));
    let mut wrong = Vec::new();
    for (text, words) in cases {
        let told = message(&mut studio, &text);
        if told.is_empty() || words.iter().any(|word| !told.contains(word)) {
            wrong.push(format!("{text}told: {told}\nwanted: {words:?}\n"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(message(&mut studio, &of("")), "");
}

#[test]
fn legends_tell_values_and_labels() {
    let file = written("legend", [5, 4, 3], |[x, y, _]| (x * y) as f32);
    let text = format!(
        "[[volume]]\nfile = {file:?}\nlabel = \"Heat\"\nunit = \"K\"\ntransfer = {{ ramp = \"batlow\", opacity = [0.0, 0.5] }}\n\
         [[volume]]\nname = \"things\"\nfile = {file:?}\nlabels = true\n\
         transfer = {{ values = [2, 6], names = [\"bone\", \"skin\"], colors = [\"#ff0000\", \"#00ff00\"] }}\n"
    );
    let scene = scene(&text).expect("a scene");
    let studio = of_scene(&scene);
    let shown = studio.volumes(&scene).expect("both are shown");
    let ShownVolume { ends, range, size, steps, .. } = &shown[0];
    assert_eq!((*ends, *range, *size, *steps), ([0.0, 12.0], [0.0, 12.0], [5, 4, 3], 1));
    assert_eq!(shown[0].histogram.iter().sum::<u64>(), 60);
    let legends = volume_legends(&scene, &shown);
    assert_eq!((legends[0].title.as_str(), legends[0].unit.as_deref()), ("Heat", Some("K")));
    assert_eq!(legends[0].bar(), Some((0.0, 12.0)));
    let columns = legends[0].columns();
    assert!(columns[0] == 0.0 && columns.last() == Some(&1.0) && columns.is_sorted(), "{columns:?}");
    let rows: Vec<(String, [f32; 3])> = legends[1].rows().into_iter().map(|row| (row.label, row.color)).collect();
    assert_eq!(rows, [("bone".to_owned(), [1.0, 0.0, 0.0]), ("skin".to_owned(), [0.0, 1.0, 0.0])]);
}

#[test]
fn volumes_of_which_nothing_is_seen_are_told_of() {
    let mut studio = of_scene(&scene("").expect("a city"));
    let file = written("unseen", [4, 4, 4], |[x, y, z]| (x + y + z) as f32);
    let mut told = |rest: &str| {
        let scene = scene(&format!("[[volume]]\nname = \"v\"\nfile = {file:?}\n{rest}"))
            .unwrap_or_else(|error| panic!("{error}"));
        let request = Request { statistics: true, ..Request::plain([16, 9]) };
        let picture = studio.render(&scene, &request).expect("a picture");
        let warning = picture.statistics.warnings.into_iter().find(|warning| warning["code"] == "volume-unseen");
        warning.map(|warning| warning["message"].as_str().expect("a message").to_owned())
    };
    assert_eq!(told(""), None);
    assert_eq!(told("mode = \"isosurface\"\nlevel = 4.5\n"), None);
    let of = |told: Option<String>, words: &str| {
        let told = told.unwrap_or_default();
        assert!(told.contains("volume \"v\"") && told.contains(words), "{told}");
    };
    of(told("mode = \"isosurface\"\nlevel = 44.5\n"), "no surface of 44.5: its values are 0 to 9");
    of(told("transfer = { values = [100, 200], opacity = [0.0, 1.0] }\n"), "no opacity");
    of(told("labels = true\ntransfer = { values = [77] }\n"), "none of the labels");
    of(told("origin = [1e6, 0, 0]\n"), "m from the city");
}

/// A solid block of one colour around the middle of the square.
fn block(rest: &str) -> String {
    let file = written("block", [3, 3, 3], |_| 0.5);
    format!(
        "[camera]\neye = [0, -120, 70]\ntarget = [0, 0, 10]\n[[volume]]\nfile = {file:?}\norigin = [-20, -20, 0]\nspacing = [20, 20, 15]\n\
         transfer = {{ colors = [\"#3060c0\", \"#3060c0\"], opacity = [1.0, 1.0], range = [0.0, 1.0] }}\n{rest}"
    )
}

#[test]
fn styles_of_surfaces_leave_volumes_as_they_are() {
    let mut studio = of_scene(&scene("").expect("a city"));
    let lens = |effect: &str| {
        format!(
            "[[lens]]\nshape = {{ kind = \"sphere\", center = [0, 0, 10], radius = 60 }}\nbody = \"none\"\neffects = [\"{effect}\"]\n"
        )
    };
    let context = |effect: &str| format!("[style]\neffects = [\"{effect}\"]\n");
    let mut all = vec![String::new(), "[style]\nbase = \"clay\"\n".to_owned()];
    all.extend(["flat", "clay"].map(context));
    all.extend(["velvet", "marble", "cel"].map(lens));
    let size = [64, 36];
    let mut wanted = None;
    for rest in all {
        let scene = scene(&block(&rest)).unwrap_or_else(|error| panic!("{error}"));
        for backend in [Backend::Specialised, Backend::Uber] {
            let request =
                Request { backend, aovs: Aovs { lens_mask: true, ..Aovs::default() }, ..Request::plain(size) };
            let picture = studio.render(&scene, &request).expect("a picture");
            let middle = picture.rgba[(size[1] / 2 * size[0] + size[0] / 2) as usize];
            assert_eq!(middle, *wanted.get_or_insert(middle), "{rest}, {backend:?}");
            // Masks are of what stands behind it.
            let without = Scene { volumes: Vec::new(), ..scene.clone() };
            let plain = studio.render(&without, &request).expect("a picture");
            assert!(picture.lens_mask == plain.lens_mask, "{rest}, {backend:?}");
        }
    }
    let [r, g, b, _] = wanted.expect("some were drawn");
    assert!(b > 150 && b > g && g > r, "{wanted:?}");
}

#[test]
fn animations_change_volumes() {
    let text = block(
        "[animation]\nframes = 3\nfps = 1\n[[animation.change]]\npath = \"volume.volume-0.slice.at\"\n\
         keys = [{ at = 0.0, value = 0.0 }, { at = 2.0, value = 1.0 }]\n",
    );
    let text = text.replace("transfer =", "mode = \"slice\"\ntransfer =");
    scene(&text).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn what_a_volume_is_read_from_is_kept() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("beside-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: data.png\n\n";
    let data: Vec<u8> = (0..64).collect();
    fs::write(folder.join("a.nhdr"), header).expect("a file");
    fs::write(folder.join("data.png"), &data).expect("a file");
    fs::write(folder.join("a.toml"), format!("{CITY}[[volume]]\nfile = \"a.nhdr\"\n")).expect("a file");
    let program = Command::new(env!("CARGO_BIN_EXE_veduta"))
        .args(["render", "a.toml", "-o", "data.png", "--size", "16x9", "--samples", "1"])
        .current_dir(&folder)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&program.stderr);
    assert_eq!(program.status.code(), Some(2), "{said}");
    assert!(said.contains("data.png is read, and would be replaced"), "{said}");
    assert_eq!(fs::read(folder.join("data.png")).expect("it is there"), data);
}

/// A lens in the air, with nothing of the city in it, acts on what a volume has there.
#[test]
fn lenses_in_which_nothing_of_the_city_is_act_on_volumes() {
    let mut studio = of_scene(&scene("").expect("a city"));
    let high = |rest: &str| {
        let text = block(rest).replace("origin = [-20, -20, 0]", "origin = [-20, -20, 260]");
        scene(&text.replace("eye = [0, -120, 70]", "eye = [0, -160, 320]").replace("[0, 0, 10]", "[0, 0, 270]"))
    };
    let mut drawn = |rest: &str| {
        let scene = high(rest).unwrap_or_else(|error| panic!("{error}"));
        let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| {
            let request = Request { backend, ..Request::plain([96, 54]) };
            studio.render(&scene, &request).unwrap_or_else(|error| panic!("{error}")).rgba
        });
        assert!(one == other, "the back ends differ: {rest}");
        one
    };
    let plain = drawn("");
    let lens = |rest: &str| {
        format!(
            "[[lens]]\nbody = \"none\"\nshape = {{ kind = \"sphere\", center = [0, 0, 275], radius = 30 }}\n{rest}\n"
        )
    };
    let without = drawn("").iter().zip(&drawn("visible = false\n")).filter(|(a, b)| a != b).count();
    let changed = |now: &[[u8; 4]]| now.iter().zip(&plain).filter(|(a, b)| a != b).count();
    for effects in ["effects = [\"eraser\"]", "effects = [\"invert\"]", "effects = [\"transparent\"]"] {
        let now = drawn(&lens(effects));
        assert!(changed(&now) > without / 3, "{effects}: {} of {without} pixels", changed(&now));
    }
}

/// A volume before a point of interest gives way to an occlusion lens as a building does; one beside the way, behind it, or that hides little does not.
#[test]
fn a_volume_that_hides_a_point_of_interest_is_an_occluder() {
    let mut studio = of_scene(&scene("").expect("a city"));
    let mut told = of_scene(&scene("").expect("a city"));
    let mut drawn = |poi: &str, own: &str, lens: &str| {
        let block = block(own);
        // As opaque as that where it says how thick.
        let block = if own.contains("thickness = 38") {
            block.replace("opacity = [1.0, 1.0]", "opacity = [0.5, 0.5]")
        } else {
            block
        };
        let text = block.replace("[[volume]]", &format!("[[poi]]\nname = \"p\"\nat = {poi}\n[[volume]]"));
        let scene = scene(&format!("{text}{lens}")).unwrap_or_else(|error| panic!("{error}"));
        let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| {
            let request = Request { backend, ..Request::plain([96, 54]) };
            studio.render(&scene, &request).unwrap_or_else(|error| panic!("{error}")).rgba
        });
        assert!(one == other, "the back ends differ: {own} {lens}");
        one
    };
    let looks = |rest: &str| {
        format!(
            "[[lens]]\nkind = \"occlusion\"\nbody = \"none\"\npoi = \"p\"\nforbid = {{ types = [\"Building\", \"SolitaryVegetationObject\", \"CityFurniture\"] }}\n{rest}\n"
        )
    };
    let exact = looks("");
    let (behind, before, beside) = ("[0, 60, 1]", "[0, -60, 30]", "[90, 60, 1]");
    let gone = drawn(behind, "visible = false\n", "");
    assert!(drawn(behind, "", "") != gone, "it is seen");
    assert!(drawn(behind, "", &exact) == gone, "it is taken away");
    assert!(drawn(behind, "", &looks("test = { kind = \"view-axis\" }")) == gone, "by any test that asks for points");
    let with = drawn(before, "", "");
    assert!(drawn(before, "", &exact) == with, "it is behind the point");
    assert!(drawn(beside, "", &exact) == with, "it is beside the way");
    assert!(drawn(behind, "", &looks("test = { kind = \"spherical\", radius = 20 }")) == with, "no test asks for it");
    // A haze of which a metre takes a ten thousandth hides nothing.
    let thin = "thickness = 400000.0\n";
    assert!(drawn(behind, thin, &exact) == drawn(behind, thin, ""), "it hides little");
    // The way through it is 38.18 m long: from y = -15.65 m, below its top, to y = 20 m. A half of the light is the limit.
    let half = |metres: f64| format!("thickness = {metres}\n");
    for (metres, hides) in [(38.1, true), (38.3, false)] {
        let own = half(metres);
        let shown = drawn(behind, &own, &exact);
        assert_eq!(shown == gone, hides, "{metres} m");
    }
    // Drawn as an occluder is drawn, by what acts on volumes.
    for render in [
        "\"transparent\"",
        "\"x-ray\"",
        "[\"invert\"]",
        "[{ as = \"transparent\", nearer = 1.0 }, { as = \"discard\" }]",
    ] {
        let shown = drawn(behind, "", &looks(&format!("render = {render}")));
        assert!(shown != with && (shown != gone) != render.starts_with("[{"), "{render}");
    }
    // Statistics name it, once, among the occluders.
    let text =
        block("").replace("[[volume]]", &format!("[[poi]]\nname = \"p\"\nat = {behind}\n[[volume]]\nname = \"cloud\""));
    let by_cases = looks("render = [{ as = \"x-ray\", nearer = 1.0 }, { as = \"transparent\" }]");
    for (lens, expected) in [
        (&exact, vec!["cloud"]),
        (&by_cases, vec!["cloud"]),
        (&looks("test = { kind = \"spherical\", radius = 20 }"), vec![]),
    ] {
        let scene = scene(&format!("{text}{lens}")).unwrap_or_else(|error| panic!("{error}"));
        let request = Request { statistics: true, ..Request::plain([96, 54]) };
        let picture = told.render(&scene, &request).unwrap_or_else(|error| panic!("{error}"));
        let list = picture.statistics.lenses[0].occluders.clone().expect("occluders");
        assert_eq!(list.iter().map(|occluder| occluder.id.as_str()).collect::<Vec<_>>(), expected, "{lens}");
    }
    // Surfaces and layers hide, too.
    for mode in ["mode = \"slice\"\nslice = { axis = \"y\" }\n", "mode = \"maximum\"\n", "mode = \"x-ray\"\n"] {
        assert!(drawn(behind, mode, &exact) == gone, "{mode}");
    }
}

/// A file of four steps in time, each of a value of its own.
fn series() -> PathBuf {
    let steps = 4;
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("series-{steps}-{}.nrrd", std::process::id()));
    let head = format!(
        "NRRD0005\ntype: float\ndimension: 4\nsizes: 3 3 3 {steps}\nkinds: domain domain domain time\nspacings: 1 1 1 1\nendian: little\nencoding: raw\n\n"
    );
    let value = |step: usize| step as f32 / (steps - 1) as f32;
    let values = (0..steps).flat_map(|step| [value(step); 27]).flat_map(f32::to_le_bytes);
    // Written once: others may read it meanwhile.
    static WRITTEN: Once = Once::new();
    WRITTEN.call_once(|| {
        fs::write(&path, head.into_bytes().into_iter().chain(values).collect::<Vec<u8>>()).expect("a file")
    });
    path
}

/// A block whose colour is its step's, of four days.
fn changing(rest: &str) -> String {
    let [own, plain] = [series(), written("block", [3, 3, 3], |_| 0.5)].map(|file| format!("{file:?}"));
    let colors = "colors = [\"#d02020\", \"#20d020\", \"#2020d0\", \"#d0d020\"], opacity = [0.6, 0.6, 0.6, 0.6]";
    let of_one = "colors = [\"#3060c0\", \"#3060c0\"], opacity = [1.0, 1.0]";
    block("").replace(&plain, &own).replace(of_one, colors) + rest
}

const DAYS: &str = "begins = \"2024-06-01\"\nends = \"2024-06-04\"\n";

#[test]
fn steps_in_time_follow_the_moment() {
    let mut studio = of_scene(&scene("").expect("a city"));
    let mut drawn = |rest: &str| {
        let scene = scene(&changing(rest)).unwrap_or_else(|error| panic!("{error}"));
        let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| {
            let request =
                Request { backend, aovs: Aovs { depth: true, ..Aovs::default() }, ..Request::plain([96, 54]) };
            studio.render(&scene, &request).unwrap_or_else(|error| panic!("{error}")).rgba
        });
        assert!(one == other, "the back ends differ: {rest}");
        one
    };
    let steps: Vec<_> = (0..4).map(|step| drawn(&format!("time_step = {step}\n"))).collect();
    assert!(steps.windows(2).all(|pair| pair[0] != pair[1]), "each has its own colour");
    // Each step up to the next one, the first before, the last after, the first where no moment is.
    for (at, step) in [
        ("2024-05-01", 0),
        ("2024-06-01", 0),
        ("2024-06-01T23:59", 0),
        ("2024-06-02", 1),
        ("2024-06-03T12:00", 2),
        ("2024-07-01", 3),
    ] {
        assert!(drawn(&format!("{DAYS}[time]\nat = \"{at}\"\n")) == steps[step], "{at}");
    }
    assert!(drawn(DAYS) == steps[0], "no moment");
    // A time lens around all of it shows its own moment, one around nothing none; each half of it what its lens says.
    let lens = |name: &str, x: f64, at: &str| {
        format!(
            "[[lens]]\nname = \"{name}\"\nkind = \"time\"\nbody = \"none\"\nshape = {{ kind = \"box\", center = [{x}, 0, 15], size = [60, 80, 60] }}\ntime = [{{ op = \"set\", at = \"{at}\" }}]\n"
        )
    };
    let time = "[time]\nat = \"2024-06-01\"\n";
    assert!(drawn(&format!("{DAYS}{time}{}", lens("a", 0.0, "2024-06-03"))) == steps[2], "all of it");
    assert!(drawn(&format!("{DAYS}{}", lens("a", 0.0, "2024-06-03"))) == steps[2], "all of it, and no moment outside");
    assert!(drawn(&format!("{DAYS}{time}{}", lens("a", 500.0, "2024-06-03"))) == steps[0], "none of it");
    let halves = drawn(&format!("{DAYS}{time}{}{}", lens("a", -30.0, "2024-06-03"), lens("b", 30.0, "2024-06-04")));
    let is_of = |i: usize, step: usize| halves[i] == steps[step][i];
    let changed: Vec<usize> = (0..halves.len()).filter(|i| steps[2][*i] != steps[3][*i]).collect();
    let (left, right) =
        (changed.iter().filter(|i| is_of(**i, 2)).count(), changed.iter().filter(|i| is_of(**i, 3)).count());
    assert!(left > changed.len() / 3 && right > changed.len() / 3, "{left} and {right} of {}", changed.len());
    // Several moments together: half of each.
    let both = drawn(&format!(
        "{DAYS}[time]\nat = \"2024-06-01\"\nsteps = [{{ op = \"aggregate\", at = [\"2024-06-01\", \"2024-06-02\"] }}]\n"
    ));
    assert!(both != steps[0] && both != steps[1], "both");
    // Surfaces, layers and light go by it, too.
    for mode in ["isosurface\"\nlevel = 0.5\nlight = \"lit", "maximum", "slice", "x-ray"] {
        let of = |rest: &str| changing(rest).replace("transfer =", &format!("mode = \"{mode}\"\ntransfer ="));
        let mut drawn = |rest: &str| {
            let scene = scene(&of(rest)).unwrap_or_else(|error| panic!("{error}"));
            studio.render(&scene, &Request::plain([48, 27])).unwrap_or_else(|error| panic!("{error}")).rgba
        };
        let own = drawn(&format!("{DAYS}{time}{}", lens("a", 0.0, "2024-06-03")));
        let alone = drawn("time_step = 2\n");
        let off: Vec<_> = own.iter().zip(&alone).filter(|(a, b)| a != b).collect();
        assert!(off.is_empty(), "{mode}: {} pixels, {:?}", off.len(), off.first());
    }
}

#[test]
fn what_is_wrong_with_the_times_of_a_volume_is_told() {
    let mut studio = of_scene(&scene("").expect("a city"));
    let time = "[time]\nat = \"2024-06-01\"\n";
    let lens = |day: usize| {
        format!(
            "[[lens]]\nname = \"l{day}\"\nkind = \"time\"\nshape = {{ kind = \"sphere\", center = [0, 0, 0], radius = 50 }}\ntime = [{{ op = \"set\", at = \"2024-06-0{day}\" }}]\n"
        )
    };
    let once = changing(DAYS);
    let many =
        format!("{once}[[volume]]\nname = \"second\"\nfile = {:?}\n{DAYS}{time}{}{}", series(), lens(2), lens(3));
    for (text, told) in [
        (changing("begins = \"2024-06-01\"\n"), "ends: is missing"),
        (changing("ends = \"2024-06-01\"\n"), "begins: is missing"),
        (changing("begins = \"2024-06-02\"\nends = \"2024-06-01\"\n"), "ends: must be later than begins"),
        (changing(&format!("{DAYS}time_step = 2\n")), "time_step: is given together with begins"),
        (many, "lenses show steps in time of volumes, 6 with those that show outside; one picture takes 4"),
    ] {
        let message = message(&mut studio, &text);
        assert!(message.contains(told), "{text}\n  gave     {message}\n  expected {told}");
    }
}
