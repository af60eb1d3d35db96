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

use glam::{DVec2, DVec3};

use crate::{
    figure::furniture::em_px,
    geom::outline,
    lens::{BestView, Lens, Placement, best_view::Depiction},
    overlay::{self, Focus, Placed, arrow::border_arrow},
    render::{
        furniture::Furniture,
        picture::{Aovs, RenderError, Request, Studio},
    },
    scene::{
        Overlay, Poi, PoiPlace, Scene,
        anchor::anchor,
        overlay::{Along, LineEnd, LineKind, Outside, Sizes},
    },
    view::View,
};

use paint::Painter;

/// How far overlays stay from points of interest, pixels.
const CLEARANCE_PX: f64 = 6.0;
/// How many numbers of images one view has for those over it.
const NUMBERS: u64 = 1 << 20;

/// What stands over a picture on account of its best-view lenses.
#[derive(Clone, Debug, Default)]
pub struct Overlays {
    /// To be drawn over it.
    pub furniture: Furniture,
    /// What each overlay is, for statistics.
    pub figures: Vec<OverlayFigures>,
    /// Where they stand; for the next frame.
    pub placed: Placed,
}

/// One overlay, for statistics.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverlayFigures {
    /// The number of its lens.
    pub lens: u32,
    /// Width and height of what it shows, pixels.
    pub size: [u32; 2],
    /// Whether it was drawn for this picture.
    pub rendered: bool,
}

/// A lens with an overlay in one picture.
struct Shown<'a> {
    index: usize,
    lens: &'a Lens,
    best_view: &'a BestView,
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

/// The overlays of a picture; the insets that they show are drawn where they are others than before.
///
/// # Errors
/// What a view of an overlay names and the city does not have, images that cannot be read, those of pictures.
pub fn overlays(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    before: Option<&Placed>,
) -> Result<Overlays, RenderError> {
    let mut kept = Vec::new();
    let made = overlays_of(studio, scene, request, before, 0, &mut kept)?;
    studio.keep_insets(|number| kept.contains(&number));
    Ok(made)
}

