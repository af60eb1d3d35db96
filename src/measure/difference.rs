//! The difference of a picture from its reference.

use serde::Serialize;

use crate::{
    lens::color::linear_from_srgb,
    measure::flip,
    render::{composited::error, picture::Picture},
};

/// A pixel is wrong when one of its channels is off by more than so many of 255 steps: fewer are hard to see, and other
/// drivers round by one.
pub const RIGHT_STEPS: u8 = 2;

/// A picture against its reference. All counts are of pixels; alpha is ignored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels with a channel off by more than [`RIGHT_STEPS`].
    pub wrong_pixels: u64,
    /// Largest difference of a channel, 8-bit steps, 0..255.
    pub max_steps: u8,
    /// Mean difference over all pixels and channels, 8-bit steps.
    pub mean_steps: f64,
    /// Mean FLIP, 0..1 ([`flip::mean`]).
    pub flip: f64,
    /// Pixels that are in a lens in one picture and not in the other; `None` without lens masks.
    pub wrong_mask_pixels: Option<u64>,
    /// Largest and mean error of a channel against layers composited in f64, linear light, 0..1 ([`Against`]).
    pub against_f64: Option<Against>,
}

/// The difference from what is right in f64: of translucent layers over any background from black to white, of light, of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Against {
    /// The largest of all pixels and channels.
    pub max: f64,
    /// Over all of them.
    pub mean: f64,
    /// The root of the mean of its square.
    pub rms: f64,
}

impl Against {
    /// That of what the channels of pixels are off.
    pub fn of(errors: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut sum, mut squares, mut max, mut count) = (0.0, 0.0, 0.0_f64, 0_u64);
        for error in errors.flatten().map(f64::abs) {
            (sum, squares, max, count) = (sum + error, squares + error * error, max.max(error), count + 1);
        }
        let count = count.max(1) as f64;
        Self { max, mean: sum / count, rms: (squares / count).sqrt() }
    }

    /// The difference of what a method laid over its picture.
    pub fn transparency(found: &[[f32; 4]], right: &[[f64; 4]]) -> Self {
        Self::of(found.iter().zip(right).map(|(found, right)| error(found.map(f64::from), *right)))
    }

    /// The difference of pictures, where a method lays nothing over: colours in 8 bits, whose steps are at most 0.009 of linear light.
    pub fn pictures(found: &Picture, right: &Picture) -> Self {
        Self::of(found.rgba.iter().zip(&right.rgba).map(|(found, right)| {
            let (found, right) = (linear_light(*found), linear_light(*right));
            [0, 1, 2].map(|i| (found[i] - right[i]).abs())
        }))
    }
}

/// A pixel in linear light, 0..1.
pub fn linear_light([r, g, b, _]: [u8; 4]) -> [f64; 3] {
    linear_from_srgb([r, g, b].map(|c| f32::from(c) / 255.0)).map(f64::from)
}

impl Difference {
    /// The difference of two pictures of one size.
    pub fn between(reference: &Picture, test: &Picture) -> Self {
        let mut found = Self { pixels: reference.rgba.len() as u64, ..Self::default() };
        let mut sum = 0_u64;
        for (a, b) in reference.rgba.iter().zip(&test.rgba) {
            let steps = [0, 1, 2].map(|k| a[k].abs_diff(b[k]));
            let most = steps[0].max(steps[1]).max(steps[2]);
            found.max_steps = found.max_steps.max(most);
            found.wrong_pixels += u64::from(most > RIGHT_STEPS);
            sum += steps.iter().map(|&s| u64::from(s)).sum::<u64>();
        }
        found.mean_steps = sum as f64 / (3 * found.pixels).max(1) as f64;
        found.flip = flip::mean(reference.size, &reference.rgba, &test.rgba);
        found.wrong_mask_pixels = match (&reference.lens_mask, &test.lens_mask) {
            (Some(a), Some(b)) => Some(wrong_mask_pixels(a, b)),
            _ => None,
        };
        found
    }
}

/// Pixels whose bits differ in any plane.
fn wrong_mask_pixels(a: &[Vec<u32>], b: &[Vec<u32>]) -> u64 {
    let pixels = a.first().map_or(0, Vec::len);
    let differs = |i: &usize| a.iter().zip(b).any(|(a, b)| a.get(*i) != b.get(*i));
    (0..pixels).filter(differs).count() as u64
}

/// Pixels whose lowest bit is not what it should be.
pub fn wrong_bits(right: &[bool], bits: &[u32]) -> u64 {
    right.iter().zip(bits).filter(|(right, bits)| **right != (**bits & 1 == 1)).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: &[[u8; 3]], mask: &[u32]) -> Picture {
        let mut picture = Picture::default();
        picture.size = [pixels.len() as u32, 1];
        picture.rgba = pixels.iter().map(|&[r, g, b]| [r, g, b, 255]).collect();
        picture.lens_mask = Some(vec![mask.to_vec(), vec![0; mask.len()]]);
        picture
    }

    #[test]
    fn differences_counted_by_hand() {
        let a = picture(&[[0, 0, 0], [10, 20, 30], [255, 255, 255], [7, 7, 7]], &[0b01, 0b11, 0, 4]);
        let b = picture(&[[0, 0, 3], [12, 18, 30], [0, 255, 255], [7, 7, 7]], &[0b10, 0b11, 0, 5]);
        let found = Difference::between(&a, &b);
        assert_eq!((found.pixels, found.wrong_pixels, found.max_steps), (4, 2, 255));
        assert_eq!(found.mean_steps, (3 + 2 + 2 + 255) as f64 / 12.0);
        assert_eq!(found.wrong_mask_pixels, Some(2));
        assert_eq!(wrong_bits(&[true, true, false, true], &[0b01, 0b10, 0b11, 1]), 2);
        assert!(found.flip > 0.0);
        let none = Difference::between(&a, &a);
        assert_eq!(none, Difference { pixels: 4, wrong_mask_pixels: Some(0), ..Difference::default() });
    }

    #[test]
    fn pictures_without_masks_or_pixels() {
        let mut plain = picture(&[[1, 2, 3]], &[0]);
        plain.lens_mask = None;
        assert_eq!(Difference::between(&plain, &plain).wrong_mask_pixels, None);
        assert_eq!(Difference::between(&Picture::default(), &Picture::default()), Difference::default());
    }
}
