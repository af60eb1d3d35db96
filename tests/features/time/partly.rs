//! What is there by halves: moments that show together, ghosts of what is gone and of what will come, objects without a date as ghosts. Layers
//! against a reference that goes through all combinations in whole years and composites in f64.

use std::collections::BTreeMap;

use glam::DVec3;
use veduta::{
    city::lifetime::Undated,
    geom::{Aabb, Shape},
    lens::{Handled, Lens, Parameter, Region},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    time::Moment,
    view::View,
};

use crate::{materials::BOTH, panes::*, studio::*};

/// When a pane is there, in years: from one up to another.
type Years = [Option<i64>; 2];

/// A time operator in whole years.
#[derive(Clone, Debug)]
enum Step {
    Set(i64),
    Shift(i64),
    Decade,
    /// Years, or so many later; and weights.
    Together(Vec<(bool, i64, u64)>),
    /// How long what is gone fades.
    Ghost(i64),
}

impl Step {
    fn new(random: &mut Random) -> Self {
        let year = |random: &mut Random| 1800 + random.below(200) as i64;
        let by = |random: &mut Random| random.below(120) as i64 - 60;
        match random.below(7) {
            0 => Self::Set(year(random)),
            1 => Self::Shift(by(random)),
            2 => Self::Decade,
            3 => Self::Ghost(random.below(90) as i64),
            _ => {
                let one = |random: &mut Random| match random.below(2) {
                    0 => (false, year(random), 1 + random.below(4)),
                    _ => (true, by(random), 1 + random.below(4)),
                };
                Self::Together((0..=random.below(3)).map(|_| one(random)).collect())
            }
        }
    }

    /// As scenes have it.
    fn handled(&self) -> Handled {
        let years = |by: i64| format!("{by} years");
        let (op, parameters): (&str, Vec<(&str, Parameter)>) = match self {
            Self::Set(year) => ("set", vec![("at", Parameter::Text(year.to_string()))]),
            Self::Shift(by) => ("shift", vec![("by", Parameter::Text(years(*by)))]),
            Self::Decade => ("floor", vec![("unit", Parameter::Text("decade".into()))]),
            Self::Ghost(past) => ("ghost", vec![("past", Parameter::Text(years(*past)))]),
            Self::Together(all) => {
                let one =
                    |(is_later, year, _): &(bool, i64, u64)| if *is_later { years(*year) } else { year.to_string() };
                let weights = all.iter().map(|(.., weight)| *weight as f64).collect();
                let at = Parameter::Texts(all.iter().map(one).collect());
                ("aggregate", vec![("at", at), ("weights", Parameter::Numbers(weights))])
            }
        };
        let parameters = parameters.into_iter().map(|(key, value)| (key.to_owned(), value));
        Handled { handler: op.to_owned(), parameters: parameters.collect::<BTreeMap<_, _>>() }
    }
}

/// A year that shows, how much it counts, and how long what is gone fades there.
#[derive(Clone, Copy)]
struct Shown {
    year: i64,
    weight: f64,
    past: i64,
}

fn after(shown: &[Shown], steps: &[Step]) -> Vec<Shown> {
    let mut shown = shown.to_vec();
    for step in steps {
        let each = |one: &Shown| -> Vec<Shown> {
            match step {
                Step::Set(year) => vec![Shown { year: *year, ..*one }],
                Step::Shift(by) => vec![Shown { year: one.year + by, ..*one }],
                Step::Decade => vec![Shown { year: one.year.div_euclid(10) * 10, ..*one }],
                Step::Ghost(past) => vec![Shown { past: *past, ..*one }],
                Step::Together(all) => {
                    let total: u64 = all.iter().map(|(.., weight)| weight).sum();
                    let of = |(is_later, year, weight): &(bool, i64, u64)| Shown {
                        year: if *is_later { one.year + year } else { *year },
                        weight: one.weight * *weight as f64 / total as f64,
                        ..*one
                    };
                    all.iter().map(of).collect()
                }
            }
        };
        shown = shown.iter().flat_map(each).collect();
    }
    shown
}

/// Days from the start of year 0 to that of another, in the Gregorian calendar.
fn days(year: i64) -> f64 {
    let before = year - 1;
    (365 * year + before.div_euclid(4) - before.div_euclid(100) + before.div_euclid(400)) as f64
}

