//! AOVs as files, PNG or EXR, written band by band.

use std::{
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use exr::meta::attribute::SampleType;

use crate::{
    figure::{
        file::{Spool, WriteError},
        picture::{
            Notes,
            rows::{PngFile, PngKind, Words, write_exr},
        },
    },
    render::bands::Band,
};

/// Rows that are read again at a time.
const ROWS: usize = 64;

/// The content of an AOV.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Metres along the view axis, +∞ = nothing. EXR: one f32 channel `Z`. PNG: 16 bit, 0 = nothing, 1..65535 = min..max linearly, both in the note
    /// `veduta:depth_m`.
    Depth,
    /// Object index + 1; 0 = nothing. PNG: 24 bits, R the high byte. EXR: u32 `id`.
    ObjectId,
    /// Unit, model axes, towards the eye; 0,0,0 = nothing. EXR: f32 channels `X`, `Y`, `Z`. PNG: round(255(½+½n)).
    Normal,
    /// Bit i = lens i, of so many lenses. PNG: 16 bit, at most 16 lenses. EXR: u32 channels `m0`, `m1`, ... of 32 lenses each.
    LensMask(usize),
}

/// An AOV as a file that takes bands from the top, and appears when it is finished.
pub struct AovFile {
    path: PathBuf,
    size: [u32; 2],
    content: Aov,
    notes: Notes,
    to: To,
}

/// Where its rows go.
enum To {
    /// Into a PNG at once.
    Png(Box<PngFile>),
    /// Aside, as words of 32 bits, since something must be known of all of them first; with the smallest and the largest finite number.
    Aside { rows: BufWriter<Spool>, is_exr: bool, range: [f32; 2] },
}

impl Aov {
    /// The PNG of it.
    fn png(self, size: [u32; 2]) -> PngKind {
        let (color, depth) = match self {
            Self::Depth | Self::LensMask(_) => (png::ColorType::Grayscale, png::BitDepth::Sixteen),
            Self::ObjectId | Self::Normal => (png::ColorType::Rgb, png::BitDepth::Eight),
        };
        PngKind { size, color, depth }
    }

    /// The channels of an EXR of it, ascending by name, each with the word of its own that its samples are.
    fn channels(self) -> Vec<(String, SampleType, usize)> {
        let own = |name: &str, kind| vec![(name.to_owned(), kind, 0)];
        match self {
            Self::Depth => own("Z", SampleType::F32),
            Self::ObjectId => own("id", SampleType::U32),
            Self::Normal => (0..3).map(|i| (["X", "Y", "Z"][i].to_owned(), SampleType::F32, i)).collect(),
            Self::LensMask(lenses) => {
                let words = lenses.max(1).div_ceil(32);
                let mut channels: Vec<_> = (0..words).map(|i| (format!("m{i}"), SampleType::U32, i)).collect();
                channels.sort_by(|a, b| a.0.cmp(&b.0));
                channels
            }
        }
    }

    /// A word of pixels of a band: the bits of its samples.
    fn words(self, band: &Band, word: usize, pixels: std::ops::Range<usize>) -> Vec<u32> {
        let floats = |own: Option<&[f32]>| own.map(|own| own[pixels.clone()].iter().map(|v| v.to_bits()).collect());
        let whole = |own: Option<&Vec<u32>>| own.map(|own| own[pixels.clone()].to_vec());
        let found = match self {
            Self::Depth => floats(band.depth.as_deref()),
            Self::ObjectId => whole(band.object_id.as_ref()),
            Self::Normal => {
                let own = band.normal.as_deref();
                own.map(|own| own[pixels.clone()].iter().map(|n| n[word].to_bits()).collect())
            }
            Self::LensMask(_) => whole(band.lens_mask.as_ref().and_then(|planes| planes.get(word))),
        };
        // A word of lenses that are not there.
        found.unwrap_or_else(|| vec![0; pixels.len()])
    }

