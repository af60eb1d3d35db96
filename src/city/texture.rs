//! Texture images, decoded when they are needed: RGBA8 with all mip levels.
//!
//! Levels are box-filtered in linear light with colours weighted by opacity, so that a fence does not darken and
//! its background does not bleed in. Sizes need not be powers of two: a level is half of the one before, rounded
//! down, and the filter weighs texels by the area they cover.

use std::{
    fs::File,
    io::{BufReader, Cursor},
    sync::LazyLock,
};

use image::{ImageReader, Limits};
use rayon::prelude::*;

use crate::city::model::{Texture, TextureImage};

/// The longest side that is kept; larger images are halved until they fit.
pub const MAX_SIDE: u32 = 8192;
/// The longest side that is decoded at all.
const MAX_DECODED_SIDE: u32 = 32_768;
/// The memory that decoding may allocate.
const MAX_DECODED_BYTES: u64 = 1 << 30;

/// A decoded texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Width of level 0, 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Height of level 0, 1 to [`MAX_SIDE`].
    pub height: u32,
    /// RGBA8, sRGB, straight alpha, row 0 at the top; level n is max(1, width >> n) × max(1, height >> n), down to
    /// 1 × 1.
    pub levels: Vec<Vec<u8>>,
    /// The size of the image, where it was too large to be kept as it is: worth a warning.
    pub reduced_from: Option<[u32; 2]>,
}

impl Pixels {
    /// Width and height of level `n`.
    pub fn size(&self, n: usize) -> [u32; 2] {
        [self.width, self.height].map(|side| (side >> n.min(31)).max(1))
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(Vec::len).sum()
    }
}

/// Decodes a PNG or JPEG and makes its mip levels; the error says what is wrong, for
/// [`crate::city::warning::WarningCode::MissingTexture`].
pub fn decode(texture: &Texture) -> Result<Pixels, String> {
    let limited = |mut limits: Limits| {
        limits.max_image_width = Some(MAX_DECODED_SIDE);
        limits.max_image_height = Some(MAX_DECODED_SIDE);
        limits.max_alloc = Some(MAX_DECODED_BYTES);
        limits
    };
    let (name, image) = match &texture.image {
        TextureImage::Missing => return Err("the image was not found".to_owned()),
        TextureImage::Bytes(bytes) => {
            let mut reader = ImageReader::new(Cursor::new(&bytes[..]));
            reader.limits(limited(Limits::default()));
            ("the embedded image".to_owned(), reader.with_guessed_format().map(ImageReader::decode))
        }
        TextureImage::File(path) => {
            let opened = File::open(path).and_then(|file| {
                let mut reader = ImageReader::new(BufReader::new(file));
                reader.limits(limited(Limits::default()));
                reader.with_guessed_format().map(ImageReader::decode)
            });
            (path.display().to_string(), opened)
        }
    };
    let image = match image {
        Ok(Ok(image)) => image.into_rgba8(),
        Ok(Err(image::ImageError::Unsupported(_))) => return Err(format!("{name} is neither PNG nor JPEG")),
        Ok(Err(e)) => return Err(format!("{name} cannot be decoded: {e}")),
        Err(e) => return Err(format!("{name} cannot be read: {e}")),
    };
    let size = [image.width(), image.height()];
    if size.contains(&0) {
        return Err(format!("{name} has no pixels"));
    }
    Ok(with_levels(size, image.into_raw()))
}

/// Makes the mip levels of an RGBA8 image.
fn with_levels(original: [u32; 2], mut pixels: Vec<u8>) -> Pixels {
    let mut size = original;
    while size.iter().any(|side| *side > MAX_SIDE) {
        (size, pixels) = half(size, &pixels);
    }
    let [width, height] = size;
    let mut levels = vec![pixels];
    while size != [1, 1] {
        let (smaller, level) = half(size, &levels[levels.len() - 1]);
        size = smaller;
        levels.push(level);
    }
    Pixels { width, height, levels, reduced_from: (original != [width, height]).then_some(original) }
}

