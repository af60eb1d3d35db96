//! City objects as they are written, and how.

use std::io::{Result, Write};

use rustc_hash::FxHashMap;

use crate::city::synth::{
    full::{
        field::P3,
        shell::{Shell, Surface},
    },
    metres,
};

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A text without characters that JSON would escape.
    Text(String),
    /// A whole number.
    Whole(i64),
    /// A length in millimetres, written in metres.
    Length(i64),
}

/// A geometry.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A closed shell of a level of detail.
    Solid(&'static str, Shell),
    /// Closed shells.
    Solids(&'static str, Vec<Shell>),
    /// Faces.
    Surfaces(&'static str, Shell),
    /// Triangles of terrain.
    Relief(&'static str, Shell),
    /// A template, where it stands, and the thousandths of its size and turn: what its x becomes, x and y; its height.
    Instance(usize, P3, [i64; 3]),
}

/// Where a building is, for the post.
#[derive(Clone, Debug, PartialEq)]
pub struct Address {
    /// The street.
    pub street: String,
    /// The number in it.
    pub number: i64,
    /// The postal code.
    pub code: String,
    /// The town.
    pub town: &'static str,
}

/// A city object.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its id, unique.
    pub id: String,
    /// Its type.
    pub kind: &'static str,
    /// What it is part of.
    pub parent: Option<String>,
    /// What is part of it.
    pub children: Vec<String>,
    /// Its attributes.
    pub attributes: Vec<(&'static str, Value)>,
    /// Its address.
    pub address: Option<Address>,
    /// Its geometries, coarse to fine.
    pub geometries: Vec<Geometry>,
}

impl Object {
    /// An object with nothing but an id and a type.
    pub fn new(id: String, kind: &'static str) -> Self {
        Self {
            id,
            kind,
            parent: None,
            children: Vec::new(),
            attributes: Vec::new(),
            address: None,
            geometries: Vec::new(),
        }
    }

    /// With a geometry more.
    #[must_use]
    pub fn with(mut self, geometry: Geometry) -> Self {
        self.geometries.push(geometry);
        self
    }

    /// With an attribute of text more.
    #[must_use]
    pub fn text(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, Value::Text(value.into())));
        self
    }

    /// With a whole number more.
    #[must_use]
    pub fn whole(mut self, name: &'static str, value: i64) -> Self {
        self.attributes.push((name, Value::Whole(value)));
        self
    }

    /// With a length more, millimetres.
    #[must_use]
    pub fn length(mut self, name: &'static str, value: i64) -> Self {
        self.attributes.push((name, Value::Length(value)));
        self
    }

    /// Makes it a child of another.
    #[must_use]
    pub fn child_of(mut self, parent: &mut Self) -> Self {
        parent.children.push(self.id.clone());
        self.parent = Some(parent.id.clone());
        self
    }

    /// Writes `"ID":{...}`.
    pub fn write(&self, out: &mut dyn Write, vertices: &mut Vertices) -> Result<()> {
        write!(out, r#""{}":{{"type":"{}""#, self.id, self.kind)?;
        if !self.attributes.is_empty() {
            write!(out, r#","attributes":{{"#)?;
            for (i, (name, value)) in self.attributes.iter().enumerate() {
                write!(out, r#"{}"{name}":"#, comma(i))?;
                match value {
                    Value::Text(text) => write!(out, r#""{text}""#)?,
                    Value::Whole(number) => write!(out, "{number}")?,
                    Value::Length(millimetres) => write!(out, "{}", metres(*millimetres))?,
                }
            }
            write!(out, "}}")?;
        }
        if let Some(Address { street, number, code, town }) = &self.address {
            write!(out, r#","address":[{{"thoroughfareName":"{street}","thoroughfareNumber":"{number}","#)?;
            write!(out, r#""postcode":"{code}","locality":"{town}"}}]"#)?;
        }
        if let Some(parent) = &self.parent {
            write!(out, r#","parents":["{parent}"]"#)?;
        }
        if !self.children.is_empty() {
            write!(out, r#","children":["{}"]"#, self.children.join(r#"",""#))?;
        }
        write!(out, r#","geometry":["#)?;
        for (i, geometry) in self.geometries.iter().enumerate() {
            write!(out, "{}", comma(i))?;
            geometry.write(out, vertices)?;
        }
        write!(out, "]}}")
    }
}

/// The vertices of a file or a feature, each once within an object and those that belong to it.
#[derive(Debug, Default)]
pub struct Vertices {
    /// Those of the objects since [`Self::forget`], in order.
    pub points: Vec<P3>,
    first: usize,
    known: FxHashMap<P3, usize>,
}

impl Vertices {
    /// The index of a point.
    pub fn index(&mut self, point: P3) -> usize {
        *self.known.entry(point).or_insert_with(|| {
            self.points.push(point);
            self.first + self.points.len() - 1
        })
    }

    /// Begins anew with the next index.
    pub fn forget(&mut self) {
        self.first += self.points.len();
        self.points.clear();
        self.known.clear();
    }
}

fn comma(i: usize) -> &'static str {
    if i == 0 { "" } else { "," }
}

impl Geometry {
    fn write(&self, out: &mut dyn Write, vertices: &mut Vertices) -> Result<()> {
        match self {
            Self::Solid(lod, shell) => {
                write!(out, r#"{{"type":"Solid","lod":"{lod}","boundaries":["#)?;
                write_shell(out, shell, vertices)?;
                write!(out, "]")?;
                write_semantics(out, std::slice::from_ref(shell), ["[", "]"])?;
            }
            Self::Solids(lod, shells) => {
                write!(out, r#"{{"type":"MultiSolid","lod":"{lod}","boundaries":["#)?;
                for (i, shell) in shells.iter().enumerate() {
                    write!(out, "{}[", comma(i))?;
                    write_shell(out, shell, vertices)?;
                    write!(out, "]")?;
                }
                write!(out, "]")?;
                write_semantics(out, shells, ["[[", "]]"])?;
            }
            Self::Surfaces(lod, shell) => {
                write!(out, r#"{{"type":"MultiSurface","lod":"{lod}","boundaries":"#)?;
                write_shell(out, shell, vertices)?;
                write_semantics(out, std::slice::from_ref(shell), ["", ""])?;
            }
            Self::Relief(lod, shell) => {
                write!(out, r#"{{"type":"CompositeSurface","lod":"{lod}","boundaries":"#)?;
                write_shell(out, shell, vertices)?;
            }
            Self::Instance(template, at, [x, y, z]) => {
                let index = vertices.index(*at);
                write!(out, r#"{{"type":"GeometryInstance","template":{template},"boundaries":[{index}],"#)?;
                let part = |value: i64| signed_thousandths(value);
                let (c, s, minus, h) = (part(*x), part(*y), part(-y), part(*z));
                write!(
                    out,
                    r#""transformationMatrix":[{c},{minus},0.0,0.0,{s},{c},0.0,0.0,0.0,0.0,{h},0.0,0.0,0.0,0.0,1.0]"#
                )?;
            }
        }
        write!(out, "}}")
    }
}

/// Thousandths as a decimal number.
pub fn signed_thousandths(value: i64) -> String {
    let sign = if value < 0 { "-" } else { "" };
    format!("{sign}{}", metres(value.abs()))
}

fn write_shell(out: &mut dyn Write, shell: &Shell, vertices: &mut Vertices) -> Result<()> {
    write!(out, "[")?;
    for (i, (_, rings)) in shell.faces.iter().enumerate() {
        write!(out, "{}[", comma(i))?;
        for (k, ring) in rings.iter().enumerate() {
            write!(out, "{}[", comma(k))?;
            for (n, point) in ring.iter().enumerate() {
                write!(out, "{}{}", comma(n), vertices.index(shell.points[*point as usize]))?;
            }
            write!(out, "]")?;
        }
        write!(out, "]")?;
    }
    write!(out, "]")
}

/// Writes what the faces are, where they are anything; `around`: what is around the list of each shell.
fn write_semantics(out: &mut dyn Write, shells: &[Shell], [open, close]: [&str; 2]) -> Result<()> {
    let faces = || shells.iter().flat_map(|shell| &shell.faces);
    let mut kinds: Vec<Surface> = faces().map(|(surface, _)| *surface).filter(|s| *s != Surface::Plain).collect();
    kinds.sort_unstable();
    kinds.dedup();
    if kinds.is_empty() {
        return Ok(());
    }
    write!(out, r#","semantics":{{"surfaces":["#)?;
    for (i, name) in kinds.iter().filter_map(|kind| kind.name()).enumerate() {
        write!(out, r#"{}{{"type":"{name}"}}"#, comma(i))?;
    }
    write!(out, r#"],"values":["#)?;
    for (k, shell) in shells.iter().enumerate() {
        write!(out, "{}{open}", comma(k))?;
        for (i, (surface, _)) in shell.faces.iter().enumerate() {
            write_index(out, i, kinds.binary_search(surface).ok())?;
        }
        write!(out, "{close}")?;
    }
    write!(out, "]}}")
}

fn write_index(out: &mut dyn Write, place: usize, index: Option<usize>) -> Result<()> {
    match index {
        Some(index) => write!(out, "{}{index}", comma(place)),
        None => write!(out, "{}null", comma(place)),
    }
}

/// Writes templates: shells whose points are thousandths.
pub fn write_templates(out: &mut dyn Write, templates: &[(&'static str, Vec<Shell>)]) -> Result<()> {
    let mut vertices = Vertices::default();
    write!(out, r#""geometry-templates":{{"templates":["#)?;
    for (i, (lod, shells)) in templates.iter().enumerate() {
        write!(out, "{}", comma(i))?;
        Geometry::Solids(lod, shells.clone()).write(out, &mut vertices)?;
    }
    write!(out, r#"],"vertices-templates":["#)?;
    for (i, point) in vertices.points.iter().enumerate() {
        let [x, y, z] = point.map(signed_thousandths);
        write!(out, "{}[{x},{y},{z}]", comma(i))?;
    }
    write!(out, "]}}")
}
