//! The bytes a glTF file points to: its binary chunk, data URIs, files beside it.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
    sync::Arc,
};

use gltf::json::{buffer::View, image::Image};
use rustc_hash::FxHashMap;

use super::document::Document;
use crate::city::{
    load::options::{LoadOptions, Sibling, is_lfs_pointer},
    model::{CityModel, TextureImage},
    warning::{WarningCode, Warnings},
};

/// The largest file a model may pull in.
const MAX_BYTES: u64 = 4 << 30;

/// The content of one buffer.
#[derive(Clone, Debug)]
enum Bytes<'a> {
    Chunk(&'a [u8]),
    Owned(Arc<[u8]>),
}

/// Where URIs of one file lead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings<'a> {
    pub path: &'a Path,
    pub options: &'a LoadOptions,
}

/// All buffers of a file; one that could not be read is remembered with its reason.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    list: Vec<Result<Bytes<'a>, String>>,
    /// Bytes of the file and of all its buffers: what its content may be measured against.
    pub total: u64,
}

impl<'a> Buffers<'a> {
    /// Reads what the buffers name; problems become warnings.
    pub fn read(
        document: &Document,
        binary: Option<&'a [u8]>,
        around: Surroundings<'_>,
        CityModel { warnings, read_beside, .. }: &mut CityModel,
    ) -> Self {
        let mut files: FxHashMap<String, Result<Bytes<'a>, String>> = FxHashMap::default();
        let mut total = binary.map_or(0, |b| b.len() as u64);
        let mut list = Vec::with_capacity(document.buffers.len());
        for (i, buffer) in document.buffers.iter().enumerate() {
            let uri = buffer.map(|buffer| (buffer, &buffer.uri));
            let content = match uri {
                Err(what) => Err(what.to_owned()),
                Ok((_, None)) if i == 0 => {
                    binary.map(Bytes::Chunk).ok_or("has no uri, and the file no binary chunk".to_owned())
                }
                Ok((_, None)) => Err("has no uri; only buffer 0 of a GLB may".to_owned()),
                Ok((buffer, Some(uri))) => files
                    .entry(uri.clone())
                    .or_insert_with(|| {
                        let read = follow(uri, buffer.byte_length.0, around, warnings, read_beside).map(Bytes::Owned);
                        total += read.as_ref().map_or(0, |b| b.slice().len() as u64);
                        read
                    })
                    .clone(),
            };
            if let Err(reason) = &content {
                warnings.add(WarningCode::BadGeometry, "", || {
                    format!("{}, buffers[{i}]: {reason}; what needs it is left out", around.path.display())
                });
            }
            list.push(content);
        }
        Self { list, total }
    }

    /// The bytes of a buffer view, cut to what exists; an error names the JSON path.
    pub fn view<'r>(&self, document: &'r Document, index: usize) -> Result<(&[u8], &'r View), String> {
        let view = document.buffer_views.get(index)?;
        let at = view.buffer.value();
        let buffer = match self.list.get(at) {
            Some(Ok(bytes)) => bytes.slice(),
            Some(Err(reason)) => return Err(format!("buffers[{at}] {reason}")),
            None => return Err(format!("bufferViews[{index}].buffer is {at}; the file has {}", self.list.len())),
        };
        let (start, length) = (view.byte_offset.map_or(0, |o| o.0), view.byte_length.0);
        if start > buffer.len() as u64 {
            return Err(format!("bufferViews[{index}] starts at byte {start} of a buffer of {}", buffer.len()));
        }
        let end = start.saturating_add(length).min(buffer.len() as u64);
        Ok((&buffer[start as usize..end as usize], view))
    }
}

impl Bytes<'_> {
    fn slice(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Owned(bytes) => bytes,
        }
    }
}

/// Reads what a URI names, at most `wanted` bytes of a file.
fn follow(
    uri: &str,
    wanted: u64,
    around: Surroundings<'_>,
    warnings: &mut Warnings,
    read_beside: &mut Vec<PathBuf>,
) -> Result<Arc<[u8]>, String> {
    if uri.starts_with("data:") {
        return data_uri(uri).map(Arc::from);
    }
    let path = sibling(uri, around, warnings)?;
    read_beside.push(path.clone());
    let mut bytes = Vec::new();
    let read = File::open(&path).and_then(|f| f.take(wanted.min(MAX_BYTES)).read_to_end(&mut bytes));
    match read {
        Ok(_) if is_lfs_pointer(&bytes) => {
            Err(format!("{} is a Git LFS pointer; `git lfs pull` brings the file", path.display()))
        }
        Ok(_) => Ok(bytes.into()),
        Err(e) => Err(format!("{} cannot be read: {e}", path.display())),
    }
}

