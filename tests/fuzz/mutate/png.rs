//! PNGs, chunk by chunk: checksums are right, mostly, so that what is inside is read.

use std::io::Read;

use super::change_bytes;
use crate::studio::random_scene::Random;

pub const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

const TYPES: &[&[u8; 4]] = &[
    b"IHDR", b"PLTE", b"IDAT", b"IEND", b"tRNS", b"gAMA", b"iCCP", b"zTXt", b"pHYs", b"acTL", b"fcTL", b"fdAT", b"sRGB",
];

/// What an image may say of its sides.
const SIDES: &[u32] = &[0, 1, 7, 255, 8193, 32_768, 32_769, 65_535, 0x7fff_ffff, 0x8000_0000, u32::MAX];

struct Chunk {
    kind: [u8; 4],
    data: Vec<u8>,
}

fn chunks(bytes: &[u8]) -> Vec<Chunk> {
    let mut found = Vec::new();
    let mut rest = bytes.get(SIGNATURE.len()..).unwrap_or_default();
    while let Some((head, after)) = rest.split_at_checked(8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let Some((data, end)) = after.split_at_checked(length) else { break };
        found.push(Chunk { kind: [head[4], head[5], head[6], head[7]], data: data.to_vec() });
        rest = end.get(4..).unwrap_or_default();
    }
    found
}

/// Changes a chunk, or what a packed one holds, and packs all again.
pub fn change(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut all = chunks(bytes);
    if all.is_empty() {
        return change_bytes(bytes.to_vec(), random);
    }
    let (at, other) = (random.below(all.len()), random.below(all.len()));
    match random.below(8) {
        0 => all.swap(at, other),
        1 => drop(all.remove(at)),
        2 => {
            let copy = Chunk { kind: all[at].kind, data: all[at].data.clone() };
            all.insert(other, copy);
        }
        3 => all[at].kind = **random.pick(TYPES),
        4 => all.insert(other, Chunk { kind: **random.pick(TYPES), data: vec![0; random.below(40)] }),
        5 => {
            let side = random.pick(SIDES).to_be_bytes();
            let from = 4 * random.below(2);
            if let Some(number) = all[0].data.get_mut(from..from + 4) {
                number.copy_from_slice(&side);
            }
        }
        6 => {
            if let Some(data) = all.iter_mut().find(|chunk| &chunk.kind == b"IDAT") {
                let mut rows = Vec::new();
                let _ = flate2::read::ZlibDecoder::new(data.data.as_slice()).take(1 << 22).read_to_end(&mut rows);
                let rows = change_bytes(rows, random);
                let mut packed = flate2::read::ZlibEncoder::new(rows.as_slice(), flate2::Compression::fast());
                data.data.clear();
                let _ = packed.read_to_end(&mut data.data);
            }
        }
        _ => all[at].data = change_bytes(std::mem::take(&mut all[at].data), random),
    }
    let mut out = SIGNATURE.to_vec();
    for chunk in all {
        out.extend((chunk.data.len() as u32).to_be_bytes());
        let start = out.len();
        out.extend(chunk.kind);
        out.extend(chunk.data);
        let mut crc = flate2::Crc::new();
        crc.update(&out[start..]);
        out.extend(if random.once_in(30) { 7 } else { crc.sum() }.to_be_bytes());
    }
    out
}
