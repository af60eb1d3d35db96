//! CityJSON 1.0, 1.1 and 2.0, and CityJSONSeq (<https://www.cityjson.org/specs/2.0.1/>).
//!
//! A file is one JSON object, or one a line: the first is the header, each other a feature with vertices of its own.
//! Everything is read once from front to back; what a number means is known only when the document is complete.

mod appearance;
mod assemble;
mod attributes;
mod document;
mod geometry;
mod kinds;
mod nested;
mod packed;
mod semantics;
mod vertices;

use std::path::Path;

use glam::DVec3;

use crate::city::{
    build::ModelBuilder,
    cityjson::{
        appearance::{AppearanceTable, SharedAppearance},
        assemble::{Assembly, Templates},
        document::Document,
        vertices::{Placing, Transform},
    },
    crs::{Axes, Crs, LocalFrame, UtmZone},
    json::{self, Json},
    load::{error::LoadError, input::Input, options::LoadOptions},
    memory::give_back,
    model::Source,
    warning::WarningCode,
};

/// Versions that can be read.
const VERSIONS: [&str; 3] = ["1.0", "1.1", "2.0"];

/// Reads a CityJSON or CityJSONSeq file; its text is freed as soon as it is read.
pub fn read(builder: &mut ModelBuilder, mut input: Input, options: &LoadOptions) -> Result<(), LoadError> {
    let mut json = Json::new(&input.bytes);
    let header = Document::read(&mut json, builder);
    let end = json.offset().min(input.bytes.len());
    let rest = &input.bytes[end..];
    let is_sequence =
        header.damage.is_none() && (input.extension() == "jsonl" || rest.trim_ascii_start().starts_with(b"{"));
    let version = check(&header, &input, is_sequence, builder)?;
    builder.begin_file(Source {
        path: input.path.clone(),
        format: if is_sequence { "CityJSONSeq" } else { "CityJSON" },
        version: version.clone(),
    });
    let has_more = !is_sequence && !rest.iter().all(|b| b.is_ascii_whitespace() || *b == 0);
    let more = has_more.then(|| json::place(&input.bytes, end));
    let mut bytes = std::mem::take(&mut input.bytes);
    let mut file = File::new(builder, &input.path, options, is_sequence);
    file.adopt_crs(header.crs.as_deref());
    file.adopt_transform(&header, &version);
    file.warn_damage(&header, &bytes);
    file.warn_encoding(&bytes);
    if !is_sequence {
        give_back(std::mem::take(&mut bytes));
    }
    file.add(header);
    if let Some(place) = more.filter(|_| !file.is_damaged) {
        let message = || format!("{}, {place}: text after the end of the model is ignored", file.path.display());
        file.builder.model.warnings.add(WarningCode::Malformed, "", message);
    }
    if is_sequence {
        file.read_features(&bytes, end);
    }
    file.appearance_table.give_back();
    give_back(bytes);
    Ok(())
}

/// Whether the first object of a file is a city at all; returns its version as stated.
fn check(header: &Document, input: &Input, is_sequence: bool, builder: &mut ModelBuilder) -> Result<String, LoadError> {
    let fail = |message: String| Err(LoadError::new(&input.path, message));
    if let Some(damage) = header.damage.filter(|_| header.objects.is_empty()) {
        let place = json::place(&input.bytes, damage.at);
        return Err(LoadError::at(
            &input.path,
            place,
            format!("{}, before any city object was complete", damage.message),
        ));
    }
    let mut warn = |message: &str| {
        builder.model.warnings.add(WarningCode::Malformed, "", || format!("{}: {message}", input.path.display()));
    };
    match header.kind.as_deref() {
        Some("CityJSON") => {}
        Some("CityJSONFeature") => {
            return fail("begins with a CityJSONFeature; the first line of CityJSONSeq must be the CityJSON object with the transform".into());
        }
        Some(other) => return fail(format!("\"type\" is \"{other:.40}\"; a city model has \"type\": \"CityJSON\"")),
        None if header.has_objects => warn("there is no \"type\": \"CityJSON\"; it is read as such"),
        None => return fail("has neither \"type\": \"CityJSON\" nor \"CityObjects\"; it is no city model".into()),
    }
    if !header.has_objects && !is_sequence {
        return fail("has no \"CityObjects\"; even an empty city has \"CityObjects\": {}".into());
    }
    let Some(version) = header.version.as_deref() else {
        warn("there is no \"version\"; it is read as 2.0");
        return Ok(String::new());
    };
    if VERSIONS.iter().any(|v| version == *v || version.strip_prefix(v).is_some_and(|rest| rest.starts_with('.'))) {
        return Ok(version.to_owned());
    }
    let hint = if version.starts_with("0.") { "; `cjio IN upgrade save OUT` makes it newer" } else { "" };
    fail(format!("\"version\" is \"{version:.40}\"; CityJSON 1.0, 1.1 and 2.0 can be read{hint}"))
}

