//! Walks of 300 frames past the places of a real city: overlays keep still, none ever overlap, and each leap is told. What must hold is in `layouts`.

#![allow(clippy::print_stdout, reason = "what was counted, for those who ask with --no-capture")]

use std::path::Path;

use glam::{DVec2, DVec3};
use libtest_mimic::{Failed, Trial};
use veduta::{
    city::{
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
    },
    geom::Aabb,
    overlay::{Align, Arrangement, Focus, Layout, LineKind, Overlay, Rect, Request},
    view::{Camera, View},
    visibility::Units,
};

use crate::layouts;

pub fn trials() -> Vec<Trial> {
    let files = ["denhaag-01/DenHaag_01.v1.0.city.json", "vienna-102081/vienna_102081.v1.1.city.jsonl"];
    files.map(|file| crate::trial(&format!("overlay_walks::{file}"), move |root| check(&root.join(file)))).into()
}

const FRAMES: u32 = 300;
const PICTURE: [u32; 2] = [1280, 720];
/// Places, of which half have an overlay.
const PLACES: usize = 24;

fn check(file: &Path) -> Result<(), Failed> {
    let model = load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?;
    let units = Units::new(&model, &shown_geometries(&model, None));
    let mut boxes: Vec<Aabb> = units.boxes.iter().copied().filter(|b| !b.is_empty() && b.size().z > 3.0).collect();
    // The tallest, as sights are.
    boxes.sort_by(|a, b| b.size().z.total_cmp(&a.size().z));
    let places: Vec<DVec3> = boxes.iter().take(PLACES).map(Aabb::center).collect();
    if places.len() < PLACES {
        return Err(format!("{} of {PLACES} places", places.len()).into());
    }
    let extent = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
    let (middle, reach) = (extent.center(), extent.size().truncate().length());
    // A stroll above the roofs, half around the city and nearer, that looks about.
    let view = |n: u32| {
        let t = f64::from(n) / f64::from(FRAMES - 1);
        let (turn, away) = (0.3 + 1.3 * t, (0.62 - 0.3 * t) * reach);
        let eye = middle + DVec3::new(turn.cos() * away, turn.sin() * away, 0.12 * reach);
        let aside = DVec3::new(-turn.sin(), turn.cos(), 0.0) * (0.1 * reach * (9.0 * t).sin());
        View::new(Camera::looking(eye, middle + aside, 0.8), PICTURE, &extent)
    };
    for (arrangement, kind) in [
        (Arrangement::Border, LineKind::Straight),
        (Arrangement::Border, LineKind::Orthogonal),
        (Arrangement::Vertical(Align::Both), LineKind::Curved),
        (Arrangement::Vertical(Align::Last), LineKind::Straight),
        (Arrangement::Horizontal(Align::Both), LineKind::Straight),
    ] {
        let frames: Vec<Request> = (0..FRAMES)
            .map(|n| Ok(request(&view(n)?, &places, arrangement, kind)))
            .collect::<Result<_, veduta::view::CameraError>>()?;
        let tied = frames.iter().map(|r| r.overlays.iter().filter(|o| !o.anchors.is_empty()).count()).sum::<usize>();
        let walk = layouts::walk(frames).map_err(|e| format!("{arrangement:?}, {kind:?}: {e}"))?;
        println!("{arrangement:?}, {kind:?}: {} tied; {walk:?}", tied as f64 / f64::from(FRAMES));
        let still = walk.still as f64 / walk.standings as f64;
        // Those further inward, half of them in one column, look for another place when a point walks into theirs.
        let came = walk.jumps.get("Came").copied().unwrap_or_default();
        let jumps = walk.jumps.values().sum::<usize>() - came;
        // Half around the city in ten seconds: points walk through the overlays all the time.
        if still < 0.75
            || jumps > FRAMES as usize / 8
            || came > FRAMES as usize / 5
            || walk.swaps_back > 3
            || walk.covering > 0
        {
            return Err(format!("{arrangement:?}, {kind:?}: {walk:?}").into());
        }
    }
    Ok(())
}

fn request(view: &View, places: &[DVec3], arrangement: Arrangement, lines: LineKind) -> Request {
    let [width, height] = PICTURE.map(f64::from);
    let seen = |at: &DVec3| {
        let pixel = view.pixel(*at).filter(|p| p.z > view.camera.near_m)?.truncate();
        ((0.0..=width).contains(&pixel.x) && (0.0..=height).contains(&pixel.y)).then_some(pixel)
    };
    let size = DVec2::new(150.0, 100.0);
    let overlays = places.iter().step_by(2).zip(0..).map(|(at, id)| Overlay {
        id,
        priority: 0.0,
        min: 0.5 * size,
        preferred: size,
        max: 1.5 * size,
        anchors: seen(at).map(Focus::Point).into_iter().collect(),
        lines,
        weight: 0.5,
        distance: at.distance(view.camera.eye),
    });
    Request {
        picture: PICTURE,
        overlays: overlays.collect(),
        avoid: places.iter().filter_map(seen).collect(),
        clearance: 6.0,
        blocked: vec![Rect::new([16, 16], [360, 42])],
        layout: Layout { arrangement, ..Layout::default() },
    }
}
