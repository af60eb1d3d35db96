//! Exact planes: equal exactly when they hold the same points.

use glam::DVec3;

/// A plane in the world: all p with `normal · p = offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit length; which side it shows to says nothing.
    pub normal: DVec3,
    /// Metres.
    pub offset: f64,
}

/// A plane `normal · p = offset` through integer points, in lowest terms; the first non-zero component of `normal`
/// is positive, so both sides of a wall lie on an equal plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExactPlane {
    /// Coprime.
    pub normal: [i64; 3],
    /// `normal · p`, low and high half (kept apart so that the struct aligns to 8 bytes).
    offset: [u64; 2],
}

impl ExactPlane {
    /// The plane across `normal` through `point`; `None` for a zero normal, or when the reduced normal needs more than
    /// 63 bits (faces of some 10⁹ lattice units on odd slopes): such faces belong to no plane.
    pub fn new(normal: [i128; 3], point: [i64; 3]) -> Option<Self> {
        let small = normal.map(i64::try_from);
        let mut reduced = match small {
            [Ok(x), Ok(y), Ok(z)] => {
                let divisor = gcd_u64(gcd_u64(x.unsigned_abs(), y.unsigned_abs()), z.unsigned_abs());
                let divisor = i64::try_from(divisor).ok().filter(|&d| d != 0)?;
                [x / divisor, y / divisor, z / divisor]
            }
            _ => {
                let [x, y, z] = normal.map(i128::unsigned_abs);
                let divisor = i128::try_from(gcd_u128(gcd_u128(x, y), z)).ok().filter(|&d| d != 0)?;
                let [x, y, z] = normal.map(|n| i64::try_from(n / divisor));
                [x.ok()?, y.ok()?, z.ok()?]
            }
        };
        if reduced.contains(&i64::MIN) {
            return None;
        }
        if reduced.iter().find(|&&n| n != 0).is_some_and(|&n| n < 0) {
            reduced = reduced.map(|n| -n);
        }
        let terms = [0, 1, 2].map(|i| i128::from(reduced[i]) * i128::from(point[i]));
        let offset = terms[0].checked_add(terms[1])?.checked_add(terms[2])?;
        Some(Self { normal: reduced, offset: [offset as u64, (offset >> 64) as u64] })
    }

    /// The plane in the world where integers p mean `origin + step × p`; `None` if its numbers are beyond f64.
    pub fn in_world(&self, step: DVec3, origin: DVec3) -> Option<Plane> {
        let [x, y, z] = self.normal.map(|n| n as f64);
        let normal = DVec3::new(x, y, z) / step;
        let length = normal.length();
        let unit = normal.try_normalize()?;
        Some(Plane { normal: unit, offset: self.offset() as f64 / length + unit.dot(origin) })
    }

    /// `normal · p` of every point of the plane.
    pub fn offset(&self) -> i128 {
        (i128::from(self.offset[1] as i64) << 64) | i128::from(self.offset[0])
    }
}

fn gcd_u64(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

fn gcd_u128(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_sizes_do_not_matter_but_places_do() {
        let plane = ExactPlane::new([0, -6, 4], [7, 1, -3]).unwrap();
        assert_eq!(plane.normal, [0, 3, -2]);
        assert_eq!(plane.offset(), 9);
        assert_eq!(ExactPlane::new([0, 300, -200], [-50, 3, 0]), Some(plane));
        assert_ne!(ExactPlane::new([0, 3, -2], [7, 1, -2]), Some(plane));
    }

    #[test]
    fn planes_in_the_world_hold_the_points() {
        let (step, origin) = (DVec3::new(0.001, 0.001, 0.01), DVec3::new(85_000.0, 447_000.0, -3.0));
        let points = [[1234, -500, 77], [9000, 123, 5], [-777, 4000, 100]];
        let normal = crate::geom::exact::newell(&points);
        let plane = ExactPlane::new(normal, points[0]).unwrap().in_world(step, origin).unwrap();
        for p in points {
            let world = origin + step * DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64);
            assert!((plane.normal.dot(world) - plane.offset).abs() < 1e-9);
        }
    }

    #[test]
    fn offsets_survive_at_the_end_of_the_range() {
        for z in [i64::MAX, i64::MIN, -1, 0] {
            assert_eq!(ExactPlane::new([0, 0, -9], [0, 0, z]).unwrap().offset(), i128::from(z));
        }
        let steep = [0, 1, 2].map(|i| i128::from(i64::MAX) - i);
        assert_eq!(ExactPlane::new(steep, [i64::MAX, i64::MAX, i64::MAX]), None, "beyond i128");
        assert_eq!(ExactPlane::new([1 << 100, 3 << 100, 0], [1, 0, 0]), ExactPlane::new([1, 3, 0], [1, 0, 9]));
        assert_eq!(ExactPlane::new([(1 << 100) + 1, 1 << 100, 0], [1, 0, 0]), None);
        assert_eq!(ExactPlane::new([0; 3], [1, 0, 0]), None);
    }
}
