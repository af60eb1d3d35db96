//! Where the sun looks: the parts of the shadow map, fitted to what a picture shows.
//!
//! A picture whose parts are about as far away as each other has one square of the map's whole size around what it shows. Where
//! some are much nearer than others, four squares share the map, each two, four or eight times as wide as the one before: what is
//! near has small texels. A perspective eye sees the same from each of its distances, only larger; so all four have the place of
//! the eye at the same share of their sides, and a place finds its square with few numbers: `across · scale + shift` is
//! inside the first for the largest `scale` that fits.
//!
//! Squares stay where they are while the eye moves by less than a texel of the widest, and sides come in steps of a fourth root of two:
//! borders of shadows do not crawl through an animation.

use glam::{DMat4, DVec2, DVec3, DVec4};

use crate::{
    geom::Aabb,
    render::{
        eye::{PictureTile, view_uniform},
        layout,
        light::{LEAST_SHADOW_SIZE, to_sun},
    },
    scene::Sun,
    view::{Basis, Camera, Projection, View},
};

/// Levels of a map that has more than one.
const LEVELS: usize = 4;
/// What is farther than so many times the distance of the nearest may ask for more than one level.
const SINGLE_RATIO: f64 = 5.0;
/// Nearer than such a part of the farthest distance there is seldom anything to see, whatever boxes say.
const NEAREST: f64 = 1.0 / 64.0;
/// How far the first level should reach at most, metres.
const FIRST_M: f64 = 30.0;
/// How much wider each level may be than the one before.
const RATIOS: [f64; 3] = [2.0, 4.0, 8.0];
/// What filters, and the push off a surface, reach beyond a place: texels.
const FILTER_TEXELS: f64 = 6.0;
/// The eye's place in a level is a whole number of these parts of its side.
const SHIFTS: f64 = 64.0;
/// Squares stand on a grid of at most so many texels.
const GRID_TEXELS: f64 = 64.0;

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

    fn place(&self, across: DVec2) -> DVec3 {
        self.origin + across.x * self.basis.right - across.y * self.basis.up
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

/// The next step up of sizes that are a fourth root of two apart.
fn in_steps(length: f64) -> f64 {
    ((4.0 * length.log2()).ceil() / 4.0).exp2()
}

/// How far a view reaches where it meets these boxes: nearest and farthest, metres along its axis.
fn depths(view: &View, boxes: &[Aabb]) -> [f64; 2] {
    let forward = view.basis.forward;
    let one = |bounds: &Aabb| {
        let (middle, reach) = (view.depth(bounds.center()), 0.5 * bounds.size().dot(forward.abs()));
        [middle - reach, middle + reach]
    };
    let all = boxes.iter().map(one).fold([f64::INFINITY, 0.0_f64], |[near, far], [a, b]| [near.min(a), far.max(b)]);
    all.map(|depth| depth.max(view.camera.near_m))
}

/// The corners of the picture at a depth.
fn corners_at(view: &View, depth: f64) -> [DVec3; 4] {
    let [w, h] = view.size.map(f64::from);
    // Samples lie up to a pixel beside.
    [[-1.0, -1.0], [w + 1.0, -1.0], [-1.0, h + 1.0], [w + 1.0, h + 1.0]]
        .map(|[x, y]| view.ray(DVec2::new(x, y)).at(depth))
}

/// A square of levels to be: where they grow from, as the sun sees it, where that is in each, and how wide they are.
struct Fit {
    anchor: DVec2,
    shift: DVec2,
    sides: Vec<f64>,
    ratio: f64,
}

impl Fit {
    /// One square around what a picture shows of these boxes between two depths.
    fn single(across: &Across, view: &View, seen: &[Aabb], [near, far]: [f64; 2], texels: f64) -> Self {
        let picture = around_all([near, far].into_iter().flat_map(|d| corners_at(view, d)).map(|p| across.of(p)));
        let shown = |bounds: &Aabb| {
            let [low, high] = across.around(bounds);
            let [low, high] = [low.max(picture[0]), high.min(picture[1])];
            low.cmple(high).all().then_some([low, high])
        };
        let [low, high] = around_all(seen.iter().filter_map(shown).flatten());
        let [low, high] = if low.cmple(high).all() { [low, high] } else { picture };
        let side = in_steps((high - low).max_element().max(1.0) / (1.0 - 2.0 * FILTER_TEXELS / texels));
        Self { anchor: 0.5 * (low + high), shift: DVec2::splat(0.5), sides: vec![side], ratio: 1.0 }
    }

    /// Squares that grow with the picture, from the eye to the farthest that it shows of these boxes.
    fn growing(across: &Across, view: &View, seen: &[Aabb], [near, far]: [f64; 2], texels: f64) -> Self {
        let eye = across.of(view.camera.eye);
        let [low, high] =
            around_all(corners_at(view, 1.0).map(|p| across.of(p) - eye).into_iter().chain([DVec2::ZERO]));
        // What filters reach; how far the eye may be from its place on the grid, and in a level.
        let room = (FILTER_TEXELS + 0.5 * GRID_TEXELS.min(texels / 32.0)) / texels + 0.5 / SHIFTS;
        let of_depth = (high - low).max_element().max(1e-3) / (1.0 - 2.0 * room);
        let shift = ((0.5 - 0.5 * (low + high) / of_depth) * SHIFTS).round() / SHIFTS;
        // The widest need not reach beyond the city.
        let inner = [shift - room, 1.0 - shift - room].map(|v| v.max(DVec2::splat(1e-3)));
        let needed = seen.iter().map(|bounds| {
            let [from, to] = across.around(bounds).map(|p| (p - eye).clamp(low * far, high * far));
            (-from / inner[0]).max(to / inner[1]).max_element()
        });
        let widest = needed.fold(0.0, f64::max).clamp(1.0, of_depth * far);
        let first = |ratio: f64| widest / of_depth / ratio.powi(LEVELS as i32 - 1);
        let most = RATIOS[RATIOS.len() - 1];
        let ratio = RATIOS.into_iter().find(|ratio| first(*ratio) <= FIRST_M.max(2.0 * near)).unwrap_or(most);
        let side = in_steps(widest / ratio.powi(LEVELS as i32 - 1));
        let sides = (0..LEVELS as i32).map(|level| side * ratio.powi(level)).collect();
        Self { anchor: eye, shift, sides, ratio }
    }

    /// Texels of the first level between places that squares may have.
    fn grid(ratio: f64, texels: f64) -> f64 {
        let widest = ratio.powi(LEVELS as i32 - 1);
        if ratio > 1.0 { widest.min(GRID_TEXELS).min(texels / 32.0).max(1.0) } else { 1.0 }
    }
}

impl SunEye {
    /// The sun's eye on what `view` shows of the boxes `seen`, beyond all of `casters`; a map of `size` × `size` texels.
    /// `None` where nothing is to be seen.
    pub fn new(view: &View, sun: &Sun, seen: &[Aabb], casters: &Aabb, size: u32) -> Option<Self> {
        let size = size.max(LEAST_SHADOW_SIZE);
        if seen.is_empty() || casters.is_empty() {
            return None;
        }
        let direction = to_sun(sun);
        let across = Across { origin: view.camera.eye, basis: Basis::looking_along(-direction, DVec3::Z) };
        let reach = depths(view, seen);
        let single = Fit::single(&across, view, seen, reach, size.into());
        // Where its texels are no larger than any pixel is wide, more levels would show nothing.
        let nearest = reach[0].max(NEAREST * reach[1]);
        let is_single = view.is_orthographic()
            || reach[1] <= SINGLE_RATIO * reach[0]
            || single.sides[0] / f64::from(size) <= view.pixel_m(nearest);
        let texels = if is_single { size } else { size / 2 };
        let fit = if is_single { single } else { Fit::growing(&across, view, seen, reach, texels.into()) };
        // On the grid, counted from the world's own origin.
        let step = fit.sides[0] / f64::from(texels) * Fit::grid(fit.ratio, texels.into());
        let from_world = across.turned(across.origin);
        let anchor = across.place(((from_world + fit.anchor) / step).round() * step - from_world);
        let beyond = casters.corners().into_iter().map(|c| (c - anchor).dot(direction)).fold(0.0, f64::max) + 10.0;
        let all = seen.iter().fold(*casters, |all, bounds| all.union(*bounds));
        let level = |side: &f64| {
            let middle = (0.5 - fit.shift) * *side;
            let target = anchor + middle.x * across.basis.right - middle.y * across.basis.up;
            let camera = Camera {
                eye: target + beyond * direction,
                target,
                up: DVec3::Z,
                projection: Projection::Orthographic { height_m: side.clamp(1e-3, 1e8) },
                near_m: 1.0,
            };
            View::new(camera, [texels; 2], &all).ok()
        };
        let levels = fit.sides.iter().map(level).collect::<Option<Vec<View>>>()?;
        Some(Self { levels, size, ratio: fit.ratio, anchor, shift: fit.shift })
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
    use super::*;

    const SIZE: u32 = 4096;

    fn town() -> (Vec<Aabb>, Aabb) {
        let at = |i: i32| DVec3::new(8e4 + f64::from(i % 40) * 50.0, 4e5 + f64::from(i / 40) * 50.0, -2.0);
        let boxes: Vec<Aabb> =
            (0..1600).map(|i| Aabb { min: at(i), max: at(i) + DVec3::new(50.0, 50.0, 40.0) }).collect();
        let all = boxes.iter().fold(Aabb::EMPTY, |all, bounds| all.union(*bounds));
        (boxes, Aabb { max: all.max + 60.0, ..all })
    }

    fn suns() -> impl Iterator<Item = Sun> {
        [(100.0, 15.0), (220.0, 45.0), (0.0, 90.0), (300.0, 2.0)].into_iter().map(|(azimuth, elevation): (f64, f64)| {
            Sun { azimuth: azimuth.to_radians(), elevation: elevation.to_radians(), shadows: true }
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
    fn all_that_is_seen_is_in_a_level_that_draws_it_there() {
        let (boxes, casters) = town();
        for (sun, camera) in suns().flat_map(|sun| eyes().into_iter().map(move |camera| (sun, camera))) {
            let view = View::new(camera, [640, 400], &casters).unwrap();
            let frustum = view.frustum(1.0);
            let seen: Vec<Aabb> = boxes.iter().filter(|bounds| frustum.meets(bounds)).copied().collect();
            let eye = SunEye::new(&view, &sun, &seen, &casters, SIZE).expect("something is seen");
            let mut count = 0;
            let places = seen.iter().flat_map(|bounds| bounds.corners()).chain(seen.iter().map(Aabb::center));
            for place in places.filter(|p| frustum.contains(*p)) {
                let levels = held(&eye, place, camera.eye);
                assert!(!levels.is_empty(), "{place} is in none, sun {sun:?}, {camera:?}");
                for (level, local, depth) in levels {
                    // Through the uniform that the map is drawn with.
                    let uniform = eye.uniform(level);
                    let from_eye = place - eye.widest().camera.eye;
                    let across =
                        DVec2::new(from_eye.dot(eye.widest().basis.right), from_eye.dot(eye.widest().basis.up));
                    let [x, y, z, w] = uniform.projection.map(f64::from);
                    let ndc = across * DVec2::new(x, y) + DVec2::new(z, w);
                    let drawn = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
                    // f32 has 24 bits for how far the widest level's eye is from a small one.
                    let texels = (drawn - local).abs().max_element() * f64::from(eye.levels[level].size[0]);
                    assert!(texels < 0.1, "{place}, level {level}: {drawn} and {local}");
                    assert!((0.0..=1.0).contains(&depth), "{depth}");
                }
                count += 1;
            }
            assert!(count > 20, "{count} places");
            for corner in casters.corners() {
                let depth = eye.across_from_relative(camera.eye).transform_point3(corner - camera.eye).z;
                assert!((0.0..=1.0).contains(&depth), "{corner} is cut off: {depth}");
            }
        }
    }

    #[test]
    fn levels_lie_in_each_other_and_texels_are_small_where_things_are_near() {
        let (boxes, casters) = town();
        for sun in suns() {
            let view = View::new(eyes()[1], [640, 400], &casters).unwrap();
            let eye = SunEye::new(&view, &sun, &boxes, &casters, SIZE).unwrap();
            assert_eq!(eye.levels.len(), LEVELS);
            for pair in eye.levels.windows(2) {
                let aside = pair[1].camera.eye - pair[0].camera.eye;
                let basis = pair[0].basis;
                let aside = DVec2::new(aside.dot(basis.right), aside.dot(basis.up)).abs().max_element();
                assert!(aside + pair[0].half_extent().y <= pair[1].half_extent().y * (1.0 + 1e-9));
            }
            // A texel is at most seven pixels wide at half of what its level reaches, in a picture of 1000 rows.
            let texel = eye.levels[0].pixel_m(1.0);
            assert!(texel < 0.06, "{texel} m");
            let overview = View::new(eyes()[0], [640, 400], &casters).unwrap();
            let eye = SunEye::new(&overview, &sun, &boxes, &casters, SIZE).unwrap();
            assert_eq!((eye.levels.len(), eye.levels[0].size), (1, [SIZE; 2]));
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
            let [near, wide] = [&casters, &far].map(|all| SunEye::new(&view, &sun, &seen, all, SIZE).unwrap());
            assert_eq!((near.scale(), near.packed()), (wide.scale(), wide.packed()));
            assert!((near.anchor - wide.anchor).length() < 1e-9);
        }
    }

    #[test]
    fn small_steps_of_the_eye_leave_the_squares_where_they_are() {
        let (boxes, casters) = town();
        for (sun, camera) in suns().flat_map(|sun| eyes().into_iter().map(move |camera| (sun, camera))) {
            let of = |by: DVec3| {
                let camera = Camera { eye: camera.eye + by, target: camera.target + by, ..camera };
                SunEye::new(&View::new(camera, [640, 400], &casters).unwrap(), &sun, &boxes, &casters, SIZE).unwrap()
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
