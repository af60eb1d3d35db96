//! Furniture as it is drawn in a tile: items, corners of context lines, coverage of text, and what is drawn at once.

use std::ops::Range;

use glam::Vec2;

use crate::{
    lens::color::{Srgb, linear_from_srgb},
    render::{
        eye::PictureTile,
        furniture::{Crosscut, Furniture, FurniturePart, Piece, Strip, strip_part},
        layout::{FurnitureItem, StripVertex},
        patch::Patch,
        text::Run,
    },
};

/// What is drawn at once.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub part: FurniturePart,
    /// Items; of strips, corners.
    pub of: Range<u32>,
    /// What it shows, and the mask of that.
    pub image: Option<(u64, Option<u64>)>,
}

/// Linear colour and alpha. The colour is that of a byte, so that no adapter's rounding changes it.
fn with_alpha(color: Srgb, opacity: f32) -> [f32; 4] {
    let [r, g, b] = linear_from_srgb(color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() / 255.0));
    [r, g, b, opacity.clamp(0.0, 1.0)]
}

/// The pieces that meet a tile, in its pixels.
#[derive(Default)]
pub(super) struct Assembled {
    pub items: Vec<FurnitureItem>,
    pub corners: Vec<StripVertex>,
    /// Of texts: two texels per word.
    pub coverage: Vec<u32>,
    pub batches: Vec<Batch>,
}

impl Assembled {
    /// Puts items or corners into a batch with those before them, if they are drawn alike.
    fn batch(&mut self, part: FurniturePart, of: Range<usize>, image: Option<(u64, Option<u64>)>) {
        let of = of.start as u32..of.end as u32;
        match self.batches.last_mut() {
            _ if of.is_empty() => {}
            Some(last) if last.part == part && last.image == image => last.of.end = of.end,
            _ => self.batches.push(Batch { part, of, image }),
        }
    }

    /// One item for each part of a piece.
    fn put(
        &mut self,
        kind: FurniturePart,
        item: FurnitureItem,
        parts: impl Iterator<Item = Patch>,
        image: Option<(u64, Option<u64>)>,
    ) {
        let first = self.items.len();
        self.items.extend(parts.map(|part| FurnitureItem { part: part.corners(), ..item }));
        self.batch(kind, first..self.items.len(), image);
    }
}

/// How many pieces after it are asked whether they hide some of a piece: the shadow and the ground of an image lie just before it.
const HIDING: usize = 3;
/// Fewer pixels are not worth more items and draws.
const WORTHWHILE: i64 = 2048;

/// Of pieces in a tile: all that they may touch, and where they hide what is under them.
fn extents(
    furniture: &Furniture,
    opaque: &[bool],
    inside: impl Fn([f32; 2]) -> [f32; 2],
) -> Vec<(Option<Patch>, Option<Patch>)> {
    let of = |(piece, is_opaque): (&Piece, &bool)| match piece {
        Piece::Panel(panel) => {
            let (low, high) = (inside(panel.low), inside(panel.high));
            let softness = panel.softness_px.max(1.0);
            let margin = 0.5 * softness + 0.5;
            let hides = panel.opacity >= 1.0 && !panel.ellipse;
            (
                Patch::around(low.map(|v| v - margin), high.map(|v| v + margin)),
                hides.then(|| Patch::inside(low, high, panel.radius_px.max(0.0), softness)).flatten(),
            )
        }
        Piece::Image(image) => {
            let (low, high) = (inside(image.low), inside(image.high));
            let softness = image.softness_px.max(1.0);
            let inset = if softness > 1.0 { 0.5 * softness } else { 0.0 };
            let hides = *is_opaque
                && image.opacity >= 1.0
                && image.mask.is_none()
                && !image.ellipse
                && image.magnification <= 1.0;
            let border = (low.map(|v| v + inset), high.map(|v| v - inset));
            let hidden = || Patch::inside(border.0, border.1, image.radius_px.max(0.0), softness);
            (Patch::around(low, high), hides.then(hidden).flatten())
        }
        Piece::Board(board) => (Patch::around(inside(board.low), inside(board.high)), None),
        Piece::Text(_) | Piece::Strip(_) | Piece::Polygon(_) => (None, None),
    };
    let worth = |(all, hides): (_, Option<Patch>)| (all, hides.filter(|part| part.area() >= WORTHWHILE));
    furniture.pieces.iter().zip(opaque).map(of).map(worth).collect()
}

