//! The order on the lanes that makes least lines cross.
//!
//! For overlays of one size with one line each, the order of least total length has no crossing, where lines are straight: if two cross, the overlays change
//! places, and both lines together become shorter, so this ends. It is how the search begins. Where overlays differ in size, have many lines or lines with
//! bends, crossings may remain: then any two overlays change places, and any one moves to another place of the lanes, as long as less crossings are left.
//! If there still are some and overlays are few ([`crate::overlay::request::Layout::proven`]), all orders are tried: what remains is the least number for these rows.
//! For more overlays what is left is counted, and may not be the least.
//!
//! A change costs O(n) for each overlay whose place it changes; the counts of all pairs are kept.

use std::cell::Cell;

use crate::overlay::{
    crossings::{Way, between},
    grid::count,
    lane::{Seat, Side, Windows, pack, wishes},
    line::way,
    problem::{Filled, Lane, Problem},
    rect::Rect,
    request::Order,
};

/// Pairs of overlays whose lines are looked at before the search gives up; curves count as much more as they have segments. About 10 ms.
const MOST_WORK: usize = 200_000;

/// The same with a frame before.
const KEPT_WORK: usize = 20_000;

/// The most overlays for which all orders are tried.
pub const MOST_PROVEN: usize = 9;

/// The same with a frame before.
const KEPT_PROVEN: usize = 5;

/// Stands for a lane where an overlay is further inward.
const INWARD: usize = usize::MAX;

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Ordered {
    /// The overlays on each lane.
    pub rows: Vec<Vec<usize>>,
    /// Those further inward: the same places.
    pub inward: Vec<(usize, Side, Rect)>,
    /// Crossings of lines with lines and overlays.
    pub crossings: u32,
    /// Whether no other order of these rows has less.
    pub is_least: bool,
}

/// Packs rows of overlays.
pub struct Packer<'a> {
    problem: &'a Problem<'a>,
    filled: &'a Filled,
    /// By lane and overlay, where it can stand.
    windows: Vec<Vec<Windows>>,
    focused: Option<usize>,
    /// By overlay, where it would rather begin than where the layout wants it.
    wishes: Vec<Option<i32>>,
}

impl<'a> Packer<'a> {
    /// Overlays keep out of the way of those further inward. `clearance` is that of points, pixels. Each overlay has windows on its own lane, and on the
    /// others only if it may `change` lanes.
    pub fn new(
        problem: &'a Problem<'a>,
        filled: &'a Filled,
        clearance: f64,
        focused: Option<usize>,
        change: bool,
    ) -> Self {
        let obstacles: Vec<Rect> = filled.inward.iter().map(|i| i.2).collect();
        let mut all: Vec<usize> =
            filled.rows.iter().flatten().copied().chain(filled.inward.iter().map(|i| i.0)).collect();
        all.sort_unstable();
        let of_lane = |(lane, row): (&Lane, &Vec<usize>)| {
            let board = problem.board.beside(lane.side, clearance, &filled.sizes);
            let mut windows = vec![Windows::new(); filled.sizes.len()];
            let mut last: Option<usize> = None;
            for &i in if change { &all } else { row } {
                let size = filled.sizes[i];
                windows[i] = match last.filter(|j| filled.sizes[*j] == size) {
                    Some(j) => windows[j].clone(),
                    None => board.windows(lane.side, 0, size, lane.span, &obstacles),
                };
                last = Some(i);
            }
            windows
        };
        let windows = filled.lanes.iter().zip(&filled.rows).map(of_lane).collect();
        Self { problem, filled, windows, focused, wishes: vec![None; filled.sizes.len()] }
    }

    /// Keeps overlays in the window that they stand in, at `rects`, and those that no more stand in one as near as can be: so they glide to where they
    /// are packed without covering a point.
    pub fn hold(&mut self, rects: &[Option<Rect>]) {
        for (k, (lane, row)) in self.filled.lanes.iter().zip(&self.filled.rows).enumerate() {
            for &i in row {
                let Some(at) = rects[i].map(|r| r.min[lane.side.along_axis()]) else { continue };
                let windows = &mut self.windows[k][i];
                match windows.iter().find(|w| (w.0..=w.1).contains(&at)) {
                    Some(&window) => *windows = vec![window],
                    None => self.wishes[i] = Some(at),
                }
            }
        }
    }

