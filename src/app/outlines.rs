//! Outlines of what is hovered and what is chosen: around what is shown of it, and dashed around what something hides.

use std::{ops::Range, sync::Arc};

use eframe::egui::{Color32, Mesh, Rect, Shape, Ui, vec2};
use glam::{DVec2, DVec3};

use crate::{
    app::{canvas_state::Outlines, state::Window},
    view::View,
};

const HOVERED: Color32 = Color32::WHITE;
const CHOSEN: Color32 = Color32::from_rgb(255, 140, 0);
/// Pixels of a dash, and of a gap.
const DASH: usize = 5;
/// The least distance between the outline of a hidden part and what is seen of the object, which has an outline of its own, pixels.
const APART: usize = 3;
/// Objects of more triangles are outlined where they are seen only.
const MOST_TRIANGLES: usize = 200_000;

impl Window {
    /// Draws the outlines of what is hovered and what is chosen.
    pub(super) fn draw_outlines(&mut self, ui: &Ui, rect: Rect) {
        let (Some(frame), Some(city)) = (self.frame.as_deref(), &self.city) else { return };
        let (Some((ids, depths)), true) = (&frame.shown, Some(frame.view.camera) == self.document.scene().camera)
        else {
            return;
        };
        // What all stands on is around everything.
        let is_ground = |object: &u32| city.model.objects.get(*object as usize).is_none_or(|own| own.class.is_ground());
        let hovered = self.canvas.hovered.and_then(|hovered| hovered.object).filter(|object| !is_ground(object));
        let objects = [hovered, self.chosen.object];
        let known = self.canvas.outlines.as_ref().filter(|known| known.objects == objects && known.rect == rect);
        let mesh = known.map(|known| known.mesh.clone()).unwrap_or_else(|| {
            let roots = objects.map(|object| object.and_then(|object| city.roots.get(object as usize).copied()));
            let family = |id: &u32| id.checked_sub(1).and_then(|id| city.roots.get(id as usize).copied());
            let shown: Vec<Option<u32>> = match roots {
                [None, None] => Vec::new(),
                _ => ids.iter().map(family).collect(),
            };
            let mut mesh = Mesh::default();
            let [hovered, chosen] = roots;
            let size = frame.view.size.map(|side| side as usize);
            let picture = Picture { size, shown: &shown, depths };
            if let Some(root) = hovered.filter(|_| hovered != chosen) {
                picture.seen_edge(root, 1, &[], |i| add_pixel(&mut mesh, i, size, rect, HOVERED));
            }
            if let Some(root) = chosen {
                // All that stands on it would be an edge of what all stands on.
                let covered = match is_ground(&root) {
                    true => vec![true; ids.len()],
                    false => covered(&self.triangles_shown(root), &frame.view),
                };
                picture.seen_edge(root, 2, &covered, |i| add_pixel(&mut mesh, i, size, rect, CHOSEN));
                picture.hidden_edge(root, &covered, |i| add_pixel(&mut mesh, i, size, rect, CHOSEN));
            }
            Arc::new(mesh)
        });
        self.canvas.outlines = Some(Outlines { mesh: mesh.clone(), objects, rect });
        ui.painter_at(rect).add(Shape::Mesh(mesh));
    }

    /// The triangles of an object with its parts that would be shown without lenses, metres; none where lenses move them.
    fn triangles_shown(&self, root: u32) -> Vec<[DVec3; 3]> {
        let mut all = Vec::new();
        let is_deformed = self.document.scene().lenses.iter().any(|lens| lens.enabled && lens.deform().is_some());
        let Some((city, index)) = self.city.as_ref().and_then(|city| Some((city, city.index.get()?))) else {
            return all;
        };
        if is_deformed {
            return all;
        }
        let model = &city.model;
        let around = model.family_bounds(root);
        let is_own = |tile: u32| {
            let object = model.geometries[model.tiles[tile as usize].geometry as usize].object;
            city.roots.get(object as usize) == Some(&root)
        };
        let pose = model.pose_of(root, self.document.scene().shown_moment());
        index.triangles_where(
            model,
            |bounds| bounds.meets(&around),
            is_own,
            |_, corners| {
                all.push(pose.map_or(*corners, |pose| corners.map(|corner| pose.place(corner))));
                all.len() <= MOST_TRIANGLES
            },
        );
        if all.len() > MOST_TRIANGLES {
            all.clear();
        }
        all
    }
}

