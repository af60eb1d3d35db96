//! Sheet files (TOML), as `docs/sheet.md` has them.

use std::{collections::BTreeSet, path::Path};

use crate::{
    figure::{
        scene_file::{
            SceneFileError,
            check::{Checker, Fields, Place},
            node::{self, Node},
            read_text, text_size,
        },
        sheet::{CellFigure, CellNote, Setting, Sheet, Variation, keys, layout::A4_DPI},
    },
    lens::nearest::did_you_mean,
    scene::DEFAULT_DPI,
};

/// How often frames are timed where nothing is said.
const PAIRS: usize = 15;
/// Longest name of a row or column: it becomes part of a file's.
const LONGEST_NAME: usize = 64;

/// Reads a sheet file (`-`: standard input).
pub fn read(path: &Path) -> Result<Sheet, SceneFileError> {
    let name = path.display().to_string();
    parse(&read_text(path, &name, "sheet")?, &name)
}

/// Reads a sheet from text; `name` stands for it in messages.
pub fn parse(text: &str, name: &str) -> Result<Sheet, SceneFileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let root =
        node::parse(text).map_err(|(line, message)| SceneFileError::whole(name, line, message.replace('\n', ", ")))?;
    if root.has("veduta") && !root.has("veduta_sheet") {
        let message = "is a scene; a sheet begins with veduta_sheet = 1 and names its scene: scene = \"FILE.toml\"";
        return Err(SceneFileError::whole(name, 1, message));
    }
    let mut reader = Reader::default();
    let sheet = reader.sheet(&root);
    let mut problems = reader.checker.problems;
    match sheet.filter(|_| problems.is_empty()) {
        Some(sheet) => Ok(sheet),
        None => {
            problems.sort_by_key(|p| p.line);
            Err(SceneFileError { name: name.into(), problems, has_lines: true, is_data_absent: false })
        }
    }
}

#[derive(Default)]
struct Reader {
    checker: Checker,
}

impl Reader {
    fn sheet(&mut self, root: &Node) -> Option<Sheet> {
        let place = Place { table: String::new(), prefix: String::new(), line: 1 };
        let top = self.checker.fields(root, &keys::ROOT, &[], place);
        let rows = self.variations(&top, "row");
        let columns = self.variations(&top, "column");
        let notes = self.notes(&top, &rows, &columns);
        let integer = |key| top.integer(key).map(|n| n as usize);
        if !rows.is_empty() && top.given("wrap") {
            self.checker.note(&top.place, "wrap", top.line("wrap"), "has a meaning only where there is no [[row]]");
        }
        let cell_size = top.node("cell_size").and_then(Node::numbers::<2>).map(|size| size.map(|side| side as u32));
        let dpi = top.number("dpi");
        let of_page = (!top.given("cell_size")).then_some(A4_DPI);
        Some(Sheet {
            scene: top.text("scene")?.to_owned(),
            settings: settings(&top),
            wrap: integer("wrap"),
            figures: self.figures(&top),
            poi: top.text("poi").map(str::to_owned),
            pairs: integer("pairs").unwrap_or(PAIRS),
            title: top.text("title").map(str::to_owned),
            caption: top.text("caption").map(str::to_owned),
            legend: top.boolean("legend").unwrap_or(true),
            cell_size,
            samples: top.integer("samples"),
            gap_px: top.number("gap_px"),
            text: text_size(&mut self.checker, &top, dpi.or(of_page).unwrap_or(DEFAULT_DPI)),
            dpi,
            rows,
            columns,
            notes,
        })
    }

    fn variations(&mut self, top: &Fields, key: &'static str) -> Vec<Variation> {
        let table = if key == "row" { &keys::ROW } else { &keys::COLUMN };
        let list = top.node(key).and_then(Node::list).unwrap_or_default();
        if list.len() > keys::MOST as usize {
            let message = format!("are {} in all; at most {} would be right", list.len(), keys::MOST);
            self.checker.note(&top.place, key, top.line(key), message);
            return Vec::new();
        }
        let mut known = BTreeSet::new();
        let mut found = Vec::new();
        for (i, node) in list.iter().enumerate() {
            let place = Place { table: format!("{key}.{i}"), prefix: String::new(), line: node.line };
            let fields = self.checker.fields(node, table, &[], place);
            let given = fields.text("name").map(str::to_owned);
            let name = given.clone().unwrap_or_else(|| (i + 1).to_string());
            let is_plain = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
            if name.chars().count() > LONGEST_NAME || !name.chars().all(is_plain) {
                let message = format!(
                    "must be at most {LONGEST_NAME} letters, digits, - and _, is {name:?}; heading has the rest"
                );
                self.checker.note(&fields.place, "name", fields.line("name"), message);
            }
            if !known.insert(name.clone()) {
                let message = format!("\"{name}\" is the name of another {key} already; names must differ");
                self.checker.note(&fields.place, "name", fields.line("name"), message);
            }
            let heading = fields.text("heading").map(str::to_owned).or(given);
            found.push(Variation { name, heading, settings: settings(&fields) });
        }
        found
    }

