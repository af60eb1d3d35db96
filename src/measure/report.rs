//! A measurement written down: a table to read and JSON to go on with.

use std::fmt::Write as _;

use serde_json::{Value as Json, json};

use crate::measure::{
    difference::RIGHT_STEPS,
    quantity::Quantity,
    ratio::Estimate,
    run::{Measurement, Row},
    topic::Slope,
};

/// Where and how a measurement was made, as far as only the caller knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// The command line, shell-ready.
    pub command: String,
    /// The city's files, as they were named.
    pub city: Vec<String>,
    /// The day, `2026-11-21`.
    pub date: String,
}

/// The version of the JSON's layout; it grows when a key changes its meaning or goes.
pub const SCHEMA: u32 = 1;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The build profile of this program: times of a debug build say little.
const PROFILE: &str = if cfg!(debug_assertions) { "debug" } else { "release" };

/// The table, in Markdown.
pub fn markdown(measured: &Measurement, origin: &Origin) -> String {
    let topic = measured.topic;
    let [width, height] = measured.size;
    let sources = match topic.sources {
        [] => String::new(),
        sources => format!(" ({})", sources.join(", ")),
    };
    let mut text = format!("# {}\n\n{}{sources}\n\n", topic.title, topic.about);
    let facts = [
        ("Command", format!("`{}`", origin.command.replace('`', "'"))),
        ("Program", format!("Veduta {VERSION} ({PROFILE} build), {}", origin.date)),
        ("Adapter", format!("{} ({}, {})", measured.adapter.name, measured.adapter.backend, measured.adapter.kind)),
        (
            "City",
            format!(
                "{}: {} objects, {} triangles, {} MiB of graphics memory",
                origin.city.join(", "),
                measured.objects,
                measured.triangles,
                number(measured.city_bytes as f64 / f64::from(1 << 20))
            ),
        ),
        ("Picture", format!("{width} × {height} pixels")),
        ("Reference", topic.reference.to_owned()),
        (
            "Plain frame",
            format!(
                "clay, no shadows, no lens, one sample: {} ms ({})",
                number(measured.plain_ms.median),
                interval(measured.plain_ms)
            ),
        ),
        ("Plot", format!("[{0}.svg]({0}.svg), [{0}.png]({0}.png)", topic.name)),
    ];
    for (name, fact) in facts {
        let _ = writeln!(text, "- {name}: {fact}");
    }
    for (name, slope) in slopes(measured) {
        let _ = writeln!(text, "- Slope{name}: {slope}");
    }
    text += "\n";
    let columns = columns(measured);
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    text += &line(&columns.iter().map(|c| c.0.clone()).collect::<Vec<_>>());
    text += &line(&columns.iter().map(|c| if c.2 { "---" } else { "---:" }.to_owned()).collect::<Vec<_>>());
    for row in &measured.rows {
        text += &line(&columns.iter().map(|c| (c.1)(row)).collect::<Vec<_>>());
    }
    let front = topic.front.map(|q| q.title(topic.knobs)).join(" and ");
    let start = match topic.restarts {
        true => format!(
            "Start-up is what the first frame on a fresh device takes longer than a later one (median of {}); memory is what that \
             frame allocates on the graphics card beside the city.",
            measured.starts
        ),
        false => "Memory is what the targets and lists of a frame take on the graphics card.".to_owned(),
    };
    let against = match measured.rows.iter().any(|row| row.difference.against_f64.is_some()) {
        true if topic.slope.is_some() => {
            " Errors against f64 are of linear light; the picture's own steps are up to 0.009 of it."
        }
        true => {
            " Errors against f64 are of what lies over the opaque picture, over any background from black to white, linear light."
        }
        false => "",
    };
    let _ = write!(
        text,
        "\n**●** Pareto front: no other variant is at least as good in {front} and better in one of them.\n\n\
         Times are medians of {} rounds in which all variants were drawn in turn, with 95 % intervals; the ratio is taken \
         round by round against the plain frame. A pixel is wrong when a channel is off by more than {RIGHT_STEPS} of 255 \
         steps. {start}{against} `docs/measure.md` says more.\n",
        measured.pairs,
    );
    text
}

/// With which power of a knob an error falls, for each line of each panel of the plot: least squares of the logarithms.
fn slopes(measured: &Measurement) -> Vec<(String, String)> {
    let topic = measured.topic;
    let Some(Slope { knob, error, above }) = topic.slope else { return Vec::new() };
    let mut lines: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
    for row in &measured.rows {
        let told = topic.panels.iter().chain(topic.series).filter_map(|i| row.knobs.get(*i));
        let names: Vec<String> = told.map(|v| format!(", {v}")).collect();
        let values = [Quantity::Knob(knob).of(row), error.of(row)];
        let point = values.map(f64::ln);
        if !point.iter().all(|v| v.is_finite()) || values[0] <= above {
            continue;
        }
        match lines.iter_mut().find(|(name, _)| *name == names.concat()) {
            Some((_, points)) => points.push(point),
            None => lines.push((names.concat(), vec![point])),
        }
    }
    let power = |points: &[[f64; 2]]| {
        let n = points.len() as f64;
        let [x, y] = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
        let both: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
        both / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>()
    };
    let text = |points: &[[f64; 2]]| {
        let title = Quantity::Knob(knob).title(topic.knobs);
        format!("the {} goes with {title} to the power of {:.2}", error.title(topic.knobs), power(points))
    };
    lines.into_iter().filter(|(_, points)| points.len() > 1).map(|(name, points)| (name, text(&points))).collect()
}

/// Heading, cell, whether it is text.
type Column = (String, Box<dyn Fn(&Row) -> String>, bool);

