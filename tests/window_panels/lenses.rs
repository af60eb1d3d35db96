//! Lenses in their list, in the picture and over it.

use glam::{DQuat, DVec2, DVec3};
use veduta::{app::lens_list::State, geom::Shape, lens::Region};

use super::*;

fn names(harness: &Panels) -> Vec<String> {
    harness.state().document.scene().lenses.iter().map(|lens| lens.name.clone()).collect()
}

/// The built-in city with more of a scene, once it is drawn.
fn with(scene: &str) -> Panels {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [14, -112, 35]\ntarget = [-30, -14, 5]\n{scene}"
    );
    let scene = parse(&text, "scene", &Options::for_command_line()).unwrap_or_else(|error| panic!("{error}"));
    let mut harness = window();
    harness.state_mut().document.edit("the scene", |own| *own = scene);
    until_drawn(&mut harness);
    harness.check_accessibility();
    harness
}

const TWO: &str = "[[lens]]\nname = \"low\"\nshape = { kind = \"sphere\", center = [-30, -14, 5], radius = 12 }\neffects = [\"sepia\"]\n\
                   [[lens]]\nname = \"high\"\nshape = { kind = \"sphere\", center = [0, -30, 5], radius = 9 }\neffects = [\"greyscale\"]\n";

#[test]
fn a_lens_gets_another_name_wherever_it_is_named() {
    let mut harness = with(
        "[[poi]]\nname = \"p\"\nobject = \"church\"\n[[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"p\"\n\
         [[overlay]]\nlens = \"v\"\nat = [0.25, 0.3]\n",
    );
    click(&mut harness, "v");
    click(&mut harness, "Lock v");
    press(&mut harness, Modifiers::NONE, Key::F2);
    assert_eq!(harness.query_all_by_label("Name of the lens").count(), 0, "it is locked");
    click(&mut harness, "Lock v");
    press(&mut harness, Modifiers::NONE, Key::F2);
    harness.get_by_label("Name of the lens").focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::A);
    write(&mut harness, "church view");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(names(&harness), ["church view"]);
    assert_eq!(harness.state().document.scene().overlays[0].lens, "church view");
    // A lock is the lens', not its name's.
    click(&mut harness, "Lock church view");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(names(&harness), ["v"]);
    assert!(harness.state().is_locked(&harness.state().document.scene().lenses[0]));
    // What is no name is refused, and said.
    click(&mut harness, "Lock v");
    press(&mut harness, Modifiers::NONE, Key::F2);
    harness.get_by_label("Name of the lens").focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::A);
    press(&mut harness, Modifiers::NONE, Key::Backspace);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(names(&harness), ["v"]);
    assert!(harness.query_all_by_label_contains("name").count() > 0);
}

#[test]
fn the_list_is_the_order_and_rows_are_dragged() {
    let mut harness = with(TWO);
    assert_eq!(names(&harness), ["low", "high"]);
    let row = |harness: &Panels, name: &str| harness.get_by_label(name).rect().center();
    let [low, high] = ["low", "high"].map(|name| row(&harness, name));
    assert!(high.y < low.y, "the top one is the first");
    // By the grip, left of all else.
    let grip = |harness: &Panels, name: &str| {
        let toggle = harness.get_by_label(&format!("{name} is on")).rect();
        egui::pos2(toggle.left() - 10.0, toggle.center().y)
    };
    let (from, to) = (grip(&harness, "high"), grip(&harness, "low"));
    drag(&mut harness, from, to);
    assert_eq!(names(&harness), ["high", "low"]);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(names(&harness), ["low", "high"]);
}

#[test]
fn states_of_lenses_are_seen_in_the_list_and_in_the_picture() {
    let mut harness = with(TWO);
    let state = |harness: &Panels| [0, 1].map(|lens| harness.state().state_of(lens));
    assert_eq!(state(&harness), [State::Normal; 2]);
    let over = harness.get_by_label("low").rect().center();
    harness.hover_at(over);
    harness.run_steps(3);
    assert_eq!(state(&harness), [State::RollOver, State::Normal]);
    // Its handle, where its middle is.
    let spot = spot(&harness, DVec3::new(0.0, -30.0, 5.0));
    harness.hover_at(spot);
    harness.run_steps(3);
    assert_eq!(state(&harness), [State::Normal, State::RollOver]);
    click_at(&mut harness, spot);
    assert_eq!((state(&harness), harness.state().chosen.lens), ([State::Normal, State::Selected], Some(1)));
    press(&mut harness, Modifiers::NONE, Key::X);
    assert_eq!(state(&harness), [State::Normal, State::Disabled]);
    // It is moved by its handle again once it is on.
    press(&mut harness, Modifiers::NONE, Key::X);
    drag(&mut harness, spot, spot + egui::vec2(40.0, 10.0));
    let lens = harness.state().document.scene().lenses[1].clone();
    assert_ne!(format!("{:?}", lens.shapes), format!("{:?}", parse_lens(TWO)), "it was moved");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    let lens = harness.state().document.scene().lenses[1].clone();
    assert_eq!(format!("{:?}", lens.shapes), format!("{:?}", parse_lens(TWO)), "one drag is one edit");
}

