//! One geometry object as it stands in the file, before vertices and appearance are known.

use std::borrow::Cow;

use crate::city::{
    build::ModelBuilder,
    cityjson::{
        attributes,
        nested::{Boundaries, Values},
    },
    json::{Json, Kind, Number, Step},
    model::{Attribute, Lod, StringId},
};

/// The geometry types of CityJSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GeometryKind {
    /// Points; not drawn.
    MultiPoint,
    /// Lines; not drawn.
    MultiLineString,
    /// Surfaces that may be anywhere.
    MultiSurface,
    /// Surfaces that join.
    CompositeSurface,
    /// An outer shell and holes in it.
    Solid,
    /// Solids that may be anywhere.
    MultiSolid,
    /// Solids that join.
    CompositeSolid,
    /// A template, placed.
    Instance,
    /// None of these.
    #[default]
    Unknown,
}

impl GeometryKind {
    fn parse(name: &str) -> Self {
        match name {
            "MultiPoint" => Self::MultiPoint,
            "MultiLineString" => Self::MultiLineString,
            "MultiSurface" => Self::MultiSurface,
            "CompositeSurface" => Self::CompositeSurface,
            "Solid" => Self::Solid,
            "MultiSolid" => Self::MultiSolid,
            "CompositeSolid" => Self::CompositeSolid,
            "GeometryInstance" => Self::Instance,
            _ => Self::Unknown,
        }
    }

    /// The depth of the rings of polygons in `boundaries`; `None` where there are no polygons.
    pub fn ring_depth(self) -> Option<usize> {
        match self {
            Self::MultiSurface | Self::CompositeSurface => Some(2),
            Self::Solid => Some(3),
            Self::MultiSolid | Self::CompositeSolid => Some(4),
            Self::MultiPoint | Self::MultiLineString | Self::Instance | Self::Unknown => None,
        }
    }

    /// Whether it is made of closed shells.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Solid | Self::MultiSolid | Self::CompositeSolid)
    }
}

/// Materials of a geometry in one theme.
#[derive(Clone, Debug)]
pub enum MaterialUse {
    /// One for all polygons.
    All(u32),
    /// One for each.
    Each(Values),
}

/// A semantic surface of the file.
#[derive(Clone, Debug)]
pub struct Semantic {
    /// Its type.
    pub kind: StringId,
    /// Its attributes: all beyond type and links.
    pub attributes: Vec<Attribute>,
    /// Its parent, an index into the same list.
    pub parent: Option<u32>,
    /// Its children, indices into the same list.
    pub children: Vec<u32>,
}

/// A geometry as read.
#[derive(Clone, Debug, Default)]
pub struct GeometryRead {
    /// Its type.
    pub kind: GeometryKind,
    /// The type's name where it is unknown.
    pub kind_name: String,
    /// Its level of detail, if given and well formed.
    pub lod: Option<Lod>,
    /// Its arrays of indices.
    pub boundaries: Boundaries,
    /// Semantic surfaces.
    pub semantics: Vec<Semantic>,
    /// Which polygon is of which semantic surface.
    pub semantic_values: Option<Values>,
    /// Materials by theme.
    pub materials: Vec<(String, MaterialUse)>,
    /// Textures by theme.
    pub textures: Vec<(String, Values)>,
    /// Index of the template, of an instance.
    pub template: Option<u32>,
    /// Row-major matrix, of an instance.
    pub matrix: Option<[f64; 16]>,
}

impl GeometryRead {
    /// Reads one.
    pub fn read(json: &mut Json<'_>, builder: &mut ModelBuilder, object: &str) -> Step<Self> {
        let mut this = Self::default();
        this.read_again(json, builder, object)?;
        Ok(this)
    }

    /// Nothing, but the memory is kept.
    pub fn clear(&mut self) {
        let Self { kind_name, boundaries, semantics, .. } = std::mem::take(self);
        *self = Self { kind_name, boundaries, semantics, ..Self::default() };
        self.kind_name.clear();
        self.boundaries.clear();
        self.semantics.clear();
    }

