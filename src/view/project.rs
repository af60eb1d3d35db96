//! From the world to pixels and back.

use glam::{DMat4, DVec2, DVec3, DVec4};

use crate::{
    geom::{Aabb, Ray},
    view::{
        basis::Basis,
        camera::{Camera, CameraError, MAX_SIZE, Projection},
        frustum::{Frustum, HalfSpace},
    },
};

/// A checked camera and the picture it fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera, checked.
    pub camera: Camera,
    /// Its axes.
    pub basis: Basis,
    /// Width and height, pixels, 1..=16384.
    pub size: [u32; 2],
    /// Far plane, metres along the view axis: +∞ in perspective; in orthographic views beyond everything.
    pub far_m: f64,
    /// Whether what lies in any direction may be seen: in a fisheye.
    pub looks_around: bool,
}

impl View {
    /// A camera on a picture of `size` pixels. `extent` is everything that may be drawn: an orthographic depth is linear and
    /// needs a far plane, which is put beyond it. Lenses are not drawn, and their sprites clamp depth.
    pub fn new(camera: Camera, size: [u32; 2], extent: &Aabb) -> Result<Self, CameraError> {
        if size.iter().any(|side| !(1..=MAX_SIZE).contains(side)) {
            return Err(CameraError::Size(size[0], size[1]));
        }
        let basis = camera.basis()?;
        let far_m = match camera.projection {
            Projection::Perspective { .. } => f64::INFINITY,
            Projection::Orthographic { .. } => {
                let deepest = HalfSpace::through(camera.eye, basis.forward).deepest(extent);
                let deepest = if extent.is_empty() || !deepest.is_finite() { 0.0 } else { deepest };
                // A metre and a thousandth more, so that nothing lies on the far plane itself.
                (deepest * 1.001 + 1.0).max(camera.near_m + 1.0)
            }
        };
        Ok(Self { camera, basis, size, far_m, looks_around: false })
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }

    /// Half the picture's width and height: at one metre in front of the eye in perspective, anywhere else.
    pub fn half_extent(&self) -> DVec2 {
        self.camera.half_extent(self.size)
    }

    /// Whether the view is orthographic.
    pub fn is_orthographic(&self) -> bool {
        matches!(self.camera.projection, Projection::Orthographic { .. })
    }

    /// Clip space from view space (x right, y up, z backward; metres from the eye), sampling the picture `offset_px`
    /// (x right, y down) away from the pixels' centres.
    ///
    /// Reversed depth in 0..1: perspective λ = near/D (infinite far plane), orthographic λ = (far−D)/(far−near).
    pub fn clip_from_view(&self, offset_px: DVec2) -> DMat4 {
        let half = self.half_extent();
        // What lies at centre + offset must land on the centre; a pixel is 2/size in ndc, rows go down.
        let shift =
            DVec2::new(-2.0 * offset_px.x / f64::from(self.size[0]), 2.0 * offset_px.y / f64::from(self.size[1]));
        let near = self.camera.near_m;
        if self.is_orthographic() {
            let depth = self.far_m - near;
            DMat4::from_cols(
                DVec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
                DVec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
                DVec4::new(shift.x, shift.y, self.far_m / depth, 1.0),
            )
        } else {
            DMat4::from_cols(
                DVec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
                DVec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
                DVec4::new(-shift.x, -shift.y, 0.0, -1.0),
                DVec4::new(0.0, 0.0, near, 0.0),
            )
        }
    }

    /// Clip space from metres relative to the eye on the model's axes: what camera-relative vertices multiply with.
    pub fn clip_from_relative(&self, offset_px: DVec2) -> DMat4 {
        self.clip_from_view(offset_px) * DMat4::from_mat3(self.basis.view_from_world())
    }

    /// Distance D of a point along the view axis, metres; negative behind the eye.
    pub fn depth(&self, world: DVec3) -> f64 {
        (world - self.camera.eye).dot(self.basis.forward)
    }

