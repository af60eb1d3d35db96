//! Overlays of a picture: what best-view lenses show, where it stands, and the lines that tie it to its places, as [`Furniture`];
//! below them markers and traces of what moves.
//!
//! ```text
//! scene ── points of interest in the picture (places) ── where overlays stand, and lines (spots, crate::overlay) ──
//! pieces of furniture
//!   ├── for those that stand in the scene: a board (call_out), whose image is furniture by itself
//!   └── for each lens with an overlay: a scene of its own (views) ── an inset of the studio, drawn where it is another
//! ```

mod call_out;
mod moving;
mod paint;
mod places;
mod room;
mod spots;
pub mod views;
mod words;

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use glam::DVec2;

use crate::{
    figure::furniture::em_px,
    lens::{Placement, best_view::Depiction},
    overlay::{Placed, Rect, arrow::border_arrow},
    render::{
        diagnostics,
        furniture::{Furniture, Piece},
        picture::{Aovs, RenderError, Request, ShownOverlay, Studio},
        stats::Pass,
    },
    scene::{
        Scene,
        overlay::{Outside, Stand},
    },
    view::View,
};

use paint::{Content, Painter};
use places::Shown;
use spots::Spot;
use views::Local;

/// How many numbers of images one view has for those over it: so many that views three deep have all of 64 bits.
const NUMBERS: u64 = 1 << 16;

/// What stands over a picture on account of its best-view lenses.
#[derive(Clone, Debug, Default)]
pub struct Overlays {
    /// To be drawn over it.
    pub furniture: Furniture,
    /// What each overlay is, for statistics.
    pub figures: Vec<OverlayFigures>,
    /// Characters of texts on boards that no font has.
    pub without_glyph: BTreeSet<char>,
}

/// One overlay, for statistics.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayFigures {
    /// Where it is.
    pub shown: ShownOverlay,
    /// Whether it was drawn for this picture.
    pub rendered: bool,
    /// The passes that drew what it shows, if that is a view, and before them those of overlays in it; the view of each is the name of its lens.
    pub passes: Vec<Pass>,
}

impl OverlayFigures {
    /// Triangles of the city that were handed to the rasteriser for what is seen in it, of one of so many samples; not those that cast
    /// shadows, nor those of overlays in it.
    pub fn triangles(&self, lens: &str, samples: u32) -> u64 {
        let own = self.passes.iter().filter(|pass| pass.view == lens && pass.name.starts_with("geometry"));
        own.map(|pass| pass.triangles).sum::<u64>() / u64::from(samples.max(1))
    }
}

/// Where the overlays of a picture, and those in them, stood last: from there they go on, so that they keep still while the eye moves. An
/// empty one is that of a picture alone, which goes by its scene only.
#[derive(Clone, Debug, Default)]
pub struct Standing {
    /// By the numbers of their views.
    of_views: BTreeMap<u64, Placed>,
    /// What was in the middle of maps, by their numbers.
    middles: BTreeMap<u64, DVec2>,
}

impl Standing {
    /// Those of the picture itself that are laid out; `None`: it has no overlays.
    pub fn of_picture(&self) -> Option<&Placed> {
        self.of_views.get(&0)
    }
}

/// What stands where in a view.
struct Plan {
    /// Numbers of its images come after this one.
    numbers: u64,
    size: [u32; 2],
    view: View,
    em: f32,
    shown: Vec<Shown>,
    /// In the order in which they are drawn.
    spots: Vec<Spot>,
    placed: Placed,
    /// Markers and traces of what moves.
    moving: Vec<Piece>,
    /// What those show that show the city, by the number of their lens.
    views: BTreeMap<usize, Inner>,
}

/// The view of an overlay.
struct Inner {
    local: Local,
    /// Pixels that it is drawn with.
    size: [u32; 2],
    plan: Option<Plan>,
}

/// What is gathered of all overlays, also of those in them.
#[derive(Default)]
struct Gathered {
    /// The numbers of images that are asked for.
    images: Vec<u64>,
    /// As in [`Overlays`].
    without_glyph: BTreeSet<char>,
}

