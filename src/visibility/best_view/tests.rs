//! Best views whose answer is known by thought, and ratings against all triangles.

use super::*;
use crate::{
    city::{
        ObjectClass,
        build::{ModelBuilder, RawObject},
        test_city::{add, add_box, builder},
    },
    geom::ray::TriangleTest,
};

/// Narrow enough that sight lines are nearly parallel.
const FROM_FAR: Field = Field { fov_y: 0.03, aspect: 1.0 };

/// A city, all of which is shown.
struct Town {
    model: CityModel,
    shown: Vec<u32>,
    index: SpatialIndex,
}

impl Town {
    fn new(city: ModelBuilder) -> Self {
        let model = city.finish();
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let index = SpatialIndex::build(&model, &shown);
        Self { model, shown, index }
    }

    fn subject(&self, id: &str) -> Subject<'_> {
        let object = self.model.find_object(id).unwrap();
        Subject::new(&self.model, &self.shown, &self.index, object).unwrap()
    }

    fn views(&self, id: &str, field: &Field) -> Vec<BestView> {
        let object = self.model.find_object(id).unwrap();
        let views = best_views(&self.model, &self.shown, &self.index, object, field).unwrap();
        assert!((1..=MOST_VIEWS).contains(&views.len()));
        for (i, view) in views.iter().enumerate() {
            let others = views[..i].iter().map(|other| other.framing.normal.angle_between(view.framing.normal));
            assert!(others.into_iter().all(|angle| angle >= APART - 1e-6), "two views of one direction");
            assert!(view.score <= views[0].score / (1.0 - 0.02), "best first, but for ties");
        }
        views
    }
}

/// Boxes (millimetres), each turned about the origin by quarters of a turn.
fn boxes(all: &[(&str, [i64; 3], [i64; 3])], quarters: usize) -> Town {
    let mut city = builder();
    for (id, min, max) in all {
        let turned = |p: [i64; 3]| (0..quarters).fold(p, |[x, y, z], _| [-y, x, z]);
        let (a, b) = (turned(*min), turned(*max));
        add_box(&mut city, id, [0, 1, 2].map(|k| a[k].min(b[k])), [0, 1, 2].map(|k| a[k].max(b[k])));
    }
    Town::new(city)
}

fn azimuth_deg(view: &BestView) -> f64 {
    view.framing.normal.x.atan2(view.framing.normal.y).to_degrees().rem_euclid(360.0)
}

fn elevation_deg(view: &BestView) -> f64 {
    view.framing.normal.z.asin().to_degrees()
}

const HOUSE: (&str, [i64; 3], [i64; 3]) = ("house", [0, 0, 0], [10_000, 20_000, 6_000]);

/// The facade of the house alone, seen from far: as large as it appears, (120, 60, ½·200) across the axes.
fn facade_of_house(n: DVec3) -> f64 {
    (120.0 * n.x.abs() + 60.0 * n.y.abs() + 100.0 * n.z.max(0.0)) / (2.0 * 180.0 + 100.0)
}

#[test]
fn of_sides_that_show_as_much_the_sunlit_one_is_taken() {
    let town = boxes(&[HOUSE], 0);
    for (east, north) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        let sun = DVec3::new(east, north, 1.0).normalize_or(DVec3::Z);
        let views = town.subject("house").lit_from(sun).best_views(&FROM_FAR, 1).unwrap();
        let normal = views[0].framing.normal;
        assert!(normal.x * east > 0.0 && normal.y * north > 0.0, "{sun}: {normal}");
        assert!(views[0].seen.lit > 0.9);
        // By night it is as without one.
        let dark = town.subject("house").lit_from(-sun).best_views(&FROM_FAR, 1).unwrap();
        assert_eq!(dark, town.subject("house").best_views(&FROM_FAR, 1).unwrap());
    }
    // Light is no reason to look at what is hidden: a wall before the sunlit side leaves the other.
    let screen = ("screen", [-30_000, -8_000, 0], [60_000, -2_000, 30_000]);
    let hidden = boxes(&[HOUSE, screen], 0);
    let south = DVec3::new(0.1, -1.0, 0.4).normalize_or(DVec3::Z);
    let views = hidden.subject("house").lit_from(south).best_views(&FROM_FAR, 1).unwrap();
    assert!(views[0].framing.normal.y > 0.0, "{}", views[0].framing.normal);
}

