//! From a document as read to the builder: vertices find their place, polygons their surfaces, templates their instances.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};
use rustc_hash::FxHashMap;

use crate::city::{
    build::{
        ModelBuilder,
        lattice::Lattice,
        points::Pool,
        raw::{Polygons, RawGeometry},
    },
    cityjson::{
        appearance::{AppearanceTable, SharedAppearance},
        document::{Document, ObjectRead},
        geometry::{GeometryKind, GeometryRead},
        packed::PackedGeometries,
        semantics::{self, Meaning},
        vertices::{self, Placing, Vertices},
    },
    memory::give_back,
    model::{Lod, NONE, StringId, Surface},
    warning::WarningCode,
};

/// Indices that instances of templates may add to one city: a file of a few bytes could ask for any number.
const MAX_INSTANCED: usize = 1 << 26;

/// Templates of a file and their vertices, metres.
#[derive(Clone, Debug, Default)]
pub struct Templates {
    /// The geometries.
    pub geometries: Vec<GeometryRead>,
    /// The vertices that they index into.
    pub vertices: Vec<DVec3>,
}

/// The assembly of one document's objects into those of the builder.
pub struct Assembly<'a> {
    /// Where they go.
    pub builder: &'a mut ModelBuilder,
    /// Materials and textures of the file.
    pub shared_appearance: &'a mut SharedAppearance,
    /// Those of the document.
    pub appearance_table: &'a AppearanceTable,
    /// Templates of the file.
    pub templates: &'a Templates,
    /// Materials and textures of the templates, of where those are declared.
    pub template_appearance: &'a AppearanceTable,
    /// The way from numbers to metres.
    pub placing: Placing,
    /// Indices instanced so far.
    pub instanced: &'a mut usize,
}

impl Assembly<'_> {
    /// Adds a document's objects. Without vertices (a file cut before them) they have no geometry.
    pub fn add(&mut self, mut document: Document) {
        let anchors = anchors(&document.geometries, &document.vertices, &self.placing);
        let is_cut = document.damage.is_some() && document.vertices.len() == 0;
        let pool = Arc::new(document.vertices.into_pool(&self.placing));
        let mut stowed = document.geometries.into_reader();
        let mut geometry = GeometryRead::default();
        for ObjectRead { raw, attributes, geometries } in document.objects.iter_mut().map(std::mem::take) {
            let id = raw.id.clone();
            let object = self.builder.add_object_with(raw, &document.attributes[attributes]);
            let mut surfaces = SurfaceTable::new(object);
            for _ in 0..geometries {
                if stowed.next_into(&mut geometry).is_some() && !is_cut {
                    self.add_geometry(&mut geometry, &id, object, &pool, &anchors, &mut surfaces);
                }
            }
        }
        give_back(document.objects);
        give_back(document.attributes);
    }

    fn add_geometry(
        &mut self,
        geometry: &mut GeometryRead,
        id: &str,
        object: u32,
        pool: &Arc<Pool>,
        anchors: &FxHashMap<u32, DVec3>,
        surfaces: &mut SurfaceTable,
    ) {
        match geometry.kind {
            GeometryKind::Instance => self.add_instance(geometry, id, object, anchors, surfaces),
            GeometryKind::Unknown => self.warn(WarningCode::BadGeometry, id, || {
                format!("a geometry is of type \"{}\", which CityJSON does not have; it is skipped", geometry.kind_name)
            }),
            GeometryKind::MultiPoint | GeometryKind::MultiLineString => {
                self.warn(WarningCode::Unsupported, id, || format!("{:?} is read but not drawn", geometry.kind));
                let lod = self.lod(geometry, id);
                // Indices without rings: they count for the extent, and nothing is drawn.
                let polygons =
                    Polygons { indices: std::mem::take(&mut geometry.boundaries.indices), ..Polygons::default() };
                self.builder.add_geometry(RawGeometry { object, lod, solid: false, pool: pool.clone(), polygons });
            }
            _ => {
                let Some(polygons) = self.polygons(geometry, id, self.appearance_table, surfaces) else { return };
                let (lod, solid) = (self.lod(geometry, id), geometry.kind.is_solid());
                self.builder.add_geometry(RawGeometry { object, lod, solid, pool: pool.clone(), polygons });
            }
        }
    }

    /// The polygons of a geometry of surfaces or solids; `None` (and a warning) where its arrays do not fit its type.
    fn polygons(
        &mut self,
        geometry: &GeometryRead,
        id: &str,
        appearance_table: &AppearanceTable,
        surfaces: &mut SurfaceTable,
    ) -> Option<Polygons> {
        let depth = geometry.kind.ring_depth()?;
        let Some((indices, ring_ends, polygon_ends)) = geometry.boundaries.rings(depth) else {
            self.warn(WarningCode::BadGeometry, id, || {
                format!(
                    "the boundaries of a {:?} are not indices in {} nested arrays; it is skipped",
                    geometry.kind,
                    depth + 1
                )
            });
            return None;
        };
        let meanings = semantics::of_polygons(geometry, depth, self.builder, id);
        let (materials, texcoords) =
            self.shared_appearance.materials_of(geometry, depth, appearance_table, self.builder, id);
        let surfaces = meanings
            .into_iter()
            .zip(materials)
            .map(|(meaning, material)| surfaces.find(meaning, material, self.builder))
            .collect();
        let (indices, ring_ends, polygon_ends) = (indices.to_vec(), ring_ends.to_vec(), polygon_ends.to_vec());
        Some(Polygons { indices, ring_ends, polygon_ends, surfaces, texcoords, normals: Vec::new() })
    }

    fn add_instance(
        &mut self,
        instance: &GeometryRead,
        id: &str,
        object: u32,
        anchors: &FxHashMap<u32, DVec3>,
        surfaces: &mut SurfaceTable,
    ) {
        let templates = self.templates;
        let Some(template) = instance.template.and_then(|t| templates.geometries.get(t as usize)) else {
            let count = templates.geometries.len();
            return self.warn(WarningCode::TemplateIndex, id, || {
                format!("template {} does not exist; the file has {count}", instance.template.map_or(-1, i64::from))
            });
        };
        let anchor = match instance.boundaries.indices[..] {
            [index] => anchors.get(&index).copied().filter(|a| a.is_finite()),
            _ => None,
        };
        let (Some(anchor), Some(matrix)) = (anchor, instance.matrix) else {
            return self.warn(WarningCode::BadGeometry, id, || {
                "an instance needs one existing reference vertex and a transformationMatrix of 16 numbers; it is skipped"
                    .to_owned()
            });
        };
        *self.instanced += template.boundaries.indices.len();
        if *self.instanced > MAX_INSTANCED {
            return self.warn(WarningCode::Unsupported, id, || {
                format!("instances of templates have more than {MAX_INSTANCED} corners together; the rest is skipped")
            });
        }
        let Some(mut polygons) = self.polygons(template, id, self.template_appearance, surfaces) else {
            if template.kind.ring_depth().is_none() {
                self.warn(WarningCode::BadGeometry, id, || {
                    format!("a template of type {:?} cannot be placed; it is skipped", template.kind)
                });
            }
            return;
        };
        let by_rows = DMat4::from_cols_array(&matrix).transpose();
        let is_by_columns = by_rows.row(3).truncate() != DVec3::ZERO && by_rows.col(3) == DVec4::W;
        if is_by_columns {
            self.warn(WarningCode::Malformed, id, || {
                "a transformationMatrix moves by its last row, where CityJSON has it in the last column; it is read column by column"
                    .to_owned()
            });
        }
        let placing = if is_by_columns { by_rows.transpose() } else { by_rows };
        let world_from_template = DMat4::from_translation(anchor) * placing;
        if world_from_template.determinant() < 0.0 {
            reverse_rings(&mut polygons);
        }
        let points = place(&mut polygons.indices, &templates.vertices, &world_from_template);
        let pool = Arc::new(Pool { lattice: Lattice::FINE, points: points.into() });
        let (lod, solid) = (self.lod(template, id), template.kind.is_solid());
        self.builder.add_geometry(RawGeometry { object, lod, solid, pool, polygons });
    }

    fn lod(&mut self, geometry: &GeometryRead, id: &str) -> Lod {
        if geometry.lod.is_none() {
            self.warn(WarningCode::Malformed, id, || {
                "a geometry has no level of detail such as \"2.2\"; it is shown where there is no other".to_owned()
            });
        }
        geometry.lod.unwrap_or(Lod::NONE)
    }

    fn warn(&mut self, code: WarningCode, id: &str, message: impl FnOnce() -> String) {
        self.builder.model.warnings.add(code, id, || format!("object {id}: {}", message()));
    }
}

