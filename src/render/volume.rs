//! Lens volumes as the shader reads them: relative to the eye, in view space, rounded once from f64.

use glam::{DVec2, DVec3};

use crate::{
    geom::{Aabb, Volume, shape::Sphere},
    lens::{Border, LensBody, LensSprite},
    render::{
        eye::PictureTile,
        flat, layout,
        operations::body_px,
        placed_region::{Leaf, PlacedLeaf, PlacedRegion},
        screen_bound::ScreenBound,
    },
    scene::{DEFAULT_DPI, POINTS_PER_INCH},
    shader::{Form, LensTest},
    view::View,
};

/// Pixels around a volume's projection that may be where a coarse sprite has it, or show an outline of 1.6 pixels; a wider one is told beside.
const WIDE_MARGIN_PX: i32 = 4;
/// Without these: for samples up to half a pixel beside the pixels' centres, and what rounding moves.
const MARGIN_PX: i32 = 1;

/// The angle from the axis up to which places bound something in a picture: from there on they are as good as beside the eye.
const WIDEST: f64 = 1.55;

/// A volume of one lens.
#[derive(Clone, Debug)]
pub struct LensVolume {
    /// Which lens, from 0.
    pub lens: u32,
    /// What it is; not empty.
    pub region: PlacedRegion,
    /// Box around it, metres.
    pub bounds: Aabb,
    /// Whether its lens acts where rays miss it (class *rest*): then all of the picture is its business.
    pub everywhere: bool,
    /// How its lens' body is drawn.
    pub drawn: LensBody,
    /// Pixels of a point, by which its line or glow is wide.
    pub point_px: f64,
    /// The sprite that it is tested by in the picture, if it is.
    pub sprite: Option<LensSprite>,
    /// Whether its lens acts on other classes than *inside*.
    pub asks_sides: bool,
    /// How its lens ends, if not at once: it acts around the volume, too.
    pub border: Option<Border>,
    /// Whether its lens leaves shadows as they are without it.
    pub keeps_shadows: bool,
    /// The colour of its sections, sRGB.
    pub section: Option<[f32; 3]>,
}

impl LensVolume {
    /// A region by itself, tested from its numbers: its lens acts on what is inside, up to its end.
    pub fn plain(lens: u32, region: PlacedRegion) -> Self {
        Self {
            lens,
            bounds: region.bounds(),
            region,
            everywhere: false,
            drawn: LensBody::None,
            point_px: DEFAULT_DPI / POINTS_PER_INCH,
            sprite: None,
            asks_sides: false,
            border: None,
            keeps_shadows: false,
            section: None,
        }
    }

    /// Whether it is tested by a sprite that has its own eye.
    pub fn has_own_eye(&self) -> bool {
        let is_asked = self.sprite.is_some_and(|sprite| sprite.own.is_some()) && !self.region.has_members();
        is_asked || self.region.saved().is_some()
    }

    /// How it is tested from the sun: the picture's sprites say nothing of what only the sun sees.
    pub fn test_from_sun(&self) -> LensTest {
        if self.has_own_eye() { LensTest::OwnSprite } else { self.region.test() }
    }

    /// How it is tested in the picture; `masks`: all classes are asked for.
    pub fn test(&self, masks: bool) -> LensTest {
        if self.has_own_eye() {
            return LensTest::OwnSprite;
        }
        let with_sides = masks || self.asks_sides || self.drawn != LensBody::None || self.section.is_some();
        match (self.region.test(), self.sprite.filter(|_| !self.region.has_members())) {
            (_, Some(sprite)) if self.region.is_form() && sprite.is_as_the_target() => LensTest::Sprite,
            (_, Some(_)) => LensTest::LayeredSprite,
            (LensTest::Numbers(form), None) if with_sides && (form.is_solid() || form == Form::Combined) => {
                LensTest::Sides(form)
            }
            (own, None) => own,
        }
    }

    /// All ways in which frames may test it, in the picture and from the sun.
    pub fn tests(&self) -> [Vec<LensTest>; 2] {
        let own = self.test_from_sun();
        let picture = match self.test(true) {
            // As a frame asks for its sides or not; whatever its lens asks for, so that lenses may change places.
            sides if sides.has_sides() => vec![own, sides],
            other => vec![other],
        };
        [picture, vec![own]]
    }

    /// The region's rows for an eye; planes and leaves are appended to `planes`.
    pub fn rows(&self, view: &View, planes: &mut Vec<[f32; 4]>) -> layout::Region {
        self.region.rows(view, planes)
    }

