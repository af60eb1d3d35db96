//! The window without a display: every panel is asked by what assistive technology reads of it, as somebody would use it.

mod lenses;
mod time_lenses;
mod timeline;
mod values;
mod volumes;

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use eframe::egui::{self, Key, Modifiers};
use egui_kittest::{Harness, kittest::Queryable};
use glam::DVec2;
use veduta::{
    app::{Start, Window, actions::Action, canvas::pick, drawn::Figure},
    figure::{
        self,
        scene_file::{Options, parse},
    },
    gpu::Gpu,
    render::picture::{Aovs, Request, Studio},
    scene::StyleLook,
    view::navigate::Axis,
};

/// Long enough for a machine that does much else: a picture takes a tenth of a second.
const PATIENCE: Duration = Duration::from_secs(300);

type Panels = Harness<'static, Window>;

/// A window with the built-in city, once it is drawn.
fn window() -> Panels {
    let files = vec![PathBuf::from("builtin:square")];
    let start = Start { files, ..Start::default() };
    let mut harness = harness(&start, egui::vec2(1280.0, 800.0));
    until(&mut harness, "a picture that tells what it shows", |window| {
        window.frame.as_ref().is_some_and(|frame| frame.shown.is_some())
    });
    harness
}

fn harness(start: &Start, size: egui::Vec2) -> Panels {
    let context = egui::Context::default();
    let window = Window::new(&context, start).expect("threads");
    let mut harness = Harness::builder()
        .with_size(size)
        .with_max_steps(4)
        .build_ui_state(|ui: &mut egui::Ui, window: &mut Window| window.ui(ui), window);
    harness.step();
    harness
}

fn until(harness: &mut Panels, what: &str, holds: impl Fn(&Window) -> bool) {
    let started = Instant::now();
    while !holds(harness.state()) {
        assert!(started.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
}

/// The picture of what the scene is now.
fn until_drawn(harness: &mut Panels) {
    harness.step();
    until(harness, "the picture of the present scene", |window| {
        window.frame.as_ref().is_some_and(|frame| {
            frame.shown.is_some()
                && frame.scene.lenses == window.document.scene().lenses
                && frame.scene.overlays == window.document.scene().overlays
                && Some(frame.view.camera) == window.camera()
        })
    });
}

/// Once the eye has come where it flies.
fn arrive(harness: &mut Panels) {
    let mut last = None;
    let mut still = 0;
    let started = Instant::now();
    while still < 20 {
        assert!(started.elapsed() < PATIENCE, "the flight never ends");
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
        let now = harness.state().camera();
        still = if now == last { still + 1 } else { 0 };
        last = now;
    }
}

fn click(harness: &mut Panels, label: &str) {
    harness.get_by_label(label).click();
    harness.step();
    harness.step();
}

fn press(harness: &mut Panels, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.step();
    harness.step();
}

/// The middle of the city's picture.
fn middle(harness: &Panels) -> egui::Pos2 {
    harness.get_by_label("City").rect().center()
}

/// Presses a button of the mouse, goes there in steps, lets it go.
fn drag(harness: &mut Panels, from: egui::Pos2, to: egui::Pos2) {
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    harness.step();
    for share in [0.3, 0.6, 0.9, 1.0] {
        harness.hover_at(from.lerp(to, share));
        harness.step();
    }
    harness.drop_at(to);
    harness.step();
    harness.step();
}

/// Writes into the field that has the focus.
fn write(harness: &mut Panels, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.step();
    harness.step();
}

/// Writes another text into a field, and is done with it.
fn retype(harness: &mut Panels, label: &str, text: &str) {
    harness.get_by_label(label).focus();
    harness.step();
    press(harness, Modifiers::COMMAND, Key::A);
    press(harness, Modifiers::NONE, Key::Backspace);
    write(harness, text);
    press(harness, Modifiers::NONE, Key::Enter);
    harness.step();
}

fn click_at(harness: &mut Panels, at: egui::Pos2) {
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.step();
    harness.step();
}

#[test]
fn a_lens_is_added_changed_undone_and_done_again() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::L);
    assert_eq!(harness.state().document.scene().lenses.len(), 1);
    assert_eq!(harness.state().chosen.lens, Some(0));
    until_drawn(&mut harness);
    // Its values are there, from the table of keys.
    for label in ["Name", "Shape", "Radius", "Effects", "Amount"] {
        assert!(harness.query_all_by_label(label).count() > 0, "there is no \"{label}\"");
    }
    let toggle = "colour is on";
    click(&mut harness, toggle);
    assert!(!harness.state().document.scene().lenses[0].enabled);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.state().document.scene().lenses[0].enabled);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.state().document.scene().lenses.is_empty());
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(harness.state().document.scene().lenses.len(), 1);
    // A copy lies above it; the lower one can be raised over it, and both go.
    press(&mut harness, Modifiers::COMMAND, Key::D);
    let names = |harness: &Panels| -> Vec<String> {
        harness.state().document.scene().lenses.iter().map(|lens| lens.name.clone()).collect()
    };
    assert_eq!(names(&harness), ["colour", "colour 2"]);
    click(&mut harness, "Lower lens");
    assert_eq!(names(&harness), ["colour 2", "colour"]);
    // What is locked stays.
    click(&mut harness, "Lock colour 2");
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(names(&harness).len(), 2);
    click(&mut harness, "Lock colour 2");
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(names(&harness), ["colour"]);
}

