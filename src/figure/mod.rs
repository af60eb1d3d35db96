//! A figure is a frame written down: scene files and back, pictures and their metadata, titles, captions and legends.

pub mod animation;
pub mod file;
pub mod furniture;
pub mod legend;
pub mod overlays;
pub mod picture;
pub mod scene_file;
pub mod sheet;
pub mod ticks;

use crate::{
    render::{
        furniture::Furniture,
        picture::{Picture, RenderError, Request, Studio},
    },
    scene::Scene,
};

/// Draws a picture with the title, the caption and the legends that the scene's `[figure]` asks for.
pub fn draw(studio: &mut Studio, scene: &Scene, request: &Request) -> Result<Picture, RenderError> {
    let own = furniture_of(studio, scene, request.size)?;
    let overlays = overlays::overlays(studio, scene, request, &furniture::cards(&own), None)?;
    let furniture = Furniture { pieces: overlays.furniture.pieces.into_iter().chain(own.pieces).collect() };
    let mut picture = studio.render_with(scene, request, &furniture)?;
    if request.statistics {
        let figures = overlays.figures.iter().map(|own| {
            let [width, height] = own.size;
            serde_json::json!({ "lens": own.lens, "width": width, "height": height, "rendered": own.rendered })
        });
        picture.statistics.overlays = figures.collect();
    }
    Ok(picture)
}

/// The title, caption and legends of a picture of `size` pixels; nothing where the scene asks for nothing.
pub fn furniture_of(studio: &Studio, scene: &Scene, size: [u32; 2]) -> Result<Furniture, RenderError> {
    let legends = match scene.figure.legend.corner() {
        Some(_) => legend::legends(scene, &studio.model, &studio.lenses_in_view(scene, size)?),
        None => Vec::new(),
    };
    Ok(furniture::lay_out(&scene.figure, &legends, size))
}
