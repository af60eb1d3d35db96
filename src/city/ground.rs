//! A plain ground under a city that has no terrain of its own, so that buildings stand on something.
//!
//! A height field through the bases of the buildings: every grid point around a building lies no higher than its base,
//! so the ground never cuts through a ground floor (what files do not say the type of may be a lamp or an upper floor: it all has the
//! base of the lowest); between buildings heights are relaxed (Laplace's equation with the
//! bases fixed), and towards the border they level out by themselves. It is no part of the model: `info`, the picker
//! and the lists of objects never see it.

use glam::{DVec2, DVec3, IVec3, Vec3};
use rustc_hash::FxHashMap;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use crate::{
    city::model::{CityModel, NONE, ObjectClass, Tile, Vertex, encode_normal},
    geom::Aabb,
};

/// The distance of the ground below the bases, metres: enough for depth to tell it from ground floors.
pub const BELOW_M: f64 = 0.05;
/// The ground reaches at least this far beyond the buildings, metres, ...
const LEAST_MARGIN_M: f64 = 60.0;
/// ... and this part of the diagonal of their extent.
const MARGIN: f64 = 0.12;
/// Grid points along the longer side: about 17,000 in all.
const POINTS_PER_SIDE: f64 = 130.0;
/// No grid is finer, metres.
const LEAST_STEP_M: f64 = 2.0;
/// Families of buildings (a building and its parts) share a base up to this size, metres; larger ones are groups.
const LARGEST_FAMILY_M: f64 = 500.0;
/// Rounds of relaxation; heights start from the nearest base, so this only smooths.
const ROUNDS: usize = 60;

/// A plain ground: tiles as in the model, but of no geometry, with surface [`NONE`].
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Its tiles; `geometry` and `texcoords` are [`NONE`].
    pub tiles: Vec<Tile>,
    /// Vertices, grouped by tile; `surface` is [`NONE`].
    pub vertices: Vec<Vertex>,
    /// Three per triangle, counter-clockwise from above, relative to the tile's first vertex.
    pub indices: Vec<u32>,
    /// Box around all vertices, metres.
    pub bounds: Aabb,
}

/// The plain ground for the geometries `shown`; `None` if there are none, or one of them is ground itself.
pub fn plain_ground(model: &CityModel, shown: &[u32]) -> Option<Ground> {
    let footprints = footprints(model, shown)?;
    let built = footprints.iter().fold(Aabb::EMPTY, |all, footprint| all.union(*footprint));
    let field = HeightField::through(footprints, built);
    Some(field.surface())
}

/// A box per shown geometry, its `min.z` the base of the building it is part of.
fn footprints(model: &CityModel, shown: &[u32]) -> Option<Vec<Aabb>> {
    let mut found: Vec<(u32, Aabb)> = Vec::new();
    for geometry in shown.iter().filter_map(|&geometry| model.geometries.get(geometry as usize)) {
        if model.objects[geometry.object as usize].class.is_ground() && geometry.triangles > 0 {
            return None;
        }
        let tiles = &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
        let bounds = tiles.iter().fold(Aabb::EMPTY, |all, tile| all.union(tile.bounds));
        if !bounds.is_empty() {
            found.push((geometry.object, bounds));
        }
    }
    // Bridges and trees say little about the ground; they count where there is nothing else.
    let is_building = |object: u32| model.objects[object as usize].class == ObjectClass::Building;
    if found.iter().any(|&(object, _)| is_building(object)) {
        found.retain(|&(object, _)| is_building(object));
    }
    let roots = model.roots();
    let mut families: FxHashMap<u32, Aabb> = FxHashMap::default();
    for &(object, bounds) in &found {
        let family = families.entry(roots[object as usize]).or_insert(Aabb::EMPTY);
        *family = family.union(bounds);
    }
    let untyped = found.iter().filter(|(object, _)| model.is_untyped(*object));
    let level = untyped.map(|(_, bounds)| bounds.min.z).fold(f64::INFINITY, f64::min);
    let with_base = |(object, mut bounds): (u32, Aabb)| {
        if model.is_untyped(object) {
            bounds.min.z = level;
            return bounds;
        }
        let family = families[&roots[object as usize]];
        if family.size().truncate().max_element() <= LARGEST_FAMILY_M {
            bounds.min.z = family.min.z;
        }
        bounds
    };
    (!found.is_empty()).then(|| found.into_iter().map(with_base).collect())
}

