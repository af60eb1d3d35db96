//! Every struct that is shared with WGSL, in one place; `tests` compares each, member by member, with
//! the WGSL struct of the same name. What the members mean stands there.
#![expect(missing_docs, reason = "each member is documented once, in its WGSL file")]

use bytemuck::{Pod, Zeroable};

use crate::{
    render::palette,
    shader::{MOST_SLOTS, MOST_VOLUMES, effect::MOST_HANDLERS},
};

/// `lib/view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct View {
    pub view_from_world: [[f32; 4]; 3],
    pub projection: [f32; 4],
    pub across_from_pixel: [f32; 4],
    pub near: f32,
    pub far: f32,
    pub orthographic: u32,
    pub sample_index: u32,
    pub eye_whole: [i32; 3],
    pub first_pixel: u32,
    pub eye_fraction: [f32; 3],
    pub pad_0: u32,
    pub size: [f32; 2],
    pub haze: f32,
    pub pad_1: u32,
}

/// A vertex of the city as the GPU reads it; `relative_to_eye` in `lib/view.wgsl` takes it from here.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CityVertex {
    pub origin: [i32; 3],
    pub surface: u32,
    pub position: [f32; 3],
    pub normal: u32,
}

impl CityVertex {
    /// A vertex `position` metres from a whole-metre `origin`, of an entry of the table of surfaces, with an octahedral
    /// normal.
    pub fn new(origin: glam::IVec3, surface: u32, position: [f32; 3], normal: u32) -> Self {
        Self { origin: origin.to_array(), surface, position, normal }
    }
}

/// Bits of the object of a surface; above them stands for which moment it is drawn: `lib/surface.wgsl` has as many.
const OBJECT_BITS: u32 = 26;

/// An object, drawn for one of the moments of what moves (from 1; 0: for all), as a texel of the table of surfaces has it.
pub fn drawn_for(object: u32, turn: u32) -> u32 {
    object | turn << OBJECT_BITS
}

/// The object of a texel.
pub fn object_of(word: u32) -> u32 {
    if word == NO_OBJECT { word } else { word & ((1 << OBJECT_BITS) - 1) }
}

/// One texel of the table of surfaces, decoded by `surface_at` in `lib/surface.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Surface {
    pub object: u32,
    pub normal: u32,
    pub color_rg: u32,
    pub color_b_flags: u32,
}

impl Surface {
    /// An entry: object index or [`NO_OBJECT`], octahedral normal, natural colour in linear light, flags.
    pub fn new(object: u32, normal: u32, color: [f32; 3], flags: u32) -> Self {
        let [r, g, b] = color.map(|c| u32::from(palette::half(c)));
        Self { object, normal, color_rg: r | g << 16, color_b_flags: b | flags << 16 }
    }

    /// The same, whatever its material lets through.
    pub fn opaque(self) -> Self {
        let clear = MOST_CLEAR << (16 + SURFACE_CLEAR_SHIFT);
        Self { color_b_flags: self.color_b_flags & !clear, ..self }
    }

    /// Whether it has light of its own.
    pub fn emits(&self) -> bool {
        (self.color_b_flags >> 16) & SURFACE_EMITS != 0
    }

    /// Whether its normal is never turned to the eye: it is lit by one that it does not have where it lies.
    pub fn is_lit_as_before(&self) -> bool {
        (self.color_b_flags >> 16) & SURFACE_LIT_AS_BEFORE != 0
    }
}

/// `lib/surface.wgsl`: no city object.
pub const NO_OBJECT: u32 = u32::MAX;
/// `lib/surface.wgsl`: light does not act on it.
pub const SURFACE_UNLIT: u32 = 1;
/// `lib/surface.wgsl`: the part stands above this bit of the flags.
pub const SURFACE_PART_SHIFT: u32 = 1;
/// `lib/surface.wgsl`: its object is a closed shell.
pub const SURFACE_CLOSED: u32 = 8;
/// `lib/surface.wgsl`: a closed shell whose faces look inwards.
pub const SURFACE_INWARD: u32 = 16;
/// A face is lit by a normal that it does not have where it lies.
pub const SURFACE_LIT_AS_BEFORE: u32 = 32;
/// `lib/surface.wgsl`: how much light its material lets through stands above this bit of the flags, in 1/511.
pub const SURFACE_CLEAR_SHIFT: u32 = 6;
/// All of it.
const MOST_CLEAR: u32 = 511;
/// `lib/surface.wgsl`: it has light of its own, the colour of the next entry.
pub const SURFACE_EMITS: u32 = 1 << 15;