    fn notes(&mut self, top: &Fields, rows: &[Variation], columns: &[Variation]) -> Vec<CellNote> {
        let list = top.node("cell").and_then(Node::list).unwrap_or_default();
        let mut known = BTreeSet::new();
        let mut found = Vec::new();
        for (i, node) in list.iter().enumerate() {
            let place = Place { table: format!("cell.{i}"), prefix: String::new(), line: node.line };
            let fields = self.checker.fields(node, &keys::CELL, &[], place);
            let at = [("row", rows), ("column", columns)].map(|(key, all)| self.named(&fields, key, all));
            let [Some(row), Some(column)] = at else { continue };
            if !known.insert([row, column]) {
                self.checker.note(&fields.place, "", node.line, "is a second table of this cell; put both into one");
            }
            let caption = fields.text("caption").map(str::to_owned);
            found.push(CellNote { row, column, caption, settings: settings(&fields) });
        }
        found
    }

    /// Which of `all` a cell names.
    fn named(&mut self, fields: &Fields, key: &str, all: &[Variation]) -> Option<usize> {
        let message = match (fields.text(key), all.len()) {
            (None, _) if fields.given(key) => return None,
            (None, 0 | 1) => return Some(0),
            (None, _) => format!("is missing: name the {key} of the cell, for example {key} = \"{}\"", all[0].name),
            (Some(name), _) => match all.iter().position(|one| one.name == name) {
                Some(at) => return Some(at),
                None => {
                    let hint = did_you_mean(name, all.iter().map(|one| one.name.as_str()));
                    format!("there is no {key} \"{name}\"{hint}")
                }
            },
        };
        self.checker.note(&fields.place, key, fields.line(key), message);
        None
    }

    fn figures(&mut self, top: &Fields) -> Vec<CellFigure> {
        let mut found = Vec::new();
        for (i, node) in top.node("figures").and_then(Node::list).unwrap_or_default().iter().enumerate() {
            let word = node.text().unwrap_or_default();
            let figure = CellFigure::WORDS.iter().find(|(known, _)| *known == word).map(|(_, figure)| *figure);
            let message = match figure {
                Some(figure) if found.contains(&figure) => format!("\"{word}\" stands there already"),
                Some(figure) => {
                    found.push(figure);
                    continue;
                }
                None => {
                    let words = CellFigure::WORDS.map(|(word, _)| word);
                    let all = words.map(|word| format!("\"{word}\"")).join(" or ");
                    format!("must be {all}, is \"{word}\"{}", did_you_mean(word, words))
                }
            };
            self.checker.note(&top.place, &format!("figures.{i}"), node.line, message);
        }
        found
    }
}