    /// Where a point appears: pixel x, pixel y (row 0 at the top, centres at +½) and D. `None` on or behind the eye
    /// plane in perspective.
    pub fn pixel(&self, world: DVec3) -> Option<DVec3> {
        let from_eye = world - self.camera.eye;
        let d = from_eye.dot(self.basis.forward);
        let scale = if self.is_orthographic() { 1.0 } else { d };
        if scale <= 0.0 || !scale.is_finite() {
            return None;
        }
        let plane = DVec2::new(from_eye.dot(self.basis.right), from_eye.dot(self.basis.up)) / scale;
        let ndc = plane / self.half_extent();
        let pixel =
            DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * DVec2::new(self.size[0].into(), self.size[1].into());
        Some(pixel.extend(d))
    }

    /// Where a point appears, times a weight, and the weight: linear in the point, so that it holds of what is behind the eye too, where the weight
    /// is less than 0. The pixel is x and y by the weight.
    pub fn weighted_pixel(&self, world: DVec3) -> DVec3 {
        let from_eye = world - self.camera.eye;
        let weight = if self.is_orthographic() { 1.0 } else { from_eye.dot(self.basis.forward) };
        let ndc = DVec2::new(from_eye.dot(self.basis.right), from_eye.dot(self.basis.up)) / self.half_extent();
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        (0.5 * size * DVec2::new(weight + ndc.x, weight - ndc.y)).extend(weight)
    }

    /// The sight line through a point of the picture, in pixels (`x + ½, y + ½` = a pixel's centre). Its `t` is D.
    pub fn ray(&self, pixel: DVec2) -> Ray {
        let unit = pixel / DVec2::new(self.size[0].into(), self.size[1].into());
        let plane = DVec2::new(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y) * self.half_extent();
        let across = plane.x * self.basis.right + plane.y * self.basis.up;
        if self.is_orthographic() {
            Ray { origin: self.camera.eye + across, direction: self.basis.forward }
        } else {
            Ray { origin: self.camera.eye, direction: self.basis.forward + across }
        }
    }

    /// The sight line through the centre of the pixel in column `x` of row `y`.
    pub fn pixel_ray(&self, x: u32, y: u32) -> Ray {
        self.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
    }

    /// Edge of a pixel at distance D, metres.
    pub fn pixel_m(&self, depth: f64) -> f64 {
        let height = 2.0 * self.half_extent().y;
        height / f64::from(self.size[1]) * if self.is_orthographic() { 1.0 } else { depth }
    }

    /// The visible part of the world, widened by `margin_px` pixels on all four sides (1 covers every jitter).
    pub fn frustum(&self, margin_px: f64) -> Frustum {
        if self.looks_around {
            return Frustum::EVERYTHING;
        }
        let wider = DVec2::new(
            1.0 + 2.0 * margin_px / f64::from(self.size[0]),
            1.0 + 2.0 * margin_px / f64::from(self.size[1]),
        );
        let half = self.half_extent() * wider;
        let (eye, Basis { right, up, forward }) = (self.camera.eye, self.basis);
        let near = HalfSpace::through(eye + self.camera.near_m * forward, forward);
        let side = |axis: DVec3, reach: f64| {
            if self.is_orthographic() {
                HalfSpace::through(eye - reach * axis, axis)
            } else {
                // Contains the eye and the border direction forward − reach·axis.
                HalfSpace::through(eye, (axis + reach * forward).normalize_or(axis))
            }
        };
        Frustum { sides: [side(right, half.x), side(-right, half.x), side(up, half.y), side(-up, half.y), near] }
    }
}

#[cfg(test)]
mod tests {
    use glam::dcamera::rh::proj::directx;
    use proptest::prelude::*;

    use super::*;

