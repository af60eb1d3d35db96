//! The synthetic city, full: terrain and a river, streets that follow both, six hundred years of houses, a church behind
//! them, a town hall with rooms, trees, and a day of trams and boats.
//!
//! Whole millimetres, as the plain city has them. The plan is straight: lines and cells; a field bends it into the
//! land ([`field`]). Houses stand in frames of whole vectors ([`frame`]), so that they turn with their streets and are
//! planar all the same. Cells are made when they are written and forgotten afterwards: time is linear in the number of
//! buildings, and memory grows with its square root, by two lists of where streets run.

mod blocks;
mod city;
mod field;
mod frame;
mod furniture;
mod history;
mod house;
mod interior;
mod landmark;
mod names;
mod object;
mod parcels;
mod plan;
mod shell;
mod streets;
mod style;
mod transport;
mod trees;

use std::io::{Result, Write};

use crate::city::synth::{
    SynthOptions, TRANSFORM,
    full::{
        object::{Vertices, write_templates},
        plan::Plan,
    },
};

/// How many standing buildings a full city may have.
pub const BUILDINGS: std::ops::RangeInclusive<u64> = 100..=100_000;

/// Writes the city as one CityJSON 2.0 object; `progress` hears how many standing buildings are done.
pub fn write_cityjson(options: &SynthOptions, out: &mut dyn Write, progress: &mut dyn FnMut(u64)) -> Result<()> {
    let plan = Plan::new(options);
    write!(out, r#"{{"type":"CityJSON","version":"2.0",{TRANSFORM},{},"#, metadata(options))?;
    write_templates(out, &trees::templates())?;
    write!(out, r#","CityObjects":{{"#)?;
    let mut vertices = Vertices::default();
    let mut separator = "";
    city::each_family(&plan, &mut |family, done| {
        vertices.forget();
        for object in family {
            writeln!(out, "{separator}")?;
            object.write(out, &mut vertices)?;
            separator = ",";
        }
        progress(done);
        Ok(())
    })?;
    // All once more, now for the vertices: making them again is cheaper than keeping them.
    write!(out, "\n}},\"vertices\":[")?;
    separator = "";
    city::each_family(&plan, &mut |family, _| {
        vertices.forget();
        family.iter().try_for_each(|object| object.write(&mut std::io::sink(), &mut vertices))?;
        for [x, y, z] in &vertices.points {
            write!(out, "{separator}[{x},{y},{z}]")?;
            separator = ",";
        }
        Ok(())
    })?;
    writeln!(out, "]}}")
}

/// Writes the city as CityJSONSeq 2.0: one line for the whole, then one for each object with all that belongs to it.
pub fn write_cityjsonseq(options: &SynthOptions, out: &mut dyn Write, progress: &mut dyn FnMut(u64)) -> Result<()> {
    let plan = Plan::new(options);
    write!(out, r#"{{"type":"CityJSON","version":"2.0",{TRANSFORM},{},"#, metadata(options))?;
    write_templates(out, &trees::templates())?;
    writeln!(out, r#","CityObjects":{{}},"vertices":[]}}"#)?;
    city::each_family(&plan, &mut |family, done| {
        let mut vertices = Vertices::default();
        write!(out, r#"{{"type":"CityJSONFeature","id":"{}","CityObjects":{{"#, family[0].id)?;
        for (i, object) in family.iter().enumerate() {
            write!(out, "{}", if i == 0 { "" } else { "," })?;
            object.write(out, &mut vertices)?;
        }
        write!(out, r#"}},"vertices":["#)?;
        for (i, [x, y, z]) in vertices.points.iter().enumerate() {
            write!(out, "{}[{x},{y},{z}]", if i == 0 { "" } else { "," })?;
        }
        writeln!(out, "]}}")?;
        progress(done);
        Ok(())
    })
}

/// Writes where trams and boats are through a day, as CSV: `id,t,x,y,z,yaw,scale`; metres, and degrees counter-clockwise from east.
pub fn write_timetable(options: &SynthOptions, out: &mut dyn Write) -> Result<()> {
    transport::write_timetable(&Plan::new(options), out)
}

fn metadata(options: &SynthOptions) -> String {
    let SynthOptions { buildings, seed } = options;
    format!(r#""metadata":{{"title":"Synthetic city of Veduta with a history, {buildings} buildings, seed {seed}"}}"#)
}

#[cfg(test)]
mod tests;
