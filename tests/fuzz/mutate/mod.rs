//! How a file is made wrong: as bytes, as text with numbers, as lines, as a tree of JSON or TOML, as WGSL, as chunks of a PNG; inside gzip and GLB
//! too.

mod png;
mod tree;
mod wgsl;
mod words;

use std::io::{Read, Write};

use crate::studio::random_scene::Random;

pub use tree::Pool;
use words::NUMBERS;

/// A wrong version of a seed file: one to four changes. `pool` has what other files of its kind say.
pub fn mutated(bytes: &[u8], name: &str, pool: &Pool, random: &mut Random) -> Vec<u8> {
    let mut out = bytes.to_vec();
    if name.ends_with(".gz") && !random.once_in(4) {
        let mut inner = Vec::new();
        // A seed is right; after the first change it may not be, and then what could be unpacked is taken.
        let _ = flate2::read::MultiGzDecoder::new(bytes).take(1 << 24).read_to_end(&mut inner);
        return gzip(&mutated(&inner, name.trim_end_matches(".gz"), pool, random));
    }
    for _ in 0..=random.below(4) {
        out = change(out, name, pool, random);
        out.truncate(1 << 22);
    }
    out
}

fn change(bytes: Vec<u8>, name: &str, pool: &Pool, random: &mut Random) -> Vec<u8> {
    if bytes.starts_with(b"glTF") && !random.once_in(4) {
        return change_glb(&bytes, pool, random);
    }
    if bytes.starts_with(png::SIGNATURE) && !random.once_in(4) {
        return png::change(&bytes, random);
    }
    // Headers of fields are text before what may be none.
    let is_text = is_field(name) || !bytes.contains(&0);
    let is = |ending: &str| name.ends_with(ending);
    match random.below(8) {
        0..=2 if is_text && (name.contains("json") || is("gltf")) => tree::change_json(bytes, pool, random),
        0..=3 if is_text && is("toml") => tree::change_toml(bytes, pool, random),
        0..=4 if is_text && is("wgsl") => wgsl::change(bytes, pool, random),
        3 | 4 if is_text => change_number(bytes, random),
        5 if is_text => change_lines(bytes, random),
        6 => insert_word(bytes, words_of(name), random),
        _ => change_bytes(bytes, random),
    }
}

/// Whether a file is a field, or is beside one, by the name that seeds have.
fn is_field(name: &str) -> bool {
    name.contains(".field.")
}

/// What may mean something to the reader of a file of this name.
fn words_of(name: &str) -> &'static [&'static str] {
    match name.rsplit('.').next() {
        _ if is_field(name) => words::WORDS_OF_FIELDS,
        Some("toml") => words::WORDS_OF_SCENES,
        Some("wgsl") => words::WORDS_OF_WGSL,
        _ => words::WORDS,
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

fn insert_word(mut bytes: Vec<u8>, words: &[&str], random: &mut Random) -> Vec<u8> {
    let at = random.below(bytes.len() + 1);
    let end = if random.once_in(2) { at } else { (at + 8).min(bytes.len()) };
    bytes.splice(at..end, random.pick(words).bytes());
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

/// Changes the JSON or the binary chunk and packs them again; the lengths are right, mostly.
fn change_glb(bytes: &[u8], pool: &Pool, random: &mut Random) -> Vec<u8> {
    let length = |at: usize| bytes.get(at..at + 4).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let json_end = (20 + length(12)).min(bytes.len());
    let mut json = bytes.get(20..json_end).unwrap_or(&[]).to_vec();
    let mut binary = bytes.get(json_end + 8..).unwrap_or(&[]).to_vec();
    match random.below(3) {
        0 => binary = change_bytes(binary, random),
        1 => json = tree::change_json(json, pool, random),
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
