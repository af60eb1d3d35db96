use std::{collections::BTreeMap, sync::Arc};

use super::*;
use crate::city::{
    build::{
        ModelBuilder,
        points::Pool,
        raw::{Polygons, RawGeometry, RawObject},
    },
    model::{StringId, Surface},
    test_city::{LATTICE, add, add_box, builder, grid_of_cubes, terrain},
};

fn all(model: &CityModel) -> Vec<Edge> {
    let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
    edges(model, &shown, &CreaseAngles::default())
}

/// The numbers of borders, creases and flat edges.
fn counts(edges: &[Edge]) -> [usize; 3] {
    [EdgeClass::Border, EdgeClass::Crease, EdgeClass::Flat].map(|c| edges.iter().filter(|e| e.class == c).count())
}

/// The ends of an edge in the lattice of the test cities (millimetres), the lower one first.
fn ends(model: &CityModel, edge: &Edge) -> [[i64; 3]; 2] {
    let origin = model.tiles[edge.tile as usize].origin.as_dvec3();
    let mut ends = edge.ends.map(|p| {
        let world = origin + Vec3::from(p).as_dvec3();
        ((world - LATTICE.origin) / LATTICE.step).round().to_array().map(|c| c as i64)
    });
    ends.sort_unstable();
    ends
}

fn building(points: Vec<[i64; 3]>, faces: &[Vec<u32>]) -> CityModel {
    let mut b = builder();
    add(&mut b, "building", ObjectClass::Building, None, points, faces);
    b.finish()
}

/// A geometry of polygons with rings, of no level of detail if `is_mesh`.
fn rings(points: Vec<[i64; 3]>, polygons: &[Vec<Vec<u32>>], normals: Vec<[f32; 3]>, is_mesh: bool) -> CityModel {
    let mut b: ModelBuilder = builder();
    let object = b.add_object(RawObject { id: "it".to_owned(), ..RawObject::default() });
    let surface = b.add_surface(Surface { object, material: NONE, kind: StringId(NONE), detail: NONE });
    let mut made = Polygons { normals, ..Polygons::default() };
    for polygon in polygons {
        for ring in polygon {
            made.indices.extend_from_slice(ring);
            made.ring_ends.push(made.indices.len() as u32);
        }
        made.polygon_ends.push(made.ring_ends.len() as u32);
        made.surfaces.push(surface);
    }
    let pool = Arc::new(Pool { lattice: LATTICE, points: points.into() });
    let lod = if is_mesh { Lod::NONE } else { Lod { tenths: 20 } };
    b.add_geometry(RawGeometry { object, lod, solid: false, pool, polygons: made });
    let model = b.finish();
    assert_eq!(model.geometries[0].dropped, 0);
    model
}

#[test]
fn a_cube_has_twelve_creases() {
    let mut b = builder();
    add_box(&mut b, "cube", [0; 3], [10_000; 3]);
    let model = b.finish();
    let found = all(&model);
    assert_eq!(counts(&found), [0, 12, 0]);
    for edge in &found {
        let [p, q] = ends(&model, edge);
        assert_eq!((0..3).filter(|&i| p[i] != q[i]).count(), 1, "{p:?} to {q:?} is a diagonal");
        let [a, b] = edge.normals.map(decode_normal);
        assert!(a.dot(b).abs() < 1e-4);
        // Out of the cube, and the first face left of the edge.
        let [start, end] = edge.ends.map(|p| Vec3::from(p).as_dvec3());
        let outward = 0.5 * (start + end) - DVec3::splat(5.0);
        assert!(a.dot(outward) > 4.9 && b.dot(outward) > 4.9);
        assert!(a.cross(end - start).dot(b) < -9.9, "the second face begins where the first one ends");
        assert_eq!(edge.extents, [Extent { inward_m: 10.0, before_m: 0.0, beyond_m: 0.0 }; 2]);
        let first = model.indices[3 * edge.triangle as usize];
        assert_eq!(model.vertices[first as usize].normal, edge.normals[0]);
    }
}

