//! Against exact clipping: a triangle of small whole coordinates, cut by the planes of the shaft in homogeneous integers.

use super::*;

type V = [i128; 3];
/// x, y, z, w > 0.
type H = [i128; 4];

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

/// The part of a convex polygon where plane · p ≥ 0.
fn clip(polygon: &[H], plane: [i128; 4]) -> Vec<H> {
    let at = |p: &H| p.iter().zip(plane).map(|(a, b)| a * b).sum::<i128>();
    let mut out = Vec::new();
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (dp, dq) = (at(p), at(q));
        if dp >= 0 {
            out.push(*p);
        }
        if dp.signum() * dq.signum() < 0 {
            let cut: H = std::array::from_fn(|k| p[k] * dq.abs() + q[k] * dp.abs());
            let by = cut.iter().fold(0, |g, c| gcd(g, *c));
            out.push(cut.map(|c| c / by));
        }
    }
    out
}

fn sub(a: V, b: V) -> V {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: V, b: V) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// n · (x − p) ≥ 0.
fn through(p: V, n: V) -> [i128; 4] {
    [n[0], n[1], n[2], -dot(n, p)]
}

fn reversed(plane: [i128; 4]) -> [i128; 4] {
    plane.map(|c| -c)
}

/// Whether something of a triangle within all planes is strictly on the inner side of `before`.
fn is_left(t: &[V; 3], planes: &[[i128; 4]], before: [i128; 4]) -> bool {
    let mut polygon: Vec<H> = t.iter().map(|p| [p[0], p[1], p[2], 1]).collect();
    for plane in planes {
        polygon = clip(&polygon, *plane);
    }
    polygon.iter().any(|p| p.iter().zip(before).map(|(a, b)| a * b).sum::<i128>() > 0)
}

/// By definition: for each face that the eye is before, the places from the eye on and before it whose sight line meets it.
fn box_by_clipping(eye: V, [low, high]: [V; 2], t: &[V; 3]) -> bool {
    (0..3).any(|k| {
        let plane = if eye[k] < low[k] { low[k] } else { high[k] };
        if (low[k]..=high[k]).contains(&eye[k]) {
            return false;
        }
        let toward = (plane - eye[k]).signum();
        let h = (plane - eye[k]).abs();
        let mut unit = [0; 3];
        unit[k] = toward;
        let mut planes = vec![through(eye, unit)];
        for j in [(k + 1) % 3, (k + 2) % 3] {
            for (end, sign) in [(low[j], 1), (high[j], -1)] {
                // ± ((x_j − eye_j) h − (end − eye_j) d) ≥ 0, d the depth from the eye.
                let mut n = [0; 3];
                n[j] = sign * h;
                n[k] = -sign * toward * (end - eye[j]);
                planes.push(through(eye, n));
            }
        }
        let mut foot = eye;
        foot[k] = plane;
        is_left(t, &planes, reversed(through(foot, unit)))
    })
}

fn triangle_by_clipping(eye: V, s: [V; 3], t: &[V; 3]) -> bool {
    let n = cross(sub(s[1], s[0]), sub(s[2], s[0]));
    let side = dot(n, sub(eye, s[0])).signum();
    let mut planes = Vec::new();
    for i in 0..3 {
        let (a, b, c) = (s[i], s[(i + 1) % 3], s[(i + 2) % 3]);
        let wall = cross(sub(a, eye), sub(b, eye));
        let inner = dot(wall, sub(c, eye)).signum();
        planes.push(through(eye, wall.map(|c| c * inner)));
    }
    side != 0 && is_left(t, &planes, through(s[0], n.map(|c| c * side)))
}

/// `None` where the three are in line, or the triangle is edge-on to them.
fn segment_by_clipping(eye: V, [a, b]: [V; 2], t: &[V; 3]) -> Option<bool> {
    let n = cross(sub(a, eye), sub(b, eye));
    if n == [0; 3] || t.iter().all(|p| dot(n, sub(*p, eye)) == 0) {
        return None;
    }
    let plane = through(eye, n);
    let planes = [plane, reversed(plane), through(eye, cross(n, sub(a, eye))), through(eye, cross(sub(b, eye), n))];
    Some(is_left(t, &planes, through(a, cross(n, sub(b, a)))))
}