/// World places of the reference vertices of instances.
fn anchors(geometries: &PackedGeometries, vertices: &Vertices, placing: &Placing) -> FxHashMap<u32, DVec3> {
    geometries
        .instances()
        .flat_map(|g| &g.boundaries.indices)
        .map(|&index| (index, placing.world(vertices.transformed(index, &placing.transform))))
        .collect()
}

/// Turns a mirrored instance right side out again.
fn reverse_rings(polygons: &mut Polygons) {
    let mut start = 0;
    for end in polygons.ring_ends.iter().map(|e| *e as usize) {
        polygons.indices[start..end].reverse();
        if let Some(texcoords) = polygons.texcoords.get_mut(start..end) {
            texcoords.reverse();
        }
        start = end;
    }
}

/// Places the template vertices that `indices` use and points the indices at them.
fn place(indices: &mut [u32], template: &[DVec3], world_from_template: &DMat4) -> Vec<[i64; 3]> {
    let mut points = Vec::new();
    let mut placed: FxHashMap<u32, u32> = FxHashMap::default();
    for index in indices {
        *index = match template.get(*index as usize) {
            Some(vertex) => *placed.entry(*index).or_insert_with(|| {
                let p = *world_from_template * vertex.extend(1.0);
                points.push(vertices::fine_point(if p.w == 1.0 { p.truncate() } else { p.truncate() / p.w }));
                (points.len() - 1) as u32
            }),
            None => u32::MAX,
        };
    }
    points
}

/// The surfaces of one object, each once.
struct SurfaceTable {
    object: u32,
    known: FxHashMap<(StringId, u32, u32), u32>,
}

impl SurfaceTable {
    fn new(object: u32) -> Self {
        Self { object, known: FxHashMap::default() }
    }

    fn find(&mut self, meaning: Meaning, material: u32, builder: &mut ModelBuilder) -> u32 {
        debug_assert!(material == NONE || (material as usize) < builder.model.materials.len());
        let (object, (kind, detail)) = (self.object, meaning);
        *self
            .known
            .entry((kind, detail, material))
            .or_insert_with(|| builder.add_surface(Surface { object, material, kind, detail }))
    }
}
