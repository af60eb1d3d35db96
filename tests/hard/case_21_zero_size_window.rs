//! Case 21, the window: without a size, or with one of a pixel, it draws nothing, and lives; once there is room, it shows the city.
//! Oracle: the stated rule, and the size of the picture.

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use eframe::egui::{self, Vec2, vec2};
use egui_kittest::Harness;
use veduta::app::{Start, Window};

const PATIENCE: Duration = Duration::from_secs(300);

fn until(harness: &mut Harness<'_, Window>, what: &str, holds: impl Fn(&Window) -> bool) {
    let started = Instant::now();
    while !holds(harness.state()) {
        assert!(started.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
}

#[test]
fn a_window_without_a_size_asks_for_no_picture_and_lives() {
    for size in [Vec2::ZERO, vec2(300.0, 0.0), vec2(0.0, 200.0), vec2(1.0, 1.0)] {
        let start = Start { files: vec![PathBuf::from("builtin:rooms")], ..Start::default() };
        let window = Window::new(&egui::Context::default(), &start).expect("threads");
        let mut harness = Harness::builder()
            .with_size(size)
            .build_ui_state(|ui: &mut egui::Ui, window: &mut Window| window.ui(ui), window);
        until(&mut harness, "the city", |window| window.city.is_some());
        harness.run_steps(5);
        if size.x == 0.0 || size.y == 0.0 {
            assert!(harness.state().frame.is_none(), "{size}: nothing is to be drawn");
        }
        harness.check_accessibility();
        harness.set_size(vec2(900.0, 600.0));
        until(&mut harness, "a picture", |window| {
            window.frame.as_ref().is_some_and(|frame| frame.view.size.iter().all(|side| *side > 100))
        });
        // Made small again, it keeps what it has.
        harness.set_size(size);
        harness.run_steps(5);
        assert!(
            harness.state().frame.is_some() && harness.state().camera().is_some_and(|camera| camera.check().is_ok())
        );
    }
}