/// Heights on a regular grid.
struct HeightField {
    /// The grid's first point, metres.
    origin: DVec2,
    /// Metres between points.
    step: f64,
    columns: usize,
    rows: usize,
    /// Row by row.
    heights: Vec<f64>,
    /// The border: a rounded rectangle.
    middle: DVec2,
    half_size: DVec2,
    radius: f64,
}

impl HeightField {
    fn through(mut footprints: Vec<Aabb>, built: Aabb) -> Self {
        let size = built.size().truncate();
        let margin = LEAST_MARGIN_M.max(MARGIN * size.length());
        let half_size = 0.5 * size + margin;
        let step = (2.0 * half_size.max_element() / POINTS_PER_SIDE).max(LEAST_STEP_M);
        let middle = built.center().truncate();
        let counts = (2.0 * half_size / step).ceil() + 1.0;
        let (columns, rows) = (counts.x as usize, counts.y as usize);
        let mut field = Self {
            origin: middle - half_size,
            step,
            columns,
            rows,
            heights: vec![f64::NAN; columns * rows],
            middle,
            half_size,
            radius: 1.5 * margin,
        };
        // Lowest first: a grid point takes the first base that reaches it and keeps it.
        footprints.sort_by(|a, b| a.min.z.total_cmp(&b.min.z));
        field.take_bases(&footprints);
        let fixed: Vec<bool> = field.heights.iter().map(|height| height.is_finite()).collect();
        field.spread();
        field.relax(&fixed);
        field
    }

    /// Sets the corners of all grid cells that a footprint touches to its base. Per row, `next` leads from each column
    /// to the first one not yet set, so that every point is set once however many footprints lie there.
    fn take_bases(&mut self, footprints: &[Aabb]) {
        let mut next: Vec<u32> = (0..self.rows).flat_map(|_| 0..=self.columns as u32).collect();
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        for footprint in footprints {
            let low = ((footprint.min.truncate() - self.origin) / self.step).floor().clamp(DVec2::ZERO, last);
            let high = (((footprint.max.truncate() - self.origin) / self.step).floor() + 1.0).clamp(DVec2::ZERO, last);
            for row in low.y as usize..=high.y as usize {
                let row_next = &mut next[row * (self.columns + 1)..(row + 1) * (self.columns + 1)];
                let mut column = first_free(row_next, low.x as usize);
                while column <= high.x as usize {
                    self.heights[row * self.columns + column] = footprint.min.z;
                    row_next[column] = column as u32 + 1;
                    column = first_free(row_next, column);
                }
            }
        }
    }

    /// Gives every free point the height of the nearest base (by steps along the grid).
    fn spread(&mut self) {
        let mut wave: Vec<usize> = (0..self.heights.len()).filter(|&i| self.heights[i].is_finite()).collect();
        let mut at = 0;
        while let Some(&i) = wave.get(at) {
            at += 1;
            for j in self.neighbours(i) {
                if self.heights[j].is_nan() {
                    self.heights[j] = self.heights[i];
                    wave.push(j);
                }
            }
        }
    }

