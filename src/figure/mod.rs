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
    figure::overlays::Standing,
    render::{
        furniture::Furniture,
        picture::{Picture, RenderError, Request, ShownOverlay, Studio},
    },
    scene::Scene,
};

/// Draws a picture with its overlays, and with the title, the caption and the legends that the scene's `[figure]` asks for.
///
/// # Errors
/// Those of a picture; what an overlay shows and is not there.
pub fn draw(studio: &mut Studio, scene: &Scene, request: &Request) -> Result<Picture, RenderError> {
    draw_next(studio, scene, request, &mut Standing::default())
}

/// The same for a frame of several: overlays go on from where they stood in the frame before.
///
/// # Errors
/// As for [`draw`].
pub fn draw_next(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    standing: &mut Standing,
) -> Result<Picture, RenderError> {
    let own = furniture_of(studio, scene, request.size)?;
    draw_with(studio, scene, request, standing, own)
}

/// Lets the overlays of a frame that is not drawn take their places.
///
/// # Errors
/// What an overlay shows and is not there.
pub fn pass(studio: &Studio, scene: &Scene, size: [u32; 2], standing: &mut Standing) -> Result<(), RenderError> {
    let own = furniture_of(studio, scene, size)?;
    overlays::pass(studio, scene, size, &furniture::cards(&own), standing)
}

/// Draws a picture with its overlays, and without title, caption and legends.
///
/// # Errors
/// As for [`draw`].
pub fn draw_untitled(studio: &mut Studio, scene: &Scene, request: &Request) -> Result<Picture, RenderError> {
    draw_with(studio, scene, request, &mut Standing::default(), Furniture::default())
}

fn draw_with(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    standing: &mut Standing,
    own: Furniture,
) -> Result<Picture, RenderError> {
    let overlays = overlays::overlays(studio, scene, request, &furniture::cards(&own), standing)?;
    let furniture = Furniture { pieces: overlays.furniture.pieces.into_iter().chain(own.pieces).collect() };
    let mut picture = studio.render_with(scene, request, &furniture)?;
    picture.without_glyph.extend(&overlays.without_glyph);
    picture.overlays = overlays.figures.iter().map(|own| own.shown).collect();
    if request.statistics {
        let figures = overlays.figures.iter().map(|own| {
            let ShownOverlay { lens, at: [x, y], size: [width, height], .. } = own.shown;
            let triangles = own.triangles(&scene.lenses[lens as usize].name, request.samples);
            serde_json::json!({
                "lens": lens, "x": x, "y": y, "width": width, "height": height,
                "rendered": own.rendered, "triangles": triangles,
            })
        });
        let statistics = &mut picture.statistics;
        statistics.overlays = figures.collect();
        statistics.passes.splice(0..0, overlays.figures.iter().flat_map(|own| own.passes.iter().cloned()));
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