#[test]
fn what_is_clicked_is_what_is_shown_there() {
    let mut harness = window();
    let at = middle(&harness);
    click_at(&mut harness, at);
    let state = harness.state();
    let frame = state.frame.as_ref().unwrap();
    let [w, h] = frame.view.size;
    let (ids, _) = frame.shown.as_ref().unwrap();
    let there = ids[(h / 2 * w + w / 2) as usize].checked_sub(1);
    assert!(there.is_some(), "a look at the middle of the city");
    assert_eq!(state.chosen.object, there);
    let name = state.city.as_ref().unwrap().model.objects[there.unwrap() as usize].id.to_string();
    assert!(harness.query_all_by_label(&name).count() > 0, "the panel tells of {name}");
}

#[test]
fn objects_are_found_shown_hidden_and_coloured() {
    let mut harness = window();
    press(&mut harness, Modifiers::COMMAND, Key::F);
    harness.get_by_label("Find by id, type or attribute").focus();
    harness.step();
    harness.event(egui::Event::Text("church".to_owned()));
    harness.step();
    harness.step();
    harness.query_all_by_label_contains("church  ").next().expect("the church is found").click();
    harness.step();
    harness.step();
    let object = harness.state().chosen.object.expect("it is chosen");
    assert_eq!(&*harness.state().city.as_ref().unwrap().model.objects[object as usize].id, "church");
    click(&mut harness, "Hide");
    assert_eq!(harness.state().document.scene().lenses[0].name, "hidden objects");
    click(&mut harness, "Show all");
    assert!(harness.state().document.scene().lenses.is_empty());
    harness.state_mut().document.set("style.effects=[{ effect = \"thematic\", attribute = \"function\" }]").unwrap();
    until_drawn(&mut harness);
}

#[test]
fn who_finds_nothing_types_on() {
    let mut harness = window();
    press(&mut harness, Modifiers::COMMAND, Key::F);
    write(&mut harness, "zzz");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    press(&mut harness, Modifiers::NONE, Key::L);
    assert!(harness.state().document.scene().lenses.is_empty(), "a letter is no command there");
    press(&mut harness, Modifiers::COMMAND, Key::A);
    write(&mut harness, "church");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.state().chosen.object.is_some());
    arrive(&mut harness);
    press(&mut harness, Modifiers::NONE, Key::L);
    assert_eq!(harness.state().document.scene().lenses.len(), 1, "where something was found keys are for the picture");
    assert!(harness.state().chosen.lens.is_some());
}

#[test]
fn ways_of_the_eye_are_taken_back_one_by_one() {
    let mut harness = window();
    let mut seen = Vec::new();
    for key in [Key::Num7, Key::Num1] {
        press(&mut harness, Modifiers::NONE, key);
        arrive(&mut harness);
        seen.push(harness.state().camera().unwrap());
        std::thread::sleep(Duration::from_millis(800));
    }
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().camera().unwrap(), seen[0]);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(harness.state().camera().unwrap(), seen[1]);
}

#[test]
fn a_part_has_the_attributes_of_what_it_is_part_of() {
    let mut harness = window();
    let part = harness.state().city.as_ref().unwrap().model.find_object("house-009-body");
    harness.state_mut().chosen.object = Some(part.expect("the city has it"));
    harness.run_steps(3);
    for label in ["As part of house-009:", "yearOfConstruction", "bakery"] {
        assert!(harness.query_all_by_label(label).count() > 0, "there is no \"{label}\"");
    }
    assert_eq!(harness.query_all_by_label("It has no attributes.").count(), 0);
    harness.check_accessibility();
}

