//! Lenses with overlays in one picture, and where their points of interest are in it.

use glam::{DVec2, DVec3};

use crate::{
    figure::{
        furniture::em_px,
        overlays::{paint, words},
    },
    geom::{exact::twice_area, outline},
    lens::{
        BestView, Lens, Placement,
        best_view::{Depiction, LocalView},
        color::Srgb,
    },
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
    /// Its preferred size in the picture, pixels.
    pub size: [u32; 2],
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
    /// The outline of its object in the picture, outer rings and holes, pixels; of one that lines end at the area of.
    pub outline: Vec<Vec<DVec2>>,
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
    let mut best_view = lens.best_view().cloned().filter(|own| lens.enabled && !is_of_nothing(studio, scene, own))?;
    let mut overlay =
        scene.overlays.iter().find(|o| o.lens == lens.name).cloned().unwrap_or_else(|| Overlay::of(&lens.name));
    overlay.caption = overlay.caption.map(|caption| words::filled(&studio.model, scene, &best_view, &caption));
    if let Depiction::Text(text) = &best_view.depiction {
        best_view.depiction = Depiction::Text(words::filled(&studio.model, scene, &best_view, text));
    }
    let to_area = overlay.line.as_ref().is_some_and(|line| line.to == LineEnd::Area);
    let pois = best_view.pois.iter().filter_map(|name| scene.pois.iter().find(|poi| poi.name == *name));
    let places = pois.filter_map(|poi| place(studio, scene, view, poi, to_area)).collect();
    let size = size_of(scene, view, &overlay, &best_view);
    Some(Shown { index, name: lens.name.clone(), color: lens.color, best_view, overlay, size, places })
}

/// Text of a card that has no size of its own has so many ems of room beside each other, where the picture is so small that a share of it has less.
const CARD_EMS: f32 = 14.0;
/// What words make an overlay larger to, as a part of the picture's width and height.
const MOST_FOR_WORDS: f64 = 0.45;

/// The preferred size of an overlay, pixels: that of its scene, but that one which goes by a share of a small picture has room for its words.
fn size_of(scene: &Scene, view: &View, overlay: &Overlay, shown: &BestView) -> [u32; 2] {
    let size = overlay.size_in(view.size);
    if overlay.size.is_some() {
        return size;
    }
    let em = em_px(&scene.figure, view.size);
    let most = view.size.map(|side| (MOST_FOR_WORDS * f64::from(side)) as u32);
    match &shown.depiction {
        Depiction::Text(text) => {
            let width = size[0].max(most[0].min((CARD_EMS * em) as u32));
            [width, size[1].max(most[1].min(paint::text_height(text, width, em)))]
        }
        Depiction::Image(_) | Depiction::View(_) => {
            let caption = overlay.caption.as_ref().map_or(0.0, |caption| paint::caption_width(caption, em));
            let width = size[0].max(most[0].min(caption.ceil() as u32));
            [width, (f64::from(width) / Overlay::ASPECT).round() as u32]
        }
    }
}

