//! Colours: sRGB as people write them, OKLab as they see them.
//!
//! OKLab: B. Ottosson, "A perceptual color space for image processing" (2020); equal steps look about equal.

/// sRGB, each 0..1.
pub type Srgb = [f32; 3];

/// Reads `#rrggbb` or `#rgb`.
pub fn parse_hex(text: &str) -> Option<Srgb> {
    let digits = text.strip_prefix('#')?;
    if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let channel = |at: std::ops::Range<usize>| u8::from_str_radix(digits.get(at)?, 16).ok();
    match digits.len() {
        6 => Some([channel(0..2)?, channel(2..4)?, channel(4..6)?].map(|c| f32::from(c) / 255.0)),
        3 => Some([channel(0..1)?, channel(1..2)?, channel(2..3)?].map(|c| f32::from(c * 17) / 255.0)),
        _ => None,
    }
}

/// Writes `#rrggbb`, rounding to 8 bits.
pub fn to_hex(color: Srgb) -> String {
    let [r, g, b] = color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Linear light of an sRGB colour (IEC 61966-2-1).
pub fn linear_from_srgb(color: Srgb) -> [f32; 3] {
    color.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

/// sRGB of linear light, clamped to 0..1.
pub fn srgb_from_linear(color: [f32; 3]) -> Srgb {
    color.map(|c| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
    })
}

/// OKLab (lightness 0..1, green–red, blue–yellow) of linear light.
pub fn oklab_from_linear([r, g, b]: [f32; 3]) -> [f32; 3] {
    let l = (0.412_221_47 * r + 0.536_332_55 * g + 0.051_445_995 * b).cbrt();
    let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
    let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Linear light of an OKLab colour; channels outside 0..1 are colours a screen does not have.
pub fn linear_from_oklab([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}

/// Linear light 0..1 of an OKLab colour: of its lightness and hue, and of its chroma as much as a screen has. Twin of `linear_in_gamut` in
/// `lib/color.wgsl`.
pub fn linear_in_gamut([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let of_chroma = |share: f32| linear_from_oklab([lightness, share * a, share * b]);
    let whole = of_chroma(1.0);
    if is_in_gamut(whole) {
        return whole.map(|c| c.clamp(0.0, 1.0));
    }
    let (mut low, mut step) = (0.0, 0.5);
    for _ in 0..CHROMA_STEPS {
        low += if is_in_gamut(of_chroma(low + step)) { step } else { 0.0 };
        step *= 0.5;
    }
    of_chroma(low).map(|c| c.clamp(0.0, 1.0))
}

/// Halvings by which the chroma that a screen has is found: to a 512th of it.
const CHROMA_STEPS: u32 = 9;
/// What rounding makes of the colours at the border.
const GAMUT_SLACK: f32 = 1e-5;

fn is_in_gamut(linear: [f32; 3]) -> bool {
    linear.iter().all(|c| (-GAMUT_SLACK..=1.0 + GAMUT_SLACK).contains(c))
}

/// OKLab of an sRGB colour.
pub fn oklab_from_srgb(color: Srgb) -> [f32; 3] {
    oklab_from_linear(linear_from_srgb(color))
}

/// From `a` (t = 0) to `b` (t = 1), evenly to the eye; exact at both ends.
pub fn mixed(a: Srgb, b: Srgb, t: f32) -> Srgb {
    if t <= 0.0 {
        return a;
    }
    if t >= 1.0 {
        return b;
    }
    let (p, q) = (oklab_from_srgb(a), oklab_from_srgb(b));
    srgb_from_linear(linear_from_oklab(std::array::from_fn(|i| p[i] + (q[i] - p[i]) * t)))
}

/// How far two colours look apart: 0 alike, about 0.02 just seen side by side, 1 black to white.
pub fn difference(a: Srgb, b: Srgb) -> f32 {
    let (p, q) = (oklab_from_srgb(a), oklab_from_srgb(b));
    (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twin of `cube_root` in `lib/color.wgsl`.
    fn cube_root(x: f32) -> f32 {
        let some = x.max(1e-18);
        let inverse = f32::from_bits(1_419_900_000 - (some.to_bits() as f32 * (1.0 / 3.0)) as u32);
        let part = some * inverse;
        let off = 1.0 - part * (inverse * inverse);
        let off2 = off * off;
        part * inverse
            * ((1.0 + 0.666_652_1 * off) + ((0.555_533_95 + 0.499_399_93 * off) + 0.458_729_24 * off2) * off2)
    }

    /// Twin of `linear_from_srgb` there.
    fn polynomial_linear(c: f32) -> f32 {
        let c2 = c * c;
        let low = (0.000_875_111_5 + 0.034_492_476 * c) + (0.496_140_2 + 0.795_216 * c) * c2;
        let high = (-0.639_369_67 + 0.511_841_3 * c) + (-0.255_237_43 + 0.056_043_09 * c) * c2;
        if c <= 0.040_45 { c * (1.0 / 12.92) } else { (low + high * (c2 * c2)).min(1.0) }
    }

    /// Twin of `srgb_from_linear` there.
    fn polynomial_srgb(c: f32) -> f32 {
        let square = c.sqrt();
        let root = square.sqrt();
        let low = (-0.059_641_75 + 0.140_776_78 * root) + (1.360_225_6 - 0.838_965_36 * root) * square;
        let high = (0.638_769_45 - 0.306_036_98 * root) + 0.064_873_32 * square;
        if c <= 0.003_130_8 { 12.92 * c } else { (low + high * c).min(1.0) }
    }

    #[test]
    fn the_polynomials_of_shaders_are_srgb() {
        for step in 0..=100_000_u32 {
            let c = f64::from(step) / 100_000.0;
            let linear = if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
            assert!((f64::from(polynomial_linear(c as f32)) - linear).abs() <= 2.5e-6, "{c}");
            let srgb = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
            assert!((f64::from(polynomial_srgb(c as f32)) - srgb).abs() <= 2e-6, "{c}");
        }
        for byte in 0..=255_u8 {
            let back = polynomial_srgb(polynomial_linear(f32::from(byte) / 255.0)) * 255.0;
            assert!((back - f32::from(byte)).abs() < 0.01, "{byte} became {back}");
        }
    }

    #[test]
    fn the_cube_root_of_shaders_is_right_to_its_sixth_digit() {
        for step in 0..200_000 {
            let x = 10.0_f64.powf(f64::from(step) * 1e-4 - 18.0) as f32;
            let exact = f64::from(x).cbrt();
            assert!((f64::from(cube_root(x)) / exact - 1.0).abs() <= 6e-7, "{x}");
        }
        for small in [0.0, 1e-38, 1e-20, 9e-19] {
            assert!((f64::from(cube_root(small)) - f64::from(small).cbrt()).abs() < 1.1e-6, "{small}");
        }
    }

    #[test]
    fn what_filters_read_is_right_to_a_fraction_of_a_byte() {
        // Twins of `packed` and `unpacked` in `lib/packed.wgsl`, one channel of so many levels.
        let rounded = |linear: f32, levels: f32| {
            let root = (levels * linear.sqrt() + 0.5).floor() * (1.0 / levels);
            root * root
        };
        for step in 0..=100_000 {
            let linear = step as f32 / 100_000.0;
            for (levels, most) in [(2047.0, 0.09), (1023.0, 0.18)] {
                let [exact, _, found] = srgb_from_linear([linear, 0.0, rounded(linear, levels)]);
                assert!((exact - found).abs() * 255.0 <= most, "{linear}: {found}, not {exact}");
            }
        }
    }

    #[test]
    fn hex_is_read_and_written() {
        assert_eq!(parse_hex("#ff8000"), Some([1.0, 128.0 / 255.0, 0.0]));
        assert_eq!(parse_hex("#f80"), Some([1.0, 136.0 / 255.0, 0.0]));
        for wrong in ["ff8000", "#ff800", "#gg0000", "#", "red", "#ü8000", "#+1+1+1"] {
            assert_eq!(parse_hex(wrong), None, "{wrong}");
        }
        for value in [0_u32, 0x12_34_56, 0xff_ff_ff, 0x80_01_fe] {
            let text = format!("#{value:06x}");
            assert_eq!(to_hex(parse_hex(&text).unwrap()), text);
        }
    }

    #[test]
    fn oklab_is_ottossons() {
        // His published table: white and linear red.
        let close = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-3);
        assert!(close(oklab_from_srgb([1.0; 3]), [1.0, 0.0, 0.0]));
        assert!(close(oklab_from_linear([1.0, 0.0, 0.0]), [0.628, 0.225, 0.126]));
        for i in 0..512_u32 {
            let c = [i & 7, i >> 3 & 7, i >> 6].map(|c| c as f32 / 7.0);
            let back = srgb_from_linear(linear_from_oklab(oklab_from_srgb(c)));
            assert!(close(c, back), "{c:?} became {back:?}");
        }
    }
}
