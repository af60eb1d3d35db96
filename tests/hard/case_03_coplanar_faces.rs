//! Case 3: exactly coplanar faces. Here: two triangles of different polygons have the same plane number exactly when
//! they lie on the same plane, also across files with other origins. Oracle: determinants of the files' integers.

use std::sync::Arc;

use glam::DVec3;
use veduta::city::{
    Lod, NONE, Source, StringId, Surface,
    build::{Lattice, ModelBuilder, Polygons, Pool, RawGeometry, RawObject},
    coplanar::coplanar_triangles,
};

use crate::oracle::{Numbers, P3, normal};

fn are_coplanar(s: [P3; 3], t: [P3; 3]) -> bool {
    let n = normal(s);
    t.iter().all(|p| (0..3).map(|i| n[i] * (i128::from(p[i]) - i128::from(s[0][i]))).sum::<i128>() == 0)
}

/// Triangles on a coarse lattice (so that many share planes), dealt to two files; absolute millimetres.
fn city(count: usize, seed: u64) -> (veduta::city::CityModel, Vec<[P3; 3]>) {
    let mut numbers = Numbers(seed);
    let mut builder = ModelBuilder::default();
    let base: P3 = [84_616_468, 447_422_999, -677];
    let mut triangles = Vec::new();
    for (file, origin) in [[84_616_468_i64, 447_422_999, -677], [78_248_660, 457_604_591, 2_463]].iter().enumerate() {
        let path = format!("{file}.city.json").into();
        builder.begin_file(Source { path, format: "CityJSON", version: "2.0".to_owned() });
        let meters = |i: usize| origin[i] as f64 / 1000.0;
        let lattice = Lattice { step: DVec3::splat(0.001), origin: DVec3::new(meters(0), meters(1), meters(2)) };
        for _ in 0..count {
            let corner = |numbers: &mut Numbers| [0, 1, 2].map(|i| base[i] + 500 * numbers.below(4));
            let triangle = [corner(&mut numbers), corner(&mut numbers), corner(&mut numbers)];
            if normal(triangle) == [0; 3] {
                continue;
            }
            let object = builder.add_object(RawObject { id: triangles.len().to_string(), ..RawObject::default() });
            let surface = builder.add_surface(Surface { object, material: NONE, kind: StringId(NONE), detail: NONE });
            let points = triangle.map(|p| [0, 1, 2].map(|i| p[i] - origin[i])).to_vec();
            let polygons = Polygons {
                indices: vec![0, 1, 2],
                ring_ends: vec![3],
                polygon_ends: vec![1],
                surfaces: vec![surface],
                ..Polygons::default()
            };
            let pool = Arc::new(Pool { lattice, points: points.into() });
            builder.add_geometry(RawGeometry { object, lod: Lod { tenths: 20 }, solid: false, pool, polygons });
            triangles.push(triangle);
        }
    }
    (builder.finish(), triangles)
}

#[test]
fn plane_numbers_agree_with_determinants_across_files() {
    let (model, triangles) = city(150, 3);
    assert_eq!(model.planes.len(), triangles.len(), "one triangle per object, in order");
    let mut shared = 0;
    for i in 0..triangles.len() {
        let mut alone = true;
        for j in 0..triangles.len() {
            if i == j {
                continue;
            }
            let coplanar = are_coplanar(triangles[i], triangles[j]);
            alone &= !coplanar;
            let same = model.planes[i] != 0 && model.planes[i] == model.planes[j];
            assert_eq!(same, coplanar, "{:?} {:?}", triangles[i], triangles[j]);
        }
        assert_eq!(model.planes[i] == 0, alone);
        shared += usize::from(!alone);
    }
    assert!(shared > 50, "the test has something to tell apart: {shared}");
}

#[test]
fn the_order_does_not_depend_on_what_is_asked_first() {
    let (model, _) = city(150, 7);
    let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
    let forwards = coplanar_triangles(&model, &shown);
    let backwards = coplanar_triangles(&model, &shown.iter().rev().copied().collect::<Vec<_>>());
    assert!(!forwards.is_empty());
    assert_eq!(forwards, backwards);
    for pair in forwards.windows(2).filter(|pair| pair[0].group == pair[1].group) {
        assert_eq!(pair[0].priority + 1, pair[1].priority);
    }
}
