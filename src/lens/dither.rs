//! Ordered dithering: how what is there or not comes and goes gradually.

/// Interleaved gradient noise's weights of x and y, and what their sum is multiplied by (Jimenez 2014).
const WEIGHTS: [f64; 3] = [0.067_110_56, 0.005_837_15, 52.982_918_9];

/// The golden ratio's fraction: the least even of all steps.
const STEP: f64 = 0.618_033_988_749_895;

/// The threshold of a picture's pixel for a sample, in the open interval 0..1: what has a share of the pixel is there where its
/// share is greater. Twin of `dither` in `lib/dither.wgsl`, to the bit.
pub fn dither(pixel: [u32; 2], sample: u32) -> f32 {
    let fraction = |of: f64| (of.fract() * 2_f64.powi(32)).round() as u32;
    let [x, y, scale] = WEIGHTS;
    let slope = pixel[0].wrapping_mul(fraction(x)).wrapping_add(pixel[1].wrapping_mul(fraction(y)));
    // The fraction of the scale to 16 bits, of a slope of 16 bits: what fits a word.
    let part = (scale.fract() * 65_536.0).round() as u32;
    let noise = slope.wrapping_mul(scale as u32).wrapping_add((slope >> 16) * part);
    let threshold = noise.wrapping_add(sample.wrapping_mul(fraction(STEP)));
    ((threshold >> 8) | 1) as f32 * 2_f32.powi(-24)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_spread_evenly_over_a_picture_and_over_the_samples_of_a_pixel() {
        for share in [0.0, 0.125, 0.3, 0.5, 0.9, 1.0_f32] {
            for corner in [[0, 0], [16_000, 3], [4000, 12_345]] {
                let pixels = (0..64 * 64).map(|i| [corner[0] + i % 64, corner[1] + i / 64]);
                let there = pixels.clone().filter(|&pixel| share > dither(pixel, 0)).count();
                let error = there as f32 / 4096.0 - share;
                assert!(error.abs() < 0.01, "{there} of 4096 at {share}");
                // A low-discrepancy sequence: the mean of n samples is right to about 1/n.
                for pixel in pixels {
                    let there = (0..16).filter(|&sample| share > dither(pixel, sample)).count();
                    assert!((there as f32 / 16.0 - share).abs() < 0.13, "{there} of 16 at {share}");
                }
            }
        }
    }

    #[test]
    fn it_is_interleaved_gradient_noise() {
        for pixel in [[0, 0], [1, 0], [0, 1], [37, 991], [3000, 2000]] {
            let [x, y, scale] = WEIGHTS;
            let noise = (scale * (x * f64::from(pixel[0]) + y * f64::from(pixel[1])).fract()).fract();
            let away = (f64::from(dither(pixel, 0)) - noise).abs();
            // The weights are rounded to 32 bits, the scaled slope to 16.
            assert!(away.min(1.0 - away) < 2e-4, "{pixel:?}: {away}");
        }
    }
}
