//! Vertices that polygons index into, as compact as their integers allow.

use crate::city::{build::lattice::Lattice, memory::give_back};

/// The value that loaders put into a pool for a point that is no number: its faces are dropped as `bad-coordinate`.
pub const BAD_POINT: [i64; 3] = [i64::MAX; 3];

/// Vertices that polygons index into.
#[derive(Clone, Debug)]
pub struct Pool {
    /// The meaning of the integers.
    pub lattice: Lattice,
    /// The vertices.
    pub points: Points,
}

/// Points of a lattice: 12 bytes each while all fit 32 bits (nearly every file), else 24.
#[derive(Clone, Debug, PartialEq)]
pub enum Points {
    /// All coordinates fit 32 bits.
    Narrow(Vec<[i32; 3]>),
    /// Some do not.
    Wide(Vec<[i64; 3]>),
}

impl Default for Points {
    fn default() -> Self {
        Self::Narrow(Vec::new())
    }
}

impl From<Vec<[i64; 3]>> for Points {
    fn from(points: Vec<[i64; 3]>) -> Self {
        if points.iter().any(|&p| narrow(p).is_none()) {
            return Self::Wide(points);
        }
        Self::Narrow(points.into_iter().filter_map(narrow).collect())
    }
}

impl FromIterator<[i64; 3]> for Points {
    fn from_iter<T: IntoIterator<Item = [i64; 3]>>(points: T) -> Self {
        let mut this = Self::default();
        points.into_iter().for_each(|point| this.push(point));
        this
    }
}

impl Points {
    /// Appends a point.
    #[inline]
    pub fn push(&mut self, point: [i64; 3]) {
        match self {
            Self::Narrow(list) => match narrow(point) {
                Some(small) => list.push(small),
                None => {
                    let mut wide: Vec<_> = std::mem::take(list).into_iter().map(widen).collect();
                    wide.push(point);
                    *self = Self::Wide(wide);
                }
            },
            Self::Wide(list) => list.push(point),
        }
    }

    /// The point of this index, if there is one.
    #[inline]
    pub fn get(&self, index: u32) -> Option<[i64; 3]> {
        match self {
            Self::Narrow(list) => list.get(index as usize).map(|&p| widen(p)),
            Self::Wide(list) => list.get(index as usize).copied(),
        }
    }

    /// All points, in order.
    pub fn iter(&self) -> impl Iterator<Item = [i64; 3]> {
        (0..self.len() as u32).map_while(|index| self.get(index))
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        match self {
            Self::Narrow(list) => list.len(),
            Self::Wide(list) => list.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Frees them.
    pub(super) fn give_back(self) {
        match self {
            Self::Narrow(list) => give_back(list),
            Self::Wide(list) => give_back(list),
        }
    }

    /// Gives back memory that was reserved for more.
    pub fn shrink_to_fit(&mut self) {
        match self {
            Self::Narrow(list) => list.shrink_to_fit(),
            Self::Wide(list) => list.shrink_to_fit(),
        }
    }
}

fn narrow(p: [i64; 3]) -> Option<[i32; 3]> {
    match p.map(i32::try_from) {
        [Ok(x), Ok(y), Ok(z)] => Some([x, y, z]),
        _ => None,
    }
}

fn widen(p: [i32; 3]) -> [i64; 3] {
    p.map(i64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_whatever_their_size() {
        let edges = [i64::from(i32::MIN), i64::from(i32::MAX), -1, 0];
        let small: Vec<_> = edges.iter().map(|&e| [e, 0, -e / 2]).collect();
        for large in [i64::from(i32::MAX) + 1, i64::from(i32::MIN) - 1, i64::MAX] {
            for place in 0..=small.len() {
                let mut all = small.clone();
                all.insert(place, [0, large, 7]);
                let pushed: Points = all.iter().copied().collect();
                assert_eq!(pushed.iter().collect::<Vec<_>>(), all);
                assert_eq!(pushed, Points::from(all.clone()));
                assert_eq!((pushed.len(), pushed.get(all.len() as u32)), (5, None));
            }
        }
        assert!(matches!(Points::from(small), Points::Narrow(list) if list.len() == 4));
    }
}
