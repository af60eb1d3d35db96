//! Overlays keep still while the camera moves: what of the frame before stays (B6).
//!
//! Overlays stay on their lanes, in their order, and at their size; where they would best stand is worked out anew with that. As long as none of these places is
//! further away than the dead band, nothing moves; otherwise all glide there together, each by the same share of its way, so that none meet on it.
//! An overlay stays between the points between which it stands, and a point that walks into it pushes it along.
//! The order changes only where a line has crossed another by more than the dead band, and another order has less crossings; what was shrunk,
//! folded or put inward comes back when there would be room even if all points came nearer by the dead band. Such a change is made at once, in one step.

use crate::overlay::{
    Order, Placed, Rect,
    crossings::Way,
    fill::{Filled, Problem, unease},
    lane::{Board, Side, fits},
    order::{Packer, packed, rects_of, search, sides_of, ways_of},
    place::{Seat, count},
    size::SHRINK_STEPS,
};

/// How many overlays per call look for a better place, times overlays: the others have their turn in the next calls. At most [`MOST_RETURNS`].
const RETURNS: usize = 400;

/// See [`RETURNS`].
const MOST_RETURNS: usize = 4;

/// How many changes of order are tried per call, times overlays.
const MOST_TRIALS: usize = 6000;

/// Of two neighbours in the order of distance, the second comes first only when it is nearer by this factor.
const NEARER: f64 = 0.95;

/// What a frame is, given the one before.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Who stands where.
    pub filled: Filled,
    /// The rectangle of each overlay.
    pub rects: Vec<Option<Rect>>,
    /// Whether they are still on their way.
    pub gliding: bool,
    /// Crossings beyond the dead band for which no better order was found.
    pub hopeless: u32,
    /// Whether the number of crossings is the least; `None` if it was not asked.
    pub is_least: Option<bool>,
}

/// The frame after `before`; `None` if too much is new to keep it.
pub fn keep(problem: &Problem, before: &Placed, focused: Option<usize>) -> Option<Kept> {
    let layout = &problem.request.layout;
    if before.picture != problem.request.picture || before.layout.arrangement != layout.arrangement {
        return None;
    }
    if (before.layout.margin, before.layout.gap) != (layout.margin, layout.gap) {
        return None;
    }
    let dead_band = dead_band(problem);
    let mut held: Vec<Option<Rect>> = Vec::new();
    let mut seats = Vec::new();
    for overlay in &problem.overlays {
        let found = before.placements.binary_search_by_key(&overlay.id, |p| p.id).ok().map(|i| &before.placements[i]);
        held.push(found.map(|p| p.rect));
        seats.push(found.map(|p| p.seat));
    }
    let mut filled = Filled {
        step: before.step,
        sizes: Vec::new(),
        lanes: Vec::new(),
        rows: Vec::new(),
        inward: Vec::new(),
        folded: Vec::new(),
    };
    filled.sizes = kept_sizes(problem, &held, before.step, if before.gliding { 0.0 } else { dead_band });
    filled.lanes = problem.lanes(&filled.sizes);
    filled.rows = rows(problem, &filled, &seats)?;
    let mut is_settled = rearrange(problem, &mut filled.rows, &filled.lanes.iter().map(|l| l.side).collect::<Vec<_>>());
    for (i, seat) in seats.iter().enumerate() {
        if let (Some(Seat::Inward(side)), Some(rect)) = (seat, held[i]) {
            let size = filled.sizes[i];
            let is_good =
                rect.size() == size && !problem.board.points.iter().any(|p| rect.covers(*p, problem.board.clearance));
            let is_helpless = || before.covers(problem.overlays[i].id) && problem.place_inward(i, size, &[]).is_none();
            if is_good || is_helpless() {
                filled.inward.push((i, *side, rect));
            }
        }
    }
    let mut ideal = fit(problem, &mut filled, &held, focused)?;
    if filled.step > 0
        && !before.gliding
        && let Some((grown, rects)) = grown(problem, &filled, &held, dead_band, focused)
    {
        (filled, ideal) = (grown, rects);
    }
    let has_come = come(problem, before, &mut filled, &mut ideal, dead_band, focused)?;
    is_settled |= has_come;
    let (mut hopeless, mut is_least) = (0, None);
    if layout.order == Order::Anchors {
        let shown: Vec<Option<Rect>> = held.iter().zip(&ideal).map(|(h, i)| i.and(*h).or(*i)).collect();
        let deep = deep_crossings(problem, &filled, &shown, dead_band);
        // What was not found is looked for again when it is worse by an eighth, or when it has been less by half.
        hopeless = if deep * 2 < before.hopeless { deep } else { before.hopeless };
        if deep > hopeless {
            hopeless = deep + deep / 8;
            let packer = Packer::new(problem, &filled, problem.board.clearance, focused, true);
            let now = count(&rects_of(&packer)?, &all_ways(problem, &filled, &rects_of(&packer)?)).sum();
            let ordered = search(&packer, Some(MOST_TRIALS))?;
            is_least = Some(ordered.is_least);
            if ordered.crossings < now {
                (filled.rows, filled.inward) = (ordered.rows, ordered.inward);
                ideal = packed(problem, &filled, focused)?;
                (is_settled, hopeless) = (true, 0);
            }
        }
    }
    let (rects, gliding) = advance(problem, &held, ideal, before.gliding, is_settled);
    Some(Kept { filled, rects, gliding, hopeless, is_least })
}

