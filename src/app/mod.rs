//! The window: a person opens a city, looks around, puts lenses where they want them, and saves the figure and the file that makes it again.
//!
//! ```text
//!  menu · actions            one table of what can be done, with keys
//!  ┌─────────┬───────────────────────┬─────────┐
//!  │ lenses  │ canvas                │ objects │   each panel changes the document by commands;
//!  │ proper- │ the last picture,     │ colours │   the canvas asks the render thread for a picture,
//!  │ ties    │ pointer, gizmos       │ costs   │   which has a device of its own
//!  └─────────┴───────────────────────┴─────────┘
//!  status
//! ```

pub mod actions;
pub mod canvas;
pub mod canvas_state;
mod cost;
pub mod dialogs;
pub mod document;
pub mod drawing;
pub mod drawn;
pub mod file_dialog;
mod finder;
mod gizmo;
mod landing;
pub mod lens_list;
pub mod new_lens;
pub mod objects;
mod outlines;
pub mod properties;
mod ray_gizmos;
pub mod render_thread;
mod scrub;
mod spots;
pub mod state;
mod theme;
pub mod timeline;
mod unsaved;
pub mod user_effects;
pub mod window;

use eframe::egui;

pub use state::Window;
pub use window::{BUILTIN, Start};

/// The program that eframe runs.
struct App {
    window: Window,
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.window.ui(ui);
    }
}

/// Whether there is a display to open a window on.
pub fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["DISPLAY", "WAYLAND_DISPLAY"]
            .iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// Opens the window and stays until it is closed.
///
/// # Errors
/// The message of the system where no window can be opened.
pub fn run(start: Start) -> Result<(), String> {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Veduta")
        .with_app_id("veduta")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([640.0, 400.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let make = move |creation: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>> {
        let window = Window::new(&creation.egui_ctx, &start)?;
        Ok(Box::new(App { window }))
    };
    eframe::run_native("veduta", options, Box::new(make)).map_err(|error| error.to_string())
}
