//! PNGs and EXRs that take their rows from the top, so that no large picture need be held whole.

use std::{
    cell::RefCell,
    io::{self, BufReader, Read, Write},
    path::{Path, PathBuf},
    rc::Rc,
};

use crate::figure::{
    file::{Spool, WholeFile, WriteError},
    picture::Notes,
};

/// Bytes of a chunk of compressed rows.
const CHUNK: usize = 1 << 16;

/// A PNG that takes its rows from the top.
pub(super) struct PngRows<W: Write + 'static> {
    rows: png::StreamWriter<'static, W>,
}

/// What a PNG is: its size, and what a pixel of it is.
#[derive(Clone, Copy)]
pub(super) struct PngKind {
    pub size: [u32; 2],
    pub color: png::ColorType,
    pub depth: png::BitDepth,
}

impl<W: Write + 'static> PngRows<W> {
    pub fn new(out: W, kind: PngKind, notes: &Notes) -> io::Result<Self> {
        let PngKind { size, color, depth } = kind;
        let mut encoder = png::Encoder::new(out, size[0], size[1]);
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
        let writer = encoder.write_header().map_err(io::Error::other)?;
        Ok(Self { rows: writer.into_stream_writer_with_size(CHUNK).map_err(io::Error::other)? })
    }

    /// The next rows.
    pub fn rows(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.rows.write_all(bytes)
    }

    /// After the last row.
    pub fn finish(self) -> io::Result<()> {
        self.rows.finish().map_err(io::Error::other)
    }
}

/// A PNG file that takes its rows from the top, and appears when it is finished.
pub(super) struct PngFile {
    path: PathBuf,
    file: Rc<RefCell<WholeFile>>,
    rows: PngRows<Shared>,
}

/// A file that the writer of a PNG, which never gives it back, shares with whoever finishes it.
struct Shared(Rc<RefCell<WholeFile>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.borrow_mut().flush()
    }
}

impl PngFile {
    pub fn new(path: &Path, kind: PngKind, notes: &Notes) -> Result<Self, WriteError> {
        let file = Rc::new(RefCell::new(WholeFile::begin(path)?));
        let rows = PngRows::new(Shared(file.clone()), kind, notes).map_err(failed(path))?;
        Ok(Self { path: path.to_owned(), file, rows })
    }

    pub fn rows(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        self.rows.rows(bytes).map_err(failed(&self.path))
    }

    /// Why it cannot be written.
    pub fn failed(&self, error: io::Error) -> WriteError {
        failed(&self.path)(error)
    }

    pub fn finish(self) -> Result<(), WriteError> {
        self.rows.finish().map_err(failed(&self.path))?;
        let file = Rc::into_inner(self.file).map(RefCell::into_inner);
        file.map_or(Ok(()), WholeFile::finish)
    }
}

fn failed(path: &Path) -> impl Fn(io::Error) -> WriteError {
    move |error| WriteError::Io { path: path.to_owned(), error }
}

/// Words of 32 bits that were put down row by row, to be read again from the first.
pub(super) struct Words {
    from: BufReader<Spool>,
}

impl Words {
    pub fn of(spool: Spool) -> io::Result<Self> {
        Ok(Self { from: BufReader::with_capacity(CHUNK, spool.rewound()?) })
    }

    /// The next ones.
    pub fn next(&mut self, count: usize) -> io::Result<Vec<u32>> {
        let mut words = vec![0_u32; count];
        self.from.read_exact(bytemuck::cast_slice_mut(&mut words))?;
        Ok(words)
    }
}

/// Writes an EXR of channels, ascending by name, whose samples stand in `words`: row by row, and in each channel by channel.
pub(super) fn write_exr(
    path: &Path,
    size: [u32; 2],
    channels: &[(String, exr::meta::attribute::SampleType)],
    mut words: Words,
) -> Result<(), WriteError> {
    use exr::{
        block::{UncompressedBlock, enumerate_ordered_header_block_indices, writer::ChunksWriter},
        prelude::*,
    };
    let size = Vec2(size[0] as usize, size[1] as usize);
    let channel = |(name, kind): &(String, SampleType)| ChannelDescription {
        name: Text::from(name.as_str()),
        sample_type: *kind,
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    };
    let mut attributes = LayerAttributes::named("veduta");
    attributes.software_name = Some(Text::from(concat!("Veduta ", env!("CARGO_PKG_VERSION"))));
    let header = exr::meta::header::Header::new(Text::from("veduta"), size, channels.iter().map(channel).collect())
        .with_encoding(Compression::ZIP16, exr::meta::BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes)
        .with_shared_attributes(ImageAttributes::with_size(size));
    // Where its table of chunks stands is written last: a file that cannot be gone back in is a copy of one that can.
    let io_failed = failed(path);
    let mut made = Spool::beside(path).map_err(&io_failed)?;
    let headers = std::iter::once(header).collect();
    exr::block::write(io::BufWriter::with_capacity(CHUNK, &mut made), headers, true, |meta, writer| {
        // One thread: the bytes must not depend on how many there are.
        for (number, block) in enumerate_ordered_header_block_indices(&meta.headers) {
            let mut lines = Ok(());
            let block = UncompressedBlock::from_lines(&meta.headers[0].channels, block, |line| {
                let read = words.next(line.location.sample_count);
                let written = read.map_err(Error::from).and_then(|samples| line.write_samples_from_slice(&samples));
                lines = std::mem::replace(&mut lines, Ok(())).and(written);
            });
            lines?;
            writer.write_chunk(number, block.compress_to_chunk(&meta.headers)?)?;
        }
        Ok(())
    })
    .map_err(|error| WriteError::Format { path: path.to_owned(), message: error.to_string() })?;
    let mut file = WholeFile::begin(path)?;
    io::copy(&mut made.rewound().map_err(&io_failed)?, &mut file).map_err(&io_failed)?;
    file.finish()
}
