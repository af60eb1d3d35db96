//! Walks of 300 frames: an object changes class at most once per crossing of the boundary of its test, its weight by no more than
//! time allows, and each pixel of the frames is as the weights say. Oracles: distances to boxes, measured here; who hides
//! something at each moment for itself; object ids of pictures without the lens, and the thresholds of `lens::dither`.

#![allow(clippy::print_stdout, reason = "what was measured, for those who ask with --no-capture")]

use std::{path::Path, sync::Arc};

use glam::DVec3;
use libtest_mimic::{Failed, Trial};
use veduta::{
    city::{
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    figure::animation::Film,
    gpu::Gpu,
    lens::{
        Lens, Occluders, Region, Rendering,
        dither::dither,
        kind::Occlusion,
        rendering::{Case, Given, ROWS, When},
    },
    render::picture::{Aovs, Picture, Request, Studio},
    scene::{CitySpec, Poi, PoiPlace, Scene, animation::Animation},
    view::{
        Projection,
        path::{CameraKey, Speed},
    },
    visibility::{self, Margin, Pace, Query, Reference, Scope, Set, Test, Units, Viewer},
};

pub fn trials() -> Vec<Trial> {
    let files = ["denhaag-01/DenHaag_01.v1.0.city.json", "vienna-102081/vienna_102081.v1.1.city.jsonl"];
    files.map(|file| crate::trial(&format!("walks::{file}"), move |root| check(&root.join(file)))).into()
}

const FRAMES: u32 = 300;
const FPS: f64 = 30.0;
const FADE_S: f64 = 0.4;
/// Reach and margin of the lens that means what is near, metres.
const NEAR_M: f64 = 45.0;
/// Reach of the first case, metres.
const CASE_M: f64 = 60.0;
const MARGIN_M: f64 = 3.0;
/// Frames that are drawn one after the other.
const STRETCH: u32 = 12;
const SIZE: [u32; 2] = [320, 180];

fn lens(name: &str, test: Test) -> Lens {
    let of = Occluders {
        pois: vec!["it".into()],
        test,
        margin: Margin { metres: MARGIN_M },
        pace: Pace { fade_s: FADE_S },
        ..Occluders::default()
    };
    let plain = crate::studio::lens(name, [Region::Occluders(of)], "sepia");
    Lens { kind: Occlusion::default().into(), effects: vec![], ..plain }
}

/// What is told of one object, or of all.
#[derive(Clone, Copy, Debug, Default)]
struct Changes {
    /// Times that a test itself changed its answer.
    crossings: u32,
    /// Times that the class did.
    classes: u32,
}

/// The class of each unit over time, told from its weight alone.
struct Classes {
    weights: Vec<f32>,
    is_in: Vec<bool>,
    was_raw: Vec<bool>,
    changes: Vec<Changes>,
}

impl Classes {
    fn new(units: usize) -> Self {
        let none = vec![false; units];
        Self { weights: vec![], is_in: none.clone(), was_raw: none, changes: vec![Changes::default(); units] }
    }

    /// A frame later: weights by unit, and whether its test holds at this moment by itself; how many fade.
    fn step(&mut self, weights: Vec<f32>, raw: impl Fn(u32) -> bool, frame: u32) -> Result<usize, Failed> {
        let most = (1.0 / FPS / FADE_S) as f32 + 1e-5;
        let is_first = self.weights.is_empty();
        for (unit, &now) in weights.iter().enumerate() {
            let raw = raw(unit as u32);
            if is_first {
                (self.is_in[unit], self.was_raw[unit]) = (now == 1.0, raw);
                if now != f32::from(u8::from(raw)) {
                    return Err(format!("unit {unit} begins with {now} where its test says {raw}").into());
                }
                continue;
            }
            let before = self.weights[unit];
            if (now - before).abs() > most {
                return Err(format!("frame {frame}: unit {unit} goes from {before} to {now}").into());
            }
            let is_in = if now == before { now == 1.0 } else { now > before };
            self.changes[unit].classes += u32::from(is_in != self.is_in[unit]);
            self.changes[unit].crossings += u32::from(raw != self.was_raw[unit]);
            if is_in != self.is_in[unit] && is_in != raw {
                return Err(format!("frame {frame}: unit {unit} becomes {is_in} where its test says {raw}").into());
            }
            (self.is_in[unit], self.was_raw[unit]) = (is_in, raw);
        }
        let fading = weights.iter().filter(|w| **w > 0.0 && **w < 1.0).count();
        self.weights = weights;
        Ok(fading)
    }

    fn sum(&self) -> Result<Changes, Failed> {
        let mut sum = Changes::default();
        for (unit, of) in self.changes.iter().enumerate() {
            if of.classes > of.crossings {
                return Err(
                    format!("unit {unit} changes class {} times for {} crossings", of.classes, of.crossings).into()
                );
            }
            sum = Changes { crossings: sum.crossings + of.crossings, classes: sum.classes + of.classes };
        }
        Ok(sum)
    }
}

fn check(file: &Path) -> Result<(), Failed> {
    let model = Arc::new(load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?);
    let shown = shown_geometries(&model, None);
    let (units, index) = (Units::new(&model, &shown), SpatialIndex::build(&model, &shown));
    let height = |unit: usize| units.boxes[unit].size().z;
    let tallest =
        (0..units.len()).filter(|&u| !units.boxes[u].is_empty()).max_by(|&a, &b| height(a).total_cmp(&height(b)));
    let tallest = tallest.ok_or("the city is empty")?;
    let (middle, foot) = (units.boxes[tallest].center(), units.boxes[tallest].min.z);
    // About it, as a walker sees it.
    let key = |(i, (turn, reach)): (usize, (f64, f64))| CameraKey {
        at: i as f64,
        eye: middle.with_z(foot + 1.7) + DVec3::new(turn.cos(), turn.sin(), 0.0) * reach,
        target: middle,
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 0.9 },
    };
    let way = [(0.0, 170.0), (0.5, 120.0), (1.1, 150.0), (1.6, 90.0), (2.2, 130.0)];
    let root = model.objects[units.roots[tallest] as usize].id.to_string();
    let walk = |lenses: Vec<Lens>| Scene {
        lenses,
        pois: vec![Poi { name: "it".into(), place: PoiPlace::Object(root.clone()) }],
        animation: Some(Animation {
            frames: FRAMES,
            fps: FPS,
            speed: Speed::Constant,
            camera: way.iter().copied().enumerate().map(key).map(|k| CameraKey { at: 2.5 * k.at, ..k }).collect(),
            changes: vec![],
            moments: None,
        }),
        ..crate::studio::scene(veduta::view::Camera::looking(middle + DVec3::X, middle, 1.0), vec![])
    };
    let near = Test::Spherical { radius: NEAR_M, reference: Reference::Nearest };
    // All are occluders all the time: those near stay as they are, the others are gone.
    let all = Test::Spherical { radius: 1e5, reference: Reference::Nearest };
    let case = |nearer_m| Case { when: When { nearer_m, ..When::default() }, ..Case::of_row(&ROWS[0], Given::new()) };
    let cases = Rendering::of_cases(vec![Case { effects: vec![], ..case(Some(CASE_M)) }, case(None)]);
    let by_case = Lens { kind: Occlusion { rendering: cases, content: None }.into(), ..lens("by case", all) };
    let film = Film::new(&walk(vec![lens("hides", Test::default()), lens("near", near), by_case.clone()]))?;
    let mut studio = Studio::new(Gpu::open()?, model.clone(), &CitySpec { ground: false, ..CitySpec::default() })?;
    let none = Set::new(units.len());
    let by_unit = |weights: Option<Vec<f32>>| -> Result<Vec<f32>, Failed> {
        let weights = weights.ok_or("no time passed")?;
        let mut all = vec![0.0_f32; units.len()];
        weights.iter().zip(&units.of_object).for_each(|(w, &unit)| all[unit as usize] = all[unit as usize].max(*w));
        Ok(all)
    };
    let [mut hides, mut nears, mut cases] = [0, 1, 2].map(|_| Classes::new(units.len()));
    let [mut fading, mut changing] = [vec![], vec![]];
    for frame in 0..FRAMES {
        let scene = film.scene(frame)?;
        let eye = scene.camera.ok_or("a camera")?.eye;
        studio.pass(&scene, SIZE, 1.0 / FPS)?;
        let query = Query {
            viewer: Viewer { eye, along: None },
            pois: &[visibility::Poi::Object(units.roots[tallest])],
            test: &Test::default(),
            forced: &none,
            forbidden: &none,
            measured: false,
            margin: None,
        };
        let detected = Scope { model: &model, units: &units, index: &index }.detect(&query);
        let weights = by_unit(studio.occluder_weights("hides"))?;
        fading.push(hides.step(weights, |unit| detected.occluders.has(unit), frame)?);
        let is_near = |unit: u32, reach: f64| {
            let around = &units.boxes[unit as usize];
            let nearest = eye.clamp(around.min, around.max.max(around.min));
            unit as usize != tallest && !around.is_empty() && nearest.distance(eye) < reach
        };
        let of_cases = studio.case_weights("by case").ok_or("no time passed")?;
        let whole = of_cases[0].iter().zip(&of_cases[1]).map(|(a, b)| a + b).collect();
        let expected = |unit: usize| f32::from(u8::from(unit != tallest && !units.boxes[unit].is_empty()));
        if by_unit(Some(whole))?.iter().enumerate().any(|(unit, sum)| (sum - expected(unit)).abs() > 1e-6) {
            return Err(format!("frame {frame}: cases are no whole").into());
        }
        let weights = [by_unit(studio.occluder_weights("near"))?, by_unit(Some(of_cases[0].clone()))?];
        let plain = drawn(&mut studio, &Scene { lenses: vec![], ..scene })?.object_id.unwrap_or_default();
        let fades = |id: &&u32| {
            let unit = id.checked_sub(1).map(|object| units.of_object[object as usize]);
            unit.is_some_and(|unit| (0.01..0.99).contains(&weights[1][unit as usize]))
        };
        changing.push(plain.iter().filter(fades).count());
        let kinds = [("near", NEAR_M), ("by case", CASE_M)];
        for ((classes, weights), (what, reach)) in [&mut nears, &mut cases].into_iter().zip(weights).zip(kinds) {
            let was: Vec<bool> = classes.is_in.clone();
            classes.step(weights, |unit| is_near(unit, reach), frame)?;
            // It is left only beyond the margin.
            for unit in (0..units.len()).filter(|&u| was[u] && !classes.is_in[u]) {
                let around = &units.boxes[unit];
                let away = eye.clamp(around.min, around.max).distance(eye);
                if frame > 0 && away < reach + MARGIN_M {
                    return Err(format!("frame {frame}, {what}: unit {unit} is left at {away} m").into());
                }
            }
        }
    }
    let [of_hides, of_nears, of_cases] = [hides.sum()?, nears.sum()?, cases.sum()?];
    println!("{}: hides {of_hides:?}, near {of_nears:?}, by case {of_cases:?}", file.display());
    if of_hides.classes < 20 || of_nears.classes < 20 || of_cases.classes < 20 {
        return Err("the walk meets too little".into());
    }
    // Where most fades: each pixel is of what the weights say.
    let of_hides = lens("hides", Test::default());
    for (lens, fading) in [(of_hides, fading), (by_case, changing)] {
        let of_stretch = |first: u32| fading[first as usize..(first + STRETCH) as usize].iter().sum::<usize>();
        let first = (1..FRAMES - STRETCH).max_by_key(|&first| of_stretch(first)).ok_or("frames")?;
        let is_by_case = lens.name == "by case";
        let film = Film::new(&walk(vec![lens]))?;
        studio.pass(&walk(vec![]), SIZE, 0.0)?;
        let (mut patterned, mut taken) = (0, 0);
        for frame in 0..first + STRETCH {
            let scene = film.scene(frame)?;
            studio.pass(&scene, SIZE, 1.0 / FPS)?;
            if frame < first {
                continue;
            }
            // Between which thresholds each object is taken away.
            let gone: Vec<[f32; 2]> = if is_by_case {
                let cases = studio.case_weights("by case").ok_or("no time passed")?;
                cases[0].iter().zip(&cases[1]).map(|(first, second)| [*first, first + second]).collect()
            } else {
                let weights = studio.occluder_weights("hides").ok_or("no time passed")?;
                weights.into_iter().map(|weight| [0.0, weight]).collect()
            };
            let with = drawn(&mut studio, &scene)?;
            let plain = drawn(&mut studio, &Scene { lenses: vec![], ..scene })?;
            for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
                let [was, now] = [&plain, &with].map(|p| p.object_id.as_ref().map_or(0, |ids| ids[i]));
                let thresholds = |id: u32| id.checked_sub(1).map_or([0.0; 2], |object| gone[object as usize]);
                let is_gone = |id: u32| {
                    let ([from, to], own) = (thresholds(id), dither([x, y], 0));
                    from <= own && to > own
                };
                if is_gone(now) || (!is_gone(was) && was != now) {
                    let [a, b] = [was, now].map(thresholds);
                    return Err(
                        format!("frame {frame}: pixel {x} {y} shows {now} ({b:?}) where {was} ({a:?}) is").into()
                    );
                }
                let [from, to] = thresholds(was);
                patterned += usize::from((0.01..0.99).contains(&(to - from)));
                taken += usize::from(is_gone(was));
            }
        }
        println!("frames {first} to {}: {patterned} pixels of what fades, {taken} taken away", first + STRETCH - 1);
        if patterned < 500 || taken < 2_000 {
            return Err(format!("{patterned} pixels of what fades, {taken} taken away").into());
        }
    }
    Ok(())
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Result<Picture, Failed> {
    let aovs = Aovs { object_id: true, ..Aovs::default() };
    let request = Request { aovs, ..Request::plain(SIZE) };
    Ok(studio.render(scene, &request)?)
}
