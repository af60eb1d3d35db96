//! Where things are: tiles by region, triangles along rays and in lens volumes.
//!
//! A hierarchy over the tiles that are shown, and one more inside each tile of many triangles. Tiles keep their numbers,
//! so the renderer culls by them.

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    city::model::CityModel,
    geom::{
        Aabb, CommonPart,
        bvh::{Bvh, HalfSpace},
        ray::{Ray, TriangleTest},
    },
};

/// Tiles up to this many triangles are tested one triangle after the other.
const PLAIN_TILE: usize = 48;
/// Triangles per box in larger tiles.
const RUN: usize = 4;

/// Finds tiles and triangles of the geometries that are shown.
#[derive(Clone, Debug)]
pub struct SpatialIndex {
    /// Tiles, as numbered in the hierarchy.
    tiles: Vec<u32>,
    top: Bvh,
    /// Per tile of `tiles`: a hierarchy over its runs of [`RUN`] triangles, if it is large.
    runs: Vec<Option<Bvh>>,
}

/// Where a ray met the city.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object, by index.
    pub object: u32,
    /// The geometry, by index.
    pub geometry: u32,
    /// The tile, by index.
    pub tile: u32,
    /// The triangle, by index into [`CityModel::planes`]; its corners are three times that in `indices`.
    pub triangle: u32,
    /// In lengths of the ray's direction.
    pub t: f64,
}

impl SpatialIndex {
    /// Indexes the tiles of the geometries `shown`.
    pub fn build(model: &CityModel, shown: &[u32]) -> Self {
        let tiles: Vec<u32> = shown
            .iter()
            .filter_map(|&geometry| model.geometries.get(geometry as usize))
            .flat_map(|geometry| geometry.tiles.clone())
            .collect();
        let bounds: Vec<Aabb> = tiles.iter().map(|&tile| model.tiles[tile as usize].bounds).collect();
        let runs = tiles.par_iter().map(|&tile| runs_of(model, tile)).collect();
        Self { top: Bvh::build(&bounds), tiles, runs }
    }

    /// Visits the tiles that may meet the intersection of half-spaces (a view frustum); `true`: wholly inside.
    pub fn tiles_in_half_spaces(&self, planes: &[HalfSpace], mut visit: impl FnMut(u32, bool)) {
        self.top.in_half_spaces(planes, |item, inside| visit(self.tiles[item as usize], inside));
    }

    /// Visits the tiles whose boxes may meet `region`.
    pub fn tiles_in_box(&self, region: &Aabb, mut visit: impl FnMut(u32)) {
        self.top.in_box(region, |item| visit(self.tiles[item as usize]));
    }

    /// Visits every triangle (by index) that shares a point with `region`, once, with its tile. `visit` says whether
    /// more triangles of that tile are wanted; of which tiles any are is for `wanted` to say.
    pub fn triangles_meeting(
        &self,
        model: &CityModel,
        region: &CommonPart,
        wanted: impl FnMut(u32) -> bool,
        mut visit: impl FnMut(u32, u32) -> bool,
    ) {
        self.descend(
            model,
            |bounds| region.coverage(bounds),
            wanted,
            |tile, triangle, is_inside| {
                !(is_inside || region.meets_triangle(&corners(model, tile, triangle))) || visit(tile, triangle)
            },
        );
    }

    /// Visits every triangle of boxes that `may_meet` something, once, by its tile and corners. `visit` says whether more
    /// triangles of that tile are wanted; of which tiles any are is for `wanted` to say. The boxes that are asked about may be smaller
    /// than the triangles' own by what f64 loses in a change of origin.
    pub fn triangles_where(
        &self,
        model: &CityModel,
        may_meet: impl Fn(&Aabb) -> bool,
        wanted: impl FnMut(u32) -> bool,
        mut visit: impl FnMut(u32, &[DVec3; 3]) -> bool,
    ) {
        self.descend(
            model,
            |bounds| may_meet(bounds).then_some(false),
            wanted,
            |tile, triangle, _| visit(tile, &corners(model, tile, triangle)),
        );
    }

    /// Visits the triangles of the boxes of which `coverage` says something, and whether that was that they are wholly inside.
    fn descend(
        &self,
        model: &CityModel,
        coverage: impl Fn(&Aabb) -> Option<bool>,
        mut wanted: impl FnMut(u32) -> bool,
        mut visit: impl FnMut(u32, u32, bool) -> bool,
    ) {
        self.top.in_region(&coverage, |item, is_inside| {
            let number = self.tiles[item as usize];
            if !wanted(number) {
                return;
            }
            let tile = &model.tiles[number as usize];
            let triangles = tile.indices.start / 3..tile.indices.end / 3;
            let mut goes_on = true;
            let mut run = |run: std::ops::Range<u32>, is_inside: bool| {
                for triangle in run {
                    if !goes_on {
                        return;
                    }
                    goes_on = visit(number, triangle, is_inside);
                }
            };
            match &self.runs[item as usize] {
                Some(runs) if !is_inside => runs.in_region(&coverage, |number, is_inside| {
                    let first = triangles.start + number * RUN as u32;
                    run(first..(first + RUN as u32).min(triangles.end), is_inside);
                }),
                // Few triangles: first whether their tile is near at all, as its neighbours in a leaf may be.
                _ if is_inside => run(triangles, true),
                _ => {
                    if let Some(is_inside) = coverage(&tile.bounds) {
                        run(triangles, is_inside);
                    }
                }
            }
        });
    }

