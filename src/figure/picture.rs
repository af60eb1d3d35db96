//! Pictures and AOVs as files (contract, "Shown surface"): PNG and EXR, written beside and then renamed.

use std::{io, path::Path};

use crate::{
    figure::{
        file::{WriteError, write_whole},
        scene_file::{self, Options},
    },
    scene::Scene,
    text,
};

/// Text that goes into a picture: keyword and value.
pub type Note = (&'static str, String);

/// What a file says of its picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notes {
    /// Texts.
    pub texts: Vec<Note>,
    /// Dots per inch on paper, > 0: PNG alone has a place for it.
    pub dpi: Option<f64>,
}

/// The notes every picture carries: program version and hash of the scene.
pub fn notes(scene_hash: Option<u64>) -> Notes {
    let mut texts = vec![("Software", concat!("Veduta ", env!("CARGO_PKG_VERSION")).to_owned())];
    if let Some(hash) = scene_hash {
        texts.push(("veduta:scene", format!("{hash:016x}")));
    }
    Notes { texts, dpi: None }
}

/// What a picture of a scene says about itself: the program's version, its dots per inch where the scene has them, and a hash of the
/// scene, paths relative to its file. An animation is no part of a picture.
pub fn notes_of(scene: &Scene, options: &Options) -> Notes {
    let still = Scene { animation: None, ..scene.clone() };
    let hash = text::hash(&scene_file::to_toml_for(&still, options));
    Notes { dpi: scene.figure.dpi_of_file(), ..notes(Some(hash)) }
}

fn png(size: [u32; 2], color: png::ColorType, depth: png::BitDepth, notes: &Notes, data: &[u8]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_pixel_dims(notes.dpi.map(|dpi| {
        let per_metre = (dpi / 0.0254).round() as u32;
        png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }
    }));
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Balanced);
    for (keyword, value) in &notes.texts {
        encoder.add_text_chunk((*keyword).to_owned(), value.clone()).map_err(io::Error::other)?;
    }
    if color != png::ColorType::Grayscale {
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    }
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(data).map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)?;
    Ok(bytes)
}

fn save_png(
    path: &Path,
    size: [u32; 2],
    color: png::ColorType,
    depth: png::BitDepth,
    notes: &Notes,
    data: &[u8],
) -> Result<(), WriteError> {
    let bytes =
        png(size, color, depth, notes, data).map_err(|error| WriteError::Io { path: path.to_owned(), error })?;
    write_whole(path, |out| out.write_all(&bytes))
}

/// A picture: sRGB, straight alpha; without alpha where `opaque`.
pub fn save_picture(
    path: &Path,
    size: [u32; 2],
    rgba: &[[u8; 4]],
    opaque: bool,
    notes: &Notes,
) -> Result<(), WriteError> {
    let bytes = png_of(size, rgba, opaque, notes).map_err(|error| WriteError::Io { path: path.to_owned(), error })?;
    write_whole(path, |out| out.write_all(&bytes))
}

/// The same as bytes.
pub(in crate::figure) fn png_of(size: [u32; 2], rgba: &[[u8; 4]], opaque: bool, notes: &Notes) -> io::Result<Vec<u8>> {
    if opaque {
        let rgb: Vec<u8> = rgba.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        png(size, png::ColorType::Rgb, png::BitDepth::Eight, notes, &rgb)
    } else {
        png(size, png::ColorType::Rgba, png::BitDepth::Eight, notes, bytemuck::cast_slice(rgba))
    }
}

/// Whether a path asks for EXR (else PNG); anything else is refused.
fn is_exr(path: &Path) -> Result<bool, WriteError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("exr") => Ok(true),
        Some("png") => Ok(false),
        _ => Err(WriteError::Format {
            path: path.to_owned(),
            message: "an AOV is written as .exr or .png; name one of them".to_owned(),
        }),
    }
}

/// Refuses what [`save_depth`] and its neighbours would refuse, before anything is drawn.
pub fn check_aov_path(path: &Path) -> Result<(), WriteError> {
    is_exr(path).map(|_| ())
}