    /// Rows of a PNG, of what needs nothing else for them.
    fn bytes(self, band: &Band) -> Result<Vec<u8>, String> {
        let all = 0..band.size[0] as usize * band.size[1] as usize;
        match self {
            Self::Depth => Ok(Vec::new()),
            Self::ObjectId => {
                let ids = self.words(band, 0, all);
                if let Some(id) = ids.iter().find(|&&id| id > 0xff_ffff) {
                    return Err(format!("object number {id} does not fit the 24 bits of a PNG; write .exr instead"));
                }
                Ok(ids.iter().flat_map(|id| id.to_be_bytes().into_iter().skip(1)).collect())
            }
            Self::Normal => {
                let code = |n: f32| (255.0 * (0.5 + 0.5 * n)).round() as u8;
                Ok(band.normal.iter().flatten().flat_map(|n| n.map(code)).collect())
            }
            Self::LensMask(_) => {
                Ok(self.words(band, 0, all).iter().flat_map(|&word| (word as u16).to_be_bytes()).collect())
            }
        }
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

impl AovFile {
    /// One of a picture of `size` pixels.
    ///
    /// # Errors
    /// Those of the file system, and what the format cannot hold.
    pub fn new(path: &Path, content: Aov, size: [u32; 2], notes: &Notes) -> Result<Self, WriteError> {
        let is_exr = is_exr(path)?;
        if let (Aov::LensMask(lenses @ 17..), false) = (content, is_exr) {
            let message = format!("a PNG lens mask holds 16 lenses and the scene has {lenses}; write .exr instead");
            return Err(WriteError::Format { path: path.to_owned(), message });
        }
        let to = match is_exr || content == Aov::Depth {
            false => To::Png(Box::new(PngFile::new(path, content.png(size), notes)?)),
            true => {
                let spool = Spool::beside(path).map_err(|error| WriteError::Io { path: path.to_owned(), error })?;
                let rows = BufWriter::with_capacity(1 << 16, spool);
                To::Aside { rows, is_exr, range: [f32::INFINITY, f32::NEG_INFINITY] }
            }
        };
        Ok(Self { path: path.to_owned(), size, content, notes: notes.clone(), to })
    }

    /// The next rows.
    ///
    /// # Errors
    /// Those of the file system, and what the format cannot hold.
    pub fn take(&mut self, band: &Band) -> Result<(), WriteError> {
        let content = self.content;
        match &mut self.to {
            To::Png(png) => {
                let wrong = |message| WriteError::Format { path: self.path.clone(), message };
                png.rows(&content.bytes(band).map_err(wrong)?)
            }
            To::Aside { rows, range, .. } => {
                let finite = band.depth.iter().flatten().copied().filter(|d| d.is_finite());
                *range = finite.fold(*range, |[low, high], d| [low.min(d), high.max(d)]);
                let width = band.size[0] as usize;
                let lines = (0..band.size[1] as usize).map(|y| y * width..(y + 1) * width);
                let mut words = lines.flat_map(|line| {
                    let of = move |(_, _, word)| content.words(band, word, line.clone());
                    content.channels().into_iter().map(of)
                });
                words
                    .try_for_each(|words| rows.write_all(bytemuck::cast_slice(&words)))
                    .map_err(|error| WriteError::Io { path: self.path.clone(), error })
            }
        }
    }

    /// After the last rows.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn finish(self) -> Result<(), WriteError> {
        let Self { path, size, content, notes, to } = self;
        let failed = |error| WriteError::Io { path: path.clone(), error };
        match to {
            To::Png(png) => png.finish(),
            To::Aside { rows, is_exr, range } => {
                let spool = rows.into_inner().map_err(|error| failed(error.into_error()))?;
                let words = Words::of(spool).map_err(failed)?;
                if is_exr {
                    let channels: Vec<_> = content.channels().into_iter().map(|(name, kind, _)| (name, kind)).collect();
                    return write_exr(&path, size, &channels, words);
                }
                let mut notes = notes;
                let [min, max] = range;
                let told = if min <= max { format!("{min} {max}") } else { "nothing".to_owned() };
                notes.texts.push(("veduta:depth_m", told));
                let mut png = PngFile::new(&path, content.png(size), &notes)?;
                put_depths(&mut png, words, size, range)?;
                png.finish()
            }
        }
    }
}

/// Depths as codes of 16 bits.
fn put_depths(png: &mut PngFile, mut words: Words, size: [u32; 2], [min, max]: [f32; 2]) -> Result<(), WriteError> {
    let span = f64::from(max) - f64::from(min);
    let code = |d: f32| -> u16 {
        if !d.is_finite() {
            return 0;
        }
        let share = if span > 0.0 { (f64::from(d) - f64::from(min)) / span } else { 0.0 };
        1 + (share * 65_534.0).round() as u16
    };
    let mut left = size[1] as usize;
    while left > 0 {
        let rows = left.min(ROWS);
        let metres = words.next(rows * size[0] as usize).map_err(|error| png.failed(error))?;
        let bytes: Vec<u8> = metres.iter().flat_map(|&word| code(f32::from_bits(word)).to_be_bytes()).collect();
        png.rows(&bytes)?;
        left -= rows;
    }
    Ok(())
}
