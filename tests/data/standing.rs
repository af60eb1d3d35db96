//! Where a person stands before buildings of real cities: on the ground, in no building, and where a third of the walls is seen if that can be.

#![allow(clippy::print_stdout, reason = "what was found, for those who ask with --no-capture")]

use std::{f64::consts::TAU, path::Path, time::Instant};

use glam::{DVec2, DVec3};
use libtest_mimic::{Failed, Trial};
use veduta::{
    city::{
        ObjectClass,
        ground::plain_ground,
        load::{LoadOptions, Quiet, load},
        place::Places,
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    view::Field,
    visibility::{Before, ENOUGH, EYE_HEIGHT_M, Subject},
};

const FILES: [&str; 3] = [
    "denhaag-01/DenHaag_01.v1.0.city.json",
    "rotterdam-delfshaven/3-20-DELFSHAVEN.city.json",
    "vienna-102081/vienna_102081.v1.1.city.jsonl",
];
/// Buildings of each city.
const BUILDINGS: usize = 40;
/// Eyes on circles around a building that are looked from beside those that are tried.
const CIRCLES: [f64; 4] = [12.0, 25.0, 50.0, 90.0];
const AROUND: u32 = 16;

pub fn trials() -> Vec<Trial> {
    FILES.map(|file| crate::trial(&format!("standing::{file}"), move |root| check(&root.join(file)))).into()
}

fn check(file: &Path) -> Result<(), Failed> {
    let model = load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?;
    let shown = shown_geometries(&model, None);
    let index = SpatialIndex::build(&model, &shown);
    let ground = plain_ground(&model, &shown);
    let places = Places { model: &model, index: &index, ground: ground.as_ref() };
    let is_root = |object: &u32| {
        let own = &model.objects[*object as usize];
        own.class == ObjectClass::Building && own.parents.is_empty() && !model.family_bounds(*object).is_empty()
    };
    let roots: Vec<u32> = (0..model.objects.len() as u32).filter(is_root).collect();
    let (mut enough, mut best, mut nowhere, mut slowest) = (0, Vec::new(), 0, 0.0_f64);
    for object in roots.iter().step_by((roots.len() / BUILDINGS).max(1)) {
        let Ok(subject) = Subject::new(&model, &shown, &index, *object) else { continue };
        let before = Before { subject: &subject, places, field: Field::default() };
        let middle = subject.bounds.center();
        let started = Instant::now();
        let found = before.standing(middle + DVec3::new(-200.0, -150.0, 120.0));
        slowest = slowest.max(started.elapsed().as_secs_f64());
        let id = &model.objects[*object as usize].id;
        let reach = 0.5 * subject.bounds.size().truncate().length();
        let around = CIRCLES.iter().flat_map(|away| {
            (0..AROUND).map(move |i| (reach + away) * DVec2::from_angle(TAU * f64::from(i) / f64::from(AROUND)))
        });
        let seen = around.filter_map(|at| before.standing_at(middle.truncate() + at)).map(|one| one.seen);
        let Some(standing) = found else {
            nowhere += 1;
            println!("{id}: nobody can stand before it; from circles {:?}", seen.reduce(f64::max));
            continue;
        };
        let height = standing.eye.z - places.ground(standing.eye.truncate()).ok_or("there is ground")?;
        if (height - EYE_HEIGHT_M).abs() > 1e-6 || places.building_around(standing.eye).is_some() {
            return Err(format!("{id}: {standing:?} is {height} m above the ground").into());
        }
        if standing.seen >= ENOUGH {
            enough += 1;
            continue;
        }
        // What other eyes see: no more than a little, since walls open and close between streets.
        let most = seen.fold(0.0, f64::max);
        best.push((standing.seen, most));
        if most >= ENOUGH + 0.05 {
            return Err(format!("{id}: {standing:?}, and {most} is seen from beside those eyes").into());
        }
    }
    println!(
        "{enough} with a third, {nowhere} nowhere, {slowest:.2} s at most; else seen, and from circles: {best:.2?}"
    );
    if enough == 0 { Err("a third is seen of none".into()) } else { Ok(()) }
}
