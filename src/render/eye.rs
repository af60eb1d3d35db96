//! A view as the shaders read it, and what it can see.

use glam::{DMat3, DVec2, DVec3, Vec3};

use crate::{render::layout, view::View};

/// A rectangle of the whole picture, pixels; pictures larger than a target are drawn rectangle by rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureTile {
    /// Left, top.
    pub origin: [u32; 2],
    /// Width, height.
    pub size: [u32; 2],
}

impl PictureTile {
    /// The whole picture.
    pub fn whole(size: [u32; 2]) -> Self {
        Self { origin: [0, 0], size }
    }

    /// Where it ends along an axis.
    pub fn end(&self, axis: usize) -> u32 {
        self.origin[axis] + self.size[axis]
    }

    /// Whether it holds no pixel.
    pub fn is_empty(&self) -> bool {
        self.size.contains(&0)
    }

    /// That from one corner up to another; of no pixel where that is not beyond.
    fn between(origin: [u32; 2], end: [u32; 2]) -> Self {
        Self { origin, size: [0, 1].map(|i| end[i].saturating_sub(origin[i])) }
    }

    /// What two have in common.
    pub fn common(self, other: Self) -> Self {
        let origin = [0, 1].map(|i| self.origin[i].max(other.origin[i]));
        Self::between(origin, [0, 1].map(|i| self.end(i).min(other.end(i))))
    }

    /// The rectangle around two.
    pub fn around(self, other: Self) -> Self {
        let origin = [0, 1].map(|i| self.origin[i].min(other.origin[i]));
        Self::between(origin, [0, 1].map(|i| self.end(i).max(other.end(i))))
    }

    /// What of this is not in the other: above, left, right, below.
    pub fn without(self, other: Self) -> impl Iterator<Item = Self> {
        let hole = self.common(other);
        let [left, top] = self.origin;
        let [right, bottom] = [self.end(0), self.end(1)];
        let [low, high] = [hole.origin, [hole.end(0), hole.end(1)]];
        let parts = [
            Self::between([left, top], [right, low[1]]),
            Self::between([left, low[1]], [low[0], high[1]]),
            Self::between([high[0], low[1]], [right, high[1]]),
            Self::between([left, high[1]], [right, bottom]),
        ];
        let parts = if hole.is_empty() { [self; 4].into_iter().take(1) } else { parts.into_iter().take(4) };
        parts.filter(|part| !part.is_empty())
    }

    /// The same pixels in parts of which no two have one in common.
    pub fn apart(parts: impl IntoIterator<Item = Self>) -> Vec<Self> {
        let mut apart: Vec<Self> = Vec::new();
        for part in parts {
            let mut rest = vec![part];
            for taken in &apart {
                rest = rest.into_iter().flat_map(|part| part.without(*taken)).collect();
            }
            apart.extend(rest.into_iter().filter(|part| !part.is_empty()));
        }
        apart
    }
}

/// An eye position split so that subtracting it from whole metres is exact.
pub fn split_eye(eye: DVec3) -> ([i32; 3], [f32; 3]) {
    let whole = eye.round();
    ([whole.x as i32, whole.y as i32, whole.z as i32], (eye - whole).as_vec3().to_array())
}

/// `layout::View` of a tile of a picture, sampled `jitter_px` beside the pixels' centres.
pub fn view_uniform(view: &View, tile: PictureTile, jitter_px: DVec2, sample_index: u32, haze: f64) -> layout::View {
    let whole = DVec2::new(view.size[0].into(), view.size[1].into());
    let size = DVec2::new(tile.size[0].into(), tile.size[1].into());
    let origin = DVec2::new(tile.origin[0].into(), tile.origin[1].into());
    // ndc of the tile = ndc of the picture · zoom + shift; rows go down, so y is measured from the bottom.
    let zoom = whole / size;
    let from_bottom = DVec2::new(origin.x, whole.y - origin.y - size.y);
    let shift = zoom - 1.0 - 2.0 * from_bottom / size;
    let jitter = DVec2::new(-2.0, 2.0) * jitter_px / size;
    let scale = zoom / view.half_extent();
    let offset = shift + jitter;
    let per_pixel = DVec2::new(2.0, -2.0) / size / scale;
    let at_corner = (DVec2::new(-1.0, 1.0) - offset) / scale;
    let (eye_whole, eye_fraction) = split_eye(view.camera.eye);
    layout::View {
        view_from_world: padded(view.basis.view_from_world()),
        projection: joined(scale, offset),
        across_from_pixel: joined(per_pixel, at_corner),
        near: view.camera.near_m as f32,
        far: if view.is_orthographic() { view.far_m as f32 } else { 0.0 },
        orthographic: u32::from(view.is_orthographic()),
        sample_index,
        eye_whole,
        first_pixel: tile.origin[0] & 0xffff | tile.origin[1] << 16,
        eye_fraction,
        pad_0: 0,
        size: [tile.size[0] as f32, tile.size[1] as f32],
        haze: haze as f32,
        pad_1: 0,
    }
}

