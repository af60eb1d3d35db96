//! Who hides what: each detection test through the tree of boxes or triangles, against a look at all of them (the exact test: at every
//! triangle of every object whose box meets the box around the eye and a point of interest).
//!
//! `cargo bench --bench occluders [-- --pairs N] [FILE...]`: 40 eyes in the streets, each with ten points of interest near it;
//! all of them one way and then the other in turn, and the median of the ratios with its 95 % interval. Both must find the same
//! objects. Without FILE: the bench city (36,000 buildings).

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{
    convert::Infallible,
    path::{Path, PathBuf},
    time::Instant,
};

use glam::DVec3;
use veduta::{
    city::{
        CityModel,
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    geom::{
        Aabb,
        shaft::{BoxShaft, TriangleShaft, segment_meets_box},
    },
    measure::ratio::{Estimate, in_turn, ratios},
    visibility::{Poi, Query, Reference, Scope, Set, Test, Units, Viewer},
};

/// Eyes per test.
const EYES: usize = 40;
/// Points of interest per eye.
const POIS: usize = 10;

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let mut pairs = 31;
    if let Some(at) = arguments.iter().position(|a| a == "--pairs") {
        pairs = arguments.get(at + 1).and_then(|n| n.parse().ok()).expect("--pairs wants a number");
        arguments.drain(at..at + 2);
    }
    let mut files: Vec<PathBuf> = arguments.iter().map(PathBuf::from).collect();
    if files.is_empty() {
        files.push(bench_city::written(bench_city::BENCH_BUILDINGS));
    }
    println!(
        "{:<28} {:>7} {:<22} {:>9}  {:>9} {:>9}  {:>24}",
        "file", "units", "test", "occluders", "all ms", "tree ms", "all / tree"
    );
    files.iter().for_each(|file| measure(file, pairs));
}

fn measure(file: &Path, pairs: usize) {
    let model = load(&[file.to_owned()], &LoadOptions::default(), &Quiet).expect("a bench file loads");
    let shown = shown_geometries(&model, None);
    let start = Instant::now();
    let units = Units::new(&model, &shown);
    let units_ms = start.elapsed().as_secs_f64() * 1e3;
    let index = SpatialIndex::build(&model, &shown);
    let scope = Scope { model: &model, units: &units, index: &index };
    let standing: Vec<u32> = (0..units.len() as u32).filter(|&u| !units.boxes[u as usize].is_empty()).collect();
    let stands: Vec<(DVec3, Vec<Poi>)> = (0..EYES).map(|i| stand(&units, &standing, i)).collect();
    let (up, reference) = (DVec3::Z, Reference::Nearest);
    let tests = [
        Test::Spherical { radius: 100.0, reference },
        Test::Cylindrical { radius: 100.0, up },
        Test::ViewerHeight { radius: 100.0, reference, up },
        Test::Ground { radius: 60.0 },
        Test::ViewAxis,
        Test::default(),
    ];
    let none = Set::new(units.len());
    for test in &tests {
        let query = |(eye, pois): &(DVec3, Vec<Poi>)| -> Vec<u32> {
            let viewer = Viewer { eye: *eye, along: None };
            let query = Query { viewer, pois, test, forced: &none, forbidden: &none, measured: false, margin: None };
            scope.detect(&query).occluders.iter().collect()
        };
        let mut found = 0;
        for stand in &stands {
            let by_tree = query(stand);
            assert_eq!(by_tree, every(&model, &units, &standing, test, stand), "{test:?} from {}", stand.0);
            found += by_tree.len();
        }
        let timed = |way: usize| {
            let start = Instant::now();
            for stand in &stands {
                std::hint::black_box(if way == 0 {
                    every(&model, &units, &standing, test, stand)
                } else {
                    query(stand)
                });
            }
            Ok::<_, Infallible>(start.elapsed().as_secs_f64() * 1e3 / EYES as f64)
        };
        let Ok(times) = in_turn(2, pairs, timed);
        let of = |values: &[f64]| Estimate::of(values).expect("finite times");
        let Estimate { median, low, high } = of(&ratios(&times[0], &times[1]));
        println!(
            "{:<28} {:>7} {:<22} {:>9.1}  {:>9.4} {:>9.4}  {:>24}",
            file.file_name().unwrap_or_default().to_string_lossy(),
            standing.len(),
            test.word(),
            found as f64 / EYES as f64,
            of(&times[0]).median,
            of(&times[1]).median,
            format!("{median:.2} ({low:.2}..{high:.2})")
        );
    }
    println!("units: {units_ms:.1} ms, once per city");
}

