//! `hull`: an object as its convex hull. Exact on the lattice: which faces it has is decided by exact predicates.

use super::{
    bodies::{Body, Triangles},
    source::{Part, STEEPEST_ROOF},
};
use glam::DVec3;

use crate::{
    city::derived::form::Form,
    geom::{outline::convex, shape::Hull},
};

pub(super) fn body(triangles: &Triangles, _: &Form) -> Option<Body> {
    let mut points: Vec<[i64; 3]> = triangles.iter().flatten().map(|&[x, y, z]| [z, x, y]).collect();
    points.sort_unstable();
    points.dedup();
    // Corners of the hull are corners of the hull of their height.
    let outer: Vec<DVec3> = points
        .chunk_by(|a, b| a[0] == b[0])
        .flat_map(|level| {
            let height = level[0][0] as f64;
            convex(level.iter().map(|&[_, x, y]| [x, y]))
                .into_iter()
                .map(move |[x, y]| DVec3::new(x as f64, y as f64, height))
        })
        .collect();
    let hull = Hull::new(&outer).ok()?;
    let (corners, faces) = hull.faces();
    let mut body = Body::default();
    for face in faces {
        let [a, b, c] = face.map(|i| corners[i as usize]);
        let normal = (b - a).cross(c - a);
        let part = match normal.z / normal.length() {
            slope if slope.abs() < STEEPEST_ROOF => Part::Wall,
            slope if slope > 0.0 => Part::Roof,
            _ => Part::Ground,
        };
        body.face(part, [[a, b, c].map(|p| p.round().to_array().map(|x| x as i64)).to_vec()]);
    }
    Some(body)
}
