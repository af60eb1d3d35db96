//! Bytes of a file and of those beside it: read whole, unpacked, bounded before anything is allocated.

use std::{
    borrow::Cow,
    fs::File,
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

use crate::field::error::FieldError;

/// The largest file, after decompression: 4 GiB.
pub const MOST_BYTES: u64 = 4 << 30;
/// What is unpacked to more than this many times its size is a bomb, where nobody says how long it is.
const MOST_RATIO: u64 = 250;
/// How many times its size deflate can reach.
const DEFLATE_RATIO: u64 = 1032;
/// Below this size the ratio is not looked at.
const FREE_BYTES: u64 = 64 << 20;
/// How gzip begins.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// Gives the bytes of a file beside another.
pub type Sibling<'a> = &'a dyn Fn(&Path) -> io::Result<Vec<u8>>;

/// One file in memory.
pub struct Input<'a> {
    /// As the user named it.
    pub path: PathBuf,
    /// The content, unpacked.
    pub bytes: Cow<'a, [u8]>,
    /// What reads files beside it.
    sibling: Sibling<'a>,
}

impl<'a> Input<'a> {
    /// A file of these bytes, unpacked if they are gzip.
    pub fn new(path: &Path, bytes: &'a [u8], sibling: Sibling<'a>) -> Result<Self, FieldError> {
        let bytes = Cow::Borrowed(bytes);
        Self { path: path.to_owned(), bytes, sibling }.unpacked()
    }

    fn unpacked(mut self) -> Result<Self, FieldError> {
        if self.bytes.len() as u64 > MOST_BYTES {
            return Err(self.fail("is larger than 4 GiB; thin it out, or cut it into pieces"));
        }
        if self.bytes.starts_with(GZIP) {
            self.bytes = Cow::Owned(gunzip(&self.bytes).map_err(|message| self.fail(message))?);
            if self.bytes.starts_with(GZIP) {
                return Err(self.fail("is gzip inside gzip; unpack it once"));
            }
        }
        Ok(self)
    }

    /// A file that this one names, in its folder or below, unpacked if `is_packed` allows that.
    pub fn beside(&self, name: &str, is_packed: bool) -> Result<Input<'a>, FieldError> {
        let relative = Path::new(name);
        let is_inside = relative.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !is_inside || name.is_empty() || name.contains('\\') {
            return Err(self.fail(format!(
                "its data are in \"{name}\", which is not below its own folder; put that file beside it and name it so"
            )));
        }
        let path = self.path.parent().unwrap_or(Path::new("")).join(relative);
        let bytes = (self.sibling)(&path)
            .map_err(|e| FieldError::new(&path, format!("cannot be read: {e}; {} names it", self.path.display())))?;
        let input = Input { path, bytes: Cow::Owned(bytes), sibling: self.sibling };
        if is_packed { input.unpacked() } else { Ok(input) }
    }

    /// The lower-case extension, not counting `.gz`.
    pub fn extension(&self) -> String {
        let name = self.name();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        name.rsplit_once('.').map(|(_, extension)| extension.to_owned()).unwrap_or_default()
    }

    fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().to_lowercase()
    }

    /// The name of the file without extensions, for fields that have none.
    pub fn stem(&self) -> String {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
    }

    /// An error about the file as a whole.
    pub fn fail(&self, message: impl Into<String>) -> FieldError {
        FieldError::new(&self.path, message)
    }

    /// An error at a byte: by its line where all before it is text.
    pub fn at(&self, byte: usize, message: impl Into<String>) -> FieldError {
        let before = self.bytes.get(..byte).unwrap_or(&self.bytes);
        let is_text = !before.iter().any(|b| *b < 9);
        let place = match is_text {
            true => format!("line {}", before.iter().filter(|b| **b == b'\n').count() + 1),
            false => format!("byte {byte}"),
        };
        FieldError::at(&self.path, place, message)
    }
}

/// Reads a regular file from the disk, at most 4 GiB.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let declared = std::fs::metadata(path)?;
    if !declared.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    if declared.len() > MOST_BYTES {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, "it is larger than 4 GiB"));
    }
    let mut bytes = Vec::with_capacity(declared.len() as usize + 1);
    File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The most bytes that so many packed ones may become.
pub fn most_unpacked(packed: usize) -> u64 {
    MOST_BYTES.min(FREE_BYTES.max(packed as u64 * MOST_RATIO))
}

/// Whether so many packed bytes can become these at all.
pub fn can_become(packed: usize, bytes: usize) -> bool {
    bytes as u64 <= (packed as u64).saturating_mul(DEFLATE_RATIO) + FREE_BYTES
}

/// Decompresses a gzip file of which nobody says how long it is. The error says what is wrong.
pub fn gunzip(packed: &[u8]) -> Result<Vec<u8>, String> {
    let limit = most_unpacked(packed.len());
    let bytes = gunzip_first(packed, limit + 1)?;
    if bytes.len() as u64 > limit {
        let mib = limit >> 20;
        return Err(format!(
            "decompresses to more than {mib} MiB, {MOST_RATIO} times its size; unpack it yourself if you trust it"
        ));
    }
    Ok(bytes)
}

