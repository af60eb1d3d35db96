//! A figure is a frame written down: scene files and back, pictures and their metadata, titles, captions and legends.

pub mod animation;
pub mod file;
pub mod furniture;
pub mod legend;
pub mod moments;
pub mod overlays;
pub mod paper;
pub mod picture;
pub mod scene_file;
pub mod sheet;
pub mod ticks;

use crate::{
    figure::{
        furniture::Laid,
        overlays::{Overlays, Standing},
    },
    render::{
        diagnostics,
        furniture::{self as over_pictures, Furniture},
        picture::{Picture, RenderError, Request, ShownOverlay, Studio, TakeBand},
    },
    scene::Scene,
    view::View,
};

/// Draws a picture with its overlays, and with what the scene's `[figure]` asks for: title, caption, legends, the signs of a map.
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
    let scene = &*studio.on_ground(scene)?;
    studio.stand_at(scene);
    let own = furniture_of(studio, scene, request.size)?;
    draw_with(studio, scene, request, standing, own)
}

/// Lets the overlays of a frame that is not drawn take their places.
///
/// # Errors
/// What an overlay shows and is not there.
pub fn pass(studio: &mut Studio, scene: &Scene, size: [u32; 2], standing: &mut Standing) -> Result<(), RenderError> {
    let scene = &*studio.on_ground(scene)?;
    studio.stand_at(scene);
    let own = furniture_of(studio, scene, size)?;
    overlays::pass(studio, scene, size, &own.taken, standing)
}

/// Draws a picture with its overlays, and without what `[figure]` asks for.
///
/// # Errors
/// As for [`draw`].
pub fn draw_untitled(studio: &mut Studio, scene: &Scene, request: &Request) -> Result<Picture, RenderError> {
    let scene = &*studio.on_ground(scene)?;
    studio.stand_at(scene);
    draw_with(studio, scene, request, &mut Standing::default(), Laid::default())
}

/// A picture, and apart from it what stands over it.
#[derive(Clone, Debug)]
pub struct Apart {
    /// The picture without its furniture and its pixels.
    pub picture: Picture,
    /// What [`draw`] draws over it; its images are those that the renderer keeps until it draws something else.
    pub furniture: Furniture,
}

/// Draws a picture without what stands over it: overlays, and what `[figure]` asks for. `take` gets its pixels, band by band from the top; the picture of
/// the answer has all but these.
///
/// # Errors
/// As for [`draw_in_bands`].
pub fn draw_apart(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    take: &mut TakeBand,
) -> Result<Apart, RenderError> {
    let scene = &*studio.on_ground(scene)?;
    studio.stand_at(scene);
    let own = furniture_of(studio, scene, request.size)?;
    let mut overlays = overlays::overlays(studio, scene, request, &own.taken, &mut Standing::default())?;
    let furniture = over(&mut overlays, own);
    let missing = diagnostics::without_glyph(&furniture);
    diagnostics::boxes(&missing).iter().for_each(|(_, message)| log::warn!("{message}"));
    let mut picture = studio.render_in_bands(scene, request, &over_pictures::NONE, take)?;
    picture.without_glyph.extend(&missing);
    tell(&mut picture, scene, request, &overlays);
    Ok(Apart { picture, furniture })
}

/// Draws a picture as [`draw`] does and gives `take` its pixels, band by band from the top; the answer has all but these.
///
/// # Errors
/// As for [`draw`], and where `take` fails.
pub fn draw_in_bands(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    take: &mut TakeBand,
) -> Result<Picture, RenderError> {
    let scene = &*studio.on_ground(scene)?;
    studio.stand_at(scene);
    let own = furniture_of(studio, scene, request.size)?;
    let mut overlays = overlays::overlays(studio, scene, request, &own.taken, &mut Standing::default())?;
    let furniture = over(&mut overlays, own);
    let mut picture = studio.render_in_bands(scene, request, &furniture, take)?;
    tell(&mut picture, scene, request, &overlays);
    Ok(picture)
}

fn draw_with(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    standing: &mut Standing,
    own: Laid,
) -> Result<Picture, RenderError> {
    let mut overlays = overlays::overlays(studio, scene, request, &own.taken, standing)?;
    let furniture = over(&mut overlays, own);
    let mut picture = studio.render_with(scene, request, &furniture)?;
    tell(&mut picture, scene, request, &overlays);
    Ok(picture)
}

/// Overlays, and over them what the figure asks for.
fn over(overlays: &mut Overlays, own: Laid) -> Furniture {
    let below = std::mem::take(&mut overlays.furniture.pieces);
    Furniture { pieces: below.into_iter().chain(own.furniture.pieces).collect() }
}

/// Says in a picture what its overlays are.
fn tell(picture: &mut Picture, scene: &Scene, request: &Request, overlays: &Overlays) {
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
}

/// The title, caption, legends and signs of a picture of `size` pixels; nothing where the scene asks for nothing.
///
/// # Errors
/// Those of the camera, and of lenses that have no place.
pub fn furniture_of(studio: &Studio, scene: &Scene, size: [u32; 2]) -> Result<Laid, RenderError> {
    let figure = &scene.figure;
    let places = [figure.legend, figure.scale_bar, figure.north_arrow];
    let view = View::new(studio.camera(scene, size), size, &studio.extent())?;
    let labels = moments::labels(studio, scene, &view)?;
    let has_pieces = figure.title.is_some() || figure.caption.is_some() || places.iter().any(|place| place.is_some());
    if !has_pieces && labels.is_empty() {
        return Ok(Laid::default());
    }
    let legends = match figure.legend.is_some() {
        true => {
            let (seen, beside) = (studio.lenses_in_view(scene, size)?, studio.shown_beside(scene, size)?);
            let of_city = legend::legends(scene, studio.file(), &seen, &studio.model, &beside);
            [legend::volume_legends(scene, &studio.volumes(scene)?), of_city].concat()
        }
        false => Vec::new(),
    };
    let standing = overlays::standing(studio, scene, &view);
    Ok(furniture::lay_out(figure, &furniture::Contents { legends: &legends, moments: &labels }, &view, &standing))
}