#[test]
fn a_box_alone_is_best_seen_over_its_corners() {
    let town = boxes(&[HOUSE], 0);
    let views = town.views("house", &FROM_FAR);
    // The best of a dense search over the first quarter of directions.
    let degrees = |a: f64, e: f64| {
        let ((sin, cos), (up, out)) = (a.to_radians().sin_cos(), e.to_radians().sin_cos());
        DVec3::new(out * sin, out * cos, up)
    };
    let all = (0..900).flat_map(|a| (0..900).map(move |e| degrees(0.1 * f64::from(a), 0.1 * f64::from(e))));
    let worth = |n: &DVec3| facade_of_house(*n) * upright(n.z.asin());
    let best = all.max_by(|a, b| worth(a).total_cmp(&worth(b))).unwrap();
    let off = views[0].framing.normal.angle_between(best).to_degrees();
    assert!(off < 6.0, "{off}° off {best}: {:?}", views[0].framing.normal);
    // One over each corner, all as good: by azimuth.
    let azimuths: Vec<f64> = views.iter().map(azimuth_deg).collect();
    assert_eq!(views.len(), 4, "{azimuths:?}");
    assert!(azimuths.is_sorted(), "{azimuths:?}");
    for (view, quarter) in views.iter().zip([0.0, 90.0, 180.0, 270.0]) {
        assert!((quarter..quarter + 90.0).contains(&azimuth_deg(view)), "{azimuths:?}");
        // Two walls and the roof of four and the roof; what looks down is no facade.
        assert!((view.seen.visible - 380.0 / 560.0).abs() < 0.005, "{:?}", view.seen);
        assert_eq!(view.seen.unoccluded, 1.0);
        assert_eq!(view.framing.up, DVec3::Z);
    }
}

#[test]
fn samples_tell_what_is_seen_of_a_box_to_a_hundredth() {
    let town = boxes(&[HOUSE], 0);
    let subject = town.subject("house");
    for i in 0..300 {
        let t = f64::from(i);
        let n = DVec3::new((t * 0.37).sin(), (t * 0.73).cos(), (t * 1.31).sin().abs()).normalize_or(DVec3::Z);
        let seen = subject.view_along(n, &FROM_FAR, None).unwrap().seen;
        assert!((seen.facade - facade_of_house(n)).abs() < 0.01, "{n}: {seen:?} {}", facade_of_house(n));
    }
}

#[test]
fn a_wall_in_front_turns_the_view_away() {
    let house = ("house", [-5_000, -5_000, 0], [5_000, 5_000, 10_000]);
    for (quarters, away) in [DVec3::Y, -DVec3::X, -DVec3::Y, DVec3::X].into_iter().enumerate() {
        let wall = ("wall", [-30_000, -9_000, 0], [30_000, -8_000, 40_000]);
        let view = boxes(&[house, wall], quarters).views("house", &FROM_FAR)[0];
        assert!(view.framing.normal.dot(away) > 0.3, "{quarters}: {:?}", view.framing.normal);
        assert_eq!(view.seen.unoccluded, 1.0, "{quarters}");
        assert!(view.seen.visible > 0.55, "{quarters}: {:?}", view.seen);
    }
}

#[test]
fn a_tower_in_a_court_is_seen_over_its_roofs() {
    let court = [
        ("tower", [-3_000, -3_000, 0], [3_000, 3_000, 20_000]),
        ("south", [-20_000, -20_000, 0], [20_000, -10_000, 14_000]),
        ("north", [-20_000, 10_000, 0], [20_000, 20_000, 14_000]),
        ("west", [-20_000, -10_000, 0], [-10_000, 10_000, 14_000]),
        ("east", [10_000, -10_000, 0], [20_000, 10_000, 14_000]),
    ];
    let town = boxes(&court, 0);
    let best = town.views("tower", &FROM_FAR)[0];
    let level = town.subject("tower").view_along(DVec3::new(1.0, 1.0, 0.0), &FROM_FAR, None).unwrap();
    // Level, what is higher than the roofs is seen: 6 of 20 m of two walls of four, and nothing of a roof of 36 m² beside 480.
    assert!((level.seen.unoccluded - 0.3).abs() < 0.02, "{level:?}");
    assert!((level.seen.visible - 0.3 * 240.0 / 516.0).abs() < 0.02, "{level:?}");
    assert!(elevation_deg(&best) > 15.0 && best.seen.visible > 1.5 * level.seen.visible, "{best:?}");
    assert!(best.score > level.score);
}