    /// Moves free points to the mean of their neighbours, again and again; at the border there is no slope.
    fn relax(&mut self, fixed: &[bool]) {
        for _ in 0..ROUNDS {
            for i in (0..self.heights.len()).filter(|&i| !fixed[i]) {
                let (sum, count) =
                    self.neighbours(i).fold((0.0, 0.0), |(sum, count), j| (sum + self.heights[j], count + 1.0));
                self.heights[i] = sum / count;
            }
        }
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (row, column) = (i / columns, i % columns);
        [
            (column > 0).then(|| i - 1),
            (column + 1 < columns).then_some(i + 1),
            (row > 0).then(|| i - columns),
            (row + 1 < rows).then_some(i + columns),
        ]
        .into_iter()
        .flatten()
    }

    /// Signed distance to the border, negative inside, metres.
    fn beyond_border(&self, p: DVec2) -> f64 {
        let radius = self.radius.min(self.half_size.min_element());
        let from_core = (p - self.middle).abs() - (self.half_size - radius);
        from_core.max(DVec2::ZERO).length() + from_core.max_element().min(0.0) - radius
    }

    /// The height at a place, from the grid points around it.
    fn height(&self, p: DVec2) -> f64 {
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        let at = ((p - self.origin) / self.step).clamp(DVec2::ZERO, last);
        let (cell, part) = (at.floor(), at - at.floor());
        let (column, row) = (cell.x as usize, cell.y as usize);
        let next = ((column + 1).min(self.columns - 1), (row + 1).min(self.rows - 1));
        let get = |column: usize, row: usize| self.heights[row * self.columns + column];
        let low = get(column, row) * (1.0 - part.x) + get(next.0, row) * part.x;
        let high = get(column, next.1) * (1.0 - part.x) + get(next.0, next.1) * part.x;
        low * (1.0 - part.y) + high * part.y
    }

    /// Points of the border, about a grid step apart, on the convex rounded rectangle.
    fn border(&self) -> impl Iterator<Item = DVec2> {
        let radius = self.radius.min(self.half_size.min_element());
        let core = self.half_size - radius;
        let per_corner = (std::f64::consts::FRAC_PI_2 * radius / self.step).ceil().clamp(4.0, 128.0) as usize;
        (0..4).flat_map(move |corner| {
            let sign = [DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0)];
            (0..=per_corner).map(move |k| {
                let turn = (corner as f64 + k as f64 / per_corner as f64) * std::f64::consts::FRAC_PI_2;
                self.middle + sign[corner] * core + radius * DVec2::from_angle(turn)
            })
        })
    }

    /// Triangles through the grid points within the border and the border itself, in tiles.
    fn surface(&self) -> Ground {
        let grid = (0..self.rows).flat_map(|row| {
            (0..self.columns).map(move |column| self.origin + self.step * DVec2::new(column as f64, row as f64))
        });
        let inside = grid.filter(|&p| self.beyond_border(p) < -0.6 * self.step);
        // Relative to the middle: no digits are lost in far-off coordinates.
        let relative: Vec<Point2<f64>> =
            inside.chain(self.border()).map(|p| p - self.middle).map(|p| Point2::new(p.x, p.y)).collect();
        let net = DelaunayTriangulation::<Point2<f64>>::bulk_load(relative).unwrap_or_default();
        let points: Vec<DVec3> = net
            .vertices()
            .map(|vertex| {
                let p = self.middle + DVec2::new(vertex.position().x, vertex.position().y);
                p.extend(self.height(p) - BELOW_M)
            })
            .collect();
        let triangles: Vec<[usize; 3]> = net.inner_faces().map(|face| face.vertices().map(|v| v.index())).collect();
        in_tiles(&points, &triangles, (16.0 * self.step).max(64.0).ceil())
    }
}

/// The first column at or after `from` that is free (halving the way as it goes).
fn first_free(next: &mut [u32], from: usize) -> usize {
    let mut at = from;
    while next[at] as usize != at {
        let beyond = next[next[at] as usize];
        next[at] = beyond;
        at = beyond as usize;
    }
    at
}

