//! The facades of an object as samples: places of equal area, spread evenly, the same in every run.

use glam::DVec3;

use crate::city::{CityModel, NONE, StringId, Tile};

/// Samples of an object.
pub(super) const SAMPLES: usize = 512;

/// Semantic surfaces that are not seen from outside: below the object, or in it.
const UNSEEN: [&str; 4] = ["GroundSurface", "InteriorWallSurface", "FloorSurface", "CeilingSurface"];
/// Those that are seen whichever way they look.
const OUTER: [&str; 2] = ["RoofSurface", "WallSurface"];
/// Faces of any other kind, or of none, are ground where they look down by more than this (the sine of 75°).
const DOWN: f64 = -0.966;

/// A place on a facade.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Metres.
    pub at: DVec3,
    /// The normal of its face, unit.
    pub normal: DVec3,
    /// Its triangle, by index into [`CityModel::planes`].
    pub triangle: u32,
    /// Its weight: 1 − ½·n_z².
    pub weight: f64,
}

/// Samples of the facades of an object.
#[derive(Debug)]
pub(super) struct Facades {
    /// [`SAMPLES`] of them, each of the same area.
    pub samples: Vec<Sample>,
    /// The sum of their weights, > 0.
    pub weight: f64,
}

struct Face {
    corners: [DVec3; 3],
    triangle: u32,
    area: f64,
    normal: DVec3,
    is_facade: bool,
}

impl Facades {
    /// The facades of some geometries: all faces but those that are not seen from outside; all where these are all. `None` where nothing has an area.
    pub fn new(model: &CityModel, geometries: &[u32]) -> Option<Self> {
        let [unseen, outer] = [&UNSEEN[..], &OUTER]
            .map(|names| -> Vec<StringId> { names.iter().filter_map(|name| model.strings.find(name)).collect() });
        let mut faces: Vec<Face> = tiles(model, geometries)
            .flat_map(|tile| (tile.indices.start / 3..tile.indices.end / 3).map(move |triangle| (tile, triangle)))
            .filter_map(|(tile, triangle)| {
                let vertices = [0, 1, 2].map(|k| tile.vertices.start + model.indices[3 * triangle as usize + k]);
                let corners = vertices.map(|vertex| model.position(tile, vertex));
                let [a, b, c] = corners;
                let doubled = (b - a).cross(c - a);
                let normal = doubled.try_normalize()?;
                let surface = model.vertices[vertices[0] as usize].surface;
                let kind = model.surfaces.get(surface as usize).map_or(StringId(NONE), |s| s.kind);
                let is_facade = !unseen.contains(&kind) && (outer.contains(&kind) || normal.z >= DOWN);
                Some(Face { corners, triangle, area: 0.5 * doubled.length(), normal, is_facade })
            })
            .collect();
        if faces.iter().any(|face| face.is_facade) {
            faces.retain(|face| face.is_facade);
        }
        let samples = spread(&faces);
        let weight = samples.iter().map(|sample| sample.weight).sum::<f64>();
        (weight > 0.0).then_some(Self { samples, weight })
    }
}

/// Each sample stands for the same area: the k-th is on the face that holds the (k+½)-th part of all area, faces laid end to end, so a
/// face has its share of them to less than one. On it, by the sequence R2 (Roberts 2018), folded into the triangle.
fn spread(faces: &[Face]) -> Vec<Sample> {
    /// 1/φ₂ and 1/φ₂², φ₂³ = φ₂ + 1.
    const R2: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let all: f64 = faces.iter().map(|face| face.area).sum();
    if !(all > 0.0 && all.is_finite()) {
        return Vec::new();
    }
    let mut before = 0.0;
    let mut at = 0;
    let sample = |k: usize| {
        let wanted = (k as f64 + 0.5) / SAMPLES as f64 * all;
        while at + 1 < faces.len() && before + faces[at].area <= wanted {
            before += faces[at].area;
            at += 1;
        }
        let face = &faces[at];
        let [mut u, mut v] = R2.map(|step| (0.5 + step * (k + 1) as f64).fract());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = face.corners;
        let weight = 1.0 - 0.5 * face.normal.z * face.normal.z;
        Sample { at: a + u * (b - a) + v * (c - a), normal: face.normal, triangle: face.triangle, weight }
    };
    (0..SAMPLES).map(sample).collect()
}

