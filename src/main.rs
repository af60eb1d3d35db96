//! The program `veduta`; everything it does is in the library.

#[expect(unsafe_code, clippy::disallowed_methods, reason = "the environment is set before any thread exists")]
fn main() -> std::process::ExitCode {
    // A Vulkan layer of Mesa asks the Wayland server which GPU to prefer, and complains on stderr where there is none.
    if std::env::var_os("WAYLAND_DISPLAY").is_none() {
        // SAFETY: the first statement of the program; nothing else runs yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
    // A driver that remembers shaders of earlier runs would have nothing to compile when compiling is timed.
    if std::env::args_os().any(|argument| argument == "measure") {
        for (name, value) in [("MESA_SHADER_CACHE_DISABLE", "true"), ("__GL_SHADER_DISK_CACHE", "0")] {
            // SAFETY: as above.
            unsafe { std::env::set_var(name, value) };
        }
    }
    veduta::cli::main()
}
