//! How a file is made wrong: as bytes, as text with numbers, as JSON, as lines; inside gzip and GLB too.

use std::io::{Read, Write};

use serde_json::Value;

use crate::random::Random;

/// What stands where a number stood.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "18446744073709551615",
    "99999999999999999999999",
    "0.5",
    "-0.1",
    "1e-7",
    "1e-320",
    "1e9",
    "1.0000001e9",
    "1e15",
    "3.4e38",
    "1e300",
    "1.7976931348623157e308",
    "1e999",
    "-1e999",
    "NaN",
    "inf",
    "-Infinity",
    "null",
    "true",
    "\"1\"",
    "[]",
    "{}",
    "[[]]",
    "",
    "1,",
    "01",
    "1e",
    "--1",
    "0x10",
    "5120",
    "5121",
    "5126",
];

/// Words that mean something to some loader.
const WORDS: &[&str] = &[
    "CityJSON",
    "CityJSONFeature",
    "CityObjects",
    "vertices",
    "transform",
    "scale",
    "translate",
    "type",
    "version",
    "1.0",
    "1.1",
    "2.0",
    "Building",
    "TINRelief",
    "GeometryInstance",
    "MultiSolid",
    "CompositeSolid",
    "Solid",
    "MultiSurface",
    "MultiPoint",
    "template",
    "templates",
    "vertices-templates",
    "geometry-templates",
    "transformationMatrix",
    "boundaries",
    "semantics",
    "surfaces",
    "values",
    "lod",
    "parents",
    "children",
    "attributes",
    "appearance",
    "textures",
    "materials",
    "texture",
    "material",
    "referenceSystem",
    "https://www.opengis.net/def/crs/EPSG/0/6697",
    "POSITION",
    "NORMAL",
    "TEXCOORD_0",
    "COLOR_0",
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT4",
    "sparse",
    "bufferView",
    "byteStride",
    "byteOffset",
    "count",
    "normalized",
    "mesh",
    "nodes",
    "extras",
    "EXT_mesh_gpu_instancing",
    "CESIUM_RTC",
    "image",
    "../../etc/passwd",
    "/dev/zero",
    "a\u{0}b",
    "\u{feff}",
    "data:;base64,AAAA",
    "v ",
    "vt ",
    "vn ",
    "f ",
    "o ",
    "g ",
    "usemtl ",
    "mtllib ",
    "newmtl ",
    "map_Kd ",
    "Kd ",
    "\\\n",
    "//",
    "-1/-1/-1",
    "1//",
    "#",
];

/// A wrong version of a seed file: one to four changes.
pub fn mutated(bytes: &[u8], name: &str, random: &mut Random) -> Vec<u8> {
    let mut out = bytes.to_vec();
    if name.ends_with(".gz") && !random.once_in(4) {
        let mut inner = Vec::new();
        // A seed is right; after the first change it may not be, and then what could be unpacked is taken.
        let _ = flate2::read::MultiGzDecoder::new(bytes).take(1 << 24).read_to_end(&mut inner);
        return gzip(&mutated(&inner, name.trim_end_matches(".gz"), random));
    }
    for _ in 0..=random.below(4) {
        out = change(out, name, random);
        out.truncate(1 << 22);
    }
    out
}

fn change(bytes: Vec<u8>, name: &str, random: &mut Random) -> Vec<u8> {
    if bytes.starts_with(b"glTF") && !random.once_in(4) {
        return change_glb(&bytes, random);
    }
    let is_text = !bytes.contains(&0);
    match random.below(8) {
        0..=2 if is_text && (name.contains("json") || name.ends_with("gltf")) => change_json(bytes, random),
        3 | 4 if is_text => change_number(bytes, random),
        5 if is_text => change_lines(bytes, random),
        6 => insert_word(bytes, random),
        _ => change_bytes(bytes, random),
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("a Vec takes all");
    encoder.finish().expect("a Vec takes all")
}

/// Flips, sets, cuts, repeats, moves.
fn change_bytes(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let length = bytes.len();
    if length == 0 {
        return vec![b'{'];
    }
    let at = random.below(length);
    match random.below(7) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => {
            bytes[at] = *random.pick(&[0, 1, 0x7f, 0x80, 0xff, b'"', b'[', b']', b'{', b'}', b',', b'\n', b'\r', b' '])
        }
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(random.range(length, 64))),
        4 => {
            let piece = bytes[random.range(length, 64)].to_vec();
            bytes.splice(at..at, piece.repeat(1 + random.below(8)));
        }
        5 => {
            let end = (at + 4).min(length);
            let word =
                random.pick(&[0u32, 1, 0x7fff_ffff, 0x8000_0000, u32::MAX, 0x7fc0_0000, 0x7f80_0000, 0x0001_0000]);
            bytes[at..end].copy_from_slice(&word.to_le_bytes()[..end - at]);
        }
        _ => {
            let piece: Vec<u8> = bytes.drain(random.range(length, 256)).collect();
            let to = random.below(bytes.len() + 1);
            bytes.splice(to..to, piece);
        }
    }
    bytes
}

fn insert_word(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let at = random.below(bytes.len() + 1);
    let end = if random.once_in(2) { at } else { (at + 8).min(bytes.len()) };
    bytes.splice(at..end, random.pick(WORDS).bytes());
    bytes
}

