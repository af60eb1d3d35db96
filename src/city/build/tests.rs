use std::sync::Arc;

use glam::DVec3;

use super::*;
use crate::city::model::{Lod, NONE, decode_normal};

const MM: Lattice = Lattice { step: DVec3::splat(0.001), origin: DVec3::ZERO };

fn ring_polygons(rings: &[&[u32]]) -> Polygons {
    let mut polygons = Polygons::default();
    for ring in rings {
        polygons.indices.extend_from_slice(ring);
        polygons.ring_ends.push(polygons.indices.len() as u32);
        polygons.polygon_ends.push(polygons.ring_ends.len() as u32);
        polygons.surfaces.push(0);
    }
    polygons
}

fn builder() -> ModelBuilder {
    let mut builder = ModelBuilder::default();
    builder.begin_file(Source { path: "a.city.json".into(), format: "CityJSON", version: "2.0".to_owned() });
    let object = builder.add_object(RawObject { id: "house".to_owned(), ..RawObject::default() });
    builder.add_surface(Surface { object, material: NONE, kind: StringId(NONE), detail: NONE });
    builder
}

fn add(builder: &mut ModelBuilder, lattice: Lattice, points: &[[i64; 3]], polygons: Polygons) {
    builder.add_geometry(RawGeometry {
        object: 0,
        lod: Lod { tenths: 20 },
        solid: false,
        pool: Arc::new(Pool { lattice, points: points.to_vec().into() }),
        polygons,
    });
}

const CUBE: [[i64; 3]; 8] = [
    [1000, 1000, 0],
    [11000, 1000, 0],
    [11000, 11000, 0],
    [1000, 11000, 0],
    [1000, 1000, 10000],
    [11000, 1000, 10000],
    [11000, 11000, 10000],
    [1000, 11000, 10000],
];
const CUBE_FACES: [&[u32]; 6] =
    [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

#[test]
fn a_cube_has_twelve_triangles_facing_out_in_one_tile() {
    let mut b = builder();
    add(&mut b, MM, &CUBE, ring_polygons(&CUBE_FACES));
    let model = b.finish();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!((model.tiles.len(), model.vertices.len(), model.planes.as_slice()), (1, 24, [0; 12].as_slice()));
    let tile = &model.tiles[0];
    assert_eq!(tile.origin, glam::IVec3::new(1, 1, 0));
    assert_eq!(tile.bounds, model.geometries[0].bounds);
    let center = tile.bounds.center();
    assert_eq!(center, DVec3::new(6.0, 6.0, 5.0));
    for triangle in model.indices.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| model.position(tile, triangle[i]));
        let normal = (b - a).cross(c - a);
        assert!(normal.dot(a - center) > 0.0);
        let stored = decode_normal(model.vertices[triangle[0] as usize].normal);
        assert!(stored.angle_between(normal) < 1e-4);
    }
}

#[test]
fn the_same_face_is_drawn_once_wherever_its_ring_starts() {
    let mut b = builder();
    add(&mut b, MM, &CUBE, ring_polygons(&CUBE_FACES));
    // Again from another pool with another origin, every ring started elsewhere; one face is new.
    let lattice = Lattice { origin: DVec3::new(1.0, -2.0, 0.5), ..MM };
    let moved: Vec<_> = CUBE.iter().map(|p| [p[0] - 1000, p[1] + 2000, p[2] - 500]).collect();
    let rotated: Vec<Vec<u32>> = CUBE_FACES
        .iter()
        .map(|face| {
            let mut face = face.to_vec();
            face.rotate_left(2);
            face
        })
        .collect();
    let mut rings: Vec<&[u32]> = rotated.iter().map(Vec::as_slice).collect();
    rings.push(&[0, 1, 2, 3]);
    add(&mut b, lattice, &moved, ring_polygons(&rings));
    let model = b.finish();
    assert_eq!(model.warnings.count(WarningCode::DuplicateShape), 6);
    let counts: Vec<_> = model.geometries.iter().map(|g| (g.polygons, g.triangles, g.dropped)).collect();
    assert_eq!(counts, [(6, 12, 0), (7, 2, 0)], "the reversed floor stays: it faces the other way");
    assert_eq!(model.geometries[0].bounds, model.geometries[1].bounds);
    let floor: Vec<u32> = model.planes.iter().copied().filter(|&p| p != 0).collect();
    assert_eq!(floor, [1; 4], "both floors are on plane 1");
}

#[test]
fn large_geometries_are_cut_into_tiles_that_keep_whole_triangles() {
    let mut b = builder();
    let side = 30_i64;
    let points: Vec<[i64; 3]> =
        (0..=side).flat_map(|y| (0..=side).map(move |x| [x * 7001 + 12_345_678, y * 7001 - 777, x * y])).collect();
    let at = |x: i64, y: i64| (y * (side + 1) + x) as u32;
    let rings: Vec<[u32; 3]> = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect();
    add(&mut b, MM, &points, ring_polygons(&rings.iter().map(|r| r.as_slice()).collect::<Vec<_>>()));
    let model = b.finish();
    assert_eq!(model.geometries[0].triangles, 1800);
    assert_eq!(model.tiles.len(), 16);
    let mut seen = std::collections::BTreeSet::new();
    for tile in &model.tiles {
        assert!((tile.origin - model.tiles[0].origin).to_array().iter().all(|d| d % 64 == 0));
        for index in &model.indices[tile.indices.start as usize..tile.indices.end as usize] {
            assert!(*index < tile.vertices.end - tile.vertices.start);
            let position = model.position(tile, tile.vertices.start + index);
            let millimetres = (position * 1000.0).round();
            assert!((position * 1000.0 - millimetres).abs().max_element() < 0.01, "{position}");
            seen.insert(millimetres.as_i64vec3().to_array());
        }
    }
    assert_eq!(seen, points.into_iter().collect());
}

