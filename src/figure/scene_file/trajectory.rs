//! `[[trajectory]]` and `[time]` in scene files: their keys, read and written.

use glam::DVec3;

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        keys::{FAR_M, Kind, Table, key},
        node::Node,
        parse::lens_color,
        write::{list, number, point, quoted, write_color},
    },
    scene::trajectory::{Pace, Trajectory},
    view::path::Form,
};

/// Earliest and latest moment, seconds.
const MOMENTS_S: f64 = 1e6;
/// Slowest speed, metres per second.
const SLOWEST: f64 = 1e-6;

/// `[time]`.
pub const TIME: Table = Table {
    name: "time",
    doc: "Which moment is shown; see Moving points.",
    keys: &[key(
        "at_s",
        Kind::Number { min: -MOMENTS_S, max: MOMENTS_S },
        "0.0",
        "s",
        "The moment that pictures show, and that an animation begins with: frame i shows this and i / `fps` seconds.",
        "12.5",
    )],
};

/// `[[trajectory]]`.
pub const TRAJECTORY: Table = Table {
    name: "trajectory",
    doc: "A way that points of interest move along; exactly one of `speed_m_s` and `times_s`. See Moving points.",
    keys: &[
        key("name", Kind::Text, "`trajectory-N`, N its place in the file", "", "Its name, unique.", "\"tram 1\""),
        key("points", Kind::Points(2), "", "m", "What it goes through.", "[[0, 0, 2], [80, 0, 2], [80, 60, 2]]"),
        key(
            "speed_m_s",
            Kind::Number { min: SLOWEST, max: FAR_M },
            "by `times_s`",
            "m/s",
            "How fast it goes its way.",
            "8.0",
        ),
        key(
            "times_s",
            Kind::Times(2),
            "by `speed_m_s`",
            "s",
            "When it is at each of `points`, counted from `start_s`; of a closed way one more, when it is back at the first. From point to \
             point it goes at one speed; where the way is `smooth` its speed has no steps either.",
            "[0.0, 10.0, 16.0]",
        ),
        key(
            "start_s",
            Kind::Number { min: -MOMENTS_S, max: MOMENTS_S },
            "0.0",
            "s",
            "When it sets out; before that it stands at its first point.",
            "-30.0",
        ),
        key(
            "closed",
            Kind::Boolean,
            "false",
            "",
            "Whether it goes on from the last point to the first, round and round. Else it stands at the last point when it has arrived.",
            "true",
        ),
        key(
            "smooth",
            Kind::Boolean,
            "false",
            "",
            "Whether it goes through the points on a centripetal Catmull-Rom curve, as cameras of animations do; else straight from point \
             to point.",
            "true",
        ),
        key(
            "color",
            Kind::Color,
            "a categorical colour, by its place",
            "",
            "Of its marker and its trace.",
            "\"#c2185b\"",
        ),
        key(
            "marker",
            Kind::Boolean,
            "true",
            "",
            "Whether a disc shows, in all views, where it is, and an arrow in it where it goes. Nothing hides it.",
            "false",
        ),
        key(
            "trace",
            Kind::Boolean,
            "false",
            "",
            "Whether a line shows its way, in all views: what it has gone, and paler what lies before it. Nothing hides it.",
            "true",
        ),
    ],
};

/// Reads a table; `None`, with a note, where it is no way.
pub fn read(checker: &mut Checker, fields: &Fields, index: usize) -> Option<Trajectory> {
    let points: Vec<DVec3> = fields.node("points")?.list()?.iter().filter_map(Node::numbers).map(DVec3::from).collect();
    let form = Form {
        is_closed: fields.boolean("closed").unwrap_or(false),
        is_smooth: fields.boolean("smooth").unwrap_or(false),
    };
    let times = fields.node("times_s").and_then(Node::list);
    let times: Option<Vec<f64>> = times.map(|list| list.iter().filter_map(Node::number).collect());
    let pace = match (fields.number("speed_m_s"), times) {
        (Some(speed), None) if !fields.given("times_s") => Pace::Speed(speed),
        (None, Some(times)) if !fields.given("speed_m_s") => {
            let wanted = points.len() + usize::from(form.is_closed);
            if times.len() != wanted {
                let why = match form.is_closed {
                    true => "one for each of the points, and when it is back at the first",
                    false => "one for each of the points",
                };
                let message = format!("must be {wanted} times, {why}, is {}", times.len());
                checker.note(&fields.place, "times_s", fields.line("times_s"), message);
                return None;
            }
            Pace::Times(times)
        }
        (None, None) if fields.given("speed_m_s") || fields.given("times_s") => return None,
        (None, None) => {
            let message = "is missing: give speed_m_s = 8.0 or times_s = [0.0, 10.0, ...]";
            checker.note(&fields.place, "speed_m_s", fields.place.line, message);
            return None;
        }
        _ => {
            let message = "is given together with speed_m_s: one of them would be right";
            checker.note(&fields.place, "times_s", fields.line("times_s"), message);
            return None;
        }
    };
    Some(Trajectory {
        name: fields.text("name").map_or_else(|| format!("trajectory-{index}"), str::to_owned),
        points,
        pace,
        form,
        start_s: fields.number("start_s").unwrap_or(0.0),
        color: fields.color("color").unwrap_or_else(|| lens_color(index)),
        marker: fields.boolean("marker").unwrap_or(true),
        trace: fields.boolean("trace").unwrap_or(false),
    })
}

/// The keys of a table, as TOML.
pub(super) fn written(index: usize, way: &Trajectory) -> Vec<(&'static str, String)> {
    let mut keys = vec![("name", quoted(&way.name)), ("points", list(way.points.iter().map(|p| point(*p))))];
    keys.push(match &way.pace {
        Pace::Speed(speed) => ("speed_m_s", number(*speed)),
        Pace::Times(times) => ("times_s", list(times.iter().map(|time| number(*time)))),
    });
    if way.start_s != 0.0 {
        keys.push(("start_s", number(way.start_s)));
    }
    if way.color != lens_color(index) {
        keys.push(("color", write_color(way.color)));
    }
    let flags = [
        ("closed", way.form.is_closed, false),
        ("smooth", way.form.is_smooth, false),
        ("marker", way.marker, true),
        ("trace", way.trace, false),
    ];
    keys.extend(flags.into_iter().filter(|(_, is, default)| is != default).map(|(key, is, _)| (key, is.to_string())));
    keys
}
