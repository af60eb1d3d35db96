//! Overlays of a picture (B1 to B7): what best-view lenses show, where it stands, and the lines that tie it to its places, as [`Furniture`];
//! below them markers and traces of what moves.
//!
//! ```text
//! scene ── points of interest in the picture ── layout and lines (crate::overlay) ── pieces of furniture
//!   └── for each lens with an overlay: a scene of its own (views) ── an inset of the studio, drawn where it is another
//! ```

mod moving;
mod paint;
pub mod views;

use std::{collections::BTreeMap, path::Path};

use glam::{DVec2, DVec3};

use crate::{
    figure::furniture::em_px,
    geom::outline,
    lens::{
        BestView, Lens, Placement,
        best_view::{Depiction, LocalView},
        color::Srgb,
    },
    overlay::{self, Focus, Placed, Rect, arrow::border_arrow},
    render::{
        furniture::{Furniture, Piece},
        picture::{Aovs, RenderError, Request, Studio},
        stats::Pass,
    },
    scene::{
        Overlay, Poi, PoiPlace, Scene,
        anchor::anchor,
        overlay::{Along, LineEnd, LineKind, Outside, Sizes},
    },
    view::{Camera, View},
};

use paint::{Content, Painter};
use views::Local;

/// How far overlays stay from points of interest, pixels.
const CLEARANCE_PX: f64 = 6.0;
/// How many numbers of images one view has for those over it: so many that views three deep have all of 64 bits.
const NUMBERS: u64 = 1 << 16;

/// What stands over a picture on account of its best-view lenses.
#[derive(Clone, Debug, Default)]
pub struct Overlays {
    /// To be drawn over it.
    pub furniture: Furniture,
    /// What each overlay is, for statistics.
    pub figures: Vec<OverlayFigures>,
}

/// One overlay, for statistics.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayFigures {
    /// The number of its lens.
    pub lens: u32,
    /// Left and top of what it shows, pixels of the picture.
    pub at: [i32; 2],
    /// Width and height of what it shows, pixels.
    pub size: [u32; 2],
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

/// Where the overlays of a picture, and those in them, stood last: from there they go on, so that they keep still while the eye moves (B6). An
/// empty one is that of a picture alone, which goes by its scene only.
#[derive(Clone, Debug, Default)]
pub struct Standing {
    /// By the numbers of their views.
    of_views: BTreeMap<u64, Placed>,
    /// What was in the middle of maps, by their numbers.
    middles: BTreeMap<u64, DVec2>,
}

impl Standing {
    /// Those of the picture itself; `None`: it has none.
    pub fn of_picture(&self) -> Option<&Placed> {
        self.of_views.get(&0)
    }
}

/// A lens with an overlay in one picture.
struct Shown {
    index: usize,
    name: String,
    color: Srgb,
    best_view: BestView,
    overlay: Overlay,
    places: Vec<Place>,
}

/// A point of interest as an overlay is tied to it.
#[derive(Clone, Debug)]
struct Place {
    /// Where it ends, if it is in the picture.
    focus: Option<Focus>,
    /// Where it is, in the plane of the picture from its middle: x right, y down.
    direction: DVec2,
    /// How far from the eye, metres.
    distance: f64,
}

/// What stands where in a view.
struct Plan {
    /// Numbers of its images come after this one.
    numbers: u64,
    size: [u32; 2],
    camera: Camera,
    em: f32,
    shown: Vec<Shown>,
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
    let mut kept = Vec::new();
    let made = plan.map_or_else(|| Ok(Overlays::default()), |plan| plan.paint(studio, request, &mut kept))?;
    studio.keep_insets(|number| kept.contains(&number));
    Ok(made)
}

/// Lets overlays take their places for a frame that is not drawn.
///
/// # Errors
/// What a view of an overlay names and the city does not have.
pub fn pass(
    studio: &Studio,
    scene: &Scene,
    size: [u32; 2],
    blocked: &[Rect],
    standing: &mut Standing,
) -> Result<(), RenderError> {
    stand(studio, scene, size, blocked, standing).map(|_| ())
}

