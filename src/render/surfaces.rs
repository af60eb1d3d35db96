//! The table of surfaces: what a fragment looks up by the number in the geometry target.
//!
//! It is a texture, [`ROW`] surfaces per row, one texel each: software adapters gather texels of many pixels at once,
//! but walk through a storage buffer pixel by pixel.

use glam::Vec3;
use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, Material, Materials, NONE, ObjectClass, StringId, Surface, TexelOpacity, decode_normal},
    gpu::{Gpu, GpuError},
    render::{
        city::{Group, Images, Shown, Texels, Translucency},
        layout,
        palette::{self, Facing},
        shells::Shells,
        textures::Textures,
    },
};

/// Opacity from which on something throws its shadow, all of it.
pub const LEAST_SHADOW: f32 = 0.5;

/// Surfaces per row: `lib/surface.wgsl` knows it too.
pub const ROW: u32 = 4096;

/// Collects surfaces as the shader wants them: one entry per (surface, normal).
pub struct SurfaceTable<'a> {
    model: &'a CityModel,
    textures: &'a Textures,
    shells: &'a Shells,
    /// Whether opacity of materials does not count.
    pub is_opaque: bool,
    /// Colour of the plain ground, linear light.
    pub ground: [f32; 3],
    /// Of block models, whose roofs are all flat: of each object whether its own is.
    pub flat_roofs: Option<&'a [bool]>,
    /// The entries, by number.
    pub entries: Vec<layout::Surface>,
    numbers: FxHashMap<(u32, u32, bool), u32>,
}

impl<'a> SurfaceTable<'a> {
    /// An empty table of what is shown.
    pub fn of(shown: &Shown<'a>, textures: &'a Textures, shells: &'a Shells) -> Self {
        let table = Self::new(shown.model, textures, shells);
        match shown.ground {
            Some(_) => Self { ground: ground_color(shown, textures), ..table },
            None => table,
        }
    }

    /// An empty table.
    pub fn new(model: &'a CityModel, textures: &'a Textures, shells: &'a Shells) -> Self {
        let ground = palette::linear_bytes(palette::PLAIN_GROUND);
        Self {
            model,
            textures,
            shells,
            is_opaque: false,
            ground,
            flat_roofs: None,
            entries: Vec::new(),
            numbers: FxHashMap::default(),
        }
    }

    /// Numbers given so far are not given again: surfaces of another tile are others.
    pub fn begin_tile(&mut self) {
        self.numbers.clear();
    }

    /// The number of a model surface (`NONE`: the plain ground) that faces a packed normal; `has_texcoords`: whether it can show a
    /// texture.
    pub fn number(&mut self, surface: u32, normal: u32, has_texcoords: bool) -> u32 {
        let Self { model, textures, shells, is_opaque, ground, flat_roofs, entries, numbers } = self;
        *numbers.entry((surface, normal, has_texcoords)).or_insert_with(|| {
            let found = match surface {
                NONE => plain_ground(*ground, normal),
                surface => entry_with(model, textures, shells, surface, normal, *flat_roofs),
            };
            let number = entries.len() as u32;
            entries.push(if *is_opaque { found.opaque() } else { found });
            entries.extend(emission(model, textures, surface).map(|light| light.entry(has_texcoords)));
            number
        })
    }

    /// What its triangles have in common with others; `has_texcoords`: whether they can show a texture.
    pub fn group(&self, surface: u32, has_texcoords: bool) -> Group {
        let found = self.model.surfaces.get(surface as usize);
        let Some(material) = found.and_then(|s| self.model.materials.get(s.material as usize)) else {
            return Group::PLAIN;
        };
        let images = if has_texcoords { self.images(material) } else { None };
        let opacity = layout::opacity_shown(material.base_color[3]);
        let translucency = match images {
            _ if opacity < 1.0 => Translucency::All,
            Some(Images { texels: Texels::Translucent, .. }) => Translucency::Some,
            _ => Translucency::None,
        };
        Group { images, translucency, has_shadow: material.base_color[3] >= LEAST_SHADOW }
    }

    /// Those of its textures that are there; `None`: none is.
    fn images(&self, material: &Material) -> Option<Images> {
        let there = |texture: u32| if self.textures.has(texture) { texture } else { NONE };
        let [color, emission, normals] = material.textures().map(there);
        let texels = match material.texels {
            _ if color == NONE => Texels::Opaque,
            TexelOpacity::Ignored => Texels::Opaque,
            TexelOpacity::Holes(least) => Texels::Holes(least.to_bits()),
            TexelOpacity::Translucent if self.textures.is_translucent(color) => Texels::Translucent,
            TexelOpacity::Translucent => Texels::Opaque,
        };
        let normal_scale = if normals == NONE { 0.0_f32 } else { material.normal_scale };
        let normal_scale_bits = normal_scale.to_bits();
        let images = Images { color, emission, normals, normal_scale: normal_scale_bits, texels, facade: false };
        ([color, emission] != [NONE; 2] || normal_scale != 0.0).then_some(images)
    }
}

