//! Objects that move by timetables: what shows of one that enters and leaves time lenses that overlap, place by place, against a reference that
//! asks of each place which moment shows there and where the object is then; and that it costs a draw for each moment, and nothing else.

use glam::{DVec2, DVec3};
use veduta::{
    figure::{self, scene_file},
    geom::Aabb,
    geom::Shape,
    lens::{Handled, Lens, Parameter, Region},
    render::{
        frame::Backend,
        picture::{Request, Studio},
    },
    scene::{CitySpec, Scene},
    time::{Interval, Moment},
    view::View,
};

use crate::{materials::BOTH, panes::rule, studio::*};

const SIZE: [u32; 2] = [160, 60];
const START: &str = "2025-06-01T08:00:00";

/// A pane of 12 by 3 metres, a metre above the ground, with its middle in the origin.
const LENGTH: f64 = 12.0;
const WIDTH: f64 = 3.0;
const ABOVE: f64 = 1.0;

/// Where it is: in a minute along x, to the north and back, turning and growing.
fn keys() -> [(i64, [f64; 3], f64, f64); 4] {
    [
        (0, [0.0, 0.0, 0.0], 0.0, 1.0),
        (20, [25.0, 5.0, 0.0], 30.0, 1.0),
        (40, [55.0, 5.0, 0.5], 30.0, 1.5),
        (60, [80.0, -5.0, 0.5], -50.0, 1.25),
    ]
}

/// The same between them: place, turn in radians, scale.
fn pose(second: f64) -> (DVec3, f64, f64) {
    let keys = keys();
    let at = |i: usize| (keys[i].0 as f64, DVec3::from(keys[i].1), keys[i].2.to_radians(), keys[i].3);
    let after = (0..keys.len()).find(|&i| at(i).0 > second).unwrap_or(keys.len());
    if after == 0 || after == keys.len() {
        let (_, place, turn, scale) = at(after.min(keys.len() - 1));
        return (place, turn, scale);
    }
    let (a, b) = (at(after - 1), at(after));
    let share = (second - a.0) / (b.0 - a.0);
    (a.1.lerp(b.1, share), a.2 + (b.2 - a.2) * share, a.3 + (b.3 - a.3) * share)
}

/// How far a place in plan is within the pane at a second, metres; less than 0: beside it.
fn depth_in_pane(second: f64, place: DVec2) -> f64 {
    let (middle, turn, scale) = pose(second);
    let own = DVec2::from_angle(-turn).rotate(place - middle.truncate()) / scale;
    scale * (0.5 * LENGTH - own.x.abs()).min(0.5 * WIDTH - own.y.abs())
}

/// A tram that is one pane, and its timetable.
fn tram(folder: &Folder) -> Scene {
    let (x, y, z) = (500.0 * LENGTH, 500.0 * WIDTH, 1000.0 * ABOVE);
    let corners = [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]].map(|v| v.map(|n| n as i64));
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}},
            "CityObjects": {{"tram": {{"type": "CityFurniture", "geometry": [{{"type": "MultiSurface", "lod": "2", "boundaries": [[[0, 1, 2, 3]]]}}]}}}},
            "vertices": {corners:?}}}"#
    );
    let mut table = "id,t,x,y,z,yaw,scale\n".to_owned();
    for (second, [x, y, z], yaw, scale) in keys() {
        table += &format!("tram,2025-06-01T08:{:02}:{:02},{x},{y},{z},{yaw},{scale}\n", second / 60, second % 60);
    }
    let city = folder.write("tram.city.json", text);
    let timetable = folder.write("tram.csv", table);
    let camera = orthographic(DVec3::new(40.0, 0.0, 60.0), DVec3::new(40.0, 0.01, 0.0), 40.0);
    let mut scene = scene(camera, vec![]);
    scene.city = CitySpec { files: vec![city], timetables: vec![timetable], ground: false, ..CitySpec::default() };
    // Half of it is seen, so that what is drawn twice is darker.
    scene.style.effects = vec![rule("transparent", &[("opacity", 0.5)], None, false)];
    scene
}

fn at(second: f64) -> Moment {
    let start = Interval::parse(START).expect("a time").begin.expect("a beginning");
    start.shifted(veduta::time::Span::of_micros((second * 1e6) as i64))
}

/// What a lens shows: a second, or so many later; several are together, each as much.
#[derive(Clone)]
enum Step {
    Set(f64),
    Shift(f64),
    Together(Vec<f64>),
}

struct Disc {
    middle: DVec2,
    radius: f64,
    step: Step,
}