/// Where a place is shown in the window.
fn spot(harness: &Panels, place: DVec3) -> egui::Pos2 {
    let frame = harness.state().frame.as_ref().unwrap();
    let city = harness.get_by_label("City").rect();
    let pixel = frame.view.pixel(place).unwrap();
    city.min + egui::vec2(pixel.x as f32, pixel.y as f32) * (city.width() / frame.view.size[0] as f32)
}

/// The first shape of the first lens.
fn shape(harness: &Panels) -> Region {
    harness.state().document.scene().lenses[0].shapes[0].clone()
}

#[test]
fn sides_points_and_turns_are_dragged_in_the_picture() {
    let lens = |shape: &str| format!("[[lens]]\nname = \"held\"\neffects = [\"sepia\"]\nshape = {{ {shape} }}\n");
    let mut harness = with(&lens("kind = \"box\", center = [-10, -20, 6], size = [30, 24, 12]"));
    click(&mut harness, "held");
    let Region::Shape(Shape::Box { center, size, .. }) = shape(&harness) else { panic!("a box") };
    let east = center + DVec3::new(0.5 * size.x, 0.0, 0.0);
    let (from, to) = (spot(&harness, east), spot(&harness, east - DVec3::new(6.0, 0.0, 0.0)));
    drag(&mut harness, from, to);
    let Region::Shape(Shape::Box { center: now, size: wide, .. }) = shape(&harness) else { panic!("a box") };
    assert!((size - wide - DVec3::new(6.0, 0.0, 0.0)).length() < 0.05, "{wide}");
    assert!((center - now - DVec3::new(3.0, 0.0, 0.0)).length() < 0.05, "its west side stays: {now}");
    // A sixth of a turn, by the arrow beyond its east side.
    until_drawn(&mut harness);
    let (middle, side) = (spot(&harness, now), spot(&harness, now + DVec3::new(0.5 * wide.x, 0.0, 0.0)));
    let arrow = side + 26.0 * (side - middle).normalized();
    let angle = std::f64::consts::FRAC_PI_3;
    let level = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let to = spot(&harness, now + 20.0 * level);
    drag(&mut harness, arrow, to);
    let Region::Shape(Shape::Box { rotation, center: same, .. }) = shape(&harness) else { panic!("a box") };
    let x = rotation * DVec3::X;
    assert!(same == now && (x.y.atan2(x.x) - angle).abs() < 0.05, "{} degrees", x.y.atan2(x.x).to_degrees());
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(shape(&harness), Region::Shape(Shape::Box { center, size, rotation: DQuat::IDENTITY }), "two edits");

    let mut harness = with(&lens(
        "kind = \"corridor\", points = [[-30, -30, 1], [-5, -25, 1], [10, -45, 1]], width = 8, height = 20",
    ));
    click(&mut harness, "held");
    let (from, to) = (DVec3::new(10.0, -45.0, 1.0), DVec3::new(14.0, -38.0, 1.0));
    let ends = [spot(&harness, from), spot(&harness, to)];
    drag(&mut harness, ends[0], ends[1]);
    let Region::Shape(Shape::Corridor { points, width, .. }) = shape(&harness) else { panic!("a corridor") };
    assert!(points[2].distance(to) < 0.05 && width == 8.0, "{points:?}");
    assert_eq!(points[..2], [DVec3::new(-30.0, -30.0, 1.0), DVec3::new(-5.0, -25.0, 1.0)], "nothing else moves");
}