/// A point of interest of a view; `None`: it is nowhere.
pub(super) fn place(studio: &Studio, scene: &Scene, view: &View, poi: &Poi, to_area: bool) -> Option<Place> {
    let anchor = || anchor(&Placement::Poi(poi.name.clone()), scene, &studio.model).ok().flatten();
    let at = match &poi.place {
        PoiPlace::Object(id) => studio.bulk(id).ok().map(|bulk| bulk.middle).or_else(anchor)?,
        PoiPlace::At(_) | PoiPlace::AboveGround(_) | PoiPlace::On(_) => anchor()?,
    };
    let moved = studio.moved(scene, view.size).ok()?;
    let heights_m = match &poi.place {
        PoiPlace::Object(id) => studio.model.find_object(id).map(|object| studio.model.family_bounds(object)),
        PoiPlace::At(_) | PoiPlace::AboveGround(_) | PoiPlace::On(_) => None,
    };
    let heights_m = heights_m.filter(|bounds| !bounds.is_empty()).map_or([at.z; 2], |b| [b.min.z, b.max.z]);
    // Where they are shown; a middle of several parts goes with the first that has a height of its own.
    let object = match &poi.place {
        PoiPlace::Object(id) => studio.model.find_object(id).map(|object| raised_part(studio, &moved, object)),
        PoiPlace::At(_) | PoiPlace::AboveGround(_) | PoiPlace::On(_) => None,
    };
    let heights_m = heights_m.map(|z| moved.place(object, at.truncate().extend(z)).z);
    let at = moved.place(object, at);
    let [w, h] = view.size.map(f64::from);
    let is_seen = |p: &DVec3| p.z > view.camera.near_m && (0.0..=w).contains(&p.x) && (0.0..=h).contains(&p.y);
    let pixel = view.pixel(at).filter(is_seen).map(|p| p.truncate());
    let outline = match &poi.place {
        PoiPlace::Object(id) if to_area && pixel.is_some() => outline_of(studio, view, &moved, id),
        _ => Vec::new(),
    };
    // A line ends at the first ring: that of the largest part.
    let focus = pixel.map(|pixel| outline.first().map_or(Focus::Point(pixel), |ring| Focus::Area(ring.clone())));
    let distance = at.distance(view.camera.eye);
    Some(Place { focus, outline, at, heights_m, direction: direction(view, at), distance })
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

/// Steps of the lattice of outlines per pixel: corners are off by a thirty-second of a pixel at most.
const STEPS: f64 = 16.0;
/// Objects of more triangles than this have their convex hull as an outline: the union would take seconds.
const MOST_TRIANGLES: usize = 20_000;

/// The outline of an object and its parts in the picture: rings around all that its faces cover, first the outer one of the largest part.
/// Empty where some of it is not before the eye.
fn outline_of(studio: &Studio, view: &View, moved: &Moved, id: &str) -> Vec<Vec<DVec2>> {
    triangles(studio, view, moved, id).map_or_else(Vec::new, rings)
}

/// The rings around what triangles cover, in steps of the lattice; pixels.
fn rings(triangles: Vec<[[i64; 2]; 3]>) -> Vec<Vec<DVec2>> {
    let mut parts = if triangles.len() <= MOST_TRIANGLES { outline::union(&triangles) } else { Vec::new() };
    if parts.is_empty() {
        let hull = outline::convex(triangles.concat());
        parts.extend((hull.len() >= 3).then(|| vec![hull]));
    }
    parts.sort_by_key(|part| part.first().map_or(0, |ring| -twice_area(ring.iter().copied()).abs()));
    let pixels = |ring: Vec<[i64; 2]>| ring.into_iter().map(|[x, y]| DVec2::new(x as f64, y as f64) / STEPS).collect();
    parts.into_iter().flatten().map(pixels).collect()
}

/// The faces of an object and its parts in the picture, [`STEPS`] of a pixel; `None` where some of them is not before the eye.
fn triangles(studio: &Studio, view: &View, moved: &Moved, id: &str) -> Option<Vec<[[i64; 2]; 3]>> {
    let model = &*studio.model;
    let root = model.find_object(id)?;
    let roots = model.roots();
    let is_own = |object: u32| object == root || roots[object as usize] == root;
    let own = studio.geometries.iter().map(|&g| &model.geometries[g as usize]).filter(|g| is_own(g.object));
    let mut all = Vec::new();
    for geometry in own {
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            for triangle in tile.indices.start / 3..tile.indices.end / 3 {
                let mut corners = [[0; 2]; 3];
                for (corner, at) in corners.iter_mut().zip(model.corners(tile, triangle)) {
                    let shown = moved.place(Some(geometry.object), at);
                    let pixel = view.pixel(shown).filter(|p| p.z > view.camera.near_m)?;
                    *corner = [pixel.x, pixel.y].map(|v| (v * STEPS).round().clamp(-1e8, 1e8) as i64);
                }
                all.push(corners);
            }
        }
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles over a rectangle, pixels.
    fn rectangle([x, y, w, h]: [i64; 4]) -> [[[i64; 2]; 3]; 2] {
        let at = |i: i64, j: i64| [x + i * w, y + j * h].map(|v| v * STEPS as i64);
        [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]
    }

    fn area(ring: &[DVec2]) -> f64 {
        let ends = ring.iter().zip(ring.iter().cycle().skip(1));
        0.5 * ends.map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    }

    #[test]
    fn outlines_have_notches_courts_and_parts() {
        // A block with a notch, whose walls lie over each other: its hull would have 100 by 60 pixels.
        let notched = [[0, 0, 100, 20], [0, 0, 30, 60], [5, 5, 20, 50], [70, 0, 30, 60]].map(rectangle).concat();
        let found = rings(notched);
        assert_eq!((found.len(), area(&found[0]).abs()), (1, 2000.0 + 2.0 * 1200.0));
        // A court is a ring of its own, and what is apart, too; the largest part comes first.
        let court = [[0, 0, 100, 20], [0, 40, 100, 20], [0, 0, 20, 60], [80, 0, 20, 60], [200, 0, 30, 30]];
        let found = rings(court.map(rectangle).concat());
        assert_eq!(found.iter().map(|ring| area(ring).abs()).collect::<Vec<_>>(), [6000.0, 60.0 * 20.0, 900.0]);
    }
}
