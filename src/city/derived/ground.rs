//! The ground that flattened objects lie on: terrain, water, roads and land use, as far as they are shown.

use glam::{DVec2, DVec3};

use super::source::{Face, Source};
use crate::{
    city::model::CityModel,
    geom::{Aabb, bvh::Bvh, plane::Plane},
};

/// Ground steeper than this holds nothing that lies on it: sine of the rise.
const STEEPEST: f64 = 0.02;

/// Triangles of the ground, found by place.
#[derive(Debug)]
pub(super) struct GroundFaces {
    faces: Vec<GroundFace>,
    bvh: Bvh,
}

/// A triangle of the ground.
#[derive(Clone, Debug)]
pub(super) struct GroundFace {
    /// Seen from above, counter-clockwise, metres.
    pub corners: [DVec2; 3],
    /// Its plane; the normal looks up.
    pub plane: Plane,
    /// Number of its plane in the model; 0: it shares it with no other.
    pub group: u32,
}

impl GroundFace {
    fn new(face: &Face, group: u32) -> Option<Self> {
        let normal = face.normal();
        let normal = if normal.z < 0.0 { -normal } else { normal }.try_normalize()?;
        let [a, b, c] = face.corners.map(DVec3::truncate);
        let corners = if (b - a).perp_dot(c - a) < 0.0 { [a, c, b] } else { [a, b, c] };
        let plane = Plane { normal, offset: normal.dot(face.corners[0]) };
        (normal.z > STEEPEST).then_some(Self { corners, plane, group })
    }

    /// Its height, metres.
    pub fn height(&self, p: DVec2) -> f64 {
        let Plane { normal, offset } = self.plane;
        (offset - normal.x * p.x - normal.y * p.y) / normal.z
    }
}

impl GroundFaces {
    /// That of the geometries `shown`; `None` where there is none.
    pub fn new(model: &CityModel, shown: &[u32]) -> Option<Self> {
        let geometries = shown.iter().map(|&number| &model.geometries[number as usize]);
        let ground = geometries.filter(|g| model.objects[g.object as usize].class.is_ground());
        let tiles = ground.flat_map(|g| &model.tiles[g.tiles.start as usize..g.tiles.end as usize]);
        let triangles = tiles.flat_map(|tile| (tile.indices.start / 3..tile.indices.end / 3).map(move |t| (tile, t)));
        let faces: Vec<GroundFace> = triangles
            .filter_map(|(tile, t)| GroundFace::new(&Source::triangle(model, tile, t), model.planes[t as usize]))
            .collect();
        // By place only: all at one height.
        let boxes: Vec<Aabb> = faces.iter().map(|f| Aabb::from_points(f.corners.map(|p| p.extend(0.0)))).collect();
        (!faces.is_empty()).then(|| Self { bvh: Bvh::build(&boxes), faces })
    }

    /// Those below the box around some points, by number.
    pub fn below(&self, corners: &[DVec2]) -> Vec<(u32, &GroundFace)> {
        let mut found = Vec::new();
        let around = Aabb::from_points(corners.iter().map(|p| p.extend(0.0)));
        self.bvh.in_box(&around, |i| found.push((i, &self.faces[i as usize])));
        found.sort_unstable_by_key(|(i, _)| *i);
        found
    }

    /// The plane of one of them, raised.
    pub fn plane(&self, number: u32, lift: f64) -> Plane {
        let Plane { normal, offset } = self.faces[number as usize].plane;
        Plane { normal, offset: offset + normal.z * lift }
    }
}
