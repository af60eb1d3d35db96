//! One JSON object of a file, the whole CityJSON or one CityJSONFeature, read once from front to back.

use std::ops::Range;

use glam::DVec3;

use crate::city::{
    build::{ModelBuilder, raw::RawObject},
    cityjson::{
        appearance::{self, Appearance},
        attributes,
        geometry::{GeometryRead, each_member, text},
        kinds,
        packed::PackedGeometries,
        vertices::{Transform, Vertices},
    },
    json::{Json, JsonError, Kind, Step},
    model::{Attribute, Material, Wrap},
    warning::WarningCode,
};

/// A city object and its geometries, as read.
#[derive(Clone, Debug, Default)]
pub struct ObjectRead {
    /// Id, type, links.
    pub raw: RawObject,
    /// Its attributes, in [`Document::attributes`].
    pub attributes: Range<usize>,
    /// The number of its geometries, of those that are packed.
    pub geometries: u32,
}

/// Everything one JSON object holds; members come in any order.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// `type`.
    pub kind: Option<String>,
    /// `version`.
    pub version: Option<String>,
    /// `metadata.referenceSystem`.
    pub crs: Option<String>,
    /// `transform`, where it is usable.
    pub transform: Option<Transform>,
    /// Whether there was a member `CityObjects`.
    pub has_objects: bool,
    /// The city objects that were read completely, in order.
    pub objects: Vec<ObjectRead>,
    /// Attributes of all objects: a list for each would scatter them over the heap.
    pub attributes: Vec<Attribute>,
    /// Geometries of the objects, in order.
    pub geometries: PackedGeometries,
    /// The geometry being read: a buffer.
    geometry: GeometryRead,
    /// `vertices`.
    pub vertices: Vertices,
    /// `appearance`, if there is any.
    pub appearance: Option<Appearance>,
    /// `geometry-templates.templates`.
    pub templates: Vec<GeometryRead>,
    /// `geometry-templates.vertices-templates`, metres.
    pub template_vertices: Vec<DVec3>,
    /// Where and why reading stopped early.
    pub damage: Option<JsonError>,
}

impl Document {
    /// Reads one JSON object; what came before a damage is kept.
    pub fn read(json: &mut Json<'_>, builder: &mut ModelBuilder) -> Self {
        let mut this = Self::default();
        let result = json.object(|json, key| this.read_member(json, builder, &key));
        this.geometry = GeometryRead::default();
        this.damage = result.err();
        this
    }

    fn read_member(&mut self, json: &mut Json<'_>, builder: &mut ModelBuilder, key: &str) -> Step<()> {
        match key {
            "type" => self.kind = Some(text(json)?.into_owned()),
            "version" => self.version = Some(version(json)?),
            "transform" => self.transform = transform(json)?,
            "metadata" => self.read_metadata(json, builder)?,
            "CityObjects" => {
                self.has_objects = true;
                each_member(json, |json, id| self.read_object(json, builder, id))?;
            }
            "vertices" => {
                self.vertices = Vertices::default();
                self.vertices.read(json)?;
            }
            "appearance" => self.appearance = Some(Appearance::read(json)?),
            "geometry-templates" => self.read_templates(json, builder)?,
            "id" => json.skip()?,
            other => attributes::keep_unknown(json, builder, other.to_owned())?,
        }
        Ok(())
    }

    fn read_metadata(&mut self, json: &mut Json<'_>, builder: &mut ModelBuilder) -> Step<()> {
        // Read twice: the reference system for its meaning, the whole to be kept.
        attributes::keep_unknown(&mut json.clone(), builder, "metadata".to_owned())?;
        each_member(json, |json, key| match key {
            "referenceSystem" => {
                self.crs = Some(text(json)?.into_owned()).filter(|c| !c.is_empty());
                Ok(())
            }
            _ => json.skip(),
        })
    }

    fn read_object(&mut self, json: &mut Json<'_>, builder: &mut ModelBuilder, id: &str) -> Step<()> {
        if json.peek()? != Kind::Object {
            builder
                .model
                .warnings
                .add(WarningCode::Malformed, id, || format!("city object {id} is no JSON object; it is skipped"));
            return json.skip();
        }
        let mut object =
            ObjectRead { raw: RawObject { id: id.to_owned(), ..Default::default() }, ..Default::default() };
        json.object(|json, key| {
            match &*key {
                "type" => object.raw.kind = text(json)?.into_owned(),
                "attributes" => {
                    let start = self.attributes.len();
                    attributes::read(json, builder, id, &mut self.attributes)?;
                    object.attributes = start..self.attributes.len();
                }
                "parents" => object.raw.parents = ids(json)?,
                // CityJSON 1.0 calls the children of a group its members.
                "children" | "members" => object.raw.children = ids(json)?,
                "geometry" if json.peek()? == Kind::Array => json.array(|json| {
                    self.geometry.read_again(json, builder, id)?;
                    self.geometries.put(&self.geometry);
                    object.geometries += 1;
                    Ok(())
                })?,
                // Never trusted: the box is taken from the vertices.
                "geometry" | "geographicalExtent" => json.skip()?,
                other => attributes::keep_unknown(json, builder, format!("CityObjects/{id}/{other}"))?,
            }
            Ok(())
        })?;
        object.raw.class = kinds::class(&object.raw.kind);
        if object.raw.kind.is_empty() {
            builder
                .model
                .warnings
                .add(WarningCode::Malformed, id, || format!("city object {id} has no type, such as \"Building\""));
        }
        self.objects.push(object);
        Ok(())
    }

