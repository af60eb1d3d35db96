//! What is in files of volumes, for people.

use super::{INDENT, Report, WIDTH};
use crate::cli::{
    info::{FieldFacts, VolumeFacts},
    report::cells::{Align, Table, clean, count, wrap},
    terminal::Paint,
};

/// The whole report, ending with a newline.
pub fn volumes_text(files: &[VolumeFacts], paint: Paint) -> String {
    let mut report = Report { out: String::new(), paint };
    for (i, file) in files.iter().enumerate() {
        if i > 0 {
            report.gap();
        }
        report.volume(file);
    }
    report.out
}

/// A number as it stands in tables.
fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    match text.contains('.') && value.abs() < 1e7 && (value == 0.0 || value.abs() >= 1e-3) {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => format!("{value:.3e}"),
    }
}

fn sizes(size: [usize; 3]) -> String {
    size.map(|n| count(n as u64)).join(" × ")
}

impl Report {
    fn volume(&mut self, file: &VolumeFacts) {
        let name = clean(&file.file);
        let format = self.paint.faint(file.format);
        let line = format!("{}  {format}", self.paint.strong(&name));
        self.line("Volume", &line);
        self.gap();
        let headings = [
            ("array", Align::Left),
            ("samples", Align::Left),
            ("numbers", Align::Right),
            ("steps", Align::Right),
            ("from", Align::Right),
            ("to", Align::Right),
            ("missing", Align::Right),
            ("unit", Align::Left),
        ];
        let mut table = Table::new(&headings);
        let value = |value: Option<f32>| value.map_or_else(|| "–".to_owned(), |value| number(value.into()));
        for field in &file.fields {
            table.row([
                clean(&field.name),
                sizes(field.size),
                count(field.components as u64),
                count(field.times.len() as u64),
                value(field.min),
                value(field.max),
                count(field.missing as u64),
                field.unit.as_deref().map_or_else(String::new, clean),
            ]);
        }
        self.table("Arrays", &table);
        self.gap();
        let mut known: Vec<(&FieldFacts, String)> = Vec::new();
        for field in &file.fields {
            let is_known = known
                .iter()
                .any(|(one, _)| (one.size, one.origin, one.steps) == (field.size, field.origin, field.steps));
            if !is_known {
                known.push((field, clean(&field.name)));
            }
        }
        for (i, (field, name)) in known.iter().enumerate() {
            let point = |p: [f64; 3]| format!("[{}]", p.map(number).join(", "));
            let heading = if i == 0 { "Grid" } else { "" };
            let of = if known.len() > 1 { format!("{name}: ") } else { String::new() };
            self.line(heading, &format!("{of}the first sample at {}", point(field.origin)));
            self.line("", &format!("steps {}", field.steps.map(point).join(", ")));
        }
        for (i, warning) in file.warnings.iter().enumerate() {
            for (k, line) in wrap(&clean(warning), WIDTH - INDENT).into_iter().enumerate() {
                let line = self.paint.warning(&line);
                self.line(if i + k == 0 { "Warnings" } else { "" }, &line);
            }
        }
    }
}
