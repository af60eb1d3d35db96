use proptest::prelude::*;

use super::*;
use crate::geom::shape::{Volume, definition::Shape};

fn point(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
}

/// A figure, and the triangles that it is made of; those of a disc are many and narrow.
fn figures() -> Vec<(FlatFigure, Vec<[DVec2; 3]>)> {
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let around = |i: i32| 3.0 * DVec2::from_angle(f64::from(i) / 4096.0 * std::f64::consts::TAU);
    let disc = (0..4096).map(|i| [DVec2::ZERO, around(i), around(i + 1)]).collect();
    let arrow = vec![p(0.0, 4.0), p(-3.0, -3.0), p(0.0, -0.5), p(3.0, -3.0)];
    let halves = vec![[arrow[0], arrow[1], arrow[2]], [arrow[2], arrow[3], arrow[0]]];
    // It crosses itself: both wings are in it, though they go round opposite ways.
    let bow = vec![p(-3.0, -2.0), p(3.0, 2.0), p(3.0, -2.0), p(-3.0, 2.0)];
    let wings = vec![[p(0.0, 0.0), bow[1], bow[2]], [p(0.0, 0.0), bow[3], bow[0]]];
    let wide = [p(-2.5, -1.0), p(2.5, -1.0), p(2.5, 1.0), p(-2.5, 1.0)];
    let clockwise = vec![p(-2.0, -2.0), p(-1.0, 3.0), p(4.0, 0.0)];
    vec![
        (FlatFigure::Disc { radius: 3.0 }, disc),
        (FlatFigure::Rectangle { size: p(5.0, 2.0) }, vec![[wide[0], wide[1], wide[2]], [wide[2], wide[3], wide[0]]]),
        (FlatFigure::Polygon { points: arrow }, halves),
        (FlatFigure::Polygon { points: bow }, wings),
        (FlatFigure::Polygon { points: clockwise.clone() }, vec![[clockwise[0], clockwise[1], clockwise[2]]]),
    ]
}

fn flat(center: DVec3, rotation: DQuat, figure: &FlatFigure, sight: Sightlines) -> Volume {
    let shape = Shape::Flat { center, rotation, figure: figure.clone() };
    shape.volumes_seen(&sight).expect("a flat lens").remove(0)
}

/// Whether `p` is seen through a triangle, by the signs of determinants alone.
fn seen_through(sight: Sightlines, [a, b, c]: [DVec3; 3], p: DVec3) -> bool {
    let det = |u: DVec3, v: DVec3, w: DVec3| u.dot(v.cross(w));
    let (u, v, w, away) = match sight {
        Sightlines::From(eye) => (a - eye, b - eye, c - eye, p - eye),
        Sightlines::Along(direction) => (a - p, b - p, c - p, direction),
    };
    let (x, y, z) = (det(u, v, away), det(v, w, away), det(w, u, away));
    let is_within = (x >= 0.0 && y >= 0.0 && z >= 0.0) || (x <= 0.0 && y <= 0.0 && z <= 0.0);
    let normal = (b - a).cross(c - a);
    let direction = if let Sightlines::From(eye) = sight { a - eye } else { away };
    is_within && normal.dot(p - a) * normal.dot(direction) >= 0.0
}

fn sights() -> impl Strategy<Value = Sightlines> {
    prop_oneof![point(12.0).prop_map(Sightlines::From), point(1.0).prop_map(Sightlines::Along)]
}

