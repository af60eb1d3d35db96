//! Small cities for tests, made by hand, most through the builder.

use std::sync::Arc;

use glam::DVec3;

use crate::city::{
    build::{
        ModelBuilder,
        lattice::Lattice,
        points::Pool,
        raw::{Polygons, RawGeometry, RawObject},
    },
    model::{Attribute, CityModel, CityObject, Lod, NONE, ObjectClass, Source, StringId, Surface, Value},
};

/// Millimetres somewhere in the Netherlands.
pub(crate) const LATTICE: Lattice = Lattice { step: DVec3::splat(0.001), origin: DVec3::new(85_000.0, 447_000.0, 0.0) };

/// A builder with one file begun.
pub(crate) fn builder() -> ModelBuilder {
    let mut builder = ModelBuilder::default();
    builder.begin_file(Source { path: "test.city.json".into(), format: "CityJSON", version: "2.0".to_owned() });
    builder
}

/// Adds an object with faces of one ring each (millimetres) and one semantic surface type for all; returns its index.
pub(crate) fn add(
    builder: &mut ModelBuilder,
    id: &str,
    class: ObjectClass,
    kind: Option<&str>,
    points: Vec<[i64; 3]>,
    faces: &[Vec<u32>],
) -> u32 {
    let object = builder.add_object(RawObject { id: id.to_owned(), class, ..RawObject::default() });
    let kind = kind.map_or(StringId(NONE), |kind| builder.intern(kind));
    let surface = builder.add_surface(Surface { object, material: NONE, kind, detail: NONE });
    let mut polygons = Polygons::default();
    for face in faces {
        polygons.indices.extend_from_slice(face);
        polygons.ring_ends.push(polygons.indices.len() as u32);
        polygons.polygon_ends.push(polygons.ring_ends.len() as u32);
        polygons.surfaces.push(surface);
    }
    let pool = Arc::new(Pool { lattice: LATTICE, points: points.into() });
    builder.add_geometry(RawGeometry { object, lod: Lod { tenths: 20 }, solid: false, pool, polygons });
    object
}

/// A box of these corners (millimetres), six faces outwards.
pub(crate) fn add_box(builder: &mut ModelBuilder, id: &str, min: [i64; 3], max: [i64; 3]) -> u32 {
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { min[axis] } else { max[axis] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<_> = faces.iter().map(|face| face.to_vec()).collect();
    add(builder, id, ObjectClass::Building, None, (0..8).map(corner).collect(), &faces)
}

/// `columns × rows` cubes of 10 m, 15 m apart.
pub(crate) fn grid_of_cubes(columns: i64, rows: i64) -> CityModel {
    let mut builder = builder();
    for row in 0..rows {
        for column in 0..columns {
            let min = [column * 15_000, row * 15_000, 0];
            add_box(&mut builder, &format!("{column}-{row}"), min, min.map(|c| c + 10_000));
        }
    }
    builder.finish()
}

/// One object: a bumpy triangulated surface of `side × side` squares of 5 m.
pub(crate) fn terrain(side: i64) -> CityModel {
    let mut builder = builder();
    let height = |x: i64, y: i64| (x * 7919 + y * 104_729) % 700;
    let points = (0..=side).flat_map(|y| (0..=side).map(move |x| [x * 5_003, y * 4_999, height(x, y)])).collect();
    let at = |x: i64, y: i64| (y * (side + 1) + x) as u32;
    let faces: Vec<Vec<u32>> = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            [vec![at(x, y), at(x + 1, y), at(x + 1, y + 1)], vec![at(x, y), at(x + 1, y + 1), at(x, y + 1)]]
        })
        .collect();
    add(&mut builder, "terrain", ObjectClass::Terrain, None, points, &faces);
    builder.finish()
}
/// Adds a building without geometry that has these attributes.
pub(crate) fn add_building(model: &mut CityModel, id: String, attributes: impl IntoIterator<Item = (StringId, Value)>) {
    let start = model.attributes.len() as u32;
    model.attributes.extend(attributes.into_iter().map(|(name, value)| Attribute { name, value }));
    let kind = model.strings.intern("Building");
    model.objects.push(CityObject {
        id: id.into(),
        kind,
        class: ObjectClass::Building,
        parents: vec![],
        children: vec![],
        attributes: start..model.attributes.len() as u32,
        geometries: 0..0,
    });
}