fn columns(measured: &Measurement) -> Vec<Column> {
    let knobs = measured.topic.knobs;
    let figure = |heading: &str, quantity: Quantity| -> Column {
        (heading.to_owned(), Box::new(move |row: &Row| number(quantity.of(row))), false)
    };
    let estimate = |heading: &str, quantity: Quantity| -> Column {
        let cell = move |row: &Row| {
            quantity.estimate(row).map_or_else(String::new, |e| format!("{} ({})", number(e.median), interval(e)))
        };
        (heading.to_owned(), Box::new(cell), false)
    };
    let mut columns: Vec<Column> = vec![
        ("".into(), Box::new(|row: &Row| if row.is_pareto { "**●**" } else { "" }.into()), true),
        ("variant".into(), Box::new(|row: &Row| row.label.replace('|', "\\|")), true),
    ];
    for i in 0..knobs.len() {
        let cell = move |row: &Row| row.knobs.get(i).map_or_else(String::new, |v| v.to_string().replace('|', "\\|"));
        columns.push((Quantity::Knob(i).title(knobs), Box::new(cell), false));
    }
    columns.push(figure("wrong pixels, %", Quantity::WrongPixels));
    if measured.rows.iter().any(|row| row.difference.wrong_mask_pixels.is_some()) {
        columns.push(figure("wrong lens mask, %", Quantity::WrongMask));
    }
    columns.push(("max, steps".into(), Box::new(|row: &Row| row.difference.max_steps.to_string()), false));
    columns.push(figure("mean, steps", Quantity::MeanSteps));
    columns.push(figure("FLIP", Quantity::Flip));
    if measured.rows.iter().any(|row| row.difference.against_f64.is_some()) {
        for (heading, quantity) in
            [("max, f64", Quantity::MaxError), ("mean, f64", Quantity::MeanError), ("rms, f64", Quantity::RmsError)]
        {
            columns.push((heading.to_owned(), Box::new(move |row: &Row| small(quantity.of(row))), false));
        }
    }
    if measured.rows.iter().any(|row| row.refined.is_some()) {
        columns.push(figure("triangles", Quantity::Triangles));
        columns.push(figure("chord, median px", Quantity::MedianChord));
        columns.push(figure("chord, largest px", Quantity::Chord));
    }
    columns.push(estimate("time, ms", Quantity::Ms));
    columns.push(estimate("time / plain frame", Quantity::Ratio));
    if measured.topic.restarts {
        columns.push(figure("start-up, ms", Quantity::StartMs));
    }
    columns.push(figure("memory, MiB", Quantity::Memory));
    columns
}

/// Three significant digits, no exponent; empty for no number.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    // 10.0 stays: its zero was measured. 0.000000 was not.
    if text.trim_start_matches('-').bytes().all(|b| b == b'0' || b == b'.') { "< 0.000001".to_owned() } else { text }
}

/// Two significant digits, whatever the size.
fn small(value: f64) -> String {
    if value == 0.0 || !value.is_finite() { number(value) } else { format!("{value:.1e}") }
}

fn interval(estimate: Estimate) -> String {
    format!("{}..{}", number(estimate.low), number(estimate.high))
}

/// All of it, as JSON.
pub fn json(measured: &Measurement, origin: &Origin) -> Json {
    let topic = measured.topic;
    let titles = |quantities: &[Quantity]| quantities.iter().map(|q| q.title(topic.knobs)).collect::<Vec<_>>();
    let row = |row: &Row| {
        let knobs: serde_json::Map<String, Json> =
            topic.knobs.iter().zip(&row.knobs).map(|(knob, value)| (knob.name.to_owned(), json!(value))).collect();
        json!({
            "label": row.label,
            "knobs": knobs,
            "difference": row.difference,
            "ms": row.ms,
            "ratio": row.ratio,
            "start_ms": row.start_ms,
            "gpu_bytes": row.gpu_bytes,
            "is_pareto": row.is_pareto,
        })
    };
    json!({
        "schema": SCHEMA,
        "program": format!("veduta {VERSION}"),
        "profile": PROFILE,
        "command": origin.command,
        "date": origin.date,
        "topic": {
            "name": topic.name,
            "title": topic.title,
            "about": topic.about,
            "sources": topic.sources,
            "reference": topic.reference,
            "knobs": topic.knobs,
            "front": titles(&topic.front),
        },
        "adapter": measured.adapter,
        "city": {
            "files": origin.city,
            "objects": measured.objects,
            "triangles": measured.triangles,
            "gpu_bytes": measured.city_bytes,
        },
        "size": measured.size,
        "pairs": measured.pairs,
        "starts": measured.starts,
        "wrong_from_steps": RIGHT_STEPS + 1,
        "plain": { "ms": measured.plain_ms },
        "variants": measured.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

/// The day of a time since 1970, UTC, `2026-11-21`.
pub fn date(since_epoch: std::time::Duration) -> String {
    // H. Hinnant, chrono-compatible low-level date algorithms: civil_from_days; years begin in March.
    let days = since_epoch.as_secs() / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.012345, "0.0123"),
            (12.345, "12.3"),
            (1234.5, "1234"),
            (-0.5, "-0.500"),
            (1e-9, "< 0.000001"),
            (f64::NAN, ""),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn days() {
        for (seconds, day) in [
            (0, "1970-01-01"),
            (951_782_399, "2000-02-28"),
            (951_782_400, "2000-02-29"),
            (1_735_689_599, "2024-12-31"),
            (1_735_689_600, "2025-01-01"),
            (4_107_542_400, "2100-03-01"),
        ] {
            assert_eq!(date(Duration::from_secs(seconds)), day);
        }
    }
}
