//! Where the sun looks: the parts of the shadow map, fitted to what a picture shows.
//!
//! A picture whose parts are about as far away as each other has one square of the map's whole size around what it shows. Where
//! some are much nearer than others, four squares share the map, each two, four or eight times as wide as the one before: what is
//! near has small texels. A perspective eye sees the same from each of its distances, only larger; so all four have the place of
//! the eye at the same share of their sides, and a place finds its square with few numbers: `across · scale + shift` is
//! inside the first for the largest `scale` that fits.
//!
//! Squares stand on a grid of texels, counted from the world's origin, and sides come in steps of a fourth root of two: while an eye moves
//! and turns, borders of shadows stay where they are, but where a side takes its next step. The grid is wide, so that for many frames the map is the
//! same, and need not be drawn again.

use glam::{DMat4, DVec2, DVec3, DVec4};

use crate::{
    geom::{Aabb, clipped},
    render::{
        eye::{PictureTile, view_uniform},
        layout,
        light::LEAST_SHADOW_SIZE,
    },
    view::{Basis, Camera, Projection, View},
};

/// Levels of a map that has more than one.
const LEVELS: usize = 4;
/// More than one level are drawn where the widest texel of one would be more than so many times as wide in the picture.
const WORTH: f64 = 1.5;
/// Nearer than such a part of the farthest distance there is seldom anything to see, whatever boxes say: only where more than [`MUCH`] of
/// the boxes' share of the picture is.
const NEAREST: f64 = 1.0 / 64.0;
const MUCH: f64 = 0.25;
/// Shadows that are nowhere so many pixels long are not drawn.
const LEAST_PX: f64 = 0.5;
/// How much wider each level may be than the one before.
const RATIOS: [f64; 4] = [2.0, 4.0, 8.0, 16.0];
/// What filters, and the push off a surface, reach beyond a place: texels.
const FILTER_TEXELS: f64 = 6.0;
/// Half of how wide the room is that is between the sun and a square, of its side.
const WIDER: f64 = 0.51;
/// Before the first that throws a shadow, and behind the last that takes one, metres.
const ROOM_M: f64 = 10.0;
/// The smallest side of a level, metres.
const LEAST_SIDE_M: f64 = 1e-3;
/// The eye's place in a level is a whole number of these parts of its side.
const SHIFTS: f64 = 64.0;
/// Squares stand on a grid of at most so many texels of the first: a texel of the widest where levels are two or four times as wide as
/// the one before, and an eighth of it where they are eight times as wide.
const GRID_TEXELS: f64 = 64.0;
/// Where there is one square, of so many parts of its side: that is what it is wider than it need be.
const GRID_PARTS: f64 = 32.0;

/// How large a map may be, and how coarse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapSize {
    /// Texels along a side at most.
    pub most: u32,
    /// How wide texels may be in the picture, pixels: a map of a half, a quarter or an eighth of that is taken where they are nowhere wider, and one
    /// level where its are not.
    pub texel_px: f64,
    /// The direction that decides it, for all samples of a picture alike: unit, towards the light.
    pub towards: DVec3,
}

/// The sun's eye on what a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct SunEye {
    /// Its levels, the smallest first; each lies in the next.
    pub levels: Vec<View>,
    /// Texels along a side of the map.
    pub size: u32,
    /// How much wider each level is than the one before; 1: there is one.
    ratio: f64,
    /// Where the levels grow from, as a place.
    anchor: DVec3,
    /// Where it is in each of them, of their sides: right, down.
    shift: DVec2,
}

/// Places as the sun sees them: right and down, metres.
#[derive(Clone, Copy, Debug)]
struct Across {
    origin: DVec3,
    basis: Basis,
}

/// A rectangle there: left top, right bottom.
type Rect = [DVec2; 2];

impl Across {
    fn of(&self, place: DVec3) -> DVec2 {
        self.turned(place - self.origin)
    }

    fn turned(&self, direction: DVec3) -> DVec2 {
        DVec2::new(direction.dot(self.basis.right), -direction.dot(self.basis.up))
    }

    /// Around a box.
    fn around(&self, bounds: &Aabb) -> Rect {
        let (middle, half) = (self.of(bounds.center()), 0.5 * bounds.size());
        let reach = DVec2::new(half.dot(self.basis.right.abs()), half.dot(self.basis.up.abs()));
        [middle - reach, middle + reach]
    }
}