/// Light of its own that a model surface has.
struct Emission {
    /// Linear.
    light: [f32; 3],
    /// Whether a picture says where.
    is_of_texels: bool,
}

impl Emission {
    /// What the table says of it where there are texture coordinates or not.
    fn entry(&self, has_texcoords: bool) -> layout::Surface {
        let Self { light, is_of_texels } = *self;
        // Without the picture it would flood the whole surface.
        let light = if is_of_texels && !has_texcoords { [0.0; 3] } else { light };
        layout::Surface::new(layout::NO_OBJECT, 0, light, if is_of_texels { layout::LIGHT_OF_TEXELS } else { 0 })
    }
}

fn emission(model: &CityModel, textures: &Textures, surface: u32) -> Option<Emission> {
    let material = model.materials.get(model.surfaces.get(surface as usize)?.material as usize)?;
    let is_of_texels = material.emissive_texture != NONE;
    let is_dark = material.emissive == [0.0; 3] || (is_of_texels && !textures.has(material.emissive_texture));
    (!is_dark).then_some(Emission { light: material.emissive, is_of_texels })
}

/// Puts a table on the GPU.
pub fn upload(gpu: &Gpu, entries: &[layout::Surface]) -> Result<wgpu::TextureView, GpuError> {
    let rows = (entries.len() as u32).div_ceil(ROW).max(1);
    gpu.check_rows("the table of surfaces", rows, u64::from(ROW) * size_of::<layout::Surface>() as u64)?;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = gpu.texture("surfaces", [ROW, rows, 1], 1, wgpu::TextureFormat::Rgba32Uint, usage);
    let mut texels = bytemuck::cast_slice::<_, u8>(entries).to_vec();
    texels.resize((ROW * rows) as usize * size_of::<layout::Surface>(), 0);
    gpu.write_texture_level(&texture, 0, &texels);
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

/// Puts the entries from one on into a table that has as many rows as they need in all; whether it has.
pub fn replace_from(gpu: &Gpu, table: &wgpu::TextureView, first: usize, entries: &[layout::Surface]) -> bool {
    let texture = table.texture();
    let rows = (entries.len() as u32).div_ceil(ROW).max(1);
    if texture.height() != rows {
        return false;
    }
    let first_row = first as u32 / ROW;
    let mut texels = bytemuck::cast_slice::<_, u8>(&entries[(first_row * ROW) as usize..]).to_vec();
    texels.resize(((rows - first_row) * ROW) as usize * size_of::<layout::Surface>(), 0);
    gpu.write_texture_rows(texture, first_row, &texels);
    true
}

/// What the table says of the plain ground in a colour, that faces a packed normal: lit as level ground, on slopes too.
fn plain_ground(color: [f32; 3], normal: u32) -> layout::Surface {
    let flags = layout::PART_TERRAIN << layout::SURFACE_PART_SHIFT | layout::SURFACE_LIT_AS_BEFORE;
    layout::Surface::new(layout::NO_OBJECT, normal, color, flags)
}

/// The colour of the plain ground beside what is shown, linear light: halfway to the mean of terrain and land, where they have colours.
fn ground_color(shown: &Shown, textures: &Textures) -> [f32; 3] {
    let plain = palette::linear_bytes(palette::PLAIN_GROUND);
    let model = shown.model;
    let (mut sum, mut area) = ([0.0_f64; 3], 0.0);
    let geometries = shown.geometries.iter().map(|&g| &model.geometries[g as usize]);
    let is_land = |class| matches!(class, ObjectClass::Terrain | ObjectClass::Land);
    let land = geometries.filter(|g| is_land(model.objects[g.object as usize].class));
    for tile in land.flat_map(|g| &model.tiles[g.tiles.start as usize..g.tiles.end as usize]) {
        let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
        for corners in indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| &model.vertices[(tile.vertices.start + corners[k]) as usize]);
            let surface = &model.surfaces[a.surface as usize];
            let has_texture = |m: &Material| textures.has(m.texture);
            if tile.texcoords != NONE && model.materials.get(surface.material as usize).is_some_and(has_texture) {
                continue;
            }
            let [p, q, r] = [a, b, c].map(|vertex| Vec3::from(vertex.position).truncate());
            let weight = f64::from((q - p).perp_dot(r - p).abs());
            let color = natural_color(model, textures, surface, a.normal, None);
            (0..3).for_each(|i| sum[i] += weight * f64::from(color[i]));
            area += weight;
        }
    }
    if area > 0.0 { std::array::from_fn(|i| 0.5 * (plain[i] + (sum[i] / area) as f32)) } else { plain }
}

/// Of each object whether most of its roof is flat, by area in plan.
pub fn flat_roofs(shown: &Shown) -> Vec<bool> {
    let model = shown.model;
    // How much more is flat than not.
    let mut flat = vec![0.0_f32; model.objects.len()];
    for geometry in shown.geometries.iter().map(|&g| &model.geometries[g as usize]) {
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
            for corners in indices.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| &model.vertices[(tile.vertices.start + corners[k]) as usize]);
                if part_of(model, &model.surfaces[a.surface as usize], a.normal) != layout::PART_ROOF {
                    continue;
                }
                let [p, q, r] = [a, b, c].map(|vertex| Vec3::from(vertex.position));
                let area = (q - p).cross(r - p);
                let is_level = palette::is_level(f64::from(area.normalize_or_zero().z));
                flat[geometry.object as usize] += if is_level { area.z.abs() } else { -area.z.abs() };
            }
        }
    }
    flat.into_iter().map(|more| more > 0.0).collect()
}

