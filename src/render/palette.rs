//! Quiet colours for surfaces that bring none of their own: by semantics first, then by kind of object.
//!
//! sRGB bytes. Chosen so that roofs carry the picture, walls stay paper-like, and a lens' colours win.

use crate::city::{CityModel, NONE, ObjectClass, StringId, Surface};

/// The clay of the plain ground.
pub const PLAIN_GROUND: [u8; 3] = [203, 204, 192];

/// The clay of `base = "clay"`, linear light: that of `lib/point.wgsl`.
pub const CLAY: [f32; 3] = [0.62, 0.585, 0.54];

const ROOF: [u8; 3] = [190, 122, 96];
const FLAT_PART: [u8; 3] = [200, 188, 176];
const WALL: [u8; 3] = [233, 226, 214];
const FOOTPRINT: [u8; 3] = [205, 198, 186];
const WINDOW: [u8; 3] = [126, 152, 172];
const DOOR: [u8; 3] = [134, 104, 80];
const TERRAIN: [u8; 3] = [190, 201, 166];
const WATER: [u8; 3] = [158, 190, 211];
const ROAD: [u8; 3] = [197, 195, 191];
const PLANT: [u8; 3] = [142, 173, 116];
const LAND: [u8; 3] = [205, 208, 184];
const CONSTRUCTION: [u8; 3] = [205, 200, 192];
const OTHER: [u8; 3] = [214, 208, 198];
const BUILDING: [u8; 3] = [226, 217, 203];

/// Colour of a surface without a material.
pub fn natural(model: &CityModel, surface: &Surface) -> [u8; 3] {
    let class = model.objects[surface.object as usize].class;
    let kind = (surface.kind != StringId(NONE)).then(|| model.strings.get(surface.kind));
    match kind {
        Some("RoofSurface") => ROOF,
        Some("OuterFloorSurface" | "OuterCeilingSurface") => FLAT_PART,
        Some("WallSurface" | "InteriorWallSurface" | "ClosureSurface") => WALL,
        Some("GroundSurface" | "FloorSurface" | "CeilingSurface") if class == ObjectClass::Building => FOOTPRINT,
        Some("Window" | "WindowSurface") => WINDOW,
        Some("Door" | "DoorSurface") => DOOR,
        Some("WaterSurface" | "WaterGroundSurface") => WATER,
        Some("AuxiliaryTrafficArea") => LAND,
        _ => match class {
            ObjectClass::Building => BUILDING,
            ObjectClass::Terrain => TERRAIN,
            ObjectClass::Water => WATER,
            ObjectClass::Road => ROAD,
            ObjectClass::Vegetation => PLANT,
            ObjectClass::Land => LAND,
            ObjectClass::Construction => CONSTRUCTION,
            ObjectClass::Other => OTHER,
        },
    }
}

/// sRGB bytes of linear light, 0..1.
pub fn srgb_bytes(linear: [f32; 3]) -> [u8; 3] {
    linear.map(|c| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

/// Linear light of sRGB 0..1.
pub fn linear(srgb: [f32; 3]) -> [f32; 3] {
    srgb.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

/// Linear light of sRGB bytes.
pub fn linear_bytes(srgb: [u8; 3]) -> [f32; 3] {
    linear(srgb.map(|c| f32::from(c) / 255.0))
}

/// The half float nearest to a colour between 0 and 1 (error ≤ 2⁻¹² of it; below 2⁻¹⁴, zero).
pub fn half(value: f32) -> u16 {
    let value = value.clamp(0.0, 1.0);
    if value < 1.0 / 16_384.0 {
        return 0;
    }
    // f32: 8 bits of exponent (bias 127), 23 of mantissa; f16: 5 (bias 15), 10. Rounded, ties away from zero.
    let bits = value.to_bits() + (1 << 12);
    ((bits >> 13) - ((127 - 15) << 10)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_near() {
        let value = |h: u16| 2_f32.powi(i32::from(h >> 10) - 15) * (1.0 + f32::from(h & 0x3ff) / 1024.0);
        for i in 1..=1000 {
            let c = i as f32 / 1000.0;
            assert!((value(half(c)) - c).abs() <= c / 2048.0, "{c}");
        }
        assert_eq!(half(0.0), 0);
    }

    #[test]
    fn clay_is_that_of_shaders() {
        let [r, g, b] = CLAY;
        let line = format!("const CLAY_COLOR = vec3f({r}, {g}, {b});");
        assert!(include_str!("../../shaders/lib/point.wgsl").contains(&line), "{line}");
    }

    #[test]
    fn bytes_survive_linear_light() {
        for byte in 0..=255_u8 {
            let [there, ..] = linear([f32::from(byte) / 255.0; 3]);
            assert_eq!(srgb_bytes([there; 3]), [byte; 3]);
        }
    }
}
