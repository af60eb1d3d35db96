//! The city model: plain data, ready to be drawn, measured and asked.
//!
//! ```text
//! object ──< geometry (one per LoD) ──< tile (own integer origin) ──< triangles
//!    │                                                                  │ each vertex names a
//!    └──< attributes                                  surface (object, semantics, material)
//! ```
//!
//! World: x east, y north, z up, metres. A vertex is `tile.origin` (whole metres, exact) + an f32
//! offset; the origin depends on the object alone, so the same object from two files gives the same
//! floats (architecture, decision 1).

use std::{
    hash::BuildHasher,
    ops::Range,
    path::PathBuf,
    sync::{Arc, OnceLock},
};

use glam::{DVec3, IVec3};
use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::{
    city::{
        crs::Frames,
        history::History,
        kept_measures::Measured,
        side_table::JoinFacts,
        strings::Strings,
        timetable::{Keyframes, TimetableFacts},
        warning::Warnings,
    },
    geom::{Aabb, plane::Plane},
};

/// Where objects stand by the hash of their id: made when first asked for, and taken for no more than a hint, since objects may be
/// added or taken away.
#[derive(Debug, Default)]
pub struct Ids(OnceLock<FxHashMap<u64, u32>>);

impl Clone for Ids {
    /// That of another model, which may change: made anew.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Ids {
    fn hash(id: &str) -> u64 {
        FxBuildHasher.hash_one(id)
    }

    /// Where an object of this id may stand.
    fn hint(&self, objects: &[CityObject], id: &str) -> Option<u32> {
        let map = self.0.get_or_init(|| {
            // Of equal hashes the first.
            objects.iter().enumerate().rev().map(|(i, object)| (Self::hash(&object.id), i as u32)).collect()
        });
        map.get(&Self::hash(id)).copied()
    }
}

/// Index into [`CityModel::strings`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StringId(pub u32);

/// What objects of files are called that do not say what their objects are: groups of OBJ, meshes of glTF.
pub const GROUP: &str = "Group";
/// See [`GROUP`].
pub const MESH: &str = "Mesh";

/// No surface, material, texture, parent, ...
pub const NONE: u32 = u32::MAX;

/// How colours of materials are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Materials {
    /// As files have them.
    #[default]
    File,
    /// Tamed: what is vivid is quieter, and never dark.
    Tamed,
}

