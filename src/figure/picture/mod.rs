//! Pictures and AOVs as files (contract, "Shown surface"): PNG and EXR, written beside and then renamed.

mod aov;
mod rows;

use std::{
    borrow::Cow,
    cell::RefCell,
    io::{self, Write},
    path::Path,
    rc::Rc,
};

pub use aov::{Aov, AovFile};
use rows::{PngFile, PngKind, PngRows};

use crate::{
    figure::{
        file::WriteError,
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

/// A picture: sRGB, straight alpha; without alpha where `opaque`.
pub fn save_picture(
    path: &Path,
    size: [u32; 2],
    rgba: &[[u8; 4]],
    opaque: bool,
    notes: &Notes,
) -> Result<(), WriteError> {
    let mut file = PictureFile::new(path, size, opaque, notes)?;
    file.rows(rgba)?;
    file.finish()
}

/// The same as bytes.
pub(in crate::figure) fn png_of(size: [u32; 2], rgba: &[[u8; 4]], opaque: bool, notes: &Notes) -> io::Result<Vec<u8>> {
    let bytes = Bytes::default();
    let mut png = PngRows::new(bytes.clone(), picture_kind(size, opaque), notes)?;
    png.rows(&bytes_of(rgba, opaque))?;
    png.finish()?;
    Ok(bytes.0.take())
}

/// Bytes that a PNG is written to.
#[derive(Clone, Default)]
struct Bytes(Rc<RefCell<Vec<u8>>>);

impl Write for Bytes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn picture_kind(size: [u32; 2], opaque: bool) -> PngKind {
    let color = if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba };
    PngKind { size, color, depth: png::BitDepth::Eight }
}

fn bytes_of(rgba: &[[u8; 4]], opaque: bool) -> Cow<'_, [u8]> {
    match opaque {
        true => rgba.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect(),
        false => Cow::Borrowed(rgba.as_flattened()),
    }
}

/// A picture as a file that takes its rows from the top, and appears when it is finished.
pub struct PictureFile {
    opaque: bool,
    png: PngFile,
}