/// The corners of all faces of some geometries, metres.
pub(super) fn corners(model: &CityModel, geometries: &[u32]) -> Vec<DVec3> {
    tiles(model, geometries).flat_map(|tile| tile.vertices.clone().map(|v| model.position(tile, v))).collect()
}

fn tiles<'a>(model: &'a CityModel, geometries: &'a [u32]) -> impl Iterator<Item = &'a Tile> {
    let own = geometries.iter().map(|&g| &model.geometries[g as usize]);
    own.flat_map(|g| &model.tiles[g.tiles.start as usize..g.tiles.end as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{
        ObjectClass,
        test_city::{add, add_box, builder},
    };

    #[test]
    fn faces_have_their_share_and_samples_lie_on_them() {
        let mut city = builder();
        add_box(&mut city, "box", [0, 0, 0], [10_000, 20_000, 6_000]);
        let model = city.finish();
        let facades = Facades::new(&model, &[0]).unwrap();
        assert_eq!(facades.samples.len(), SAMPLES);
        // 120, 120, 60, 60 and a roof of 200; what looks down is none.
        let across = |axis: DVec3| facades.samples.iter().filter(|s| s.normal.dot(axis) > 0.9).count() as f64;
        for (axis, area) in [
            (DVec3::X, 120.0),
            (-DVec3::X, 120.0),
            (DVec3::Y, 60.0),
            (-DVec3::Y, 60.0),
            (DVec3::Z, 200.0),
            (-DVec3::Z, 0.0),
        ] {
            // Two triangles each.
            assert!((across(axis) - area / 560.0 * SAMPLES as f64).abs() < 2.0, "{axis}: {}", across(axis));
        }
        let origin = model.geometries[0].bounds.min;
        for sample in &facades.samples {
            let p = sample.at - origin;
            let sides = [p.x, 10.0 - p.x, p.y, 20.0 - p.y, 6.0 - p.z];
            assert!(sides.iter().any(|side| side.abs() < 1e-9) && sides.iter().all(|side| *side > -1e-9), "{p}");
            assert!((sample.weight - if sample.normal.z > 0.9 { 0.5 } else { 1.0 }).abs() < 1e-9);
        }
        // Each face is filled evenly: as many in each quarter of the roof.
        let roof: Vec<DVec3> = facades.samples.iter().filter(|s| s.normal.z > 0.9).map(|s| s.at - origin).collect();
        for (x, y) in [(0.0, 0.0), (5.0, 0.0), (0.0, 10.0), (5.0, 10.0)] {
            let quarter = roof.iter().filter(|p| p.x >= x && p.x < x + 5.0 && p.y >= y && p.y < y + 10.0).count();
            assert!((quarter as f64 - 0.25 * roof.len() as f64).abs() < 6.0, "{quarter} of {}", roof.len());
        }
    }

    #[test]
    fn ground_and_rooms_are_no_facades_unless_there_is_nothing_else() {
        let mut city = builder();
        let square = |z: i64| vec![[0, 0, z], [9_000, 0, z], [9_000, 9_000, z], [0, 9_000, z]];
        let up = [vec![0, 1, 2, 3]];
        add(&mut city, "ground", ObjectClass::Building, Some("GroundSurface"), square(0), &up);
        add(&mut city, "roof", ObjectClass::Building, Some("RoofSurface"), square(5_000), &[vec![0, 3, 2, 1]]);
        add(&mut city, "floor", ObjectClass::Building, Some("FloorSurface"), square(2_000), &up);
        let model = city.finish();
        let heights = |geometries: &[u32]| -> Vec<f64> {
            let mut z: Vec<f64> = Facades::new(&model, geometries).unwrap().samples.iter().map(|s| s.at.z).collect();
            z.dedup();
            z
        };
        assert_eq!(heights(&[0, 1, 2]), [5.0], "a roof is one even if it looks down");
        assert_eq!(heights(&[0]), [0.0]);
        assert_eq!(heights(&[0, 2]), [0.0, 2.0]);
        assert!(Facades::new(&model, &[]).is_none());
    }
}
