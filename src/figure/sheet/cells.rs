//! The scene of each cell of a sheet.

use std::collections::BTreeMap;

use crate::{
    figure::{
        scene_file::{self, Options, SceneFileError},
        sheet::{CellFigure, Setting, Sheet},
    },
    lens::nearest::did_you_mean,
    scene::{PiecePlace, PoiPlace, Scene},
};

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Names of its row and column, joined by a dash: part of its file's name.
    pub name: String,
    /// Which row.
    pub row: usize,
    /// Which column.
    pub column: usize,
    /// What stands below it.
    pub caption: Option<String>,
    /// What it shows: without title, caption and legend, which are the sheet's, and the signs of a map.
    pub scene: Scene,
    /// Id of the object whose share is told, where that is asked for.
    pub poi: Option<String>,
}

/// The cells of a sheet over a scene, row by row. Changes come in the order: of all, of the row, of the column, of the cell.
/// `name` stands for the sheet file in messages; paths in changes are read with `options`, those of the scene's file.
///
/// # Errors
/// All changes that cannot be made, each once, with the first cell that it cannot be made in.
pub fn cells(sheet: &Sheet, base: &Scene, name: &str, options: &Options) -> Result<Vec<Cell>, SceneFileError> {
    let [rows, columns] = sheet.grid();
    let mut found = Vec::with_capacity(rows * columns);
    let mut problems: BTreeMap<(u32, String), String> = BTreeMap::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let (of_row, of_column) = (sheet.rows.get(row), sheet.columns.get(column));
        let note = sheet.notes.iter().find(|note| (note.row, note.column) == (row, column));
        let names: Vec<&str> = of_row.iter().chain(&of_column).map(|one| one.name.as_str()).collect();
        let cell_name = if names.is_empty() { "1".to_owned() } else { names.join("-") };
        let of_row = of_row.map_or(&[][..], |one| &one.settings);
        let of_column = of_column.map_or(&[][..], |one| &one.settings);
        let of_cell = note.map_or(&[][..], |note| &note.settings);
        let mut scene = base.clone();
        let mut is_right = true;
        for setting in sheet.settings.iter().chain(of_row).chain(of_column).chain(of_cell) {
            match scene_file::set_within(&scene, &setting.assignment, options) {
                Ok(command) => command.redo(&mut scene),
                Err(error) => {
                    is_right = false;
                    let key = (setting.line, setting.place.clone());
                    problems.entry(key).or_insert_with(|| problem_line(setting, &error, &cell_name));
                    break;
                }
            }
        }
        if !is_right {
            continue;
        }
        scene.figure.samples = sheet.samples.or(scene.figure.samples);
        let figure = &mut scene.figure;
        [figure.legend, figure.scale_bar, figure.north_arrow] = [PiecePlace::None; 3];
        (scene.figure.title, scene.figure.caption, scene.animation) = (None, None, None);
        let poi = match sheet.figures.contains(&CellFigure::VisibleShare).then(|| poi_of(sheet, &scene)) {
            None => None,
            Some(Ok(id)) => Some(id),
            Some(Err(message)) => {
                problems.entry((0, "poi".into())).or_insert_with(|| format!("poi: {message} (cell {cell_name})"));
                continue;
            }
        };
        let caption = note.and_then(|note| note.caption.clone());
        found.push(Cell { name: cell_name, row, column, caption, scene, poi });
    }
    let mut names: BTreeMap<&str, &Cell> = BTreeMap::new();
    for cell in &found {
        if names.insert(&cell.name, cell).is_some() {
            let message =
                format!("two cells would be written as {}; other names of rows or columns would be right", cell.name);
            problems.insert((0, cell.name.clone()), message);
        }
    }
    if problems.is_empty() {
        return Ok(found);
    }
    let problem =
        |((line, _), message)| scene_file::Problem { line, table: String::new(), key: String::new(), message };
    let problems = problems.into_iter().map(problem).collect();
    Err(SceneFileError { name: name.into(), problems, has_lines: true, is_data_absent: false })
}

/// What is wrong with a change, as one line.
fn problem_line(setting: &Setting, error: &SceneFileError, cell: &str) -> String {
    let all: Vec<String> = error.problems.iter().map(ToString::to_string).collect();
    format!("{} {:?}: {} (cell {cell})", setting.place, setting.assignment, all.join("; "))
}

