//! Places further inward (B6): the least depth at a side at which an overlay has room.
//!
//! In the plane of depth and place along the side, each point and each overlay closes a rectangle of places to an overlay of a given size. A sweep over depth
//! counts how many of them lie over each place along the side, in a segment tree: where the least count is 0, there is room. With n overlays and p points this
//! takes O((n + p) log (n + p)) for each side.

use crate::overlay::{
    Rect,
    crossings::FURTHEST,
    fill::Problem,
    lane::{Side, nearest},
    rect::closed_by,
};

/// Places that something closes: depths and places along the side, first and last of each.
#[derive(Clone, Copy, Debug)]
struct Closed {
    depth: (i32, i32),
    along: (i32, i32),
}

impl Problem<'_> {
    /// The place that is least inward for an overlay of `size`, keeping the gap from `obstacles` and from what is blocked and covering no point.
    pub fn place_inward(&self, item: usize, size: [i32; 2], obstacles: &[Rect]) -> Option<(Side, Rect)> {
        let board = &self.board;
        let inner = board.inner.size();
        if size[0] > inner[0] || size[1] > inner[1] {
            return None;
        }
        let reach = self.request.layout.reach;
        let reach = if reach.is_nan() { 1.0 } else { reach.clamp(0.0, 1.0) };
        let mut best: Option<(i32, i32, Side, Rect)> = None;
        for &side in &self.sides {
            let (d, a) = (side.depth_axis(), side.along_axis());
            let deepest = (inner[d] - size[d]).min((f64::from(inner[d]) * reach) as i32 - size[d]).max(0);
            let deepest = best.map_or(deepest, |best| deepest.min(best.0));
            let span = (board.inner.min[a], board.inner.max[a]);
            let closed = self.closed(side, size, obstacles);
            let Some(depth) = least_depth(&closed, (span.0, span.1 - size[a]), deepest) else { continue };
            let wish = (self.wish[item][a] - f64::from(size[a]) * 0.5).clamp(-FURTHEST, FURTHEST) as i32;
            let windows = board.windows(side, depth, size, span, obstacles);
            if let Some(at) = nearest(&windows, wish, span.0, span.1) {
                let found = (depth, (at - wish).abs(), side, board.rect(side, at, depth, size));
                if best.is_none_or(|b| (found.0, found.1) < (b.0, b.1)) {
                    best = Some(found);
                }
            }
        }
        best.map(|(.., side, rect)| (side, rect))
    }

    /// What is closed at a side to an overlay of `size`.
    fn closed(&self, side: Side, size: [i32; 2], obstacles: &[Rect]) -> Vec<Closed> {
        let board = &self.board;
        let (d, a) = (side.depth_axis(), side.along_axis());
        // Of places of the upper or left end, the depths.
        let depths = |(first, last): (i32, i32)| {
            if side.is_first() {
                (first - board.inner.min[d], last - board.inner.min[d])
            } else {
                (board.inner.max[d] - size[d] - last, board.inner.max[d] - size[d] - first)
            }
        };
        let beside = |o: &Rect, i: usize| (o.min[i] - board.gap - size[i] + 1, o.max[i] + board.gap - 1);
        let of_obstacle = |o: &Rect| Closed { depth: depths(beside(o, d)), along: beside(o, a) };
        let closes = |p: f64, i: usize| closed_by(p, board.clearance, size[i]);
        let points = board.points.iter().map(|p| Closed { depth: depths(closes(p[d], d)), along: closes(p[a], a) });
        points.chain(obstacles.iter().chain(&board.blocked).map(of_obstacle)).collect()
    }
}

/// The least depth from 0 to `deepest` at which not all places from `low` to `high` are closed.
fn least_depth(closed: &[Closed], (low, high): (i32, i32), deepest: i32) -> Option<i32> {
    let clipped = |c: &Closed| {
        let along = (c.along.0.max(low), c.along.1.min(high));
        let depth = (c.depth.0.max(0), c.depth.1.min(deepest));
        (along.0 <= along.1 && depth.0 <= depth.1).then_some(Closed { depth, along })
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
    let mut depth = 0;
    for (at, change, from, to) in events {
        if at > depth {
            if counts.least() == 0 {
                return Some(depth);
            }
            depth = at;
        }
        counts.add(from, to, change);
    }
    (depth <= deepest && counts.least() == 0).then_some(depth)
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
            let tried = (0..=20).find(|depth| (3..=30).any(|at| is_open(*depth, at)));
            assert_eq!(least_depth(&closed, (3, 30), 20), tried, "{closed:?}");
        }
    }
}