/// Depth: metres along the view axis, +∞ = nothing. EXR: one f32 channel `Z`. PNG: 16 bit, 0 = nothing,
/// 1..65535 = min..max linearly, both in the note `veduta:depth_m`.
pub fn save_depth(path: &Path, size: [u32; 2], metres: &[f32], notes: &Notes) -> Result<(), WriteError> {
    if is_exr(path)? {
        return save_exr(path, size, vec![("Z".to_owned(), exr::prelude::FlatSamples::F32(metres.to_vec()))]);
    }
    let finite = || metres.iter().copied().filter(|d| d.is_finite());
    let (min, max) = finite().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    let span = f64::from(max) - f64::from(min);
    let code = |d: f32| -> u16 {
        if !d.is_finite() {
            return 0;
        }
        let share = if span > 0.0 { (f64::from(d) - f64::from(min)) / span } else { 0.0 };
        1 + (share * 65_534.0).round() as u16
    };
    let data: Vec<u8> = metres.iter().flat_map(|&d| code(d).to_be_bytes()).collect();
    let mut notes = notes.clone();
    let range = if min <= max { format!("{min} {max}") } else { "nothing".to_owned() };
    notes.texts.push(("veduta:depth_m", range));
    save_png(path, size, png::ColorType::Grayscale, png::BitDepth::Sixteen, &notes, &data)
}

/// Object ids: index + 1 as 24 bits, R the high byte; 0 = nothing. PNG only.
pub fn save_object_id(path: &Path, size: [u32; 2], ids: &[u32], notes: &Notes) -> Result<(), WriteError> {
    if is_exr(path)? {
        return save_exr(path, size, vec![("id".to_owned(), exr::prelude::FlatSamples::U32(ids.to_vec()))]);
    }
    if let Some(id) = ids.iter().find(|&&id| id > 0xff_ffff) {
        let message = format!("object number {id} does not fit the 24 bits of a PNG; write .exr instead");
        return Err(WriteError::Format { path: path.to_owned(), message });
    }
    let data: Vec<u8> = ids
        .iter()
        .flat_map(|id| {
            let [_, r, g, b] = id.to_be_bytes();
            [r, g, b]
        })
        .collect();
    save_png(path, size, png::ColorType::Rgb, png::BitDepth::Eight, notes, &data)
}

/// Normals: unit, model axes, towards the eye; 0,0,0 = nothing. EXR: f32 channels `X`, `Y`, `Z`. PNG: round(255(½+½n)).
pub fn save_normal(path: &Path, size: [u32; 2], normals: &[[f32; 3]], notes: &Notes) -> Result<(), WriteError> {
    if is_exr(path)? {
        let channel = |i: usize| exr::prelude::FlatSamples::F32(normals.iter().map(|n| n[i]).collect());
        let channels = ["X", "Y", "Z"].iter().enumerate().map(|(i, name)| ((*name).to_owned(), channel(i)));
        return save_exr(path, size, channels.collect());
    }
    let code = |n: f32| (255.0 * (0.5 + 0.5 * n)).round() as u8;
    let data: Vec<u8> = normals.iter().flat_map(|n| n.map(code)).collect();
    save_png(path, size, png::ColorType::Rgb, png::BitDepth::Eight, notes, &data)
}

/// Lens masks: bit i = lens i. PNG: 16 bit, at most 16 lenses. EXR: u32 channels `m0`, `m1`, ... of 32 lenses each.
pub fn save_lens_mask(
    path: &Path,
    size: [u32; 2],
    planes: &[Vec<u32>],
    lens_count: usize,
    notes: &Notes,
) -> Result<(), WriteError> {
    let nothing = vec![0; size[0] as usize * size[1] as usize];
    if is_exr(path)? {
        let count = lens_count.max(1).div_ceil(32);
        let channel =
            |i: usize| (format!("m{i}"), exr::prelude::FlatSamples::U32(planes.get(i).unwrap_or(&nothing).clone()));
        return save_exr(path, size, (0..count).map(channel).collect());
    }
    if lens_count > 16 {
        let message = format!("a PNG lens mask holds 16 lenses and the scene has {lens_count}; write .exr instead");
        return Err(WriteError::Format { path: path.to_owned(), message });
    }
    let data: Vec<u8> = planes.first().unwrap_or(&nothing).iter().flat_map(|&m| (m as u16).to_be_bytes()).collect();
    save_png(path, size, png::ColorType::Grayscale, png::BitDepth::Sixteen, notes, &data)
}

fn save_exr(path: &Path, size: [u32; 2], channels: Vec<(String, exr::prelude::FlatSamples)>) -> Result<(), WriteError> {
    use exr::prelude::*;
    let list = channels.into_iter().map(|(name, samples)| AnyChannel::new(Text::from(name.as_str()), samples));
    let mut attributes = LayerAttributes::named("veduta");
    attributes.software_name = Some(Text::from(concat!("Veduta ", env!("CARGO_PKG_VERSION"))));
    let layer = Layer::new(
        (size[0] as usize, size[1] as usize),
        attributes,
        Encoding { compression: Compression::ZIP16, ..Encoding::default() },
        AnyChannels::sort(list.collect()),
    );
    let mut bytes = io::Cursor::new(Vec::new());
    // One thread: the bytes must not depend on how many there are.
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| WriteError::Format { path: path.to_owned(), message: error.to_string() })?;
    write_whole(path, |out| out.write_all(bytes.get_ref()))
}

