//! Spheres, and the smallest one around points.

use glam::DVec3;

/// A closed ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle, metres.
    pub center: DVec3,
    /// Metres, ≥ 0.
    pub radius: f64,
}

/// Balls whose radii differ by less than this part are taken for the same.
const SAME: f64 = 1e-12;
/// Rounds at most; a few dozen are the most that cities were seen to need.
const ROUNDS: usize = 1000;

impl Sphere {
    /// The smallest ball around `points`, which are finite; `None` without any. It holds all of them; its radius is the least to a
    /// relative 1e-9.
    ///
    /// The problem is of the kind that Sharir and Welzl (1992) describe: at most four of the points decide. Those are kept; the point
    /// that is farthest from their ball joins them, and of the five at most, the smallest ball around them is found by trying all
    /// subsets (the choice of the farthest is Gärtner's, 1999). Each round the ball grows, so it ends.
    pub fn around(points: &[DVec3]) -> Option<Self> {
        let origin = *points.first()?;
        let mut support = vec![DVec3::ZERO];
        let mut ball = Self { center: DVec3::ZERO, radius: 0.0 };
        for _ in 0..ROUNDS {
            let (far, distance) = farthest(points, origin, ball.center);
            if distance <= ball.radius * (1.0 + SAME) {
                break;
            }
            support.push(far);
            let Some((next, chosen)) = smallest(&support) else { break };
            if next.radius <= ball.radius * (1.0 + SAME) {
                break;
            }
            support = (0..support.len()).filter(|i| chosen >> i & 1 == 1).map(|i| support[i]).collect();
            ball = next;
        }
        let center = origin + ball.center;
        Some(Self { center, radius: points.iter().map(|p| p.distance(center)).fold(0.0, f64::max) })
    }
}

/// The point farthest from `center`, both relative to `origin`, with its distance.
fn farthest(points: &[DVec3], origin: DVec3, center: DVec3) -> (DVec3, f64) {
    let away = |p: &DVec3| (*p - origin).distance_squared(center);
    let far = points.iter().fold((origin, -1.0), |far, p| if away(p) > far.1 { (*p, away(p)) } else { far });
    (far.0 - origin, far.1.max(0.0).sqrt())
}

/// The smallest ball around five points at most, with those that decide, as bits.
fn smallest(points: &[DVec3]) -> Option<(Sphere, u32)> {
    let subsets = (1_u32..1 << points.len()).filter(|set| set.count_ones() <= 4);
    let balls = subsets.filter_map(|set| {
        let chosen: Vec<DVec3> = (0..points.len()).filter(|i| set >> i & 1 == 1).map(|i| points[i]).collect();
        let ball = through(&chosen)?;
        // Room for what solving for a center loses where the points are nearly in a plane or on a line.
        let reach = ball.radius * (1.0 + 1e-10);
        points.iter().all(|p| p.distance(ball.center) <= reach).then_some((ball, set))
    });
    balls.min_by(|a, b| a.0.radius.total_cmp(&b.0.radius))
}