/// Decompresses every member of a gzip file, up to so many bytes; padding behind it is no member.
pub fn gunzip_first(packed: &[u8], most: u64) -> Result<Vec<u8>, String> {
    if !packed.starts_with(GZIP) {
        return Err("is no gzip; bytes 1f 8b belong at its beginning".into());
    }
    let (mut bytes, mut rest) = (Vec::new(), packed);
    while rest.starts_with(GZIP) && (bytes.len() as u64) < most {
        let room = most - bytes.len() as u64;
        let mut member = flate2::bufread::GzDecoder::new(rest).take(room);
        member.read_to_end(&mut bytes).map_err(|e| match e.kind() {
            io::ErrorKind::UnexpectedEof => "is gzip that ends early; is the download complete?".to_owned(),
            _ => format!("is damaged gzip: {e}"),
        })?;
        rest = member.into_inner().into_inner();
    }
    Ok(bytes)
}

/// Decompresses zlib to at most `most` bytes, and appends them. The error says what is wrong.
pub fn inflate(packed: &[u8], most: u64, bytes: &mut Vec<u8>) -> Result<(), String> {
    let start = bytes.len();
    let mut decoder = flate2::bufread::ZlibDecoder::new(packed).take(most + 1);
    decoder.read_to_end(bytes).map_err(|e| format!("the zlib data are damaged: {e}"))?;
    if (bytes.len() - start) as u64 > most {
        return Err(format!("the zlib data become more than the {most} bytes that belong here"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn none(_: &Path) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::NotFound, "none"))
    }

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn gzip_is_unpacked_and_bounded() {
        let twice = [gzip(b"one "), gzip(b"two"), vec![0; 9]].concat();
        assert_eq!(gunzip(&twice).unwrap(), b"one two");
        let bomb = gzip(&vec![0; 65 << 20]);
        assert!(gunzip(&bomb).err().is_some_and(|e| e.contains("more than 64 MiB")));
        assert!(gunzip(&gzip(b"some text")[..15]).unwrap_err().contains("ends early"));
        let mut damaged = gzip(&[7; 999]);
        let middle = damaged.len() / 2;
        damaged[middle] ^= 0xff;
        assert!(gunzip(&damaged).is_err());
        assert_eq!(gunzip_first(&bomb, 65 << 20).map(|bytes| bytes.len()), Ok(65 << 20));
        assert_eq!(gunzip_first(&twice, 5).unwrap(), b"one t");
        assert!(can_become(1 << 20, 1 << 30) && !can_become(1 << 20, 2 << 30));
        assert!(gunzip(b"text").unwrap_err().contains("is no gzip"));
        let nested = gzip(&gzip(b"x"));
        let error = Input::new(Path::new("a.gz"), &nested, &none).err().unwrap();
        assert!(error.to_string().contains("gzip inside gzip"), "{error}");
    }

    #[test]
    fn only_files_below_the_folder_are_asked_for() {
        let give = |path: &Path| Ok(path.to_string_lossy().into_owned().into_bytes());
        let input = Input::new(Path::new("/d/a.nhdr"), b"", &give).unwrap();
        assert_eq!(&input.beside("sub/b.raw", false).unwrap().bytes[..], b"/d/sub/b.raw");
        for name in ["../b", "/etc/passwd", "", "c:\\b"] {
            let error = input.beside(name, false).err().unwrap();
            assert!(error.message.contains("below its own folder"), "{error}");
        }
        let input = Input::new(Path::new("a.nhdr"), b"", &none).unwrap();
        assert_eq!(input.beside("b", false).err().unwrap().to_string(), "b: cannot be read: none; a.nhdr names it");
    }

    #[test]
    fn names_and_places() {
        let input = Input::new(Path::new("d/Brain.v2.NII.gz"), b"one\ntwo\0", &none).unwrap();
        assert_eq!(input.extension(), "nii");
        assert_eq!(input.at(5, "x").place, "line 2");
        assert_eq!(input.at(99, "x").place, "byte 99");
        assert_eq!(Input::new(Path::new("d/a.b.nii.gz"), b"", &none).unwrap().stem(), "a.b");
    }

    #[test]
    fn zlib_is_bounded() {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(&[5; 100]).unwrap();
        let packed = encoder.finish().unwrap();
        let mut bytes = Vec::new();
        inflate(&packed, 100, &mut bytes).unwrap();
        assert_eq!(bytes, [5; 100]);
        assert!(inflate(&packed, 99, &mut bytes).unwrap_err().contains("more than the 99 bytes"));
        assert!(inflate(b"nonsense", 99, &mut bytes).unwrap_err().contains("damaged"));
    }
}
