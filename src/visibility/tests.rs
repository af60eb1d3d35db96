//! The tests of boxes against other formulations, and how tests are put together.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::{
    city::{
        CityModel, ObjectClass,
        spatial::SpatialIndex,
        test_city::{add, add_box, builder, grid_of_cubes},
    },
    geom::Aabb,
};

/// A city, its units and what finds triangles.
struct Town {
    model: CityModel,
    units: Units,
    index: SpatialIndex,
}

impl Town {
    fn new(model: CityModel) -> Self {
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let (units, index) = (Units::new(&model, &shown), SpatialIndex::build(&model, &shown));
        Self { model, units, index }
    }

    fn grid() -> Self {
        Self::new(grid_of_cubes(12, 12))
    }

    fn ask(&self, eye: DVec3, pois: &[Poi], test: &Test) -> Detected {
        self.ask_with(eye, pois, test, |query, scope| scope.detect(&query))
    }

    fn ask_with<T>(&self, eye: DVec3, pois: &[Poi], test: &Test, then: impl FnOnce(Query, Scope) -> T) -> T {
        let none = Set::new(self.units.len());
        let viewer = Viewer { eye, along: None };
        let query = Query { viewer, pois, test, forced: &none, forbidden: &none, measured: false, margin: None };
        then(query, Scope { model: &self.model, units: &self.units, index: &self.index })
    }

    /// The units whose boxes this holds for.
    fn all_where(&self, holds: impl Fn(&Aabb) -> bool) -> Vec<u32> {
        (0..self.units.len() as u32).filter(|&unit| holds(&self.units.boxes[unit as usize])).collect()
    }
}

fn found(detected: &Detected) -> Vec<u32> {
    detected.occluders.iter().collect()
}

const NOBODY: [u32; 0] = [];

/// Points of a box, corners included, on a grid of seven a side.
fn points(b: &Aabb) -> impl Iterator<Item = DVec3> + '_ {
    let at = |i: usize| DVec3::new((i % 7) as f64, (i / 7 % 7) as f64, (i / 49) as f64) / 6.0;
    (0..343).map(move |i| b.min + b.size() * at(i))
}

fn holds(b: &Aabb, p: DVec3) -> bool {
    (0..3).all(|k| b.min[k] <= p[k] && p[k] <= b.max[k])
}

fn eyes() -> impl Strategy<Value = DVec3> {
    (84_990.0..85_190.0f64, 446_990.0..447_190.0f64, -5.0..40.0f64).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn ups() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        Just(DVec3::Z),
        prop::array::uniform3(-1.0..1.0f64).prop_filter_map("a direction", |v| DVec3::from(v).try_normalize()),
    ]
}

