//! Timetables read: which objects move, and when they are where.

use std::path::Path;

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::{
    city::{
        join::{
            NAMED,
            table::{Cell, Cells, Table},
        },
        load::{error::LoadError, input},
        model::CityModel,
        timetable::{Keyframe, Keyframes, TimetableFacts},
    },
    time::{Interval, Moment},
};

/// The columns of a timetable beside `id`, and which may be missing.
const COLUMNS: [(&str, bool); 6] =
    [("t", false), ("x", false), ("y", false), ("z", false), ("yaw", true), ("scale", true)];
/// What a row has where a column says nothing: no turn, as large as it is.
const UNSAID: [f64; 2] = [0.0, 1.0];

impl CityModel {
    /// Reads a timetable, CSV or the properties of GeoJSON: `id`, `t`, `x`, `y`, `z` (metres, the coordinates of the city), and where they are
    /// there `yaw` (degrees counter-clockwise from east) and `scale`. What an earlier one says of an object no longer counts.
    ///
    /// # Errors
    /// A file that is no table, lacks a column, or has a row that says no moment or place.
    pub fn add_timetable(&mut self, file: &Path) -> Result<(), LoadError> {
        let bytes = input::read(file)?.bytes;
        let table = Table::new(file, &bytes, "id")?;
        let columns = columns_of(file, &table)?;
        let numbers: FxHashMap<String, u32> =
            self.objects.iter().map(|object| object.id.to_string()).zip(0..).collect();
        let mut facts = TimetableFacts {
            file: file.to_owned(),
            rows: 0,
            objects: 0,
            without_object: 0,
            first_without_object: Vec::new(),
            first: None,
            last: None,
        };
        let mut found: FxHashMap<u32, Vec<Keyframe>> = FxHashMap::default();
        let mut wrong: Option<LoadError> = None;
        table.each_row(|id, cells| {
            facts.rows += 1;
            match (keyframe(&columns, &cells), numbers.get(id)) {
                (Err(message), _) => {
                    let place = format!("row {} of {id}", facts.rows);
                    wrong.get_or_insert_with(|| LoadError::at(file, place, message));
                }
                (Ok(key), Some(object)) => found.entry(*object).or_default().push(key),
                (Ok(_), None) => {
                    facts.without_object += 1;
                    let is_new = !facts.first_without_object.iter().any(|known| known == id);
                    if is_new && facts.first_without_object.len() < NAMED {
                        facts.first_without_object.push(id.to_owned());
                    }
                }
            }
        })?;
        drop(numbers);
        if let Some(error) = wrong {
            return Err(error);
        }
        facts.objects = found.len() as u64;
        let moments = || found.values().flatten().map(|key| key.at);
        (facts.first, facts.last) = (moments().min().map(Moment::written), moments().max().map(Moment::written));
        self.moves.retain(|known| !found.contains_key(&known.object));
        self.moves.extend(found.into_iter().map(|(object, mut keys)| {
            keys.sort_by_key(|key| key.at);
            Keyframes { object, keys }
        }));
        self.moves.sort_by_key(|of| of.object);
        self.timetables.push(facts);
        Ok(())
    }
}

/// How far from the origin anything may be, metres.
const FARTHEST_M: f64 = 1e9;
/// The smallest scale.
const LEAST_SCALE: f64 = 1e-6;

/// Which of [`COLUMNS`] each column of a table is.
fn columns_of(file: &Path, table: &Table) -> Result<Vec<Option<usize>>, LoadError> {
    let known = |name: &String| COLUMNS.iter().position(|(column, _)| column == name);
    let columns: Vec<Option<usize>> = table.columns().iter().map(known).collect();
    let is_there = |at: usize| columns.contains(&Some(at));
    match (0..COLUMNS.len()).find(|&at| !COLUMNS[at].1 && !is_there(at)) {
        None => Ok(columns),
        Some(at) => Err(LoadError::new(
            file,
            format!(
                "a timetable has the columns id, t, x, y, z and, if need be, yaw and scale; \"{}\" is missing",
                COLUMNS[at].0
            ),
        )),
    }
}