    /// The rectangles of a row; `None` if it does not fit.
    pub fn row(&self, k: usize, row: &[usize]) -> Option<Vec<Rect>> {
        let lane = self.filled.lanes[k];
        let (a, board) = (lane.side.along_axis(), &self.problem.board);
        let lengths: Vec<i32> = row.iter().map(|i| self.filled.sizes[*i][a]).collect();
        let anchors: Vec<f64> = row.iter().map(|i| self.problem.wish[*i][a]).collect();
        let focused = self.focused.and_then(|f| row.iter().position(|i| *i == f));
        let mut wishes = wishes(self.problem.request.layout.along, lane.span, &lengths, &anchors, board.gap, focused);
        wishes.iter_mut().zip(row).for_each(|(wish, i)| *wish = self.wishes[*i].unwrap_or(*wish));
        self.row_near(k, row, &wishes)
    }

    /// The rectangles of a row whose overlays begin as near to `wishes` (pixels along the side) as can be; `None` if it does not fit.
    pub fn row_near(&self, k: usize, row: &[usize], wishes: &[i32]) -> Option<Vec<Rect>> {
        let lane = self.filled.lanes[k];
        let (a, board) = (lane.side.along_axis(), &self.problem.board);
        let lengths: Vec<i32> = row.iter().map(|i| self.filled.sizes[*i][a]).collect();
        let seat =
            |(n, i): (usize, &usize)| Seat { windows: &self.windows[k][*i], length: lengths[n], wish: wishes[n] };
        let seats: Vec<Seat> = row.iter().enumerate().map(seat).collect();
        let places = pack(&seats, board.gap)?;
        Some(places.iter().zip(row).map(|(at, i)| board.rect(lane.side, *at, 0, self.filled.sizes[*i])).collect())
    }
}

/// The rectangle of each overlay that has one; `None` if a row does not fit.
pub fn packed(problem: &Problem, filled: &Filled, focused: Option<usize>) -> Option<Vec<Option<Rect>>> {
    rects_of(&Packer::new(problem, filled, problem.board.clearance, focused, false))
}

/// The rectangle of each overlay, with rows packed by `packer`.
pub fn rects_of(packer: &Packer) -> Option<Vec<Option<Rect>>> {
    let filled = packer.filled;
    let mut rects = vec![None; filled.sizes.len()];
    for (k, row) in filled.rows.iter().enumerate() {
        for (i, rect) in row.iter().zip(packer.row(k, row)?) {
            rects[*i] = Some(rect);
        }
    }
    filled.inward.iter().for_each(|(i, _, rect)| rects[*i] = Some(*rect));
    Some(rects)
}

/// The side that each overlay stands on.
pub fn sides_of(filled: &Filled) -> Vec<Option<Side>> {
    let mut sides = vec![None; filled.sizes.len()];
    for (lane, row) in filled.lanes.iter().zip(&filled.rows) {
        row.iter().for_each(|i| sides[*i] = Some(lane.side));
    }
    filled.inward.iter().for_each(|(i, side, _)| sides[*i] = Some(*side));
    sides
}

/// The ways of the lines of an overlay.
pub fn ways_of(problem: &Problem, item: usize, rect: &Rect, side: Side) -> Vec<Way> {
    problem.targets[item]
        .iter()
        .filter_map(|(target, _)| way(rect, side, target, problem.overlays[item].lines))
        .collect()
}

/// One state of the search.
struct State<'p, 'a> {
    packer: &'p Packer<'a>,
    rows: Vec<Vec<usize>>,
    inward: Vec<(usize, Side, Rect)>,
    rects: Vec<Option<Rect>>,
    ways: Vec<Vec<Way>>,
    /// Crossings of each pair, both ways round.
    counts: Vec<Vec<u32>>,
    crossings: u32,
    /// Pairs that were looked at so far.
    work: Cell<usize>,
}

/// Where an overlay stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Stand {
    item: usize,
    /// The lane; [`INWARD`] for one further inward.
    lane: usize,
    /// The number in the row, or among those further inward.
    number: usize,
}

/// A change to try for one overlay.
#[derive(Clone, Copy)]
enum Change {
    /// It changes places with another.
    Swap(Stand),
    /// It moves to a place of a lane.
    Move { lane: usize, number: usize },
}

