//! Focus areas that are made from polygons, images, files and the city itself: worked out once and kept.

use std::{path::Path, sync::Arc};

use glam::{DQuat, DVec3};

use crate::{
    city::{
        CityModel, Geometry,
        load::{self, LoadOptions},
        model::{Texture, TextureImage},
        shown::shown_geometries,
        texture,
    },
    geom::{
        Aabb, Volume,
        shape::{
            Mesh, Motion, PlacedSolid, Sightlines, Solid,
            solid::{self, Bitmap},
        },
    },
    lens::{
        chosen::{Choice, chosen},
        focus::Focus,
    },
};

/// Corners of city objects are put together where they are the same to this, metres: those of one object may lie in several
/// tiles, each rounded from its own origin.
const SAME_M: f64 = 1.0 / 2048.0;

/// Solids made so far, with what they were made from.
#[derive(Debug, Default)]
pub struct Solids {
    made: Vec<Made>,
}

#[derive(Debug)]
struct Made {
    /// Of a file at its own place: a lens that moves makes nothing anew.
    from: Focus,
    /// `None`: no object has a body.
    solid: Option<Arc<Solid>>,
    /// Where the solid's origin is in the coordinates of what it was made from.
    origin: DVec3,
    /// Whether it was asked for since the last [`Solids::forget_others`].
    is_wanted: bool,
}

/// The city that objects are taken from.
#[derive(Clone, Copy, Debug)]
pub struct ShownCity<'a> {
    /// The city.
    pub model: &'a CityModel,
    /// Its geometries that are shown.
    pub geometries: &'a [u32],
}

/// Where focus areas stand, and what flat ones are looked through along.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// From a lens' own coordinates to the model's.
    pub motion: Motion,
    /// The sight lines of the eye.
    pub sight: Sightlines,
}