impl Disc {
    fn lens(&self, number: usize) -> Lens {
        let shape =
            Shape::Cylinder { center: self.middle.extend(0.0), radius: self.radius, height: 60.0, axis: DVec3::Z };
        let mut lens = lens(&format!("t{number}"), [Region::from(shape)], "sepia");
        lens.effects.clear();
        let text = |text: String| Parameter::Text(text);
        let (op, key, value) = match &self.step {
            Step::Set(second) => ("set", "at", text(at(*second).written())),
            Step::Shift(by) => ("shift", "by", text(format!("{by} s"))),
            Step::Together(all) => {
                ("aggregate", "at", Parameter::Texts(all.iter().map(|by| format!("{by} s")).collect()))
            }
        };
        lens.time = vec![Handled { handler: op.to_owned(), parameters: [(key.to_owned(), value)].into() }];
        lens
    }

    fn holds(&self, place: DVec2) -> f64 {
        self.radius - place.distance(self.middle)
    }

    fn after(&self, seconds: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let each = |(second, weight): &(f64, f64)| match &self.step {
            Step::Set(at) => vec![(*at, *weight)],
            Step::Shift(by) => vec![(second + by, *weight)],
            Step::Together(all) => all.iter().map(|by| (second + by, weight / all.len() as f64)).collect(),
        };
        seconds.iter().flat_map(each).collect()
    }
}

fn through(studio: &mut Studio, scene: &Scene, backend: Backend) -> Vec<f32> {
    crate::panes::transparency(studio, scene, backend, SIZE).iter().map(|texel| texel[3]).collect()
}

/// Compares what is seen through the pane with the reference; how many places have something of it, and how many more than one moment's.
fn compare(studio: &mut Studio, scene: &Scene, discs: &[Disc], second: f64, backend: Backend) -> [usize; 2] {
    let around = Aabb { min: DVec3::splat(-2e4), max: DVec3::splat(2e4) };
    let view = View::new(scene.camera.expect("a camera"), SIZE, &around).expect("a view");
    let (mut covered, mut several) = (0, 0);
    for (pixel, found) in through(studio, scene, backend).into_iter().enumerate() {
        let (x, y) = (pixel as u32 % SIZE[0], pixel as u32 / SIZE[0]);
        let place = view.ray([f64::from(x) + 0.5, f64::from(y) + 0.5].into()).origin.truncate();
        let inside = discs.iter().filter(|disc| disc.holds(place) > 0.0);
        let shown = inside.fold(vec![(second, 1.0)], |shown, disc| disc.after(&shown));
        let is_unsure = discs.iter().any(|disc| disc.holds(place).abs() < 0.02)
            || shown.iter().any(|(second, _)| depth_in_pane(*second, place).abs() < 0.02);
        if is_unsure {
            continue;
        }
        let mut seconds: Vec<f64> = shown.iter().map(|(second, _)| *second).collect();
        seconds.sort_by(f64::total_cmp);
        seconds.dedup();
        let share = |at: &f64| shown.iter().filter(|(second, _)| second == at).map(|(_, weight)| weight).sum::<f64>();
        let there: Vec<f64> = seconds.iter().filter(|at| depth_in_pane(**at, place) > 0.0).map(share).collect();
        let expected: f64 = there.iter().map(|share| 1.0 - 0.5 * share).product();
        let error = (f64::from(found) - expected).abs();
        assert!(
            error < 1e-6,
            "second {second}, {backend:?}, pixel {x} {y} at {place}: {found}, not {expected} of {shown:?}"
        );
        covered += usize::from(!there.is_empty());
        several += usize::from(there.len() > 1);
    }
    [covered, several]
}

#[test]
fn each_place_shows_the_tram_once_where_its_own_moment_has_it() {
    let folder = Folder::new("tram");
    let mut scene = tram(&folder);
    let mut studio = of_scene(&scene);
    // Three lenses that overlap, and the tram goes through all.
    let disc = |x: f64, y: f64, radius: f64, step: Step| Disc { middle: DVec2::new(x, y), radius, step };
    let shifts = [
        disc(22.0, 2.0, 12.0, Step::Shift(4.0)),
        disc(38.0, 6.0, 13.0, Step::Shift(-6.0)),
        disc(32.0, 10.0, 11.0, Step::Set(31.0)),
    ];
    let several = [
        disc(22.0, 2.0, 14.0, Step::Together(vec![0.0, 3.0, -8.0])),
        disc(40.0, 4.0, 16.0, Step::Shift(2.0)),
        disc(60.0, 0.0, 12.0, Step::Together(vec![0.0, -2.0])),
    ];
    for (discs, is_shared) in [(&shifts, false), (&several, true)] {
        scene.lenses = discs.iter().enumerate().map(|(i, disc)| disc.lens(i)).collect();
        let mut seen = [0; 2];
        for second in [-5.0, 0.0, 10.0, 17.5, 22.25, 27.0, 33.5, 41.0, 52.0, 70.0] {
            scene.moment = Some(at(second));
            for backend in BOTH {
                let found = compare(&mut studio, &scene, discs, second, backend);
                seen = [seen[0] + found[0], seen[1] + found[1]];
            }
        }
        assert!(seen[0] > 2000 && is_shared == (seen[1] > 100), "{seen:?}");
    }
}

