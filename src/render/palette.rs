//! Quiet colours for surfaces that bring none of their own: by semantics first, then by kind of object.
//!
//! sRGB bytes. Chosen so that roofs carry the picture, walls stay paper-like, and a lens' colours win.

use crate::city::{CityModel, NONE, ObjectClass, StringId, Surface};

/// The clay of the plain ground.
pub const PLAIN_GROUND: [u8; 3] = [203, 204, 192];

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_linear_light() {
        for byte in 0..=255_u8 {
            let [there, ..] = linear([f32::from(byte) / 255.0; 3]);
            assert_eq!(srgb_bytes([there; 3]), [byte; 3]);
        }
    }
}
