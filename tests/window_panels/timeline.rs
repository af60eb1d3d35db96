//! The timeline: typed, stepped, played and scrubbed.

use veduta::{
    app::timeline::Step,
    time::{Interval, Moment},
};

use super::*;

fn moment(harness: &Panels) -> Option<String> {
    harness.state().document.scene().moment.map(Moment::written)
}

#[test]
fn a_moment_is_typed_stepped_played_and_taken_back() {
    let mut harness = window();
    until_drawn(&mut harness);
    harness.check_accessibility();
    assert_eq!(moment(&harness), None, "all times show at first");
    let typed = |harness: &mut Panels, text: &str| retype(harness, "Moment", text);
    typed(&mut harness, "1650");
    assert_eq!(moment(&harness).as_deref(), Some("1650"));
    click(&mut harness, "Step on in time");
    click(&mut harness, "Step on in time");
    assert_eq!(moment(&harness).as_deref(), Some("1652"), "dates of this city are years");
    click(&mut harness, "Step back in time");
    assert_eq!(moment(&harness).as_deref(), Some("1651"));
    // What is no time is told, and changes nothing.
    typed(&mut harness, "soon");
    assert_eq!(moment(&harness).as_deref(), Some("1651"));
    // Steps in a row are one edit.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(moment(&harness).as_deref(), None);
    press(&mut harness, Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    assert_eq!(moment(&harness).as_deref(), Some("1651"));
    typed(&mut harness, "");
    assert_eq!(moment(&harness), None);
    click(&mut harness, "Play through time");
    harness.step();
    harness.step();
    assert!(harness.state().timeline.plays);
    assert!(moment(&harness).is_some(), "it begins at the beginning");
    click(&mut harness, "Pause");
    assert!(!harness.state().timeline.plays);
}

#[test]
fn a_part_of_the_line_is_played_round() {
    let mut harness = window();
    until_drawn(&mut harness);
    retype(&mut harness, "Moment", "1700");
    press(&mut harness, Modifiers::NONE, Key::OpenBracket);
    let begin = Moment::of_year(1700).expect("a year");
    let range = |harness: &Panels| harness.state().timeline.range;
    assert_eq!(range(&harness).map(|[from, _]| from), Some(begin));
    // The other end is dragged, to full years.
    let line = harness.get_by_label("Timeline").rect();
    let grip = harness.get_by_label("Loop until").rect().center();
    let to = egui::pos2(harness.get_by_label("Loop from").rect().right() + 20.0, line.center().y);
    drag(&mut harness, grip, to);
    let [from, until] = range(&harness).expect("a part of the line");
    assert!(from == begin && until > from && until.written().len() == 4, "{}", until.written());
    assert_eq!(moment(&harness).as_deref(), Some("1700"), "a handle is not the line");
    let edits = harness.state().document.names()[0].map(str::to_owned);
    click(&mut harness, "Play through time");
    let mut rounds = 0;
    let mut before = moment(&harness);
    let started = Instant::now();
    while rounds < 2 {
        assert!(started.elapsed() < PATIENCE, "it does not go round");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
        let now = harness.state().document.scene().moment.expect("a moment");
        assert!((from..until).contains(&now), "{}", now.written());
        let written = moment(&harness);
        rounds += usize::from(written < before);
        before = written;
    }
    click(&mut harness, "Pause");
    assert_eq!(harness.state().document.names()[0].map(str::to_owned), edits, "all of it is one way through time");
    // It is no part of the scene; a double click takes it back.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(range(&harness).is_some());
    let grip = harness.get_by_label("Loop until").rect().center();
    harness.hover_at(grip);
    harness.step();
    // At once: steps take longer than a double click.
    for pressed in [true, false, true, false] {
        let button = egui::PointerButton::Primary;
        let event = egui::Event::PointerButton { pos: grip, button, pressed, modifiers: Modifiers::NONE };
        harness.input_mut().events.push(event);
    }
    harness.run_steps(2);
    assert_eq!(range(&harness), None);
}

#[test]
fn views_are_kept_as_camera_keys() {
    let mut harness = window();
    until_drawn(&mut harness);
    retype(&mut harness, "Moment", "1700");
    click(&mut harness, "Keep the view for this moment");
    press(&mut harness, Modifiers::NONE, Key::Num7);
    arrive(&mut harness);
    retype(&mut harness, "Moment", "1800");
    let city = middle(&harness);
    harness.hover_at(city);
    press(&mut harness, Modifiers::NONE, Key::C);
    let animation = harness.state().document.scene().animation.clone().expect("an animation");
    let [first, second] = &animation.camera[..] else { panic!("two keys: {:?}", animation.camera) };
    assert!(first.at < second.at && first.eye != second.eye);
    for (key, year) in [(first, 1700), (second, 1800)] {
        let off = animation.moment_of(key.at).expect("a moment") - Moment::of_year(year).expect("a year");
        assert!(off.abs() < veduta::time::HOUR, "the key of {year} is off by {off} µs");
    }
    harness.check_accessibility();
    // It is written and read as it is.
    assert!(harness.state().document.as_written().is_ok());
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().document.scene().animation.as_ref().map(|own| own.camera.len()), Some(1));
}