#[test]
fn what_moves_costs_a_draw_for_each_moment_at_which_it_shows() {
    let folder = Folder::new("tram-draws");
    let mut scene = tram(&folder);
    scene.style.effects.clear();
    let mut studio = of_scene(&scene);
    scene.moment = Some(at(10.0));
    let mut drawn = |scene: &Scene| {
        let request = Request { statistics: true, ..Request::plain(SIZE) };
        let found = studio.render(scene, &request).expect("a picture").statistics;
        let city = found.passes.iter().find(|pass| pass.name == "geometry").expect("the pass that draws the city");
        [u64::from(city.draws), city.triangles]
    };
    let disc = |x: f64, step: Step| Disc { middle: DVec2::new(x, 0.0), radius: 9.0, step };
    let own = drawn(&scene);
    // Where no moment shows it is drawn with all else.
    let timeless = Scene { moment: None, ..scene.clone() };
    let whole = drawn(&timeless);
    assert_eq!(whole, [1, own[1]]);
    // A lens that it does not touch at the moment that shows there.
    scene.lenses = vec![disc(70.0, Step::Shift(0.5)).lens(0)];
    assert_eq!(drawn(&scene), own);
    for (k, by) in [4.0, 14.0, 24.0].into_iter().enumerate() {
        let (middle, ..) = pose(10.0 + by);
        let mut all: Vec<Lens> = scene.lenses.split_off(1);
        all.push(disc(middle.x, Step::Shift(by)).lens(k + 1));
        scene.lenses.extend(all);
        let now = drawn(&scene);
        let more = now[1] - own[1];
        assert_eq!(more, 2 * (k as u64 + 1), "two triangles for each moment: {now:?}, {own:?}");
    }
}

#[test]
fn an_overlay_with_a_moment_leaves_what_shows_beside_it() {
    let folder = Folder::new("tram-overlay");
    let tram = tram(&folder);
    let scene = |time: &str| {
        let text = format!(
            "veduta = 1\n[camera]\neye = [20, -60, 40]\ntarget = [20, 0, 0]\n[[poi]]\nname = \"p\"\nat = [20, 0, 0]\n\
             [[lens]]\nname = \"then\"\nkind = \"best-view\"\npoi = \"p\"\n{time}\n\
             [[lens]]\nname = \"rest\"\nkind = \"best-view\"\npoi = \"p\"\n"
        );
        let mut parsed = scene_file::parse(&text, "s.toml", &Default::default()).unwrap_or_else(|e| panic!("{e}"));
        parsed.city = tram.city.clone();
        parsed.style.effects.clear();
        parsed
    };
    let then = scene("time = [{ op = \"set\", at = \"2025-06-01T08:00:36\" }]");
    let mut studio = of_scene(&then);
    let mut drawn = |scene: &Scene| figure::draw(&mut studio, scene, &Request::plain([400, 240])).expect("a picture");
    let (without, with) = (drawn(&scene("")), drawn(&then));
    // Seen beside one another, one after the other and again: each shows its own.
    let all = [drawn(&then), drawn(&scene("")), drawn(&then)];
    assert!(all[0].rgba == with.rgba && all[1].rgba == without.rgba && all[2].rgba == with.rgba);
    let place = with.overlays.iter().find(|shown| shown.lens == 0).expect("an overlay");
    let is_in = |x: usize, y: usize| {
        (0..2).all(|axis| {
            let at = [x, y][axis] as i32;
            (place.at[axis]..place.at[axis] + place.size[axis] as i32).contains(&at)
        })
    };
    let differing: Vec<bool> =
        (0..400 * 240).filter(|i| with.rgba[*i] != without.rgba[*i]).map(|i| is_in(i % 400, i / 400)).collect();
    assert!(differing.len() > 20 && differing.iter().all(|inside| *inside), "{} differ", differing.len());
}
