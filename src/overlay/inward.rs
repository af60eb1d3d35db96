//! Places further inward (B6): the least depth at a side at which an overlay has room.
//!
//! In the plane of depth and place along the side, each point and each overlay closes a rectangle of places to an overlay of a given size. A sweep over depth
//! counts how many of them lie over each place along the side, in a segment tree: where the least count is 0, there is room. With n overlays and p points this
//! takes O((n + p) log (n + p)) for each side.
//!
//! While overlays are added and none goes, room only becomes less: for an overlay as large as one before, the search begins at the depth where that one
//! ended ([`Depths`]). It mostly ends soon after, so first those alone are swept over that are near.

use glam::DVec2;

use crate::overlay::{
    Rect,
    crossings::FURTHEST,
    fill::Problem,
    lane::{Board, Side, Windows, nearest},
    rect::closed_by,
};

/// What is known of the room further inward: for overlays of a size, or of a larger one, the least depth at each side at which there may be some.
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

/// Places that something closes: depths and places along the side, first and last of each.
#[derive(Clone, Copy, Debug)]
struct Closed {
    depth: (i32, i32),
    along: (i32, i32),
}

impl Problem<'_> {
    /// The place that is least inward for an overlay of `size`, keeping the gap from `obstacles` and from what is blocked on the `board`, and covering no
    /// point of it. `depths`: what earlier calls with this board and some of these obstacles have found.
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
            let Some((depth, windows)) = room(board, side, size, obstacles, (least[k], limit)) else {
                least[k] = if limit < deepest { limit + 1 } else { NOWHERE };
                continue;
            };
            least[k] = depth;
            let span = (board.inner.min[a], board.inner.max[a]);
            let wish = (self.wish[item][a] - f64::from(size[a]) * 0.5).clamp(-FURTHEST, FURTHEST) as i32;
            if let Some(at) = nearest(&windows, wish, span.0, span.1) {
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

/// The least of the `depths` (first and last) at which an overlay of `size` has room at a side, and where along it.
fn room(
    board: &Board,
    side: Side,
    size: [i32; 2],
    obstacles: &[Rect],
    (first, last): (i32, i32),
) -> Option<(i32, Windows)> {
    let (d, a) = (side.depth_axis(), side.along_axis());
    let span = (board.inner.min[a], board.inner.max[a]);
    let windows = |depth: i32| board.windows(side, depth, size, span, obstacles);
    let here = windows(first);
    if !here.is_empty() {
        return Some((first, here));
    }
    let near = last.min(first + size[d] + board.gap);
    let found = [(first + 1, near), (near + 1, last)].into_iter().find_map(|depths| {
        let closed = closed(board, side, size, obstacles, depths);
        least_depth(&closed, (span.0, span.1 - size[a]), depths)
    });
    found.map(|depth| (depth, windows(depth)))
}

/// What is closed to an overlay of `size` at some of the `depths` of a side, first and last.
fn closed(board: &Board, side: Side, size: [i32; 2], obstacles: &[Rect], (first, last): (i32, i32)) -> Vec<Closed> {
    let (d, a) = (side.depth_axis(), side.along_axis());
    // Of places of the upper or left end, the depths; `None` if they are others.
    let depths = |(low, high): (i32, i32)| {
        let depths = if side.is_first() {
            (low - board.inner.min[d], high - board.inner.min[d])
        } else {
            (board.inner.max[d] - size[d] - high, board.inner.max[d] - size[d] - low)
        };
        (depths.0 <= last && first <= depths.1).then(|| (depths.0.max(first), depths.1.min(last)))
    };
    let beside = |o: &Rect, i: usize| (o.min[i] - board.gap - size[i] + 1, o.max[i] + board.gap - 1);
    let of_obstacle = |o: &Rect| Some(Closed { depth: depths(beside(o, d))?, along: beside(o, a) });
    let closes = |p: f64, i: usize| closed_by(p, board.clearance, size[i]);
    let of_point = |p: &DVec2| Some(Closed { depth: depths(closes(p[d], d))?, along: closes(p[a], a) });
    let points = board.points.iter().filter_map(of_point);
    points.chain(obstacles.iter().chain(&board.blocked).filter_map(of_obstacle)).collect()
}

/// The least of the depths from `first` to `last` at which not all places from `low` to `high` are closed; nothing is closed beyond these depths.
fn least_depth(closed: &[Closed], (low, high): (i32, i32), (first, last): (i32, i32)) -> Option<i32> {
    let clipped = |c: &Closed| {
        let along = (c.along.0.max(low), c.along.1.min(high));
        (along.0 <= along.1).then_some(Closed { depth: c.depth, along })
    };
    let closed: Vec<Closed> = closed.iter().filter_map(clipped).collect();
    // Cells between the ends of what is closed: in one cell all places are as one.
    let mut starts: Vec<i32> = closed.iter().flat_map(|c| [c.along.0, c.along.1 + 1]).chain([low]).collect();
    starts.retain(|at| *at <= high);
    starts.sort_unstable();
    starts.dedup();
    let cell = |at: i32| starts.partition_point(|s| *s < at);
    let mut counts = Counts::new(starts.len());
    // Opened before closed at one depth does not matter: it is asked when all of a depth are done.
    let mut events: Vec<(i32, i32, usize, usize)> = Vec::with_capacity(2 * closed.len());
    for c in &closed {
        let (from, to) = (cell(c.along.0), cell(c.along.1 + 1));
        events.push((c.depth.0, 1, from, to));
        events.push((c.depth.1 + 1, -1, from, to));
    }
    events.sort_unstable();
    let mut depth = first;
    for (at, change, from, to) in events {
        if at > depth {
            if counts.least() == 0 {
                return Some(depth);
            }
            depth = at;
        }
        counts.add(from, to, change);
    }
    (depth <= last && counts.least() == 0).then_some(depth)
}

/// A segment tree: counts of cells, of which ranges change and the least is known.
struct Counts {
    /// The number of cells, a power of two; those that are too many count as closed.
    size: usize,
    /// By node (1 the root, 2n and 2n + 1 below n): the least count below it, without what was added above it.
    least: Vec<i32>,
    /// What was added to all of it.
    added: Vec<i32>,
}

impl Counts {
    fn new(cells: usize) -> Self {
        let size = cells.next_power_of_two();
        let mut counts = Self { size, least: vec![0; 2 * size], added: vec![0; 2 * size] };
        counts.add(cells, size, 1);
        counts
    }

    fn least(&self) -> i32 {
        self.least[1]
    }

    /// Adds to cells `from` up to, not including, `to`.
    fn add(&mut self, from: usize, to: usize, change: i32) {
        if from >= to {
            return;
        }
        let (first, last) = (from + self.size, to + self.size - 1);
        let (mut l, mut r) = (first, last + 1);
        while l < r {
            if l % 2 == 1 {
                self.apply(l, change);
                l += 1;
            }
            if r % 2 == 1 {
                r -= 1;
                self.apply(r, change);
            }
            (l, r) = (l / 2, r / 2);
        }
        for end in [first, last] {
            let mut node = end / 2;
            while node > 0 {
                self.least[node] = self.least[2 * node].min(self.least[2 * node + 1]) + self.added[node];
                node /= 2;
            }
        }
    }

    fn apply(&mut self, node: usize, change: i32) {
        self.least[node] += change;
        self.added[node] += change;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_know_their_least() {
        let mut counts = Counts::new(5);
        let mut plain = [0; 5];
        for k in 0..200_usize {
            let (from, to, change) = (k * 7 % 5, k * 7 % 5 + k * 3 % 4, if k % 3 == 2 { -1 } else { 1 });
            let to = to.min(5);
            counts.add(from, to, change);
            plain[from..to.max(from)].iter_mut().for_each(|c| *c += change);
            // The cells that are too many stay at 1.
            assert_eq!(counts.least(), *plain.iter().chain([&1]).min().unwrap(), "{k}: {plain:?}");
        }
    }

    #[test]
    fn the_least_depth_is_that_of_all_tried() {
        for seed in 0..400_i32 {
            let number = |k: i32, most: i32| (seed * 31 + k * k * 17 + k * 7).rem_euclid(most);
            let one = |k: i32| {
                let (depth, along) = (number(k, 30) - 5, number(k + 50, 40) - 5);
                Closed { depth: (depth, depth + number(k + 9, 12)), along: (along, along + number(k + 3, 25)) }
            };
            let closed: Vec<Closed> = (0..seed % 14).map(one).collect();
            let is_open = |depth: i32, at: i32| {
                let over = |range: (i32, i32), v: i32| (range.0..=range.1).contains(&v);
                !closed.iter().any(|c| over(c.depth, depth) && over(c.along, at))
            };
            for first in [0, 7] {
                let of_these = |c: &Closed| {
                    let depth = (c.depth.0.max(first), c.depth.1.min(20));
                    (depth.0 <= depth.1).then_some(Closed { depth, ..*c })
                };
                let clipped: Vec<Closed> = closed.iter().filter_map(of_these).collect();
                let tried = (first..=20).find(|depth| (3..=30).any(|at| is_open(*depth, at)));
                assert_eq!(least_depth(&clipped, (3, 30), (first, 20)), tried, "{closed:?}");
            }
        }
    }
}