#[test]
fn what_cannot_be_opened_is_said_and_the_city_stays() {
    let mut harness = window();
    harness.state_mut().open(&[PathBuf::from("/nowhere/at.city.json")]);
    until(&mut harness, "the message", |window| !window.is_loading());
    assert!(harness.state().city.is_some(), "what was there stays");
    assert!(harness.query_all_by_label_contains("/nowhere/at.city.json").count() > 0, "the message names the file");
}

#[test]
fn all_that_can_be_done_is_listed_with_its_key() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F1);
    for label in ["Keys and mouse", "Add colour lens", "Frame all", "Undo", "Export figure…"] {
        assert!(harness.query_all_by_label(label).count() > 0, "there is no \"{label}\"");
    }
    click(&mut harness, "Close");
    press(&mut harness, Modifiers::NONE, Key::T);
    until_drawn(&mut harness);
    assert!(harness.query_all_by_label("What it costs").count() > 0);
}

#[test]
fn a_way_is_drawn_and_becomes_a_lens() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::K);
    let at = middle(&harness);
    for shift in [egui::vec2(-60.0, 0.0), egui::vec2(0.0, 30.0), egui::vec2(70.0, 10.0)] {
        click_at(&mut harness, at + shift);
    }
    assert_eq!(harness.state().drawing().map(|drawing| drawing.points.len()), Some(3), "three places are measured");
    assert!(harness.state().document.scene().lenses.is_empty(), "measuring changes nothing");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().drawing().is_none());
    let context = harness.ctx.clone();
    for (figure, corners) in [(Figure::Route, 2), (Figure::Area, 3)] {
        harness.state_mut().act(&context, Action::Draw(figure));
        harness.step();
        for shift in &[egui::vec2(-60.0, 0.0), egui::vec2(0.0, 40.0), egui::vec2(70.0, 0.0)][..corners] {
            click_at(&mut harness, at + *shift);
        }
        press(&mut harness, Modifiers::NONE, Key::Enter);
        assert!(harness.state().drawing().is_none());
    }
    let lenses = &harness.state().document.scene().lenses;
    assert_eq!(lenses.iter().map(|lens| lens.name.as_str()).collect::<Vec<_>>(), ["route", "area"]);
    until_drawn(&mut harness);
}

#[test]
fn wheel_keys_and_drags_go_the_way_they_say() {
    let mut harness = window();
    arrive(&mut harness);
    let start = harness.state().camera().unwrap();
    let basis = start.basis().unwrap();
    let away = |harness: &Panels| {
        let now = harness.state().camera().unwrap();
        (now.eye.distance(start.target), (now.eye - start.eye).dot(basis.right), now.eye.z - start.eye.z)
    };
    let back = |harness: &mut Panels| {
        harness.state_mut().document.look(start);
        until_drawn(harness);
    };
    let far = start.eye.distance(start.target);
    let at = middle(&harness);
    for (points, is_nearer) in [(60.0, true), (-60.0, false)] {
        harness.hover_at(at);
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, points),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
            modifiers: Modifiers::NONE,
        });
        harness.run_steps(8);
        let distance = away(&harness).0;
        assert!(if is_nearer { distance < 0.98 * far } else { distance > 1.02 * far }, "{points}: {far} to {distance}");
        back(&mut harness);
    }
    // Keys: to which side the eye goes, and whether up.
    for (key, side, up) in [
        (Key::ArrowRight, -1.0, 0.0),
        (Key::ArrowLeft, 1.0, 0.0),
        (Key::ArrowUp, 0.0, 1.0),
        (Key::ArrowDown, 0.0, -1.0),
    ] {
        harness.key_down(key);
        harness.run_steps(4);
        harness.key_up(key);
        harness.step();
        let (distance, right, higher) = away(&harness);
        assert!((distance - far).abs() < 1e-6 * far, "{key:?}: the eye goes around");
        let is_right = |way: f64, wanted: f64| if wanted == 0.0 { way.abs() < 1e-3 * far } else { way * wanted > 1e-3 };
        assert!((side == 0.0 || is_right(right, side)) && is_right(higher, up), "{key:?}: {right} {higher}");
        back(&mut harness);
    }
    for (key, is_nearer) in [(Key::Plus, true), (Key::Minus, false)] {
        harness.key_down(key);
        harness.run_steps(4);
        harness.key_up(key);
        harness.step();
        let distance = away(&harness).0;
        assert!(if is_nearer { distance < far } else { distance > far }, "{key:?}: {far} to {distance}");
        back(&mut harness);
    }
    // What is before the place that is held goes with the pointer.
    drag(&mut harness, at, at + egui::vec2(80.0, 0.0));
    assert!(away(&harness).1 < -1e-3 * far, "{:?}", away(&harness));
    back(&mut harness);
    drag(&mut harness, at, at + egui::vec2(0.0, 40.0));
    assert!(away(&harness).2 > 1e-3 * far, "{:?}", away(&harness));
    back(&mut harness);
    // Looking around, all of it does.
    harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND));
    drag(&mut harness, at, at + egui::vec2(80.0, 40.0));
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.step();
    let forward = harness.state().camera().unwrap().basis().unwrap().forward;
    assert!(forward.dot(basis.right) < -0.01 && forward.dot(basis.up) > 0.01, "{forward}");
    assert!((harness.state().camera().unwrap().eye - start.eye).length() < 1e-9 * far, "the eye stays");
}

