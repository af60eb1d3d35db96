//! The text form of an [`Answer`]: one screen that tells what a file is, at most 100 columns wide.
//!
//! Text from files is shown with control characters replaced: an id must not be able to steer the terminal.

mod cells;
mod compare;
mod crs;
mod sights;
mod volumes;

use std::fmt::Write;

use crate::{
    city::{
        Source,
        facts::{AttributeFacts, Extent, Facts, TreeLine},
    },
    cli::{
        info::{Answer, PlaceFacts},
        report::cells::{Align, Table, bytes, clean, count, cut, length, percent},
        terminal::Paint,
    },
};

pub use cells::wrap;
pub use compare::compare_text;
pub use volumes::volumes_text;

/// Columns at most.
const WIDTH: usize = 100;
/// Where the text beside a heading starts.
const INDENT: usize = 12;

/// The whole report, ending with a newline.
pub fn text(answer: &Answer, sources: &[Source], paint: Paint) -> String {
    let facts = &answer.facts;
    let mut report = Report { out: String::new(), paint };
    report.files(facts, sources);
    report.place(facts);
    report.objects(facts);
    report.levels(facts);
    report.surfaces(facts);
    report.attributes(facts);
    report.time(facts);
    report.joins(facts);
    report.timetables(facts);
    report.textures(facts);
    report.warnings(facts);
    report.list(facts);
    answer.at.iter().for_each(|at| report.at(at));
    answer.landmarks.iter().for_each(|landmarks| report.landmarks(landmarks));
    answer.best_views.iter().for_each(|views| report.best_views(views));
    report.out
}

struct Report {
    out: String,
    paint: Paint,
}

impl Report {
    /// A line below a heading: the heading stands beside the first one only.
    fn line(&mut self, heading: &str, text: &str) {
        let pad = " ".repeat(INDENT.saturating_sub(heading.chars().count()));
        let line = format!("{}{pad}{text}", self.paint.heading(heading));
        self.out.push_str(line.trim_end());
        self.out.push('\n');
    }

    fn gap(&mut self) {
        self.out.push('\n');
    }

    /// A table below a heading.
    fn table(&mut self, heading: &str, table: &Table) {
        for (i, line) in table.lines(self.paint, WIDTH - INDENT).iter().enumerate() {
            self.line(if i == 0 { heading } else { "" }, line);
        }
    }

    fn files(&mut self, facts: &Facts, sources: &[Source]) {
        const SHOWN: usize = 6;
        for (i, source) in sources.iter().take(SHOWN).enumerate() {
            let size = std::fs::metadata(&source.path).map(|m| bytes(m.len())).unwrap_or_default();
            let kind = format!("{} {}", source.format, clean(&source.version));
            let what = [kind.trim().to_owned(), size].into_iter().filter(|part| !part.is_empty());
            let what = what.collect::<Vec<_>>().join(", ");
            let heading = if i > 0 {
                ""
            } else if sources.len() == 1 {
                "File"
            } else {
                "Files"
            };
            let name = cut(&clean(&source.path.display().to_string()), WIDTH - INDENT - what.len() - 2);
            let line = format!("{}  {}", self.paint.strong(&name), self.paint.faint(&what));
            self.line(heading, &line);
        }
        if sources.len() > SHOWN {
            let more = format!("and {} more, together {}", sources.len() - SHOWN, facts.format);
            self.line("", &self.paint.faint(&more));
        }
    }

