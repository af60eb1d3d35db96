//! Images of what the eye sees that lenses look into which bend pictures instead of rays: which part of the view each shows, and how finely.
//!
//! ```text
//!   a lens that looks into the picture     one image of all that its rays meet along their way, as the picture sees it, with as many
//!                                          texels to a pixel as the lens magnifies
//!   a fisheye                              faces of a cube around the eye: the one that it looks at; of more than 90° also those beside
//!                                          that, and of more than 250° the one behind
//! ```
//!
//! A place is looked up in the finest image that shows it, whatever lens that is of: all are of the same eye.

use glam::{DVec2, DVec3};

use crate::{
    lens::{
        ray::{FisheyeProjection, RayMethod, RayOutline},
        ray_path::{ImageBend, RayPaths, Rim},
        ray_walk::PathPiece,
    },
    render::{bent, eye::PictureTile, layout},
    view::{Basis, Camera, Projection, View},
};

/// Images of a picture, at most: of each lens the faces of a cube.
pub(super) const MOST_SOURCES: usize = 48;
/// Texels of an image, along an axis, at most.
const MOST_SIDE: f64 = 4096.0;
/// Texels of all images, which are layers of one size: at most 12 to 24 bytes each, a quarter to half a gibibyte.
const MOST_TEXELS: f64 = (1 << 24) as f64 * 1.5;
/// Coarser than this share of what lenses ask for they are not made.
const LEAST_SHARE: f64 = 1e-4;
/// Texels of the whole picture, of which an image is a part, along an axis, at most.
const MOST_WHOLE: f64 = 60_000.0;
/// Places of a lens, along an axis, that are asked what is seen there.
const PLACES: u32 = 32;
/// What is between them may reach so far beyond what they see, as a share of that; and texels for all that lies between texels.
const MARGIN: f64 = 0.03;
const MARGIN_TEXELS: f64 = 2.0;
/// From so far off its axis on the corners of a cube's first face do not reach a place, and those of the faces beside it do not.
const FIRST_FACE: f64 = std::f64::consts::FRAC_PI_4;
const SIDE_FACES: f64 = 2.186_276_035_465_284;

/// An image.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RaySource {
    /// The whole picture that it is a part of.
    pub view: View,
    /// The part.
    pub tile: PictureTile,
    /// How wide a texel is where it looks straight ahead: at distance 1, or with parallel rays in metres.
    texel: f64,
}

impl RaySource {
    /// Whether its axes are those of the picture.
    pub fn is_turned(&self, view: &View) -> bool {
        self.view.basis != view.basis
    }

    /// As pixels look into it, where its own view is this one for the shaders.
    pub fn row(&self, own: &layout::View, view: &View) -> layout::RaySource {
        let turn = self.view.basis.view_from_world() * view.basis.view_from_world().transpose();
        let column = |axis: DVec3, w: f32| axis.as_vec3().extend(w).to_array();
        let [width, height] = self.tile.size.map(|side| side as f32);
        let [scale_x, scale_y, offset_x, offset_y] = own.projection;
        layout::RaySource {
            turn_x: column(turn.x_axis, own.near),
            turn_y: column(turn.y_axis, own.far),
            turn_z: column(turn.z_axis, own.orthographic as f32),
            // Rows go down.
            texel: [
                0.5 * scale_x * width,
                -0.5 * scale_y * height,
                0.5 * (1.0 + offset_x) * width,
                0.5 * (1.0 - offset_y) * height,
            ],
            size: [width, height],
            reserved: [0.0; 2],
        }
    }
}

/// What a lens looks into.
struct Lens<'a> {
    rim: &'a Rim,
    /// How many times as large it shows things, at most; at least 1.
    magnifies: f64,
    /// Where it looks in other directions than the picture.
    round: Option<Round>,
}

/// How a lens looks around.
struct Round {
    /// The widest angle from its middle, radians.
    turn: f64,
    /// The angle that a radius of it shows, where it shows things largest, radians.
    per_radius: f64,
}

impl Round {
    /// That of a fisheye.
    fn of_fisheye(rim: &Rim, angle: f64, projection: FisheyeProjection) -> Self {
        let per_radius = match projection {
            FisheyeProjection::Angular => 0.5 * angle,
            FisheyeProjection::Hemispherical => (0.5 * angle).sin(),
        };
        // In the corners of a square it is more.
        let turn = match rim.outline {
            RayOutline::Circle => 0.5 * angle,
            RayOutline::Square => 0.5 * angle * std::f64::consts::SQRT_2,
        };
        Self { turn, per_radius }
    }
}

