//! How occluders are drawn (O3): whatever the style, the point of interest is seen, and nothing else goes.

#![allow(clippy::print_stdout, reason = "what was measured, for those who ask with --no-capture")]

mod studio;

use std::{collections::BTreeSet, path::PathBuf};

use studio::*;
use veduta::{
    figure::{
        scene_file::{self, Options},
        sheet::share::share_in,
    },
    lens::{Focus, Rendering, rendering::ROWS},
    render::{
        frame::Backend,
        picture::{Aovs, Request},
    },
    scene::Scene,
    visibility::Test,
};

/// The church that houses hide, by the exact test.
fn church() -> Scene {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/trapp-3-3-2-c.toml");
    let mut scene = scene_file::read(&path, &Options::for_file(&path)).expect("a scene");
    scene.figure.size = [400, 225];
    let Some(Focus::Occluders(of)) = scene.lenses[0].shapes.first_mut() else { panic!("an occlusion lens") };
    of.pois = vec!["church".into()];
    of.test = Test::default();
    scene
}

fn request(backend: Backend, statistics: bool) -> Request {
    let aovs = Aovs { object_id: statistics, ..Aovs::default() };
    Request { size: [400, 225], samples: 1, transparent: false, aovs, statistics, backend }
}

#[test]
fn every_rendering_shows_the_point_of_interest_and_takes_nothing_else_away() {
    let scene = church();
    let mut studio = of_scene(&scene);
    let mut plain = scene.clone();
    plain.lenses[0].enabled = false;
    let before = share_in(&mut studio, &plain, "church").expect("a picture").expect("it is in the picture");
    assert!(before < 0.6, "it is hidden: {before}");
    let told = studio.render(&scene, &request(Backend::Specialised, true)).expect("a picture");
    let occluders: BTreeSet<String> =
        told.statistics.lenses[0].occluders.iter().flatten().map(|o| o.id.clone()).collect();
    assert!(occluders.len() > 5, "{occluders:?}");
    let seen = studio.render(&plain, &request(Backend::Specialised, true)).expect("a picture").object_id.expect("ids");
    let ids: BTreeSet<u32> = seen.into_iter().filter(|id| *id > 0).collect();
    let root = |mut object: usize| {
        while let Some(parent) = studio.model.objects[object].parents.first() {
            object = *parent as usize;
        }
        object
    };
    let others = ids.into_iter().filter(|id| !occluders.contains(&*studio.model.objects[root(*id as usize - 1)].id));
    let others: Vec<u32> = others.collect();
    assert!(others.len() > 20, "{}", others.len());
    for row in ROWS {
        let mut drawn = scene.clone();
        drawn.lenses[0].render = Rendering::of_word(row.word);
        let share = share_in(&mut studio, &drawn, "church").expect("a picture").expect("it is in the picture");
        println!("{}: {:.1} %", row.word, 100.0 * share);
        let least = if ["discard", "box", "edges"].contains(&row.word) { 1.0 } else { 0.7 };
        assert!(share >= least, "{}: {share}", row.word);
        let left: BTreeSet<u32> =
            studio.transmittance(&drawn, [400, 225]).expect("a frame").object_id.into_iter().collect();
        let gone: Vec<u32> = others.iter().copied().filter(|id| !left.contains(id)).collect();
        // What is pressed flat lies on what was seen of the ground before it.
        let most = if ["flatten", "low"].contains(&row.word) { 1 } else { 0 };
        assert!(gone.len() <= most, "{}: {gone:?} of {}", row.word, others.len());
    }
}

#[test]
fn both_back_ends_draw_every_rendering_alike() {
    let scene = church();
    let mut studio = of_scene(&scene);
    for row in ROWS {
        let mut drawn = scene.clone();
        drawn.lenses[0].render = Rendering::of_word(row.word);
        let [a, b] = [Backend::Specialised, Backend::Uber]
            .map(|backend| studio.render(&drawn, &request(backend, true)).expect("a picture"));
        assert!(a.rgba == b.rgba && a.object_id == b.object_id, "{}", row.word);
    }
}