proptest! {
    #![proptest_config(crate::seeds::cases(256))]

    #[test]
    fn it_holds_what_is_seen_through_its_triangles(sight in sights(), turn in point(3.0), center in point(2.0), p in point(15.0)) {
        let rotation = DQuat::from_scaled_axis(turn);
        for (figure, triangles) in figures() {
            let volume = flat(center, rotation, &figure, sight);
            let corner = |q: DVec2| center + rotation * q.extend(0.0);
            let expected = triangles.iter().any(|t| seen_through(sight, t.map(corner), p));
            // The triangles of the disc leave slivers of 2e-6 m, the farther the eye's lines go the wider.
            let slack = if matches!(figure, FlatFigure::Disc { .. }) { 1e-4 } else { 1e-7 };
            if volume.signed_distance(p).abs() > slack && !volume.is_empty() {
                prop_assert_eq!(volume.contains(p), expected, "{:?} from {:?}", &figure, sight);
            }
        }
    }

    #[test]
    fn sight_lines_enter_at_the_plane_and_never_leave(sight in sights(), turn in point(3.0), through in point(4.0)) {
        for (figure, _) in figures() {
            let volume = flat(DVec3::ZERO, DQuat::from_scaled_axis(turn), &figure, sight);
            let ray = match sight {
                Sightlines::From(eye) => Ray { origin: eye, direction: through - eye },
                Sightlines::Along(direction) => Ray { origin: through, direction },
            };
            let span = volume.entry_exit(&ray);
            if let Some((entry, exit)) = span {
                prop_assert_eq!(exit, f64::INFINITY);
                prop_assert!(volume.signed_distance(ray.at(entry)).abs() < 1e-6 * (1.0 + entry.abs()));
            }
            for i in 1..200 {
                let t = if matches!(sight, Sightlines::From(_)) { f64::from(i) * 0.1 } else { f64::from(i - 100) };
                if volume.signed_distance(ray.at(t)).abs() > 1e-6 {
                    prop_assert_eq!(span.is_some_and(|(entry, _)| entry <= t), volume.contains(ray.at(t)), "{}", t);
                }
            }
        }
    }

    /// The border, in many points: nothing of it is nearer than the distance says, and some of it hardly farther.
    #[test]
    fn distances_are_those_to_the_border(sight in sights(), turn in point(3.0), p in point(9.0)) {
        for (figure, triangles) in figures() {
            let rotation = DQuat::from_scaled_axis(turn);
            let volume = flat(DVec3::ZERO, rotation, &figure, sight);
            if volume.is_empty() {
                continue;
            }
            let distance = volume.signed_distance(p).abs();
            let away = |from: DVec3| match sight {
                Sightlines::From(eye) => from - eye,
                Sightlines::Along(direction) => direction,
            };
            // On the figure, and on the lines that its border throws.
            let corners = match &figure {
                FlatFigure::Disc { radius } => (0..256).map(|i| *radius * DVec2::from_angle(f64::from(i) * 0.0245437)).collect(),
                _ => figure.corners(),
            };
            let mut nearest = f64::INFINITY;
            let mut at = |q: DVec3| nearest = nearest.min(p.distance(q));
            for [a, b] in edges(&corners) {
                for i in 0..=48 {
                    let on = a.lerp(b, f64::from(i) / 48.0);
                    let is_round = matches!(figure, FlatFigure::Disc { .. });
                    let from = rotation * (if is_round { 3.0 * on.normalize_or(DVec2::X) } else { on }).extend(0.0);
                    let line = away(from);
                    at(from + ((p - from).dot(line) / line.length_squared()).max(0.0) * line);
                }
            }
            let own = (rotation.conjugate() * p).truncate();
            let holds = |t: &[DVec2; 3]| winding(t, own) != 0;
            if triangles.iter().any(holds) {
                at(rotation * own.extend(0.0));
            }
            // A wing's inner sides are no edges of the polygon, but cross in its middle.
            prop_assert!(distance <= nearest + 1e-6, "{figure:?} from {sight:?}: {distance}, but {nearest}");
            prop_assert!(distance >= nearest - 0.35 * (1.0 + nearest), "{figure:?} from {sight:?}: {distance} and {nearest}");
        }
    }

    #[test]
    fn a_triangle_meets_it_where_a_point_of_it_is_held(sight in sights(), raw in prop::array::uniform9(-8.0..8.0f64), turn in point(3.0)) {
        let corners = [0, 3, 6].map(|i| DVec3::new(raw[i], raw[i + 1], raw[i + 2]));
        let n = 16;
        let spacing = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f64::max) / f64::from(n);
        for (figure, _) in figures() {
            let volume = flat(DVec3::ZERO, DQuat::from_scaled_axis(turn), &figure, sight);
            if volume.is_empty() {
                continue;
            }
            let (mut is_held, mut least) = (false, f64::INFINITY);
            for i in 0..=n {
                for j in 0..=n - i {
                    let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                    let p = corners[0] + (corners[1] - corners[0]) * s + (corners[2] - corners[0]) * t;
                    is_held |= volume.contains(p) && volume.signed_distance(p) < -1e-9;
                    least = least.min(volume.signed_distance(p));
                }
            }
            let meets = volume.meets_triangle(&corners);
            prop_assert!(meets || !is_held, "{figure:?} from {sight:?} holds a point of {corners:?}");
            prop_assert!(!meets || least < spacing, "{figure:?} from {sight:?} is {least} from {corners:?}");
        }
    }
}

