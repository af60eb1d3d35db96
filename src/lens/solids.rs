//! Region areas that are made from polygons, images, files and the city itself: worked out once and kept.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use glam::{DQuat, DVec3};
use rustc_hash::FxHashMap;

use crate::{
    city::{
        CityModel, Geometry,
        load::{self, LoadOptions},
        model::{Texture, TextureImage, TextureOpacity},
        shown::shown_geometries,
        spatial::SpatialIndex,
        texture,
    },
    geom::{
        Aabb, Volume,
        deform::{
            Deformers,
            refine::{Limits, refined},
        },
        shape::{
            Hull, Mesh, Motion, PlacedSolid, Sightlines, Solid,
            error::ShapeError,
            solid::{self, Bitmap},
        },
    },
    lens::{
        chosen::members,
        region::Region,
        sprite_file,
        sprite_volume::{PlacedSprite, SpriteVolume},
    },
};

/// Corners of a body are put together where they are the same to this, metres, at the place of one of them: those of one object
/// may lie in several tiles, each rounded from its own origin.
const SAME_M: f64 = 1.0 / 2048.0;

/// Solids made so far, with what they were made from.
#[derive(Debug, Default)]
pub struct Solids {
    made: Vec<Made>,
    hulls: Vec<MadeOfHull>,
    moved: Vec<MadeByMoving>,
    sprites: Vec<ReadSprite>,
}

/// A depth sprite of a file.
#[derive(Debug)]
struct ReadSprite {
    file: PathBuf,
    sprite: Arc<SpriteVolume>,
    is_wanted: bool,
}

/// A solid of a convex polytope.
#[derive(Debug)]
struct MadeOfHull {
    /// Its triangles.
    triangles: Vec<[DVec3; 3]>,
    solid: Arc<Solid>,
    is_wanted: bool,
}

/// A volume that deformations moved.
#[derive(Debug)]
struct MadeByMoving {
    from: Volume,
    deformers: Arc<Deformers>,
    /// `None`: rounding leaves nothing of it.
    placed: Option<PlacedSolid>,
    is_wanted: bool,
}

/// How far the surface of a moved volume may be from where it should be, by its largest side.
const MOVED_ERROR: f64 = 1.0 / 1024.0;
/// Sides of round volumes that are moved.
const MOVED_SEGMENTS: u32 = 96;
/// Faces of one.
const MOVED_FACES: usize = 1 << 17;

#[derive(Debug)]
struct Made {
    /// Of a file at its own place: a lens that moves makes nothing anew.
    from: Region,
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
    /// Finds their triangles; made when first asked for.
    pub index: &'a OnceLock<SpatialIndex>,
    /// Tells cities apart that show the same objects elsewhere ([`Self::numbered`]).
    pub number: u64,
}

impl<'a> ShownCity<'a> {
    /// The number of a city that timetables show as the so-manieth; those that follow, up to the next, are of where deformations show it.
    pub fn numbered(stance: u64) -> u64 {
        stance << 32
    }

    /// The number of the same where nothing deforms it.
    pub fn undeformed(number: u64) -> u64 {
        number >> 32 << 32
    }

    /// What finds the triangles that are shown.
    pub fn index(&self) -> &'a SpatialIndex {
        self.index.get_or_init(|| SpatialIndex::build(self.model, self.geometries))
    }
}

/// Where focus areas stand, and what flat ones are looked through along.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// From a lens' own coordinates to the model's.
    pub motion: Motion,
    /// The sight lines of the eye.
    pub sight: Sightlines,
}

/// The way to the key of a focus area that is wrong (empty: the whole), and what would be right.
pub type RegionError = (String, String);

