//! The failure of a command: one readable message and an exit code.

use std::{fmt::Display, process::ExitCode};

use crate::{
    cli::terminal::{self, Paint},
    text,
};

/// Why a command did not do what it was asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// File, place, what is wrong; what would be right.
    message: String,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Failed,
    Usage,
}

/// The result of a command.
pub type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// The command could not be done: exit code 1.
    pub fn failed(message: impl Display) -> Self {
        Self { message: message.to_string(), kind: Kind::Failed }
    }

    /// The command line asks for what makes no sense: exit code 2.
    pub fn usage(message: impl Display) -> Self {
        Self { message: message.to_string(), kind: Kind::Usage }
    }

    /// Reading or writing `place` failed.
    pub fn io(place: &str, error: &std::io::Error) -> Self {
        Self::failed(format!("{place}: {error}"))
    }

    /// Prints the message on stderr; gives the exit code.
    pub fn report(&self) -> ExitCode {
        let code = match self.kind {
            Kind::Failed => 1,
            Kind::Usage => 2,
        };
        let paint = Paint::for_stderr();
        terminal::say(&format!("{} {}", paint.error("error:"), text::shown(&self.message)));
        ExitCode::from(code)
    }
}
