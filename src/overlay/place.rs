//! All at once: overlays with a place, lines, markers, and what could not be done.

use glam::DVec2;

use crate::overlay::{
    coherence::{Kept, Turns, all_ways, dead_band, keep},
    crossings::{Way, pixels},
    fill::fill,
    grid::count,
    line::way,
    order::{Packer, packed, search, sides_of},
    placed::{ContextLine, Fact, Jump, Marker, Placed, Placement, Seat},
    problem::{Filled, Problem},
    rect::Rect,
    request::Request,
};

/// Folded overlays whose anchors are nearer to each other than this share a marker, pixels.
pub const MARKER_RADIUS: f64 = 24.0;

/// Places overlays and draws their lines. `before`: what this call gave for the frame before; without it, the result depends on the request alone.
///
/// Overlays keep the gap between each other and the margin to the border, and cover no point that they could avoid. With a frame before they keep still
/// ([`crate::overlay::coherence`]), but never at the price of these promises.
///
/// From nothing O(n² + n p) for n overlays and p points where lanes hold them all, for each that stands further inward a sweep over what is near
/// ([`crate::overlay::inward`]), and a bounded search for the order. With a frame before O(n² + n p), all of it comparisons of boxes.
pub fn place(request: &Request, before: Option<&Placed>) -> Placed {
    if let Some(before) = before.filter(|before| before.settled && before.request == *request) {
        return before.clone();
    }
    let problem = Problem::new(request);
    let focused = focused(&problem, before);
    if let Some(kept) = before.and_then(|before| keep(&problem, before, focused)) {
        return finished(&problem, kept, focused);
    }
    let mut filled = fill(&problem);
    let mut is_least = None;
    // Search of the rows as they were filled fits at least as well as they do.
    if let Some(ordered) = search(&Packer::new(&problem, &filled, problem.board.clearance, focused, true), false) {
        is_least = Some(ordered.is_least);
        (filled.rows, filled.inward) = (ordered.rows, ordered.inward);
    }
    let rects = packed(&problem, &filled, focused).unwrap_or_else(|| vec![None; problem.overlays.len()]);
    let ways = all_ways(&problem, &filled, &rects);
    let crossings = count(&rects, &ways).crossings;
    let turns = Turns::default();
    let jump = Some(Jump::Anew);
    finished(
        &problem,
        Kept {
            filled,
            rects,
            ways,
            crossings,
            gliding: Vec::new(),
            settled: false,
            jump,
            hopeless: 0,
            turns,
            is_least,
        },
        focused,
    )
}

/// Which overlay is in the exploration focus: the nearest to the centre of interest; that of before unless another is nearer by more than the dead band.
fn focused(problem: &Problem, before: Option<&Placed>) -> Option<usize> {
    let centre = problem.request.layout.centre_of_interest.filter(|c| c.is_finite())?;
    let candidates = || (0..problem.overlays.len()).filter(|&i| !problem.targets[i].is_empty());
    let distance = |i: usize| problem.wish[i].distance(centre);
    let nearest = candidates().min_by(|&a, &b| {
        distance(a).total_cmp(&distance(b)).then(problem.overlays[a].id.cmp(&problem.overlays[b].id))
    })?;
    let last = before.and_then(|b| b.focused).and_then(|id| candidates().find(|&i| problem.overlays[i].id == id));
    last.filter(|&last| distance(last) <= distance(nearest) + dead_band(problem)).or(Some(nearest))
}

