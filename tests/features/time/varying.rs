//! Attributes that change over time: each place has the colour of the value that holds at its own moment.

use glam::DVec3;
use veduta::{
    city::side_table::Join,
    figure::legend::legends,
    geom::Shape,
    lens::{Handled, Lens, Parameter, Region, chosen::Choice},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{CitySpec, Scene},
    time::Moment,
};

use crate::{materials::BOTH, panes::*, studio::*};

const USES: [&str; 3] = ["home", "shop", "mill"];

/// What a pane is used for, from a year up to another.
type Row = (usize, Option<i64>, Option<i64>, usize);

fn rows(random: &mut Random, panes: usize) -> Vec<Row> {
    let mut rows = Vec::new();
    for pane in 0..panes {
        let mut year = 1600 + random.below(100) as i64;
        for i in 0..random.below(5) {
            let long = 20 + random.below(120) as i64;
            let is_last = random.below(4) == 0;
            let begin = if i == 0 && random.below(2) == 0 { None } else { Some(year) };
            rows.push((pane, begin, (!is_last).then_some(year + long), random.below(3) as usize));
            year += long + if random.below(3) == 0 { 30 } else { 0 };
            if is_last {
                break;
            }
        }
    }
    rows
}

/// What holds in a year: of several rows the one that began last.
fn used_in(rows: &[Row], pane: usize, year: i64) -> Option<usize> {
    let holds =
        |row: &&Row| row.0 == pane && row.1.is_none_or(|begin| begin <= year) && row.2.is_none_or(|end| year < end);
    rows.iter().filter(holds).max_by_key(|row| row.1).map(|row| row.3)
}

/// A scene of the panes with a side table, coloured by its `use`.
fn scene_of(folder: &Folder, name: &str, table: &str, panes: &[Pane]) -> Scene {
    let table = folder.write(&format!("{name}.csv"), table);
    let valid = ["since", "until"].map(|column| (name == "over-time").then(|| column.to_owned()));
    let join = Join { file: table, key: "pane".to_owned(), attribute: Some("n".to_owned()), valid };
    let mut thematic = used("thematic");
    let texts = |all: &[&str]| Parameter::Texts(all.iter().map(ToString::to_string).collect());
    thematic.parameters.insert("attribute".to_owned(), Parameter::Text("use".to_owned()));
    thematic.parameters.insert("categories".to_owned(), texts(&USES));
    thematic.parameters.insert("colors".to_owned(), texts(&["#c03020", "#2060c0", "#30a040"]));
    let mut scene = of_context(vec![thematic]);
    scene.city = CitySpec { files: vec![city(panes)], joins: vec![join], ground: false, ..CitySpec::default() };
    scene
}

/// With what holds over time.
fn over_time(folder: &Folder, rows: &[Row], all: &[Pane]) -> Scene {
    let year = |year: &Option<i64>| year.map_or_else(String::new, |year| year.to_string());
    let line = |(pane, begin, end, what): &Row| format!("{pane},{},{},{}\n", USES[*what], year(begin), year(end));
    let table = "pane,use,since,until\n".to_owned() + &rows.iter().map(line).collect::<String>();
    scene_of(folder, "over-time", &table, all)
}

/// With what holds in a year.
fn fixed(folder: &Folder, rows: &[Row], all: &[Pane], year: i64) -> Scene {
    let own = (0..all.len()).filter_map(|pane| Some((pane, used_in(rows, pane, year)?)));
    let lines = own.map(|(pane, what)| format!("{pane},{}\n", USES[what]));
    scene_of(folder, &format!("in-{year}"), &("pane,use\n".to_owned() + &lines.collect::<String>()), all)
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { aovs: ALL, backend, ..Request::plain([160, 130]) };
    studio.render(scene, &request).expect("a picture")
}

