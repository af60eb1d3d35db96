//! Primitives of one mesh node become polygons: every mode, any index width, placed in f64.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use gltf::json::{
    mesh::{Mode, Primitive as Json, Semantic},
    validation::Checked,
};
use rustc_hash::FxHashMap;

use super::{
    accessor::{self, View},
    buffers::Buffers,
    document::Document,
    material::{self, Key, Mapping, Materials, Palette, UNTINTED},
    node::Visit,
};
use crate::city::{
    build::{
        ModelBuilder,
        lattice::Lattice,
        points::Pool,
        raw::{Polygons, RawGeometry},
    },
    model::{Lod, NONE, StringId, Surface},
    warning::WarningCode,
};

/// Farther than this from the origin, coordinates are wrong.
const MAX_COORDINATE_M: f64 = 1e9;

/// Opening a primitive costs as much time as this many corners, about.
pub(super) const OPENING_CORNERS: u64 = 16;

/// A primitive whose accessors have been checked.
#[derive(Debug)]
pub(super) struct Primitive<'a> {
    positions: View<'a>,
    indices: Option<View<'a>>,
    normals: Option<View<'a>>,
    texcoords: Option<(View<'a>, Mapping)>,
    colors: Option<View<'a>>,
    material: Option<usize>,
    mode: Mode,
}

/// Opens a primitive; `Ok(None)` for points and lines, an error for what is malformed.
pub(super) fn open<'a>(
    document: &Document,
    buffers: &'a Buffers<'_>,
    json: &Json,
) -> Result<Option<Primitive<'a>>, String> {
    let Checked::Valid(mode) = json.mode else { return Err("mode must be 0 to 6".into()) };
    if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        return Ok(None);
    }
    let find = |semantic| {
        let found = json.attributes.get(&Checked::Valid(semantic));
        found.map(|index| accessor::open(document, buffers, index.value())).transpose()
    };
    let positions = find(Semantic::Positions)?.ok_or("has no POSITION")?;
    if positions.dimension != 3 {
        return Err("POSITION must be VEC3".into());
    }
    let indices = json.indices.map(|i| accessor::open(document, buffers, i.value())).transpose()?;
    if indices.as_ref().is_some_and(|i| !i.is_indices()) {
        return Err("indices must be SCALAR, of an unsigned integer type".into());
    }
    let material = json.material.map(|m| m.value());
    let of_each_vertex = |view: Option<View<'a>>, dimension: usize| {
        view.filter(|v| v.dimension >= dimension && v.count >= positions.count)
    };
    let texcoords = match material::mapping(document, material) {
        Some(mapping) => of_each_vertex(find(Semantic::TexCoords(mapping.set))?, 2).map(|view| (view, mapping)),
        None => None,
    };
    let normals = of_each_vertex(find(Semantic::Normals)?, 3);
    let colors = of_each_vertex(find(Semantic::Colors(0))?, 3);
    Ok(Some(Primitive { positions, indices, normals, texcoords, colors, material, mode }))
}

/// Where the first vertex of a mesh node is; `None` where its first primitive has none that can be read.
pub(super) fn first_place(document: &Document, buffers: &Buffers<'_>, visit: &Visit<'_>) -> Option<DVec3> {
    let primitive = document.meshes.get(visit.mesh).ok()?.primitives.first()?;
    let primitive = open(document, buffers, primitive).ok()??;
    let place = (primitive.positions.count > 0).then(|| DVec3::from(primitive.positions.get::<3>(0)))?;
    Some(visit.world_from_node.transform_point3(place))
}

impl Primitive<'_> {
    /// Corners that its triangles have together, before anything is dropped.
    pub fn corner_count(&self) -> u64 {
        self.triangle_count().saturating_mul(3)
    }

    /// The part that it takes of the file's budget: its corners in all copies, and the work of opening them.
    pub fn cost(&self, copies: u64) -> u64 {
        let views = [Some(&self.positions), self.indices.as_ref(), self.normals.as_ref(), self.colors.as_ref()];
        let opening: u64 = views.into_iter().flatten().map(View::opening_cost).sum();
        self.corner_count().saturating_mul(copies).saturating_add(opening)
    }

    fn triangle_count(&self) -> u64 {
        let n = self.indices.as_ref().map_or(self.positions.count, |i| i.count);
        if self.mode == Mode::Triangles { n / 3 } else { n.saturating_sub(2) }
    }

    /// The vertices of triangle `t`, counter-clockwise (glTF 2.0, 3.7.2.1).
    fn triangle(&self, t: u64) -> [u64; 3] {
        let corners = match self.mode {
            Mode::TriangleStrip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Mode::TriangleFan => [t + 1, t + 2, 0],
            _ => [3 * t, 3 * t + 1, 3 * t + 2],
        };
        corners.map(|c| self.indices.as_ref().map_or(c, |i| u64::from(i.index(c))))
    }

    /// The vertex colour of a triangle, and whether its corners agree on it.
    fn color(&self, corners: [u64; 3]) -> ([f64; 4], bool) {
        let Some(view) = &self.colors else { return ([1.0; 4], true) };
        let colors = corners.map(|c| {
            let [r, g, b, a] = view.get(c);
            [r, g, b, if view.dimension == 4 { a } else { 1.0 }]
                .map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) })
        });
        let mean = std::array::from_fn(|c| (colors[0][c] + colors[1][c] + colors[2][c]) / 3.0);
        let agree = (0..4).all(|c| colors.iter().all(|color| (color[c] - colors[0][c]).abs() <= 1.5 / 255.0));
        (mean, agree)
    }
}