fn real(p: V) -> DVec3 {
    DVec3::from(p.map(|c| c as f64))
}

/// Coordinates of `range` by a plain generator.
struct Dice(u64);

impl Dice {
    fn point(&mut self, range: u64) -> V {
        std::array::from_fn(|_| {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            i128::from((self.0 >> 33) % (2 * range + 1)) - i128::from(range)
        })
    }
}

#[test]
fn box_shafts_are_what_clipping_says() {
    let mut dice = Dice(1);
    let mut found = [0; 2];
    for i in 0..120_000 {
        // Small ranges: flat boxes, points, corners in planes of faces are frequent.
        let range = [2, 3, 5, 40][i % 4];
        let (eye, p, q) = (dice.point(range), dice.point(range), dice.point(range));
        let bounds = [std::array::from_fn(|k| p[k].min(q[k])), std::array::from_fn(|k| p[k].max(q[k]))];
        let t = [dice.point(range), dice.point(range), dice.point(range)];
        let expected = box_by_clipping(eye, bounds, &t);
        let aabb = Aabb { min: real(bounds[0]), max: real(bounds[1]) };
        let shaft = BoxShaft::new(real(eye), &aabb);
        assert_eq!(shaft.meets(&t.map(real)), expected, "{eye:?} {bounds:?} {t:?}");
        let around = Aabb::from_points(t.map(real));
        assert!(!expected || shaft.may_meet(&around), "{eye:?} {bounds:?} {t:?}: a box is lost");
        found[usize::from(expected)] += 1;
    }
    assert!(found.iter().all(|n| *n > 20_000), "{found:?}");
}

#[test]
fn triangle_shafts_are_what_clipping_says() {
    let mut dice = Dice(2);
    let mut found = [0; 2];
    for i in 0..120_000 {
        let range = [2, 3, 5, 40][i % 4];
        let mut point = || dice.point(range);
        let (eye, s, t) = (point(), [point(), point(), point()], [point(), point(), point()]);
        let expected = triangle_by_clipping(eye, s, &t);
        let is_met = TriangleShaft::new(real(eye), s.map(real)).is_some_and(|shaft| shaft.meets(&t.map(real)));
        assert_eq!(is_met, expected, "{eye:?} {s:?} {t:?}");
        found[usize::from(expected)] += 1;
    }
    assert!(found.iter().all(|n| *n > 10_000), "{found:?}");
}

#[test]
fn segment_shafts_are_what_clipping_says() {
    let mut dice = Dice(3);
    let mut found = [0; 2];
    for i in 0..120_000 {
        let range = [2, 3, 5, 40][i % 4];
        let mut point = || dice.point(range);
        let (eye, s, t) = (point(), [point(), point()], [point(), point(), point()]);
        let Some(expected) = segment_by_clipping(eye, s, &t) else { continue };
        let shaft = SegmentShaft::new(real(eye), s.map(real));
        assert_eq!(shaft.meets(&t.map(real)), expected, "{eye:?} {s:?} {t:?}");
        let around = Aabb::from_points(t.map(real));
        assert!(!expected || shaft.may_meet(&around), "{eye:?} {s:?} {t:?}: a box is lost");
        found[usize::from(expected)] += 1;
    }
    assert!(found.iter().all(|n| *n > 10_000), "{found:?}");
}

