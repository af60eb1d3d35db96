//! What is measured of the geometry of objects and faces: heights, areas, volumes, slopes, directions.
//!
//! It is of what is shown by default ([`shown_geometries`]): of each object its finest level of detail, of a whole that its parts stand for
//! all of these together. Measured when first asked for.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use crate::city::{
    closed::edges,
    derived::footprints,
    kept_measures::{Face, OfFaces, Sums},
    model::{CityModel, NONE, StringId, Value, decode_normal},
    shown::shown_geometries,
};

/// Slope below which a face looks in no direction, degrees.
pub const LEVEL_DEG: f64 = 1.0;
/// Cosine of the slope from which on a face is a wall and no roof: 75°.
const STEEPEST_ROOF: f64 = 0.259;

/// What is measured of objects; terrain, water, roads and land use have nothing of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfObject {
    /// From the lowest to the highest vertex, metres.
    Height,
    /// Of the ground that it covers seen from above, square metres.
    Area,
    /// What its faces enclose, cubic metres; none where they are not closed.
    Volume,
    /// Of the faces that look up and are no walls, the mean by area, degrees: 0 is level.
    Slope,
    /// Where most of the area of these faces looks, of those that are not level, degrees clockwise from north.
    Azimuth,
}

/// Slope of a face, degrees, 0 (level) to 90 (upright), whichever side is up.
pub fn slope_deg(normal: DVec3) -> f64 {
    normal.z.abs().min(1.0).acos().to_degrees()
}

/// Where a face looks, degrees clockwise from north, 0 to 360; `None`: it is level.
pub fn azimuth_deg(normal: DVec3) -> Option<f64> {
    let turned = normal.x.atan2(normal.y).to_degrees().rem_euclid(360.0);
    // What is a rounding error left of north is north.
    let turned = if turned < 360.0 { turned } else { 0.0 };
    (slope_deg(normal) >= LEVEL_DEG).then_some(turned)
}

impl CityModel {
    /// Of each object what was measured, NaN where there is nothing of it.
    pub fn measured_of_objects(&self, what: OfObject) -> Vec<f64> {
        if what == OfObject::Area {
            return self.measured.areas.get_or_init(|| areas(self)).clone();
        }
        let found = self.measured.faces.get_or_init(|| of_faces(self));
        if what == OfObject::Azimuth {
            return found.azimuths.clone();
        }
        let one = |(object, sums): (usize, &Sums)| match what {
            _ if sums.low > sums.high || self.objects[object].class.is_ground() => f64::NAN,
            OfObject::Height => sums.high - sums.low,
            OfObject::Volume if sums.edges == 0 && sums.volume != 0.0 => sums.volume.abs() / 6.0,
            OfObject::Slope if sums.roof > 0.0 => sums.sloped / sums.roof,
            _ => f64::NAN,
        };
        found.sums.iter().enumerate().map(one).collect()
    }

    /// An attribute of a semantic surface, or of the nearest that it is part of: of one with number `detail` ([`CityModel::details`]).
    pub fn attribute_of_surface(&self, detail: u32, name: StringId) -> Option<Value> {
        let mut at = detail;
        // Ways up end, as loaders see to.
        for _ in 0..=self.details.len() {
            let found = self.details.get(at as usize)?;
            let own = &self.attributes[found.attributes.start as usize..found.attributes.end as usize];
            if let Some(attribute) = own.iter().find(|a| a.name == name) {
                return Some(attribute.value);
            }
            at = found.parent;
        }
        None
    }

    /// Of each object whether it is shown by default.
    pub fn shown_objects(&self) -> &[bool] {
        self.measured.shown.get_or_init(|| is_shown(self, &shown_geometries(self, None)))
    }

    /// All faces of what is shown by default.
    pub fn measured_faces(&self) -> &[Face] {
        &self.measured.faces.get_or_init(|| of_faces(self)).faces
    }
}