/// Where a primitive is put.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// From the mesh's space to the world.
    pub world_from_mesh: DAffine3,
    /// For normals: the inverse transpose, up to a positive factor.
    normals: DMat3,
    /// Whether it mirrors, so that triangles must be turned round.
    mirrors: bool,
}

impl Placed {
    pub fn new(world_from_mesh: DAffine3) -> Self {
        let m = world_from_mesh.matrix3;
        let determinant = m.determinant();
        let cofactors = DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
        let mirrors = determinant < 0.0;
        Self { world_from_mesh, normals: if mirrors { cofactors * -1.0 } else { cofactors }, mirrors }
    }
}

/// Polygons of one object that have the same kinds of data per corner.
#[derive(Debug, Default)]
struct Part {
    points: Vec<[i64; 3]>,
    polygons: Polygons,
}

/// The polygons gathered for one mesh node.
#[derive(Debug)]
pub(super) struct Gathered {
    object: u32,
    id: String,
    /// By (has texture coordinates, has normals).
    parts: [Part; 4],
    surfaces: FxHashMap<u32, u32>,
}

impl Gathered {
    pub fn new(object: u32, id: String) -> Self {
        Self { object, id, parts: Default::default(), surfaces: FxHashMap::default() }
    }

    /// Adds one placed copy of a primitive. The caller has charged its corners to the budget.
    pub fn add(
        &mut self,
        builder: &mut ModelBuilder,
        materials: &mut Materials,
        from: Palette<'_>,
        primitive: &Primitive<'_>,
        placed: Placed,
    ) {
        let mut painter = Painter::new(primitive);
        let slot = usize::from(primitive.texcoords.is_some()) + 2 * usize::from(primitive.normals.is_some());
        let mut points = Points::new(primitive);
        for t in 0..primitive.triangle_count() {
            let mut corners = primitive.triangle(t);
            let [a, b, c] = corners;
            if primitive.mode != Mode::Triangles && (a == b || b == c || c == a) {
                continue; // how strips are stitched together
            }
            if placed.mirrors {
                corners = [a, c, b];
            }
            if let Some(&past) = corners.iter().find(|&&c| c >= primitive.positions.count) {
                builder.model.warnings.add(WarningCode::VertexIndex, &self.id, || {
                    let (file, id, count) = (from.around.path.display(), &self.id, primitive.positions.count);
                    format!("{file}, {id}: triangle {t} names vertex {past} of {count}")
                });
                continue;
            }
            let part = &mut self.parts[slot];
            let placed_corners = corners.map(|c| points.get(part, primitive, &placed, c));
            let [Some(p), Some(q), Some(r)] = placed_corners else {
                builder.model.warnings.add(WarningCode::BadCoordinate, &self.id, || {
                    let (file, id) = (from.around.path.display(), &self.id);
                    format!("{file}, {id}: triangle {t} has a coordinate that is not finite or beyond 1e9 m")
                });
                continue;
            };
            let material = painter.material(builder, materials, from, primitive, corners, &self.id);
            let surface = *self.surfaces.entry(material).or_insert_with(|| {
                builder.add_surface(Surface { object: self.object, material, kind: StringId(NONE), detail: NONE })
            });
            let part = &mut self.parts[slot];
            part.push([p, q, r], surface);
            part.push_details(primitive, &placed, corners, [p, q, r]);
        }
    }

    /// Hands the polygons to the builder; returns how many there were.
    pub fn finish(self, builder: &mut ModelBuilder) -> usize {
        let mut triangles = 0;
        for Part { points, polygons } in self.parts {
            triangles += polygons.polygon_ends.len();
            if !polygons.polygon_ends.is_empty() {
                let pool = Arc::new(Pool { lattice: Lattice::FINE, points: points.into() });
                builder.add_geometry(RawGeometry { object: self.object, lod: Lod::NONE, solid: false, pool, polygons });
            }
        }
        triangles
    }
}