#[test]
fn what_is_seen_through_one_gap_is_seen() {
    // Under a roof and behind walls of 60 m, but for a gap 25° from south: between the rows that are rated first.
    let around = [
        ("house", [-4_000, -4_000, 0], [4_000, 4_000, 8_000]),
        ("roof", [-45_000, -45_000, 60_000], [45_000, 45_000, 61_000]),
        ("north", [-45_000, 40_000, 0], [45_000, 45_000, 60_000]),
        ("west", [-45_000, -45_000, 0], [-40_000, 45_000, 60_000]),
        ("east", [40_000, -45_000, 0], [45_000, 45_000, 60_000]),
        ("south-west", [-45_000, -45_000, 0], [-24_000, -40_000, 60_000]),
        ("south-east", [-14_000, -45_000, 0], [45_000, -40_000, 60_000]),
    ];
    for quarters in 0..4 {
        let best = boxes(&around, quarters).views("house", &FROM_FAR)[0];
        let wanted = (205.0 - 90.0 * quarters as f64).rem_euclid(360.0);
        assert!((azimuth_deg(&best) - wanted).abs() < 3.0, "{quarters}: {best:?}");
        assert!(best.seen.visible > 0.2 && best.seen.unoccluded > 0.7, "{quarters}: {best:?}");
    }
}

#[test]
fn the_first_view_is_as_good_as_the_best_of_all_directions_but_for_a_tie() {
    // Houses of many heights, on a street grid with gaps of a few metres.
    let number = |i: i64, by: i64| (i * by).rem_euclid(1009);
    let house = |i: i64| {
        let (x, y) = (14_000 * (i % 7), 17_000 * (i / 7));
        let (w, d, h) =
            (7_000 + 6 * number(i + 3, 389), 9_000 + 6 * number(i + 5, 577), 4_000 + 24 * number(i + 7, 743));
        (format!("{i}"), [x, y, 0], [x + w, y + d, h])
    };
    let houses: Vec<(String, [i64; 3], [i64; 3])> = (0..49).map(house).collect();
    let named: Vec<(&str, [i64; 3], [i64; 3])> =
        houses.iter().map(|(id, min, max)| (id.as_str(), *min, *max)).collect();
    let town = boxes(&named, 0);
    let best = search::best_of_all(&town.subject("24"), &Field::default());
    let found = town.views("24", &Field::default())[0].score;
    assert!(found >= best * (1.0 - 0.02) && found <= best, "{found} of {best}");
}

#[test]
fn a_city_that_turns_takes_its_views_along() {
    let city = [
        ("house", [-6_000, -9_000, 0], [6_000, 9_000, 8_000]),
        ("low", [-4_000, 12_000, 0], [9_000, 16_000, 5_000]),
        ("high", [11_000, -20_000, 0], [16_000, 20_000, 25_000]),
        ("side", [-30_000, -15_000, 0], [-20_000, 2_000, 12_000]),
    ];
    let before = boxes(&city, 0).views("house", &Field::default())[0];
    for quarters in 1..4 {
        let all = boxes(&city, quarters).views("house", &Field::default());
        let turned = (0..quarters).fold(before.framing.normal, |n, _| DVec3::new(-n.y, n.x, n.z));
        let off = |view: &BestView| view.framing.normal.angle_between(turned).to_degrees();
        // It is the best again, but for ties, which go by azimuth and do not turn.
        let after = all.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        assert!(after.score >= 0.97 * all[0].score, "{quarters}: {after:?}");
        // Faces may be cut into other triangles, and samples stand elsewhere: a step of the lattice in azimuth and in elevation, 5° each.
        assert!(off(after) < 7.1, "{quarters}: {}°", off(after));
        assert!((after.score - before.score).abs() < 0.02 * before.score, "{quarters}");
        assert!((after.seen.visible - before.seen.visible).abs() < 0.03, "{quarters}");
    }
}

#[test]
fn a_square_is_seen_obliquely_from_above() {
    let mut city = builder();
    let corners = vec![[0, 0, 0], [40_000, 0, 0], [40_000, 40_000, 0], [0, 40_000, 0]];
    add(&mut city, "square", ObjectClass::Road, None, corners, &[vec![0, 1, 2, 3]]);
    let view = Town::new(city).views("square", &Field::default())[0];
    assert!((35.0..=65.0).contains(&elevation_deg(&view)), "{view:?}");
    assert_eq!((view.seen.visible, view.seen.unoccluded), (1.0, 1.0));
}

#[test]
fn what_has_no_faces_has_no_views() {
    let mut city = builder();
    add_box(&mut city, "house", [0, 0, 0], [5_000, 5_000, 5_000]);
    city.add_object(RawObject { id: "idea".to_owned(), ..RawObject::default() });
    let town = Town::new(city);
    let object = town.model.find_object("idea").unwrap();
    let refused = best_views(&town.model, &town.shown, &town.index, object, &Field::default()).unwrap_err();
    assert_eq!(refused, NoView::NoFaces("idea".to_owned()));
    // Nor has what has faces that are not shown.
    let refused = best_views(&town.model, &[], &town.index, 0, &Field::default()).unwrap_err();
    assert_eq!(refused, NoView::NoFaces("house".to_owned()));
    let narrow = Field { fov_y: 0.0, aspect: 1.0 };
    assert!(matches!(town.subject("house").best_views(&narrow, 1), Err(NoView::Framing(_))));
}