/// The dead band, pixels, finite.
pub fn dead_band(problem: &Problem) -> f64 {
    let band = problem.request.layout.dead_band;
    if band.is_nan() { 0.0 } else { band.clamp(0.0, 1e6) }
}

/// The sizes after `step`; those of before where they differ by no more than the dead band.
fn kept_sizes(problem: &Problem, held: &[Option<Rect>], step: u32, dead_band: f64) -> Vec<[i32; 2]> {
    let kept = |(sizes, held): (&crate::overlay::size::Sizes, &Option<Rect>)| {
        let new = sizes.shrunk(step);
        let near =
            |old: [i32; 2]| (0..2).all(|i| f64::from((old[i] - new[i]).abs()) <= dead_band && old[i] >= sizes.min[i]);
        held.map(|r| r.size()).filter(|old| near(*old)).unwrap_or(new)
    };
    problem.sizes.iter().zip(held).map(kept).collect()
}

/// The rows of before, less what has gone; `None` if a lane is no more.
fn rows(problem: &Problem, filled: &Filled, seats: &[Option<Seat>]) -> Option<Vec<Vec<usize>>> {
    let mut rows: Vec<Vec<(u32, usize)>> = vec![Vec::new(); filled.lanes.len()];
    for (i, seat) in seats.iter().enumerate() {
        if let Some(Seat::Lane(side, n)) = seat {
            let k = filled.lanes.iter().position(|l| l.side == *side)?;
            let d = side.depth_axis();
            if filled.sizes[i][d] > problem.board.inner.size()[d] {
                return None;
            }
            rows[k].push((*n, i));
        }
    }
    rows.iter_mut().for_each(|row| row.sort_unstable());
    Some(rows.into_iter().map(|row| row.into_iter().map(|r| r.1).collect()).collect())
}

/// Rows that do not go by anchors, in their order; whether that has changed.
fn rearrange(problem: &Problem, rows: &mut [Vec<usize>], sides: &[Side]) -> bool {
    let order = problem.request.layout.order;
    let factor = match order {
        Order::Anchors => return false,
        Order::Distance => NEARER,
        Order::Priority | Order::Id => 1.0,
    };
    let mut has_changed = false;
    for (row, side) in rows.iter_mut().zip(sides) {
        // Sorting by neighbours; each passes another at most once.
        for end in (1..row.len()).rev() {
            for n in 0..end {
                let (first, second) = (problem.key(row[n], *side), problem.key(row[n + 1], *side));
                if second < first * factor {
                    row.swap(n, n + 1);
                    has_changed = true;
                }
            }
        }
    }
    has_changed
}

/// Places for what stands on the lanes: between the points where it stood, otherwise anywhere along the lane, otherwise smaller.
fn fit(
    problem: &Problem,
    filled: &mut Filled,
    held: &[Option<Rect>],
    focused: Option<usize>,
) -> Option<Vec<Option<Rect>>> {
    let clearance = problem.board.clearance;
    let mut packer = Packer::new(problem, filled, clearance, focused, false);
    packer.hold(held);
    if let Some(rects) = rects_of(&packer) {
        return Some(rects);
    }
    if let Some(rects) = packed(problem, filled, focused) {
        return Some(rects);
    }
    for step in filled.step + 1..=SHRINK_STEPS {
        let sizes: Vec<_> = problem.sizes.iter().map(|s| s.shrunk(step)).collect();
        // Those further inward keep their size: shrinking them makes no room on the lanes.
        let smaller = Filled { step, lanes: problem.lanes(&sizes), sizes, ..filled.clone() };
        if smaller.lanes.len() != filled.lanes.len() {
            return None;
        }
        if let Some(rects) = packed(problem, &smaller, focused) {
            *filled = smaller;
            return Some(rects);
        }
    }
    None
}