impl Part {
    fn push(&mut self, corners: [u32; 3], surface: u32) {
        let polygons = &mut self.polygons;
        polygons.indices.extend_from_slice(&corners);
        polygons.ring_ends.push(polygons.indices.len() as u32);
        polygons.polygon_ends.push(polygons.ring_ends.len() as u32);
        polygons.surfaces.push(surface);
    }

    /// Texture coordinates and normals of the triangle pushed last.
    fn push_details(&mut self, primitive: &Primitive<'_>, placed: &Placed, corners: [u64; 3], points: [u32; 3]) {
        if let Some((view, mapping)) = &primitive.texcoords {
            self.polygons.texcoords.extend(corners.map(|c| {
                let [u, v] = view.get(c);
                let at = mapping.rows.map(|row| (row[0] * u + row[1] * v + row[2]) as f32);
                if at.iter().all(|c| c.is_finite()) { at } else { [0.0; 2] }
            }));
        }
        if let Some(view) = &primitive.normals {
            let [a, b, c] = points.map(|p| Lattice::FINE.to_world(self.points[p as usize]));
            let flat = (b - a).cross(c - a).normalize_or(DVec3::Z);
            self.polygons.normals.extend(corners.map(|c| {
                // A normal that is not usable gives way to the face's own.
                let normal = (placed.normals * DVec3::from(view.get::<3>(c))).normalize_or(flat);
                normal.as_vec3().to_array()
            }));
        }
    }
}

/// Vertices of a primitive put into a part when first used; big shared buffers of which little is used stay small.
struct Points {
    /// Slot per vertex: 0 unseen, 1 unusable, else the pool index + 2.
    dense: Vec<u32>,
    sparse: FxHashMap<u64, u32>,
}

impl Points {
    fn new(primitive: &Primitive<'_>) -> Self {
        let count = primitive.positions.count;
        let dense = if count <= primitive.corner_count().saturating_mul(4) { count as usize } else { 0 };
        Self { dense: vec![0; dense], sparse: FxHashMap::default() }
    }

    fn get(&mut self, part: &mut Part, primitive: &Primitive<'_>, placed: &Placed, vertex: u64) -> Option<u32> {
        let slot = match self.dense.get_mut(vertex as usize) {
            Some(slot) => slot,
            None => self.sparse.entry(vertex).or_default(),
        };
        if *slot == 0 {
            let world = placed.world_from_mesh.transform_point3(primitive.positions.get::<3>(vertex).into());
            let usable = world.abs().cmple(DVec3::splat(MAX_COORDINATE_M)).all();
            *slot = match Lattice::FINE.nearest(world).filter(|_| usable) {
                Some(point) => {
                    part.points.push(point);
                    part.points.len() as u32 + 1
                }
                None => 1,
            };
        }
        slot.checked_sub(2)
    }
}

/// Chooses the material of each triangle of one primitive.
struct Painter {
    key: Key,
    /// The mean colour of the primitive, once there are too many colours.
    mean: Option<[f64; 4]>,
}

impl Painter {
    fn new(primitive: &Primitive<'_>) -> Self {
        let key = Key { material: primitive.material, textured: primitive.texcoords.is_some(), tint: UNTINTED };
        Self { key, mean: None }
    }

    fn material(
        &mut self,
        builder: &mut ModelBuilder,
        materials: &mut Materials,
        from: Palette<'_>,
        primitive: &Primitive<'_>,
        corners: [u64; 3],
        id: &str,
    ) -> u32 {
        if let Some(Err(what)) = primitive.material.map(|index| from.document.materials.get(index)) {
            builder.model.warnings.add(WarningCode::AppearanceIndex, id, || {
                format!("{}, {id}: {what}; the default is used", from.around.path.display())
            });
            self.key.material = None;
        }
        if primitive.colors.is_some() {
            let (color, agree) = match self.mean {
                Some(mean) => (mean, true),
                None => primitive.color(corners),
            };
            let mut key = Key { tint: material::tint(color), ..self.key };
            if !materials.admits(key) && self.mean.is_none() {
                let mean = mean_color(primitive);
                self.mean = Some(mean);
                key.tint = material::tint(mean);
            }
            if !agree || self.mean.is_some() {
                builder.model.warnings.add(WarningCode::Unsupported, id, || {
                    let file = from.around.path.display();
                    format!("{file}, {id}: vertex colours that run across a face are drawn as their mean")
                });
            }
            self.key.tint = key.tint;
        }
        materials.get(self.key, from, &mut builder.model)
    }
}

/// The mean colour of a primitive's triangles.
fn mean_color(primitive: &Primitive<'_>) -> [f64; 4] {
    let mut sum = [0.0; 4];
    let count = primitive.triangle_count();
    for t in 0..count {
        let (color, _) = primitive.color(primitive.triangle(t));
        for (sum, channel) in sum.iter_mut().zip(color) {
            *sum += channel;
        }
    }
    sum.map(|s| s / count.max(1) as f64)
}
