//! Which objects show when: Delft by its years of construction, from above, against a reader of the file that knows nothing of the program and
//! a reference that goes through all time lenses in whole years.

use std::{collections::HashMap, path::Path};

use glam::{DVec2, DVec3};
use libtest_mimic::{Failed, Trial};
use serde_json::Value;
use veduta::{
    geom::Shape,
    lens::{Handled, Lens, LensBody, Parameter, kind::TimeLens},
    render::{
        frame::Backend,
        picture::{Aovs, Request},
    },
    scene::Scene,
    time::Moment,
    view::{Camera, Projection},
};

use crate::studio;

pub fn trials() -> Vec<Trial> {
    vec![crate::trial("time::delft_shows_what_its_register_says", |root| {
        check(&root.join("3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl"))
    })]
}

/// Years of construction by object, as the file says them: parts have their building's.
fn years(file: &Path) -> Result<HashMap<String, i64>, Failed> {
    let mut years = HashMap::new();
    for line in std::fs::read_to_string(file)?.lines() {
        let line: Value = serde_json::from_str(line)?;
        let Some(objects) = line["CityObjects"].as_object() else { continue };
        let own = |object: &Value| object["attributes"]["oorspronkelijkbouwjaar"].as_i64();
        for (id, object) in objects {
            let parent = object["parents"][0].as_str().and_then(|parent| objects.get(parent));
            if let Some(year) = own(object).or_else(|| parent.and_then(own)) {
                years.insert(id.clone(), year);
            }
        }
    }
    Ok(years)
}

/// A time operator in whole years.
#[derive(Clone, Copy)]
enum InYears {
    Set(i64),
    Shift(i64),
    Floor(i64),
    Ceil(i64),
}

impl InYears {
    fn of(number: u64) -> Self {
        let at = |most: u64| (number / 4 % most) as i64;
        match number % 4 {
            0 => Self::Set(1380 + at(650)),
            1 => Self::Shift(at(400) - 200),
            2 => Self::Floor([10, 50, 100][at(3) as usize]),
            _ => Self::Ceil([10, 25, 100][at(3) as usize]),
        }
    }

    fn apply(self, year: i64) -> i64 {
        match self {
            Self::Set(year) => year,
            Self::Shift(by) => year + by,
            Self::Floor(unit) => year - year.rem_euclid(unit),
            Self::Ceil(unit) => year + (-year).rem_euclid(unit),
        }
    }

    fn step(self) -> Handled {
        let (op, key, text) = match self {
            Self::Set(year) => ("set", "at", year.to_string()),
            Self::Shift(by) => ("shift", "by", format!("{by} years")),
            Self::Floor(unit) => ("floor", "unit", format!("{unit} years")),
            Self::Ceil(unit) => ("ceil", "unit", format!("{unit} years")),
        };
        Handled { handler: op.into(), parameters: [(key.to_owned(), Parameter::Text(text))].into() }
    }
}

/// A time lens over a disc of the ground.
struct Disc {
    middle: DVec2,
    radius: f64,
    steps: Vec<InYears>,
}

impl Disc {
    fn lens(&self, number: usize) -> Lens {
        let shape =
            Shape::Cylinder { center: self.middle.extend(0.0), radius: self.radius, height: 1000.0, axis: DVec3::Z };
        Lens {
            shapes: vec![shape.into()],
            time: self.steps.iter().map(|step| step.step()).collect(),
            body: LensBody::None,
            ..Lens::plain(format!("lens {number}"), TimeLens::default(), [0.5; 3])
        }
    }
}

/// Numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn share(&mut self) -> f64 {
        self.next() as f64 / (1_u64 << 31) as f64
    }
}

const SIZE: [u32; 2] = [280, 280];
/// Nearer to the border of a lens than this an f32 may tell otherwise, metres.
const UNSURE_M: f64 = 1e-3;