    fn read_templates(&mut self, json: &mut Json<'_>, builder: &mut ModelBuilder) -> Step<()> {
        each_member(json, |json, key| match key {
            "templates" if json.peek()? == Kind::Array => json.array(|json| {
                self.templates.push(GeometryRead::read(json, builder, "geometry-templates")?);
                Ok(())
            }),
            "vertices-templates" if json.peek()? == Kind::Array => json.array(|json| {
                self.template_vertices.push(match attributes::numbers(json)?[..] {
                    [x, y, z, ..] => DVec3::new(x, y, z),
                    _ => DVec3::NAN,
                });
                Ok(())
            }),
            _ => json.skip(),
        })
    }
}

/// `"2.0"`; a number, as some write, by its text.
fn version(json: &mut Json<'_>) -> Step<String> {
    Ok(match json.peek()? {
        Kind::String => json.string()?.into_owned(),
        _ => String::from_utf8_lossy(json.raw()?).into_owned(),
    })
}

/// A list of ids; what is no string is left out.
fn ids(json: &mut Json<'_>) -> Step<Vec<String>> {
    let mut list = Vec::new();
    if json.peek()? != Kind::Array {
        json.skip()?;
        return Ok(list);
    }
    json.array(|json| {
        list.extend(Some(text(json)?.into_owned()).filter(|id| !id.is_empty()));
        Ok(())
    })?;
    Ok(list)
}

/// Three finite scales, none 0, and three finite translations.
fn transform(json: &mut Json<'_>) -> Step<Option<Transform>> {
    let (mut scale, mut translate) = (Vec::new(), Vec::new());
    each_member(json, |json, key| {
        match key {
            "scale" => scale = attributes::numbers(json)?,
            "translate" => translate = attributes::numbers(json)?,
            _ => json.skip()?,
        }
        Ok(())
    })?;
    let vector = |list: Vec<f64>| <[f64; 3]>::try_from(list).ok().map(DVec3::from_array).filter(|v| v.is_finite());
    let usable = vector(scale).zip(vector(translate)).filter(|(scale, _)| scale.cmpne(DVec3::ZERO).all());
    Ok(usable.map(|(scale, translate)| Transform { scale, translate }))
}

impl Appearance {
    /// Reads the value of `appearance`.
    fn read(json: &mut Json<'_>) -> Step<Self> {
        let mut this = Self::default();
        each_member(json, |json, key| {
            match key {
                "materials" if json.peek()? == Kind::Array => json.array(|json| {
                    this.materials.push(material(json)?);
                    Ok(())
                })?,
                "textures" if json.peek()? == Kind::Array => json.array(|json| {
                    this.textures.push(texture(json)?);
                    Ok(())
                })?,
                "vertices-texture" if json.peek()? == Kind::Array => json.array(|json| {
                    // CityJSON counts v upwards; row 0 of an image is its top.
                    this.texcoords.push(match attributes::numbers(json)?[..] {
                        [u, v, ..] if u.abs() < 1e30 && v.abs() < 1e30 => [u as f32, (1.0 - v) as f32],
                        _ => [0.0; 2],
                    });
                    Ok(())
                })?,
                "default-theme-material" => this.material_theme = Some(text(json)?.into_owned()),
                "default-theme-texture" => this.texture_theme = Some(text(json)?.into_owned()),
                _ => json.skip()?,
            }
            Ok(())
        })?;
        Ok(this)
    }
}

fn material(json: &mut Json<'_>) -> Step<Material> {
    let mut read = appearance::X3dMaterial::default();
    each_member(json, |json, key| {
        match key {
            "name" => read.name = text(json)?.into_owned(),
            "diffuseColor" => read.diffuse = color(json)?,
            "emissiveColor" => read.emissive = color(json)?,
            "specularColor" => read.specular = color(json)?,
            "shininess" => read.shininess = scalar(json)?,
            "transparency" => read.transparency = scalar(json)?,
            _ => json.skip()?,
        }
        Ok(())
    })?;
    Ok(read.into_material())
}

fn texture(json: &mut Json<'_>) -> Step<(String, [Wrap; 2])> {
    let (mut image, mut wrap) = (String::new(), Wrap::Repeat);
    each_member(json, |json, key| {
        match key {
            "image" => image = text(json)?.into_owned(),
            "wrapMode" => {
                wrap = match &*text(json)? {
                    "mirror" => Wrap::Mirror,
                    "none" | "clamp" | "border" => Wrap::Clamp,
                    _ => Wrap::Repeat,
                }
            }
            _ => json.skip()?,
        }
        Ok(())
    })?;
    Ok((image, [wrap; 2]))
}

fn scalar(json: &mut Json<'_>) -> Step<Option<f32>> {
    if json.peek()? == Kind::Number {
        return Ok(Some(json.number()?.as_f64() as f32).filter(|s| s.is_finite()).map(|s| s.clamp(0.0, 1.0)));
    }
    json.skip()?;
    Ok(None)
}

fn color(json: &mut Json<'_>) -> Step<Option<[f32; 3]>> {
    let list = attributes::numbers(json)?;
    let rgb = <[f64; 3]>::try_from(list).ok().filter(|c| c.iter().all(|x| x.is_finite()));
    Ok(rgb.map(|c| c.map(|x| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) as f32 })))
}
