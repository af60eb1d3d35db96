//! Files of depth sprites: OpenEXR, as `docs/sprites.md` describes them.

use std::{io::Cursor, path::Path};

use exr::{
    meta::{
        BlockDescription, MetaData,
        attribute::{AttributeValue, TileDescription},
        header::Header,
    },
    prelude::{FlatSamples, IntegerBounds, Text, Vec2},
};
use glam::{DVec2, DVec3};

use crate::{
    lens::{
        sprite::{DepthCode, Format, MOST_LAYERS, Mapping},
        sprite_volume::{SpriteSpace, SpriteVolume},
    },
    text::one_line,
    view::{Basis, MAX_SIZE},
};

/// Version of the format.
const VERSION: i32 = 1;
/// Intervals of a file, at most: texels times layers.
const MOST_INTERVALS: u64 = 1 << 25;
/// Intervals that a tile may have where the picture has fewer.
const MOST_BEYOND: u64 = 1 << 20;
/// Furthest that a coordinate may lie from the origin, metres, as in scene files.
const FAR_M: f64 = 1e9;
/// Axes are orthonormal to this.
const SKEW: f64 = 1e-6;
/// What would be right.
const RIGHT: &str = "a file that `veduta render --sprite` wrote would be right";

/// The file of a sprite, uncompressed numbers zipped; the same sprite gives the same bytes.
///
/// # Errors
/// What the format cannot hold, in words.
pub fn bytes(sprite: &SpriteVolume) -> Result<Vec<u8>, String> {
    use exr::prelude::{AnyChannel, AnyChannels, Compression, Encoding, Image, Layer, LayerAttributes, WritableImage};
    let SpriteVolume { space, origin, kept, layers, ends, code, crs } = sprite;
    let samples = |layer: u32, end: usize| {
        FlatSamples::F32(ends.iter().skip(layer as usize).step_by(*layers as usize).map(|e| e[end]).collect())
    };
    let channels = (0..*layers).flat_map(|layer| {
        let named = move |end: usize| Text::from(channel_name(layer, end).as_str());
        [0, 1].map(|end| AnyChannel::new(named(end), samples(layer, end)))
    });
    let mut attributes = LayerAttributes::named("veduta");
    attributes.software_name = Some(Text::from(concat!("Veduta ", env!("CARGO_PKG_VERSION"))));
    attributes.layer_position = Vec2(origin[0] as i32, origin[1] as i32);
    let mut put = |name: &str, value| attributes.other.insert(Text::from(name), value);
    put("veduta.sprite", AttributeValue::I32(VERSION));
    put("veduta.layers", AttributeValue::I32(*layers as i32));
    let Basis { right, up, forward } = space.basis;
    for (name, v) in [("eye", space.eye), ("right", right), ("up", up), ("forward", forward)] {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(v.to_array()) {
            put(&format!("veduta.{name}.{axis}"), AttributeValue::F64(value));
        }
    }
    let numbers =
        [("halfWidth", space.half.x), ("halfHeight", space.half.y), ("near", code.near_m), ("far", code.far_m)];
    for (name, value) in numbers {
        put(&format!("veduta.{name}"), AttributeValue::F64(value));
    }
    let texts = [
        ("projection", projection_word(space.is_orthographic)),
        ("format", code.format.word()),
        ("mapping", code.mapping.word()),
    ];
    let texts = texts.into_iter().chain(crs.as_ref().map(|crs| ("crs", crs.as_str())));
    for (name, text) in texts {
        let text = Text::new_or_none(text).ok_or_else(|| format!("{name} \"{text}\" is no text that OpenEXR holds"))?;
        put(&format!("veduta.{name}"), AttributeValue::Text(text));
    }
    let layer = Layer::new(
        (kept[0] as usize, kept[1] as usize),
        attributes,
        Encoding { compression: Compression::ZIP16, ..Encoding::default() },
        AnyChannels::sort(channels.collect()),
    );
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::from_dimensions((space.size[0] as usize, space.size[1] as usize));
    let mut out = Cursor::new(Vec::new());
    // One thread: the bytes must not depend on how many there are.
    image.write().non_parallel().to_buffered(&mut out).map_err(|error| error.to_string())?;
    let mut bytes = out.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Puts our own attributes in the order of their names: the writer keeps them in one that changes from run to run. Nothing moves
/// but these; they follow each other.
fn sort_attributes(bytes: &mut [u8]) {
    /// Magic number and version.
    const START: usize = 8;
    let text_end = |from: usize| from + bytes[from..].iter().position(|b| *b == 0).unwrap_or(0);
    let mut own: Vec<std::ops::Range<usize>> = Vec::new();
    let mut at = START;
    // Each is a name, a type, the size of its value, and that; an empty name ends them.
    while bytes.get(at).is_some_and(|b| *b != 0) {
        let type_end = text_end(text_end(at) + 1);
        let Some(size) = bytes.get(type_end + 1..type_end + 5) else { return };
        let end = type_end + 5 + size.iter().rev().fold(0, |all, byte| all << 8 | usize::from(*byte));
        if bytes[at..].starts_with(b"veduta.") {
            own.push(at..end);
        }
        at = end;
    }
    let (Some(first), true) = (own.first(), own.windows(2).all(|pair| pair[0].end == pair[1].start)) else { return };
    let start = first.start;
    let mut sorted: Vec<Vec<u8>> = own.iter().map(|range| bytes[range.clone()].to_vec()).collect();
    sorted.sort();
    let sorted = sorted.concat();
    bytes[start..start + sorted.len()].copy_from_slice(&sorted);
}

fn channel_name(layer: u32, end: usize) -> String {
    format!("interval{layer}.{}", ["entry", "exit"][end])
}

fn projection_word(is_orthographic: bool) -> &'static str {
    if is_orthographic { "orthographic" } else { "perspective" }
}

