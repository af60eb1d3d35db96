//! The outside of a glTF file: the GLB box, the JSON inside, versions and required extensions.

use serde::Deserialize;

use super::document::{Document, DocumentError, said};
use crate::city::{
    load::{error::LoadError, input::Input},
    warning::{WarningCode, Warnings},
};

/// Extensions a file may require: read, or without effect on what is shown here.
const READ_EXTENSIONS: &[&str] = &[
    "KHR_materials_unlit",
    "KHR_texture_transform",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "CESIUM_RTC",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "EXT_feature_metadata",
    "KHR_lights_punctual",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_clearcoat",
    "KHR_materials_sheen",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_transmission",
    "KHR_materials_anisotropy",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_texture_webp",
    "EXT_lights_image_based",
    "EXT_instance_features",
    "CESIUM_primitive_outline",
];

/// The part of a file that must be known before the rest can be believed.
#[derive(Deserialize)]
struct Head {
    asset: Option<Asset>,
    #[serde(default, rename = "extensionsRequired")]
    required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

/// A glTF file, opened but not yet followed.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The version that it says it is of.
    pub version: String,
    pub document: Document,
    /// The binary chunk of a GLB.
    pub binary: Option<&'a [u8]>,
}

/// Opens `.gltf` or `.glb`, whichever the bytes are.
pub(super) fn open<'a>(input: &'a Input, warnings: &mut Warnings) -> Result<Container<'a>, LoadError> {
    let (json, binary) = match input.bytes.starts_with(b"glTF") {
        true => split_glb(input, warnings)?,
        false => (&input.bytes[..], None),
    };
    let chunk = if input.bytes.starts_with(b"glTF") { "JSON chunk, " } else { "" };
    let failed = |e: serde_json::Error| {
        let place = format!("{chunk}line {} column {}", e.line(), e.column());
        let what = said(&e);
        let hint = match e.classify() {
            serde_json::error::Category::Eof => "; the file ends early: is the download complete?",
            _ => "",
        };
        LoadError::at(&input.path, place, format!("{what}{hint}"))
    };
    let head: Head = serde_json::from_slice(json).map_err(failed)?;
    let Some(asset) = head.asset else {
        return Err(LoadError::new(&input.path, "has no \"asset\" object with a version, so it is no glTF file"));
    };
    if !asset.version.starts_with("2.") {
        let message = format!("is glTF {}; glTF 2.0 is read, convert it", asset.version.escape_debug());
        return Err(LoadError::at(&input.path, "asset.version", message));
    }
    if let Some(unread) = head.required.iter().find(|e| !READ_EXTENSIONS.contains(&e.as_str())) {
        let message = format!("the file requires {}, which cannot be read; {}", unread.escape_debug(), advice(unread));
        return Err(LoadError::at(&input.path, "extensionsRequired", message));
    }
    let document = Document::parse(json).map_err(|error| match error {
        DocumentError::Syntax(error) => failed(error),
        DocumentError::Member(name, what) => LoadError::at(&input.path, format!("{chunk}{name}"), what),
    })?;
    Ok(Container { version: asset.version, document, binary })
}

/// Advice about an extension that is not read.
fn advice(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "export it without mesh compression"
        }
        "KHR_texture_basisu" | "EXT_texture_avif" | "MSFT_texture_dds" => "export its textures as PNG or JPEG",
        _ => "export it without that extension",
    }
}

/// The JSON and the binary chunk of a GLB: 12 bytes of header, then chunks of length, type, content (glTF 2.0, 4.4).
fn split_glb<'a>(input: &'a Input, warnings: &mut Warnings) -> Result<(&'a [u8], Option<&'a [u8]>), LoadError> {
    let bytes = &input.bytes[..];
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let short = |place: &str, what: String| LoadError::at(&input.path, place, what);
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(short("GLB header", format!("the file ends after {} bytes, inside the header", bytes.len())));
    };
    if version != 2 {
        return Err(short("GLB header", format!("is GLB version {version}; version 2 (glTF 2.0) is read, convert it")));
    }
    if length != bytes.len() {
        let code = if length > bytes.len() { WarningCode::TruncatedFile } else { WarningCode::Malformed };
        warnings.add(code, "", || {
            let file = input.path.display();
            format!("{file}, GLB header: says {length} bytes, the file has {}; what is there is read", bytes.len())
        });
    }
    let (Some(json_length), Some(kind)) = (word(12), bytes.get(16..20)) else {
        return Err(short("GLB JSON chunk", format!("the file ends after {} bytes, before any content", bytes.len())));
    };
    if kind != b"JSON" {
        return Err(short("byte 16", "the first chunk of a GLB must be JSON".into()));
    }
    let rest = &bytes[20..];
    let Some(json) = rest.get(..json_length) else {
        let message =
            format!("says {json_length} bytes, {} are left in the file; is the download complete?", rest.len());
        return Err(short("GLB JSON chunk", message));
    };
    let mut at = 20 + json_length;
    // Chunks of other types are ignored, as the specification wants.
    while let (Some(declared), Some(kind)) = (word(at), bytes.get(at + 4..at + 8)) {
        let content = &bytes[at + 8..];
        if kind == b"BIN\0" {
            if declared > content.len() {
                warnings.add(WarningCode::TruncatedFile, "", || {
                    let (file, left) = (input.path.display(), content.len());
                    format!("{file}, GLB BIN chunk: says {declared} bytes, {left} are left in the file")
                });
            }
            return Ok((json, Some(&content[..declared.min(content.len())])));
        }
        at = at.saturating_add(8).saturating_add(declared);
        if at > bytes.len() {
            break;
        }
    }
    Ok((json, None))
}
