//! The looks of pictures, chosen by small pictures of the built-in square in each of them.

use eframe::egui::{self, Button, ColorImage, Context, Id, Image, RichText, TextureHandle, TextureOptions, Ui};

/// The looks, by their words in scene files, as PNG of the size [`PICTURE`].
pub const PICTURES: [(&str, &[u8]); 5] = [
    ("natural", include_bytes!("../../../assets/looks/natural.png")),
    ("paper", include_bytes!("../../../assets/looks/paper.png")),
    ("map", include_bytes!("../../../assets/looks/map.png")),
    ("night", include_bytes!("../../../assets/looks/night.png")),
    ("blueprint", include_bytes!("../../../assets/looks/blueprint.png")),
];
/// Width and height of the pictures, pixels.
pub const PICTURE: [u32; 2] = [168, 112];
/// How wide they are shown, points: half of that, so that they are sharp on fine screens.
const SHOWN: [f32; 2] = [84.0, 56.0];
/// What one takes with its frame and its name, points.
const CELL: [f32; 2] = [100.0, 78.0];

/// A picture for each word, two in a row, the present one marked; the word that is chosen. `label`: what names them.
pub fn menu(ui: &mut Ui, words: &[&str], now: &str, label: Id) -> Option<String> {
    let textures = textures(ui.ctx());
    let mut chosen = None;
    egui::Grid::new("looks").num_columns(2).spacing([4.0, 4.0]).show(ui, |ui| {
        for (i, word) in words.iter().enumerate() {
            // As wide as it is: what takes all the room there is makes a panel grow from frame to frame.
            ui.allocate_ui_with_layout(CELL.into(), egui::Layout::top_down(egui::Align::Center), |ui| {
                ui.set_width(CELL[0]);
                let picture = PICTURES.iter().position(|(own, _)| own == word).and_then(|k| textures.get(k));
                let button = match picture {
                    Some(texture) => Button::image(Image::new((texture.id(), SHOWN.into()))),
                    None => Button::new(*word),
                };
                let response = ui.add(button.selected(*word == now)).labelled_by(label);
                response.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, *word == now, *word));
                if response.clicked() && *word != now {
                    chosen = Some((*word).to_owned());
                }
                let name = RichText::new(*word).small();
                ui.label(if *word == now { name.strong() } else { name });
            });
            if i % 2 == 1 {
                ui.end_row();
            }
        }
    });
    chosen
}

/// Whether each of these words has a picture.
pub fn are_looks(words: &[&str]) -> bool {
    words.iter().all(|word| PICTURES.iter().any(|(own, _)| own == word))
}

/// The pictures, in the order of [`PICTURES`]; decoded once.
fn textures(context: &Context) -> Vec<TextureHandle> {
    let id = Id::unique("pictures of looks");
    if let Some(known) = context.data(|data| data.get_temp::<Vec<TextureHandle>>(id)) {
        return known;
    }
    let texture = |(word, png): &(&str, &[u8])| {
        let image = image::load_from_memory(png).map(image::DynamicImage::into_rgba8).unwrap_or_default();
        let size = [image.width() as usize, image.height() as usize];
        context.load_texture(*word, ColorImage::from_rgba_unmultiplied(size, image.as_raw()), TextureOptions::LINEAR)
    };
    let made: Vec<TextureHandle> = PICTURES.iter().map(texture).collect();
    context.data_mut(|data| data.insert_temp(id, made.clone()));
    made
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::StyleLook;

    #[test]
    fn every_look_has_a_picture() {
        let words = StyleLook::WORDS.map(|(word, _)| word);
        assert_eq!(PICTURES.map(|(word, _)| word), words);
        assert!(are_looks(&words) && !are_looks(&["natural", "clay"]));
        for (word, png) in PICTURES {
            let image = image::load_from_memory(png).expect(word);
            assert_eq!([image.width(), image.height()], PICTURE, "{word}");
        }
    }
}