fn around_all(points: impl IntoIterator<Item = DVec2>) -> Rect {
    points.into_iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

/// The next step up of sides that are a fourth root of two apart.
fn in_steps(length: f64) -> f64 {
    ((4.0 * length.max(LEAST_SIDE_M).log2()).ceil() / 4.0).exp2()
}

/// Between which depths a view shows something of these boxes, metres along its axis.
fn depths(view: &View, boxes: &[Aabb]) -> [f64; 2] {
    let forward = view.basis.forward;
    let reach = |bounds: &Aabb| 0.5 * bounds.size().dot(forward.abs());
    let front = |bounds: &Aabb| view.depth(bounds.center()) - reach(bounds);
    let far = boxes.iter().map(|bounds| view.depth(bounds.center()) + reach(bounds)).fold(0.0, f64::max);
    // A box that goes on beside the picture may begin much nearer than what the picture shows of it.
    let sides = view.frustum(1.0).sides.map(|side| (-side.normal, -side.offset));
    let mut near = far;
    let first = boxes.iter().min_by(|a, b| front(a).total_cmp(&front(b)));
    for bounds in first.into_iter().chain(boxes) {
        if front(bounds) < near {
            near = near.min(nearest_in(bounds, &sides, view));
        }
    }
    [near, far].map(|depth| depth.max(view.camera.near_m))
}

/// From which depth on no shadow of these casters is as long as it must be, metres; ∞ for parallel rays.
fn farthest(view: &View, casters: &Aabb, to_sun: DVec3) -> f64 {
    if view.is_orthographic() {
        return f64::INFINITY;
    }
    let per_height = (to_sun.truncate().length() / to_sun.z.max(1e-6)).max(1.0);
    casters.size().z * per_height / (LEAST_PX * view.pixel_m(1.0))
}

/// How near a good part of a picture is: nearer than this there is less than [`MUCH`] of what boxes cover of it, metres, rounded down to a
/// power of two.
fn near_part(view: &View, boxes: &[Aabb]) -> f64 {
    const LEAST: i32 = -8;
    let (mut areas, width) = ([0.0; 40], 2.0 * view.half_extent().max_element());
    for bounds in boxes {
        let distance = bounds.distance_to(view.camera.eye).max(view.camera.near_m);
        let octave = (distance.log2().floor() as i32 - LEAST).clamp(0, areas.len() as i32 - 1);
        areas[octave as usize] += (bounds.size().length() / (distance * width)).powi(2).min(1.0);
    }
    let wanted = MUCH * areas.iter().sum::<f64>();
    let mut before = 0.0;
    let reached = areas.iter().position(|area| {
        before += area;
        before > wanted
    });
    f64::from(reached.unwrap_or(0) as i32 + LEAST).exp2()
}

/// The least depth of what a box has inside all half spaces n·p ≤ d; ∞ where that is nothing.
fn nearest_in(bounds: &Aabb, sides: &[(DVec3, f64)], view: &View) -> f64 {
    let eye = view.camera.eye;
    if bounds.distance_to(eye) <= view.camera.near_m {
        return view.camera.near_m;
    }
    // In the eye's place, where national coordinates lose no digits.
    let own: Vec<(DVec3, f64)> = sides.iter().map(|(normal, offset)| (*normal, offset - normal.dot(eye))).collect();
    faces_in(bounds, eye, &own).into_iter().map(|p| p.dot(view.basis.forward)).fold(f64::INFINITY, f64::min)
}

/// Corners, from `origin`, of what the faces of a box have inside all half spaces n·p ≤ d, which are counted from there too.
fn faces_in(bounds: &Aabb, origin: DVec3, sides: &[(DVec3, f64)]) -> Vec<DVec3> {
    // Corners by number: x, y and z in bits 0, 1 and 2.
    const FACES: [[usize; 4]; 6] = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
    let corners = bounds.corners().map(|corner| corner - origin);
    FACES.iter().flat_map(|face| clipped(&face.map(|k| corners[k]), sides.iter().copied())).collect()
}

/// The corners of the picture at a depth.
fn corners_at(view: &View, depth: f64) -> [DVec3; 4] {
    let [w, h] = view.size.map(f64::from);
    // Samples lie up to a pixel beside.
    [[-1.0, -1.0], [w + 1.0, -1.0], [-1.0, h + 1.0], [w + 1.0, h + 1.0]]
        .map(|[x, y]| view.ray(DVec2::new(x, y)).at(depth))
}

/// Squares of levels to be: where they grow from, as the sun sees it, where that is in each, and how wide they are.
struct Fit {
    anchor: DVec2,
    shift: DVec2,
    sides: Vec<f64>,
    ratio: f64,
    /// How many pixels a texel is wide where that is most.
    pixels: f64,
}

/// What a picture shows, as the sun sees it.
struct Shown<'a> {
    across: Across,
    view: &'a View,
    boxes: &'a [Aabb],
    /// The nearest and the farthest of it that may show shadows, metres along the view axis.
    depths: [f64; 2],
    /// From where on texels are to be as small as pixels.
    near_part: f64,
}

