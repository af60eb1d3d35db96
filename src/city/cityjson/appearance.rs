//! Materials and textures: from the lists of the file to those of the model, and which polygon has which.

use std::path::Path;

use rustc_hash::FxHashMap;

use crate::city::{
    build::ModelBuilder,
    cityjson::{
        geometry::{GeometryRead, MaterialUse},
        nested::Token,
    },
    load::options::{LoadOptions, Sibling},
    memory::give_back,
    model::{Material, NONE, TexelOpacity, Texture, TextureImage, TextureOpacity, Wrap},
    warning::WarningCode,
};

/// `appearance` as read.
#[derive(Clone, Debug, Default)]
pub struct Appearance {
    /// Materials.
    pub materials: Vec<Material>,
    /// Image paths as the file spells them, and how they continue.
    pub textures: Vec<(String, [Wrap; 2])>,
    /// Texture coordinates, v down.
    pub texcoords: Vec<[f32; 2]>,
    /// The theme to show.
    pub material_theme: Option<String>,
    /// The theme to show.
    pub texture_theme: Option<String>,
}

/// A material in the terms of X3D, as CityJSON has it.
#[derive(Clone, Debug, Default)]
pub struct X3dMaterial {
    /// Its name.
    pub name: String,
    /// sRGB, 0..1.
    pub diffuse: Option<[f32; 3]>,
    /// sRGB, 0..1.
    pub emissive: Option<[f32; 3]>,
    /// sRGB, 0..1.
    pub specular: Option<[f32; 3]>,
    /// 0..1.
    pub shininess: Option<f32>,
    /// 0..1.
    pub transparency: Option<f32>,
}

impl X3dMaterial {
    /// The same in the model's terms.
    pub fn into_material(self) -> Material {
        let [r, g, b] = self.diffuse.unwrap_or([0.8; 3]).map(linear);
        let is_shiny = self.specular.is_some_and(|s| s.iter().any(|c| *c > 0.0));
        Material {
            name: self.name,
            base_color: [r, g, b, 1.0 - self.transparency.unwrap_or(0.0)],
            emissive: self.emissive.unwrap_or([0.0; 3]).map(linear),
            roughness: if is_shiny { roughness(self.shininess.unwrap_or(0.2)) } else { Material::default().roughness },
            ..Material::default()
        }
    }
}