fn overlays_of(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    before: Option<&Placed>,
    numbers: u64,
    kept: &mut Vec<u64>,
) -> Result<Overlays, RenderError> {
    if !scene.moves() && !scene.lenses.iter().any(|lens| lens.enabled && lens.best_view.is_some()) {
        return Ok(Overlays::default());
    }
    let camera = studio.camera(scene, request.size);
    let view = View::new(camera, request.size, &studio.extent())?;
    let shown: Vec<Shown> =
        scene.lenses.iter().enumerate().filter_map(|(i, lens)| seen(studio, scene, &view, i, lens)).collect();
    let asked = layout_of(studio, scene, &view, &shown, em_px(&scene.figure, request.size));
    let placed = overlay::place(&asked, before);
    let mut painter = Painter::new(em_px(&scene.figure, request.size));
    moving::paint(&mut painter, scene, &view);
    let of = |id: u32| shown.iter().find(|s| s.index as u32 == id);
    for line in &placed.lines {
        let Some(one) = of(line.overlay) else { continue };
        let Some(style) = &one.overlay.line else { continue };
        let place = &one.places.iter().filter(|p| p.focus.is_some()).nth(line.anchor);
        let number = paint::number(numbers, one.index, paint::Part::Skin);
        let skin = match &style.skin {
            None => None,
            Some(file) => {
                kept.push(number);
                studio.renderer.image_of_file(number, file, None).map_err(|e| wrong(one.lens, &e))?;
                Some(number)
            }
        };
        let is_far = place.is_some_and(|p| style.arrow_distance_m.is_some_and(|most| p.distance > most));
        painter.line(&line.points, style, one.lens.color, skin, is_far, request.size);
        if let (false, Some(focus)) = (is_far, place.and_then(|p| p.focus.as_ref())) {
            painter.focus(focus, style, one.lens.color);
        }
    }
    let mut figures = Vec::new();
    for placement in &placed.placements {
        let Some(one) = of(placement.id) else { continue };
        let number = paint::number(numbers, one.index, paint::Part::Picture);
        kept.push(number);
        let room = painter.picture_room(&one.overlay, placement.rect);
        let (mut rendered, mut mirror) = (false, false);
        match &one.best_view.depiction {
            Depiction::Text(text) => painter.text(&one.overlay, placement.rect, text),
            Depiction::Image(file) => {
                rendered =
                    studio.renderer.image_of_file(number, file, Some(room.size())).map_err(|e| wrong(one.lens, &e))?;
            }
            Depiction::View(view) => {
                let own = views::local(studio, scene, &camera, one.lens, one.best_view, view, room.size())?;
                let asked = Request {
                    size: room.size(),
                    transparent: own.transparent,
                    aovs: Aovs::default(),
                    statistics: false,
                    ..*request
                };
                let nested = overlays_of(studio, &own.scene, &asked, None, number * NUMBERS, kept)?;
                rendered = studio.inset(number, &at_its_moment(&own.scene), &asked, &nested.furniture)?;
                mirror = own.mirror;
            }
        }
        if !matches!(one.best_view.depiction, Depiction::Text(_)) {
            let mut masks = [None, None];
            for (mask, (part, file)) in masks.iter_mut().zip(paint::masks(&one.overlay.frame)) {
                let Some(file) = file else { continue };
                let number = paint::number(numbers, one.index, part);
                kept.push(number);
                studio.renderer.image_of_file(number, file, Some(room.size())).map_err(|e| wrong(one.lens, &e))?;
                *mask = Some(number);
            }
            painter.overlay(&one.overlay, placement.rect, number, mirror, masks);
            if let Depiction::View(view) = &one.best_view.depiction {
                painter.signs(view, &camera, room);
            }
        }
        figures.push(OverlayFigures { lens: one.index as u32, size: room.size(), rendered });
    }
    for one in &shown {
        let Some(style) = one.overlay.line.as_ref().filter(|style| style.outside == Outside::Arrow) else { continue };
        for place in one.places.iter().filter(|place| place.focus.is_none()) {
            if let Some(arrow) = border_arrow(request.size, 0.4 * f64::from(painter.em()), place.direction) {
                painter.arrow(arrow.tip, arrow.direction, style.color.unwrap_or(one.lens.color));
            }
        }
    }
    for marker in &placed.markers {
        painter.marker(marker.at, marker.overlays.len());
    }
    Ok(Overlays { furniture: Furniture { pieces: painter.into_pieces() }, figures, placed })
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

fn wrong(lens: &Lens, message: &str) -> RenderError {
    RenderError::Scene(format!("lens \"{}\": {message}", lens.name))
}

/// What of a lens's overlay depends on the eye; `None`: it has no overlay.
fn seen<'a>(studio: &Studio, scene: &Scene, view: &View, index: usize, lens: &'a Lens) -> Option<Shown<'a>> {
    let best_view = lens.best_view.as_ref().filter(|_| lens.enabled)?;
    let overlay =
        scene.overlays.iter().find(|o| o.lens == lens.name).cloned().unwrap_or_else(|| Overlay::of(&lens.name));
    let to_area = overlay.line.as_ref().is_some_and(|line| line.to == LineEnd::Area);
    let pois = best_view.pois.iter().filter_map(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let places = pois.filter_map(|poi| place(studio, scene, view, poi, to_area)).collect();
    Some(Shown { index, lens, best_view, overlay, places })
}

fn place(studio: &Studio, scene: &Scene, view: &View, poi: &Poi, to_area: bool) -> Option<Place> {
    let at = anchor(&Placement::Poi(poi.name.clone()), scene, &studio.model).ok().flatten()?;
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

/// What the layout is asked.
fn layout_of(studio: &Studio, scene: &Scene, view: &View, shown: &[Shown], em: f32) -> overlay::Request {
    let layout = &scene.layout;
    let size = |side: [u32; 2]| DVec2::new(side[0].into(), side[1].into());
    let lines = shown.iter().find_map(|one| one.overlay.line.as_ref().map(|line| line.kind)).unwrap_or_default();
    let overlays = shown.iter().map(|one| {
        let focuses: Vec<Focus> = one.places.iter().filter_map(|place| place.focus.clone()).collect();
        let preferred = size(one.overlay.size);
        overlay::Overlay {
            id: one.index as u32,
            priority: one.overlay.priority,
            min: one.overlay.min.map_or(0.5 * preferred, size),
            preferred,
            max: one.overlay.max.map_or(1.5 * preferred, size),
            anchors: if one.overlay.line.is_some() { focuses } else { Vec::new() },
            weight: one.overlay.interest,
            distance: one.places.iter().map(|place| place.distance).fold(f64::INFINITY, f64::min).min(1e9),
        }
    });
    let all: Vec<&str> = scene.pois.iter().map(|poi| poi.name.as_str()).collect();
    let avoid = scene.pois.iter().filter(|poi| all.contains(&poi.name.as_str()));
    let avoid = avoid.filter_map(|poi| match place(studio, scene, view, poi, false)?.focus? {
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
        lines: match lines {
            LineKind::Straight => overlay::LineKind::Straight,
            LineKind::Orthogonal => overlay::LineKind::Orthogonal,
            LineKind::Curved => overlay::LineKind::Curved,
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
