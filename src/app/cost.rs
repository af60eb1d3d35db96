//! Costs of the picture: times, passes, pipelines, lenses.

use eframe::egui::{self, Ui};

use crate::app::state::Window;

/// The panel.
pub fn show(window: &Window, ui: &mut Ui) {
    ui.heading("What it costs");
    if let Some(city) = &window.city {
        ui.weak(format!("{}{}", city.adapter, if city.is_software { " (the processor draws)" } else { "" }));
    }
    let mut times = window.times_ms.clone();
    times.sort_by(f64::total_cmp);
    if let (Some(median), Some(last)) = (times.get(times.len() / 2), window.times_ms.last()) {
        ui.label(format!("Last picture {last:.0} ms, median {median:.0} ms"));
    }
    let Some(statistics) = &window.statistics else {
        ui.weak("Measured with the next picture that stands still.");
        return;
    };
    let frame = &statistics.frame;
    ui.label(format!(
        "On the card {:.1} ms; the city takes {:.0} MB there",
        frame.gpu_ms.unwrap_or(0.0),
        statistics.city.gpu_bytes as f64 / 1e6
    ));
    ui.label(format!(
        "{} of {} pipelines were there, {} triangles in the city",
        statistics.pipelines.reused,
        statistics.pipelines.names.len(),
        statistics.city.triangles
    ));
    egui::CollapsingHeader::new("Passes").default_open(true).show(ui, |ui| {
        egui::Grid::new("passes").num_columns(3).striped(true).show(ui, |ui| {
            for name in ["pass", "ms", "triangles"] {
                ui.strong(name);
            }
            ui.end_row();
            for pass in &statistics.passes {
                ui.label(&pass.name);
                ui.monospace(pass.gpu_ms.map_or_else(|| "–".to_owned(), |ms| format!("{ms:.2}")));
                ui.monospace(pass.triangles.to_string());
                ui.end_row();
            }
        });
    });
    egui::CollapsingHeader::new("Lenses").default_open(true).show(ui, |ui| {
        egui::Grid::new("lens costs").num_columns(3).striped(true).show(ui, |ui| {
            for name in ["lens", "objects", "pixels"] {
                ui.strong(name);
            }
            ui.end_row();
            for lens in &statistics.lenses {
                ui.label(&lens.name);
                ui.monospace(lens.objects.to_string());
                ui.monospace(lens.covered.to_string());
                ui.end_row();
            }
        });
    });
}
