use glam::DQuat;
use proptest::prelude::*;

use super::*;
use crate::geom::shape::{OrientedBox, Sphere, definition::Shape};

/// A volume of each kind, about `size` metres large, placed and turned by eight numbers.
fn volume(kind: usize, n: &[f64], size: f64) -> Volume {
    let center = DVec3::new(n[0], n[1], n[2]);
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, n[3], n[4], n[5]);
    let sizes = size * DVec3::new(0.4 + n[6].abs(), 0.4 + n[7].abs(), 0.4 + 0.5 * (n[6] - n[7]).abs());
    let shape = match kind % 7 {
        0 => Shape::Sphere { center, radius: sizes.x },
        1 => Shape::Box { center, size: 2.0 * sizes, rotation: turn },
        2 => Shape::Cylinder { center, radius: sizes.x, height: 2.0 * sizes.y, axis: turn * DVec3::Z },
        3 => Shape::Ellipsoid { center, radii: sizes, rotation: turn },
        4 => Shape::Frustum {
            center,
            radius: sizes.x,
            top_radius: sizes.y,
            height: 2.0 * sizes.z,
            axis: turn * DVec3::Z,
        },
        5 => Shape::Frustum { center, radius: sizes.x, top_radius: 0.0, height: 2.0 * sizes.z, axis: turn * DVec3::Z },
        _ => {
            let points = (0..9).map(|i| {
                let t = f64::from(i) + n[3];
                center + sizes * DVec3::new((t * 1.7).sin(), (t * 2.9).cos(), (t * 0.8).sin())
            });
            Shape::Convex { points: points.collect() }
        }
    };
    shape.volume().expect("a volume")
}

/// The farthest that `p` is outside of any of them: no change of place changes that by more than its length.
fn farthest(volumes: &[Volume], p: DVec3) -> f64 {
    volumes.iter().map(|v| v.signed_distance(p)).fold(f64::NEG_INFINITY, f64::max)
}

/// Whether any of the cells holds a point of all volumes, by halving those that may; `None` where that is not clear down to
/// 1e-7 m or in 100,000 cells. Knows of volumes only their signed distance.
fn searched<C>(
    cells: Vec<C>,
    volumes: &[Volume],
    around: impl Fn(&C) -> (DVec3, f64),
    parts: impl Fn(&C) -> Vec<C>,
) -> Option<bool> {
    let (mut open, mut looked_at, mut is_unclear) = (std::collections::VecDeque::from(cells), 0, false);
    while let Some(cell) = open.pop_front() {
        looked_at += 1;
        let (middle, radius) = around(&cell);
        let beyond = farthest(volumes, middle);
        if beyond < -1e-9 {
            return Some(true);
        }
        if radius < 1e-7 || looked_at > 100_000 {
            is_unclear = true;
            continue;
        }
        if beyond <= radius {
            open.extend(parts(&cell));
        }
    }
    (!is_unclear).then_some(false)
}

