//! Who stands where: on which lane, further inward, or nowhere (B6).
//!
//! Overlays are placed by priority, the higher first. All shrink together, by eighths of the way from the size that they want to their smallest, until the
//! lanes hold all of them; if that is not enough, again until all find a place on the lanes or further inward; at their smallest size, who finds no place is
//! folded. An overlay stands as little inward as it can: no place in the whole picture is missed, as one that touches nothing could be pushed outwards until
//! it does. With n overlays and p points this takes O(n² + n p) where lanes hold all, and for each overlay that stands
//! further inward a sweep over what is near ([`crate::overlay::inward`]).

use glam::DVec2;

use crate::overlay::{
    Align, Arrangement, Order, Overlay, Rect, Request,
    crossings::{FURTHEST, pixels},
    inward::Depths,
    lane::{Board, Side, Windows, fits, nearest},
    line::Target,
    size::{SHRINK_STEPS, Sizes, sizes_of},
};

/// A side in use, and the part of it where overlays stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lane {
    /// The side.
    pub side: Side,
    /// First and last pixel of the part, without the corners where lanes would meet.
    pub span: (i32, i32),
}

/// A request made ready: overlays in order of priority, all numbers finite.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// What was asked for.
    pub request: &'a Request,
    /// The overlays, the highest priority first, then the lowest id. Elsewhere an overlay is its number in this list.
    pub overlays: Vec<&'a Overlay>,
    /// Their limits.
    pub sizes: Vec<Sizes>,
    /// Where their lines end; the second number is that of the anchor.
    pub targets: Vec<Vec<(Target, usize)>>,
    /// Where each would like to be, pixels.
    pub wish: Vec<DVec2>,
    /// The room there is.
    pub board: Board,
    /// The sides where the arrangement puts overlays.
    pub sides: Vec<Side>,
}

impl<'a> Problem<'a> {
    /// Makes a request ready.
    pub fn new(request: &'a Request) -> Self {
        let layout = &request.layout;
        let whole = |x: u32| i32::try_from(x).unwrap_or(i32::MAX).min(FURTHEST as i32);
        let (width, height, margin) = (whole(request.picture[0]), whole(request.picture[1]), whole(layout.margin));
        let inner = Rect { min: [margin; 2], max: [width - margin, height - margin] };
        let clearance = if request.clearance.is_finite() { request.clearance.clamp(0.0, FURTHEST) } else { 0.0 };
        let near = |p: &&DVec2| {
            let picture = Rect { min: [0; 2], max: [width, height] };
            p.is_finite() && picture.covers(**p, clearance + 1.0)
        };
        let points = request.avoid.iter().filter(near).copied().collect();
        let near = |x: i32| x.clamp(-(FURTHEST as i32), FURTHEST as i32);
        let blocked = request.blocked.iter().map(|r| Rect { min: r.min.map(near), max: r.max.map(near) });
        let blocked = blocked.filter(|r| r.within(&inner, whole(layout.gap))).collect();
        let board = Board { inner, gap: whole(layout.gap), clearance, points, blocked };
        let mut overlays: Vec<&Overlay> = request.overlays.iter().collect();
        overlays.sort_by(|a, b| rank(b).total_cmp(&rank(a)).then(a.id.cmp(&b.id)));
        let targets = |o: &&Overlay| -> Vec<(Target, usize)> {
            o.anchors.iter().enumerate().filter_map(|(i, focus)| Some((Target::new(focus)?, i))).collect()
        };
        let targets: Vec<_> = overlays.iter().map(targets).collect();
        let middle = DVec2::new(f64::from(width), f64::from(height)) * 0.5;
        let wish = targets.iter().map(|t| t.first().map_or(middle, |(target, _)| pixels(target.at))).collect();
        let sizes = sizes_of(&overlays, layout.size, inner.size());
        let sides = match layout.arrangement {
            Arrangement::Border => Side::ALL.to_vec(),
            Arrangement::Vertical(align) => aligned(align, Side::Left, Side::Right),
            Arrangement::Horizontal(align) => aligned(align, Side::Top, Side::Bottom),
        };
        Self { request, overlays, sizes, targets, wish, board, sides }
    }

    /// The lanes for overlays of these sizes: none meet, and where there is no room for two that face each other, the second is left out.
    pub fn lanes(&self, sizes: &[[i32; 2]]) -> Vec<Lane> {
        let inner = self.board.inner;
        let gap = self.board.gap;
        // The thickest overlay of each axis; larger ones than the picture stand nowhere.
        let thickest = |i: usize| sizes.iter().map(|s| s[i]).filter(|s| *s <= inner.size()[i]).max().unwrap_or(0);
        let thick = [thickest(0), thickest(1)];
        let has_room = |side: &Side| {
            let d = side.depth_axis();
            side.is_first() || !self.sides.contains(&Side::ALL[d * 2]) || 2 * thick[d] + gap <= inner.size()[d]
        };
        let sides: Vec<Side> = self.sides.iter().copied().filter(has_room).collect();
        let lane = |&side: &Side| {
            let a = side.along_axis();
            let corner = |crossing: Side| if sides.contains(&crossing) { thick[a] + gap } else { 0 };
            let (first, last) = (Side::ALL[a * 2], Side::ALL[a * 2 + 1]);
            Lane { side, span: (inner.min[a] + corner(first), inner.max[a] - corner(last)) }
        };
        sides.iter().map(lane).collect()
    }