/// A change of rows that was looked at.
struct Trial {
    rows: Vec<(usize, Vec<usize>)>,
    /// Those further inward that change: the number there, and the overlay.
    inward: Vec<(usize, usize)>,
    /// Overlay, new rectangle, new ways.
    moved: Vec<(usize, Rect, Vec<Way>)>,
    crossings: u32,
    /// The change of the length of all lines together, lattice steps; positive: longer.
    longer: f64,
}

impl<'p, 'a> State<'p, 'a> {
    fn new(packer: &'p Packer<'a>) -> Option<Self> {
        let filled = packer.filled;
        let rects = rects_of(packer)?;
        let sides = sides_of(filled);
        let n = rects.len();
        let ways: Vec<Vec<Way>> = (0..n)
            .map(|i| rects[i].zip(sides[i]).map_or(Vec::new(), |(rect, side)| ways_of(packer.problem, i, &rect, side)))
            .collect();
        let counted = count(&rects, &ways);
        let mut counts = vec![vec![0; n]; n];
        for [i, j] in counted.pairs() {
            counts[i][j] += 1;
            counts[j][i] += 1;
        }
        Some(Self {
            packer,
            rows: filled.rows.clone(),
            inward: filled.inward.clone(),
            rects,
            ways,
            counts,
            crossings: counted.crossings.sum(),
            work: Cell::new(0),
        })
    }

    /// Looks at rows `k` made anew, and at others in places further inward; `None` if a row does not fit.
    fn look(&self, rows: Vec<(usize, Vec<usize>)>, inward: Vec<(usize, usize)>) -> Option<Trial> {
        let problem = self.packer.problem;
        let mut placed: Vec<(usize, Side, Rect)> =
            inward.iter().map(|(n, i)| (*i, self.inward[*n].1, self.inward[*n].2)).collect();
        for (k, row) in &rows {
            let side = self.packer.filled.lanes[*k].side;
            placed.extend(row.iter().zip(self.packer.row(*k, row)?).map(|(i, rect)| (*i, side, rect)));
        }
        let mut moved = Vec::new();
        let mut longer = 0.0;
        for (i, side, rect) in placed {
            if self.rects[i] != Some(rect) {
                let ways = ways_of(problem, i, &rect, side);
                longer += ways.iter().map(Way::length).sum::<f64>() - self.ways[i].iter().map(Way::length).sum::<f64>();
                moved.push((i, rect, ways));
            }
        }
        let segments: usize = moved.iter().flat_map(|m| &m.2).map(|way| way.points().len() - 1).sum();
        self.work.set(self.work.get() + (segments + moved.len()) * self.rects.len());
        let (mut before, mut after) = (0, 0);
        for (n, (i, rect, ways)) in moved.iter().enumerate() {
            for j in 0..self.rects.len() {
                let later = moved[n..].iter().any(|m| m.0 == j);
                let Some(other) = self.rects[j].filter(|_| !later) else { continue };
                match moved[..n].iter().find(|m| m.0 == j) {
                    Some((_, other, other_ways)) => after += between(rect, ways, other, other_ways),
                    None => after += between(rect, ways, &other, &self.ways[j]),
                }
                before += self.counts[*i][j];
            }
        }
        Some(Trial { rows, inward, moved, crossings: self.crossings + after - before, longer })
    }

    fn take(&mut self, trial: Trial) {
        for (k, row) in trial.rows {
            self.rows[k] = row;
        }
        for (n, item) in trial.inward {
            self.inward[n].0 = item;
        }
        let moved: Vec<usize> = trial.moved.iter().map(|m| m.0).collect();
        for (i, rect, ways) in trial.moved {
            (self.rects[i], self.ways[i]) = (Some(rect), ways);
        }
        for i in moved {
            for j in 0..self.rects.len() {
                if let (Some(a), Some(b)) = (self.rects[i], self.rects[j].filter(|_| j != i)) {
                    let count = between(&a, &self.ways[i], &b, &self.ways[j]);
                    (self.counts[i][j], self.counts[j][i]) = (count, count);
                }
            }
        }
        self.crossings = trial.crossings;
    }

    /// Where each overlay stands.
    fn places(&self) -> Vec<Stand> {
        let of_row = |(lane, row): (usize, &Vec<usize>)| {
            row.iter().enumerate().map(|(number, &item)| Stand { item, lane, number }).collect::<Vec<_>>()
        };
        let mut places: Vec<_> = self.rows.iter().enumerate().flat_map(of_row).collect();
        let inward = self.inward.iter().enumerate();
        places.extend(inward.map(|(number, &(item, ..))| Stand { item, lane: INWARD, number }));
        places.sort_unstable();
        places
    }

