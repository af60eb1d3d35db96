//! Places further inward: the least depth at a side at which an overlay has room.
//!
//! In the plane of depth and place along the side, each point and each overlay closes a rectangle of places to an overlay
//! of a given size. A sweep over depth raises the depth at which each place along the side opens, by one rectangle after
//! the other; where that is less than where the next one begins, there is room. With n overlays and p points this takes
//! O((n + p) (log (n + p) + w)) at most, for a side of w pixels, and of w mostly no more than what a rectangle closes.
//!
//! While overlays are added and none goes, room only becomes less: for an overlay as large as one before, the search begins
//! at the depth where that one ended ([`Depths`]). It mostly ends soon after, so first what is near is swept over alone.

use glam::DVec2;

use crate::overlay::{
    crossings::FURTHEST,
    lane::{Board, Side, Windows, nearest},
    problem::Problem,
    rect::{Interval, Rect, closed_by},
};

/// Knowledge of the room further inward: for overlays of a size, or of a larger one, the least depth at each side at
/// which there may be some.
///
/// It holds for one board as long as obstacles are only added.
#[derive(Clone, Debug, Default)]
pub struct Depths {
    /// Sizes, and depths in the order of the problem's sides.
    known: Vec<([i32; 2], [i32; 4])>,
}

impl Depths {
    /// Where to begin, for an overlay of `size`; pixels, [`NOWHERE`] where there is no room at a side.
    fn of(&self, size: [i32; 2]) -> [i32; 4] {
        let smaller = self.known.iter().filter(|(known, _)| known[0] <= size[0] && known[1] <= size[1]);
        smaller.fold([0; 4], |least, (_, depths)| [0, 1, 2, 3].map(|k| least[k].max(depths[k])))
    }

    fn note(&mut self, size: [i32; 2], depths: [i32; 4]) {
        match self.known.iter_mut().find(|(known, _)| *known == size) {
            Some((_, known)) => *known = depths,
            None => self.known.push((size, depths)),
        }
    }
}

/// A depth of which there is none.
const NOWHERE: i32 = i32::MAX;

/// Places that something closes: depths, and places along the side.
#[derive(Clone, Copy, Debug)]
struct Closed {
    depth: Interval,
    along: Interval,
}

impl Problem<'_> {
    /// The place that is least inward for an overlay of `size`, keeping the gap from `obstacles` and from what is blocked on
    /// the `board`, and covering no point of it. `depths`: what calls with this board and less obstacles have found.
    pub fn place_inward(
        &self,
        board: &Board,
        item: usize,
        size: [i32; 2],
        obstacles: &[Rect],
        depths: &mut Depths,
    ) -> Option<(Side, Rect)> {
        let inner = board.inner.size();
        if size[0] > inner[0] || size[1] > inner[1] {
            return None;
        }
        let reach = self.request.layout.reach;
        let reach = if reach.is_nan() { 1.0 } else { reach.clamp(0.0, 1.0) };
        let mut least = depths.of(size);
        let mut order: Vec<usize> = (0..self.sides.len()).collect();
        order.sort_by_key(|k| least[*k]);
        // Depth, distance from the wish, and the number of the side: what is less is better.
        let mut best: Option<((i32, i32, usize), Rect)> = None;
        for k in order {
            let side = self.sides[k];
            let (d, a) = (side.depth_axis(), side.along_axis());
            let deepest = (inner[d] - size[d]).min((f64::from(inner[d]) * reach) as i32 - size[d]).max(0);
            let limit = best.map_or(deepest, |best| deepest.min(best.0.0));
            if least[k] > limit {
                continue;
            }
            let looked_at = Interval { first: least[k], last: limit };
            let Some((depth, windows)) = room(board, side, size, obstacles, looked_at) else {
                least[k] = if limit < deepest { limit + 1 } else { NOWHERE };
                continue;
            };
            least[k] = depth;
            let span = board.inner.span(a);
            let wish = (self.wish[item][a] - f64::from(size[a]) * 0.5).clamp(-FURTHEST, FURTHEST) as i32;
            if let Some(at) = nearest(&windows, wish, span.low, span.high) {
                let found = (depth, (at - wish).abs(), k);
                if best.is_none_or(|best| found < best.0) {
                    best = Some((found, board.rect(side, at, depth, size)));
                }
            }
        }
        depths.note(size, least);
        best.map(|((.., k), rect)| (self.sides[k], rect))
    }
}

/// The least of the `depths` at which an overlay of `size` has room at a side, and where along it.
fn room(board: &Board, side: Side, size: [i32; 2], obstacles: &[Rect], depths: Interval) -> Option<(i32, Windows)> {
    let (d, a) = (side.depth_axis(), side.along_axis());
    let Interval { first, last } = depths;
    let span = board.inner.span(a);
    let places = Interval { first: span.low, last: span.high - size[a] };
    let windows = |depth: i32| board.windows(side, depth, size, span, obstacles);
    let here = windows(first);
    if !here.is_empty() {
        return Some((first, here));
    }
    let near = last.min(first + size[d] + board.gap);
    let behind = [Interval { first: first + 1, last: near }, Interval { first: near + 1, last }];
    let found =
        behind.into_iter().find_map(|depths| least_depth(closed(board, side, size, obstacles, depths), places, depths));
    found.map(|depth| (depth, windows(depth)))
}

