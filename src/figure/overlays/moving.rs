//! Markers and traces of what moves, over any view of it.

use glam::{DVec2, DVec3};

use crate::{
    figure::overlays::paint::Painter,
    scene::{PoiPlace, Scene, Trajectory},
    view::View,
};

/// How far beyond the picture lines are still drawn, pixels: more than any is wide.
const BEYOND_PX: f64 = 64.0;
/// How far the place is that an arrow points to, as a share of the distance from the eye; and metres where rays are parallel.
const AHEAD: f64 = 0.01;

/// Draws what moves in a scene, traces first, as a view shows it.
pub(super) fn paint(painter: &mut Painter, scene: &Scene, view: &View) {
    let is_used =
        |way: &&Trajectory| scene.pois.iter().any(|poi| matches!(&poi.place, PoiPlace::On(name) if *name == way.name));
    let ways = || scene.trajectories.iter().filter(is_used);
    for way in ways().filter(|way| way.trace) {
        let (line, gone) = (way.line(), way.at(scene.time_s).gone_m);
        let mut vertices = line.vertices();
        let at = vertices.partition_point(|(metres, _)| *metres < gone);
        vertices.insert(at, (gone, line.at(gone)));
        let places: Vec<DVec3> = vertices.into_iter().map(|(_, place)| place).collect();
        for (places, is_gone) in [(&places[at..], false), (&places[..=at], true)] {
            seen_parts(view, places).iter().for_each(|part| painter.trace(part, way.color, is_gone));
        }
    }
    for way in ways().filter(|way| way.marker) {
        let moving = way.at(scene.time_s);
        let Some(at) = pixel(view, moving.at) else { continue };
        let step = if view.is_orthographic() { 1.0 } else { AHEAD * at.z };
        let ahead = moving.direction.and_then(|direction| pixel(view, moving.at + step * direction));
        // What goes along the ray has no direction in the picture.
        let direction =
            ahead.map(|ahead| ahead.truncate() - at.truncate()).filter(|way| way.length() > 0.02 * step_px(view));
        painter.moving(at.truncate(), direction.and_then(DVec2::try_normalize), way.color);
    }
}

/// How many pixels the step of an arrow is across the view.
fn step_px(view: &View) -> f64 {
    let metre = 0.5 * f64::from(view.size[1]) / view.half_extent().y;
    if view.is_orthographic() { metre } else { AHEAD * metre }
}

/// The pixel of a place before the near plane, and its distance along the view axis.
fn pixel(view: &View, place: DVec3) -> Option<DVec3> {
    view.pixel(place).filter(|p| p.z >= view.camera.near_m * (1.0 - 1e-9))
}

/// The parts of a line that are before the near plane and in the picture or not far from it, pixels; no point twice in a row.
fn seen_parts(view: &View, places: &[DVec3]) -> Vec<Vec<DVec2>> {
    let mut parts: Vec<Vec<DVec2>> = Vec::new();
    for pair in places.windows(2) {
        let Some([from, to]) = seen_part(view, [pair[0], pair[1]]) else { continue };
        match parts.last_mut() {
            Some(part) if part.last().is_some_and(|last| last.distance(from) < 1e-6) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
    }
    for part in &mut parts {
        // Points nearer to each other than this have no direction that shows.
        part.dedup_by(|next, before| next.distance(*before) < 0.25);
    }
    parts.retain(|part| part.len() > 1);
    parts
}

/// The part of a straight line that is before the near plane and not far from the picture, pixels.
fn seen_part(view: &View, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
    let near = view.camera.near_m;
    let depths = ends.map(|end| view.depth(end) - near);
    if depths.iter().all(|depth| *depth <= 0.0) {
        return None;
    }
    let cut = ends[0].lerp(ends[1], depths[0] / (depths[0] - depths[1]));
    let kept: [DVec3; 2] = std::array::from_fn(|i| if depths[i] < 0.0 { cut } else { ends[i] });
    let [from, to] = [pixel(view, kept[0])?.truncate(), pixel(view, kept[1])?.truncate()];
    // Liang and Barsky.
    let along = to - from;
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let (low, high) = (-BEYOND_PX, f64::from(view.size[axis]) + BEYOND_PX);
        if along[axis] == 0.0 {
            if !(low..=high).contains(&from[axis]) {
                return None;
            }
            continue;
        }
        let [a, b] = [low, high].map(|side| (side - from[axis]) / along[axis]);
        (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
    }
    (enters < leaves).then(|| [from + enters * along, from + leaves * along])
}