impl Materials {
    /// The words of scene files.
    pub const WORDS: [(&'static str, Self); 2] = [("tamed", Self::Tamed), ("file", Self::File)];
}

/// A whole city: everything that was read from all files, in reading order.
#[derive(Clone, Debug, Default)]
pub struct CityModel {
    /// The files, in the order given.
    pub sources: Vec<Source>,
    /// Files that were read because those name them: buffers, libraries of materials.
    pub read_beside: Vec<PathBuf>,
    /// Canonical name of the reference system (`EPSG:7415`, `EPSG:25832+5783`), if understood.
    pub crs: Option<String>,
    /// The reference system as the file spells it.
    pub crs_raw: Option<String>,
    /// The metric frames that degrees and earth-centred coordinates were put in.
    pub frames: Frames,
    /// Every distinct string once: types, attribute names, attribute texts.
    pub strings: Strings,
    /// City objects in byte order of the files; the position is the object index of the contract.
    pub objects: Vec<CityObject>,
    /// Finds them by their ids.
    pub ids: Ids,
    /// What was measured of its geometry so far.
    pub measured: Measured,
    /// Attributes of objects and semantic surfaces; ranges of it belong to them.
    pub attributes: Vec<Attribute>,
    /// Geometries, grouped by object in object order, LoD ascending as read.
    pub geometries: Vec<Geometry>,
    /// The steps of the grids that vertices stand on, metres along each axis; [`Geometry::grid`] is an index into it.
    pub steps: Vec<DVec3>,
    /// The surfaces that triangles are part of: an object's semantic surface in one material.
    pub surfaces: Vec<Surface>,
    /// Semantic surfaces that carry attributes or links of their own.
    pub details: Vec<SurfaceDetail>,
    /// Materials, from all files.
    pub materials: Vec<Material>,
    /// How their colours are shown.
    pub shown_materials: Materials,
    /// Textures, from all files.
    pub textures: Vec<Texture>,
    /// Tiles, grouped by geometry.
    pub tiles: Vec<Tile>,
    /// Vertices, grouped by tile.
    pub vertices: Vec<Vertex>,
    /// Texture coordinates, v down (row 0 of the image at 0), or empty when no tile has any;
    /// ranges of it belong to tiles ([`Tile::texcoords`]).
    pub texcoords: Vec<[f32; 2]>,
    /// Three per triangle, counter-clockwise from outside, relative to the tile's first vertex.
    pub indices: Vec<u32>,
    /// One per triangle: 0, or a number shared by all triangles of exactly one plane (two polygons at least).
    pub planes: Vec<u32>,
    /// The planes that `planes` numbers: number k stands at k - 1.
    pub plane_equations: Vec<Plane>,
    /// Triangles of polygons that lie in several tiles (few do): [`crate::city::edges`] must not take the cuts for edges.
    /// Ascending by triangle.
    pub cut_polygons: Vec<CutTriangle>,
    /// Box around the vertices that any geometry as read uses (dropped faces, points and lines too), metres:
    /// grown by [`crate::city::build::ModelBuilder::add_geometry`], and by loaders for points and lines.
    pub extent_as_read: Aabb,
    /// Faces that loaders could not even hand over, each with a warning; [`Geometry::dropped`] counts the others.
    pub faces_dropped: u64,
    /// The side tables whose attributes its objects have.
    pub joins: Vec<JoinFacts>,
    /// Attributes that change over time, by name; objects have the last of their values as plain ones.
    pub histories: FxHashMap<StringId, History>,
    /// Attributes that say what became of objects, and nothing of what they are.
    pub changes: Vec<StringId>,
    /// The objects that move, ascending.
    pub moves: Vec<Keyframes>,
    /// The timetables by which they do.
    pub timetables: Vec<TimetableFacts>,
    /// Members of the file that are not read, kept as JSON: (where, text).
    pub unknown: Vec<(String, String)>,
    /// The faults that were lived with.
    pub warnings: Warnings,
}

/// One file that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Path as given.
    pub path: PathBuf,
    /// `CityJSON`, `CityJSONSeq`, `glTF`, `OBJ`.
    pub format: &'static str,
    /// The format's version as the file states it, `2.0`; empty where it has none.
    pub version: String,
}

/// A city object: a building, a part of one, a road, a tree, a patch of terrain, ...
#[derive(Clone, Debug, PartialEq)]
pub struct CityObject {
    /// Id, unique in the city (a repeated one got `#2`, ...).
    pub id: Box<str>,
    /// Type as the file names it: `Building`, `+NoiseBarrier`, ...
    pub kind: StringId,
    /// Its class.
    pub class: ObjectClass,
    /// Parents, object indices.
    pub parents: Vec<u32>,
    /// Children, object indices.
    pub children: Vec<u32>,
    /// Its attributes, in [`CityModel::attributes`].
    pub attributes: Range<u32>,
    /// Its geometries, in [`CityModel::geometries`].
    pub geometries: Range<u32>,
}

/// The class of a city object, across formats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ObjectClass {
    /// Buildings, their parts, installations, rooms.
    #[default]
    Building,
    /// Relief.
    Terrain,
    /// Water bodies.
    Water,
    /// Roads, squares, railways, waterways.
    Road,
    /// Plants and plant cover.
    Vegetation,
    /// Land use.
    Land,
    /// Bridges, tunnels and other constructions.
    Construction,
    /// Furniture, groups, generics, extensions.
    Other,
}

impl ObjectClass {
    /// Whether buildings stand on it: such objects are never occluders and need no plain ground.
    pub fn is_ground(self) -> bool {
        matches!(self, Self::Terrain | Self::Water | Self::Road | Self::Land)
    }
}

