//! Packed staging of a document's geometries between reading and assembly: one list of numbers.
//!
//! The meaning of a geometry is known only when the document is complete: vertices and appearance mostly come last. Until
//! then a dozen lists for each of a hundred thousand geometries would cost several times what is in them.

use crate::city::{
    cityjson::{
        geometry::{GeometryKind, GeometryRead, MaterialUse, Semantic},
        nested::{Token, Values},
    },
    memory::give_back,
    model::{Attribute, Lod, StringId},
};

/// Geometries, taken out in the order in which they were put in.
#[derive(Clone, Debug, Default)]
pub struct PackedGeometries {
    words: Vec<u32>,
    attributes: Vec<Attribute>,
    themes: Vec<String>,
    /// Instances, and what does not have the shape of its type.
    odd: Vec<GeometryRead>,
}

/// First word of a geometry that stands in [`PackedGeometries::odd`].
const ODD: u32 = u32::MAX;
/// Tokens that are no index. No list of a 4 GiB file is that long, so indices from [`FIRST_TOKEN`] on are all alike.
const NULL: u32 = u32::MAX - 1;
const OPEN: u32 = u32::MAX - 2;
const CLOSE: u32 = u32::MAX - 3;
const FIRST_TOKEN: u32 = CLOSE;
/// In place of [`Lod::tenths`].
const NO_LOD: u32 = 256;

const KINDS: [GeometryKind; 5] = [
    GeometryKind::MultiSurface,
    GeometryKind::CompositeSurface,
    GeometryKind::Solid,
    GeometryKind::MultiSolid,
    GeometryKind::CompositeSolid,
];

impl PackedGeometries {
    /// Appends a geometry.
    pub fn put(&mut self, geometry: &GeometryRead) {
        let Some((kind, depth)) = plain(geometry) else {
            self.words.push(ODD);
            return self.odd.push(geometry.clone());
        };
        self.words.extend([kind, geometry.lod.map_or(NO_LOD, |lod| u32::from(lod.tenths))]);
        self.put_list(&geometry.boundaries.indices);
        self.words.push(geometry.boundaries.leaf_depth.is_some().into());
        for ends in &geometry.boundaries.ends[..=depth] {
            self.put_list(ends);
        }
        self.words.push(geometry.semantics.len() as u32);
        for semantic in &geometry.semantics {
            let parent = semantic.parent.unwrap_or(0);
            self.words.extend([semantic.kind.0, semantic.parent.is_some().into(), parent]);
            self.put_list(&semantic.children);
            self.words.push(semantic.attributes.len() as u32);
            self.attributes.extend_from_slice(&semantic.attributes);
        }
        self.words.push(geometry.semantic_values.is_some().into());
        geometry.semantic_values.iter().for_each(|values| self.put_values(values));
        self.words.push(geometry.materials.len() as u32);
        for (theme, used) in &geometry.materials {
            self.put_theme(theme);
            match used {
                MaterialUse::All(index) => self.words.extend([1, *index]),
                MaterialUse::Each(values) => {
                    self.words.push(0);
                    self.put_values(values);
                }
            }
        }
        self.words.push(geometry.textures.len() as u32);
        for (theme, values) in &geometry.textures {
            self.put_theme(theme);
            self.put_values(values);
        }
    }

    fn put_list(&mut self, list: &[u32]) {
        self.words.push(list.len() as u32);
        self.words.extend_from_slice(list);
    }

    fn put_values(&mut self, values: &Values) {
        self.words.extend([values.is_malformed.into(), values.tokens.len() as u32]);
        self.words.extend(values.tokens.iter().map(|token| match *token {
            Token::Open => OPEN,
            Token::Close => CLOSE,
            Token::Null => NULL,
            Token::Index(index) if index >= FIRST_TOKEN => u32::MAX,
            Token::Index(index) => index,
        }));
    }

    fn put_theme(&mut self, theme: &str) {
        let known = self.themes.iter().position(|t| t == theme).unwrap_or_else(|| {
            self.themes.push(theme.to_owned());
            self.themes.len() - 1
        });
        self.words.push(known as u32);
    }

    /// The instances in it.
    pub fn instances(&self) -> impl Iterator<Item = &GeometryRead> {
        self.odd.iter().filter(|geometry| geometry.kind == GeometryKind::Instance)
    }

    /// Starts taking out.
    pub fn into_reader(self) -> Reader {
        let Self { words, attributes, themes, odd } = self;
        Reader { words, at: 0, attributes: attributes.into_iter(), themes, odd: odd.into_iter() }
    }
}

/// Kind (as an index of [`KINDS`]) and ring depth of a geometry whose boundaries have the shape of its type.
fn plain(geometry: &GeometryRead) -> Option<(u32, usize)> {
    let kind = KINDS.iter().position(|kind| *kind == geometry.kind)?;
    let depth = geometry.kind.ring_depth()?;
    let is_bare = geometry.template.is_none() && geometry.matrix.is_none();
    let is_shallow = geometry.boundaries.ends[depth + 1..].iter().all(Vec::is_empty);
    (is_bare && is_shallow && geometry.boundaries.rings(depth).is_some()).then_some((kind as u32, depth))
}

