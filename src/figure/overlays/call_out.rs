//! Boards in the scene that show overlays: where they stand, and what of the picture they are.
//!
//! ```text
//!        ╱────────╲          turned about the vertical axis to the eye, tilted back;
//!       ╱ overlay  ╲         its middle is above the point of interest
//!      ╱────────────╲
//!            │  foot         the context line, from the middle of the lower edge
//!            ╵
//!        ┌───┴───┐ top       of the object
//! ```

use glam::{DMat3, DVec2, DVec3};

use crate::{
    overlay::Rect,
    render::furniture::BoardPiece,
    scene::overlay::CallOut,
    view::{View, local},
};

/// Steps of the size of a board's image per doubling: it is drawn again only when the eye has come nearer, or gone, by
/// a fifth of the way.
const STEPS: f64 = 4.0;
/// Pixels of a board's image for each that it takes in the picture: its text is still sharp when it is turned.
const DENSITY: f64 = 1.2;
/// Longest side of a board's image, pixels; and as a multiple of the picture's: what is larger is not all seen.
const MOST: [f64; 2] = [4096.0, 2.0];
/// A board that is seen from its edge is thinner than this, pixels, and not drawn.
const THIN_PX: f64 = 0.5;

/// What a board stands above.
#[derive(Clone, Copy, Debug)]
pub(super) struct Above {
    /// A point of interest, model coordinates.
    pub place: DVec3,
    /// From the lowest to the highest of its object, metres.
    pub heights_m: [f64; 2],
}

/// A board that is seen.
#[derive(Clone, Debug)]
pub(super) struct Board {
    /// Width and height of the overlay in its image, pixels.
    pub size: [u32; 2],
    /// Around that, where its shadow falls, pixels of the image.
    pub margin: i32,
    /// How many times as large the overlay is in the image as in a picture.
    pub scale: f64,
    /// How far its middle is from the eye along the view axis, metres.
    pub depth: f64,
    /// The middle of its lower edge, pixels of the picture; `None`: that is not before the eye.
    pub foot: Option<DVec2>,
    /// What of the picture it may touch, less its shadow.
    pub seen: Rect,
    /// With its shadow.
    low: [i32; 2],
    high: [i32; 2],
    rows: [[f32; 3]; 3],
}

/// A rectangle in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Quad {
    /// Its upper left corner, model coordinates.
    corner: DVec3,
    /// Its upper edge, to the right, metres.
    across: DVec3,
    /// Its left edge, downwards.
    down: DVec3,
}

/// The board of a call-out; `None`: it is out of the picture, behind the eye, or seen from behind or from its edge.
/// `size_at` is the size of the overlay when all of it is so many times as large as in a picture, where its text has
/// `em`; pixels.
pub(super) fn board(
    view: &View,
    call_out: &CallOut,
    above: &Above,
    size_at: impl Fn(f64) -> [u32; 2],
    em: f32,
) -> Option<Board> {
    let (quad, scale) = stand(view, call_out, above, &size_at, em)?;
    let size = size_at(scale);
    let margin = (margin_px(em) * scale).ceil() as i32 + 4;
    let seen = quad.seen(view)?;
    let image = quad.grown(size.map(|side| f64::from(margin) / f64::from(side)));
    let (low, high) = image.bounds(view)?;
    let depth = view.depth(quad.corner + 0.5 * (quad.across + quad.down));
    let foot = quad.corner + 0.5 * quad.across + quad.down;
    Some(Board {
        size,
        margin,
        scale,
        depth,
        foot: view.pixel(foot).filter(|p| p.z > view.camera.near_m).map(|p| p.truncate()),
        seen,
        low,
        high,
        rows: image.rows(view, low)?,
    })
}

impl Board {
    /// Width and height of its image, pixels.
    pub fn image_size(&self) -> [u32; 2] {
        self.size.map(|side| side + 2 * self.margin as u32)
    }

    /// The piece that shows its image.
    pub fn piece(&self, image: u64) -> BoardPiece {
        let pixels = |corner: [i32; 2]| corner.map(|v| v as f32);
        BoardPiece { image, low: pixels(self.low), high: pixels(self.high), rows: self.rows }
    }

    /// What of the picture others leave free. Where it fills most of that there is no other place for them.
    pub fn blocks(&self, picture: [u32; 2]) -> Option<Rect> {
        let area = |[w, h]: [i64; 2]| w * h;
        let is_most = 2 * area(self.seen.size().map(i64::from)) > area(picture.map(i64::from));
        (!is_most).then_some(self.seen)
    }
}

/// How far the shadow of a frame reaches beyond it, pixels, where text has `em`.
fn margin_px(em: f32) -> f64 {
    0.7 * f64::from(em)
}