/// One attribute of an object or a semantic surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attribute {
    /// Its name.
    pub name: StringId,
    /// Its value.
    pub value: Value,
}

/// An attribute's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Given, but null.
    Null,
    /// True or false.
    Boolean(bool),
    /// A whole number that fits 64 bits.
    Integer(i64),
    /// Any other finite number.
    Number(f64),
    /// Text.
    String(StringId),
    /// A list, kept as its JSON text.
    Array(StringId),
    /// A table, kept as its JSON text.
    Object(StringId),
}

/// A level of detail as a canonical string: `2` for 2.0, `1.3`. Ordered by number, then by text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Lod {
    /// `10 × major + minor`; 255 for none (glTF, OBJ).
    pub tenths: u8,
}

impl Lod {
    /// The geometry of formats that have no levels of detail.
    pub const NONE: Self = Self { tenths: u8::MAX };

    /// Reads `2`, `2.0`, `1.3`; `None` for what is no level between 0 and 9.9.
    pub fn parse(text: &str) -> Option<Self> {
        let (major, minor) = text.trim().split_once('.').unwrap_or((text.trim(), "0"));
        let digit = |s: &str| -> Option<u8> {
            let s = if s.len() > 1 { s.trim_end_matches('0') } else { s };
            match s.as_bytes() {
                [] => Some(0),
                [d] if d.is_ascii_digit() => Some(d - b'0'),
                _ => None,
            }
        };
        match major.as_bytes() {
            [d] if d.is_ascii_digit() => Some(Self { tenths: (d - b'0') * 10 + digit(minor)? }),
            _ => None,
        }
    }
}

impl PartialOrd for Lod {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Lod {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.tenths.cmp(&other.tenths)
    }
}

impl std::fmt::Display for Lod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.tenths / 10, self.tenths % 10) {
            _ if *self == Self::NONE => write!(f, "none"),
            (major, 0) => write!(f, "{major}"),
            (major, minor) => write!(f, "{major}.{minor}"),
        }
    }
}

/// One geometry of one object, triangulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The object it belongs to.
    pub object: u32,
    /// Its level of detail.
    pub lod: Lod,
    /// Whether it is made of closed shells (Solid, MultiSolid, CompositeSolid).
    pub solid: bool,
    /// Polygons as read, before de-duplication and refusal.
    pub polygons: u32,
    /// Triangles as drawn.
    pub triangles: u32,
    /// Polygons that were refused (each with a warning); repeated ones are not among them.
    pub dropped: u32,
    /// The grid that its vertices stand on, in [`CityModel::steps`].
    pub grid: u32,
    /// Its tiles, in [`CityModel::tiles`].
    pub tiles: Range<u32>,
    /// Box around all vertices its polygons name (bad coordinates left out), metres.
    pub bounds: Aabb,
}

/// Part of a geometry that shares one origin; at most 64 m on a side.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Whole metres; vertices are relative to it.
    pub origin: IVec3,
    /// The geometry it is part of.
    pub geometry: u32,
    /// Its vertices.
    pub vertices: Range<u32>,
    /// Its indices, three per triangle; `planes` holds one entry per three of them.
    pub indices: Range<u32>,
    /// First texture coordinate (one per vertex), or [`NONE`].
    pub texcoords: u32,
    /// Box around its vertices, metres.
    pub bounds: Aabb,
}

/// A triangle whose polygon has triangles in other tiles too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutTriangle {
    /// Index into [`CityModel::planes`].
    pub triangle: u32,
    /// The same number for all triangles of the polygon; unique within its geometry.
    pub polygon: u32,
}

/// A vertex as the GPU reads it: 20 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Metres from the tile's origin.
    pub position: [f32; 3],
    /// Unit normal, octahedral, 2 × snorm16 ([`encode_normal`]).
    pub normal: u32,
    /// Index into [`CityModel::surfaces`].
    pub surface: u32,
}