impl Solids {
    /// The volumes whose union a focus area is, none where it holds nothing; one by object, a depth sprite and a
    /// combination have none.
    pub fn volumes(&mut self, region: &Region, city: ShownCity, place: &Place) -> Result<Vec<Volume>, RegionError> {
        if let Some(wrong) = region.check() {
            return Err((wrong.0.to_owned(), wrong.1));
        }
        let (at, rotation) = match region {
            Region::Shape(shape) => {
                return shape.placed(&place.motion, &place.sight).map_err(|error| (String::new(), error.to_string()));
            }
            Region::Thematic(_)
            | Region::Enclosed { .. }
            | Region::Occluders(_)
            | Region::Case { .. }
            | Region::Sprite { .. }
            | Region::Own { .. }
            | Region::Magnified { .. }
            | Region::Combined { .. } => {
                return Ok(Vec::new());
            }
            _ if region.is_empty() => return Ok(Vec::new()),
            Region::Mesh { at, rotation, .. } => (*at, *rotation),
            _ => (DVec3::ZERO, DQuat::IDENTITY),
        };
        let mut from = region.clone();
        if let Region::Mesh { at, rotation, .. } = &mut from {
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

    /// The depth sprite of a file where a lens has it, read when it is first asked for.
    pub fn sprite(&mut self, file: &Path, city: ShownCity, motion: &Motion) -> Result<PlacedSprite, RegionError> {
        let index = match self.sprites.iter().position(|s| s.file == file) {
            Some(index) => index,
            None => {
                let sprite = sprite_file::read(file).map_err(|message| ("file".to_owned(), message))?;
                let sprite = Arc::new(sprite);
                self.sprites.push(ReadSprite { file: file.to_owned(), sprite, is_wanted: true });
                self.sprites.len() - 1
            }
        };
        let read = &mut self.sprites[index];
        read.is_wanted = true;
        if let (Some(own), Some(of_city)) = (&read.sprite.crs, &city.model.crs)
            && own != of_city
        {
            let file = file.display();
            return Err(("file".into(), format!("{file} has coordinates of {own}, the city those of {of_city}")));
        }
        Ok(PlacedSprite::new(read.sprite.clone(), motion))
    }

    /// A convex polytope as a solid; `None` where rounding leaves nothing of it.
    pub fn of_hull(&mut self, hull: &Hull) -> Option<PlacedSolid> {
        let (at, triangles) = (hull.planes().0, hull.triangles());
        let made = match self.hulls.iter_mut().position(|m| m.triangles == triangles) {
            Some(index) => &mut self.hulls[index],
            None => {
                let points = triangles.iter().flatten().copied().collect();
                let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                let solid = Solid::new(&[Mesh { points, triangles: indices }], DVec3::ZERO).ok()?;
                self.hulls.push(MadeOfHull { triangles, solid: Arc::new(solid), is_wanted: true });
                self.hulls.last_mut()?
            }
        };
        made.is_wanted = true;
        Some(PlacedSolid { solid: made.solid.clone(), rotation: DQuat::IDENTITY, at })
    }

    /// A volume where deformations take it, as a solid; `None` where rounding leaves nothing of it.
    ///
    /// # Errors
    /// A volume without an end, or without an inside.
    pub fn moved(&mut self, volume: &Volume, deformers: &Arc<Deformers>) -> Result<Option<PlacedSolid>, &'static str> {
        if !volume.is_bounded() || matches!(volume, Volume::Flat(_)) {
            return Err(
                "a focus area of the city at rest (space = \"rest\") needs an inside with an end: flat ones have none",
            );
        }
        let is_same = |made: &MadeByMoving| made.from == *volume && made.deformers == *deformers;
        let at = self.moved.iter().position(is_same).unwrap_or_else(|| {
            let placed = moved_solid(volume, deformers);
            let made = MadeByMoving { from: volume.clone(), deformers: deformers.clone(), placed, is_wanted: true };
            self.moved.push(made);
            self.moved.len() - 1
        });
        self.moved[at].is_wanted = true;
        Ok(self.moved[at].placed.clone())
    }

    /// Drops what was not asked for since the last time.
    pub fn forget_others(&mut self) {
        self.moved.retain(|m| m.is_wanted);
        self.moved.iter_mut().for_each(|m| m.is_wanted = false);
        self.hulls.retain(|m| m.is_wanted);
        self.hulls.iter_mut().for_each(|m| m.is_wanted = false);
        self.sprites.retain(|s| s.is_wanted);
        self.sprites.iter_mut().for_each(|s| s.is_wanted = false);
        self.made.retain(|m| m.is_wanted);
        self.made.iter_mut().for_each(|m| m.is_wanted = false);
    }
}

/// The surface of a volume, fine enough to follow deformations, where they take it.
fn moved_solid(volume: &Volume, deformers: &Deformers) -> Option<PlacedSolid> {
    let Mesh { points, triangles } = volume.surface_mesh(MOVED_SEGMENTS);
    let tolerance_m = MOVED_ERROR * volume.bounds().size().max_element();
    let limits = Limits { triangles: MOVED_FACES, ..Limits::default() };
    let fine = refined(&points, &triangles, deformers, &|_| 1.0, tolerance_m, limits);
    let kept = fine.kept.iter().map(|&i| triangles[i as usize].map(|k| points[k as usize]));
    let moved = fine.triangles.iter().map(|corners| corners.map(|i| fine.vertices[i as usize].shown));
    let corners: Vec<DVec3> = kept.chain(moved).flatten().collect();
    let indices = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let at = Aabb::from_points(corners.iter().copied()).center().round();
    let solid = Solid::new(&[Mesh { points: corners, triangles: indices }], at).ok()?;
    Some(PlacedSolid { solid: Arc::new(solid), rotation: DQuat::IDENTITY, at })
}

/// The solid of a focus area, and where its origin is; `None` where it has no body.
fn made(from: &Region, city: ShownCity) -> Result<(Option<Solid>, DVec3), RegionError> {
    match from {
        Region::Prism { points, holes, base, height } => {
            let rings: Vec<_> = std::iter::once(points).chain(holes).cloned().collect();
            let (low, high) = points
                .iter()
                .fold((glam::DVec2::INFINITY, glam::DVec2::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
            let origin = if low.is_finite() { low.midpoint(high).round().extend(*base) } else { DVec3::ZERO };
            let solid = solid::prism(&rings, *base, *height, origin).map_err(|e| ("points".into(), e.to_string()))?;
            Ok((Some(solid), origin))
        }
        Region::Mask { image, corner, size, base, height } => {
            let mask = bitmap(image).map_err(|e| ("image".into(), e))?;
            let origin = (*corner + 0.5 * *size).extend(*base);
            let corner = [corner.extend(*base), size.extend(*height)];
            let solid = solid::stacked(&[mask], corner, origin).map_err(|e| wrong_mask("image", image, &e))?;
            Ok((Some(solid), origin))
        }
        Region::Mask3d { images, corner, size } => {
            let mut layers: Vec<Bitmap> = Vec::new();
            for (i, image) in images.iter().enumerate() {
                let wrong = |message| (format!("images.{i}"), message);
                let layer = bitmap(image).map_err(wrong)?;
                if let Some(first) = layers.first().filter(|first| first.size != layer.size) {
                    let [[w, h], [x, y]] = [layer.size, first.size];
                    let image = image.display();
                    return Err(wrong(format!(
                        "{image} has {w}x{h} pixels, the first has {x}x{y}; all need the same size"
                    )));
                }
                layers.push(layer);
            }
            let origin = *corner + 0.5 * *size;
            let first = images.first().map(PathBuf::as_path).unwrap_or(Path::new(""));
            let solid =
                solid::stacked(&layers, [*corner, *size], origin).map_err(|e| wrong_mask("images", first, &e))?;
            Ok((Some(solid), origin))
        }
        Region::Mesh { file, scale, .. } => {
            let wrong = |message: String| ("file".to_owned(), message);
            if file.is_dir() {
                return Err(wrong(format!("{} is a folder; a file would be right", file.display())));
            }
            let folder = file.parent().map(Path::to_owned).into_iter().collect();
            let options = LoadOptions { roots: folder, ..LoadOptions::default() };
            let loaded = load::load(std::slice::from_ref(file), &options, &load::Quiet);
            let model = loaded.map_err(|e| wrong(e.to_string()))?;
            let geometries = shown_geometries(&model, None);
            let bodies = bodies(
                ShownCity { model: &model, geometries: &geometries, index: &OnceLock::new(), number: 0 },
                |_| true,
                *scale,
            );
            if bodies.is_empty() {
                return Err(wrong(format!(
                    "{} has no faces; a file with a closed body would be right",
                    file.display()
                )));
            }
            let origin = middle(&bodies);
            let solid = Solid::new(&bodies, origin).map_err(|e| wrong(format!("{}: {e}", file.display())))?;
            if solid.mended > 0 {
                let (file, count) = (file.display(), solid.mended);
                log::warn!("{file} is not closed: as a lens its holes are closed by {count} triangles");
            }
            Ok((Some(solid), origin))
        }
        Region::Objects(choice) => {
            let chosen = members(city.model, choice);
            let bodies = bodies(city, |object| chosen[object as usize], 1.0);
            if bodies.is_empty() {
                return Ok((None, DVec3::ZERO));
            }
            let origin = middle(&bodies);
            // Of faces that enclose nothing, as streets are: nothing is in them.
            let solid = match Solid::new(&bodies, origin) {
                Err(ShapeError::NoBody) => None,
                made => Some(made.map_err(|e| (choice.key().to_owned(), e.to_string()))?),
            };
            Ok((solid, origin))
        }
        Region::Shape(_)
        | Region::Thematic(_)
        | Region::Occluders(_)
        | Region::Case { .. }
        | Region::Enclosed { .. }
        | Region::Sprite { .. }
        | Region::Own { .. }
        | Region::Magnified { .. }
        | Region::Combined { .. } => Ok((None, DVec3::ZERO)),
    }
}

/// What is wrong with a mask of images.
fn wrong_mask(key: &str, image: &Path, error: &ShapeError) -> RegionError {
    match error {
        ShapeError::NoBody => ("size".into(), "is too small: nothing of the mask is left".into()),
        ShapeError::ManyFaces(_) => (key.into(), format!("{}: {error}; fewer pixels would be right", image.display())),
        _ => (key.into(), format!("{}: {error}", image.display())),
    }
}

/// The bodies of the shown geometries whose object is wanted, each closed by itself.
fn bodies(city: ShownCity, is_wanted: impl Fn(u32) -> bool, scale: f64) -> Vec<Mesh> {
    let model = city.model;
    let geometries = city.geometries.iter().map(|&g| &model.geometries[g as usize]);
    let body = |geometry: &Geometry| {
        let mut mesh = Mesh::default();
        let mut known: FxHashMap<[i64; 3], DVec3> = FxHashMap::default();
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            let first = mesh.points.len() as u32;
            let corners = tile.vertices.clone().map(|vertex| model.position(tile, vertex) * scale);
            mesh.points
                .extend(corners.map(|p| *known.entry((p / SAME_M).round().as_i64vec3().to_array()).or_insert(p)));
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
    let texture =
        Texture { image: TextureImage::File(path.to_owned()), wrap: Default::default(), opacity: TextureOpacity::Own };
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
