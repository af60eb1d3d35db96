//! Temporal coherence of overlays: what of the frame before stays while the camera moves.
//!
//! Overlays stay on their lanes, in their order, and at their size; where they would best stand is worked out anew with that. As long as
//! none of these places along a side is further away than the dead band, nothing moves there; otherwise all of that side glide together,
//! each by the same share of its way, so that none meet on it. An overlay stays between the points between which it stands, and a point
//! that walks into it pushes it along.
//!
//! The order changes only where a line has crossed another by more than the dead band, and another order has less crossings; what was
//! shrunk, folded or put inward comes back when there would be room even if all points came nearer by the dead band. Such a change is
//! made at once, in one step, by those of the sides that it changes; [`crate::overlay::placed::Jump`] tells of it.

use crate::overlay::{
    crossings::Way,
    fill::unease,
    grid::{Counted, Segment, count},
    inward::Depths,
    lane::{Board, Side, Windows, fits},
    order::{Packer, packed, rects_of, search, sides_of, ways_of},
    placed::Placed,
    placed::{Crossings, Jump, Seat},
    problem::{Filled, Problem},
    rect::Rect,
    request::{Order, Request},
    size::{SHRINK_STEPS, Sizes},
};

/// The number of overlays that look for a better place in a call, times the number of all: the others have their turn in the next calls.
/// At most [`MOST_RETURNS`].
const RETURNS: usize = 200;

/// See [`RETURNS`].
const MOST_RETURNS: usize = 4;

/// The factor by which the second of two neighbours in the order of distance must be nearer to come first.
const NEARER: f64 = 0.95;

/// A frame, made from the one before.
#[derive(Clone, Debug)]
pub struct Kept {
    /// The place of each overlay.
    pub filled: Filled,
    /// The rectangle of each overlay.
    pub rects: Vec<Option<Rect>>,
    /// The ways of the lines of each.
    pub ways: Vec<Vec<Way>>,
    /// The crossings of their lines.
    pub crossings: Crossings,
    /// The sides along which they are still on their way.
    pub gliding: Vec<Side>,
    /// Whether nothing would change without a change of the request.
    pub settled: bool,
    /// Why some moved further than they glide.
    pub jump: Option<Jump>,
    /// Crossings beyond the dead band for which no better order was found.
    pub hopeless: u32,
    /// The overlays that have had a turn.
    pub turns: Turns,
    /// Whether the number of crossings is the least; `None` if it was not asked.
    pub is_least: Option<bool>,
}

/// Overlays that wait for a place, or for a better one, have their turns one after another: to look for one takes time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turns {
    /// The id of the last that had its turn.
    pub last: Option<u32>,
    /// The number that had a turn since the request, or a place, has changed.
    pub tried: usize,
}

