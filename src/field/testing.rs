//! What tests of all formats use.

use std::{io, path::Path};

use crate::field::{Field, FieldError, FieldFile, load_bytes};

/// Loads a file that has none beside it.
pub fn load(name: &str, bytes: impl AsRef<[u8]>) -> Result<FieldFile, FieldError> {
    load_with(name, bytes, &[])
}

/// Loads a file in the folder `d`, with others beside it.
pub fn load_with(name: &str, bytes: impl AsRef<[u8]>, beside: &[(&str, &[u8])]) -> Result<FieldFile, FieldError> {
    let sibling = |path: &Path| {
        let found = beside.iter().find(|(name, _)| Path::new("d").join(name) == path);
        found.map(|(_, bytes)| bytes.to_vec()).ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "not found"))
    };
    load_bytes(&Path::new("d").join(name), bytes.as_ref(), &sibling)
}

/// The only field of a file.
pub fn one(file: Result<FieldFile, FieldError>) -> Field {
    let mut file = file.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.fields.len(), 1);
    file.fields.remove(0)
}

/// The message of a file that is refused.
pub fn refused(file: Result<FieldFile, FieldError>) -> String {
    let message = file.expect_err("the file is refused").to_string();
    assert!(!message.contains('\n') && message.len() < 1500, "{message}");
    message
}

/// The numbers of a step.
pub fn numbers(field: &Field, step: usize) -> Vec<f32> {
    let values = &field.steps[step].values;
    (0..values.len()).map(|i| values.get(i)).collect()
}

/// Bytes as gzip.
pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::read::GzEncoder::new(bytes, flate2::Compression::default());
    let mut packed = Vec::new();
    io::Read::read_to_end(&mut encoder, &mut packed).expect("memory can be read");
    packed
}

/// Bytes as zlib.
pub fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::read::ZlibEncoder::new(bytes, flate2::Compression::default());
    let mut packed = Vec::new();
    io::Read::read_to_end(&mut encoder, &mut packed).expect("memory can be read");
    packed
}

/// Numbers as bytes, the most significant first.
pub fn big(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_be_bytes()).collect()
}

/// Numbers as bytes, the most significant last.
pub fn little(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}