/// `lib/surface.wgsl`: of such an entry, that texels say how much of the light there is.
pub const LIGHT_OF_TEXELS: u32 = 1;

/// The flags of a surface of this opacity, 0..1, to the nearest of 512 steps.
pub fn clear_bits(opacity: f32) -> u32 {
    (((1.0 - opacity.clamp(0.0, 1.0)) * MOST_CLEAR as f32).round() as u32) << SURFACE_CLEAR_SHIFT
}

/// An opacity as the shaders have it.
pub fn opacity_shown(opacity: f32) -> f32 {
    1.0 - (clear_bits(opacity) >> SURFACE_CLEAR_SHIFT) as f32 / MOST_CLEAR as f32
}

/// `lib/surface.wgsl`: of a number in the geometry target, that it is a section, and the bits that hold whose.
pub const SECTION: u32 = 1 << 31;
/// `lib/surface.wgsl`: the object of a section; all of these bits: of several.
pub const SECTION_OBJECT: u32 = (1 << 26) - 1;
/// `lib/surface.wgsl`: what a surface is part of.
pub const PART_OTHER: u32 = 0;
/// `lib/surface.wgsl`.
pub const PART_ROOF: u32 = 1;
/// `lib/surface.wgsl`.
pub const PART_WALL: u32 = 2;
/// `lib/surface.wgsl`.
pub const PART_TERRAIN: u32 = 3;

/// The plane of a face that shares it, as vertex attributes of `pass/geometry.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Plane {
    pub normal: [f32; 3],
    pub origin: [i32; 3],
    pub offset: f32,
}

/// The same of a face that has images.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TexturedPlane {
    pub plane: Plane,
    pub texcoord: [f32; 2],
}

/// `pass/refine.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Refinement {
    pub eye: [i32; 3],
    pub items: u32,
    pub eye_offset: [f32; 3],
    pub corners: u32,
    pub forward: [f32; 3],
    pub pixels: f32,
    pub near: f32,
    pub orthographic: u32,
    pub tolerance: f32,
    pub shortest: f32,
    pub anchor: [i32; 3],
    pub shift: u32,
    pub met: u32,
    pub chunks: u32,
    pub lift: f32,
    pub narrowest: f32,
    pub is_smooth: u32,
    pub asked: u32,
    pub pad_0: [u32; 2],
}

/// `pass/refine.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Corner {
    pub cell: [i32; 3],
    pub source: u32,
    pub weights: [f32; 2],
    pub pad_0: [u32; 2],
}

/// `pass/refine.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Triangle {
    pub a: u32,
    pub b: u32,
    pub c: u32,
    pub source: u32,
    pub edges: u32,
}

/// `lib/region.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Region {
    pub a: [f32; 3],
    pub test: u32,
    pub b: [f32; 4],
    pub c: [f32; 4],
    pub d: [f32; 4],
}

/// `pass/sections.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SectionStage {
    pub center: [f32; 3],
    pub radius: f32,
    pub color: [f32; 3],
    pub volume: u32,
    pub leaves: u32,
    pub turn: u32,
    pub has_forms: u32,
    pub pad_0: u32,
}

/// `lib/light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Light {
    pub to_sun: [f32; 3],
    pub shadow_scale: f32,
    pub sun: [f32; 3],
    pub shadow_depth_step: f32,
    pub sky: [f32; 3],
    pub shadow_levels: f32,
    pub ground: [f32; 3],
    pub fade_width: f32,
    pub sun_from_relative: [[f32; 4]; 4],
    pub zenith: [f32; 3],
    pub reserved_2: u32,
    pub horizon: [f32; 3],
    pub scene_radius: f32,
    pub to_sky: [f32; 3],
    pub sky_scale: f32,
    pub sky_depth_step: f32,
    pub sky_levels: f32,
    pub sky_weight: f32,
    pub sky_spread: f32,
    pub sky_from_relative: [[f32; 4]; 4],
    pub fade: [f32; 4],
}