/// As a picture of a best-view lens is: whoever drags a disc means its lens. A locked one stays, and the eye turns.
#[test]
fn a_disc_is_dragged_before_its_lens_is_chosen() {
    let text = "[[lens]]\nname = \"held\"\neffects = [\"sepia\"]\nshape = { kind = \"sphere\", center = [-10, -20, 6], radius = 9 }\n";
    for is_locked in [false, true] {
        let mut harness = with(text);
        if is_locked {
            click(&mut harness, "Lock held");
        }
        harness.state_mut().chosen.lens = None;
        until_drawn(&mut harness);
        let eye = harness.state().camera();
        let (from, to) = (DVec3::new(-10.0, -20.0, 6.0), DVec3::new(-3.0, -26.0, 6.0));
        let ends = [spot(&harness, from), spot(&harness, to)];
        drag(&mut harness, ends[0], ends[1]);
        let Region::Shape(Shape::Sphere { center, .. }) = shape(&harness) else { panic!("a sphere") };
        assert!(center.distance(if is_locked { from } else { to }) < 0.05, "locked {is_locked}: {center}");
        assert_eq!(harness.state().chosen.lens, (!is_locked).then_some(0));
        assert_eq!(harness.state().camera() == eye, !is_locked);
    }
}

#[test]
fn what_is_attached_is_moved_from_where_it_is_attached() {
    let mut harness = with(
        "[[poi]]\nname = \"p\"\nat = [-10, -20, 6]\n\
         [[lens]]\nname = \"held\"\neffects = [\"sepia\"]\nattached_to = { poi = \"p\" }\n\
         shape = { kind = \"sphere\", center = [5, 0, 0], radius = 9 }\n",
    );
    let before = harness.get_by_label("City").rect();
    click(&mut harness, "held");
    harness.check_accessibility();
    assert_eq!(harness.get_by_label("City").rect(), before, "values of the lens make their panel wider");
    let (from, to) = (DVec3::new(-5.0, -20.0, 6.0), DVec3::new(2.0, -26.0, 6.0));
    let ends = [spot(&harness, from), spot(&harness, to)];
    drag(&mut harness, ends[0], ends[1]);
    let Region::Shape(Shape::Sphere { center, radius }) = shape(&harness) else { panic!("a sphere") };
    assert!(center.distance(DVec3::new(12.0, -6.0, 0.0)) < 0.05 && radius == 9.0, "{center}");
    press(&mut harness, Modifiers::NONE, Key::F);
    arrive(&mut harness);
    let target = harness.state().camera().unwrap().target;
    assert!(target.distance(to) < 9.0, "its middle is looked at: {target}");
    // Of an object and a lens what was chosen last.
    let church = harness.state().city.as_ref().unwrap().model.find_object("church");
    harness.state_mut().chosen.object = church;
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::F);
    arrive(&mut harness);
    assert!(harness.state().camera().unwrap().target.distance(to) > 9.0, "the object is looked at");
    // Its row stands above its values.
    harness.query_all_by_label("held").next().unwrap().click();
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::F);
    arrive(&mut harness);
    assert!(harness.state().camera().unwrap().target.distance(to) < 9.0, "the lens is, again");
}

/// The shapes of the second lens.
fn parse_lens(text: &str) -> Vec<veduta::lens::Region> {
    let scene = parse(&format!("veduta = 1\n{text}"), "scene", &Options::for_command_line()).unwrap();
    scene.lenses[1].shapes.clone()
}

/// Over the picture of an overlay.
fn overlay(harness: &Panels, index: usize) -> egui::Pos2 {
    let frame = harness.state().frame.as_ref().unwrap();
    let city = harness.get_by_label("City").rect();
    let scale = city.width() / frame.view.size[0] as f32;
    let own = frame.overlays[index];
    city.min
        + egui::vec2(own.at[0] as f32 + 0.5 * own.size[0] as f32, own.at[1] as f32 + 0.5 * own.size[1] as f32) * scale
}