impl<'a> Shown<'a> {
    fn new(view: &'a View, boxes: &'a [Aabb], casters: &Aabb, direction: DVec3) -> Self {
        let across = Across { origin: view.camera.eye, basis: Basis::looking_along(-direction, DVec3::Z) };
        let [near, far] = depths(view, boxes);
        let far = far.min(farthest(view, casters, direction).max(4.0 * near));
        // Where something is near, but next to nothing of the picture, it need not be told how much is.
        let least = NEAREST * far;
        let near_part = if near < least { least.min(near_part(view, boxes)) } else { least };
        Self { across, view, boxes, depths: [near, far], near_part }
    }

    /// How many pixels a length is wide from a depth on.
    fn pixels(&self, length: f64, depth: f64) -> f64 {
        let [near, far] = self.depths;
        length / self.view.pixel_m(depth.clamp(near.max(self.near_part).min(far), far))
    }

    /// Squares for a map of so many texels each way, which may be so many pixels wide.
    fn fit(&self, size: u32, texel_px: f64) -> Fit {
        let single = self.single(size.into());
        if self.view.is_orthographic() || single.pixels <= texel_px.max(1.0) {
            return single;
        }
        let growing = self.growing((size / 2).into());
        if growing.pixels * WORTH < single.pixels { growing } else { single }
    }

    /// One square around all of it.
    fn single(&self, texels: f64) -> Fit {
        let Self { across, view, depths: [near, far], .. } = *self;
        let picture = around_all([near, far].into_iter().flat_map(|d| corners_at(view, d)).map(|p| across.of(p)));
        let shown = |bounds: &Aabb| {
            let [low, high] = across.around(bounds);
            let [low, high] = [low.max(picture[0]), high.min(picture[1])];
            low.cmple(high).all().then_some([low, high])
        };
        let [low, high] = around_all(self.boxes.iter().filter_map(shown).flatten());
        let [low, high] = if low.cmple(high).all() { [low, high] } else { picture };
        let side = in_steps((high - low).max_element() / (1.0 - 2.0 * FILTER_TEXELS / texels - 1.0 / GRID_PARTS));
        let pixels = self.pixels(side / texels, near);
        Fit { anchor: 0.5 * (low + high), shift: DVec2::splat(0.5), sides: vec![side], ratio: 1.0, pixels }
    }

    /// Squares that grow with the picture, from the eye to the farthest of it.
    fn growing(&self, texels: f64) -> Fit {
        let Self { across, view, depths: [_, far], .. } = *self;
        let eye = across.of(view.camera.eye);
        let corners = corners_at(view, 1.0).map(|p| across.of(p) - eye);
        let [low, high] = around_all(corners.into_iter().chain([DVec2::ZERO]));
        // What filters reach; how far the eye may be from its place on the grid, and in a level.
        let room = (FILTER_TEXELS + 0.5 * GRID_TEXELS.min(texels / 32.0)) / texels + 0.5 / SHIFTS;
        // Along the light the picture is as wide as its own angle is.
        let of_depth = (high - low).max_element() / (1.0 - 2.0 * room);
        let shift = ((0.5 - 0.5 * (low + high) / of_depth) * SHIFTS).round() / SHIFTS;
        // The widest need not reach beyond the city.
        let inner = [shift - room, 1.0 - shift - room].map(|v| v.max(DVec2::splat(1e-3)));
        let needed = self.boxes.iter().map(|bounds| {
            let [from, to] = across.around(bounds).map(|p| (p - eye).clamp(low * far, high * far));
            (-from / inner[0]).max(to / inner[1]).max_element()
        });
        let widest = needed.fold(0.0, f64::max).min(of_depth * far);
        let of_ratio = |ratio: f64| {
            let first = in_steps(widest / ratio.powi(LEVELS as i32 - 1));
            let sides: Vec<f64> = (0..LEVELS as i32).map(|level| first * ratio.powi(level)).collect();
            // Each begins where the one before ends.
            let begins = [0.0].into_iter().chain(sides.iter().map(|side| side / of_depth));
            let wide = sides.iter().zip(begins).map(|(side, from)| self.pixels(side / texels, from));
            Fit { anchor: eye, shift, pixels: wide.fold(0.0, f64::max), sides, ratio }
        };
        let [first, others @ ..] = RATIOS.map(of_ratio);
        others.into_iter().fold(first, |best, fit| if fit.pixels < best.pixels { fit } else { best })
    }
}