/// Reads a file.
///
/// # Errors
/// One line that names the file, what is wrong with it, and what would be right.
pub fn read(file: &Path) -> Result<SpriteVolume, String> {
    let name = file.display();
    if file.is_dir() {
        return Err(format!("{name} is a folder; {RIGHT}"));
    }
    let bytes = std::fs::read(file).map_err(|error| format!("{name}: cannot be read: {error}"))?;
    read_bytes(&bytes).map_err(|message| format!("{name} {message}"))
}

/// What is wrong with the values of an attribute.
fn wrong<T>(name: &str, message: impl std::fmt::Display) -> Result<T, String> {
    Err(format!("is no depth sprite: the attribute {name} {message}; {RIGHT}"))
}

/// The attributes of a file.
struct Attributes<'h>(&'h Header);

impl Attributes<'_> {
    fn get(&self, name: &str) -> Result<&AttributeValue, String> {
        let Some(text) = Text::new_or_none(name) else { return wrong(name, "is missing") };
        let found = self.0.own_attributes.other.get(&text);
        found.map_or_else(|| wrong(name, "is missing"), Ok)
    }

    fn integer(&self, name: &str, [least, most]: [i32; 2]) -> Result<i32, String> {
        match self.get(name)? {
            AttributeValue::I32(n) if (least..=most).contains(n) => Ok(*n),
            AttributeValue::I32(n) if least == most => wrong(name, format!("must be {least}, is {n}")),
            AttributeValue::I32(n) => wrong(name, format!("must be {least} to {most}, is {n}")),
            _ => wrong(name, "must be an int"),
        }
    }

    /// A number that is neither NaN nor beyond these.
    fn number(&self, name: &str, [least, most]: [f64; 2]) -> Result<f64, String> {
        match self.get(name)? {
            AttributeValue::F64(n) if (least..=most).contains(n) => Ok(*n),
            AttributeValue::F64(n) => wrong(name, format!("must be {least:?} to {most:?}, is {n}")),
            _ => wrong(name, "must be a double"),
        }
    }

    fn vector(&self, name: &str, most: f64) -> Result<DVec3, String> {
        let part = |axis: &str| self.number(&format!("{name}.{axis}"), [-most, most]);
        Ok(DVec3::new(part("x")?, part("y")?, part("z")?))
    }

    fn text(&self, name: &str) -> Result<String, String> {
        match self.get(name)? {
            AttributeValue::Text(text) => Ok(text.to_string()),
            _ => wrong(name, "must be a string"),
        }
    }

    fn word<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> Result<T, String> {
        let text = self.text(name)?;
        let found = words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value);
        let all = words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
        found.map_or_else(|| wrong(name, format!("must be one of {all}, is \"{text}\"")), Ok)
    }
}