/// Linear light of an sRGB value (IEC 61966-2-1).
fn linear(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Perceptual roughness of a Blinn lobe with exponent 128 × shininess (Walter et al. 2007: α² = 2 / (n + 2)).
fn roughness(shininess: f32) -> f32 {
    (2.0 / (128.0 * shininess + 2.0)).sqrt().sqrt()
}

/// The model's materials and textures of one file, across the documents of a sequence.
#[derive(Debug, Default)]
pub struct SharedAppearance {
    /// Whether more documents follow.
    is_shared: bool,
    /// Materials and textures of earlier documents, so that features that repeat them share them.
    known_materials: FxHashMap<MaterialKey, u32>,
    known_textures: FxHashMap<(String, [u8; 2]), u32>,
    /// Textured variants: (material or NONE, texture) → material.
    textured: FxHashMap<(u32, u32), u32>,
}

/// Everything in a material that differs here: its name, and the bits of the rest.
type MaterialKey = (String, [u32; 10]);

fn key_of(material: &Material) -> MaterialKey {
    // What no CityJSON has is left out.
    let Material { name, base_color: [r, g, b, a], emissive, roughness, unlit, texture, .. } = material;
    let [r, g, b, a, roughness] = [r, g, b, a, roughness].map(|x| x.to_bits());
    let [er, eg, eb] = emissive.map(f32::to_bits);
    (name.clone(), [r, g, b, a, er, eg, eb, roughness, u32::from(*unlit), *texture])
}

/// The appearance of one document, in the model's indices.
#[derive(Clone, Debug, Default)]
pub struct AppearanceTable {
    materials: Vec<u32>,
    textures: Vec<u32>,
    texcoords: Vec<[f32; 2]>,
    material_theme: Option<String>,
    texture_theme: Option<String>,
}

impl AppearanceTable {
    /// Frees it.
    pub fn give_back(self) {
        give_back(self.texcoords);
    }
}

impl SharedAppearance {
    /// An empty one; `is_shared`: more than one document uses it.
    pub fn new(is_shared: bool) -> Self {
        Self { is_shared, ..Self::default() }
    }

    /// Adds what a document declares to the model.
    pub fn adopt(
        &mut self,
        mut appearance: Appearance,
        builder: &mut ModelBuilder,
        file: &Path,
        options: &LoadOptions,
    ) -> AppearanceTable {
        let mut appearance_table = AppearanceTable {
            texcoords: appearance.texcoords,
            material_theme: appearance.material_theme,
            texture_theme: appearance.texture_theme,
            ..AppearanceTable::default()
        };
        // What one document repeats stays repeated: only what earlier ones declared is looked up.
        let (mut new_materials, mut new_textures) = (Vec::new(), Vec::new());
        builder.model.materials.reserve(appearance.materials.len());
        for material in appearance.materials.drain(..) {
            let key = self.is_shared.then(|| key_of(&material));
            let index = key.as_ref().and_then(|key| self.known_materials.get(key).copied()).unwrap_or_else(|| {
                builder.model.materials.push(material);
                (builder.model.materials.len() - 1) as u32
            });
            new_materials.extend(key.map(|key| (key, index)));
            appearance_table.materials.push(index);
        }
        give_back(appearance.materials);
        for (image, wrap) in appearance.textures {
            let key = (image, wrap.map(|w| w as u8));
            let index = self.known_textures.get(&key).copied().unwrap_or_else(|| {
                let image = resolve(&key.0, builder, file, options);
                builder.model.textures.push(Texture { image, wrap, opacity: TextureOpacity::Own });
                (builder.model.textures.len() - 1) as u32
            });
            if self.is_shared {
                new_textures.push((key, index));
            }
            appearance_table.textures.push(index);
        }
        self.known_materials.extend(new_materials);
        self.known_textures.extend(new_textures);
        appearance_table
    }

    /// The material with this texture on it.
    fn textured(&mut self, material: u32, texture: u32, builder: &mut ModelBuilder) -> u32 {
        let materials = &mut builder.model.materials;
        *self.textured.entry((material, texture)).or_insert_with(|| {
            let base = materials.get(material as usize).cloned();
            let bare = base.unwrap_or(Material { base_color: [1.0; 4], ..Material::default() });
            materials.push(Material { texture, texels: TexelOpacity::Translucent, ..bare });
            (materials.len() - 1) as u32
        })
    }

    /// The material of each polygon of a geometry, and the texture coordinate of each index (or none at all).
    pub fn materials_of(
        &mut self,
        geometry: &GeometryRead,
        depth: usize,
        appearance_table: &AppearanceTable,
        builder: &mut ModelBuilder,
        object: &str,
    ) -> (Vec<u32>, Vec<[f32; 2]>) {
        let polygon_count = geometry.boundaries.ends[depth - 1].len();
        let mut materials = vec![NONE; polygon_count];
        let mut bad = 0;
        if let Some(used) = themed(&geometry.materials, appearance_table.material_theme.as_deref()) {
            bad += set_materials(used, geometry, depth, appearance_table, &mut materials);
        }
        let mut texcoords = Vec::new();
        if let Some(values) = themed(&geometry.textures, appearance_table.texture_theme.as_deref()) {
            let (rings, wrong) = ring_textures(values, geometry, depth, appearance_table);
            bad += wrong;
            texcoords = self.apply_textures(&rings, geometry, depth, builder, &mut materials);
        }
        if bad > 0 {
            builder.model.warnings.add(WarningCode::AppearanceIndex, object, || {
                format!("object {object}: {bad} material or texture values of a geometry point past their list or do not match its boundaries; their faces have none")
            });
        }
        (materials, texcoords)
    }

    /// Gives polygons whose rings all have one texture that texture; returns the coordinates of all indices.
    fn apply_textures(
        &mut self,
        rings: &[RingTexture],
        geometry: &GeometryRead,
        depth: usize,
        builder: &mut ModelBuilder,
        materials: &mut [u32],
    ) -> Vec<[f32; 2]> {
        let boundaries = &geometry.boundaries;
        let (ring_ends, polygon_ends) = (&boundaries.ends[depth], &boundaries.ends[depth - 1]);
        let mut texcoords = Vec::new();
        let mut start = 0;
        for (polygon, end) in polygon_ends.iter().map(|e| *e as usize).enumerate() {
            let own = &rings[start..end];
            if let Some(texture) = own.first().and_then(|r| r.texture)
                && own.iter().all(|r| r.texture == Some(texture))
            {
                texcoords.resize(boundaries.indices.len(), [0.0; 2]);
                materials[polygon] = self.textured(materials[polygon], texture, builder);
                for (ring, own_texture) in (start..end).zip(own) {
                    let from = if ring == 0 { 0 } else { ring_ends[ring - 1] as usize };
                    texcoords[from..from + own_texture.texcoords.len()].copy_from_slice(&own_texture.texcoords);
                }
            }
            start = end;
        }
        texcoords
    }
}

/// Where an image of the file is.
fn resolve(image: &str, builder: &mut ModelBuilder, path: &Path, options: &LoadOptions) -> TextureImage {
    let warnings = &mut builder.model.warnings;
    let file = path.display();
    if image.is_empty() {
        return TextureImage::Missing(format!("{file}: a texture names no image"));
    }
    if image.contains("://") {
        return TextureImage::Missing(format!("{file}: {image} is on the web; nothing is fetched"));
    }
    match options.sibling(path, image) {
        Sibling::Found(path) => TextureImage::File(path),
        Sibling::Missing(path) => TextureImage::Missing(format!("{file}: no image at {}", path.display())),
        Sibling::Outside(path) => {
            warnings.add(WarningCode::OutsidePath, "", || {
                format!("{file}: {} leaves the folders named; --allow-outside would follow it", path.display())
            });
            TextureImage::Missing(String::new())
        }
    }
}

/// The entry of the theme to show: the default theme, else the first.
fn themed<'a, T>(list: &'a [(String, T)], theme: Option<&str>) -> Option<&'a T> {
    let chosen = list.iter().find(|(name, _)| Some(name.as_str()) == theme);
    chosen.or(list.first()).map(|(_, value)| value)
}