    fn place(&mut self, facts: &Facts) {
        let system = match (&facts.crs, &facts.crs_raw) {
            (Some(crs), _) => match crs::name(crs) {
                Some(name) => format!("{}, {name}", clean(crs)),
                None => clean(crs),
            },
            (None, Some(raw)) => format!("not understood: {}", cut(&clean(raw), WIDTH - INDENT - 18)),
            (None, None) => "not stated".to_owned(),
        };
        self.line("Reference", &system);
        let Some(extent) = facts.extent else { return self.line("Extent", "no geometry") };
        let size: [f64; 3] = std::array::from_fn(|i| extent.max[i] - extent.min[i]);
        let human = format!("{} east–west, {} north–south, {} high", length(size[0]), length(size[1]), length(size[2]));
        self.line("Extent", &human);
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let range = format!("{name} {} … {}", number(extent.min[axis]), number(extent.max[axis]));
            self.line("", &self.paint.faint(&range));
        }
    }

    fn objects(&mut self, facts: &Facts) {
        self.gap();
        let total = self.paint.strong(&count(facts.objects.total));
        self.line("Objects", &total);
        const SHOWN: usize = 24;
        let mut table = Table::new(&[("", Align::Left), ("", Align::Right), ("", Align::Left)]);
        let most = facts.tree.iter().map(|line| line.count).max().unwrap_or(1);
        for (i, line) in facts.tree.iter().take(SHOWN).enumerate() {
            table.row([branch(&facts.tree, i), count(line.count), bar(line.count, most, 24)]);
        }
        self.table("", &table);
        if facts.tree.len() > SHOWN {
            let more = format!("and {} more types", facts.tree.len() - SHOWN);
            self.line("", &self.paint.faint(&more));
        }
    }

    fn levels(&mut self, facts: &Facts) {
        if facts.lods.is_empty() {
            return;
        }
        self.gap();
        let columns = [("LoD", Align::Left), ("objects", Align::Right), ("polygons", Align::Right)];
        let mut table = Table::new(&[&columns[..], &[("triangles", Align::Right)]].concat());
        for (lod, level) in &facts.lods {
            table.row([lod.clone(), count(level.objects), count(level.polygons), count(level.triangles)]);
        }
        self.table("Geometry", &table);
        let [solid, all] = facts.solids;
        if solid > 0 {
            let share = format!("{} of {} geometries are solids", count(solid), count(all));
            self.line("", &self.paint.faint(&share));
        }
        if facts.faces_dropped > 0 {
            let dropped = format!("{} faces are not drawn, see the warnings", count(facts.faces_dropped));
            self.line("", &self.paint.warning(&dropped));
        }
    }

    fn surfaces(&mut self, facts: &Facts) {
        if facts.semantics.is_empty() {
            return;
        }
        self.gap();
        const SHOWN: usize = 16;
        let all: u64 = facts.semantics.iter().map(|(_, n)| n).sum();
        let columns = [("type", Align::Left), ("triangles", Align::Right), ("", Align::Right)];
        let mut table = Table::new(&columns);
        for (kind, triangles) in facts.semantics.iter().take(SHOWN) {
            let kind = if kind.is_empty() { "without".to_owned() } else { clean(kind) };
            table.row([kind, count(*triangles), percent(*triangles, all)]);
        }
        self.table("Surfaces", &table);
    }

    fn attributes(&mut self, facts: &Facts) {
        if facts.attributes.is_empty() {
            return;
        }
        self.gap();
        let columns = [("name", Align::Left), ("type", Align::Left), ("filled", Align::Right)];
        let mut table =
            Table::new(&[&columns[..], &[("distinct", Align::Right), ("range or values", Align::Left)]].concat());
        for (name, attribute) in &facts.attributes {
            table.row([
                cut(&clean(name), 40),
                attribute.kind.unwrap_or("null").to_owned(),
                percent(attribute.count, facts.objects.total),
                count(attribute.distinct),
                values(attribute),
            ]);
        }
        self.table("Attributes", &table);
    }

    /// What is at a place.
    fn at(&mut self, at: &PlaceFacts) {
        self.gap();
        let ground = match at.ground_m {
            Some(height) if at.is_plain_ground => {
                format!("ground at {height:.2} m (of no file: from the bases of buildings)")
            }
            Some(height) => format!("ground at {height:.2} m"),
            None => "no ground".to_owned(),
        };
        self.line("At", &format!("{}, {}: {ground}", at.x, at.y));
        let (Some(top), Some(object)) = (at.top_m, &at.object) else { return self.line("", "nothing stands there") };
        let above = at.above_ground_m.map_or_else(String::new, |above| format!(", {above:.2} m above the ground"));
        let kind = at.r#type.as_deref().unwrap_or_default();
        self.line("", &format!("top at {top:.2} m{above}: {} ({})", clean(object), clean(kind)));
    }

    fn time(&mut self, facts: &Facts) {
        let Some(time) = &facts.time else { return };
        self.gap();
        let named = |word: &str, name: &Option<String>| name.as_ref().map(|name| format!("{word} {}", clean(name)));
        let names: Vec<String> = named("from", &time.from).into_iter().chain(named("until", &time.until)).collect();
        let span = time.first.as_ref().zip(time.last.as_ref()).map(|(first, last)| format!(": {first} … {last}"));
        self.line("Time", &format!("{}{}", cut(&names.join(", "), WIDTH - INDENT - 50), span.unwrap_or_default()));
        let mut counts = vec![format!("{} dated", count(time.dated)), format!("{} undated", count(time.undated))];
        let others =
            [(time.empty, "end when they begin, and are never there"), (time.unreadable, "values are no times")];
        counts.extend(others.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{} {what}", count(*n))));
        self.line("", &self.paint.faint(&counts.join(", ")));
        if let Some(first) = &time.first_unreadable {
            let line = self.paint.warning(&cut(&clean(first), WIDTH - INDENT));
            self.line("", &line);
        }
    }

    fn joins(&mut self, facts: &Facts) {
        for (i, join) in facts.joins.iter().enumerate() {
            if i == 0 {
                self.gap();
            }
            let by = match &join.attribute {
                Some(attribute) => format!("{} = {}", clean(&join.key), clean(attribute)),
                None => format!("{} = id", clean(&join.key)),
            };
            let name = cut(&clean(&join.file.display().to_string()), WIDTH - INDENT - by.len().min(40) - 2);
            self.line(if i == 0 { "Joined" } else { "" }, &format!("{}  {}", self.paint.strong(&name), cut(&by, 40)));
            let mut counts = vec![
                format!("{} of {} rows joined", count(join.joined), count(join.rows)),
                format!("{} objects got {} attributes", count(join.objects), join.attributes.len()),
            ];
            if join.repeated > 0 {
                counts.push(format!("{} rows repeat a key", count(join.repeated)));
            }
            self.line("", &self.paint.faint(&counts.join(", ")));
            if join.without_object > 0 {
                let keys: Vec<String> = join.first_without_object.iter().map(|key| clean(key)).collect();
                let more = if join.without_object > keys.len() as u64 { ", …" } else { "" };
                let line = format!("{} rows of no object: {}{more}", count(join.without_object), keys.join(", "));
                let line = self.paint.warning(&cut(&line, WIDTH - INDENT));
                self.line("", &line);
            }
        }
    }

    fn timetables(&mut self, facts: &Facts) {
        for (i, table) in facts.timetables.iter().enumerate() {
            if i == 0 {
                self.gap();
            }
            let name = cut(&clean(&table.file.display().to_string()), WIDTH - INDENT);
            let name = self.paint.strong(&name);
            self.line(if i == 0 { "Timetables" } else { "" }, &name);
            let mut counts = vec![format!("{} objects move by {} rows", count(table.objects), count(table.rows))];
            counts.extend(
                table.first.as_ref().zip(table.last.as_ref()).map(|(first, last)| format!("{first} to {last}")),
            );
            self.line("", &self.paint.faint(&counts.join(", ")));
            if table.without_object > 0 {
                let keys: Vec<String> = table.first_without_object.iter().map(|key| clean(key)).collect();
                let line = format!("{} rows of no object: {}", count(table.without_object), keys.join(", "));
                let line = self.paint.warning(&cut(&line, WIDTH - INDENT));
                self.line("", &line);
            }
        }
    }

    fn textures(&mut self, facts: &Facts) {
        let textures = facts.textures;
        if textures.declared > 0 {
            self.gap();
            let line = format!("{} named, {} found", count(textures.declared), count(textures.found));
            let line = if textures.found < textures.declared { self.paint.warning(&line) } else { line };
            self.line("Textures", &line);
        }
    }

    fn warnings(&mut self, facts: &Facts) {
        self.gap();
        if facts.warnings.is_empty() {
            return self.line("Warnings", "none");
        }
        for (i, warning) in facts.warnings.iter().enumerate() {
            let title = format!("{} × {}", count(warning.count), self.paint.warning(warning.code));
            self.line(if i == 0 { "Warnings" } else { "" }, &title);
            for line in wrap(warning.meaning, WIDTH - INDENT - 2) {
                self.line("", &format!("  {line}"));
            }
            for line in wrap(&format!("first: {}", clean(&warning.message)), WIDTH - INDENT - 2).iter().take(3) {
                self.line("", &format!("  {}", self.paint.faint(line)));
            }
        }
    }

    fn list(&mut self, facts: &Facts) {
        let Some(list) = &facts.objects.list else { return };
        self.gap();
        let columns = [("index", Align::Right), ("id", Align::Left), ("type", Align::Left), ("LoD", Align::Left)];
        let place = [("middle", Align::Left), ("size", Align::Left)];
        let mut table = Table::new(&[&columns[..], &place, &[("parents", Align::Left)]].concat());
        for (index, object) in list.iter().enumerate() {
            let [middle, size] = object.extent.map_or_else(Default::default, |extent| place_and_size(&extent));
            table.row([
                index.to_string(),
                clean(&object.id),
                clean(&object.kind),
                object.lods.join(" "),
                middle,
                size,
                clean(&object.parents.join(" ")),
            ]);
        }
        // Ids are for copying: this table alone may be wider than the rest.
        for line in table.lines(self.paint, usize::MAX) {
            let _ = writeln!(self.out, "{}", line.trim_end());
        }
    }
}

