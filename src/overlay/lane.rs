//! A side of the picture is a lane: overlays stand along it in a row, and past what they must not cover.
//!
//! The places along a lane where an overlay covers no point are *windows*, intervals of whole pixels. A row is packed in two passes: backwards, the last
//! place of each that leaves room for those after it; forwards, the place of each that is nearest to the one that it wants. If a row fits at all, the first
//! pass finds that out. Both are linear in the overlays and their windows.

use crate::overlay::{
    rect::{Interval, Rect, Span, closed_by},
    request::Along,
};
use glam::DVec2;

/// A side of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// x = 0.
    Left,
    /// x = width.
    Right,
    /// y = 0.
    Top,
    /// y = height.
    Bottom,
}

impl Side {
    /// All four.
    pub const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Top, Self::Bottom];

    /// The axis that leads into the picture: 0 x, 1 y.
    pub fn depth_axis(self) -> usize {
        usize::from(matches!(self, Self::Top | Self::Bottom))
    }

    /// The axis along the side.
    pub fn along_axis(self) -> usize {
        1 - self.depth_axis()
    }

    /// Whether it is left or top: its depth axis leads into the picture.
    pub fn is_first(self) -> bool {
        matches!(self, Self::Left | Self::Top)
    }
}

/// Places of an overlay's upper or left end where it covers nothing, first and last of each interval, ascending.
pub type Windows = Vec<(i32, i32)>;

/// Where overlays may stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Board {
    /// The picture less its margin.
    pub inner: Rect,
    /// Between overlays, pixels.
    pub gap: i32,
    /// Distance from points, pixels, finite, 0 and up.
    pub clearance: f64,
    /// The points not to be covered, finite, in the picture or just beside it.
    pub points: Vec<DVec2>,
    /// Rectangles that are left free like an overlay that stands there, pixels.
    pub blocked: Vec<Rect>,
}

impl Board {
    /// The rectangle of an overlay of `size` at `along` its side, `depth` pixels further inward than the margin.
    pub fn rect(&self, side: Side, along: i32, depth: i32, size: [i32; 2]) -> Rect {
        let (d, a) = (side.depth_axis(), side.along_axis());
        let mut min = [0; 2];
        min[a] = along;
        min[d] = if side.is_first() { self.inner.min[d] + depth } else { self.inner.max[d] - depth - size[d] };
        Rect::new(min, size)
    }

    /// The board with another clearance, with the points alone that overlays of such sizes may cover that stand at this side.
    pub fn beside(&self, side: Side, clearance: f64, sizes: &[[i32; 2]]) -> Self {
        let d = side.depth_axis();
        let thick = sizes.iter().map(|s| s[d]).max().unwrap_or(0);
        let strip = self.rect(side, 0, 0, [thick; 2]);
        let (low, high) = (f64::from(strip.min[d]) - clearance - 1.0, f64::from(strip.max[d]) + clearance + 1.0);
        let points = self.points.iter().copied().filter(|p| (low..=high).contains(&p[d])).collect();
        Self { clearance, points, blocked: self.blocked.clone(), ..*self }
    }

    /// The number of points that an overlay covers that stands there.
    pub fn covered(&self, rect: &Rect) -> usize {
        self.points.iter().filter(|p| rect.covers(**p, self.clearance)).count()
    }

    /// Whether it would be too near to what is blocked.
    pub fn is_blocked(&self, rect: &Rect) -> bool {
        self.blocked.iter().any(|b| b.within(rect, self.gap))
    }

    /// Whether it covers no point, and keeps the gap from what is blocked.
    pub fn is_free(&self, rect: &Rect) -> bool {
        !self.is_blocked(rect) && self.covered(rect) == 0
    }

    /// Where an overlay can stand along a side at a depth, within `span`: covering no point and keeping the gap from `obstacles` and from
    /// what is blocked.
    pub fn windows(&self, side: Side, depth: i32, size: [i32; 2], span: Span, obstacles: &[Rect]) -> Windows {
        let (d, a) = (side.depth_axis(), side.along_axis());
        let length = size[a];
        let strip = self.rect(side, 0, depth, size);
        let mut closed: Vec<(i32, i32)> = Vec::new();
        for obstacle in obstacles.iter().chain(&self.blocked) {
            if strip.min[d] < obstacle.max[d] + self.gap && obstacle.min[d] < strip.max[d] + self.gap {
                closed.push((obstacle.min[a] - self.gap - length + 1, obstacle.max[a] + self.gap - 1));
            }
        }
        for point in &self.points {
            if !strip.covers_in(d, *point, self.clearance) {
                continue;
            }
            let Interval { first, last } = closed_by(point[a], self.clearance, length);
            closed.push((first, last));
        }
        closed.sort_unstable();
        let last_place = span.high - length;
        let mut windows = Windows::new();
        let mut from = span.low;
        for (first, last) in closed {
            if first > from && from <= last_place {
                windows.push((from, (first - 1).min(last_place)));
            }
            from = from.max(last + 1);
        }
        if from <= last_place {
            windows.push((from, last_place));
        }
        windows
    }
}