/// `pass/sprite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SpriteStage {
    pub region: Region,
    pub pixels_per_texel: [f32; 2],
    pub origin: [f32; 2],
    pub clip_scale: [f32; 2],
    pub clip_shift: [f32; 2],
    pub leaves: [u32; 4],
}

/// `lib/lens-sprite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SpritePlace {
    pub origin: [i32; 2],
    pub size: [i32; 2],
    pub texels_per_pixel: [f32; 2],
    pub sprite: [f32; 2],
    pub page: u32,
    pub first: u32,
    pub width: u32,
    pub layers: u32,
    pub kind: u32,
    pub near: f32,
    pub far: f32,
    pub own: u32,
}

/// `pass/stored-sprite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct StoredStage {
    pub view: View,
    pub region: Region,
    pub pixels_per_texel: [f32; 2],
    pub origin: [f32; 2],
    pub width: u32,
    pub height: u32,
    pub layers: u32,
    pub first: u32,
    pub kind: u32,
    pub near: f32,
    pub far: f32,
    pub first_list: u32,
    pub excess: u32,
    /// A struct that holds a vector takes a multiple of 16 bytes.
    pub pad_0: [u32; 3],
}

/// `pass/sprite-list.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ListStage {
    pub view: View,
    pub region: Region,
    pub clip_scale: [f32; 2],
    pub clip_shift: [f32; 2],
    pub width: u32,
    pub height: u32,
    pub first_list: u32,
    pub leaf: u32,
    pub room: u32,
    pub pad_0: [u32; 3],
}

/// `lib/cities.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct City {
    pub linear: [[f32; 4]; 3],
    pub from_whole: [i32; 3],
    pub number: u32,
    pub from_fraction: [f32; 3],
    pub first_surface: u32,
    pub to: [f32; 3],
    pub scale: f32,
}

/// `lib/bent-rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RayLens {
    pub center: [f32; 2],
    pub radius: f32,
    pub border: f32,
    pub distance: f32,
    pub until: f32,
    pub power: f32,
    pub kind: u32,
    pub outline: u32,
    pub first_knot: u32,
    pub knots: u32,
    pub angle: f32,
    pub color: [f32; 3],
    pub grid: f32,
}

/// `lib/bent-rays.wgsl`: of a lens that has a field in place of an outline.
pub const OUTLINE_FIELD: u32 = 2;
/// `lib/bent-rays.wgsl`: kinds of lenses that bend rays.
pub const RAY_PLANE: u32 = 0;
/// `lib/bent-rays.wgsl`.
pub const RAY_SAMPLED: u32 = 1;
/// `lib/bent-rays.wgsl`.
pub const RAY_ANGULAR: u32 = 2;
/// `lib/bent-rays.wgsl`.
pub const RAY_HEMISPHERICAL: u32 = 3;
/// `lib/bent-rays.wgsl`.
pub const RAY_OWN: u32 = 4;

/// `lib/bent-rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RayEvent {
    pub distance: f32,
    pub lens: u32,
    pub ends: u32,
    pub reserved: u32,
}

/// Lenses that bend rays, and what they have of knots.
const RAY_LENSES: usize = crate::shader::MOST_RAY_LENSES;
const RAY_KNOTS: usize = RAY_LENSES * crate::lens::ray::SAMPLED_KNOTS;

/// `lib/bent-rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RayLenses {
    pub images: u32,
    pub planes: u32,
    pub events: u32,
    pub stretch: f32,
    pub followed: u32,
    pub warped: u32,
    pub moved: u32,
    pub pad_0: u32,
    pub chosen: [[u32; 4]; 2],
    pub lenses: [RayLens; RAY_LENSES],
    pub along: [RayEvent; 2 * RAY_LENSES],
    pub knots: [[f32; 4]; RAY_KNOTS],
}

