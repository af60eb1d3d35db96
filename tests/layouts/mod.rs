//! What tests of layouts over time share: a walk, and what must hold in each of its frames. Figures are counted.
#![allow(dead_code, reason = "every test binary uses its own part")]

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use veduta::overlay::{
    Fact, Focus, Placed, Rect, Request,
    grid::count,
    lane::Side,
    line::{Target, way},
    place,
    placed::{Crossings, Jump, Seat},
};

/// Frames within which no two overlays change their order back.
pub const FOR_GOOD: usize = 10;

/// What was counted.
#[derive(Debug, Default)]
pub struct Walk {
    /// Frames.
    pub frames: usize,
    /// Frames in which an overlay moved.
    pub moving: usize,
    /// Overlays times frames, and of these those that stand where they stood.
    pub standings: usize,
    /// See `standings`.
    pub still: usize,
    /// Frames with a jump, by its cause.
    pub jumps: BTreeMap<String, usize>,
    /// Pairs that changed their order along a side.
    pub swaps: usize,
    /// Such pairs that changed it back within [`FOR_GOOD`] frames.
    pub swaps_back: usize,
    /// The most crossings of a frame.
    pub crossings: u32,
    /// Overlays times frames that are folded.
    pub folded: usize,
    /// Overlays times frames that cover a point.
    pub covering: usize,
}

/// Lays out one frame after the other, and looks at each.
pub fn walk(frames: impl IntoIterator<Item = Request>) -> Result<Walk, String> {
    let mut walk = Walk::default();
    let mut before: Option<Placed> = None;
    let mut swapped: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (n, asked) in frames.into_iter().enumerate() {
        let placed = place(&asked, before.as_ref());
        look(&asked, &placed).map_err(|e| format!("frame {n}: {e}"))?;
        if let Some(before) = &before {
            step(&mut walk, &mut swapped, n, before, &placed).map_err(|e| format!("frame {n}: {e}"))?;
        }
        walk.frames += 1;
        walk.crossings = walk.crossings.max(placed.crossings.sum());
        walk.folded += placed.folded.len();
        walk.covering += placed.facts.iter().filter(|f| matches!(f, Fact::Covers { .. })).count();
        before = Some(placed);
    }
    Ok(walk)
}

/// What holds in one frame.
fn look(asked: &Request, placed: &Placed) -> Result<(), String> {
    let (margin, gap) = (asked.layout.margin as i32, asked.layout.gap as i32);
    let [width, height] = asked.picture.map(|side| side as i32);
    let too_near = |a: &Rect, b: &Rect| (0..2).all(|i| a.min[i] < b.max[i] + gap && b.min[i] < a.max[i] + gap);
    for (n, a) in placed.placements.iter().enumerate() {
        let [low, high] = [a.rect.min, a.rect.max];
        if low.iter().any(|v| *v < margin) || high[0] > width - margin || high[1] > height - margin {
            return Err(format!("{a:?} is not in the picture"));
        }
        let others = placed.placements[..n].iter().map(|b| &b.rect).chain(&asked.blocked);
        if let Some(b) = others.into_iter().find(|b| too_near(&a.rect, b)) {
            return Err(format!("{a:?} is too near to {b:?}"));
        }
        let c = asked.clearance;
        let is_covered = |p: &DVec2| (0..2).all(|i| f64::from(low[i]) - c < p[i] && p[i] < f64::from(high[i]) + c);
        let told = placed.facts.iter().any(|f| matches!(f, Fact::Covers { overlay, .. } if *overlay == a.id));
        if asked.avoid.iter().any(is_covered) != told {
            return Err(format!("{a:?} covers a point and does not tell, or tells and does not"));
        }
    }
    Ok(())
}