/// The frame after `before`; `None` if too much is new to keep it.
pub fn keep(problem: &Problem, before: &Placed, focused: Option<usize>) -> Option<Kept> {
    let layout = &problem.request.layout;
    let old = &before.request;
    let fixed = |request: &Request| {
        let layout = &request.layout;
        (request.picture, layout.arrangement, layout.margin, layout.gap)
    };
    if fixed(old) != fixed(problem.request) {
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
        sizes: kept_sizes(problem, &held, &seats, before, dead_band),
        lanes: Vec::new(),
        rows: Vec::new(),
        inward: Vec::new(),
        folded: Vec::new(),
    };
    filled.lanes = problem.lanes(&filled.sizes);
    filled.rows = rows(problem, &filled, &seats)?;
    let old_rows: Vec<(Side, Vec<usize>)> = filled.lanes.iter().map(|l| l.side).zip(filled.rows.clone()).collect();
    rearrange(problem, &mut filled);
    for (i, seat) in seats.iter().enumerate() {
        if let (Some(Seat::Inward(side)), Some(rect)) = (seat, held[i]) {
            let size = filled.sizes[i];
            let is_good = rect.size() == size && problem.board.is_free(&rect);
            let is_helpless = || {
                before.covers(problem.overlays[i].id)
                    && !problem.board.is_blocked(&rect)
                    && problem.place_inward(&problem.board, i, size, &[], &mut Depths::default()).is_none()
            };
            if is_good || is_helpless() {
                filled.inward.push((i, *side, rect));
            }
        }
    }
    let mut ideal = fit(problem, &mut filled, &held, focused)?;
    if filled.step > 0
        && before.gliding.is_empty()
        && let Some((grown, rects)) = grown(problem, &filled, &held, dead_band, focused)
    {
        (filled, ideal) = (grown, rects);
    }
    let mut turns = Turns { last: before.turn, tried: if old == problem.request { before.tried } else { 0 } };
    let come = come(problem, before, &mut turns, &mut filled, &mut ideal, dead_band, focused)?;
    let was_gliding = &before.gliding;
    let advance = |filled: &Filled, ideal: &[Option<Rect>]| {
        Advance { problem, filled, held: &held, ideal, was_gliding }.rects(&old_rows)
    };
    let (mut rects, mut gliding) = advance(&filled, &ideal);
    let mut ways = all_ways(problem, &filled, &rects);
    let mut counted = count(&rects, &ways);
    let (mut hopeless, mut is_least, mut has_order) = (0, None, false);
    if layout.order == Order::Anchors {
        let deep = deep_crossings(&ways, &rects, &counted, dead_band);
        // What was not found is looked for again when it is worse by an eighth, or when it has been less by half.
        hopeless = if deep * 2 < before.hopeless { deep } else { before.hopeless };
        if deep > hopeless {
            let packer = Packer::new(problem, &filled, problem.board.clearance, focused, true);
            let ordered = search(&packer, true)?;
            let other = Filled { rows: ordered.rows, inward: ordered.inward, ..filled.clone() };
            let other_ideal = packed(problem, &other, focused)?;
            let (other_rects, other_gliding) = advance(&other, &other_ideal);
            // Less crossings than those that stay even if their places move by the dead band: so that soon after they do not change back.
            let other_ways = all_ways(problem, &other, &other_rects);
            let other_counted = count(&other_rects, &other_ways);
            let crossings = other_counted.crossings.sum();
            if crossings >= deep {
                hopeless = deep + deep / 8;
            } else if crossings < stood(problem, &held, &seats) {
                is_least = Some(ordered.is_least && other_rects == other_ideal);
                (filled, rects, gliding) = (other, other_rects, other_gliding);
                (ways, counted) = (other_ways, other_counted);
                (has_order, hopeless) = (true, 0);
            }
        }
    }
    let has_rows = filled.rows.iter().zip(&old_rows).any(|(new, old)| *new != old.1);
    let has_moved = rects != held || has_rows || filled.step != before.step || hopeless != before.hopeless;
    let jump = (has_order || leaps(problem, &held, &rects)).then(|| {
        let is_reordered = has_order || layout.order != Order::Anchors && has_rows;
        let causes = [(come.any, Jump::Came), (is_reordered, Jump::Order), (filled.step != before.step, Jump::Size)];
        causes.into_iter().find(|cause| cause.0).map_or(Jump::Room, |cause| cause.1)
    });
    turns.tried = if has_moved { 0 } else { turns.tried };
    let settled = !has_moved && was_gliding.is_empty() && gliding.is_empty() && turns.tried >= come.waiting;
    let crossings = counted.crossings;
    Some(Kept { filled, rects, ways, crossings, gliding, settled, jump, hopeless, turns, is_least })
}

/// The dead band, pixels, finite.
pub fn dead_band(problem: &Problem) -> f64 {
    let band = problem.request.layout.dead_band;
    if band.is_nan() { 0.0 } else { band.clamp(0.0, 1e6) }
}