fn stand(
    studio: &Studio,
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
    studio: &Studio,
    scene: &Scene,
    size: [u32; 2],
    blocked: &[Rect],
    numbers: u64,
    before: &Standing,
    now: &mut Standing,
) -> Result<Option<Plan>, RenderError> {
    if !scene.moves() && !scene.lenses.iter().any(|lens| lens.enabled && lens.best_view.is_some()) {
        return Ok(None);
    }
    let camera = studio.camera(scene, size);
    let view = View::new(camera, size, &studio.extent())?;
    let shown: Vec<Shown> =
        scene.lenses.iter().enumerate().filter_map(|(i, lens)| seen(studio, scene, &view, i, lens)).collect();
    let em = em_px(&scene.figure, size);
    let asked = layout_of(studio, scene, &view, &shown, blocked, em);
    let placed = overlay::place(&asked, before.of_views.get(&numbers));
    now.of_views.insert(numbers, placed.clone());
    let mut ways = Painter::new(em);
    moving::paint(&mut ways, scene, &view);
    let moving = ways.into_pieces();
    let mut plan = Plan { numbers, size, camera, em, shown, placed, moving, views: BTreeMap::new() };
    for placement in &plan.placed.placements {
        let Some(one) = plan.of(placement.id) else { continue };
        let Some(view) = one.best_view.view() else { continue };
        let room = paint::picture_room(&one.overlay, placement.rect, em).size();
        let number = paint::number(numbers, one.index, paint::Part::Picture);
        let tracked = before.middles.get(&number).copied();
        let from = views::From { main: camera, size: room, tracked };
        let local = views::local(studio, scene, &one.name, &one.best_view, view, &from)?;
        now.middles.extend(local.middle.map(|middle| (number, middle)));
        let size = room.map(|side| (f64::from(side) * local.magnification).round() as u32);
        let inner = self::plan(studio, &local.scene, size, &[], number.wrapping_mul(NUMBERS), before, now)?;
        plan.views.insert(one.index, Inner { local, size, plan: inner });
    }
    Ok(Some(plan))
}

impl Plan {
    fn of(&self, id: u32) -> Option<&Shown> {
        self.shown.iter().find(|one| one.index as u32 == id)
    }

    fn paint(&self, studio: &mut Studio, request: &Request, kept: &mut Vec<u64>) -> Result<Overlays, RenderError> {
        let mut painter = Painter::new(self.em);
        painter.put(&self.moving);
        self.lines(studio, &mut painter, kept)?;
        let mut figures = Vec::new();
        for placement in &self.placed.placements {
            let Some(one) = self.of(placement.id) else { continue };
            figures.push(self.overlay(studio, request, &mut painter, one, placement.rect, kept)?);
        }
        for one in &self.shown {
            let style = one.overlay.line.as_ref().filter(|style| style.outside == Outside::Arrow);
            let Some(style) = style else { continue };
            for place in one.places.iter().filter(|place| place.focus.is_none()) {
                if let Some(arrow) = border_arrow(self.size, 0.4 * f64::from(self.em), place.direction) {
                    painter.arrow(arrow.tip, arrow.direction, style.color.unwrap_or(one.color));
                }
            }
        }
        for marker in &self.placed.markers {
            painter.marker(marker.at, marker.overlays.len());
        }
        Ok(Overlays { furniture: Furniture { pieces: painter.into_pieces() }, figures })
    }