/// What a file's attributes say: all but the intervals.
fn described(header: &Header) -> Result<SpriteVolume, String> {
    let attributes = Attributes(header);
    attributes.integer("veduta.sprite", [VERSION; 2])?;
    let layers = attributes.integer("veduta.layers", [1, MOST_LAYERS as i32])? as u32;
    let eye = attributes.vector("veduta.eye", FAR_M)?;
    let axes = ["right", "up", "forward"].map(|axis| attributes.vector(&format!("veduta.{axis}"), 2.0));
    let [right, up, forward] = axes;
    let (right, up, forward) = (right?, up?, forward?);
    let is_one = |v: DVec3| (v.length() - 1.0).abs() < SKEW;
    if !(is_one(right) && is_one(up) && is_one(forward) && (right.cross(up) + forward).length() < SKEW) {
        return wrong("veduta.forward", "must stand upright on veduta.right and veduta.up, all of length 1");
    }
    let is_orthographic =
        attributes.word("veduta.projection", &[(projection_word(false), false), (projection_word(true), true)])?;
    let half = |name: &str| attributes.number(name, [1e-6, 1e7]);
    let half = DVec2::new(half("veduta.halfWidth")?, half("veduta.halfHeight")?);
    let near_m = attributes.number("veduta.near", [1e-6, FAR_M])?;
    let mut mappings = Mapping::WORDS.to_vec();
    mappings.push((Mapping::ComplementaryW.word(), Mapping::ComplementaryW));
    let mapping = attributes.word("veduta.mapping", &mappings)?;
    let most = if mapping == Mapping::InverseW { f64::INFINITY } else { 1e12 };
    let far_m = attributes.number("veduta.far", [near_m, most])?;
    if far_m <= near_m {
        return wrong("veduta.far", format!("must lie beyond veduta.near, {near_m}"));
    }
    let format = attributes.word("veduta.format", &Format::WORDS)?;
    let crs = if attributes.get("veduta.crs").is_ok() { Some(attributes.text("veduta.crs")?) } else { None };

    let frame = header.shared_attributes.display_window;
    let side = |n: usize| u32::try_from(n).ok().filter(|n| (1..=MAX_SIZE).contains(n));
    let both = |size: Vec2<usize>| Some([side(size.0)?, side(size.1)?]);
    let Some((size, kept)) = both(frame.size).zip(both(header.layer_size)) else {
        let Vec2(w, h) = if both(frame.size).is_some() { header.layer_size } else { frame.size };
        return Err(format!("has {w}x{h} texels; 1 to {MAX_SIZE} on a side would be right"));
    };
    let intervals = u64::from(kept[0]) * u64::from(kept[1]) * u64::from(layers);
    if intervals > MOST_INTERVALS {
        let [w, h] = kept;
        return Err(format!(
            "has {w}x{h} texels of {layers} layers; at most {MOST_INTERVALS} intervals in all would be right"
        ));
    }
    if let BlockDescription::Tiles(TileDescription { tile_size: Vec2(w, h), .. }) = header.blocks {
        // A tile is made room for as a whole, however little of it the picture has.
        let tile = (w as u64).saturating_mul(h as u64).saturating_mul(layers.into());
        if tile > intervals.max(MOST_BEYOND) {
            return Err(format!("has tiles of {w}x{h} texels, more than it has itself; 64x64 would be right"));
        }
    }
    let position = header.own_attributes.layer_position;
    let place = [(position.0, frame.position.0), (position.1, frame.position.1)];
    let mut origin = [0; 2];
    for i in 0..2 {
        let from = i64::from(place[i].0) - i64::from(place[i].1);
        if from < 0 || from + i64::from(kept[i]) > i64::from(size[i]) {
            return Err("has a data window beside its display window; one within it would be right".to_owned());
        }
        origin[i] = from as u32;
    }
    Ok(SpriteVolume {
        space: SpriteSpace { eye, basis: Basis { right, up, forward }, is_orthographic, half, size },
        origin,
        kept,
        layers,
        ends: Vec::new(),
        code: DepthCode { mapping, near_m, far_m, format },
        crs,
    })
}