/// What of the piece `i` is seen, in parts.
fn seen(extents: &[(Option<Patch>, Option<Patch>)], i: usize, tile: Patch) -> Vec<Patch> {
    let Some(all) = extents[i].0.and_then(|all| all.common(tile)) else { return Vec::new() };
    let hidden = |&(_, hides): &(Option<Patch>, Option<Patch>)| hides.and_then(|part| part.common(all));
    let after = &extents[i + 1..extents.len().min(i + 1 + HIDING)];
    let hole = after.iter().filter_map(hidden).max_by_key(|part| part.area());
    match hole {
        Some(hole) => all.without(hole).collect(),
        None => vec![all],
    }
}

/// The pieces that meet a tile.
pub(super) fn assembled(furniture: &Furniture, runs: &[Option<Run>], opaque: &[bool], tile: PictureTile) -> Assembled {
    let mut all = Assembled::default();
    let mut bytes = Vec::<[u8; 2]>::new();
    let origin = tile.origin.map(|o| o as f32);
    let inside = |p: [f32; 2]| [p[0] - origin[0], p[1] - origin[1]];
    let extents = extents(furniture, opaque, inside);
    let tile_patch = Patch { low: [0, 0], high: tile.size.map(|s| s as i32) };
    let flag = |on: bool| f32::from(u8::from(on));
    for (i, (piece, run)) in furniture.pieces.iter().zip(runs).enumerate() {
        let (item, kinds, image) = match (piece, run) {
            (Piece::Image(image), _) => {
                let item = FurnitureItem {
                    low: inside(image.low),
                    high: inside(image.high),
                    color: [0.0, 0.0, 0.0, image.opacity.clamp(0.0, 1.0)],
                    halo: [flag(image.mirror), flag(image.ellipse), (image.magnification - 1.0).max(0.0), 0.0],
                    radius: image.radius_px.max(0.0),
                    softness: image.softness_px.max(1.0),
                    ..Default::default()
                };
                let kinds = [FurniturePart::OpaquePicture, FurniturePart::Picture];
                (item, kinds, Some((image.image, image.mask)))
            }
            (Piece::Panel(panel), _) => {
                let item = FurnitureItem {
                    low: inside(panel.low),
                    high: inside(panel.high),
                    color: with_alpha(panel.color, panel.opacity),
                    halo: [0.0, flag(panel.ellipse), 0.0, 0.0],
                    radius: panel.radius_px.max(0.0),
                    softness: panel.softness_px.max(1.0),
                    ..Default::default()
                };
                (item, [FurniturePart::Solid, FurniturePart::Items], None)
            }
            (Piece::Board(board), _) => {
                let [[a, b, c], [d, e, f], [g, h, i]] = board.rows;
                let item = FurnitureItem {
                    low: inside(board.low),
                    high: inside(board.high),
                    color: [a, b, c, 1.0],
                    halo: [d, e, f, g],
                    radius: h,
                    softness: i,
                    ..Default::default()
                };
                (item, [FurniturePart::Board; 2], Some((board.image, None)))
            }
            (Piece::Strip(strip), _) => {
                let first = all.corners.len();
                all.corners.extend(strip_corners(strip, origin));
                let skin = strip.skin.map(|skin| (skin, None));
                all.batch(strip_part(strip.skin), first..all.corners.len(), skin);
                continue;
            }
            (Piece::Text(line), Some(run)) => {
                let halo = line.halo.map_or([0.0; 4], |h| with_alpha(h.color, h.opacity));
                if let Some((item, part)) = clipped(run, tile, &mut bytes) {
                    let item = FurnitureItem { color: with_alpha(line.color, 1.0), halo, ..item };
                    all.put(FurniturePart::Items, item, [part].into_iter(), None);
                }
                continue;
            }
            (Piece::Polygon(polygon), Some(run)) => {
                if let Some((item, part)) = clipped(run, tile, &mut bytes) {
                    let item = FurnitureItem { color: with_alpha(polygon.color, polygon.opacity), ..item };
                    all.put(FurniturePart::Items, item, [part].into_iter(), None);
                }
                continue;
            }
            (Piece::Text(_) | Piece::Polygon(_), None) => continue,
        };
        if (0..2).any(|axis| item.high[axis] <= item.low[axis]) {
            continue;
        }
        let seen = seen(&extents, i, tile_patch);
        let Some(solid) = extents[i].1 else {
            all.put(kinds[1], item, seen.into_iter(), image);
            continue;
        };
        all.put(kinds[0], item, seen.iter().filter_map(|part| part.common(solid)), image);
        all.put(kinds[1], item, seen.iter().flat_map(|part| part.without(solid)), image);
    }
    if bytes.len() % 2 == 1 {
        bytes.push([0, 0]);
    }
    all.coverage = bytes.as_chunks().0.iter().map(|[[a, b], [c, d]]| u32::from_le_bytes([*a, *b, *c, *d])).collect();
    all
}