/// Images that pixels look into: `pass/ray-warp.wgsl`.
const RAY_SOURCES: usize = crate::render::ray_sources::MOST_SOURCES;

/// `pass/ray-warp.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RaySource {
    pub turn_x: [f32; 4],
    pub turn_y: [f32; 4],
    pub turn_z: [f32; 4],
    pub texel: [f32; 4],
    pub size: [f32; 2],
    pub reserved: [f32; 2],
}

/// `pass/ray-warp.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RaySources {
    pub count: u32,
    pub pad_0: [u32; 3],
    pub all: [RaySource; RAY_SOURCES],
}

/// `lib/fields.wgsl`: what a ray makes of a field.
pub const FIELD_DIRECT: u32 = 0;
/// `lib/fields.wgsl`.
pub const FIELD_ABSORBS: u32 = 1;
/// `lib/fields.wgsl`.
pub const FIELD_SURFACE: u32 = 2;
/// `lib/fields.wgsl`.
pub const FIELD_MAXIMUM: u32 = 3;
/// `lib/fields.wgsl`.
pub const FIELD_MINIMUM: u32 = 4;
/// `lib/fields.wgsl`.
pub const FIELD_MEAN: u32 = 5;
/// `lib/fields.wgsl`: its light acts on it.
pub const FIELD_LIT: u32 = 1;
/// `lib/fields.wgsl`.
pub const FIELD_SHADOWED: u32 = 2;
/// `lib/fields.wgsl`.
pub const FIELD_LABELS: u32 = 4;
/// `lib/fields.wgsl`.
pub const FIELD_STEEP: u32 = 8;
/// `lib/fields.wgsl`: its surface is a plane across its first axis; the next two bits say across its second and its third.
pub const FIELD_SLICE: u32 = 16;
/// `lib/fields.wgsl`: lenses take nothing of it away.
pub const FIELD_KEPT: u32 = 128;

/// `lib/fields.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Field {
    pub to_x: [f32; 4],
    pub to_y: [f32; 4],
    pub to_z: [f32; 4],
    pub low: [f32; 3],
    pub mode: u32,
    pub high: [f32; 3],
    pub flags: u32,
    pub last: [f32; 3],
    pub first_slice: u32,
    pub scale: f32,
    pub shift: f32,
    pub level: f32,
    pub steepest: f32,
    pub thickness: f32,
    pub first_brick: u32,
    pub ramp: u32,
    pub object: u32,
    pub begin_hour: i32,
    pub begin_micro: u32,
    pub end_hour: i32,
    pub end_micro: u32,
}

/// Fields of a picture, and the entries of their ramps.
const FIELDS: usize = crate::scene::volume::MOST_VOLUMES;
const FIELD_ENTRIES: usize = FIELDS * crate::scene::volume::RAMP_ENTRIES;

/// `lib/fields.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct FieldTable {
    pub count: u32,
    pub is_jittered: u32,
    pub step: f32,
    pub reserved: f32,
    pub each: [Field; FIELDS],
    pub ramps: [[f32; 4]; FIELD_ENTRIES],
}

/// `pass/rays.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RayCity {
    pub from_view_x: [f32; 4],
    pub from_view_y: [f32; 4],
    pub from_view_z: [f32; 4],
    pub eye: [i32; 3],
    pub surfaces: u32,
    pub eye_fraction: [f32; 3],
    pub number: u32,
    pub eye_in_boxes: [f32; 3],
    pub boxes: u32,
    pub triangles: u32,
    pub pad_0: [u32; 3],
    pub world_x: [f32; 4],
    pub world_y: [f32; 4],
    pub world_z: [f32; 4],
}

/// `pass/lines.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LineStage {
    pub width: f32,
    pub step: u32,
    pub drawn: u32,
    pub reserved: u32,
}

/// `pass/filter.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct FilterStage {
    pub step: [i32; 2],
    pub reach: i32,
    pub first: u32,
    pub length: i32,
    pub layers: i32,
    pub layer: i32,
    pub pad_0: u32,
}

/// `shader::uber`: one entry of the invoker table, as the GPU keeps it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PackedInvoker {
    pub place: u32,
    pub call: u32,
    pub slots: u32,
    pub number: u32,
}