proptest! {
    #![proptest_config(crate::seeds::cases(64))]

    #[test]
    fn near_boxes_are_found_by_every_reference(eye in eyes(), radius in 0.0..90.0f64) {
        let town = Town::grid();
        let of = |reference| found(&town.ask(eye, &[], &Test::Spherical { radius, reference }));
        let corners = |b: &Aabb| b.corners().map(|c| c.distance(eye));
        let centre = |b: &Aabb| b.corners().into_iter().sum::<DVec3>() / 8.0;
        prop_assert_eq!(of(Reference::Centre), town.all_where(|b| holds(b, eye) || centre(b).distance(eye) < radius));
        prop_assert_eq!(of(Reference::AnyCorner), town.all_where(|b| holds(b, eye) || corners(b).iter().any(|d| *d < radius)));
        prop_assert_eq!(of(Reference::AllCorners), town.all_where(|b| holds(b, eye) || corners(b).iter().all(|d| *d < radius)));
        // The nearest point is no further than any of a grid, and nearer than all of them by less than a cell.
        let nearest = of(Reference::Nearest);
        for unit in 0..town.units.len() as u32 {
            let b = &town.units.boxes[unit as usize];
            let least = points(b).map(|p| p.distance(eye)).fold(f64::INFINITY, f64::min);
            let is_found = nearest.contains(&unit);
            prop_assert!(is_found || least >= radius, "{unit} at {least}");
            prop_assert!(!is_found || least < radius + b.size().length() / 6.0, "{unit} at {least}");
        }
    }

    #[test]
    fn what_is_as_high_as_the_viewer_has_corners_on_both_sides(eye in eyes(), up in ups(), radius in 0.0..90.0f64) {
        let town = Town::grid();
        let test = Test::ViewerHeight { radius, reference: Reference::Centre, up };
        let straddles = |b: &Aabb| {
            let sides = b.corners().map(|c| (c - eye).dot(up));
            sides.iter().any(|s| *s >= -1e-9) && sides.iter().any(|s| *s <= 1e-9)
        };
        let expected = town.all_where(|b| holds(b, eye) || (b.center().distance(eye) < radius && straddles(b)));
        prop_assert_eq!(found(&town.ask(eye, &[], &test)), expected);
    }

    #[test]
    fn a_cylinder_is_a_ball_seen_along_its_axis(eye in eyes(), up in ups(), radius in 0.0..90.0f64) {
        let town = Town::grid();
        // Turned so that the axis is upright, plan distances.
        let turn = glam::DQuat::from_rotation_arc(up, DVec3::Z);
        let near = |b: &Aabb| (turn * (b.center() - eye)).truncate().length();
        let is_sure = |unit: &u32| (near(&town.units.boxes[*unit as usize]) - radius).abs() > 1e-9;
        let expected = town.all_where(|b| holds(b, eye) || near(b) < radius);
        let of = found(&town.ask(eye, &[], &Test::Cylindrical { radius, up }));
        let sure = |all: Vec<u32>| all.into_iter().filter(|unit| is_sure(unit)).collect::<Vec<_>>();
        prop_assert_eq!(sure(of), sure(expected));
    }

    #[test]
    fn bases_are_met_in_plan(eye in eyes(), radius in 0.0..90.0f64) {
        let town = Town::grid();
        // A disc meets a rectangle: its middle is in the rectangle grown along one axis, or a corner is in the disc.
        let meets = |b: &Aabb| {
            let grown = |x: f64, y: f64| {
                (b.min.x - x..=b.max.x + x).contains(&eye.x) && (b.min.y - y..=b.max.y + y).contains(&eye.y)
            };
            grown(radius, 0.0) || grown(0.0, radius)
                || b.corners().iter().any(|c| c.truncate().distance(eye.truncate()) <= radius)
        };
        prop_assert_eq!(found(&town.ask(eye, &[], &Test::Ground { radius })), town.all_where(meets));
    }

    #[test]
    fn view_axes_are_followed_through_boxes(eye in eyes(), at in eyes(), object in 0..144u32) {
        let town = Town::grid();
        // What is left of the way within the slabs; the point of interest's own box is left out.
        let is_crossed = |b: &Aabb, to: DVec3| {
            let (mut first, mut last) = (0.0_f64, 1.0_f64);
            for k in 0..3 {
                let (d, from) = (to[k] - eye[k], eye[k]);
                let (a, b) = ((b.min[k] - from) / d, (b.max[k] - from) / d);
                (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
            }
            first <= last
        };
        let middle = town.units.boxes[object as usize].center();
        let expected = town.all_where(|b| holds(b, eye) || is_crossed(b, at) || is_crossed(b, middle));
        let expected: Vec<u32> = expected.into_iter().filter(|unit| *unit != object).collect();
        prop_assert_eq!(found(&town.ask(eye, &[Poi::At(at), Poi::Object(object)], &Test::ViewAxis)), expected);
    }

    /// A margin keeps at least what is found, under `not` too, and something more somewhere.
    #[test]
    fn what_is_found_is_kept(eye in eyes(), object in 0..144u32, kind in 0..7usize, inverted in any::<bool>(), metres in 0.0..8.0f64) {
        let town = Town::grid();
        let up = DVec3::Z;
        let test = [
            Test::Spherical { radius: 40.0, reference: Reference::Nearest },
            Test::Cylindrical { radius: 40.0, up },
            Test::ViewerHeight { radius: 40.0, reference: Reference::Centre, up },
            Test::ViewAxis,
            Test::Ground { radius: 30.0 },
            Test::default(),
            Test::Route { points: vec![DVec3::new(85_012.0, 447_012.0, 1.0), DVec3::new(85_150.0, 447_100.0, 1.0)] },
        ][kind].clone();
        let test = if inverted { Test::Not(Box::new(test)) } else { test };
        town.ask_with(eye, &[Poi::Object(object)], &test, |query, scope| {
            let plain = scope.detect(&query);
            prop_assert_eq!(&plain.occluders, &plain.kept);
            let wide = scope.detect(&Query { margin: Some(Margin { metres }), ..query });
            prop_assert_eq!(&plain.occluders, &wide.occluders);
            prop_assert_eq!(wide.occluders.clone().without(&wide.kept).count(), 0);
            Ok(())
        })?;
    }
}

const STREET: f64 = 1.7;

/// The first row, from the south: cubes of 10 m, 15 m apart, the corner of the first at (85000, 447000).
fn cube(column: i64, row: i64) -> Poi {
    Poi::Object((row * 12 + column) as u32)
}

fn eye(x: f64, y: f64) -> DVec3 {
    DVec3::new(85_000.0 + x, 447_000.0 + y, STREET)
}

#[test]
fn who_stands_between_is_found_and_nobody_else() {
    let town = Town::grid();
    // From before the row, at the third cube of a column.
    let detected = town.ask(eye(5.0, -20.0), &[cube(0, 3)], &Test::default());
    assert_eq!(found(&detected), [0, 12, 24]);
    assert!(detected.list.iter().all(|o| o.why == ["exact"] && o.coverage.is_none() && o.root == o.unit));
    assert_eq!(found(&town.ask(eye(5.0, -20.0), &[cube(0, 0)], &Test::default())), NOBODY, "none before the first");
    let both = town.ask(eye(5.0, -20.0), &[cube(0, 3), cube(0, 1)], &Test::default());
    assert_eq!(found(&both), [0, 24], "points of interest hide nobody");
    // Hard case 22: what is behind the eye is asked for as well.
    let behind = town.ask(eye(5.0, 12.5), &[cube(0, 0), cube(0, 2)], &Test::default());
    assert_eq!(found(&behind), [12]);
}

#[test]
fn an_eye_within_the_box_of_what_it_looks_at_sees_it() {
    let town = Town::grid();
    assert_eq!(found(&town.ask(eye(5.0, 5.0), &[cube(0, 0)], &Test::default())), NOBODY);
    // Within another: it hides what it looks at, and boxes hold the eye.
    for test in [Test::default(), Test::ViewAxis, Test::Ground { radius: 0.0 }] {
        assert!(town.ask(eye(5.0, 5.0), &[cube(3, 3)], &test).occluders.has(0), "{test:?}");
    }
}

#[test]
fn points_and_planes_of_faces_are_decided() {
    let town = Town::grid();
    // Along the fronts of a row, in their plane: they are touched; a hair before them they are not.
    let point = |y: f64| [Poi::At(eye(200.0, y))];
    let all: Vec<u32> = (0..12).collect();
    assert_eq!(found(&town.ask(eye(-20.0, 0.0), &point(0.0), &Test::default())), all);
    let hair = 2.0_f64.powi(-30);
    assert_eq!(found(&town.ask(eye(-20.0, -hair), &point(-hair), &Test::default())), NOBODY);
    assert_eq!(
        found(&town.ask(eye(-20.0, -1.0), &[Poi::At(eye(-20.0, -1.0))], &Test::default())),
        NOBODY,
        "the eye itself"
    );
    // Along axes, down onto a roof and through all of it.
    let above = DVec3::new(85_005.0, 447_005.0, 50.0);
    assert_eq!(found(&town.ask(above, &[Poi::At(above.with_z(10.0))], &Test::default())), NOBODY, "on the roof");
    assert_eq!(found(&town.ask(above, &[Poi::At(above.with_z(9.99))], &Test::default())), [0]);
}

#[test]
fn a_way_is_hidden_where_some_point_of_it_is() {
    let town = Town::grid();
    // In the street behind the first row, seen through its gaps, too.
    let way = |from: f64, to: f64| Test::Route { points: vec![eye(from, 12.5), eye(to, 12.5)] };
    assert_eq!(found(&town.ask(eye(12.5, -20.0), &[], &way(12.5, 13.0))), NOBODY);
    assert_eq!(found(&town.ask(eye(12.5, -20.0), &[], &way(5.0, 13.0))), [0]);
    assert_eq!(found(&town.ask(eye(12.5, -20.0), &[], &way(5.0, 20.0))), [0, 1]);
    assert_eq!(found(&town.ask(eye(12.5, 12.5), &[], &way(5.0, 20.0))), NOBODY, "along itself");
}

#[test]
fn tests_are_put_together_and_explain_themselves() {
    let town = Town::grid();
    let (at, poi) = (eye(5.0, -20.0), [cube(0, 3)]);
    let near = |radius: f64| Test::Spherical { radius, reference: Reference::Centre };
    let not = |test: Test| Test::Not(Box::new(test));
    let why = |test: &Test| -> Vec<(u32, Vec<String>)> {
        town.ask(at, &poi, test).list.into_iter().map(|o| (o.unit, o.why)).collect()
    };
    let words = |words: &[&str]| words.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>();
    let far_away = Test::All(vec![Test::default(), not(near(30.0))]);
    assert_eq!(why(&far_away), [(12, words(&["exact", "not spherical"])), (24, words(&["exact", "not spherical"]))]);
    let either = Test::All(vec![Test::Any(vec![near(26.0), Test::default()]), near(30.0)]);
    assert_eq!(why(&either)[0], (0, words(&["spherical", "exact", "spherical 2"])));
    assert_eq!(found(&town.ask(at, &poi, &not(not(Test::default())))), [0, 12, 24]);
    assert_eq!(town.ask(at, &poi, &not(Test::default())).list.len(), 144 - 4, "all but three, and what is looked at");
    let forced = Set::of(&(0..144).map(|i| i == 36 || i == 100).collect::<Vec<_>>());
    let forbidden = Set::of(&(0..144).map(|i| i == 12 || i == 0).collect::<Vec<_>>());
    town.ask_with(at, &poi, &Test::default(), |query, scope| {
        let detected = scope.detect(&Query { forced: &forced, ..query });
        assert_eq!(found(&detected), [0, 12, 24, 100], "but what is looked at");
        assert_eq!(detected.list[3].why, ["forced"]);
        let all = Set::new(144).complement();
        assert_eq!(found(&scope.detect(&Query { forced: &all, forbidden: &forbidden, ..query })).len(), 141);
    });
}

#[test]
fn shares_are_what_shadows_are() {
    // A wall that covers the lower half of a wall as wide, seen from the ground: half of its rays but for perspective.
    let mut builder = builder();
    add_box(&mut builder, "wall", [-100_000, 200_000, 0], [100_000, 200_001, 100_000]);
    add_box(&mut builder, "low", [-100_000, 100_000, 0], [100_000, 100_001, 25_000]);
    add_box(&mut builder, "left", [-100_000, 150_000, 0], [0, 150_001, 90_000]);
    let town = Town::new(builder.finish());
    let at = DVec3::new(85_000.0, 447_000.0, 0.0);
    let test = |coverage: f64| Test::Exact { coverage, rays: 4096 };
    let shares = |coverage: f64| -> Vec<(u32, Coverage)> {
        let list = town.ask(at, &[Poi::Object(0)], &test(coverage)).list;
        list.into_iter().map(|o| (o.unit, o.coverage.expect("a share"))).collect()
    };
    // By solid angle of rectangles that touch the foot of the eye: a right-angled formula (Van Oosterom).
    let rectangle = |w: f64, h: f64, d: f64| (w * h / (d * (w * w + h * h + d * d).sqrt())).atan();
    let whole = rectangle(100.0, 100.0, 200.0);
    let low = rectangle(100.0, 50.0, 200.0) / whole;
    let left = 0.5;
    let found = shares(0.01);
    for ((unit, share), (expected_unit, expected)) in found.iter().zip([(1, low), (2, left)]) {
        assert_eq!(*unit, expected_unit);
        assert!(share.low - 0.01 < expected && expected < share.high + 0.01, "{share:?} is not {expected}");
    }
    assert_eq!(shares(0.52).iter().map(|s| s.0).collect::<Vec<_>>(), [1]);
    assert_eq!(shares(0.8), []);
    assert_eq!(town.ask(at, &[Poi::Object(0)], &Test::default()).list.len(), 2);
}

#[test]
fn parts_stand_for_their_whole_and_ground_never_hides() {
    let mut builder = builder();
    let hall = add_box(&mut builder, "hall", [0, 0, 0], [10_000, 10_000, 10_000]);
    let tower = add_box(&mut builder, "tower", [10_000, 0, 0], [14_000, 4_000, 30_000]);
    let house = add_box(&mut builder, "house", [0, 30_000, 0], [10_000, 40_000, 10_000]);
    let quad = |y: i64| vec![[-90_000, y, 0], [90_000, y, 0], [90_000, y, 20_000], [-90_000, y, 20_000]];
    let face = [vec![0, 1, 2, 3]];
    for (i, class) in
        [ObjectClass::Terrain, ObjectClass::Road, ObjectClass::Water, ObjectClass::Land].into_iter().enumerate()
    {
        add(&mut builder, &format!("ground-{i}"), class, None, quad(20_000 + i as i64), &face);
    }
    let wall = add(&mut builder, "wall", ObjectClass::Other, None, quad(25_000), &face);
    let mut model = builder.finish();
    let group = model.strings.intern("CityObjectGroup");
    model.objects[tower as usize].parents = vec![hall];
    model.objects[hall as usize].children = vec![tower];
    let town = Town::new(model.clone());
    assert_eq!(town.units.of_object[hall as usize], town.units.of_object[tower as usize]);
    let at = DVec3::new(85_012.0, 446_990.0, 25.0);
    let roots = |town: &Town| -> Vec<u32> {
        let list = town.ask(at, &[Poi::Object(house)], &Test::default()).list;
        list.into_iter().map(|o| o.root).collect()
    };
    assert_eq!(roots(&town), [hall, wall], "the tower is the hall's, and ground is none");
    let detected = town.ask(at, &[Poi::Object(house)], &Test::default());
    let objects = town.units.objects_of(&town.model, &detected.occluders);
    assert_eq!(objects, [true, true, false, false, false, false, false, true]);
    let of_tower = town.ask(eye(5.0, 20.0).with_z(5.0), &[Poi::Object(tower)], &Test::default());
    assert_eq!(of_tower.list, [], "a part does not hide its whole");
    // A member of a group stands for itself.
    model.objects[hall as usize].kind = group;
    assert_eq!(roots(&Town::new(model)), [tower, wall]);
}

#[test]
fn within_the_box_faces_decide() {
    // An L of two wings; a kiosk in its yard, before the wing that closes it, and one behind the other wing.
    let mut builder = builder();
    let wings = add_box(&mut builder, "north", [0, 30_000, 0], [40_000, 40_000, 10_000]);
    let other = add_box(&mut builder, "west", [0, 0, 0], [10_000, 30_000, 10_000]);
    let kiosk = add_box(&mut builder, "kiosk", [25_000, 15_000, 0], [28_000, 18_000, 3_000]);
    let mut model = builder.finish();
    model.objects[other as usize].parents = vec![wings];
    model.objects[wings as usize].children = vec![other];
    let town = Town::new(model);
    let ask = |x: f64, y: f64| found(&town.ask(eye(x, y), &[Poi::Object(wings)], &Test::default()));
    let kiosk = town.units.of_object[kiosk as usize];
    assert_eq!(ask(26.0, -20.0), [kiosk], "before the north wing");
    assert_eq!(ask(-30.0, 16.0), NOBODY, "behind the west wing, from where no face is beyond it");
}

#[test]
fn parallel_sight_lines_are_parallel() {
    let town = Town::grid();
    // From the south, level: columns hide columns, whatever the eye's place across.
    let none = Set::new(144);
    let pois = [cube(4, 3)];
    let test = Test::default();
    let viewer = Viewer { eye: eye(500.0, -300.0), along: Some(DVec3::Y) };
    let query =
        Query { viewer, pois: &pois, test: &test, forced: &none, forbidden: &none, measured: false, margin: None };
    let scope = Scope { model: &town.model, units: &town.units, index: &town.index };
    assert_eq!(found(&scope.detect(&query)), [4, 16, 28]);
    assert_eq!(found(&scope.detect(&Query { test: &Test::ViewAxis, ..query })), [4, 16, 28]);
}