#[test]
fn places_have_the_values_of_their_own_moments() {
    let mut random = Random(12);
    let folder = Folder::new("varying");
    let all = panes(10, &mut random);
    let rows = rows(&mut random, all.len());
    let over_time = over_time(&folder, &rows, &all);
    let fixed = |year: i64| fixed(&folder, &rows, &all, year);
    let ball = Shape::Sphere { center: DVec3::new(0.4, 3.0, 5.0), radius: 3.0 };
    let set = |year: i64| Handled {
        handler: "set".to_owned(),
        parameters: [("at".to_owned(), Parameter::Text(year.to_string()))].into(),
    };
    let mut changed = 0;
    let mut studio = of_scene(&over_time);
    for (outside, inside) in [(1650, 1750), (1790, 1700), (1850, 1620)] {
        let mut shown = over_time.clone();
        shown.moment = Moment::of_year(outside);
        let mut lens = lens("then", [ball.clone()], "sepia");
        lens.effects.clear();
        shown.lenses = vec![Lens { time: vec![set(inside)], ..lens }];
        let [before, then] = [outside, inside].map(|year| {
            let scene = fixed(year);
            drawn(&mut of_scene(&scene), &scene, Backend::Specialised)
        });
        for backend in BOTH {
            let found = drawn(&mut studio, &shown, backend);
            let is_inside = bits(&found, 0);
            for (i, color) in found.rgba.iter().enumerate() {
                let expected = if is_inside[i] { then.rgba[i] } else { before.rgba[i] };
                assert_eq!(
                    *color, expected,
                    "{outside} and {inside}, {backend:?}: pixel {i}, inside: {}",
                    is_inside[i]
                );
                changed += usize::from(then.rgba[i] != before.rgba[i] && is_inside[i]);
            }
        }
    }
    assert!(changed > 1000, "{changed} places look otherwise in the lens");
}

#[test]
fn choices_and_legends_go_by_the_moment_of_the_scene() {
    let mut random = Random(12);
    let folder = Folder::new("varying-choice");
    let all = panes(10, &mut random);
    let rows = rows(&mut random, all.len());
    let shops =
        Choice { attribute: Some("use".to_owned()), values: Some(vec!["shop".to_owned()]), ..Choice::default() };
    let with_lens = |scene: &Scene| {
        let mut scene = scene.clone();
        for used in &mut scene.style.effects {
            used.parameters.insert("counts".to_owned(), Parameter::Boolean(true));
        }
        scene.lenses = vec![lens("shops", [Region::Thematic(shops.clone())], "invert")];
        scene
    };
    let over_time = with_lens(&over_time(&folder, &rows, &all));
    let mut studio = of_scene(&over_time);
    let counted = |studio: &Studio, scene: &Scene| -> Vec<String> {
        let found = legends(scene, studio.file(), &[true], &studio.model, &[]);
        found[0].rows().iter().map(|row| row.label.clone()).collect()
    };
    let mut shown = std::collections::BTreeSet::new();
    // Back and forth, and then as the file has it: the last that holds.
    for year in [1650, 1750, 1820, 1700] {
        let now = Scene { moment: Moment::of_year(year), ..over_time.clone() };
        let still = with_lens(&fixed(&folder, &rows, &all, year));
        let mut other = of_scene(&still);
        for backend in BOTH {
            let expected = drawn(&mut other, &still, backend);
            let found = drawn(&mut studio, &now, backend);
            assert!(found.rgba == expected.rgba, "{year}, {backend:?}");
            shown.insert(found.rgba.concat());
        }
        let sorted = |mut rows: Vec<String>| {
            rows.retain(|row| !row.ends_with("(0)"));
            rows.sort();
            rows
        };
        assert_eq!(sorted(counted(&studio, &now)), sorted(counted(&other, &still)), "{year}");
    }
    assert!(shown.len() > 2);
    let last = Scene { moment: None, ..over_time.clone() };
    assert!(drawn(&mut studio, &last, BOTH[0]).rgba == drawn(&mut of_scene(&last), &last, BOTH[0]).rgba);
}