/// All a step larger, if there is room with points nearer by the dead band.
fn grown(
    problem: &Problem,
    filled: &Filled,
    held: &[Option<Rect>],
    dead_band: f64,
    focused: Option<usize>,
) -> Option<(Filled, Vec<Option<Rect>>)> {
    if !filled.inward.is_empty() || !filled.folded.is_empty() {
        return None;
    }
    let sizes: Vec<_> = problem.sizes.iter().map(|s| s.shrunk(filled.step - 1)).collect();
    let lanes = problem.lanes(&sizes);
    if lanes.len() != filled.lanes.len() {
        return None;
    }
    let larger = Filled { step: filled.step - 1, sizes, lanes, ..filled.clone() };
    rects_of(&Packer::new(problem, &larger, problem.board.clearance + dead_band, focused, false))?;
    let mut packer = Packer::new(problem, &larger, problem.board.clearance, focused, false);
    packer.hold(held);
    let rects = rects_of(&packer)?;
    drop(packer);
    Some((larger, rects))
}

/// Finds places for what has none: new overlays, those that were folded, those further inward whose place is taken; and brings those further inward back to a
/// lane. Whether anything came. `None` if a new overlay has no place, but a less important one has.
fn come(
    problem: &Problem,
    before: &Placed,
    filled: &mut Filled,
    ideal: &mut Vec<Option<Rect>>,
    dead_band: f64,
    focused: Option<usize>,
) -> Option<bool> {
    let mut has_come = false;
    let mut is_inward = vec![false; ideal.len()];
    filled.inward.iter().for_each(|f| is_inward[f.0] = true);
    let waiting: Vec<usize> = (0..ideal.len()).filter(|&i| ideal[i].is_none() || is_inward[i]).collect();
    let turns = (RETURNS / ideal.len().max(1)).clamp(1, MOST_RETURNS);
    let first = before.calls.wrapping_mul(turns) % waiting.len().max(1);
    let has_turn = |n: usize| (n + waiting.len() - first) % waiting.len() < turns;
    let mut folded = Vec::new();
    for (n, &item) in waiting.iter().enumerate() {
        let id = problem.overlays[item].id;
        let was_folded = before.folded.binary_search(&id).is_ok();
        let is_patient = was_folded || is_inward[item];
        if is_patient && !has_turn(n) {
            if ideal[item].is_none() {
                folded.push(item);
            }
            continue;
        }
        // What was not there before needs no more room than it takes.
        let spare = if is_patient { dead_band } else { 0.0 };
        if let Some((k, at)) = lane_for(problem, filled, item, problem.board.clearance + spare) {
            let mut with = filled.clone();
            with.inward.retain(|f| f.0 != item);
            with.rows[k].insert(at, item);
            if let Some(rects) = packed(problem, &with, focused) {
                (*filled, *ideal, has_come) = (with, rects, true);
                continue;
            }
        }
        if is_inward[item] {
            continue;
        }
        let obstacles: Vec<Rect> = ideal.iter().flatten().copied().collect();
        let board = Board {
            clearance: problem.board.clearance + if was_folded { dead_band } else { 0.0 },
            ..problem.board.clone()
        };
        let wider = Problem { board, ..problem.clone() };
        match wider.place_inward(item, filled.sizes[item], &obstacles) {
            Some((side, rect)) => {
                filled.inward.push((item, side, rect));
                ideal[item] = Some(rect);
                has_come = true;
            }
            None if !was_folded && ideal[item + 1..].iter().any(Option::is_some) => return None,
            None => folded.push(item),
        }
    }
    filled.folded = folded;
    Some(has_come)
}

