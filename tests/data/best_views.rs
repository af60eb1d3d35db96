//! Best views and landmarks of real cities: what stands out is seen well, and what the exact detection finds before it hides little.

#![allow(clippy::print_stdout, reason = "what was found, for those who ask with --no-capture")]

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use veduta::{
    city::{
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    view::Field,
    visibility::{Poi, Query, Scope, Set, Test, Units, Viewer, best_views, landmarks},
};

/// Files, and the landmark that must be among the first: index of none stands for whatever comes first.
const FILES: [&str; 3] = [
    "denhaag-01/DenHaag_01.v1.0.city.json",
    "rotterdam-delfshaven/3-20-DELFSHAVEN.city.json",
    "vienna-102081/vienna_102081.v1.1.city.jsonl",
];

pub fn trials() -> Vec<Trial> {
    let mut all: Vec<Trial> =
        FILES.map(|file| crate::trial(&format!("best_views::{file}"), move |root| check(&root.join(file)))).into();
    all.push(crate::trial("landmarks::covers what its faces cover", |root| covers(&root)));
    all
}

/// Two buildings of some 10,000 faces, and the ground that these cover, square metres to a decimal, by another program's union.
const COVERED: [(&str, f64); 2] =
    [("NL.IMBAG.Pand.0503100000000033", 2661.9), ("NL.IMBAG.Pand.0503100000000209", 3061.5)];

fn covers(root: &Path) -> Result<(), Failed> {
    let model = load(&[root.join("3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl")], &LoadOptions::default(), &Quiet)?;
    let found = landmarks(&model, &shown_geometries(&model, None), model.objects.len());
    for (id, area) in COVERED {
        let is_it = |object: u32| *model.objects[object as usize].id == *id;
        let landmark = found.iter().find(|l| is_it(l.object)).ok_or("it is there")?;
        if landmark.footprint_is_hull || (landmark.footprint_m2 - area).abs() > 0.06 {
            return Err(format!(
                "{id} covers {area}, not {} (hull: {})",
                landmark.footprint_m2, landmark.footprint_is_hull
            )
            .into());
        }
    }
    Ok(())
}

/// Landmarks of each file.
const LANDMARKS: usize = 5;

fn check(file: &Path) -> Result<(), Failed> {
    let model = load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?;
    let shown = shown_geometries(&model, None);
    let (units, index) = (Units::new(&model, &shown), SpatialIndex::build(&model, &shown));
    let scope = Scope { model: &model, units: &units, index: &index };
    let none = Set::new(units.len());
    let found = landmarks(&model, &shown, LANDMARKS);
    for landmark in &found {
        let id = &model.objects[landmark.object as usize].id;
        let views = best_views(&model, &shown, &index, landmark.object, &Field::default())?;
        let best = &views[0];
        println!("{id}: {landmark:?}\n  {} views, {best:?}", views.len());
        // By rays of another kind: through the whole solid angle, all that is before the object by unit.
        let viewer = Viewer { eye: best.framing.eye, along: None };
        let test = Test::Exact { coverage: 0.0, rays: 2048 };
        let pois = [Poi::Object(landmark.object)];
        let query =
            Query { viewer, pois: &pois, test: &test, forced: &none, forbidden: &none, measured: true, margin: None };
        let covered: f64 = scope.detect(&query).list.iter().filter_map(|o| o.coverage).map(|c| c.share).sum();
        println!("  occluders cover {covered:.3} together");
        // Of a convex body a half is seen at most; of one with wings and courts less, of a part of a row that shares its walls least.
        if best.seen.visible < 0.15 || best.seen.unoccluded < 0.8 {
            return Err(format!("{id} is not seen well: {:?}", best.seen).into());
        }
        // What single occluders cover adds up to no less than all of them do; a wall behind another counts twice. Terrain, into
        // which the feet of walls reach, hides a tenth at most, and is no occluder.
        if covered > 0.25 || covered + 0.1 < 1.0 - best.seen.unoccluded {
            return Err(format!("{id}: occluders cover {covered}, {:?}", best.seen).into());
        }
    }
    if found.len() < LANDMARKS { Err("there are too few landmarks".into()) } else { Ok(()) }
}
