//! A request made ready: overlays in order of priority, the lanes and the room there is.

use crate::overlay::{
    crossings::{FURTHEST, pixels},
    lane::{Board, Side, nearest},
    line::Target,
    rect::{Rect, Span},
    request::{Align, Arrangement, Order, Overlay, Request},
    size::{Sizes, sizes_of},
};

use glam::DVec2;

/// A side in use, and the part of it where overlays stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lane {
    /// The side.
    pub side: Side,
    /// The part, without the corners where lanes would meet.
    pub span: Span,
}

/// A request made ready: overlays in order of priority, all numbers finite.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// The request.
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
            Lane { side, span: Span { low: inner.min[a] + corner(first), high: inner.max[a] - corner(last) } }
        };
        sides.iter().map(lane).collect()
    }

    /// Whether an overlay has no place in the picture even at its smallest.
    pub fn is_too_large(&self, item: usize) -> bool {
        let (min, room) = (self.sizes[item].min, self.board.inner.size());
        min[0] > room[0] || min[1] > room[1]
    }

    /// The number that it is placed by, higher before lower.
    pub fn rank(&self, item: usize) -> f64 {
        rank(self.overlays[item])
    }

    /// Whether overlays of these sizes could have room, told by area alone: with its gap each takes a rectangle of the picture and one gap more.
    pub(super) fn has_area(&self, sizes: &[[i32; 2]]) -> bool {
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
    pub(super) fn place_covering(&self, item: usize, size: [i32; 2], obstacles: &[Rect]) -> Option<(Side, Rect)> {
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
            let span = board.inner.span(a);
            let wish = (self.wish[item][a] - f64::from(size[a]) * 0.5).clamp(-FURTHEST, FURTHEST) as i32;
            for depth in depths.into_iter().filter(|at| *at >= 0 && at + size[d] <= board.inner.size()[d]) {
                let windows = bare.windows(side, depth, size, span, obstacles);
                let ends = windows.iter().flat_map(|w| [w.0, w.1]);
                let beside = board.points.iter().flat_map(|p| {
                    [(p[a] + board.clearance).ceil(), (p[a] - board.clearance).floor() - f64::from(size[a])]
                });
                let wishes = ends.chain(beside.map(|at| at as i32)).chain([wish]);
                for at in wishes.filter_map(|at| nearest(&windows, at, span.low, span.high)) {
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

/// The place of each overlay.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Steps of shrinking, 0..[`crate::overlay::size::SHRINK_STEPS`].
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
