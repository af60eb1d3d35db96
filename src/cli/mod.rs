//! Commands, options, messages and exit codes (contract.md, "The program").

/// Runs the program on the process' arguments: 0 done, 1 failed, 2 wrong usage.
pub fn main() -> std::process::ExitCode {
    std::process::ExitCode::from(2)
}
