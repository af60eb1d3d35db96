//! Derived forms of every building of real cities: sound models, and each form holds what it must.

use libtest_mimic::{Failed, Trial};
use rustc_hash::FxHashMap;
use veduta::{
    city::{
        CityModel,
        derived::{Derive, Form, Height, derive},
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
    },
    geom::Aabb,
};

/// (file, buildings at least, those without a prism at most)
const CITIES: [(&str, usize, u32); 3] = [
    ("denhaag-01/DenHaag_01.v1.0.city.json", 800, 8),
    ("vienna-102081/vienna_102081.v1.1.city.jsonl", 90, 8),
    ("3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl", 90, 8),
];

pub fn trials() -> Vec<Trial> {
    let trial = |(file, least, most): (&'static str, usize, u32)| {
        crate::trial(&format!("derived::{file}"), move |root| {
            let model = load(&[root.join(file)], &LoadOptions::default(), &Quiet)?;
            check(&model, least, most)
        })
    };
    CITIES.into_iter().map(trial).collect()
}

/// Per object: what its faces enclose (cubic metres), the box around them, what those that look up cover (square metres).
fn sums(model: &CityModel) -> FxHashMap<u32, (f64, Aabb, f64)> {
    let mut sums: FxHashMap<u32, (f64, Aabb, f64)> = FxHashMap::default();
    for geometry in &model.geometries {
        let (volume, bounds, plan) = sums.entry(geometry.object).or_insert((0.0, Aabb::EMPTY, 0.0));
        let base = geometry.bounds.min;
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            for corners in model.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| model.position(tile, tile.vertices.start + corners[k]));
                *volume += (a - base).dot((b - base).cross(c - base)) / 6.0;
                *plan += 0.5 * (b - a).truncate().perp_dot((c - a).truncate()).max(0.0);
                *bounds = [a, b, c].into_iter().fold(*bounds, Aabb::grown);
            }
        }
    }
    sums
}

fn check(model: &CityModel, least: usize, most: u32) -> Result<(), Failed> {
    let shown = shown_geometries(model, None);
    let made = |form| {
        let derived = derive(model, &shown, &Derive { form, parts: false });
        derived.model.validate().map_err(|problem| format!("{form:?}: {problem}"))?;
        Ok::<_, Failed>(derived)
    };
    let boxes = made(Form::Box { oriented: false })?;
    let [oriented, prisms, hulls] = [Form::Box { oriented: true }, Form::Prism, Form::Hull].map(made);
    let (oriented, prisms, hulls) = (oriented?, prisms?, hulls?);
    let raised = made(Form::Height(Height::Factor(2.0)))?;
    let flat = made(Form::Flat { lift_m: 0.05 })?;
    let counts = [boxes.unchanged, oriented.unchanged, prisms.unchanged, hulls.unchanged, raised.unchanged];
    if counts.iter().any(|count| *count > most) || flat.left_out > most {
        return Err(format!("without a form: {counts:?}, {}", flat.left_out).into());
    }
    let [boxes, oriented, prisms, hulls] = [&boxes, &oriented, &prisms, &hulls].map(|derived| sums(&derived.model));
    if boxes.len() < least {
        return Err(format!("{} objects", boxes.len()).into());
    }
    let mut plan = 0.0;
    for (object, (in_box, bounds, _)) in &boxes {
        let of = |sums: &FxHashMap<u32, (f64, Aabb, f64)>| sums.get(object).copied().unwrap_or((0.0, Aabb::EMPTY, 0.0));
        let ((in_oriented, ..), (in_prism, of_prism, area), (in_hull, of_hull, _)) =
            (of(&oriented), of(&prisms), of(&hulls));
        plan += area;
        let id = &model.objects[*object as usize].id;
        let slack = 1.0 + 1e-3 * in_box;
        if in_oriented > in_box + slack || in_prism > in_box + slack || in_hull > in_box + slack {
            return Err(format!("{id}: box {in_box}, {in_oriented}, prism {in_prism}, hull {in_hull} m³").into());
        }
        let size = bounds.size();
        if (in_box - size.x * size.y * size.z).abs() > slack {
            return Err(format!("{id}: a box of {in_box} m³ is {size}").into());
        }
        // What has no such form is shown under the numbers of its parts; there are few, as counted above.
        for around in [of_prism, of_hull].into_iter().filter(|around| !around.is_empty()) {
            let off = (around.min - bounds.min).abs().max((around.max - bounds.max).abs()).max_element();
            if off > 2.1e-3 {
                return Err(format!("{id}: {off} m from its box").into());
            }
        }
    }
    // The plan of what is flat counts overlaps as often as there are; that of prisms once.
    let pressed: f64 = sums(&flat.model).values().map(|(.., area)| area).sum();
    let (low, high) = (0.98 * plan, 3.0 * plan);
    if !(low..high).contains(&pressed) {
        return Err(format!("flat covers {pressed} m², prisms {plan} m²").into());
    }
    let raised = sums(&raised.model);
    let is_alone = |object: &u32| {
        let object = &model.objects[*object as usize];
        object.parents.is_empty() && object.children.is_empty()
    };
    for (object, (_, bounds, _)) in raised.iter().filter(|(object, _)| is_alone(object)) {
        let before = boxes.get(object).map_or(0.0, |(_, bounds, _)| bounds.size().z);
        if (bounds.size().z - 2.0 * before).abs() > 3e-3 {
            let id = &model.objects[*object as usize].id;
            return Err(format!("{id}: {} m high, was {before} m", bounds.size().z).into());
        }
    }
    Ok(())
}