/// The key of a focus area that is wrong (empty: the whole), and what would be right.
pub type FocusError = (&'static str, String);

impl Solids {
    /// The volumes whose union a focus area is, none where it holds nothing; a *thematic* one and a combination
    /// have none.
    pub fn volumes(&mut self, focus: &Focus, city: ShownCity, place: &Place) -> Result<Vec<Volume>, FocusError> {
        if let Some(wrong) = focus.check() {
            return Err(wrong);
        }
        let (at, rotation) = match focus {
            Focus::Shape(shape) => {
                return shape.placed(&place.motion, &place.sight).map_err(|error| ("", error.to_string()));
            }
            Focus::Thematic(_) | Focus::Combined { .. } => return Ok(Vec::new()),
            _ if focus.is_empty() => return Ok(Vec::new()),
            Focus::Mesh { at, rotation, .. } => (*at, *rotation),
            _ => (DVec3::ZERO, DQuat::IDENTITY),
        };
        let mut from = focus.clone();
        if let Focus::Mesh { at, rotation, .. } = &mut from {
            (*at, *rotation) = (DVec3::ZERO, DQuat::IDENTITY);
        }
        let index = match self.made.iter().position(|m| m.from == from) {
            Some(index) => index,
            None => {
                let (solid, origin) = made(&from, city)?;
                self.made.push(Made { from, solid: solid.map(Arc::new), origin, is_wanted: true });
                self.made.len() - 1
            }
        };
        let made = &mut self.made[index];
        made.is_wanted = true;
        let at = at + rotation * made.origin;
        let placed = |solid| Volume::Solid(PlacedSolid { solid, rotation, at }).placed(&place.motion);
        Ok(made.solid.clone().map(placed).into_iter().collect())
    }

    /// Drops what was not asked for since the last time.
    pub fn forget_others(&mut self) {
        self.made.retain(|m| m.is_wanted);
        self.made.iter_mut().for_each(|m| m.is_wanted = false);
    }
}

/// The solid of a focus area, and where its origin is; `None` where it has no body.
fn made(from: &Focus, city: ShownCity) -> Result<(Option<Solid>, DVec3), FocusError> {
    match from {
        Focus::Prism { points, holes, base, height } => {
            let rings: Vec<_> = std::iter::once(points).chain(holes).cloned().collect();
            let (low, high) = points
                .iter()
                .fold((glam::DVec2::INFINITY, glam::DVec2::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
            let origin = if low.is_finite() { low.midpoint(high).round().extend(*base) } else { DVec3::ZERO };
            let solid = solid::prism(&rings, *base, *height, origin).map_err(|e| ("points", e.to_string()))?;
            Ok((Some(solid), origin))
        }
        Focus::Mask { image, corner, size, base, height } => {
            let mask = bitmap(image).map_err(|e| ("image", e))?;
            let origin = (*corner + 0.5 * *size).extend(*base);
            let corner = [corner.extend(*base), size.extend(*height)];
            let solid = solid::stacked(&[mask], corner, origin).map_err(|e| ("image", e.to_string()))?;
            Ok((Some(solid), origin))
        }
        Focus::Mask3d { images, corner, size } => {
            let layers: Result<Vec<_>, _> = images.iter().map(|image| bitmap(image)).collect();
            let layers = layers.map_err(|e| ("images", e))?;
            let origin = *corner + 0.5 * *size;
            let solid = solid::stacked(&layers, [*corner, *size], origin).map_err(|e| ("images", e.to_string()))?;
            Ok((Some(solid), origin))
        }
        Focus::Mesh { file, scale, .. } => {
            let folder = file.parent().map(Path::to_owned).into_iter().collect();
            let options = LoadOptions { allow_outside: false, roots: folder };
            let loaded = load::load(std::slice::from_ref(file), &options, &load::Quiet);
            let model = loaded.map_err(|e| ("file", e.to_string()))?;
            let geometries = shown_geometries(&model, None);
            let bodies = bodies(ShownCity { model: &model, geometries: &geometries }, |_| true, *scale);
            let origin = middle(&bodies);
            let solid = Solid::new(&bodies, origin).map_err(|e| ("file", format!("{}: {e}", file.display())))?;
            Ok((Some(solid), origin))
        }
        Focus::Objects(choice) => {
            let chosen = chosen(city.model, choice).map_err(|e| (key_of(choice), e.to_string()))?;
            let bodies = bodies(city, |object| chosen.objects[object as usize], 1.0);
            if bodies.is_empty() {
                return Ok((None, DVec3::ZERO));
            }
            let origin = middle(&bodies);
            let solid = Solid::new(&bodies, origin).map_err(|e| (key_of(choice), e.to_string()))?;
            Ok((Some(solid), origin))
        }
        Focus::Shape(_) | Focus::Thematic(_) | Focus::Combined { .. } => Ok((None, DVec3::ZERO)),
    }
}

/// The key by which a choice chooses.
pub fn key_of(choice: &Choice) -> &'static str {
    if choice.ids.is_empty() { "attribute" } else { "ids" }
}

/// The bodies of the shown geometries whose object is wanted, each closed by itself.
fn bodies(city: ShownCity, is_wanted: impl Fn(u32) -> bool, scale: f64) -> Vec<Mesh> {
    let model = city.model;
    let geometries = city.geometries.iter().map(|&g| &model.geometries[g as usize]);
    let body = |geometry: &Geometry| {
        let mut mesh = Mesh::default();
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            let first = mesh.points.len() as u32;
            let corners = tile.vertices.clone().map(|vertex| model.position(tile, vertex) * scale);
            mesh.points.extend(corners.map(|p| (p / SAME_M).round() * SAME_M));
            let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
            mesh.triangles.extend(indices.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(|i| first + i)));
        }
        mesh
    };
    let wanted = geometries.filter(|g| is_wanted(g.object)).map(body);
    wanted.filter(|mesh| !mesh.triangles.is_empty()).collect()
}

/// Whole metres near the middle of some bodies.
fn middle(bodies: &[Mesh]) -> DVec3 {
    let bounds = Aabb::from_points(bodies.iter().flat_map(|b| &b.points).copied());
    if bounds.is_empty() { DVec3::ZERO } else { bounds.center().round() }
}

/// An image as a mask: where it is opaque and at least as light as mid grey.
fn bitmap(path: &Path) -> Result<Bitmap, String> {
    let texture = Texture { image: TextureImage::File(path.to_owned()), wrap: Default::default() };
    let pixels = texture::decode(&texture)?;
    if let Some([w, h]) = pixels.reduced_from {
        return Err(format!("{} has {w}x{h} pixels; a mask takes {} per side", path.display(), texture::MAX_SIDE));
    }
    let is_in = |p: &[u8; 4]| {
        let [r, g, b, a] = p.map(u32::from);
        // Rec. 709, of the encoded values, in thousandths.
        a >= 128 && 213 * r + 715 * g + 72 * b >= 128_000
    };
    Ok(Bitmap { size: pixels.size(0), bits: pixels.levels[0].as_chunks().0.iter().map(is_in).collect() })
}

#[cfg(test)]
mod tests;
