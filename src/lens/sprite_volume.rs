//! Depth sprites with an eye of their own: where their texels are in the world, and the volume that a saved one holds.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::{
    geom::{
        Aabb, clipped,
        shape::{Motion, flat::ENDLESS_M},
    },
    lens::sprite::DepthCode,
    view::{Basis, View},
};

/// The eye that a sprite was made from, and its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpriteSpace {
    /// Centre of projection; of parallel rays the middle of the plane from which distances count. Metres, model coordinates.
    pub eye: DVec3,
    /// Its axes.
    pub basis: Basis,
    /// Whether all rays are parallel.
    pub is_orthographic: bool,
    /// Half the frame's width and height: at a distance of one metre in perspective, anywhere else; metres.
    pub half: DVec2,
    /// Width and height of the whole frame, texels.
    pub size: [u32; 2],
}

impl SpriteSpace {
    /// That of a view.
    pub fn of(view: &View) -> Self {
        Self {
            eye: view.camera.eye,
            basis: view.basis,
            is_orthographic: view.is_orthographic(),
            half: view.half_extent(),
            size: view.size,
        }
    }

    /// Turned and moved.
    pub fn moved(&self, motion: &Motion) -> Self {
        if *motion == Motion::NONE {
            return *self;
        }
        let Basis { right, up, forward } = self.basis;
        let [right, up, forward] = [right, up, forward].map(|axis| motion.rotation * axis);
        Self { eye: motion.point(self.eye), basis: Basis { right, up, forward }, ..*self }
    }

    /// Right, up and along the axis, from the eye; metres.
    fn local(&self, p: DVec3) -> DVec3 {
        let Basis { right, up, forward } = self.basis;
        let from_eye = p - self.eye;
        DVec3::new(from_eye.dot(right), from_eye.dot(up), from_eye.dot(forward))
    }

    /// Texels per metre (in perspective at a distance of one), to the right and down; and the texel that the axis goes through.
    pub fn projection(&self) -> [DVec2; 2] {
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        [size / (2.0 * self.half) * DVec2::new(1.0, -1.0), 0.5 * size]
    }

    /// What a point's place across the axis is divided by.
    fn scale(&self, d: f64) -> f64 {
        if self.is_orthographic { 1.0 } else { d }
    }

    /// Where a point is in the frame, in texels from its top left corner, and its distance along the axis; `None` behind the eye.
    pub fn texel(&self, p: DVec3) -> Option<DVec3> {
        let local = self.local(p);
        let [scale, middle] = self.projection();
        (local.z > 0.0).then(|| (local.truncate() * scale / self.scale(local.z) + middle).extend(local.z))
    }

    /// The point at a place of the frame, texels, and a distance along the axis, metres.
    pub fn at(&self, texel: DVec2, d: f64) -> DVec3 {
        let [scale, middle] = self.projection();
        let across = (texel - middle) / scale * self.scale(d);
        self.eye + across.x * self.basis.right + across.y * self.basis.up + d * self.basis.forward
    }

    /// Box around what part of the frame shows between two distances, metres.
    pub fn bounds(&self, origin: [u32; 2], size: [u32; 2], depths: [f64; 2]) -> Aabb {
        let low = DVec2::new(origin[0].into(), origin[1].into());
        let high = low + DVec2::new(size[0].into(), size[1].into());
        let corners = [low, high, DVec2::new(low.x, high.y), DVec2::new(high.x, low.y)];
        Aabb::from_points(corners.into_iter().flat_map(|corner| depths.map(|d| self.at(corner, d))))
    }

    /// The half-spaces whose common part a rectangle of the frame is seen through, in local coordinates: `normal · p ≤ 0`, or
    /// `offset`.
    fn sides(&self, origin: DVec2, size: DVec2) -> [(DVec3, f64); 4] {
        let [scale, middle] = self.projection();
        let side = |axis: usize, texel: f64, sign: f64| {
            let across = (texel - middle[axis]) / scale[axis];
            // Texels count down, metres up.
            let sign = sign * scale[axis].signum();
            let mut normal = DVec3::ZERO;
            normal[axis] = sign;
            if self.is_orthographic {
                return (normal, sign * across);
            }
            normal.z = -sign * across;
            (normal, 0.0)
        };
        let end = origin + size;
        [side(0, origin.x, -1.0), side(0, end.x, 1.0), side(1, origin.y, -1.0), side(1, end.y, 1.0)]
    }
}

/// A saved depth sprite: where the rays of its texels are inside, and how it stored that.
#[derive(Clone, Debug, PartialEq)]
pub struct SpriteVolume {
    /// Where it was made.
    pub space: SpriteSpace,
    /// The part of the frame that is kept: its first texel. Rays beside it are nowhere inside.
    pub origin: [u32; 2],
    /// Width and height of that part, texels.
    pub kept: [u32; 2],
    /// Intervals of a texel, at most.
    pub layers: u32,
    /// Entry and exit along the axis, metres: row by row from the top, texel by texel, layer by layer, ascending. An entry of 0:
    /// the eye is inside; an exit of +∞: there is none; an exit of 0: there are no more intervals.
    pub ends: Vec<[f32; 2]>,
    /// How it stored distances.
    pub code: DepthCode,
    /// Name of the coordinate reference system of the model, where it is known.
    pub crs: Option<String>,
}