fn joined(a: DVec2, b: DVec2) -> [f32; 4] {
    [a.x as f32, a.y as f32, b.x as f32, b.y as f32]
}

/// Columns of a 3×3 matrix at WGSL's stride.
pub fn padded(m: DMat3) -> [[f32; 4]; 3] {
    [m.x_axis, m.y_axis, m.z_axis].map(|c| c.as_vec3().extend(0.0).to_array())
}

/// CPU twin of `relative_to_eye` in `lib/view.wgsl`, in the same f32 steps (hard case 1).
pub fn relative_to_eye(whole: [i32; 3], offset: [f32; 3], eye_whole: [i32; 3], eye_fraction: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| ((whole[i].wrapping_sub(eye_whole[i])) as f32 - eye_fraction[i]) + offset[i])
}

/// A world position relative to the eye, rounded once.
pub fn relative(world: DVec3, eye: DVec3) -> Vec3 {
    (world - eye).as_vec3()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{geom::Aabb, view::Camera};

    /// ndc of a world point by the uniform's own figures, in f64.
    fn pixel_by_uniform(view: &View, uniform: &layout::View, world: DVec3) -> DVec2 {
        let p = view.basis.view_from_world() * (world - view.camera.eye);
        let scale = DVec2::new(uniform.projection[0].into(), uniform.projection[1].into());
        let shift = DVec2::new(uniform.projection[2].into(), uniform.projection[3].into());
        let ndc = p.truncate() * scale / -p.z + shift;
        DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * DVec2::new(uniform.size[0].into(), uniform.size[1].into())
    }

    #[test]
    fn tiles_and_jitter_only_shift_pixels() {
        let eye = DVec3::new(85_000.25, 446_000.5, 30.0);
        let view =
            View::new(Camera::looking(eye, eye + DVec3::new(3.0, 9.0, -2.0), 0.8), [1000, 600], &Aabb::EMPTY).unwrap();
        let world = eye + DVec3::new(40.0, 100.0, -20.0);
        let expected = view.pixel(world).unwrap().truncate();
        for (origin, size) in [([0, 0], [1000, 600]), ([512, 0], [488, 256]), ([100, 300], [64, 32])] {
            let jitter = DVec2::new(0.25, -0.375);
            let uniform = view_uniform(&view, PictureTile { origin, size }, jitter, 0, 0.0);
            let found = pixel_by_uniform(&view, &uniform, world);
            let moved = expected - DVec2::new(origin[0].into(), origin[1].into()) - jitter;
            assert!((found - moved).length() < 1e-3, "{found} is not {moved}");
        }
    }

    fn tile() -> impl Strategy<Value = PictureTile> {
        let pair = || prop::array::uniform2(0..9u32);
        (pair(), pair()).prop_map(|(origin, size)| PictureTile { origin, size })
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn parts_hold_each_pixel_once(parts in prop::collection::vec(tile(), 0..6)) {
            let holds = |tile: &PictureTile, [x, y]: [u32; 2]| {
                (tile.origin[0]..tile.end(0)).contains(&x) && (tile.origin[1]..tile.end(1)).contains(&y)
            };
            let apart = PictureTile::apart(parts.iter().copied());
            for pixel in (0..18).flat_map(|x| (0..18).map(move |y| [x, y])) {
                let count = apart.iter().filter(|tile| holds(tile, pixel)).count();
                prop_assert_eq!(count, usize::from(parts.iter().any(|tile| holds(tile, pixel))));
            }
            for (a, b) in parts.iter().zip(parts.iter().skip(1)) {
                let [common, around] = [a.common(*b), a.around(*b)];
                for pixel in (0..18).flat_map(|x| (0..18).map(move |y| [x, y])) {
                    prop_assert_eq!(holds(&common, pixel), holds(a, pixel) && holds(b, pixel));
                    prop_assert!(holds(&around, pixel) || !(holds(a, pixel) || holds(b, pixel)));
                }
            }
        }
    }
}
