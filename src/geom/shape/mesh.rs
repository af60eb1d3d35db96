//! Closed meshes of lens volumes.

use std::collections::BTreeMap;

use glam::DVec3;

/// A closed triangle mesh, world metres, counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub points: Vec<DVec3>,
    /// Indices into `points`.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Volume by the divergence theorem, m³; exact for closed meshes up to rounding, positive when oriented outwards.
    pub fn volume_m3(&self) -> f64 {
        let origin = self.points.first().copied().unwrap_or(DVec3::ZERO);
        let corner = |i: u32| self.points[i as usize] - origin;
        self.triangles.iter().map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0).sum()
    }

    /// The first fault: an edge without exactly one twin, an index out of range, a number that is none.
    pub fn validate(&self) -> Result<(), String> {
        if let Some(i) = self.points.iter().position(|p| !p.is_finite()) {
            return Err(format!("point {i} is not finite"));
        }
        let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for t in &self.triangles {
            if t.iter().any(|i| *i as usize >= self.points.len()) {
                return Err(format!("triangle {t:?} points past the {} points", self.points.len()));
            }
            for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
                *edges.entry([a, b]).or_default() += 1;
            }
        }
        let fault = edges.iter().find(|([a, b], n)| **n != 1 || edges.get(&[*b, *a]) != Some(&1));
        fault.map_or(Ok(()), |([a, b], _)| Err(format!("edge {a}-{b} is not shared by exactly two triangles")))
    }
}