    /// Whether an overlay has no place in the picture even at its smallest.
    pub fn is_too_large(&self, item: usize) -> bool {
        let (min, room) = (self.sizes[item].min, self.board.inner.size());
        min[0] > room[0] || min[1] > room[1]
    }

    /// What it is placed by, higher before lower.
    pub fn rank(&self, item: usize) -> f64 {
        rank(self.overlays[item])
    }

    /// Whether overlays of these sizes could have room, told by area alone: with its gap each takes a rectangle of the picture and one gap more.
    fn has_area(&self, sizes: &[[i32; 2]]) -> bool {
        let area =
            |size: [i32; 2]| size.map(|s| i128::from(s.max(0)) + i128::from(self.board.gap)).into_iter().product();
        sizes.iter().map(|s| area(*s)).sum::<i128>() <= area(self.board.inner.size())
    }

    /// By what an overlay is sorted into a row of a side.
    pub fn key(&self, item: usize, side: Side) -> f64 {
        match self.request.layout.order {
            Order::Anchors => self.wish[item][side.along_axis()],
            Order::Priority => item as f64,
            Order::Distance => self.overlays[item].distance,
            Order::Id => f64::from(self.overlays[item].id),
        }
    }

    /// Where an overlay would be put into a row.
    pub fn place_in_row(&self, row: &[usize], item: usize, side: Side) -> usize {
        let key = |i: usize| (self.key(i, side), i);
        row.partition_point(|&i| key(i).0.total_cmp(&key(item).0).then(i.cmp(&item)).is_lt())
    }

    /// The place of those at the border of the picture or beside an obstacle that covers fewest points; for an overlay that covers some wherever it is.
    fn place_covering(&self, item: usize, size: [i32; 2], obstacles: &[Rect]) -> Option<(Side, Rect)> {
        let board = &self.board;
        let bare = Board { points: Vec::new(), ..board.clone() };
        let mut best: Option<((usize, i32), Side, Rect)> = None;
        for &side in &self.sides {
            let (d, a) = (side.depth_axis(), side.along_axis());
            let past = |o: &Rect| {
                board.gap + if side.is_first() { o.max[d] - board.inner.min[d] } else { board.inner.max[d] - o.min[d] }
            };
            let mut depths: Vec<i32> = obstacles.iter().chain(&board.blocked).map(past).collect();
            depths.push(0);
            depths.sort_unstable();
            depths.dedup();
            let span = (board.inner.min[a], board.inner.max[a]);
            let wish = (self.wish[item][a] - f64::from(size[a]) * 0.5).clamp(-FURTHEST, FURTHEST) as i32;
            for depth in depths.into_iter().filter(|at| *at >= 0 && at + size[d] <= board.inner.size()[d]) {
                let windows = bare.windows(side, depth, size, span, obstacles);
                let ends = windows.iter().flat_map(|w| [w.0, w.1]);
                let beside = board.points.iter().flat_map(|p| {
                    [(p[a] + board.clearance).ceil(), (p[a] - board.clearance).floor() - f64::from(size[a])]
                });
                let wishes = ends.chain(beside.map(|at| at as i32)).chain([wish]);
                for at in wishes.filter_map(|at| nearest(&windows, at, span.0, span.1)) {
                    let rect = board.rect(side, at, depth, size);
                    let cost = (
                        board.points.iter().filter(|p| rect.covers(**p, board.clearance)).count(),
                        depth + (at - wish).abs(),
                    );
                    if best.is_none_or(|b| cost < b.0) {
                        best = Some((cost, side, rect));
                    }
                }
            }
        }
        best.map(|(_, side, rect)| (side, rect))
    }
}

/// The priority; what is no number counts as the lowest.
fn rank(overlay: &Overlay) -> f64 {
    if overlay.priority.is_nan() { f64::NEG_INFINITY } else { overlay.priority + 0.0 }
}

fn aligned(align: Align, first: Side, last: Side) -> Vec<Side> {
    match align {
        Align::First => vec![first],
        Align::Last => vec![last],
        Align::Both => vec![first, last],
    }
}

/// Who stands where.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Steps of shrinking, 0..[`SHRINK_STEPS`].
    pub step: u32,
    /// The size of each overlay, pixels.
    pub sizes: Vec<[i32; 2]>,
    /// The lanes.
    pub lanes: Vec<Lane>,
    /// The overlays on each lane, from the top or from the left.
    pub rows: Vec<Vec<usize>>,
    /// Those further inward.
    pub inward: Vec<(usize, Side, Rect)>,
    /// Those without a place.
    pub folded: Vec<usize>,
}

