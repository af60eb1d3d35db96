//! Numbers for planes that several polygons share.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::Lattice;
use crate::geom::plane::{ExactPlane, Plane};

/// A plane in the integers of one class of grids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct PlaneKey {
    pub(super) plane: ExactPlane,
    /// [`super::metric::Grid::class`].
    pub(super) class: u32,
}

/// Every plane met so far.
#[derive(Debug, Default)]
pub(super) struct PlaneTable {
    numbers: FxHashMap<PlaneKey, u32>,
    /// Per number: the polygon that was on it last, and whether another one was before.
    polygons: Vec<(u32, bool)>,
}

impl PlaneTable {
    /// The number of `key`, 1 or more; `polygon` lies on it.
    pub(super) fn add(&mut self, key: PlaneKey, polygon: u32) -> u32 {
        let next = self.polygons.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        match self.polygons.get_mut(number as usize) {
            Some((last, shared)) => {
                *shared |= *last != polygon;
                *last = polygon;
            }
            None => self.polygons.push((polygon, false)),
        }
        number + 1
    }

    /// Renumbers `planes`: planes of a single polygon become 0, the others 1, 2, ... in the order they were met.
    /// Returns those others in the world; `classes` are the lattices of the grid classes.
    pub(super) fn finish(self, planes: &mut [u32], classes: &[Lattice]) -> Vec<Plane> {
        let nowhere = Plane { normal: DVec3::ZERO, offset: 0.0 };
        let mut count = 0;
        let final_numbers: Vec<u32> = std::iter::once(0)
            .chain(self.polygons.iter().map(|&(_, shared)| {
                count += u32::from(shared);
                if shared { count } else { 0 }
            }))
            .collect();
        let mut equations = vec![nowhere; count as usize];
        for (key, number) in self.numbers {
            if let Some(place) = final_numbers[number as usize + 1].checked_sub(1) {
                let lattice = classes[key.class as usize];
                equations[place as usize] = key.plane.in_world(lattice.step, lattice.origin).unwrap_or(nowhere);
            }
        }
        for plane in planes {
            *plane = final_numbers[*plane as usize];
        }
        equations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_planes_of_two_polygons_keep_a_number() {
        let key = |z: i64, class| PlaneKey { plane: ExactPlane::new([0, 0, 1], [0, 0, z]).unwrap(), class };
        let mut table = PlaneTable::default();
        let mut planes = vec![
            table.add(key(0, 0), 10),
            table.add(key(0, 0), 10),
            table.add(key(1, 0), 11),
            0,
            table.add(key(2, 0), 12),
            table.add(key(1, 0), 13),
            table.add(key(2, 1), 14),
            table.add(key(2, 0), 15),
        ];
        let millimetres = Lattice { step: DVec3::splat(0.001), origin: DVec3::ZERO };
        let equations = table.finish(&mut planes, &[millimetres, Lattice::FINE]);
        assert_eq!(planes, [0, 0, 1, 0, 2, 1, 0, 2]);
        assert_eq!(equations.iter().map(|plane| plane.normal).collect::<Vec<_>>(), [DVec3::Z; 2]);
        assert_eq!(equations.iter().map(|plane| plane.offset).collect::<Vec<_>>(), [0.001, 0.002]);
    }
}
