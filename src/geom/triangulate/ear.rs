//! Ear clipping of a short simple ring, on integers.
//!
//! In a ring that touches itself nowhere, an ear is a left turn whose closed triangle holds no other corner. Cutting
//! one off leaves a ring that touches itself nowhere, and by the two-ears theorem one is always left (straight corners
//! included, since closed triangles are tested): the result covers the ring once.

use super::Corner;
use crate::geom::exact::{dot, orient, segments_meet};

/// Buffers kept between faces.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Corners not yet cut off, in order.
    live: Vec<u32>,
}

impl Scratch {
    /// Appends the triangles of the ring (counter-clockwise, no spikes); `false` if it touches or crosses itself.
    ///
    /// Cuts ears off, the one with the shortest cut first (the first of equals), which keeps slivers rare.
    pub(super) fn clip(&mut self, ring: &[Corner], triangles: &mut Vec<[u32; 3]>) -> bool {
        if !is_simple(ring) {
            return false;
        }
        let at = |corner: u32| ring[corner as usize].at;
        self.live.clear();
        self.live.extend(0..ring.len() as u32);
        while self.live.len() > 3 {
            let n = self.live.len();
            let corners = |i: usize| [self.live[(i + n - 1) % n], self.live[i], self.live[(i + 1) % n]];
            let cut = |i: usize| {
                let [a, _, c] = corners(i).map(|corner| &ring[corner as usize]);
                let d = [c.at[0] - a.at[0], c.at[1] - a.at[1]];
                dot(d, d) + i128::from(c.height - a.height).pow(2)
            };
            let turn = |i: usize| {
                let [a, b, c] = corners(i).map(at);
                orient(a, b, c)
            };
            // Only corners that do not turn left can lie in another corner's triangle.
            let blockers = (0..n).filter(|&i| turn(i) <= 0).fold(0_u64, |set, i| set | 1 << i);
            let is_ear = |i: usize| {
                let ear = corners(i);
                let [a, b, c] = ear.map(at);
                let mut rest = blockers;
                while rest != 0 {
                    let other = self.live[rest.trailing_zeros() as usize];
                    rest &= rest - 1;
                    let p = at(other);
                    if !ear.contains(&other) && orient(a, b, p) >= 0 && orient(b, c, p) >= 0 && orient(c, a, p) >= 0 {
                        return false;
                    }
                }
                true
            };
            let ears = (0..n).filter(|&i| blockers & 1 << i == 0 && is_ear(i));
            let Some(best) = ears.min_by_key(|&i| cut(i)) else { return false };
            triangles.push(corners(best));
            self.live.remove(best);
        }
        triangles.push([self.live[0], self.live[1], self.live[2]]);
        true
    }
}

/// Whether no two edges share a point, but neighbours their corner (neighbours cannot overlap: spikes are gone).
fn is_simple(ring: &[Corner]) -> bool {
    let n = ring.len();
    let edge = |i: usize| (ring[i].at, ring[(i + 1) % n].at);
    (0..n).all(|i| {
        let (a, b) = edge(i);
        let last = if i == 0 { n - 1 } else { n };
        (i + 2..last).all(|j| {
            let (c, d) = edge(j);
            !segments_meet(a, b, c, d)
        })
    })
}