    fn lines(&self, studio: &mut Studio, painter: &mut Painter, kept: &mut Vec<u64>) -> Result<(), RenderError> {
        for line in &self.placed.lines {
            let Some(one) = self.of(line.overlay) else { continue };
            let Some(style) = &one.overlay.line else { continue };
            let place = one.places.iter().filter(|p| p.focus.is_some()).nth(line.anchor);
            let skin = self.image(studio, one, paint::Part::Skin, style.skin.as_deref(), None, kept)?;
            let is_far = place.is_some_and(|p| style.arrow_distance_m.is_some_and(|most| p.distance > most));
            painter.line(&line.points, style, one.color, skin, is_far, self.size);
            if let (false, Some(focus)) = (is_far, place.and_then(|p| p.focus.as_ref())) {
                painter.focus(focus, style, one.color);
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
        kept: &mut Vec<u64>,
    ) -> Result<Option<u64>, RenderError> {
        let Some(file) = file else { return Ok(None) };
        let number = paint::number(self.numbers, one.index, part);
        kept.push(number);
        studio.renderer.image_of_file(number, file, size).map_err(|error| wrong(&one.name, &error))?;
        Ok(Some(number))
    }

    fn overlay(
        &self,
        studio: &mut Studio,
        request: &Request,
        painter: &mut Painter,
        one: &Shown,
        rect: Rect,
        kept: &mut Vec<u64>,
    ) -> Result<OverlayFigures, RenderError> {
        let room = paint::picture_room(&one.overlay, rect, self.em);
        let number = paint::number(self.numbers, one.index, paint::Part::Picture);
        let inner = self.views.get(&one.index);
        let (mut rendered, mut passes) = (false, Vec::new());
        match (&one.best_view.depiction, inner) {
            (Depiction::Text(text), _) => {
                painter.text(&one.overlay, rect, text);
                return Ok(OverlayFigures {
                    lens: one.index as u32,
                    at: room.low,
                    size: room.size(),
                    rendered,
                    passes,
                });
            }
            (Depiction::Image(file), _) => {
                kept.push(number);
                let read = studio.renderer.image_of_file(number, file, Some(room.size()));
                rendered = read.map_err(|error| wrong(&one.name, &error))?;
            }
            (Depiction::View(_), None) => {}
            (Depiction::View(_), Some(inner)) => {
                kept.push(number);
                let asked = Request {
                    size: inner.size,
                    transparent: inner.local.transparent,
                    aovs: Aovs::default(),
                    statistics: false,
                    ..*request
                };
                let over = match &inner.plan {
                    Some(plan) => plan.paint(studio, &asked, kept)?,
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
            self.image(studio, one, paint::Part::Alpha, alpha, Some(room.size()), kept)?,
            self.image(studio, one, paint::Part::Frame, frame, Some(room.size()), kept)?,
        ];
        let local = inner.map(|inner| &inner.local);
        let mirror = local.is_some_and(|local| local.mirror);
        let magnification = local.map_or(1.0, |local| local.magnification) as f32;
        painter.overlay(&one.overlay, rect, Content { image: number, mirror, magnification, masks });
        if let (Some(view), Some(local)) = (one.best_view.view(), local) {
            painter.signs(&one.overlay, view, local, &self.camera, room);
        }
        Ok(OverlayFigures { lens: one.index as u32, at: room.low, size: room.size(), rendered, passes })
    }
}

/// What of a scene its picture without furniture is made of: nothing moves in it, nor has it points of interest that no lens asks for. It
/// stays the same where only they are others.
fn at_its_moment(scene: &Scene) -> Scene {
    let mut own = scene.clone();
    (own.trajectories, own.time_s) = (Vec::new(), 0.0);
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

/// Whether a view is of an object that the city does not have; the scene's warnings tell so.
fn is_of_nothing(studio: &Studio, scene: &Scene, best_view: &BestView) -> bool {
    let first = best_view.pois.first().and_then(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let is_missing = |poi: &Poi| matches!(&poi.place, PoiPlace::Object(id) if studio.model.find_object(id).is_none());
    best_view.view().is_some_and(LocalView::is_of_poi) && first.is_some_and(is_missing)
}

/// What of a lens's overlay depends on the eye; `None`: it has no overlay, or that would show nothing.
fn seen(studio: &Studio, scene: &Scene, view: &View, index: usize, lens: &Lens) -> Option<Shown> {
    let best_view = lens.best_view.clone().filter(|own| lens.enabled && !is_of_nothing(studio, scene, own))?;
    let overlay =
        scene.overlays.iter().find(|o| o.lens == lens.name).cloned().unwrap_or_else(|| Overlay::of(&lens.name));
    let to_area = overlay.line.as_ref().is_some_and(|line| line.to == LineEnd::Area);
    let pois = best_view.pois.iter().filter_map(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let places = pois.filter_map(|poi| place(studio, scene, view, poi, to_area)).collect();
    Some(Shown { index, name: lens.name.clone(), color: lens.color, best_view, overlay, places })
}

fn place(studio: &Studio, scene: &Scene, view: &View, poi: &Poi, to_area: bool) -> Option<Place> {
    let anchor = || anchor(&Placement::Poi(poi.name.clone()), scene, &studio.model).ok().flatten();
    let at = match &poi.place {
        PoiPlace::Object(id) => studio.middle(id).ok().or_else(anchor)?,
        PoiPlace::At(_) | PoiPlace::On(_) => anchor()?,
    };
    let from_eye = at - view.camera.eye;
    let direction = DVec2::new(from_eye.dot(view.basis.right), -from_eye.dot(view.basis.up));
    let [w, h] = view.size.map(f64::from);
    let is_seen = |p: &DVec3| p.z > view.camera.near_m && (0.0..=w).contains(&p.x) && (0.0..=h).contains(&p.y);
    let pixel = view.pixel(at).filter(is_seen).map(|p| p.truncate());
    let focus = pixel.map(|pixel| match &poi.place {
        PoiPlace::Object(id) if to_area => area(studio, view, id).map_or(Focus::Point(pixel), Focus::Area),
        _ => Focus::Point(pixel),
    });
    Some(Place { focus, direction, distance: from_eye.length() })
}

/// The outline of an object and its parts in the picture: the convex hull of their corners; `None` where some of it is not before the eye.
fn area(studio: &Studio, view: &View, id: &str) -> Option<Vec<DVec2>> {
    let model = &*studio.model;
    let root = model.find_object(id)?;
    let roots = model.roots();
    let mut corners = Vec::new();
    for &geometry in &studio.geometries {
        let geometry = &model.geometries[geometry as usize];
        let is_own = geometry.object == root || roots[geometry.object as usize] == root;
        if !is_own {
            continue;
        }
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            for vertex in tile.vertices.clone() {
                let pixel = view.pixel(model.position(tile, vertex)).filter(|p| p.z > view.camera.near_m)?;
                corners.push([pixel.x, pixel.y].map(|v| (v * 256.0).round().clamp(-1e8, 1e8) as i64));
            }
        }
    }
    let hull = outline::convex(corners);
    (hull.len() >= 3).then(|| hull.into_iter().map(|[x, y]| DVec2::new(x as f64, y as f64) / 256.0).collect())
}

/// What an overlay prefers: a card is no higher than its text.
fn preferred_size(one: &Shown, em: f32) -> [u32; 2] {
    let [width, height] = one.overlay.size;
    match &one.best_view.depiction {
        Depiction::Text(text) => [width, height.min(paint::text_height(text, width, em))],
        _ => [width, height],
    }
}

/// What the layout is asked.
fn layout_of(
    studio: &Studio,
    scene: &Scene,
    view: &View,
    shown: &[Shown],
    blocked: &[Rect],
    em: f32,
) -> overlay::Request {
    let layout = &scene.layout;
    let size = |side: [u32; 2]| DVec2::new(side[0].into(), side[1].into());
    let overlays = shown.iter().map(|one| {
        let focuses: Vec<Focus> = one.places.iter().filter_map(|place| place.focus.clone()).collect();
        let preferred = size(preferred_size(one, em));
        overlay::Overlay {
            id: one.index as u32,
            priority: one.overlay.priority,
            min: one.overlay.min.map_or(0.5 * preferred, size),
            preferred,
            max: one.overlay.max.map_or(1.5 * preferred, size),
            anchors: if one.overlay.line.is_some() { focuses } else { Vec::new() },
            lines: match one.overlay.line.as_ref().map(|line| line.kind).unwrap_or_default() {
                LineKind::Straight => overlay::LineKind::Straight,
                LineKind::Orthogonal => overlay::LineKind::Orthogonal,
                LineKind::Curved => overlay::LineKind::Curved,
            },
            weight: one.overlay.interest,
            distance: one.places.iter().map(|place| place.distance).fold(f64::INFINITY, f64::min).min(1e9),
        }
    });
    let avoid = scene.pois.iter().filter_map(|poi| match place(studio, scene, view, poi, false)?.focus? {
        Focus::Point(at) => Some(at),
        Focus::Area(_) => None,
    });
    let (arrangement, along) = match layout.along {
        Along::Top => (overlay::Arrangement::Horizontal(overlay::Align::First), overlay::Along::Even),
        Along::Bottom => (overlay::Arrangement::Horizontal(overlay::Align::Last), overlay::Along::Even),
        Along::Left => (overlay::Arrangement::Vertical(overlay::Align::First), overlay::Along::Even),
        Along::Right => (overlay::Arrangement::Vertical(overlay::Align::Last), overlay::Along::Even),
        Along::Sides => (overlay::Arrangement::Vertical(overlay::Align::Both), overlay::Along::Even),
        Along::Border => (overlay::Arrangement::Border, overlay::Along::Even),
    };
    let [w, h] = view.size.map(f64::from);
    overlay::Request {
        picture: view.size,
        overlays: overlays.collect(),
        avoid: avoid.collect(),
        clearance: CLEARANCE_PX * f64::from(em) / 13.0,
        blocked: blocked.to_vec(),
        layout: overlay::Layout {
            arrangement,
            along,
            size: match layout.sizes {
                Sizes::Preferred => overlay::SizeRule::Preferred,
                Sizes::Distance => overlay::SizeRule::ByDistance,
                Sizes::Interest => overlay::SizeRule::ByInterest,
            },
            margin: layout.margin_px.round() as u32,
            gap: layout.gap_px.round() as u32,
            centre_of_interest: layout.exploration_focus.then(|| 0.5 * DVec2::new(w, h)),
            ..overlay::Layout::default()
        },
    }
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