/// A coordinate, millimetres shown where there are any.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The middle of a box, as scene files have places, and its size along the axes; to the centimetre.
fn place_and_size(Extent { min, max }: &Extent) -> [String; 2] {
    let all = |of: fn(f64, f64) -> f64| [0, 1, 2].map(|i| format!("{:.2}", of(min[i], max[i])));
    let size = all(|low, high| high - low).join(" × ");
    [format!("[{}]", all(|low, high| low + 0.5 * (high - low)).join(", ")), format!("{size} m")]
}

/// A type with the branch that leads to it from the type of its parents.
fn branch(tree: &[TreeLine], at: usize) -> String {
    let line = &tree[at];
    let mut text = String::new();
    for depth in 1..=line.depth {
        // Another line of this depth follows before the tree goes back above it.
        let goes_on = tree[at + 1..].iter().take_while(|l| l.depth >= depth).any(|l| l.depth == depth);
        text.push_str(match (depth == line.depth, goes_on) {
            (true, true) => "├ ",
            (true, false) => "└ ",
            (false, true) => "│ ",
            (false, false) => "  ",
        });
    }
    text + &cut(&clean(&line.kind), 40)
}

/// A bar of `width` columns for `most`, in eighths of a column.
fn bar(part: u64, most: u64, width: usize) -> String {
    let eighths = (part as f64 / most.max(1) as f64 * (width * 8) as f64).round() as usize;
    let rest = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"][eighths % 8];
    "█".repeat(eighths / 8) + rest
}

