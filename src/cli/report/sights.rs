//! Best views and landmarks, for people.

use std::fmt::Write;

use super::{Report, number};
use crate::cli::{
    info::{LandmarkFacts, ViewFacts},
    report::cells::{Align, Table, clean, cut, length},
};

/// The winds, clockwise from north.
const WINDS: [&str; 16] =
    ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

impl Report {
    /// The views of an object, and the camera of the first as scene files have it.
    pub(super) fn best_views(&mut self, views: &[ViewFacts]) {
        let Some(first) = views.first() else { return };
        self.gap();
        let columns = [("", Align::Right), ("from", Align::Left), ("above", Align::Right)];
        let shares = [("visible", Align::Right), ("unoccluded", Align::Right), ("score", Align::Right)];
        let mut table = Table::new(&[&columns[..], &shares, &[("eye", Align::Left)]].concat());
        for (i, view) in views.iter().enumerate() {
            table.row([
                (i + 1).to_string(),
                from(view),
                format!("{:.0}°", view.elevation_deg),
                format!("{:.0} %", 100.0 * view.visible),
                format!("{:.0} %", 100.0 * view.unoccluded),
                format!("{:.3}", view.score),
                place(view.eye),
            ]);
        }
        self.table("Views", &table);
        self.line("", &self.paint.faint("the first as the camera of a scene:"));
        // For copying: from the left border.
        let _ = writeln!(self.out, "[camera]\neye = {}\ntarget = {}", place(first.eye), place(first.target));
        if first.up != [0.0, 0.0, 1.0] {
            let _ = writeln!(self.out, "up = {:?}", first.up);
        }
        let _ = writeln!(self.out, "fov_deg = {}", number(first.fov_deg));
    }

    /// The landmarks.
    pub(super) fn landmarks(&mut self, landmarks: &[LandmarkFacts]) {
        self.gap();
        if landmarks.is_empty() {
            return self.line("Landmarks", "none: nothing stands in this city");
        }
        let columns = [("", Align::Right), ("id", Align::Left), ("score", Align::Right), ("high", Align::Right)];
        let others = [("around", Align::Right), ("covers", Align::Right), ("next as high", Align::Right)];
        let mut table = Table::new(&[&columns[..], &others, &[("name", Align::Left)]].concat());
        for (i, landmark) in landmarks.iter().enumerate() {
            table.row([
                (i + 1).to_string(),
                clean(&landmark.id),
                format!("{:.3}", landmark.score),
                length(landmark.height_m),
                length(landmark.neighbours_m),
                format!("{:.0} m²{}", landmark.footprint_m2, if landmark.footprint_is_hull { " (hull)" } else { "" }),
                landmark.isolation_m.map_or("none".to_owned(), length),
                cut(&clean(landmark.name.as_deref().unwrap_or("")), 40),
            ]);
        }
        // Ids are for copying: they are not cut.
        let lines = table.lines(self.paint, usize::MAX);
        for (i, line) in lines.iter().enumerate() {
            self.line(if i == 0 { "Landmarks" } else { "" }, line);
        }
    }
}

/// The wind that blows from where the eye is, with its direction.
fn from(view: &ViewFacts) -> String {
    if view.elevation_deg > 89.9 {
        return "straight above".to_owned();
    }
    let wind = WINDS[(view.azimuth_deg / 22.5).round() as usize % WINDS.len()];
    format!("{wind} {:.0}°", view.azimuth_deg)
}

/// A place as scene files have it, to the centimetre.
fn place(p: [f64; 3]) -> String {
    format!("[{:.2}, {:.2}, {:.2}]", p[0], p[1], p[2])
}