#[test]
fn who_walks_stays_on_the_ground() {
    let mut harness = window();
    let context = harness.ctx.clone();
    harness.state_mut().act(&context, Action::ToggleWalk);
    let high = harness.state().camera().unwrap().eye.z;
    until(&mut harness, "the ground", |window| window.camera().is_some_and(|camera| camera.eye.z < high));
    arrive(&mut harness);
    let low = harness.state().camera().unwrap();
    let extent = harness.state().city.as_ref().unwrap().extent;
    assert!(
        low.eye.z < extent.max.z && low.eye.z > extent.min.z,
        "{low:?} is at the height of eyes, above the terrain of {extent:?}"
    );
    assert!((low.target.z - low.eye.z).abs() < 1e-6, "{low:?} looks level");
    let before = low.eye;
    harness.key_down(Key::W);
    harness.run_steps(4);
    harness.key_up(Key::W);
    harness.step();
    let after = harness.state().camera().unwrap().eye;
    assert!((after - before).truncate().length() > 0.01, "{before} {after}");
    // From the air, before what is chosen: outside of it, and it is what is looked at.
    let church = {
        let model = &harness.state().city.as_ref().unwrap().model;
        model.objects.iter().position(|own| &*own.id == "church").expect("the square has a church") as u32
    };
    harness.state_mut().act(&context, Action::ToggleWalk);
    harness.state_mut().act(&context, Action::Look(Axis::Top));
    arrive(&mut harness);
    harness.state_mut().chosen.object = Some(church);
    harness.state_mut().act(&context, Action::ToggleWalk);
    arrive(&mut harness);
    let there = harness.state().camera().unwrap();
    let bounds = harness.state().city.as_ref().unwrap().model.family_bounds(church);
    let aside = (there.target - there.eye).angle_between(bounds.center() - there.eye);
    assert!(aside < 0.3, "{there:?} looks at {bounds:?}");
    let outside = (there.eye - bounds.center()).abs().truncate() - 0.5 * bounds.size().truncate();
    assert!(outside.max_element() > 0.0 && there.eye.z < bounds.max.z, "{there:?} stands before {bounds:?}");
}

/// An eye that is given above the ground is moved as any other, and goes on being given so.
#[test]
fn an_eye_above_the_ground_is_moved_like_others() {
    let mut ends = Vec::new();
    let mut start = None;
    for above_ground in [true, false] {
        let mut harness = window();
        let context = harness.ctx.clone();
        until(&mut harness, "the ground", |window| window.city.as_ref().is_some_and(|city| city.index.get().is_some()));
        if above_ground {
            let number = harness.state().camera().unwrap().eye.z;
            harness.state_mut().document.set("camera.above_ground=true").unwrap();
            let there = harness.state().camera().unwrap();
            let extent = harness.state().city.as_ref().unwrap().extent;
            let ground = there.eye.z - number;
            assert!((extent.min.z - 1.0..extent.max.z).contains(&ground), "{ground} is ground of {extent:?}");
            start = Some(there);
        } else {
            harness.state_mut().document.look(start.unwrap());
        }
        harness.step();
        harness.state_mut().act(&context, Action::Look(Axis::Top));
        arrive(&mut harness);
        assert_eq!(harness.state().document.scene().camera_above_ground, above_ground);
        ends.push(harness.state().camera().unwrap());
    }
    assert!(
        (ends[0].eye - ends[1].eye).length() < 1e-6 && (ends[0].target - ends[1].target).length() < 1e-6,
        "{ends:?}"
    );
}

