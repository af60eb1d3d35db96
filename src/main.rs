//! The program `veduta`; everything it does is in the library.

#[expect(unsafe_code, clippy::disallowed_methods, reason = "the environment is set before any thread exists")]
fn main() -> std::process::ExitCode {
    // A Vulkan layer of Mesa asks the Wayland server which card to prefer, and complains on stderr where there is none.
    if std::env::var_os("WAYLAND_DISPLAY").is_none() {
        // SAFETY: the first statement of the program; nothing else runs yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
    veduta::cli::main()
}
