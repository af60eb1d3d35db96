//! What became of a city, for people.

use std::fmt::Write;

use super::{INDENT, Report, WIDTH};
use crate::{
    city::compare::Counts,
    cli::{
        info::{CompareFacts, ListedChange, StateFacts},
        report::cells::{Align, Table, clean, count, cut},
        terminal::Paint,
    },
};

/// Attributes and types that are shown.
const SHOWN: usize = 24;

/// The whole report, ending with a newline.
pub fn compare_text(facts: &CompareFacts, paint: Paint) -> String {
    let mut report = Report { out: String::new(), paint };
    report.states(facts);
    report.counts(facts);
    report.types_and_attributes(facts);
    report.volumes(facts);
    report.changes(facts);
    report.out
}

impl Report {
    fn states(&mut self, facts: &CompareFacts) {
        for (heading, state) in [("Before", &facts.before), ("After", &facts.after)] {
            let what = format!("{} objects", count(state.objects));
            let name = cut(&name(state), WIDTH - INDENT - what.len() - 2);
            let line = format!("{}  {}", self.paint.strong(&name), self.paint.faint(&what));
            self.line(heading, &line);
        }
        let matched = facts.matched;
        let key = facts.key.as_ref().map_or_else(String::new, |key| cut(&clean(key), 40));
        let ways = [
            (matched.key, format!("by {key}")),
            (matched.id, "by id".to_owned()),
            (matched.version, "as predecessor and successor".to_owned()),
            (matched.part, "as parts".to_owned()),
        ];
        let ways: Vec<String> =
            ways.iter().filter(|(n, _)| *n > 0).map(|(n, how)| format!("{} {how}", count(*n))).collect();
        let ways = if ways.is_empty() { "none".to_owned() } else { ways.join(", ") };
        self.line("Matched", &cut(&ways, WIDTH - INDENT));
        if facts.repeated_keys > 0 {
            let values: Vec<String> = facts.first_repeated_keys.iter().map(|key| clean(&key.value)).collect();
            let more = if facts.repeated_keys > values.len() as u64 { ", …" } else { "" };
            let number = count(facts.repeated_keys);
            let line = format!("{number} values of several objects, matched by id or not: {}{more}", values.join(", "));
            let line = self.paint.warning(&cut(&line, WIDTH - INDENT));
            self.line("", &line);
        }
        let tolerance = facts.tolerance_m.map(|metres| format!("{:.2}", 1000.0 * metres));
        let [x, y, z] = &tolerance;
        let text = if x == y && y == z { x.clone() } else { tolerance.join(" × ") };
        let line = self.paint.faint(&format!("corners up to {text} mm apart are the same"));
        self.line("", &line);
    }

    fn counts(&mut self, facts: &CompareFacts) {
        self.gap();
        let columns = [("", Align::Left), ("all", Align::Right), ("without parents", Align::Right)];
        let mut table = Table::new(&columns);
        let mut row = |name: &str, of: fn(&Counts) -> u64| {
            table.row([name.to_owned(), count(of(&facts.objects)), count(of(&facts.roots))]);
        };
        row("added", |counts| counts.added);
        row("removed", |counts| counts.removed);
        row("changed", |counts| counts.changed);
        row("  geometry", |counts| counts.changed_geometry);
        row("  attributes", |counts| counts.changed_attributes);
        row("unchanged", |counts| counts.unchanged);
        self.table("Objects", &table);
        if facts.types_changed > 0 {
            let line = format!("{} have another type", count(facts.types_changed));
            self.line("", &line);
        }
    }

    fn types_and_attributes(&mut self, facts: &CompareFacts) {
        let columns = [("added", Align::Right), ("removed", Align::Right), ("changed", Align::Right)];
        let columns = [&[("", Align::Left)], &columns[..]].concat();
        self.gap();
        let mut table = Table::new(&[&columns[..], &[("unchanged", Align::Right)]].concat());
        for (kind, counts) in facts.by_type.iter().take(SHOWN) {
            let numbers = [counts.added, counts.removed, counts.changed, counts.unchanged].map(count);
            let [added, removed, changed, unchanged] = numbers;
            table.row([cut(&clean(kind), 40), added, removed, changed, unchanged]);
        }
        self.table("Types", &table);
        self.more(facts.by_type.len(), "types");
        if facts.attributes.is_empty() {
            return;
        }
        self.gap();
        let mut table = Table::new(&columns);
        for (name, counts) in facts.attributes.iter().take(SHOWN) {
            let [added, removed, changed] = [counts.added, counts.removed, counts.changed].map(count);
            table.row([cut(&clean(name), 40), added, removed, changed]);
        }
        self.table("Attributes", &table);
        self.more(facts.attributes.len(), "attributes");
    }

    fn more(&mut self, all: usize, what: &str) {
        if all > SHOWN {
            let more = self.paint.faint(&format!("and {} more {what}", all - SHOWN));
            self.line("", &more);
        }
    }

    fn volumes(&mut self, facts: &CompareFacts) {
        let volume = facts.volume_m3;
        let text = |cubic_metres: f64| format!("{} m³", count(cubic_metres.round() as u64));
        let one = |what: &str, volume: Option<f64>| volume.map(|volume| format!("{what} {}", text(volume)));
        let changed = volume.changed_before.zip(volume.changed_after);
        let changed = changed.map(|(old, new)| format!("changed {} → {}", text(old), text(new)));
        let parts = [one("added", volume.added), one("removed", volume.removed), changed];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if !parts.is_empty() {
            self.gap();
            self.line("Volume", &parts.join(", "));
        }
    }

    fn changes(&mut self, facts: &CompareFacts) {
        let Some(list) = &facts.list else { return };
        self.gap();
        if list.is_empty() {
            return self.line("Changes", "none: all objects are the same");
        }
        let columns = [("", Align::Left), ("id", Align::Left), ("type", Align::Left), ("what", Align::Left)];
        let mut table = Table::new(&columns);
        for change in list {
            table.row([change.state.to_owned(), clean(&change.id), clean(&change.kind), what(change)]);
        }
        // Ids are for copying: this table alone may be wider than the rest.
        for line in table.lines(self.paint, usize::MAX) {
            let _ = writeln!(self.out, "{}", line.trim_end());
        }
    }
}

/// What a state is called.
fn name(state: &StateFacts) -> String {
    match &state.files[..] {
        [] => "nothing".to_owned(),
        [file] => clean(&file.display().to_string()),
        [file, others @ ..] => format!("{} and {} more", clean(&file.display().to_string()), others.len()),
    }
}

/// What differs in an object, in words.
fn what(change: &ListedChange) -> String {
    let value = |value: &serde_json::Value| match value {
        serde_json::Value::String(text) => cut(&clean(text), 40),
        other => cut(&clean(&other.to_string()), 40),
    };
    let mut parts: Vec<String> = Vec::new();
    parts.extend(change.id_before.iter().map(|id| format!("was {}", clean(id))));
    parts.extend(change.type_before.iter().map(|kind| format!("was a {}", clean(kind))));
    if change.geometry {
        parts.push("geometry".to_owned());
    }
    for (name, [old, new]) in &change.attributes {
        parts.push(format!("{} {} → {}", cut(&clean(name), 40), value(old), value(new)));
    }
    if change.parts {
        parts.push("parts".to_owned());
    }
    parts.join("; ")
}