    /// Visits every triangle that a ray meets not farther than `t_max`, in no particular order; one without direction meets none.
    pub fn hits(&self, model: &CityModel, ray: &Ray, t_max: f64, mut visit: impl FnMut(&Hit)) {
        self.hits_until(model, ray, t_max, |hit| {
            visit(hit);
            false
        });
    }

    /// The same, until `visit` says that it is enough.
    pub fn hits_until(&self, model: &CityModel, ray: &Ray, t_max: f64, mut visit: impl FnMut(&Hit) -> bool) {
        /// Every box is beyond this end.
        const ENOUGH: f64 = f64::NEG_INFINITY;
        let Some(test) = TriangleTest::new(ray) else { return };
        self.top.along_ray(ray, t_max, |item, end| {
            let number = self.tiles[item as usize];
            let tile = &model.tiles[number as usize];
            let object = model.geometries[tile.geometry as usize].object;
            // The new end.
            let mut try_all = |mut triangles: std::ops::Range<u32>, end: f64| -> f64 {
                let is_enough = end == ENOUGH
                    || triangles.any(|triangle| {
                        let hit = test.hit(corners(model, number, triangle)).filter(|t| *t <= t_max);
                        hit.is_some_and(|t| visit(&Hit { object, geometry: tile.geometry, tile: number, triangle, t }))
                    });
                if is_enough { ENOUGH } else { end }
            };
            let triangles = tile.indices.start / 3..tile.indices.end / 3;
            match &self.runs[item as usize] {
                None => try_all(triangles, end),
                Some(runs) => {
                    let mut left = end;
                    runs.along_ray(ray, end, |run, _| {
                        let first = triangles.start + run * RUN as u32;
                        left = try_all(first..(first + RUN as u32).min(triangles.end), left);
                        left
                    });
                    left
                }
            }
        });
    }

    /// Follows vertices of the model that moved, of tiles that `is_moved` names; tiles, triangles and what is shown are the same. The bounds of the
    /// model's tiles must have followed.
    pub fn refit(&mut self, model: &CityModel, is_moved: impl Fn(u32) -> bool + Sync) {
        let bounds: Vec<Aabb> = self.tiles.iter().map(|&tile| model.tiles[tile as usize].bounds).collect();
        self.top.refit(&bounds);
        self.tiles.par_iter().zip(&mut self.runs).for_each(|(&tile, runs)| {
            if let Some(runs) = runs.as_mut().filter(|_| is_moved(tile)) {
                runs.refit(&boxes_of_runs(model, tile));
            }
        });
    }

    /// The first triangle a ray meets, from either side; of triangles equally far away the one read first.
    pub fn hit(&self, model: &CityModel, ray: &Ray) -> Option<Hit> {
        self.hit_where(model, ray, f64::INFINITY, |_| true)
    }

    /// The first triangle (by index) that is not farther than `t_max` and that `accept` takes.
    pub fn hit_where(&self, model: &CityModel, ray: &Ray, t_max: f64, accept: impl Fn(u32) -> bool) -> Option<Hit> {
        let test = TriangleTest::new(ray)?;
        let mut best: Option<Hit> = None;
        self.top.along_ray(ray, t_max, |item, mut end| {
            let number = self.tiles[item as usize];
            let tile = &model.tiles[number as usize];
            let mut try_triangle = |triangle: u32, end: f64| -> f64 {
                let Some(t) = test.hit(corners(model, number, triangle)) else { return end };
                let nearer = best.is_none_or(|hit| (t, triangle) < (hit.t, hit.triangle));
                if t <= end && nearer && accept(triangle) {
                    let object = model.geometries[tile.geometry as usize].object;
                    best = Some(Hit { object, geometry: tile.geometry, tile: number, triangle, t });
                    return t;
                }
                end
            };
            let triangles = tile.indices.start / 3..tile.indices.end / 3;
            match &self.runs[item as usize] {
                None => {
                    for triangle in triangles {
                        end = try_triangle(triangle, end);
                    }
                }
                Some(runs) => runs.along_ray(ray, end, |run, mut run_end| {
                    let first = triangles.start + run * RUN as u32;
                    for triangle in first..(first + RUN as u32).min(triangles.end) {
                        run_end = try_triangle(triangle, run_end);
                    }
                    end = run_end;
                    run_end
                }),
            }
            end
        });
        best
    }
}

/// World corners of a triangle (index into [`CityModel::planes`]) of a tile.
fn corners(model: &CityModel, tile: u32, triangle: u32) -> [DVec3; 3] {
    model.corners(&model.tiles[tile as usize], triangle)
}

