//! `[[trajectory]]` and `[time]` in scene files: their keys, read and written.

use crate::{
    figure::scene_file::{
        check::Fields,
        epoch,
        forms::{Color, Form as _, Same, lens_color},
        keys::{FAR_M, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    scene::{
        Scene,
        trajectory::{Pace, Trajectory},
    },
    view::path::Form,
};

/// Earliest and latest moment, seconds.
const MOMENTS_S: f64 = 1e6;
/// Slowest speed, metres per second.
const SLOWEST: f64 = 1e-6;

/// `[time]`.
pub const TIME: Table =
    Table { name: "time", doc: "Which moment is shown; see Time, and Moving points.", keys: keys_of!(TIME_ROWS) };

/// Its rows.
pub const TIME_ROWS: &[Row<Scene>] = &[
    field!(
        key(
            "at",
            Kind::Moment,
            "none: all objects are there",
            "",
            "The moment of the calendar that pictures show: a year, a date or a date-time, of which the beginning counts. Objects are there from their first moment up to their last, which is not of it. See Time.",
            "\"1890\"",
        ),
        Same,
        |scene: Scene| scene.moment
    ),
    Row::<Scene>::new(
        key(
            "steps",
            Kind::Operators,
            "none",
            "",
            "Time operators that make of `at` what shows where no lens shows another moment: as a lens' `time` has them.",
            "[{ op = \"ghost\", past = \"50 years\" }]",
        ),
        |scene, _| epoch::written(&scene.time_steps),
        |scene, given| scene.time_steps = epoch::read(given.reader, given.fields, "steps"),
    ),
    field!(
        key(
            "at_s",
            Kind::Number { min: -MOMENTS_S, max: MOMENTS_S },
            "0.0",
            "s",
            "The second of the scene's own clock that pictures show, and that an animation begins with: frame i shows this and i / `fps` seconds.",
            "12.5",
        ),
        Same,
        |scene: Scene| scene.time_s
    ),
];

/// `[[trajectory]]`.
pub const TRAJECTORY: Table = Table {
    name: "trajectory",
    doc: "A way that points of interest move along; exactly one of `speed_m_s` and `times_s`. See Moving points.",
    keys: keys_of!(TRAJECTORY_ROWS),
};

const TRAJECTORY_ROWS: &[Row<Trajectory>] = &[
    field!(
        key("name", Kind::Text, "`trajectory-N`, N its place in the file", "", "Its name, unique.", "\"tram 1\""),
        Same,
        |way: Trajectory| way.name
    )
    .always(),
    field!(
        key("points", Kind::Points(2), "", "m", "What it goes through.", "[[0, 0, 2], [80, 0, 2], [80, 60, 2]]"),
        Same,
        |way: Trajectory| way.points
    ),
    field!(
        key(
            "above_ground",
            Kind::Boolean,
            "false",
            "",
            "Whether the heights of `points` are metres above the ground, which it follows between them, too; see Heights above the ground.",
            "true",
        ),
        Same,
        |way: Trajectory| way.above_ground
    ),
    Row::<Trajectory>::joint(
        key(
            "speed_m_s",
            Kind::Number { min: SLOWEST, max: FAR_M },
            "by `times_s`",
            "m/s",
            "How fast it goes its way.",
            "8.0",
        ),
        |way, _| match way.pace {
            Pace::Speed(speed) => Some(speed.into()),
            Pace::Times(_) => None,
        },
    )
    .always(),
    Row::<Trajectory>::joint(
        key(
            "times_s",
            Kind::Times(2),
            "by `speed_m_s`",
            "s",
            "When it is at each of `points`, counted from `start_s`; of a closed way one more, when it is back at the first. From point to \
             point it goes at one speed; where the way is `smooth` its speed has no steps either.",
            "[0.0, 10.0, 16.0]",
        ),
        |way, _| match &way.pace {
            Pace::Times(times) => Same::data(times),
            Pace::Speed(_) => None,
        },
    )
    .always(),
    field!(
        key(
            "start_s",
            Kind::Number { min: -MOMENTS_S, max: MOMENTS_S },
            "0.0",
            "s",
            "When it sets out; before that it stands at its first point.",
            "-30.0",
        ),
        Same,
        |way: Trajectory| way.start_s
    ),
    field!(
        key("closed", Kind::Boolean, "false", "", "Whether it goes on from the last point to the first, round and round. Else it stands at the last point when it has arrived.", "true",),
        Same,
        |way: Trajectory| way.form.is_closed
    ),
    field!(
        key("smooth", Kind::Boolean, "false", "", "Whether it goes through the points on a centripetal Catmull-Rom curve, as cameras of animations do; else straight from point \
             to point.", "true",),
        Same,
        |way: Trajectory| way.form.is_smooth
    ),
    field!(
        key(
            "color",
            Kind::Color,
            "a categorical colour, by its place",
            "",
            "Of its marker and its trace.",
            "\"#c2185b\"",
        ),
        Color,
        |way: Trajectory| way.color
    )
    .after("start_s"),
    field!(
        key("marker", Kind::Boolean, "true", "", "Whether a disc shows, in all views, where it is, and an arrow in it where it goes. Nothing hides it.", "false",),
        Same,
        |way: Trajectory| way.marker
    ),
    field!(
        key("trace", Kind::Boolean, "false", "", "Whether a line shows its way, in all views: what it has gone, and paler what lies before it. Nothing hides it.", "true",),
        Same,
        |way: Trajectory| way.trace
    ),
];

/// A way that says nothing but its points.
fn plain(index: usize) -> Trajectory {
    Trajectory {
        name: format!("trajectory-{index}"),
        points: Vec::new(),
        pace: Pace::Speed(0.0),
        form: Form { is_closed: false, is_smooth: false },
        above_ground: false,
        start_s: 0.0,
        color: lens_color(index),
        marker: true,
        trace: false,
    }
}

/// Reads a table; `None`, with a note, where it is no way.
pub fn read(reader: &mut Reader, fields: &Fields, index: usize) -> Option<Trajectory> {
    let mut way = plain(index);
    if !row::read(TRAJECTORY_ROWS, fields, reader, &mut way) {
        return None;
    }
    way.pace = pace(reader, fields, &way)?;
    Some(way)
}

/// How fast it goes its way: exactly one of two keys says it.
fn pace(reader: &mut Reader, fields: &Fields, way: &Trajectory) -> Option<Pace> {
    let times = fields.node("times_s").and_then(Node::list);
    let times: Option<Vec<f64>> = times.map(|list| list.iter().filter_map(Node::number).collect());
    let (key, line, message) = match (fields.number("speed_m_s"), times) {
        (Some(speed), None) if !fields.given("times_s") => return Some(Pace::Speed(speed)),
        (None, Some(times)) if !fields.given("speed_m_s") => {
            let wanted = way.points.len() + usize::from(way.form.is_closed);
            if times.len() == wanted {
                return Some(Pace::Times(times));
            }
            let why = match way.form.is_closed {
                true => "one for each of the points, and when it is back at the first",
                false => "one for each of the points",
            };
            ("times_s", fields.line("times_s"), format!("must be {wanted} times, {why}, is {}", times.len()))
        }
        (None, None) if fields.given("speed_m_s") || fields.given("times_s") => return None,
        (None, None) => {
            let message = "is missing: give speed_m_s = 8.0 or times_s = [0.0, 10.0, ...]";
            ("speed_m_s", fields.place.line, message.to_owned())
        }
        _ => {
            let message = "is given together with speed_m_s: one of them would be right";
            ("times_s", fields.line("times_s"), message.to_owned())
        }
    };
    reader.checker.note(&fields.place, key, line, message);
    None
}

/// The table of a way.
pub fn written(index: usize, way: &Trajectory, options: &Options) -> Data {
    row::written(TRAJECTORY_ROWS, way, &plain(index), options)
}