/// The smallest ball with all of up to four points on its border; `None` where they are in a plane or on a line and have none.
fn through(points: &[DVec3]) -> Option<Sphere> {
    let (&base, rest) = points.split_first()?;
    let edges: Vec<DVec3> = rest.iter().map(|p| *p - base).collect();
    // The centre is base + Σ λ_i e_i with e_i · Σ λ_j e_j = ½ |e_i|²: the Gram matrix of the edges, by Cramer's rule.
    let gram = |i: usize, j: usize| edges[i].dot(edges[j]);
    let half = |i: usize| 0.5 * gram(i, i);
    let center = match edges.len() {
        0 => DVec3::ZERO,
        1 => 0.5 * edges[0],
        2 => {
            let det = gram(0, 0) * gram(1, 1) - gram(0, 1) * gram(0, 1);
            let a = half(0) * gram(1, 1) - half(1) * gram(0, 1);
            let b = half(1) * gram(0, 0) - half(0) * gram(0, 1);
            (a * edges[0] + b * edges[1]) / det
        }
        _ => {
            // For three edges the equations themselves, e_i · c = ½ |e_i|².
            let [u, v, w] = [edges[0], edges[1], edges[2]];
            (half(0) * v.cross(w) + half(1) * w.cross(u) + half(2) * u.cross(v)) / u.dot(v.cross(w))
        }
    };
    center.is_finite().then(|| Sphere { center: base + center, radius: center.length() })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geom::aabb::Aabb;

    const FAR: DVec3 = DVec3::new(85_000.0, 447_000.0, 12.0);

    fn is_near(ball: Option<Sphere>, center: [f64; 3], radius: f64) {
        let ball = ball.unwrap();
        assert!(ball.center.distance(FAR + DVec3::from(center)) < 1e-8, "{ball:?}");
        assert!((ball.radius - radius).abs() < 1e-8, "{ball:?}");
    }

    #[test]
    fn few_points_have_the_ball_one_thinks_of() {
        assert_eq!(Sphere::around(&[]), None);
        is_near(Sphere::around(&[FAR]), [0.0; 3], 0.0);
        is_near(Sphere::around(&[FAR; 7]), [0.0; 3], 0.0);
        is_near(Sphere::around(&[FAR, FAR + 4.0 * DVec3::X]), [2.0, 0.0, 0.0], 2.0);
        // An obtuse triangle is held by its longest side, an equilateral one by its circle.
        is_near(Sphere::around(&[FAR, FAR + 6.0 * DVec3::X, FAR + DVec3::new(3.0, 0.5, 0.0)]), [3.0, 0.0, 0.0], 3.0);
        let side = |i: i32| {
            FAR + DVec3::new(
                (f64::from(i) * 2.094_395_102_393_195).cos(),
                0.0,
                (f64::from(i) * 2.094_395_102_393_195).sin(),
            )
        };
        is_near(Sphere::around(&[side(0), side(1), side(2)]), [0.0; 3], 1.0);
        let on_a_line: Vec<DVec3> = (0..50).map(|i| FAR + f64::from(i) * DVec3::new(1.0, 2.0, 2.0)).collect();
        is_near(Sphere::around(&on_a_line), [24.5, 49.0, 49.0], 73.5);
    }

    #[test]
    fn a_box_has_its_diagonal_and_a_regular_tetrahedron_its_circumsphere() {
        let bounds = Aabb { min: FAR, max: FAR + DVec3::new(2.0, 3.0, 6.0) };
        is_near(Sphere::around(&bounds.corners()), [1.0, 1.5, 3.0], 3.5);
        let corner = |x: f64, y: f64, z: f64| FAR + DVec3::new(x, y, z);
        let four = [corner(1.0, 1.0, 1.0), corner(1.0, -1.0, -1.0), corner(-1.0, 1.0, -1.0), corner(-1.0, -1.0, 1.0)];
        is_near(Sphere::around(&four), [0.0; 3], 3.0_f64.sqrt());
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn all_points_are_in_it_and_no_smaller_ball_has_them(points in prop::collection::vec(prop::array::uniform3(-50.0..50.0f64), 1..60)) {
            let points: Vec<DVec3> = points.into_iter().map(|p| FAR + DVec3::from(p)).collect();
            let ball = Sphere::around(&points).unwrap();
            prop_assert!(points.iter().all(|p| p.distance(ball.center) <= ball.radius));
            // Of a smallest ball the middle is in the hull of the points on its border: whichever way it is moved, one of them
            // gets farther away.
            let border: Vec<DVec3> = points.iter().map(|p| *p - ball.center).filter(|p| p.length() >= ball.radius * (1.0 - 1e-9)).collect();
            for i in 0..200 {
                let t = f64::from(i);
                let away = DVec3::new((t * 0.37).sin(), (t * 0.73).cos(), (t * 1.31).sin()).normalize_or(DVec3::Z);
                prop_assert!(border.iter().any(|p| p.dot(away) <= 1e-6 * ball.radius));
            }
        }
    }
}
