//! glTF materials as [`Material`]s: made when first used, once per (material, textured, vertex colour).

use gltf::json::{
    extensions::texture::TextureTransform,
    material::{AlphaMode, Material as Json},
    texture::{Info, WrappingMode},
    validation::Checked,
};
use rustc_hash::FxHashMap;

use super::{
    buffers::{self, Buffers, Surroundings},
    document::Document,
};
use crate::city::{
    model::{CityModel, Material, NONE, TexelOpacity, Texture, TextureOpacity, Wrap},
    warning::WarningCode,
};

/// Vertex colours are kept as materials; a file with more different ones than this gets means per primitive.
pub(super) const MAX_TINTS: usize = 4096;
/// The steps of a tint: 10 bits per channel.
const TINT_STEPS: f64 = 1023.0;

/// A vertex colour, linear RGB and opacity in 1/1023.
pub(super) type Tint = [u16; 4];

/// No vertex colour.
pub(super) const UNTINTED: Tint = [TINT_STEPS as u16; 4];

/// The tint nearest to a linear colour.
pub(super) fn tint(color: [f64; 4]) -> Tint {
    color.map(|c| (c.clamp(0.0, 1.0) * TINT_STEPS).round() as u16)
}

/// Which material a triangle asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Key {
    /// Index in the file; `None` is the default material.
    pub material: Option<usize>,
    /// Whether its texture applies: the primitive has the texture coordinates it wants.
    pub textured: bool,
    /// The vertex colour it is multiplied with.
    pub tint: Tint,
}

/// The way to the texture coordinates of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mapping {
    /// Which `TEXCOORD_n`.
    pub set: u32,
    /// `KHR_texture_transform` as rows: u' = m₀·(u, v, 1), v' = m₁·(u, v, 1).
    pub rows: [[f64; 3]; 2],
}

/// The materials of one file.
#[derive(Debug)]
pub(super) struct Materials {
    made: FxHashMap<Key, u32>,
    /// By their index in the file, and whether they hold normals.
    textures: FxHashMap<(usize, bool), u32>,
    /// Vertex colours seen.
    pub tints: usize,
    /// Bytes that embedded images may still take.
    image_budget: u64,
}

/// The source that materials are read from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Palette<'a> {
    pub document: &'a Document,
    pub buffers: &'a Buffers<'a>,
    pub around: Surroundings<'a>,
}

impl Materials {
    pub fn new(buffers: &Buffers<'_>) -> Self {
        let image_budget = buffers.total.saturating_mul(2).saturating_add(1 << 20);
        Self { made: FxHashMap::default(), textures: FxHashMap::default(), tints: 0, image_budget }
    }

    /// The city's index of the material of `key`.
    pub fn get(&mut self, key: Key, from: Palette<'_>, city: &mut CityModel) -> u32 {
        if let Some(made) = self.made.get(&key) {
            return *made;
        }
        let material = self.make(key, from, city);
        city.materials.push(material);
        let index = (city.materials.len() - 1) as u32;
        self.made.insert(key, index);
        index
    }

    /// Whether another vertex colour may become a material.
    pub fn admits(&mut self, key: Key) -> bool {
        if self.made.contains_key(&key) {
            return true;
        }
        self.tints += 1;
        self.tints <= MAX_TINTS
    }