#[test]
fn the_plane_belongs_to_it_and_what_is_before_it_does_not() {
    let square = FlatFigure::Rectangle { size: DVec2::splat(2.0) };
    // Seen from either side.
    for side in [1.0, -1.0] {
        for sight in [Sightlines::From(DVec3::Z * 10.0 * side), Sightlines::Along(DVec3::NEG_Z * side)] {
            let volume = flat(DVec3::ZERO, DQuat::IDENTITY, &square, sight);
            assert!(volume.contains(DVec3::ZERO) && volume.contains(DVec3::new(1.0, 1.0, 0.0)), "{sight:?}");
            assert!(!volume.contains(DVec3::Z * 1e-9 * side) && volume.contains(DVec3::NEG_Z * 1e12 * side));
            assert!(!volume.is_bounded() && volume.bounds().max.min_element() > 1e20);
            let wide = [DVec3::new(-90.0, -90.0, 0.0), DVec3::new(90.0, -90.0, 0.0), DVec3::new(0.0, 120.0, 0.0)];
            for (height, meets) in [(0.0, true), (-5.0, true), (1e-6, false)] {
                assert_eq!(volume.meets_triangle(&wide.map(|p| p + DVec3::Z * height * side)), meets, "{height}");
            }
        }
    }
    let sight = Sightlines::From(DVec3::Z * 10.0);
    let volume = flat(DVec3::ZERO, DQuat::IDENTITY, &square, sight);
    // Twice as far away it is twice as wide; behind the eye there is nothing of it.
    assert!(volume.contains(DVec3::new(1.9, 0.0, -10.0)) && !volume.contains(DVec3::new(2.1, 0.0, -10.0)));
    assert!(!volume.contains(DVec3::Z * 11.0) && !volume.contains(DVec3::Z * 10.0));
    let up = Ray { origin: DVec3::Z * 10.0, direction: DVec3::Z };
    assert_eq!(volume.entry_exit(&up), None);
    assert_eq!(volume.entry_exit(&Ray { direction: DVec3::NEG_Z, ..up }), Some((10.0, f64::INFINITY)));
}

#[test]
fn edge_on_and_without_area_it_holds_nothing() {
    let disc = FlatFigure::Disc { radius: 5.0 };
    let below = DVec3::NEG_Z * 3.0;
    for sight in [
        Sightlines::From(DVec3::new(30.0, 2.0, 0.0)),
        Sightlines::From(DVec3::ZERO),
        Sightlines::From(DVec3::new(1.0, 1.0, 0.0)),
        Sightlines::Along(DVec3::X),
        Sightlines::Along(DVec3::ZERO),
    ] {
        let volume = flat(DVec3::ZERO, DQuat::IDENTITY, &disc, sight);
        assert!(volume.is_empty() && !volume.contains(below) && !volume.contains(DVec3::ZERO), "{sight:?}");
        assert!(volume.signed_distance(below) > 0.0 && volume.signed_distance(DVec3::ZERO) > 0.0, "{sight:?}");
        for direction in [DVec3::X, DVec3::NEG_Z, DVec3::ONE, DVec3::ZERO] {
            assert_eq!(volume.entry_exit(&Ray { origin: DVec3::new(30.0, 2.0, 0.0), direction }), None);
        }
        assert!(!volume.meets_triangle(&[below, below + DVec3::X, below + DVec3::Y]));
    }
    let line = [[0.0, 0.0], [2.0, 1.0], [4.0, 2.0], [1.0, 0.5]].map(DVec2::from).to_vec();
    for figure in [
        FlatFigure::Disc { radius: 0.0 },
        FlatFigure::Rectangle { size: DVec2::new(3.0, 0.0) },
        FlatFigure::Polygon { points: line },
        FlatFigure::Polygon { points: vec![DVec2::ONE; 3] },
    ] {
        let volume = flat(DVec3::ZERO, DQuat::IDENTITY, &figure, Sightlines::From(DVec3::Z * 9.0));
        assert!(volume.is_empty() && !volume.contains(DVec3::ZERO), "{figure:?}");
        assert!(volume.bounding_mesh().triangles.is_empty());
    }
}

#[test]
fn what_is_no_figure_is_refused() {
    let refused = |figure: FlatFigure| {
        let shape = Shape::Flat { center: DVec3::ZERO, rotation: DQuat::IDENTITY, figure };
        shape.check().unwrap_err()
    };
    assert_eq!(refused(FlatFigure::Disc { radius: -1.0 }), ShapeError::Negative("radius", -1.0));
    assert_eq!(refused(FlatFigure::Rectangle { size: DVec2::new(1.0, f64::NAN) }), ShapeError::NotFinite);
    assert_eq!(refused(FlatFigure::Polygon { points: vec![DVec2::ONE; 2] }), ShapeError::FewCorners(2));
    let many = FlatFigure::Polygon { points: vec![DVec2::ONE; MAX_CORNERS + 1] };
    assert_eq!(refused(many), ShapeError::ManyCorners(MAX_CORNERS + 1));
    let without_eye = Shape::Flat { center: DVec3::ZERO, rotation: DQuat::IDENTITY, figure: figures().remove(0).0 };
    assert_eq!(without_eye.volumes().unwrap_err(), ShapeError::NeedsEye);
}
