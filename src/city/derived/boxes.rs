//! `box`: an object as its bounding box.

use super::bodies::{Body, Triangles, span};

use crate::{
    city::derived::form::Form,
    geom::outline::{convex, smallest_rectangle},
};

/// The box along the axes; or the upright one on the smallest rectangle around the footprint, its corners rounded to the lattice.
pub(super) fn body(triangles: &Triangles, form: &Form) -> Option<Body> {
    let points = || triangles.iter().flatten();
    let [x, y] = [0, 1].map(|axis| {
        let all = || points().map(|p| p[axis]);
        [all().min().unwrap_or(0), all().max().unwrap_or(0)]
    });
    if x[0] >= x[1] || y[0] >= y[1] {
        return None;
    }
    let mut ring = vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
    if matches!(form, Form::Box { oriented: true }) {
        let hull = convex(points().map(|p| [p[0], p[1]]));
        if hull.len() < 3 {
            return None;
        }
        ring = smallest_rectangle(&hull).map(|p| p.round().to_array().map(|x| x as i64)).to_vec();
    }
    Body::upright(&[vec![ring]], span(triangles))
}