    fn make(&mut self, key: Key, from: Palette<'_>, city: &mut CityModel) -> Material {
        let json = key.material.and_then(|m| from.document.materials.get(m).ok());
        // glTF 2.0, 5.19: the default material is white; a city in pure white hides its edges, so ours is used.
        let mut material = json.map_or_else(Material::default, colors);
        if let Some(json) = json {
            self.add_textures(&mut material, json, key.textured, from, city);
        }
        if key.tint != UNTINTED && json.is_none() {
            material.base_color = [1.0; 4];
        }
        for (channel, tint) in material.base_color.iter_mut().zip(key.tint) {
            *channel *= (f64::from(tint) / TINT_STEPS) as f32;
        }
        match json.map(|j| j.alpha_mode) {
            Some(Checked::Valid(AlphaMode::Blend)) => material.texels = TexelOpacity::Translucent,
            Some(Checked::Valid(AlphaMode::Mask)) => {
                // The texel's share of the test `texel × factor < cutoff`; nothing is left where the factor is 0.
                let cutoff = json.and_then(|j| j.alpha_cutoff).map_or(0.5, |c| c.0);
                let alpha = material.base_color[3];
                let least = if alpha > 0.0 { (cutoff / alpha).max(0.0) } else { f32::MAX };
                material.texels = TexelOpacity::Holes(least);
                let is_hole = material.texture == NONE && alpha < cutoff;
                material.base_color[3] = if is_hole { 0.0 } else { 1.0 };
            }
            _ => material.base_color[3] = 1.0,
        }
        material
    }

    /// Adds what a material has at its texture coordinates, where there are some.
    fn add_textures(
        &mut self,
        material: &mut Material,
        json: &Json,
        textured: bool,
        from: Palette<'_>,
        city: &mut CityModel,
    ) {
        let [color, emissive, normal] = maps(json);
        let mapping = first_mapping(json);
        // A vertex has one pair of coordinates: that of the first.
        let mut is_drawn = |map: &Option<Map>, what: &str| {
            let Some(map) = map else { return None };
            let trouble = match (textured, mapping) {
                (false, _) => "where there are no texture coordinates for them",
                (_, Some(first)) if first != map.mapping => "at other texture coordinates than the material's first",
                _ => return Some(map.texture),
            };
            city.warnings.add(WarningCode::Unsupported, "", || {
                let name = json.name.as_deref().unwrap_or("unnamed");
                format!("{}, material {name:?}: {what} textures are not drawn {trouble}", from.around.path.display())
            });
            None
        };
        let color = color.filter(|_| textured).map(|map| map.texture);
        let is_dark = material.emissive == [0.0; 3];
        let is_lit_by = emissive.is_some();
        let emissive = if is_dark { None } else { is_drawn(&emissive, "emissive") };
        let normal = is_drawn(&normal, "normal");
        let mut number = |index: Option<usize>, has_normals| {
            index.map_or(NONE, |index| self.texture(index, has_normals, from, city))
        };
        material.texture = number(color, false);
        material.emissive_texture = number(emissive, false);
        if is_lit_by && material.emissive_texture == NONE {
            // Without its picture the light would flood the whole surface.
            material.emissive = [0.0; 3];
        }
        material.normal_texture = number(normal, true);
        let scale = json.normal_texture.as_ref().map_or(1.0, |map| map.scale);
        material.normal_scale = if scale.is_finite() { scale } else { 1.0 };
    }

    /// The city's index of texture `index`, or [`NONE`].
    fn texture(&mut self, index: usize, has_normals: bool, from: Palette<'_>, city: &mut CityModel) -> u32 {
        if let Some(made) = self.textures.get(&(index, has_normals)) {
            return *made;
        }
        let document = from.document;
        let found = document.textures.get(index).and_then(|texture| {
            let at = texture.image().ok_or_else(|| format!("textures[{index}] has no image that can be read"))?;
            Ok((texture, at, document.images.get(at)?))
        });
        let made = match found {
            Ok((texture, at, image)) => {
                let sampler = texture.sampler.and_then(|s| document.samplers.get(s as usize).ok());
                let wrap = sampler.map_or([Wrap::Repeat; 2], |s| [s.wrap_s, s.wrap_t].map(wrap));
                let budget = &mut self.image_budget;
                let image = buffers::image(at, image, document, from.buffers, from.around, budget, &mut city.warnings);
                city.textures.push(Texture { image, wrap, opacity: TextureOpacity::Own });
                (city.textures.len() - 1) as u32
            }
            Err(what) => {
                city.warnings.add(WarningCode::AppearanceIndex, "", || {
                    format!("{}, {what}; the material is shown without it", from.around.path.display())
                });
                NONE
            }
        };
        self.textures.insert((index, has_normals), made);
        made
    }
}