fn searched_in_triangle(triangle: [DVec3; 3], volumes: &[Volume]) -> Option<bool> {
    let around = |t: &[DVec3; 3]| {
        let middle = (t[0] + t[1] + t[2]) / 3.0;
        (middle, t.iter().map(|p| p.distance(middle)).fold(0.0, f64::max))
    };
    let parts = |&[a, b, c]: &[DVec3; 3]| {
        let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
        vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    searched(vec![triangle], volumes, around, parts)
}

fn searched_in_box(bounds: Aabb, volumes: &[Volume]) -> Option<bool> {
    let parts = |b: &Aabb| b.corners().map(|c| Aabb { min: c.min(b.center()), max: c.max(b.center()) }).to_vec();
    searched(vec![bounds], volumes, |b| (b.center(), 0.5 * b.size().length()), parts)
}

fn corners(n: &[f64]) -> [DVec3; 3] {
    [0, 3, 6].map(|i| DVec3::new(n[i], n[i + 1], n[i + 2]))
}

proptest! {
    #![proptest_config(crate::seeds::cases(3000))]

    /// One volume: the closed forms say the same as cutting, which knows nothing of them.
    #[test]
    fn cutting_says_what_the_closed_forms_say(
        kind in 0..7_usize, n in prop::collection::vec(-1.0..1.0f64, 8), raw in prop::collection::vec(-8.0..8.0f64, 9),
        far in prop::sample::select(vec![0.0, 447_000.0])
    ) {
        let n: Vec<f64> = n.iter().enumerate().map(|(i, v)| if i < 3 { v + far } else { *v }).collect();
        let volume = volume(kind, &n, 3.0);
        let triangle = corners(&raw).map(|p| p + far);
        let region = CommonPart::common(std::slice::from_ref(&volume)).expect("it is not empty");
        prop_assert_eq!(region.cuts_down(&triangle), volume.meets_triangle(&triangle), "{:?} {:?}", volume, triangle);
    }

    /// Two to four volumes of any kind: what halving the triangle finds.
    #[test]
    fn triangles_that_meet_an_intersection_are_found(
        kinds in prop::collection::vec(0..7_usize, 2..5),
        n in prop::collection::vec(-1.5..1.5f64, 32),
        raw in prop::collection::vec(-6.0..6.0f64, 9),
    ) {
        let volumes: Vec<Volume> = kinds.iter().zip(n.chunks(8)).map(|(k, n)| volume(*k, n, 1.5)).collect();
        let triangle = corners(&raw);
        let region = CommonPart::common(&volumes);
        let meets = region.as_ref().is_some_and(|r| r.meets_triangle(&triangle));
        if let Some(expected) = searched_in_triangle(triangle, &volumes) {
            prop_assert_eq!(meets, expected, "{:?} {:?}", volumes, triangle);
        }
        if let Some(region) = region {
            let bounds = Aabb::from_points(triangle);
            prop_assert!(!meets || region.coverage(&bounds).is_some());
        }
    }

    /// Whether volumes have anything in common: what halving their box finds.
    #[test]
    fn empty_intersections_are_known(
        kinds in prop::collection::vec(0..7_usize, 2..5), n in prop::collection::vec(-1.5..1.5f64, 32), size in 0.4..1.6f64
    ) {
        let volumes: Vec<Volume> = kinds.iter().zip(n.chunks(8)).map(|(k, n)| volume(*k, n, size)).collect();
        let region = CommonPart::common(&volumes);
        if let Some(expected) = searched_in_box(volumes[0].bounds(), &volumes) {
            prop_assert_eq!(region.is_some(), expected, "{:?}", volumes);
        }
        if let Some(region) = region {
            for i in 0..200 {
                let t = f64::from(i);
                let p = 3.0 * DVec3::new((t * 1.3).sin(), (t * 2.1).sin(), (t * 0.7).cos());
                let inside = volumes.iter().all(|v| v.contains(p));
                prop_assert_eq!(region.contains(p), inside);
                prop_assert!(!inside || Aabb { min: p, max: p }.meets(&region.bounds()), "its box holds it");
            }
        }
    }

    /// Boxes that are called outside hold no point of the region, those called inside no other.
    #[test]
    fn boxes_are_told_apart(
        kinds in prop::collection::vec(0..7_usize, 1..4), n in prop::collection::vec(-0.6..0.6f64, 24),
        middle in prop::array::uniform3(-4.0..4.0f64), half in prop::array::uniform3(0.05..2.0f64)
    ) {
        let volumes: Vec<Volume> = kinds.iter().zip(n.chunks(8)).map(|(k, n)| volume(*k, n, 3.0)).collect();
        let Some(region) = CommonPart::common(&volumes) else { return Ok(()) };
        let (middle, half) = (DVec3::from(middle), DVec3::from(half));
        let bounds = Aabb { min: middle - half, max: middle + half };
        match region.coverage(&bounds) {
            None => prop_assert!(searched_in_box(bounds, &volumes) != Some(true), "{volumes:?} meets {bounds:?}"),
            Some(true) => prop_assert!(bounds.corners().iter().all(|c| farthest(&volumes, *c) <= 0.0)),
            Some(false) => {}
        }
        // Far away and deep inside are never left open.
        let away = Aabb { min: bounds.min + 40.0, max: bounds.max + 40.0 };
        prop_assert_eq!(region.coverage(&away), None);
        let depth = -farthest(&volumes, middle);
        if depth > 0.01 {
            let small = 0.3 * depth;
            prop_assert_eq!(region.coverage(&Aabb { min: middle - small, max: middle + small }), Some(true));
        }
    }
}

/// Whether an integer triangle meets the half spaces n · p ≤ d, all in integers: in the triangle's own measure s, t they are
/// half planes, and such a set, bounded by s, t ≥ 0 and s + t ≤ 1, is empty or has a corner where two borders cross.
fn meets_in_integers(triangle: [[i64; 3]; 3], planes: &[([i64; 3], i64)]) -> bool {
    let dot = |a: [i64; 3], b: [i64; 3]| (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).sum::<i128>();
    let along = |k: usize| [0, 1, 2].map(|i| triangle[k][i] - triangle[0][i]);
    // a s + b t ≤ c
    let mut sides: Vec<[i128; 3]> = vec![[-1, 0, 0], [0, -1, 0], [1, 1, 1]];
    sides
        .extend(planes.iter().map(|&(n, d)| [dot(n, along(1)), dot(n, along(2)), i128::from(d) - dot(n, triangle[0])]));
    (0..sides.len()).flat_map(|i| (0..i).map(move |j| (i, j))).any(|(i, j)| {
        let ([a, b, c], [e, f, g]) = (sides[i], sides[j]);
        let whole = a * f - b * e;
        let (s, t) = (c * f - b * g, a * g - c * e);
        let is_behind = |[a, b, c]: &[i128; 3]| (a * s + b * t) * whole.signum() <= c * whole.abs();
        whole != 0 && sides.iter().all(is_behind)
    })
}

#[test]
fn boxes_and_polytopes_are_decided_as_integers_decide() {
    let mut state = 0x9e37_79b9_u64;
    let mut number = |low: i64, high: i64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + ((state >> 33) % (high - low + 1) as u64) as i64
    };
    let (mut met, mut missed, mut spanned, mut empty) = (0, 0, 0, 0);
    for _ in 0..40_000 {
        // Millimetres around a city far from the origin; whole metres, or a millimetre off them: all but touching is common.
        let place = [85_000_000, 447_000_000, 3_000];
        let mut volumes = Vec::new();
        let mut planes: Vec<([i64; 3], i64)> = Vec::new();
        for _ in 0..number(1, 3) {
            let from = [0; 3].map(|_: i64| 1000 * number(-11, -1) + number(-1, 1));
            let to = from.map(|c| c + 1000 * number(4, 14) + number(-1, 1));
            let axis = |i: usize, by: i64| [0, 1, 2].map(|k| if k == i { by } else { 0 });
            let mut own: Vec<([i64; 3], i64)> =
                (0..3).flat_map(|i| [(axis(i, 1), to[i]), (axis(i, -1), -from[i])]).collect();
            // As often as not two corners are cut off.
            if number(0, 1) == 1 {
                let sum: i64 = from.iter().sum();
                own.extend([([1, 1, 1], sum + 16_000), ([-2, -1, 1], -2 * from[0] - from[1] + to[2] - 900)]);
            }
            let world = |(n, d): &([i64; 3], i64)| {
                let d = d + (0..3).map(|i| n[i] * place[i]).sum::<i64>();
                [n[0] as f64, n[1] as f64, n[2] as f64, d as f64 / 1000.0]
            };
            let Ok(volume) = (Shape::Polytope { planes: own.iter().map(world).collect() }).volume() else { continue };
            volumes.push(volume);
            planes.extend(own);
        }
        if volumes.is_empty() {
            continue;
        }
        let triangle = [0; 3].map(|_: i64| [0; 3].map(|_: i64| 1000 * number(-25, 25) + number(-1, 1)));
        let world = triangle.map(|p| DVec3::from([0, 1, 2].map(|i| (p[i] + place[i]) as f64 / 1000.0)));
        // All a million times finer, each plane moved out or in by a unit: between them lies what f64 cannot decide.
        let moved = |by: i64| planes.iter().map(|(n, d)| (*n, d * 1_000_000 + by)).collect::<Vec<_>>();
        let fine = triangle.map(|p| p.map(|c| c * 1_000_000));
        let (surely, perhaps) = (meets_in_integers(fine, &moved(-1)), meets_in_integers(fine, &moved(1)));
        let region = CommonPart::common(&volumes);
        empty += usize::from(region.is_none());
        let meets = region.is_some_and(|r| r.meets_triangle(&world));
        assert!(meets || !surely, "{volumes:?} {world:?}");
        assert!(perhaps || !meets, "{volumes:?} {world:?}");
        let holds = |p: [i64; 3]| planes.iter().all(|(n, d)| (0..3).map(|i| n[i] * p[i]).sum::<i64>() <= *d);
        let meets_edge = |i: usize| meets_in_integers([triangle[i], triangle[(i + 1) % 3], triangle[i]], &planes);
        if surely {
            met += 1;
            spanned += usize::from(!triangle.iter().any(|p| holds(*p)) && !(0..3).any(meets_edge));
        }
        missed += usize::from(!perhaps);
    }
    assert!(met > 4_000 && missed > 4_000 && spanned > 1_000 && empty > 1_000, "{met} {missed} {spanned} {empty}");
}