/// The texels of one side that a texel of half its length covers: the first, and the share of each of up to three.
#[derive(Clone, Copy)]
struct Taps {
    first: u32,
    weights: [f32; 3],
}

/// The box filter of texel `i` when `side` texels become `smaller`.
fn taps(i: u32, side: u32, smaller: u32) -> Taps {
    let [side, smaller, i] = [side, smaller, i].map(u64::from);
    // In units of 1/smaller of a texel everything is whole.
    let (start, end) = (i * side, (i + 1) * side);
    let first = start / smaller;
    let weights = [0, 1, 2].map(|k| {
        let (low, high) = ((first + k) * smaller, (first + k + 1) * smaller);
        (high.min(end).saturating_sub(low.max(start)) as f32) / side as f32
    });
    Taps { first: first as u32, weights }
}

/// The next level: each side halved, rounded down, but not below 1.
fn half([width, height]: [u32; 2], pixels: &[u8]) -> ([u32; 2], Vec<u8>) {
    let smaller = [(width / 2).max(1), (height / 2).max(1)];
    let columns: Vec<Taps> = (0..smaller[0]).map(|x| taps(x, width, smaller[0])).collect();
    let row_bytes = width as usize * 4;
    let mut out = vec![0; smaller[0] as usize * smaller[1] as usize * 4];
    out.par_chunks_mut(smaller[0] as usize * 4).enumerate().for_each(|(y, row)| {
        let rows = taps(y as u32, height, smaller[1]);
        for (texel, column) in row.chunks_exact_mut(4).zip(&columns) {
            let mut sum = Sum::default();
            for (j, wy) in rows.weights.into_iter().enumerate().filter(|(_, w)| *w > 0.0) {
                let start = (rows.first as usize + j) * row_bytes;
                for (i, wx) in column.weights.into_iter().enumerate().filter(|(_, w)| *w > 0.0) {
                    let at = start + (column.first as usize + i) * 4;
                    sum.add(&pixels[at..at + 4], wx * wy);
                }
            }
            texel.copy_from_slice(&sum.texel());
        }
    });
    (smaller, out)
}

/// A weighted sum of texels in linear light.
#[derive(Default)]
struct Sum {
    /// Colours times opacity.
    color: [f32; 3],
    /// Colours alone: what a wholly transparent texel keeps.
    bare: [f32; 3],
    alpha: f32,
}

impl Sum {
    fn add(&mut self, texel: &[u8], weight: f32) {
        let alpha = f32::from(texel[3]) / 255.0 * weight;
        self.alpha += alpha;
        for c in 0..3 {
            let light = LINEAR[usize::from(texel[c])];
            self.color[c] += light * alpha;
            self.bare[c] += light * weight;
        }
    }

    fn texel(&self) -> [u8; 4] {
        let opaque = self.alpha > 0.0;
        let light = |c: usize| if opaque { self.color[c] / self.alpha } else { self.bare[c] };
        [srgb(light(0)), srgb(light(1)), srgb(light(2)), (self.alpha * 255.0).round() as u8]
    }
}

/// sRGB bytes as linear light (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let c = i as f32 / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
});