/// Packs a unit normal: octahedral map, x in the low half, each snorm16. Error below 6.5e-5 rad.
pub fn encode_normal(n: DVec3) -> u32 {
    let l1 = n.x.abs() + n.y.abs() + n.z.abs();
    let (mut u, mut v) = if l1 > 0.0 { (n.x / l1, n.y / l1) } else { (0.0, 0.0) };
    if n.z < 0.0 {
        let sign = |a: f64| if a < 0.0 { -1.0 } else { 1.0 };
        (u, v) = ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v));
    }
    let snorm = |a: f64| u32::from(((a * 32767.0).round() as i16) as u16);
    snorm(u) | snorm(v) << 16
}

/// The inverse of [`encode_normal`], up to its stated error.
pub fn decode_normal(packed: u32) -> DVec3 {
    let half = |h: u32| f64::from((h & 0xffff) as u16 as i16) / 32767.0;
    let (u, v) = (half(packed), half(packed >> 16));
    let z = 1.0 - u.abs() - v.abs();
    let fold = (-z).max(0.0);
    let toward_zero = |a: f64| if a < 0.0 { a + fold } else { a - fold };
    DVec3::new(toward_zero(u), toward_zero(v), z).normalize_or(DVec3::Z)
}

/// The surface that a triangle is part of. Unique per (object, semantics, material).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Surface {
    /// The object that carries the geometry.
    pub object: u32,
    /// Index into [`CityModel::materials`], or [`NONE`].
    pub material: u32,
    /// Semantic surface type as the file names it (`RoofSurface`), or `StringId(NONE)`.
    pub kind: StringId,
    /// Index into [`CityModel::details`], or [`NONE`].
    pub detail: u32,
}

/// A semantic surface that has more than a type.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceDetail {
    /// Its attributes, in [`CityModel::attributes`].
    pub attributes: Range<u32>,
    /// Its parent surface, index into [`CityModel::details`], or [`NONE`].
    pub parent: u32,
}

/// The look of a surface that is not restyled.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name, may be empty.
    pub name: String,
    /// Linear RGB and opacity, 0..1.
    pub base_color: [f32; 4],
    /// Linear RGB of its own light.
    pub emissive: [f32; 3],
    /// Perceptual roughness, 0 (mirror) .. 1 (chalk).
    pub roughness: f32,
    /// Whether light must not act on it (glTF `KHR_materials_unlit`).
    pub unlit: bool,
    /// What the opacity of texels of its texture does.
    pub texels: TexelOpacity,
    /// Index into [`CityModel::textures`] for the base colour, or [`NONE`].
    pub texture: u32,
    /// That of the picture whose colours `emissive` is multiplied with, or [`NONE`]; at the texture coordinates of `texture`.
    pub emissive_texture: u32,
    /// That of the picture of normals in tangent space (glTF 2.0, section 3.9.3), or [`NONE`]; at the same coordinates.
    pub normal_texture: u32,
    /// What the x and y of these normals are multiplied with.
    pub normal_scale: f32,
}

impl Material {
    /// Its textures, [`NONE`] where it has none.
    pub fn textures(&self) -> [u32; 3] {
        [self.texture, self.emissive_texture, self.normal_texture]
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [0.8, 0.8, 0.8, 1.0],
            emissive: [0.0; 3],
            roughness: 0.9,
            unlit: false,
            texels: TexelOpacity::Ignored,
            texture: NONE,
            emissive_texture: NONE,
            normal_texture: NONE,
            normal_scale: 1.0,
        }
    }
}

/// What the opacity of texels does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TexelOpacity {
    /// Nothing: all are opaque.
    #[default]
    Ignored,
    /// Texels below this opacity are holes, the others opaque.
    Holes(f32),
    /// They let through what is behind.
    Translucent,
}

/// A texture image: where it is and how it continues outside 0..1.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Texture {
    /// Where the pixels are.
    pub image: TextureImage,
    /// The rule outside 0..1.
    pub wrap: [Wrap; 2],
    /// Where the opacity of its texels is.
    pub opacity: TextureOpacity,
}