/// The changes of a table.
fn settings(fields: &Fields) -> Vec<Setting> {
    let table = if fields.place.table.is_empty() { String::new() } else { format!("[{}] ", fields.place.table) };
    let list = fields.node("set").and_then(Node::list).unwrap_or_default();
    let setting = |(i, node): (usize, &Node)| Setting {
        assignment: node.text().unwrap_or_default().to_owned(),
        place: format!("{table}set.{i}"),
        line: node.line,
    };
    list.iter().enumerate().map(setting).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHEET: &str = r#"
veduta_sheet = 1
scene = "a.toml"
set = ["style.base=clay"]
figures = ["occluders", "visible-share"]
poi = "hall"
title = "T"
[[row]]
name = "near"
set = ["lens.0.shape.radius=40", "sun.shadows=false"]
[[row]]
[[column]]
name = "sepia"
heading = "Sepia!"
[[column]]
name = "old"
[[cell]]
row = "2"
column = "sepia"
caption = "C"
set = ["lens.0.enabled=false"]
"#;

    #[test]
    fn a_sheet_is_read() {
        let sheet = parse(SHEET, "s").unwrap();
        assert_eq!((sheet.grid(), sheet.lines(), sheet.pairs, sheet.legend), ([2, 2], [2, 2], 15, true));
        let said = |all: &[Variation]| -> Vec<(String, Option<String>, usize)> {
            all.iter().map(|v| (v.name.clone(), v.heading.clone(), v.settings.len())).collect()
        };
        assert_eq!(said(&sheet.rows), [("near".into(), Some("near".into()), 2), ("2".into(), None, 0)]);
        assert_eq!(sheet.columns[0].heading.as_deref(), Some("Sepia!"));
        assert_eq!(sheet.figures, [CellFigure::Occluders, CellFigure::VisibleShare]);
        let note = &sheet.notes[0];
        assert_eq!((note.row, note.column, note.caption.as_deref()), (1, 0, Some("C")));
        let setting = &sheet.rows[0].settings[1];
        assert_eq!((setting.place.as_str(), setting.line), ("[row.0] set.1", 10));
        assert_eq!(sheet.settings[0].place, "set.0");
    }

    #[test]
    fn columns_alone_may_wrap() {
        let columns = |n: usize| "[[column]]\n".repeat(n);
        let lines = |wrap: usize, n: usize| {
            parse(&format!("veduta_sheet = 1\nscene = \"a\"\nwrap = {wrap}\n{}", columns(n)), "s").unwrap().lines()
        };
        assert_eq!([lines(4, 10), lines(4, 4), lines(4, 3), lines(1, 3)], [[3, 4], [1, 4], [1, 3], [3, 1]]);
    }

    #[test]
    fn every_mistake_names_its_line_place_and_remedy() {
        for (from, to, expected) in [
            ("scene = \"a.toml\"\n", "", "s:1: scene: is missing"),
            ("veduta_sheet = 1", "veduta_sheet = 2", "s:2: veduta_sheet: must be 1, is 2"),
            ("veduta_sheet = 1", "veduta = 1", "s:1: is a scene; a sheet begins with veduta_sheet = 1"),
            ("title", "titel", "s:7: titel: unknown key; did you mean \"title\"?"),
            ("heading", "header", "[column.0] header: unknown key; did you mean \"heading\"?"),
            ("\"occluders\"", "\"ocluders\"", "figures.0: must be \"visible-share\" or"),
            ("\"occluders\"", "\"ocluders\"", "did you mean \"occluders\"?"),
            ("\"occluders\"", "\"visible-share\"", "figures.1: \"visible-share\" stands there already"),
            ("name = \"old\"", "name = \"sepia\"", "[column.1] name: \"sepia\" is the name of another column already"),
            ("name = \"old\"", "name = \"a/b\"", "[column.1] name: must be at most 64 letters"),
            ("row = \"2\"", "row = \"nera\"", "s:18: [cell.0] row: there is no row \"nera\"; did you mean \"near\"?"),
            ("row = \"2\"\n", "", "[cell.0] row: is missing: name the row of the cell, for example row = \"near\""),
            ("poi = \"hall\"", "wrap = 2", "wrap: has a meaning only where there is no [[row]]"),
            ("poi = \"hall\"", "pairs = 0", "pairs: must be a whole number 1 to 10000"),
            ("poi = \"hall\"", "cell_size = [0, 9]", "cell_size: must be [width, height]"),
            ("poi = \"hall\"", "text_px = 9\ntext_pt = 9", "text_pt: is given together with text_px"),
            ("poi = \"hall\"", "text_pt = 97", "text_pt: 97 points at 300 dpi are 404.17 pixels; 6 to 400"),
            ("poi = \"hall\"", "text_pt = 4\ncell_size = [9, 9]", "text_pt: 4 points at 96 dpi are 5.33 pixels"),
            ("set = [\"style.base=clay\"]", "set = [1]", "set: must be a list of texts"),
            ("[[row]]\n[[column]]", "[[column]]", "[cell.0] row: there is no row \"2\""),
        ] {
            assert!(SHEET.contains(from), "{from}");
            let message = parse(&SHEET.replacen(from, to, 1), "s").unwrap_err().to_string();
            assert!(message.contains(expected), "{to}: {message}");
        }
    }
}