/// The sizes after the steps of before; those of before where they differ by no more than the dead band and are not on their way.
fn kept_sizes(
    problem: &Problem,
    held: &[Option<Rect>],
    seats: &[Option<Seat>],
    before: &Placed,
    dead_band: f64,
) -> Vec<[i32; 2]> {
    let kept = |(i, sizes): (usize, &Sizes)| {
        let new = sizes.shrunk(before.step);
        let is_gliding = seats[i].is_some_and(|seat| before.gliding.contains(&seat.side()));
        let band = if is_gliding { 0.0 } else { dead_band };
        let near = |old: [i32; 2]| (0..2).all(|i| f64::from((old[i] - new[i]).abs()) <= band && old[i] >= sizes.min[i]);
        held[i].map(|r| r.size()).filter(|old| near(*old)).unwrap_or(new)
    };
    problem.sizes.iter().enumerate().map(kept).collect()
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

/// Rows that do not go by anchors, in their order.
fn rearrange(problem: &Problem, filled: &mut Filled) {
    let factor = match problem.request.layout.order {
        Order::Anchors => return,
        Order::Distance => NEARER,
        Order::Priority | Order::Id => 1.0,
    };
    for (row, lane) in filled.rows.iter_mut().zip(&filled.lanes) {
        // Sorting by neighbours; each passes another at most once.
        for end in (1..row.len()).rev() {
            for n in 0..end {
                let (first, second) = (problem.key(row[n], lane.side), problem.key(row[n + 1], lane.side));
                if second < first * factor {
                    row.swap(n, n + 1);
                }
            }
        }
    }
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
    let waits = |i: usize| held[i].is_none() && !problem.is_too_large(i);
    if !filled.inward.is_empty() || (0..held.len()).any(waits) {
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

/// The result of [`come`].
struct Come {
    /// Whether an overlay has found a place, or a better one.
    any: bool,
    /// The number that wait for one, of those that are not too large for the picture.
    waiting: usize,
}

/// Finds places for what has none: new overlays, those that were folded, those further inward whose place is taken; and brings those further inward back to a
/// lane. `None` if a new overlay has no place, but one of lower priority has, and none of its size.
fn come(
    problem: &Problem,
    before: &Placed,
    turns: &mut Turns,
    filled: &mut Filled,
    ideal: &mut Vec<Option<Rect>>,
    dead_band: f64,
    focused: Option<usize>,
) -> Option<Come> {
    let mut any = false;
    let mut is_inward = vec![false; ideal.len()];
    filled.inward.iter().for_each(|f| is_inward[f.0] = true);
    let (too_large, waiting): (Vec<usize>, Vec<usize>) =
        (0..ideal.len()).filter(|&i| ideal[i].is_none() || is_inward[i]).partition(|i| problem.is_too_large(*i));
    let most = (RETURNS / ideal.len().max(1)).clamp(1, MOST_RETURNS);
    let last = turns.last.and_then(|id| problem.overlays.iter().position(|o| o.id == id));
    let first = last.map_or(0, |last| waiting.partition_point(|i| *i <= last)) % waiting.len().max(1);
    let has_turn = |n: usize| (n + waiting.len() - first) % waiting.len() < most;
    if !waiting.is_empty() {
        let had = most.min(waiting.len());
        turns.tried += had;
        turns.last = Some(problem.overlays[waiting[(first + had - 1) % waiting.len()]].id);
    }
    let mut folded = too_large;
    let mut depths = Depths::default();
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
                (*filled, *ideal, any) = (with, rects, true);
                depths = Depths::default();
                continue;
            }
        }
        if is_inward[item] {
            continue;
        }
        let obstacles: Vec<Rect> = ideal.iter().flatten().copied().collect();
        let place = if was_folded {
            let board = Board { clearance: problem.board.clearance + dead_band, ..problem.board.clone() };
            problem.place_inward(&board, item, filled.sizes[item], &obstacles, &mut Depths::default())
        } else {
            problem.place_inward(&problem.board, item, filled.sizes[item], &obstacles, &mut depths)
        };
        match place {
            Some((side, rect)) => {
                filled.inward.push((item, side, rect));
                ideal[item] = Some(rect);
                any = true;
            }
            None if was_folded => folded.push(item),
            None => {
                // At the cost of one that is less important: the least important of those further inward of its size, or all anew.
                let is_less = |i: usize| problem.rank(i) < problem.rank(item);
                let other = filled.inward.iter().enumerate().filter(|(_, f)| is_less(f.0));
                let other = other.filter(|(_, f)| filled.sizes[f.0] == filled.sizes[item]).max_by_key(|(_, f)| f.0);
                match other.map(|(n, _)| n) {
                    Some(n) => {
                        let (loser, side, rect) = filled.inward[n];
                        filled.inward[n] = (item, side, rect);
                        (ideal[item], ideal[loser], any) = (Some(rect), None, true);
                        folded.push(loser);
                    }
                    None if (0..ideal.len()).any(|i| ideal[i].is_some() && is_less(i)) => return None,
                    None => folded.push(item),
                }
            }
        }
    }
    folded.sort_unstable();
    filled.folded = folded;
    Some(Come { any, waiting: waiting.len() })
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
        if filled.sizes[item][d] > inner[d] || length - board.gap > lane.span.length() {
            return None;
        }
        let mut of_size: Vec<([i32; 2], Windows)> = Vec::new();
        for size in row.iter().map(|i| filled.sizes[*i]) {
            if !of_size.iter().any(|(known, _)| *known == size) {
                of_size.push((size, board.windows(lane.side, 0, size, lane.span, &obstacles)));
            }
        }
        let windows =
            |size: [i32; 2]| of_size.iter().find(|(known, _)| *known == size).map_or(&[][..], |(_, w)| &w[..]);
        let seats = row.iter().map(|i| (windows(filled.sizes[*i]), filled.sizes[*i][a]));
        fits(seats, board.gap).then_some((k, at))
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

/// The crossings if all stood where they stood before.
fn stood(problem: &Problem, held: &[Option<Rect>], seats: &[Option<Seat>]) -> u32 {
    let ways = |i: usize| Some(ways_of(problem, i, &held[i]?, seats[i]?.side()));
    count(held, &(0..held.len()).map(|i| ways(i).unwrap_or_default()).collect::<Vec<_>>()).crossings.sum()
}

/// Crossings that stay when all lines end before their focus by the dead band; `all`: those that there are.
fn deep_crossings(ways: &[Vec<Way>], rects: &[Option<Rect>], all: &Counted, dead_band: f64) -> u32 {
    if dead_band == 0.0 {
        return all.crossings.sum();
    }
    let shortened: Vec<Option<Way>> = ways.iter().flatten().map(|way| way.shortened(dead_band)).collect();
    // Of each its segments less the last, which alone has become shorter: where they met something they still do.
    let whole: Vec<u32> = shortened.iter().map(|way| way.as_ref().map_or(0, |w| w.points().len() as u32 - 2)).collect();
    let is_whole = |s: &Segment| s.number < whole[s.line as usize];
    let short = |s: &Segment| shortened[s.line as usize].as_ref();
    let do_cross = |[a, b]: &[Segment; 2]| {
        is_whole(a) & is_whole(b) || short(a).zip(short(b)).is_some_and(|(way, other)| way.crosses(other))
    };
    let does_pass = |(s, i): &(Segment, usize)| {
        is_whole(s) || short(s).zip(rects[*i].as_ref()).is_some_and(|(way, rect)| way.crosses_overlay(rect))
    };
    let lines = all.lines.iter().filter(|both| do_cross(both)).count();
    (lines + all.overlays.iter().filter(|one| does_pass(one)).count()) as u32
}

/// Whether an overlay moved further than it glides.
fn leaps(problem: &Problem, held: &[Option<Rect>], rects: &[Option<Rect>]) -> bool {
    let glide = glide(problem);
    held.iter().zip(rects).any(|(h, r)| h.zip(*r).is_some_and(|(h, r)| f64::from(h.distance(&r)) > glide))
}

/// The distance that overlays glide per call, pixels, 1 and up.
fn glide(problem: &Problem) -> f64 {
    let glide = problem.request.layout.glide;
    if glide.is_nan() { 1.0 } else { glide.max(1.0) }
}

/// On the way from those `held` to those that are best.
struct Advance<'a> {
    problem: &'a Problem<'a>,
    filled: &'a Filled,
    held: &'a [Option<Rect>],
    ideal: &'a [Option<Rect>],
    was_gliding: &'a [Side],
}

