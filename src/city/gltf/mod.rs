//! glTF 2.0 and GLB: mesh nodes, depth first, become city objects.
//!
//! glTF is y up, with z toward the viewer; the world here is x east, y north, z up: (x, y, z) → (x, −z, y).
//! Node transforms are chained in f64. glTF says nothing of levels of detail or of what a mesh is, so geometry has
//! [`Lod::NONE`](crate::city::model::Lod::NONE) and objects are of type `Mesh`, taken for buildings.

mod accessor;
mod buffers;
mod container;
mod document;
mod extras;
mod material;
mod mesh;
mod node;

use glam::{DAffine3, DVec3};
use gltf::json::mesh::Mesh;
use rustc_hash::FxHashMap;

use self::{
    buffers::{Buffers, Surroundings},
    document::Document,
    material::{Materials, Palette},
    mesh::{Gathered, Placed},
};
use crate::city::{
    build::{ModelBuilder, raw::RawObject},
    load::{error::LoadError, input::Input, options::LoadOptions},
    model::{MESH, ObjectClass, Source},
    warning::WarningCode,
};

/// Corners that a file may unfold to by instancing and by shared accessors: this many for free, ...
const FREE_CORNERS: u64 = 1 << 20;
/// ... this many for each of its bytes, ...
const CORNERS_PER_BYTE: u64 = 32;
/// ... and never more than this (22 million triangles, about 4 GiB while they are built).
const MAX_CORNERS: u64 = 1 << 26;

/// Reads a glTF file into `builder`.
pub fn read(builder: &mut ModelBuilder, input: &Input, options: &LoadOptions) -> Result<(), LoadError> {
    let container = container::open(input, &mut builder.model.warnings)?;
    let document = &container.document;
    let around = Surroundings { path: &input.path, options };
    let buffers = Buffers::read(document, container.binary, around, &mut builder.model);
    let from = Palette { document, buffers: &buffers, around };
    builder.begin_file(Source { path: input.path.clone(), format: "glTF", version: container.version.clone() });
    let bytes = input.bytes.len() as u64 + buffers.total;
    let corners = FREE_CORNERS.saturating_add(bytes.saturating_mul(CORNERS_PER_BYTE)).min(MAX_CORNERS);
    let mut reader = Reader {
        from,
        materials: Materials::new(&buffers),
        ids: FxHashMap::default(),
        corners,
        triangles: 0,
        trouble: None,
    };
    let mut visits = node::visits(document, &input.path, &mut builder.model.warnings);
    let first = visits.iter().find_map(|visit| mesh::first_place(document, &buffers, visit));
    if let Some(frame) = first.and_then(|place| builder.frame_of_unnamed(&input.path, place)) {
        visits.iter_mut().for_each(|visit| visit.world_from_node = frame.local_from_earth() * visit.world_from_node);
    }
    let mut ids: Vec<String> = Vec::new();
    for visit in &visits {
        let parent = visit.parent.and_then(|p| ids.get(p).cloned());
        ids.push(reader.read_node(builder, visit, parent));
    }
    match reader.trouble {
        Some((place, reason)) if reader.triangles == 0 => {
            Err(LoadError::at(&input.path, place, format!("{reason}; no mesh of the file could be read")))
        }
        _ => Ok(()),
    }
}

/// The state of reading one file.
struct Reader<'a> {
    from: Palette<'a>,
    materials: Materials,
    /// The number of times that each id was used.
    ids: FxHashMap<String, u32>,
    /// Corners that may still be unfolded.
    corners: u64,
    triangles: usize,
    /// The first primitive that could not be read: JSON path, reason.
    trouble: Option<(String, String)>,
}