/// The range of numbers and dates, the most frequent of other values.
fn values(attribute: &AttributeFacts) -> String {
    let plain = |value: &serde_json::Value| match value {
        serde_json::Value::String(text) if text.trim().is_empty() => format!("{text:?}"),
        serde_json::Value::String(text) => clean(text),
        serde_json::Value::Number(n) => n.as_f64().filter(|_| n.is_f64()).map_or_else(|| n.to_string(), number),
        other => clean(&other.to_string()),
    };
    if let (Some(min), Some(max)) = (&attribute.min, &attribute.max) {
        return if min == max { plain(min) } else { format!("{} … {}", plain(min), plain(max)) };
    }
    let shown = |(value, times): &(serde_json::Value, u64)| match times {
        _ if attribute.distinct == attribute.count => cut(&plain(value), 30),
        times => format!("{} ×{}", cut(&plain(value), 24), count(*times)),
    };
    let mut parts: Vec<String> = attribute.values.iter().take(8).map(shown).collect();
    if attribute.distinct as usize > parts.len() {
        parts.push("…".to_owned());
    }
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::facts::{ObjectFacts, TextureFacts};

    fn line(depth: usize, kind: &str, count: u64) -> TreeLine {
        TreeLine { depth, kind: kind.into(), count }
    }

    fn some_facts() -> Facts {
        let attribute = AttributeFacts {
            count: 3,
            nulls: 1,
            kind: Some("string"),
            min: None,
            max: None,
            values: vec![("a\u{1b}[31m very long text that goes on and on and on".into(), 2), ("b".into(), 1)],
            distinct: 2,
        };
        Facts {
            format: "CityJSON".into(),
            version: Some("2.0".into()),
            crs: Some("EPSG:7415".into()),
            crs_raw: None,
            extent: None,
            objects: ObjectFacts { total: 4, by_type: vec![], list: None },
            lods: vec![("2.2".into(), Default::default())],
            attributes: vec![("x".repeat(300), attribute)],
            timetables: Vec::new(),
            joins: vec![crate::city::side_table::JoinFacts {
                file: "z/".repeat(120).into(),
                key: "\u{1b}k".repeat(90),
                attribute: Some("n".repeat(300)),
                rows: 9,
                joined: 5,
                objects: 6,
                without_object: 3,
                first_without_object: vec!["\u{1b}".into(), "q".repeat(300)],
                repeated: 1,
                attributes: vec!["a".into()],
            }],
            time: Some(crate::city::facts::TimeFacts {
                from: Some("f".repeat(300)),
                until: Some("u\u{1b}".repeat(300)),
                first: Some("1890".into()),
                last: Some("1950-05-03T14:05:30.000025".into()),
                granularity: Some("year"),
                dated: 4,
                undated: 2,
                empty: 1,
                unreadable: 3,
                first_unreadable: Some("\u{1b}".repeat(300)),
            }),
            textures: TextureFacts { declared: 1, found: 0 },
            faces_dropped: 1,
            warnings: vec![crate::city::facts::WarningFacts {
                code: "zero-area",
                count: 2,
                objects: vec![],
                message: "word ".repeat(100),
                meaning: "A face has no area.",
            }],
            tree: vec![line(0, "Building", 2), line(1, "BuildingPart", 1), line(1, "Room", 1)],
            semantics: vec![("RoofSurface".into(), 3), (String::new(), 1)],
            solids: [1, 2],
        }
    }

    fn some_answer() -> Answer {
        Answer { facts: some_facts(), at: None, best_views: None, landmarks: None }
    }

    #[test]
    fn a_report_fits_and_cannot_steer_the_terminal() {
        let source = Source { path: "y/".repeat(120).into(), format: "CityJSON", version: "2.0".into() };
        let text = text(&some_answer(), &[source], Paint { on: false });
        assert!(!text.contains('\u{1b}'), "{text}");
        for line in text.lines() {
            assert!(line.chars().count() <= WIDTH, "{} columns: {line}", line.chars().count());
        }
        for part in
            ["Amersfoort", "├ BuildingPart", "└ Room", "zero-area", "75 %", "1 named, 0 found", "5 of 9 rows joined"]
        {
            assert!(text.contains(part), "{part} is missing in:\n{text}");
        }
    }

    #[test]
    fn colours_only_where_wanted() {
        assert!(text(&some_answer(), &[], Paint { on: true }).contains("\u{1b}[1;36mObjects"));
    }

    #[test]
    fn branches_close_where_they_end() {
        let tree = [line(0, "a", 1), line(1, "b", 1), line(2, "c", 1), line(1, "d", 1), line(0, "e", 1)];
        let drawn: Vec<_> = (0..tree.len()).map(|i| branch(&tree, i)).collect();
        assert_eq!(drawn, ["a", "├ b", "│ └ c", "└ d", "e"]);
    }

    #[test]
    fn bars_are_in_eighths() {
        assert_eq!(bar(10, 10, 3), "███");
        assert_eq!(bar(5, 10, 3), "█▌");
        assert_eq!(bar(0, 0, 3), "");
    }
}