/// A scene that is saved away from its city can be edited and exported on, and opened again when that is allowed.
#[test]
fn a_scene_is_kept_away_from_its_city() {
    let folder = std::env::temp_dir().join(format!("veduta-window-outside-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (file, figure) = (folder.join("s.toml"), folder.join("f.png"));
    let mut harness = window();
    let square = harness.state().camera();
    harness.state_mut().open(&[PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("citydata/courtyard.city.json")]);
    // While it loads, pictures of the city before are asked for.
    for width in 0..40 {
        if !harness.state().is_loading() {
            break;
        }
        harness.set_size(egui::vec2(1200.0 + width as f32, 800.0));
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    until(&mut harness, "the other city", |window| !window.is_loading());
    until_drawn(&mut harness);
    assert_ne!(harness.state().camera(), square, "it is looked at from where it is seen");
    harness.state_mut().save(&file);
    harness.step();
    assert!(harness.query_all_by_label_contains("need --allow-outside").count() > 0);
    assert!(harness.state().command_line().unwrap().ends_with(" --allow-outside"));
    harness.state_mut().document.set("figure.size=[64, 48]").unwrap();
    harness.state_mut().save(&file);
    harness.state_mut().export(&figure);
    harness.step();
    let started = Instant::now();
    while harness.query_all_by_label_contains("is written").count() == 0 {
        assert!(started.elapsed() < PATIENCE, "waited in vain for the figure");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
    assert!(figure.exists());
    assert!(
        harness.query_all_by_label_contains("f.png is written. The same without a window: veduta render").count() > 0
    );
    for answer in ["Cancel", "Allow"] {
        harness.state_mut().open(&[PathBuf::from("builtin:square")]);
        until(&mut harness, "the square", |window| !window.is_loading());
        harness.state_mut().open(std::slice::from_ref(&file));
        harness.run_steps(3);
        assert!(harness.query_all_by_label_contains("courtyard.city.json").count() > 0, "what is read is told");
        click(&mut harness, answer);
        until(&mut harness, "an end", |window| !window.is_loading());
        harness.run_steps(3);
        assert_eq!(harness.state().document.file().is_some(), answer == "Allow");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Whatever lens a pixel is seen through, a click there means what the shown surface is, and where it is.
#[test]
fn a_pick_is_the_shown_surface_under_every_kind_of_lens() {
    let shape = "shape = { kind = \"sphere\", center = [0, 0, 5], radius = 70 }";
    let poi = "[[poi]]\nname = \"p\"\nobject = \"church\"\n";
    let kinds = [
        ("colour", "", format!("{shape}\neffects = [\"sepia\"]")),
        ("eraser", "", format!("{shape}\neffects = [\"eraser\"]")),
        ("x-ray", "", format!("{shape}\neffects = [\"x-ray\"]")),
        ("flat", "", format!("kind = \"content\"\n{shape}\ncontent = {{ derive = \"flat\" }}")),
        ("occlusion", poi, "kind = \"occlusion\"\npoi = \"p\"\nrender = \"discard\"".to_owned()),
        (
            "twist",
            "",
            format!("kind = \"deformation\"\n{shape}\ndeform = [{{ kind = \"scale\", factors = [1, 1, 2] }}]"),
        ),
        ("view", poi, "kind = \"best-view\"\npoi = \"p\"".to_owned()),
    ];
    for (name, pois, lens) in kinds {
        let text = format!(
            "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [14, -112, 35]\ntarget = [-30, -14, 5]\n{pois}\
             [[lens]]\nname = \"{name}\"\n{lens}\n"
        );
        let scene = parse(&text, name, &Options::for_command_line()).unwrap_or_else(|error| panic!("{error}"));
        let mut harness = window();
        harness.state_mut().document.edit("the lens", |own| *own = scene.clone());
        until_drawn(&mut harness);
        let frame = harness.state().frame.as_ref().unwrap();
        let size = frame.view.size;
        let model = harness.state().city.as_ref().unwrap().model.clone();
        let mut studio = Studio::new(Gpu::open().unwrap(), model, &scene.city).unwrap();
        let aovs = Aovs { depth: true, object_id: true, ..Aovs::default() };
        let request = Request { aovs, ..Request::plain(size) };
        let picture = studio.render(&scene, &request).unwrap();
        let (ids, depths) = (picture.object_id.unwrap(), picture.depth.unwrap());
        let mut seen = 0;
        for (x, y) in (0..size[1]).step_by(37).flat_map(|y| (0..size[0]).step_by(31).map(move |x| (x, y))) {
            let i = (y * size[0] + x) as usize;
            let picked = pick(frame, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            assert_eq!(
                picked.map(|hovered| hovered.object),
                depths[i].is_finite().then(|| ids[i].checked_sub(1)),
                "{name}"
            );
            if let Some(hovered) = picked {
                // Where it is: at that pixel, as deep as it is shown.
                let back = frame.view.pixel(hovered.at).unwrap();
                assert!(
                    (back.truncate() - DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)).length() < 1e-3,
                    "{name}: {back}"
                );
                assert!(
                    (frame.view.depth(hovered.at) - f64::from(depths[i])).abs() < 1e-5 * f64::from(depths[i]),
                    "{name}"
                );
                seen += 1;
            }
        }
        assert!(seen > 100, "{name}: {seen}");
    }
}

#[test]
fn edits_are_not_lost_unasked() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::L);
    press(&mut harness, Modifiers::COMMAND, Key::Q);
    assert!(!harness.state().quits());
    click(&mut harness, "Cancel");
    assert!(!harness.state().quits() && harness.query_all_by_label("Lose them").count() == 0);
    press(&mut harness, Modifiers::COMMAND, Key::Q);
    click(&mut harness, "Lose them");
    assert!(harness.state().quits());
    // Looking around is nothing to be asked about.
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::Num5);
    press(&mut harness, Modifiers::COMMAND, Key::Q);
    assert!(harness.state().quits());
}

#[test]
fn a_level_of_detail_and_more_files_are_edits_that_load_again() {
    let mut harness = window();
    let count = |harness: &Panels| harness.state().city.as_ref().map_or(0, |city| city.model.objects.len());
    let square = count(&harness);
    harness.state_mut().add_files(&[PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("citydata/rooms.city.json")]);
    harness.step();
    until(&mut harness, "both cities", |window| !window.is_loading() && window.frame.is_some());
    assert!(count(&harness) > square, "{square} objects before, {} now", count(&harness));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    until(&mut harness, "the first one alone", |window| !window.is_loading() && window.frame.is_some());
    assert_eq!(count(&harness), square);
    // What cannot be loaded is taken back.
    harness.state_mut().add_files(&[PathBuf::from("/nowhere/b.city.json")]);
    harness.step();
    until(&mut harness, "the message", |window| !window.is_loading());
    harness.run_steps(3);
    assert_eq!((count(&harness), harness.state().document.scene().city.files.len()), (square, 1));
}

#[test]
fn a_figure_is_shown_as_it_will_be() {
    let mut harness = window();
    let text = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [14, -112, 35]\ntarget = [-30, -14, 5]\n[[poi]]\nname = \"p\"\n\
                object = \"church\"\n[[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"p\"\n\
                [[overlay]]\nlens = \"v\"\nsize = [240, 160]\n[figure]\nsize = [2000, 1000]\ntitle = \"A title\"\n";
    let scene = parse(text, "preview", &Options::for_command_line()).unwrap_or_else(|error| panic!("{error}"));
    harness.state_mut().document.edit("the scene", |own| *own = scene.clone());
    until_drawn(&mut harness);
    let share = |harness: &Panels| {
        let frame = harness.state().frame.as_ref().unwrap();
        frame.overlays[0].size.map(|side| f64::from(side) / f64::from(frame.view.size[0]))
    };
    let in_window = share(&harness);
    press(&mut harness, Modifiers::NONE, Key::P);
    until(&mut harness, "the figure", |window| {
        window.frame.as_ref().is_some_and(|frame| frame.view.size[0] == 2 * frame.view.size[1] && frame.shown.is_some())
    });
    // As large as in the figure itself, but for what whole pixels are; in the window its pixels are the window's.
    let as_figure = share(&harness);
    let model = harness.state().city.as_ref().unwrap().model.clone();
    let mut studio = Studio::new(Gpu::open().unwrap(), model, &scene.city).unwrap();
    let request = Request { statistics: true, ..Request::plain(scene.figure.size) };
    let told = figure::draw(&mut studio, &scene, &request).unwrap().statistics.overlays.remove(0);
    for (side, key) in as_figure.into_iter().zip(["width", "height"]) {
        assert!((side - told[key].as_f64().unwrap() / 2000.0).abs() < 3e-3, "{key}: {side} of the picture, {told}");
    }
    assert!(in_window[0] > 1.5 * as_figure[0], "{in_window:?}");
    assert_eq!(harness.state().frame.as_ref().unwrap().scene.figure.title.as_deref(), Some("A title"));
}

/// The picture that the window shows, in its shape and with its overlays, as a file and in the clipboard.
#[test]
fn what_the_window_shows_is_exported_and_copied() {
    let folder = std::env::temp_dir().join(format!("veduta-window-shown-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut harness = window();
    let text = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [14, -112, 35]\ntarget = [-30, -14, 5]\n[[poi]]\nname = \"p\"\n\
                object = \"church\"\n[[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"p\"\n[figure]\nsize = [200, 300]\nsamples = 1\ntitle = \"A title\"\n";
    let scene = parse(text, "shown", &Options::for_command_line()).unwrap_or_else(|error| panic!("{error}"));
    harness.state_mut().document.edit("the scene", |own| *own = scene.clone());
    until_drawn(&mut harness);
    let size = harness.state().frame.as_ref().unwrap().view.size;
    assert_eq!(harness.state().shown_size(), Some(size));
    press(&mut harness, Modifiers::COMMAND, Key::E);
    assert!(harness.query_all_by_label_contains("(see Figure): 200 × 300 pixels, 1 sample each").count() == 1);
    harness.get_by_label_contains("As the window shows it").click();
    harness.run_steps(3);
    let file = folder.join("shown.png");
    harness.get_by_role_and_label(egui::Role::TextInput, "File").focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::A);
    write(&mut harness, &file.display().to_string());
    click(&mut harness, "Export");
    let started = Instant::now();
    while harness.query_all_by_label_contains("is written").count() == 0 {
        assert!(started.elapsed() < PATIENCE, "waited in vain for the picture");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
    assert!(harness.query_all_by_label_contains("without a window").count() == 0, "no command makes it again");
    let written = image::open(&file).unwrap().into_rgba8();
    let model = harness.state().city.as_ref().unwrap().model.clone();
    let mut studio = Studio::new(Gpu::open().unwrap(), model, &scene.city).unwrap();
    let mut untitled = scene.clone();
    untitled.figure.title = None;
    let drawn = figure::draw(&mut studio, &untitled, &Request::plain(size)).unwrap();
    assert_eq!([written.width(), written.height()], size);
    assert!(written.as_raw() == drawn.rgba.as_flattened(), "the picture of the window, and its overlay");
    // The clipboard gets what is seen.
    until_drawn(&mut harness);
    // In one frame, whose output tells it.
    let modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
    let (key, physical_key) = (Key::C, None);
    harness.input_mut().events.push(egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers });
    harness.step();
    let copied = harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyImage(image) => Some(image.clone()),
        _ => None,
    });
    let copied = copied.expect("a picture");
    let frame = harness.state().frame.as_ref().unwrap();
    let seen: Vec<[u8; 4]> = copied.pixels.iter().map(egui::Color32::to_array).collect();
    assert!(copied.size == size.map(|side| side as usize) && seen == frame.rgba, "what is seen");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Looks are chosen by pictures, in a panel that stays as wide as it is.
#[test]
fn a_look_is_chosen_by_its_picture() {
    let mut harness = window();
    let before = harness.get_by_label("City").rect().width();
    click(&mut harness, "Style");
    harness.run_steps(20);
    assert_eq!(harness.get_by_label("City").rect().width(), before, "the panel grows");
    let paper = |harness: &Panels| harness.state().document.scene().style.look;
    assert_eq!(paper(&harness), StyleLook::Natural);
    let pictures = harness.query_all_by_role(egui::Role::RadioButton).count();
    assert_eq!(pictures, 5);
    harness.get_by_role_and_label(egui::Role::RadioButton, "paper").click();
    harness.run_steps(3);
    assert_eq!(paper(&harness), StyleLook::Paper);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(paper(&harness), StyleLook::Natural, "it is an edit");
}
