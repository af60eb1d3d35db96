//! Overlays that wait for a place, or for a better one, with a frame before: which come, when, and in which order.

use std::collections::BTreeSet;

use super::*;
use crate::overlay::placed::Jump;

/// Calls until nothing changes any more; what is then.
fn at_rest(asked: &Request, from: Placed) -> (Placed, usize) {
    let mut placed = from;
    for calls in 1..2000 {
        placed = place(asked, Some(&placed));
        check(asked, &placed).unwrap();
        if placed.settled {
            return (placed, calls);
        }
    }
    panic!("no rest after 2000 calls")
}

#[test]
fn a_folded_overlay_comes_back_when_there_is_room() {
    // Three of four times 200 pixels fit into a column of 696.
    let overlays = (0..4).map(|id| overlay(id, sized(100.0, 200.0), [640.0, 90.0 + 180.0 * f64::from(id)])).collect();
    let mut asked = request(overlays, Arrangement::Vertical(Align::First));
    asked.layout.reach = 0.0;
    let (placed, _) = at_rest(&asked, place(&asked, None));
    assert_eq!(placed.folded, [3]);
    let gone = asked.overlays.remove(1);
    let placed = place(&asked, Some(&placed));
    assert_eq!((&placed.folded[..], placed.placements.len()), (&[][..], 3));
    // It takes the place of the one that has gone; one that stood stays where it stood or makes room.
    assert_eq!(placed.placements.iter().map(|p| p.id).collect::<Vec<_>>(), [0, 2, 3]);
    // One that is as important and was not there waits.
    asked.overlays.push(gone);
    let (placed, _) = at_rest(&asked, placed);
    assert_eq!(placed.folded.len(), 1);
    // A more important one has the place of another, at once.
    asked.overlays.iter_mut().find(|o| placed.folded.contains(&o.id)).unwrap().priority = 1.0;
    let waiting = placed.folded[0];
    let anew = Placed { folded: vec![], ..placed };
    let placed = place(&asked, Some(&anew));
    assert!(placed.folded.len() == 1 && placed.folded[0] != waiting, "{:?}", placed.folded);
    assert_eq!(placed.jump, Some(Jump::Anew));
}

#[test]
fn what_is_folded_comes_back_once_points_are_further_away_than_the_dead_band() {
    let mut asked = request(vec![overlay(0, sized(100.0, 300.0), [640.0, 360.0])], Arrangement::Vertical(Align::First));
    asked.layout.reach = 0.0;
    asked.picture = [1280, 324];
    asked.avoid = vec![DVec2::new(60.0, 150.0)];
    let (placed, _) = at_rest(&asked, place(&asked, None));
    let covers = Fact::Covers { overlay: 0, points: vec![0] };
    assert_eq!((placed.folded.len(), &placed.facts[..]), (0, &[covers][..]), "wherever it stands");
    asked.blocked = vec![Rect::new([0, 100], [60, 50])];
    let (placed, _) = at_rest(&asked, place(&asked, Some(&placed)));
    assert_eq!((&placed.folded[..], &placed.facts[..]), (&[0][..], &[Fact::NoRoom { overlay: 0 }][..]));
    asked.blocked.clear();
    // Covered from x = 118 on: 112 and the clearance of 6. Only 12 further there is room to come back.
    for (x, is_back) in [(119.0, false), (129.0, false), (130.5, true), (119.0, true)] {
        asked.avoid = vec![DVec2::new(x, 150.0)];
        let placed = at_rest(&asked, if is_back && x < 125.0 { shown(&asked, 131.0) } else { placed.clone() }).0;
        assert_eq!(placed.folded.is_empty(), is_back, "{x}");
    }
}

/// The only overlay at its place, with a point at x.
fn shown(asked: &Request, x: f64) -> Placed {
    place(&Request { avoid: vec![DVec2::new(x, 150.0)], ..asked.clone() }, None)
}