/// The places that are closed to an overlay of `size` at some of the `depths` of a side.
fn closed(board: &Board, side: Side, size: [i32; 2], obstacles: &[Rect], depths: Interval) -> Vec<Closed> {
    let (d, a) = (side.depth_axis(), side.along_axis());
    // The depths of places of the upper or left end; `None` if they are others.
    let depth_of = |places: Interval| {
        let inward = if side.is_first() {
            let edge = board.inner.min[d];
            Interval { first: places.first - edge, last: places.last - edge }
        } else {
            let edge = board.inner.max[d] - size[d];
            Interval { first: edge - places.last, last: edge - places.first }
        };
        inward.overlap(depths)
    };
    let beside =
        |o: &Rect, i: usize| Interval { first: o.min[i] - board.gap - size[i] + 1, last: o.max[i] + board.gap - 1 };
    let of_obstacle = |o: &Rect| Some(Closed { depth: depth_of(beside(o, d))?, along: beside(o, a) });
    let closes = |p: f64, i: usize| closed_by(p, board.clearance, size[i]);
    let of_point = |p: &DVec2| Some(Closed { depth: depth_of(closes(p[d], d))?, along: closes(p[a], a) });
    let points = board.points.iter().filter_map(of_point);
    points.chain(obstacles.iter().chain(&board.blocked).filter_map(of_obstacle)).collect()
}

/// The least of the `depths` at which not all `places` are closed.
fn least_depth(mut closed: Vec<Closed>, places: Interval, depths: Interval) -> Option<i32> {
    let Interval { first, last } = places;
    if first > last {
        return None;
    }
    closed.retain(|c| c.along.overlap(places).is_some());
    closed.sort_unstable_by_key(|c| c.depth.first);
    // By place, the least depth that is open as far as has been looked; and the least of all, as it was last worked out.
    let mut open = vec![depths.first; (last - first) as usize + 1];
    let mut least = depths.first;
    for c in closed {
        // What comes now begins here or further inward, and closes nothing before.
        if c.depth.first > least {
            least = open.iter().fold(i32::MAX, |a, b| a.min(*b));
            if c.depth.first > least {
                break;
            }
        }
        let along = (c.along.first.max(first) - first) as usize..=(c.along.last.min(last) - first) as usize;
        open[along].iter_mut().for_each(|depth| *depth = (*depth).max(c.depth.last + 1));
    }
    open.into_iter().min().filter(|least| *least <= depths.last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlay::{
        request::Arrangement,
        tests::{overlay, request},
    };

    #[test]
    fn the_least_depth_is_that_of_all_tried() {
        for seed in 0..400_i32 {
            let number = |k: i32, most: i32| (seed * 31 + k * k * 17 + k * 7).rem_euclid(most);
            let one = |k: i32| {
                let (depth, along) = (number(k, 30) - 5, number(k + 50, 40) - 5);
                let from = |first: i32, more: i32| Interval { first, last: first + more };
                Closed { depth: from(depth, number(k + 9, 12)), along: from(along, number(k + 3, 25)) }
            };
            let closed: Vec<Closed> = (0..seed % 14).map(one).collect();
            let is_open = |depth: i32, at: i32| {
                let over = |range: Interval, v: i32| (range.first..=range.last).contains(&v);
                !closed.iter().any(|c| over(c.depth, depth) && over(c.along, at))
            };
            for first in [0, 7] {
                let (places, depths) = (Interval { first: 3, last: 30 }, Interval { first, last: 20 });
                let of_these = |c: &Closed| Some(Closed { depth: c.depth.overlap(depths)?, ..*c });
                let clipped = closed.iter().filter_map(of_these).collect();
                let tried = (first..=20).find(|depth| (3..=30).any(|at| is_open(*depth, at)));
                assert_eq!(least_depth(clipped, places, depths), tried, "{closed:?}");
            }
        }
    }

    #[test]
    fn what_is_known_changes_no_place() {
        for (round, reach) in (0..40_u32).zip([1.0, 0.4].into_iter().cycle()) {
            let at = |k: u32| {
                DVec2::new(f64::from((round * 131 + k * k * 37) % 400), f64::from((round * 71 + k * k * 29 + k) % 300))
            };
            let overlays = (0..80).map(|id| {
                let size = if id % 3 == 0 { [60.0, 30.0] } else { [40.0, 20.0] };
                overlay(id, size, at(id).to_array())
            });
            let mut asked = request(overlays.collect(), Arrangement::Border);
            (asked.picture, asked.layout.reach) = ([400, 300], reach);
            let problem = Problem::new(&asked);
            let mut depths = Depths::default();
            let mut obstacles = Vec::new();
            for item in 0..80 {
                let place = |depths: &mut Depths| {
                    problem.place_inward(&problem.board, item, problem.sizes[item].min, &obstacles, depths)
                };
                let found = place(&mut depths);
                assert_eq!(found, place(&mut Depths::default()), "round {round}, overlay {item}");
                obstacles.extend(found.map(|found| found.1));
            }
            assert!(obstacles.len() < 80, "some have no place");
        }
    }
}