/// The lane, and the place in its row, where an overlay could stand too.
fn lane_for(problem: &Problem, filled: &Filled, item: usize, clearance: f64) -> Option<(usize, usize)> {
    let obstacles: Vec<Rect> = filled.inward.iter().filter(|f| f.0 != item).map(|f| f.2).collect();
    let mut sides: Vec<(f64, usize)> = (0..filled.lanes.len())
        .map(|k| (unease(problem, item, &filled.lanes[k], &filled.rows[k], &filled.sizes), k))
        .collect();
    sides.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    sides.into_iter().map(|s| s.1).find_map(|k| {
        let lane = filled.lanes[k];
        let (d, a) = (lane.side.depth_axis(), lane.side.along_axis());
        let at = problem.place_in_row(&filled.rows[k], item, lane.side);
        let row: Vec<usize> = [&filled.rows[k][..at], &[item], &filled.rows[k][at..]].concat();
        let board = problem.board.beside(lane.side, clearance, &filled.sizes);
        let inner = board.inner.size();
        let length: i32 = row.iter().map(|i| filled.sizes[*i][a] + board.gap).sum();
        // Before any windows: a full row has no room, whatever the points are.
        if filled.sizes[item][d] > inner[d] || length - board.gap > lane.span.1 - lane.span.0 {
            return None;
        }
        let windows: Vec<_> =
            row.iter().map(|i| board.windows(lane.side, 0, filled.sizes[*i], lane.span, &obstacles)).collect();
        fits(windows.iter().zip(&row).map(|(w, i)| (&w[..], filled.sizes[*i][a])), board.gap).then_some((k, at))
    })
}

/// The ways of all lines, by overlay.
pub fn all_ways(problem: &Problem, filled: &Filled, rects: &[Option<Rect>]) -> Vec<Vec<Way>> {
    let sides = sides_of(filled);
    rects
        .iter()
        .zip(&sides)
        .enumerate()
        .map(|(i, (rect, side))| rect.zip(*side).map_or(Vec::new(), |(r, s)| ways_of(problem, i, &r, s)))
        .collect()
}

/// Crossings that stay when all lines end before their focus by the dead band.
fn deep_crossings(problem: &Problem, filled: &Filled, rects: &[Option<Rect>], dead_band: f64) -> u32 {
    let ways = all_ways(problem, filled, rects);
    let all = count(rects, &ways).sum();
    if all == 0 || dead_band == 0.0 {
        return all;
    }
    let shortened: Vec<Vec<Way>> =
        ways.iter().map(|ways| ways.iter().filter_map(|w| w.shortened(dead_band)).collect()).collect();
    count(rects, &shortened).sum()
}

/// The rectangles of this frame, on the way from those `held` to those that are best, and whether they are still on it.
fn advance(
    problem: &Problem,
    held: &[Option<Rect>],
    ideal: Vec<Option<Rect>>,
    was_gliding: bool,
    is_settled: bool,
) -> (Vec<Option<Rect>>, bool) {
    let pairs = || held.iter().zip(&ideal).filter_map(|(h, i)| i.map(|i| (*h, i)));
    if is_settled || pairs().any(|(h, _)| h.is_none()) {
        return (ideal, false);
    }
    let furthest = pairs().filter_map(|(h, i)| Some(h?.distance(&i))).max().unwrap_or(0);
    if furthest == 0 {
        return (ideal, false);
    }
    let board = &problem.board;
    let covered = |rect: &Rect| board.points.iter().filter(|p| rect.covers(**p, board.clearance)).count();
    let no_worse = |rects: &[Option<Rect>]| {
        rects.iter().zip(&ideal).all(|(r, i)| {
            r.zip(*i).is_none_or(|(r, i)| r == i || (board.inner.holds(&r) && covered(&r) <= covered(&i)))
        })
    };
    let shown: Vec<Option<Rect>> = held.iter().zip(&ideal).map(|(h, i)| i.and(*h)).collect();
    if !was_gliding && f64::from(furthest) <= dead_band(problem) {
        return if no_worse(&shown) { (shown, false) } else { (ideal, false) };
    }
    let glide = problem.request.layout.glide;
    let share = (if glide.is_nan() { 1.0 } else { glide.max(1.0) } / f64::from(furthest)).min(1.0);
    let between: Vec<Option<Rect>> =
        shown.iter().zip(&ideal).map(|(h, i)| h.zip(*i).map(|(h, i)| h.towards(&i, share))).collect();
    let placed: Vec<Rect> = between.iter().flatten().copied().collect();
    let is_apart = placed.iter().enumerate().all(|(n, a)| placed[..n].iter().all(|b| !a.within(b, board.gap)));
    if share < 1.0 && is_apart && no_worse(&between) { (between, true) } else { (ideal, false) }
}