    /// How far around it its lens acts, metres; 0 where that ends at once.
    pub fn reach_m(&self, view: &View) -> f64 {
        let Some(border) = self.border else { return 0.0 };
        let farthest = self.bounds.corners().into_iter().map(|c| view.depth(c)).fold(0.0, f64::max);
        border.reach_m(view, farthest)
    }

    /// The box around all that its lens acts on as *inside*, metres.
    pub fn bounds_of_border(&self, view: &View) -> Aabb {
        let reach = self.reach_m(view);
        Aabb { min: self.bounds.min - reach, max: self.bounds.max + reach }
    }

    /// The box in which its lens may act as *inside*: x to the right, y up, and the distance D along the view axis, metres from the eye.
    pub fn room(&self, view: &View) -> [DVec3; 2] {
        if !self.region.is_bounded() {
            return [DVec3::NEG_INFINITY, DVec3::INFINITY];
        }
        let placed = |point: DVec3| {
            let relative = point - view.camera.eye;
            DVec3::new(relative.dot(view.basis.right), relative.dot(view.basis.up), view.depth(point))
        };
        let reach = self.reach_m(view);
        if let (Some(Volume::Sphere(Sphere { center, radius })), false) = (self.region.volume(), self.has_own_eye()) {
            let middle = placed(*center);
            return [middle - radius - reach, middle + radius + reach];
        }
        let ends = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] =
            self.bounds.corners().into_iter().map(placed).fold(ends, |[low, high], p| [low.min(p), high.max(p)]);
        [low - reach, high + reach]
    }

    /// The part of the tile it may touch, outline included; `None` where it cannot be seen.
    pub fn seen_part(&self, view: &View, tile: PictureTile) -> Option<ScreenBound> {
        let whole = ScreenBound::whole(tile.size);
        // In front of what its own eye sees, or behind it, places may be anywhere.
        if self.everywhere || (self.has_own_eye() && (self.asks_sides || !self.region.is_bounded())) {
            return Some(whole);
        }
        let margin = match self.drawn {
            LensBody::Halo => match self.halo_reach_px(view) {
                Some(reach) => reach.ceil() as i32 + MARGIN_PX,
                None => return Some(whole),
            },
            LensBody::None if self.sprite.is_none() => MARGIN_PX,
            _ => self.line_margin_px(),
        };
        if let PlacedRegion::One(PlacedLeaf { leaf: Leaf::Volume(Volume::Flat(flat)), .. }) = &self.region {
            if self.border.is_some() {
                // It fades in its plane, however that is seen.
                return Some(whole);
            }
            let around = |(low, high)| ScreenBound::around(low, high).grown([margin; 2]).within(tile);
            return flat::projected(flat, view).map_or_else(|all| all.then_some(whole), around);
        }
        // A glow goes around the lens: what is behind an eye of parallel rays glows before it.
        let glow_m = match self.drawn {
            LensBody::Halo if view.is_orthographic() => f64::from(margin) * view.pixel_m(1.0),
            _ => 0.0,
        };
        let bounds = self.bounds_of_border(view);
        let bounds = Aabb { min: bounds.min - glow_m, max: bounds.max + glow_m };
        if self.bounds.is_empty() || !view.frustum(margin.into()).meets(&bounds) {
            return None;
        }
        // What lies beside or behind the eye bounds nothing.
        let Some((low, high)) = self.projected(view) else { return Some(whole) };
        ScreenBound::around(low, high).grown([margin; 2]).within(tile)
    }

    /// How far from its projection a line around it is seen at most, or what a coarse sprite says of it holds, pixels.
    pub fn line_margin_px(&self) -> i32 {
        // A line is half inside, and fades over a pixel.
        let line = (0.5 * body_px(false, self.point_px) + 1.0).ceil() as i32;
        WIDE_MARGIN_PX.max(line + 2)
    }

    /// How far from its projection a halo is seen at most, pixels; `None` where that may be anywhere.
    ///
    /// A halo is as wide as an angle (`lib/halo.wgsl`): its ray passes a place at a distance of no more than its width in pixels on the axis,
    /// seen from as far along it. The further from the axis, the more pixels that angle takes.
    fn halo_reach_px(&self, view: &View) -> Option<f64> {
        let is_own = |leaf: &PlacedLeaf| matches!(leaf.leaf, Leaf::Own(_));
        if self.region.leaves().any(is_own) {
            // Its distance may be any that is not too large.
            return None;
        }
        // What tells less than a distance, axis by axis, is no more than that beside the box around it.
        let is_exact = self.region.volume().is_some() && !self.region.has_solids();
        let width = body_px(true, self.point_px) * if is_exact { 1.0 } else { 3.0_f64.sqrt() };
        if view.is_orthographic() {
            return Some(width);
        }
        let [x, y] = view.size.map(f64::from);
        let slant = |corner: [f64; 2]| {
            let direction = view.ray(corner.into()).direction;
            direction.angle_between(view.basis.forward)
        };
        let aside = [[0.0, 0.0], [x, 0.0], [0.0, y], [x, y]].map(slant).into_iter().fold(0.0, f64::max);
        let angle = (width * view.pixel_m(1.0) * aside.cos()).min(1.0).asin();
        (aside + angle < WIDEST).then(|| ((aside + angle).tan() - aside.tan()) / view.pixel_m(1.0))
    }

    /// The box around its projection, pixels; `None` where it may be anywhere.
    pub fn box_seen(&self, view: &View) -> Option<(DVec2, DVec2)> {
        let ([x0, y0, ..], [x1, y1, ..]) = self.projected(view)?;
        Some((DVec2::new(x0, y0), DVec2::new(x1, y1)))
    }

    /// The least and the most of x, y, x + y and x - y in its projection, pixels; `None` where it reaches behind the near
    /// plane.
    fn projected(&self, view: &View) -> Option<([f64; 4], [f64; 4])> {
        let reach = self.reach_m(view);
        let around = || self.bounds_of_border(view).corners();
        let Some(volume) = self.region.volume().filter(|_| !self.has_own_eye()) else {
            return projected_corners(view, around());
        };
        match volume {
            Volume::Sphere(Sphere { center, radius }) if !view.is_orthographic() => {
                projected_sphere(view, *center, *radius + reach)
            }
            Volume::Flat(flat) => flat::projected(flat, view).ok(),
            _ => projected_corners(view, volume.corners_around(reach).unwrap_or_else(|| around().to_vec())),
        }
    }
}

