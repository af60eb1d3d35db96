//! Lattice integers as metres and as comparable integers, alike for all files.

use glam::DVec3;

use crate::city::build::lattice::Lattice;

/// World metres are trusted up to here; farther points are damaged input.
const FARTHEST: DVec3 = DVec3::new(1e9, 1e9, 1e6);

/// A lattice seen from the whole city.
///
/// Where a lattice's origin is a whole number of steps (all real files: decimal steps, decimal origins), its integers
/// are shifted to absolute ones, and metres are computed from those: two files with other `translate`s then give the
/// same bits for the same place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    lattice: Lattice,
    /// Added to the lattice's integers; zero where they cannot be made absolute.
    shift: Option<[i64; 3]>,
    /// Whole steps per metre per axis (1000 for millimetres), or 0 where that is no whole number.
    per_metre: DVec3,
    /// Points of grids of one class are equal exactly when their [`Grid::absolute`] integers are.
    pub(super) class: u32,
}

impl Grid {
    /// The grid of a lattice; `classes` lists the classes so far.
    pub(super) fn new(lattice: Lattice, classes: &mut Vec<Lattice>) -> Self {
        let shift = whole_shift(&lattice);
        let represented = if shift.is_some() { Lattice { origin: DVec3::ZERO, ..lattice } } else { lattice };
        let class = classes.iter().position(|&known| known == represented).unwrap_or_else(|| {
            classes.push(represented);
            classes.len() - 1
        });
        let inverse = lattice.step.recip();
        let whole = inverse.round();
        let close = (inverse - whole).abs().cmple(whole * 1e-12);
        Self { lattice, shift, per_metre: DVec3::select(close, whole, DVec3::ZERO), class: class as u32 }
    }

    /// The integers that are compared between grids of one class.
    pub(super) fn absolute(&self, p: [i64; 3]) -> [i64; 3] {
        let shift = self.shift.unwrap_or_default();
        [0, 1, 2].map(|i| p[i].saturating_add(shift[i]))
    }

    /// World metres; the nearest f64 to the true decimal where the step divides a metre.
    pub(super) fn world(&self, p: [i64; 3]) -> DVec3 {
        if self.shift.is_none() {
            return self.lattice.to_world(p);
        }
        let p = self.absolute(p);
        let p = DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64);
        DVec3::select(self.per_metre.cmpgt(DVec3::ZERO), p / self.per_metre, p * self.lattice.step)
    }

    /// Metres per unit, the largest axis.
    pub(super) fn coarsest_step(&self) -> f64 {
        self.lattice.step.max_element()
    }

    /// The direction of an exact lattice normal in the world; zero if it has none.
    pub(super) fn normal(&self, n: [i128; 3]) -> DVec3 {
        let s = self.lattice.step;
        let n = DVec3::new(n[0] as f64, n[1] as f64, n[2] as f64);
        (n * DVec3::new(s.y * s.z, s.z * s.x, s.x * s.y)).normalize_or_zero()
    }
}

/// Whether a world point is a number and within 10⁹ m (height: 10⁶ m) of the origin.
pub(super) fn is_trusted(world: DVec3) -> bool {
    world.abs().cmple(FARTHEST).all()
}

/// `origin / step` where it is whole on all axes, up to the rounding of the two decimals.
fn whole_shift(lattice: &Lattice) -> Option<[i64; 3]> {
    let quotient = lattice.origin / lattice.step;
    let whole = quotient.round();
    let rounding = (quotient.abs() * f64::EPSILON * 4.0).max(DVec3::splat(1e-6));
    let fits = quotient.abs().cmplt(DVec3::splat(1e15)).all();
    (fits && (quotient - whole).abs().cmple(rounding).all()).then_some([whole.x as i64, whole.y as i64, whole.z as i64])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(step: f64, origin: [f64; 3]) -> Lattice {
        Lattice { step: DVec3::splat(step), origin: origin.into() }
    }

    #[test]
    fn files_with_other_origins_give_the_same_bits() {
        let mut classes = Vec::new();
        let a = Grid::new(lattice(0.001, [84_616.468, 447_422.999, -0.677]), &mut classes);
        let b = Grid::new(lattice(0.001, [78_248.66, 457_604.591, 2.463]), &mut classes);
        assert_eq!(a.class, b.class);
        for i in 0..1000_i64 {
            let here = [85_000_123 + i * 7_919, 455_123_457 - i * 104_729, 1_234 + i];
            let in_a = [here[0] - 84_616_468, here[1] - 447_422_999, here[2] + 677];
            let in_b = [here[0] - 78_248_660, here[1] - 457_604_591, here[2] - 2_463];
            assert_eq!(a.absolute(in_a), here);
            assert_eq!(b.absolute(in_b), here);
            assert_eq!(a.world(in_a), b.world(in_b));
            let text = format!("{}.{:03}", here[0] / 1000, here[0] % 1000);
            assert_eq!(a.world(in_a).x, text.parse::<f64>().unwrap(), "the nearest f64 to the decimal");
        }
    }

    #[test]
    fn odd_origins_are_classes_of_their_own() {
        let mut classes = Vec::new();
        let grids = [
            lattice(0.001, [0.0; 3]),
            lattice(0.001, [0.000_3, 0.0, 0.0]),
            lattice(0.01, [0.0; 3]),
            lattice(0.001, [5.0; 3]),
            Lattice::FINE,
        ]
        .map(|l| Grid::new(l, &mut classes));
        assert_eq!(grids.map(|g| g.class), [0, 1, 2, 0, 3]);
        assert_eq!(grids[1].world([1000, 0, 0]), DVec3::new(1.000_3, 0.0, 0.0));
        assert_eq!(grids[4].world([1 << 19, 0, -1 << 20]), DVec3::new(0.5, 0.0, -1.0));
    }

    #[test]
    fn damaged_numbers_are_not_trusted() {
        let mut classes = Vec::new();
        for step in [f64::NAN, f64::INFINITY] {
            assert!(!is_trusted(Grid::new(lattice(step, [1.0; 3]), &mut classes).world([1, 2, 3])));
        }
        let millimetres = Grid::new(lattice(0.001, [0.0; 3]), &mut classes);
        assert!(!is_trusted(millimetres.world([0, 0, i64::from(i32::MIN)])));
        assert!(!is_trusted(millimetres.world([i64::MAX; 3])));
        assert!(is_trusted(millimetres.world([999_999_999_999, 0, 9_000_000])));
    }
}
