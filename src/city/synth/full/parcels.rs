//! Parcels: gardens behind and before houses, laid over the ground of their block.

use crate::city::synth::full::{
    blocks::{Block, Kind, Lot},
    field::{P2, P3},
    frame::steps,
    house::House,
    object::{Geometry, Object},
    plan::Plan,
    shell::{Shell, Surface},
    streets,
};

/// Parcels and plants lie so far above the ground, millimetres.
pub const LIFT: i64 = 40;
/// Gardens reach so far behind houses in rows, steps.
const GARDEN: i64 = steps(9_000);

/// The gardens of a block of rows, each with the id of the building that it belongs to; the first building has the number
/// `first`, the last at most `last`.
pub fn gardens(plan: &Plan, block: &Block, [first, last]: [u64; 2]) -> Vec<Object> {
    if block.kind != Kind::Terraces {
        return Vec::new();
    }
    let ground = streets::ground(plan, block.cell);
    let mut objects = Vec::new();
    for (number, lot) in (first..=last).zip(&block.lots) {
        let house = &lot.house;
        let Some(deep) = reach(block, lot) else { continue };
        let corners = house.frame.rectangle([0, house.depth], [house.width, house.depth + deep]);
        // Some are lawns and beds, some paved.
        let (kind, class) = if number % 3 == 0 { ("LandUse", "yard") } else { ("PlantCover", "garden") };
        let object = Object::new(format!("parcel{number}"), kind)
            .text("class", class)
            .text("building", format!("b{number}"))
            .whole("yearOfConstruction", house.year)
            .with(Geometry::Surfaces("2", laid(&corners, &ground)));
        objects.push(object);
    }
    objects
}

/// How deep the garden behind a house can be: half of the way to what is opposite, steps.
fn reach(block: &Block, lot: &Lot) -> Option<i64> {
    let House { frame, depth, .. } = &lot.house;
    let far = |at: P2| {
        let away = [at[0] - frame.origin[0], at[1] - frame.origin[1]];
        (away[0] * frame.v[0] + away[1] * frame.v[1]) / (frame.v[0] * frame.v[0] + frame.v[1] * frame.v[1])
    };
    let nearest = block
        .lots
        .iter()
        .filter(|other| other.side != lot.side)
        .flat_map(|other| other.house.frame.rectangle([0, 0], [other.house.width, other.house.depth]))
        .map(far)
        .min()
        .unwrap_or(depth + 2 * GARDEN);
    let deep = ((nearest - depth) / 2 - 1).min(GARDEN);
    (deep > steps(2_500)).then_some(deep)
}

/// A polygon laid over triangles: cut along them, a little higher.
fn laid(polygon: &[P2], ground: &Shell) -> Shell {
    let mut shell = Shell::default();
    for (_, rings) in &ground.faces {
        let [a, b, c] = [0, 1, 2].map(|k| ground.points[rings[0][k] as usize]);
        let mut piece: Vec<[f64; 2]> = polygon.iter().map(|p| p.map(|v| v as f64)).collect();
        for (from, to) in [(a, b), (b, c), (c, a)] {
            piece = cut(&piece, from, to);
        }
        if piece.len() < 3 {
            continue;
        }
        let first = shell.points.len() as u32;
        shell.points.extend(piece.iter().map(|at| raised(*at, [a, b, c])));
        for k in 1..piece.len() as u32 - 1 {
            shell.triangle(Surface::Plain, [first, first + k, first + k + 1]);
        }
    }
    shell
}

/// What of a convex polygon lies to the left of a line.
fn cut(polygon: &[[f64; 2]], from: P3, to: P3) -> Vec<[f64; 2]> {
    let [ax, ay, dx, dy] = [from[0], from[1], to[0] - from[0], to[1] - from[1]].map(|v| v as f64);
    let side = |[x, y]: [f64; 2]| dx * (y - ay) - dy * (x - ax);
    let mut kept = Vec::new();
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (s, t) = (side(*p), side(*q));
        if s >= 0.0 {
            kept.push(*p);
        }
        if (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0) {
            let part = s / (s - t);
            kept.push([p[0] + (q[0] - p[0]) * part, p[1] + (q[1] - p[1]) * part]);
        }
    }
    kept
}

/// A place on the plane of a triangle, lifted, in whole millimetres.
fn raised([x, y]: [f64; 2], [a, b, c]: [P3; 3]) -> P3 {
    let [ab, ac] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]].map(|v| v as f64));
    let (px, py) = (x - a[0] as f64, y - a[1] as f64);
    let area = ab[0] * ac[1] - ab[1] * ac[0];
    let (s, t) = ((px * ac[1] - py * ac[0]) / area, (ab[0] * py - ab[1] * px) / area);
    [x.round() as i64, y.round() as i64, a[2] + (s * ab[2] + t * ac[2]).round() as i64 + LIFT]
}
