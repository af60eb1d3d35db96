//! Layouts of overlays over time: walks of 300 frames past places on the ground, by a pinhole camera.

#![allow(clippy::print_stdout, reason = "what was counted, for those who ask with --no-capture")]

use crate::layouts::{pixel, walk};
use glam::{DVec2, DVec3};
use veduta::overlay::{Align, Arrangement, Focus, Layout, LineKind, Overlay, Rect, Request};

const FRAMES: u32 = 300;
const PICTURE: [u32; 2] = [1280, 720];

/// Numbers from 0 to 1 without an order.
fn random(n: u32) -> f64 {
    let mut x = n.wrapping_mul(0x9e37_79b9).wrapping_add(0x85eb_ca6b);
    for shift in [15, 13, 16] {
        x = (x ^ (x >> shift)).wrapping_mul(0xc2b2_ae35);
    }
    f64::from(x) / f64::from(u32::MAX)
}

/// One frame of a walk of a walker who strolls over a square, and looks about: `count` overlays, of which every third has two places.
fn frame(n: u32, count: u32, arrangement: Arrangement, lines: LineKind, seed: u32) -> Request {
    let t = f64::from(n) / 30.0;
    let eye = DVec3::new(6.0 * (0.4 * t).sin(), 1.4 * t, 12.0);
    let (heading, tilt) = (0.25 * (0.7 * t).sin(), -0.12);
    let place = |k: u32| {
        let at = |i: u32| random(seed * 1000 + 3 * k + i);
        DVec3::new(-60.0 + 120.0 * at(0), 40.0 + 160.0 * at(1), 10.0 * at(2))
    };
    let [width, height] = PICTURE.map(f64::from);
    let seen = |k: u32| {
        let (at, depth) = pixel(eye, heading, tilt, 0.9, PICTURE, place(k))?;
        ((0.0..=width).contains(&at.x) && (0.0..=height).contains(&at.y)).then_some((at, depth))
    };
    let overlays = (0..count).map(|id| {
        let places = [Some(id), (id % 3 == 0).then_some(count + id)].into_iter().flatten();
        let places: Vec<(DVec2, f64)> = places.filter_map(seen).collect();
        let size = DVec2::new(120.0, 80.0);
        Overlay {
            id,
            priority: f64::from(id % 4),
            min: size * 0.5,
            preferred: size,
            max: size * 1.5,
            distance: places.iter().map(|p| p.1).fold(1e9, f64::min),
            anchors: places.iter().map(|p| Focus::Point(p.0)).collect(),
            lines,
            weight: 0.5,
        }
    });
    Request {
        picture: PICTURE,
        overlays: overlays.collect(),
        avoid: (0..2 * count).filter_map(seen).map(|p| p.0).collect(),
        clearance: 6.0,
        blocked: vec![
            Rect::new([16, 16], [300, 40]),
            Rect::new([16, 660], [420, 44]),
            Rect::new([1060, 560], [204, 144]),
        ],
        layout: Layout { arrangement, ..Layout::default() },
    }
}

#[test]
fn overlays_keep_still_while_one_walks() {
    let arrangements = [
        Arrangement::Border,
        Arrangement::Vertical(Align::Both),
        Arrangement::Vertical(Align::Last),
        Arrangement::Horizontal(Align::Both),
    ];
    for (seed, arrangement) in (1..).zip(arrangements) {
        for (count, kind) in
            [(8, LineKind::Straight), (12, LineKind::Straight), (12, LineKind::Curved), (12, LineKind::Orthogonal)]
        {
            let walk = walk((0..FRAMES).map(|n| frame(n, count, arrangement, kind, seed)));
            let walk = walk.unwrap_or_else(|e| panic!("{count} overlays, {arrangement:?}, {kind:?}: {e}"));
            let share = walk.still as f64 / walk.standings as f64;
            let jumps: usize = walk.jumps.values().sum();
            assert!(share > 0.9 && jumps <= 15 && walk.swaps_back <= 2, "{arrangement:?}, {kind:?}: {walk:?}");
            println!("{count} overlays, {arrangement:?}, {kind:?}: {walk:?}");
        }
    }
}