/// The images of a tile of a picture, the finest first: as fine as the lenses ask for, or where that were too many texels, as there may be.
pub(super) fn sources(paths: &RayPaths, view: &View, tile: PictureTile) -> Vec<RaySource> {
    let mut share = 1.0;
    loop {
        let all = sources_of(paths, view, tile, share);
        let side = |axis: usize| all.iter().map(|source| source.tile.size[axis]).max().unwrap_or_default();
        let texels = f64::from(side(0)) * f64::from(side(1)) * all.len() as f64;
        // Some may be as large as they can be until they are much coarser.
        if texels <= MOST_TEXELS || share < LEAST_SHARE {
            return all;
        }
        share *= 0.98 * (MOST_TEXELS / texels).sqrt();
    }
}

/// The same, where texels to a pixel are this share of what lenses ask for.
fn sources_of(paths: &RayPaths, view: &View, tile: PictureTile, share: f64) -> Vec<RaySource> {
    let mut all: Vec<RaySource> = Vec::new();
    for lens in lenses(paths).filter(|lens| lens.rim.method == RayMethod::Image) {
        let Some(part) = bent::part_of(lens.rim, view, tile) else { continue };
        let fineness = share * lens.rim.fineness;
        match lens.round {
            Some(round) => all.extend(faces(lens.rim, view, &round, fineness)),
            None => all.extend(flat(paths, &lens, view, tile, part.rectangle(), fineness)),
        }
    }
    all.sort_by(|a, b| a.texel.total_cmp(&b.texel));
    all.truncate(MOST_SOURCES);
    all
}

fn lenses(paths: &RayPaths) -> impl Iterator<Item = Lens<'_>> {
    let images = paths.images.iter().map(|lens| match &lens.bend {
        ImageBend::Sampled(radius) => Lens { rim: &lens.rim, magnifies: radius.magnifies(), round: None },
        ImageBend::Round(angle, projection) => {
            Lens { rim: &lens.rim, magnifies: 1.0, round: Some(Round::of_fisheye(&lens.rim, *angle, *projection)) }
        }
        ImageBend::Own(own) => {
            let extent = own.extent;
            let round = extent.turn.map(|turn| Round { turn, per_radius: extent.per_radius });
            Lens { rim: &lens.rim, magnifies: extent.magnifies, round }
        }
    });
    let planes = paths.planes.iter().map(|lens| Lens {
        rim: &lens.rim,
        magnifies: lens.magnifies(paths.is_parallel).max(1.0),
        round: None,
    });
    images.chain(planes)
}

/// The image of a lens that looks into the picture.
fn flat(
    paths: &RayPaths,
    lens: &Lens,
    view: &View,
    tile: PictureTile,
    part: PictureTile,
    fineness: f64,
) -> Option<RaySource> {
    let half = view.half_extent();
    let size = DVec2::new(view.size[0].into(), view.size[1].into());
    let first = DVec2::new(f64::from(tile.origin[0] + part.origin[0]), f64::from(tile.origin[1] + part.origin[1]));
    let wide = DVec2::new(part.size[0].into(), part.size[1].into());
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for i in 0..(PLACES + 1).pow(2) {
        let share = DVec2::new((i % (PLACES + 1)).into(), (i / (PLACES + 1)).into()) / f64::from(PLACES);
        let place = (first + share * wide) / size;
        let across = DVec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y) * half;
        for seen in seen_along(&paths.pieces(across), paths.is_parallel) {
            (low, high) = (low.min(seen), high.max(seen));
        }
    }
    let pixel = 2.0 * half.y / size.y;
    let wanted = pixel / (lens.magnifies * fineness);
    let margin = MARGIN * (high - low);
    (low, high) = (low - margin, high + margin);
    // So far from the axis the whole picture goes, and so far its part.
    let reach = low.abs().max(high.abs()) + MARGIN_TEXELS * wanted;
    if !(high - low).is_finite() || !reach.is_finite() {
        return None;
    }
    let coarsest = (2.0 * reach.max_element() / MOST_WHOLE).max((high - low).max_element() / (MOST_SIDE - 8.0));
    let texel = wanted.max(coarsest);
    let whole = (2.0 * reach / texel).ceil() + 2.0 * MARGIN_TEXELS;
    let begins = |from: f64, whole: f64| (whole / 2.0 + from / texel - MARGIN_TEXELS).floor().max(0.0);
    let ends = |to: f64, whole: f64| (whole / 2.0 + to / texel + MARGIN_TEXELS).ceil().min(whole);
    // Rows go down.
    let origin = [begins(low.x, whole.x), begins(-high.y, whole.y)];
    let end = [ends(high.x, whole.x), ends(-low.y, whole.y)];
    let tile = PictureTile {
        origin: origin.map(|o| o as u32),
        size: [0, 1].map(|i| (end[i] - origin[i]).clamp(1.0, MOST_SIDE) as u32),
    };
    let half_y = 0.5 * whole.y * texel;
    let projection = match view.camera.projection {
        Projection::Perspective { .. } => Projection::Perspective { fov_y: 2.0 * half_y.atan() },
        Projection::Orthographic { .. } => Projection::Orthographic { height_m: 2.0 * half_y },
    };
    let camera = Camera { projection, ..view.camera };
    let view = View { camera, size: [whole.x as u32, whole.y as u32], looks_around: false, ..*view };
    Some(RaySource { view, tile, texel })
}

