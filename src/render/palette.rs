//! Quiet colours for surfaces that bring none of their own: by semantics first, then by kind of object.
//!
//! sRGB bytes. Chosen so that roofs carry the picture, walls stay paper-like, and a lens' colours win.

use crate::{
    city::{CityModel, NONE, ObjectClass, StringId, Surface},
    lens::color::{linear_from_oklab, oklab_from_linear},
    text,
};

/// The clay of the plain ground.
pub const PLAIN_GROUND: [u8; 3] = [203, 204, 192];

/// The clay of `base = "clay"`, linear light: that of `lib/point.wgsl`.
pub const CLAY: [f32; 3] = [0.62, 0.585, 0.54];

/// Pitched roofs: a tile to each building.
const ROOFS: [[u8; 3]; 8] = [
    [190, 122, 96],
    [181, 113, 90],
    [196, 133, 104],
    [172, 106, 88],
    [186, 126, 103],
    [150, 116, 100],
    [138, 132, 130],
    [121, 122, 128],
];
/// Flat ones.
const FLAT_ROOFS: [[u8; 3]; 3] = [[196, 190, 182], [187, 183, 177], [204, 197, 187]];
const FLAT_PART: [u8; 3] = [200, 188, 176];
const WALLS: [[u8; 3]; 6] =
    [[233, 226, 214], [227, 217, 201], [236, 231, 222], [221, 208, 190], [230, 223, 214], [214, 199, 183]];
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
/// Cosine of the slope up to which a roof is flat: 8°.
const LEAST_FLAT: f64 = 0.99;

/// What a surface is, as far as its colour goes by that, where it says nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facing {
    /// A roof.
    pub is_roof: bool,
    /// A wall.
    pub is_wall: bool,
    /// Level: of a roof, a flat one.
    pub is_level: bool,
}

/// Whether what faces upwards by so much (cosine) is level.
pub fn is_level(up: f64) -> bool {
    up >= LEAST_FLAT
}

/// Colour of a surface without a material. Roofs and walls differ from building to building.
pub fn natural(model: &CityModel, surface: &Surface, facing: Facing) -> [u8; 3] {
    let Facing { is_roof, is_wall, is_level } = facing;
    let class = model.objects[surface.object as usize].class;
    let kind = (surface.kind != StringId(NONE)).then(|| model.strings.get(surface.kind));
    let hash = || hash_of(&model.objects[model.root(surface.object) as usize].id);
    let roof = || if is_level { one_of(&FLAT_ROOFS, hash()) } else { one_of(&ROOFS, hash()) };
    // Walls do not go by the roof.
    let wall = || one_of(&WALLS, hash() >> 20);
    match kind {
        Some("RoofSurface") => roof(),
        Some("OuterFloorSurface" | "OuterCeilingSurface") => FLAT_PART,
        Some("WallSurface" | "InteriorWallSurface" | "ClosureSurface") => wall(),
        Some("GroundSurface" | "FloorSurface" | "CeilingSurface") if class == ObjectClass::Building => FOOTPRINT,
        Some("Window" | "WindowSurface") => WINDOW,
        Some("Door" | "DoorSurface") => DOOR,
        Some("WaterSurface" | "WaterGroundSurface") => WATER,
        Some("AuxiliaryTrafficArea") => LAND,
        _ => match class {
            ObjectClass::Building if is_roof => roof(),
            ObjectClass::Building if is_wall => wall(),
            ObjectClass::Building => FOOTPRINT,
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

/// One of some colours.
fn one_of(colors: &[[u8; 3]], number: u64) -> [u8; 3] {
    colors[(number % colors.len() as u64) as usize]
}

/// A number of an id, the same everywhere, all of whose bits differ from id to id.
fn hash_of(id: &str) -> u64 {
    let hash = text::hash(id);
    (hash ^ hash >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 7
}

/// The chroma (OKLab) up to which colours of materials stay as they are, and what it comes near to at most.
const CALM: f32 = 0.08;
const MOST_CHROMA: f32 = 0.108;
/// The least lightness (OKLab) of a grey, and how much more of it a colour has for its chroma: what is vivid is not dark.
const LEAST_LIGHTNESS: f32 = 0.32;
const LIGHTER: f32 = 2.35;

/// A quieter colour of a material, linear light: of its hue, not as vivid, and not dark.
pub fn tamed(color: [f32; 3]) -> [f32; 3] {
    let [lightness, a, b] = oklab_from_linear(color.map(|c| c.clamp(0.0, 1.0)));
    let chroma = a.hypot(b);
    let room = MOST_CHROMA - CALM;
    let calm = chroma.min(CALM) + room * ((chroma - CALM).max(0.0) / room).tanh();
    let share = if chroma > 0.0 { calm / chroma } else { 1.0 };
    let lightness = lightness.max(LEAST_LIGHTNESS + LIGHTER * calm);
    linear_from_oklab([lightness, share * a, share * b]).map(|c| c.clamp(0.0, 1.0))
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
    fn vivid_materials_are_tamed_and_quiet_ones_stay() {
        for quiet in [[203, 204, 192], [233, 226, 214], [158, 190, 211], [128, 128, 128]] {
            let linear = linear_bytes(quiet);
            assert_eq!(srgb_bytes(tamed(linear)), quiet);
        }
        // The roofs of a well-known city model.
        let [red, green, blue] = srgb_bytes(tamed(linear_bytes([127, 0, 0])));
        assert!(red > 150 && green > 70 && blue > 60, "{red} {green} {blue}");
        for k in 0..512_u32 {
            let color = [k & 7, k >> 3 & 7, k >> 6].map(|c| c as f32 / 7.0);
            let ([before_l, before_a, before_b], [l, a, b]) =
                (oklab_from_linear(color), oklab_from_linear(tamed(color)));
            // Less than a step of a byte is lost where a screen has no such colour.
            assert!(a.hypot(b) < MOST_CHROMA + 0.002 && l > before_l - 0.002, "{color:?}");
            let turned = (before_a * b - before_b * a) / (before_a.hypot(before_b) * a.hypot(b)).max(1e-3);
            assert!(turned.abs() < 0.05, "{color:?} turns by {turned}");
        }
    }

    #[test]
    fn roofs_differ_from_building_to_building() {
        let numbers: Vec<u64> = (0..400).map(|k| hash_of(&format!("NL.IMBAG.Pand.{k:016}"))).collect();
        for (count, shift) in [(ROOFS.len(), 0), (WALLS.len(), 20)] {
            let of = |color: usize| numbers.iter().filter(|n| (**n >> shift) as usize % count == color).count();
            assert!(
                (0..count).all(|color| of(color) > 400 / count / 2),
                "{:?}",
                (0..count).map(of).collect::<Vec<_>>()
            );
        }
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