/// Fills in materials; returns how many values were wrong.
fn set_materials(
    used: &MaterialUse,
    geometry: &GeometryRead,
    depth: usize,
    appearance_table: &AppearanceTable,
    out: &mut [u32],
) -> u64 {
    let mut bad = 0;
    let mut find = |index: u32| {
        let found = appearance_table.materials.get(index as usize);
        bad += u64::from(found.is_none());
        found.copied().unwrap_or(NONE)
    };
    let values = match used {
        MaterialUse::All(index) => {
            out.fill(find(*index));
            return bad;
        }
        MaterialUse::Each(values) => values,
    };
    let mut beside = 0;
    let wrong = values.for_each(&geometry.boundaries.ends[..depth - 1], |polygon, tokens| match tokens {
        [Token::Index(index)] => out[polygon] = find(*index),
        // In place of a face's value may stand one for all of its rings.
        [Token::Open, Token::Index(index), Token::Close] => out[polygon] = find(*index),
        [.., Token::Index(_), _] => beside += 1,
        _ => {}
    });
    bad + wrong + beside
}

/// The texture of a ring.
#[derive(Clone, Debug, Default)]
struct RingTexture {
    texture: Option<u32>,
    texcoords: Vec<[f32; 2]>,
}

/// The texture of every ring, and how many were wrong.
fn ring_textures(
    values: &crate::city::cityjson::nested::Values,
    geometry: &GeometryRead,
    depth: usize,
    appearance_table: &AppearanceTable,
) -> (Vec<RingTexture>, u64) {
    let boundaries = &geometry.boundaries;
    let ring_ends = &boundaries.ends[depth];
    let mut rings = vec![RingTexture::default(); ring_ends.len()];
    let mut bad = 0;
    let wrong = values.for_each(&boundaries.ends[..depth], |ring, tokens| {
        let start = if ring == 0 { 0 } else { ring_ends[ring - 1] };
        let corners = (ring_ends[ring] - start) as usize;
        match tokens {
            [Token::Null] | [Token::Open, Token::Null, Token::Close] | [Token::Open, Token::Close] => {}
            [Token::Open, Token::Index(texture), uv @ .., Token::Close] => {
                let texture = appearance_table.textures.get(*texture as usize).copied();
                let texcoords: Option<Vec<_>> = uv
                    .iter()
                    .map(|token| match token {
                        Token::Index(i) => appearance_table.texcoords.get(*i as usize).copied(),
                        _ => None,
                    })
                    .collect();
                match (texture, texcoords) {
                    (Some(texture), Some(texcoords)) if texcoords.len() == corners => {
                        rings[ring] = RingTexture { texture: Some(texture), texcoords };
                    }
                    _ => bad += 1,
                }
            }
            _ => bad += 1,
        }
    });
    (rings, bad + wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_linear() {
        assert_eq!(linear(0.0), 0.0);
        assert!((linear(1.0) - 1.0).abs() < 1e-6);
        // 50 % grey of a screen is 21.4 % of the light.
        assert!((linear(0.5) - 0.2140).abs() < 1e-4);
        let glass = X3dMaterial { transparency: Some(0.75), ..X3dMaterial::default() }.into_material();
        assert_eq!(glass.base_color[3], 0.25);
    }

    #[test]
    fn shininess_runs_from_chalk_to_mirror() {
        assert_eq!(roughness(0.0), 1.0);
        assert!(roughness(0.2) > roughness(0.8));
        assert_eq!(X3dMaterial { shininess: Some(1.0), ..X3dMaterial::default() }.into_material().roughness, 0.9);
    }

    #[test]
    fn the_default_theme_wins_then_the_first() {
        let list = [("a".to_owned(), 1), ("b".to_owned(), 2)];
        assert_eq!(themed(&list, Some("b")), Some(&2));
        assert_eq!(themed(&list, Some("c")), Some(&1));
        assert_eq!(themed(&list, None), Some(&1));
        assert_eq!(themed::<i32>(&[], None), None);
    }
}
