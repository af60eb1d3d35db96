//! A plain ground under a city and around it, so that buildings stand on something, and the picture does not end where the data does.
//!
//! A height field through the bases of the buildings, just below terrain, roads, water and land where files have them: it shows where
//! they have gaps, and beyond their rim. Between what is known heights are smooth; around the city they level out, up to where the ground
//! has faded into what is behind it. It is no part of the model: `info`, the picker and the lists of objects never see it.

mod field;
mod net;

use std::ops::Range;

use glam::{DVec2, DVec3, IVec3, Vec3};
use rustc_hash::FxHashMap;

use crate::{
    city::{
        ground::field::HeightField,
        model::{CityModel, NONE, ObjectClass, Tile, Vertex, encode_normal},
    },
    geom::Aabb,
};

/// The distance of the ground below the bases, metres: enough for depth to tell it from ground floors.
pub const BELOW_M: f64 = 0.04;
/// The same below terrain, roads, water and land: about as much, so that what is level stays so, and more than its triangles are off.
pub const BELOW_TERRAIN_M: f64 = 0.06;
/// Around the city the ground is as it is below it for at least so many metres, ...
const LEAST_MARGIN_M: f64 = 60.0;
/// ... and this part of the diagonal of its extent.
const MARGIN: f64 = 0.12;
/// From there on it fades: over so many diagonals, ...
const FADE: f64 = 0.8;
/// ... and at least so many metres.
const LEAST_FADE_M: f64 = 300.0;
/// Families of buildings (a building and its parts) share a base up to this size, metres; larger ones are groups.
const LARGEST_FAMILY_M: f64 = 500.0;

/// A plain ground: tiles as in the model, but of no geometry, with surface [`NONE`].
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Its tiles; `geometry` and `texcoords` are [`NONE`].
    pub tiles: Vec<Tile>,
    /// Which of them lie below the city, and within its margin; the others around it.
    pub below: Range<usize>,
    /// Whether the city has terrain, roads, water or land of its own: then this fills their gaps, and the city ends where it did.
    pub is_filling: bool,
    /// Vertices, grouped by tile; `surface` is [`NONE`].
    pub vertices: Vec<Vertex>,
    /// Three per triangle, counter-clockwise from above, relative to the tile's first vertex.
    pub indices: Vec<u32>,
    /// Box around all vertices, metres.
    pub bounds: Aabb,
    /// How it fades.
    pub fade: Fade,
    field: HeightField,
}

/// How the plain ground fades into what is behind it: by the distance from a rectangle, seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade {
    /// The rectangle's middle, metres.
    pub middle: DVec2,
    /// Half of its sides, metres.
    pub half: DVec2,
    /// How far from it nothing is left, metres.
    pub width: f64,
}

impl Ground {
    /// Its height at a place in plan, metres: to 3 cm what is drawn; beyond what lies below the city, that of the nearest place.
    pub fn height(&self, at: DVec2) -> f64 {
        self.field.height(at)
    }

    /// Box around what lies below the city, metres.
    pub fn bounds_below(&self) -> Aabb {
        self.tiles[self.below.clone()].iter().fold(Aabb::EMPTY, |all, tile| all.union(tile.bounds))
    }
}

/// The plain ground for the geometries `shown`; `None` if there are none.
pub fn plain_ground(model: &CityModel, shown: &[u32]) -> Option<Ground> {
    let known = Known::new(model, shown);
    let built = known.bounds();
    if built.is_empty() {
        return None;
    }
    let size = built.size().truncate();
    let margin = LEAST_MARGIN_M.max(MARGIN * size.length());
    let fade = Fade {
        middle: built.center().truncate(),
        half: 0.5 * size + 0.5 * margin,
        width: LEAST_FADE_M.max(FADE * size.length()),
    };
    let mut field = HeightField::over(fade.middle, (0.5 * size + margin).max_element());
    known.put_into(model, &mut field);
    field.fill();
    let mut net = net::Net::of(&field, 0.5 * margin + fade.width);
    known.rims(model, &field).iter().for_each(|rim| net.hang(rim, &field));
    let tile_m = (16.0 * field.step).max(64.0).ceil();
    let mut ground = Ground {
        tiles: Vec::new(),
        below: 0..0,
        is_filling: !known.ground.is_empty(),
        vertices: Vec::new(),
        indices: Vec::new(),
        bounds: Aabb::EMPTY,
        fade,
        field,
    };
    ground.add(&net.points, &net.below, tile_m);
    ground.below = 0..ground.tiles.len();
    ground.add(&net.points, &net.around, (8.0 * tile_m).max(fade.width));
    Some(ground)
}

