//! Faces of OBJ: corners `v`, `v/vt`, `v//vn`, `v/vt/vn`, counted from 1 or, if negative, from the newest back.

use rustc_hash::FxHashMap;

use super::{
    Reader, is_usable,
    lines::{text, words},
};
use crate::city::{
    build::{
        ModelBuilder,
        raw::{Polygons, RawObject},
    },
    model::{GROUP, NONE, ObjectClass, StringId, Surface},
    warning::WarningCode,
};

/// The faces of one name.
#[derive(Debug)]
pub(super) struct Group {
    name: String,
    /// The object, once there is a face.
    object: Option<u32>,
    /// By (has texture coordinates, has normals).
    parts: [Polygons; 4],
    /// Surface by material.
    surfaces: FxHashMap<u32, u32>,
}

/// One corner: zero-based indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Corner {
    v: u32,
    vt: Option<u32>,
    vn: Option<u32>,
}

/// A fault of a face.
enum Wrong {
    Word(String),
    Index(String),
}

impl Group {
    pub fn new(name: String) -> Self {
        Self { name, object: None, parts: Default::default(), surfaces: FxHashMap::default() }
    }

    /// The object, added with the first face.
    fn object(&mut self, builder: &mut ModelBuilder, objects: &mut usize) -> u32 {
        *self.object.get_or_insert_with(|| {
            let id = if self.name.is_empty() { format!("group-{objects}") } else { self.name.clone() };
            *objects += 1;
            let kind = GROUP.to_owned();
            builder.add_object(RawObject { id, kind, class: ObjectClass::Building, ..RawObject::default() })
        })
    }

    /// The polygons that were gathered, per kind of data.
    pub fn into_parts(self) -> impl Iterator<Item = (u32, Polygons)> {
        let object = self.object;
        self.parts.into_iter().filter(|p| !p.polygon_ends.is_empty()).filter_map(move |p| Some((object?, p)))
    }
}

impl Reader<'_> {
    /// Adds a face to the current group.
    pub(super) fn face(&mut self, builder: &mut ModelBuilder, line: usize, arguments: &[u8]) {
        let corners: Result<Vec<Corner>, Wrong> =
            words(arguments).map(|word| self.corner(builder, line, word)).collect();
        let name = &self.groups[self.group].name;
        let path = self.path.display();
        let corners = match corners {
            Ok(corners) => corners,
            Err(Wrong::Word(what)) => {
                let what = format!("{what:?} is no corner of a face (v, v/vt, v//vn or v/vt/vn); the face is dropped");
                return self.malformed(builder, line, &what);
            }
            Err(Wrong::Index(what)) => {
                let message = || format!("{path}, line {line}: {what}; the face is dropped");
                return builder.model.warnings.add(WarningCode::VertexIndex, name, message);
            }
        };
        if corners.len() < 3 {
            let count = corners.len();
            return builder.model.warnings.add(WarningCode::ShortRing, name, || {
                format!("{path}, line {line}: a face of {count} corners; it needs three")
            });
        }
        if corners.iter().any(|c| !is_usable(self.points[c.v as usize])) {
            return builder.model.warnings.add(WarningCode::BadCoordinate, name, || {
                format!(
                    "{path}, line {line}: the face uses a position that is not finite or beyond 1e9 m; it is dropped"
                )
            });
        }
        self.add_face(builder, &corners);
    }

    fn add_face(&mut self, builder: &mut ModelBuilder, corners: &[Corner]) {
        let has_texcoords = corners.iter().all(|c| c.vt.is_some());
        let has_normals = corners.iter().all(|c| c.vn.is_some_and(|n| self.normals[n as usize] != [0.0; 3]));
        let look = self.look;
        let material = look.map_or(NONE, |l| if has_texcoords { l.textured } else { l.plain });
        let is_mapped = has_texcoords && look.is_some_and(|l| l.textured != l.plain);
        let group = &mut self.groups[self.group];
        let object = group.object(builder, &mut self.objects);
        let surface = *group
            .surfaces
            .entry(material)
            .or_insert_with(|| builder.add_surface(Surface { object, material, kind: StringId(NONE), detail: NONE }));
        let part = &mut group.parts[usize::from(is_mapped) + 2 * usize::from(has_normals)];
        part.indices.extend(corners.iter().map(|c| c.v));
        part.ring_ends.push(part.indices.len() as u32);
        part.polygon_ends.push(part.ring_ends.len() as u32);
        part.surfaces.push(surface);
        if is_mapped {
            part.texcoords.extend(corners.iter().filter_map(|c| Some(self.texcoords[c.vt? as usize])));
        }
        if has_normals {
            part.normals.extend(corners.iter().filter_map(|c| Some(self.normals[c.vn? as usize])));
        }
    }

    /// Reads one corner; a texture coordinate or normal that does not exist is passed over with a warning.
    fn corner(&self, builder: &mut ModelBuilder, line: usize, word: &[u8]) -> Result<Corner, Wrong> {
        let mut fields = word.split(|b| *b == b'/');
        let wrong = || Wrong::Word(text(word).chars().take(40).collect());
        let mut field = || -> Result<Option<i64>, Wrong> {
            match fields.next() {
                None | Some(b"") => Ok(None),
                Some(digits) => {
                    let digits = std::str::from_utf8(digits).map_err(|_| wrong())?;
                    digits.parse().map(Some).map_err(|_| wrong())
                }
            }
        };
        let (v, vt, vn) = (field()?.ok_or_else(wrong)?, field()?, field()?);
        if fields.next().is_some() {
            return Err(wrong());
        }
        let Some(vertex) = resolve(v, self.points.len()) else {
            let (count, hint) = (self.points.len(), if v == 0 { " (OBJ counts from 1)" } else { "" });
            return Err(Wrong::Index(format!("vertex {v} of {count}{hint}")));
        };
        let mut optional = |what: &str, index: Option<i64>, count: usize| {
            let found = resolve(index?, count);
            if found.is_none() {
                let path = self.path.display();
                builder.model.warnings.add(WarningCode::AppearanceIndex, &self.groups[self.group].name, || {
                    format!("{path}, line {line}: {what} {} of {count}; it is ignored", index.unwrap_or_default())
                });
            }
            found
        };
        let vt = optional("texture coordinate", vt, self.texcoords.len());
        let vn = optional("normal", vn, self.normals.len());
        Ok(Corner { v: vertex, vt, vn })
    }
}

/// Index `i` as OBJ counts, of a list that has `count` so far.
fn resolve(i: i64, count: usize) -> Option<u32> {
    let count = i64::try_from(count).ok()?;
    let index = if i < 0 { count.checked_add(i)? } else { i - 1 };
    (0..count).contains(&index).then(|| u32::try_from(index).ok())?
}
