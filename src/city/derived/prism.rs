//! `prism`: an object as its footprint, drawn up from its lowest to its highest point.
//!
//! The footprint is the union of its faces that look up, seen from above (of what has none, of those that look down), so it
//! holds roofs that reach over walls too. [`outline::union`] says how exact it is; lattice units are millimetres.

use super::bodies::{Body, Triangles, span};

use crate::{
    city::derived::form::Form,
    geom::{
        exact::orient,
        outline::{self, Point},
        triangulate::Triangulator,
    },
};

pub(super) fn body(triangles: &Triangles, _: &Form) -> Option<Body> {
    let seen = |side: i128| -> Vec<[Point; 3]> {
        let from_above = triangles.iter().map(|t| t.map(|p| [p[0], p[1]]));
        from_above.filter(|[a, b, c]| orient(*a, *b, *c).signum() == side).collect()
    };
    let mut faces = seen(1);
    if faces.is_empty() {
        faces = seen(-1);
    }
    let figure = outline::union(&faces);
    // Rounding may make rings cross: such an object has no prism that is closed.
    let is_sound = |rings: &outline::Part| {
        let points: Vec<[i64; 3]> = rings.iter().flatten().map(|p| [p[0], p[1], 0]).collect();
        let ends: Vec<u32> = rings
            .iter()
            .scan(0, |end, ring| {
                *end += ring.len() as u32;
                Some(*end)
            })
            .collect();
        Triangulator::default().triangulate(&points, &ends, &mut Vec::new()).is_ok()
    };
    if !figure.iter().all(is_sound) {
        return None;
    }
    Body::upright(&figure, span(triangles))
}