/// The last place at or before `limit`.
fn last_up_to(windows: &[(i32, i32)], limit: i32) -> Option<i32> {
    let after = windows.partition_point(|w| w.0 <= limit);
    Some(windows[after.checked_sub(1)?].1.min(limit))
}

/// The place nearest to `wish` among those from `low` to `high`; the lower of two.
pub fn nearest(windows: &[(i32, i32)], wish: i32, low: i32, high: i32) -> Option<i32> {
    let wish = wish.clamp(low, high.max(low));
    let below = last_up_to(windows, wish).filter(|at| *at >= low);
    let above = windows.get(windows.partition_point(|w| w.1 < wish)).map(|w| w.0.max(wish)).filter(|at| *at <= high);
    match (below, above) {
        (Some(b), Some(a)) => Some(if wish - b <= a - wish { b } else { a }),
        (one, other) => one.or(other),
    }
}

/// One overlay of a row.
#[derive(Clone, Copy, Debug)]
pub struct Seat<'a> {
    /// Where it can stand.
    pub windows: &'a [(i32, i32)],
    /// Its length along the side, pixels.
    pub length: i32,
    /// Where it would like to begin, pixels.
    pub wish: i32,
}

/// Whether a row fits: of each overlay the windows and the length.
pub fn fits<'a>(row: impl DoubleEndedIterator<Item = (&'a [(i32, i32)], i32)>, gap: i32) -> bool {
    let mut limit = i32::MAX;
    for (windows, length) in row.rev() {
        let Some(last) = last_up_to(windows, limit.saturating_sub(length)) else { return false };
        limit = last - gap;
    }
    true
}

/// Where the overlays of a row begin, pixels; `None` if the row does not fit.
pub fn pack(row: &[Seat], gap: i32) -> Option<Vec<i32>> {
    let mut latest = vec![0; row.len()];
    let mut limit = i32::MAX;
    for (seat, latest) in row.iter().zip(&mut latest).rev() {
        *latest = last_up_to(seat.windows, limit.saturating_sub(seat.length))?;
        limit = *latest - gap;
    }
    let mut low = i32::MIN;
    let place = |(seat, latest): (&Seat, i32)| {
        let at = nearest(seat.windows, seat.wish, low, latest)?;
        low = at + seat.length + gap;
        Some(at)
    };
    row.iter().zip(latest).map(place).collect()
}

/// Where the overlays of a row would like to begin on a lane: `lengths` pixels long, with anchors at `anchors` along the side.
///
/// `focused` (its number in the row) shall stand in the middle, those before and after it share what is left.
pub fn wishes(
    along: Along,
    span: Span,
    lengths: &[i32],
    anchors: &[f64],
    gap: i32,
    focused: Option<usize>,
) -> Vec<i32> {
    if let Some(k) = focused {
        let middle = span.low + (span.length() - lengths[k]) / 2;
        let before = Span { high: middle - gap, ..span };
        let mut all = wishes(along, before, &lengths[..k], &anchors[..k], gap, None);
        all.push(middle);
        let rest = Span { low: middle + lengths[k] + gap, ..span };
        all.extend(wishes(along, rest, &lengths[k + 1..], &anchors[k + 1..], gap, None));
        return all;
    }
    let total: i32 = lengths.iter().sum();
    let count = lengths.len() as i32;
    match along {
        Along::Even => {
            let room = span.length() - total;
            // Shares of the room, rounded one by one, so that the pixels that are left over are spread too.
            let even = |k: i32| span.low + (i64::from(room) * i64::from(k + 1) / i64::from(count + 1)) as i32;
            let tight = |k: i32| span.low + (room - gap * (count - 1)) / 2 + gap * k;
            let is_tight = room < gap * (count + 1);
            let before = lengths.iter().scan(0, |sum, length| Some(std::mem::replace(sum, *sum + length)));
            before.zip(0..).map(|(before, k)| before + if is_tight { tight(k) } else { even(k) }).collect()
        }
        Along::Start => {
            lengths.iter().scan(span.low, |at, length| Some(std::mem::replace(at, *at + length + gap))).collect()
        }
        Along::Anchors => near_anchors(span, lengths, anchors, gap),
    }
}

