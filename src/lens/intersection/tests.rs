use glam::{DQuat, DVec3};
use proptest::prelude::*;

use super::*;
use crate::{
    city::test_city::{grid_of_cubes, terrain},
    geom::{Aabb, Shape, shape::Sphere},
};

/// Numbers for a lens: which kind, where (shares of the city's box), how large, how turned.
type LensNumbers = (usize, [f64; 3], f64, [f64; 3]);

fn lens_numbers() -> impl Strategy<Value = LensNumbers> {
    // From far smaller than a triangle to holding most of the city.
    let size = (-1.0..1.6f64).prop_map(|e| 10_f64.powf(e));
    (0..6_usize, prop::array::uniform3(0.0..1.0f64), size, prop::array::uniform3(-3.0..3.0f64))
}

fn volumes(model: &CityModel, &(kind, at, r, turn): &LensNumbers) -> Vec<Volume> {
    let extent = model.extent();
    let center = extent.min + extent.size() * DVec3::from(at);
    let rotation = DQuat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]);
    let shape = match kind {
        0 => Shape::Sphere { center, radius: r },
        1 => Shape::Box { center, size: DVec3::new(1.8, 1.1, 0.9) * r, rotation },
        2 => Shape::Cylinder { center, radius: r, height: 2.0 * r, axis: DVec3::Z },
        3 => Shape::Ellipsoid { center, radii: DVec3::new(1.0, 0.4, 0.7) * r, rotation },
        4 => Shape::Frustum { center, radius: r, top_radius: 0.2 * r, height: r, axis: rotation * DVec3::Z },
        _ => {
            let step = DVec3::new(2.0 * r, r, 0.1 * r);
            Shape::Corridor {
                points: vec![center - step, center, center + DVec3::new(-step.y, step.x, step.z)],
                width: 0.5 * r,
                height: r,
            }
        }
    };
    shape.volumes().expect("volumes")
}

/// All triangles that meet a point of every lens, one after the other.
fn by_brute_force(model: &CityModel, regions: &[CommonPart]) -> Vec<u32> {
    let mut met = Vec::new();
    for tile in &model.tiles {
        for triangle in tile.indices.start / 3..tile.indices.end / 3 {
            let corner =
                |k: u32| model.position(tile, tile.vertices.start + model.indices[(3 * triangle + k) as usize]);
            let corners = [corner(0), corner(1), corner(2)];
            if regions.iter().any(|r| r.meets_triangle(&corners)) {
                met.push(triangle);
            }
        }
    }
    met.sort_unstable();
    met
}

fn objects_of(model: &CityModel, triangles: &[u32]) -> Vec<u32> {
    let object = |t: &u32| model.surfaces[model.vertices[vertex_of(model, *t) as usize].surface as usize].object;
    let mut objects: Vec<u32> = triangles.iter().map(object).collect();
    objects.sort_unstable();
    objects.dedup();
    objects
}

fn vertex_of(model: &CityModel, triangle: u32) -> u32 {
    let tile = model.tiles.iter().find(|t| t.indices.contains(&(3 * triangle))).expect("a tile");
    tile.vertices.start + model.indices[3 * triangle as usize]
}

/// Moves every vertex of a tile by the same steps, each tile by others, and their boxes with them.
fn moved(model: &CityModel, seed: f64) -> CityModel {
    let mut model = model.clone();
    for i in 0..model.tiles.len() {
        let t = seed + i as f64;
        let way = 30.0 * DVec3::new((t * 1.1).sin(), (t * 2.3).cos(), 0.3 * (t * 0.7).sin());
        let range = model.tiles[i].vertices.clone();
        for vertex in range.clone() {
            let position = &mut model.vertices[vertex as usize].position;
            *position = (glam::Vec3::from(*position) + way.as_vec3()).to_array();
        }
        model.tiles[i].bounds = Aabb::from_points(range.map(|v| model.position(&model.tiles[i], v)));
    }
    model
}

fn check(model: &CityModel, index: &SpatialIndex, lenses: &[LensNumbers]) -> Result<usize, TestCaseError> {
    let volumes: Vec<Vec<Volume>> = lenses.iter().map(|l| volumes(model, l)).collect();
    let lists: Vec<&[Volume]> = volumes.iter().map(Vec::as_slice).collect();
    let regions = regions(&lists);
    let expected = by_brute_force(model, &regions);
    prop_assert_eq!(&triangles_meeting(model, index, &regions), &expected);
    prop_assert_eq!(objects_meeting(model, index, &regions), objects_of(model, &expected));
    Ok(expected.len())
}

proptest! {
    #![proptest_config(crate::seeds::cases(150))]

    /// One to three lenses on houses and on ground whose tiles have hierarchies of their own, before and after it moves.
    #[test]
    fn the_hierarchy_finds_what_brute_force_finds(
        lenses in prop::collection::vec(lens_numbers(), 1..4), seed in 0.0..100.0f64
    ) {
        for model in [grid_of_cubes(5, 4), terrain(24)] {
            let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
            let mut index = SpatialIndex::build(&model, &shown);
            for lens in &lenses {
                check(&model, &index, std::slice::from_ref(lens))?;
            }
            check(&model, &index, &lenses)?;
            let later = moved(&model, seed);
            index.refit(&later, |_| true);
            for lens in &lenses {
                check(&later, &index, std::slice::from_ref(lens))?;
            }
        }
    }
}

#[test]
fn a_lens_within_a_roof_meets_the_triangles_that_span_it() {
    let model = grid_of_cubes(3, 3);
    let shown: Vec<u32> = (0..9).collect();
    let index = SpatialIndex::build(&model, &shown);
    let bounds = model.geometries[4].bounds;
    // In the middle of a half of the roof, a metre off all edges.
    let center = bounds.max - DVec3::new(3.0, 6.0, 0.0);
    let ball = |center, radius| [Volume::Sphere(Sphere { center, radius })];
    let lens = ball(center, 0.5);
    assert_eq!(triangles_meeting(&model, &index, &regions(&[&lens])).len(), 1);
    assert_eq!(objects_meeting(&model, &index, &regions(&[&lens])), [4]);
    // With one above the roof that shares only what is above it, and with one that is elsewhere: nothing.
    let (above, elsewhere) = (ball(center + DVec3::Z * 0.6, 0.5), ball(center + DVec3::X, 0.4));
    assert_eq!(regions(&[&lens, &above]).len(), 1);
    assert!(triangles_meeting(&model, &index, &regions(&[&lens, &above])).is_empty());
    assert!(regions(&[&lens, &elsewhere]).is_empty());
    assert!(regions(&[]).is_empty());
}