/// Takes geometries out of a [`PackedGeometries`].
#[derive(Debug)]
pub struct Reader {
    words: Vec<u32>,
    at: usize,
    attributes: std::vec::IntoIter<Attribute>,
    themes: Vec<String>,
    odd: std::vec::IntoIter<GeometryRead>,
}

impl Drop for Reader {
    fn drop(&mut self) {
        give_back(std::mem::take(&mut self.words));
    }
}

impl Reader {
    /// The next geometry, in place of what `into` held; `None` at the end.
    pub fn next_into(&mut self, into: &mut GeometryRead) -> Option<()> {
        let first = *self.words.get(self.at)?;
        self.at += 1;
        if first == ODD {
            *into = self.odd.next()?;
            return Some(());
        }
        into.clear();
        into.kind = *KINDS.get(first as usize)?;
        into.lod = u8::try_from(self.word()).ok().map(|tenths| Lod { tenths });
        let depth = into.kind.ring_depth()?;
        self.list(&mut into.boundaries.indices);
        into.boundaries.leaf_depth = (self.word() != 0).then_some(depth);
        for ends in &mut into.boundaries.ends[..=depth] {
            self.list(ends);
        }
        for _ in 0..self.word() {
            let kind = StringId(self.word());
            let (has_parent, parent) = (self.word() != 0, self.word());
            let mut children = Vec::new();
            self.list(&mut children);
            let count = self.word() as usize;
            let attributes = self.attributes.by_ref().take(count).collect();
            into.semantics.push(Semantic { kind, attributes, parent: has_parent.then_some(parent), children });
        }
        if self.word() != 0 {
            into.semantic_values = Some(self.values());
        }
        for _ in 0..self.word() {
            let theme = self.theme();
            let used = if self.word() != 0 { MaterialUse::All(self.word()) } else { MaterialUse::Each(self.values()) };
            into.materials.push((theme, used));
        }
        for _ in 0..self.word() {
            let theme = self.theme();
            into.textures.push((theme, self.values()));
        }
        Some(())
    }

    fn word(&mut self) -> u32 {
        self.at += 1;
        self.words.get(self.at - 1).copied().unwrap_or(0)
    }

    fn slice(&mut self) -> &[u32] {
        let count = self.word() as usize;
        let start = self.at;
        self.at += count;
        self.words.get(start..self.at).unwrap_or_default()
    }

    fn list(&mut self, into: &mut Vec<u32>) {
        into.clear();
        into.extend_from_slice(self.slice());
    }

    fn values(&mut self) -> Values {
        let is_malformed = self.word() != 0;
        let tokens = self.slice().iter().map(|word| match *word {
            OPEN => Token::Open,
            CLOSE => Token::Close,
            NULL => Token::Null,
            index => Token::Index(index),
        });
        Values { tokens: tokens.collect(), is_malformed }
    }

    fn theme(&mut self) -> String {
        let index = self.word() as usize;
        self.themes.get(index).cloned().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{build::ModelBuilder, json::Json};

    const GEOMETRIES: [&str; 8] = [
        r#"{"type":"MultiSurface","lod":"2.2","boundaries":[[[0,1,2],[3,4,5]],[[6,7,8]]]}"#,
        r#"{"type":"Solid","lod":1,"boundaries":[[[[0,1,2]],[[3,4,5]]],[]],"semantics":{"surfaces":[
            {"type":"RoofSurface","slope":3.5,"children":[1,2],"name":"a"},{"type":"Window","parent":0},{}],"values":[[0,null],null]}}"#,
        r#"{"type":"CompositeSolid","boundaries":[[[[[0,1,2]]]]],"material":{"x":{"value":3},"y":{"values":[[[4294967295]]]}},
            "texture":{"x":{"values":[[[[[0,10,11,12]]]]]},"y":{"values":"bad"}}}"#,
        r#"{"type":"GeometryInstance","template":1,"boundaries":[7],"transformationMatrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}"#,
        r#"{"type":"Solid","lod":"1","boundaries":[[0,1]]}"#,
        r#"{"type":"MultiSurface","boundaries":[[[]],[[]]]}"#,
        r#"{"type":"Blob","lod":"3","boundaries":[1,[2]]}"#,
        r#"{"type":"MultiPoint","lod":"3","boundaries":[1,2]}"#,
    ];

    #[test]
    fn geometries_come_out_as_they_went_in() {
        let mut builder = ModelBuilder::default();
        let mut read = |text: &str| GeometryRead::read(&mut Json::new(text.as_bytes()), &mut builder, "a").unwrap();
        let geometries: Vec<_> = GEOMETRIES.iter().map(|text| read(text)).collect();
        let mut packed = PackedGeometries::default();
        // Twice, so that each follows another one in the same buffer.
        let order = || geometries.iter().chain(geometries.iter().rev());
        order().for_each(|geometry| packed.put(geometry));
        assert_eq!(packed.instances().count(), 2);
        assert_eq!(packed.odd.len(), 2 * 4, "only odd ones are kept whole");
        let mut reader = packed.into_reader();
        let mut out = GeometryRead::default();
        for geometry in order() {
            reader.next_into(&mut out).unwrap();
            let mut expected = geometry.clone();
            // The name of a known type is not needed any more.
            if out.kind_name.is_empty() {
                expected.kind_name.clear();
            }
            assert_eq!(format!("{out:?}"), format!("{expected:?}"));
        }
        assert!(reader.next_into(&mut out).is_none());
    }
}