/// How much of what is there in these years shows.
fn share(years: Years, shown: &[Shown]) -> f64 {
    let [begin, end] = years;
    let of = |one: &Shown| {
        if begin.zip(end).is_some_and(|(begin, end)| end <= begin) || begin.is_some_and(|begin| one.year < begin) {
            return 0.0;
        }
        match end {
            Some(end) if end <= one.year => {
                let left = days(end + one.past) - days(one.year);
                if left > 0.0 { 0.5 * left / (days(end + one.past) - days(end)) } else { 0.0 }
            }
            _ => 1.0,
        }
    };
    // What is whole in all is whole.
    if shown.iter().all(|one| of(one) == 1.0) { 1.0 } else { shown.iter().map(|one| one.weight * of(one)).sum() }
}

/// A time lens: a ball, and its operators.
struct Ball {
    center: DVec3,
    radius: f64,
    steps: Vec<Step>,
}

impl Ball {
    fn lens(&self, number: usize) -> Lens {
        let mut lens = lens(
            &format!("t{number}"),
            [Region::from(Shape::Sphere { center: self.center, radius: self.radius })],
            "sepia",
        );
        lens.effects.clear();
        lens.time = self.steps.iter().map(Step::handled).collect();
        lens
    }
}

/// The panes with these dates.
fn dated(panes: &[Pane], years: &[Years]) -> Studio {
    let path = city(panes);
    let mut text = std::fs::read_to_string(&path).expect("the city");
    for (pane, [begin, end]) in panes.iter().zip(years) {
        let dates = [("yearOfConstruction", begin), ("yearOfDemolition", end)];
        let dates = dates.iter().filter_map(|(key, year)| year.map(|year| format!(r#", "{key}": {year}"#)));
        let own = format!(r#"{{"n": {}}}"#, pane.name);
        let with = format!(r#"{{"n": {}{}}}"#, pane.name, dates.collect::<String>());
        assert_eq!(text.matches(&own).count(), 1);
        text = text.replace(&own, &with);
    }
    std::fs::write(&path, text).expect("a temporary file");
    let made = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

fn years(random: &mut Random) -> Years {
    let begin = random.below(5).min(1) * (1780 + random.below(200));
    let end = random.below(3).min(1) * (1800 + random.below(220));
    [begin, end].map(|year| (year > 0).then_some(year as i64))
}

#[test]
fn layers_are_those_of_all_combinations_in_whole_years() {
    let mut random = Random(44);
    let all = panes(14, &mut random);
    let stacks = stacks(&mut studio_of(&all), &all);
    let (mut halves, mut tried) = (0, 0);
    for round in 0..if is_thorough() { 60 } else { 5 } {
        let dates: Vec<Years> = all.iter().map(|_| years(&mut random)).collect();
        let mut studio = dated(&all, &dates);
        let steps = |random: &mut Random| (0..=random.below(2)).map(|_| Step::new(random)).collect::<Vec<_>>();
        let balls: Vec<Ball> = (0..=random.below(4))
            .map(|_| Ball {
                center: DVec3::new(1.4 * random.share(), 10.0 * random.share(), 10.0 * random.share()),
                radius: 1.0 + 4.0 * random.share(),
                steps: steps(&mut random),
            })
            .collect();
        let mut scene = of_context(vec![]);
        scene.lenses = balls.iter().enumerate().map(|(i, ball)| ball.lens(i)).collect();
        scene.moment = Moment::of_year(1900);
        let own = if round % 2 == 0 { vec![] } else { steps(&mut random) };
        scene.time_steps = own.iter().map(Step::handled).collect();
        scene.city.dating.undated = if round % 3 == 1 { Undated::Ghost } else { Undated::Show };
        let first = after(&[Shown { year: 1900, weight: 1.0, past: 0 }], &own);
        let around = Aabb { min: DVec3::splat(-2e4), max: DVec3::splat(2e4) };
        let view = View::new(camera(), SIZE, &around).expect("a view");
        for backend in BOTH {
            let found = match studio.redraw(&scene, SIZE) {
                Err(error) if error.to_string().contains("combinations") => continue,
                _ => transparency(&mut studio, &scene, backend, SIZE),
            };
            for (pixel, stack) in stacks.iter().enumerate() {
                let (x, y) = (pixel as u32 % SIZE[0], pixel as u32 / SIZE[0]);
                let ray = view.ray([f64::from(x) + 0.5, f64::from(y) + 0.5].into());
                let place = |pane: usize| {
                    let x = all.iter().find(|p| p.name == pane).expect("a pane").x as f64 / 1000.0;
                    ray.origin + ray.direction * ((x - ray.origin.x) / ray.direction.x)
                };
                let off = |pane: usize, ball: &Ball| place(pane).distance(ball.center) - ball.radius;
                if stack.iter().any(|(pane, _)| balls.iter().any(|ball| off(*pane, ball).abs() < 1e-3)) {
                    continue;
                }
                let share_of = |pane: usize| {
                    let at = all.iter().position(|p| p.name == pane).expect("a pane");
                    if dates[at] == [None; 2] && scene.city.dating.undated == Undated::Ghost {
                        return 0.35;
                    }
                    let inside = balls.iter().filter(|ball| off(pane, ball) < 0.0);
                    share(dates[at], &inside.fold(first.clone(), |shown, ball| after(&shown, &ball.steps)))
                };
                let there = stack
                    .iter()
                    .filter(|(pane, _)| share_of(*pane) > 0.0)
                    .take_while(|(pane, _)| share_of(*pane) < 1.0);
                let there: Vec<(usize, [f32; 3])> = there.copied().collect();
                let expected = composited(&there, |_, pane| share_of(pane));
                let error = largest_difference(&[found[pixel]], &[expected]);
                assert!(
                    error < 64.0 * 2_f64.powi(-23),
                    "round {round}, {backend:?}, pixel {x} {y}: {error:e}, {:?} of {expected:?}",
                    found[pixel]
                );
                halves += usize::from(!there.is_empty());
                tried += 1;
            }
        }
    }
    assert!(tried > 10_000 && halves > 1_000, "{halves} of {tried} pixels have something by halves");
}

#[test]
fn both_ends_of_lifetimes_are_half_open_to_the_microsecond() {
    let mut random = Random(31);
    let all = panes(5, &mut random);
    let stacks = stacks(&mut studio_of(&all), &all);
    // Born and gone in one year, and at one instant; open at either end; without a date.
    let dates: Vec<Years> =
        vec![[Some(1900), Some(1901)], [Some(1900), Some(1900)], [None, Some(1900)], [Some(1900), None], [None; 2]];
    let mut studio = dated(&all, &dates);
    let text = |text: &str| Parameter::Text(text.to_owned());
    let ball = Ball { center: DVec3::new(0.2, 5.0, 5.0), radius: 50.0, steps: vec![] };
    for (at, there) in [
        ("1899-12-31T23:59:59.999999", [false, false, true, false, true]),
        ("1900", [true, false, false, true, true]),
        ("1900-12-31T23:59:59.999999", [true, false, false, true, true]),
        ("1901", [false, false, false, true, true]),
    ] {
        let mut of_scene = of_context(vec![]);
        of_scene.moment = veduta::time::Interval::parse(at).expect("a time").begin;
        let mut in_lens = of_context(vec![]);
        in_lens.moment = Moment::of_year(1700);
        let set = Handled { handler: "set".into(), parameters: [("at".to_owned(), text(at))].into() };
        in_lens.lenses = vec![Lens { time: vec![set], ..ball.lens(0) }];
        let expected: Vec<u32> = stacks
            .iter()
            .map(|stack| {
                let seen = stack.iter().find(|(pane, _)| there[*pane]);
                // Ids are counted from 1, in the order of the file.
                seen.map_or(0, |(pane, _)| 1 + all.iter().position(|p| p.name == *pane).expect("a pane") as u32)
            })
            .collect();
        for (scene, backend) in [&of_scene, &in_lens].into_iter().flat_map(|scene| BOTH.map(|backend| (scene, backend)))
        {
            let request = Request { aovs: ALL, backend, ..Request::plain(SIZE) };
            let found = studio.render(scene, &request).expect("a picture").object_id.expect("ids");
            assert!(found == expected, "{at}, {backend:?}, in a lens: {}", !scene.lenses.is_empty());
        }
    }
}

#[test]
fn what_is_there_at_any_of_several_moments_is_whole() {
    let mut random = Random(5);
    let all = panes(4, &mut random);
    let dates: Vec<Years> =
        vec![[Some(1800), Some(1850)], [Some(1900), None], [Some(1860), Some(1870)], [None, Some(1890)]];
    let mut studio = dated(&all, &dates);
    let text = |text: &str| Parameter::Text(text.to_owned());
    let at = Parameter::Texts(vec!["1820".to_owned(), "1950".to_owned()]);
    let parameters = [("at".to_owned(), at), ("show".to_owned(), text("any"))];
    let any = Handled { handler: "aggregate".into(), parameters: parameters.into() };
    let ball = Ball { center: DVec3::new(0.15, 5.0, 5.0), radius: 50.0, steps: vec![] };
    let mut in_lens = of_context(vec![]);
    in_lens.moment = Moment::of_year(1865);
    in_lens.lenses = vec![Lens { time: vec![any.clone()], ..ball.lens(0) }];
    let mut of_scene = of_context(vec![]);
    of_scene.moment = Moment::of_year(1865);
    of_scene.time_steps = vec![any];
    // All but the third, as if it had never been.
    let gone = [rule("eraser", &[], Some(&[2]), false)];
    let mut expected = of_context(gone.to_vec());
    expected.moment = None;
    for backend in BOTH {
        let [one, other, expected] = [&in_lens, &of_scene, &expected].map(|scene| drawn(&mut studio, scene, backend));
        for found in [one, other] {
            assert_eq!((&found.object_id, &found.depth), (&expected.object_id, &expected.depth), "{backend:?}");
            assert!(found.rgba == expected.rgba, "{backend:?}");
        }
    }
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    studio.render(scene, &Request { aovs: ALL, backend, ..Request::plain([240, 200]) }).expect("a picture")
}

#[test]
fn what_will_come_is_drawn_in_outline() {
    let mut random = Random(9);
    let all = panes(6, &mut random);
    // The first is there, the others come one after the other.
    let dates: Vec<Years> = (0..6).map(|i| [Some(1890 + 20 * i), None]).collect();
    let mut studio = dated(&all, &dates);
    let mut scene = of_context(vec![]);
    scene.moment = Moment::of_year(1900);
    for backend in BOTH {
        let plain = drawn(&mut studio, &scene, backend);
        let changed: Vec<usize> = [5, 15, 55, 500]
            .into_iter()
            .map(|future: i64| {
                let mut ahead = scene.clone();
                let step = Parameter::Text(format!("{future} years"));
                ahead.time_steps =
                    vec![Handled { handler: "ghost".into(), parameters: [("future".to_owned(), step)].into() }];
                let found = drawn(&mut studio, &ahead, backend);
                assert_eq!(
                    (&found.object_id, &found.depth),
                    (&plain.object_id, &plain.depth),
                    "{backend:?}: lines are not there yet"
                );
                found.rgba.iter().zip(&plain.rgba).filter(|(a, b)| a != b).count()
            })
            .collect();
        assert!(
            changed[0] == 0 && changed[1] > 50 && changed[2] > changed[1] && changed[3] > changed[2],
            "{backend:?}: {changed:?}"
        );
    }
    // In a lens alone, and where the lens is.
    let ball = Ball { center: DVec3::new(0.2, 3.0, 5.0), radius: 4.0, steps: vec![] };
    let mut inside = scene.clone();
    let step = Parameter::Text("500 years".to_owned());
    let mut lens = ball.lens(0);
    lens.time = vec![Handled { handler: "ghost".into(), parameters: [("future".to_owned(), step)].into() }];
    inside.lenses = vec![lens];
    let [one, other] = BOTH.map(|backend| drawn(&mut studio, &inside, backend));
    assert!(one.rgba == other.rgba, "both back ends draw the same lines");
    let plain = drawn(&mut studio, &scene, Backend::Specialised);
    let is_left = |pixel: &usize| pixel % 240 < 120;
    let changed: Vec<usize> = (0..one.rgba.len()).filter(|&i| one.rgba[i] != plain.rgba[i]).collect();
    let left = changed.iter().filter(|pixel| is_left(pixel)).count();
    assert!(
        changed.len() > 50 && (left * 5 > changed.len() * 4 || left * 5 < changed.len()),
        "{left} of {}",
        changed.len()
    );
}
