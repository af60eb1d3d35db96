//! Texture images, decoded when they are needed: RGBA8 with all mip levels.
//!
//! Levels are box-filtered in linear light with colours weighted by opacity, so that a fence does not darken and
//! its background does not bleed in. Sizes need not be powers of two: a level is half of the one before, rounded
//! down, and the filter weighs texels by the area they cover.

use std::{
    fs::File,
    io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom},
    path::Path,
    sync::{Arc, LazyLock},
};

use image::{
    ColorType, DynamicImage, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, Luma, Rgba,
    RgbaImage,
};
use rayon::prelude::*;

use crate::{
    city::{
        load::options::{LFS_POINTER, is_lfs_pointer},
        model::{CityModel, Material, NONE, Texture, TextureImage, TextureOpacity},
        warning::WarningCode,
    },
    text::one_line,
};

/// The longest side that is kept; larger images are halved until they fit.
pub const MAX_SIDE: u32 = 8192;
/// The longest side that is decoded at all.
const MAX_DECODED_SIDE: u32 = 32_768;
/// The memory that decoding an image and making its levels may take: so many bytes, and so many times its file.
const MOST_BYTES: u64 = 512 << 20;
const MOST_TIMES: u64 = 4;
/// What is read, as messages say it.
const FORMATS: &str = "PNG, JPEG, TIFF, WebP, BMP, GIF and TGA";
/// The end of a file, in which a whole PNG or JPEG says that it ends there.
const END_BYTES: usize = 4096;

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

    /// Whether some texel is not opaque.
    pub fn is_translucent(&self) -> bool {
        self.levels[0].chunks_exact(4).any(|texel| texel[3] < u8::MAX)
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(Vec::len).sum()
    }
}

/// Where the bytes of an image come from.
trait Source: BufRead + Seek {}

impl<T: BufRead + Seek> Source for T {}

/// An image that has been opened: what messages call it, and what reads it.
struct Opened {
    name: String,
    /// The memory that it may take, bytes.
    most: u64,
    reader: ImageReader<Box<dyn Source>>,
}

/// Opens an image, which says by its first bytes what it is, or else by its name.
fn open(image: &TextureImage) -> Result<Opened, String> {
    let (name, length, source, by_name): (_, _, Box<dyn Source>, _) = match image {
        TextureImage::Missing(_) => return Err("the image was not found".to_owned()),
        TextureImage::Bytes(bytes) => {
            ("the embedded image".to_owned(), bytes.len() as u64, Box::new(Cursor::new(Arc::clone(bytes))), None)
        }
        TextureImage::File(path) => {
            let name = path.display().to_string();
            let file = File::open(path).map_err(|e| format!("{name} cannot be read: {e}"))?;
            let length = file.metadata().map_or(0, |of_file| of_file.len());
            (name, length, Box::new(BufReader::new(file)), ImageFormat::from_path(path).ok())
        }
    };
    let mut reader = ImageReader::new(source);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_DECODED_SIDE);
    limits.max_image_height = Some(MAX_DECODED_SIDE);
    let most = MOST_TIMES.saturating_mul(length).saturating_add(MOST_BYTES);
    limits.max_alloc = Some(most);
    reader.limits(limits.clone());
    if let Some(format) = by_name.filter(|format| *format == ImageFormat::Tga) {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format().map_err(|e| format!("{name} cannot be read: {e}"))?;
    if is_copied(reader.format()) {
        limits.max_alloc = Some(most / 2);
        reader.limits(limits);
    }
    match reader.format() {
        Some(format) if format.reading_enabled() => Ok(Opened { name, most, reader }),
        Some(format) => Err(format!("{name} is {format:?}, which is not read; {FORMATS} are")),
        None if begins_as_pointer(image) => {
            Err(format!("{name} is a Git LFS pointer; `git lfs pull` brings the image"))
        }
        None => Err(format!("{name} is no image of a kind that is read; {FORMATS} are")),
    }
}

/// Whether an image stands for one kept elsewhere.
fn begins_as_pointer(image: &TextureImage) -> bool {
    let mut head = vec![0; LFS_POINTER.len()];
    match image {
        TextureImage::Bytes(bytes) => is_lfs_pointer(bytes),
        TextureImage::File(path) => {
            File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && is_lfs_pointer(&head)
        }
        TextureImage::Missing(_) => false,
    }
}

/// Whether images of a format are decoded into room beside that of the picture: frames of GIFs, and all of a TIFF.
fn is_copied(format: Option<ImageFormat>) -> bool {
    matches!(format, Some(ImageFormat::Gif | ImageFormat::Tiff))
}