/// The overlays of a picture; the insets that they show are drawn where they are others than before. They leave `blocked` free, pixels: what is
/// drawn over them.
///
/// # Errors
/// What a view of an overlay names and the city does not have, images that cannot be read, those of pictures.
pub fn overlays(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    blocked: &[Rect],
    standing: &mut Standing,
) -> Result<Overlays, RenderError> {
    let plan = stand(studio, scene, request.size, blocked, standing)?;
    let mut gathered = Gathered::default();
    let made = plan.map_or_else(|| Ok(Overlays::default()), |plan| plan.paint(studio, request, &mut gathered))?;
    studio.keep_insets(|number| gathered.images.contains(&number));
    Ok(Overlays { without_glyph: gathered.without_glyph, ..made })
}

/// What of a picture overlays take that have places of their own, or stand in the scene; pixels.
pub fn standing(studio: &Studio, scene: &Scene, view: &View) -> Vec<Rect> {
    if scene.overlays.iter().all(|overlay| matches!(overlay.stand, Stand::Laid)) {
        return Vec::new();
    }
    let lenses = scene.lenses.iter().enumerate();
    let shown: Vec<Shown> = lenses.filter_map(|(i, lens)| places::seen(studio, scene, view, i, lens)).collect();
    spots::standing(scene, view, &shown, em_px(&scene.figure, view.size))
}

/// Lets overlays take their places for a frame that is not drawn.
///
/// # Errors
/// What a view of an overlay names and the city does not have.
pub fn pass(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
    blocked: &[Rect],
    standing: &mut Standing,
) -> Result<(), RenderError> {
    stand(studio, scene, size, blocked, standing).map(|_| ())
}

fn stand(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
    blocked: &[Rect],
    standing: &mut Standing,
) -> Result<Option<Plan>, RenderError> {
    let mut new = Standing::default();
    let plan = plan(studio, scene, size, blocked, 0, standing, &mut new)?;
    *standing = new;
    Ok(plan)
}

/// Where the overlays of a view stand, and those in them; `None`: it has none.
fn plan(
    studio: &mut Studio,
    scene: &Scene,
    size: [u32; 2],
    blocked: &[Rect],
    numbers: u64,
    before: &Standing,
    now: &mut Standing,
) -> Result<Option<Plan>, RenderError> {
    if !scene.moves() && !scene.lenses.iter().any(|lens| lens.enabled && lens.kind.has_overlay()) {
        return Ok(None);
    }
    let camera = studio.camera(scene, size);
    let view = View::new(camera, size, &studio.extent())?;
    let shown: Vec<Shown> =
        scene.lenses.iter().enumerate().filter_map(|(i, lens)| places::seen(studio, scene, &view, i, lens)).collect();
    let em = em_px(&scene.figure, size);
    let (spots, placed) = spots::spots(studio, scene, &view, &shown, blocked, em, before.of_views.get(&numbers));
    now.of_views.insert(numbers, placed.clone());
    let mut ways = Painter::new(em);
    moving::paint(&mut ways, scene, &view);
    let moving = ways.into_pieces();
    let mut plan = Plan { numbers, size, view, em, shown, spots, placed, moving, views: BTreeMap::new() };
    for spot in &plan.spots {
        let Some(one) = plan.of(spot) else { continue };
        let Some(view) = one.best_view.view() else { continue };
        let room = paint::picture_room(&one.overlay, spot.rect, spot.em).size();
        let number = paint::number(numbers, one.index, paint::Part::Picture);
        let tracked = before.middles.get(&number).copied();
        let from = views::From { main: camera, size: room, tracked };
        let local = views::local(studio, scene, &one.name, &one.best_view, view, &from)?;
        now.middles.extend(local.middle.map(|middle| (number, middle)));
        let size = room.map(|side| (f64::from(side) * local.magnification).round() as u32);
        let inner = self::plan(studio, &local.scene, size, &[], number.wrapping_mul(NUMBERS), before, now)?;
        plan.views.insert(one.index, Inner { local, size, plan: inner });
        studio.stand_at(scene);
    }
    Ok(Some(plan))
}

impl Plan {
    fn of(&self, spot: &Spot) -> Option<&Shown> {
        self.shown.iter().find(|one| one.index == spot.index)
    }