/// Where a call-out stands, and how many times as large as in a picture its overlay is drawn for it: near to its
/// largest size in the picture.
fn stand(
    view: &View,
    call_out: &CallOut,
    above: &Above,
    size_at: impl Fn(f64) -> [u32; 2],
    em: f32,
) -> Option<(Quad, f64)> {
    let [lowest, highest] = above.heights_m;
    let top = above.place.with_z(highest);
    let side = |size: [u32; 2]| size.map(f64::from);
    let [width, height] = side(size_at(1.0));
    let depth = |place: DVec3| view.depth(place).max(view.camera.near_m);
    let width_m = match call_out.width_m {
        Some(metres) => metres,
        None if view.depth(top) > view.camera.near_m => width * view.pixel_m(view.depth(top)),
        None => return None,
    };
    let high_m = width_m * height / width;
    let foot = top + call_out.height_m.unwrap_or(0.125 * (highest - lowest + high_m)) * DVec3::Z;
    // In plan, to the viewer.
    let to_eye = (view.camera.eye - foot).truncate();
    let is_level = !view.is_orthographic() && to_eye.length() > 1e-6 * view.camera.eye.distance(foot);
    let facing = if is_level { to_eye.normalize_or(DVec2::NEG_Y) } else { -local::heading(&view.camera) };
    let right = DVec2::new(-facing.y, facing.x).extend(0.0);
    let up = call_out.tilt.cos() * DVec3::Z - call_out.tilt.sin() * facing.extend(0.0);
    let nearest = depth(foot).min(depth(foot + high_m * up));
    let wanted = width_m / view.pixel_m(nearest) / width;
    let stepped = (((wanted * DENSITY).log2() * STEPS).round() / STEPS).exp2();
    let most = MOST[0].min(MOST[1] * f64::from(view.size[0].max(view.size[1])));
    let scale = stepped.min(most / (width.max(height) + 2.0 * margin_px(em)));
    let [width, height] = side(size_at(scale));
    let across = width_m * right;
    let down = -width_m * height / width * up;
    let quad = Quad { corner: foot - 0.5 * across - down, across, down };
    (scale > 0.0 && quad.corner.is_finite()).then_some((quad, scale))
}

impl Quad {
    /// So much wider and higher on each side, as shares of itself.
    fn grown(&self, [x, y]: [f64; 2]) -> Self {
        let corner = self.corner - x * self.across - y * self.down;
        Self { corner, across: (1.0 + 2.0 * x) * self.across, down: (1.0 + 2.0 * y) * self.down }
    }

    /// The corners of what is before the near plane, clockwise, pixels: none to five.
    fn outline(&self, view: &View) -> Vec<DVec2> {
        let (a, b, c) = (self.corner, self.across, self.down);
        let corners = [a, a + b, a + b + c, a + c];
        let near = view.camera.near_m * (1.0 + 1e-9);
        let before = |corner: DVec3| view.depth(corner) - near;
        let mut kept = Vec::new();
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % 4];
            let depths = [before(from), before(to)];
            if depths[0] >= 0.0 {
                kept.push(from);
            }
            if (depths[0] < 0.0) != (depths[1] < 0.0) {
                kept.push(from.lerp(to, depths[0] / (depths[0] - depths[1])));
            }
        }
        kept.into_iter().filter_map(|corner| view.pixel(corner)).map(|p| p.truncate()).collect()
    }

    /// The pixels that it may touch; `None`: none.
    fn bounds(&self, view: &View) -> Option<([i32; 2], [i32; 2])> {
        let outline = self.outline(view);
        let (mut low, mut high) = ([0; 2], [0; 2]);
        for i in 0..2 {
            let side = f64::from(view.size[i]);
            let most = |pick: fn(f64, f64) -> f64, from: f64| outline.iter().map(|p| p[i]).fold(from, pick);
            low[i] = most(f64::min, f64::INFINITY).floor().clamp(0.0, side) as i32;
            high[i] = most(f64::max, f64::NEG_INFINITY).ceil().clamp(0.0, side) as i32;
            if low[i] >= high[i] {
                return None;
            }
        }
        Some((low, high))
    }

    /// The same of one that is seen from before.
    fn seen(&self, view: &View) -> Option<Rect> {
        let outline = self.outline(view);
        let next = |i: usize| outline[(i + 1) % outline.len()];
        let area: f64 = (0..outline.len()).map(|i| 0.5 * outline[i].perp_dot(next(i))).sum();
        let longest = (0..outline.len()).map(|i| outline[i].distance(next(i))).fold(0.0, f64::max);
        if area < THIN_PX * longest {
            return None;
        }
        self.bounds(view).map(|(min, max)| Rect { min, max })
    }

    /// The rows of [`BoardPiece`].
    fn rows(&self, view: &View, low: [i32; 2]) -> Option<[[f32; 3]; 3]> {
        let basis = view.basis;
        let half_px = 0.5 * DVec2::new(view.size[0].into(), view.size[1].into());
        let scale = half_px / view.half_extent();
        // Pixels times w, and w: the distance along the view axis, in orthographic views 1.
        let project = |v: DVec3, is_place: bool| {
            let w = if view.is_orthographic() { f64::from(u8::from(is_place)) } else { v.dot(basis.forward) };
            DVec3::new(half_px.x * w + scale.x * v.dot(basis.right), half_px.y * w - scale.y * v.dot(basis.up), w)
        };
        let corner = project(self.corner - view.camera.eye, true);
        let pixel_from_image = DMat3::from_cols(project(self.across, false), project(self.down, false), corner);
        let from_low = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(low[0].into(), low[1].into(), 1.0));
        let image_from_pixel = pixel_from_image.inverse() * from_low;
        // In any unit: so that w is about 1 in the middle.
        let middle = corner + 0.5 * (pixel_from_image.x_axis + pixel_from_image.y_axis);
        let unit = if middle.z.abs() > 0.0 { middle.z.abs() } else { 1.0 };
        let rows = image_from_pixel.transpose() * unit;
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec3().to_array());
        rows.iter().flatten().all(|v| v.is_finite()).then_some(rows)
    }
}

#[cfg(test)]
mod tests;