/// Where the opacity of the texels of a texture is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub enum TextureOpacity {
    /// In the image.
    #[default]
    Own,
    /// In another image, stretched over the first: its opacity, or how light it is where it has none.
    Of(TextureImage),
    /// In the image, read in that way, which has no colours: they are white.
    Alone,
}

/// Where a texture's pixels are. Decoded by [`crate::city::texture`] when needed.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum TextureImage {
    /// A file that exists and stays inside the folders the user named.
    File(PathBuf),
    /// An encoded image inside the model file.
    Bytes(Arc<[u8]>),
    /// Declared but not found, or not readable; the material's colour is used. Why, as long as that has not been told.
    Missing(String),
}

impl TextureImage {
    /// Whether there is none.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Missing(_))
    }
}

/// Texture addressing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Repeats.
    #[default]
    Repeat,
    /// Repeats, every other copy flipped.
    Mirror,
    /// The border texel goes on.
    Clamp,
}

impl CityModel {
    /// World position of a vertex of `tile`, metres; exact (a whole number plus an f32).
    pub fn position(&self, tile: &Tile, vertex: u32) -> DVec3 {
        tile.origin.as_dvec3() + glam::Vec3::from(self.vertices[vertex as usize].position).as_dvec3()
    }

    /// The corners of a triangle of a tile, metres; `triangle` counts from the model's first.
    pub fn corners(&self, tile: &Tile, triangle: u32) -> [DVec3; 3] {
        [0, 1, 2].map(|k| self.position(tile, tile.vertices.start + self.indices[(3 * triangle + k) as usize]))
    }

    /// Box around the vertices used by any geometry, metres; empty for an empty city.
    pub fn extent(&self) -> Aabb {
        self.geometries.iter().fold(Aabb::EMPTY, |all, g| all.union(g.bounds))
    }

    /// The files that it is made of beside those that were given: buffers, libraries of materials, textures.
    pub fn files_beside(&self) -> Vec<PathBuf> {
        let file = |texture: &Texture| match &texture.image {
            TextureImage::File(path) => Some(path.clone()),
            TextureImage::Bytes(_) | TextureImage::Missing(_) => None,
        };
        let tables = self.joins.iter().map(|join| join.file.clone());
        let tables = tables.chain(self.timetables.iter().map(|table| table.file.clone()));
        self.read_beside.iter().cloned().chain(tables).chain(self.textures.iter().filter_map(file)).collect()
    }

    /// Whether its file does not say what it is.
    pub fn is_untyped(&self, object: u32) -> bool {
        [GROUP, MESH].contains(&self.strings.get(self.objects[object as usize].kind))
    }

    /// The top of the object's family: itself, or its first parent's root.
    pub fn root(&self, object: u32) -> u32 {
        let mut at = object;
        while let Some(&parent) = self.objects[at as usize].parents.first() {
            at = parent;
        }
        at
    }

    /// [`CityModel::root`] of every object, in linear time however deep families are.
    pub fn roots(&self) -> Vec<u32> {
        let mut roots = vec![NONE; self.objects.len()];
        let mut path = Vec::new();
        for object in 0..self.objects.len() as u32 {
            let mut at = object;
            while roots[at as usize] == NONE {
                path.push(at);
                match self.objects[at as usize].parents.first() {
                    Some(&parent) => at = parent,
                    None => roots[at as usize] = at,
                }
            }
            let root = roots[at as usize];
            path.drain(..).for_each(|member| roots[member as usize] = root);
        }
        roots
    }

    /// What moves an object, itself or with what it is part of: its place in [`Self::moves`].
    pub fn mover(&self, object: u32) -> Option<usize> {
        let mut at = object;
        // No family is deeper than there are objects.
        for _ in 0..self.objects.len() {
            if let Ok(i) = self.moves.binary_search_by_key(&at, |of| of.object) {
                return Some(i);
            }
            at = *self.objects[at as usize].parents.first()?;
        }
        None
    }