/// What is known of the height of the ground.
struct Known {
    /// Geometries that stand on it, each with its base, metres.
    standing: Vec<(u32, f64)>,
    /// Geometries that are ground.
    ground: Vec<u32>,
    /// Box around all of them, metres.
    bounds: Aabb,
}

impl Known {
    fn new(model: &CityModel, shown: &[u32]) -> Self {
        let mut found: Vec<(u32, u32, Aabb)> = Vec::new();
        let mut ground = Vec::new();
        let mut bounds = Aabb::EMPTY;
        for &number in shown {
            let Some(geometry) = model.geometries.get(number as usize) else { continue };
            let tiles = &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
            let of_geometry = tiles.iter().fold(Aabb::EMPTY, |all, tile| all.union(tile.bounds));
            if of_geometry.is_empty() || geometry.triangles == 0 {
                continue;
            }
            if model.objects[geometry.object as usize].class.is_ground() {
                ground.push(number);
                bounds = bounds.union(of_geometry);
            } else {
                found.push((number, geometry.object, of_geometry));
            }
        }
        // Bridges and trees say little about the ground; they count where there is nothing else.
        let is_building = |object: u32| model.objects[object as usize].class == ObjectClass::Building;
        if !ground.is_empty() || found.iter().any(|&(_, object, _)| is_building(object)) {
            found.retain(|&(_, object, _)| is_building(object));
        }
        let bounds = found.iter().fold(bounds, |all, (_, _, own)| all.union(*own));
        Self { standing: bases(model, &found), ground, bounds }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Tells a field of it.
    fn put_into(&self, model: &CityModel, field: &mut HeightField) {
        for &geometry in &self.ground {
            triangles(model, geometry).for_each(|triangle| field.lies_below(&triangle, BELOW_TERRAIN_M));
        }
        // The lowest first: what stands much higher stands on something else.
        for &(geometry, base) in &self.standing {
            triangles(model, geometry).for_each(|triangle| field.reaches(&triangle, base - BELOW_M));
        }
    }

    /// Edges where terrain ends: of one triangle only, with nothing of it farther out.
    fn rims(&self, model: &CityModel, field: &HeightField) -> Vec<[DVec3; 2]> {
        // Millimetres: neighbours have the same corners, whatever tiles they are in.
        let key = |p: DVec3| (1e3 * p).round().as_i64vec3();
        let mut edges: FxHashMap<_, Option<[DVec3; 2]>> = FxHashMap::default();
        for [a, b, c] in self.ground.iter().flat_map(|&geometry| triangles(model, geometry)) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let ends = [key(from), key(to)];
                let edge = if ends[0].to_array() < ends[1].to_array() { ends } else { [ends[1], ends[0]] };
                edges.entry(edge).and_modify(|once| *once = None).or_insert(Some([from, to]));
            }
        }
        // Counter-clockwise from above: what lies to the right of an edge is outside.
        let is_rim = |[from, to]: &[DVec3; 2]| {
            let along = (*to - *from).truncate();
            let outwards = -along.perp().normalize_or_zero();
            outwards != DVec2::ZERO && !field.has_terrain(0.5 * (*from + *to).truncate() + 1.5 * field.step * outwards)
        };
        let mut rims: Vec<[DVec3; 2]> = edges.into_values().flatten().filter(is_rim).collect();
        let order = |rim: &[DVec3; 2]| rim.map(|p| p.to_array().map(f64::to_bits));
        rims.sort_unstable_by_key(order);
        rims
    }
}

/// The corners of the triangles of a geometry, metres.
fn triangles(model: &CityModel, geometry: u32) -> impl Iterator<Item = [DVec3; 3]> {
    let tiles = model.geometries[geometry as usize].tiles.clone();
    let tiles = &model.tiles[tiles.start as usize..tiles.end as usize];
    tiles.iter().flat_map(move |tile| {
        (tile.indices.start / 3..tile.indices.end / 3).map(move |triangle| model.corners(tile, triangle))
    })
}