/// Reads the bytes of a file; the message goes on after its name.
pub fn read_bytes(bytes: &[u8]) -> Result<SpriteVolume, String> {
    parsed(bytes).map_err(|message| one_line(&message))
}

fn parsed(bytes: &[u8]) -> Result<SpriteVolume, String> {
    let no_exr = |error: exr::error::Error| format!("is no OpenEXR file that can be read ({error}); {RIGHT}");
    // Its head first: what it asks for must be bounded before it is made room for.
    let head = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(no_exr)?;
    let [header] = &head.headers[..] else {
        return Err(format!("has {} parts; {RIGHT}", head.headers.len()));
    };
    let mut sprite = described(header)?;
    let wanted: Vec<String> =
        (0..sprite.layers).flat_map(|layer| [channel_name(layer, 0), channel_name(layer, 1)]).collect();
    let has = |name: &str| header.channels.list.iter().any(|channel| channel.name.to_string() == name);
    if let Some(missing) = wanted.iter().find(|name| !has(name)) {
        return Err(format!("is no depth sprite: the channel {missing} is missing; {RIGHT}"));
    }
    if header.channels.list.len() != wanted.len() {
        let (has, wanted) = (header.channels.list.len(), wanted.len());
        return Err(format!("has {has} channels; {wanted}, two for each layer, would be right"));
    }
    use exr::prelude::{ReadChannels, ReadLayers};
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(no_exr)?;
    let texels = sprite.kept[0] as usize * sprite.kept[1] as usize;
    sprite.ends = vec![[0.0; 2]; texels * sprite.layers as usize];
    for (i, name) in wanted.iter().enumerate() {
        let channel = image.layer_data.channel_data.list.iter().find(|channel| channel.name.to_string() == *name);
        let Some(FlatSamples::F32(values)) = channel.map(|c| &c.sample_data).filter(|values| values.len() == texels)
        else {
            return Err(format!("is no depth sprite: the channel {name} must hold a 32-bit float per texel; {RIGHT}"));
        };
        for (texel, value) in values.iter().enumerate() {
            sprite.ends[texel * sprite.layers as usize + i / 2][i % 2] = *value;
        }
    }
    check_intervals(&sprite)?;
    Ok(sprite)
}