/// Memory that decoding an image of this size takes, bytes; `is_copied`: [`is_copied`].
fn needed([width, height]: [u32; 2], color: ColorType, is_copied: bool) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    let (rgba, decoded) = (4 * pixels, u64::from(color.bytes_per_pixel()) * pixels);
    // As it is in the file; then as RGBA8 beside that; then with its levels.
    let read = if is_copied { 2 * decoded } else { decoded };
    let turned = if color == ColorType::Rgba8 { 0 } else { decoded + rgba };
    read.max(turned).max(rgba / 2 * 3)
}

/// Whether an image can be read, without reading all of it: its size, and that its end is there; where that is in doubt it is decoded.
///
/// # Errors
/// What is wrong, as [`decode`] says it.
pub fn check(image: &TextureImage) -> Result<(), String> {
    checked(image).map_err(|message| one_line(&message))
}

fn checked(image: &TextureImage) -> Result<(), String> {
    let opened = open(image)?;
    let end: &[u8] = match opened.reader.format() {
        Some(ImageFormat::Png) => b"IEND",
        Some(ImageFormat::Jpeg) => &[0xff, 0xd9],
        _ => return decoded(opened).map(drop),
    };
    let name = opened.name.clone();
    bounded(opened)?;
    let last = match image {
        TextureImage::Bytes(bytes) => bytes[bytes.len().saturating_sub(END_BYTES)..].to_vec(),
        TextureImage::File(path) => last_bytes(path).map_err(|e| format!("{name} cannot be read: {e}"))?,
        TextureImage::Missing(_) => Vec::new(),
    };
    if last.windows(end.len()).any(|bytes| bytes == end) { Ok(()) } else { decoded(open(image)?).map(drop) }
}