#[test]
fn overlays_are_dragged_entered_and_have_their_values() {
    let mut harness =
        with("[[poi]]\nname = \"p\"\nobject = \"church\"\n[[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"p\"\n");
    let own = harness.state().frame.as_ref().unwrap().overlays[0];
    let to = own.camera.expect("it is a view");
    let at = overlay(&harness, 0);
    let city = harness.get_by_label("City").rect();
    let there = city.min + 0.5 * city.size();
    drag(&mut harness, at, there);
    let place = harness.state().document.scene().overlays[0].clone();
    assert_eq!(place.lens, "v");
    until_drawn(&mut harness);
    assert!(overlay(&harness, 0).distance(there) < 6.0, "{} {there}", overlay(&harness, 0));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.state().document.scene().overlays.is_empty(), "one drag is one edit");
    until_drawn(&mut harness);
    // All its values are with its lens.
    assert!(harness.query_all_by_label("Opacity").count() > 0);
    // A click goes to where its eye is.
    let at = overlay(&harness, 0);
    click_at(&mut harness, at);
    arrive(&mut harness);
    let now = harness.state().camera().unwrap();
    assert!(now.eye.distance(to.eye) < 1e-6 && now.target.distance(to.target) < 1e-6, "{now:?} {to:?}");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(
        harness.state().camera().unwrap().eye.distance(DVec3::new(14.0, -112.0, 35.0)) < 1e-9,
        "one flight is one edit"
    );
}

#[test]
fn a_portal_is_stepped_through_and_leads_back() {
    let mut harness = with(
        "[[lens]]\nname = \"gate\"\nkind = \"portal\"\nview = { kind = \"camera\", eye = [60, 40, 20], target = [0, 0, 5] }\n",
    );
    let before = harness.state().camera().unwrap();
    let at = overlay(&harness, 0);
    click_at(&mut harness, at);
    let beyond = harness.state().camera().unwrap();
    assert_eq!(beyond.eye, DVec3::new(60.0, 40.0, 20.0));
    until_drawn(&mut harness);
    let at = overlay(&harness, 0);
    click_at(&mut harness, at);
    assert_eq!(harness.state().camera().unwrap().eye, before.eye);
}

#[test]
fn a_magnifier_is_held_by_its_middle_and_rim_and_the_wheel_magnifies() {
    use veduta::lens::ray::Bend;
    let mut harness = with("");
    harness.state_mut().chosen.lens = None;
    click(&mut harness, "Lens");
    click(&mut harness, "Add magnifier");
    until_drawn(&mut harness);
    let ray = |harness: &Panels| harness.state().document.scene().lenses[0].ray().expect("a magnifier").clone();
    let before = ray(&harness);
    let city = harness.get_by_label("City").rect();
    let at = |ray: &veduta::lens::ray::RayLens| {
        city.min + egui::vec2(ray.center.x as f32, ray.center.y as f32) * city.size()
    };
    // What is picked is what the bent ray meets.
    {
        let frame = harness.state().frame.as_ref().expect("a picture");
        let size = DVec2::from(frame.view.size.map(f64::from));
        let pixel = (before.center * size + DVec2::new(0.4 * before.radius * size.y, 0.0)).floor();
        let picked = pick(frame, pixel + 0.5).expect("a place").at;
        let straight = frame.view.ray(pixel + 0.5).at(frame.view.depth(picked));
        assert!(picked.distance(straight) > 1.0, "{picked} is where a straight ray goes");
        let shown = frame.shown.as_ref().expect("depths").1[(pixel.y * size.x + pixel.x) as usize];
        assert!((frame.view.depth(picked) - f64::from(shown)).abs() < 1e-4 * f64::from(shown));
    }
    drag(&mut harness, at(&before), at(&before) + egui::vec2(60.0, -30.0));
    let moved = ray(&harness);
    assert!(at(&moved).distance(at(&before) + egui::vec2(60.0, -30.0)) < 1.0);
    until_drawn(&mut harness);
    let rim = at(&moved) + egui::vec2(moved.radius as f32 * city.height(), 0.0);
    drag(&mut harness, rim, rim + egui::vec2(24.0, 0.0));
    let wider = ray(&harness);
    assert!((wider.radius - moved.radius - f64::from(24.0 / city.height())).abs() < 2e-3, "{}", wider.radius);
    let mut wheel = |modifiers: Modifiers| {
        harness.hover_at(at(&wider));
        harness.event(egui::Event::ModifiersChanged(modifiers));
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, 60.0),
            modifiers,
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
        });
        harness.run_steps(20);
        harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
        harness.step();
        let Bend::Magnify(magnify) = ray(&harness).bend else { panic!("a magnifier") };
        magnify
    };
    let Bend::Magnify(first) = wider.bend else { panic!("a magnifier") };
    let larger = wheel(Modifiers::NONE);
    assert!(larger.magnification > 1.05 * first.magnification && larger.border == first.border);
    let softer = wheel(Modifiers::ALT);
    assert!(softer.border > first.border && softer.magnification == larger.magnification);
}