fn add_pixel(mesh: &mut Mesh, i: usize, [w, h]: [usize; 2], rect: Rect, color: Color32) {
    let scale = rect.size() / vec2(w as f32, h as f32);
    let at = rect.min + vec2((i % w) as f32, (i / w) as f32) * scale;
    mesh.add_colored_rect(Rect::from_min_size(at, scale), color);
}

/// The depths and objects that a picture shows.
struct Picture<'a> {
    size: [usize; 2],
    /// The family at each pixel.
    shown: &'a [Option<u32>],
    /// Metres along the view axis at each pixel.
    depths: &'a [f32],
}

impl Picture<'_> {
    /// Visits the pixels of a family that are at an edge of what is seen of it, so many pixels deep. `covered`: all that it covers
    /// in the picture, empty where that is not known. Where something before it ends within that there is no edge of it: the
    /// other side of it is dashed, or seen through a veil.
    fn seen_edge(&self, root: u32, reach: usize, covered: &[bool], mut visit: impl FnMut(usize)) {
        let [w, h] = self.size;
        for (i, _) in self.shown.iter().enumerate().filter(|(_, own)| **own == Some(root)) {
            let (x, y) = (i % w, i / w);
            let ends_at = |j: usize| {
                let is_before = || self.depths[j] < self.depths[i];
                self.shown[j] != Some(root) && !(covered.get(j) == Some(&true) && is_before())
            };
            // The end of the picture is no edge of the object.
            let is_edge = x >= reach && ends_at(i - reach)
                || y >= reach && ends_at(i - reach * w)
                || x + reach < w && ends_at(i + reach)
                || y + reach < h && ends_at(i + reach * w);
            if is_edge {
                visit(i);
            }
        }
    }

    /// Visits the pixels, in dashes, at the edge of what a family covers where something else is seen.
    fn hidden_edge(&self, root: u32, covered: &[bool], mut visit: impl FnMut(usize)) {
        let [w, h] = self.size;
        let is_near = |x: usize, y: usize| {
            let mut rows = y.saturating_sub(APART)..(y + APART + 1).min(h);
            let cols = x.saturating_sub(APART)..(x + APART + 1).min(w);
            rows.any(|y| self.shown[y * w + cols.start..y * w + cols.end].contains(&Some(root)))
        };
        for (i, _) in covered.iter().enumerate().filter(|(_, is_covered)| **is_covered) {
            let (x, y) = (i % w, i / w);
            let is_inner = x > 0 && y > 0 && x + 1 < w && y + 1 < h;
            let is_edge = is_inner && ![i - 1, i + 1, i - w, i + w].iter().all(|&j| covered[j]);
            if is_edge && ((x + y) / DASH).is_multiple_of(2) && !is_near(x, y) {
                visit(i);
            }
        }
    }
}

/// The pixels that triangles cover, whatever hides them; those that reach behind the eye are left out.
fn covered(triangles: &[[DVec3; 3]], view: &View) -> Vec<bool> {
    let [w, h] = view.size.map(|side| side as usize);
    let mut covered = vec![false; w * h];
    for corners in triangles {
        if let [Some(a), Some(b), Some(c)] = corners.map(|corner| view.pixel(corner)) {
            spans([a, b, c].map(|at| at.truncate()), [w, h], |y, xs| {
                covered[y * w + xs.start..y * w + xs.end].fill(true)
            });
        }
    }
    covered
}