impl SpriteVolume {
    /// The intervals of a texel of the kept part.
    pub fn intervals(&self, x: u32, y: u32) -> impl Iterator<Item = [f32; 2]> {
        let first = (y as usize * self.kept[0] as usize + x as usize) * self.layers as usize;
        self.ends[first..first + self.layers as usize].iter().copied().take_while(|ends| ends[1] > 0.0)
    }

    /// Of all entries that are not in the eye and all exits, the nearest and the furthest, metres; `None` where it holds nothing.
    pub fn depths(&self) -> Option<[f64; 2]> {
        let all = self.ends.iter().filter(|ends| ends[1] > 0.0);
        let reach = all.fold([f32::INFINITY, 0.0], |[low, high], [entry, exit]| [low.min(*entry), high.max(*exit)]);
        (reach[1] > 0.0).then(|| reach.map(f64::from))
    }
}

/// A saved depth sprite where a lens has it.
#[derive(Clone, Debug)]
pub struct PlacedSprite {
    /// What was saved.
    pub sprite: Arc<SpriteVolume>,
    /// Where it is now.
    pub space: SpriteSpace,
    /// Box around it, metres.
    pub bounds: Aabb,
}

impl PlacedSprite {
    /// A sprite that a motion has put where it is.
    pub fn new(sprite: Arc<SpriteVolume>, motion: &Motion) -> Self {
        let space = sprite.space.moved(motion);
        let bounds = match sprite.depths() {
            None => Aabb::EMPTY,
            Some([_, far]) if far.is_infinite() => Aabb { min: DVec3::splat(-ENDLESS_M), max: DVec3::splat(ENDLESS_M) },
            Some(depths) => space.bounds(sprite.origin, sprite.kept, depths),
        };
        Self { sprite, space, bounds }
    }

