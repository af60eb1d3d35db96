//! Hard case 19: a register in which not all buildings have a date (Lyon's first arrondissement, BD TOPO), joined to a city with its ids.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;
use veduta::{
    city::{
        facts::TimeFacts,
        lifetime::{Dating, Lifetimes, Undated},
        load::{LoadOptions, Quiet, load},
        side_table::Join,
    },
    time::{Granularity, Interval},
};

use crate::studio::Folder;

pub fn trials() -> Vec<Trial> {
    vec![crate::trial("register::case_19_lyon_has_buildings_without_a_date", |root| {
        check(&root.join("lyon1-3dtiles-time/buildings_lyon1.geojson"))
    })]
}

/// A city of as many cubes, one after the other, with these ids.
fn city(ids: &[String]) -> String {
    let faces = "[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]";
    let mut objects = Vec::new();
    let mut vertices = Vec::new();
    for (i, id) in ids.iter().enumerate() {
        let first = 8 * i;
        let own: String =
            faces.chars().map(|c| c.to_digit(10).map_or(c.to_string(), |k| (first + k as usize).to_string())).collect();
        objects.push(format!(
            r#""{id}": {{"type": "Building", "geometry": [{{"type": "Solid", "lod": "1", "boundaries": [[{own}]]}}]}}"#
        ));
        let (x, y) = (20 * (i as i64 % 60), 20 * (i as i64 / 60));
        for z in [0, 10] {
            vertices.extend([[x, y, z], [x + 10, y, z], [x + 10, y + 10, z], [x, y + 10, z]]);
        }
    }
    format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [1, 1, 1], "translate": [0, 0, 0]}}, "CityObjects": {{{}}}, "vertices": {vertices:?}}}"#,
        objects.join(", ")
    )
}

fn check(register: &Path) -> Result<(), Failed> {
    let read: Value = serde_json::from_str(&std::fs::read_to_string(register)?)?;
    let features = read["features"].as_array().ok_or("no features")?;
    let ids: Vec<String> = features.iter().filter_map(|f| f["properties"]["ID"].as_str()).map(str::to_owned).collect();
    // An independent reading: dates of ISO 8601 are in the order of their texts.
    let dates: Vec<Option<&str>> = features.iter().map(|f| f["properties"]["DATE_APP"].as_str()).collect();
    assert_eq!((ids.len(), dates.iter().flatten().count()), (2576, 2576 - 911));
    let folder = Folder::new("lyon");
    // The city lacks the last of the register, and has one that the register lacks.
    let mut own = ids[..2575].to_vec();
    own.push("BATIMENT of none".to_owned());
    let file = folder.write("lyon.city.json", city(&own));
    let join = Join { file: register.to_owned(), key: "ID".into(), ..Join::default() };
    let options = LoadOptions { joins: vec![join], ..LoadOptions::default() };
    let model = load(&[file], &options, &Quiet)?;
    model.validate()?;
    let facts = &model.joins[0];
    assert_eq!((facts.rows, facts.joined, facts.objects, facts.without_object), (2576, 2575, 2575, 1));
    assert_eq!(facts.first_without_object, [ids[2575].clone()]);
    let dating = Dating { from: Some("DATE_APP".into()), ..Dating::default() };
    let found = Lifetimes::new(&model, &dating)?;
    let with_date = dates[..2575].iter().flatten().count() as u64;
    assert_eq!((found.dated, found.undated, found.empty, &found.unreadable), (with_date, 2576 - with_date, 0, &None));
    let hidden = Lifetimes::new(&model, &Dating { undated: Undated::Hide, ..dating.clone() })?;
    for at in ["0001-01-01", "1419-12-31", "1420-01-01", "1850-01-01", "1850-06-15", "1914-01-01", "2026-11-29"] {
        let moment = Interval::parse(at)?.begin;
        for (i, id) in own.iter().enumerate() {
            let date = dates.get(i).copied().flatten().filter(|_| i < 2575);
            let is_built = date.is_some_and(|date| date <= at);
            assert_eq!(found.of[i].holds(moment), date.is_none() || is_built, "{id} of {date:?} in {at}");
            assert_eq!(hidden.of[i].holds(moment), is_built, "{id} of {date:?} in {at}, undated hidden");
        }
    }
    let facts = TimeFacts::new(&model, &dating)?.ok_or("no dates")?;
    assert_eq!((facts.dated, facts.undated, facts.unreadable), (with_date, 2576 - with_date, 0));
    assert_eq!(found.granularity, Some(Granularity::Day));
    Ok(())
}