/// The keyframe of a row; else what is wrong with it.
fn keyframe(columns: &[Option<usize>], cells: &Cells) -> Result<Keyframe, String> {
    let (mut at, mut values) = (None, [None, None, None, None, Some(UNSAID[0]), Some(UNSAID[1])]);
    let mut wrong = None;
    cells.each(|column, cell| {
        let Some(which) = columns.get(column).copied().flatten() else { return };
        let name = COLUMNS[which].0;
        match (which, cell) {
            (0, Cell::Text(text)) => at = moment(text).map_err(|message| wrong = Some(message)).ok(),
            (0, Cell::Integer(number)) => {
                at = moment(&number.to_string()).map_err(|message| wrong = Some(message)).ok()
            }
            (0, Cell::Number(number)) => at = moment(&number.to_string()).map_err(|message| wrong = Some(message)).ok(),
            (which, Cell::Integer(number)) if which > 0 => values[which] = Some(number as f64),
            (which, Cell::Number(number)) if which > 0 => values[which] = Some(number),
            _ if which > 0 => wrong = Some(format!("{name} must be a number")),
            _ => wrong = Some("t must be a time, as \"2025-06-01T05:00:00\"".to_owned()),
        }
    });
    if let Some(message) = wrong {
        return Err(message);
    }
    let at = at.ok_or("t is missing: a time, as \"2025-06-01T05:00:00\", would be right")?;
    let number = |which: usize| values[which].ok_or_else(|| format!("{} is missing", COLUMNS[which].0));
    let place = DVec3::new(number(1)?, number(2)?, number(3)?);
    let (yaw, scale) = (number(4)?.to_radians(), number(5)?);
    if place.abs().max_element() > FARTHEST_M || yaw.abs() > FARTHEST_M {
        return Err(format!("x, y, z and yaw must be at most {FARTHEST_M:e}"));
    }
    if !(LEAST_SCALE..=1.0 / LEAST_SCALE).contains(&scale) {
        return Err(format!("scale must be from {LEAST_SCALE:e} to {:e}, is {scale}", 1.0 / LEAST_SCALE));
    }
    Ok(Keyframe { at, place, yaw, scale })
}

/// The beginning of what a text says.
fn moment(text: &str) -> Result<Moment, String> {
    Interval::parse(text)?.begin.ok_or_else(|| format!("\"{text}\" has no beginning"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::test_city::{add_box, builder};

    /// What is wrong with a table, or the model with it.
    fn read(text: &str) -> Result<CityModel, String> {
        static MADE: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = MADE.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let file = std::env::temp_dir().join(format!("veduta-timetable-{}-{number}.csv", std::process::id()));
        std::fs::write(&file, text).expect("a temporary file");
        let mut builder = builder();
        add_box(&mut builder, "a", [0; 3], [1000; 3]);
        add_box(&mut builder, "b", [5000, 0, 0], [6000, 1000, 1000]);
        let mut model = builder.finish();
        let read = model.add_timetable(&file).map_err(|error| error.to_string());
        std::fs::remove_file(&file).expect("the temporary file");
        read.map(|()| model)
    }

    #[test]
    fn rows_become_keyframes_in_the_order_of_time() {
        let text = "yaw,t,id,x,y,z,note\n90,2025-06-01T08:00:10,b,1,2,3.5,x\n,2025-06-01T08:00,b,0,2,3,\n0,2025,c,0,0,0,\n0,2025,c,0,0,0,\n";
        let model = read(text).expect("a timetable");
        let [of] = &model.moves[..] else { panic!("one object: {:?}", model.moves) };
        assert_eq!((of.object, of.keys.len()), (model.find_object("b").expect("it"), 2));
        assert_eq!(of.keys[0].place, DVec3::new(0.0, 2.0, 3.0));
        assert_eq!((of.keys[1].yaw, of.keys[1].scale), (90_f64.to_radians(), 1.0));
        let facts = &model.timetables[0];
        assert_eq!((facts.rows, facts.objects, facts.without_object), (4, 1, 2));
        assert_eq!(facts.first_without_object, ["c"]);
        assert_eq!(facts.first.as_deref(), Some("2025-06-01T08:00"), "the first moment of an object that is there");
        assert_eq!(facts.last.as_deref(), Some("2025-06-01T08:00:10"));
    }

    #[test]
    fn what_is_no_timetable_is_told() {
        let wrong = |text: &str, expected: &str| {
            let message = read(text).err().unwrap_or_default();
            assert!(message.contains(expected), "{text:?} gave {message:?}, not {expected:?}");
        };
        wrong("", "is empty");
        wrong("id,t,x,y\na,2025,1,2\n", "\"z\" is missing");
        wrong("name,t,x,y,z\na,2025,1,2,3\n", "id");
        wrong("id,t,x,y,z\na,2025,1,2,3\na,soon,1,2,3\n", "row 2 of a");
        wrong("id,t,x,y,z\na,2025,1,,3\n", "y is missing");
        wrong("id,t,x,y,z\na,2025,1,far,3\n", "y must be a number");
        wrong("id,t,x,y,z\na,,1,2,3\n", "t is missing");
        wrong("id,t,x,y,z\na,2025,1e308,2,3\n", "x, y, z and yaw must be at most 1e9");
        wrong("id,t,x,y,z,scale\na,2025,1,2,3,0\n", "scale must be from 1e-6 to 1e6, is 0");
    }
}