/// An entry of the invoker table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Invoker {
    pub handler: u32,
    pub scope: u32,
    pub first_volume: u32,
    pub volumes: u32,
    pub parameters: u32,
    pub blend: u32,
    pub weight: u32,
    /// What a style acts on, what a handler is to lines, how a content is clipped.
    pub kind: u32,
    /// Of a lens: its bit in the masks.
    pub number: u32,
    pub border: u32,
}

// What `shader::uber` reads of the bits of an invoker.
const _: () = assert!(MOST_VOLUMES < 1 << 11 && MOST_SLOTS < 1 << 13 && MOST_HANDLERS <= 1 << 13);

impl Invoker {
    /// Few words: on software adapters an invoker costs the words that are read of it.
    pub fn packed(&self) -> PackedInvoker {
        PackedInvoker {
            place: self.scope | self.first_volume << 3 | self.volumes << 14,
            call: self.handler | self.parameters << 13 | self.blend << 26 | self.kind << 29,
            slots: self.weight | self.border << 16,
            number: self.number,
        }
    }
}

/// `pass/narrow.wgsl`: where an invoker may act, in x, y and distance: from and to, two halves of a word each.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Reach {
    pub x: u32,
    pub y: u32,
    pub distance: u32,
}

impl Reach {
    /// Everywhere.
    pub const EVERYWHERE: Self = Self { x: 0x7c00_fc00, y: 0x7c00_fc00, distance: 0x7c00_fc00 };

    /// In a box of x, y and distance, metres; rounded outwards.
    pub fn of([low, high]: &[glam::DVec3; 2]) -> Self {
        let word = |low: f64, high: f64| u32::from(half_above(-low) ^ 0x8000) | u32::from(half_above(high)) << 16;
        Self { x: word(low.x, high.x), y: word(low.y, high.y), distance: word(low.z, high.z) }
    }
}

/// The bits of the least number of half precision that is not less; infinity above 65504.
fn half_above(number: f64) -> u16 {
    let size = number.abs();
    // Steps of 2^-24 below 2^-14, of 2^-10 of a power of two above.
    let exponent = size.clamp(1.0 / 16_384.0, 65_536.0).log2().floor();
    let steps = size.min(65_536.0) * (10.0 - exponent).exp2();
    let whole = if number < 0.0 { steps.floor() } else { steps.ceil() };
    // From the steps of one power of two to those of the next the bits go on.
    let bits = (whole as u32 + ((exponent + 14.0) as u32) * 1024).min(0x7c00) as u16;
    if number < 0.0 { bits.min(0x7bff) | 0x8000 } else { bits }
}

/// `pass/furniture.wgsl`, per instance.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct FurnitureItem {
    pub low: [f32; 2],
    pub high: [f32; 2],
    pub color: [f32; 4],
    pub halo: [f32; 4],
    pub radius: f32,
    pub softness: f32,
    pub first_texel: u32,
    pub row_texels: u32,
    pub part: [f32; 4],
}