/// The triangles of a strip, three corners each, with a pixel around it. At bends its sides meet in a mitre.
fn strip_corners(strip: &Strip, origin: [f32; 2]) -> Vec<StripVertex> {
    let points = strip.points.iter().map(|p| [p[0] - origin[0], p[1] - origin[1]]).collect();
    let cuts = Strip { points, ..strip.clone() }.crosscuts();
    let Some(last) = cuts.last() else { return Vec::new() };
    let length = last.along;
    let ends = strip.widths.map(|width| 0.5 * width);
    let fade = strip.fade.map_or([0.0; 4], |(at, radii)| [at[0] - origin[0], at[1] - origin[1], radii[0], radii[1]]);
    let color = with_alpha(strip.color, strip.opacity);
    let side = |(i, cut): (usize, &Crosscut)| {
        let reach = cut.half_width.max(0.5) + 1.0;
        // Half a pixel beyond the ends, where their borders fade.
        let beyond = match i {
            0 => -0.5,
            _ if i + 1 == cuts.len() => 0.5,
            _ => 0.0,
        };
        let corner = |sign: f32| StripVertex {
            at: (Vec2::from(cut.at)
                + sign * reach * cut.stretch * Vec2::from(cut.across)
                + beyond * Vec2::from(cut.ahead))
            .into(),
            across: sign * reach,
            half_width: cut.half_width,
            along: cut.along + beyond,
            length,
            ends,
            color,
            fade,
        };
        [corner(1.0), corner(-1.0)]
    };
    let sides: Vec<[StripVertex; 2]> = cuts.iter().enumerate().map(side).collect();
    let quads = sides.windows(2).flat_map(|pair| {
        let ([a, b], [c, d]) = (pair[0], pair[1]);
        [a, b, c, c, b, d]
    });
    quads.collect()
}