/// By clipping as well: what is left of the segment in the slabs.
#[test]
fn segments_meet_boxes_as_clipping_says() {
    let mut dice = Dice(4);
    let mut found = [0; 2];
    for i in 0..60_000 {
        let range = [2, 3, 5, 40][i % 4];
        let (a, b, p, q) = (dice.point(range), dice.point(range), dice.point(range), dice.point(range));
        let (low, high): (V, V) = (std::array::from_fn(|k| p[k].min(q[k])), std::array::from_fn(|k| p[k].max(q[k])));
        let mut left: Vec<H> = [a, b].map(|p| [p[0], p[1], p[2], 1]).to_vec();
        for k in 0..3 {
            let mut unit = [0; 3];
            unit[k] = 1;
            left = clip(&clip(&left, through(low, unit)), reversed(through(high, unit)));
        }
        let bounds = Aabb { min: real(low), max: real(high) };
        assert_eq!(segment_meets_box([real(a), real(b)], &bounds), !left.is_empty(), "{a:?} {b:?} {low:?} {high:?}");
        found[usize::from(!left.is_empty())] += 1;
    }
    assert!(found.iter().all(|n| *n > 10_000), "{found:?}");
}

#[test]
fn what_is_beside_the_base_or_behind_is_not_before_it() {
    let eye = DVec3::new(0.0, -10.0, 1.0);
    let house = Aabb { min: DVec3::new(-2.0, 0.0, 0.0), max: DVec3::new(2.0, 4.0, 3.0) };
    let shaft = BoxShaft::new(eye, &house);
    let wall = |x: [f64; 2], y: f64| [DVec3::new(x[0], y, 0.0), DVec3::new(x[1], y, 0.0), DVec3::new(x[0], y, 3.0)];
    assert!(shaft.meets(&wall([-1.0, 1.0], -5.0)), "before it");
    assert!(!shaft.meets(&wall([2.0, 4.0], 0.0)), "a front that goes on beside");
    assert!(!shaft.meets(&wall([-1.0, 1.0], 0.0)), "its own front");
    assert!(!shaft.meets(&wall([-1.0, 1.0], 4.0)) && !shaft.meets(&wall([-1.0, 1.0], 9.0)), "behind");
    assert!(!shaft.meets(&wall([-1.0, 1.0], -10.5)), "behind the eye");
    let ground = [DVec3::new(-90.0, -90.0, 0.0), DVec3::new(90.0, -90.0, 0.0), DVec3::new(0.0, 90.0, 0.0)];
    // From the eye down to the foot of the front, and no further.
    assert!(!shaft.meets(&ground) && shaft.meets(&ground.map(|p| p + 1e-9 * DVec3::Z)));
    let inside = BoxShaft::new(house.center(), &house);
    assert!(!inside.meets(&wall([-1.0, 1.0], 2.0)) && !inside.meets(&ground), "no sight line enters it");
    assert!(!BoxShaft::new(house.min, &house).meets(&ground), "nor from its corner");
}

/// Hard case 12: slivers 1 mm × 1 km, at coordinates of a country; corners behind the eye.
#[test]
fn slivers_are_met_on_the_right_side_of_a_micrometre() {
    let at = DVec3::new(155_000.0, 463_000.0, 0.0);
    let shaft = BoxShaft::new(at, &Aabb { min: at + DVec3::new(99.0, -1.0, -1.0), max: at + DVec3::splat(100.0) });
    for step in 0..200 {
        let y = -1.0e-6 * f64::from(step) - 0.5e-6;
        // Along the lower side of the shaft, half-way: it is met where it reaches above y = -½.
        let x = 49.5;
        let sliver =
            |top: f64| [[x, top, -500.0], [x, top - 0.001, -500.0], [x, top, 500.0]].map(|p| at + DVec3::from(p));
        assert!(shaft.meets(&sliver(-0.5 - y)) && !shaft.meets(&sliver(-0.5 + y)), "{step}");
    }
    let around_eye = [[-1e6, -1e6, 0.1], [1e6, -1e6, 0.1], [0.0, 1e6, 0.1]].map(|p| at + DVec3::from(p));
    assert!(shaft.meets(&around_eye), "it passes above the eye");
    assert!(!shaft.meets(&around_eye.map(|p| p - 2.0 * DVec3::Z)), "and the shaft ends at its base");
}