#[test]
fn touching_volumes_have_a_point_in_common_and_no_volumes_have_none() {
    let ball = |x: f64| Volume::Sphere(Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 1.0 });
    let cube = |x: f64| {
        Volume::Box(OrientedBox { center: DVec3::new(x, 0.0, 0.0), size: 2.0 * DVec3::ONE, rotation: DQuat::IDENTITY })
    };
    let upright = [DVec3::new(1.0, -3.0, -3.0), DVec3::new(1.0, 3.0, -3.0), DVec3::new(1.0, 0.0, 5.0)];
    for (a, b) in [(ball(0.0), ball(2.0)), (cube(0.0), cube(2.0)), (ball(0.0), cube(2.0))] {
        let region = CommonPart::common(&[a.clone(), b.clone()]).expect("one point at least");
        assert!(region.meets_triangle(&upright), "{a:?} {b:?}");
        assert!(!region.meets_triangle(&upright.map(|p| p + DVec3::X * 1e-6)), "{a:?} {b:?}");
    }
    assert!(CommonPart::common(&[ball(0.0), ball(2.000_001)]).is_none());
    assert!(CommonPart::common(&[cube(0.0), cube(2.000_001)]).is_none());
    assert!(CommonPart::common(&[ball(0.0), cube(2.000_001)]).is_none());
    assert!(CommonPart::common(&[]).is_none());
    let nothing = Volume::Sphere(Sphere { center: DVec3::ZERO, radius: 0.0 });
    assert!(
        CommonPart::common(std::slice::from_ref(&nothing)).is_none()
            && CommonPart::common(&[ball(0.0), nothing]).is_none()
    );
}