/// All that is told of a frame.
fn finished(problem: &Problem, kept: Kept, focused: Option<usize>) -> Placed {
    let Kept { filled, rects, ways, crossings, gliding, settled, jump, hopeless, turns, is_least } = kept;
    let mut placed = Placed {
        placements: placements(problem, &filled, &rects),
        folded: (0..rects.len()).filter(|&i| rects[i].is_none()).map(|i| problem.overlays[i].id).collect(),
        markers: markers(problem, &rects),
        lines: Vec::new(),
        crossings,
        is_least: crossings.sum() == 0 || is_least == Some(true),
        facts: Vec::new(),
        gliding,
        settled,
        jump,
        step: filled.step,
        request: problem.request.clone(),
        focused: focused.map(|i| problem.overlays[i].id),
        hopeless,
        turn: turns.last,
        tried: turns.tried,
    };
    placed.folded.sort_unstable();
    let sides = sides_of(&filled);
    let mut by_id: Vec<usize> = (0..rects.len()).collect();
    by_id.sort_by_key(|i| problem.overlays[*i].id);
    let points = Points::new(&problem.request.avoid);
    for i in by_id {
        let id = problem.overlays[i].id;
        // The ways do not tell whose focus has none.
        let all_have_one = ways[i].len() == problem.targets[i].len();
        for (n, (target, anchor)) in problem.targets[i].iter().enumerate() {
            let (Some(rect), Some(side)) = (rects[i], sides[i]) else { break };
            let points = |way: &Way| way.points().iter().map(|p| pixels(*p)).collect();
            let line = match ways[i].get(n).filter(|_| all_have_one) {
                Some(way) => Some(points(way)),
                None => way(&rect, side, target, problem.overlays[i].lines).as_ref().map(points),
            };
            match line {
                Some(points) => placed.lines.push(ContextLine { overlay: id, anchor: *anchor, points }),
                None => placed.facts.push(Fact::OnItsFocus { overlay: id, anchor: *anchor }),
            }
        }
        placed.facts.extend(facts(problem, i, rects[i].as_ref(), &points));
    }
    placed
}

fn placements(problem: &Problem, filled: &Filled, rects: &[Option<Rect>]) -> Vec<Placement> {
    let mut placements = Vec::new();
    let mut add = |i: usize, seat: Seat| {
        placements.extend(rects[i].map(|rect| Placement { id: problem.overlays[i].id, rect, seat }))
    };
    for (lane, row) in filled.lanes.iter().zip(&filled.rows) {
        row.iter().zip(0..).for_each(|(i, n)| add(*i, Seat::Lane(lane.side, n)));
    }
    filled.inward.iter().for_each(|(i, side, _)| add(*i, Seat::Inward(*side)));
    placements.sort_by_key(|p| p.id);
    placements
}

fn markers(problem: &Problem, rects: &[Option<Rect>]) -> Vec<Marker> {
    let mut markers: Vec<Marker> = Vec::new();
    let [width, height] = problem.request.picture.map(f64::from);
    for i in (0..rects.len()).filter(|i| rects[*i].is_none()) {
        let at = problem.wish[i].clamp(DVec2::ZERO, DVec2::new(width, height));
        let id = problem.overlays[i].id;
        match markers.iter_mut().find(|m| m.at.distance(at) < MARKER_RADIUS) {
            Some(marker) => marker.overlays.push(id),
            None => markers.push(Marker { at, overlays: vec![id] }),
        }
    }
    markers.iter_mut().for_each(|m| m.overlays.sort_unstable());
    markers
}

/// Points by their height.
struct Points {
    /// The place, and the number.
    by_height: Vec<(DVec2, usize)>,
}

impl Points {
    /// Those that are finite.
    fn new(points: &[DVec2]) -> Self {
        let mut by_height: Vec<_> =
            points.iter().enumerate().filter(|(_, p)| p.is_finite()).map(|(n, p)| (*p, n)).collect();
        by_height.sort_unstable_by(|a, b| a.0.y.total_cmp(&b.0.y));
        Self { by_height }
    }

    /// The numbers of those that an overlay covers.
    fn covered(&self, rect: &Rect, clearance: f64) -> Vec<usize> {
        let from = self.by_height.partition_point(|p| p.0.y < f64::from(rect.min[1]) - clearance);
        let near = self.by_height[from..].iter().take_while(|p| p.0.y <= f64::from(rect.max[1]) + clearance);
        let mut covered: Vec<usize> = near.filter(|p| rect.covers(p.0, clearance)).map(|p| p.1).collect();
        covered.sort_unstable();
        covered
    }
}

fn facts(problem: &Problem, i: usize, rect: Option<&Rect>, points: &Points) -> Vec<Fact> {
    let overlay = problem.overlays[i].id;
    let mut facts = Vec::new();
    for anchor in 0..problem.overlays[i].anchors.len() {
        if !problem.targets[i].iter().any(|t| t.1 == anchor) {
            facts.push(Fact::NoAnchor { overlay, anchor });
        }
    }
    match rect {
        Some(rect) => {
            let points = points.covered(rect, problem.board.clearance);
            if !points.is_empty() {
                facts.push(Fact::Covers { overlay, points });
            }
        }
        None => {
            facts.push(if problem.is_too_large(i) { Fact::TooLarge { overlay } } else { Fact::NoRoom { overlay } });
        }
    }
    facts
}
