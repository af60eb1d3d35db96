//! Tests on the shared data sets, named by `VEDUTA_DATA`; without it every trial reads *ignored*, never *ok*.
//!
//! One module per room below `tests/data/`; each gives its trials, which are made even without the data.

#[path = "data/bent_rays.rs"]
mod bent_rays;
#[path = "data/best_views.rs"]
mod best_views;
#[path = "data/compare.rs"]
mod compare;
#[path = "data/derived.rs"]
mod derived;
#[path = "data/edges.rs"]
mod edges;
#[path = "data/faces.rs"]
mod faces;
#[path = "data/fields.rs"]
mod fields;
#[path = "data/info.rs"]
mod info;
mod layouts;
#[path = "data/meshes.rs"]
mod meshes;
#[path = "data/occluders.rs"]
mod occluders;
#[path = "data/overlay_walks.rs"]
mod overlay_walks;
#[path = "data/own_handlers.rs"]
mod own_handlers;
#[path = "data/pictures.rs"]
mod pictures;
#[path = "data/register.rs"]
mod register;
#[path = "data/scenes.rs"]
mod scenes;
#[path = "data/shadows.rs"]
mod shadows;
#[path = "data/standing.rs"]
mod standing;
mod studio;
#[path = "data/time.rs"]
mod time;
#[path = "data/walks.rs"]
mod walks;

use std::{path::PathBuf, time::Instant};

use libtest_mimic::{Arguments, Failed, Trial};

/// The folder of the shared data sets, if there is one.
fn root() -> Option<PathBuf> {
    std::env::var_os("VEDUTA_DATA").filter(|value| !value.is_empty()).map(PathBuf::from)
}

/// A trial that needs the data.
#[allow(clippy::print_stdout, reason = "times of tests are printed beside their results")]
fn trial(name: &str, run: impl FnOnce(PathBuf) -> Result<(), Failed> + Send + 'static) -> Trial {
    let root = root();
    let is_absent = root.is_none();
    let named = name.to_owned();
    let timed = move || {
        let started = Instant::now();
        let result = run(root.expect("the trial is ignored without the data"));
        // As the standard harness says it, for `./dev test --times`.
        if std::env::var_os("VEDUTA_TIMES").is_some() {
            println!("test data::{named} ... done <{:.3}s>", started.elapsed().as_secs_f64());
        }
        result
    };
    Trial::test(name, timed).with_ignored_flag(is_absent)
}

fn main() {
    let arguments = Arguments::from_args();
    let rooms = [
        bent_rays::trials(),
        best_views::trials(),
        compare::trials(),
        derived::trials(),
        edges::trials(),
        faces::trials(),
        fields::trials(),
        info::trials(),
        meshes::trials(),
        occluders::trials(),
        overlay_walks::trials(),
        own_handlers::trials(),
        pictures::trials(),
        register::trials(),
        scenes::trials(),
        shadows::trials(),
        standing::trials(),
        time::trials(),
        walks::trials(),
    ];
    let trials = rooms.into_iter().flatten().collect();
    libtest_mimic::run(&arguments, trials).exit();
}
