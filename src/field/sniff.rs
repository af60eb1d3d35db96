//! The format of a file: by its content first, by its name where the content says little.

use std::path::Path;

use crate::field::{input::Input, nrrd, vtk};

/// The formats that can be read, for messages.
const READABLE: &str = "Veduta reads fields as NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), VTK (.vti, .vtk), OpenDX (.dx, .general), NIfTI (.nii, .hdr) and NetCDF (.nc), each also .gz";

/// The formats told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Nrrd,
    MetaImage,
    Vti,
    Vtk,
    Dx,
    General,
    Nifti,
    NetCdf,
}

/// First bytes of what is no field, and what that is.
const OTHERS: &[(&[u8], &str)] = &[
    (b"\x89PNG", "is a PNG image, not a volume"),
    (b"\xff\xd8\xff", "is a JPEG image, not a volume"),
    (b"II*\0", "is a TIFF image, not a volume"),
    (b"MM\0*", "is a TIFF image, not a volume"),
    (b"glTF", "is a glTF model, not a volume; [city] files would be right"),
    (b"PK\x03\x04", "is a ZIP archive; unpack it and name the volume inside"),
];

/// The extensions that such files have, without `.gz`.
const EXTENSIONS: &[&str] =
    &["nrrd", "nhdr", "mha", "mhd", "vti", "vtk", "dx", "general", "nii", "hdr", "nc", "nc4", "cdf"];

/// Whether a file is a field by its name.
pub fn is_named(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').is_some_and(|(_, extension)| EXTENSIONS.contains(&extension))
}

/// The format of a file; the error says what the file is instead.
pub fn format(input: &Input<'_>) -> Result<Format, String> {
    let bytes = &input.bytes[..];
    let head = bytes.get(..8192).unwrap_or(bytes);
    let has = |needle: &[u8]| head.windows(needle.len()).any(|window| window == needle);
    let extension = input.extension();
    if bytes.is_empty() {
        return Err("is empty (0 bytes); is the download complete?".into());
    }
    if let Some((_, what)) = OTHERS.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err((*what).to_owned());
    }
    if head.trim_ascii_start().starts_with(b"{") {
        return Err("is JSON, as city models are, and no volume; [city] files would be right".to_owned());
    }
    if head.starts_with(nrrd::MAGIC) {
        return Ok(Format::Nrrd);
    }
    if head.starts_with(vtk::MAGIC) || head.get(..14).is_some_and(|h| h.eq_ignore_ascii_case(vtk::MAGIC)) {
        return Ok(Format::Vtk);
    }
    if head.starts_with(b"CDF\x01") || head.starts_with(b"CDF\x02") || head.starts_with(b"CDF\x05") {
        return Ok(Format::NetCdf);
    }
    if head.starts_with(b"\x89HDF\r\n\x1a\n") {
        return Ok(Format::NetCdf);
    }
    if is_nifti(head) {
        return Ok(Format::Nifti);
    }
    let text = head.trim_ascii_start();
    if text.starts_with(b"<") {
        return if has(b"<VTKFile") { Ok(Format::Vti) } else { Err(format!("is XML, but no VTKFile. {READABLE}")) };
    }
    if has(b"ElementDataFile") || (has(b"DimSize") && has(b"NDims")) {
        return Ok(Format::MetaImage);
    }
    let is_line = |keys: &[&[u8]]| {
        let mut lines = head.split(|b| *b == b'\n').map(<[u8]>::trim_ascii_start);
        lines.any(|line| keys.iter().any(|key| is_keyword(line, key)))
    };
    if is_line(&[b"object"]) && has(b"class") {
        return Ok(Format::Dx);
    }
    let is_given = |line: &[u8]| line.contains(&b'=');
    let has_grid = head.split(|b| *b == b'\n').any(|line| {
        let line = line.trim_ascii_start();
        (is_keyword(line, b"grid") || is_keyword(line, b"points")) && is_given(line)
    });
    if has_grid && !head.contains(&0) {
        return Ok(Format::General);
    }
    match extension.as_str() {
        "nrrd" | "nhdr" => Err("begins without NRRD0001 to NRRD0005; it is no NRRD file".into()),
        "mha" | "mhd" => Ok(Format::MetaImage),
        "vti" | "vtr" | "vts" | "vtu" => Err("has no element VTKFile; it is no VTK XML file".into()),
        "vtk" => Err("begins without \"# vtk DataFile\"; it is no legacy VTK file".into()),
        "dx" => Ok(Format::Dx),
        "general" => Ok(Format::General),
        "nii" | "hdr" | "img" => Err("has no header of NIfTI-1 (348 bytes, \"n+1\" or \"ni1\" at byte 344)".into()),
        "nc" | "nc4" | "cdf" => Err("begins with neither \"CDF\" nor HDF5's signature; it is no NetCDF file".into()),
        _ if head.contains(&0) => Err(format!("is binary data of no format known here. {READABLE}")),
        _ => Err(format!("is text of no format known here. {READABLE}")),
    }
}

fn is_keyword(line: &[u8], key: &[u8]) -> bool {
    let own = line.get(..key.len()).is_some_and(|word| word.eq_ignore_ascii_case(key));
    own && line.get(key.len()).is_none_or(|b| !b.is_ascii_alphanumeric() && *b != b'_')
}

/// Whether the header's own size stands first, in either order: 348 bytes, or 540 of version 2.
fn is_nifti(head: &[u8]) -> bool {
    let sizes: [[u8; 4]; 4] =
        [348_u32.to_le_bytes(), 348_u32.to_be_bytes(), 540_u32.to_le_bytes(), 540_u32.to_be_bytes()];
    head.len() >= 348 && sizes.iter().any(|size| head.starts_with(size))
}

#[cfg(test)]
mod tests {
    use crate::field::testing::{load, refused};

    #[test]
    fn what_is_no_field_is_named() {
        for (name, bytes, wanted) in [
            ("a.dx", &b""[..], "is empty (0 bytes)"),
            ("a.nrrd", b"hello", "no NRRD file"),
            ("a.vti", b"hello", "no VTK XML file"),
            ("a.vtk", b"hello", "no legacy VTK file"),
            ("a.nii", b"hello", "no header of NIfTI-1"),
            ("a.nc", b"hello", "no NetCDF file"),
            ("a.xyz", b"hello", "is text of no format known here. Veduta reads"),
            ("a.xyz", b"hel\0lo", "is binary data of no format known here"),
            ("a.xyz", b"<gml/>", "is XML, but no VTKFile"),
            ("a.dx", b"hello", "stands where `object` or `end` belongs"),
            ("a.general", b"hello", "is no statement"),
            ("a.mhd", b"hello", "is no line of a header"),
            ("a.nc", b"CDF\x01", "NetCDF"),
            ("a.gz", &[0x1f, 0x8b, 8, 0], "gzip that ends early"),
        ] {
            let message = refused(load(name, bytes));
            assert!(message.contains(wanted), "{wanted}: {message}");
        }
    }

    #[test]
    fn content_goes_before_names() {
        let nrrd = "NRRD0001\ntype: uint8\ndimension: 1\nsizes: 1\nencoding: text\n\n7";
        assert_eq!(load("a.vtk", nrrd).unwrap().format, "NRRD");
        assert_eq!(load("a.txt", "grid = 1\nend\n7").unwrap().format, "general array (OpenDX)");
    }
}