/// The corners of a triangle of a tile, metres, and its surface and packed normal.
fn corners(model: &CityModel, tile: &crate::city::model::Tile, triangle: u32) -> ([DVec3; 3], u32, u32) {
    let first = &model.vertices[(tile.vertices.start + model.indices[3 * triangle as usize]) as usize];
    (model.corners(tile, triangle), first.surface, first.normal)
}

/// The objects that are shown as parts of others, which are not, with these.
fn wholes(model: &CityModel, is_shown: &[bool]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for part in (0..model.objects.len() as u32).filter(|o| is_shown[*o as usize]) {
        let mut at = part;
        // Ways up end, as loaders see to; as far as there are objects, whatever a model says.
        for _ in 0..model.objects.len() {
            let Some(&parent) = model.objects[at as usize].parents.first() else { break };
            if !is_shown[parent as usize] {
                pairs.push((part, parent));
            }
            at = parent;
        }
    }
    pairs
}

fn is_shown(model: &CityModel, shown: &[u32]) -> Vec<bool> {
    let mut is_shown = vec![false; model.objects.len()];
    shown.iter().for_each(|g| is_shown[model.geometries[*g as usize].object as usize] = true);
    is_shown
}

fn of_faces(model: &CityModel) -> OfFaces {
    let shown = shown_geometries(model, None);
    let mut sums = vec![Sums::NONE; model.objects.len()];
    let mut areas: FxHashMap<(u32, u32, u32), f64> = FxHashMap::default();
    for geometry in shown.iter().map(|g| &model.geometries[*g as usize]) {
        let tiles = &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
        let Some(middle) = tiles.first().map(|tile| tile.bounds.center()) else { continue };
        for tile in tiles {
            for triangle in tile.indices.start / 3..tile.indices.end / 3 {
                let (places, surface, normal) = corners(model, tile, triangle);
                // Each geometry is closed for itself, so its middle is as good an origin as any.
                let [a, b, c] = places.map(|place| place - middle);
                let doubled = (b - a).cross(c - a);
                let area = 0.5 * doubled.length();
                let upward = doubled.z / doubled.length().max(f64::MIN_POSITIVE);
                let is_roof = upward >= STEEPEST_ROOF;
                let one = Sums {
                    low: places.iter().map(|p| p.z).fold(f64::INFINITY, f64::min),
                    high: places.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max),
                    edges: edges(places),
                    volume: a.dot(b.cross(c)),
                    roof: if is_roof { area } else { 0.0 },
                    sloped: if is_roof { area * upward.min(1.0).acos().to_degrees() } else { 0.0 },
                };
                let found = model.surfaces.get(surface as usize);
                let (object, detail) = found.map_or((geometry.object, NONE), |s| (s.object, s.detail));
                sums[object as usize].add(&one);
                *areas.entry((object, normal, detail)).or_default() += area;
            }
        }
    }
    let wholes = wholes(model, &is_shown(model, &shown));
    let face = |((object, normal, detail), area)| Face { object, normal, detail, area };
    let mut faces: Vec<Face> = areas.into_iter().map(face).collect();
    faces.sort_unstable_by_key(|face| (face.object, face.normal, face.detail));
    let azimuths = azimuths(model, &faces, &wholes);
    for (part, whole) in wholes {
        let own = sums[part as usize];
        sums[whole as usize].add(&own);
    }
    OfFaces { sums, faces, azimuths }
}

