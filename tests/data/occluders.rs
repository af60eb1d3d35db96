//! The exact detection test against brute force over all triangles: clipping by half-spaces, in f64. Faces that lie within a
//! micrometre of the border of a shaft are told apart by no such clipping: where an object is an occluder by these alone it is left
//! out, and counted.

#![allow(clippy::print_stdout, reason = "what was measured, for those who ask with --no-capture")]

use std::{path::Path, sync::Arc};

use glam::DVec3;
use libtest_mimic::{Failed, Trial};
use veduta::{
    city::{
        CityModel,
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    visibility::{Poi, Query, Scope, Set, Test, Units, Viewer},
};

pub fn trials() -> Vec<Trial> {
    let files = ["denhaag-01/DenHaag_01.v1.0.city.json", "vienna-102081/vienna_102081.v1.1.city.jsonl"];
    files.map(|file| crate::trial(&format!("occluders::{file}"), move |root| check(&root.join(file)))).into()
}

/// Points of interest tried.
const POIS: usize = 100;
/// Nearer to the border of a shaft than this clipping in f64 says nothing, metres.
const UNSURE_M: f64 = 1e-6;

/// normal · p ≥ offset, the normal unit.
type Plane = (DVec3, f64);

/// A polygon's part beyond all planes, each moved outwards by `slack`; whether any of it is left that lies `slack` before `end`.
fn is_left(t: &[DVec3; 3], planes: &[Plane], end: Plane, slack: f64) -> bool {
    let mut polygon = t.to_vec();
    for (normal, offset) in planes {
        let at = |p: DVec3| normal.dot(p) - offset + slack;
        let mut next = Vec::new();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            if at(p) >= 0.0 {
                next.push(p);
            }
            if (at(p) < 0.0) != (at(q) < 0.0) {
                next.push(p + (q - p) * (at(p) / (at(p) - at(q))));
            }
        }
        polygon = next;
    }
    polygon.iter().any(|p| end.0.dot(*p) - end.1 > -slack)
}

/// The pyramid over a convex polygon, its tip at the origin: side planes, and the plane that what is before it lies before.
fn pyramid(base: &[DVec3]) -> Option<(Vec<Plane>, Plane)> {
    let middle = base.iter().sum::<DVec3>() / base.len() as f64;
    let normal = (base[1] - base[0]).cross(base[2] - base[0]).try_normalize()?;
    let towards = if normal.dot(middle) > 0.0 { normal } else { -normal };
    let edges = base.iter().zip(base.iter().cycle().skip(1));
    let sides: Option<Vec<Plane>> = edges
        .map(|(a, b)| {
            let side = a.cross(*b).try_normalize()?;
            Some((if side.dot(middle) >= 0.0 { side } else { -side }, 0.0))
        })
        .collect();
    Some((sides?, (-towards, -towards.dot(base[0]))))
}

/// Whether a triangle is before some of the pyramids: yes, no, or too near to say.
fn verdict(t: &[DVec3; 3], all: &[(Vec<Plane>, Plane)]) -> Option<bool> {
    let with = |slack: f64| all.iter().any(|(sides, end)| is_left(t, sides, *end, slack));
    match (with(-UNSURE_M), with(UNSURE_M)) {
        (true, _) => Some(true),
        (false, false) => Some(false),
        (false, true) => None,
    }
}

/// The triangles shown, each with the root of its object.
fn triangles(model: &CityModel, shown: &[u32], root: &[u32]) -> Vec<(u32, bool, [DVec3; 3])> {
    let mut all = Vec::new();
    for geometry in shown.iter().map(|&g| &model.geometries[g as usize]) {
        let is_ground = model.objects[geometry.object as usize].class.is_ground();
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            for corners in model.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
                let corner = |k: usize| model.position(tile, tile.vertices.start + corners[k]);
                all.push((root[geometry.object as usize], is_ground, [corner(0), corner(1), corner(2)]));
            }
        }
    }
    all
}