/// A city with a tram that goes along x, 80 metres in a minute and back in another, and turns round between.
fn tram(folder: &std::path::Path) -> PathBuf {
    std::fs::create_dir_all(folder).expect("a folder");
    let sides = [[-6000, -1500], [6000, -1500], [6000, 1500], [-6000, 1500]];
    let corners: Vec<[i32; 3]> = [0, 3000].iter().flat_map(|z| sides.map(|[x, y]| [x, y, *z])).collect();
    let ground = [[-100_000, -100_000, 0], [200_000, -100_000, 0], [200_000, 100_000, 0], [-100_000, 100_000, 0]];
    let vertices: Vec<[i32; 3]> = corners.into_iter().chain(ground).collect();
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}},
            "CityObjects": {{
              "tram": {{"type": "CityFurniture", "geometry": [{{"type": "MultiSurface", "lod": "2", "boundaries":
                [[[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]}}]}},
              "ground": {{"type": "LandUse", "geometry": [{{"type": "MultiSurface", "lod": "2", "boundaries": [[[8, 9, 10, 11]]]}}]}}}},
            "vertices": {vertices:?}}}"#
    );
    let rows = ["08:00:00,0,0,0,0", "08:01:00,80,0,0,0", "08:01:10,80,0,0,180", "08:02:10,0,0,0,180"];
    let table: String = rows.iter().map(|row| format!("tram,2025-06-01T{row}\n")).collect();
    std::fs::write(folder.join("tram.city.json"), text).expect("a file");
    std::fs::write(folder.join("tram.csv"), format!("id,t,x,y,z,yaw\n{table}")).expect("a file");
    let scene = "veduta = 1\n[city]\nfiles = [\"tram.city.json\"]\ntimetables = [\"tram.csv\"]\n\
                 [camera]\neye = [40, -90, 60]\ntarget = [40, 0, 0]\n[time]\nat = \"2025-06-01T08:00:15\"\n";
    let file = folder.join("tram.toml");
    std::fs::write(&file, scene).expect("a file");
    file
}

#[test]
fn an_object_that_moves_is_dragged_through_time() {
    let folder = std::env::temp_dir().join(format!("veduta-window-tram-{}", std::process::id()));
    let start = Start { files: vec![tram(&folder)], ..Start::default() };
    let mut harness = harness(&start, egui::vec2(1280.0, 800.0));
    until(&mut harness, "a picture", |window| window.frame.as_ref().is_some_and(|frame| frame.shown.is_some()));
    std::fs::remove_dir_all(&folder).expect("it is there");
    let second = |harness: &Panels| {
        let start = Interval::parse("2025-06-01T08:00:00").expect("a time").begin.expect("a beginning");
        let now = harness.state().document.scene().moment.expect("a moment");
        (now - start) as f64 / 1e6
    };
    let spot = |harness: &Panels, x: f64| {
        let frame = harness.state().frame.as_ref().expect("a picture");
        let city = harness.get_by_label("City").rect();
        let pixel = frame.view.pixel(glam::DVec3::new(x, 0.0, 3.0)).expect("before the eye");
        city.min + egui::vec2(pixel.x as f32, pixel.y as f32) * (city.width() / frame.view.size[0] as f32)
    };
    let shows_now = |harness: &mut Panels| {
        until(harness, "the picture of the moment", |window| {
            let now = window.document.scene().moment;
            window.frame.as_ref().is_some_and(|frame| frame.shown.is_some() && frame.scene.moment == now)
        });
    };
    assert_eq!(second(&harness), 15.0);
    let camera = harness.state().camera();
    // It stands at 20 metres, and is taken by its roof to 64.
    let (from, to) = (spot(&harness, 20.0), spot(&harness, 64.0));
    drag(&mut harness, from, to);
    assert!((second(&harness) - 48.0).abs() < 0.3, "{}", second(&harness));
    assert_eq!(harness.state().camera(), camera, "the eye stays");
    assert_eq!(harness.state().document.names()[0], Some("move through time"));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(second(&harness), 15.0, "one drag is one edit");
    shows_now(&mut harness);
    // Through a lens that shows it twenty seconds later, and so farther on, it is dragged as it is there.
    let lens = "lens.0={ name = \"later\", kind = \"time\", time = [{ op = \"shift\", by = \"20 s\" }], body = \"none\", \
                shape = { kind = \"box\", center = [60, 0, 0], size = [60, 40, 40] } }";
    harness.state_mut().document.set(lens).expect("a lens");
    until_drawn(&mut harness);
    let (from, to) = (spot(&harness, 46.0), spot(&harness, 62.0));
    drag(&mut harness, from, to);
    assert!((second(&harness) - 27.0).abs() < 0.3, "{}", second(&harness));
    // What stands is no handle of time: there the eye goes round.
    shows_now(&mut harness);
    let from = spot(&harness, 5.0);
    drag(&mut harness, from, from + egui::vec2(60.0, 0.0));
    assert_ne!(harness.state().camera(), camera);
    // The line is that of the timetable, and its steps are as fine.
    let context = harness.ctx.clone();
    let before = second(&harness);
    harness.state_mut().act(&context, Action::Time(Step::On));
    assert!((0.0..=1.0).contains(&(second(&harness) - before)), "from {before} to {}", second(&harness));
}
