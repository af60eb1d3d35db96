//! A probe's report to read.

use std::fmt::Write as _;

use crate::measure::{
    ratio::Estimate,
    report::number,
    topics::gpu::{
        pictures::STEPS,
        report::{Checked, Compared, Frames, PROFILE, Report, VERSION},
    },
};

/// The report, in Markdown.
pub fn markdown(report: &Report) -> String {
    let failures = report.failures();
    let adapter = &report.adapter;
    let mut text = "# What this GPU does\n\n".to_owned();
    if report.is_software {
        text += "**This is a software adapter: no GPU was probed. The answers are those of a program on the processor.**\n\n";
    }
    let facts = [
        ("Command", format!("`{}`", report.command.replace('`', "'"))),
        ("Program", format!("Veduta {VERSION} ({PROFILE} build), {}", report.date)),
        ("Adapter", format!("{} ({}, {})", adapter.name, adapter.backend, adapter.kind)),
        ("Driver", report.driver.clone()),
        ("Corners of triangles are moved by", snapping(report.snapping)),
        ("Time", format!("{:.0} s of {:.0} s", report.seconds[1], report.seconds[0])),
        ("Result", format!("{} of {} fail", failures.len(), report.count())),
    ];
    for (name, fact) in facts {
        let _ = writeln!(text, "- {name}: {fact}");
    }
    let _ = failures.iter().try_for_each(|failure| writeln!(text, "  - {failure}"));
    checks(&mut text, &report.checks);
    pictures(&mut text, &report.pictures);
    if let Some(timed) = &report.frames {
        frames(&mut text, timed);
    }
    if !report.skipped.is_empty() {
        text += "\n## Left out\n\n";
        for [what, why] in &report.skipped {
            let _ = writeln!(text, "- {what}: {why}");
        }
    }
    text
}

fn line(text: &mut String, cells: &[&str]) {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}

fn checks(text: &mut String, rows: &[Checked]) {
    if rows.is_empty() {
        return;
    }
    *text += "\n## Hard cases\n\n";
    line(text, &["check", "case", "property", "oracle", "result", "wrong", "of", "s"]);
    line(text, &["---", "---", "---", "---", "---", "---:", "---:", "---:"]);
    for row in rows {
        let result = if row.found.is_cut { format!("{}, cut short", row.verdict()) } else { row.verdict().to_owned() };
        let (wrong, of) = (row.found.wrong.to_string(), format!("{} {}", row.found.tried, row.check.unit));
        let seconds = format!("{:.1}", row.seconds);
        let check = row.check;
        line(text, &[check.name, check.case, check.property, check.oracle, &result, &wrong, &of, &seconds]);
    }
}

fn pictures(text: &mut String, rows: &[Compared]) {
    if rows.is_empty() {
        return;
    }
    *text += "\n## Pictures against those of the software adapter\n\n";
    let off = format!("off by more than {STEPS} of 255");
    line(text, &["scene", "result", &off, "allowed", "of pixels", "largest, steps", "s"]);
    line(text, &["---", "---", "---:", "---:", "---:", "---:", "---:"]);
    for row in rows {
        let result = if row.failure().is_none() { "alike" } else { "differs" };
        let [wrong, allowed, pixels] = [row.wrong, row.allowed, row.pixels].map(|n| n.to_string());
        let (steps, seconds) = (row.max_steps.to_string(), format!("{:.1}", row.seconds));
        line(text, &[&row.scene, result, &wrong, &allowed, &pixels, &steps, &seconds]);
    }
}

fn frames(text: &mut String, frames: &Frames) {
    let [width, height] = frames.size;
    let cut = if frames.is_cut { ", cut short" } else { "" };
    let _ = write!(
        text,
        "\n## Frames\n\n{}: {} triangles, {width} × {height} pixels; medians of {} rounds{cut} with 95 % intervals. V1 shows the \
         whole city, V2 a street. The plain frame is clay, without shadows and lenses, with one sample.\n\n",
        frames.city, frames.triangles, frames.rounds
    );
    line(text, &["frame", "what", "ms", "by the card's clock, ms", "time / plain frame"]);
    line(text, &["---", "---", "---:", "---:", "---:"]);
    let range = |e: Estimate| format!("{} ({}..{})", number(e.median), number(e.low), number(e.high));
    for row in &frames.rows {
        let by_gpu = row.gpu_ms.map(number).unwrap_or_default();
        line(text, &[&row.name, &row.about, &range(row.ms), &by_gpu, &range(row.ratio)]);
    }
}

/// How far corners are moved, for people.
fn snapping(pixels: f64) -> String {
    match pixels {
        0.0 => "nothing where depth is made of them".to_owned(),
        _ => format!("up to {pixels:.4} pixels"),
    }
}
