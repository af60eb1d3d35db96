//! Where the overlays of a picture stand: where the layout puts them, at places of their own, or on boards in the scene.

use glam::DVec2;

use crate::{
    figure::overlays::{
        call_out::{self, Board},
        paint,
        places::{Shown, place},
        room,
    },
    lens::best_view::Depiction,
    overlay::{
        self, Focus, Placed, Rect,
        crossings::pixels,
        lane::Side,
        line::{Target, straight, way},
    },
    render::picture::Studio,
    scene::{
        Scene,
        overlay::{Along, LineKind, Sizes, Stand},
    },
    view::View,
};

/// How far overlays stay from points of interest, pixels.
const CLEARANCE_PX: f64 = 6.0;

/// An overlay that has a place.
pub(super) struct Spot {
    /// The number of its lens.
    pub index: usize,
    /// Where it is in the picture; of a board in the image of that; pixels.
    pub rect: Rect,
    /// Of its text, pixels.
    pub em: f32,
    /// The number of the end among those that are seen, and the way to it from the overlay, pixels of the picture.
    pub lines: Vec<(usize, Vec<DVec2>)>,
    /// What it stands on in the scene.
    pub board: Option<Board>,
}

/// Where all stand, in the order in which they are drawn: boards, the farthest first; what is laid out; what has a
/// place of its own.
pub(super) fn spots(
    studio: &Studio,
    scene: &Scene,
    view: &View,
    shown: &[Shown],
    blocked: &[Rect],
    em: f32,
    before: Option<&Placed>,
) -> (Vec<Spot>, Placed) {
    let mut boards: Vec<Spot> = shown.iter().filter_map(|one| on_board(view, one, em)).collect();
    boards.sort_by(|a, b| depth(b).total_cmp(&depth(a)).then(a.index.cmp(&b.index)));
    let own: Vec<Spot> = shown.iter().filter_map(|one| at_its_place(scene, view, one, em)).collect();
    let is_laid = |one: &&Shown| match one.overlay.stand {
        Stand::Laid => true,
        // One that its place cannot hold is told as others are: by a marker.
        Stand::At(_) => own.iter().all(|spot| spot.index != one.index),
        Stand::Scene(_) => false,
    };
    let laid: Vec<&Shown> = shown.iter().filter(is_laid).collect();
    let taken = boards.iter().filter_map(|spot| spot.board.as_ref()?.blocks(view.size));
    let blocked = blocked.iter().copied().chain(own.iter().map(|spot| spot.rect)).chain(taken).collect();
    let asked = layout_of(studio, scene, view, &laid, blocked, em);
    // Where nobody stood before; else all stay about where they are.
    let busy = if laid.is_empty() || before.is_some() { Vec::new() } else { room::busy(studio, view) };
    let narrowest = asked.overlays.iter().map(|own| own.min.min_element()).fold(f64::INFINITY, f64::min);
    let over_objects = room::over_objects(studio, scene, view, &laid, narrowest);
    let placed = room::placed(&asked, over_objects, scene.layout.along, &busy, before);
    let of_placement = |placement: &overlay::Placement| {
        let lines = placed.lines.iter().filter(|line| line.overlay == placement.id);
        let lines = lines.map(|line| (line.anchor, line.points.clone())).collect();
        Spot { index: placement.id as usize, rect: placement.rect, em, lines, board: None }
    };
    let spots = boards.into_iter().chain(placed.placements.iter().map(of_placement)).chain(own).collect();
    (spots, placed)
}

/// What those take that the layout does not place: those with a place of their own, and boards.
pub(super) fn standing(scene: &Scene, view: &View, shown: &[Shown], em: f32) -> Vec<Rect> {
    let own = shown.iter().filter_map(|one| Some(at_its_place(scene, view, one, em)?.rect));
    let boards = shown.iter().filter_map(|one| on_board(view, one, em)?.board?.blocks(view.size));
    own.chain(boards).collect()
}

fn depth(spot: &Spot) -> f64 {
    spot.board.as_ref().map_or(0.0, |board| board.depth)
}

/// An overlay with a place of its own; `None`: it has none, or the picture does not hold it at its smallest.
fn at_its_place(scene: &Scene, view: &View, one: &Shown, em: f32) -> Option<Spot> {
    let Stand::At(at) = one.overlay.stand else { return None };
    let preferred = preferred_size(one, 1.0, em);
    let margin = scene.layout.margin_in(view.size) as i32;
    let mut rect = Rect::default();
    for i in 0..2 {
        let room = view.size[i] as i32 - 2 * margin;
        let min = least_size(one, preferred)[i].min(preferred[i]) as i32;
        let size = (preferred[i] as i32).min(room);
        if size < min {
            return None;
        }
        let low = (at[i] * f64::from(view.size[i]) - 0.5 * f64::from(size)).round() as i32;
        rect.min[i] = low.clamp(margin, margin + room - size);
        rect.max[i] = rect.min[i] + size;
    }
    let line = |focus: &Focus| {
        let target = Target::new(focus)?;
        // From the edge that the place is furthest beyond.
        let [width, height] = rect.size().map(f64::from);
        let to = (pixels(target.at) - rect.middle()) / DVec2::new(width, height);
        let side = match to.x.abs() > to.y.abs() {
            true if to.x > 0.0 => Side::Left,
            true => Side::Right,
            false if to.y > 0.0 => Side::Top,
            false => Side::Bottom,
        };
        let way = way(&rect, side, &target, line_kind(one))?;
        Some(way.points().iter().map(|p| pixels(*p)).collect())
    };
    let lines = one.focuses().enumerate().filter_map(|(i, focus)| Some((i, line(focus)?))).collect();
    Some(Spot { index: one.index, rect, em, lines, board: None })
}