impl Fit {
    /// Texels of the first level between places that squares may have.
    fn grid(&self, texels: f64) -> f64 {
        let widest = self.ratio.powi(LEVELS as i32 - 1);
        if self.ratio > 1.0 {
            widest.min(GRID_TEXELS).min(texels / 32.0).max(1.0)
        } else {
            (texels / GRID_PARTS).floor()
        }
    }
}

impl SunEye {
    /// The eye of a light from `direction` (unit, towards it) on what `view` shows of the boxes `seen`, beyond all of `casters`.
    /// `None` where nothing is to be seen. What is so far that no shadow is as long as half a pixel there may be beyond it.
    pub fn new(view: &View, direction: DVec3, seen: &[Aabb], casters: &Aabb, wanted: &MapSize) -> Option<Self> {
        if seen.is_empty() || casters.is_empty() {
            return None;
        }
        let size = Self::size_for(view, wanted, seen, casters);
        let shown = Shown::new(view, seen, casters, direction);
        let (fit, across) = (shown.fit(size, wanted.texel_px), shown.across);
        let texels = if fit.sides.len() == 1 { size } else { size / 2 };
        // On the grid, counted from the world's own origin.
        let step = fit.sides[0] / f64::from(texels) * fit.grid(texels.into());
        let from_world = across.turned(across.origin);
        let place = ((from_world + fit.anchor) / step).round() * step;
        // By the world's origin alone, to the bit: a map that is held need not be drawn anew.
        let anchor = place.x * across.basis.right - place.y * across.basis.up;
        let all = seen.iter().fold(*casters, |all, bounds| all.union(*bounds));
        // What is not between the sun and the widest square neither throws nor takes shadows there: depth is counted in what is.
        let widest = fit.sides.iter().copied().fold(0.0, f64::max);
        let aside = (0.5 - fit.shift) * widest;
        let middle = anchor + aside.x * across.basis.right - aside.y * across.basis.up;
        let sides = [across.basis.right, across.basis.up].map(|axis| [axis, -axis].map(|axis| (axis, WIDER * widest)));
        let along = faces_in(&all, middle, sides.as_flattened()).into_iter().map(|p| p.dot(direction));
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
        let [low, beyond] = if low <= high { [low, high + ROOM_M] } else { [0.0, ROOM_M] };
        let level = |side: &f64| {
            let middle = (0.5 - fit.shift) * *side;
            let eye = anchor + middle.x * across.basis.right - middle.y * across.basis.up + beyond * direction;
            let camera = Camera {
                eye,
                target: eye - (beyond - low) * direction,
                up: DVec3::Z,
                projection: Projection::Orthographic { height_m: *side },
                near_m: 1.0,
            };
            let view = View::new(camera, [texels; 2], &all).ok()?;
            Some(View { far_m: beyond - low + ROOM_M, ..view })
        };
        let levels = fit.sides.iter().map(level).collect::<Option<Vec<View>>>()?;
        Some(Self { levels, size, ratio: fit.ratio, anchor, shift: fit.shift })
    }

    /// Texels along a side of the map for what `view` shows of the boxes `seen`.
    fn size_for(view: &View, wanted: &MapSize, seen: &[Aabb], casters: &Aabb) -> u32 {
        // Two levels side by side have as many texels each.
        let sizes = [8, 4, 2, 1].map(|part| (wanted.most.max(LEAST_SHADOW_SIZE) / part) & !1);
        let [.., most] = sizes;
        if wanted.texel_px == 0.0 {
            return most;
        }
        let shown = Shown::new(view, seen, casters, wanted.towards);
        let large = || sizes.into_iter().filter(|size| *size >= LEAST_SHADOW_SIZE);
        // One level draws less than four.
        let single = large().find(|size| shown.single(f64::from(*size)).pixels <= wanted.texel_px);
        single.or_else(|| large().find(|size| shown.fit(*size, 0.0).pixels <= wanted.texel_px)).unwrap_or(most)
    }