fn check(file: &Path) -> Result<(), Failed> {
    let model = Arc::new(load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?);
    let shown = shown_geometries(&model, None);
    let (units, index) = (Units::new(&model, &shown), SpatialIndex::build(&model, &shown));
    let root = model.roots();
    let all = triangles(&model, &shown, &root);
    let standing: Vec<u32> = (0..root.len() as u32)
        .filter(|&o| root[o as usize] == o && all.iter().any(|(of, is_ground, _)| *of == o && !is_ground))
        .collect();
    let none = Set::new(units.len());
    let test = Test::default();
    let (mut found, mut unsure, mut asked) = (0, 0, 0);
    for i in 0..POIS {
        // Additive recurrences: spread evenly, the same in every run.
        let at = |step: f64| (i as f64 * step + 0.5).fract();
        let poi = standing[(at(0.754_877_666_2) * standing.len() as f64) as usize];
        let own: Vec<[DVec3; 3]> = all.iter().filter(|(of, ..)| *of == poi).map(|(.., t)| *t).collect();
        let corners = || own.iter().flatten().copied();
        let (low, high) = (corners().reduce(DVec3::min).unwrap(), corners().reduce(DVec3::max).unwrap());
        let turn = std::f64::consts::TAU * at(0.569_840_290_9);
        let reach = 20.0 + 280.0 * at(0.324_717_957_2);
        let eye = low.midpoint(high).with_z(low.z + 1.7 + 30.0 * at(0.618_033_988_7))
            + DVec3::new(turn.cos(), turn.sin(), 0.0) * reach;
        let query = Query {
            viewer: Viewer { eye, along: None },
            pois: &[Poi::Object(poi)],
            test: &test,
            forced: &none,
            forbidden: &none,
            measured: false,
            margin: None,
        };
        let detected = Scope { model: &model, units: &units, index: &index }.detect(&query);
        // By hand, from the eye.
        let (low, high) = (low - eye, high - eye);
        let mut faces = Vec::new();
        for k in 0..3 {
            let plane = if low[k] > 0.0 { low[k] } else { high[k] };
            if low[k] > 0.0 || high[k] < 0.0 {
                let [u, v] = [(k + 1) % 3, (k + 2) % 3];
                let corner = |a: f64, b: f64| {
                    let mut p = DVec3::ZERO;
                    (p[k], p[u], p[v]) = (plane, a, b);
                    p
                };
                faces.extend(pyramid(&[
                    corner(low[u], low[v]),
                    corner(high[u], low[v]),
                    corner(high[u], high[v]),
                    corner(low[u], high[v]),
                ]));
            }
        }
        let own: Vec<_> = own.iter().filter_map(|t| pyramid(&t.map(|p| p - eye))).collect();
        let mut verdicts: Vec<Option<bool>> = vec![Some(false); root.len()];
        for (of, is_ground, t) in all.iter().filter(|(of, ..)| *of != poi) {
            let entry = &mut verdicts[*of as usize];
            if *is_ground || *entry == Some(true) {
                continue;
            }
            let t = t.map(|p| p - eye);
            let (near, far) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
            let is_in_box = near.cmple(high + UNSURE_M).all() && far.cmpge(low - UNSURE_M).all();
            let mut now = verdict(&t, &faces);
            if now != Some(true) && is_in_box {
                now = match (now, verdict(&t, &own)) {
                    (_, Some(true)) => Some(true),
                    (Some(false), Some(false)) => Some(false),
                    _ => None,
                };
            }
            if now != Some(false) {
                *entry = now;
            }
        }
        for &object in standing.iter().filter(|o| **o != poi) {
            asked += 1;
            let is_found = detected.occluders.has(units.of_object[object as usize]);
            match verdicts[object as usize] {
                None => unsure += 1,
                Some(expected) if expected != is_found => {
                    let id = &model.objects[object as usize].id;
                    return Err(format!(
                        "{id} hides {}: {is_found}, not {expected} (eye {eye})",
                        model.objects[poi as usize].id
                    )
                    .into());
                }
                Some(expected) => found += u32::from(expected),
            }
        }
    }
    println!("{}: {found} occluders of {asked} asked, {unsure} too near to say", file.display());
    if found < 200 || unsure * 20 > found {
        return Err(format!("{found} occluders found, {unsure} too near to say").into());
    }
    Ok(())
}