/// One file being read: what the header says holds for its features.
struct File<'a> {
    builder: &'a mut ModelBuilder,
    path: &'a Path,
    options: &'a LoadOptions,
    axes: Axes,
    transform: Transform,
    shared_appearance: SharedAppearance,
    appearance_table: AppearanceTable,
    templates: Templates,
    instanced: usize,
    is_damaged: bool,
}

impl<'a> File<'a> {
    fn new(builder: &'a mut ModelBuilder, path: &'a Path, options: &'a LoadOptions, is_sequence: bool) -> Self {
        Self {
            builder,
            path,
            options,
            axes: Axes::Metric,
            transform: Transform::IDENTITY,
            shared_appearance: SharedAppearance::new(is_sequence),
            appearance_table: AppearanceTable::default(),
            templates: Templates::default(),
            instanced: 0,
            is_damaged: false,
        }
    }

    /// JSON is UTF-8; an old code page shows as `\u{fffd}` in names, and that is said once.
    fn warn_encoding(&mut self, bytes: &[u8]) {
        if let Err(e) = std::str::from_utf8(bytes) {
            self.warn(WarningCode::Malformed, || {
                let place = json::place(bytes, e.valid_up_to());
                format!(", {place}: this is not UTF-8; what cannot be read stands as \u{fffd}")
            });
        }
    }

    fn warn(&mut self, code: WarningCode, message: impl FnOnce() -> String) {
        let file = self.path.display();
        self.builder.model.warnings.add(code, "", || format!("{file}{}", message()));
    }

    /// Takes the file's reference system, and what it says about the coordinates.
    fn adopt_crs(&mut self, raw: Option<&str>) {
        let Some(raw) = raw else { return };
        let Some(crs) = Crs::parse(raw) else {
            self.builder.model.crs_raw.get_or_insert_with(|| raw.to_owned());
            return self.warn(WarningCode::UnknownCrs, || {
                format!(": reference system \"{raw:.80}\" is not understood (expected an EPSG code); coordinates are used as they are")
            });
        };
        self.axes = crs.axes;
        match crs.axes {
            Axes::Feet => {
                self.warn(WarningCode::UnknownCrs, || format!(": {} is in feet; they are used as metres", crs.name))
            }
            Axes::Metric | Axes::LatLon | Axes::LonLat | Axes::Geocentric => {}
        }
        match self.builder.model.crs.clone() {
            None => {
                self.builder.model.crs = Some(crs.name);
                self.builder.model.crs_raw = Some(raw.to_owned());
            }
            Some(first) if first != crs.name => self.warn(WarningCode::CrsMismatch, || {
                format!(" is in {}, files before it in {first}; coordinates are used as they are", crs.name)
            }),
            Some(_) => {}
        }
    }

    /// Takes the file's transform: optional in 1.0, required since.
    fn adopt_transform(&mut self, header: &Document, version: &str) {
        match header.transform {
            Some(transform) => self.transform = transform,
            None if version.starts_with("1.0") => {}
            None => self.warn(WarningCode::MissingTransform, || {
                format!(
                    ": there is no usable \"transform\" (scale and translate, three numbers each), which CityJSON {version} requires; numbers are read as metres"
                )
            }),
        }
    }

    fn warn_damage(&mut self, document: &Document, bytes: &[u8]) {
        let Some(damage) = document.damage else { return };
        self.is_damaged = true;
        let place = json::place(bytes, damage.at);
        let count = document.objects.len();
        let shapes = if document.vertices.len() == 0 { ", without geometry: the vertices come later" } else { "" };
        self.warn(WarningCode::TruncatedFile, || {
            format!(", {place}: {}; the {count} city objects before it are kept{shapes}", damage.message)
        });
    }

    /// Adds a document's objects; what it declares itself holds for it, else what the header declared.
    fn add(&mut self, mut document: Document) {
        let own =
            document.appearance.take().map(|a| self.shared_appearance.adopt(a, self.builder, self.path, self.options));
        if !document.templates.is_empty() {
            self.templates = Templates {
                geometries: std::mem::take(&mut document.templates),
                vertices: std::mem::take(&mut document.template_vertices),
            };
        }
        let is_header = document.kind.as_deref() != Some("CityJSONFeature");
        let own = match own {
            Some(own) if is_header => {
                std::mem::replace(&mut self.appearance_table, own).give_back();
                None
            }
            own => own,
        };
        let placing = self.placing(&document);
        Assembly {
            builder: self.builder,
            shared_appearance: &mut self.shared_appearance,
            appearance_table: own.as_ref().unwrap_or(&self.appearance_table),
            templates: &self.templates,
            template_appearance: &self.appearance_table,
            placing,
            instanced: &mut self.instanced,
        }
        .add(document);
    }

