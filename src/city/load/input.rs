//! Bytes of a file: read whole, gunzipped, without a byte order mark; bounded before anything is allocated.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use crate::city::{load::error::LoadError, memory::give_back};

/// The largest model, after decompression: 4 GiB, what 32-bit offsets can count.
const MAX_BYTES: u64 = 4 << 30;
/// Text of city models compresses 5 to 40 times; deflate can reach 1032 times. Beyond this it is a bomb.
const MAX_RATIO: u64 = 250;
/// Below this size the ratio is not looked at.
const FREE_BYTES: u64 = 64 << 20;

/// One model file in memory.
#[derive(Clone, Debug)]
pub struct Input {
    /// As the user named it; `-` for standard input.
    pub path: PathBuf,
    /// The content, decompressed, without UTF-8 byte order mark.
    pub bytes: Vec<u8>,
    /// Whether compressed content ends early: the loader shows what is there, [`super::read_input`] says so.
    pub is_cut: bool,
}

impl Input {
    /// The lower-case extension, not counting `.gz`.
    pub fn extension(&self) -> String {
        extension(&self.path)
    }
}

/// The lower-case extension of a path, not counting `.gz`.
pub(super) fn extension(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map(|(_, e)| e.to_owned()).unwrap_or_default()
}

/// Reads a file, or standard input for `-`.
pub fn read(path: &Path) -> Result<Input, LoadError> {
    let failed = |e: std::io::Error| LoadError::new(path, format!("cannot be read: {e}"));
    if let Some(bytes) = crate::city::builtin::read(path) {
        return from_bytes(path, bytes);
    }
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().lock().take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    } else {
        let mut file = File::open(path).map_err(failed)?;
        let declared = file.metadata().map_or(0, |m| m.len());
        if declared > MAX_BYTES {
            return Err(too_large(path));
        }
        bytes.reserve_exact(declared as usize + 1);
        file.by_ref().take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    }
    from_bytes(path, bytes)
}

/// Makes an input of bytes that were read, as [`read`] does.
pub fn from_bytes(path: &Path, mut bytes: Vec<u8>) -> Result<Input, LoadError> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large(path));
    }
    let mut is_cut = false;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let packed = std::mem::take(&mut bytes);
        (bytes, is_cut) = gunzip(path, &packed)?;
        give_back(packed);
        if bytes.starts_with(&[0x1f, 0x8b]) {
            return Err(LoadError::new(path, "is gzip inside gzip; unpack it once"));
        }
    }
    if bytes.starts_with(&[0xef, 0xbb, 0xbf]) {
        bytes.drain(..3);
    }
    Ok(Input { path: path.to_owned(), bytes, is_cut })
}

fn too_large(path: &Path) -> LoadError {
    LoadError::new(path, "is larger than 4 GiB; cut it into tiles and name several files")
}

/// Decompresses every member of a gzip file; and whether its end is cut off.
fn gunzip(path: &Path, packed: &[u8]) -> Result<(Vec<u8>, bool), LoadError> {
    let limit = MAX_BYTES.min(FREE_BYTES.max(packed.len() as u64 * MAX_RATIO));
    let mut bytes = Vec::new();
    let result = flate2::read::MultiGzDecoder::new(packed).take(limit + 1).read_to_end(&mut bytes);
    if bytes.len() as u64 > limit {
        let mib = limit >> 20;
        return Err(LoadError::new(
            path,
            format!(
                "decompresses to more than {mib} MiB, {MAX_RATIO} times its size; unpack it yourself if you trust it"
            ),
        ));
    }
    match result {
        Err(e) if bytes.is_empty() || e.kind() != std::io::ErrorKind::UnexpectedEof => {
            Err(LoadError::new(path, format!("is damaged gzip: {e}")))
        }
        result => Ok((bytes, result.is_err())),
    }
}