/// Box around a box's projection, pixels, also beside the picture; `None` where it reaches behind the near plane.
pub fn projected_box(view: &View, bounds: &Aabb) -> Option<(DVec2, DVec2)> {
    let ([x0, y0, ..], [x1, y1, ..]) = projected_corners(view, bounds.corners())?;
    Some((DVec2::new(x0, y0), DVec2::new(x1, y1)))
}

/// Of a point: x, y, x + y, x - y.
pub(super) fn along(p: DVec2) -> [f64; 4] {
    [p.x, p.y, p.x + p.y, p.x - p.y]
}

fn projected_corners(view: &View, corners: impl IntoIterator<Item = DVec3>) -> Option<([f64; 4], [f64; 4])> {
    let (mut low, mut high) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
    for corner in corners {
        let p = view.pixel(corner).filter(|p| view.is_orthographic() || p.z > view.camera.near_m)?;
        for (i, at) in along(p.truncate()).into_iter().enumerate() {
            (low[i], high[i]) = (low[i].min(at), high[i].max(at));
        }
    }
    Some((low, high))
}

/// What bounds a sphere's ellipse in a perspective picture, as [`LensVolume::projected`]: in the plane of an image direction
/// and the view axis, the sphere is a disc, and the ellipse ends where the eye's tangents to it go (Mara and McGuire 2013).
fn projected_sphere(view: &View, center: DVec3, radius: f64) -> Option<([f64; 4], [f64; 4])> {
    let c = view.basis.view_from_world() * (center - view.camera.eye);
    let depth = -c.z;
    if depth - radius <= view.camera.near_m {
        return None;
    }
    let world_from_view = view.basis.view_from_world().transpose();
    let inv = 1.0 / (depth * depth - radius * radius);
    let (mut low, mut high) = ([0.0; 4], [0.0; 4]);
    // Pixels are square, and their rows go down.
    for (i, direction) in [[1.0, 0.0], [0.0, -1.0], [1.0, -1.0], [1.0, 1.0]].into_iter().enumerate() {
        let direction = DVec2::from(direction).normalize_or(DVec2::X);
        let across = direction.dot(c.truncate());
        let reach = radius * (across * across + depth * depth - radius * radius).sqrt();
        let end = |slope: f64| {
            let at = world_from_view * (slope * inv * direction).extend(-1.0) * depth;
            Some(along(view.pixel(view.camera.eye + at)?.truncate())[i])
        };
        let ends = [end(across * depth - reach)?, end(across * depth + reach)?];
        (low[i], high[i]) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    }
    Some((low, high))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        geom::{Shape, combination::Operation},
        view::Camera,
    };

    #[test]
    fn the_bounds_of_a_volume_hold_it_and_touch_it() {
        let camera = Camera::looking(DVec3::new(3.0, -40.0, 12.0), DVec3::new(1.0, 5.0, 2.0), 0.9);
        let view = View::new(camera, [640, 480], &Aabb::EMPTY).expect("a view");
        let at = DVec3::new(-6.0, 4.0, 3.0);
        let shapes = [
            Shape::Sphere { center: at, radius: 9.0 },
            Shape::Box {
                center: at,
                size: DVec3::new(4.0, 7.0, 11.0),
                rotation: glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 0.9),
            },
        ];
        for shape in shapes {
            let volume = shape.volume().expect("a volume");
            let lens = LensVolume::plain(0, PlacedRegion::One(Leaf::Volume(volume.clone()).into()));
            let (low, high) = lens.projected(&view).expect("it is in front of the eye");
            let (mut least, mut most) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
            for (x, y) in (0..480).flat_map(|y| (0..640).map(move |x| (x, y))) {
                if volume.entry_exit(&view.pixel_ray(x, y)).is_some() {
                    let at = along(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
                    for i in 0..4 {
                        (least[i], most[i]) = (least[i].min(at[i]), most[i].max(at[i]));
                    }
                }
            }
            for i in 0..4 {
                assert!(least[i] >= low[i] && most[i] <= high[i], "{low:?} {high:?} do not hold {least:?} {most:?}");
                // A sharp corner may pass between the centres of some rows.
                let apart = (least[i] - low[i]).max(high[i] - most[i]);
                assert!(apart < 3.0, "{low:?} {high:?} {least:?} {most:?}");
            }
        }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// By the formula of `lib/halo.wgsl`, in the corners of wide pictures too, and where two balls hardly meet: how far they are is less
        /// than how far what they share is.
        #[test]
        fn beyond_the_bounds_of_a_halo_no_ray_comes_near(
            fov in 0.1..2.6_f64,
            parallel in prop::bool::weighted(0.2),
            point_px in prop::sample::select(vec![4.0 / 3.0, 0.5, 7.0]),
            at in prop::array::uniform2(0.0..1.0_f64),
            away in 5.0..200.0_f64,
            radius in 0.5..20.0_f64,
            second in prop::option::of((0.3..2.0_f64, prop::array::uniform3(-1.0..1.0_f64))),
        ) {
            let mut camera = Camera::looking(DVec3::new(3.0, -40.0, 12.0), DVec3::new(1.0, 5.0, 2.0), fov);
            if parallel {
                camera.projection = crate::view::Projection::Orthographic { height_m: 90.0 };
            }
            let size = [96, 64];
            let view = View::new(camera, size, &Aabb::EMPTY).expect("a view");
            let ray = view.ray(DVec2::from(at) * DVec2::new(96.0, 64.0));
            let center = ray.origin + away * ray.direction;
            let mut balls = vec![(center, radius)];
            if let Some((size, aside)) = second {
                let aside = DVec3::from(aside).normalize_or(DVec3::X);
                balls.push((center + 0.98 * (1.0 + size) * radius * aside, size * radius));
            }
            let ball = |(center, radius): &(DVec3, f64)| -> PlacedLeaf {
                Leaf::Volume(Volume::Sphere(Sphere { center: *center, radius: *radius })).into()
            };
            let region = match &balls[..] {
                [one] => PlacedRegion::One(ball(one)),
                _ => PlacedRegion::Combined(vec![
                    (ball(&balls[0]), vec![]),
                    (ball(&balls[1]), vec![Operation::Intersection]),
                ]),
            };
            let lens = LensVolume { drawn: LensBody::Halo, point_px, ..LensVolume::plain(0, region) };
            prop_assume!(!lens.bounds.is_empty());
            let tile = PictureTile { origin: [0; 2], size };
            let seen = lens.seen_part(&view, tile);
            let pixels = (0..size[1]).step_by(3).flat_map(|y| (0..size[0]).step_by(3).map(move |x| [x, y]));
            for [x, y] in pixels.filter(|[x, y]| !seen.is_some_and(|part| part.holds([*x, *y]))) {
                let ray = view.pixel_ray(x, y);
                let to_depth = 1.0 / ray.direction.dot(view.basis.forward);
                let width = |depth: f64| {
                    let place = ray.origin + depth * to_depth * ray.direction;
                    let away = balls.iter().map(|(c, r)| c.distance(place) - r).fold(f64::NEG_INFINITY, f64::max);
                    away / view.pixel_m(depth)
                };
                let closest = (0..1500).map(|i| width(0.1 * 1.006_f64.powi(i))).fold(f64::INFINITY, f64::min);
                prop_assert!(closest > body_px(true, point_px), "{closest} pixels at {x}, {y}, {seen:?}");
            }
        }
    }
}