/// Linear light as an sRGB byte.
fn srgb(light: f32) -> u8 {
    let c = if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (c * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::city::model::Wrap;

    fn png(width: u32, height: u32, pixels: &[u8]) -> Texture {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        Texture { image: TextureImage::Bytes(Arc::from(bytes)), wrap: [Wrap::Repeat; 2] }
    }

    #[test]
    fn one_color_stays_that_color_on_every_level() {
        for (width, height) in [(1, 1), (2, 2), (7, 5), (1, 9), (64, 3)] {
            let color = [200, 17, 3, 128];
            let pixels = decode(&png(width, height, &color.repeat((width * height) as usize))).unwrap();
            assert_eq!((pixels.width, pixels.height), (width, height));
            let longest = width.max(height);
            assert_eq!(pixels.levels.len(), 1 + longest.ilog2() as usize, "{width} × {height}");
            for (n, level) in pixels.levels.iter().enumerate() {
                let [w, h] = pixels.size(n);
                assert_eq!(level.len(), (w * h * 4) as usize);
                assert!(level.chunks(4).all(|t| t == color), "{width} × {height}, level {n}: {level:?}");
            }
        }
    }

    /// Half black, half white is half the light, and half the light is 188 in sRGB.
    #[test]
    fn averages_are_of_light() {
        let pixels = decode(&png(2, 1, &[0, 0, 0, 255, 255, 255, 255, 255])).unwrap();
        assert_eq!(pixels.levels[1], [188, 188, 188, 255]);
    }

    #[test]
    fn what_is_transparent_has_no_color_to_give() {
        let pixels = decode(&png(2, 1, &[10, 20, 30, 255, 255, 0, 255, 0])).unwrap();
        assert_eq!(pixels.levels[1], [10, 20, 30, 128]);
    }

    /// Three texels become one: each has a third of the weight.
    #[test]
    fn odd_sides_weigh_texels_by_area() {
        let pixels = decode(&png(3, 1, &[255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255])).unwrap();
        let third = (255.0 * (1.055 * (1.0f64 / 3.0).powf(1.0 / 2.4) - 0.055)).round() as u8;
        assert_eq!(pixels.levels[1], [third, third, third, 255]);
        for (side, smaller) in [(2, 1), (3, 1), (5, 2), (7, 3), (9, 4), (1, 1), (101, 50)] {
            let mut covered = vec![0.0; side as usize + 3];
            for i in 0..smaller {
                let t = taps(i, side, smaller);
                assert!((t.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{side} to {smaller}, {i}");
                for (k, w) in t.weights.into_iter().enumerate() {
                    covered[t.first as usize + k] += w;
                }
            }
            let share = smaller as f32 / side as f32;
            assert!(covered[..side as usize].iter().all(|c| (c - share).abs() < 1e-5), "{side}: {covered:?}");
            assert!(covered[side as usize..].iter().all(|c| *c == 0.0), "{side}: {covered:?}");
        }
    }

    #[test]
    fn large_images_are_halved_until_they_fit() {
        let pixels = with_levels([MAX_SIDE * 2, 2], [9, 9, 9, 255].repeat(MAX_SIDE as usize * 4));
        assert_eq!((pixels.width, pixels.height), (MAX_SIDE, 1));
        assert_eq!(pixels.reduced_from, Some([MAX_SIDE * 2, 2]));
    }

    #[test]
    fn what_is_no_image_is_an_error_in_words() {
        let bytes = |b: &[u8]| Texture { image: TextureImage::Bytes(Arc::from(b)), wrap: [Wrap::Repeat; 2] };
        assert!(decode(&bytes(b"")).unwrap_err().contains("neither PNG nor JPEG"));
        assert!(decode(&bytes(b"GIF89a......")).unwrap_err().contains("neither PNG nor JPEG"));
        assert!(decode(&bytes(b"\x89PNG\r\n\x1a\n")).unwrap_err().contains("cannot be decoded"));
        // A header that claims 60000 × 60000 pixels.
        let mut huge = png(1, 1, &[0; 4]);
        if let TextureImage::Bytes(png) = &mut huge.image {
            let mut lying = png.to_vec();
            lying[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
            *png = Arc::from(lying);
        }
        assert!(decode(&huge).is_err());
        let file = |path: &str| Texture { image: TextureImage::File(path.into()), wrap: [Wrap::Repeat; 2] };
        assert!(decode(&file("no/such.png")).unwrap_err().contains("no/such.png cannot be read"));
    }
}