    /// Whether a closed triangle shares a point with what a ray of some texel is inside of, in f64.
    pub fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let (sprite, space) = (&*self.sprite, &self.space);
        let Some([near, far]) = sprite.depths() else { return false };
        let low = DVec2::new(sprite.origin[0].into(), sprite.origin[1].into());
        let part = |x: u32, y: u32, size: [u32; 2]| {
            space.sides(low + DVec2::new(x.into(), y.into()), DVec2::new(size[0].into(), size[1].into()))
        };
        let between =
            |[near, far]: [f64; 2]| [(-DVec3::Z, -near), (DVec3::Z, if far.is_finite() { far } else { f64::MAX })];
        let local = corners.map(|p| space.local(p));
        let seen = clipped(&clipped(&local, between([near, far])), part(0, 0, sprite.kept));
        let [xs, ys] = self.around(&seen);
        ys.into_iter().any(|y| {
            let row = clipped(&seen, part(0, y, [sprite.kept[0], 1]));
            let [own, _] = self.around(&row);
            let columns = own.start.max(xs.start)..own.end.min(xs.end);
            columns.into_iter().any(|x| {
                let column = clipped(&row, part(x, y, [1, 1]));
                let meets =
                    |[entry, exit]: [f32; 2]| !clipped(&column, between([entry.into(), exit.into()])).is_empty();
                !column.is_empty() && sprite.intervals(x, y).any(meets)
            })
        })
    }

    /// Columns and rows of the kept part that a polygon in it, in local coordinates, may touch.
    fn around(&self, polygon: &[DVec3]) -> [std::ops::Range<u32>; 2] {
        let (sprite, [scale, middle]) = (&*self.sprite, self.space.projection());
        [0, 1].map(|i| {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for p in polygon {
                // What touches the eye may be anywhere.
                let w = self.space.scale(p.z);
                let at = if w > 0.0 { p[i] * scale[i] / w + middle[i] - f64::from(sprite.origin[i]) } else { f64::NAN };
                low = if at.is_nan() { 0.0 } else { low.min(at) };
                high = if at.is_nan() { f64::INFINITY } else { high.max(at) };
            }
            let last = f64::from(sprite.kept[i]);
            // A border belongs to both of its texels; rounding may move what lies on it.
            let texel = |at: f64| at.clamp(0.0, last) as u32;
            texel((low - 1e-6).floor())..texel((high + 1e-6).floor() + 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        geom::{Volume, shape::Sphere},
        lens::sprite::{Format, Mapping},
        view::Camera,
    };

    fn view(is_orthographic: bool) -> View {
        let mut camera =
            Camera::looking(DVec3::new(85_010.0, 446_980.0, 30.0), DVec3::new(85_000.0, 447_000.0, 10.0), 0.8);
        if is_orthographic {
            camera.projection = crate::view::Projection::Orthographic { height_m: 40.0 };
        }
        View::new(camera, [40, 30], &Aabb::EMPTY).expect("a view")
    }

    /// A sprite of a ball, and another ball behind it.
    fn balls(view: &View) -> SpriteVolume {
        let ball = |along: f64| {
            let center = view.ray(DVec2::new(19.0, 16.0)).at(along);
            Volume::Sphere(Sphere { center, radius: 5.0 })
        };
        let both = [ball(25.0), ball(40.0)];
        let texels = (0..30).flat_map(|y| (0..40).map(move |x| (x, y)));
        let ends = texels.flat_map(|(x, y)| {
            let mut own: Vec<[f32; 2]> = Vec::new();
            own.extend(
                both.iter().filter_map(|b| b.entry_exit(&view.pixel_ray(x, y))).map(|(a, b)| [a as f32, b as f32]),
            );
            own.resize(2, [0.0; 2]);
            own
        });
        SpriteVolume {
            ends: ends.collect(),
            space: SpriteSpace::of(view),
            origin: [0, 0],
            kept: [40, 30],
            layers: 2,
            code: DepthCode { mapping: Mapping::InverseW, near_m: 1.0, far_m: f64::INFINITY, format: Format::Float32 },
            crs: None,
        }
    }

    #[test]
    fn places_are_those_of_the_view() {
        for is_orthographic in [false, true] {
            let view = view(is_orthographic);
            let space = SpriteSpace::of(&view);
            for (texel, d) in [(DVec2::new(0.0, 0.0), 3.0), (DVec2::new(39.0, 7.25), 70.0)] {
                let p = view.ray(texel).at(d);
                assert!((space.at(texel, d) - p).length() < 1e-9);
                assert!((space.texel(p).expect("before the eye") - texel.extend(d)).length() < 1e-6);
            }
            assert_eq!(space.texel(view.camera.eye - view.basis.forward), None);
        }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn triangles_meet_what_their_points_are_in(is_orthographic in any::<bool>(),
            corners in prop::array::uniform3((-5.0..45.0f64, -5.0..35.0f64, 5.0..60.0f64))) {
            let view = view(is_orthographic);
            let sprite = Arc::new(balls(&view));
            let placed = PlacedSprite::new(sprite.clone(), &Motion::NONE);
            let corners = corners.map(|(x, y, d)| placed.space.at(DVec2::new(x, y), d));
            // Brute force: points of the triangle. Each stands for what is as near as the next ones.
            let step = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f64::max) / 120.0;
            let (mut holds, mut nearly) = (false, false);
            for (i, j) in (0..=120).flat_map(|i| (0..=120 - i).map(move |j| (i, j))) {
                let (u, v) = (f64::from(i) / 120.0, f64::from(j) / 120.0);
                let at = placed.space.texel(corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]));
                let Some(at) = at else { continue };
                let is_in = |x: i32, y: i32, room: f64| {
                    let ends = |e: [f32; 2]| at.z >= f64::from(e[0]) - room && at.z <= f64::from(e[1]) + room;
                    (0..40).contains(&x) && (0..30).contains(&y) && sprite.intervals(x as u32, y as u32).any(ends)
                };
                let [x, y] = [at.x.floor() as i32, at.y.floor() as i32];
                holds |= is_in(x, y, 0.0);
                let beside = (step * 60.0 / if is_orthographic { 1.0 } else { (at.z - step).max(0.5) }).ceil() as i32;
                let around = (-beside..=beside).flat_map(|i| (-beside..=beside).map(move |j| (x + i, y + j)));
                nearly = nearly || around.into_iter().any(|(x, y)| is_in(x, y, step));
            }
            let met = placed.meets_triangle(&corners);
            prop_assert!(met || !holds, "a point of it is inside");
            prop_assert!(!met || nearly, "no point of it is near");
        }
    }

    #[test]
    fn a_triangle_far_beyond_all_corners_is_met() {
        for is_orthographic in [false, true] {
            let view = view(is_orthographic);
            let placed = PlacedSprite::new(Arc::new(balls(&view)), &Motion::NONE);
            let middle = view.ray(DVec2::new(19.5, 16.5)).at(25.0);
            let sheet = |along: f64| {
                let p = middle + along * view.basis.forward;
                let by = |a: f64, b: f64| p + 1e3 * (a * view.basis.right + b * view.basis.up);
                [by(-1.0, -1.0), by(1.0, -1.0), by(0.0, 1.0)]
            };
            for (along, is_met) in [(0.0, true), (-4.9, true), (-5.2, false), (7.5, false), (12.0, true), (22.0, false)]
            {
                assert_eq!(placed.meets_triangle(&sheet(along)), is_met, "{along}");
            }
            let moved = PlacedSprite::new(
                placed.sprite.clone(),
                &Motion { translation: DVec3::new(0.0, 0.0, 50.0), ..Motion::NONE },
            );
            assert!(!moved.meets_triangle(&sheet(0.0)));
            assert!(moved.meets_triangle(&sheet(0.0).map(|p| p + DVec3::Z * 50.0)));
        }
    }
}
