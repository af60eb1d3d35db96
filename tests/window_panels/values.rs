//! Values of the scene in their panels, objects by their types, what it costs, files of a user's that change.

use eframe::egui::Role;

use super::*;

#[test]
fn light_style_eye_and_figure_are_set_by_their_panels() {
    let mut harness = window();
    click(&mut harness, "Sun");
    assert!(harness.state().document.scene().sun.shadows);
    click(&mut harness, "Shadows");
    assert!(!harness.state().document.scene().sun.shadows);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.state().document.scene().sun.shadows);
    click(&mut harness, "Sun");
    click(&mut harness, "Style");
    click(&mut harness, "Base");
    click(&mut harness, "clay");
    assert_eq!(harness.state().document.scene().style.base, veduta::scene::BaseStyle::Clay);
    click(&mut harness, "Style");
    click(&mut harness, "Points of interest");
    click(&mut harness, "Add one in the middle of the picture");
    let poi = harness.state().document.scene().pois[0].clone();
    assert_eq!(poi.name, "poi-0");
    click(&mut harness, "poi-0");
    click(&mut harness, "Take it away");
    assert!(harness.state().document.scene().pois.is_empty());
    // What no first look needs is one click further.
    assert_eq!(harness.query_all_by_label("Layout").count(), 0);
    click(&mut harness, "More of the scene");
    click(&mut harness, "Layout");
    click(&mut harness, "Along");
    click(&mut harness, "right");
    assert_eq!(harness.state().document.scene().layout.along, veduta::scene::overlay::Along::Right);
}

#[test]
fn what_a_picture_costs_is_told() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::L);
    press(&mut harness, Modifiers::NONE, Key::T);
    // The next picture that stands still is measured.
    let started = std::time::Instant::now();
    while harness.query_all_by_label("Passes").count() == 0 {
        assert!(started.elapsed() < PATIENCE, "waited in vain for the numbers");
        std::thread::sleep(std::time::Duration::from_millis(10));
        harness.step();
    }
    for label in ["What it costs", "Passes", "Lenses", "pass", "lens", "geometry"] {
        assert!(harness.query_all_by_label(label).count() > 0, "there is no \"{label}\"");
    }
    press(&mut harness, Modifiers::NONE, Key::T);
    assert_eq!(harness.query_all_by_label("Passes").count(), 0);
}

#[test]
fn types_of_objects_are_hidden_and_shown() {
    let mut harness = window();
    let buildings = |harness: &Panels| {
        let (city, frame) = (harness.state().city.clone().unwrap(), harness.state().frame.as_ref().unwrap());
        let kind = |id: u32| {
            let root = city.roots[id as usize];
            city.model.strings.get(city.model.objects[root as usize].kind).to_owned()
        };
        let (ids, _) = frame.shown.as_ref().unwrap();
        ids.iter().filter_map(|id| id.checked_sub(1)).filter(|id| kind(*id) == "Building").count()
    };
    assert!(buildings(&harness) > 1000);
    click(&mut harness, "Types");
    click(&mut harness, "Building (94)");
    assert_eq!(harness.state().document.scene().lenses[0].name, "hidden types");
    until_drawn(&mut harness);
    assert_eq!(buildings(&harness), 0, "with their parts");
    // Roads lie on the ground, and go, too.
    click(&mut harness, "Road (9)");
    click(&mut harness, "Building (94)");
    until_drawn(&mut harness);
    assert!(buildings(&harness) > 1000);
    click(&mut harness, "Road (9)");
    assert!(harness.state().document.scene().lenses.is_empty());
}

/// An effect that gives all surfaces this colour.
fn flat(color: &str) -> String {
    format!(
        "//! name = \"window-test\"\n//! kind = \"post\"\n//! spec = \"mine\"\n//! doc = \"One colour.\"\n\n\
         fn effect(color: vec3f, point: Point) -> vec3f {{\n    return {color};\n}}\n"
    )
}