/// What holds from one frame to the next.
fn step(
    walk: &mut Walk,
    swapped: &mut BTreeMap<(u32, u32), usize>,
    n: usize,
    before: &Placed,
    placed: &Placed,
) -> Result<(), String> {
    let asked = &placed.request;
    let old = |id: u32| before.placements.iter().find(|p| p.id == id);
    let mut has_moved = false;
    let mut sides: BTreeMap<Side, (i32, bool)> = BTreeMap::new();
    for new in &placed.placements {
        let Some(old) = old(new.id) else { continue };
        let moved = new.rect.distance(&old.rect);
        walk.standings += 1;
        walk.still += usize::from(moved == 0);
        has_moved |= moved > 0;
        if placed.jump.is_none() && f64::from(moved) > asked.layout.glide {
            return Err(format!("{} moves by {moved} pixels at once, and no jump is told", new.id));
        }
        let side = sides.entry(new.seat.side()).or_default();
        *side = (side.0.max(moved), side.1 || is_pushed(asked, &old.rect));
    }
    for (side, (moved, is_pushed)) in sides {
        // Less than a dead band, or none of them had to.
        let is_on_its_way = before.gliding.contains(&side) || placed.gliding.contains(&side);
        let has_cause = is_on_its_way || is_pushed || placed.jump.is_some();
        if !has_cause && moved > 0 && f64::from(moved) <= asked.layout.dead_band {
            return Err(format!("at {side:?} all could stand still, and one moves by {moved} pixels"));
        }
    }
    walk.moving += usize::from(has_moved);
    if let Some(jump) = placed.jump {
        *walk.jumps.entry(format!("{jump:?}")).or_default() += 1;
    }
    let mut has_swapped = false;
    for (k, a) in placed.placements.iter().enumerate() {
        for b in &placed.placements[..k] {
            let (Some(old_a), Some(old_b)) = (old(a.id), old(b.id)) else { continue };
            let seats = |s: Seat, t: Seat| match (s, t) {
                (Seat::Lane(side, m), Seat::Lane(other, n)) if side == other => Some((side, m < n)),
                _ => None,
            };
            let (Some(now), Some(then)) = (seats(a.seat, b.seat), seats(old_a.seat, old_b.seat)) else { continue };
            if now.0 == then.0 && now.1 != then.1 {
                has_swapped = true;
                walk.swaps += 1;
                let last = swapped.insert((a.id, b.id), n);
                walk.swaps_back += usize::from(last.is_some_and(|last| n - last <= FOR_GOOD));
            }
        }
    }
    if has_swapped
        && placed.jump != Some(Jump::Order)
        && placed.jump != Some(Jump::Anew)
        && placed.jump != Some(Jump::Came)
    {
        return Err(format!("the order along a side changes, and what is told is {:?}", placed.jump));
    }
    if has_swapped && placed.jump == Some(Jump::Order) {
        let kept = crossings_of(asked, before);
        if placed.crossings.sum() >= kept.sum() {
            return Err(format!("another order, and {:?} where there would have been {kept:?}", placed.crossings));
        }
    }
    Ok(())
}

/// Whether an overlay cannot stay here: a point or what is blocked has come.
fn is_pushed(asked: &Request, rect: &Rect) -> bool {
    let gap = asked.layout.gap as i32;
    asked.avoid.iter().any(|p| rect.covers(*p, asked.clearance)) || asked.blocked.iter().any(|b| rect.within(b, gap))
}

/// The crossings if overlays stood where they stood before.
fn crossings_of(asked: &Request, before: &Placed) -> Crossings {
    let mut rects = Vec::new();
    let mut ways = Vec::new();
    for overlay in &asked.overlays {
        let old = before.placements.iter().find(|p| p.id == overlay.id);
        rects.push(old.map(|p| p.rect));
        let of = |focus: &Focus| way(&old?.rect, old?.seat.side(), &Target::new(focus)?, overlay.lines);
        ways.push(overlay.anchors.iter().filter_map(of).collect());
    }
    count(&rects, &ways).crossings
}

/// Where a pinhole camera sees a place: pixels, and metres along its view; `None` behind it.
pub fn pixel(eye: DVec3, heading: f64, tilt: f64, fov_y: f64, picture: [u32; 2], place: DVec3) -> Option<(DVec2, f64)> {
    let forward = DVec3::new(heading.sin() * tilt.cos(), heading.cos() * tilt.cos(), tilt.sin());
    let right = DVec3::new(heading.cos(), -heading.sin(), 0.0);
    let up = right.cross(forward);
    let to = place - eye;
    let depth = to.dot(forward);
    let [width, height] = picture.map(f64::from);
    let scale = 0.5 * height / (0.5 * fov_y).tan();
    let at = DVec2::new(0.5 * width, 0.5 * height) + DVec2::new(to.dot(right), -to.dot(up)) * (scale / depth);
    (depth > 0.1).then_some((at, depth))
}