#[test]
fn a_hole_has_edges_and_a_triangulated_top_its_own() {
    // A box of 10 m, its top with a hole of 4 m.
    let square = |low: i64, high: i64, z: i64| [[low, low, z], [high, low, z], [high, high, z], [low, high, z]];
    let mut points: Vec<[i64; 3]> = square(0, 10_000, 0).to_vec();
    points.extend(square(0, 10_000, 10_000));
    points.extend(square(3_000, 7_000, 10_000));
    let sides = [vec![0, 1, 5, 4], vec![1, 2, 6, 5], vec![2, 3, 7, 6], vec![3, 0, 4, 7]].map(|ring| vec![ring]);
    let top = vec![vec![4, 5, 6, 7], vec![11, 10, 9, 8]];
    let mut polygons = sides.to_vec();
    polygons.push(top);
    let model = rings(points.clone(), &polygons, Vec::new(), false);
    assert_eq!(counts(&all(&model)), [4 + 4, 8, 0], "the foot and the hole are borders");
    // The top as two triangles in the data: their common edge is real, and flat.
    *polygons.last_mut().unwrap() = vec![vec![4, 5, 6]];
    polygons.push(vec![vec![4, 6, 7]]);
    let model = rings(points, &polygons, Vec::new(), false);
    assert_eq!(counts(&all(&model)), [4, 8, 1]);
}

#[test]
fn coplanar_halves_are_flat_and_steeper_ones_are_not() {
    // Two halves of a roof, 5 m wide each, the far border of the second raised.
    let halves = |rise: i64| {
        let points =
            vec![[0, 0, 0], [5_000, 0, 0], [5_000, 8_000, 0], [0, 8_000, 0], [10_000, 0, rise], [10_000, 8_000, rise]];
        counts(&all(&building(points, &[vec![0, 1, 2, 3], vec![1, 4, 5, 2]])))
    };
    assert_eq!(halves(0), [6, 0, 1]);
    // 5 m · tan 4.9° = 429 mm; tan 5.1°: 446 mm.
    assert_eq!(halves(429), [6, 0, 1]);
    assert_eq!(halves(446), [6, 1, 0]);
    assert_eq!(halves(-446), [6, 1, 0]);
}

#[test]
fn the_turn_of_a_face_does_not_matter() {
    let points = vec![[0, 0, 0], [5_000, 0, 0], [5_000, 8_000, 0], [0, 8_000, 0], [10_000, 0, 0], [10_000, 8_000, 0]];
    let model = building(points, &[vec![0, 1, 2, 3], vec![1, 2, 5, 4]]);
    let found = all(&model);
    assert_eq!(counts(&found), [6, 0, 1]);
    let flat = found.iter().find(|e| e.class == EdgeClass::Flat).unwrap();
    assert_eq!(flat.normals[0], flat.normals[1], "as if both were turned the same way");
    // A fence of two faces, back to back.
    let fence = vec![[0, 0, 0], [5_000, 0, 0], [5_000, 0, 2_000], [0, 0, 2_000]];
    let model = building(fence, &[vec![0, 1, 2, 3], vec![3, 2, 1, 0]]);
    assert_eq!(counts(&all(&model)), [4, 0, 0]);
}

#[test]
fn an_l_shaped_prism_has_eighteen_creases() {
    let plan = [[0, 0], [9_000, 0], [9_000, 4_000], [4_000, 4_000], [4_000, 9_000], [0, 9_000]];
    let at = |z: i64| plan.map(|[x, y]| [x, y, z]);
    let points = [at(0), at(5_000)].concat();
    let mut faces = vec![vec![5, 4, 3, 2, 1, 0], vec![6, 7, 8, 9, 10, 11]];
    faces.extend((0..6).map(|i| vec![i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6]));
    let model = building(points, &faces);
    assert_eq!(counts(&all(&model)), [0, 18, 0]);
}