    fn paint(&self, studio: &mut Studio, request: &Request, gathered: &mut Gathered) -> Result<Overlays, RenderError> {
        let mut painter = Painter::new(self.em);
        painter.put(&self.moving);
        // Boards stand in the scene: their lines lie over what is farther away.
        for spot in self.spots.iter().filter(|spot| spot.board.is_none()) {
            self.lines(studio, &mut painter, spot, gathered)?;
        }
        let mut figures = Vec::new();
        for spot in &self.spots {
            let Some(one) = self.of(spot) else { continue };
            let Some(board) = &spot.board else {
                figures.push(self.overlay(studio, request, &mut painter, one, spot, gathered)?);
                continue;
            };
            self.lines(studio, &mut painter, spot, gathered)?;
            let mut own = Painter::new(spot.em);
            let mut of_board = self.overlay(studio, request, &mut own, one, spot, gathered)?;
            let furniture = Furniture { pieces: own.into_pieces() };
            gathered.without_glyph.extend(diagnostics::without_glyph(&furniture));
            let number = paint::number(self.numbers, one.index, paint::Part::Board);
            gathered.images.push(number);
            of_board.rendered |= studio.renderer.board(number, board.image_size(), &furniture, of_board.rendered)?;
            painter.put(&[Piece::Board(board.piece(number))]);
            (of_board.shown.at, of_board.shown.size) =
                (board.seen.min, board.seen.size().map(|side| side.max(0) as u32));
            figures.push(of_board);
        }
        figures.sort_by_key(|own| own.shown.lens);
        for one in &self.shown {
            let style = one.overlay.line.as_ref().filter(|style| style.outside == Outside::Arrow);
            let Some(style) = style else { continue };
            let outside = one.places.iter().filter(|place| place.focus.is_none()).map(|place| place.direction);
            for direction in outside.chain(self.to_unseen_board(one)) {
                if let Some(arrow) = border_arrow(self.size, 0.4 * f64::from(self.em), direction) {
                    painter.arrow(arrow.tip, arrow.direction, style.color.unwrap_or(one.color));
                }
            }
        }
        for marker in &self.placed.markers {
            painter.marker(marker.at, marker.overlays.len());
        }
        Ok(Overlays { furniture: Furniture { pieces: painter.into_pieces() }, figures, ..Overlays::default() })
    }

    /// Where the board of a place in the picture is, if it is not seen: in the plane of the picture from its middle.
    fn to_unseen_board(&self, one: &Shown) -> Option<DVec2> {
        let first = one.places.first().filter(|place| place.focus.is_some())?;
        let is_seen = || self.spots.iter().any(|spot| spot.index == one.index);
        let stands = matches!(one.overlay.stand, Stand::Scene(_));
        (stands && !is_seen()).then(|| places::direction(&self.view, first.at.with_z(first.heights_m[1])))
    }

    /// The context lines of an overlay.
    fn lines(
        &self,
        studio: &mut Studio,
        painter: &mut Painter,
        spot: &Spot,
        gathered: &mut Gathered,
    ) -> Result<(), RenderError> {
        let Some(one) = self.of(spot) else { return Ok(()) };
        let Some(style) = &one.overlay.line else { return Ok(()) };
        for (end, points) in &spot.lines {
            let place = one.places.iter().filter(|p| p.focus.is_some()).nth(*end);
            let skin = self.image(studio, one, paint::Part::Skin, style.skin.as_deref(), None, gathered)?;
            let is_far = place.is_some_and(|p| style.arrow_distance_m.is_some_and(|most| p.distance > most));
            painter.line(points, style, one.color, skin, is_far, self.size);
            if let (false, Some(place)) = (is_far, place) {
                painter.focus(place, style, one.color);
            }
        }
        Ok(())
    }

    /// Keeps an image of a file for the renderer, at `size` or as it is; its number.
    fn image(
        &self,
        studio: &mut Studio,
        one: &Shown,
        part: paint::Part,
        file: Option<&Path>,
        size: Option<[u32; 2]>,
        gathered: &mut Gathered,
    ) -> Result<Option<u64>, RenderError> {
        let Some(file) = file else { return Ok(None) };
        let number = paint::number(self.numbers, one.index, part);
        gathered.images.push(number);
        studio.renderer.image_of_file(number, file, size).map_err(|error| wrong(&one.name, &error))?;
        Ok(Some(number))
    }