/// An overlay that stands in the scene; `None`: it does not, or it is not seen.
fn on_board(view: &View, one: &Shown, em: f32) -> Option<Spot> {
    let Stand::Scene(call_out) = one.overlay.stand else { return None };
    let first = one.places.first()?;
    let above = call_out::Above { place: first.at, heights_m: first.heights_m };
    let board = call_out::board(view, &call_out, &above, |scale| preferred_size(one, scale, em), em)?;
    // All run straight: the first is a pole.
    let line = |focus: &Focus| board.foot.and_then(|foot| straight(foot, focus));
    let lines = one.focuses().enumerate().filter_map(|(i, focus)| Some((i, line(focus)?))).collect();
    let rect = Rect::new([board.margin; 2], board.size.map(|side| side as i32));
    Some(Spot { index: one.index, rect, em: em * board.scale as f32, lines, board: Some(board) })
}

fn line_kind(one: &Shown) -> overlay::LineKind {
    match one.overlay.line.as_ref().map(|line| line.kind).unwrap_or_default() {
        LineKind::Straight => overlay::LineKind::Straight,
        LineKind::Orthogonal => overlay::LineKind::Orthogonal,
        LineKind::Curved => overlay::LineKind::Curved,
    }
}

/// What an overlay prefers, so many times as large: a card is no higher than its text.
fn preferred_size(one: &Shown, scale: f64, em: f32) -> [u32; 2] {
    let [width, height] = one.size.map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    match &one.best_view.depiction {
        Depiction::Text(text) => [width, height.min(paint::text_height(text, width, em * scale as f32))],
        _ => [width, height],
    }
}

/// It is made no smaller: by half where nobody says so, and a card not at all, which would lose its text.
fn least_size(one: &Shown, preferred: [u32; 2]) -> [u32; 2] {
    match (&one.overlay.min, &one.best_view.depiction) {
        (Some(min), _) => *min,
        (None, Depiction::Text(_)) => preferred,
        (None, _) => preferred.map(|side| (side / 2).max(1)),
    }
}

/// What the layout is asked.
fn layout_of(
    studio: &Studio,
    scene: &Scene,
    view: &View,
    shown: &[&Shown],
    blocked: Vec<Rect>,
    em: f32,
) -> overlay::Request {
    let layout = &scene.layout;
    let size = |side: [u32; 2]| DVec2::new(side[0].into(), side[1].into());
    let overlays: Vec<overlay::Overlay> = shown
        .iter()
        .map(|one| {
            let preferred = preferred_size(one, 1.0, em);
            let least = size(least_size(one, preferred));
            let preferred = size(preferred);
            overlay::Overlay {
                id: one.index as u32,
                priority: one.overlay.priority,
                min: least,
                preferred,
                max: one.overlay.max.map_or(1.5 * preferred, size),
                anchors: one.focuses().cloned().collect(),
                lines: line_kind(one),
                weight: one.overlay.interest,
                distance: one.places.iter().map(|place| place.distance).fold(f64::INFINITY, f64::min).min(1e9),
            }
        })
        .collect();
    let avoid = scene.pois.iter().filter_map(|poi| match place(studio, scene, view, poi, false)?.focus? {
        Focus::Point(at) => Some(at),
        Focus::Area(_) => None,
    });
    let (arrangement, along) = match layout.along {
        Along::Top => (overlay::Arrangement::Horizontal(overlay::Align::First), overlay::Along::Even),
        Along::Bottom => (overlay::Arrangement::Horizontal(overlay::Align::Last), overlay::Along::Even),
        Along::Left => (overlay::Arrangement::Vertical(overlay::Align::First), overlay::Along::Even),
        Along::Right => (overlay::Arrangement::Vertical(overlay::Align::Last), overlay::Along::Even),
        Along::Sides => (overlay::Arrangement::Vertical(overlay::Align::Both), overlay::Along::Even),
        Along::Border => (overlay::Arrangement::Border, overlay::Along::Even),
    };
    let [w, h] = view.size.map(f64::from);
    overlay::Request {
        picture: view.size,
        overlays,
        avoid: avoid.collect(),
        clearance: CLEARANCE_PX * f64::from(em) / 13.0,
        blocked,
        layout: overlay::Layout {
            arrangement,
            along,
            size: match layout.sizes {
                Sizes::Preferred => overlay::SizeRule::Preferred,
                Sizes::Distance => overlay::SizeRule::ByDistance,
                Sizes::Interest => overlay::SizeRule::ByInterest,
            },
            margin: layout.margin_in(view.size),
            gap: layout.gap_in(view.size),
            centre_of_interest: layout.exploration_focus.then(|| 0.5 * DVec2::new(w, h)),
            ..overlay::Layout::default()
        },
    }
}