fn runs_of(model: &CityModel, number: u32) -> Option<Bvh> {
    let tile = &model.tiles[number as usize];
    (tile.indices.len() / 3 > PLAIN_TILE).then(|| Bvh::build(&boxes_of_runs(model, number)))
}

fn boxes_of_runs(model: &CityModel, number: u32) -> Vec<Aabb> {
    let tile = &model.tiles[number as usize];
    let triangles: Vec<u32> = (tile.indices.start / 3..tile.indices.end / 3).collect();
    let around = |run: &[u32]| Aabb::from_points(run.iter().flat_map(|&triangle| corners(model, number, triangle)));
    triangles.chunks(RUN).map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::test_city::{grid_of_cubes, terrain};

    #[test]
    fn rays_down_onto_cubes_hit_their_roofs() {
        let model = grid_of_cubes(20, 20);
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let index = SpatialIndex::build(&model, &shown);
        for i in 0..400_u32 {
            let bounds = model.geometries[i as usize].bounds;
            let ray = Ray { origin: bounds.center() + DVec3::new(0.1, 0.2, 100.0), direction: -DVec3::Z };
            let hit = index.hit(&model, &ray).unwrap();
            assert_eq!(hit.object, i);
            assert!((ray.origin.z - hit.t - bounds.max.z).abs() < 1e-9);
        }
        assert_eq!(index.hit(&model, &Ray { origin: DVec3::splat(-50.0), direction: -DVec3::X }), None);
        let only_one = SpatialIndex::build(&model, &[7]);
        let down = Ray { origin: model.geometries[8].bounds.center() + 50.0 * DVec3::Z, direction: -DVec3::Z };
        assert_eq!(only_one.hit(&model, &down), None);
    }

    #[test]
    fn a_terrain_is_watertight_at_its_vertices_and_edges() {
        // Hard case 11: rays through shared vertices and edges of a triangulated surface never fall through.
        let model = terrain(40);
        let index = SpatialIndex::build(&model, &[0]);
        assert!(index.runs.iter().any(Option::is_some), "large tiles have a hierarchy of their own");
        for (number, tile) in model.tiles.iter().enumerate() {
            for triangle in tile.indices.start / 3..tile.indices.end / 3 {
                let [a, b, c] = corners(&model, number as u32, triangle);
                for (target, direction) in
                    [(a, -DVec3::Z), (0.5 * (b + c), DVec3::new(0.3, -0.2, -1.0)), (b, DVec3::new(0.0, 0.1, -1.0))]
                {
                    let bounds = model.geometries[0].bounds;
                    let inner = target.x > bounds.min.x + 1.0 && target.x < bounds.max.x - 1.0;
                    if inner && target.y > bounds.min.y + 1.0 && target.y < bounds.max.y - 1.0 {
                        let ray = Ray { origin: target - 30.0 * direction, direction };
                        let hit = index.hit(&model, &ray);
                        assert!(hit.is_some_and(|h| (h.t - 30.0).abs() < 2.0), "{target} {direction}: {hit:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn hits_end_where_it_is_enough() {
        let row = grid_of_cubes(30, 1);
        let model = &row;
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let through = model.extent().center() - 1000.0 * DVec3::X + DVec3::new(0.0, 0.3, 0.2);
        let hills = terrain(40);
        let over = hills.extent().center() - 1000.0 * DVec3::X;
        for (model, shown, origin) in [(model, &shown[..], through), (&hills, &[0][..], over)] {
            let index = SpatialIndex::build(model, shown);
            let ray = Ray { origin, direction: DVec3::X };
            let mut all = Vec::new();
            index.hits(model, &ray, f64::INFINITY, |hit| all.push(hit.triangle));
            assert!(all.len() > 20, "{}", all.len());
            for wanted in 1..=all.len() {
                let mut some = Vec::new();
                index.hits_until(model, &ray, f64::INFINITY, |hit| {
                    some.push(hit.triangle);
                    some.len() == wanted
                });
                assert_eq!(some, all[..wanted], "the same, as far as it goes");
            }
        }
    }

    #[test]
    fn the_nearest_triangle_is_what_brute_force_finds() {
        let model = grid_of_cubes(6, 6);
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let index = SpatialIndex::build(&model, &shown);
        let extent = model.extent();
        for i in 0..2000_u32 {
            let part = |k: u32| f64::from((i * 31 + k).wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24);
            let origin = extent.min - 20.0 + (extent.size() + 40.0) * DVec3::new(part(1), part(2), part(3));
            let ray = Ray { origin, direction: DVec3::new(part(4) - 0.5, part(5) - 0.5, part(6) - 0.5) };
            let test = TriangleTest::new(&ray).unwrap();
            let mut expected: Option<(f64, u32)> = None;
            for (number, tile) in model.tiles.iter().enumerate() {
                for triangle in tile.indices.start / 3..tile.indices.end / 3 {
                    if let Some(t) = test.hit(corners(&model, number as u32, triangle))
                        && expected.is_none_or(|best| (t, triangle) < best)
                    {
                        expected = Some((t, triangle));
                    }
                }
            }
            assert_eq!(index.hit(&model, &ray).map(|hit| (hit.t, hit.triangle)), expected);
        }
    }
}
