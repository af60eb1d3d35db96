//! The place of each overlay: on a lane, further inward, or nowhere.
//!
//! Overlays are placed by priority, the higher first. All shrink together, by eighths of the way from the size that they want to their smallest, until the
//! lanes hold all of them; if that is not enough, again until all find a place on the lanes or further inward; at their smallest size, one that finds no place is
//! folded. An overlay stands as little inward as it can: no place in the whole picture is missed, as one that touches nothing could be pushed outwards until
//! it does. With n overlays and p points this takes O(n² + n p) where lanes hold all, and for each overlay that stands
//! further inward a sweep over what is near ([`crate::overlay::inward`]).

use crate::overlay::{
    inward::Depths,
    lane::{Board, Windows, fits},
    problem::{Filled, Lane, Problem},
    rect::Rect,
    size::SHRINK_STEPS,
};

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

/// The cost of a side for an overlay: how far its wish is from the side, as a share of the picture, and half of the share of the lane that is taken.
pub fn unease(problem: &Problem, item: usize, lane: &Lane, row: &[usize], sizes: &[[i32; 2]]) -> f64 {
    let (d, a) = (lane.side.depth_axis(), lane.side.along_axis());
    let extent = |i: usize| f64::from(problem.board.inner.size()[i].max(1));
    let from_first = ((problem.wish[item][d] - f64::from(problem.board.inner.min[d])) / extent(d)).clamp(0.0, 1.0);
    let far = if lane.side.is_first() { from_first } else { 1.0 - from_first };
    let taken: i32 = row.iter().map(|i| sizes[*i][a] + problem.board.gap).sum();
    far + 0.5 * f64::from(taken) / f64::from(lane.span.length().max(1))
}
