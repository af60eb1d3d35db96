//! Furniture: what stands over a finished picture - panels, swatches, lines of text - as plain data.
//!
//! Whoever makes it (titles, captions, legends: [`crate::figure`]) says where everything stands in pixels of the whole
//! picture; tiles of a large picture each take their part. Equal furniture is set once.

use glam::Vec2;

use crate::{lens::color::Srgb, render::text::TextLine};

/// Which furniture a pipeline draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FurniturePart {
    /// Panels and text.
    Items,
    /// Insides of opaque panels.
    Solid,
    /// Pictures of overlays.
    Picture,
    /// Insides of opaque pictures.
    OpaquePicture,
    /// Overlays that stand in the scene.
    Board,
    /// Context lines of one colour.
    Strip,
    /// Context lines with a skin.
    Skin,
}

/// Everything that stands over a picture, bottom first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Furniture {
    /// The pieces.
    pub pieces: Vec<Piece>,
}

/// One piece of furniture.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// A rectangle.
    Panel(Panel),
    /// A line of text.
    Text(TextLine),
    /// An image that the renderer keeps.
    Image(ImagePiece),
    /// An overlay that stands in the scene.
    Board(BoardPiece),
    /// A context line.
    Strip(Strip),
    /// A polygon of one colour.
    Polygon(Polygon),
}

/// An image of [`Renderer::board`](crate::render::renderer::Renderer::board) on a rectangle in the scene, in
/// perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardPiece {
    /// Its number; alpha is premultiplied.
    pub image: u64,
    /// Left, top of what it may touch, whole pixels from the picture's top left.
    pub low: [f32; 2],
    /// Right, bottom.
    pub high: [f32; 2],
    /// Rows r for which the place (x, y), pixels from `low`, shows the image at (u, v) = (r₀·p, r₁·p) / r₂·p, p = (x,
    /// y, 1): shares of its width and height from its top left. r₂·p is positive before the eye.
    pub rows: [[f32; 3]; 3],
}

/// An image of [`Renderer::images`](crate::render::images::Images), texel by texel; what of it is missing there is not drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImagePiece {
    /// Its number there.
    pub image: u64,
    /// The number of the image that says what of it is seen, stretched over it: the mean of its colours, times its alpha.
    pub mask: Option<u64>,
    /// Left, top, whole pixels from the picture's top left.
    pub low: [f32; 2],
    /// Right, bottom.
    pub high: [f32; 2],
    /// Whether left and right are exchanged.
    pub mirror: bool,
    /// 0 to 1.
    pub opacity: f32,
    /// Whether it is an ellipse.
    pub ellipse: bool,
    /// Radius of the corners, pixels.
    pub radius_px: f32,
    /// Over how many pixels the border fades: 1 is a clean one, more lies inside; ≥ 1.
    pub softness_px: f32,
    /// Fisheye: how many times larger the middle is ([`crate::view::local::fisheye`]); the image is as much larger than its place. At 1, its texels are pixels.
    pub magnification: f32,
}

/// A way of so many widths through the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// The way, pixels from the picture's top left; no point twice in a row.
    pub points: Vec<[f32; 2]>,
    /// Its widths at both ends, pixels.
    pub widths: [f32; 2],
    /// sRGB 0..1.
    pub color: Srgb,
    /// 0 to 1.
    pub opacity: f32,
    /// The number of the image that is laid along it.
    pub skin: Option<u64>,
    /// What it fades towards: a point, and the radii within which nothing and beyond which all is seen, pixels.
    pub fade: Option<([f32; 2], [f32; 2])>,
}

/// How far a mitre may reach, in half widths; sharper bends are cut there.
const MITRE: f32 = 3.0;

/// A strip across its way, at one of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crosscut {
    /// The point.
    pub at: [f32; 2],
    /// To its left side, of length 1.
    pub across: [f32; 2],
    /// How far its sides are there, in half widths: 1, and more at bends, where sides meet in a mitre.
    pub stretch: f32,
    /// Along the way, of length 1.
    pub ahead: [f32; 2],
    /// Half the width there, pixels.
    pub half_width: f32,
    /// How far along the way it is, pixels.
    pub along: f32,
}

impl Strip {
    /// Its crosscuts, one for each point; none where it has no length.
    pub fn crosscuts(&self) -> Vec<Crosscut> {
        let points: Vec<Vec2> = self.points.iter().map(|p| Vec2::from(*p)).collect();
        let normal = |pair: &[Vec2]| (pair[1] - pair[0]).perp().normalize_or(Vec2::Y);
        let normals: Vec<Vec2> = points.windows(2).map(normal).collect();
        let mut along = vec![0.0_f32];
        for pair in points.windows(2) {
            along.push(along[along.len() - 1] + pair[0].distance(pair[1]));
        }
        let length = along[along.len() - 1];
        if normals.is_empty() || length <= 0.0 {
            return Vec::new();
        }
        let ends = self.widths.map(|width| 0.5 * width);
        let cut = |(i, point): (usize, &Vec2)| {
            let before = normals[i.max(1) - 1];
            let after = normals[i.min(normals.len() - 1)];
            let middle = (before + after).normalize_or(after);
            let stretch = (1.0 / middle.dot(after).max(1.0 / MITRE)).min(MITRE);
            Crosscut {
                at: (*point).into(),
                across: middle.into(),
                stretch,
                ahead: (-after.perp()).into(),
                half_width: ends[0] + (ends[1] - ends[0]) * along[i] / length,
                along: along[i],
            }
        };
        points.iter().enumerate().map(cut).collect()
    }
}

/// A polygon of one colour: a hand of an arrow.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// Its corners, pixels from the picture's top left; what its border goes around is in it.
    pub points: Vec<[f32; 2]>,
    /// sRGB 0..1.
    pub color: Srgb,
    /// 0 to 1.
    pub opacity: f32,
}

/// A rectangle of one colour: a card, a swatch, its shadow. On whole pixels its colour is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Left, top, pixels from the picture's top left.
    pub low: [f32; 2],
    /// Right, bottom.
    pub high: [f32; 2],
    /// sRGB 0..1.
    pub color: Srgb,
    /// 0 to 1.
    pub opacity: f32,
    /// Radius of the corners, pixels.
    pub radius_px: f32,
    /// Over how many pixels the border fades: 1 is a clean one, more a shadow; ≥ 1.
    pub softness_px: f32,
    /// Whether it is the ellipse that fills the rectangle.
    pub ellipse: bool,
}

/// No furniture, to be borrowed.
pub static NONE: Furniture = Furniture { pieces: Vec::new() };

impl Furniture {
    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// What draws it; some of it may come twice.
    pub(super) fn parts(&self) -> impl Iterator<Item = FurniturePart> {
        use FurniturePart as P;
        self.pieces.iter().flat_map(|piece| match piece {
            Piece::Panel(_) => [Some(P::Items), Some(P::Solid)].into_iter().flatten(),
            Piece::Text(_) | Piece::Polygon(_) => [Some(P::Items), None].into_iter().flatten(),
            Piece::Image(_) => [Some(P::Picture), Some(P::OpaquePicture)].into_iter().flatten(),
            Piece::Board(_) => [Some(P::Board), None].into_iter().flatten(),
            Piece::Strip(strip) => [Some(strip_part(strip.skin)), None].into_iter().flatten(),
        })
    }
}

/// What draws a context line.
pub(super) fn strip_part(skin: Option<u64>) -> FurniturePart {
    if skin.is_some() { FurniturePart::Skin } else { FurniturePart::Strip }
}