#[test]
fn a_wall_between_two_rooms_is_a_crease() {
    let points = vec![
        [0, 0, 0],
        [0, 4_000, 0],
        [-5_000, 0, 0],
        [-5_000, 4_000, 0],
        [5_000, 0, 0],
        [5_000, 4_000, 0],
        [0, 0, 3_000],
        [0, 4_000, 3_000],
    ];
    // Floor left, floor right, wall up from where they meet.
    let model = building(points, &[vec![2, 0, 1, 3], vec![0, 4, 5, 1], vec![0, 1, 7, 6]]);
    assert_eq!(counts(&all(&model)), [9, 1, 0]);
}

/// A ball of 10 m, `n` segments around and half as many rings, in triangles.
fn ball(n: u32, are_smooth: bool) -> CityModel {
    let rows = n / 2;
    let mut directions = vec![DVec3::Z];
    for row in 1..rows {
        for i in 0..n {
            let polar = std::f64::consts::PI * f64::from(row) / f64::from(rows);
            let around = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            directions.push(DVec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos()));
        }
    }
    directions.push(-DVec3::Z);
    let at = |row: u32, i: u32| match row {
        0 => 0,
        r if r == rows => directions.len() as u32 - 1,
        r => 1 + (r - 1) * n + i % n,
    };
    let mut polygons = Vec::new();
    for row in 0..rows {
        for i in 0..n {
            let quad = [at(row, i), at(row + 1, i), at(row + 1, i + 1), at(row, i + 1)];
            for t in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                    polygons.push(vec![t.to_vec()]);
                }
            }
        }
    }
    let points = directions.iter().map(|d| (*d * 10_000.0).round().to_array().map(|c| c as i64)).collect();
    let corners = polygons.iter().flatten().flatten();
    let normals = corners.map(|&i| directions[i as usize].as_vec3().to_array());
    let normals = if are_smooth { normals.collect() } else { Vec::new() };
    rings(points, &polygons, normals, true)
}

#[test]
fn smooth_meshes_have_no_edges_and_faceted_ones_have() {
    // Facets of 12 segments turn by about 30°, of 36 by about 10°.
    assert_eq!(counts(&all(&ball(12, true))), [0, 0, 0]);
    assert_eq!(counts(&all(&ball(36, false))), [0, 0, 0]);
    let [borders, creases, flat] = counts(&all(&ball(12, false)));
    assert_eq!((borders, flat), (0, 0));
    // 120 triangles have 180 edges. Out fall the diagonals of four rings of flat quads, and the edges to the poles,
    // where facets turn by 2 asin(sin 15° · sin 15°) = 8° only.
    assert_eq!(creases, 180 - 4 * 12 - 2 * 12);
}

#[test]
fn a_box_with_averaged_normals_keeps_its_edges() {
    let mut b = builder();
    add_box(&mut b, "cube", [0; 3], [10_000; 3]);
    let model = b.finish();
    let points: Vec<[i64; 3]> = (0..8).map(|i| [0, 1, 2].map(|axis| (i >> axis & 1) * 10_000)).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<Vec<Vec<u32>>> =
        faces.iter().flat_map(|f| [vec![vec![f[0], f[1], f[2]]], vec![vec![f[0], f[2], f[3]]]]).collect();
    let outward = |i: &u32| points[*i as usize].map(|c| if c == 0 { -1.0_f32 } else { 1.0 });
    let normals = triangles.iter().flatten().flatten().map(outward).collect();
    let mesh = rings(points.clone(), &triangles, normals, true);
    let places = |model: &CityModel| {
        let mut places: Vec<_> = all(model).iter().map(|e| ends(model, e)).collect();
        places.sort_unstable();
        places
    };
    assert_eq!(places(&mesh), places(&model));
}