/// The base of the building that each geometry is part of, metres, ascending.
fn bases(model: &CityModel, found: &[(u32, u32, Aabb)]) -> Vec<(u32, f64)> {
    let roots = model.roots();
    let mut families: FxHashMap<u32, Aabb> = FxHashMap::default();
    for &(_, object, bounds) in found {
        let family = families.entry(roots[object as usize]).or_insert(Aabb::EMPTY);
        *family = family.union(bounds);
    }
    // What files do not say the type of may be a lamp or an upper floor: it all has the base of the lowest.
    let untyped = found.iter().filter(|(_, object, _)| model.is_untyped(*object));
    let level = untyped.map(|(_, _, bounds)| bounds.min.z).fold(f64::INFINITY, f64::min);
    let is_part = |object: u32| {
        let object = &model.objects[object as usize];
        object.parents.is_empty() || model.strings.get(object.kind) == "BuildingPart"
    };
    let base = |&(geometry, object, bounds): &(u32, u32, Aabb)| {
        let family = families[&roots[object as usize]];
        let is_family = family.size().truncate().max_element() <= LARGEST_FAMILY_M;
        let base = match () {
            () if model.is_untyped(object) => level,
            // Parts on a slope have bases of their own; a balcony stands on its building.
            () if is_family && !is_part(object) => family.min.z,
            () => bounds.min.z,
        };
        (geometry, base)
    };
    let mut bases: Vec<(u32, f64)> = found.iter().map(base).collect();
    bases.sort_by(|a, b| a.1.total_cmp(&b.1));
    bases
}