impl Reader<'_> {
    /// Adds the object of a mesh node and its geometry; returns its id.
    fn read_node(&mut self, builder: &mut ModelBuilder, visit: &node::Visit<'_>, parent: Option<String>) -> String {
        let node = visit.node;
        let name = node.name.as_deref().filter(|n| !n.is_empty());
        let id = self.unique(builder, name.map_or_else(|| format!("node-{}", visit.number), str::to_owned));
        let mesh = self.from.document.meshes.get(visit.mesh);
        let mut attributes = Vec::new();
        for extras in [node.extras.as_ref(), mesh.as_ref().ok().and_then(|m| m.extras.as_ref())].into_iter().flatten() {
            for attribute in extras::attributes(builder, extras, &id) {
                // The node's own word counts before that of the mesh it shares.
                if !attributes.iter().any(|a: &crate::city::model::Attribute| a.name == attribute.name) {
                    attributes.push(attribute);
                }
            }
        }
        let object = builder.add_object(RawObject {
            id: id.clone(),
            kind: MESH.into(),
            class: ObjectClass::Building,
            parents: parent.into_iter().collect(),
            children: Vec::new(),
            attributes,
        });
        if node.skin.is_some() {
            self.unsupported(builder, &id, "skins are not drawn; the mesh stands in its bind pose");
        }
        match mesh {
            Ok(mesh) => self.read_mesh(builder, visit, mesh, Gathered::new(object, id.clone()), &id),
            Err(reason) => self.bad(builder, &id, format!("nodes[{}].mesh", visit.number), reason),
        }
        id
    }

    fn read_mesh(
        &mut self,
        builder: &mut ModelBuilder,
        visit: &node::Visit<'_>,
        mesh: &Mesh,
        mut gathered: Gathered,
        id: &str,
    ) {
        let from = self.from;
        let instances = match node::instances(from.document, from.buffers, visit.node) {
            Ok(instances) => instances,
            Err(reason) => {
                let place = format!("nodes[{}].extensions.EXT_mesh_gpu_instancing", visit.number);
                return self.bad(builder, id, place, reason);
            }
        };
        for (i, json) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{}].primitives[{i}]", visit.mesh);
            self.corners = self.corners.saturating_sub(mesh::OPENING_CORNERS);
            let primitive = match mesh::open(from.document, from.buffers, json) {
                Ok(Some(primitive)) => primitive,
                Ok(None) => {
                    self.unsupported(builder, id, "points and lines are not drawn");
                    continue;
                }
                Err(reason) => {
                    self.bad(builder, id, place, reason);
                    continue;
                }
            };
            if json.targets.as_ref().is_some_and(|t| !t.is_empty()) {
                self.unsupported(builder, id, "morph targets are not drawn; the mesh has its base shape");
            }
            let copies = instances.as_ref().map_or(1, node::Instances::count);
            if primitive.corner_count() == 0 {
                continue;
            }
            match self.corners.checked_sub(primitive.cost(copies)) {
                Some(left) => self.corners = left,
                None => {
                    let reason = format!(
                        "{copies} × {} corners are more than this file may unfold to",
                        primitive.corner_count()
                    );
                    self.bad(builder, id, place, reason);
                    continue;
                }
            }
            for copy in 0..copies {
                let local = instances.as_ref().map_or(DAffine3::IDENTITY, |i| i.get(copy));
                let placed = Placed::new(visit.world_from_node * local);
                gathered.add(builder, &mut self.materials, from, &primitive, placed);
            }
        }
        self.triangles += gathered.finish(builder);
    }

    /// `id`, or `id#2`, ... where it is taken: parents are named by id, and here a name is no promise of one.
    fn unique(&mut self, builder: &mut ModelBuilder, id: String) -> String {
        let mut candidate = id.clone();
        while self.ids.contains_key(&candidate) {
            let uses = self.ids.entry(id.clone()).or_insert(1);
            *uses += 1;
            candidate = format!("{id}#{uses}");
        }
        if candidate != id {
            let file = self.from.around.path.display();
            builder.model.warnings.add(WarningCode::DuplicateId, &candidate, || {
                format!("{file}: several mesh nodes are named {id:?}; later ones get #2, #3, ...")
            });
        }
        self.ids.insert(candidate.clone(), 1);
        candidate
    }

    fn unsupported(&self, builder: &mut ModelBuilder, id: &str, what: &str) {
        let file = self.from.around.path.display();
        builder.model.warnings.add(WarningCode::Unsupported, id, || format!("{file}, {id}: {what}"));
    }

    fn bad(&mut self, builder: &mut ModelBuilder, id: &str, place: String, reason: String) {
        let file = self.from.around.path.display();
        builder.model.warnings.add(WarningCode::BadGeometry, id, || format!("{file}, {place}: {reason}"));
        self.trouble.get_or_insert((place, reason));
    }
}

/// (x, y, z) → (x, −z, y).
fn z_up() -> DAffine3 {
    DAffine3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y, DVec3::ZERO)
}

/// Where the whole model stands: `CESIUM_RTC`, a translation in the z-up frame (as CesiumJS applies it).
fn world_from_scene(document: &Document) -> DAffine3 {
    let rtc = document.extensions.get("CESIUM_RTC");
    let center: Option<[f64; 3]> = rtc.and_then(|r| serde_json::from_value(r.get("center")?.clone()).ok());
    DAffine3::from_translation(center.unwrap_or_default().into()) * z_up()
}
