//! Every struct that is shared with WGSL, in one place; `tests` compares each, member by member, with
//! the WGSL struct of the same name. What the members mean stands there.
#![expect(missing_docs, reason = "each member is documented once, in its WGSL file")]

use bytemuck::{Pod, Zeroable};

/// `lib/view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct View {
    pub view_from_world: [[f32; 4]; 3],
    pub projection: [f32; 4],
    pub near: f32,
    pub far: f32,
    pub orthographic: u32,
    pub sample_index: u32,
    pub eye_whole: [i32; 3],
    pub pad_0: u32,
    pub eye_fraction: [f32; 3],
    pub pad_1: u32,
    pub size: [f32; 2],
    pub haze: f32,
    pub pad_2: u32,
}

/// `lib/surface.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Surface {
    pub origin: [i32; 3],
    pub object: u32,
    pub color_rg: u32,
    pub color_ba: u32,
    pub flags: u32,
    pub normal: u32,
}

/// `lib/surface.wgsl`: no city object.
pub const NO_OBJECT: u32 = u32::MAX;
/// `lib/surface.wgsl`: light does not act on it.
pub const SURFACE_UNLIT: u32 = 1;

/// `pass/geometry.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Plane {
    pub normal: [f32; 3],
    pub reserved: f32,
    pub origin: [i32; 3],
    pub offset: f32,
}

/// `lib/shape.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Shape {
    pub center: [f32; 3],
    pub kind: u32,
    pub axis_x: [f32; 3],
    pub size_x: f32,
    pub axis_y: [f32; 3],
    pub size_y: f32,
    pub axis_z: [f32; 3],
    pub size_z: f32,
    pub first_plane: u32,
    pub plane_count: u32,
    pub lens: u32,
    pub reserved: u32,
}

/// `lib/shape.wgsl`: kinds of shapes.
pub const SPHERE: u32 = 0;
/// `lib/shape.wgsl`.
pub const BOX: u32 = 1;
/// `lib/shape.wgsl`.
pub const CYLINDER: u32 = 2;
/// `lib/shape.wgsl`.
pub const CONVEX: u32 = 3;

/// `lib/light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Light {
    pub to_sun: [f32; 3],
    pub shadow_texel: f32,
    pub sun: [f32; 3],
    pub shadow_depth_step: f32,
    pub sky: [f32; 3],
    pub reserved_0: f32,
    pub ground: [f32; 3],
    pub reserved_1: f32,
    pub shadow_from_relative: [[f32; 4]; 4],
    pub zenith: [f32; 3],
    pub background: u32,
    pub horizon: [f32; 3],
    pub scene_radius: f32,
}

/// `pass/sprite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SpriteStage {
    pub shape: u32,
    pub pad_0: u32,
    pub pixels_per_texel: [f32; 2],
    pub origin: [f32; 2],
}

/// `pass/lens_mask.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MaskStage {
    pub origin: [u32; 2],
    pub size: [u32; 2],
    pub texels_per_pixel: [f32; 2],
    pub sprite_origin: [f32; 2],
    pub lens: u32,
    pub pad_0: u32,
}

/// `pass/shade.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Parameters {
    pub a: [f32; 4],
    pub b: [f32; 4],
}

/// `pass/shade.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Operation {
    pub effect: u32,
    pub lens: u32,
    pub class_: u32,
    pub reserved: u32,
    pub parameters: Parameters,
}

/// `pass/shade.wgsl`: everywhere, not in a lens.
pub const CONTEXT: u32 = u32::MAX;
/// `pass/shade.wgsl`: draws the lens' silhouette.
pub const OUTLINE: u32 = 0xffff;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::Module;

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
    fn host_and_wgsl_structs_are_the_same() {
        let shade = Module::Shade(vec![]);
        let checks = [
            (
                &Module::Geometry,
                host!(View {
                    view_from_world,
                    projection,
                    near,
                    far,
                    orthographic,
                    sample_index,
                    eye_whole,
                    pad_0,
                    eye_fraction,
                    pad_1,
                    size,
                    haze,
                    pad_2
                }),
            ),
            (&Module::Geometry, host!(Surface { origin, object, color_rg, color_ba, flags, normal })),
            (&Module::Geometry, host!(Plane { normal, reserved, origin, offset })),
            (
                &Module::Sprite,
                host!(Shape {
                    center,
                    kind,
                    axis_x,
                    size_x,
                    axis_y,
                    size_y,
                    axis_z,
                    size_z,
                    first_plane,
                    plane_count,
                    lens,
                    reserved
                }),
            ),
            (
                &shade,
                host!(Light {
                    to_sun,
                    shadow_texel,
                    sun,
                    shadow_depth_step,
                    sky,
                    reserved_0,
                    ground,
                    reserved_1,
                    shadow_from_relative,
                    zenith,
                    background,
                    horizon,
                    scene_radius
                }),
            ),
            (&Module::Sprite, host!(SpriteStage { shape, pad_0, pixels_per_texel, origin })),
            (&Module::LensMask, host!(MaskStage { origin, size, texels_per_pixel, sprite_origin, lens, pad_0 })),
            (&shade, host!(Parameters { a, b })),
            (&shade, host!(Operation { effect, lens, class_, reserved, parameters })),
        ];
        let wrong: Vec<String> = checks.into_iter().flat_map(|(module, fields)| differences(module, fields)).collect();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