    /// An object's own attributes.
    pub fn attributes_of(&self, object: u32) -> &[Attribute] {
        let range = &self.objects[object as usize].attributes;
        &self.attributes[range.start as usize..range.end as usize]
    }

    /// An attribute of the object, or of the nearest ancestor that has it.
    pub fn attribute(&self, object: u32, name: StringId) -> Option<Value> {
        let mut at = object;
        loop {
            if let Some(found) = self.attributes_of(at).iter().find(|a| a.name == name) {
                return Some(found.value);
            }
            at = *self.objects[at as usize].parents.first()?;
        }
    }

    /// Box around the geometries, of all levels of detail, of an object and of all below it, metres; empty without any.
    pub fn family_bounds(&self, object: u32) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        // Of several parents, and round in a circle, each is counted once.
        let mut known = rustc_hash::FxHashSet::from_iter([object]);
        let mut left = vec![object];
        while let Some(member) = left.pop() {
            let member = &self.objects[member as usize];
            let own = &self.geometries[member.geometries.start as usize..member.geometries.end as usize];
            bounds = own.iter().fold(bounds, |all, geometry| all.union(geometry.bounds));
            left.extend(member.children.iter().copied().filter(|child| known.insert(*child)));
        }
        bounds
    }

    /// The object of this id.
    pub fn find_object(&self, id: &str) -> Option<u32> {
        let is_it = |index: &u32| self.objects.get(*index as usize).is_some_and(|object| &*object.id == id);
        let hint = self.ids.hint(&self.objects, id).filter(is_it);
        hint.or_else(|| self.objects.iter().position(|o| &*o.id == id).map(|i| i as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_are_found_by_their_ids_when_some_come_and_go() {
        let object = |id: &str| CityObject {
            id: id.into(),
            kind: StringId(0),
            class: ObjectClass::default(),
            parents: vec![],
            children: vec![],
            attributes: 0..0,
            geometries: 0..0,
        };
        let mut model = CityModel { objects: ["a", "b", "a"].map(object).to_vec(), ..CityModel::default() };
        let found = |model: &CityModel| ["a", "b", "c", ""].map(|id| model.find_object(id));
        assert_eq!(found(&model), [Some(0), Some(1), None, None]);
        model.objects.push(object("c"));
        assert_eq!(found(&model), [Some(0), Some(1), Some(3), None]);
        model.objects.remove(0);
        assert_eq!(found(&model), [Some(1), Some(0), Some(2), None]);
        assert_eq!(found(&model.clone()), found(&model));
        assert_eq!(found(&CityModel::default()), [None; 4]);
    }

    #[test]
    fn lods_are_canonical_and_ordered() {
        for (text, canonical) in
            [("2", "2"), ("2.0", "2"), ("2.00", "2"), ("1.3", "1.3"), (" 0 ", "0"), ("2.20", "2.2")]
        {
            assert_eq!(Lod::parse(text).unwrap().to_string(), canonical, "{text}");
        }
        for text in ["", "x", "-1", "2.31", "10", "2.x", "."] {
            assert_eq!(Lod::parse(text), None, "{text}");
        }
        assert!(Lod::parse("1.3") < Lod::parse("2"));
    }

    #[test]
    fn normals_survive_packing() {
        for i in 0..2000 {
            let t = f64::from(i);
            let n = DVec3::new((t * 0.37).sin(), (t * 0.73).cos(), (t * 1.31).sin()).normalize_or(DVec3::Z);
            let error = decode_normal(encode_normal(n)).angle_between(n);
            assert!(error < 6.5e-5, "{n} is off by {error}");
        }
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            assert_eq!(decode_normal(encode_normal(axis)), axis);
            assert_eq!(decode_normal(encode_normal(-axis)), -axis);
        }
    }

    #[test]
    fn a_vertex_is_twenty_bytes() {
        assert_eq!(size_of::<Vertex>(), 20);
    }
}