#[test]
fn all_that_wait_have_their_turn() {
    // 240 in a picture for about 40: one has its turn per call.
    let spread = |id: u32| [f64::from((id * 37) % 400), f64::from((id * 91) % 300)];
    let overlays: Vec<Overlay> = (0..240).map(|id| overlay(id, sized(50.0, 40.0), spread(id))).collect();
    let mut asked = request(overlays, Arrangement::Border);
    (asked.picture, asked.avoid) = ([400, 300], vec![]);
    let mut placed = place(&asked, None);
    let mut turns = BTreeSet::new();
    let mut calls = 0;
    while !placed.settled {
        placed = place(&asked, Some(&placed));
        turns.extend(placed.turn);
        calls += 1;
    }
    let waiting = || placed.folded.iter().all(|id| turns.contains(id));
    assert!(waiting() && !placed.folded.is_empty(), "{} of {} folded", turns.len(), placed.folded.len());
    assert!(calls <= 2 * placed.folded.len() + 10, "{calls} calls");
    // Half of those that stand go: as many others come, the most important first, and at rest none is left for which there is room.
    let gone: Vec<u32> = placed.placements.iter().map(|p| p.id).step_by(2).collect();
    asked.overlays.retain(|o| !gone.contains(&o.id));
    let before = placed.folded.len();
    let (placed, _) = at_rest(&asked, placed);
    assert!(before - placed.folded.len() >= gone.len() * 3 / 4, "{before} waited, {} do", placed.folded.len());
    let (margin, gap) = (asked.layout.margin as i32, asked.layout.gap as i32);
    let is_free = |x: i32, y: i32| {
        let rect = Rect::new([x, y], [50, 40]);
        !placed.placements.iter().any(|p| p.rect.within(&rect, gap))
    };
    let room = (margin..=400 - margin - 50)
        .find_map(|x| (margin..=300 - margin - 40).find(|y| is_free(x, *y)).map(|y| (x, y)));
    assert_eq!(room, None);
}

#[test]
fn what_has_settled_stays_and_costs_nothing() {
    let overlays = (0..9).map(|id| overlay(id, sized(160.0, 120.0), [300.0 + 90.0 * f64::from(id), 350.0])).collect();
    let mut asked = request(overlays, Arrangement::Border);
    let (placed, calls) = at_rest(&asked, place(&asked, None));
    assert!(calls <= 3 && placed.jump.is_none() && placed.gliding.is_empty(), "{calls}");
    assert_eq!(place(&asked, Some(&placed)), placed);
    // A hair's breadth is another request, and all keep still.
    asked.overlays[0].anchors = vec![Focus::Point(DVec2::new(300.001, 350.0))];
    let next = place(&asked, Some(&placed));
    assert_eq!(next.placements, placed.placements);
    assert_ne!(next.lines, placed.lines.clone().split_off(1));
}

#[test]
fn the_sides_move_on_their_own() {
    // Two columns; a point walks into the left one alone.
    let at = |id: u32| [if id < 3 { 300.0 } else { 980.0 }, 120.0 + 220.0 * f64::from(id % 3)];
    let overlays = (0..6).map(|id| overlay(id, sized(160.0, 120.0), at(id))).collect();
    let mut asked = request(overlays, Arrangement::Vertical(Align::Both));
    let (mut placed, _) = at_rest(&asked, place(&asked, None));
    let left = rect_of(&placed, 1);
    let mut has_moved = false;
    for step in 0..100 {
        asked.avoid[0] = DVec2::new(90.0, f64::from(left.min[1] - 10 + 2 * step));
        let next = place(&asked, Some(&placed));
        check(&asked, &next).unwrap();
        for id in 3..6 {
            assert_eq!(rect_of(&next, id), rect_of(&placed, id), "step {step}");
        }
        assert!(next.jump.is_some() || (0..3).all(|id| rect_of(&next, id).distance(&rect_of(&placed, id)) <= 24));
        has_moved |= rect_of(&next, 1) != left;
        placed = next;
    }
    assert!(has_moved);
}

#[test]
fn what_is_blocked_is_left_free_with_the_gap() {
    let title = Rect::new([16, 16], [400, 40]);
    let legend = Rect::new([1000, 300], [264, 404]);
    let overlays = (0..8).map(|id| overlay(id, sized(160.0, 120.0), [200.0 + 120.0 * f64::from(id), 380.0])).collect();
    let mut asked = request(overlays, Arrangement::Border);
    let free = place(&asked, None);
    let meets = |placed: &Placed| {
        placed.placements.iter().filter(|p| p.rect.within(&title, 10) || p.rect.within(&legend, 10)).count()
    };
    assert!(meets(&free) > 0);
    asked.blocked = vec![title, legend];
    for placed in [place(&asked, None), at_rest(&asked, free.clone()).0] {
        check(&asked, &placed).unwrap();
        assert_eq!((meets(&placed), placed.placements.len()), (0, 8));
    }
    // All of the picture: all are folded, and each tells.
    asked.blocked = vec![Rect::new([-10, -10], [2000, 2000])];
    for placed in [place(&asked, None), at_rest(&asked, free).0] {
        assert_eq!(placed.folded.len(), 8);
        assert_eq!(placed.facts, (0..8).map(|overlay| Fact::NoRoom { overlay }).collect::<Vec<_>>());
    }
}