    /// The way from this document's numbers to metres; the first vertex in degrees decides the zone of the whole city, and the first that
    /// is earth-centred its frame.
    fn placing(&mut self, document: &Document) -> Placing {
        let first = document.vertices.transformed(0, &self.transform);
        let degrees = match self.axes {
            Axes::LatLon => Some(first),
            Axes::LonLat => Some(DVec3::new(first.y, first.x, first.z)),
            Axes::Metric | Axes::Feet | Axes::Geocentric => None,
        };
        if let Some(place) = degrees.filter(|p| p.is_finite()) {
            if place.x.abs() > 90.0 || place.y.abs() > 360.0 {
                self.axes = Axes::Metric;
                self.warn(WarningCode::UnknownCrs, || {
                    ": the reference system is in degrees, the coordinates are not; they are used as metres".to_owned()
                });
            } else {
                self.builder.zone.get_or_insert(UtmZone::at(place.x, place.y));
            }
        }
        if self.axes == Axes::Geocentric && first.is_finite() && self.builder.frame.is_none() {
            self.builder.frame = LocalFrame::at(first);
            if self.builder.frame.is_none() {
                self.axes = Axes::Metric;
                self.warn(WarningCode::UnknownCrs, || {
                    ": the reference system is earth-centred, the coordinates are not near the ground; they are used as metres"
                        .to_owned()
                });
            }
        }
        let zone = self.builder.zone.unwrap_or(UtmZone { number: 31, is_south: false });
        Placing { transform: self.transform, axes: self.axes, zone, frame: self.builder.frame }
    }

    /// The lines after the header; a bad one is named and left out. Features that span several lines are read, too, as long as each is
    /// whole.
    fn read_features(&mut self, bytes: &[u8], start: usize) {
        let lines = |bytes: &[u8]| bytes.iter().filter(|b| **b == b'\n').count();
        let (mut at, mut line_number, mut can_span) = (start, lines(&bytes[..start]) + 1, true);
        while at < bytes.len() {
            let rest = &bytes[at..];
            let mut end = rest.iter().position(|b| *b == b'\n').map_or(rest.len(), |newline| newline + 1);
            if !rest[..end].trim_ascii().is_empty() {
                end = self.read_feature(rest, end, line_number, &mut can_span);
            }
            at += end;
            line_number += lines(&rest[..end]);
        }
    }

    /// Reads a feature from the beginning of a text whose first line is so long; returns how much of it was read. `can_span`: whether
    /// features may go on in the next lines.
    fn read_feature(&mut self, text: &[u8], line: usize, line_number: usize, can_span: &mut bool) -> usize {
        let own = &text[..line];
        let mut json = Json::new(own.strip_suffix(b"\n").unwrap_or(own));
        let mut document = Document::read(&mut json, self.builder);
        let mut read = line;
        if document.damage.is_some_and(|damage| *can_span && damage.at >= own.trim_ascii_end().len()) {
            let mut whole = Json::new(text);
            let spanning = Document::read(&mut whole, self.builder);
            *can_span = spanning.damage.is_none();
            if *can_span {
                (document, read, json) = (spanning, whole.offset(), Json::new(b""));
                self.warn(WarningCode::Malformed, || {
                    format!(
                        ", line {line_number}: a feature spans several lines; one line each is what other programs read"
                    )
                });
            }
        }
        self.add_feature(document, &mut json, line_number);
        read
    }

    fn add_feature(&mut self, document: Document, json: &mut Json<'_>, line_number: usize) {
        if let Some(damage) = document.damage {
            return self.warn(WarningCode::Malformed, || {
                format!(", line {line_number}, column {}: {}; the line is skipped", damage.at + 1, damage.message)
            });
        }
        match document.kind.as_deref() {
            Some("CityJSONFeature") => {}
            // Files joined end to end: a header again.
            Some("CityJSON") => {
                self.axes = Axes::Metric;
                self.adopt_crs(document.crs.as_deref());
                self.transform = document.transform.unwrap_or(self.transform);
            }
            _ => {
                return self.warn(WarningCode::Malformed, || {
                    format!(", line {line_number}: expected \"type\": \"CityJSONFeature\"; the line is skipped")
                });
            }
        }
        if !json.is_at_end() {
            self.warn(WarningCode::Malformed, || {
                format!(", line {line_number}: text after the feature is ignored; each feature needs a line of its own")
            });
        }
        self.add(document);
    }
}

#[cfg(test)]
mod tests;