    /// The widest level: it holds all that is seen, and the others.
    pub fn widest(&self) -> &View {
        &self.levels[self.levels.len() - 1]
    }

    /// A level as shaders read it. All have one eye, that of the widest, so that they count places and depths alike.
    pub fn uniform(&self, level: usize) -> layout::View {
        let (own, widest) = (&self.levels[level], self.widest());
        let mut uniform = view_uniform(widest, PictureTile::whole(widest.size), DVec2::ZERO, 0, 0.0);
        let aside = own.camera.eye - widest.camera.eye;
        let scale = 1.0 / own.half_extent();
        let shift = -DVec2::new(aside.dot(widest.basis.right), aside.dot(widest.basis.up)) * scale;
        uniform.projection = [scale.x, scale.y, shift.x, shift.y].map(|v| v as f32);
        uniform
    }

    /// The texels of a level: left, top, and its side.
    pub fn place(&self, level: usize) -> [u32; 3] {
        let side = self.levels[level].size[0];
        [level as u32 % 2 * side, level as u32 / 2 * side, side]
    }

    /// From places relative to `eye`, metres: right and down from where the levels grow from, metres, and depth as the map stores it.
    pub fn across_from_relative(&self, eye: DVec3) -> DMat4 {
        let widest = self.widest();
        let (Basis { right, up, .. }, from) = (widest.basis, eye - self.anchor);
        let depth = (widest.clip_from_relative(DVec2::ZERO) * DMat4::from_translation(eye - widest.camera.eye)).row(2);
        let row = |axis: DVec3| axis.extend(axis.dot(from));
        DMat4::from_cols(row(right), row(-up), depth, DVec4::W).transpose()
    }

    /// What the first level's side is, as a share per metre.
    pub fn scale(&self) -> f64 {
        0.5 / self.levels[0].half_extent().y
    }

    /// Metres that one unit of stored depth spans.
    pub fn depth_step_m(&self) -> f64 {
        let widest = self.widest();
        widest.far_m - widest.camera.near_m
    }