/// Visits the pixels whose middles are in a triangle, row by row; pixels from the upper left.
fn spans([a, b, c]: [DVec2; 3], [w, h]: [usize; 2], mut visit: impl FnMut(usize, Range<usize>)) {
    // The first pixel whose middle is not before a coordinate.
    let first = |at: f64, end: usize| (at - 0.5).ceil().clamp(0.0, end as f64) as usize;
    let [low, high] = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
    for row in first(low, h)..first(high, h) {
        let y = row as f64 + 0.5;
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        for [p, q] in [[a, b], [b, c], [c, a]] {
            // Each edge has its lower end and not its upper one, so that a corner counts once.
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
                ends = [ends[0].min(x), ends[1].max(x)];
            }
        }
        let xs = first(ends[0], w)..first(ends[1], w);
        if xs.start < xs.end {
            visit(row, xs);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{geom::Aabb, view::Camera};

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn spans_are_the_pixels_in_a_triangle(p in prop::array::uniform3(prop::array::uniform2(-8.0..40.0_f64))) {
            let [a, b, c] = p.map(DVec2::from);
            let size = [32, 24];
            let mut found = vec![false; size[0] * size[1]];
            spans([a, b, c], size, |y, xs| xs.for_each(|x| found[y * size[0] + x] = true));
            let area = (b - a).perp_dot(c - a);
            for (i, is_found) in found.into_iter().enumerate() {
                let at = DVec2::new((i % size[0]) as f64 + 0.5, (i / size[0]) as f64 + 0.5);
                let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| (q - p).perp_dot(at - p) * area.signum());
                let least = sides.into_iter().fold(f64::INFINITY, f64::min);
                // On an edge either is right; nearer than rounding takes it.
                prop_assert!(least.abs() < 1e-9 || is_found == (least > 0.0), "{at}: {is_found}, {least}");
            }
        }
    }

    #[test]
    fn what_is_hidden_has_a_dashed_edge_and_what_is_seen_none_of_that() {
        let view =
            View::new(Camera::looking(DVec3::new(0.0, -20.0, 0.0), DVec3::ZERO, 0.8), [96, 64], &Aabb::EMPTY).unwrap();
        // A square that faces the eye.
        let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z);
        let square = [
            [corner(-4.0, -4.0), corner(4.0, -4.0), corner(4.0, 4.0)],
            [corner(-4.0, -4.0), corner(4.0, 4.0), corner(-4.0, 4.0)],
        ];
        let covered = covered(&square, &view);
        let depths = vec![20.0; 96 * 64];
        let edge = |shown: &[Option<u32>]| {
            let mut all = Vec::new();
            Picture { size: [96, 64], shown, depths: &depths }.hidden_edge(7, &covered, |i| all.push(i));
            all
        };
        let [low, high] = [corner(-4.0, 4.0), corner(4.0, -4.0)].map(|at| view.pixel(at).unwrap().truncate());
        let is_in = |i: usize, by: f64| {
            let at = DVec2::new((i % 96) as f64 + 0.5, (i / 96) as f64 + 0.5);
            at.cmpge(low + by).all() && at.cmple(high - by).all()
        };
        let hidden = edge(&vec![Some(3); 96 * 64]);
        assert!(hidden.iter().all(|&i| is_in(i, 0.0) && !is_in(i, 1.5)), "at the edge, within it");
        let around = 4.0 * (high - low).x;
        let share = hidden.len() as f64 / around;
        assert!((0.35..0.65).contains(&share), "dashes: {share} of the edge");
        // The left half is seen: only the right half has dashes.
        let half: Vec<Option<u32>> =
            (0..96 * 64).map(|i| Some(if is_in(i, 0.0) && i % 96 < 48 { 7 } else { 3 })).collect();
        let right = edge(&half);
        assert!(!right.is_empty() && right.iter().all(|&i| i % 96 >= 48 + APART), "{right:?}");
        let seen: Vec<Option<u32>> = (0..96 * 64).map(|i| is_in(i, 0.0).then_some(7)).collect();
        assert!(edge(&seen).is_empty());
    }

    #[test]
    fn an_edge_of_what_is_seen_is_not_where_something_before_it_begins() {
        // A row: the object, something else within what it covers, and something beside it.
        let shown = [Some(7), Some(7), Some(7), Some(3), Some(3), Some(3), Some(3), Some(3)];
        let covered = [true, true, true, true, true, true, false, false];
        let edge = |depth_of_other: f32, covered: &[bool]| {
            let depths = [vec![20.0; 3], vec![depth_of_other; 5]].concat();
            let mut all = Vec::new();
            Picture { size: [8, 1], shown: &shown, depths: &depths }.seen_edge(7, 1, covered, |i| all.push(i));
            all
        };
        assert!(edge(10.0, &covered).is_empty(), "before it");
        assert_eq!(edge(30.0, &covered), [2], "behind it: it is cut there");
        assert_eq!(edge(10.0, &[]), [2], "nobody knows what it covers");
        let beside = [true, true, true, false, false, false, false, false];
        assert_eq!(edge(10.0, &beside), [2], "beside it");
    }
}