/// What the table says of a model surface (`NONE`: the plain ground) that faces a packed normal.
pub(super) fn entry(
    model: &CityModel,
    textures: &Textures,
    shells: &Shells,
    surface: u32,
    normal: u32,
) -> layout::Surface {
    entry_with(model, textures, shells, surface, normal, None)
}

/// The same; `flat_roofs` as for [`natural_color`].
fn entry_with(
    model: &CityModel,
    textures: &Textures,
    shells: &Shells,
    surface: u32,
    normal: u32,
    flat_roofs: Option<&[bool]>,
) -> layout::Surface {
    let Some(found) = model.surfaces.get(surface as usize) else {
        return plain_ground(palette::linear_bytes(palette::PLAIN_GROUND), normal);
    };
    let material = model.materials.get(found.material as usize);
    let color = natural_color(model, textures, found, normal, flat_roofs);
    let unlit = if material.is_some_and(|m| m.unlit) { layout::SURFACE_UNLIT } else { 0 };
    let part = part_of(model, found, normal) << layout::SURFACE_PART_SHIFT;
    let shell = shells.get(&found.object).copied().unwrap_or_default();
    let opacity = material.map_or(1.0, |m| m.base_color[3]);
    let emits = if emission(model, textures, surface).is_some() { layout::SURFACE_EMITS } else { 0 };
    layout::Surface::new(found.object, normal, color, unlit | part | shell | emits | layout::clear_bits(opacity))
}

/// The colour of a model surface that faces a packed normal, linear light; where it has a texture, that of the material.
/// `flat_roofs`: of each object whether its roof is one, where that is not what the surface says.
fn natural_color(
    model: &CityModel,
    textures: &Textures,
    surface: &Surface,
    normal: u32,
    flat_roofs: Option<&[bool]>,
) -> [f32; 3] {
    let is_tamed = |m: &Material| model.shown_materials == Materials::Tamed && m.texture == NONE && !m.unlit;
    match model.materials.get(surface.material as usize) {
        // A texture brings the colour; the material's own only tints it.
        Some(m) if m.texture == NONE || textures.has(m.texture) => {
            let own = [m.base_color[0], m.base_color[1], m.base_color[2]];
            if is_tamed(m) { palette::tamed(own) } else { own }
        }
        // A declared texture that is missing: most files say plain white beside it, so the quiet colours are better.
        _ => {
            let part = part_of(model, surface, normal);
            let own = || palette::is_level(decode_normal(normal).z);
            palette::linear_bytes(palette::natural(
                model,
                surface,
                Facing {
                    is_roof: part == layout::PART_ROOF,
                    is_wall: part == layout::PART_WALL,
                    is_level: flat_roofs.map_or_else(own, |are| are[surface.object as usize]),
                },
            ))
        }
    }
}

/// What a surface is part of: by its semantics; where a building has none, by which way it faces.
pub(super) fn part_of(model: &CityModel, surface: &Surface, normal: u32) -> u32 {
    let class = model.objects[surface.object as usize].class;
    if class.is_ground() {
        return layout::PART_TERRAIN;
    }
    let kind = (surface.kind != StringId(NONE)).then(|| model.strings.get(surface.kind));
    match kind {
        Some("RoofSurface" | "OuterCeilingSurface" | "OuterFloorSurface") => layout::PART_ROOF,
        Some("WallSurface" | "InteriorWallSurface" | "ClosureSurface") => layout::PART_WALL,
        Some("Window" | "WindowSurface" | "Door" | "DoorSurface") => layout::PART_WALL,
        Some(_) => layout::PART_OTHER,
        None if class == ObjectClass::Building => match decode_normal(normal).z {
            z if z.abs() < STEEPEST_ROOF => layout::PART_WALL,
            z if z > 0.0 => layout::PART_ROOF,
            _ => layout::PART_OTHER,
        },
        None => layout::PART_OTHER,
    }
}

/// Cosine of the slope from which on a face without semantics is a wall: 75°.
const STEEPEST_ROOF: f64 = 0.259;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_of_a_picture_is_dark_where_there_are_no_texture_coordinates() {
        let entry = |is_of_texels, has_texcoords| Emission { light: [1.0; 3], is_of_texels }.entry(has_texcoords);
        let [light, dark] = [[1.0; 3], [0.0; 3]].map(|color| {
            [0, layout::LIGHT_OF_TEXELS].map(|flags| layout::Surface::new(layout::NO_OBJECT, 0, color, flags))
        });
        assert_eq!([entry(false, false), entry(false, true)], [light[0]; 2]);
        assert_eq!([entry(true, false), entry(true, true)], [dark[1], light[1]]);
    }
}