/// Cuts a surface into tiles of `size` metres with smooth normals.
fn in_tiles(points: &[DVec3], triangles: &[[usize; 3]], size: f64) -> Ground {
    let mut normals = vec![DVec3::ZERO; points.len()];
    let mut cells: Vec<([i64; 2], [usize; 3])> = Vec::with_capacity(triangles.len());
    for &triangle in triangles {
        let [a, b, c] = triangle.map(|i| points[i]);
        let normal = (b - a).cross(c - a);
        triangle.into_iter().for_each(|i| normals[i] += normal);
        let cell = ((a + b + c) / (3.0 * size)).floor();
        cells.push(([cell.x as i64, cell.y as i64], triangle));
    }
    cells.sort_unstable();
    let mut ground = Ground { tiles: Vec::new(), vertices: Vec::new(), indices: Vec::new(), bounds: Aabb::EMPTY };
    for tile in cells.chunk_by(|a, b| a.0 == b.0) {
        let low = tile.iter().flat_map(|(_, triangle)| triangle).fold(DVec3::INFINITY, |low, &i| low.min(points[i]));
        let origin: IVec3 = low.floor().as_ivec3();
        let (first_vertex, first_index) = (ground.vertices.len() as u32, ground.indices.len() as u32);
        let mut vertex_of: FxHashMap<usize, u32> = FxHashMap::default();
        let mut bounds = Aabb::EMPTY;
        for &i in tile.iter().flat_map(|(_, triangle)| triangle) {
            let index = *vertex_of.entry(i).or_insert_with(|| {
                let position: Vec3 = (points[i] - origin.as_dvec3()).as_vec3();
                bounds = bounds.grown(origin.as_dvec3() + position.as_dvec3());
                let normal = encode_normal(normals[i].normalize_or(DVec3::Z));
                ground.vertices.push(Vertex { position: position.to_array(), normal, surface: NONE });
                ground.vertices.len() as u32 - 1 - first_vertex
            });
            ground.indices.push(index);
        }
        ground.bounds = ground.bounds.union(bounds);
        ground.tiles.push(Tile {
            origin,
            geometry: NONE,
            vertices: first_vertex..ground.vertices.len() as u32,
            indices: first_index..ground.indices.len() as u32,
            texcoords: NONE,
            bounds,
        });
    }
    ground
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
        let extent = model.extent();
        assert!(extent.min.truncate().cmpge(ground.bounds.min.truncate() + 59.0).all());
        assert!(extent.max.truncate().cmple(ground.bounds.max.truncate() - 59.0).all());
        assert!(ground.vertices.len() < 25_000);
        assert!(ground.vertices.iter().all(|v| v.surface == NONE));
    }

    #[test]
    fn it_cuts_through_no_ground_floor_on_a_hill() {
        let mut b = builder();
        let base = |x: i64, y: i64| 900 * x + (y * 7919) % 1300;
        for x in 0..20 {
            for y in 0..12 {
                let min = [x * 17_000, y * 23_000, base(x, y)];
                add_box(&mut b, &format!("{x} {y}"), min, [min[0] + 12_000, min[1] + 14_000, min[2] + 8_000]);
            }
        }
        let model = b.finish();
        let ground = plain_ground(&model, &all(&model)).unwrap();
        let triangles = triangles(&ground);
        for geometry in model.geometries.iter().step_by(7) {
            let bounds = geometry.bounds;
            for corner in bounds.corners().into_iter().chain([bounds.center()]) {
                let height = height_at(&triangles, corner.truncate()).unwrap();
                assert!(height <= bounds.min.z - BELOW_M + 1e-4, "{height} above {}", bounds.min.z);
                assert!(height > bounds.min.z - 4.0, "{height} far below {}", bounds.min.z);
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
    fn nothing_and_terrain_get_none() {
        assert_eq!(plain_ground(&CityModel::default(), &[]), None);
        assert_eq!(plain_ground(&terrain(4), &[0]), None);
    }
}