/// Fills the picture from nothing.
pub fn fill(problem: &Problem) -> Filled {
    let shrinks = problem.sizes.iter().any(|s| s.min != s.wanted);
    let steps = if shrinks { SHRINK_STEPS } else { 0 };
    let all = |inward: bool| (0..=steps).find_map(|step| fill_at(problem, step, inward, false));
    let placed = all(false).or_else(|| all(true));
    placed.or_else(|| fill_at(problem, steps, true, true)).unwrap_or_else(|| Filled {
        step: steps,
        sizes: problem.sizes.iter().map(|s| s.shrunk(steps)).collect(),
        lanes: Vec::new(),
        rows: Vec::new(),
        inward: Vec::new(),
        folded: (0..problem.overlays.len()).collect(),
    })
}

/// Fills the picture with overlays that are shrunk by `step`, also further inward where lanes are full. Without `folds`, `None` if not all have a place.
fn fill_at(problem: &Problem, step: u32, inward: bool, folds: bool) -> Option<Filled> {
    let sizes: Vec<[i32; 2]> = problem.sizes.iter().map(|s| s.shrunk(step)).collect();
    let lanes = problem.lanes(&sizes);
    let board = &problem.board;
    if !folds && !problem.has_area(&sizes) {
        return None;
    }
    let mut rows: Vec<Vec<usize>> = vec![Vec::new(); lanes.len()];
    let mut windows: Vec<Vec<Windows>> = vec![vec![Windows::new(); sizes.len()]; lanes.len()];
    let boards: Vec<Board> = lanes.iter().map(|lane| board.beside(lane.side, board.clearance, &sizes)).collect();
    let mut left = Vec::new();
    for (item, &size) in sizes.iter().enumerate() {
        let mut sides: Vec<(f64, usize)> =
            (0..lanes.len()).map(|k| (unease(problem, item, &lanes[k], &rows[k], &sizes), k)).collect();
        sides.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let found = sides.iter().find_map(|&(_, k)| {
            let Lane { side, span } = lanes[k];
            if size[side.depth_axis()] > board.inner.size()[side.depth_axis()] {
                return None;
            }
            windows[k][item] = match sizes[..item].iter().rposition(|s| *s == size) {
                Some(other) if !windows[k][other].is_empty() => windows[k][other].clone(),
                _ => boards[k].windows(side, 0, size, span, &[]),
            };
            let at = problem.place_in_row(&rows[k], item, side);
            let with = rows[k][..at].iter().chain([&item]).chain(&rows[k][at..]);
            let seats: Vec<_> = with.map(|&i| (&windows[k][i][..], sizes[i][side.along_axis()])).collect();
            fits(seats.into_iter(), board.gap).then_some((k, at))
        });
        match found {
            Some((k, at)) => rows[k].insert(at, item),
            None if inward => left.push(item),
            None => return None,
        }
    }
    let mut filled = Filled { step, sizes, lanes, rows, inward: Vec::new(), folded: Vec::new() };
    if left.is_empty() {
        return Some(filled);
    }
    let packed = crate::overlay::order::packed(problem, &filled, None)?;
    let mut obstacles: Vec<Rect> = packed.into_iter().flatten().collect();
    let (mut depths, mut empty_depths) = (Depths::default(), Depths::default());
    for item in left {
        let size = filled.sizes[item];
        let place = problem.place_inward(board, item, size, &obstacles, &mut depths).or_else(|| {
            let mut is_helpless = || problem.place_inward(board, item, size, &[], &mut empty_depths).is_none();
            if folds && is_helpless() { problem.place_covering(item, size, &obstacles) } else { None }
        });
        match place {
            Some((side, rect)) => {
                obstacles.push(rect);
                filled.inward.push((item, side, rect));
            }
            None if folds => filled.folded.push(item),
            None => return None,
        }
    }
    Some(filled)
}

/// How badly a side suits an overlay: how far its wish is from the side, as a share of the picture, and half of the share of the lane that is taken.
pub fn unease(problem: &Problem, item: usize, lane: &Lane, row: &[usize], sizes: &[[i32; 2]]) -> f64 {
    let (d, a) = (lane.side.depth_axis(), lane.side.along_axis());
    let extent = |i: usize| f64::from(problem.board.inner.size()[i].max(1));
    let from_first = ((problem.wish[item][d] - f64::from(problem.board.inner.min[d])) / extent(d)).clamp(0.0, 1.0);
    let far = if lane.side.is_first() { from_first } else { 1.0 - from_first };
    let taken: i32 = row.iter().map(|i| sizes[*i][a] + problem.board.gap).sum();
    far + 0.5 * f64::from(taken) / f64::from((lane.span.1 - lane.span.0).max(1))
}