/// Of each object the direction in which most of the area of its sloped roofs looks, to the degree that a face has; equal areas: the first by its
/// normal.
fn azimuths(model: &CityModel, faces: &[Face], wholes: &[(u32, u32)]) -> Vec<f64> {
    let mut by_degree: FxHashMap<(u32, u32), (f64, f64)> = FxHashMap::default();
    let mut owners: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    wholes.iter().for_each(|(part, whole)| owners.entry(*part).or_default().push(*whole));
    let is_ground = |face: &&Face| model.objects[face.object as usize].class.is_ground();
    for face in faces.iter().filter(|face| !is_ground(face)) {
        let normal = decode_normal(face.normal);
        let Some(azimuth) = azimuth_deg(normal).filter(|_| normal.z >= STEEPEST_ROOF) else { continue };
        for owner in owners.get(&face.object).into_iter().flatten().chain([&face.object]) {
            let place = by_degree.entry((*owner, azimuth.round() as u32 % 360)).or_insert((0.0, azimuth));
            place.0 += face.area;
        }
    }
    let mut found = vec![(0.0, f64::NAN); model.objects.len()];
    let mut all: Vec<_> = by_degree.into_iter().collect();
    all.sort_unstable_by_key(|(key, _)| *key);
    for ((object, _), (area, azimuth)) in all {
        let best = &mut found[object as usize];
        if area > best.0 {
            *best = (area, azimuth);
        }
    }
    found.into_iter().map(|(_, azimuth)| azimuth).collect()
}

/// Of each object the ground that it covers, square metres, NaN where it covers none.
fn areas(model: &CityModel) -> Vec<f64> {
    let shown = shown_geometries(model, None);
    let mut areas = vec![f64::NAN; model.objects.len()];
    for footprint in footprints(model, &shown, true) {
        let area: f64 = footprint.parts.iter().flatten().map(|ring| ring_area(ring)).sum();
        footprint.objects.iter().for_each(|object| areas[*object as usize] = area);
    }
    for (part, whole) in wholes(model, &is_shown(model, &shown)) {
        let own = areas[part as usize];
        if own.is_finite() {
            let whole = &mut areas[whole as usize];
            *whole = if whole.is_finite() { *whole + own } else { own };
        }
    }
    areas
}