    fn cameras() -> impl Strategy<Value = View> {
        let point = || prop::array::uniform3(-1e3..1e3f64).prop_map(DVec3::from);
        (point(), point(), point(), any::<bool>(), 0.1..3.0f64, 1..4000u32, 1..4000u32).prop_filter_map(
            "a direction",
            |(eye, target, up, ortho, scale, w, h)| {
                let projection = if ortho {
                    Projection::Orthographic { height_m: 100.0 * scale }
                } else {
                    Projection::Perspective { fov_y: scale }
                };
                let national = DVec3::new(85_000.0, 446_000.0, 0.0);
                let camera = Camera { eye: eye + national, target: target + national, up, projection, near_m: 0.5 };
                let extent = Aabb { min: national - 3e3, max: national + 3e3 };
                View::new(camera, [w, h], &extent).ok()
            },
        )
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Linear in the point, and the same pixel before the eye.
        #[test]
        fn weighted_pixels_are_pixels_before_the_eye(view in cameras(), a in prop::array::uniform3(-1e3..1e3f64), b in prop::array::uniform3(-1e3..1e3f64)) {
            let [a, b] = [a, b].map(|place| view.camera.eye + DVec3::from(place));
            let [own, other] = [a, b].map(|place| view.weighted_pixel(place));
            match view.pixel(a) {
                Some(pixel) => prop_assert!((own.truncate() / own.z).distance(pixel.truncate()) <= 1e-6 * (1.0 + pixel.truncate().length())),
                None => prop_assert!(own.z <= 0.0),
            }
            let middle = view.weighted_pixel(a.midpoint(b));
            prop_assert!(middle.distance(own.midpoint(other)) <= 1e-6 * (1.0 + own.length() + other.length()));
        }

        #[test]
        fn a_ray_goes_where_its_pixel_says(view in cameras(), x in 0.0..1.0f64, y in 0.0..1.0f64, d in 0.6..5e3f64) {
            let pixel = DVec2::new(x * f64::from(view.size[0]), y * f64::from(view.size[1]));
            let back = view.pixel(view.ray(pixel).at(d)).unwrap();
            prop_assert!((back.truncate() - pixel).length() < 1e-4, "{pixel} became {back}");
            prop_assert!((back.z - d).abs() < 1e-6);
            prop_assert!(view.frustum(0.0).contains(view.ray(pixel).at(d)) || x < 1e-6 || y < 1e-6 || x > 1.0 - 1e-6 || y > 1.0 - 1e-6);
        }

        #[test]
        fn matrix_and_closed_form_agree(view in cameras(), x in 0.0..1.0f64, y in 0.0..1.0f64, d in 0.6..2e3f64, jx in -0.5..0.5f64, jy in -0.5..0.5f64) {
            let size = DVec2::new(view.size[0].into(), view.size[1].into());
            let jitter = DVec2::new(jx, jy);
            let world = view.ray(DVec2::new(x, y) * size + jitter).at(d);
            let clip = view.clip_from_relative(jitter) * (world - view.camera.eye).extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let pixel = DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size;
            prop_assert!((pixel - DVec2::new(x, y) * size).length() < 1e-4);
            let expected = if view.is_orthographic() { (view.far_m - d) / (view.far_m - 0.5) } else { 0.5 / d };
            prop_assert!((ndc.z - expected).abs() < 1e-9);
        }

        #[test]
        fn culling_never_drops_a_visible_point(view in cameras(), x in 0.0..1.0f64, y in 0.0..1.0f64, d in 0.6..5e3f64, e in prop::array::uniform3(0.0..50.0f64)) {
            let size = DVec2::new(view.size[0].into(), view.size[1].into());
            let seen = view.ray(DVec2::new(x, y) * size).at(d);
            let bounds = Aabb { min: seen - DVec3::from(e), max: seen };
            prop_assert!(view.frustum(0.0).meets(&bounds));
        }
    }

    #[test]
    fn perspective_is_glams() {
        let camera = Camera::looking(DVec3::ZERO, DVec3::Y, 0.8);
        let view = View::new(camera, [640, 360], &Aabb::EMPTY).unwrap();
        let theirs = directx::perspective_infinite_reverse(0.8, 640.0 / 360.0, camera.near_m);
        assert!(view.clip_from_view(DVec2::ZERO).abs_diff_eq(theirs, 1e-15));
    }

    #[test]
    fn looking_north_the_east_is_right_and_the_sky_up() {
        let view = View::new(Camera::looking(DVec3::ZERO, DVec3::Y, 1.0), [100, 50], &Aabb::EMPTY).unwrap();
        assert_eq!(view.pixel(DVec3::new(0.0, 10.0, 0.0)), Some(DVec3::new(50.0, 25.0, 10.0)));
        assert!(view.pixel(DVec3::new(1.0, 10.0, 0.0)).unwrap().x > 50.0);
        assert!(view.pixel(DVec3::new(0.0, 10.0, 1.0)).unwrap().y < 25.0);
        assert_eq!(view.pixel(-DVec3::Y), None);
        assert!(!view.frustum(0.0).meets(&Aabb { min: DVec3::splat(-2.0), max: DVec3::splat(-1.0) }));
    }
}
