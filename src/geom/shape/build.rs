//! Meshes that volumes are drawn or bounded by.

use std::{collections::BTreeMap, f64::consts::TAU};

use glam::{DMat3, DQuat, DVec3};

use crate::geom::shape::mesh::Mesh;

/// Refinements of the icosahedron: 4 × as many triangles each; 2 gives 320.
pub(super) const BOUNDING_LEVEL: u32 = 2;
/// Bounding meshes of round shapes are this much larger than need be, against rounding to f32.
pub(super) const GROWTH: f64 = 1.0 + 1e-5;

pub(super) fn placed(mut unit: Mesh, center: DVec3, scale: f64) -> Mesh {
    for p in &mut unit.points {
        *p = center + scale * *p;
    }
    unit
}

pub(super) fn stretched(mut unit: Mesh, center: DVec3, radii: DVec3, rotation: DQuat) -> Mesh {
    for p in &mut unit.points {
        *p = center + rotation * (radii * *p);
    }
    unit
}

/// Corner `i` of a box: bits 0, 1, 2 choose + on x, y, z, as in [`crate::geom::aabb::Aabb::corners`].
pub(super) fn cuboid(center: DVec3, half: DVec3, rotation: DQuat) -> Mesh {
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let points = (0..8).map(|i| center + rotation * (half * DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh { points, triangles: quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect() }
}

/// A regular prism around `axis` (unit), of these radii at bottom and top; the last two points are the middles of these.
pub(super) fn prism(center: DVec3, radii: [f64; 2], half: f64, axis: DVec3, sides: u32) -> Mesh {
    let (u, v) = axis.any_orthonormal_pair();
    let spoke = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
        cos * u + sin * v
    };
    let ring = |radius: f64, h: f64| (0..sides).map(move |i| center + h * axis + radius * spoke(i));
    let points =
        ring(radii[0], -half).chain(ring(radii[1], half)).chain([center - half * axis, center + half * axis]).collect();
    let (bottom, top) = (2 * sides, 2 * sides + 1);
    let triangles = (0..sides)
        .flat_map(|i| {
            let j = (i + 1) % sides;
            [[i, j, sides + j], [i, sides + j, sides + i], [bottom, j, i], [top, sides + i, sides + j]]
        })
        .collect();
    Mesh { points, triangles }
}

/// The icosahedron, each triangle cut into four `level` times, on the unit sphere.
pub(super) fn icosphere(level: u32) -> Mesh {
    let g = 0.5 * (1.0 + 5_f64.sqrt());
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) / (1.0 + g * g).sqrt();
    #[rustfmt::skip]
    let points = vec![
        corner(-1.0, g, 0.0), corner(1.0, g, 0.0), corner(-1.0, -g, 0.0), corner(1.0, -g, 0.0),
        corner(0.0, -1.0, g), corner(0.0, 1.0, g), corner(0.0, -1.0, -g), corner(0.0, 1.0, -g),
        corner(g, 0.0, -1.0), corner(g, 0.0, 1.0), corner(-g, 0.0, -1.0), corner(-g, 0.0, 1.0),
    ];
    #[rustfmt::skip]
    let triangles = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
        [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
        [8, 6, 7], [9, 8, 1],
    ];
    (0..level).fold(Mesh { points, triangles }, |mesh, _| quartered(mesh))
}

pub(super) fn quartered(mesh: Mesh) -> Mesh {
    let mut points = mesh.points;
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for [a, b, c] in mesh.triangles {
        let mut middle = |i: u32, j: u32| {
            *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                points.push((points[i as usize] + points[j as usize]).normalize_or_zero());
                points.len() as u32 - 1
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { points, triangles }
}

/// Corners of a box, by its axes.
pub(super) fn corners_of_box(center: DVec3, axes: DMat3, half: DVec3) -> Vec<DVec3> {
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    (0..8).map(|i| center + axes * (half * DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))).collect()
}