/// A corner of a context line.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct StripVertex {
    pub at: [f32; 2],
    pub across: f32,
    pub half_width: f32,
    pub along: f32,
    pub length: f32,
    pub ends: [f32; 2],
    pub color: [f32; 4],
    pub fade: [f32; 4],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geom::shape::VolumeForm,
        shader::{DeformPlan, LensTest, Module, Plan, PlanLens, Program, Uber},
    };

    type Fields = Vec<(&'static str, usize)>;

    macro_rules! host {
        ($t:ty { $($f:ident),* $(,)? }) => {
            (stringify!($t), size_of::<$t>(), vec![$((stringify!($f), std::mem::offset_of!($t, $f))),*] as Fields)
        };
    }

    /// Differences between a host struct and the WGSL struct of its name; host padding (`pad_*`) has no WGSL member.
    fn differences(module: &Module, (name, size, fields): (&str, usize, Fields)) -> Vec<String> {
        let source = module.source();
        let parsed = wgpu::naga::front::wgsl::parse_str(&source).expect("valid WGSL");
        let found = parsed.types.iter().find_map(|(_, t)| match &t.inner {
            wgpu::naga::TypeInner::Struct { members, span } if t.name.as_deref() == Some(name) => {
                Some((members.clone(), *span as usize))
            }
            _ => None,
        });
        let Some((members, span)) = found else { return vec![format!("no WGSL struct {name}")] };
        let mut wrong = Vec::new();
        if span != size {
            wrong.push(format!("{name}: {size} bytes on the host, {span} in WGSL"));
        }
        let host: Fields = fields.into_iter().filter(|(f, _)| !f.starts_with("pad_")).collect();
        let wgsl: Vec<(String, usize)> =
            members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
        for i in 0..host.len().max(wgsl.len()) {
            let (h, w) = (host.get(i), wgsl.get(i));
            if h.map(|(n, o)| (*n, *o)) != w.map(|(n, o)| (n.as_str(), *o)) {
                wrong.push(format!("{name}, member {i}: host {h:?}, WGSL {w:?}"));
            }
        }
        wrong
    }

    #[test]
    fn halves_are_the_next_ones_above() {
        let number = |bits: u16| {
            let (size, exponent) = (f64::from(bits & 0x3ff), i32::from(bits >> 10 & 31));
            let size = match exponent {
                31 => f64::INFINITY,
                0 => size * 2_f64.powi(-24),
                _ => (1024.0 + size) * 2_f64.powi(exponent - 25),
            };
            if bits & 0x8000 == 0 { size } else { -size }
        };
        // In ascending order, minus zero left out.
        let all: Vec<u16> = (0x8001..0xfc00).rev().chain(0..=0x7c00).collect();
        for pair in all.windows(2) {
            let [below, above] = [number(pair[0]), number(pair[1])];
            let between = if above.is_finite() { 0.5 * (below + above) } else { 1e300 };
            for inside in [above, between, below + 1e-9 * (above.min(1e5) - below)] {
                assert_eq!(number(half_above(inside)), above, "{inside} is above {below}");
            }
        }
        assert_eq!(number(half_above(-1e300)), -65504.0);
        let [low, high] = [glam::DVec3::NEG_INFINITY, glam::DVec3::INFINITY];
        assert_eq!(Reach::of(&[low, high]), Reach::EVERYWHERE);
    }

    #[test]
    fn host_and_wgsl_structs_are_the_same() {
        let lens = PlanLens { number: 0, volumes: vec![LensTest::Sprite], leaves: vec![], body: None, border: None };
        let content = crate::shader::PlanContent {
            lens: 0,
            class: crate::shader::ClassTest::Inside,
            city: 1,
            clip: Default::default(),
            keeps_terrain: false,
        };
        let cut = Plan { lenses: vec![lens.clone()], contents: vec![content], ..Plan::default() };
        let cut = Module::Geometry(Some(Program::Specialised(cut)));
        let shade = Module::Shade(Program::Specialised(Plan { lenses: vec![lens], ..Plan::default() }));
        let blur = crate::shader::effect::number_of("blur").expect("there is one");
        let uber = Module::Shade(Program::Uber(Uber::default()));
        let rays = Module::Rays(None, crate::shader::Bends { images: 1, planes: 1, ..crate::shader::Bends::default() });
        let warp = Module::RayWarp(crate::shader::Bends { images: 1, planes: 1, ..crate::shader::Bends::default() });
        let fields = Module::Composite(Program::Specialised(Plan { fields: true, ..Plan::default() }));
        let checks = [
            (
                &Module::Geometry(None),
                host!(View {
                    view_from_world,
                    projection,
                    across_from_pixel,
                    near,
                    far,
                    orthographic,
                    sample_index,
                    eye_whole,
                    first_pixel,
                    eye_fraction,
                    pad_0,
                    size,
                    haze,
                    pad_1
                }),
            ),
            (&Module::Sprite, host!(Region { a, test, b, c, d })),
            (
                &shade,
                host!(Light {
                    to_sun,
                    shadow_scale,
                    sun,
                    shadow_depth_step,
                    sky,
                    shadow_levels,
                    ground,
                    fade_width,
                    sun_from_relative,
                    zenith,
                    reserved_2,
                    horizon,
                    scene_radius,
                    to_sky,
                    sky_scale,
                    sky_depth_step,
                    sky_levels,
                    sky_weight,
                    sky_spread,
                    sky_from_relative,
                    fade
                }),
            ),
            (&Module::Sprite, host!(SpriteStage { region, pixels_per_texel, origin, clip_scale, clip_shift, leaves })),
            (&Module::Filter(blur), host!(FilterStage { step, reach, first, length, layers, layer, pad_0 })),
            (&uber, host!(PackedInvoker { place, call, slots, number })),
            (&Module::Narrow, host!(Reach { x, y, distance })),
            (&Module::Refine(DeformPlan::default()), host!(Corner { cell, source, weights, pad_0 })),
            (&Module::Refine(DeformPlan::default()), host!(Triangle { a, b, c, source, edges })),
            (
                &Module::Refine(DeformPlan::default()),
                host!(Refinement {
                    eye,
                    items,
                    eye_offset,
                    corners,
                    forward,
                    pixels,
                    near,
                    orthographic,
                    tolerance,
                    shortest,
                    anchor,
                    shift,
                    met,
                    chunks,
                    lift,
                    narrowest,
                    is_smooth,
                    asked,
                    pad_0,
                }),
            ),
            (
                &rays,
                host!(RayLens {
                    center,
                    radius,
                    border,
                    distance,
                    until,
                    power,
                    kind,
                    outline,
                    first_knot,
                    knots,
                    angle,
                    color,
                    grid
                }),
            ),
            (&rays, host!(RayEvent { distance, lens, ends, reserved })),
            (&warp, host!(RaySource { turn_x, turn_y, turn_z, texel, size, reserved })),
            (&warp, host!(RaySources { count, pad_0, all })),
            (
                &rays,
                host!(RayLenses {
                    images,
                    planes,
                    events,
                    stretch,
                    followed,
                    warped,
                    moved,
                    pad_0,
                    chosen,
                    lenses,
                    along,
                    knots
                }),
            ),
            (
                &rays,
                host!(RayCity {
                    from_view_x,
                    from_view_y,
                    from_view_z,
                    eye,
                    surfaces,
                    eye_fraction,
                    number,
                    eye_in_boxes,
                    boxes,
                    triangles,
                    pad_0,
                    world_x,
                    world_y,
                    world_z
                }),
            ),
            (
                &fields,
                host!(Field {
                    to_x,
                    to_y,
                    to_z,
                    low,
                    mode,
                    high,
                    flags,
                    last,
                    first_slice,
                    scale,
                    shift,
                    level,
                    steepest,
                    thickness,
                    first_brick,
                    ramp,
                    object,
                    begin_hour,
                    begin_micro,
                    end_hour,
                    end_micro
                }),
            ),
            (&fields, host!(FieldTable { count, is_jittered, step, reserved, each, ramps })),
            (&cut, host!(City { linear, from_whole, number, from_fraction, first_surface, to, scale })),
            (
                &shade,
                host!(SpritePlace {
                    origin,
                    size,
                    texels_per_pixel,
                    sprite,
                    page,
                    first,
                    width,
                    layers,
                    kind,
                    near,
                    far,
                    own
                }),
            ),
            (
                &Module::StoredForm(VolumeForm::Sphere),
                host!(StoredStage {
                    view,
                    region,
                    pixels_per_texel,
                    origin,
                    width,
                    height,
                    layers,
                    first,
                    kind,
                    near,
                    far,
                    first_list,
                    excess,
                    pad_0
                }),
            ),
            (
                &Module::SpriteList,
                host!(ListStage { view, region, clip_scale, clip_shift, width, height, first_list, leaf, room, pad_0 }),
            ),
            (&Module::Furniture, host!(StripVertex { at, across, half_width, along, length, ends, color, fade })),
            (
                &Module::Furniture,
                host!(FurnitureItem { low, high, color, halo, radius, softness, first_texel, row_texels, part }),
            ),
        ];
        let wrong: Vec<String> = checks.into_iter().flat_map(|(module, fields)| differences(module, fields)).collect();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
