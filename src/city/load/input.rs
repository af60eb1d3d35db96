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
    /// Bytes behind compressed content that are none of it.
    pub passed_over: usize,
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
    let (mut is_cut, mut passed_over) = (false, 0);
    if bytes.starts_with(GZIP) {
        let packed = std::mem::take(&mut bytes);
        (bytes, is_cut, passed_over) = gunzip(path, &packed)?;
        give_back(packed);
        if bytes.starts_with(GZIP) {
            return Err(LoadError::new(path, "is gzip inside gzip; unpack it once"));
        }
    }
    if bytes.starts_with(&[0xef, 0xbb, 0xbf]) {
        bytes.drain(..3);
    }
    Ok(Input { path: path.to_owned(), bytes, is_cut, passed_over })
}

fn too_large(path: &Path) -> LoadError {
    LoadError::new(path, "is larger than 4 GiB; cut it into tiles and name several files")
}

/// How compressed content begins.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// Decompresses every member of a gzip file; and whether its end is cut off, and how many bytes behind it are none (RFC 1952, 2.2: members
/// follow each other; padding with zeros, and what transfers leave behind, is no member).
fn gunzip(path: &Path, packed: &[u8]) -> Result<(Vec<u8>, bool, usize), LoadError> {
    let limit = MAX_BYTES.min(FREE_BYTES.max(packed.len() as u64 * MAX_RATIO));
    let (mut bytes, mut rest) = (Vec::new(), packed);
    let mut result = Ok(0);
    while rest.starts_with(GZIP) && result.is_ok() {
        let room = limit + 1 - bytes.len() as u64;
        let mut member = flate2::bufread::GzDecoder::new(rest).take(room);
        result = member.read_to_end(&mut bytes);
        rest = member.into_inner().into_inner();
        if bytes.len() as u64 > limit {
            let mib = limit >> 20;
            return Err(LoadError::new(
                path,
                format!(
                    "decompresses to more than {mib} MiB, {MAX_RATIO} times its size; unpack it yourself if you trust it"
                ),
            ));
        }
    }
    match result {
        Err(e) if bytes.is_empty() || e.kind() != std::io::ErrorKind::UnexpectedEof => {
            Err(LoadError::new(path, format!("is damaged gzip: {e}")))
        }
        Err(_) => Ok((bytes, true, 0)),
        Ok(_) => Ok((bytes, false, if rest.iter().all(|byte| *byte == 0) { 0 } else { rest.len() })),
    }
}
