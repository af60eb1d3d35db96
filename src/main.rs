//! The program `veduta`; everything it does is in the library.

fn main() -> std::process::ExitCode {
    veduta::cli::main()
}