#[test]
fn what_is_in_another_has_the_views_it_would_have_alone() {
    let town = boxes(&[HOUSE, ("hall", [-20_000, -20_000, -1_000], [40_000, 40_000, 30_000])], 0);
    let views = town.views("house", &FROM_FAR);
    let alone = boxes(&[HOUSE], 0).views("house", &FROM_FAR);
    assert_eq!(views.len(), alone.len());
    for (view, alone) in views.iter().zip(&alone) {
        assert_eq!((view.seen.visible, view.seen.unoccluded, view.seen.facade), (0.0, 0.0, 0.0));
        assert_eq!((view.framing, view.score), (alone.framing, alone.score));
        assert_eq!(view.seen.facade_alone, alone.seen.facade_alone);
    }
}

#[test]
fn a_given_direction_has_the_score_it_would_be_listed_with() {
    let town = Town::new(builder_of_streets());
    for view in town.views("3-3", &Field::default()) {
        let again = town.subject("3-3").view_along(view.framing.normal, &Field::default(), None).unwrap();
        assert!((again.score - view.score).abs() < 1e-3, "{again:?} {view:?}");
        assert!((again.seen.facade - view.seen.facade).abs() < 1e-3);
    }
    let above = town.subject("3-3").view_along(DVec3::Z, &Field::default(), Some([DVec3::X, DVec3::Z])).unwrap();
    assert_eq!(above.framing.up, DVec3::X, "what is ahead is up");
    assert!(above.seen.facade > 0.0 && above.score > 0.0);
}

/// Seven rows of seven houses of many heights.
fn builder_of_streets() -> ModelBuilder {
    let mut city = builder();
    for (x, y) in (0..7).flat_map(|y| (0..7).map(move |x| (x, y))) {
        let min = [15_000 * x, 15_000 * y, 0];
        let height = 4_000 + 2_500 * ((3 * x + 5 * y) % 7);
        add_box(&mut city, &format!("{x}-{y}"), min, [min[0] + 10_000, min[1] + 10_000, height]);
    }
    city
}

#[test]
fn sight_lines_are_what_brute_force_over_all_triangles_says() {
    let town = Town::new(builder_of_streets());
    let subject = town.subject("3-3");
    let model = &town.model;
    let mut triangles = Vec::new();
    for tile in &model.tiles {
        let object = model.geometries[tile.geometry as usize].object;
        for t in tile.indices.start / 3..tile.indices.end / 3 {
            let corner = |k: u32| model.position(tile, tile.vertices.start + model.indices[(3 * t + k) as usize]);
            triangles.push((object, t, [corner(0), corner(1), corner(2)]));
        }
    }
    let own = model.find_object("3-3").unwrap();
    for (i, n) in [DVec3::new(1.0, 0.3, 0.2), DVec3::new(-0.4, -1.0, 0.9), DVec3::Z, DVec3::X].into_iter().enumerate() {
        let framing = Framing::new(&subject.ball, n, &Field::default(), None).unwrap();
        let mut visible = 0;
        for sample in &subject.facades.samples {
            let ray = Ray { origin: framing.eye, direction: sample.at - framing.eye };
            let test = TriangleTest::new(&ray).unwrap();
            let end = 1.0 - SKIN_M / ray.direction.length();
            let before = |&(object, triangle, corners): &(u32, u32, [DVec3; 3])| {
                (object != own || triangle != sample.triangle) && test.hit(corners).is_some_and(|t| t <= end)
            };
            visible += u32::from(!triangles.iter().any(before));
        }
        let seen = subject.seen(framing.eye);
        assert_eq!(seen.visible, f64::from(visible) / SAMPLES as f64, "{i}");
        assert!(visible > 0 || i == 3, "{i}: nothing is seen");
    }
}

#[test]
fn upright_views_are_liked_best() {
    assert_eq!([0.0, 0.3, -0.3].map(upright), [1.0; 3]);
    assert_eq!(upright(std::f64::consts::FRAC_PI_2), 0.5);
    assert!((upright(60_f64.to_radians()) - 0.75).abs() < 1e-12, "half way between");
    let all: Vec<f64> = (0..=90).map(|e| -upright(f64::from(e).to_radians())).collect();
    assert!(all.is_sorted());
}