    /// Two overlays change places; further inward only those of one size can.
    fn swapped(&self, one: Stand, other: Stand) -> Option<Trial> {
        let Stand { item: i, lane: k, number: m } = one;
        let Stand { item: j, lane: l, number: n } = other;
        let sizes = &self.packer.filled.sizes;
        if (k == INWARD || l == INWARD) && sizes[i] != sizes[j] {
            return None;
        }
        let with = |k: usize, m: usize, item: usize| {
            let mut row = self.rows[k].clone();
            row[m] = item;
            vec![(k, row)]
        };
        match (k == INWARD, l == INWARD) {
            (true, true) => self.look(Vec::new(), vec![(m, j), (n, i)]),
            (true, false) => self.look(with(l, n, i), vec![(m, j)]),
            (false, true) => self.look(with(k, m, j), vec![(n, i)]),
            (false, false) if k == l => {
                let mut row = self.rows[k].clone();
                row.swap(m, n);
                self.look(vec![(k, row)], Vec::new())
            }
            (false, false) => self.look([with(k, m, j), with(l, n, i)].concat(), Vec::new()),
        }
    }

    /// An overlay of a lane moves to place `n` of lane `l`.
    fn moved(&self, from: Stand, l: usize, n: usize) -> Option<Trial> {
        let Stand { item, lane: k, number: m } = from;
        if k == INWARD {
            return None;
        }
        let mut first = self.rows[k].clone();
        first.remove(m);
        if k == l {
            first.insert(n.min(first.len()), item);
            return self.look(vec![(k, first)], Vec::new());
        }
        let mut second = self.rows[l].clone();
        second.insert(n.min(second.len()), item);
        self.look(vec![(k, first), (l, second)], Vec::new())
    }

    /// Overlays whose lines cross change places as long as that makes the lines shorter.
    fn uncross(&mut self, work: usize) {
        let mut again = true;
        while again && self.crossings > 0 {
            again = false;
            let places = self.places();
            'pairs: for (a, first) in places.iter().enumerate() {
                for second in &places[a + 1..] {
                    if self.counts[first.item][second.item] == 0 {
                        continue;
                    }
                    if self.work.get() > work {
                        return;
                    }
                    if let Some(trial) = self.swapped(*first, *second).filter(|t| t.longer < -0.5) {
                        self.take(trial);
                        again = true;
                        // The places are those of before for these two: begin anew after this row of pairs.
                        break 'pairs;
                    }
                }
            }
        }
    }

    /// Overlays change places, or one moves, as long as less lines cross.
    fn improve(&mut self, work: usize) {
        let mut again = true;
        while again && self.crossings > 0 {
            again = false;
            let places = self.places();
            let troubled = |i: usize| self.counts[i].iter().any(|c| *c > 0);
            let mut best: Option<Trial> = None;
            'all: for first in places.iter().filter(|p| troubled(p.item)) {
                let swaps = places.iter().filter(|p| p.item != first.item).map(|p| Change::Swap(*p));
                let gaps = self.rows.iter().enumerate();
                let moves =
                    gaps.flat_map(|(lane, row)| (0..=row.len()).map(move |number| Change::Move { lane, number }));
                for change in swaps.chain(moves) {
                    if self.work.get() > work {
                        break 'all;
                    }
                    let trial = match change {
                        Change::Swap(other) => self.swapped(*first, other),
                        Change::Move { lane, number } => self.moved(*first, lane, number),
                    };
                    let Some(trial) = trial.filter(|t| t.crossings < self.crossings) else { continue };
                    let is_better = |b: &Trial| (trial.crossings, trial.longer) < (b.crossings, b.longer);
                    if best.as_ref().is_none_or(is_better) {
                        best = Some(trial);
                    }
                }
            }
            if let Some(best) = best {
                self.take(best);
                again = true;
            }
        }
    }
}

