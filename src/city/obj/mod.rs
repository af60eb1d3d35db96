//! Wavefront OBJ with MTL: groups with faces become city objects.
//!
//! OBJ does not say which way is up; city exporters (cjio, FME, 3dfier) write z up, and so it is read unless the scene says
//! otherwise (`city.up`). `o NAME` and
//! `g NAMES` both begin a group (its id is the text after the keyword); a group named again goes on; faces before
//! any name belong to `group-K`, K being the index of the object.
//!
//! Positions are decimal numbers in the file, so they are put on the decimal lattice that holds them exactly;
//! [`tobj`] reads the materials, but not this part: it gives up a whole file at the first bad index, says no line
//! numbers, and keeps positions as binary fractions, on which flat walls are no longer flat.

mod face;
mod lines;
mod mtl;

use std::{path::Path, sync::Arc};

use glam::{DVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

use self::{
    face::Group,
    lines::{Lines, number, statement, text, words},
    mtl::{Look, Looks},
};
use crate::city::{
    build::{
        ModelBuilder,
        lattice::Lattice,
        points::{Points, Pool},
        raw::RawGeometry,
    },
    load::{
        error::LoadError,
        input::Input,
        options::{LoadOptions, Up},
    },
    model::{Lod, Source},
    warning::WarningCode,
};

/// Farther than this from the origin, coordinates are wrong.
const MAX_COORDINATE_M: f64 = 1e9;
/// Lattice coordinates stay below this, as on [`Lattice::FINE`].
const MAX_STEPS: f64 = (1u64 << 50) as f64;
/// Positions with more decimals than this are put on [`Lattice::FINE`].
const MAX_DECIMALS: u32 = 9;

/// Statements that draw something else than polygons.
const UNDRAWN: &[&[u8]] = &[b"p", b"l", b"curv", b"curv2", b"surf", b"vp", b"cstype", b"deg", b"call"];
/// Statements without effect here.
const IGNORED: &[&[u8]] = &[
    b"s",
    b"mg",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
    b"bmat",
    b"step",
    b"usemap",
    b"maplib",
    b"csh",
];

/// Reads an OBJ file into `builder`.
pub fn read(builder: &mut ModelBuilder, input: &Input, options: &LoadOptions) -> Result<(), LoadError> {
    builder.begin_file(Source { path: input.path.clone(), format: "OBJ", version: String::new() });
    let mut reader = Reader::new(&input.path, options.up);
    for (line_number, line) in Lines::new(&input.bytes) {
        if let Some((keyword, arguments)) = statement(&line) {
            reader.statement(builder, options, line_number, keyword, arguments);
        }
    }
    if reader.understood == 0 {
        return Err(LoadError::new(&input.path, "holds no OBJ statement (v, f, g, ...); is it an OBJ file?"));
    }
    reader.finish(builder);
    Ok(())
}

/// The state of reading one file.
struct Reader<'a> {
    path: &'a Path,
    up: Up,
    points: Vec<DVec3>,
    texcoords: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// Most decimals of any usable position; `None` once one is written with an exponent.
    decimals: Option<u32>,
    groups: Vec<Group>,
    /// Groups by name; the nameless one is `""`.
    by_name: FxHashMap<String, usize>,
    group: usize,
    looks: Looks,
    look: Option<Look>,
    /// Libraries that were read or tried.
    libraries: FxHashSet<String>,
    /// Objects added so far.
    objects: usize,
    /// Statements that were known.
    understood: usize,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, up: Up) -> Self {
        Self {
            path,
            up,
            points: Vec::new(),
            texcoords: Vec::new(),
            normals: Vec::new(),
            decimals: Some(0),
            groups: vec![Group::new(String::new())],
            by_name: FxHashMap::from_iter([(String::new(), 0)]),
            group: 0,
            looks: Looks::default(),
            look: None,
            libraries: FxHashSet::default(),
            objects: 0,
            understood: 0,
        }
    }

    fn statement(
        &mut self,
        builder: &mut ModelBuilder,
        options: &LoadOptions,
        line: usize,
        keyword: &[u8],
        arguments: &[u8],
    ) {
        self.understood += 1;
        match keyword {
            b"v" => self.position(builder, line, arguments),
            b"vt" => {
                let [u, v, _] = self.numbers(builder, line, "vt", arguments, 1);
                // OBJ counts v from the bottom of the picture.
                let at = [u as f32, (1.0 - v) as f32];
                self.texcoords.push(if at.iter().all(|c| c.is_finite()) { at } else { [0.0; 2] });
            }
            b"vn" => {
                let [x, y, z] = self.numbers(builder, line, "vn", arguments, 3);
                self.normals.push(self.up.placed(DVec3::new(x, y, z)).normalize_or_zero().as_vec3().to_array());
            }
            b"f" | b"fo" => self.face(builder, line, arguments),
            b"o" | b"g" => self.group = self.group_named(text(arguments)),
            b"usemtl" => self.use_material(builder, line, &text(arguments)),
            b"mtllib" => self.library(builder, options, line, arguments),
            _ if UNDRAWN.contains(&keyword) => {
                let path = self.path.display();
                builder.model.warnings.add(WarningCode::Unsupported, "", || {
                    format!("{path}, line {line}: {:?} (points, lines, curves) is not drawn", text(keyword))
                });
            }
            _ if IGNORED.contains(&keyword) => {}
            _ => {
                self.understood -= 1;
                let keyword: String = text(keyword).chars().take(20).collect();
                self.malformed(builder, line, &format!("{keyword:?} is no OBJ statement"));
            }
        }
    }

    /// Up to three numbers, at least `least`; what is missing or malformed is NaN, and said.
    fn numbers(
        &mut self,
        builder: &mut ModelBuilder,
        line: usize,
        keyword: &str,
        arguments: &[u8],
        least: usize,
    ) -> [f64; 3] {
        let mut found = [0.0; 3];
        let mut words = words(arguments);
        for (i, slot) in found.iter_mut().enumerate() {
            match words.next().map(number) {
                Some(Some(value)) => *slot = value,
                None if i >= least => break,
                _ => {
                    self.malformed(builder, line, &format!("{keyword} needs {least} numbers"));
                    return [f64::NAN; 3];
                }
            }
        }
        found
    }

    fn position(&mut self, builder: &mut ModelBuilder, line: usize, arguments: &[u8]) {
        // A fourth number is a weight, which matters to rational curves only; six are a position and a colour.
        if words(arguments).count() >= 6 {
            let path = self.path.display();
            builder.model.warnings.add(WarningCode::Unsupported, "", || {
                format!("{path}, line {line}: vertex colours of OBJ are not drawn; materials are")
            });
        }
        let point = self.up.placed(DVec3::from(self.numbers(builder, line, "v", arguments, 3)));
        // A vertex that is wrong keeps its place, or all later indices would be off; its faces are dropped.
        self.points.push(point);
        if self.decimals.is_some() && is_usable(point) {
            let most = words(arguments).take(3).map(decimals).try_fold(0, |most, d| Some(most.max(d?)));
            self.decimals = self.decimals.zip(most).map(|(a, b)| a.max(b)).filter(|d| *d <= MAX_DECIMALS);
        }
    }

    fn group_named(&mut self, name: String) -> usize {
        let groups = &mut self.groups;
        *self.by_name.entry(name).or_insert_with_key(|name| {
            groups.push(Group::new(name.clone()));
            groups.len() - 1
        })
    }

    fn use_material(&mut self, builder: &mut ModelBuilder, line: usize, name: &str) {
        self.look = self.looks.get(name);
        if self.look.is_none() {
            let path = self.path.display();
            builder.model.warnings.add(WarningCode::AppearanceIndex, "", || {
                format!("{path}, line {line}: no mtllib defines material {name:?}")
            });
        }
    }

    /// `mtllib` names files; a single name may hold spaces.
    fn library(&mut self, builder: &mut ModelBuilder, options: &LoadOptions, line: usize, arguments: &[u8]) {
        let whole = text(arguments);
        if !self.libraries.insert(whole.clone()) {
            return;
        }
        let mut read = |name: &str| mtl::read(&mut builder.model, &mut self.looks, self.path, name, options);
        let mut failed: Vec<String> = read(&whole).err().into_iter().collect();
        if !failed.is_empty() && words(arguments).count() > 1 {
            let names = words(arguments).map(text).filter(|name| self.libraries.insert(name.clone()));
            failed = names.filter_map(|name| read(&name).err()).collect();
        }
        if let Some(reason) = failed.last() {
            self.malformed(builder, line, &format!("mtllib: {reason}; its materials have a plain colour"));
        }
    }

    fn malformed(&self, builder: &mut ModelBuilder, line: usize, what: &str) {
        let path = self.path.display();
        builder.model.warnings.add(WarningCode::Malformed, "", || format!("{path}, line {line}: {what}"));
    }

    /// Puts the positions on their lattice and hands all groups to the builder.
    fn finish(mut self, builder: &mut ModelBuilder) {
        let first = self.points.first().copied();
        let frame = first.and_then(|place| builder.frame_of_unnamed(self.path, place));
        let local = frame.map(|frame| frame.local_from_earth());
        if let Some(local) = local {
            self.points.iter_mut().for_each(|point| *point = local.transform_point3(*point));
            self.decimals = None;
        }
        let farthest =
            self.points.iter().filter(|p| is_usable(**p)).fold(0.0, |far: f64, p| far.max(p.abs().max_element()));
        let scale = self.decimals.map(|d| 10f64.powi(d as i32)).filter(|scale| farthest * scale <= MAX_STEPS);
        let lattice = scale.map_or(Lattice::FINE, |s| Lattice { step: DVec3::splat(1.0 / s), origin: DVec3::ZERO });
        // Unusable positions are in no face.
        let points: Points = self.points.iter().map(|p| lattice.nearest(*p).unwrap_or_default()).collect();
        let pool = Arc::new(Pool { lattice, points });
        for group in self.groups {
            for (object, mut polygons) in group.into_parts() {
                for normal in polygons.normals.iter_mut().filter(|_| local.is_some()) {
                    let turned = local.unwrap_or_default().matrix3 * Vec3::from(*normal).as_dvec3();
                    *normal = turned.as_vec3().to_array();
                }
                builder.add_geometry(RawGeometry {
                    object,
                    lod: Lod::NONE,
                    solid: false,
                    pool: pool.clone(),
                    polygons,
                });
            }
        }
    }
}

fn is_usable(point: DVec3) -> bool {
    point.abs().cmple(DVec3::splat(MAX_COORDINATE_M)).all()
}

/// The number of decimals that a number is written with, trailing zeros not counted; `None` for an exponent.
fn decimals(word: &[u8]) -> Option<u32> {
    if word.iter().any(|b| matches!(b, b'e' | b'E')) {
        return None;
    }
    let Some(dot) = word.iter().position(|b| *b == b'.') else { return Some(0) };
    let last = word.iter().rposition(|b| *b != b'0').unwrap_or(dot);
    Some(last.saturating_sub(dot) as u32)
}