impl PictureFile {
    /// One of `size` pixels: sRGB, straight alpha; without alpha where `opaque`.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn new(path: &Path, size: [u32; 2], opaque: bool, notes: &Notes) -> Result<Self, WriteError> {
        Ok(Self { opaque, png: PngFile::new(path, picture_kind(size, opaque), notes)? })
    }

    /// The next rows.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn rows(&mut self, rgba: &[[u8; 4]]) -> Result<(), WriteError> {
        self.png.rows(&bytes_of(rgba, self.opaque))
    }

    /// After the last row.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn finish(self) -> Result<(), WriteError> {
        self.png.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::{fs, path::PathBuf};

    use super::*;
    use crate::render::bands::Band;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("veduta-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    /// Writes an AOV of a picture row by row, and in one band; the same bytes.
    fn save(path: &Path, content: Aov, band: &Band, notes: &Notes) -> Result<(), WriteError> {
        let mut file = AovFile::new(path, content, band.size, notes)?;
        file.take(band)?;
        file.finish()?;
        let whole = fs::read(path).unwrap();
        let mut file = AovFile::new(path, content, band.size, notes)?;
        let width = band.size[0] as usize;
        for y in 0..band.size[1] as usize {
            let row = y * width..(y + 1) * width;
            file.take(&Band {
                first_row: y as u32,
                size: [band.size[0], 1],
                depth: band.depth.as_ref().map(|all| all[row.clone()].to_vec()),
                object_id: band.object_id.as_ref().map(|all| all[row.clone()].to_vec()),
                normal: band.normal.as_ref().map(|all| all[row.clone()].to_vec()),
                lens_mask: band
                    .lens_mask
                    .iter()
                    .map(|all| all.iter().map(|p| p[row.clone()].to_vec()).collect())
                    .next(),
                ..Band::default()
            })?;
        }
        file.finish()?;
        assert!(fs::read(path).unwrap() == whole, "{path:?} depends on its bands");
        let left = fs::read_dir(path.parent().unwrap()).unwrap().flatten();
        assert!(left.map(|entry| entry.file_name()).all(|name| !name.to_string_lossy().starts_with('.')));
        Ok(())
    }

    #[test]
    fn depth_survives_both_formats() {
        let folder = folder("depth");
        let metres = [1.5, f32::INFINITY, 100.25, 7.0, 2.0, 1.5];
        let band = Band { size: [3, 2], depth: Some(metres.to_vec()), ..Band::default() };
        save(&folder.join("d.exr"), Aov::Depth, &band, &Notes::default()).unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(folder.join("d.exr")).unwrap();
        let channel = &read.layer_data.channel_data.list[0];
        assert_eq!(channel.name.to_string(), "Z");
        assert_eq!(channel.sample_data.values_as_f32().collect::<Vec<_>>(), metres);
        save(&folder.join("d.png"), Aov::Depth, &band, &notes(Some(7))).unwrap();
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
        let with = |ids: Option<Vec<u32>>, masks: Option<Vec<Vec<u32>>>| Band {
            size: [2, 1],
            object_id: ids,
            lens_mask: masks,
            ..Band::default()
        };
        let none = Notes::default();
        save(&folder.join("i.png"), Aov::ObjectId, &with(Some(vec![0x0001_0203, 0]), None), &none).unwrap();
        let read = image::open(folder.join("i.png")).unwrap().into_rgb8();
        assert_eq!(read.get_pixel(0, 0).0, [1, 2, 3]);
        let many = with(Some(vec![0x0100_0000, 0]), None);
        let refused = save(&folder.join("i.png"), Aov::ObjectId, &many, &none).unwrap_err();
        assert!(refused.to_string().contains("write .exr"), "{refused}");
        save(&folder.join("i.exr"), Aov::ObjectId, &many, &none).unwrap();
        let masks = with(None, Some(vec![vec![0x8001, 2]]));
        save(&folder.join("m.png"), Aov::LensMask(16), &masks, &none).unwrap();
        let read = image::open(folder.join("m.png")).unwrap().into_luma16();
        assert_eq!(read.into_raw(), [0x8001, 2]);
        let refused = save(&folder.join("m.png"), Aov::LensMask(17), &masks, &none).unwrap_err();
        assert!(refused.to_string().contains("write .exr"), "{refused}");
        let planes = [vec![1, 2], vec![3, 4_000_000_000]];
        save(&folder.join("m.exr"), Aov::LensMask(40), &with(None, Some(planes.to_vec())), &none).unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(folder.join("m.exr")).unwrap();
        for (i, channel) in read.layer_data.channel_data.list.iter().enumerate() {
            assert_eq!(channel.name.to_string(), format!("m{i}"));
            let exr::prelude::FlatSamples::U32(values) = &channel.sample_data else { panic!("not u32") };
            assert_eq!(values, &planes[i]);
        }
        let normals = Band { size: [1, 2], normal: Some(vec![[0.0, -1.0, 0.5], [0.0; 3]]), ..Band::default() };
        save(&folder.join("n.png"), Aov::Normal, &normals, &none).unwrap();
        assert_eq!(image::open(folder.join("n.png")).unwrap().into_rgb8().get_pixel(0, 0).0, [128, 0, 191]);
        save(&folder.join("n.exr"), Aov::Normal, &normals, &none).unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(folder.join("n.exr")).unwrap();
        let list = &read.layer_data.channel_data.list;
        let found: Vec<(String, Vec<f32>)> =
            list.iter().map(|own| (own.name.to_string(), own.sample_data.values_as_f32().collect())).collect();
        let right = [("X", [0.0, 0.0]), ("Y", [-1.0, 0.0]), ("Z", [0.5, 0.0])];
        assert_eq!(found, right.map(|(name, values)| (name.to_owned(), values.to_vec())));
        assert!(save(&folder.join("n.jpg"), Aov::Normal, &normals, &none).is_err());
        fs::remove_dir_all(folder).unwrap();
    }
}