/// An eye in a street, and the units nearest to it that are at least 60 m away.
fn stand(units: &Units, standing: &[u32], i: usize) -> (DVec3, Vec<Poi>) {
    let house = &units.boxes[standing[i * standing.len() / EYES] as usize];
    let eye = DVec3::new(house.min.x - 3.0, house.min.y - 3.0, house.min.z + 1.7);
    let mut near: Vec<(f64, u32)> = standing
        .iter()
        .map(|&u| (units.boxes[u as usize].center().distance(eye), u))
        .filter(|(distance, _)| *distance > 60.0)
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Units are numbered as their first object is; of the bench city each is its own.
    let object = |unit: u32| units.roots[unit as usize];
    (eye, near.iter().take(10 * POIS).step_by(10).map(|(_, unit)| Poi::Object(object(*unit))).collect())
}

/// The occluders by a look at every box, or at every triangle.
fn every(model: &CityModel, units: &Units, standing: &[u32], test: &Test, (eye, pois): &(DVec3, Vec<Poi>)) -> Vec<u32> {
    let own: Vec<u32> = pois.iter().filter_map(|&poi| units.unit_of(poi)).collect();
    let holds_eye = |b: &Aabb| eye.cmpge(b.min).all() && eye.cmple(b.max).all();
    let near = |b: &Aabb, r: f64| eye.clamp(b.min, b.max).distance_squared(*eye) < r * r;
    let shafts: Vec<(BoxShaft, Aabb, Vec<TriangleShaft>)> = match test {
        Test::Exact { .. } => own.iter().map(|&unit| shaft(model, units, *eye, unit)).collect(),
        _ => Vec::new(),
    };
    let holds = |unit: u32| {
        let b = &units.boxes[unit as usize];
        match test {
            Test::Spherical { radius, .. } => holds_eye(b) || near(b, *radius),
            Test::Cylindrical { radius, .. } => {
                holds_eye(b) || (b.center() - *eye).truncate().length_squared() < radius * radius
            }
            Test::ViewerHeight { radius, .. } => {
                holds_eye(b) || (near(b, *radius) && b.min.z <= eye.z && eye.z <= b.max.z)
            }
            Test::Ground { radius } => {
                let plan = eye.truncate();
                plan.clamp(b.min.truncate(), b.max.truncate()).distance_squared(plan) <= radius * radius
            }
            Test::ViewAxis => {
                let to = |poi: &Poi| segment_meets_box([*eye, units.box_of(*poi).center()], b);
                holds_eye(b) || pois.iter().any(to)
            }
            _ if !shafts.iter().any(|(_, target, _)| target.grown(*eye).meets(b)) => false,
            _ => corners(model, units, unit).iter().any(|t| {
                let around = Aabb::from_points(*t);
                let before = |(shaft, target, faces): &(BoxShaft, Aabb, Vec<TriangleShaft>)| {
                    shaft.meets(t) || (around.meets(target) && faces.iter().any(|face| face.meets(t)))
                };
                // A point of interest may hide another one, but is none that is hidden away.
                shafts.iter().zip(&own).any(|(one, poi)| *poi != unit && before(one))
            }),
        }
    };
    standing.iter().copied().filter(|unit| !own.contains(unit) && holds(*unit)).collect()
}

fn shaft(model: &CityModel, units: &Units, eye: DVec3, unit: u32) -> (BoxShaft, Aabb, Vec<TriangleShaft>) {
    let target = units.shown[unit as usize];
    let faces = corners(model, units, unit).into_iter().filter_map(|t| TriangleShaft::new(eye, t)).collect();
    (BoxShaft::new(eye, &target), target, faces)
}

/// The triangles of a unit.
fn corners(model: &CityModel, units: &Units, unit: u32) -> Vec<[DVec3; 3]> {
    let mut all = Vec::new();
    for geometry in units.geometries(unit).iter().map(|&g| &model.geometries[g as usize]) {
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            let corner = |i: u32| model.position(tile, tile.vertices.start + model.indices[i as usize]);
            all.extend(tile.indices.clone().step_by(3).map(|i| [corner(i), corner(i + 1), corner(i + 2)]));
        }
    }
    all
}