/// The part of a run that is in a tile; its coverage is appended.
fn clipped(run: &Run, tile: PictureTile, bytes: &mut Vec<[u8; 2]>) -> Option<(FurnitureItem, Patch)> {
    let low: [u32; 2] = std::array::from_fn(|i| run.origin[i].max(tile.origin[i]));
    let high: [u32; 2] = std::array::from_fn(|i| (run.origin[i] + run.size[i]).min(tile.origin[i] + tile.size[i]));
    if low[0] >= high[0] || low[1] >= high[1] {
        return None;
    }
    let first_texel = bytes.len() as u32;
    for y in low[1]..high[1] {
        let row = (y - run.origin[1]) as usize * run.size[0] as usize;
        let column = |x: u32| row + (x - run.origin[0]) as usize;
        bytes.extend(&run.texels[column(low[0])..column(high[0])]);
    }
    let [low, high]: [[u32; 2]; 2] = [low, high].map(|p| std::array::from_fn(|i| p[i] - tile.origin[i]));
    let row_texels = high[0] - low[0];
    let [from, to] = [low, high].map(|p| p.map(|v| v as f32));
    let item = FurnitureItem { low: from, high: to, first_texel, row_texels, ..Default::default() };
    Some((item, Patch { low: low.map(|v| v as i32), high: high.map(|v| v as i32) }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::furniture::{ImagePiece, Panel};

    /// A shadow, a ground with round corners, an image on it.
    fn card(opacity: f32) -> Furniture {
        let panel = |low, high, opacity, radius_px, softness_px| {
            Piece::Panel(Panel { low, high, color: [1.0; 3], opacity, radius_px, softness_px, ellipse: false })
        };
        let image = ImagePiece {
            image: 7,
            mask: None,
            low: [20.0, 20.0],
            high: [180.0, 120.0],
            mirror: false,
            opacity,
            ellipse: false,
            radius_px: 4.0,
            softness_px: 1.0,
            magnification: 1.0,
        };
        let pieces = vec![
            panel([10.0, 14.0], [190.0, 134.0], 0.3, 8.0, 12.0),
            panel([10.0, 10.0], [190.0, 130.0], opacity, 8.0, 1.0),
            Piece::Image(image),
        ];
        Furniture { pieces }
    }

    /// How many pixels of items meet each pixel of a tile of 200 × 150, of those drawn without blending and of the others.
    fn drawn(furniture: &Furniture, opaque: bool) -> Vec<[u8; 2]> {
        let tile = PictureTile { origin: [0, 0], size: [200, 150] };
        let runs = vec![None; furniture.pieces.len()];
        let all = assembled(furniture, &runs, &[false, false, opaque], tile);
        let mut times = vec![[0; 2]; 200 * 150];
        for batch in &all.batches {
            let is_blended = !matches!(batch.part, FurniturePart::Solid | FurniturePart::OpaquePicture);
            for item in &all.items[batch.of.start as usize..batch.of.end as usize] {
                let [x0, y0, x1, y1] = item.part.map(|v| v as usize);
                for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                    times[y * 200 + x][usize::from(is_blended)] += 1;
                }
            }
        }
        times
    }

    #[test]
    fn what_lies_under_an_opaque_image_is_not_drawn() {
        let times = drawn(&card(1.0), true);
        let at = |x: usize, y: usize| times[y * 200 + x];
        assert_eq!(at(100, 70), [1, 0], "the image alone");
        assert_eq!(at(14, 70), [1, 0], "the ground alone");
        assert_eq!(at(20, 20), [1, 1], "a corner of the image over the ground");
        assert_eq!(at(10, 10), [0, 2], "a corner of the ground over the shadow");
        assert_eq!(at(195, 139), [0, 1], "the shadow");
        assert_eq!(at(199, 0), [0, 0]);
    }

    #[test]
    fn what_shines_through_hides_nothing() {
        assert_eq!(drawn(&card(0.99), true)[70 * 200 + 100], [0, 3]);
        assert_eq!(drawn(&card(1.0), false)[70 * 200 + 100], [1, 1], "the ground hides the shadow");
    }

    #[test]
    fn tiles_share_a_run_without_gap_or_overlap() {
        let texels: Vec<[u8; 2]> = (0..7 * 5).map(|i| [i as u8 + 1, 0]).collect();
        let run = Run { origin: [3, 2], size: [7, 5], texels };
        let mut seen = [0_u8; 12 * 9];
        for (x, y) in [(0, 0), (5, 0), (10, 0), (0, 4), (5, 4), (10, 4)] {
            let tile = PictureTile { origin: [x, y], size: [5, if y == 0 { 4 } else { 5 }] };
            let mut bytes = vec![[99, 99]; 3];
            let Some((item, _)) = clipped(&run, tile, &mut bytes) else { continue };
            assert_eq!(item.first_texel, 3);
            let [low, high] = [item.low, item.high].map(|p| p.map(|v| v as u32));
            for (i, (row, column)) in
                (low[1]..high[1]).flat_map(|row| (low[0]..high[0]).map(move |column| (row, column))).enumerate()
            {
                let at = ((row + y) * 12 + column + x) as usize;
                assert_eq!(seen[at], 0);
                seen[at] = bytes[3 + i][0];
            }
        }
        for (i, value) in seen.iter().enumerate() {
            let (x, y) = (i as i32 % 12 - 3, i as i32 / 12 - 2);
            let expected = if (0..7).contains(&x) && (0..5).contains(&y) { (y * 7 + x + 1) as u8 } else { 0 };
            assert_eq!(*value, expected, "{x} {y}");
        }
    }
}