/// Another number in the place of one, or of a few.
fn change_number(bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let is_part = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e' | b'E');
    let mut starts: Vec<usize> = Vec::new();
    for (i, b) in bytes.iter().enumerate() {
        if b.is_ascii_digit() && (i == 0 || !is_part(bytes[i - 1])) {
            starts.push(i);
        }
    }
    if starts.is_empty() {
        return change_bytes(bytes, random);
    }
    let start = *random.pick(&starts);
    let end = bytes[start..].iter().position(|b| !is_part(*b)).map_or(bytes.len(), |n| start + n);
    let number = random.pick(NUMBERS).bytes();
    let mut out = bytes;
    out.splice(start..end, number);
    out
}

/// Lines taken out, doubled, swapped.
fn change_lines(bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let mut lines: Vec<&[u8]> = bytes.split_inclusive(|b| *b == b'\n').collect();
    let count = lines.len();
    let (a, b) = (random.below(count), random.below(count));
    match random.below(4) {
        0 if count > 0 => drop(lines.remove(a)),
        1 if count > 0 => lines.insert(b, lines[a]),
        2 if count > 0 => lines.swap(a, b),
        _ => {
            let words: Vec<&[u8]> = bytes.split_inclusive(u8::is_ascii_whitespace).collect();
            let mut words = words;
            let (a, b) = (random.below(words.len()), random.below(words.len()));
            if !words.is_empty() {
                words.swap(a, b);
            }
            return words.concat();
        }
    }
    lines.concat()
}

/// Changes the JSON tree, where there is one; in a sequence, of one line.
fn change_json(bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let mut lines: Vec<Vec<u8>> = match serde_json::from_slice::<Value>(&bytes) {
        Ok(_) => vec![bytes.clone()],
        Err(_) => bytes.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect(),
    };
    let at = random.below(lines.len());
    let Ok(mut tree) = serde_json::from_slice::<Value>(&lines[at]) else { return change_number(bytes, random) };
    let total = count(&tree);
    let source = nth(&mut tree, random.below(total)).clone();
    let node = nth(&mut tree, random.below(total));
    match random.below(10) {
        0 => *node = serde_json::from_str(random.pick::<&str>(NUMBERS)).unwrap_or(Value::Null),
        1 => *node = source,
        2 => *node = Value::String((*random.pick(WORDS)).to_owned()),
        3 => {
            for _ in 0..1 + random.below(100) {
                *node = Value::Array(vec![node.take()]);
            }
        }
        4 => *node = Value::Object([((*random.pick(WORDS)).to_owned(), node.take())].into_iter().collect()),
        _ => change_members(node, source, random),
    }
    lines[at] = tree.to_string().into_bytes();
    lines.join(&b'\n')
}

/// Takes out, doubles, renames, empties or adds members of a node.
fn change_members(node: &mut Value, source: Value, random: &mut Random) {
    match node {
        Value::Array(list) if list.is_empty() => list.push(source),
        Value::Array(list) => {
            let at = random.below(list.len());
            match random.below(6) {
                0 => drop(list.remove(at)),
                1 => {
                    let copies = *random.pick(&[1, 2, 100]);
                    let copy = list[at].clone();
                    if count(&copy) * copies < 20_000 {
                        list.extend(std::iter::repeat_n(copy, copies));
                    }
                }
                2 => list.clear(),
                3 => list.reverse(),
                4 => list[at] = source,
                _ => list.insert(at, source),
            }
        }
        Value::Object(map) => {
            let keys: Vec<String> = map.keys().cloned().collect();
            let key = if keys.is_empty() { String::new() } else { random.pick(&keys).clone() };
            match random.below(4) {
                0 => drop(map.remove(&key)),
                1 => {
                    let value = map.remove(&key).unwrap_or(Value::Null);
                    map.insert((*random.pick(WORDS)).to_owned(), value);
                }
                2 => drop(map.insert(key, source)),
                _ => drop(map.insert((*random.pick(WORDS)).to_owned(), source)),
            }
        }
        other => *other = serde_json::from_str(random.pick::<&str>(NUMBERS)).unwrap_or(Value::Null),
    }
}

/// Nodes of a tree, itself included.
fn count(tree: &Value) -> usize {
    match tree {
        Value::Array(list) => 1 + list.iter().map(count).sum::<usize>(),
        Value::Object(map) => 1 + map.values().map(count).sum::<usize>(),
        _ => 1,
    }
}

/// Node `n` in reading order.
fn nth(tree: &mut Value, mut n: usize) -> &mut Value {
    if n == 0 {
        return tree;
    }
    n -= 1;
    let children: Vec<&mut Value> = match tree {
        Value::Array(list) => list.iter_mut().collect(),
        Value::Object(map) => map.values_mut().collect(),
        _ => unreachable!("counted before"),
    };
    for child in children {
        let size = count(child);
        if n < size {
            return nth(child, n);
        }
        n -= size;
    }
    unreachable!("counted before")
}

/// Changes the JSON or the binary chunk and packs them again; the lengths are right, mostly.
fn change_glb(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let length = |at: usize| bytes.get(at..at + 4).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let json_end = (20 + length(12)).min(bytes.len());
    let mut json = bytes.get(20..json_end).unwrap_or(&[]).to_vec();
    let mut binary = bytes.get(json_end + 8..).unwrap_or(&[]).to_vec();
    match random.below(3) {
        0 => binary = change_bytes(binary, random),
        1 => json = change_json(json, random),
        _ => json = change_number(json, random),
    }
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = (28 + json.len() + binary.len()) as u32;
    let lying = random.once_in(10);
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((if lying { total ^ 1 << random.below(32) } else { total }).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}
