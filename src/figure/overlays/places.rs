//! Lenses with overlays in one picture, and where their points of interest are in it.

use glam::{DVec2, DVec3};

use crate::{
    geom::outline,
    lens::{BestView, Lens, Placement, best_view::LocalView, color::Srgb},
    overlay::Focus,
    render::{moved::Moved, picture::Studio},
    scene::{Overlay, Poi, PoiPlace, Scene, anchor::anchor, overlay::LineEnd},
    view::View,
};

/// A lens with an overlay in one picture.
pub(super) struct Shown {
    /// The number of the lens.
    pub index: usize,
    /// Its name.
    pub name: String,
    /// Its colour.
    pub color: Srgb,
    /// What its overlay shows.
    pub best_view: BestView,
    /// How that stands over the picture.
    pub overlay: Overlay,
    /// Its points of interest that have a place.
    pub places: Vec<Place>,
}

impl Shown {
    /// The ends of its context lines that are in the picture; none where it has no lines.
    pub fn focuses(&self) -> impl Iterator<Item = &Focus> {
        let places = if self.overlay.line.is_some() { &self.places[..] } else { &[] };
        places.iter().filter_map(|place| place.focus.as_ref())
    }
}

/// A point of interest as an overlay is tied to it.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Where it ends, if it is in the picture.
    pub focus: Option<Focus>,
    /// The middle of its object or itself, model coordinates.
    pub at: DVec3,
    /// From the lowest to the highest of its object, metres; both are those of `at` where it has none.
    pub heights_m: [f64; 2],
    /// Where it is, in the plane of the picture from its middle: x right, y down.
    pub direction: DVec2,
    /// How far from the eye, metres.
    pub distance: f64,
}

/// In the plane of the picture from its middle, x right, y down.
pub(super) fn direction(view: &View, at: DVec3) -> DVec2 {
    let from_eye = at - view.camera.eye;
    DVec2::new(from_eye.dot(view.basis.right), -from_eye.dot(view.basis.up))
}

/// Whether a view is of an object that the city does not have; the scene's warnings tell so.
fn is_of_nothing(studio: &Studio, scene: &Scene, best_view: &BestView) -> bool {
    let first = best_view.pois.first().and_then(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let is_missing = |poi: &Poi| matches!(&poi.place, PoiPlace::Object(id) if studio.model.find_object(id).is_none());
    best_view.view().is_some_and(LocalView::is_of_poi) && first.is_some_and(is_missing)
}

/// What of a lens's overlay depends on the eye; `None`: it has no overlay, or that would show nothing.
pub(super) fn seen(studio: &Studio, scene: &Scene, view: &View, index: usize, lens: &Lens) -> Option<Shown> {
    let best_view = lens.best_view().cloned().filter(|own| lens.enabled && !is_of_nothing(studio, scene, own))?;
    let overlay =
        scene.overlays.iter().find(|o| o.lens == lens.name).cloned().unwrap_or_else(|| Overlay::of(&lens.name));
    let to_area = overlay.line.as_ref().is_some_and(|line| line.to == LineEnd::Area);
    let pois = best_view.pois.iter().filter_map(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let places = pois.filter_map(|poi| place(studio, scene, view, poi, to_area)).collect();
    Some(Shown { index, name: lens.name.clone(), color: lens.color, best_view, overlay, places })
}

/// A point of interest of a view; `None`: it is nowhere.
pub(super) fn place(studio: &Studio, scene: &Scene, view: &View, poi: &Poi, to_area: bool) -> Option<Place> {
    let anchor = || anchor(&Placement::Poi(poi.name.clone()), scene, &studio.model).ok().flatten();
    let at = match &poi.place {
        PoiPlace::Object(id) => studio.middle(id).ok().or_else(anchor)?,
        PoiPlace::At(_) | PoiPlace::On(_) => anchor()?,
    };
    let moved = studio.moved(scene, view.size).ok()?;
    let heights_m = match &poi.place {
        PoiPlace::Object(id) => studio.model.find_object(id).map(|object| studio.model.family_bounds(object)),
        PoiPlace::At(_) | PoiPlace::On(_) => None,
    };
    let heights_m = heights_m.filter(|bounds| !bounds.is_empty()).map_or([at.z; 2], |b| [b.min.z, b.max.z]);
    // Where they are shown; a middle of several parts goes with the first that has a height of its own.
    let object = match &poi.place {
        PoiPlace::Object(id) => studio.model.find_object(id).map(|object| raised_part(studio, &moved, object)),
        PoiPlace::At(_) | PoiPlace::On(_) => None,
    };
    let heights_m = heights_m.map(|z| moved.place(object, at.truncate().extend(z)).z);
    let at = moved.place(object, at);
    let [w, h] = view.size.map(f64::from);
    let is_seen = |p: &DVec3| p.z > view.camera.near_m && (0.0..=w).contains(&p.x) && (0.0..=h).contains(&p.y);
    let pixel = view.pixel(at).filter(is_seen).map(|p| p.truncate());
    let focus = pixel.map(|pixel| match &poi.place {
        PoiPlace::Object(id) if to_area => area(studio, view, &moved, id).map_or(Focus::Point(pixel), Focus::Area),
        _ => Focus::Point(pixel),
    });
    let distance = at.distance(view.camera.eye);
    Some(Place { focus, at, heights_m, direction: direction(view, at), distance })
}

/// The part of an object whose height is changed, or the object.
fn raised_part(studio: &Studio, moved: &Moved, object: u32) -> u32 {
    let mut left = vec![object];
    while let Some(part) = left.pop() {
        if moved.heights.of(part).is_some() {
            return part;
        }
        // Children follow their parents in every city that is loaded.
        left.extend(studio.model.objects[part as usize].children.iter().copied().filter(|child| *child > part));
    }
    object
}

/// The outline of an object and its parts in the picture: the convex hull of their corners; `None` where some of it is
/// not before the eye.
fn area(studio: &Studio, view: &View, moved: &Moved, id: &str) -> Option<Vec<DVec2>> {
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
                let shown = moved.place(Some(geometry.object), model.position(tile, vertex));
                let pixel = view.pixel(shown).filter(|p| p.z > view.camera.near_m)?;
                corners.push([pixel.x, pixel.y].map(|v| (v * 256.0).round().clamp(-1e8, 1e8) as i64));
            }
        }
    }
    let hull = outline::convex(corners);
    (hull.len() >= 3).then(|| hull.into_iter().map(|[x, y]| DVec2::new(x as f64, y as f64) / 256.0).collect())
}