#[test]
fn triangles_that_reach_far_out_of_their_tiles_share_corners_to_the_bit() {
    // A fan: all corners far from each other, the hub in another tile than most triangles, and one polygon over all.
    let mut b = builder();
    let rim = |i: i64| [i * 41_137 - 300_003, 377_777 - (i * 9_973) % 7_001, i * 13];
    let mut points: Vec<[i64; 3]> = (0..16).map(rim).collect();
    points.push([101_009, -300_007, 7]);
    let mut rings: Vec<Vec<u32>> = (0..15).map(|i| vec![16, i + 1, i]).collect();
    rings.push((0..17).rev().collect());
    add(&mut b, MM, &points, ring_polygons(&rings.iter().map(Vec::as_slice).collect::<Vec<_>>()));
    let model = b.finish();
    model.validate().unwrap();
    assert!(model.tiles.len() > 5);
    let places: std::collections::BTreeSet<[u64; 3]> = model
        .tiles
        .iter()
        .flat_map(|tile| tile.vertices.clone().map(|v| model.position(tile, v).to_array().map(f64::to_bits)))
        .collect();
    assert_eq!(places.len(), 17, "one place per point, whichever tile it is seen from");
    // The last polygon's fifteen triangles lie in several tiles; the others are whole.
    assert_eq!(model.cut_polygons.iter().map(|cut| cut.polygon).collect::<Vec<_>>(), [15; 15]);
}

#[test]
fn unusable_faces_are_dropped_with_their_reason() {
    let mut b = builder();
    let mut points = CUBE.to_vec();
    points.push(BAD_POINT);
    let rings: [&[u32]; 6] = [&[0, 1, 2, 3], &[0, 1, 8], &[0, 1, 99], &[0, 1], &[0, 1, 0], &[]];
    add(&mut b, MM, &points, ring_polygons(&rings));
    let model = b.finish();
    let geometry = &model.geometries[0];
    assert_eq!((geometry.polygons, geometry.triangles, geometry.dropped), (6, 2, 5));
    let count = |code| model.warnings.count(code);
    assert_eq!(count(WarningCode::BadCoordinate), 1);
    assert_eq!(count(WarningCode::VertexIndex), 1);
    assert_eq!(count(WarningCode::ShortRing), 3);
    assert_eq!(geometry.bounds.max, DVec3::new(11.0, 11.0, 0.0), "bad coordinates are no part of the bounds");
}

#[test]
fn thread_counts_do_not_change_the_result() {
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut b = builder();
            for i in 0..3000_i64 {
                let points: Vec<_> = CUBE.iter().map(|p| [p[0] + i * 10_000, p[1], p[2]]).collect();
                if i > 0 {
                    b.add_object(RawObject { id: format!("house {}", i % 2500), ..RawObject::default() });
                }
                add(&mut b, MM, &points, ring_polygons(&CUBE_FACES));
                b.staging.parts.last_mut().unwrap().object = i as u32;
            }
            b.finish()
        })
    };
    let (one, four) = (made(1), made(4));
    assert_eq!(one.vertices, four.vertices);
    assert_eq!((&one.indices, &one.planes), (&four.indices, &four.planes));
    assert_eq!((&one.tiles, &one.geometries), (&four.tiles, &four.geometries));
    assert_eq!(one.warnings, four.warnings);
    assert_eq!(one.objects.len(), 3000);
    let alone = one.planes.iter().filter(|&&p| p == 0).count();
    assert_eq!(alone, 4, "neighbours share walls, all share floor, roof and sides: only the two ends are alone");
}

#[test]
fn geometries_are_sorted_by_object_and_level() {
    let mut b = builder();
    let second = b.add_object(RawObject { id: "b".to_owned(), ..RawObject::default() });
    for (object, tenths) in [(second, 22), (0, 22), (second, 12), (0, 13)] {
        add(&mut b, MM, &CUBE, ring_polygons(&CUBE_FACES));
        let raw = b.staging.parts.last_mut().unwrap();
        (raw.object, raw.lod) = (object, Lod { tenths });
    }
    let model = b.finish();
    let order: Vec<_> = model.geometries.iter().map(|g| (g.object, g.lod.tenths)).collect();
    assert_eq!(order, [(0, 13), (0, 22), (1, 12), (1, 22)]);
    assert_eq!(model.objects.iter().map(|o| o.geometries.clone()).collect::<Vec<_>>(), [0..2, 2..4]);
    assert!(model.tiles.iter().zip(0..).all(|(tile, i)| tile.geometry == i));
}