/// The object whose share is told.
fn poi_of(sheet: &Sheet, scene: &Scene) -> Result<String, String> {
    let id = |place: &PoiPlace| match place {
        PoiPlace::Object(id) => Some(id.clone()),
        PoiPlace::At(_) | PoiPlace::AboveGround(_) | PoiPlace::On(_) => None,
    };
    let Some(name) = &sheet.poi else {
        return scene.pois.iter().find_map(|poi| id(&poi.place)).ok_or_else(|| {
            "the scene has no point of interest that is an object, whose visible-share could be told; [[poi]] object = \"ID\" \
             would be right"
                .to_owned()
        });
    };
    match scene.pois.iter().find(|poi| poi.name == *name) {
        Some(poi) => id(&poi.place).ok_or_else(|| {
            format!("\"{name}\" is a point, of which there is no visible-share; one with an object would be right")
        }),
        None => {
            let hint = did_you_mean(name, scene.pois.iter().map(|poi| poi.name.as_str()));
            Err(format!("the scene has no point of interest \"{name}\"{hint}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        figure::{scene_file::Options, sheet::file},
        geom::Shape,
        lens::Region,
    };

    const SCENE: &str = r#"
veduta = 1
city.files = ["builtin:square"]
figure = { title = "T", legend = "auto", samples = 3 }
animation = { frames = 2 }
[[poi]]
name = "well"
at = [0, 0, 0]
[[poi]]
name = "hall"
object = "town-hall"
[[lens]]
name = "a"
shape = { kind = "sphere", center = [0, 0, 0], radius = 60.0 }
"#;

    fn made(text: &str) -> Result<Vec<Cell>, String> {
        let base = scene_file::parse(SCENE, "scene", &Options::for_command_line()).unwrap();
        let sheet = file::parse(&format!("veduta_sheet = 1\nscene = \"a\"\n{text}"), "s").unwrap();
        cells(&sheet, &base, "s", &Options::for_command_line()).map_err(|error| error.to_string())
    }

    fn radius(cell: &Cell) -> f64 {
        match cell.scene.lenses[0].shapes[0] {
            Region::Shape(Shape::Sphere { radius, .. }) => radius,
            _ => f64::NAN,
        }
    }

    #[test]
    fn changes_of_row_and_column_both_apply_and_the_cell_has_the_last_word() {
        let all = made(
            r#"
set = ["lens.a.shape.radius=1", "style.base=clay"]
samples = 9
row = [{ name = "r" }, { set = ["lens.a.shape.radius=2", "sun.shadows=false"] }]
column = [{ name = "c" }, { name = "d", set = ["lens.a.shape.radius=3"] }]
cell = [{ row = "r", column = "d", caption = "C", set = ["lens.a.shape.radius=4"] }]
"#,
        )
        .unwrap();
        let said: Vec<_> = all.iter().map(|cell| (cell.name.as_str(), radius(cell), cell.scene.sun.shadows)).collect();
        assert_eq!(said, [("r-c", 1.0, true), ("r-d", 4.0, true), ("2-c", 2.0, false), ("2-d", 3.0, false)]);
        assert_eq!(all[1].caption.as_deref(), Some("C"));
        for cell in &all {
            let figure = &cell.scene.figure;
            assert_eq!((figure.samples, &figure.title, figure.legend), (Some(9), &None, PiecePlace::None));
            assert_eq!((&cell.scene.animation, &cell.poi), (&None, &None));
        }
        assert_eq!(made("").unwrap()[0].name, "1");
        assert_eq!(made("figures = [\"visible-share\"]").unwrap()[0].poi.as_deref(), Some("town-hall"));
    }

    #[test]
    fn mistakes_name_their_cell() {
        for (text, expected) in [
            (
                "row = [{ name = \"r\" }, { set = [\"lens.a.shape.raduis=2\"] }]\ncolumn = [{}, {}]",
                "s:3: [row.1] set.0 \"lens.a.shape.raduis=2\": [lens.0] shape.raduis: unknown key; did you mean \"radius\"? (cell 2-1)",
            ),
            (
                "set = [\"lens.b.enabled=false\"]",
                "s:3: set.0 \"lens.b.enabled=false\": lens.b.enabled: there is no lens \"b\" (cell 1)",
            ),
            (
                "poi = \"hal\"\nfigures = [\"visible-share\"]",
                "s: poi: the scene has no point of interest \"hal\"; did you mean \"hall\"? (cell 1)",
            ),
            (
                "poi = \"well\"\nfigures = [\"visible-share\"]",
                "\"well\" is a point, of which there is no visible-share",
            ),
            (
                "row = [{ name = \"a\" }, { name = \"a-b\" }]\ncolumn = [{ name = \"b-c\" }, { name = \"c\" }]",
                "s: two cells would be written as a-b-c; other names",
            ),
        ] {
            let message = made(text).unwrap_err();
            assert!(message.contains(expected) && message.lines().count() == 1, "{text}: {message}");
        }
    }
}
