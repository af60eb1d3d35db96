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
    if scale <= 0.0 || !place.is_finite() || !yaw.is_finite() || !scale.is_finite() {
        return Err(format!("scale must be more than 0, is {scale}"));
    }
    Ok(Keyframe { at, place, yaw, scale })
}

/// The beginning of what a text says.
fn moment(text: &str) -> Result<Moment, String> {
    Interval::parse(text)?.begin.ok_or_else(|| format!("\"{text}\" has no beginning"))
}