/// Tries all orders of the overlays on the lanes, with as many on each lane as now, and gives the first of those with least crossings, if less than `below`:
/// the lowest, or if the order is kept the one that begins most like it.
fn try_all(packer: &Packer, state: &State, below: u32, is_kept: bool) -> Option<(Vec<Vec<usize>>, u32)> {
    let mut items: Vec<usize> = state.rows.concat();
    if !is_kept {
        items.sort_unstable();
    }
    let mut search = Exhaustive {
        packer,
        lengths: state.rows.iter().map(Vec::len).collect(),
        inward: Vec::new(),
        best: None,
        below,
    };
    search.inward = state.inward.iter().map(|(i, _, rect)| (*rect, state.ways[*i].clone())).collect();
    let fixed = pairs(&search.inward, 0, u32::MAX);
    let mut rows = Vec::new();
    search.rows(&mut items, &mut rows, &mut Vec::new(), fixed);
    search.best.map(|rows| (rows, search.below))
}

/// Crossings among `all`, of those from number `from` on with one another and those before them; what is `most` or more is not counted on.
fn pairs(all: &[(Rect, Vec<Way>)], from: usize, most: u32) -> u32 {
    let mut sum = 0;
    for i in from..all.len() {
        for j in 0..i {
            sum += between(&all[i].0, &all[i].1, &all[j].0, &all[j].1);
            if sum >= most {
                return sum;
            }
        }
    }
    sum
}

struct Exhaustive<'p, 'a> {
    packer: &'p Packer<'a>,
    lengths: Vec<usize>,
    inward: Vec<(Rect, Vec<Way>)>,
    best: Option<Vec<Vec<usize>>>,
    below: u32,
}

impl Exhaustive<'_, '_> {
    /// Lane after lane: all orders of what is left for the next one; `placed` are those of the lanes before it, with `crossings` among them.
    fn rows(
        &mut self,
        left: &mut Vec<usize>,
        rows: &mut Vec<Vec<usize>>,
        placed: &mut Vec<(Rect, Vec<Way>)>,
        crossings: u32,
    ) {
        if crossings >= self.below {
            return;
        }
        let k = rows.len();
        if k == self.lengths.len() {
            (self.best, self.below) = (Some(rows.clone()), crossings);
            return;
        }
        let mut row = Vec::with_capacity(self.lengths[k]);
        self.row(left, &mut row, rows, placed, crossings);
    }

    fn row(
        &mut self,
        left: &mut Vec<usize>,
        row: &mut Vec<usize>,
        rows: &mut Vec<Vec<usize>>,
        placed: &mut Vec<(Rect, Vec<Way>)>,
        crossings: u32,
    ) {
        let k = rows.len();
        if row.len() < self.lengths[k] {
            for n in 0..left.len() {
                let item = left.remove(n);
                row.push(item);
                self.row(left, row, rows, placed, crossings);
                row.pop();
                left.insert(n, item);
            }
            return;
        }
        let Some(rects) = self.packer.row(k, row) else { return };
        let side = self.packer.filled.lanes[k].side;
        if placed.is_empty() {
            placed.extend(self.inward.iter().cloned());
        }
        let before = placed.len();
        placed.extend(row.iter().zip(rects).map(|(i, rect)| (rect, ways_of(self.packer.problem, *i, &rect, side))));
        let sum = crossings + pairs(placed, before, self.below - crossings);
        if sum < self.below {
            rows.push(row.clone());
            self.rows(left, rows, placed, sum);
            rows.pop();
        }
        placed.truncate(before);
    }
}

/// Searches for the order of rows with least crossings, beginning with that of `packer`. An order that `is_kept` is that of the frame before: less changes are
/// tried, and all orders only of few overlays.
pub fn search(packer: &Packer, is_kept: bool) -> Option<Ordered> {
    let mut state = State::new(packer)?;
    let layout = &packer.problem.request.layout;
    let count: usize = state.rows.iter().map(Vec::len).sum();
    let mut is_least = state.crossings == 0;
    if layout.order == Order::Anchors && state.crossings > 0 {
        let (work, proven) = if is_kept { (KEPT_WORK, KEPT_PROVEN) } else { (MOST_WORK, MOST_PROVEN) };
        state.uncross(work);
        state.improve(work);
        is_least = state.crossings == 0;
        if !is_least && count <= (layout.proven as usize).min(proven) {
            is_least = true;
            if let Some((rows, crossings)) = try_all(packer, &state, state.crossings, is_kept) {
                (state.rows, state.crossings) = (rows, crossings);
            }
        }
    }
    Some(Ordered { rows: state.rows, inward: state.inward, crossings: state.crossings, is_least })
}