fn last_bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(END_BYTES as u64)))?;
    let mut bytes = Vec::new();
    file.take(END_BYTES as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// What decodes an image that is not too large.
fn bounded(opened: Opened) -> Result<impl ImageDecoder, String> {
    let Opened { name, most, reader } = opened;
    let is_copied = is_copied(reader.format());
    let decoder = reader.into_decoder().map_err(|e: ImageError| format!("{name} cannot be decoded: {e}"))?;
    let (width, height) = decoder.dimensions();
    let bytes = needed([width, height], decoder.color_type(), is_copied);
    if bytes <= most {
        return Ok(decoder);
    }
    let (bytes, most) = (bytes >> 20, most >> 20);
    Err(format!(
        "{name} has {width} × {height} pixels, which take {bytes} MiB; {most} MiB, 512 and four times the file, would be right"
    ))
}

/// Width and height of an image, pixels, without decoding it.
///
/// # Errors
/// As of [`decode`].
pub fn size(image: &TextureImage) -> Result<[u32; 2], String> {
    let size = open(image).and_then(bounded).map(|decoder| decoder.dimensions().into());
    size.map_err(|message| one_line(&message))
}

fn decoded(opened: Opened) -> Result<RgbaImage, String> {
    let name = opened.name.clone();
    let failed = |e: ImageError| format!("{name} cannot be decoded: {e}");
    let image = DynamicImage::from_decoder(bounded(opened)?).map_err(failed)?.into_rgba8();
    if [image.width(), image.height()].contains(&0) {
        return Err(format!("{name} has no pixels"));
    }
    Ok(image)
}

/// Decodes an image and makes its mip levels; the error says what is wrong, for
/// [`crate::city::warning::WarningCode::MissingTexture`].
pub fn decode(texture: &Texture) -> Result<Pixels, String> {
    decode_within(texture, MAX_SIDE)
}

/// The same, halved until no side is longer than `side` pixels, which is at most [`MAX_SIDE`].
///
/// # Errors
/// As of [`decode`].
pub fn decode_within(texture: &Texture, side: u32) -> Result<Pixels, String> {
    let image = with_opacity(texture).map_err(|message| one_line(&message))?;
    Ok(with_levels([image.width(), image.height()], image.into_raw(), side, Sum::of_colors))
}

/// The same of a texture of normals (glTF 2.0, section 3.9.3): levels have the means of its bytes, which are numbers and no light.
///
/// # Errors
/// As of [`decode`].
pub fn decode_normals_within(texture: &Texture, side: u32) -> Result<Pixels, String> {
    let mut image = decoded(open(&texture.image).map_err(|message| one_line(&message))?)?;
    image.pixels_mut().for_each(|texel| texel[3] = u8::MAX);
    Ok(with_levels([image.width(), image.height()], image.into_raw(), side, Sum::of_numbers))
}

/// Bytes of an image of this size with its levels where no side is longer than `side`, and of decoding it.
pub fn bytes_within(size: [u32; 2], side: u32) -> [u64; 2] {
    let bytes = |[width, height]: [u32; 2]| 4 * u64::from(width) * u64::from(height);
    let mut kept = size;
    while kept.iter().any(|own| *own > side) {
        kept = smaller(kept);
    }
    [bytes(kept) / 3 * 4 + 4, bytes(size) / 2 * 3]
}

fn with_opacity(texture: &Texture) -> Result<RgbaImage, String> {
    let mut image = decoded(open(&texture.image)?)?;
    match &texture.opacity {
        TextureOpacity::Own => {}
        TextureOpacity::Of(other) => {
            let opacity = opacity_of(&decoded(open(other)?)?);
            let [width, height] = [image.width(), image.height()];
            let opacity = image::imageops::resize(&opacity, width, height, image::imageops::FilterType::Triangle);
            image.pixels_mut().zip(opacity.pixels()).for_each(|(texel, opacity)| texel[3] = opacity[0]);
        }
        TextureOpacity::Alone => {
            let opacity = opacity_of(&image);
            let texels = image.pixels_mut().zip(opacity.pixels());
            texels.for_each(|(texel, opacity)| *texel = Rgba([255, 255, 255, opacity[0]]));
        }
    }
    Ok(image)
}

/// The opacity that an image tells: its own, or where it has none how light it is.
fn opacity_of(image: &RgbaImage) -> GrayImage {
    match image.pixels().any(|texel| texel[3] < u8::MAX) {
        true => GrayImage::from_fn(image.width(), image.height(), |x, y| Luma([image.get_pixel(x, y)[3]])),
        false => DynamicImage::from(image.clone()).into_luma8(),
    }
}

/// Marks the images that cannot be read as missing, and warns of all that are, with the first object that has each.
pub fn settle(model: &mut CityModel) {
    let trouble_of = |image: &TextureImage| match image {
        TextureImage::Missing(why) => Some(why.clone()),
        image => check(image).err(),
    };
    // Of the image, and of the one that has its opacity.
    let trouble = |texture: &Texture| {
        let other = if let TextureOpacity::Of(image) = &texture.opacity { trouble_of(image) } else { None };
        [trouble_of(&texture.image), other]
    };
    let troubles: Vec<[Option<String>; 2]> = model.textures.par_iter().map(trouble).collect();
    if troubles.as_flattened().iter().all(Option::is_none) {
        return;
    }
    let mut objects = vec![None; troubles.len()];
    for surface in model.surfaces.iter().rev() {
        let textures = model.materials.get(surface.material as usize).map_or([NONE; 3], Material::textures);
        for texture in textures {
            if let Some(object) = objects.get_mut(texture as usize) {
                *object = Some(surface.object);
            }
        }
    }
    // What is shown in place of each.
    const INSTEAD: [&str; 3] =
        ["the material's colour is used", "the material has no light of its own", "its normals are those of the faces"];
    let mut instead = vec![INSTEAD[0]; troubles.len()];
    for role in [2, 1, 0] {
        for material in &model.materials {
            if let Some(of_texture) = instead.get_mut(material.textures()[role] as usize) {
                *of_texture = INSTEAD[role];
            }
        }
    }
    for (((texture, [trouble, of_opacity]), object), instead) in
        model.textures.iter_mut().zip(troubles).zip(objects).zip(instead)
    {
        let object = object.and_then(|object| model.objects.get(object as usize)).map_or("", |object| &object.id);
        let mut tell = |trouble: String, what: &str| {
            // What lies outside of the folders has been told by that name.
            if !trouble.is_empty() {
                model.warnings.add(WarningCode::MissingTexture, object, || format!("{trouble}; {what}"));
            }
        };
        if let Some(trouble) = of_opacity {
            texture.opacity = TextureOpacity::Own;
            tell(trouble, "the texture is opaque");
        }
        if let Some(trouble) = trouble {
            texture.image = TextureImage::Missing(String::new());
            tell(trouble, instead);
        }
    }
}

/// Makes the mip levels of an RGBA8 image.
fn with_levels(original: [u32; 2], mut pixels: Vec<u8>, most_side: u32, sum: fn() -> Sum) -> Pixels {
    let mut size = original;
    while size.iter().any(|side| *side > most_side) {
        (size, pixels) = half(size, &pixels, sum);
    }
    let [width, height] = size;
    let mut levels = vec![pixels];
    while size != [1, 1] {
        let (smaller, level) = half(size, &levels[levels.len() - 1], sum);
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

/// The size of the next level: each side halved, rounded down, but not below 1.
fn smaller(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| (side / 2).max(1))
}

/// The next level.
fn half([width, height]: [u32; 2], pixels: &[u8], sum: fn() -> Sum) -> ([u32; 2], Vec<u8>) {
    let smaller = smaller([width, height]);
    let columns: Vec<Taps> = (0..smaller[0]).map(|x| taps(x, width, smaller[0])).collect();
    let row_bytes = width as usize * 4;
    let mut out = vec![0; smaller[0] as usize * smaller[1] as usize * 4];
    out.par_chunks_mut(smaller[0] as usize * 4).enumerate().for_each(|(y, row)| {
        let rows = taps(y as u32, height, smaller[1]);
        for (texel, column) in row.chunks_exact_mut(4).zip(&columns) {
            let mut sum = sum();
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

/// A weighted sum of texels, of colours in linear light.
#[derive(Default)]
struct Sum {
    /// Whether bytes are numbers, not sRGB.
    is_of_numbers: bool,
    /// Colours times opacity.
    color: [f32; 3],
    /// Colours alone: what a wholly transparent texel keeps.
    bare: [f32; 3],
    alpha: f32,
}

impl Sum {
    fn of_colors() -> Self {
        Self::default()
    }

    fn of_numbers() -> Self {
        Self { is_of_numbers: true, ..Self::default() }
    }

    fn add(&mut self, texel: &[u8], weight: f32) {
        let alpha = f32::from(texel[3]) / 255.0 * weight;
        self.alpha += alpha;
        for c in 0..3 {
            let light = if self.is_of_numbers { f32::from(texel[c]) / 255.0 } else { LINEAR[usize::from(texel[c])] };
            self.color[c] += light * alpha;
            self.bare[c] += light * weight;
        }
    }

    fn texel(&self) -> [u8; 4] {
        let opaque = self.alpha > 0.0;
        let light = |c: usize| if opaque { self.color[c] / self.alpha } else { self.bare[c] };
        let byte = |c| if self.is_of_numbers { (light(c) * 255.0).round() as u8 } else { srgb(light(c)) };
        [byte(0), byte(1), byte(2), (self.alpha * 255.0).round() as u8]
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
        Texture { image: TextureImage::Bytes(Arc::from(bytes)), wrap: [Wrap::Repeat; 2], opacity: TextureOpacity::Own }
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
        let pixels =
            with_levels([MAX_SIDE * 2, 2], [9, 9, 9, 255].repeat(MAX_SIDE as usize * 4), MAX_SIDE, Sum::of_colors);
        assert_eq!((pixels.width, pixels.height), (MAX_SIDE, 1));
        assert_eq!(pixels.reduced_from, Some([MAX_SIDE * 2, 2]));
    }

    #[test]
    fn what_is_no_image_is_an_error_in_words() {
        let bytes = |b: &[u8]| Texture {
            image: TextureImage::Bytes(Arc::from(b)),
            wrap: [Wrap::Repeat; 2],
            opacity: TextureOpacity::Own,
        };
        for (content, said) in [
            (&b""[..], "no image of a kind that is read; PNG, JPEG, TIFF"),
            (b"<html></html>", "no image of a kind that is read"),
            (b"DDS ............", "is Dds, which is not read"),
            (b"GIF89a......", "cannot be decoded"),
            (b"\x89PNG\r\n\x1a\n", "cannot be decoded"),
        ] {
            assert!(decode(&bytes(content)).unwrap_err().contains(said), "{:?}", decode(&bytes(content)));
            assert_eq!(check(&bytes(content).image).unwrap_err(), decode(&bytes(content)).unwrap_err());
        }
        // A header that claims 60000 × 60000 pixels.
        let mut huge = png(1, 1, &[0; 4]);
        if let TextureImage::Bytes(png) = &mut huge.image {
            let mut lying = png.to_vec();
            lying[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
            *png = Arc::from(lying);
        }
        assert!(decode(&huge).is_err());
        assert!(check(&huge.image).is_err());
        let file = |path: &str| Texture {
            image: TextureImage::File(path.into()),
            wrap: [Wrap::Repeat; 2],
            opacity: TextureOpacity::Own,
        };
        assert!(decode(&file("no/such.png")).unwrap_err().contains("no/such.png cannot be read"));
    }

    #[test]
    fn what_has_lost_its_end_is_not_there() {
        let noise: Vec<u8> = (0..64 * 64 * 4_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
        for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Tiff, ImageFormat::WebP, ImageFormat::Bmp] {
            let image = RgbaImage::from_raw(64, 64, noise.clone()).expect("an image");
            let mut whole = Cursor::new(Vec::new());
            DynamicImage::ImageRgba8(image).to_rgb8().write_to(&mut whole, format).expect("written");
            let whole = whole.into_inner();
            let of = |bytes: &[u8]| TextureImage::Bytes(Arc::from(bytes));
            assert_eq!(check(&of(&whole)), Ok(()), "{format:?}");
            // With something behind it, it is whole.
            assert_eq!(check(&of(&[&whole[..], &[0; 9000]].concat())), Ok(()), "{format:?}");
            let part = of(&whole[..whole.len() / 2]);
            let texture = Texture { image: part.clone(), wrap: [Wrap::Repeat; 2], opacity: TextureOpacity::Own };
            assert_eq!(check(&part).is_ok(), decode(&texture).is_ok(), "{format:?}");
            assert!(format == ImageFormat::Jpeg || check(&part).is_err(), "{format:?}");
        }
    }

    #[test]
    fn pixels_are_bounded_before_they_are_made() {
        for (size, color, is_copied, mib) in [
            ([8192, 8192], ColorType::Rgba8, false, 384),
            ([8192, 8192], ColorType::Rgb8, false, 448),
            ([8192, 8192], ColorType::Rgba16, false, 768),
            ([8192, 8192], ColorType::Rgba8, true, 512),
            ([8192, 8192], ColorType::Rgb16, true, 768),
            ([8192, 8192], ColorType::L8, true, 384),
            ([32_768, 32_768], ColorType::L8, false, 6144),
        ] {
            assert_eq!(needed(size, color, is_copied), mib << 20, "{size:?} {color:?}");
        }
    }

    #[test]
    fn a_frame_that_is_larger_than_its_gif_is_refused() {
        let gif = |[width, height]: [u16; 2]| {
            // 9 by 7 pixels of two colours, a frame, and in it one code.
            let mut bytes = b"GIF89a\x09\0\x07\0\x80\0\0\0\0\0\xff\xff\xff,\0\0\0\0".to_vec();
            bytes.extend([width, height].iter().flat_map(|side| side.to_le_bytes()));
            bytes.extend(b"\0\x02\x02\x44\x01\0;");
            Texture {
                image: TextureImage::Bytes(Arc::from(bytes)),
                wrap: [Wrap::Repeat; 2],
                opacity: TextureOpacity::Own,
            }
        };
        // 458 MiB of RGBA and as many pixels of indices.
        let refused = decode(&gif([48_111, 2495])).unwrap_err();
        assert!(refused.contains("imit"), "{refused}");
        assert!(decode(&gif([1, 1])).is_ok());
    }

    #[test]
    fn a_tiff_whose_pixels_are_far_more_than_its_bytes_is_refused() {
        let tiff = |width: u32, height: u32| {
            // Bits of the four samples, four bytes of pixels, and the fields: tag, type (3: 16 bits, 4: 32), count, value.
            let fields: [[u32; 4]; 9] = [
                [256, 4, 1, width],
                [257, 4, 1, height],
                [258, 3, 4, 8],
                [259, 3, 1, 1],
                [262, 3, 1, 2],
                [273, 4, 1, 16],
                [277, 3, 1, 4],
                [278, 4, 1, height],
                [279, 4, 1, 4],
            ];
            let mut bytes = b"II*\0\x14\0\0\0\x08\0\x08\0\x08\0\x08\0abcd".to_vec();
            bytes.extend((fields.len() as u16).to_le_bytes());
            for [tag, kind, count, value] in fields {
                bytes.extend([tag as u16, kind as u16].iter().flat_map(|word| word.to_le_bytes()));
                bytes.extend([count, value].iter().flat_map(|word| word.to_le_bytes()));
            }
            bytes.extend([0; 4]);
            let image = TextureImage::Bytes(Arc::from(bytes));
            Texture { image, wrap: [Wrap::Repeat; 2], opacity: TextureOpacity::Own }
        };
        assert_eq!(decode(&tiff(1, 1)).map(|pixels| [pixels.width, pixels.height]), Ok([1, 1]));
        // 272 MiB of RGBA, twice.
        let refused = decode(&tiff(27_778, 2567)).unwrap_err();
        assert!(refused.contains("544 MiB"), "{refused}");
    }
}