/// A texture of a material, and where it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Map {
    texture: usize,
    mapping: Mapping,
}

impl Map {
    fn new(texture: usize, set: u32, transform: Option<&TextureTransform>) -> Self {
        let Some(t) = transform else {
            return Self { texture, mapping: Mapping { set, rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] } };
        };
        // KHR_texture_transform: translation × rotation × scale.
        let (sin, cos) = f64::from(t.rotation.0).sin_cos();
        let [sx, sy] = t.scale.0.map(f64::from);
        let [ox, oy] = t.offset.0.map(f64::from);
        let rows = [[cos * sx, sin * sy, ox], [-sin * sx, cos * sy, oy]];
        Self { texture, mapping: Mapping { set: t.tex_coord.unwrap_or(set), rows } }
    }

    fn of(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        Self::new(info.index.value(), info.tex_coord, transform)
    }
}

/// The textures of a material that are drawn: of its colour, of its light, of its normals.
fn maps(json: &Json) -> [Option<Map>; 3] {
    let normal = json.normal_texture.as_ref().map(|info| {
        let others = info.extensions.as_ref().map(|e| &e.others);
        let transform: Option<TextureTransform> = others
            .and_then(|others| others.get("KHR_texture_transform"))
            .and_then(|transform| serde_json::from_value(transform.clone()).ok());
        Map::new(info.index.value(), info.tex_coord, transform.as_ref())
    });
    [color_texture(json).as_ref().map(Map::of), json.emissive_texture.as_ref().map(Map::of), normal]
}

/// Where the first of them is read.
fn first_mapping(json: &Json) -> Option<Mapping> {
    maps(json).into_iter().flatten().next().map(|map| map.mapping)
}

/// Where the textures of a material are read, if it has some.
pub(super) fn mapping(document: &Document, material: Option<usize>) -> Option<Mapping> {
    first_mapping(document.materials.get(material?).ok()?)
}

/// The texture that colours the material, of either workflow.
fn color_texture(json: &Json) -> Option<Info> {
    json.pbr_metallic_roughness.base_color_texture.clone().or_else(|| {
        let glossy = json.extensions.as_ref()?.others.get("KHR_materials_pbrSpecularGlossiness")?;
        serde_json::from_value(glossy.get("diffuseTexture")?.clone()).ok()
    })
}

/// Everything of a material but its textures.
fn colors(json: &Json) -> Material {
    let pbr = &json.pbr_metallic_roughness;
    let extension = |name: &str| json.extensions.as_ref().and_then(|e| e.others.get(name));
    let mut base_color = pbr.base_color_factor.0;
    let mut roughness = pbr.roughness_factor.0;
    if let Some(glossy) = extension("KHR_materials_pbrSpecularGlossiness") {
        let factor = glossy.get("diffuseFactor").and_then(|f| serde_json::from_value(f.clone()).ok());
        base_color = factor.unwrap_or([1.0; 4]);
        roughness = 1.0 - glossy.get("glossinessFactor").and_then(serde_json::Value::as_f64).unwrap_or(1.0) as f32;
    }
    let strength = extension("KHR_materials_emissive_strength").and_then(|e| e.get("emissiveStrength")?.as_f64());
    let emissive = json.emissive_factor.0.map(|c| sane(c * strength.unwrap_or(1.0) as f32, f32::MAX));
    Material {
        name: json.name.clone().unwrap_or_default(),
        base_color: base_color.map(|c| sane(c, 1.0)),
        emissive,
        roughness: sane(roughness, 1.0),
        unlit: json.extensions.as_ref().is_some_and(|e| e.unlit.is_some()),
        ..Material::default()
    }
}

/// Between 0 and `most`; NaN is 0.
fn sane(value: f32, most: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, most) }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}