/// The places of the picture that what a ray meets is seen at, at both ends of each of its pieces.
fn seen_along(pieces: &[PathPiece], is_parallel: bool) -> impl Iterator<Item = DVec2> {
    let seen = move |piece: &PathPiece, t: f64| {
        let (origin, slope) = (piece.line.origin.truncate(), piece.line.direction.truncate());
        match (is_parallel, t.is_finite()) {
            // It goes on as the eye sees.
            (true, false) => origin,
            (true, true) => origin + t * slope,
            (false, false) => slope,
            (false, true) => origin / t.max(f64::MIN_POSITIVE) + slope,
        }
    };
    pieces.iter().filter(|piece| piece.line.direction.z == -1.0).flat_map(move |piece| {
        let begins = (piece.range[0] > 0.0).then(|| seen(piece, piece.range[0]));
        [begins, Some(seen(piece, piece.range[1]))].into_iter().flatten()
    })
}

/// The faces of a cube that a fisheye looks at.
fn faces(rim: &Rim, view: &View, round: &Round, fineness: f64) -> Vec<RaySource> {
    let size = DVec2::new(view.size[0].into(), view.size[1].into());
    let radius_px = rim.radius / (2.0 * view.half_extent().y) * size.y;
    let Round { turn, per_radius } = *round;
    // Texels of a face at distance 1, where it looks straight ahead.
    let density = radius_px / per_radius * fineness;
    let half = 1.0 + MARGIN_TEXELS / density.max(MARGIN_TEXELS);
    let side = (2.0 * half * density).ceil().clamp(2.0, MOST_SIDE);
    // The axes of the fisheye, in the world.
    let middle = if view.is_orthographic() { DVec2::ZERO } else { rim.center };
    let to_world = view.basis.view_from_world().transpose();
    let ahead = middle.extend(-1.0).normalize_or(DVec3::NEG_Z);
    let aside = ahead.cross(DVec3::Y).normalize_or(DVec3::X);
    let [forward, right, up] = [ahead, aside, aside.cross(ahead)].map(|axis| to_world * axis);
    let face = |right: DVec3, up: DVec3, forward: DVec3| {
        let projection = Projection::Perspective { fov_y: 2.0 * half.atan() };
        let camera = Camera { target: view.camera.eye + forward, up, projection, ..view.camera };
        let basis = Basis { right, up, forward };
        let size = [side as u32; 2];
        let view = View { camera, basis, size, far_m: f64::INFINITY, looks_around: false };
        RaySource { view, tile: PictureTile::whole(size), texel: 2.0 * half / side }
    };
    let beside =
        [face(-forward, up, right), face(forward, up, -right), face(right, -forward, up), face(right, forward, -up)];
    let mut all = vec![face(right, up, forward)];
    if turn >= FIRST_FACE {
        all.extend(beside);
    }
    if turn >= SIDE_FACES {
        all.push(face(-right, up, -forward));
    }
    all
}

#[cfg(test)]
mod tests;