#[cfg(test)]
mod tests {
    use std::{fs, path::PathBuf};

    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("veduta-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn depth_survives_both_formats() {
        let folder = folder("depth");
        let metres = [1.5, f32::INFINITY, 100.25, 7.0, 2.0, 1.5];
        save_depth(&folder.join("d.exr"), [3, 2], &metres, &Notes::default()).unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(folder.join("d.exr")).unwrap();
        let channel = &read.layer_data.channel_data.list[0];
        assert_eq!(channel.name.to_string(), "Z");
        assert_eq!(channel.sample_data.values_as_f32().collect::<Vec<_>>(), metres);
        save_depth(&folder.join("d.png"), [3, 2], &metres, &notes(Some(7))).unwrap();
        let decoder = png::Decoder::new(io::BufReader::new(fs::File::open(folder.join("d.png")).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let text: Vec<_> =
            reader.info().uncompressed_latin1_text.iter().map(|t| (t.keyword.clone(), t.text.clone())).collect();
        assert!(text.contains(&("veduta:depth_m".into(), "1.5 100.25".into())), "{text:?}");
        assert!(text.contains(&("veduta:scene".into(), "0000000000000007".into())), "{text:?}");
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut data).unwrap();
        let codes: Vec<u16> = data.chunks(2).map(|c| u16::from_be_bytes([c[0], c[1]])).collect();
        assert_eq!((codes[0], codes[1], codes[2], codes[5]), (1, 0, 65_535, 1));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_file_says_its_dots_per_inch() {
        let folder = folder("dpi");
        let file = folder.join("p.png");
        // Per metre and rounded: 300 / 0.0254 = 11811.02.
        for (dpi, per_metre) in
            [(None, None), (Some(300.0), Some(11_811)), (Some(96.0), Some(3780)), (Some(10.0), Some(394))]
        {
            for opaque in [true, false] {
                save_picture(&file, [1, 1], &[[1, 2, 3, 4]], opaque, &Notes { dpi, ..notes(None) }).unwrap();
                let decoder = png::Decoder::new(io::BufReader::new(fs::File::open(&file).unwrap()));
                let found = decoder.read_info().unwrap().info().pixel_dims;
                assert_eq!(found.map(|dots| [dots.xppu, dots.yppu]), per_metre.map(|dots| [dots; 2]));
                assert!(found.is_none_or(|dots| dots.unit == png::Unit::Meter));
            }
        }
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn ids_and_masks_are_bits_not_colours() {
        let folder = folder("ids");
        save_object_id(&folder.join("i.png"), [2, 1], &[0x0001_0203, 0], &Notes::default()).unwrap();
        let read = image::open(folder.join("i.png")).unwrap().into_rgb8();
        assert_eq!(read.get_pixel(0, 0).0, [1, 2, 3]);
        save_lens_mask(&folder.join("m.png"), [2, 1], &[vec![0x8001, 2]], 16, &Notes::default()).unwrap();
        let read = image::open(folder.join("m.png")).unwrap().into_luma16();
        assert_eq!(read.into_raw(), [0x8001, 2]);
        let refused = save_lens_mask(&folder.join("m.png"), [2, 1], &[vec![0, 0]], 17, &Notes::default()).unwrap_err();
        assert!(refused.to_string().contains("write .exr"), "{refused}");
        let planes = [vec![1, 2], vec![3, 4_000_000_000]];
        save_lens_mask(&folder.join("m.exr"), [2, 1], &planes, 40, &Notes::default()).unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(folder.join("m.exr")).unwrap();
        for (i, channel) in read.layer_data.channel_data.list.iter().enumerate() {
            assert_eq!(channel.name.to_string(), format!("m{i}"));
            let exr::prelude::FlatSamples::U32(values) = &channel.sample_data else { panic!("not u32") };
            assert_eq!(values, &planes[i]);
        }
        assert!(save_normal(&folder.join("n.jpg"), [1, 1], &[[0.0; 3]], &Notes::default()).is_err());
        fs::remove_dir_all(folder).unwrap();
    }
}