    /// An overlay in its frame.
    fn overlay(
        &self,
        studio: &mut Studio,
        request: &Request,
        painter: &mut Painter,
        one: &Shown,
        spot: &Spot,
        gathered: &mut Gathered,
    ) -> Result<OverlayFigures, RenderError> {
        let rect = spot.rect;
        let room = paint::picture_room(&one.overlay, rect, spot.em);
        let number = paint::number(self.numbers, one.index, paint::Part::Picture);
        let inner = self.views.get(&one.index);
        let (mut rendered, mut passes) = (false, Vec::new());
        let camera = inner.and_then(|inner| inner.local.scene.camera);
        let shown = ShownOverlay { lens: one.index as u32, at: room.low, size: room.size(), camera };
        match (&one.best_view.depiction, inner) {
            (Depiction::Text(text), _) => {
                painter.text(&one.overlay, rect, text);
                return Ok(OverlayFigures { shown, rendered, passes });
            }
            (Depiction::Image(file), _) => {
                gathered.images.push(number);
                let read = studio.renderer.image_of_file(number, file, Some(room.size()));
                rendered = read.map_err(|error| wrong(&one.name, &error))?;
            }
            (Depiction::View(_), None) => {}
            (Depiction::View(_), Some(inner)) => {
                gathered.images.push(number);
                let asked = Request {
                    size: inner.size,
                    transparent: inner.local.transparent,
                    aovs: Aovs::default(),
                    statistics: false,
                    ..*request
                };
                let over = match &inner.plan {
                    Some(plan) => plan.paint(studio, &asked, gathered)?,
                    None => Overlays::default(),
                };
                let is_stale = over.figures.iter().any(|figures| figures.rendered);
                let drawn =
                    studio.inset(number, &at_its_moment(&inner.local.scene), &asked, &over.furniture, is_stale)?;
                rendered = drawn.is_some();
                passes.extend(over.figures.into_iter().flat_map(|figures| figures.passes));
                passes.extend(drawn.into_iter().flatten().map(|pass| of_overlay(pass, &one.name)));
            }
        }
        let [alpha, frame] = paint::masks(&one.overlay.frame);
        let masks = [
            self.image(studio, one, paint::Part::Alpha, alpha, Some(room.size()), gathered)?,
            self.image(studio, one, paint::Part::Frame, frame, Some(room.size()), gathered)?,
        ];
        let local = inner.map(|inner| &inner.local);
        let mirror = local.is_some_and(|local| local.mirror);
        let magnification = local.map_or(1.0, |local| local.magnification) as f32;
        painter.overlay(&one.overlay, rect, Content { image: number, mirror, magnification, masks });
        if let (Some(view), Some(local)) = (one.best_view.view(), local) {
            painter.signs(&one.overlay, view, local, &self.view.camera, room);
        }
        Ok(OverlayFigures { shown, rendered, passes })
    }
}

/// What of a scene its picture without furniture is made of: nothing moves in it, nor has it points of interest that no lens asks for. It
/// stays the same where only they are others.
fn at_its_moment(scene: &Scene) -> Scene {
    let mut own = scene.clone();
    own.trajectories.clear();
    // Time operators may go by the clock.
    if own.lenses.iter().all(|lens| lens.time.is_empty()) {
        own.time_s = 0.0;
    }
    own.pois = scene.standing_pois();
    own.pois.retain(|poi| {
        scene.lenses.iter().filter(|lens| lens.enabled).any(|lens| {
            let is_looked_for = lens.occluders().is_some_and(|of| of.pois.contains(&poi.name));
            is_looked_for || lens.placement == Placement::Poi(poi.name.clone())
        })
    });
    own
}

/// A pass of the view of a lens, which tells it by its name.
fn of_overlay(pass: Pass, lens: &str) -> Pass {
    let view = if pass.view == "main" { lens.to_owned() } else { format!("{lens}: {}", pass.view) };
    Pass { view, ..pass }
}

fn wrong(lens: &str, message: &str) -> RenderError {
    RenderError::Scene(format!("lens \"{lens}\": {message}"))
}

/// A rectangle of whole pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Left, top.
    pub low: [i32; 2],
    /// Right, bottom.
    pub high: [i32; 2],
}

impl Room {
    /// Width and height, at least 1.
    pub fn size(&self) -> [u32; 2] {
        std::array::from_fn(|i| (self.high[i] - self.low[i]).max(1) as u32)
    }
}
