//! Messages for a person meanwhile: colours, log lines and progress, all on stderr, none of it in a pipe.

use std::{
    io::{IsTerminal, Write},
    time::Duration,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::{cli::arguments::GlobalArguments, text};

/// Writes one line to stderr; a stderr that is gone is no reason to stop.
pub fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

// --- colours ----------------------------------------------------------------------------------

/// Puts colours around text, or not.
#[derive(Clone, Copy, Debug)]
pub struct Paint {
    /// Whether to.
    pub on: bool,
}

impl Paint {
    /// Colours for stdout: on a terminal, unless `NO_COLOR` is set (to anything but nothing) or the terminal is dumb.
    pub fn for_stdout() -> Self {
        Self { on: std::io::stdout().is_terminal() && wanted() }
    }

    /// The same for stderr.
    pub fn for_stderr() -> Self {
        Self { on: std::io::stderr().is_terminal() && wanted() }
    }

    /// A heading.
    pub fn heading(self, text: &str) -> String {
        self.wrap("1;36", text)
    }

    /// A text that matters most.
    pub fn strong(self, text: &str) -> String {
        self.wrap("1", text)
    }

    /// A text that matters least.
    pub fn faint(self, text: &str) -> String {
        self.wrap("2", text)
    }

    /// Something to look at.
    pub fn warning(self, text: &str) -> String {
        self.wrap("33", text)
    }

    /// Something that failed.
    pub fn error(self, text: &str) -> String {
        self.wrap("1;31", text)
    }

    fn wrap(self, code: &str, text: &str) -> String {
        if self.on && !text.is_empty() { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }
}

fn wanted() -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !is_set("NO_COLOR") && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

// --- log --------------------------------------------------------------------------------------

struct StderrLog;

static LOG: StderrLog = StderrLog;

impl log::Log for StderrLog {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        // The GPU stack tells its life at `info`; ours is what `-v` asks for. What its shader compiler finds wrong comes back as
        // an error, and is told once. That a processor draws the window is no reason to worry: the panel of costs says what draws.
        let is_told_elsewhere =
            ["naga", "egui", "eframe", "winit"].iter().any(|own| metadata.target().starts_with(own));
        (metadata.level() <= log::Level::Warn && !is_told_elsewhere)
            || metadata.target().starts_with("veduta")
            || log::max_level() == log::LevelFilter::Trace
    }

    fn log(&self, record: &log::Record<'_>) {
        if self.enabled(record.metadata()) {
            let paint = Paint::for_stderr();
            let level = match record.level() {
                log::Level::Error => paint.error("error:"),
                log::Level::Warn => paint.warning("warning:"),
                log::Level::Info => paint.faint("info:"),
                log::Level::Debug => paint.faint("debug:"),
                log::Level::Trace => paint.faint("trace:"),
            };
            say(&format!("{level} {}", text::shown(&record.args().to_string())));
        }
    }

    fn flush(&self) {}
}

/// Log lines go to stderr from here on: warnings, with `-v` also what is going on, with `-q` errors only.
pub fn start_log(global: &GlobalArguments) {
    let level = match (global.quiet, global.verbose) {
        (true, _) => log::LevelFilter::Error,
        (_, 0) => log::LevelFilter::Warn,
        (_, 1) => log::LevelFilter::Info,
        (_, 2) => log::LevelFilter::Debug,
        _ => log::LevelFilter::Trace,
    };
    if log::set_logger(&LOG).is_ok() {
        log::set_max_level(level);
    }
}

/// A fault of the program itself is told in a line, unless `RUST_BACKTRACE` asks for all that led to it.
pub fn tell_faults_in_a_line() {
    if std::env::var_os("RUST_BACKTRACE").is_some_and(|value| value != "0") {
        return;
    }
    std::panic::set_hook(Box::new(|fault| {
        let place = fault.location().map(|at| format!(" ({}:{})", at.file(), at.line())).unwrap_or_default();
        let what = fault.payload_as_str().unwrap_or("unknown").lines().next().unwrap_or_default();
        log::error!("a fault of veduta{place}: {what}; RUST_BACKTRACE=1 tells more, for a report");
    }));
}

// --- progress ---------------------------------------------------------------------------------

/// The progress of long work; shown on a terminal only, and gone when done.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Work of `total` steps that are called `unit` (`buildings`).
    pub fn counting(total: u64, what: &str, unit: &str, global: &GlobalArguments) -> Self {
        let template = format!("{{msg}} {{wide_bar}} {{pos}}/{{len}} {unit}, {{eta}} left");
        Self::start(ProgressBar::with_draw_target(Some(total), target(global)), &template, what)
    }

    /// Work of unknown length.
    pub fn spinning(what: &str, global: &GlobalArguments) -> Self {
        let progress =
            Self::start(ProgressBar::with_draw_target(None, target(global)), "{spinner} {msg} {elapsed}", what);
        progress.bar.enable_steady_tick(Duration::from_millis(120));
        progress
    }

    fn start(bar: ProgressBar, template: &str, what: &str) -> Self {
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        Self { bar }
    }

    /// Shows the step that the work is at now.
    pub fn says(&self, message: String) {
        self.bar.set_message(message);
    }

    /// So many steps are done in all.
    pub fn at(&self, steps: u64) {
        self.bar.set_position(steps);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn target(global: &GlobalArguments) -> ProgressDrawTarget {
    if !global.quiet && std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr_with_hz(8)
    } else {
        ProgressDrawTarget::hidden()
    }
}