impl Advance<'_> {
    /// The rectangles of this frame, and the sides that are still on their way. Lanes whose row is not that of before are where they are best at once.
    fn rects(&self, old_rows: &[(Side, Vec<usize>)]) -> (Vec<Option<Rect>>, Vec<Side>) {
        let mut rects = self.ideal.to_vec();
        let mut gliding = Vec::new();
        let is_old = |k: usize| {
            let old = old_rows.iter().find(|old| old.0 == self.filled.lanes[k].side);
            // Those that have gone leave room, no more.
            old.is_some_and(|old| old.1.iter().filter(|i| self.filled.rows[k].contains(i)).eq(&self.filled.rows[k]))
        };
        let packer = Packer::new(self.problem, self.filled, self.problem.board.clearance, None, false);
        for k in (0..self.filled.rows.len()).filter(|k| is_old(*k)) {
            let Some((row, is_gliding)) = self.row(k, &packer) else { continue };
            self.filled.rows[k].iter().zip(row).for_each(|(i, rect)| rects[*i] = Some(rect));
            gliding.extend(is_gliding.then_some(self.filled.lanes[k].side));
        }
        // Lanes do not meet, other than while they grow or shrink.
        let mut all: Vec<Rect> = rects.iter().flatten().copied().collect();
        all.sort_unstable_by_key(|rect| rect.min[1]);
        let gap = self.problem.board.gap;
        let meets_next = |n: usize, a: &Rect| {
            let mut next = all[n + 1..].iter().take_while(|b| b.min[1] < a.max[1].saturating_add(gap));
            next.any(|b| a.within(b, gap))
        };
        if all.iter().enumerate().any(|(n, a)| meets_next(n, a)) {
            return (self.ideal.to_vec(), Vec::new());
        }
        (rects, gliding)
    }

    /// Those of lane `k`, in the order of its row, and whether they are still on their way; `None`: where they are best.
    fn row(&self, k: usize, packer: &Packer) -> Option<(Vec<Rect>, bool)> {
        let row = &self.filled.rows[k];
        let side = self.filled.lanes[k].side;
        let held: Vec<Rect> = row.iter().map(|i| self.held[*i]).collect::<Option<_>>()?;
        let ideal: Vec<Rect> = row.iter().map(|i| self.ideal[*i]).collect::<Option<_>>()?;
        let left = |rects: &[Rect]| rects.iter().zip(&ideal).map(|(r, i)| r.distance(i)).max().unwrap_or(0);
        let furthest = left(&held);
        let is_gliding = self.was_gliding.contains(&side) || f64::from(furthest) > dead_band(self.problem);
        let share = if is_gliding { glide(self.problem) / f64::from(furthest.max(1)) } else { 0.0 };
        if furthest == 0 || share >= 1.0 {
            return None;
        }
        let next: Vec<Rect> = held.iter().zip(&ideal).map(|(h, i)| h.towards(i, share)).collect();
        let board = &self.problem.board;
        let is_good = |(rect, ideal): (&Rect, &Rect)| {
            rect == ideal
                || board.inner.holds(rect) && !board.is_blocked(rect) && board.covered(rect) <= board.covered(ideal)
        };
        if next.iter().zip(&ideal).all(is_good) {
            return Some((next, is_gliding));
        }
        // A point is in the way, or what is blocked: as near as can be.
        let starts: Vec<i32> = next.iter().map(|r| r.min[side.along_axis()]).collect();
        let pushed = packer.row_near(k, row, &starts)?;
        // On a way around a point they could stand for ever.
        let goes_on = !is_gliding || left(&pushed) < furthest;
        goes_on.then_some((pushed, is_gliding))
    }
}
