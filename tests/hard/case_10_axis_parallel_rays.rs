//! Case 10: axis-parallel and zero-direction rays, flat boxes, rays in a slab's plane: no misses. Oracle: the slab test
//! in `i128` fractions.

use glam::DVec3;
use veduta::geom::{Aabb, bvh::Bvh, ray::Ray};

use crate::oracle::Numbers;

/// Whether the half-line meets the closed box, all in integers: per axis the interval of t as fractions.
fn meets(min: [i64; 3], max: [i64; 3], origin: [i64; 3], direction: [i64; 3]) -> bool {
    // t in [near, far], both as numerator / positive denominator.
    let (mut near, mut far) = ((0_i128, 1_i128), (1_i128, 0_i128));
    for i in 0..3 {
        let (low, high, d) = (min[i] - origin[i], max[i] - origin[i], i128::from(direction[i]));
        if d == 0 {
            if low > 0 || high < 0 {
                return false;
            }
            continue;
        }
        let (low, high) = if d > 0 { (low, high) } else { (-high, -low) };
        let (enter, leave) = ((i128::from(low), d.abs()), (i128::from(high), d.abs()));
        if enter.0 * near.1 > near.0 * enter.1 {
            near = enter;
        }
        // far starts at infinity: 1 / 0.
        if far.1 == 0 || leave.0 * far.1 < far.0 * leave.1 {
            far = leave;
        }
    }
    far.1 == 0 || near.0 * far.1 <= far.0 * near.1
}

#[test]
fn no_ray_misses_a_box_it_meets() {
    let mut numbers = Numbers(10);
    let mut met = 0;
    for _ in 0..4_000 {
        // Far from the origin, as cities are; flat on an axis as often as not.
        let min = [85_000, 447_000, -3].map(|c| c + numbers.below(40));
        let max = min.map(|c| c + numbers.below(2) * numbers.below(20));
        let bounds = Aabb { min: DVec3::from(min.map(|c| c as f64)), max: DVec3::from(max.map(|c| c as f64)) };
        let bvh = Bvh::build(&[bounds]);
        for _ in 0..250 {
            let direction = [0; 3].map(|_: i64| numbers.below(2) * (numbers.below(9) - 4));
            let steps = numbers.below(9);
            // Through a point of the box, mostly of its rim; some go just past it.
            let target = [0, 1, 2].map(|i| min[i] + numbers.below((max[i] - min[i] + 2) as u64));
            let origin = [0, 1, 2].map(|i| target[i] - steps * direction[i]);
            if direction == [0; 3] || !meets(min, max, origin, direction) {
                continue;
            }
            met += 1;
            let ray = Ray {
                origin: DVec3::from(origin.map(|c| c as f64)),
                direction: DVec3::from(direction.map(|c| c as f64)),
            };
            let mut found = false;
            bvh.along_ray(&ray, f64::INFINITY, |_, end| {
                found = true;
                end
            });
            assert!(found, "{min:?} {max:?} {origin:?} {direction:?}");
        }
    }
    assert!(met > 200_000, "{met} rays that meet their box");
}
