//! The format of a file: by its content first, by its name where the content says little.

use std::path::Path;

use crate::city::load::{
    input::{self, Input},
    options::LFS_POINTER,
};

/// The formats that can be read, for messages.
pub(super) const READABLE: &str =
    "Veduta reads CityJSON (.json), CityJSONSeq (.jsonl), glTF (.gltf, .glb) and OBJ (.obj), each also .gz";

/// The formats told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// CityJSON and CityJSONSeq: the loader tells them apart by what follows the first object.
    CityJson,
    /// glTF 2.0, text or binary.
    Gltf,
    /// Wavefront OBJ.
    Obj,
    /// A format of city models that cannot be read yet, by name.
    Known(&'static str),
    /// No city model; the sentence says what it is.
    Not(&'static str),
}

/// First bytes that give a format away.
const MAGIC: &[(&[u8], Format)] = &[
    (b"glTF", Format::Gltf),
    (b"b3dm", Format::Known("3D Tiles (b3dm)")),
    (b"i3dm", Format::Known("3D Tiles (i3dm)")),
    (b"cmpt", Format::Known("3D Tiles (cmpt)")),
    (b"pnts", Format::Known("3D Tiles (pnts, a point cloud)")),
    (b"ISO-10303-21", Format::Known("IFC (STEP)")),
    (b"fcb\x01", Format::Known("FlatCityBuf")),
    (b"LASF", Format::Known("LAS (a point cloud)")),
    (b"ply\n", Format::Known("PLY")),
    (b"ply\r", Format::Known("PLY")),
    (b"\x89PNG", Format::Not("is a PNG image, not a city model")),
    (b"\xff\xd8\xff", Format::Not("is a JPEG image, not a city model")),
    (b"GIF8", Format::Not("is a GIF image, not a city model")),
    (b"II*\0", Format::Not("is a TIFF image, not a city model")),
    (b"MM\0*", Format::Not("is a TIFF image, not a city model")),
    (LFS_POINTER, Format::Not("is a Git LFS pointer, not the file itself; `git lfs pull` brings that")),
    (b"%PDF", Format::Not("is a PDF document, not a city model")),
    (b"PK\x03\x04", Format::Not("is a ZIP archive; unpack it and name the model inside")),
    (b"7z\xbc\xaf", Format::Not("is a 7-Zip archive; unpack it and name the model inside")),
    (b"\xfd7zXZ", Format::Not("is xz-compressed; unpack it, or use gzip")),
    (b"BZh", Format::Not("is bzip2-compressed; unpack it, or use gzip")),
    (b"\x28\xb5\x2f\xfd", Format::Not("is zstd-compressed; unpack it, or use gzip")),
    (b"\xff\xfe", Format::Not("is UTF-16 text; save it as UTF-8")),
    (b"\xfe\xff", Format::Not("is UTF-16 text; save it as UTF-8")),
    (b"\0\0\xfe\xff", Format::Not("is UTF-32 text; save it as UTF-8")),
    (b"\x7fELF", Format::Not("is a program, not a city model")),
];

/// The format of these bytes.
pub(super) fn format(input: &Input) -> Format {
    let bytes = &input.bytes[..];
    if bytes.is_empty() {
        return Format::Not("is empty (0 bytes); is the download complete?");
    }
    if let Some((_, format)) = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return *format;
    }
    let extension = input.extension();
    let head = &bytes[..bytes.len().min(8192)];
    let Some(start) = head.iter().position(|b| !b.is_ascii_whitespace()) else {
        return Format::Not("holds nothing but white space");
    };
    match head[start] {
        b'{' if head.get(start + 1) == Some(&0) => Format::Not("is UTF-16 text; save it as UTF-8"),
        b'{' => json(head, &extension),
        b'<' => xml(head),
        b'[' => Format::Not("is a JSON list; a CityJSON file is one object, {\"type\": \"CityJSON\", ...}"),
        _ => text(head, &extension),
    }
}

fn has(head: &[u8], needle: &str) -> bool {
    head.windows(needle.len()).any(|w| w == needle.as_bytes())
}

/// A JSON object: CityJSON unless it clearly is something else; its loader explains what is missing.
fn json(head: &[u8], extension: &str) -> Format {
    let city = has(head, "\"CityJSON") || has(head, "\"CityObjects\"");
    match extension {
        "gltf" => Format::Gltf,
        _ if city => Format::CityJson,
        _ if has(head, "\"asset\"") && (has(head, "\"root\"") || has(head, "\"geometricError\"")) => {
            Format::Known("3D Tiles (tileset.json)")
        }
        _ if has(head, "\"FeatureCollection\"") || has(head, "\"Feature\"") => Format::Known("GeoJSON"),
        _ if has(head, "\"asset\"") => Format::Gltf,
        _ if has(head, "\"layerType\"") => Format::Known("I3S"),
        _ => Format::CityJson,
    }
}

fn xml(head: &[u8]) -> Format {
    if has(head, "citygml") || has(head, "CityModel") {
        Format::Known("CityGML")
    } else if has(head, "indoorgml") {
        Format::Known("IndoorGML")
    } else if has(head, "/kml") {
        Format::Known("KML")
    } else if has(head, "COLLADA") {
        Format::Known("COLLADA")
    } else if has(head, "ifcXML") || has(head, "ifcxml") {
        Format::Known("ifcXML")
    } else if has(head, "opengis.net/gml") {
        Format::Known("GML")
    } else if has(head, "<html") || has(head, "<HTML") || has(head, "<!DOCTYPE html") {
        Format::Not("is a web page; did the download fail?")
    } else {
        Format::Not("is XML, but no city model that is known here")
    }
}

/// Neither JSON nor XML: OBJ, or binary, or nothing we know.
fn text(head: &[u8], extension: &str) -> Format {
    let words = [&b"v "[..], b"vn ", b"vt ", b"f ", b"o ", b"g ", b"mtllib ", b"usemtl "];
    let is_obj = head.split(|b| *b == b'\n').any(|line| words.iter().any(|w| line.trim_ascii_start().starts_with(w)));
    match extension {
        "obj" => Format::Obj,
        "gltf" | "glb" => Format::Gltf,
        "ifc" => Format::Known("IFC"),
        "shp" => Format::Known("Shapefile"),
        "gpkg" => Format::Known("GeoPackage"),
        "las" | "laz" => Format::Known("LAS/LAZ (a point cloud)"),
        "stl" => Format::Known("STL"),
        "dae" => Format::Known("COLLADA"),
        "fbx" => Format::Known("FBX"),
        "skp" => Format::Known("SketchUp"),
        "3ds" => Format::Known("3DS"),
        "json" | "jsonl" if !head.contains(&0) => Format::CityJson,
        _ if head.contains(&0) => Format::Not("is binary data of no format known here"),
        _ if is_obj => Format::Obj,
        _ => Format::Not("is text, but no city model that is known here"),
    }
}

/// Whether a file of a folder is worth opening: images, buffers and notes lie beside models.
pub(super) fn looks_like_a_city(path: &Path) -> bool {
    let models = ["json", "jsonl", "gltf", "glb", "obj", "gml", "xml", "b3dm", "ifc", "fcb", "geojson"];
    models.contains(&input::extension(path).as_str())
}
