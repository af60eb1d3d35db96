//! The synthetic city, plain: streets, blocks and LoD2 houses, the same bytes for the same seed everywhere.
//!
//! Everything is whole millimetres, so faces are exactly planar, party walls coincide exactly, and no rounding of any
//! machine can change a byte. The city grows outward from its centre block by block; blocks are made when they are
//! written and forgotten afterwards, so time is linear and memory constant in the number of buildings.

pub mod full;
mod house;
mod layout;
mod random;

use std::io::{Result, Write};

use crate::city::synth::{
    house::{House, Part},
    layout::{Block, Layout},
};

/// The synthetic city that is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SynthOptions {
    /// The number of buildings; streets come in addition.
    pub buildings: u64,
    /// Which of all such cities.
    pub seed: u64,
}

impl SynthOptions {
    /// More buildings than this make a file whose indices and bytes no reader counts.
    pub const MAX_BUILDINGS: u64 = 5_000_000;
}

const TRANSFORM: &str = r#""transform":{"scale":[0.001,0.001,0.001],"translate":[0.0,0.0,0.0]}"#;

/// Writes the city as one CityJSON 2.0 object; `progress` hears how many buildings are done.
pub fn write_cityjson(options: &SynthOptions, out: &mut dyn Write, progress: &mut dyn FnMut(u64)) -> Result<()> {
    write!(out, r#"{{"type":"CityJSON","version":"2.0",{TRANSFORM},{},"CityObjects":{{"#, metadata(options))?;
    let mut first_vertex = 0;
    let mut separator = "";
    for block in Layout::new(options) {
        block.each_object(&mut |object| {
            writeln!(out, "{separator}")?;
            object.write(out, first_vertex)?;
            first_vertex += object.points().len();
            separator = ",";
            Ok(())
        })?;
        progress(block.first_building + block.houses.len() as u64);
    }
    // The blocks once more, now for their vertices: making them again is cheaper than keeping them.
    write!(out, "\n}},\"vertices\":[")?;
    separator = "";
    for block in Layout::new(options) {
        block.each_object(&mut |object| {
            for [x, y, z] in object.points() {
                write!(out, "{separator}[{x},{y},{z}]")?;
                separator = ",";
            }
            Ok(())
        })?;
    }
    writeln!(out, "]}}")
}

/// Writes the city as CityJSONSeq 2.0: one line for the whole, then one per object.
pub fn write_cityjsonseq(options: &SynthOptions, out: &mut dyn Write, progress: &mut dyn FnMut(u64)) -> Result<()> {
    let whole = format!(r#""type":"CityJSON","version":"2.0",{TRANSFORM},{}"#, metadata(options));
    writeln!(out, r#"{{{whole},"CityObjects":{{}},"vertices":[]}}"#)?;
    for block in Layout::new(options) {
        block.each_object(&mut |object| {
            write!(out, r#"{{"type":"CityJSONFeature","id":"{}","CityObjects":{{"#, object.id())?;
            object.write(out, 0)?;
            write!(out, r#"}},"vertices":["#)?;
            for (i, [x, y, z]) in object.points().iter().enumerate() {
                write!(out, "{}[{x},{y},{z}]", if i == 0 { "" } else { "," })?;
            }
            writeln!(out, "]}}")
        })?;
        progress(block.first_building + block.houses.len() as u64);
    }
    Ok(())
}

fn metadata(options: &SynthOptions) -> String {
    let SynthOptions { buildings, seed } = options;
    format!(r#""metadata":{{"title":"Synthetic city of Veduta, {buildings} buildings, seed {seed}"}}"#)
}

/// A city object as it is written.
enum Object<'a> {
    /// A building, with its number, from 1.
    Building(u64, &'a House),
    /// The streets at the west and south of a block, with the block's number, from 1.
    Street(u64, &'a Block),
    /// The ground of a block, with its number.
    Ground(u64, &'a Block),
}

impl Block {
    fn each_object(&self, write: &mut dyn FnMut(&Object<'_>) -> Result<()>) -> Result<()> {
        write(&Object::Street(self.number, self))?;
        write(&Object::Ground(self.number, self))?;
        for (i, house) in self.houses.iter().enumerate() {
            write(&Object::Building(self.first_building + i as u64 + 1, house))?;
        }
        Ok(())
    }
}

impl Object<'_> {
    fn id(&self) -> String {
        match self {
            Self::Building(number, _) => format!("b{number}"),
            Self::Street(number, _) => format!("s{number}"),
            Self::Ground(number, _) => format!("g{number}"),
        }
    }

    fn points(&self) -> Vec<[i64; 3]> {
        match self {
            Self::Building(_, house) => house.points(),
            Self::Street(_, block) => block.street.iter().map(|[x, y]| [*x, *y, 0]).collect(),
            Self::Ground(_, block) => block.ground.iter().map(|[x, y]| [*x, *y, 0]).collect(),
        }
    }

    /// Writes `"ID":{...}`; its vertices start at `first`.
    fn write(&self, out: &mut dyn Write, first: usize) -> Result<()> {
        write!(out, r#""{}":"#, self.id())?;
        match self {
            Self::Building(_, house) => write_building(out, house, first),
            Self::Street(_, block) => write_flat(out, "Road", block.street.len(), first),
            Self::Ground(_, block) => write_flat(out, "LandUse", block.ground.len(), first),
        }
    }
}

/// An object of one horizontal polygon.
fn write_flat(out: &mut dyn Write, kind: &str, corners: usize, first: usize) -> Result<()> {
    write!(out, r#"{{"type":"{kind}","geometry":[{{"type":"MultiSurface","lod":"2","boundaries":[["#)?;
    let ring: Vec<u8> = (0..corners as u8).collect();
    write_ring(out, &ring, first)?;
    write!(out, "]]}}]}}")
}

fn write_building(out: &mut dyn Write, house: &House, first: usize) -> Result<()> {
    let faces = house.shape.faces();
    let (function, year) = (house.function, house.year);
    let height = metres(house.height());
    write!(out, r#"{{"type":"Building","attributes":{{"height":{height},"function":"{function}","#)?;
    write!(out, r#""yearOfConstruction":{year}}},"geometry":[{{"type":"Solid","lod":"2","boundaries":[["#)?;
    for (i, (_, rings)) in faces.iter().enumerate() {
        write!(out, "{}", if i == 0 { "[" } else { ",[" })?;
        for (k, ring) in rings.iter().enumerate() {
            write!(out, "{}", if k == 0 { "" } else { "," })?;
            write_ring(out, ring, first)?;
        }
        write!(out, "]")?;
    }
    write!(out, r#"]],"semantics":{{"surfaces":[{{"type":"GroundSurface"}},{{"type":"WallSurface"}},"#)?;
    write!(out, r#"{{"type":"RoofSurface"}}],"values":[["#)?;
    for (i, (part, _)) in faces.iter().enumerate() {
        let index = match part {
            Part::Ground => 0,
            Part::Wall => 1,
            Part::Roof => 2,
        };
        write!(out, "{}{index}", if i == 0 { "" } else { "," })?;
    }
    write!(out, "]]}}}}]}}")
}

fn write_ring(out: &mut dyn Write, ring: &[u8], first: usize) -> Result<()> {
    for (i, index) in ring.iter().enumerate() {
        write!(out, "{}{}", if i == 0 { "[" } else { "," }, first + usize::from(*index))?;
    }
    write!(out, "]")
}

/// Millimetres as a JSON number in metres, always with a decimal point: the attribute is a number in every building.
fn metres(millimetres: i64) -> String {
    let text = format!("{}.{:03}", millimetres / 1000, millimetres % 1000);
    let short = text.trim_end_matches('0');
    if short.ends_with('.') { format!("{short}0") } else { short.to_owned() }
}

#[cfg(test)]
mod tests;
