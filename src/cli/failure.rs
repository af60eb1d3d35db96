//! The failure of a command: one readable message and an exit code.

use std::{fmt::Display, process::ExitCode};

use crate::cli::terminal::{self, Paint};

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
    ClosedPipe,
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

    /// Reading or writing `place` failed. The reader of a pipe that leaves early is no failure: it has seen enough.
    pub fn io(place: &str, error: &std::io::Error) -> Self {
        let kind = if error.kind() == std::io::ErrorKind::BrokenPipe { Kind::ClosedPipe } else { Kind::Failed };
        Self { message: format!("{place}: {error}"), kind }
    }

    /// Prints the message on stderr; gives the exit code.
    pub fn report(&self) -> ExitCode {
        let code = match self.kind {
            Kind::ClosedPipe => return ExitCode::SUCCESS,
            Kind::Failed => 1,
            Kind::Usage => 2,
        };
        let paint = Paint::for_stderr();
        terminal::say(&format!("{} {}", paint.error("error:"), self.message));
        ExitCode::from(code)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use super::*;

    #[test]
    fn a_closed_pipe_is_no_failure() {
        let code = |failure: Failure| format!("{:?}", failure.report());
        assert_eq!(
            code(Failure::io("stdout", &Error::from(ErrorKind::BrokenPipe))),
            format!("{:?}", ExitCode::SUCCESS)
        );
        assert_eq!(code(Failure::io("x.json", &Error::from(ErrorKind::NotFound))), format!("{:?}", ExitCode::from(1)));
    }
}
