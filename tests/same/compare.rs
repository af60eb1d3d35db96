//! What two programs wrote, compared.

use std::{
    collections::BTreeSet,
    io,
    path::{Path, PathBuf},
};

use serde_json::Value;

/// Keys of statistics that differ from run to run: times, and the memory of the process.
const OF_THE_RUN: [&str; 4] = ["ms", "cpu_ms", "gpu_ms", "peak_bytes"];
/// Texts of PNGs that differ from version to version.
const OF_THE_VERSION: [&str; 2] = ["Software", "veduta:scene"];

/// Two files that differ.
#[derive(Debug)]
pub struct Difference {
    /// Path below the folder of the run.
    pub file: String,
    /// How.
    pub what: String,
}

/// Two folders compared.
#[derive(Debug, Default)]
pub struct Compared {
    /// How many files either has.
    pub files: usize,
    /// Those that differ.
    pub differences: Vec<Difference>,
}

/// Compares all files below two folders.
pub fn folders(before: &Path, now: &Path) -> io::Result<Compared> {
    let [of_before, of_now] = [files(before)?, files(now)?];
    let mut compared = Compared::default();
    for file in of_before.union(&of_now) {
        compared.files += 1;
        let what = match (of_before.contains(file), of_now.contains(file)) {
            (true, true) => file_pair(&before.join(file), &now.join(file))?,
            (true, false) => Some("is not written any more".to_owned()),
            _ => Some("was not written before".to_owned()),
        };
        compared.differences.extend(what.map(|what| Difference { file: file.display().to_string(), what }));
    }
    Ok(compared)
}

/// All files below a folder.
fn files(folder: &Path) -> io::Result<BTreeSet<PathBuf>> {
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = PathBuf::from(path.file_name().unwrap_or_default());
        if path.is_dir() {
            found.extend(files(&path)?.into_iter().map(|file| name.join(file)));
        } else {
            found.insert(name);
        }
    }
    Ok(found)
}

/// How two files differ, if they do.
fn file_pair(before: &Path, now: &Path) -> io::Result<Option<String>> {
    let [a, b] = [std::fs::read(before)?, std::fs::read(now)?];
    if a == b {
        return Ok(None);
    }
    let differs = match before.extension().and_then(|extension| extension.to_str()) {
        Some("png") => png_pair(&a, &b),
        Some("json" | "jsonl") => json_pair(&a, &b),
        Some("txt") => Some(format!("was:\n{}\nis:\n{}", String::from_utf8_lossy(&a), String::from_utf8_lossy(&b))),
        _ => {
            let first = a.iter().zip(&b).take_while(|(a, b)| a == b).count();
            Some(format!("{} bytes, now {}; the first that differs is byte {first}", a.len(), b.len()))
        }
    };
    Ok(differs)
}

/// Chunks of a PNG: kind and content, without what names the version.
fn chunks(bytes: &[u8]) -> Option<Vec<(&[u8], &[u8])>> {
    let mut rest = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n")?;
    let mut chunks = Vec::new();
    while !rest.is_empty() {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let length = u32::from_be_bytes(*length) as usize;
        let (kind, content) = (after.get(..4)?, after.get(4..4 + length)?);
        rest = after.get(8 + length..)?;
        let is_text = matches!(kind, b"tEXt" | b"iTXt" | b"zTXt");
        let keyword = content.split(|byte| *byte == 0).next().unwrap_or_default();
        if !is_text || !OF_THE_VERSION.iter().any(|key| key.as_bytes() == keyword) {
            chunks.push((kind, content));
        }
    }
    Some(chunks)
}

fn png_pair(a: &[u8], b: &[u8]) -> Option<String> {
    let (Some(before), Some(now)) = (chunks(a), chunks(b)) else { return Some("no whole PNG".to_owned()) };
    if before == now {
        return None;
    }
    let decoded = |bytes: &[u8]| image::load_from_memory(bytes).map(|picture| picture.to_rgba16());
    let (Ok(before), Ok(now)) = (decoded(a), decoded(b)) else { return Some("no picture".to_owned()) };
    if before.dimensions() != now.dimensions() {
        return Some(format!("{:?} pixels, now {:?}", before.dimensions(), now.dimensions()));
    }
    let changed =
        before.pixels().zip(now.pixels()).map(|(a, b)| (0..4).map(|i| a.0[i].abs_diff(b.0[i])).max().unwrap_or(0));
    let (count, most) = changed.fold((0, 0), |(count, most), by| (count + u32::from(by > 0), most.max(by)));
    Some(match count {
        0 => "the same pixels, other metadata".to_owned(),
        _ => format!(
            "{count} of {} pixels, by up to {:.1} of 255",
            before.width() * before.height(),
            f32::from(most) / 257.0
        ),
    })
}

/// Each line of statistics is an object, or the whole file is one.
fn json_pair(a: &[u8], b: &[u8]) -> Option<String> {
    let values = |bytes: &[u8]| -> Option<Vec<Value>> {
        serde_json::Deserializer::from_slice(bytes).into_iter().collect::<Result<_, _>>().ok()
    };
    let (Some(before), Some(now)) = (values(a), values(b)) else { return Some("no JSON".to_owned()) };
    let mut differences = Vec::new();
    if before.len() != now.len() {
        differences.push(format!("{} objects, now {}", before.len(), now.len()));
    }
    for (i, (before, now)) in before.iter().zip(&now).enumerate() {
        value_pair(&i.to_string(), before, now, &mut differences);
    }
    let more = differences.len().saturating_sub(8);
    differences.truncate(8);
    if more > 0 {
        differences.push(format!("and {more} more"));
    }
    (!differences.is_empty()).then(|| differences.join("; "))
}

fn value_pair(path: &str, before: &Value, now: &Value, differences: &mut Vec<String>) {
    match (before, now) {
        (Value::Object(a), Value::Object(b)) => {
            let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            for key in keys.into_iter().filter(|key| !OF_THE_RUN.contains(&key.as_str())) {
                let [a, b] = [a, b].map(|object| object.get(key).unwrap_or(&Value::Null));
                value_pair(&format!("{path}.{key}"), a, b, differences);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                value_pair(&format!("{path}.{i}"), a, b, differences);
            }
        }
        (a, b) if a != b => differences.push(format!("{path} was {a}, is {b}")),
        _ => {}
    }
}
