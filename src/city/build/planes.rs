//! Numbers for planes that several polygons share.

use glam::DVec3;

use crate::{
    city::{build::lattice::Lattice, memory::give_back},
    geom::plane::{ExactPlane, Plane},
};

/// A plane in the integers of one class of grids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct PlaneKey {
    pub(super) plane: ExactPlane,
    /// [`super::metric::Grid::class`].
    pub(super) class: u32,
}

/// Every plane met so far.
///
/// Planes are told apart by 128-bit fingerprints of their exact integers: a third of the memory of the integers, and
/// two of a million planes would be confused with a chance of some 10⁻²⁷.
#[derive(Debug, Default)]
pub(super) struct PlaneTable {
    /// Open addressing over the fingerprints: 1 + number, or 0 where free; a power of two, at most three quarters full.
    slots: Vec<u32>,
    fingerprints: Vec<[u64; 2]>,
    /// Per number: the polygon that was on it last, and the plane in the world if another one was before.
    uses: Vec<(u32, u32)>,
    shared: Vec<Plane>,
}

/// In [`PlaneTable::uses`]: one polygon so far.
const ALONE: u32 = u32::MAX;

impl PlaneTable {
    /// The number of `key`, 1 or more; `polygon` lies on it. `classes` are the lattices of the grid classes.
    pub(super) fn add(&mut self, key: PlaneKey, polygon: u32, classes: &[Lattice]) -> u32 {
        let number = self.find_or_add(key.fingerprint());
        match self.uses.get_mut(number as usize) {
            Some((last, shared)) => {
                if *last != polygon && *shared == ALONE {
                    *shared = self.shared.len() as u32;
                    let lattice = classes[key.class as usize];
                    let nowhere = Plane { normal: DVec3::ZERO, offset: 0.0 };
                    self.shared.push(key.plane.in_world(lattice.step, lattice.origin).unwrap_or(nowhere));
                }
                *last = polygon;
            }
            None => self.uses.push((polygon, ALONE)),
        }
        number + 1
    }

    /// The number of a fingerprint: the next one if it is new.
    fn find_or_add(&mut self, fingerprint: [u64; 2]) -> u32 {
        if self.fingerprints.len() * 4 >= self.slots.len() * 3 {
            self.resize((self.slots.len() * 2).max(64));
        }
        let mut at = self.home(fingerprint);
        loop {
            match self.slots[at].checked_sub(1) {
                Some(number) if self.fingerprints[number as usize] == fingerprint => return number,
                Some(_) => at = (at + 1) & (self.slots.len() - 1),
                None => {
                    self.fingerprints.push(fingerprint);
                    self.slots[at] = self.fingerprints.len() as u32;
                    return self.slots[at] - 1;
                }
            }
        }
    }

    /// Where a fingerprint stands, or where looking for it begins.
    fn home(&self, fingerprint: [u64; 2]) -> usize {
        fingerprint[0] as usize & (self.slots.len() - 1)
    }

    fn resize(&mut self, slots: usize) {
        give_back(std::mem::take(&mut self.slots));
        self.slots = vec![0; slots];
        for number in 0..self.fingerprints.len() {
            let mut at = self.home(self.fingerprints[number]);
            while self.slots[at] != 0 {
                at = (at + 1) & (slots - 1);
            }
            self.slots[at] = number as u32 + 1;
        }
    }

    /// Renumbers `planes`: planes of a single polygon become 0, the others 1, 2, ... in the order in which their second
    /// polygon was met. Returns those others in the world.
    pub(super) fn finish(mut self, planes: &mut [u32]) -> Vec<Plane> {
        give_back(self.slots);
        give_back(self.fingerprints);
        for plane in planes {
            // `ALONE` wraps around to 0, and so do triangles without a plane.
            *plane = plane.checked_sub(1).map_or(0, |number| self.uses[number as usize].1.wrapping_add(1));
        }
        give_back(self.uses);
        self.shared.shrink_to_fit();
        self.shared
    }
}

impl PlaneKey {
    /// Two different mixes of all its numbers.
    fn fingerprint(&self) -> [u64; 2] {
        let offset = self.plane.offset();
        let [x, y, z] = self.plane.normal.map(|n| n as u64);
        let words = [x, y, z, offset as u64, (offset >> 64) as u64, u64::from(self.class)];
        [0x9e37_79b9_7f4a_7c15, 0xc2b2_ae3d_27d4_eb4f].map(|seed: u64| words.iter().fold(seed, |h, &w| mix(h, w, seed)))
    }
}

/// A round of a multiply-and-fold hash: every bit of `h` and `word` reaches every bit of the result.
fn mix(h: u64, word: u64, seed: u64) -> u64 {
    let product = u128::from(h ^ word.rotate_left(31)) * u128::from((word ^ seed) | 1);
    let folded = (product as u64) ^ ((product >> 64) as u64) ^ h.rotate_left(17);
    (folded ^ (folded >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_planes_of_two_polygons_keep_a_number() {
        let key = |z: i64, class| PlaneKey { plane: ExactPlane::new([0, 0, 1], [0, 0, z]).unwrap(), class };
        let millimetres = Lattice { step: DVec3::splat(0.001), origin: DVec3::ZERO };
        let classes = [millimetres, Lattice::FINE];
        let mut table = PlaneTable::default();
        let mut add = |key, polygon| table.add(key, polygon, &classes);
        let mut planes = vec![
            add(key(0, 0), 10),
            add(key(0, 0), 10),
            add(key(1, 0), 11),
            0,
            add(key(2, 0), 12),
            add(key(1, 0), 13),
            add(key(2, 1), 14),
            add(key(2, 0), 15),
        ];
        let equations = table.finish(&mut planes);
        assert_eq!(planes, [0, 0, 1, 0, 2, 1, 0, 2]);
        assert_eq!(equations.iter().map(|plane| plane.normal).collect::<Vec<_>>(), [DVec3::Z; 2]);
        assert_eq!(equations.iter().map(|plane| plane.offset).collect::<Vec<_>>(), [0.001, 0.002]);
    }
}