impl Ground {
    /// Adds a surface, cut into tiles of `size` metres, with smooth normals.
    fn add(&mut self, points: &[DVec3], triangles: &[[u32; 3]], size: f64) {
        let mut normals = vec![DVec3::ZERO; points.len()];
        let mut cells: Vec<([i64; 2], [u32; 3])> = Vec::with_capacity(triangles.len());
        for &triangle in triangles {
            let [a, b, c] = triangle.map(|i| points[i as usize]);
            let normal = (b - a).cross(c - a);
            triangle.into_iter().for_each(|i| normals[i as usize] += normal);
            let cell = ((a + b + c) / (3.0 * size)).floor();
            cells.push(([cell.x as i64, cell.y as i64], triangle));
        }
        cells.sort_unstable();
        for tile in cells.chunk_by(|a, b| a.0 == b.0) {
            let corners = || tile.iter().flat_map(|(_, triangle)| triangle);
            let low = corners().fold(DVec3::INFINITY, |low, &i| low.min(points[i as usize]));
            let origin: IVec3 = low.floor().as_ivec3();
            let (first_vertex, first_index) = (self.vertices.len() as u32, self.indices.len() as u32);
            let mut vertex_of: FxHashMap<u32, u32> = FxHashMap::default();
            let mut bounds = Aabb::EMPTY;
            for &i in corners() {
                let index = *vertex_of.entry(i).or_insert_with(|| {
                    let position: Vec3 = (points[i as usize] - origin.as_dvec3()).as_vec3();
                    bounds = bounds.grown(origin.as_dvec3() + position.as_dvec3());
                    let normal = encode_normal(normals[i as usize].normalize_or(DVec3::Z));
                    self.vertices.push(Vertex { position: position.to_array(), normal, surface: NONE });
                    self.vertices.len() as u32 - 1 - first_vertex
                });
                self.indices.push(index);
            }
            self.bounds = self.bounds.union(bounds);
            self.tiles.push(Tile {
                origin,
                geometry: NONE,
                vertices: first_vertex..self.vertices.len() as u32,
                indices: first_index..self.indices.len() as u32,
                texcoords: NONE,
                bounds,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{
        model::{GROUP, MESH},
        test_city::{add_box, builder, grid_of_cubes, terrain},
    };

    fn all(model: &CityModel) -> Vec<u32> {
        (0..model.geometries.len() as u32).collect()
    }

    /// Corners of all triangles.
    fn triangles(ground: &Ground) -> Vec<[DVec3; 3]> {
        let corner = |tile: &Tile, k: u32| {
            let vertex = ground.vertices[(tile.vertices.start + ground.indices[k as usize]) as usize];
            tile.origin.as_dvec3() + Vec3::from(vertex.position).as_dvec3()
        };
        let of_tile = |tile: &Tile| {
            let tile = tile.clone();
            (tile.indices.start..tile.indices.end).step_by(3).map(move |k| [0, 1, 2].map(|i| corner(&tile, k + i)))
        };
        ground.tiles.iter().flat_map(of_tile).collect()
    }

    /// Height of the ground at a place.
    fn height_at(triangles: &[[DVec3; 3]], p: DVec2) -> Option<f64> {
        triangles.iter().find_map(|t| {
            let [a, b, c] = t.map(|corner| corner.truncate() - p);
            let (u, v, w) = (b.perp_dot(c), c.perp_dot(a), a.perp_dot(b));
            (u.min(v).min(w) >= 0.0 && u + v + w > 0.0).then(|| (u * t[0].z + v * t[1].z + w * t[2].z) / (u + v + w))
        })
    }

    #[test]
    fn it_lies_just_below_a_level_city_and_beyond_it() {
        let model = grid_of_cubes(10, 6);
        let ground = plain_ground(&model, &all(&model)).unwrap();
        let triangles = triangles(&ground);
        for t in &triangles {
            assert!((t[1] - t[0]).cross(t[2] - t[0]).z > 0.0, "seen from above");
            assert!(t.iter().all(|p| (p.z + BELOW_M).abs() < 1e-6));
        }
        let (extent, below) = (model.extent(), ground.bounds_below());
        assert!(extent.min.truncate().cmpge(below.min.truncate() + 59.0).all());
        assert!(extent.max.truncate().cmple(below.max.truncate() - 59.0).all());
        // It goes on until it has faded.
        let Fade { middle, half, width } = ground.fade;
        assert!(ground.bounds.min.truncate().cmple(middle - half - width).all());
        assert!(ground.bounds.max.truncate().cmpge(middle + half + width).all());
        assert!(ground.vertices.len() < 1_500, "what is level takes {} vertices", ground.vertices.len());
        assert!(ground.vertices.iter().all(|v| v.surface == NONE));
    }

    /// Each of its edges inside is of two triangles, and all of them together cover the square that it fills.
    #[test]
    fn it_has_no_gaps() {
        let model = hill();
        let ground = plain_ground(&model, &all(&model)).unwrap();
        let triangles = triangles(&ground);
        let area = |t: &[DVec3; 3]| 0.5 * (t[1] - t[0]).truncate().perp_dot((t[2] - t[0]).truncate());
        assert!(triangles.iter().all(|t| area(t) > 0.0));
        let key = |p: DVec3| (p * 64.0).round().as_i64vec3();
        let mut edges: FxHashMap<_, i32> = FxHashMap::default();
        for [a, b, c] in triangles.iter().map(|t| t.map(key)) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_default() += 1;
                *edges.entry((to, from)).or_default() -= 1;
            }
        }
        let open: Vec<_> = edges.iter().filter(|(_, count)| **count > 0).collect();
        let rim = |p: glam::I64Vec3| {
            let beyond = ((p.as_dvec3() / 64.0).truncate() - ground.fade.middle).abs() - ground.fade.half;
            beyond.max(DVec2::ZERO).length() > 0.99 * ground.fade.width
        };
        assert!(open.iter().all(|((a, b), _)| rim(*a) && rim(*b)), "{open:?}");
    }

    #[test]
    fn it_lies_below_terrain_and_fills_its_holes() {
        let mut model = terrain(4);
        // A hole of one polygon.
        let hole = model.geometries[0].tiles.start as usize;
        let first = model.tiles[hole].indices.start as usize;
        let gone: Vec<u32> = model.indices[first..first + 3].to_vec();
        model.indices[first..first + 3].fill(gone[0]);
        let ground = plain_ground(&model, &[0]).unwrap();
        let triangles = triangles(&ground);
        let tile = &model.tiles[hole];
        let corner = |i: u32| {
            let vertex = &model.vertices[(tile.vertices.start + i) as usize];
            tile.origin.as_dvec3() + Vec3::from(vertex.position).as_dvec3()
        };
        for i in 0..(tile.vertices.end - tile.vertices.start) {
            let place = corner(i);
            let height = height_at(&triangles, place.truncate()).unwrap();
            assert!(height < place.z - 0.4 * BELOW_TERRAIN_M, "{height} above {}", place.z);
        }
        let middle = gone.iter().map(|&i| corner(i)).sum::<DVec3>() / 3.0;
        let height = height_at(&triangles, middle.truncate()).unwrap();
        assert!((height - middle.z).abs() < 5.0, "{height} in a hole at {}", middle.z);
    }

    /// Houses on a slope, each on a base of its own.
    fn hill() -> CityModel {
        let mut b = builder();
        let base = |x: i64, y: i64| 900 * x + (y * 7919) % 1300;
        for x in 0..20 {
            for y in 0..12 {
                let min = [x * 17_000, y * 23_000, base(x, y)];
                add_box(&mut b, &format!("{x} {y}"), min, [min[0] + 12_000, min[1] + 14_000, min[2] + 8_000]);
            }
        }
        b.finish()
    }

    #[test]
    fn it_reaches_every_ground_floor_on_a_hill_and_cuts_through_none() {
        let model = hill();
        let ground = plain_ground(&model, &all(&model)).unwrap();
        let triangles = triangles(&ground);
        for geometry in model.geometries.iter().step_by(7) {
            let bounds = geometry.bounds;
            for corner in bounds.corners().into_iter().chain([bounds.center()]) {
                let height = height_at(&triangles, corner.truncate()).unwrap();
                assert!(height < bounds.min.z, "{height} above {}", bounds.min.z);
                assert!(height > bounds.min.z - 2.0 * BELOW_M, "{height} far below {}", bounds.min.z);
            }
        }
    }

    #[test]
    fn parts_stand_on_the_base_of_their_building() {
        let mut b = builder();
        add_box(&mut b, "house", [0, 0, 0], [10_000, 10_000, 8_000]);
        let mut balcony = crate::city::build::raw::RawObject { id: "balcony".to_owned(), ..Default::default() };
        balcony.parents.push("house".to_owned());
        let balcony = b.add_object(balcony);
        let surface = b.add_surface(crate::city::model::Surface {
            object: balcony,
            material: NONE,
            kind: crate::city::model::StringId(NONE),
            detail: NONE,
        });
        b.add_geometry(crate::city::build::raw::RawGeometry {
            object: balcony,
            lod: crate::city::model::Lod { tenths: 20 },
            solid: false,
            pool: std::sync::Arc::new(crate::city::build::points::Pool {
                lattice: crate::city::test_city::LATTICE,
                points: vec![[10_000, 2_000, 5_000], [30_000, 2_000, 5_000], [30_000, 8_000, 5_000]].into(),
            }),
            polygons: crate::city::build::raw::Polygons {
                indices: vec![0, 1, 2],
                ring_ends: vec![3],
                polygon_ends: vec![1],
                surfaces: vec![surface],
                ..Default::default()
            },
        });
        let model = b.finish();
        let ground = plain_ground(&model, &all(&model)).unwrap();
        assert!(ground.bounds.max.z < 0.0, "the ground does not rise to the balcony");
    }

    /// A lamp's head and a bridge's deck are groups like the houses beside them.
    #[test]
    fn what_has_no_type_stands_on_one_level() {
        for kind in [GROUP, MESH] {
            let mut b = builder();
            add_box(&mut b, "house", [0, 0, 2_000], [10_000, 10_000, 8_000]);
            add_box(&mut b, "head", [300_000, 0, 9_000], [301_000, 1_000, 9_300]);
            let mut model = b.finish();
            let uneven = plain_ground(&model, &all(&model)).unwrap();
            assert!(uneven.bounds.max.z > 8.0, "buildings have bases of their own");
            let kind = model.strings.intern(kind);
            model.objects.iter_mut().for_each(|object| object.kind = kind);
            let ground = plain_ground(&model, &all(&model)).unwrap();
            let heights = triangles(&ground).into_iter().flatten().map(|p| p.z);
            assert!(heights.map(|z| (z - 2.0 + BELOW_M).abs()).fold(0.0, f64::max) < 1e-6);
        }
    }

    #[test]
    fn nothing_gets_none() {
        assert_eq!(plain_ground(&CityModel::default(), &[]), None);
    }
}