#[test]
fn relief_is_calm() {
    let model = terrain(20);
    let [borders, creases, flat] = counts(&all(&model));
    assert_eq!((borders, creases), (80, 0));
    // Inner edges of 20 × 20 squares with a diagonal each.
    assert_eq!(flat, 2 * 20 * 19 + 400);
}

#[test]
fn polygons_cut_by_tiles_have_no_diagonals() {
    // A comb: many corners over 300 m, so many triangles over many tiles; and its neighbour in the same plane.
    let mut ring: Vec<[i64; 3]> = Vec::new();
    for i in 0..40_i64 {
        ring.push([i * 8_000, 0, 0]);
        ring.push([i * 8_000 + 4_000, 200_000 - (i * 7919) % 9_000, 0]);
    }
    ring.push([39 * 8_000 + 4_000, -50_000, 0]);
    ring.push([0, -50_000, 0]);
    let corners = ring.len() as u32;
    let beside = [[0, -50_000, 0], [316_000, -50_000, 0], [316_000, -150_000, 0], [0, -150_000, 0]];
    let points: Vec<_> = ring.iter().copied().chain([beside[2], beside[3]]).collect();
    let clockwise: Vec<u32> = (0..corners).rev().collect();
    let model =
        building(points.clone(), &[clockwise, vec![corners - 1, corners, corners + 1].into_iter().rev().collect()]);
    assert!(model.tiles.len() >= 5, "{} tiles", model.tiles.len());
    assert!(!model.cut_polygons.is_empty());
    model.validate().unwrap();
    let mut expected: BTreeMap<[[i64; 3]; 2], usize> = BTreeMap::new();
    let mut expect = |mut ends: [[i64; 3]; 2]| {
        ends.sort_unstable();
        *expected.entry(ends).or_default() += 1;
    };
    for i in 0..corners as usize {
        expect([ring[i], ring[(i + 1) % corners as usize]]);
    }
    for [i, j] in [[corners - 1, corners], [corners, corners + 1], [corners + 1, corners - 1]] {
        expect([points[i as usize], points[j as usize]]);
    }
    let mut found: Vec<_> = all(&model).iter().map(|e| ends(&model, e)).collect();
    found.sort_unstable();
    assert_eq!(found, expected.into_keys().collect::<Vec<_>>());
}

#[test]
fn the_order_of_faces_changes_nothing_but_the_triangles() {
    let mut b = builder();
    add_box(&mut b, "cube", [0; 3], [10_000; 3]);
    let model = b.finish();
    let points: Vec<[i64; 3]> = (0..8).map(|i| [0, 1, 2].map(|axis| (i >> axis & 1) * 10_000)).collect();
    let faces = [[1, 3, 7, 5], [4, 6, 2, 0], [2, 6, 7, 3], [0, 1, 5, 4], [7, 6, 4, 5], [0, 2, 3, 1]];
    let other = building(points, &faces.map(|f: [u32; 4]| f.to_vec()));
    let plain = |model: &CityModel| -> Vec<Edge> {
        all(model).iter().map(|e| Edge { triangle: 0, other: (0, 0), ..*e }).collect()
    };
    assert_eq!(plain(&model), plain(&other));
}

#[test]
fn every_geometry_is_by_itself_and_only_shown_ones_are_asked() {
    let model = grid_of_cubes(7, 5);
    let found = edges(&model, &[3, 30, 99], &CreaseAngles::default());
    assert_eq!(counts(&found), [0, 24, 0], "there is no geometry 99");
    assert_eq!(found.iter().map(|e| model.tiles[e.tile as usize].geometry).collect::<Vec<_>>()[11..13], [3, 30]);
    assert_eq!(counts(&all(&model)), [0, 7 * 5 * 12, 0], "faces of neighbours in one plane are not joined");
    assert!(edges(&CityModel::default(), &[], &CreaseAngles::default()).is_empty());
}