    /// Reads one in place of another. The builder gets what is not read.
    pub fn read_again(&mut self, json: &mut Json<'_>, builder: &mut ModelBuilder, object: &str) -> Step<()> {
        self.clear();
        if json.peek()? != Kind::Object {
            return json.skip();
        }
        let this = self;
        json.object(|json, key| {
            match &*key {
                "type" => {
                    let name = text(json)?;
                    this.kind = GeometryKind::parse(&name);
                    this.kind_name.clear();
                    this.kind_name.push_str(&name);
                }
                "lod" => this.lod = lod(json)?,
                "boundaries" => this.boundaries.read_again(json)?,
                "semantics" => this.read_semantics(json, builder, object)?,
                "material" => each_theme(json, |json, theme| {
                    if let Some(used) = material_use(json)? {
                        this.materials.push((theme, used));
                    }
                    Ok(())
                })?,
                "texture" => each_theme(json, |json, theme| {
                    each_member(json, |json, key| match key {
                        "values" => {
                            this.textures.push((theme.clone(), Values::read(json)?));
                            Ok(())
                        }
                        _ => json.skip(),
                    })
                })?,
                "template" => this.template = Some(index(json)?),
                "transformationMatrix" => this.matrix = matrix(json)?,
                other => {
                    let place = format!("CityObjects/{object}/geometry/{other}");
                    attributes::keep_unknown(json, builder, place)?;
                }
            }
            Ok(())
        })
    }

    fn read_semantics(&mut self, json: &mut Json<'_>, builder: &mut ModelBuilder, object: &str) -> Step<()> {
        each_member(json, |json, key| match key {
            "surfaces" if json.peek()? == Kind::Array => json.array(|json| {
                self.semantics.push(semantic(json, builder, object)?);
                Ok(())
            }),
            "values" => {
                self.semantic_values = Some(Values::read(json)?);
                Ok(())
            }
            _ => json.skip(),
        })
    }
}

/// Reads one entry of `semantics.surfaces`.
fn semantic(json: &mut Json<'_>, builder: &mut ModelBuilder, object: &str) -> Step<Semantic> {
    let mut this = Semantic { kind: StringId(u32::MAX), attributes: Vec::new(), parent: None, children: Vec::new() };
    each_member(json, |json, key| {
        match key {
            "type" => {
                let name = text(json)?;
                this.kind = builder.intern(&name);
            }
            "parent" => this.parent = Some(index(json)?),
            "children" if json.peek()? == Kind::Array => json.array(|json| {
                this.children.push(index(json)?);
                Ok(())
            })?,
            name => {
                let name = builder.intern(name);
                let value = attributes::value(json, builder, object)?;
                this.attributes.push(Attribute { name, value });
            }
        }
        Ok(())
    })?;
    Ok(this)
}

fn material_use(json: &mut Json<'_>) -> Step<Option<MaterialUse>> {
    let mut used = None;
    each_member(json, |json, key| {
        match key {
            "value" if json.peek()? == Kind::Number => used = Some(MaterialUse::All(index(json)?)),
            "values" => used = Some(MaterialUse::Each(Values::read(json)?)),
            _ => json.skip()?,
        }
        Ok(())
    })?;
    Ok(used)
}

/// Members of an object; anything else is skipped.
pub fn each_member<'a>(json: &mut Json<'a>, mut member: impl FnMut(&mut Json<'a>, &str) -> Step<()>) -> Step<()> {
    match json.peek()? {
        Kind::Object => json.object(|json, key| member(json, &key)),
        _ => json.skip(),
    }
}

fn each_theme<'a>(json: &mut Json<'a>, mut theme: impl FnMut(&mut Json<'a>, String) -> Step<()>) -> Step<()> {
    each_member(json, |json, key| theme(json, key.to_owned()))
}

/// A string; anything else counts as empty.
pub fn text<'a>(json: &mut Json<'a>) -> Step<Cow<'a, str>> {
    if json.peek()? == Kind::String {
        return json.string();
    }
    json.skip()?;
    Ok(Cow::Borrowed(""))
}

/// An index; anything else is one that no list has.
fn index(json: &mut Json<'_>) -> Step<u32> {
    if json.peek()? != Kind::Number {
        json.skip()?;
        return Ok(u32::MAX);
    }
    Ok(match json.number()? {
        Number::Integer(i) => u32::try_from(i).unwrap_or(u32::MAX),
        Number::Real(_) => u32::MAX,
    })
}

/// `"2.2"` (1.1, 2.0) or `2.2` (1.0).
fn lod(json: &mut Json<'_>) -> Step<Option<Lod>> {
    Ok(match json.peek()? {
        Kind::String => Lod::parse(&json.string()?),
        Kind::Number => Lod::parse(std::str::from_utf8(json.raw()?).unwrap_or_default()),
        _ => {
            json.skip()?;
            None
        }
    })
}

/// Sixteen finite numbers, or nothing.
fn matrix(json: &mut Json<'_>) -> Step<Option<[f64; 16]>> {
    Ok(attributes::numbers(json)?.try_into().ok().filter(|m: &[f64; 16]| m.iter().all(|x| x.is_finite())))
}