/// The file a relative URI names, inside the folders the user named.
fn sibling(uri: &str, around: Surroundings<'_>, warnings: &mut Warnings) -> Result<PathBuf, String> {
    if uri.split_once(':').is_some_and(|(scheme, _)| scheme.len() > 1 && !scheme.contains(['/', '.'])) {
        let shown: String = uri.chars().take(60).collect();
        return Err(format!("{shown} is no file beside the model; nothing is fetched from a network"));
    }
    match around.options.sibling(around.path, &percent_decoded(uri)) {
        Sibling::Found(path) => Ok(path),
        Sibling::Missing(path) => Err(format!("{} does not exist", path.display())),
        Sibling::Outside(path) => {
            warnings.add(WarningCode::OutsidePath, "", || {
                let (file, path) = (around.path.display(), path.display());
                format!("{file}: {path} is outside the folders you named; --allow-outside reads it")
            });
            Err(format!("{} is outside the folders you named", path.display()))
        }
    }
}

/// Where an image's pixels are; problems become [`TextureImage::Missing`]. `budget` is the number of
/// bytes that embedded images may still take: views may overlap, so their sum is not bounded by the file.
pub(super) fn image(
    index: usize,
    image: &Image,
    document: &Document,
    buffers: &Buffers<'_>,
    around: Surroundings<'_>,
    budget: &mut u64,
    warnings: &mut Warnings,
) -> TextureImage {
    let found = match (&image.uri, &image.buffer_view) {
        (Some(uri), _) if uri.starts_with("data:") => data_uri(uri).map(|b| TextureImage::Bytes(b.into())),
        (Some(uri), _) => sibling(uri, around, warnings).map(TextureImage::File),
        (None, Some(view)) => buffers.view(document, view.value()).and_then(|(bytes, _)| {
            *budget = budget.checked_sub(bytes.len() as u64).ok_or("images overlap in the buffer many times")?;
            Ok(TextureImage::Bytes(bytes.into()))
        }),
        (None, None) => Err("has neither uri nor bufferView".to_owned()),
    };
    found
        .unwrap_or_else(|reason| TextureImage::Missing(format!("{}, images[{index}]: {reason}", around.path.display())))
}

/// The content of a `data:` URI, base64 or percent-encoded.
fn data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let Some((head, content)) = uri.split_once(',') else {
        return Err("data URI without a comma".to_owned());
    };
    if head.ends_with(";base64") {
        base64(content).ok_or_else(|| "data URI is not valid base64".to_owned())
    } else {
        Ok(percent_bytes(content))
    }
}

/// RFC 4648 base64, standard or URL alphabet; padding and white space are passed over.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0u32);
    for byte in text.bytes() {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' | b' ' | b'\t' | b'\r' | b'\n' => continue,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
        }
    }
    Some(out)
}

/// `a%20b` → `a b`; what is no escape stays.
fn percent_decoded(uri: &str) -> String {
    String::from_utf8_lossy(&percent_bytes(uri)).into_owned()
}

fn percent_bytes(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let hex = |at: usize| bytes.get(at).and_then(|b| (*b as char).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        match (bytes[at], hex(at + 1), hex(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high << 4 | low) as u8);
                at += 3;
            }
            (byte, ..) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_as_in_its_rfc() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmFy", "foobar")] {
            assert_eq!(base64(text).unwrap(), bytes.as_bytes(), "{text}");
        }
        assert_eq!(base64("+/-_").unwrap(), [0xfb, 0xff, 0xbf]);
        assert_eq!(base64("Zm9v!"), None);
    }

    #[test]
    fn escapes_are_undone_and_others_stay() {
        assert_eq!(percent_decoded("a%20b%2Fc%zz%4"), "a b/c%zz%4");
        assert_eq!(data_uri("data:,%00x").unwrap(), b"\0x");
    }
}
