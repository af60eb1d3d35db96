//! Which city objects a lens meets: by descent of the city's hierarchies, against a look at every triangle of every object
//! whose box meets the lens's.
//!
//! `cargo bench --bench lens_objects [-- --pairs N] [FILE...]`: 40 lenses per size, spread over the city, of six kinds; all
//! of them one way and then the other in turn, and the median of the ratios with its 95 % interval. Both must find the same
//! objects. Without FILE: the bench city, and the shared CityJSON files of 1 MB and more where `VEDUTA_DATA` is set.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{
    collections::BTreeSet,
    convert::Infallible,
    path::{Path, PathBuf},
    time::Instant,
};

use glam::{DQuat, DVec3};
use veduta::{
    city::{
        CityModel,
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    geom::{Aabb, CommonPart, Shape, Volume},
    lens::intersection::{objects_meeting, regions},
    measure::ratio::{Estimate, in_turn, ratios},
};

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
        files.extend(shared_files());
    }
    println!(
        "{:<36} {:>8} {:>9} {:>8}  {:>9} {:>9}  {:>24}  {:>8}",
        "file", "tri", "lens", "objects", "every ms", "tree ms", "every / tree", "build ms"
    );
    for file in files {
        measure(&file, pairs);
    }
}

fn measure(file: &Path, pairs: usize) {
    let model = load(&[file.to_owned()], &LoadOptions::default(), &Quiet).expect("a bench file loads");
    let shown = shown_geometries(&model, None);
    let start = Instant::now();
    let index = SpatialIndex::build(&model, &shown);
    let build_ms = start.elapsed().as_secs_f64() * 1e3;
    let extent = shown.iter().fold(Aabb::EMPTY, |all, &g| all.union(model.geometries[g as usize].bounds));
    let half_city = 0.35 * extent.size().truncate().length();
    for radius in [5.0, 25.0, 100.0, half_city] {
        let lenses: Vec<Volume> = (0..40).map(|i| lens(&model, &shown, i, radius)).collect();
        let mut found = 0;
        for volume in &lenses {
            let by_tree = objects_meeting(&model, &index, &regions(&[std::slice::from_ref(volume)]));
            let by_all: Vec<u32> = every_triangle(&model, &shown, volume).into_iter().collect();
            assert_eq!(by_tree, by_all, "{}: {volume:?}", file.display());
            found += by_all.len();
        }
        let timed = |way: usize| {
            let start = Instant::now();
            for volume in &lenses {
                if way == 0 {
                    std::hint::black_box(every_triangle(&model, &shown, volume));
                } else {
                    let regions: Vec<CommonPart> = regions(&[std::slice::from_ref(volume)]);
                    std::hint::black_box(objects_meeting(&model, &index, &regions));
                }
            }
            Ok::<_, Infallible>(start.elapsed().as_secs_f64() * 1e3 / lenses.len() as f64)
        };
        let Ok(times) = in_turn(2, pairs, timed);
        let of = |values: &[f64]| Estimate::of(values).expect("finite times");
        let Estimate { median, low, high } = of(&ratios(&times[0], &times[1]));
        println!(
            "{:<36} {:>8} {:>7.0} m {:>8.1}  {:>9.3} {:>9.3}  {:>24}  {:>8.1}",
            file.file_name().unwrap_or_default().to_string_lossy(),
            model.indices.len() / 3,
            radius,
            found as f64 / lenses.len() as f64,
            of(&times[0]).median,
            of(&times[1]).median,
            format!("{median:.2} ({low:.2}..{high:.2})"),
            build_ms
        );
    }
}

/// Lens `i` of the city: around the middle of an object that is shown.
fn lens(model: &CityModel, shown: &[u32], i: usize, r: f64) -> Volume {
    let center = model.geometries[shown[(i * shown.len() / 40).min(shown.len() - 1)] as usize].bounds.center();
    let turn = DQuat::from_rotation_z(i as f64) * DQuat::from_rotation_x(0.3);
    let shape = match i % 6 {
        0 => Shape::Sphere { center, radius: r },
        1 => Shape::Box { center, size: DVec3::new(2.0, 1.4, 1.0) * r, rotation: turn },
        2 => Shape::Cylinder { center, radius: r, height: 60.0, axis: DVec3::Z },
        3 => Shape::Ellipsoid { center, radii: DVec3::new(1.0, 0.5, 0.3) * r, rotation: turn },
        4 => Shape::Frustum { center, radius: r, top_radius: 0.0, height: 2.0 * r, axis: DVec3::Z },
        _ => {
            let corner = |k: i32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) - 0.5;
            Shape::Convex { points: (0..8).map(|k| center + turn * (corner(k) * 1.5 * r)).collect() }
        }
    };
    shape.volume().expect("a volume")
}

/// Objects of which a triangle meets the volume, one triangle after the other.
fn every_triangle(model: &CityModel, shown: &[u32], volume: &Volume) -> BTreeSet<u32> {
    let bounds = volume.bounds();
    let mut met = BTreeSet::new();
    for &g in shown {
        let geometry = &model.geometries[g as usize];
        if met.contains(&geometry.object) || !bounds.meets(&geometry.bounds) {
            continue;
        }
        let tiles = &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
        let is_met = tiles.iter().any(|tile| {
            (tile.indices.start as usize..tile.indices.end as usize).step_by(3).any(|i| {
                let corner = |k: usize| model.position(tile, tile.vertices.start + model.indices[i + k]);
                volume.meets_triangle(&[corner(0), corner(1), corner(2)])
            })
        });
        if is_met {
            met.insert(geometry.object);
        }
    }
    met
}

/// Shared CityJSON files of 1 MB and more.
fn shared_files() -> Vec<PathBuf> {
    let Some(root) = std::env::var_os("VEDUTA_DATA").map(PathBuf::from) else { return Vec::new() };
    let folders = std::fs::read_dir(root).into_iter().flatten().flatten();
    let files = folders.flat_map(|folder| std::fs::read_dir(folder.path()).into_iter().flatten().flatten());
    let is_city = |path: &Path| {
        let name = path.to_string_lossy();
        let is_large = std::fs::metadata(path).is_ok_and(|m| m.len() >= 1_000_000);
        is_large && (name.ends_with(".city.json") || name.ends_with(".city.jsonl"))
    };
    let mut found: Vec<PathBuf> = files.map(|file| file.path()).filter(|path| is_city(path)).collect();
    found.sort();
    found
}