/// Negative of a ring that runs clockwise.
fn ring_area(ring: &[DVec2]) -> f64 {
    let Some(&first) = ring.first() else { return 0.0 };
    ring.windows(2).map(|w| 0.5 * (w[0] - first).perp_dot(w[1] - first)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{
        ObjectClass,
        load::{LoadOptions, Quiet, load},
        test_city::{add, add_box, builder},
    };

    fn of(model: &CityModel, object: usize) -> [f64; 5] {
        [OfObject::Height, OfObject::Area, OfObject::Volume, OfObject::Slope, OfObject::Azimuth]
            .map(|what| model.measured_of_objects(what)[object])
    }

    fn close(found: [f64; 5], expected: [f64; 5]) -> bool {
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-2 || (a.is_nan() && b.is_nan()))
    }

    #[test]
    fn boxes_houses_and_what_is_open() {
        let mut builder = builder();
        add_box(&mut builder, "box", [0, 0, 5_000], [10_000, 20_000, 12_000]);
        // A saddle roof, its ridge along y: 4 m above eaves 3 m away; to the west it is longer by a little: its eaves lie lower.
        let points = vec![
            [0, 0, 0],
            [6_000, 0, 0],
            [6_000, 10_000, 0],
            [0, 10_000, 0],
            [0, 0, 5_000],
            [6_000, 0, 5_000],
            [6_000, 10_000, 5_000],
            [0, 10_000, 5_000],
            [4_000, 0, 9_000],
            [4_000, 10_000, 9_000],
        ];
        let faces: [&[u32]; 7] = [
            &[0, 3, 2, 1],
            &[0, 1, 5, 8, 4],
            &[2, 3, 7, 9, 6],
            &[1, 2, 6, 5],
            &[3, 0, 4, 7],
            &[4, 8, 9, 7],
            &[5, 6, 9, 8],
        ];
        let faces: Vec<Vec<u32>> = faces.iter().map(|f| f.to_vec()).collect();
        add(&mut builder, "house", ObjectClass::Building, None, points.clone(), &faces);
        add(&mut builder, "open", ObjectClass::Building, None, points.clone(), &faces[1..]);
        add(&mut builder, "land", ObjectClass::Terrain, None, points, &[vec![4, 5, 6, 7]]);
        let model = builder.finish();
        assert!(close(of(&model, 0), [7.0, 200.0, 1400.0, 0.0, f64::NAN]), "{:?}", of(&model, 0));
        // West: 4 up in 4, 45°; east: 4 in 2, 63.4°. Weighed by 40√2 and 20√5.
        let [west, east] = [(40.0 * 2.0_f64.sqrt(), 45.0), (20.0 * 5.0_f64.sqrt(), 2.0_f64.atan().to_degrees())];
        let slope = (west.0 * west.1 + east.0 * east.1) / (west.0 + east.0);
        let volume = 60.0 * 5.0 + 0.5 * 6.0 * 4.0 * 10.0;
        assert!(close(of(&model, 1), [9.0, 60.0, volume, slope, 270.0]), "{:?}", of(&model, 1));
        assert!(close(of(&model, 2), [9.0, 60.0, f64::NAN, slope, 270.0]), "{:?}", of(&model, 2));
        assert!(close(of(&model, 3), [f64::NAN; 5]), "{:?}", of(&model, 3));
        // A box has six faces, the house seven.
        let faces = |object: u32| model.measured_faces().iter().filter(|f| f.object == object).count();
        assert_eq!([0, 1, 2, 3].map(faces), [6, 7, 6, 1]);
        let area: f64 = model.measured_faces().iter().filter(|f| f.object == 0).map(|f| f.area).sum();
        assert!((area - 2.0 * (200.0 + 70.0 + 140.0)).abs() < 1e-6);
        // What was measured belongs to the model that it was measured of.
        let mut other = model.clone();
        other.vertices.iter_mut().for_each(|vertex| vertex.position[2] *= 0.5);
        assert_eq!([&model, &other].map(|m| m.measured_of_objects(OfObject::Height)[0]), [7.0, 3.5]);
    }

    #[test]
    fn a_whole_has_what_its_parts_have_together() {
        let city = concat!(env!("CARGO_MANIFEST_DIR"), "/citydata/lod-part.city.json");
        let model = load(&[city.into()], &LoadOptions::default(), &Quiet).expect("a city");
        let shown = is_shown(&model, &shown_geometries(&model, None));
        let whole = (0..model.objects.len()).find(|o| !shown[*o]).expect("a whole that is not shown");
        let parts: Vec<usize> = (0..model.objects.len())
            .filter(|o| shown[*o] && model.objects[*o].parents.contains(&(whole as u32)))
            .collect();
        assert!(!parts.is_empty());
        let sum = |what| parts.iter().map(|part| model.measured_of_objects(what)[*part]).sum::<f64>();
        for what in [OfObject::Area, OfObject::Volume] {
            let found = model.measured_of_objects(what)[whole];
            assert!((found - sum(what)).abs() < 1e-6 || (found.is_nan() && sum(what).is_nan()), "{what:?}: {found}");
        }
        assert!(model.measured_of_objects(OfObject::Height)[whole] > 0.0);
    }

    #[test]
    fn directions_and_slopes_of_normals() {
        let cases = [
            ([0.0, 1.0, 0.0], 90.0, Some(0.0)),
            ([1.0, 0.0, 0.0], 90.0, Some(90.0)),
            ([0.0, -1.0, 1.0], 45.0, Some(180.0)),
            ([-1.0, 0.0, -1.0], 45.0, Some(270.0)),
            ([0.0, 0.0, 1.0], 0.0, None),
            ([0.01, 0.0, 1.0], 0.572_938_697_683_486, None),
        ];
        for (normal, slope, azimuth) in cases {
            let normal = DVec3::from(normal).normalize_or(DVec3::Z);
            assert!((slope_deg(normal) - slope).abs() < 1e-9, "{normal}");
            assert_eq!(azimuth_deg(normal).map(f64::round), azimuth, "{normal}");
        }
    }
}