#[test]
fn effects_are_read_again_when_they_change() {
    let folder = std::env::temp_dir().join(format!("veduta-window-effects-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("mine.wgsl");
    std::fs::write(&file, flat("vec3f(1.0, 0.0, 0.0)")).unwrap();
    let mut harness = window();
    // Nothing is lost by an effect that comes: nobody is asked, and the city stays.
    harness.state_mut().open(std::slice::from_ref(&file));
    let said = |harness: &mut Panels, text: &str| {
        let started = Instant::now();
        while harness.query_all_by_label_contains(text).count() == 0 {
            assert!(started.elapsed() < PATIENCE, "nobody says \"{text}\"");
            std::thread::sleep(Duration::from_millis(20));
            harness.step();
        }
    };
    said(&mut harness, "The effect window-test was read.");
    harness.state_mut().document.set("style.effects=[\"window-test\"]").unwrap();
    let is = |color: [u8; 3]| {
        move |window: &Window| {
            window.frame.as_ref().is_some_and(|frame| {
                let [w, h] = frame.view.size.map(|side| side as usize);
                frame.rgba[h / 2 * w + w / 2][..3] == color
            })
        }
    };
    until(&mut harness, "a red picture", is([255, 0, 0]));
    std::fs::write(&file, flat("vec3f(0.0, 0.0, 1.0)  ")).unwrap();
    until(&mut harness, "a blue picture", is([0, 0, 255]));
    // What is broken is told with its place; the picture stays.
    std::fs::write(&file, flat("vec3f(0.0, green, 1.0)")).unwrap();
    said(&mut harness, "mine.wgsl:7:");
    harness.run_steps(5);
    assert!(is([0, 0, 255])(harness.state()));
    std::fs::write(&file, flat("vec3f(0.0, 1.0, 0.0)")).unwrap();
    until(&mut harness, "a green picture", is([0, 255, 0]));
    std::fs::remove_dir_all(&folder).unwrap();
    harness.run_steps(5);
    assert!(is([0, 255, 0])(harness.state()), "what is not there any more stays as it was");
}

#[test]
fn a_file_that_vanishes_takes_nothing_with_it() {
    let folder = std::env::temp_dir().join(format!("veduta-window-vanishes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("lods.city.json");
    std::fs::copy(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("citydata/lod-all.city.json"), &file).unwrap();
    let start = Start { files: vec![file.clone()], ..Start::default() };
    let mut harness = harness(&start, egui::vec2(1280.0, 800.0));
    until(&mut harness, "a picture", |window| window.frame.as_ref().is_some_and(|frame| frame.shown.is_some()));
    std::fs::remove_dir_all(&folder).unwrap();
    // It is drawn and looked at as before; only what must be read anew is refused, and taken back.
    press(&mut harness, Modifiers::NONE, Key::Home);
    press(&mut harness, Modifiers::NONE, Key::L);
    until_drawn(&mut harness);
    harness.state_mut().document.set("city.lod=\"1\"").unwrap();
    harness.step();
    until(&mut harness, "the message", |window| !window.is_loading());
    harness.run_steps(3);
    assert_eq!(harness.state().document.scene().city.lod, None);
    assert!(harness.query_all_by_label_contains("lods.city.json").count() > 0, "the message names the file");
    assert_eq!(harness.state().document.scene().lenses.len(), 1);
    // Where its folder was nothing can be saved; the scene stays one that is not.
    harness.state_mut().save(&folder.join("scene.toml"));
    harness.step();
    assert!(harness.state().document.is_changed());
    assert!(harness.query_all_by_label_contains("scene.toml").count() > 0);
}

#[test]
fn files_are_chosen_by_keys_alone() {
    let folder = std::env::temp_dir().join(format!("veduta-window-dialogs-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("deeper")).unwrap();
    std::fs::copy(
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("citydata/rooms.city.json"),
        folder.join("deeper/rooms.city.json"),
    )
    .unwrap();
    let mut harness = window();
    press(&mut harness, Modifiers::COMMAND, Key::O);
    // A folder that is typed is entered; what is not there is told.
    for (typed, shown) in [
        (format!("{}", folder.display()), "deeper/"),
        ("nothing.city.json".to_owned(), "there is no such file"),
        ("deeper".to_owned(), "rooms.city.json"),
    ] {
        press(&mut harness, Modifiers::COMMAND, Key::A);
        write(&mut harness, &typed);
        press(&mut harness, Modifiers::NONE, Key::Enter);
        harness.run_steps(2);
        assert!(harness.query_all_by_label_contains(shown).count() > 0, "{typed}: there is no \"{shown}\"");
        harness.get_by_role_and_label(Role::TextInput, "File").focus();
        harness.step();
    }
    write(&mut harness, "rooms.city.json");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    until(&mut harness, "the other city", |window| {
        !window.is_loading() && window.document.title() == "rooms.city.json" && window.frame.is_some()
    });
    // What would be written over is asked about.
    let scene = folder.join("deeper/scene.toml");
    std::fs::write(&scene, "veduta = 1\n").unwrap();
    press(&mut harness, Modifiers::COMMAND, Key::S);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    harness.run_steps(2);
    click(&mut harness, "Cancel");
    assert_eq!(std::fs::read_to_string(&scene).unwrap(), "veduta = 1\n");
    press(&mut harness, Modifiers::COMMAND, Key::S);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    harness.run_steps(2);
    click(&mut harness, "Replace");
    assert!(std::fs::read_to_string(&scene).unwrap().contains("rooms.city.json"));
    std::fs::remove_dir_all(&folder).unwrap();
}
