//! The look of the window: the letters of the figures, quiet panels, in light and dark.

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Stroke, Style,
    TextStyle, Theme, vec2,
};

use crate::render::text::fonts::{REGULAR, SEMI_BOLD};

/// The family of headings.
const HEADINGS: &str = "headings";
/// Blue of what is chosen and of links, on dark and on light.
const ACCENTS: [Color32; 2] = [Color32::from_rgb(86, 180, 233), Color32::from_rgb(0, 92, 150)];

/// Sets fonts and both themes.
pub fn set(context: &Context) {
    let mut fonts = FontDefinitions::default();
    for (name, bytes) in [("Inter", REGULAR), ("Inter SemiBold", SEMI_BOLD)] {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
    }
    let fallback = fonts.families.get(&FontFamily::Proportional).cloned().unwrap_or_default();
    let with = |first: &str| std::iter::once(first.to_owned()).chain(fallback.iter().cloned()).collect::<Vec<_>>();
    let [regular, heading] = [with("Inter"), with("Inter SemiBold")];
    fonts.families.insert(FontFamily::Proportional, regular);
    fonts.families.insert(FontFamily::Name(HEADINGS.into()), heading);
    context.set_fonts(fonts);
    // A slow hand, or a slow frame, still clicks; what moved before it was let go is a drag.
    context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
    context.style_mut_of(Theme::Dark, |style| common(style, ACCENTS[0], true));
    context.style_mut_of(Theme::Light, |style| common(style, ACCENTS[1], false));
}

fn common(style: &mut Style, accent: Color32, is_dark: bool) {
    let sizes = [
        (TextStyle::Heading, FontId::new(15.0, FontFamily::Name(HEADINGS.into()))),
        (TextStyle::Body, FontId::proportional(13.0)),
        (TextStyle::Button, FontId::proportional(13.0)),
        (TextStyle::Small, FontId::proportional(11.0)),
        (TextStyle::Monospace, FontId::monospace(12.0)),
    ];
    style.text_styles.extend(sizes);
    style.spacing.item_spacing = vec2(6.0, 5.0);
    style.spacing.button_padding = vec2(7.0, 3.0);
    style.spacing.indent = 14.0;
    let visuals = &mut style.visuals;
    let [panel, edge, text, weak] = match is_dark {
        true => [32, 58, 225, 165],
        false => [248, 212, 30, 96],
    };
    visuals.panel_fill = Color32::from_gray(panel);
    visuals.window_fill = Color32::from_gray(panel);
    visuals.override_text_color = Some(Color32::from_gray(text));
    visuals.weak_text_color = Some(Color32::from_gray(weak));
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_gray(edge));
    visuals.hyperlink_color = accent;
    visuals.selection.bg_fill = accent.gamma_multiply(if is_dark { 0.45 } else { 0.3 });
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_gray(text));
    visuals.error_fg_color = if is_dark { Color32::from_rgb(255, 130, 110) } else { Color32::from_rgb(176, 32, 16) };
    for widget in [
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(4);
    }
}

/// A colour of the scene, for the window.
pub(super) fn color_of(rgb: [f32; 3]) -> Color32 {
    let [r, g, b] = rgb.map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// Text at a place of the canvas, with a halo.
pub(super) fn caption(painter: &egui::Painter, at: egui::Pos2, anchor: Align2, text: &str, size: f32) {
    let font = egui::FontId::proportional(size);
    for (dx, dy) in [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)] {
        painter.text(at + egui::vec2(dx, dy), anchor, text, font.clone(), Color32::from_white_alpha(220));
    }
    painter.text(at, anchor, text, font, Color32::from_gray(20));
}