fn check(file: &Path) -> Result<(), Failed> {
    let years = years(file)?;
    assert_eq!(years.len(), 199, "objects with a year, of their own or their building's");
    let mut studio = studio::studio(&[file.to_owned()]);
    let extent = studio.extent();
    let height_m = 1.02 * (extent.max - extent.min).truncate().max_element();
    let middle = extent.center();
    let camera = Camera {
        up: DVec3::Y,
        projection: Projection::Orthographic { height_m },
        ..Camera::looking(middle.with_z(extent.max.z + 500.0), middle, 1.0)
    };
    let year_of = |id: u32| years[&*studio.model.objects[id as usize - 1].id];
    let all: Vec<i64> = (0..studio.model.objects.len() as u32).map(|object| year_of(object + 1)).collect();
    let place = |pixel: usize| {
        let (x, y) = (pixel % SIZE[0] as usize, pixel / SIZE[0] as usize);
        let share = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / DVec2::from(SIZE.map(f64::from));
        middle.truncate() + height_m * (share - 0.5) * DVec2::new(1.0, -1.0)
    };
    let mut random = Random(44);
    let (mut compared, mut inside, mut gone) = (0_u64, 0_u64, 0_u64);
    let mut picture = |scene: &Scene, backend| {
        let request = Request { aovs: Aovs { object_id: true, ..Aovs::default() }, backend, ..Request::plain(SIZE) };
        Ok::<_, Failed>(studio.render(scene, &request)?.object_id.unwrap_or_default())
    };
    let timeless = picture(&studio::scene(camera, Vec::new()), Backend::Specialised)?;
    for count in [1, 8, 64] {
        for (i, year) in (0..40).map(|i| (i, 1380 + i * 650 / 39)) {
            // Of many lenses a sample: each picture takes seconds.
            if count > 1 && i % (if studio::is_thorough() { 1 } else { count / 2 }) != 0 {
                continue;
            }
            let disc = |random: &mut Random| Disc {
                middle: middle.truncate() + height_m * (DVec2::new(random.share(), random.share()) - 0.5),
                radius: height_m * (0.1 + 0.4 * random.share()),
                steps: (0..1 + random.next() % 3).map(|_| InYears::of(random.next())).collect(),
            };
            let mut discs: Vec<Disc> = (0..count).map(|_| disc(&mut random)).collect();
            if count == 1 {
                // What the issue of a register asks for: one lens at one year, now elsewhere.
                discs[0].steps = vec![InYears::Set(year)];
            }
            let scene_year = if count == 1 { 2030 - 3 * i } else { year };
            let lenses = discs.iter().enumerate().map(|(i, disc)| disc.lens(i)).collect();
            let scene = Scene { moment: Moment::of_year(scene_year), ..studio::scene(camera, lenses) };
            for backend in [Backend::Specialised, Backend::Uber] {
                if backend == Backend::Uber && i % 8 != 0 && !studio::is_thorough() {
                    continue;
                }
                let shown = picture(&scene, backend)?;
                let mut seen = [Vec::new(), Vec::new()];
                for (pixel, (&now, &ever)) in shown.iter().zip(&timeless).enumerate() {
                    let at = place(pixel);
                    let border = |disc: &Disc| (disc.middle.distance(at) - disc.radius).abs();
                    if discs.iter().map(border).fold(f64::INFINITY, f64::min) < UNSURE_M {
                        continue;
                    }
                    let holds = |disc: &&Disc| disc.middle.distance(at) < disc.radius;
                    let steps = discs.iter().filter(holds).flat_map(|disc| &disc.steps);
                    let then = steps.fold(scene_year, |year, step| step.apply(year));
                    let is_inside = discs.iter().any(|disc| holds(&disc));
                    if now != 0 {
                        let own = all[now as usize - 1];
                        assert!(own <= then, "{count} lenses, {year}: an object of {own} in {then}");
                        seen[usize::from(is_inside)].push(now);
                    }
                    if ever != 0 {
                        let own = all[ever as usize - 1];
                        assert_eq!(now == ever, own <= then, "{count} lenses, {year}: the object of {own} in {then}");
                        gone += u64::from(own > then);
                        inside += u64::from(is_inside);
                        compared += 1;
                    }
                }
                if count == 1 {
                    sets_agree(&discs[0], year, scene_year, &seen, &timeless, &all, place);
                }
            }
        }
    }
    assert!(
        compared > 250_000 && inside > 100_000 && gone > 100_000,
        "{compared} pixels, {inside} in lenses, {gone} gone"
    );
    Ok(())
}

/// The objects that are seen inside and outside a lens are those that were there then of the ones that have a pixel there.
fn sets_agree(
    disc: &Disc,
    year: i64,
    scene_year: i64,
    seen: &[Vec<u32>; 2],
    timeless: &[u32],
    all: &[i64],
    place: impl Fn(usize) -> DVec2,
) {
    for (seen, is_inside, then) in [(&seen[1], true, year), (&seen[0], false, scene_year)] {
        let sorted = |mut objects: Vec<u32>| {
            objects.sort_unstable();
            objects.dedup();
            objects
        };
        let here = |pixel: usize| (disc.middle.distance(place(pixel)) < disc.radius) == is_inside;
        let is_unsure = |pixel: usize| (disc.middle.distance(place(pixel)) - disc.radius).abs() < UNSURE_M;
        let own = timeless.iter().enumerate().filter(|(pixel, id)| **id != 0 && here(*pixel) && !is_unsure(*pixel));
        let own = own.map(|(_, id)| *id).filter(|id| all[*id as usize - 1] <= then);
        let (expected, seen) = (sorted(own.collect()), sorted(seen.clone()));
        assert!(expected.iter().all(|id| seen.contains(id)), "{year}, inside {is_inside}: something is missing");
        let is_there = |id: &u32| all[*id as usize - 1] <= then;
        assert!(seen.iter().all(is_there), "{year}, inside {is_inside}: something is too much");
    }
}