/// Least squares: each as near to the middle at its anchor as the others let it (pool adjacent violators; linear).
fn near_anchors(span: Span, lengths: &[i32], anchors: &[f64], gap: i32) -> Vec<i32> {
    // Less what stands before it each place must only not decrease.
    let before: Vec<i32> =
        lengths.iter().scan(0, |sum, length| Some(std::mem::replace(sum, *sum + length + gap))).collect();
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for ((anchor, length), before) in anchors.iter().zip(lengths).zip(&before) {
        let mut pool = (anchor - f64::from(*length) * 0.5 - f64::from(*before), 1);
        while let Some(&(mean, count)) = pools.last().filter(|p| p.0 > pool.0) {
            let both = count + pool.1;
            pool = ((mean * count as f64 + pool.0 * pool.1 as f64) / both as f64, both);
            pools.pop();
        }
        pools.push(pool);
    }
    let slack = span.length() - lengths.iter().sum::<i32>() - gap * (lengths.len() as i32 - 1);
    let low = f64::from(span.low);
    let last = low + f64::from(slack.max(0));
    let places =
        pools.iter().flat_map(|(mean, count)| std::iter::repeat_n(mean.clamp(low, last).round() as i32, *count));
    places.zip(before).map(|(at, before)| at + before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: Span = Span { low: 10, high: 210 };

    fn board(points: &[[f64; 2]], clearance: f64) -> Board {
        Board {
            inner: Rect::new([10, 10], [300, 200]),
            gap: 5,
            clearance,
            points: points.iter().map(|p| DVec2::from_array(*p)).collect(),
            blocked: Vec::new(),
        }
    }

    #[test]
    fn sides_hold_overlays_at_their_depth() {
        let board = board(&[], 0.0);
        let at = |side| board.rect(side, 50, 7, [30, 20]).min;
        assert_eq!(Side::ALL.map(at), [[17, 50], [273, 50], [50, 17], [50, 183]]);
    }

    #[test]
    fn windows_leave_out_what_covers_a_point() {
        let windows = |x: f64, y: f64, c: f64| board(&[[x, y]], c).windows(Side::Left, 0, [30, 20], SIDE, &[]);
        assert_eq!(windows(20.0, 100.0, 6.0), [(10, 74), (106, 190)]);
        assert_eq!(windows(20.0, 100.5, 6.0), [(10, 74), (107, 190)]);
        assert_eq!(windows(20.0, 100.0, 0.0), [(10, 79), (101, 190)], "a point on the border is covered");
        assert_eq!(windows(46.0, 100.0, 6.0), [(10, 190)], "just beyond");
        assert_eq!(windows(20.0, 15.0, 6.0), [(21, 190)]);
        let obstacle = [Rect::new([35, 50], [10, 10])];
        assert_eq!(board(&[], 0.0).windows(Side::Left, 0, [30, 20], SIDE, &obstacle), [(10, 25), (65, 190)]);
        assert_eq!(board(&[], 0.0).windows(Side::Left, 0, [21, 20], SIDE, &obstacle), [(10, 25), (65, 190)]);
        assert_eq!(board(&[], 0.0).windows(Side::Left, 0, [20, 20], SIDE, &obstacle), [(10, 190)], "the gap is kept");
        assert!(board(&[], 0.0).windows(Side::Left, 0, [20, 201], SIDE, &[]).is_empty());
    }

    #[test]
    fn the_nearest_place_is_the_nearest() {
        let windows = [(10, 20), (40, 50)];
        let at = |wish| nearest(&windows, wish, 0, 100);
        assert_eq!([0, 15, 30, 31, 45, 90].map(at), [10, 15, 20, 40, 45, 50].map(Some));
        assert_eq!((nearest(&windows, 15, 21, 39), nearest(&windows, 15, 30, 45)), (None, Some(40)));
    }

    #[test]
    fn a_row_is_packed_if_it_fits() {
        let open = vec![(0, 80)];
        let seat = |wish| Seat { windows: &open, length: 20, wish };
        assert_eq!(pack(&[seat(0), seat(0), seat(0)], 5), Some(vec![0, 25, 50]));
        assert_eq!(pack(&[seat(80), seat(80), seat(80)], 5), Some(vec![30, 55, 80]));
        assert_eq!(pack(&[seat(0); 5], 0), Some(vec![0, 20, 40, 60, 80]));
        assert_eq!(pack(&[seat(0); 5], 1), None);
        let hole = vec![(0, 10), (41, 80)];
        let seat = |wish| Seat { windows: &hole, length: 20, wish };
        assert_eq!(pack(&[seat(20), seat(20)], 5), Some(vec![10, 41]));
        assert!(fits([(&hole[..], 20); 3].into_iter(), 5) && !fits([(&hole[..], 20); 4].into_iter(), 5));
    }

    #[test]
    fn wishes_share_the_room() {
        let wish =
            |along, focused| wishes(along, Span { low: 0, high: 100 }, &[10, 20, 10], &[90.0, 90.0, 10.0], 5, focused);
        assert_eq!(wish(Along::Even, None), [15, 40, 75]);
        assert_eq!(wish(Along::Start, None), [0, 15, 40]);
        // By least squares the means of the three, less what is before each, are one: (85 + 65 − 35) / 3.
        assert_eq!(wish(Along::Anchors, None), [38, 53, 78]);
        assert_eq!(wish(Along::Even, Some(1)), [12, 40, 77], "the second in the middle");
        assert_eq!(
            wishes(Along::Even, Span { low: 0, high: 44 }, &[10; 4], &[0.0; 4], 5, None),
            [-5, 10, 25, 40],
            "too many: tight, about the middle"
        );
        assert_eq!(wishes(Along::Anchors, Span { low: 0, high: 100 }, &[10, 10], &[-50.0, 400.0], 5, None), [0, 90]);
    }
}