/// Whether the intervals of every texel are numbers, and ascend.
fn check_intervals(sprite: &SpriteVolume) -> Result<(), String> {
    let layers = sprite.layers as usize;
    for (texel, ends) in sprite.ends.chunks(layers).enumerate() {
        let mut before = 0.0;
        let mut is_over = false;
        for (layer, &[entry, exit]) in ends.iter().enumerate() {
            let message = if entry.is_nan() || exit.is_nan() {
                "is not a number; a distance in metres, 0 or more, would be right".to_owned()
            } else if entry < 0.0 || exit < 0.0 || entry.is_infinite() {
                format!("is {entry} to {exit} m; distances of 0 or more would be right")
            } else if entry > exit {
                format!("begins at {entry} m, beyond its end at {exit} m")
            } else if exit > 0.0 && is_over {
                "follows one that is empty; those of a texel must come first".to_owned()
            } else if exit > 0.0 && entry < before {
                format!("begins at {entry} m, before the end of the one before it at {before} m")
            } else {
                is_over |= exit == 0.0;
                before = exit;
                continue;
            };
            let [x, y] =
                [texel as u32 % sprite.kept[0] + sprite.origin[0], texel as u32 / sprite.kept[0] + sprite.origin[1]];
            return Err(format!("is no depth sprite: interval {layer} of texel {x}, {y} {message}"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sprite() -> SpriteVolume {
        SpriteVolume {
            space: SpriteSpace {
                eye: DVec3::new(85_000.125, 446_000.1, 30.0),
                basis: Basis { right: DVec3::X, up: DVec3::Z, forward: DVec3::Y },
                is_orthographic: false,
                half: DVec2::new(0.4, 0.3),
                size: [40, 30],
            },
            origin: [3, 4],
            kept: [2, 3],
            layers: 2,
            ends: vec![
                [1.0, 2.0],
                [3.0, f32::INFINITY],
                [0.0, 2.5],
                [2.5, 2.75],
                [0.0; 2],
                [0.0; 2],
                [7.0, 7.0],
                [0.0; 2],
                [0.125, 0.5],
                [0.0; 2],
                [5.0, 6.0],
                [0.0; 2],
            ],
            code: DepthCode { mapping: Mapping::InverseW, near_m: 0.1, far_m: f64::INFINITY, format: Format::Uint32 },
            crs: Some("EPSG:7415".to_owned()),
        }
    }

    #[test]
    fn what_is_written_is_read_back() {
        let mut one = sprite();
        assert_eq!(read_bytes(&bytes(&one).unwrap()).unwrap(), one);
        for _ in 0..4 {
            assert!(bytes(&one).unwrap() == bytes(&one).unwrap(), "other bytes");
        }
        one.crs = None;
        one.space.is_orthographic = true;
        one.code = DepthCode { mapping: Mapping::ComplementaryW, near_m: 1.0, far_m: 90.0, format: Format::Unorm8 };
        assert_eq!(read_bytes(&bytes(&one).unwrap()).unwrap(), one);
    }

    #[test]
    fn wrong_sprites_are_told_apart() {
        type Change<'a> = &'a dyn Fn(&mut SpriteVolume);
        let message = |change: Change| {
            let mut one = sprite();
            change(&mut one);
            read_bytes(&bytes(&one).unwrap()).expect_err("it is wrong")
        };
        let cases: [(Change, &str); 14] = [
            (&|s| s.ends[2][0] = f32::NAN, "interval 0 of texel 4, 4 is not a number"),
            (&|s| s.ends[1] = [3.0, 2.5], "interval 1 of texel 3, 4 begins at 3 m, beyond its end at 2.5 m"),
            (
                &|s| s.ends[1][0] = 1.5,
                "interval 1 of texel 3, 4 begins at 1.5 m, before the end of the one before it at 2 m",
            ),
            (&|s| s.ends[8] = [-1.0, 0.5], "interval 0 of texel 3, 6 is -1 to 0.5 m"),
            (&|s| s.ends[5] = [1.0, 2.0], "interval 1 of texel 3, 5 follows one that is empty"),
            (&|s| s.code.near_m = 0.0, "the attribute veduta.near must be 1e-6 to 1000000000.0, is 0"),
            (&|s| s.code.far_m = f64::NAN, "the attribute veduta.far must be 0.1 to inf, is NaN"),
            (&|s| s.code.mapping = Mapping::W, "the attribute veduta.far must be 0.1 to 1000000000000.0, is inf"),
            (&|s| s.code.far_m = 0.1, "the attribute veduta.far must lie beyond veduta.near, 0.1"),
            (&|s| s.space.eye.z = f64::NAN, "the attribute veduta.eye.z must be -1000000000.0 to 1000000000.0, is NaN"),
            (&|s| s.space.basis.up = DVec3::Y, "the attribute veduta.forward must stand upright on"),
            (&|s| s.space.half.y = -1.0, "the attribute veduta.halfHeight must be 1e-6 to 10000000.0, is -1"),
            (&|s| s.space.size = [4, 30], "has a data window beside its display window"),
            (&|s| s.space.size = [40_000, 30], "has 40000x30 texels; 1 to 16384 on a side would be right"),
        ];
        for (change, expected) in cases {
            let found = message(change);
            assert!(found.contains(expected), "{found} is not {expected}");
        }
        assert!(read_bytes(b"no picture").unwrap_err().starts_with("is no OpenEXR file that can be read"));
        let mut tiled = bytes(&sprite()).unwrap();
        let at = tiled.windows(9).position(|name| name == b"tiledesc\0").expect("tiles") + 9 + 4;
        tiled[at..at + 8].copy_from_slice(&[64, 0, 0, 0, 64, 0, 91, 0]);
        let found = read_bytes(&tiled).unwrap_err();
        assert!(found.starts_with("has tiles of 64x5963840 texels"), "{found}");
        let whole = bytes(&sprite()).unwrap();
        assert!(read_bytes(&whole[..whole.len() - 9]).unwrap_err().starts_with("is no OpenEXR file that can be read"));
    }
}
