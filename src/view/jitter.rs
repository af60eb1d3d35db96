//! Where in a pixel the samples lie.

use glam::DVec2;

/// Offset of sample `i` from the pixel's centre, pixels in -½..½; sample 0 is the centre itself, as AOVs need it.
///
/// R2, the additive sequence of the plastic number (M. Roberts, "The unreasonable effectiveness of quasirandom
/// sequences", 2018): any first N samples are spread evenly, so a static view can stop or go on at any count.
pub fn jitter_px(i: u32) -> DVec2 {
    // 1/p and 1/p² with p³ = p + 1.
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_2);
    (f64::from(i) * STEP + 0.5).fract() - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_is_the_centre_and_all_stay_in_the_pixel() {
        assert_eq!(jitter_px(0), DVec2::ZERO);
        for i in 0..100_000 {
            let j = jitter_px(i);
            assert!(j.cmpge(DVec2::splat(-0.5)).all() && j.cmplt(DVec2::splat(0.5)).all(), "{i}: {j}");
        }
    }

    #[test]
    fn sixty_four_samples_fill_a_four_by_four_grid() {
        let mut cells = [0; 16];
        for i in 0..64 {
            let cell = ((jitter_px(i) + 0.5) * 4.0).as_uvec2();
            cells[(cell.y * 4 + cell.x) as usize] += 1;
        }
        assert!(cells.iter().all(|n| (2..=6).contains(n)), "{cells:?}");
    }
}