    /// How levels follow each other, as `lib/light.wgsl` unpacks it: the anchor's place in them, right and down, in parts of a
    /// [`SHIFTS`]-th of their sides, and how much wider each is than the one before.
    pub fn packed(&self) -> u32 {
        let [x, y] = (self.shift * SHIFTS).to_array().map(|v| v as u32);
        x | y << 8 | (self.ratio as u32) << 16
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{render::light::to_sun, scene::Sun};

    const SIZE: u32 = 4096;

    /// With the whole map.
    fn of_size(view: &View, direction: DVec3, seen: &[Aabb], casters: &Aabb, size: u32) -> Option<SunEye> {
        SunEye::new(view, direction, seen, casters, &MapSize { most: size, texel_px: 0.0, towards: direction })
    }

    fn town() -> (Vec<Aabb>, Aabb) {
        let at = |i: i32| DVec3::new(8e4 + f64::from(i % 40) * 50.0, 4e5 + f64::from(i / 40) * 50.0, -2.0);
        let boxes: Vec<Aabb> =
            (0..1600).map(|i| Aabb { min: at(i), max: at(i) + DVec3::new(50.0, 50.0, 40.0) }).collect();
        let all = boxes.iter().fold(Aabb::EMPTY, |all, bounds| all.union(*bounds));
        (boxes, Aabb { max: all.max + 60.0, ..all })
    }

    fn suns() -> impl Iterator<Item = DVec3> {
        [(100.0, 15.0), (220.0, 45.0), (0.0, 90.0), (300.0, 2.0)].into_iter().map(|(azimuth, elevation): (f64, f64)| {
            to_sun(&Sun { azimuth: azimuth.to_radians(), elevation: elevation.to_radians(), ..Sun::default() })
        })
    }

    fn eyes() -> Vec<Camera> {
        let middle = DVec3::new(8.1e4, 4.01e5, 10.0);
        let street = DVec3::new(8.05e4, 4.005e5, 1.7);
        vec![
            Camera::looking(middle + DVec3::new(-900.0, -1500.0, 1100.0), middle, 0.8),
            Camera::looking(street, street + DVec3::new(100.0, 60.0, 0.0), 1.0),
            Camera::looking(street, street + DVec3::new(-100.0, 10.0, 5.0), 1.6),
            Camera {
                projection: Projection::Orthographic { height_m: 250.0 },
                ..Camera::looking(middle + DVec3::Z * 300.0, middle, 0.8)
            },
        ]
    }

    /// Where a place is in the levels that hold it: level, its share of the side, and depth; as the shader works it out.
    fn held(eye: &SunEye, place: DVec3, camera: DVec3) -> Vec<(usize, DVec2, f64)> {
        let at = eye.across_from_relative(camera).transform_point3(place - camera);
        let mut scale = eye.scale();
        let mut all = Vec::new();
        for level in 0..eye.levels.len() {
            let local = at.truncate() * scale + eye.shift;
            if local.cmpge(DVec2::ZERO).all() && local.cmple(DVec2::ONE).all() {
                all.push((level, local, at.z));
            }
            scale /= eye.ratio;
        }
        all
    }

    #[test]
    fn the_nearest_is_that_of_the_picture_and_not_of_a_box_beside_it() {
        let (boxes, casters) = town();
        for camera in [eyes()[0], eyes()[1]] {
            let view = View::new(camera, [640, 400], &casters).unwrap();
            let frustum = view.frustum(1.0);
            let seen: Vec<Aabb> = boxes.iter().filter(|b| frustum.meets(b)).copied().collect();
            let [near, far] = depths(&view, &seen);
            // Points on the sides of the boxes, a metre and a half apart.
            let mut points = [f64::INFINITY, 0.0_f64];
            for (bounds, [a, b, c]) in
                seen.iter().flat_map(|bounds| [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|axes| (bounds, axes)))
            {
                for i in 0..31 * 31 * 2 {
                    let mut at = DVec3::ZERO;
                    (at[a], at[b], at[c]) =
                        (f64::from(i % 31) / 30.0, f64::from(i / 31 % 31) / 30.0, f64::from(i / 961));
                    let p = bounds.min + at * bounds.size();
                    if frustum.contains(p) {
                        points = [points[0].min(view.depth(p)), points[1].max(view.depth(p))];
                    }
                }
            }
            let near_m = view.camera.near_m;
            assert!(near <= points[0] && points[0] <= near + 3.0, "{near}, by points {points:?}");
            assert!(near >= near_m && far >= points[1], "{far}, by points {points:?}");
        }
    }

    /// Looks for what is seen in the levels, and for it there through the uniforms that they are drawn with. How many places were found.
    fn find_all(camera: Camera, sun: DVec3, size: [u32; 2]) -> Result<usize, String> {
        let (boxes, casters) = town();
        let view = View::new(camera, size, &casters).map_err(|error| error.to_string())?;
        let frustum = view.frustum(1.0);
        let seen: Vec<Aabb> = boxes.iter().filter(|bounds| frustum.meets(bounds)).copied().collect();
        let Some(eye) = of_size(&view, sun, &seen, &casters, SIZE) else { return Ok(0) };
        let [near, far] = depths(&view, &seen);
        let along = (0..=6).flat_map(|i| corners_at(&view, near * (far / near).powf(f64::from(i) / 6.0)));
        let places = seen.iter().flat_map(|bounds| bounds.corners()).chain(seen.iter().map(Aabb::center)).chain(along);
        let last = farthest(&view, &casters, sun).max(4.0 * near);
        let is_there = |p: &DVec3| {
            frustum.contains(*p) && view.depth(*p) <= last && seen.iter().any(|bounds| bounds.distance_to(*p) == 0.0)
        };
        let mut count = 0;
        for place in places.filter(is_there) {
            let levels = held(&eye, place, camera.eye);
            if levels.is_empty() {
                return Err(format!("{place} is in none"));
            }
            for (level, local, depth) in levels {
                let uniform = eye.uniform(level);
                let from_eye = place - eye.widest().camera.eye;
                let across = DVec2::new(from_eye.dot(eye.widest().basis.right), from_eye.dot(eye.widest().basis.up));
                let [x, y, z, w] = uniform.projection.map(f64::from);
                let ndc = across * DVec2::new(x, y) + DVec2::new(z, w);
                let drawn = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
                // The scale and the shift of a small level are rounded to f32 beside a widest one 4096 times as wide.
                let texels = (drawn - local).abs().max_element() * f64::from(eye.levels[level].size[0]);
                if texels > 0.1 || !(0.0..=1.0).contains(&depth) {
                    return Err(format!("{place}, level {level}: {drawn} and {local}, depth {depth}"));
                }
            }
            count += 1;
        }
        // Whatever throws a shadow onto the widest square has a depth there.
        let step = casters.size() / 8.0;
        let of = |i: i32| DVec3::new(f64::from(i % 9), f64::from(i / 9 % 9), f64::from(i / 81));
        let casting = (0..729).map(|i| casters.min + step * of(i)).flat_map(|place| held(&eye, place, camera.eye));
        match casting.map(|(_, _, depth)| depth).find(|depth| !(0.0..=1.0).contains(depth)) {
            Some(depth) => Err(format!("a caster is cut off: {depth}")),
            None => Ok(count),
        }
    }

    #[test]
    fn all_that_is_seen_is_in_a_level_that_draws_it_there() {
        for (sun, camera) in suns().flat_map(|sun| eyes().into_iter().map(move |camera| (sun, camera))) {
            let found = find_all(camera, sun, [640, 400]);
            assert!(found.as_ref().is_ok_and(|count| *count > 20), "{found:?}, {sun:?}, {camera:?}");
        }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn nothing_is_lost_from_any_eye(
            at in prop::array::uniform3(0.0..1.0f64), way in prop::array::uniform3(-1.0..1.0f64), along_light in any::<bool>(),
            fov_deg in prop::sample::select(vec![0.01, 0.3, 20.0, 60.0, 120.0, 179.0]), height in prop::option::of(1e-3..5e3f64),
            azimuth in 0.0..6.3f64, elevation in 0.011..1.57f64, size in prop::sample::select(vec![[1, 1], [640, 400], [3, 900]]),
        ) {
            let eye = DVec3::new(8e4, 4e5, 0.0) + DVec3::from(at) * DVec3::new(2000.0, 2000.0, 60.0);
            let sun = to_sun(&Sun { azimuth, elevation, ..Sun::default() });
            // Right along the light nothing of the picture's depth is across it.
            let way = if along_light { -sun } else { DVec3::from(way) };
            prop_assume!(way.length() > 1e-3);
            let mut camera = Camera::looking(eye, eye + 100.0 * way, f64::to_radians(fov_deg));
            if let Some(height_m) = height {
                camera.projection = Projection::Orthographic { height_m };
            }
            let found = find_all(camera, sun, size);
            prop_assert!(found.is_ok(), "{:?}", found);
        }
    }

    #[test]
    fn levels_lie_in_each_other_and_texels_are_small_where_things_are_near() {
        let (boxes, casters) = town();
        for sun in suns() {
            let view = View::new(eyes()[1], [640, 400], &casters).unwrap();
            let eye = of_size(&view, sun, &boxes, &casters, SIZE).unwrap();
            assert_eq!(eye.levels.len(), LEVELS);
            for pair in eye.levels.windows(2) {
                let aside = pair[1].camera.eye - pair[0].camera.eye;
                let basis = pair[0].basis;
                let aside = DVec2::new(aside.dot(basis.right), aside.dot(basis.up)).abs().max_element();
                assert!(aside + pair[0].half_extent().y <= pair[1].half_extent().y * (1.0 + 1e-9));
            }
            // The first level has texels of centimetres, in a city of two kilometres.
            let texel = eye.levels[0].pixel_m(1.0);
            assert!(texel < 0.06, "{texel} m");
            let overview = View::new(eyes()[0], [640, 400], &casters).unwrap();
            let eye = of_size(&overview, sun, &boxes, &casters, SIZE).unwrap();
            assert_eq!((eye.levels.len(), eye.levels[0].size), (1, [SIZE; 2]));
        }
    }

    /// A house whose coordinates are lost, far away in the picture, costs what is near nothing that one sees.
    #[test]
    fn what_strays_leaves_what_is_near_its_texels() {
        let house = |x: f64| Aabb { min: DVec3::new(x, 0.0, 0.0), max: DVec3::new(x + 12.0, 12.0, 15.0) };
        let ground = |x: f64| Aabb { min: DVec3::new(-500.0, -500.0, 0.0), max: DVec3::new(x + 500.0, 500.0, 0.0) };
        let camera = Camera::looking(DVec3::new(-40.0, 10.0, 20.0), DVec3::new(18.0, 6.0, 5.0), 0.8);
        let texel = |far: f64| {
            let seen = [house(0.0), house(25.0), house(far), ground(far)];
            let casters = seen.iter().fold(Aabb::EMPTY, |all, bounds| all.union(*bounds));
            let view = View::new(camera, [1280, 720], &casters).unwrap();
            let sun = to_sun(&Sun { azimuth: 2.2, elevation: 0.7, ..Sun::default() });
            let eye = of_size(&view, sun, &seen, &casters, SIZE).unwrap();
            // The nearest house is 40 m away.
            let held = held(&eye, DVec3::new(0.0, 0.0, 7.0), camera.eye);
            let texel = eye.levels[held[0].0].pixel_m(1.0);
            // Steps of depths between a half and 1, beside what a surface is pushed off itself (`lib/light.wgsl`).
            let step = eye.depth_step_m() * 2_f64.powi(-24);
            assert!(step < 0.35 * texel, "{far}: steps of {step} m, texels of {texel} m");
            texel / view.pixel_m(40.0)
        };
        let near = texel(50.0);
        for far in [2e3, 2e4, 2e5, 2e6, 2e7] {
            assert!(texel(far) < 4.0, "{far}: {} pixels, {near} where nothing strays", texel(far));
        }
    }

    #[test]
    fn what_is_far_beside_the_picture_changes_no_texel() {
        let (boxes, casters) = town();
        let camera = Camera {
            projection: Projection::Orthographic { height_m: 250.0 },
            ..Camera::looking(DVec3::new(8.1e4, 4.01e5, 300.0), DVec3::new(8.1e4, 4.01e5, 0.0), 0.8)
        };
        let view = View::new(camera, [640, 400], &casters).unwrap();
        let seen: Vec<Aabb> = boxes.into_iter().filter(|bounds| view.frustum(1.0).meets(bounds)).collect();
        let far = Aabb { min: casters.min - 2e4, max: casters.max };
        for sun in suns().take(2) {
            let [near, wide] = [&casters, &far].map(|all| of_size(&view, sun, &seen, all, SIZE).unwrap());
            assert_eq!((near.scale(), near.packed()), (wide.scale(), wide.packed()));
            assert!((near.anchor - wide.anchor).length() < 1e-9);
        }
    }

    /// A map that is held need not be drawn: its views are the same to the bit.
    #[test]
    fn most_steps_of_an_eye_leave_the_views_as_they_are() {
        let (boxes, casters) = town();
        // Shares of the distance: from a street centimetres.
        let steps = [2e-3, 2e-4, 2e-4, 2e-3];
        for (sun, (camera, step_share)) in suns().flat_map(|sun| eyes().into_iter().zip(steps).map(move |c| (sun, c))) {
            let of = |step: u32| {
                let aside = (camera.target - camera.eye).cross(camera.up).normalize_or(DVec3::X);
                let aside = aside * (step_share * f64::from(step) * camera.eye.distance(camera.target));
                let view = View::new(Camera { eye: camera.eye + aside, ..camera }, [640, 400], &casters).unwrap();
                let seen: Vec<Aabb> = boxes.iter().filter(|b| view.frustum(1.0).meets(b)).copied().collect();
                let eye = of_size(&view, sun, &seen, &casters, SIZE).unwrap();
                (0..eye.levels.len()).map(|level| eye.uniform(level)).collect::<Vec<_>>()
            };
            let views: Vec<_> = (0..40).map(of).collect();
            let drawn = views.windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(drawn <= 12, "{drawn} of 39, {sun:?}, {camera:?}");
        }
    }

    #[test]
    fn small_steps_of_the_eye_leave_the_squares_where_they_are() {
        let (boxes, casters) = town();
        for (sun, camera) in suns().flat_map(|sun| eyes().into_iter().map(move |camera| (sun, camera))) {
            let of = |by: DVec3| {
                let camera = Camera { eye: camera.eye + by, target: camera.target + by, ..camera };
                of_size(&View::new(camera, [640, 400], &casters).unwrap(), sun, &boxes, &casters, SIZE).unwrap()
            };
            let first = of(DVec3::ZERO);
            let grid = first.levels[0].pixel_m(1.0);
            for step in 1..20 {
                let next = of(f64::from(step) * DVec3::new(0.013, -0.021, 0.004));
                if next.scale() != first.scale() {
                    continue;
                }
                let basis = first.widest().basis;
                let moved = next.anchor - first.anchor;
                for axis in [basis.right, basis.up] {
                    let texels = moved.dot(axis) / grid;
                    assert!((texels - texels.round()).abs() < 1e-3, "{texels} texels");
                }
            }
        }
    }
}
